"""Drive Firefox over WebDriver BiDi (W3C), through its own port: no geckodriver.

Without a screen it has no WebGL, so it gets an X server of its own, where Mesa draws.
"""

from __future__ import annotations

import asyncio
import base64
import importlib.util
import json
import os
import re
import shutil
import subprocess
import time
from collections.abc import Mapping
from itertools import count
from pathlib import Path
from types import TracebackType
from typing import Any

GENEROUS = 300  # [s] for what happens sooner or later: a software renderer compiles slowly

FIREFOX = next(filter(None, map(shutil.which, ("firefox-esr", "firefox"))), None)
X_SERVER = shutil.which("Xvfb")
_READY = FIREFOX and X_SERVER and importlib.util.find_spec("aiohttp")
MISSING = "" if _READY else "needs Firefox, Xvfb, and aiohttp"

_PREFERENCES = {
    "webgl.force-enabled": True,
    "webgl.disable-fail-if-major-performance-caveat": True,
    "app.normandy.enabled": False,
    "app.update.disabledForTesting": True,
    "browser.shell.checkDefaultBrowser": False,
    "browser.startup.page": 0,
    "datareporting.policy.dataSubmissionEnabled": False,
    "extensions.update.enabled": False,
    "network.captive-portal-service.enabled": False,
    "network.connectivity-service.enabled": False,
    "services.settings.server": "data:,#none",
    "toolkit.telemetry.enabled": False,
}
_MIDDLE = """const found = document.querySelector(arguments[0]);
found.scrollIntoView({ block: "center", behavior: "instant" });
const box = found.getBoundingClientRect();
return [box.x + box.width / 2, box.y + box.height / 2]"""
_LISTENING = re.compile(r"WebDriver BiDi listening on (ws://\S+)")


class Firefox:
    """One window, until the block ends."""

    def __init__(self, folder: Path) -> None:
        assert FIREFOX and X_SERVER
        folder.mkdir(parents=True, exist_ok=True)
        lines = [
            f"user_pref({json.dumps(name)}, {json.dumps(value)});" for name, value in _PREFERENCES.items()
        ]
        (folder / "user.js").write_text("\n".join(lines) + "\n", "utf-8")
        read, write = os.pipe()
        screen = [X_SERVER, "-displayfd", str(write), "-screen", "0", "1280x960x24", "-nolisten", "tcp"]
        self._screen = subprocess.Popen(screen, pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as answer:
            environment = {
                **os.environ,
                "DISPLAY": f":{answer.readline().strip()}",
                "MOZ_ENABLE_WAYLAND": "0",
            }
        command = [FIREFOX, "--no-remote", "--profile", str(folder), "--remote-debugging-port=0"]
        self._program = subprocess.Popen(
            command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
        )
        self._loop = asyncio.new_event_loop()
        self._numbers = count(1)
        self._errors: list[str] = []
        try:
            self._loop.run_until_complete(self._connect(self._address()))
        except BaseException:
            self._end()
            raise

    def open(self, url: str) -> None:
        """Load a page; once more where Firefox does not say that it has, as was seen once."""
        load = {"context": self._context, "url": url, "wait": "complete"}
        try:
            self._loop.run_until_complete(self._answer("browsingContext.navigate", load, GENEROUS / 3))
        except TimeoutError:
            self._ask("browsingContext.navigate", **load)

    def run(self, script: str, *arguments: object) -> Any:
        """Return what a function's body returns in the page, promises awaited, as JSON."""
        body = (
            "async (text) => JSON.stringify(await (async function () { %s }).apply(null, JSON.parse(text)))"
        )
        answer = self._ask(
            "script.callFunction",
            functionDeclaration=body % script,
            arguments=[{"type": "string", "value": json.dumps(arguments)}],
            target={"context": self._context},
            awaitPromise=True,
        )
        assert answer["type"] == "success", answer["exceptionDetails"]["text"]
        value = answer["result"].get("value")
        return None if value is None else json.loads(value)

    def wait(self, condition: str, *arguments: object) -> Any:
        """Return what an expression gives as soon as that is true."""
        end = time.monotonic() + GENEROUS
        while not (value := self.run(f"return {condition}", *arguments)):
            assert time.monotonic() < end, f"never: {condition}; log: {self.log()}"
            time.sleep(0.05)
        return value

    def click(self, selector: str) -> None:
        """Click on the middle of an element, or on what covers it."""
        self._point(selector, (0, 0))

    def drag(self, selector: str, start: tuple[int, int], end: tuple[int, int]) -> None:
        """Drag from one place to another, in pixels from an element's middle."""
        self._point(selector, start, end)

    def press(self, *keys: str) -> None:
        """Press keys one after the other, wherever the focus is."""
        actions = [{"type": kind, "value": key} for key in keys for kind in ("keyDown", "keyUp")]
        self.act({"type": "key", "id": "keys", "actions": actions})

    def log(self) -> list[str]:
        """Return the errors on the console since the last call."""
        self.run("return 0")  # what was said before its answer has come by then
        errors, self._errors = self._errors, []
        return errors

    def _point(self, selector: str, *places: tuple[int, int]) -> None:
        x, y = self.run(_MIDDLE, selector)
        first, *rest = [{"type": "pointerMove", "x": round(x + a), "y": round(y + b)} for a, b in places]
        press, let_go = {"type": "pointerDown", "button": 0}, {"type": "pointerUp", "button": 0}
        self.act({"type": "pointer", "id": "hand", "actions": [first, press, *rest, let_go]})

    def act(self, *sources: dict[str, Any]) -> None:
        """Let devices act as a hand would: sources of WebDriver's actions."""
        self._ask("input.performActions", context=self._context, actions=list(sources))

    def size(self, width: int, height: int) -> None:
        """Give the page another size, in CSS pixels."""
        viewport = {"width": width, "height": height}
        self._ask("browsingContext.setViewport", context=self._context, viewport=viewport)

    def picture(self) -> bytes:
        """Return a PNG of what the window shows of the page."""
        return base64.b64decode(self._ask("browsingContext.captureScreenshot", context=self._context)["data"])

    def __enter__(self) -> Firefox:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self._ask("browser.close")
        finally:
            self._end()

    def _address(self) -> str:
        """Return where the browser listens, as it says on its standard error."""
        assert self._program.stderr
        for line in self._program.stderr:
            if result := _LISTENING.search(line):
                return result[1]
        raise AssertionError("Firefox ended")

    async def _connect(self, address: str) -> None:
        from aiohttp import ClientSession

        self._session = ClientSession()
        self._socket = await self._session.ws_connect(f"{address}/session", max_msg_size=0)
        await self._answer("session.new", {"capabilities": {}})
        tree = await self._answer("browsingContext.getTree", {})
        self._context = tree["contexts"][0]["context"]
        await self._answer("session.subscribe", {"events": ["log.entryAdded"]})

    def _ask(self, method: str, **parameters: object) -> Any:
        return self._loop.run_until_complete(self._answer(method, parameters))

    async def _answer(self, method: str, parameters: Mapping[str, object], seconds: float = GENEROUS) -> Any:
        number = next(self._numbers)
        await self._socket.send_json({"id": number, "method": method, "params": parameters})
        async with asyncio.timeout(seconds):
            while True:
                message = await self._socket.receive_json()
                if message.get("method") == "log.entryAdded" and message["params"]["level"] == "error":
                    self._errors.append(str(message["params"]["text"]))
                if message.get("id") == number:
                    assert message["type"] == "success", message
                    return message["result"]

    def _end(self) -> None:
        if hasattr(self, "_session"):
            self._loop.run_until_complete(self._session.close())
        self._loop.close()
        self._program.terminate()
        self._program.communicate(timeout=GENEROUS)
        self._screen.terminate()
        self._screen.wait(GENEROUS)
