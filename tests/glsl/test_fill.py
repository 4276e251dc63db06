"""Depressions filled as by a priority flood; every texel drains; turning the terrain turns it."""

import numpy as np
import pytest

from playground.engine.engine import Engine

from ..sketch_texts import passes
from ..truth.drainage import edge_of, ends_of, flooded

PASSES = passes(
    height="./rough", fill="water/fill", down=("water/directions", 'inputs = { height = "fill" }')
)
STOPPED = (
    PASSES.replace('"water/fill"\n', '"water/fill"\nset = {{ "fill.steps" = {steps} }}\n')
    .replace("{ height = ", "{{ height = ")
    .replace('"fill" }\n', '"fill" }}\n')
)
ROUGH = """
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")
uniform float flat_to = 0.0;  //! slider(0, 1) Nothing lies lower
uniform int turn = 0;         //! slider(0, 1) Half a turn
uniform int mirror = 0;       //! slider(0, 1) East for west
float kernel(ivec2 texel) {
    if (turn == 1) texel = size - 1 - texel;
    if (mirror == 1) texel.x = size.x - 1 - texel.x;
    float sum = 0.0;
    for (int k = 0; k < 4; k++) sum += random(texel >> k, uint(k)) * float(1 << k) / 15.0;
    return max(sum, flat_to);
}
"""
SIZE, EXTENT, RELIEF = [71, 53], [2100.0, 1300.0], 400.0
SPACING = (EXTENT[0] / 70, EXTENT[1] / 52)
FALL = 1e-4 / RELIEF


@pytest.fixture
def terrain(make_sketch):
    return make_sketch(PASSES, size=SIZE, extent=EXTENT, relief=RELIEF, rough=ROUGH)


def test_equal_to_a_priority_flood(engine, terrain):
    height, level = engine.read(terrain, "height").copy(), engine.read(terrain, "fill").copy()
    assert (level >= height).all() and (level - height > 0.02).mean() > 0.1
    # Heights up to 1, rounded once a texel of the way.
    np.testing.assert_allclose(level, flooded(height, SPACING, FALL), rtol=0, atol=2e-6)


FLOOD = passes(high="./high", flood=("water/fill/flood", 'inputs = { height = "height", initial = "high" }'))
HIGH = """
#include "water/texels.glsl"
#pragma kernel(output = "level:r32f")
uniform sampler2D height;  //! input
float kernel(ivec2 texel) { return on_edge(texel, size) ? texelFetch(height, texel, 0).r : 1e30; }
"""
# A way that goes to and fro in every second row, 1,800 texels to the one gap in the wall.
MAZE = """
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) {
    bool wall = texel.y % 2 == 0 && texel.x != (texel.y % 4 == 0 ? 1 : size.x - 2);
    return wall || texel.x == 0 || texel.x == size.x - 1 || texel.y == size.y - 1 ? 1.0 : 0.0;
}
"""


@pytest.mark.parametrize(
    ("rough", "size"),
    [(ROUGH, [71, 53]), (ROUGH, [200, 129]), (ROUGH, [2, 3]), (MAZE, [71, 53])],
    ids=["71x53", "200x129", "2x3", "maze"],
)
def test_tiled_flood_matches_stepwise_flood_bit_for_bit(ctx, make_sketch, size, rough):
    """In whatever order texels fall, a flood ends at the same levels; and they are the water's."""
    if ctx.version_code < 430:
        pytest.skip("tiles fall by compute shaders")
    extent = [30.0 * (n - 1) for n in size]
    sketch = make_sketch(PASSES + FLOOD, size=size, extent=extent, relief=RELIEF, rough=rough, high=HIGH)
    with Engine(ctx) as engine:
        height, level = engine.read(sketch, "height").copy(), engine.read(sketch, "fill").copy()
        np.testing.assert_array_equal(level, engine.read(sketch, "flood"))
    rounded = 2e-6 if rough == ROUGH else 6e-8 * 1800
    np.testing.assert_allclose(level, flooded(height, (30.0, 30.0), FALL), rtol=0, atol=rounded)


def spiral(ny: int, nx: int) -> np.ndarray:
    """Return a corridor of depth 1 that winds from the middle to a gap at the south-west."""
    walls, (x, y), (dx, dy), turns = np.ones((ny, nx), np.float32), (1, 1), (1, 0), 0
    walls[:2, 1] = 0
    while turns < 2:
        to, after = (y + dy, x + dx), (y + 2 * dy, x + 2 * dx)
        blocked = not (0 < to[0] < ny - 1 and 0 < to[1] < nx - 1) or walls[after] == 0
        turns = turns + 1 if blocked else 0
        if blocked:
            dx, dy = -dy, dx
        else:
            y, x = to
            walls[to] = 0
    return walls


def labyrinth(ny: int, nx: int, seed: int) -> np.ndarray:
    """Return corridors of depth 1 with one way between any two places, and a gap at the south-west."""
    random, walls, way = np.random.default_rng(seed), np.ones((ny, nx), np.float32), [(1, 1)]
    walls[:2, 1] = 0
    while way:
        y, x = way[-1]
        free = [
            (dy, dx)
            for dy, dx in ((0, 1), (1, 0), (0, -1), (-1, 0))
            if 0 < y + 2 * dy < ny - 1 and 0 < x + 2 * dx < nx - 1 and walls[y + 2 * dy, x + 2 * dx]
        ]
        if not free:
            way.pop()
            continue
        dy, dx = free[random.integers(len(free))]
        walls[y + dy, x + dx] = walls[y + 2 * dy, x + 2 * dx] = 0
        way.append((y + 2 * dy, x + 2 * dx))
    return walls


def bowls(ny: int, nx: int) -> np.ndarray:
    """Return bowls within bowls, whose rims are lower towards the middle."""
    y, x = np.mgrid[-1 : 1 : ny * 1j, -1 : 1 : nx * 1j]
    away = np.hypot(x, y) / np.sqrt(2)
    waves = (0.5 + 0.5 * np.cos(20 * away)) * away
    return ((waves - waves.min()) / np.ptp(waves)).astype(np.float32)


SHAPES = {
    "spiral": lambda: spiral(97, 97),
    "long spiral": lambda: spiral(40, 211),
    "labyrinth": lambda: labyrinth(71, 53, 1),
    "another": lambda: labyrinth(34, 99, 2),
    "bowls": lambda: bowls(60, 83),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_valleys_of_any_shape_are_filled_to_their_spills(engine, make_sketch, shape):
    _check_fill(engine, make_sketch, SHAPES[shape]())


@pytest.mark.slow
def test_a_spiral_of_33000_texels_is_filled_to_its_spill(engine, make_sketch):
    _check_fill(engine, make_sketch, spiral(257, 257))


def _check_fill(engine, make_sketch, heights: np.ndarray) -> None:
    ny, nx = heights.shape
    text = PASSES.replace('"./rough"', '"generation/heightmap"')
    sketch = make_sketch(text, size=[nx, ny], extent=[10.0 * (nx - 1), 15.0 * (ny - 1)], relief=100.0)
    sketch = sketch.with_values({"height.elevation": heights})
    height, level = engine.read(sketch, "height").copy(), engine.read(sketch, "fill").copy()
    truth = flooded(height, (10.0, 15.0), 1e-4 / 100.0)
    # Heights up to 1 are rounded to 6e-8 at most once a texel of the way, which has half of all texels.
    np.testing.assert_allclose(level, truth, rtol=0, atol=6e-8 * heights.size / 2)


@pytest.mark.parametrize("size", [[71, 53], [130, 97]], ids=str)
def test_in_few_steps_it_is_too_high_by_a_part_of_the_fall(engine, make_sketch, size):
    """What is not found is a shorter way of the same spill: the fall across the terrain bounds that."""
    sketch = make_sketch(STOPPED.format(steps=16), size=size, extent=EXTENT, relief=RELIEF, rough=ROUGH)
    height, level = engine.read(sketch, "height").copy(), engine.read(sketch, "fill").copy()
    spacing = [e / (s - 1) for e, s in zip(EXTENT, size, strict=True)]
    over = level - flooded(height, spacing, FALL)
    assert over.min() > -2e-6
    assert over.max() < FALL * np.hypot(*EXTENT)


@pytest.mark.parametrize("steps", [1, 7, 400])
@pytest.mark.parametrize("flat_to", [0.0, 0.5, 1.0])
def test_every_texel_drains_after_any_number_of_steps(engine, make_sketch, steps, flat_to):
    sketch = make_sketch(STOPPED.format(steps=steps), size=SIZE, extent=EXTENT, relief=RELIEF, rough=ROUGH)
    sketch = sketch.with_values({"height.flat_to": flat_to})
    level, receiver = engine.read(sketch, "fill").ravel().copy(), engine.read(sketch, "down").astype(int)
    edge = edge_of(receiver.shape)
    assert edge.ravel()[ends_of(receiver)].all(), "every way ends at an edge"
    inner = ~edge.ravel()
    assert (level[receiver.ravel()[inner]] < level[inner]).all()


def test_hostile_scales_keep_their_ways(engine, make_sketch):
    """A relief of kilometres on texels of centimetres, where the fall is near what a float rounds to."""
    for extent, relief in ([0.7, 0.5], 9000.0), ([7e6, 5e6], 0.01):
        sketch = make_sketch(STOPPED.format(steps=60), size=SIZE, extent=extent, relief=relief, rough=ROUGH)
        receiver = engine.read(sketch, "down").astype(int)
        assert edge_of(receiver.shape).ravel()[ends_of(receiver)].all()
