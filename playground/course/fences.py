"""Read a fenced block of a lesson: its first word is its kind, its second its name, its lines TOML."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from playground.course import model
from playground.course.document import Fence, Piece, check_path, measure_of, shader
from playground.course.scenes import FRAME, STATE, Sketches, read_scene, with_steps, with_value
from playground.course.tasks import EXERCISES, SHARE, answer_text, path_of, starter_text
from playground.errors import DataError, ShaderError, SketchError, nearest
from playground.paths import GLSL
from playground.shader.parameter import spell
from playground.sketch.assign import TERRAIN_KEYS, check_value, resolve
from playground.sketch.flatten import flatten
from playground.sketch.model import Value, kernels_of
from playground.sketch.toml_table import TomlFile

_NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")


def open_fence(piece: Piece, path: Path, line: int, sketches: Sketches) -> Fence:
    """Return the fence that a piece of a file is; raise ``SketchError`` if its head or its TOML is wrong."""
    kind, _, name = piece.info.partition(" ")
    if kind not in READERS:
        hint = nearest(kind, READERS)
        raise SketchError(f"no block of a lesson is called '{kind}'{hint}", file=path, line=line)
    if not _NAME.fullmatch(name):
        message = f"{kind} '{name}': behind its kind a block has a name of small letters, digits and -"
        raise SketchError(message, file=path, line=line)
    file = TomlFile(path, GLSL / "sketches", piece.inside, line)
    return Fence(kind, name, piece, line, file, sketches)


def read_fence(fence: Fence) -> model.Named:
    """Build the block that a fence describes; raise ``SketchError`` at the key that is wrong."""
    return READERS[fence.kind](fence)


def _figure(fence: Fence) -> model.Figure:
    fence.only(model.Figure, *STATE, "sliders")
    scene, sliders = fence.scene(), fence.texts("sliders")
    for path in sliders:
        check_path(fence, scene, path, "sliders")
    return fence.block(model.Figure, scene=scene, sliders=sliders)


def _steps(fence: Fence) -> model.Steps:
    from playground.engine.planner import repeated_in, repeats_of  # it needs what is loaded by then only

    fence.only(model.Steps, *STATE, "passes", "iterations")
    scene = fence.scene(FRAME)
    passes = fence.texts("passes")
    if not passes:
        raise fence.error('a step block needs passes = ["…"]: the repeated passes that it stops')
    with fence.located("passes"):
        repeated = [repeated_in(scene.sketch, path) for path in passes]
        most = min(repeats_of(scene.sketch, frame_size=scene.pixels, time=scene.time)[p] for p in repeated)
    iterations = fence.take("iterations", list, list(range(most + 1)))
    if not iterations or not all(type(each) is int and 0 <= each <= most for each in iterations):
        message = f"iterations = {spell(iterations)}: expected whole numbers from 0 to {most}"
        raise fence.error(message, "iterations")
    captions = fence.texts("captions")
    if captions and len(captions) != len(iterations):
        raise fence.error(f"captions: {len(captions)} for {len(iterations)} iterations", "captions")
    scenes = tuple(with_steps(scene, dict.fromkeys(passes, iteration)) for iteration in iterations)
    return fence.block(model.Steps, scenes=scenes, passes=passes, iterations=tuple(iterations))


def _slider(fence: Fence) -> model.Slider:
    fence.only(model.Slider, *STATE, "parameter", "values", "from", "to", "frames")
    scene = fence.scene(FRAME)
    parameter = fence.markdown("parameter")
    check_path(fence, scene, parameter, "parameter")
    values = _swept(fence, scene, parameter)
    scenes = tuple(with_value(scene, parameter, value) for value in values)
    return fence.block(model.Slider, scenes=scenes, parameter=parameter, values=values)


def _swept(fence: Fence, scene: model.Scene, parameter: str) -> tuple[Value, ...]:
    values = fence.take("values", list, None)
    if values is None:
        low, high = (fence.take(key, float, None) for key in ("from", "to"))
        frames = fence.take("frames", int, 9)
        if low is None or high is None or low == high or not 2 <= frames <= 64:
            raise fence.error("a slider needs values = […], or from, to and frames (2 to 64)")
        whole = resolve(scene.sketch.graph, parameter)[0].parameter.type in ("int", "uint")
        values = [low + (high - low) * i / (frames - 1) for i in range(frames)]
        values = [round(v) if whole else float(f"{v:.6g}") for v in values]
    if len(values) < 2:
        raise fence.error("values: a slider has two or more", "values")
    with fence.located("values"):
        return tuple(check_value(scene.sketch, parameter, value) for value in values)


def _compare(fence: Fence) -> model.Compare:
    fence.only(model.Compare, *STATE, "variant")
    tables = fence.file.tables("variant")
    if len(tables) < 2:
        raise fence.error("a compare block has two or more [[variant]]")
    scenes = []
    for index, table in enumerate(tables):
        site = ("variant", index)
        fence.file.only(table, STATE, *site)
        scenes.append(read_scene(fence.file, table, site, fence.sketches, under=fence.state))
    labels = fence.texts("labels")
    if len(labels) != len(scenes):
        raise fence.error(f"labels: {len(labels)} for {len(scenes)} variants", "labels")
    if len({scene.pixels for scene in scenes}) > 1:
        raise fence.error("pictures that are compared have one size: set pixels")
    return fence.block(model.Compare, scenes=tuple(scenes))


def _code(fence: Fence) -> model.Code:
    fence.only(model.Code, "file", "anchor")
    return fence.block(model.Code, file=shader(fence), anchor=fence.markdown("anchor"))


_TRACED = ("pass", "texel", "iteration", "file", "anchor", "function", "call")
_NOT_TRACED = ("camera", "steps", "view", "range")
_LOOPED = ("loop", "variables", "rows", "digits")


def _trace(fence: Fence) -> model.Trace:
    fence.only(model.Trace, *(key for key in STATE if key not in _NOT_TRACED), *_TRACED, *_LOOPED)
    scene = fence.scene()
    with fence.located("pass"):
        path = flatten(scene.sketch).ref(fence.markdown("pass"), scene.sketch.name).path
    texel = fence.take("texel", list, None)
    if texel is None or len(texel) != 2 or not all(type(each) is int and each >= 0 for each in texel):
        expected = "expected texel = [column, row], counted from 0 in the south-west"
        raise fence.error(expected if texel is None else f"texel = {spell(texel)}: {expected}", "texel")
    iteration = fence.file.table.get("iteration", [])
    iteration = iteration if isinstance(iteration, list) else [iteration]
    if not all(type(each) is int and each >= 0 for each in iteration):
        expected = "expected a number from 0, or one for each loop around the pass, the outermost first"
        raise fence.error(f"iteration = {spell(fence.file.table['iteration'])}: {expected}", "iteration")
    call, digits = fence.take("call", int, 1), fence.take("digits", int, 4)
    if call < 1:
        raise fence.error(f"call = {call}: expected the number of a call, from 1", "call")
    if not 1 <= digits <= 7:
        raise fence.error(f"digits = {digits}: expected 1 to 7", "digits")
    loop, variables = fence.take("loop", str, ""), fence.texts("variables")
    rows = fence.take("rows", list, [])
    if not all(type(row) is int for row in rows):
        message = f"rows = {spell(rows)}: expected whole numbers, values of the loop's variable"
        raise fence.error(message, "rows")
    if loop and not (variables and rows):
        raise fence.error('a loop needs variables = ["…"] and rows = […]: the table on paper', "loop")
    if not loop and (variables or rows):
        key = "variables" if variables else "rows"
        raise fence.error(f'{key}: of which loop? give loop = "…", its variable', key)
    return fence.block(
        model.Trace,
        scene=scene,
        path=path,
        texel=(texel[0], texel[1]),
        iteration=tuple(iteration),
        file=shader(fence),
        anchor=fence.markdown("anchor"),
        function=fence.take("function", str, ""),
        call=call,
        loop=loop,
        variables=variables,
        rows=tuple(rows),
        digits=digits,
    )


def _break(fence: Fence) -> model.Break:
    fence.only(model.Break, *STATE, "file", "find", "put")
    find, put = (fence.take(key, str, "") for key in ("find", "put"))
    return fence.block(model.Break, scene=fence.scene(), file=shader(fence), find=find, put=put)


def _question(fence: Fence) -> model.Question:
    fence.only(model.Question, "right", "trace", "variable", "step", "points")
    choices, right = fence.texts("choices"), fence.take("right", int, -1)
    if choices and not 0 <= right < len(choices):
        raise fence.error(f"right = {right}: expected the place of a choice, 0 to {len(choices) - 1}")
    if right >= 0 and not choices:
        raise fence.error("right: there are no choices", "right")
    return fence.block(model.Question, right=right, **_asked(fence, bool(choices)))


def _asked(fence: Fence, has_choices: bool) -> dict[str, Any]:
    """Return the value of a trace that a question asks for, and its points; nothing for another question."""
    table = fence.file.table
    if "trace" not in table:
        for key in ("variable", "step", "points"):
            if key in table:
                raise fence.error(f'{key}: of which trace? give trace = "…", the name of a block', key)
        return {}
    if has_choices:
        raise fence.error("choices: the answer is a number of the trace", "choices")
    points = fence.take("points", int, 1)
    if not 1 <= points <= 100:
        raise fence.error(f"points = {points}: expected 1 to 100", "points")
    asked = model.Asked(fence.markdown("trace"), fence.markdown("variable"), fence.take("step", int, None))
    return {"of": asked, "points": points}


def _measure(fence: Fence) -> model.Measure:
    fence.only(model.Measure, *STATE, "of", "what", "with", "over", "digits", "unit", "between")
    what, arguments, between = measure_of(fence, fence.file.table)
    over = fence.take("over", dict, None)
    if over is not None:
        fence.file.only(over, STATE, "over")
        over = read_scene(fence.file, over, ("over",), fence.sketches, under=fence.state)
    digits = fence.take("digits", int, 3)
    if not 1 <= digits <= 7:
        raise fence.error(f"digits = {digits}: expected 1 to 7", "digits")
    return fence.block(
        model.Measure,
        scene=fence.scene(),
        over=over,
        of=fence.take("of", str, "height"),
        what=what,
        arguments=arguments,
        digits=digits,
        unit=fence.take("unit", str, ""),
        between=between,
    )


TaskKind = TypeVar("TaskKind", bound=model.Task)

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


def _built(fence: Fence, kind: type[TaskKind], task: TaskKind, **fields: Any) -> TaskKind:
    """Return the block: what ``_task`` has found, its texts, and the fields of its own."""
    return fence.block(kind, **{name: getattr(task, name) for name in _OWN}, **fields)


def _task(fence: Fence, kind: type[TaskKind]) -> TaskKind:
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
    scene = _task_scene(fence, task, fence.state)
    if file and str(path_of(task)) not in {f for _, k in kernels_of(scene.sketch.graph) for f in k.files}:
        raise fence.error(f"file = '{file}': sketch {scene.sketch.name} does not use it", "file")
    return replace(task, scene=scene, begin=_begin(fence, task, scene))


def _begin(fence: Fence, task: model.Task, scene: model.Scene) -> model.Scene:
    """Return the picture that a student begins from, but for the text of a kernel."""
    answer, begin = (fence.take(key, dict, {}) for key in ("set", "begin"))
    for path in task.sliders:
        _check_task_path(fence, scene, path, "sliders")
    for path in answer:
        _check_task_path(fence, scene, path, "set", path)
    if not task.file and (lacking := sorted(set(task.sliders) - set(answer))):
        message = f"sliders: the answer sets no {', '.join(lacking)}; give it in set"
        raise fence.error(message, "sliders")
    for path in begin:
        _check_task_path(fence, scene, path, "begin", path)
        if path not in task.sliders:
            raise fence.error(f"begin: '{path}' is none of the sliders", "begin", path)
    if isinstance(task, model.Exercise) and task.file:  # the kernel is judged, at the answer's values
        return scene
    others = {path: value for path, value in answer.items() if path not in task.sliders}
    return _task_scene(fence, task, {**fence.state, "set": {**others, **begin}})


def _task_scene(fence: Fence, task: model.Task, state: Mapping[str, Any]) -> model.Scene:
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
        with fence.located(*key_path, "of"):
            flatten(scene.sketch).ref(of, scene.sketch.name)
    at = _at(fence, task, file.take(table, "at", dict, {}, *key_path), *key_path, "at")
    hidden = file.take(table, "hidden", bool, False, *key_path)
    if hidden and not at:
        message = "hidden = true: give at = { … }, values that the student is not shown"
        raise fence.error(message, *key_path, "hidden")
    tolerance = file.take(table, "tolerance", float, None if of else SHARE, *key_path)
    if measures:
        if "tolerance" in table:
            raise fence.error("tolerance: a measure lies between bounds", *key_path, "tolerance")
        return model.Check(0.0, at, hidden, of, _check_measure(fence, task, table, of, *key_path))
    if tolerance is None:
        message = f"a check of '{of}' needs tolerance = …: how far a value may be from the answer's"
        raise fence.error(message, *key_path)
    if tolerance < 0 or (tolerance >= 1 and not of):
        expected = "0 or more" if of else "a fraction of the pixels, from 0 to below 1"
        raise fence.error(f"tolerance = {spell(tolerance)}: expected {expected}", *key_path, "tolerance")
    return model.Check(tolerance, at, hidden, of)


def _check_measure(
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
        with fence.located(*slot, path):
            values.append((path, check_value(task.scene.sketch, path, value)))
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


def _check_task_path(fence: Fence, scene: model.Scene, path: str, *location: str) -> None:
    """Raise ``SketchError`` where the picture has no such parameter, and the terrain none either."""
    if path not in TERRAIN_KEYS:
        check_path(fence, scene, path, *location)


READERS: dict[str, Callable[[Fence], model.Named]] = {
    "figure": _figure,
    "step": _steps,
    "slider": _slider,
    "compare": _compare,
    "code": _code,
    "trace": _trace,
    "break": _break,
    "question": _question,
    "exercise": read_exercise,
    "challenge": read_challenge,
    "measure": _measure,
}
"""What reads each kind of block."""
