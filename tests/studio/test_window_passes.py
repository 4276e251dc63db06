"""Passes in a real window: added, wired, muted, deleted by mouse and keys, and undone byte for byte."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from .screen import HILLS, ON_LINUX, Program, Screen

pytestmark = [*ON_LINUX, pytest.mark.slow]
SCREEN = 1280, 720
# It writes where each node and button is, by its label.
RUN = """
import json, sys
from pathlib import Path
from imgui_bundle import imgui
from playground.studio.app import run
places = {}
def noting(draw):
    def noted(label, *rest):
        answer = draw(label, *rest)
        low, size = imgui.get_item_rect_min(), imgui.get_item_rect_size()
        place = low.x, low.y, size.x, size.y
        if places.get(label) != place:
            places[label] = place
            Path("places.json").write_text(json.dumps(places))
        return answer
    return noted
for name in ("button", "invisible_button", "selectable"):
    setattr(imgui, name, noting(getattr(imgui, name)))
sys.exit(run(sys.argv[1], size=(1280, 720), time_limit=600))
"""
TERRAIN = """// terrain.glsl -- steps
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return float((texel.x / 16 + texel.y / 16) % 2); }
"""
PIN = 6  # [pixels] that an output is right of what a click on its node takes


class Passes(Program):
    """A window on a sketch of one pass."""

    def __init__(self, screen: Screen, folder: Path) -> None:
        self.file = folder / "steps" / "sketch.toml"
        self.file.parent.mkdir()
        self.file.write_text(HILLS, encoding="utf-8")
        (self.file.parent / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
        self.places = folder / "places.json"
        super().__init__(
            screen, folder, [sys.executable, "-c", RUN, str(self.file.parent)], folder, strip=True
        )
        self.wait(lambda now: now["draws"] > 0)

    def text(self) -> str:
        return self.file.read_text(encoding="utf-8")

    def changes(self, picture: str) -> str:
        now = self.wait(lambda now: now["picture"] not in ("", picture) and not now["error"])
        return str(now["picture"])

    def becomes(self, text: str) -> None:
        """Wait until the file says so, and the picture is of it."""
        self.wait(lambda now: self.text() == text and now["stage"] == "NONE")

    def at(self, label: str, across: float = 0.5) -> tuple[int, int]:
        """Return where something stays."""
        before, end = (0.0, 0.0, 0.0, 0.0), time.monotonic() + 20
        while time.monotonic() < end:
            time.sleep(0.3)
            try:
                place = tuple(json.loads(self.places.read_text("utf-8")).get(label, (0.0, 0.0, 0.0, 0.0)))
            except ValueError:
                continue
            if place == before and place[2]:
                return round(place[0] + across * place[2]), round(place[1] + place[3] / 2)
            before = place
        pytest.fail(f"nothing like {label}")


@pytest.fixture
def app(screen: Screen, tmp_path: Path) -> Iterator[Passes]:
    made = Passes(screen, tmp_path)
    yield made
    made.close()


def test_tour_of_passes(app: Passes) -> None:
    do, first = app.screen.do, app.wait(lambda now: now["picture"])["picture"]
    do("mousemove", *app.at("node height"), "click", 1)
    app.wait(lambda now: now["layers"] == ["passes"])

    do("key", "plus")
    app.wait(lambda now: now["takes_text"])
    do("type", "smooth")
    time.sleep(2.0)
    do("key", "Return")
    smooth = app.changes(first)
    added = app.text()
    assert 'use    = "generation/smooth"\ninputs = { height = "height" }\n' in added

    do("key", "m")  # the new node is chosen
    muted = app.changes(smooth)
    do("key", "m")
    app.changes(muted)
    assert app.text() == added

    left, top = app.at("node height", 1.0)
    do("mousemove", left + PIN, top, "mousedown", 1)
    for share in (0.3, 0.5):
        do("mousemove", *app.at("node view", share))
        time.sleep(0.3)
    do("mouseup", 1)
    app.wait(lambda now: app.text() != added)
    assert 'inputs = { height = "height" }' in app.text().partition("[view]")[2]
    do("key", "ctrl+z")
    app.becomes(added)

    do("mousemove", *app.at("node smooth"), "click", 1, "key", "Delete")
    app.wait(lambda now: "smooth" not in app.text())
    do("key", "ctrl+z")
    app.becomes(added)
    do("key", "ctrl+z")
    app.becomes(HILLS)

    time.sleep(1.0)  # until the graph fits its pane again
    x, y = app.at("node height", 0.2)
    do("mousemove", x, y)
    time.sleep(0.3)
    do("mousedown", 1)
    for step in (20, 60):
        do("mousemove", x - step, y - step // 4)
        time.sleep(0.3)
    do("mouseup", 1)
    moved = app.at("node height", 0.2)
    assert abs(moved[0] - x + 60) < 3 and abs(moved[1] - y + 15) < 3 and app.text() == HILLS
    do("key", "Escape", "key", "ctrl+q")
    assert app.ended() == 0, app.complaint()
    kept = [
        json.loads(path.read_text("utf-8")) for path in app.file.parents[1].rglob("state/**/sketch-*.json")
    ]
    assert [node for state in kept for node, _ in state["kept"]["places"]] == ["height"]
