"""The Python API as its first lines of documentation promise it."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import playground

SKETCH = """
format = 1
size = 65
[[pass]]
name = "height"
use = "generation/diamond_square"
[view]
use = "view/map"
inputs = { shown = "height" }
set = { channel = "red" }
"""


@pytest.fixture
def sketch(tmp_path: Path) -> playground.Sketch:
    path = tmp_path / "small.toml"
    path.write_text(SKETCH)
    return playground.load(path)


def test_a_sketch_renders_to_an_array_and_a_png(sketch: playground.Sketch, tmp_path: Path):
    with playground.headless() as engine:
        frame = engine.render(sketch, size=(120, 90))
    assert frame.array.shape == (90, 120, 4)
    assert frame.array.dtype == np.uint8
    assert frame._repr_png_().startswith(b"\x89PNG")
    saved = frame.save(tmp_path / "land.png")
    assert saved.read_bytes().startswith(b"\x89PNG")


def test_textures_come_as_documented(sketch: playground.Sketch):
    with playground.headless() as engine:
        height = engine.read(sketch, "height")
        assert height.shape == (65, 65)
        assert height.dtype == np.float32
        # Row 0 is the south: the south-east corner is the last of the first row.
        marked = sketch.with_values({"height.corners": (0.1, 0.2, 0.3, 0.4), "height.smoothing": 0.0})
        corners = engine.read(marked, "height")[[0, 0, -1, -1], [0, -1, 0, -1]]
        np.testing.assert_allclose(corners, [0.1, 0.2, 0.3, 0.4], rtol=1e-6)


def test_parameters_are_listed_and_set_without_changing_the_sketch(sketch: playground.Sketch):
    found = playground.parameters(sketch)
    parameter, value = found["height.smoothing"]
    assert (parameter.type, value) == ("float", pytest.approx(0.2))
    changed = sketch.with_values({"height.smoothing": 0.7})
    assert playground.parameters(changed)["height.smoothing"][1] == pytest.approx(0.7)
    assert playground.parameters(sketch)["height.smoothing"][1] == pytest.approx(0.2)
    with pytest.raises(playground.ParameterError, match="smoothing"):
        sketch.with_values({"height.smothing": 0.7})
    with pytest.raises(playground.ParameterError, match="range"):
        sketch.with_values({"height.smoothing": 7})


def test_a_repeated_kernel_is_walked_turn_by_turn(sketch: playground.Sketch):
    small = sketch.with_values({"size": 5})
    with playground.headless() as engine:
        turns = list(engine.steps(small, _repeated(engine, small)))
    assert [turn for turn, _ in turns] == [0, 1, 2, 3, 4, 5]
    assert [int(np.count_nonzero(values)) for _, values in turns] == [0, 4, 5, 9, 13, 25]


def _repeated(engine: playground.Engine, sketch: playground.Sketch) -> str:
    plan = engine.plan_for(sketch, (64, 64))
    return next(step.path for step in plan.walk() if step.kernel.repeat != "1")


def test_a_sketch_is_a_value(sketch: playground.Sketch):
    assert pickle.loads(pickle.dumps(sketch)) == sketch
    assert hash(sketch.with_values({"height.seed": 3})) == hash(sketch.with_values({"height.seed": 3}))


def test_one_call_renders_a_shipped_sketch():
    frame = playground.render("jacksboro", size=(96, 54), values={"size": 65})
    assert frame.array[..., :3].std() > 5
    assert (frame.array[..., 3] == 255).all()
