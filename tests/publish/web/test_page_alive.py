"""Exported pages in Chromium, on the engine's renderer: a user sees what the engine draws, bit for bit."""

from __future__ import annotations

import base64
import io
import os
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import PIL.Image
import pytest
from numpy.typing import NDArray

from playground.engine.engine import Engine
from playground.publish.web_page import page_bytes, prepare_page
from playground.sketch.model import DEFAULT_PICTURE, Camera, Sketch
from playground.studio.picture.view import field_for

from ...browser import MESA, Browser
from ...loading import load
from .pages import VIEW

pytestmark = pytest.mark.slow

EYE = (210.0, 30.0, 9000.0, 2000.0, 1800.0, 100.0, 35.0)
SETTLED = 0.4  # [s] of address.js
LINK = "camera=" + ",".join(f"{number:g}" for number in EYE)
INFO = "document.querySelector('.info').textContent"


@pytest.fixture(scope="module")
def browser(drawn: Engine, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    with Browser(tmp_path_factory.mktemp("alive"), 900, 560, MESA) as made:
        yield made


@pytest.fixture(scope="module")
def exported(drawn: Engine, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Give a function that exports a sketch, and returns the address of its page."""
    folder, made = tmp_path_factory.mktemp("exported"), {}

    def export(name: str) -> tuple[Sketch, str]:
        if name not in made:
            sketch, path = load(name), folder / f"{name}.html"
            html, _ = page_bytes(drawn, sketch, prepare_page(drawn, sketch, path, {}))
            path.write_bytes(html)
            made[name] = sketch, path.as_uri()
        return made[name]

    return export


def opened(browser: Browser, url: str) -> None:
    browser.open("about:blank")
    browser.open(url)
    browser.wait("document.querySelector('canvas') && !document.querySelector('canvas').hidden")
    at_rest(browser)


def at_rest(browser: Browser) -> None:
    """Wait until no other picture is to come."""
    browser.wait("document.querySelector('.stage').getAttribute('aria-busy') === 'false'")
    assert browser.run("return document.querySelector('.notes .alarm')?.textContent ?? ''") == ""


def picture(browser: Browser) -> NDArray[np.uint8]:
    text = browser.run("return document.querySelector('canvas').toDataURL('image/png')")
    data = base64.b64decode(text.partition(",")[2])
    return np.asarray(PIL.Image.open(io.BytesIO(data)).convert("RGB"))


def expected(
    drawn: Engine, sketch: Sketch, values: dict[str, object], like: NDArray[np.uint8]
) -> NDArray[np.uint8]:
    size = like.shape[1], like.shape[0]
    azimuth, elevation, distance, x, y, z, field = EYE
    camera = Camera(azimuth, elevation, distance, (x, y, z), field_for(field, DEFAULT_PICTURE, size))
    frame = drawn.render(replace(sketch.with_values(values), keyframes=()).with_camera(camera), size=size)
    return np.asarray(frame.array[..., :3])


def test_a_link_a_slider_and_undo_show_what_the_engine_draws(browser: Browser, drawn: Engine, exported: Any):
    sketch, url = exported("diamond_square")
    opened(browser, f"{url}#{LINK}&height.seed=5")
    first = picture(browser)
    assert np.array_equal(first, expected(drawn, sketch, {"height.seed": 5}, first))
    assert len(np.unique(first.reshape(-1, 3), axis=0)) > 1000, "there is something in it"
    path, value = browser.run(
        """const slider = document.querySelector('.row.is-slider [type=range]'), row = slider.closest('.row');
        slider.value = 0.3; slider.oninput();
        return [row.dataset.path, row.querySelector('.number').value]"""
    )
    at_rest(browser)
    moved = picture(browser)
    target = {"height.seed": 5, path: float(value)}
    assert np.array_equal(moved, expected(drawn, sketch, target, moved)) and not np.array_equal(moved, first)
    browser.click(".head-line button")
    at_rest(browser)
    assert np.array_equal(picture(browser), first)
    assert browser.log() == []


def test_iterations_are_stopped_early(browser: Browser, drawn: Engine, exported: Any):
    sketch, url = exported("diamond_square")
    opened(browser, f"{url}#{LINK}")
    browser.run("for (const one of document.querySelectorAll('.panel details.section')) one.open = true")
    browser.wait("document.querySelector('.is-steps [type=range]')")
    path = browser.run(
        """const row = document.querySelector('.is-steps'), slider = row.querySelector('[type=range]');
        slider.value = 3; slider.oninput(); return row.dataset.path"""
    )
    at_rest(browser)
    shown = picture(browser)
    size = shown.shape[1], shown.shape[0]
    azimuth, elevation, distance, x, y, z, field = EYE
    camera = Camera(azimuth, elevation, distance, (x, y, z), field_for(field, DEFAULT_PICTURE, size))
    frame = drawn.render(sketch.with_camera(camera), size=size, steps={path: 3}, interpolated=True)
    assert np.array_equal(shown, frame.array[..., :3])


def test_a_map_reads_what_the_engine_has_in_its_texture(browser: Browser, drawn: Engine, exported: Any):
    sketch, url = exported("diamond_square")
    opened(browser, f"{url}#{LINK}")
    browser.run("const menu = document.querySelector('.textures'); menu.value = '0'; menu.onchange()")
    at_rest(browser)
    browser.drag("canvas", (-40, 25), (-39, 25))
    browser.wait("/^Texel \\d/.test(document.querySelector('.readout').textContent)")
    lines = browser.run("return document.querySelector('.readout').textContent").split("\n")
    x, y = map(int, lines[0].removeprefix("Texel ").split(", "))
    texture = browser.run("return document.querySelector('.textures').selectedOptions[0].textContent")
    number = float(drawn.read(sketch, texture)[y, x])
    assert lines[-1] == f"{number:.6g}"
    assert lines[2].startswith(f"{number * sketch.terrain.relief:.2f} m high")
    if folder := os.environ.get("PAGE_PICTURES"):
        Path(folder, "alive map.png").write_bytes(browser.picture())


def test_orbiting_draws_and_the_picture_is_whole_again_at_rest(
    browser: Browser, drawn: Engine, exported: Any
):
    _, url = exported("hex_tiled")
    opened(browser, url)
    before = picture(browser)
    browser.drag("canvas", (-60, 0), (60, 20))
    at_rest(browser)
    after = picture(browser)
    assert after.shape == before.shape and not np.array_equal(after, before)
    asked = browser.run("return performance.getEntriesByType('resource').map((one) => one.name)")
    assert [name for name in asked if not name.startswith(("data:", "blob:"))] == []
    assert browser.log() == []


def test_drag_writes_camera_to_address_if_picture_uses_it(browser: Browser, exported: Any):
    for name, sees in (("hex_tiled", True), ("white_noise_image", False)):
        _, url = exported(name)
        opened(browser, url)
        browser.drag("canvas", (-60, 0), (60, 20))
        at_rest(browser)
        time.sleep(2 * SETTLED)
        assert browser.run("return location.hash.includes('camera=')") is sees
    assert browser.log() == []


def test_a_french_page_has_a_french_editor(browser: Browser, exported: Any):
    """What a compiler complains of stays English, as it is in the terminal."""
    _, url = exported("lighting_hill")
    path = Path(url.removeprefix("file://"))
    french = path.with_name("colline.html")
    french.write_text(path.read_text("utf-8").replace(' lang="en"', ' lang="fr"', 1), "utf-8")
    opened(browser, french.as_uri())
    browser.run(
        "[...document.querySelectorAll('[role=tab]')].find((tab) => /Code/.test(tab.textContent)).click()"
    )
    browser.wait("document.querySelector('.editor')")
    shown = browser.run("return document.querySelector('.editor').innerText")
    assert "Fichier" in shown and "Rétablir ce fichier" in shown and "Échap puis Tab" in shown
    assert "Comme dans l’esquisse" in shown
    browser.run(
        f"const view = {VIEW.format('.editor')};"
        "view.dispatch({changes: {from: view.state.doc.length, insert: ' int a = ;'}})"
    )
    status = "document.querySelector('.editor-status').textContent"
    browser.wait(f"/^1 erreur|^. erreurs/.test({status})")
    assert browser.run(f"return {status}").endswith("l’image est la dernière qui marchait")
