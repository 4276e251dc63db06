"""Which inputs a text reads by ``texelFetch`` alone, and which of its fetches read one texel."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.shader.sampler_reads import fetched_alone, fixed_texels, read_by_texels_alone
from playground.shader.source import SourceText, read_source
from playground.sketch.model import Input, TexelKernel

HEAD = """uniform sampler2D sun;
uniform sampler2D moon;
uniform sampler2D image;
"""
BOTH = {"sun", "moon"}
AT = "float at(sampler2D which, ivec2 t) { return ■texelFetch(which, t, 0).r; }\n"
TEXTS = {
    # How an input is read: a text, each fetch that is found marked; the inputs that are read by nothing else.
    "in the kernel": ("float kernel(ivec2 t) { return ■texelFetch(sun, t, 0).r; }", BOTH),
    "at a place with calls and brackets": (
        "float kernel(ivec2 t) {\n"
        "    return ■texelFetch( sun,clamp(ivec2(t[0], max(t.y, 1)), ivec2(0), textureSize(sun, 0)), 0 ).r"
        " + ■texelFetch(moon, t, 0).g; }",
        BOTH,
    ),
    "by a function that is handed both": (
        f"{AT}float kernel(ivec2 t) {{ return at(sun, t) + at(moon, t + 1); }}",
        BOTH,
    ),
    "down a chain, with other names": (
        f"{AT}float twice(float by, sampler2D one) {{ return by * at(one, ivec2(2)); }}\n"
        "float kernel(ivec2 t) { return twice(float(t.x), sun); }",
        BOTH,
    ),
    "by a function that calls itself": (
        "float at(sampler2D sun, int n) { return n > 0 ? at(sun, --n) : ■texelFetch(sun, ivec2(7), 0).r; }\n"
        "float kernel(ivec2 t) { return at(sun, 3); }",
        BOTH,
    ),
    "in a call within a call": (
        f"{AT}float kernel(ivec2 t) {{ return max(at(sun, ivec2(at(moon, t), 0)), 1.0); }}",
        BOTH,
    ),
    "beside a variable of its name": (
        "float near(float moon, ivec2 t) { return max(moon, 1.0) * (moon + float(t.x)); }\n"
        "float kernel(ivec2 t) { vec2 sun = vec2(2.0, 3.0); return near(sun.x, ivec2(sun)); }\n"
        "float other(ivec2 t) { return ■texelFetch(sun, t, 0).r + ■texelFetch(moon, t, 0).r; }",
        BOTH,
    ),
    "in brackets": (
        "float at(sampler2D which, ivec2 t) { return texelFetch(which, t, 0).r; }\n"
        "float kernel(ivec2 t) { return at((sun), t) + ■texelFetch(moon, t, 0).r; }",
        {"moon"},
    ),
    "by another function of GLSL": (
        "float kernel(ivec2 t) { return texelFetch(sun, t, 0).r + texelFetchOffset(sun, t, 0, t).r"
        " + textureGrad(moon, vec2(t), vec2(0.0), vec2(0.0)).r; }",
        set(),
    ),
    "by another level": ("float kernel(ivec2 t) { return texelFetch(sun, t, 1).r; }", {"moon"}),
    "by a level that is worked out": (
        "float kernel(ivec2 t) { return texelFetch(sun, t, t.x).r; }",
        {"moon"},
    ),
    "and filtered": (
        "float kernel(ivec2 t) { return texelFetch(sun, t, 0).r + textureLod(sun, vec2(t), 0.0).r"
        " + ■texelFetch(moon, t, 0).r; }",
        {"moon"},
    ),
    "and filtered by a function": (
        "float at(sampler2D sun) { return textureLod(sun, vec2(0.5), 0.0).r; }\n"
        "float kernel(ivec2 t) { return texelFetch(sun, t, 0).r + at(sun) + ■texelFetch(moon, t, 0).r; }",
        {"moon"},
    ),
    "by a function that may be handed one that is filtered": (
        "float at(sampler2D which, ivec2 t) { return texelFetch(which, t, 0).r; }\n"
        "float kernel(ivec2 t) { return at(sun, t) + at(moon, t) + textureLod(moon, vec2(t), 0.0).r; }",
        {"sun"},
    ),
    "by a function that may be handed an image file": (
        "float at(sampler2D which, ivec2 t) { return texelFetch(which, t, 0).r; }\n"
        "float kernel(ivec2 t) { return at(sun, t) + at(image, t); }",
        BOTH,
    ),
    "by one of two functions of a name, of which the other filters": (
        "float at(sampler2D which, ivec2 t) { return texelFetch(which, t, 0).r; }\n"
        "float at(sampler2D which, vec2 t) { return textureLod(which, t, 0.0).r; }\n"
        "float kernel(ivec2 t) { return at(sun, t) + ■texelFetch(moon, t, 0).r; }",
        {"moon"},
    ),
    "by a function that nothing calls": (
        "float at(sampler2D which, ivec2 t) { return texelFetch(which, t, 0).r; }\n"
        "float kernel(ivec2 t) { return ■texelFetch(moon, t, 0).r; }",
        BOTH,
    ),
    "by a macro": (
        "#define AT(t) texelFetch(sun, t, 0)\nfloat kernel(ivec2 t) { return AT(t).r; }",
        set(),
    ),
    "by a macro that is handed it": (
        "#define AT(s) texelFetch(s, ivec2(0), 0)\nfloat kernel(ivec2 t) { return AT(sun).r; }",
        set(),
    ),
    "by a function that a macro calls": (
        "float at(sampler2D which) { return texelFetch(which, ivec2(0), 0).r; }\n"
        "#define FIRST at\nfloat kernel(ivec2 t) { return FIRST(sun) + at(moon); }",
        set(),
    ),
    "by what a macro makes of the name": (
        "#define texelFetch(s, p, l) textureLod(s, vec2(p), 0.0)\n"
        "float kernel(ivec2 t) { return texelFetch(sun, t, 0).r; }",
        set(),
    ),
    "by a function that returns several numbers": (
        "float[2] two(sampler2D which, vec2 p) { return float[2](textureLod(which, p, 0.0).r, 0.0); }\n"
        "float kernel(ivec2 t) { return texelFetch(sun, t, 0).r + two(sun, vec2(t))[0]; }",
        set(),
    ),
    "by a function with a line end in its argument": (
        "float two(sampler2D\n    which, vec2 p) { return textureLod(which, p, 0.0).r; }\n"
        "float kernel(ivec2 t) { return texelFetch(sun, t, 0).r + two(sun, vec2(t)); }",
        {"moon"},
    ),
    "by a function whose argument has a macro's type": (
        "#define Map sampler2D\nfloat two(Map which, vec2 p) { return textureLod(which, p, 0.0).r; }\n"
        "float kernel(ivec2 t) { return texelFetch(sun, t, 0).r + two(sun, vec2(t)); }",
        set(),
    ),
    "by a function behind a macro": (
        "#define SQUARE(T) T square(T x) { return x * x; }\nSQUARE(vec2)\n"
        "float two(sampler2D which, vec2 p) { return textureLod(which, p, 0.0).r; }\n"
        "float kernel(ivec2 t) { return texelFetch(sun, t, 0).r + two(sun, vec2(t)); }",
        set(),
    ),
    "by a function behind a head that is written twice": (
        "#if 1\nfloat one(float x) {\n#else\nfloat one(float x, float y) {\n#endif\n    return x; }\n"
        "float two(sampler2D which, vec2 p) { return textureLod(which, p, 0.0).r; }\n"
        "float kernel(ivec2 t) { return texelFetch(sun, t, 0).r + two(sun, vec2(t)); }",
        set(),
    ),
    "by a function with brackets in its arguments": (
        "float two(float w[(2)], sampler2D which) { return textureLod(which, vec2(w[0]), 0.0).r; }\n"
        "float kernel(ivec2 t) { return texelFetch(sun, t, 0).r + two(float[2](0.1, 0.2), sun); }",
        set(),
    ),
    "by the text's own function of that name": (
        "vec4 texelFetch(sampler2D which, ivec2 p, int l) { return textureLod(which, vec2(p), 0.0); }\n"
        "float kernel(ivec2 t) { return texelFetch(sun, t, 0).r; }",
        set(),
    ),
    "in a comment": ("float kernel(ivec2 t) { return 1.0; } // texelFetch(sun, t, 0)", set()),
}


def source_of(folder: Path, text: str) -> SourceText:
    (folder / "k.glsl").write_text(HEAD + text + "\n", encoding="utf-8")
    return read_source(folder / "k.glsl", (folder,))


@pytest.mark.parametrize("how", TEXTS)
def test_what_is_read_by_fetches_alone(tmp_path: Path, how: str):
    marked, expected = TEXTS[how]
    source = source_of(tmp_path, marked.replace("■", ""))
    inputs = tuple(Input(name) for name in sorted(BOTH))
    result = fetched_alone(TexelKernel("main", source, (), inputs=inputs))
    lines = [line.code for line in source.lines]
    for line, column in reversed(result.fetches):
        assert lines[line][column:].startswith("texelFetch")
        lines[line] = f"{lines[line][:column]}■{lines[line][column:]}"
    assert "\n".join(lines).split("//")[0].strip() == (HEAD + marked).split("//")[0].strip()
    assert result.inputs == expected


# ── Which fetches of a text read one texel of an input, whatever is computed, and which only look so


FOUND = {
    "in the kernel": ("float kernel(ivec2 t) { return texelFetch(sun, ivec2(3), 0).r; }", [("sun", 3, 3)]),
    "two places on a line": (
        "float kernel(ivec2 t) { return texelFetch(sun, ivec2(2, 5), 0).r"
        " + texelFetch( moon,ivec2(0) , 0 ).g; }",
        [("sun", 2, 5), ("moon", 0, 0)],
    ),
    "by a function that is handed it under its own name": (
        "float at(sampler2D sun) { return texelFetch(sun, ivec2(1, 0), 0).r; }\n"
        "float kernel(ivec2 t) { return at(sun) * at( sun ); }",
        [("sun", 1, 0)],
    ),
    "down a chain of functions": (
        "float at(int k, sampler2D sun) { return texelFetch(sun, ivec2(1, 0), 0).r; }\n"
        "float twice(sampler2D sun, vec2 p[2]) { return at(int(p[0].x), sun) * 2.0; }\n"
        "float kernel(ivec2 t) { return twice(sun, vec2[2](vec2(1.0, 2.0), vec2(0.0))); }",
        [("sun", 1, 0)],
    ),
    "by a function that a prototype announces": (
        "float at(sampler2D sun);\nfloat kernel(ivec2 t) { return at(sun); }\n"
        "float at(sampler2D sun) { return texelFetch(sun, ivec2(4), 0).r; }",
        [("sun", 4, 4)],
    ),
    "by a function that calls itself": (
        "float at(sampler2D sun, int n) { return n > 0 ? at(sun, n - 1) : texelFetch(sun, ivec2(7), 0).r; }\n"
        "float kernel(ivec2 t) { return at(sun, 3); }",
        [("sun", 7, 7)],
    ),
}
LEFT = {
    "at a place that is worked out": "float kernel(ivec2 t) { return texelFetch(sun, ivec2(0, t.y), 0).r; }",
    "of another level": "float kernel(ivec2 t) { return texelFetch(sun, ivec2(0), 1).r; }",
    "in a comment": "float kernel(ivec2 t) { return 1.0; } // texelFetch(sun, ivec2(0), 0)",
    "by a function that is handed another": (
        "float at(sampler2D sun) { return texelFetch(sun, ivec2(1, 0), 0).r; }\n"
        "float kernel(ivec2 t) { return at(sun) * at(moon); }"
    ),
    "by a function that is handed another further up": (
        "float at(sampler2D sun) { return texelFetch(sun, ivec2(1, 0), 0).r; }\n"
        "float twice(sampler2D sun) { return at(sun) * 2.0; }\n"
        "float kernel(ivec2 t) { return twice(moon); }"
    ),
    "by a function whose argument has a name of its own": (
        "float at(sampler2D which) { return texelFetch(which, ivec2(1, 0), 0).r; }\n"
        "float kernel(ivec2 t) { return at(sun); }"
    ),
    "by one of two functions of a name": (
        "float at(sampler2D sun) { return texelFetch(sun, ivec2(1, 0), 0).r; }\n"
        "float at(sampler2D moon, int n) { return 1.0; }\n"
        "float kernel(ivec2 t) { return at(sun) + at(moon, 2); }"
    ),
    "by a macro": (
        "#define AT(sun) \\\n    texelFetch(sun, ivec2(0), 0)\nfloat kernel(ivec2 t) { return AT(moon).r; }"
    ),
    "by a function that a macro calls": (
        "float at(sampler2D sun) { return texelFetch(sun, ivec2(1, 0), 0).r; }\n#define AT at\n"
        "float kernel(ivec2 t) { return AT(moon) + at(sun); }"
    ),
    "of a name that a macro changes": (
        "#define sun moon\nfloat kernel(ivec2 t) { return texelFetch(sun, ivec2(0), 0).r; }"
    ),
}


def texels(folder: Path, text: str) -> list[tuple[str, int, int]]:
    path = folder / "k.glsl"
    path.write_text(HEAD + text + "\n", encoding="utf-8")
    source = read_source(path, (folder,))
    result = fixed_texels(source)
    for item in result:
        written = source.lines[item.line].code[item.start : item.end]
        assert written.startswith("texelFetch") and written.endswith(")") and item.input in written
    return [(item.input, item.x, item.y) for item in result]


@pytest.mark.parametrize("where", FOUND)
def test_a_fetch_of_one_texel_of_an_input_is_found(tmp_path: Path, where: str):
    text, expected = FOUND[where]
    assert texels(tmp_path, text) == expected


@pytest.mark.parametrize("where", LEFT)
def test_what_may_be_another_texel_is_left_alone(tmp_path: Path, where: str):
    assert texels(tmp_path, LEFT[where]) == []


ALONE = {
    "in the kernel": ("float kernel(ivec2 t) { return texelFetch(sun, ivec2(3), 0).r; }", {"sun"}),
    "by a function": (
        "float at(bool is, sampler2D sun) { return is ? texelFetch(sun, ivec2(1, 0), 0).a : 0.0; }\n"
        "float kernel(ivec2 t) { return (at(t.x > 0, sun)) + max(at(true, sun), 1.0); }",
        {"sun"},
    ),
    "of two": (
        "float kernel(ivec2 t) { return texelFetch(sun, ivec2(3), 0).r * texelFetch(moon, ivec2(0), 0).r; }",
        {"sun", "moon"},
    ),
    "and elsewhere": (
        "float kernel(ivec2 t) { return texelFetch(sun, ivec2(3), 0).r + texelFetch(sun, t, 0).r; }",
        set(),
    ),
    "and filtered": (
        "float kernel(ivec2 t) { return texelFetch(sun, ivec2(3), 0).r + textureLod(sun, vec2(t), 0.0).r; }",
        set(),
    ),
    "and its size": (
        "float kernel(ivec2 t) { return texelFetch(sun, ivec2(3), 0).r * float(textureSize(sun, 0).x); }",
        set(),
    ),
    "and by a function that calls it otherwise": (
        "float at(sampler2D which) { return textureLod(which, vec2(0.0), 0.0).r; }\n"
        "float kernel(ivec2 t) { return texelFetch(sun, ivec2(3), 0).r * at(sun); }",
        set(),
    ),
    "and by a function at any place": (
        "float at(sampler2D sun, ivec2 t) { return texelFetch(sun, t, 0).r; }\n"
        "float kernel(ivec2 t) { return texelFetch(sun, ivec2(3), 0).r * at(sun, t); }",
        set(),
    ),
    "and by a macro": (
        "#define AT(t) texelFetch(sun, t, 0)\n"
        "float kernel(ivec2 t) { return texelFetch(sun, ivec2(3), 0).r * AT(t).r; }",
        set(),
    ),
}


@pytest.mark.parametrize("how", ALONE)
def test_fixed_texel_inputs_are_detected_from_kernel_text(tmp_path: Path, how: str):
    text, expected = ALONE[how]
    assert read_by_texels_alone(source_of(tmp_path, text)) == expected


@pytest.mark.parametrize(
    ("taken", "components"),
    [(".a", {3}), (" . gr", {0, 1}), (".xyz.zx", {0, 1, 2}), (".st", {0, 1}), ("", {0, 1, 2, 3})],
)
def test_what_a_text_takes_of_a_texel_is_noted(tmp_path: Path, taken: str, components: set[int]):
    text = f"vec4 kernel(ivec2 t) {{ return vec4(texelFetch(sun, ivec2(3), 0){taken}); }}"
    (result,) = fixed_texels(source_of(tmp_path, text))
    assert result.components == components
