"""Turn a camera that orbits the terrain into matrices.

World space: metres of the terrain, x east, y north, z up from height 0; the south-west
corner is the origin.

Sums, products, quotients and roots alone, in a fixed order, so that every machine and every
browser (camera.js) gets the same matrices to the last bit.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pyrr
from numpy.typing import NDArray

from playground.sketch.model import Camera
from playground.terrain.directions import cos_sin

Vector = tuple[float, float, float]

MARGIN = 1.06
"""Air around a terrain that just fills the picture, as a share of the eye's distance."""


@dataclass(frozen=True, slots=True)
class Eye:
    """A camera over one terrain, seen in one picture."""

    clip_from_world: NDArray[np.float32]  # (4, 4), rows; acts on column vectors
    position: Vector  # [m]
    target: Vector  # [m]
    distance: float  # [m]

    @property
    def world_from_clip(self) -> NDArray[np.float32]:
        """The inverse of ``clip_from_world``."""
        return np.array(_inverse(self.clip_from_world.tolist()), np.float32)


def look(camera: Camera, extent: tuple[float, float], relief: float, size: tuple[int, int]) -> Eye:
    """Return the eye of a camera over a terrain, in a picture.

    ``extent`` and ``relief`` in metres, ``size`` in pixels.
    """
    aspect = size[0] / size[1]
    radius = 0.5 * _length(*extent, relief)
    target = camera.target or (extent[0] / 2, extent[1] / 2, relief / 2)
    distance = camera.distance or fit(camera, extent, relief, aspect)
    (north, east), (level, rise) = cos_sin(camera.azimuth), cos_sin(camera.elevation)
    towards = (east * level, north * level, rise)  # the eye, from the target
    position = (
        target[0] + distance * towards[0],
        target[1] + distance * towards[1],
        target[2] + distance * towards[2],
    )
    away = _length(
        position[0] - extent[0] / 2,
        position[1] - extent[1] / 2,
        position[2] - relief / 2,
    )
    near = max((away - 1.2 * radius), 0.002 * distance, 1e-3)
    far = away + 2.0 * radius
    # At right angles to the eye's direction already, so that looking straight down is nothing special.
    right, up = (-north, east, 0.0), (-east * rise, -north * rise, level)
    high = near * _half_height(camera)  # [m] half the height of what is in the picture, at the near plane
    wide = high * aspect
    lens = pyrr.matrix44.create_perspective_projection_from_bounds(
        -wide, wide, -high, high, near, far, dtype=np.float64
    ).tolist()  # its rows are columns here
    # The rows of world to view, each scaled as the lens does.
    across = _row(right, 0.0, target, lens[0][0])
    upright = _row(up, 0.0, target, lens[1][1])
    behind = _row(towards, distance, target, 1.0)
    depth = [each * lens[2][2] for each in behind]
    depth[3] += lens[3][2]
    matrix = np.array([across, upright, depth, [-each for each in behind]], np.float32)
    return Eye(matrix, position, target, distance)


def _row(axis: Vector, distance: float, target: Vector, scale: float) -> list[float]:
    """Return a row that gives how far places are along an axis from the eye.

    The eye is ``distance`` from the target along it.
    """
    x, y, z = axis
    offset = -(x * target[0] + y * target[1] + z * target[2]) - distance
    return [x * scale, y * scale, z * scale, offset * scale]


def _half_height(camera: Camera) -> float:
    """Return half the height of what is in the picture, over its depth."""
    cosine, sine = cos_sin(camera.field_of_view / 2)
    return sine / cosine


def _length(*parts: float) -> float:
    found = 0.0
    for part in parts:
        found += part * part
    return math.sqrt(found)


def _inverse(matrix: list[list[float]]) -> list[list[float]]:
    """Invert a matrix of four rows by elimination, each column's pivot its largest number."""
    rows = [[*row, *(float(i == j) for j in range(4))] for i, row in enumerate(matrix)]
    for column in range(4):
        pivot = max(range(column, 4), key=lambda row: abs(rows[row][column]))
        rows[column], rows[pivot] = rows[pivot], rows[column]
        for row in range(column + 1, 4):
            factor = rows[row][column] / rows[column][column]
            for k in range(column, 8):
                rows[row][k] -= factor * rows[column][k]
    for row in (3, 2, 1, 0):
        for k in range(4, 8):
            for later in range(row + 1, 4):
                rows[row][k] -= rows[row][later] * rows[later][k]
            rows[row][k] /= rows[row][row]
    return [row[4:] for row in rows]


def fit(camera: Camera, extent: tuple[float, float], relief: float, aspect: float) -> float:
    """Return the distance [m] from the terrain's middle at which all of it is in the picture.

    The same for every azimuth, so that orbiting does not zoom: the terrain's corners are on two
    circles of radius R around the middle, h above and below it. Where the angle from the eye's
    azimuth is phi, a corner at height z = +-h is

        R sin phi                               right of the middle
        z cos(e) - R cos(phi) sin(e)            above it
        R cos(phi) cos(e) + z sin(e)            nearer to the eye

    for an eye e above the horizon. It is in the picture when its distance from the eye is
    right / tan(half the width) and above / tan(half the height) or more; the two terms in phi
    are greatest at the root of the sum of their squares.
    """
    radius, up = _length(*extent) / 2, relief / 2
    tall = _half_height(camera)
    cosine, sine = cos_sin(camera.elevation)
    sideways = radius * _length(cosine, 1 / (tall * aspect)) + up * abs(sine)
    upwards = max(
        radius * abs(cosine + sign * sine / tall) + up * abs(sine - sign * cosine / tall) for sign in (-1, 1)
    )
    return max(MARGIN * max(sideways, upwards), 1e-2)


def orbit(camera: Camera, azimuth: float, elevation: float) -> Camera:
    """Return the camera turned by so many degrees; the eye stays 89 degrees or less from the horizon."""
    return replace(
        camera,
        azimuth=(camera.azimuth + azimuth) % 360.0,
        elevation=min(max(camera.elevation + elevation, -89.0), 89.0),
    )


def zoom(camera: Camera, factor: float, distance: float) -> Camera:
    """Return the camera ``factor`` times as far from its target as ``distance`` metres."""
    return replace(camera, distance=min(max(distance * factor, 1e-2), 1e8))


def pan(camera: Camera, eye: Eye, right: float, up: float) -> Camera:
    """Return the camera moved over the terrain: ``right``, and ``up`` along the ground.

    Both are shares of the picture's height; what is at the target moves across the picture the other way.
    """
    cosine, sine = cos_sin(camera.azimuth)
    scale = 2 * eye.distance * _half_height(camera)
    # The picture's right is a quarter turn counter-clockwise from the eye's place, seen from above.
    east = -cosine * right - sine * up
    north = sine * right - cosine * up
    x, y, z = eye.target
    return replace(camera, target=(x + scale * east, y + scale * north, z))
