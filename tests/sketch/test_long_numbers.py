"""A number of thousands of digits, wherever a file may have one, is one message and no traceback."""

from __future__ import annotations

import json

import pytest

from playground.errors import PlaygroundError

from ..loading import load

pytestmark = pytest.mark.room("dialects")

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


@pytest.mark.parametrize("name", REFUSED)
def test_a_long_number_is_one_sentence_at_its_line(folder, name):
    text, words, line = REFUSED[name]
    folder.write("t.frag", TOY)
    with pytest.raises(PlaygroundError) as caught:
        load(folder.write(name, text))
    (result,) = caught.value.diagnostics
    assert words in result.message and "\n" not in result.message
    assert (result.file.endswith(name), result.line) == (True, line)


@pytest.mark.parametrize("name", READ)
def test_a_long_number_that_means_nothing_here_is_read(folder, name):
    assert load(folder.write(name, READ[name])).graph.passes
