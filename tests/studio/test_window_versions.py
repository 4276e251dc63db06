"""Versions in a real window: each save appears in the filmstrip; look, go back, undo, name, by the mouse."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

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
for name in ("button", "input_text_with_hint", "invisible_button"):
    setattr(imgui, name, noting(getattr(imgui, name)))
sys.exit(run(sys.argv[1], size=(1280, 720), time_limit=600))
"""
TERRAIN = """#pragma kernel(output = "height:r32f")
uniform float hills = 4.0; //! slider(1, 16)
float kernel(ivec2 texel) {
    vec2 place = vec2(texel) / vec2(size - 1);
    return 0.5 + 0.25 * sin(hills * place.x) * sin(hills * place.y);
}
"""


class Kept(Program):
    """A window on a folder with hills."""

    def __init__(self, screen: Screen, folder: Path) -> None:
        self.folder = folder / "hills"
        self.folder.mkdir()
        self.kernel = self.folder / "terrain.glsl"
        self.kernel.write_text(TERRAIN, encoding="utf-8")
        (self.folder / "sketch.toml").write_text(HILLS, encoding="utf-8")
        super().__init__(screen, folder, [sys.executable, "-c", RUN, str(self.folder)], folder)
        drawn = self.wait(lambda now: len(now["versions"]) == 1)["draws"]
        screen.do("key", "v")
        self.wait(lambda now: now["draws"] > drawn)  # the strip takes room of the picture

    def places(self) -> dict[str, tuple[int, int]]:
        """Return where everything is, by its label."""
        with suppress(json.JSONDecodeError, FileNotFoundError):  # it is being written
            found: dict[str, tuple[int, int]] = json.loads(
                (self.folder.parent / "places.json").read_text(encoding="utf-8")
            )
            return found
        return {}

    def click(self, label: str, *more: object) -> None:
        """Click on what has a label, once it stands still."""
        before: object = None
        end = time.monotonic() + LIMIT
        while time.monotonic() < end:
            at = self.places().get(label)
            if at is not None and at == before:
                self.screen.do("mousemove", *at, *(more or ("click", 1)))
                return
            before = at
            time.sleep(0.7)
        pytest.fail(f"there is no {label}")

    def frames(self) -> list[str]:
        """Return the labels of the versions, from the left."""
        places = self.places()
        return sorted((name for name in places if name.startswith("version ")), key=lambda n: places[n][0])


@pytest.fixture
def window(screen: Screen, tmp_path: Path) -> Iterator[Kept]:
    made = Kept(screen, tmp_path)
    yield made
    made.close()


def test_tour_of_the_versions(window: Kept) -> None:
    first = window.now()["picture"]
    for number in (8, 12):
        save_in_place(window.kernel, TERRAIN.replace("hills = 4.0", f"hills = {number}.0").encode())
        window.wait(lambda now, number=number: len(now["versions"]) == number // 4)
    saved = window.now()["picture"]
    oldest = window.frames()[0]
    window.click(oldest)
    looked = window.wait(lambda now: now["looked"] and now["picture"] == first)
    assert "hills = 12.0" in window.kernel.read_text()
    assert len(looked["versions"]) == 3
    window.click("To the present###present")
    window.wait(lambda now: not now["looked"] and now["picture"] == saved)
    time.sleep(1.0)
    window.click(oldest, "click", "--repeat", 2, "--delay", 60, 1)
    window.wait(lambda now: now["picture"] == first and not now["looked"])
    assert window.kernel.read_text() == TERRAIN
    window.screen.do("mousemove", 640, 200, "key", "ctrl+z")
    window.wait(lambda now: now["picture"] == saved)
    assert "hills = 12.0" in window.kernel.read_text()
    window.click("##name")
    window.screen.do("type", "--delay", 80, "ridge")
    window.screen.do("key", "Return")
    window.wait(lambda now: "ridge" in now["versions"])
