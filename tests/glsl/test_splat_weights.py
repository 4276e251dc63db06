"""texturing/splat_weights: weights sum to 1, and the alphas made of them give them back."""

from __future__ import annotations

import numpy as np
import pytest

FILE = "texturing/splat_weights.glsl"


def over(alphas: np.ndarray, layers: np.ndarray) -> np.ndarray:
    """Do section 2.6's formula for one layer after another: result = alpha texture + (1 - alpha) previous."""
    result = np.zeros_like(layers[0], float)
    for alpha, layer in zip(alphas, layers, strict=True):
        result = alpha * layer + (1 - alpha) * result
    return result


@pytest.fixture
def weights():
    random = np.random.default_rng(3)
    dirichlet = random.dirichlet([0.3] * 4, 4000)
    dirichlet[:15] = np.array([[(n >> k) & 1 for k in range(4)] for n in range(1, 16)], float)
    return dirichlet / dirichlet.sum(axis=1, keepdims=True)


def test_cover_weights_match_layers_composited_in_order(on_gpu):
    covers = np.random.default_rng(4).uniform(size=(3000, 3))
    result = on_gpu(FILE, "weights_of_covers(c)", c=covers)
    for k in range(4):
        seen = [over([1.0, *cover], np.eye(4)[k]) for cover in covers]
        np.testing.assert_allclose(result[:, k], seen, atol=3e-7)
    np.testing.assert_allclose(result.sum(axis=1), 1.0, atol=3e-7)


def test_covers_past_their_range_are_held_in_it(on_gpu):
    result = on_gpu(
        FILE, "weights_of_covers(c)", c=np.array([[-1.0, 0.0, 0.0], [0.3, 2.0, 0.0], [9.0, 9.0, 9.0]])
    )
    np.testing.assert_allclose(result, [[1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], atol=1e-7)


def test_mask_weights_are_proportional_and_empty_is_first_layer(on_gpu):
    masks = np.random.default_rng(5).uniform(size=(500, 4)) * np.array([1, 200.0, 1e-3, 1])
    result = on_gpu(FILE, "weights_of_mask(m)", m=masks)
    np.testing.assert_allclose(result, masks / masks.sum(axis=1, keepdims=True), atol=1e-6)
    np.testing.assert_array_equal(on_gpu(FILE, "weights_of_mask(m)", m=np.zeros((1, 4))), [[1, 0, 0, 0]])


def test_byte_weights_sum_to_255_within_rounding(on_gpu, weights):
    result = on_gpu(FILE, "weights_in_bytes(w)", w=weights).astype(float) * 255
    whole = np.round(result)
    np.testing.assert_allclose(result, whole, atol=1e-4)
    assert (whole.sum(axis=1) == 255).all()
    assert whole.min() >= 0
    # The largest takes what the roundings of the others leave: up to half a 255th of each.
    off = np.abs(whole - weights * 255)
    assert off.max() <= 2.0
    assert np.sort(off, axis=1)[:, :3].max() <= 0.5 + 1e-4


def test_composited_layer_alphas_reproduce_weights(on_gpu, weights):
    alphas = np.stack([on_gpu(FILE, f"alpha_of_layer(w, {k})", w=weights) for k in range(4)])
    assert alphas.min() >= 0 and alphas.max() <= 1
    assert np.isfinite(alphas).all()
    left = [over(alphas[:, i].astype(float), np.eye(4)) for i in range(len(weights))]
    np.testing.assert_allclose(left, weights, atol=5e-7)


def test_the_weights_themselves_as_alphas_would_not(weights):
    """Why alphas are made at all: the formula with the map's own numbers favours the last layers."""
    mixed = weights[weights.max(axis=1) < 0.7]
    left = np.array([over(w, np.eye(4)) for w in mixed])
    assert np.abs(left - mixed).max(axis=1).min() > 0.02


def test_heights_shift_the_odds_and_nothing_else(on_gpu, weights):
    heights = np.random.default_rng(6).uniform(0, 2, weights.shape)
    result = on_gpu(FILE, "weights_by_heights(w, h, 5.0)", w=weights, h=heights)
    np.testing.assert_allclose(result.sum(axis=1), 1.0, atol=3e-7)
    assert ((result == 0) == (weights == 0)).all()
    # Odds of each pair, in logarithms: the old ones and five times the difference of heights.
    inside = (weights > 1e-4).all(axis=1)
    logs = np.log(result[inside].astype(float)) - np.log(weights[inside]) - 5.0 * heights[inside]
    np.testing.assert_allclose(logs - logs[:, :1], 0.0, atol=2e-4)


def test_single_material_and_equal_heights_keep_their_weights(on_gpu, weights):
    alone = on_gpu(FILE, "weights_by_heights(w, h, 20.0)", w=np.eye(4), h=np.full((4, 4), 1.0) - np.eye(4))
    np.testing.assert_array_equal(alone, np.eye(4))
    level = on_gpu(FILE, "weights_by_heights(w, vec4(0.7), 20.0)", w=weights)
    np.testing.assert_allclose(level, weights, atol=2e-7)
