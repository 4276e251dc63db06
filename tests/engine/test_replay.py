"""A loop whose iterations are replayed gives the bits, and the counts, of one whose passes run one by one."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.engine.loops import Replay
from playground.engine.unfinished import Unfinished

from ..sketch_texts import passes

START = """#pragma kernel(output = "v:r32f")
uniform float level = 1.0; //! slider(0, 10)
float kernel(ivec2 texel) { return level * float((texel.x * 5 + texel.y * 3) % 7) / 7.0; }
"""
ADD = """#pragma kernel(output = "v:r32f, w:r32f")
uniform sampler2D before; //! input("zero")
uniform sampler2D other;  //! input("white")
uniform float gain = 0.5; //! slider(0, 1)
void kernel(ivec2 texel, out float v, out float w) {
    v = gain * texelFetch(before, texel, 0).r + 0.25 * texelFetch(other, ivec2(0), 0).r;
    w = v + (wired_other ? 0.5 : 0.25);
}
"""
COUNT = """#pragma kernel(output = "v:r32f")
uniform sampler2D before; //! input("zero")
float kernel(ivec2 texel) {
    return 0.5 * texelFetch(before, texel, 0).r + float(iteration) / float(iterations) + 0.125 * time;
}
"""
BLUR = """#pragma kernel(output = "v:r32f")
uniform sampler2D before; //! input("linear", "mipmap")
float kernel(ivec2 texel) {
    return 0.5 * textureLod(before, vec2(0.5), 2.0).r + 0.5 * texelFetch(before, texel, 0).r + 0.125;
}
"""
REPEATED = """#pragma kernel(output = "v:r32f", repeat = 3)
uniform sampler2D before; //! input
float kernel(ivec2 texel) { return 0.5 * previous(texel) + texelFetch(before, texel, 0).r; }
"""
TWO = passes(
    a="./add",
    b=("./count", 'inputs = { before = "a:w" }'),
    c=("./add", 'inputs = { before = "b", other = "a" }'),
)
TWO += '[inputs]\nbefore = "a.before"\n[outputs]\nv = "c:v"\n'
INNER = passes(
    c="./count", l=("./two", 'inputs = { before = "c" }', "repeat = 4", 'feedback = { before = "v" }')
)
INNER += '[inputs]\nbefore = "c.before"\n[outputs]\nv = "l:v"\n'
GROWS = 'size = ["2 + iteration // 2", "2 + iteration // 2"]'


def looped(use: str, *more: str, repeat: str = "9") -> str:
    wires = ('inputs = { before = "start:v" }', f'repeat = "{repeat}"', 'feedback = { before = "v" }')
    return passes(start="./start", l=(use, *wires, *more))


SKETCHES = {
    "one kernel": looped("./count"),
    "two outputs, one kernel": looped("./add"),
    "several kernels": looped("./two"),
    "one text twice": looped("./twice"),
    "frames": looped("./count", repeat="frames"),
    "goes on": looped("./two", repeat="floor(60 * time)"),
    "mipmaps": looped("./blur"),
    "repeated inside": looped("./repeated"),
    "a loop inside": looped("./inner"),
    "sizes that change": looped("./count", GROWS),
}
REPLAYED = {"one kernel", "two outputs, one kernel", "several kernels", "frames", "goes on", "a loop inside"}


@pytest.fixture
def written(folder):
    texts = {"start": START, "add": ADD, "count": COUNT, "blur": BLUR, "repeated": REPEATED}
    for name, text in texts.items():
        folder.write(f"{name}.glsl", text)
    folder.write("two.toml", TWO)
    folder.write("inner.toml", INNER)
    twice = passes(a="./add", b=("./add", 'inputs = { before = "a:w" }', "set = { gain = 0.25 }"))
    folder.write("twice.toml", twice + '[inputs]\nbefore = "a.before"\n[outputs]\nv = "b:v"\n')
    return {name: folder.sketch(text) for name, text in SKETCHES.items()}


def drawn(engine: Engine, sketch, frame: int):
    """Return what a loop gives at a frame, and what the engine counted."""
    engine.runs.clear()
    values = engine.read(sketch, "l:v", time=frame / 60).copy()
    record = engine.record
    return values, dict(engine.runs), +record.iterations, record.texels, sorted(record.ran)


@pytest.mark.parametrize("name", SKETCHES)
@pytest.mark.parametrize("driver", ["fragment", "compute"])
def test_a_loop_gives_the_same_replayed_or_not(ctx, written, driver, name, monkeypatch):
    if driver == "compute" and ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    replays = []
    usual = Replay.run
    monkeypatch.setattr(Replay, "run", lambda self, *value: replays.append(self) or usual(self, *value))
    sketch = written[name]
    with Engine(ctx, driver=driver) as quick, Engine(ctx, driver=driver) as slow:
        slow.options.profiling = True  # each pass is measured, so each runs by itself
        for level in (1.0, 2.0):
            changed = sketch.with_values({"start.level": level})
            for frame in (5, 12, 13, 40, 7):
                ours, theirs = drawn(quick, changed, frame), drawn(slow, changed, frame)
                np.testing.assert_array_equal(ours[0], theirs[0])
                assert ours[1:] == theirs[1:]
    assert bool(replays) == (name in REPLAYED)


def test_a_loop_that_is_stopped_in_between_goes_on_where_it_was(any_engine, written):
    sketch = written["goes on"]
    expected = any_engine.read(sketch, "l:v", time=0.5).copy()
    with Engine(any_engine.ctx) as hasty:
        hasty.options.patience = -1.0
        stops = 0
        for _ in range(20):
            try:
                result = hasty.read(sketch, "l:v", time=0.5)
                break
            except Unfinished:
                stops += 1
        np.testing.assert_array_equal(result, expected)
        assert stops == 7, "every four iterations of thirty"
        assert hasty.runs["l.a"] == 30


def test_what_is_called_before_each_step_is_called_before_each(any_engine, written):
    seen = []
    any_engine.runner.before_step = lambda step: seen.append(step.path)
    any_engine.texture(written["several kernels"], "l:v")
    assert seen.count("l.b") == 9


def test_two_sets_of_textures_change_places(any_engine, written):
    any_engine.texture(written["several kernels"], "l:v")
    assert any_engine.runner.pool.made <= 1 + 2 * (2 + 1 + 2), "the start's, and two of each output"


@pytest.mark.parametrize("pressed", [False, True])
def test_buttons_and_parameters_stay_set(any_engine, folder, pressed):
    folder.write(
        "tap.glsl",
        '#pragma kernel(output = "v:r32f")\nuniform sampler2D before; //! input("zero")\n'
        "uniform bool tap = false; //! button() Tap\n"
        "float kernel(ivec2 texel) { return texelFetch(before, texel, 0).r + (tap ? 2.0 : 1.0); }\n",
    )
    sketch = folder.sketch(passes(l=("./tap", "repeat = 6", 'feedback = { before = "v" }')))
    any_engine.runner.pressed = frozenset({"l.tap"}) if pressed else frozenset()
    assert any_engine.read(sketch, "l:v")[0, 0] == (12.0 if pressed else 6.0)
