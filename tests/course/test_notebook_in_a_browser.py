"""A notebook's widget in a real browser, with a model that has its saved state and no kernel."""

from __future__ import annotations

import base64
import json
from functools import partial
from http.server import ThreadingHTTPServer
from threading import Thread

import numpy as np
import pytest

from playground.course.notebook import lesson as notebook_lesson
from playground.course.notebook.lesson import NotebookLesson
from playground.course.scenes import draw, with_value

from ..verify.report.browser import MISSING, Browser
from .test_live_book_in_a_browser import LLVMPIPE, RIGHT, Recorder, drawn, picture

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
    opened, running = NotebookLesson(lesson), []

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
        server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Recorder, directory=str(folder)))
        Thread(target=server.serve_forever, daemon=True).start()
        browser = Browser(tmp_path / f"profile-{name}", flags=flags).__enter__()
        running.append((server, browser))
        browser.open(f"http://127.0.0.1:{server.server_address[1]}/index.html")
        browser.wait("globalThis.rendered")
        return browser

    yield show
    for server, browser in running:
        browser.__exit__(None, None, None)
        server.shutdown()
        server.server_close()


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
