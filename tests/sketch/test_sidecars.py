"""Files next to a data file that say how to read it: they go wherever it goes."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from playground.allowed_files import leads_outside, sidecar_places, sidecars
from playground.data.content_hash import content_hash, content_key
from playground.errors import DataError, PlaygroundError
from playground.sketch.files import contents, find_file
from playground.sketch.load import load
from playground.sketch.save import save, save_copy
from playground.studio.reload.dependencies import data_files

from ..sketch_texts import passes

KERNEL = """// k.glsl -- a picture
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
    (made / "k.glsl").write_text(KERNEL)
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
        monkeypatch.setattr("playground.data.content_hash._LARGE", 1)
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
