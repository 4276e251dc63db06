"""A coarse height at more texels: what cubic convolution keeps, it keeps."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine.on_arrays import OnArrays

COARSE, FINE = (13, 9), (37, 41)  # texels to the north and to the east: no whole number of times finer


@pytest.fixture
def finer(engine):
    """Give ``finer(coarse)``, the height at ``FINE`` texels in float64."""

    def run(coarse):
        worked = OnArrays(engine, "generation/finer").run(
            {"coarse": coarse.astype(np.float32)}, size=(FINE[1], FINE[0])
        )
        return worked["height"].astype(np.float64)

    return run


def places(texels):
    return np.meshgrid(*(np.linspace(0, 1, count) for count in texels), indexing="ij")


def test_parabolas_are_kept_within(finer):
    def parabola(y, x):
        return 0.2 + 0.5 * x - 0.3 * y + 0.4 * x * x - 0.6 * y * y + 0.3 * x * y

    found = finer(parabola(*places(COARSE)))
    expected = parabola(*places(FINE))
    inner = (slice(FINE[0] // COARSE[0] + 1, -FINE[0] // COARSE[0] - 1), slice(6, -6))
    np.testing.assert_allclose(found[inner], expected[inner], atol=1e-6)


def test_it_goes_through_the_texels_given(finer):
    coarse = np.random.default_rng(3).random(COARSE)
    # Every third row and every fifth column of the fine grid is one of the coarse grid.
    np.testing.assert_allclose(finer(coarse)[::3, ::5], coarse, atol=1e-6)
