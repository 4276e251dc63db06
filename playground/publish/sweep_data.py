"""Sweep a sketch's parameters for research: an xarray.Dataset of pictures and measures, one for each case.

Cases are drawn in worker processes. Each is drawn by itself, so that what is found does not depend on how
many there are. ``sweep`` is where what a sweep may say is read; ``sheet`` puts its pictures side by side.
"""

from __future__ import annotations

import importlib
import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground._version import __version__
from playground.engine.engine import Engine, open_engine
from playground.engine.plain_forms import silent
from playground.engine.plan import Plan, checked_pixels, view_height
from playground.engine.process.pool import Pool
from playground.engine.process.worker import Parent, Service
from playground.errors import ParameterError, PlaygroundError
from playground.extras import needs
from playground.publish.export_formats import HEIGHT, kind_of
from playground.publish.series import SWEEP_SIZE
from playground.publish.sweep import Sweep, combinations, sweep_of
from playground.sketch.load import opened
from playground.sketch.model import MAX_SIDE, Sketch
from playground.terminal import progress as bar

if TYPE_CHECKING:
    import xarray


MAX_BYTES = 2**32
"""Bytes that the pictures of a sweep may take."""

_MAX_WORKERS = 64


def sweep(
    sketch: Sketch | str | Path,
    values: Mapping[str, Iterable[object]],
    *,
    textures: Sequence[str] | None = None,
    pictures: bool = True,
    size: tuple[int, int] = SWEEP_SIZE,
    time: float = 0.0,
    workers: int | None = None,
    software: bool = False,
    progress: bool = True,
) -> xarray.Dataset:
    """Draw a sketch with every combination of some values; return pictures and measures of textures.

    ``sketch`` is a loaded one, or what ``load`` takes. ``values`` are by path: those of a parameter, of a
    part of a vector (``light.sun.elevation``), of ``relief``, ``extent``, ``size`` and
    ``base_elevation``; or a text as on the command line, "10..60,6". Each path is a dimension, in
    their order, and the values are its coordinates: numbers and truth values as they are; a vector, a
    menu's choice and a file as the text that the command line takes, "135,25", and each number of a
    vector is a coordinate of its own along the same dimension, ``light.sun.azimuth``.

    ``picture`` is uint8 (…, row, column, channel), top row first, sRGB and alpha, of ``size`` in pixels
    at ``time`` in seconds; without ``pictures`` it is left out. Of each of ``textures``, references as
    ``Engine.read`` takes them (the heights that the picture shows, unless given), there are ``.mean``,
    ``.min``, ``.max`` and ``.std`` over its texels, float64: heights in metres, all else as ``read``
    gives it, of several numbers a texel the mean of the first three.

    It is drawn in so many ``workers``, processes, as there are processors, 4 at most, unless given; the
    result is the same for any number. ``software`` asks for the software renderer. With ``progress``
    there is a bar where standard error is a terminal.

        found = playground.sweep(
            "diamond_square", {"height.seed": [1, 2], "relief": [200.0, 400.0]}, size=(32, 18), workers=1
        )
        print(found["height.max"].sel(relief=400.0).values)

    Needs xarray, of the extra ``research``. Raises ``ParameterError`` for
    what cannot be set, ``PlaygroundError`` for any mistake in the sketch, ``SandboxCrash`` where a
    process dies.
    """
    made = _xarray()
    base, pixels = opened(sketch), checked_pixels(size, MAX_SIDE)
    sweeps = [sweep_of(base, path, value) for path, value in values.items()]
    _check(sweeps, pixels if pictures else (0, 0), workers)
    measured = None if textures is None else tuple(textures)
    cases = [
        Case(each.sketch, pixels, time, measured, pictures)
        for each in combinations(base, sweeps[::-1])  # so that the last dimension changes fastest
    ]
    count = min(len(cases), workers or min(os.cpu_count() or 1, 4))
    results: list[SweepResult] = []
    with bar(f"sweep of {base.name}", len(cases)) if progress else nullcontext(lambda: None) as advance:
        for result in _drawn(cases, count, software):
            results.append(result)
            advance()
    return _dataset(made, base, sweeps, results, (pixels, time))


def _xarray() -> Any:
    try:
        return importlib.import_module("xarray")
    except ImportError as error:
        message = needs("a sweep as a Dataset", "xarray", "research")
        raise PlaygroundError(f"{message} ({error})") from None


def _check(sweeps: Sequence[Sweep], size: tuple[int, int], workers: int | None) -> None:
    if not sweeps:
        raise ParameterError("a sweep of nothing: expected a parameter's path with its values")
    whole: dict[str, Sweep] = {}
    for each in sweeps:
        other = whole.setdefault(each.parameter, each)
        if other is not each and None in (other.part, each.part):
            raise ParameterError(f"sweeps of {other.path} and of {each.path}: expected one of them")
    if workers is not None and not (isinstance(workers, int) and 1 <= workers <= _MAX_WORKERS):
        raise ParameterError(f"workers = {workers}: expected a whole number from 1 to {_MAX_WORKERS}")
    need = math.prod(len(each.values) for each in sweeps) * size[0] * size[1] * 4
    if need > MAX_BYTES:
        raise ParameterError(
            f"the pictures would take {need / 2**30:.1f} GiB; {MAX_BYTES // 2**30} are the most: choose "
            "smaller ones, fewer values, or pictures=False"
        )


# ── drawing ────────────────────────────────────────────────────────────────


def _drawn(cases: Sequence[Case], count: int, software: bool) -> Iterator[SweepResult]:
    """Yield what is found of each case, in their order."""
    with Pool(__name__, options=software, workers=count) as pool:
        for number, outcome in enumerate(pool.map(cases)):
            result = outcome.get(f"case {number} of the sweep")
            assert isinstance(result, SweepResult)
            yield result


# ── what is found ──────────────────────────────────────────────────────────


def _dataset(
    made: Any,
    base: Sketch,
    sweeps: Sequence[Sweep],
    results: Sequence[SweepResult],
    at: tuple[tuple[int, int], float],
) -> xarray.Dataset:
    dims = [each.path for each in sweeps]
    shape = tuple(len(each.values) for each in sweeps)
    variables: dict[str, Any] = {}
    for name, unit in results[0].units.items():
        numbers = np.array([result.measures[name] for result in results], np.float64).reshape(shape)
        variables[name] = (dims, numbers, {"units": unit})
    if results[0].picture is not None:
        stacked = np.stack([result.picture for result in results if result.picture is not None])
        pictures = stacked.reshape(*shape, *stacked.shape[1:])
        variables["picture"] = ([*dims, "row", "column", "channel"], pictures, {"encoding": "sRGB, alpha"})
    coordinates: dict[str, Any] = {}
    for each in sweeps:
        coordinates |= _coordinates(each)
    if "picture" in variables:
        coordinates["channel"] = list("rgba")
    attributes = {
        "sketch": base.name,
        "size": list(at[0]),
        "time": at[1],
        "renderer": results[0].renderer,
        "playground": __version__,
    }
    dataset: xarray.Dataset = made.Dataset(variables, coordinates, attributes)
    return dataset


def _coordinates(each: Sweep) -> dict[str, Any]:
    """Return the coordinates of a sweep: its values, and of vectors each number as well."""
    if each.is_plain:
        return {each.path: (each.path, np.array(each.values), {"units": each.unit} if each.unit else {})}
    coordinates: dict[str, Any] = {each.path: (each.path, np.array(each.labels, dtype=str))}
    numbers: NDArray[Any] = np.array(each.values)
    if numbers.ndim == 2:
        for index, part in enumerate(each.parts):
            coordinates[f"{each.path}.{part}"] = (each.path, numbers[:, index])
    return coordinates


# ── in the worker ────────────────────────────────────────────────────────────


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
class SweepResult:
    """What a case gives."""

    picture: NDArray[np.uint8] | None  # (height, width, 4), top row first
    measures: dict[str, float]  # as "height.mean"
    units: dict[str, str]  # likewise
    renderer: str


def open_service(parent: Parent, software: bool) -> Service:
    """Return the service that draws cases, all of them by one engine."""
    engine = open_engine(software=software, notice=silent)

    def answer(case: Case) -> SweepResult:
        drawn = draw(engine, case)
        engine.forget_unused()
        return drawn

    return Service(answer)


def draw(engine: Engine, case: Case) -> SweepResult:
    """Draw a case; raise as ``Engine.render`` does."""
    measures: dict[str, float] = {}
    units: dict[str, str] = {}
    at = {"size": case.size, "time": case.time}
    plan = engine.plan(case.sketch, case.size, case.time)
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
    return SweepResult(picture, measures, units, engine.info.renderer)


def _shown(plan: Plan) -> list[str]:
    """Return the heights that the picture shows, by their pass's name where that is enough; none for none."""
    shown, name = view_height(plan), plan.sketch.name
    if not shown:
        return []
    short = shown.partition(":")[0]
    return [short if plan.flat.ref(short, name) == plan.flat.ref(shown, name) else shown]
