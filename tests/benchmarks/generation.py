"""Time the techniques that make terrain against their alternatives, in one run.

    pip install ".[bench]"
    python tests/benchmarks/generation.py [--size 1025 4097] [--rounds 7] [--processor] [NAME…]

Each figure is the median of several runs, with a new seed each, ours and theirs alternately,
so that a busy machine slows both; techniques with a fast variant are timed in their plain form
as well. Nothing compiled is timed. Figures wander with the
machine; ratios less so. The thesis's own methods are compiled from thesis.c with cc -O2.
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np
from side_by_side import SEEDS, Bench, Comparison, Run, run_all

from playground.engine.engine import Engine
from playground.sketch.model import Sketch
from playground.sketch.variants import any_variants


class Generation(Bench):
    """The shared bench, with terrains of ours and of the thesis."""

    source = "thesis.c"

    def ours(
        self,
        use: str,
        ref: str,
        size: int,
        *,
        forms: str = "auto fragment plain",
        seed: str = "seed",
        **values: object,
    ) -> dict[str, Run]:
        """Return runs of a technique, a new seed each, up to the texture ``ref`` inside it ("": its last).

        Of one without a fast variant there is no plain form apart.
        """
        sketch = self.sketch(f'size = {size}\n[[pass]]\nname = "a"\nuse = "{use}"\n').with_values(
            {f"a.{name}": value for name, value in values.items()}
        )
        wanted = f"a.{ref}" if ref else "a"

        def run(form: str) -> None:
            engine = self.engines["auto" if form == "plain" else form]
            seeded = sketch.with_values({f"a.{seed}": next(SEEDS) % 9999})
            engine.texture(seeded.plainly() if form == "plain" else seeded, wanted)
            engine.ctx.finish()

        there = [f for f in forms.split() if f != "plain" or any_variants(sketch.graph.passes[0].technique)]
        return {form: partial(run, form) for form in there}

    def c(self, function: str, size: int, *arguments: float | int) -> dict[str, Run]:
        """Return a run of one of the thesis's methods in C; none where there is no compiler."""
        if self.thesis is None:
            return {}
        out = np.empty((size, size), np.float32)
        given = [ctypes.c_float(a) if isinstance(a, float) else ctypes.c_int(a) for a in arguments]
        called = getattr(self.thesis, function)

        def run() -> None:
            called(out.ctypes.data_as(ctypes.c_void_p), size, *given, ctypes.c_uint(next(SEEDS)))

        return {"the thesis's C": run}


# ── what others take ─────────────────────────────────────────────────────────


def fast_noise_lite(size: int, kind: str, octaves: int, lacunarity: float, gain: float) -> dict[str, Run]:
    """Return a run of FastNoise Lite over a grid of coordinates that is made beforehand."""
    try:
        from pyfastnoiselite.pyfastnoiselite import FastNoiseLite, FractalType, NoiseType
    except ImportError:
        return {}
    noise = FastNoiseLite(7)
    noise.noise_type = getattr(NoiseType, f"NoiseType_{kind}")
    noise.fractal_type = FractalType.FractalType_FBm
    noise.fractal_octaves, noise.fractal_lacunarity, noise.fractal_gain = octaves, lacunarity, gain
    noise.frequency = 4.0 / size
    along = np.arange(size, dtype=np.float32)
    places = np.stack([axis.ravel() for axis in np.meshgrid(along, along)]).astype(np.float32)
    return {f"pyfastnoiselite {kind}": lambda: noise.gen_from_coords(places)}


def open_simplex(size: int, octaves: int, lacunarity: float, gain: float) -> dict[str, Run]:
    """Return a run of opensimplex, octave by octave."""
    try:
        import opensimplex
    except ImportError:
        return {}
    noise = opensimplex.OpenSimplex(7)
    along = np.arange(size) * 4 / size

    def run() -> object:
        layers = (
            noise.noise2array(along * lacunarity**k, along * lacunarity**k) * gain**k for k in range(octaves)
        )
        return sum(layers)

    return {"opensimplex": run}


def scipy_fourier(size: int, roughness: float) -> dict[str, Run]:
    """Return a run of scipy.fft's whole pipeline: random grid, filter, inverse, brought to 0..1."""
    try:
        import scipy.fft
    except ImportError:
        return {}

    def run() -> object:
        grid = np.random.default_rng(next(SEEDS)).random((size, size), np.float32)
        spectrum = scipy.fft.rfft2(grid, workers=os.cpu_count())
        fy = scipy.fft.fftfreq(size, 1 / size).astype(np.float32)[:, None]
        fx = scipy.fft.rfftfreq(size, 1 / size).astype(np.float32)
        squared = fy * fy + fx * fx
        squared[0, 0] = 1.0
        spectrum *= squared ** np.float32(-roughness / 2)
        terrain = scipy.fft.irfft2(spectrum, s=grid.shape, workers=os.cpu_count())
        low, high = terrain.min(), terrain.max()
        return (terrain - low) / (high - low)

    return {"scipy.fft": run}


def numpy_diamond_square(size: int, smoothing: float) -> dict[str, Run]:
    """Return a run of diamond-square in NumPy, whole slices at a time, brought to 0..1."""

    def run() -> object:
        random = np.random.default_rng(next(SEEDS))
        terrain = np.zeros((size, size), np.float32)
        terrain[:: size - 1, :: size - 1] = 0.5
        spacing = size - 1
        while spacing > 1:
            half, scale = spacing // 2, np.float32(2 * smoothing * spacing / (size - 1))
            corners = terrain[::spacing, ::spacing]
            mean = (corners[:-1, :-1] + corners[1:, :-1] + corners[:-1, 1:] + corners[1:, 1:]) * np.float32(
                0.25
            )
            terrain[half::spacing, half::spacing] = (
                mean + (random.random(mean.shape, np.float32) - 0.5) * scale
            )
            ring = np.pad(terrain[::half, ::half], 1)
            there = np.pad(np.ones((ring.shape[0] - 2, ring.shape[1] - 2), np.float32), 1)
            total = ring[:-2, 1:-1] + ring[2:, 1:-1] + ring[1:-1, :-2] + ring[1:-1, 2:]
            count = there[:-2, 1:-1] + there[2:, 1:-1] + there[1:-1, :-2] + there[1:-1, 2:]
            edges = total / count + (random.random(total.shape, np.float32) - 0.5) * scale
            terrain[::spacing, half::spacing] = edges[::2, 1::2]
            terrain[half::spacing, ::spacing] = edges[1::2, ::2]
            spacing = half
        low, high = terrain.min(), terrain.max()
        return (terrain - low) / (high - low)

    return {"NumPy": run}


def numpy_faults(size: int, faults: int) -> dict[str, Run]:
    """Return a run of fault formation in NumPy: a comparison over the terrain for each fault."""

    def run() -> object:
        random = np.random.default_rng(next(SEEDS))
        along = np.linspace(0, 1, size, dtype=np.float32)
        terrain = np.zeros((size, size), np.float32)
        for k in range(faults):
            (x0, y0), (x1, y1) = random.random((2, 2), np.float32)
            side = (x1 - x0) * (along[:, None] - y0) > (y1 - y0) * (along[None, :] - x0)
            terrain += np.where(side, 1 - k / faults, k / faults - 1).astype(np.float32)
        return terrain

    return {"NumPy": run}


# ── what is compared ─────────────────────────────────────────────────────────


def layered_noise(bench: Generation, size: int) -> Iterator[Comparison]:
    """Compare the thesis's layers: as noise with libraries, as a whole with its own C."""
    theirs = fast_noise_lite(size, "Value", 2, 4.0, 0.2) | open_simplex(size, 2, 4.0, 0.2)
    yield Comparison(
        "layered_noise, before normalisation",
        bench.ours("generation/layered_noise", "sum", size),
        theirs,
        "≥ 5 auto",
    )
    yield Comparison(
        "layered_noise",
        bench.ours("generation/layered_noise", "", size),
        bench.c("layered_noise", size, 4, 2, 0.2),
    )


def gradient_noise(bench: Generation, size: int) -> Iterator[Comparison]:
    """Compare six octaves of gradient noise with libraries."""
    theirs = fast_noise_lite(size, "Perlin", 6, 2.0, 0.5) | open_simplex(size, 6, 2.0, 0.5)
    yield Comparison(
        "gradient_noise, before normalisation",
        bench.ours("generation/gradient_noise", "sum", size),
        theirs,
        "≥ 5 auto",
    )
    yield Comparison("gradient_noise", bench.ours("generation/gradient_noise", "", size))


def fourier(bench: Generation, size: int) -> Iterator[Comparison]:
    """Compare the spectral terrain with scipy.fft, at the power of two below."""
    even = size - size % 2
    yield Comparison(
        f"fourier at {even}", bench.ours("generation/fourier", "", even), scipy_fourier(even, 2.0), "≥ 1 auto"
    )


def diamond_square(bench: Generation, size: int) -> Iterator[Comparison]:
    """Compare diamond-square, normalised, with the thesis's C and with NumPy."""
    theirs = bench.c("diamond_square", size, 0.2) | numpy_diamond_square(size, 0.2)
    ours = bench.ours("generation/diamond_square", "", size, normalise="max")
    yield Comparison("diamond_square, normalised", ours, theirs, "≥ 5 auto, ≥ 0.4 fragment")


def fault_formation(bench: Generation, size: int) -> Iterator[Comparison]:
    """Time 200 faults: alone, and with their smoothing and normalisation."""
    theirs = numpy_faults(size, 200)
    for what, ref, wanted in (
        ("200 faults", "sum", "≤ 20 ms auto, ≤ 150 ms fragment at 1025²"),
        ("fault_formation, 200 faults", "", ""),
    ):
        ours = bench.ours("generation/fault_formation", ref, size, iterations=200)
        yield Comparison(what, ours, theirs, wanted)


def models(bench: Generation, size: int) -> Iterator[Comparison]:
    """Compare the thesis's own models with its Perlin: its claims, as ratios."""
    base = bench.ours("generation/layered_noise", "", size, forms="auto")["auto"]
    shape = bench.ours("generation/diamond_square", "", size, forms="auto")["auto"]
    for name, seed in (("mixed", "seed"), ("mixed_tiled", "seed"), ("layered_noise_tiled", "seed")):
        ours = bench.ours(f"generation/{name}", "", size, seed=seed)
        theirs = {"layered_noise": base, "diamond_square": shape}
        theirs |= bench.c("mixed", size, 0.2, 32, 1, 0.04) if name == "mixed" else {}
        yield Comparison(name, ours, theirs, "report")


def multiply(bench: Generation, size: int) -> Iterator[Comparison]:
    """Compare a product with one of its factors: the thesis says that it costs twice as much."""
    factor = '[[pass]]\nname = "{}"\nuse = "generation/{}"\nset = {{ normalise = "minmax" }}\n'
    product = (
        '[[pass]]\nname = "a"\nuse = "generation/multiply"\ninputs = { first = "one", second = "other" }\n'
    )
    for name in ("diamond_square", "fourier"):
        side = size - size % 2 if name == "fourier" else size
        passes = factor.format("one", name) + factor.format("other", name) + product
        sketch = bench.sketch(f"size = {side}\n{passes}")

        def run(engine: Engine, sketch: Sketch = sketch) -> None:
            seeds = {f"{factor}.seed": next(SEEDS) % 9999 for factor in ("one", "other")}
            engine.texture(sketch.with_values(seeds), "a")
            engine.ctx.finish()

        ours: dict[str, Run] = {d: (lambda e=e, r=run: r(e)) for d, e in bench.engines.items()}  # type: ignore[misc]
        theirs = {name: bench.ours(f"generation/{name}", "", side, forms="auto", normalise="minmax")["auto"]}
        yield Comparison(f"multiply, two by {name}", ours, theirs, "0.5, says the thesis")


def others(bench: Generation, size: int) -> Iterator[Comparison]:
    """Time the rest."""
    for name in (
        "fbm",
        "white_noise",
        "triangle_subdivision",
        "midpoint_displacement",
        "circles",
        "delaunay",
    ):
        yield Comparison(name, bench.ours(f"generation/{name}", "", size))


COMPARISONS: dict[str, Callable[[Generation, int], Iterator[Comparison]]] = {
    found.__name__: found
    for found in (
        layered_noise,
        gradient_noise,
        fourier,
        diamond_square,
        fault_formation,
        models,
        multiply,
        others,
    )
}
"""What is timed, by the name it goes by on the command line."""


if __name__ == "__main__":
    run_all(__doc__ or "", Generation, COMPARISONS)
