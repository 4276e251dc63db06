"""Keys that come fast: each has a frame, and an empty one after it, however slow the frames are."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import glfw
import pytest
from imgui_bundle import ImVec2, imgui

from playground.studio.key_queue import KeyQueue

KEYS = {
    glfw.KEY_DOWN: imgui.Key.down_arrow,
    glfw.KEY_END: imgui.Key.end,
    glfw.KEY_LEFT: imgui.Key.left_arrow,
    glfw.KEY_ENTER: imgui.Key.enter,
}
Press = Callable[..., None]


@pytest.fixture
def press(monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[KeyQueue, Press]]:
    """Give a queue, and what presses a key and lets it go between two frames."""
    heard: dict[str, Any] = {}
    monkeypatch.setattr(glfw, "set_key_callback", lambda _, call: heard.update(key=call))
    monkeypatch.setattr(glfw, "set_char_callback", lambda _, call: heard.update(char=call))
    context = imgui.create_context()
    io = imgui.get_io()
    io.set_ini_filename("")
    io.display_size = ImVec2(640, 480)
    io.backend_flags |= imgui.BackendFlags_.renderer_has_textures
    queue = KeyQueue()
    queue.listen(None)

    def press(key: int, letter: str = "") -> None:
        for action in (glfw.PRESS, glfw.RELEASE):
            heard["key"](None, key, 0, action, 0)
            if letter and action == glfw.PRESS:
                heard["char"](None, ord(letter))

    yield queue, press
    imgui.destroy_context(context)


def frames(queue: KeyQueue, before: Callable[[int], None] = lambda _: None) -> list[list[int]]:
    """Draw frames until no key waits; return the keys that are pressed in each.

    ``before`` is called before each, with its number.
    """
    seen: list[list[int]] = []
    while queue.waits or not seen or seen[-1]:
        before(len(seen))
        queue.feed()
        imgui.new_frame()
        seen.append([key for key, named in KEYS.items() if imgui.is_key_pressed(named, repeat=False)])
        imgui.end_frame()
        assert len(seen) < 100
    return seen


@pytest.mark.parametrize(
    "keys",
    [
        [glfw.KEY_DOWN] * 6 + [glfw.KEY_END, glfw.KEY_LEFT],
        [glfw.KEY_END, glfw.KEY_ENTER, glfw.KEY_ENTER, glfw.KEY_LEFT],
        [glfw.KEY_LEFT, glfw.KEY_DOWN, glfw.KEY_LEFT, glfw.KEY_DOWN],
    ],
    ids=["one key again and again", "Enter twice", "in turn"],
)
def test_each_key_has_an_empty_frame_after_it(press: tuple[KeyQueue, Press], keys: list[int]) -> None:
    queue, tap = press
    for key in keys:
        tap(key)
    seen = frames(queue)
    assert [key for frame in seen for key in frame] == keys
    for frame, after in pairwise(seen):
        assert len(frame) < 2 and not (frame and after), seen


def test_a_click_before_a_key_takes_no_frame_from_it(press: tuple[KeyQueue, Press]) -> None:
    queue, tap = press
    io = imgui.get_io()
    io.add_mouse_pos_event(20, 20)
    io.add_mouse_button_event(0, True)
    io.add_mouse_button_event(0, False)
    tap(glfw.KEY_END)
    tap(glfw.KEY_ENTER)
    seen = frames(queue)
    assert [key for frame in seen for key in frame] == [glfw.KEY_END, glfw.KEY_ENTER]
    for frame, after in pairwise(seen):
        assert not (frame and after), seen


def test_a_mouse_that_moves_holds_up_no_key(press: tuple[KeyQueue, Press]) -> None:
    queue, tap = press
    keys = [glfw.KEY_END, glfw.KEY_DOWN, glfw.KEY_DOWN]
    for key in keys:
        tap(key)

    def move(number: int) -> None:
        for x in (700, 20 + number):  # as where it is outside, and the picture's cursor is in its place
            imgui.get_io().add_mouse_pos_event(x, 20)

    assert [key for frame in frames(queue, move) for key in frame] == keys


def test_a_key_after_ctrl_is_not_pressed_with_it(
    monkeypatch: pytest.MonkeyPatch, press: tuple[KeyQueue, Press]
) -> None:
    queue, tap = press
    monkeypatch.setattr(glfw, "get_key_name", lambda *_: "e")
    tap(glfw.KEY_LEFT_CONTROL)
    tap(glfw.KEY_E, letter="e")
    seen = []
    while queue.waits or len(seen) < 3:
        queue.feed()
        imgui.new_frame()
        seen.append((imgui.is_key_released(imgui.Key.mod_ctrl), imgui.is_key_pressed(imgui.Key.e)))
        imgui.end_frame()
    assert (True, False) in seen and (False, True) in seen and (True, True) not in seen
