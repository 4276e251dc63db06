"""The kernel of the lesson on fractals: fractional Brownian motion, and that of the library."""

from __future__ import annotations

import numpy as np
import pytest

from .drawing import salt
from .terrains import toml_value
from .test_gradient_noise import SHIFT, perlin

SIZE = 257
EXTENT = 5000.0


@pytest.fixture
def read(any_engine, make_sketch):
    def of(use, **values):
        given = "".join(f"{k} = {toml_value(v)}\n" for k, v in values.items())
        sketch = make_sketch(
            f'[[pass]]\nname = "a"\nuse = "{use}"\n[pass.set]\n{given}', size=SIZE, extent=EXTENT
        )
        return any_engine.read(sketch.plainly(), "a").astype(np.float64)

    return of


@pytest.mark.parametrize(("hurst", "frequency", "octaves"), [(0.8, 2.0, 7), (0.3, 3.0, 4)])
def test_octaves_are_added(read, hurst, frequency, octaves):
    """Places are off by a rounding, 2^-24 of them; noise rises by less than 4 a cell."""
    y, x = np.mgrid[0:SIZE, 0:SIZE] * (frequency / (SIZE - 1))
    wanted, bound = np.zeros((SIZE, SIZE)), 0.0
    for k in range(octaves):
        which = (7 + salt("generation/fbm")) * 0x2545F491 + k * 0xC2B2AE3D
        wanted += 2.0 ** (-hurst * k) * perlin(x * 2**k + SHIFT, y * 2**k, which)
        bound += 2.0 ** (-hurst * k) * (4 * 4 * frequency * 2**k + 16) * 2.0**-24
    found = read("lessons/fbm", hurst=hurst, frequency=frequency, octaves=octaves)
    assert np.abs(found - wanted).max() <= bound
    library = read("generation/fbm", hurst=hurst, frequency=frequency, octaves=octaves, normalise="none")
    assert np.abs(found - library).max() <= 2 * bound
