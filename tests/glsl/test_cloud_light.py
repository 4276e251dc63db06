"""clouds/seen: the light of heaps is that of photons, followed one by one through the same heaps."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from ..sketch_texts import passes
from ..truth.land import towards
from .test_cloud_pictures import BILLOWS, FLAT, NONE, TERRAIN, TOLD, looking, rays

WIDE, BASE, TALL, EXTINCTION, G = 9000.0, 1900.0, 900.0, 0.067, 0.85
SEEN = (128, 96)
SKETCH = (
    passes(
        daylight=("./told", "size = [16, 1]"),
        none=("./none", "size = 8"),
        cloud=("clouds/field", "size = 256"),
        drift=("clouds/drift", "size = 1", "set = { base = 1900.0, wide = 9000.0 }"),
    )
    + BILLOWS
    + passes(seen=("clouds/seen", "size = [128, 96]", 'inputs = { columns = "none", bounced = "none" }'))
)


def cube_of(texture):
    """Return the cube of billows as [z, y, x], from its 6 by 6 slices of 32 with borders of 1."""
    slices = texture.reshape(6, 34, 6, 34).transpose(0, 2, 1, 3).reshape(36, 34, 34)
    return slices[:32, 1:33, 1:33]


def between(grid, position):
    """Interpolate a periodic grid at places in grid cells, x first, to both sides of the nearest points."""
    return map_coordinates(grid, position[:, ::-1].T - 0.5, order=1, mode="grid-wrap")


class Heaps:
    """Clouds of clouds/density, in float64: a tile of thicknesses and a cube of billows."""

    def __init__(self, tile, cube):
        self.tile, self.cube = tile, cube

    def density(self, at):
        """Return the share 0..1 of the most extinction at places [m]."""
        up = (at[:, 2] - BASE) / TALL
        result = np.zeros(len(at))
        inside = np.flatnonzero((up > 0) & (up < 1.3))
        thick = between(self.tile, at[inside, :2] / WIDE * len(self.tile))
        near = (thick > 0) & (np.abs(thick - up[inside]) < 0.5)
        inside, thick = inside[near | (thick > up[inside])], thick[near | (thick > up[inside])]
        cubes = at[inside] - [0, 0, BASE]
        cubes = cubes / WIDE * 10
        heaps = 0.9 * (between(self.cube, cubes * 32) - 0.695)
        heaps += 0.3 * (between(self.cube, cubes * 5 * 32) - 0.695)
        up = up[inside]
        thick = thick + heaps * (0.4 + 0.6 * up) * np.clip(np.where(heaps > 0, 0, 0.3) + 4 * thick, 0, 1)
        foot = np.clip(up / 0.035, 0, 1)
        result[inside] = np.clip((thick - up) * 16, 0, 1) * foot**2 * (3 - 2 * foot)
        return result

    def towards(self, at, sun, steps=14):
        """Return what is left of the sun's beam at places: steps that grow away from them."""
        length = np.clip((BASE + TALL - at[:, 2]) / sun[2], 0, 9000)
        ends = (np.arange(steps + 1) / steps) ** 2
        total = 0.0
        for near, far in pairwise(ends):
            total = total + self.density(at + sun * (length * (near + far) / 2)[:, None]) * (far - near)
        return np.exp(-EXTINCTION * total * length)


def turned(ahead, rng):
    """Return directions after a drop has turned them, by Henyey and Greenstein's phase."""
    u = rng.random(len(ahead))
    cosine = (1 + G**2 - ((1 - G**2) / (1 - G + 2 * G * u)) ** 2) / (2 * G)
    first = np.cross(ahead, np.where(np.abs(ahead[:, 2:]) < 0.9, [[0.0, 0, 1]], [[1.0, 0, 0]]))
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    around = rng.uniform(0, 2 * np.pi, len(ahead))[:, None]
    aside = first * np.cos(around) + np.cross(ahead, first) * np.sin(around)
    return ahead * cosine[:, None] + aside * np.sqrt(np.clip(1 - cosine**2, 0, None))[:, None]


def photons(heaps, eye, ahead, sun, rng, asked=0.25):
    """Return the mean light, times pi, of a beam of 1 that comes to the eye: Woodcock's free paths.

    The sun is asked for at a part of the scatterings only.
    """
    face = BASE if eye[2] < BASE else BASE + TALL
    at = eye + ahead * ((face - eye[2]) / ahead[:, 2:])
    total, count = 0.0, len(at)
    while len(at):
        at = at + ahead * rng.exponential(1 / EXTINCTION, (len(at), 1))
        inside = (at[:, 2] > BASE - 1e-6) & (at[:, 2] < BASE + TALL)
        at, ahead = at[inside], ahead[inside]
        hit = np.flatnonzero(rng.random(len(at)) < heaps.density(at))
        some = hit[rng.random(len(hit)) < asked]
        phase = (1 - G**2) / (4 * np.pi) / (1 + G**2 - 2 * G * (ahead[some] @ sun)) ** 1.5
        total += (phase * heaps.towards(at[some], sun)).sum() / asked
        ahead[hit] = turned(ahead[hit], rng)
    return np.pi * total / count


@pytest.mark.slow
@pytest.mark.parametrize(
    ("cover", "elevation", "view"),
    [
        # With the sun behind; from above; from below, towards the sun, under nearly all cloud.
        (0.35, 25.0, (330.0, 20.0)),
        (0.6, 60.0, (20.0, -25.0)),
        (0.85, 60.0, (150.0, 20.0)),
    ],
)
def test_heaps_send_as_much_light_as_photons_do(any_engine, make_sketch, cover, elevation, view):
    """To a fifth, as an even layer. Photons, one to a pixel, are themselves a tenth off by chance.

    The header of ``clouds/heap_light`` has the views that miss it.
    """
    sun = towards(150.0, elevation)
    message = TOLD.replace("vec4(0.0, 0.0, 1.0, 90.0)", f"vec4({sun[0]}, {sun[1]}, {sun[2]}, {elevation})")
    sketch = make_sketch(TERRAIN + SKETCH, flat=FLAT, told=message, none=NONE)
    sketch = sketch.with_values({"cloud.clouds": cover})
    target = (4000.0, 3000.0, 900.0 if view[1] > 0 else 6000.0)
    sketch = looking(sketch, *view, target, field=30.0)
    value = any_engine.read(sketch, "seen", size=SEEN).astype(np.float64)[..., 1].mean()
    tile = any_engine.read(sketch, "cloud", size=SEEN).astype(np.float64)[..., 0]
    cube = cube_of(any_engine.read(sketch, "billows", size=SEEN).astype(np.float64)[..., 0])
    eye = np.asarray(any_engine.record.plan.eye.position, np.float64)
    ahead = rays(any_engine.record.plan.eye, SEEN).reshape(-1, 3)
    truth = photons(Heaps(tile, cube), eye, ahead, sun, np.random.default_rng(5))
    assert value == pytest.approx(truth, rel=0.2)


def test_billows_come_again_and_have_the_mean_that_is_said(any_engine, make_sketch):
    """A cube beside its copy is as smooth as within, on each axis; slices carry the next one with them."""
    texture = any_engine.read(make_sketch(BILLOWS), "billows").astype(np.float64)
    cube = cube_of(texture[..., 0])
    assert cube.mean() == pytest.approx(0.695, abs=0.005)
    np.testing.assert_array_equal(cube_of(texture[..., 1]), np.roll(cube, -1, axis=0))
    for axis in range(3):
        steps = np.abs(np.diff(cube, axis=axis)).mean()
        seam = np.abs(np.take(cube, 0, axis) - np.take(cube, -1, axis)).mean()
        assert seam == pytest.approx(steps, rel=0.15)
    # The border of a slice is its other side.
    first = texture[:34, :34, 0]
    np.testing.assert_array_equal(first[0, 1:33], first[32, 1:33])
    np.testing.assert_array_equal(first[1:33, 33], first[1:33, 1])
