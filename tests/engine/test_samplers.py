"""How textures are filtered: along slanted ground by a graphics card, plainly where the processor draws."""

from __future__ import annotations

import pytest

from playground.engine.binder import Binder
from playground.engine.software import Software
from playground.engine.tuning import Tuning
from playground.shader.parameter import Sampling


@pytest.mark.parametrize(
    ("software", "sampling", "expected"),
    [
        (False, Sampling("linear", "repeat", True), 8.0),
        (False, Sampling("linear", "repeat", False), 1.0),
        (False, Sampling("nearest", "clamp", True), 1.0),
        (True, Sampling("linear", "repeat", True), 1.0),
    ],
)
def test_anisotropy_is_for_mipmaps_on_a_graphics_card(ctx, software, sampling, expected):
    binder = Binder(ctx, Software(ctx) if software else Tuning())
    try:
        assert binder._new_sampler(sampling).anisotropy == min(expected, ctx.max_anisotropy)
    finally:
        binder.release()
