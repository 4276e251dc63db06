"""Erosion under a brush: rock is accounted for, its own step in float64, nothing outside, any window."""

from __future__ import annotations

import numpy as np

from playground.engine.engine import Engine
from playground.engine.on_arrays import OnArrays

NY, NX = 47, 61
SPACING = (9.0, 14.0)
Y, X = np.mgrid[0:NY, 0:NX] * np.array([SPACING[1], SPACING[0]])[:, None, None]


def hills(seed: int = 4) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return (120 * np.sin(X / 130) * np.cos(Y / 170) + rng.normal(0, 1, (NY, NX))).astype(np.float32)


def brush(strength: float = 0.9, radius: float = 230.0) -> np.ndarray:
    away = np.hypot(X - X.mean(), Y - Y.mean())
    t = np.clip((radius - away) / (0.6 * radius), 0, 1)
    return (strength * t * t * (3 - 2 * t)).astype(np.float32)


def stamped(run: OnArrays, height: np.ndarray, weight: np.ndarray, stamps: int, **values: float):
    """Return the height and the water after some stamps, each given what the one before left."""
    water, flux = (np.zeros((*height.shape, 4), np.float32) for _ in range(2))
    for _ in range(stamps):
        value = {"height": height, "brush": weight, "water": water, "flux": flux}
        result = run.run(value, spacing=SPACING, relief=1.0, values=values)
        height, water, flux = result["height"], result["water"], result["flux"]
    return height, water


def test_brush_erosion_conserves_material_with_outflow(engine: Engine):
    run, before, weight = OnArrays(engine, "erosion/brush"), hills(), brush()
    after, water = stamped(run, before, weight, 30)
    change = after.astype(np.float64) - before
    worn, laid = np.maximum(-change, 0).sum(), np.maximum(change, 0).sum()
    carried, left = water[..., 1].astype(np.float64).sum(), water[..., 2].astype(np.float64).sum()
    # Something happens, or the budget would be of nothing: each part is more than rounding can make.
    rounding = 30 * (weight > 0).sum() * np.spacing(np.abs(before).max()) / 2
    assert min(worn, laid, carried, left) > rounding
    assert abs(change.sum() + carried + left) < 1e-6 * (worn + laid)
    assert (after[weight == 0] == before[weight == 0]).all()
    assert (water[..., :2][weight == 0] == 0).all(), "past the rim there is no water"


def test_a_step_of_the_brush_is_the_step_in_float64(engine: Engine):
    rng = np.random.default_rng(8)
    before, after = (rng.normal(0, 20, (NY, NX, 4)).astype(np.float32) for _ in range(2))
    weight = brush()
    options = {"spacing": SPACING, "relief": 1.0, "values": {"repose": 35.0, "creep": 0.03}}
    value = {"before": before, "after": after, "brush": weight}
    result = OnArrays(engine, "erosion/brush/hold").run(value, **options)["state"]
    bed, w, slid = before[..., 0].astype(np.float64), weight.astype(np.float64), np.zeros((NY, NX))
    for y in range(NY):
        for x in range(NX):
            for j, i, length in ((y, x - 1, 9.0), (y, x + 1, 9.0), (y - 1, x, 14.0), (y + 1, x, 14.0)):
                if 0 <= j < NY and 0 <= i < NX:
                    rise, most = bed[j, i] - bed[y, x], np.tan(np.radians(35.0)) * length
                    over = max(rise - most, 0.0) if rise > 0 else min(rise + most, 0.0)
                    slid[y, x] += min(w[y, x], w[j, i]) * (0.05 * over + 0.03 * rise)
    expected = bed + w * (after[..., 0] - bed) + slid
    np.testing.assert_allclose(result[..., 0], np.where(w > 0, expected, bed), atol=1e-4)
    rock = after[..., 0].astype(np.float64) + after[..., 2]  # after the step
    under = w > 0
    np.testing.assert_allclose((result[..., 0] + result[..., 2] - slid)[under], rock[under], atol=1e-4)
    gone = result[..., 3].astype(np.float64) - before[..., 3]
    np.testing.assert_allclose((result[..., 0] + gone)[~under], rock[~under], atol=1e-4)


def test_without_a_brush_it_erodes_everywhere(any_engine: Engine):
    run, before = OnArrays(any_engine, "erosion/brush"), hills()
    result = run.run({"height": before}, spacing=SPACING, relief=1.0)
    assert (result["height"] != before).mean() > 0.5


def test_hostile_parameters_leave_numbers(any_engine: Engine):
    rng = np.random.default_rng(2)
    run, rough = OnArrays(any_engine, "erosion/brush"), rng.normal(0, 2000, (NY, NX)).astype(np.float32)
    hostile = {"rain": 1.0, "wear": 2.0, "capacity": 100.0, "settling": 2.0, "repose": 1.0, "creep": 0.05}
    after, water = stamped(run, rough, brush(1.0), 60, **hostile)
    assert np.isfinite(after).all() and np.isfinite(water).all()
    # No step digs below the lowest neighbour; what is laid down comes from what was higher.
    assert rough.min() <= after.min() and after.max() <= rough.max()
