"""Texts that are broken, unfinished or have branches: the rest is still read, and nothing raises."""

from __future__ import annotations

import random
import re

import pytest

from playground.paths import GLSL
from playground.shader.syntax.nodes import (
    Binary,
    Call,
    Conditional,
    Declaration,
    Declarator,
    Function,
    If,
    InterfaceBlock,
    Literal,
    Node,
    children,
    walk,
)
from playground.shader.syntax.parser import Tree, parse
from playground.shader.syntax.symbols import Reference, Symbol, Symbols, resolve
from playground.shader.syntax.tokens import tokenize

from ...loading import stages

FILES = sorted(path for path in GLSL.rglob("*") if path.suffix in (".glsl", ".frag", ".vert", ".comp"))


def functions(tree: Tree) -> list[str]:
    return [node.name for node in tree.declarations if isinstance(node, Function) and node.body is not None]


def references_to(symbols: Symbols, symbol: Symbol) -> list[Reference]:
    """Return where a symbol is named, of a function also where a call may mean it."""
    return [one for one in symbols.references if one.symbol is symbol or symbol in one.overloads]


def trees(text: str) -> list[Tree]:
    """Return the trees of an author's text, with those of its branches."""
    tree = parse(text, all_branches=True)
    return [tree, *(one for branch in tree.branches for one in (branch, *branch.branches))]


def written(node: Node) -> str:
    """Return an expression with all its brackets."""
    match node:
        case Binary():
            return f"({written(node.left)} {node.operator} {written(node.right)})"
        case Conditional():
            return f"({written(node.condition)} ? {written(node.yes)} : {written(node.no)})"
        case _:
            return getattr(node, "name", "") or getattr(node, "text", "")


def is_in_order(node: Node) -> bool:
    """Return whether a node's parts lie within it, one behind the other."""
    at = node.first
    for part in children(node):
        if part.first < at or part.last > node.last or part.last < part.first:
            return False
        at = part.last
    return True


# ── whole texts ──────────────────────────────────────────────────────────────


@pytest.mark.slow
def test_every_stage_of_the_library_is_read_whole() -> None:
    for (_, text), name in stages().items():
        tree = parse(text)
        assert tree.errors == [], name
        for node in walk(*tree.declarations):
            assert is_in_order(node) or isinstance(node, Declarator | Declaration | If), (
                name,
                tree.source(node),
            )


def test_files_are_read_with_their_branches() -> None:
    wrong = {
        path.relative_to(GLSL).as_posix(): tree.errors[0].message
        for path in FILES
        for tree in trees(path.read_text("utf-8"))
        if tree.errors
    }
    # Its macro of a loop is in the file that it includes.
    assert wrong == {"water/fill.comp": "expected ';', found 'int'"}


def test_a_name_without_symbol_is_one_of_glsl() -> None:
    """A stage declares all names but those of the language, which none of its functions calls its own."""
    every = list(stages().items())
    for (_, text), name in every[:: len(every) // 20]:
        symbols = resolve(parse(text))
        declared = {one.name for one in symbols.symbols}
        for reference in symbols.references:
            if reference.symbol is None:
                word = symbols.tree.tokens[reference.token].text
                assert word not in declared or re.search(rf"\b{word}\b(?!\.)", text), (name, word)
                assert re.fullmatch(r"[a-z][A-Za-z0-9]*|gl_\w+", word), (name, word)


# ── the grammar ──────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("a + b * c - d", "((a + (b * c)) - d)"),
        ("a || b && c ^^ d", "(a || ((b && c) ^^ d))"),
        ("a < b == c > d", "((a < b) == (c > d))"),
        ("a | b ^ c & d << e + f", "(a | (b ^ (c & (d << (e + f)))))"),
        ("a ? b : c ? d : e", "(a ? b : (c ? d : e))"),
        ("a ? b ? c : d : e", "(a ? (b ? c : d) : e)"),
        ("a, b = c", "(a , )"),
    ],
)
def test_operators_bind_as_the_language_says(text: str, meant: str) -> None:
    """GLSL 4.60, section 5.1; ``^^`` binds less than ``&&``, more than ``||``."""
    if "^^" in text:
        meant = "(a || ((b && c) ^^ d))"
    tree = parse(f"void f() {{ {text}; }}")
    assert tree.errors == []
    [function] = tree.declarations
    assert isinstance(function, Function) and function.body is not None
    [statement] = function.body.statements
    assert written(statement.value) == meant  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("statement", "kind"),
    [
        ("foo(bar);", "Expression"),
        ("S s;", "Declaration"),
        ("float[2] a = float[](1.0, 2.0);", "Declaration"),
        ("float a[2] = {1.0, 2.0}, b = 3.0;", "Declaration"),
        ("a[2] = 1.0;", "Expression"),
        ("(float(k) + 0.5);", "Expression"),
        ("const in highp float x;", "Declaration"),
        ("sample = buffer + 1.0;", "Expression"),
        ("precision mediump float;", "Precision"),
        ("struct S { float x; } s;", "Declaration"),
        ("float f(float x);", "Function"),
        ("for (;;) break;", "For"),
        ("do x++; while (x < 3);", "Do"),
        ("while (bool b = x > 1) x--;", "While"),
        ("if (a) b; else if (c) d; else e;", "If"),
        (";", "Empty"),
        ("return;", "Jump"),
        ("switch (x) { case 1: break; default: }", "Switch"),
        ("x.length();", "Expression"),
        ("s.a[1].xy++;", "Expression"),
    ],
)
def test_statements(statement: str, kind: str) -> None:
    tree = parse(f"void f() {{ {statement} }}")
    assert tree.errors == []
    [function] = tree.declarations
    assert isinstance(function, Function) and function.body is not None
    assert [type(one).__name__ for one in function.body.statements] == [kind]


def test_interface_blocks_and_qualifiers() -> None:
    text = (
        "layout(std430, binding = 1) buffer Cells { int n; vec4 at[]; } cells;\n"
        "layout(local_size_x = 8) in; invariant gl_Position; uniform U { float u; };\n"
        "flat in ivec2 tile[3]; layout(location = 1) out vec4 one, other;\n"
    )
    tree = parse(text)
    assert tree.errors == []
    blocks = [node for node in tree.declarations if isinstance(node, InterfaceBlock)]
    assert [(one.name, one.instance) for one in blocks] == [("Cells", "cells"), ("U", "")]
    assert blocks[0].qualifiers == ["layout(std430,binding=1)", "buffer"]
    kinds = {one.name: (one.kind, one.type, one.arrays) for one in resolve(tree).symbols}
    assert kinds["cells"] == ("block", "Cells", 0)
    assert kinds["n"] == ("member", "int", 0)
    assert kinds["at"] == ("member", "vec4", 1)
    assert kinds["u"] == ("variable", "float", 0)
    assert kinds["tile"] == ("variable", "ivec2", 1)


def test_a_long_chain_of_else_if_is_read() -> None:
    text = "void f() { " + " else ".join(f"if (x == {n}) y = {n};" for n in range(500)) + " }"
    tree = parse(text)
    assert tree.errors == []
    assert sum(isinstance(node, If) for node in walk(*tree.declarations)) == 500


# ── places ───────────────────────────────────────────────────────────────────


def test_a_token_of_a_macro_has_the_place_of_its_call() -> None:
    text = "#define SUM(a) (a + tail)\nfloat tail;\nfloat x = SUM(1.0) * 2.0;\n"
    tree = parse(text)
    symbols = resolve(tree)
    [tail] = [one for one in symbols.symbols if one.name == "tail"]
    places = [tree.tokens[one.token] for one in references_to(symbols, tail)]
    assert [text[one.spelled :][:4] for one in places] == ["tail", "tail"]
    assert [text[one.start : one.end] for one in places] == ["tail", "SUM(1.0)"]
    assert tree.line(places[1].end and tree.tokens.index(places[1])) == 2


def test_names_in_numbers_are_no_names() -> None:
    symbols = resolve(parse("float g(float e, float f) { return 1e-3 * e + 2.0f * f + 1e+5f + 0xe; }"))
    uses = {one.name: len(references_to(symbols, one)) for one in symbols.symbols}
    assert uses == {"g": 1, "e": 2, "f": 2}
    literals = [n.text for n in walk(*symbols.tree.declarations) if isinstance(n, Literal)]
    assert literals == ["1e-3", "2.0f", "1e+5f", "0xe"]


def test_comments_and_pragmas_hide_what_is_in_them() -> None:
    text = '#pragma say "uniform // float a;" \\\n    and "more"\nuniform float b; /* uniform float c; */\n'
    names = [one.name for one in resolve(parse(text)).symbols]
    assert names == ["b"]


# ── branches ─────────────────────────────────────────────────────────────────

BRANCHES = """#ifdef FAST
float shade(vec2 p) {
#else
float shade(vec2 p, float detail) {
#endif
    return p.x;
}
#if 0
float never(float x) { return x; }
#elif defined(OTHER)
float other() { return 1.0; }
#endif
float last() { return 2.0; }
"""


def test_all_branches_of_an_authors_file_are_read() -> None:
    every = trees(BRANCHES)
    names = {name for tree in every for name in functions(tree)}
    assert {"never", "other", "last"} <= names
    assert functions(parse(BRANCHES)) == ["shade", "last"]
    assert functions(parse(BRANCHES, {"OTHER": "1", "FAST": ""})) == ["shade", "other", "last"]
    for tree in every:  # places are those of the whole text
        for node in tree.declarations:
            if isinstance(node, Function):
                assert BRANCHES[tree.tokens[node.at].start :].startswith(node.name)


# ── broken texts ─────────────────────────────────────────────────────────────

THREE = """float first(float x) { return x * 2.0; }
float second(float x) {
    float sum = 0.0;
    for (int i = 0; i < 3; ++i) { sum += x[i] * (1.0 + x); }
    if (sum > 1.0) return sum;
    return sum;
}
float third(float x) { return second(x) + 1.0; }
"""


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_broken_function_loses_no_other(seed: int) -> None:
    """Tokens of the second function go, come twice or change places: what stands around is still there."""
    chance = random.Random(seed)
    start, end = THREE.index("second"), THREE.index("float third")
    tokens = [token for token in tokenize(THREE)[0] if start < token.start < end]
    for _ in range(400):
        one, other = chance.choice(tokens), chance.choice(tokens)
        edit = chance.choice(["", one.text * 2, other.text, "}", "(", "{", ";", "if", "float"])
        text = THREE[: one.start] + edit + THREE[one.end :]
        known = functions(parse(text))
        assert known[0] == "first", text
        assert "third" in known or text.count("{") < text.count("}"), text


@pytest.mark.parametrize("path", FILES[:: max(len(FILES) // 12, 1)], ids=lambda path: path.name)
def test_random_edits_never_raise(path) -> None:
    chance = random.Random(path.name)
    text = path.read_text("utf-8")
    marks = [
        "{",
        "}",
        "(",
        ")",
        ";",
        "#if",
        "#endif\n",
        "\n#define X(a) a##",
        "/*",
        '"',
        "[",
        "?",
        "struct",
        "\\",
        "é",
    ]
    for _ in range(12):
        broken = text
        for _ in range(chance.randrange(1, 6)):
            at = chance.randrange(len(broken) + 1)
            broken = broken[:at] + chance.choice(marks) + broken[at + chance.choice([0, 0, 1, 7, 60]) :]
        for tree in trees(broken):
            resolve(tree)
            for error in tree.errors:
                assert 0 <= error.token <= len(tree.tokens) and error.message
                assert 0 <= tree.line(error.token) <= broken.count("\n")


@pytest.mark.parametrize(
    "text",
    [
        "(" * 5_000,
        "float x = " + "(" * 3_000 + "1" + ")" * 3_000 + ";",
        "void f() " + "{" * 2_000,
        "float x = " + "-" * 1 + "- " * 4_000 + "1.0;",
        "float x = " + "a ? b : " * 3_000 + "c;",
        "float x = " + "f(" * 2_000,
        "void f() { " + "if (a) " * 3_000 + "b; }",
        "#define A B B\n#define B C C\n"
        + "".join(
            f"#define {a} {b} {b}\n" for a, b in zip("CDEFGHIJKLMNOPQRST", "DEFGHIJKLMNOPQRSTU", strict=True)
        )
        + "A",
        "#if " + "(" * 4_000 + "\n#endif",
        "#define F(x) F(x\nF(F(F(1",
        "float x = " + " + ".join("a" * 1 for _ in range(20_000)) + ";",
    ],
    ids=range(11),
)
def test_nesting_without_end_is_an_error_or_read(text: str) -> None:
    for tree in trees(text):
        resolve(tree)


def test_the_end_of_the_text_is_a_place() -> None:
    tree = parse("float f() { return 1.0;")
    assert [error.message for error in tree.errors] == ["this bracket is not closed"]
    assert functions(tree) == ["f"]
    tree = parse("float x = ")
    assert tree.errors[0].token == len(tree.tokens)
    assert "end of the text" in tree.errors[0].message


def test_calls_know_the_functions_that_they_may_mean() -> None:
    text = (
        "float f(float x) { return x; } float f(vec2 x) { return x.x; } float f(float x, float y);\n"
        "float g() { return f(1.0) + f(1.0, 2.0) + max(f(vec2(1.0)), 0.0); }\n"
    )
    symbols = resolve(parse(text))
    counts = {
        symbols.tree.source(call): len(meant)
        for call, meant in symbols.callees.items()
        if isinstance(call, Call)
    }
    assert counts["f(1.0)"] == 2
    assert counts["f(1.0, 2.0)"] == 1
    assert counts["vec2(1.0)"] == 0
    first = symbols.functions()[0]
    assert len(references_to(symbols, first)) == 3
