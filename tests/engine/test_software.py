"""What a software renderer does otherwise gives the same texels."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine import results
from playground.engine.context import ContextInfo
from playground.engine.engine import Engine
from playground.engine.results import Result
from playground.engine.software import FIXED, NEAREST, OWN_SIZE, PLACE, quicker_choices, specialise
from playground.errors import ShaderError
from playground.shader.reserved_names import UNWIRED
from playground.shader.sampler_reads import fixed_texels
from playground.shader.wrap import COMPUTE, FRAGMENT, wrap

from ..sketch_texts import passes
from .conftest import Folder, on_both_kinds

ROUGH = """#pragma kernel(output = "rough:FORMAT")
vec4 kernel(ivec2 texel) {
    return fract(sin(vec4(1.0, 2.0, 3.0, 4.0) * float(texel.x * 37 + texel.y)) * 999.0);
}
"""
READS = """#pragma kernel(output = "texels:rgba32f, sum:rgba32f")
uniform sampler2D first;   //! input("linear", "repeat")
uniform sampler2D second;  //! input("linear", "mipmap")
uniform sampler2D third;   //! input
uniform sampler2D open;    //! input("white")
vec4 at(sampler2D which, ivec2 place) { return texelFetch(which, place, 0); }
vec4 over(sampler2D which, ivec2 place) { return place.y < 0 ? vec4(7.0) : at(which, place); }
void kernel(ivec2 texel, out vec4 texels, out vec4 sum) {
    ivec2 place = texel * 2 - 9;
    texels = at(first, place) + texelFetch(open, place * 5, 0);
    sum = over(second, place.yx) + texelFetch(third, place, 0) + textureLod(third, vec2(texel) / 17.0, 0.0);
}
"""
PASSES = "\n" + passes(
    rough=("./rough", "size = [23, 11]"),
    a=("./reads", 'inputs = { first = "rough", second = "rough", third = "rough" }'),
)


def sketch_of(folder: Folder, form: str = "rgba32f"):
    folder.write("rough.glsl", ROUGH.replace("FORMAT", form))
    folder.write("reads.glsl", READS)
    return folder.sketch(PASSES)


def around(texels: np.ndarray, y: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return texels by their places, 0 outside."""
    inside = (y >= 0) & (x >= 0) & (y < texels.shape[0]) & (x < texels.shape[1])
    return np.where(inside[..., None], texels[np.where(inside, y, 0), np.where(inside, x, 0)], 0)


@pytest.mark.parametrize("form", ["rgba32f", "rgba16f", "rgba8"])
@pytest.mark.parametrize("driver", [FRAGMENT, COMPUTE])
def test_texels_are_those_at_their_places_and_zero_outside(
    any_engine: Engine, folder: Folder, monkeypatch, driver: str, form: str
):
    if driver == COMPUTE and not any_engine.info.compute:
        pytest.skip("this context has no compute shaders")
    monkeypatch.setattr(ContextInfo, "software", True)
    sketch = sketch_of(folder, form)
    with Engine(any_engine.ctx, driver=driver) as engine:
        rough = engine.read(sketch, "rough")
        result, total = engine.read(sketch, "a"), engine.read(sketch, "a:sum")
    y, x = np.mgrid[0:17, 0:17] * 2 - 9
    # A driver may make a fraction of a byte by a product, which rounds once more; the sums are below 16.
    exact = {"rtol": 0, "atol": 2**-20 if form == "rgba8" else 0}
    np.testing.assert_allclose(result, around(rough, y, x) + np.float32(1), **exact)
    tall, wide = np.minimum(np.floor(np.arange(17) / 17 * [[11], [23]]).astype(int), [[10], [22]])
    nearest = rough[tall[:, None], wide[None, :]]
    handed = np.where((x < 0)[..., None], np.float32(7), around(rough, x, y))
    np.testing.assert_allclose(total, (handed + around(rough, y, x)) + nearest, **exact)


@pytest.mark.parametrize("form", ["rgba32f", "rgba16", "rgba8"])
def test_the_bits_are_those_of_a_renderer_that_fetches(
    any_engine: Engine, folder: Folder, monkeypatch, form: str
):
    np.testing.assert_array_equal(*on_both_kinds(any_engine, monkeypatch, sketch_of(folder, form), "a"))


BLUR = """#pragma kernel(output = "one:r32f, two:rg32f", repeat = "6")
uniform sampler2D rough;  //! input
void kernel(ivec2 texel, out float one, out vec2 two) {
    if (iteration == 0) { one = texelFetch(rough, texel, 0).r; two = texelFetch(rough, texel, 0).gb; return; }
    one = 0.5 * previous_one(texel - ivec2(1, 0)) + previous_two(texel + ivec2(0, 2)).y;
    two = fract(previous_two(texel + 1) + previous_one(texel));
}
"""


def test_the_iteration_before_is_read_so_too(any_engine: Engine, folder: Folder, monkeypatch):
    """Its places are inside: the texel at the edge stands for those beyond."""
    monkeypatch.setattr(ContextInfo, "software", True)
    folder.write("rough.glsl", ROUGH.replace("FORMAT", "rgba32f"))
    folder.write("blur.glsl", BLUR)
    sketch = folder.sketch(PASSES.partition('[[pass]]\nname = "a"')[0] + passes(a="./blur"))
    with Engine(any_engine.ctx) as engine:
        rough = engine.read(sketch, "rough")
        result, second = engine.read(sketch, "a"), engine.read(sketch, "a:two")
    y, x = np.mgrid[0:17, 0:17]
    start = around(rough, y, x)
    position, two = start[..., 0], start[..., 1:3]
    for _ in range(5):
        position, two = (
            np.float32(0.5) * position[:, np.maximum(x[0] - 1, 0)] + two[np.minimum(y[:, 0] + 2, 16)][..., 1],
            np.modf(two[np.minimum(y + 1, 16), np.minimum(x + 1, 16)] + position[..., None])[0],
        )
    np.testing.assert_allclose(result, position, rtol=1e-5)
    np.testing.assert_allclose(second, two, atol=1e-5)


@pytest.mark.parametrize("own", ["4095, 2", "8193, 2"])
def test_no_texel_is_missed_where_there_are_many(any_engine: Engine, folder: Folder, monkeypatch, own: str):
    """The middle of a texel as a fraction of the width is rounded, by far less than half a texel."""
    monkeypatch.setattr(ContextInfo, "software", True)
    folder.write("rough.glsl", ROUGH.replace("FORMAT", "rgba32f"))
    folder.write("reads.glsl", ASKS)
    body = PASSES.replace("[23, 11]", "[8193, 2]").partition("inputs")[0]
    with Engine(any_engine.ctx) as engine:
        sketch = folder.sketch(f"{body}size = [{own}]\n")
        rough, result = engine.read(sketch, "rough"), engine.read(sketch, "a")
    np.testing.assert_array_equal(result[..., :2], rough[:, : result.shape[1], :2])


ASKS = """#pragma kernel(output = "found:rgba32f")
uniform sampler2D rough;  //! input
vec4 kernel(ivec2 texel) { return vec4(texelFetch(rough, texel, 0).rg, textureSize(rough, 0)); }
"""


def test_texture_sizes_match_whether_known_or_queried(any_engine: Engine, folder: Folder, monkeypatch):
    """The same kernel runs with an input of its own size, then with one of another."""
    monkeypatch.setattr(ContextInfo, "software", True)
    folder.write("rough.glsl", ROUGH.replace("FORMAT", "rgba32f"))
    folder.write("reads.glsl", ASKS)
    with Engine(any_engine.ctx) as engine:
        for width, height in ((9, 4), (6, 2), (9, 4)):
            body = PASSES.replace("[23, 11]", f"[{width}, {height}]").partition("inputs")[0]
            result = engine.read(folder.sketch(f"{body}size = [9, 4]\n"), "a")
            np.testing.assert_array_equal(result[0, 0, 2:], [width, height])


def test_a_texture_of_the_passs_own_size_is_not_asked_for_it(folder: Folder):
    """What a text does for other sizes is left out then as it is compiled."""
    sketch_of(folder)
    folder.write("reads.glsl", ASKS.replace("texel, 0)", "texel * size / size, 0)"))
    kernel = folder.sketch(PASSES.partition("inputs")[0]).graph.passes[1].technique
    assert OWN_SIZE in quicker_choices(kernel)
    before = wrap(kernel, COMPUTE).stages["compute"]
    after = specialise(wrap(kernel, COMPUTE), [(NEAREST, 1), (OWN_SIZE, 1)]).stages["compute"]
    own, changed = before.text.split("\n")[before.first - 1 :], after.text.split("\n")[after.first - 1 :]
    assert [line.replace("texelFetch", "k_texel_of") for line in own] == changed
    assert after.locate(after.first) == kernel.source.lines[0]
    assert after.text.count("uniform ivec2 size;") == 1
    assert len(OWN_SIZE) == len("textureSize") and f"#define textureSize {OWN_SIZE}\n" in after.text
    assert "vec2(textureSize" not in after.text


IMAGE = """#pragma kernel(output = "found:r32f")
uniform sampler2D rough;  //! input
uniform sampler2D image;  //! file("image.png")
float kernel(ivec2 texel) { return texelFetch(rough, texel, 0).r + float(textureSize(image, 0).x); }
"""


def test_a_kernel_that_reads_an_image_asks_for_sizes(folder: Folder):
    sketch_of(folder)
    folder.write("reads.glsl", IMAGE)
    kernel = folder.sketch(PASSES.partition("inputs")[0]).graph.passes[1].technique
    assert NEAREST in quicker_choices(kernel) and OWN_SIZE not in quicker_choices(kernel)


def test_no_line_and_no_column_changes(folder: Folder):
    kernel = sketch_of(folder).graph.passes[1].technique
    assert NEAREST in quicker_choices(kernel)
    before = wrap(kernel, FRAGMENT).stages["fragment"]
    after = specialise(wrap(kernel, FRAGMENT), [(UNWIRED, 0), (NEAREST, 1)]).stages["fragment"]
    own, changed = before.text.split("\n")[before.first - 1 :], after.text.split("\n")[after.first - 1 :]
    assert [len(line) for line in own] == [len(line) for line in changed]
    assert sum(line.count("k_texel_in(") for line in changed) == 2, "at(…) and of open"
    assert sum(line.count("k_fetch_in(third") for line in changed) == 1, "which is read by textureLod as well"


@pytest.mark.parametrize(
    "wrong", ["texelFetch(rough, vec2(1.0), 0)", "vec4(vec3(textureSize(rough, 0)), 1.0)"]
)
def test_a_complaint_names_what_the_author_wrote(any_engine: Engine, folder: Folder, monkeypatch, wrong: str):
    sketch_of(folder)
    folder.write("reads.glsl", ASKS.replace("return ", f"return {wrong} + "))
    said = []
    for software in (True, False):
        monkeypatch.setattr(ContextInfo, "software", software)
        with Engine(any_engine.ctx) as engine, pytest.raises(ShaderError) as refused:
            engine.read(folder.sketch(PASSES.partition("inputs")[0]), "a")
        said.append(refused.value.diagnostics)
    assert said[0] == said[1]


def test_a_text_with_a_macro_of_such_a_name_compiles(any_engine: Engine, folder: Folder, monkeypatch):
    monkeypatch.setattr(ContextInfo, "software", True)
    sketch_of(folder)
    own = ASKS.replace("uniform", "#define textureSize(a, b) ivec2(b + 7)\nuniform", 1)
    folder.write("reads.glsl", own)
    with Engine(any_engine.ctx) as engine:
        result = engine.read(
            folder.sketch(PASSES.replace("size = [23, 11]\n", "").partition("inputs")[0]), "a"
        )
    np.testing.assert_array_equal(result[2, 4, 2:], [7, 7])


FILTERS = """#pragma kernel(output = "found:r32f")
uniform sampler2D mixed;  //! input
uniform sampler2D rough;  //! input
float kernel(ivec2 texel) {
    return textureLod(mixed, vec2(texel) / vec2(size), 0.0).r + 1000.0 * texelFetch(rough, texel, 0).r;
}
"""


def test_filtered_input_keeps_its_sampler_beside_texel_fetches(
    any_engine: Engine, folder: Folder, monkeypatch
):
    sketch_of(folder)
    folder.write("reads.glsl", FILTERS)
    sketch = folder.sketch(PASSES.partition("inputs")[0] + 'inputs = { mixed = "rough", rough = "rough" }\n')
    np.testing.assert_array_equal(*on_both_kinds(any_engine, monkeypatch, sketch, "a"))


PLACES = """#pragma kernel(output = "found:rg32f")
vec2 kernel(ivec2 texel) { return vec2(texel); }
"""


@pytest.mark.parametrize("size", ["8193, 3", "3, 8193", "4095, 5", "1, 1"])
def test_each_texel_knows_its_place(any_engine: Engine, folder: Folder, monkeypatch, size: str):
    """The place that the vertex shader gives is rounded, by far less than half a texel."""
    monkeypatch.setattr(ContextInfo, "software", True)
    folder.write("places.glsl", PLACES)
    sketch = folder.sketch(f'[[pass]]\nname = "a"\nuse = "./places"\nsize = [{size}]\n')
    kernel = sketch.graph.passes[0].technique
    written = specialise(wrap(kernel, FRAGMENT), [(PLACE, 1)]).stages["fragment"]
    assert "ivec2(k_place_at)" in written.text and written.locate(written.first) == kernel.source.lines[0]
    with Engine(any_engine.ctx, driver=FRAGMENT) as engine:
        result = engine.read(sketch, "a")
    height, width = result.shape[:2]
    np.testing.assert_array_equal(result[..., 0], np.tile(np.arange(width), (height, 1)))
    np.testing.assert_array_equal(result[..., 1].T, np.tile(np.arange(height), (width, 1)))


# ── Texels at places written as numbers are uniforms on a software renderer: the same bits, never ol


ROW = """#pragma kernel(output = "row:FORMAT")
uniform float scale = 1.0;  //! slider(0, 9)
vec4 kernel(ivec2 texel) { return scale * vec4(texel.x + 1, texel.y + 1, 0.3, 1e-7) / 7.0; }
"""
ROW_READS = """#pragma kernel(output = "found:rgba32f")
uniform sampler2D row;  //! input
uniform sampler2D more;  //! input("white")
vec4 at(sampler2D row) { return texelFetch(row, ivec2(2, 1), 0); }
vec4 kernel(ivec2 texel) {
    return at(row) + 10.0 * texelFetch(row, ivec2(4, 0), 0) + 100.0 * texelFetch(row, ivec2(9, 0), 0)
            + texelFetch(more, ivec2(0), 0) * float(texel.x);
}
"""
ROW_PASSES = "\n" + passes(row=("./row", "size = [SIZE]"), a="./reads")


def row_sketch_of(folder: Folder, form: str = "rgba32f", size: str = "5, 2"):
    folder.write("row.glsl", ROW.replace("FORMAT", form))
    folder.write("reads.glsl", ROW_READS)
    return folder.sketch(ROW_PASSES.replace("SIZE", size))


def row_texel(x: int, y: int, scale: float = 1.0) -> np.ndarray:
    return np.float32(scale) * np.array([x + 1, y + 1, 0.3, 1e-7], np.float32) / np.float32(7)


def truth(scale: float = 1.0) -> np.ndarray:
    here = row_texel(2, 1, scale) + 10 * row_texel(4, 0, scale)  # (9, 0) is outside: zeros
    return here + np.arange(17, dtype=np.float32)[None, :, None] * np.ones((17, 1, 4), np.float32)


@pytest.fixture(params=[True, False], ids=["software", "GPU"])
def software(request, monkeypatch) -> bool:
    monkeypatch.setattr(ContextInfo, "software", request.param)
    return bool(request.param)


@pytest.mark.parametrize("driver", ["fragment", "compute"])
def test_their_values_are_those_of_the_fetches(any_engine: Engine, folder: Folder, software, driver):
    if driver == "compute" and not any_engine.info.compute:
        pytest.skip("this context has no compute shaders")
    with Engine(any_engine.ctx, driver=driver) as engine:
        result = engine.read(row_sketch_of(folder), "a")
    np.testing.assert_allclose(result, truth(), rtol=2e-6)


@pytest.mark.parametrize("form", ["rgba32f", "rgba16f", "rgba8", "rgba16"])
def test_fixed_texels_have_the_bits_of_fetches(any_engine: Engine, folder: Folder, monkeypatch, form: str):
    np.testing.assert_array_equal(*on_both_kinds(any_engine, monkeypatch, row_sketch_of(folder, form), "a"))


def test_they_change_with_the_input_and_are_read_back_once(any_engine: Engine, folder: Folder, monkeypatch):
    monkeypatch.setattr(ContextInfo, "software", True)
    sketch, asked, read = row_sketch_of(folder), set(), []
    texel, read_texture = Result.texel, results.read_texture
    monkeypatch.setattr(Result, "texel", lambda own, *of: asked.add(of) or texel(own, *of))
    monkeypatch.setattr(
        results, "read_texture", lambda texture: read.append(texture) or read_texture(texture)
    )
    with Engine(any_engine.ctx) as engine:
        for scale in (1.0, 2.0, 0.5, 2.0):
            result = engine.read(sketch.with_values({"row.scale": scale}), "a")
            np.testing.assert_allclose(result, truth(scale), rtol=2e-6)
            own = [texture for texture in read if texture.size == (5, 2)]
            engine.read(sketch.with_values({"row.scale": scale}), "a")
    assert asked == {("row", 2, 1), ("row", 4, 0), ("row", 9, 0)}
    assert len(own) == 3, "of two pictures with the same row, the second reads nothing back"


def test_one_texel_input_reads_alike_at_all_fixed_texels(any_engine: Engine, folder: Folder, software):
    """As the fetches do: what is not wired has one texel, and they cannot tell the two apart."""
    with Engine(any_engine.ctx) as engine:
        result = engine.read(row_sketch_of(folder, size="1, 1"), "a")
    expected = 111 * row_texel(0, 0) + np.arange(17, dtype=np.float32)[None, :, None]
    np.testing.assert_allclose(result, expected * np.ones((17, 1, 1)), rtol=1e-5)


LOOP = "\n" + passes(
    row=("./row", "size = [5, 2]"),
    a=("./grows", 'repeat = "3"', 'inputs = { before = "row" }', 'feedback = { before = "sum" }'),
)
GROWS = """format = 1
[[pass]]
name = "sum"
use = "./sum"
[outputs]
sum = "sum"
[inputs]
before = "sum.before"
"""
SUM = """#pragma kernel(output = "sum:r32f")
uniform sampler2D before;  //! input
float kernel(ivec2 texel) { return texelFetch(before, ivec2(1, 1), 0).r + 1.0; }
"""


def test_what_a_loop_feeds_back_is_fetched_in_each_iteration(any_engine: Engine, folder: Folder, software):
    folder.write("row.glsl", ROW.replace("FORMAT", "rgba32f"))
    folder.write("sum.glsl", SUM)
    folder.write("grows.toml", GROWS)
    with Engine(any_engine.ctx) as engine:
        result = engine.read(folder.sketch(LOOP), "a")
    np.testing.assert_allclose(result, row_texel(1, 1)[0] + 3.0, rtol=1e-6)


def test_fixed_texels_change_no_line_and_no_column(folder: Folder):
    kernel = row_sketch_of(folder).graph.passes[1].technique
    plain = wrap(kernel, FRAGMENT)
    before = plain.stages["fragment"]
    after = specialise(plain, [(f"{FIXED}row", 1)]).stages["fragment"]
    assert "k_fixed_2_1_row" in after.text and "k_fixed_0_0_more" not in after.text
    old, new = before.text.split("\n"), after.text.split("\n")
    texels = [each for each in fixed_texels(kernel.source) if each.input == "row"]
    assert {(each.x, each.y) for each in texels} == {(2, 1), (4, 0), (9, 0)}
    for index, line in enumerate(kernel.source.lines):
        expected = old[before.first - 1 + index]
        for each in texels:
            if each.line == index:
                uniform = f"k_fixed_{each.x}_{each.y}_row".ljust(each.end - each.start)
                expected = expected[: each.start] + uniform + expected[each.end :]
        assert after.locate(after.first + index) is line
        assert new[after.first - 1 + index] == expected


DATES = """#pragma kernel(output = "row:rgba32f")
uniform float hour = 1.0;  //! slider(0, 24)
uniform float day = 1.0;   //! slider(0, 365)
vec4 kernel(ivec2 texel) { return vec4(hour, hour, hour, day) * float(texel.x + 1); }
"""
SEASON = """#pragma kernel(output = "season:r32f")
uniform sampler2D row;  //! input
uniform float gain = 1.0;  //! slider(0, 9)
float kernel(ivec2 texel) { return gain * texelFetch(row, ivec2(2, 0), 0).a; }
"""


def test_a_pass_whose_texels_are_as_they_were_does_not_run_again(
    any_engine: Engine, folder: Folder, software: bool
):
    """Only its result's key is another; what it does not take of a texel does not count."""
    folder.write("row.glsl", DATES)
    folder.write("reads.glsl", SEASON)
    sketch = folder.sketch(ROW_PASSES.replace("SIZE", "5, 2"))
    with Engine(any_engine.ctx) as engine:

        def look(**values: float) -> tuple[float, bool]:
            changed = {f"row.{name}" if name != "gain" else "a.gain": v for name, v in values.items()}
            result = engine.read(sketch.with_values(changed), "a")
            assert (result == result[0, 0]).all()
            return float(result[0, 0]), "a" in engine.record.ran

        assert look(day=7) == (21, True)
        assert look(day=7, hour=2) == (21, not software)
        assert look(day=7, hour=3) == (21, not software)
        assert look(day=8, hour=3) == (24, True)
        assert look(day=8, hour=4, gain=2) == (48, True)
        assert look(day=8, hour=5, gain=2) == (48, not software)
        assert look(day=7, hour=3)[0] == 21


BOTH = """#pragma kernel(output = "both:r32f")
uniform sampler2D first;   //! input
uniform sampler2D second;  //! input
float kernel(ivec2 texel) { return texelFetch(first, texel, 0).r + 100.0 * texelFetch(second, texel, 0).r; }
"""


def test_passes_sharing_fixed_texels_keep_separate_results(any_engine: Engine, folder: Folder, monkeypatch):
    """Two passes change places, so that each has what was the other's; then one goes on."""
    monkeypatch.setattr(ContextInfo, "software", True)
    folder.write("row.glsl", DATES)
    folder.write("reads.glsl", SEASON)
    folder.write("both.glsl", BOTH)
    first = ROW_PASSES.replace("SIZE", "5, 2")
    second = first.replace('"row"', '"other"').replace('name = "a"', 'name = "b"')
    second += 'inputs = { row = "other:row" }\n'
    last = '[[pass]]\nname = "c"\nuse = "./both"\ninputs = { first = "a", second = "b" }\n'
    sketch = folder.sketch(first + second + last)
    with Engine(any_engine.ctx) as engine:
        for hour, other in ((1, 2), (2, 1), (3, 1), (1, 1), (4, 5)):
            changed = sketch.with_values({"row.hour": hour, "other.hour": other})
            assert (engine.read(changed, "c") == 303).all()


# ── A kernel that says where its costly rest begins runs that only where it is needed, with the same


KERNEL = """#pragma kernel(output = "found:rgba32f, more:r32f"REPEAT)
void kernel(ivec2 texel, out vec4 found, out float more) {
    found = vec4(texel, 0.0, 1.0);
    more = 3.0;
    if ((texel.x + texel.y) % 5 != 0) return;
    if (skips_rest()) return;
    found.b = sin(float(texel.x)) + 2.0;
    more = 7.0;
}
"""
ONE = """#pragma kernel(output = "found:r32f")
float kernel(ivec2 texel) {
    if (texel.x > 9) return 0.25;
    if (skips_rest()) return 0.0;
    return 0.75;
}
"""
SIZE = (37, 23)
TEXELS = f"size = [{SIZE[0]}, {SIZE[1]}]"


def rest_truth() -> tuple[np.ndarray, np.ndarray]:
    x, y = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    rest = (x + y) % 5 == 0
    blue = np.where(rest, np.sin(x) + 2.0, 0.0)
    return np.stack([x, y, blue, np.ones_like(blue)], -1), np.where(rest, 7.0, 3.0)


@pytest.mark.parametrize("repeat", ["", ', repeat = "2"'])
def test_its_texels_are_those_of_the_kernel_as_it_is_written(engine: Engine, folder: Folder, repeat: str):
    sketch = folder.one(KERNEL.replace("REPEAT", repeat), size=TEXELS)
    result, more = rest_truth()
    np.testing.assert_allclose(engine.read(sketch, "a:found"), result, atol=1e-6)
    np.testing.assert_array_equal(engine.read(sketch, "a:more"), more)


def test_a_kernel_of_one_output_returns_its_texel(engine: Engine, folder: Folder):
    result = engine.read(folder.one(ONE, size=TEXELS), "a")
    np.testing.assert_array_equal(
        result, np.where(np.arange(SIZE[0]) > 9, 0.25, 0.75) * np.ones((SIZE[1], 1))
    )


def test_a_software_renderer_draws_each_texel_once(any_engine: Engine, folder: Folder, monkeypatch):
    """What is done before the rest fails the depth test: else more samples would pass than there are."""
    monkeypatch.setattr(ContextInfo, "software", True)
    texels = SIZE[0] * SIZE[1]
    with Engine(any_engine.ctx) as engine:
        sketch, query = folder.one(KERNEL.replace("REPEAT", ""), size=TEXELS), engine.ctx.query(samples=True)
        with query:
            engine.texture(sketch, "a:found")
        assert query.samples == texels and engine.runs["a"] == 1
        monkeypatch.setattr(engine.ctx, "enable", lambda flags: None)
        engine.cache.clear()
        with query:
            engine.texture(sketch, "a:found")
        assert query.samples > texels, "the query sees it"
