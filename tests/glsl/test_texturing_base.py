"""texturing/swatches and texturing/one_of: images beside each other, and one image of several."""

from __future__ import annotations

import numpy as np
import pytest

PLAIN = '#pragma kernel(output = "colour:rgba16f")\nvec4 kernel(ivec2 texel) {{ return vec4({}, 1.0); }}\n'
COLOURS = {"red": "1.0, 0.0, 0.0", "green": "0.0, 1.0, 0.0", "blue": "0.0, 0.0, 1.0"}
FILES = {name: PLAIN.format(colour) for name, colour in COLOURS.items()}
SWATCHES = "".join(f'[[pass]]\nname = "{name}"\nuse = "./{name}"\nsize = 8\n' for name in COLOURS)


@pytest.mark.parametrize(("begin", "order"), [(0, ("red", "green")), (1, ("green", "blue"))])
def test_swatches_stand_in_their_order_with_paper_between(engine, make_sketch, begin, order):
    use = (
        '[[pass]]\nname = "picture"\nuse = "texturing/swatches"\n'
        'inputs = { first = "red", second = "green", third = "blue" }\n'
        f"set = {{ begin = {begin}, count = 2, gap = 4, paper = [0.5, 0.25, 0.125] }}\n"
    )
    picture = engine.read(make_sketch(SWATCHES + use, size=[44, 24], **FILES), "picture")[..., :3]
    expected = np.empty((24, 44, 3))
    expected[:] = (0.5, 0.25, 0.125)
    for index, name in enumerate(order):
        left = 24 * index
        expected[2:22, left : left + 20] = np.eye(3)[list(COLOURS).index(name)]
    np.testing.assert_array_equal(picture, expected)


def test_a_swatch_repeats_the_whole_image(any_engine, make_sketch):
    stripes = PLAIN.format("vec3(float(texel.x < 16))")
    text = '[[pass]]\nname = "red"\nuse = "./red"\nsize = 32\n'
    use = '[[pass]]\nname = "p"\nuse = "texturing/swatches"\ninputs = { first = "red" }\n'
    use += "set = { count = 1, tiles = 2 }\n"
    row = any_engine.read(make_sketch(text + use, size=64, red=stripes), "p")[30, :, 0].astype(float)
    np.testing.assert_array_equal(row.round(), (np.arange(64) % 32 < 16).astype(float))


def test_one_of_returns_chosen_colour_or_white(engine, make_sketch):
    use = (
        '[[pass]]\nname = "colour"\nuse = "texturing/one_of"\n'
        'inputs = { first = "red", second = "green", third = "blue" }\n'
    )
    sketch = make_sketch(SWATCHES + use, size=9, **FILES)
    for chosen, expected in enumerate([*np.eye(3), np.ones(3)]):
        colour = engine.read(sketch.with_values({"colour.chosen": chosen}), "colour")[..., :3]
        np.testing.assert_array_equal(colour, np.broadcast_to(expected, (9, 9, 3)))


def test_one_of_copies_same_size_colour_and_interpolates_coarser(engine, make_sketch):
    eastward = PLAIN.format("vec3(float(texel.x) / float(size.x - 1))")
    passes = '[[pass]]\nname = "fine"\nuse = "./red"\n[[pass]]\nname = "coarse"\nuse = "./red"\nsize = 3\n'
    use = '[[pass]]\nname = "c"\nuse = "texturing/one_of"\ninputs = { first = "fine", second = "coarse" }\n'
    sketch = make_sketch(passes + use, size=17, red=eastward)
    fine = engine.read(sketch, "fine")
    np.testing.assert_array_equal(engine.read(sketch, "c"), fine)
    coarse = engine.read(sketch.with_values({"c.chosen": 1}), "c")
    np.testing.assert_allclose(coarse.astype(float), fine.astype(float), atol=5e-3)
