"""Texels at places written as numbers are uniforms on a software renderer: the same bits, never old ones."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine import results
from playground.engine.context import ContextInfo
from playground.engine.engine import Engine
from playground.engine.results import Result
from playground.engine.software import FIXED, specialise
from playground.shader.sampler_reads import fixed_texels
from playground.shader.wrap import FRAGMENT, wrap

from ..sketch_texts import passes
from .conftest import Folder, on_both_kinds

ROW = """#pragma kernel(output = "row:FORMAT")
uniform float scale = 1.0;  //! slider(0, 9)
vec4 kernel(ivec2 texel) { return scale * vec4(texel.x + 1, texel.y + 1, 0.3, 1e-7) / 7.0; }
"""
READS = """#pragma kernel(output = "found:rgba32f")
uniform sampler2D row;  //! input
uniform sampler2D more;  //! input("white")
vec4 at(sampler2D row) { return texelFetch(row, ivec2(2, 1), 0); }
vec4 kernel(ivec2 texel) {
    return at(row) + 10.0 * texelFetch(row, ivec2(4, 0), 0) + 100.0 * texelFetch(row, ivec2(9, 0), 0)
            + texelFetch(more, ivec2(0), 0) * float(texel.x);
}
"""
PASSES = "\n" + passes(row=("./row", "size = [SIZE]"), a="./reads")


def sketch_of(folder: Folder, form: str = "rgba32f", size: str = "5, 2"):
    folder.write("row.glsl", ROW.replace("FORMAT", form))
    folder.write("reads.glsl", READS)
    return folder.sketch(PASSES.replace("SIZE", size))


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
        result = engine.read(sketch_of(folder), "a")
    np.testing.assert_allclose(result, truth(), rtol=2e-6)


@pytest.mark.parametrize("form", ["rgba32f", "rgba16f", "rgba8", "rgba16"])
def test_the_bits_are_those_of_a_renderer_that_fetches(
    any_engine: Engine, folder: Folder, monkeypatch, form: str
):
    np.testing.assert_array_equal(*on_both_kinds(any_engine, monkeypatch, sketch_of(folder, form), "a"))


def test_they_change_with_the_input_and_are_read_back_once(any_engine: Engine, folder: Folder, monkeypatch):
    monkeypatch.setattr(ContextInfo, "software", True)
    sketch, asked, read = sketch_of(folder), set(), []
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
        result = engine.read(sketch_of(folder, size="1, 1"), "a")
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


def test_no_line_and_no_column_changes(folder: Folder):
    kernel = sketch_of(folder).graph.passes[1].technique
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
    sketch = folder.sketch(PASSES.replace("SIZE", "5, 2"))
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
    first = PASSES.replace("SIZE", "5, 2")
    second = first.replace('"row"', '"other"').replace('name = "a"', 'name = "b"')
    second += 'inputs = { row = "other:row" }\n'
    last = '[[pass]]\nname = "c"\nuse = "./both"\ninputs = { first = "a", second = "b" }\n'
    sketch = folder.sketch(first + second + last)
    with Engine(any_engine.ctx) as engine:
        for hour, other in ((1, 2), (2, 1), (3, 1), (1, 1), (4, 5)):
            changed = sketch.with_values({"row.hour": hour, "other.hour": other})
            assert (engine.read(changed, "c") == 303).all()
