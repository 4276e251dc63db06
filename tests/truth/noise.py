"""The library's random numbers and noise, by definition: corner by corner, in float64."""

from __future__ import annotations

from itertools import product
from zlib import crc32

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Bits = NDArray[np.uint64]

WHOLE = 2**32
FINEST_SIDE = 2**15
"""Spacings of the lattice that points of terrains made by halving are keyed on, noise/finest.glsl."""
SHIFT = 0.618034
"""Of every octave of lattice noise, in its own cells, to the east."""
OCTAVE = 0xC2B2AE3D
COLUMN, ROW = 0x9E3779B1, 0x85EBCA77


def salt(name: str) -> int:
    """Return what a technique adds to its seed: the CRC-32 of its name, see noise/hash.glsl."""
    return crc32(name.encode())


def pcg3d(x: ArrayLike, y: ArrayLike, z: ArrayLike) -> list[Bits]:
    """Return pcg3d of keys, in the notation of Jarzynski and Olano's paper; numbers wrap at 2^32."""
    v = [(np.asarray(n, np.int64) % WHOLE).astype(np.uint64) * 1664525 + 1013904223 for n in (x, y, z)]
    v = [n % WHOLE for n in v]
    for last in (False, True):
        for i in range(3):
            v[i] = (v[i] + v[(i + 1) % 3] * v[(i + 2) % 3]) % WHOLE
        if not last:
            v = [n ^ (n >> 16) for n in v]
    return v


def python_random(x: ArrayLike, y: ArrayLike, seed: int, part: int = 0) -> Array:
    """Return noise/hash.glsl's ``random(point, seed)``, 0..1; ``part`` 1 is the second of ``random_pair``."""
    return np.asarray(pcg3d(x, y, seed)[part] >> 8, np.float64) / 2.0**24


def assert_white(values: Array) -> None:
    """Check that n x n numbers know nothing of each other: nearest lags at most 4/n, any at most 6/n."""
    n = len(values)
    power = np.abs(np.fft.fft2(values - values.mean())) ** 2
    correlation = np.fft.ifft2(power).real / power.mean()
    correlation[0, 0] = 0
    nearest = [correlation[0, 1], correlation[1, 0], correlation[1, 1], correlation[1, -1]]
    assert np.abs(nearest).max() <= 4 / n
    assert np.abs(correlation).max() <= 6 / n


def assert_even(values: Array) -> None:
    """Check that numbers are even over 0..1: within four standard errors of mean, variance and counts."""
    assert abs(values.mean() - 1 / 2) < 4 / np.sqrt(12 * values.size)
    assert abs(values.var() - 1 / 12) < 4 / np.sqrt(180 * values.size)
    counts = np.histogram(values, 64, (0, 1))[0]
    chi = ((counts - values.size / 64) ** 2 / (values.size / 64)).sum()
    assert 63 - 4 * np.sqrt(126) < chi < 63 + 5 * np.sqrt(126)


# ── lattices ─────────────────────────────────────────────────────────────────


def mixed(key: Bits) -> Bits:
    """Return one round of mixing, made odd."""
    key = key % WHOLE
    key = (key ^ (key // 2**15)) * 0x7FEB352D % WHOLE
    return key - key % 2 + 1


def bits(x: ArrayLike, y: ArrayLike, seed: int) -> Bits:
    """Return a lattice point's random bits, uint64 below 2^32."""
    x, y = (np.asarray(a).astype(np.int64) % WHOLE for a in np.broadcast_arrays(x, y))
    columns = mixed(x.astype(np.uint64) * np.uint64(COLUMN) + np.uint64(seed % WHOLE))
    rows = mixed(y.astype(np.uint64) * np.uint64(ROW) + np.uint64(seed % WHOLE))
    return columns * rows % WHOLE


def signed(number: Bits) -> Array:
    """Return the bits as a signed number, -1..1."""
    return ((number.astype(np.float64) + WHOLE / 2) % WHOLE - WHOLE / 2) / 2**31


def lattice_seed(seed: int, octave: int) -> int:
    """Return the seed of an octave."""
    return (seed * 0x2545F491 + octave * OCTAVE) % WHOLE


def gradient(number: Bits) -> tuple[Array, Array]:
    """Return the unit vector of some bits: 22.5 or 67.5 degrees, in the quarter that two more bits say."""
    eighth = number // 2**29
    angle = np.radians(np.where(eighth % 2 == 1, 67.5, 22.5))
    return (
        np.where(eighth >= 4, -1, 1) * np.cos(angle),
        np.where(eighth // 2 % 2 == 1, -1, 1) * np.sin(angle),
    )


def fade(t: ArrayLike) -> Array:
    """Return 6 t^5 - 15 t^4 + 10 t^3."""
    t = np.asarray(t, np.float64)
    return 6 * t**5 - 15 * t**4 + 10 * t**3


def perlin(x: ArrayLike, y: ArrayLike, seed: int) -> Array:
    """Return Perlin noise as a sum over four corners of weight times plane."""
    x, y = np.asarray(x, np.float64), np.asarray(y, np.float64)
    total = np.zeros(np.broadcast(x, y).shape)
    for i, j in product((0, 1), repeat=2):
        cx, cy = np.floor(x) + i, np.floor(y) + j
        gx, gy = gradient(bits(cx, cy, seed))
        dx, dy = x - cx, y - cy
        total = total + fade(1 - abs(dx)) * fade(1 - abs(dy)) * (gx * dx + gy * dy)
    return 1.513 * total


def simplex(x: Array, y: Array, seed: int) -> Array:
    """Return simplex noise as a sum over all lattice points near enough, not three that are picked."""
    skew, back = (np.sqrt(3) - 1) / 2, (3 - np.sqrt(3)) / 6
    x, y = x * np.sqrt(2 / 3), y * np.sqrt(2 / 3)  # triangles of side 1
    near_x, near_y = np.floor(x + (x + y) * skew), np.floor(y + (x + y) * skew)
    total = np.zeros(np.broadcast(x, y).shape)
    for i, j in product(range(-1, 3), repeat=2):
        cx, cy = near_x + i, near_y + j
        dx, dy = x - (cx - (cx + cy) * back), y - (cy - (cx + cy) * back)
        gx, gy = gradient(bits(cx, cy, seed))
        total = total + np.maximum(0.5 - dx**2 - dy**2, 0) ** 4 * (gx * dx + gy * dy)
    return 100.0 * total


def solid(position: Array, seed: int) -> Array:
    """Return noise of space as a sum over eight corners of weight times plane."""
    whole = np.floor(position)
    total = np.zeros(position.shape[:-1])
    for corner in product((0, 1), repeat=3):
        at = whole + corner
        layers = (at[..., 2].astype(np.int64) % WHOLE).astype(np.uint64)
        layers = mixed(layers * np.uint64(OCTAVE) + np.uint64(seed % WHOLE))
        number = bits(at[..., 0], at[..., 1], seed) * layers % WHOLE
        signs = np.stack([1.0 - 2.0 * (number // 2 ** (31 - k) % 2) for k in range(3)], axis=-1)
        way = position - at
        total = total + np.prod(fade(1 - abs(way)), axis=-1) * (signs * way).sum(axis=-1)
    return total * 2 / 3


NOISE = {"Perlin": perlin, "simplex": simplex}


def places(
    size: tuple[int, int], extent: tuple[float, float], frequency: float
) -> tuple[Array, Array, float]:
    """Return each texel's place in cells of the first octave, and the texels to a cell."""
    spacing = np.array(extent, float) / np.maximum(np.array(size) - 1, 1)
    cells = min(frequency / extent[0], 0.5 / spacing.max())
    y, x = np.mgrid[0 : size[1], 0 : size[0]]
    return x * spacing[0] * cells, y * spacing[1] * cells, 1 / (cells * spacing.max())


def sum_of_octaves(
    x: Array,
    y: Array,
    *,
    texels: float,
    basis: str = "Perlin",
    shape: str = "plain",
    octaves: int = 6,
    lacunarity: float = 2.0,
    gain: float = 0.5,
    seed: int = 7,
    warp: float = 0.4,
    name: str = "generation/gradient_noise",
) -> Array:
    """Return a sum of octaves at places in cells of the first; those finer than texels fade out."""
    value = {"basis": basis, "lacunarity": lacunarity, "gain": gain, "texels": texels, "name": name}
    if shape == "warped":

        def plain(x: Array, y: Array, more: int) -> Array:
            return sum_of_octaves(x, y, octaves=octaves, seed=seed + more, **value)

        return plain(x + warp * plain(x, y, 0x51ED270B), y + warp * plain(x, y, 0xA3DA4E16), 0)
    total, before = np.zeros(np.broadcast(x, y).shape), None
    for k in range(octaves):
        frequency = lacunarity**k
        visible = min(max(texels / frequency - 1, 0), 1)
        noise = NOISE[basis](x * frequency + SHIFT, y * frequency, lattice_seed(seed + salt(name), k))
        if shape == "billow":
            noise = 2 * abs(noise) - 1
        elif shape == "ridged":
            noise = (1 - abs(noise)) ** 2
            noise = noise if before is None else noise * np.minimum(2 * before, 1)
            before = noise
        total = total + visible * gain**k * noise
    return total
