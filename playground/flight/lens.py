"""The lens of the craft: matrices around the eye, so that numbers stay small far from the first part."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from playground.flight.craft import Craft

FIELD_OF_VIEW = 58.0  # [degrees] upright
NEAREST = 2.0  # [m]


@dataclass(frozen=True)
class Lens:
    """The view frustum, in a space whose origin is the eye: x east, y north, z up, metres."""

    clip_from_near: NDArray[np.float32]  # (4, 4), rows; acts on columns
    near_from_clip: NDArray[np.float32]
    planes: NDArray[np.float64]  # (5, 4): a place is inside where plane · (place, 1) >= 0
    pixel: float  # [radians] high

    def sees(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which boxes, given by their corners (n, 3), may be in the picture."""
        normals = self.planes[:, None, :3]
        farthest = np.where(normals >= 0, high[None], low[None])
        inside: NDArray[np.bool_] = ((farthest * normals).sum(axis=2) + self.planes[:, 3:] >= 0).all(axis=0)
        return inside


def through(
    craft: Craft, size: tuple[int, int], farthest: float, field_of_view: float = FIELD_OF_VIEW
) -> Lens:
    """Return the view ahead of a craft in a picture of that size [pixels], as far as that [m]."""
    ahead, right, up = axes(craft)
    rotation = np.eye(4)
    rotation[:3, :3] = [right, up, -ahead]
    tall = 1 / math.tan(math.radians(field_of_view) / 2)
    near, far = NEAREST, farthest
    lens = np.zeros((4, 4))
    lens[0, 0], lens[1, 1] = tall * size[1] / size[0], tall
    lens[2, 2], lens[2, 3] = (far + near) / (near - far), 2 * far * near / (near - far)
    lens[3, 2] = -1.0
    matrix = lens @ rotation
    rows = [matrix[3] + matrix[0], matrix[3] - matrix[0], matrix[3] + matrix[1], matrix[3] - matrix[1]]
    rows.append(matrix[3] + matrix[2])
    pixel = math.radians(field_of_view) / size[1]
    inverse = np.linalg.inv(matrix)
    with np.errstate(under="ignore"):  # a right angle's cosine is 0, or nearly
        return Lens(matrix.astype(np.float32), inverse.astype(np.float32), np.array(rows), pixel)


def axes(craft: Craft) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the unit vectors ahead, to the right and up of a craft."""
    ch, sh = math.cos(craft.heading), math.sin(craft.heading)
    cp, sp = math.cos(craft.pitch), math.sin(craft.pitch)
    ahead = np.array([sh * cp, ch * cp, sp])
    level = np.array([ch, -sh, 0.0])
    above = np.cross(level, ahead)
    cr, sr = math.cos(craft.roll), math.sin(craft.roll)
    # Right wing down: the craft's right goes below the horizon.
    return ahead, cr * level - sr * above, sr * level + cr * above


def turned(before: Craft, after: Craft) -> float:
    """Return the angle between two attitudes [radians]."""
    cosine = (np.sum(np.array(axes(before)) * np.array(axes(after))) - 1) / 2
    return math.acos(min(max(float(cosine), -1.0), 1.0))
