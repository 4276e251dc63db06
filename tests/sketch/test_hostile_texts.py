"""Texts whose reading could take minutes, or for ever, are read in seconds."""

from __future__ import annotations

import time

import pytest

from playground.engine.sketch_warnings import warnings_of_kernel
from playground.errors import PlaygroundError
from playground.shader.wrap import FRAGMENT, wrap
from playground.shader.zero_values import with_zeros
from playground.sketch.load import load

IMAGE = "void mainImage(out vec4 c, in vec2 p) {{ {} c = vec4(p, 0, 1); }}\n"


def in_turn(line, count):
    """Return lines, each with its number and the one before it."""
    return "\n".join(line.format(n, n - 1) for n in range(1, count))


TEXTS = {
    "a condition's macros double": "#define M0 1\n"
    + in_turn("#define M{0} (M{1} + M{1})", 40)
    + "\n#if M39 > 1\n#endif\n",
    "macros double": "#define M0 + 1.0\n" + in_turn("#define M{0} M{1} M{1}", 40),
    "brackets of arrays stay open": "float a[;\n" * 4000,
    "calls of macros stay open": "#define M(x) x\n" + "M(\n" * 4000,
    "macros between functions": in_turn("#define M{0}(x) x\nfloat f{0}(float x) {{ return M{0}(x); }}", 700),
    "structs double": "struct S0 { float a; };\n" + in_turn("struct S{0} {{ S{1} a, b; }};", 40),
    "structs in structs": "struct S {" * 2000 + "float a; }" * 2000,
    "a chain of structs": "struct S0 { float a; };\n" + in_turn("struct S{0} {{ S{1} a; }};", 700),
    "a channel handed to many": in_turn("vec4 f{0}(sampler2D s, vec2 p) {{ return texture(s, p); }}", 700),
}
BODIES = {
    "macros double": "float a = M39;",
    "structs double": "S39 a; a.a = a.b;",
    "a chain of structs": "S699 a; c.x = a.a;",
    "a channel handed to many": in_turn("f{0}(iChannel0, p);", 700),
    "quotients of quotients": f"float a = {'1/2*' * 3000}1.0;",
    "quotients in brackets": f"float a = {'(1/' * 2000}2{')' * 2000};",
    "labels of a switch": f"switch (1) {{ {in_turn('case {0}: float a{0}; break;', 500)} }}",
}


@pytest.mark.parametrize("name", [*TEXTS, *(name for name in BODIES if name not in TEXTS)])
def test_a_hostile_text_is_read_in_seconds(folder, name):
    path = folder.write("a.frag", f"{TEXTS.get(name, '')}\n{IMAGE.format(BODIES.get(name, ''))}")
    start = time.process_time()  # of this process: others on the machine do not count
    try:
        kernel = load(path).graph.find("view").technique
        text = with_zeros(wrap(kernel, FRAGMENT, 450)).stages["fragment"].text
        assert len(text) < 10 * path.stat().st_size + 10_000
        warnings_of_kernel(kernel)
    except PlaygroundError:
        pass  # what is wrong with it is said
    assert time.process_time() - start < 5.0  # [s]
