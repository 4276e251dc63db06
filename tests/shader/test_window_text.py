"""A kernel's text for a window of a picture: what it reads at its own texel alone can be drawn in parts."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.shader.kernel import Input, TexelKernel
from playground.shader.source import read_source
from playground.shader.window_text import for_window

HEAD = "uniform sampler2D sun; uniform sampler2D moon;\n"


def window(folder: Path, text: str) -> str:
    """Return the text of a kernel for a window, of which ``sun`` is as large as the picture; or why not."""
    (folder / "k.glsl").write_text(HEAD + text, encoding="utf-8")
    source = read_source(folder / "k.glsl", (folder,))
    kernel = TexelKernel("main", source, (), inputs=(Input("sun"), Input("moon")), repeat="1")
    result = for_window(kernel, ("sun",))
    return result if isinstance(result, str) else result.source.code.removeprefix(HEAD).rstrip()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("return texelFetch(sun, t, 0);", "return texelFetch(sun, k_local, 0);"),
        ("return texelFetch( sun,t ,0 ).rrrr;", "return texelFetch( sun,k_local ,0 ).rrrr;"),
        ("return vec4(textureSize(sun, 0), t);", "return vec4(size, t);"),
        ("return texelFetch(moon, t + 1, 0);", "return texelFetch(moon, t + 1, 0);"),
        (
            "{ vec2 sun = vec2(1e5); return vec4(sun, sun); }",
            "{ vec2 sun = vec2(1e5); return vec4(sun, sun); }",
        ),
        (
            "return vec4(matches_moon);",
            "return vec4((wired_moon && textureSize(moon, 0) == size));",
        ),
    ],
)
def test_what_is_read_at_its_own_texel(tmp_path: Path, text: str, expected: str):
    head = "vec4 kernel(ivec2 k_local) { ivec2 t = k_local + k_window;"
    assert window(tmp_path, f"vec4 kernel(ivec2 t) {{ {text} }}") == f"{head} {expected} }}"


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("vec4 kernel(ivec2 t) { return texelFetch(sun, t + 1, 0); }", "'sun'"),
        ("vec4 kernel(ivec2 t) { return texelFetch(sun, t.yx, 0); }", "'sun'"),
        ("vec4 kernel(ivec2 t) { { ivec2 t = ivec2(0); return texelFetch(sun, t, 0); } }", "'sun'"),
        (
            "vec4 at(ivec2 t) { return texelFetch(sun, t, 0); } vec4 kernel(ivec2 t) { return at(t); }",
            "'sun'",
        ),
        ("#define HERE texelFetch(sun, t, 0)\nvec4 kernel(ivec2 t) { return HERE; }", "'sun'"),
        ("vec4 kernel(ivec2 t) { t.x += 1; return texelFetch(sun, t, 0); }", "'t'"),
        ("void f(out ivec2 a) { a = ivec2(0); } vec4 kernel(ivec2 t) { f(t); return vec4(t, t); }", "'t'"),
        ("vec4 kernel(ivec2 t) { return previous(t); }", "iteration"),
        ("bool f() { return matches_moon; } vec4 kernel(ivec2 t) { return vec4(f()); }", "matches"),
    ],
)
def test_what_cannot_be_drawn_in_parts_is_named(tmp_path: Path, text: str, named: str):
    why = window(tmp_path, text)
    assert named in why and "kernel" not in why
