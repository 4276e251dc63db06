"""Three lights on one terrain: each part of the picture is that light's own."""

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
    three="lighting/height_difference",
)
NAMES = ("one", "two", "three")


@pytest.fixture
def pictures(make_sketch, any_engine: Engine):
    lights = ", ".join(
        f'light_{where} = "{name}"' for where, name in zip(("left", "middle", "right"), NAMES, strict=True)
    )
    together = make_sketch(f'{TERRAIN}[view]\nuse = "view/three"\ninputs = {{ {lights} }}\n')
    alone = [
        make_sketch(f'{TERRAIN}[view]\nuse = "view/terrain"\ninputs = {{ light = "{name}" }}\n')
        for name in NAMES
    ]
    return together, [any_engine.render(sketch, size=SIZE).array for sketch in alone]


@pytest.mark.parametrize("lines", [(1 / 3, 2 / 3), (0.2, 0.25), (0.5, 0.5)], ids=str)
def test_each_part_is_the_picture_of_its_light(any_engine, pictures, lines):
    together, alone = pictures
    changed = together.with_values({"view.first": lines[0], "view.second": lines[1]})
    array = any_engine.render(changed, size=SIZE).array
    middles = np.arange(SIZE[0]) + 0.5
    first, second = lines[0] * SIZE[0], lines[1] * SIZE[0]
    away = np.minimum(np.abs(middles - first), np.abs(middles - second))
    parts = (middles < first, (middles > first) & (middles < second), middles > second)
    for part, picture in zip(parts, alone, strict=True):
        part &= away > 2
        np.testing.assert_array_equal(array[:, part], picture[:, part])
    assert (array[:, away < 0.99, :3] == 255).all()
    assert not array[:, (away > 1.01) & (away < 1.99), :3].any()


@pytest.mark.parametrize(("lines", "which"), [((1, 1), 0), ((0, 1), 1), ((0, 0), 2), ((1, 0), 0)], ids=str)
def test_a_picture_alone_has_no_line(any_engine, pictures, lines, which):
    together, alone = pictures
    changed = together.with_values({"view.first": float(lines[0]), "view.second": float(lines[1])})
    np.testing.assert_array_equal(any_engine.render(changed, size=SIZE).array, alone[which])
