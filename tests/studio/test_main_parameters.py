"""What the panel opens on, and what random values are for, without a screen."""

from __future__ import annotations

from pathlib import Path

import pytest
from imgui_bundle import imgui

from playground.engine.engine import Engine
from playground.sketch.assign import values_of
from playground.sketch.find import find, shipped_sketches
from playground.studio.draw import fitting_label
from playground.studio.edits.edits import Draft
from playground.studio.panel.parameter_list import Filter, main_items
from playground.studio.panel.randomise import targets

from ..loading import load
from ..sketch_texts import map_of, passes
from .panel_desk import Bare

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


def test_a_sketch_without_such_a_list_shows_its_passes_unfolded(folder: Path, any_engine: Engine) -> None:
    (folder / "sketch.toml").write_text(SKETCH.replace('main = ["light.seed", "height.seed"]\n', ""))
    bare = Bare(any_engine, folder)
    try:
        assert "##height.level" in bare.places and "##main height.seed" not in bare.places
    finally:
        bare.close()


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
