"""How far each method of lighting is from the truth, kept below bounds, on three terrains under three suns.

``python tests/truth`` prints the whole table, at a finer grid. The bounds are what was
measured, and a little: what makes a method worse than it was is seen here.
"""

from functools import cache

import numpy as np
import pytest

from ..truth.errors import measure, truth_of
from ..truth.land import LANDS
from ..truth.methods import METHODS

SIZE = 49

# The greatest, over the suns 5, 25 and 60 degrees high, of: the mean error of the visible part,
# its 99th percentile, its mean where the sun is partly seen; the light's mean and percentile.
# Of methods of the sky: the light's mean and percentile.
BOUNDS = {
    ("height difference", "cone"): (0.061, 1.152, 0.48, 1.033, 1.152),
    ("height difference", "valley"): (0.478, 1.152, 0.992, 0.562, 1.152),
    ("height difference", "real"): (0.303, 1.152, 0.538, 0.759, 1.152),
    ("L·N", "cone"): (0.081, 1.152, 0.48, 0.007, 0.102),
    ("L·N", "valley"): (0.938, 1.152, 0.992, 0.216, 0.962),
    ("L·N", "real"): (0.553, 1.152, 0.592, 0.033, 0.425),
    ("ray cast", "cone"): (0.005, 0.002, 0.245, 0.002, 0.002),
    ("ray cast", "valley"): (0.005, 0.14, 0.261, 0.004, 0.118),
    ("ray cast", "real"): (0.018, 0.527, 0.286, 0.004, 0.064),
    ("ray cast, sweep", "cone"): (0.006, 0.002, 0.284, 0.002, 0.003),
    ("ray cast, sweep", "valley"): (0.005, 0.14, 0.424, 0.004, 0.118),
    ("ray cast, sweep", "real"): (0.023, 1.103, 0.397, 0.004, 0.078),
    ("ray cast, mean filter", "cone"): (0.069, 0.697, 0.283, 0.014, 0.314),
    ("ray cast, mean filter", "valley"): (0.062, 0.514, 0.361, 0.044, 0.429),
    ("ray cast, mean filter", "real"): (0.286, 1.039, 0.339, 0.098, 0.324),
    ("cylinder", "cone"): (0.577, 0.577, 0.341, 0.498, 0.535),
    ("cylinder", "valley"): (0.577, 0.577, 0.285, 0.412, 0.565),
    ("cylinder", "real"): (0.577, 0.577, 0.262, 0.493, 0.569),
    ("cone 0.01", "cone"): (0.006, 0.132, 0.18, 0.002, 0.014),
    ("cone 0.01", "valley"): (0.007, 0.247, 0.253, 0.006, 0.206),
    ("cone 0.01", "real"): (0.021, 0.498, 0.248, 0.004, 0.062),
    ("cone 0.01, sweep", "cone"): (0.006, 0.13, 0.183, 0.002, 0.013),
    ("cone 0.01, sweep", "valley"): (0.006, 0.247, 0.35, 0.005, 0.206),
    ("cone 0.01, sweep", "real"): (0.025, 0.713, 0.299, 0.005, 0.079),
    ("cone 0.0046", "cone"): (0.004, 0.002, 0.022, 0.002, 0.002),
    ("cone 0.0046", "valley"): (0.004, 0.022, 0.272, 0.003, 0.018),
    ("cone 0.0046", "real"): (0.015, 0.476, 0.141, 0.003, 0.026),
    ("cone 0.0046, sweep", "cone"): (0.005, 0.003, 0.132, 0.002, 0.002),
    ("cone 0.0046, sweep", "valley"): (0.004, 0.022, 0.424, 0.003, 0.018),
    ("cone 0.0046, sweep", "real"): (0.021, 0.766, 0.278, 0.004, 0.071),
    ("sun disc", "cone"): (0.004, 0.003, 0.042, 0.002, 0.002),
    ("sun disc", "valley"): (0.004, 0.007, 0.271, 0.003, 0.006),
    ("sun disc", "real"): (0.014, 0.476, 0.122, 0.003, 0.026),
    ("sun disc, step length 0.25", "cone"): (0.003, 0.003, 0.04, 0.002, 0.002),
    ("sun disc, step length 0.25", "valley"): (0.003, 0.007, 0.271, 0.002, 0.006),
    ("sun disc, step length 0.25", "real"): (0.006, 0.02, 0.098, 0.002, 0.003),
    ("sun disc, sweep", "cone"): (0.005, 0.004, 0.142, 0.002, 0.002),
    ("sun disc, sweep", "valley"): (0.004, 0.007, 0.424, 0.003, 0.006),
    ("sun disc, sweep", "real"): (0.02, 0.812, 0.278, 0.004, 0.07),
    ("horizon sun, on its arc", "cone"): (0.011, 0.291, 0.44, 0.003, 0.027),
    # In its penumbra, some ten texels under the lowest sun, the sweep is off by what the march is.
    ("horizon sun, on its arc", "valley"): (0.003, 0.057, 0.634, 0.002, 0.047),
    ("horizon sun, on its arc", "real"): (0.025, 1.126, 0.285, 0.006, 0.095),
    ("horizon sun, eight", "cone"): (0.061, 1.152, 0.442, 0.007, 0.102),
    ("horizon sun, eight", "valley"): (0.09, 1.152, 0.992, 0.055, 0.846),
    ("horizon sun, eight", "real"): (0.085, 1.152, 0.504, 0.017, 0.344),
    ("horizon sky, table", "cone"): (0.003, 0.008),
    ("horizon sky, table", "valley"): (0.011, 0.049),
    ("horizon sky, table", "real"): (0.004, 0.011),
    ("horizon sky, 32 directions", "cone"): (0.002, 0.004),
    ("horizon sky, 32 directions", "valley"): (0.004, 0.014),
    ("horizon sky, 32 directions", "real"): (0.003, 0.008),
    ("sky patches, all white", "cone"): (0.003, 0.009),
    ("sky patches, all white", "valley"): (0.011, 0.05),
    ("sky patches, all white", "real"): (0.004, 0.012),
    ("analytic", "cone"): (0.061, 1.152, 0.442, 0.008, 0.103),
    ("analytic", "valley"): (0.09, 1.152, 0.992, 0.059, 0.848),
    ("analytic", "real"): (0.085, 1.152, 0.504, 0.018, 0.346),
    ("sun disc, interreflection", "cone"): (0.004, 0.003, 0.042, 0.003, 0.004),
    ("sun disc, interreflection", "valley"): (0.004, 0.007, 0.271, 0.004, 0.007),
    ("sun disc, interreflection", "real"): (0.014, 0.476, 0.122, 0.003, 0.026),
    ("interreflection, table", "cone"): (0.003, 0.007),
    ("interreflection, table", "valley"): (0.013, 0.028),
    ("interreflection, table", "real"): (0.007, 0.016),
    ("interreflection, 32 directions", "cone"): (0.003, 0.009),
    ("interreflection, 32 directions", "valley"): (0.015, 0.03),
    ("interreflection, 32 directions", "real"): (0.007, 0.017),
}


@pytest.fixture(scope="module")
def truths(kept, tmp_path_factory):
    """Give ``truths(terrain)``: what is true of a terrain, worked out once."""
    folder = tmp_path_factory.mktemp("truth")
    return cache(lambda name: truth_of(kept, folder, name, SIZE, strips=10, azimuths=32))


def worst(errors):
    """Return the greatest of each of the five numbers; of the sky's methods there are two."""
    rows = [(e.visibility_mean, e.visibility_p99, e.penumbra_mean, e.light_mean, e.light_p99) for e in errors]
    columns = [[v for v in column if v is not None] for column in zip(*rows, strict=True)]
    return tuple(max(column) for column in columns if column)


@pytest.mark.parametrize(
    "terrain", [name if name == "real" else pytest.param(name, marks=pytest.mark.slow) for name in LANDS]
)
@pytest.mark.parametrize("method", [m for m in METHODS if m.measured], ids=lambda m: m.name)
def test_errors_stay_within_bounds(ctx, kept, truths, tmp_path, method, terrain):
    result = worst(list(measure(kept, tmp_path, method, truths(terrain))))
    bounds = BOUNDS[method.name, terrain]
    assert len(result) == len(bounds)
    assert (np.array(result) <= bounds).all(), f"{[round(v, 4) for v in result]} against {bounds}"
