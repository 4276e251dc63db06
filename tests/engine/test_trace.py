"""A trace gives what the kernel computed: against the same run in Python, and the texel's own bits."""

from __future__ import annotations

import json
import math
import os
import sys
from pathlib import Path
from subprocess import run

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.engine.trace.model import first_difference
from playground.errors import ParameterError, ShaderError, SketchError
from playground.sketch.find import shipped_sketches

from ..loading import load
from ..sketch_texts import map_of, passes
from ..traces import traces_of

ROOT = Path(__file__).resolve().parent.parent.parent

f32 = np.float32

STEPS = """#include "half.glsl"
#pragma kernel(output = "a:r32f")
struct Walk { ivec2 at; float far[3]; };
#define TWICE(x) (2 * (x))
bool is_over(int n, out int left) {
    left = n - 8;
    return left > 0;
}
float kernel(ivec2 texel) {
    int n = texel.x + 3 * texel.y + 1, count = 0;
    while (n != 1) {
        if (n % 2 == 0) n = halved(n);
        else {
            n = 3 * n + 1;
            count += TWICE(1);
        }
        ++count;
    }
    int left;
    if (is_over(count, left)) count -= left;
    Walk walk = Walk(texel, float[3](0.0, 0.0, 0.0));
    for (int i = 0; i < 3; i++) for (int j = 0; j <= i; j++) walk.far[i] += float(j + texel.x);
    mat2 turn = mat2(1.0, 2.0, 3.0, 4.0);
    turn[1].x = -1.0;
    vec3 all = vec3(0.0);
    all.yz = turn * vec2(walk.far[1], 1.0);
    switch (texel.x & 1) {
    case 0:
        all.x = 5.0;
        break;
    default:
        all.x += 0.5;
    }
    return all.x + all.y + all.z + float(count);
}
"""
HALF = """int halved(int n) {
    return n >> 1;
}
"""


def run_of(x: int, y: int) -> dict[str, object]:
    """Run what STEPS says, in Python."""
    n, count, ns = x + 3 * y + 1, 0, []
    tests = []
    while n != 1:
        tests.append(n % 2 == 0)
        if n % 2 == 0:
            n //= 2
        else:
            n, count = 3 * n + 1, count + 2
        ns.append(n)
        count += 1
    left = count - 8
    over = left > 0
    count -= left if over else 0
    far = [float(sum(j + x for j in range(i + 1))) for i in range(3)]
    y0, y1 = 1.0 * far[1] + -1.0, 2.0 * far[1] + 4.0
    first = 5.0 if x % 2 == 0 else 0.5
    value = first + y0 + y1 + count
    parts = (first, y0, y1)
    return {"n": ns, "tests": tests, "left": left, "over": over, "far": far, "all": parts, "value": value}


@pytest.fixture
def steps(folder):
    folder.write("half.glsl", HALF)
    return folder.one(STEPS)


@pytest.mark.parametrize("texel", [(0, 0), (5, 2), (16, 16), (9, 0)])
def test_every_statement_has_the_value_that_python_gets(engine, steps, texel):
    expected = run_of(*texel)
    trace = engine.trace(steps, "a", texel=texel, function="all")
    assert trace.is_exact and trace.is_complete
    assert trace.outputs == trace.texel_values == {"a": (expected["value"],)}
    (call,) = trace.calls_of("kernel")
    assert call.result == expected["value"]
    assert call["texel"] == texel
    assert call.values("n")[1:] == expected["n"]
    assert call.values("n % 2 == 0") == expected["tests"]
    assert [c.result for c in trace.calls_of("halved")] == [
        n for n, even in zip(expected["n"], expected["tests"], strict=True) if even
    ]
    assert call["left"] == expected["left"] and call["is_over(count, left)"] == expected["over"]
    assert trace.calls_of("is_over")[0].values("left") == [expected["left"]]
    assert call["walk"] == {"at": texel, "far": [0.0, 0.0, 0.0]}
    # Each element as the inner loop's last iteration left it.
    sums = [row["walk.far[i]"] for loop in trace.loops(call) if loop.variable == "i" for row in loop.rows]
    assert sums == expected["far"]
    assert call["turn"] == ((1.0, 2.0), (3.0, 4.0)) and call["turn[1]"] == (-1.0, 4.0)
    assert call["all"] == expected["all"] and call["texel.x & 1"] == texel[0] % 2


def test_events_lie_where_the_author_wrote_them(any_engine, steps, folder):
    trace = any_engine.trace(steps, "a", texel=(5, 2), function="all")
    lines = STEPS.split("\n")
    kernel = trace.calls_of("kernel")[0]
    for event in kernel.events:
        if event.kind in ("set", "condition", "iteration", "argument") and event.name:
            line = lines[event.line - 1]
            assert Path(event.path).name == "one.glsl"
            assert line[event.column - 1 : event.end_column - 1] == event.name, event
    halved = trace.calls_of("halved")[0]
    assert (Path(halved.path).name, halved.line, halved.end_line) == ("half.glsl", 1, 3)
    assert halved.caller == kernel.index and kernel.caller is None
    assert [Path(path).name for path in trace.files] == ["one.glsl", "half.glsl"]
    assert trace.files[kernel.path][kernel.line - 1].startswith("float kernel")


def test_functions_of_the_kernels_own_file_are_recorded_first(any_engine, steps):
    own = any_engine.trace(steps, "a", texel=(5, 2))
    assert own.functions == ("is_over", "kernel") and own.others == ("halved",)
    assert not own.calls_of("halved") and own.is_exact
    one = any_engine.trace(steps, "a", texel=(5, 2), function="halved")
    assert {call.function for call in one.calls} == {"halved"} and one.is_exact


COUNT = """#pragma kernel(output = "a:r32f", repeat = "6")
float kernel(ivec2 texel) {
    float before = previous(texel + ivec2(1, 0));
    return before * 2.0 + float(iteration) + float(texel.x);
}
"""


def test_an_iteration_reads_what_the_one_before_left(engine, folder):
    sketch = folder.one(COUNT)
    values = np.zeros((17, 17))
    before = []
    for iteration in range(6):
        before.append(values)
        shifted = np.concatenate([values[:, 1:], values[:, -1:]], axis=1)
        values = shifted * 2.0 + iteration + np.arange(17)
    for iteration in (0, 3, None):
        trace = engine.trace(sketch, "a", texel=(4, 9), iteration=iteration)
        number = 5 if iteration is None else iteration
        assert trace.iteration == (number,) and trace.is_exact
        assert trace.calls[0]["before"] == before[number][9, 5]


AT_ONCE = """#pragma kernel(output = "a:r32f", repeat = "6", at_once = "4")
float kernel(ivec2 texel) {
    float sum = previous(texel);
    for (int i = iteration; i < until; i++) sum += float(i * i);
    return sum;
}
"""


def test_iterations_that_run_at_once_are_traced_up_to_one(any_engine, folder):
    sketch = folder.one(AT_ONCE)
    for iteration, first in ((0, 0), (2, 0), (3, 0), (4, 4), (5, 4)):
        trace = any_engine.trace(sketch, "a", texel=(3, 3), iteration=iteration)
        stopped = any_engine.read(sketch, "a", steps={"a": iteration + 1})[3, 3]
        assert trace.outputs["a"] == (stopped,) == (sum(i * i for i in range(iteration + 1)),)
        assert len(trace.loops()[0].rows) == iteration + 1 - first and trace.is_exact


ADD = """#pragma kernel(output = "a:r32f")
uniform sampler2D state; //! input("zero")
float kernel(ivec2 texel) {
    float before = texelFetch(state, texel, 0).r;
    return before + float(iteration + 1);
}
"""


def test_a_pass_in_a_loop_is_traced_in_any_of_its_iterations(any_engine, folder):
    sketch = folder.one(ADD, more='repeat = 5\nfeedback = { state = "a" }\n')
    for number in range(5):
        trace = any_engine.trace(sketch, "a", texel=(3, 3), iteration=number)
        assert trace.calls[0]["before"] == sum(range(number + 1)) and trace.is_exact
    assert trace.outputs["a"] == (15.0,) == (any_engine.read(sketch, "a")[3, 3],)


TWICE = """#pragma kernel(output = "a:r32f", repeat = "2")
uniform sampler2D state; //! input("zero")
float kernel(ivec2 texel) {
    float start = texelFetch(state, texel, 0).r;
    return previous(texel) + start + 1.0;
}
"""


def test_a_kernel_that_repeats_in_a_loop_has_two_iterations(any_engine, folder):
    sketch = folder.one(TWICE, more='repeat = 3\nfeedback = { state = "a" }\n')
    start = 0.0
    for loop in range(3):
        value = 0.0
        for repeat in range(2):
            trace = any_engine.trace(sketch, "a", texel=(2, 5), iteration=(loop, repeat))
            value += start + 1.0
            assert trace.calls[0]["start"] == start and trace.outputs["a"] == (value,) and trace.is_exact
        start = value


GROW = """#pragma kernel(output = "a:r32f")
uniform sampler2D before; //! input("black")
float kernel(ivec2 texel) {
    float smaller = texelFetch(before, texel / 2, 0).r;
    return smaller + float(size.x);
}
"""


def test_an_iteration_has_the_size_and_the_count_of_its_own(any_engine, folder):
    folder.kernels(grow=GROW)
    inner = ("./grow", 'repeat = "iteration + 1"', 'size = "2 ** (iteration + 1) + iterations"')
    fed = 'feedback = { before = "a" }'
    folder.write("inner.toml", passes(grow=(*inner, fed)) + '[inputs]\nbefore = "grow.before"\n')
    sketch = folder.sketch(passes(a=("./inner", "repeat = 3", fed)))
    sides = {(n, k): 2 ** (k + 1) + n + 1 for n in range(3) for k in range(n + 1)}
    total = 0
    for iteration, side in sides.items():
        trace = any_engine.trace(sketch, "a.grow", texel=(side - 1, side - 1), iteration=iteration)
        assert trace.is_exact and trace.calls[0]["smaller"] == total
        total += side
        assert trace.outputs["a"] == (total,)
    with pytest.raises(ParameterError, match="6 x 6 texels in iteration 1, 1; 0 to 5"):
        any_engine.trace(sketch, "a.grow", texel=(6, 0), iteration=(1, 1))
    with pytest.raises(ParameterError, match=r"iteration 1 of 'a\.grow', which has 1"):
        any_engine.trace(sketch, "a.grow", texel=(0, 0), iteration=(0, 1))


def test_a_loop_over_frames_goes_on_from_a_state_that_is_kept(any_engine, folder):
    sketch = folder.one(ADD, more='repeat = "frames"\nfeedback = { state = "a" }\n')
    expected = any_engine.read(sketch, "a", time=0.5)
    runs, kept = dict(any_engine.runs), len(any_engine.cache.states)
    trace = any_engine.trace(sketch, "a", texel=(3, 3), time=0.5)
    assert kept and trace.iteration == (30,) and trace.is_exact
    assert trace.calls[0]["before"] == sum(range(31)) and trace.outputs["a"] == (expected[3, 3],)
    assert dict(any_engine.runs) == runs and len(any_engine.cache.states) == kept


SLOPE = """#version 330
out vec4 colour;
void main() {
    vec2 place = floor(gl_FragCoord.xy);
    vec2 slope = vec2(dFdx(place.x * place.x), dFdy(place.y * place.y));
    colour = vec4(slope / 64.0, 0.0, 1.0);
}
"""


@pytest.mark.parametrize("texel", [(4, 4), (5, 6), (8, 3), (15, 15)])
def test_derivatives_are_those_of_the_texels_own_quad(any_engine, tmp_path, texel):
    path = tmp_path / "slope.frag"
    path.write_text(SLOPE)
    trace = any_engine.trace(load(path), "view", texel=texel, size=(16, 16))
    expected = tuple(float((n | 1) ** 2 - (n & ~1) ** 2) for n in texel)
    assert trace.calls[0]["slope"] == expected and trace.is_exact


TWO = """#pragma kernel(output = "a:rg32f, b:r8")
uniform sampler2D h; //! input
void kernel(ivec2 texel, out vec2 a, out float b) {
    vec2 place = vec2(texel) / vec2(textureSize(h, 0));
    float low = texelFetch(h, texel, 0).r;
    a = place + low;
    b = place.x;
}
"""


def test_each_output_is_compared_with_its_texel(engine, folder):
    folder.kernels(h=COUNT.replace("a:r32f", "h:r32f"), two=TWO)
    sketch = folder.sketch(passes(h="./h", two="./two"))
    trace = engine.trace(sketch, "two", texel=(4, 8))
    low = engine.read(sketch, "h")[8, 4]
    assert trace.calls[0]["low"] == low and trace.is_exact
    assert trace.outputs["a"] == (f32(4 / 17) + low, f32(8 / 17) + low)
    assert trace.outputs["b"] == pytest.approx((4 / 17,), abs=0.5 / 255)
    assert trace.texel_values["b"] == (engine.read(sketch, "two:b")[8, 4],)


SHEET = """#pragma draw(mesh = "sheet", output = "frame:rgba32f")
vec4 vertex(vec3 corner, out vec2 place, out int side) {
    place = corner.xy * 8.0;
    side = 7;
    return vec4(corner.x, corner.y * 2.0 - 1.0, 0.25, 1.0);
}
vec4 fragment(vec2 place, int side) {
    if (place.y > 4.0) discard;
    float across = dFdx(place.x);
    return vec4(place, across, float(side) + gl_FragCoord.z);
}
"""


def test_a_draw_hands_its_fragment_what_the_mesh_has_there(any_engine, folder):
    """The sheet covers the right half: place.x runs from 0 to 8 over 8 of 16 pixels."""
    sketch = folder.one(SHEET, size="size = 16")
    trace = any_engine.trace(sketch, "a", texel=(11, 3))
    call = trace.calls_of("fragment")[0]
    assert call["place"] == pytest.approx((3.5, 1.75)) and call["side"] == 7
    assert call["across"] == pytest.approx(1.0)
    assert trace.outputs["frame"] == pytest.approx((3.5, 1.75, 1.0, 7.625)) and trace.is_exact
    gone = any_engine.trace(sketch, "a", texel=(11, 12))
    assert gone.is_discarded and not gone.outputs and gone.events[-1].kind == "discard"
    with pytest.raises(ParameterError, match="nothing is drawn"):
        any_engine.trace(sketch, "a", texel=(3, 3))


def test_not_a_number_is_found_where_it_first_appears(any_engine, folder):
    kernel = """#pragma kernel(output = "a:r32f")
float root(float x) {
    float below = x - 8.0;
    return sqrt(below);
}
float kernel(ivec2 texel) { return root(float(texel.x)); }
"""
    sketch = folder.one(kernel)
    assert any_engine.trace(sketch, "a", texel=(9, 0)).first_not_finite() is None
    event = any_engine.trace(sketch, "a", texel=(3, 0)).first_not_finite()
    assert (event.line, event.kind, event.name) == (4, "return", "root") and math.isnan(event.value)


@pytest.mark.room("dialects")
def test_a_shader_of_another_tool_is_traced_in_its_own_lines(any_engine, tmp_path):
    path = tmp_path / "rings.frag"
    path.write_text(
        "float ring(vec2 p) { return floor(length(p)); }\n"
        "void mainImage(out vec4 colour, in vec2 pixel) {\n"
        "    vec2 p = pixel - 0.5 * iResolution.xy;\n"
        "    for (int i = 0; i < 3; ++i) p *= 0.5;\n"
        "    colour = vec4(ring(p), fract(iTime), 0.0, 1.0);\n"
        "}\n"
    )
    trace = any_engine.trace(load(path), "view", texel=(40, 30), size=(64, 36), time=1.25)
    image, ring = trace.calls_of("mainImage")[0], trace.calls_of("ring")[0]
    assert image.values("p") == [(8.5, 12.5), (4.25, 6.25), (2.125, 3.125), (1.0625, 1.5625)]
    assert ring.result == 1.0 and ring.caller == image.index and (ring.line, image.line) == (1, 2)
    assert image["colour"] == (1.0, 0.25, 0.0, 1.0) and trace.is_exact


def test_a_trace_changes_nothing_that_is_drawn_afterwards(any_engine, folder):
    folder.kernels(h=COUNT.replace("a:r32f", "h:r32f"), two=TWO)
    sketch = folder.sketch(passes(h="./h", two="./two") + map_of("two:b"))
    before = any_engine.render(sketch, size=(64, 36))
    record, runs, bound = any_engine.record, dict(any_engine.runs), any_engine.ctx.fbo
    programs, results = any_engine.runner.programs.compiled, dict(any_engine.record.results)
    for path in ("h", "two", "view"):
        trace = any_engine.trace_frame(path, texel=(5, 5), iteration=2 if path == "h" else None)
        assert trace.is_exact
    assert any_engine.runner.programs.compiled == programs
    other = sketch.with_values({"view.channel": "red"})
    any_engine.trace(other, "view", texel=(1, 1), size=(32, 18), function="all")
    assert any_engine.record is record and dict(any_engine.runs) == runs
    assert dict(any_engine.record.results) == results and any_engine.ctx.fbo is bound
    assert any_engine.stale(sketch, size=(64, 36)) == []
    again = any_engine.render(sketch, size=(64, 36))
    assert again.array.tobytes() == before.array.tobytes() and dict(any_engine.runs) == runs
    with Engine(any_engine.ctx) as fresh:
        assert fresh.render(sketch, size=(64, 36)).array.tobytes() == before.array.tobytes()


def test_a_trace_of_more_iterations_leaves_a_stopped_picture(any_engine, folder):
    folder.kernels(h=COUNT.replace("a:r32f", "h:r32f"))
    sketch = folder.sketch(passes(h="./h") + map_of("h"))
    stopped = any_engine.render(sketch, size=(64, 36), steps={"h": 2})
    trace = any_engine.trace(sketch, "h", texel=(5, 5), size=(64, 36))
    assert trace.iteration == (5,) and trace.is_exact
    assert any_engine.record.plan.steps == {"h": 2}
    assert any_engine.trace_frame("h", texel=(5, 5)).iteration == (1,)
    again = any_engine.render(sketch, size=(64, 36), steps={"h": 2})
    assert again.array.tobytes() == stopped.array.tobytes()


def test_a_picture_that_failed_is_not_drawn_again_for_a_trace(any_engine, folder, steps):
    folder.write("broken.glsl", COUNT.replace("before * 2.0", "behind"))
    with pytest.raises(ShaderError):
        any_engine.render(folder.sketch(passes(h="./broken") + map_of("h")), size=(64, 36))
    assert any_engine.trace(steps, "a", texel=(1, 1)).is_exact


def test_the_limit_cuts_a_trace_and_says_so(any_engine, steps):
    whole = any_engine.trace(steps, "a", texel=(9, 0))
    cut = any_engine.trace(steps, "a", texel=(9, 0), limit=20)
    assert whole.is_complete and not cut.is_complete and cut.count == whole.count > 50
    assert cut.is_exact and len(cut.events) <= 20
    assert [e.value for e in cut.events] == [e.value for e in whole.events[: len(cut.events)]]


def test_more_events_than_a_small_target_holds_are_all_there(any_engine, folder):
    kernel = """#pragma kernel(output = "a:r32f")
float kernel(ivec2 texel) {
    float sum = 0.0;
    for (int i = 0; i < 3000; i++) sum += 1.0;
    return sum;
}
"""
    trace = any_engine.trace(folder.one(kernel), "a", texel=(1, 1))
    assert trace.calls[0].values("sum") == [float(n) for n in range(3001)]
    assert len(trace.loops()[0].rows) == 3000 and trace.is_complete


def test_two_texels_part_at_a_condition(any_engine, steps):
    one, other = (any_engine.trace(steps, "a", texel=(x, 0)) for x in (4, 9))
    first = first_difference(one, other, values=False)
    assert [(e.name, e.value) for e in first] == [("n % 2 == 0", False), ("n % 2 == 0", True)]


@pytest.mark.parametrize(
    ("path", "more", "kind", "words"),
    [
        ("b", {}, SketchError, "did you mean|there are"),
        ("a", {"texel": (17, 0)}, ParameterError, "17 x 17"),
        ("a", {"texel": (1.5, 0)}, ParameterError, "two whole numbers"),
        ("a", {"iteration": 6}, ParameterError, "0 to 5"),
        ("a", {"iteration": (1, 2)}, ParameterError, "6 iterations"),
        ("a", {"function": "kernle"}, ParameterError, "'kernel'"),
        ("a", {"limit": 0}, ParameterError, "limit"),
        ("source", {}, SketchError, "processor"),
    ],
)
def test_what_cannot_be_traced_is_refused_with_what_can(any_engine, folder, path, more, kind, words):
    folder.write("one.glsl", COUNT)
    sketch = folder.sketch(passes(a="./one", source="generation/heightmap"))
    with pytest.raises(kind, match=words):
        any_engine.trace(sketch, path, **{"texel": (0, 0), **more})


def test_a_text_that_cannot_be_read_is_refused_at_its_line(any_engine, folder):
    deep = "(" * 70 + "1.0" + ")" * 70
    kernel = f'#pragma kernel(output = "a:r32f")\nfloat kernel(ivec2 texel) {{ return {deep}; }}\n'
    with pytest.raises(ShaderError, match=r"one\.glsl:2.*cannot be traced"):
        any_engine.trace(folder.one(kernel), "a", texel=(0, 0))


# ── every shipped sketch ─────────────────────────────────────────────────────


@pytest.mark.slow
@pytest.mark.parametrize("name", shipped_sketches())
def test_traces_of_shipped_passes_have_the_texels_bits(any_engine, name):
    for result in traces_of(any_engine, name, texels=3, earlier=1):
        assert not result.unequal, result


QUICK = ("channels", "delaunay_flips", "diamond_square_steps", "fluid", "value_noise_curve")
"""Sketches whose passes softpipe draws in seconds, some of them in loops."""


@pytest.mark.slow
def test_traces_under_softpipe_have_the_texels_bits():
    """It is a second implementation, of OpenGL 3.3 without compute; a process has one renderer."""
    settings = ["--texels=2", "--earlier=1", "--side=17", "--width=32", "--values=64"]
    command = [sys.executable, "-m", "tests.traces", "--here", *settings, *QUICK]
    environment = os.environ | {"GALLIUM_DRIVER": "softpipe"}
    done = run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=180)
    assert done.returncode == 0, done.stderr
    renderer, *rows = done.stdout.splitlines()
    if renderer != "softpipe":
        pytest.skip("this OpenGL has no softpipe")
    results = [json.loads(row) for row in rows]
    assert {result["sketch"] for result in results} == set(QUICK)
    assert sum(result["earlier"] for result in results) >= 9
    assert not [result for result in results if result["unequal"]]
