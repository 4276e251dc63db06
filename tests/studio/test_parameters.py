"""What the panel lists and opens on, what is typed, random values, undo."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from imgui_bundle import imgui

from playground.errors import ParameterError
from playground.shader.parameter import Widget, coerce, tidied
from playground.sketch.assign import values_of
from playground.sketch.find import find, shipped_sketches
from playground.sketch.model import Camera, Parameter
from playground.studio.draw import fitting_label
from playground.studio.edits.edits import Draft, Edits
from playground.studio.edits.history import History, State, applied, edits_of, state_of, step_label
from playground.studio.panel.parameter_list import (
    Filter,
    filtered,
    main_items,
    sections_of,
    set_words,
    shown_values,
)
from playground.studio.panel.randomise import at_random, mutated, targets
from playground.studio.panel.values import read_typed

from ..loading import load
from ..sketch_texts import map_of, map_of_height, passes
from .panel_desk import Bare, OpenBare

TERRAIN = """// terrain.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high the hills are
uniform float seed = 3.0; //! slider(0, 9) Which hills
float kernel(ivec2 texel) { return level; }
"""
LIGHT = """// light.glsl -- light
#pragma kernel(output = "light:rgba16f")
uniform float seed = 3.0; //! slider(0, 9) Which light
vec4 kernel(ivec2 texel) { return vec4(seed); }
"""
SKETCH = (
    'format = 1\nsize = 33\nmain = ["light.seed", "height.seed"]\n'
    + passes(height="./terrain", light="./light")
    + map_of("height")
)


FILES = {"terrain.glsl": TERRAIN, "light.glsl": LIGHT, "sketch.toml": SKETCH}


def value(bare: Bare, path: str) -> object:
    assert bare.session.sketch is not None
    return values_of(bare.session.sketch)[path]


def drawn_for(name: str, *, everything: bool = False) -> tuple[list[str], str]:
    sketch = load(find(name))
    result, words = targets(Draft(sketch, sketch), Filter(), everything=everything)
    return [path for path, _ in result], words


def test_main_parameters_come_first_in_order_with_passes_folded(bare: Bare) -> None:
    result = main_items(bare.session.shown.base)
    assert [item.path for item in result] == ["light.seed", "height.seed"]
    assert [item.title for item in result] == ["Light: seed", "Height: seed"], "a title alone would not do"
    bare.run_frames(2)
    light, height = bare.places["##main light.seed"], bare.places["##main height.seed"]
    assert light[1] < height[1]
    assert "##height.level" not in bare.places, "its pass is folded"


def test_a_label_that_leans_on_its_group_has_it_before_it() -> None:
    sketch = load(find("variants"))
    titles = {item.path: item.title for item in main_items(sketch)}
    assert titles["weights.rock_slope"] == "Slope: from" and titles["weights.snow_from"] == "Height: from"
    assert titles["by_height.rock_from"] == "Rock from" and titles["view.mode"] == "Compare"


@pytest.mark.slow
def test_shipped_main_parameter_titles_are_distinct_and_fit(bare: Bare) -> None:
    room = 97.0  # what the panel's first width leaves a label
    imgui.new_frame()
    for name in shipped_sketches():
        sketch = load(find(name))
        titles = [item.title for item in main_items(sketch)]
        assert len(set(titles)) == len(titles), name
        assert [title for title in titles if fitting_label(title, room)[1] != title] == [], name
    imgui.end_frame()


def test_a_sketch_without_such_a_list_shows_its_passes_unfolded(folder: Path, open_bare: OpenBare) -> None:
    (folder / "sketch.toml").write_text(SKETCH.replace('main = ["light.seed", "height.seed"]\n', ""))
    bare = open_bare(folder)
    assert "##height.level" in bare.places and "##main height.seed" not in bare.places


def test_a_main_parameter_is_typed_where_it_was_clicked_on(bare: Bare) -> None:
    bare.click("Height###pass", 0.2)  # now the parameter is there twice
    imgui.get_io().add_key_event(imgui.Key.mod_ctrl, True)
    bare.click("##main height.seed", 0.2)
    imgui.get_io().add_key_event(imgui.Key.mod_ctrl, False)
    bare.run_frames(2)
    assert "##main height.seed-typed" in bare.places and "##height.seed-typed" not in bare.places
    bare.type("7")
    bare.key(imgui.Key.enter)
    assert value(bare, "height.seed") == 7.0


def test_the_menu_of_a_main_parameter_resets_it(bare: Bare) -> None:
    bare.session.drafts.set("height.seed", 5.0)
    bare.click("##main height.seed", 0.2, button=1)
    bare.click("Reset")
    assert value(bare, "height.seed") == 3.0


def test_random_values_affect_shape_unless_everything_is_chosen(bare: Bare) -> None:
    bare.click("Random")
    bare.click("Random values")
    assert value(bare, "height.seed") != 3.0
    assert (value(bare, "light.seed"), value(bare, "height.level")) == (3.0, 0.5)
    bare.click("Everything")
    bare.click("Random values")
    assert value(bare, "light.seed") != 3.0 and value(bare, "height.level") != 0.5


@pytest.mark.parametrize(
    ("name", "least", "words"),
    [
        (
            "diamond_square",
            {"height.smoothing", "height.seed", "height.corners"},
            "the main ones of the shape",
        ),
        ("multiply", {"first.seed", "second.seed"}, "the main ones of the shape"),
        ("profile", {"height.seed"}, "the main ones of the shape"),
        ("daylight", {"daylight.hour"}, "the main ones"),
    ],
)
def test_random_values_of_shipped_sketches(name: str, least: set[str], words: str) -> None:
    result, label = drawn_for(name)
    assert least <= set(result) and label == words
    assert not any(path.startswith("view.") or path.endswith("raw_size") for path in result)


def test_everything_is_everything() -> None:
    result, _ = drawn_for("daylight", everything=True)
    assert {"view.exposure", "height.raw_size", "light.gain"} <= set(result)


# ── parameter list ────────────────────────────────────────────────────────────


KERNEL = """// terrain.glsl -- level terrain
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high it lies
uniform float other = 0.5; //! slider(0, 1) group("More") label("Beside it")
float kernel(ivec2 texel) { return level + other; }
"""
LISTED_SKETCH = "format = 1\nsize = 33\n" + map_of_height("./both")
BOTH = '[[pass]]\nname = "inner"\nuse = "./terrain"\n[parameters]\nhigh = "inner.level"\n'


@pytest.fixture
def draft(tmp_path: Path) -> Draft:
    for name, text in {"terrain.glsl": KERNEL, "sketch.toml": LISTED_SKETCH, "both.toml": BOTH}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    sketch = load(tmp_path)
    return Draft(sketch, sketch)


# ── what is listed ───────────────────────────────────────────────────────────


def test_a_pass_lists_what_it_exports_and_what_is_inside(draft: Draft) -> None:
    height, view = sections_of(draft.base)
    assert (height.name, view.name) == ("height", "view")
    assert [(g.name, [i.path for i in g.items]) for g in height.groups] == [("", ["height.high"])]
    ((heading, (group,)),) = height.inner
    assert (heading, group.name, group.items[0].path) == ("inner", "More", "height.inner.other")


@pytest.mark.parametrize(
    ("search", "names"),
    [
        ("high", {"height.high"}),  # name
        ("BESIDE", {"height.inner.other"}),  # label
        ("lies how", {"height.high"}),  # description, in any order
        ("more", {"height.inner.other"}),  # group
        ("inner other", {"height.inner.other"}),  # path
        ("nothing like it", set()),
    ],
)
def test_a_search_finds_every_word_somewhere(draft: Draft, search: str, names: set[str]) -> None:
    left = filtered(draft, Filter(search))
    assert {i.path for section in left.values() for i in section.items if section.name == "height"} == names


def test_what_is_changed_by_any_name_is_marked_and_found(draft: Draft) -> None:
    by_leaf = draft.with_edits(Edits((("height.inner.level", 0.75),)))
    assert shown_values(by_leaf).changed == {"height.high"}
    assert shown_values(by_leaf).of["height.high"] == 0.75
    assert set(filtered(by_leaf, Filter(changed=True))) == {"height"}
    same = draft.with_edits(Edits((("height.high", 0.5),)))
    assert shown_values(same).changed == frozenset(), "set, but to what the file says"
    assert filtered(same, Filter(changed=True)) == {}


def test_what_is_set_can_be_set_again_on_the_command_line(draft: Draft) -> None:
    edited = draft.with_edits(Edits((("height.high", 0.75), ("height.inner.other", 0.1), ("size", (17, 17)))))
    words = set_words(edited).split()
    assert words[::2] == ["--set"] * 3
    pairs = dict(word.split("=") for word in words[1::2])
    assert draft.file.with_values(pairs) == edited.sketch


# ── what is typed ────────────────────────────────────────────────────────────

ANGLE = Parameter("a", "float", 0.0, Widget("slider", 0, 10))
WHOLE = Parameter("a", "int", 0, Widget("slider", 0, 9))
PAIR = Parameter("a", "vec2", (0.0, 0.0))
MENU = Parameter("a", "int", 0, Widget("menu", choices=("soft", "hard")))


@pytest.mark.parametrize(
    ("parameter", "text", "value"),
    [
        (ANGLE, "pi/4", math.pi / 4),
        (ANGLE, " 2 * 3.5 ", 7.0),
        (ANGLE, "0,25", 0.25),
        (WHOLE, "2**3", 8),
        (PAIR, "1/4, max(1, 2)", (0.25, 2.0)),
        (PAIR, "1,2", (1.0, 2.0)),
        (MENU, "hard", 1),
        (Parameter("a", "vec3", (0.0, 0.0, 0.0), Widget("colour")), "#ff0000", (1.0, 0.0, 0.0)),
    ],
)
def test_a_value_may_be_typed_as_an_expression(parameter: Parameter, text: str, value: object) -> None:
    result = read_typed(parameter, text, "p.a")
    assert result == value and type(result) is type(value)


@pytest.mark.parametrize(
    ("parameter", "text", "message"),
    [
        (ANGLE, "11", "outside its range 0 to 10"),
        (ANGLE, "1/0", "division by zero"),
        (ANGLE, "__import__('os')", "p.a"),
        (ANGLE, "pie", "did you mean 'pi'"),
        (WHOLE, "1/2", "expected a whole number"),
        (PAIR, "1", "expected 2 numbers"),
        (MENU, "hrad", "did you mean 'hard'"),
    ],
)
def test_what_cannot_be_taken_is_reported(parameter: Parameter, text: str, message: str) -> None:
    with pytest.raises(ParameterError, match=r"p\.a") as caught:
        read_typed(parameter, text, "p.a")
    assert message in str(caught.value)


def test_a_number_of_the_graphics_card_is_written_short() -> None:
    for value in (0.37, 1e-7, -2.5, 123456.7, 0.1 + 0.2):
        short = tidied(float(np.float32(value)))
        assert np.float32(short) == np.float32(value) and len(repr(short)) <= 12


# ── random values ───────────────────────────────────────────────────────────────────

MANY = [
    ("p.slider", Parameter("slider", "float", 0.5, Widget("slider", 0.0, 1.0), step=0.25)),
    ("p.log", Parameter("log", "float", 1.0, Widget("log_slider", 0.01, 100.0))),
    ("p.count", Parameter("count", "int", 3, Widget("slider", 1, 9))),
    ("p.kind", Parameter("kind", "int", 0, Widget("menu", choices=("a", "b", "c")))),
    ("p.on", Parameter("on", "bool", True, Widget("checkbox"))),
    ("p.sun", Parameter("sun", "vec2", (135.0, 40.0), Widget("direction"))),
    ("p.tint", Parameter("tint", "vec4", (0.2, 0.3, 0.1, 0.5), Widget("colour"))),
    ("p.at", Parameter("at", "vec2", (0.5, 0.5), Widget("point", 0.0, 1.0))),
]
FREE = ("p.free", Parameter("free", "float", 2.0))
FILE = ("p.file", Parameter("file", "sampler2D", "x.png", Widget("file")))


def test_random_values_stay_in_the_ranges_and_repeat() -> None:
    parameters = dict(MANY)
    seen: dict[str, list[object]] = {path: [] for path in parameters}
    for seed in range(200):
        values = at_random([*MANY, FREE, FILE], seed)
        assert values.keys() == parameters.keys() and values == at_random(MANY[::-1], seed)
        for path, value in values.items():
            assert coerce(parameters[path], value, path) == value
            seen[path].append(value)
    assert set(seen["p.slider"]) == {0.0, 0.25, 0.5, 0.75, 1.0}
    assert set(seen["p.kind"]) == {0, 1, 2} and set(seen["p.on"]) == {True, False}
    assert set(seen["p.count"]) == set(range(1, 10))
    below = sum(float(v) < 1.0 for v in seen["p.log"])  # type: ignore[arg-type]
    assert 70 <= below <= 130, "half of a logarithmic slider's way lies below its middle"
    assert all(tint[3] == 0.5 for tint in seen["p.tint"])  # type: ignore[index]


def test_mutation_stays_near_and_spreads_with_strength() -> None:
    parameters = dict([*MANY, FREE])
    values = {path: p.default for path, p in parameters.items()}

    def way(strength: float) -> float:
        gone = []
        for seed in range(200):
            result = mutated([*MANY, FREE, FILE], values | {"p.file": "x.png"}, seed, strength)
            assert result.keys() == parameters.keys()
            assert all(coerce(parameters[path], v, path) == v for path, v in result.items())
            gone.append(abs(math.log10(float(result["p.log"]))) / 4)  # type: ignore[arg-type]
        return float(np.mean(gone))

    # The mean of a normal distribution's absolute value is 0.798 of its deviation.
    assert way(0.05) == pytest.approx(0.798 * 0.05, rel=0.15)
    assert way(0.01) == pytest.approx(0.798 * 0.01, rel=0.15)


# ── undo ─────────────────────────────────────────────────────────────────────


class Harness:
    """A history, and the edits that it follows; a second passes in each frame."""

    def __init__(self) -> None:
        self.history, self.edits, self.now, self.reads = History(), Edits(), 0.0, 0
        self.frame()

    def frame(self, held: bool = False, seconds: float = 1.0) -> None:
        self.now += seconds
        self.history.look(self.edits, {}, self.reads, held=held, now=self.now)

    def set(self, path: str, value: float, **how: float) -> None:
        self.edits = self.edits.with_value(path, value)
        self.frame(**how)  # type: ignore[arg-type]

    def undo(self) -> None:
        assert self.history.go(-1, self._apply)
        self._settle()

    def redo(self) -> None:
        assert self.history.go(1, self._apply)
        self._settle()

    def _apply(self, changes: State) -> bool:
        self.edits = edits_of(applied(state_of(self.edits, {}), changes))
        return True

    def _settle(self) -> None:
        self.history.settle(self.edits, {})
        self.frame()


def test_a_drag_is_one_step_and_one_that_comes_back_is_none() -> None:
    harness = Harness()
    for n in range(10):
        harness.set("p.a", n / 10, held=True, seconds=2.0)
    harness.frame(held=False)
    assert [s.after for s in harness.history.steps] == [{("value", "p.a"): 0.9}]
    for value in (0.5, 0.9):
        harness.set("p.a", value, held=True)
    harness.set("p.a", 0.9, held=False, seconds=0.1)
    harness.frame()
    harness.set("p.b", 1.0)
    assert [list(s.after) for s in harness.history.steps] == [[("value", "p.a")], [("value", "p.b")]]


def test_what_goes_on_in_the_same_way_is_one_step() -> None:
    harness = Harness()
    for n in range(5):
        harness.edits = Edits(camera=Camera(distance=100.0 - n))
        harness.frame(seconds=0.1)
    harness.frame(seconds=5.0)
    harness.edits = Edits(camera=Camera(distance=50.0))
    harness.frame()
    assert len(harness.history.steps) == 2


def test_new_step_clears_redo_and_oldest_steps_are_dropped() -> None:
    harness = Harness()
    harness.history = History(most=4)
    harness.frame()
    for n in range(6):
        harness.set("p.a", float(n))
    assert len(harness.history.steps) == 4 and harness.history.steps[0].after == {("value", "p.a"): 2.0}
    harness.undo()
    harness.undo()
    harness.set("p.b", 1.0)
    assert len(harness.history.steps) == 3 and not harness.history.can_redo


def test_steps_have_names() -> None:
    harness = Harness()
    harness.set("p.a", 0.5)
    harness.history.call("Preset dusk")
    harness.edits = harness.edits.with_value("p.a", 0.75).with_value("p.b", 0.25)
    harness.frame()
    harness.edits = Edits(harness.edits.values, (("p", "x"),))
    harness.frame()
    harness.edits = Edits(harness.edits.values, (("p", "x"),), locked=("p.a",))
    harness.frame()
    harness.history.jump(1.0, 0.0, held=False, now=harness.now)

    def written(path: str, value: object) -> str:
        return "the file's" if value is None else f"{value:g}"

    assert [step_label(s, str.upper, written) for s in harness.history.steps] == [
        "P.A: the file's to 0.5",
        "Preset dusk",
        "p: x",
        "Lock P.A",
        "Time 1.00 s to 0.00 s",
    ]
