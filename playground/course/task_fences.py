"""Read the blocks that a student does something for: exercises and challenges, with their checks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, TypeVar

from playground.course import model
from playground.course.document import Fence, measure_of, shader
from playground.course.scenes import STATE, read_scene
from playground.course.tasks.verdict import SHARE
from playground.course.tasks.work import EXERCISES, answer_text, path_of, starter_text
from playground.errors import DataError, PlaygroundError, ShaderError, nearest
from playground.shader.parameter import spell
from playground.sketch.assign import TERRAIN_KEYS, check_value, resolve
from playground.sketch.flatten import flatten
from playground.sketch.model import Value, kernels_of

T = TypeVar("T", bound=model.Task)

_WORK = ("file", "start", "answer", "sliders")
_CHECK = ("at", "hidden", "tolerance")
_OWN = (*_WORK, "scene", "begin")
_MEASURE = ("what", "with", "between", "unit")


def read_exercise(fence: Fence) -> model.Exercise:
    """Build an exercise; raise ``SketchError`` at the key that is wrong."""
    fence.only(model.Exercise, *STATE, *_WORK, "points", "check")
    drawn = "sketch" in fence.file.table
    works = any(key in fence.file.table for key in (*_WORK, "check"))
    if works and not drawn:
        raise fence.error('an exercise that checks itself needs sketch = "…"')
    if not works and "points" in fence.file.table:
        raise fence.error("points: nothing here is checked; give file or sliders", "points")
    alt = fence.markdown("alt", needed=drawn)
    if not works:
        return fence.block(model.Exercise, scene=fence.scene() if drawn else None, alt=alt)
    task = _task(fence, model.Exercise)
    points = fence.take("points", int, 1)
    if not 1 <= points <= 100:
        raise fence.error(f"points = {points}: expected 1 to 100", "points")
    checks = tuple(_check(fence, task, index) for index in range(len(fence.file.tables("check"))))
    whole = (model.Check(SHARE),)
    return _built(fence, model.Exercise, task, alt=alt, checks=checks or whole, points=points)


def read_challenge(fence: Fence) -> model.Challenge:
    """Build a challenge; raise ``SketchError`` at the key that is wrong."""
    fence.only(model.Challenge, *STATE, *(key for key in _WORK if key != "answer"), "begin", "goal")
    task = _task(fence, model.Challenge)
    goal = fence.take("goal", int, 95)
    if not 1 <= goal <= 100:
        raise fence.error(f"goal = {goal}: expected a score, 1 to 100", "goal")
    return _built(fence, model.Challenge, task, goal=goal)


def _built(fence: Fence, kind: type[T], task: T, **fields: Any) -> T:
    """Return the block: what ``_task`` has found, its texts, and the fields of its own."""
    return fence.block(kind, **{name: getattr(task, name) for name in _OWN}, **fields)


def _task(fence: Fence, kind: type[T]) -> T:
    """Return a task of a kind without its texts: what is written or set, and its pictures."""
    sliders = fence.texts("sliders")
    start, answer = (fence.take(key, str, "") for key in ("start", "answer"))
    file = shader(fence) if "file" in fence.file.table else ""
    for key, name in (("start", start), ("answer", answer)):
        _check_text(fence, key, name, file)
    if file and not (start or answer):
        raise fence.error(f"file = '{file}': give its start, its answer, or both", "file")
    if not file and not sliders:
        what = 'give file = "…" or sliders = ["…"]'
        raise fence.error(f"what is to be done in this {fence.kind}? {what}")
    task = kind(
        line=fence.line,
        text=fence.piece.text,
        name=fence.name,
        file=file,
        start=start,
        answer=answer,
        sliders=sliders,
    )
    if file and starter_text(task) == answer_text(task):
        raise fence.error("start and answer are the same text", "start" if start else "answer")
    scene = _scene(fence, task, fence.state)
    if file and str(path_of(task)) not in {f for _, k in kernels_of(scene.sketch.graph) for f in k.files}:
        raise fence.error(f"file = '{file}': sketch {scene.sketch.name} does not use it", "file")
    return replace(task, scene=scene, begin=_begin(fence, task, scene))


def _begin(fence: Fence, task: model.Task, scene: model.Scene) -> model.Scene:
    """Return the picture that a student begins from, but for the text of a kernel."""
    answer, begin = (fence.take(key, dict, {}) for key in ("set", "begin"))
    for path in task.sliders:
        _check_path(fence, scene, path, "sliders")
    for path in answer:
        _check_path(fence, scene, path, "set", path)
    if not task.file and (lacking := sorted(set(task.sliders) - set(answer))):
        message = f"sliders: the answer sets no {', '.join(lacking)}; give it in set"
        raise fence.error(message, "sliders")
    for path in begin:
        _check_path(fence, scene, path, "begin", path)
        if path not in task.sliders:
            raise fence.error(f"begin: '{path}' is none of the sliders", "begin", path)
    if isinstance(task, model.Exercise) and task.file:  # the kernel is judged, at the answer's values
        return scene
    others = {path: value for path, value in answer.items() if path not in task.sliders}
    return _scene(fence, task, {**fence.state, "set": {**others, **begin}})


def _scene(fence: Fence, task: model.Task, state: Mapping[str, Any]) -> model.Scene:
    """Return the picture of a state, with the model answer's text."""
    texts = {str(path_of(task)): answer_text(task)} if task.file else None
    try:
        return read_scene(fence.file, state, (), fence.sketches, texts=texts)
    except (ShaderError, DataError) as error:
        raise fence.error(f"the model answer: {error.diagnostics[0]}", "answer") from None


def _check(fence: Fence, task: model.Exercise, index: int) -> model.Check:
    """Return a check; raise ``SketchError`` at the key that is wrong."""
    key_path, file, scene = ("check", index), fence.file, task.scene
    table = file.tables("check")[index]
    assert scene is not None
    measures = "what" in table or "between" in table
    file.only(table, [*_CHECK, "of", *(_MEASURE if measures else ())], *key_path)
    of = file.take(table, "of", str, "height" if measures else "", *key_path)
    if of:
        try:
            flatten(scene.sketch).ref(of, scene.sketch.name)
        except PlaygroundError as error:
            raise fence.error(error.diagnostics[0].message, *key_path, "of") from None
    at = _at(fence, task, file.take(table, "at", dict, {}, *key_path), *key_path, "at")
    hidden = file.take(table, "hidden", bool, False, *key_path)
    if hidden and not at:
        message = "hidden = true: give at = { … }, values that the student is not shown"
        raise fence.error(message, *key_path, "hidden")
    tolerance = file.take(table, "tolerance", float, None if of else SHARE, *key_path)
    if measures:
        if "tolerance" in table:
            raise fence.error("tolerance: a measure lies between bounds", *key_path, "tolerance")
        return model.Check(0.0, at, hidden, of, _measure(fence, task, table, of, *key_path))
    if tolerance is None:
        message = f"a check of '{of}' needs tolerance = …: how far a value may be from the answer's"
        raise fence.error(message, *key_path)
    if tolerance < 0 or (tolerance >= 1 and not of):
        expected = "0 or more" if of else "a fraction of the pixels, from 0 to below 1"
        raise fence.error(f"tolerance = {spell(tolerance)}: expected {expected}", *key_path, "tolerance")
    return model.Check(tolerance, at, hidden, of)


def _measure(
    fence: Fence, task: model.Exercise, table: Mapping[str, Any], of: str, *slot: str | int
) -> model.Measure:
    what, arguments, between = measure_of(fence, table, *slot)
    if between is None:
        raise fence.error("a check of a measure needs between = [lowest, highest]", *slot)
    return model.Measure(
        line=fence.file.line(*slot) or task.line,
        text="",
        name=task.name,
        of=of,
        what=what,
        arguments=arguments,
        unit=fence.file.take(table, "unit", str, "", *slot),
        between=between,
    )


def _at(
    fence: Fence, task: model.Exercise, arguments: Mapping[str, Any], *slot: str | int
) -> tuple[tuple[str, Value], ...]:
    """Return the values that a check sets; raise ``SketchError`` for one that it cannot."""
    assert task.scene is not None
    own = () if task.file else task.sliders
    values = []
    for path, value in arguments.items():
        try:
            values.append((path, check_value(task.scene.sketch, path, value)))
        except PlaygroundError as error:
            raise fence.error(error.diagnostics[0].message, *slot, path) from None
        if path in own:
            raise fence.error(f"at: '{path}' is what the student sets", *slot, path)
    return tuple(values)


def _check_text(fence: Fence, key: str, name: str, file: str) -> None:
    """Raise ``SketchError`` where there is no such starter or answer, or no kernel that it is of."""
    if not name:
        return
    if not file:
        raise fence.error(f'{key}: of which kernel? give file = "…" too', key)
    path = (EXERCISES / name).resolve()
    if not path.is_relative_to(EXERCISES) or not path.is_file():
        names = [each.relative_to(EXERCISES).as_posix() for each in EXERCISES.rglob("*.glsl")]
        raise fence.error(f"{key} = '{name}': not in course/exercises/{nearest(name, names)}", key)


def _check_path(fence: Fence, scene: model.Scene, path: str, *location: str) -> None:
    """Raise ``SketchError`` where the picture has no such parameter."""
    if path in TERRAIN_KEYS:
        return
    try:
        resolve(scene.sketch.graph, path)
    except PlaygroundError as error:
        raise fence.error(error.diagnostics[0].message, *location) from None
