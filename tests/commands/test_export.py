"""`playground export` as a user meets it: what it prints where, its exit status, its sentences."""

from __future__ import annotations

import io
import re
from pathlib import Path

import numpy as np
import pytest

from playground import cli
from playground.publish.commands.export import HELP

from ..elevations import write_geotiff
from ..sketch_texts import map_of, passes

HEIGHT = """// rise.glsl -- a slope that rises to the north.
#pragma kernel(output = "height:r32f")
uniform float rise = 1.0;  //! slider(0, 4) How high the northern edge is
float kernel(ivec2 texel) { return rise * float(texel.y) / float(size.y - 1); }
"""
WAVE = """// wave.glsl -- colours, and no height.
#pragma kernel(output = "colour:rgba16f")
vec4 kernel(ivec2 texel) { return vec4(0.5); }
"""
SKETCH = (
    """format = 1
size = 17
extent = 320.0
relief = 100.0
"""
    + passes(height="./rise", colour="./wave")
    + """[view]
use = "view/terrain"
[[preset]]
name = "half"
set = { "height.rise" = 0.5 }
[[shot]]
name = "quarter"
set = { "height.rise" = 0.25 }
"""
)
LIT = SKETCH.replace("[view]", '[[pass]]\nname = "light"\nuse = "./wave"\n[view]', 1).replace(
    '"half"', '"evening"'
)
FLAT = "format = 1\nsize = 9\n" + passes(colour="./wave") + map_of("colour")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    made = tmp_path / "rise"
    made.mkdir()
    texts = {"rise.glsl": HEIGHT, "wave.glsl": WAVE}
    for name, text in (texts | {"sketch.toml": SKETCH, "lit.toml": LIT, "flat.toml": FLAT}).items():
        (made / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir() if path.name != "rise")


def printed(capsys: pytest.CaptureFixture[str]) -> tuple[str, str]:
    out, error = capsys.readouterr()
    return out, error


def test_export_prints_paths_to_stdout_and_details_to_stderr(folder: Path, capfd: pytest.CaptureFixture[str]):
    status = cli.main(["export", "rise", "--to", "a.r16", "--to", "a.glb"])
    out, error = capfd.readouterr()
    assert status == 0, error
    assert out == "a.r16\na.r16.json\na.glb\n"
    assert error.splitlines() == [
        "a.r16: 17 x 17; 16 bits; 0 is 0 m and 65535 is 100 m; 20 x 20 m a texel",
        "a.glb: 17 x 17 vertices, 512 triangles; 320 x 320 m, 0 to 100 m high; texture 17 x 17",
    ]
    assert names(folder) == ["a.glb", "a.r16", "a.r16.json"]


def test_without_a_name_a_new_one_is_taken(folder: Path, capsys: pytest.CaptureFixture[str]):
    assert [cli.main(["export", "rise"]) for _ in range(2)] == [0, 0]
    assert printed(capsys)[0] == "rise.glb\nrise-2.glb\n"
    assert (folder / "rise.glb").read_bytes() == (folder / "rise-2.glb").read_bytes()


def test_the_terrain_is_that_of_the_settings_the_preset_the_shot(folder: Path):
    for options, highest in (
        ([], 100.0),
        (["--set", "height.rise=2"], 200.0),
        (["--preset", "half"], 50.0),
        (["--shot", "quarter"], 25.0),
        (["--shot", "quarter", "--set", "relief=10"], 2.5),
        (["--as", "numbers"], 1.0),
    ):
        assert cli.main(["export", "rise", "--to", "a.npy", *options]) == 0
        result = np.load(folder / "a.npy")
        assert result[0].max() == result.max() == highest and result[-1].max() == 0.0


def test_bits_range_grid_and_driver_are_heard(folder: Path, capsys: pytest.CaptureFixture[str]):
    command = ["export", "rise", "--driver", "fragment", "--bits", "16", "--range", "-50,605.35"]
    assert cli.main([*command, "--to", "a.tif"]) == 0
    assert "0 is -50 m and 65535 is 605.35 m" in printed(capsys)[1]
    assert cli.main(["export", "rise", "--grid", "5", "-o", "a.obj"]) == 0
    assert "5 x 5 vertices, 32 triangles" in printed(capsys)[1]
    assert cli.main(["export", "rise", "--range", "10,20", "-o", "a.png"]) == 0
    assert re.search(
        r"^warning: a\.png: \d+ of 289 values \([\d.]+ %\) are outside 10 to 20 m",
        printed(capsys)[1],
        re.MULTILINE,
    )


def test_what_is_right_is_written_beside_mistakes(folder: Path, capsys: pytest.CaptureFixture[str]):
    """Each mistake once, at the end; of the sketch's, too, which shows when a file is prepared."""
    command = ["export", "rise", "--to", "a.fbx", "--to", "a.npy", "--to", "no/b.png", "--to", "c.npy"]
    assert cli.main(command) == 2
    out, error = printed(capsys)
    assert out.split() == ["a.npy", "c.npy"] == names(folder)
    *_, count, first, second = error.splitlines()
    assert count == "2 of 4 files are written"
    assert first == "error: a.fbx: nothing is exported as '.fbx'; a mesh is .glb, .obj or .stl"
    assert second.endswith("no/b.png: there is no folder 'no' to write into")
    command = ["export", "rise", "--to", "a.png", "--to", "b.tif", "--texture", "colr"]
    assert cli.main(command) == 2
    assert printed(capsys)[1].count("no pass 'colr' in sketch rise") == 1


@pytest.mark.parametrize("ending", ["glb", "png", "obj"])
def test_a_sketch_without_height_says_so(ending: str, folder: Path, capsys: pytest.CaptureFixture[str]):
    assert cli.main(["export", "rise/flat.toml", "--to", f"a.{ending}"]) == 2
    assert printed(capsys)[1] == "error: sketch flat has no height to export; its textures are colour\n"
    assert names(folder) == []
    assert cli.main(["export", "rise/flat.toml", "--texture", "colour", "--to", "a.png"]) == 0


def test_what_was_there_stays_when_an_export_fails(folder: Path, capsys: pytest.CaptureFixture[str]):
    (folder / "a.png").write_bytes(b"before")
    assert cli.main(["export", "rise", "--to", "a.png", "--set", "height.rise=0", "--texture", "x"]) == 2
    assert (folder / "a.png").read_bytes() == b"before"
    assert cli.main(["export", "rise", "--to", "a.png"]) == 0
    assert (folder / "a.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.slow
def test_every_example_of_the_help_runs(folder: Path, capsys: pytest.CaptureFixture[str]):
    """On a small sketch in the place of those that ship, which take longer."""
    examples = re.findall(r"^  playground (export .*)$", HELP, re.MULTILINE)
    assert len(examples) > 4
    dem = write_geotiff(folder / "dem.tif")
    for line in examples:
        line, piped, _ = line.partition(" > ")
        if piped:  # to standard output: see below
            continue
        line = re.sub("jacksboro|diamond_square", "rise/lit.toml", line).replace("size=1025", "size=33")
        assert cli.main(line.split()) == 0, printed(capsys)[1]
    dem.unlink()
    written = set(printed(capsys)[0].split())
    assert written == set(names(folder)) == {
        "lit.glb", "terrain.png", "terrain.tif", "terrain.r16", "terrain.r16.json", "ground.webp",
        "terrain.glb", "model.stl", "terrain.obj", "terrain.mtl", "terrain-texture.png",
        "hills.json", "fractal.fs", "page.html", "noise.html", "steps.html", "in-its-place.tif",
    }  # fmt: skip


@pytest.mark.parametrize("name", ["splat", "splat_mask", "splat_distance"])
def test_a_view_that_mixes_at_every_pixel_has_no_texture_to_give(
    name: str, folder: Path, capsys: pytest.CaptureFixture[str]
):
    """None of its layers is the terrain's texture."""
    assert cli.main(["export", name, "--grid", "9", "--to", "a.obj"]) == 0
    assert "no texture: the view shows no colour; name one with --texture" in printed(capsys)[1]
    assert names(folder) == ["a.mtl", "a.obj"]


def test_one_file_by_two_names_is_one(folder: Path, capsys: pytest.CaptureFixture[str]):
    assert cli.main(["export", "rise", "--to", "a.png", "--to", str(folder / "a.png")]) == 2
    assert "would be written twice" in printed(capsys)[1] and not list(folder.glob("a.png"))


# ── to standard output ───────────────────────────────────────────────────────


@pytest.mark.parametrize("form", ["npy", ".TIF", "glb", ""])
def test_export_to_stdout_writes_exactly_the_file_bytes(form: str, capfdbinary: pytest.CaptureFixture[bytes]):
    chosen = ["--format", form] if form else []
    ending = form.lower().removeprefix(".") or "glb"
    assert cli.main(["export", "rise", "--to", f"rise.{ending}"]) == 0
    capfdbinary.readouterr()
    assert cli.main(["export", "rise", "--to", "-", *chosen]) == 0
    out, err = capfdbinary.readouterr()
    assert out == Path(f"rise.{ending}").read_bytes()
    assert err.startswith(b"standard output: ")


@pytest.mark.room("dialects")
def test_a_shader_comes_in_by_a_pipe_and_leaves_by_one(
    monkeypatch: pytest.MonkeyPatch, capfdbinary: pytest.CaptureFixture[bytes]
):
    text = b"// Half red\nvoid mainImage(out vec4 c, in vec2 p) { c = vec4(0.5, 0.0, 0.0, 1.0); }\n"
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(text), "utf-8"))
    assert cli.main(["export", "-", "--to", "-", "--format", "fs", "-q"]) == 0
    out, err = capfdbinary.readouterr()
    assert out.startswith(b"/*{") and b"0.5, 0.0, 0.0" in out and err == b""


def test_a_terminal_gets_no_bytes(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]):
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    assert cli.main(["export", "rise", "--to", "-"]) == 2
    monkeypatch.undo()
    assert "--to - writes a .glb file to standard output, which is the terminal" in capfd.readouterr().err
