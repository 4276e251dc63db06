"""A drag ends where the mouse was let go, also where one frame brings the movement and the release."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from imgui_bundle import ImVec2, imgui

from playground.studio.window import after_events, before_release

WIDE, PAD = 400.0, 10.0


class Slider:
    """A slider from 0 to 1 over a window without a screen."""

    def __init__(self) -> None:
        self.value = 0.0
        self.frames()

    def frame(self) -> None:
        imgui.new_frame()
        imgui.set_next_window_pos(ImVec2(0, 0))
        imgui.set_next_window_size(ImVec2(500, 100))
        imgui.begin("w")
        imgui.set_cursor_screen_pos(ImVec2(PAD, 40))
        imgui.set_next_item_width(WIDE)
        _, self.value = imgui.slider_float("##s", self.value, 0.0, 1.0)
        imgui.end()
        imgui.render()
        for texture in imgui.get_platform_io().textures:
            texture.set_status(imgui.ImTextureStatus.ok)

    def frames(self) -> float:
        for _ in range(5):
            self.frame()
        return self.value


@pytest.fixture
def slider() -> Iterator[Slider]:
    context = imgui.create_context()
    io = imgui.get_io()
    io.set_ini_filename("")
    io.display_size = ImVec2(500, 100)
    io.backend_flags |= imgui.BackendFlags_.renderer_has_textures
    yield Slider()
    imgui.destroy_context(context)


def move(share: float) -> tuple[float, float]:
    position = PAD + share * WIDE, 48.0
    imgui.get_io().add_mouse_pos_event(*position)
    return position


def test_drag_ends_at_release_position_at_any_frame_rate(slider: Slider) -> None:
    io = imgui.get_io()
    move(0.2)
    slider.frames()
    io.add_mouse_button_event(0, True)
    slider.frames()
    move(0.4)
    position = move(0.75)
    before_release(position)
    io.add_mouse_button_event(0, False)
    move(0.3)  # what comes later is no part of it
    after_events()
    # A knob's middle stays away from the ends, so the share is not quite the mouse's.
    assert slider.frames() == pytest.approx(0.75, abs=0.02)
    assert not imgui.is_mouse_down(0) and io.mouse_pos.x == pytest.approx(PAD + 0.3 * WIDE)
    move(0.9)
    assert slider.frames() == pytest.approx(0.75, abs=0.02)
    assert io.mouse_source == imgui.MouseSource.mouse


def test_a_release_at_rest_is_the_mouses_own(slider: Slider) -> None:
    io = imgui.get_io()
    position = move(0.5)
    slider.frames()
    io.add_mouse_button_event(0, True)
    slider.frames()
    before_release(position)
    io.add_mouse_button_event(0, False)
    after_events()
    slider.frame()
    assert not imgui.is_mouse_down(0) and io.mouse_source == imgui.MouseSource.mouse
