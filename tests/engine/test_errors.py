"""Every mistake in a shader is a message with its file, line and column, once, and all at once."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.engine.engine import Engine
from playground.engine.sandbox import Sandbox, TrySketch
from playground.engine.sandbox_handler import all_errors
from playground.errors import ContextError, PlaygroundError, ShaderError, SketchError

from ..loading import load
from ..sketch_texts import passes

GOOD = """#pragma kernel(output = "a:r32f")
float kernel(ivec2 texel) {
    return 1.0;
}
"""


def mistake(engine, folder, kernel: str, **files: str) -> ShaderError:
    for name, text in files.items():
        folder.write(f"{name}.glsl", text)
    with pytest.raises(ShaderError) as caught:
        engine.read(folder.one(kernel), "a")
    return caught.value


def test_a_driver_s_complaint_names_file_line_and_column(engine, folder):
    error = mistake(engine, folder, GOOD.replace("return 1.0;", "float x = 1.0;\n    return x + nonsense;"))
    first = error.diagnostics[0]
    assert first.file.endswith("one.glsl")
    assert (first.line, first.column) == (4, 16)
    assert "nonsense" in first.message
    assert first.excerpt == "    return x + nonsense;"


def test_a_complaint_inside_an_include_names_the_include(engine, folder):
    error = mistake(
        engine,
        folder,
        '\n#include "outer.glsl"\n' + GOOD.replace("1.0", "outer(1.0)"),
        outer='// one\n#include "deep/inner.glsl"\nfloat outer(float x) { return inner(x); }\n',
        **{"deep/inner": "// two\n// lines\nfloat inner(float x) { return x * wrong_name; }\n"},
    )
    first = error.diagnostics[0]
    assert first.file.endswith("deep/inner.glsl")
    assert first.line == 3
    assert first.column == 35
    assert len(first.chain) == 2
    assert first.chain[0].endswith("one.glsl:2")
    assert first.chain[1].endswith("outer.glsl:2")


def test_error_after_includes_has_correct_kernel_line(engine, folder):
    long = "\n".join(f"float f{i}() {{ return {i}.0; }}" for i in range(50)) + "\n"
    error = mistake(engine, folder, '#include "long.glsl"\n' + GOOD.replace("1.0", "f49() + bad"), long=long)
    assert error.diagnostics[0].file.endswith("one.glsl")
    assert error.diagnostics[0].line == 4


def test_several_mistakes_are_all_reported(engine, folder):
    error = mistake(
        engine, folder, GOOD.replace("return 1.0;", "float x = one_wrong;\n    return two_wrong;")
    )
    assert {3, 4} <= {d.line for d in error.diagnostics}


def test_words_that_change_nothing_are_allowed_in_a_signature(engine, folder):
    kernel = GOOD.replace("(ivec2 texel)", "( const in ivec2 texel )\n")
    assert engine.read(folder.one(kernel), "a")[0, 0] == 1.0


def test_previous_without_a_repeat(engine, folder):
    error = mistake(engine, folder, GOOD.replace("1.0", "previous(texel) + 1.0"))
    assert "give it a repeat" in error.diagnostics[0].message
    assert (error.diagnostics[0].line, error.diagnostics[0].column) == (3, 12)


@pytest.mark.parametrize(
    "text", [GOOD.rstrip().removesuffix("}"), GOOD.replace("return 1.0;", "if (true) {\n    return 1.0;")]
)
def test_unclosed_bracket_names_file_and_last_line(engine, folder, text):
    first = mistake(engine, folder, text).diagnostics[0]
    assert first.file.endswith("one.glsl")
    assert first.line >= 3
    assert "bracket" in first.message or "missing its partner" in first.message


def test_one_bracket_too_many(engine, folder):
    first = mistake(engine, folder, GOOD + "}\n").diagnostics[0]
    assert first.file.endswith("one.glsl")
    assert first.line == 5


def test_a_mistake_does_not_spoil_the_next_frame(engine, folder):
    mistake(engine, folder, GOOD.replace("1.0", "nonsense"))
    assert engine.read(folder.one(GOOD), "a")[0, 0] == 1.0
    mistake(engine, folder, GOOD.replace("1.0", "nonsense"))
    assert engine.ctx.error == "GL_NO_ERROR"


def test_a_texture_larger_than_the_driver_takes_is_a_sentence(any_engine, folder, monkeypatch):
    monkeypatch.setitem(any_engine.ctx.info, "GL_MAX_TEXTURE_SIZE", 1024)
    with pytest.raises(ContextError, match=r"2000 x 10 texels; this driver takes no more than 1024 a side"):
        any_engine.texture(folder.one(GOOD, size="size = [2000, 10]"), "a")


@pytest.mark.parametrize("size", [(0, 10), (10, 16385)])
def test_an_impossible_picture_is_a_sentence(any_engine, folder, size):
    with pytest.raises(PlaygroundError, match="1 to 16384 a side"):
        any_engine.render(folder.one(GOOD), size=size)


def test_an_unknown_texture_names_the_nearest(any_engine, folder):
    with pytest.raises(PlaygroundError, match=r"no pass 'aa' in sketch .*did you mean 'a'"):
        any_engine.texture(folder.one(GOOD), "aa")
    with pytest.raises(PlaygroundError, match="no output 'b'"):
        any_engine.texture(folder.one(GOOD), "a:b")


def test_steps_of_an_unknown_pass_are_a_sentence(any_engine, folder):
    with pytest.raises(PlaygroundError, match="no repeated pass 'b'"):
        any_engine.texture(folder.one(GOOD), "a", steps={"b": 1})


def test_an_engine_says_which_drivers_there_are(ctx):
    from playground.engine.engine import Engine

    with pytest.raises(ContextError, match="expected one of auto, fragment, compute"):
        Engine(ctx, driver="cuda")


def test_an_opengl_error_names_the_pass(any_engine, folder, monkeypatch):
    """An error that the driver reports when something new was made names the pass."""
    sketch = folder.one(GOOD)
    run = any_engine.runner.run

    def faulty(step, *arguments, **named):
        result = run(step, *arguments, **named)
        any_engine.ctx.enable_direct(0x1234)
        return result

    monkeypatch.setattr(any_engine.runner, "run", faulty)
    with pytest.raises(ContextError, match="pass 'a': OpenGL reports GL_INVALID_ENUM"):
        any_engine.texture(sketch, "a")


# ── Every pass that does not compile is reported at once, each mistake once ──


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
