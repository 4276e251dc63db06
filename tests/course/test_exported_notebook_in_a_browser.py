"""A notebook that was run, as HTML in a real browser: live figures, and nothing asked for."""

from __future__ import annotations

import copy
from functools import partial
from http.server import ThreadingHTTPServer
from threading import Thread

import nbformat
import numpy as np
import pytest
from nbclient import NotebookClient
from nbconvert.exporters import HTMLExporter

from playground.course.read import read_lesson
from playground.course.scenes import with_value
from playground.publish.notebook.export import TerrainHTMLExporter

from ..verify.report.browser import MISSING, Browser
from .test_live_book_in_a_browser import LLVMPIPE, RIGHT, Recorder, drawn, picture
from .test_notebook_export import STATES

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(bool(MISSING), reason=MISSING),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]

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
def shown(tmp_path):
    """Return a function that opens HTML from a server, in a browser that has no network."""
    running = []

    def show(html, flags=OFFLINE):
        (tmp_path / "index.html").write_text(html, encoding="utf-8")
        Recorder.asked.clear()
        server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Recorder, directory=str(tmp_path)))
        Thread(target=server.serve_forever, daemon=True).start()
        browser = Browser(tmp_path / "profile", flags=flags).__enter__()
        running.append((server, browser))
        browser.open(f"http://127.0.0.1:{server.server_address[1]}/index.html")
        # Each by a name, as the pictures of a book have one.
        browser.run(
            "document.querySelectorAll('[data-terrain-saved]').forEach((root, at) => { root.id = `f${at}`; })"
        )
        return browser

    yield show
    for server, browser in running:
        browser.__exit__(None, None, None)
        server.shutdown()
        server.server_close()


def live(browser, name):
    browser.run(f"document.getElementById('{name}').scrollIntoView({{ block: 'center' }})")
    browser.wait(f"document.querySelector('#{name} .live canvas:not([hidden])')")


def asked_for(browser):
    """Return all addresses that a page asked for, but for the icon that any page of a server has."""
    result = browser.run("return performance.getEntriesByType('resource').map((entry) => entry.name)")
    return [url for url in result if not url.endswith("/favicon.ico")]


def test_an_exported_notebook_is_live_and_asks_for_nothing(run, shown, engine):
    scene = read_lesson("diamond_square").named["land"].scene
    html, _ = TerrainHTMLExporter().from_notebook_node(run)
    browser = shown(html)
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


def test_any_exporter_html_is_live_without_saved_widget_state(run, shown, engine):
    """As JupyterLab saves notebooks: a figure has the values of its cell."""
    scene = read_lesson("diamond_square").named["land"].scene
    nb = copy.deepcopy(run)
    del nb.metadata["widgets"]
    html, _ = HTMLExporter().from_notebook_node(nb)
    browser = shown(html)
    live(browser, "f0")
    first = picture(browser, "f0")
    np.testing.assert_array_equal(first, drawn(engine, scene, first))
    assert all("cdnjs.cloudflare.com" in url for url in asked_for(browser))  # nbconvert's own


def test_exported_figure_without_webgl_shows_picture_and_reason(run, shown):
    html, _ = TerrainHTMLExporter().from_notebook_node(run)
    browser = shown(html, ("--disable-gpu", "--disable-3d-apis"))
    text = browser.wait("document.querySelector('#f0 .mistake')?.textContent")
    assert text.startswith("This browser offers no WebGL2, so the picture stands still.")
    width = "document.querySelector('#f0 img').naturalWidth"
    assert browser.run(f"return [{width}, document.querySelectorAll('#f0 canvas, #f0 input').length]") == [
        read_lesson("diamond_square").named["land"].scene.pixels[0],
        0,
    ]


def test_a_damaged_figure_in_a_page_says_so_in_a_sentence(run, shown):
    html, _ = TerrainHTMLExporter().from_notebook_node(run)
    at = html.index("data-terrain-state")
    start = html.index(">", at) + 1
    browser = shown(f"{html[:start]}!!!!{html[start + 4 :]}")
    live(browser, "f1")
    text = browser.wait("document.querySelector('#f0 p')?.textContent")
    assert text.startswith("This figure stands still, because it cannot be started here: ")
    assert browser.run("return document.querySelector('#f0 img').naturalWidth") > 0
