"""What was set by hand outlives a reload, unless the file itself changed that very thing."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from playground.live.edits import Draft, Edits, reload_draft
from playground.sketch.assign import values_of
from playground.sketch.load import load
from playground.sketch.model import Camera

KERNEL = """// land.glsl -- level land
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1)
uniform float other = 0.5; //! slider(0, 1)
float kernel(ivec2 texel) { return level + other; }
"""
SKETCH = """format = 1
size = 33
[[pass]]
name = "height"
use = "./land"
set = { other = 0.25 }
[view]
use = "view/map"
inputs = { shown = "height" }
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "land.glsl").write_text(KERNEL, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    return tmp_path


def edited(folder: Path, **values: float) -> Draft:
    sketch = load(folder)
    return Draft(sketch, sketch, Edits(tuple((f"height.{k}", v) for k, v in values.items())))


def change(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new), encoding="utf-8")


def test_values_by_hand_outlive_a_change_of_something_else(folder: Path) -> None:
    old = edited(folder, level=0.9)
    change(folder / "land.glsl", "level + other", "level - other")
    draft, notes = reload_draft(old, load(folder))
    assert values_of(draft.sketch)["height.level"] == 0.9
    assert notes == []


def test_the_file_wins_where_the_file_changed(folder: Path) -> None:
    old = edited(folder, level=0.9, other=0.8)
    change(folder / "sketch.toml", "other = 0.25", "other = 0.3")
    draft, notes = reload_draft(old, load(folder))
    assert values_of(draft.sketch) == {**values_of(draft.sketch), "height.level": 0.9, "height.other": 0.3}
    assert len(notes) == 1 and "height.other" in notes[0] and "0.3" in notes[0]


def test_a_parameter_of_another_type_falls_back_and_says_so(folder: Path) -> None:
    old = edited(folder, level=1.0)
    change(
        folder / "land.glsl",
        "uniform float level = 0.5; //! slider(0, 1)",
        "uniform int level = 1; //! slider(0, 3)",
    )
    change(folder / "land.glsl", "return level +", "return float(level) +")
    draft, notes = reload_draft(old, load(folder))
    assert values_of(draft.sketch)["height.level"] == 1
    assert not draft.edits.has("height.level")
    assert "was a float and is a int" in notes[0]


def test_a_value_out_of_a_new_range_falls_back_and_says_so(folder: Path) -> None:
    old = edited(folder, level=0.9)
    change(folder / "land.glsl", "level = 0.5; //! slider(0, 1)", "level = 0.5; //! slider(0, 0.6)")
    draft, notes = reload_draft(old, load(folder))
    assert values_of(draft.sketch)["height.level"] == 0.5
    assert "outside its range" in notes[0]


def test_a_parameter_that_goes_and_returns_keeps_its_value(folder: Path) -> None:
    old = edited(folder, level=0.9)
    text = (folder / "land.glsl").read_text(encoding="utf-8")
    change(
        folder / "land.glsl", "uniform float level = 0.5; //! slider(0, 1)\n", "const float level = 0.5;\n"
    )
    without, notes = reload_draft(old, load(folder))
    assert "height.level" not in values_of(without.sketch) and "is gone" in notes[0]
    (folder / "land.glsl").write_text(text, encoding="utf-8")
    again, notes = reload_draft(without, load(folder))
    assert values_of(again.sketch)["height.level"] == 0.9 and notes == []


def test_the_camera_stays_until_the_file_moves_it(folder: Path) -> None:
    sketch = load(folder)
    old = Draft(sketch, sketch, Edits(camera=Camera(azimuth=10.0)))
    same, _ = reload_draft(old, replace(sketch, title="another"))
    assert same.sketch.camera.azimuth == 10.0
    moved, notes = reload_draft(old, sketch.with_camera(Camera(azimuth=77.0)))
    assert moved.sketch.camera.azimuth == 77.0 and "camera" in notes[0]


def test_a_technique_chosen_by_hand_stays_until_the_file_chooses(folder: Path) -> None:
    (folder / "other.glsl").write_text(KERNEL.replace("land", "other"), encoding="utf-8")
    sketch = load(folder)
    chosen = Draft(sketch, sketch).choose("height", "generation/diamond_square")
    stays, _ = reload_draft(chosen, replace(sketch, title="another"))
    assert stays.sketch.graph.find("height").use == "generation/diamond_square"
    change(folder / "sketch.toml", "./land", "./other")
    given, notes = reload_draft(chosen, load(folder))
    assert given.sketch.graph.find("height").use == "./other" and "gave way" in notes[0]


def test_choosing_what_the_file_says_is_no_edit(folder: Path) -> None:
    sketch = load(folder)
    draft = Draft(sketch, sketch).choose("height", "generation/diamond_square")
    assert draft.edits.techniques == (("height", "generation/diamond_square"),)
    assert draft.choose("height", "./land").edits.techniques == ()
    assert draft.reset().base is sketch
