"""The files of a sketch: which may be read, where they are found, and what lies next to them."""

from __future__ import annotations

import os
from collections import Counter
from pathlib import Path

import pytest

from playground.allowed_files import (
    is_file,
    leads_outside,
    looking_once,
    noting_part,
    noting_places,
    real,
    root_of,
    sidecar_places,
    sidecars,
    signature,
)
from playground.data.content_hash import content_hash, content_key
from playground.errors import DataError, PlaygroundError, ShaderError
from playground.paths import GLSL
from playground.shader import source
from playground.shader.source import read_text
from playground.sketch import files
from playground.sketch.files import contents, find_file
from playground.sketch.load import load
from playground.sketch.save import save, save_copy

from ..sketch_texts import passes

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


# ── A file that a parameter names is found as it is now, whatever was found before


@pytest.fixture
def places(tmp_path: Path) -> tuple[Path, Path]:
    """Give the folder of a sketch, and in it that of a kernel."""
    sketch = tmp_path / "sketch"
    kernel = sketch / "kernels"
    kernel.mkdir(parents=True)
    return sketch, kernel


def found(places: tuple[Path, Path], text: str = "p.png") -> Path:
    return find_file(text, str(places[0]), str(places[1] / "k.glsl"), "picture")


def test_a_file_that_stays_is_not_looked_for_anew(places, monkeypatch):
    (places[1] / "p.png").write_bytes(b"1")
    assert found(places) == places[1] / "p.png"
    monkeypatch.setattr(files.Path, "resolve", lambda *_: pytest.fail("its links are followed again"))
    assert found(places) == places[1] / "p.png"


def test_file_appearing_in_first_search_folder_is_found(places):
    (places[1] / "p.png").write_bytes(b"1")
    assert found(places) == places[1] / "p.png"
    (places[0] / "p.png").write_bytes(b"2")
    assert found(places) == places[0] / "p.png"


def test_one_that_goes_is_missed_and_one_that_is_replaced_found(places):
    file = places[0] / "p.png"
    file.write_bytes(b"1")
    assert found(places) == file
    file.unlink()
    with pytest.raises(DataError, match="no such file"):
        found(places)
    file.write_bytes(b"2")
    assert found(places) == file


def test_a_link_that_leads_elsewhere_is_followed_there(places, tmp_path):
    for name in ("one", "two"):
        (places[0] / name).mkdir()
        (places[0] / name / "p.png").write_bytes(b"1")
    link = places[0] / "link"
    link.symlink_to("one", target_is_directory=True)
    assert found(places, "link/p.png") == places[0] / "one" / "p.png"
    link.unlink()
    link.symlink_to("two", target_is_directory=True)
    assert found(places, "link/p.png") == places[0] / "two" / "p.png"
    link.unlink()
    (tmp_path / "p.png").write_bytes(b"1")
    link.symlink_to(tmp_path, target_is_directory=True)
    with pytest.raises(DataError):
        found(places, "link/p.png")


def test_sidecar_link_out_of_folder_is_refused_once_it_appears(places, tmp_path):
    (places[0] / "dem.asc").write_text("1", encoding="utf-8")
    assert found(places, "dem.asc") == places[0] / "dem.asc"
    (tmp_path / "dem.prj").write_text("1", encoding="utf-8")
    (places[0] / "dem.prj").symlink_to(tmp_path / "dem.prj")
    with pytest.raises(DataError, match="leads out of the sketch's folder"):
        found(places, "dem.asc")


# ── Files next to a data file that say how to read it: they go wherever it goes


PICTURED = """// k.glsl -- a picture
#pragma kernel(output = "height:r32f")
uniform sampler2D shape; //! file
float kernel(ivec2 texel) { return texelFetch(shape, texel, 0).r; }
"""
SKETCH = "format = 1\nsize = 17\n" + passes(height=("./k", 'set = { shape = "data/a.bil" }'))


def grid(path: Path, *endings: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    for ending in (path.suffix, *endings):
        path.with_suffix(ending).write_text(f"{path.stem} {ending}")
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "own"
    grid(made / "data/a.bil", ".hdr", ".prj", ".shx", ".txt")
    (made / "k.glsl").write_text(PICTURED)
    (made / "sketch.toml").write_text(SKETCH)
    return made


@pytest.mark.parametrize(
    ("ending", "names"),
    [
        (".bil", [".hdr", ".prj"]),
        (".flt", [".hdr", ".prj"]),
        (".asc", [".prj"]),
        (".shp", [".shx", ".dbf", ".prj", ".cpg"]),
        (".SHP", [".shx", ".dbf", ".prj", ".cpg"]),
        (".png", []),
    ],
)
def test_each_format_has_its_own(tmp_path: Path, ending: str, names: list[str]) -> None:
    path = grid(tmp_path / f"a{ending}", ".hdr", ".prj", ".shx", ".dbf", ".cpg", ".txt")
    assert [p.suffix for p in sidecars(path)] == names
    assert set(sidecars(path)) <= set(sidecar_places(path))


def test_what_gdal_appends_to_a_name_goes_along(folder: Path, tmp_path: Path) -> None:
    source = grid(tmp_path / "elsewhere/b.tif")
    aux = source.with_name("b.tif.aux.xml")
    assert sidecars(source) == ()
    before = content_key(source)
    aux.write_text("<PAMDataset/>")
    assert sidecars(source) == (aux,) and content_key(source) != before
    sketch = load(folder)
    save(sketch, sketch.with_values({"height.shape": str(source)}))
    assert (folder / "b.tif.aux.xml").read_text() == "<PAMDataset/>"


def test_small_letters_come_first_and_what_is_not_there_is_none(tmp_path: Path) -> None:
    path = grid(tmp_path / "a.bil", ".HDR")
    assert [p.name.lower() for p in sidecars(path)] == ["a.hdr"]


@pytest.mark.parametrize("large", [False, True])
def test_the_contents_change_with_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, large: bool) -> None:
    if large:
        monkeypatch.setattr("playground.data.content_hash.LARGE", 1)
    path = grid(tmp_path / "a.flt", ".hdr")
    seen = [(content_hash(path), content_key(path))]
    for ending, text in ((".hdr", "other"), (".prj", "new"), (".prj", "newer")):
        path.with_suffix(ending).write_text(text)
        seen.append((content_hash(path), content_key(path)))
    assert all(len(set(each)) == len(seen) for each in zip(*seen, strict=True))
    path.with_suffix(".prj").unlink()
    assert (content_hash(path), content_key(path)) == seen[1]
    path.with_suffix(".txt").write_text("of no concern")
    assert content_hash(path) == seen[1][0]


def test_they_are_watched_there_or_not(folder: Path) -> None:
    from playground.studio.reload.dependencies import data_files

    (folder / "data/a.prj").unlink()
    paths = data_files(load(folder))
    assert {folder / "data" / name for name in ("a.bil", "a.hdr", "a.prj")} <= paths
    assert folder / "data/a.txt" not in paths


def test_they_are_packed(folder: Path) -> None:
    files, _, _ = contents(load(folder))
    assert {name for name in files if "/data/" in name} == {f"own/data/a.{e}" for e in ("bil", "hdr", "prj")}


def test_they_are_copied_with_a_sketch(folder: Path, tmp_path: Path) -> None:
    sketch = load(folder)
    copy = save_copy(sketch, sketch, tmp_path).parent
    assert sorted(p.name for p in (copy / "data").iterdir()) == ["a.bil", "a.hdr", "a.prj"]


def test_sidecars_are_copied_to_sketch_under_unused_name(folder: Path, tmp_path: Path) -> None:
    source = grid(tmp_path / "elsewhere/b.bil", ".hdr", ".prj")
    sketch = load(folder)
    save(sketch, sketch.with_values({"height.shape": str(source)}))
    for ending in (".bil", ".hdr", ".prj"):
        assert (folder / f"b{ending}").read_bytes() == source.with_suffix(ending).read_bytes()
    source.with_suffix(".hdr").write_text("the same numbers in another order")
    sketch = load(folder)
    save(sketch, sketch.with_values({"height.shape": str(source)}))
    assert (folder / "b.hdr").read_text() == "b .hdr", "another file needs it"
    assert (folder / "b-2.hdr").read_text() == "the same numbers in another order"
    assert (folder / "b-2.bil").exists() and 'shape = "b-2.bil"' in (folder / "sketch.toml").read_text()


@pytest.mark.skipif(os.name == "nt", reason="links need a right of their own there")
def test_one_that_leads_out_of_a_stranger_s_folder_is_refused(folder: Path, tmp_path: Path) -> None:
    private = tmp_path / "private"
    private.write_text("nrows 1")
    assert not leads_outside("data/a.bil", folder)
    (folder / "data/a.hdr").unlink()
    (folder / "data/a.hdr").symlink_to(private)
    assert leads_outside("data/a.bil", folder)
    with pytest.raises(PlaygroundError, match="outside"):
        load(folder)
    with pytest.raises(DataError, match=r"shape: a\.hdr next to it leads out of the sketch's folder"):
        find_file("data/a.bil", str(folder), str(folder / "k.glsl"), "shape")
    (folder / "b.bil").symlink_to(folder / "data/a.bil")
    assert leads_outside("b.bil", folder), "where a link leads, its own neighbours count"
    (folder / "data/a.hdr").unlink()
    (folder / "data/a.hdr").symlink_to(folder / "data/a.txt")
    assert not leads_outside("data/a.bil", folder)
