"""The window that one flies in, as a person meets it: a real X server, keys by xdotool."""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from playground.flight.craft import Controls
from playground.flight.record import read_record
from playground.paths import NAME
from playground.studio.interface import FORMAT

from ..sketch_texts import passes
from ..studio.screen import LIMIT, ON_LINUX, Program, Screen

WIDTH, HEIGHT = 640, 360
SKETCH = (
    """format = 1
title = "A small endless terrain"
size = 33
extent = 1920.0
relief = 900.0
"""
    + passes(
        height=("generation/endless", 'set = { apron = 8, hills = 64, "detail.octaves" = 3 }'),
        colour=("texturing/endless_ground", "set = { apron = 8, patches = 16 }"),
        daylight=("lighting/daylight", "set = { hour = 10.0 }"),
        light=("lighting/soft_cone", "set = { gain = 1.0, ambient = 1.0 }"),
    )
    + """[view]
use = "view/terrain"
samples = 1
set = { sky = "daylight", tone = "film", exposure = 0.6 }
"""
)

pytestmark = ON_LINUX


class App(Program):
    """A flight in a window, on an X server of its own."""

    def __init__(self, folder: Path, *arguments: str, speaks: str = "en") -> None:
        (folder / "sketch.toml").write_text(SKETCH, encoding="utf-8")
        interface = folder / "state" / NAME / "interface.json"
        interface.parent.mkdir(parents=True)
        interface.write_text(json.dumps({"format": FORMAT, "language": speaks}), encoding="utf-8")
        command = [sys.executable, "-m", "playground", "fly", *arguments, "--size", f"{WIDTH}x{HEIGHT}"]
        super().__init__(Screen(folder, WIDTH, HEIGHT), folder, command, folder)

    def close(self) -> None:
        """End it, and its screen."""
        super().close()
        self.screen.close()


@pytest.fixture
def open_app(tmp_path: Path) -> Iterator[Callable[..., App]]:
    opened: list[App] = []

    def make(*arguments: str, speaks: str = "en") -> App:
        opened.append(App(tmp_path, *arguments, speaks=speaks))
        return opened[-1]

    yield make
    for app in opened:
        app.close()


@pytest.mark.slow
def test_keys_fly_and_the_flight_is_written_down(open_app: Callable[..., App], tmp_path: Path) -> None:
    app = open_app("sketch.toml", "--record", "a.jsonl", "--radius", "1.5", "--set", "relief=800")
    first = app.wait(lambda now: now["ready"] and now["steps"] > 0)
    assert first["missing"] == 0 and first["parts"] >= 9

    app.screen.do("keydown", "d")
    app.wait(lambda now: now["roll"] > 0.3 and now["heading"] > 0.02)
    app.screen.do("keyup", "d", "keydown", "Down")
    app.wait(lambda now: now["pitch"] > 0.15)
    app.screen.do("keyup", "Down", "keydown", "Shift_L")
    app.wait(lambda now: now["throttle"] > first["throttle"] + 0.1)
    app.screen.do("keyup", "Shift_L")
    app.screen.do("mousemove", 300, 150, "mousedown", 1, "mousemove", 220, 150)
    app.wait(lambda now: now["roll"] < -0.2)
    app.screen.do("mouseup", 1)

    level = app.now()["throttle"]
    app.screen.do("click", 5)
    app.wait(lambda now: now["throttle"] < level - 0.04)
    app.screen.do("key", "bracketright")
    app.wait(lambda now: now["hour"] == 10.5 and now["missing"] == 0)
    app.screen.do("key", "p")
    still = app.wait(lambda now: now["paused"])["steps"]
    for key, zoom in (("ctrl+plus", 1.1), ("ctrl+minus", 1.0), ("ctrl+minus", 0.9), ("ctrl+0", 1.0)):
        app.screen.do("key", key)
        app.wait(lambda now, zoom=zoom: now["zoom"] == zoom)
    app.screen.do("key", "shift+slash")
    app.wait(lambda now: now["help"])
    end = time.monotonic() + LIMIT
    while np.median((shown := app.screen.pixels())[HEIGHT // 2, 200:440]) >= 60:
        assert time.monotonic() < end, "the help is on a dark plate"
    assert app.now()["steps"] == still, "nothing moves while it is paused"
    sky = shown[20:40, 20:100].reshape(-1, 3)
    assert sky[:, 2].mean() > sky[:, 0].mean() + 20, "the sky is blue"
    if os.environ.get("FLY_PICTURE"):
        from PIL import Image

        Image.fromarray(shown).save(os.environ["FLY_PICTURE"])
    app.screen.do("key", "F1", "key", "p")
    app.wait(lambda now: not now["help"] and now["steps"] > still + 5)
    app.screen.do("key", "r")
    app.wait(lambda now: now["hour"] == 10.0 and abs(now["roll"]) < 0.2)
    app.screen.do("key", "F1", "key", "Escape")
    app.wait(lambda now: not now["help"] and not now["paused"])
    app.screen.do("key", "Escape")
    app.wait(lambda now: now["paused"])
    app.screen.do("keydown", "ctrl", "sleep", 0.2, "key", "q", "keyup", "ctrl")
    assert app.ended() == 0, app.complaint()

    record = read_record(tmp_path / "a.jsonl")
    flown = list(record)
    assert record.steps == app.now()["steps"] or abs(record.steps - app.now()["steps"]) < 30
    assert {m.hour for m in flown} >= {10.5} and sum(m.reset for m in flown) == 1
    assert Controls(roll=100) in {m.controls for m in flown}
    assert Path(record.header.sketch) == tmp_path / "sketch.toml" and record.header.radius == 1.5
    assert record.header.values == {"relief": "800"}


@pytest.mark.slow
def test_a_replay_flies_by_itself_and_stops_at_its_end(open_app: Callable[..., App], tmp_path: Path) -> None:
    header = {"format": "playground flight", "version": 1, "sketch": "sketch.toml", "size": [640, 360]}
    header |= {"step": 1 / 60, "radius": 1.5, "values": {}, "start": None}
    rows = [json.dumps(header), "[40, 0, 0, 100, 0]", '{"hour": 16.0}', "[30, 0, 40, 0, 0]"]
    (tmp_path / "b.jsonl").write_text("\n".join(rows), encoding="utf-8")
    app = open_app("--replay", "b.jsonl", speaks="fr")
    now = app.wait(lambda now: now["ready"] and now["paused"])
    assert now["steps"] == 70 and now["hour"] == 16.0 and now["roll"] > 0.3
    assert now["language"] == "fr", "as another window has chosen it"
    app.screen.do("keydown", "ctrl", "sleep", 0.2, "key", "q", "keyup", "ctrl")
    assert app.ended() == 0, app.complaint()


@pytest.mark.slow
def test_saved_edit_is_flown_in_place_and_error_is_reported(
    open_app: Callable[..., App], tmp_path: Path
) -> None:
    app = open_app("sketch.toml", "--radius", "1.5")
    app.wait(lambda now: now["ready"])
    app.screen.do("mousemove", WIDTH // 2, HEIGHT // 2, "key", "p")
    before = app.wait(lambda now: now["paused"] and not now["missing"])
    seen = app.screen.pixels()
    file = tmp_path / "sketch.toml"
    file.write_text(SKETCH.replace("generation/endless", "generation/endles"), encoding="utf-8")
    wrong = app.wait(lambda now: now["error"])
    assert "endles" in wrong["error"] and "sketch.toml" in wrong["error"]
    assert (app.screen.pixels() != seen).any(), "it is shown over the picture"
    file.write_text(SKETCH.replace("relief = 900.0", "relief = 300.0"), encoding="utf-8")
    after = app.wait(lambda now: now["changes"] == 1 and not now["missing"])
    assert not after["error"] and after["heading"] == before["heading"]
    assert after["up"] == before["up"], "the terrain is lower: the craft stays where it was"
    app.screen.do("key", "ctrl+q")
    assert app.ended() == 0, app.complaint()
