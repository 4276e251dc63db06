"""Numbers, colours, values as text and gestures in a page are the window's: JavaScript against Python."""

from __future__ import annotations

import math
import tomllib
from functools import cache
from typing import Any

import numpy as np
import pytest

from playground.engine.camera import look
from playground.publish.web.parameter_data import parameters_data, row
from playground.shader.colours import linear_to_srgb, parse_hex, srgb_to_linear, to_hex
from playground.shader.parameter import coerce, is_whole, length_of, tidied
from playground.sketch.assign import check_value, resolve, shown_parameters, values_of
from playground.sketch.find import shipped_sketches
from playground.sketch.model import Camera, Parameter, Sketch, Value
from playground.studio import widgets as dome
from playground.studio.clock import stepped
from playground.studio.panel.parameter_list import main_items
from playground.studio.panel.values import decimals, format_of, snapped, unit_of
from playground.studio.picture.gestures import Gesture, steered, turned_sun
from playground.studio.picture.view import field_for

from ...loading import load
from .node import Node

pytestmark = pytest.mark.slow


RANDOM = np.random.default_rng(16)


Known = tuple[Sketch, str, Parameter, dict[str, Any]]


@cache
def sketches() -> list[Sketch]:
    """Return the shipped sketches."""
    return [load(name) for name in shipped_sketches()]


@cache
def parameters() -> list[Known]:
    """Return each different parameter of the shipped sketches once, with its row of a page."""
    result: dict[str, Known] = {}
    for sketch in sketches():
        for shown in shown_parameters(sketch):
            targets = tuple(target.path for target in resolve(sketch.graph, shown.path))
            data = row(shown, shown.parameter.default, targets)
            parameter = shown.parameter
            result[f"{parameter.name} {parameter.type} {parameter.widget} {parameter.step}"] = (
                sketch,
                shown.path,
                parameter,
                data,
            )
    return list(result.values())


def numbers() -> list[Known]:
    """Return those that are written as numbers."""
    kinds = ("number", "slider", "log_slider", "angle", "divider")
    return [parameter for parameter in parameters() if parameter[2].widget.kind in kinds]


def some_value(parameter: Parameter) -> Value:
    """Return a value at random that a parameter takes."""
    kind, count = parameter.widget.kind, length_of(parameter.type)
    if parameter.type == "bool":
        return bool(RANDOM.integers(2))
    if kind == "menu":
        return int(RANDOM.integers(len(parameter.widget.choices)))
    if kind == "direction":
        return tuple(RANDOM.uniform((0, -10), (360, 90)).round(1).tolist())
    result = []
    for part in range(count):
        low, high = parameter.widget.ends(part)
        low, high = (0.0, 1.0) if kind in ("colour", "point") and low is None else (low, high)
        number = RANDOM.uniform(-40 if low is None else low, 40 if high is None else high)
        if is_whole(parameter.type):
            number = min(max(round(number), math.ceil(low or 0)), number if high is None else int(high))
            result.append(int(number))
        else:
            result.append(snapped(parameter, tidied(number)))
    return tuple(result) if count > 1 else result[0]


def test_there_are_parameters_of_every_widget():
    kinds = {parameter.widget.kind for _, _, parameter, _ in parameters()}
    assert kinds >= {
        "number",
        "slider",
        "log_slider",
        "angle",
        "direction",
        "colour",
        "menu",
        "checkbox",
        "file",
    }
    assert len(parameters()) > 300


def test_numbers_are_written_and_snapped_as_in_the_window(node: Node):
    asked, expected = [], []
    for _, _, parameter, data in numbers():
        low, high = parameter.widget.ends()
        for share in (0.0, 0.123, 0.5, 0.77777, 1.0):
            number = -3.0 + share * 11 if low is None or high is None else low + share * (high - low)
            near = snapped(parameter, number)
            near = round(near) if is_whole(parameter.type) else near
            asked.append([data, near, number])
            expected.append([format_of(parameter) % near, decimals(parameter), unit_of(parameter), near])
    script = """async (asked, load) => {
        const { decimals, snapped, unitOf, written } = await load("numbers.js");
        return asked.map(([one, number, any]) => [
            written(one, number) + unitOf(one), decimals(one), unitOf(one), snapped(one, any)]);
    }"""
    for (data, _, _), result, target in zip(asked, node.run(script, asked), expected, strict=True):
        free = data["ranges"][0][0] is None  # without a range the window writes as many digits as there are
        assert result[free:] == target[free:], data["path"]


def test_a_slider_reaches_its_ends_and_comes_back(node: Node):
    rows = [data for _, _, parameter, data in numbers() if parameter.widget.ends()[1] is not None]
    script = """async (rows, load) => {
        const { scaleOf } = await load("numbers.js");
        return rows.map((one) => {
            const scale = scaleOf(one), shares = [0, 0.2, 0.5, 0.9, 1];
            const there = shares.map(scale.value);
            return [there, there.map((value) => scale.value(scale.share(value)))];
        });
    }"""
    for data, (there, again) in zip(rows, node.run(script, rows), strict=True):
        low, high = data["ranges"][0]
        assert there[0] == low and there[-1] == high, data["path"]
        assert there == sorted(there)
        np.testing.assert_allclose(again, there, rtol=1e-12, atol=1e-12 * max(abs(low), abs(high)))


def test_tidied_numbers_are_pythons(node: Node):
    numbers = [0.37, 0.1, 1 / 3, 1e-30, 123456.789, -2.5, 0.0, 1e39, *RANDOM.normal(size=200).tolist()]
    assert node.each("numbers.js", "tidied", [[n] for n in numbers]) == [tidied(n) for n in numbers]


def test_colours_are_pythons(node: Node):
    bytes_ = [f"#{i:02x}{255 - i:02x}{(7 * i) % 256:02x}" for i in range(256)]
    script = """async (texts, load) => {
        const { fromHex, toHex } = await load("numbers.js");
        return texts.map((text) => {
            const [linear, raw] = [fromHex(text), fromHex(text, true)];
            return [linear, toHex(linear), raw, toHex(raw, true)];
        });
    }"""
    for text, (linear, back, raw, raw_back) in zip(bytes_, node.run(script, bytes_), strict=True):
        np.testing.assert_allclose(linear, parse_hex(text), rtol=4e-16, atol=0)
        assert raw == list(parse_hex(text, raw=True))
        assert back == raw_back == text
    lights = np.linspace(0, 1, 1001)
    for name, python in (("toShown", linear_to_srgb), ("toLinear", srgb_to_linear)):
        result = node.each("numbers.js", name, lights[:, None].tolist())
        np.testing.assert_allclose(result, python(lights), rtol=4e-16, atol=1e-16)
    mixed = RANDOM.uniform(-0.1, 1.1, (200, 4)).tolist()
    assert node.each("numbers.js", "toHex", [[c] for c in mixed]) == [to_hex(colour) for colour in mixed]


@pytest.mark.parametrize("text", ["", "#12", "#1234", "#gggggg", "red", "#123456789", "123456"])
def test_what_is_no_colour_is_none(node: Node, text: str):
    assert node.call("numbers.js", "fromHex", text) is None


def test_values_as_text_are_what_python_reads(node: Node):
    """Links, --set and TOML: what a page writes, Python takes, exactly; and the page itself."""
    chosen = [p for p in parameters() if p[2].widget.kind not in ("file", "button")]
    asked = [[data, some_value(parameter)] for _, _, parameter, data in chosen for _ in range(3)]
    script = """async (asked, load) => {
        const { fits, read, toml, write } = await load("numbers.js");
        return asked.map(([one, value]) => [
            write(one, value), toml(one, value), read(one, write(one, value)), fits(one, value)]);
    }"""
    of = {id(data): (sketch, path, parameter) for sketch, path, parameter, data in parameters()}
    for (data, value), (text, toml, read, fits) in zip(asked, node.run(script, asked), strict=True):
        sketch, path, parameter = of[id(data)]
        assert fits, (path, value)
        assert coerce(parameter, text) == value or data["widget"] == "colour", (path, text, value)
        arguments = tomllib.loads(f"value = {toml}")["value"]
        assert check_value(sketch, path, arguments) == coerce(parameter, text), (path, toml)
        there = np.asarray(read, float) if not isinstance(read, str) else read
        np.testing.assert_allclose(there, np.asarray(coerce(parameter, text), float), rtol=4e-16, atol=1e-16)


def test_values_out_of_range_are_refused_as_python_refuses_them(node: Node):
    asked = []
    for _, _, parameter, data in numbers():
        low, high = parameter.widget.ends()
        if low is not None and high is not None:
            outside = [low - 0.1 * (high - low) - 1, high + 0.1 * (high - low) + 1, math.nan]
            asked += [[data, ",".join([repr(n)] * length_of(parameter.type))] for n in outside]
    asked += [
        [parameters()[0][3], text] for text in ("", "x", "1,2,3,4,5,6", "[]", "{}", "__proto__", "1e999")
    ]
    script = "async (asked, load) => { const { read } = await load('numbers.js');"
    script += " return asked.map(([one, text]) => read(one, text) === undefined); }"
    refused = node.run(script, asked)
    assert [text for (_, text), no in zip(asked, refused, strict=True) if not no] == []


# ── gestures ─────────────────────────────────────────────────────────────────


def test_a_dome_is_the_windows(node: Node):
    places = RANDOM.uniform(-1.3, 1.3, (100, 2)).tolist()
    directions = [dome.direction_at(*place) for place in places]
    close = {"rtol": 1e-12, "atol": 1e-12}
    np.testing.assert_allclose(node.each("controls.js", "directionAt", places), directions, **close)
    dots = [dome.dot_of(*direction) for direction in directions]
    np.testing.assert_allclose(node.each("controls.js", "dotOf", directions), dots, **close)


def test_page_gestures_move_camera_like_window_mouse(node: Node):
    extent, relief, size = (4096.0, 3000.0), 800.0, (960, 540)
    script = """async (camera, eye, across, down, wheel, load) => {
        const { moved, turned, zoomed } = await load("camera.js");
        const pan = moved(camera, eye, camera.field_of_view, across, down);
        return [turned(camera, across, down), pan, zoomed(camera, eye, wheel)];
    }"""
    for _ in range(20):
        azimuth, elevation, field = RANDOM.uniform((0, -80, 20), (360, 88, 90)).tolist()
        camera = Camera(azimuth, elevation, float(RANDOM.uniform(0, 9000)), None, field)
        eye, (across, down) = look(camera, extent, relief, size), RANDOM.uniform(-300, 300, 2).tolist()
        wheel = float(RANDOM.integers(-3, 4))
        expected = [
            steered(camera, eye, Gesture(size[1], across, down, orbiting=True)),
            steered(camera, eye, Gesture(size[1], across, down, panning=True)),
            steered(camera, eye, Gesture(size[1], wheel=wheel)),
        ]
        here = {"azimuth": azimuth, "elevation": elevation, "distance": camera.distance, "target": None}
        here |= {"field_of_view": field}
        there = {"distance": eye.distance, "target": list(eye.target)}
        result = node.run(script, here, there, across / size[1], down / size[1], wheel)
        for mine, theirs in zip(result, expected, strict=True):
            for name in ("azimuth", "elevation", "field_of_view"):
                assert mine[name] == pytest.approx(getattr(theirs, name), rel=1e-12)
        assert result[1]["target"] == pytest.approx(expected[1].target, rel=1e-9)
        if wheel:
            assert result[2]["distance"] == pytest.approx(expected[2].distance, rel=1e-12)


def test_a_narrow_room_opens_the_view_as_in_the_window(node: Node):
    rooms = [
        ((960, 540), (300, 700)),
        ((960, 540), (1600, 300)),
        ((960, 540), (960, 540)),
        ((800, 600), (10, 900)),
    ]
    result = node.each("camera.js", "fieldFor", [(40, *room) for room in rooms])
    assert result == pytest.approx([field_for(40.0, *room) for room in rooms], rel=1e-12)


def test_a_drag_with_ctrl_moves_a_sun_as_in_the_window(node: Node):
    drags = RANDOM.uniform((-10, -10, -3, -3), (370, 90, 3, 3), (50, 4))
    cases = [((a, e), across, up) for a, e, across, up in drags.tolist()]
    result = node.each("camera.js", "sunMoved", cases)
    np.testing.assert_allclose(result, [turned_sun(*case) for case in cases], atol=0.0100001)


def test_frames_of_time_are_the_windows(node: Node):
    times = [(t, by) for t in (0.0, 0.01, 1 / 30, 0.5, 3.99999, 7 / 30) for by in (-1, 1)]
    assert node.each("timeline.js", "stepped", times) == [stepped(time, by) for time, by in times]


# ── what a panel lists ───────────────────────────────────────────────────────


def test_main_parameters_have_the_windows_labels(node: Node):
    script = """async (rows, load) => {
        const { mainLabels, mainRows } = await load("labels.js");
        return [...mainLabels(mainRows(rows))];
    }"""
    seen = 0
    for sketch in sketches():
        if not sketch.main:
            continue
        expected = {item.path: item.title for item in main_items(sketch)}
        rows = parameters_data(sketch, values_of(sketch), lambda path, targets: "")
        assert node.run(script, rows) == [list(item) for item in expected.items()], sketch.name
        seen += len(expected)
    assert seen > 50
