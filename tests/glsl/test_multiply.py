"""The product of two terrains against NumPy, and what it does to valleys and ridges."""

import numpy as np
import pytest

TERRAIN = """
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")
uniform float scale = 1.0;
uniform float base = 0.0;
uniform uint seed = 3u;
float kernel(ivec2 texel) { return base + scale * random(texel, seed); }
"""
PASSES = """
[[pass]]
name = "a"
use = "./terrain"
set = {{ seed = 1, scale = {first[0]}, base = {first[1]} }}
[[pass]]
name = "b"
use = "./terrain"
set = {{ seed = 2, scale = {second[0]}, base = {second[1]} }}
[[pass]]
name = "terrain"
use = "generation/multiply"
inputs = {{ first = "a", second = "b" }}
set = {{ normalise = "{normalise}" }}
"""
LANDS = """
[[pass]]
name = "a"
use = "generation/diamond_square"
set = {{ seed = {0}, smoothing = 0.5 }}
[[pass]]
name = "b"
use = "generation/diamond_square"
set = {{ seed = {1}, smoothing = 0.5 }}
[[pass]]
name = "terrain"
use = "generation/multiply"
inputs = {{ first = "a", second = "b" }}
"""
INSIDE = [(1.0, 0.0), (0.5, 0.25), (0.0, 0.5), (0.0, 1.0)]
OUTSIDE = [(2.0, -1.0), (3.0, 0.0), (0.5, 0.75), (0.5, -0.1), (0.0, 2.0), (0.0, -1.0)]


@pytest.fixture
def sketch_of(make_sketch):
    def make(first=(1.0, 0.0), second=(1.0, 0.0), size=(33, 20), normalise="none"):
        passes = PASSES.format(first=first, second=second, normalise=normalise)
        return make_sketch(passes, size=list(size), terrain=TERRAIN)

    return make


def factor(terrain):
    """Return a terrain as it is where it lies in 0..1, else from lowest to highest."""
    terrain = terrain.astype(np.float64)
    low, high = terrain.min(), terrain.max()
    if 0 <= low and high <= 1:
        return terrain
    return (terrain - low) / (high - low) if high > low else np.zeros_like(terrain)


@pytest.mark.parametrize("first", INSIDE + OUTSIDE, ids=str)
@pytest.mark.parametrize("second", [INSIDE[1], OUTSIDE[0]], ids=str)
def test_it_is_the_product(engine, sketch_of, first, second):
    sketch = sketch_of(first, second)
    truth = factor(engine.read(sketch, "a")) * factor(engine.read(sketch, "b"))
    np.testing.assert_allclose(engine.read(sketch, "terrain"), truth, atol=1e-6)


@pytest.mark.parametrize("size", [(1, 1), (2, 2), (40, 3), (129, 129)], ids=str)
def test_it_is_nowhere_above_a_factor(engine, sketch_of, size):
    sketch = sketch_of(INSIDE[0], INSIDE[1], size)
    product = engine.read(sketch, "terrain")
    assert (product <= engine.read(sketch, "a")).all() and (product <= engine.read(sketch, "b")).all()


def test_it_does_not_matter_which_comes_first(engine, sketch_of):
    sketch = sketch_of(OUTSIDE[0], INSIDE[1])
    turned = sketch_of(INSIDE[1], OUTSIDE[0]).with_values({"a.seed": 2, "b.seed": 1})
    np.testing.assert_array_equal(engine.read(sketch, "terrain"), engine.read(turned, "terrain"))


def test_it_is_normalised_by_default(engine, make_sketch):
    terrain = engine.read(make_sketch(LANDS.format(1, 2), size=33), "terrain")
    assert terrain.min() == 0 and terrain.max() == 1


def roughness(terrain):
    """Return the mean slope of the lowest quarter of a terrain over that of its highest."""
    slope = np.hypot(*np.gradient(terrain.astype(np.float64)))
    low, high = np.quantile(terrain, [0.25, 0.75])
    return slope[terrain <= low].mean() / slope[terrain >= high].mean()


@pytest.mark.slow
def test_valleys_become_smoother_than_ridges(any_engine, make_sketch):
    for seed in range(20):
        sketch = make_sketch(LANDS.format(2 * seed, 2 * seed + 1), size=129)
        product = roughness(any_engine.read(sketch, "terrain"))
        factors = [roughness(any_engine.read(sketch, name)) for name in ("a", "b")]
        assert product < min(factors), (seed, product, factors)
