"""Slopes by differences, what is made of slopes, and how far they are from the noise's own."""

from __future__ import annotations

import numpy as np
import pytest

from playground.shader.colours import linear_to_srgb

HEIGHT = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) {{ return {}; }}\n'
SLOPE = '#pragma kernel(output = "slope:rg32f")\nvec2 kernel(ivec2 texel) {{ return {}; }}\n'
EAST, NORTH = "float(texel.x) / float(size.x - 1)", "float(texel.y) / float(size.y - 1)"
EXTENT = [900.0, 300.0]


@pytest.fixture
def read(any_engine, make_sketch):
    """Give the last pass's texture, float64; each pass a line of TOML."""

    def of(*passes, name="out", **sketch):
        files = {key: sketch.pop(key) for key in ("ground", "bank", "level") if key in sketch}
        text = "".join(f"[[pass]]\n{pass_}\n" for pass_ in passes)
        return any_engine.read(make_sketch(text, **files, **sketch), name).astype(np.float64)

    return of


def by_differences(read, height, more="", **sketch):
    value = {"size": [31, 13], "extent": EXTENT} | sketch
    return read(
        'name = "height"\nuse = "./ground"',
        f'name = "out"\nuse = "terrain/slope"\n{more}',
        ground=HEIGHT.format(height),
        **value,
    )


@pytest.mark.parametrize("way", ["both sides", "one side"])
@pytest.mark.parametrize("apart", [1, 3])
def test_a_plane_has_its_slope_everywhere_whatever_the_spacing(read, way, apart):
    """Texels are 30 m apart to the east and 25 m to the north; borders included."""
    result = by_differences(
        read, f"2.0 * {EAST} - 0.5 * {NORTH}", f'set = {{ sides = "{way}", apart = {apart} }}'
    )
    np.testing.assert_allclose(result[..., 0], 2.0 / 900, rtol=2e-5)
    np.testing.assert_allclose(result[..., 1], -0.5 / 300, rtol=2e-5)


@pytest.mark.parametrize("apart", [1, 4])
def test_parabola_slopes_are_exact_two_sided_and_lag_one_sided(read, apart):
    x, inside = np.arange(31) * 30.0, np.s_[:, apart:-apart]
    slope = 2 * x / 900**2
    for way, late in (("both sides", 0.0), ("one side", apart * 30.0 / 2)):
        text = f'set = {{ sides = "{way}", apart = {apart} }}'
        result = by_differences(read, f"{EAST} * {EAST}", text)[..., 0]
        expected = np.broadcast_to(slope + 2 * late / 900**2, result.shape)
        np.testing.assert_allclose(result[inside], expected[inside], atol=2e-8)
        # At the border only one side is there: half of what is read is half a step off.
        assert abs(result[:, 0] - slope[0]).min() > 0.9 * apart * 30.0 / 900**2


def test_resized_texture_takes_slopes_of_nearest_texels(read):
    small = by_differences(read, f"{EAST} * {NORTH}")
    large = by_differences(read, f"{EAST} * {NORTH}", "size = [61, 25]")
    np.testing.assert_allclose(large[::2, ::2], small, rtol=1e-6)


def test_slope_error_is_second_order_two_sided_first_one_sided(read):
    """Second and first order, of smooth noise; measured inside, where both sides are there."""
    octaves = "set = { octaves = 2, frequency = 3.0 }"
    for way, order in (("both sides", 2), ("one side", 1)):
        errors = []
        for side in (65, 129, 257):
            angle = read(
                f'name = "height"\nuse = "generation/gradient_noise/sum"\n{octaves}',
                f'name = "exact"\nuse = "generation/gradient_noise/derivatives"\n{octaves}',
                f'name = "slope"\nuse = "terrain/slope"\nset = {{ sides = "{way}" }}',
                'name = "out"\nuse = "terrain/normal_angle"\ninputs = { other = "exact" }',
                size=side,
                extent=5000.0,
                relief=400.0,
            )
            errors.append(angle[side // 16 : -(side // 16), side // 16 : -(side // 16)].mean())
        halved = np.log2(np.array(errors[:-1]) / errors[1:])
        np.testing.assert_allclose(halved, order, atol=0.15)


SLOPES = [(0.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.3, 0.7)]


def of_slopes(read, use, first, other=None, relief=1.0):
    passes = ['name = "slope"\nuse = "./bank"']
    passes += ['name = "flat"\nuse = "./level"'] if other else []
    wired = 'inputs = { slope = "slope", other = "flat" }' if other else ""
    passes.append(f'name = "out"\nuse = "{use}"\n{wired}')
    files = {"bank": SLOPE.format(f"vec2({first[0]}, {first[1]})")}
    if other:
        files["level"] = SLOPE.format(f"vec2({other[0]}, {other[1]})")
    return read(*passes, size=3, extent=10.0, relief=relief, **files)


@pytest.mark.parametrize("first", SLOPES)
@pytest.mark.parametrize("other", [(0.0, 0.0), (0.3, 0.7001)])
def test_the_angle_between_normals(read, first, other):
    normals = [np.array([-a, -b, 1]) / np.sqrt(a * a + b * b + 1) for a, b in (first, other)]
    half = np.linalg.norm(normals[0] - normals[1]) / 2  # exact for small angles too
    expected = 2 * np.degrees(np.arcsin(half))
    np.testing.assert_allclose(of_slopes(read, "terrain/normal_angle", first, other), expected, rtol=2e-3)


def test_slopes_are_multiplied_by_the_relief(read):
    result = of_slopes(read, "terrain/normal_angle", (0.01, 0.0), (0.0, 0.0), relief=100.0)
    np.testing.assert_allclose(result, 45.0, rtol=1e-5)


@pytest.mark.parametrize("slope", SLOPES)
def test_a_normal_map_is_a_unit_vector_as_it_is_shown(read, slope):
    colour = of_slopes(read, "terrain/normal_map", slope)[1, 1, :3]
    expected = np.array([-slope[0], -slope[1], 1]) / np.sqrt(slope[0] ** 2 + slope[1] ** 2 + 1)
    np.testing.assert_allclose(2 * linear_to_srgb(colour) - 1, expected, atol=4e-3)


@pytest.mark.parametrize("slope", SLOPES)
def test_light_by_slope_is_the_cosine_to_the_sun(read, slope):
    """The sun in the north-west at 40 degrees, as the parameter's default has it; gain 2."""
    of_slope = of_slopes(read, "lighting/by_slope", slope)[1, 1, 0]
    azimuth, height = np.radians([315.0, 40.0])
    sun = [np.sin(azimuth) * np.cos(height), np.cos(azimuth) * np.cos(height), np.sin(height)]
    normal = np.array([-slope[0], -slope[1], 1]) / np.sqrt(slope[0] ** 2 + slope[1] ** 2 + 1)
    np.testing.assert_allclose(of_slope, 2 * max(normal @ sun, 0), atol=2e-3)


LINES = 'interval = 10, width = 2.0, line = "#000000"'


def lines_of(read, use, value, height, relief=100.0):
    passes = ['name = "height"\nuse = "./ground"', 'name = "slope"\nuse = "terrain/slope"']
    passes.append(f'name = "out"\nuse = "{use}"\nset = {{ {value} }}')
    shape = {"size": [201, 9], "extent": [2000.0, 80.0], "relief": relief}
    return 1 - read(*passes, ground=HEIGHT.format(height), **shape)[..., 0]


@pytest.mark.parametrize("height", [EAST, f"{EAST} * {EAST} + 0.03 * {NORTH}"])
def test_contour_lines_are_those_of_view_contours(read, height):
    """Both store half floats; the lines are ten texels apart and more, so they do not crowd."""
    mine = lines_of(read, "view/contours/simple", f'{LINES}, ground = "#ffffff"', height, relief=60.0)
    theirs = lines_of(read, "view/contours", f"{LINES}, every = 0, strength = 1.0", height, relief=60.0)
    np.testing.assert_allclose(mine[:, 2:-2], theirs[:, 2:-2], atol=2e-3)
    assert mine.max() > 0.9 and mine.min() < 0.1


def test_contour_width_in_height_metres_widens_on_gentle_slope(read):
    """A line of 2 m is covered for 2 m of height: 40 m of way where it rises 1 m in 20."""
    for relief, texels in ((100.0, 4.0), (50.0, 8.0)):
        text = f'{LINES}, ground = "#ffffff", measured = "metres of height"'
        line = lines_of(read, "view/contours/simple", text, EAST, relief=relief)[4]
        lines = relief / 10
        inside = line[round(100 / lines) : -round(100 / lines)]
        np.testing.assert_allclose(inside.sum() / (lines - 1), texels, rtol=0.05)
