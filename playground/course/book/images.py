"""Draw the book's pictures into its folder, as WebP."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from playground.course.figure_renders import Picture, draw, pictures_of
from playground.course.model import Lesson, Scene
from playground.engine.engine import Engine
from playground.files import replacing

QUALITY = 79
"""Of WebP: noise in a texture costs most, and errors in it are least visible."""

EFFORT = 50
"""Of lossless WebP, where quality only means time: more made nothing smaller."""

SHARPER = 1.5
"""Pixels drawn for each of a page's, each way: screens have more than one."""


BLACK = 32.0
"""Level of 255 that nine tenths of a picture lie below, where there is nothing but black to see."""

MAX_DIAGRAM_COLOURS = 2048
"""Colours that a diagram has at most; terrain has tens of thousands."""


@dataclass
class Album:
    """The pictures of a book: their files, and what each shows; equal pictures share a file."""

    folder: Path
    scenes: dict[str, Scene] = field(default_factory=dict)  # file name → what it shows
    _known: dict[tuple[object, ...], str] = field(default_factory=dict)

    def add(self, name: str, scene: Scene) -> str:
        """Note a picture and return its file's name; the same picture under another name has one file."""
        key = (scene.sketch, scene.pixels, scene.time, scene.steps)
        if key not in self._known:
            self._known[key] = f"{name}.webp"
            self.scenes[f"{name}.webp"] = scene
        return self._known[key]

    def add_lesson(self, lesson: Lesson) -> dict[str, str]:
        """Note all pictures of a lesson; return their files' names by their own."""
        return {
            picture.name: self.add(f"{lesson.name}-{picture.name}", picture.scene)
            for picture in pictures_of(lesson)
        }

    def draw(self, engine: Engine, names: Iterable[str], advance: Callable[[], None]) -> None:
        """Draw some of the pictures; raise as ``Engine.render`` does."""
        self.folder.mkdir(parents=True, exist_ok=True)
        before: Future[None] | None = None
        with ThreadPoolExecutor(1) as aside:  # a picture is stored while the next is drawn
            for name in names:
                frame = draw(engine, larger(self.scenes[name]))
                if before:
                    before.result()
                    advance()
                before = aside.submit(store, self.folder / name, frame.array)
            if before:
                before.result()
                advance()


def store(path: Path, picture: NDArray[np.uint8]) -> None:
    """Write a picture as WebP: a diagram without loss, terrain nearly so."""
    exact = is_diagram(picture)
    with replacing(path) as handle:
        image = Image.fromarray(picture).convert("RGB")
        if exact:
            image.save(handle, "WEBP", quality=EFFORT, method=2, lossless=True)
        else:
            image.save(handle, "WEBP", quality=QUALITY, method=4)


def is_diagram(picture: NDArray[np.uint8]) -> bool:
    """Whether a picture has few colours: compression damages its thin lines, which terrain tolerates."""
    colours = picture[..., :3].astype(np.uint32) @ np.array([1, 256, 65536], np.uint32)
    return np.unique(colours).size <= MAX_DIAGRAM_COLOURS


def is_blank(path: Path) -> bool:
    """Whether a stored picture is as good as black, seen from as far as a stamp."""
    with Image.open(path) as image:
        small = image.convert("L").resize((64, 36), Image.Resampling.BOX)
    return float(np.percentile(np.asarray(small), 90)) < BLACK


def larger(scene: Scene) -> Scene:
    """Return a picture with the pixels that the book draws."""
    width, height = scene.pixels
    return replace(scene, pixels=(round(width * SHARPER), round(height * SHARPER)))


def of_picture(files: dict[str, str], folder: str) -> Callable[[Picture], str]:
    """Return what gives a picture's address, from a page's folder."""
    return lambda picture: f"{folder}/{files[picture.name]}"
