"""Logs of every driver become the same entries, and the commonest mistakes get a hint.

The files in `logs/` are real: Mesa's were made here, the others are quoted from the public
threads that their first line names.
"""

import random
from pathlib import Path

import moderngl
import pytest

from playground.shader.driver_log import LogEntry, hint, parse_log, source_column, split_moderngl

from ..cases import each

LOGS = Path(__file__).parent / "logs"


def error(line: int, message: str, column: int = 0) -> LogEntry:
    return LogEntry(line, column, "error", message)


def warning(line: int, message: str, column: int = 0) -> LogEntry:
    return LogEntry(line, column, "warning", message)


MOD = """\
float mod(float, float)
vec2 mod(vec2, float)
vec3 mod(vec3, float)
vec4 mod(vec4, float)
vec2 mod(vec2, vec2)
vec3 mod(vec3, vec3)
vec4 mod(vec4, vec4)
double mod(double, double)
dvec2 mod(dvec2, double)
dvec3 mod(dvec3, double)
dvec4 mod(dvec4, double)
dvec2 mod(dvec2, dvec2)
dvec3 mod(dvec3, dvec3)
dvec4 mod(dvec4, dvec4)""".replace("\n", "\n    ")

BOUND = "More than one varying out variable is bound to the same number"
TWO_STAGES = 'Symbol "iris_FogFragCoord" usage doesn\'t match between two stages'
UNCOMPILED = (
    "Fragment shader(s) were not successfully compiled before glLinkProgram() was called. Link failed."
)
NO_OVERLOAD = "no matching overloaded function found (using implicit conversion)"

# file: (stage that moderngl names, entries)
EXPECTED: dict[str, tuple[str, list[LogEntry]]] = {
    "moderngl_vertex": ("vertex", [error(5, "`zz' undeclared", 6)]),
    "moderngl_geometry": ("geometry", [error(4, "`foo' undeclared", 15)]),
    "moderngl_tess_control": ("tess_control", [error(3, "`foo' undeclared", 15)]),
    "moderngl_compute": (
        "compute",
        [
            error(3, "`foo' undeclared", 15),
            error(3, "value of type int cannot be assigned to variable of type error", 15),
        ],
    ),
    "moderngl_compute_link": (
        "link",
        [error(0, "compute shader must contain a fixed or a variable local group size")],
    ),
    "moderngl_link": (
        "link",
        [
            error(
                0,
                "vertex shader output `q' declared as type `vec3', "
                "but fragment shader input declared as type `vec4'",
            )
        ],
    ),
    "mesa_link_joined": (
        "link",
        [
            error(0, "count of uniform locations > MAX_UNIFORM_LOCATIONS(99999 > 81920)"),
            error(0, "Too many fragment shader default uniform block components"),
        ],
    ),
    "mesa_semicolon": ("", [error(8, "syntax error, unexpected IDENTIFIER, expecting ',' or ';'", 1)]),
    "mesa_candidates": (
        "",
        [
            error(7, f"no matching function for call to `mod(int, ivec2)'; candidates are:\n    {MOD}", 10),
            error(7, "cannot construct `vec4' from a non-numeric data type", 5),
            error(8, "initializer of type float cannot be assigned to variable of type int", 1),
        ],
    ),
    "mesa_preprocessor": (
        "",
        [
            error(8, "Illegal non-directive after #", 1),
            error(9, "#error hello world", 1),
            error(11, "macro A invoked with 2 arguments (expected 1)", 1),
        ],
    ),
    "mesa_warning": ("", [warning(8, "`a' used uninitialized", 10), error(9, "`zz' undeclared", 1)]),
    "mesa_recursion": (
        "",
        [
            error(0, "function `float f()' has static recursion"),
            error(0, "function `float g()' has static recursion"),
        ],
    ),
    "mesa_reserved": (
        "",
        [
            error(7, "illegal use of reserved word `filter'", 7),
            error(7, "syntax error, unexpected ERROR_TOK, expecting ',' or ';'", 7),
        ],
    ),
    "mesa_line_directive": (
        "",
        [
            error(7, "`nope' undeclared", 9),
            error(7, "could not implicitly convert return value to float, in function `f'", 2),
            error(100, "`nope2' undeclared", 20),
            error(100, "could not implicitly convert return value to float, in function `g'", 13),
            error(7, "`nope3' undeclared", 20),
            error(7, "could not implicitly convert return value to float, in function `h'", 13),
        ],
    ),
    "nvidia_undefined": ("", [error(n, 'undefined variable "iTime" (C1008)') for n in (99, 100, 116)]),
    "nvidia_repeated": ("", [error(430, 'undefined variable "worldDay" (C1503)')]),
    "nvidia_moderngl": ("fragment", [error(11, 'undefined variable "u_val0" (C1503)')]),
    "nvidia_sections": ("", [error(n, "lvalue in assignment too complex (C5025)") for n in (38, 102)]),
    "nvidia_fatal": (
        "",
        [
            error(17, "too little data in type constructor (C1067)"),
            error(0, "Can't convert to expr: 1, @TMP3 + 0.1f (C9999)"),
        ],
    ),
    "nvidia_ambiguous": (
        "",
        [
            error(
                6,
                'ambiguous overloaded function reference "smoothstep(float, float, int)" (C1101)\n'
                "    (0) : float64_t smoothstep(float64_t, float64_t, float64_t)\n"
                "    (0) : float smoothstep(float, float, float)",
            )
        ],
    ),
    "nvidia_versions": (
        "",
        [
            error(2, "unsupported version 330 (C0201)"),
            error(2, 'syntax error, unexpected \'(\', expecting "::" at token "("'),
            error(6, 'global type vec4 requires "#version 100" or later (C7532)'),
            error(
                8,
                'global type uint requires "#version 130" or later '
                "... or #extension GL_EXT_gpu_shader4 : enable (C7532)",
            ),
        ],
    ),
    "nvidia_warnings": (
        "",
        [
            warning(10, "extension EXT_shader_subgroup_extended_types_int16 not supported (C7508)"),
            error(293, 'swizzle mask element not present in operand "a" (C1031)'),
            error(293, "array index out of bounds (C1068)"),
        ],
    ),
    "nvidia_conflict": (
        "",
        [
            error(1835, 'declaration of "ndotv" conflicts with previous declaration at 0(1327) (C1038)'),
            error(1839, 'declaration of "f0" conflicts with previous declaration at 0(1328) (C1038)'),
        ],
    ),
    "nvidia_link": ("", [error(0, 'Block "_86" not declared as an output from the previous stage')]),
    "amd_undeclared": (
        "",
        [
            error(89, "Undeclared identifier: viewPos"),
            error(89, 'Vector field selection out of range "xyz"'),
        ],
    ),
    "amd_reserved": ("", [error(6, "Reserved word: output"), error(6, 'Syntax error: "output" parse error')]),
    "amd_link": ("", [error(0, BOUND), warning(0, TWO_STAGES)]),
    "amd_link_uncompiled": ("", [error(0, UNCOMPILED)]),
    "amd_new": (
        "",
        [
            error(25, "'str' : vector swizzle selectors not from the same set"),
            error(
                25,
                "'assign' : cannot convert from ' temp 2-component vector of float' "
                "to ' smooth out 3-component vector of float'",
            ),
        ],
    ),
    "intel_undeclared": (
        "",
        [
            error(121, "'tex00' : undeclared identifier"),
            error(121, f"'texture' : {NO_OVERLOAD}"),
            error(121, f"'process_texel' : {NO_OVERLOAD}"),
            error(
                121,
                "'assign' : cannot convert from 'const highp float' "
                "to 'inout 4-component vector of highp float'",
            ),
        ],
    ),
    "intel_link": (
        "",
        [
            error(
                0,
                "The \u2666 shader uses varying FragWorldPos, but previous shader does not write to it.\n"
                "    Out of resource error.",
            )
        ],
    ),
    "apple_undeclared": (
        "",
        [
            error(283, "'/' does not operate on 'int' and 'unsigned int'"),
            error(285, "Use of undeclared identifier 'uv'"),
            error(286, "Use of undeclared identifier 'uv'"),
        ],
    ),
    "apple_texture2d": (
        "",
        [
            error(8, "Invalid call of undeclared identifier 'texture2D'"),
            error(9, "Use of undeclared identifier 'col'"),
            error(9, "Use of undeclared identifier 'gl_FragColor'"),
        ],
    ),
    "apple_version": (
        "",
        [error(1, "#version required and missing."), error(27, "'varying' : syntax error")],
    ),
    "apple_link": ("", [error(0, "One or more attached shaders not successfully compiled")]),
    "angle_frontend": (
        "",
        [
            error(10, "'texture2D' : no matching overloaded function found"),
            error(10, "'=' : dimension mismatch"),
            error(
                10,
                "'assign' : cannot convert from 'const mediump float' "
                "to 'FragColor mediump 4-component vector of float'",
            ),
        ],
    ),
    "angle_direct3d": (
        "",
        [
            error(0, "undeclared identifier 'IncidentLight'"),
            warning(
                0,
                "D3D shader compilation failed with default flags. (vs_3_0)\n"
                "    Retrying with avoid flow control",
            ),
            error(0, "undeclared identifier 'webgl_45daf4aa877f103d'"),
        ],
    ),
    "mali_reserved": (
        "",
        [
            error(17, "Keyword 'sample' is reserved (L0003)"),
            error(18, "Expected literal or '(', got 'sample' (L0001)"),
            error(31, "Undeclared variable 'color' (L0002)"),
        ],
    ),
}


def read(name: str) -> str:
    lines = (LOGS / f"{name}.txt").read_text(encoding="utf-8").splitlines(keepends=True)
    assert lines[0].startswith("# ")
    return "".join(lines[1:])


def test_every_fixture_is_expected() -> None:
    assert {path.stem for path in LOGS.glob("*.txt")} == EXPECTED.keys()


@each("name", EXPECTED)
def test_a_real_log_becomes_its_entries(name: str) -> None:
    stage, log = split_moderngl(read(name))
    assert (stage, list(parse_log(log))) == EXPECTED[name]


@each("name", EXPECTED)
def test_line_endings_and_a_final_zero_change_nothing(name: str) -> None:
    text = read(name)
    stage, log = split_moderngl(text.replace("\n", "\r\n") + "\0")
    assert (stage, list(parse_log(log))) == EXPECTED[name]


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

# part of the sentence: messages of several vendors
HINTS: dict[str, list[str]] = {
    "`tau` is not declared": [
        "`tau' undeclared",
        'undefined variable "tau" (C1503)',
        "'tau' : undeclared identifier",
        "Undeclared identifier: tau",
        "Use of undeclared identifier 'tau'",
        "Undeclared variable 'tau' (L0002)",
    ],
    "`MAX_STEPS` is not declared": ["`MAX_STEPS' undeclared"],
    "`;` is missing": [
        "syntax error, unexpected IDENTIFIER, expecting ',' or ';'",
        "syntax error, unexpected '}', expecting ',' or ';'",
        "syntax error, unexpected RETURN, expecting ',' or ';'",
        "syntax error, unexpected identifier, expecting ',' or ';' at token \"o\"",
        "'o' : syntax error, unexpected IDENTIFIER, expecting COMMA or SEMICOLON",
    ],
    "missing `;`, comma or bracket": [
        'Syntax error: "return" parse error',
        "'=' : syntax error",
        'syntax error, unexpected \'(\', expecting "::" at token "("',
    ],
    "ends too soon": [
        "syntax error, unexpected end of file",
        'syntax error, unexpected $end, expecting "::" at token "<EOF>"',
    ],
    "one closing brace too many": ["syntax error, unexpected '}', expecting end of file"],
    "a type should be": ["syntax error, unexpected NEW_IDENTIFIER", "Use of undeclared type 'Geometry'"],
    "Whole and decimal numbers": [
        "initializer of type float cannot be assigned to variable of type int",
        "value of type float cannot be assigned to variable of type int",
        "'=' : cannot convert from 'const int' to 'float'",
        'Cannot convert from: "float" to: "highp int"',
        "wrong operand types: no operation '*' exists that takes a left-hand operand of type 'const int' "
        "and a right operand of type 'float' (or there is no acceptable conversion)",
        "'*' does not operate on 'float' and 'int'",
        'implicit cast from "float" to "int" (C7011)',
        "Type mismatch, cannot convert from 'int' to 'float' (S0001)",
        "initializer of type vec2 cannot be assigned to variable of type ivec2",
        "`return' with wrong type int, in function `sgn' returning float",
    ],
    "most built-in functions want floats": [
        "no matching function for call to `mod(int, ivec2)'; candidates are:\n    float mod(float, float)",
        'unable to find compatible overloaded function "mod(int, int)" (C1115)',
        "No matching function for call to pow(float, int)",
    ],
    "No form of `dot` takes these arguments": [
        'unable to find compatible overloaded function "dot(mat3, vec3)" (C1115)',
        "'dot' : no matching overloaded function found (using implicit conversion)",
        "No matching overloaded function found: dot",
    ],
    "Signed and unsigned": ["initializer of type uint cannot be assigned to variable of type int"],
    "differ in size": [
        "value of type vec3 cannot be assigned to variable of type vec4",
        'implicit narrowing of type from "vec3" to "float" (C7623)',
        "Incompatible types (float and vec4) in assignment (and no available implicit conversion)",
        "'=' : dimension mismatch",
        "vector size mismatch for arithmetic operator",
    ],
    "A bool is not a number": ["initializer of type bool cannot be assigned to variable of type float"],
    "do not fit": [
        "could not implicitly convert operands to arithmetic operator",
        'invalid operands to "+" (C1020)',
    ],
    "components do not exist": [
        "invalid swizzle / mask `xyzw'",
        'swizzle mask element not present in operand "z" (C1031)',
        "'xyzw' : vector swizzle selection out of range",
        'Vector field selection out of range "xyz"',
        "'rgba' : field selection requires structure, vector, or matrix on left hand side",
        "OpenGL does not allow swizzles on scalar expressions (C7505)",
    ],
    "cannot be written to": [
        "assignment to read-only variable 'u'",
        "'assign' : l-value required (can't modify a const)",
        "'assign' : l-value required \"roughness\" (can't modify a uniform)",
        'l-value required: assign "gl_Vertex" (can\'t modify an input)',
        "Left-hand-side of assignment must not be read-only",
        "non-lvalue in assignment",
    ],
    "end in `return`": [
        "function `f' has non-void return type float, but no return statement",
        'function "two_lines" has no return statement (C1110)',
        "`return' with no value, in function f returning non-void",
        "'f' : function does not return a value: f",
    ],
    "name is taken": [
        "`a' redeclared",
        "function `f' redefined",
        "redeclaration of `u2' has incorrect type",
        'declaration of "f0" conflicts with previous declaration at 0(1328) (C1038)',
        "'pos' : redefinition",
        "Function 'noise2' redefines an existing function",
        "Attempt to redeclare 'distance' as a variable",
    ],
    "No function `fbm` is known": [
        "no function with name 'fbm'",
        "Invalid call of undeclared identifier 'fbm'",
        "Invalid call of 'fbm' (not a function or subroutine uniform)",
        "'fbm' : function is not known",
    ],
    "too few components": [
        "too few components to construct `vec4'",
        "too little data in type constructor (C1067)",
        "'constructor' : not enough data provided for construction",
    ],
    "too many components": [
        "too many parameters to `vec4' constructor",
        "too much data in type constructor (C1068)",
        "'constructor' : too many arguments",
    ],
    "`filter` is a reserved word": [
        "illegal use of reserved word `filter'",
        "'filter' : Reserved word.",
        "Reserved word: filter",
        'syntax error, unexpected reserved word "filter" at token "filter"',
        "Keyword 'filter' is reserved (L0003)",
        "'filter' : syntax error",
        'Syntax error: "filter" parse error',
    ],
    "`sample` is a reserved word": [
        "syntax error, unexpected SAMPLE, expecting ',' or ';'",
        "sample: Illegal use of reserved word 'sample'",
    ],
    "begin with `gl_`": ["identifier `gl_VertexID2' uses reserved `gl_' prefix", "`gl_VertexID' redeclared"],
    "`texture2D` is not in core GLSL": [
        "no function with name 'texture2D'",
        "Invalid call of undeclared identifier 'texture2D'",
        "'texture2D' : no matching overloaded function found",
        "global function texture2D is removed after version 140 (C7616)",
    ],
    "`gl_FragColor` is not in core GLSL": [
        "`gl_FragColor' undeclared",
        "Use of undeclared identifier 'gl_FragColor'",
    ],
    "write `in` or `out`": [
        "illegal use of reserved word `varying'",
        "'varying' : syntax error",
        "'attribute' is deprecated, use 'in/out' instead (C7555)",
    ],
    "needs a newer `#version`": [
        "`in' qualifier in declaration of `q' only valid for function parameters in GLSL 1.10",
        "#version must appear on the first line",
        "#version required and missing.",
        'global type uint requires "#version 130" or later (C7532)',
    ],
    "has no GLSL": [
        "GLSL 4.70 is not supported. Supported versions are: 1.10, 1.20",
        "version '430' is not supported",
        "unsupported version 460 (C0201)",
        "Version number 330 not supported",
    ],
    "lacks the extension `GL_FOO_bar`": [
        "extension `GL_FOO_bar' unsupported in fragment shader",
        "extension GL_FOO_bar not supported (C7508)",
        "'GL_FOO_bar' : extension is not supported",
    ],
    "add `#extension GL_FOO_bar : enable`": [
        "'&' requires \"#extension GL_FOO_bar : enable\" before use (C7548)"
    ],
    "too old for this": [
        "unrecognized layout identifier `binding'",
        "Unknown identifier 'binding' in layout",
        "'scalar swizzle' : not supported for this version or the enabled extensions",
    ],
}


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
