"""ISF shaders run unchanged: inputs, passes, vertex files, where mistakes are."""

from __future__ import annotations

import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.engine.engine import Engine
from playground.errors import PlaygroundError, ShaderError
from playground.publish.large import strips
from playground.shader.wrap import FRAGMENT, wrap
from playground.sketch.model import ForeignShader
from tests.dialects.test_drawn import DEPRECATED, colours
from tests.isf_texts import STATEFUL, TEXTS, VERTEX, with_mistake

from ..loading import load

SIZE = (32, 18)
STATELESS = [name for name in TEXTS if name not in STATEFUL]
WAVES = "float wave(float x) {\n    return 0.5 + 0.5 * sin(x * 9.0 + TIME) * level;\n}\n"


@pytest.fixture
def isf(folder):
    """Write a text, or that of a name, with what belongs to it; give its path."""

    def written(text, vertex="", name="shader"):
        if text in TEXTS:
            name, vertex, text = text, vertex or VERTEX.get(text, ""), TEXTS[text]
        folder.write("waves.glsl", WAVES)
        if vertex:
            folder.write(f"{name}.vs", vertex)
        if not (folder.path / "photo.png").exists():
            pixels = np.random.default_rng(5).integers(0, 256, (6, 8, 4), dtype=np.uint8)
            pixels[..., 3] = 255
            write_png(folder.path / "photo.png", pixels)
        return folder.write(f"{name}.fs", text)

    return written


def drawn(engine, path, time=0.0, size=SIZE, **values):
    return engine.render(load(path).with_values(values), size=size, time=time).array


def kernels(path):
    return [kernel for _, kernel in load(path).graph.kernels if isinstance(kernel, ForeignShader)]


@pytest.mark.parametrize("name", TEXTS)
def test_isf_shader_is_deterministic_at_fixed_time(any_engine, ctx, isf, name):
    path = isf(name)
    first = drawn(any_engine, path, 1.0)
    assert colours(first) > 1
    assert ctx.error == "GL_NO_ERROR"
    any_engine.cache.clear()
    drawn(any_engine, path, 2.0)
    np.testing.assert_array_equal(drawn(any_engine, path, 1.0), first)
    with Engine(ctx) as fresh:
        np.testing.assert_array_equal(drawn(fresh, path, 1.0), first)


@pytest.mark.parametrize("name", TEXTS)
def test_a_mistake_is_at_its_own_line(any_engine, isf, name):
    text, line = with_mistake(TEXTS[name])
    with pytest.raises(ShaderError) as caught:
        drawn(any_engine, isf(text, VERTEX.get(name, "")))
    diagnostic = caught.value.diagnostics[0]
    assert (diagnostic.line, diagnostic.file.endswith("shader.fs")) == (line, True)
    assert "not_declared" in diagnostic.message


@pytest.mark.parametrize("name", VERTEX)
def test_a_mistake_of_a_vertex_shader_is_at_its_own_line(any_engine, isf, name):
    vertex, line = with_mistake(VERTEX[name])
    with pytest.raises(ShaderError) as caught:
        drawn(any_engine, isf(TEXTS[name], vertex))
    diagnostic = caught.value.diagnostics[0]
    assert (diagnostic.line, diagnostic.file.endswith("shader.vs")) == (line, True)
    assert "not_declared" in diagnostic.message


def test_a_mistake_of_an_include_is_at_its_own_line(any_engine, isf, folder):
    path = isf("includes")
    folder.write("waves.glsl", WAVES.replace("level", "not_declared"))
    with pytest.raises(ShaderError) as caught:
        drawn(any_engine, path)
    diagnostic = caught.value.diagnostics[0]
    assert (diagnostic.line, diagnostic.file.endswith("waves.glsl"), len(diagnostic.chain)) == (2, True, 1)


@pytest.mark.parametrize("name", TEXTS)
def test_the_driver_gets_no_deprecated_name(isf, name):
    for kernel in kernels(isf(name)):
        for stage in wrap(kernel, FRAGMENT, 450).stages.values():
            assert not [word for line in stage.text.split("\n") for word in DEPRECATED.findall(line)]


@pytest.mark.parametrize("name", ["given", "inputs", "with_vertex_1"])
def test_a_picture_drawn_in_parts_is_the_picture_drawn_whole(any_engine, isf, name):
    sketch = load(isf(name))
    whole = any_engine.render(sketch, size=SIZE, time=1.0).array
    parts = np.concatenate(list(strips(any_engine, sketch, SIZE, tile=(20, 8), time=1.0)))
    np.testing.assert_allclose(parts.astype(int), whole, atol=1)


# ── what is given ────────────────────────────────────────────────────────────

ONE = '/*{{"ISFVSN": "2", "INPUTS": [{}]{}}}*/\nvoid main() {{\n    gl_FragColor = {};\n}}\n'


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("vec4(TIME / 4.0, float(FRAMEINDEX) / 128.0, RENDERSIZE / 64.0)", [96, 179, 128, 72]),
        ("vec4(TIMEDELTA * 60.0, DATE.x / 3940.0, DATE.y / 4.0, DATE.z / 4.0)", [255, 128, 64, 64]),
        ("vec4(isf_FragNormCoord * 8.0, float(PASSINDEX), 1.0)", [32, 255, 0, 255]),
    ],
)
def test_what_isf_gives(any_engine, isf, expression, expected):
    picture = drawn(any_engine, isf(ONE.format("", "", expression)), 1.5)
    np.testing.assert_allclose(picture[0, 0], expected, atol=1)


def test_coordinates_are_the_picture_s_of_a_filter_too(any_engine, isf):
    image = '{"NAME": "inputImage", "TYPE": "image"}'
    text = ONE.format(image, "", "abs(IMG_PIXEL(inputImage, gl_FragCoord.xy) - IMG_THIS_PIXEL(inputImage))")
    assert drawn(any_engine, isf(text))[..., :3].max() == 0


def test_a_colour_is_as_it_is_written_and_shown(any_engine, isf):
    tint = '{"NAME": "tint", "TYPE": "color", "DEFAULT": [1.0, 0.5, 0.25, 1.0]}'
    path = isf(ONE.format(tint, "", "tint"))
    np.testing.assert_allclose(drawn(any_engine, path)[0, 0], [255, 128, 64, 255], atol=1)
    np.testing.assert_array_equal(
        drawn(any_engine, path, **{"view.tint": "#336699"})[0, 0], [0x33, 0x66, 0x99, 255]
    )


def test_values_of_inputs(any_engine, isf):
    path = isf("inputs")
    result = {p.name: p for p in load(path).graph.find("view").technique.parameters}
    assert {name: (p.widget.kind, p.default) for name, p in result.items()} == {
        "level": ("slider", 0.5),
        "on": ("checkbox", True),
        "go": ("button", False),
        "mode": ("menu", 1),
        "centre": ("point", (0.25, 0.0)),
        "tint": ("colour", (1.0, 0.5, 0.25, 1.0)),
    }
    assert (result["level"].title, result["level"].line) == ("Level of red", 4)
    off = drawn(any_engine, path, **{"view.on": False, "view.level": 0.25, "view.mode": "nine"})
    np.testing.assert_allclose(off[0, 0, :3], 255 * 0.25 * 9 / 4, atol=1)
    any_engine.runner.pressed = frozenset({"view.go"})
    pressed = drawn(any_engine, path, **{"view.on": False, "view.level": 0.25})
    any_engine.runner.pressed = frozenset()
    np.testing.assert_allclose(pressed[0, 0, :3], 255 * 0.75, atol=1)


def test_a_value_that_the_text_names_once_counts(any_engine, isf):
    path = isf(ONE.format('{"NAME": "level", "TYPE": "float"}', "", "vec4(level)"))
    made = [drawn(any_engine, path, **{"view.level": value})[0, 0, 0] for value in (0.2, 0.8, 0.2)]
    assert made == [51, 204, 51]


def test_no_defaults(isf):
    result = {p.name: p for p in load(isf("no_defaults")).graph.find("view").technique.parameters}
    assert {name: p.default for name, p in result.items()} == {
        "a": 0.5,
        "b": 3.0,
        "c": True,
        "d": (0.5, 0.5),
        "e": (0.0, 0.0, 0.0, 1.0),
        "f": 3.0,
    }


def test_menus_of_every_form(isf):
    result = {p.name: p for p in load(isf("long_alone")).graph.find("view").technique.parameters}
    assert (result["a"].widget.choices, result["a"].default) == (("zero", "one"), 1)
    assert (result["b"].widget.values, result["b"].default) == ((2, 2, 7), 0)
    assert len(set(result["b"].widget.choices)) == 3
    assert (result["c"].widget.kind, result["c"].default) == ("number", 0)


def test_places_in_pixels_without_a_range_are_kept(isf):
    (result,) = load(isf("pixels_1")).graph.find("view").technique.parameters
    assert (result.default, result.widget.axes) == ((16.0, 9.0), ((0.0, 16.0), (0.0, 9.0)))


# ── passes ───────────────────────────────────────────────────────────────────


def sizes(engine, path, size=(64, 36), **values):
    plan = engine.plan(load(path).with_values(values), size)
    return {
        step.path: (step.size, step.kernel.outputs[0].format)
        for step in plan.walk()
        if isinstance(step.kernel, ForeignShader)
    }


def test_passes_have_their_sizes_and_formats(any_engine, isf):
    path = isf("passes")
    assert sizes(any_engine, path) == {
        "view.across": ((32, 36), "rgba8"),
        "view.both": ((16, 9), "rgba32f"),
        "view.pass_2": ((64, 36), "rgba8"),
    }
    assert sizes(any_engine, path, **{"view.blurAmount": 5.0})["view.across"][0] == (12, 36)


def test_a_target_that_recurs_gives_its_latest_write(any_engine, isf):
    picture = drawn(any_engine, isf("recurring"))
    # Five passes, each adding 0.05 of blue to what the one before it gave, in bytes.
    np.testing.assert_allclose(picture[0, 0, 2], 5 * 0.05 * 255, atol=3)
    north_east = picture[0, -1]
    np.testing.assert_allclose(north_east[0], min(255, 5 * 0.2 * 255 * (31.5 / 32)), atol=3)


def test_what_a_later_pass_writes_and_nothing_keeps_reads_zero(any_engine, isf):
    picture = drawn(any_engine, isf("self_read"), 1.0)
    np.testing.assert_allclose(picture[-1, 0, :3], [255 / 64, 255 / 36, 0], atol=1)


@pytest.mark.parametrize(
    ("size", "words", "line"),
    [
        ('"WIDTH": "$WDTH / 2"', r"WIDTH of pass 0: .*names '\$WDTH'.*did you mean '\$WIDTH'", 1),
        ('"WIDTH": "sqrt($WIDTH)"', "calls 'sqrt'", 1),
        ('"HEIGHT": "$HEIGHT /"', "HEIGHT of pass 0: .*is not an expression", 1),
        ('"WIDTH": "import os"', "is not an expression", 1),
        ('"WIDTH": [1]', "is no size", 1),
        ('"WIDTH": "(1, 2)"', r"WIDTH of pass 0: '\(1, 2\)' holds something other", 1),
        ('"WIDTH": "WIDTH / 2"', r"'WIDTH / 2' names 'WIDTH', .*there are: \$WIDTH, \$HEIGHT", 1),
    ],
)
def test_a_size_that_cannot_be(isf, size, words, line):
    text = ONE.format("", f', "PASSES": [{{"TARGET": "a", {size}}}, {{}}]', "IMG_THIS_PIXEL(a)")
    with pytest.raises(PlaygroundError, match=words) as caught:
        load(isf(text))
    assert caught.value.diagnostics[0].line == line


@pytest.mark.parametrize(
    ("size", "expected"),
    [
        ("$WIDTH * 0.001", 1),
        ("7", 7),
        ("clamp($WIDTH, 1, 10)", 10),
        ("ceil($WIDTH / 3.0)", 22),
        ("mod($WIDTH, 5)", 4),
        ("pow(2, 3)", 8),
        ("trunc($WIDTH / 3.0)", 21),
        ("abs(-9)", 9),
    ],
)
def test_sizes_are_whole_and_at_least_one(any_engine, isf, size, expected):
    text = ONE.format("", f', "PASSES": [{{"TARGET": "a", "WIDTH": "{size}"}}, {{}}]', "IMG_THIS_PIXEL(a)")
    assert sizes(any_engine, isf(text))["view.a"][0] == (expected, 36)


def test_an_absurd_size_is_refused(any_engine, isf):
    text = ONE.format(
        "", ', "PASSES": [{"TARGET": "a", "WIDTH": "$WIDTH * 100000"}, {}]', "IMG_THIS_PIXEL(a)"
    )
    with pytest.raises(PlaygroundError, match="1 to 16384 a side were expected"):
        drawn(any_engine, isf(text))


def test_a_target_that_nobody_writes_is_one_sentence(isf):
    more = ', "PERSISTENT_BUFFERS": ["kept"], "PASSES": [{"TARGET": "a"}, {}]'
    with pytest.raises(ShaderError, match="kept reads 'kept', which no pass writes") as caught:
        load(isf(ONE.format("", more, "IMG_THIS_PIXEL(kept)")))
    assert caught.value.diagnostics[0].line == 3


def test_last_isf_pass_is_picture_despite_target_and_size(any_engine, isf):
    passes = ', "PASSES": [{"TARGET": "a"}, {"TARGET": "b", "WIDTH": "2", "FLOAT": true}]'
    path = isf(ONE.format("", passes, "vec4(isf_FragNormCoord, float(PASSINDEX), 1.0)"))
    picture = drawn(any_engine, path)
    assert picture.shape == (18, 32, 4) and (picture[..., 2] == 255).all() and colours(picture) > 2
    assert "is the last, so it is the picture" in load(path).graph.warnings[0].message


def test_a_kept_target_counts_the_frames(any_engine, isf):
    passes = ', "PASSES": [{"TARGET": "a", "PERSISTENT": 1, "FLOAT": "true", "WIDTH": 1, "HEIGHT": 1}, {}]'
    text = ONE.format("", passes, "IMG_PIXEL(a, vec2(0.5)) + (PASSINDEX == 0 ? 1.0 / 128.0 : 0.0)")
    for time, frames in ((0.0, 1), (0.5, 31), (1.0, 61), (0.5, 31)):
        result = drawn(any_engine, isf(text), time)[0, 0, 0]
        assert result == round(255 * frames / 128)


def test_cells_live_and_die_as_numpy_s_do(any_engine, isf):
    def frame(number):
        return drawn(any_engine, isf("game"), (number - 1) / 60, size=(64, 36))[::2, ::2, 0] > 127

    cells = frame(1)
    assert 0.2 < cells.mean() < 0.6
    for number in (2, 3, 4):
        edge = np.pad(cells, 1, mode="edge").astype(int)  # texels beyond the edge are those at the edge
        around = sum(np.roll(np.roll(edge, y, 0), x, 1) for y in (-1, 0, 1) for x in (-1, 0, 1))[1:-1, 1:-1]
        around = around - cells
        cells = (around == 3) | ((around == 2) & cells)
        np.testing.assert_array_equal(frame(number), cells)


# ── files beside it ──────────────────────────────────────────────────────────


def test_a_vertex_file_is_followed_and_one_that_comes_is_read(any_engine, isf, folder):
    text = TEXTS["with_vertex_1"]
    path = isf(text)
    without = drawn(any_engine, path)
    vertex = folder.write("shader.vs", VERTEX["with_vertex_1"])
    assert str(vertex) in load(path).files
    turned = drawn(any_engine, path)
    assert not np.array_equal(without, turned)
    folder.write("shader.vs", VERTEX["with_vertex_1"].replace("cos(turn)", "cos(turn * 2.0)"))
    assert not np.array_equal(turned, drawn(any_engine, path))
    assert not np.array_equal(turned, drawn(any_engine, path, **{"view.turn": 1.0}))


def test_clamped_vertex_coordinates_leave_isf_picture_unchanged(any_engine, isf):
    text = '/*{"ISFVSN": "2", "INPUTS": []}*/\nvarying vec2 at;\n'
    text += "void main() { gl_FragColor = vec4(at, 0, 1); }\n"
    vertex = (
        "varying vec2 at;\nvoid main() { isf_vertShaderInit(); at = clamp(isf_FragNormCoord, 0.0, 1.0); }\n"
    )
    picture = drawn(any_engine, isf(text, vertex), size=(4, 2))
    np.testing.assert_allclose(picture[0, :, 0], [32, 96, 159, 223], atol=1)
    np.testing.assert_allclose(picture[:, 0, 1], [191, 64], atol=1)


def test_an_imported_image_is_as_in_its_file(any_engine, isf, folder):
    pixels = np.random.default_rng(7).integers(0, 256, (6, 8, 4), dtype=np.uint8)
    pixels[..., 3] = 255
    write_png(folder.path / "photo.png", pixels)
    picture = drawn(any_engine, isf("imported_1"), size=(8, 6))
    np.testing.assert_allclose(picture, pixels, atol=1)
    missing = isf(TEXTS["imported_1"].replace("photo.png", "gone.png"))
    assert colours(drawn(any_engine, missing)) > 1
    (kernel,) = kernels(missing)
    assert kernel.unfed == (("photo", "there is no file './gone.png', so a stand-in is drawn"),)
    outside = isf(TEXTS["imported_1"].replace("./photo.png", "../../x.png"))
    assert "lies outside the sketch's folder" in kernels(outside)[0].unfed[0][1]


SIX = ["right", "left", "top", "bottom", "front", "back"]
CUBE = """/*{{"ISFVSN": "1", "INPUTS": [], "IMPORTED": [{{"NAME": "around", "TYPE": "cube", "PATH": {}}}]}}*/
uniform vec3 towards;  //! Which way
void main() {{ gl_FragColor = textureCube(around, towards); }}
"""


def test_a_cube_of_six_images(any_engine, isf, folder):
    for number, name in enumerate(SIX):
        face = np.full((4, 4, 4), 255, np.uint8)
        face[..., 0] = 40 * number
        (folder.path / "faces").mkdir(exist_ok=True)
        write_png(folder.path / "faces" / f"{name}.png", face)
    paths = [f"faces/{name}.png" for name in SIX]
    path = isf(CUBE.format(str(paths).replace("'", '"')))
    ways = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    seen = [int(drawn(any_engine, path, size=(2, 2), **{"view.towards": way})[0, 0, 0]) for way in ways]
    np.testing.assert_allclose(seen, [0, 40, 80, 120, 160, 200], atol=1)
    missing = isf(CUBE.format(str([*paths[:5], "faces/x.png"]).replace("'", '"')))
    assert kernels(missing)[0].unfed[0][1] == "there is no file 'faces/x.png', so a sky stands in"
    with pytest.raises(ShaderError, match="cube 'around' needs the paths of six images"):
        load(isf(CUBE.format('["a.png"]')))


# ── bad input ────────────────────────────────────────────────────────────────

MAIN = "\nvoid main() { gl_FragColor = vec4(1.0); }\n"


@pytest.mark.parametrize(
    ("header", "words", "position"),
    [
        (
            '/*{"INPUTS": [\n  {"NAME": "a" "TYPE": "float"}]}*/',
            "not JSON: expecting ',' delimiter, found",
            (2, 16),
        ),
        ('/*{"INPUTS": [\n  {"NAME": "a",\n*/', "not JSON: .*it ends here", (2, 16)),
        ('/*{"INPUTS": 5}*/', "INPUTS: expected a list of objects", (1, 0)),
        ('/*{"INPUTS": [\n{"NAME": "a b", "TYPE": "float"}]}*/', "a NAME that GLSL can use", (2, 0)),
        ('/*{"INPUTS": [\n{"TYPE": "float"}]}*/', "a NAME that GLSL can use", (1, 0)),
        (
            '/*{"INPUTS": [{"NAME": "a", "TYPE": "float"},\n{"NAME": "TIME", "TYPE": "float"}]}*/',
            "cannot be called 'TIME': ISF itself gives this name",
            (2, 0),
        ),
        (
            '/*{"INPUTS": [{"NAME": "a", "TYPE": "float"}, {"NAME": "a", "TYPE": "bool"}]}*/',
            "two inputs have this name",
            (1, 0),
        ),
        ('/*{"INPUTS": [], "PASSES": [{"TARGET": "a-b"}, {}]}*/', "needs a name that GLSL can use", (1, 0)),
        ('/*{"INPUTS": [], "IMPORTED": {"a": {}}}*/', "needs the path of its file", (1, 0)),
    ],
)
def test_a_wrong_description_is_one_sentence_at_its_place(isf, header, words, position):
    with pytest.raises(ShaderError, match=words) as caught:
        load(isf(header + MAIN))
    diagnostic = caught.value.diagnostics[0]
    assert (diagnostic.line, diagnostic.column) == position


def test_no_main_is_one_sentence(isf):
    with pytest.raises(ShaderError, match=r"needs a main\(\) of its own"):
        load(isf('/*{"ISFVSN": "2", "INPUTS": []}*/\nfloat x;\n'))
    with pytest.raises(ShaderError, match=r"a vertex shader needs a main\(\)"):
        load(isf('/*{"ISFVSN": "2", "INPUTS": []}*/' + MAIN, "float x;\n"))


def test_unknown_keys_are_named_once_with_the_nearest(isf):
    header = '/*{"ISFVSN": "2", "INPUT": [], "PASSES": [{"TARGET": "a",\n"PERSISTANT": true}, {}]}*/'
    notes = load(isf(header + MAIN)).graph.warnings
    assert [(note.line, note.message) for note in notes][:2] == [
        (1, "INPUT of the description means nothing here, and is left out; did you mean 'INPUTS'?"),
        (2, "PERSISTANT of pass 0 means nothing here, and is left out; did you mean 'PERSISTENT'?"),
    ]


def test_an_unknown_type_is_named_and_left_out(any_engine, isf):
    inputs = '{"NAME": "a", "TYPE": "flaot"}, {"NAME": "b", "TYPE": "COLOR", "DEFAULT": [1, 0, 0, 1]}'
    path = isf(ONE.format(inputs, "", "b"))
    assert [note.message for note in load(path).graph.warnings] == [
        "input 'a' is left out: ISF has no type 'flaot'; did you mean 'float'?"
    ]
    np.testing.assert_array_equal(drawn(any_engine, path)[0, 0], [255, 0, 0, 255])


def test_other_kinds_of_shaders_are_not_drawn(isf):
    header = '/*{"INPUTS": [],\n"MODE": "VERTEX_SHADER_ART"}*/'
    with pytest.raises(ShaderError, match="MODE VERTEX_SHADER_ART: only ISF's own kind is drawn") as caught:
        load(isf(header + MAIN))
    assert caught.value.diagnostics[0].line == 2


def test_a_comment_may_come_before_the_description(any_engine, isf):
    text = "// A licence\n\n// of two lines\n" + TEXTS["tabs"]
    path = isf(text)
    assert colours(drawn(any_engine, path)) > 1
    assert load(path).graph.find("view").technique.parameters[0].line == 10


def test_a_name_with_blanks_has_its_vertex_shader(any_engine, isf, folder):
    folder.write("Edge of it.vs", VERTEX["with_vertex"])
    path = folder.write("Edge of it.fs", TEXTS["with_vertex"])
    assert kernels(path)[0].vertex_source is not None and colours(drawn(any_engine, path)) > 1


def test_a_key_in_small_letters_is_named(isf):
    (note,) = load(
        isf('/*{"INPUTS": [{"NAME": "a", "TYPE": "float", "default": 1}]}*/' + MAIN)
    ).graph.warnings
    assert note.message == "default of input 'a' means nothing here, and is left out; did you mean 'DEFAULT'?"


def test_its_title_and_dialect(isf):
    assert load(isf("given")).title == "All that ISF gives, by the tests (isf)"
