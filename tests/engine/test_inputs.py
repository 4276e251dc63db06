"""What a kernel is given for an input and a direction, and what an unwired input reads."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine.software import Software
from playground.engine.tuning import Tuning
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


# ── What is given for an input and for a direction: whether it is wired, and the unit vector towards


ASKS = """#pragma kernel(output = "given:rgba32f")
uniform sampler2D wind;  //! input("black")
uniform vec2 sun = vec2(30.0, 60.0);  //! direction
vec4 kernel(ivec2 texel) { return vec4(towards_sun, wired_wind ? 1.0 : 0.0); }
"""
WIND = '#pragma kernel(output = "value:r32f")\nfloat kernel(ivec2 texel) { return 0.0; }\n'
PASS = '[[pass]]\nname = "asked"\nuse = "./asks"\n'


DRAWN = """#pragma draw(mesh = "sheet", output = "given:rgba32f")
uniform sampler2D wind;  //! input("black")
uniform vec2 sun = vec2(30.0, 60.0);  //! direction
vec4 vertex(vec3 corner, out float blown) {
    blown = wired_wind ? 1.0 : 0.0;
    return vec4(corner.xy * 2.0 - 1.0, 0.0, 1.0);
}
vec4 fragment(float blown) { return vec4(towards_sun, wired_wind ? blown : 0.0); }
"""
SWEPT = """#pragma compute(groups = "size.x, size.y", local = "1, 1")
uniform sampler2D wind;  //! input("black")
uniform vec2 sun = vec2(30.0, 60.0);  //! direction
void main() {
    imageStore(out_given, ivec2(gl_GlobalInvocationID.xy), vec4(towards_sun, wired_wind ? 1.0 : 0.0));
}
"""


@pytest.fixture(params=["compiled in", "set as uniforms"])
def each_engine(request, any_engine):
    """Give an engine that compiles in what is wired, as where the processor draws, and one that does not."""
    tuning = Software(any_engine.ctx) if request.param == "compiled in" else Tuning()
    any_engine.runner.kernels.tuning, any_engine.runner.programs.write = tuning, tuning.write
    return any_engine


@pytest.fixture
def asked(folder):
    folder.write("asks.glsl", ASKS)
    folder.write("blows.glsl", WIND)
    return folder.sketch(PASS)


def truth(azimuth, elevation):
    a, e = np.radians([azimuth, elevation])
    return [np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)]


@pytest.mark.parametrize("sun", [(30, 60), (-250, -20), (0, 90), (450, 0), (180, -90), (720, 3)], ids=str)
def test_the_vector_towards_a_direction(any_engine, asked, sun):
    value = any_engine.read(asked.with_values({"asked.sun": sun}), "asked")[3, 5]
    np.testing.assert_allclose(value[:3], truth(*sun), atol=1e-7)
    if sun[0] % 90 == 0 and sun[1] % 90 == 0:
        assert sorted(np.abs(value[:3])) == [0, 0, 1]


def test_direction_change_invalidates_reader_of_its_vector(any_engine, asked):
    before = any_engine.read(asked, "asked")
    assert (before != any_engine.read(asked.with_values({"asked.sun": (31, 60)}), "asked")).any()


def test_whether_an_input_is_wired(any_engine, asked, folder):
    assert any_engine.read(asked, "asked")[0, 0, 3] == 0
    blown = folder.sketch('[[pass]]\nname = "wind"\nuse = "./blows"\n' + PASS)
    assert any_engine.read(blown, "asked")[0, 0, 3] == 1
    assert any_engine.read(asked, "asked")[0, 0, 3] == 0


@pytest.mark.usefixtures("trusted_variants")
@pytest.mark.parametrize("form", ["kernel", "draw", "variant"])
def test_kernels_draws_and_compute_variants_get_them(each_engine, folder, form):
    if form == "variant" and not each_engine.info.compute:
        pytest.skip("this context has no compute shaders")
    folder.write("asks.glsl", DRAWN if form == "draw" else ASKS)
    if form == "variant":
        folder.write("asks.comp", SWEPT)
    folder.write("blows.glsl", WIND)
    alone = folder.sketch(PASS)
    for sketch, wired in (
        (alone, 0),
        (folder.sketch('[[pass]]\nname = "wind"\nuse = "./blows"\n' + PASS), 1),
    ):
        for sun in ((30, 60), (200, 5)):
            value = each_engine.read(sketch.with_values({"asked.sun": sun}), "asked")
            np.testing.assert_allclose(value[..., :3], np.broadcast_to(truth(*sun), (17, 17, 3)), atol=1e-7)
            assert (value[..., 3] == wired).all()


SIZES = """#pragma kernel(output = "given:rg32f")
uniform sampler2D wind;  //! input("black")
vec2 kernel(ivec2 texel) { return vec2(matches_wind ? 1.0 : 0.0, wired_wind ? 1.0 : 0.0); }
"""


def test_whether_an_input_has_the_size_of_the_pass(each_engine, folder):
    folder.write("asks.glsl", SIZES)
    folder.write("blows.glsl", WIND)
    for size, value in (("", (1, 1)), ("size = 9\n", (0, 1)), ("size = [17, 9]\n", (0, 1))):
        sketch = folder.sketch(f'[[pass]]\nname = "wind"\nuse = "./blows"\n{size}{PASS}')
        assert tuple(each_engine.read(sketch, "asked")[3, 2]) == value
    assert tuple(each_engine.read(folder.sketch(PASS), "asked")[0, 0]) == (0, 0)
