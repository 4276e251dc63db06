"""Compute the numbers of a lesson, on an engine."""

from __future__ import annotations

import math
import re
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from playground.course.measures import MEASURES, Grid, OfTexture
from playground.course.model import Lesson, Markdown, Measure, Scene
from playground.engine.engine import Engine
from playground.engine.plan import LoopStep, Plan, PlanRequest, Step, every_version, needed
from playground.engine.planner import make_plan
from playground.errors import SketchError
from playground.sketch.model import TexelKernel

_PLACE = re.compile(r"\{\{\s*([a-z0-9-]+)\s*\}\}")


@dataclass(frozen=True, slots=True)
class Number:
    """The value of a measure."""

    value: float
    text: str  # to its digits, with its unit; a point for the decimals


class NoNumberError(SketchError):
    """A measure is not finite for the texture that there is."""


def measured(engine: Engine, measure: Measure) -> Number:
    """Return the number of a measure; raise ``SketchError`` naming it where there is none.

    It is a ``NoNumberError`` where the value is not finite.
    """
    assert measure.scene is not None
    value = _value(engine, measure, measure.scene)
    if measure.over is not None:
        below = _value(engine, measure, measure.over)
        value = value / below if below else math.nan
    value *= 100.0 if measure.unit == "%" else 1.0
    if not math.isfinite(value):
        raise NoNumberError(f"measure '{measure.name}': {value} is not a number to show", line=measure.line)
    return Number(value, spelled(value, measure.digits, measure.unit))


def numbers_of(engine: Engine, lesson: Lesson) -> dict[str, Number]:
    """Return all numbers of a lesson, by their names."""
    return {measure.name: measured(engine, measure) for measure in lesson.measures}


def filled(markdown: Markdown, numbers: Mapping[str, Number], comma: bool = False) -> Markdown:
    """Replace the places that name measures by their numbers; one that is not computed yet is "…".

    ``comma`` writes decimals behind a comma, as French does.
    """

    def text(match: re.Match[str]) -> str:
        number = numbers.get(match[1])
        number_text = number.text if number else "…"
        return number_text.replace(".", ",") if comma else number_text

    return _PLACE.sub(text, markdown)


def named_in(markdown: Markdown) -> list[str]:
    """List the measures that a text names."""
    return _PLACE.findall(markdown)


def spelled(value: float, digits: int, unit: str = "") -> str:
    """Write a number to significant digits, never as a power of ten; thousands separated by narrow spaces."""
    rounded = float(f"{value:.{digits - 1}e}")
    power = math.floor(math.log10(abs(rounded))) if rounded else 0
    # What was counted has no decimals: 1 summit, not 1.00.
    decimals = 0 if value == int(value) else max(digits - 1 - power, 0)
    text = f"{rounded:,.{decimals}f}".replace(",", "\u202f").replace("-", "−")
    if unit in ("%", "°"):
        return f"{text}\u202f%" if unit == "%" else f"{text}°"
    return f"{text}\u202f{unit}" if unit else text


def _value(engine: Engine, measure: Measure, scene: Scene) -> float:
    at: dict[str, Any] = {"size": scene.pixels, "time": scene.time, "steps": dict(scene.steps)}
    value = MEASURES[measure.what]
    if isinstance(value, OfTexture):
        values = engine.read(scene.sketch, measure.of, **at)
        first = values if values.ndim == 2 else values[..., 0]
        grid = _grid(engine.record.plan, first.shape)
        try:
            return value.function(first.astype(np.float64), grid, **dict(measure.arguments))
        except ValueError as error:
            raise SketchError(f"measure '{measure.name}': {error}", line=measure.line) from None
    if measure.what == "triangles":
        engine.cache.clear()
        engine.draw(scene.sketch, **at)
        return float(engine.record.triangles)
    if measure.what == "milliseconds":
        return min(_seconds(engine, measure, scene, at) for _ in range(3)) * 1e3
    if measure.what == "texture_bytes":
        texture = engine.texture(scene.sketch, measure.of, **at)
        width, height = texture.size
        bytes_a_channel = {"f1": 1, "f2": 2, "f4": 4}[texture.dtype]
        return float(width * height * texture.components * bytes_a_channel)
    # Of the plain form: a fast variant has other iterations than the text that the lesson shows.
    plan = make_plan(
        scene.sketch,
        PlanRequest(frame_size=scene.pixels, time=scene.time, steps=at["steps"], ref=measure.of),
    )
    nodes = needed(plan.nodes, plan.flat.ref(measure.of, scene.sketch.name))
    if measure.what == "iterations":
        return float(max((node.repeat for node in every_version(tuple(nodes))), default=0))
    return float(sum(_texels(node) for node in nodes))


def _texels(node: Step | LoopStep) -> int:
    if isinstance(node, Step):
        return node.size[0] * node.size[1] * node.repeat if isinstance(node.kernel, TexelKernel) else 0
    if len(node.bodies) == 1:
        return node.repeat * sum(_texels(inner) for inner in node.body)
    return sum(_texels(inner) for number in range(node.repeat) for inner in node.body_of(number))


def _seconds(engine: Engine, measure: Measure, scene: Scene, at: dict[str, Any]) -> float:
    engine.cache.clear()
    engine.ctx.finish()
    started = time.perf_counter()
    engine.texture(scene.sketch, measure.of, **at)
    engine.ctx.finish()
    return time.perf_counter() - started


def _grid(plan: Plan | None, shape: tuple[int, ...]) -> Grid:
    assert plan is not None
    east, north = plan.terrain.extent or (1.0, 1.0)
    spacing = (east / max(shape[1] - 1, 1), north / max(shape[0] - 1, 1))
    return Grid(spacing, plan.terrain.relief or 1.0)
