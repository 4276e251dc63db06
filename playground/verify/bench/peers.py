"""What else does the same: libraries, NumPy and SciPy, the thesis's C, other methods of our own.

A peer is made by the name in a row's ``peers``; its other keys are its arguments. One whose library is not
installed is left out, which is said. Peers are timed, and tell nothing about what is right.
"""

from __future__ import annotations

import ctypes
import importlib
import math
import shutil
import subprocess
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.verify.bench.context import BenchContext, Run, changing, processors

HERE = Path(__file__).resolve().parent
SOURCES = ("thesis.c", "thesis_light.c")


@dataclass
class Peer:
    """A peer of one row at one size."""

    name: str
    run: Run
    once: bool = False  # too slow to run more than once
    alone: bool = False  # uses one processor


@dataclass
class PeerSetup:
    """What a peer is made for."""

    context: BenchContext
    size: int
    row: Mapping[str, Any]
    missing: list[str] = field(default_factory=list)  # libraries that are not installed

    def library(self, name: str) -> Any:
        """Return a library, or None where it is not installed, which is noted."""
        try:
            return importlib.import_module(name)
        except ImportError:
            self.missing.append(name.partition(".")[0])
            return None

    def thesis(self) -> Thesis | None:
        """Return the thesis's own methods; None where there is no compiler, which is said."""
        thesis = _thesis_in(self.context.folder)
        if thesis is None:
            self.context.options.say(
                "no C compiler (cc, gcc, clang) on PATH: the thesis's methods are left out"
            )
        return thesis

    def heights(self, ref: str = "height") -> NDArray[np.float32]:
        """Return the heights of the row's terrain in metres, rows from the south."""
        sketch = self.context.sketch(self.row, self.size)
        return self.context.engine().metres(sketch, ref)


def _fast_noise_lite(to: PeerSetup, noise: str, octaves: int, lacunarity: float, gain: float) -> Peer | None:
    library = to.library("pyfastnoiselite.pyfastnoiselite")
    if library is None:
        return None
    made = library.FastNoiseLite(7)
    made.noise_type = getattr(library.NoiseType, f"NoiseType_{noise}")
    made.fractal_type = library.FractalType.FractalType_FBm
    made.fractal_octaves, made.fractal_lacunarity, made.fractal_gain = octaves, lacunarity, gain
    made.frequency = 4.0 / to.size
    along = np.arange(to.size, dtype=np.float32)
    places = np.stack([axis.ravel() for axis in np.meshgrid(along, along)]).astype(np.float32)
    return Peer(f"pyfastnoiselite {noise}", lambda: made.gen_from_coords(places))


def _opensimplex(to: PeerSetup, octaves: int, lacunarity: float, gain: float) -> Peer | None:
    library = to.library("opensimplex")
    if library is None:
        return None
    noise, along = library.OpenSimplex(7), np.arange(to.size) * 4 / to.size

    def run() -> object:
        scales = [(lacunarity**k, gain**k) for k in range(octaves)]
        return sum(noise.noise2array(along * scale, along * scale) * weight for scale, weight in scales)

    return Peer("opensimplex", run)


def _scipy_fourier(to: PeerSetup, roughness: float) -> Peer | None:
    """Return SciPy's whole pipeline: random grid, transform, filter, inverse, brought to 0..1."""
    fft = to.library("scipy.fft")
    if fft is None:
        return None
    size, workers = to.size - to.size % 2, processors()

    def run() -> object:
        grid = np.random.default_rng(to.context.seed()).random((size, size), np.float32)
        spectrum = fft.rfft2(grid, workers=workers)
        fy = fft.fftfreq(size, 1 / size).astype(np.float32)[:, None]
        fx = fft.rfftfreq(size, 1 / size).astype(np.float32)
        squared = fy * fy + fx * fx
        squared[0, 0] = 1.0
        spectrum *= squared ** np.float32(-roughness / 2)
        return _stretched(fft.irfft2(spectrum, s=grid.shape, workers=workers))

    return Peer("scipy.fft", run)


def _numpy_diamond_square(to: PeerSetup, smoothing: float) -> Peer:
    """Return diamond-square in NumPy, whole slices at a time, brought to 0..1."""
    size = to.size

    def run() -> object:
        random = np.random.default_rng(to.context.seed())
        terrain = np.zeros((size, size), np.float32)
        terrain[:: size - 1, :: size - 1] = 0.5
        spacing = size - 1
        while spacing > 1:
            half, scale = spacing // 2, np.float32(2 * smoothing * spacing / (size - 1))
            corners = terrain[::spacing, ::spacing]
            total = corners[:-1, :-1] + corners[1:, :-1] + corners[:-1, 1:] + corners[1:, 1:]
            mean = total * np.float32(0.25)
            noise = (random.random(mean.shape, np.float32) - 0.5) * scale
            terrain[half::spacing, half::spacing] = mean + noise
            ring = np.pad(terrain[::half, ::half], 1)
            there = np.pad(np.ones((ring.shape[0] - 2, ring.shape[1] - 2), np.float32), 1)
            total = ring[:-2, 1:-1] + ring[2:, 1:-1] + ring[1:-1, :-2] + ring[1:-1, 2:]
            count = there[:-2, 1:-1] + there[2:, 1:-1] + there[1:-1, :-2] + there[1:-1, 2:]
            edges = total / count + (random.random(total.shape, np.float32) - 0.5) * scale
            terrain[::spacing, half::spacing] = edges[::2, 1::2]
            terrain[half::spacing, ::spacing] = edges[1::2, ::2]
            spacing = half
        return _stretched(terrain)

    return Peer("NumPy", run, alone=True)


def _numpy_faults(to: PeerSetup, faults: int) -> Peer:
    """Return fault formation in NumPy: a comparison over the terrain for each fault."""
    size = to.size

    def run() -> object:
        random = np.random.default_rng(to.context.seed())
        along = np.linspace(0, 1, size, dtype=np.float32)
        terrain = np.zeros((size, size), np.float32)
        for k in range(faults):
            (x0, y0), (x1, y1) = random.random((2, 2), np.float32)
            side = (x1 - x0) * (along[:, None] - y0) > (y1 - y0) * (along[None, :] - x0)
            terrain += np.where(side, 1 - k / faults, k / faults - 1).astype(np.float32)
        return terrain

    return Peer("NumPy", run, alone=True)


def _stretched(terrain: NDArray[np.float32]) -> NDArray[np.float32]:
    low, high = terrain.min(), terrain.max()
    stretched: NDArray[np.float32] = (terrain - low) / (high - low)
    return stretched


# ── the thesis's own methods ─────────────────────────────────────────────────


@cache
def _thesis_in(folder: Path) -> Thesis | None:
    """Return the thesis's methods, compiled into a folder with -O2; None where there is no compiler."""
    compiler = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
    if compiler is None:
        return None
    library = folder / "thesis.so"
    sources = [str(HERE / name) for name in SOURCES]
    options = ["-O2", "-shared", "-fPIC", "-o", str(library), *sources, "-lm"]
    subprocess.run([compiler, *options], check=True, capture_output=True)
    return Thesis(ctypes.CDLL(str(library)))


class Thesis:
    """A library of the thesis's methods, in C as its pseudo-code has them."""

    def __init__(self, library: ctypes.CDLL) -> None:
        self._library = library

    def terrain(self, function: str, size: int, arguments: Sequence[float | int], seed: Run) -> Run:
        """Return a run of a method that makes terrain; ``seed`` gives each its seed."""
        out = np.empty((size, size), np.float32)
        value = [ctypes.c_float(a) if isinstance(a, float) else ctypes.c_int(a) for a in arguments]
        called = getattr(self._library, function)

        def run() -> None:
            called(out.ctypes.data_as(ctypes.c_void_p), size, *value, ctypes.c_uint(seed()))  # type: ignore[arg-type]

        return run

    def light(
        self, function: str, grey: NDArray[np.float32], elevation: float, more: Sequence[float], down: bool
    ) -> Run:
        """Return a run of a method that lights heights in texels, (ny, nx), each time from elsewhere.

        It takes the way to the sun, or the light's way ``down``.
        """
        out = np.empty_like(grey)
        called = getattr(self._library, function)
        turns = iter(range(10**9))
        level = math.cos(math.radians(elevation))
        turned = -1.0 if down else 1.0

        def run() -> None:
            azimuth = math.radians(20.0 + 137.508 * next(turns))
            way = (
                level * math.sin(azimuth),
                level * math.cos(azimuth),
                math.sin(math.radians(elevation)),
            )
            called(
                grey.ctypes.data_as(ctypes.c_void_p),
                out.ctypes.data_as(ctypes.c_void_p),
                grey.shape[0],
                *(ctypes.c_float(turned * component) for component in way),
                *(ctypes.c_float(number) for number in more),
            )

        return run


def _thesis_terrain(to: PeerSetup, function: str, arguments: list[float | int]) -> Peer | None:
    thesis = to.thesis()
    if thesis is None:
        return None
    return Peer("the thesis's C", thesis.terrain(function, to.size, arguments, to.context.seed), alone=True)


def _thesis_light(
    to: PeerSetup, function: str, more: tuple[float, ...] = (), down: bool = False
) -> Peer | None:
    thesis = to.thesis()
    if thesis is None:
        return None
    grey = np.ascontiguousarray(to.heights() / np.float32(to.row["texel"]), dtype=np.float32)
    run = thesis.light(function, grey, float(to.row["elevation"]), more, down)
    return Peer("the thesis's C", run, alone=True)


# ── horizons and the sky over them: a sweep along lines, and topocalc ────────

SHIFT = 16  # a line drifts by whole 65536ths of a texel a row


def _sky_view(swept: Any, heights: np.ndarray, spacing: float, directions: int) -> np.ndarray:
    """Return the cosine-weighted sky-view factor of level surfaces (ny, nx) by one sweep a direction."""
    total = np.zeros(heights.shape, np.float32)
    turned = np.ascontiguousarray(heights.T)
    total_turned = np.zeros(turned.shape, np.float32)
    for number in range(directions):
        angle = 2 * math.pi * number / directions
        east, north = math.sin(angle), math.cos(angle)
        along_rows = abs(east) >= abs(north) - 1e-12
        ahead, aside = (east, north) if along_rows else (north, east)
        swept(
            heights if along_rows else turned,
            round(aside / abs(ahead) * (1 << SHIFT)),
            ahead > 0,
            np.float32(abs(ahead) / spacing),
            total if along_rows else total_turned,
        )
    return (total + total_turned.T) / directions


def _sweep_by(numba: Any) -> Any:
    """Return the sweep along lines in one direction, compiled."""

    def sweep(heights: Any, drift: int, upwards: bool, steep: Any, total: Any) -> None:
        """Add the squared cosine of each texel's horizon: lines run along the last axis.

        Each line keeps the upper hull of what it has passed (Timonen and Westerholm 2010).
        """
        across, rows = heights.shape
        half = 1 << (SHIFT - 1)
        top = ((rows - 1) * abs(drift) + half) >> SHIFT
        first = -top if drift > 0 else 0
        end = across + top if drift < 0 else across
        for line in numba.prange(first, end):
            tall = np.empty(rows + 1, np.float32)
            far = np.empty(rows + 1, np.float32)
            last = -1
            for row in range(rows - 1, -1, -1):
                at = line + ((row * drift + half) >> SHIFT)
                if at < 0 or at >= across:
                    continue
                along = row if upwards else rows - 1 - row
                here = heights[at, along]
                position = np.float32(row)
                best = np.float32(-1e30)
                while last >= 0:
                    slope = (tall[last] - here) / (far[last] - position)
                    if slope < best:
                        break
                    best = slope
                    last -= 1
                if best > np.float32(-1e29):
                    last += 1
                last += 1
                tall[last] = here
                far[last] = position
                tangent = max(best, np.float32(0)) * steep
                total[at, along] += np.float32(1) / (np.float32(1) + tangent * tangent)

    return numba.njit(parallel=True, fastmath=True, error_model="numpy")(sweep)


def _numba_horizons(to: PeerSetup, directions: int) -> Peer | None:
    numba = to.library("numba")
    if numba is None:
        return None
    swept = _sweep_by(numba)
    heights, texel = to.heights(), float(to.row["texel"])
    return Peer("Numba sweep", lambda: _sky_view(swept, heights, texel, directions))


def _topocalc_horizons(to: PeerSetup, directions: int) -> Peer | None:
    topocalc = to.library("topocalc.viewf")
    if topocalc is None or to.size > 2000:
        return None
    heights, texel = to.heights().astype(np.float64), float(to.row["texel"])

    def run() -> object:
        return topocalc.viewf(heights, texel, nangles=directions)[0]

    return Peer("topocalc", run, once=True, alone=True)


# ── of our own ───────────────────────────────────────────────────────────────


def _ours(to: PeerSetup, name: str, **changed: Any) -> Peer:
    """Return another texture of our own: the row with some of its keys changed."""
    row = {**to.row, **changed}
    context, engine = to.context, to.context.engine()
    sketch, change, texture = context.sketch(row, to.size), changing(context, row), str(row["texture"])

    def run() -> None:
        engine.texture(change(sketch), texture)
        engine.ctx.finish()

    return Peer(name, run)


PEERS: dict[str, Callable[..., Peer | None]] = {
    "fast_noise_lite": _fast_noise_lite,
    "opensimplex": _opensimplex,
    "scipy_fourier": _scipy_fourier,
    "numpy_diamond_square": _numpy_diamond_square,
    "numpy_faults": _numpy_faults,
    "thesis_terrain": _thesis_terrain,
    "thesis_light": _thesis_light,
    "numba_horizons": _numba_horizons,
    "topocalc_horizons": _topocalc_horizons,
    "ours": _ours,
}
"""What makes each peer, by the name that rows give it."""


def made(setting: PeerSetup, row: Mapping[str, Any]) -> Peer | None:
    """Make a peer of a row; None where what it needs is not here."""
    options = dict(row)
    return PEERS[options.pop("peer")](setting, **options)
