"""Time water and erosion by rivers against other programs, in one run.

    pip install -e ".[bench]" fastscapelib pyflwdir xarray-spatial scikit-image richdem
    python tests/verify/benchmarks/water.py --processor [--size 1025] [--rounds 3] [NAME…]

Each of those that is not installed is left out. They use one processor and take processor time by
itself; ours is given over processors, so that on two of them twice our figure is what it takes in all.
Terrain: gradient noise of eight octaves, 20.48 km wide and 1800 m high; a quarter of it lies under lakes.
The filled terrain, for what needs one, is this project's own. Seeds change from run to run.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from side_by_side import SEEDS, Bench, Comparison, Run, run_all

from playground.sketch.model import Sketch

EXTENT, RELIEF = 20480.0, 1800.0
TERRAIN = f"""size = {{size}}
extent = {EXTENT}
relief = {RELIEF}
[[pass]]
name = "height"
use = "generation/gradient_noise"
set = {{{{ frequency = 3, octaves = 8 }}}}
"""
FLOW = """
[[pass]]
name = "fill"
use = "water/fill"
[[pass]]
name = "ways"
use = "water/directions"
inputs = { height = "fill:level" }
[[pass]]
name = "area"
use = "water/accumulation"
inputs = { receiver = "ways" }
"""
CARVE = """
[[pass]]
name = "worn"
use = "erosion/stream_power"
"""
YEARS, RISE, WEAR = 1e5, 5e-4, 5e-6  # of a step; [m/yr]; [1/yr]


def peer(name: str) -> Any:
    """Return a module, or None where it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


class Erosion(Bench):
    """The shared bench, with terrains before and after their depressions are filled."""

    def ours(self, sketch: Sketch, what: str, changed: str, before: str = "") -> dict[str, Run]:
        """Return runs that draw a pass after a change to ``changed``; ``before`` is drawn beforehand."""

        def run_of(form: str) -> Run:
            engine = self.engines["fragment" if form == "fragment" else "auto"]

            def run() -> None:
                engine.texture(sketch.with_values({changed: next(SEEDS) % 9999}), what)
                engine.ctx.finish()

            if before:
                engine.texture(sketch, before)
            return run

        return {form: run_of(form) for form in ("auto", "fragment")}

    def metres(self, size: int, filled: bool = False) -> np.ndarray:
        """Return the terrain in metres, float64, south row first."""
        sketch = self.sketch(TERRAIN.format(size=size) + FLOW)
        name = "fill:level" if filled else "height"
        return RELIEF * self.engines["auto"].read(sketch, name).astype(np.float64)


def fill(bench: Erosion, size: int) -> Iterator[Comparison]:
    """Depressions filled."""
    z = bench.metres(size)
    theirs: dict[str, Run] = {}
    if richdem := peer("richdem"):
        theirs["richdem"] = lambda: richdem.FillDepressions(richdem.rdarray(z, no_data=-9999))
    if morphology := peer("skimage.morphology"):
        seed = np.full_like(z, z.max())
        for edge in (np.s_[0], np.s_[-1], np.s_[:, 0], np.s_[:, -1]):
            seed[edge] = z[edge]
        theirs["scikit-image"] = lambda: morphology.reconstruction(seed, z, method="erosion")
    if dem := peer("pyflwdir.dem"):
        theirs["pyflwdir"] = lambda: dem.fill_depressions(z)
    sketch = bench.sketch(TERRAIN.format(size=size) + FLOW)
    yield Comparison("fill", bench.ours(sketch, "fill:level", "height.seed"), theirs, alone=frozenset(theirs))


def flow(bench: Erosion, size: int) -> Iterator[Comparison]:
    """Directions and drained areas of a filled terrain."""
    z = bench.metres(size, filled=True)
    theirs: dict[str, Run] = {}
    if richdem := peer("richdem"):
        theirs["richdem"] = lambda: richdem.FlowAccumulation(richdem.rdarray(z, no_data=-9999), method="D8")
    if pyflwdir := peer("pyflwdir"):
        theirs["pyflwdir"] = lambda: pyflwdir.from_dem(z).upstream_area("cell")
    if (xrspatial := peer("xrspatial")) and (xarray := peer("xarray")):
        if hasattr(xrspatial, "flow_accumulation"):
            raster = xarray.DataArray(z)
            theirs["xarray-spatial"] = lambda: xrspatial.flow_accumulation(xrspatial.flow_direction(raster))
    sketch = bench.sketch(TERRAIN.format(size=size) + FLOW)
    ours = bench.ours(sketch, "area", "ways.seed", before="fill:level")
    yield Comparison("flow", ours, theirs, "≤ 250 ms C at 1025²", alone=frozenset(theirs))


def carve(bench: Erosion, size: int) -> Iterator[Comparison]:
    """A whole terrain, from its coarsest level to its finest; theirs is fifty steps at full size."""
    theirs: dict[str, Run] = {}
    if fastscapelib := peer("fastscapelib"):
        z = bench.metres(size)
        theirs["fastscapelib, 1 step"] = lambda: fastscape(fastscapelib, z, 1)
        theirs["fastscapelib, 50 steps"] = lambda: fastscape(fastscapelib, z, 50)
    sketch = bench.sketch(TERRAIN.format(size=size) + CARVE)
    ours = bench.ours(sketch, "worn:height", "worn.seed", before="height")
    once = frozenset({"fastscapelib, 50 steps"})
    yield Comparison("carve", ours, theirs, "≤ 20 s C at 1025²", once=once, alone=frozenset(theirs))


def fastscape(module: Any, z: np.ndarray, steps: int) -> np.ndarray:
    """Wear a terrain by fastscapelib: single flow, sinks resolved by a minimum spanning tree."""
    sides = [EXTENT, EXTENT]
    grid = module.RasterGrid.from_length(list(z.shape), sides, module.NodeStatus.FIXED_VALUE)
    graph = module.FlowGraph(grid, [module.SingleFlowRouter(), module.MSTSinkResolver()])
    eroder = module.SPLEroder(graph, k_coef=WEAR, area_exp=0.5, slope_exp=1, tolerance=1e-5)
    lift = np.full(z.shape, RISE * YEARS)
    lift[[0, -1]] = lift[:, [0, -1]] = 0.0
    for _ in range(steps):
        raised = z + lift
        graph.update_routes(raised)
        z = raised - eroder.erode(raised, graph.accumulate(1.0), YEARS)
    return z


COMPARISONS: dict[str, Callable[[Erosion, int], Iterator[Comparison]]] = {
    result.__name__: result for result in (fill, flow, carve)
}
"""What is timed, by the name it goes by on the command line."""


if __name__ == "__main__":
    run_all(__doc__ or "", Erosion, COMPARISONS)
