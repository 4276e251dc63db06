"""A part of the window that fails is left out, and the rest is drawn as if nothing had been."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from imgui_bundle import ImVec2, imgui

from playground.studio.guard import Guard


def ended_too_soon() -> None:
    imgui.begin("left open")
    imgui.push_id("an id")
    imgui.push_style_color(imgui.Col_.text, (1.0, 0.0, 0.0, 1.0))
    imgui.push_style_var(imgui.StyleVar_.alpha, 0.5)
    imgui.begin_child("a child")
    imgui.begin_group()
    imgui.begin_disabled()
    raise ValueError("this cannot be drawn")


def empty_id() -> None:
    imgui.begin("left open")
    imgui.tree_node_ex("###")


def table() -> None:
    imgui.begin("left open")
    if imgui.begin_table("table", 2):
        imgui.table_next_column()
    raise IndexError("no such row")


def popup() -> None:
    imgui.begin("left open")
    imgui.open_popup("popup")
    if imgui.begin_popup("popup"):
        imgui.push_item_width(20)
        imgui.push_text_wrap_pos(4)
    raise KeyError("gone")


def font() -> None:
    imgui.begin("left open")
    imgui.push_font(imgui.get_font(), 20)
    imgui.begin_tooltip()
    raise RuntimeError("no glyph")


def ended_twice() -> None:
    imgui.end()


BUGS = (ended_too_soon, empty_id, table, popup, font, ended_twice)


@pytest.fixture
def interface() -> Iterator[None]:
    context = imgui.create_context()
    io = imgui.get_io()
    io.set_ini_filename("")
    io.display_size = ImVec2(640, 480)
    io.backend_flags |= imgui.BackendFlags_.renderer_has_textures
    yield
    imgui.destroy_context(context)


def draw_frame(draw: Callable[[], None]) -> tuple[float, int]:
    """Draw one frame; return where a button after it is, and how wide it is."""
    imgui.get_io().delta_time = 1 / 60
    imgui.new_frame()
    draw()
    imgui.set_next_window_pos(ImVec2(10, 10))
    imgui.begin("the next part")
    imgui.button("as always")
    result = imgui.get_item_rect_min().y, imgui.get_item_rect_size().x
    imgui.end()
    imgui.render()
    for texture in imgui.get_platform_io().textures:
        texture.set_status(imgui.ImTextureStatus.ok)
    return result


@pytest.mark.parametrize("bug", BUGS, ids=lambda bug: bug.__name__)
def test_panel_bug_becomes_notice_and_next_part_is_drawn(
    interface: None, bug: Callable[[], None], caplog: pytest.LogCaptureFixture
) -> None:
    notices: list[str] = []
    guard = Guard(notices.append)
    draw_frame(lambda: None)
    usual = draw_frame(lambda: None)
    with caplog.at_level(logging.ERROR):
        for _ in range(3):
            assert draw_frame(lambda: guard.draw("the part", bug, None)) == usual
    assert len(notices) == 3 and all("the part failed" in notice for notice in notices)
    assert len(caplog.records) == 1, "reported once in the terminal"
    assert caplog.records[0].exc_info is not None


def test_what_is_left_open_without_a_bug_is_ended(interface: None) -> None:
    notices: list[str] = []
    guard = Guard(notices.append)
    draw_frame(lambda: None)
    usual = draw_frame(lambda: None)

    def draw() -> int:
        imgui.begin("left open")
        imgui.push_id("an id")
        return 7

    numbers: list[int] = []
    assert draw_frame(lambda: numbers.append(guard.draw("the part", draw, 0))) == usual
    assert numbers == [7]


def test_interrupting_is_no_bug(interface: None) -> None:
    def stop() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        Guard(print).run("the part", stop, None)


def test_a_part_that_draws_nothing_returns_its_default(tmp_path: Path) -> None:
    notices: list[str] = []
    assert Guard(notices.append).run("reading", lambda: len((tmp_path / "gone").read_bytes()), -1) == -1
    assert notices and "reading failed" in notices[0]
