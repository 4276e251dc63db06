"""A software renderer reads texels by coordinates where it may: the texels that ``texelFetch`` gives."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.errors import ShaderError
from playground.gpu.choices import has_quick_fetches, with_choices
from playground.gpu.context import ContextInfo
from playground.gpu.wrap import COMPUTE, FRAGMENT, wrap
from playground.sketch.reserved_names import TEXELS, UNWIRED

from .conftest import Folder

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
PASSES = """
[[pass]]
name = "rough"
use = "./rough"
size = [23, 11]
[[pass]]
name = "a"
use = "./reads"
inputs = { first = "rough", second = "rough", third = "rough" }
"""


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
        found, total = engine.read(sketch, "a"), engine.read(sketch, "a:sum")
    y, x = np.mgrid[0:17, 0:17] * 2 - 9
    # A driver may make a fraction of a byte by a product, which rounds once more; the sums are below 16.
    exact = {"rtol": 0, "atol": 2**-20 if form == "rgba8" else 0}
    np.testing.assert_allclose(found, around(rough, y, x) + np.float32(1), **exact)
    tall, wide = np.minimum(np.floor(np.arange(17) / 17 * [[11], [23]]).astype(int), [[10], [22]])
    nearest = rough[tall[:, None], wide[None, :]]
    handed = np.where((x < 0)[..., None], np.float32(7), around(rough, x, y))
    np.testing.assert_allclose(total, (handed + around(rough, y, x)) + nearest, **exact)


@pytest.mark.parametrize("form", ["rgba32f", "rgba16", "rgba8"])
def test_the_bits_are_those_of_a_renderer_that_fetches(
    any_engine: Engine, folder: Folder, monkeypatch, form: str
):
    found = []
    for software in (True, False):
        monkeypatch.setattr(ContextInfo, "software", software)
        with Engine(any_engine.ctx) as engine:
            found.append(engine.read(sketch_of(folder, form), "a"))
    np.testing.assert_array_equal(found[0], found[1])


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
    sketch = folder.sketch(
        PASSES.partition('[[pass]]\nname = "a"')[0] + '[[pass]]\nname = "a"\nuse = "./blur"\n'
    )
    with Engine(any_engine.ctx) as engine:
        rough = engine.read(sketch, "rough")
        found, second = engine.read(sketch, "a"), engine.read(sketch, "a:two")
    y, x = np.mgrid[0:17, 0:17]
    start = around(rough, y, x)
    one, two = start[..., 0], start[..., 1:3]
    for _ in range(5):
        one, two = (
            np.float32(0.5) * one[:, np.maximum(x[0] - 1, 0)] + two[np.minimum(y[:, 0] + 2, 16)][..., 1],
            np.modf(two[np.minimum(y + 1, 16), np.minimum(x + 1, 16)] + one[..., None])[0],
        )
    np.testing.assert_allclose(found, one, rtol=1e-5)
    np.testing.assert_allclose(second, two, atol=1e-5)


def test_no_line_and_no_column_changes(folder: Folder):
    kernel = sketch_of(folder).graph.passes[1].technique
    assert has_quick_fetches(kernel)
    before = wrap(kernel, FRAGMENT).stages["fragment"]
    after = with_choices(wrap(kernel, FRAGMENT), [(UNWIRED, 0), (TEXELS, 1)]).stages["fragment"]
    own, changed = before.text.split("\n")[before.first - 1 :], after.text.split("\n")[after.first - 1 :]
    assert [len(line) for line in own] == [len(line) for line in changed]
    assert sum(line.count("k_texel_in(") for line in changed) == 2, "at(…) and of open"
    assert sum(line.count("k_fetch_in(third") for line in changed) == 1, "which is read by textureLod as well"


@pytest.mark.parametrize("name", ["first", "open"])
def test_complaints_name_the_function_of_the_text(any_engine: Engine, folder: Folder, monkeypatch, name: str):
    monkeypatch.setattr(ContextInfo, "software", True)
    sketch_of(folder)
    wrong = READS.replace("texelFetch(open, place * 5, 0)", f"texelFetch({name}, vec2(place), 0)")
    folder.write("reads.glsl", wrong)
    with Engine(any_engine.ctx) as engine, pytest.raises(ShaderError) as refused:
        engine.read(folder.sketch(PASSES), "a")
    first = refused.value.diagnostics[0]
    expected = next(i for i, line in enumerate(wrong.split("\n"), 1) if "vec2(place)" in line)
    assert first.line == expected and "k_texel" not in first.message and "k_fetch" not in first.message
