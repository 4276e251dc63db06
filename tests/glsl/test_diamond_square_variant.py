"""The compute variant of diamond-square gives the same bits as its passes, for any parameters."""

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.errors import SketchError

CORNERS = (0.1, 0.7, 0.4, 0.9)


@pytest.fixture
def fast(ctx):
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    with Engine(ctx) as engine:
        yield engine


@pytest.fixture
def slow(ctx):
    with Engine(ctx, driver="fragment") as engine:
        yield engine


def sketch_of(make_sketch, size, **values):
    text = "".join(f"{k} = {v!r}\n".replace("(", "[").replace(")", "]") for k, v in values.items())
    use = '[[pass]]\nname = "terrain"\nuse = "generation/diamond_square"\n'
    return make_sketch(f"{use}[pass.set]\n{text}", size=size)


def test_it_runs_and_by_fragment_the_passes_do(fast, slow, make_sketch):
    sketch = sketch_of(make_sketch, 129)
    fast.texture(sketch, "terrain")
    slow.texture(sketch, "terrain")
    assert fast.record.ran == ["terrain"]
    assert "terrain.raw" in slow.record.ran


@pytest.mark.parametrize("size", [2, 3, 5, 9, 17, 33, 65, 129, 257, 513])
@pytest.mark.parametrize("normalise", ["none", "max", "minmax"])
@pytest.mark.parametrize("random", ["centred", "positive"])
def test_it_gives_the_bits_of_the_passes(fast, slow, make_sketch, size, normalise, random):
    """Sizes of even and odd levels, of one group and of many."""
    values = {"smoothing": 0.63, "corners": CORNERS, "seed": 5, "random": random, "normalise": normalise}
    sketch = sketch_of(make_sketch, size, **values)
    np.testing.assert_array_equal(fast.read(sketch, "terrain"), slow.read(sketch, "terrain"))


# At 65 texels and seeds 172 and 291, at 129 and seed 61, the lowest or the highest stands in the
# two western columns, which no eight columns hold; at 129 and seed 289 what lies past the
# eastern border would be the highest.
@pytest.mark.parametrize("size", [65, 129, 257])
@pytest.mark.parametrize("smoothing", [1.0, 0.05])
def test_no_height_is_missed_in_the_search_for_the_range(fast, make_sketch, size, smoothing):
    """Rows that cannot hold the lowest or the highest are skipped; those that can must not be."""
    for seed in (*range(8), 61, 172, 289, 291):
        values = {"smoothing": smoothing, "corners": CORNERS, "seed": seed}
        raw = fast.read(sketch_of(make_sketch, size, **values), "terrain")
        share = (raw - raw.min()) / (raw.max() - raw.min())
        result = fast.read(sketch_of(make_sketch, size, normalise="minmax", **values), "terrain")
        np.testing.assert_array_equal(result, share)
        result = fast.read(sketch_of(make_sketch, size, normalise="max", **values), "terrain")
        np.testing.assert_array_equal(result, raw / raw.max())


def test_terrain_below_0_is_not_turned_over(fast, slow, make_sketch):
    """By "max", a terrain whose heights are all below 0 stays as it is."""
    values = {"smoothing": 0.01, "normalise": "max", "corners": (0.0, 0.0, 0.0, 0.0)}
    for seed in range(4):
        sketch = sketch_of(make_sketch, 65, seed=seed, **values)
        np.testing.assert_array_equal(fast.read(sketch, "terrain"), slow.read(sketch, "terrain"))


def test_level_terrain_is_level(fast, make_sketch):
    for size in (33, 129):
        for normalise, height in (("none", np.float32(0.4)), ("max", 1.0), ("minmax", 0.0)):
            sketch = sketch_of(make_sketch, size, smoothing=0.0, corners=(0.4,) * 4, normalise=normalise)
            np.testing.assert_array_equal(fast.read(sketch, "terrain"), height)


def test_an_iteration_on_the_way_is_the_kernel_s(fast, make_sketch):
    sketch = sketch_of(make_sketch, 65)
    fast.read(sketch, "terrain", steps={"terrain.raw": 3})
    assert "terrain.raw" in fast.record.ran
    fast.read(sketch, "terrain")
    assert fast.record.ran in ([], ["terrain"])


def test_variant_refuses_sizes_refused_by_its_kernel(fast, slow, make_sketch):
    for engine in (fast, slow):
        with pytest.raises(SketchError, match="65 x 65 or 129 x 129"):
            engine.read(sketch_of(make_sketch, 100), "terrain")


def test_keys_are_in_the_order_of_heights(on_gpu):
    heights = np.array([-3e38, -1.0, -1e-30, -0.0, 0.0, 1e-38, 0.5, 0.50000006, 1.0, 3e38], np.float32)
    file = "terrain/order.glsl"
    keys = on_gpu(file, "key_of_height(h)", h=heights)
    assert (np.diff(keys.astype(np.int64)) > 0).all() and keys.min() > 0 and (~keys).min() > 0
    np.testing.assert_array_equal(on_gpu(file, "height_of_key(key_of_height(h))", h=heights), heights)
