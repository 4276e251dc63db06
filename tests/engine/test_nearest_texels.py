"""Fetches by samplers that take the nearest, on a software renderer: the texels of a fetch, to the bit."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from playground.engine import programs
from playground.engine.engine import Engine
from playground.errors import ShaderError
from playground.gpu.context import ContextInfo
from playground.gpu.interpolated_place import with_interpolated_place
from playground.gpu.nearest_texels import reads_nearest, with_nearest_texels
from playground.gpu.wrap import FRAGMENT, wrap
from playground.sketch.model import Sketch
from playground.sketch.reserved_names import LEVEL_0, OWN_SIZE

from .conftest import Folder

NUMBERS = """#pragma kernel(output = "numbers:FORMAT")
TYPE kernel(ivec2 texel) { return TYPE(vec4(texel, 0.3, 1e-7) / DIVISOR + 0.25); }
"""
READS = """#pragma kernel(output = "found:rgba32f")
uniform sampler2D numbers;  //! input
vec4 at(sampler2D field, ivec2 place) { return texelFetch(field, place, 0); }
vec4 kernel(ivec2 texel) { return at(numbers, texel + ivec2(SHIFT)); }
"""
ASKS = """#pragma kernel(output = "found:rgba32f")
uniform sampler2D numbers;  //! input
vec4 kernel(ivec2 texel) {
    return vec4(textureSize(numbers, 0), 0.0, 0.0) + texelFetch(numbers, ivec2(0), 0);
}
"""
PASSES = """
[[pass]]
name = "numbers"
use = "./numbers"
size = [SIZE]
[[pass]]
name = "a"
use = "./reads"
size = [OWN]
"""


def sketch_of(
    folder: Folder, reads: str = READS, size: str = "5, 3", own: str = "5, 3", form: str = "rgba32f"
) -> Sketch:
    kind = "float" if form.startswith("r16") or form == "r32f" else "vec2" if "rgb" not in form else "vec4"
    text = NUMBERS.replace("FORMAT", form).replace("TYPE", kind)
    folder.write("numbers.glsl", text.replace("DIVISOR", "1.0" if form.endswith("f") else "16.0"))
    folder.write("reads.glsl", reads.replace("SHIFT", "0"))
    return folder.sketch(PASSES.replace("SIZE", size).replace("OWN", own))


@pytest.fixture
def compiled(any_engine: Engine, monkeypatch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    """Give the fragment shaders that are compiled, on what passes for a software renderer."""
    found: list[str] = []
    own = programs.compile_wrapped

    def noted(ctx, wrapped):
        found.extend(stage.text for name, stage in wrapped.stages.items() if name == "fragment")
        return own(ctx, wrapped)

    monkeypatch.setattr(ContextInfo, "software", True)
    monkeypatch.setattr(programs, "compile_wrapped", noted)
    return found


@pytest.mark.parametrize("own", ["5, 3", "7, 6"])
@pytest.mark.parametrize("shift", ["0", "-2, 1", "4, -1", "-2000000000, 0"])
def test_each_texel_is_that_of_its_place_and_outside_are_zeros(
    any_engine: Engine, folder: Folder, compiled: list[str], own: str, shift: str
):
    sketch = sketch_of(folder, READS.replace("SHIFT", shift), own=own)
    with Engine(any_engine.ctx) as engine:
        found = engine.read(sketch, "a")
    assert any(LEVEL_0 in text for text in compiled)
    height, width = found.shape[:2]
    right, up = [int(part) for part in (f"{shift}, {shift}").split(", ")[:2]]
    expected = np.zeros((height, width, 4), np.float32)
    for y, x in np.ndindex(height, width):
        if 0 <= x + right < 5 and 0 <= y + up < 3:
            expected[y, x] = np.array([x + right, y + up, 0.3, 1e-7], np.float32) + np.float32(0.25)
    np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("own", ["4095, 2", "8193, 2"])
def test_no_texel_is_missed_where_there_are_many(
    any_engine: Engine, folder: Folder, compiled: list[str], own: str
):
    """The middle of a texel as a share of the width is rounded, by far less than half a texel."""
    with Engine(any_engine.ctx) as engine:
        found = engine.read(sketch_of(folder, size="8193, 2", own=own), "a")
    expected = np.arange(found.shape[1], dtype=np.float32) + np.float32(0.25)
    np.testing.assert_array_equal(found[0, :, 0], expected)


@pytest.mark.parametrize("form", ["r32f", "rgba16f", "rg16f", "rgba8", "r16"])
def test_the_bits_are_those_of_a_fetch(
    any_engine: Engine, folder: Folder, monkeypatch: pytest.MonkeyPatch, form: str
):
    found = []
    sketch = sketch_of(folder, READS.replace("SHIFT", "1, 0"), form=form)
    for software in (True, False):
        monkeypatch.setattr(ContextInfo, "software", software)
        with Engine(any_engine.ctx) as engine:
            found.append(engine.read(sketch, "a"))
    inside = np.s_[:, :-1]  # beyond the last column a format without alpha has none to be zero
    np.testing.assert_array_equal(found[0][inside], found[1][inside])


def test_sizes_are_those_of_the_textures_whether_known_or_asked_for(
    any_engine: Engine, folder: Folder, compiled: list[str]
):
    """The same kernel runs with an input of its own size, then with one of another."""
    with Engine(any_engine.ctx) as engine:
        for size in ("9, 4", "6, 2", "9, 4"):
            found = engine.read(sketch_of(folder, ASKS, size=size, own="9, 4"), "a")[0, 0]
            width, height = map(int, size.split(", "))
            np.testing.assert_allclose(found, [width + 0.25, height + 0.25, 0.55, 0.25], rtol=1e-6)
    assert [OWN_SIZE in text for text in compiled if LEVEL_0 in text][:2] == [True, False]


def test_a_texture_of_its_size_is_not_asked_for_it(any_engine: Engine, folder: Folder, compiled: list[str]):
    """What a text does for other sizes is left out then as it is compiled."""
    with Engine(any_engine.ctx) as engine:
        engine.read(sketch_of(folder, ASKS), "a")
    (text,) = [text for text in compiled if LEVEL_0 in text]
    assert "#define textureSize" in text
    assert "vec2(textureSize" not in text


def test_a_kernel_with_a_sampler_that_mixes_texels_or_with_a_loop_fetches_them(folder: Folder):
    mixed = READS.replace("//! input", '//! input("linear")')
    by_filter = READS.replace("texelFetch(field, place, 0)", "textureLod(field, vec2(place), 0.0)")
    loops = READS.replace("return at", "for (int i = 0; i < 9; ++i) texel.x += i;\n    return at")
    for reads, expected in ((READS, True), (mixed, False), (by_filter, False), (loops, False)):
        kernel = sketch_of(folder, reads).graph.passes[1].technique
        assert reads_nearest(kernel) is expected


def test_no_line_and_no_column_changes(folder: Folder):
    sketch = sketch_of(folder, ASKS.replace("numbers, 0)", "numbers, 0) * size / size", 1))
    kernel = sketch.graph.passes[1].technique
    plain = wrap(kernel, FRAGMENT)
    before = plain.stages["fragment"]
    after = with_interpolated_place(with_nearest_texels(plain, own_size=True)).stages["fragment"]
    texts = [stage.text.split("\n")[stage.first - 1 :] for stage in (before, after)]
    own = len(kernel.source.lines)
    assert texts[0][:own] == texts[1][:own]
    assert after.locate(after.first) == kernel.source.lines[0]
    assert after.text.count("uniform ivec2 size;") == 1
    assert len("texelFetch") == len(LEVEL_0)
    assert len("textureSize") == len(OWN_SIZE)


@pytest.mark.parametrize("wrong", ["texelFetch(numbers, vec2(1.0), 0)", "vec3(textureSize(numbers, 0))"])
def test_a_complaint_names_what_the_author_wrote(
    any_engine: Engine, folder: Folder, monkeypatch: pytest.MonkeyPatch, wrong: str
):
    sketch = sketch_of(folder, READS.replace("at(numbers, texel + ivec2(SHIFT))", f"vec4({wrong})"))
    said = []
    for software in (True, False):
        monkeypatch.setattr(ContextInfo, "software", software)
        with Engine(any_engine.ctx) as engine, pytest.raises(ShaderError) as caught:
            engine.read(sketch, "a")
        said.append(caught.value.diagnostics)
    assert said[0] == said[1]


def test_a_text_with_a_macro_of_that_name_compiles(any_engine: Engine, folder: Folder, compiled: list[str]):
    own = READS.replace("uniform", "#define texelFetch(a, b, c) vec4(textureSize(a, c), b)\nuniform", 1)
    with Engine(any_engine.ctx) as engine:
        found = engine.read(sketch_of(folder, own), "a")
    np.testing.assert_array_equal(found[2, 4], [5, 3, 4, 2])


@pytest.mark.parametrize("size", ["8193, 3", "3, 8193", "4095, 5", "1, 1"])
def test_each_texel_knows_its_place(any_engine: Engine, folder: Folder, compiled: list[str], size: str):
    """The place that the vertex shader gives is rounded, by far less than half a texel."""
    with Engine(any_engine.ctx) as engine:
        found = engine.read(sketch_of(folder, size=size, own="2, 2"), "numbers")
    assert any("ivec2(k_place_at)" in text for text in compiled)
    height, width = found.shape[:2]
    np.testing.assert_array_equal(found[..., 0], np.tile(np.arange(width) + np.float32(0.25), (height, 1)))
    np.testing.assert_array_equal(found[..., 1].T, np.tile(np.arange(height) + np.float32(0.25), (width, 1)))
