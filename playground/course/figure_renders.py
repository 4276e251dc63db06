"""List the pictures of a lesson, and draw them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from playground.course import model
from playground.engine.engine import Engine
from playground.engine.frame import Frame
from playground.errors import SketchError
from playground.paths import GLSL
from playground.shader.source import read_text
from playground.sketch.model import Shot, kernels_of
from playground.sketch.replace_technique import with_texts

SMALL = 3
"""How many times smaller, each way, the pictures are that tests compare."""


@dataclass(frozen=True)
class Picture:
    """One picture of a lesson."""

    name: str  # in the lesson: "land", "smoothing-3", "fault-broken"
    scene: model.Scene
    alt: str = ""

    @property
    def shot(self) -> Shot:
        """The picture as a shot of its sketch, which is set already."""
        scene = self.scene
        return Shot(self.name, scene.pixels, scene.time, steps=scene.steps)

    def smaller(self, times: int = SMALL) -> Picture:
        """Return the same picture with fewer pixels."""
        width, height = self.scene.pixels
        pixels = (max(width // times, 16), max(height // times, 16))
        return replace(self, scene=replace(self.scene, pixels=pixels))


def pictures_of(lesson: model.Lesson) -> list[Picture]:
    """List all pictures of a lesson, in its order."""
    return [picture for block in lesson.blocks for picture in pictures_in(block)]


def pictures_in(block: model.Block) -> Iterator[Picture]:
    """Yield the pictures of a block: of a series each, of a bug the correct one and the broken one."""
    if isinstance(block, model.Figure) and block.scene:
        yield Picture(block.name, block.scene, block.alt)
    elif isinstance(block, model.Steps | model.Slider | model.Compare):
        for index, scene in enumerate(block.scenes):
            yield Picture(f"{block.name}-{index}", scene, block.alt)
    elif isinstance(block, model.Break) and block.scene:
        yield Picture(block.name, block.scene)
        yield Picture(f"{block.name}-broken", broken(block), block.alt)
    elif isinstance(block, model.Exercise | model.Challenge) and block.scene:
        yield Picture(block.name, block.scene, block.alt)


def broken(block: model.Break) -> model.Scene:
    """Return the picture of a block with its bug in it.

    Raises ``SketchError`` where what the bug replaces is not there exactly once, or where
    the sketch does not use the file; ``ShaderError`` where no kernel is left.
    """
    assert block.scene is not None
    path = str((GLSL / block.file).resolve())
    sketch = block.scene.sketch
    if path not in {file for _, kernel in kernels_of(sketch.graph) for file in kernel.files}:
        raise _error(block, f"sketch {sketch.name} does not use {block.file}")
    return replace(block.scene, sketch=with_texts(sketch, {path: with_bug(block)}).plainly(), plain=False)


def with_bug(block: model.Break, text: str | None = None) -> str:
    """Return the text of a block's file with its bug; ``text`` replaces what is in the file."""
    text = read_text(GLSL / block.file) if text is None else text
    count = text.count(block.find)
    if not block.find or count != 1:
        raise _error(block, f"find: expected once in {block.file}, found {count} times")
    if block.find == block.put:
        raise _error(block, "find and put are the same")
    return text.replace(block.find, block.put)


def draw(engine: Engine, scene: model.Scene) -> Frame:
    """Draw a picture; raise as ``Engine.render`` does."""
    return engine.render(scene.sketch, size=scene.pixels, time=scene.time, steps=dict(scene.steps))


def _error(block: model.Break, message: str) -> SketchError:
    return SketchError(f"break '{block.name}': {message}", line=block.line)
