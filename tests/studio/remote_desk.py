"""A session without a window, driven by remotes: a frame is drawn here for each turn of a loop."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from playground.engine.engine import Engine
from playground.sketch.assign import values_of
from playground.studio.bench import Workbench
from playground.studio.interface import WindowControls
from playground.studio.remote.remotes import RemoteOptions, Remotes
from playground.studio.session import Session

from ..sketch_texts import map_of, passes

SIZE = (48, 32)
KERNEL = """// hills.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform float level = 0.25;  //! slider(0, 1) group("Shape") How high
uniform float scale = 10.0;  //! log_slider(1, 1000) unit("m")
uniform int   count = 3;     //! slider(0, 10)
uniform vec2  sun = vec2(135.0, 25.0); //! direction
uniform vec3  tint = vec3(1.0, 0.5, 0.0); //! colour
uniform int   kind = 0;      //! menu("round", "sharp", "flat")
uniform bool  rocks = true;  //! checkbox
uniform vec2  middle = vec2(0.5, 0.5); //! point
uniform vec2  place = vec2(0.0, 5.0); //! point(-1, 1, 0, 10)
uniform bool  fire = false;  //! button
uniform float free = 1.0;    //! Any number
uniform float phase = 0.0;   //! angle
uniform sampler2D grass;     //! file("grass.png")
float kernel(ivec2 texel) {
    float all = level + scale + float(count) + sun.x + tint.g + float(kind) + middle.x + free + phase;
    all += place.x + (fire ? 1.0 : 0.0);
    return level * float(texel.x) / float(size.x) + (rocks ? 1e-9 : 2e-9) * all * sin(time)
        + 0.0 * texelFetch(grass, ivec2(0), 0).r;
}
"""
SKETCH = (
    'format = 1\ntitle = "Hills"\nsize = 9\nextent = 100.0\n'
    + passes(height="./hills")
    + map_of("height")
    + '[[preset]]\nname = "high"\nset = { "height.level" = 0.75, "height.kind" = "flat" }\n'
)
TOKEN = "a-token-of-the-tests"


def write_sketch(folder: Path) -> Path:
    folder.mkdir()
    (folder / "hills.glsl").write_text(KERNEL, encoding="utf-8")
    (folder / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    from PIL import Image

    Image.new("L", (4, 4), 200).save(folder / "grass.png")
    return folder


class Harness:
    """A session, and the remotes that drive it."""

    def __init__(self, engine: Engine, path: Path) -> None:
        self._before = set(threading.enumerate())
        self.session = Session(engine, path)
        self.bench = Workbench(self.session, WindowControls(lambda: None), folder=path.parent)
        self.remotes = Remotes()
        self.woken = 0
        self.frame()
        self.frame()
        assert self.session.shown is not None, self.session.error
        self.bench.undo.history.steps.clear()
        self.bench.undo.history.done = 0

    def open(self, **options: Any) -> Remotes:
        self.remotes.close()
        self.remotes = Remotes(RemoteOptions(**options))
        self.remotes.attach(self.bench, self._wake)
        self.remotes.tell()
        return self.remotes

    def _wake(self) -> None:
        self.woken += 1

    def frame(self) -> None:
        """Do what the window does in a frame."""
        self.remotes.take()
        self.session.frame(SIZE)
        self.bench.undo.record()
        self.bench.take_notes()
        self.bench.problems.take(self.session.error, (), self.session.sketch)
        self.remotes.tell()

    def during(self, act: Callable[[], Any], limit: float = 60.0) -> Any:
        """Draw frames while another thread acts; return what it returns."""
        values: list[Any] = []

        def run() -> None:
            try:
                values.append((act(), None))
            except BaseException as error:
                values.append((None, error))

        thread = threading.Thread(target=run, daemon=True)
        thread.start()
        end = time.monotonic() + limit
        while thread.is_alive():
            assert time.monotonic() < end, "the client does not end"
            self.frame()
            time.sleep(0.002)
        answer, error = values[0]
        if error is not None:
            raise error
        return answer

    def until(self, holds: Callable[[], object], limit: float = 20.0) -> None:
        end = time.monotonic() + limit
        while not holds():
            assert time.monotonic() < end, "it does not happen"
            self.frame()
            time.sleep(0.002)

    def threads(self) -> set[threading.Thread]:
        """Return the threads that were started since, and have not ended."""
        return set(threading.enumerate()) - self._before

    def pressed(self) -> list[str]:
        """Return a list of the buttons that are pressed from now on."""
        names: list[str] = []
        press = self.session.press
        self.session.press = lambda path: (names.append(path), press(path))[1]  # type: ignore
        return names

    def value(self, path: str) -> Any:
        assert self.session.sketch is not None
        return values_of(self.session.sketch)[path]

    @property
    def notices(self) -> list[str]:
        self.bench.take_notes()
        return [notice.text for notice in self.bench.notices.items]

    def close(self) -> None:
        self.remotes.close()
        self.session.release()
