"""One text, two drivers, the same bits: small kernels that try what kernels may do."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.shader.kernel import FORMATS

from ..sketch_texts import passes

BODY = "\n" + passes(start="./start", a="./one")
START = """#pragma kernel(output = "start:rgba32f")
uint scrambled(uint x) { x ^= x >> 16; x *= 0x7feb352du; x ^= x >> 15; x *= 0x846ca68bu;
    return x ^ (x >> 16); }
vec4 kernel(ivec2 texel) {
    uint h = scrambled(uint(texel.x) + scrambled(uint(texel.y)));
    return vec4(h & 255u, (h >> 8) & 255u, (h >> 16) & 255u, h >> 24) / 255.0 * 3.0 - 1.0;
}
"""


@pytest.fixture
def both(ctx):
    """Give a function that reads a texture by each driver, and sees that the bits agree."""
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")

    def read(sketch, ref="a", **named):
        with Engine(ctx, driver="fragment") as engine, Engine(ctx, driver="compute") as two:
            first, second = engine.read(sketch, ref, **named), two.read(sketch, ref, **named)
        np.testing.assert_array_equal(first.view(np.uint32), second.view(np.uint32))
        return first

    return read


@pytest.mark.parametrize("size", ["size = 17", "size = [64, 3]", "size = 1"])
@pytest.mark.parametrize("form", FORMATS)
def test_every_format(both, folder, form, size):
    letters = form.rstrip("0123456789f")
    kind, swizzle = {"r": ("float", "r"), "rg": ("vec2", "rg"), "rgba": ("vec4", "rgba")}[letters]
    folder.write("start.glsl", START)
    folder.write(
        "one.glsl",
        f'#pragma kernel(output = "a:{form}", repeat = "2")\nuniform sampler2D start; //! input\n'
        f"{kind} kernel(ivec2 texel) {{\n"
        f"    {kind} other = texelFetch(start, texel, 0).{swizzle};\n"
        "    if (iteration == 0) return other * 0.4;\n"
        "    return previous(texel) * 0.9 + previous(texel + ivec2(1, 0)) * 0.25;\n"
        "}\n",
    )
    result = both(folder.sketch(BODY, size=size))
    assert np.isfinite(result).all()
    if form.endswith(("8", "16")):
        assert result.min() >= 0.0
        assert result.max() <= 1.0
    elif result.size > 100:
        assert result.min() < 0.0


CHECKS = {
    "mathematics": """
    return sin(v.x * 9.0) + exp2(v.y) + pow(abs(v.z), 1.7) + atan(v.x, v.y) + inversesqrt(abs(v.w) + 0.1);""",
    "products": """
    vec3 n = normalize(v.xyz);
    return dot(n, vec3(0.3, 0.5, 0.8)) * length(v) + mix(v.x, v.y, fract(v.z));""",
    "whole numbers": """
    int i = int(v.x * 100.0);
    uint u = floatBitsToUint(v.y);
    return float((i << 3) ^ int(u & 1023u)) + float(i / 7 % 5);""",
    "branches": """
    float s = 0.0;
    for (int i = 0; i < 40; i++) {
        if (s > 5.0) break;
        s += abs(v[i & 3]);
    }
    return s;""",
    "matrices": """
    mat2 m = mat2(v.x, v.y, v.z, v.w);
    vec2 r = m * vec2(1.0, 2.0);
    return determinant(m) + r.x / (r.y + 4.0);""",
    "the size": """
    float share = float(texel.x) / float(size.x) + float(size.y) * 0.5;
    return share + spacing.x * 0.001 + relief * 1e-4 + time;""",
    "extremes": """
    return texel.x == 3 ? 1.0 / 0.0 : texel.x == 4 ? -1.0 / 0.0 : v.x * 1e30;""",
}


@pytest.mark.parametrize("name", CHECKS)
def test_every_sort_of_arithmetic(both, folder, name):
    folder.write("start.glsl", START)
    folder.write(
        "one.glsl",
        '#pragma kernel(output = "a:r32f")\nuniform sampler2D start; //! input\n'
        f"float kernel(ivec2 texel) {{\n    vec4 v = texelFetch(start, texel, 0);\n    {CHECKS[name]}\n}}\n",
    )
    both(folder.sketch(BODY), time=0.3)


@pytest.mark.parametrize("way", ["nearest", "linear"])
@pytest.mark.parametrize("wrap", ["clamp", "repeat"])
def test_every_way_to_read_a_texture(both, folder, way, wrap):
    folder.write("start.glsl", START)
    folder.write(
        "one.glsl",
        f'#pragma kernel(output = "a:rgba32f")\n'
        f'uniform sampler2D start; //! input("{way}", "{wrap}", "mipmap")\n'
        "vec4 kernel(ivec2 texel) {\n"
        "    vec2 uv = (vec2(texel) * 1.37 - 3.0) / vec2(textureSize(start, 0));\n"
        "    vec4 between = 0.1 * textureLod(start, uv, 1.5);\n"
        "    return textureLod(start, uv, 0.0) + textureLod(start, uv, 1.0) + between;\n"
        "}\n",
    )
    result = both(folder.sketch(BODY))
    assert result.std() > 0.1


TYPES = {
    "float": "0.7",
    "int": "-3",
    "uint": "4294967295u",
    "bool": "true",
    "vec2": "vec2(0.1, 0.2)",
    "vec3": "vec3(0.1, 0.2, 0.3)",
    "vec4": "vec4(0.1, 0.2, 0.3, 0.4)",
    "ivec2": "ivec2(-1, 2)",
    "ivec3": "ivec3(-1, 2, 3)",
    "ivec4": "ivec4(-1, 2, 3, 4)",
    "uvec2": "uvec2(1u, 4000000000u)",
    "uvec3": "uvec3(1u, 2u, 3u)",
    "uvec4": "uvec4(1u, 2u, 3u, 4u)",
}


@pytest.mark.parametrize("kind", TYPES)
def test_every_type_of_parameter_arrives(both, folder, kind):
    """The kernel compares what arrives with what its own initialiser says."""
    sketch = folder.one(
        f'#pragma kernel(output = "a:r32f")\nuniform {kind} value = {TYPES[kind]};\n'
        f"float kernel(ivec2 texel) {{ {kind} expected = {kind}({TYPES[kind]}); "
        f"return value == expected ? 1.0 : 0.0; }}\n"
    )
    assert np.all(both(sketch) == 1.0)


def test_several_outputs_of_several_formats(both, folder):
    sketch = folder.one(
        '#pragma kernel(output = "x:r8, y:rg16f, z:rgba32f, w:r16", repeat = "3")\n'
        "void kernel(ivec2 texel, out float x, out vec2 y, out vec4 z, out float w) {\n"
        "    x = previous_x(texel) + 0.1; y = previous_y(texel + ivec2(1)) + vec2(texel) * 0.1;\n"
        "    z = previous_z(texel) + vec4(x, y, 1.0);\n"
        "    w = previous_w(texel - ivec2(1)) + 0.01 * float(texel.x);\n"
        "}\n"
    )
    for output in "xyzw":
        both(sketch, f"a:{output}")


def test_an_input_that_nothing_is_wired_to_has_its_fallback(both, folder):
    sketch = folder.one(
        '#pragma kernel(output = "a:rgba32f")\nuniform sampler2D p; //! input("white")\n'
        'uniform sampler2D q; //! input("black")\n'
        "vec4 kernel(ivec2 texel) { return vec4(texelFetch(p, ivec2(0), "
        "0).rg, texelFetch(q, ivec2(0), 0).ra); }\n"
    )
    np.testing.assert_array_equal(both(sketch)[2, 2], (1.0, 1.0, 0.0, 1.0))
