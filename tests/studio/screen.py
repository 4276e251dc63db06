"""What tests of windows share: an X server without a screen, and a program that shows itself there."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from playground.paths import NAME
from playground.studio.interface import FORMAT, HINTS

from ..sketch_texts import passes

ROOT = Path(__file__).resolve().parents[2]
LIMIT = 90.0  # [s] for anything to happen on a slow machine

HILLS = (
    'format = 1\ntitle = "Hills"\nsize = 65\nextent = 1000.0\nrelief = 200.0\n'
    + passes(height="./terrain")
    + '[view]\nuse = "view/terrain"\nsamples = 1\n'
)
"""A sketch whose terrain is the file next to it; keys of its view may follow."""

ON_LINUX = [
    pytest.mark.live,
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="Xvfb is for Linux"),
]


def script(size: tuple[int, int], **options: object) -> str:
    """Return a program that opens a window on the sketch in its first argument."""
    text = "".join(f"{name}={value!r}, " for name, value in options.items())
    return (
        "import sys\nfrom playground.studio.app import run\n"
        f"sys.exit(run(sys.argv[1], size={size}, {text}time_limit=300))\n"
    )


def needed(program: str) -> str:
    """Return the path of a program; without it a test is skipped, and fails in CI."""
    text = shutil.which(program)
    if text is None:
        message = f"{program} is not installed (Debian: apt install xvfb xdotool)"
        if os.environ.get("CI"):
            pytest.fail(message)
        pytest.skip(message)
    return text


class Screen:
    """An X server with nothing on it but what a test opens."""

    def __init__(self, folder: Path, width: int, height: int) -> None:
        self.folder, self.size = folder, (width, height)
        read, write = os.pipe()
        arguments = ["-displayfd", str(write), "-screen", "0", f"{width}x{height}x24", "-fbdir", str(folder)]
        self.server = subprocess.Popen(
            [needed("Xvfb"), *arguments, "-nolisten", "tcp"], pass_fds=[write], stderr=subprocess.DEVNULL
        )
        os.close(write)
        with os.fdopen(read) as answer:
            self.display = f":{answer.readline().strip()}"
        self.xdotool = needed("xdotool")

    def pixels(self) -> NDArray[np.uint8]:
        """Return what is on the screen: (height, width, 3), top row first. The file is an X window dump."""
        raw = (self.folder / "Xvfb_screen0").read_bytes()
        header = np.frombuffer(raw, ">u4", 25)
        width, height, line, start = header[4], header[5], header[12], header[0] + 12 * header[19]
        rows = np.frombuffer(raw, np.uint8, height * line, start).reshape(height, line // 4, 4)
        return rows[:, :width, 2::-1].copy()

    def do(self, *words: object) -> None:
        """Move the mouse, press keys: words of xdotool."""
        environment = {**os.environ, "DISPLAY": self.display}
        subprocess.run([self.xdotool, *map(str, words)], env=environment, check=True, timeout=180)

    def close(self) -> None:
        """End the server."""
        self.server.terminate()
        self.server.wait(10)


class Program:
    """A program with a window, in a process of its own, which reports what it shows."""

    def __init__(
        self,
        screen: Screen,
        folder: Path,
        command: Sequence[str],
        cwd: Path,
        *,
        code: bool = False,
        strip: bool = False,
        as_delivered: bool = False,
    ) -> None:
        """Start it; ``code``: with the code pane, ``strip``: with the strip below the picture.

        ``as_delivered``: with what a window shows that was never opened before.
        """
        self.screen = screen
        interface = folder / "state" / NAME / "interface.json"
        if not interface.exists() and not as_delivered:
            interface.parent.mkdir(parents=True, exist_ok=True)
            # Beside the panel is the picture alone; what the panel begins with leaves room for what follows.
            panes = {"code": float(code), "strip": float(strip), "terrain": 0.0}
            chosen = {
                "format": FORMAT,
                "panes": panes,
                "shows_readout": False,
                "used_keys": list(HINTS),
            }  # the corner's words differ from run to run, the hints would be over the picture
            interface.write_text(json.dumps(chosen), encoding="utf-8")
        self.status = folder / "status.jsonl"
        gone = ("WAYLAND_DISPLAY", "XDG_SESSION_TYPE")
        environment = {k: v for k, v in os.environ.items() if k not in gone}
        # What it remembers is a test's own, and gone with it.
        environment |= {"XDG_STATE_HOME": str(folder / "state"), "XDG_CACHE_HOME": str(folder / "cache")}
        environment |= {"DISPLAY": screen.display, "PLAYGROUND_STATUS": str(self.status)}
        places = filter(None, [str(ROOT), os.environ.get("PYTHONPATH", "")])
        environment["PYTHONPATH"] = os.pathsep.join(places)
        self.log = (folder / "stderr.txt").open("w+b")
        self.process = subprocess.Popen(command, env=environment, cwd=cwd, stderr=self.log)

    def now(self) -> dict[str, Any]:
        """Return the last line of its status; nothing before that."""
        text = self.status.read_text("utf-8") if self.status.exists() else ""
        lines = text[: text.rfind("\n") + 1].splitlines()  # the last may be half written
        values: dict[str, Any] = json.loads(lines[-1]) if lines else {}
        return values

    def wait(self, until: Callable[[dict[str, Any]], object]) -> dict[str, Any]:
        """Wait until its status fulfils a condition."""
        end = time.monotonic() + LIMIT
        while time.monotonic() < end:
            assert self.process.poll() is None, f"the window died: {self.complaint()}"
            now = self.now()
            if now and until(now):
                time.sleep(0.1)  # what was drawn reaches the screen
                return now
            time.sleep(0.02)
        pytest.fail(f"it did not happen; last seen: {self.now()}; {self.complaint()}")

    def complaint(self) -> str:
        """Return what it wrote to standard error."""
        self.log.seek(0)
        return self.log.read().decode("utf-8", "replace")

    def ended(self) -> int:
        """Wait for its end; return its exit status."""
        return self.process.wait(LIMIT)

    def close(self) -> None:
        """End it, if it has not ended."""
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait(10)
        self.log.close()
