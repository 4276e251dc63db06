"""Two lights on one terrain: each side of the line is the picture of that light alone."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine.engine import Engine

from ..sketch_texts import passes

SIZE = (96, 64)
TERRAIN = "\n" + passes(
    height="generation/layered_noise",
    one="lighting/l_dot_n",
    two=("lighting/l_dot_n", "set = { gain = 0.5 }"),
)


@pytest.fixture
def pictures(make_sketch, any_engine: Engine):
    both = make_sketch(
        f'{TERRAIN}[view]\nuse = "view/compare"\ninputs = {{ light_left = "one", light_right = "two" }}\n'
    )
    alone = [
        make_sketch(f'{TERRAIN}[view]\nuse = "view/terrain"\ninputs = {{ light = "{name}" }}\n')
        for name in ("one", "two")
    ]
    return both, [any_engine.render(sketch, size=SIZE).array.astype(int) for sketch in alone]


def test_each_side_is_the_picture_of_its_light(any_engine, pictures):
    both, (item, two) = pictures
    assert np.abs(item - two).max() > 50
    for divider in (0.25, 0.5, 0.8):
        result = any_engine.render(both.with_values({"view.divider": divider}), size=SIZE).array.astype(int)
        line = divider * SIZE[0]
        middles = np.arange(SIZE[0]) + 0.5
        np.testing.assert_array_equal(result[:, middles < line - 2], item[:, middles < line - 2])
        np.testing.assert_array_equal(result[:, middles > line + 2], two[:, middles > line + 2])
        assert (result[:, np.abs(middles - line) < 1, :3] == 255).all()


def test_at_its_ends_the_line_is_gone(any_engine, pictures):
    both, (item, two) = pictures
    for divider, whole in ((1.0, item), (0.0, two)):
        array = any_engine.render(both.with_values({"view.divider": divider}), size=SIZE).array
        np.testing.assert_array_equal(array, whole)


def test_the_difference_is_grey_where_there_is_none_and_signed(any_engine, pictures):
    both, (item, two) = pictures
    changed = both.with_values({"view.mode": "difference", "view.amplified": 1.0})
    result = any_engine.render(changed, size=SIZE).array.astype(int)
    expected = np.clip(127.5 + 0.5 * (two - item), 0, 255)[..., :3]
    np.testing.assert_allclose(result[..., :3], expected, atol=1.01)


def test_variants_have_all_of_their_own(make_sketch, any_engine):
    text = passes(
        hills="generation/layered_noise",
        rough="generation/diamond_square",
        green=("texturing/grass", "size = 32"),
        brown=("texturing/mud", "size = 32"),
        sun=("lighting/l_dot_n", 'inputs = { height = "hills" }'),
        moon=("lighting/l_dot_n", 'inputs = { height = "rough" }', "set = { gain = 0.6 }"),
    )
    of = {"left": ("hills", "green", "sun"), "right": ("rough", "brown", "moon")}
    wires = ", ".join(
        f'{kind}_{side} = "{name}"'
        for side, names in of.items()
        for kind, name in zip(("height", "colour", "light"), names, strict=True)
    )
    both = make_sketch(f'{text}[view]\nuse = "view/variants"\ninputs = {{ {wires} }}\n', size=33)
    for divider, (height, colour, light) in ((1.0, of["left"]), (0.0, of["right"])):
        alone = make_sketch(
            f'{text}[view]\nuse = "view/terrain"\n'
            f'inputs = {{ height = "{height}", colour = "{colour}", light = "{light}" }}\n',
            size=33,
        )
        array = any_engine.render(both.with_values({"view.divider": divider}), size=SIZE).array
        np.testing.assert_array_equal(array, any_engine.render(alone, size=SIZE).array)
