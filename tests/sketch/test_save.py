"""Saving changes the bytes of what was set and no other, and the file then says just that."""

from __future__ import annotations

import os
import random
import stat
import sys
import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.errors import DataError, SketchError
from playground.paths import GLSL, SKETCHES
from playground.sketch.assign import values_of
from playground.sketch.load import load
from playground.sketch.model import Camera, Sketch
from playground.sketch.replace_technique import with_technique
from playground.sketch.save import ReadOnlySketch, save, save_copy, save_preset, saved_text
from playground.sketch.toml_text import KeyPath, TomlPlaces, append, drop, put

from ..cases import each

SHIPPED = sorted(GLSL.rglob("*.toml"))
each_shipped = each("path", SHIPPED, ids=lambda p: p.relative_to(GLSL).as_posix())
SAMPLED, MANY = 2, 12  # places of a file that are tried
few_or_many = pytest.mark.parametrize(
    "count", [pytest.param(SAMPLED, id="few"), pytest.param(MANY, id="many", marks=pytest.mark.slow)]
)


def leaves(value: Any, key_path: KeyPath = ()) -> Iterator[tuple[KeyPath, Any]]:
    """Yield every value of a table that is no table, with its place."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from leaves(inner, (*key_path, key))
    elif isinstance(value, list) and value and all(isinstance(item, dict) for item in value):
        for index, inner in enumerate(value):
            yield from leaves(inner, (*key_path, index))
    else:
        yield key_path, value


def some(places: Iterable[KeyPath], count: int) -> list[KeyPath]:
    """Return so many of them, which differ from file to file."""
    result = sorted(places, key=str)
    return random.Random(len(result)).sample(result, min(len(result), count))


@pytest.mark.slow
@few_or_many
@each_shipped
def test_every_shipped_value_can_be_overwritten_alone(path: Path, count: int) -> None:
    text = path.read_bytes().decode()
    spans, result = TomlPlaces(text), dict(leaves(tomllib.loads(text)))
    assert {position for position in spans.pairs if position in result} == set(result), (
        "tomllib sees the same values"
    )
    for position, value in result.items():
        pair = spans.pairs[position]
        written = text[pair.value : pair.end]
        assert tomllib.loads(f"x = {written}")["x"] == value
    for position in some(result, count):
        pair = spans.pairs[position]
        written = text[pair.value : pair.end]
        table, key = position[:-1], str(position[-1])
        assert put(text, table, key, written) == text
        changed = put(text, table, key, "[7, 8]")
        assert changed == text[: pair.value] + "[7, 8]" + text[pair.end :]
        assert dict(leaves(tomllib.loads(changed))) == {**result, position: [7, 8]}


@pytest.mark.slow
@few_or_many
@each_shipped
def test_any_shipped_value_can_be_added_and_removed(path: Path, count: int) -> None:
    text = path.read_bytes().decode()
    result = dict(leaves(tomllib.loads(text)))
    for table in some({position[:-1] for position in result}, count):
        more = put(text, table, "new-one", "3")
        assert dict(leaves(tomllib.loads(more))) == {**result, (*table, "new-one"): 3}
        left = drop(more, table, "new-one")
        assert left == text, "and then every byte is as it was"
    for position in some(result, count):
        less = dict(leaves(tomllib.loads(drop(text, position[:-1], str(position[-1])))))
        others = {p: v for p, v in result.items() if p != position}
        assert {p: v for p, v in less.items() if v != {}} == others


KERNEL = """// terrain.glsl -- level terrain
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1)
uniform int count = 3; //! slider(0, 9)
uniform int kind = 0; //! menu("soft", "hard")
uniform bool on = true;
uniform vec3 tint = vec3(0.0); //! colour
uniform vec2 sun = vec2(135.0, 40.0); //! direction
uniform vec4 many = vec4(0.0);
uniform sampler2D image; //! file()
float kernel(ivec2 texel) { return level; }
"""
BARE = KERNEL.replace("terrain", "bare").replace("uniform int count = 3; //! slider(0, 9)\n", "")
SKETCH = """# A sketch   of ours.
format = 1
  relief   =   200   # metres

[[pass]]
name = "height"   # the terrain
use = "./terrain"
set = { level = 0.25, count=4 }   # by eye

[view]
use = "view/map"
inputs = { shown = "height" }
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "own"
    made.mkdir()
    for name, text in {"terrain.glsl": KERNEL, "bare.glsl": BARE, "sketch.toml": SKETCH}.items():
        (made / name).write_bytes(text.encode())
    return made


def rewritten(folder: Path, text: str) -> Sketch:
    (folder / "sketch.toml").write_bytes(text.encode())
    return load(folder)


def saved(folder: Path, expected: Sketch) -> str:
    save(load(folder), expected)
    again = load(folder)
    assert values_of(again) == values_of(expected) and again.camera == expected.camera
    return (folder / "sketch.toml").read_bytes().decode()


VALUES = {
    "height.level": (0.75, "0.75"),
    "height.count": (5, "5"),
    "height.kind": ("hard", '"hard"'),
    "height.on": (False, "false"),
    "height.tint": ("#8a9a5b", '"#8a9a5b"'),
    "height.sun": ((90.0, 12.5), "[90, 12.5]"),
    "height.many": ((1e-7, 2.0, -3.5, 1e20), "[1e-07, 2, -3.5, 1e+20]"),
}


@pytest.mark.parametrize("newline", ["\n", "\r\n"], ids=["lf", "crlf"])
@pytest.mark.parametrize("mark", ["", "\ufeff"], ids=["plain", "marked"])
@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("", ""),
        ("set = { level = 0.25, count=4 }   # by eye\n", ""),
        ("set = { level = 0.25, count=4 }   # by eye\n", "set = {}\n"),
        ("set = { level = 0.25, count=4 }   # by eye\n", "set.level = 0.25 # dotted\nset.count = 4\n"),
        (
            "set = { level = 0.25, count=4 }   # by eye\n",
            "[pass.set] # header\n  level = 0.25\n  count = 4\n",
        ),
        ("set = { level = 0.25, count=4 }   # by eye\n", "[pass.set]\n"),
    ],
    ids=["braces", "none", "empty", "dotted", "header", "empty header"],
)
def test_values_are_saved_however_the_file_is_written(
    folder: Path, old: str, new: str, mark: str, newline: str
) -> None:
    text = mark + SKETCH.replace(old, new).replace("\n", newline)
    sketch = rewritten(folder, text)
    expected = sketch.with_values({path: value for path, (value, _) in VALUES.items()})
    after = saved(folder, expected)
    for path, (_, written) in VALUES.items():
        assert f"{path.removeprefix('height.')} = {written}" in after.replace("count=", "count = ")
    assert after.startswith(mark) and after.count("\n") == after.count(newline)
    for comment in ("# A sketch   of ours.", "  relief   =   200   # metres", "# the terrain"):
        assert comment in after
    assert all(
        line in after
        for line in text.splitlines()
        if not any(word in line for word in ("level", "count", "set"))
    )
    assert saved(folder, expected) == after, "saved once more, nothing changes"


def test_one_value_changes_its_own_bytes_only(folder: Path) -> None:
    after = saved(folder, load(folder).with_values({"height.level": 0.75}))
    assert after == SKETCH.replace("0.25", "0.75")
    after = saved(folder, load(folder).with_values({"relief": 300}))
    assert after == SKETCH.replace("0.25", "0.75").replace("200", "300")


def test_direction_keeps_braces_and_integer_has_no_point(folder: Path) -> None:
    old = "level = 0.25"
    text = SKETCH.replace(old, "level = 1, sun = { azimuth = 1, elevation = 2 }")
    expected = rewritten(folder, text).with_values({"height.sun": (3.5, 40.0), "height.level": 0.0})
    assert saved(folder, expected) == text.replace("level = 1", "level = 0").replace(
        "{ azimuth = 1, elevation = 2 }", "{ azimuth = 3.5, elevation = 40 }"
    )


def test_the_camera_is_saved(folder: Path) -> None:
    camera = Camera(12.5, 30.0, 900.0, (1.0, 2.5, 3.0), 40.0)
    after = saved(folder, load(folder).with_camera(camera))
    line = "camera = { azimuth = 12.5, elevation = 30, distance = 900, target = [1, 2.5, 3]"
    line += ", field_of_view = 40 }"
    assert after == SKETCH + line + "\n"
    without = saved(folder, load(folder).with_camera(replace(camera, target=None)))
    assert without == SKETCH + line.replace("target = [1, 2.5, 3], ", "") + "\n"


def test_a_sketch_without_a_view_gets_the_one_it_has(folder: Path) -> None:
    text = SKETCH[: SKETCH.index("\n[view]")]
    expected = rewritten(folder, text).with_camera(Camera(azimuth=7.0)).with_values({"view.channel": "red"})
    after = saved(folder, expected)
    assert after.startswith(text) and after.endswith("camera = { azimuth = 7 }\n")


def test_a_technique_is_saved_without_what_it_has_no_place_for(folder: Path) -> None:
    sketch = load(folder)
    expected = with_technique(sketch, "height", "./bare")
    assert saved(folder, expected) == SKETCH.replace("./terrain", "./bare").replace(", count=4", "")


def test_inner_value_is_saved_under_its_exported_name(folder: Path) -> None:
    (folder / "both.toml").write_text(
        '[[pass]]\nname = "inner"\nuse = "./terrain"\n[parameters]\nhigh = "inner.level"\n', encoding="utf-8"
    )
    text = SKETCH.replace("./terrain", "./both").replace("level = 0.25, count=4", "high = 0.25")
    expected = rewritten(folder, text).with_values({"height.inner.level": 0.75, "height.inner.count": 8})
    assert saved(folder, expected) == text.replace("high = 0.25", 'high = 0.75, "inner.count" = 8')


def test_a_file_from_elsewhere_is_copied_into_the_folder(folder: Path, tmp_path: Path) -> None:
    image = tmp_path / "else where.png"
    write_png(image, np.zeros((2, 2, 4), np.uint8))
    save(load(folder), load(folder).with_values({"height.image": str(image)}))
    assert values_of(load(folder))["height.image"] == "else where.png"
    assert (folder / "else where.png").read_bytes() == image.read_bytes()


@pytest.mark.skipif(sys.platform == "win32", reason="files have no limit there")
def test_failed_file_copy_on_save_leaves_no_partial_file(folder: Path, tmp_path: Path) -> None:
    import resource

    image = tmp_path / "large.png"
    image.write_bytes(bytes(2**20))
    sketch = load(folder)
    before, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2**19, hard))  # as a disk that is full halfway
    try:
        with pytest.raises(DataError, match="cannot be copied into the folder of the sketch"):
            save(sketch, sketch.with_values({"height.image": str(image)}))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (before, hard))
    assert {path.name for path in folder.iterdir()} == {"bare.glsl", "terrain.glsl", "sketch.toml"}


def test_presets_are_saved_and_saved_over(folder: Path) -> None:
    save_preset(load(folder), "by night", {"height.level": 1.0, "height.kind": 1})
    text = (folder / "sketch.toml").read_text(encoding="utf-8")
    assert text == SKETCH + '\n[[preset]]\nname = "by night"\n[preset.set]\n' + (
        '"height.level" = 1.0\n"height.kind" = "hard"\n'
    )
    save_preset(load(folder), "by night", {"height.level": 0.5, "height.on": False})
    (preset,) = load(folder).presets
    assert dict(preset.values) == {"height.level": 0.5, "height.kind": 1, "height.on": False}


@pytest.mark.parametrize(
    ("value", "written"),
    [
        (float(np.float32(0.1)), "0.1"),
        (1 / 3, "0.33333334"),
        (0.7, "0.7"),
        (float(np.float32(1e-7)), "1e-07"),
    ],
)
def test_saved_number_has_fewest_round_trip_digits(folder: Path, value: float, written: str) -> None:
    save(load(folder), load(folder).with_values({"height.level": value}))
    assert f"level = {written}" in (folder / "sketch.toml").read_text(encoding="utf-8")
    assert np.float32(values_of(load(folder))["height.level"]) == np.float32(value)
    save_preset(load(folder), "one", {"height.level": value})
    assert f'"height.level" = {written}\n' in (folder / "sketch.toml").read_text(encoding="utf-8")


def test_a_file_that_has_changed_meanwhile_is_left_alone(folder: Path) -> None:
    sketch = load(folder)
    path = folder / "sketch.toml"
    other = SKETCH.replace("0.25", "0.5").encode()
    path.write_bytes(other)
    with pytest.raises(SketchError, match="changed meanwhile"):
        save(sketch, sketch.with_values({"height.level": 0.75}))
    assert path.read_bytes() == other and len(list(folder.iterdir())) == 3
    path.write_bytes(SKETCH.replace("# by eye", "# by ear").encode())
    save(sketch, sketch.with_values({"height.level": 0.75}))
    assert path.read_bytes() == SKETCH.replace("# by eye", "# by ear").replace("0.25", "0.75").encode()


def test_what_the_file_cannot_say_leaves_it_alone(folder: Path) -> None:
    dotted = "set.sun.azimuth = 1\nset.sun.elevation = 2\n"
    text = SKETCH.replace("set = { level = 0.25, count=4 }   # by eye\n", dotted)
    sketch = rewritten(folder, text)
    with pytest.raises(SketchError, match="cannot be written into this file"):
        save(sketch, sketch.with_values({"height.sun": (3.0, 4.0)}))
    assert (folder / "sketch.toml").read_bytes() == text.encode() and len(list(folder.iterdir())) == 3


@pytest.mark.skipif(sys.platform == "win32", reason="links and permissions of POSIX")
def test_links_and_permissions_stay(folder: Path, tmp_path: Path) -> None:
    real = folder / "sketch.toml"
    real.chmod(0o640)
    link = tmp_path / "linked.toml"
    link.symlink_to(real)
    sketch = load(link)
    save(sketch, sketch.with_values({"height.level": 0.75}))
    assert link.is_symlink() and real.read_text(encoding="utf-8") == SKETCH.replace("0.25", "0.75")
    assert stat.S_IMODE(real.stat().st_mode) == 0o640


def test_a_shipped_sketch_is_not_written_to_but_copied(tmp_path: Path) -> None:
    path = SKETCHES / "drape.toml"
    before = path.read_bytes()
    sketch = load(path)
    expected = sketch.with_camera(Camera(azimuth=5.0)).with_values({"relief": 777.0})
    with pytest.raises(ReadOnlySketch, match="belongs to the playground"):
        save(sketch, expected)
    assert path.read_bytes() == before
    for name in ("drape", "drape-2"):
        copy = save_copy(sketch, expected, tmp_path)
        assert copy == tmp_path / name / "sketch.toml"
        result = load(copy)
        assert values_of(result) == values_of(expected)
        assert (result.camera.azimuth, result.terrain.relief) == (5.0, 777.0)
        images = {v for v in values_of(result).values() if isinstance(v, str) and v}
        assert images and all((copy.parent / image).is_file() for image in images)


@pytest.mark.slow
@pytest.mark.parametrize("path", sorted(SKETCHES.glob("*.toml")), ids=lambda p: p.stem)
def test_what_is_not_set_changes_nothing(path: Path) -> None:
    sketch = load(path)
    text = path.read_bytes().decode()
    assert saved_text(text, sketch, sketch) == text


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write everything")
def test_a_file_that_may_not_be_written_is_left_for_a_copy(folder: Path, tmp_path: Path) -> None:
    (folder / "sketch.toml").chmod(0o444)
    sketch = load(folder)
    with pytest.raises(ReadOnlySketch, match="cannot be written"):
        save(sketch, sketch.with_values({"height.level": 0.75}))


def test_a_shader_opened_alone_has_nothing_to_save_into(folder: Path) -> None:
    sketch = load(folder / "terrain.glsl")
    with pytest.raises(ReadOnlySketch, match="no sketch file"):
        save(sketch, sketch.with_camera(Camera(azimuth=5.0)))


def test_a_copy_that_fails_leaves_nothing(folder: Path, tmp_path: Path) -> None:
    sketch = load(folder)
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(DataError):
        save_copy(sketch, sketch, tmp_path / "file")
    (folder / "terrain.glsl").write_text("broken", encoding="utf-8")
    with pytest.raises(SketchError):
        save_copy(sketch, sketch.with_values({"height.level": 0.75}), tmp_path)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["file", "own"]


def test_appended_lines_follow_text_without_final_newline() -> None:
    assert append("a = 1", ["b = 2"]) == "a = 1\n\nb = 2\n"
    assert put("a = 1", (), "b", "2") == "a = 1\nb = 2"
    assert drop("a = 1\nb = 2", (), "b") == "a = 1\n"
    assert put("[t]\r\nx.y = [ # why\r\n  1,\r\n]\r\n", ("t",), "x.y", "2") == "[t]\r\nx.y = 2\r\n"
    assert put('"a.b" = 1\n\'c\'.d = {e.f="}"}', ("c",), "d.e.f", "3") == "\"a.b\" = 1\n'c'.d = {e.f=3}"
