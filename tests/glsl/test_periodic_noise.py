"""noise/periodic.glsl, against float64 twins with the same hash, and against its own copies."""

from __future__ import annotations

import numpy as np
import pytest

FILE = "noise/periodic.glsl"
PERIOD = (5, 3)
SEED = 11


def bits(x: int, y: int, seed: int) -> list[int]:
    """Mix a lattice point and a seed as pcg3d does, with Python's integers."""
    v = [(n * 1664525 + 1013904223) % 2**32 for n in (int(x), int(y), int(seed))]
    for rounds in range(2):
        for i in range(3):
            v[i] = (v[i] + v[(i + 1) % 3] * v[(i + 2) % 3]) % 2**32
        if rounds == 0:
            v = [n ^ (n >> 16) for n in v]
    return v


def number(x: int, y: int, seed: int = SEED) -> np.ndarray:
    """Two random numbers of a lattice point that has been brought into the tile."""
    return np.array([n >> 8 for n in bits(x % PERIOD[0], y % PERIOD[1], seed)[:2]]) / 2.0**24


@pytest.fixture
def places() -> np.ndarray:
    # Sixty-fourths: exact in float32, so that a copy one period away has the same place in its cell.
    return np.random.default_rng(3).integers(-1000, 1000, (400, 2)) / 64


def blend(array: np.ndarray, corner: object) -> float:
    low = np.floor(array).astype(int)
    part = array - low
    weight = 6 * part**5 - 15 * part**4 + 10 * part**3
    total = 0.0
    for i in (0, 1):
        for j in (0, 1):
            share = (weight[0] if i else 1 - weight[0]) * (weight[1] if j else 1 - weight[1])
            total += share * corner(low[0] + i, low[1] + j, part - (i, j))
    return total


def test_value_noise_interpolates_four_lattice_values(on_gpu, places):
    result = on_gpu(FILE, f"value_noise_periodic(p, ivec2{PERIOD}, {SEED}u)", p=places)
    expected = [blend(p, lambda x, y, _: number(x, y)[0]) for p in places]
    np.testing.assert_allclose(result, expected, atol=2e-6)


def test_gradient_noise_interpolates_four_lattice_planes(on_gpu, places):
    result = on_gpu(FILE, f"gradient_noise_periodic(p, ivec2{PERIOD}, {SEED}u)", p=places)
    expected = [blend(p, lambda x, y, d: (number(x, y) * 2 - 1) @ d) for p in places]
    np.testing.assert_allclose(result, expected, atol=3e-6)


def test_periodic_cells_find_two_nearest_points_with_wraparound(on_gpu, places):
    result = on_gpu(FILE, f"cells_periodic(p, ivec2{PERIOD}, {SEED}u)", p=places)
    x, y = np.meshgrid(np.arange(-20, 21), np.arange(-20, 21))
    cells = np.stack([x.ravel(), y.ravel()], axis=1)
    points = cells + np.array([number(*c) for c in cells])
    far = np.linalg.norm(places[:, None] - points[None], axis=2)
    order = np.argsort(far, axis=1)[:, :2]
    np.testing.assert_allclose(result[:, :2], np.take_along_axis(far, order, axis=1), atol=1e-5)
    numbers = np.array([number(*cells[i], SEED + 1)[0] for i in order[:, 0]])
    np.testing.assert_allclose(result[:, 2], numbers, atol=1e-6)


@pytest.mark.parametrize(
    "expression",
    [
        "value_noise_periodic(p, ivec2(5, 3), 11u)",
        "gradient_noise_periodic(p, ivec2(5, 3), 11u)",
        "gradient_fbm_periodic(p, ivec2(5, 3), 4, 0.5, 11u)",
        "cells_periodic(p, ivec2(5, 3), 11u).xyz",
    ],
)
@pytest.mark.parametrize("away", [(5, 0), (0, 3), (-5, 6)])
def test_a_copy_one_period_away_is_the_same(on_gpu, places, expression, away):
    here, there = on_gpu(FILE, expression, p=places), on_gpu(FILE, expression, p=places + away)
    if "cells" in expression:  # distances are differences of larger numbers there
        np.testing.assert_allclose(here, there, atol=1e-5)
    else:
        np.testing.assert_array_equal(here, there)


def test_gradient_noise_is_zero_on_lattice_and_within_one(on_gpu):
    x, y = np.meshgrid(np.arange(-3.0, 8.0), np.arange(-3.0, 8.0))
    lattice = np.stack([x.ravel(), y.ravel()], axis=1)
    assert not on_gpu(FILE, "gradient_noise_periodic(p, ivec2(16), 2u)", p=lattice).any()
    dense = np.random.default_rng(1).uniform(0, 64, (20_000, 2))
    values = on_gpu(FILE, "gradient_noise_periodic(p, ivec2(64), 2u)", p=dense)
    assert np.abs(values).max() <= 1
    assert abs(values.astype(float).mean()) < 0.02
    assert values.astype(float).std() > 0.15


def test_wrapping_agrees_with_the_remainder_of_mathematics(on_gpu):
    points = np.random.default_rng(2).integers(-50, 50, (200, 2)).astype(np.int32)
    result = on_gpu(FILE, "lattice_wrapped(p, ivec2(7, 4))", p=points)
    np.testing.assert_array_equal(result, np.mod(points, (7, 4)))
