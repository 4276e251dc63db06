"""Triangulations against SciPy's, against circles in exact fractions, and against their own steps."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import Delaunay

from playground.data import delaunay
from playground.data.delaunay import (
    MAX_POINTS,
    MAX_PROPORTION,
    SIDE,
    Rules,
    Triangulation,
    tables,
    triangulate,
)
from playground.errors import DataError

WAYS = [Rules(), Rules(random_weights=True, seed=1), Rules(random_weights=True, seed=2, proportion=0.3)]


def sets(triangles):
    """Return triangles as a set of sets of points."""
    result = {frozenset(t) for t in np.asarray(triangles).tolist()}
    assert len(result) == len(triangles), "no triangle occurs twice"
    return result


def circle(made: Triangulation, triangle) -> tuple[Fraction, Fraction, Fraction]:
    """Return middle and squared radius, exactly: where the perpendiculars on two edges' middles meet."""
    (ax, ay), (bx, by), (cx, cy) = ([Fraction(int(n)) for n in made.places[p]] for p in triangle)
    m1, m2 = ((ax + bx) / 2, (ay + by) / 2), ((ax + cx) / 2, (ay + cy) / 2)
    # m1 + s (by - ay, ax - bx) = m2 + t (cy - ay, ax - cx)
    d1, d2 = (by - ay, ax - bx), (cy - ay, ax - cx)
    s = ((m2[0] - m1[0]) * d2[1] - (m2[1] - m1[1]) * d2[0]) / (d1[0] * d2[1] - d1[1] * d2[0])
    x, y = m1[0] + s * d1[0], m1[1] + s * d1[1]
    return x, y, (ax - x) ** 2 + (ay - y) ** 2


def depth(made: Triangulation, triangle, point) -> Fraction:
    """Return how deep inside a triangle's circle a point lies: above 0 inside, 0 on it."""
    x, y, square = circle(made, triangle)
    px, py = (int(n) for n in made.places[point])
    return square - (px - x) ** 2 - (py - y) ** 2


def twice_areas(made: Triangulation) -> list[int]:
    """Return twice the triangles' areas by the shoelace formula, above 0 where counter-clockwise."""
    numbers = []
    for triangle in made.triangles.tolist():
        corners = [tuple(map(int, made.places[p])) for p in triangle]
        turned = zip(corners, corners[1:] + corners[:1], strict=True)
        numbers.append(sum(px * qy - qx * py for (px, py), (qx, qy) in turned))
    return numbers


@pytest.mark.parametrize("points", [1, 2, 3, 7, 60, 500, 3000])
@pytest.mark.parametrize("rules", WAYS, ids=["equal", "random", "wide"])
def test_both_methods_are_scipy_s_triangulation(rules, points):
    by_hole = triangulate(replace(rules, points=points))
    by_flips = triangulate(replace(rules, points=points, by_flips=True))
    assert sets(by_hole.triangles) == sets(Delaunay(by_hole.places.astype(np.float64)).simplices)
    for name in ("places", "heights", "triangles", "neighbours"):
        np.testing.assert_array_equal(getattr(by_flips, name), getattr(by_hole, name), name)
    assert by_flips.replaced == by_hole.replaced
    assert sets(by_flips.destroyed) == sets(by_hole.destroyed)


@pytest.mark.parametrize("seed", range(20))
def test_many_seeds_by_both_methods(seed):
    rules = Rules(points=40 + 10 * seed, random_weights=True, seed=seed, proportion=1.0 + seed / 10)
    made = [triangulate(replace(rules, by_flips=by_flips)).triangles for by_flips in (False, True)]
    np.testing.assert_array_equal(*made)
    assert sets(made[0]) == sets(Delaunay(triangulate(rules).places.astype(np.float64)).simplices)


@pytest.mark.parametrize("by_flips", [False, True])
@pytest.mark.parametrize("rules", WAYS, ids=["equal", "random", "wide"])
def test_every_circle_is_empty(rules, by_flips):
    made = triangulate(replace(rules, points=40, by_flips=by_flips))
    for triangle in made.triangles.tolist():
        others = set(range(len(made.places))) - set(triangle)
        assert all(depth(made, triangle, point) <= 0 for point in others)


@pytest.mark.slow
def test_circumcircles_contain_no_vertex_of_adjacent_triangles():
    """Where no neighbour's corner lies in a circle, no point at all does (Delaunay's lemma)."""
    made = triangulate(Rules(points=1500, random_weights=True))
    for triangle, neighbours in zip(made.triangles.tolist(), made.neighbours.tolist(), strict=True):
        for other in neighbours:
            if other >= 0:
                (point,) = set(made.triangles[other].tolist()) - set(triangle)
                assert depth(made, triangle, point) <= 0


def test_without_a_point_there_is_a_tie():
    """Four corners lie on one circle: either diagonal is legal."""
    for by_flips in (False, True):
        made = triangulate(Rules(points=0, by_flips=by_flips))
        assert sets(made.triangles) == {frozenset({0, 1, 2}), frozenset({1, 2, 3})}
        assert [depth(made, t, 6 - sum(t)) for t in made.triangles.tolist()] == [0, 0]
        assert (len(made.destroyed), made.replaced) == (0, 0)


def test_ties_are_left_alike_by_both_methods(monkeypatch):
    """With points on the nodes of a coarse grid alone, many are on others' circles, exactly."""
    step = SIDE // 8

    def on_the_grid(growing, triangle, point):
        a, b, c = growing.triple(triangle)
        x, y = np.meshgrid(np.arange(1, 8) * step, np.arange(1, 8) * step)
        inside = np.ones(x.shape, bool)
        for p, q in ((a, b), (b, c), (c, a)):
            px, py = growing.x[p], growing.y[p]
            inside &= (growing.x[q] - px) * (y - py) > (growing.y[q] - py) * (x - px)
        result = np.argwhere(inside)
        j, i = result[delaunay.hash3(point, 2, growing.rules.seed)[0] % len(result)]
        return int(x[j, i]), int(y[j, i])

    monkeypatch.setattr(delaunay.Growing, "barycentre", on_the_grid)
    points, ties = 9, 0
    for seed in range(20):
        made = [
            triangulate.__wrapped__(Rules(points=points, seed=seed, by_flips=by_flips))  # not cached
            for by_flips in (False, True)
        ]
        np.testing.assert_array_equal(made[0].triangles, made[1].triangles)
        assert sum(twice_areas(made[0])) == 2 * SIDE**2 and min(twice_areas(made[0])) > 0
        for triangle in made[0].triangles.tolist():
            for point in set(range(points + 4)) - set(triangle):
                fraction = depth(made[0], triangle, point)
                assert fraction <= 0
                ties += fraction == 0
        for item in made:
            assert min(depth(item, t, points + 3) for t in item.destroyed.tolist()) > 0, "not those it is on"
    assert ties > 20


@pytest.mark.parametrize("rules", WAYS, ids=["equal", "random", "wide"])
@pytest.mark.parametrize("points", [0, 1, 60, 2000])
def test_areas_sum_to_the_terrain_and_none_is_turned(rules, points):
    made = triangulate(replace(rules, points=points))
    areas = twice_areas(made)
    assert len(areas) == 2 * points + 2
    assert sum(areas) == 2 * made.sides[0] * made.sides[1]
    assert min(areas) > 0
    assert areas == sorted(areas, reverse=True), "the list begins with the greatest, as the thesis keeps it"


@pytest.mark.parametrize("points", [0, 1, 2, 300])
def test_neighbours_share_an_edge_and_know_each_other(points):
    made = triangulate(Rules(points=points, by_flips=True))
    outside = 0
    for t, (triangle, neighbours) in enumerate(
        zip(made.triangles.tolist(), made.neighbours.tolist(), strict=True)
    ):
        assert triangle[0] == min(triangle)
        for corner, other in zip(triangle, neighbours, strict=True):
            edge = set(triangle) - {corner}
            if other < 0:
                outside += 1
                assert edge in ({0, 1}, {1, 3}, {2, 3}, {0, 2}), "an edge of the border"
                continue
            assert edge == set(triangle) & set(made.triangles[other].tolist())
            assert t in made.neighbours[other]
    assert outside == 4


@pytest.mark.parametrize("rules", WAYS, ids=["equal", "random", "wide"])
def test_each_point_is_in_the_greatest_triangle_before_it(rules):
    for points in range(25):
        before, after = (triangulate(replace(rules, points=n)) for n in (points, points + 1))
        np.testing.assert_array_equal(after.places[:-1], before.places)
        np.testing.assert_array_equal(after.heights[:-1], before.heights)
        areas = twice_areas(before)
        elements = np.array([*after.places[-1].tolist(), 1], object)
        fell = after.destroyed[0].tolist()
        (which,) = (t for t, c in enumerate(before.triangles.tolist()) if set(c) == set(fell))
        assert areas[which] == max(areas)
        corners = before.places[before.triangles[which]].astype(np.float64)
        shares = np.linalg.solve(np.vstack([corners.T, np.ones(3)]), elements.astype(np.float64))
        if rules.random_weights:
            assert shares.min() > 64 / 702 - 1e-6
        else:
            np.testing.assert_allclose(shares, 1 / 3, atol=1e-6)


def test_random_weights_differ():
    first = triangulate(Rules(points=1, random_weights=True)).places[-1]
    assert not np.array_equal(first, triangulate(Rules(points=1)).places[-1])
    assert not np.array_equal(first, triangulate(Rules(points=1, random_weights=True, seed=8)).places[-1])


@pytest.mark.parametrize("by_flips", [False, True])
def test_destroyed_triangles_have_new_point_in_circumcircle(by_flips):
    rules = Rules(random_weights=True, by_flips=by_flips)
    most = 0
    for points in range(1, 40):
        before, after = (triangulate(replace(rules, points=n)) for n in (points - 1, points))
        newest = points + 3
        inside = replace_places(before, after)
        held = {frozenset(t) for t in before.triangles.tolist() if depth(inside, t, newest) > 0}
        assert sets(after.destroyed) == held == sets(before.triangles) - sets(after.triangles)
        assert after.replaced == len(held) - 1
        most = max(most, len(held))
        gone, there = edges(before) - edges(after), edges(after)
        assert {frozenset(row[:2]) for row in after.destroyed[1:].tolist()} == gone
        assert all(frozenset({newest, row[2]}) in there for row in after.destroyed.tolist())
    assert most >= 4, "some point destroys several"


def replace_places(made: Triangulation, later: Triangulation) -> Triangulation:
    return replace(made, places=later.places)


def edges(made: Triangulation) -> set[frozenset[int]]:
    return {frozenset({t[i], t[i - 1]}) for t in made.triangles.tolist() for i in range(3)}


def test_the_last_insertion_may_stop_between_flips():
    rules = Rules(points=13, seed=104, random_weights=True, by_flips=True, proportion=0.5625)
    whole = triangulate(rules)
    assert whole.replaced >= 3
    stages = [triangulate(replace(rules, flips=n)) for n in range(whole.replaced + 1)]
    np.testing.assert_array_equal(stages[-1].triangles, whole.triangles)
    for n, (before, after) in enumerate(pairwise(stages)):
        assert before.replaced == n and len(before.destroyed) == n + 2, "those made, and the one to come"
        u, v, w = before.destroyed[-1].tolist()
        assert edges(before) - edges(after) == {frozenset({u, v})}
        assert edges(after) - edges(before) == {frozenset({16, w})}
        assert depth(before, (u, v, w), 16) > 0, "it was illegal"
        assert sum(twice_areas(before)) == sum(twice_areas(whole))
    # Only the last insertion stops: the steps before it are whole.
    assert triangulate(replace(rules, points=14, flips=0)).places.tolist()[:-1] == whole.places.tolist()


@pytest.mark.parametrize("roughness", [0.5, 1.0, 2.0])
def test_displaced_heights_stay_near_their_triangle(roughness):
    rules = Rules(random_weights=True, displaced=True, roughness=roughness, corners=(0.0, 0.2, 0.9, 0.4))
    shares = []
    for points in range(1, 40):
        before, after = (triangulate(replace(rules, points=n)) for n in (points - 1, points))
        plane = LinearNDInterpolator(before.places[after.destroyed[0]], before.heights[after.destroyed[0]])
        reach = (max(twice_areas(before)) / (2 * SIDE**2)) ** 0.5
        shares.append((after.heights[-1] - plane(after.places[-1:])[0]) / reach**roughness)
    assert -1 <= min(shares) < -0.5 and 0.5 < max(shares) <= 1


def test_random_heights_are_spread_over_0_to_1():
    heights = triangulate(Rules(points=2000, corners=(0.1, 0.2, 0.3, 0.4))).heights
    assert heights[:4].tolist() == [0.1, 0.2, 0.3, 0.4]
    counts = np.histogram(heights[4:], bins=10, range=(0, 1))[0]
    assert heights.min() >= 0 and heights.max() < 1
    assert counts.min() > 200 - 4 * 200**0.5 and counts.max() < 200 + 4 * 200**0.5


def test_the_same_rules_make_the_same_and_another_seed_does_not():
    rules = Rules(points=100, random_weights=True)
    first, second = triangulate.__wrapped__(rules), triangulate.__wrapped__(rules)
    np.testing.assert_array_equal(first.triangles, second.triangles)
    np.testing.assert_array_equal(first.heights, second.heights)
    assert not np.array_equal(first.places, triangulate(replace(rules, seed=8)).places)
    assert not np.array_equal(first.heights, triangulate(replace(rules, seed=8)).heights)


@pytest.mark.parametrize("proportion", [1.0, 0.3, 3.0, 1 / MAX_PROPORTION, MAX_PROPORTION])
def test_sides_are_as_given_and_lattice_numbers_are_floats(proportion):
    made = triangulate(Rules(points=20, proportion=proportion))
    assert max(made.sides) == SIDE and min(made.sides) % 4096 == 0
    assert made.sides[1] / made.sides[0] == pytest.approx(proportion, rel=1e-3)
    np.testing.assert_array_equal(made.places.astype(np.float32), made.places)
    assert made.places[3].tolist() == list(made.sides)


@pytest.mark.slow
@pytest.mark.parametrize("proportion", [1.0, MAX_PROPORTION])
def test_no_point_comes_near_an_edge(proportion):
    """As many as there may be: each stood a lattice spacing and more from the edges of its triangle."""
    made = triangulate(Rules(points=MAX_POINTS, random_weights=True, proportion=proportion))
    corners = made.places[made.triangles].astype(np.int64)
    a, b, c = (corners[:, i] for i in range(3))
    doubled = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    assert doubled.min() > 0 and doubled.sum() == 2 * made.sides[0] * made.sides[1]
    assert doubled.max() < 6 * doubled.mean(), "the greatest is always taken"
    altitude = doubled.max() / np.hypot(*made.sides)
    assert altitude * 64 / 702 > 18


def test_tables_hold_the_entries_row_by_row():
    made = triangulate(Rules(points=9, by_flips=True))
    result = {name: table.reshape(-1, 4) for name, table in tables(made, (4, 6)).items()}
    assert tables(made, (4, 6))["places"].shape == (6, 4, 4)
    np.testing.assert_array_equal(result["places"][:13, :2], made.places)
    np.testing.assert_array_equal(result["places"][:13, 2], made.heights.astype(np.float32))
    np.testing.assert_array_equal(result["triangles"][:20, :3], made.triangles)
    np.testing.assert_array_equal(result["neighbours"][:20, :3], made.neighbours)
    assert result["last"][0].tolist() == [12, len(made.destroyed), made.replaced, 20]
    np.testing.assert_array_equal(result["last"][1 : 1 + len(made.destroyed), :3], made.destroyed)
    assert not result["places"][13:].any() and not result["triangles"][20:].any()


def test_what_cannot_be_made_has_a_sentence():
    with pytest.raises(DataError, match="-1 points to triangulate; 0 to 10000"):
        triangulate(Rules(points=-1))
    with pytest.raises(DataError, match="10001 points"):
        triangulate(Rules(points=MAX_POINTS + 1))
    for proportion in (0.0, 0.1, 9.0, float("nan")):
        with pytest.raises(DataError, match="sides 1 to"):
            triangulate(Rules(proportion=proportion))
    with pytest.raises(DataError, match="20 entries do not fit into 4 x 4 texels; make the pass larger"):
        tables(triangulate(Rules(points=9)), (4, 4))
