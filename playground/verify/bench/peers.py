"""What else does the same: libraries, NumPy and SciPy, the thesis's C, other methods of our own.

A peer is made by the name in a row's ``peers``; its other keys are its arguments. One whose library is not
installed is left out, which is said.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.verify.bench import horizon_peers
from playground.verify.bench.room import Room, changing, processors
from playground.verify.bench.timing import Run


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

    room: Room
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

    def heights(self, ref: str = "height") -> NDArray[np.float32]:
        """Return the heights of the row's terrain in metres, rows from the south."""
        sketch = self.room.sketch(self.row, self.size)
        return self.room.engine().metres(sketch, ref)


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
        return sum(noise.noise2array(along * scale, along * scale) * share for scale, share in scales)

    return Peer("opensimplex", run)


def _scipy_fourier(to: PeerSetup, roughness: float) -> Peer | None:
    """Return SciPy's whole pipeline: random grid, transform, filter, inverse, brought to 0..1."""
    fft = to.library("scipy.fft")
    if fft is None:
        return None
    size, workers = to.size - to.size % 2, processors()

    def run() -> object:
        grid = np.random.default_rng(to.room.seed()).random((size, size), np.float32)
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
        random = np.random.default_rng(to.room.seed())
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
        random = np.random.default_rng(to.room.seed())
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


def _thesis_terrain(to: PeerSetup, function: str, arguments: list[float | int]) -> Peer | None:
    thesis = to.room.thesis
    if thesis is None:
        return None
    return Peer("the thesis's C", thesis.terrain(function, to.size, arguments, to.room.seed), alone=True)


def _thesis_light(
    to: PeerSetup, function: str, more: tuple[float, ...] = (), down: bool = False
) -> Peer | None:
    thesis = to.room.thesis
    if thesis is None:
        return None
    grey = np.ascontiguousarray(to.heights() / np.float32(to.row["texel"]), dtype=np.float32)
    run = thesis.light(function, grey, float(to.row["elevation"]), more, down)
    return Peer("the thesis's C", run, alone=True)


def _numba_horizons(to: PeerSetup, directions: int) -> Peer | None:
    if horizon_peers.numba is None:
        to.missing.append("numba")
        return None
    heights, texel = to.heights(), float(to.row["texel"])
    return Peer("Numba sweep", lambda: horizon_peers.numba_sweep(heights, texel, directions))


def _topocalc_horizons(to: PeerSetup, directions: int) -> Peer | None:
    if horizon_peers.viewf is None or to.size > 2000:
        return None
    heights, texel = to.heights(), float(to.row["texel"])
    run: Run = lambda: horizon_peers.topocalc(heights, texel, directions)  # noqa: E731
    return Peer("topocalc", run, once=True, alone=True)


def _ours(to: PeerSetup, name: str, **changed: Any) -> Peer:
    """Return another texture of our own: the row with some of its keys changed."""
    row = {**to.row, **changed}
    room, engine = to.room, to.room.engine()
    sketch, change, texture = room.sketch(row, to.size), changing(room, row), str(row["texture"])

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
