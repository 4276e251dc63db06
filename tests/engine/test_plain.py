"""Plain shaders run unchanged, get the usual uniforms, and read image files."""

from __future__ import annotations

import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.engine.sketch_warnings import warnings_of_kernel
from playground.errors import PlaygroundError, ShaderError

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


def test_a_plain_compute_shader_writes_its_image(compute_engine, folder):
    sketch = load(folder.write("c.comp", COMPUTE))
    frame = compute_engine.render(sketch, size=(9, 5), time=1.0)
    np.testing.assert_allclose(frame.array[2, :, 0], np.round(np.arange(9) / 8 * 255), atol=1)
    assert np.all(frame.array[..., 1] == 255)


def test_what_it_does_not_write_is_empty(compute_engine, folder):
    half = COMPUTE.replace("imageSize(picture).x", "4")
    frame = compute_engine.render(load(folder.write("c.comp", half)), size=(9, 5), time=1.0)
    assert not frame.array[:, 4:].any()


def test_a_mistake_names_its_line(any_engine, folder):
    path = folder.write("t.frag", TOY.replace("iTime * 0.1", "iTim * 0.1"))
    with pytest.raises(PlaygroundError) as caught:
        any_engine.render(load(path), size=(8, 8))
    assert caught.value.diagnostics[0].line == 12


# ── A plain shader reads image files by ``//! file``; each version gets a vertex shader of its kind


COPY = """#version 330
uniform sampler2D tex;  //! file("x.png")
uniform vec2 u_resolution;
out vec4 colour;
void main() { colour = texture(tex, gl_FragCoord.xy / u_resolution); }
"""


@pytest.fixture
def pixels(folder):
    result = np.random.default_rng(5).integers(0, 256, (6, 8, 4), dtype=np.uint8)
    result[..., 3] = 255
    write_png(folder.path / "x.png", result)
    return result


def kernel_of(path):
    return load(path).graph.find("view").technique


def test_a_picture_passes_through_unchanged(any_engine, folder, pixels):
    frame = any_engine.render(load(folder.write("t.frag", COPY)), size=(8, 6))
    np.testing.assert_array_equal(frame.array, pixels)


def test_sampling_options_hold(any_engine, folder, pixels):
    middle = COPY.replace("gl_FragCoord.xy / u_resolution", "vec2(1.25, 0.5)")
    folder.write("t.frag", middle.replace('"x.png"', '"x.png", "linear", "repeat"'))
    frame = any_engine.render(load(folder.path / "t.frag"), size=(2, 2))
    expected = pixels[2:4, 1:3].astype(float).mean((0, 1))  # 1.25 repeats 0.25, between texels 1 and 2
    np.testing.assert_allclose(frame.array[0, 0], expected, atol=1)
    write_png(folder.path / "x.png", pixels[:4, :4])
    coarsest = COPY.replace("texture(tex, gl_FragCoord.xy / u_resolution)", "textureLod(tex, vec2(0.1), 2.0)")
    folder.write("t.frag", coarsest.replace('"x.png"', '"x.png", "mipmap"'))
    frame = any_engine.render(load(folder.path / "t.frag"), size=(2, 2))
    expected = pixels[:4, :4].astype(float).mean((0, 1))
    np.testing.assert_allclose(frame.array[0, 0], expected, atol=2)  # two levels, each rounded to a byte


def test_changed_file_contents_redraw_and_equal_contents_do_not(any_engine, folder, pixels):
    sketch = load(folder.write("t.frag", COPY))
    any_engine.render(sketch, size=(8, 6))
    write_png(folder.path / "x.png", pixels)
    any_engine.render(sketch, size=(8, 6))
    assert any_engine.record.ran == []
    write_png(folder.path / "x.png", 255 - pixels | np.uint8([0, 0, 0, 255]))
    frame = any_engine.render(sketch, size=(8, 6))
    assert any_engine.record.ran == ["view"]
    np.testing.assert_array_equal(frame.array[..., :3], 255 - pixels[..., :3])


def test_the_file_is_a_parameter(any_engine, folder, pixels):
    write_png(folder.path / "y.png", pixels[::-1])
    sketch = load(folder.write("t.frag", COPY)).with_values({"view.tex": "y.png"})
    np.testing.assert_array_equal(any_engine.render(sketch, size=(8, 6)).array, pixels[::-1])


def test_a_missing_or_outlying_file_is_a_sentence(any_engine, folder):
    with pytest.raises(PlaygroundError, match="there is no such file"):
        any_engine.render(load(folder.write("t.frag", COPY)), size=(8, 6))
    with pytest.raises(PlaygroundError, match="lies outside") as caught:
        load(folder.write("t.frag", COPY.replace("x.png", "/etc/x.png")))
    assert caught.value.diagnostics[0].line == 2
    with pytest.raises(ShaderError, match="a plain shader has no inputs"):
        load(folder.write("t.frag", COPY.replace('file("x.png")', "input")))


COPY_COMPUTE = """#version 430
layout(local_size_x = 4, local_size_y = 2) in;
layout(rgba8, binding = 0) writeonly uniform image2D picture;
layout(binding = 3) uniform sampler2D tex;  //! file("x.png")
void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    imageStore(picture, texel, texelFetch(tex, texel, 0));
}
"""


def test_a_plain_compute_shader_reads_one_too(compute_engine, folder, pixels):
    frame = compute_engine.render(load(folder.write("c.comp", COPY_COMPUTE)), size=(8, 6))
    np.testing.assert_array_equal(frame.array, pixels)


def test_unfed_sampler_warns_once_at_its_line(any_engine, folder, pixels):
    text = COPY.replace("out vec4", "uniform sampler2D iChannel0, other;\nuniform samplerCube sky;\nout vec4")
    text = text.replace("u_resolution);", "u_resolution) + texture(iChannel0, vec2(0.5)) * 0.0;")
    kernel = kernel_of(folder.write("t.frag", text))
    warnings = [(d.line, d.severity, d.message.partition(",")[0]) for d in warnings_of_kernel(kernel)]
    assert warnings == [
        (4, "warning", "nothing feeds 'iChannel0'"),
        (4, "warning", "nothing feeds 'other'"),
        (5, "warning", "nothing feeds 'sky'"),
    ]
    assert '//! file("picture.png")' in warnings_of_kernel(kernel)[0].message
    assert not warnings_of_kernel(kernel_of(folder.write("t.frag", COPY)))


def test_samplers_of_several_kinds_that_nothing_feeds_read_black(any_engine, folder, pixels):
    text = COPY.replace("out vec4", "uniform sampler2D pair[2];\nuniform samplerCube sky;\nout vec4")
    text = text.replace(
        "u_resolution);", "u_resolution) + texture(pair[1], vec2(0.5)).r + texture(sky, vec3(1.0)).r;"
    )
    frame = any_engine.render(load(folder.write("t.frag", text)), size=(8, 6))
    np.testing.assert_array_equal(frame.array, pixels)


OLD = """// an old one
#version {}
{}
uniform vec2 u_resolution;
void main() {{
    gl_FragColor = vec4(gl_FragCoord.xy / u_resolution, 0.0, 1.0);
}}
"""
SINCE = OLD.replace("uniform vec2", "out vec4 c;\nuniform vec2").replace("gl_FragColor", "c")


@pytest.mark.parametrize(
    "version", ["110", "120", "100", "130", "150", "330 core", "300 es", "310 es", "400"]
)
def test_every_version_that_the_driver_takes_is_drawn(any_engine, folder, version):
    es = "precision highp float;" if version == "100" or "es" in version else ""
    text = (OLD if int(version[:3]) < 130 else SINCE).format(version, es)
    try:
        frame = any_engine.render(load(folder.write("t.frag", text)), size=(4, 2))
    except ShaderError as error:  # another driver, another list of versions
        assert "refuses the version" in str(error)
        pytest.skip(f"this driver has no version {version}")
    np.testing.assert_allclose(frame.array[0, :, 0], [32, 96, 159, 223], atol=1)
    np.testing.assert_allclose(frame.array[:, 0, 1], [191, 64], atol=1)


def test_a_mistake_in_an_old_version_is_reported_at_its_own_line(any_engine, folder):
    text = OLD.format("120", "").replace("0.0, 1.0)", "blue, 1.0)")
    with pytest.raises(ShaderError) as caught:
        any_engine.render(load(folder.write("t.frag", text)), size=(4, 2))
    assert [d.line for d in caught.value.diagnostics[:1]] == [6]
    assert "blue" in str(caught.value) and "gl_VertexID" not in str(caught.value)


@pytest.mark.parametrize("version", ["999", "330 compatibility"])
def test_refused_glsl_version_is_one_error_at_its_line(any_engine, folder, version):
    try:
        any_engine.render(load(folder.write("t.frag", SINCE.format(version, ""))), size=(4, 2))
    except ShaderError as error:
        (result,) = error.diagnostics
        assert result.line == 2 and result.message.startswith("this driver refuses the version: ")
    else:
        pytest.skip("this driver takes it")
