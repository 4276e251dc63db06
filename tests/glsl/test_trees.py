"""Trees by their counts against a density's integral, as sets, and by what changes along a flight."""

from dataclasses import replace

import numpy as np
import pytest

from ..sketch_texts import passes

SLOPE = """
#include "maths/land.glsl"
#pragma kernel(output = "height:r32f, density:r32f")
uniform float most = 0.8;  //! slider(0, 1)
void kernel(ivec2 texel, out float height, out float density) {
    vec2 share = share_of_texel(texel, size);
    height = 0.2 + 0.5 * share.x;
    density = most * share.x * (1.0 - 0.7 * share.y);
}
"""
PASSES = (
    passes(
        ground="./ground",
        trees=(
            "trees/place",
            'inputs = {{ height = "ground:height", density = "ground:density" }}',
            "set = {{ {values} }}",
        ),
    )
    + """[view]
use = "view/terrain"
camera = {{ azimuth = {azimuth}, elevation = 20.0, distance = 300.0, target = [{x}, {y}, 50.0] }}
"""
)
EXTENT = (2600.0, 1500.0)  # of 53 x 41 texels: unequal spacing
EVERY = "all_round = true, whole = 10000, reach = 4000, trees = 200000"
CELL = 9.0


def placed(make_sketch, values=EVERY, azimuth=200.0, at=(1300.0, 700.0)):
    body = PASSES.format(values=values, azimuth=azimuth, x=at[0], y=at[1])
    return make_sketch(body, size=[53, 41], extent=list(EXTENT), relief=120.0, ground=SLOPE)


def table(engine, sketch, **options):
    """Return the trees of the table that are drawn, (n, 4), and their keys."""
    tree = engine.read(sketch, "trees.cells:tree", **options).reshape(-1, 4).copy()
    key = engine.read(sketch, "trees.cells:key", **options)[..., 0].ravel()
    return tree[key < 1], key[key < 1]


def listed(engine, sketch, **options):
    tree = engine.read(sketch, "trees:tree", **options).reshape(-1, 4).copy()
    total = int(engine.read(sketch, "trees:total", **options).ravel()[0])
    assert (tree[total:] == 0).all()
    return tree[:total]


def rows(tree):
    return set(map(tuple, tree.tolist()))


def expected(kept=lambda x, y: 1.0):
    """Return mean and variance of the number of trees: sums over cells much smaller than theirs."""
    x, y = ((np.arange(n) + 0.5) / n for n in (2600, 1500))
    share = 0.8 * x * (1 - 0.7 * y[:, None]) * kept(x * EXTENT[0], y[:, None] * EXTENT[1])
    each = EXTENT[0] * EXTENT[1] / share.size / CELL**2
    return share.sum() * each, (share * (1 - share)).sum() * each


@pytest.mark.parametrize("seed", [3, 4])
def test_there_are_as_many_as_the_density_says(kept, ctx, make_sketch, seed):
    sketch = placed(make_sketch, f"{EVERY}, seed = {seed}")
    tree, key = table(kept, sketch)
    mean, variance = expected()
    assert abs(len(tree) - mean) < 4 * np.sqrt(variance)
    assert tree[:, 3].min() >= 0.55 * 21 - 1e-3 and tree[:, 3].max() <= 21 + 1e-3
    np.testing.assert_allclose(tree[:, 2], 120 * (0.2 + 0.5 * tree[:, 0] / EXTENT[0]), atol=2e-3)
    # The western half of one row of cells has its own share: where they stand follows the density.
    west = tree[:, 0] < EXTENT[0] / 2
    assert abs(west.mean() - 0.25) < 4 * np.sqrt(0.25 * 0.75 / len(tree))
    assert abs(np.corrcoef(key, tree[:, 0])[0, 1]) < 4 / np.sqrt(len(tree)), "ranks know nothing of the place"


@pytest.mark.parametrize("level", [-10.0, 40.0, 61.5])
def test_none_stands_in_water_and_all_others_stay(kept, ctx, make_sketch, level):
    """The ground is 24 to 84 m high; rocks and tufts are placed by the same pass."""
    sea = '[[pass]]\nname = "sea"\nuse = "water/sea"\nsize = 1\nset = {{ sea_level = {level} }}\n'
    wired = PASSES.replace('"ground:density" }}', '"ground:density", water = "sea" }}')
    body = (sea + wired).format(level=level, values=EVERY, azimuth=200.0, x=1300.0, y=700.0)
    sketch = make_sketch(body, size=[53, 41], extent=list(EXTENT), relief=120.0, ground=SLOPE)
    every = table(kept, placed(make_sketch))[0]
    dry = rows(every[every[:, 2] > level])
    assert len(dry) > 1000
    assert rows(table(kept, sketch)[0]) == dry


@pytest.mark.slow
def test_farther_away_fewer_are_kept_by_a_known_share(kept, ctx, make_sketch):
    sketch = placed(make_sketch, "all_round = true, whole = 150, reach = 1200, trees = 200000")
    tree, key = table(kept, sketch)
    eye = np.array(kept.plan(sketch, (640, 360)).eye.position)

    def share(x, y):
        away = np.sqrt(
            (x - eye[0]) ** 2 + (y - eye[1]) ** 2 + (120 * (0.2 + 0.5 * x / EXTENT[0]) - eye[2]) ** 2
        )
        end = np.clip((away - 0.9 * 1200) / 120, 0, 1)
        # Whole up to this rank, then smaller up to a quarter more.
        return np.minimum(1.25 * np.minimum(150 / away, 1) ** 2 * (1 - end * end * (3 - 2 * end)), 1)

    mean, variance = expected(share)
    assert abs(len(tree) - mean) < 4 * np.sqrt(variance)
    assert abs(key.mean() - 0.5) < 4 / np.sqrt(12 * len(key)), "keys are uniform"


def test_a_tree_stays_where_it_is_when_the_eye_moves(kept, ctx, make_sketch):
    near = "all_round = true, whole = 5000, reach = 700, trees = 200000"
    moves = [dict(at=(1300.0, 700.0)), dict(at=(1553.0, 711.0)), dict(at=(1300.0, 700.0), azimuth=77.0)]
    tables = [table(kept, placed(make_sketch, near, **move)) for move in moves]
    eyes = [kept.plan(placed(make_sketch, near, **m), (640, 360)).eye.position for m in moves]
    for (tree, _), eye in zip(tables[1:], eyes[1:], strict=True):
        first = tables[0][0]
        # Where both see all trees, both have the same.
        both = [
            rows(
                t[
                    (np.hypot(t[:, 0] - eyes[0][0], t[:, 1] - eyes[0][1]) < 550)
                    & (np.hypot(t[:, 0] - eye[0], t[:, 1] - eye[1]) < 550)
                ]
            )
            for t in (first, tree)
        ]
        assert len(both[0]) > 500 and both[0] == both[1]


def test_what_the_picture_shows_does_not_depend_on_its_size(kept, ctx, make_sketch):
    values = "whole = 5000, reach = 900, trees = 200000, margin = {}"
    sketch = placed(make_sketch, values.format(30))
    small = listed(kept, sketch, size=(160, 90))
    large = listed(kept, sketch, size=(640, 360))
    np.testing.assert_array_equal(small, large)
    every = table(kept, placed(make_sketch, values.format(30) + ", all_round = true"))[0]
    assert len(small) < 0.5 * len(every) and rows(table(kept, sketch)[0]) <= rows(every)
    # Nobody who is in the picture is left out.
    clip = np.c_[every[:, :3], np.ones(len(every))] @ kept.plan(sketch, (640, 360)).eye.clip_from_world.T
    shown = (np.abs(clip[:, :2]) < clip[:, 3:]).all(1)
    assert rows(every[shown]) <= rows(table(kept, sketch)[0]) and shown.sum() > 100


def test_the_list_is_the_table(kept, ctx, make_sketch):
    sketch = placed(make_sketch)
    tree, _ = table(kept, sketch)
    result = listed(kept, sketch)
    assert rows(result[:, :3]) == rows(tree[:, :3]) and len(result) == len(tree)
    order = [np.lexsort(t[:, :2].T) for t in (result, tree)]
    # Where all are kept, all are as tall as they are.
    np.testing.assert_array_equal(result[order[0], 3], tree[order[1], 3])
    assert result[:, 3].min() >= 0.55 * 21 - 1e-3


def test_where_there_are_too_many_fewer_are_kept_everywhere(kept, ctx, make_sketch):
    whole = listed(kept, placed(make_sketch))
    budget = 4096
    result = listed(kept, placed(make_sketch, EVERY.replace("200000", str(budget))))
    assert 0.85 * budget < len(result) <= budget < len(whole)
    assert rows(result[:, :3]) <= rows(whole[:, :3])
    share = len(result) / len(whole)
    for axis in (0, 1):  # as large a fraction of every strip, to the last
        bins = np.linspace(0, EXTENT[axis], 9)
        counts, of = np.histogram(result[:, axis], bins)[0], np.histogram(whole[:, axis], bins)[0]
        assert (np.abs(counts - share * of) < 4 * np.sqrt(share * of)).all()
    limit = kept.read(placed(make_sketch, EVERY.replace("200000", str(budget))), "trees:limit")[0, 0]
    assert result[:, 3].max() <= 21 * limit**-0.4 + 1e-3


@pytest.mark.parametrize("limit", [0.4, 0.9, 1.0])
def test_what_is_drawn_covers_as_much_as_is_said(on_gpu, limit):
    """Over many ranks: the mean of the squared sizes of those that are drawn."""
    rank = (np.arange(100_000) + 0.5) / 100_000
    for kept in (1.0, 0.95, 0.85, 0.5, 0.01):
        key = rank / min(1.25 * kept, 1.0)
        key = key[key < limit].astype(np.float32)
        sizes = on_gpu("trees/level.glsl", f"shrunk(key, drawn_part({kept}), {limit})", key=key)
        truth = (sizes.astype(np.float64) ** 2).sum() / len(rank)
        result = on_gpu("trees/level.glsl", "covering_share(k, l)", k=[kept], l=[limit])[0]
        assert result == pytest.approx(truth, rel=0.03), kept
        assert (sizes == 1).all() == (kept == limit == 1), "all are whole where all are kept"


PLANE = """
#pragma kernel(output = "height:r32f, a_wetness:r32f, a_weights:rgba8, a_painted:r32f, a_paths:r32f")
uniform float slope = 0.5;  //! slider(0, 4)
void kernel(ivec2 at, out float height, out float a_wetness, out vec4 a_weights, out float a_painted,
            out float a_paths) {
    height = 0.01 * slope * float(at.x);  // 100 m relief, spacing 1 m
    a_wetness = float(at.y) / 32.0;
    a_weights = vec4(0.25, 0.75, 0.0, 0.0);
    a_painted = at.y == 3 ? 0.5 : 1.0;
    a_paths = at.x == 20 ? 1.0 : 0.0;
}
"""
DENSITY = passes(
    ground=("./plane", "set = {{ slope = {slope} }}"),
    density=("trees/density", 'inputs = {{ height = "ground:height"{wired} }}', "set = {{ {values} }}"),
)


@pytest.mark.parametrize(
    "slope, wired, values, target",
    [
        (0.5, "", "maximum = 0.5", lambda x, y: 0.5 + 0 * x),
        (0.875, "", "", lambda x, y: 0.5 + 0 * x),  # halfway through the steep ones
        (2.0, "", "", lambda x, y: 0 * x),
        (
            1.0,
            "",
            "steep = [4, 5], lowest = 10, band = 8",
            lambda x, y: np.where(x < 10, 0.0, np.where(x > 18, 1, np.nan)),
        ),
        (
            1.0,
            "",
            "steep = [4, 5], highest = 20, band = 8",
            lambda x, y: np.where(x > 20, 0.0, np.where(x < 12, 1, np.nan)),
        ),
        (0.0, "wetness", "wet = 1", lambda x, y: y / 32),
        (0.0, "wetness", "wet = -0.5", lambda x, y: 1 - 0.5 * y / 32),
        (0.0, "weights", "bears = [1, 0.2, 0, 0]", lambda x, y: 0.25 + 0.15 + 0 * x),
        (0.0, "painted", "", lambda x, y: np.where(y == 3, 0.5, 1)),
        (0.0, "paths", "", lambda x, y: np.where(x == 20, 0.0, 1)),
    ],
)
def test_each_reason_for_fewer_trees_is_a_factor(kept, ctx, make_sketch, slope, wired, values, target):
    wires = f', {wired} = "ground:a_{wired}"' if wired else ""
    text = DENSITY.format(slope=slope, wired=wires, values=values)
    density = kept.read(make_sketch(text, size=33, extent=32.0, relief=100.0, plane=PLANE), "density")
    y, x = np.mgrid[:33, :33].astype(float)
    truth = target(x, y)
    existing = np.isfinite(truth) & (x > 0) & (x < 32)
    np.testing.assert_allclose(
        density[existing], truth[existing], atol=4e-3
    )  # weights of 8 bits, half floats


def test_clearings_take_their_share_of_the_ground(kept, ctx, make_sketch):
    for share in (0.2, 0.5, 0.7):
        text = DENSITY.format(slope=0.0, wired="", values=f"clearings = {share}, clearing = 10")
        result = kept.read(make_sketch(text, size=257, extent=640.0, relief=100.0, plane=PLANE), "density")
        assert abs(1 - result.mean() - share) < 0.1


@pytest.mark.slow
def test_nothing_pops_as_the_eye_comes_nearer(kept, ctx, make_sketch):
    """A hundredth nearer each step: no tree jumps, and those of one place cover as much."""
    sketch = placed(make_sketch, "all_round = true, whole = 200, reach = 1200, trees = 200000")
    for distance, nearer in ((1160.0, 0.999), (950.0, 0.99), (600.0, 0.99), (250.0, 0.99)):
        result = []
        for step in (1.0, nearer):
            tree = listed(kept, sketch.with_camera(replace(sketch.camera, distance=distance * step)))
            near = tree[np.hypot(tree[:, 0] - 1300, tree[:, 1] - 700) < 120]
            result.append({(x, y): h for x, y, _, h in near.tolist()})
        first, other = result
        areas = [sum(h * h for h in tall.values()) for tall in result]
        assert abs(areas[1] / areas[0] - 1) < 0.02 or distance > 0.9 * 1200 - 120
        jumps = [abs(first.get(at, 0.0) - other.get(at, 0.0)) for at in first.keys() | other.keys()]
        # The share that is kept changes by twice a step, so a key by no more, and a height by five of these.
        # In the last tenth of the reach all shrink to nothing, evenly with the distance.
        end = (distance + 120) * (1 - nearer) / (0.1 * 1200) if distance > 0.9 * 1200 - 120 else 0.0
        assert max(jumps) / max(*first.values(), *other.values()) < 1.2 * (10.0 * (1 - nearer) + end), (
            distance
        )
