"""Draws of several outputs, and draws whose number of instances a texture says."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np
import pytest

from playground.errors import PlaygroundError

from ..sketch_texts import passes

PAIR = """#pragma draw(mesh = "sheet", output = "seen:rgba32f, more:rg16f"{more})
uniform float right = 1.0;
uniform float depth = 0.0;
uniform float mark = 1.0;
vec4 vertex(vec3 corner, out vec2 place) {
    place = corner.xy;
    return vec4(mix(-1.0, right, corner.x), corner.y * 2.0 - 1.0, depth, 1.0);
}
void fragment(vec2 place, out vec4 seen, out vec4 more) {
    seen = vec4(mark, floor(16.0 * place), 1.0);
    more = vec4(-mark, 0.5 * mark, 9.0, 9.0);
}
"""
BACK = """#pragma kernel(output = "seen:rgba32f, more:rg16f")
void kernel(ivec2 texel, out vec4 seen, out vec2 more) { seen = vec4(8.0); more = vec2(9.0); }
"""


@pytest.fixture
def pairs(folder):
    """Give a function that draws pairs of outputs, one over the other: (name, options, values, start)."""

    def make(*layers, samples: int = 1):
        folder.write("back.glsl", BACK)
        body, value = ['[[pass]]\nname = "back"\nuse = "./back"'], {}
        for name, more, values, start in layers:
            folder.write(f"{name}.glsl", PAIR.replace("{more}", more))
            wired = f'\ninputs = {{ initial = "{start}" }}' if start else ""
            body.append(f'[[pass]]\nname = "{name}"\nuse = "./{name}"{wired}')
            value |= {f"{name}.{key}": value for key, value in values.items()}
        sketch = folder.sketch("\n".join(body), size="size = 16")
        return sketch.with_picture(samples=samples).with_values(value)

    return make


@pytest.mark.parametrize("samples", [1, 4])
@pytest.mark.parametrize("start", ["", "back"])
def test_a_draw_fills_all_of_its_outputs(any_engine, pairs, samples, start):
    sketch = pairs(("one", "", {"right": 0.0, "mark": 3.0}, start), samples=samples)
    seen, more = any_engine.read(sketch, "one:seen"), any_engine.read(sketch, "one:more")
    np.testing.assert_array_equal(seen[:, :8, 0], 3.0)
    np.testing.assert_array_equal(seen[:, :8, 2], np.tile(np.arange(16.0)[:, None], 8))
    np.testing.assert_array_equal(more[:, :8], np.broadcast_to((-3.0, 1.5), (16, 8, 2)))
    np.testing.assert_array_equal(seen[:, 8:], 8.0 if start else 0.0)
    np.testing.assert_array_equal(more[:, 8:], 9.0 if start else 0.0)
    assert any_engine.runs["one"] == 1, "one draw gives both"


@pytest.mark.parametrize("samples", [1, 4])
def test_draw_continues_from_all_outputs_and_depth_of_another(any_engine, pairs, samples):
    sketch = pairs(
        ("one", "", {"right": 0.0, "depth": 0.0}, "back"),
        ("two", "", {"depth": 0.5, "mark": 2.0}, "one"),
        ("none", ', repeat = "int(depth)"'.replace("int(depth)", "0"), {}, "two"),
        samples=samples,
    )
    for last in ("two", "none"):
        np.testing.assert_array_equal(
            any_engine.read(sketch, f"{last}:more")[..., 0][:, 7:9], [[-1, -2]] * 16
        )
        np.testing.assert_array_equal(any_engine.read(sketch, f"{last}:seen")[..., 0][:, 7:9], [[1, 2]] * 16)
    np.testing.assert_array_equal(any_engine.read(sketch, "one:more")[:, 8:], 9.0)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ("vec4 fragment(vec2 place)", r"fragment must be void fragment\(…, out vec4 seen, out vec4 more\)"),
        ("void fragment(vec2 place, out vec4 more, out vec4 seen)", "in the order of the pragma"),
        ("void fragment(vec2 place, out vec4 seen, out vec2 more)", "fragment must be void fragment"),
    ],
)
def test_a_fragment_without_its_outputs_has_a_sentence(any_engine, folder, wrong, message):
    right = "void fragment(vec2 place, out vec4 seen, out vec4 more)"
    text = PAIR.replace("{more}", "").replace(right, wrong)
    with pytest.raises(PlaygroundError, match=message) as caught:
        any_engine.texture(folder.one(text), "a")
    assert caught.value.diagnostics[0].line == 9


def test_a_draw_of_other_outputs_cannot_go_on_from_one(any_engine, folder):
    folder.write("one.glsl", PAIR.replace("{more}", ""))
    single = PAIR.replace("{more}", "").replace("seen:rgba32f, more:rg16f", "seen:rgba32f")
    single = single.replace(", out vec4 seen, out vec4 more", "").replace("void fragment", "vec4 fragment")
    folder.write(
        "two.glsl", single.replace("seen = vec4(mark", "return vec4(mark").replace("    more =", "    //")
    )
    sketch = folder.sketch(passes(one="./one", two=("./two", 'inputs = { initial = "one" }')))
    with pytest.raises(
        PlaygroundError, match="pass 'two' goes on from 'one', a draw of seen, more; it gives seen"
    ):
        any_engine.texture(sketch, "two")


DOTS = """#pragma draw(mesh = "sheet", instances = "{count}", output = "frame:rgba32f", \\
                      depth = "none", samples = 1)
uniform sampler2D list;  //! input
vec4 vertex(vec3 corner, out float which) {
    which = float(gl_InstanceID + 1);
    return vec4((corner.xy + vec2(gl_InstanceID, 0.0)) / 16.0 * 2.0 - 1.0, 0.0, 1.0);
}
vec4 fragment(float which) { return vec4(which, 0.0, 0.0, 1.0); }
"""
LIST = """#pragma kernel(output = "other:r32f, list:{form}")
uniform float many = 5.0;
void kernel(ivec2 texel, out float other, out {type} list) {
    other = 11.0;
    list = texel == ivec2(0) ? {value} : {type}(0.0);
}
"""


@pytest.fixture
def dots(folder):
    """Give a function that makes a sketch of a row of texels, as many as a texture says."""

    def make(count: str, form: str = "r32f", type: str = "float", value: str = "many"):
        text = LIST.replace("{form}", form).replace("{type}", type).replace("{value}", value)
        folder.write("list.glsl", text)
        folder.write("dots.glsl", DOTS.replace("{count}", count))
        return folder.sketch(
            passes(list="./list", dots=("./dots", 'inputs = { list = "list:list" }')),
            size="size = 16",
        )

    return make


def first_row(engine, sketch):
    return engine.read(sketch, "dots")[0, :, 0]


@pytest.mark.parametrize(
    ("count", "form", "type", "value"),
    [
        ("list.x", "r32f", "float", "many"),
        ("2 * list.w - 5", "rgba16f", "vec4", "vec4(0.0, 0.0, 0.0, many)"),
        ("min(list.y, size.x)", "rg32f", "vec2", "vec2(0.0, many)"),
    ],
)
def test_a_texture_says_how_many_instances_are_drawn(any_engine, dots, count, form, type, value):
    sketch = dots(count, form, type, value)
    np.testing.assert_array_equal(first_row(any_engine, sketch), [1, 2, 3, 4, 5, *[0] * 11])


def test_another_count_draws_again_and_the_same_does_not(any_engine, dots):
    sketch = dots("list.x")
    for many in (3, 16, 0, 3):
        changed = sketch.with_values({"list.many": many})
        result = first_row(any_engine, changed)
        np.testing.assert_array_equal(result, [*range(1, many + 1), *[0] * (16 - many)])
        any_engine.texture(changed, "dots")
        assert any_engine.record.ran == []


def test_a_count_is_read_once_from_the_graphics_card(any_engine, dots, monkeypatch):
    sketch = dots("list.x")
    first_row(any_engine, sketch)
    monkeypatch.setattr(moderngl.Framebuffer, "read", lambda *a, **k: pytest.fail("read again"))
    any_engine.texture(replace(sketch, camera=replace(sketch.camera, azimuth=3.0)), "dots")
    assert any_engine.record.triangles == 0


@pytest.mark.parametrize(
    ("count", "value", "message"),
    [
        ("list.x", "-1.0", "pass 'dots': instances = -1; 0 to 1048576 were expected"),
        ("list.x", "1.0 / (many - 5.0)", "pass 'dots': instances: 'list' holds inf; a number was expected"),
        ("list.x / 2", "many", "pass 'dots': instances 'list.x / 2' gives 2.5; a whole number was expected"),
        ("list.y", "many", "'list' has no component y; it is r32f"),
        ("lost.x", "many", "instances: .*'lost.x'.*did you mean 'list.x'"),
    ],
)
def test_a_count_that_is_wrong_has_a_sentence(any_engine, dots, count, value, message):
    with pytest.raises(PlaygroundError, match=message) as caught:
        any_engine.texture(dots(count, value=value), "dots")
    assert caught.value.diagnostics[0].file


def test_instance_count_on_tiled_mesh_is_refused(any_engine, folder):
    text = DOTS.replace("sheet", "land").replace("{count}", "3").replace("  //! input", "  //! input(white)")
    text = f"{text}uniform int detail = 0;\nuniform int grid = 9;\n"
    with pytest.raises(PlaygroundError, match="mesh 'land' is drawn once for each of its tiles; it takes no"):
        any_engine.texture(folder.one(text), "a")
