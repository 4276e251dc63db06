"""A window's place: kept for the next time, and never off the screen."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.live.place import Geometry, Place, remember, remembered, state_file, within

TWO = [(0, 0, 1920, 1080), (1920, 200, 1280, 1024)]


@pytest.mark.parametrize(
    ("wanted", "found"),
    [
        (Geometry(100, 50, 800, 600), Geometry(100, 50, 800, 600)),
        (Geometry(2000, 300, 800, 600, True), Geometry(2000, 300, 800, 600, True)),
        (Geometry(-700, 50, 800, 600), Geometry(-700, 50, 800, 600)),  # enough to take hold of
        (Geometry(-790, 50, 800, 600), Geometry(560, 240, 800, 600)),  # ten units only
        (Geometry(5000, 50, 800, 600), Geometry(560, 240, 800, 600)),  # that screen is gone
        (Geometry(100, -40, 800, 600), Geometry(560, 240, 800, 600)),  # its title is out of reach
        (Geometry(9000, 0, 4000, 3000), Geometry(0, 0, 1920, 1080)),
    ],
)
def test_a_window_comes_back_where_it_can_be_seen(wanted: Geometry, found: Geometry) -> None:
    assert within(wanted, TWO) == found


def test_without_a_screen_it_stays() -> None:
    assert within(Geometry(1, 2, 300, 400), []) == Geometry(1, 2, 300, 400)


def test_a_place_is_kept(tmp_path: Path) -> None:
    file, place = tmp_path / "new" / "window.json", Geometry(-5, 6, 700, 800, True)
    assert remembered(file) is None
    remember(file, place)
    assert remembered(file) == place
    (tmp_path / "file").write_text("", encoding="utf-8")
    remember(tmp_path / "file" / "window.json", place)  # nothing can be written there: nothing happens


BAD = (
    "",
    "{",
    "[]",
    "null",
    '{"x": 1}',
    '{"x": 1, "y": 2, "width": 1e9, "height": 500}',
    '{"x": 0, "y": 0, "width": 5, "height": 5}',
    '{"x": "a", "y": 0, "width": 500, "height": 500}',
)


@pytest.mark.parametrize("text", BAD)
def test_what_makes_no_sense_is_left(tmp_path: Path, text: str) -> None:
    (tmp_path / "window.json").write_text(text, encoding="utf-8")
    assert remembered(tmp_path / "window.json") is None


def test_it_is_kept_where_the_system_keeps_such_things() -> None:
    home, tail = Path("/home/me"), Path("terrain-shader-playground/window.json")
    assert state_file({}, "linux", home) == home / ".local/state" / tail
    assert state_file({"XDG_STATE_HOME": "/state"}, "linux", home) == Path("/state") / tail
    assert state_file({}, "darwin", home) == home / "Library/Application Support" / tail
    assert state_file({"LOCALAPPDATA": "/local"}, "win32", home) == Path("/local") / tail


def test_what_is_dropped_is_taken_once(monkeypatch: pytest.MonkeyPatch) -> None:
    listening = []
    monkeypatch.setattr("glfw.set_drop_callback", lambda handle, act: listening.append((handle, act)))
    handles = ["first"]
    place = Place(lambda: handles[0])
    assert place.dropped() == []
    listening[0][1]("first", ["/a/b.png", "/c"])
    assert place.dropped() == [Path("/a/b.png"), Path("/c")] and place.dropped() == []
    handles[0] = "second"  # the window was opened anew
    place.dropped()
    assert [handle for handle, _ in listening] == ["first", "second"]
