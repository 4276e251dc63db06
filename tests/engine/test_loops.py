"""Loops give what the same loops give in NumPy, replayed or not, at any sizes, and run no iteration twice."""

from __future__ import annotations

import resource
from contextlib import suppress

import moderngl
import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.engine.loops import MAX_STATES, LoopState, Replay
from playground.engine.plan import LoopStep, PlanRequest
from playground.engine.planner import make_plan, repeats_of
from playground.engine.programs import Program
from playground.engine.results import Cached, Pool
from playground.engine.unfinished import Unfinished
from playground.errors import PlaygroundError
from playground.sketch.model import Output, PassSpec

from ..loading import load
from ..sketch_texts import passes

START = """#pragma kernel(output = "water:r32f")
uniform float level = 1.0; //! slider(0, 10)
float kernel(ivec2 texel) { return level * float((texel.x * 5 + texel.y * 3) % 7); }
"""
ROUGH = """#pragma kernel(output = "rough:r32f")
uniform float grain = 0.5; //! slider(0, 10)
float kernel(ivec2 texel) { return grain * float(texel.x % 3); }
"""
FLOW = """#pragma kernel(output = "flow:r32f")
uniform sampler2D water; //! input
float kernel(ivec2 texel) { return texelFetch(water, texel, 0).r * 0.5; }
"""
MOVE = """#pragma kernel(output = "moved:r32f, left:r32f")
uniform sampler2D water; //! input
uniform sampler2D flow;  //! input
uniform sampler2D rough; //! input
uniform sampler2D silt;  //! input("black")
uniform float bias = 0.0; //! slider(-1, 1)
void kernel(ivec2 texel, out float moved, out float left) {
    moved = texelFetch(water, texel, 0).r - texelFetch(flow, texel, 0).r
        + texelFetch(rough, texel, 0).r + bias;
    left = texelFetch(silt, texel, 0).r + texelFetch(flow, texel, 0).r;
}
"""
RAIN = (
    "\n"
    + passes(rough="./rough", flow="./flow", move="./move")
    + """[inputs]
water = ["flow.water", "move.water"]
silt = "move.silt"
[outputs]
water = "move:moved"
silt = "move:left"
flow = "flow:flow"
"""
)
SKETCH = "\n" + passes(
    start="./start",
    rain=(
        "./rain",
        'inputs = { water = "start:water" }',
        'repeat = "REPEAT"',
        'feedback = { water = "water", silt = "silt" }',
    ),
    after=("./flow", 'inputs = { water = "rain:water" }'),
)


@pytest.fixture
def rain(folder):
    folder.kernels(start=START, rough=ROUGH, flow=FLOW, move=MOVE)
    folder.write("rain.toml", RAIN)

    def sketch(repeat: str = "4", more: str = ""):
        return folder.sketch(SKETCH.replace("REPEAT", repeat) + more)

    return sketch


def expected(
    iterations: int, level: float = 1.0, grain: float = 0.5
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    y, x = np.mgrid[0:17, 0:17]
    water = level * ((x * 5 + y * 3) % 7).astype(np.float64)
    silt, flow = np.zeros((17, 17)), np.zeros((17, 17))
    for _ in range(iterations):
        flow = water * 0.5
        water = water - flow + grain * (x % 3)
        silt = silt + flow
    return water, silt, flow


@pytest.mark.parametrize("iterations", [1, 2, 4, 7])
def test_feedback_is_the_iteration_before(engine, rain, iterations):
    sketch = rain(str(iterations))
    water, silt, flow = expected(iterations)
    np.testing.assert_allclose(engine.read(sketch, "rain:water"), water, rtol=1e-6)
    np.testing.assert_allclose(engine.read(sketch, "rain:silt"), silt, rtol=1e-6)
    np.testing.assert_allclose(engine.read(sketch, "rain.flow"), flow, rtol=1e-6)
    np.testing.assert_allclose(engine.read(sketch, "after"), water * 0.5, rtol=1e-6)


def test_no_iteration_gives_what_the_first_would_read(engine, rain):
    sketch = rain("0")
    np.testing.assert_allclose(engine.read(sketch, "rain:water"), expected(0)[0])
    assert not engine.read(sketch, "rain:silt").any()
    np.testing.assert_allclose(engine.read(sketch, "after"), expected(0)[0] * 0.5)


def test_what_does_not_change_with_the_loop_runs_once(engine, rain):
    engine.texture(rain("6"), "after")
    assert engine.runs == {"start": 1, "rain.rough": 1, "rain.flow": 6, "rain.move": 6, "after": 1}


def test_a_cached_loop_runs_nothing(engine, rain):
    sketch = rain("6")
    engine.texture(sketch, "after")
    for ref in ("rain:water", "rain:silt", "rain.flow", "rain.rough", "after"):
        engine.texture(sketch, ref)
        assert engine.record.ran == []


def test_more_iterations_go_on_from_those_that_are_cached(engine, rain):
    engine.texture(rain("3"), "rain:water")
    assert engine.runs["rain.move"] == 3
    result = engine.read(rain("5"), "rain:water")
    assert engine.runs["rain.move"] == 5
    np.testing.assert_allclose(result, expected(5)[0], rtol=1e-6)
    np.testing.assert_allclose(engine.read(rain("5"), "after"), expected(5)[0] * 0.5, rtol=1e-6)
    engine.texture(rain("2"), "rain:water")
    assert engine.runs["rain.move"] == 7, "fewer iterations begin again"


@pytest.mark.parametrize("path", ["start.level", "rain.rough.grain", "rain.move.bias"])
def test_a_changed_value_begins_again(engine, rain, path):
    sketch = rain("3")
    engine.texture(sketch, "rain:water")
    engine.texture(sketch.with_values({path: 0.75}), "rain:water")
    assert engine.runs["rain.move"] == 6


def test_what_reads_a_loop_is_stale_when_its_iterations_are(engine, rain):
    engine.texture(rain("3"), "after")
    engine.texture(rain("4"), "after")
    assert engine.runs["after"] == 2


def test_time_repeat_continues_and_rewinds_to_earlier_state(engine, rain):
    sketch = rain("floor(time * 2)")
    counts = []
    for time in (0.0, 1.0, 1.2, 4.0, 4.0, 1.0, 1.5):
        result = engine.read(sketch, "rain:water", time=time)
        np.testing.assert_allclose(result, expected(int(time * 2))[0], rtol=1e-6)
        counts.append(engine.record.ran.count("rain.move"))
    assert counts == [0, 2, 0, 6, 0, 1, 1]


def test_going_on_gives_the_same_bits_as_beginning_anew(ctx, engine, rain):
    sketch = rain("floor(time)")
    for time in (1.0, 2.0, 5.0, 9.0):
        gone_on = engine.read(sketch, "rain:water", time=time).copy()
    with Engine(ctx, driver=engine.driver) as fresh:
        np.testing.assert_array_equal(gone_on, fresh.read(sketch, "rain:water", time=9.0))
        assert fresh.runs["rain.move"] == 9


def test_steps_of_a_loop_run_each_iteration_once(engine, rain):
    sketch = rain("5")
    for iteration, values in engine.steps(sketch, "rain"):
        np.testing.assert_allclose(values, expected(iteration)[0], rtol=1e-6)
    assert engine.runs["rain.move"] == 5


def test_the_iteration_is_known_inside(engine, folder):
    folder.write(
        "add.glsl",
        '#pragma kernel(output = "sum:r32f")\nuniform sampler2D sum_before; //! input("black")\n'
        "float kernel(ivec2 texel) { return texelFetch(sum_before, texel, 0).r + "
        "float(iteration) + 0.01 * float(iterations); }\n",
    )
    folder.write("add_up.toml", (passes(add="./add") + '[inputs]\nsum_before = "add.sum_before"\n'))
    sketch = folder.sketch(passes(a=("./add_up", "repeat = 5", 'feedback = { sum_before = "sum" }')))
    np.testing.assert_allclose(engine.read(sketch, "a"), sum(range(5)) + 5 * 0.05, rtol=1e-5)
    stopped = engine.read(sketch, "a", steps={"a": 3})
    np.testing.assert_allclose(stopped, sum(range(3)) + 3 * 0.05, rtol=1e-5)


def test_pass_reading_iteration_runs_each_time_without_feedback(engine, folder):
    folder.write(
        "turn.glsl",
        '#pragma kernel(output = "now:r32f")\n'
        "float kernel(ivec2 texel) { return float(iteration * iteration); }\n",
    )
    folder.write(
        "add.glsl",
        '#pragma kernel(output = "sum:r32f")\nuniform sampler2D now; //! input\n'
        'uniform sampler2D sum_before; //! input("black")\nfloat kernel(ivec2 texel) {\n'
        "    return texelFetch(sum_before, texel, 0).r + texelFetch(now, texel, 0).r;\n}\n",
    )
    folder.write(
        "add_up.toml",
        (passes(now="./turn", add="./add") + '[inputs]\nsum_before = "add.sum_before"\n'),
    )
    sketch = folder.sketch(passes(a=("./add_up", "repeat = 5", 'feedback = { sum_before = "sum" }')))
    assert engine.read(sketch, "a")[2, 2] == 0 + 1 + 4 + 9 + 16
    assert engine.runs["a.now"] == 5


def test_a_single_kernel_may_be_looped_as_well(engine, folder):
    folder.write(
        "twice.glsl",
        '#pragma kernel(output = "v:r32f", repeat = "2")\nuniform sampler2D before; //! input("white")\n'
        "float kernel(ivec2 texel) { return previous(texel) + texelFetch(before, texel, 0).r; }\n",
    )
    sketch = folder.sketch('[[pass]]\nname="a"\nuse="./twice"\nrepeat = 3\nfeedback = { before = "v" }\n')
    assert engine.read(sketch, "a")[0, 0] == 8.0
    assert engine.read(sketch, "a", steps={"a": 2})[0, 0] == 4.0, "the loop is what stops, not the kernel"
    assert [v[0, 0] for _, v in engine.steps(sketch, "a")] == [0.0, 2.0, 4.0, 8.0]


# ── loops in loops ───────────────────────────────────────────────────────────

INNER = """#pragma kernel(output = "v:r32f")
uniform sampler2D before; //! input("black")
uniform sampler2D slow;   //! input
uniform sampler2D still;  //! input
float kernel(ivec2 texel) {
    return texelFetch(before, texel, 0).r * 0.5 + texelFetch(slow, texel, 0).r
         + texelFetch(still, texel, 0).r + float(iteration);
}
"""
SLOW = """#pragma kernel(output = "slow:r32f")
uniform sampler2D fed; //! input("black")
float kernel(ivec2 texel) { return texelFetch(fed, texel, 0).r + float(texel.x); }
"""
STILL = """#pragma kernel(output = "still:r32f")
float kernel(ivec2 texel) { return float(texel.y) * 0.125; }
"""
INNER_TOML = (
    "\n"
    + passes(still="./still", slow="./slow", go="./inner")
    + """[inputs]
before = "go.before"
fed = "slow.fed"
[outputs]
v = "go:v"
slow = "slow:slow"
"""
)
OUTER_TOML = (
    "\n"
    + passes(round=("./inner_loop", "repeat = 3", 'feedback = { before = "v" }'))
    + """[inputs]
fed = "round.fed"
[outputs]
v = "round:v"
slow = "round:slow"
"""
)


def test_nested_loops(engine, folder):
    folder.kernels(inner=INNER, slow=SLOW, still=STILL)
    folder.write("inner_loop.toml", INNER_TOML)
    folder.write("outer.toml", OUTER_TOML)
    sketch = folder.sketch(passes(o=("./outer", 'repeat="floor(time)"', 'feedback={ fed = "v" }')))
    y, x = np.mgrid[0:17, 0:17]
    for time in (2.0, 5.0, 1.0):
        fed, v, slow = np.zeros((17, 17)), np.zeros((17, 17)), np.zeros((17, 17))
        for _ in range(int(time)):
            slow = fed + x
            v = np.zeros((17, 17))
            for iteration in range(3):
                v = v * 0.5 + slow + y * 0.125 + iteration
            fed = v
        np.testing.assert_allclose(engine.read(sketch, "o:v", time=time), v, rtol=1e-6)
        np.testing.assert_allclose(engine.read(sketch, "o:slow", time=time), slow, rtol=1e-6)
        np.testing.assert_allclose(engine.read(sketch, "o.round.still", time=time), y * 0.125, rtol=1e-6)
        np.testing.assert_allclose(engine.read(sketch, "o", time=time), v, rtol=1e-6)
    iterations = 5 + 1  # 2, then 3 more, then 1 again
    assert engine.runs == {
        "o.round.still": 1,  # nothing changes it
        "o.round.slow": iterations,  # once in an iteration of the outer loop
        "o.round.go": 3 * iterations,
    }


def test_a_loop_that_no_loop_around_it_changes_runs_once(engine, folder):
    folder.kernels(inner=INNER, slow=SLOW, still=STILL)
    folder.write("inner_loop.toml", INNER_TOML)
    folder.write(
        "sum.glsl",
        '#pragma kernel(output = "sum:r32f")\nuniform sampler2D v; //! input\n'
        'uniform sampler2D last; //! input("black")\n'
        "float kernel(ivec2 texel) { return texelFetch(last, texel, 0).r + texelFetch(v, texel, 0).r; }\n",
    )
    folder.write(
        "outer.toml",
        '[[pass]]\nname="round"\nuse="./inner_loop"\nrepeat=3\nfeedback={ before = "v" }\n'
        '[[pass]]\nname="sum"\nuse="./sum"\ninputs={ v = "round:v" }\n[inputs]\nlast="sum.last"\n',
    )
    sketch = folder.sketch('[[pass]]\nname="o"\nuse="./outer"\nrepeat=4\nfeedback={ last = "sum" }\n')
    y, x = np.mgrid[0:17, 0:17]
    v = np.zeros((17, 17))
    for iteration in range(3):
        v = v * 0.5 + x + y * 0.125 + iteration
    np.testing.assert_allclose(engine.read(sketch, "o"), 4 * v, rtol=1e-6)
    assert engine.runs == {"o.round.still": 1, "o.round.slow": 1, "o.round.go": 3, "o.sum": 4}


def test_outer_loop_change_through_feedback_reruns_inner_pass(engine, folder):
    """Inside, ``a`` reads only what the inner loop feeds back;
    that comes from ``b``, which reads the outer loop."""
    item = '#pragma kernel(output = "{out}:r32f")\nuniform sampler2D {of}; //! input("black")\n'
    item += "float kernel(ivec2 texel) {{ return texelFetch({of}, texel, 0).r {more}; }}\n"
    folder.write("a.glsl", item.format(out="a", of="back", more="+ 1.0"))
    folder.write("c.glsl", item.format(out="c", of="seen", more="* 10.0"))
    folder.write(
        "b.glsl",
        '#pragma kernel(output = "b:r32f")\nuniform sampler2D a; //! input\n'
        'uniform sampler2D far; //! input("black")\n'
        "float kernel(ivec2 texel) { return texelFetch(a, texel, 0).r + texelFetch(far, texel, 0).r; }\n",
    )
    folder.write(
        "inner.toml",
        '[[pass]]\nname="a"\nuse="./a"\n[[pass]]\nname="b"\nuse="./b"\n'
        '[inputs]\nback="a.back"\nfar="b.far"\n[outputs]\nb="b:b"\na="a:a"\n',
    )
    folder.write(
        "outer.toml",
        '[[pass]]\nname="i"\nuse="./inner"\nrepeat=2\nfeedback={ back = "b" }\n'
        '[inputs]\nfar="i.far"\n[outputs]\nb="i:b"\na="i:a"\n',
    )
    sketch = folder.sketch(
        '[[pass]]\nname="o"\nuse="./outer"\nrepeat="floor(time)"\nfeedback={ far = "b" }\n'
        '[[pass]]\nname="c"\nuse="./c"\ninputs={ seen = "o:a" }\n'
    )
    for time in (1, 2, 4, 3):
        far = a = 0.0
        for _ in range(time):
            b = 0.0
            for _ in range(2):
                a = b + 1.0
                b = a + far
            far = b
        assert engine.read(sketch, "o:b", time=time)[1, 1] == far
        assert engine.read(sketch, "c", time=time)[1, 1] == a * 10.0


SAME = """#pragma kernel(output = "v:r32f")
uniform sampler2D before; //! input
uniform sampler2D other;  //! input("white")
uniform float gain = 1.0; //! slider(-9, 9)
uniform bool turned = false;
float kernel(ivec2 texel) {
    float v = gain * texelFetch(before, texel, 0).r + texelFetch(other, ivec2(0), 0).r;
    return turned ? -v + float(iteration) : v + (wired_other ? 0.5 : 0.25);
}
"""


def test_looped_passes_of_one_kernel_keep_own_values_and_inputs(engine, folder):
    """What a program was set to for one pass is not taken for the next one's."""
    folder.write("same.glsl", SAME)
    folder.write("start.glsl", START)
    folder.write(
        "both.toml",
        '[[pass]]\nname = "a"\nuse = "./same"\n'
        '[[pass]]\nname = "b"\nuse = "./same"\ninputs = { before = "a", other = "a" }\nset = { gain = 0.5 }\n'
        '[[pass]]\nname = "c"\nuse = "./same"\ninputs = { before = "b" }\n'
        "set = { turned = true, gain = 0.25 }\n"
        '[inputs]\nbefore = "a.before"\n[outputs]\nv = "c:v"\n',
    )
    sketch = folder.sketch(
        '[[pass]]\nname = "start"\nuse = "./start"\n[[pass]]\nname = "l"\nuse = "./both"\nrepeat = 7\n'
        'inputs = { before = "start" }\nfeedback = { before = "v" }\n'
    )
    y, x = np.mgrid[0:17, 0:17]
    for gain in (1.0, 2.0):
        v = ((x * 5 + y * 3) % 7).astype(np.float64)
        for iteration in range(7):
            a = gain * v + 1.0 + 0.25
            b = 0.5 * a + a[0, 0] + 0.5
            v = -(0.25 * b + 1.0) + iteration
        result = engine.read(sketch.with_values({"l.a.gain": gain}), "l")
        np.testing.assert_allclose(result, v, rtol=1e-6)


def test_an_iteration_sets_only_what_changes(engine, rain, monkeypatch):
    written = []
    usual = Program.set_all
    monkeypatch.setattr(
        Program, "set_all", lambda self, values: written.append(values) or usual(self, values)
    )
    engine.texture(rain("200"), "rain:water")
    assert sum("size" in values for values in written) <= 2 * 3, "once for what is wired first, once after"


# ── what it costs ────────────────────────────────────────────────────────────


def test_five_hundred_iterations_use_memory_of_one_hundred(any_engine, rain):
    sketch = rain("floor(time)")
    for time in range(MAX_STATES + 2):
        any_engine.texture(sketch, "rain:water", time=float(time))  # as many states are kept as may be
    any_engine.texture(sketch, "rain:water", time=100.0)
    made, cached = any_engine.runner.pool.made, any_engine.cache.bytes
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    any_engine.texture(sketch, "rain:water", time=500.0)
    assert any_engine.runs["rain.move"] == 500
    assert any_engine.runner.pool.made == made, "every iteration finds its textures in the pool"
    assert any_engine.cache.bytes == cached
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 8 * 1024  # [KiB]


@pytest.mark.parametrize("good", [0, 1, 2, 4])
def test_an_iteration_that_fails_leaves_the_last_good_one(any_engine, rain, monkeypatch, good):
    sketch = rain("floor(time)")
    any_engine.texture(sketch, "rain:water", time=2.0)
    write, moves = any_engine.runner.kernels.write, []

    def fails_once(program, driver, result, *more):
        if result.outputs[0].name == "moved":
            moves.append(result)
            if len(moves) == good + 1:
                raise RuntimeError("on purpose")
        write(program, driver, result, *more)

    monkeypatch.setattr(any_engine.runner.kernels, "write", fails_once)
    with pytest.raises(RuntimeError, match="on purpose"):
        any_engine.texture(sketch, "rain:water", time=9.0)
    monkeypatch.undo()
    np.testing.assert_allclose(any_engine.read(sketch, "rain:water", time=9.0), expected(9)[0], rtol=1e-6)
    assert any_engine.record.ran.count("rain.move") == 7 - good


@pytest.mark.parametrize("fails", [False, True])
def test_a_loop_gives_back_all_that_a_failed_iteration_made(ctx: moderngl.Context, fails: bool):
    outputs, pool = (Output("v", "r32f"),), Pool(ctx, 2**20)
    spec = PassSpec("loop", "generation/diamond_square", load("").graph)
    loop = LoopStep("loop", 3, 3, ((),), (), spec)
    with suppress(ZeroDivisionError), LoopState(loop, Cached({}), pool) as state:
        for number in range(3):
            with state.iteration() as computed:
                computed["a"] = pool.take((5, 3), outputs)
                if fails and number == 2:
                    raise ZeroDivisionError
        assert state.iterations == 3
        for result in state.take().values():
            pool.give(result)
    assert pool.made == len(pool) == 2
    pool.clear()


# ── A loop whose iterations are replayed gives the bits, and the counts, of one whose passes run one


LEVEL = """#pragma kernel(output = "v:r32f")
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
PAIRED = passes(
    c="./count", l=("./two", 'inputs = { before = "c" }', "repeat = 4", 'feedback = { before = "v" }')
)
PAIRED += '[inputs]\nbefore = "c.before"\n[outputs]\nv = "l:v"\n'
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
    texts = {"start": LEVEL, "add": ADD, "count": COUNT, "blur": BLUR, "repeated": REPEATED}
    folder.kernels(**texts)
    folder.write("two.toml", TWO)
    folder.write("inner.toml", PAIRED)
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


# ── A loop whose sizes and counts follow its iteration gives what its levels give as passes written


# What it reads, as a fraction of the terrain, its own size, and where it is in the loop.
GROW = """#pragma kernel(output = "ground:r32f")
uniform sampler2D ground_before; //! input("black")
uniform float rise = 1.0;        //! slider(0, 10)
float kernel(ivec2 texel) {
    ivec2 from = textureSize(ground_before, 0);
    ivec2 near = ivec2(floor(vec2(texel) * vec2(from - 1) / vec2(max(size - 1, 1)) + 0.5));
    return texelFetch(ground_before, near, 0).r * 3.0 + rise * float((texel.x * 5 + texel.y * 3) % 7)
        + 0.125 * float(size.x) + 0.0625 * float(size.y) + spacing.x / 1024.0;
}
"""
SMOOTH = """#pragma kernel(output = "ground:r32f")
uniform sampler2D ground_before; //! input
float kernel(ivec2 texel) {
    float sum = 0.0;
    for (int i = -1; i <= 1; i++)
        sum += texelFetch(ground_before, clamp(texel + ivec2(i, 0), ivec2(0), size - 1), 0).r;
    return sum / 3.0 + 0.5;
}
"""
EASTING = """#pragma kernel(output = "still:r32f")
float kernel(ivec2 texel) { return float(texel.x); }
"""
SLANT = """#pragma kernel(output = "ground:r32f")
uniform float level = 2.0; //! slider(0, 10)
float kernel(ivec2 texel) { return level * float(texel.x - texel.y); }
"""
COARSE = '"(size.x - 1) // 2 ** (iterations - 1 - iteration) + 1"'
LOOP = f"""
[[pass]]
name = "start"
use = "./start"
[[pass]]
name = "a"
use = "./grow"
inputs = {{ ground_before = "start" }}
repeat = 4
size = {COARSE}
feedback = {{ ground_before = "ground" }}
"""


def by_hand(sides: list[int], use: str = "./grow") -> str:
    text, before = '\n[[pass]]\nname = "start"\nuse = "./start"\n', "start"
    for number, side in enumerate(sides):
        text += f'[[pass]]\nname = "level{number}"\nuse = "{use}"\nsize = {side}\n'
        text += f'inputs = {{ ground_before = "{before}" }}\n'
        before = f"level{number}"
    return text


@pytest.fixture
def levels(folder):
    folder.kernels(grow=GROW, smooth=SMOOTH, still=EASTING, start=SLANT)
    folder.write(
        "one.toml",
        '[[pass]]\nname = "grow"\nuse = "./grow"\n'
        '[[pass]]\nname = "smooth"\nuse = "./smooth"\nrepeat = "REPEAT"\n'
        'inputs = { ground_before = "grow" }\nfeedback = { ground_before = "ground" }\n'
        '[inputs]\nground_before = "grow.ground_before"\n[outputs]\nground = "smooth:ground"\n'.replace(
            "REPEAT", "5 if iteration == 0 else iterations - iteration"
        ),
    )
    return folder


def test_each_level_has_its_size_and_reads_coarser_texture(any_engine, levels):
    result = any_engine.read(levels.sketch(LOOP, size="size = 33"), "a")
    hand = any_engine.read(levels.sketch(by_hand([5, 9, 17, 33]), size="size = 33"), "level3")
    assert result.shape == (33, 33)
    np.testing.assert_array_equal(result, hand)


def test_sizes_may_differ_along_the_axes(any_engine, levels):
    both = '["2 + 3 * iteration", "(size.y - 1) // 2 ** (iterations - 1 - iteration) + 1"]'
    result = any_engine.read(levels.sketch(LOOP.replace(COARSE, both)), "a")
    hand = by_hand([0, 1, 2, 3])
    for number, size in enumerate(([2, 3], [5, 5], [8, 9], [11, 17])):
        hand = hand.replace(f"size = {number}\n", f"size = {size}\n")
    np.testing.assert_array_equal(result, any_engine.read(levels.sketch(hand), "level3"))


@pytest.mark.parametrize("steps", [1, 2, 3])
def test_stopped_early_it_leaves_the_smaller_texture(any_engine, levels, steps):
    sides = [5, 9, 17, 33][:steps]
    sketch = levels.sketch(LOOP, size="size = 33")
    result = any_engine.read(sketch, "a", steps={"a": steps})
    hand = any_engine.read(levels.sketch(by_hand(sides), size="size = 33"), f"level{steps - 1}")
    np.testing.assert_array_equal(result, hand)


def test_steps_yield_every_level_and_run_each_once(any_engine, levels):
    sketch = levels.sketch(LOOP, size="size = 33")
    assert [values.shape[0] for _, values in any_engine.steps(sketch, "a")] == [5, 5, 9, 17, 33]
    assert any_engine.runs["a"] == 4
    before = next(iter(any_engine.steps(sketch, "a")))[1]
    y, x = np.round(np.mgrid[0:5, 0:5] * 8)
    assert before.shape == (5, 5) and (np.abs(before - 2.0 * (x - y)) <= 2.0 * 8).all()


def test_a_technique_in_the_loop_has_its_sizes_and_counts(any_engine, levels):
    sketch = levels.sketch(LOOP.replace("./grow", "./one"), size="size = 33")
    result = any_engine.read(sketch, "a")
    hand, before = '\n[[pass]]\nname = "start"\nuse = "./start"\n', "start"
    for number, (side, count) in enumerate([(5, 5), (9, 3), (17, 2), (33, 1)]):
        hand += f'[[pass]]\nname = "g{number}"\nuse = "./grow"\nsize = {side}\n'
        hand += f'inputs = {{ ground_before = "{before}" }}\n'
        hand += f'[[pass]]\nname = "s{number}"\nuse = "./smooth"\nsize = {side}\nrepeat = {count}\n'
        hand += f'inputs = {{ ground_before = "g{number}" }}\nfeedback = {{ ground_before = "ground" }}\n'
        before = f"s{number}"
    np.testing.assert_array_equal(result, any_engine.read(levels.sketch(hand, size="size = 33"), "s3"))
    assert repeats_of(sketch) == {"a": 4, "a.smooth": 5}
    assert [len(v) for _, v in any_engine.steps(sketch, "a.smooth")] == [33] * 6


def test_the_innermost_loop_gives_the_names(any_engine, levels):
    levels.write(
        "inner.toml",
        '[[pass]]\nname = "in"\nuse = "./grow"\nrepeat = "iteration + 1"\n'
        'size = "2 ** (iteration + 1) + iterations"\nfeedback = { ground_before = "ground" }\n'
        '[inputs]\nground_before = "in.ground_before"\n',
    )
    sketch = levels.sketch(passes(a=("./inner", "repeat = 3", 'feedback = { ground_before = "ground" }')))
    sides = [2**j + n for n in (1, 2, 3) for j in range(1, n + 1)]
    hand = by_hand(sides).replace('inputs = { ground_before = "start" }\n', "")
    result = any_engine.read(sketch, "a")
    assert result.shape == (11, 11)
    np.testing.assert_array_equal(result, any_engine.read(levels.sketch(hand), f"level{len(sides) - 1}"))


def test_feedback_input_has_size_of_previous_iteration(any_engine, levels):
    levels.write(
        "twice.toml",
        '[[pass]]\nname = "grow"\nuse = "./grow"\nsize = "2 * ground_before.size.x - 1 + 0 * iteration"\n'
        '[inputs]\nground_before = "grow.ground_before"\n',
    )
    start = '\n[[pass]]\nname = "start"\nuse = "./start"\nsize = 3\n'
    sketch = levels.sketch(
        start + '[[pass]]\nname = "a"\nuse = "./twice"\nrepeat = 3\ninputs = { ground_before = "start" }\n'
        'feedback = { ground_before = "ground" }\n'
    )
    hand = by_hand([5, 9, 17]).replace('use = "./start"\n', 'use = "./start"\nsize = 3\n')
    np.testing.assert_array_equal(
        any_engine.read(sketch, "a"), any_engine.read(levels.sketch(hand), "level2")
    )


def test_outside_its_size_is_that_of_the_last_iteration(any_engine, levels):
    after = '[[pass]]\nname = "b"\nuse = "./smooth"\nsize = "a.size.x"\ninputs = { ground_before = "a" }\n'
    sketch = levels.sketch(LOOP.replace("repeat = 4", 'repeat = "3"') + after, size="size = 33")
    assert any_engine.read(sketch, "b").shape == (33, 33)
    assert any_engine.read(sketch, "b", steps={"a": 2}).shape == (17, 17)


def test_constant_pass_runs_once_and_resized_pass_each_level(any_engine, levels):
    levels.write(
        "two.glsl",
        '#pragma kernel(output = "ground:r32f")\nuniform sampler2D ground_before; //! input("black")\n'
        "uniform sampler2D once; //! input\nuniform sampler2D each; //! input\n"
        "float kernel(ivec2 texel) { return texelFetch(ground_before, texel / 2, 0).r"
        " + texelFetch(once, ivec2(6, 0), 0).r + texelFetch(each, size - 1, 0).r; }\n",
    )
    levels.write(
        "both.toml",
        '[[pass]]\nname = "once"\nuse = "./still"\nsize = 7\n[[pass]]\nname = "each"\nuse = "./still"\n'
        '[[pass]]\nname = "two"\nuse = "./two"\ninputs = { once = "once", each = "each" }\n'
        '[inputs]\nground_before = "two.ground_before"\n',
    )
    sketch = levels.sketch(
        f'[[pass]]\nname = "a"\nuse = "./both"\nrepeat = 3\nsize = {COARSE}\n'
        'feedback = { ground_before = "ground" }\n'
    )
    result = any_engine.read(sketch, "a")
    assert any_engine.runs == {"a.once": 1, "a.each": 3, "a.two": 3}
    assert result[0, 0] == 3 * 6 + 4 + 8 + 16


def test_only_what_is_stale_runs_again(any_engine, levels):
    sketch = levels.sketch(LOOP, size="size = 33")
    any_engine.texture(sketch, "a")
    any_engine.texture(sketch, "a")
    assert any_engine.record.ran == []
    changed = sketch.with_values({"a.rise": 2.0})
    result = any_engine.read(changed, "a").copy()
    assert any_engine.record.ran == ["a"] * 4
    with Engine(any_engine.ctx) as fresh:
        np.testing.assert_array_equal(result, fresh.read(changed, "a"))


def test_more_levels_restart_loop_as_first_sizes_differ(any_engine, levels):
    any_engine.texture(levels.sketch(LOOP, size="size = 33"), "a")
    more = levels.sketch(LOOP.replace("repeat = 4", "repeat = 5"), size="size = 33")
    result = any_engine.read(more, "a")
    assert any_engine.record.ran == ["a"] * 5
    hand = any_engine.read(levels.sketch(by_hand([3, 5, 9, 17, 33]), size="size = 33"), "level4")
    np.testing.assert_array_equal(result, hand)


def test_a_size_of_a_later_iteration_is_in_the_key(any_engine, levels):
    result = []
    for side in (9, 8):
        sketch = levels.sketch(LOOP.replace(COARSE, f'"{side} if iteration == 2 else 5"'))
        result.append(any_engine.read(sketch, "a").copy())
        hand = levels.sketch(by_hand([5, 5, side, 5]))
        np.testing.assert_array_equal(result[-1], any_engine.read(hand, "level3"))
    assert not np.array_equal(*result)


def test_a_value_that_a_size_names_makes_the_plan_anew(any_engine, levels):
    levels.write(
        "sized.glsl",
        GROW.replace("uniform float rise", "uniform int side = 3; //! slider(1, 9)\nuniform float rise"),
    )
    loop = LOOP.replace("./grow", "./sized").replace(COARSE, '"a.side + 2 * iteration"')
    sketch = levels.sketch(loop)
    assert any_engine.read(sketch, "a").shape == (9, 9)
    assert any_engine.read(sketch.with_values({"a.side": 5}), "a").shape == (11, 11)


def test_a_loop_of_no_iteration_has_the_size_of_the_only_one(any_engine, levels):
    sketch = levels.sketch(LOOP.replace("repeat = 4", "repeat = 0"))
    assert any_engine.read(sketch, "a").shape == (17, 17)


def test_one_plan_has_one_step_for_one_size(levels):
    sketch = levels.sketch(LOOP.replace(COARSE, '"5 if iteration < 3 else 9"'))
    loop = make_plan(sketch, PlanRequest(frame_size=(9, 9))).node("a")
    assert [body[0].size for body in loop.bodies] == [(5, 5)] * 3 + [(9, 9)]
    assert loop.bodies[0] is loop.bodies[1] is loop.bodies[2]
    assert loop.body is loop.bodies[3]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            '[[pass]]\nname = "a"\nuse = "./start"\nsize = "2 + iteration"\n',
            "pass 'a': size names 'iteration', which is for the size of a pass with a repeat "
            "and for the passes inside it",
        ),
        (
            LOOP.replace("repeat = 4", 'repeat = "iterations"'),
            "pass 'a': repeat names 'iterations', which is for the size of a pass with a repeat "
            "and for the passes inside it",
        ),
        (
            LOOP.replace(COARSE, '"2 - iteration"'),
            "pass 'a': size 0 x 0 in iteration 2; 1 to 16384 a side were expected",
        ),
        (
            LOOP.replace(COARSE, '"size.x + iteratoin"'),
            "pass 'a': size: 'size.x + iteratoin' names 'iteratoin', which is not known here; "
            "did you mean 'iteration'?",
        ),
        (
            LOOP.replace("repeat = 4", "repeat = 5000"),
            "pass 'a': repeat '5000' gives 5000; 0 to 1024 were expected where a size or a repeat inside "
            "names the iteration",
        ),
    ],
)
def test_mistakes_are_said_in_a_sentence(levels, text, sentence):
    with pytest.raises(PlaygroundError) as caught:
        make_plan(levels.sketch(text), PlanRequest(frame_size=(9, 9)))
    assert caught.value.diagnostics[0].message == sentence


def test_a_technique_outside_any_loop_is_in_iteration_0_of_1(any_engine, levels):
    sketch = levels.sketch('[[pass]]\nname = "a"\nuse = "./one"\n')
    assert repeats_of(sketch) == {"a.smooth": 5}
    assert any_engine.read(sketch, "a").shape == (17, 17)


def test_a_parameter_of_that_name_comes_before_the_loop(any_engine, levels):
    levels.write(
        "named.toml",
        '[[pass]]\nname = "grow"\nuse = "./grow"\nsize = "iterations + 2"\n'
        '[parameters]\niterations = "grow.rise"\n[inputs]\nground_before = "grow.ground_before"\n',
    )
    sketch = levels.sketch(
        '[[pass]]\nname = "a"\nuse = "./named"\nrepeat = 3\nfeedback = { ground_before = "ground" }\n'
        "set = { iterations = 5 }\n"
    )
    assert any_engine.read(sketch, "a").shape == (7, 7)
