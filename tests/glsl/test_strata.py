"""Layers of hardness: constant along a layer, one thickness apart, within the contrast."""

from __future__ import annotations

import numpy as np
import pytest

from ..sketch_texts import passes

PLANE = """#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return float(texel.y) / float(size.y - 1); }
"""


@pytest.fixture
def hardness(engine, make_sketch):
    """Give ``hardness(**parameters)`` on a plane that rises 1000 m to the north over 2000 m."""

    def read(**values):
        text = ", ".join(f"{name} = {value}" for name, value in values.items())
        made = passes(height="./plane", hard=("erosion/strata", f"set = {{ {text} }}"))
        sketch = make_sketch(made, size=[65, 257], extent=[512.0, 2000.0], relief=1000.0, plane=PLANE)
        return engine.read(sketch, "hard").astype(np.float64)

    return read


def test_level_layers_follow_the_elevation(hardness):
    result = hardness(thickness=125.0, dip=[0, 0], folds=0.0, blend=0.01, contrast=4.0)
    assert np.ptp(result, axis=1).max() == 0
    # 32 rows are a layer: in each the hardness is one number, above 1 and below in turn.
    layers = result[:256, 0].reshape(8, 32)
    assert np.ptp(layers[:, 1:-1], axis=1).max() == 0
    signs = np.log2(layers[:, 8])
    assert (signs[::2] > 0).all() and (signs[1::2] < 0).all() and np.abs(signs).max() <= 2
    assert np.abs(signs).min() >= 2 * 0.4 - 1e-6 and len(np.unique(signs)) == 8


def test_layers_that_dip_are_planes(hardness):
    """They lead down to the east at 45 degrees: 500 m further east they are 500 m lower."""
    result = hardness(thickness=250.0, dip=[90, 45], folds=0.0, contrast=9.0, blend=1.0)
    west, east = result[:, 2], result[:, 62]
    # 60 columns of 8 m are 480 m, and 480 m of height are 122.88 rows.
    rows = np.arange(257)
    expected = np.interp(np.arange(130) + 122.88, rows, np.log2(west))
    np.testing.assert_allclose(np.log2(east[:130]), expected, atol=0.01)
    assert result.max() > 2 and result.min() < 0.5


def test_without_contrast_all_rock_is_the_reference(hardness):
    np.testing.assert_array_equal(hardness(contrast=1.0), 1)


def test_folds_bend_the_layers_no_further_than_they_say(hardness):
    """Gradient noise is in -1..1: no layer is found further away than its folds."""
    even = hardness(thickness=400.0, dip=[0, 0], folds=0.0, blend=0.01)
    folded = hardness(thickness=400.0, dip=[0, 0], folds=50.0, fold_width=300.0, blend=0.01)
    rows = int(np.ceil(50 / (1000 / 256)))
    for y in range(rows, 257 - rows, 16):
        assert np.isin(folded[y], even[y - rows : y + rows + 1, 0]).mean() > 0.9
    assert (folded != even).any()


ROUND = """title = "Layers laid bare in turn"
[[pass]]
name = "hard"
use = "erosion/strata"
set = { thickness = 40.0, contrast = 6.0 }
[[pass]]
name = "worn"
use = "erosion/hydraulic"
inputs = { hardness = "hard" }
set = { hours = 40 }
[[pass]]
name = "fallen"
use = "erosion/thermal"
inputs = { height = "worn:height", hardness = "hard" }
set = { steps = 5 }
[inputs]
height = ["hard.height", "worn.height"]
[outputs]
height = "fallen:height"
"""


def test_repeated_erosion_follows_newly_exposed_strata(engine, make_sketch, tmp_path):
    (tmp_path / "round.toml").write_text(ROUND)
    hills = "generation/gradient_noise", "set = { frequency = 3, octaves = 5 }"
    wired = 'inputs = { height = "raw" }'
    rounds = "./round", wired, 'repeat = 3\nfeedback = { height = "height" }'
    made = passes(raw=hills, once=("./round", wired), worn=rounds)
    sketch = make_sketch(made, size=65, extent=5000.0, relief=800.0)
    raw, once, worn = (engine.read(sketch, name).astype(np.float64) for name in ("raw", "once", "worn"))
    changes = [800 * np.abs(result - raw).mean() for result in (once, worn)]
    assert np.isfinite(worn).all() and changes[1] > 1.5 * changes[0] > 1.5
