"""What is guessed of a name that no driver knows: on this machine's compiler, and on the words of others."""

from __future__ import annotations

from pathlib import Path

import moderngl
import pytest

from playground.errors import PlaygroundError
from playground.gpu.driver_log import hint
from playground.gpu.driver_warnings import warnings_of
from playground.gpu.name_suggestions import guess, library
from playground.gpu.program import compile_wrapped
from playground.gpu.wrap import FRAGMENT, wrap
from playground.paths import GLSL
from playground.sketch.model import Kernel
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
    """Return what is said first of a text that does not compile."""
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
    assert read_kernel(tmp_path / "k.glsl", tmp_path) is not None, "the include works as it was told"


# The wording of each: tests/gpu/test_logs.py has whole logs of these drivers.
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
    place = next(ln for ln in kernel.source.lines if line in ln.code)
    assert guess(message, kernel.source, place) == ""


def test_what_a_driver_warns_of_is_reported_in_the_kernel_s_lines(
    ctx: moderngl.Context, tmp_path: Path
) -> None:
    if "llvmpipe" not in ctx.info["GL_RENDERER"]:
        pytest.skip("each driver warns of other things")
    wrapped = wrap(read(tmp_path, BODY.format("float a; return a;")), FRAGMENT)
    compile_wrapped(ctx, wrapped).release()
    for _ in range(2):  # a text that is in the driver's cache by now is told of all the same
        (found,) = warnings_of(ctx, wrapped)
        assert (found.severity, found.line, found.column) == ("warning", 5, 21)
        assert "`a' used uninitialized" in found.message and found.file.endswith("k.glsl")
    assert warnings_of(ctx, wrap(read(tmp_path, BODY.format("return level;")), FRAGMENT)) == ()
    assert warnings_of(ctx, wrap(read(tmp_path, BODY.format("return leve;")), FRAGMENT)) == ()
    assert ctx.error == "GL_NO_ERROR"
