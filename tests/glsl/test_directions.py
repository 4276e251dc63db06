"""The way down from each texel against slopes in NumPy; turned, mirrored, and made to wander."""

import numpy as np
import pytest

from playground.errors import SketchError

from ..sketch_texts import passes
from ..truth.drainage import edge_of, steepest_slopes

ROUGH = """
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")
uniform int turn = 0;     //! slider(0, 1) Half a turn
uniform int mirror = 0;   //! slider(0, 1) East for west
uniform float tilt = 0.0; //! slider(-1, 1) Rise to the east over the whole
uniform float rough = 1.0; //! slider(0, 1) Of the random part
float kernel(ivec2 texel) {
    if (turn == 1) texel = size - 1 - texel;
    if (mirror == 1) texel.x = size.x - 1 - texel.x;
    return tilt * float(texel.x) / float(size.x) + rough * random(texel, 11u);
}
"""
PASSES = passes(height="./rough", down="water/directions")


@pytest.fixture
def terrain(make_sketch):
    return make_sketch(PASSES, size=[61, 45], extent=[1200.0, 700.0], rough=ROUGH)


SPACING = (1200.0 / 60, 700.0 / 44)


def both(engine, sketch, **values):
    chosen = sketch.with_values({k.replace("_", ".", 1): v for k, v in values.items()})
    return engine.read(chosen, "height").copy(), engine.read(chosen, "down").astype(int)


def test_each_texel_drains_to_its_steepest_neighbour(engine, terrain):
    height, receiver = both(engine, terrain)
    own = np.arange(height.size).reshape(height.shape)
    slopes, numbers = steepest_slopes(height, SPACING)
    inner = ~edge_of(height.shape)
    np.testing.assert_array_equal(receiver[~inner], own[~inner], "edges are outlets")
    steepest = slopes[:, inner].max(0)
    pit = steepest <= 0
    assert 0.02 < pit.mean() < 0.3
    np.testing.assert_array_equal(receiver[inner][pit], own[inner][pit], "pits drain to nowhere")
    expected = np.take_along_axis(numbers[:, inner], slopes[:, inner].argmax(0)[None], 0)[0]
    np.testing.assert_array_equal(receiver[inner][~pit], expected[~pit])


def test_turned_or_mirrored_terrain_drains_turned_or_mirrored(engine, terrain):
    _, receiver = both(engine, terrain)
    _rows, columns = receiver.shape
    way = np.stack([receiver // columns, receiver % columns]) - np.indices(receiver.shape)
    for key, flip, sign in (("turn", (1, 2), (-1, -1)), ("mirror", (2,), (1, -1))):
        _, result = both(engine, terrain, **{f"height_{key}": 1})
        other = np.stack([result // columns, result % columns]) - np.indices(result.shape)
        np.testing.assert_array_equal(np.flip(other, flip), way * np.reshape(sign, (2, 1, 1)))


def test_what_wanders_still_goes_down(engine, terrain):
    height, receiver = both(engine, terrain, down_randomness=1.0)
    level = height.ravel()
    elsewhere = receiver.ravel() != np.arange(height.size)
    assert (level[receiver.ravel()[elsewhere]] < level[elsewhere]).all()
    assert (receiver != both(engine, terrain)[1]).mean() > 0.1
    assert (receiver != both(engine, terrain, down_randomness=1.0, down_seed=2)[1]).mean() > 0.1


def test_on_an_even_slope_water_wanders_to_both_sides_alike(engine, make_sketch):
    sketch = make_sketch(PASSES, size=[161, 161], rough=ROUGH)
    values = {"height_tilt": -1.0, "height_rough": 0.0}
    _, straight = both(engine, sketch, **values)
    own = np.arange(straight.size).reshape(straight.shape)
    inner = np.s_[1:-1, 1:-1]
    assert (straight - own)[inner].min() == (straight - own)[inner].max() == 1, "due east"
    _, receiver = both(engine, sketch, down_randomness=1.0, **values)
    sideways = np.round((receiver - own)[inner] / 161.0)
    # 159^2 draws of which about a half go aside: four standard deviations of their mean.
    assert 0.2 < np.abs(sideways).mean() < 0.8
    assert abs(sideways.mean()) < 4 * sideways.std() / 159


def test_terrain_too_large_for_float_indices_is_refused(engine, make_sketch):
    sketch = make_sketch(PASSES, size=[5001, 33], rough=ROUGH)
    with pytest.raises(SketchError, match=r"takes n up to 4096, m up to 4096 texels a side, not 5001 x 33"):
        engine.read(sketch, "down")
