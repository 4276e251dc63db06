"""What a student begins from and hands in for a task, and the picture that it makes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TypeGuard

from playground.course.language import Said
from playground.course.library import HERE
from playground.course.model import Block, Challenge, Exercise, Lesson, Scene, Task
from playground.errors import ParameterError, nearest
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
