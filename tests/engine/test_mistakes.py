"""Every pass that does not compile is reported at once, each mistake once."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.engine.engine import Engine
from playground.engine.sandbox import Sandbox, TrySketch
from playground.engine.sandbox_handler import all_errors
from playground.errors import PlaygroundError, ShaderError, SketchError

from ..loading import load
from ..sketch_texts import passes

SKETCH = (
    "format = 1\nsize = 17\n"
    + passes(height="./first", other="./second", good="./third")
    + """[view]
use = "view/map"
[view.inputs]
shown = "height"
"""
)
KERNEL = """#include "both.glsl"
#pragma kernel(output = "{name}:r32f")
float kernel(ivec2 texel) {{ return {body}; }}
"""


def sketch_in(folder: Path, first: str, second: str, both: str = "0.0") -> Path:
    (folder / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    (folder / "both.glsl").write_text(f"float both() {{ return {both}; }}\n", encoding="utf-8")
    for name, output, body in (
        ("first", "height", first),
        ("second", "other", second),
        ("third", "good", "0.0"),
    ):
        (folder / f"{name}.glsl").write_text(KERNEL.format(name=output, body=body), encoding="utf-8")
    return folder / "sketch.toml"


def drawn(engine: Engine, path: Path) -> PlaygroundError:
    sketch = load(path)
    with pytest.raises(ShaderError) as caught:
        engine.draw(sketch, size=(32, 18))
    return all_errors(caught.value, engine, sketch, size=(32, 18))


def files(error: PlaygroundError) -> list[str]:
    return [Path(d.file).name for d in error.diagnostics if d.severity == "error"]


def test_two_passes_that_fail_are_both_reported_in_order(engine: Engine, tmp_path: Path) -> None:
    result = files(drawn(engine, sketch_in(tmp_path, "first_name", "second_name")))
    assert result[0] == "first.glsl" and set(result) == {"first.glsl", "second.glsl"}


def test_a_pass_that_the_picture_does_not_need_is_reported_too(engine: Engine, tmp_path: Path) -> None:
    sketch = load(sketch_in(tmp_path, "missing", "missing"))
    error = ShaderError("of another pass", file="elsewhere.glsl")
    reports = all_errors(error, engine, sketch, size=(32, 18))
    assert files(reports)[0] == "elsewhere.glsl" and set(files(reports)[1:]) == {"first.glsl", "second.glsl"}


def test_a_mistake_in_a_file_that_all_include_is_reported_once(engine: Engine, tmp_path: Path) -> None:
    diagnostics = drawn(engine, sketch_in(tmp_path, "both()", "both()", "missing_name")).diagnostics
    assert len({(d.file, d.line, d.column, d.message) for d in diagnostics}) == len(diagnostics)
    assert {Path(d.file).name for d in diagnostics} == {"both.glsl"}


def test_an_error_of_another_kind_comes_back_as_it_is(any_engine: Engine, tmp_path: Path) -> None:
    sketch = load(sketch_in(tmp_path, "0.0", "0.0"))
    error = SketchError("not a shader's")
    assert all_errors(error, any_engine, sketch, size=(32, 18)) is error


@pytest.mark.slow
def test_the_sandbox_reports_all(tmp_path: Path) -> None:
    sketch = load(sketch_in(tmp_path, "first_name", "second_name"))
    with Sandbox(limit_seconds=60.0) as sandbox:
        report = sandbox.run(TrySketch(sketch))
    assert report.error is not None
    assert set(files(report.error)) == {"first.glsl", "second.glsl"}


@pytest.mark.parametrize(
    ("character", "words"),
    [
        ("\u200b", "U+200B, ZERO WIDTH SPACE"),
        ("\u00a0", "U+00A0, NO-BREAK SPACE"),
        ("\u2013", "U+2013, EN DASH"),
    ],
)
@pytest.mark.room("dialects")
def test_a_character_that_glsl_has_not_is_named_as_it_is(any_engine, folder, character, words):
    body = f"    // \u00fc?\n    float a = 2.0{character} 1.0;\n c = vec4(a);"
    text = f"void mainImage(out vec4 c, in vec2 p) {{\n{body} }}\n"
    with pytest.raises(ShaderError) as caught:
        any_engine.render(load(folder.write("t.frag", text)), size=(8, 8))
    first = caught.value.diagnostics[0]
    assert (first.line, first.column) == (3, 18)
    assert words in first.message and "'?'" not in first.message


@pytest.mark.room("dialects")
def test_a_question_mark_of_the_author_s_own_stays_one(any_engine, folder):
    text = "void mainImage(out vec4 c, in vec2 p) {\n    float a = ? 1.0;  // \u00fc\n c = vec4(a); }\n"
    with pytest.raises(ShaderError) as caught:
        any_engine.render(load(folder.write("t.frag", text)), size=(8, 8))
    assert "U+" not in caught.value.diagnostics[0].message
