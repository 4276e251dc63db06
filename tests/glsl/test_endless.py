"""An endless terrain, part by part: against a twin in float64, at its borders, and under its own shadows."""

from itertools import product

import numpy as np
import pytest

from playground.engine.engine import Engine

from ..loading import load
from ..sketch_texts import passes, use
from ..truth.noise import bits, fade, gradient, lattice_seed, python_random, salt

PASSES = passes(
    height="generation/endless",
    colour="texturing/endless_ground",
    light=use("lighting/soft_cone", gain=1.0, ambient=0.2),
)
SPACING = 24.0


@pytest.fixture
def part_of(make_sketch):
    """Give the sketch of a part of so many intervals, with so wide an apron."""

    def make(part, intervals=32, apron=8, **values):
        size = intervals + 2 * apron + 1
        sketch = make_sketch(PASSES, size=size, extent=SPACING * (size - 1), relief=2400.0)
        value = {}
        for name in ("height", "colour"):
            value |= {f"{name}.part": part, f"{name}.apron": apron}
        return sketch.with_values(value | values)

    return make


def inside(values, apron):
    return values[apron : values.shape[0] - apron, apron : values.shape[1] - apron]


# ── the truth ────────────────────────────────────────────────────────────────


def blended(x, y, plane):
    """Blend planes over the four lattice points around a place, given in exact fractions (cell, share)."""
    (cx, dx), (cy, dy) = x, y
    total = 0.0
    for i, j in product((0, 1), repeat=2):
        weight = fade(1 - abs(dx - i)) * fade(1 - abs(dy - j))
        gx, gy = plane(cx + i, cy + j)
        total += weight * (gx * (dx - i) + gy * (dy - j))
    return total


def shape_twin(node, hills=256, layers=3, persistence=0.4, seed=7):
    total = strengths = 0.0
    for k in range(layers):
        wide = max(hills // 2**k, 2)
        moved = (node[0] + k * (wide * 5 // 8), node[1] + k * (wide * 3 // 8))
        x, y = ((n // wide, n % wide / wide) for n in moved)
        which = lattice_seed(seed + salt("generation/endless/shape"), k)
        total += persistence**k * 1.513 * blended(x, y, lambda a, b, s=which: gradient(bits(a, b, s)))
        strengths += persistence**k
    return min(max(0.5 + 0.75 * total / strengths, 0.0), 1.0)


def detail_twin(node, side=384, frequency=6, octaves=6, gain=0.45, seed=7):
    total = strengths = 0.0
    for k in range(octaves):
        period = frequency * 2**k
        x, y = (n % side / side * period + k * shift for n, shift in zip(node, (0.618, 0.382), strict=True))
        x, y = ((int(np.floor(p)), p - np.floor(p)) for p in (x, y))
        key = seed + salt("generation/endless/detail") + 101 * k

        def plane(a, b, p=period, key=key):
            return [2 * python_random(a % p, b % p, key, part) - 1 for part in (0, 1)]

        noise = blended(x, y, plane)
        total += gain**k * (1 - abs(noise)) ** 2
        strengths += gain**k
    return total / strengths


def height_twin(node, rough=0.45, valleys=0.15, peaks=0.7):
    low = shape_twin(node)
    bent = (1 - peaks) * low + peaks * low**2
    return (1 - rough) * bent + rough * (valleys + (1 - valleys) * bent) * detail_twin(node)


# ── the terrain ─────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("part", [(0, 0), (5, -3), (-120_000, 70_001)])
def test_a_part_is_its_shape_and_the_detail_of_each_node(engine, part_of, part):
    result = engine.read(part_of(part), "height")
    for x, y in np.random.default_rng(5).integers(0, result.shape[0], (40, 2)):
        node = (part[0] * 32 + int(x) - 8, part[1] * 32 + int(y) - 8)
        assert result[y, x] == pytest.approx(height_twin(node), abs=2e-5)


@pytest.mark.parametrize("wide", [1, 3, 64, 1000])
def test_nodes_are_counted_over_all_parts(on_gpu, wide):
    nodes = np.random.default_rng(1).integers(-(2**24), 2**24, (300, 2)).astype(np.int32)
    cells = on_gpu("terrain/parts.glsl", f"node_of(n, ivec2(2, -3), 4, ivec2({wide + 9}))", n=nodes)
    np.testing.assert_array_equal(cells, nodes + np.array([2, -3]) * wide - 4)


def test_neighbours_agree_to_the_last_bit_wherever_they_overlap(engine, part_of):
    def read(part, ref):
        return engine.read(part_of(part), ref)

    for ref in ("height", "colour"):
        here, east, north = read((3, -2), ref), read((4, -2), ref), read((3, -1), ref)
        reach = 0 if ref == "height" else 1  # a slope at a texture's own edge is one-sided
        cut = slice(reach, here.shape[0] - reach)
        np.testing.assert_array_equal(
            here[cut, 32 + reach : 49 - reach], east[cut, reach : 17 - reach], err_msg=ref
        )
        np.testing.assert_array_equal(
            here[32 + reach : 49 - reach, cut], north[reach : 17 - reach, cut], err_msg=ref
        )
        assert not np.array_equal(here, east)


def test_a_part_does_not_depend_on_the_way_there(ctx, part_of):
    with Engine(ctx) as left, Engine(ctx) as other:
        for part in ((0, 0), (1, 0), (2, 0), (7, 7)):
            left.read(part_of(part), "light")
        first = {ref: left.read(part_of((7, 7)), ref) for ref in ("height", "colour", "light")}
        left.cache.clear()
        for ref, values in first.items():
            np.testing.assert_array_equal(left.read(part_of((7, 7)), ref), values)
            np.testing.assert_array_equal(other.read(part_of((7, 7)), ref), values)


def test_the_detail_is_made_once_for_all_parts(any_engine, part_of):
    for x in range(6):
        any_engine.texture(part_of((x, 1)), "height")
    assert any_engine.runs["height.detail"] == 1
    assert any_engine.runs["height.shape"] == any_engine.runs["height.height"] == 6


def test_the_detail_fits_next_to_its_copy(any_engine, part_of):
    """Its step from the last texel to the first is like any other; the terrain far away has the same one."""
    tile = any_engine.read(part_of((0, 0)), "height.detail").astype(float)
    for values in (tile, tile.T):
        inner = np.abs(np.diff(values, axis=0)).mean()
        assert np.abs(values[0] - values[-1]).mean() < 1.5 * inner
    there = any_engine.read(part_of((12, 0), **{"height.rough": 1.0, "height.valleys": 1.0}), "height")
    here = any_engine.read(part_of((0, 0), **{"height.rough": 1.0, "height.valleys": 1.0}), "height")
    np.testing.assert_array_equal(there, here)  # 12 parts of 32 are the 384 texels of the tile


def test_part_light_matches_large_terrain_if_shadows_fit_apron(any_engine, part_of):
    """Sun 40 degrees up: a shadow of the apron's 40 texels, 960 m, needs 805 m of mountain."""
    sun = {"light.sun": (120.0, 40.0)}
    small = inside(any_engine.read(part_of((3, 1), 64, 40, **sun), "light"), 40)
    large = inside(any_engine.read(part_of((3, 1), 64, 168, **sun), "light"), 168)
    assert (large[..., 3] < 1).mean() > 0.02, "there are shadows"
    np.testing.assert_allclose(small, large, atol=2e-3)

    low = {"light.sun": (120.0, 16.0)}
    small = inside(any_engine.read(part_of((2, 5), 64, 8, **low), "light"), 8)
    large = inside(any_engine.read(part_of((2, 5), 64, 168, **low), "light"), 168)
    assert np.abs(small - large).max() > 0.1, "with the sun low, shadows come from beyond the apron"
    assert (small >= large - 2e-3).all(), "they are missed, and none is made up"


@pytest.mark.parametrize("elevation", [25.0, 9.0, 4.0])
def test_reach_within_apron_gives_equal_light_from_any_part(any_engine, part_of, elevation):
    """Every texel then sees as far, whichever part it is lit with: no border shows."""
    value = {"light.sun": (120.0, elevation), "light.max_distance": 24}
    small = inside(any_engine.read(part_of((2, 5), 64, 24, **value), "light"), 24)
    large = inside(any_engine.read(part_of((2, 5), 64, 152, **value), "light"), 152)
    assert 0.02 < (large[..., 3] < 0.99).mean(), "there are shadows"
    np.testing.assert_allclose(small, large, atol=3e-3)
    endless = any_engine.read(part_of((2, 5), 64, 152, **{**value, "light.max_distance": 0}), "light")
    assert (inside(endless, 152) <= large + 3e-3).all(), "a reach only takes shadows away"


def test_heights_stay_within_0_and_1_and_use_most_of_it(any_engine, part_of):
    terrain = any_engine.read(part_of((1, 0), 512, 0, **{"height.hills": 128}), "height")
    assert 0.0 <= terrain.min() < 0.12 and 0.6 < terrain.max() <= 1.0
    hardest = {"height.rough": 1.0, "height.valleys": 1.0, "height.gain": 1.0, "height.layers": 8}
    terrain = any_engine.read(part_of((1, 0), 64, 0, **hardest), "height")
    assert np.isfinite(terrain).all() and terrain.min() >= 0.0 and terrain.max() <= 1.0


@pytest.mark.parametrize("size", [2, 3, 9])
def test_tiny_parts_are_numbers(any_engine, part_of, size):
    result = any_engine.read(
        part_of((3, 3), size - 1, 0, **{"height.hills": 2, "colour.patches": 4}), "light"
    )
    assert np.isfinite(result).all()
    wide = part_of((3, 3), 4, 0, **{"height.apron": 500})  # more apron than texture
    assert np.isfinite(any_engine.read(wide, "height")).all()


# ── the ground ───────────────────────────────────────────────────────────────


def test_weights_of_the_ground_sum_to_1(any_engine, part_of):
    """White materials give white ground, whatever their weights, and the shown weights are theirs."""
    ones = {f"colour.{name}": (1.0, 1.0, 1.0) for name in ("meadow", "wood", "rock", "sand", "snow")}
    white = any_engine.read(part_of((4, 4), 128, 0, **ones, **{"colour.contrast": 0.0}), "colour")
    np.testing.assert_allclose(white, 1.0, atol=1e-3)
    weights = any_engine.read(
        part_of((4, 4), 256, 0, **{"colour.shown": "weights", "colour.wood_below": 900.0}), "colour"
    )[..., :3]
    assert weights.min() >= 0 and weights.sum(axis=-1).max() <= 1.002
    assert (weights.max(axis=(0, 1)) > 0.5).all(), "rock, wood and snow are all there"


def test_the_ground_follows_height_and_slope(any_engine, part_of):
    value = {"colour.shown": "weights", "colour.ragged": 0.0}
    sketch = part_of((4, 8), 256, 0, **value)
    height = any_engine.read(sketch, "height") * 2400.0
    rock, wood, snow, _ = np.moveaxis(any_engine.read(sketch, "colour"), -1, 0)
    slope = np.degrees(np.arctan(np.hypot(*np.gradient(height, SPACING))))
    assert snow[height < 750].max() == 0 and snow[(height > 1250) & (slope < 30)].min() > 0.9
    assert rock[(slope > 50) & (height < 700)].mean() > 0.9
    assert wood[height > 720].max() == 0


# ── figure 5.15 ──────────────────────────────────────────────────────────────


def test_the_principle_s_picture_lights_the_middle_part_alone(any_engine):
    """Grey all around, coloured in the middle third; the same heights under both."""
    picture = any_engine.read(load("flight_principle"), "diagram")[..., :3]
    spread = picture.max(axis=-1) - picture.min(axis=-1)
    right = spread[38:338, 306:606]
    parts = right.reshape(3, 100, 3, 100)[:, 8:92, :, 8:92].mean(axis=(1, 3))
    middle = parts[1, 1]
    parts[1, 1] = 0.0
    assert middle > 0.05 and parts.max() < 0.02
    marked = (picture[..., 0] > 3 * picture[..., 2]) & (picture[..., 0] > 0.5)
    assert marked[138, 410:500].mean() > 0.9 and marked[38, 310:600].mean() > 0.9
