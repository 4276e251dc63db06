"""A plan of which only values changed is made of the one before, and says what one made from nothing says."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from playground.data.values import write_values
from playground.engine import planner as planner_module
from playground.engine.cache import Cache
from playground.engine.engine import Engine
from playground.engine.plan import Plan, PlanRequest, every_node
from playground.engine.planner import make_plan, planned
from playground.errors import DataError
from playground.sketch.assign import resolve, shown_parameters
from playground.sketch.model import Sketch, Value

from ..loading import load
from ..plans import plans_made_whole

SIZE = (64, 36)
SKETCHES = (
    "jacksboro",
    "mixed",
    "fault_formation",
    "splat_many",
    "diamond_square_steps",
    "sun_flight",
    "delaunay",
)


def facts_of(plan: Plan) -> list[object]:
    """Return all that a plan says; matrices by their numbers."""
    eye = plan.eye.clip_from_world.tolist(), plan.eye.position, plan.eye.target
    return [
        plan.sketch,
        list(every_node(plan.nodes)),
        plan.terrain,
        eye,
        plan.frame_size,
        plan.time,
        plan.lacking,
    ]


def other_values(sketch: Sketch) -> list[tuple[str, Value]]:
    """Return a value for each parameter with a range or choices, other than its default."""
    result: list[tuple[str, Value]] = []
    for shown in shown_parameters(sketch):
        parameter, widget = shown.parameter, shown.parameter.widget
        if parameter.name == "packing":
            continue  # another than the file has
        if parameter.type == "bool":
            result.append((shown.path, not parameter.default))
        elif widget.kind == "menu":
            result.append((shown.path, (int(parameter.default) + 1) % len(widget.choices)))  # type: ignore[arg-type]
        elif (
            parameter.type in ("float", "int", "uint") and widget.high is not None and widget.low is not None
        ):
            middle = (widget.low + widget.high) / 2
            result.append((shown.path, middle if parameter.type == "float" else int(middle)))
    return result


@pytest.fixture
def wholes(monkeypatch) -> list[Sketch]:
    """Give the sketches whose plans were made from nothing."""
    return plans_made_whole(monkeypatch)


def plan_of(sketch: Sketch, time: float = 0.0) -> Plan:
    return planned(sketch, PlanRequest(SIZE, time))


@pytest.mark.parametrize("name", SKETCHES)
def test_a_renewed_plan_is_the_one_made_from_nothing(name, wholes):
    sketch = load(name)
    plan_of(sketch)
    for number, (path, value) in enumerate(other_values(sketch)[:40]):
        changed = sketch.with_values({path: value})
        time = 0.5 * (number % 3)
        from_nothing = make_plan(changed, PlanRequest(SIZE, time))
        assert facts_of(plan_of(changed, time)) == facts_of(from_nothing), path
    assert len(wholes) <= 1 + 2 * number, "some were renewed"


@pytest.mark.slow
def test_a_slider_that_no_size_names_plans_no_pass(monkeypatch, wholes):
    nodes: Counter[str] = Counter()
    plan_node = planner_module._Planning._node

    def counting(self, node):
        nodes[node.path] += 1
        return plan_node(self, node)

    monkeypatch.setattr(planner_module._Planning, "_node", counting)
    sketch = load("")
    first = plan_of(sketch)
    assert set(nodes) == {step.path for step in first.walk()} and max(nodes.values()) == 1
    nodes.clear()
    for azimuth in range(20):
        second = plan_of(sketch.with_values({"light.sun": (100.0 + azimuth, 20.0)}))
    assert not nodes and len(wholes) == 1
    moved = {
        step.path for step, before in zip(second.walk(), first.walk(), strict=True) if step is not before
    }
    sun = {target.path.rpartition(".")[0] for target in resolve(sketch.graph, "light.sun")}
    assert moved == sun, "only passes that have the value are other ones"


def test_a_value_that_a_count_names_plans_anew(wholes):
    sketch = load("fault_formation")
    first = plan_of(sketch)
    counts = [path for path in first.basis.named if path.startswith("height.")]
    assert counts, "its number of faults is the number of its steps"
    for path in counts:
        more = sketch.with_values({path: 7})
        plan = plan_of(more)
        assert facts_of(plan) == facts_of(make_plan(more, PlanRequest(SIZE))) != facts_of(first)
    assert len(wholes) == 1 + 2 * len(counts)


def test_another_file_of_the_terrain_plans_anew(tmp_path):

    def rise(side: int) -> None:
        write_values(
            tmp_path / "rise.npy", np.linspace(0, 1, side * side, dtype=np.float32).reshape(side, side)
        )

    rise(9)
    (tmp_path / "sketch.toml").write_text(
        'format = 1\n[[pass]]\nname = "height"\n'
        'use = "generation/heightmap"\nset = { elevation = "rise.npy" }\n'
    )
    sketch = load(tmp_path)
    assert plan_of(sketch).terrain.size == (9, 9)
    rise(17)
    assert plan_of(sketch).terrain.size == (17, 17)
    Path(tmp_path / "rise.npy").unlink()
    with pytest.raises(DataError, match="there is no such file"):
        plan_of(sketch)


@pytest.mark.slow
def test_what_is_used_is_weighed_twice_a_frame_at_most(ctx, monkeypatch):
    weighed: Counter[str] = Counter()
    weigh = Cache._weigh

    def counting(self, key):
        weighed[key] += 1
        weigh(self, key)

    sketch = load("")
    with Engine(ctx) as engine:
        engine.render(sketch, size=SIZE)
        monkeypatch.setattr(Cache, "_weigh", counting)
        engine.render(sketch.with_values({"light.sun": (130.0, 20.0)}), size=SIZE)
        passes = len(list(engine.record.plan.walk()))
        # What ran is weighed as it is put away as well, once more where something stood under its key.
        assert sum(weighed.values()) <= passes + 2 * len(engine.record.ran)
        weighed.clear()
        engine.render(sketch.with_values({"light.sun": (130.0, 20.0)}), size=SIZE)
        assert engine.record.ran == [] and sum(weighed.values()) <= passes
