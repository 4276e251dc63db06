"""Shadows, hard and soft, marched and swept: slow marches in float64, quadrature, symmetries, limits.

The marches here know nothing of early ends, of leaps or of lines: they look from a place along
its way to the sun at every piece of terrain, and measure angles and lengths. That both drivers
give the same bits is tested in test_drivers.py.
"""

import shutil
from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import binary_dilation, map_coordinates, maximum_filter

from playground.engine.context import ContextInfo
from playground.engine.engine import Engine
from playground.shader.parameter import MAX_SIDE

from ..sketch_texts import passes, toml_value
from ..truth.marches import Views
from .terrains import HILLS

DATA = Path(__file__).resolve().parents[2] / "glsl/sketches/data/jacksboro_fault_dem.npz"
BOTH_FORMS = pytest.mark.parametrize("form", ["march", "sweep"])
SOFT = ["soft_cone", "soft_cylinder", "sun_disc"]
EVERY = [
    *[("ray_cast", form) for form in ("march", "sweep")],
    *[("soft_cone", form) for form in ("march", "sweep")],
    *[("sun_disc", form) for form in ("march", "sweep")],
    ("soft_cylinder", None),
    ("night", None),
]
EVERY_METHOD = pytest.mark.parametrize(("method", "form"), EVERY, ids=lambda v: str(v))

FLAT = """
#pragma kernel(output = "height:r32f")
uniform float base = 0.37;
float kernel(ivec2 texel) { return base; }
"""
# A mountain, the valley y = 32 between two slopes, a wall with a needle.
SHAPES = """
#pragma kernel(output = "height:r32f")
uniform int which = 0;  //! menu("cone", "valley", "wall", "needle")
float kernel(ivec2 texel) {
    vec2 middle = vec2(texel) - 0.5 * vec2(size - 1);
    if (which == 0) return max(1.0 - length(middle) / 24.0, 0.0);
    if (which == 1) return abs(middle.y) / 32.0;
    if (which == 2) return texel.x == size.x / 2 ? 1.0 : 0.0;
    return texel == size / 2 ? 1000.0 : 0.0;
}
"""


@pytest.fixture
def jacksboro(make_sketch, tmp_path):
    """Give a sketch of the Jacksboro fault, lit."""
    shutil.copy(DATA, tmp_path)

    def make(method, sun, **values):
        settings = "".join(f"{k} = {toml_value(v)}\n" for k, v in {"sun": sun, **values}.items())
        text = passes(
            height=("generation/heightmap", f'set = {{ elevation = "{DATA.name}" }}'),
            light=(f"lighting/{method}", "[pass.set]", f"{settings}"),
        )
        return make_sketch(text, size=[403, 344], extent=[29900.0, 31900.0], relief=840.0)

    return make


def visible(engine, sketch):
    """Return the visible part of the sun, as the method itself gives it."""
    inner = "light.moon.visibility" if "night" in _used(sketch) else "light.visibility"
    return engine.read(sketch, inner)


def _used(sketch):
    return next(p.use for p in sketch.graph.passes if p.name == "light")


def part_of_disc(line):
    """Return the fraction of a disc of radius 1 over a line, by counting points of a fine lattice."""
    axis = (np.arange(1200) + 0.5) / 600 - 1
    x, y = np.meshgrid(axis, axis)
    heights = np.sort(y[x * x + y * y <= 1])
    return 1 - np.searchsorted(heights, line) / heights.size


@pytest.mark.parametrize("sampling", ["interpolated", "cut down"])
@pytest.mark.parametrize("method", ["ray_cast", *SOFT])
def test_a_march_rounds_alike_by_uniforms_and_by_constants(ctx, make_sketch, monkeypatch, method, sampling):
    """A software renderer compiles menus in as constants; a GPU, and a page, have them as uniforms."""
    text = passes(
        height="generation/gradient_noise",
        light=(f"lighting/{method}", f'set = {{ sun = [110.0, 15.0], sampling = "{sampling}" }}'),
    )
    sketches = [
        make_sketch(text, size=list(size), extent=640.0, relief=130.0).with_values({"height.seed": seed})
        for seed, size in [(3, (65, 33)), (9978, (50, 77))]
    ]
    sketches += [sketch.plainly() for sketch in sketches]
    drawn = []
    for software in (True, False):
        monkeypatch.setattr(ContextInfo, "software", software)
        with Engine(ctx) as engine:
            drawn.append([visible(engine, sketch) for sketch in sketches])
    for constants, uniforms in zip(*drawn, strict=True):
        assert len(np.unique(constants)) > 1, "or it shows nothing"
        np.testing.assert_array_equal(constants, uniforms)


# What a march leaps over


@pytest.mark.parametrize("size", [(1, 1), (16, 17), (65, 33), (40, 100)], ids=str)
def test_block_maxima_cover_blocks_and_their_borders(any_engine, make_sketch, size):
    text = passes(
        height="generation/white_noise", maxima=("lighting/block_maxima", 'size = "(height.size + 15) // 16"')
    )
    sketch = make_sketch(text, size=list(size))
    heights = any_engine.read(sketch, "height")
    maxima = any_engine.read(sketch, "maxima")
    # The filter's window begins at its own texel, and what lies beside the terrain is as low as can be.
    expected = maximum_filter(heights, size=17, origin=-8, mode="constant", cval=-1.0)[::16, ::16]
    np.testing.assert_array_equal(maxima, expected)


@pytest.mark.parametrize("method", ["ray_cast", *SOFT])
@pytest.mark.parametrize("sun", [(135, 25), (262, 7), (0, 4)], ids=str)
def test_leaps_pass_over_nothing(any_engine, make_sketch, method, sun):
    """With blocks that reach to the sky every step is looked at, and the bits are the same."""
    sky = '#pragma kernel(output = "block_maxima:r32f")\nfloat kernel(ivec2 texel) { return 1e6; }\n'
    head = passes(
        height=("generation/gradient_noise", "set = { frequency = 3.0, seed = 5 }"),
        range="terrain/range",
        horizon=("./sky", "size = 1"),
    )
    result = []
    for use in ("lighting/block_maxima", "./sky"):
        text = (
            f'{head}[[pass]]\nname = "block_maxima"\nuse = "{use}"\nsize = "(height.size + 15) // 16"\n'
            f'[[pass]]\nname = "seen"\nuse = "lighting/{method}/leaping"\nset = {{ sun = {list(sun)} }}\n'
        )
        sketch = make_sketch(text, size=[200, 150], extent=[3000.0, 2000.0], relief=700.0, sky=sky)
        result.append(any_engine.read(sketch, "seen"))
    assert 0.05 < (result[0] < 1).mean() and (result[0] > 0).mean() > 0.05
    np.testing.assert_array_equal(result[0], result[1])


FAR_WALL = """
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return texel.x == size.x - 1 ? 1.0 : 0.0; }
"""


@pytest.mark.parametrize("method", ["ray_cast", "sun_disc"])
def test_shadow_crosses_widest_terrain_at_shortest_step(any_engine, lit, method):
    """A wall of 300 m hides all of a disc at 0.7 degrees as far as 17.8 km away: on 16384 texels of 1 m."""
    values = {
        "size": [MAX_SIDE, 2],
        "extent": [MAX_SIDE - 1.0, 1.0],
        "relief": 300.0,
        "step_length": 0.25,
    }
    result = visible(any_engine, lit(FAR_WALL, method, (90, 0.7), **values))
    assert result[:, :-1].max() < 1e-6
    assert result[:, -1].min() == 1


# Against the slow marches


SUNS = [(135, 25), (90, 15), (0, 6), (317, 40), (45, 10), (222.5, 60)]
GRID = {"size": [65, 49], "extent": [640, 960], "relief": 300.0}
SPACING = (10.0, 20.0)


def heights_of(engine, sketch, relief=300.0):
    return engine.read(sketch, "height").astype(np.float64) * relief


@pytest.mark.parametrize("sun", SUNS, ids=str)
@pytest.mark.parametrize(("delta_r", "step_length"), [(0.01, 1.0), (0.1, 0.5), (0.3, 2.0), (1.5, 1.0)])
def test_the_cone_is_that_of_a_slow_march(any_engine, lit, sun, delta_r, step_length):
    sketch = lit(HILLS, "soft_cone", sun, delta_r=delta_r, step_length=step_length, **GRID)
    views = Views(heights_of(any_engine, sketch), sun[0], SPACING, step_length)
    grows = delta_r / np.cos(np.radians(sun[1]))
    expected = views.free_of_beam(sun[1], lambda far: far * grows)
    result = visible(any_engine, sketch)
    assert expected.min() < 0.5 or sun[1] > 30
    # Close to the texel a cone of 0.01 is centimetres wide: a float's rounding is some of that.
    np.testing.assert_allclose(result, expected, atol=2e-3 if delta_r < 0.05 else 2e-4)


@pytest.mark.parametrize("sun", SUNS[:3], ids=str)
def test_thesis_step_counting_doubles_cone_at_half_step_length(any_engine, lit, sun):
    sketch = lit(HILLS, "soft_cone", sun, delta_r=0.05, step_length=0.5, growth="per step", **GRID)
    views = Views(heights_of(any_engine, sketch), sun[0], SPACING, 0.5)
    expected = views.free_of_beam(sun[1], lambda far: far * 0.1 / np.cos(np.radians(sun[1])))
    np.testing.assert_allclose(visible(any_engine, sketch), expected, atol=5e-4)
    same = [lit(HILLS, "soft_cone", sun, growth=g, **GRID) for g in ("per unit of path", "per step")]
    np.testing.assert_array_equal(visible(any_engine, same[0]), visible(any_engine, same[1]))


@pytest.mark.parametrize("sun", SUNS[1:5], ids=str)
@pytest.mark.parametrize("radius", [0.5, 20.0])
def test_the_cylinder_is_that_of_a_slow_march(any_engine, lit, sun, radius):
    sketch = lit(HILLS, "soft_cylinder", sun, radius=radius, **GRID)
    views = Views(heights_of(any_engine, sketch), sun[0], SPACING)
    expected = views.free_of_beam(sun[1], lambda _: radius / 255 * 300, first=0.5)
    np.testing.assert_allclose(visible(any_engine, sketch), expected, atol=3e-4)


@pytest.mark.parametrize("sun", [*SUNS[:4], (200, 0.1), (200, -0.2)], ids=str)
@pytest.mark.parametrize("diameter", [0.53, 10.0])
def test_the_disc_is_that_of_a_slow_march_and_quadrature(any_engine, lit, sun, diameter):
    sketch = lit(HILLS, "sun_disc", sun, diameter=diameter, **GRID)
    tangents = Views(heights_of(any_engine, sketch), sun[0], SPACING).tangents()
    horizon = np.degrees(np.arctan(tangents))
    expected = part_of_disc((horizon - sun[1]) / (diameter / 2))
    np.testing.assert_allclose(visible(any_engine, sketch), expected, atol=3e-3)


@pytest.mark.parametrize("sun", [(135, 25), (262, 7)], ids=str)
def test_light_of_another_size_marches_from_its_own_places(any_engine, lit, sun):
    sketch = lit(HILLS, "soft_cone", sun, delta_r=0.1, light_size='["3*size.x-2", "3*size.y-2"]', **GRID)
    views = Views(heights_of(any_engine, sketch), sun[0], SPACING, finer=3)
    expected = views.free_of_beam(sun[1], lambda far: far * 0.1 / np.cos(np.radians(sun[1])))
    result = visible(any_engine, sketch)
    assert result.shape == (145, 193)
    np.testing.assert_allclose(result, expected, atol=5e-4)


def test_the_disc_is_cut_as_quadrature_cuts_it(on_gpu):
    lines = np.linspace(-1.2, 1.2, 500)
    result = on_gpu("lighting/sun_disc/area.glsl", "disc_above(line)", line=lines)
    np.testing.assert_allclose(result, part_of_disc(lines), atol=1e-3)
    assert result[0] == 1 and result[-1] == 0


# Flat terrain


@BOTH_FORMS
@pytest.mark.parametrize("elevation", [0.0, 5.0, 30.0, 70.0, 89.9, 90.0])
@pytest.mark.parametrize("azimuth", [270.0, 137.0])
def test_on_flat_terrain_a_wide_cone_sees_the_known_part(any_engine, lit, form, azimuth, elevation):
    result = visible(any_engine, lit(FLAT, "soft_cone", (azimuth, elevation), delta_r=1.5, form=form))
    # Texels whose first step leaves the terrain see all of the sun.
    inner = result[1:-1, 1:-1]
    np.testing.assert_allclose(inner, (1 + np.sin(np.radians(elevation)) / 1.5) / 2, atol=1e-5)


# What holds for all


DEGENERATE = [
    {"size": [1, 1]},
    {"size": [2, 2]},
    {"size": [1, 20]},
    {"size": [20, 1]},
    {"relief": 0.0},
    {"relief": 1e5},
]


@EVERY_METHOD
def test_there_is_no_terrain_and_no_sun_without_numbers(any_engine, lit, method, form):
    suns = [(0, 90), (90, 0), (33, 89.9999), (77, -0.1), (45, -90), (135, 20)]
    for values in DEGENERATE:
        sketch = lit(HILLS, method, (0, 0), form=form, **{"size": 17, **values})
        for sun in suns:
            moved = sketch.with_values({"light.sun": sun})
            part = visible(any_engine, moved)
            assert np.isfinite(part).all() and part.min() >= 0 and part.max() <= 1, (values, sun)
            assert np.isfinite(any_engine.read(moved, "light")).all(), (values, sun)
            if sun[1] < -0.3:
                assert part.max() == 0


# The sweep


def test_both_drivers_sweep_alike(ctx, lit):
    """The plain form follows a texel's lines again for each texel, the compute variant each line once."""
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    with Engine(ctx, driver="fragment") as plain, Engine(ctx) as swept:
        for azimuth in (0, 12.3, 45, 90, 100, 135, 161, 180, 225, 230, 270, 301, 315, 317, 359.99999):
            shape = {"shape": "disc", "spread": 0.53}
            sketch = lit(HILLS, "sun_sweep", (azimuth, 9.0), size=[49, 65], relief=300.0, **shape)
            result = [engine.read(sketch, "light") for engine in (plain, swept)]
            np.testing.assert_array_equal(result[0], result[1])
        assert swept.record.plan.step("light").kernel.kind == "compute"


@pytest.mark.parametrize("method", ["ray_cast", "soft_cone", "sun_disc"])
def test_sweep_without_compute_marches_and_reports_it_once(ctx, lit, method):
    """The plain form looks along a texel's whole line: half a minute on 1537 texels a side, the march 2 s."""
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    said = []
    values = {"size": 65, "relief": 300.0, "light_size": 33}
    with Engine(ctx, driver="fragment", notice=said.append) as plain, Engine(ctx) as swept:
        march, sweep = (lit(HILLS, method, (100, 9), form=form, **values) for form in ("march", "sweep"))
        sweep_on_grid = visible(plain, sweep)
        assert plain.record.plan.step("light.horizon").size == (1, 1)
        assert said == [
            f"light does without compute shaders, which are not here: see glsl/lighting/{method}.toml"
        ]
        assert visible(swept, sweep).shape == sweep_on_grid.shape == (65, 65), (
            "a texel for each of the terrain's"
        )
        assert swept.record.plan.step("light.horizon").size == (65, 65)
        np.testing.assert_array_equal(sweep_on_grid[::2, ::2], visible(plain, march))
        assert len(said) == 1 and plain.record.plan.step("light.visibility.fast.block_maxima").size == (
            5,
            5,
        )


@pytest.mark.parametrize("azimuth", [0.0, 90.0, 180.0, 270.0, 45.0, 225.0])
def test_along_axes_and_diagonals_the_sweep_is_the_march(any_engine, lit, azimuth):
    """Lines meet texels only, and four slopes are enough to find what shadows a narrow cone."""
    values = {"size": 129, "relief": 300.0, "extent": 1280.0}
    for method in ("ray_cast", "soft_cone", "sun_disc"):
        march, sweep = (
            visible(any_engine, lit(HILLS, method, (azimuth, 9), form=form, **values))
            for form in ("march", "sweep")
        )
        difference = np.abs(march - sweep)
        assert (difference > 1e-3).mean() < 2e-3 and difference.mean() < 1e-4


# Shares of texels whose hard shadow may differ, and mean and root mean square of soft parts' differences.
BOUNDS = {5.0: (0.006, 0.006, 0.06), 25.0: (0.0003, 0.0003, 0.01)}


@pytest.mark.parametrize("elevation", [5.0, 25.0])
@pytest.mark.parametrize("azimuth", [105.0, 200.0])
def test_on_real_terrain_the_sweep_is_nearly_the_march(any_engine, jacksboro, azimuth, elevation):
    sun = (azimuth, elevation)
    hard, mean, square = BOUNDS[elevation]
    march, sweep = (visible(any_engine, jacksboro("ray_cast", sun, form=f)) for f in ("march", "sweep"))
    assert (march == 0).mean() > 0.005
    assert (march != sweep).mean() <= hard
    # What the sweep lights and the march does not lies beside what the march lights.
    beside = binary_dilation(march == 1, np.ones((3, 3)))
    assert ((sweep == 1) & ~beside).mean() <= hard / 10
    for method in ("soft_cone", "sun_disc"):
        march, sweep = (visible(any_engine, jacksboro(method, sun, form=f)) for f in ("march", "sweep"))
        difference = np.abs(march - sweep)
        assert difference.mean() <= mean and np.sqrt((difference**2).mean()) <= square


@pytest.mark.parametrize("azimuth", [180.0, 170.0, 205.0, 140.0])
def test_the_sweep_finds_the_other_rim_of_a_valley(any_engine, lit, azimuth):
    """Slopes of 100 m on 320 m, 10 m a texel: the southern rim's angle is known in closed form."""
    values = {"extent": 640.0, "given": {"which": "valley"}, "diameter": 4.0, "form": "sweep"}
    y = np.arange(65.0)
    height = np.abs(y - 32) / 32 * 100
    lean = np.abs(np.cos(np.radians(azimuth)))  # of the way to the sun, that part leads south
    rim = np.where(y > 0, (100 - height) / np.maximum(y * 10, 1e-9), 0) * lean
    slope = (np.roll(height, 1) - height) / 10 * lean
    # Ways that leave the terrain by its side see no rim.
    seen = (y >= 8) & (y * np.abs(np.tan(np.radians(azimuth))) < 27)
    for elevation in (3.0, 6.0, 9.0, 12.0, 15.0):
        result = any_engine.read(lit(SHAPES, "sun_disc", (azimuth, elevation), **values), "light.horizon")
        # What lies above or below the disc is not looked for.
        ends = np.tan(np.radians([elevation - 2, elevation + 2]))
        expected = np.clip(np.maximum(rim, slope), *ends)[seen]
        middle = np.clip(result[:, 30:35], *ends)[seen]
        assert len(set(expected)) > 5 or elevation > 12 or azimuth == 140
        np.testing.assert_allclose(middle, np.broadcast_to(expected[:, None], middle.shape), atol=0.004)


# Night


def test_night_is_the_widest_cone_with_a_gain_of_1(any_engine, lit):
    values = {"relief": 300.0, "extent": 640.0}
    night = any_engine.read(lit(HILLS, "night", (135, 25), **values), "light")
    cone = any_engine.read(lit(HILLS, "soft_cone", (135, 25), delta_r=1.5, gain=1.0, **values), "light")
    np.testing.assert_array_equal(night, cone)


LAMP = {
    "sun": (0, -10),
    "lamp_gain": 2.0,
    "max_distance": 200.0,
    "lamp_height": 100.0,
    "lamp_colour": (1.0, 0.5, 0.25),
}


@pytest.mark.parametrize("falloff", ["inverse square", "soft"])
def test_a_lamp_lights_flat_terrain_by_its_distance(any_engine, lit, falloff):
    values = {k: v for k, v in LAMP.items() if k != "sun"}
    sketch = lit(
        FLAT,
        "night",
        LAMP["sun"],
        size=[65, 33],
        extent=[640, 640],
        lamp=(0.25, 0.5),
        falloff=falloff,
        **values,
    )
    light = any_engine.read(sketch, "light")
    y, x = np.mgrid[0:33, 0:65] * np.array([20.0, 10.0])[:, None, None]
    far = np.sqrt((x - 160) ** 2 + (y - 320) ** 2 + 100**2)
    falls = (200 / far) ** 2 if falloff == "inverse square" else np.maximum(1 - (far / 200) ** 2, 0) ** 2
    received = 2 * 100 / far * falls
    np.testing.assert_allclose(light[..., 0], received, rtol=1e-3, atol=1e-4)
    np.testing.assert_allclose(light[..., 1:3], light[..., :1] * [0.5, 0.25], rtol=2e-3, atol=1e-4)


@pytest.mark.parametrize("radius", [0.0, 20.0])
def test_a_wall_throws_the_lamp_s_shadow(any_engine, lit, radius):
    """The lamp stands at 100 m, 160 m west of a wall of 50 m: behind it 160 m are dark."""
    values = {k: v for k, v in LAMP.items() if k != "sun"}
    sketch = lit(
        SHAPES, "night", LAMP["sun"], size=[65, 33], extent=[640, 320], relief=50.0, lamp=(0.25, 0.5),
        lamp_radius=radius, given={"which": "wall"}, **values,
    )  # fmt: skip
    row = any_engine.read(sketch, "light")[16, :, 0]
    behind = (np.arange(65) - 32) * 10.0
    dark = (behind > 15) & (behind < (155 if radius == 0 else 110))
    np.testing.assert_array_equal(row[dark], 0)
    assert row[(behind > (165 if radius == 0 else 250))].min() > 0 and row[behind < -15].min() > 0
    # A large lamp is seen in part from where its middle is behind the crest.
    assert (row[(behind > 130) & (behind < 155)].max() > 0) == (radius > 0)


def test_the_lamp_s_shadows_are_those_of_a_slow_march(any_engine, lit):
    values = {k: v for k, v in LAMP.items() if k != "sun"}
    sketch = lit(
        HILLS, "night", LAMP["sun"], relief=300.0, extent=640.0, lamp=(0.5, 0.25), lamp_radius=0.0, **values
    )
    heights = heights_of(any_engine, sketch)
    light = any_engine.read(sketch, "light")[..., 0]
    y, x = np.mgrid[0:65, 0:65].astype(np.float64)
    stand = np.array([32.0, 16.0, heights[16, 32] + 100])
    clear = np.full(x.shape, np.inf)
    steps = np.maximum(np.abs(stand[0] - x), np.abs(stand[1] - y))
    for k in range(1, 65):
        share = np.minimum(k / np.maximum(steps, 1e-9), 1.0)
        terrain = map_coordinates(heights, [y + share * (stand[1] - y), x + share * (stand[0] - x)], order=1)
        over = heights + share * (stand[2] - heights) - terrain
        clear = np.where(k < steps - 1e-6, np.minimum(clear, over), clear)
    north, east = np.gradient(heights, 10.0)
    way = np.stack([(stand[0] - x) * 10, (stand[1] - y) * 10, stand[2] - heights], axis=-1)
    facing = way[..., 2] - east * way[..., 0] - north * way[..., 1]
    sure = (np.abs(clear) > 0.01) & (np.abs(facing) > 0.1)
    expected = (clear > 0) & (facing > 0)
    assert sure.mean() > 0.9 and 0.1 < expected.mean() < 0.9
    np.testing.assert_array_equal(light[sure] > 0, expected[sure])


def test_lamp_on_ground_or_one_texel_terrain_gives_finite_light(any_engine, lit):
    for size in ([1, 1], [2, 2], [1, 20], [33, 33]):
        for height in (0.0, 40.0):
            values = {"lamp_gain": 8.0, "lamp": (0.5, 0.5), "lamp_height": height, "lamp_radius": 0.0}
            light = any_engine.read(lit(HILLS, "night", (30, 20), size=size, **values), "light")
            assert np.isfinite(light).all() and light.min() >= 0
