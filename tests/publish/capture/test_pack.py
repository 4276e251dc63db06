"""Packed sketches: the same picture elsewhere, the same bytes again, nothing outside their folder."""

from __future__ import annotations

import stat
import zipfile
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from playground import cli
from playground.data.values import write_values
from playground.engine.engine import Engine
from playground.errors import DataError
from playground.paths import GLSL
from playground.publish.pack import pack
from playground.sketch import find as unpack
from playground.sketch.files import contents
from playground.sketch.find import unpacked, unpacked_beside
from playground.sketch.model import VARIANTS
from playground.sketch.variants import NAME, active_variant, unverified
from playground.studio.drops import Drops, opened_from
from playground.verify.check import find_files

from ...loading import load
from ...sketch_texts import passes
from ...variants import trust

TERRAIN = """// terrain.glsl -- a picture, tilted
#include "inc/tilt.glsl"
#pragma kernel(output = "height:r32f")
uniform sampler2D shape; //! file
float kernel(ivec2 texel) { return tilt(texel, size) * texelFetch(shape, texel, 0).r; }
"""
TILT = "float tilt(ivec2 texel, ivec2 size) { return float(texel.x) / float(size.x); }\n"
SKETCH = (
    'format = 1  # ours\ntitle = "Hills"\nsize = 17\n'
    + passes(height=("./parts/terrain", 'set = { shape = "images/one.png" }'), light="lighting/l_dot_n")
    + """[view]
use = "view/terrain"
set = { grid = 9 }
[[preset]]
name = "other"
set = { "height.shape" = "images/two.png" }
"""
)


@pytest.fixture(autouse=True)
def _home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(unpack, "cache_folder", lambda: tmp_path / "cache")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "hills"
    for name in ("parts/inc", "images", "screenshots/hills/llvmpipe"):
        (made / name).mkdir(parents=True)
    (made / "parts/terrain.glsl").write_text(TERRAIN)
    (made / "parts/inc/tilt.glsl").write_text(TILT)
    (made / "parts/unused.glsl").write_text(TILT)
    (made / "sketch.toml").write_text(SKETCH)
    (made / "README.md").write_text("Lesson 3\n")
    for name, seed in (("one", 1), ("two", 2)):
        values = np.random.default_rng(seed).random((17, 17), dtype=np.float32)
        write_values(made / f"images/{name}.png", values)
    (made / "screenshots/hills/llvmpipe/noon.png").write_bytes(b"a reference")
    return made


def zipped(path: Path, files: dict[str, bytes], **attributes: int) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in files.items():
            entry = zipfile.ZipInfo(name)
            entry.filename = name  # as another program writes it, unchanged by Python
            for key, value in attributes.items():
                setattr(entry, key, value)
            archive.writestr(entry, data, zipfile.ZIP_DEFLATED)
    return path


def test_a_pack_opens_elsewhere_with_the_same_picture(
    folder: Path, tmp_path: Path, any_engine: Engine
) -> None:
    before = any_engine.render(load(folder), size=(64, 48))
    path = pack(load(folder), tmp_path / "lesson.zip")
    for file in sorted(folder.rglob("*.*")):
        file.unlink()  # nothing of it is needed
    result = load(path)
    assert result.name == "hills" and Path(result.file).is_relative_to(tmp_path / "cache")
    assert np.array_equal(any_engine.render(result, size=(64, 48)).array, before.array)
    other = any_engine.render(result.with_preset("other"), size=(64, 48))
    assert not np.array_equal(other.array, before.array), "the preset's image came along"


def test_what_is_in_it_and_nothing_else(folder: Path) -> None:
    files, main, shipped = contents(load(folder))
    names = "README.md images/one.png images/two.png parts/inc/tilt.glsl parts/terrain.glsl sketch.toml"
    assert sorted(files) == [f"hills/{name}" for name in names.split()]
    assert main == "hills/sketch.toml"
    assert "lighting/l_dot_n.glsl" in shipped and all((GLSL / name).is_file() for name in shipped)


@pytest.mark.slow
def test_pack_includes_references_and_is_byte_reproducible(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("a.zip", "b.zip"):
        assert cli.main(["pack", str(folder), "-o", str(tmp_path / name)]) == 0
        (folder / "sketch.toml").touch()
    assert (tmp_path / "a.zip").read_bytes() == (tmp_path / "b.zip").read_bytes()
    with zipfile.ZipFile(tmp_path / "a.zip") as archive:
        assert archive.read("hills/screenshots/hills/llvmpipe/noon.png") == b"a reference"
        assert archive.namelist() == sorted(archive.namelist())
    assert cli.main(["check", str(tmp_path / "a.zip")]) == 0
    assert "3 files checked, none failed" in capsys.readouterr().out
    assert cli.main(["pack", str(folder), "-o", str(tmp_path / "a.tar")]) == 2
    assert "ending in .zip" in capsys.readouterr().err


def test_a_shipped_sketch_and_a_shader_alone_pack_too(tmp_path: Path) -> None:
    shipped = load(pack(load("splat"), tmp_path / "splat.zip"))
    assert (shipped.name, Path(shipped.file).name) == ("splat", "sketch.toml")
    shader = tmp_path / "plasma.frag"
    shader.write_text("#version 330\nuniform float iTime; out vec4 c;\nvoid main() { c = vec4(iTime); }\n")
    assert Path(load(pack(load(shader), tmp_path / "p.zip")).file).name == "plasma.frag"


def test_the_images_of_a_plain_shader_go_with_it(any_engine: Engine, tmp_path: Path) -> None:
    write_values(tmp_path / "x.png", np.linspace(0.0, 1.0, 12, dtype=np.float32).reshape(3, 4))
    shader = tmp_path / "look.frag"
    shader.write_text(
        '#version 330\nuniform sampler2D tex;  //! file("x.png")\nuniform vec2 u_resolution;\nout vec4 c;\n'
        "void main() { c = texture(tex, gl_FragCoord.xy / u_resolution); }\n"
    )
    packed = pack(load(shader), tmp_path / "look.zip")
    (tmp_path / "elsewhere").mkdir()
    there = load(packed.rename(tmp_path / "elsewhere/look.zip"))
    here = any_engine.render(load(shader), size=(4, 3)).array
    assert here[..., 0].std() > 50
    np.testing.assert_array_equal(any_engine.render(there, size=(4, 3)).array, here)


def test_what_was_changed_in_the_cache_is_made_anew(folder: Path, tmp_path: Path) -> None:
    path = pack(load(folder), tmp_path / "lesson.zip")
    terrain = unpacked(path).parent / "parts/terrain.glsl"
    assert terrain.read_text() == TERRAIN
    terrain.write_text("broken")
    assert unpacked(path).parent / "parts/terrain.glsl" == terrain and terrain.read_text() == TERRAIN


def test_a_window_opens_a_copy_next_to_it_and_leaves_edits_alone(folder: Path, tmp_path: Path) -> None:
    handed = tmp_path / "handed"
    handed.mkdir()
    path = pack(load(folder), handed / "lesson.zip")
    before = path.read_bytes()
    file, sentence = opened_from(path)
    assert file == handed / "hills/sketch.toml" and "edits go there" in sentence
    file.write_text(SKETCH.replace("17", "33"))
    again, sentence = unpacked_beside(path)
    assert again == file and "edits stay" in sentence and "33" in file.read_text()
    assert path.read_bytes() == before
    (folder / "README.md").write_text("Lesson 3, corrected\n")
    newer, _ = unpacked_beside(pack(load(folder), path))
    assert newer == handed / "hills-2/sketch.toml" and "33" in file.read_text()
    assert [p.name for p in handed.iterdir() if p.name.endswith(".part")] == []


def test_a_zip_dropped_on_the_window_opens(folder: Path, tmp_path: Path) -> None:
    messages: list[str] = []
    opened: list[Path] = []
    commands = SimpleNamespace(notices=SimpleNamespace(say=messages.append), open=opened.append)
    drops = Drops(commands)  # type: ignore[arg-type]
    path = pack(load(folder), tmp_path / "lesson.zip")
    drops.take([path])
    assert opened == [tmp_path / "hills-2/sketch.toml"] and "edits go there" in messages[0]
    path.write_bytes(b"no zip")
    drops.take([path])
    assert len(opened) == 1 and "is no zip that can be read" in messages[1]


def test_a_folder_of_somebody_else_s_is_left_alone(folder: Path, tmp_path: Path) -> None:
    path = pack(load(folder), tmp_path / "lesson.zip")
    file, _ = unpacked_beside(path)  # hills/ is the original itself
    assert file == tmp_path / "hills-2/sketch.toml"


BY_HAND = b'format = 1\n[[pass]]\nname = "height"\nuse = "generation/white_noise"\n'


def test_a_zip_made_by_hand_opens_if_it_holds_one_sketch(tmp_path: Path) -> None:
    for name in ("sketch.toml", "terrain/sketch.toml"):
        path = zipped(tmp_path / "hand.zip", {name: BY_HAND, "__MACOSX/terrain/x": b"", "a/.DS_Store": b""})
        assert load(path).graph.find("height") is not None
        file, _ = unpacked_beside(path)
        assert file.name == "sketch.toml"


BAD = ["../x.toml", "/x.toml", "a/../../x", "C:/x", "a\\..\\x", "a//x", "a/./x", "con.glsl"]
BAD += ["a /x", "x.", "a\x01b"]


@pytest.mark.always
@pytest.mark.parametrize("name", BAD)
def test_no_name_leads_out(name: str, tmp_path: Path) -> None:
    path = zipped(tmp_path / "bad.zip", {"sketch.toml": b"", name: b"x"})
    with pytest.raises(DataError, match="is no name that a file of a sketch may have"):
        load(path)
    assert not (tmp_path / "cache").exists()


LINK = {"external_attr": (stat.S_IFLNK | 0o777) << 16}
REFUSED: dict[str, tuple[dict[str, bytes], dict[str, int]]] = {
    "is a link": ({"sketch.toml": b"/etc"}, LINK),
    "twice": ({"sketch.toml": b"", "Sketch.toml": b""}, {}),
    "lies inside a file": ({"sketch.toml": b"", "a/b": b"", "a": b""}, {}),
    "2001 files; at most 2000": ({f"{n}.glsl": b"" for n in range(2001)}, {}),
    r"would become 65 MiB from 0\.0.*too much to unpack": (
        {"sketch.toml": b"", "zeros": bytes(65 * 2**20)},
        {},
    ),
    "holds no file": ({}, {}),
    r"expected one sketch\.toml.* found none": ({"a.toml": BY_HAND}, {}),
    "found 2 of them": ({"a/sketch.toml": BY_HAND, "b/sketch.toml": BY_HAND}, {}),
}


@pytest.mark.parametrize("message", REFUSED)
def test_links_bombs_and_doubles_are_refused(tmp_path: Path, message: str) -> None:
    files, attributes = REFUSED[message]
    with pytest.raises(DataError, match=message):
        load(zipped(tmp_path / "bad.zip", files, **attributes))
    assert message[:5] in ("expec", "found") or not (tmp_path / "cache").exists(), "nothing was written"


def test_overlapping_files_are_refused(tmp_path: Path) -> None:
    path = zipped(tmp_path / "bomb.zip", {"sketch.toml": b"", "a": bytes(range(256)) * 400})
    data = path.read_bytes()
    start = data.index(b"PK\x01\x02", data.index(b"PK\x01\x02") + 1)
    end = data.index(b"PK\x05\x06")
    again = b"".join(data[start:end].replace(b"a", bytes([letter]), 1) for letter in b"bcdefgh")
    tail = bytearray(data[end:])
    tail[8:10] = tail[10:12] = (9).to_bytes(2, "little")
    tail[12:16] = (int.from_bytes(tail[12:16], "little") + len(again)).to_bytes(4, "little")
    path.write_bytes(data[:end] + again + tail)
    with pytest.raises(DataError, match="its files overlap"):
        load(path)


def test_a_file_cut_short_leaves_nothing(folder: Path, tmp_path: Path) -> None:
    path = pack(load(folder), tmp_path / "lesson.zip")
    data = bytearray(path.read_bytes())
    index = data.index(b"hills/parts/terrain.glsl") + 40
    data[index : index + 4] = b"\xff\xff\xff\xff"
    path.write_bytes(data)
    with pytest.raises(DataError, match="cannot be unpacked"):
        load(path)
    assert list((tmp_path / "cache" / "packs").iterdir()) == []


def test_one_that_needs_what_this_playground_has_not_says_so(folder: Path, tmp_path: Path) -> None:
    path = pack(load(folder), tmp_path / "lesson.zip")
    with zipfile.ZipFile(path) as archive:
        files = {name: archive.read(name) for name in archive.namelist()}
    manifest = files["pack.json"].replace(b"lighting/l_dot_n.glsl", b"lighting/of_later.glsl")
    files["pack.json"] = manifest.replace(b'"version": "', b'"version": "9.')
    with pytest.raises(DataError, match=r"needs glsl/lighting/of_later\.glsl.*packed with 9\."):
        load(zipped(path, files))
    with pytest.raises(DataError, match="is of format 2"):
        load(zipped(path, {**files, "pack.json": manifest.replace(b'"format": 1', b'"format": 2')}))
    with pytest.raises(DataError, match=r"its pack\.json cannot be read"):
        load(zipped(path, {**files, "pack.json": b"[]"}))


def test_files_from_outside_are_refused_in_a_sentence(folder: Path, tmp_path: Path) -> None:
    stray = tmp_path / "stray.png"
    write_values(stray, np.ones((17, 17), np.float32))
    sketch = load(folder).with_values({"height.shape": str(stray)})
    with pytest.raises(DataError, match=r"outside the sketch's folder.*copy it there"):
        pack(sketch, tmp_path / "lesson.zip")
    assert not (tmp_path / "lesson.zip").exists()


def test_pack_cache_keeps_latest_and_check_finds_packed_files(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(unpack, "MAX_PACKS", 2)
    for number in range(4):
        (folder / "README.md").write_text(f"{number}")
        latest = unpacked(pack(load(folder), tmp_path / f"{number}.zip"))
    assert len(list((tmp_path / "cache/packs").iterdir())) == 2 and latest.is_file()
    names = [path.name for path, _ in find_files([tmp_path / "3.zip"])]
    assert names == ["tilt.glsl", "terrain.glsl", "sketch.toml"]


def test_a_fast_variant_and_the_record_of_it_go_along_and_run(folder: Path, tmp_path: Path) -> None:
    (folder / "parts/same.glsl").write_text(TERRAIN)
    passes = (
        'agrees = "exact"\n[[pass]]\nname = "height"\nuse = "./same"\nset = { shape = "images/one.png" }\n'
    )
    (folder / "parts/terrain.fast.toml").write_text(passes)
    trust(folder / "parts")
    packed = pack(load(folder), tmp_path / "hills.zip")
    with zipfile.ZipFile(packed) as archive:
        assert {"hills/parts/terrain.fast.toml", f"hills/parts/{NAME}"} <= set(archive.namelist())
    result = load(unpacked(packed))
    assert unverified(result) == ()
    assert active_variant(result.graph.passes[0].technique, VARIANTS) is not None
