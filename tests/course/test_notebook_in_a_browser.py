"""A notebook's widgets in a real browser, saved and without a kernel, and a notebook exported as HTML."""

from __future__ import annotations

import base64
import copy
import json
from contextlib import ExitStack

import nbformat
import numpy as np
import pytest
from nbclient import NotebookClient
from nbconvert.exporters import HTMLExporter

from playground.course.notebook import lesson as notebook_lesson
from playground.course.notebook.lesson import NotebookLesson
from playground.course.read import read_lesson
from playground.course.scenes import draw, with_value
from playground.publish.notebook.export import TerrainHTMLExporter

from ..browser import MISSING
from .test_live_book_in_a_browser import LLVMPIPE, RIGHT, Recorder, drawn, picture, served
from .test_notebook import STATES

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(bool(MISSING), reason=MISSING),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]

HOST = """<!doctype html><meta charset="utf-8"><link rel="stylesheet" href="widget.css"><main></main>
<script type="module">
import widget from "./widget.js";
const { state, bytes } = await (await fetch("state.json")).json();
state.picture = Uint8Array.from(atob(bytes), (letter) => letter.charCodeAt(0));
const heard = {};
globalThis.model = {
  get: (name) => state[name],
  set: (name, value) => { state[name] = value; for (const act of heard[`change:${name}`] ?? []) act(); },
  save_changes() {},
  on: (name, act) => { (heard[name] ??= new Set()).add(act); },
  off: (name, act) => heard[name]?.delete(act),
};
const el = document.querySelector("main");
el.id = state.name;
globalThis.close = await widget.render({ model, el });
globalThis.rendered = true;
</script>"""


@pytest.fixture
def shown(lesson, engine, monkeypatch, tmp_path):
    """Return a function that shows a block's widget, as it was saved, in a browser."""
    monkeypatch.setattr(notebook_lesson, "on_engine", lambda work: work(engine))
    opened = NotebookLesson(lesson)

    def show(name, flags=LLVMPIPE):
        widget = opened.show(name)
        state = {
            k: v for k, v in widget.get_state().items() if k in widget.keys and k not in ("picture", "layout")
        }
        keep = {
            k: state[k] for k in "page language labels kind drawn_by why alt controls values mistake".split()
        }
        folder = tmp_path / name
        folder.mkdir()
        (folder / "index.html").write_text(HOST, encoding="utf-8")
        (folder / "widget.js").write_text(widget._esm, encoding="utf-8")
        (folder / "widget.css").write_text(widget._css, encoding="utf-8")
        saved = {"state": {**keep, "name": name}, "bytes": base64.b64encode(widget.picture).decode()}
        (folder / "state.json").write_text(json.dumps(saved), encoding="utf-8")
        browser = running.enter_context(served(folder, "index.html", tmp_path / f"profile-{name}", flags))
        browser.wait("globalThis.rendered")
        return browser

    with ExitStack() as running:
        yield show


def test_a_saved_figure_is_live_without_a_kernel(shown, lesson, engine):
    scene, browser = lesson.named["land"].scene, shown("land")
    first = picture(browser, "land")
    np.testing.assert_array_equal(first, drawn(engine, scene, first))
    assert browser.run("return model.get('drawn_by')") == "browser"
    browser.run("document.querySelector('#land .live input[type=range]').focus()")
    browser.press(*[RIGHT] * 5)
    value = browser.run("return model.get('values')['height.smoothing']")
    moved = picture(browser, "land")
    np.testing.assert_array_equal(moved, drawn(engine, with_value(scene, "height.smoothing", value), moved))
    browser.run("model.set('values', { 'height.smoothing': 0.25 })")  # as Python sets it
    moved = picture(browser, "land")
    np.testing.assert_array_equal(moved, drawn(engine, with_value(scene, "height.smoothing", 0.25), moved))
    assert browser.log() == [] or all("favicon" in line for line in browser.log())


def test_a_saved_series_is_live_without_a_kernel(shown, lesson, engine):
    browser, scenes = shown("turns"), lesson.named["turns"].scenes
    browser.run("model.set('values', { frame: 3 })")
    now = picture(browser, "turns")
    np.testing.assert_array_equal(now, drawn(engine, scenes[3], now))
    browser.run("document.querySelector('#turns .live input[type=range]').focus()")
    browser.press(RIGHT)
    assert browser.run("return model.get('values').frame") == 4


def test_without_webgl_the_saved_picture_is_shown(shown, lesson, engine):
    browser = shown("land", ("--disable-gpu", "--disable-3d-apis"))
    size = browser.wait(
        "(document.querySelector('img')?.naturalWidth ? [document.querySelector('img').naturalWidth] : null)"
    )
    assert size == [draw(engine, lesson.named["land"].scene).array.shape[1]]
    assert browser.run("return model.get('drawn_by')") == "kernel"
    assert browser.run("return document.querySelectorAll('canvas').length") == 0


# ── exported ──────────────────────────────────────────────────────────────────


OFFLINE = (*LLVMPIPE, "--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE 127.0.0.1")
CELLS = (
    'from playground.course.notebook import open_lesson\nlesson = open_lesson("diamond_square")',
    'lesson.show("land")',
    'lesson.show("smoothing")',
)
DRAGGED = 0.3


@pytest.fixture(scope="module")
def run():
    """Give a notebook as it is saved when its cells have run and a slider was dragged."""
    nb = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in CELLS])
    NotebookClient(nb, timeout=600, kernel_name="python3").execute()
    states = [model["state"] for model in nb.metadata["widgets"][STATES]["state"].values()]
    (land,) = [state for state in states if "height.smoothing" in state.get("values", {})]
    land["values"] = {**land["values"], "height.smoothing": DRAGGED}
    return nb


@pytest.fixture
def shown_html(tmp_path):
    """Return a function that opens HTML from a server, in a browser that has no network."""
    with ExitStack() as running:

        def show(html, flags=OFFLINE):
            (tmp_path / "index.html").write_text(html, encoding="utf-8")
            browser = running.enter_context(served(tmp_path, "index.html", tmp_path / "profile", flags))
            # Each by a name, as the pictures of a book have one.
            browser.run(
                "document.querySelectorAll('[data-terrain-saved]')"
                ".forEach((root, at) => { root.id = `f${at}`; })"
            )
            return browser

        yield show


def live(browser, name):
    browser.run(f"document.getElementById('{name}').scrollIntoView({{ block: 'center' }})")
    browser.wait(f"document.querySelector('#{name} .live canvas:not([hidden])')")


def asked_for(browser):
    """Return all addresses that a page asked for, but for the icon that any page of a server has."""
    result = browser.run("return performance.getEntriesByType('resource').map((entry) => entry.name)")
    return [url for url in result if not url.endswith("/favicon.ico")]


def test_an_exported_notebook_is_live_and_asks_for_nothing(run, shown_html, engine):
    scene = read_lesson("diamond_square").named["land"].scene
    html, _ = TerrainHTMLExporter().from_notebook_node(run)
    browser = shown_html(html)
    live(browser, "f0")
    first = picture(browser, "f0")
    expected = drawn(engine, with_value(scene, "height.smoothing", DRAGGED), first)
    np.testing.assert_array_equal(first, expected)
    browser.run("document.querySelector('#f0 .live input[type=range]').focus()")
    browser.press(*[RIGHT] * 5)
    assert (picture(browser, "f0") != first).any()
    live(browser, "f1")
    assert picture(browser, "f1").std() > 2.0
    assert browser.run("return Object.keys(terrainRuntimes).length") == 1
    assert asked_for(browser) == []
    assert [path for path in Recorder.asked if path != "/favicon.ico"] == ["/index.html"]
    assert [line for line in browser.log() if "favicon" not in line] == []


def test_any_exporter_html_is_live_without_saved_widget_state(run, shown_html, engine):
    """As JupyterLab saves notebooks: a figure has the values of its cell."""
    scene = read_lesson("diamond_square").named["land"].scene
    nb = copy.deepcopy(run)
    del nb.metadata["widgets"]
    html, _ = HTMLExporter().from_notebook_node(nb)
    browser = shown_html(html)
    live(browser, "f0")
    first = picture(browser, "f0")
    np.testing.assert_array_equal(first, drawn(engine, scene, first))
    assert all("cdnjs.cloudflare.com" in url for url in asked_for(browser))  # nbconvert's own


def test_exported_figure_without_webgl_shows_picture_and_reason(run, shown_html):
    html, _ = TerrainHTMLExporter().from_notebook_node(run)
    browser = shown_html(html, ("--disable-gpu", "--disable-3d-apis"))
    text = browser.wait("document.querySelector('#f0 .mistake')?.textContent")
    assert text.startswith("This browser offers no WebGL2, so the picture stands still.")
    width = "document.querySelector('#f0 img').naturalWidth"
    assert browser.run(f"return [{width}, document.querySelectorAll('#f0 canvas, #f0 input').length]") == [
        read_lesson("diamond_square").named["land"].scene.pixels[0],
        0,
    ]


def test_a_damaged_figure_in_a_page_says_so_in_a_sentence(run, shown_html):
    html, _ = TerrainHTMLExporter().from_notebook_node(run)
    at = html.index("data-terrain-state")
    start = html.index(">", at) + 1
    browser = shown_html(f"{html[:start]}!!!!{html[start + 4 :]}")
    live(browser, "f1")
    text = browser.wait("document.querySelector('#f0 p')?.textContent")
    assert text.startswith("This figure stands still, because it cannot be started here: ")
    assert browser.run("return document.querySelector('#f0 img').naturalWidth") > 0
