"""FLIP: how different two pictures look to someone who flips between them, 0..1 at every pixel.

Written from P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström and
M. D. Fairchild 2020, "FLIP: A Difference Evaluator for Alternating Images" (Proceedings of the
ACM on Computer Graphics and Interactive Techniques 3(2)), section 4; the numbers below are that
paper's. Both pictures are blurred as far as the eye blurs, colours are compared where equal
distances look equally different, and the result grows where edges or points come or go.

Alpha: both pictures are composited over black and over white, and the larger difference counts. So
a difference in alpha counts as much as it can be seen, and colours that full transparency
hides count for nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.memo import SOURCES, bytes_held
from playground.verify.shots.compare import worst_window

Floats = NDArray[np.float32]

PIXELS_PER_DEGREE = 0.7 * (3840 / 0.7) * math.pi / 180
"""Of the observer's view: a monitor 0.7 m wide of 3840 pixels, 0.7 m away."""

TILE = 32
"""[pixels] Side of the tiles of which the worst is reported."""

# Contrast sensitivity as Gaussians (a, b) of each channel: achromatic, red-green, blue-yellow.
_CONTRAST = (((1.0, 0.0047),), ((1.0, 0.0053),), ((34.1, 0.04), (13.5, 0.025)))
_COLOUR_EXPONENT = 0.7  # qc
_KNEE, _AT_KNEE = 0.4, 0.95  # pc and pt: up to which share errors stretch, and how far
_FEATURE_WIDTH = 0.082  # w [degrees]: of the edges and points that the eye finds
_FEATURE_EXPONENT = 0.5  # qf
_STRIP = 32  # [pixels] along the axis that are filtered at once
_ONE_THREAD = 2**18  # multiplications that OpenBLAS does not share: on a busy machine, waiting takes longer
_MIN_WEIGHT = 1e-7  # weights below this fraction of the largest change nothing in float32


@dataclass(frozen=True, eq=False)
class Flip:
    """The difference of two pictures, as it is seen."""

    difference: Floats  # (height, width) 0..1

    @property
    def mean(self) -> float:
        """Mean over the picture."""
        return float(self.difference.mean(dtype=np.float64))

    @property
    def tile(self) -> float:
        """Mean over the worst 32 × 32 pixels, wherever they lie; a small picture is one tile."""
        return self.worst_tile()[0]

    def worst_tile(self) -> tuple[float, tuple[int, int]]:
        """Return the worst tile's mean, and x and y [pixels] of its top left corner."""
        total, corner, (width, height) = worst_window(self.difference, TILE)
        return max(total, 0.0) / (width * height), corner


def flip(actual: NDArray[np.uint8], expected: NDArray[np.uint8]) -> Flip:
    """Compare two pictures, uint8 (height, width, 4), top row first, sRGB and alpha.

    Raises ``DataError`` where their sizes differ or they are no such pictures.
    """
    for array in (actual, expected):
        if array.dtype != np.uint8 or array.ndim != 3 or array.shape[2] != 4 or 0 in array.shape:
            raise DataError(f"a picture is uint8 (height, width, 4); found {array.dtype} {array.shape}")
    if actual.shape != expected.shape:
        sizes = [f"{array.shape[1]} × {array.shape[0]}" for array in (actual, expected)]
        raise DataError(f"pictures of {sizes[0]} and {sizes[1]} pixels cannot be compared")
    # Values too small for float32 are rounded to 0, which is what is wanted.
    with np.errstate(under="ignore"):
        if min(int(actual[..., 3].min()), int(expected[..., 3].min())) == 255:
            return Flip(_difference(actual[..., :3], expected[..., :3]))
        over = [
            _difference(_composited(actual, ground), _composited(expected, ground)) for ground in (0, 255)
        ]
        return Flip(np.maximum(*over))


def flip_picture(actual: NDArray[np.uint8], expected: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return the difference as a picture, opaque uint8 (height, width, 4): black 0, red, white 1.

    Raises ``DataError`` as `flip` does.
    """
    return coloured(flip(actual, expected).difference)


def coloured(difference: Floats) -> NDArray[np.uint8]:
    """Return values 0..1 in the colours of `ramp`, opaque uint8 (height, width, 4)."""
    index = np.clip(difference * 255 + np.float32(0.5), 0, 255).astype(np.uint8)
    return np.asarray(ramp()[index], np.uint8)


@cache
def ramp() -> NDArray[np.uint8]:
    """Return 256 colours from black over purple and orange to pale yellow, uint8 (256, 4).

    They are magma's, by S. van der Walt and N. Smith for matplotlib, given to the public domain
    (CC0): every 17th of its 256 colours, with the others between them, at most 3 levels off.
    """
    nodes = np.array([[int(text[i : i + 2], 16) for i in (0, 2, 4)] for text in _MAGMA.split()])
    places = np.arange(0, 256, 17)
    colours = np.full((256, 4), 255, np.uint8)
    for channel in range(3):
        colours[:, channel] = np.round(np.interp(np.arange(256), places, nodes[:, channel]))
    colours.setflags(write=False)
    return colours


_MAGMA = """
000004 0b0924 20114b 3b0f70 57157e 721f81 8c2981 a8327d
c43c75 de4968 f1605d fa7f5e fe9f6d febf84 fddea0 fcfdbf
"""


def _composited(picture: NDArray[np.uint8], grey: int) -> NDArray[np.uint8]:
    """Return a picture's colours over a grey ground, mixed as encoded, as screens do."""
    alpha = picture[..., 3:].astype(np.float32) / np.float32(255)
    mixed = picture[..., :3] * alpha + np.float32(grey) * (1 - alpha)
    return np.asarray(mixed + np.float32(0.5), np.uint8)


def _difference(actual: NDArray[np.uint8], expected: NDArray[np.uint8]) -> Floats:
    """Return FLIP of two opaque pictures, uint8 (height, width, 3)."""
    (ours, edges, points), (theirs, other_edges, other_points) = _seen(actual), _seen(expected)
    colours = _colour_difference(ours, theirs)
    features = _feature_difference(edges - other_edges, points - other_points)
    return np.asarray(colours ** (1 - features), np.float32)


def _seen(picture: NDArray[np.uint8]) -> tuple[Floats, Floats, Floats]:
    """Return what the eye sees of a picture: its colours as `_perceived` has them, edges and points."""
    opponent = _opponent(picture)
    return (_perceived(opponent), *_features(opponent[0]))


# ── colour spaces ────────────────────────────────────────────────────────────


@cache
def _matrices() -> tuple[Floats, Floats, Floats]:
    """Return XYZ over white from linear sRGB, then YyCxCz from that light, but for its constant, and back.

    From the chromaticities of IEC 61966-2-1: red, green, blue, and D65.
    """
    x, y = np.array([[0.64, 0.30, 0.15], [0.33, 0.60, 0.06]])
    primaries = np.array([x / y, np.ones(3), (1 - x - y) / y])
    white = np.array([0.3127 / 0.3290, 1.0, (1 - 0.3127 - 0.3290) / 0.3290])
    relative = primaries * np.linalg.solve(primaries, white) / white[:, None]
    opponent = np.array([[0, 116, 0], [500, -500, 0], [0, 200, -200]]) @ relative
    matrices = relative, opponent, np.linalg.inv(opponent)
    return tuple(array.astype(np.float32) for array in matrices)  # type: ignore[return-value]


@cache
def _linear() -> Floats:
    """Return the light of each of the 256 bytes of sRGB."""
    byte = np.arange(256) / 255
    return np.where(byte <= 0.04045, byte / 12.92, ((byte + 0.055) / 1.055) ** 2.4).astype(np.float32)


def _opponent(picture: NDArray[np.uint8]) -> Floats:
    """Return YyCxCz of sRGB bytes, (3, height, width): lightness, red to green, blue to yellow."""
    _, opponent, _ = _matrices()
    values = _mixed(opponent, np.moveaxis(np.take(_linear(), picture), 2, 0))
    values[0] -= 16
    return values


def _mixed(matrix: Floats, channels: Floats) -> Floats:
    """Return a matrix times the three channels of each pixel, (3, height, width)."""
    values = channels.reshape(3, -1)
    mixed = np.empty(values.shape, np.float32)
    most = _ONE_THREAD // matrix.size
    for start in range(0, values.shape[1], most):
        pixels = slice(start, start + most)
        np.matmul(matrix, values[:, pixels], out=mixed[:, pixels])
    return mixed.reshape(channels.shape)


def _perceived(opponent: Floats) -> Floats:
    """Return L*, a*, b* of what is left after the eye's blur, (3, height, width), chroma Hunt-adjusted."""
    blurred = np.empty_like(opponent)
    for channel, kernels, channel_values in zip(opponent, _blurs(), blurred, strict=True):
        channel_values[...] = sum(
            (_along(_along(channel, line, 0), line, 1) * weight for line, weight in kernels), _ZERO
        )
    blurred[0] += 16
    relative, _, inverse = _matrices()
    light = np.clip(_mixed(inverse, blurred), 0, 1)
    relative = np.maximum(_mixed(relative, light), 0)
    # CIE 15:2004: a cube root, and near black the line that continues it.
    bend = 6 / 29
    x, y, z = np.where(relative > bend**3, np.cbrt(relative), relative / (3 * bend**2) + 4 / 29)
    lightness = 116 * y - 16
    hunt = np.float32(0.01) * lightness
    return np.asarray(np.stack([lightness, 500 * (x - y) * hunt, 200 * (y - z) * hunt]), np.float32)


_ZERO = np.float32(0)


# ── colours ──────────────────────────────────────────────────────────────────


@cache
def _blurs() -> tuple[tuple[tuple[Floats, np.float32], ...], ...]:
    """Return, for each opponent channel, the Gaussians whose sum blurs it, with their shares.

    A Gaussian in two dimensions is one along each axis; a sum of two is not, so each is
    taken by itself. Together they weigh 1 over the pixels within three deviations
    of the widest.
    """
    widest = max(b for gaussians in _CONTRAST for _, b in gaussians)
    radius = math.ceil(3 * math.sqrt(widest / (2 * math.pi**2)) * PIXELS_PER_DEGREE)
    degrees = np.arange(-radius, radius + 1) / PIXELS_PER_DEGREE
    kernels = []
    for gaussians in _CONTRAST:
        lines = [np.exp(-(math.pi**2) * degrees**2 / b) for _, b in gaussians]
        weights = [
            a * math.sqrt(math.pi / b) * line.sum() ** 2
            for (a, b), line in zip(gaussians, lines, strict=True)
        ]
        shares = [np.float32(weight / sum(weights)) for weight in weights]
        kernels.append(tuple((_trimmed(line / line.sum()), s) for line, s in zip(lines, shares, strict=True)))
    return tuple(kernels)


def _colour_difference(ours: Floats, theirs: Floats) -> Floats:
    """Return HyAB differences of L*a*b*, stretched to 0..1."""
    lightness, a, b = ours - theirs
    power = (np.abs(lightness) + np.sqrt(a * a + b * b)) ** np.float32(_COLOUR_EXPONENT)
    most = _largest_difference()
    knee = np.float32(_KNEE * most)
    below = power * np.float32(_AT_KNEE / knee)
    above = _AT_KNEE + (power - knee) / (most - knee) * np.float32(1 - _AT_KNEE)
    return np.asarray(np.where(power < knee, below, above), np.float32)


@cache
def _largest_difference() -> float:
    """Return the difference of pure green and pure blue, than which none in sRGB is larger."""
    plain = np.array([[[0, 255, 0]], [[0, 0, 255]]], np.uint8)
    # Each alone in its picture, so that the blur finds nothing to mix it with.
    (l1, a1, b1), (l2, a2, b2) = (_perceived(_opponent(colour[None]))[:, 0, 0] for colour in plain)
    distance = abs(float(l1 - l2)) + math.hypot(float(a1 - a2), float(b1 - b2))
    return float(distance**_COLOUR_EXPONENT)


# ── features ─────────────────────────────────────────────────────────────────


@cache
def _feature_lines() -> tuple[Floats, Floats, Floats]:
    """Return a Gaussian and its first and second derivatives, weighing 1 on each side of zero."""
    deviation = 0.5 * _FEATURE_WIDTH * PIXELS_PER_DEGREE
    radius = math.ceil(3 * deviation)
    x = np.arange(-radius, radius + 1)
    gauss = np.exp(-(x**2) / (2 * deviation**2))
    first, second = -x * gauss, (x**2 / deviation**2 - 1) * gauss
    scaled = [np.where(line > 0, line / line[line > 0].sum(), line / -line[line < 0].sum())
              for line in (first, second)]  # fmt: skip
    whole, edges, points = (line.astype(np.float32) for line in (gauss / gauss.sum(), *scaled))
    return whole, edges, points


def _feature_difference(edges: Floats, points: Floats) -> Floats:
    """Return how far two pictures' edges and points differ, 0..1, from the differences of their strengths."""
    difference = np.maximum(np.abs(edges), np.abs(points))
    difference_found = (difference * np.float32(1 / math.sqrt(2))) ** np.float32(_FEATURE_EXPONENT)
    return np.asarray(np.clip(difference_found, 0, 1), np.float32)


def _features(lightness: Floats) -> tuple[Floats, Floats]:
    """Return how strong an edge, and how strong a point or line, is at each pixel."""
    gauss, first, second = _feature_lines()
    relative = np.asarray((lightness + 16) / 116, np.float32)
    down, across = _along(relative, gauss, 0), _along(relative, gauss, 1)
    edges = _length(_along(down, first, 1), _along(across, first, 0))
    points = _length(_along(down, second, 1), _along(across, second, 0))
    return edges, points


def _length(x: Floats, y: Floats) -> Floats:
    """Return the lengths of vectors; numpy.hypot guards against overflow, and takes several times as long."""
    return np.asarray(np.sqrt(x * x + y * y), np.float32)


# ── filters ──────────────────────────────────────────────────────────────────


def _trimmed(line: NDArray[np.float64]) -> Floats:
    """Return a symmetric line of weights without its ends that weigh nothing."""
    used = np.flatnonzero(line > _MIN_WEIGHT * line.max())
    return line[used[0] : used[-1] + 1].astype(np.float32)


def _along(values: Floats, line: Floats, axis: int) -> Floats:
    """Filter along one axis, with an odd number of weights; edges go on outside.

    By a product of matrices for each few rows or columns: of what those multiply, much is 0, and it is
    many times faster all the same than a pass over the picture for each weight.
    """
    radius = len(line) // 2
    pads = [(radius, radius) if axis == side else (0, 0) for side in (0, 1)]
    padded = np.pad(values, pads, mode="edge")
    filtered = np.empty(values.shape, np.float32)
    size, other = values.shape[axis], values.shape[1 - axis]
    for start in range(0, size, _STRIP):
        matrix = _band(line.tobytes(), min(_STRIP, size - start))
        inside, reached = (slice(start, start + length) for length in matrix.shape)
        most = _ONE_THREAD // matrix.size
        for begin in range(0, other, most):
            across = slice(begin, begin + most)
            if axis == 0:
                np.matmul(matrix, padded[reached, across], out=filtered[inside, across])
            else:
                np.matmul(padded[across, reached], matrix.T, out=filtered[across, inside])
    return filtered


@SOURCES.cached(weight=bytes_held)
def _band(line: bytes, count: int) -> Floats:
    """Return the matrix whose rows are a line of weights, each one further along than the last."""
    weights = np.frombuffer(line, np.float32)
    band = np.zeros((count, count + len(weights) - 1), np.float32)
    for row in range(count):
        band[row, row : row + len(weights)] = weights
    return band
