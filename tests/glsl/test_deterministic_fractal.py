"""Self-similar sets against all of their pieces, and by counting boxes; the triangle against a recursion."""

import math

import numpy as np
import pytest

from ..sketch_texts import passes, use
from ..truth.noise import pcg3d, salt

FOLDS = "generation/deterministic_fractal/folds.glsl"
ROOT_3 = math.sqrt(3)

# Where each copy's middle stands and what becomes of the two axes, for a set 1 wide in the
# middle of its box; then a piece of it as corners, and the set's menu entry.
THIRDS = (-1 / 3, 0, 1 / 3)
TURN_60 = np.array([[0.5, -ROOT_3 / 2], [ROOT_3 / 2, 0.5]])
SQUARE = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
BASE = (
    -ROOT_3 / 12
)  # the lower side of a box around Koch's curve; a third of the triangle's height below its middle
SETS = {
    "koch_curve": (
        [
            ((-1 / 3, BASE), np.eye(2) / 3),
            ((-1 / 12, BASE + ROOT_3 / 12), TURN_60 / 3),
            ((1 / 12, BASE + ROOT_3 / 12), TURN_60.T / 3),
            ((1 / 3, BASE), np.eye(2) / 3),
        ],
        np.array([[-0.5, BASE], [0.5, BASE]]),
        np.array([0, BASE]),
    ),
    "cantor_dust": (
        [((x, y), np.eye(2) / 3) for x in THIRDS for y in THIRDS if x and y],
        SQUARE,
        np.zeros(2),
    ),
    "vicsek_cross": (
        [((x, y), np.eye(2) / 3) for x in THIRDS for y in THIRDS if not (x and y)],
        SQUARE,
        np.zeros(2),
    ),
    "sierpinski_carpet": (
        [((x, y), np.eye(2) / 3) for x in THIRDS for y in THIRDS if x or y],
        SQUARE,
        np.zeros(2),
    ),
    "sierpinski_triangle": (
        [((x, y), np.eye(2) / 2) for x, y in ((-0.25, -ROOT_3 / 8), (0.25, -ROOT_3 / 8), (0, ROOT_3 / 8))],
        np.array([[-0.5, -ROOT_3 / 4], [0.5, -ROOT_3 / 4], [0, ROOT_3 / 4]]),
        np.zeros(2),
    ),
}
NAMES = [
    "Cantor set",
    "Koch curve",
    "Cantor dust",
    "Vicsek cross",
    "Sierpinski triangle",
    "Sierpinski carpet",
]
COPIES = {"Cantor set": (2, 3), "Koch curve": (4, 3), "Cantor dust": (4, 3), "Vicsek cross": (5, 3),
          "Sierpinski triangle": (3, 2), "Sierpinski carpet": (8, 3)}  # fmt: skip


def pieces(name, depth):
    """Return the corners of every piece after so many turns: each map of the set, applied to all before."""
    maps, piece, origin = SETS[name]
    result = [piece]
    for _ in range(depth):
        result = [np.array(m) + (corners - origin) @ a.T for m, a in maps for corners in result]
    return np.array(result)


def far_from_segment(position, a, b):
    along = np.clip(((position - a) @ (b - a)) / ((b - a) @ (b - a)), 0, 1)
    return np.hypot(*(position - a - along[:, None] * (b - a)).T)


def far_from(position, corners):
    """Return how far places are from a convex piece, 0 inside."""
    ends = list(zip(corners, np.roll(corners, -1, axis=0), strict=True))
    nearest = np.min([far_from_segment(position, a, b) for a, b in ends], axis=0)
    if len(corners) == 2:
        return nearest
    turned = [(b - a)[0] * (position - a)[:, 1] - (b - a)[1] * (position - a)[:, 0] for a, b in ends]
    return np.where(np.min(turned, axis=0) >= 0, 0, nearest)


@pytest.fixture
def places():
    return np.random.default_rng(4).uniform(-0.8, 0.8, (1500, 2))


@pytest.mark.parametrize("name", SETS)
@pytest.mark.parametrize("depth", [0, 1, 2, 3])
def test_distances_are_those_to_the_nearest_piece(on_gpu, places, name, depth):
    result = on_gpu(FOLDS, f"distance_to_set({name.upper()}, place, {depth})", place=places)
    truth = np.min([far_from(places, corners) for corners in pieces(name, depth)], axis=0)
    np.testing.assert_allclose(result, truth, atol=2e-6)


@pytest.mark.parametrize("depth", [0, 1, 2, 4])
def test_the_bars_of_cantor(on_gpu, places, depth):
    result = on_gpu(FOLDS, f"cantor_bars(place, {depth})", place=places)
    bars = [(0, 1)]
    truth = np.full(len(places), np.inf)
    row = 1 / (depth + 1)
    for turn in range(depth + 1):
        middle = 0.5 - (turn + 0.5) * row
        for a, b in bars:
            box = np.array([[a, -0.3 * row], [b, -0.3 * row], [b, 0.3 * row], [a, 0.3 * row]]) - (0.5, 0)
            truth = np.minimum(truth, far_from(places, box + np.array([0, middle])))
        bars = [bar for a, b in bars for bar in ((a, a + (b - a) / 3), (b - (b - a) / 3, b))]
    np.testing.assert_allclose(result, truth, atol=2e-6)


@pytest.fixture
def sketch_of(make_sketch):
    def make(size, technique="deterministic_fractal", **values):
        text = passes(fractal=use(f"generation/{technique}", **values))
        return make_sketch(text, size=size, extent=[float(n) for n in size])

    return make


def boxes(member, side):
    """Return how many boxes of so many pixels hold a member."""
    count = -(-member.shape[0] // side), -(-member.shape[1] // side)
    full = np.zeros((count[0] * side, count[1] * side), bool)
    full[: member.shape[0], : member.shape[1]] = member
    return full.reshape(count[0], side, count[1], side).any(axis=(1, 3)).sum()


@pytest.mark.parametrize("name", NAMES)
def test_the_dimension_by_counting_boxes(any_engine, sketch_of, name):
    """Of what is drawn at 1024 texels, within 0.05 of log n / log(1/r).

    Boxes grow over whole turns, threefold three times or twofold five times: a set with gaps
    is counted by steps, not along a line. Of Cantor's set the last row is counted, along
    which it lies.
    """
    depth, sides = (
        (8, np.geomspace(8, 256, 40)) if name == "Sierpinski triangle" else (6, np.geomspace(6, 162, 40))
    )
    sketch = sketch_of((1024, 1024), fractal=name, depth=depth, margin=0.0, label=False)
    member = any_engine.read(sketch, "fractal:set_distance") < 0.5 / 1024
    if name == "Cantor set":
        member = member[int(0.5 * 1024 / (depth + 1))][None]
    sides = np.unique(np.round(sides).astype(int))
    slope = np.polyfit(np.log(1 / sides), np.log([boxes(member, side) for side in sides]), 1)[0]
    copies, part = COPIES[name]
    assert abs(slope - math.log(copies) / math.log(part)) < 0.05


def read_label(picture):
    """Return the letters of a label's picture, 5 rows of 67, top row first."""
    shapes = {
        "0": "### #.# #.# #.# ###", "1": ".#. ##. .#. .#. ###", "2": "### ..# ### #.. ###",
        "3": "### ..# ### ..# ###", "4": "#.# #.# ### ..# ..#", "5": "### #.. ### ..# ###",
        "6": "### #.. ### #.# ###", "7": "### ..# .#. .#. .#.", "8": "### #.# ### #.# ###",
        "9": "### #.# ### ..# ###", "n": "... ... ##. #.# #.#", "r": "... ... .## #.. #..",
        "D": "##. #.# #.# #.# ##.", "/": "..# ..# .#. #.. #..", ".": "... ... ... ... .#.",
        "=": "... ### ... ### ...", " ": "... ... ... ... ...",
    }  # fmt: skip
    letters = {shape: letter for letter, shape in shapes.items()}
    text = ""
    for column in range(0, 67, 4):
        rows = ["".join(".#"[int(p)] for p in row[column : column + 3]) for row in picture]
        text += letters[" ".join(rows)]
    return text


@pytest.mark.parametrize("name", NAMES)
def test_the_label_says_copies_scale_and_dimension(engine, sketch_of, name):
    copies, part = COPIES[name]
    sketch = sketch_of((210, 180), fractal=name, ink="#000000", paper="#ffffff")
    dark = engine.read(sketch, "fractal:colour")[..., 0] < 0.5
    scale, width = 2, 67 * 2
    low, left = 10, (210 - width) // 2  # twice as high as a label, below it as much as above
    letters = dark[low : low + 5 * scale : scale, left : left + width : scale][::-1]
    dimension = math.log(copies) / math.log(part)
    assert read_label(letters) == f"n={copies} r=1/{part} D={dimension:.3f}"
    assert not dark[:low].any() and not dark[low + 5 * scale : low + 5 * scale + 8].any()


def test_fractals_side_by_side_match_single_ones_by_dimension(engine, sketch_of):
    all_of_them = engine.read(sketch_of((630, 360), depth=3), "fractal:set_distance").copy()
    colours = engine.read(sketch_of((630, 360), depth=3), "fractal:colour").copy()
    dimensions = [math.log(n) / math.log(m) for n, m in COPIES.values()]
    assert dimensions == sorted(dimensions)
    for index, name in enumerate(NAMES):
        row, column = 180 * (1 - index // 3), 210 * (index % 3)
        alone = sketch_of((210, 180), depth=3, fractal=name)
        panel = np.s_[row : row + 180, column : column + 210]
        np.testing.assert_allclose(all_of_them[panel], engine.read(alone, "fractal:set_distance"), atol=1e-6)
        np.testing.assert_allclose(colours[panel], engine.read(alone, "fractal:colour"), atol=2e-3)


def test_ink_lies_on_the_set_and_fades_within_a_pixel(engine, sketch_of):
    values = {"fractal": "Sierpinski carpet", "depth": 2, "label": False, "margin": 0.1}
    sketch = sketch_of((200, 200), ink="#000000", paper="#ffffff", **values)
    away = engine.read(sketch, "fractal:set_distance") * 160  # pixels
    shade = engine.read(sketch, "fractal:colour")[..., 0]
    np.testing.assert_allclose(shade, np.clip(away, 0, 1), atol=2e-3)
    assert (shade == 0).mean() == pytest.approx(0.8**2 * (8 / 9) ** 2, abs=0.01)
    wide = sketch.with_values({"fractal.pen": 3.0})
    assert (engine.read(wide, "fractal:colour")[..., 0] == 0).sum() > 1.1 * (shade == 0).sum()


# ── the triangle ─────────────────────────────────────────────────────────────


def divided(depth, roughness, number):
    """Return {(i, j): place} of every point, by halving triangles one inside the other.

    ``number(i, j)`` gives the two random numbers of a point of the deepest lattice, 64 a side.
    """
    side = 2**depth
    result = {
        (0, 0): np.array([-0.5, -ROOT_3 / 4]),
        (side, 0): np.array([0.5, -ROOT_3 / 4]),
        (0, side): np.array([0, ROOT_3 / 4]),
    }

    def middle(a, b):
        key = ((a[0] + b[0]) // 2, (a[1] + b[1]) // 2)
        if key not in result:
            length = np.hypot(*(result[b] - result[a]))
            random = 2 * number(key[0] * 64 // side, key[1] * 64 // side) - 1
            result[key] = (result[a] + result[b]) / 2 + random * roughness * length
        return key

    def halve(a, b, c, turns):
        if turns:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            for item in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (bc, ca, ab)):
                halve(*item, turns - 1)

    halve(*list(result), depth)
    return result


def number(i, j):
    return np.array([n >> 8 for n in pcg3d(i, j, 7 + salt("generation/fractalised_triangle"))[:2]]) / 2.0**24


@pytest.mark.parametrize("depth", [0, 1, 2, 4, 6])
@pytest.mark.parametrize("roughness", [0.0, 0.15, 0.5])
def test_the_triangle_is_divided(engine, sketch_of, depth, roughness):
    sketch = sketch_of((32, 32), "fractalised_triangle", depth=depth, roughness=roughness)
    result = engine.read(sketch, "fractal.points")
    truth = divided(depth, roughness, number)
    assert result.shape == (2**depth + 1,) * 2 + (2,)
    assert len(truth) == (2**depth + 1) * (2**depth + 2) // 2
    for (i, j), position in truth.items():
        np.testing.assert_allclose(result[j, i], position, atol=2e-6)


@pytest.mark.parametrize("depth", [0, 1, 3])
def test_facets_have_a_shade_each_and_edges_are_ink(engine, sketch_of, depth):
    values = {"depth": depth, "roughness": 0.1, "panels": False, "ink": "#000000", "paper": "#ffffff"}
    sketch = sketch_of((120, 120), "fractalised_triangle", **values)
    result = engine.read(sketch, "fractal")[..., :3].reshape(-1, 3).astype(np.float64)
    points = divided(depth, 0.1, number)
    y, x = np.mgrid[0:120, 0:120]
    position = (np.stack([x, y], axis=-1).reshape(-1, 2) + 0.5 - 60) / 96
    away = np.full(len(position), np.inf)
    facet = np.zeros(len(position), int)
    count = 0
    for i, j in points:
        for three in (((0, 0), (1, 0), (0, 1)), ((1, 1), (0, 1), (1, 0))):
            keys = [(i + a, j + b) for a, b in three]
            if all(key in points for key in keys):
                count += 1
                corners = np.array([points[key] for key in keys])
                ends = zip(corners, np.roll(corners, 1, axis=0), strict=True)
                away = np.min([away, *(far_from_segment(position, a, b) for a, b in ends)], axis=0)
                facet[far_from(position, corners) == 0] = count
    assert count == 4**depth
    ink = np.clip(1.1 - 96 * away, 0, 1) * (1 - 0.1 * depth)
    outside = facet == 0
    np.testing.assert_allclose(
        result[outside], np.broadcast_to(1 - ink[outside, None], result[outside].shape), atol=2e-3
    )
    assert (ink[~outside] > 0.5).any()
    shades = []
    for index in range(1, count + 1):
        seen = (facet == index) & (ink < 0.5)
        if seen.sum() > 3:
            shade = result[seen] / (1 - ink[seen, None])
            assert np.ptp(shade, axis=0).max() < 4e-3
            shades.append(tuple(np.round(shade[0], 2)))
    assert len(shades) > 0.9 * count and len(set(shades)) > 0.4 * len(shades)


def test_panels_show_the_iterations_as_far_as_they_go(engine, sketch_of):
    sketch = sketch_of((300, 200), "fractalised_triangle", depth=2)
    panels = engine.read(sketch, "fractal")[..., :3].copy()
    alone = []
    for turns in range(3):
        sketch = sketch_of((100, 100), "fractalised_triangle", depth=turns, panels=False)
        alone.append(engine.read(sketch, "fractal")[..., :3].copy())
    for index in range(6):
        row, column = 100 * (1 - index // 3), 100 * (index % 3)
        panel = panels[row : row + 100, column : column + 100]
        np.testing.assert_allclose(panel, alone[min(index, 2)], atol=2e-3)
