"""A sketch edited in a page, saved there and opened by Python gives the page's picture, bit for bit."""

from __future__ import annotations

import base64
import json
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

import moderngl
import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.publish.web.page_data import page_data
from playground.sketch.find import unpacked
from playground.sketch.model import Camera

from ...loading import load
from ...verify.report.browser import MESA, Browser
from .node import NODE
from .pages import HOME, MISSING

pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(MISSING), reason=MISSING)]

SIZE = (160, 90)
CAMERA = Camera(150.0, 35.0, 15000.0, (5000.0, 5200.0, 100.0), 40.0)
VALUES = [
    ["height.smoothing", 0.8125],
    ["height.seed", 5],
    ["view.haze", 0.25],
    ["light.sky_colour", [0.25, 0.5, 0.1]],
]


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    folder = tmp_path_factory.mktemp("page")
    script = folder / "script.js"
    command = [str(NODE), "build.mjs", str(Path(__file__).with_name("my_version_entry.js")), str(script)]
    subprocess.run(command, cwd=HOME, check=True, capture_output=True)
    data = json.dumps(page_data([load("diamond_square")], frame=SIZE, packed=True)).replace("<", "\\u003c")
    css = (HOME / "runtime" / "editor.css").read_text(encoding="utf-8")
    text = f"<!doctype html><meta charset=utf-8><style>{css}</style><body>"
    text += f"<script>{script.read_text('utf-8')}</script>"
    text += f"<script>const PAGE = {data}; playground.open(PAGE).then((found) => {{ window.page = found; }},"
    text += " (error) => { window.page = { error: String(error.stack) }; });</script>"
    (folder / "page.html").write_text(text, encoding="utf-8")
    with Browser(folder / "profile", 1100, 900, MESA) as browser:
        browser.open((folder / "page.html").as_uri())
        browser.wait("window.page")
        assert browser.run("return page.error") is None
        yield browser


def settle(page: Browser, script: str, *values: object) -> object:
    """Return what a promise gives."""
    page.run(
        f"window.found = undefined; Promise.resolve({script}).then((found) => {{ window.found = [found]; }})",
        *values,
    )
    return page.wait("window.found")[0]


def picture(page: Browser) -> np.ndarray:
    texels = base64.b64decode(page.run("return page.picture()"))
    return np.frombuffer(texels, np.uint8).reshape(SIZE[1], SIZE[0], 4)[::-1]


def put(page: Browser, file: str, old: str, new: str) -> None:
    page.run("page.editor.open(arguments[0])", file)
    text = page.run("return document.querySelector('.code-text').value")
    assert old in text
    page.run("page.editor.put(arguments[0])", text.replace(old, new))
    settle(page, "page.editor.done()")


def saved(page: Browser, folder: Path, values: list[object], camera: Camera | None) -> Path:
    value = None if camera is None else asdict(camera)
    path = folder / "my-version.zip"
    path.write_bytes(base64.b64decode(str(settle(page, "page.version(...arguments)", values, value))))
    return path


def rendered(ctx: moderngl.Context, path: Path, folder: Path) -> np.ndarray:
    with Engine(ctx, driver="fragment") as engine:
        return np.asarray(engine.render(load(unpacked(path, folder / "cache")), size=SIZE).array)


def test_what_was_edited_and_set_is_the_same_picture_in_python(
    page: Browser, tmp_path: Path, ctx: moderngl.Context
):
    before = picture(page)
    put(page, "noise/hash.glsl", "bits >> 8u", "bits >> 9u")
    put(page, "generation/diamond_square/raw.glsl", "return total", "return 0.9 * total")
    assert page.run("return page.editor.problems") == []
    page.run("page.set(...arguments)", VALUES, asdict(CAMERA))
    result = picture(page)
    assert (result != before).any()
    path = saved(page, tmp_path, VALUES, CAMERA)
    assert (rendered(ctx, path, tmp_path) == result).all()


def test_broken_text_keeps_picture_and_is_reported_at_its_line(page: Browser):
    before = picture(page)
    put(page, "noise/hash.glsl", "1.0 / 16777216.0", "1.0 / nothing_such")
    (result,) = page.run("return page.editor.problems")
    assert result["file"] == "noise/hash.glsl" and "`nothing_such` is not declared" in result["message"]
    line = page.run(
        "return document.querySelector('.code-text').value.split('\\n')[arguments[0]]", result["line"] - 1
    )
    assert "nothing_such" in line
    assert (picture(page) == before).all()
    put(page, "noise/hash.glsl", "1.0 / nothing_such", "1.0 / 16777216.0")
    assert page.run("return page.editor.problems") == []


def test_a_uniform_that_is_added_has_its_initial_value(page: Browser):
    file = "generation/diamond_square/raw.glsl"
    before = picture(page)
    put(page, file, "float kernel(", "uniform float added = 0.5;\nfloat kernel(")
    put(page, file, "total / count", "total * added / count")
    half = picture(page)
    assert (half != before).any()
    put(page, file, "total * added / count", "total * 0.5 / count")
    assert (picture(page) == half).all()
    assert "‘added’" in page.run("return document.querySelector('.editor-notices').textContent")


def test_a_slow_picture_is_asked_about(page: Browser):
    chosen = "page.recovery.pace(page.player, page.done).then((one) => { window.chosen = [one]; })"
    page.run(f"window.chosen = undefined; {chosen}")
    said = page.wait("document.querySelector('.recovery')?.textContent")
    assert said.startswith("At 160 × 90 this takes about")
    page.click(".recovery button")
    width, height = page.wait("window.chosen")[0]
    assert 1 <= width < 160 and 1 <= height < 90
    assert page.run("return page.player.state.frame ?? page.player.sketch.frame") == [160, 90]


CODE = "[...document.querySelectorAll('[role=tab]')].find((tab) => tab.textContent === 'Code').click()"
DRAWN = "document.querySelector('.stage canvas')?.hidden === false"


def replaced(page: Browser, old: str, new: str) -> None:
    """Select a part of the text and type over it."""
    page.run(
        "const area = document.querySelector('.code-text'), at = area.value.indexOf(arguments[0]);"
        "area.focus(); area.setSelectionRange(at, at + arguments[0].length);",
        old,
    )
    page.press(*new)


def test_exported_page_survives_break_repair_save_and_reload(tmp_path: Path):
    path = tmp_path / "page.html"
    command = [sys.executable, "-m", "playground", "export", "diamond_square", "--to", str(path)]
    subprocess.run([*command, "--set", "size=65"], check=True, capture_output=True)
    with Browser(tmp_path / "profile", 1280, 900, MESA) as page:
        page.open(path.as_uri())
        page.wait(DRAWN)
        page.run(CODE)
        page.wait("document.querySelector('.code-text')")
        menu = "const menu = document.querySelector('.editor select');"
        page.run(f"{menu} menu.value = arguments[0]; menu.onchange()", "generation/diamond_square/raw.glsl")
        replaced(page, "return total", "return totl")
        said = page.wait("document.querySelector('.editor-problems li')?.textContent")
        assert said.startswith("generation/diamond_square/raw.glsl:66: ") and "did you mean `total`?" in said
        replaced(page, "totl", "0.5 * total")
        page.wait("/^Compiled/.test(document.querySelector('.editor-status').textContent)")
        page.click(".editor-download")
        page.wait("/my-version.zip is saved/.test(document.querySelector('.editor-status').textContent)")
        page.open(path.as_uri())
        page.wait(DRAWN)
        page.run(CODE)
        options = "[...document.querySelectorAll('.editor option')].map((one) => one.text)"
        listed = page.wait(f"document.querySelector('.code-text') && {options}")
        edited = [name for name in listed if name.endswith("(edited)")]
        assert edited == ["generation/diamond_square/raw.glsl (edited)"]
        assert page.log() == []
