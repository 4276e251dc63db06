"""Macros and branches that are off, in shaders of other tools: what a preprocessor leaves out is no code."""

from __future__ import annotations

import json

import numpy as np
import pytest

from playground.dialects.table import dialect_of
from playground.sketch.load import load
from playground.sketch.model import kernels_of

SIZE = (32, 18)
PICTURE = "vec4(p / iResolution.xy, 0.25, 1.0)"
IMAGE = f"void mainImage(out vec4 c, in vec2 p) {{ c = {PICTURE}; }}\n"
MAIN = "out vec4 o;\nvoid main() { mainImage(o, gl_FragCoord.xy); }\n"
ISF = '/*{"CATEGORIES": ["a"]}*/\n'


@pytest.fixture
def drawn(any_engine, folder):
    """Give a function that draws a text, or a file, as an array."""

    def draw(text, name="a.frag"):
        path = folder.write(name, text) if text else folder.path / name
        return any_engine.render(load(path), size=SIZE).array

    return draw


def expected(red=None, green=None, blue=0.25):
    """Return the picture in 8 bits: by default x and y of its places, 0..1."""
    x, y = (np.arange(32) + 0.5) / 32, ((np.arange(18) + 0.5) / 18)[::-1, None]
    channels = [x if red is None else red, y if green is None else green, blue, 1.0]
    return np.stack([np.broadcast_to(channel, (18, 32)) for channel in channels], axis=-1) * 255


def check(result, **channels):
    assert np.abs(result - expected(**channels)).max() <= 0.5 + 1e-3


# ── entry points that are macros ─────────────────────────────────────────────

MACROS = {
    "a quotient": "#define mainImage(O,u) O=vec4(u/iResolution.xy,.25,1.)",
    "members": "#define mainImage(O,u) O=vec4(u.x/iResolution.x,u.y/iResolution.y,.25,1.)",
    "the place is changed": "#define mainImage(O,u) u /= iResolution.xy; O = vec4(u, .25, 1.)",
    "a sum from zero": "#define mainImage(O,u) float a; O += vec4(u / iResolution.xy, a + .25, 1.)",
    "another name": f"#define mainImage image\nvoid image(out vec4 c, vec2 p) {{ c = {PICTURE}; }}",
}


@pytest.mark.parametrize("name", MACROS)
def test_main_image_may_be_a_macro(drawn, name):
    check(drawn(f"{MACROS[name]}\n"))


def test_main_image_of_a_buffer_may_be_a_macro(drawn, folder):
    folder.write("Buffer A.glsl", "#define mainImage(O,u) O = vec4(u / iResolution.xy * 1., .25, 1.)\n")
    check(drawn("#define mainImage(O,u) O = texture(iChannel0, u / iResolution.xy)\n", "Image.glsl"))


def test_main_cubemap_may_be_a_macro(drawn, folder):
    folder.write("Cube A.glsl", "#define mainCubemap(O,u,o,d) O = vec4(d*.5+.5 + o*1., u.x*0.+1.)\n")
    text = "void mainImage(out vec4 c, in vec2 p) { c = texture(iChannel0, vec3(0, 0, -1)); }\n"
    check(drawn(text, "Image.glsl"), red=0.5, green=0.5, blue=0.0)


def test_main_may_be_a_macro(drawn):
    check(
        drawn("#define START main\nvoid START() { gl_FragColor = vec4(0, 1, 0, 1); }\n"),
        red=0,
        green=1,
        blue=0,
    )


# ── branches that are off ────────────────────────────────────────────────────

OFF = {
    "if 0": "#if 0\n{}#endif\n",
    "ifdef": "#ifdef ELSEWHERE\n{}#endif\n",
    "defined": "#if defined(ELSEWHERE) && !defined(HERE)\n{}#endif\n",
    "else": "#define HERE\n#ifdef HERE\n#else\n{}#endif\n",
    "in others": "#ifndef ELSEWHERE\n#ifdef ELSEWHERE\n{}#endif\n#endif\n",
    "of a number": "#define LEVEL 2\n#if LEVEL > 2 || LEVEL == 1\n{}#endif\n",
    "continued": "#if 0 && \\\n 1\n{}#endif\n",
    "a comment": "/*\n{}*/\n",
    "another tool": "#ifndef GL_ES\n{}#endif\n",
}


@pytest.mark.parametrize("name", OFF)
@pytest.mark.parametrize("first", [True, False])
def test_a_main_that_is_off_is_none(drawn, name, first):
    off = OFF[name].format(MAIN)
    text = f"{off}{IMAGE}" if first else f"{IMAGE}{off}"
    assert dialect_of(text).name == "shadertoy"
    check(drawn(text))


def test_a_main_image_that_is_off_is_none(drawn):
    text = f"#ifdef SITE\n{IMAGE}#else\nvoid main() {{ gl_FragColor = vec4(1, 0, 1, 1); }}\n#endif\n"
    check(drawn(text), red=1, green=0, blue=1)


@pytest.mark.parametrize("name", ["Image.glsl", "image.frag"])
def test_common_is_there_beside_a_main_that_is_off(drawn, folder, name):
    folder.write("common.glsl", "const float LEVEL = 0.25;\n#define HERE\n")
    off = OFF["ifdef"].format(MAIN)
    image = IMAGE.replace("0.25", "\n#ifdef HERE\nLEVEL\n#else\n1.0\n#endif\n")
    check(drawn(f"{image}{off}", name))


def test_an_export_has_branches_too(drawn):
    def one(name, kind, code):
        return {"name": name, "type": kind, "code": code, "inputs": [], "outputs": []}

    image = f"#ifdef HERE\n{IMAGE}#else\nuniform vec3 iResolution;\n#endif\n{OFF['ifdef'].format(MAIN)}"
    passes = [one("Image", "image", image), one("Common", "common", "#define HERE\n")]
    check(drawn(json.dumps({"renderpass": passes}), "a.json"))


def test_what_is_declared_in_a_branch_that_is_off_is_not(drawn, folder):
    off = OFF["ifdef"].format("uniform vec3 iResolution;\nuniform float level; //! slider(0, 1)\n")
    check(drawn(f"{off}{IMAGE}"))
    assert not load(folder.path / "a.frag").graph.find("view").technique.parameters


def test_isf_has_branches_too(drawn):
    off = OFF["ifdef"].format("vec4 TIME;\nvoid main() { gl_FragColor = vec4(1); }\n")
    colour = "vec4(gl_FragCoord.xy / RENDERSIZE, .25 + 0. * TIME, 1.)"
    text = f"{ISF}{off}void main() {{ gl_FragColor = {colour}; }}\n"
    check(drawn(text, "a.fs"))


# ── bodies of macros ─────────────────────────────────────────────────────────

BODIES = {
    "an element": ("#define R iChannelResolution[0].xy", "R.x * 0.0 + 0.25"),
    "a time of a channel": ("#define T iChannelTime[1]", "T + 0.25"),
    "itself": ("#define iTime (iTime * 0.25)", "iTime + 0.25"),
    "a sampler": ("#define S iChannel0", "texelFetch(S, ivec2(0), 0).x * 0.0 + 0.25"),
    "a call": ("#define T(q) texture(iChannel0, q)", "T(p).x * 0.0 + 0.25"),
    "a number without a sign": (
        "#define ZERO uint(0)\nuint at() { uint i = ZERO; return i; }",
        "float(at()) + 0.25",
    ),
    "vectors of these": ("#define A uvec2(1u, 2u)\nuvec2 q = A;", "float(q.y) / 8.0"),
    "a matrix": ("#define M mat2x2(1.0, 0.0, 0.0, 0.25)", "M[1].y"),
    "words since taken": ("#define Q smooth(1.0)\nfloat smooth(float x) { return x / 4.0; }", "Q"),
    "in a branch": (
        "#define ON\n#ifdef ON\n#define R iChannelResolution[0].x\n#else\n#define R iTime\n#endif",
        "R * 0.0 + 0.25",
    ),
    "a uniform": ("#define GIVEN(t, n) uniform t n;\nGIVEN(float, iTimeDelta)", "iTimeDelta * 15.0"),
    "a block": ("uniform Block { float iTime; };", "iTime * 0.0 + 0.25"),
}


@pytest.mark.parametrize("name", BODIES)
def test_a_body_of_a_macro_declares_nothing_by_itself(drawn, name):
    before, blue = BODIES[name]
    check(drawn(f"{before}\n{IMAGE.replace('0.25', blue)}"))


def test_a_hash_of_whole_numbers_is_that_of_numpy(drawn):
    text = "#define HASH_T uvec3(1597334673u, 3812015801u, 2798796415u)\n"
    text += "float h(uvec3 q) { q *= HASH_T; return float(q.x ^ q.y ^ q.z) / 4294967295.0; }\n"
    result = drawn(f"{text}{IMAGE.replace(PICTURE, 'vec4(h(uvec3(p, iFrame)))')}")[..., 0]
    x, y = np.meshgrid(np.arange(32, dtype=np.uint64), np.arange(18, dtype=np.uint64)[::-1])
    mixed = (x * 1597334673 ^ y * 3812015801) % 2**32
    assert np.abs(result - mixed / (2**32 - 1) * 255).max() <= 0.5 + 1e-3


# ── what tools define ────────────────────────────────────────────────────────

KNOWN = {
    "Shadertoy": (
        "a.frag",
        IMAGE,
        {
            "GL_ES": 1,
            "__VERSION__ == 300": 1,
            "GL_FRAGMENT_PRECISION_HIGH": 1,
            "HW_PERFORMANCE == 1": 1,
            "SHADER_TOY": 0,
            "defined(GL_ARB_gpu_shader5)": 0,
        },
    ),
    "VS Code": (
        "a.frag",
        f'#iChannel0 "self"\n{IMAGE}',
        {"GL_ES": 1, "__VERSION__ == 300": 1, "defined(SHADER_TOY)": 1, "HW_PERFORMANCE": 0},
    ),
    "The Book of Shaders": (
        "a.frag",
        "uniform vec2 u_resolution;\nvoid main() {\n"
        "gl_FragColor = vec4(gl_FragCoord.xy / u_resolution, 0.25, 1.0); }",
        {"GL_ES": 1, "__VERSION__ == 100": 1, "defined(GL_OES_standard_derivatives)": 1},
    ),
    "desktop": (
        "a.frag",
        "#version 330\nuniform vec2 u_resolution;\nin vec2 uv; out vec4 c;\nvoid main() {\n"
        "c = vec4(gl_FragCoord.xy / u_resolution, 0.25, 1.0); }",
        {"defined(GL_ES)": 0, "__VERSION__ == 330": 1},
    ),
    "ISF": (
        "a.fs",
        f"{ISF}void main() {{\ngl_FragColor = vec4(isf_FragNormCoord, 0.25, 1.0); }}",
        {"defined(GL_ES)": 0, "__VERSION__ >= 330": 1},
    ),
}


@pytest.mark.parametrize("name", KNOWN)
def test_a_text_may_ask_what_its_tool_defines(drawn, name):
    file, text, conditions = KNOWN[name]
    for condition, holds in conditions.items():
        choice = f"\n#if {condition}\n{{}}\n#else\n{{}}\n#endif\n"
        first, second = ("0.25", "0.75") if holds else ("0.75", "0.25")
        check(drawn(text.replace("0.25", choice.format(first, second)), file))


def test_a_macro_s_uniform_is_a_parameter(drawn, folder):
    text = "#define KNOB(n, v) uniform float n = v;\nKNOB(level, 0.25)\n/* uniform float other; */\n"
    check(drawn(f"{text}{IMAGE.replace('0.25', 'level')}"))
    parameters = load(folder.path / "a.frag").graph.find("view").technique.parameters
    assert [(p.name, p.default) for p in parameters] == [("level", 0.25)]


def test_a_keyboard_that_a_comment_asks_for_is_not_there(drawn, folder):
    for asks, there in (("/*\n#iKeyboard\n*/", False), ("#iKeyboard", True)):
        check(drawn(f'#iChannel0 "self"\n{asks}\n{IMAGE}'))
        kernels = kernels_of(load(folder.path / "a.frag").graph.find("view").technique)
        assert any(bool(kernel.helpers) for _, kernel in kernels) == there
