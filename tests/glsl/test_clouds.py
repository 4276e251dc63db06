"""clouds/…: clouds of a cover leave what the cover leaves of the sun, and go with the wind."""

import numpy as np
import pytest

DRIFT = '[[pass]]\nname = "drift"\nuse = "clouds/drift"\nsize = 1\n'


def field(make_sketch, size="[200, 152]", day="", **value):
    values = ", ".join(f"{k} = {v}" for k, v in value.items())
    use = f'[[pass]]\nname = "field"\nuse = "clouds/field"\nsize = {size}\nset = {{ {values} }}\n'
    return make_sketch(day + use)


def dense_part(thick, steps=200):
    """Return the integral over the height of the density in clouds of a thickness, in the tallest."""
    total = 0.0
    for k in range(steps):
        up = (k + 0.5) / steps * thick
        foot = np.clip(up / 0.035, 0, 1)
        total = total + np.clip((thick - up) * 16, 0, 1) * foot**2 * (3 - 2 * foot) * thick / steps
    return total


@pytest.mark.slow
@pytest.mark.parametrize(
    ("size", "seed"),
    [
        ("[200, 152]", 3),
        ("33", 3),
        *(
            pytest.param(*case, marks=pytest.mark.slow)
            for case in (("[200, 152]", 11), ("100", 11), ("257", 5))
        ),
    ],
)
def test_clouds_leave_of_the_beam_what_their_cover_leaves(any_engine, make_sketch, size, seed):
    """Kasten and Czeplak 1980, from clear to overcast, to a level of eight bits; more cover, more cloud."""
    before = None
    for cover in (0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0):
        result = any_engine.read(field(make_sketch, size, clouds=cover, seed=seed), "field").astype(
            np.float64
        )
        beam = (1 - 0.75 * cover**3.4) * (1 - cover**2)
        assert result[..., 3].mean() == pytest.approx(beam, abs=1 / 255), cover
        assert before is None or (result[..., 0] >= before - 1e-3).all()
        before = result[..., 0]
        # Beer and Lambert, through drops whose depth is what is not scattered nearly straight on.
        depth = (1 - 0.85**2) * 0.067 * 900 * dense_part(result[..., 0])
        np.testing.assert_allclose(result[..., 3], np.exp(-depth), rtol=0.01, atol=1e-4)


def test_their_cover_is_daylight_s(any_engine, make_sketch):
    day = '[[pass]]\nname = "daylight"\nuse = "lighting/daylight"\nset = { clouds = 0.55 }\n'
    wired = any_engine.read(field(make_sketch, day=day, clouds=0.1), "field")
    own = any_engine.read(field(make_sketch, clouds=0.55), "field")
    np.testing.assert_array_equal(wired, own)
    # Another hour makes no new clouds.
    sketch = field(make_sketch, day=day)
    any_engine.read(sketch, "field")
    any_engine.read(sketch.with_values({"daylight.hour": 15.0}), "field")
    assert not any(name.startswith("field") for name in any_engine.record.ran)


def test_a_tile_fits_beside_its_copy(any_engine, make_sketch):
    result = any_engine.read(field(make_sketch, seed=5, across=3), "field.shape").astype(np.float64)[..., :3]
    for axis in (0, 1):
        steps = np.abs(np.diff(result, axis=axis)).max(axis=(0, 1))
        around = np.abs(np.take(result, 0, axis) - np.take(result, -1, axis)).max(axis=0)
        assert (around <= 1.1 * steps).all()  # the most of 200 pairs of columns, and of one


@pytest.mark.parametrize("wind", [(8.0, 3.0), (-21.5, -0.5)])
def test_clouds_go_with_the_wind_and_come_again(any_engine, make_sketch, wind):
    sketch = make_sketch(DRIFT).with_values({"drift.wind": list(wind), "drift.wide": 9000.0})
    sketch = sketch.with_values({"drift.pace": 3.0, "drift.base": 1800.0})
    for time in (0.0, 1.0, 77.0, 4321.0):
        result = any_engine.read(sketch, "drift", time=time)[0, 0].astype(np.float64)
        truth = np.array(wind) * 3 * time
        off = (result[:2] - truth + 4500) % 9000 - 4500
        np.testing.assert_allclose(off, 0, atol=1e-6 * max(np.abs(truth).max(), 9000))
        assert (result[:2] >= 0).all() and (result[:2] <= 9000).all()
        np.testing.assert_array_equal(result[2:], [1800, 9000])
    period = 9000 / 3 / abs(wind[0])
    first, other = (any_engine.read(sketch, "drift", time=t)[0, 0, 0] for t in (5.0, 5.0 + 4 * period))
    assert (first - other + 4500) % 9000 - 4500 == pytest.approx(0, abs=0.05)
