"""Find the ground under a pixel: where a ray from the eye first meets the terrain."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from playground.terrain.camera import Eye

_HALVINGS = 24


def ground_under(
    eye: Eye,
    place: tuple[float, float],
    heights: NDArray[np.floating],
    extent: tuple[float, float],
    relief: float,
) -> tuple[float, float] | None:
    """Return where on the terrain a place of the picture lies; None where there is sky.

    ``place``: shares of the picture's width and height from its lower left. ``heights``:
    (ny, nx), row 0 south, 0..1 of ``relief`` [m]; ``extent`` [m]. The answer is in shares of the
    terrain's sides, east and north. Steps are as long as a texel, so that a needle between two may
    be missed; between steps the ground is halved in.
    """
    found = ray_over(eye, place, heights.shape[::-1], extent)
    if found is None:
        return None
    origin, way, entry, leave, steps = found
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
    eye: Eye, place: tuple[float, float], size: tuple[int, ...], extent: tuple[float, float]
) -> tuple[NDArray[np.float64], NDArray[np.float64], float, float, int] | None:
    """Return how to look for the ground under a place of the picture; None where its ray meets no terrain.

    Where the ray begins [m], its unit vector, from where to where along it [m] it is over a terrain of
    ``size`` texels (nx, ny), and in how many steps, each no longer than a texel, to march that way.
    """
    origin, way = _ray(eye, place)
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

    In shares of the picture from its lower left; what is behind the eye is left out.
    """
    place = np.asarray(shares, np.float64) * extent
    ground = _ground(place[:, 0], place[:, 1], heights, extent, relief)
    world = np.concatenate([place, ground[:, None], np.ones((len(place), 1))], axis=1)
    clip = world @ eye.clip_from_world.astype(np.float64).T
    return [(float(x / w + 1) / 2, float(y / w + 1) / 2) for x, y, _, w in clip if w > 0]


def _ray(eye: Eye, place: tuple[float, float]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where a pixel's ray begins and its unit vector."""
    far = np.linalg.inv(eye.clip_from_world.astype(np.float64)) @ [2 * place[0] - 1, 2 * place[1] - 1, 1, 1]
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
