"""The identifiers of a GLSL text, and what its functions declare."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import moderngl
import pytest

from playground.engine.programs import compile_wrapped
from playground.errors import PlaygroundError
from playground.paths import GLSL
from playground.shader.names import Syntax, syntax_of, words
from playground.shader.syntax.symbols import Symbol
from playground.shader.wrap import FRAGMENT, wrap
from playground.sketch.model import CpuSource
from playground.sketch.techniques import read_kernel

TEXT = """// A file. float no(int comment);
#ifndef GUARD
#define GUARD
#define TWICE(x) ((x) * 2.0)

struct March {
    vec2 start;  // where
    float far;
};

// How steep it is.
// Not how high.
float steep(vec2 slope, const in March march) {
    float first = slope.x, second[2] = float[2](slope.y, 0.0);
    for (int step = 0; step < 3; step++) { vec2 far = vec2(float(step)); first += far.x; }
    return first + second[0] /* + hidden */ + march.far;
}
float asked(vec2 place);
const float LEAST = 1e-6;
uniform vec3 tint = vec3(1.0);  //! colour
#endif
"""


def test_what_can_be_named_at_a_place_is_known() -> None:
    syntax = syntax_of(TEXT)
    inside = syntax.visible(TEXT.index("first += far"))
    assert [*inside] == ["slope", "march", "first", "second", "step", "far"]
    assert all(TEXT[syntax.place(symbol) :].startswith(name) for name, symbol in inside.items())
    assert [*syntax.visible(TEXT.index("return first"))] == ["slope", "march", "first", "second"]


def test_words_are_those_of_the_code() -> None:
    result = {word.text for word in words('#include "a/b.glsl"\n' + TEXT)}
    assert result >= {"steep", "TWICE", "march", "far"}
    assert not result & {"no", "comment", "hidden", "Not", "glsl", "colour"}


def test_letters_of_numbers_are_no_names() -> None:
    text = "float a = 1e-3 + 2.0f + 3.e5 + .5e3f + 0xFFu + 0Xe1 + 1u + 4.f - e; vec2 b = v1e3.xy * 1E+2;\n"
    assert [word.text for word in words(text)] == ["float", "a", "e", "vec2", "b", "v1e3", "xy"]


# ── every local of the library under another name ────────────────────────────

KERNELS = [path for path in sorted(GLSL.rglob("*.glsl")) if "sketches" not in path.parts]


def renamed(code: str) -> str:
    """Return a text in which each local and parameter has a name of its own, where that is free."""
    syntax = Syntax(code)
    places: dict[int, tuple[str, str]] = {}
    for number, symbol in enumerate(s for s in syntax.symbols.symbols if may_be_renamed(s)):
        occurrences = syntax.occurrences(symbol.name)
        own = {each.meaning for each in occurrences if each.at == syntax.place(symbol)}
        places |= {e.at: (symbol.name, f"fresh_{number}") for e in occurrences if e.meaning in own}
    for at in sorted(places, reverse=True):
        old, new = places[at]
        code = f"{code[:at]}{new}{code[at + len(old) :]}"
    return code


def may_be_renamed(symbol: Symbol) -> bool:
    name = symbol.function.name if symbol.function is not None else ""
    is_output = name == "kernel" and "out" in symbol.qualifiers
    is_local = symbol.kind == "local" or (symbol.kind == "parameter" and name not in ("vertex", "fragment"))
    return is_local and not is_output


@pytest.mark.slow
@pytest.mark.parametrize("path", KERNELS, ids=lambda path: path.relative_to(GLSL).as_posix())
def test_a_kernel_compiles_with_other_names_of_its_locals(ctx: moderngl.Context, path: Path) -> None:
    try:
        kernel = read_kernel(path, GLSL)
    except PlaygroundError:
        kernel = None
    if kernel is None or isinstance(kernel, CpuSource):
        return  # a library file: kernels include it
    lines = renamed(kernel.source.code).split("\n")[: len(kernel.source.lines)]
    compile_wrapped(ctx, wrap(replace(kernel, source=kernel.source.with_codes(lines)), FRAGMENT)).release()
