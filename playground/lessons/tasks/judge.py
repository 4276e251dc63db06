"""Judge a work: draw it and the model answer at the values of each check, and compare them.

Nothing that a student hands in raises: a text that is wrong, or that lacks a parameter, is a
verdict too. A work that never ends is its caller's to stop: judge in a process that may be killed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.engine.engine import Engine
from playground.errors import ParameterError, PlaygroundError
from playground.lessons.figure_renders import draw
from playground.lessons.measuring import NoNumberError, measured
from playground.lessons.model import Check, Exercise, Scene
from playground.lessons.picture_difference import differing, share_differing
from playground.lessons.tasks.verdict import Picture, Result, Verdict
from playground.lessons.tasks.work import LackingParameter, Work, scene_of, wanted_scene
from playground.lessons.translatable import Said

SIDE = 240
"""Pixels of the longer side of the pictures that are compared."""

_DOWN, _ACROSS = ("top", "", "bottom"), ("left", "", "right")
_MOST = 0.6
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
    engine: Engine, exercise: Exercise, work: Work, wanted: tuple[Wanted, ...] | None = None
) -> Verdict:
    """Return what comes of a work; ``wanted``, from ``answers``, saves drawing the answer again.

    Raises ``PlaygroundError`` only where it is not the student's doing: no OpenGL, an exercise whose
    answer cannot be drawn.
    """
    wanted = answers(engine, exercise) if wanted is None else wanted
    try:
        draw(engine, small(scene_of(exercise, work)))
    except PlaygroundError as error:
        return Verdict((), error.diagnostics, 0.0, exercise.points)
    results = tuple(
        _result(engine, exercise, work, check, known)
        for check, known in zip(exercise.checks, wanted, strict=True)
    )
    passed = sum(result.passed for result in results)
    return Verdict(results, (), round(exercise.points * passed / len(results), 2), exercise.points)


def answers(engine: Engine, exercise: Exercise) -> tuple[Wanted, ...]:
    """Return what the model answer gives for each check; raise as ``Engine.render`` does."""
    found = []
    for check in exercise.checks:
        scene = small(wanted_scene(exercise, check.at))
        if check.measure is not None:
            found.append(Wanted())
        elif check.of:
            found.append(Wanted(texture=_read(engine, scene, check.of)))
        else:
            found.append(Wanted(picture=_drawn(engine, scene)))
    return tuple(found)


def compare(check: Check, mine: Wanted, wanted: Wanted) -> Result:
    """Return what comes of a check of a picture or a texture."""
    if wanted.picture is not None:
        assert mine.picture is not None
        return _compare_pictures(check, mine.picture, wanted.picture)
    assert mine.texture is not None and wanted.texture is not None
    return _compare_textures(check, mine.texture, wanted.texture)


def small(scene: Scene, side: int = SIDE) -> Scene:
    """Return a picture with at most ``side`` pixels on its longer side."""
    times = max(max(scene.pixels) / side, 1.0)
    width, height = (max(round(pixels / times), 16) for pixels in scene.pixels)
    return replace(scene, pixels=(width, height))


def _result(engine: Engine, exercise: Exercise, work: Work, check: Check, wanted: Wanted) -> Result:
    try:
        whole = scene_of(exercise, work, check.at)
        if check.measure is not None:
            return _measure(engine, check, whole)
        scene = small(whole)
        if check.of:
            return compare(check, Wanted(texture=_read(engine, scene, check.of)), wanted)
        return compare(check, Wanted(picture=_drawn(engine, scene)), wanted)
    except PlaygroundError as error:
        # The words of a value that is refused have the value, which may be hidden.
        tells = check.hidden and isinstance(error, ParameterError) and not isinstance(error, LackingParameter)
        mistake = Said("a parameter does not take its value") if tells else error.diagnostics[0].message
        return Result(check, False, float("inf"), mistake=mistake)


def _drawn(engine: Engine, scene: Scene) -> Picture:
    return np.ascontiguousarray(draw(engine, scene).array[..., :3])


def _read(engine: Engine, scene: Scene, of: str) -> Values:
    at: dict[str, Any] = {"size": scene.pixels, "time": scene.time, "steps": dict(scene.steps)}
    return engine.read(scene.sketch, of, **at)


def _measure(engine: Engine, check: Check, scene: Scene) -> Result:
    """Measure at the scene's own pixels, as the lesson does: triangles depend on the frame's size."""
    measure = check.measure
    assert measure is not None and measure.between is not None
    try:
        with np.errstate(all="ignore"):  # a flat texture has no correlation: 0/0
            value = measured(engine, replace(measure, scene=scene)).value
    except NoNumberError:
        return Result(check, False, math.nan)
    low, high = measure.between
    return Result(check, low <= value <= high, value)


def _compare_pictures(check: Check, mine: Picture, wanted: Picture) -> Result:
    share = share_differing(mine, wanted)
    passed = share <= check.tolerance
    if mine.shape != wanted.shape:
        sizes = mine.shape[1::-1], wanted.shape[1::-1]
        return Result(check, False, share, sizes=sizes, mine=mine, wanted=wanted)
    bias = float((mine.astype(np.float64) - wanted).mean())
    place = _place(differing(mine, wanted).astype(np.float64))
    return Result(check, passed, share, bias, place, mine=mine, wanted=wanted)


def _compare_textures(check: Check, mine: Values, wanted: Values) -> Result:
    found = Result(
        check, False, float("inf"), mine=_as_picture(mine, wanted), wanted=_as_picture(wanted, wanted)
    )
    if mine.shape != wanted.shape:
        return replace(found, sizes=(_size(mine), _size(wanted)))
    finite = np.isfinite(mine)
    if not finite.all():
        count = int((~finite.reshape(*mine.shape[:2], -1).all(axis=-1)).sum())
        return replace(found, not_finite=count)
    apart = mine.astype(np.float64) - wanted
    by_texel = np.abs(apart).reshape(*mine.shape[:2], -1).max(axis=-1)
    largest = float(by_texel.max())
    place = _place(np.where(by_texel > check.tolerance, by_texel, 0.0)[::-1])
    passed, bias = largest <= check.tolerance, float(apart.mean())
    return replace(found, passed=passed, difference=largest, bias=bias, place=place)


def _size(values: Values) -> tuple[int, ...]:
    """Return width, height, and channels of a texture."""
    return (values.shape[1], values.shape[0], values.shape[2] if values.ndim > 2 else 1)


def _as_picture(values: Values, wanted: Values) -> Picture:
    """Return a texture in grey or colour, from the answer's lowest to its highest value; north is up.

    An answer that is the same everywhere is shown as it is: from 0 to 1, or to itself where it is outside.
    """
    low, high = float(wanted.min()), float(wanted.max())
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
    found = []
    for axis, names in ((0, _DOWN), (1, _ACROSS)):
        thirds = [float(part.sum()) / total for part in np.array_split(amount, 3, axis=axis)]
        found.append(next((name for name, part in zip(names, thirds, strict=True) if part > _MOST), None))
    down, across = found
    if down == across:
        return "middle" if down == "" else ""
    return "-".join(filter(None, (down, across)))
