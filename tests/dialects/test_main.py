"""Shaders with a main of their own: each rule's text is drawn, the frame before it is read, and more."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.engine.plan import PlanRequest
from playground.engine.plan_warnings import source_warnings
from playground.engine.planner import make_plan
from playground.engine.sketch_warnings import warnings_of_kernel
from playground.errors import ShaderError, SketchError
from playground.publish.large import strips
from playground.shader.wrap import FRAGMENT, wrap
from playground.sketch.model import ForeignShader, kernels_of
from playground.sketch.replace_technique import with_texts
from playground.verify.reduce.case import inline_sketch
from tests.dialect_texts import with_mistake
from tests.dialects.test_drawn import DEPRECATED
from tests.main_dialect_texts import MAIN_TEXTS, STATEFUL

from ..loading import load

SIZE = (32, 18)


def drawn(engine, path, time=0.0, size=SIZE, **values):
    return engine.render(load(path).with_values(values), size=size, time=time).array


@pytest.mark.parametrize("name", MAIN_TEXTS)
def test_main_shader_is_deterministic_at_fixed_time(any_engine, ctx, folder, name):
    path = folder.write(f"{name}.frag", MAIN_TEXTS[name])
    first = drawn(any_engine, path, 1.0)
    assert len(np.unique(first[..., :3].reshape(-1, 3), axis=0)) > 1
    any_engine.cache.clear()
    drawn(any_engine, path, 2.0)
    np.testing.assert_array_equal(drawn(any_engine, path, 1.0), first)
    with Engine(ctx) as fresh:
        np.testing.assert_array_equal(drawn(fresh, path, 1.0), first)
    assert ctx.error == "GL_NO_ERROR"


@pytest.mark.parametrize("name", MAIN_TEXTS)
def test_a_mistake_is_at_its_own_line(any_engine, folder, name):
    text, line = with_mistake(MAIN_TEXTS[name])
    with pytest.raises(ShaderError) as caught:
        drawn(any_engine, folder.write(f"{name}.frag", text))
    diagnostic = caught.value.diagnostics[0]
    assert (diagnostic.line, diagnostic.file.endswith(f"{name}.frag")) == (line, True)
    assert "not_declared" in diagnostic.message


@pytest.mark.parametrize("name", MAIN_TEXTS)
def test_the_driver_gets_no_deprecated_name(folder, name):
    kernels = kernels_of(load(folder.write(f"{name}.frag", MAIN_TEXTS[name])).graph.find("view").technique)
    texts = [
        s.text
        for _, k in kernels
        if isinstance(k, ForeignShader)
        for s in wrap(k, FRAGMENT, 450).stages.values()
    ]
    assert texts
    assert not [word for text in texts for line in text.split("\n") for word in DEPRECATED.findall(line)]


@pytest.mark.parametrize("name", MAIN_TEXTS)
def test_there_is_state_only_where_the_frame_before_is_read(folder, name):
    spec = load(folder.write(f"{name}.frag", MAIN_TEXTS[name])).graph.find("view")
    assert (spec.repeat == "frames") == (name in STATEFUL)


# ── the frame before ─────────────────────────────────────────────────────────

COUNT = "vec4(floor(texture2D({0}, vec2(0.5)).r * 255.0 + 1.5) / 255.0, 0.0, 0.0, 1.0)"


@pytest.mark.parametrize("name", ["backbuffer", "u_backbuffer", "prevFrame", "prevPass", "texPreviousFrame"])
def test_previous_frame_is_a_sixtieth_of_a_second_earlier(any_engine, folder, name):
    text = f"uniform sampler2D {name};\nvoid main() {{ gl_FragColor = {COUNT.format(name)}; }}\n"
    path = folder.write("t.frag", text)
    for time, frames in {0.0: 1, 1 / 60: 2, 0.5: 31, 1.0: 61}.items():
        assert drawn(any_engine, path, time, (4, 3))[0, 0, 0] == frames
    assert drawn(any_engine, path, 0.25, (4, 3))[0, 0, 0] == 16  # back in time


def test_the_frame_before_has_eight_bits_a_channel(any_engine, folder):
    text = (
        "uniform sampler2D backbuffer;\nvoid main() { gl_FragColor = vec4(texture2D(backbuffer, vec2(0.5)).r"
    )
    path = folder.write("t.frag", f"{text} + 0.4 / 255.0); }}\n")
    assert drawn(any_engine, path, 1.0, (4, 3))[0, 0, 0] == 0  # never as much as half a step


def test_the_frame_before_is_read_by_place(any_engine, folder):
    text = """uniform float time; uniform vec2 resolution; uniform sampler2D backbuffer;
void main() {
    vec2 p = gl_FragCoord.xy / resolution - vec2(1.0 / 8.0, 0.0);
    gl_FragColor = time < 0.01 ? vec4(floor(gl_FragCoord.x) == 2.0) : texture2D(backbuffer, p);
}
"""
    result = drawn(any_engine, folder.write("t.frag", text), 3 / 60, (8, 2))
    assert np.flatnonzero(result[0, :, 0]).tolist() == [5]


def test_double_buffer_accumulates_floats_and_buffer_persists(any_engine, folder):
    text = """uniform sampler2D u_doubleBuffer0, u_buffer0, u_buffer1;
void main() {
#if defined(DOUBLE_BUFFER_0)
    gl_FragColor = texture2D(u_doubleBuffer0, vec2(0.5)) + vec4(0.25);
#elif defined(BUFFER_0)
    gl_FragColor = texture2D(u_buffer1, vec2(0.5));
#elif defined(BUFFER_1)
    gl_FragColor = texture2D(u_doubleBuffer0, vec2(0.5));
#else
    vec2 p = vec2(0.5);
    vec3 c = vec3(texture2D(u_doubleBuffer0, p).r, texture2D(u_buffer0, p).r, texture2D(u_buffer1, p).r);
    gl_FragColor = vec4(c / 100.0 * 4.0, 1.0);
#endif
}
"""
    result = drawn(any_engine, folder.write("t.frag", text), 0.5, (4, 3))[0, 0, :3] / 255 * 100
    # In frame n the double buffer was written n + 1 times. Buffers come before it: buffer 1 reads n
    # of them, buffer 0 what buffer 1 read in the frame before.
    np.testing.assert_allclose(result, [31, 29, 30], atol=0.5 * 100 / 255)


def test_a_change_of_a_parameter_draws_the_state_anew(any_engine, folder):
    text = "uniform sampler2D backbuffer; uniform float step_ = 0.0;\nvoid main() {"
    text += " gl_FragColor = texture2D(backbuffer, vec2(0.5)) + vec4(step_); }\n"
    path = folder.write("t.frag", text)
    assert drawn(any_engine, path, 0.1, (4, 3))[0, 0, 0] == 0
    assert drawn(any_engine, path, 0.1, (4, 3), **{"view.step_": 4 / 255})[0, 0, 0] == 28


# ── what was left over ───────────────────────────────────────────────────────


def test_what_a_vertex_shader_gave_under_names_of_glsl_s_own(any_engine, folder):
    text = "void main() { gl_FragColor = vec4(gl_TexCoord[3].xy, gl_FogFragCoord, 1.0) * gl_Color; }\n"
    result = drawn(any_engine, folder.write("t.frag", text), size=(4, 2))
    np.testing.assert_allclose(result[1, :, 0], [32, 96, 159, 223], atol=1)
    np.testing.assert_allclose(result[:, 0, 1], [191, 64], atol=1)


def test_names_that_are_ours_belong_to_the_file(any_engine, folder):
    path = folder.write("t.frag", MAIN_TEXTS["our_names"])
    assert [p.name for p in load(path).graph.find("view").technique.parameters] == ["k_window_"]
    half = drawn(any_engine, path, size=(4, 2), **{"view.k_window_": 0.25})
    np.testing.assert_allclose(half[1, :, 0], [16, 48, 80, 112], atol=1)
    assert (half[..., 2] == 64).all()


def test_each_of_an_array_of_samplers_may_be_wired(any_engine, folder):
    folder.write("t.frag", MAIN_TEXTS["sampler_array"].replace("texture2D(u_tex0, st)", "vec4(0.0)"))
    folder.write(
        "red.glsl",
        '#pragma kernel(output = "colour:rgba8")\nuniform vec3 c = vec3(1, 0, 0);\n'
        "vec4 kernel(ivec2 t) { return vec4(c, 1); }\n",
    )
    passes = '[[pass]]\nname = "red"\nuse = "./red"\nsize = 8\n'
    passes += '[[pass]]\nname = "green"\nuse = "./red"\nsize = 4\nset = { c = [0, 1, 0] }\n'
    view = '[view]\nuse = "./t"\n'
    sketch = folder.sketch(f'{passes}{view}inputs = {{ maps_0 = "red", maps_2 = "green" }}\n')
    np.testing.assert_array_equal(any_engine.render(sketch, size=(4, 4)).array[0, 0, :3], [255, 255, 0])
    (note,) = source_warnings(make_plan(folder.sketch(passes + view), PlanRequest(frame_size=SIZE)))
    assert (note.line, note.message) == (2, "nothing feeds maps_0, maps_1, maps_2: it reads black")


def test_edited_text_gets_channel_stand_ins_before_saving(any_engine, folder):
    path = folder.write("t.frag", "void main() { gl_FragColor = vec4(0.0, 0.0, 0.0, 1.0); }\n")
    text = "uniform sampler2D u_tex3; uniform sampler2D backbuffer;\nvoid main() {"
    text += " gl_FragColor = texture2D(u_tex3, gl_FragCoord.xy / 8.0);"
    text += " gl_FragColor += texture2D(backbuffer, vec2(0.5)) * 0.1; }\n"
    changed = with_texts(load(path), {str(path): text})
    before = any_engine.render(changed, size=(8, 8)).array
    np.testing.assert_array_equal(
        any_engine.render(load(folder.write("u.frag", text)), size=(8, 8)).array, before
    )
    assert len(np.unique(before[..., 0])) > 4


def test_camera_and_sun_are_the_sketch_s_where_it_has_them(any_engine, folder):
    text = "uniform vec3 u_camera, u_light;\nvoid main() { gl_FragColor = vec4(0.5 + 0.5 * VALUE, 1.0); }\n"
    neutral = folder.write("n.frag", text.replace("VALUE", "u_light * u_camera.z"))
    np.testing.assert_allclose(drawn(any_engine, neutral)[0, 0, :3], [128, 128, 255], atol=1)
    folder.write("light.frag", text.replace("VALUE", "u_light"))
    folder.write("eye.frag", text.replace("VALUE", "u_camera / vec3(1e6, 1e6, 1e6)"))
    scene = """extent = 1000.0
relief = 100.0
[[pass]]
name = "height"
use = "generation/white_noise"
[[pass]]
name = "light"
use = "lighting/l_dot_n"
set = { sun = [90, 30] }
[[pass]]
name = "look"
use = "./NAME"
size = 4
[view]
use = "view/terrain"
camera = { azimuth = 90.0, elevation = 0.0, distance = 500000.0, target = [0.0, 0.0, 250000.0] }
"""
    light = any_engine.read(folder.sketch(scene.replace("NAME", "light")), "look")[0, 0, :3]
    np.testing.assert_allclose(
        light, [0.5 + 0.5 * np.cos(np.pi / 6), 0.5, 0.75], atol=1 / 255
    )  # east, 30° up
    eye = any_engine.read(folder.sketch(scene.replace("NAME", "eye")), "look")[0, 0, :3]
    np.testing.assert_allclose(eye, [0.75, 0.5, 0.625], atol=1 / 255)  # 500 km east, 250 km up


@pytest.mark.parametrize("name", ["viewer_ripples", "viewer_pyramid", "viewer_conditions", "viewer_flood"])
def test_what_is_reduced_is_the_whole_text_in_its_author_s_words(folder, name):
    text, _ = with_mistake(MAIN_TEXTS[name])
    (item,) = inline_sketch(load(folder.write("t.frag", text)), frame=SIZE).passes
    assert item.text.splitlines() == [line for line in text.splitlines() if line.strip()]


def test_a_picture_that_reads_smaller_ones_is_drawn_in_parts(any_engine, folder):
    sketch = load(folder.write("t.frag", MAIN_TEXTS["viewer_buffers"]))
    whole = any_engine.render(sketch, size=SIZE, time=0.1).array
    parts = np.concatenate(list(strips(any_engine, sketch, SIZE, tile=(20, 8), time=0.1)))
    np.testing.assert_allclose(parts.astype(int), whole, atol=1)


@pytest.mark.parametrize("name", ["viewer_flood", "viewer_pyramid", "viewer_post", "sandbox_trails"])
def test_what_needs_the_whole_picture_says_so(any_engine, folder, name):
    sketch = load(folder.write("t.frag", MAIN_TEXTS[name]))
    with pytest.raises(SketchError, match=r"cannot be drawn in parts: it .*; choose a smaller picture"):
        list(strips(any_engine, sketch, SIZE, tile=(20, 8), time=0.1))


def test_unfed_uniform_without_widget_is_named_in_warning(any_engine, folder):
    text = """struct Light { vec3 colour; float power; };
uniform Light key;
uniform Light lights[2];
uniform float u_values[4];
uniform float kept[2] = float[2](0.25, 0.5);
uniform float unread[3];
uniform vec3 u_SH[9];
uniform float gain;
uniform vec2 u_resolution;
void main() {
    float all_of_it = u_values[1] + kept[1] + gain + u_SH[0].x;
    gl_FragColor = vec4(gl_FragCoord.xy / u_resolution, all_of_it, 1.0);
    gl_FragColor.rgb += key.colour + lights[1].colour;
}
"""
    path = folder.write("a.frag", text)
    plan = make_plan(load(path), PlanRequest(frame_size=SIZE))
    assert [(w.message, w.line) for w in source_warnings(plan)] == [
        ("nothing feeds key, lights, u_values: it is 0, as no panel shows its type", 2)
    ]
    assert drawn(any_engine, path)[0, 0, 2] == 128


def test_an_image_that_shaders_write_is_named(folder):
    text = """#version 420
layout(r32ui) uniform coherent uimage2D[3] computeTex;
uniform float fGlobalTime;
out vec4 c;
void main() { imageStore(computeTex[0], ivec2(0), uvec4(1)); c = vec4(fGlobalTime); }
"""
    plan = make_plan(load(folder.write("a.frag", text)), PlanRequest(frame_size=SIZE))
    (result,) = source_warnings(plan)
    assert (result.message, result.line) == (
        "nothing feeds computeTex: it reads 0, and nothing stores what it writes",
        2,
    )


# ── a given name of another type ─────────────────────────────────────────────

OTHER_TYPES = {
    "sampler2D": "texture({}, vec2(0.5)).x",
    "samplerCube": "texture({}, vec3(0.5)).x",
    "sampler2D[2]": "texture({}[0], vec2(0.5)).x",
    "isampler2D": "float(texture({}, vec2(0.5)).x)",
    "Own": "{}.a",
    "mat4": "{}[0][0]",
}
FORMS = (
    "{}\nvoid main() {{ gl_FragColor = vec4({}); }}\n",
    "{}\nvoid mainImage(out vec4 c, in vec2 p) {{ c = vec4({}); }}\n",
    '/*{{"ISFVSN": "2"}}*/\n{}\nvoid main() {{ gl_FragColor = vec4({}); }}\n',
    "#version 330\n{}\nout vec4 o;\nvoid main() {{ o = vec4({}); }}\n",
)


@pytest.mark.parametrize("kind", OTHER_TYPES)
def test_a_given_name_of_another_type_is_the_text_s_own(any_engine, folder, kind):
    base, bracket, count = kind.partition("[")
    for number, name in enumerate(("spectrum", "iTime", "TIME", "time", "resolution", "mouse", "iDate")):
        form = FORMS[number % 4]
        declared = f"struct Own {{ float a; }};\nuniform {base} {name}{bracket}{count};"
        text = form.format(declared, OTHER_TYPES[kind].format(name))
        sketch = load(folder.write("a.frag" if "ISF" not in form else "a.fs", text))
        array = any_engine.render(sketch, size=(8, 4), time=2.0).array
        assert (array[..., :3] == 0).all(), name
        said = [str(d) for d in source_warnings(make_plan(sketch, PlanRequest(frame_size=(8, 4))))]
        said += [str(d) for _, k in kernels_of(sketch.graph) for d in warnings_of_kernel(k)]
        if "version" not in form or "sampler" in kind:
            assert sum(name in item for item in said) == 1, (name, said)


def test_a_sampler_s_name_as_a_number_is_a_parameter(any_engine, folder):
    text = "uniform vec2 u_tex0;\nuniform float iChannel1 = 0.5;\n"
    text += "void main() { gl_FragColor = vec4(u_tex0, iChannel1, 1.0); }\n"
    sketch = load(folder.write("a.frag", text)).with_values({"view.u_tex0": (1.0, 0.0)})
    np.testing.assert_array_equal(any_engine.render(sketch, size=(8, 4)).array[0, 0], [255, 0, 128, 255])
