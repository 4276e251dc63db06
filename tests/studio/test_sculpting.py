"""What the sculptor's tools do to terrain, against formulas in float64 and slow sums over texels."""

from __future__ import annotations

import numpy as np
import pytest

from playground.studio.paint.brush import APPROACH, SHARPEN, TOOLS, Brush, Dab, sculpt

SHAPING = tuple(tool for tool in TOOLS if tool != "erode")  # which runs a technique
EXTENT = (900.0, 400.0)
NY, NX = 41, 61
DX, DY = EXTENT[0] / (NX - 1), EXTENT[1] / (NY - 1)  # [m] 15 and 10
MIDDLE = (0.5, 0.5)
Y, X = np.mgrid[0:NY, 0:NX] * np.array([DY, DX])[:, None, None]


def hills(seed: int = 3) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return (300 + 80 * np.sin(X / 70) * np.cos(Y / 50) + rng.normal(0, 5, (NY, NX))).astype(np.float32)


def worked(tool: str, seconds: float, *, ground=None, start=None, at=(MIDDLE, MIDDLE), steps=1, **brush):
    """Return the change after a stroke, float64."""
    change = np.zeros((NY, NX), np.float32) if start is None else start.copy()
    value = Brush(**{"radius": 120.0, "strength": 0.8, "softness": 0.6, "tool": tool} | brush)
    for n in range(steps):
        a, b = (tuple(np.array(at[0]) + (np.array(at[1]) - at[0]) * (n + k) / steps) for k in (0, 1))
        sculpt(change, ground, Dab(a, b, EXTENT, value, seconds / steps), rate=40.0, level=310.0)
    return change.astype(np.float64)


def falloff(position=MIDDLE, radius=120.0, softness=0.6) -> np.ndarray:
    """Return the brush's share at each texel, from its description: a cubic over the softness."""
    away = np.hypot(X - position[0] * EXTENT[0], Y - position[1] * EXTENT[1])
    t = np.clip((radius - away) / (radius * softness), 0, 1)
    return 3 * t**2 - 2 * t**3


@pytest.mark.parametrize(("tool", "sign"), [("raise", 1), ("lower", -1)])
def test_raise_adds_rate_times_seconds_times_falloff(tool, sign):
    value = worked(tool, 0.5)
    np.testing.assert_allclose(value, sign * 0.8 * 40.0 * 0.5 * falloff(), atol=1e-4)


@pytest.mark.parametrize("tool", SHAPING)
def test_tool_effect_per_second_is_independent_of_frame_rate(tool):
    ground, start = hills(), np.full((NY, NX), 12.0, np.float32)
    once, often = (worked(tool, 1.0, ground=ground, start=start, steps=n) - 12.0 for n in (10, 100))
    assert np.abs(once).max() > 1
    np.testing.assert_allclose(once, often, atol=0.03 * np.abs(once).max())


def test_line_stroke_is_time_integral_of_brush():
    ends = (0.3, 0.4), (0.7, 0.6)
    value = worked("raise", 2.0, at=ends)
    shares = np.linspace(0, 1, 2001)
    places = (np.array(ends[0]) + share * (np.array(ends[1]) - ends[0]) for share in shares)
    expected = 0.8 * 40.0 * 2.0 * np.mean([falloff(tuple(position)) for position in places], axis=0)
    np.testing.assert_allclose(value, expected, atol=0.02 * expected.max())


def test_flatten_levels_hard_core_and_leaves_outside_unchanged():
    ground = hills()
    change = worked("flatten", 4.0, ground=ground, strength=1.0, softness=0.5)
    terrain = ground + change
    away = np.hypot(X - 450, Y - 200)
    core = away < 60 - 1e-6
    # exp(-rate t) of what was there is left, and what float32 rounds off.
    left = np.exp(-APPROACH * 4.0) * np.abs(ground - 310.0).max() + 4 * np.spacing(np.float32(310.0))
    assert np.abs(terrain[core] - 310.0).max() <= left
    assert (change[away >= 120] == 0).all()
    before, after = np.abs(ground.astype(float) - 310), np.abs(terrain - 310)
    assert (after <= before + 1e-4).all(), "nowhere farther from the level"


def test_flatten_and_erase_go_by_the_exponential():
    start = hills() - 300
    value = worked("erase", 0.13, start=start)
    np.testing.assert_allclose(value, start * np.exp(-APPROACH * 0.8 * 0.13 * falloff()), atol=1e-4)
    value = worked("flatten", 0.13, start=start)
    expected = 310 + (start - 310) * np.exp(-APPROACH * 0.8 * 0.13 * falloff())
    np.testing.assert_allclose(value, expected, atol=1e-4)


def test_smooth_moves_rock_and_makes_none():
    ground = hills()
    change = worked("smooth", 1.0, ground=ground, steps=7)
    assert np.abs(change).max() > 5
    # The sum of float32 roundings of 7 stamps over the texels that were reached.
    assert abs(change.sum()) < 7 * np.count_nonzero(change) * np.spacing(np.float32(np.abs(change).max()))
    inside = falloff() > 0
    terrain = ground + change
    assert terrain[inside].var() < 0.8 * ground[inside].var()
    assert terrain.max() <= ground.max() + 1e-3 and terrain.min() >= ground.min() - 1e-3
    assert (change[~inside] == 0).all()


def test_smooth_is_the_heat_equation_in_metres():
    """Under a brush that is 1 everywhere a wave decays by exp(-D k^2 t), alike along both axes."""
    seconds, radius = 0.1, 5000.0
    most = (32 * min(DX, DY)) ** 2 / 16 * seconds  # the finer side bounds its steps
    for axis, (length, coordinate) in enumerate([(10 * DY, Y), (10 * DX, X)]):
        wave = np.sin(2 * np.pi * coordinate / length)
        result = wave + worked(
            "smooth", seconds, ground=wave.astype(np.float32), strength=0.1, softness=0.0, radius=radius
        )
        inner = result[12:-12, 15:-15]
        spacing = (DY, DX)[axis]
        # Of the five-point operator: k^2 becomes (2 - 2 cos(k d)) / d^2.
        decay = np.exp(-0.1 * most * (2 - 2 * np.cos(2 * np.pi * spacing / length)) / spacing**2)
        assert decay < 0.9
        np.testing.assert_allclose(inner, decay * wave[12:-12, 15:-15], atol=0.02)


def test_sharpen_raises_what_stands_above_its_mean():
    ground = hills()
    value = worked("sharpen", 0.2, ground=ground)
    sigma, weight = 30.0, 0.8 * falloff()
    y, x = 17, 33
    # The mean by a slow sum over the square that the brush looks at: three deviations beyond its edge.
    columns = range(max(int(np.floor((450 - 210) / DX)), 0), min(int(np.ceil((450 + 210) / DX)) + 1, NX))
    rows = range(max(int(np.floor((200 - 210) / DY)), 0), min(int(np.ceil((200 + 210) / DY)) + 1, NY))
    near = [(j, i, np.exp(-(((i - x) * DX) ** 2 + ((j - y) * DY) ** 2) / (2 * sigma**2)))
            for j in rows for i in columns]  # fmt: skip
    mean = sum(g * float(ground[j, i]) for j, i, g in near) / sum(g for *_, g in near)
    expected = (np.exp(SHARPEN * 0.2 * weight[y, x]) - 1) * (ground[y, x] - mean)
    np.testing.assert_allclose(value[y, x], expected, rtol=1e-3)
    assert abs(worked("sharpen", 1.0, ground=np.full((NY, NX), 70.0, np.float32))).max() < 1e-4


@pytest.mark.parametrize("tool", SHAPING)
@pytest.mark.parametrize("position", [(0.0, 0.0), (1.0, 0.3), (3.0, 3.0), (-0.01, 1.005)])
def test_every_tool_stays_finite_at_edges_and_off_terrain(tool, position):
    ground = hills()
    value = worked(tool, 0.1, ground=ground, at=(position, position))
    assert np.isfinite(value).all()
    assert value.any() == (position[0] < 2 and tool != "erase")


@pytest.mark.parametrize("tool", SHAPING)
def test_a_mirrored_stroke_is_the_mirror_image(tool):
    ground, start = hills(), hills(4) - 300
    value = worked(tool, 0.3, ground=ground, start=start, at=((0.3, 0.4), (0.6, 0.5)))
    other = worked(tool, 0.3, ground=ground[:, ::-1], start=start[:, ::-1], at=((0.7, 0.4), (0.4, 0.5)))[
        :, ::-1
    ]
    np.testing.assert_allclose(value, other, atol=1e-3)
