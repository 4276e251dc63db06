"""The mixed model: its sum against NumPy, and how many small summits its details take away."""

import numpy as np
import pytest
from scipy.ndimage import maximum_filter

SEED = 3


@pytest.fixture
def sketch_of(make_sketch):
    def make(size=65, **values):
        given = "".join(f"{k} = {v!r}\n" for k, v in ({"seed": SEED} | values).items())
        head = '[[pass]]\nname = "land"\nuse = "generation/mixed"\n[pass.set]\n'
        beside = f'[[pass]]\nname = "noise"\nuse = "generation/layered_noise"\nset = {{ seed = {SEED}, '
        beside += 'frequency = 32, octaves = 1, persistence = 0.04, normalise = "none" }\n'
        return make_sketch(head + given + beside, size=size)

    return make


@pytest.mark.parametrize("shape_range", ["none", "max", "minmax"])
@pytest.mark.parametrize(("octaves", "persistence"), [(1, 0.04), (3, 0.3), (8, 0.9), (8, 1.0), (0, 0.5)])
def test_it_is_the_weighted_mean_of_shape_and_layers(engine, sketch_of, shape_range, octaves, persistence):
    sketch = sketch_of(frequency=4, octaves=octaves, persistence=persistence, shape_range=shape_range)
    shape = engine.read(sketch, "land.shape").astype(np.float64)
    if shape_range == "max":
        shape = shape / shape.max()
    elif shape_range == "minmax":
        shape = np.interp(shape, [shape.min(), shape.max()], [0, 1])
    total, weights = shape, 1.0
    for k in range(octaves):
        layer = engine.read(sketch.with_values({"land.detail.layer": k + 1}), "land.detail")
        total = total + layer.astype(np.float64) * persistence ** (k + 1)
        weights += persistence ** (k + 1)
    np.testing.assert_allclose(engine.read(sketch, "land.mix"), total / weights, atol=2e-6)


def test_its_parts_are_diamond_square_and_layered_noise(engine, sketch_of, make_sketch):
    sketch = sketch_of()
    np.testing.assert_array_equal(engine.read(sketch, "land.detail"), engine.read(sketch, "noise"))
    use = f'[[pass]]\nname = "land"\nuse = "generation/diamond_square"\nset = {{ seed = {SEED} }}\n'
    alone = engine.read(make_sketch(use, size=65), "land")
    np.testing.assert_array_equal(engine.read(sketch, "land.shape"), alone)


def test_without_details_it_is_the_shape(engine, sketch_of):
    for values in ({"octaves": 0}, {"persistence": 0.0}):
        sketch = sketch_of(**values)
        np.testing.assert_array_equal(engine.read(sketch, "land.mix"), engine.read(sketch, "land.stretched"))


def test_it_is_normalised_by_default(engine, sketch_of):
    land = engine.read(sketch_of(), "land")
    assert land.min() == 0 and land.max() == 1


def summits(land):
    """Count the texels that are higher than the eight around them."""
    around = np.ones((3, 3), bool)
    around[1, 1] = False
    highest = maximum_filter(land, footprint=around, mode="constant", cval=-np.inf)
    return int((land > highest)[1:-1, 1:-1].sum())


@pytest.mark.parametrize(("persistence", "low", "high"), [(0.04, 0.7, 0.95), (0.2, 0.25, 0.55)])
@pytest.mark.parametrize("size", [257, 513])
def test_details_take_small_summits_away(any_engine, sketch_of, size, persistence, low, high):
    """Some of them at the thesis's weight of 0.04, most at five times that."""
    for seed in range(4):
        sketch = sketch_of(size, persistence=persistence, seed=seed)
        shape = summits(any_engine.read(sketch, "land.stretched").astype(np.float64))
        ratio = summits(any_engine.read(sketch, "land.mix").astype(np.float64)) / shape
        assert low < ratio < high, (seed, ratio)
