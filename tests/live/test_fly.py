"""The window that one flies in, as a person meets it: a real X server, keys by xdotool."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from playground.flight.craft import Controls
from playground.flight.record import read_record

ROOT = Path(__file__).resolve().parents[2]
WIDTH, HEIGHT = 640, 360
LIMIT = 25.0  # [s] for anything to happen on a slow machine
SKETCH = """format = 1
title = "A small land without end"
size = 33
extent = 1920.0
relief = 900.0
[[pass]]
name = "height"
use = "generation/endless"
set = { apron = 8, hills = 64, "detail.octaves" = 3 }
[[pass]]
name = "colour"
use = "texturing/endless_ground"
set = { apron = 8, patches = 16 }
[[pass]]
name = "daylight"
use = "lighting/daylight"
set = { hour = 10.0 }
[[pass]]
name = "light"
use = "lighting/soft_cone"
set = { gain = 1.0, ambient = 1.0 }
[view]
use = "view/terrain"
samples = 1
set = { sky = "daylight", tone = "film", exposure = 0.6 }
"""

pytestmark = [
    pytest.mark.live,
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="Xvfb is for Linux"),
]


def needed(program: str) -> str:
    found = shutil.which(program)
    if found is None:
        message = f"{program} is not installed (Debian: apt install xvfb xdotool)"
        if os.environ.get("CI"):
            pytest.fail(message)
        pytest.skip(message)
    return found


class App:
    """A flight in a window, on an X server of its own."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        self.folder = folder
        read, write = os.pipe()
        screen = ["-displayfd", str(write), "-screen", "0", f"{WIDTH}x{HEIGHT}x24", "-fbdir", str(folder)]
        self.server = subprocess.Popen(
            [needed("Xvfb"), *screen, "-nolisten", "tcp"], pass_fds=[write], stderr=subprocess.DEVNULL
        )
        os.close(write)
        with os.fdopen(read) as answer:
            self.display = f":{answer.readline().strip()}"
        self.status = folder / "status.jsonl"
        (folder / "sketch.toml").write_text(SKETCH, encoding="utf-8")
        gone = ("WAYLAND_DISPLAY", "XDG_SESSION_TYPE")
        self.environment = {k: v for k, v in os.environ.items() if k not in gone}
        self.environment |= {"DISPLAY": self.display, "PLAYGROUND_STATUS": str(self.status)}
        self.environment["PYTHONPATH"] = os.pathsep.join(
            filter(None, [str(ROOT), os.environ.get("PYTHONPATH", "")])
        )
        self.said = (folder / "stderr.txt").open("w+b")
        command = [sys.executable, "-m", "playground", "fly", *arguments, "--size", f"{WIDTH}x{HEIGHT}"]
        self.process = subprocess.Popen(command, env=self.environment, cwd=folder, stderr=self.said)

    def now(self) -> dict[str, Any]:
        text = self.status.read_text("utf-8") if self.status.exists() else ""
        lines = text[: text.rfind("\n") + 1].splitlines()  # the last may be half written
        return json.loads(lines[-1]) if lines else {"ready": False, "steps": 0}

    def wait(self, until: Callable[[dict[str, Any]], object]) -> dict[str, Any]:
        end = time.monotonic() + LIMIT
        while time.monotonic() < end:
            assert self.process.poll() is None, f"the window died: {self.complaint()}"
            now = self.now()
            if until(now):
                return now
            time.sleep(0.02)
        pytest.fail(f"it did not happen; last seen: {self.now()}; {self.complaint()}")

    def do(self, *words: object) -> None:
        command = [needed("xdotool"), *map(str, words)]
        subprocess.run(command, env=self.environment, check=True, timeout=10)

    def pixels(self) -> NDArray[np.uint8]:
        """Return what is on the screen: (height, width, 3), top row first. The file is an X window dump."""
        raw = (self.folder / "Xvfb_screen0").read_bytes()
        header = np.frombuffer(raw, ">u4", 25)
        width, height, line, start = header[4], header[5], header[12], header[0] + 12 * header[19]
        rows = np.frombuffer(raw, np.uint8, height * line, start).reshape(height, line // 4, 4)
        return rows[:, :width, 2::-1].copy()

    def complaint(self) -> str:
        self.said.seek(0)
        return self.said.read().decode("utf-8", "replace")

    def close(self) -> None:
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait(10)
        self.said.close()
        self.server.terminate()
        self.server.wait(10)


@pytest.fixture
def open_app(tmp_path: Path) -> Iterator[Callable[..., App]]:
    opened: list[App] = []

    def make(*arguments: str) -> App:
        opened.append(App(tmp_path, *arguments))
        return opened[-1]

    yield make
    for app in opened:
        app.close()


def test_keys_fly_and_the_flight_is_written_down(open_app: Callable[..., App], tmp_path: Path) -> None:
    app = open_app("sketch.toml", "--record", "a.jsonl", "--radius", "1.5", "--set", "relief=800")
    first = app.wait(lambda now: now["ready"] and now["steps"] > 0)
    assert first["missing"] == 0 and first["parts"] >= 9

    app.do("keydown", "d")
    app.wait(lambda now: now["roll"] > 0.3 and now["heading"] > 0.02)
    app.do("keyup", "d", "keydown", "Down")
    app.wait(lambda now: now["pitch"] > 0.15)
    app.do("keyup", "Down", "keydown", "Shift_L")
    app.wait(lambda now: now["throttle"] > first["throttle"] + 0.1)
    app.do("keyup", "Shift_L")
    app.do("mousemove", 300, 150, "mousedown", 1, "mousemove", 220, 150)
    app.wait(lambda now: now["roll"] < -0.2)
    app.do("mouseup", 1)

    level = app.now()["throttle"]
    app.do("click", 5)
    app.wait(lambda now: now["throttle"] < level - 0.04)
    app.do("key", "bracketright")
    app.wait(lambda now: now["hour"] == 10.5 and now["missing"] == 0)
    app.do("key", "p")
    still = app.wait(lambda now: now["paused"])["steps"]
    app.do("key", "shift+slash")
    app.wait(lambda now: now["help"])
    time.sleep(0.3)
    shown = app.pixels()
    assert app.now()["steps"] == still, "nothing moves while it is paused"
    sky, plate = shown[20:40, 20:100].reshape(-1, 3), shown[HEIGHT // 2, 200:440].reshape(-1, 3)
    assert sky[:, 2].mean() > sky[:, 0].mean() + 20, "the sky is blue"
    assert np.median(plate) < 60, "the help stands on a dark plate"
    if os.environ.get("FLY_PICTURE"):
        from PIL import Image

        Image.fromarray(shown).save(os.environ["FLY_PICTURE"])
    app.do("key", "F1", "key", "p")
    app.wait(lambda now: not now["help"] and now["steps"] > still + 5)
    app.do("key", "r")
    app.wait(lambda now: now["hour"] == 10.0 and abs(now["roll"]) < 0.2)
    app.do("key", "Escape")
    assert app.process.wait(LIMIT) == 0, app.complaint()

    record = read_record(tmp_path / "a.jsonl")
    flown = list(record)
    assert record.steps == app.now()["steps"] or abs(record.steps - app.now()["steps"]) < 30
    assert {m.hour for m in flown} >= {10.5} and sum(m.reset for m in flown) == 1
    assert Controls(roll=100) in {m.controls for m in flown}
    assert Path(record.header.sketch) == tmp_path / "sketch.toml" and record.header.radius == 1.5
    assert record.header.values == {"relief": "800"}


def test_a_replay_flies_by_itself_and_stops_at_its_end(open_app: Callable[..., App], tmp_path: Path) -> None:
    header = {"format": "playground flight", "version": 1, "sketch": "sketch.toml", "size": [640, 360]}
    header |= {"step": 1 / 60, "radius": 1.5, "values": {}, "start": None}
    rows = [json.dumps(header), "[40, 0, 0, 100, 0]", '{"hour": 16.0}', "[30, 0, 40, 0, 0]"]
    (tmp_path / "b.jsonl").write_text("\n".join(rows), encoding="utf-8")
    app = open_app("--replay", "b.jsonl")
    now = app.wait(lambda now: now["ready"] and now["paused"])
    assert now["steps"] == 70 and now["hour"] == 16.0 and now["roll"] > 0.3
    app.do("key", "Escape")
    assert app.process.wait(LIMIT) == 0, app.complaint()
