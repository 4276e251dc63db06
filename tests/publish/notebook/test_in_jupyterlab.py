"""Widgets in a real JupyterLab, in a real browser, with a kernel: what is drawn, dragged, set and said."""

from __future__ import annotations

import base64
import io
import json
import time

import numpy as np
import pytest
from PIL import Image

import playground
from playground.sketch.model import Camera

from .conftest import KERNEL, SKETCH
from .lab import MISSING, Lab

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(bool(MISSING), reason=MISSING),
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]

RIGHT = "\ue014"
SIZE = (128, 72)
CELLS = [
    "import playground\nb = playground.widget('./sketch.toml', size=(128, 72))\nb",
    "k = playground.widget('./sketch.toml', size=(128, 72), draws='kernel')\nk",
    "low, high = {'height.rise': 0.2}, {'height.rise': 0.8}\n"
    "c = playground.compare(low, high, sketch='./sketch.toml', size=(128, 72))\nc",
]
BROWSER, KERNEL_DRAWN, COMPARED = range(3)


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    """Give a notebook with a widget that the browser draws, one that the kernel draws, and two compared."""
    folder = tmp_path_factory.mktemp("lab")
    (folder / "slope.glsl").write_text(KERNEL, encoding="utf-8")
    (folder / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    with Lab(folder, CELLS) as made:
        shown = ".sketches .stage[aria-busy=false] canvas:not([hidden])"
        made.browser.wait("document.querySelectorAll(arguments[0]).length === 4", shown)
        made.sketch = playground.load(folder / "sketch.toml")
        made.slope = folder / "slope.glsl"
        yield made
        assert made.browser.log() == []


def widget(at):
    """Return the expression of a widget's element."""
    return f"document.querySelectorAll('.sketches')[{at}]"


def picture(lab, at, side=0):
    """Return a widget's picture at rest: of its whole size, and two readings agree.

    It is brought into sight first, for what nobody sees is drawn only once it is seen.
    """
    text, before = f"{widget(at)}.querySelectorAll('canvas')[{side}]", ""
    lab.browser.run(f"{widget(at)}.scrollIntoView()")
    script = f"const c = {text}; return c.width === {SIZE[0]} ? c.toDataURL() : String(Math.random())"
    for _ in range(60):
        time.sleep(0.4)
        now = lab.browser.run(script)
        if now == before:
            break
        before = now
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(now.partition(",")[2]))).convert("RGB"))


def expected(engine, sketch):
    return engine.render(sketch, size=SIZE).array[..., :3]


@pytest.mark.parametrize(("name", "at"), [("b", BROWSER), ("k", KERNEL_DRAWN)])
def test_slider_and_python_stay_in_sync_with_picture(lab, any_engine, name, at):
    """Whoever draws: to the pixel what the engine draws of these values."""
    who = {"b": "browser", "k": "kernel"}[name]
    assert lab.python(f"print({name}.drawn_by)") == who
    said = lab.browser.run(f"return {widget(at)}.querySelector('.drawn-by').textContent")
    assert said == {"b": "Drawn by this browser.", "k": "Drawn by the kernel: draws = 'kernel'."}[name]
    np.testing.assert_array_equal(picture(lab, at), expected(any_engine, lab.sketch))
    lab.python(f"told = []\n{name}.on_change(told.append)")
    lab.browser.run(f"{widget(at)}.querySelector('.rows input[type=range]').focus()")
    lab.browser.press(*[RIGHT] * 5)
    moved = picture(lab, at)
    value = float(lab.python(f"print({name}['height.rise'])"))
    assert value > 0.5 and str(value) in lab.python("print(told[-1])")
    np.testing.assert_array_equal(moved, expected(any_engine, lab.sketch.with_values({"height.rise": value})))
    lab.python(f"{name}['height.rise'] = 0.25")
    steep = lab.sketch.with_values({"height.rise": 0.25})
    np.testing.assert_array_equal(picture(lab, at), expected(any_engine, steep))


@pytest.mark.parametrize(("name", "at"), [("b", BROWSER), ("k", KERNEL_DRAWN)])
def test_drag_over_picture_turns_camera_seen_by_python(lab, any_engine, name, at):
    lab.python(f"{name}['height.rise'] = 0.5\n{name}.camera = None")
    lab.browser.run(f"const c = {widget(at)}.querySelector('canvas'); c.id = 'c{at}'; c.scrollIntoView()")
    lab.browser.drag(f"#c{at}", (0, 0), (18, 9))
    turned = picture(lab, at)
    lab.python("import dataclasses, json")
    camera = Camera(**json.loads(lab.python(f"print(json.dumps(dataclasses.asdict({name}.camera)))")))
    assert camera.azimuth != 200 and camera.elevation != 32
    np.testing.assert_array_equal(turned, expected(any_engine, lab.sketch.with_camera(camera)))


def test_a_mistake_is_a_sentence_and_the_last_good_picture_stays(lab, any_engine):
    good = lab.slope.read_text(encoding="utf-8")
    before, said = picture(lab, BROWSER), f"{widget(BROWSER)}.querySelector('.mistake').textContent"
    try:
        lab.slope.write_text(good.replace("return rise", "return rose"), encoding="utf-8")
        lab.python("b.sketch = './sketch.toml'")
        lab.browser.wait(f"{said}.includes('slope.glsl:5') && {said}.includes('rose')")
        np.testing.assert_array_equal(picture(lab, BROWSER), before)
    finally:
        lab.slope.write_text(good, encoding="utf-8")
    lab.python("b.sketch = playground.load('./sketch.toml').with_values({'height.rise': 1.0})")
    lab.browser.wait(f"{said} === ''")
    steep = lab.sketch.with_values({"height.rise": 1.0})
    np.testing.assert_array_equal(picture(lab, BROWSER), expected(any_engine, steep))


def test_compared_widgets_have_own_values_and_shared_camera(lab, any_engine):
    lab.python("c.camera = playground.Camera(azimuth=90.0, elevation=45.0, distance=500.0)")
    for side, rise in enumerate((0.2, 0.8)):
        sketch = lab.sketch.with_values({"height.rise": rise}).with_camera(Camera(90.0, 45.0, 500.0))
        np.testing.assert_array_equal(picture(lab, COMPARED, side), expected(any_engine, sketch))
    heads = lab.browser.run("return [...document.querySelectorAll('.owns b')].map((b) => b.textContent)")
    assert heads == ["height.rise = 0.2", "height.rise = 0.8"]


def test_a_theme_that_is_dark_makes_the_widget_dark(lab):
    dark = "document.querySelectorAll('.sketches.dark').length"
    assert lab.browser.run(f"return {dark}") == 0
    lab.command("apputils:change-theme", theme="JupyterLab Dark")
    lab.browser.wait(f"{dark} === 3")


def test_closing_takes_the_widget_away(lab):
    lab.python("k.close()")
    lab.browser.wait("document.querySelectorAll('.sketches').length === 2")
