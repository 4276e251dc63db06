"""A default that has no effect is reported with what sets the parameter, and where."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from playground.engine.sketch_warnings import newly_shadowed, shadowed_by_files
from playground.sketch.load import load
from playground.sketch.model import Keyframe

KERNEL = """#pragma kernel(output = "height:r32f")
uniform float rise = 2.0;  //! slider(0, 10)
uniform int kind = 0;      //! menu("round", "sharp")
uniform float free = 1.0;  //! slider(0, 10)
float kernel(ivec2 texel) { return rise + float(kind) + free; }
"""
SKETCH = """format = 1
size = 9

[[pass]]
name = "first"
use = "./terrain"

[[pass]]
name = "height"
use = "./terrain"
set = { rise = 5, kind = "sharp" }

[[pass]]
name = "nested"
use = "./both"

[pass.set]
two.free = 7
"""
BOTH = """[[pass]]
name = "one"
use = "./terrain"

[[pass]]
name = "two"
use = "./terrain"
set = { rise = 3 }
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "terrain.glsl").write_text(KERNEL)
    (tmp_path / "both.toml").write_text(BOTH)
    (tmp_path / "sketch.toml").write_text(SKETCH)
    return tmp_path


def listed(result) -> list[str]:
    return [f"{item.path} {item.by.rpartition('/')[2]} {str(item).partition(': ')[2]}" for item in result]


def edited(folder: Path, before: str, after: str):
    old = load(folder)
    text = (folder / "terrain.glsl").read_text()
    (folder / "terrain.glsl").write_text(text.replace(before, after))
    return old, load(folder)


def test_each_default_that_a_file_sets_over_names_its_line(folder):
    sketch = load(folder)
    path = folder.as_posix()
    assert listed(shadowed_by_files(sketch)) == [
        f"height.rise sketch.toml:11 the default is 2; {path}/sketch.toml:11 sets 5",
        f"height.kind sketch.toml:11 the default is round; {path}/sketch.toml:11 sets sharp",
        f"nested.two.rise both.toml:8 the default is 2; {path}/both.toml:8 sets 3",
        f"nested.two.free sketch.toml:18 the default is 1; {path}/sketch.toml:18 sets 7",
    ]
    warning = shadowed_by_files(sketch)[0].warning
    assert (Path(warning.file).name, warning.line, warning.severity) == ("terrain.glsl", 2, "warning")


def test_user_shipped_or_default_value_is_not_reported_shadowed(folder):
    sketch = load(folder).with_values({"height.rise": 1.0, "nested.two.free": 2.0})
    assert [item.path for item in shadowed_by_files(sketch)] == ["height.kind", "nested.two.rise"]
    assert shadowed_by_files(load("jacksboro")) == []
    _, now = edited(folder, "rise = 2.0", "rise = 5.0")
    assert "height.rise" not in [item.path for item in shadowed_by_files(now)]


def test_an_edit_of_a_default_is_reported_where_it_has_no_effect(folder):
    old, now = edited(folder, "rise = 2.0", "rise = 9.0")
    assert [item.path for item in newly_shadowed(old, now)] == ["height.rise", "nested.two.rise"]
    assert str(newly_shadowed(old, now)[0]).endswith("the default is 9; " + f"{folder}/sketch.toml:11 sets 5")
    assert newly_shadowed(now, now) == []
    by_user = now.with_values({"first.rise": 4.0, "height.rise": 1.0})
    assert [(item.path, item.by.rpartition("/")[2], item.value) for item in newly_shadowed(old, by_user)] == [
        ("first.rise", "the panel", 4.0),
        ("height.rise", "the panel", 1.0),
        ("nested.two.rise", "both.toml:8", 3.0),
    ]
    moving = replace(now, keyframes=(Keyframe(0.0, values=(("first.rise", 1.0),), line=20),))
    assert newly_shadowed(old, moving)[0].by.endswith("sketch.toml:20")


def test_new_default_equal_to_set_value_is_not_shadowed(folder):
    old, now = edited(folder, "rise = 2.0", "rise = 5.0")
    assert [item.path for item in newly_shadowed(old, now)] == ["nested.two.rise"]
