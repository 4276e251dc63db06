"""Where a window goes on the screens that there are, and files dropped on it, as GLFW reports them."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.studio.window import WindowPlacement, on_screen


def test_what_is_dropped_is_taken_once(monkeypatch: pytest.MonkeyPatch) -> None:
    listening = []
    monkeypatch.setattr("glfw.set_drop_callback", lambda handle, act: listening.append((handle, act)))
    handles = ["first"]
    window_placement = WindowPlacement(lambda: handles[0])
    assert window_placement.dropped() == []
    listening[0][1]("first", ["/a/b.png", "/c"])
    assert window_placement.dropped() == [Path("/a/b.png"), Path("/c")] and window_placement.dropped() == []
    handles[0] = "second"  # the window was opened again
    window_placement.dropped()
    assert [handle for handle, _ in listening] == ["first", "second"]


LEFT, RIGHT = (0, 0, 1920, 1080), (1920, -200, 1280, 1024)


@pytest.mark.parametrize(
    ("window", "areas", "expected"),
    [
        ((100, 200, 800, 600), [LEFT], (100, 200)),
        ((1500, 100, 800, 600), [LEFT, RIGHT], (1500, 100)),  # on both, and all of it
        ((-50, 700, 800, 600), [LEFT], (0, 480)),
        ((1900, 100, 800, 600), [LEFT], (1120, 100)),
        ((2500, 300, 800, 600), [LEFT], (1120, 300)),  # its screen is gone
        ((2500, 300, 800, 600), [LEFT, RIGHT], (2400, 224)),
        ((-3000, -3000, 800, 600), [RIGHT], (1920, -200)),
        ((50, 50, 3000, 2000), [LEFT], (0, 0)),  # larger than the screen: its title bar shows
        ((50, 50, 800, 600), [], (50, 50)),
    ],
)
def test_a_window_comes_back_where_a_screen_shows_it(window, areas, expected):
    assert on_screen(window, areas) == expected
