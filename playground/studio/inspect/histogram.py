"""The numbers of a map's texture: how they are spread, and the colours of the map's ramp.

They are read and counted a bounded piece a frame, so that no frame waits. A texture of up to
``MAX_TEXELS_READ`` texels is read whole; of a larger one rows are left out, evenly, and it is reported. The
count goes twice over its numbers: once for the least, the greatest, the mean and what is no number, once to
count them into bins between the two.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from playground.engine.textures import read_texels
from playground.memo import INTERFACE
from playground.paths import GLSL
from playground.shader.own_shaders import own_shader
from playground.studio.picture.full_screen import TexelShader
from playground.studio.session import Session

if TYPE_CHECKING:
    import moderngl

    from playground.sketch.map_sketch import Map

# ── the histogram ─────────────────────────────────────────────────────────────


BINS = 128
PIECE = 2**17
"""Texels that a frame reads, or counts, at most; but a row at least."""
MAX_TEXELS_READ = 2**22


@dataclass(frozen=True)
class ChannelHistogram:
    """One channel's numbers; those that are not finite are only counted."""

    count: int  # finite ones
    nans: int
    infinities: int
    lowest: float  # NaN where none is finite
    highest: float
    mean: float
    deviation: float  # of all, not of a sample
    bins: NDArray[np.int64]  # from the histogram's low to its high


@dataclass(frozen=True)
class Histogram:
    """A texture's numbers, channel by channel."""

    size: tuple[int, int]
    read: int  # texels
    low: float  # of all channels together: where the first bin begins, where the last one ends
    high: float
    channels: tuple[ChannelHistogram, ...]

    @property
    def whole(self) -> bool:
        """Whether every texel was read."""
        return self.read == self.size[0] * self.size[1]

    def between(self, channel: int, fraction: float) -> tuple[float, float]:
        """Return numbers, to the width of a bin, below and above which ``fraction`` of a channel's lie."""
        bins = self.channels[channel].bins
        width = (self.high - self.low) / len(bins)
        total = np.cumsum(bins)
        first = int(np.searchsorted(total, fraction * total[-1], "right"))
        last = int(np.searchsorted(total, (1.0 - fraction) * total[-1], "left"))
        return self.low + first * width, self.low + (last + 1) * width


def count(
    texture: moderngl.Texture, piece: int = PIECE, most: int = MAX_TEXELS_READ
) -> Iterator[Histogram | None]:
    """Yield None after each piece of work, the histogram at the end.

    The context is the caller's to make current for each piece; the texture must stay as it is.
    """
    width, height = texture.size
    apart = max(-(-width * height // most), 1)  # rows from one that is read to the next
    starts, rows = range(0, height, apart), max(piece // width, 1)
    blocks: list[NDArray[np.float32]] = []
    moments = []
    for first in range(0, len(starts), rows):
        if apart == 1:
            block = read_texels(texture, (0, first), (width, min(rows, height - first)))
        else:
            block = np.stack([read_texels(texture, (0, row), (width, 1)) for row in starts[first:][:rows]])
        blocks.append(block.reshape(-1, texture.components))
        moments.append(_moments(blocks[-1]))
        yield None
    counts, nans, lows, highs, means, squares = np.stack(moments, axis=1)  # (block, channel) of each
    low, high = (float(lows.min()), float(highs.max())) if counts.any() else (0.0, 0.0)
    bins = np.zeros((texture.components, BINS), np.int64)
    for block in blocks:
        for channel in range(texture.components):
            bins[channel] += _binned(block[:, channel], low, high)
        yield None
    read, finite = sum(map(len, blocks)), counts.sum(axis=0)
    mean = (counts * means).sum(axis=0) / np.maximum(finite, 1)
    variance = (squares + counts * (means - mean) ** 2).sum(axis=0) / np.maximum(finite, 1)
    numbers = np.stack([lows.min(axis=0), highs.max(axis=0), mean, np.sqrt(variance)])
    numbers[:, finite == 0] = np.nan
    strange = nans.sum(axis=0)
    channels = []
    for n, nan, column, mine in zip(finite, strange, numbers.T.tolist(), bins, strict=True):
        least, greatest, centre, deviation = column
        row = int(n), int(nan), int(read - n - nan), least, greatest, centre, deviation, mine
        channels.append(ChannelHistogram(*row))
    yield Histogram((width, height), read, low, high, tuple(channels))


def _moments(block: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return (6, channels): the counts of finite numbers and of NaN, then moments of the finite ones.

    Those are the least, the greatest, the mean and the sum of squared differences from it; blocks are
    combined as in Chan, Golub and LeVeque 1983.
    """
    finite = np.isfinite(block)
    count, values = finite.sum(axis=0), np.where(finite, block, np.float32(0)).astype(np.float64)
    mean = values.sum(axis=0) / np.maximum(count, 1)
    squares = (np.where(finite, values - mean, 0.0) ** 2).sum(axis=0)
    low, high = np.where(finite, values, np.inf).min(axis=0), np.where(finite, values, -np.inf).max(axis=0)
    return np.stack([count, np.isnan(block).sum(axis=0), low, high, mean, squares])


def _binned(numbers: NDArray[np.float32], low: float, high: float) -> NDArray[np.int64]:
    values = numbers[np.isfinite(numbers)].astype(np.float64)
    if high <= low:
        places = np.zeros(len(values), np.int64)
    else:
        places = np.minimum(((values - low) * (BINS / (high - low))).astype(np.int64), BINS - 1)
    return np.bincount(places, minlength=BINS)


@dataclass
class Counter:
    """Computes a histogram of the map's texture, a piece of the work a frame."""

    session: Session
    piece: int = PIECE
    latest: Histogram | None = None
    _of: object = None  # what is being counted
    _counted: object = None  # what the latest is of
    _work: Iterator[Histogram | None] | None = field(default=None, repr=False)

    @property
    def waits(self) -> bool:
        """Whether there is work left."""
        return self._work is not None

    @property
    def fresh(self) -> bool:
        """Whether the latest is of the texture that is shown now."""
        return self.latest is not None and self._counted == self._of

    def go_on(self) -> None:
        """Count one more piece; restart where another texture, or a new version of it, is shown."""
        result = self._shown()
        if result is None:
            self.stop()
            return
        texture, of = result
        if of != self._of:
            if self.latest is not None and of[:2] != self._counted_name():
                self.latest = None
            self._of, self._work = of, count(texture, self.piece)
        if self._work is None:
            return
        with self.session.engine.borrowed():
            done = next(self._work)
        if done is not None:
            self.latest, self._counted, self._work = done, of, None

    def stop(self) -> None:
        """Forget all of it."""
        self.latest = self._of = self._counted = self._work = None

    def _counted_name(self) -> tuple[object, ...]:
        return self._counted[:2] if isinstance(self._counted, tuple) else ()

    def _shown(self) -> tuple[moderngl.Texture, tuple[object, ...]] | None:
        shown = self.session.view.map
        result = self.session.result_of(shown.ref) if shown is not None else None
        return (result[0], (shown.ref, *result[1])) if shown is not None and result is not None else None


# ── the ramp ──────────────────────────────────────────────────────────────────


STEPS = 64
Colour = tuple[float, float, float]


def colours_of(ctx: moderngl.Context, ramp: int) -> tuple[Colour, ...]:
    """Return ``STEPS`` display-encoded colours of a ramp, evenly from its begin to its end.

    The context is the caller's to make current and to leave as it was; nothing stays in it.
    """
    ramp_functions = (GLSL / "colour" / "ramp.glsl").read_text(encoding="utf-8")
    shader = TexelShader(ctx, f"#version 330\n{ramp_functions}{own_shader('ramp_main.glsl')}", (STEPS, 1))
    try:
        (values,) = shader.compute({}, ramp=ramp, steps=float(STEPS))
    finally:
        shader.release()
    return tuple((float(r), float(g), float(b)) for r, g, b, _ in values)


def ends_of(shown: Map) -> tuple[float, float]:
    """Return the numbers at the two ends of a map's legend.

    Around a middle they are as far from it on either side, independent of where the map's range begins.
    """
    low, high, middle = (_number(shown, name) for name in ("lowest", "highest", "middle"))
    if _number(shown, "ramp") != 4:
        return low, high
    half = max(abs(high - middle), abs(low - middle))
    return middle - half, middle + half


@INTERFACE.cached()
def ticks(low: float, high: float, most: int = 5) -> tuple[float, ...]:
    """Return round numbers between two, at most so many."""
    span = abs(high - low)
    if not (0 < span < 1e30):
        return (low,)
    step = 10.0 ** np.floor(np.log10(span / max(most - 1, 1)))
    for factor in (1, 2, 2.5, 5, 10, 20):
        if span / (step * factor) <= most - 1:
            step *= factor
            break
    first = np.ceil(min(low, high) / step - 1e-9)
    last = np.floor(max(low, high) / step + 1e-9)
    return tuple(float(n * step) + 0.0 for n in np.arange(first, last + 1))


def _number(shown: Map, name: str) -> float:
    value = shown.value(name)
    return float(value) if isinstance(value, int | float) else 0.0
