"""Draws: what they start from, how they blend, what hides what; several outputs, and instances."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.errors import PlaygroundError

from ..loading import load
from ..sketch_texts import passes

HEAD = '#pragma draw(mesh = "sheet", output = "frame:rgba32f"{more})\n'
PLATE = (
    HEAD
    + """uniform float left = -1.0;
uniform float right = 1.0;
uniform float depth = 0.0;
uniform int count = 0;
uniform vec4 colour = vec4(1.0, 0.0, 0.0, 1.0);
vec4 vertex(vec3 corner, out vec2 place) {
    place = corner.xy;
    return vec4(mix(left, right, corner.x), corner.y * 2.0 - 1.0, depth, 1.0);
}
vec4 fragment(vec2 place) { return colour; }
"""
)
BACK = """#pragma kernel(output = "frame:rgba32f")
vec4 kernel(ivec2 texel) { return vec4(0.25, float(texel.x), 0.0, 1.0); }
"""


@pytest.fixture
def plates(folder):
    """Give a function that draws plates one over the other: (name, options, values, start)."""

    def make(*layers, samples: int = 1, size: int = 16):
        folder.write("back.glsl", BACK)
        body = ['[[pass]]\nname = "back"\nuse = "./back"']
        value = {}
        for name, more, values, start in layers:
            folder.write(f"{name}.glsl", PLATE.replace("{more}", more))
            wired = f'\ninputs = {{ initial = "{start}" }}' if start else ""
            body.append(f'[[pass]]\nname = "{name}"\nuse = "./{name}"{wired}')
            value |= {f"{name}.{key}": value for key, value in values.items()}
        sketch = folder.sketch("\n".join(body), size=f"size = {size}")
        return sketch.with_picture(samples=samples).with_values(value)

    return make


RED, GREEN = (1.0, 0.0, 0.0, 1.0), (0.0, 1.0, 0.0, 0.5)


@pytest.mark.parametrize("samples", [1, 4])
def test_it_covers_what_it_covers_and_is_clear_elsewhere(any_engine, plates, samples):
    sketch = plates(("one", "", {"right": 0.0, "colour": RED}, ""), samples=samples)
    result = any_engine.read(sketch, "one")
    np.testing.assert_array_equal(result[:, :8], np.broadcast_to(RED, (16, 8, 4)))
    np.testing.assert_array_equal(result[:, 8:], 0.0)


@pytest.mark.parametrize("samples", [1, 4])
def test_it_starts_from_a_texture(any_engine, plates, samples):
    sketch = plates(("one", "", {"right": 0.0}, "back"), samples=samples)
    result, back = any_engine.read(sketch, "one"), any_engine.read(sketch, "back")
    np.testing.assert_array_equal(result[:, :8], np.broadcast_to(RED, (16, 8, 4)))
    np.testing.assert_array_equal(result[:, 8:], back[:, 8:])


@pytest.mark.parametrize("samples", [1, 4])
@pytest.mark.parametrize("start", ["", "back"])
def test_nothing_is_left_of_what_was_drawn_on_before(any_engine, plates, samples, start):
    """What a draw draws on is used again: colours of an earlier frame, and its depth, are gone."""
    near = plates(("one", "", {"depth": -0.9, "colour": GREEN}, start), samples=samples)
    any_engine.read(near, "one")
    far = plates(("one", "", {"right": 0.0, "depth": 0.9}, start), samples=samples)
    result = any_engine.read(far, "one")
    np.testing.assert_array_equal(result[:, :8], np.broadcast_to(RED, (16, 8, 4)))
    expected = any_engine.read(far, "back")[:, 8:] if start else np.zeros((16, 8, 4))
    np.testing.assert_array_equal(result[:, 8:], expected)


def test_a_start_of_another_format_is_converted(any_engine, folder):
    """A texture of one component, drawn over by a draw of four: what is copied as it is must not be."""
    folder.write(
        "back.glsl", '#pragma kernel(output = "grey:r32f")\nfloat kernel(ivec2 t) { return 0.75; }\n'
    )
    folder.write("one.glsl", PLATE.replace("{more}", ""))
    wiring = '[[pass]]\nname = "one"\nuse = "./one"\ninputs = { initial = "back" }\nset = { right = 0.0 }'
    sketch = folder.sketch(f'[[pass]]\nname = "back"\nuse = "./back"\n{wiring}', size="size = 16")
    result = any_engine.read(sketch.with_picture(samples=1), "one")
    np.testing.assert_array_equal(result[:, 8:], np.broadcast_to((0.75, 0.0, 0.0, 1.0), (16, 8, 4)))


@pytest.mark.parametrize("samples", [1, 2, 4])
@pytest.mark.parametrize(("depth", "hidden"), [(-0.5, False), (0.5, True)])
def test_it_starts_from_an_earlier_draw_with_its_depth(any_engine, plates, samples, depth, hidden):
    sketch = plates(
        ("one", "", {"depth": 0.0}, "back"),
        ("two", "", {"right": 0.0, "depth": depth, "colour": (0.0, 0.0, 1.0, 1.0)}, "one"),
        samples=samples,
    )
    result = any_engine.read(sketch, "two")
    assert result[8, 4, 2] == (0.0 if hidden else 1.0)
    assert result[8, 12, 0] == 1.0
    item = any_engine.read(sketch, "one")
    assert item[8, 4, 2] == 0.0, "the earlier one is left alone"
    assert any_engine.record.ran == []


def test_an_earlier_draw_hands_on_each_sample(any_engine, plates):
    """Where the first covers half a pixel, what the second hides behind it shows in the other half only."""
    sketch = plates(
        ("one", "", {"right": 0.5 / 8, "depth": 0.0}, ""),
        ("two", "", {"depth": 0.5, "colour": (0.0, 0.0, 1.0, 1.0)}, "one"),
        samples=4,
    )
    red, _, blue, alpha = any_engine.read(sketch, "two")[4, 8]
    assert 0.0 < red < 1.0
    assert (red + blue, alpha) == (1.0, 1.0)


@pytest.mark.parametrize("samples", [1, 4])
def test_equal_depth_draws_over_what_has_that_depth(any_engine, plates, samples):
    sketch = plates(
        ("one", "", {"right": 0.0, "depth": 0.25}, ""),
        ("near", "", {"left": 0.0, "right": 0.5, "depth": 0.0}, "one"),
        ("over", ', depth = "equal", blend = "alpha"', {"depth": 0.25, "colour": GREEN}, "near"),
        samples=samples,
    )
    result = any_engine.read(sketch, "over")
    np.testing.assert_array_equal(result[:, :8], np.broadcast_to((0.5, 0.5, 0.0, 1.0), (16, 8, 4)))
    np.testing.assert_array_equal(result[:, 8:12], np.broadcast_to(RED, (16, 4, 4)))
    np.testing.assert_array_equal(result[:, 12:], 0.0)


def test_without_a_depth_test_the_later_one_shows(any_engine, plates):
    sketch = plates(
        ("one", "", {"depth": 0.0}, ""),
        ("two", ', depth = "none"', {"depth": 0.5, "colour": (0.0, 0.0, 1.0, 1.0)}, "one"),
    )
    assert any_engine.read(sketch, "two")[3, 3, 2] == 1.0


@pytest.mark.parametrize("samples", [1, 4])
@pytest.mark.parametrize("blend", ["none", "alpha", "add"])
def test_blending(any_engine, plates, blend, samples):
    sketch = plates(("one", f', blend = "{blend}"', {"colour": GREEN}, "back"), samples=samples)
    result, under = any_engine.read(sketch, "one"), any_engine.read(sketch, "back").astype(np.float64)
    over = np.broadcast_to(np.array(GREEN), under.shape)
    expected = {
        "none": over,
        "add": under + over,
        "alpha": over * 0.5 + under * 0.5 + (over * [0, 0, 0, 0.5]),  # alpha itself is not weighed by alpha
    }[blend]
    np.testing.assert_allclose(result, expected, rtol=1e-6)


def test_samples_are_resolved_to_their_mean(any_engine, plates):
    edge = 0.5 / 8  # half a pixel right of the middle
    sketch = plates(("one", "", {"right": edge}, ""), samples=4)
    column = any_engine.read(sketch, "one")[:, 8, 0]
    assert np.all((column > 0) & (column < 1))
    assert np.all(any_engine.read(sketch.with_picture(samples=1), "one")[:, 8, 0] % 1 == 0)


def test_overlay_draw_is_independent_of_earlier_engine_draws(ctx, plates):
    """The draw below keeps its samples only where one goes on from it: that is part of its key."""
    below = plates(("one", "", {}, "back"), samples=4)
    both = plates(("one", "", {}, "back"), ("two", "", {"depth": 0.5, "right": 0.3}, "one"), samples=4)
    with Engine(ctx) as engine, Engine(ctx) as fresh:
        engine.texture(below, "one")
        np.testing.assert_array_equal(engine.read(both, "two"), fresh.read(both, "two"))
        assert engine.runs["one"] == 2


def test_sample_count_invalidates_draws_and_no_other_pass(any_engine, plates):
    sketch = plates(("one", "", {}, "back"), samples=1)
    any_engine.texture(sketch, "one")
    any_engine.texture(sketch.with_picture(samples=4), "one")
    assert any_engine.record.ran == ["one"]


def test_a_draw_that_draws_nothing_hands_on_what_it_starts_from(any_engine, plates):
    sketch = plates(
        ("one", "", {"depth": 0.0}, "back"),
        ("two", ', repeat = "count"', {}, "one"),
        ("three", "", {"depth": 0.5, "colour": GREEN}, "two"),
        samples=4,
    )
    result = any_engine.read(sketch, "three")
    assert "two" not in any_engine.record.ran
    assert result[3, 3, 0] == 1.0, "hidden by the first draw's depth"
    np.testing.assert_array_equal(any_engine.read(sketch, "two"), any_engine.read(sketch, "one"))


def test_surfaces_and_vertex_arrays_are_used_again(any_engine, plates, monkeypatch):
    sketch = plates(("one", "", {}, "back"), samples=4)
    any_engine.texture(sketch, "one")
    made: list[str] = []
    for name in ("renderbuffer", "depth_renderbuffer", "vertex_array", "buffer"):
        real = getattr(any_engine.ctx, name)
        monkeypatch.setattr(
            any_engine.ctx, name, lambda *a, _r=real, _n=name, **k: (made.append(_n), _r(*a, **k))[1]
        )
    for i in range(5):
        any_engine.texture(sketch.with_values({"one.right": i / 10}), "one")
        assert any_engine.record.ran == ["one"]
    assert made == []


def test_a_draw_leaves_the_context_as_it_was(ctx, any_engine, plates):
    texture = ctx.texture((4, 4), 4, dtype="f4")
    mine = ctx.framebuffer([texture])
    _ = ctx.error
    mine.use()
    any_engine.texture(plates(("one", ', blend = "add"', {}, "back"), samples=4), "one")
    assert ctx.fbo is mine
    # Neither depth nor blending is on: two triangles over each other, the far one last.
    program = ctx.program(
        vertex_shader="#version 330\nin vec3 p; void main() { gl_Position = vec4(p, 1.0); }",
        fragment_shader="#version 330\nuniform float v; out vec4 o; void main() { o = vec4(v); }",
    )
    for value, z in ((0.25, 0.0), (0.5, 0.9)):
        buffer = ctx.buffer(np.array([[-1, -1, z], [3, -1, z], [-1, 3, z]], "f4").tobytes())
        program["v"].value = value
        array = ctx.vertex_array(program, [(buffer, "3f", "p")])
        array.render()
        array.release()
        buffer.release()
    assert np.frombuffer(mine.read(components=1, dtype="f4"), "f4")[0] == 0.5
    ctx.detect_framebuffer(0).use()
    program.release()
    mine.release()
    texture.release()


def test_a_frame_leaves_no_sampler_behind(ctx, any_engine, folder):
    """A sampler stays on its unit for any texture bound after it: others would read theirs by it."""
    folder.write("back.glsl", BACK)
    folder.write(
        "blur.glsl",
        '#pragma kernel(output = "b:rgba32f")\nuniform sampler2D frame; //! input("linear", "repeat")\n'
        "vec4 kernel(ivec2 texel) { return textureLod(frame, vec2(0.1), 0.0); }\n",
    )
    sketch = folder.sketch('[[pass]]\nname = "back"\nuse = "./back"\n[[pass]]\nname = "b"\nuse = "./blur"\n')
    any_engine.texture(sketch, "b")
    texture = ctx.texture((2, 1), 1, np.array([0.0, 1.0], "f4").tobytes(), dtype="f4")
    texture.filter = (ctx.NEAREST, ctx.NEAREST)
    target = ctx.texture((1, 1), 1, dtype="f4")
    framebuffer = ctx.framebuffer([target])
    _ = ctx.error
    program = ctx.program(
        vertex_shader="#version 330\n"
        "void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0, 1); }",
        fragment_shader="#version 330\n"
        "uniform sampler2D t; out float o; void main() { o = texture(t, vec2(0.45, 0.5)).r; }",
    )
    array = ctx.vertex_array(program, [])
    framebuffer.use()
    texture.use(0)
    array.render(ctx.TRIANGLES, vertices=3)
    assert np.frombuffer(target.read(), "f4")[0] == 0.0, "its own way of reading, nearest"
    ctx.detect_framebuffer(0).use()
    for made in (array, program, framebuffer, target, texture):
        made.release()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            HEAD.replace("{more}", "") + "vec4 vertex(vec3 corner) { return vec4(0); }\n",
            "needs a function vec4 fragment",
        ),
        (
            PLATE.replace("{more}", "").replace("fragment(vec2 place)", "fragment(vec3 place)"),
            "fragment takes vec3 place",
        ),
        (PLATE.replace("{more}", "").replace('"sheet"', '"shet"'), "no mesh 'shet'; did you mean 'sheet'"),
        (PLATE.replace("{more}", "").replace('"sheet"', '"grid"'), "mesh 'grid' needs a parameter"),
        (
            PLATE.replace("{more}", "").replace("out vec2 place)", "out vec2 place, inout vec2 x)"),
            "cannot read the argument",
        ),
    ],
)
def test_mistakes_in_a_draw_have_sentences(any_engine, folder, text, message):
    with pytest.raises(PlaygroundError, match=message) as caught:
        any_engine.texture(folder.one(text), "a")
    assert caught.value.diagnostics[0].file


STRIPES = (
    '#pragma draw(mesh = "triangles", count = "{count}", output = "frame:rgba32f"{more})\n'
    """uniform sampler2D rows;  //! input
uniform int stripes = 3; //! slider(0, 40)
vec4 vertex(vec3 corner, out int triangle) {
    triangle = int(corner.x);
    float row = texelFetch(rows, ivec2(0, triangle), 0).g;
    vec2 place = corner.y < 0.5 ? vec2(0.0, row) : corner.y < 1.5 ? vec2(32.0, row) : vec2(0.0, row + 1.0);
    return vec4(place / vec2(size) * 2.0 - 1.0, 0.0, 1.0);
}
vec4 fragment(int triangle) { return vec4(float(triangle + 1), 0.0, 0.0, 1.0); }
"""
)
ROWS = """#pragma kernel(output = "rows:rgba32f")
vec4 kernel(ivec2 texel) { return vec4(0.0, float(size.y - 1 - texel.y), 0.0, 1.0); }
"""


@pytest.fixture
def stripes(folder):
    """Give a function that makes a sketch of thin triangles, one a row, whose places a texture holds."""

    def make(count: str, more: str = ""):
        folder.write("rows.glsl", ROWS)
        folder.write("stripes.glsl", STRIPES.replace("{count}", count).replace("{more}", more))
        body = '[[pass]]\nname = "rows"\nuse = "./rows"\n[[pass]]\nname = "a"\nuse = "./stripes"\n'
        return folder.sketch(body, size="size = 16").with_picture(samples=1)

    return make


def test_triangles_take_their_places_from_a_texture(any_engine, stripes):
    sketch = stripes("2 * stripes + size.x - 16", ', depth = "none"')
    for number in (1, 3, 5):
        result = any_engine.read(sketch.with_values({"a.stripes": number}), "a")[:, 1, 0]
        expected = [16 - row if row >= 16 - 2 * number else 0 for row in range(16)]
        np.testing.assert_array_equal(result, expected)
        assert any_engine.record.ran[-1:] == ["a"]


def test_a_count_that_is_wrong_has_a_sentence(any_engine, stripes, folder):
    sketch = stripes("stripes").with_values({"a.stripes": 0})
    with pytest.raises(PlaygroundError, match="count = 0: mesh 'triangles' takes 1 to") as caught:
        any_engine.read(sketch, "a")
    assert caught.value.diagnostics[0].line
    folder.write("stripes.glsl", STRIPES.replace(', count = "{count}"', "").replace("{more}", ""))
    with pytest.raises(PlaygroundError, match='or count = "…" in its #pragma'):
        any_engine.read(load(sketch.file), "a")
    with pytest.raises(PlaygroundError, match="mesh 'sheet' takes no count"):
        any_engine.read(folder.one(PLATE.replace("{more}", ', count = "3"')), "a")


def test_a_draw_may_keep_to_one_sample(any_engine, plates):
    """Its texels are numbers, not colours: their mean over samples would be none of them."""
    edge = 0.5 / 8  # half a pixel right of the middle
    sketch = plates(("one", ", samples = 1", {"right": edge}, ""), samples=4)
    result = any_engine.read(sketch, "one")
    assert np.all(result % 1 == 0)
    np.testing.assert_array_equal(any_engine.read(sketch.with_picture(samples=1), "one"), result)
    assert any_engine.record.ran == [], "the view's samples are nothing to it"


@pytest.mark.parametrize(("first", "second"), [(", samples = 1", ""), ("", ", samples = 1")])
def test_a_draw_goes_on_from_one_with_other_samples(any_engine, plates, first, second):
    sketch = plates(
        ("one", first, {"right": 0.0}, "back"),
        ("two", second, {"left": 0.5, "colour": (0.0, 0.0, 1.0, 1.0)}, "one"),
        samples=4,
    )
    result = any_engine.read(sketch, "two")
    np.testing.assert_array_equal(result[:, :8], np.broadcast_to(RED, (16, 8, 4)))
    np.testing.assert_array_equal(result[:, 12:, 2], 1.0)
    np.testing.assert_array_equal(result[:, 8:12], any_engine.read(sketch, "back")[:, 8:12])


def test_a_mesh_as_large_as_it_gets_is_not_cached_for_ever(any_engine, folder):
    folder.write(
        "g.glsl",
        PLATE.replace("{more}", "").replace('"sheet"', '"grid"')
        + "uniform int grid = 5; //! slider(2, 99)\n",
    )
    sketch = folder.sketch('[[pass]]\nname="a"\nuse="./g"\n')
    for n in range(2, 40):
        any_engine.texture(sketch.with_values({"a.grid": n}), "a")
    draws = any_engine.runner.draws
    assert len(draws.meshes) <= 8
    assert sum(len(p.arrays) for p in any_engine.runner.programs.by_text.values()) <= 8 + 2


OVER = """#pragma draw(mesh = "sheet", output = "frame:rgba32f", over = "below")
uniform sampler2D below;  //! input
vec4 vertex(vec3 corner, out vec2 pixel) {
    pixel = corner.xy * vec2(size);
    return vec4(corner.xy * 2.0 - 1.0, 1.0, 1.0);
}
vec4 fragment(vec2 pixel) { return texelFetch(below, ivec2(pixel), 0) + vec4(0.0, 0.5, 0.0, 0.0); }
"""


def over_sketch(folder, wired='initial = "back", below = "one"'):
    """Return a sketch of a plate, a draw over its pixels, and a plate behind both that goes on from that."""
    folder.write("back.glsl", BACK)
    folder.write("plate.glsl", PLATE.replace("{more}", ""))
    folder.write("over.glsl", OVER)
    return folder.sketch(
        f"""
[[pass]]
name = "back"
use = "./back"
[[pass]]
name = "one"
use = "./plate"
set = {{ right = 0.0, depth = 0.2 }}
[[pass]]
name = "shaded"
use = "./over"
inputs = {{ {wired} }}
[[pass]]
name = "far"
use = "./plate"
inputs = {{ initial = "shaded" }}
set = {{ depth = 0.5, colour = [0.0, 0.0, 1.0, 1.0] }}
""",
        size="size = 16",
    )


@pytest.mark.parametrize("samples", [1, 4])
def test_overlay_draw_shares_coverage_and_depth_of_its_base(any_engine, folder, samples):
    sketch = over_sketch(folder).with_picture(samples=samples)
    back = any_engine.read(sketch, "back")
    shaded, far = any_engine.read(sketch, "shaded"), any_engine.read(sketch, "far")
    np.testing.assert_array_equal(shaded[:, :8], np.broadcast_to((1.0, 0.5, 0.0, 1.0), (16, 8, 4)))
    np.testing.assert_array_equal(shaded[:, 8:], back[:, 8:])
    np.testing.assert_array_equal(far[:, :8], shaded[:, :8])
    np.testing.assert_array_equal(far[:, 8:], np.broadcast_to((0.0, 0.0, 1.0, 1.0), (16, 8, 4)))


def test_a_draw_over_another_leaves_its_depth_as_it_is(any_engine, folder):
    """Also where it begins with the colours of a draw that has a depth of its own."""
    sketch = over_sketch(folder, 'initial = "one", below = "one"')
    for value in (1.0, 0.5):
        changed = sketch.with_values({"one.colour": (value, 0.0, 0.0, 1.0)})
        far = any_engine.read(changed, "far")
        np.testing.assert_array_equal(far[:, :8], np.broadcast_to((value, 0.5, 0.0, 1.0), (16, 8, 4)))
        np.testing.assert_array_equal(far[:, 8:], np.broadcast_to((0.0, 0.0, 1.0, 1.0), (16, 8, 4)))


def test_a_draw_goes_over_no_kernel_and_no_other_input(any_engine, folder):
    with pytest.raises(
        PlaygroundError, match="draws over 'below', which needs to be a draw of 16 x 16 pixels"
    ):
        any_engine.read(over_sketch(folder, 'initial = "back", below = "back"'), "shaded")
    folder.write("over.glsl", OVER.replace('over = "below"', 'over = "blow"'))
    with pytest.raises(PlaygroundError, match="over: there is no input 'blow'; did you mean 'below'"):
        folder.sketch('[[pass]]\nname = "one"\nuse = "./over"', size="size = 16")


# ── Draws of several outputs, and draws whose number of instances a texture says


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
PAIR_BACK = """#pragma kernel(output = "seen:rgba32f, more:rg16f")
void kernel(ivec2 texel, out vec4 seen, out vec2 more) { seen = vec4(8.0); more = vec2(9.0); }
"""


@pytest.fixture
def pairs(folder):
    """Give a function that draws pairs of outputs, one over the other: (name, options, values, start)."""

    def make(*layers, samples: int = 1):
        folder.write("back.glsl", PAIR_BACK)
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
def test_a_wrong_count_of_instances_has_a_sentence(any_engine, dots, count, value, message):
    with pytest.raises(PlaygroundError, match=message) as caught:
        any_engine.texture(dots(count, value=value), "dots")
    assert caught.value.diagnostics[0].file


def test_instance_count_on_tiled_mesh_is_refused(any_engine, folder):
    text = DOTS.replace("sheet", "land").replace("{count}", "3").replace("  //! input", "  //! input(white)")
    text = f"{text}uniform int detail = 0;\nuniform int grid = 9;\n"
    with pytest.raises(PlaygroundError, match="mesh 'land' is drawn once for each of its tiles; it takes no"):
        any_engine.texture(folder.one(text), "a")
