"""Shadertoy's shaders of several passes are drawn: from exports, folders and the VS Code form."""

from __future__ import annotations

import json
import wave

import numpy as np
import pytest
import tifffile

from playground.data.image_files import write_png
from playground.engine.engine import Engine
from playground.engine.plan import PlanRequest
from playground.engine.plan_warnings import source_warnings
from playground.engine.planner import make_plan
from playground.errors import PlaygroundError, ShaderError
from playground.publish.large import strips
from playground.sketch.warnings import warnings_of_sketch
from playground.studio.channels.channels import with_source
from playground.verify.reduce.case import inline_sketch
from tests.toy_texts import (
    CUBE,
    EXPORTS,
    FOLDERS,
    GROWS,
    IMAGE,
    PLAIN,
    SHOWS,
    SOUND,
    VSCODE,
    A,
    Toy,
    cube,
    export,
    one,
    read,
)

from ..loading import load

SIZE = (32, 18)
TOYS: dict[str, Toy] = {**EXPORTS, **FOLDERS, **VSCODE}


@pytest.fixture
def opened(folder):
    def of(files, opens=""):
        for name, text in files.items():
            folder.write(name, text)
        return load(folder.path / opens)

    return of


def drawn(engine, sketch, time=0.0, size=SIZE):
    return engine.render(sketch, size=size, time=time).array


def notes(sketch):
    plan = make_plan(sketch, PlanRequest(frame_size=SIZE))
    return [str(d.message) for d in (*warnings_of_sketch(sketch), *source_warnings(plan))]


@pytest.mark.parametrize("name", TOYS)
def test_toy_is_deterministic_at_fixed_time(any_engine, ctx, opened, name):
    sketch = opened(TOYS[name].files, TOYS[name].opens)
    first = drawn(any_engine, sketch, 1.0)
    assert len(np.unique(first[..., :3].reshape(-1, 3), axis=0)) > 1
    any_engine.cache.clear()
    drawn(any_engine, sketch, 2.0)
    np.testing.assert_array_equal(drawn(any_engine, sketch, 1.0), first)
    with Engine(ctx) as fresh:
        np.testing.assert_array_equal(drawn(fresh, sketch, 1.0), first)


@pytest.mark.parametrize("name", TOYS)
def test_a_mistake_is_at_its_line_and_pass(any_engine, opened, name):
    files, line = TOYS[name].with_mistake()
    with pytest.raises(ShaderError) as caught:
        drawn(any_engine, opened(files, TOYS[name].opens))
    diagnostic = caught.value.diagnostics[0]
    assert (diagnostic.file.rpartition("/")[2], diagnostic.line) == (TOYS[name].at, line)
    assert "not_declared" in diagnostic.message and "not_declared" in diagnostic.excerpt


# ── exports ──────────────────────────────────────────────────────────────────


def first_texel(engine, sketch, time=0.0, size=(4, 4)):
    return drawn(engine, sketch, time, size)[0, 0].astype(int)


def test_buffer_feeds_later_passes_and_earlier_ones_next_frame(any_engine, opened):
    count = "void mainImage(out vec4 c, in vec2 p) {{ c = vec4(float(iFrame + {}) / 255.0); }}"
    plain = "void mainImage(out vec4 c, in vec2 p) { c = texelFetch(iChannel0, ivec2(0), 0); }"
    later = opened({"a.json": export(
        one("Image", plain, read(257)),
        one("Buffer A", plain, read(258), output=257),
        one("Buffer B", count.format(10), output=258),
    )}, "a.json")  # fmt: skip
    earlier = opened({"b.json": export(
        one("Image", plain, read(258)),
        one("Buffer B", plain, read(257), output=258),
        one("Buffer A", count.format(10), output=257),
    )}, "b.json")  # fmt: skip
    for frame in (0, 1, 7):
        time = (frame + 0.5) / 60
        assert first_texel(any_engine, earlier, time)[0] == 10 + frame
        assert first_texel(any_engine, later, time)[0] == (0 if frame == 0 else 9 + frame)


def test_a_buffer_keeps_fractions_negative_numbers_and_alpha(any_engine, opened):
    plain = "void mainImage(out vec4 c, in vec2 p) {{ c = {}; }}"
    sketch = opened({"a.json": export(
        one("Image", plain.format("vec4(texelFetch(iChannel0, ivec2(0), 0).wzy + 1.0, 1.0)"), read(257)),
        one("Buffer A", plain.format("vec4(9.0, -0.75, -0.5, -0.25)"), output=257),
    )}, "a.json")  # fmt: skip
    np.testing.assert_allclose(first_texel(any_engine, sketch)[:3], [191, 128, 64], atol=1)


def test_feedback_counts_the_frames(any_engine, opened):
    counts = "void mainImage(out vec4 c, in vec2 p) { c = texelFetch(iChannel1, ivec2(p), 0) + 1.0 / 255.0; }"
    image = "void mainImage(out vec4 c, in vec2 p) { c = texelFetch(iChannel0, ivec2(p), 0); }"
    sketch = opened(
        {"a.json": export(one("Image", image, read(257)), one("Buffer A", counts, read(257, 1), output=257))},
        "a.json",
    )
    for frame in (0, 5, 30):
        assert first_texel(any_engine, sketch, (frame + 0.5) / 60)[0] == frame + 1


def test_a_sampler_says_how_a_buffer_is_read(any_engine, opened):
    ramp = "void mainImage(out vec4 c, in vec2 p) { c = vec4(floor(p.x) / 3.0); }"
    image = "void mainImage(out vec4 c, in vec2 p) { c = texture(iChannel0, vec2(1.03, 0.5)); }"
    expected = {
        ("nearest", "clamp"): 255,
        ("nearest", "repeat"): 0,
        ("linear", "clamp"): 255,
        ("linear", "repeat"): (0.5 - 4 * 0.03) * 255,
    }
    for (form, wrap), value in expected.items():
        text = export(
            one("Image", image, read(257, sampler={"filter": form, "wrap": wrap})),
            one("Buffer A", ramp, output=257),
        )
        np.testing.assert_allclose(
            first_texel(any_engine, opened({"a.json": text}, "a.json"))[0], value, atol=2
        )


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
    rows, columns = np.mgrid[SIZE[1] - 0.5 : 0 : -1, 0.5 : SIZE[0]]
    expected = np.dstack([columns / SIZE[0], rows / SIZE[1], np.full(rows.shape, 0.25)])
    np.testing.assert_allclose(result[..., :3] / 255, expected, atol=0.51 / 255 + 1e-6)


def test_pixels_of_a_cube_map_pass_are_those_of_its_face(any_engine, opened):
    where = (
        "void mainCubemap(out vec4 c, in vec2 p, in vec3 o, in vec3 d) { c = vec4(p / 1024.0, 0.0, 1.0); }"
    )
    image = "void mainImage(out vec4 c, in vec2 p) {{ c = texture(iChannel0, {}); }}"
    wire = {"id": 41, "ctype": "cubemap", "channel": 0}
    for way, expected in [
        ("vec3(1.0, 0.5, 0.0)", (0.5, 0.25)),
        ("vec3(0.5, 1.0, 0.0)", (0.75, 0.5)),
        ("vec3(-0.5, 0.0, -1.0)", (0.75, 0.5)),
    ]:
        text = export(one("Image", image.format(way), wire), cube(where))
        result = first_texel(any_engine, opened({"a.json": text}, "a.json"))
        np.testing.assert_allclose(result[:2], 255 * np.array(expected), atol=2)


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


def test_what_makes_no_picture_is_named(opened):
    text = f"{PLAIN}{SOUND}\nvoid mainVR(out vec4 c, vec2 p) {{}}\n"
    for files, opens in [
        ({"a.frag": text}, "a.frag"),
        ({"a.json": export(one("Image", text))}, "a.json"),
        ({"a.frag": f"#iKeyboard\n{text}"}, "a.frag"),
    ]:
        names = notes(opened(files, opens))
        assert [note.split(",")[0] for note in names if "not drawn" in note] == [
            "mainSound is sound",
            "mainVR is for VR",
        ]


def test_what_is_not_there_is_named_once_with_its_channel(opened):
    for name, expected in {
        "site": ["iChannel0: '/media/a/1.jpg' is a file of the site", "iChannel3: it is a video"],
        "devices": [
            "iChannel0: it is music",
            "iChannel2: it is a camera",
            "a microphone",
        ],
        "sound": ["Sound is sound, which is not drawn"],
    }.items():
        text = "\n".join(notes(opened(TOYS[name].files, TOYS[name].opens)))
        for words in expected:
            assert text.count(words) == 1, text


def test_the_title_is_the_export_s_or_the_folder_s(opened, folder):
    assert opened(TOYS["buffer"].files, "shader.json").title == "Made here (export)"
    assert opened(TOYS["folder"].files).title == f"{folder.path.name} (shadertoy)"
    titled = {"Image.glsl": f"// waves on a pond.\n{PLAIN}"}
    assert opened({**TOYS["folder"].files, **titled}).title == "Waves on a pond (shadertoy)"


def test_line_ends_of_any_system_and_what_is_beyond_ascii(any_engine, opened):
    code = PLAIN.replace(") {", ") { // größer → und\r\n").replace(";", ";\r\n")
    sketch = opened({"a.json": export(one("Image", code))}, "a.json")
    plain = opened({"b.json": export(one("Image", PLAIN))}, "b.json")
    np.testing.assert_array_equal(drawn(any_engine, sketch), drawn(any_engine, plain))
    wrong = code.replace("c = ", "c = not_declared + ")
    with pytest.raises(ShaderError) as caught:
        drawn(any_engine, opened({"a.json": export(one("Image", wrong))}, "a.json"))
    assert caught.value.diagnostics[0].line == 2


@pytest.mark.parametrize("name", ["common", "cube", "code_uniforms"])
def test_a_picture_drawn_in_parts_is_the_picture_drawn_whole(any_engine, opened, name):
    sketch = opened(TOYS[name].files, TOYS[name].opens)
    whole = drawn(any_engine, sketch, 0.25)
    parts = np.concatenate(list(strips(any_engine, sketch, SIZE, tile=(20, 8), time=0.25)))
    np.testing.assert_allclose(parts.astype(int), whole, atol=1)


def test_one_pass_toy_is_reduced_and_several_passes_are_refused(opened):
    files, _ = TOYS["one_pass"].with_mistake()
    (one_pass,) = inline_sketch(opened(files, "shader.json"), frame=SIZE).passes
    assert one_pass.suffix == ".frag" and "not_declared" in one_pass.text
    with pytest.raises(PlaygroundError, match="2 passes of another tool's shader cannot be inlined"):
        inline_sketch(opened(TOYS["buffer"].files, "shader.json"), frame=SIZE)


@pytest.mark.parametrize("name", ["buffer", "feedback"])
def test_what_cannot_be_drawn_in_parts_says_so(any_engine, opened, name):
    with pytest.raises(PlaygroundError, match=r"cannot be drawn in parts: .*; choose a smaller picture"):
        list(strips(any_engine, opened(TOYS[name].files, TOYS[name].opens), SIZE, tile=(20, 8)))


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


@pytest.mark.parametrize(
    ("text", "words", "position"),
    [
        ('{"Shader": {"renderpass": [{"code": "void\\n"}}', "damaged JSON", (1, 46)),
        ('{"renderpass": ' + "[" * 200_000, "damaged JSON: it is nested deeper than 64 levels", (0, 0)),
        ('{"renderpass": 3}', "holds a list of passes called renderpass", (0, 0)),
        (export(), "there is no Image pass to draw; there is nothing", (0, 0)),
        (
            export(one("Sound", "vec2 mainSound(int s, float t) { return vec2(0); }")),
            "there is Sound",
            (0, 0),
        ),
        (export(one("Image", PLAIN), one("Image", PLAIN)), "a second pass called Image", (0, 0)),
        (json.dumps({"renderpass": ["x"]}), "is not a table of a pass", (0, 0)),
        (json.dumps({"renderpass": [{"name": "Image", "type": "image"}]}), "Image has no code", (0, 0)),
        (
            export(one("Image", IMAGE, read(257, 7)), A),
            "Image: an input for channel 7; there are 0 to 3",
            (0, 0),
        ),
    ],
)
def test_a_damaged_export_is_one_sentence(folder, text, words, position):
    with pytest.raises(PlaygroundError) as caught:
        load(folder.write("a.json", text))
    (result,) = caught.value.diagnostics
    assert words in result.message and "\n" not in result.message
    assert (result.line, result.column) == position and result.file.endswith("a.json")


def test_a_pass_without_its_function_or_what_it_reads_is_named(folder):
    for text, position, words in [
        (export(one("Image", PLAIN), one("Buffer A", "\nfloat x;\n", output=257)), ("a.json:Buffer A", 2),
         "Buffer A has no mainImage"),
        (export(one("Image", PLAIN), cube(PLAIN)), ("a.json:Cube A", 1), "no mainCubemap, but a mainImage"),
        (export(one("Image", IMAGE, read(259)), A), ("a.json:Image", 4), "iChannel0 reads 'output 259'"),
        (export(one("Image", "")), ("a.json:Image", 1), "Image has no mainImage"),
    ]:  # fmt: skip
        with pytest.raises(ShaderError) as caught:
            load(folder.write("a.json", text))
        (result,) = caught.value.diagnostics
        assert words in result.message
        assert (result.file.rpartition("/")[2], result.line) == position


def test_an_export_reads_nothing_outside_its_folder(folder, any_engine):
    folder.write("secret.glsl", "float secret = 1.0;\n")
    text = export(one("Image", '#include "../secret.glsl"\n' + PLAIN))
    with pytest.raises(ShaderError, match="outside"):
        load(folder.write("own/a.json", text))
    value = {"id": "a", "src": "../x.png", "ctype": "texture", "channel": 0}
    folder.write("x.png", "not read")
    drawn(any_engine, load(folder.write("own/b.json", export(one("Image", IMAGE, value)))))


def test_growth_differs_from_frame_to_frame(any_engine, opened):
    text = export(one("Image", IMAGE, read(257)), one("Buffer A", GROWS, read(257), output=257))
    sketch = opened({"a.json": text}, "a.json")
    blue = [first_texel(any_engine, sketch, frame / 60 + 0.001)[2] for frame in (1, 2, 10, 60)]
    np.testing.assert_allclose(blue, [0, 1, 9, 59], atol=1)


# ── folders ──────────────────────────────────────────────────────────────────


COUNTS = "void mainImage(out vec4 c, in vec2 p) {{ c = vec4(float(iFrame + {}) / 255.0); }}\n"
FETCH = "void mainImage(out vec4 c, in vec2 p) {{ c = texelFetch({}, ivec2(0), 0); }}\n"


def test_folder_channels_are_buffers_in_order_unless_directed(any_engine, opened):
    buffers = {"Buffer A.glsl": COUNTS.format(10), "BufferC.frag": COUNTS.format(30)}
    for head, channel, value in [
        ("", "iChannel0", 10),
        ("", "iChannel2", 30),
        ("// iChannel0 = BufferC\n", "iChannel0", 30),
        ('#iChannel0 "file://BufferC.frag"\n', "iChannel0", 30),
    ]:
        sketch = opened({**buffers, "Image.glsl": head + FETCH.format(channel)})
        assert first_texel(any_engine, sketch)[0] == value
        said = [note for note in notes(sketch) if "nothing says otherwise" in note]
        assert len(said) == (not head)
        assert not said or f"{channel} reads Buffer {'A' if value == 10 else 'C'}" in said[0]


def test_a_channel_that_only_common_reads_is_a_buffer(any_engine, opened):
    common = (
        "#define FIRST iChannel0\nvec4 first(vec2 at) { if (at.x < 9.0) { return texture(FIRST, at); }"
        " return vec4(0.0); }\nvec4 seen(vec2 at) { return first(at) + texture(iChannel2, at); }\n"
    )
    image = "void mainImage(out vec4 c, in vec2 p) { c = seen(p / iResolution.xy); }\n"
    fills = "void mainImage(out vec4 c, in vec2 p) { c = vec4(p / iResolution.xy, 0.0, 1.0) * %s; }\n"
    files = {"Common.glsl": common, "Image.glsl": image}
    files |= {"Buffer A.glsl": fills % "vec4(1, 0, 0, 1)", "Buffer C.glsl": fills % "vec4(0, 1, 0, 1)"}
    sketch = opened(files)
    result = drawn(any_engine, sketch)[..., :3] / 255
    rows, columns = np.mgrid[SIZE[1] - 0.5 : 0 : -1, 0.5 : SIZE[0]]
    expected = np.dstack([columns / SIZE[0], rows / SIZE[1], np.zeros(rows.shape)])
    np.testing.assert_allclose(result, expected, atol=0.51 / 255 + 1e-6)
    (said,) = notes(sketch)
    assert "iChannel0 reads Buffer A, iChannel2 reads Buffer C" in said
    view = sketch.graph.find("view")
    assert not view.repeat, "no buffer reads itself, so there is no state"


def test_a_channel_that_is_handed_on_is_a_cube_map_or_a_volume(any_engine, opened):
    text = (
        "vec3 cube(samplerCube k, vec3 u) { return texture(k, u).rgb; }\n"
        "vec3 volume(sampler3D k, vec3 u) { return texture(k, u).rgb; }\n"
        "void mainImage(out vec4 c, in vec2 p) { vec2 s = p / iResolution.xy;"
        " c = vec4(s, 0.25 + 0.0 * (cube(iChannel0, vec3(s, 1)).x + volume(iChannel1, vec3(s, 1)).x), 1); }\n"
    )
    for name in ("a.frag", "b/Image.glsl"):
        sketch = opened({name: text}, name)
        technique = sketch.graph.find("view").technique
        assert {i.name: i.shape for i in technique.inputs} == {"iChannel0": "cube", "iChannel1": "volume"}
        result = drawn(any_engine, sketch)[..., :3] / 255
        rows, columns = np.mgrid[SIZE[1] - 0.5 : 0 : -1, 0.5 : SIZE[0]]
        expected = np.dstack([columns / SIZE[0], rows / SIZE[1], np.full(rows.shape, 0.25)])
        np.testing.assert_allclose(result, expected, atol=0.51 / 255 + 1e-6)


def test_channel_read_by_direction_is_cube_map_or_sky(any_engine, opened, folder):
    text = "void mainImage(out vec4 c, in vec2 p) { vec3 rd = -vec3(0, 1, 0); c = texture(iChannel1, rd); }\n"
    alone = opened({"a.frag": text}, "a.frag")
    assert first_texel(any_engine, alone)[2] < 102, "the ground of a sky"
    assert "nothing feeds iChannel1" in notes(alone)[0]
    sketch = opened({"t/Image.glsl": text, "t/Cube A.glsl": CUBE}, "t")
    np.testing.assert_allclose(first_texel(any_engine, sketch)[:3], [128, 0, 128], atol=2)
    declared = opened({"b.frag": f"uniform sampler3D iChannel1;\n{text}"}, "b.frag")
    assert [i.shape for i in declared.graph.find("view").technique.inputs] == ["volume"]


@pytest.mark.parametrize("opens", ["a.frag", "a.json"])
def test_another_source_of_a_cube_map_has_a_cube_s_size(any_engine, opened, opens):
    image = SHOWS.replace("iChannel0, uv", "iChannel0, vec3(uv, 1.0)")
    site = {"id": "b", "src": "/media/a/2.png", "ctype": "cubemap", "channel": 0}
    sketch = opened({"a.frag": image, "a.json": export(one("Image", image, site))}, opens)
    sky = drawn(any_engine, sketch)
    for source in ("foreign/noise", "foreign/cube_faces"):
        assert not np.array_equal(drawn(any_engine, with_source(sketch, "view.iChannel0", source)), sky)


def test_a_later_buffer_of_a_folder_is_that_of_the_frame_before(any_engine, opened):
    sketch = opened(
        {
            "Image.glsl": FETCH.format("iChannel0"),
            "Buffer A.glsl": '#iChannel0 "file://Buffer B.glsl"\n' + FETCH.format("iChannel0"),
            "Buffer B.glsl": COUNTS.format(10),
        }
    )
    assert [first_texel(any_engine, sketch, (frame + 0.5) / 60)[0] for frame in (0, 4)] == [0, 13]


def test_a_pass_that_comes_or_changes_is_read(any_engine, opened, folder):
    sketch = opened({"Image.glsl": FETCH.format("iChannel1"), "Buffer A.glsl": COUNTS.format(1)})
    noise = first_texel(any_engine, sketch)[0]
    folder.write("Buffer B.glsl", COUNTS.format(20))
    assert first_texel(any_engine, load(folder.path))[0] == 20 != noise
    folder.write("Buffer B.glsl", COUNTS.format(21))
    assert first_texel(any_engine, load(folder.path))[0] == 21
    named = {path.rpartition("/")[2] for path in load(folder.path).files}
    assert {"Image.glsl", "Buffer B.glsl"} <= named


@pytest.mark.parametrize("name", FOLDERS)
def test_every_toy_folder_file_belongs_to_sketch_for_packing(opened, name):
    names = {path.rpartition("/")[2] for path in opened(TOYS[name].files, TOYS[name].opens).files}
    assert names >= set(TOYS[name].files)


def test_a_comment_gives_a_channel_the_keyboard(opened):
    sketch = opened(TOYS["folder_with_a_keyboard"].files)
    assert notes(sketch) == []
    assert "foreign/keys" in [spec.use for spec in sketch.graph.passes]


def test_a_folder_that_is_none_is_one_sentence(folder):
    with pytest.raises(PlaygroundError, match=r"no sketch\.toml, and no Image"):
        load(folder.path)
    folder.write("Image.glsl", PLAIN)
    folder.write("Buffer A.glsl", PLAIN)
    folder.write("BufferA.glsl", PLAIN)
    with pytest.raises(
        PlaygroundError, match=r"Buffer A.glsl and .*BufferA.glsl are both Buffer A; remove one"
    ):
        load(folder.path)


def test_a_pass_of_a_folder_without_its_function_is_named(opened):
    with pytest.raises(ShaderError, match="Cube A has no mainCubemap, but a mainImage") as caught:
        opened({"Image.glsl": PLAIN, "Cube A.glsl": PLAIN})
    assert caught.value.diagnostics[0].file.endswith("Cube A.glsl")


# ── VS Code ──────────────────────────────────────────────────────────────────


def test_uniforms_are_parameters_with_their_ranges(any_engine, opened):
    sketch = opened(VSCODE["code_uniforms"].files, "a.glsl")
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


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("#iUniform float", "cannot read this #iUniform"),
        ("#iUniform flaot x = 1.0", "did you mean 'float'"),
        ("#iUniform float x = 1.0 in { a, 2.0 }", "expected a number, not 'a'"),
        ("#iChannel0 file://x.png", "expected #iChannel0"),
        ('#iChannel0::MinFiltre "Nearest"', "did you mean 'MinFilter'"),
        ('#iChannel0::WrapMode "Repaet"', "did you mean 'Repeat'"),
        ('#iChannel0 "file://bb.glsl"', "no file 'bb.glsl'; did you mean 'b.glsl'"),
    ],
)
def test_unreadable_directive_is_one_error_at_its_line(opened, line, words):
    with pytest.raises(ShaderError) as caught:
        opened({"a.glsl": f"// first\n{line}\n{PLAIN}", "b.glsl": PLAIN}, "a.glsl")
    (result,) = caught.value.diagnostics
    assert (result.line, result.file.endswith("a.glsl")) == (2, True)
    assert words in result.message


@pytest.mark.parametrize(
    ("line", "names"),
    [
        ("#iFirstPersonControls", ["#iFirstPersonControls", "iViewMatrix"]),
        ('#iVertex "file://a.vert"', ["#iVertex", "vertex shader"]),
        ("#iSomethingNew 3", ["#iSomethingNew", "not known"]),
        ("#StrictCompatibility", []),
    ],
)
def test_a_directive_that_does_nothing_here_is_named_once(any_engine, opened, line, names):
    text = (
        "void mainImage(out vec4 c, in vec2 p) { c = iViewMatrix * vec4(p / iResolution.xy, 0.25, 1.0); }\n"
    )
    sketch = opened({"a.frag": f"{line}\n{text}"}, "a.frag")
    result = drawn(any_engine, sketch)[..., :3] / 255
    rows, columns = np.mgrid[SIZE[1] - 0.5 : 0 : -1, 0.5 : SIZE[0]]
    expected = np.dstack([columns / SIZE[0], rows / SIZE[1], np.full(rows.shape, 0.25)])
    np.testing.assert_allclose(result, expected, atol=0.51 / 255 + 1e-6)
    said = notes(sketch)
    assert len(said) == bool(names) and all(name in said[0] for name in names)


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


def test_files_that_read_each_other_are_each_drawn_once_a_frame(any_engine, opened):
    adds = "void mainImage(out vec4 c, in vec2 p) { c = texelFetch(iChannel0, ivec2(p), 0) + 1.0 / 255.0; }\n"
    sketch = opened(
        {"a.glsl": f'#iChannel0 "file://b.glsl"\n{adds}', "b.glsl": f'#iChannel0 "file://a.glsl"\n{adds}'},
        "a.glsl",
    )
    assert [first_texel(any_engine, sketch, (frame + 0.5) / 60)[0] for frame in (0, 1, 9)] == [2, 4, 20]


def test_the_button_of_the_mouse(any_engine, opened):
    text = "#iUniform float x = 0.0\nvoid mainImage(out vec4 c, in vec2 p) { c = iMouseButton + x; }\n"
    sketch = opened({"a.glsl": text}, "a.glsl")
    for press, level in [(2.0, 255), (-2.0, 0)]:
        any_engine.runner.drag = (3.0, 3.0, press, press)
        assert first_texel(any_engine, sketch)[0] == level


def test_a_file_outside_the_folder_is_not_read(folder):
    folder.write("b.glsl", PLAIN)
    path = folder.write("own/a.glsl", f'#iChannel0 "file://../b.glsl"\n{IMAGE}')
    with pytest.raises(ShaderError, match="lies outside the shader's own folder") as caught:
        load(path)
    assert caught.value.diagnostics[0].line == 1
