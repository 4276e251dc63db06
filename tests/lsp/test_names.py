"""The identifiers of a GLSL text, and what its functions declare."""

from __future__ import annotations

from playground.lsp.shader import syntax_of, words

TEXT = """// A file. float no(int comment);
#ifndef GUARD
#define GUARD
#define TWICE(x) ((x) * 2.0)

struct March {
    vec2 start;  // where
    float far;
};

// How steep it is.
// Not how high.
float steep(vec2 slope, const in March march) {
    float first = slope.x, second[2] = float[2](slope.y, 0.0);
    for (int step = 0; step < 3; step++) { vec2 far = vec2(float(step)); first += far.x; }
    return first + second[0] /* + hidden */ + march.far;
}
float asked(vec2 place);
const float LEAST = 1e-6;
uniform vec3 tint = vec3(1.0);  //! colour
#endif
"""


def test_what_can_be_named_at_a_place_is_known() -> None:
    syntax = syntax_of(TEXT)
    inside = syntax.visible(TEXT.index("first += far"))
    assert [*inside] == ["slope", "march", "first", "second", "step", "far"]
    assert all(TEXT[syntax.place(symbol) :].startswith(name) for name, symbol in inside.items())
    assert [*syntax.visible(TEXT.index("return first"))] == ["slope", "march", "first", "second"]


def test_words_are_those_of_the_code() -> None:
    result = {word.text for word in words('#include "a/b.glsl"\n' + TEXT)}
    assert result >= {"steep", "TWICE", "march", "far"}
    assert not result & {"no", "comment", "hidden", "Not", "glsl", "colour"}


def test_letters_of_numbers_are_no_names() -> None:
    text = "float a = 1e-3 + 2.0f + 3.e5 + .5e3f + 0xFFu + 0Xe1 + 1u + 4.f - e; vec2 b = v1e3.xy * 1E+2;\n"
    assert [word.text for word in words(text)] == ["float", "a", "e", "vec2", "b", "v1e3", "xy"]
