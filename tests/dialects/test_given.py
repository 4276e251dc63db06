"""What other tools' shaders are given: the mouse, stand-ins, sounds, a sketch's wires, camera and sun."""

from __future__ import annotations

import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.dialects.foreign import unfed_warnings
from playground.engine.plan_warnings import source_warnings
from playground.engine.sandbox import Sandbox
from playground.engine.sketch_warnings import warnings_of_kernel
from playground.errors import ParameterError, SketchError
from playground.shader.wrap import FRAGMENT, wrap
from playground.sketch.load import load
from playground.sketch.model import kernels_of
from playground.sketch.replace_technique import with_texts
from playground.sketch.traits import traits_of
from playground.verify.check import check_file

from ..foreign_cases import CASES, photo
from .drawing import SIZE, colours, drawn, first_texel, kernels, notes, shader_of

TOY = "void mainImage(out vec4 c, in vec2 p) {{ c = {}; }}\n"
MAIN = "{}\nvoid main() {{ gl_FragColor = {}; }}\n"


# ── what is given ────────────────────────────────────────────────────────────


def test_the_mouse_of_each_dialect(any_engine, folder):
    any_engine.runner.hover, any_engine.runner.drag = (16.0, 9.0), (8.0, 4.0, -2.0, -1.0)
    toy = TOY.format("vec4(iMouse.xy, -iMouse.zw) / 16.0")
    hover = MAIN.format("uniform vec3 u_mouse;", "vec4(u_mouse.xy / 32.0, 0.0, 1.0)")
    share = MAIN.format("uniform vec2 mouse;", "vec4(mouse, 0.0, 1.0)")
    for text, expected in {toy: [128, 64, 32], hover: [128, 72, 0], share: [128, 128, 0]}.items():
        texel = first_texel(any_engine, folder.write("t.frag", text), size=SIZE)
        np.testing.assert_allclose(texel, [*expected, 255], atol=1)


# ── channels ─────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    "text",
    [
        TOY.format("texture(iChannelN, p / iResolution.xy)"),
        MAIN.format("uniform sampler2D u_texN;", "texture2D(u_texN, gl_FragCoord.xy / 32.0)"),
        MAIN.format("uniform sampler2D textureN;", "texture2D(textureN, gl_FragCoord.xy / 32.0)"),
    ],
)
def test_stand_ins_differ_by_number(any_engine, folder, text):
    made = [drawn(any_engine, folder.write("t.frag", text.replace("N", str(n)))) for n in range(4)]
    assert all(colours(item) > 4 for item in made)
    assert all(not np.array_equal(a, b) for i, a in enumerate(made) for b in made[:i])


def test_an_annotation_of_our_own_counts(any_engine, folder):
    write_png(folder.path / "x.png", np.full((4, 4, 4), 255, np.uint8))
    head = 'uniform sampler2D u_tex0;  //! file("x.png")\nuniform float time = 0.5;  //! slider(0, 1)'
    path = folder.write("t.frag", MAIN.format(head, "texture2D(u_tex0, vec2(0.5)) * time"))
    assert [p.name for p in shader_of(path).parameters] == ["u_tex0", "time"]
    np.testing.assert_allclose(drawn(any_engine, path, 3.0)[0, 0, :3], 128, atol=1)


PHOTO = """uniform vec2 u_resolution;
uniform sampler2D u_tex0; // photo.png
uniform vec2 u_tex0Resolution;
void main() {
    gl_FragColor = texture2D(u_tex0, gl_FragCoord.xy / u_resolution);
    gl_FragColor.a = u_tex0Resolution.x / 8.0;
}
"""


def test_a_comment_names_the_picture(any_engine, folder):
    path = folder.write("t.frag", PHOTO)
    (note,) = unfed_warnings(shader_of(path), ())
    assert (note.line, note.message) == (
        2,
        "nothing feeds u_tex0: there is no file 'photo.png', so a stand-in is drawn",
    )
    assert colours(drawn(any_engine, path)) > 1
    write_png(folder.path / "photo.png", photo(5))
    assert shader_of(path).unfed == ()
    np.testing.assert_allclose(drawn(any_engine, path, size=(8, 6)), photo(5), atol=1)


def test_a_sketch_wires_a_pass_to_a_channel_and_sets_a_parameter(any_engine, folder):
    folder.write("toy.frag", f"uniform float level;\n{TOY.format('texture(iChannel1, vec2(0.5)) * level')}")
    folder.write(
        "red.glsl",
        '#pragma kernel(output = "colour:rgba8")\nvec4 kernel(ivec2 t) { return vec4(1, 0, 0, 1); }\n',
    )
    passes = '[[pass]]\nname = "red"\nuse = "./red"\nsize = 8\n'
    view = '[view]\nuse = "./toy"\nset = { level = 0.5 }\n'
    wired = folder.sketch(f'{passes}{view}inputs = {{ iChannel1 = "red" }}\n')
    np.testing.assert_allclose(any_engine.render(wired, size=(4, 4)).array[0, 0], [128, 0, 0, 255], atol=1)
    unwired = folder.sketch(passes + view)
    assert any_engine.render(unwired, size=(4, 4)).array[0, 0, 1] > 0


def test_what_nothing_feeds_is_named_once(folder):
    sound, fed = notes(load(CASES["main"]["kodelife"].write(folder.path)))
    assert "texture0, texture1, texture2, texture3" in fed.message and fed.line == 6
    assert "nothing feeds spectrum: a made-up sound" in sound.message
    toy = TOY.format("texture(iChannel0, p) + texture(iChannel1, p)")
    folder.write("toy.frag", toy)
    view = '[view]\nuse = "./toy"\ninputs = {{ {} }}\n'
    passes = '[[pass]]\nname = "card"\nuse = "foreign/picture"\nsize = 8\n'
    for inputs, left in {
        "": ["iChannel0, iChannel1"],
        'iChannel1 = "card"': ["iChannel0"],
        'iChannel0 = "card", iChannel1 = "card"': [],
    }.items():
        unfed = [
            note for note in notes(folder.sketch(passes + view.format(inputs))) if "feeds" in note.message
        ]
        assert [note.message.split(":")[0] for note in unfed] == [f"nothing feeds {n}" for n in left]


# ── which dialect ────────────────────────────────────────────────────────────


def test_a_dialect_may_be_named(any_engine, folder):
    both = "#ifdef HW_PERFORMANCE\nvoid mainImage(out vec4 c, vec2 p) { c = vec4(1, 0, 0, 1); }\n#else\n"
    path = folder.write("t.frag", f"{both}void main() {{ gl_FragColor = vec4(0, 1, 0, 1); }}\n#endif\n")
    for dialect, texel in {"main": [0, 255, 0, 255], "shadertoy": [255, 0, 0, 255]}.items():
        np.testing.assert_array_equal(first_texel(any_engine, load(path, dialect=dialect)), texel)
    with pytest.raises(ParameterError, match="did you mean 'shadertoy'"):
        load(path, dialect="shadertoi")
    with pytest.raises(SketchError, match="--dialect is for a shader file"):
        load("jacksboro", dialect="main")


def test_a_text_that_replaces_the_file_is_read_as_its_dialect(any_engine, folder):
    path = folder.write("t.frag", TOY.format("vec4(0.0)"))
    changed = with_texts(load(path), {str(path): TOY.format("vec4(fract(iTime), 0.0, 0.0, 1.0)")})
    np.testing.assert_array_equal(first_texel(any_engine, changed, 1.0), [0, 0, 0, 255])
    assert traits_of(changed).moves and not traits_of(load(path)).moves


@pytest.mark.slow
def test_check_names_the_dialect_and_the_line(folder):
    with Sandbox() as sandbox:
        good = check_file(CASES["shadertoy"]["toy"].write(folder.path), sandbox)
        wrong, line = CASES["main"]["varying"].with_mistake()
        bad = check_file(wrong.write(folder.path), sandbox)
    assert (good.ok, good.notes) == (True, ("read as shadertoy",))
    assert ["nothing feeds iChannel0" in w.message for w in good.warnings] == [True]
    assert [d.line for d in bad.errors] == [line]


def test_a_made_up_sound_stands_in_for_one_and_is_named(any_engine, folder):
    lines = "uniform sampler1D texFFT;\nuniform sampler1D texFFTSmoothed;\nuniform vec2 v2Resolution;\n"
    body = "float x = gl_FragCoord.x / v2Resolution.x;\n"
    colour = "vec4(100.0 * texture(texFFT, x).r, 100.0 * texture(texFFTSmoothed, x).r, 0.0, 1.0)"
    text = f"#version 410 core\n{lines}out vec4 c;\nvoid main() {{ {body} c = {colour}; }}\n"
    sketch = load(folder.write("t.glsl", text))
    result = [any_engine.render(sketch, size=(64, 4), time=t).array[0, :, 0].astype(int) for t in (1.1, 1.3)]
    assert result[0].max() > 60 and result[0][-4:].max() < 60, "tones in the west, fewer in the east"
    assert not np.array_equal(*result)
    plan = any_engine.plan(sketch, (64, 4))
    (warning,) = source_warnings(plan)
    assert "nothing feeds texFFT, texFFTSmoothed: a made-up sound stands in" in warning.message


def test_kodelife_s_three_bands_go_by_time_and_are_named(any_engine, folder):
    text = "uniform vec3 spectrum;\nvoid main() { gl_FragColor = vec4(spectrum, 1.0); }\n"
    sketch = load(folder.write("t.frag", text))
    result = {tuple(first_texel(any_engine, sketch, time)[:3].tolist()) for time in (0.0, 0.2, 0.4)}
    assert len(result) == 3 and all(min(item) > 0 for item in result)
    assert traits_of(sketch).moves
    (warning,) = source_warnings(any_engine.plan(sketch, (2, 2)))
    assert "nothing feeds spectrum: a made-up sound stands in" in warning.message


def test_bonzomatic_s_sound_may_be_multiplied_as_its_shaders_do(any_engine, folder):
    text = "#version 410 core\nuniform sampler1D texFFT;\nuniform vec2 v2Resolution;\nout vec4 c;\n"
    text += (
        "void main() { c = vec4(vec3(texture(texFFT, gl_FragCoord.x / v2Resolution.x).r * 100.0), 1.0); }\n"
    )
    row = drawn(any_engine, folder.write("b.frag", text), 0.5)[0, :, 0]
    assert 50 < row.max() and (row < 255).mean() > 0.9


# ── packing ──────────────────────────────────────────────────────────────────

SIDE = 256
INDEX = "uint i = uint(p.x) + 256u * uint(p.y);"
BYTES = "c = vec4(uvec3(bits, bits >> 8, bits >> 16) & 255u, 255.0) / 255.0;"


def bits_of(engine, folder, expression, shift=0, head=""):
    """Return bits of a uint for each 16-bit number i, by a shader that computes it."""
    body = f"{INDEX} uint bits = {expression} >> {shift}; {BYTES}"
    text = f"{head}void mainImage(out vec4 c, in vec2 p) {{ {body} }}"
    result = drawn(engine, folder.write("p.frag", text), size=(SIDE, SIDE))[::-1, :, :3].astype(np.uint32)
    return ((result[..., 2] << 16 | result[..., 1] << 8 | result[..., 0]) << shift).ravel()


@pytest.mark.parametrize("head", ["", "#version 300 es\nprecision highp float;\n"])
def test_half_floats_are_packed_to_the_bit(any_engine, folder, head):
    numbers = np.arange(2**16, dtype=np.uint32)
    halves = numbers.astype(np.uint16).view(np.float16)
    low, high = (
        bits_of(any_engine, folder, "floatBitsToUint(unpackHalf2x16(i).x)", shift, head) for shift in (0, 24)
    )
    view = (high | low).view(np.float32)
    np.testing.assert_array_equal(np.isnan(view), np.isnan(halves))
    there = ~np.isnan(halves)
    np.testing.assert_array_equal((high | low)[there], halves.astype(np.float32).view(np.uint32)[there])
    for rest in (0, 1, 0x0FFF, 0x1000, 0x1001, 0x3000, 0xFFFF):
        with np.errstate(all="ignore"):
            values = (numbers << 16 | rest).view(np.float32)
            expected = values.astype(np.float16)
        pair = f"packHalf2x16(vec2(1.0, uintBitsToFloat(i << 16 | {rest}u)))"
        view = bits_of(any_engine, folder, pair, 8, head) | bits_of(any_engine, folder, pair, 0, head)
        assert set(view & 0xFFFF) == {0x3C00}, "1.0 in the lower half"
        view = (view >> 16).astype(np.uint16)
        np.testing.assert_array_equal(np.isnan(view.view(np.float16)), np.isnan(values))
        np.testing.assert_array_equal(view[~np.isnan(values)], expected.view(np.uint16)[~np.isnan(values)])


@pytest.mark.parametrize(("kind", "most", "low"), [("Unorm", 65535, 0), ("Snorm", 32767, -1)])
def test_normalised_integers_are_packed_to_the_bit(any_engine, folder, kind, most, low):
    number = np.float32
    values = (np.arange(2**16, dtype=number) - number(20000)) * number(2**-15)
    codes = np.rint(np.clip(values, low, 1).astype(number) * number(most)).astype(np.int32)
    pair = f"pack{kind}2x16(vec2(1.0, (float(i) - 20000.0) * exp2(-15.0)))"
    bits = bits_of(any_engine, folder, pair, 8) | bits_of(any_engine, folder, pair, 0)
    np.testing.assert_array_equal(bits & 0xFFFF, most)
    np.testing.assert_array_equal(bits >> 16, codes & 0xFFFF)
    stored = np.arange(2**16).astype(np.uint16)
    stored = stored if low == 0 else stored.view(np.int16)
    expected = np.clip(stored.astype(number) / number(most), low, 1)
    back = f"floatBitsToUint(unpack{kind}2x16(i << 16).y)"
    bits = bits_of(any_engine, folder, back, 24) | bits_of(any_engine, folder, back, 0)
    np.testing.assert_allclose(bits.view(number), expected, rtol=3e-7)  # of a quotient: 2.5 ULP


def test_a_text_s_own_packing_is_its_own(any_engine, ctx, folder):
    own = "uint packHalf2x16(vec2 v) { return 7u; }\nvec2 unpackHalf2x16(uint u) { return vec2(float(u)); }\n"
    for head in ("", "#define packUnorm2x16(v) 7u\n"):
        called = "packUnorm2x16" if head else "packHalf2x16"
        text = TOY.format(f"vec4(float({called}(vec2(1.0))) / 255.0)")
        picture = drawn(any_engine, folder.write("own.frag", (head or own) + text))
        assert set(picture[..., 0].ravel()) == {7}
    for version, packs in ((330, True), (420, False)):
        text = f"#version {version}\nuniform vec2 u_tex0Resolution;\nout vec4 o;\n"
        text += "void main() { o = vec4(unpackHalf2x16(3u), u_tex0Resolution); }\n"
        (kernel,) = kernels(folder.write("v.frag", text))
        assert ("packing.glsl" in kernel.helpers) == packs
        stages = wrap(kernel, FRAGMENT, version).stages
        ctx.program(vertex_shader=stages["vertex"].text, fragment_shader=stages["fragment"].text).release()


# ── a main of their own ──────────────────────────────────────────────────────


def test_names_that_are_ours_belong_to_the_file(any_engine, folder):
    path = CASES["main"]["our_names"].write(folder.path)
    assert [p.name for p in shader_of(path).parameters] == ["k_window_"]
    half = drawn(any_engine, path, size=(4, 2), **{"view.k_window_": 0.25})
    np.testing.assert_allclose(half[1, :, 0], [16, 48, 80, 112], atol=1)
    assert (half[..., 2] == 64).all()


def test_each_of_an_array_of_samplers_may_be_wired(any_engine, folder):
    text = CASES["main"]["sampler_array"].files["sampler_array.frag"]
    folder.write("t.frag", text.replace("texture2D(u_tex0, st)", "vec4(0.0)"))
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
    (note,) = [note for note in notes(folder.sketch(passes + view)) if "feeds" in note.message]
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
        said = [str(note) for note in notes(sketch, (8, 4))]
        said += [str(d) for _, k in kernels_of(sketch.graph) for d in warnings_of_kernel(k)]
        if "version" not in form or "sampler" in kind:
            assert sum(name in item for item in said) == 1, (name, said)
