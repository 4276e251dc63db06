"""Completion, hover, definitions, rename and colours, asked for by real messages."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

from playground.paths import GLSL
from playground.shader.driver_log import library
from playground.shader.reserved_names import GIVEN
from playground.sketch import toml_table
from playground.sketch.load import load

from .client import Editor, Refusal
from .conftest import KERNEL, LIBRARY, SKETCH


def place(text: str, word: str, into: int = 0) -> tuple[int, int]:
    """Return the line and the column of a word's first appearance; all of it is ASCII."""
    at = text.index(word) + into
    return text.count("\n", 0, at), at - (text.rfind("\n", 0, at) + 1)


def labels(value: Any) -> set[str]:
    return {item["label"] for item in value["items"]}


def completed(editor: Editor, uri: str, text: str) -> set[str]:
    """Return what may stand where ``text`` has a bar."""
    at = text.index("|")
    editor.type(uri, text.replace("|", "", 1))
    line, column = text.count("\n", 0, at), at - (text.rfind("\n", 0, at) + 1)
    return labels(editor.at("completion", uri, line, column))


def applied(text: str, edits: list[dict[str, Any]]) -> str:
    """Return a text of ASCII with edits made."""
    starts = [0]
    for line in text.split("\n"):
        starts.append(starts[-1] + len(line) + 1)
    spans = [
        [starts[e["range"][k]["line"]] + e["range"][k]["character"] for k in ("start", "end")] for e in edits
    ]
    for (start, end), edit in sorted(zip(spans, edits, strict=True), key=lambda item: item[0], reverse=True):
        text = text[:start] + edit["newText"] + text[end:]
    return text


# ── shaders ──────────────────────────────────────────────────────────────────


@pytest.mark.slow
def test_a_kernel_is_completed_with_all_that_it_may_name(editor: Editor, hill: str) -> None:
    names = completed(editor, hill, KERNEL.replace("    return", "    float more = |;\n    return"))
    assert names >= {*GIVEN, "towards_sun", "previous"}, "given names"
    assert names >= {"rounds", "tint", "shape", "sun"}, "parameters"
    assert names >= {"far", "texel", "kept_of"}, "what the function and its include declare"
    names = completed(editor, hill, KERNEL.replace("    return", "    float more = r|;\n    return"))
    assert names >= {name for name in library() if name.startswith("r")}
    assert "random" in names and "reflect" in names


def test_a_function_of_the_library_brings_its_include(editor: Editor, folder: Path) -> None:
    uri = (folder / "hill.glsl").as_uri()
    text = KERNEL.replace("    return", "    far += rando;\n    return")
    editor.open(uri, text)
    line, column = place(text, "rando", 5)
    result = {i["label"]: i for i in editor.at("completion", uri, line, column)["items"]}["random"]
    assert result["detail"] == "float random(ivec2 point, uint seed)"
    assert "One number in [0, 1)" in result["documentation"]["value"]
    changed = applied(text, result["additionalTextEdits"]).replace("rando;", "random(texel, 1u);")
    assert editor.diagnostics(uri, editor.type(uri, changed)) == []


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ('#include "noi|', {"noise/hash.glsl", "shade.glsl"}),
        ('#pragma kernel(output = "height:r32f", |)', {"repeat", "accepts", "visits"}),
        ('#pragma draw(mesh = "grid", blend = "|', {"alpha", "add", "none"}),
        ('#pragma draw(mesh = "|', {"grid", "sheet"}),
        ("uniform vec3 extra = vec3(1.0);  //! |", {"colour", "slider", "unit()"}),
        ("uniform vec2 extra = vec2(1.0);  //! |", {"direction", "point"}),
        ("uniform sampler2D extra;  //! input(|)", {"linear", "white", "mipmap"}),
    ],
)
def test_directives_and_annotations_are_completed(
    editor: Editor, hill: str, line: str, expected: set[str]
) -> None:
    names = completed(editor, hill, f"// one line\n{line}\n{KERNEL}")
    assert names >= expected
    assert "base_elevation" not in names, "names of code do not belong here"


def test_a_comment_is_not_completed(editor: Editor, hill: str) -> None:
    assert completed(editor, hill, f"{KERNEL}\n// the rel|\n") == set()


@pytest.mark.parametrize(
    ("word", "expected"),
    [
        ("size) - 0.5", "ivec2 size"),
        ("towards_sun", "unit vector towards 'sun'"),
        ("kept_of(", "The share of a value that is left after a loss."),
        ("tint.x", "Tint of the hill"),
        ("far)", "float far = length"),
        ('shade.glsl"', "How a value is shaded"),
        ("slider(", "the range is enforced"),
    ],
)
def test_hover_says_what_a_name_is(editor: Editor, hill: str, word: str, expected: str) -> None:
    assert expected in editor.at("hover", hill, *place(KERNEL, word, 1))["contents"]["value"]


@pytest.mark.parametrize(
    ("word", "file", "line"),
    [
        ('shade.glsl"', "shade.glsl", ""),
        ("kept_of(", "shade.glsl", "float kept_of(float value"),
        ("tint.x", "hill.glsl", "uniform vec3 tint"),
        ("towards_sun", "hill.glsl", "uniform vec2 sun"),
        ("far)", "hill.glsl", "float far"),
    ],
)
def test_go_to_definition(editor: Editor, folder: Path, hill: str, word: str, file: str, line: str) -> None:
    result = editor.at("definition", hill, *place(KERNEL, word, 1))
    assert result["uri"] == (folder / file).as_uri()
    text = (folder / file).read_text().split("\n")[result["range"]["start"]["line"]]
    assert line in text


def test_a_function_that_is_not_included_is_found_in_the_library(editor: Editor, folder: Path) -> None:
    uri = (folder / "hill.glsl").as_uri()
    text = KERNEL.replace("kept_of(", "random(")
    editor.open(uri, text)
    result = editor.at("definition", uri, *place(text, "random("))
    assert result["uri"] == (GLSL / "noise/hash.glsl").as_uri()
    assert (
        '#include "noise/hash.glsl"' in editor.at("hover", uri, *place(text, "random("))["contents"]["value"]
    )


def test_symbols_are_what_a_file_declares(editor: Editor, folder: Path) -> None:
    uri, sketch = (folder / "hill.glsl").as_uri(), (folder / "sketch.toml").as_uri()
    editor.open(uri, KERNEL)
    editor.open(sketch, SKETCH, "toml")
    result = editor.ask("textDocument/documentSymbol", textDocument={"uri": uri})
    assert [item["name"] for item in result] == ["rounds", "tint", "shape", "sun", "kernel"]
    result = editor.ask("textDocument/documentSymbol", textDocument={"uri": sketch})
    assert [item["name"] for item in result] == ["pass height", "preset sharp", "shot sharp"]


REACH = """#pragma kernel(output = "height:r32f")
uniform float gain = 1.0;   //! slider(0, 1)
uniform vec2 sun = vec2(135.0, 30.0);  //! direction
float lit(float slope, float loss) {
    float rest = 1.0 - loss;
    return slope * rest;
}
float kernel(ivec2 texel) {
    float far = float(texel.x);
    float near = far * gain;
    if (near > 2.0) {
        near = 2.0;
    }
    return near + lit(towards_sun.z, 0.5);
}
"""


@pytest.mark.parametrize(
    ("word", "lines"),
    [("gain =", "10-12, 14"), ("sun =", "4, 6, 14"), ("loss)", "4-6, 14"), ("texel)", "8-12, 14")],
)
def test_hover_tells_the_lines_that_a_name_can_change(
    editor: Editor, folder: Path, word: str, lines: str
) -> None:
    uri = (folder / "hill.glsl").as_uri()
    editor.open(uri, REACH)
    assert f"can change lines {lines}" in editor.at("hover", uri, *place(REACH, word))["contents"]["value"]


def test_a_uniform_is_highlighted_with_what_it_can_change(editor: Editor, folder: Path) -> None:
    uri = (folder / "hill.glsl").as_uri()
    editor.open(uri, REACH)
    result = editor.at("documentHighlight", uri, *place(REACH, "gain ="))
    by_kind = {(item["kind"], item["range"]["start"]["line"] + 1) for item in result}
    assert by_kind == {(3, 2), (2, 10), (1, 10), (1, 11), (1, 12), (1, 14)}
    result = editor.at("documentHighlight", uri, *place(REACH, "near ="))
    assert [(i["kind"], i["range"]["start"]["line"] + 1) for i in result] == [
        (3, 10),
        (2, 11),
        (3, 12),
        (2, 14),
    ]


def test_references_are_in_every_file(editor: Editor, folder: Path, hill: str) -> None:
    result = editor.at("references", hill, *place(KERNEL, "kept_of("), context={"includeDeclaration": True})
    lines = {(item["uri"].rpartition("/")[2], item["range"]["start"]["line"]) for item in result}
    assert lines == {
        ("hill.glsl", place(KERNEL, "kept_of(")[0]),
        ("shade.glsl", place(LIBRARY, "kept_of(")[0]),
    }


def test_each_name_has_its_kind(editor: Editor, folder: Path) -> None:
    text = (
        '#pragma kernel(output = "height:r32f")\n#define TWICE(x) ((x) * 2.0)\n'
        "struct Wave { float far; };\nuniform float gain = 1.0;  //! slider(0, 1)\n"
        "float kernel(ivec2 texel) { Wave wave; return TWICE(wave.far) * gain * relief; }\n"
    )
    uri = (folder / "hill.glsl").as_uri()
    editor.open(uri, text)
    legend = editor.initialized["capabilities"]["semanticTokensProvider"]["legend"]["tokenTypes"]
    data = editor.ask("textDocument/semanticTokens/full", textDocument={"uri": uri})["data"]
    kinds, line, column = {}, 0, 0
    for down, right, length, kind, _ in zip(*[iter(data)] * 5, strict=True):
        line, column = line + down, right + (column if down == 0 else 0)
        kinds[text.split("\n")[line][column : column + length]] = legend[kind]
    assert kinds == {
        "TWICE": "macro",
        "Wave": "struct",
        "far": "property",
        "gain": "variable",
        "kernel": "function",
        "texel": "parameter",
        "wave": "variable",
        "relief": "variable",
    }


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("wave.|;", {"far", "at"}),
        ("float f = 2.0 * (waves[1 + 1].| + 1.0);", {"far", "at"}),
        ("float f = sea.wave.|", {"far", "at"}),
        ("return made(wave.far).|", {"far", "at"}),
        ("sea.| = wave;", {"wave"}),
        ("float f = wave.at.|;", set()),
    ],
)
def test_a_dot_is_completed_with_the_members_of_its_type(
    editor: Editor, hill: str, line: str, expected: set[str]
) -> None:
    structs = "struct Wave { float far; vec2 at; };\nstruct Sea { Wave wave; };\n"
    structs += "Wave made(float far) { return Wave(far, vec2(1.0)); }\n"
    body = f"    Wave wave, waves[3]; Sea sea;\n    {line}\n    float far"
    assert (
        completed(
            editor,
            hill,
            KERNEL.replace("float kernel", f"{structs}float kernel").replace("    float far", body),
        )
        == expected
    )


# ── sketches ─────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (SKETCH + "\n[[pass]]\n|", set(toml_table.PASS)),
        (SKETCH + "\n[view]\n|", set(toml_table.VIEW)),
        (SKETCH + "\n[view]\ncamera = { | }", set(toml_table.CAMERA)),
        (SKETCH.replace("size = 33", "|"), {"relief", "main"}),
        (SKETCH + "\n[|", {"pass", "shot", "view"}),
        (SKETCH + '\n[[pass]]\nname = "a"\nuse = "|"', {"./hill", "generation/mixed", "lighting/l_dot_n"}),
        (SKETCH.replace("{ rounds = 2,", "{ |"), {"rounds", "shape", "sun", "tint"}),
        (SKETCH.replace("{ rounds = 2,", '{ shape = "|",'), {"round", "sharp"}),
        (SKETCH.replace("{ rounds = 2,", "{ sun = { | },"), {"azimuth", "elevation"}),
        (SKETCH.replace('"height.rounds" = 3', '"height.shape" = |'), {'"round"', '"sharp"'}),
        (SKETCH.replace('preset = "sharp"', 'preset = "|"'), {"sharp"}),
        (SKETCH.replace('["height.rounds"]', '["|"]'), {"height.rounds", "height.tint"}),
        (
            SKETCH + '\n[[pass]]\nname = "l"\nuse = "lighting/l_dot_n"\ninputs = { | }',
            {"height"},
        ),
        (
            SKETCH + '\n[[pass]]\nname = "l"\nuse = "lighting/l_dot_n"\ninputs = { height = "|" }',
            {"height"},
        ),
        (SKETCH + '\n[[keyframe]]\ntime = 1\nease = "|"', {"smooth", "linear", "hold"}),
    ],
)
def test_a_sketch_is_completed(editor: Editor, sketch: str, text: str, expected: set[str]) -> None:
    assert completed(editor, sketch, text) >= expected


@pytest.mark.parametrize(
    ("word", "expected"),
    [
        ("relief =", toml_table.SKETCH["relief"]),
        ("preset]]", toml_table.SKETCH["preset"]),
        ("./hill", "One hill, as high as its size"),
        ("rounds = 2", "How often"),
        ('height.shape" =', "Form of the hill"),
    ],
)
def test_hover_in_a_sketch(editor: Editor, sketch: str, word: str, expected: str) -> None:
    assert expected in editor.at("hover", sketch, *place(SKETCH, word, 1))["contents"]["value"]


def test_go_to_what_a_sketch_names(editor: Editor, folder: Path, sketch: str) -> None:
    kernel = (folder / "hill.glsl").as_uri()
    assert editor.at("definition", sketch, *place(SKETCH, "./hill", 1))["uri"] == kernel
    result = editor.at("definition", sketch, *place(SKETCH, "rounds = 2", 1))
    assert (result["uri"], result["range"]["start"]["line"]) == (kernel, 4)
    result = editor.at("definition", sketch, *place(SKETCH, 'preset = "sharp"', 11))
    assert result["range"]["start"]["line"] == place(SKETCH, "[[preset]]")[0] + 1


# ── rename ───────────────────────────────────────────────────────────────────


def renamed(editor: Editor, folder: Path, word: str, new: str, text: str = KERNEL) -> dict[str, str]:
    """Return the texts of the files that a rename changes, by name."""
    uri = (folder / "hill.glsl").as_uri()
    editor.open(uri, text)
    result = editor.at("rename", uri, *place(text, word), newName=new)["changes"]
    named = {u.rpartition("/")[2]: edits for u, edits in result.items()}
    texts = {"hill.glsl": text, "shade.glsl": LIBRARY, "sketch.toml": SKETCH}
    return {name: applied(texts[name], edits) for name, edits in named.items()}


def test_a_functions_own_name_changes_there_alone(editor: Editor, folder: Path) -> None:
    text = KERNEL + "\nfloat other(float far) {\n    return far;\n}\n"
    result = renamed(editor, folder, "far =", "away", text)
    assert result == {"hill.glsl": text.replace("far =", "away =").replace("z, far)", "z, away)")}


def test_a_function_changes_in_every_file_that_calls_it(editor: Editor, folder: Path) -> None:
    result = renamed(editor, folder, "kept_of(", "remaining")
    assert result == {
        "hill.glsl": KERNEL.replace("kept_of", "remaining"),
        "shade.glsl": LIBRARY.replace("kept_of", "remaining"),
    }


def test_a_parameter_changes_in_the_sketches_that_set_it(editor: Editor, folder: Path) -> None:
    result = renamed(editor, folder, "rounds = 1", "turns")
    assert result == {
        "hill.glsl": KERNEL.replace("rounds", "turns"),
        "sketch.toml": SKETCH.replace("rounds", "turns"),
    }
    for name, text in result.items():
        (folder / name).write_text(text)
    assert load(folder / "sketch.toml").main == ("height.turns",)


TECHNIQUE = """[[pass]]
name = "a"
use = "./hill"
[parameters]
%s
[outputs]
height = "a:height"
"""


@pytest.mark.parametrize(
    ("export", "inside"),
    [('rounds = "a.rounds"\n"*" = "*"', "rounds"), ('"*" = "*"', "turns")],
    ids=["named", "all"],
)
def test_a_parameter_that_a_technique_shows_outside(
    editor: Editor, folder: Path, export: str, inside: str
) -> None:
    """By a name of its own, that name stays; with all others, it is called as the parameter is."""
    (folder / "both.toml").write_text(TECHNIQUE % export)
    sketch = SKETCH.replace("./hill", "./both")
    (folder / "more.toml").write_text(sketch)
    uri = (folder / "hill.glsl").as_uri()
    editor.open(uri, KERNEL)
    result = editor.at("rename", uri, *place(KERNEL, "rounds = 1"), newName="turns")["changes"]
    for changed, edits in result.items():
        path = folder / changed.rpartition("/")[2]
        path.write_text(applied(path.read_text(), edits))
    assert load(folder / "more.toml").main == (f"height.{inside}",)
    assert (folder / "more.toml").read_text() == sketch.replace("rounds", inside)
    for name in ("both.toml", "more.toml"):
        (folder / name).unlink()


def test_a_direction_takes_the_vector_towards_it_along(editor: Editor, folder: Path) -> None:
    result = renamed(editor, folder, "sun =", "lamp")
    assert result == {"hill.glsl": KERNEL.replace("vec2 sun", "vec2 lamp").replace("s_sun", "s_lamp")}


@pytest.mark.parametrize(
    ("word", "new", "why"),
    [
        ("texel)", "size", "given to every kernel"),
        ("far =", "texel", "a name of this function already"),
        ("kept_of(", "far", "is a name in"),
        ("kept_of(", "2nd", "is no name"),
        ("kept_of(", "vec3", "a word of GLSL"),
        ("size) -", "extent_", "its name is fixed"),
        ("length(", "measure", "a word of GLSL"),
        ("kernel(ivec2", "paint", "its name is fixed"),
        ("hill, as", "mound", "no name here"),
        ("z, far", "w", "component"),
    ],
)
def test_a_rename_that_is_not_safe_is_refused_with_a_sentence(
    editor: Editor, folder: Path, word: str, new: str, why: str
) -> None:
    with pytest.raises(Refusal, match=why) as refusal:
        renamed(editor, folder, word, new)
    assert "Traceback" not in str(refusal.value)
    assert not [note for note in editor.notes if note["method"] == "window/logMessage"]


def test_what_the_library_declares_is_not_renamed_from_a_kernel(editor: Editor, folder: Path) -> None:
    text = KERNEL.replace("#include", '#include "noise/hash.glsl"\n#include').replace("kept_of(", "random(")
    with pytest.raises(Refusal, match="not in the open folder"):
        renamed(editor, folder, "random(", "chance", text)


# What is renamed stands in «»; the cursor is at the first of them.
SCOPES = {
    "numbers": """float kernel(ivec2 texel) {
    float «e» = 1e-3, f = 2.0f;
    return «e» * 1.e3 + .5e3 + 0xeu - 1E-3 + f * «e»;
}""",
    "suffixes": """float kernel(ivec2 texel) {
    float «f» = 2.0f;
    return «f» + 1.f + .5F + 3e2f + 0xFFu;
}""",
    "members": """struct Wave { float e; };
float kernel(ivec2 texel) {
    vec4 «e» = vec4(1.0);
    Wave wave = Wave(«e».x);
    return «e».r + wave.e + wave . e + «e» [0];
}""",
    "another function": """float other(float e) { return e; }
float kernel(ivec2 texel) { float «e» = 1.0; return other(«e»); }
float third() { float e = 2.0; return e; }""",
    "outer block": """float kernel(ivec2 texel) {
    float «e» = 1.0;
    for (int i = 0; i < 3; ++i) { float e = «e» * 2.0, g = e; texel.x += int(e + g); }
    for (int e = 0; e < 3; ++e) texel.x += e;
    if (texel.x > 1) { float e = 2.0; return e; } else { return «e»; }
}""",
    "inner block": """float kernel(ivec2 texel) {
    float e = 1.0;
    { float «e» = e * 2.0; texel.x += int(«e»); { float e = «e»; texel.x += int(e); } }
    return e;
}""",
    "head of a loop": """float kernel(ivec2 texel) {
    int e = 1;
    for (int «e» = 0, g = «e»; «e» < 3; ++«e») if (g > «e») texel.x += «e»; else texel.x -= «e»;
    return float(e);
}""",
    "argument": """float other(in vec2 «e», float[2] g) {
    float h[2] = float[2](«e».x, «e».y), k = «e».x;
    return h[0] * k;
}
float kernel(ivec2 texel) { return other(vec2(1e-3), float[2](0.0, 1.0)); }""",
    "a macro's parameter": """#define SQUARE(e) ((e) * (e))
float kernel(ivec2 texel) { float «e» = 1.0; return SQUARE(«e»); }""",
    "branches": """float kernel(ivec2 texel) {
#ifdef FINE
    float «e» = 1.0;
#else
    float «e» = 2.0;
#endif
    return «e»;
}""",
    "a macro's text": """#define STEP (1.0 + «e»)
#define TWICE(e) (STEP * e)
float kernel(ivec2 texel) { float «e» = 1.0; return TWICE(«e»); }
float other(float e) { return e; }""",
    "branches of other brackets": """float kernel(ivec2 texel) {
    float «e» = 1.0;
#ifdef FINE
    for (int i = 0; i < 3; ++i) { «e» += 1e3 * march.e;
#else
    while (texel.x > 1) { float far = «e»; «e» *= far;
#endif
    }
    return «e»;
}
float other(float e) { return e; }""",
    "struct": """struct «Wave» { float e; };
«Wave» wave(float e) { return «Wave»(e); }
float kernel(ivec2 texel) { «Wave» both[2]; both[0] = wave(1.0); return both[0].e; }""",
    "member": """struct Sea { float e; };
struct Wave { float «e», f; Sea sea; };
Wave wave(float e) { return Wave(e, 1.0, Sea(e)); }
float kernel(ivec2 texel) {
    Wave all[2]; float e = 1.0; all[0].«e» = e; all[1] . «e» += wave(e).«e» + all[0].sea.e; return e;
}""",
    "overloads": """float «e»(float f) { return f; }
float «e»(vec2 f) { return «e»(f.x); }
float kernel(ivec2 texel) { float f = 1e-3; return «e»(f) + «e»(vec2(f)); }""",
    "a macro": """#define «e» 2.0
#define TWICE(f) (f * «e»)
float kernel(ivec2 texel) {
#if defined(«e») && «e» > 1
    return TWICE(«e») + 1e3;
#else
    return 1.0;
#endif
}""",
    "top level": """float «e»(float f) { return f * 1e-3; }
#define CALL(e) (e)
float kernel(ivec2 texel) { return CALL(«e»(1e3)); }""",
}
PRAGMA = '#pragma kernel(output = "height:r32f", \\\n    title = "a // b")\n'


@pytest.mark.parametrize("case", SCOPES)
def test_a_rename_changes_what_the_name_stands_for(editor: Editor, folder: Path, case: str) -> None:
    marked = PRAGMA + SCOPES[case]
    text = marked.replace("«", "").replace("»", "")
    uri = (folder / "hill.glsl").as_uri()
    editor.open(uri, text)
    result = editor.at("rename", uri, *place(marked, "«"), newName="east")["changes"]
    assert applied(text, result[uri]) == re.sub("«.*?»", "east", marked)


@pytest.mark.parametrize(
    ("text", "word", "new", "why"),
    [
        ("float kernel(ivec2 t) { return 1e-3; }", "e-3", "east", "no name here"),
        ("float kernel(ivec2 t) { return 2.0f; }", "f;", "far", "no name here"),
        ("float kernel(ivec2 t) { return 0xFFu; }", "FFu", "far", "no name here"),
        (
            "#define STEP (1.0 + e)\n#define TWICE (STEP * 2.0)\nfloat f(float e) { return STEP; }\n"
            "float kernel(ivec2 t) { float e = 1.0; return TWICE; }",
            "e = 1",
            "east",
            r"'e' is in the macro STEP at .*hill\.glsl:3",
        ),
        (
            "float far = 1.0;\n#define STEP (1.0 + far)\n"
            "float kernel(ivec2 t) { float e = 1.0; return e * STEP; }",
            "e = 1",
            "far",
            "a name of this function already",
        ),
        (
            "float kernel(ivec2 t) { float e = 1.0, far = 2.0; { float f = e; return f * far; } }",
            "e = 1",
            "far",
            "a name of this function already: .*hill.glsl:3",
        ),
        (
            "float far(float e) { return e; }\nfloat kernel(ivec2 t) { float e = 1.0; return far(e); }",
            "e = 1",
            "far",
            "a name of this function already",
        ),
        (
            "struct W { float e, far; };\nfloat kernel(ivec2 t) { W w; return w.e; }",
            "e, far",
            "far",
            "is a name in .*hill.glsl:3 already",
        ),
        ("void kernel(ivec2 t, out float height) { height = 1.0; }", "height)", "low", "its name is fixed"),
        (
            "#define FAR 1.0\nfloat kernel(ivec2 t) { float e = FAR; return e; }",
            "e = FAR",
            "FAR",
            "already",
        ),
        (
            "#define SQ(e) (e * e)\nfloat kernel(ivec2 t) { return SQ(1.0); }",
            "e)",
            "east",
            "a macro's parameter",
        ),
    ],
)
def test_a_rename_that_would_change_the_meaning_is_refused(
    editor: Editor, folder: Path, text: str, word: str, new: str, why: str
) -> None:
    with pytest.raises(Refusal, match=why):
        renamed(editor, folder, word, new, PRAGMA + text)


def test_a_uniform_behind_a_pragma_with_slashes_has_a_symbol(editor: Editor, folder: Path) -> None:
    text = (
        PRAGMA + "uniform float gain = 1.0;  //! slider(0, 1)\nfloat kernel(ivec2 texel) { return gain; }\n"
    )
    uri = (folder / "hill.glsl").as_uri()
    editor.open(uri, text)
    result = editor.ask("textDocument/documentSymbol", textDocument={"uri": uri})
    assert [symbol["name"] for symbol in result] == ["gain", "kernel"]
    result = editor.at("rename", uri, *place(text, "gain"), newName="loss")["changes"]
    assert applied(text, result[uri]) == text.replace("gain", "loss")


# ── colours ──────────────────────────────────────────────────────────────────


def test_kernel_colours_are_shown_encoded_and_written_linear(editor: Editor, hill: str) -> None:
    (result,) = editor.ask("textDocument/documentColor", textDocument={"uri": hill})
    start, end = place(KERNEL, "vec3(0.2, 0.5, 1.0)"), place(KERNEL, "vec3(0.2, 0.5, 1.0)", 19)
    assert result["range"] == {
        "start": {"line": start[0], "character": start[1]},
        "end": {"line": end[0], "character": end[1]},
    }
    encoded = [1.055 * c ** (1 / 2.4) - 0.055 for c in (0.2, 0.5, 1.0)]  # IEC 61966-2-1
    assert [result["color"][k] for k in ("red", "green", "blue")] == pytest.approx(encoded, abs=0.5 / 255)
    (shown,) = editor.ask(
        "textDocument/colorPresentation",
        textDocument={"uri": hill},
        range=result["range"],
        color={"red": 0.5, "green": 0.0, "blue": 1.0, "alpha": 1.0},
    )
    numbers = [float(n) for n in shown["label"].removeprefix("vec3(").rstrip(")").split(",")]
    half = round(0.5 * 255) / 255
    assert numbers == pytest.approx([((half + 0.055) / 1.055) ** 2.4, 0.0, 1.0], abs=1e-4)


def test_colours_of_a_sketch(editor: Editor, sketch: str) -> None:
    (result,) = editor.ask("textDocument/documentColor", textDocument={"uri": sketch})
    assert [round(result["color"][k] * 255) for k in ("red", "green", "blue")] == [0x33, 0x66, 0x99]
    (shown,) = editor.ask(
        "textDocument/colorPresentation",
        textDocument={"uri": sketch},
        range=result["range"],
        color={"red": 1.0, "green": 0.0, "blue": 128 / 255, "alpha": 1.0},
    )
    changed = applied(SKETCH, [shown["textEdit"]])
    assert tomllib.loads(changed)["pass"][0]["set"]["tint"] == "#ff0080"
