"""Drained areas equal serial counting, number by number: on terrains, and on the worst of trees."""

import numpy as np
import pytest

from ..sketch_texts import passes
from ..truth.drainage import counted, edge_of

# Spacings of 1 m: a cell is 1 m2, so that areas are whole numbers and equality is exact.
PASSES = passes(ways="./ways", drained=("water/accumulation", 'inputs = {{ receiver = "ways"{rain} }}'))
HEAD = """
#include "noise/hash.glsl"
#include "water/texels.glsl"
#pragma kernel(output = "receiver:r32f")
"""
# Row by row to and fro: one way through all texels.
SERPENTINE = """
float kernel(ivec2 texel) {
    bool east = texel.y % 2 == 0;
    if (texel.x != (east ? size.x - 1 : 0)) return number_of(texel + ivec2(east ? 1 : -1, 0), size);
    return texel.y == 0 ? number_of(texel, size) : number_of(texel - ivec2(0, 1), size);
}
"""
# Columns that drain into the southern row, which drains west.
COMB = """
float kernel(ivec2 texel) {
    if (texel.y > 0) return number_of(texel - ivec2(0, 1), size);
    return number_of(texel - ivec2(texel.x > 0 ? 1 : 0, 0), size);
}
"""
# Each texel to any of the three to the south: trees with all kinds of branches.
RANDOM = """
float kernel(ivec2 texel) {
    int aside = int(3.0 * random(texel, 3u)) - 1;
    ivec2 to = ivec2(clamp(texel.x + aside, 0, size.x - 1), texel.y - 1);
    return number_of(texel.y == 0 ? texel : to, size);
}
"""
# All eight neighbours drain to every third texel, and those drain west through the next.
STARS = """
float kernel(ivec2 texel) {
    ivec2 middle = min(3 * (texel / 3) + 1, size - 1);
    if (middle != texel) return number_of(texel + clamp(middle - texel, -1, 1), size);
    return number_of(texel, size);
}
"""
TREES = {"serpentine": SERPENTINE, "comb": COMB, "random": RANDOM, "stars": STARS}


def drained(engine, make_sketch, ways, size):
    sketch = make_sketch(
        PASSES.format(rain=""), size=list(size), extent=[size[0] - 1.0, size[1] - 1.0], ways=ways
    )
    return engine.read(sketch, "ways").copy(), engine.read(sketch, "drained").copy(), sketch


@pytest.mark.parametrize("tree", TREES)
@pytest.mark.parametrize("size", [(64, 64), (45, 130)], ids=str)
def test_equal_to_serial_counting(engine, make_sketch, tree, size):
    ways, area, sketch = drained(engine, make_sketch, HEAD + TREES[tree], size)
    np.testing.assert_array_equal(area, counted(ways))
    folded = engine.read(sketch.plainly(), "drained.fold")
    assert (folded[..., 1:3] == -1).all(), "nothing is left to be added"


@pytest.mark.filterwarnings("ignore:.*accumulation.comp is left out:playground.errors.PlainFormWarning")
def test_rain_weighs_what_falls(engine, make_sketch):
    rain = """
#include "noise/hash.glsl"
#pragma kernel(output = "rain:r32f")
float kernel(ivec2 texel) { return floor(4.0 * random(texel, 8u)); }
"""
    wet = '[[pass]]\nname = "wet"\nuse = "./wet"\n'
    text = wet + PASSES.format(rain=', rain = "wet"').replace("accumulation", "discharge")
    sketch = make_sketch(text, size=[50, 40], extent=[49.0, 39.0], ways=HEAD + RANDOM, wet=rain)
    ways, area = engine.read(sketch, "ways").copy(), engine.read(sketch, "drained").copy()
    np.testing.assert_array_equal(area, counted(ways, engine.read(sketch, "wet")))


def test_areas_are_in_square_metres(engine, make_sketch):
    sketch = make_sketch(PASSES.format(rain=""), size=[33, 65], extent=[320.0, 128.0], ways=HEAD + COMB)
    assert engine.read(sketch, "drained")[0, 0] == 33 * 65 * 10.0 * 2.0


def test_all_of_a_filled_terrain_arrives_at_its_edges(engine, make_sketch):
    text = passes(
        height=("generation/gradient_noise", "set = { frequency = 3, octaves = 7, seed = 4 }"),
        fill="water/fill",
        ways=("water/directions", 'inputs = { height = "fill" }'),
        drained="water/accumulation",
    )
    sketch = make_sketch(text, size=[129, 97], extent=[128.0, 96.0], relief=40.0)
    ways, area = engine.read(sketch, "ways").copy(), engine.read(sketch, "drained").copy()
    np.testing.assert_array_equal(area, counted(ways))
    assert area[edge_of(area.shape)].sum(dtype=float) == area.size
