"""What may fill a pass, and what stays when something else does."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.errors import SketchError
from playground.sketch.assign import value_of, values_of
from playground.sketch.replace_technique import choices, fits, nearest_fitting, with_technique

from ..loading import load
from ..sketch_texts import map_of, passes

pytestmark = pytest.mark.slow


FLAT = """// flat.glsl -- level terrain
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1)
uniform float smoothing = 0.1; //! slider(0, 0.3)
float kernel(ivec2 texel) { return level * smoothing; }
"""
RAISED = """// raised.glsl -- terrain on terrain
#pragma kernel(output = "height:r32f")
uniform sampler2D height; //! input
uniform float level = 0.25; //! slider(0, 1)
float kernel(ivec2 texel) { return level + texelFetch(height, texel, 0).r; }
"""
BROKEN = """// broken.glsl -- no such widget
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slidder(0, 1)
float kernel(ivec2 texel) { return level; }
"""
PAINT = """// paint.glsl -- a colour
#pragma kernel(output = "colour:rgba16f")
uniform sampler2D height; //! input
vec4 kernel(ivec2 texel) { return texelFetch(height, texel, 0).rrrr; }
"""
LIBRARY = "// library.glsl -- nothing to run\nfloat twice(float x) { return 2.0 * x; }\n"
SKETCH = (
    "format = 1\nsize = 33\n"
    + passes(
        height=("./flat", "set = { level = 0.75, smoothing = 0.2 }"),
        upper=("./raised", 'inputs = { height = "height" }'),
        colour=("./paint", 'inputs = { height = "upper" }'),
    )
    + map_of("colour")
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    files = {"flat": FLAT, "raised": RAISED, "broken": BROKEN, "paint": PAINT, "library": LIBRARY}
    for name, text in files.items():
        (tmp_path / f"{name}.glsl").write_text(text, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    return tmp_path


def test_what_gives_the_same_outputs_and_can_be_wired_is_offered(folder: Path) -> None:
    sketch = load(folder)
    first, second, colour = (choices(sketch, name) for name in ("height", "upper", "colour"))
    assert "./flat" in first and "generation/diamond_square" in first
    assert "./raised" not in first, "nothing comes before it that could be its input"
    assert {"./raised", "./flat", "generation/diamond_square"} <= set(second)
    assert "./paint" in colour and not {"./flat", "./raised"} & set(colour)
    assert not {"./broken", "./library", "./sketch"} & {*first, *second, *colour}


def test_what_fills_a_pass_is_always_offered(folder: Path) -> None:
    sketch = load(folder)
    (folder / "flat.glsl").write_text(BROKEN, encoding="utf-8")
    assert "./flat" in choices(sketch, "height")


def test_values_stay_where_their_parameters_do(folder: Path) -> None:
    sketch = load(folder).with_values({"upper.level": 0.9, "height.level": 0.1})
    changed = with_technique(sketch, "upper", "./flat")
    assert values_of(changed)["upper.level"] == pytest.approx(0.9)
    assert values_of(changed)["height.level"] == pytest.approx(0.1)
    assert changed.graph.find("upper").inputs == (), "it has no input to be wired"
    back = with_technique(changed, "height", "generation/diamond_square")
    assert "height.level" not in dict(back.overrides)
    assert value_of(back, "height.smoothing", values_of(back)) == pytest.approx(0.2)
    assert "height.level" not in values_of(back)


def test_a_value_out_of_the_new_range_gives_way(folder: Path) -> None:
    sketch = load(folder)
    square = with_technique(sketch, "height", "generation/diamond_square").with_values(
        {"height.smoothing": 0.9}
    )
    assert values_of(with_technique(square, "height", "./flat"))["height.smoothing"] == pytest.approx(0.2)


def test_wires_to_inputs_that_remain_stay(folder: Path) -> None:
    (folder / "lifted.glsl").write_text(RAISED.replace("raised", "lifted"), encoding="utf-8")
    changed = with_technique(load(folder), "upper", "./lifted")
    assert changed.graph.find("upper").inputs == (("height", "height"),)


def test_the_same_technique_is_the_same_sketch(folder: Path) -> None:
    sketch = load(folder)
    assert with_technique(sketch, "upper", "./raised") is sketch


def test_a_technique_that_cannot_be_wired_is_refused_by_name(folder: Path) -> None:
    with pytest.raises(SketchError, match="needs its input 'height'"):
        with_technique(load(folder), "height", "./raised")
    with pytest.raises(SketchError, match="did you mean 'height'"):
        choices(load(folder), "hieght")
    with pytest.raises(SketchError, match="there is no technique"):
        with_technique(load(folder), "height", "./flatt")


def test_the_parts_of_a_technique_are_not_offered() -> None:
    sketch = load("jacksboro")
    offered = choices(sketch, "height")
    assert "generation/diamond_square" in offered
    assert not [name for name in offered if name.startswith("generation/diamond_square/")]


def test_a_view_is_not_replaced_by_linear_light() -> None:
    offered = choices(load("jacksboro"), "view")
    assert "view/terrain" in offered
    # A frame of linear light would be shown as if it were encoded.
    assert not {"view/land", "view/sky", "view/sea"} & set(offered)


def test_one_technique_is_known_to_fit_without_the_others(folder: Path) -> None:
    sketch = load(folder)
    offered = choices(sketch, "height")
    part = "generation/diamond_square/raw"
    for use in ("./flat", "./raised", "./paint", "./nowhere", "generation/fbm", "view/map", part):
        assert fits(sketch, "height", use) is (use in offered), use
    assert nearest_fitting(sketch, "height", "generation/fmb") == "; did you mean 'generation/fbm'?"
    with pytest.raises(SketchError, match="did you mean 'height'"):
        fits(sketch, "hieght", "./flat")
