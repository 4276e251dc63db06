"""Which folder a technique opened alone may read from, and where links lead: one rule for all callers."""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path

import pytest

from playground.allowed_files import (
    is_file,
    looking_once,
    noting_part,
    noting_places,
    real,
    root_of,
    signature,
)
from playground.errors import ShaderError
from playground.paths import GLSL
from playground.shader import source
from playground.shader.source import read_text
from playground.sketch.load import load

KERNEL = """#include "../lib.glsl"
#pragma kernel(output = "height:r32f")
uniform sampler2D grass;  //! file("../grass.png")
float kernel(ivec2 texel) { return half_of(float(texel.x)); }
"""


@pytest.fixture
def hills(tmp_path: Path) -> Path:
    folder = tmp_path / "hills"
    (folder / "parts").mkdir(parents=True)
    (folder / "lib.glsl").write_text("float half_of(float x) { return 0.5 * x; }\n")
    (folder / "parts" / "k.glsl").write_text(KERNEL)
    return folder


def test_root_is_library_sketch_folder_or_own_folder(hills: Path):
    part = hills / "parts" / "k.glsl"
    assert root_of(GLSL / "noise" / "hash.glsl") == GLSL
    assert root_of(part) == hills / "parts"
    (hills / "sketch.toml").touch()
    assert root_of(part) == hills
    (hills / "parts" / "sketch.toml").touch()
    assert root_of(part) == hills / "parts"


def test_a_part_of_a_sketch_reads_from_the_sketch_s_folder(hills: Path):
    part = hills / "parts" / "k.glsl"
    with pytest.raises(ShaderError, match="outside"):
        load(part)
    (hills / "sketch.toml").touch()
    opened = load(part)
    assert opened.folder == str(hills)
    assert opened.graph.find("height").use == "./parts/k"  # type: ignore[union-attr]
    assert str(hills / "lib.glsl") in opened.files


def test_a_technique_of_several_passes_does_too(hills: Path):
    (hills / "sketch.toml").touch()
    whole = hills / "parts" / "whole.toml"
    whole.write_text('[[pass]]\nname = "height"\nuse = "./k"\n[outputs]\nheight = "height"\n')
    assert str(hills / "lib.glsl") in load(whole).files


def test_links_are_followed_once_in_a_load_and_anew_in_the_next(tmp_path):
    first, second, link = tmp_path / "first", tmp_path / "second", tmp_path / "link"
    first.mkdir()
    second.mkdir()
    link_to(link, first)
    with noting_places():
        assert real(link) == first
        link.unlink()
        link_to(link, second)
        assert real(link) == first, "one load sees one state"
        with noting_places():
            assert real(link) == second
    assert real(link) == second


def test_load_reads_text_once_and_parts_note_its_signature(tmp_path):
    file = tmp_path / "text.glsl"
    file.write_text("first")
    before = signature(file)
    with noting_places() as places:
        assert read_text(file) == "first"
        file.write_text("second, longer")
        with noting_part() as part:
            assert is_file(file)
            assert read_text(file) == "first", "one load sees one state"
        assert places[file] == part[file] == before, "so that the save is seen"
    assert read_text(file) == "second, longer"


def test_what_was_read_before_places_are_noted_is_read_again(tmp_path):
    file, late = tmp_path / "text.glsl", tmp_path / "late.glsl"
    file.write_text("first")
    with looking_once():
        assert read_text(file) == read_text(file, any_encoding=True) == "first"
        assert real(late) == late
        assert not is_file(late)
        file.write_text("second, longer")
        late.touch()
        with noting_part() as part:
            assert read_text(file) == read_text(file, any_encoding=True) == "second, longer"
            assert is_file(late)
        assert part == {file: signature(file), late: signature(late)}


@pytest.mark.parametrize(
    "name", ["no\0name", "x" * 300, "file/below", "..", "gone/..", "circle", "dangling", "."]
)
def test_in_a_load_any_name_leads_where_it_leads_without_one(tmp_path, name):
    (tmp_path / "file").touch()
    link_to(tmp_path / "circle", tmp_path / "circle")
    link_to(tmp_path / "dangling", tmp_path / "nowhere")
    link_to(tmp_path / "here", tmp_path)
    for path in (tmp_path / name, tmp_path / "here" / name, Path(os.path.relpath(tmp_path)) / name):
        expected, there = real(path), is_file(path)
        with looking_once():
            assert (real(path), is_file(path)) == (expected, there)
            assert (real(path), is_file(path)) == (expected, there), "the second time too"


def link_to(link: Path, target: Path) -> None:
    try:
        link.symlink_to(target, target_is_directory=True)
    except OSError:
        pytest.skip("this system makes no links")


def test_each_load_stats_and_reads_every_file_once(hills: Path, monkeypatch: pytest.MonkeyPatch):
    looked: Counter[Path] = Counter()
    texts: Counter[Path] = Counter()
    lstat, read_regular = Path.lstat, source.read_regular

    def counted(path: Path) -> os.stat_result:
        looked[path] += 1
        return lstat(path)

    def counted_text(path: Path, most: int) -> bytes:
        texts[path] += 1
        return read_regular(path, most)

    monkeypatch.setattr(Path, "lstat", counted)
    monkeypatch.setattr(source, "read_regular", counted_text)
    view = '[view]\nuse = "view/map"\ninputs = { shown = "height" }\n'
    (hills / "sketch.toml").write_text(f'format = 1\n[[pass]]\nname = "height"\nuse = "./parts/k"\n{view}')
    kernel = hills / "parts" / "k.glsl"
    load(hills)
    assert looked[kernel] == texts[kernel] == 1
    assert set(looked.values()) == set(texts.values()) == {1}
    load(hills)
    assert looked[kernel] == texts[kernel] == 2
