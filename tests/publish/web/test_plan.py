"""A page plans a sketch as the engine does: sizes, counts, values, order, what is stale, mistakes."""

from __future__ import annotations

import random
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from playground.engine.cache_keys import KeyMaker, Keys
from playground.engine.plan import LoopStep, Plan, PlanNode, PlanRequest, Step, every_node, needed
from playground.engine.planner import make_plan
from playground.errors import PlaygroundError
from playground.publish.web import texts
from playground.publish.web.blobs import Blobs
from playground.publish.web.plan import KINDS, _Writing, sketch_data
from playground.publish.web.shared_data import SharedData
from playground.sketch.map_sketch import Map
from playground.sketch.model import Camera, Kernel, Sketch

from ...loading import load
from ...shipped import SHIPPED
from ...sketch_texts import map_of, passes
from .node import Node
from .random_settings import Settings, random_settings

SETTINGS = 3
ASK = """async (sketch, states, load) => {
    const { makePlan } = await load("plan.js");
    const flat = (node) => node.loop
        ? [["loop", node.path, node.repeat, node.total, node.countsFrames], ...node.body.flatMap(flat)]
        : [[node.kernel.name, node.path, node.repeat, node.total, node.size,
            node.between && Object.values(node.between), node.values]];
    return states.map((state) => {
        try {
            const plan = makePlan(sketch, state), { eye, target, distance } = plan.eye;
            return { nodes: plan.nodes.flatMap(flat), eye: [...eye, ...target, distance],
                     terrain: Object.values(plan.terrain).flat() };
        } catch (error) {
            return `${error.name}: ${error.message}`;
        }
    });
}"""


STALE = """async (sketch, states, known, load) => {
    const [{ makePlan }, { keysOf }] = [await load("plan.js"), await load("staleness.js")];
    const { usedBy } = await load("staleness.js"), { stepsOf } = await load("plan_nodes.js");
    const every = (nodes) => nodes.flatMap((node) => (node.loop ? [node, ...every(node.body)] : [node]));
    const used = Object.fromEntries(Object.entries(known).map(([path, { code, names }]) => {
        const kernel = sketch.kernels[stepsOf(sketch.nodes).find((leaf) => leaf.path === path).kernel];
        return [path, usedBy(kernel, code, names)];
    }));
    const pathOf = new Map(stepsOf(sketch.nodes).map((leaf) => [sketch.kernels[leaf.kernel], leaf.path]));
    const keys = states.map((state) => {
        const plan = makePlan(sketch, state), { eye, target, distance } = plan.eye;
        const camera = [eye, target, distance, plan.frame];
        const all = { ...plan.terrain, time: plan.time, eye };
        all.clip_from_world = all.world_from_clip = camera;
        const found = keysOf(plan, {
            text: (kernel) => known[pathOf.get(kernel)].text,
            used: (kernel) => used[pathOf.get(kernel)],
            given: (step) => {
                const given = Object.fromEntries(known[step.path].given.map((name) => [name, all[name]]));
                if ("spacing" in given) given.spacing = [plan.terrain.extent, step.size];
                return given;
            },
        });
        const changes = every(plan.nodes).map((node) => [node.path, [...found.changes.get(node)].sort()]);
        return { ...found, changes };
    });
    return { keys, used };
}"""


@pytest.fixture(scope="module")
def shared() -> Iterator[SharedData]:
    """Give what all sketches share, without texels: a plan needs none."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(texts, "_is_as_written", lambda *_: True)
        patch.setattr(Blobs, "add", lambda *_: "texels")
        patch.setattr(_Writing, "_drawn", lambda *_: defaultdict(lambda: np.zeros((1, 1), np.float32)))
        patch.setattr("playground.publish.web.shared_data._lossless", lambda _: b"")
        yield SharedData()


_WRITTEN: dict[str, dict[str, Any]] = {}


def exported(sketch: Sketch, shared: SharedData) -> dict[str, Any]:
    if sketch.name not in _WRITTEN:
        _WRITTEN[sketch.name] = sketch_data(sketch, shared)
    return _WRITTEN[sketch.name]


def python(sketch: Sketch, settings: Settings) -> Plan | str:
    try:
        return make_plan(
            settings.of(sketch),
            PlanRequest(
                frame_size=settings.frame,
                time=settings.time,
                steps=settings.steps,
                variants=KINDS,
                interpolated=True,
            ),
        )
    except PlaygroundError as error:
        return f"PlanError: {error.diagnostics[0].message}"


def flat(node: PlanNode) -> list[list[Any]]:
    if isinstance(node, LoopStep):
        inside = [item for each in node.body for item in flat(each)]
        return [["loop", node.path, node.repeat, node.total, node.counts_frames], *inside]
    between = list(node.between) if node.between else None
    files = {p.name for p in node.kernel.parameters if p.widget.kind == "file"}
    values = {name: _as_json(value) for name, value in node.values.items() if name not in files}
    return [[node.kernel.name, node.path, node.repeat, node.total, list(node.size), between, values]]


def _as_json(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value


@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_sketch_is_planned_as_the_engine_plans_it(node: Node, shared: SharedData, name: str):
    sketch = load(name)
    data = exported(sketch, shared)
    chance = random.Random(name)
    first = python(sketch, Settings())
    assert isinstance(first, Plan)
    several = [Settings(), *(random_settings(chance, data, first) for _ in range(SETTINGS))]
    answers = node.run(ASK, data, [settings.state(data) for settings in several])
    for settings, answer in zip(several, answers, strict=True):
        expected = python(sketch, settings)
        if isinstance(expected, str):
            assert answer == expected, settings
            continue
        assert not isinstance(answer, str), (answer, settings)
        nodes = [item for each in expected.nodes for item in flat(each)]
        assert [item[:2] for item in answer["nodes"]] == [node[:2] for node in nodes]
        for left, other in zip(answer["nodes"], nodes, strict=True):
            values = {name: left[-1][name] for name in other[-1]} if len(left) > 5 else left[-1]
            assert [*left[:-1], values] == other, settings
        metres = [*expected.terrain.size, *expected.terrain.extent, expected.terrain.relief]
        assert answer["terrain"] == [*metres, expected.terrain.base_elevation]
        eye = [*expected.eye.position, *expected.eye.target, expected.eye.distance]
        np.testing.assert_allclose(answer["eye"], eye, rtol=1e-12, atol=1e-8)


def given(plan: Plan, step: Step) -> dict[str, Any]:
    """Return what an engine gives a step, as far as that takes no window: see ``Runner.given_for``."""
    eye, terrain = plan.eye, plan.terrain
    all_of_it = {
        "time": plan.time,
        "extent": terrain.extent,
        "relief": terrain.relief,
        "base_elevation": terrain.base_elevation,
        "clip_from_world": eye.clip_from_world.tolist(),
        "world_from_clip": eye.world_from_clip.tolist(),
        "eye": eye.position,
        "spacing": (terrain.extent, step.size),
    }
    return {name: all_of_it[name] for name in names_given(step.kernel)}


def names_given(kernel: Kernel) -> list[str]:
    return [
        name
        for name in kernel.engine_uniforms
        if name not in ("size", "iteration", "iterations", "stage", "until")
    ]


def classes(keys: list[dict[str, dict[str, str]]]) -> list[list[tuple[str, int]]]:
    """Return which keys of several plans are equal: for each plan and path the number of its class."""
    numbers: dict[str, int] = {}
    return [
        [
            (f"{kind} {path}", numbers.setdefault(f"{kind} {key}", len(numbers)))
            for kind in ("steps", "raw", "unfinished", "loops")
            for path, key in sorted(result[kind].items())
        ]
        for result in keys
    ]


def hashes_of(keys: Keys) -> dict[str, dict[str, str]]:
    """Return the engine's keys by kind, as a page names them."""
    steps = keys.steps.items()
    return {
        "steps": {path: key.result for path, key in steps},
        "raw": {path: key.computed for path, key in steps},
        "unfinished": {path: key.unfinished for path, key in steps},
        "loops": keys.loops,
    }


def neighbours(
    chance: random.Random, settings: Settings, data: dict[str, Any], first: Plan
) -> list[Settings]:
    """Return settings that differ from some in one thing each, then the same again."""
    result = [replace(settings, values={path: value}) for path, value in list(settings.values.items())[:2]]
    result += [replace(settings, time=settings.time + 0.25), replace(settings, frame=(40, 30))]
    result += [replace(settings, camera=Camera(10.0)), replace(settings, steps={}), replace(settings)]
    return [*result, replace(settings, steps=random_settings(chance, data, first).steps)]


def stale_as_in_the_engine(node: Node, shared: SharedData, sketch: Sketch, target: list[Settings]) -> Keys:
    """Compare what changes between plans for some settings; return the engine's keys of the first."""
    data = exported(sketch, shared)
    first = python(sketch, Settings())
    assert isinstance(first, Plan)
    several, plans = [], []
    for each in target:
        if isinstance(plan := python(sketch, each), Plan):
            several.append(each)
            plans.append(plan)
    maker = KeyMaker()
    expected = [maker.keys_of(plan, lambda _: "fragment", partial(given, plan)) for plan in plans]
    existing = {
        step.path: {
            "text": maker.text_of(step.kernel).digest,
            "code": step.kernel.source.code,
            "names": [*names_given(step.kernel), "iteration", "iterations"],
            "given": names_given(step.kernel),
        }
        for step in first.walk()
    }
    result = node.run(STALE, data, [each.state(data) for each in several], existing)
    assert classes(result["keys"]) == classes([hashes_of(keys) for keys in expected])
    for keys, plan, answer in zip(expected, plans, result["keys"], strict=True):
        changes = [[node.path, sorted(keys.changes[id(node)])] for node in every_node(plan.nodes)]
        assert answer["changes"] == changes
    for step in first.walk():
        text = maker.text_of(step.kernel)
        parameters = {p.name for p in step.kernel.parameters}
        assert result["used"][step.path] & parameters == text.used & parameters, step.path
    return expected[0]


@pytest.mark.parametrize("name", SHIPPED)
def test_what_is_stale_in_a_page_is_what_is_stale_in_the_engine(node: Node, shared: SharedData, name: str):
    sketch = load(name)
    data = exported(sketch, shared)
    chance = random.Random(f"{name} stale")
    first = python(sketch, Settings())
    assert isinstance(first, Plan)
    settings = replace(random_settings(chance, data, first), terrain={})
    stale_as_in_the_engine(node, shared, sketch, [settings, *neighbours(chance, settings, data, first)])


SEED = """#pragma kernel(output = "seed:r32f")
uniform float level = 0.5;  //! slider(0, 2)
float kernel(ivec2 texel) { return level * time; }
"""
FLOW = """#pragma kernel(output = "flow:r32f")
uniform sampler2D water;     //! input("zero")
uniform sampler2D rough;     //! input
uniform bool drop = false;   //! button
uniform float rate = 0.5;    //! slider(0, 1)
float kernel(ivec2 texel) {
    float now = texelFetch(water, texel, 0).r + rate * texelFetch(rough, texel, 0).r;
    return drop ? 0.0 : now + time + 0.01 * float(iteration) + float(iterations);
}
"""
COUNT = """#pragma kernel(output = "count:r32f")
float kernel(ivec2 texel) { return float(iteration); }
"""
FLOWS = passes(count="./count", flow=("./flow", 'inputs = { rough = "count" }')) + (
    '[parameters]\ndrop = ["flow.drop"]\nrate = ["flow.rate"]\n[inputs]\nwater = ["flow.water"]\n'
    '[outputs]\nwater = "flow:flow"\n'
)
LOOP = """format = 1
size = 9
[[pass]]
name = "seed"
use = "./seed"
[[pass]]
name = "flow"
use = "./flow"
inputs = { rough = "seed" }
repeat = "REPEAT"
feedback = { water = "flow" }
[[pass]]
name = "both"
use = "./flows"
repeat = "REPEAT"
feedback = { water = "water" }
"""


@pytest.mark.parametrize("repeat", ["frames", "7", "frames + 2"])
def test_loops_change_with_what_theirs_are(node: Node, shared: SharedData, tmp_path: Path, repeat: str):
    (tmp_path / "seed.glsl").write_text(SEED)
    (tmp_path / "flow.glsl").write_text(FLOW)
    (tmp_path / "count.glsl").write_text(COUNT)
    (tmp_path / "flows.toml").write_text(FLOWS)
    (tmp_path / "loop.toml").write_text(LOOP.replace("REPEAT", repeat) + map_of("both"))
    sketch = replace(load(tmp_path / "loop.toml"), name=f"loop {repeat}")
    several = [
        Settings(),
        Settings(time=0.5),
        Settings(values={"flow.drop": True}),
        Settings(values={"flow.drop": True}, time=0.5),
        Settings(values={"flow.rate": 0.25}),
        Settings(values={"both.rate": 0.25}),
        Settings(values={"seed.level": 0.25}),
        Settings(steps={"flow": 1}, time=0.5),
        Settings(frame=(3, 3)),
    ]
    keys = stale_as_in_the_engine(node, shared, sketch, several)
    assert any(keys.changes.values()), "something changes with the loop"


INCREMENTAL = """async (sketch, first, second, load) => {
    const { makePlan } = await load("plan.js");
    const before = makePlan(sketch, first), after = makePlan(sketch, second);
    const other = [...after.steps].filter(([path, step]) => before.steps.get(path) !== step);
    return { other: other.map(([path]) => path), nodes: before.nodes === after.nodes };
}"""


def test_a_moved_camera_leaves_every_step_as_it_is(node: Node, shared: SharedData):
    data = exported(load("jacksboro"), shared)
    moved = Settings(camera=Camera(10.0, 20.0)).state(data)
    result = node.run(INCREMENTAL, data, Settings().state(data), moved)
    assert result == {"other": [], "nodes": True}


def test_moved_slider_reruns_steps_with_its_value_alone(node: Node, shared: SharedData):
    data = exported(load("jacksboro"), shared)
    row = next(row for row in data["shown"] if row["path"] == "colour.grass_below")
    moved = Settings(values={row["path"]: row["value"] + 1.0}).state(data)
    result = node.run(INCREMENTAL, data, Settings().state(data), moved)
    assert result["other"] == list(dict.fromkeys(path.rpartition(".")[0] for path in row["targets"]))


def test_another_size_makes_the_plan_anew(node: Node, shared: SharedData):
    data = exported(load("diamond_square"), shared)
    larger = Settings(terrain={"size": (257, 257)}).state(data)
    assert not node.run(INCREMENTAL, data, Settings().state(data), larger)["nodes"]


@pytest.mark.parametrize(("name", "ref"), [("l_dot_n", "height"), ("splat", "weights")])
def test_a_map_takes_the_place_of_the_view(node: Node, shared: SharedData, name: str, ref: str):
    sketch = load(name)
    data = exported(sketch, shared)
    texture = next(
        item for item in data["textures"] if item["ref"].partition(":")[0].partition(".")[0] == ref
    )
    state = Settings().state(data) | {"map": {**texture, "values": {"gain": 2.0}}}
    script = """async (sketch, state, load) => {
        const { makePlan } = await load("plan.js"), { needed } = await load("plan_nodes.js");
        const plan = makePlan(sketch, state);
        return [plan.picture, needed(plan.nodes, plan.picture).map((node) => [node.path, node.size])];
    }"""
    picture, nodes = node.run(script, data, state)
    of = Map(texture["ref"]).of(sketch)
    plan = make_plan(of, PlanRequest(frame_size=(64, 36), variants=KINDS, ref=texture["ref"]))
    expected = [node.path for node in needed(plan.nodes, plan.picture)]
    assert picture["path"] == nodes[-1][0] == "#map" and nodes[-1][1] == [64, 36]
    assert [path for path, _ in nodes[:-1]] == expected[:-1]


GROWN = """#pragma kernel(output = "ground:r32f")
uniform sampler2D ground_before; //! input("black")
uniform int side = 3;            //! slider(1, 9)
uniform float rise = 1.0;        //! slider(0, 9)
float kernel(ivec2 texel) { return texelFetch(ground_before, texel, 0).r + rise * float(size.x); }
"""
LEVEL = """
[[pass]]
name = "once"
use = "./count"
size = 7
[[pass]]
name = "each"
use = "./count"
[[pass]]
name = "grow"
use = "./grown"
size = "ground_before.size.x + iteration"
inputs = { ground_before = "each" }
[[pass]]
name = "smooth"
use = "./grown"
repeat = "5 if iteration == 0 else iterations - iteration"
inputs = { ground_before = "grow" }
feedback = { ground_before = "ground" }
size = "grow.size.x + iterations + iteration"
[parameters]
rise = ["smooth.rise", "grow.rise"]
side = "smooth.side"
[inputs]
ground_before = "grow.ground_before"
[outputs]
ground = "smooth:ground"
"""
LEVELS = """format = 1
size = 33
[[pass]]
name = "start"
use = "./count"
size = 3
[[pass]]
name = "a"
use = "./level"
repeat = "REPEAT"
size = "(size.x - 1) // 2 ** (iterations - 1 - iteration) + a.side"
inputs = { ground_before = "start" }
feedback = { ground_before = "ground" }
[[pass]]
name = "after"
use = "./grown"
size = "a.size.x + 1"
inputs = { ground_before = "a" }
"""


@pytest.mark.parametrize("repeat", ["4", "frames", "2 + a.side // 4"])
def test_levels_are_planned_and_stale_as_in_the_engine(
    node: Node, shared: SharedData, tmp_path: Path, repeat: str
):
    (tmp_path / "count.glsl").write_text(COUNT)
    (tmp_path / "grown.glsl").write_text(GROWN)
    (tmp_path / "level.toml").write_text(LEVEL.replace('inputs = { ground_before = "each" }\n', ""))
    (tmp_path / "levels.toml").write_text(LEVELS.replace("REPEAT", repeat) + map_of("after"))
    sketch = replace(load(tmp_path / "levels.toml"), name=f"levels {repeat}")
    data = exported(sketch, shared)
    several = [
        Settings(),
        Settings(time=0.05),
        Settings(values={"a.side": 5}),
        Settings(values={"a.rise": 0.25}),
        Settings(steps={"a": 1}),
        Settings(steps={"a": 2}, time=0.05),
        Settings(steps={"a.smooth": 2}),
        Settings(steps={"a": 9}),
        Settings(terrain={"size": (17, 17)}),
        Settings(terrain={"size": (4, 4)}),
    ]
    answers = node.run(ASK, data, [settings.state(data) for settings in several])
    for settings, answer in zip(several, answers, strict=True):
        expected = python(sketch, settings)
        if isinstance(expected, str):
            assert answer == expected
            continue
        nodes = [item for each in expected.nodes for item in flat(each)]
        assert [item[:-1] for item in answer["nodes"]] == [node[:-1] for node in nodes], settings
    keys = stale_as_in_the_engine(node, shared, sketch, [s for s in several if not s.terrain])
    assert any("a" in changes for changes in keys.changes.values())
