"""Turn a camera that orbits the terrain into matrices.

World space: metres of the terrain, x east, y north, z up from height 0; the south-west
corner is the origin.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pyrr
from numpy.typing import NDArray

from playground.sketch.model import Camera

MARGIN = 1.06
"""Air around a terrain that just fills the picture, as a share of the eye's distance."""


@dataclass(frozen=True, slots=True)
class Eye:
    """A camera over one terrain, seen in one picture."""

    clip_from_world: NDArray[np.float32]  # (4, 4), rows; acts on column vectors
    position: tuple[float, float, float]  # [m]
    target: tuple[float, float, float]  # [m]
    distance: float  # [m]

    @property
    def world_from_clip(self) -> NDArray[np.float32]:
        """The inverse of ``clip_from_world``."""
        return np.linalg.inv(self.clip_from_world.astype(np.float64)).astype(np.float32)


def look(camera: Camera, extent: tuple[float, float], relief: float, size: tuple[int, int]) -> Eye:
    """Return the eye of a camera over a terrain, in a picture.

    ``extent`` and ``relief`` in metres, ``size`` in pixels.
    """
    aspect = size[0] / size[1]
    radius = 0.5 * math.sqrt(extent[0] ** 2 + extent[1] ** 2 + relief**2)
    target = camera.target or (extent[0] / 2, extent[1] / 2, relief / 2)
    distance = camera.distance or fit(camera, extent, relief, aspect)
    azimuth, elevation = math.radians(camera.azimuth), math.radians(camera.elevation)
    towards = (
        math.sin(azimuth) * math.cos(elevation),
        math.cos(azimuth) * math.cos(elevation),
        math.sin(elevation),
    )
    position = tuple(t + distance * d for t, d in zip(target, towards, strict=True))
    middle = (extent[0] / 2, extent[1] / 2, relief / 2)
    away = math.dist(position, middle)
    near = max((away - 1.2 * radius), 0.002 * distance, 1e-3)
    far = away + 2.0 * radius
    # At right angles to the eye's direction already, so that looking straight down is nothing special.
    up = (
        -math.sin(azimuth) * math.sin(elevation),
        -math.cos(azimuth) * math.sin(elevation),
        math.cos(elevation),
    )
    view = pyrr.matrix44.create_look_at(position, target, up, dtype=np.float64)
    lens = pyrr.matrix44.create_perspective_projection(
        camera.field_of_view, aspect, near, far, dtype=np.float64
    )
    # pyrr multiplies row vectors; ours are columns.
    matrix = (view @ lens).T.astype(np.float32)
    return Eye(matrix, (position[0], position[1], position[2]), target, distance)


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
    radius, up = math.hypot(*extent) / 2, relief / 2
    tall = math.tan(math.radians(camera.field_of_view) / 2)
    cosine, sine = math.cos(math.radians(camera.elevation)), math.sin(math.radians(camera.elevation))
    sideways = radius * math.hypot(cosine, 1 / (tall * aspect)) + up * abs(sine)
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
    azimuth = math.radians(camera.azimuth)
    scale = 2 * eye.distance * math.tan(math.radians(camera.field_of_view) / 2)
    # The picture's right is a quarter turn counter-clockwise from the eye's place, seen from above.
    east = -math.cos(azimuth) * right - math.sin(azimuth) * up
    north = math.sin(azimuth) * right - math.cos(azimuth) * up
    x, y, z = eye.target
    return replace(camera, target=(x + scale * east, y + scale * north, z))
