"""Macros and branches that are off, in shaders of other tools: what a preprocessor leaves out is no code."""

from __future__ import annotations

import numpy as np
import pytest

from playground.dialects.table import dialect_of

from .drawing import drawn, ramp

PICTURE = "vec4(p / iResolution.xy, 0.25, 1.0)"
IMAGE = f"void mainImage(out vec4 c, in vec2 p) {{ c = {PICTURE}; }}\n"
MAIN = "out vec4 o;\nvoid main() { mainImage(o, gl_FragCoord.xy); }\n"
ISF = '/*{"CATEGORIES": ["a"]}*/\n'


@pytest.fixture
def check(any_engine, folder):
    """Give a function that draws a text and compares it with the place of each pixel."""

    def of(text, name="a.frag"):
        picture = drawn(any_engine, folder.write(name, text))
        assert np.abs(picture[..., :2] - 255 * ramp()).max() <= 0.5 + 1e-3
        assert (picture[..., 2:] == [64, 255]).all()

    return of


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
def test_a_main_that_is_off_is_none(check, name, first):
    off = OFF[name].format(MAIN)
    text = f"{off}{IMAGE}" if first else f"{IMAGE}{off}"
    assert dialect_of(text).name == "shadertoy"
    check(text)


def test_a_hash_of_whole_numbers_is_that_of_numpy(any_engine, folder):
    text = "#define HASH_T uvec3(1597334673u, 3812015801u, 2798796415u)\n"
    text += "float h(uvec3 q) { q *= HASH_T; return float(q.x ^ q.y ^ q.z) / 4294967295.0; }\n"
    text += IMAGE.replace(PICTURE, "vec4(h(uvec3(p, iFrame)))")
    result = drawn(any_engine, folder.write("a.frag", text))[..., 0]
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
def test_a_text_may_ask_what_its_tool_defines(check, name):
    file, text, conditions = KNOWN[name]
    for condition, holds in conditions.items():
        choice = f"\n#if {condition}\n{{}}\n#else\n{{}}\n#endif\n"
        first, second = ("0.25", "0.75") if holds else ("0.75", "0.25")
        check(text.replace("0.25", choice.format(first, second)), file)
