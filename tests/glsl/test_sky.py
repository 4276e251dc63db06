"""The sky over horizons: sectors against quadrature, closed forms, the exact K, patches, ground.

``factor`` and ``light`` are rgba16f: comparisons allow what a half float cuts off, 2^-10.
"""

import numpy as np
import pytest
from scipy.integrate import dblquad

from ..loading import load
from ..truth.land import Land, cone, real
from ..truth.sky import sky_visibility
from .terrains import lit_by

HALF = 2.0**-10
OPEN_SKY = "lighting/horizons/open_sky.glsl"


@pytest.fixture
def read(ctx, kept, tmp_path):
    """Give ``read(terrain, use, *outputs, **values)``: the outputs of a technique in lighting/, float64."""

    def make(terrain, use, *outputs, passes="", size=None, **values):
        sketch = lit_by(tmp_path, terrain, "under_test", use, passes=passes, size=size, **values)
        result = [kept.read(sketch, f"under_test:{output}").astype(np.float64) for output in outputs]
        assert all(np.isfinite(f).all() for f in result)
        return result[0] if len(result) == 1 else result

    return make


def colour_pass(folder, text, name="colour"):
    (folder / f"{name}_of.glsl").write_text(f'#pragma kernel(output = "{name}:rgba16f")\n{text}')
    return f'[[pass]]\nname = "{name}"\nuse = "./{name}_of"\n'


def plane(angle, towards=90.0, n=33, spacing=(20.0, 20.0)):
    """Rise at an angle [degrees] towards an azimuth."""
    y, x = np.mgrid[0:n, 0:n] * np.array(spacing[::-1])[:, None, None]
    a = np.radians(towards)
    return Land((x * np.sin(a) + y * np.cos(a)) * np.tan(np.radians(angle)), spacing, f"plane {angle}")


def rms(values):
    return float(np.sqrt((values**2).mean()))


# A sector


@pytest.mark.parametrize("sectors", [8, 16])
@pytest.mark.parametrize("azimuth", [0.0, 45.0, 200.0])
@pytest.mark.parametrize("slope", [(0.0, 0.0), (0.4, -0.2), (-0.5, 0.9)], ids=str)
def test_a_sector_is_the_integral_over_it(on_gpu, sectors, azimuth, slope):
    """1/pi of N·v over the sector's open part, times n and the length of (-slope, 1)."""
    towards = (np.float32(np.sin(np.radians(azimuth))), np.float32(np.cos(np.radians(azimuth))))
    tangents = np.array([0.0, 0.3, 1.0, 4.0, 30.0], np.float32)
    call = f"sky_of_sector(tangent, slope, towards, sector_shape({sectors}))"
    result = on_gpu(OPEN_SKY, call, tangent=tangents, slope=tuple(np.float32(slope)), towards=towards)
    half = np.pi / sectors
    for tangent, value in zip(tangents, result, strict=True):
        own = slope[0] * towards[0] + slope[1] * towards[1]
        lowest = np.arctan(max(tangent, own, 0.0))

        def lit(e, a):
            across = slope[0] * np.sin(a) + slope[1] * np.cos(a)
            return (np.sin(e) - across * np.cos(e)) * np.cos(e)

        truth = dblquad(lit, np.radians(azimuth) - half, np.radians(azimuth) + half, lowest, np.pi / 2)[0]
        assert value == pytest.approx(truth * sectors / np.pi, abs=2e-5)


@pytest.mark.parametrize("slope", [(0.0, 0.0), (0.4, -0.2), (-3.0, 8.0)], ids=str)
def test_two_opposite_sectors_are_the_sum_of_both(on_gpu, slope):
    """By each sector's own angle from the vertical, in float64; level, steep and over a wall.

    Mesa's arc tangent, a polynomial, is off by 3.26e-6 at most, and counts as often as the slope rises.
    """
    azimuth = np.radians(25.0)
    towards = np.array([np.sin(azimuth), np.cos(azimuth)])
    heights = [0.0, 1e-4, 0.3, 1.0, 30.0, 6e4]
    tangents = np.array([(there, back) for there in heights for back in heights], np.float32)
    call = "sky_of_sectors(tangents, slope, towards, sector_shape(16))"
    result = on_gpu(
        OPEN_SKY, call, tangents=tangents, slope=tuple(np.float32(slope)), towards=tuple(np.float32(towards))
    )
    width = np.pi / 16
    truth = np.zeros(len(tangents))
    for tangent, sense in zip(tangents.T.astype(np.float64), (1, -1), strict=True):
        rise = sense * (np.array(slope) @ towards)
        open_sky = np.pi / 2 - np.arctan(np.maximum(np.maximum(tangent, rise), 0.0))
        within = open_sky - np.sin(2 * open_sky) / 2
        truth += np.sin(open_sky) ** 2 - rise * np.sin(width) / width * within
    steep = abs(np.array(slope) @ towards)
    np.testing.assert_allclose(result, truth, rtol=4 * 2.0**-24, atol=2e-6 + 3.3e-6 * steep)


def test_the_total_k_is_below_each_patch(on_gpu):
    """K = 0.1, 0.3, 0.2 and ground of 0.5: 0.75 in all; with each patch's own K below, 0.977."""
    k = np.array([0.1, 0.3, 0.2], np.float32)
    more = on_gpu(OPEN_SKY, "thrown_back(vec3(0.5), k).x", k=np.float32(k.sum()))
    assert (k * more).sum() == pytest.approx(0.75, abs=1e-6)
    alone = on_gpu(OPEN_SKY, "thrown_back(vec3(0.5), k).x", k=k)
    assert (k * alone).sum() == pytest.approx(0.977, abs=1e-3)
    assert np.isfinite(on_gpu(OPEN_SKY, "thrown_back(vec3(1.0), k).x", k=np.float32(0.0)))


@pytest.mark.parametrize("first", [0.0, 30.0])
def test_the_table_is_the_sectors_integrals(ctx, kept, tmp_path, first):
    (tmp_path / "s.toml").write_text(
        'format = 1\nsize = 9\n[[pass]]\nname = "table"\nuse = "lighting/horizon_sky/table"\n'
        f"size = [256, 8]\nset = {{ first = {first} }}\n"
    )
    table = kept.read(load(tmp_path / "s.toml"), "table").astype(np.float64)
    assert table.shape == (8, 256, 4)
    for position in (0, 17, 128, 254, 255):
        low = np.pi / 2 if position == 255 else np.arctan(position / 255 / (1 - position / 255))
        for row in range(8):
            a = np.radians(first - 45 * row)
            steps = np.radians(np.linspace(-22.5, 22.5, 4001)[:-1] + 22.5 / 4000) + a
            level = (np.pi / 2 - low) / 2 - np.sin(2 * low) / 4  # cos² e from the horizon up
            truth = [
                np.sin(steps).mean() * level / 4,
                np.cos(steps).mean() * level / 4,
                np.cos(low) ** 2 / 8,
            ]
            np.testing.assert_allclose(table[row, position, :3], truth, atol=2e-6)


# Closed forms


@pytest.mark.parametrize("angle", [20.0, 45.0])
def test_a_plane_with_many_sectors(read, angle):
    k = read(plane(angle, 33.0), "horizon_sky", "k", summed="over all directions", directions=64)
    truth = (1 + np.cos(np.radians(angle))) / 2
    np.testing.assert_allclose(k, truth, atol=0.01)
    # Where sight lines leave the terrain at its edge, nearby lines may see a little more.
    np.testing.assert_allclose(k[8:-8, 8:-8], truth, atol=3e-4)


@pytest.mark.parametrize("spacing", [(10.0, 10.0), (7.0, 20.0)], ids=str)
@pytest.mark.parametrize(("angle", "bound"), [(20.0, 0.01), (40.0, 0.01)])
def test_a_valley_without_end(read, angle, bound, spacing):
    """Slope a, the opposite rim at elevation e: (1 + cos(a + e)) / 2."""
    nx, ny = 41, 641
    x = np.abs(np.arange(nx) - 20.0) * spacing[0]
    terrain = Land(np.tile(x * np.tan(np.radians(angle)), (ny, 1)), spacing)
    k = read(terrain, "horizon_sky", "k", summed="over all directions", directions=64)[ny // 2]
    rim = 20 * spacing[0]
    position = np.arange(nx)[3:17]  # on the western wall
    here = (20 - position) * spacing[0]
    elevation = np.arctan2((rim - here) * np.tan(np.radians(angle)), here + rim)
    truth = (1 + np.cos(np.radians(angle) + elevation)) / 2
    np.testing.assert_allclose(k[3:17], truth, atol=bound)


# The exact K


@pytest.mark.slow
@pytest.mark.parametrize("make", [real, cone], ids=["real", "cone"])
def test_k_is_close_to_the_exact_one(read, make):
    terrain = make(49)
    exact = sky_visibility(terrain, count=64)
    for values, mean in (
        ({"summed": "by the table"}, 0.005),
        ({"summed": "by the formula"}, 0.005),
        ({"summed": "over all directions", "directions": 16}, 0.0025),
        ({"summed": "over all directions", "directions": 64}, 0.0025),
    ):
        error = read(terrain, "horizon_sky", "k", **values) - exact
        assert rms(error) < mean and abs(error.mean()) < 0.002, values


@pytest.mark.slow
@pytest.mark.parametrize(("steepness", "excess"), [(1, 0.014), (3, 0.076)])
def test_the_sky_is_too_bright_at_the_edge(read, steepness, excess):
    """By as much as header and lesson say: a piece of a wider DEM, against the exact K of all of it."""
    wide = Land(real(193).heights * steepness, real(193).spacing)
    piece = slice(64, 129)
    k = read(
        Land(wide.heights[piece, piece], wide.spacing),
        "horizon_sky",
        "k",
        summed="over all directions",
        directions=64,
    )
    over = k - sky_visibility(wide, count=32)[piece, piece]
    from_edge = np.minimum(np.arange(65), np.arange(65)[::-1])
    ring = np.minimum.outer(from_edge, from_edge)
    assert over[ring == 0].mean() == pytest.approx(excess, rel=0.15)
    assert 0 < over[ring == 16].mean() < 0.15 * excess
    assert over.max() < 0.12 * steepness


def test_the_table_and_the_formula_agree(read):
    terrain = Land(real(49).heights * 3, (74.0, 93.0))
    table, formula, measured = (
        read(terrain, "horizon_sky", "k", summed=way)
        for way in ("by the table", "by the formula", "over all directions")
    )
    np.testing.assert_allclose(table, formula, atol=2e-4)
    np.testing.assert_allclose(measured, formula, atol=2e-3)
    assert formula.min() < 0.8


# Ground


def test_f_is_k_with_the_ground_below(read):
    terrain = Land(real(33).heights * 4, (74.0, 93.0))
    k, factor = read(terrain, "horizon_sky", "k", "factor", ground=[0.2, 0.5, 1.0])
    for channel, ground in enumerate((0.2, 0.5, 1.0)):
        np.testing.assert_allclose(factor[..., channel], k / (1 - ground * (1 - k)), rtol=2 * HALF)
    np.testing.assert_allclose(factor[..., 2], 1, rtol=2 * HALF)


def test_the_ground_is_the_mean_colour_under_a_texel(read, tmp_path):
    """Stripes finer than the light: it sees their mean, not one of them."""
    stripe = "(texel.x & 1) == 0 ? vec3(0.8, 0.2, 0.0) : vec3(0.0, 0.6, 0.0)"
    text = f"vec4 kernel(ivec2 texel) {{ return vec4({stripe}, 1.0); }}"
    passes = colour_pass(tmp_path, text) + 'size = ["8 * size.x", "8 * size.y"]\n'
    terrain = Land(real(33).heights * 4, (74.0, 93.0))
    k, factor = read(terrain, "horizon_sky", "k", "factor", passes=passes)
    for channel, ground in enumerate((0.4, 0.4, 0.0)):
        np.testing.assert_allclose(factor[..., channel], k / (1 - ground * (1 - k)), rtol=0.004)


def test_light_is_the_factor_in_the_skys_colour(read):
    terrain = real(33)
    light, factor = read(terrain, "horizon_sky", "light", "factor", sky_colour=[0.5, 1.0, 2.0], ambient=0.5)
    np.testing.assert_allclose(light[..., :3], factor[..., :3] * [0.25, 0.5, 1.0], rtol=2 * HALF, atol=1e-3)


# Patches


def sampled(terrain, tangents, split, patch):
    """Return K of one patch by small cells of the sky, each texel's sky cut off sector by sector."""
    east, north = terrain.slopes()
    total = np.zeros(terrain.heights.shape)
    azimuths = np.radians(np.arange(0.25, 360, 0.5))
    for a in azimuths:
        azimuth = np.degrees(a)
        sector = int(np.floor((-azimuth) / 45 + 0.5)) % 8
        centre = np.radians(-45 * sector)
        own = east * np.sin(centre) + north * np.cos(centre)
        low = np.arctan(np.maximum(np.maximum(tangents[..., sector], own), 0))
        quarter = int(np.floor(azimuth / 90 + 0.5)) % 4
        parting = np.radians(split)
        across = east * np.sin(a) + north * np.cos(a)

        def up_to(start, end, across=across):
            """Integrate (sin e - across cos e) cos e."""
            return (np.sin(end) ** 2 - np.sin(start) ** 2) / 2 - across * (
                (end - start) / 2 + (np.sin(2 * end) - np.sin(2 * start)) / 4
            )

        if patch == "overhead":
            total += up_to(np.maximum(low, parting), np.pi / 2)
        elif quarter == patch:
            total += np.where(low < parting, up_to(np.minimum(low, parting), parting), 0)
    return total * np.radians(0.5) / np.pi / np.sqrt(1 + east**2 + north**2)


def test_patches_are_the_parts_of_the_sky(read):
    terrain = Land(real(33).heights * 2, (74.0, 93.0))
    ahead, behind = read(terrain, "horizon_sky", "ahead", "behind")
    low, high = read(terrain, "sky_patches", "low", "high", split=35.0)
    tangents = np.concatenate([ahead, behind], axis=-1)
    for quarter in range(4):
        np.testing.assert_allclose(low[..., quarter], sampled(terrain, tangents, 35.0, quarter), atol=1.5e-3)
    np.testing.assert_allclose(high[..., 3], sampled(terrain, tangents, 35.0, "overhead"), atol=1.5e-3)


@pytest.mark.parametrize("split", [10.0, 45.0, 80.0])
def test_patches_add_up_to_the_sky(read, split):
    terrain = Land(real(33).heights * 2, (74.0, 93.0))
    low, high = read(terrain, "sky_patches", "low", "high", split=split, ground=[0.5, 0.5, 0.5])
    k, factor = read(terrain, "horizon_sky", "k", "factor", summed="by the formula", ground=[0.5, 0.5, 0.5])
    np.testing.assert_allclose(low.sum(axis=-1) + high[..., 3], k, atol=2e-3)
    white = [1.0, 1.0, 1.0]
    colours = dict.fromkeys(("overhead", "north", "east", "south", "west"), white)
    even = read(terrain, "sky_patches", "factor", split=split, ground=[0.5, 0.5, 0.5], **colours)
    np.testing.assert_allclose(even[..., :3], factor[..., :3], atol=3e-3)


# Interreflection


def test_shadows_of_a_local_method_are_not_black(read, tmp_path):
    terrain = Land(real(49).heights * 2, (74.0, 93.0))
    passes = '[[pass]]\nname = "light"\nuse = "lighting/ray_cast"\nset = { sun = [250.0, 15.0] }\n'
    values = {"ambient": 0.4, "sky_colour": [0.5, 1.0, 1.0], "ground": [0.3, 0.3, 0.3]}
    light, factor, k = read(terrain, "interreflection", "light", "factor", "k", passes=passes, **values)
    direct = read(terrain, "ray_cast", "light", sun=[250.0, 15.0])
    shadow = direct[..., 0] == 0
    assert shadow.mean() > 0.1 and light[shadow][:, 1].min() > 0.2
    sky = factor[..., :3] * [0.2, 0.4, 0.4]
    np.testing.assert_allclose(light[..., :3], direct[..., :3] + sky, rtol=2 * HALF, atol=1e-3)
    np.testing.assert_array_equal(light[..., 3], direct[..., 3])
    both = read(terrain, "interreflection", "light", passes=passes, both=True, **values)
    grown = direct[..., :3] / (1 - 0.3 * (1 - k[..., None])) + sky
    np.testing.assert_allclose(both[..., :3], grown, rtol=4 * HALF, atol=1e-3)


def test_another_sun_sums_no_sky_anew(ctx, kept, tmp_path):
    passes = '[[pass]]\nname = "light"\nuse = "lighting/l_dot_n"\n'
    sketch = lit_by(tmp_path, real(33), "under_test", "interreflection", passes=passes)
    kept.read(sketch, "under_test")
    kept.read(sketch.with_values({"light.sun": (100, 30), "under_test.ambient": 0.2}), "under_test")
    assert kept.record.ran == ["light", "under_test.add"]
