"""lighting/sun_position: the sun over any place, against other formulas, dates and published examples.

The shader has the mean sun, the equation of time and the hour angle. The truth here is the
Astronomical Almanac's low precision formulas (its section C, good to 0.01 degrees from 1950
to 2050): ecliptic longitude, right ascension, Greenwich's sidereal time, then rotations.
"""

import datetime

import numpy as np
import pytest

FILE = "lighting/sun_position.glsl"
SEEN = "sun_position(place, year, day, hours)"
COURSE = "sun_course(days_from_2000(year, day), hours)"
UNSEEN = f"sun_over(place.x, {COURSE}.x, 15.0 * (hours - 12.0) + place.y + {COURSE}.y)"


def vector(azimuth, elevation):
    """East, north, up."""
    a, e = np.radians(azimuth), np.radians(elevation)
    return np.stack([np.cos(e) * np.sin(a), np.cos(e) * np.cos(a), np.sin(e)], axis=-1)


def apart(first, other):
    """Return the angle between directions [degrees], right for small ones."""
    return np.degrees(2 * np.arcsin(np.clip(np.linalg.norm(first - other, axis=-1) / 2, 0, 1)))


def days_since_noon_2000(date, hours):
    return (date - datetime.date(2000, 1, 1)).days - 0.5 + hours / 24


def almanac(date, hours, latitude, longitude):
    """Return the direction of the sun without air: east, north, up."""
    n = days_since_noon_2000(date, hours)
    mean, anomaly = 280.460 + 0.9856474 * n, np.radians(357.528 + 0.9856003 * n)
    ecliptic = np.radians(mean + 1.915 * np.sin(anomaly) + 0.020 * np.sin(2 * anomaly))
    tilt = np.radians(23.439 - 4e-7 * n)
    equatorial = np.array(
        [np.cos(ecliptic), np.cos(tilt) * np.sin(ecliptic), np.sin(tilt) * np.sin(ecliptic)]
    )
    turned = np.radians(280.46061837 + 360.98564736629 * n + longitude)  # local sidereal time
    south = np.array([[np.cos(turned), np.sin(turned), 0], [-np.sin(turned), np.cos(turned), 0], [0, 0, 1]])
    along, east, pole = south @ equatorial  # towards the meridian's equator, the east, the pole
    phi = np.radians(latitude)
    return np.array(
        [east, pole * np.cos(phi) - along * np.sin(phi), along * np.cos(phi) + pole * np.sin(phi)]
    )


def columns(cases):
    """Return the shader's inputs for (date, hours, latitude, longitude)."""
    return {
        "place": np.array([c[2:] for c in cases], np.float64),
        "year": np.array([c[0].year for c in cases]),
        "day": np.array([c[0].timetuple().tm_yday for c in cases]),
        "hours": np.array([c[1] for c in cases], np.float64),
    }


PLACES = [(36.3, -84.2), (34.85, 5.73), (-33.9, 18.4), (-54.8, -68.3), (0.0, 0.0), (69.6, 19.0)]
PLACES += [(-77.8, 166.7), (21.3, -157.9), (90.0, 0.0), (-23.44, 180.0)]


def many():
    rng = np.random.default_rng(5)
    start, last = datetime.date(1950, 1, 1), datetime.date(2050, 12, 31)
    cases = []
    for _ in range(3000):
        date = start + datetime.timedelta(int(rng.integers((last - start).days + 1)))
        cases.append((date, float(rng.uniform(0, 24)), *PLACES[int(rng.integers(len(PLACES)))]))
    for year in (1950, 1999, 2000, 2024, 2050):
        for month, day in ((3, 20), (6, 21), (9, 22), (12, 21), (12, 31), (1, 1)):
            cases += [
                (datetime.date(year, month, day), h, *p) for h in (0.0, 6.0, 12.0, 18.0) for p in PLACES
            ]
    return cases


def test_days_are_counted_as_the_calendar_counts_them(on_gpu):
    dates = [datetime.date(1901, 1, 1) + datetime.timedelta(d) for d in range(0, 72_682, 13)]
    result = on_gpu(
        FILE,
        "days_from_2000(year, day)",
        year=np.array([d.year for d in dates]),
        day=np.array([d.timetuple().tm_yday for d in dates]),
    )
    np.testing.assert_array_equal(result, [(d - datetime.date(2000, 1, 1)).days for d in dates])


def test_the_sun_is_where_the_almanac_says_for_a_hundred_years(on_gpu):
    cases = many()
    result = on_gpu(FILE, UNSEEN, **columns(cases)).astype(np.float64)
    truth = np.array([almanac(*case) for case in cases])
    error = apart(vector(result[:, 0], result[:, 1]), truth)
    assert error.max() < 0.03  # the almanac's own 0.01, and this file's
    assert ((result[:, 0] >= 0) & (result[:, 0] <= 360)).all()


def test_sunrise_and_sunset_come_at_the_almanac_s_minute(on_gpu):
    """The hour at which the almanac's sun crosses the horizon, by bisection: here it is level, too."""
    cases, risings = [], []
    for latitude, longitude in ((36.3, -84.2), (-33.9, 18.4), (0.0, 0.0), (51.5, 0.0)):
        for month in (3, 6, 9, 12):
            date, noon = datetime.date(2025, month, 21), 12 - longitude / 15
            for rising in (True, False):
                low, high = (noon - 12, noon) if rising else (noon, noon + 12)
                for _ in range(30):
                    middle = (low + high) / 2
                    up = almanac(date, middle, latitude, longitude)[2] > 0
                    low, high = (low, middle) if up == rising else (middle, high)
                cases.append((date, low, latitude, longitude))
                risings.append(rising)
    result = on_gpu(FILE, UNSEEN, **columns(cases))
    assert np.abs(result[:, 1]).max() < 0.03
    np.testing.assert_array_equal(result[:, 0] < 180, risings)


def test_published_examples(on_gpu):
    # Reda and Andreas 2004, "Solar Position Algorithm": 17 October 2003, 12:30:30, seven hours behind.
    case = (datetime.date(2003, 10, 17), 19 + 30.5 / 60, 39.742476, -105.1786)
    result = on_gpu(FILE, SEEN, **columns([case])).astype(np.float64)[0]
    assert apart(vector(*result), vector(194.34024, 90 - 50.11162)) < 0.01
    # Meeus 1998, examples 25.a and 28.b: 13 October 1992 at 0 h, declination and equation of time.
    course = on_gpu(FILE, "sun_course(days_from_2000(1992, 287), 0.0)").astype(np.float64)[0]
    assert np.degrees(np.arcsin(course[0])) == pytest.approx(-7.78507, abs=0.003)
    assert course[1] == pytest.approx(3.427351, abs=0.01)
    # Meeus 1998, example 27.a: the sun stands highest on 21 June 1962 at 21:24 universal time.
    around = on_gpu(
        FILE,
        "sun_course(days_from_2000(1962, 172), hours)",
        hours=np.array([21.4 - 30 * 24, 21.4, 21.4 + 30 * 24]),
    )
    assert np.degrees(np.arcsin(np.float64(around[1, 0]))) == pytest.approx(23.4405, abs=0.005)
    assert np.degrees(np.arcsin(around[[0, 2], 0].astype(np.float64))).max() < 22


def test_the_sun_s_own_noon_is_on_the_meridian(on_gpu):
    rng = np.random.default_rng(8)
    places = np.stack([rng.uniform(-89, 89, 200), rng.uniform(-180, 180, 200)], axis=1)
    days = rng.integers(1, 367, 200)
    result = on_gpu(FILE, "sun_position_solar(place, 2025, day, 12.0)", place=places, day=days).astype(
        np.float64
    )
    upright = np.abs(vector(result[:, 0], result[:, 1])[:, 0])  # nothing of it is east or west
    assert upright.max() < 1e-5
    declination = on_gpu(FILE, "sun_course(days_from_2000(2025, day), 12.0).x", day=days).astype(np.float64)
    height = 90 - np.abs(places[:, 0] - np.degrees(np.arcsin(declination)))
    seen = height > 1
    np.testing.assert_allclose(result[seen, 1], height[seen], atol=0.45)  # refraction and half a day
    high = height > 45
    np.testing.assert_allclose(result[high, 1], height[high], atol=0.25)


def test_the_sun_rises_in_the_east_and_both_clocks_agree(on_gpu):
    hours = np.arange(5, 19.01, 0.5)
    result = on_gpu(FILE, "sun_position_solar(vec2(36.3, -84.2), 2025, 120, hours)", hours=hours)
    assert (np.diff(result[:, 0]) > 0).all()
    assert result[2, 0] < 90 and result[-3, 0] > 270
    np.testing.assert_allclose(result[:, 1], result[::-1, 1], atol=0.2)  # morning mirrors afternoon
    # Universal time is the sun's, less the longitude's hours and the equation of time.
    ahead = on_gpu(FILE, "sun_course(days_from_2000(2025, 120), 17.0).y").astype(np.float64)
    universal = hours + 84.2 / 15 - ahead / 15
    other = on_gpu(FILE, "sun_position(vec2(36.3, -84.2), 2025, 120, hours)", hours=universal)
    assert apart(vector(*result.T.astype(np.float64)), vector(*other.T.astype(np.float64))).max() < 0.02


def test_refraction_is_that_of_the_air(on_gpu):
    heights = np.concatenate([np.linspace(-0.5, 90, 400), [5.0, 85.0, 0.0]])
    result = on_gpu(FILE, "refraction(h)", h=heights).astype(np.float64)
    # Saemundsson 1986, from heights without air, for 1010 hPa and 10 °C.
    other = 1.02 / np.tan(np.radians(heights + 10.3 / (heights + 5.11))) / 60
    np.testing.assert_allclose(result, other, atol=0.1)
    high = heights > 5
    np.testing.assert_allclose(result[high], other[high], atol=0.004)
    # By pieces, without steps, and gone at both ends.
    fine = np.linspace(-90, 90, 40_001)
    result = on_gpu(FILE, "refraction(h)", h=fine).astype(np.float64)
    assert np.abs(np.diff(result)).max() < 0.01 and (result >= 0).all() and np.isfinite(result).all()
    assert result[0] < 1e-3 and result[-1] == 0


def test_nothing_breaks_at_poles_zeniths_and_far_hours(on_gpu):
    places = np.array([(90.0, 0.0), (-90.0, 30.0), (0.0, 0.0), (23.43, 180.0), (-90.0, -180.0)])
    hours, days = np.array([-1e4, 0.0, 6.0, 12.0, 24.0, 1e4]), np.array([1, 79, 80, 172, 366])
    which = np.array(np.meshgrid(range(5), hours, days)).reshape(3, -1)
    position, hour, day = places[which[0].astype(int)], which[1], which[2].astype(int)
    result = on_gpu(FILE, "sun_position_solar(place, 2025, day, hour)", place=position, hour=hour, day=day)
    assert np.isfinite(result).all() and np.abs(result[:, 1]).max() < 90.1
    overhead = on_gpu(FILE, "sun_over(0.0, 0.0, 0.0)")[0]
    assert overhead[1] == pytest.approx(90, abs=1e-4) and overhead[0] == 0
    # The whole circle, straight north and south included.
    hours = np.linspace(0, 360, 721)
    for declination in (-0.3, 0.0, 0.39):
        result = on_gpu(FILE, f"sun_over(50.0, {declination}, h)", h=hours).astype(np.float64)
        assert np.isfinite(result).all() and result[:, 0].min() >= 0 and result[:, 0].max() <= 360
