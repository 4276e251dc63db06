"""Terrain from an example: each part against brute force, and the whole by what the example is like."""

from __future__ import annotations

import sys
from itertools import pairwise, product
from pathlib import Path

import numpy as np
import pytest
import tifffile
from scipy.ndimage import gaussian_filter
from scipy.special import ndtri
from scipy.stats import rankdata

from playground.data import by_example
from playground.data.by_example import (
    CELLS,
    Candidates,
    Fit,
    SynthesisSettings,
    cut,
    features_of,
    in_cells,
    integrated,
    made_like,
    normal_deviate,
    oriented,
    quilted,
    smoothed,
)
from playground.data.elevation import Elevation, read_elevation
from playground.engine import file_sources
from playground.engine.source_kinds import Material
from playground.engine.sources import rank_heights
from playground.errors import DataError
from playground.memo import SOURCES
from playground.paths import GLSL

from ..truth.drainage import drained_areas, exponent_of

RNG = np.random.default_rng(7)
JACKSBORO = GLSL / "sketches/data/jacksboro_fault_dem.npz"
METRES = 80.0
FIFTY_CANDIDATES = SynthesisSettings(candidates=50)


# ── fields ───────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("sigma", [3.0, 6.0])
def test_smoothing_is_a_gaussian_of_the_mirrored_field(sigma):
    field = RNG.normal(size=(37, 52))
    expected = gaussian_filter(field, sigma, mode="reflect", truncate=9)
    np.testing.assert_allclose(smoothed(field, sigma), expected, atol=1e-9)
    assert smoothed(np.full((5, 9), 3.0), sigma) == pytest.approx(3.0)


@pytest.mark.parametrize("nearness", [1e-4, 0.3])
def test_a_field_of_gradients_is_the_least_squares_one(nearness):
    ny, nx = 6, 9
    east, north, near = RNG.normal(size=(3, ny, nx))
    rows, expected = [], []

    def equation(weight, number, *places):
        row = np.zeros((ny, nx))
        for position, sign in places:
            row[position] = sign
        rows.append(weight * row.ravel())
        expected.append(weight * number)

    for y, x in product(range(ny), range(nx)):
        if x + 1 < nx:
            equation(1, east[y, x], ((y, x + 1), 1), ((y, x), -1))
        if y + 1 < ny:
            equation(1, north[y, x], ((y + 1, x), 1), ((y, x), -1))
        equation(np.sqrt(nearness), near[y, x], ((y, x), 1))
    result = np.linalg.lstsq(np.array(rows), np.array(expected), rcond=None)[0].reshape(ny, nx)
    np.testing.assert_allclose(integrated(east, north, near, nearness), result, atol=1e-9)


def test_gradients_of_a_field_give_it_back():
    field = RNG.normal(size=(31, 20))
    east, north = np.diff(field, axis=1, append=0), np.diff(field, axis=0, append=0)
    np.testing.assert_allclose(integrated(east, north, field, 1e-4), field, atol=1e-9)


# ── pieces ───────────────────────────────────────────────────────────────────


def test_a_cut_is_the_best_of_all_ways():
    for _ in range(20):
        error = RNG.random((5, 4))
        ways = [w for w in product(range(4), repeat=5) if (abs(np.diff(w)) <= 1).all()]
        best = min(ways, key=lambda way: error[np.arange(5), way].sum())
        assert tuple(cut(error)) == best


def test_eight_orientations_keep_metres():
    """A plane that rises 0.3 to the east and 0.1 to the north rises so, turned and mirrored."""
    y, x = np.mgrid[0:40, 0:30]
    ways = oriented(0.3 * 50 * x + 0.1 * 80 * y, (50.0, 80.0), (40.0, 60.0))
    result = set()
    for way in ways:
        north, east = np.gradient(way, 60.0, 40.0)
        assert np.ptp(east) < 0.02 and np.ptp(north) < 0.02
        result.add((round(float(east.mean()), 2), round(float(north.mean()), 2)))
    expected = {(a * s, b * t) for a, b in ((0.3, 0.1), (0.1, 0.3)) for s in (1, -1) for t in (1, -1)}
    assert {(round(a, 2), round(b, 2)) for a, b in expected} == result


def test_cells_are_means():
    pieces = RNG.random((3, 19, 19))
    edges = [k * 19 // CELLS for k in range(CELLS)] + [19]
    expected = [
        [p[a:b, c:d].mean() for a, b in pairwise(edges)
         for c, d in pairwise(edges)]
        for p in pieces
    ]  # fmt: skip
    np.testing.assert_allclose(in_cells(pieces), expected)


def test_the_best_piece_is_that_of_the_least_error():
    """Worked out piece by piece: relative to both variances, and with what was used before."""
    example = gaussian_filter(RNG.normal(size=(60, 50)), 3) * 100
    side = 16
    pieces = Candidates(oriented(example, (1.0, 1.0), (1.0, 1.0)), side, 60, np.random.default_rng(2))
    existing = RNG.random((side, side)) < 0.4
    heights, features = 10 * RNG.normal(size=(side, side)) + 70, RNG.normal(size=CELLS * CELLS)
    errors = []
    for number in range(60):
        piece = pieces.with_border(number)[:-1, :-1]
        a, b = piece[existing], heights[existing]
        error = np.var(a - b) / (np.var(a) + np.var(b))
        errors.append(error)
    assert pieces.best(Fit(existing, heights)) == int(np.argmin(errors))
    again = pieces.best(Fit(existing, heights))
    assert again != int(np.argmin(errors)), (
        "the same is not taken twice running where others are nearly as good"
    )
    fresh = Candidates(oriented(example, (1.0, 1.0), (1.0, 1.0)), side, 60, np.random.default_rng(2))
    whole = features_of(example, side / 6)
    of_ways = oriented(whole, (1.0, 1.0), (1.0, 1.0))
    for number in range(60):
        y, x = fresh.corners[number]
        own = in_cells(of_ways[fresh.which[number]][y : y + side, x : x + side]) / whole.std()
        away = (abs(features) * (own - features) ** 2).sum() / (abs(features) * features**2).sum()
        errors[number] += 5.0 * away
    assert fresh.best(Fit(existing, heights, features, 5.0)) == int(np.argmin(errors))


def test_a_quilt_of_an_even_slope_has_no_seam():
    """All pieces of one orientation are the same: so whatever is cut, it is that plane."""
    plane = np.add.outer(2.0 * np.arange(60), 3.0 * np.arange(60))
    pieces = Candidates([plane] * 5, 16, 20, np.random.default_rng(1))
    laid = quilted(pieces, (50, 37), 5)
    assert (laid.heights.shape, laid.east.shape) == ((37, 50), (37, 50))
    np.testing.assert_allclose(laid.east, 3.0)
    np.testing.assert_allclose(laid.north, 2.0)
    np.testing.assert_allclose(np.diff(laid.heights, axis=1), 3.0, atol=1e-4)


# ── the whole ────────────────────────────────────────────────────────────────


@pytest.fixture(scope="module")
def example() -> Elevation:
    return read_elevation(JACKSBORO)


def lines(n: int) -> np.ndarray:
    """Return a picture of three ridges that meet."""
    y, x = np.mgrid[0:n, 0:n] / (n - 1)
    result = np.full((n, n), 1e9)
    for end in ((0.1, 0.1), (0.9, 0.2), (0.5, 0.95)):
        way = np.array(end) - 0.5
        t = np.clip(((x - 0.5) * way[0] + (y - 0.5) * way[1]) / (way @ way), 0, 1)
        result = np.minimum(result, np.hypot(x - 0.5 - t * way[0], y - 0.5 - t * way[1]))
    return (result < 0.02).astype(float)


def made(example: Elevation, n: int = 161, guide: np.ndarray | None = None, **wishes: object) -> np.ndarray:
    wished = SynthesisSettings(**{"candidates": 400, **wishes})
    return made_like(example, example.spacing, (n, n), (METRES, METRES), wished, guide)


def slopes(heights: np.ndarray) -> np.ndarray:
    """Return the slopes [degrees] that a half, nine tenths and 99 of 100 texels stay below."""
    north, east = np.gradient(heights, METRES)
    return np.percentile(np.degrees(np.arctan(np.hypot(east, north))), [50, 90, 99])


def spectrum(heights: np.ndarray) -> float:
    """Return the exponent of the power spectrum, from waves of 8 km to 200 m."""
    n = min(heights.shape)
    square = heights[:n, :n] - heights[:n, :n].mean()
    power = abs(np.fft.fft2(square * np.hanning(n)[:, None] * np.hanning(n))) ** 2
    k = np.hypot(*np.meshgrid(np.fft.fftfreq(n, METRES), np.fft.fftfreq(n, METRES)))
    edges = np.geomspace(1 / 8000, 1 / 200, 9)
    means = [power[(k >= a) & (k < b)].mean() for a, b in pairwise(edges)]
    return float(np.polyfit(np.log(np.sqrt(edges[1:] * edges[:-1])), np.log(means), 1)[0])


def parts(example: Elevation, n: int = 161) -> list[np.ndarray]:
    """Return an example in square texels, and its four corners, n x n each."""
    whole = oriented(example.heights.astype(np.float64), example.spacing, (METRES, METRES))[0]
    corners = [whole[y, x] for y in (slice(n), slice(-n, None)) for x in (slice(n), slice(-n, None))]
    return [whole, *corners]


@pytest.mark.parametrize("guided", [False, True])
def test_slopes_and_spectrum_are_those_of_the_example(example, guided):
    """As near to the whole example's as those of its own parts of that size are."""
    result = made(example, guide=lines(161) if guided else None)
    for measure in (slopes, spectrum):
        whole, *own = (measure(part) for part in parts(example))
        assert (abs(measure(result) - whole) <= np.max([abs(part - whole) for part in own], axis=0)).all()


@pytest.mark.slow
def test_its_rivers_branch_as_those_of_the_example(example):
    """Areas drained fall off by an exponent within 0.1 of the example's."""
    own = exponent_of(drained_areas(parts(example)[1]))
    assert own == pytest.approx(0.46, abs=0.03), "as measured before"
    for guide in (None, lines(161)):
        assert exponent_of(drained_areas(made(example, guide=guide, seed=2))) == pytest.approx(own, abs=0.1)


def test_ridges_stand_where_they_are_drawn(example):
    guide = lines(129)
    near = gaussian_filter(guide, 6)
    for drawn in (guide, lines(43)):  # a guide may have any size
        result = made(example, 129, drawn, follow=0.7)
        assert np.mean(result[guide > 0]) > np.percentile(result[near < 0.01], 90)
        assert np.corrcoef(near.ravel(), result.ravel())[0, 1] > 0.6
    valleys = made(example, 129, -guide, follow=0.7)
    assert np.mean(valleys[guide > 0]) < np.percentile(valleys[near < 0.01], 10)


def test_a_guide_that_is_not_followed_is_none(example):
    plain = made(example, 65)
    for guide, follow in ((lines(65), 0.0), (np.full((9, 9), 0.4), 0.5), (np.ones((1, 1)), 0.5)):
        np.testing.assert_array_equal(made(example, 65, guide, follow=follow), plain)


def test_a_seed_is_one_terrain(example):
    first, again, other = made(example, 65), made(example, 65), made(example, 65, seed=9)
    np.testing.assert_array_equal(first, again)
    assert abs(first - other).max() > 50


def test_an_example_smaller_than_a_piece_is_a_sentence():
    small = Elevation(np.zeros((20, 30), np.float32), "small.npy", (METRES, METRES), path=Path("small.npy"))
    with pytest.raises(DataError, match=r"has 30 x 20 texels .* pieces of 48 need 50 at least"):
        made(small)
    flat = Elevation(np.zeros((80, 80), np.float32), "flat.npy", (METRES, METRES))
    assert not made(flat, 65, lines(65)).any()


def test_it_can_be_stopped_between_any_two_of_its_heavy_steps(example, monkeypatch):
    order, running = [], []
    for name in ("oriented", "_features", "Candidates", "features_of", "quilted", "smoothed", "integrated"):
        act = getattr(by_example, name)

        def noted(*arguments, _name=name, _act=act, **more):
            if not running:  # what one of them calls is not a step of its own
                order.append(_name)
            running.append(_name)
            try:
                return _act(*arguments, **more)
            finally:
                running.pop()

        monkeypatch.setattr(by_example, name, noted)
    SOURCES.clear()
    guide = lines(65)
    made_like(
        example,
        example.spacing,
        (65, 65),
        (METRES, METRES),
        FIFTY_CANDIDATES,
        guide,
        lambda *at: order.append("report"),
    )
    order = [name for name in order if name != "_features"]  # cached, so no step of its own
    heavy = ["oriented", "Candidates", "features_of", "quilted", "smoothed", "integrated"]
    assert [name for name in dict.fromkeys(order) if name != "report"] == heavy
    for name in heavy:
        around = order[order.index(name) - 1], order[order.index(name) + 1]
        assert around[name == "quilted"] == "report", f"before {name}; a quilt does so by itself"
    assert order[-1] == "report", "and after the last"


def test_it_reports_how_far_it_is_and_can_be_stopped(example):
    seen = []
    made_like(
        example,
        example.spacing,
        (65, 65),
        (METRES, METRES),
        FIFTY_CANDIDATES,
        report=lambda *at: seen.append(at),
    )
    assert len(seen) >= 5 and all(0 <= done < total for done, total in seen)
    assert [done for done, _ in seen] == sorted(done for done, _ in seen)

    class Stop(Exception):
        pass

    def stop(done, wanted):
        raise Stop

    with pytest.raises(Stop):
        made_like(example, example.spacing, (65, 65), (METRES, METRES), FIFTY_CANDIDATES, report=stop)


def slow_order(strength):
    """Yield the places by the rule itself: each time all that wait are looked at."""
    weak, sides = by_example.WEAK, ((0, -1), (0, 1), (-1, 0), (1, 0))
    waiting = set(product(*map(range, strength.shape)))
    border = set()

    def rank(place):
        beside = sum((place[0] + dj, place[1] + di) not in waiting for dj, di in sides)
        strong = float(strength[place]) if strength[place] > weak else 0.0
        return strong, beside, (-place[0], -place[1])

    while waiting:
        strong = [position for position in border if strength[position] > weak]
        if not strong and any(strength[position] > weak for position in waiting):
            position = max(waiting, key=rank)
        else:
            position = max(strong or border or waiting, key=rank)
        waiting.remove(position)
        border.discard(position)
        border |= {(position[0] + dj, position[1] + di) for dj, di in sides} & waiting
        yield position


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (7, 1), (12, 17)])
@pytest.mark.parametrize("share", [0.0, 0.1, 0.6, 1.0])
def test_pieces_are_laid_in_the_order_of_the_rule(shape, share):
    rng = np.random.default_rng(8)
    strength = np.where(rng.random(shape) < share, rng.integers(1, 6, shape) / 4.0, 0.1)
    assert list(by_example.filling_order(strength)) == list(slow_order(strength))


def calls(order, strength):
    """Return how many calls an order of all places makes."""
    count = 0

    def note(frame, event, given):
        nonlocal count
        count += event in ("call", "c_call")

    sys.setprofile(note)
    try:
        assert len(list(order(strength))) == strength.size
    finally:
        sys.setprofile(None)
    return count


@pytest.mark.parametrize("height", [0.1, 1.0])
def test_order_cost_of_pieces_is_near_linear_in_their_count(height):
    few, many = np.full((12, 12), height), np.full((24, 24), height)
    assert calls(by_example.filling_order, many) < 5 * calls(by_example.filling_order, few)


# ── the source ───────────────────────────────────────────────────────────────


def values(file: Path, **more: float) -> dict[str, object]:
    usual = {"texel": 0.0, "rise": 0.0, "piece": 3840.0, "candidates": 60, "follow": 0.5, "seed": 1}
    return {"elevation": str(file), **usual, **more}


def test_the_file_says_the_relief_and_heights_are_in_it():
    terrain = file_sources.describe_example(values(JACKSBORO))
    assert (terrain.relief, terrain.base_elevation, terrain.size) == (840.0, 236.0, None)
    for relief in (840.0, 420.0):
        material = Material({}, (METRES, METRES), relief)
        result = relief * file_sources.make_from_example(values(JACKSBORO), (65, 65), material)["height"]
        assert result.min() == 0 and 300 < result.max() < 1200, "metres are metres"
    assert file_sources.example_notes(values(JACKSBORO)) == ()


def test_a_file_without_metres_is_told_them(tmp_path):
    hills = gaussian_filter(np.random.default_rng(2).normal(size=(90, 70)), 4)
    file = tmp_path / "hills.tif"  # a picture, whose greys have no unit
    tifffile.imwrite(file, (65535 * (hills - hills.min()) / np.ptp(hills)).astype(np.uint16))
    assert file_sources.describe_example(values(file)).relief is None
    assert file_sources.describe_example(values(file, rise=300.0)).relief == 300.0
    assert "it does not say how large it is" in file_sources.example_notes(values(file))[0]
    assert file_sources.example_notes(values(file, texel=30.0)) == ()
    for rise, expected in ((0.0, 1.0), (300.0, 0.3)):  # of a relief of 1000 m
        material = Material({}, (METRES, METRES), 1000.0)
        made = file_sources.make_from_example(values(file, rise=rise, piece=1600.0), (65, 65), material)[
            "height"
        ]
        assert 0.4 * expected < made.max() < 1.6 * expected


def test_of_a_large_file_no_more_is_read_than_an_example_needs(tmp_path):
    file = tmp_path / "large.npy"
    np.save(file, np.add.outer(np.zeros(20), np.arange(4097)).astype(np.float32))
    assert (
        "its 4097 x 20 texels are read as 2049 x " in file_sources.example_notes(values(file, texel=10.0))[0]
    )
    example, coarser = file_sources.example_of(values(file))
    assert (example.size[0], coarser) == (2049, 2.0)


# ── Ranks and sorted heights against SciPy's ─────────────────────────────────


def test_normal_deviates_are_scipy_s():
    shares = np.concatenate([np.geomspace(1e-9, 0.5, 4000), 1 - np.geomspace(1e-9, 0.5, 4000)])
    np.testing.assert_allclose(normal_deviate(shares), ndtri(shares), atol=1e-8)


def test_ranks_become_normal_and_heights_are_sorted():
    heights = RNG.permutation(13 * 17).reshape(13, 17).astype(np.float32)
    arrays = rank_heights({"widest": 0.0}, (17, 13), Material({"example": heights}))
    np.testing.assert_array_equal(arrays["sorted"].ravel(), np.sort(heights, axis=None))
    heights = heights.astype(np.float64)  # SciPy 1.18 gives ranks in the dtype of what is ranked
    shares = (rankdata(heights) - 0.5) / heights.size
    np.testing.assert_allclose(arrays["normal"], ndtri(shares).reshape(13, 17), atol=1e-6)


def test_what_is_too_wide_is_left_out():
    heights = RNG.normal(size=(60, 80)).astype(np.float32)
    arrays = rank_heights({"widest": 0.2}, (80, 60), Material({"example": heights[..., None]}))
    expected = heights - gaussian_filter(heights.astype(np.float64), 4.0, mode="reflect", truncate=9)
    np.testing.assert_allclose(arrays["sorted"].ravel(), np.sort(expected, axis=None), atol=1e-5)


@pytest.mark.parametrize("value", [{}, {"example": np.full((1, 1), 3.0, np.float32)}], ids=["none", "texel"])
def test_no_example_is_flat(value):
    assert not rank_heights({"widest": 0.1}, (4, 3), Material(value))["sorted"].any()


def test_numbers_that_are_none_count_as_0():
    heights = np.array([[1, np.nan], [np.inf, -np.inf]], np.float32)
    arrays = rank_heights({"widest": 0.0}, (2, 2), Material({"example": heights}))
    np.testing.assert_array_equal(arrays["sorted"].ravel(), [0, 0, 0, 1])


def test_it_says_how_far_it_is_and_stops_where_it_is_told_to():
    heights, seen = RNG.normal(size=(20, 30)).astype(np.float32), []
    material = Material({"example": heights}, report=lambda *at: seen.append(at))
    rank_heights({"widest": 0.2}, (80, 60), material)
    assert seen == [(done, len(seen)) for done in range(len(seen))] and len(seen) >= 4

    class Stop(Exception):
        pass

    for last in range(len(seen)):

        def stop(done, wanted, last=last):
            if done == last:
                raise Stop

        with pytest.raises(Stop):
            rank_heights({"widest": 0.2}, (80, 60), Material({"example": heights}, report=stop))
