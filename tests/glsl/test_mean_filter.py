"""The mean filter of light: sums of slices in float64, for windows and for patches."""

from __future__ import annotations

import numpy as np
import pytest

HALF = 2.0**-10
LIGHT = """
#include "noise/hash.glsl"
#pragma kernel(output = "light:rgba16f")
vec4 kernel(ivec2 texel) {
    return vec4(2.0 * random_pair(texel, 1u), random_pair(texel, 2u));
}
"""


@pytest.fixture
def filtered(make_sketch):
    def make(n: int, area: str = "window", size: tuple[int, int] = (19, 13)):
        passes = (
            '[[pass]]\nname = "bright"\nuse = "./bright"\n'
            '[[pass]]\nname = "light"\nuse = "lighting/mean_filter"\ninputs = { light = "bright" }\n'
            f'set = {{ n = {n}, area = "{area}" }}\n'
        )
        return make_sketch(passes, size=list(size), bright=LIGHT)

    return make


@pytest.mark.parametrize("n", [0, 1, 4, 30])
def test_a_window_is_the_mean_of_what_lies_around(engine, filtered, n):
    sketch = filtered(n)
    before = engine.read(sketch, "bright").astype(np.float64)
    result = engine.read(sketch, "light")
    for y in range(before.shape[0]):
        for x in range(before.shape[1]):
            around = before[max(y - n, 0) : y + n + 1, max(x - n, 0) : x + n + 1]
            np.testing.assert_allclose(result[y, x], around.mean(axis=(0, 1)), atol=2 * HALF)


@pytest.mark.parametrize("n", [0, 1, 2, 5, 40])
def test_a_patch_has_one_light_the_mean_of_its_own(engine, filtered, n):
    sketch = filtered(n, "patch")
    before = engine.read(sketch, "bright").astype(np.float64)
    result = engine.read(sketch, "light")
    side = max(n, 1)
    for y in range(0, before.shape[0], side):
        for x in range(0, before.shape[1], side):
            patch = (slice(y, y + side), slice(x, x + side))
            expected = np.broadcast_to(before[patch].mean(axis=(0, 1)), result[patch].shape)
            np.testing.assert_allclose(result[patch], expected, atol=2 * HALF)


def test_the_thesis_s_four_is_a_window_of_nine(engine, filtered):
    """One bright texel spreads over 81, not 16."""
    sketch = filtered(4, size=(31, 31))
    before = engine.read(sketch, "bright")[..., 0].astype(np.float64)
    result = engine.read(sketch, "light")[..., 0]
    np.testing.assert_allclose(result[15, 15], before[11:20, 11:20].mean(), atol=2 * HALF)


def test_even_light_stays(engine, filtered, make_sketch):
    flat = '#pragma kernel(output = "light:rgba16f")\nvec4 kernel(ivec2 texel) { return vec4(0.75); }\n'
    passes = '[[pass]]\nname = "a"\nuse = "./a"\n[[pass]]\nname = "b"\nuse = "lighting/mean_filter"\n'
    passes += 'inputs = { light = "a" }\n'
    np.testing.assert_array_equal(engine.read(make_sketch(passes, a=flat), "b"), 0.75)
