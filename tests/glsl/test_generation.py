"""What holds for every technique that makes terrain, whatever it is: found in the folder, not listed here."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.engine.planner import repeats_of
from playground.errors import PlaygroundError
from playground.sketch.assign import shown_parameters, value_of, values_of
from playground.sketch.find import is_part
from playground.sketch.model import Parameter, Sketch, Value
from playground.sketch.wiring import input_names, is_optional, output_names

from ..loading import library, load

NEEDS_A_FILE = {"generation/heightmap"}
MADE = [
    name
    for name in library()
    if name.startswith("generation/") and name not in NEEDS_A_FILE and not is_part(name)
]
SIZES = [(1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (33, 33), (2, 9), (13, 6)]


def outputs(name: str) -> list[str]:
    return list(output_names(library()[name]))


@pytest.fixture
def sketch_of(tmp_path) -> Callable[..., Sketch]:
    numbers = iter(range(1_000_000))

    def make(name: str, size: tuple[int, int] = (33, 33)) -> Sketch:
        result = library()[name]
        expected = [input_name for input_name in input_names(result) if not is_optional(result, input_name)]
        feeds = "".join(
            f'[[pass]]\nname = "feed_{i}"\nuse = "generation/white_noise"\nset = {{ seed = {i} }}\n'
            for i in range(len(expected))
        )
        wires = ", ".join(f'{item} = "feed_{i}"' for i, item in enumerate(expected))
        path = tmp_path / f"sketch_{next(numbers)}.toml"
        path.write_text(
            f"format = 1\nsize = {list(size)}\nextent = 1000.0\n{feeds}"
            f'[[pass]]\nname = "a"\nuse = "{name}"\ninputs = {{ {wires} }}\n'
        )
        return load(path)

    return make


def taken(any_engine: Engine, sketch: Sketch, name: str) -> dict[str, np.ndarray] | None:
    """Return every output; None where the technique does not take the size, and says which it takes."""
    try:
        return {output: any_engine.read(sketch, f"a:{output}").copy() for output in outputs(name)}
    except PlaygroundError as error:
        assert "the nearest it takes" in str(error), str(error)
        return None


def fitting(any_engine: Engine, sketch_of: Callable[..., Sketch], name: str) -> Sketch:
    for size in ((33, 33), (32, 32)):
        sketch = sketch_of(name, size)
        if taken(any_engine, sketch, name) is not None:
            return sketch
    raise AssertionError(f"{name} takes neither 33 nor 32 texels a side")


def parameters(sketch: Sketch) -> dict[str, Parameter]:
    """Return the parameters that a technique shows, by path."""
    return {s.path: s.parameter for s in shown_parameters(sketch) if s.exported and s.path.startswith("a.")}


def extremes(parameter: Parameter) -> Iterator[Value]:
    widget = parameter.widget
    if widget.kind == "menu":
        yield from range(len(widget.choices))
    elif parameter.type == "bool":
        yield from (False, True)
    elif widget.low is not None and widget.high is not None:
        whole = parameter.type[0] in "iu"
        for end in (widget.low, widget.high):
            number = int(end) if whole else float(end)
            count = len(parameter.default) if isinstance(parameter.default, tuple) else 0
            yield (number,) * count if count else number


def looks_normalised(sketch: Sketch, values: dict[str, np.ndarray]) -> bool:
    if "a.normalise" not in parameters(sketch) or "height" not in values:
        return False
    return value_of(sketch, "a.normalise", values_of(sketch)) == 2


def assert_good(sketch: Sketch, values: dict[str, np.ndarray], what: str) -> None:
    for output, array in values.items():
        assert np.isfinite(array).all(), f"{what}: {output} holds what is no number"
    if looks_normalised(sketch, values):
        low, high = values["height"].min(), values["height"].max()
        assert (low, high) in ((0.0, 1.0), (0.0, 0.0)), f"{what}: heights from {low} to {high}"


ONE_HAS_NO_STEP = "generation/first_height"
"""The first lesson's kernel: it divides by ``size - 1``, and its readers have not met ``max``."""


@pytest.mark.parametrize("name", MADE)
def test_every_size_is_taken_or_refused_with_those_nearest(any_engine, sketch_of, name):
    accepted = 0
    for size in SIZES:
        if name == ONE_HAS_NO_STEP and 1 in (size if isinstance(size, tuple) else (size,)):
            continue
        sketch = sketch_of(name, size)
        values = taken(any_engine, sketch, name)
        if values is not None:
            accepted += 1
            assert_good(sketch, values, f"{name} at {size}")
    assert accepted >= 2


@pytest.mark.parametrize("name", MADE)
def test_every_parameter_may_go_to_its_ends(any_engine, sketch_of, name):
    sketch = fitting(any_engine, sketch_of, name)
    for path, parameter in parameters(sketch).items():
        for value in extremes(parameter):
            changed = sketch.with_values({path: value})
            values = taken(any_engine, changed, name)
            if path == "a.normalise":
                assert values is not None and all(np.isfinite(v).all() for v in values.values())
            elif values is not None:
                assert_good(changed, values, f"{name} with {path} = {value}")


@pytest.mark.parametrize("name", MADE)
def test_every_parameter_may_go_to_its_ends_with_all_others(any_engine, sketch_of, name):
    sketch = fitting(any_engine, sketch_of, name)
    for end in (0, -1):
        ends = {p: list(extremes(q))[end] for p, q in parameters(sketch).items() if list(extremes(q))}
        ends.pop("a.normalise", None)
        changed = sketch.with_values(ends)
        values = taken(any_engine, changed, name)
        if values is not None:
            assert_good(changed, values, f"{name} with {ends}")


@pytest.mark.parametrize("name", MADE)
def test_a_seed_names_one_terrain(ctx, any_engine, sketch_of, name):
    sketch = fitting(any_engine, sketch_of, name)
    first = taken(any_engine, sketch, name)
    with Engine(ctx) as another:
        again = taken(another, sketch, name)
    assert first is not None and again is not None
    for output in first:
        np.testing.assert_array_equal(first[output], again[output])
    seeds = [path for path in parameters(sketch) if path.endswith("seed")]
    for path in seeds:
        other = taken(any_engine, sketch.with_values({path: 1234}), name)
        assert other is not None
        assert not np.array_equal(other[outputs(name)[0]], first[outputs(name)[0]]), path


@pytest.mark.parametrize("name", MADE)
def test_every_repeat_can_be_stopped_at_every_turn(any_engine, sketch_of, name):
    sketch = fitting(any_engine, sketch_of, name)
    repeats = {path: whole for path, whole in repeats_of(sketch).items() if path.startswith("a")}
    for path, whole in repeats.items():
        last = any_engine.read(sketch, path).copy()
        for turn in sorted({0, 1, whole // 2, max(whole - 1, 0), whole}):
            state = any_engine.read(sketch, path, steps={path: turn})
            assert np.isfinite(state).all()
            if turn == whole:
                np.testing.assert_array_equal(state, last)
