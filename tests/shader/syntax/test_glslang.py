"""The syntax tree held to glslang's: the same symbols on the same lines, the same macros, no text refused.

glslang prints its tree with ``-i`` and what is behind its preprocessor with ``-E``.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from playground.shader.syntax.parser import parse
from playground.shader.syntax.preprocessor import preprocess
from playground.shader.syntax.symbols import Symbol, Symbols, resolve

from ...loading import stages

ENDINGS = {"vertex": "vert", "fragment": "frag", "compute": "comp"}
SYMBOL = re.compile(r"0:(\d+) +'(\w+)' \( ?(.*?)\)$", re.MULTILINE)
PARAMETERS = re.compile(r"Function Parameters: \n(?:0:\d+ +'\w+' .*\n)*")  # on the line of the last
ELEMENTS = re.compile(r"(?:un)?sized array of |\d+-element array of |implicitly-sized array of ")
STORAGE = {"temp": "local", "uniform": "uniform", "global": "variable", "const": "local"}
FEW = 12  # stages for every day


def glslang(folder: Path, kind: str, text: str, *options: str) -> str:
    """Return what glslang prints of a stage."""
    program = shutil.which("glslangValidator")
    if program is None:
        pytest.skip("needs glslangValidator, which is in the package glslang-tools of Debian and Ubuntu")
    file = folder / f"stage.{ENDINGS[kind]}"
    file.write_text(text, encoding="utf-8")
    ran = subprocess.run(
        [program, *options, str(file)], capture_output=True, text=True, timeout=60, check=False
    )
    assert ran.returncode == 0, ran.stdout
    return ran.stdout


def type_of(words: str) -> tuple[str, int]:
    """Return a type that glslang describes as GLSL writes it, and how many dimensions of an array it has."""
    words, arrays = ELEMENTS.subn("", re.sub(r"\{.*\}", "{", words))
    if "structure{" in words:
        return "struct", arrays
    if vector := re.search(r"(\d)-component vector of (\w+)", words):
        prefix = {"float": "", "int": "i", "uint": "u", "bool": "b"}[vector[2]]
        return f"{prefix}vec{vector[1]}", arrays
    if matrix := re.search(r"(\d)X(\d) matrix of float", words):
        return f"mat{matrix[1]}" if matrix[1] == matrix[2] else f"mat{matrix[1]}x{matrix[2]}", arrays
    return words.split()[-1], arrays


def written_type(symbol: Symbol, structs: set[str]) -> tuple[str, int]:
    return "struct" if symbol.type in structs else symbol.type, symbol.arrays


def assert_same_symbols(symbols: Symbols, printed: str, name: str) -> int:
    """Hold each symbol that glslang prints to the references of its line; return how many."""
    assert symbols.tree.errors == [], name
    structs = {one.name for one in symbols.symbols if one.kind == "struct"}
    ours: dict[tuple[int, str], set[tuple[str, str, int]]] = {}
    for one in symbols.references:
        if one.symbol is not None and one.symbol.kind not in ("function", "struct", "member"):
            key = symbols.tree.line(one.token) + 1, one.symbol.name
            kind = one.symbol.kind
            if kind == "variable" and {"in", "out"} & set(one.symbol.qualifiers):
                kind = "stage"
            ours.setdefault(key, set()).add((kind, *written_type(one.symbol, structs)))
    body = PARAMETERS.sub("", printed.split("Linker Objects")[0])
    count = 0
    for line, spelled, words in SYMBOL.findall(body):
        if spelled.startswith("gl_"):
            continue
        kinds = {kind for kind, *_ in ours.get((int(line), spelled), set())}
        types = {(of_type, arrays) for _, of_type, arrays in ours.get((int(line), spelled), set())}
        assert type_of(words) in types, (name, line, spelled, words, ours.get((int(line), spelled)))
        storage = words.replace("flat ", "").replace("smooth ", "").split()[0]
        if storage in ("in", "out", "inout"):
            assert kinds & {"parameter", "stage"}, (name, line, spelled, words)
        elif storage in ("temp", "uniform"):
            assert STORAGE[storage] in kinds, (name, line, spelled, words, kinds)
        count += 1
    return count


@pytest.mark.slow
def test_symbols_of_the_library_are_those_of_glslang(tmp_path: Path) -> None:
    every = stages()
    assert len(every) > 500
    total = sum(
        assert_same_symbols(resolve(parse(text)), glslang(tmp_path, kind, text, "-i"), name)
        for (kind, text), name in every.items()
    )
    assert total > 100_000


def test_symbols_of_some_stages_are_those_of_glslang(tmp_path: Path) -> None:
    every = list(stages().items())
    total = sum(
        assert_same_symbols(resolve(parse(text)), glslang(tmp_path, kind, text, "-i"), name)
        for (kind, text), name in every[:: len(every) // FEW]
    )
    assert total > 1_000


SHADOWS = """#version 330
uniform float a;
struct S { float a; vec2 b; };
out vec4 k;
float f(float a, int n) { return a + float(n); }
float f(vec2 a) { return a.x; }
void g(out ivec2 b, inout float a) { b = ivec2(a); a += float(b.x); }
float h(int n) {
    float sum = a;
    for (int a = 0; a < n; ++a) {
        sum += float(a);
        { uint sum = 1u; n += int(sum); }
        for (float n = 0.0; n < 2.0; n += 1.0)
            sum += n;
    }
    if (sum > 1.0) { ivec3 sum = ivec3(n); n = sum.x; }
    else bool(n);
    while (n > 3) { vec3 a = vec3(n); n -= int(a.x); }
    float a = a + sum;
    vec2 list[3] = vec2[](vec2(a), vec2(n), vec2(sum));
    mat2x3 m = mat2x3(a);
    return a + list[1].x + m[1].y;
}
void main() {
    S a = S(1.0, vec2(2.0));
    ivec2 b;
    float n = 3.0;
    g(b, n);
    switch (b.x) { case 0: float a = n; n = a; break; default: n = 2.0; }
    k = vec4(a.a, a.b, h(b.y) + f(a.b) + f(n, b.x));
}
"""


def test_scopes_are_those_of_glslang(tmp_path: Path) -> None:
    printed = glslang(tmp_path, "fragment", SHADOWS, "-i")
    assert assert_same_symbols(resolve(parse(SHADOWS)), printed, "scopes") > 50


def test_another_scope_is_noticed(tmp_path: Path) -> None:
    """What the comparison is worth: the tree of another text is refused."""
    printed = glslang(tmp_path, "fragment", SHADOWS, "-i")
    other = SHADOWS.replace("{ uint sum = 1u;", "{ int sum = 1u;")
    with pytest.raises(AssertionError):
        assert_same_symbols(resolve(parse(other)), printed, "another")


MACROS = """#version 430
#define ONE 1
#define TWO (ONE + ONE)
#define ADD(a, b) ((a) + (b))
#define TWICE(f, x) f(x, x)
#define NAME(a, b) a##b
#define EMPTY
#define NEXT ADD
#define LATE AFTER(1)
#define AFTER(x) x + LATE
#define LONG(x) x \\
    + x
#define FALLS(x) NAME(x, 1) + NAME(x, _y)
#if __VERSION__ >= 430 && !defined(GL_ES) && (1 << 3) == 010 && 7 / 2 == 3 && -7 % 4 == -3
int a = TWO + ADD(ADD(1, 2), TWICE(ADD, 3));
#elif 1
int wrong;
#else
int wrong2;
#endif
int NAME(b, 1) = NEXT (1, (2, 3)) EMPTY;
int c = LATE + AFTER + AFTER(AFTER(2));
int d = LONG(4) /* TWO */ + ADD /* in a call */ (1,
    2); // ADD(1, 2)
#undef ADD
int e = ADD(1, 2) + FALLS(x);
#ifndef ONE
int wrong3;
#else
#ifdef EMPTY
int f = ONE;
#endif
#endif
#if 0xFF == 255 || 0
int g = 1.0e-3 + .5f + 1.;
#endif
"""


def words(text: str) -> list[str]:
    """Return the tokens of a text that the preprocessor is done with."""
    return [token.text for token in preprocess(text).tokens]


def test_macros_and_conditions_are_those_of_glslang(tmp_path: Path) -> None:
    printed = glslang(tmp_path, "fragment", MACROS, "-E")
    assert words(MACROS) == words(re.sub(r"^#.*", "", printed, flags=re.MULTILINE))


@pytest.mark.slow
def test_the_library_behind_the_preprocessor_is_that_of_glslang(tmp_path: Path) -> None:
    for (kind, text), name in stages().items():
        if kind != "vertex" and "#define" in text:
            printed = glslang(tmp_path, kind, text, "-E")
            assert words(text) == words(re.sub(r"^#.*", "", printed, flags=re.MULTILINE)), name


def test_tokens_written_out_again_are_the_same_program(tmp_path: Path) -> None:
    every = [item for item in stages().items() if item[0][0] == "fragment"]
    for (kind, text), _ in every[:: len(every) // 4]:
        tree = parse(text)
        head = "\n".join(token.text for token in tree.preprocessed.directives if "define" not in token.text)
        again = head + "\n" + " ".join(token.text for token in tree.tokens)
        trees = [glslang(tmp_path, kind, one, "-i") for one in (text, again)]
        plain = [re.sub(r"^0:[\d?]+", "", one, flags=re.MULTILINE) for one in trees]
        assert plain[0] == plain[1]
