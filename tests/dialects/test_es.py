"""Older GLSL becomes GLSL 3.30 word by word; lines stay, and so does what needs no change."""

from __future__ import annotations

import pytest

from playground.dialects.es import rewritten, version_of
from playground.shader.source import read_source_and_origin


@pytest.fixture
def codes(tmp_path):
    def rewrite(text: str) -> list[str]:
        path = tmp_path / "a.frag"
        path.write_text(text)
        result = rewritten(read_source_and_origin(path, (tmp_path,), foreign=True)[0])
        assert [line.text for line in result.source.lines] == text.split("\n")
        return [line.code for line in result.source.lines]

    return rewrite


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("varying vec2 a;", "in      vec2 a;"),
        ("x = texture2D(s, p);", "x = texture  (s, p);"),
        ("x = textureCubeLodEXT(s, p, 1.0);", "x = textureLod       (s, p, 1.0);"),
        ("x = texture2DProjLodEXT(s, p, 1.0);", "x = textureProjLod     (s, p, 1.0);"),
        ("x = texture2DProjGradARB(s, p, a, b);", "x = textureProjGrad     (s, p, a, b);"),
        ("x = texture3D(s, p) + shadow2D(t, p).r;", "x = texture  (s, p) + texture (t, p).r;"),
        ("x = texture2DRect(s, p);", "x = texture      (s, p);"),
        ("#define read(p) texture2D(s, p)", "#define read(p) texture(s, p)"),
        ("#define look texture2D", "#define look texture"),
        ("gl_FragColor = x;", "k_frag_color = x;"),
        ("gl_FragData[0] = x;", "k_frag_data[0] = x;"),
        ("gl_FragDepthEXT = x;", "gl_FragDepth    = x;"),
        ("#version 120", ""),
        ("#version 310 es", ""),
        ("#extension GL_OES_standard_derivatives : enable", ""),
        ("#pragma once", ""),
        ("precision mediump float;", "precision mediump float;"),
        ("float filter = 1.0; x = filter;", "float filter_ = 1.0; x = filter_;"),
        ("float a, sample = 1.0; x = sample;", "float a, sample_ = 1.0; x = sample_;"),
        ("#define smooth(x) x", "#define smooth_(x) x"),
        ("flat in int which;", "flat in int which;"),
        ("uint a = 1u; switch (a) { case 1u: break; }", "uint a = 1u; switch (a) { case 1u: break; }"),
        ("uniform sampler2D texture;", "uniform sampler2D texture_;"),
        ("vec4 c = texture2D(texture, p); vec2 texture;", "vec4 c = texture  (texture_, p); vec2 texture_;"),
        ("vec4 texture(vec2 p) { return x; }", "vec4 texture(vec2 p) { return x; }"),
        ("float filter_; float filter;", "float filter_; float filter_1;"),
    ],
)
def test_a_line(codes, old, new):
    assert codes(old) == [new]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (
            "uniform sampler2D texture;\n#define read(p) texture2D(texture, p)",
            ["uniform sampler2D texture_;", "#define read(p) texture(texture_, p)"],
        ),
        (
            "vec2 texture;\n#define look texture\n#define call texture(s, p)",
            ["vec2 texture_;", "#define look texture", "#define call texture(s, p)"],
        ),
        (
            "vec4 texture(vec2 p) { return texture2D(s, p); }\nvec4 a = texture(p);",
            ["vec4 texture_(vec2 p) { return texture  (s, p); }", "vec4 a = texture_(p);"],
        ),
        (
            "vec4 texture2D(sampler2D s, vec2 p) { return texture(s, p); }\nvec4 a = texture2D(s, p);",
            ["vec4 texture2D_(sampler2D s, vec2 p) { return texture(s, p); }", "vec4 a = texture2D_(s, p);"],
        ),
        (
            "vec4 texture2D(in lowp sampler2D s,\nvec2 p)\n{ return textureLod(s, p, 0.0); }",
            ["vec4 texture2D_(in lowp sampler2D s,", "vec2 p)", "{ return textureLod(s, p, 0.0); }"],
        ),
        (
            "#define texture2D(s, p) texture(s, p)\nvec4 a() { return texture2D(s, p); }",
            ["#define texture(s, p) texture(s, p)", "vec4 a() { return texture  (s, p); }"],
        ),
    ],
)
def test_what_an_author_calls_texture_is_told_from_the_lookup(codes, old, new):
    assert codes(old) == new


def test_comments_stay_as_they_are_written(codes):
    assert codes("// varying\nfloat a; /* gl_FragColor */ float b; // filter") == [
        "",
        "float a;                    float b;",
    ]


def test_words_are_renamed_only_in_versions_that_have_them_free(codes):
    assert codes("#version 130\nfloat filter;")[1] == "float filter;"
    assert codes("#version 110\nfloat filter;")[1] == "float filter_;"


def test_a_version_from_330_on_stays_with_its_extensions(tmp_path):
    path = tmp_path / "a.frag"
    path.write_text("#version 430 core\n#extension GL_ARB_x : enable\nvarying vec2 a;\n")
    source, _ = read_source_and_origin(path, (tmp_path,), foreign=True)
    result = rewritten(source)
    assert version_of(source) == 430 and result.prelude == ("#extension GL_ARB_x : enable",)
    assert [line.code for line in result.source.lines[:3]] == ["#version 430 core", "", "in      vec2 a;"]


def test_colour_and_data_go_to_one_output(codes):
    assert codes("gl_FragData[1] = a;\ngl_FragColor = b;") == ["k_frag_data[1] = a;", "k_frag_data[0] = b;"]
