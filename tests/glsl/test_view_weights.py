"""view/weights: the mixture of four colours by the weights, the strongest, or one alone."""

from __future__ import annotations

import numpy as np
import pytest

from playground.shader.colours import srgb_to_linear

MAP = '#pragma kernel(output = "weights:rgba32f")\n'
MAP += "vec4 kernel(ivec2 texel) {{ vec2 s = vec2(texel) / vec2(size - 1); return {}; }}\n"
BILINEAR = MAP.format("vec4(s.x * s.y, (1.0 - s.x) * s.y, s.x * (1.0 - s.y), (1.0 - s.x) * (1.0 - s.y))")
PASSES = '[[pass]]\nname = "weights"\nuse = "./weights"\n[[pass]]\nname = "colour"\nuse = "view/weights"\n{}'
# Okabe and Ito's green, orange, sky blue and purple, as bytes.
BYTES = np.array([[0, 158, 115], [230, 159, 0], [86, 180, 233], [204, 121, 167]]) / 255
COLOURS = srgb_to_linear(BYTES)


def shares(width, height):
    x, y = np.meshgrid(np.linspace(0, 1, width), np.linspace(0, 1, height))
    return np.stack([x * y, (1 - x) * y, x * (1 - y), (1 - x) * (1 - y)], axis=-1)


@pytest.mark.parametrize("size", [[33, 17], [65, 50]])
def test_colours_are_mixed_by_weight(engine, make_sketch, size):
    sketch = make_sketch(PASSES.format(f"size = {size}\n"), size=[33, 17], weights=BILINEAR)
    result = engine.read(sketch, "colour").astype(float)
    np.testing.assert_allclose(result[..., :3], shares(*size) @ COLOURS, atol=2e-3)
    assert (result[..., 3] == 1).all()


def test_the_strongest_alone(any_engine, make_sketch):
    sketch = make_sketch(PASSES.format('set = { shown = "strongest" }\n'), size=[32, 16], weights=BILINEAR)
    result = any_engine.read(sketch, "colour").astype(float)[..., :3]
    np.testing.assert_allclose(result, COLOURS[shares(32, 16).argmax(axis=-1)], atol=2e-3)


@pytest.mark.parametrize(("layer", "name"), list(enumerate(("grass", "rock", "snow", "path"))))
def test_one_layer_alone_is_grey(any_engine, make_sketch, layer, name):
    sketch = make_sketch(PASSES.format(f'set = {{ shown = "{name}" }}\n'), size=[33, 17], weights=BILINEAR)
    result = any_engine.read(sketch, "colour").astype(float)
    for channel in range(3):
        np.testing.assert_allclose(result[..., channel], shares(33, 17)[..., layer], atol=1e-3)


def test_weights_that_do_not_sum_to_one_show(any_engine, make_sketch):
    sketch = make_sketch(
        PASSES.format(""), size=5, weights=MAP.format("vec4(0.25 + 0.0 * s.x, 0.0, 0.0, 0.0)")
    )
    result = any_engine.read(sketch, "colour")[..., :3]
    np.testing.assert_allclose(result, np.broadcast_to(0.25 * COLOURS[0], result.shape), atol=1e-3)


def test_a_finer_map_is_averaged(any_engine, make_sketch):
    stripes = MAP.format("texel.x % 2 == 0 ? vec4(1.0, 0.0, 0.0, 0.0) : vec4(0.0, 1.0, 0.0, 0.0)")
    sketch = make_sketch(PASSES.format("size = 17\n"), size=128, weights=stripes)
    result = any_engine.read(sketch, "colour").astype(float)[2:-2, 2:-2, :3]
    np.testing.assert_allclose(result, np.broadcast_to(COLOURS[:2].mean(axis=0), result.shape), atol=0.02)
