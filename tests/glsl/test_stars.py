"""sky/stars: as many stars as there are, where the turning sky has them, of constant light."""

import numpy as np
import pytest

from ..truth.land import towards

FAINTEST, MAGNITUDE_0 = 6.92, 1.98e-11


def almanac(days):
    """Return right ascension and declination of the sun [rad], days from noon of 1 January 2000.

    The Astronomical Almanac's low precision formulas, to 0.01 degrees.
    """
    mean, anomaly = 280.460 + 0.9856474 * days, np.radians(357.528 + 0.9856003 * days)
    longitude = np.radians(mean + 1.915 * np.sin(anomaly) + 0.020 * np.sin(2 * anomaly))
    tilt = np.radians(23.439 - 4e-7 * days)
    ascension = np.arctan2(np.cos(tilt) * np.sin(longitude), np.cos(longitude))
    return ascension, np.arcsin(np.sin(tilt) * np.sin(longitude))


@pytest.mark.parametrize("clock", ["sun", "zone"])
def test_the_sun_stands_among_the_stars_where_the_almanac_has_it(any_engine, make_sketch, on_gpu, clock):
    for day, hour, latitude, longitude in (
        (20, 11.0, 36.0, -84.2),
        (172, 15.5, -33.0, 18.0),
        (300, 9.0, 5, 0),
    ):
        universal = hour - longitude / 15
        hour = hour if clock == "sun" else universal  # of the zone of Greenwich
        value = f"year = 2031, day = {day}, hour = {hour}, latitude = {latitude}, longitude = {longitude}, "
        text = f'[[pass]]\nname = "day"\nuse = "lighting/daylight"\nset = {{ {value} clock = "{clock}" }}\n'
        sketch = make_sketch(text)
        sun = towards(*any_engine.read(sketch, "day.place:place")[0, 0, :2].astype(np.float64))
        _, position, turned, _ = any_engine.read(sketch, "day.place:date")[0, 0].astype(np.float64)
        result = on_gpu("sky/stars.glsl", "celestial_of(d, l, t)", d=sun[None], l=[position], t=[turned])[0]
        ascension, declination = almanac(365 * 31 + 8 + day - 1 + universal / 24 - 0.5)
        level = np.cos(declination)
        truth = [level * np.cos(ascension), level * np.sin(ascension), np.sin(declination)]
        # Refraction lifts a sun this high by less than 0.1 degrees.
        np.testing.assert_allclose(result, truth, atol=np.radians(0.15))


def test_their_light_is_that_of_as_many_stars_as_there_are(on_gpu):
    """The mean over the sphere is pi / 4 pi of the sum of 10^(0.51 m + 0.68) stars' light, to magnitude 6.92.

    Half of it comes from a few bright ones, so magnitudes from 3 on are compared.
    """
    rng = np.random.default_rng(2)
    ahead = rng.normal(size=(400_000, 3))
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    radius = 0.006
    result = on_gpu("sky/stars.glsl", "stars_towards(d, 1.0)", d=ahead)[:, 1].astype(np.float64)
    peak = 3 / radius**2 * MAGNITUDE_0 * 10 ** (-0.4 * 3.0)
    # Of a disc (1 - r²)² of area 1, the part below a level of the brightest is closed in form; so is the
    # number of discs that are hit at all.
    hit = (result > 0).mean()
    stars = 10 ** (0.51 * FAINTEST + 0.68)
    # Two grids have half of them each.
    assert hit == pytest.approx(1 - (1 - stars / 2 * radius**2 / 4) ** 2, rel=0.03)
    bright = (result > peak).mean() * 4 / radius**2
    # A star of magnitude m is over the level where (1 - r²)² > 10^(0.4 (m - 3)).
    magnitudes = np.linspace(-2, 3, 2001)
    counts = np.diff(10 ** (0.51 * magnitudes + 0.68))
    area = 1 - 10 ** (0.2 * (magnitudes[1:] - 3))
    assert bright == pytest.approx((counts * area).sum(), rel=0.35)


def test_a_star_has_the_same_light_in_pixels_of_any_size(on_gpu):
    rng = np.random.default_rng(4)
    ahead = rng.normal(size=(60_000, 3))
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    seen = on_gpu("sky/stars.glsl", "stars_towards(d, 1.0)", d=ahead)[:, 1]
    middle = ahead[np.argsort(seen)[-4:]]
    side = np.cross(middle, [0.3, 0.2, 0.9])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    up = np.cross(middle, side)
    offset = (np.arange(101) - 50) / 50 * 0.014
    x, y = np.meshgrid(offset, offset)
    for item, first, second in zip(middle, side, up, strict=True):
        near = (item + x[..., None] * first + y[..., None] * second).reshape(-1, 3)
        near /= np.linalg.norm(near, axis=1, keepdims=True)
        sums = [
            on_gpu("sky/stars.glsl", f"stars_towards(d, {pixel})", d=near)[:, 1].sum(dtype=np.float64)
            for pixel in ("0.0014", "0.0025", "1.0")
        ]
        np.testing.assert_allclose(sums, sums[0], rtol=0.06)
