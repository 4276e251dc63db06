"""A terrain without relief: what wears or shapes it divides by nothing."""

from __future__ import annotations

import numpy as np
import pytest

from ..sketch_texts import passes

TECHNIQUES = {
    "erosion/thermal": "set = { steps = 4 }",
    "erosion/hydraulic": "set = { hours = 60 }",
    "erosion/gullies": "",
    "erosion/stream_power": "set = { coarsest = 8 }",
    "generation/sculpted/sum": 'inputs = { height = "before", change = "before" }',
}


@pytest.mark.parametrize("use", TECHNIQUES)
def test_heights_stay_finite(engine, make_sketch, use: str):
    text = passes(before="generation/white_noise", worn=(use, TECHNIQUES[use]))
    if "inputs" not in TECHNIQUES[use]:
        text += 'inputs = { height = "before" }\n'
    sketch = make_sketch(text, size=17, extent=1000.0, relief=0.0)
    assert np.isfinite(engine.read(sketch, "worn:height")).all()
