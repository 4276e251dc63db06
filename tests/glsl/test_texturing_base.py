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
    wanted = np.empty((24, 44, 3))
    wanted[:] = (0.5, 0.25, 0.125)
    for place, name in enumerate(order):
        left = 24 * place
        wanted[2:22, left : left + 20] = np.eye(3)[list(COLOURS).index(name)]
    np.testing.assert_array_equal(picture, wanted)


def test_a_swatch_shows_the_whole_image_as_often_as_asked(any_engine, make_sketch):
    stripes = PLAIN.format("vec3(float(texel.x < 16))")
    text = '[[pass]]\nname = "red"\nuse = "./red"\nsize = 32\n'
    use = '[[pass]]\nname = "p"\nuse = "texturing/swatches"\ninputs = { first = "red" }\n'
    use += "set = { count = 1, tiles = 2 }\n"
    row = any_engine.read(make_sketch(text + use, size=64, red=stripes), "p")[30, :, 0].astype(float)
    np.testing.assert_array_equal(row.round(), (np.arange(64) % 32 < 16).astype(float))
