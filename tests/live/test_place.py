"""Files dropped on a window, as GLFW tells of them."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.live.place import Place


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
