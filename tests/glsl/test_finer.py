"""A coarse height at more texels: what cubic convolution keeps, it keeps."""

from __future__ import annotations

import numpy as np
import pytest

from ..sketch_texts import passes

PARABOLA = """#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) {
    vec2 p = vec2(texel) / vec2(size - 1);
    return 0.2 + 0.5 * p.x - 0.3 * p.y + 0.4 * p.x * p.x - 0.6 * p.y * p.y + 0.3 * p.x * p.y;
}
"""


@pytest.fixture
def finer(engine, make_sketch):
    """Give ``finer(use, size)``: a pass of 9 x 13 texels, and that at more, in float64."""

    def read(use, size):
        coarse = (use, "size = [9, 13]")
        made = passes(coarse=coarse, fine=("generation/finer", 'inputs = { coarse = "coarse" }'))
        sketch = make_sketch(made, size=list(size), extent=1000.0, relief=100.0, parabola=PARABOLA)
        return [engine.read(sketch, name).astype(np.float64) for name in ("coarse", "fine")]

    return read


def test_parabolas_are_kept_where_all_four_texels_are(finer):
    """41 x 38 texels: in one direction five times as fine, in the other no whole number of times."""
    _, result = finer("./parabola", (41, 38))
    y, x = np.meshgrid(np.linspace(0, 1, 38), np.linspace(0, 1, 41), indexing="ij")
    expected = 0.2 + 0.5 * x - 0.3 * y + 0.4 * x * x - 0.6 * y * y + 0.3 * x * y
    inner = (np.abs(x - 0.5) <= 0.5 - 1 / 8) & (np.abs(y - 0.5) <= 0.5 - 1 / 12)
    np.testing.assert_allclose(result[inner], expected[inner], atol=1e-6)


def test_it_goes_through_the_texels_given(finer):
    coarse, result = finer("generation/white_noise", (41, 37))
    np.testing.assert_allclose(result[::3, ::5], coarse, atol=1e-6)
