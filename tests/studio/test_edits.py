"""What was set by the user outlives a reload, unless the file itself changed that very thing."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from playground.sketch.assign import values_of
from playground.sketch.model import Camera
from playground.studio.edits.edits import Draft, Edits, reload_draft

from ..loading import load
from ..sketch_texts import map_of, passes

KERNEL = """// terrain.glsl -- level terrain
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1)
uniform float other = 0.5; //! slider(0, 1)
float kernel(ivec2 texel) { return level + other; }
"""
SKETCH = "format = 1\nsize = 33\n" + passes(height=("./terrain", "set = { other = 0.25 }")) + map_of("height")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "terrain.glsl").write_text(KERNEL, encoding="utf-8")
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
    change(folder / "terrain.glsl", "level + other", "level - other")
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
        folder / "terrain.glsl",
        "uniform float level = 0.5; //! slider(0, 1)",
        "uniform int level = 1; //! slider(0, 3)",
    )
    change(folder / "terrain.glsl", "return level +", "return float(level) +")
    draft, notes = reload_draft(old, load(folder))
    assert values_of(draft.sketch)["height.level"] == 1
    assert not draft.edits.has("height.level")
    assert "was float and is int now" in notes[0]


def test_value_outside_new_range_is_clamped_and_reported(folder: Path) -> None:
    old = edited(folder, level=0.9)
    change(folder / "terrain.glsl", "level = 0.5; //! slider(0, 1)", "level = 0.5; //! slider(0, 0.6)")
    draft, notes = reload_draft(old, load(folder))
    assert values_of(draft.sketch)["height.level"] == 0.6
    assert notes == ["height.level = 0.9 is outside its new range 0 to 0.6: 0.6 is taken"]


def test_a_new_default_shows_unless_the_user_has_set_the_value(folder: Path) -> None:
    old = edited(folder, other=0.75)
    change(folder / "terrain.glsl", "level = 0.5;", "level = 0.125;")
    change(folder / "terrain.glsl", "other = 0.5;", "other = 0.625;")
    draft, notes = reload_draft(old, load(folder))
    assert values_of(draft.sketch) == {
        **values_of(draft.sketch),
        "height.level": 0.125,
        "height.other": 0.75,
    }
    assert notes == []


def test_a_set_value_outlives_a_new_default_of_its_own(folder: Path) -> None:
    old = edited(folder, level=0.75)
    change(folder / "terrain.glsl", "level = 0.5;", "level = 0.125;")
    draft, notes = reload_draft(old, load(folder))
    assert values_of(draft.sketch)["height.level"] == 0.75 and notes == []


def test_value_equal_to_file_stops_being_edit(folder: Path) -> None:
    old = edited(folder, other=0.75)
    change(folder / "sketch.toml", "other = 0.25", "other = 0.75")
    draft, notes = reload_draft(old, load(folder))
    assert values_of(draft.sketch)["height.other"] == 0.75
    assert draft.edits == Edits() and notes == []


def test_a_value_returns_with_its_technique(folder: Path) -> None:
    old = edited(folder, level=0.9)
    away = old.choose("height", "generation/diamond_square")
    assert "height.level" not in values_of(away.sketch) and away.applied == {}
    same, notes = reload_draft(away, load(folder))
    assert notes == []
    back = same.choose("height", "./terrain")
    assert values_of(back.sketch)["height.level"] == 0.9
    assert values_of(back.sketch)["height.other"] == 0.25, "and so does what the file sets there"


def test_a_value_that_another_technique_does_not_take_waits(folder: Path) -> None:
    low = KERNEL.replace("terrain", "low").replace("slider(0, 1)", "slider(0, 0.6)")
    (folder / "low.glsl").write_text(low, encoding="utf-8")
    whole = KERNEL.replace("terrain", "whole").replace("uniform float level = 0.5", "uniform int level = 1")
    whole = whole.replace("return level", "return float(level)")
    (folder / "whole.glsl").write_text(whole, encoding="utf-8")
    for value, use, there in ((0.9, "./low", 0.5), (1.0, "./whole", 1)):
        away = edited(folder, level=value).choose("height", use)
        assert values_of(away.sketch)["height.level"] == there
        same, notes = reload_draft(away, load(folder))
        assert notes == [] and values_of(same.choose("height", "./terrain").sketch)["height.level"] == value


def test_a_value_outlives_its_pass(folder: Path) -> None:
    old = edited(folder, level=0.9)
    text = (folder / "sketch.toml").read_text(encoding="utf-8")
    (folder / "sketch.toml").write_text(text.replace('"height"', '"ground"'), encoding="utf-8")
    gone, notes = reload_draft(old, load(folder))
    assert len(notes) == 1 and "waits in case it returns" in notes[0]
    (folder / "sketch.toml").write_text(text, encoding="utf-8")
    again, notes = reload_draft(gone, load(folder))
    assert values_of(again.sketch)["height.level"] == 0.9 and notes == []


def test_value_waits_while_parameter_has_another_type(folder: Path) -> None:
    old = edited(folder, level=1.0)
    text = (folder / "terrain.glsl").read_text(encoding="utf-8")
    line = "uniform float level = 0.5; //! slider(0, 1)"
    change(folder / "terrain.glsl", line, "const float level = 0.5;")
    gone, _ = reload_draft(old, load(folder))
    (folder / "terrain.glsl").write_text(
        text.replace(line, "uniform int level = 0; //! slider(0, 3)").replace("level +", "float(level) +"),
        encoding="utf-8",
    )
    other, _ = reload_draft(gone, load(folder))
    assert values_of(other.sketch)["height.level"] == 0
    (folder / "terrain.glsl").write_text(text, encoding="utf-8")
    again, _ = reload_draft(other, load(folder))
    assert values_of(again.sketch)["height.level"] == 1.0


def test_a_choice_keeps_its_name_when_its_menu_is_written_anew(folder: Path) -> None:
    line = "uniform float level = 0.5; //! slider(0, 1)"
    change(folder / "terrain.glsl", line, 'uniform int level = 0; //! menu("low", "high")')
    change(folder / "terrain.glsl", "level +", "float(level) +")
    old = edited(folder, level=1)
    change(folder / "terrain.glsl", '"low", "high"', '"none", "low", "high"')
    moved, notes = reload_draft(old, load(folder))
    assert values_of(moved.sketch)["height.level"] == 2 and notes == []
    change(folder / "terrain.glsl", '"none", "low", "high"', '"none", "low"')
    lost, notes = reload_draft(moved, load(folder))
    assert values_of(lost.sketch)["height.level"] == 0
    assert notes == ["height.level: its menu has no 'high' any more: back to the file's value"]


def test_what_is_locked_stays_over_any_change_of_the_files(folder: Path) -> None:
    sketch = load(folder)
    edits = Edits((("height.other", 0.75),), locked=("height.other", "height.level"))
    old = Draft(sketch, sketch, edits)
    change(folder / "terrain.glsl", "level = 0.5;", "level = 0.125;")
    change(folder / "sketch.toml", "other = 0.25", "other = 0.3")
    draft, notes = reload_draft(old, load(folder))
    values = values_of(draft.sketch)
    assert (values["height.level"], values["height.other"]) == (0.5, 0.75) and notes == []


def test_an_edit_is_taken_back_by_any_name_of_its_parameter(folder: Path) -> None:
    (folder / "both.toml").write_text(
        '[[pass]]\nname = "inner"\nuse = "./terrain"\n[parameters]\nhigh = "inner.level"\n',
        encoding="utf-8",
    )
    change(folder / "sketch.toml", "./terrain", "./both")
    change(folder / "sketch.toml", "set = { other = 0.25 }", "")
    sketch = load(folder)
    draft = Draft(sketch, sketch, Edits((("height.inner.level", 0.75), ("height.inner.other", 0.125))))
    assert values_of(draft.without("height.high").sketch)["height.inner.level"] == 0.5
    assert values_of(draft.without("height.high").sketch)["height.inner.other"] == 0.125


def test_a_parameter_that_goes_and_returns_keeps_its_value(folder: Path) -> None:
    old = edited(folder, level=0.9)
    text = (folder / "terrain.glsl").read_text(encoding="utf-8")
    change(
        folder / "terrain.glsl", "uniform float level = 0.5; //! slider(0, 1)\n", "const float level = 0.5;\n"
    )
    without, notes = reload_draft(old, load(folder))
    assert "height.level" not in values_of(without.sketch) and "is gone" in notes[0]
    (folder / "terrain.glsl").write_text(text, encoding="utf-8")
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
    (folder / "other.glsl").write_text(KERNEL.replace("terrain", "other"), encoding="utf-8")
    sketch = load(folder)
    chosen = Draft(sketch, sketch).choose("height", "generation/diamond_square")
    stays, _ = reload_draft(chosen, replace(sketch, title="another"))
    assert stays.sketch.graph.find("height").use == "generation/diamond_square"
    change(folder / "sketch.toml", "./terrain", "./other")
    value, notes = reload_draft(chosen, load(folder))
    assert value.sketch.graph.find("height").use == "./other" and "gave way" in notes[0]


def test_choosing_what_the_file_says_is_no_edit(folder: Path) -> None:
    sketch = load(folder)
    draft = Draft(sketch, sketch).choose("height", "generation/diamond_square")
    assert draft.edits.techniques == (("height", "generation/diamond_square"),)
    assert draft.choose("height", "./terrain").edits.techniques == ()
    assert draft.with_all(Edits()).base is sketch
