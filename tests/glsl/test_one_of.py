"""One light of four: the chosen one as it is, at any size."""

import numpy as np
import pytest

LIGHT = """
#include "noise/hash.glsl"
#pragma kernel(output = "light:rgba16f")
uniform uint seed = 0u;
vec4 kernel(ivec2 texel) { return vec4(random_pair(texel, seed), random_pair(texel, seed + 9u)); }
"""
NAMES = ("first", "second", "third", "fourth")


@pytest.fixture
def chosen(make_sketch):
    def make(which, *, size="", wired=NAMES):
        passes = "".join(
            f'[[pass]]\nname = "{name}"\nuse = "./bright"\nset = {{ seed = {seed} }}\n'
            for seed, name in enumerate(NAMES)
        )
        wires = ", ".join(f'{name} = "{name}"' for name in wired)
        passes += f'[[pass]]\nname = "light"\nuse = "lighting/one_of"\ninputs = {{ {wires} }}\n'
        return make_sketch(f'{passes}{size}set = {{ chosen = "{which}" }}\n', size=[21, 13], bright=LIGHT)

    return make


@pytest.mark.parametrize("which", NAMES)
def test_the_chosen_light_is_given_as_it_is(engine, chosen, which):
    sketch = chosen(which)
    np.testing.assert_array_equal(engine.read(sketch, "light"), engine.read(sketch, which))


def test_a_larger_map_takes_the_nearest_texel(engine, chosen):
    sketch = chosen("third", size="size = [41, 25]\n")
    result, light = engine.read(sketch, "light"), engine.read(sketch, "third")
    np.testing.assert_array_equal(result[::2, ::2], light)
    for axis in (0, 1):
        assert (np.diff(np.take(result, range(0, 13), axis=axis), axis=axis) == 0).any()


def test_what_is_not_wired_is_white(engine, chosen):
    sketch = chosen("fourth", wired=("first",))
    result = engine.read(sketch.with_values({"light.chosen": "fourth"}), "light")
    assert np.isfinite(result).all()
