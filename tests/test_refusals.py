"""Each row of ``refusals/*.toml`` is refused in one message at its line, which names what is wrong."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from pathlib import Path

import pytest

from playground import cli
from playground.engine.engine import Engine
from playground.errors import PlaygroundError, ShaderError
from playground.shader.header import parse_kernel
from playground.shader.source import read_source

from .cases import each
from .loading import load
from .refusals import Row, rows
from .sketch.conftest import PASS, TAIL, Folder
from .sketch_texts import LIT_NOISE, SMALL_VIEW, passes

KERNEL = '#pragma kernel(output = "height:r32f")\n'


def assert_refused(act: Callable[[], object], row: Row, file: str, line: int | None) -> PlaygroundError:
    """Assert that an act is refused as a row says, at a line of a file."""
    with pytest.raises(PlaygroundError) as caught:
        act()
    first = caught.value.diagnostics[0]
    assert row["names"] in first.message and "\n" not in first.message, first
    assert Path(first.file).name == file and first.line == (first.line if line is None else line), first
    return caught.value


@each("row", rows("sketch"), ids=lambda row: row["names"])
def test_a_mistake_in_a_sketch_is_refused_at_its_line(row: Row, tmp_path: Path) -> None:
    folder = Folder(tmp_path / "mine")
    head = row.get("head", f"format = 1\n{row.get('top', '')}\n" if "top" in row else "format = 1\n")
    body = row.get("body", PASS + (f"{row['pass']}\n" if "pass" in row else ""))
    tail = row.get("tail", TAIL + (f"{row['view']}\n" if "view" in row else ""))
    file = "s.toml"
    if "technique" in row:
        body, file = PASS.replace("terrain", "t"), "t.toml"
        folder.write(file, row["technique"])
    assert_refused(lambda: folder.sketch(body, tail, head), row, file, row.get("line"))


@each("row", rows("kernel"), ids=lambda row: row["names"])
def test_a_mistake_in_a_kernel_is_refused_at_its_line(row: Row, tmp_path: Path) -> None:
    texts = []
    if "pragma" in row:
        texts = [(f"{row['pragma']}\n", 1), (f"// first\n{row['pragma']}\n", 2)]
    elif "code" in row:
        texts = [(f"{KERNEL}float f;\n{row['code']}\n", 3)]
    elif "shared" in row:
        (tmp_path / "shared.glsl").write_text(row["shared"], "utf-8")
        texts = [(f'{KERNEL}\n#include "shared.glsl"\n', row["line"])]
    else:
        texts = [(row["text"], row["line"])]
    for text, line in texts:
        (tmp_path / "k.glsl").write_text(text, "utf-8")
        file = "shared.glsl" if "shared" in row else "k.glsl"
        error = assert_refused(
            lambda: parse_kernel("k", read_source(tmp_path / "k.glsl", (tmp_path,))), row, file, line
        )
        first = error.diagnostics[0]
        assert isinstance(error, ShaderError)
        if "shared" in row:
            assert [Path(position).name for position in first.chain] == ["k.glsl:3"]
        else:
            assert first.excerpt == text.split("\n")[line - 1]


SLOPE = """// rise.glsl -- a slope that rises to the north.
#pragma kernel(output = "height:r32f")
uniform float rise = 1.0;  //! slider(0, 4) How high the northern edge is
float kernel(ivec2 texel) { return rise * float(texel.y) / float(size.y - 1); }
"""
COLOUR = '#pragma kernel(output = "colour:rgba16f")\nvec4 kernel(ivec2 texel) { return vec4(0.5); }\n'
RISE = f"""format = 1
size = 17
{passes(height="./rise", colour="./wave")}[view]
use = "view/terrain"
[[preset]]
name = "half"
set = {{ "height.rise" = 0.5 }}
[[shot]]
name = "quarter"
set = {{ "height.rise" = 0.25 }}
"""
FILM = f"""format = 1
size = 33
{LIT_NOISE}{SMALL_VIEW}[[keyframe]]
time = 0.5
set = {{ "light.gain" = 2.0 }}
"""
COMPUTE = """#version 430
layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba16f, binding = 0) uniform writeonly image2D picture;
void main() { imageStore(picture, ivec2(gl_GlobalInvocationID.xy), vec4(1.0)); }
"""
FILES = {"note.txt": "a note", "terrain.toml": FILM, "all.comp": COMPUTE, "rise/sketch.toml": RISE}
FILES |= {
    "rise/rise.glsl": SLOPE,
    "rise/wave.glsl": COLOUR,
    "rise/flat.glsl": SLOPE.replace("rise *", "0.0 *"),
}


@pytest.mark.parametrize("row", rows("command"), ids=lambda row: row["command"])
def test_a_mistake_in_a_command_is_one_line_and_status_2(
    row: Row, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    for folder in ("empty", "rise"):
        (tmp_path / folder).mkdir()
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    before = sorted(tmp_path.rglob("*"))
    assert cli.main(shlex.split(row["command"])) == 2
    out, error = capfd.readouterr()
    assert out == "" and error.startswith("error: ") and row["names"] in error
    assert len(error.splitlines()) == 1 and sorted(tmp_path.rglob("*")) == before


@each("row", rows("drawn"), ids=lambda row: row["names"])
def test_a_mistake_in_what_is_drawn_is_refused(any_engine: Engine, row: Row, tmp_path: Path) -> None:
    (tmp_path / "one.glsl").write_text(row["kernel"], "utf-8")
    (tmp_path / "sketch.toml").write_text(f"format = 1\nsize = 17\n{passes(a='./one')}", "utf-8")
    assert_refused(lambda: any_engine.read(load(tmp_path), "a"), row, "one.glsl", row.get("line"))
