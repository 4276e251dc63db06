"""The size of the interface: by keys, on any keyboard, remembered from one start to the next."""

from __future__ import annotations

from pathlib import Path

from imgui_bundle import imgui

from playground.studio.interface import SIZES, InterfaceSize, remembered_size

from ..cases import each
from ..sketch_texts import map_of_height
from .panel_desk import Bare

TERRAIN = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) { return 0.5; }\n'


FILES = {"terrain.glsl": TERRAIN, "sketch.toml": "format = 1\nsize = 17\n" + map_of_height()}


@each(
    ("keys", "size"),
    [
        ((imgui.Key.equal,), 1.1),
        ((imgui.Key.mod_shift, imgui.Key.equal), 1.1),
        ((imgui.Key.keypad_add,), 1.1),
        ((imgui.Key.minus,), 0.9),
        ((imgui.Key.keypad_subtract,), 0.9),
        ((imgui.Key.right_bracket,), 1.0),
    ],
)
def test_ctrl_plus_and_minus_change_the_size(bare: Bare, keys: tuple[imgui.Key, ...], size: float) -> None:
    bare.key(imgui.Key.mod_ctrl, *keys)
    assert bare.bench.interface.size.size == size
    bare.key(imgui.Key.mod_ctrl, imgui.Key._0)
    assert bare.bench.interface.size.size == 1.0
    bare.key(*keys)
    assert bare.bench.interface.size.size == 1.0, "without Ctrl they are no such keys"


def test_a_keyboard_whose_plus_is_elsewhere_has_it_there(bare: Bare) -> None:
    bare.bench.window.sign_held = lambda: "+"
    bare.key(imgui.Key.mod_ctrl, imgui.Key.right_bracket)  # as on a German keyboard
    assert bare.bench.interface.size.size == 1.1
    bare.key(imgui.Key.mod_ctrl, imgui.Key.minus)  # as on a Swedish one
    assert bare.bench.interface.size.size == 1.25


def test_it_ends_at_the_smallest_and_at_the_largest() -> None:
    size = InterfaceSize()
    for _ in range(20):
        size.step(1)
    assert size.size == SIZES[-1]
    for _ in range(20):
        size.step(-1)
    assert size.size == SIZES[0]


def test_interface_size_persists_and_invalid_file_uses_default(tmp_path: Path) -> None:
    assert remembered_size(tmp_path).size == 1.0
    remembered_size(tmp_path).step(1)
    assert remembered_size(tmp_path).size == 1.1
    for text in (
        "",
        "{",
        "[]",
        '{"format": 1, "size": "nan"}',
        '{"format": 2, "size": 2.0}',
        '{"format": 1}',
    ):
        (tmp_path / "interface.json").write_text(text, encoding="utf-8")
        assert remembered_size(tmp_path).size == 1.0, text
