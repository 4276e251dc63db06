"""A frame works out what depends on what has changed, and comes to the keys of one made from nothing."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.engine import cache_keys
from playground.engine.cache_keys import KeyMaker, Keys
from playground.engine.engine import Engine
from playground.engine.plan import Plan, PlanRequest, every_version
from playground.engine.planner import make_plan

from ..sketch_texts import SMALL_VIEW, passes

HEAD = '#pragma kernel(output = "v:r32f"{})\n'
OPEN = 'uniform sampler2D v; //! input("zero")\n'
VALUE = "uniform float value = 1.0; //! slider(0, 1e9)\n"
READ = "texelFetch(v, texel, 0).r"
KERNELS = {
    "flat": HEAD.format("") + VALUE + "float kernel(ivec2 texel) { return value; }\n",
    "metric": HEAD.format("")
    + OPEN
    + VALUE
    + f"float kernel(ivec2 texel) {{ return value * relief + {READ}; }}\n",
    "spaced": HEAD.format("") + OPEN + f"float kernel(ivec2 texel) {{ return spacing.x + {READ}; }}\n",
    "timed": HEAD.format("")
    + OPEN
    + VALUE
    + f"float kernel(ivec2 texel) {{ return value * time + {READ}; }}\n",
    "aimed": HEAD.format("") + OPEN + f"float kernel(ivec2 texel) {{ return eye.x + {READ}; }}\n",
    "tapped": HEAD.format("")
    + OPEN
    + "uniform bool tap = false; //! button() Tap\n"
    + f"float kernel(ivec2 texel) {{ return (tap ? 1.0 : 0.0) + {READ}; }}\n",
    "pictured": HEAD.format("")
    + 'uniform sampler2D image; //! file("p.png")\n'
    + "float kernel(ivec2 texel) { return texelFetch(image, texel % 2, 0).r; }\n",
    "repeated": HEAD.format(', repeat = "steps"')
    + OPEN
    + "uniform int steps = 3; //! slider(1, 9)\n"
    + f"float kernel(ivec2 texel) {{ return 0.5 * previous(texel) + {READ}; }}\n",
    "fed": HEAD.format("")
    + OPEN
    + VALUE
    + "uniform int wide = 1; //! slider(0, 1)\n"
    + f"float kernel(ivec2 texel) {{ return value + 0.5 * {READ} + float(iteration); }}\n",
}
PLAIN = "#version 330\nuniform vec2 u_mouse;\nout vec4 v;\nvoid main() { v = vec4(u_mouse, 0.0, 1.0); }\n"
LOOP = 'feedback = { v = "v" }'
SIZES = 'size = ["2 + iteration * grown.wide", "2 + iteration * grown.wide"]'
TEXT = (
    passes(
        start="./flat",
        metric=("./metric", 'inputs = { v = "start" }'),
        spaced=("./spaced", 'inputs = { v = "metric" }'),
        timed=("./timed", 'inputs = { v = "start" }'),
        aimed=("./aimed", 'inputs = { v = "timed" }'),
        tapped=("./tapped", 'inputs = { v = "spaced" }'),
        pictured="./pictured",
        plain="./plain",
        repeated=("./repeated", 'inputs = { v = "tapped" }'),
        loop=("./pair", 'inputs = { v = "repeated" }', "repeat = 4", LOOP),
        film=("./timed", 'inputs = { v = "pictured" }', 'repeat = "frames"', LOOP),
        grown=("./wide", 'inputs = { v = "loop" }', "repeat = 3", LOOP, SIZES),
        end=("./spaced", 'inputs = { v = "grown" }'),
    )
    + SMALL_VIEW
    + 'inputs = { height = "end" }\n'
)
PAIR = passes(a="./fed", b=("./metric", 'inputs = { v = "a" }'))
PAIR += '[inputs]\nv = "a.v"\n[outputs]\nv = "b:v"\n'
WIDE = passes(still="./flat", a="./fed") + '[inputs]\nv = "a.v"\n[outputs]\nv = "a:v"\n'
WIDE += '[parameters]\nvalue = "a.value"\nwide = "a.wide"\n'


@pytest.fixture
def many(folder):
    """Give a sketch of passes of every kind that keys tell apart."""
    for name, text in KERNELS.items():
        folder.write(f"{name}.glsl", text)
    folder.write("plain.frag", PLAIN)
    folder.write("pair.toml", PAIR)
    folder.write("wide.toml", WIDE)
    picture(folder, 0)
    return folder.sketch(TEXT)


def picture(folder, level: int) -> None:
    write_png(folder.path / "p.png", np.full((2, 2, 3), level % 256, np.uint8))


class Frames:
    """The settings of frames, one of which changes at a time."""

    def __init__(self, engine: Engine, sketch, folder) -> None:
        self.engine, self.sketch, self.folder = engine, sketch, folder
        self.size, self.time, self.steps, self.number = (32, 18), 0.0, {}, 0

    def change(self, what: str) -> None:
        """Change one thing to what it was not before, but for buttons and stops, which alternate."""
        self.number += 1
        number, sketch = self.number, self.sketch
        if what == "camera":
            sketch = sketch.with_camera(replace(sketch.camera, azimuth=float(number)))
        elif what == "time":
            self.time = number / 8
        elif what == "picture":
            self.size = (32 + number, 18)
        elif what == "file":
            picture(self.folder, number)
        elif what == "button":
            pressed = self.engine.runner.pressed
            self.engine.runner.pressed = frozenset() if pressed else frozenset({"tapped.tap"})
        elif what == "mouse":
            self.engine.runner.mouse = (float(number), 0.0, 0.0, 0.0)
        elif what == "stop":
            self.steps = {} if self.steps else {"repeated": 1}
        elif what == "samples":
            sketch = sketch.with_picture(samples=2 if sketch.picture.samples == 1 else 1)
        elif what == "size":
            sketch = sketch.with_values({"size": 8 + number % 9})
        elif what == "extent":
            sketch = sketch.with_values({"extent": 1000.0 + number})
        elif what == "relief":
            sketch = sketch.with_values({"relief": 100.0 + number})
        elif what == "grown.wide":
            sketch = sketch.with_values({what: number % 2})
        elif what == "repeated.steps":
            sketch = sketch.with_values({what: 2 + number % 7})
        elif what != "nothing":
            sketch = sketch.with_values({what: number + 0.5})
        self.sketch = sketch

    def plan(self) -> Plan:
        return self.engine.plan(self.sketch, self.size, self.time, self.steps)


VALUES = ["start.value", "metric.value", "timed.value", "loop.a.value", "film.value", "grown.value"]
CHANGES = ["nothing", "camera", "time", "picture", "file", "button", "stop", "samples", "size", "extent"]
CHANGES += ["relief", "mouse", "repeated.steps", "grown.wide", *VALUES]


def computed_from_nothing(engine: Engine, plan: Plan) -> Keys:
    maker = KeyMaker(content=engine.painted.content)
    engine.runner.set_frame(plan)
    return maker.keys_of(plan, engine.runner.driver_for, engine.runner.given_for_key)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_keys_made_of_the_last_ones_are_those_made_from_nothing(any_engine, many, folder, seed):
    frames, random = Frames(any_engine, many, folder), np.random.default_rng(seed)
    for what in ("nothing", *random.permutation(CHANGES * 3)):
        frames.change(str(what))
        plan, forms = frames.plan(), any_engine.plain_forms
        from_nothing = make_plan(
            frames.sketch,
            PlanRequest(
                frame_size=frames.size,
                time=frames.time,
                variants=forms.kinds if frames.sketch.picture.samples == 1 else forms.kinds_without_draws,
                steps=frames.steps,
            ),
        )
        assert plan.nodes == from_nothing.nodes
        ours, theirs = any_engine.keys_of(plan), computed_from_nothing(any_engine, plan)
        assert ours == theirs, what
        assert ours.changes.keys() == {id(node) for node in every_version(plan.nodes)}


def test_two_sketches_in_turn_have_keys_of_their_own(any_engine, many, folder):
    other = folder.sketch(TEXT.replace('"end"', '"last"'))
    for number in range(3):
        for sketch in (many, other, many.plainly(), many.with_values({"start.value": 5.0 + number})):
            plan = any_engine.plan(sketch, (32, 18))
            assert any_engine.keys_of(plan) == computed_from_nothing(any_engine, plan)


def test_keys_are_those_of_the_plan_s_terrain(any_engine, many):
    plan = any_engine.plan(many, (32, 18))
    any_engine.keys_of(plan)
    flat = replace(plan, terrain=replace(plan.terrain, relief=1.0))
    assert any_engine.keys_of(flat) == computed_from_nothing(any_engine, flat)


REACHED = {
    "nothing": set(),
    "camera": {"aimed", "view"},
    "time": {"timed", "aimed", "film"},
    "file": {"pictured", "film"},
    "mouse": {"plain"},
    "button": {"tapped", "repeated", "loop", "grown", "end", "view"},
    "metric.value": {"metric", "spaced", "tapped", "repeated", "loop", "grown", "end", "view"},
    "grown.value": {"grown", "end", "view"},
    "film.value": {"film"},
}


@pytest.mark.parametrize("what", REACHED)
def test_keys_are_computed_for_what_a_change_reaches(any_engine, many, folder, what, monkeypatch):
    of_one_plan = folder.sketch(TEXT.replace('"frames"', "5"))  # a count that names the time plans again
    frames, made = Frames(any_engine, of_one_plan, folder), []
    usual = cache_keys._KeyComputation.part
    any_engine.keys_of(frames.plan())
    frames.change(what)
    plan = frames.plan()
    monkeypatch.setattr(
        cache_keys._KeyComputation, "part", lambda self, node, *a: made.append(node) or usual(self, node, *a)
    )
    any_engine.keys_of(plan)
    assert {node.path.partition(".")[0] for node in made} == REACHED[what]


CHAINED = "the picture reads all of them"


@pytest.mark.parametrize("what", ["camera", CHAINED])
def test_unchanged_pass_costs_next_to_nothing_per_frame(any_engine, folder, what):
    folder.write("flat.glsl", KERNELS["flat"])
    folder.write("more.glsl", KERNELS["spaced"])
    calls = {}
    for count in (10, 210):
        text = passes(p0="./flat")
        for number in range(1, count):
            text += passes(**{f"p{number}": ("./more", f'inputs = {{ v = "p{number - 1}" }}')})
        shown = f"p{count - 1}" if what == CHAINED else "p0"
        sketch = folder.sketch(text + SMALL_VIEW + f'inputs = {{ height = "{shown}" }}\n')
        moved = [sketch.with_camera(replace(sketch.camera, azimuth=float(turn))) for turn in range(4)]
        with Engine(any_engine.ctx) as engine:  # whose cache has room for all of it
            for each in moved[:-1]:
                engine.draw(each, size=(16, 9))
            calls[count] = calls_of(lambda draw=engine.draw, last=moved[-1]: draw(last, size=(16, 9)))
            assert engine.record.ran and all(path.startswith("view") for path in engine.record.ran)
    # One call a pass would be 200. What is in use is taken from the cache and weighed, which is nine.
    most = 10 * 200 if what == CHAINED else 100
    assert calls[210] - calls[10] <= most


def calls_of(run) -> int:
    """Return how many functions written in Python a call of one calls."""
    count = 0

    def profile(frame, event, argument):
        nonlocal count
        count += event == "call"

    before = sys.getprofile()
    sys.setprofile(profile)
    try:
        run()
    finally:
        sys.setprofile(before)
    return count
