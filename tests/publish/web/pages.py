"""Run the page runtime in a browser: sketches are opened in one page, their pictures come back as arrays."""

from __future__ import annotations

import base64
import gzip
import json
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

import playground.publish.web

from ...browser import MESA, MISSING, Browser
from .firefox import Firefox
from .node import NODE

HOME = Path(playground.publish.web.__file__).parent
ENGINE = HOME / "runtime" / "engine.js"
ESBUILD = HOME / "node_modules" / "esbuild"
if not MISSING and not (NODE and ESBUILD.exists()):
    MISSING = "needs Node, and npm ci in playground/publish/web"

_HARNESS = """
window.pages = {
  figures: {},
  bytes(array) {
    const all = new Uint8Array(array.buffer, array.byteOffset, array.byteLength);
    let text = "";
    for (let i = 0; i < all.length; i += 32768) text += String.fromCharCode(...all.subarray(i, i + 32768));
    return btoa(text);
  },
  told(error) {
    const { message, code, sentence, complaints, where, stack } = error;
    return { error: { message, code, sentence, complaints, where, stack } };
  },
  async begin(shared, options) {
    window.pages.engine?.close();
    window.pages.canvas = document.createElement("canvas");
    try {
      window.pages.engine = playground.createEngine(window.pages.canvas, shared, options);
    } catch (error) {
      return window.pages.told(error);
    }
    return {};
  },
  async open(name, sketch) {
    const start = performance.now(), player = window.pages.engine.open(sketch);
    window.pages.figures[name] = player;
    try {
      await player.load();
    } catch (error) {
      return window.pages.told(error);
    }
    return { compile: performance.now() - start };
  },
  async picture(name, state, soon) {
    const player = window.pages.figures[name];
    Object.assign(player.state, state);
    try {
      const done = soon ? await player.renderSoon(soon) : player.render();
      const texels = player.picture(), { frame, picture } = player.plan;
      const size = player.plan.steps.get(picture.path).size;
      return { ...done, size, frame, texels: window.pages.bytes(texels) };
    } catch (error) {
      return window.pages.told(error);
    }
  },
  read(name, path, output) {
    try {
      const { size, channels, data } = window.pages.figures[name].read({ path, output });
      return { size, channels, texels: window.pages.bytes(data) };
    } catch (error) {
      return window.pages.told(error);
    }
  },
};
"""


class PageError(Exception):
    """What the runtime threw."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        super().__init__(str(values.get("message")))
        self.message = dict(values)
        self.add_note(str(values.get("stack")))


VIEW = "document.querySelector('{} .cm-content').cmTile.view"
"""CodeMirror's view in an element, by the element's selector."""


def parts_of(packed: str) -> list[str]:
    """Return a page's style, its data as JSON and its script."""
    return gzip.decompress(base64.b64decode(packed)).decode().split("\0")


def script_of(folder: Path, entry: Path = ENGINE) -> Path:
    """Return the runtime with its engine as one script, bundled into a folder."""
    made = folder / "engine.js"
    command = [str(NODE or shutil.which("node")), "build.mjs", str(entry), str(made)]
    subprocess.run(command, cwd=HOME, check=True, capture_output=True)
    return made


class Pages:
    """One page with the runtime in it, until the block ends."""

    def __init__(
        self,
        folder: Path,
        flags: Sequence[str] = MESA,
        browser: type[Firefox] | None = None,
        entry: Path = ENGINE,
    ) -> None:
        script = script_of(folder, entry).read_text(encoding="utf-8")
        page = folder / "page.html"
        page.write_text(f"<!doctype html><meta charset=utf-8><script>{script}\n{_HARNESS}</script>", "utf-8")
        profile = folder / "profile"
        self.browser = browser(profile) if browser else Browser(profile, 640, 480, flags)
        self.browser.open(page.as_uri())

    def begin(self, page: Mapping[str, Any], **options: Any) -> None:
        """Open an engine for a page's sketches, in place of the one before."""
        self._asked("pages.begin", page["shared"], options)

    def open(self, sketch: Mapping[str, Any], name: str = "") -> dict[str, Any]:
        """Open a sketch under its name or another, compiled and with its data loaded."""
        return self._asked("pages.open", name or sketch["name"], sketch)

    def picture(self, name: str, soon: float = 0, **state: Any) -> Picture:
        """Return the picture of an open sketch with ``state`` set; with ``soon`` in slices of so many ms."""
        message = self._asked("pages.picture", name, state, soon)
        width, height = message["size"]
        texels = np.frombuffer(base64.b64decode(message["texels"]), np.uint8).reshape(height, width, 4)
        return Picture(texels[::-1], message["ran"], message["milliseconds"])

    def read(self, name: str, path: str, output: str) -> NDArray[np.float32]:
        """Return the texels of an open sketch's texture, (ny, nx, channels), row 0 south."""
        message = self._asked("pages.read", name, path, output)
        (width, height), channels = message["size"], message["channels"]
        return np.frombuffer(base64.b64decode(message["texels"]), "<f4").reshape(height, width, channels)

    def renderer(self) -> str:
        """Return what WebGL says it draws on."""
        script = """const gl = document.createElement("canvas").getContext("webgl2");
        const named = gl && gl.getExtension("WEBGL_debug_renderer_info");
        const found = named ? gl.getParameter(named.UNMASKED_RENDERER_WEBGL) : "";
        gl?.getExtension("WEBGL_lose_context")?.loseContext();
        return found"""
        return str(self.browser.run(script))

    def run(self, script: str, *values: object) -> Any:
        """Return what a function's body returns; `figures` are the players by name, `engine` theirs."""
        return self.browser.run(f"const {{ figures, engine }} = pages; {script}", *values)

    def _asked(self, function: str, *values: object) -> dict[str, Any]:
        text = json.dumps(values)  # as text: a driver copies values slowly
        message = self.browser.run(f"return {function}(...JSON.parse(arguments[0]))", text)
        if "error" in message:
            raise PageError(message["error"])
        return dict(message)

    def __enter__(self) -> Pages:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.browser.__exit__(kind, error, trace)


class Picture:
    """Pixels, (height, width, 4) bytes, top row first, and what ran for them."""

    def __init__(self, pixels: NDArray[np.uint8], ran: list[str], milliseconds: float) -> None:
        self.pixels = pixels
        self.ran = ran
        self.milliseconds = milliseconds

    def levels_off(self, other: NDArray[np.uint8]) -> int:
        """Return by how many levels of 255 the pixel differs that differs most."""
        assert self.pixels.shape == other.shape
        return int(np.abs(self.pixels.astype(int) - other).max())
