"""Every shipped sketch is written down: as JSON's own types, with texts that are the engine's."""

from __future__ import annotations

import gzip
import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from playground.engine.engine import Engine
from playground.engine.plan import LoopStep, Plan, PlanRequest
from playground.engine.planner import make_plan
from playground.paths import GLSL
from playground.publish.web.page import page_text
from playground.publish.web.page_data import page_data
from playground.publish.web.plan import KINDS
from playground.shader import expressions
from playground.shader.common_glsl import in_common_glsl
from playground.shader.wrap import FRAGMENT, wrap
from playground.sketch.model import PlainFragment, Sketch

from ...foreign_cases import EVERY, Case
from ...loading import load
from ...shipped import EACH_KIND, of_each_kind, slow_but
from .node import Node

STAGES = """async (shared, kernels, load) => {
    const { flatten } = await load("source.js"), { stageText } = await load("kernel_texts.js");
    return kernels.map(({ kernel, stage, file }) => stageText(stage, flatten(shared, file)));
}"""


ORDINARY = 96 * 1024  # [bytes] of a page's plan and texts, compressed
WHOLE_SCENES = {"alpine", "coast", "desert", "gullies", "lake", "october", "sky"}
"""Land or its sky outdoors, with what makes it: two ordinary pages, the view's and that of the rest."""

Written = Callable[[str], dict[str, Any]]


@cache
def shipped(name: str) -> Sketch:
    return load(name)


@pytest.fixture(scope="module")
def written(exporting: Engine) -> Written:
    """Return a function that gives the page of a sketch, which is written once."""
    return cache(lambda name: page_data([shipped(name)], frame=(320, 180), engine=exporting))


@cache
def planned(name: str) -> Plan:
    return plan_of(shipped(name))


def plan_of(sketch: Sketch) -> Plan:
    return make_plan(sketch, PlanRequest(frame_size=(320, 180), variants=KINDS))


@pytest.mark.parametrize("name", EACH_KIND)
def test_it_is_json_and_says_nothing_of_this_machine(name: str, written: Written):
    page = written(name)
    text = json.dumps(page, allow_nan=False)
    assert json.dumps(json.loads(text)) == text
    for folder in (GLSL, Path.home(), Path.cwd()):
        assert str(folder) not in text


@pytest.mark.parametrize("name", slow_but(sorted({*of_each_kind(), *WHOLE_SCENES})))
def test_its_plan_and_its_texts_are_small(name: str, written: Written):
    text = page_text(written(name))
    assert len(gzip.compress(text.encode(), 9)) < (2 if name in WHOLE_SCENES else 1) * ORDINARY


@pytest.mark.parametrize("name", EACH_KIND)
def test_a_page_makes_the_engines_own_stages(node: Node, name: str, written: Written):
    check_stages(node, written(name), planned(name))


def check_stages(node: Node, page: dict[str, Any], plan: Plan) -> None:
    [sketch] = page["sketches"]
    of = {leaf["path"]: sketch["kernels"][leaf["kernel"]] for leaf in leaves(sketch["nodes"])}
    asked, expected = [], []
    for step in plan.walk():
        kernel = of[step.path]
        if step.kernel.kind == "source":
            continue
        for stage, made in wrap(step.kernel, FRAGMENT).stages.items():
            data = kernel[stage]
            asked.append({"stage": data, "file": data.get("file", kernel["file"])})
            text = in_common_glsl(made.text) if isinstance(step.kernel, PlainFragment) else made.text
            expected.append((text.rstrip().splitlines(), made.first))
    for stage, (lines, first) in zip(node.run(STAGES, page["shared"], asked), expected, strict=True):
        assert stage["first"] == first
        assert [*map(str.rstrip, stage["text"].rstrip().splitlines())] == [*map(str.rstrip, lines)]


@pytest.mark.room("dialects")
@pytest.mark.parametrize("case", [case for case in EVERY if case.family != "shadertoy"], ids=str)
def test_a_page_makes_the_stages_of_other_tools_shaders(node: Node, tmp_path: Path, case: Case):
    folder = tmp_path / "here"
    folder.mkdir()
    sketch = load(case.write(folder))
    page = page_data([sketch])
    assert str(tmp_path) not in json.dumps(page)
    check_stages(node, page, plan_of(sketch))


def leaves(nodes: list[dict[str, Any]]) -> list[dict[str, Any]]:
    values = []
    for node in nodes:
        values += leaves(node["body"]) if "body" in node else [node]
    return values


class Numbers:
    """What names of formulas stand for in a plan, and formulas evaluated, slowly."""

    def __init__(self, plan: Any, sketch: dict[str, Any]) -> None:
        self.plan, self.sketch = plan, sketch

    def size(self, size: str | list[int]) -> tuple[int, int]:
        """Return a size from nothing but the data."""
        if not isinstance(size, str):
            return size[0], size[1]
        if size[0] == "#":
            base = self.plan.terrain.size if size == "#terrain" else self.plan.frame_size
            assert base
            return base
        x, y = (self.whole(formula) for formula in self.sketch["passes"][size]["size"])
        return x, y

    def whole(self, formula: Any) -> int:
        """Return what a formula gives: put into names, and the rest is Python's evaluation of its text."""
        names: dict[str, Any] = {}
        text = self.text(formula, names)
        return expressions.evaluate(text, names)

    def text(self, formula: Any, names: dict[str, Any]) -> str:
        """Return a formula as an expression again, its absolute names as names of ``names``."""
        if not isinstance(formula, list):
            return str(formula) if not isinstance(formula, str) else self.clock(formula, names)
        kind, *of = formula
        if kind in ("text", "last", "before"):  # of what a loop feeds back, the iteration before
            return self.text(of[-1], names)
        if kind in ("size", "value"):
            name = f"n{len(names)}"
            names[name] = self.size(of[0])[of[1]] if kind == "size" else self.sketch["values"][of[0]]
            return name
        if kind in ("iteration", "iterations"):  # of what a plan gives, the last
            return str(max(self.plan.node(of[0]).total, 1) - (kind == "iteration"))
        parts = [f"({self.text(part, names)})" for part in of]
        if kind == "if":
            return f"{parts[1]} if {parts[0]} else {parts[2]}"
        if kind.isidentifier() or kind == "log2":
            return f"{kind}({', '.join(parts)})"
        return f"{parts[0]} {kind} {parts[1]}"

    def clock(self, name: str, names: dict[str, Any]) -> str:
        names |= {"time": self.plan.time, "frames": expressions.frames_at(self.plan.time)}
        return name


@pytest.mark.parametrize("name", EACH_KIND)
def test_sizes_and_counts_that_the_data_give_are_the_plans(name: str, written: Written):
    [sketch] = written(name)["sketches"]
    plan = planned(name)
    numbers = Numbers(plan, sketch)
    loops: dict[str, Any] = {}

    def look(nodes: list[dict[str, Any]]) -> None:
        for node in nodes:
            if "body" in node:
                loops[node["path"]] = sketch["passes"][node["path"]]["repeat"]
                look(node["body"])

    look(sketch["nodes"])
    sizes = {leaf["path"]: leaf["size"] for leaf in leaves(sketch["nodes"])}
    for step in plan.walk():
        assert numbers.size(sizes[step.path]) == step.size
    for node in plan.nodes:
        if isinstance(node, LoopStep):
            assert numbers.whole(loops[node.path]) == node.total
    assert sketch["picture"] == {"path": plan.picture.path, "output": plan.picture.output}


@pytest.mark.parametrize("name", EACH_KIND)
def test_values_are_those_that_the_engine_gives(name: str, written: Written):
    """Before keyframes and what follows: those the page works out by itself."""
    [sketch], images = written(name)["sketches"], written(name)["shared"]["images"]
    plan = planned(name)
    set_elsewhere = {path for track in sketch["tracks"] for path in track["targets"]}
    set_elsewhere |= {path for rule in sketch["rules"] for path in rule["targets"]}
    steps = {step.path: step for step in plan.walk()}
    for leaf in leaves(sketch["nodes"]):
        step = steps[leaf["path"]]
        assert leaf["values"].keys() == step.values.keys()
        for parameter in step.kernel.parameters:
            path = leaf["values"][parameter.name]
            value = sketch["values"][path]
            if path in set_elsewhere:
                continue
            if parameter.widget.kind == "file":
                assert value in images or step.kernel.kind == "source"
            else:
                assert parameter.widget.uniform_value(value) == step.values[parameter.name]
