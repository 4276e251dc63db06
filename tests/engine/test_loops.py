"""A loop over a technique gives what the same loop gives in NumPy, and runs no iteration twice."""

from __future__ import annotations

import resource
from contextlib import suppress

import moderngl
import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.engine.loops import MAX_STATES, LoopState
from playground.engine.plan import LoopStep
from playground.engine.programs import Program
from playground.engine.results import Cached, Pool
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
    for name, text in {"start": START, "rough": ROUGH, "flow": FLOW, "move": MOVE}.items():
        folder.write(f"{name}.glsl", text)
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
    sketch = folder.sketch(
        '[[pass]]\nname = "a"\nuse = "./add_up"\nrepeat = 5\nfeedback = { sum_before = "sum" }\n'
    )
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
    for name, text in {"inner": INNER, "slow": SLOW, "still": STILL}.items():
        folder.write(f"{name}.glsl", text)
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
    for name, text in {"inner": INNER, "slow": SLOW, "still": STILL}.items():
        folder.write(f"{name}.glsl", text)
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
