"""The Game of Life against its rule in NumPy, bit by bit; gliders fly, round the torus too."""

import numpy as np
import pytest

PASSES = """
[[pass]]
name = "life"
use = "simulation/life"
set = {{ pattern = "{pattern}", every = {every}, fade = {fade}, seed = {seed} }}
"""


@pytest.fixture
def sketch_of(make_sketch):
    def make(pattern="soup", size=(48, 37), every=1, fade=0.02, seed=1):
        text = PASSES.format(pattern=pattern, every=every, fade=fade, seed=seed)
        return make_sketch(text, size=list(size))

    return make


def generation_after(cells):
    """Return the next generation of cells, 0 or 1, on a torus: counted by rolled copies."""
    shifts = [(y, x) for y in (-1, 0, 1) for x in (-1, 0, 1) if (y, x) != (0, 0)]
    count = sum(np.roll(cells, shift, (0, 1)) for shift in shifts)
    return ((count == 3) | ((count == 2) & (cells == 1))).astype(int)


def cells_at(engine, sketch, frame, output="life"):
    return engine.read(sketch, f"life:{output}", time=frame / 60)


@pytest.mark.parametrize("size", [(48, 37), (33, 64)], ids=str)
@pytest.mark.parametrize("every", [1, 3])
def test_a_soup_follows_the_rule(engine, sketch_of, size, every):
    sketch = sketch_of(size=size, every=every)
    cells = cells_at(engine, sketch, 0).astype(int)
    assert 0.25 < cells.mean() < 0.45, "the soup, of density 0.35"
    for frame in range(1, 61):
        if frame % every == 0:
            cells = generation_after(cells)
        np.testing.assert_array_equal(cells_at(engine, sketch, frame), cells)
    assert cells.any()


def test_the_trail_is_life_fading(engine, sketch_of):
    sketch = sketch_of(every=2, fade=5 / 255)
    trail = np.zeros((37, 48), int)
    for frame in range(30):
        alive = cells_at(engine, sketch, frame) == 1
        trail = np.where(alive, 255, np.maximum(trail - 5, 0))
        cells = cells_at(engine, sketch, frame, "trail")
        np.testing.assert_array_equal(np.round(255 * cells).astype(int), trail)


@pytest.mark.parametrize("size", [(16, 16), (48, 32)], ids=str)
def test_glider_moves_one_cell_in_four_steps_and_wraps_torus(engine, sketch_of, size):
    sketch = sketch_of("gliders", size=size)
    first = cells_at(engine, sketch, 0)
    assert first.sum() == 5 * (size[0] // 16) * (size[1] // 16)
    np.testing.assert_array_equal(cells_at(engine, sketch, 4), np.roll(first, (-1, 1), (0, 1)))
    np.testing.assert_array_equal(cells_at(engine, sketch, 64), first)


def test_gliders_whose_tile_the_edge_cuts_are_left_out(engine, sketch_of):
    assert cells_at(engine, sketch_of("gliders", size=(47, 33)), 0).sum() == 5 * 2 * 2


def test_another_seed_is_another_soup(engine, sketch_of):
    assert (cells_at(engine, sketch_of(seed=1), 0) != cells_at(engine, sketch_of(seed=2), 0)).any()
