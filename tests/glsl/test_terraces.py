"""Steps of hard and soft layers, against the curve through their edges."""

from __future__ import annotations

import numpy as np
import pytest

from ..sketch_texts import passes

PLANE = """#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return float(texel.y) / float(size.y - 1); }
"""
RELIEF, BASE = 1000.0, -200.0
METRES = BASE + RELIEF * np.linspace(0, 1, 513)


@pytest.fixture
def stepped(engine, make_sketch):
    """Give ``stepped(**parameters)``: the metres above the sea that a plane from -200 to 800 m has then."""

    def read(**values):
        text = ", ".join(f"{name} = {value}" for name, value in values.items())
        made = passes(
            plane="./plane", cut=("erosion/terraces", 'inputs = { height = "plane" }', f"set = {{ {text} }}")
        )
        head = f"base_elevation = {BASE}\n"
        sketch = make_sketch(head + made, size=[3, 513], extent=[8.0, 2000.0], relief=RELIEF, plane=PLANE)
        return BASE + RELIEF * engine.read(sketch, "cut").astype(np.float64)

    return read


def test_even_layers_are_the_curve_through_their_edges(stepped):
    result = stepped(thickness=100.0, uneven=0.0, wall=0.2, bench=0.3)
    edges = np.arange(-300, 901, 100.0)
    sort = np.sort(np.concatenate([edges, edges[:-1] + 80]))
    kept = np.sort(np.concatenate([edges, edges[:-1] + 30]))
    np.testing.assert_allclose(result[:, 1], np.interp(METRES, sort, kept), atol=1e-3)
    assert np.ptp(result, axis=1).max() == 0


def test_uneven_terraces_rise_with_ground_within_one_layer(stepped):
    result = stepped(thickness=100.0, uneven=1.0, wall=0.1, bench=0.3, seed=8)[:, 1]
    assert np.diff(result).min() >= 0 and np.abs(result - METRES).max() < 140
    assert (result <= METRES + 1e-3).all()


def test_outside_its_heights_and_without_strength_nothing_moves(stepped):
    result = stepped(thickness=60.0, between=[100.0, 300.0])[:, 1]
    outside = (METRES < 70) | (METRES > 330)
    np.testing.assert_allclose(result[outside], METRES[outside], atol=1e-3)
    assert np.abs(result - METRES)[~outside].max() > 10
    np.testing.assert_allclose(stepped(strength=0.0)[:, 1], METRES, atol=1e-3)
