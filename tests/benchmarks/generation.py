"""Time the techniques that make land beside what one would take instead, in one run.

    pip install ".[bench]"
    python tests/benchmarks/generation.py [--size 1025 4097] [--rounds 7] [NAME…]

Each figure is the median of several runs, with a new seed each, ours and theirs in turn,
so that a busy machine slows both. Nothing compiled is timed. Figures wander with the
machine; ratios less so. The thesis's own methods are compiled from thesis.c with cc -O2.
"""

from __future__ import annotations

import argparse
import ctypes
import itertools
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from playground.engine.engine import Engine
from playground.gpu.context import open_context
from playground.sketch.load import load

HERE = Path(__file__).resolve().parent
SEEDS = itertools.count(1)
Run = Callable[[], object]


@dataclass
class Comparison:
    """Something of ours, and what stands beside it."""

    what: str
    ours: dict[str, Run]  # by driver
    theirs: dict[str, Run] = field(default_factory=dict)
    wanted: str = ""


def main() -> None:
    """Run every comparison and print one table a size."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="only these comparisons, as fourier")
    parser.add_argument("--size", type=int, nargs="+", default=[1025, 4097], help="texels a side")
    parser.add_argument("--rounds", type=int, default=7, help="runs of each (default 7)")
    options = parser.parse_args()
    unknown = [name for name in options.names if name not in COMPARISONS]
    if unknown:
        parser.error(f"no comparison '{unknown[0]}'; there are: {', '.join(COMPARISONS)}")
    console = Console(width=None if sys.stdout.isatty() else 150)
    with Bench() as bench:
        console.print(f"{bench.renderer}, {os.cpu_count()} processors", highlight=False)
        costs: dict[tuple[str, int], float] = {}
        for size in options.size:
            table = Table(title=f"{size} x {size}, milliseconds (medians of {options.rounds})")
            for heading in ("what", "auto", "fragment", "beside it", "ms", "ratio", "wanted"):
                table.add_column(heading, justify="left" if heading in ("what", "beside it") else "right")
            for name, make in COMPARISONS.items():
                if options.names and name not in options.names:
                    continue
                for comparison in make(bench, size):
                    _add(table, comparison, options.rounds, costs, size)
            console.print(table)
        _growth(console, costs, options.size)


def _add(
    table: Table, comparison: Comparison, rounds: int, costs: dict[tuple[str, int], float], size: int
) -> None:
    runs = comparison.ours | comparison.theirs
    times = alternated(runs, rounds)
    if "auto" in times:
        costs[comparison.what, size] = times["auto"]
    ours = [f"{times[d]:.1f}" if d in times else "" for d in ("auto", "fragment")]
    if not comparison.theirs:
        table.add_row(comparison.what, *ours, "", "", "", comparison.wanted)
    for index, name in enumerate(comparison.theirs):
        ratios = " / ".join(f"{times[name] / times[d]:.2f}" for d in comparison.ours)
        head = (comparison.what, *ours) if index == 0 else ("", "", "")
        table.add_row(*head, name, f"{times[name]:.1f}", ratios, comparison.wanted if index == 0 else "")


def _growth(console: Console, costs: dict[tuple[str, int], float], sizes: list[int]) -> None:
    if len(sizes) < 2:
        return
    low, high = min(sizes), max(sizes)
    table = Table(title=f"cost per texel at {high}², over that at {low}² (wanted: at most 1.3)")
    table.add_column("what")
    table.add_column("ratio", justify="right")
    for what in dict.fromkeys(name for name, _ in costs):
        if (what, low) in costs and (what, high) in costs:
            table.add_row(what, f"{costs[what, high] / costs[what, low] * (low / high) ** 2:.2f}")
    console.print(table)


def alternated(runs: dict[str, Run], rounds: int) -> dict[str, float]:
    """Return the median milliseconds of each, after one unmeasured run of each; they take turns."""
    times: dict[str, list[float]] = {name: [] for name in runs}
    for turn in range(rounds + 1):
        for name, run in runs.items():
            start = time.perf_counter()
            run()
            if turn:
                times[name].append((time.perf_counter() - start) * 1e3)
    return {name: statistics.median(found) for name, found in times.items()}


class Bench:
    """Engines of both drivers, a folder for sketches, and the thesis's methods in C."""

    def __init__(self) -> None:
        self.ctx = open_context()
        self.folder = Path(tempfile.mkdtemp(prefix="playground-bench-"))
        self.engines = {driver: Engine(self.ctx, driver=driver) for driver in ("auto", "fragment")}
        self.renderer = self.engines["auto"].info.renderer
        self.thesis = _compiled(self.folder)

    def __enter__(self) -> Bench:
        return self

    def __exit__(self, *error: object) -> None:
        for engine in self.engines.values():
            engine.release()
        self.ctx.release()
        shutil.rmtree(self.folder)

    def ours(
        self,
        use: str,
        ref: str,
        size: int,
        *,
        drivers: str = "auto fragment",
        seed: str = "seed",
        **values: object,
    ) -> dict[str, Run]:
        """Return runs of a technique, a new seed each, up to the texture ``ref`` inside it ("": its last)."""
        path = self.folder / f"{next(SEEDS)}.toml"
        path.write_text(f'format = 1\nsize = {size}\n[[pass]]\nname = "a"\nuse = "{use}"\n')
        sketch = load(path).with_values({f"a.{name}": value for name, value in values.items()})
        wanted = f"a.{ref}" if ref else "a"

        def run(engine: Engine) -> None:
            engine.texture(sketch.with_values({f"a.{seed}": next(SEEDS) % 9999}), wanted)
            engine.ctx.finish()

        return {driver: (lambda e=self.engines[driver]: run(e)) for driver in drivers.split()}  # type: ignore[misc]

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


def _compiled(folder: Path) -> ctypes.CDLL | None:
    compiler = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        print("no C compiler: the thesis's own methods are left out", file=sys.stderr)
        return None
    library = folder / "thesis.so"
    options = ["-O2", "-shared", "-fPIC", "-o", str(library), str(HERE / "thesis.c"), "-lm"]
    subprocess.run([compiler, *options], check=True)
    return ctypes.CDLL(str(library))


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
        land = scipy.fft.irfft2(spectrum, s=grid.shape, workers=os.cpu_count())
        low, high = land.min(), land.max()
        return (land - low) / (high - low)

    return {"scipy.fft": run}


def numpy_diamond_square(size: int, smoothing: float) -> dict[str, Run]:
    """Return a run of diamond-square in NumPy, whole slices at a time, brought to 0..1."""

    def run() -> object:
        random = np.random.default_rng(next(SEEDS))
        land = np.zeros((size, size), np.float32)
        land[:: size - 1, :: size - 1] = 0.5
        spacing = size - 1
        while spacing > 1:
            half, scale = spacing // 2, np.float32(2 * smoothing * spacing / (size - 1))
            corners = land[::spacing, ::spacing]
            mean = (corners[:-1, :-1] + corners[1:, :-1] + corners[:-1, 1:] + corners[1:, 1:]) * np.float32(
                0.25
            )
            land[half::spacing, half::spacing] = mean + (random.random(mean.shape, np.float32) - 0.5) * scale
            ring = np.pad(land[::half, ::half], 1)
            there = np.pad(np.ones((ring.shape[0] - 2, ring.shape[1] - 2), np.float32), 1)
            total = ring[:-2, 1:-1] + ring[2:, 1:-1] + ring[1:-1, :-2] + ring[1:-1, 2:]
            count = there[:-2, 1:-1] + there[2:, 1:-1] + there[1:-1, :-2] + there[1:-1, 2:]
            edges = total / count + (random.random(total.shape, np.float32) - 0.5) * scale
            land[::spacing, half::spacing] = edges[::2, 1::2]
            land[half::spacing, ::spacing] = edges[1::2, ::2]
            spacing = half
        low, high = land.min(), land.max()
        return (land - low) / (high - low)

    return {"NumPy": run}


def numpy_faults(size: int, faults: int) -> dict[str, Run]:
    """Return a run of fault formation in NumPy: a comparison over the land for each fault."""

    def run() -> object:
        random = np.random.default_rng(next(SEEDS))
        along = np.linspace(0, 1, size, dtype=np.float32)
        land = np.zeros((size, size), np.float32)
        for k in range(faults):
            (x0, y0), (x1, y1) = random.random((2, 2), np.float32)
            side = (x1 - x0) * (along[:, None] - y0) > (y1 - y0) * (along[None, :] - x0)
            land += np.where(side, 1 - k / faults, k / faults - 1).astype(np.float32)
        return land

    return {"NumPy": run}


# ── what is compared ─────────────────────────────────────────────────────────


def layered_noise(bench: Bench, size: int) -> Iterator[Comparison]:
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


def gradient_noise(bench: Bench, size: int) -> Iterator[Comparison]:
    """Compare six octaves of gradient noise with libraries."""
    theirs = fast_noise_lite(size, "Perlin", 6, 2.0, 0.5) | open_simplex(size, 6, 2.0, 0.5)
    yield Comparison(
        "gradient_noise, before normalisation",
        bench.ours("generation/gradient_noise", "sum", size),
        theirs,
        "≥ 5 auto",
    )
    yield Comparison("gradient_noise", bench.ours("generation/gradient_noise", "", size))


def fourier(bench: Bench, size: int) -> Iterator[Comparison]:
    """Compare the spectral land with scipy.fft, at the power of two below."""
    even = size - size % 2
    yield Comparison(
        f"fourier at {even}", bench.ours("generation/fourier", "", even), scipy_fourier(even, 2.0), "≥ 1 auto"
    )


def diamond_square(bench: Bench, size: int) -> Iterator[Comparison]:
    """Compare diamond-square, normalised, with the thesis's C and with NumPy."""
    theirs = bench.c("diamond_square", size, 0.2) | numpy_diamond_square(size, 0.2)
    ours = bench.ours("generation/diamond_square", "", size, normalise="max")
    yield Comparison("diamond_square, normalised", ours, theirs, "≥ 5 auto, ≥ 0.4 fragment")


def fault_formation(bench: Bench, size: int) -> Iterator[Comparison]:
    """Time 200 faults: alone, and with their smoothing and normalisation."""
    theirs = numpy_faults(size, 200)
    for what, ref, wanted in (
        ("200 faults", "sum", "≤ 20 ms auto, ≤ 150 ms fragment at 1025²"),
        ("fault_formation, 200 faults", "", ""),
    ):
        ours = bench.ours("generation/fault_formation", ref, size, iterations=200)
        yield Comparison(what, ours, theirs, wanted)


def models(bench: Bench, size: int) -> Iterator[Comparison]:
    """Compare the thesis's own models with its Perlin: its claims, as ratios."""
    base = bench.ours("generation/layered_noise", "", size, drivers="auto")["auto"]
    shape = bench.ours("generation/diamond_square", "", size, drivers="auto")["auto"]
    for name, seed in (("mixed", "seed"), ("mixed_tiled", "seed"), ("layered_noise_tiled", "seed")):
        ours = bench.ours(f"generation/{name}", "", size, seed=seed)
        theirs = {"layered_noise": base, "diamond_square": shape}
        theirs |= bench.c("mixed", size, 0.2, 32, 1, 0.04) if name == "mixed" else {}
        yield Comparison(name, ours, theirs, "report")


def others(bench: Bench, size: int) -> Iterator[Comparison]:
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


COMPARISONS: dict[str, Callable[[Bench, int], Iterator[Comparison]]] = {
    found.__name__: found
    for found in (layered_noise, gradient_noise, fourier, diamond_square, fault_formation, models, others)
}
"""What is timed, by the name it goes by on the command line."""


if __name__ == "__main__":
    main()
