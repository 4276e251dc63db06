"""The terrain of triangles against SciPy's linear interpolation; the pictures of it by their own pixels."""

from __future__ import annotations

import os
import subprocess
import sys
from fractions import Fraction
from functools import partial

import numpy as np
import pytest
from scipy.interpolate import LinearNDInterpolator

from playground.data.delaunay import Rules, Triangulation, triangulate
from playground.engine.engine import Engine
from playground.errors import DataError
from playground.paths import GLSL
from playground.sketch.model import kernels_of
from playground.sketch.techniques import read_technique

from ..loading import load
from ..sketch_texts import kernel, passes, use
from ..truth.noise import python_random, salt

TABLES = "generation/delaunay/tables.glsl"
DRAWN = "generation/delaunay/picture/drawn.glsl"
SIZES = [(2, 2), (3, 3), (5, 5), (33, 33), (513, 513), (37, 22), (2, 300), (130, 7)]


@pytest.fixture
def terrain(single):
    """Give a function that makes a sketch of the terrain: its size and its parameters."""
    return partial(single, "generation/delaunay")


def rules_of(**values) -> Rules:
    """Return the rules that the technique's parameters stand for."""
    renamed = {
        "weights": ("random_weights", "random"),
        "method": ("by_flips", "flips"),
        "heights": ("displaced", "displaced"),
    }
    result = {}
    for name, value in values.items():
        field, on = renamed.get(name, (name, None))
        result[field] = value if on is None else value == on
    return Rules(**result)


def truth(made: Triangulation, size) -> np.ndarray:
    """Return heights at the texels in float64, each exactly where it stands, by SciPy's own triangles."""
    x, y = (np.linspace(0, side, n) for side, n in zip(made.sides, size, strict=True))
    return LinearNDInterpolator(made.places.astype(np.float64), made.heights)(*np.meshgrid(x, y))


# ── the terrain ─────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("points", [1, 2, 60, pytest.param(1000, marks=pytest.mark.slow)])
def test_heights_are_scipy_s(any_engine, terrain, points):
    """Every texel, those on the terrain's border too: one that no triangle covered would be 0."""
    values = {"points": points, "weights": "random", "corners": (0.9, 0.7, 0.6, 0.8)}
    made = triangulate(rules_of(**values))
    for size in SIZES:
        result = any_engine.read(terrain(size, **values), "terrain.tin")
        np.testing.assert_allclose(result, truth(made, size), atol=5e-7, err_msg=str(size))
        assert result[0, 0] == np.float32(0.9) and result[-1, -1] == np.float32(0.8)


@pytest.mark.parametrize(
    ("points", "weights", "proportion", "size"),
    [
        pytest.param(10_000, "random", 0.125, (257, 129), marks=pytest.mark.slow),
        (1000, "equal", 1.0, (1000, 1000)),
    ],
)
def test_slivers(any_engine, terrain, points, weights, proportion, size):
    """Along the border triangles are thousands of times longer than high."""
    values = {"points": points, "weights": weights, "proportion": proportion}
    result = any_engine.read(terrain(size, **values), "terrain.tin")
    whole = truth(triangulate(rules_of(**values)), size)
    np.testing.assert_allclose(result, whole, atol=4e-7)
    assert whole.std() > 0.1


def test_two_triangles(engine, terrain):
    """The first step: an edge from south-east to north-west, a plane on either side."""
    sw, se, nw, ne = 0.1, 0.6, 0.9, 0.4
    for size in SIZES:
        x, y = np.meshgrid(*(np.linspace(0, 1, n) for n in size))
        below = sw + (se - sw) * x + (nw - sw) * y
        above = ne + (nw - ne) * (1 - x) + (se - ne) * (1 - y)
        result = engine.read(terrain(size, points=0, corners=(sw, se, nw, ne)), "terrain.tin")
        np.testing.assert_allclose(result, np.where(x + y < 1, below, above), atol=2e-7, err_msg=str(size))


def test_each_step_is_scipy_s(any_engine, terrain):
    for points in range(1, 12):
        result = any_engine.read(terrain((65, 65), points=points), "terrain.tin")
        np.testing.assert_allclose(result, truth(triangulate(Rules(points=points)), (65, 65)), atol=5e-7)


def test_no_texel_is_missed_at_any_size(any_engine, terrain):
    """Heights near 1 everywhere: displaced by next to nothing."""
    values = {"heights": "displaced", "roughness": 3.0, "corners": (1.0,) * 4}
    for points in (0, 1, 300):
        least = triangulate(rules_of(points=points, **values)).heights.min()
        assert least > 0.5
        for size in [(1, 1), (1, 9), (9, 1), *SIZES]:
            result = any_engine.read(terrain(size, points=points, **values), "terrain.tin")
            assert result.shape == size[::-1] and np.isfinite(result).all()
            assert result.min() >= least - 1e-6, size


def test_flat_terrain_is_exactly_flat(engine, terrain):
    for corners in ((0.3,) * 4, (1.0,) * 4):
        result = engine.read(terrain((65, 33), points=0, corners=corners), "terrain.tin")
        assert (result == np.float32(corners[0])).all()


def test_both_drivers_and_both_methods_give_the_same_bits(ctx, terrain):
    result = []
    for driver in ("fragment", "compute") if ctx.version_code >= 430 else ("fragment",):
        for method in ("destruction and construction", "flips"):
            with Engine(ctx, driver=driver) as engine:
                sketch = terrain((65, 40), points=200, weights="random", method=method)
                result.append([engine.read(sketch, ref) for ref in ("terrain", "terrain.tin")])
    for item in result[1:]:
        for mine, first in zip(item, result[0], strict=True):
            np.testing.assert_array_equal(mine, first)


def test_heights_are_the_hash_s_numbers(any_engine, terrain):
    """noise/hash.glsl's random(ivec2(point, 0), seed + salt), for points numbered after the four corners."""
    made = triangulate(Rules(points=50, seed=123))
    np.testing.assert_array_equal(
        made.heights[4:], python_random(np.arange(4, 54), 0, 123 + salt("delaunay"))
    )
    table = any_engine.read(terrain(points=50, seed=123), "terrain.triangulation:places").reshape(-1, 4)
    np.testing.assert_array_equal(table[:54, 2], made.heights.astype(np.float32))
    np.testing.assert_array_equal(table[:54, :2], made.places)


def test_every_parameter_reaches_the_triangulation(any_engine, terrain):
    changes = {
        "points": 31,
        "weights": "random",
        "seed": 8,
        "heights": "displaced",
        "corners": (0.1, 0.2, 0.3, 0.4),
        "proportion": 0.4,
    }
    usual = {"points": 30, "proportion": 1.0}
    first = any_engine.read(terrain(**usual), "terrain.tin")
    for name, value in changes.items():
        values = usual | {name: value}
        result = any_engine.read(terrain(**values), "terrain.tin")
        assert not np.array_equal(result, first), name
        np.testing.assert_allclose(
            result, truth(triangulate(rules_of(**values)), (33, 33)), atol=5e-7, err_msg=name
        )
    displaced = {"points": 30, "heights": "displaced"}
    rough, smooth = (any_engine.read(terrain(**displaced, roughness=r), "terrain.tin") for r in (0.5, 1.5))
    assert smooth.std() < 0.7 * rough.std()


def test_more_triangles_than_there_are_add_nothing(any_engine, make_sketch):
    tin = use("generation/delaunay/tin", points=20)
    sketch = make_sketch(passes(made=use("generation/delaunay/triangulation", points=20), tin=tin))
    first = any_engine.read(sketch, "tin")
    np.testing.assert_array_equal(any_engine.read(sketch.with_values({"tin.points": 400}), "tin"), first)


def test_a_triangulation_that_does_not_fit_has_a_sentence(any_engine, make_sketch):
    sketch = make_sketch(passes(made="generation/delaunay/triangulation"), size=9)
    with pytest.raises(DataError, match="122 entries do not fit into 9 x 9 texels") as caught:
        any_engine.read(sketch, "made:places")
    assert caught.value.diagnostics[0].line == 5


@pytest.mark.slow
def test_opengl_3_3_is_enough(any_engine, terrain, tmp_path):
    kinds = {kernel.kind for _, kernel in kernels_of(read_technique("generation/delaunay", GLSL, GLSL))}
    assert kinds == {"source", "draw", "kernel"}
    sketch = terrain((33, 33), points=40)
    out = tmp_path / "old.npy"
    value = ["--texture", "terrain", "-o", str(out), "--set", "terrain.points=40"]
    done = subprocess.run(
        [sys.executable, "-m", "playground", "render", sketch.file, *value],
        env={**os.environ, "MESA_GL_VERSION_OVERRIDE": "3.3", "PYTHONPATH": str(GLSL.parent)},
        capture_output=True,
        text=True,
        cwd=tmp_path,
    )
    assert done.returncode == 0, done.stderr
    np.testing.assert_array_equal(np.load(out), any_engine.read(sketch, "terrain"))


# ── whole numbers in GLSL ────────────────────────────────────────────────────


def test_the_cross_product_is_rounded_once(on_gpu):
    rng = np.random.default_rng(1)
    a, b = rng.integers(-(2**24), 2**24 + 1, (2, 4000, 2))
    b[:1000] = (a[:1000] * rng.uniform(0.1, 0.9, (1000, 1))).astype(np.int64)  # nearly along a
    b[1000:1500] = a[1000:1500] + rng.integers(-2, 3, (500, 2))
    b = np.clip(b, -(2**24), 2**24)
    a[:8] = b[:8] = [[2**24, 2**24], [-(2**24), 2**24], [2**24, -(2**24)], [-(2**24)] * 2] * 2
    b[4:8] = b[5:9][::-1]
    result = on_gpu(TABLES, "exact_cross(a, b)", a=a.astype(np.int32), b=b.astype(np.int32))
    exact = a[:, 0].astype(object) * b[:, 1] - a[:, 1].astype(object) * b[:, 0]
    off = np.array([float(abs(Fraction(float(f)) - int(e))) for f, e in zip(result, exact, strict=True)])
    most = np.array([float(abs(e)) for e in exact])
    assert (off <= most * 2.0**-23).all() and (result[exact == 0] == 0).all()
    in_floats = a[:, 0].astype(np.float32) * b[:, 1].astype(np.float32) - a[:, 1].astype(np.float32) * b[
        :, 0
    ].astype(np.float32)
    assert np.abs(in_floats - most).max() > 1e3, "what rounding twice would do"


@pytest.mark.parametrize("side", [2**24, 4096 * 1229, 4096])
def test_places_are_exact_fractions(on_gpu, side):
    texels = np.array([2, 3, 5, 33, 257, 513, 1000, 4097, 16_384], np.int32)
    n = np.repeat(texels, 5)
    k = (np.linspace(0, 1, 5)[None] * (texels[:, None] - 1)).astype(np.int32).ravel()
    result = on_gpu(TABLES, f"exact_place(k, n, {side})", k=k, n=n)
    for i in range(len(k)):
        expected = Fraction(side * int(k[i]), int(n[i]) - 1)
        assert result[i, 0] == expected // 1
        assert result[i, 1] == pytest.approx(float(expected % 1), abs=1e-6)


def test_circles_hold_what_is_inside(on_gpu):
    rng = np.random.default_rng(2)
    p = rng.uniform(0, 2**24, (2000, 4, 2))
    a, b, c, d = (p[:, i] for i in range(4))
    turn = np.cross(np.pad(b - a, ((0, 0), (0, 1))), np.pad(c - a, ((0, 0), (0, 1))))[:, 2] < 0
    b[turn], c[turn] = c[turn].copy(), b[turn].copy()
    result = on_gpu(DRAWN, "int(is_inside_circle(a, b, c, d))", a=a, b=b, c=c, d=d)
    middles = [
        np.linalg.solve(2 * np.array([q - o, r - o]), [q @ q - o @ o, r @ r - o @ o])
        for o, q, r in zip(a, b, c, strict=True)
    ]
    radius = np.linalg.norm(a - middles, axis=1)
    off = (radius - np.linalg.norm(d - middles, axis=1)) / radius
    sure = np.abs(off) > 1e-3
    np.testing.assert_array_equal(result[sure] == 1, off[sure] > 0)
    assert 200 < result.sum() < 1800


# ── the pictures ─────────────────────────────────────────────────────────────

WIDTH, HEIGHT, MARGIN = 640, 360, 0.1


@pytest.fixture
def picture(any_engine, make_sketch):
    """Give a function that draws a triangulation: (pixels south first, its pixel of a lattice place)."""

    def draw(rules: dict[str, object], **values):
        both = passes(made="generation/delaunay/triangulation", picture="generation/delaunay/picture")
        sketch = make_sketch(both, size=(WIDTH, HEIGHT))
        value = {f"made.{k}": v for k, v in rules.items()}
        value |= {f"picture.{k}": v for k, v in ({"circles": "none", "margin": MARGIN} | values).items()}
        return any_engine.read(sketch.with_values(value), "picture")

    return draw


def pixels_of(made: Triangulation, places) -> np.ndarray:
    """Return the pixels (x, y) of places: the terrain as large as fits but for a tenth, in the middle."""
    sides = np.array(made.sides, float)
    scale = min(WIDTH * (1 - 2 * MARGIN) / sides[0], HEIGHT * (1 - 2 * MARGIN) / sides[1])
    return np.array([WIDTH / 2, HEIGHT / 2]) + (np.asarray(places, float) - sides / 2) * scale


def at(result, pixels) -> np.ndarray:
    x, y = np.floor(pixels).astype(int).T
    return result[y, x, :3]


RULES = {"points": 9, "weights": "random", "seed": 3}
INK, PAPER = np.array([0.05, 0.05, 0.06]), np.array([0.93, 0.91, 0.87])


def test_edges_and_points_are_ink_and_the_rest_is_paper(picture):
    result, made = picture(RULES), triangulate(rules_of(**RULES))
    pixels = pixels_of(made, made.places)
    np.testing.assert_allclose(at(result, pixels), np.tile(INK, (13, 1)), atol=2e-3)
    lined = np.zeros((HEIGHT, WIDTH), bool)
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH] + 0.5
    for triangle in made.triangles.tolist():
        for i in range(3):
            p, q = pixels[triangle[i]], pixels[triangle[i - 1]]
            assert at(result, np.linspace(p, q, 9)).max() < 0.65, "along the edge it is dark"
            far = np.linalg.norm(q - p)
            position = np.clip(((x - p[0]) * (q - p)[0] + (y - p[1]) * (q - p)[1]) / far**2, 0, 1)
            lined |= np.hypot(x - p[0] - position * (q - p)[0], y - p[1] - position * (q - p)[1]) < 1.3
    for p in pixels:
        lined |= np.hypot(x - p[0], y - p[1]) < 3.6
    np.testing.assert_allclose(
        result[~lined][:, :3], np.tile(PAPER, (np.count_nonzero(~lined), 1)), atol=1e-3
    )
    assert (result[..., 3] == 1).all()


def test_circles_go_through_the_corners_of_their_triangles(picture):
    only = {"circles": "all", "line": 2.0, "dot_radius": 0.0, "ink": (0.0, 0.0, 0.0, 0.0)}
    result, made = picture(RULES, **only), triangulate(rules_of(**RULES))
    lined = np.zeros((HEIGHT, WIDTH), bool)
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH] + 0.5
    for triangle in made.triangles.tolist():
        a, b, c = pixels_of(made, made.places[triangle])
        middle = np.linalg.solve(2 * np.array([b - a, c - a]), [b @ b - a @ a, c @ c - a @ a])
        radius = np.linalg.norm(a - middle)
        angles = np.linspace(0, 2 * np.pi, 400)
        around = middle + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        shown = ((around > 1) & (around < [WIDTH - 1, HEIGHT - 1])).all(axis=1)
        assert at(result, around[shown])[:, 0].max() < 0.75, "around the circle it is drawn"
        lined |= np.abs(np.hypot(x - middle[0], y - middle[1]) - radius) < 1.6
    np.testing.assert_allclose(
        result[~lined][:, :3], np.tile(PAPER, (np.count_nonzero(~lined), 1)), atol=1e-3
    )


def hue(pixel) -> str:
    return "green" if pixel[1] > 2 * pixel[0] else "red" if pixel[0] > 2 * pixel[1] else "neither"


def test_an_illegal_edge_is_red_and_its_flip_green(picture):
    """Figure 1.28."""
    rules = {"points": 5, "weights": "random", "method": "flips", "seed": 9016}
    made = triangulate(rules_of(**rules))
    assert made.replaced == 1
    u, v, w = made.destroyed[1]
    marks = {"marked": "a flip", "circles": "none", "dot_radius": 0.0}
    before, after = picture(rules | {"flips": 0}, **marks), picture(rules, **marks)
    old, new = (pixels_of(made, made.places[list(ends)]) for ends in ((u, v), (8, w)))
    for share in (0.2, 0.4, 0.6, 0.8):
        position = old[0] + share * (old[1] - old[0])
        assert hue(at(before, position[None])[0]) == "red"
        assert hue(at(after, position[None])[0]) == "neither" or abs(share - 0.5) < 0.15
        position = new[0] + share * (new[1] - new[0])
        assert hue(at(after, position[None])[0]) == "green"
    for item in (before, after):
        tinted = at(
            item, pixels_of(made, made.places[[u, v, w, 8]].mean(axis=0)[None] + [[0.03 * 2**24, 0]])
        )[0]
        assert tinted[2] < PAPER[2] - 0.1, "both triangles are filled"


def test_every_edge_of_a_finished_triangulation_is_legal(picture):
    """Figure 1.27, for each edge in turn."""
    made = triangulate(rules_of(**RULES))
    for number in range(0, 3 * len(made.triangles), 5):
        triangle = np.roll(made.triangles[number // 3], -(number % 3) - 1)
        result = picture(RULES, marked="an edge", number=number, dot_radius=0.0)
        p, q = pixels_of(made, made.places[triangle[:2]])
        assert hue(at(result, (0.3 * p + 0.7 * q)[None])[0]) == "green"
        middle = pixels_of(made, made.places[triangle].mean(axis=0)[None])
        assert np.abs(at(result, middle)[0] - PAPER).max() > 0.1, "the triangle beside it is filled"


def test_what_the_last_insertion_destroyed_is_filled_and_dashed(picture):
    rules = {"points": 13, "weights": "random", "seed": 104, "proportion": 0.5625}
    for method in ("flips", "destruction and construction"):
        result = picture(rules | {"method": method}, marked="the last insertion", dot_radius=0.0)
        made = triangulate(rules_of(**rules))
        assert made.replaced >= 4
        inside = np.zeros((HEIGHT, WIDTH), bool)
        y, x = np.mgrid[0:HEIGHT, 0:WIDTH] + 0.5
        for triangle in made.destroyed.tolist():
            a, b, c = pixels_of(made, made.places[triangle])
            sides = [
                (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]) for p, q in ((a, b), (b, c), (c, a))
            ]
            inside |= (np.min(sides, axis=0) > 0) | (np.max(sides, axis=0) < 0)
        # Far enough from what is drawn on the rim.
        core, rim = inside.copy(), inside.copy()
        for _ in range(4):
            core = (
                core & np.roll(core, 1, 0) & np.roll(core, -1, 0) & np.roll(core, 1, 1) & np.roll(core, -1, 1)
            )
            rim = rim | np.roll(rim, 1, 0) | np.roll(rim, -1, 0) | np.roll(rim, 1, 1) | np.roll(rim, -1, 1)
        assert np.abs(result[core][:, :3] - PAPER).max(axis=1).min() > 0.05
        colourful = np.abs(result[..., 0] - result[..., 2]) > 0.15
        assert not colourful[~rim].any()
        for u, v, w in made.destroyed[1:].tolist():
            p, q, new, far = pixels_of(made, made.places[[u, v, 16, w]])
            dashes = [hue(c) for c in at(result, np.linspace(p, q, 60)[5:-5])]
            assert dashes.count("red") > 10 and dashes.count("red") < 50, "red, with gaps"
            assert hue(at(result, (0.35 * new + 0.65 * far)[None])[0]) == "green"


def test_a_picture_may_lie_on_another(any_engine, make_sketch):
    """Nothing drawn, and white paper: what lies under it is what comes out."""
    back = kernel("vec4(random_pair(texel, 1u), random(texel, 2u), 1.0)", "back:rgba16f")
    blank = {"circles": "all", "line": 0.0, "dot_radius": 0.0, "paper": (1.0, 1.0, 1.0)}
    text = passes(
        back="./back",
        made="generation/delaunay/triangulation",
        picture=use("generation/delaunay/picture", inputs={"under": "back"}, **blank),
    )
    sketch = make_sketch(text, size=65, back=back)
    result, under = any_engine.read(sketch, "picture"), any_engine.read(sketch, "back")
    np.testing.assert_allclose(result, under, atol=1e-3)
    lined = any_engine.read(sketch.with_values({"picture.line": 2.0, "picture.circles": "none"}), "picture")
    assert lined.mean() < 0.8 * under.mean()


def test_more_points_than_there_are_draw_nothing(picture):
    np.testing.assert_array_equal(
        picture(RULES, points=9, circles="all"), picture(RULES, points=700, circles="all")
    )
    assert not np.array_equal(picture(RULES, points=9), picture(RULES, points=3))


def test_side_by_side_each_keeps_to_its_window(any_engine):
    sketch = load("delaunay_flips")
    both, left = any_engine.read(sketch, "right"), any_engine.read(sketch, "left")
    np.testing.assert_array_equal(both[:, :320], left[:, :320])
    assert (np.abs(left[:, 320:, :3] - PAPER) < 1e-3).all()
    assert (both[:, 320:, :3].min(axis=-1) < 0.2).sum() > 500
