"""Time the methods of light against their alternatives, in one run.

    pip install ".[bench]"
    python tests/benchmarks/lighting.py [--size 1025 4097] [--rounds 7] [--processor] [NAME…]

Each figure is the median of several runs, each under another sun (horizons: in slightly other
directions; edits: on another terrain), ours and theirs alternately, so that a busy machine slows both.
Nothing compiled is timed, nor is terrain made, but where the table says so. Figures wander with the
machine; ratios less so. The thesis's own methods are compiled from thesis_light.c with cc -O2.
topocalc is not in the extra, for it must be built without isolation; it is left out where it is
not installed:

    pip install cython setuptools_scm numpy && pip install --no-build-isolation topocalc

Terrain: the thesis's layered noise (4, 2, 0.2), for horizons its mixed model, which is rougher; a
texel is as long as the height of one of 255 grey levels.
"""

from __future__ import annotations

import ctypes
import itertools
import math
from collections.abc import Callable, Iterator

import horizon_peers
import numpy as np
from side_by_side import SEEDS, Bench, Comparison, Run, run_all

from playground.engine.engine import Engine
from playground.sketch.model import Sketch

TEXEL = 10.0  # metres
DIRECTIONS = 16
LOW, HIGH = 5.0, 25.0  # elevations of the sun [degrees]
DELTA_R = 0.01


def azimuths() -> Iterator[float]:
    """Yield azimuths all around, the same for whoever asks: by the golden angle."""
    return (20.0 + 137.508 * number % 360.0 for number in itertools.count())


class Lighting(Bench):
    """The shared bench, with lit terrains of ours and of the thesis."""

    source = "thesis_light.c"

    def terrain(self, size: int, use: str = "layered_noise", rest: str = "") -> Sketch:
        """Return a sketch of a terrain of so many texels a side, and what else is to be on it."""
        side = (size - 1) * TEXEL
        return self.sketch(
            f"size = {size}\nextent = {side}\nrelief = {255 * TEXEL}\n"
            f'[[pass]]\nname = "height"\nuse = "generation/{use}"\n{rest}'
        )

    def lit(
        self, size: int, method: str, ref: str, elevation: float, drivers: str = "auto", **values: object
    ) -> dict[str, Run]:
        """Return runs of a method, under a new sun each, up to one of its textures."""
        rest = f'[[pass]]\nname = "light"\nuse = "lighting/{method}"\n'
        sketch = self.terrain(size, rest=rest).with_values({f"light.{k}": v for k, v in values.items()})
        own = elevation + next(SEEDS) * 1e-5  # else the engine would know a part of it from another row

        def runs(engine: Engine) -> Run:
            suns = azimuths()

            def run() -> None:
                engine.texture(sketch.with_values({"light.sun": (next(suns), own)}), ref)
                engine.ctx.finish()

            return run

        return {driver: runs(self.engines[driver]) for driver in drivers.split()}

    def heights(self, size: int, use: str = "layered_noise") -> np.ndarray:
        """Return the heights of a terrain [m], rows from the south."""
        return self.engines["auto"].read(self.terrain(size, use), "height") * np.float32(255 * TEXEL)

    def c(self, function: str, size: int, elevation: float, *more: float) -> dict[str, Run]:
        """Return runs of one of the thesis's methods in C; none where there is no compiler."""
        if self.thesis is None:
            return {}
        grey = np.ascontiguousarray(self.heights(size) / np.float32(TEXEL))
        out = np.empty_like(grey)
        called = getattr(self.thesis, function)
        suns = azimuths()

        def run() -> None:
            azimuth = math.radians(next(suns))
            level = math.cos(math.radians(elevation))
            # L·N takes the light's way down, the walks go up.
            turned = -1.0 if function == "l_dot_n" else 1.0
            way = (
                level * math.sin(azimuth),
                level * math.cos(azimuth),
                math.sin(math.radians(elevation)),
            )
            called(
                grey.ctypes.data_as(ctypes.c_void_p),
                out.ctypes.data_as(ctypes.c_void_p),
                size,
                *(ctypes.c_float(turned * component) for component in way),
                *(ctypes.c_float(number) for number in more),
            )

        return {"the thesis's C": run}


ALONE = frozenset({"the thesis's C", "topocalc"})


def horizons(bench: Lighting, size: int) -> Iterator[Comparison]:
    """Compare horizons in 16 directions and the sky over them with a sweep in Numba, and topocalc."""
    rest = f'[[pass]]\nname = "light"\nuse = "lighting/horizons"\nset = {{ directions = {DIRECTIONS} }}\n'
    sketch = bench.terrain(size, "mixed", rest)
    engine = bench.engines["auto"]
    firsts = itertools.count(1)

    def run() -> None:
        engine.texture(sketch.with_values({"light.first": next(firsts) * 1e-4}), "light:sky")
        engine.ctx.finish()

    heights = bench.heights(size, "mixed")
    theirs: dict[str, Run] = {}
    if horizon_peers.numba is not None:
        theirs["Numba sweep"] = lambda: horizon_peers.numba_sweep(heights, TEXEL, DIRECTIONS)
    if horizon_peers.viewf is not None and size < 2000:
        theirs["topocalc"] = lambda: horizon_peers.topocalc(heights, TEXEL, DIRECTIONS)
    yield Comparison(
        f"horizons, {DIRECTIONS} directions, and K",
        {"auto": run},
        theirs,
        "≥ 0.8 of Numba, ≥ 50 of topocalc",
        once=frozenset({"topocalc"}),
        alone=ALONE,
    )


def shadows(bench: Lighting, size: int) -> Iterator[Comparison]:
    """Compare the visible part of the sun by a sweep with the march, and the whole light with C."""
    for elevation in (LOW, HIGH):
        for name, method in (("hard shadow", "ray_cast"), ("cone", "soft_cone"), ("disc", "sun_disc")):
            swept = bench.lit(size, method, "light.visibility", elevation, form="sweep")
            marched = bench.lit(size, method, "light.visibility", elevation, form="march")["auto"]
            yield Comparison(
                f"{name} alone by a sweep, sun {elevation:g}°",
                swept,
                {"the march": marched},
                "≥ 8" if name == "hard shadow" else "",
            )


def thesis(bench: Lighting, size: int) -> Iterator[Comparison]:
    """Compare whole light by a sweep with the thesis's pseudo-code in C."""
    for elevation in (LOW, HIGH):
        for method, more, wanted in (("soft_cone", (DELTA_R,), "≥ 20"), ("ray_cast", (), "")):
            ours = bench.lit(size, method, "light", elevation, form="sweep")
            theirs = bench.c(method, size, elevation, *more)
            yield Comparison(f"{method}, light, sun {elevation:g}°", ours, theirs, wanted, alone=ALONE)
        yield Comparison(
            f"l_dot_n, sun {elevation:g}°",
            bench.lit(size, "l_dot_n", "light", elevation),
            bench.c("l_dot_n", size, elevation),
            alone=ALONE,
        )


def dragged(bench: Lighting, size: int) -> Iterator[Comparison]:
    """Time light alone, with the horizons known, while the sun is dragged."""
    for method, measured in (
        ("horizon_sun", "on its arc"),
        ("horizon_sun", "eight directions"),
        ("analytic", "eight directions"),
    ):
        ours = bench.lit(size, method, "light", HIGH, measured=measured)
        yield Comparison(f"{method}, {measured}: the sun is moved", ours, wanted="< 15 ms at 1025²")


METHODS = [
    ("height_difference", ""),
    ("l_dot_n", ""),
    ("ray_cast", "march"),
    ("ray_cast", "sweep"),
    ("soft_cylinder", ""),
    ("soft_cone", "march"),
    ("soft_cone", "sweep"),
    ("sun_disc", "march"),
    ("sun_disc", "sweep"),
    ("night", "march"),
    ("night", "sweep"),
    ("horizon_sun", ""),
    ("horizon_sky", ""),
    ("sky_patches", ""),
    ("analytic", ""),
]


def edited(bench: Lighting, size: int) -> Iterator[Comparison]:
    """Time what follows an edit of the terrain, up to its light: all passes of both."""
    engine = bench.engines["auto"]
    for name, form in METHODS:
        chosen = f'set = {{ form = "{form}" }}\n' if form else ""
        rest = f'[[pass]]\nname = "light"\nuse = "lighting/{name}"\n{chosen}'
        sketch = bench.terrain(size, rest=rest)

        def run(sketch: Sketch = sketch) -> None:
            engine.texture(sketch.with_values({"height.seed": next(SEEDS) % 9999}), "light")
            engine.ctx.finish()

        yield Comparison(f"edit → lit terrain: {name}{form and ', ' + form}", {"auto": run})


COMPARISONS: dict[str, Callable[[Lighting, int], Iterator[Comparison]]] = {
    found.__name__: found for found in (horizons, shadows, thesis, dragged, edited)
}
"""What is timed, by the name it goes by on the command line."""


if __name__ == "__main__":
    run_all(__doc__ or "", Lighting, COMPARISONS)
