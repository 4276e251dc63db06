"""Find which boxes around tiles a view sees, how deep they lie, and how long a metre looks there.

Like the camera's, these numbers are the same on every machine and in a browser (visibility.js).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

FAR = 1e30
Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class View:
    """From where, and how large, a terrain is looked at."""

    clip_from_world: Floats  # (4, 4), rows; acts on column vectors
    eye: tuple[float, float, float]  # [m]
    extent: tuple[float, float]  # [m]
    relief: float  # [m] of height 1
    size: tuple[int, int]  # [pixels]

    @property
    def forward(self) -> Floats:
        """What a place's depth [m] is worked out with: its first three times the place, plus the last."""
        row: Floats = self.clip_from_world[3]
        return row

    @property
    def near(self) -> float:
        """Depth [m] of the plane before which nothing is drawn."""
        ahead, depth = self._row(3), self._row(2)
        along = _dot(depth, ahead) / _dot(ahead, ahead)
        return -(_dot(depth, self.eye) + depth[3]) / (1.0 + along)

    @property
    def pixels(self) -> float:
        """The most pixels that a metre upwards is long, at depth 1 m, anywhere in the picture.

        A place at (x, y) of the view, over its depth, is x and y times a scale from the
        middle. Moved by a short way (a, b, c) at depth z it moves by (a - x c, b - y c) / z,
        whose length is greatest in a corner of the picture.
        """
        across, upright, ahead = (self._row(k) for k in (0, 1, 3))
        wide, tall = 1.0 / math.sqrt(_dot(across, across)), 1.0 / math.sqrt(_dot(upright, upright))
        lengths = []
        for x in (-wide, wide):
            for y in (-tall, tall):
                right = (self.size[0] / (2.0 * wide)) * (across[2] * wide - x * ahead[2])
                up = (self.size[1] / (2.0 * tall)) * (upright[2] * tall - y * ahead[2])
                lengths.append(math.sqrt(right * right + up * up))
        return max(lengths)

    @property
    def stretch(self) -> float:
        """How much further than it is deep a place in the picture may be."""
        across, upright = self._row(0), self._row(1)
        return math.sqrt(1.0 + 1.0 / _dot(across, across) + 1.0 / _dot(upright, upright))

    def _row(self, number: int) -> list[float]:
        row: list[float] = self.clip_from_world[number].tolist()
        return row


@dataclass(frozen=True, slots=True)
class Boxes:
    """The boxes around the tiles of a terrain [m]: columns and rows share their sides."""

    east: Floats  # (2, nx): west and east sides
    north: Floats  # (2, ny): south and north sides
    up: Floats  # (2, ny, nx): lowest and highest

    def support(self, plane: Floats) -> Floats:
        """Return the support of each box (ny, nx): the most of a plane's equation at a place of it."""
        east, north = (plane[0] * self.east).max(axis=0), (plane[1] * self.north).max(axis=0)
        found: Floats = plane[2] * self.up[int(plane[2] > 0)]
        found += east
        found += north[:, None] + plane[3]
        return found

    def depths(self, view: View) -> Floats:
        """Return the least depth [m] of each that can be visible."""
        least: Floats = np.maximum(-self.support(-view.forward), view.near)
        return least

    @property
    def longest(self) -> float:
        """The largest that a diagonal of any box can be [m]."""
        x, y, z = (float(np.ptp(side, axis=0).max()) for side in (self.east, self.north, self.up))
        return math.sqrt(x * x + y * y + z * z)

    def distances(self, eye: tuple[float, float, float]) -> tuple[Floats, Floats]:
        """Return how far [m] the eye is from each box's nearest place, and from its furthest."""
        nearest, furthest = [], []
        for (low, high), at in zip((self.east, self.north, self.up), eye, strict=True):
            nearest.append(np.maximum(np.maximum(low - at, at - high), 0.0) ** 2)
            furthest.append(np.maximum(np.abs(low - at), np.abs(high - at)) ** 2)
        return _length(*nearest), _length(*furthest)

    def visible(self, view: View) -> NDArray[np.bool_]:
        """Return which are not wholly outside one of the six planes of the view."""
        found = np.ones(self.up.shape[1:], bool)
        for row in (0, 1, 2):
            for sign in (1.0, -1.0):
                found &= self.support(view.clip_from_world[3] + sign * view.clip_from_world[row]) >= 0
        return found

    def with_walls(self, view: View) -> Boxes:
        """Return boxes that hold the walls at the terrain's rim as well.

        How deep a wall goes is the draw's to say; none goes deeper than this, or than the terrain itself.
        """
        return replace(self, up=np.stack([np.minimum(self.up[0], -max(view.extent)), self.up[1]]))


def _dot(one: Sequence[float], other: Sequence[float]) -> float:
    """Return the product of the first three numbers of each."""
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]


def _length(east: Floats, north: Floats, up: Floats) -> Floats:
    found: Floats = np.sqrt(east + north[:, None] + up)
    return found


def boxes_of(spans: NDArray[np.float32], view: View) -> Boxes:
    """Return the boxes of squares, (ny, nx): ``spans`` are their lowest and highest heights and their ends.

    Those are shares of the terrain's sides, east and north; each begins where the one before ends.
    """
    heights = np.moveaxis(np.clip(spans[..., :2].astype(np.float64), -FAR, FAR), -1, 0) * view.relief
    sides = []
    for ends, extent in zip((spans[0, :, 2], spans[:, 0, 3]), view.extent, strict=True):
        edges = np.concatenate([[0.0], ends.astype(np.float64)]) * extent
        sides.append(np.stack([edges[:-1], edges[1:]]))
    # A relief below 0 turns the terrain upside down.
    return Boxes(sides[0], sides[1], heights if view.relief >= 0 else heights[::-1])
