"""A button, a point with ranges, a menu with values: read, written, saved, drawn."""

from __future__ import annotations

import numpy as np
import pytest

from playground.commands.entries import Choice
from playground.errors import ParameterError, ShaderError
from playground.publish.sweep import parts_of, sweep_text
from playground.shader.parameter import coerce, expected, write
from playground.sketch.load import load
from playground.sketch.save import saved_text
from playground.studio.panel.randomise import at_random, mutated
from playground.verify.reduce.case import inline_sketch

KERNEL = """#pragma kernel(output = "colour:rgba32f", repeat = "1 + (mode == 40)")
uniform int mode = 9;       //! menu("soft", "hard", "none") values(-3, 9, 40) What it does
uniform vec2 place = vec2(0.0, 3.0);  //! point(-1, 1, 2, 4) Where
uniform vec2 even = vec2(0.5);        //! point(-2, 2)
uniform bool go;            //! button label("Go!") Begins anew
vec4 kernel(ivec2 texel) { return vec4(float(mode), place, go ? 1.0 : 0.0) + 0.0 * vec4(even.x); }
"""
SKETCH = """[[pass]]
name = "a"
use = "./a"
size = 2
{}

[view]
use = "view/map"
inputs = {{ shown = "a" }}
"""


@pytest.fixture
def sketch(folder):
    folder.write("a.glsl", KERNEL)
    return lambda more="": load(folder.write("s.toml", f"format = 1\n{SKETCH.format(more)}"))


def parameters(sketch):
    return {p.name: p for p in sketch.graph.find("a").technique.parameters}


def test_what_an_annotation_says(sketch):
    result = parameters(sketch())
    assert (result["mode"].default, result["mode"].widget.values) == (1, (-3, 9, 40))
    assert result["place"].widget.axes == ((-1.0, 1.0), (2.0, 4.0))
    assert (result["place"].widget.low, result["place"].widget.high) == (-1.0, 4.0)
    assert (result["even"].widget.axes, result["even"].widget.low) == ((), -2.0)
    assert (result["go"].widget.kind, result["go"].default, result["go"].title) == ("button", False, "Go!")


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (
            'uniform int a = 2;  //! menu("x", "y") values(1, 4)',
            "is 2; its menu's values are 1, 4",
        ),
        ('uniform int a = 1;  //! menu("x", "y") values(1)', "expected 2 whole numbers"),
        ('uniform int a = 1;  //! menu("x", "y") values(1, 2.5)', "expected 2 whole numbers"),
        ("uniform int a = 1;  //! slider(0, 4) values(1, 4)", "a menu before it"),
        ("uniform bool a = true;  //! button", "must be false"),
        ("uniform float a;  //! button", "button is for bool"),
        ("uniform vec2 a;  //! point(1)", "two numbers, the lower first"),
        ("uniform vec2 a;  //! point(0, 1, 2)", "two numbers, the lower first"),
        ("uniform vec2 a = vec2(2.0);  //! point(0, 1)", "outside its range 0 to 1"),
        ("uniform vec2 a = vec2(0.5, 0.5);  //! point(0, 1, 2, 4)", "outside its range 2 to 4"),
    ],
)
def test_what_is_refused_at_its_line(folder, line, words):
    text = f'#pragma kernel(output = "h:r32f")\n{line}\nfloat kernel(ivec2 t) {{ return 0.0; }}\n'
    with pytest.raises(ShaderError, match=words) as caught:
        load(folder.write("b.glsl", text))
    assert caught.value.diagnostics[0].line == 2


def test_values_are_taken_and_written(sketch):
    result = parameters(sketch())
    assert [coerce(result["mode"], name) for name in ("none", 0)] == [2, 0]
    assert write(result["mode"], 2) == "none"
    assert coerce(result["place"], "0.5,4") == (0.5, 4.0)
    assert (coerce(result["go"], "on"), write(result["go"], True)) == (True, "true")
    for name, value, words in (
        ("mode", "nine", "expected one of soft, hard, none; did you mean 'none'"),
        ("mode", "9", "expected one of"),
        ("place", "1,1", "1 is outside its range 2 to 4"),
        ("even", "a", "expected two numbers from -2 to 2, as 0,0"),
    ):
        with pytest.raises(ParameterError, match=words):
            coerce(result[name], value)
    assert expected(result["place"]) == "two numbers from -1 to 1 and from 2 to 4, as 0,3"
    assert Choice("a.place", result["place"], (0.0, 3.0), True).range == "-1 to 1, 2 to 4"
    assert Choice("a.go", result["go"], False, True).range == "true while pressed"
    assert Choice("a.mode", result["mode"], 1, True).as_json()["choices"] == ["soft", "hard", "none"]


def test_the_uniform_gets_the_value_and_a_repeat_names_it(any_engine, sketch):
    for choice, (value, repeat) in {"hard": (9, 1), "soft": (-3, 1), "none": (40, 2)}.items():
        made = sketch(f'set = {{ mode = "{choice}", place = [-1, 4] }}')
        np.testing.assert_array_equal(any_engine.read(made, "a")[0, 0], [value, -1, 4, 0])
        assert any_engine.plan(made, (4, 4)).walk()[0].total == repeat


def test_a_pressed_button_is_true_and_stale_afterwards(any_engine, sketch):
    made = sketch()
    for pressed, seen in ((frozenset({"a.go"}), 1.0), (frozenset({"b.go"}), 0.0), (frozenset(), 0.0)):
        any_engine.runner.pressed = pressed
        assert any_engine.read(made, "a")[0, 0, 3] == seen
    assert any_engine.read(made.with_values({"a.go": True}), "a")[0, 0, 3] == 1.0


def test_it_is_saved_by_its_label(sketch):
    made = sketch().with_values({"a.mode": "none", "a.place": (0.25, 2.5)})
    text = saved_text(SKETCH.format(""), sketch(), made)
    assert 'mode = "none"' in text and "place = [0.25, 2.5]" in text


def test_it_is_reduced_to_the_same_values(sketch):
    case = inline_sketch(sketch('set = { mode = "none" }'), frame=(8, 8))
    assert dict(case.passes[0].values)["mode"] == 2
    assert "values(-3, 9, 40)" in case.passes[0].text


def test_random_values_keep_to_each_range_and_press_nothing(sketch):
    result = [(name, p) for name, p in parameters(sketch()).items()]
    now = {name: p.default for name, p in result}
    for seed in range(40):
        for made in (at_random(result, seed), mutated(result, now, seed, 0.9)):
            assert "go" not in made and made["mode"] in (0, 1, 2)
            assert -1 <= made["place"][0] <= 1 and 2 <= made["place"][1] <= 4


def test_a_sweep_goes_through_labels_and_ranges(sketch):
    result = parameters(sketch())
    assert sweep_text("a.mode", result["mode"]) == "a.mode=soft,hard,none"
    assert parts_of(result["place"]) == ("x", "y")
    assert sweep_text("a.place", result["place"], "y") == "a.place.y=2..4,9"
