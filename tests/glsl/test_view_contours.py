"""view/contours: where lines must be on planes and cones, how wide, and what is left where they crowd."""

from __future__ import annotations

import numpy as np
import pytest

HEIGHT = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) {{ return {}; }}\n'
COLOUR = '#pragma kernel(output = "colour:rgba16f")\nvec4 kernel(ivec2 texel) {{ return {}; }}\n'
PASSES = '[[pass]]\nname = "height"\nuse = "./terrain"\n{}[[pass]]\nname = "lines"\nuse = "view/contours"\n'
PASSES += 'set = {{ line = "#000000", strength = 1.0, {} }}\n{}'
GROUND = '[[pass]]\nname = "colour"\nuse = "./ground"\n'
EASTWARD = "float(texel.x) / float(size.x - 1)"


@pytest.fixture
def cover(make_sketch):
    """Give how much of each texel lines cover, row 0 south."""

    def read(engine, terrain, given, more="", **sketch):
        files = {"terrain": HEIGHT.format(terrain)}
        result = engine.read(make_sketch(PASSES.format("", given, more), **files, **sketch), "lines")
        return 1.0 - result[..., 0].astype(float)

    return read


def on_lines(away, wide):
    """Return how much of a texel a line covers, its middle so many texels away."""
    return np.clip(0.5 * wide + 0.5 - away, 0, 1) * min(wide, 1)


@pytest.mark.parametrize("width", [1.0, 3.0, 0.5])
def test_on_a_plane_lines_stand_where_the_elevation_is_theirs(engine, cover, width):
    text = f"interval = 10, every = 0, width = {width}"
    result = cover(engine, EASTWARD, text, size=[201, 5], extent=[2000.0, 40.0], relief=100.0)
    x = np.arange(201.0)
    away = np.abs(x[:, None] - np.arange(0, 201, 20.0)).min(axis=1)
    np.testing.assert_allclose(result[2], on_lines(away, width), atol=2e-3)


@pytest.mark.parametrize("size", [[101, 101], [257, 257], [301, 151]])
def test_contours_on_cone_are_circles_of_even_width_at_any_size(any_engine, cover, size):
    """1000 m of cone, 5 lines; the terrain has 513 texels a side, the lines a size of their own."""
    cone = "1.0 - length(vec2(texel) / float(size.x - 1) - 0.5) * 2.0"
    value = "interval = 200, every = 0, width = 2"
    result = cover(any_engine, cone, value, f"size = {size}\n", size=513, extent=1000.0, relief=1000.0)
    x, y = np.meshgrid(np.linspace(-500, 500, size[0]), np.linspace(-500, 500, size[1]))
    radius = np.hypot(x, y)
    # Metres to the next circle, over metres from texel to texel in its direction.
    metres = np.abs(radius[..., None] - np.array([100, 200, 300, 400, 500.0, 600])).min(axis=-1)
    unit = np.stack([x, y], axis=-1) / np.maximum(radius, 1e-9)[..., None]
    steps = np.hypot(unit[..., 0] * 1000 / (size[0] - 1), unit[..., 1] * 1000 / (size[1] - 1))
    inside = (radius > 60) & (radius < 480)
    np.testing.assert_allclose(
        result[inside], on_lines(metres / np.maximum(steps, 1e-9), 2)[inside], atol=0.06
    )


def test_their_widths_do_not_depend_on_the_slope(any_engine, cover):
    """Summed across a line its cover is its width, on gentle terrain and on steep."""
    for relief in (50.0, 100.0, 200.0):
        result = cover(
            any_engine, EASTWARD, "interval = 25, every = 0, width = 3", size=[401, 3], relief=relief
        )
        lines = relief / 25
        inside = result[1, round(200 / lines) : -round(200 / lines)]
        np.testing.assert_allclose(inside.sum(), 3 * (lines - 1), rtol=0.02)


def test_every_so_manieth_line_is_thick_counted_from_sea_level(any_engine, make_sketch):
    value = "interval = 10, every = 5, width = 1, thick = 4"
    text = "base_elevation = 230.0\n" + PASSES.format("", value, "")
    sketch = make_sketch(
        text, size=[401, 3], extent=[4000.0, 20.0], relief=100.0, terrain=HEIGHT.format(EASTWARD)
    )
    result = 1 - any_engine.read(sketch, "lines")[1, :, 0].astype(float)
    for elevation in range(240, 330, 10):
        x = (elevation - 230) * 4
        np.testing.assert_allclose(result[x - 6 : x + 7].sum(), 4 if elevation % 50 == 0 else 1, atol=0.02)


def test_crowded_contours_fade_to_mean_without_flicker(any_engine, cover):
    result = cover(any_engine, EASTWARD, "interval = 0.5, every = 0, width = 0.8", size=[101, 5], relief=50.0)
    np.testing.assert_allclose(result, min(0.8 * 50 / 100 / 0.5, 1.0), atol=2e-3)


def test_level_terrain_has_no_lines_even_at_the_elevation_of_one(any_engine, cover):
    for terrain in ("0.0", "0.5", "0.51"):
        assert (cover(any_engine, terrain, "interval = 10", size=9) == 0).all()


def test_below_the_sea_lines_go_on(any_engine, cover):
    result = cover(any_engine, f"{EASTWARD} - 0.5", "interval = 10, every = 0, width = 1", size=[201, 3])
    peaks = np.flatnonzero(result[1] > 0.9)
    np.testing.assert_array_equal(peaks, np.arange(0, 201, 20))


def test_the_ground_is_seen_between_them_at_its_own_resolution(any_engine, make_sketch):
    text = PASSES.format(GROUND, "interval = 40", "size = 65\n")
    ground = COLOUR.format("vec4(vec2(texel) / vec2(size - 1), 0.25, 1.0)")
    sketch = make_sketch(
        text, size=33, relief=10.0, terrain=HEIGHT.format(f"0.3 + 0.1 * {EASTWARD}"), ground=ground
    )
    result = any_engine.read(sketch, "lines").astype(float)
    x, y = np.meshgrid(np.linspace(0, 1, 65), np.linspace(0, 1, 65))
    np.testing.assert_allclose(result[..., 0], x, atol=2e-3)
    np.testing.assert_allclose(result[..., 1], y, atol=2e-3)


def test_what_is_not_a_number_leaves_the_ground(any_engine, cover):
    result = cover(any_engine, "uintBitsToFloat(0x7fc00000u)", "interval = 10", size=5)
    assert (result == 0).all()
