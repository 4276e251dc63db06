"""`playground export --to page.html` as a user meets it: one file, what it says, what it refuses."""

from __future__ import annotations

import base64
import io
import json
import re
from pathlib import Path
from typing import Any

import PIL.Image
import pytest

from playground import cli

from ..publish.web.pages import parts_of
from ..sketch_texts import passes

HEIGHT = """// rise.glsl -- A slope that rises to the north.
#pragma kernel(output = "height:r32f")
uniform float rise = 1.0;  //! slider(0, 4) How high the northern edge is
float kernel(ivec2 texel) { return rise * float(texel.y) / float(size.y - 1); }
"""
FLAT = """// flat.glsl -- No slope.
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return 0.5; }
"""
COLOUR = """#pragma kernel(output = "colour:rgba16f")
vec4 kernel(ivec2 texel) { return vec4(0.5); }
"""
SKETCH = (
    'format = 1\ntitle = "Rise & fall"\nsize = 17\n'
    + passes(height="./rise", colour="./colour")
    + """[view]
use = "view/terrain"
[[preset]]
name = "half"
set = { "height.rise" = 0.5 }
[[shot]]
name = "quarter"
size = [200, 100]
time = 1.5
set = { "height.rise" = 0.25 }
"""
)
COMPUTE = """#version 430
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba16f, binding = 0) uniform writeonly image2D picture;
void main() { imageStore(picture, ivec2(gl_GlobalInvocationID.xy), vec4(1.0)); }
"""


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    made = tmp_path / "rise"
    made.mkdir()
    texts = {"rise.glsl": HEIGHT, "flat.glsl": FLAT, "colour.glsl": COLOUR, "sketch.toml": SKETCH}
    for name, text in texts.items():
        (made / name).write_text(text)
    (tmp_path / "all.comp").write_text(COMPUTE)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("playground.publish.web_page.read_bundle", lambda name: f"/* {name} */")
    return tmp_path


def page_in(path: Path) -> dict[str, Any]:
    """Return the data of a page."""
    result = re.search(r'id="playground-packed">(.*?)</script>', path.read_text("utf-8"))
    assert result
    page: dict[str, Any] = json.loads(parts_of(result[1])[1])
    return page


@pytest.mark.slow
def test_one_file_is_written_and_a_line_says_what_it_holds(folder: Path, capfd: pytest.CaptureFixture[str]):
    status = cli.main(["export", "rise", "--to", "a.html"])
    out, error = capfd.readouterr()
    assert (status, out) == (0, "a.html\n"), error
    pattern = r"a\.html: (\d+) KiB; \d+ KiB of them data and poster; \d+ texts to edit\n"
    said = re.fullmatch(pattern, error)
    assert said and int(said[1]) == round((folder / "a.html").stat().st_size / 1024)
    assert sorted(path.name for path in folder.iterdir()) == ["a.html", "all.comp", "rise"]


@pytest.mark.slow
def test_a_page_has_its_language(folder: Path):
    """Its data are the same: names and notes are the sketch's."""
    for name, more in (("a.html", []), ("b.html", ["--lang", "en"]), ("c.html", ["--lang", "fr"])):
        assert cli.main(["export", "rise", "--shot", "quarter", *more, "--to", name]) == 0
    usual, english, french = (folder / name for name in ("a.html", "b.html", "c.html"))
    assert usual.read_bytes() == english.read_bytes()
    assert page_in(french) == page_in(usual)
    text = french.read_text("utf-8")
    assert '<html lang="fr">' in text and "ouvrez-la dans un navigateur" in text


@pytest.mark.slow
def test_page_of_shot_has_its_values_time_size_and_poster(folder: Path):
    assert cli.main(["export", "rise", "--shot", "quarter", "--to", "a.html"]) == 0
    [sketch] = page_in(folder / "a.html")["sketches"]
    assert (sketch["frame"], sketch["time"]) == ([200, 100], 1.5)
    assert sketch["values"]["height.rise"] == 0.25
    poster = re.search(r'src="data:image/webp;base64,([^"]+)"', (folder / "a.html").read_text("utf-8"))
    assert poster
    assert PIL.Image.open(io.BytesIO(base64.b64decode(poster[1]))).size == (200, 100)


@pytest.mark.slow
def test_values_presets_and_steps_go_into_the_page(folder: Path):
    arguments = ["export", "diamond_square_steps", "--set", "size=33", "--to", "a.html"]
    assert cli.main([*arguments, "--steps", "height=3"]) == 0
    [sketch] = page_in(folder / "a.html")["sketches"]
    assert sketch["terrain"]["size"] == [33, 33]
    assert list(sketch["steps"].values()) == [3]


@pytest.mark.slow
def test_the_same_sketch_gives_the_same_file(folder: Path):
    for name in ("a.html", "b.html"):
        assert cli.main(["export", "rise", "--shot", "quarter", "--to", name]) == 0
    assert (folder / "a.html").read_bytes() == (folder / "b.html").read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize("expected", ["height=./flat", pytest.param("height", marks=pytest.mark.slow)])
def test_a_menu_of_techniques_has_a_sketch_for_each(folder: Path, expected: str):
    assert cli.main(["export", "rise", "--technique", expected, "--to", "a.html"]) == 0
    page = page_in(folder / "a.html")
    [menu] = page["sketches"][0]["choices"]
    assert (menu["pass"], menu["label"], menu["now"]) == ("height", "Height", "./rise")
    uses = {other["use"]: page["sketches"][other["sketch"]] for other in menu["others"]}
    assert {"./rise", "./flat"} <= uses.keys()
    for use, sketch in uses.items():
        [own] = sketch["choices"]
        assert (own["now"], own["others"]) == (use, menu["others"])
    flat = uses["./flat"]
    kernels = {node["path"]: flat["kernels"][node["kernel"]]["name"] for node in flat["nodes"]}
    assert kernels["height"] == "flat"
    assert flat["presets"] == [{"name": "half", "values": {}}]
    assert any("preset 'half' leaves height.rise out" in note for note in flat["notes"])


@pytest.mark.slow
def test_two_menus_have_a_sketch_for_each_pair(folder: Path):
    (folder / "rise" / "red.glsl").write_text(COLOUR.replace("0.5", "0.5, 0.0, 0.0, 1.0"))
    menus = ["--technique", "height=./flat", "--technique", "colour=./red"]
    assert cli.main(["export", "rise", *menus, "--to", "a.html"]) == 0
    sketches = page_in(folder / "a.html")["sketches"]
    assert len(sketches) == 4
    now = [tuple(menu["now"] for menu in sketch["choices"]) for sketch in sketches]
    assert now[0] == ("./rise", "./colour") and len(set(now)) == 4
    for number, sketch in enumerate(sketches):
        for at, menu in enumerate(sketch["choices"]):
            for other in menu["others"]:
                there = now[other["sketch"]]
                assert there[at] == other["use"]
                assert there[1 - at] == now[number][1 - at], "the other menu stays as it is"


def test_what_the_page_does_otherwise_is_said(capfd: pytest.CaptureFixture[str]):
    assert cli.main(["export", "delaunay_flips", "--to", "a.html"]) == 0
    assert "the triangulation is exported as it is" in capfd.readouterr().err


def test_a_page_that_would_be_too_large_is_refused(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str], folder: Path
):
    monkeypatch.setattr("playground.publish.web_page.MAX_PAGE_BYTES", 2**10)
    assert cli.main(["export", "delaunay_flips", "--to", "a.html"]) == 2
    assert "a smaller terrain, image or film would do" in capfd.readouterr().err
    assert not (folder / "a.html").exists()


@pytest.mark.slow
def test_an_older_page_stays_when_another_cannot_be_written(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
):
    (folder / "a.html").write_text("as it was")
    monkeypatch.setattr("playground.publish.web_page.encoded_poster", _refuse)
    assert cli.main(["export", "rise", "--to", "a.html"]) == 2
    assert (folder / "a.html").read_text() == "as it was"
    assert len(list(folder.iterdir())) == 3


def _refuse(*_: object) -> None:
    from playground.errors import DataError

    raise DataError("no poster")
