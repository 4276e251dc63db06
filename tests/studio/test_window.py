"""The window as a person meets it: a real X server, real files, a mouse and keys by xdotool.

What is on the screen is read from Xvfb's own framebuffer; what the window says of
itself comes as JSON lines (``playground.studio.status``).
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from playground.errors import ContextError
from playground.studio.app import run

from .screen import HILLS, ON_LINUX, Program, Screen, script

WIDTH, HEIGHT = 800, 500
PANEL = 330  # pixels at scale 1
RUN = script((WIDTH, HEIGHT))

TERRAIN = """// terrain.glsl -- hills
#include "inc/wave.glsl"
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high
float kernel(ivec2 texel) { return level * wave(vec2(texel) / vec2(size)); }
"""
WAVE = "// wave.glsl -- a wave\nfloat wave(vec2 p) { return 0.5 + 0.5 * sin(9.0 * p.x) * cos(7.0 * p.y); }\n"
SKETCH = HILLS + "camera = { azimuth = 200, elevation = 50, distance = 900 }\nset = { grid = 65 }\n"

pytestmark = ON_LINUX


class App(Program):
    """The window, running in a process of its own on a sketch in a folder."""

    def __init__(self, screen: Screen, folder: Path) -> None:
        self.sketch = folder / "sketch"
        self.pictures = folder / "pictures"
        (self.sketch / "inc").mkdir(parents=True, exist_ok=True)
        self.pictures.mkdir(exist_ok=True)
        for name, text in {"terrain.glsl": TERRAIN, "inc/wave.glsl": WAVE, "sketch.toml": SKETCH}.items():
            (self.sketch / name).write_text(text, encoding="utf-8")
        super().__init__(screen, folder, [sys.executable, "-c", RUN, str(self.sketch)], self.pictures)
        self.wait(lambda now: now["draws"] > 0)

    def picture(self) -> NDArray[np.uint8]:
        """Return the picture's part of the screen, without what notices and errors cover."""
        return self.screen.pixels()[60:220, PANEL + 10 : PANEL + 250]


SCREEN = WIDTH, HEIGHT  # [pixels]


@pytest.fixture(scope="module")
def shared(screen: Screen, tmp_path_factory: pytest.TempPathFactory) -> Iterator[App]:
    """Give a window for tests that leave the files and the picture as they were."""
    made = App(screen, tmp_path_factory.mktemp("shared"))
    yield made
    made.close()


@pytest.fixture
def app(screen: Screen, tmp_path: Path) -> Iterator[App]:
    made = App(screen, tmp_path)
    yield made
    made.close()


def save_in_place(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")


def save_by_rename(path: Path, text: str) -> None:
    neighbour = path.with_name(f".{path.name}.swp")
    neighbour.write_text(text, encoding="utf-8")
    neighbour.replace(path)


def is_red(pixel: NDArray[np.uint8]) -> bool:
    return bool(pixel[0] > 1.5 * pixel[1:].max())


def soon(is_so: Callable[[], bool], seconds: float = 60.0) -> bool:
    """Return whether something comes true: the screen may show a moment later what the status reports."""
    end = time.monotonic() + seconds
    while not (result := is_so()) and time.monotonic() < end:
        time.sleep(0.05)
    return result


def test_an_edit_that_works_one_that_breaks_and_one_that_fixes(shared: App) -> None:
    app, terrain, wave = shared, shared.sketch / "terrain.glsl", shared.sketch / "inc" / "wave.glsl"
    for save in (save_in_place, save_by_rename):
        first, first_hash = app.picture(), app.now()["picture"]
        assert first.std() > 1.0, "there is terrain on the screen"

        save(terrain, TERRAIN.replace("level * wave", "0.3 * level * wave"))
        app.wait(lambda now, old=first_hash: now["picture"] != old and not now["error"])
        lower = app.picture()
        assert not np.array_equal(lower, first)

        save(wave, WAVE.replace("cos(", "cosine("))
        now = app.wait(lambda now: now["error"])
        assert "wave.glsl:2:" in now["error"] and "cosine" in now["error"]
        np.testing.assert_array_equal(app.picture(), lower, "the last good picture stays")
        assert soon(lambda: is_red(app.screen.pixels()[HEIGHT - 40, PANEL + 30])), "a red box says so"

        save(wave, WAVE)
        save(terrain, TERRAIN)
        app.wait(lambda now, old=first_hash: now["picture"] == old and not now["error"])
        assert soon(lambda old=first: np.array_equal(app.picture(), old))
    assert app.process.poll() is None


@pytest.mark.slow
def test_missing_sketch_is_reported_and_resumes_once_restored(shared: App) -> None:
    folder, path = shared.sketch, shared.sketch / "sketch.toml"
    first, errors = shared.now()["picture"], shared.complaint().count("the file is gone")
    path.unlink()
    error = shared.wait(lambda now: now["error"])["error"]
    assert "the file is gone" in error and "sketch.toml" in error
    path.write_text(SKETCH.replace("relief = 200.0", "relief = 300.0"), encoding="utf-8")
    shared.wait(lambda now: not now["error"] and now["picture"] != first)
    path.unlink()
    time.sleep(0.15)
    path.write_text(SKETCH, encoding="utf-8")
    shared.wait(lambda now: not now["error"] and now["picture"] == first)
    folder.rename(folder.with_name("elsewhere"))
    error = shared.wait(lambda now: now["error"])["error"]
    assert "gone with its folder" in error
    assert shared.now()["picture"] == first, "the last good picture stays"
    folder.with_name("elsewhere").rename(folder)
    shared.wait(lambda now: not now["error"] and now["picture"] == first)
    errors = shared.complaint().count("the file is gone") - errors
    assert errors in (2, 3), "the terminal shows each once"
    assert "Traceback" not in shared.complaint()


@pytest.mark.slow
def test_the_mouse_and_the_keys(app: App) -> None:
    screen, x, y = app.screen, PANEL + 200, 200
    first = app.now()["picture"]

    screen.do(
        "mousemove",
        x,
        y,
        "mousedown",
        1,
        "mousemove",
        x + 60,
        y + 10,
        "mousemove",
        x + 90,
        y + 20,
        "mouseup",
        1,
    )
    turned = app.wait(lambda now: now["picture"] != first)["picture"]
    screen.do("mousemove", x, y, "click", 4)
    nearer = app.wait(lambda now: now["picture"] != turned)["picture"]
    screen.do("mousemove", x, y, "mousedown", 3, "mousemove", x + 40, y, "mouseup", 3)
    app.wait(lambda now: now["picture"] != nearer)

    screen.do("key", "r")
    app.wait(lambda now: now["picture"] == first)
    runs = app.now()["runs"]
    assert runs["height"] == 1, "the camera moved; the terrain was not made again"

    screen.do("mousemove", 100, 300, "mousedown", 1, "mousemove", 160, 300, "mouseup", 1)
    time.sleep(0.5)
    assert app.now()["picture"] == first, "over the panel the mouse is the panel's"

    screen.do("mousemove", x, y, "key", "m")
    app.wait(lambda now: now["map"] == "height:height" and now["picture"] != first)
    screen.do("key", "m")
    app.wait(lambda now: now["map"] == "" and now["picture"] == first)

    for name in ("sketch.png", "sketch-2.png"):
        screen.do("key", "s")
        now = app.wait(lambda now, name=name: now["saved"].endswith(name))
        assert any(name in text for text in now["notices"])
        assert (app.pictures / name).stat().st_size > 1000

    screen.do("key", "Tab")
    wide = app.wait(lambda now: now["picture"] != first)
    assert wide["draws"] > 0
    screen.do("key", "ctrl+q")
    assert app.ended() == 0, app.complaint()


PARTED = """// parted.glsl -- black on the left of a line, white on its right
#pragma kernel(output = "frame:rgba8")
uniform float line = 0.5;  //! divider Where it is
vec4 kernel(ivec2 texel) { return vec4(vec3(float(texel.x) + 0.5 < line * float(size.x) ? 0.0 : 1.0), 1.0); }
"""


@pytest.mark.slow
def test_a_line_in_the_picture_is_dragged_and_nothing_else_is(app: App) -> None:
    screen, wide = app.screen, WIDTH - PANEL
    (app.sketch / "parted.glsl").write_text(PARTED, encoding="utf-8")
    before = app.now()["picture"]
    sketch = SKETCH[: SKETCH.index("[view]")] + '[view]\nuse = "./parted"\n'
    save_in_place(app.sketch / "sketch.toml", sketch)
    shown = app.wait(lambda now: now["picture"] not in ("", before))["picture"]

    def lit_from() -> int:
        """Return the first bright pixel from the picture's left."""
        return int(np.argmax(screen.pixels()[150, PANEL:, 0] > 128))

    assert soon(lambda: abs(lit_from() - wide / 2) <= 1)
    middle = PANEL + wide // 2
    screen.do("mousemove", middle + 60, 150, "mousedown", 1, "mousemove", middle + 90, 150, "mouseup", 1)
    time.sleep(0.3)
    assert app.now()["picture"] == shown, "grabbed next to the line"
    for words in (("mousemove", middle + 2, 150), ("mousedown", 1), ("mousemove", middle + 50, 160)):
        screen.do(*words)
        time.sleep(0.15)
    screen.do("mousemove", middle + 100, 160, "mouseup", 1)
    app.wait(lambda now: now["picture"] != shown)
    assert soon(lambda: abs(lit_from() - (wide // 2 + 100)) <= 3)


# A driver that is reset whenever a file called "reset" is there.
RESET = """
import sys
from pathlib import Path
import playground.studio.window as window
def lost(self):
    mark = Path("reset")
    found = mark.exists()
    mark.unlink(missing_ok=True)
    return found
window.Window.lost = property(lost)
from playground.studio.app import run
sys.exit(run(sys.argv[1], size=(800, 500), time_limit=300))
"""


@pytest.mark.slow
def test_a_context_that_is_lost_costs_nothing_but_a_moment(
    screen: Screen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(globals(), "RUN", RESET)
    app = App(screen, tmp_path)
    try:
        first = app.now()["picture"]
        screen.do("mousemove", PANEL + 200, 200, "click", 4)
        nearer = app.wait(lambda now: now["picture"] != first)["picture"]
        panel, picture = screen.pixels()[:, :PANEL], app.picture()
        (app.pictures / "reset").touch()
        app.wait(lambda now: any("was reset" in text for text in now["notices"]))
        app.wait(lambda now: now["picture"] == nearer and not now["error"])
        assert soon(lambda: np.array_equal(app.picture(), picture))
        assert soon(lambda: np.array_equal(screen.pixels()[:50, :PANEL], panel[:50])), "and its texts"
        save_in_place(app.sketch / "terrain.glsl", TERRAIN.replace("level * wave", "0.3 * level * wave"))
        app.wait(lambda now: now["picture"] not in ("", nearer) and not now["error"])
        screen.do("mousemove", PANEL + 200, 200, "key", "ctrl+q")
        assert app.ended() == 0, app.complaint()
    finally:
        app.close()


@pytest.mark.slow
def test_after_a_crash_it_opens_as_it_was(screen: Screen, tmp_path: Path) -> None:
    app = App(screen, tmp_path)
    try:
        first = app.now()["picture"]
        screen.do("mousemove", PANEL + 200, 200, "click", 4)
        nearer = app.wait(lambda now: now["picture"] != first)["picture"]
        memories = tmp_path / "state" / "terrain-shader-playground" / "sessions"
        assert soon(lambda: any('"distance"' in p.read_text("utf-8") for p in memories.glob("*.json")))
        app.process.kill()
        app.process.wait(60)
    finally:
        app.close()
    app.status.unlink()
    again = App(screen, tmp_path)
    try:
        again.wait(lambda now: now["picture"] == nearer)
        screen.do("mousemove", PANEL + 200, 200, "key", "r")
        again.wait(lambda now: now["picture"] == first)
    finally:
        again.close()


@pytest.mark.slow
def test_nothing_is_drawn_while_nothing_happens(app: App) -> None:
    def draws_nothing(seconds: float) -> bool:
        before = app.now()["draws"]
        time.sleep(seconds)
        return bool(app.now()["draws"] == before)

    assert soon(lambda: draws_nothing(1.0)), "the first pictures are done"
    used = cpu_seconds(app.process.pid)
    assert draws_nothing(2.0)
    assert cpu_seconds(app.process.pid) - used < 0.5
    app.screen.do("key", "ctrl+q")
    assert app.ended() == 0, app.complaint()


def test_without_a_display_it_says_so_in_one_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET", "XDG_RUNTIME_DIR"):
        monkeypatch.delenv(name, raising=False)
    file = tmp_path / "terrain.frag"
    file.write_text("#version 330\nout vec4 c;\nvoid main() { c = vec4(1); }\n", encoding="utf-8")
    with pytest.raises(ContextError, match="no screen to open a window on") as caught:
        run(file)
    assert caught.value.exit_status == 2 and "\n" not in str(caught.value)
    assert "Traceback" not in capfd.readouterr().err


def cpu_seconds(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
