"""The first minutes, from an empty home, by the window alone: a terrain is made, changed, shown and exported.

    TOUR=pictures python -m pytest -m slow tests/studio/test_window_first_terrain.py -s

prints how long each step took, and keeps a screenshot of each in the folder that ``TOUR`` names.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.paths import NAME, SKETCHES
from playground.publish.capture_job import PAGE, TURNTABLE
from playground.studio.interface import FORMAT
from playground.studio.land.looks import look_title
from playground.studio.language import choose_language, tr

from ..elevations import geotiff
from .screen import LIMIT, ON_LINUX, Program, Screen
from .x_drop import Source

pytestmark = [*ON_LINUX, pytest.mark.slow]
WATCHED = Path(__file__).with_name("watched.py")
KEPT = os.environ.get("TOUR", "")


class Tour:
    """A person at a screen: clicks on what is seen, by its words, and types."""

    def __init__(self, screen: Screen, home: Path, language: str) -> None:
        self.screen, self.home, self.language = screen, home, language
        choose_language(language)
        self.places_file = home / "places.json"
        command = [sys.executable, str(WATCHED), str(self.places_file), "live"]
        command += ["--size", f"{screen.size[0]}x{screen.size[1]}"]
        if language != "en":
            state = home / "state" / NAME / "interface.json"
            state.parent.mkdir(parents=True)
            state.write_text(json.dumps({"format": FORMAT, "language": language}), encoding="utf-8")
        self.window = Program(screen, home, command, home, as_delivered=True)
        self.started = self.since = time.monotonic()
        self.steps: list[tuple[str, float]] = []
        self.cut: set[str] = set()  # labels that do not fit

    def drawn(self) -> dict[str, tuple[float, float, float, float]]:
        """Return the places of what is in sight, by label; note whose words are cut off."""
        if not self.places_file.exists():
            return {}
        frame = json.loads(self.places_file.read_text("utf-8"))
        self.cut |= set(frame["cut"])
        return dict(frame["places"])

    def find(self, label: str) -> tuple[float, float, float, float]:
        """Wait until something with this label is in sight."""
        end = time.monotonic() + LIMIT
        while time.monotonic() < end:
            for name, place in self.drawn().items():
                if name == label or (label.startswith("###") and name.endswith(label)):
                    return place
            assert self.window.process.poll() is None, self.window.complaint()
            time.sleep(0.05)
        pytest.fail(f"{label} is not in sight; {sorted(self.drawn())}")

    def click(self, label: str, *, times: int = 1, across: float = 0.5) -> None:
        """Click on what has a label, once it has come to rest."""
        place, before = self.find(label), None
        while place != before:  # until nothing above it moves it any more
            time.sleep(0.3)
            place, before = self.find(label), place
        x, y, wide, high = place
        self.screen.do("mousemove", round(x + across * wide), round(y + high / 2))
        time.sleep(0.15)
        self.screen.do("click", "--repeat", times, "--delay", 60, 1)
        time.sleep(0.15)

    def type(self, text: str) -> None:
        for number, line in enumerate(text.split("\n")):
            if number:
                self.key("Return")
            self.screen.do("type", "--delay", 30, line)

    def key(self, *names: str) -> None:
        for name in names:
            self.screen.do("key", name)
            time.sleep(0.05)

    def wait(self, until: Callable[[dict[str, Any]], object]) -> dict[str, Any]:
        return self.window.wait(until)

    def step(self, name: str) -> None:
        """Note how long what was just done took, and keep a picture of it."""
        now = time.monotonic()
        self.steps.append((name, now - self.since))
        time.sleep(0.4)
        if KEPT:
            folder = Path(KEPT)
            folder.mkdir(parents=True, exist_ok=True)
            file = f"{self.screen.size[0]}-{self.language}-{len(self.steps):02d}-{name.replace(' ', '-')}"
            write_png(folder / f"{file}.png", self.screen.pixels())
        self.since = time.monotonic()


KERNEL = """\
vec2 place = vec2(texel) / vec2(size - 1);
float hills = 0.5 + 0.5 * sin(9.0 * place.x + 2.0 * sin(7.0 * place.y)) * cos(8.0 * place.y);
return 0.7 * hills * hills + 0.05 * sin(61.0 * place.x) * cos(53.0 * place.y);"""
"""The lines inside the braces, which the editor indents."""


def real_heights(path: Path) -> Path:
    """Write the shipped elevations of the Jacksboro fault as a GeoTIFF; as a file that someone has."""
    with np.load(SKETCHES / "data" / "jacksboro_fault_dem.npz") as data:
        heights = np.asarray(data["elevation"], np.float32)
    unit = '<Item name="UNITTYPE" sample="0" role="unittype">m</Item>'
    tie = (0.0, 0.0, 0.0, 700_000.0, 4_050_000.0, 0.0)
    return geotiff(path, heights, {1024: 1, 1025: 1, 3072: 32616}, (30.0, 30.0), tie, metadata=unit)


@pytest.mark.parametrize("size", [(1280, 720), (2560, 1440)], ids=["small", "large"])
@pytest.mark.parametrize("language", ["en", "fr"])
def test_a_terrain_in_ten_minutes(tmp_path: Path, size: tuple[int, int], language: str) -> None:
    screen = Screen(tmp_path, *size)
    home = tmp_path / "home"
    home.mkdir()
    tour = Tour(screen, home, language)
    try:
        make_a_terrain(tour, real_heights(tmp_path / "valley.tif"))
    finally:
        tour.window.close()
        screen.close()
        choose_language("en")
    for name, seconds in tour.steps:
        print(f"{seconds:6.1f} s  {name}")
    print(f"{sum(seconds for _, seconds in tour.steps):6.1f} s  all")
    assert not tour.cut, "words that do not fit"


def make_a_terrain(tour: Tour, dem: Path) -> None:
    tour.find("###new")
    tour.step("start page")

    tour.click("###new")
    tour.click(f"{tr('Empty kernel')}##empty")
    first = tour.wait(lambda now: now["picture"] and now["stage"] == "NONE")["picture"]
    tour.step("new sketch")

    x, y, wide, high = tour.find("###find code")
    tour.screen.do("mousemove", round(x + wide), round(y + 8 * high), "click", 1)
    tour.wait(lambda now: now["typing"])
    tour.key("ctrl+Home", "Down", "Down", "Down", "Down", "Home", "shift+End")
    tour.type(KERNEL)
    time.sleep(1.0)  # what compiled on the way is shown meanwhile
    tour.wait(lambda now: now["picture"] != first and not now["error"] and now["stage"] == "NONE")
    tour.step("kernel typed")

    tour.key("Left")
    tour.type(" + hill")
    tour.wait(lambda now: now["error"])
    tour.step("mistake")
    tour.key(*["BackSpace"] * 7)
    tour.wait(lambda now: not now["error"] and now["stage"] == "NONE")
    tour.key("ctrl+s")
    tour.wait(lambda now: not now["unsaved"])
    tour.step("repaired and saved")

    tour.key("Escape")
    tour.click("node height")
    tour.click("+ height")
    tour.type("stream power")
    time.sleep(1.0)
    tour.step("erosion is looked for")
    before = tour.wait(lambda now: True)["picture"]
    tour.key("Return")
    eroded = tour.wait(lambda now: now["picture"] != before and not now["error"] and now["stage"] == "NONE")
    tour.step("erosion added")
    tour.click("node stream_power")
    tour.click("M stream_power")
    tour.wait(lambda now: now["picture"] != eroded["picture"])
    tour.step("erosion muted")
    tour.click("M stream_power")

    tour.click("###times3")
    tour.step("exaggerated")

    tour.screen.do("mousemove", 640, 200)
    source = Source(tour.screen.display)
    source.drop(dem)
    source.close()
    tour.wait(lambda now: not any(name.startswith("node stream") for name in tour.drawn()))
    tour.wait(lambda now: now["picture"] and not now["error"] and now["stage"] == "NONE")
    tour.step("elevation file dropped")

    tour.click("##land.look")
    before = tour.wait(lambda now: now["picture"])["picture"]
    tour.click(look_title("hillshade"))
    tour.wait(lambda now: now["picture"] != before)
    tour.step("Swiss hillshade")

    tour.key("v")
    tour.click("##name")
    tour.type("as it was found")
    tour.key("Return")
    kept = tour.wait(lambda now: "as it was found" in now["versions"])
    tour.step("version named")

    tour.click("##land.relief", times=2)
    tour.key("ctrl+a")
    tour.type("2000")
    tour.key("Return")
    changed = tour.wait(lambda now: now["picture"] != kept["picture"] and now["edited"])
    tour.step("relief changed")
    tour.click(next(name for name in tour.drawn() if name.startswith("version ")))
    tour.wait(lambda now: now["looked"] and now["picture"] != changed["picture"])
    tour.step("version looked at")
    tour.click("###back to")
    tour.wait(lambda now: not now["looked"] and not now["edited"])
    tour.step("gone back")

    tour.click(tr("Show…"))
    tour.click(f"###kind {TURNTABLE}")
    tour.step("what to show")
    for name, value in (("###around", "2"), ("###fps", "6")):
        tour.click(name, times=2)
        tour.key("ctrl+a")
        tour.type(value)
        tour.key("Tab")
    tour.click("###write")
    made = tour.wait(lambda now: now["captured"])["captured"]
    tour.step("turntable")
    with av.open(made) as film:
        assert sum(1 for _ in film.decode(video=0)) == 12
    tour.click(f"###kind {PAGE}")
    tour.click("###write")
    page = tour.wait(lambda now: now["captured"] != made)["captured"]
    tour.step("page")
    assert page.endswith(".html") and "<title>valley" in Path(page).read_text(encoding="utf-8")
