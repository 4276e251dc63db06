"""Shadertoy's shaders of several passes: exports, folders and the VS Code form, more than a case can say."""

from __future__ import annotations

import wave

import numpy as np
import pytest
import tifffile

from playground.data.image_files import write_png
from playground.errors import PlaygroundError, ShaderError
from playground.studio.channels.channels import with_source
from playground.verify.reduce.case import inline_sketch

from ..foreign_cases import CASES, TEXTS, cube, export, one, read
from ..loading import load
from .drawing import SIZE, drawn, first_texel, notes, ramp

TOYS = CASES["shadertoy"]
IMAGE, PLAIN, SHOWS, CUBE = (TEXTS[name] for name in ("image", "plain", "shows", "cube"))


@pytest.fixture
def opened(folder):
    def of(files, opens=""):
        for name, text in files.items():
            folder.write(name, text)
        return load(folder.path / opens)

    return of


# ── exports ──────────────────────────────────────────────────────────────────


@pytest.mark.slow
def test_cube_map_pass_is_sampled_by_direction_and_by_itself(any_engine, opened):
    image = "void mainImage(out vec4 c, in vec2 p) {{ c = texture(iChannel0, {}); }}"
    wire = {"id": 41, "ctype": "cubemap", "channel": 0}
    for way in np.vstack([np.eye(3), -np.eye(3), [[0.3, -0.5, 0.8], [-0.7, 0.6, -0.2]]]):
        text = export(one("Image", image.format(f"vec3({way[0]}, {way[1]}, {way[2]})"), wire), cube(CUBE))
        expected = 255 * (0.5 + 0.5 * way / np.linalg.norm(way))
        np.testing.assert_allclose(
            first_texel(any_engine, opened({"a.json": text}, "a.json"))[:3], expected, atol=2
        )
    counts = "void mainCubemap(out vec4 c, in vec2 p, in vec3 o, in vec3 d) { c = texture(iChannel0, d) + vec4(iResolution.y / 1024.0 / 255.0); }"  # noqa: E501
    text = export(one("Image", image.format("vec3(0.2, -1.0, 0.4)"), wire), cube(counts, wire))
    sketch = opened({"a.json": text}, "a.json")
    assert [first_texel(any_engine, sketch, (frame + 0.5) / 60)[0] for frame in (0, 3)] == [1, 4]


@pytest.mark.parametrize("sampler", ["mipmap", "linear"])
@pytest.mark.parametrize("kind", ["cubemap", "volume", "Cube A"])
def test_a_buffer_may_be_read_beside_a_cube_or_a_volume(any_engine, opened, kind, sampler):
    wire = {
        "id": 41 if kind == "Cube A" else "x",
        "type": kind if kind != "Cube A" else "cubemap",
        "channel": 1,
    }
    image = (
        "void mainImage(out vec4 c, in vec2 p) { vec2 s = p / iResolution.xy;"
        " c = textureLod(iChannel0, s, 0.0) + 0.0 * texture(iChannel1, vec3(s, 1.0)); }"
    )
    fills = "void mainImage(out vec4 c, in vec2 p) { c = vec4(p / iResolution.xy, 0.25, 1.0); }"
    passes = [
        one("Image", image, read(257, sampler={"filter": sampler, "wrap": "clamp"}), wire),
        one("Buffer A", fills, output=257),
        *([cube(CUBE)] if kind == "Cube A" else []),
    ]
    result = drawn(any_engine, opened({"a.json": export(*passes)}, "a.json"))
    np.testing.assert_allclose(result[..., :2] / 255, ramp(), atol=0.51 / 255 + 1e-6)
    assert (result[..., 2] == 64).all()


def test_an_image_next_to_an_export_is_read_as_its_sampler_says(any_engine, opened, folder):
    pixels = np.full((4, 4, 4), 255, np.uint8)
    pixels[:2, :, :3] = 128  # its upper half
    write_png(folder.path / "x.png", pixels)
    image = "void mainImage(out vec4 c, in vec2 p) { c = texture(iChannel0, vec2(0.5, 0.875)); }"
    for sampler, level in [
        ({}, 128),
        ({"vflip": "false"}, 255),
        ({"vflip": False}, 255),
        ({"vflip": "true", "srgb": "true"}, 255 * ((128 / 255 + 0.055) / 1.055) ** 2.4),
    ]:
        value = {"id": "a", "src": "x.png", "ctype": "texture", "channel": 0, "sampler": sampler}
        sketch = opened({"a.json": export(one("Image", image, value))}, "a.json")
        np.testing.assert_allclose(first_texel(any_engine, sketch)[0], level, atol=1)
        assert notes(sketch) == []


def test_the_title_is_the_folder_s_unless_its_image_has_one(folder):
    assert load(TOYS["folder"].write(folder.path)).title == f"{folder.path.name} (shadertoy)"


def test_line_ends_of_any_system_and_what_is_beyond_ascii(any_engine, opened):
    code = PLAIN.replace(") {", ") { // größer → und\r\n").replace(";", ";\r\n")
    sketch = opened({"a.json": export(one("Image", code))}, "a.json")
    plain = opened({"b.json": export(one("Image", PLAIN))}, "b.json")
    np.testing.assert_array_equal(drawn(any_engine, sketch), drawn(any_engine, plain))
    wrong = code.replace("c = ", "c = not_declared + ")
    with pytest.raises(ShaderError) as caught:
        drawn(any_engine, opened({"a.json": export(one("Image", wrong))}, "a.json"))
    assert caught.value.diagnostics[0].line == 2


def test_one_pass_is_reduced_and_several_are_refused(folder):
    wrong, _ = TOYS["one_pass"].with_mistake()
    (one_pass,) = inline_sketch(load(wrong.write(folder.path)), frame=SIZE).passes
    assert one_pass.suffix == ".frag" and "not_declared" in one_pass.text
    with pytest.raises(PlaygroundError, match="2 passes of another tool's shader cannot be inlined"):
        inline_sketch(load(TOYS["buffer"].write(folder.path)), frame=SIZE)


def test_sketch_may_use_toy_export_or_folder_and_wire_channels(any_engine, folder):
    folder.write("toy.json", export(one("Image", IMAGE, {"id": "a", "src": "/media/a.jpg", "channel": 0})))
    folder.write("Image.glsl", IMAGE)
    folder.write("Common.glsl", "float nothing;\n")
    for use in ("./toy", "./Image"):
        wired = 'inputs = { iChannel0 = "data" }'
        body = f'[[pass]]\nname = "data"\nuse = "foreign/black"\nsize = 4\n[view]\nuse = "{use}"\n{wired}\n'
        assert drawn(any_engine, folder.sketch(body))[..., :3].max() == 0
        assert notes(folder.sketch(body)) == []
        assert drawn(any_engine, folder.sketch(body.replace(wired, "")))[..., :3].max() > 0


def test_an_export_reads_nothing_outside_its_folder(folder, any_engine):
    value = {"id": "a", "src": "../x.png", "ctype": "texture", "channel": 0}
    folder.write("x.png", "not read")
    drawn(any_engine, load(folder.write("own/b.json", export(one("Image", IMAGE, value)))))


def test_an_export_that_is_nested_too_deep_is_refused(folder):
    path = folder.write("a.json", '{"renderpass": ' + "[" * 200_000)
    with pytest.raises(PlaygroundError, match="damaged JSON: it is nested deeper than 64 levels"):
        load(path)


# ── folders ──────────────────────────────────────────────────────────────────


COUNTS = "void mainImage(out vec4 c, in vec2 p) {{ c = vec4(float(iFrame + {}) / 255.0); }}\n"
FETCH = "void mainImage(out vec4 c, in vec2 p) {{ c = texelFetch({}, ivec2(0), 0); }}\n"


def test_a_channel_read_by_direction_is_a_sky(any_engine, opened):
    text = "void mainImage(out vec4 c, in vec2 p) { vec3 rd = -vec3(0, 1, 0); c = texture(iChannel1, rd); }\n"
    alone = opened({"a.frag": text}, "a.frag")
    assert first_texel(any_engine, alone)[2] < 102, "the ground of a sky"
    assert "nothing feeds iChannel1" in notes(alone)[0].message


@pytest.mark.parametrize("opens", ["a.frag", "a.json"])
def test_another_source_of_a_cube_map_has_a_cube_s_size(any_engine, opened, opens):
    image = SHOWS.replace("iChannel0, uv", "iChannel0, vec3(uv, 1.0)")
    site = {"id": "b", "src": "/media/a/2.png", "ctype": "cubemap", "channel": 0}
    sketch = opened({"a.frag": image, "a.json": export(one("Image", image, site))}, opens)
    sky = drawn(any_engine, sketch)
    for source in ("foreign/noise", "foreign/cube_faces"):
        assert not np.array_equal(drawn(any_engine, with_source(sketch, "view.iChannel0", source)), sky)


def test_a_pass_that_comes_or_changes_is_read(any_engine, opened, folder):
    sketch = opened({"Image.glsl": FETCH.format("iChannel1"), "Buffer A.glsl": COUNTS.format(1)})
    noise = first_texel(any_engine, sketch)[0]
    folder.write("Buffer B.glsl", COUNTS.format(20))
    assert first_texel(any_engine, load(folder.path))[0] == 20 != noise
    folder.write("Buffer B.glsl", COUNTS.format(21))
    assert first_texel(any_engine, load(folder.path))[0] == 21
    named = {path.rpartition("/")[2] for path in load(folder.path).files}
    assert {"Image.glsl", "Buffer B.glsl"} <= named


def test_a_comment_gives_a_channel_the_keyboard(folder):
    sketch = load(TOYS["folder_with_a_keyboard"].write(folder.path))
    assert "foreign/keys" in [spec.use for spec in sketch.graph.passes]


# ── VS Code ──────────────────────────────────────────────────────────────────


def test_uniforms_are_parameters_with_their_ranges(any_engine, opened):
    sketch = opened(TOYS["code_uniforms"].files, "a.glsl")
    result = {p.name: p for p in sketch.graph.find("view").technique.parameters}
    level, count = result["level"], result["count"]
    assert (level.default, level.widget.kind, level.widget.low, level.widget.high) == (
        1.0,
        "slider",
        0.0,
        1.0,
    )
    assert (level.step, level.tooltip, level.line) == (0.1, "how bright", 1)
    assert (count.type, count.default, count.widget.high) == ("int", 3, 15)
    assert (result["tint"].type, result["tint"].default, result["tint"].widget.kind) == (
        "vec3",
        (1.0, 0.5, 0.0),
        "colour",
    )
    assert (result["other"].type, result["other"].default) == ("vec4", (1.0, 1.0, 1.0, 1.0))
    assert (result["place"].default, result["on"].default, result["free"].default) == (
        (0.25, 0.25),
        True,
        2.0,
    )
    dark = drawn(any_engine, sketch.with_values({"view.on": False, "view.place": (0.0, 0.0)}))
    assert dark[..., 2].max() == 0 < drawn(any_engine, sketch)[..., 0].max()


def test_an_image_of_a_channel_has_its_own_size_and_filters(any_engine, opened, folder):
    pixels = np.zeros((2, 4, 4), np.uint8)
    pixels[..., 3], pixels[:, 2:, 0], pixels[0, :, 1] = 255, 255, 255
    write_png(folder.path / "x.png", pixels)
    read_it = "void mainImage(out vec4 c, in vec2 p) {{ c = texture(iChannel0, {}); }}"
    for more, position, expected in [
        ("", "vec2(0.5, 0.25)", [128, 0]),
        ('#iChannel0::MagFilter "Nearest"\n', "vec2(0.51, 0.25)", [255, 0]),
        (
            '#iChannel0::MagFilter "Nearest"\n#iChannel0::MinFilter "LinearMipMapLinear"\n',
            "vec2(0.49, 0.75)",
            [0, 255],
        ),
        ('#iChannel0::WrapMode "Clamp"\n', "vec2(1.5, 1.5)", [255, 255]),
        ('#iChannel0::WrapMode "Repeat"\n', "vec2(1.125, 1.25)", [0, 0]),
        ('#iChannel0::WrapMode "Mirror"\n', "vec2(1.125, 1.25)", [255, 255]),
    ]:
        sketch = opened({"a.glsl": f'#iChannel0 "file://x.png"\n{more}{read_it.format(position)}'}, "a.glsl")
        np.testing.assert_allclose(first_texel(any_engine, sketch)[:2], expected, atol=1)
    size = read_it.replace(
        "texture(iChannel0, {})", "vec4(iChannelResolution[0] / 8.0, 1.0) + 0.0 * texture(iChannel0, p)"
    )
    sketch = opened(
        {"a.glsl": '#iChannel0 "file://x.png"\n' + size.replace("{{", "{").replace("}}", "}")}, "a.glsl"
    )
    np.testing.assert_allclose(first_texel(any_engine, sketch)[:3], [128, 64, 32], atol=1)


@pytest.mark.parametrize("kind", ["uint8", "uint16", "float32"])
def test_a_channel_reads_a_tiff_of_any_numbers(any_engine, opened, folder, kind):
    most = 1 if kind == "float32" else np.iinfo(kind).max
    texels = np.array([[[0.2, 0.4, 0.6], [3.0, -1.0, 0.25]]])
    texels = texels if kind == "float32" else np.clip(texels, 0, 1)
    stored = (np.rint(texels * most) if most > 1 else texels).astype(kind)
    tifffile.imwrite(folder.path / "x.tiff", stored, photometric="rgb")
    text = (
        '#iChannel0 "file://x.tiff"\nvoid mainImage(out vec4 c, in vec2 p) {\n'
        "    c = texelFetch(iChannel0, ivec2(p.x < 16.0 ? 0 : 1, 0), 0) * 0.25 + 0.25; }\n"
    )
    result = drawn(any_engine, opened({"a.frag": text}, "a.frag"))[0, [0, -1], :3] / 255
    np.testing.assert_allclose(result, texels[0] * 0.25 + 0.25, atol=0.51 / 255 + 2e-3 / 4)


def test_two_passes_may_read_two_files_by_one_channel(any_engine, opened, folder):
    for name, level in (("x", 100), ("y", 20)):
        write_png(folder.path / f"{name}.png", np.full((2, 2, 4), level, np.uint8))
    text = "void mainImage(out vec4 c, in vec2 p) {{ c = texture(iChannel0, vec2(0.5)){}; }}\n"
    files = {
        "a.glsl": '#iChannel0 "file://x.png"\n#iChannel1 "file://b.glsl"\n'
        + text.format(" + texture(iChannel1, vec2(0.5))"),
        "b.glsl": '#iChannel0 "file://y.png"\n' + text.format(""),
    }
    assert first_texel(any_engine, opened(files, "a.glsl"))[0] == 120


def test_cube_of_six_files_has_faces_placed_and_upright(any_engine, opened, folder):
    (folder.path / "six").mkdir()
    levels = {"px": 20, "nx": 60, "py": 100, "ny": 140, "pz": 180, "nz": 220}
    for face, level in levels.items():
        pixels = np.full((4, 4, 4), level, np.uint8)
        pixels[:2, :, 1] = 255  # its upper half
        write_png(folder.path / f"six/sky_{face}.png", pixels)
    ways = {
        "px": "1, .3, 0",
        "nx": "-1, .3, 0",
        "py": "0, 1, -.3",
        "ny": "0, -1, .3",
        "pz": "0, .3, 1",
        "nz": "0, .3, -1",
    }
    for face, way in ways.items():
        text = (
            '#iChannel0 "file://six/sky_{}.png"\n#iChannel0::Type "CubeMap"\n'
            f"void mainImage(out vec4 c, in vec2 p) {{ c = texture(iChannel0, vec3({way})); }}\n"
        )
        result = first_texel(any_engine, opened({"a.glsl": text}, "a.glsl"))
        np.testing.assert_allclose(result[:2], [levels[face], 255], atol=1)


@pytest.mark.parametrize("row", range(3))
def test_keys_are_those_of_the_window(any_engine, opened, row):
    name = ("isKeyDown", "isKeyPressed", "isKeyToggled")[row]
    text = (
        f"void mainImage(out vec4 c, in vec2 p) {{ c = vec4({name}(Key_A), {name}(Key_Space), 0.0, 1.0); }}"
    )
    toy = "void mainImage(out vec4 c, in vec2 p) { c = texelFetch(iChannel0, ivec2(65, ROW), 0); }"
    keyboard = {"id": "a", "src": "/presets/tex00.jpg", "ctype": "keyboard", "channel": 0}
    code = opened({"a.glsl": f"#iKeyboard\n{text}"}, "a.glsl")
    site = opened({"a.json": export(one("Image", toy.replace("ROW", str(row)), keyboard))}, "a.json")
    assert first_texel(any_engine, code)[0] == first_texel(any_engine, site)[0] == 0
    any_engine.runner.inputs.keyboard.hold([65])
    assert list(first_texel(any_engine, code)[:2]) == [255, 0]
    assert first_texel(any_engine, site)[0] == 255


def test_a_sound_file_of_a_channel_is_read(any_engine, opened, folder):
    path = folder.path / "tone.wav"
    with wave.open(str(path), "wb") as file:
        file.setparams((1, 2, 44100, 0, "NONE", ""))
        samples = np.round(12000 * np.sin(2 * np.pi * 2000 * np.arange(44100) / 44100)).astype("<i2")
        file.writeframes(samples.tobytes())
    text = (
        "void mainImage(out vec4 c, in vec2 p) { c = texture(iChannel0, vec2((p.x + 0.5) / 512.0, 0.25)); }"
    )
    sketch = opened({"a.glsl": f'#iChannel0 "file://tone.wav"\n{text}'}, "a.glsl")
    row = drawn(any_engine, sketch, 0.5, (256, 1))[0, :, 0].astype(int)
    made = {"id": "a", "src": "tone.wav", "ctype": "music", "channel": 0}
    same = opened({"a.json": export(one("Image", text, made))}, "a.json")
    np.testing.assert_array_equal(drawn(any_engine, same, 0.5, (256, 1))[0, :, 0], row)
    assert abs(int(row.argmax()) - 2000 / (44100 / 2048)) < 3 and row.max() > 100
    assert notes(sketch) == []


def test_the_button_of_the_mouse(any_engine, opened):
    text = "#iUniform float x = 0.0\nvoid mainImage(out vec4 c, in vec2 p) { c = iMouseButton + x; }\n"
    sketch = opened({"a.glsl": text}, "a.glsl")
    for press, level in [(2.0, 255), (-2.0, 0)]:
        any_engine.runner.drag = (3.0, 3.0, press, press)
        assert first_texel(any_engine, sketch)[0] == level
