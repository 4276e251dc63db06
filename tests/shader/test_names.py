"""What is guessed of a name that no driver knows: on this machine's compiler, and on the words of others."""

from __future__ import annotations

from pathlib import Path

import moderngl
import pytest

from playground.engine.programs import compile_library, compile_wrapped, warnings_of
from playground.errors import PlaygroundError
from playground.paths import GLSL
from playground.shader.complaints import explain
from playground.shader.driver_log import guess, hint, library
from playground.shader.reserved_names import GIVEN
from playground.shader.source import read_source
from playground.shader.wrap import FRAGMENT, wrap
from playground.sketch.load import load
from playground.sketch.model import Kernel, kernels_of
from playground.sketch.techniques import read_kernel

HEAD = """// k.glsl -- a kernel
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high
"""
BODY = "float kernel(ivec2 texel) {{\n    {}\n}}\n"


def read(folder: Path, text: str) -> Kernel:
    (folder / "k.glsl").write_text(HEAD + text, encoding="utf-8")
    kernel = read_kernel(folder / "k.glsl", folder)
    assert kernel is not None
    return kernel


def complaint(ctx: moderngl.Context, folder: Path, text: str) -> str:
    """Return the first message for a text that does not compile."""
    with pytest.raises(PlaygroundError) as caught:
        compile_wrapped(ctx, wrap(read(folder, text), FRAGMENT))
    return caught.value.diagnostics[0].message


HILLS = "float hills(vec2 p) { return p.x; }\n"
MISTAKES = {
    "a `;` is missing": ("float a = 1.0\n    return a;", "A `;` is missing"),
    "a function's float into an int": ("int a = floor(2.5); return float(a);", "Whole and decimal numbers"),
    "a parameter misspelt": ("return levle;", "did you mean `level`?"),
    "a given name misspelt": ("return tiem;", "did you mean `time`?"),
    "a built-in misspelt": ("return smothstep(0.0, 1.0, 0.5);", "did you mean `smoothstep`?"),
    "another case": ("return Level;", "did you mean `level`?"),
    "HLSL's function": ("return lerp(0.0, 1.0, 0.5);", "its name for that is `mix`"),
    "HLSL's type": ("float3 a = float3(1.0); return a.x;", "its name for that is `vec3`"),
    "HLSL's saturate": ("return saturate(2.0);", "clamp(x, 0.0, 1.0)"),
    "a plain shader's time": ("return iTime;", "a kernel is given `time`"),
    "a cast of C": ("return (float)texel.x;", "write float(...)"),
    "a uniform is written": ("level = 2.0; return level;", "copy it into a local variable first"),
    "sizes": ("vec3 a = vec2(1.0); return a.x;", "differ in size"),
    "a constructor": ("vec3 a = vec3(1.0, 2.0); return a.x;", "too few components"),
    "% of floats": ("return 3.5 % 2.0;", "write `mod(a, b)` for floats"),
    "a reserved word": ("float filter = 1.0; return filter;", "`filter` is a reserved word"),
    "declared twice": ("float a = 1.0; float a = 2.0; return a;", "This name is taken"),
    "a number for a condition": ("if (level) return 1.0; return 0.0;", "A condition is a bool"),
    "an array of C": ("float a[2] = {1.0, 2.0}; return a[0];", "Braces do not fill an array"),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_a_common_mistake_is_explained(ctx: moderngl.Context, tmp_path: Path, name: str) -> None:
    if "llvmpipe" not in ctx.info["GL_RENDERER"]:
        pytest.skip("each driver takes other mistakes for one")
    line, part = MISTAKES[name]
    assert part in complaint(ctx, tmp_path, BODY.format(line))


def test_mistakes_outside_a_function_are_explained(ctx: moderngl.Context, tmp_path: Path) -> None:
    if "llvmpipe" not in ctx.info["GL_RENDERER"]:
        pytest.skip("each driver takes other mistakes for one")
    late = BODY.format("return hills(vec2(texel));") + HILLS
    assert "k.glsl:7: GLSL reads from above, so move it up" in complaint(ctx, tmp_path, late)
    near = HILLS + BODY.format("return hils(vec2(texel));")
    assert "did you mean `hills`?" in complaint(ctx, tmp_path, near)
    assert "did you mean `float`?" in complaint(ctx, tmp_path, "flaot f;\n" + BODY.format("return 0.0;"))
    unclosed = complaint(ctx, tmp_path, "float kernel(ivec2 texel) {\n    return 1.0;\n")
    assert "is a bracket unclosed?" in unclosed and "`;` is missing" not in unclosed
    around = "float f(float x) { return f(x); }\n" + BODY.format("return f(1.0);")
    assert "GLSL has no recursion" in complaint(ctx, tmp_path, around)
    without = "float f(float x) { float y = x; }\n" + BODY.format("return f(1.0);")
    assert "end in `return`" in complaint(ctx, tmp_path, without)


def test_a_function_of_the_library_is_reported_with_its_file(ctx: moderngl.Context, tmp_path: Path) -> None:
    name, files = next((name, files) for name, files in library().items() if len(files) == 1)
    text = complaint(ctx, tmp_path, BODY.format(f"return {name}();"))
    assert f'add `#include "{files[0]}"`' in text
    assert (GLSL / files[0]).is_file()
    (tmp_path / "k.glsl").write_text(HEAD + f'#include "{files[0]}"\n' + BODY.format("return 0.0;"))
    assert read_kernel(tmp_path / "k.glsl", tmp_path) is not None, "the include works as suggested"


# The wording of each: tests/shader/test_logs.py has whole logs of these drivers.
@pytest.mark.parametrize(
    "message",
    [
        "`levle' undeclared",  # Mesa
        'undefined variable "levle" (C1503)',  # NVIDIA
        "'levle' : undeclared identifier",  # AMD, Intel, ANGLE
        "Undeclared identifier: levle",  # AMD, older
        "Use of undeclared identifier 'levle'",  # Apple
    ],
)
def test_every_driver_s_wording_is_understood(tmp_path: Path, message: str) -> None:
    kernel = read(tmp_path, BODY.format("return levle;"))
    line = next(line for line in kernel.source.lines if "levle" in line.code)
    assert guess(message, kernel.source, line) == "`levle` is not declared; did you mean `level`?"


@pytest.mark.parametrize(
    "message",
    [
        'operands to "%" must be integral (C1021)',  # NVIDIA: gfx-rs/naga#1266
        "'%' : wrong operand types - no operation '%' exists that takes a left-hand operand of type "
        "'highp 3-component vector of float' and a right operand of type 'const 3-component vector of float' "
        "(or there is no acceptable conversion)",  # ANGLE: gfx-rs/naga#1451
    ],
)
def test_a_remainder_of_floats_on_other_drivers(message: str) -> None:
    assert hint(message) == "`%` is for whole numbers: write `mod(a, b)` for floats."


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("return zyxwv;", "`zyxwv' undeclared"),  # nothing is like it
        ("return leve1 + ab;", "`ab' undeclared"),  # too short
        ("return sin(1, 2);", "'sin' : no matching overloaded function found"),  # known, used wrongly
        ("return heat1 + heat3;", "`heat3' undeclared"),  # two are as near
        ("return level;", "syntax error, unexpected RETURN, expecting ',' or ';'"),
        ("return level;", "`return' with wrong type int, in function `kernel' returning float"),
    ],
)
def test_nothing_is_guessed_where_nothing_is_sure(tmp_path: Path, line: str, message: str) -> None:
    text = "const float heat1 = 1.0;\nconst float heat2 = 2.0;\n" + BODY.format(line)
    kernel = read(tmp_path, text)
    position = next(ln for ln in kernel.source.lines if line in ln.code)
    assert guess(message, kernel.source, position) == ""


def test_driver_warning_is_reported_at_kernel_line(ctx: moderngl.Context, tmp_path: Path) -> None:
    if "llvmpipe" not in ctx.info["GL_RENDERER"]:
        pytest.skip("each driver warns of other things")
    wrapped = wrap(read(tmp_path, BODY.format("float a; return a;")), FRAGMENT)
    compile_wrapped(ctx, wrapped).release()
    for _ in range(2):  # a text that is in the driver's cache by now is reported all the same
        (result,) = warnings_of(ctx, wrapped)
        assert (result.severity, result.line, result.column) == ("warning", 5, 21)
        assert "`a' used uninitialized" in result.message and result.file.endswith("k.glsl")
    assert warnings_of(ctx, wrap(read(tmp_path, BODY.format("return level;")), FRAGMENT)) == ()
    assert warnings_of(ctx, wrap(read(tmp_path, BODY.format("return leve;")), FRAGMENT)) == ()
    assert ctx.error == "GL_NO_ERROR"


@pytest.mark.room("dialects")
def test_a_driver_s_warning_of_no_value_is_none_where_it_is_zero(
    ctx: moderngl.Context, tmp_path: Path
) -> None:
    kernel = foreign(tmp_path, TOY.format("vec4(0.0); float a; c.x = a"))
    assert warnings_of(ctx, wrap(kernel, FRAGMENT, 450)) == ()


# ── one error a name, and nothing that follows from it ───────────────────────


def errors(ctx: moderngl.Context, kernel: Kernel) -> list[tuple[int, int, str]]:
    """Return line, column and message of each error of a text that does not compile."""
    with pytest.raises(PlaygroundError) as caught:
        compile_wrapped(ctx, wrap(kernel, FRAGMENT, 450))
    return [(d.line, d.column, d.message) for d in caught.value.diagnostics]


def foreign(folder: Path, text: str, name: str = "a.frag") -> Kernel:
    """Return the kernel of another tool's shader."""
    (folder / name).write_text(text, encoding="utf-8")
    technique = load(folder / name).graph.find("view").technique
    return next(kernel for _, kernel in kernels_of(technique))


AROUND = """void mainImage(out vec4 c, in vec2 p) {{
    vec2 uv = p / iResolution.xy;
    c = texture(
        {0}, uv) * 2.0 + vec4({0}, 1.0);
    c += {0};
    vec3 q = vec2(1.0);
}}
"""


@pytest.mark.room("dialects")
def test_a_name_is_one_error_and_other_mistakes_stay(ctx: moderngl.Context, tmp_path: Path) -> None:
    if "llvmpipe" not in ctx.info["GL_RENDERER"]:
        pytest.skip("each driver finds other mistakes")
    result = errors(ctx, foreign(tmp_path, AROUND.format("iChanel0")))
    assert [(line, column) for line, column, _ in result] == [(4, 9), (6, 5)]
    assert "did you mean `iChannel0`?" in result[0][2]


@pytest.mark.room("dialects")
def test_the_forms_of_a_function_are_the_few_nearest(ctx: moderngl.Context, tmp_path: Path) -> None:
    if "llvmpipe" not in ctx.info["GL_RENDERER"]:
        pytest.skip("each driver lists them otherwise")
    ((_, _, message),) = errors(ctx, foreign(tmp_path, TOY.format("texture(iChannel0, 1)")))
    assert len(message.split("\n")) == 5 and "vec4 texture(sampler2D, vec2" in message
    two = "float f(vec2 a) { return 1.0; }\nfloat f(vec3 a) { return 1.0; }\n"
    ((_, _, message),) = errors(ctx, foreign(tmp_path, two + TOY.format("vec4(f(mat2(1.0)))")))
    assert "float f(vec2)" in message and "float f(vec3)" in message and "more" not in message


TOY = "void mainImage(out vec4 c, in vec2 p) {{ c = {}; }}\n"
LOGS = {
    "NVIDIA": '0({0}) : error C1503: undefined variable "iChanel0"\n'
    '0({0}) : error C1115: unable to find compatible overloaded function "texture(error, vec2)"\n'
    '0({1}) : error C1503: undefined variable "iChanel0"\n0({1}) : error C7011: odd\n',
    "ANGLE": "ERROR: 0:{0}: 'iChanel0' : undeclared identifier\n"
    "ERROR: 0:{0}: 'texture' : no matching overloaded function found\n"
    "ERROR: 0:{0}: 'assign' : cannot convert from 'const float' to 'FragColor 4-component vector of float'\n"
    "ERROR: 0:{1}: 'iChanel0' : undeclared identifier\nERROR: 0:{1}: 'x' : odd\n",
    "Apple": "ERROR: 0:{0}: Use of undeclared identifier 'iChanel0'\n"
    "ERROR: 0:{1}: Use of undeclared identifier 'iChanel0'\nERROR: 0:{1}: odd\n",
}


@pytest.mark.parametrize("name", LOGS)
@pytest.mark.room("dialects")
def test_other_drivers_errors_are_folded_too(tmp_path: Path, name: str) -> None:
    text = "void mainImage(out vec4 c, in vec2 p) {\n    c = texture(iChanel0, p);\n    c += iChanel0;\n}\n"
    wrapped = wrap(foreign(tmp_path, text), FRAGMENT, 450)
    first = wrapped.stages["fragment"].first
    log = LOGS[name].format(first + 1, first + 2)
    diagnostics = explain(f"GLSL Compiler failed\n\nfragment_shader\n======\n{log}", wrapped).diagnostics
    assert [(d.line, "iChannel0" in d.message) for d in diagnostics] == [(2, True), (3, False)]


# ── names by dialect ─────────────────────────────────────────────────────────

ISF = '/*{{"INPUTS": [{{"NAME": "inputImage", "TYPE": "image"}}, {{"NAME": "level", "TYPE": "float"}}]}}*/\n'
ISF += "void main() {{ gl_FragColor = vec4({}); }}\n"
VSCODE = f'#iChannel0 "self"\n{TOY}'
SANDBOX = "void main() {{ gl_FragColor = vec4({}) * u_time; }}\n"
PLAIN = "#version 330\nout vec4 c;\nvoid main() {{ c = vec4({}); }}\n"
SUGGESTED = {
    ("a.frag", TOY): {
        "texture(iChanel0, p)": "did you mean `iChannel0`?",
        "vec4(iResoluton, 1)": "did you mean `iResolution`?",
        "vec4(itime)": "did you mean `iTime`?",
        "vec4(time)": "`iTime` is the same",
        "vec4(TIME)": "`iTime` is the same",
        "u_mouse.xyxy": "`iMouse` is the same",
        "vec4(size, 0, 1)": "`iResolution` is the same",
        "vec4(spacing, 0, 1)": "`spacing` is given to kernels",
        "vec4(RENDERSIZE, 0, 1)": "`iResolution` is the same",
    },
    ("v.frag", VSCODE): {"iMouseButon": "did you mean `iMouseButton`?"},
    ("i.fs", ISF): {
        "RENDERSIZ, 0, 1": "did you mean `RENDERSIZE`?",
        "iTime": "`TIME` is the same",
        "iFrame": "`FRAMEINDEX` is the same",
        "levl": "did you mean `level`?",
        "isf_FragNormCord, 0, 1": "did you mean `isf_FragNormCoord`?",
        "IMG_NORM_PIXEL(inputImge, vec2(0))": "did you mean `inputImage`?",
        "IMG_NORM_PIXL(inputImage, vec2(0))": "did you mean `IMG_NORM_PIXEL`?",
    },
    ("s.frag", SANDBOX): {
        "u_resoluton, 0, 1": "did you mean `u_resolution`?",
        "TIME": "is the same",
        "base_elevation": "`base_elevation` is given to kernels",
    },
    ("p.frag", PLAIN): {
        "iTime": "add `uniform float iTime;` above",
        "u_resolution, 0, 1": "add `uniform vec2 u_resolution;` above",
        "relief": "`relief` is given to kernels",
    },
}


@pytest.mark.parametrize("text", SUGGESTED, ids=lambda text: text[0])
@pytest.mark.room("dialects")
def test_a_suggestion_is_a_name_of_the_shader_s_tool(
    ctx: moderngl.Context, tmp_path: Path, text: tuple[str, str]
) -> None:
    for wrong, part in SUGGESTED[text].items():
        kernel = foreign(tmp_path, text[1].format(wrong), text[0])
        assert part in errors(ctx, kernel)[0][2], wrong


@pytest.mark.parametrize("name", GIVEN)
def test_no_name_is_suggested_for_itself(ctx: moderngl.Context, tmp_path: Path, name: str) -> None:
    library_file = tmp_path / "part.glsl"
    library_file.write_text(f"float f() {{ return float({name}); }}\n", encoding="utf-8")
    with pytest.raises(PlaygroundError) as caught:
        compile_library(ctx, read_source(library_file, (tmp_path,)))
    assert f"`{name}` is given to kernels" in caught.value.diagnostics[0].message
    assert len(caught.value.diagnostics) == 1


def test_a_name_of_another_place_is_said_to_be_there(ctx: moderngl.Context, tmp_path: Path) -> None:
    other = "float f() { float inner = 1.0; return inner; }\n"
    assert "`inner` is declared at" in complaint(ctx, tmp_path, other + BODY.format("return inner;"))
    loop = BODY.format("for (int i = 0; i < 2; i++) {} return float(i);")
    assert "k.glsl:5, in a block or a function" in complaint(ctx, tmp_path, loop)
    late = BODY.format("return later;") + "float later = 1.0;\n"
    assert "k.glsl:7: GLSL reads from above, so move it up" in complaint(ctx, tmp_path, late)
