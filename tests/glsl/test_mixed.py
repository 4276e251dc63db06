"""The mixed model: its sum against NumPy, and how many small summits its details take away."""

import numpy as np
import pytest
from scipy.ndimage import maximum_filter

from playground.engine.engine import Engine

SEED = 3


@pytest.fixture
def sketch_of(make_sketch):
    def make(size=65, use="mixed", **values):
        text = "".join(f"{k} = {v!r}\n" for k, v in ({"seed": SEED} | values).items())
        head = f'[[pass]]\nname = "terrain"\nuse = "generation/{use}"\n[pass.set]\n'
        beside = f'[[pass]]\nname = "noise"\nuse = "generation/layered_noise"\nset = {{ seed = {SEED}, '
        beside += 'frequency = 32, octaves = 1, persistence = 0.04, normalise = "none" }\n'
        return make_sketch(head + text + beside, size=size)

    return make


@pytest.mark.parametrize("shape_range", ["none", "max", "minmax"])
@pytest.mark.parametrize(("octaves", "persistence"), [(1, 0.04), (3, 0.3), (8, 0.9), (8, 1.0), (0, 0.5)])
def test_it_is_the_weighted_mean_of_shape_and_layers(engine, sketch_of, shape_range, octaves, persistence):
    sketch = sketch_of(frequency=4, octaves=octaves, persistence=persistence, shape_range=shape_range)
    shape = engine.read(sketch, "terrain.shape.raw").astype(np.float64)
    if shape_range == "max":
        shape = shape / shape.max()
    elif shape_range == "minmax":
        shape = np.interp(shape, [shape.min(), shape.max()], [0, 1])
    total, weights = shape, 1.0
    for k in range(octaves):
        layer = engine.read(sketch.with_values({"terrain.detail.layer": k + 1}), "terrain.detail")
        total = total + layer.astype(np.float64) * persistence ** (k + 1)
        weights += persistence ** (k + 1)
    np.testing.assert_allclose(engine.read(sketch, "terrain.mix"), total / weights, atol=2e-6)


def test_its_parts_are_diamond_square_and_layered_noise(engine, sketch_of, make_sketch):
    sketch = sketch_of()
    np.testing.assert_array_equal(engine.read(sketch, "terrain.detail"), engine.read(sketch, "noise"))
    use = '[[pass]]\nname = "terrain"\nuse = "generation/diamond_square"\n'
    alone = make_sketch(f'{use}set = {{ seed = {SEED}, normalise = "max" }}\n', size=65)
    np.testing.assert_array_equal(engine.read(sketch, "terrain.shape"), engine.read(alone, "terrain"))


def test_its_shape_is_the_technique_with_its_fast_form(ctx, sketch_of):
    """Where there is compute, diamond-square's own passes do not run: its one compute shader does."""
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    for use in ("mixed", "mixed_tiled"):
        with Engine(ctx) as engine:
            engine.texture(sketch_of(use=use), "terrain")
            assert "terrain.shape" in engine.record.ran
            assert not [name for name in engine.record.ran if name.startswith("terrain.shape.")], (
                engine.record.ran
            )


def test_without_details_it_is_the_shape(engine, sketch_of):
    for values in ({"octaves": 0}, {"persistence": 0.0}):
        sketch = sketch_of(**values)
        np.testing.assert_array_equal(
            engine.read(sketch, "terrain.mix"), engine.read(sketch, "terrain.shape")
        )


def test_it_is_normalised_by_default(engine, sketch_of):
    terrain = engine.read(sketch_of(), "terrain")
    assert terrain.min() == 0 and terrain.max() == 1


def summits(terrain):
    """Count the texels that are higher than the eight around them."""
    around = np.ones((3, 3), bool)
    around[1, 1] = False
    highest = maximum_filter(terrain, footprint=around, mode="constant", cval=-np.inf)
    return int((terrain > highest)[1:-1, 1:-1].sum())


@pytest.mark.parametrize(("persistence", "low", "high"), [(0.04, 0.89, 0.98), (0.2, 0.33, 0.53)])
@pytest.mark.parametrize("size", [257, 513])
def test_details_take_small_summits_away(any_engine, sketch_of, size, persistence, low, high):
    """On a shape that fills 0..1: about a tenth at the thesis's weight of 0.04, half and more at 0.2."""
    kept = []
    for seed in range(16):
        sketch = sketch_of(size, persistence=persistence, seed=seed, shape_range="minmax")
        shape = summits(any_engine.read(sketch, "terrain.shape").astype(np.float64))
        kept.append(summits(any_engine.read(sketch, "terrain.mix").astype(np.float64)) / shape)
    assert low < np.mean(kept) < high, kept


@pytest.mark.parametrize("use", ["mixed", "mixed_tiled"])
def test_the_smoothing_counts(any_engine, sketch_of, use):
    """A smoother shape is a flatter one, of which the same details take more summits away."""
    terrains = [
        any_engine.read(sketch_of(257, use=use, smoothing=s), "terrain").astype(float) for s in (0.1, 0.5)
    ]
    assert np.abs(terrains[0] - terrains[1]).max() > 0.05
    assert summits(terrains[0]) < 0.9 * summits(terrains[1])


@pytest.mark.parametrize("frequency", [4, 32])
def test_details_know_nothing_of_the_shape(any_engine, sketch_of, frequency):
    """The numbers that displace the shape's points are not those of the details' nodes at the same places."""
    correlations = []
    for seed in range(8):
        sketch = sketch_of(257, seed=seed, frequency=frequency)
        node = 256 // frequency
        detail = any_engine.read(sketch, "terrain.detail").astype(float)[::node, ::node][1:-1, 1:-1]
        raw = any_engine.read(sketch, "terrain.shape.raw").astype(float)[:: node // 2, :: node // 2]
        # How far a point stands above the mean of the points around it, where it is an edge's middle.
        here = raw[2:-2:2, 2:-2:2]
        around = (raw[2:-2:2, :-4:2] + raw[2:-2:2, 4::2] + raw[:-4:2, 2:-2:2] + raw[4::2, 2:-2:2]) / 4
        edges = np.add.outer(*[np.arange(1, len(detail) + 1)] * 2) % 2 == 1
        correlations.append(np.corrcoef((here - around)[edges], detail[edges])[0, 1] * edges.sum() ** 0.5)
    assert np.abs(np.mean(correlations)) < 4 / np.sqrt(8)
