"""What a student begins from and hands in for a task; judge it against the model answer; say what differs.

Nothing that a student hands in raises: a text that is wrong, or that lacks a parameter, is a verdict too. A
work that never ends is its caller's to stop: ``judging`` judges in processes that may be killed. No
sentence gives the answer away.
"""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, TypeGuard

import numpy as np
from numpy.typing import NDArray

from playground.course.library import HERE, Labels, Said, decimal, in_language, labels
from playground.course.measures import NoNumberError, measured, spelled
from playground.course.model import Block, Challenge, Check, Exercise, Lesson, Question, Scene, Task
from playground.course.scenes import draw
from playground.engine.engine import Engine
from playground.errors import Diagnostic, ParameterError, PlaygroundError, nearest
from playground.paths import GLSL
from playground.shader.parameter import spell
from playground.shader.source import read_text
from playground.sketch.flatten import flatten
from playground.sketch.model import Sketch, Value, kernels_of
from playground.sketch.replace_technique import with_texts


def checks_itself(block: Block) -> TypeGuard[Exercise | Challenge]:
    """Return whether a block is an exercise that has checks, or a challenge."""
    return isinstance(block, Challenge) or (isinstance(block, Exercise) and bool(block.checks))


def asks_number(block: Block) -> TypeGuard[Question]:
    """Return whether a block is a question for a number of a trace."""
    return isinstance(block, Question) and block.of is not None


def tasks_of(lesson: Lesson) -> list[Exercise | Challenge | Question]:
    """List a lesson's exercises with checks, its challenges and its questions for a number, in its order."""
    return [block for block in lesson.blocks if checks_itself(block) or asks_number(block)]


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


def webp_of(picture: NDArray[np.uint8]) -> bytes:
    """Return a picture (h, w, 3 or 4) as WebP, without its alpha."""
    from PIL import Image  # the window does without

    stream = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(picture[..., :3])).save(stream, "WEBP", quality=80, method=4)
    return stream.getvalue()


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


SIDE = 240
"""Pixels of the longer side of the pictures that are compared."""

_DOWN, _ACROSS = ("top", "", "bottom"), ("left", "", "right")
_MIN_FRACTION = 0.6
"""Share of all that differs that lies in a third of a picture, to say that it lies there."""

_ROUNDING = 4 * float(np.finfo(np.float32).eps)
"""By how much, relatively, the texels of a constant texture may differ."""

Values = NDArray[np.float32]


@dataclass(frozen=True)
class Wanted:
    """What the model answer gives for a check: a picture, or a texture; neither for a measure."""

    picture: Picture | None = None
    texture: Values | None = None


def judge(
    engine: Engine, exercise: Exercise, work: Work, expected: tuple[Wanted, ...] | None = None
) -> Verdict:
    """Return what comes of a work; ``expected``, from ``answers``, saves drawing the answer again.

    Raises ``PlaygroundError`` only where it is not the student's doing: no OpenGL, an exercise whose
    answer cannot be drawn.
    """
    expected = answers(engine, exercise) if expected is None else expected
    try:
        draw(engine, small(scene_of(exercise, work)))
    except PlaygroundError as error:
        return Verdict((), error.diagnostics, 0.0, exercise.points)
    results = tuple(
        _result(engine, exercise, work, check, expected_result)
        for check, expected_result in zip(exercise.checks, expected, strict=True)
    )
    passed = sum(result.passed for result in results)
    return Verdict(results, (), round(exercise.points * passed / len(results), 2), exercise.points)


def answers(engine: Engine, exercise: Exercise) -> tuple[Wanted, ...]:
    """Return what the model answer gives for each check; raise as ``Engine.render`` does."""
    expected = []
    for check in exercise.checks:
        scene = small(wanted_scene(exercise, check.at))
        if check.measure is not None:
            expected.append(Wanted())
        elif check.of:
            expected.append(Wanted(texture=_read(engine, scene, check.of)))
        else:
            expected.append(Wanted(picture=_drawn(engine, scene)))
    return tuple(expected)


def compare(check: Check, mine: Wanted, expected: Wanted) -> CheckResult:
    """Return what comes of a check of a picture or a texture."""
    if expected.picture is not None:
        assert mine.picture is not None
        return _compare_pictures(check, mine.picture, expected.picture)
    assert mine.texture is not None and expected.texture is not None
    return _compare_textures(check, mine.texture, expected.texture)


def small(scene: Scene, side: int = SIDE) -> Scene:
    """Return a picture with at most ``side`` pixels on its longer side."""
    times = max(max(scene.pixels) / side, 1.0)
    width, height = (max(round(pixels / times), 16) for pixels in scene.pixels)
    return replace(scene, pixels=(width, height))


def _result(engine: Engine, exercise: Exercise, work: Work, check: Check, expected: Wanted) -> CheckResult:
    try:
        whole = scene_of(exercise, work, check.at)
        if check.measure is not None:
            return _measure(engine, check, whole)
        scene = small(whole)
        if check.of:
            return compare(check, Wanted(texture=_read(engine, scene, check.of)), expected)
        return compare(check, Wanted(picture=_drawn(engine, scene)), expected)
    except PlaygroundError as error:
        # The words of a value that is refused have the value, which may be hidden.
        tells = check.hidden and isinstance(error, ParameterError) and not isinstance(error, LackingParameter)
        mistake = Said("a parameter does not take its value") if tells else error.diagnostics[0].message
        return CheckResult(check, False, float("inf"), mistake=mistake)


def _drawn(engine: Engine, scene: Scene) -> Picture:
    return np.ascontiguousarray(draw(engine, scene).array[..., :3])


def _read(engine: Engine, scene: Scene, of: str) -> Values:
    at: dict[str, Any] = {"size": scene.pixels, "time": scene.time, "steps": dict(scene.steps)}
    return engine.read(scene.sketch, of, **at)


def _measure(engine: Engine, check: Check, scene: Scene) -> CheckResult:
    """Measure at the scene's own pixels, as the lesson does: triangles depend on the frame's size."""
    measure = check.measure
    assert measure is not None and measure.between is not None
    try:
        with np.errstate(all="ignore"):  # a flat texture has no correlation: 0/0
            value = measured(engine, replace(measure, scene=scene)).value
    except NoNumberError:
        return CheckResult(check, False, math.nan)
    low, high = measure.between
    return CheckResult(check, low <= value <= high, value)


def _compare_pictures(check: Check, mine: Picture, expected: Picture) -> CheckResult:
    share = share_differing(mine, expected)
    passed = share <= check.tolerance
    if mine.shape != expected.shape:
        sizes = mine.shape[1::-1], expected.shape[1::-1]
        return CheckResult(check, False, share, sizes=sizes, mine=mine, expected=expected)
    bias = float((mine.astype(np.float64) - expected).mean())
    region = _place(differing(mine, expected).astype(np.float64))
    return CheckResult(check, passed, share, bias, region, mine=mine, expected=expected)


def _compare_textures(check: Check, mine: Values, expected: Values) -> CheckResult:
    result = CheckResult(
        check, False, float("inf"), mine=_as_picture(mine, expected), expected=_as_picture(expected, expected)
    )
    if mine.shape != expected.shape:
        return replace(result, sizes=(_size(mine), _size(expected)))
    finite = np.isfinite(mine)
    if not finite.all():
        count = int((~finite.reshape(*mine.shape[:2], -1).all(axis=-1)).sum())
        return replace(result, not_finite=count)
    apart = mine.astype(np.float64) - expected
    by_texel = np.abs(apart).reshape(*mine.shape[:2], -1).max(axis=-1)
    largest = float(by_texel.max())
    region = _place(np.where(by_texel > check.tolerance, by_texel, 0.0)[::-1])
    passed, bias = largest <= check.tolerance, float(apart.mean())
    return replace(result, passed=passed, difference=largest, bias=bias, region=region)


def _size(values: Values) -> tuple[int, ...]:
    """Return width, height, and channels of a texture."""
    return (values.shape[1], values.shape[0], values.shape[2] if values.ndim > 2 else 1)


def _as_picture(values: Values, expected: Values) -> Picture:
    """Return a texture in grey or colour, from the answer's lowest to its highest value; north is up.

    An answer that is the same everywhere is shown as it is: from 0 to 1, or to itself where it is outside.
    """
    low, high = float(expected.min()), float(expected.max())
    if high - low <= _ROUNDING * max(abs(low), abs(high)):
        low, high = min(low, 0.0), max(high, 1.0)
    clean = np.nan_to_num(values, nan=low, posinf=high, neginf=low)
    grey = np.clip((clean - low) / (high - low), 0.0, 1.0)[::-1]
    channels = grey[..., None] if grey.ndim == 2 else grey
    if channels.shape[2] < 3:
        channels = np.repeat(channels[..., :1], 3, axis=2)
    return np.ascontiguousarray((channels[..., :3] * 255.0 + 0.5).astype(np.uint8))


def _place(amount: NDArray[np.float64]) -> str:
    """Return where in a picture, top row first, most of it is, as "top-left", "left" or "middle"; else ""."""
    total = float(amount.sum())
    if not total:
        return ""
    result = []
    for axis, names in ((0, _DOWN), (1, _ACROSS)):
        thirds = [float(part.sum()) / total for part in np.array_split(amount, 3, axis=axis)]
        result.append(
            next((name for name, part in zip(names, thirds, strict=True) if part > _MIN_FRACTION), None)
        )
    down, across = result
    if down == across:
        return "middle" if down == "" else ""
    return "-".join(filter(None, (down, across)))


@dataclass(frozen=True, eq=False)
class Match:
    """How near a work is to the picture of a challenge."""

    score: float  # 0..100
    goal: int
    target: Picture | None  # None where its process ended
    mine: Picture | None = None
    diagnostics: tuple[Diagnostic, ...] = ()  # why nothing could be drawn

    @property
    def solved(self) -> bool:
        """Whether it is near enough."""
        return self.score >= self.goal


@dataclass(frozen=True, eq=False)
class Ends:
    """The two pictures that a score lies between."""

    target: Picture
    begin: Picture


def ends_of(engine: Engine, task: Challenge, side: int = SIDE) -> Ends:
    """Draw the picture to match and the one to begin from; ``side`` is the longer one, in pixels."""
    scenes = wanted_scene(task), scene_of(task, starter(task))
    return Ends(*(_drawn(engine, small(scene, side)) for scene in scenes))


def match(engine: Engine, task: Challenge, work: Work, ends: Ends | None = None, side: int = SIDE) -> Match:
    """Return how near a work is; a mistake in it is an answer too, with no score.

    ``ends``, from ``ends_of`` with the same ``side``, saves drawing them again. Raises ``PlaygroundError``
    only where it is not the student's doing.
    """
    ends = ends_of(engine, task, side) if ends is None else ends
    try:
        mine = _drawn(engine, small(scene_of(task, work), side))
    except PlaygroundError as error:
        return Match(0.0, task.goal, ends.target, diagnostics=error.diagnostics)
    return Match(score(ends.target, ends.begin, mine), task.goal, ends.target, mine)


_BRIGHTER = 1.0  # level of 255, in the mean, from which a picture is called brighter or darker


def sentences(verdict: Verdict, language: str) -> list[str]:
    """Return a sentence for each check, or for each mistake that kept the work from being drawn."""
    if verdict.diagnostics:
        return [str(diagnostic) for diagnostic in verdict.diagnostics]
    return [sentence_of(result, language) for result in verdict.results]


def points_of(verdict: Verdict, language: str) -> str:
    """Return the points as "1.5 of 2 points"; in French as "1,5 point sur 2": its plural begins at two."""
    several = verdict.points >= 2 if language == "fr" else verdict.of > 1
    key = "points" if several else "point"
    return labels("tasks", language)(key, got=_number(verdict.points, language), of=verdict.of)


def score_of(match: Match, language: str) -> str:
    """Return how near a challenge's picture is as "Score 87 of 100; solved from 95."."""
    return labels("tasks", language)("score_of", score=int(match.score), goal=match.goal)


def sentence_of(result: CheckResult, language: str) -> str:
    """Return what comes of one check as a sentence."""
    say, check = labels("tasks", language), result.check
    settings = ", ".join(f"{path} = {decimal(spell(value), language)}" for path, value in check.at)
    where = say["hidden"] if check.hidden else say("at", at=settings) if check.at else ""
    message = _found(result, say, language)
    return f"{where}{message}" if where else f"{message[0].upper()}{message[1:]}"


def _found(result: CheckResult, say: Labels, language: str) -> str:
    check = result.check
    if result.mistake:
        return say("mistake", mistake=in_language(result.mistake, language).rstrip("."))
    if check.measure is not None:
        return _of_measure(result, say, language)
    kind, of = "texture" if check.of else "picture", f"`{check.of}`"
    if result.passed:
        return say(f"right_{kind}", of=of)
    if result.sizes:
        mine, expected = (_size_text(size, say) for size in result.sizes)
        return say("size" if check.of else "picture_size", of=of, mine=mine, wanted=expected)
    if result.not_finite:
        return say(
            "not_finite" if result.not_finite > 1 else "not_finite_one", of=of, count=result.not_finite
        )
    region = say[f"{'map' if check.of else 'place'}_{result.region}"] if result.region else ""
    least = check.tolerance if check.of else _BRIGHTER
    more = "more" if result.bias > 0 else "less"
    bias = say[f"bias_{kind}_{more}"] if abs(result.bias) > least else ""
    by, tolerance = (_number(value, language) for value in (result.difference, check.tolerance))
    share = decimal(spelled(100.0 * result.difference, 2, "%"), language)
    return say(f"wrong_{kind}", of=of, share=share, by=by, tolerance=tolerance, place=region, bias=bias)


def _of_measure(result: CheckResult, say: Labels, language: str) -> str:
    check, measure = result.check, result.check.measure
    assert measure is not None and measure.between is not None
    what = say[f"measure_{measure.what}"]
    if not math.isfinite(result.difference):
        return say("no_value", what=what, of=f"`{check.of}`")
    low, high, value = (
        decimal(spelled(number, 3, measure.unit), language)
        for number in (*measure.between, result.difference)
    )
    hidden = "hidden_" if check.hidden else ""
    key = f"{hidden}{'right' if result.passed else 'wrong'}_measure"
    return say(key, what=what, of=f"`{check.of}`", value=value, low=low, high=high)


def _size_text(size: tuple[int, ...], say: Labels) -> str:
    if len(size) == 2:
        return say("texels", width=size[0], height=size[1])
    return say("channels", width=size[0], height=size[1], channels=size[2])


def _number(value: float, language: str) -> str:
    return decimal(f"{value:.3g}", language)
