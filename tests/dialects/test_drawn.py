"""Shaders of other tools run unchanged: what they are given, what feeds them, where mistakes are."""

from __future__ import annotations

import re

import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.dialects.foreign import unfed_warnings
from playground.engine.engine import Engine
from playground.engine.plan import PlanRequest
from playground.engine.plan_warnings import source_warnings
from playground.engine.planner import make_plan
from playground.engine.sandbox import Sandbox
from playground.errors import ParameterError, PlaygroundError, ShaderError, SketchError
from playground.publish.large import strips
from playground.shader.wrap import FRAGMENT, wrap
from playground.sketch.load import load
from playground.sketch.model import ForeignShader, kernels_of
from playground.sketch.replace_technique import with_texts
from playground.sketch.traits import traits_of
from playground.verify.check import check_file
from playground.verify.reduce.case import inline_sketch
from tests.dialect_texts import TEXTS, with_mistake

SIZE = (32, 18)
TOY = "void mainImage(out vec4 c, in vec2 p) {{ c = {}; }}\n"
MAIN = "{}\nvoid main() {{ gl_FragColor = {}; }}\n"
DEPRECATED = re.compile(
    r"\b(?:varying|attribute|gl_FragColor|gl_FragData|gl_FragDepthEXT"
    r"|(?:texture|shadow)(?:[123]D|Cube|2DRect)\w*)\b"
)


def drawn(engine, path, time=0.0, size=SIZE, **values):
    return engine.render(load(path).with_values(values), size=size, time=time).array


def colours(picture):
    return len(np.unique(picture[..., :3].reshape(-1, 3), axis=0))


@pytest.mark.parametrize("name", TEXTS)
def test_dialect_shader_is_deterministic_at_fixed_time(any_engine, ctx, folder, name):
    path = folder.write(f"{name}.frag", TEXTS[name])
    first = drawn(any_engine, path, 1.0)
    assert colours(first) > 1
    any_engine.cache.clear()
    drawn(any_engine, path, 2.0)
    np.testing.assert_array_equal(drawn(any_engine, path, 1.0), first)
    with Engine(ctx) as fresh:
        np.testing.assert_array_equal(drawn(fresh, path, 1.0), first)


@pytest.mark.parametrize("name", TEXTS)
def test_a_mistake_is_at_its_own_line(any_engine, folder, name):
    text, line = with_mistake(TEXTS[name])
    with pytest.raises(ShaderError) as caught:
        drawn(any_engine, folder.write(f"{name}.frag", text))
    diagnostic = caught.value.diagnostics[0]
    assert (diagnostic.line, diagnostic.file.endswith(f"{name}.frag")) == (line, True)
    assert "not_declared" in diagnostic.message


@pytest.mark.parametrize("name", TEXTS)
def test_the_driver_gets_no_deprecated_name(folder, name):
    kernels = kernels_of(load(folder.write(f"{name}.frag", TEXTS[name])).graph.find("view").technique)
    stages = [stage for _, kernel in kernels for stage in wrap(kernel, FRAGMENT, 450).stages.values()]
    left = [word for stage in stages for line in stage.text.split("\n") for word in DEPRECATED.findall(line)]
    assert stages and not left


def test_a_mistake_in_an_include_is_at_the_include_s_line(any_engine, folder):
    folder.write("sketch.toml", "")  # so that this folder is the root
    folder.write("lib/deep/inner.glsl", "float inner() {\n    return not_declared;\n}\n")
    folder.write(
        "lib/outer.glsl", "#pragma once\n#include <lib/deep/inner.glsl>\nfloat outer() { return inner(); }\n"
    )
    top = '#include "outer.glsl"\n#include "lib/outer.glsl"\nvoid main() { gl_FragColor = vec4(outer()); }\n'
    path = folder.write("lib/a/b.frag", top)
    with pytest.raises(ShaderError) as caught:
        drawn(any_engine, path)
    diagnostic = caught.value.diagnostics[0]
    assert (diagnostic.file.endswith("lib/deep/inner.glsl"), diagnostic.line, len(diagnostic.chain)) == (
        True,
        2,
        2,
    )
    folder.write("lib/deep/inner.glsl", "float inner() { return gl_FragCoord.x / 32.0; }\n")
    assert colours(drawn(any_engine, path)) == SIZE[0]


def test_an_include_outside_the_folder_is_refused_at_its_line(any_engine, folder):
    folder.write("x.glsl", "float x;\n")
    path = folder.write("own/a.frag", '\n#include "../x.glsl"\nvoid main() {}\n')
    with pytest.raises(ShaderError, match="lies outside") as caught:
        load(path)
    assert caught.value.diagnostics[0].line == 2


# ── what is given ────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("vec4(iTime / 4.0, float(iFrame) / 128.0, iResolution.z, 0.0)", [128, 179, 255, 255]),
        ("vec4(iTimeDelta * 60.0, iFrameRate / 60.0, iSampleRate / 88200.0, 1.0)", [255, 255, 128, 255]),
        ("vec4(iDate.x / 3940.0, iDate.y, iDate.z, iDate.w)", [128, 0, 255, 255]),
        ("vec4(iChannelResolution[1] / 512.0, iChannelTime[2])", [128, 128, 0, 255]),
        ("iMouse + vec4(iGlobalTime - iTime)", [0, 0, 0, 255]),
    ],
)
def test_what_shadertoy_gives(any_engine, folder, expression, expected):
    more = "+ 0.0 * texture(iChannel1, p)" if "Resolution[" in expression else ""
    picture = drawn(any_engine, folder.write("t.frag", TOY.format(f"{expression} {more}")), 1.5)
    if "iTime /" in expression:
        expected = [96, 179, 255, 255]  # 1.5 / 4, 90 / 128
    np.testing.assert_allclose(picture[0, 0], expected, atol=1)


def test_the_mouse_of_each_dialect(any_engine, folder):
    any_engine.runner.hover, any_engine.runner.drag = (16.0, 9.0), (8.0, 4.0, -2.0, -1.0)
    toy = drawn(any_engine, folder.write("t.frag", TOY.format("vec4(iMouse.xy, -iMouse.zw) / 16.0")))
    np.testing.assert_allclose(toy[0, 0], [128, 64, 32, 255], atol=1)
    hover = MAIN.format("uniform vec3 u_mouse;", "vec4(u_mouse.xy / 32.0, 0.0, 1.0)")
    np.testing.assert_allclose(
        drawn(any_engine, folder.write("u.frag", hover))[0, 0], [128, 72, 0, 255], atol=1
    )
    share = MAIN.format("uniform vec2 mouse;", "vec4(mouse, 0.0, 1.0)")
    np.testing.assert_allclose(
        drawn(any_engine, folder.write("s.frag", share))[0, 0], [128, 128, 0, 255], atol=1
    )


def test_shadertoy_s_alpha_is_ignored(any_engine, folder):
    assert (
        drawn(any_engine, folder.write("t.frag", TOY.format("vec4(0.5, 0.5, 0.5, 0.0)")))[..., 3] == 255
    ).all()


def test_coordinates_of_a_vertex_shader_run_over_the_picture(any_engine, folder):
    text = "varying vec2 vUv;\nvoid main() { gl_FragColor = vec4(vUv, 0.0, 1.0); }\n"
    picture = drawn(any_engine, folder.write("t.frag", text), size=(4, 2))
    np.testing.assert_allclose(picture[0, :, 0], [32, 96, 159, 223], atol=1)
    np.testing.assert_allclose(picture[:, 0, 1], [191, 64], atol=1)  # north on top


def test_custom_uniforms_are_parameters_if_panel_supports_them(any_engine, folder):
    text = (
        "uniform float level; uniform float other;\nuniform float twice = 2.0 * 0.5;\n"
        "#ifdef NEVER\nuniform vec2 both;\n#else\nuniform float both;\n#endif\nuniform float own = 0.25;\n"
        "void main() { gl_FragColor = vec4(level, own, twice + other, 1.0); }\n"
    )
    path = folder.write("t.frag", text)
    shown = [p.name for p in load(path).graph.find("view").technique.parameters]
    assert shown == ["level", "other", "both", "own"]
    np.testing.assert_allclose(drawn(any_engine, path)[0, 0], [0, 64, 255, 255], atol=1)
    np.testing.assert_allclose(drawn(any_engine, path, **{"view.own": 1.0})[0, 0], [0, 255, 255, 255], atol=1)


def test_multi_declarator_and_multiline_uniforms_are_parameters(folder):
    text = (
        "uniform float u_time; uniform float a = 0.5, b; uniform vec2 many[2], c = vec2(1.0, 2.0);\n"
        "uniform vec3\n    tint;  //! colour What it is multiplied by\n"
        "void main() { gl_FragColor = vec4(tint * a, b + c.x + many[0].x + u_time); }\n"
    )
    parameters = load(folder.write("t.frag", text)).graph.find("view").technique.parameters
    assert {p.name: (p.default, p.line) for p in parameters} == {
        "a": (0.5, 1),
        "b": (0.0, 1),
        "c": ((1.0, 2.0), 1),
        "tint": ((0.0, 0.0, 0.0), 3),
    }
    assert parameters[-1].widget.kind == "colour"


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
    assert [p.name for p in load(path).graph.find("view").technique.parameters] == ["u_tex0", "time"]
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
    pixels = np.random.default_rng(5).integers(0, 256, (6, 8, 4), dtype=np.uint8)
    pixels[..., 3] = 255
    path = folder.write("t.frag", PHOTO)
    (note,) = unfed_warnings(load(path).graph.find("view").technique, ())
    assert (note.line, note.message) == (
        2,
        "nothing feeds u_tex0: there is no file 'photo.png', so a stand-in is drawn",
    )
    assert colours(drawn(any_engine, path)) > 1
    write_png(folder.path / "photo.png", pixels)
    assert load(path).graph.find("view").technique.unfed == ()
    np.testing.assert_allclose(drawn(any_engine, path, size=(8, 6)), pixels, atol=1)


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
    text = TEXTS["kodelife"]
    plan = make_plan(load(folder.write("t.frag", text)), PlanRequest(frame_size=SIZE))
    sound, fed = source_warnings(plan)
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
        plan = make_plan(folder.sketch(passes + view.format(inputs)), PlanRequest(frame_size=SIZE))
        assert [w.message.split(":")[0] for w in source_warnings(plan)] == [
            f"nothing feeds {n}" for n in left
        ]


# ── which dialect ────────────────────────────────────────────────────────────


def test_a_dialect_may_be_named(any_engine, folder):
    both = "#ifdef HW_PERFORMANCE\nvoid mainImage(out vec4 c, vec2 p) { c = vec4(1, 0, 0, 1); }\n#else\n"
    path = folder.write("t.frag", f"{both}void main() {{ gl_FragColor = vec4(0, 1, 0, 1); }}\n#endif\n")
    np.testing.assert_array_equal(
        any_engine.render(load(path, dialect="main"), size=(4, 4)).array[0, 0], [0, 255, 0, 255]
    )
    np.testing.assert_array_equal(
        any_engine.render(load(path, dialect="shadertoy"), size=(4, 4)).array[0, 0], [255, 0, 0, 255]
    )
    with pytest.raises(ParameterError, match="did you mean 'shadertoy'"):
        load(path, dialect="shadertoi")
    with pytest.raises(SketchError, match="--dialect is for a shader file"):
        load("jacksboro", dialect="main")


def test_what_is_not_read_yet_is_one_sentence(folder):
    cases = {
        "vec2 mainSound(int s, float t) { return vec2(0.0); }": "mainSound is sound, .* no mainImage",
        "void mainVR(out vec4 c, vec2 p, vec3 o, vec3 d) {}": "mainVR is for VR, .* no mainImage",
        "void mainCubemap(out vec4 c, vec2 p, vec3 o, vec3 d) {}": "a cube map alone is not drawn",
        "float x;": "nothing to run: no main, mainImage or #pragma",
    }
    for text, sentence in cases.items():
        with pytest.raises(PlaygroundError, match=sentence):
            load(folder.write("t.frag", text))


@pytest.mark.parametrize("name", ["book", "varying", "toy", "toy_declares"])
def test_a_picture_drawn_in_parts_is_the_picture_drawn_whole(any_engine, folder, name):
    sketch = load(folder.write("t.frag", TEXTS[name]))
    whole = any_engine.render(sketch, size=SIZE, time=1.0).array
    parts = np.concatenate(list(strips(any_engine, sketch, SIZE, tile=(20, 8), time=1.0)))
    np.testing.assert_allclose(parts.astype(int), whole, atol=1)


@pytest.mark.parametrize("name", ["toy", "varying", "viewer"])
def test_it_is_reduced_in_its_author_s_words(folder, name):
    text, _ = with_mistake(TEXTS[name])
    case = inline_sketch(load(folder.write("t.frag", text)), frame=SIZE)
    (item,) = case.passes
    assert item.name == "shader" and "not_declared" in item.text
    assert set(item.text.splitlines()) <= set(text.splitlines())


def test_a_text_that_replaces_the_file_is_read_as_its_dialect(any_engine, folder):
    path = folder.write("t.frag", TOY.format("vec4(0.0)"))
    changed = with_texts(load(path), {str(path): TOY.format("vec4(fract(iTime), 0.0, 0.0, 1.0)")})
    np.testing.assert_array_equal(
        any_engine.render(changed, size=(2, 2), time=1.0).array[0, 0], [0, 0, 0, 255]
    )
    assert traits_of(changed).moves and not traits_of(load(path)).moves


@pytest.mark.slow
def test_check_names_the_dialect_and_the_line(folder):
    with Sandbox() as sandbox:
        good = check_file(folder.write("good.frag", TEXTS["toy"]), sandbox)
        text, line = with_mistake(TEXTS["varying"])
        bad = check_file(folder.write("bad.frag", text), sandbox)
    assert (good.ok, good.notes) == (True, ("read as shadertoy",))
    assert ["nothing feeds iChannel0" in w.message for w in good.warnings] == [True]
    assert [d.line for d in bad.errors] == [line]


def test_the_title_names_the_dialect(folder):
    assert load(folder.write("t.frag", TEXTS["toy"])).title == "All that Shadertoy declares (shadertoy)"
    assert load(folder.write("u.frag", TEXTS["book"])).title == "u (main)"


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
    pictures = [any_engine.render(sketch, size=(2, 2), time=t).array for t in (0.0, 0.2, 0.4)]
    result = {tuple(picture[0, 0, :3].tolist()) for picture in pictures}
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
        sketch = load(folder.write("v.frag", text))
        (kernel,) = [
            k for _, k in kernels_of(sketch.graph.find("view").technique) if isinstance(k, ForeignShader)
        ]
        assert ("packing.glsl" in kernel.helpers) == packs
        stages = wrap(kernel, FRAGMENT, version).stages
        ctx.program(vertex_shader=stages["vertex"].text, fragment_shader=stages["fragment"].text).release()
