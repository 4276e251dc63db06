"""What is given for an input and for a direction: whether it is wired, and the unit vector towards it."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine.software import Software
from playground.engine.tuning import Tuning

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
    any_engine.runner.kernels.tuning, any_engine.runner.programs._write = tuning, tuning.write
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
