"""A text's dialect is found by its signs, in their order; what it declares by its statements."""

from __future__ import annotations

import pytest

from playground.dialects.table import dialect_of
from playground.shader.declarations import is_declared, uniforms, vertex_outputs
from playground.sketch.load import load
from playground.sketch.model import PlainFragment


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ('/*{ "DESCRIPTION": "x",\n\t"CATEGORIES": ["a",], }*/\nvoid main() {}', "isf"),
        ("/*{ a comment }*/\nvoid main() {}", "main"),
        ("/*{}*/\nvoid main() {}", "isf"),
        ("// x\n/* {\n} */\nvoid main() {}", "isf"),
        ('/*{"CREDIT": ""}*/\nvoid main() {}', "isf"),
        ("/*{,}*/\nvoid main() { gl_FragColor = vec4(TIME); }", "isf"),
        ('/*{"LABEL": ""}*/\nvoid main() { gl_FragColor = IMG_THIS_PIXEL(a); }', "isf"),
        ('[{"renderpass": []}]', "export"),
        ('{"renderpass": []}', "export"),
        ('#pragma kernel(output = "a:r8")\nvoid mainImage() {}', "own"),
        ("// #pragma kernel\nvoid mainImage(out vec4 c, vec2 p) {}", "shadertoy"),
        ("void mainImage(out vec4 c, vec2 p) {} void main() {}", "main"),
        ("/* void main() {} */ void mainImage(out vec4 c, vec2 p) {}", "shadertoy"),
        ('#iChannel0 "file://a.png"\nvoid mainImage(out vec4 c, vec2 p) {}', "vscode"),
        ("#iUniform float a = 1.0\nvoid main() {}", "vscode"),
        ("#StrictCompatibility\nvoid mainImage(out vec4 c, vec2 p) {}", "vscode"),
        (" # iFirstPersonControls\nvoid mainImage(out vec4 c, vec2 p) {}", "vscode"),
        ('#iVertex "file://a.vert"\nvoid main() {}', "vscode"),
        ("// #iVertex\nvoid main() {}", "main"),
        ("int main ( ) {}", "main"),
        ("#define M mainImage\nvoid M(out vec4 c, vec2 p) {}", "shadertoy"),
        ("#define M mainImage\nvoid main() {}", "main"),
        ("#ifdef A\nvoid mainImage(out vec4 c, vec2 p) {}\n#else\nvoid main() {}\n#endif", "main"),
        ("#ifdef SHADER_TOY\nvoid mainImage(out vec4 c, vec2 p) {}\n#endif\nvoid main() {}", "main"),
        ("#ifdef A\nvoid mainImage(out vec4 c, vec2 p) {}\n#endif", "shadertoy"),
        ("#if 0\n#iUniform float a = 1.0\n#endif\nvoid main() {}", "main"),
        ("#define main2 main\nvoid f() {}", "main"),
        ("vec2 mainSound(float t) {}", "sound"),
        ("float f() { return 1.0; }", None),
        ("", None),
    ],
)
def test_the_sign_of_a_dialect(text, name):
    dialect = dialect_of(text)
    assert (dialect.name if dialect else None) == name


@pytest.mark.parametrize("version", ["330", "330 core", "430"])
def test_a_plain_shader_that_needs_no_more_stays_one(tmp_path, version):
    path = tmp_path / "a.frag"
    path.write_text(
        f"#version {version}\nuniform float iTime;\nout vec4 c;\nvoid main() {{ c = vec4(iTime); }}\n"
    )
    assert type(load(path).graph.find("view").technique) is PlainFragment
    path.write_text(path.read_text().replace("uniform float iTime", "in vec2 uv; uniform float iTime"))
    assert load(path).graph.find("view").technique.dialect == "main"


def test_the_same_files_give_the_same_kernel(tmp_path):
    path = tmp_path / "a.frag"
    path.write_text("void main() { gl_FragColor = vec4(1.0); }\n")
    first = load(path).graph.find("view").technique
    assert load(path).graph.find("view").technique is first
    path.write_text("void main() { gl_FragColor = vec4(0.5); }\n")
    assert load(path).graph.find("view").technique is not first


def test_uniforms_of_several_lines_and_names_are_found():
    code = "uniform float a, b[3];uniform vec2\n  c = vec2(1.0, 2.0), d;\n"
    code += "layout(location = 1) uniform highp int e;\n"
    result = uniforms(f"{code}void f(vec2 g) {{ vec2 h; }}\n")
    assert {n: (d.type, d.is_array) for n, d in result.items()} == {
        "a": ("float", False),
        "b": ("float", True),
        "c": ("vec2", False),
        "d": ("vec2", False),
        "e": ("int", False),
    }


def test_a_macro_may_stand_for_a_qualifier():
    code = "#ifdef A\n#define IN in\n#else\n  # define IN in\n#endif\n#define U uniform\n#define INNER in_\n"
    code += "IN vec2 uv;\nU float a; U vec2 b;\nINNER vec2 c;\n"
    assert {n: (d.type, d.line) for n, d in uniforms(code).items()} == {
        "a": ("float", 8),
        "b": ("vec2", 8),
    }
    assert vertex_outputs(code) == (("out vec2 uv;", "uv = k_share;"),)


def test_a_local_name_is_no_declaration_of_the_file():
    code = "float time;\nfloat f(float iTime) { float mouse = 1.0; return mouse; }\n"
    assert is_declared(code, "time", anywhere=False) and is_declared(code, "f", anywhere=False)
    for name in ("mouse", "iTime"):
        assert not is_declared(code, name, anywhere=False) and is_declared(code, name, anywhere=True)
    code = f"#define BEGIN (\n#define OPEN {{\n{code}"
    assert is_declared(code, "time", anywhere=False) and is_declared(code, "f", anywhere=False)


def test_what_a_vertex_shader_gives():
    code = (
        "in vec2 uv, other;\nflat in ivec2 which;\nlayout(location = 2) in vec4 v_color;\nin vec2 many[3];\n"
        "in Block { vec3 v_normal; vec2 at; } inside;\n"
        "void f(in vec2 p, in vec3 q) { }\nvoid g(\n  in vec2 r);\n"
    )
    assert dict(vertex_outputs(code)) == {
        "out vec2 uv;": "uv = k_share;",
        "out vec2 other;": "other = vec2(0.0);",
        "flat out ivec2 which;": "which = ivec2(0);",
        "layout(location=2) out vec4 v_color;": "v_color = vec4(1.0);",
        "out vec2 many[3];": "for (int k_i = 0; k_i < many.length(); ++k_i) many[k_i] = vec2(0.0);",
        "out Block { vec3 v_normal; vec2 at; } inside;": (
            "inside.v_normal = vec3(0.0, 0.0, 1.0); inside.at = vec2(0.0);"
        ),
    }


def test_array_typed_uniforms_and_images_are_found():
    code = "uniform float[3] a;\nlayout(r32ui) uniform coherent restrict uimage2D [2] b;\n"
    code += "uniform lowp sampler2D[4] maps, more;uniform vec2\tc;\n"
    result = uniforms(code)
    assert {n: (d.type, d.is_array, d.line, d.written.strip()) for n, d in result.items()} == {
        "a": ("float", True, 0, "a[3]"),
        "b": ("uimage2D", True, 1, "b[2]"),
        "maps": ("sampler2D", True, 2, "maps[4]"),
        "more": ("sampler2D", True, 2, "more[4]"),
        "c": ("vec2", False, 2, "c"),
    }


def test_precision_and_empty_macros_are_not_types():
    code = "#ifdef GL_ES\n#define LOWP lowp\n#else\n#define LOWP\n#endif\n#define HIGH highp\n#define GUARD\n"
    code += "uniform LOWP float a;\nin LOWP vec4 v_color;\nin HIGH vec2 v_uv;\nuniform HIGH sampler2D b;\n"
    assert {n: (d.type, d.line) for n, d in uniforms(code).items()} == {
        "a": ("float", 7),
        "b": ("sampler2D", 10),
    }
    assert [declaration for declaration, _ in vertex_outputs(code)] == ["out vec4 v_color;", "out vec2 v_uv;"]
