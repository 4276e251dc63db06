"""A pass runs again when, and only when, something that its textures depend on has changed."""

from __future__ import annotations

import os
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
from playground.sketch.model import Camera

from ..sketch_texts import SMALL_VIEW, passes

TERRAIN = """#pragma kernel(output = "height:r32f")
uniform float bumps = 3.0;   //! slider(0, 10) How many
uniform float unused = 1.0;  //! slider(0, 10) Never read
float kernel(ivec2 texel) { return fract(float(texel.x * texel.y) * bumps * 0.01); }
"""
LIGHT = """#pragma kernel(output = "light:r32f")
uniform sampler2D height; //! input
uniform vec2 sun = vec2(135.0, 30.0); //! direction
float kernel(ivec2 texel) { return texelFetch(height, texel, 0).r * sun.y; }
"""
SLOPE = """#pragma kernel(output = "slope:r32f")
uniform sampler2D height; //! input
float kernel(ivec2 texel) { return (texelFetch(height, texel, 0).r) / spacing.x; }
"""
SPAN = """#pragma kernel(output = "span:r32f")
float kernel(ivec2 texel) { return extent.x + relief; }
"""
CLOCK = """#pragma kernel(output = "clock:r32f")
float kernel(ivec2 texel) { return time; }
"""
FOUR = "\nextent = 1000.0\nrelief = 100.0\n" + passes(
    height="./terrain",
    slope="./slope",
    span="./span",
    clock="./clock",
    light=("./light", 'inputs = { height = "height" }'),
)
EVERYTHING = ("height", "slope", "span", "clock", "light")


@pytest.fixture
def four(folder):
    folder.kernels(terrain=TERRAIN, light=LIGHT, slope=SLOPE, span=SPAN, clock=CLOCK)
    return folder.sketch(FOUR)


def ran_after(engine: Engine, sketch, time: float = 0.0) -> set[str]:
    """Return what runs to bring every pass up to date."""
    names: set[str] = set()
    for path in (*EVERYTHING, "view:frame"):
        engine.texture(sketch, path, size=(32, 18), time=time)
        names |= set(engine.record.ran)
    return names


def test_the_same_sketch_twice_runs_nothing(engine, four):
    assert ran_after(engine, four) == {*EVERYTHING, "view"}
    assert ran_after(engine, four) == set()
    assert engine.record.texels == 0
    assert engine.runs == dict.fromkeys((*EVERYTHING, "view"), 1)


def test_moving_the_light_runs_light_and_view_only(engine, four):
    ran_after(engine, four)
    assert ran_after(engine, four.with_values({"light.sun": (200.0, 10.0)})) == {"light", "view"}
    assert ran_after(engine, four) == set(), "both are cached"


def test_a_changed_terrain_runs_what_reads_it(engine, four):
    ran_after(engine, four)
    assert ran_after(engine, four.with_values({"height.bumps": 4.0})) == {"height", "slope", "light", "view"}


def test_only_what_is_requested_runs(engine, four):
    engine.texture(four, "slope")
    assert engine.record.ran == ["height", "slope"]
    assert engine.record.texels == 2 * 17 * 17


def test_a_value_that_the_text_never_uses_makes_nothing_stale(engine, four):
    ran_after(engine, four)
    assert ran_after(engine, four.with_values({"height.unused": 9.0})) == set()


def test_a_comment_makes_nothing_stale(engine, folder, four):
    ran_after(engine, four)
    folder.write(
        "terrain.glsl", "// a new first line\n" + TERRAIN.replace("How many", "How many bumps /* or not */")
    )
    folder.write("light.glsl", LIGHT.replace("\nfloat", "\n\n// a remark\n   float"))
    assert ran_after(engine, folder.sketch(FOUR)) == set()


def test_a_changed_text_runs_it_and_what_reads_it(engine, folder, four):
    ran_after(engine, four)
    folder.write("terrain.glsl", TERRAIN.replace("0.01", "0.02"))
    assert ran_after(engine, folder.sketch(FOUR)) == {"height", "slope", "light", "view"}


def test_a_changed_way_of_reading_an_input_runs_it(engine, folder, four):
    ran_after(engine, four)
    folder.write("light.glsl", LIGHT.replace("//! input", '//! input("linear")'))
    assert ran_after(engine, folder.sketch(FOUR)) == {"light", "view"}


def test_extent_and_relief_matter_to_texts_that_name_them(engine, four):
    ran_after(engine, four)
    assert ran_after(engine, four.with_values({"extent": (2000.0, 1000.0)})) == {"slope", "span"}
    assert ran_after(engine, four.with_values({"relief": 50.0})) == {"span"}


def test_time_matters_to_texts_that_name_it(engine, four):
    ran_after(engine, four)
    assert ran_after(engine, four, time=1.0) == {"clock"}
    assert ran_after(engine, four, time=0.0) == set()


def test_the_size_matters_to_all_but_the_view_of_the_same_frame(engine, four):
    ran_after(engine, four)
    assert ran_after(engine, four.with_values({"size": (33, 17)})) == {*EVERYTHING, "view"}


def test_the_camera_matters_to_what_names_it(engine, folder):
    folder.write(
        "eye.glsl", '#pragma kernel(output = "e:r32f")\nfloat kernel(ivec2 texel) { return eye.x; }\n'
    )
    folder.write("terrain.glsl", TERRAIN)
    sketch = folder.sketch(passes(height="./terrain", e="./eye"))
    engine.texture(sketch, "e")
    engine.texture(sketch, "height")
    turned = replace(sketch, camera=replace(sketch.camera, azimuth=10.0))
    engine.texture(turned, "height")
    assert engine.record.ran == []
    engine.texture(turned, "e")
    assert engine.record.ran == ["e"]


def test_a_file_matters_by_its_contents(engine, folder, tmp_path):
    picture = np.full((4, 4, 4), 255, np.uint8)
    write_png(tmp_path / "p.png", picture)
    sketch = folder.one(
        '#pragma kernel(output = "p:r32f")\nuniform sampler2D image; //! file("p.png")\n'
        "float kernel(ivec2 texel) { return texelFetch(image, texel / 5, 0).r; }\n"
    )
    assert engine.read(sketch, "a").max() == 1.0
    os.utime(tmp_path / "p.png", ns=(1, 1))  # another time, the same contents
    engine.texture(sketch, "a")
    assert engine.record.ran == []
    write_png(tmp_path / "p.png", picture // 255)
    assert engine.read(sketch, "a").max() < 0.001
    assert engine.record.ran == ["a"]


def test_visit_count_may_depend_on_parameter_unused_in_code(any_engine, folder):
    kernel = """#pragma kernel(output = "h:r32f", repeat = "2", visits = "count, 1")
uniform int count = 3; //! slider(1, 17)
ivec2 visit(ivec2 cell) { return cell; }
float kernel(ivec2 texel) { return previous(texel) + 1.0; }
"""
    if not any_engine.info.compute:
        pytest.skip("without compute every texel is run")
    sketch = folder.one(kernel)
    assert (any_engine.read(sketch, "a") > 0).sum() == 3
    assert (any_engine.read(sketch.with_values({"a.count": 5}), "a") > 0).sum() == 5


def test_the_driver_and_the_form_enter_the_key(ctx, four):
    keys = {}
    for driver in ("fragment", "auto", *(["compute"] if ctx.version_code >= 430 else [])):
        with Engine(ctx, driver=driver) as engine:
            engine.texture(four, "height")
            keys[driver] = engine.keys_of(engine.record.plan).steps["height"].result
            assert keys[driver] in engine.cache
    assert keys["auto"] == keys["fragment"] != keys.get("compute"), "auto draws a plain kernel by fragment"


# ── the bound ────────────────────────────────────────────────────────────────


def test_the_cache_keeps_its_bound_and_drops_the_oldest(ctx, folder):
    sketch = folder.one(TERRAIN, size="size = 64")  # 16 KiB
    each = 64 * 64 * 4
    with Engine(ctx, cache_bytes=4 * each) as engine:
        for bumps in range(10):
            engine.texture(sketch.with_values({"a.bumps": bumps}), "a")
            assert engine.cache.bytes <= 4 * each
        assert len(engine.cache) == 4
        for bumps, runs in ((9, 0), (6, 0), (5, 1), (9, 0), (7, 1)):
            engine.texture(sketch.with_values({"a.bumps": bumps}), "a")
            assert len(engine.record.ran) == runs, f"bumps {bumps}"


def test_what_a_frame_uses_is_cached_even_over_the_bound(ctx, four):
    with Engine(ctx, cache_bytes=1000) as engine:
        values = engine.read(four, "light", size=(32, 18))
        assert engine.cache.bytes == 2 * 17 * 17 * 4 > 1000
        assert values.shape == (17, 17)
        engine.texture(four, "span")
        assert engine.cache.bytes == 17 * 17 * 4, "the next frame needs one texture only"


def test_a_texture_lives_until_the_next_frame(ctx, four):
    with Engine(ctx, cache_bytes=0) as engine:
        texture = engine.texture(four, "span")
        assert np.frombuffer(texture.read(), "f4")[0] == 1100.0


def test_mipmaps_count(ctx, folder):
    folder.write(
        "far.glsl", LIGHT.replace("//! input", '//! input("linear", "mipmap")').replace("height", "a")
    )
    folder.write("one.glsl", TERRAIN)
    sketch = folder.sketch(passes(a="./one", b="./far"), size="size = 64")
    with Engine(ctx) as engine:
        engine.texture(sketch, "a")
        before = engine.cache.bytes
        engine.texture(sketch, "b")
        assert engine.cache.bytes == 2 * before + before // 3


CHANGES = {
    "relief": lambda four: four.with_values({"relief": 150.0}),
    "extent": lambda four: four.with_values({"extent": (2000.0, 1000.0)}),
    "camera": lambda four: four.with_camera(Camera(azimuth=77.0)),
    "a value": lambda four: four.with_values({"light.sun": (90.0, 10.0)}),
    "nothing": lambda four: four,
}


@pytest.mark.parametrize("what", CHANGES)
def test_what_would_run_is_what_runs_and_asking_changes_nothing(engine, folder, four, what):
    four = folder.sketch(f'{FOUR}[view]\nuse = "view/terrain"\n')
    engine.draw(four, size=(32, 18))
    plan, drawn = engine.record.plan, engine.drawn()
    changed = CHANGES[what](four)
    would = engine.stale(changed, size=(32, 18))
    fingerprint = engine.fingerprint(changed, size=(32, 18))
    assert engine.record.plan is plan and engine.drawn() == drawn
    assert (fingerprint == engine.fingerprint(four, size=(32, 18))) == (what == "nothing")
    engine.draw(changed, size=(32, 18))
    assert engine.record.ran == would
    assert bool(would) == (what != "nothing")


def save_silently(path, data: bytes) -> None:
    """Save other contents in place, of the same size, inode and time of change, as ``cp -p`` does."""
    before = path.stat()
    path.write_bytes(data)
    os.utime(path, (1e9, 1e9))
    assert (path.stat().st_ino, path.stat().st_size) == (before.st_ino, before.st_size)


def test_saves_that_keep_inode_size_and_time_are_drawn(any_engine, folder, tmp_path):
    """Many at once: some of them fall into one tick of the file system's clock."""
    pragma = '#include "part.glsl"\n#pragma kernel(output = "height:r32f")\n'
    kernel = pragma + "float kernel(ivec2 texel) {{ return {}.0 * part(); }}\n"
    ramp = np.linspace(0.0, 1.0, 17 * 17, dtype=np.float32).reshape(17, 17)
    folder.write("k.glsl", kernel.format(0))
    folder.write("part.glsl", "float part() { return 0.0; }\n")
    np.save(tmp_path / "ramp.npy", ramp)
    head = (tmp_path / "ramp.npy").read_bytes()[: -ramp.nbytes]
    elevation = 'set = { elevation = "ramp.npy", first_row = "south" }'
    folder.sketch(passes(a="./k", b=("generation/heightmap", elevation)))
    for value in range(1, 9):
        save_silently(tmp_path / "k.glsl", kernel.format(value).encode())
        save_silently(tmp_path / "part.glsl", f"float part() {{ return {value}.0; }}\n".encode())
        save_silently(tmp_path / "ramp.npy", head + (ramp**value).tobytes())
        assert any_engine.read(tmp_path / "sketch.toml", "a")[0, 0] == value * value
        np.testing.assert_allclose(any_engine.read(tmp_path / "sketch.toml", "b"), ramp**value, atol=1e-6)


@pytest.mark.parametrize(
    ("ref", "change", "reasons"),
    [
        ("light", {"height.bumps": 4.0}, {"height": ("value bumps",), "light": ("input height",)}),
        ("light", {"light.sun": (1.0, 2.0)}, {"light": ("value sun",)}),
        ("span", {"relief": 50.0}, {"span": ("given relief",)}),
        ("slope", {"extent": (500.0, 500.0)}, {"slope": ("given spacing",)}),
        ("slope", {"size": 9}, {"height": ("size",), "slope": ("size", "input height", "given spacing")}),
    ],
)
def test_the_keys_of_two_frames_say_why_a_pass_ran(engine, four, ref, change, reasons):
    engine.texture(four, ref)
    assert {path: engine.record.reasons(path) for path in engine.record.ran} == dict.fromkeys(
        engine.record.ran, ("the pass",)
    )
    engine.texture(four.with_values(change), ref)
    assert {path: engine.record.reasons(path) for path in engine.record.ran} == reasons


def test_a_text_a_file_and_a_dropped_texture_are_reasons_too(engine, folder, four):
    engine.texture(four, "slope")
    folder.write("slope.glsl", SLOPE.replace(").r)", ").r * 2.0)"))
    engine.texture(folder.sketch(FOUR), "slope")
    assert engine.record.reasons("slope") == ("text",)
    engine.cache.clear()
    engine.texture(folder.sketch(FOUR), "slope")
    assert engine.record.ran == ["height", "slope"]
    assert engine.record.reasons("slope") == ()


# ── A frame works out what depends on what has changed, and comes to the keys of one made from nothi


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
    folder.kernels(**KERNELS)
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
EVERY_CHANGE = [
    "nothing",
    "camera",
    "time",
    "picture",
    "file",
    "button",
    "stop",
    "samples",
    "size",
    "extent",
]
EVERY_CHANGE += ["relief", "mouse", "repeated.steps", "grown.wide", *VALUES]


def computed_from_nothing(engine: Engine, plan: Plan) -> Keys:
    maker = KeyMaker(content=engine.painted.content)
    engine.runner.set_frame(plan)
    return maker.keys_of(plan, engine.runner.driver_for, engine.runner.given_for_key)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_keys_made_of_the_last_ones_are_those_made_from_nothing(any_engine, many, folder, seed):
    frames, random = Frames(any_engine, many, folder), np.random.default_rng(seed)
    for what in ("nothing", *random.permutation(EVERY_CHANGE * 3)):
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
    usual = cache_keys.KeyComputation.part
    any_engine.keys_of(frames.plan())
    frames.change(what)
    plan = frames.plan()
    monkeypatch.setattr(
        cache_keys.KeyComputation, "part", lambda self, node, *a: made.append(node) or usual(self, node, *a)
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


# ── A frame that none follows keeps no texture longer than a pass reads it, and is the same frame


GROUND = """#pragma kernel(output = "height:r32f")
uniform float bumps = 3.0; //! slider(0, 9)
float kernel(ivec2 texel) { return 0.5 + 0.5 * sin(bumps * float(texel.x) + 0.2 * float(texel.y)); }
"""
RAISED = """#pragma kernel(output = "height:r32f")
uniform sampler2D before; //! input
float kernel(ivec2 texel) { float h = texelFetch(before, texel, 0).r; return WHAT; }
"""
SHOWN = """#pragma kernel(output = "frame:rgba8")
uniform sampler2D height; //! input("linear", "mipmap")
vec4 kernel(ivec2 texel) { return vec4(textureLod(height, (vec2(texel) + 0.5) / vec2(size), 1.0).rrr, 1.0); }
"""
CHAIN = passes(
    first="./ground",
    twin="./ground",
    second=("./raised", 'inputs = { before = "first:height" }'),
    third=("./raised", 'inputs = { before = "second:height" }'),
    both=("./raised", 'inputs = { before = "third:height" }'),
    last=("./raised", 'inputs = { before = "both:height" }'),
)


@pytest.fixture
def chain(folder):
    def of(what: str = "0.9 * h"):
        folder.write("ground.glsl", GROUND)
        folder.write("raised.glsl", RAISED.replace("WHAT", what))
        folder.write("shown.glsl", SHOWN)
        return folder.sketch(CHAIN + '[view]\nuse = "./shown"\ninputs = { height = "last:height" }\n')

    return of


def once(engine: Engine) -> Engine:
    engine.options.keeps, engine.options.looks_early = False, True
    return engine


def test_last_use_release_keeps_picture_and_frees_read_textures(ctx, chain):
    with Engine(ctx) as usual, Engine(ctx) as engine:
        expected = usual.render(chain(), size=(40, 30))
        render = once(engine).render(chain(), size=(40, 30))
        np.testing.assert_array_equal(render.array, expected.array)
        assert set(usual.record.results) == {"first", "second", "third", "both", "last", "view"}
        assert set(engine.record.results) == {"view"}
        assert engine.cache.bytes == 40 * 30 * 4
        # A texture that was given back was written by a later pass: two hold what five passes gave.
        assert engine.runner.pool.made < usual.runner.pool.made


def test_equal_passes_share_texture_until_last_read(ctx, folder):
    folder.write("ground.glsl", GROUND)
    folder.write("raised.glsl", RAISED.replace("WHAT", "0.9 * h"))
    two = RAISED.replace("uniform", "uniform sampler2D other; //! input\nuniform", 1)
    folder.write("two.glsl", two.replace("WHAT", "0.5 * h + 0.25 * texelFetch(other, texel, 0).r"))
    folder.write("shown.glsl", SHOWN)
    text = passes(
        first="./ground",
        twin="./ground",
        low=("./raised", 'inputs = { before = "first:height" }'),
        sum=("./two", 'inputs = { before = "low:height", other = "twin:height" }'),
    )
    sketch = folder.sketch(text + '[view]\nuse = "./shown"\ninputs = { height = "sum:height" }\n')
    with Engine(ctx) as usual, Engine(ctx) as engine:
        expected = usual.render(sketch, size=(20, 20)).array
        np.testing.assert_array_equal(once(engine).render(sketch, size=(20, 20)).array, expected)


def test_frames_may_follow_all_the_same(ctx, chain):
    sketch = chain()
    with Engine(ctx) as usual, Engine(ctx) as engine:
        once(engine)
        for bumps in (3.0, 4.0, 3.0):
            changed = sketch.with_values({"first.bumps": bumps})
            expected = usual.render(changed, size=(24, 24)).array
            np.testing.assert_array_equal(engine.render(changed, size=(24, 24)).array, expected)


def test_what_was_not_finite_in_a_texture_that_is_gone_is_told(ctx, chain):
    broken = chain("texel == ivec2(3, 2) ? uintBitsToFloat(0x7fc00000u) : h")
    with Engine(ctx) as usual, Engine(ctx) as engine:
        usual.render(broken, size=(16, 16))
        once(engine).render(broken, size=(16, 16))
        assert engine.record.results.keys() == {"view"}
        expected = [str(not_finite) for not_finite in usual.not_finite_by_pass()]
        assert [str(not_finite) for not_finite in engine.not_finite_by_pass()] == expected
        assert "pass 'second', output 'height'" in str(engine.not_finite())


def test_mipmapped_texture_keeps_no_base_level_framebuffer(ctx, chain):
    with Engine(ctx) as engine:
        engine.render(chain(), size=(16, 16))
        assert engine.record.results["last"].mipmapped
        assert engine.record.results["last"]._framebuffer is None
        assert engine.record.results["both"]._framebuffer is not None


def test_terrain_under_the_eye_stays(ctx, folder):
    folder.write("ground.glsl", GROUND)
    sketch = folder.sketch(
        passes(height="./ground") + '[view]\nuse = "view/terrain"\nset = { grid = 9 }\n'
        "camera = { elevation = 1, distance = 0.3 }\n"
    )
    with Engine(ctx) as usual, Engine(ctx) as engine:
        usual.warnings.report = engine.warnings.report = lambda _: None
        expected = usual.render(sketch, size=(32, 18)).array
        assert usual.eye_height.raised_by > 0
        np.testing.assert_array_equal(once(engine).render(sketch, size=(32, 18)).array, expected)
