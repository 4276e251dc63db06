"""A whole round of the window by the keyboard alone: no mouse is moved, no button of one pressed."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from playground.paths import NAME

from ..sketch_texts import passes, use
from .screen import LIMIT, ON_LINUX, Program, Screen

pytestmark = [*ON_LINUX, pytest.mark.slow]
SCREEN = 1280, 720

# The window, with the label of the control that shows the focus in a file.
RUN = """
import sys
from pathlib import Path
from imgui_bundle import imgui
from playground.studio import focus
from playground.studio.app import run
def noting(draw):
    def noted(label, *rest):
        answer = draw(label, *rest)
        if focus.is_shown() and imgui.get_item_id() == imgui.get_current_context().nav_id:
            Path("focus.txt").write_text(label, encoding="utf-8")
        return answer
    return noted
for name in ("button", "small_button", "checkbox", "begin_combo", "slider_float", "slider_int",
             "collapsing_header", "radio_button", "invisible_button", "input_text_with_hint",
             "begin_tab_item", "menu_item_simple", "selectable", "text_link", "tree_node_ex"):
    setattr(imgui, name, noting(getattr(imgui, name)))
sketch = "".join(sys.argv[1:])
sys.exit(run(sketch, size=(1280, 720), start_page=not sketch, time_limit=600))
"""
PAINTED = (
    'format = 1\nsize = 65\nextent = 1000.0\nrelief = 200.0\nmain = ["height.amount"]\n'
    + passes(
        hills="generation/layered_noise",
        height=use("generation/sculpted", inputs={"height": "hills"}),
        light="lighting/l_dot_n",
    )
    + '[view]\nuse = "view/terrain"\nsamples = 1\n'
    + "camera = { azimuth = 180, elevation = 89, distance = 900 }\n"
)


class Keyboard(Program):
    """The window, and what a person does who has no mouse."""

    def __init__(self, screen: Screen, folder: Path, sketch: str = "") -> None:
        self.folder = folder / "work"
        self.folder.mkdir()
        command = [sys.executable, "-c", RUN]
        if sketch:
            (self.folder / "sketch.toml").write_text(sketch, encoding="utf-8")
            command.append("sketch.toml")
        super().__init__(screen, folder, command, self.folder, code=True, strip=True)
        screen.do("mousemove", SCREEN[0] - 1, SCREEN[1] - 1)  # it stays in the corner

    def press(self, *keys: str) -> None:
        for key in keys:
            self.screen.do("key", key)

    def focused(self) -> str:
        file = self.folder / "focus.txt"
        return file.read_text("utf-8") if file.exists() else ""

    def walk(self, to: str) -> None:
        """Press Tab until a control whose label has these letters shows the focus."""
        for _ in range(60):
            before = self.focused()
            self.press("Tab")
            end = time.monotonic() + 2.0  # two controls in a row may have one label
            while self.focused() in ("", before) and time.monotonic() < end:
                time.sleep(0.02)
            if to in self.focused():
                return
        pytest.fail(f"Tab never comes to {to}; {self.now()}")

    def settled(self) -> str:
        """Return the picture's hash, once none was drawn for a while: the first may be a preview."""
        now, since = self.now(), time.monotonic()
        while time.monotonic() < since + 1.5:
            time.sleep(0.05)
            if self.now()["draws"] != now["draws"]:
                now, since = self.now(), time.monotonic()
        return str(now["picture"])

    def remembered(self, name: str) -> object:
        file = self.folder.parent / "state" / NAME / "interface.json"
        return json.loads(file.read_text("utf-8")).get(name)


@pytest.fixture
def window(screen: Screen, tmp_path: Path) -> Iterator[Keyboard]:
    made = Keyboard(screen, tmp_path)
    made.wait(lambda now: "start page" in now["layers"] and now["takes_text"])
    yield made
    made.close()


def test_a_whole_round_without_a_mouse(window: Keyboard) -> None:
    window.walk("###new")
    window.press("space")
    window.wait(lambda now: "popup" in now["layers"])
    window.press("Down", "Return")
    now = window.wait(lambda now: now["draws"] > 0 and "start page" not in now["layers"])
    assert (window.folder / "my-land" / "sketch.toml").is_file(), now

    first = now["picture"]
    window.walk("##colour.strength")
    window.press("space", "Right", "Right", "Right", "space")
    edited = window.wait(lambda now: now["edited"] and now["picture"] != first)["edited"]
    assert all(path == "colour.strength" for path in edited)
    window.press("Escape", "ctrl+z")
    window.wait(lambda now: not now["edited"])

    window.press("ctrl+e", "ctrl+e")
    window.wait(lambda now: now["typing"])
    window.screen.do("type", "--delay", 60, "// mine ")
    window.wait(lambda now: now["unsaved"])
    window.press("ctrl+s")
    window.wait(lambda now: not now["unsaved"])

    window.press("Escape")
    window.wait(lambda now: not now["typing"])
    window.press("v", "ctrl+shift+Tab")  # the last pane is the strip
    window.walk("version ")
    window.press("space")
    window.wait(lambda now: now["looked"])
    window.press("Escape", "Escape")
    window.wait(lambda now: not now["looked"])

    window.press("F10")
    window.wait(lambda now: "popup" in now["layers"])
    window.walk("###language fr")
    window.press("space")
    end = time.monotonic() + LIMIT
    while window.remembered("language") != "fr" and time.monotonic() < end:
        time.sleep(0.05)
    assert window.remembered("language") == "fr"
    window.press("Escape")
    window.wait(lambda now: "popup" not in now["layers"])
    window.press("Escape", "o")
    window.wait(lambda now: "start page" in now["layers"])
    window.press("ctrl+q")
    assert window.ended() == 0, window.complaint()


@pytest.fixture
def painted(screen: Screen, tmp_path: Path) -> Iterator[Keyboard]:
    made = Keyboard(screen, tmp_path, PAINTED)
    made.wait(lambda now: now["draws"] > 0 and now["stage"] == "NONE")
    yield made
    made.close()


def test_the_picture_and_the_edges_without_a_mouse(painted: Keyboard) -> None:
    window, screen = painted, painted.screen

    def traced() -> list[int]:
        texel: list[int] = window.now()["trace"].get("texel", [])
        return texel

    def edge() -> int:
        """Return where the panel's ground ends in a row above its first line."""
        row = screen.pixels()[5, 5:]
        return int((row != row[0]).any(axis=1).argmax())

    window.press("x", "b")
    window.wait(lambda now: {"cursor", "brush"} <= set(now["layers"]))
    bare = window.settled()
    screen.do("keydown", "space")
    window.wait(lambda now: now["picture"] != bare and "height.image" in now["edited"])
    window.press("shift+Left", "shift+Left", "Left")
    screen.do("keyup", "space")
    window.press("ctrl+z")
    window.wait(lambda now: now["picture"] == bare)
    window.press("b", "t")
    window.wait(lambda now: traced())
    middle = traced()
    window.press("shift+Right")
    window.wait(lambda now: traced() == [middle[0] + 10, middle[1]])
    window.press("space", "Down", "i")
    window.wait(lambda now: "inspector" in now["layers"])
    assert traced() == [middle[0] + 10, middle[1]], "it is pinned"
    window.press("shift+space")
    window.wait(lambda now: traced() == [middle[0] + 10, middle[1] - 1])
    window.press("Escape", "Escape", "Escape")
    window.wait(lambda now: not now["layers"])

    first = edge()
    window.press("ctrl+Tab", "alt+KP_Add", "alt+KP_Add", "ctrl+Tab", "alt+KP_Subtract")
    window.press("ctrl+Tab", "alt+KP_Add")
    end = time.monotonic() + LIMIT
    panes: dict[str, float] = {}
    while "strip height" not in panes and time.monotonic() < end:
        time.sleep(0.05)
        panes = window.remembered("panes")  # type: ignore[assignment]
    assert panes["code width"] == pytest.approx(0.43) and panes["strip height"] == pytest.approx(0.36)
    assert edge() == first + 40
