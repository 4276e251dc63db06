"""What an input that may stay unwired reads: white or black at every texel, by every way to read it."""

from __future__ import annotations

import numpy as np
import pytest

from playground.errors import ShaderError

READS = {
    "at its own texel": "texelFetch(mask, texel, 0).r",
    "far outside": "texelFetch(mask, texel * 1000 - 7, 0).r",
    "shifted": "texelFetchOffset(mask, texel, 0, ivec2(2, 3)).r",
    "clamped by its size": "texelFetch(mask, min(texel, textureSize(mask, 0) - 1), 0).r",
    "through a function": "at(mask, texel)",
    "through a macro": "AT(texel)",
    "filtered": "textureLod(mask, vec2(texel) / 17.0, 0.0).r",
}
KERNEL = """#pragma kernel(output = "a:r32f")
uniform sampler2D mask;  //! input("WORD")
#define AT(p) texelFetch(mask, p, 0).r
float at(sampler2D which, ivec2 place) {{ return texelFetch(which, place, 0).r; }}
float kernel(ivec2 texel) {{ return {}; }}
"""


@pytest.mark.parametrize("word", ["white", "black"])
@pytest.mark.parametrize("how", READS)
def test_it_is_the_constant_everywhere(any_engine, folder, how, word):
    sketch = folder.one(KERNEL.format(READS[how]).replace("WORD", word))
    assert np.all(any_engine.read(sketch, "a") == (1.0 if word == "white" else 0.0))


def test_its_size_is_one_texel(any_engine, folder):
    kernel = KERNEL.format("float(textureSize(mask, 0).x * 10 + textureSize(mask, 0).y)")
    assert np.all(any_engine.read(folder.one(kernel.replace("WORD", "white")), "a") == 11.0)


def test_wired_input_reads_its_texture_beside_unwired_one(any_engine, folder):
    folder.write(
        "ramp.glsl",
        '#pragma kernel(output = "a:r32f")\nfloat kernel(ivec2 t) { return float(t.x + 20 * t.y); }\n',
    )
    kernel = KERNEL.format("texelFetch(mask, texel, 0).r * 10000.0 + texelFetch(ramp, texel, 0).r")
    kernel = kernel.replace("WORD", "white").replace(
        "#define", 'uniform sampler2D ramp;  //! input("black")\n#define', 1
    )
    folder.write("both.glsl", kernel)
    passes = "\n".join(f'[[pass]]\nname = "{n}"\nuse = "./{u}"' for n, u in (("ramp", "ramp"), ("b", "both")))
    sketch = folder.sketch(passes)
    y, x = np.mgrid[0:17, 0:17]
    np.testing.assert_array_equal(any_engine.read(sketch, "b"), 10000.0 + x + 20 * y)


DRAW = """#pragma draw(mesh = "sheet")
uniform sampler2D lift;   //! input("white")
uniform sampler2D paint;  //! input("white")
vec4 vertex(vec3 corner, out vec2 place) {
    place = corner.xy;
    return vec4(2.0 * corner.xy - 1.0, 0.0, texelFetch(lift, ivec2(5), 0).r);
}
vec4 fragment(vec2 place) { return texelFetch(paint, ivec2(gl_FragCoord.xy), 0); }
"""


def test_a_draw_reads_it_in_both_stages(any_engine, folder):
    folder.write("look.glsl", DRAW)
    folder.write("one.glsl", '#pragma kernel(output = "a:r32f")\nfloat kernel(ivec2 t) { return 1.0; }\n')
    sketch = folder.sketch('[[pass]]\nname = "a"\nuse = "./one"\n[view]\nuse = "./look"\n')
    assert np.all(any_engine.read(sketch, "view", size=(9, 7)) == 1.0)


def test_a_mistake_names_glsl_s_own_function(any_engine, folder):
    sketch = folder.one(KERNEL.format("texelFetch(mask, texel).r").replace("WORD", "white"))
    with pytest.raises(ShaderError) as caught:
        any_engine.read(sketch, "a")
    first = caught.value.diagnostics[0]
    assert first.line == 5 and "texelFetch" in first.message and "k_fetch" not in str(caught.value)
