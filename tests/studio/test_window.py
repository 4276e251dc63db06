"""The window as a person meets it: a real X server, real files, a mouse and keys by xdotool.

Three tours each open one window and go through all that it is for: edit, break, survive. What needs another
start has a test of its own. What is on the screen is read from Xvfb's framebuffer; what the window
reports of itself comes as JSON lines (``playground.studio.status``).
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from playground.data.image_files import write_png
from playground.errors import ContextError
from playground.sketch.load import load
from playground.studio.app import run, title_of
from playground.studio.channels.channels import channels
from playground.studio.window import WindowPlacement, on_screen

from ..data.test_bounds import npz
from ..sketch_texts import map_of, passes
from .saves import save_by_rename, save_in_place
from .screen import HILLS, LIMIT, ON_LINUX, ROOT, Program, Screen, script

pytestmark = ON_LINUX
SCREEN = 1000, 700  # [pixels]
SIZE = WIDTH, HEIGHT = 900, 640
PANEL = 330  # [pixels] at scale 1
MIDDLE = 600, 150

# A window that files in its folder do things to: a lost context, a drop, a slow renderer, a bug in a panel,
# another editor. It writes where the slider of the level is.
RUN = f"""
import os, sys, time
from pathlib import Path
from imgui_bundle import imgui
import playground.studio.window as window
from playground.studio.app import run
from playground.studio.drops import Drops
from playground.studio.problems.panel import ErrorsList
from playground.studio.session import Session
slide, frame, take, draw = imgui.slider_float, Session.frame, Drops.take, ErrorsList.draw
def noting(label, *rest):
    answer = slide(label, *rest)
    if label == "##height.level":
        low, size = imgui.get_item_rect_min(), imgui.get_item_rect_size()
        Path("slider.txt").write_text(f"{{low.x + 0.3 * size.x:.0f}} {{low.y + size.y / 2:.0f}}")
    return answer
def taken(name):
    found = Path(name).exists()
    Path(name).unlink(missing_ok=True)
    return found
def slowly(session, size):
    time.sleep(0.4 if Path("slow").exists() else 0.0)
    if Path("editor").exists():
        os.environ["PLAYGROUND_EDITOR"] = Path("editor").read_text()
    return frame(session, size)
def with_drop(drops, paths):
    dropped = [Path(Path("drop").read_text())] if Path("drop").exists() else []
    Path("drop").unlink(missing_ok=True)
    return take(drops, [*paths, *dropped])
def broken(*rest):
    if not Path("broken").exists():
        return draw(*rest)
    imgui.push_style_color(imgui.Col_.text, (1.0, 0.0, 0.0, 1.0))
    imgui.begin_group()
    imgui.tree_node_ex("###")
    raise IndexError("no such row")
imgui.slider_float, Session.frame, Drops.take, ErrorsList.draw = noting, slowly, with_drop, broken
window.Window.lost = property(lambda self: taken("reset"))
size = {SIZE} if "--remembered" not in sys.argv else None
sys.exit(run(sys.argv[1], size=size, time_limit=600))
"""
TERRAIN = """// terrain.glsl -- hills
#include "inc/wave.glsl"
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high
float kernel(ivec2 texel) { return level * wave(vec2(texel) / vec2(size)); }
"""
WAVE = "// wave.glsl -- a wave\nfloat wave(vec2 p) { return 0.5 + 0.5 * sin(9.0 * p.x) * cos(7.0 * p.y); }\n"
SKETCH = (
    HILLS.replace("format = 1", "format = 1  # ours").replace(
        'use = "./terrain"\n', 'use = "./terrain"\nset = { level = 0.75 }   # by eye\n'
    )
    + "camera = { azimuth = 200, elevation = 50, distance = 900 }\nset = { grid = 65 }\n"
)
FILES = {"terrain.glsl": TERRAIN, "inc/wave.glsl": WAVE, "sketch.toml": SKETCH}
SLOPE = (
    TERRAIN.replace('#include "inc/wave.glsl"\n', "")
    .replace("wave(", "fract(2.0 * dot(vec2(0.5, 0.1), ")
    .replace("vec2(size))", "vec2(size)))")
)
TIMED = (
    'format = 1\ntitle = "Timed"\nsize = [65, 33]\nextent = [1000.0, 500.0]\nrelief = 200.0\n'
    + passes(height=("./terrain", "set = { level = 0.75 }"))
    + map_of("height")
    + '[[keyframe]]\ntime = 1.0\nset = { "view.lowest" = 0.0 }\n'
    '[[keyframe]]\ntime = 2.0\nset = { "view.lowest" = -1.0 }\n'
)
PARTED = """// parted.glsl -- black on the left of a line, white on its right
#pragma kernel(output = "frame:rgba8")
uniform float line = 0.5;  //! divider Where it is
vec4 kernel(ivec2 texel) { return vec4(vec3(float(texel.x) + 0.5 < line * float(size.x) ? 0.0 : 1.0), 1.0); }
"""
HOLE = """// terrain.glsl -- hills with a hole
#pragma kernel(output = "height:r32f")
uniform float root = -1.0; //! slider(-1, 1)
float kernel(ivec2 texel) { return texel / 4 == ivec2(3, 5) ? sqrt(root) : 0.5; }
"""
# llvmpipe cuts every loop at 65,535 iterations, so that it takes many to keep it busy.
LOOP = " for (int i = 0; i < 60000; i++) s += sin(float(i) + s);"
BUSY = TERRAIN.replace("{ return", f"{{ float s = 0.0;{LOOP * 20} if (s == 0.5) return s; return")


class App(Program):
    """The window, running in a process of its own on a sketch in a folder."""

    def __init__(self, screen: Screen, folder: Path, *words: str) -> None:
        self.folder = folder / "hills"
        for name, text in FILES.items():
            path = self.folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            if not path.exists():
                path.write_text(text, encoding="utf-8")
        (folder / "status.jsonl").unlink(missing_ok=True)
        super().__init__(screen, folder, [sys.executable, "-c", RUN, str(self.folder), *words], folder)
        self.wait(lambda now: now["draws"] > 0)
        screen.do("mousemove", *MIDDLE)

    def do(self, *words: object) -> None:
        self.screen.do(*words)

    def picture(self) -> NDArray[np.uint8]:
        """Return the picture's part of the screen, without what notices and errors cover."""
        return self.screen.pixels()[60:220, PANEL + 10 : PANEL + 250]

    def shows(self, picture: str) -> None:
        self.wait(lambda now: now["picture"] == picture and not now["error"])

    def changes(self, picture: str) -> str:
        """Wait until another picture is shown, and nothing is wrong; return it."""
        now = self.wait(lambda now: now["picture"] not in ("", picture) and not now["error"])
        return str(now["picture"])

    def says(self, text: str) -> None:
        self.wait(lambda now: any(text in notice for notice in now["notices"]))

    def save(self, name: str, text: str) -> None:
        save_in_place(self.folder / name, text.encode())

    def drop(self, path: Path) -> None:
        """Drop a file on the window."""
        (self.folder.parent / "drop").write_text(str(path), encoding="utf-8")
        self.do("mousemove", MIDDLE[0] + 1, MIDDLE[1], "mousemove", *MIDDLE)

    def open_beside(self, name: str, **files: str) -> Path:
        """Drop another sketch; return its folder."""
        folder = self.folder.parent / name
        folder.mkdir(exist_ok=True)
        for stem, text in files.items():
            (folder / f"{stem}{'.toml' if stem == 'sketch' else '.glsl'}").write_text(text, encoding="utf-8")
        before = self.now()["picture"]
        self.drop(folder)
        self.changes(before)
        return folder

    def quit(self) -> None:
        self.do("mousemove", *MIDDLE, "key", "ctrl+q")
        assert self.ended() == 0, self.complaint()

    def name(self) -> str:
        return self.ask("getwindowname", self.window())

    def geometry(self) -> tuple[int, ...]:
        result = self.ask("getwindowgeometry", "--shell", self.window())
        return tuple(int(n) for n in re.findall(r"(?:X|Y|WIDTH|HEIGHT)=(-?\d+)", result))

    def window(self) -> str:
        return self.ask("search", "--sync", "--onlyvisible", "--name", "terrain shader playground").split()[0]

    def ask(self, *words: str) -> str:
        environment = {**os.environ, "DISPLAY": self.screen.display}
        command = [self.screen.xdotool, *words]
        return subprocess.check_output(command, env=environment, text=True, timeout=180).strip()


@pytest.fixture
def app(screen: Screen, tmp_path: Path) -> Iterator[App]:
    made = App(screen, tmp_path)
    yield made
    made.close()


def soon(is_so: Callable[[], bool], seconds: float = LIMIT) -> bool:
    """Return whether something comes true: the screen may show a moment later what the status reports."""
    end = time.monotonic() + seconds
    while not (result := is_so()) and time.monotonic() < end:
        time.sleep(0.05)
    return result


# ── edit ─────────────────────────────────────────────────────────────────────


@pytest.mark.slow
def test_tour_of_editing(app: App) -> None:
    assert app.name() == "hills – terrain shader playground"
    nothing_is_drawn_at_rest(app)
    the_mouse_turns_the_terrain(app)
    keys_show_maps_and_save_pictures(app)
    a_value_is_typed_undone_and_saved(app)
    it_fills_the_screen_and_comes_back(app)
    escape_closes_one_layer_at_a_time(app)
    a_divider_is_dragged(app)
    boxes_comparison_and_time(app)
    app.quit()


def nothing_is_drawn_at_rest(app: App) -> None:
    def draws_nothing(seconds: float) -> bool:
        before = app.now()["draws"]
        time.sleep(seconds)
        return bool(app.now()["draws"] == before)

    def cpu_seconds() -> float:
        fields = Path(f"/proc/{app.process.pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    assert soon(lambda: draws_nothing(1.0)), "the first pictures are done"
    used = cpu_seconds()
    assert draws_nothing(2.0)
    assert cpu_seconds() - used < 0.5


def the_mouse_turns_the_terrain(app: App) -> None:
    x, y = PANEL + 200, 200
    first = app.now()["picture"]
    app.do("mousemove", x, y, "mousedown", 1, "mousemove", x + 60, y + 10)
    app.do("mousemove", x + 90, y + 20, "mouseup", 1)
    turned = app.changes(first)
    app.do("mousemove", x, y, "click", 4)
    nearer = app.changes(turned)
    app.do("mousemove", x, y, "mousedown", 3, "mousemove", x + 40, y, "mouseup", 3)
    app.changes(nearer)
    app.do("key", "r")
    app.shows(first)
    assert app.now()["runs"]["height"] == 1, "the camera moved; the terrain was not made again"
    app.do("mousemove", 100, 300, "mousedown", 1, "mousemove", 160, 300, "mouseup", 1)
    time.sleep(0.5)
    assert app.now()["picture"] == first, "over the panel the mouse is the panel's"
    app.do("mousemove", *MIDDLE)


def keys_show_maps_and_save_pictures(app: App) -> None:
    first = app.now()["picture"]
    app.do("key", "m")
    app.wait(lambda now: now["map"] == "height:height" and now["picture"] != first)
    app.do("key", "m")
    app.wait(lambda now: now["map"] == "" and now["picture"] == first)
    for name in ("hills.png", "hills-2.png"):
        app.do("key", "s")
        app.wait(lambda now, name=name: now["saved"].endswith(name))
        app.says(name)
        assert (app.folder.parent / name).stat().st_size > 1000
    app.do("key", "h")
    wide = app.changes(first)
    app.do("key", "h")
    app.shows(first)
    assert wide != first


def a_value_is_typed_undone_and_saved(app: App) -> None:
    first, file = app.now()["picture"], app.folder / "sketch.toml"
    level = (app.folder.parent / "slider.txt").read_text().split()
    app.do("mousemove", *level, "keydown", "ctrl", "sleep", 0.5, "click", 1, "sleep", 0.5, "keyup", "ctrl")
    app.wait(lambda now: now["takes_text"])
    app.do("type", "--delay", 200, "1/4")
    app.do("key", "Return")
    low = app.changes(first)
    app.do("mousemove", *MIDDLE, "key", "ctrl+s")
    app.says("saved 1 value")
    assert file.read_text(encoding="utf-8") == SKETCH.replace("0.75", "0.25")
    reloaded = app.wait(lambda now: now["stage"] == "NONE")
    assert reloaded["picture"] == low and not reloaded["error"]
    for keys, picture in (("ctrl+z", first), ("ctrl+shift+z", low), ("ctrl+z", first)):
        app.do("key", keys)
        app.shows(picture)
    app.do("key", "ctrl+s")
    app.wait(lambda now: file.read_text(encoding="utf-8") == SKETCH)


def it_fills_the_screen_and_comes_back(app: App) -> None:
    def full() -> bool:
        return bool(app.screen.pixels()[HEIGHT + 50 :, :200].any())

    assert not full()
    for filled in (True, False):
        before = app.now()["picture"]
        app.do("key", "F11")
        app.changes(before)
        app.wait(lambda now, filled=filled: full() == filled)


def escape_closes_one_layer_at_a_time(app: App) -> None:
    open_layers = []
    for key, layer in (("g", "passes"), ("a", "A/B"), ("F11", "full screen")):
        app.do("key", key)
        open_layers.append(layer)
        app.wait(lambda now: now["layers"] == open_layers)
    while open_layers:
        del open_layers[0]
        app.do("key", "Escape")
        app.wait(lambda now: now["layers"] == open_layers)
    app.do("key", "Escape")
    app.says("Ctrl+Q quits")
    app.do("key", "g")  # the strip is closed again


def a_divider_is_dragged(app: App) -> None:
    sketch = SKETCH[: SKETCH.index("[view]")] + '[view]\nuse = "./parted"\n'
    app.open_beside("parted", parted=PARTED, terrain=SLOPE, sketch=sketch)
    shown, wide = app.now()["picture"], WIDTH - PANEL

    def lit_from() -> int:
        """Return the first bright pixel from the picture's left."""
        return int(np.argmax(app.screen.pixels()[250, PANEL:, 0] > 128))

    assert soon(lambda: abs(lit_from() - wide / 2) <= 1)
    middle = PANEL + wide // 2
    app.do("mousemove", middle + 60, 250, "mousedown", 1, "mousemove", middle + 90, 250, "mouseup", 1)
    time.sleep(0.3)
    assert app.now()["picture"] == shown, "grabbed next to the line"
    for words in (("mousemove", middle + 2, 250), ("mousedown", 1), ("mousemove", middle + 50, 260)):
        app.do(*words)
        time.sleep(0.15)
    app.do("mousemove", middle + 100, 260, "mouseup", 1)
    app.changes(shown)
    assert soon(lambda: abs(lit_from() - (wide // 2 + 100)) <= 3)


def boxes_comparison_and_time(app: App) -> None:
    folder = app.open_beside("timed", terrain=SLOPE, sketch=TIMED)
    assert soon(lambda: app.name() == "timed – terrain shader playground")
    app.do("mousemove", *MIDDLE, "key", "space", "key", "0")
    app.wait(lambda now: not now["playing"])
    app.do("mousemove", 100, HEIGHT - 100, "mousemove", 620, 300)
    app.wait(lambda now: not now["notices"])
    rested = app.now()["picture"]

    def picture() -> NDArray[np.uint8]:
        """Return the part of the screen that shows the terrain, between what lies over it above and below."""
        return app.screen.pixels()[70 : HEIGHT - 60, PANEL + 4 : WIDTH - 4]

    def until(done: Callable[[], object]) -> None:
        app.wait(lambda _: done())

    before = picture()
    draws = app.now()["draws"]
    app.do("key", "i")
    until(lambda: (picture() != before).any(axis=2).sum() > 4000)
    assert app.now()["draws"] == draws, "nothing is drawn for a box at the mouse"
    app.do("key", "i")
    until(lambda: (picture() == before).all())
    app.do("key", "g")
    until(lambda: (picture() != before).any(axis=2).mean() > 0.3)
    app.do("key", "g")
    until(lambda: (picture() == before).all())

    # A: the left half stays what it was while the file makes another of the right one.
    app.do("key", "a")
    (folder / "sketch.toml").write_text(TIMED.replace("0.75", "0.25"), encoding="utf-8")
    app.changes(rested)
    middle = before.shape[1] // 2

    def halves() -> bool:
        now = picture()
        left = (now[:, : middle - 40] == before[:, : middle - 40]).all()
        return bool(left and (now[:, middle + 40 :] != before[:, middle + 40 :]).any(axis=2).mean() > 0.3)

    until(halves)
    line = (PANEL + WIDTH) // 2
    app.do("mousemove", line, 400, "sleep", 0.3, "mousedown", 1, "sleep", 0.3)
    app.do("mousemove", line + 60, 400, "sleep", 0.3, "mousemove", line + 120, 400, "sleep", 0.3)
    app.do("mouseup", 1, "mousemove", 620, 300)  # the mouse itself is on the screen as well
    moved = middle + 80
    until(lambda: (picture()[:, :moved] == before[:, :moved]).all())
    app.do("key", "a")

    # The bar of time: a click there goes to that moment, and a comma a picture back.
    now = app.wait(lambda now: now["stage"] == "NONE")["picture"]
    app.do("mousemove", WIDTH - 40, HEIGHT - 20, "sleep", 0.3, "mousedown", 1, "sleep", 0.3, "mouseup", 1)
    late = app.changes(now)
    app.do("mousemove", 620, 300, "type", ",")
    app.changes(late)


# ── break ────────────────────────────────────────────────────────────────────


def test_an_edit_that_works_one_that_breaks_and_one_that_fixes(app: App) -> None:
    terrain, wave = app.folder / "terrain.glsl", app.folder / "inc" / "wave.glsl"
    for save in (save_in_place, save_by_rename):
        first, first_hash = app.picture(), app.now()["picture"]
        assert first.std() > 1.0, "there is terrain on the screen"

        save(terrain, TERRAIN.replace("level * wave", "0.3 * level * wave").encode())
        app.changes(first_hash)
        lower = app.picture()
        assert not np.array_equal(lower, first)

        save(wave, WAVE.replace("cos(", "cosine(").encode())
        now = app.wait(lambda now: now["error"])
        assert "wave.glsl:2:" in now["error"] and "cosine" in now["error"]
        np.testing.assert_array_equal(app.picture(), lower, "the last good picture stays")
        assert soon(lambda: is_red(app.screen.pixels()[HEIGHT - 40, PANEL + 30])), "a red box says so"

        save(wave, WAVE.encode())
        save(terrain, TERRAIN.encode())
        app.shows(first_hash)
        assert soon(lambda old=first: np.array_equal(app.picture(), old))


def is_red(pixel: NDArray[np.uint8]) -> bool:
    return bool(pixel[0] > 1.5 * pixel[1:].max())


@pytest.mark.slow
def test_tour_of_breaking(app: App) -> None:
    an_editor_is_started_at_the_line(app)
    the_editor_in_the_window_fixes_the_file(app)
    a_slow_check_is_announced(app)
    a_list_that_cannot_be_drawn_is_left_out(app)
    a_missing_sketch_is_reported_until_it_is_back(app)
    words_lead_to_the_texels_in_magenta(app)
    assert app.complaint().count("Traceback") == 1, "of the list alone"
    app.quit()


def an_editor_is_started_at_the_line(app: App) -> None:
    value, program = app.folder.parent / "opened.txt", app.folder.parent / "editor.py"
    program.write_text("import pathlib, sys\npathlib.Path(sys.argv[1]).write_text('|'.join(sys.argv[2:]))\n")
    command = f"{sys.executable} {program} {value} {{file}} {{line}} {{column}}"
    (app.folder.parent / "editor").write_text(command)
    app.save("inc/wave.glsl", WAVE.replace("cos(", "cosine("))
    app.wait(lambda now: now["error"])
    app.do("key", "shift+e")
    app.wait(lambda _: value.exists() and value.read_text())
    column = WAVE.splitlines()[1].index("cos(") + 1
    assert value.read_text() == f"{app.folder / 'inc/wave.glsl'}|2|{column}"
    app.says("opened hills/inc/wave.glsl in")


def the_editor_in_the_window_fixes_the_file(app: App) -> None:
    (app.folder.parent / "editor").write_text("builtin")
    app.save("inc/wave.glsl", WAVE)
    good = app.wait(lambda now: not now["error"])["picture"]
    app.save("inc/wave.glsl", WAVE.replace("cos(", "os("))
    app.wait(lambda now: now["error"])
    app.do("key", "e")
    app.wait(lambda now: now["typing"] == ["wave.glsl"])
    app.do("key", "c")  # the cursor is before "os"
    app.wait(lambda now: now["unsaved"] == ["wave.glsl"])
    app.do("keydown", "ctrl", "sleep", 0.3, "key", "s", "sleep", 0.3, "keyup", "ctrl")
    app.shows(good)
    assert (app.folder / "inc/wave.glsl").read_text(encoding="utf-8") == WAVE
    app.do("key", "Escape")
    app.wait(lambda now: not now["typing"])
    app.do("key", "ctrl+e")  # in so narrow a window the code is where the picture was


def a_slow_check_is_announced(app: App) -> None:
    app.save("terrain.glsl", BUSY)
    app.wait(lambda now: now["trying"] == "terrain.glsl")
    time.sleep(1.5)
    app.save("terrain.glsl", TERRAIN.replace("level *", "0.9 * level *"))
    app.wait(lambda now: not now["trying"] and now["stage"] == "NONE" and not now["error"])


def a_list_that_cannot_be_drawn_is_left_out(app: App) -> None:
    first = app.now()["picture"]
    (app.folder.parent / "broken").touch()
    app.save("terrain.glsl", TERRAIN.replace("wave(vec2", "wive(vec2"))
    app.wait(lambda now: now["error"] and any("list of errors failed" in n for n in now["notices"]))
    time.sleep(0.5)
    app.save("terrain.glsl", TERRAIN)
    app.changes(first)
    assert app.complaint().count("Traceback") == 1, "the terminal shows it once"
    (app.folder.parent / "broken").unlink()


def a_missing_sketch_is_reported_until_it_is_back(app: App) -> None:
    folder, path = app.folder, app.folder / "sketch.toml"
    first, errors = app.now()["picture"], app.complaint().count("the file is gone")
    path.unlink()
    error = app.wait(lambda now: now["error"])["error"]
    assert "the file is gone" in error and "sketch.toml" in error
    app.save("sketch.toml", SKETCH.replace("relief = 200.0", "relief = 300.0"))
    app.changes(first)
    path.unlink()
    time.sleep(0.15)
    app.save("sketch.toml", SKETCH)
    app.shows(first)
    folder.rename(folder.with_name("elsewhere"))
    error = app.wait(lambda now: now["error"])["error"]
    assert "gone with its folder" in error
    assert app.now()["picture"] == first, "the last good picture stays"
    folder.with_name("elsewhere").rename(folder)
    app.shows(first)
    errors = app.complaint().count("the file is gone") - errors
    assert errors in (2, 3), "the terminal shows each once"


def words_lead_to_the_texels_in_magenta(app: App) -> None:
    sketch = "format = 1\nsize = 33\n" + passes(height="./terrain") + map_of("height")
    folder = app.open_beside("hole", terrain=HOLE, sketch=sketch)
    result = app.wait(lambda now: now["not_finite"])["not_finite"]
    assert "pass 'height', output 'height': NaN at texel (12, 20)" in result[0]
    app.do("mousemove", 386, 52, "sleep", 1, "click", 1)  # "Show it", at scale 1
    app.wait(lambda now: now["map"] == "height:height")
    magenta = (app.screen.pixels()[:, PANEL + 10 :] == np.array([255, 0, 255])).all(axis=2).sum()
    assert magenta > 1000, "sixteen texels of a map of 33, on half a thousand pixels"
    (folder / "terrain.glsl").write_text(HOLE.replace("= -1.0", "= 1.0"), encoding="utf-8")
    app.wait(lambda now: not now["not_finite"])


# ── survive ──────────────────────────────────────────────────────────────────


@pytest.mark.slow
def test_tour_of_surviving(screen: Screen, tmp_path: Path) -> None:
    app = App(screen, tmp_path, "--remembered")
    try:
        larger = app.now()["picture"]
        app.ask("windowsize", "--sync", app.window(), "620", "410")
        app.ask("windowmove", "--sync", app.window(), "210", "150")
        assert soon(lambda: app.geometry() == (210, 150, 620, 410))
        app.changes(larger)
        app.do("mousemove", 650, 350)
        nearer = a_lost_context_costs_nothing_but_a_moment(app)
        memories = tmp_path / "state" / "terrain-shader-playground" / "sessions"
        texts = ("distance", "620")
        assert soon(lambda: any(all(t in p.read_text() for t in texts) for p in memories.glob("*.json")))
        app.process.kill()
        app.process.wait(60)
        app.close()

        app = App(screen, tmp_path, "--remembered")
        assert app.geometry() == (210, 150, 620, 410), "it opens where it was"
        app.shows(nearer)
        app.ask("windowmove", "--sync", app.window(), "900", "600")  # most of it beyond the screen
        app.do("mousemove", 950, 650, "key", "r")
        app.changes(nearer)
        app.do("key", "ctrl+q")
        assert app.ended() == 0, app.complaint()
        app.close()

        app = App(screen, tmp_path, "--remembered")
        assert app.geometry() == (1000 - 620, 700 - 410, 620, 410)
        app.ask("windowsize", "--sync", app.window(), str(WIDTH), str(HEIGHT))
        app.ask("windowmove", "--sync", app.window(), "0", "0")
        app.wait(lambda now: now["stage"] == "NONE")
        a_slow_double_click_opens_a_field(app)
        a_bomb_costs_the_window_nothing(app)
        shutil.rmtree(tmp_path / "bomb")
        app.wait(lambda now: "gone with its folder" in now["error"])
        app.quit()
    finally:
        app.close()


def a_lost_context_costs_nothing_but_a_moment(app: App) -> str:
    first = app.now()["picture"]
    app.do("click", 4)
    nearer = app.changes(first)

    def text() -> NDArray[np.uint8]:
        return app.screen.pixels()[150:200, 210 : 210 + PANEL]

    def picture() -> NDArray[np.uint8]:
        return app.screen.pixels()[220:330, 210 + PANEL + 10 : 210 + 600]

    panel, before = text(), picture()
    (app.folder.parent / "reset").touch()
    app.says("was reset")
    app.shows(nearer)
    assert soon(lambda: np.array_equal(picture(), before))
    assert soon(lambda: np.array_equal(text(), panel)), "and its texts"
    app.save("terrain.glsl", TERRAIN.replace("level * wave", "0.3 * level * wave"))
    app.changes(nearer)
    app.save("terrain.glsl", TERRAIN)
    app.shows(nearer)
    return nearer


def a_slow_double_click_opens_a_field(app: App) -> None:
    """No key that is typed meanwhile is lost, or taken for a shortcut."""
    (app.folder.parent / "slow").touch()
    level = (app.folder.parent / "slider.txt").read_text().split()
    for text, value in (("0.25", 0.25), ("0.75", 0.75)):
        click = ["mousedown", "1", "sleep", "0.03", "mouseup", "1"]
        typed = [part for c in text for part in ("key", "period" if c == "." else c)]
        app.do("mousemove", *level, "sleep", 0.6, *click, "sleep", 0.1, *click, "sleep", 0.05, *typed)
        app.wait(lambda now: now["takes_text"])
        app.do("sleep", 0.6, "key", "Return")
        app.wait(lambda now, value=value: now["edited"].get("height.level") == value)
    now = app.now()
    assert not now["layers"] and not now["map"] and not now["saved"], "no letter was a shortcut"
    (app.folder.parent / "slow").unlink()
    app.do("mousemove", *MIDDLE)


def a_bomb_costs_the_window_nothing(app: App) -> None:
    folder = app.folder.parent / "bomb"
    folder.mkdir()
    np.savez_compressed(folder / "terrain.npz", elevation=np.eye(65, dtype=np.float32))
    set_by = 'use = "generation/heightmap"\nset = { elevation = "terrain.npz" }'
    text = HILLS.replace('use = "./terrain"', set_by) + "set = { grid = 33 }\n"
    app.open_beside("bomb", sketch=text)
    first, before = app.wait(lambda now: now["stage"] == "NONE")["picture"], most_memory(app)
    npz(folder / "terrain.npz")
    app.wait(lambda now: "would become 1024 MiB" in now["error"])
    app.do("click", 4)  # nearer: the picture is not drawn with what failed
    time.sleep(1.0)
    assert app.now()["picture"] == first, "the last good picture stays"
    assert most_memory(app) - before < 200 * 2**20
    Path(f"/proc/{app.process.pid}/clear_refs").write_text("5")  # the most memory is counted from here on
    before = most_memory(app)
    with (folder / "terrain.npy").open("wb") as file:  # 512 MiB, all of it holes: read in turn
        head = {"descr": "<f8", "fortran_order": False, "shape": (8192, 8192)}
        np.lib.format.write_array_header_1_0(file, head)
        file.truncate(file.tell() + 8 * 8192**2)
    save_in_place(folder / "sketch.toml", text.replace("terrain.npz", "terrain.npy").encode())
    app.changes(first)
    # It is read as a terrain of 4097 x 4097 texels: sums of float64, 128 MiB. A band has 2^22 texels: 32
    # MiB as they are in the file, 16 as float32, 32 as float64, 32 of the band before, 8 that say where
    # there is no data, and 8 of what is summed across: 256. Then that terrain is brought to the sketch's
    # 65 x 65: 64 as float32, 64 from 0 to 1 and 128 as float64: 256. The window's frames have the rest.
    assert most_memory(app) - before < 300 * 2**20


def most_memory(window: Program) -> int:
    """Return the most memory that a window has had so far [bytes]."""
    status = Path(f"/proc/{window.process.pid}/status").read_text()
    return int(status.partition("VmHWM:")[2].split()[0]) * 1024


# ── other tools' shaders ─────────────────────────────────────────────────────

HALVES = """void mainImage(out vec4 c, in vec2 p) {
    c = p.x < 0.5 * iResolution.x ? texture(iChannel0, p) : texture(iChannel1, p);
}
"""
PASTED = "// Half red\nvoid mainImage(out vec4 c, in vec2 p) { c = vec4(0.5, 0.0, 0.0, 1.0); }\n"
CHOOSER, BLACK = (200, 348), (150, 377)  # of the first channel, at scale 1
LATER = 412, 341  # the second channel in the menu of a drop
LEFT, RIGHT = (420, 500), (420, 760)  # row, column of a pixel in each half
HOLDS = """
import sys
import imgui_bundle
import glfw
glfw.init()
glfw.window_hint(glfw.VISIBLE, False)
window = glfw.create_window(8, 8, "clipboard", None, None)
glfw.set_clipboard_string(window, sys.argv[1])
print("there", flush=True)
while True:
    glfw.wait_events_timeout(1.0)
"""


@pytest.fixture
def clipboard(screen: Screen) -> Iterator[None]:
    """Hold a shader's text on the screen's clipboard, as another program does."""
    environment = {**os.environ, "DISPLAY": screen.display}
    command = [sys.executable, "-c", HOLDS, PASTED]
    holder = subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)
    assert holder.stdout is not None and holder.stdout.readline() == "there\n"
    yield
    holder.kill()
    holder.wait(10)
    holder.stdout.close()


@pytest.mark.slow
@pytest.mark.room("dialects")
@pytest.mark.usefixtures("clipboard")
def test_tour_of_a_shader_of_another_tool(screen: Screen, tmp_path: Path) -> None:
    file = tmp_path / "halves.frag"
    file.write_text(HALVES, encoding="utf-8")
    program = Program(screen, tmp_path, [sys.executable, "-c", RUN, str(file)], tmp_path)

    def pixel(position: tuple[int, int]) -> tuple[int, ...]:
        return tuple(int(n) for n in screen.pixels()[position])

    def idle(but: str) -> str:
        now = program.wait(lambda now: now["picture"] != but and now["stage"] == "NONE" and not now["error"])
        return str(now["picture"])

    try:
        # A channel is chosen, and a dropped image feeds the other.
        first = program.wait(lambda now: now["draws"] > 0)["picture"]
        assert pixel(LEFT) != (0, 0, 0)
        screen.do("mousemove", *CHOOSER, "sleep", 0.5, "click", 1)
        program.wait(lambda now: "popup" in now["layers"])
        screen.do("mousemove", *BLACK, "sleep", 0.5, "click", 1)
        black = idle(first)
        assert pixel(LEFT) == (0, 0, 0) and pixel(RIGHT) != (0, 0, 0)
        write_png(tmp_path / "green.png", np.full((6, 5, 4), (0, 255, 0, 255), np.uint8))
        (tmp_path / "drop").write_text(str(tmp_path / "green.png"), "utf-8")
        screen.do("mousemove", 700, 560)
        program.wait(lambda now: "popup" in now["layers"])
        screen.do("mousemove", *LATER, "sleep", 0.5, "click", 1)
        idle(black)
        assert pixel(LEFT) == (0, 0, 0) and pixel(RIGHT) == (0, 255, 0)
        screen.do("mousemove", 700, 500, "key", "ctrl+z")
        program.wait(lambda now: now["picture"] == black)
        screen.do("key", "ctrl+z")
        program.wait(lambda now: now["picture"] == first)
        screen.do("key", "ctrl+shift+z")
        program.wait(lambda now: now["picture"] == black)

        # A text on the clipboard opens, and the shader before it comes back.
        screen.do("key", "ctrl+v")
        program.wait(lambda now: any("pasted as half_red.frag" in text for text in now["notices"]))
        second = idle(black)
        assert (tmp_path / "half_red.frag").read_text("utf-8") == PASTED
        assert pixel((450, 600)) == (128, 0, 0)
        screen.do("key", "BackSpace")
        program.wait(lambda now: now["picture"] == black)
        screen.do("key", "shift+BackSpace")
        program.wait(lambda now: now["picture"] == second)
        screen.do("key", "BackSpace")
        program.wait(lambda now: now["picture"] == black and now["stage"] == "NONE")

        # Ctrl+S makes a sketch of the shader.
        screen.do("mousemove", 560, 450, "key", "ctrl+s")
        program.wait(lambda now: any("saved halves_sketch.toml" in text for text in now["notices"]))
        now = program.wait(lambda now: now["stage"] == "NONE")
        assert now["picture"] == black and not now["error"]
        assert file.read_text("utf-8") == HALVES
        sources = [c.source for c in channels(load(tmp_path / "halves_sketch.toml"))]
        assert sources == ["foreign/black", "foreign/noise"]
        screen.do("key", "ctrl+q")
        assert program.ended() == 0, program.complaint()
    finally:
        program.close()


@pytest.mark.slow
@pytest.mark.room("dialects")
@pytest.mark.usefixtures("clipboard")
def test_the_clipboard_is_read_before_there_is_a_window(screen: Screen) -> None:
    read = "from playground.studio.window import clipboard_text\nprint(clipboard_text(), end='')"
    environment = {**os.environ, "DISPLAY": screen.display, "PYTHONPATH": str(ROOT)}
    result = subprocess.run(
        [sys.executable, "-c", read], env=environment, capture_output=True, text=True, timeout=60, check=True
    )
    assert result.stdout == PASTED


@pytest.mark.slow
@pytest.mark.room("dialects")
def test_a_text_from_standard_input_opens(screen: Screen, tmp_path: Path) -> None:
    (tmp_path / "given.txt").write_text(PASTED, "utf-8")
    command = f"exec '{sys.executable}' -m playground live - --size 800x500 < given.txt"
    program = Program(screen, tmp_path, ["sh", "-c", command], tmp_path)
    try:
        program.wait(lambda now: now["draws"] > 0)
        assert "standard input is kept as half_red.frag" in program.complaint()
        screen.do("mousemove", 700, 300, "key", "ctrl+q")
        assert program.ended() == 0, program.complaint()
    finally:
        program.close()


# ── other starts ─────────────────────────────────────────────────────────────

COSTLY = """// slow.glsl -- takes far longer than to read it from a disk
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) {
    float sum = 0.0;
    for (int i = 0; i < 4000; i++) sum += sin(float(texel.x * i) * 0.01 + sum);
    return 0.5 * fract(sum);
}
"""


@pytest.mark.slow
def test_a_window_reopens_terrain_from_the_disk(screen: Screen, tmp_path: Path) -> None:
    (tmp_path / "slow.glsl").write_text(COSTLY, encoding="utf-8")
    text = "format = 1\nsize = 513\n" + passes(height="./slow") + map_of("height", channel="red")
    (tmp_path / "sketch.toml").write_text(text, encoding="utf-8")
    land = tmp_path / "cache" / "terrain-shader-playground" / "land"
    seen, pixels = "", screen.pixels()
    for _ in range(2):
        command = [sys.executable, "-c", script((500, 400), cache_limit=2**28), str(tmp_path)]
        program = Program(screen, tmp_path, command, tmp_path)
        try:
            now = program.wait(lambda now: now["picture"])
            assert ("height" in now["runs"]) == (not seen)
            assert seen in ("", now["picture"])
            program.wait(lambda _: list(land.glob("*.land")))
            if seen:
                assert np.mean(screen.pixels() == pixels) > 0.95, "the panel's figures aside"
            seen, pixels = now["picture"], screen.pixels()
        finally:
            program.close()
        (tmp_path / "status.jsonl").unlink()


def test_a_sketch_in_a_folder_is_called_by_its_folder(tmp_path: Path) -> None:
    assert title_of(tmp_path / "hills" / "sketch.toml") == "hills – terrain shader playground"
    assert title_of(tmp_path / "hills" / "valley.toml") == "valley – terrain shader playground"
    assert title_of(tmp_path / "terrain.glsl") == "terrain – terrain shader playground"


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


def test_what_is_dropped_is_taken_once(monkeypatch: pytest.MonkeyPatch) -> None:
    listening = []
    monkeypatch.setattr("glfw.set_drop_callback", lambda handle, act: listening.append((handle, act)))
    handles = ["first"]
    window_placement = WindowPlacement(lambda: handles[0])
    assert window_placement.dropped() == []
    listening[0][1]("first", ["/a/b.png", "/c"])
    assert window_placement.dropped() == [Path("/a/b.png"), Path("/c")] and window_placement.dropped() == []
    handles[0] = "second"  # the window was opened again
    window_placement.dropped()
    assert [handle for handle, _ in listening] == ["first", "second"]


ONE, OTHER = (0, 0, 1920, 1080), (1920, -200, 1280, 1024)  # screens


@pytest.mark.parametrize(
    ("window", "areas", "expected"),
    [
        ((100, 200, 800, 600), [ONE], (100, 200)),
        ((1500, 100, 800, 600), [ONE, OTHER], (1500, 100)),  # on both, and all of it
        ((-50, 700, 800, 600), [ONE], (0, 480)),
        ((1900, 100, 800, 600), [ONE], (1120, 100)),
        ((2500, 300, 800, 600), [ONE], (1120, 300)),  # its screen is gone
        ((2500, 300, 800, 600), [ONE, OTHER], (2400, 224)),
        ((-3000, -3000, 800, 600), [OTHER], (1920, -200)),
        ((50, 50, 3000, 2000), [ONE], (0, 0)),  # larger than the screen: its title bar shows
        ((50, 50, 800, 600), [], (50, 50)),
    ],
)
def test_a_window_comes_back_where_a_screen_shows_it(window, areas, expected):
    assert on_screen(window, areas) == expected
