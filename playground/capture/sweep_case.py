"""Draw one case of a sweep in a worker process: its picture, and measures of its textures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from playground.api import headless
from playground.capture.export_textures import kind_of
from playground.capture.extensions import HEIGHT
from playground.engine.engine import Engine
from playground.engine.plain_forms import silent
from playground.engine.plan import Plan
from playground.engine.process.worker import Parent, Service
from playground.engine.view_inputs import view_height
from playground.sketch.model import Sketch

_COLOURS = 3  # numbers of a texel that count: alpha does not
MEASURES: dict[str, Callable[[NDArray[np.float64]], float]] = {
    "mean": np.mean,
    "min": np.min,
    "max": np.max,
    "std": np.std,
}
"""What is measured of a texture, over its texels."""


@dataclass(frozen=True)
class Case:
    """One combination of values."""

    sketch: Sketch
    size: tuple[int, int]  # [pixels]
    time: float  # [s]
    textures: tuple[str, ...] | None  # to measure; None: the heights that the picture shows
    pictures: bool  # whether its picture is wanted


@dataclass(frozen=True)
class Found:
    """What a case gives."""

    picture: NDArray[np.uint8] | None  # (height, width, 4), top row first
    measures: dict[str, float]  # as "height.mean"
    units: dict[str, str]  # likewise
    renderer: str


def open_service(parent: Parent, software: bool) -> Service:
    """Return the service that draws cases, all of them by one engine."""
    engine = headless(software=software, notice=silent)

    def answer(case: Case) -> Found:
        found = draw(engine, case)
        engine.forget_unused()
        return found

    return Service(answer)


def draw(engine: Engine, case: Case) -> Found:
    """Draw a case; raise as ``Engine.render`` does."""
    measures: dict[str, float] = {}
    units: dict[str, str] = {}
    at = {"size": case.size, "time": case.time}
    plan = engine.internal.plan_for(case.sketch, case.size, case.time)
    for ref in _shown(plan) if case.textures is None else case.textures:
        plan.flat.ref(ref, case.sketch.name)
        values = engine.read(case.sketch, ref, **at).astype(np.float64)  # type: ignore[arg-type]
        is_height = kind_of(plan, ref) == HEIGHT and values.ndim == 2
        if is_height:
            values = plan.terrain.metres(values.astype(np.float32)).astype(np.float64)
        numbers = values[..., :_COLOURS].mean(axis=-1) if values.ndim == 3 else values
        for name, measure in MEASURES.items():
            measures[f"{ref}.{name}"] = float(measure(numbers))
            units[f"{ref}.{name}"] = "m" if is_height else "1"
    picture = engine.render(case.sketch, **at).array if case.pictures else None  # type: ignore[arg-type]
    return Found(picture, measures, units, engine.info.renderer)


def _shown(plan: Plan) -> list[str]:
    """Return the heights that the picture shows, by their pass's name where that is enough; none for none."""
    shown, name = view_height(plan), plan.sketch.name
    if not shown:
        return []
    short = shown.partition(":")[0]
    return [short if plan.flat.ref(short, name) == plan.flat.ref(shown, name) else shown]
