"""A lesson in a notebook: its blocks by name, drawn by one engine for all."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, TypeVar

from playground.api import headless
from playground.engine.engine import Engine
from playground.engine.frame import Frame
from playground.errors import SketchError, nearest
from playground.lessons.bugs import region
from playground.lessons.figure_renders import broken, draw
from playground.lessons.library import SOURCE, interface_words
from playground.lessons.measuring import measured
from playground.lessons.model import (
    Break,
    Compare,
    Exercise,
    Figure,
    Lesson,
    Measure,
    Named,
    Scene,
    Slider,
    Steps,
)
from playground.lessons.notebook.controls import controls_of, scene_at
from playground.lessons.read import read_lesson
from playground.markup import tag
from playground.paths import GLSL
from playground.sketch.text_overrides import with_texts

T = TypeVar("T")


_THREAD = ThreadPoolExecutor(1, thread_name_prefix="lesson")


@cache
def _engine() -> Engine:
    return headless()


def on_engine(work: Callable[[Engine], T]) -> T:
    """Return what some work gives with the engine that all lessons of this process draw with.

    The engine has a thread of its own: a context draws in one thread only, and a notebook
    answers what is dragged in another than its cells run in.
    """
    return _THREAD.submit(lambda: work(_engine())).result()


def open_lesson(name: str, language: str = SOURCE) -> NotebookLesson:
    """Return a lesson for a notebook; raise ``SketchError`` for a name or language there is not."""
    return NotebookLesson(read_lesson(name, language))


@dataclass(frozen=True, eq=False)
class Mended(Frame):
    """The picture that mended lines make, with a word on whether it is the whole one."""

    word: str = ""

    def _repr_html_(self) -> str:
        source = f"data:image/png;base64,{b64encode(self._repr_png_()).decode()}"
        return tag("p", self.word) + tag("img", src=source, alt=self.word)


class NotebookLesson:
    """A lesson whose blocks can be shown one by one."""

    def __init__(self, lesson: Lesson) -> None:
        self.lesson = lesson
        self.words: Mapping[str, str] = interface_words(lesson.language)

    def show(self, name: str) -> Any:
        """Return what a notebook shows of a block: a picture, with sliders where it has some.

        Raises ``SketchError`` for a block there is not, or one without a picture.
        """
        block = self._block(name)
        if isinstance(block, Figure | Steps | Slider | Compare):
            return self._dragged(block)
        if isinstance(block, Break):
            return self._frame(broken(block))
        if isinstance(block, Exercise) and block.scene:
            return self._frame(block.scene)
        raise SketchError(f"block '{name}' of lesson '{self.lesson.name}' has no picture")

    def measure(self, name: str) -> float:
        """Return the number of a measure, computed now."""
        block = self._block(name)
        if not isinstance(block, Measure):
            raise SketchError(f"block '{name}' of lesson '{self.lesson.name}' measures nothing")
        return on_engine(lambda engine: measured(engine, block)).value

    def mend(self, name: str, lines: str) -> Mended:
        """Return the picture that a fault's shader makes with other lines in place of the faulty ones.

        Raises ``ShaderError`` naming what is wrong with the lines.
        """
        block = self._block(name)
        if not isinstance(block, Break) or block.scene is None:
            raise SketchError(f"block '{name}' of lesson '{self.lesson.name}' is no fault to mend")
        text = region(block).with_lines(lines)
        path = str((GLSL / block.file).resolve())
        sketch = block.scene.sketch.plainly()  # what is compared is the text, not a fast variant
        tried = replace(block.scene, sketch=with_texts(sketch, {path: text}), plain=False)
        frame, whole = self._frame(tried), self._frame(replace(block.scene, sketch=sketch))
        same = bool((frame.array == whole.array).all())
        return Mended(frame.array, frame.sketch, frame.time, self.words["mended" if same else "not_yet"])

    def _block(self, name: str) -> Named:
        named = self.lesson.named
        if name not in named:
            raise SketchError(f"lesson '{self.lesson.name}' has no block '{name}'{nearest(name, named)}")
        return named[name]

    def _frame(self, scene: Scene) -> Frame:
        return on_engine(lambda engine: draw(engine, scene))

    def _dragged(self, block: Figure | Steps | Slider | Compare) -> Any:
        controls = controls_of(block, self.lesson.language, self.words)

        def png(values: Mapping[str, float]) -> bytes:
            return self._frame(scene_at(block, values))._repr_png_()

        if not controls:
            return self._frame(scene_at(block, {}))
        try:
            from playground.lessons.notebook.widget import PictureWidget
        except ModuleNotFoundError:
            return self._frame(scene_at(block, {control.key: control.value for control in controls}))
        return PictureWidget(png, controls, block.alt)
