"""The Python API as its first lines of documentation promise it."""

from __future__ import annotations

import textwrap
from pathlib import Path

import numpy as np
import pytest

import playground

from .sketch_texts import map_of_height

SKETCH = "\nformat = 1\nsize = 65\n" + map_of_height("generation/diamond_square", channel="red")


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
    saved = frame.save(tmp_path / "terrain.png")
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


def test_parameters_are_listed_and_set_without_mutating_sketch(sketch: playground.Sketch):
    parameters = playground.parameters(sketch)
    parameter, value = parameters["height.smoothing"]
    assert (parameter.type, value) == ("float", pytest.approx(0.2))
    changed = sketch.with_values({"height.smoothing": 0.7})
    assert playground.parameters(changed)["height.smoothing"][1] == pytest.approx(0.7)
    assert playground.parameters(sketch)["height.smoothing"][1] == pytest.approx(0.2)
    with pytest.raises(playground.ParameterError, match="smoothing"):
        sketch.with_values({"height.smothing": 0.7})
    with pytest.raises(playground.ParameterError, match="range"):
        sketch.with_values({"height.smoothing": 7})


def test_a_repeated_kernel_is_run_step_by_step(sketch: playground.Sketch):
    small = sketch.with_values({"size": 5})
    with playground.headless() as engine:
        steps = list(engine.steps(small, _repeated(engine, small)))
    assert [step for step, _ in steps] == [0, 1, 2, 3, 4, 5]
    assert [int(np.count_nonzero(values)) for _, values in steps] == [0, 4, 5, 9, 13, 25]


def _repeated(engine: playground.Engine, sketch: playground.Sketch) -> str:
    plan = engine.plan(sketch, (64, 64))
    return next(step.path for step in plan.walk() if step.kernel.repeat != "1")


@pytest.mark.slow
def test_one_call_renders_a_shipped_sketch():
    frame = playground.render("jacksboro", size=(96, 54), values={"size": 65})
    assert frame.array[..., :3].std() > 5
    assert (frame.array[..., 3] == 255).all()


# ── what a program may get wrong ─────────────────────────────────────────────


@pytest.mark.parametrize(
    ("value", "sentence"),
    [
        ({"size": (64.5, 36)}, r"size \(64.5, 36\): expected two whole numbers"),
        ({"size": 64}, "size 64: expected two whole numbers"),
        ({"size": "ab"}, "size 'ab': expected two whole numbers"),
        ({"size": (64, 36, 3)}, "expected two whole numbers"),
        ({"size": (True, 36)}, "expected two whole numbers"),
        ({"size": (0, 36)}, "a picture of 0 x 36 pixels; 1 to 16384"),
        ({"time": float("nan")}, "time nan: expected a number of seconds"),
        ({"time": float("inf")}, "time inf: expected a number of seconds"),
        ({"time": "noon"}, "time 'noon': expected a number of seconds"),
        (
            {"steps": {"height.raw": 1.5}},
            "'height.raw' stops after 1.5 steps; expected a whole number from 0",
        ),
        ({"steps": {"height.raw": -1}}, "'height.raw' stops after -1 steps; expected a whole number from 0"),
    ],
)
def test_a_wrong_argument_is_refused_in_a_sentence(engine, sketch, value, sentence):
    with pytest.raises(playground.PlaygroundError, match=sentence):
        engine.render(sketch, **{"size": (64, 36), **value})


def test_numbers_of_numpy_will_do(any_engine, sketch):
    frame = any_engine.render(sketch, size=np.array([64, 36]), time=np.float32(0.5))
    assert frame.array.shape == (36, 64, 4)


@pytest.mark.slow
def test_a_sketch_may_be_named_to_an_engine(any_engine):
    by_name = any_engine.read("diamond_square", "height")
    np.testing.assert_array_equal(any_engine.read(playground.load("diamond_square"), "height"), by_name)
    assert any_engine.render("diamond_square", size=(32, 18)).sketch == "diamond_square"
    with pytest.raises(playground.SketchError, match="by its name or its path, not by 5"):
        playground.load(5)  # type: ignore[arg-type]
    with pytest.raises(playground.SketchError, match="by its name or its path, not by 5"):
        any_engine.render(5)


def test_a_released_engine_says_so(sketch):
    engine = playground.headless()
    engine.render(sketch, size=(32, 18))
    engine.release()
    engine.release()
    for use in (
        lambda: engine.render(sketch),
        lambda: engine.read(sketch, "height"),
        lambda: list(engine.steps(sketch, "height")),
        lambda: engine.__enter__(),
    ):
        with pytest.raises(playground.ContextError, match="this engine was released"):
            use()


# ── step by step ─────────────────────────────────────────────────────────────


def test_single_repeated_pass_is_addressed_by_technique_name(engine, sketch):
    small = sketch.with_values({"size": 5})
    by_name = list(engine.steps(small, "height"))
    by_path = list(engine.steps(small, "height.raw"))
    assert [step for step, _ in by_name] == [0, 1, 2, 3, 4, 5]
    for (_, first), (_, other) in zip(by_name, by_path, strict=True):
        np.testing.assert_array_equal(first, other)
    stopped = engine.read(small, "height.raw", steps={"height": 2})
    np.testing.assert_array_equal(stopped, by_path[2][1])


def test_non_repeating_pass_is_refused_listing_repeated_ones(engine, sketch):
    for path in ("height.normalised", "view", "nothing"):
        with pytest.raises(playground.SketchError, match=rf"no repeated pass '{path}' .*height\.raw"):
            list(engine.steps(sketch, path))
    with pytest.raises(playground.SketchError, match=r"did you mean 'height\.raw'"):
        engine.render(sketch, steps={"height.rwa": 1})


def test_the_package_s_own_example_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert playground.__doc__ is not None
    rest = playground.__doc__.partition("\n\n")[2]
    example = textwrap.dedent(rest.partition("\n\nA sketch is")[0]).replace("(1280, 720)", "(64, 36)")
    names: dict[str, object] = {}
    exec(compile(example, "playground", "exec"), names)
    assert (tmp_path / "terrain.png").is_file()
    assert names["step"] == 1 + 2 * 9, "the corners, then two steps for each halving of 512 spacings"
