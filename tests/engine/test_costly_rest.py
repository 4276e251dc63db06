"""A kernel that says where its costly rest begins runs that only where it is needed, with the same texels."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine.context import ContextInfo
from playground.engine.engine import Engine

from .conftest import Folder

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


def truth() -> tuple[np.ndarray, np.ndarray]:
    x, y = np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1]))
    rest = (x + y) % 5 == 0
    blue = np.where(rest, np.sin(x) + 2.0, 0.0)
    return np.stack([x, y, blue, np.ones_like(blue)], -1), np.where(rest, 7.0, 3.0)


@pytest.mark.parametrize("repeat", ["", ', repeat = "2"'])
def test_its_texels_are_those_of_the_kernel_as_it_is_written(engine: Engine, folder: Folder, repeat: str):
    sketch = folder.one(KERNEL.replace("REPEAT", repeat), size=TEXELS)
    result, more = truth()
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
