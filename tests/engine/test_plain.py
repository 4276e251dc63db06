"""A plain shader, with its own #version and main, runs unchanged and gets the usual uniforms."""

from __future__ import annotations

import numpy as np
import pytest

from playground.errors import PlaygroundError

from ..loading import load

TOY = """// a shader of one's own
#version 330 core
uniform float iTime;
uniform vec3 iResolution;
uniform vec4 iMouse;
uniform int iFrame;
uniform float dim;
uniform sampler2D iChannel0;
out vec4 colour;
void main() {
    vec2 uv = gl_FragCoord.xy / iResolution.xy;
    colour = vec4(uv.x, iTime * 0.1, iMouse.x * 0.01 + float(iFrame) * 0.001, 1.0) * (1.0 - dim)
           + texture(iChannel0, uv) * 0.0;
}
"""


@pytest.fixture
def toy(folder):
    return load(folder.write("toy.frag", TOY))


def test_it_is_the_whole_picture(any_engine, toy):
    frame = any_engine.render(toy, size=(20, 10), time=5.0)
    expected = np.round((np.arange(20) + 0.5) / 20 * 255)
    np.testing.assert_allclose(frame.array[4, :, 0], expected, atol=1)
    np.testing.assert_allclose(frame.array[0, 0, 1:], [127.5, 0.3 * 255, 255], atol=1)


def test_its_own_uniforms_are_parameters(any_engine, toy):
    dark = any_engine.render(toy.with_values({"view.dim": 1.0}), size=(20, 10), time=5.0)
    assert dark.array[..., :3].max() == 0


@pytest.mark.parametrize("name", ["iTime", "u_time", "time", "iGlobalTime", "uTime"])
def test_time_goes_by_several_names(any_engine, folder, name):
    path = folder.write("t.frag", TOY.replace("iTime", name))
    assert any_engine.render(load(path), size=(8, 8), time=10.0).array[0, 0, 1] == 255


@pytest.mark.parametrize(
    ("declared", "used"),
    [
        ("vec2 u_resolution", "u_resolution.xy"),
        ("vec2 resolution", "resolution"),
        ("vec3 iResolution", "iResolution.xy"),
    ],
)
def test_the_resolution_has_as_many_components_as_are_declared(any_engine, folder, declared, used):
    text = TOY.replace("vec3 iResolution", declared).replace("iResolution.xy", used)
    frame = any_engine.render(load(folder.write("t.frag", text)), size=(4, 4))
    np.testing.assert_allclose(frame.array[0, :, 0], [32, 96, 159, 223], atol=1)


@pytest.mark.parametrize("kind", ["float", "int", "uint"])
def test_the_frame_number_fits_its_type(any_engine, folder, kind):
    path = folder.write("t.frag", TOY.replace("int iFrame", f"{kind} iFrame"))
    picture = any_engine.render(load(path), size=(8, 8), time=1000 / 60).array
    assert picture[0, 0, 2] == 255


def test_mouse_is_passed_and_unmoved_mouse_invalidates_nothing(any_engine, toy):
    any_engine.render(toy, size=(8, 8), time=1.0)
    any_engine.render(toy, size=(8, 8), time=1.0)
    assert any_engine.record.ran == []
    any_engine.runner.mouse = (100.0, 0.0, 0.0, 0.0)
    assert any_engine.render(toy, size=(8, 8), time=1.0).array[0, 0, 2] == 255
    assert any_engine.record.ran == ["view"]


def test_what_reads_no_time_is_not_drawn_again(any_engine, folder):
    path = folder.write("still.frag", "#version 330\nout vec4 c;\nvoid main() { c = vec4(1.0); }\n")
    any_engine.render(load(path), size=(8, 8), time=1.0)
    any_engine.render(load(path), size=(8, 8), time=2.0)
    assert any_engine.record.ran == []


COMPUTE = """#version 430
layout(local_size_x = 4, local_size_y = 2) in;
layout(rgba16f, binding = 0) writeonly uniform image2D picture;
uniform float u_time;
void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (texel.x >= imageSize(picture).x) return;
    imageStore(picture, texel, vec4(float(texel.x) / 8.0, u_time, 0.0, 1.0));
}
"""


def test_a_plain_compute_shader_writes_its_image(any_engine, folder):
    if not any_engine.info.compute:
        pytest.skip("this context has no compute shaders")
    sketch = load(folder.write("c.comp", COMPUTE))
    frame = any_engine.render(sketch, size=(9, 5), time=1.0)
    np.testing.assert_allclose(frame.array[2, :, 0], np.round(np.arange(9) / 8 * 255), atol=1)
    assert np.all(frame.array[..., 1] == 255)


def test_what_it_does_not_write_is_empty(any_engine, folder):
    if not any_engine.info.compute:
        pytest.skip("this context has no compute shaders")
    half = COMPUTE.replace("imageSize(picture).x", "4")
    frame = any_engine.render(load(folder.write("c.comp", half)), size=(9, 5), time=1.0)
    assert not frame.array[:, 4:].any()


def test_a_mistake_names_its_line(any_engine, folder):
    path = folder.write("t.frag", TOY.replace("iTime * 0.1", "iTim * 0.1"))
    with pytest.raises(PlaygroundError) as caught:
        any_engine.render(load(path), size=(8, 8))
    assert caught.value.diagnostics[0].line == 12
