"""The mean filter against sums of slices in float64, over those texels that exist."""

import numpy as np
import pytest

TERRAIN = """
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")
uniform float scale = 1.0;
uniform float base = 0.0;
float kernel(ivec2 texel) { return base + scale * random_signed(texel, 3u); }
"""
PASSES = """
[[pass]]
name = "terrain"
use = "./terrain"
set = {{ scale = {scale}, base = {base} }}
[[pass]]
name = "smooth"
use = "generation/smooth"
inputs = {{ height = "terrain" }}
set = {{ radius = {radius} }}
"""


def truth(terrain, radius):
    """Return the mean of each square of texels, cut at the border, slice by slice."""
    terrain = terrain.astype(np.float64)
    rows, columns = terrain.shape
    result = np.empty_like(terrain)
    for y in range(rows):
        strip = terrain[max(y - radius, 0) : y + radius + 1]
        for x in range(columns):
            result[y, x] = strip[:, max(x - radius, 0) : x + radius + 1].mean()
    return result


@pytest.fixture
def sketch_of(make_sketch):
    def make(size=(33, 33), radius=5, scale=1.0, base=0.0):
        return make_sketch(
            PASSES.format(radius=radius, scale=scale, base=base), size=list(size), terrain=TERRAIN
        )

    return make


@pytest.mark.parametrize("radius", [1, 2, 5, 40, 63])
@pytest.mark.parametrize("size", [(33, 33), (70, 23), (23, 70), (150, 131)], ids=str)
def test_it_is_the_mean_of_what_exists(engine, sketch_of, size, radius):
    sketch = sketch_of(size, radius)
    terrain = engine.read(sketch, "terrain")
    np.testing.assert_allclose(engine.read(sketch, "smooth"), truth(terrain, radius), atol=1e-6)


def test_it_is_scipys_away_from_the_border(engine, sketch_of):
    uniform_filter = pytest.importorskip("scipy.ndimage").uniform_filter
    sketch = sketch_of((129, 97), 5)
    inner = np.s_[5:-5, 5:-5]
    expected = uniform_filter(engine.read(sketch, "terrain").astype(np.float64), 11)
    np.testing.assert_allclose(engine.read(sketch, "smooth")[inner], expected[inner], atol=1e-6)


def test_the_thesis_radius_is_the_default(engine, make_sketch, sketch_of):
    passes = PASSES.format(radius=0, scale=1.0, base=0.0).replace("set = { radius = 0 }", "")
    plain = engine.read(make_sketch(passes, size=40, terrain=TERRAIN), "smooth")
    np.testing.assert_array_equal(plain, engine.read(sketch_of((40, 40), 5), "smooth"))


def test_radius_0_changes_no_bit(engine, sketch_of):
    for base in (0.0, 300.0):
        sketch = sketch_of((90, 40), 0, base=base)
        np.testing.assert_array_equal(engine.read(sketch, "smooth"), engine.read(sketch, "terrain"))


def test_a_radius_above_the_terrain_gives_its_mean_everywhere(engine, sketch_of):
    sketch = sketch_of((70, 41), 512)
    terrain = engine.read(sketch, "terrain").astype(np.float64)
    np.testing.assert_allclose(engine.read(sketch, "smooth"), terrain.mean(), atol=1e-6)


@pytest.mark.parametrize("size", [(1, 1), (2, 2), (1, 100), (100, 1)], ids=str)
def test_tiny_terrains(engine, sketch_of, size):
    sketch = sketch_of(size)
    np.testing.assert_allclose(
        engine.read(sketch, "smooth"), truth(engine.read(sketch, "terrain"), 5), atol=1e-6
    )


@pytest.mark.parametrize("radius", [5, 100])
def test_roundings_do_not_gather_on_a_large_terrain(engine, sketch_of, radius):
    """Against sums of sums in float64; heights far from 0 leave a float few digits below them."""
    sketch = sketch_of((1025, 600), radius, base=8.0)
    terrain = engine.read(sketch, "terrain").astype(np.float64)

    def along(values):
        sums = np.cumsum(np.pad(values, ((1, 0), (0, 0))), axis=0)
        position = np.arange(len(values))
        low, high = np.maximum(position - radius, 0), np.minimum(position + radius, len(values) - 1) + 1
        return (sums[high] - sums[low]) / (high - low)[:, None]

    np.testing.assert_allclose(engine.read(sketch, "smooth"), along(along(terrain).T).T, atol=4e-6)


def test_flat_terrain_stays_and_a_slope_stays_inside(engine, make_sketch, sketch_of):
    flat = engine.read(sketch_of((80, 80), 7, scale=0.0, base=0.7), "smooth")
    np.testing.assert_allclose(flat, np.float32(0.7), rtol=2e-7)
    slope = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 t) { return float(t.x + 2 * t.y); }\n'
    result = engine.read(
        make_sketch(
            PASSES.format(radius=7, scale=0, base=0).replace("set = { scale = 0, base = 0 }", ""),
            size=80,
            terrain=slope,
        ),
        "smooth",
    )
    y, x = np.mgrid[7:73, 7:73]
    np.testing.assert_allclose(result[7:-7, 7:-7], x + 2 * y, atol=2e-5)
