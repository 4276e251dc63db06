"""Logs of every driver become the same entries, and the commonest mistakes get a hint.

The files in `logs/` are real: Mesa's were made here, the others are quoted from the public
threads that their first line names.
"""

import random
import tomllib
from pathlib import Path

import moderngl
import pytest

from playground.shader.driver_log import LogEntry, hint, parse_log, source_column, split_moderngl

from ..cases import each

LOGS = Path(__file__).parent / "logs"


EXPECTED = tomllib.loads((LOGS / "entries.toml").read_text(encoding="utf-8"))
HINTS = tomllib.loads((LOGS / "hints.toml").read_text(encoding="utf-8"))


def error(line: int, message: str, column: int = 0) -> LogEntry:
    return LogEntry(line, column, "error", message)


def read(name: str) -> str:
    lines = (LOGS / f"{name}.txt").read_text(encoding="utf-8").splitlines(keepends=True)
    assert lines[0].startswith("# ")
    return "".join(lines[1:])


def test_every_fixture_is_expected() -> None:
    assert {path.stem for path in LOGS.glob("*.txt")} == EXPECTED.keys()


@each("name", EXPECTED)
def test_a_real_log_becomes_its_entries(name: str) -> None:
    """With any line ends, and with a zero at its end."""
    expected = EXPECTED[name].get("stage", ""), [LogEntry(*entry) for entry in EXPECTED[name]["entries"]]
    for text in (read(name), read(name).replace("\n", "\r\n") + "\0"):
        stage, log = split_moderngl(text)
        assert (stage, list(parse_log(log))) == expected


# ---- what must hold for any log ------------------------------------------------------------

WORDINGS = (
    "{source}:{line}(8): error: {what}",
    "{source}({line}) : error C1503: {what}",
    "{source}({line}) : warning C7050: {what}",
    "ERROR: {source}:{line}: {what}",
    "ERROR: {source}:{line}: error(#143) {what}",
    "WARNING: {source}:{line}: {what}",
    "kernel.frag:{line}: error: {what}",
    "{source}:{line}: L0002: {what}",
)


@pytest.mark.parametrize("wording", WORDINGS)
def test_line_numbers_survive_any_source_number(wording: str) -> None:
    lines = [1, 2, 9, 10, 255, 4096, 65_536, 1_234_567]
    log = "\n".join(
        wording.format(source=i % 4, line=line, what=f"'name{i}' : undeclared")
        for i, line in enumerate(lines)
    )
    entries = parse_log(log)
    assert [entry.line for entry in entries] == lines
    assert all(f"name{i}" in entry.message for i, entry in enumerate(entries))
    assert {entry.severity for entry in entries} == {"warning" if "warning" in wording.lower() else "error"}


# A quarter of the texts every day, for they are made by chance: the others are no different.
@pytest.mark.slow
@pytest.mark.parametrize("seed", [7, *(pytest.param(n, marks=pytest.mark.slow) for n in (107, 207, 307))])
def test_no_text_makes_the_reader_raise(seed: int) -> None:
    rng = random.Random(seed)
    pieces = [
        *"0123456789:(),.;'\"`#-= \t\n\r\0\x0b\x85\u2028\u0663é",
        "0:12(8): error:",
        "0(12) : error C1008:",
        "ERROR: 0:12:",
        "error(#143)",
        "error:",
        "warning:",
        " info",
        "candidates are:",
        "... ",
        "9" * 5000,
        "GLSL Compiler failed",
        "GLSL Linker failed",
        "\n====\n",
        "vertex_shader",
        "{0}",
        "}",
        "{",
        "undeclared",
        "syntax error",
        "no matching function for call to `f(int)'",
    ]
    for _ in range(750):
        text = "".join(rng.choices(pieces, k=rng.randrange(30)))
        _, log = split_moderngl(text)
        for entry in (*parse_log(text), *parse_log(log)):
            assert entry.line >= 0 and entry.column >= 0
            assert entry.severity in ("error", "warning")
            assert entry.message.strip()
            assert "\n" not in hint(entry.message)
        hint(text)


@pytest.mark.parametrize("text", ["", "\n", "  \r\n\0", "No errors.\n", "-----\n"])
def test_a_log_that_says_nothing_has_no_entries(text: str) -> None:
    assert parse_log(text) == ()


def test_a_log_that_is_not_understood_is_returned_whole() -> None:
    assert parse_log("the compiler is tired\ncome back tomorrow\n") == (
        error(0, "the compiler is tired\n    come back tomorrow"),
    )


def test_a_summary_alone_is_better_than_nothing() -> None:
    assert parse_log("ERROR: 1 compilation errors.  No code generated.\n") == (
        error(0, "1 compilation errors. No code generated."),
    )


def test_lines_of_assembly_are_not_lines_of_the_shader() -> None:
    log = (
        "Internal error: assembly compile error for vertex shader at offset 77:\n"
        "-- error message --\n"
        "line 12, column 3:  error: invalid operand\n"
        "-- internal assembly text --\n"
        "!!NVvp5.0\n0(3) : error C1008: not real\n"
    )
    assert [entry.line for entry in parse_log(log)] == [0, 0]
    assert "not real" not in str(parse_log(log))


def test_a_text_that_moderngl_did_not_wrap_has_no_stage() -> None:
    assert split_moderngl("0:3(1): error: `a' undeclared\n") == ("", "0:3(1): error: `a' undeclared")


@pytest.mark.parametrize(
    ("text", "stage"),
    [
        ("GLSL Compiler failed\n\nfragment_shader\n===============\n\n\n", "fragment"),
        ("GLSL Linker failed", "link"),
    ],
)
def test_a_driver_that_says_nothing_leaves_an_empty_log(text: str, stage: str) -> None:
    assert split_moderngl(text) == (stage, "")


@pytest.mark.parametrize(
    ("line", "column", "expected"),
    [
        ("zz;", 1, 1),
        ("    q = zz;", 6, 9),  # mesa: moderngl_vertex.txt
        ("\t\tq  =\tzz;", 6, 8),
        ("a  b", 2, 0),  # between the words there is nothing to point at
        ("ab", 3, 0),
        ("ab", 0, 0),
        ("", 1, 0),
    ],
)
def test_a_column_is_found_again_in_the_source(line: str, column: int, expected: int) -> None:
    assert source_column(line, column) == expected


# ---- hints ---------------------------------------------------------------------------------


@each(("part", "message"), [(part, message) for part, messages in HINTS.items() for message in messages])
def test_a_common_mistake_gets_its_hint(part: str, message: str) -> None:
    sentence = hint(message)
    assert part in sentence
    assert sentence.endswith(".") and "{" not in sentence.replace("`{`", "")


@pytest.mark.parametrize(
    "message",
    [
        "",
        "type mismatch",
        "#error hello world",
        "cannot construct `vec4' from a non-numeric data type",
        "value of type int cannot be assigned to variable of type error",
        "syntax error, unexpected ERROR_TOK, expecting ',' or ';'",
        "Too many fragment shader default uniform block components",
    ],
)
def test_there_is_no_hint_where_nothing_is_known(message: str) -> None:
    assert hint(message) == ""


# ---- the driver that is installed ------------------------------------------------------------

VERTEX = "#version 330\nin vec3 place;\nvoid main() {\n    gl_Position = vec4(place, 1.0);\n}\n"

# line of the mistake in the fragment shader, its body from line 6 on, part of the hint ("" for any)
BROKEN = [
    (7, "float a = 1.0;\na = tau;", "`tau` is not declared"),
    (7, "float a = 1.0\ncolour = vec4(a);", "`;` is missing"),
    (6, "vec3 v = vec4(1.0);", "differ in size"),
    (8, "\n\nfloat f = mod(7, ivec2(2));", "No form of `mod`"),
    (7, "vec3 v = vec3(1.0);\nv.xyzw = vec4(1.0);", "components do not exist"),
    (6, "scale = 2.0;", "cannot be written to"),
    (8, "float b;\n\nfloat b;", "name is taken"),
    (6, "colour = vec4(fbm(1.0));", "No function `fbm`"),
    (6, "colour = vec4(1.0, 2.0);", "too few components"),
    (6, "float filter = 1.0;", "`filter` is a reserved word"),
    (6, "colour = texture2D(1, vec2(0.0));", "`texture2D` is not in core GLSL"),
    (9, "// one\n/* two\n   three */\n#error stop", ""),
]


@pytest.fixture(scope="module")
def context() -> moderngl.Context:
    try:
        return moderngl.create_context(standalone=True, backend="egl", require=330)
    except Exception as problem:
        pytest.skip(f"no OpenGL through EGL here: {problem}")


def test_the_installed_driver_is_understood(context: moderngl.Context) -> None:
    mesa = "Mesa" in f"{context.info['GL_VERSION']} {context.info['GL_RENDERER']}"
    head = "#version 330\nuniform float scale;\nout vec4 colour;\n\nvoid main() {\n"
    for line, body, part in BROKEN:
        with pytest.raises(moderngl.Error) as caught:
            context.program(vertex_shader=VERTEX, fragment_shader=f"{head}{body}\n}}\n")
        stage, log = split_moderngl(str(caught.value))
        entries = parse_log(log)
        assert stage == "fragment", body
        assert line in [entry.line for entry in entries if entry.severity == "error"], f"{body}\n{log}"
        if mesa:  # other compilers may see another mistake first
            assert entries[0].line == line and part in hint(entries[0].message), f"{body}\n{log}"
    for text in ("zz;", "    zz;", "\t \tfloat  a =\t  zz  ;", "float a = 1.0;      a     =   zz;"):
        with pytest.raises(moderngl.Error) as caught:
            context.program(vertex_shader=VERTEX, fragment_shader=f"{head}{text}\n}}\n")
        first = parse_log(split_moderngl(str(caught.value))[1])[0]
        if first.column:
            assert text[source_column(text, first.column) - 1 :].startswith("zz"), text
    with pytest.raises(moderngl.Error) as caught:
        context.program(vertex_shader="#version 330\nvoid main() {\n    gl_Position = zz;\n}\n")
    stage, log = split_moderngl(str(caught.value))
    assert (stage, parse_log(log)[0].line) == ("vertex", 3)
    assert context.error == "GL_NO_ERROR"
