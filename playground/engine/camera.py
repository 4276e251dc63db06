"""Cameras: directions on the terrain, matrices of an orbit, the ground under a pixel.

World space: metres of the terrain, x east, y north, z up from height 0; the south-west
corner is the origin.

Sums, products, quotients and roots alone, in a fixed order, so that every machine and every browser gets the
same directions and matrices to the last bit: no two libraries of mathematics agree on that of a sine. The
page runtime has the same in camera.js, tested for equality.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pyrr
from numpy.typing import NDArray

from playground.sketch.model import Camera

# Taylor's, up to the term below which nothing is left of 45 degrees in double precision.
_SINE = [(-1) ** n / math.factorial(2 * n + 1) for n in range(9)]
_COSINE = [(-1) ** n / math.factorial(2 * n) for n in range(10)]


def unit_vector(direction: Sequence[float]) -> tuple[float, float, float]:
    """Return the unit vector (east, north, up) of an azimuth and an elevation [degrees].

    Azimuths are clockwise from north, elevations above the horizon; exact at quarter turns,
    as ``glsl/lighting/sun.glsl`` is.
    """
    azimuth, elevation = direction
    north, east = cos_sin(azimuth)
    level, up = cos_sin(elevation)
    return east * level, north * level, up


def cos_sin(degrees: float) -> tuple[float, float]:
    """Return an angle's cosine and sine: exact at quarter turns, else to two units of the last bit."""
    degrees = math.fmod(degrees, 360.0)
    quarters = math.floor(degrees / 90.0 + 0.5)
    x = (degrees - 90.0 * quarters) * (math.pi / 180.0)
    c, s = _series(_COSINE, x * x), x * _series(_SINE, x * x)
    return ((c, s), (-s, c), (-c, -s), (s, -c))[quarters % 4]


def _series(factors: Sequence[float], x: float) -> float:
    total = 0.0
    for factor in reversed(factors):
        total = total * x + factor
    return total


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
    length_squared = 0.0
    for part in parts:
        length_squared += part * part
    return math.sqrt(length_squared)


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


_HALVINGS = 24


def ground_under(
    eye: Eye,
    position: tuple[float, float],
    heights: NDArray[np.floating],
    extent: tuple[float, float],
    relief: float,
) -> tuple[float, float] | None:
    """Return where on the terrain a place of the picture lies; None where there is sky.

    ``position``: shares of the picture's width and height from its lower left. ``heights``:
    (ny, nx), row 0 south, 0..1 of ``relief`` [m]; ``extent`` [m]. The answer is in fractions of the
    terrain's sides, east and north. Steps are as long as a texel, so that a needle between two may
    be missed; between steps the ground is halved in.
    """
    hit = ray_over(eye, position, heights.shape[::-1], extent)
    if hit is None:
        return None
    origin, way, entry, leave, steps = hit
    along = np.linspace(entry, leave, steps + 1)
    below = _over_ground(origin, way, along, heights, extent, relief) <= 0
    if not below.any():
        return None
    first = int(np.argmax(below))
    low, high = along[max(first - 1, 0)], along[first]
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if _over_ground(origin, way, np.array([middle]), heights, extent, relief)[0] <= 0:
            high = middle
        else:
            low = middle
    x, y = (origin + high * way)[:2] / np.asarray(extent, np.float64)
    return float(np.clip(x, 0.0, 1.0)), float(np.clip(y, 0.0, 1.0))


def ray_over(
    eye: Eye, position: tuple[float, float], size: tuple[int, ...], extent: tuple[float, float]
) -> tuple[NDArray[np.float64], NDArray[np.float64], float, float, int] | None:
    """Return how to look for the ground under a place of the picture; None where its ray meets no terrain.

    Where the ray begins [m], its unit vector, from where to where along it [m] it is over a terrain of
    ``size`` texels (nx, ny), and in how many steps, each no longer than a texel, to march that way.
    """
    origin, way = _ray(eye, position)
    entry, leave = _over_terrain(origin, way, extent)
    if not entry < leave:
        return None
    texel = min(extent[0] / max(size[0] - 1, 1), extent[1] / max(size[1] - 1, 1))
    level = float(np.hypot(way[0], way[1]))
    return origin, way, entry, leave, int(np.clip((leave - entry) * level / texel, 64, 16_384))


def seen_from(
    eye: Eye,
    shares: NDArray[np.floating],
    heights: NDArray[np.floating],
    extent: tuple[float, float],
    relief: float,
) -> list[tuple[float, float]]:
    """Return where in the picture places on the ground are seen, (n, 2) shares of the terrain's sides.

    In fractions of the picture from its lower left; what is behind the eye is left out.
    """
    position = np.asarray(shares, np.float64) * extent
    ground = _ground(position[:, 0], position[:, 1], heights, extent, relief)
    world = np.concatenate([position, ground[:, None], np.ones((len(position), 1))], axis=1)
    clip = world @ eye.clip_from_world.astype(np.float64).T
    return [(float(x / w + 1) / 2, float(y / w + 1) / 2) for x, y, _, w in clip if w > 0]


def _ray(eye: Eye, position: tuple[float, float]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where a pixel's ray begins and its unit vector."""
    far = np.linalg.inv(eye.clip_from_world.astype(np.float64)) @ [
        2 * position[0] - 1,
        2 * position[1] - 1,
        1,
        1,
    ]
    origin = np.array(eye.position, np.float64)
    way = far[:3] / far[3] - origin
    return origin, way / np.linalg.norm(way)


def _over_terrain(
    origin: NDArray[np.float64], way: NDArray[np.float64], extent: tuple[float, float]
) -> tuple[float, float]:
    """Return from where to where a ray is over the terrain's rectangle, in metres along it."""
    entry, leave = 0.0, np.inf
    for axis in range(2):
        if abs(way[axis]) < 1e-12:
            if not 0 <= origin[axis] <= extent[axis]:
                return 1.0, 0.0
            continue
        edges = sorted(((0 - origin[axis]) / way[axis], (extent[axis] - origin[axis]) / way[axis]))
        entry, leave = max(entry, edges[0]), min(leave, edges[1])
    # Straight down it is over the same place for ever; twice the way to height 0 is enough.
    if not np.isfinite(leave):
        leave = 2 * abs(float(origin[2])) + 1e5
    return entry, float(leave)


def _over_ground(
    origin: NDArray[np.float64],
    way: NDArray[np.float64],
    along: NDArray[np.float64],
    heights: NDArray[np.floating],
    extent: tuple[float, float],
    relief: float,
) -> NDArray[np.float64]:
    """Return how far [m] places along a ray are over the ground."""
    x, y, z = (origin[axis] + along * way[axis] for axis in range(3))
    return np.asarray(z - _ground(x, y, heights, extent, relief), np.float64)


def _ground(
    east: NDArray[np.float64],
    north: NDArray[np.float64],
    heights: NDArray[np.floating],
    extent: tuple[float, float],
    relief: float,
) -> NDArray[np.float64]:
    """Return heights [m] between the four texels around places [m], held on the terrain."""
    ny, nx = heights.shape
    x = np.clip(east / extent[0], 0, 1) * (nx - 1)
    y = np.clip(north / extent[1], 0, 1) * (ny - 1)
    i, j = np.minimum(x.astype(int), max(nx - 2, 0)), np.minimum(y.astype(int), max(ny - 2, 0))
    u, v = x - i, y - j
    right, up = np.minimum(i + 1, nx - 1), np.minimum(j + 1, ny - 1)
    south = heights[j, i] * (1 - u) + heights[j, right] * u
    above = heights[up, i] * (1 - u) + heights[up, right] * u
    return np.asarray(south * (1 - v) + above * v, np.float64) * relief
