"""Drive a headless Chromium through chromedriver, over the WebDriver protocol (W3C, 2018)."""

from __future__ import annotations

import base64
import json
import os
import re
import shutil
import subprocess
import time
import urllib.error
import urllib.request
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

ELEMENT = "element-6066-11e4-a52e-4f735466cecf"
GENEROUS = 120  # [s] for what happens sooner or later

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
DRIVER = shutil.which("chromedriver")
MISSING = "" if CHROMIUM and DRIVER and os.name == "posix" else "needs Chromium and chromedriver, on POSIX"

_OPTIONS = "--headless --no-sandbox --no-first-run --disable-background-networking"
_OPTIONS += " --disable-component-update --disable-sync --hide-scrollbars"

NO_GPU = ("--disable-gpu",)
MESA = ("--use-gl=angle", "--use-angle=gl-egl", "--ignore-gpu-blocklist")
"""WebGL2 on Mesa: the renderer of the engine's own tests."""
SWIFTSHADER = ("--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
"""WebGL2 on the renderer that Chromium brings along."""


class Browser:
    """One window, until the block ends."""

    def __init__(
        self, folder: Path, width: int = 1280, height: int = 900, flags: Sequence[str] = NO_GPU
    ) -> None:
        assert DRIVER and CHROMIUM
        self._driver = subprocess.Popen(
            [DRIVER, "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        assert self._driver.stdout
        port = None
        while port is None:
            line = self._driver.stdout.readline()
            assert line, "chromedriver ended"
            port = re.search(r"successfully on port (\d+)", line)
        self._base = f"http://127.0.0.1:{port[1]}/session"
        arguments = [
            *_OPTIONS.split(),
            f"--window-size={width},{height}",
            f"--user-data-dir={folder}",
            *flags,
        ]
        options = {"browserName": "chrome", "goog:chromeOptions": {"binary": CHROMIUM, "args": arguments}}
        options["goog:loggingPrefs"] = {"browser": "ALL"}
        try:
            answer = self._ask("POST", "", {"capabilities": {"alwaysMatch": options}})
        except BaseException:
            self._end()
            raise
        self._base += f"/{answer['sessionId']}"

    @property
    def process(self) -> int:
        """The id of the driver's process, which began all of the browser's."""
        return self._driver.pid

    def open(self, url: str) -> None:
        """Load a page."""
        self._ask("POST", "/url", {"url": url})

    def visit(self, url: str) -> None:
        """Load a page as a new visitor: nothing is stored or emulated, and the mouse is in a corner."""
        self.emulate("clearDeviceMetricsOverride")
        self.emulate("setEmulatedMedia", media="", features=[])
        self.emulate("setScriptExecutionDisabled", value=False)
        self.act({"type": "pointer", "id": "hand", "actions": [{"type": "pointerMove", "x": 0, "y": 0}]})
        self.open(url)
        self.run("localStorage.clear(); sessionStorage.clear()")
        self.open(url)

    def run(self, script: str, *arguments: object) -> Any:
        """Return what a function's body returns in the page."""
        return self._ask("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def wait(self, condition: str, *arguments: object) -> Any:
        """Return what an expression gives as soon as that is true."""
        end = time.monotonic() + GENEROUS
        while not (value := self.run(f"return {condition}", *arguments)):
            assert time.monotonic() < end, f"never: {condition}; log: {self.log()}"
            time.sleep(0.05)
        return value

    def click(self, selector: str) -> None:
        """Click on an element as a hand would: it has to be there and uncovered."""
        result = self._ask("POST", "/element", {"using": "css selector", "value": selector})
        self.run("arguments[0].scrollIntoView({ block: 'center', behavior: 'instant' })", result)
        self._ask("POST", f"/element/{result[ELEMENT]}/click", {})

    def press(self, *keys: str) -> None:
        """Press keys one after the other, wherever the focus is."""
        actions = [{"type": kind, "value": key} for key in keys for kind in ("keyDown", "keyUp")]
        self.act({"type": "key", "id": "keys", "actions": actions})

    def act(self, *sources: dict[str, Any]) -> None:
        """Let devices act as a hand would: sources of WebDriver's actions."""
        self._ask("POST", "/actions", {"actions": list(sources)})

    def drag(self, selector: str, start: tuple[int, int], end: tuple[int, int]) -> None:
        """Drag from one place to another, in pixels from an element's middle."""
        result = self._ask("POST", "/element", {"using": "css selector", "value": selector})
        move = {"type": "pointerMove", "duration": 0, "origin": result}
        actions: list[dict[str, object]] = [{**move, "x": start[0], "y": start[1]}]
        actions += [{"type": "pointerDown", "button": 0}, {**move, "x": end[0], "y": end[1]}]
        actions += [{"type": "pointerUp", "button": 0}]
        self.act({"type": "pointer", "id": "hand", "actions": actions})

    def emulate(self, what: str, **settings: object) -> None:
        """Behave as another device or medium: a command of DevTools' domain Emulation."""
        self._ask("POST", "/goog/cdp/execute", {"cmd": f"Emulation.{what}", "params": settings})

    def log(self) -> list[str]:
        """Return the errors on the console since the last call, and what a policy refused."""
        result = self._ask("POST", "/se/log", {"type": "browser"})
        return [str(entry["message"]) for entry in result if entry["level"] == "SEVERE"]

    def picture(self) -> bytes:
        """Return a PNG of the window."""
        return base64.b64decode(self._ask("GET", "/screenshot"))

    def __enter__(self) -> Browser:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self._ask("DELETE", "")
        finally:
            self._end()

    def _end(self) -> None:
        self._driver.terminate()
        self._driver.communicate(timeout=GENEROUS)

    def _ask(self, method: str, path: str, body: object = None) -> Any:
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(
            self._base + path, data, {"Content-Type": "application/json"}, method=method
        )
        try:
            with urllib.request.urlopen(request, timeout=GENEROUS) as answer:
                return json.loads(answer.read())["value"]
        except urllib.error.HTTPError as error:
            with error:
                raise AssertionError(json.loads(error.read())["value"]["message"]) from None
