"""A trace in a real window: mouse and keys by xdotool, a hunt for NaN, a probe, a save; the picture stays."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from .saves import save_in_place
from .screen import HILLS, LIMIT, ON_LINUX, Program, Screen

pytestmark = [*ON_LINUX, pytest.mark.slow]
SCREEN = 1280, 720
# It writes where each button and field is, by its label.
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
        place = round(low.x + size.x / 2), round(low.y + size.y / 2)
        if places.get(label) != place:
            places[label] = place
            Path("places.json").write_text(json.dumps(places))
        return answer
    return noted
for name in ("button", "small_button", "input_text_with_hint"):
    setattr(imgui, name, noting(getattr(imgui, name)))
sys.exit(run(sys.argv[1], size=(1280, 720), time_limit=600))
"""
TERRAIN = """// terrain.glsl -- a crater whose rim is a square root
#pragma kernel(output = "height:r32f")
float rim(vec2 p) {
    float depth = 0.04 - dot(p, p);
    return sqrt(depth);
}
float kernel(ivec2 texel) {
    vec2 place = vec2(texel) / vec2(size - 1);
    float height = 0.0;
    for (int i = 0; i < 4; i++) {
        height += place.x / float(i + 1);
    }
    if (place.y > 0.75) height -= rim(place - 0.9);
    return height / 4.0;
}
"""
ROOT, HEAD = 5, 7
FREE = 700, 240  # a place of the map that no window covers
PANEL = 330  # [pixels] the panel's width
MAP = round(SCREEN[1] * (1 - 0.34))  # the map's height: below it is the strip, and at its right the code
ROOM = (SCREEN[0] - PANEL) * (1 - 0.45)  # the picture's width


class Traced(Program):
    """A window on a folder with the crater."""

    def __init__(self, screen: Screen, folder: Path) -> None:
        self.folder = folder / "crater"
        self.folder.mkdir()
        (self.folder / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
        (self.folder / "sketch.toml").write_text(HILLS, encoding="utf-8")
        super().__init__(screen, folder, [sys.executable, "-c", RUN, str(self.folder)], folder)
        self.wait(lambda now: now["draws"] > 0)

    def traced(self, condition: Any = lambda trace: True) -> dict[str, Any]:
        """Wait until there is a trace of which a condition holds."""

        def fits(now: dict[str, Any]) -> bool:
            trace = now.get("trace") or {}
            return bool(trace) and not trace["compiling"] and trace["traces"] > 0 and condition(trace)

        return dict(self.wait(fits)["trace"])

    def click(self, label: str) -> None:
        """Click on what has a label, once it stands still."""
        places = self.folder.parent / "places.json"
        before: object = None
        end = time.monotonic() + LIMIT
        while time.monotonic() < end:
            with suppress(json.JSONDecodeError):  # it is being written
                at = json.loads(places.read_text(encoding="utf-8")).get(label)
                if at is not None and at == before:
                    self.screen.do("mousemove", *at, "click", 1)
                    return
                before = at
            time.sleep(0.7)
        pytest.fail(f"there is no {label}")


@pytest.fixture
def window(screen: Screen, tmp_path: Path) -> Iterator[Traced]:
    made = Traced(screen, tmp_path)
    yield made
    made.close()


def texel_at(x: int, y: int) -> list[int]:
    """Return the texel that the map shows there: it is square, in the middle of the picture's place."""
    left = PANEL + (ROOM - MAP) / 2
    return [int((x + 0.5 - left) / MAP * 65), int((MAP - y - 0.5) / MAP * 65)]


def test_tour_of_a_trace(window: Traced) -> None:
    screen = window.screen
    screen.do("mousemove", *FREE, "key", "m")
    window.wait(lambda now: now["map"] and now["not_finite"])
    screen.do("key", "t")
    window.traced(lambda trace: trace["exact"] and trace["texel"] == texel_at(*FREE))
    before = window.now()
    it_follows_the_mouse_until_a_click_pins_it(window)
    now = window.now()
    assert (now["picture"], now["runs"], now["draws"]) == (before["picture"], before["runs"], before["draws"])
    a_number_that_is_not_finite_is_found(window)
    an_expression_becomes_a_map(window)
    a_save_is_traced_again(window)
    screen.do("mousemove", *FREE, "key", "Escape")
    window.wait(lambda now: not now["trace"] and "trace" not in now["layers"])
    screen.do("key", "ctrl+q")
    assert window.ended() == 0, window.complaint()


def it_follows_the_mouse_until_a_click_pins_it(window: Traced) -> None:
    x, y = FREE
    window.screen.do("mousemove", x + 50, y)
    window.traced(lambda trace: trace["texel"] == texel_at(x + 50, y))
    window.screen.do("click", 1, "mousemove", x - 100, y)
    time.sleep(1.0)
    assert window.traced()["texel"] == texel_at(x + 50, y)
    window.click("Unpin##pin")
    window.screen.do("mousemove", x - 100, y)
    window.traced(lambda trace: trace["texel"] == texel_at(x - 100, y))


def a_number_that_is_not_finite_is_found(window: Traced) -> None:
    window.click("Trace it")
    trace = window.traced(lambda trace: trace["line"] == ROOT)
    assert trace["texel"][1] > 0.75 * 64 and not trace["message"]


def an_expression_becomes_a_map(window: Traced) -> None:
    window.click("##probe")
    window.screen.do("type", "height > 1.0")
    window.click("First texel where it is true")
    window.wait(lambda now: now["trace"] and now["trace"]["probe"])
    # Behind the line of the root there is no such name: the driver says so, and the picture stays.
    now = window.now()
    assert "height" in now["trace"]["probe"] and now["map"] == "height:height" and not now["error"]
    window.click("kernel##call 0")  # the caret goes to its head
    window.traced(lambda trace: trace["line"] == HEAD)
    window.click("##probe")
    window.screen.do("key", "ctrl+a", "type", "texel.x > 60")
    window.click("First texel where it is true")
    trace = window.traced(lambda trace: trace["texel"] == [61, 0])
    assert window.now()["map"] == "height:probe" and "run 1" in trace["probe"]


def a_save_is_traced_again(window: Traced) -> None:
    count = window.traced()["traces"]
    text = TERRAIN.replace("float(i + 1)", "float(i + 2)")
    save_in_place(window.folder / "terrain.glsl", text.encode())
    trace = window.traced(lambda trace: trace["traces"] > count)
    assert trace["texel"] == [61, 0] and trace["exact"] and not window.now()["error"]
    window.click("Back to the picture")
    window.wait(lambda now: not now["map"])
