"""Texts whose reading could take minutes are read in seconds, and numbers of any length refused or read."""

from __future__ import annotations

import json
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


# ── A number of thousands of digits, wherever a file may have one, is one message and no traceback


LONG = "9" * 4_400
HEX = "0x" + "F" * 5_000
TOY = "void mainImage(out vec4 c, in vec2 p) { c = vec4(p, 0.0, 1.0); }"
ISF = '/*{"ISFVSN": "2",\n%s\n}*/\nvoid main() { gl_FragColor = vec4(isf_FragNormCoord, 0.0, 1.0); }'
OWN = '#pragma kernel(output = "height:r32f")\nuniform %s\nfloat kernel(ivec2 texel) { return 0.5; }\n'
BUFFER = (
    "uniform sampler2D u_buffer0; // %s\nvoid main() {\n#ifdef BUFFER_%s\n    gl_FragColor = vec4(1.0);\n"
    "#else\n    gl_FragColor = texture2D(u_buffer0, gl_FragCoord.xy);\n#endif\n}\n"
)

REFUSED = {
    "default.fs": (
        ISF % f'"INPUTS": [{{"NAME": "a", "TYPE": "float", "DEFAULT": {LONG}}}]',
        "4400 digits",
        2,
    ),
    "hex.fs": (ISF % f'"PASSES": [{{"TARGET": "q", "WIDTH": "{HEX}"}}, {{}}]', "longer than 500 char", 2),
    "size.fs": (ISF % f'"PASSES": [{{"TARGET": "q", "WIDTH": "{LONG}"}}, {{}}]', "longer than 500 char", 2),
    "x.json": (f'{{"renderpass": [],\n"x": {LONG}}}', "4400 digits", 2),
    "deep.json": ('{"renderpass": ' + "[" * 100 + "]" * 100 + "}", "nested deeper", 0),
    "s.toml": (f'format = 1\nsize = {LONG}\n[view]\nuse = "./t"\n', "4400 digits", 2),
    "h.toml": (f'format = 1\nsize = {HEX}\n[view]\nuse = "./t"\n', "size", 2),
    "k.glsl": (OWN % f"float a = {LONG};", "must be a literal", 2),
    "r.glsl": (OWN % f"float a = 0.5; //! slider(0, {LONG})", "slider of 'a'", 2),
    "u.frag": (f"#iUniform int a = {LONG} in {{ 0, 1 }}\n{TOY}", "expected a number", 1),
    "l.frag": (f"#iUniform int a = 1 in {{ 0, {'9' * 400} }}\n{TOY}", "expected a number", 1),
}
READ = {
    "m.fs": ISF % f'"INPUTS": [{{"NAME": "a", "TYPE": "float", "DEFAULT": {"9" * 400}}}]',
    "v.frag": f"#version {LONG}\nout vec4 o;\nvoid main() {{ o = vec4(1.0); }}",
    "a.frag": f"uniform sampler2D t[{LONG}];\n{TOY.replace('0.0', 'texture(t[0], p).x')}",
    "b.frag": BUFFER % (f"{LONG}x{LONG}", LONG),
    "f.frag": BUFFER % (f"{LONG}.5", "0"),
    "channel.json": json.dumps(
        {"renderpass": [{"code": TOY, "name": "Image", "type": "image"}], "x": 10**300}
    ),
}


@pytest.mark.room("dialects")
@pytest.mark.parametrize("name", REFUSED)
def test_a_long_number_is_one_sentence_at_its_line(folder, name):
    text, words, line = REFUSED[name]
    folder.write("t.frag", TOY)
    with pytest.raises(PlaygroundError) as caught:
        load(folder.write(name, text))
    (result,) = caught.value.diagnostics
    assert words in result.message and "\n" not in result.message
    assert (result.file.endswith(name), result.line) == (True, line)


@pytest.mark.room("dialects")
@pytest.mark.parametrize("name", READ)
def test_a_long_number_that_means_nothing_here_is_read(folder, name):
    assert load(folder.write(name, READ[name])).graph.passes
