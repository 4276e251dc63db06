"""Measure textures and pictures: the numbers of lessons, by the names that these use."""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from inspect import signature
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.course.library import decimal
from playground.course.model import Lesson, Markdown, Measure, Scene
from playground.errors import SketchError
from playground.sketch.model import TexelKernel

if TYPE_CHECKING:
    from playground.engine.engine import Engine
    from playground.engine.plan import LoopStep, Plan, Step

Values = NDArray[np.float64]
"""(ny, nx), row 0 in the south."""


@dataclass(frozen=True, slots=True)
class Grid:
    """The places and metres of a heightmap's texels."""

    spacing: tuple[float, float] = (1.0, 1.0)  # [m] from texel to texel, eastwards and northwards
    relief: float = 1.0  # [m] from height 0 to height 1


_NEAR = [(dy, dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1) if dy or dx]
_KM2 = 1e6  # [m²]


def pits(values: Values, grid: Grid) -> float:
    """Return the fraction of the texels, borders aside, that no neighbour is lower than, 0..1."""
    slopes, _ = flow_directions(values, grid)
    return float((slopes[1:-1, 1:-1] <= 0).mean())


def tail_power(values: Values, grid: Grid, low: float, high: float) -> float:
    """Return τ of P(A > a) ~ a^−τ, of drained areas A [m²], fitted from ``low`` to ``high`` [km²].

    P is the fraction of the texels that drain more than a.
    """
    at = np.geomspace(low, high, 12) * _KM2 if 0 < low < high else np.empty(0)
    shares = np.array([(values > a).mean() for a in at])
    if not at.size or not shares.all():
        raise ValueError(f"low = {low:g}, high = {high:g}: expected areas [km²] that some texels exceed")
    return -float(np.polyfit(np.log(at), np.log(shares), 1)[0])


def slope_where_drained(values: Values, grid: Grid, low: float, high: float) -> float:
    """Return the median slope, in metres a metre, of the texels that drain ``low`` to ``high`` [km²]."""
    slopes, _ = _between(values, grid, low, high)
    if not slopes.size:
        raise ValueError(f"low = {low:g}, high = {high:g}: no texel drains that area (km²)")
    return float(np.median(slopes))


def slope_area_power(values: Values, grid: Grid, low: float, high: float) -> float:
    """Return θ of S ~ A^θ, fitted to the texels that drain ``low`` to ``high`` [km²]; S is the slope down."""
    slopes, areas = _between(values, grid, low, high)
    if np.unique(areas).size < 2:
        raise ValueError(f"low = {low:g}, high = {high:g}: fewer than two texels drain that area (km²)")
    return float(np.polyfit(np.log(areas), np.log(slopes), 1)[0])


def _between(values: Values, grid: Grid, low: float, high: float) -> tuple[Values, Values]:
    """Return the slopes above 0 and the areas of the texels that drain so much; edges have no slope."""
    slopes, receivers = flow_directions(values, grid)
    areas = drainage_areas(values, receivers) * grid.spacing[0] * grid.spacing[1]
    chosen = (slopes > 0) & (areas >= low * _KM2) & (areas <= high * _KM2)
    return slopes[chosen], areas[chosen]


def flow_directions(values: Values, grid: Grid) -> tuple[Values, NDArray[np.intp]]:
    """Return the slope down to the steepest neighbour, and its number; 0 and the own number where none is."""
    ny, nx = values.shape
    numbers = np.arange(ny * nx).reshape(ny, nx)
    slopes, receivers = np.zeros((ny, nx)), numbers.copy()
    inner = slice(1, ny - 1), slice(1, nx - 1)
    for dy, dx in _NEAR:
        there = slice(1 + dy, ny - 1 + dy), slice(1 + dx, nx - 1 + dx)
        away = np.hypot(dy * grid.spacing[1], dx * grid.spacing[0])
        slope = grid.relief * (values[inner] - values[there]) / away
        receivers[inner] = np.where(slope > slopes[inner], numbers[there], receivers[inner])
        slopes[inner] = np.maximum(slopes[inner], slope)
    return slopes, receivers


def drainage_areas(values: Values, receivers: NDArray[np.intp]) -> Values:
    """Return how many texels drain through each, itself included: handed on from the highest one down."""
    areas = np.ones(values.size)
    down = receivers.ravel()
    for cell in np.argsort(-values, axis=None, kind="stable"):
        if down[cell] != cell:
            areas[down[cell]] += areas[cell]
    return areas.reshape(values.shape)


@dataclass(frozen=True)
class OfTexture:
    """A measure of a texture's values."""

    function: Callable[..., float]
    arguments: tuple[str, ...] = ()


@dataclass(frozen=True)
class OfRun:
    """A measure of how a texture or a picture is computed: from the engine, not from the values."""

    arguments: tuple[str, ...] = ()


def mean(values: Values, grid: Grid) -> float:
    """Return the mean."""
    return float(values.mean())


def mean_below_mesh(values: Values, grid: Grid) -> float:
    """Return the mean of the mesh through the texels: one on an edge counts half, in a corner a quarter."""
    east, north = (np.r_[0.5, np.ones(count - 2), 0.5] for count in values.shape[::-1])
    return float(np.average(values, weights=np.outer(north, east)))


def lowest(values: Values, grid: Grid) -> float:
    """Return the lowest value."""
    return float(values.min())


def highest(values: Values, grid: Grid) -> float:
    """Return the highest value."""
    return float(values.max())


def spread(values: Values, grid: Grid) -> float:
    """Return how far apart the lowest and the highest value are."""
    return float(values.max() - values.min())


def deviation(values: Values, grid: Grid) -> float:
    """Return the standard deviation."""
    return float(values.std())


def share_below(values: Values, grid: Grid, limit: float) -> float:
    """Return the fraction of the texels that lies below a limit, 0..1."""
    return float((values < limit).mean())


def share_above(values: Values, grid: Grid, limit: float) -> float:
    """Return the fraction of the texels that lies above a limit, 0..1."""
    return float((values > limit).mean())


def share_between(values: Values, grid: Grid, low: float, high: float) -> float:
    """Return the fraction of the texels that lies between two limits, both included, 0..1."""
    return float(((values >= low) & (values <= high)).mean())


def distinct(values: Values, grid: Grid) -> float:
    """Return how many different values there are."""
    return float(np.unique(values).size)


def local_maxima(values: Values, grid: Grid) -> float:
    """Return how many texels, borders aside, are higher than each of their eight neighbours."""
    return float(_peaks(values).sum())


def peaks_on_lattice(values: Values, grid: Grid, every: float) -> float:
    """Return the fraction of the local maxima that has a row and a column that ``every`` divides, 0..1."""
    step = int(every)
    if step < 1:
        raise ValueError(f"every = {every:g}: expected 1 or more")
    rows, columns = np.nonzero(_peaks(values))
    return float((((rows + 1) % step == 0) & ((columns + 1) % step == 0)).mean()) if rows.size else 0.0


def _peaks(values: Values) -> NDArray[np.bool_]:
    inner = values[1:-1, 1:-1]
    top = np.ones(inner.shape, bool)
    for dy in (0, 1, 2):
        for dx in (0, 1, 2):
            if (dy, dx) != (1, 1):
                top &= inner > values[dy : dy + inner.shape[0], dx : dx + inner.shape[1]]
    return top


def mean_slope(values: Values, grid: Grid) -> float:
    """Return the mean slope in degrees of a height in 0..1, by central differences in metres."""
    return float(_slopes(values, grid).mean())


def share_steeper(values: Values, grid: Grid, degrees: float) -> float:
    """Return the fraction of the terrain that is steeper than some degrees, 0..1."""
    return float((_slopes(values, grid) > degrees).mean())


def _slopes(values: Values, grid: Grid) -> Values:
    north, east = np.gradient(values * grid.relief, grid.spacing[1], grid.spacing[0])
    slopes: Values = np.degrees(np.arctan(np.hypot(east, north)))
    return slopes


def spectrum_slope(values: Values, grid: Grid) -> float:
    """Return the slope of the radial power spectrum in log-log, from 8 cycles to a quarter of the side.

    Of fractional Brownian motion in the plane it is −(2H + 2), H the Hurst exponent. The
    values are weighed by a Hann window; the sixteen bins are of equal width in the logarithm.
    """
    side = min(values.shape)
    part = values[:side, :side]
    window = np.hanning(side)
    power = np.abs(np.fft.fft2((part - part.mean()) * np.outer(window, window))) ** 2
    along = np.fft.fftfreq(side, 1 / side)
    frequency = np.hypot(along[None], along[:, None])
    edges = np.geomspace(8.0, side / 4.0, 17)
    means = [power[(frequency >= low) & (frequency < high)].mean() for low, high in pairwise(edges)]
    return float(np.polyfit(np.log(np.sqrt(edges[1:] * edges[:-1])), np.log(means), 1)[0])


def box_dimension(values: Values, grid: Grid, limit: float) -> float:
    """Return the dimension by counting boxes of 2 to a quarter of a side of what lies above a limit."""
    side = 2 ** int(np.log2(min(values.shape)))
    mask = values[:side, :side] > limit
    sizes = [2**k for k in range(1, int(np.log2(side)) - 1)]
    counts = []
    for size in sizes:
        boxes = mask.reshape(side // size, size, side // size, size).any(axis=(1, 3))
        counts.append(max(int(boxes.sum()), 1))
    return float(-np.polyfit(np.log(sizes), np.log(counts), 1)[0])


def diagonal_crease(values: Values, grid: Grid) -> float:
    """Return how much a square heightmap bends across its south-west diagonal, over the parallels of it.

    The bend is the second difference along the other diagonal; the parallels are the forty on each side.
    """
    bend = np.abs(values[2:, :-2] - 2.0 * values[1:-1, 1:-1] + values[:-2, 2:])
    near = [np.diagonal(bend, k).mean() for k in range(-40, 41) if k]
    return float(np.diagonal(bend).mean() / np.mean(near))


def step_across(values: Values, grid: Grid, at: float) -> float:
    """Return the mean step from column ``at`` − 1 to ``at``, over that of four pairs of columns nearby."""
    column, count = int(at), values.shape[1]
    if not 4 <= column <= count - 4:
        raise ValueError(f"column {column} of {count} has not four on each side")
    steps = np.abs(np.diff(values, axis=1)).mean(axis=0)
    neighbours = [steps[column - 1 + k] for k in (-3, -2, 2, 3)]
    return float(steps[column - 1] / np.mean(neighbours))


def correlation(values: Values, grid: Grid, dx: float, dy: float) -> float:
    """Return the correlation of a texture with itself, moved by so many texels, over what they share."""
    x, y = int(dx), int(dy)
    ny, nx = values.shape
    if abs(x) >= nx or abs(y) >= ny:
        raise ValueError(f"moved by {x}, {y}: expected less than {nx}, {ny}")
    first = values[max(y, 0) : ny + min(y, 0), max(x, 0) : nx + min(x, 0)]
    second = values[max(-y, 0) : ny + min(-y, 0), max(-x, 0) : nx + min(-x, 0)]
    return float(np.corrcoef(first.ravel(), second.ravel())[0, 1])


def edge_match(values: Values, grid: Grid) -> float:
    """Return the mean step from the last column to the first, over that of neighbouring columns.

    About 1 for terrain that repeats without a seam.
    """
    return float(np.abs(values[:, 0] - values[:, -1]).mean() / np.abs(np.diff(values, axis=1)).mean())


_FUNCTIONS: tuple[Callable[..., float], ...] = (
    *(mean, mean_below_mesh, lowest, highest, spread, deviation, distinct),
    *(share_below, share_above, share_between, share_steeper),
    *(local_maxima, peaks_on_lattice, mean_slope, spectrum_slope, box_dimension),
    *(diagonal_crease, step_across, correlation, edge_match),
    *(pits, tail_power, slope_where_drained, slope_area_power),
)

MEASURES: dict[str, OfTexture | OfRun] = {
    **{each.__name__: OfTexture(each, tuple(signature(each).parameters)[2:]) for each in _FUNCTIONS},
    "triangles": OfRun(),  # drawn for the whole picture
    "iterations": OfRun(),  # of the repeated pass in ``of``
    "texels": OfRun(),  # computed for ``of`` by fragment shaders, every iteration counted
    "texture_bytes": OfRun(),  # of ``of``, without mip levels
    "milliseconds": OfRun(),  # to compute ``of`` again: the best of three
}
"""Every measure, by the name that lessons use."""


_PLACEHOLDER = re.compile(r"\{\{\s*([a-z0-9-]+(?::[^{}:]+)?(?::-?\d+)?)\s*\}\}")


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


def filled(markdown: Markdown, numbers: Mapping[str, Number], language: str) -> Markdown:
    """Replace the places that name measures by their numbers; one that is not computed yet is "…"."""
    return _PLACEHOLDER.sub(
        lambda match: decimal(numbers[match[1]].text, language) if match[1] in numbers else "…", markdown
    )


def named_in(markdown: Markdown) -> list[str]:
    """List the numbers that a text names: of measures, of questions, of traces as "march:ray:3"."""
    return _PLACEHOLDER.findall(markdown)


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
    from playground.engine.plan import PlanRequest, every_version, needed
    from playground.engine.planner import make_plan  # reading a lesson needs neither

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
    from playground.engine.plan import Step

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
