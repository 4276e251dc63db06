"""The brush over the picture, by mouse, wheel and keys, without a screen."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path

import pytest
from imgui_bundle import imgui

from playground.studio.mouse import PictureMouse
from playground.studio.paint.layer import NUMBERS

from ..sketch_texts import passes
from .panel_desk import Bare

FILES = {
    "sketch.toml": 'format = 1\nsize = 65\nextent = 1000.0\nrelief = 200.0\nmain = ["height.amount"]\n'
    + passes(
        hills="generation/layered_noise",
        rain="erosion/painted_factor",
        mask="texturing/alpha_map/mask",
        height="generation/sculpted",
    ).replace('use = "generation/sculpted"', 'use = "generation/sculpted"\ninputs = { height = "hills" }')
    + '[view]\nuse = "view/terrain"\nsamples = 1\n'
    + "camera = { azimuth = 180, elevation = 89, distance = 900 }\n"
}
_K = imgui.Key
AREA = (0.0, 0.0, 1280.0, 720.0)
Act = Callable[..., None]


@pytest.fixture
def act(bare: Bare, tmp_path: Path) -> Iterator[Act]:
    """Give a function that draws a frame of the picture's mouse at (700, 360)."""
    painting, io = bare.bench.painting, imgui.get_io()
    painting.folder, painting._now = tmp_path, lambda: bare.time
    hand = PictureMouse(bare.session, painting)

    def frame(*, down: bool = False, wheel: float = 0.0, keys: tuple[imgui.Key, ...] = ()) -> None:
        bare.time += 0.05
        io.add_mouse_pos_event(700, 360)
        io.add_mouse_button_event(0, down)
        for key in keys:
            io.add_key_event(key, True)
        io.add_mouse_wheel_event(0.0, wheel)
        imgui.new_frame()
        hand.act(AREA, 1.0)
        imgui.render()
        for texture in imgui.get_platform_io().textures:
            texture.set_status(imgui.ImTextureStatus.ok)
        bare.session.frame((48, 32))
        for key in keys:
            io.add_key_event(key, False)

    yield frame


def test_the_wheel_and_keys_change_the_brush(bare: Bare, act: Act) -> None:
    painting = bare.bench.painting
    before = painting.brush
    bare.type("]")
    assert painting.brush == before, "the brush is not taken"
    bare.key(_K.b)
    first, camera = painting.brush, bare.session.sketch.camera
    act(wheel=1.0, keys=(_K.mod_ctrl,))
    assert painting.brush.radius == pytest.approx(first.radius * 1.1)
    act(wheel=-2.0, keys=(_K.mod_shift,))
    assert painting.brush.strength == pytest.approx(first.strength - 0.1)
    act(wheel=1.0, keys=(_K.mod_ctrl, _K.mod_shift))
    assert painting.brush.softness == pytest.approx(first.softness + 0.05)
    assert bare.session.sketch.camera == camera, "the wheel was the brush's"
    bare.run_frames(2)  # Ctrl and Shift are up
    bare.type("[}<")
    assert painting.brush.radius == pytest.approx(first.radius)
    assert painting.brush.strength == pytest.approx(first.strength - 0.05)
    assert painting.brush.softness == pytest.approx(first.softness)
    bare.type("[" * 60 + "}" * 40 + "<" * 40)
    assert painting.brush.radius == pytest.approx(2.0) and painting.brush.strength == 1
    assert painting.brush.softness == 0
    act(wheel=1.0)
    assert bare.session.sketch.camera != camera


def test_the_panel_offers_tools_for_heights_and_layers_for_masks(bare: Bare) -> None:
    painting = bare.bench.painting
    bare.key(_K.b)
    assert set(painting.targets) == {"height.image", "rain.image", "mask.image"}
    for target, row, other in (
        ("height.image", "##tool", "##layer"),
        ("rain.image", "##tool", "##layer"),
        ("mask.image", "##layer", "##tool"),
    ):
        painting.choose(target)
        bare.places.clear()
        bare.run_frames(2)
        assert row in bare.places and other not in bare.places and "##target" in bare.places
        bare.type("4")
        assert (painting.brush.tool == "flatten") == (row == "##tool")
        bare.run_frames(1)
        assert ("##stated" in bare.places) == (row == "##tool")
        bare.type("7")
        assert (painting.brush.tool == "erode") == (target == "height.image"), "a factor has no ground"
        bare.type("1")


def test_held_brush_paints_without_mouse_motion(bare: Bare, act: Act) -> None:
    painting = bare.bench.painting
    bare.key(_K.b)
    painting.choose("height.image")
    heights = []
    act()
    for _ in range(4):
        act(down=True)
        assert painting.layer is not None and painting.layer.kind is NUMBERS
        heights.append(float(painting.layer.pixels.max()))
    assert all(a < b for a, b in pairwise(heights))
    act()
    assert painting.layer is not None and painting.layer.saved and painting.layer.can_undo
    bare.key(_K.mod_ctrl, _K.z)
    assert not painting.layer.pixels.any()
