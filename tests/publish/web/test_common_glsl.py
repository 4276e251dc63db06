"""What desktop GLSL allows and GLSL ES does not is written out at export, line for line, or refused."""

from __future__ import annotations

import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest

from playground.errors import ShaderError
from playground.publish.web.page_data import page_data
from playground.shader.common_glsl import in_common_glsl, lacking
from playground.shader.wrap import FRAGMENT, wrap

from ...loading import load
from ...sketch_texts import map_of_height
from .texts import kernels

GLSLANG = shutil.which("glslangValidator")
CONVERSIONS = {
    "float a = 1;": "float a = 1.0;",
    "float a = -1 + 2 * n;": "float a = float(-1 + 2 * n);",
    "vec3 v = 2 * w.xyz;": "vec3 v = 2.0 * w.xyz;",
    "float a = pow(x, 2) + max(x, 0) + max(1, 2);": "float a = pow(x, 2.0) + max(x, 0.0) + float(max(1, 2));",
    "int i = max(n, 0);": "int i = max(n, 0);",
    "bool b = x > 1 && n > 1;": "bool b = x > 1.0 && n > 1;",
    "float a = b ? 1 : 0.5;": "float a = b ? 1.0 : 0.5;",
    "float a = n / 2;": "float a = float(n / 2);",
    "float a = x + n / 2;": "float a = x + float(n / 2);",
    "vec2 v = x.xx;": "vec2 v = vec2(x);",
    "x *= 2;": "x *= 2.0;",
    "w.x = 1;": "w.x = 1.0;",
    "float a[2] = { 1, x };": "float a[2] = float[]( 1.0, x );",
    "vec2 v = vec2(1, n);": "vec2 v = vec2(1, n);",
    "vec2 v = ivec2(1, n) + w.xy;": "vec2 v = vec2(ivec2(1, n)) + w.xy;",
    "float a = taken(1, n);": "float a = taken(1.0, n);",
    "uint u = n + 1u;": "uint u = uint(n) + 1u;",
    "float a = SIDES * x;": "float a = float(SIDES) * x;",
    "float a = known(1) * 2;": "float a = float(known(1) * 2);",
    "for (float f = 0; f < 3; f++) x += f * 2;": "for (float f = 0.0; f < 3.0; f++) x += f * 2.0;",
    "w = m * w * 2;": "w = m * w * 2.0;",
    "float a = (1 + n) * x;": "float a = float((1 + n)) * x;",
    "float a = (n + 1u) * x;": "float a = float((uint(n) + 1u)) * x;",
    "vec4 t = texture(s, w.xy, 1);": "vec4 t = texture(s, w.xy, 1.0);",
    "ivec2 t = textureSize(s, 0);": "ivec2 t = textureSize(s, 0);",
    "some.level = 1;": "some.level = 1.0;",
    "int k = all[1] > 2 ? 1 : 0;": "int k = all[1] > 2.0 ? 1 : 0;",
}
FUNCTION = """#define SIDES 6
#define known(a) (a)
struct Some {{ float level; int many; }};
uniform sampler2D s;
float taken(float a, int b) {{ return a; }}
float whole() {{
    return 1;
}}
void main() {{
    float x = 0.5; int n = 3; vec4 w = vec4(1.0); mat4 m = mat4(1.0); bool b = true; Some some; float all[3];
    {}
}}
"""


@pytest.mark.parametrize("written", CONVERSIONS)
def test_a_conversion_is_written_out(written: str):
    expected = FUNCTION.format(CONVERSIONS[written]).replace("return 1;", "return 1.0;")
    assert in_common_glsl(FUNCTION.format(written)) == expected


@pytest.mark.parametrize(
    "text",
    [
        "#define BODY(t) t twice(t a)\nBODY(float) { return a 2; }\nvoid main() {\n    float a = ) 1;\n}\n",
        "void main() { float a = " + 2000 * "(" + "1",
        "",
    ],
    ids=["macros that take types", "endless", "nothing"],
)
def test_what_is_not_understood_stays(text: str):
    assert in_common_glsl(text) == text


FORMS = {
    "in Block { vec2 uv; float far[2]; } from;\nvoid main() { vec2 a = from.uv * from.far[0]; }": (
        " in vec2 Block_uv; in float Block_far[2]; \nvoid main() { vec2 a = Block_uv * Block_far[0]; }"
    ),
    "out Block {\n    vec2 uv;\n};\nvoid main() { uv = vec2(1.0); }": (
        "\n    out vec2 Block_uv;\n\nvoid main() { Block_uv = vec2(1.0); }"
    ),
    "float tanh(float x) { return x; }\nfloat y() { return tanh(1.0); }": (
        "float k_own_tanh(float x) { return x; }\nfloat y() { return k_own_tanh(1.0); }"
    ),
    "uniform float t;\nfloat a = t * 2.0, b = 3.0;\nvoid main() {\n}": (
        "uniform float t;\nfloat a , b = 3.0;\nvoid main() { a = t * 2.0;\n}"
    ),
    "const float k = 2.0;\nfloat a = k * sin(1.0);\nvoid main() {}": (
        "const float k = 2.0;\nfloat a = k * sin(1.0);\nvoid main() {}"
    ),
    "void f(float x) { const float a = x; const int n = 3; float b[n]; }": (
        "void f(float x) {  float a = x; const int n = 3; float b[n]; }"
    ),
}


@pytest.mark.parametrize("written", FORMS)
def test_a_form_of_desktops_has_another(written: str):
    result = in_common_glsl(written)
    assert result.split() == FORMS[written].split()
    assert result.count("\n") == written.count("\n")


HEAD = """#version 420
uniform sampler2D s;
uniform float t;
uniform int k;
out vec4 c;
"""
BODY = (
    "void main() {{\n    float x = t; int n = k; uint u = 3u; vec4 w = vec4(t);\n    {}\n    c = w * x;\n}}\n"
)
DESKTOP = tomllib.loads(Path(__file__).with_name("desktop.toml").read_text("utf-8"))
TEXTS = {name: BODY.format(text) for name, text in DESKTOP["statements"].items()} | DESKTOP["texts"]
TEXTS["long_sum"] = BODY.format(f"x = {' + '.join(['1'] * 400)} + t;")


@pytest.mark.skipif(GLSLANG is None, reason="needs glslangValidator")
def test_what_desktops_take_pages_take(tmp_path: Path):
    for name, text in TEXTS.items():
        common = in_common_glsl(HEAD + text)
        assert common.count("\n") == (HEAD + text).count("\n"), name
        (tmp_path / f"{name}.desktop.frag").write_text(HEAD + text)
        es = common.replace("#version 420", "#version 300 es\nprecision highp float;")
        (tmp_path / f"{name}.es.frag").write_text(es)
    files = sorted(tmp_path.iterdir())
    done = subprocess.run([str(GLSLANG), *files], capture_output=True, text=True, check=False)
    assert done.returncode == 0, "\n".join(line for line in done.stdout.split("\n") if line)


def test_macro_whose_calls_want_different_numbers_stays():
    text = "#define ADD(a) (a + 1)\nuniform float t;\nvoid main() { int i = ADD(2); float f = ADD(t); }\n"
    assert in_common_glsl(text) == text


def test_a_texture_of_one_dimension_is_a_row():
    text = "uniform sampler1D tones;\nvec4 a = texture(tones, 0.5) + texelFetch(tones, 3, 0);\n"
    result = in_common_glsl(text)
    assert "sampler1D" not in result and result.count("\n") == 2
    assert "k_line(tones, 0.5) + k_lineFetch(tones, 3, 0)" in result


@pytest.mark.slow
def test_the_library_is_in_the_common_subset():
    for name, kernel in kernels().items():
        for stage in wrap(kernel, FRAGMENT).stages.values():
            assert in_common_glsl(stage.text) == stage.text, name


LOOSE = """#pragma kernel(output = "height:r32f")
uniform float steep = 2.0;  //! slider(0, 4)
float kernel(ivec2 texel) {
    return pow(steep, 2);
}
"""


def test_desktop_only_line_of_a_kernel_is_refused(tmp_path: Path):
    (tmp_path / "terrain.glsl").write_text(LOOSE, "utf-8")
    (tmp_path / "loose.toml").write_text(f"format = 1\nsize = 33\n{map_of_height()}", "utf-8")
    with pytest.raises(ShaderError, match=r"terrain\.glsl:4.*written as `return pow\(steep, 2\.0\);`"):
        page_data([load(tmp_path / "loose.toml")])
    (tmp_path / "terrain.glsl").write_text(LOOSE.replace("2)", "2.0)"), "utf-8")
    assert page_data([load(tmp_path / "loose.toml")])["sketches"]


TOY = "void mainImage(out vec4 c, in vec2 p) {{ c = vec4({}); }}\n"


@pytest.mark.parametrize(
    ("code", "name"),
    [
        ("vec4 a = textureGather(s, p);", "textureGather()"),
        ("int n = findMSB (5);", "findMSB()"),
        ("double d = 1.0;", "double"),
        ("uniform samplerCubeArray s;", "samplerCubeArray"),
        ("float fma(float a, float b, float c) { return a; } float x = fma(1.0, 2.0, 3.0);", ""),
        ("#define ldexp(a, b) (a)\nfloat x = ldexp(1.0, 2);", ""),
        ("float bitCount = 1.0, doubled = 2.0;", ""),
        ("vec4 a = texture(s, p) + texelFetch(s, ivec2(p), 0);", ""),
    ],
)
def test_what_the_glsl_of_pages_lacks_is_found(code: str, name: str):
    assert lacking(code) == name


def test_a_shader_that_no_page_can_run_is_refused_with_the_name(tmp_path: Path):
    (tmp_path / "toy.frag").write_text(TOY.format("textureGather(iChannel0, p).x"))
    with pytest.raises(ShaderError, match=r"names textureGather\(\), which the GLSL of web pages has not"):
        page_data([load(tmp_path / "toy.frag")])
    (tmp_path / "fine.frag").write_text(TOY.format("texture(iChannel0, p).x"))
    assert page_data([load(tmp_path / "fine.frag")])["sketches"]
