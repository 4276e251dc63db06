"""A technique run on arrays gives what it gives on a terrain of that size, and leaves the picture alone."""

from __future__ import annotations

import threading

import numpy as np
import pytest

from playground.engine.on_arrays import OnArrays
from playground.engine.unfinished import SourceUnfinished
from playground.errors import PlaygroundError
from playground.sketch.techniques import read_technique

from ..loading import load
from ..plans import plans_made_whole
from ..sketch_texts import passes

HILLS = """#pragma kernel(output = "height:r32f")
uniform int seed = 3; //! slider(0, 99)
float kernel(ivec2 texel) { return fract(float((texel.x * 73 + texel.y * 179 + seed * 31) % 97) * 0.37); }
"""
RAIN = """#pragma kernel(output = "rain:rg32f")
vec2 kernel(ivec2 texel) { return vec2(float(texel.y) * 0.01, 1.0); }
"""
SLUMP = """#pragma kernel(output = "height:r32f, moved:rg32f")
uniform sampler2D height_before; //! input
uniform sampler2D rain;          //! input("white")
uniform float rate = 0.1;        //! slider(0, 1)
void kernel(ivec2 texel, out float height, out vec2 moved) {
    float here = texelFetch(height_before, texel, 0).r;
    float east = texelFetch(height_before, clamp(texel + ivec2(1, 0), ivec2(0), size - 1), 0).r;
    float north = texelFetch(height_before, clamp(texel + ivec2(0, 1), ivec2(0), size - 1), 0).r;
    vec2 slope = relief * vec2(east - here, north - here) / spacing;
    moved = rate * slope * texelFetch(rain, texel, 0).rg + 0.001 * float(iteration);
    height = here + (moved.x + moved.y) / (relief + base_elevation);
}
"""
SLUMPS = (
    "\n"
    + passes(slump=("./slump", 'repeat = "6"', 'feedback = { height_before = "height" }'))
    + """[inputs]
height_before = "slump.height_before"
rain = "slump.rain"
[parameters]
rate = "slump.rate"
[outputs]
height = "slump:height"
moved = "slump:moved"
"""
)
SKETCH = "extent = [320.0, 240.0]\nrelief = 40.0\nbase_elevation = 7.0\n" + passes(
    hills="./hills",
    rain="./rain",
    a=("./slumps", 'inputs = { height_before = "hills", rain = "rain" }', "set = { rate = 0.25 }"),
)
OPTIONS = {"spacing": (320.0 / 16, 240.0 / 12), "relief": 40.0, "base_elevation": 7.0}


@pytest.fixture
def sketch(folder):
    folder.kernels(hills=HILLS, rain=RAIN, slump=SLUMP)
    folder.write("slumps.toml", SLUMPS)
    return folder.sketch(SKETCH, size="size = [17, 13]")


@pytest.fixture
def slumps(sketch, folder):
    return read_technique("./slumps", folder.path, folder.path)


def test_it_gives_the_bits_of_the_same_technique_on_a_terrain(engine, sketch, slumps):
    expected = {name: engine.read(sketch, f"a:{name}").copy() for name in ("height", "moved")}
    hills, rain = engine.read(sketch, "hills").copy(), engine.read(sketch, "rain").copy()
    inputs = {"height_before": hills, "rain": rain}
    result = OnArrays(engine, slumps).run(inputs, values={"rate": 0.25}, **OPTIONS)
    assert result.keys() == expected.keys()
    for name, values in expected.items():
        assert result[name].dtype == np.float32
        np.testing.assert_array_equal(result[name], values)


def test_steps_values_and_arrays_are_those_of_each_run(engine, sketch, slumps):
    brush, hills = OnArrays(engine, slumps), engine.read(sketch, "hills").copy()
    seen = []
    for rate, steps, array in (
        (0.25, 3, hills),
        (0.25, 6, hills),
        (0.5, 3, hills),
        (0.25, 3, hills[::-1].copy()),
        (0.25, 3, hills),
    ):
        options = {"values": {"rate": rate}, "steps": {"": steps}, "outputs": ("height",)}
        seen.append(brush.run({"height_before": array}, **options, **OPTIONS)["height"])
    np.testing.assert_array_equal(seen[0], seen[4])
    assert all(not np.array_equal(seen[0], other) for other in seen[1:4])
    expected = engine.read(sketch.with_values({"a.rate": 0.25}), "a:height", steps={"a.slump": 3})
    rain = engine.read(sketch, "rain").copy()
    inputs = {"height_before": hills, "rain": rain}
    options |= {"values": {"rate": 0.25}, "steps": {"slump": 3}}
    np.testing.assert_array_equal(brush.run(inputs, **options, **OPTIONS)["height"], expected)


def test_a_technique_of_the_library_is_named(any_engine):
    sketch = load("l_dot_n").with_values({"size": 33, "height.seed": 5})
    product = any_engine.read(sketch, "product").copy()
    height = any_engine.read(sketch, "height").copy()
    result = OnArrays(any_engine, "lighting/l_dot_n").run(
        {"height": height},
        spacing=(10240.0 / 32, 10240.0 / 32),
        relief=1800.0,
        values={"sun": (120.0, 25.0)},
    )
    np.testing.assert_array_equal(result["light"], product)


def test_runs_on_arrays_leave_last_frame_and_cache_unchanged(engine, sketch, slumps):
    engine.draw(sketch, size=(32, 24))
    hills = engine.read(sketch, "hills").copy()
    engine.draw(sketch, size=(32, 24))
    record, runs, held = engine.record, engine.runs.copy(), len(engine.cache)
    brush = OnArrays(engine, slumps)
    for _ in range(3):
        brush.run({"height_before": hills}, **OPTIONS)
    made, count = engine.runner.pool.made, len(engine.cache)
    for _ in range(5):
        brush.run({"height_before": hills}, **OPTIONS)
    assert engine.runner.pool.made == made and len(engine.cache) == count == held
    assert engine.record is record and engine.runs == runs
    engine.draw(sketch, size=(32, 24))
    assert engine.record.ran == []


def test_a_source_that_a_window_waits_for_goes_on(engine, sketch, slumps):
    ended, may_end = threading.Event(), threading.Event()

    def work(report):
        try:
            while not may_end.wait(0.002):
                report(0, 1)
        finally:
            ended.set()
        return {"height": np.ones((2, 2), np.float32)}

    works = engine.runner.works
    works.waits = False
    with pytest.raises(SourceUnfinished):
        works.made("height", "key", lambda: work)
    engine.options.patience = 0.1
    try:
        OnArrays(engine, slumps).run({"height_before": np.zeros((5, 4), np.float32)}, **OPTIONS)
        assert engine.options.patience == 0.1
    finally:
        engine.options.patience = None
    assert engine.runner.works is works and not works.waits
    assert not ended.wait(0.1) and works.at_work
    may_end.set()
    assert ended.wait(5.0)
    assert works.made("height", "key", lambda: work)["height"].all()
    works.waits = True


def test_warm_it_neither_compiles_nor_plans_anew(any_engine, slumps, monkeypatch):
    wholes = plans_made_whole(monkeypatch)
    brush, hills = OnArrays(any_engine, slumps), np.zeros((129, 129), np.float32)
    counts = []
    for number in range(4):
        brush.run({"height_before": hills + number}, values={"rate": 0.1 * number}, **OPTIONS)
        counts.append((len(wholes), any_engine.runner.programs.compiled))
    assert counts[0] == counts[-1]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"arrays": {"heigt_before": 2}}, "has no input 'heigt_before'; did you mean 'height_before'"),
        ({"arrays": {}}, "needs an array for its input 'height_before'"),
        ({"arrays": {"height_before": 1}}, r"an array of shape \(4,\); \(ny, nx\) or"),
        ({"outputs": ("heigth",)}, "has no output 'heigth'; did you mean 'height'"),
        ({"values": {"rat": 1.0}}, "did you mean 'technique.rate'"),
        ({"values": {"rate": 3.0}}, "outside its range 0 to 1"),
        ({"steps": {"": 9}}, "stops after 9 steps, but it has 6 in all"),
        ({"relief": float("nan")}, "relief"),
    ],
)
def test_mistakes_are_said_in_a_sentence(any_engine, slumps, change, sentence):
    arrays = {name: np.zeros((4,) * n) for name, n in change.pop("arrays", {"height_before": 2}).items()}
    with pytest.raises(PlaygroundError, match=sentence):
        OnArrays(any_engine, slumps).run(arrays, **{**OPTIONS, **change})
