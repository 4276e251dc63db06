"""Which inputs a text reads by ``texelFetch`` alone, and which of its fetches read one texel."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from playground.shader.sampler_reads import fetched_alone, fixed_texels, read_by_texels_alone
from playground.shader.source import SourceText, read_source
from playground.sketch.model import Input, TexelKernel

HEAD = """uniform sampler2D sun;
uniform sampler2D moon;
uniform sampler2D image;
"""
BOTH = {"sun", "moon"}


def cases(name: str) -> list[object]:
    """Return the texts of a file of ``reads``, each with the words after its title."""
    text = (Path(__file__).parent / "reads" / f"{name}.glsl").read_text("utf-8")
    parts = re.split(r"^//// (.*?):(.*)\n", text, flags=re.MULTILINE)[1:]
    titles, words, texts = parts[::3], parts[1::3], parts[2::3]
    return [
        pytest.param(t.strip("\n"), w.split(), id=i) for i, w, t in zip(titles, words, texts, strict=True)
    ]


def source_of(folder: Path, text: str) -> SourceText:
    (folder / "k.glsl").write_text(HEAD + text + "\n", encoding="utf-8")
    return read_source(folder / "k.glsl", (folder,))


@pytest.mark.parametrize(("marked", "expected"), cases("by_fetches"))
def test_what_is_read_by_fetches_alone(tmp_path: Path, marked: str, expected: list[str]):
    source = source_of(tmp_path, marked.replace("■", ""))
    inputs = tuple(Input(name) for name in sorted(BOTH))
    result = fetched_alone(TexelKernel("main", source, (), inputs=inputs))
    lines = [line.code for line in source.lines]
    for line, column in reversed(result.fetches):
        assert lines[line][column:].startswith("texelFetch")
        lines[line] = f"{lines[line][:column]}■{lines[line][column:]}"
    assert "\n".join(lines).split("//")[0].strip() == (HEAD + marked).split("//")[0].strip()
    assert result.inputs == set(expected)


@pytest.mark.parametrize(("text", "expected"), cases("fixed_texels"))
def test_fetches_of_one_texel_are_found_and_no_others(tmp_path: Path, text: str, expected: list[str]):
    source = source_of(tmp_path, text)
    result = fixed_texels(source)
    assert [word for item in result for word in (item.input, str(item.x), str(item.y))] == expected
    for item in result:
        written = source.lines[item.line].code[item.start : item.end]
        assert written.startswith("texelFetch") and written.endswith(")") and item.input in written


@pytest.mark.parametrize(("text", "expected"), cases("by_fixed_texels"))
def test_inputs_read_by_fixed_texels_alone(tmp_path: Path, text: str, expected: list[str]):
    assert read_by_texels_alone(source_of(tmp_path, text)) == set(expected)


@pytest.mark.parametrize(
    ("taken", "components"),
    [(".a", {3}), (" . gr", {0, 1}), (".xyz.zx", {0, 1, 2}), (".st", {0, 1}), ("", {0, 1, 2, 3})],
)
def test_what_a_text_takes_of_a_texel_is_noted(tmp_path: Path, taken: str, components: set[int]):
    text = f"vec4 kernel(ivec2 t) {{ return vec4(texelFetch(sun, ivec2(3), 0){taken}); }}"
    (result,) = fixed_texels(source_of(tmp_path, text))
    assert result.components == components
