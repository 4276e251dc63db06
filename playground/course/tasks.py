"""What a student begins from and hands in for a task, its picture, and what came of judging it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeGuard

import numpy as np
from numpy.typing import NDArray

from playground.course.library import HERE, Said
from playground.course.model import Block, Challenge, Check, Exercise, Lesson, Scene, Task
from playground.errors import Diagnostic, ParameterError, nearest
from playground.paths import GLSL
from playground.shader.source import read_text
from playground.sketch.flatten import flatten
from playground.sketch.model import Sketch, Value, kernels_of
from playground.sketch.replace_technique import with_texts


def checks_itself(block: Block) -> TypeGuard[Exercise | Challenge]:
    """Return whether a block is an exercise that has checks, or a challenge."""
    return isinstance(block, Challenge) or (isinstance(block, Exercise) and bool(block.checks))


def tasks_of(lesson: Lesson) -> list[Exercise | Challenge]:
    """List a lesson's exercises that have checks, and its challenges, in its order."""
    return [block for block in lesson.blocks if checks_itself(block)]


EXERCISES = HERE / "exercises"
"""Starters and model answers, in a folder for each lesson."""


def path_of(task: Task) -> Path:
    """Return the absolute path of the file that the student's text replaces."""
    return (GLSL / task.file).resolve()


def starter_text(task: Task) -> str:
    """Return what a student begins from; "" for a task of values."""
    return _text(task, task.start)


def answer_text(task: Task) -> str:
    """Return the model answer; "" for a task of values."""
    return _text(task, task.answer)


def _text(task: Task, own: str) -> str:
    if not task.file:
        return ""
    return read_text(EXERCISES / own if own else path_of(task))


class LackingParameter(ParameterError):
    """A kernel has not a parameter that its task sets."""


@dataclass(frozen=True)
class Work:
    """What a student hands in."""

    text: str | None = None  # of the task's file; None: its starter
    values: Mapping[str, Value] = field(default_factory=dict)  # of its sliders; others are left as they begin


def starter(task: Task) -> Work:
    """Return the work of a student who has done nothing."""
    return Work(starter_text(task) if task.file else None)


def answer(task: Task) -> Work:
    """Return the model answer."""
    assert task.scene is not None
    text = answer_text(task) if task.file else None
    return Work(text, {path: value for path, value in task.scene.values if path in task.sliders})


def wanted_scene(task: Task, at: tuple[tuple[str, Value], ...] = ()) -> Scene:
    """Return the answer's picture, at values over its own."""
    assert task.scene is not None
    return _with_values(task.scene, dict(at))


def scene_of(task: Task, work: Work, at: tuple[tuple[str, Value], ...] = ()) -> Scene:
    """Return the picture that a work makes, at values over its own.

    Raises ``ParameterError`` for a value that the task does not ask for, or that a kernel does not take,
    and ``ShaderError`` or ``DataError`` for a text that makes no kernel.
    """
    scene = task.begin
    assert scene is not None
    if strange := [path for path in work.values if path not in task.sliders]:
        raise ParameterError(f"'{strange[0]}' is not set in this task{nearest(strange[0], task.sliders)}")
    values = dict(work.values) if not task.file or isinstance(task, Challenge) else {}
    if task.file:
        text = starter_text(task) if work.text is None else work.text
        return _of_kernel(task, text, {**values, **dict(at)})
    return _with_values(scene, {**values, **dict(at)})


def _of_kernel(task: Task, text: str, values: Mapping[str, Value]) -> Scene:
    scene = task.begin
    assert scene is not None
    before, path = scene.sketch, str(path_of(task))
    sketch = with_texts(replace(before, overrides=()), {path: text}).plainly()
    try:  # set again: a value that the answer takes may be none of this kernel's
        sketch = sketch.with_values({**dict(before.overrides), **values})
        flatten(sketch)
    except ParameterError:
        if lacking := _parameters(before, path) - _parameters(sketch, path):
            message = Said("the kernel has no parameter '{name}', which is set here", name=min(lacking))
            raise LackingParameter(message) from None
        raise
    return replace(scene, sketch=sketch, plain=False)


def _parameters(sketch: Sketch, path: str) -> set[str]:
    """Return the names of the parameters that the kernels of a file have."""
    kernels = [kernel for _, kernel in kernels_of(sketch.graph) if kernel.path == path]
    return {parameter.name for kernel in kernels for parameter in kernel.parameters}


def _with_values(scene: Scene, values: Mapping[str, Value]) -> Scene:
    if not values:
        return scene
    return replace(scene, sketch=scene.sketch.with_values(values), plain=False)


Picture = NDArray[np.uint8]
"""(h, w, 3), top row first."""


@dataclass(frozen=True, eq=False)
class CheckResult:
    """What came of one check."""

    check: Check
    passed: bool
    # Fraction of the pixels that differ, or the largest difference of a texel; of a measure its
    # value, NaN where it has none.
    difference: float = 0.0
    bias: float = 0.0  # mean of the work's minus the answer's: levels of 255, or the texture's unit
    region: str = ""  # where most of it differs, as "top-left" or "middle"; "": in no third of it
    not_finite: int = 0  # texels of the work that are no numbers
    sizes: tuple[tuple[int, ...], tuple[int, ...]] | None = None  # the work's and the answer's, if not equal
    mistake: str = ""  # why it could not be drawn at these values
    # The work and what is asked for, to compare; those of a check that is hidden are for the teacher.
    mine: Picture | None = None
    expected: Picture | None = None


@dataclass(frozen=True, eq=False)
class Verdict:
    """What came of a work."""

    results: tuple[CheckResult, ...]
    diagnostics: tuple[Diagnostic, ...]  # why nothing could be drawn: then there are no results
    points: float
    of: int  # points

    @property
    def passed(self) -> bool:
        """Whether it has all points."""
        return self.points == self.of

    @property
    def visible(self) -> tuple[CheckResult, ...]:
        """The results whose pictures a student may see."""
        return tuple(result for result in self.results if not result.check.hidden)


LEVELS = 3
"""Levels of 255 that no eye sees."""

SHARE = 0.002
"""Share of all pixels that may differ by more in pictures that are the same."""


def differing(first: NDArray[np.uint8], other: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Return which pixels of two pictures (h, w, 3 or 4) of one size differ in a colour; alpha aside."""
    apart = np.abs(first[..., :3].astype(np.int16) - other[..., :3])
    differs: NDArray[np.bool_] = apart.max(axis=-1) > LEVELS
    return differs


def share_differing(first: NDArray[np.uint8], other: NDArray[np.uint8]) -> float:
    """Return the fraction of the pixels that differ, 0..1; 1 for pictures of two sizes."""
    return float(differing(first, other).mean()) if first.shape[:2] == other.shape[:2] else 1.0


def mean_difference(first: NDArray[np.uint8], other: NDArray[np.uint8]) -> float:
    """Return the mean absolute difference of two pictures of one size in red, green and blue, in levels."""
    return float(np.abs(first[..., :3].astype(np.float64) - other[..., :3]).mean())


def difference_map(mine: Picture, expected: Picture) -> Picture:
    """Return the pixels that differ in white to red, by how much, over the dimmed picture asked for."""
    apart = np.abs(mine.astype(np.int16) - expected).max(axis=-1)
    picture: Picture = (expected.mean(axis=-1, keepdims=True) * 0.35).astype(np.uint8).repeat(3, axis=-1)
    where = differing(mine, expected)
    strong = np.clip(apart[where] * 2 + 80, 0, 255).astype(np.uint8)
    picture[where] = np.stack([np.full_like(strong, 255), 255 - strong, 255 - strong], axis=-1)
    return picture


def score(target: Picture, begin: Picture, mine: Picture) -> float:
    """Return 100 for the picture asked for, 0 for the one to begin from or one farther off, else between.

    Pictures are uint8 (h, w, 3 or 4) of one size; between them the score is linear in the mean absolute
    difference of the colours. Raises ``ValueError`` for pictures of several sizes.
    """
    if len({picture.shape[:2] for picture in (target, begin, mine)}) > 1:
        raise ValueError("pictures that are compared have one size")
    if share_differing(target, mine) <= SHARE:
        return 100.0
    whole = mean_difference(target, begin)
    return 100.0 * max(0.0, 1.0 - mean_difference(target, mine) / whole) if whole else 0.0
