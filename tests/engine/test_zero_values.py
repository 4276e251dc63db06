"""Variables of other tools' shaders begin at 0: the picture is that of the text with its zeros written."""

from __future__ import annotations

import re

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.errors import ShaderError
from playground.shader.wrap import FRAGMENT, wrap
from playground.shader.zero_values import with_zeros
from playground.sketch.load import load

pytestmark = pytest.mark.room("dialects")

SIZE = (32, 18)
IN_MAIN = (
    "{}\nvoid mainImage(out vec4 c, in vec2 p) {{« c = vec4(0);» vec2 s = p / iResolution.xy;{}\n{} }}\n"
)
DIRTY = """void mainImage(out vec4 c, in vec2 p) {
    float a[64]; vec4 v = vec4(1e30); mat4 m = mat4(0.0 / (p.x - p.x));
    for (int i = 0; i < 64; i++) a[(i * 7) % 64] = 1e30 * float(i + iFrame);
    for (int i = 0; i < 64; i++) v += a[(i + int(p.x)) % 64] * m[i % 4];
    c = v;
}
"""
# In each, what is between « and » is what WebGL adds; it is taken away for the shader that is tested.
LOCALS = {
    "several names": (
        "",
        "float a« = 0.», b = .5, d[3]« = float[3](0., 0., 0.)»; a += s.x + d[1];",
        "a, b, d[2]",
    ),
    "for": ("", "for (float i« = 0.», z« = 0.»; i++ < 4.; z += s.x) c.x += z;", "c.x, 0, 0"),
    "each step of a loop": (
        "",
        "float t = 0.; for (int i = 0; i < 3; i++) { float q« = 0.»; q += s.x; t += q; }",
        "t / 4., 0, 0",
    ),
    "while": (
        "",
        "int n = 0; float t = 0.; while (n++ < 3) { vec2 q« = vec2(0)»; q += s; t += q.y; }",
        "t / 4., 0, 0",
    ),
    "switch": (
        "",
        "float t; switch (int(p.x) % 2) { case 0: float q« = 0.»; q += s.x; t = q; break;"
        " default: vec2 r« = vec2(0)»; r += s; t = r.y; }",
        "t, 0, 0",
    ),
    "switch, declared above another label": (
        "",
        "float t = 0.; switch (int(p.x) % 4) { case 0: float q« = 0.»; q += s.x; t = q; break;"
        " case 1: case 2:« q = 0.;» q += s.y; default: t = 1. - s.x; }",
        "t, 0, 0",
    ),
    "behind if": ("", "float t« = 0.»; if (s.x > .5) t = 1.;", "t, s.y, 0"),
    "precisions": ("", "highp float a« = 0.»; lowp vec3 b« = vec3(0)»; a += s.x; b += s.y;", "a, b.x, 0"),
    "other types": (
        "",
        "int a« = 0»; uint b« = 0u»; bool d« = false»; mat2 m« = mat2(0)»; bvec2 e« = bvec2(false)»;"
        " m[0] += s; a += int(p.x); b += uint(p.y);",
        "m[0].x, float(a + int(b)) / 64., d || e.x ? 1 : s.y",
    ),
    "a struct": (
        "struct Ball { vec3 at; float r; }; struct Hit { Ball ball[2]; int n; mat3 m; };",
        "Hit h« = Hit(Ball[2](Ball(vec3(0), 0.), Ball(vec3(0), 0.)), 0, mat3(0))»;"
        " h.ball[1].at.xy += s; h.n++;",
        "h.ball[1].at.xy, float(h.n) / 4. + h.ball[0].r + h.m[1].x",
    ),
    "structs without a name": (
        "",
        "struct { float a; vec2 b; } q;« q.a = 0.; q.b = vec2(0);» q.a += s.x; q.b += s;",
        "q.a, q.b",
    ),
    "structs of the place": (
        "",
        "struct Own { float a[2]; }; Own q« = Own(float[2](0., 0.))»; q.a[1] += s.x;",
        "q.a[1] + q.a[0], s.y, 0",
    ),
    "sizes": (
        "#define N 3\nconst int M = N * 2 + 1;",
        "float a[M], b[N + (M >> 1)];« for (int i = 0; i < 7; i++) a[i] = 0.;"
        " for (int i = 0; i < 6; i++) b[i] = 0.;» a[6] += s.x; b[5] += s.y;",
        "a[6] + a[0], b[5] + b[1], a[3]",
    ),
    "long arrays": (
        "",
        "vec4 a[200];« for (int i = 0; i < 200; i++) a[i] = vec4(0);» int k = int(p.x); a[k] += s.x; ",
        "a[k].x, a[k + 1].y, a[199].z",
    ),
    "arrays by their type": (
        "",
        "float[2] a« = float[2](0., 0.)», b« = float[2](0., 0.)»; a[1] += s.x; b[0] += s.y;",
        "a[1] + a[0], b[0], b[1]",
    ),
    "a macro for a type": (
        "#define F float\n#define V3 vec3",
        "F a« = 0.»; V3 v« = V3(0)»; a += s.x; v += s.y;",
        "a, v.x, 0",
    ),
    "a macro for a name": ("#define PI total", "float PI« = 0.»; PI += s.x;", "total, 0, 0"),
    "a macro that declares": (
        "#define SUM(n, x) float n« = 0.»; n += x",
        "SUM(a, s.x); SUM(b, s.y);",
        "a, b, 0",
    ),
    "a macro of a loop": (
        "#define REP(i, n) for (int i« = 0»; i < n; i++)",
        "REP(k, 4) c.x += s.x;",
        "c.x / 4., 0, 0",
    ),
    "a macro with and without": (
        "#define DECL(n) float n",
        "DECL(a)« = 0.»; DECL(b) = s.y; a += s.x;",
        "a, b, 0",
    ),
    "a macro beside one that names itself": (
        "#define iTime (iTime * .5)\n#define SUM(n, x) float n« = 0.»; n += x + iTime",
        "SUM(a, s.x);",
        "a, s.y, 0",
    ),
    "out parameters": (
        "void f(float x, out float a, out vec2 b[2], inout float k)"
        " {« a = 0.; b[0] = b[1] = vec2(0);» a += x; b[1] += x; k += x; }",
        "float a = 7.; vec2 b[2]; float k = .25; f(s.x, a, b, k);",
        "a, b[1].x + b[0].x, k",
    ),
    "the colour itself": ("", "c += vec4(s, .5, 1);", "c.xyz"),
    "no return": (
        "float f(float x) { if (x > .5) return x;« return 0.;» }\n"
        "struct R { vec2 a; }; R g(vec2 x) { if (x.x > .5) { R r = R(x); return r; }« return R(vec2(0));» }",
        "",
        "f(s.x), g(s).a",
    ),
    "globals": (
        "float g« = 0.», h = .25; vec3 v« = vec3(0)»; struct L { float a; }; L l[2]« = L[2](L(0.), L(0.))»;",
        "g += s.x; v += s.y; l[1].a += .5;",
        "g, v.x + h, l[1].a",
    ),
    "global arrays": (
        "float g[300];",
        "« for (int i = 0; i < 300; i++) g[i] = 0.;» int k = int(p.x); g[k] += s.x;",
        "g[k], g[299 - k], g[k + 1]",
    ),
    "functions that keep globals": (
        "float n« = 0.»; float next() { n += .125; return n; }",
        "",
        "next(), next(), next()",
    ),
    "branches": (
        "#define A\n#ifdef A\n#define T float\n#else\n#define T vec4\n#endif",
        "\n#ifndef A\nvec2 a;\n#else\nT a« = 0.»;\n#endif\n a += s.x;",
        "a, 0, 0",
    ),
}


def of_case(before, body, colour="", *, explicit=False):
    text = IN_MAIN.format(before, body, f"c.xyz = vec3({colour});" if colour else "")
    return re.sub(r"«(.*?)»", r"\1" if explicit else "", text, flags=re.DOTALL)


@pytest.mark.parametrize("name", LOCALS)
def test_a_variable_begins_at_zero(ctx, any_engine, folder, name):
    with Engine(ctx) as engine:
        expected = engine.render(
            load(folder.write("a.frag", of_case(*LOCALS[name], explicit=True))), size=SIZE
        ).array
    any_engine.render(load(folder.write("dirty.frag", DIRTY)), size=SIZE)
    path = folder.write("b.frag", of_case(*LOCALS[name]))
    np.testing.assert_array_equal(any_engine.render(load(path), size=SIZE).array, expected)
    assert len(np.unique(expected)) > 2


OUTPUTS = {
    "gl_FragColor": "void main() { gl_FragColor.r += 0.5; }",
    "gl_FragData": "void main() { gl_FragData[0].r += 0.5; }",
    "an output of its own": "#version 330\nuniform float u_view;\nin vec2 uv;\nout vec4 c;\n"
    "void main() { c.r += 0.5 + 0.0 * uv.x; }",
    "a plain shader": "#version 330\nout vec4 c;\nvoid main() { float a; c.r += a + 0.5; }",
    "ISF": '/*{"CATEGORIES": ["a"]}*/\nvoid main() { gl_FragColor.r += 0.5; }',
    "its main a macro": "#define BEGIN void main() {\nBEGIN gl_FragColor.r += 0.5; }",
}


@pytest.mark.parametrize("name", OUTPUTS)
def test_an_output_of_main_begins_at_zero(any_engine, folder, name):
    any_engine.render(load(folder.write("dirty.frag", DIRTY)), size=SIZE)
    render = any_engine.render(
        load(folder.write("a.fs" if name == "ISF" else "a.frag", OUTPUTS[name])), size=SIZE
    )
    np.testing.assert_array_equal(render.array[..., :3], np.broadcast_to([128, 0, 0], (18, 32, 3)))


def test_a_varying_of_an_own_vertex_shader_begins_at_zero(any_engine, folder):
    folder.write(
        "a.vs", "varying vec2 v; varying float w;\nvoid main() { isf_vertShaderInit(); v.x += 0.5; }\n"
    )
    text = '/*{"CATEGORIES": ["a"]}*/\nvarying vec2 v; varying float w;\n'
    path = folder.write("a.fs", f"{text}void main() {{ gl_FragColor = vec4(v, w, 1.0); }}\n")
    array = any_engine.render(load(path), size=SIZE).array[..., :3]
    np.testing.assert_array_equal(array, np.broadcast_to([128, 0, 0], (18, 32, 3)))


def test_buffers_that_write_no_alpha_have_none(any_engine, folder):
    folder.write("Buffer A.glsl", "void mainImage(out vec4 c, in vec2 p) { c.rgb += 0.5; }\n")
    image = "void mainImage(out vec4 c, in vec2 p) { c = texelFetch(iChannel0, ivec2(p), 0).aaar; }\n"
    array = any_engine.render(load(folder.write("Image.glsl", image)), size=SIZE).array[..., :3]
    assert not array.any()


def test_a_mistake_keeps_its_line_and_its_column(any_engine, folder):
    body = "    float a, b[3]; vec2 q; float w = nowhere;"
    text = f"float g; vec3 v;\nvoid mainImage(out vec4 c, in vec2 p) {{ vec4 k;\n{body}\n}}\n"
    with pytest.raises(ShaderError) as caught:
        any_engine.render(load(folder.write("a.frag", text)), size=SIZE)
    first = caught.value.diagnostics[0]
    assert (first.line, first.column) == (3, body.index("nowhere") + 1)


def test_zeros_change_no_line_and_no_text_that_has_them(folder):
    def zeroed(text):
        kernel = load(folder.write("a.frag", text)).graph.find("view").technique
        return with_zeros(wrap(kernel, FRAGMENT, 450)).stages["fragment"], kernel

    stage, kernel = zeroed(of_case("float g;\n#define D(n) float n\n", "\nD(\na);\nfloat b;\n"))
    assert stage.text.count("\n") == wrap(kernel, FRAGMENT, 450).stages["fragment"].text.count("\n")
    text = "float f(float x) { return x; }\nfloat g = 1.0;"
    stage, kernel = zeroed(of_case(text, " float a = s.x, b[2] = float[2](1.0, a);", "a"))
    assert text in stage.text and "float a = s.x, b[2] = float[2](1.0, a);" in stage.text


def test_a_jump_past_a_declaration_in_a_switch_finds_zeros(folder):
    body = "switch (int(p.x)) { case 0: float q; if (s.x > 0.5) break;"
    body += " case 1: q += 1.0; break; case 2: c.x = q; }"
    kernel = load(folder.write("a.frag", of_case("", body))).graph.find("view").technique
    text = with_zeros(wrap(kernel, FRAGMENT, 450)).stages["fragment"].text
    assert "case 0: float q = 0.0; if" in text and "case 2: q = 0.0; c.x" in text
    assert "case 1: q += 1.0" in text  # case 0 goes on to it


def test_a_text_that_zeros_would_break_is_drawn_as_it_is(any_engine, folder, caplog):
    before = "#define vec2 highp vec2\nfloat f(vec2 s) { vec2 a; a = s; return a.x; }\n#undef vec2"
    text = of_case(before, "", "f(s)")
    array = any_engine.render(load(folder.write("a.frag", text)), size=SIZE).array
    assert array[0, -1, 0] > 240
    assert "a.frag: variables without a value are undefined here" in caplog.text


def test_macros_without_end_are_left_to_the_driver(folder):
    doubles = "\n".join(f"#define M{n + 1} M{n} M{n}" for n in range(40))
    text = f"#define M0 +1.0\n{doubles}\n{of_case('', 'float a;', 'a')}"
    kernel = load(folder.write("a.frag", text)).graph.find("view").technique
    assert "float a" in with_zeros(wrap(kernel, FRAGMENT, 450)).stages["fragment"].text
