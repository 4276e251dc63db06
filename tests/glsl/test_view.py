"""view/: what is where in the picture, and what its colours are."""

from __future__ import annotations

import numpy as np
import pytest

from playground.shader.colours import linear_to_srgb
from playground.sketch.model import Camera

from ..truth import eyes

HEIGHT = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) {{ return {}; }}\n'
COLOUR = '#pragma kernel(output = "colour:rgba16f")\nvec4 kernel(ivec2 texel) {{ return {}; }}\n'
WHITE = COLOUR.format("vec4(1.0)")
PASSES = '[[pass]]\nname = "height"\nuse = "./terrain"\n[[pass]]\nname = "colour"\nuse = "./cover"\n'
NAN = "uintBitsToFloat(0x7fc00000u)"
MAGENTA = (255, 0, 255)


@pytest.fixture
def terrain(make_sketch):
    def make(height="0.0", colour="vec4(1.0)", size=33, given="", **more):
        view = f'[view]\nuse = "view/terrain"\nsamples = 1\nset = {{ {given or "grid = 33"} }}\n'
        files = {"terrain": HEIGHT.format(height), "cover": COLOUR.format(colour)}
        return make_sketch(PASSES + view, size=size, **files, **more)

    return make


def above(sketch, azimuth=180.0, elevation=60.0, **more):
    return sketch.with_camera(Camera(azimuth=azimuth, elevation=elevation, **more))


def pixels_of(engine, points):
    """Where points of the terrain are in the last picture: column and row from the top left."""
    plan = engine.record.plan
    places = eyes.pixels_of(plan.eye, points, plan.frame_size)
    return places * [1, -1] + [0, plan.frame_size[1]]


# ── the terrain ─────────────────────────────────────────────────────────────────


def test_vertices_stand_where_the_camera_s_matrix_says(any_engine, terrain):
    mark = "texel == ivec2(8, 24) ? vec4(1.0, 0.0, 0.0, 1.0) : vec4(0.0, 0.0, 1.0, 1.0)"
    blue = 'grid = 33, earth = "#0000ff"'
    sketch = above(terrain(height="0.5", colour=mark, given=blue), azimuth=205, elevation=50)
    picture = any_engine.render(sketch, size=(300, 200)).array.astype(float)
    red = np.clip(picture[..., 0] - picture[..., 2], 0, None)
    rows, columns = np.indices(red.shape)
    middle = np.array([(columns + 0.5).ravel() @ red.ravel(), (rows + 0.5).ravel() @ red.ravel()]) / red.sum()
    expected = pixels_of(any_engine, np.array([[250.0, 750.0, 50.0]]))[0]
    np.testing.assert_allclose(middle, expected, atol=1.0)


def test_cover_and_light_of_any_size_align_to_terrain_corners(on_gpu):
    for texels in (2, 33, 1025):
        ends = on_gpu("maths/drape.glsl", f"drape_uv(s, ivec2({texels}))", s=np.array([[0.0] * 2, [1.0] * 2]))
        np.testing.assert_allclose(ends * texels - 0.5, [[0, 0], [texels - 1, texels - 1]], atol=1e-4)


def test_no_colour_and_no_light_is_white_terrain(any_engine, make_sketch):
    text = '[[pass]]\nname = "height"\nuse = "./terrain"\n[view]\nuse = "view/terrain"\nsamples = 1\n'
    picture = any_engine.render(above(make_sketch(text, terrain=HEIGHT.format("0.0"))), size=(64, 64)).array
    assert (picture[32, 32] == 255).all()


@pytest.mark.parametrize("samples", [1, 4])
def test_a_hole_in_the_numbers_shows_and_harms_nothing_else(any_engine, terrain, samples):
    hole = f"all(lessThan(abs(texel - 16), ivec2(2))) ? {NAN} : 0.0"
    whole, broken = (above(terrain(height=h)).with_picture(samples=samples) for h in ("0.0", hole))
    first, other = (any_engine.render(s, size=(160, 120)).array for s in (whole, broken))
    changed = (first != other).any(axis=-1)
    magenta = (other[..., :3] == MAGENTA).all(axis=-1)
    assert magenta.sum() > 20
    assert changed.mean() < 0.1
    assert (other[..., 3] == 255).all()
    assert not (first[..., :3] == MAGENTA).all(axis=-1).any()


def test_heights_of_any_size_leave_the_picture_opaque(any_engine, terrain):
    wild = "texel.x == 3 ? 1e30 : texel.x == 9 ? -1e30 : texel.x == 20 ? 1.0 / float(texel.y - 5) : 0.5"
    picture = any_engine.render(above(terrain(height=wild)), size=(64, 48)).array
    assert (picture[..., 3] == 255).all()


def test_the_cut_is_earth_and_the_terrain_is_not(any_engine, terrain):
    value = 'grid = 33, earth = "#804020", skirt = 0.2'
    sketch = above(terrain(height="0.5", given=value), elevation=10.0, azimuth=180.0)
    any_engine.render(sketch, size=(200, 150))
    frame = any_engine.read(sketch, "view.land", size=(200, 150))
    column, row = pixels_of(any_engine, np.array([[500.0, 0.0, 0.0]]))[0].astype(int)
    red, green, blue, _ = frame[149 - row, column].astype(float)
    assert red > 2 * green > 2 * blue
    column, row = pixels_of(any_engine, np.array([[500.0, 300.0, 50.0]]))[0].astype(int)
    np.testing.assert_array_equal(frame[149 - row, column], 1.0)


# ── wires ────────────────────────────────────────────────────────────────────


def test_wires_change_pixels_of_the_terrain_alone(any_engine, terrain):
    hills = "0.5 + 0.4 * sin(float(texel.x) * 0.6) * sin(float(texel.y) * 0.5)"
    green = "vec4(0.2, 0.3, 0.1, 1.0)"
    sketch = above(terrain(height=hills, colour=green, given="grid = 17"), elevation=30.0)
    wired = sketch.with_values({"view.wireframe": True})
    plain, lines = (any_engine.render(s, size=(240, 160)).array.astype(int) for s in (sketch, wired))
    sky, terrain = (any_engine.read(sketch, f"view.{p}", size=(240, 160))[::-1] for p in ("sky", "land"))
    on_terrain = (np.abs(sky - terrain) > 1e-3).any(axis=-1)
    changed = (plain != lines).any(axis=-1)
    assert changed.sum() > 1000
    assert not (changed & ~on_terrain).any()


def test_wires_run_along_the_mesh_s_edges(any_engine, terrain):
    value = 'grid = 5, wireframe = true, wire = "#ff0000", faces = 0.0'
    sketch = above(terrain(given=value), elevation=89.0)
    any_engine.render(sketch, size=(400, 400))
    frame = any_engine.read(sketch, "view.land", size=(400, 400))[..., 0].astype(float)
    cell = 1000.0 / 4
    on = np.array([[1, 1.5], [1.5, 2], [2.5, 2.5], [3, 2.2]])  # two sides, a diagonal, a side
    off = np.array([[1.7, 1.3], [0.25, 0.75], [2.3, 3.7]])
    for places, expected in ((on, True), (off, False)):
        for column, row in pixels_of(any_engine, np.c_[places * cell, np.zeros(len(places))]).astype(int):
            near = frame[398 - row : 401 - row, column - 1 : column + 2]
            assert (near.max() > 0.5) == expected


def test_wires_closer_than_pixels_become_their_mean_grey(any_engine, terrain):
    value = 'grid = 41, wireframe = true, wire = "#ffffff", faces = 0.0'
    sketch = above(terrain(given=value), elevation=89.0)
    any_engine.render(sketch, size=(100, 100))
    frame = any_engine.read(sketch, "view.land", size=(100, 100))[..., 0].astype(float)
    assert frame[30:70, 30:70].std() < 0.04


# ── sky ──────────────────────────────────────────────────────────────────────


def test_where_there_is_no_terrain_there_is_sky(any_engine, terrain):
    sketch = above(terrain(), elevation=40.0)
    sky, terrain = (any_engine.read(sketch, f"view.{p}", size=(96, 64)) for p in ("sky", "land"))
    corners = np.ix_([0, -1], [0, -1])
    np.testing.assert_array_equal(sky[corners], terrain[corners])
    assert (sky != terrain).any()


def test_the_horizon_s_colour_is_level_with_the_eye(engine, terrain):
    value = 'zenith = "#0000ff", horizon = "#00ff00", nadir = "#ff0000"'
    sketch = above(terrain(given=value), elevation=0.0)
    sky = engine.read(sketch, "view.sky", size=(9, 101)).astype(float)
    assert sky[50, 4, 1] > 0.97
    assert (np.diff(sky[50:, 4, 2]) > 0).all()  # bluer and bluer upwards
    assert (np.diff(sky[:51, 4, 0]) < 0).all()  # redder and redder downwards
    assert sky[50:, :, 0].max() < 0.02


# ── sea ──────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(("level", "base"), [(25.0, 0.0), (70.0, 0.0), (170.0, 100.0)])
def test_the_sea_drowns_the_terrain_below_its_level_and_no_other(any_engine, terrain, level, base):
    ramp = "float(texel.x) / float(size.x - 1)"
    text = f'grid = 33, sea = true, sea_level = {level}, water = "#0000ff", horizon = "#0000ff"'
    sketch = above(terrain(height=ramp, given=text), elevation=89.0).with_values({"base_elevation": base})
    any_engine.render(sketch, size=(200, 200))
    before, after = (any_engine.read(sketch, f"view.{p}", size=(200, 200))[::-1] for p in ("land", "sea"))
    drowned = (np.abs(after - before) > 0.05).any(axis=-1)
    shares = np.array([(i, j) for i in np.arange(1, 32) / 32 for j in np.arange(1, 32) / 32])
    heights = shares[:, 0] * 100.0
    places = pixels_of(any_engine, np.c_[shares * 1000.0, np.maximum(heights, level - base)]).astype(int)
    clear = np.abs(heights - (level - base)) > 1.0
    result = drowned[places[clear, 1], places[clear, 0]]
    np.testing.assert_array_equal(result, heights[clear] < level - base)


def test_a_hill_hides_the_sea_behind_it(any_engine, terrain):
    wall = "texel.y == 8 ? 1.0 : 0.0"
    value = "grid = 33, sea = true, sea_level = 10"
    sketch = above(terrain(height=wall, given=value, relief=400.0), elevation=5.0)
    any_engine.render(sketch, size=(200, 150))
    before, after = (any_engine.read(sketch, f"view.{p}", size=(200, 150))[::-1] for p in ("land", "sea"))
    column, row = pixels_of(any_engine, np.array([[500.0, 250.0, 200.0]]))[0].astype(int)
    np.testing.assert_array_equal(after[row, column], before[row, column])
    column, row = pixels_of(any_engine, np.array([[500.0, 100.0, 10.0]]))[0].astype(int)
    assert (after[row, column] != before[row, column]).any()


SHOWN = 'grid = 33, sea = true, water = "#0000ff", horizon = "#0000ff"'


@pytest.mark.parametrize("elevation", [-20.0, 4.0, 30.0])
def test_a_sea_far_below_the_ground_does_not_float_in_the_air(any_engine, terrain, elevation):
    """From the side it would show below the terrain's walls; only what the ground does not bury is drawn."""
    hills = "0.3 + 0.7 * float((texel.x + texel.y) % 16) / 15.0"
    text = f"{SHOWN}, sea_level = -150"
    sketch = above(terrain(height=hills, given=text), elevation=elevation)
    array = any_engine.render(sketch, size=(120, 90)).array
    without = any_engine.render(sketch.with_values({"view.sea": False}), size=(120, 90)).array
    np.testing.assert_array_equal(array, without)


def test_low_sea_level_fills_valley_below_zero_height(any_engine, terrain):
    valley = "abs(texel.x - 16) < 6 ? -2.0 : 1.0"
    sketch = above(terrain(height=valley, given=f"{SHOWN}, sea_level = -150"), elevation=89.0)
    any_engine.render(sketch, size=(200, 200))
    before, after = (any_engine.read(sketch, f"view.{p}", size=(200, 200))[::-1] for p in ("land", "sea"))
    east = np.array([300.0, 400.0, 500.0, 600.0, 700.0])
    places = pixels_of(any_engine, np.c_[east, np.full(5, 500.0), [100, -150, -150, -150, 100]]).astype(int)
    filled = (np.abs(after - before) > 0.05).any(axis=-1)[places[:, 1], places[:, 0]]
    np.testing.assert_array_equal(filled, [False, True, True, True, False])


def test_no_sea_costs_nothing(any_engine, terrain):
    """Nor does the terrain when there is one, by the fast variant either."""
    for sketch, inside in ((above(terrain()).plainly(), ""), (above(terrain()), "fast.")):
        inside = inside if any_engine.info.software else ""
        any_engine.render(sketch, size=(40, 30))
        assert {"view.sea", "view.fast.sea"}.isdisjoint(any_engine.record.ran)
        any_engine.render(sketch.with_values({"view.sea": True}), size=(40, 30))
        assert any_engine.record.ran == [f"view.{inside}sea", f"view.{inside}present"]


# ── the last pass ────────────────────────────────────────────────────────────


@pytest.fixture
def presented(make_sketch):
    ramp = COLOUR.replace("16f", "32f").format("vec4(float(texel.x) / 63.0 * vec3(1.0, 0.1, 2.0), 0.25)")

    def make(given):
        view = f'[view]\nuse = "view/present"\ninputs = {{ picture = "ramp" }}\nset = {{ {given} }}\n'
        return make_sketch(f'[[pass]]\nname = "ramp"\nuse = "./ramp"\n{view}', size=[64, 4], ramp=ramp)

    return make


@pytest.mark.parametrize("stops", [-1.0, 0.0, 1.0])
def test_the_picture_is_encoded_by_the_srgb_curve(engine, presented, stops):
    picture = engine.render(presented(f"exposure = {stops}"), size=(64, 4)).array
    light = np.arange(64)[:, None] / 63 * np.array([1.0, 0.1, 2.0]) * 2.0**stops
    assert np.abs(picture[2, :, :3] - linear_to_srgb(np.clip(light, 0, 1)) * 255).max() <= 0.51
    assert (picture[..., 3] == 255).all()


@pytest.mark.parametrize("tone", ["Reinhard", "film"])
def test_a_tone_curve_keeps_order_and_brings_bright_light_in(engine, presented, tone):
    bright = presented("exposure = 1.0")
    both = (bright, bright.with_values({"view.tone": tone}))
    cut, bent = (engine.render(sketch, size=(64, 4)).array[0] for sketch in both)
    assert (np.diff(bent[:, 2].astype(int)) >= 0).all()
    assert (bent[:, 2] == 255).sum() < (cut[:, 2] == 255).sum()


# ── the map ──────────────────────────────────────────────────────────────────


@pytest.fixture
def shown(make_sketch):
    def make(height, size, given='channel = "red"'):
        view = f'[view]\nuse = "view/map"\ninputs = {{ shown = "height" }}\nset = {{ {given} }}\n'
        passes = '[[pass]]\nname = "height"\nuse = "./terrain"\n'
        return make_sketch(passes + view, size=size, terrain=HEIGHT.format(height))

    return make


def test_the_map_shows_each_value_in_its_place_north_on_top(engine, shown):
    sketch = shown("(float(texel.x) + 40.0 * float(texel.y)) / 1280.0", [40, 32])
    picture = engine.render(sketch, size=(40, 32)).array
    values = (np.arange(40) + 40 * np.arange(32)[::-1, None]) / 1280
    assert np.abs(picture[..., 0] - values * 255).max() <= 0.51
    assert (picture[..., 3] == 255).all()


def test_an_enlarged_map_has_squares(engine, shown):
    sketch = shown("float((texel.x + texel.y) & 1)", [4, 4])
    picture = engine.render(sketch, size=(32, 32)).array[..., 0]
    assert set(np.unique(picture)) == {0, 255}
    np.testing.assert_array_equal(picture[::8, ::8], picture[7::8, 7::8])


def test_a_shrunk_map_shows_means_or_single_texels(engine, shown):
    board = "float((texel.x & 3) == 0)"
    mean = engine.render(shown(board, [64, 64]), size=(16, 16)).array[..., 0]
    assert np.abs(mean.astype(int) - 64).max() <= 1
    value = 'channel = "red", shrunk = "nearest"'
    nearest = engine.render(shown(board, [64, 64], value), size=(16, 16)).array[..., 0]
    assert set(np.unique(nearest)) <= {0, 255}


def test_what_is_not_a_number_has_a_colour_of_its_own_on_the_map(engine, shown):
    picture = engine.render(shown(f"texel.x == 3 ? {NAN} : 0.5", [8, 8]), size=(8, 8)).array
    magenta = (picture[..., :3] == MAGENTA).all(axis=-1)
    np.testing.assert_array_equal(magenta, np.arange(8)[None] * np.ones((8, 1)) == 3)
