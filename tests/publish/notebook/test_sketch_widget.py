"""The widget of a sketch, on the side of the kernel."""

from __future__ import annotations

import base64
import gzip
import io
import json
import re
import sys
import threading

import numpy as np
import pytest
from PIL import Image

import playground
from playground.errors import DataError, ParameterError
from playground.extras import install_command
from playground.publish.notebook import engine_thread
from playground.publish.notebook import widget as widgets
from playground.sketch.model import Camera

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

SIZE = (64, 36)
TOY = """void mainImage(out vec4 colour, in vec2 place) {
    colour = textureGather(iChannel0, place / iResolution.xy);
}
"""
VIEW = {"azimuth": 10.0, "elevation": 40.0, "distance": 500.0, "target": None, "field_of_view": 35.0}


def pixels(picture):
    return np.asarray(Image.open(io.BytesIO(picture)).convert("RGBA"))


def unpacked(text):
    return json.loads(gzip.decompress(base64.b64decode(text)))


@pytest.fixture
def widget(engine, slope):
    return playground.widget(slope, size=SIZE)


@pytest.fixture
def answers(monkeypatch):
    """Return a function that asks a widget for a picture, as a browser does, and gives the answer."""

    def ask(widget, **asked):
        sent = []
        monkeypatch.setattr(widget, "send", lambda content, buffers=None: sent.append((content, buffers)))
        usual = {"id": "a-1", "side": 0, "values": {}, "camera": VIEW, "time": 0.0, "moving": False}
        widget.receive(widget, {"draw": {**usual, "size": list(SIZE), **asked}}, [])
        return sent

    return ask


def test_its_values_are_the_sketch_s_until_they_are_set(widget):
    assert widget["height.rise"] == 0.5 and widget.values["height.far"] == (0.25, 0.75)
    widget["height.rise"] = 0.75
    widget.values = {"height.far": (0, 1)}
    assert widget["height.rise"] == 0.75 and widget["height.far"] == (0.0, 1.0)
    assert dict(widget.sketch.overrides) == {"height.rise": 0.75, "height.far": (0.0, 1.0)}
    with pytest.raises(TypeError, match="does not support item assignment"):
        widget.values["height.rise"] = 0.1


@pytest.mark.parametrize(
    ("path", "value", "sentence"),
    [
        ("height.ris", 1, "no parameter 'height.ris'.*did you mean 'height.rise'"),
        ("height.rise", "high", "height.rise = 'high': expected"),
        ("relief", 3, "the terrain's own, no slider: widget.sketch ="),
    ],
)
def test_a_value_that_cannot_be_is_refused_and_nothing_changes(widget, path, value, sentence):
    before = dict(widget.values)
    with pytest.raises(ParameterError, match=sentence):
        widget[path] = value
    assert dict(widget.values) == before
    with pytest.raises(ParameterError, match=r"did you mean 'height.rise'"):
        _ = widget["height.ris"]


def test_who_listens_is_told_what_has_changed_whoever_changed_it(widget):
    message = []
    end = widget.on_change(message.append)
    widget["height.rise"] = 0.25
    widget.set_state({"values": {"height.rise": 0.25, "height.far": [0.5, 0.5]}})  # as a browser does
    widget["height.rise"] = 0.25
    end()
    widget["height.rise"] = 1.0
    assert message == [{"height.rise": 0.25}, {"height.far": (0.5, 0.5)}]


def test_the_camera_of_the_browser_is_the_sketch_s(widget):
    widget.set_state({"camera": {**VIEW, "target": [1.0, 2.0, 3.0]}, "time": 2.5})
    assert widget.camera == Camera(10.0, 40.0, 500.0, (1.0, 2.0, 3.0), 35.0) == widget.sketch.camera
    assert widget.time == 2.5
    widget.camera = None
    assert widget.sketch.camera == Camera()


INF, NAN = float("inf"), float("nan")


@pytest.mark.parametrize(
    ("state", "sentence"),
    [
        ({"values": {"height.rise": INF}}, "height.rise = inf: expected a finite number"),
        ({"values": {"height.rise": 10**400}}, "height.rise = 1000.*: expected"),
        ({"values": {1: 2}}, "values: expected values by path"),
        ({"camera": {**VIEW, "distance": INF}}, "camera: distance = inf: expected 0 to"),
        ({"camera": {"azimuth": NAN}}, "camera: azimuth = nan: expected -720 to 720"),
        ({"camera": {**VIEW, "field_of_view": 0}}, "camera: field_of_view = 0: expected 5 to 120"),
        ({"camera": {**VIEW, "target": [INF, 0, 0]}}, r"camera: target = \[inf, 0, 0\]: expected \[east"),
        ({"camera": {**VIEW, "target": 5}}, r"camera: target = 5: expected \[east, north, up\]"),
        ({"camera": {**VIEW, "distanse": 1.0}}, "camera: no 'distanse'; did you mean 'distance'"),
        ({"camera": [1.0, 2.0]}, "camera = .*: expected a Camera or its values by name"),
        ({"camera": {**VIEW, "azimuth": "north"}}, "camera: azimuth = 'north': expected"),
        ({"time": INF}, "time = inf: expected seconds from 0"),
        ({"time": NAN}, "time = nan: expected seconds from 0"),
        ({"time": 10**400}, "time = 1000.*: expected seconds from 0"),
        ({"size": [10**9, 9]}, "size = .*: expected two whole numbers of pixels from 16 to 4096"),
        ({"tine": 1.0}, "a widget has no 'tine'; did you mean 'time'"),
        ([1], "the state of a widget is a mapping, not list"),
    ],
)
def test_a_state_that_cannot_be_is_one_sentence(widget, state, sentence):
    before = dict(widget.values), widget.camera, widget.time
    with pytest.raises(playground.PlaygroundError, match=sentence):
        widget.set_state(state)
    assert (dict(widget.values), widget.camera, widget.time) == before
    widget.set_state({"camera": {"azimuth": 10.0}, "time": 1.5})
    assert widget.camera == Camera(azimuth=10.0) and widget.time == 1.5


def test_a_picture_that_the_kernel_draws_is_the_engine_s(widget, engine, answers):
    ((answer, (picture,)),) = answers(widget, values={"height.rise": 1.0, "height.far": [0.0, 0.0]})
    assert answer == {"drawn": "a-1", "error": ""}
    sketch = widget.sketch.with_values({"height.rise": 1.0}).with_camera(Camera(10.0, 40.0, 500.0))
    expected = engine.render(sketch, size=SIZE).array
    np.testing.assert_array_equal(pixels(picture), expected)
    ((_, (moving,)),) = answers(widget, values={"height.rise": 1.0}, size=[32, 18], moving=True)
    assert moving[:2] == b"\xff\xd8" and pixels(moving).shape == (18, 32, 4)


def test_what_cannot_be_drawn_is_answered_as_well(widget, answers, monkeypatch):
    """Else the browser would wait for ever."""
    for wrong in ({"values": {"height.rise": "x"}}, {"time": NAN}, {"camera": {**VIEW, "distance": INF}}):
        ((answer, buffers),) = answers(widget, **wrong)
        assert re.search("height.rise|time = nan|distance = inf", answer["error"]) and buffers == []
    monkeypatch.setattr(widgets, "on_engine", lambda _: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        answers(widget)


def test_changed_sketch_is_shown_and_error_keeps_last_good_one(widget, engine, slope):
    page, picture = widget.page, widget.picture
    np.testing.assert_array_equal(pixels(picture), engine.render(widget.sketch, size=SIZE).array)
    kernel = slope.with_name("slope.glsl")
    text = kernel.read_text(encoding="utf-8")
    kernel.write_text(text.replace("return rise", "return rose"), encoding="utf-8")
    widget.sketch = slope
    assert "slope.glsl:5" in widget.mistake and "rose" in widget.mistake
    assert (widget.page, widget.picture) == (page, picture)
    widget["height.rise"] = 0.1
    kernel.write_text(text.replace("rise = 0.5", "rise = 0.9"), encoding="utf-8")
    widget.sketch = slope
    assert widget.mistake == "" and widget["height.rise"] == 0.9 and widget.page != page
    np.testing.assert_array_equal(
        pixels(widget.picture), engine.render(playground.load(slope), size=SIZE).array
    )


@pytest.mark.slow
def test_what_a_page_cannot_change_is_changed_with_another_page(engine):
    """Elevations are made when the page is: a value of theirs asks for another."""
    widget = playground.widget("jacksboro", size=SIZE)
    locked = {row["path"] for row in unpacked(widget.page)["sketches"][0]["shown"] if row["locked"]}
    assert "height.longest" in locked and "light.sun" not in locked
    page = widget.page
    widget["light.sun"] = (250, 12)
    assert widget.page == page
    widget["height.longest"] = 128
    assert widget.page != page and widget["height.longest"] == 128 and widget["light.sun"] == (250.0, 12.0)


def test_sketch_no_page_can_run_is_drawn_by_kernel_with_reason(engine, slope, answers):
    toy = slope.with_name("toy.frag")
    toy.write_text(TOY, encoding="utf-8")
    widget = playground.widget(toy, size=SIZE)
    assert widget.page == "" and "textureGather(), which the GLSL of web pages has not" in widget.why
    ((answer, (picture,)),) = answers(widget)
    assert answer["error"] == "" and pixels(picture).shape == (36, 64, 4)
    with pytest.raises(playground.PlaygroundError, match="textureGather"):
        playground.widget(toy, size=SIZE, draws="browser")


def test_what_draws_can_be_chosen(engine, slope):
    widget = playground.widget(slope, size=SIZE, draws="kernel")
    assert widget.page == "" and widget.why == "draws = 'kernel'"
    (sketch,) = unpacked(widget.outline)["sketches"]
    paged = unpacked(playground.widget(slope, size=SIZE).page)["sketches"][0]
    assert set(sketch) <= set(paged)
    for name in ("shown", "camera", "frame", "duration", "moves", "presets", "tracks", "terrain"):
        assert (
            {**paged[name], **sketch[name]} == paged[name]
            if name == "terrain"
            else sketch[name] == paged[name]
        )
    data, _ = widget._repr_mimebundle_()
    assert "text/html" not in data and "image/png" in data


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [
        ({"draws": "gpu"}, "draws = 'gpu': expected one of auto, browser, kernel"),
        ({"size": (0, 36)}, r"size = \(0, 36\): expected two whole numbers of pixels from 16 to 4096"),
        ({"sliders": ["height.ris"]}, "did you mean 'height.rise'"),
    ],
)
def test_a_setting_that_cannot_be_is_one_sentence(engine, slope, settings, sentence):
    with pytest.raises(playground.PlaygroundError, match=sentence):
        playground.widget(slope, **settings)


def test_a_saved_notebook_has_the_figure_with_its_values(widget):
    widget["height.rise"] = 0.125
    data, _ = widget._repr_mimebundle_()
    (text,) = re.findall(r"data-terrain-state(?:=\"\")?>([\w+/=]*)</script>", data["text/html"])
    kept = unpacked(text)
    assert kept["kind"] == "sketch" and kept["values"]["height.rise"] == 0.125 and kept["page"] == widget.page


def test_two_are_compared_by_their_values_or_as_sketches(engine, slope):
    both = playground.compare({"height.rise": 0.25}, {"height.rise": 0.75}, sketch=slope, size=SIZE)
    assert (both.left["height.rise"], both.right["height.rise"]) == (0.25, 0.75)
    assert both.rows == ["height.rise"]
    assert both.names == ["height.rise = 0.25", "height.rise = 0.75"]
    left, right = (engine.render(sketch, size=SIZE).array for sketch in both.sketches)
    assert (left != right).any()
    np.testing.assert_array_equal(pixels(both.picture), np.hstack([left, right]))
    both.right = {"height.rise": 0.5}
    assert both.left["height.rise"] == 0.25 and both.sketches[1].overrides == (("height.rise", 0.5),)
    named = playground.compare(slope, both.sketches[0], size=SIZE, names=("mine", "yours"), swipe=True)
    assert named.names == ["mine", "yours"] and named.swipe
    named.sketches = ("nothing", slope)
    assert "no shipped sketch 'nothing'" in named.mistake


@pytest.mark.slow
def test_closing_the_last_releases_what_all_hold(slope):
    """The engine of all widgets, with its context; the next one opens another."""
    first, other = (playground.widget(slope, size=SIZE) for _ in range(2))
    (engine,) = engine_thread.engines
    first.close()
    assert engine_thread.engines == [engine] and not engine.released
    other.close()
    other.close()
    assert engine_thread.engines == [] and engine.released and other.page == "" == first.page
    again = playground.widget(slope, size=SIZE)
    assert again.page
    again.close()


def test_any_thread_may_set_a_sketch(slope):
    widget = playground.widget(slope, size=SIZE)
    before = widget.picture
    steep = widget.sketch.with_values({"height.rise": 1.0})
    other = threading.Thread(target=lambda: setattr(widget, "sketch", steep))
    other.start()
    other.join()
    assert widget.mistake == "" and widget.picture != before
    widget.close()


def test_without_anywidget_one_sentence_names_the_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "anywidget", None)
    monkeypatch.delitem(sys.modules, "playground.publish.notebook.widget")
    for call in (playground.widget, lambda: playground.compare("jacksboro", "jacksboro")):
        with pytest.raises(DataError, match=f"needs anywidget: {re.escape(install_command('notebook'))}"):
            call()
