"""Lowest, highest, and what is made of them, against NumPy."""

import numpy as np
import pytest

TERRAIN = """
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")
uniform float scale = 1.0;
uniform float base = 0.0;
uniform int hole = 0;
float kernel(ivec2 texel) {
    if (hole == 1 && texel.x == texel.y) return uintBitsToFloat(0x7fc00000u);
    return base + scale * random_signed(texel, 3u);
}
"""
PASSES = """
[[pass]]
name = "terrain"
use = "./terrain"
set = {{ scale = {scale}, base = {base}, hole = {hole} }}
[[pass]]
name = "range"
use = "terrain/range"
inputs = {{ height = "terrain" }}
[[pass]]
name = "normal"
use = "generation/normalise"
inputs = {{ height = "terrain" }}
set = {{ mode = "{mode}" }}
"""


@pytest.fixture
def sketch_of(make_sketch):
    def make(size=33, scale=1.0, base=0.0, mode="minmax", hole=0):
        passes = PASSES.format(scale=scale, base=base, mode=mode, hole=hole)
        return make_sketch(passes, size=size, terrain=TERRAIN)

    return make


SIZES = [[1, 1], [2, 2], [1, 40], [31, 33], [32, 32], [100, 7], [257, 300], [1025, 1025]]


@pytest.mark.parametrize("size", SIZES, ids=str)
def test_the_range_is_numpys(engine, sketch_of, size):
    sketch = sketch_of(size, scale=3.0, base=-0.7)
    terrain = engine.read(sketch, "terrain")
    np.testing.assert_array_equal(engine.read(sketch, "range"), [[[terrain.min(), terrain.max()]]])


def test_one_extreme_texel_is_found_wherever_it_is(engine, make_sketch):
    spike = """
    #pragma kernel(output = "height:r32f")
    uniform ivec2 where = ivec2(0);
    float kernel(ivec2 texel) { return texel == where ? 9.0 : texel == size - 1 - where ? -9.0 : 0.0; }
    """
    passes = '[[pass]]\nname = "height"\nuse = "./spike"\n[[pass]]\nname = "range"\nuse = "terrain/range"\n'
    sketch = make_sketch(passes, size=[545, 530], spike=spike)
    every_row_of_two_blocks = [(k, k + 3) for k in range(36)]
    for where in [(0, 0), (544, 0), (0, 529), (544, 529), *every_row_of_two_blocks]:
        result = engine.read(sketch.with_values({"height.where": where}), "range")
        np.testing.assert_array_equal(result, [[[-9.0, 9.0]]])


@pytest.mark.parametrize("size", SIZES[2:], ids=str)
@pytest.mark.parametrize(("scale", "base"), [(0.01, 0.0), (300.0, 1000.0)])
def test_minmax_spans_0_to_1(engine, sketch_of, size, scale, base):
    sketch = sketch_of(size, scale, base)
    terrain = engine.read(sketch, "terrain").astype(np.float64)
    result = engine.read(sketch, "normal")
    assert result.min() == 0.0 and result.max() == 1.0
    np.testing.assert_allclose(result, np.interp(terrain, [terrain.min(), terrain.max()], [0, 1]), atol=1e-6)


def test_max_puts_the_highest_at_1_and_leaves_0(engine, sketch_of):
    sketch = sketch_of(mode="max", scale=2.0)
    terrain = engine.read(sketch, "terrain").astype(np.float64)
    np.testing.assert_allclose(engine.read(sketch, "normal"), terrain / terrain.max(), rtol=1e-6, atol=1e-9)


def test_none_changes_no_bit_and_looks_at_nothing(engine, sketch_of):
    sketch = sketch_of(mode="none", scale=2.0)
    np.testing.assert_array_equal(engine.read(sketch, "normal"), engine.read(sketch, "terrain"))
    np.testing.assert_array_equal(engine.read(sketch, "normal.range"), [[[0.0, 1.0]]])


@pytest.mark.parametrize(
    ("mode", "base", "expected"),
    [
        ("minmax", 0.3, 0),
        ("minmax", 0, 0),
        ("minmax", -5, 0),
        ("max", 0.3, 1),
        ("max", 0, 0),
        ("max", -5, -5),
    ],
)
def test_flat_terrain_is_a_number(engine, sketch_of, mode, base, expected):
    result = engine.read(sketch_of(scale=0.0, base=float(base), mode=mode), "normal")
    np.testing.assert_array_equal(result, np.float32(expected))


@pytest.mark.parametrize("base", [0.3, -700.0, 4e6])
def test_flat_terrain_with_roundings_is_flat(engine, sketch_of, base):
    """A step or two of a float is no terrain; 32 additions may leave sixteen."""
    terrain = engine.read(sketch_of(scale=abs(base) * 3e-7, base=base), "terrain")
    assert 0 < np.ptp(terrain) < 16 * np.finfo(np.float32).eps * abs(base)
    result = engine.read(sketch_of(scale=abs(base) * 3e-7, base=base), "normal")
    np.testing.assert_array_equal(result, 0)


@pytest.mark.parametrize("base", [0.3, -700.0, 4e6])
def test_terrain_over_its_roundings_is_stretched(engine, sketch_of, base):
    result = engine.read(sketch_of(scale=abs(base) * 1e-5, base=base), "normal")
    assert result.min() == 0.0 and result.max() == 1.0


def test_terrain_below_0_is_not_turned_over_by_max(engine, sketch_of):
    sketch = sketch_of(mode="max", base=-3.0)
    np.testing.assert_array_equal(engine.read(sketch, "normal"), engine.read(sketch, "terrain"))


def test_a_texel_without_a_number_spoils_no_other(engine, sketch_of):
    sketch = sketch_of(hole=1)
    terrain = engine.read(sketch, "terrain")
    holes = np.isnan(terrain)
    assert holes.any()
    np.testing.assert_array_equal(engine.read(sketch, "range"), [[[np.nanmin(terrain), np.nanmax(terrain)]]])
    assert not np.isnan(engine.read(sketch, "normal")[~holes]).any()


def test_moving_a_terrain_and_stretching_it_changes_nothing(engine, sketch_of):
    first = engine.read(sketch_of(scale=1.0, base=0.0), "normal")
    second = engine.read(sketch_of(scale=8.0, base=5.0), "normal")
    np.testing.assert_allclose(first, second, atol=1e-6)
