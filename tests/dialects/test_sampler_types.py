"""A channel is what a text reads it as: a picture, a cube map at three coordinates, or a volume."""

from __future__ import annotations

import pytest

from playground.dialects.shadertoy import sampler_types

DECLARED = """
vec3 direction(vec2 p) { return vec3(p, 1.0); }
vec2 place(vec3 p) { return p.xy; }
mat3 camera;
const float far = 10.0, near = 1e-3;
void mainImage(out vec4 c, in vec2 fragCoord) {
    vec2 uv = fragCoord / iResolution.xy, other;
    vec3 rd = normalize(vec3(uv, 1.0)), n = rd, ref = reflect(rd, n);
    vec4 four;
    c = LOOKUP;
}
"""


@pytest.mark.parametrize(
    "lookup",
    [
        "texture(iChannel0, rd)",
        "texture(iChannel0, ref, 1.0)",
        "textureLod(iChannel0, -rd, 0.0)",
        "texture( iChannel0 , reflect(rd, n) )",
        "texture(iChannel0, vec3(uv, 0.5))",
        "texture(iChannel0, normalize(rd * 2.0 + 0.5))",
        "texture(iChannel0, camera * rd)",
        "texture(iChannel0, direction(uv))",
        "texture(iChannel0, four.xyz)",
        "texture(iChannel0, (rd))",
        "texture(iChannel0, rd.xzy * 1e-3)",
        "texture(iChannel0, mix(rd, n, 0.5))",
        "texture(iChannel0, cross(rd, n))",
        "textureCube(iChannel0, rd)",
        "texture(iChannel0, rd) + texture(iChannel1, uv)",
    ],
)
def test_three_coordinates_are_a_cube(lookup):
    assert sampler_types(DECLARED.replace("LOOKUP", lookup)) == {"iChannel0": "samplerCube"}


@pytest.mark.parametrize(
    "lookup",
    [
        "texture(iChannel0, uv)",
        "texture(iChannel0, uv * near)",
        "texture(iChannel0, rd.xy)",
        "texture(iChannel0, place(rd))",
        "texture(iChannel0, fragCoord / iResolution.xy)",
        "texture(iChannel0, vec2(rd.x, n.y) * 0.5 + vec3(1.0).xy)",
        "texture(iChannel0, fract(uv - 0.5))",
        "texture(iChannel0, UNKNOWN)",
        "texelFetch(iChannel0, ivec2(rd), 0)",
        "texture(iChannel0, other, 1.0)",
        "texture(iChannel0, rd) + texture(iChannel0, uv)",
        "texture(iChannel0, (rd",
    ],
)
def test_two_or_unknown_ones_are_none(lookup):
    assert sampler_types(DECLARED.replace("LOOKUP", lookup)) == {}


def test_the_latest_declaration_counts():
    text = "vec4 a(vec2 p) { return texture(iChannel0, p); } vec4 b(vec3 p) { return texture(iChannel1, p); }"
    assert sampler_types(text) == {"iChannel1": "samplerCube"}


@pytest.mark.parametrize(
    ("lookup", "types"),
    [
        ("{ vec3 p = vec3(0.0); } c = texture(iChannel0, p);", {}),
        ("for (vec3 p = vec3(0.0); p.x < 1.0;) c = texture(iChannel0, p);", {"iChannel0": "samplerCube"}),
        ("Ray ray; c = texture(iChannel0, ray.along);", {"iChannel0": "samplerCube"}),
        ("ivec3 cell; c = texelFetch(iChannel0, cell, 0);", {"iChannel0": "sampler3D"}),
        ("c = texture(iChannel0, p / iChannelResolution[0].xy);", {}),
        ("c = texture(iChannel0, iResolution * p.x);", {"iChannel0": "samplerCube"}),
    ],
)
def test_a_coordinate_has_the_type_of_its_scope(lookup, types):
    head = "struct Ray { vec3 along; };\nvoid mainImage(out vec4 c, vec2 p) { "
    assert sampler_types(f"{head}{lookup} }}") == types


TAKES = """
#define SKY iChannel2
vec3 cube(samplerCube k, vec3 u) { return texture(k, u).rgb; }
float volume(in vec3 at, const in highp sampler3D v) { return texture(v, at).r; }
vec4 either(sampler2D s, vec2 u);
vec4 either(samplerCube s, vec3 u) { return texture(s, u); }
vec4 flat_one(sampler2D s) { return texture(s, vec2(0.5)); }
void mainImage(out vec4 c, in vec2 fragCoord) { vec3 rd; vec2 uv; c = vec4(LOOKUP); }
"""


@pytest.mark.parametrize(
    ("lookup", "types"),
    [
        ("cube(iChannel0, rd)", {"iChannel0": "samplerCube"}),
        ("volume(fract(rd * (1.0, 2.0)), iChannel1)", {"iChannel1": "sampler3D"}),
        ("cube(SKY, rd) + cube( iChannel3 , rd)", {"iChannel2": "samplerCube", "iChannel3": "samplerCube"}),
        ("either(iChannel0, rd)", {"iChannel0": "samplerCube"}),
        ("either(iChannel0, uv)", {}),
        ("flat_one(iChannel0) + texture(SKY, rd)", {"iChannel2": "samplerCube"}),
        ("cube(iChannel0, rd) + texture(iChannel0, UNKNOWN)", {"iChannel0": "samplerCube"}),
        ("cube(iChannel0, rd) + texture(iChannel0, uv)", {}),
        ("volume(rd, iChannel0) + texture(iChannel0, rd)", {"iChannel0": "sampler3D"}),
        ("texelFetch(iChannel0, ivec3(rd), 0)", {"iChannel0": "sampler3D"}),
        ("texelFetch(iChannel0, ivec2(uv), 0)", {}),
    ],
)
def test_a_function_that_takes_a_channel_says_its_type(lookup, types):
    assert sampler_types(TAKES.replace("LOOKUP", lookup)) == types


@pytest.mark.parametrize(
    ("macros", "lookup", "types"),
    [
        ("#define T(s, p) texture(s, p)", "T(iChannel0, rd)", {"iChannel0": "samplerCube"}),
        ("#define T(p) texture(S, p)\n#define S iChannel1", "T(rd)", {"iChannel1": "samplerCube"}),
        ("#define T(s, p) texture(s, (p).xy)", "T(iChannel0, rd)", {}),
        ("#define SKY texture(iChannel0, rd)", "SKY", {"iChannel0": "samplerCube"}),
        ("#define T(s, p) texelFetch(s, ivec3(p), 0)", "T(iChannel2, rd)", {"iChannel2": "sampler3D"}),
        (
            "#define S iChannel0\n#undef S\n#define S iChannel1",
            "texture(S, rd)",
            {"iChannel1": "samplerCube"},
        ),
    ],
)
def test_macros_look_up_what_they_stand_for(macros, lookup, types):
    assert sampler_types(f"{macros}\n{DECLARED.replace('LOOKUP', lookup)}") == types
