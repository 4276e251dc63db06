"""A loop that counts frames: frame n is at n / 60 s, from the first, whatever was drawn before."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.shader.reserved_names import CLOCKED
from playground.sketch.traits import has_moving_counts, is_animated
from tests.data.films import colour, own_film

from ..loading import load
from ..sketch_texts import passes

STATE = """// Each texel takes the mean of the one to its west and of the other pass, and what goes by time.
#pragma kernel(output = "state:rgba32f")
uniform sampler2D own;    //! input("zero")
uniform sampler2D other;  //! input
vec4 kernel(ivec2 texel) {
    ivec2 whole = textureSize(own, 0);
    vec4 west = texelFetch(own, ivec2((texel.x + whole.x - 1) % whole.x, texel.y), 0);
    ivec2 there = min(texel, textureSize(other, 0) - 1);
    return vec4(0.5 * (west.r + texelFetch(other, there, 0).r) + float(int(round(60.0 * time)) % 4), time,
                vec2(whole));
}
"""
OTHER = """#pragma kernel(output = "other:r32f")
uniform sampler2D own;  //! input("zero")
float kernel(ivec2 texel) { return 0.25 * texelFetch(own, texel, 0).r + float(texel.x + 2 * texel.y); }
"""
STILL = """#pragma kernel(output = "still:r32f")
float kernel(ivec2 texel) { return float(texel.x); }
"""
SHOW = """#pragma kernel(output = "shown:rgba16f")
uniform sampler2D state;  //! input
uniform sampler2D still;  //! input
vec4 kernel(ivec2 texel) { return texelFetch(state, texel, 0) / 32.0 + 0.0 * texelFetch(still, texel, 0); }
"""
INNER = (
    passes(
        other=("./other", 'size = ["view_size.size.x // 2", "view_size.size.y // 2 + 1"]'),
        state="./state",
        still="./still",
        show="./show",
    )
    + '[inputs]\nown = ["state.own", "other.own"]\n[outputs]\nshown = "show:shown"\nstate = "state:state"\n'
).replace("view_size.", "")
LOOP = '[[pass]]\nname = "loop"\nuse = "./USE"\nrepeat = "frames"\nfeedback = { INPUT = "OUTPUT" }\n'
SKETCH = f'format = 1\nsize = 8\n{passes(unread="./still")}[view]\nuse = "./loop"\n'


def looped(folder, use: str, output: str, fed: str):
    """Return a sketch whose picture is a technique that runs once a frame, from the frame before."""
    folder.write("still.glsl", STILL)
    folder.write("loop.toml", LOOP.replace("USE", use).replace("OUTPUT", output).replace("INPUT", fed))
    return load(folder.write("sketch.toml", SKETCH))


@pytest.fixture
def sketch(folder):
    folder.kernels(state=STATE, other=OTHER, show=SHOW)
    folder.write("inner.toml", INNER)
    return looped(folder, "inner", "state", "own")


def twin(size: tuple[int, int], frames: int) -> np.ndarray:
    """Return the state after so many frames, (height, width, 4), worked out texel by texel."""
    width, height = size
    small = (width // 2, height // 2 + 1)
    state = np.zeros((height, width, 4))
    for frame in range(frames):
        other = np.zeros((small[1], small[0]))
        for y in range(small[1]):
            for x in range(small[0]):
                other[y, x] = 0.25 * state[y, x, 0] + x + 2 * y
        new = np.empty_like(state)
        for y in range(height):
            for x in range(width):
                there = other[min(y, small[1] - 1), min(x, small[0] - 1)]
                new[y, x] = 0.5 * (state[y, x - 1, 0] + there) + frame % 4, frame / 60, width, height
        state = new
    return state


def states(engine: Engine, sketch, size: tuple[int, int], time: float) -> np.ndarray:
    return engine.read(sketch, "view.loop:state", size=size, time=time).copy()


@pytest.mark.parametrize("size", [(8, 6), (13, 9)])
@pytest.mark.parametrize("time", [0.0, 0.5, 1.0])
def test_a_frame_is_that_of_a_twin_stepped_from_the_first(any_engine, sketch, time, size):
    array = states(any_engine, sketch, size, time)
    # Two roundings a frame, of 2**-24 each; what is fed back comes back by 5 / 8.
    np.testing.assert_allclose(array, twin(size, round(60 * time) + 1), rtol=2 * 2**-24 / (1 - 5 / 8))


def test_what_reads_neither_time_nor_what_is_fed_back_runs_once(any_engine, sketch):
    any_engine.draw(sketch, size=(8, 6), time=0.5)
    assert any_engine.runs == {
        "view.loop.other": 31,
        "view.loop.state": 31,
        "view.loop.still": 1,
        "view.loop.show": 31,
    }
    any_engine.draw(sketch, size=(8, 6), time=0.75)
    assert any_engine.runs["view.loop.state"] == 46, "frames that are cached are not run again"
    assert any_engine.runs["view.loop.still"] == 1
    any_engine.draw(sketch, size=(8, 6), time=0.755)
    assert any_engine.record.ran == [], "the same frame"


@pytest.mark.slow
def test_the_picture_is_a_function_of_time_and_size_alone(ctx, sketch):
    def cold(time, size):
        with Engine(ctx) as engine:
            return states(engine, sketch, size, time), engine.render(sketch, size=size, time=time).array

    with Engine(ctx) as warm:
        for time, size in ((2.0, (8, 6)), (1.0, (8, 6)), (1.0, (13, 9)), (0.0, (8, 6)), (1.5, (8, 6))):
            result = states(warm, sketch, size, time), warm.render(sketch, size=size, time=time).array
            for first, other, again in zip(result, cold(time, size), cold(time, size), strict=True):
                assert first.tobytes() == other.tobytes() == again.tobytes()


DRAW = """void mainImage(out vec4 colour, in vec2 place) {
    vec2 whole = vec2(textureSize(iChannel0, 0));
    colour = texelFetch(iChannel0, ivec2(0), 0) + vec4(iMouse.x, 1.0, 0.0, 0.0) / 255.0;
    colour.z = (10.0 * whole.x + float(iFrame)) / 255.0;
}
"""


@pytest.fixture
def drawing(folder):
    folder.write("draw.frag", DRAW)
    return looped(folder, "draw", "frame", "iChannel0")


@pytest.mark.room("dialects")
def test_foreign_shader_reads_zeros_before_first_frame(any_engine, drawing):
    result = any_engine.read(drawing, "view.loop", size=(5, 4))
    np.testing.assert_array_equal(np.round(255 * result), np.broadcast_to([0, 1, 50, 255], (4, 5, 4)))


@pytest.mark.room("dialects")
def test_mouse_applies_from_its_frame_and_keeps_earlier_frames(any_engine, drawing):
    any_engine.read(drawing, "view.loop", size=(4, 4), time=4 / 60)
    any_engine.runner.drag = (2.0, 0.0, 0.0, 0.0)
    any_engine.read(drawing, "view.loop", size=(4, 4), time=4 / 60)
    assert any_engine.record.ran == []
    result = any_engine.read(drawing, "view.loop", size=(4, 4), time=7 / 60)
    assert any_engine.record.ran == ["view.loop.view"] * 3
    np.testing.assert_array_equal(np.round(255 * result[0, 0]), [6, 8, 47, 255])


@pytest.mark.room("dialects")
def test_window_inputs_changing_per_frame_are_frame_uniforms(any_engine, drawing):
    any_engine.draw(drawing, size=(4, 4))
    runner, step = any_engine.runner, any_engine.record.plan.step("view.loop.view")
    before = runner.frame_uniforms(step, 3)
    runner.mouse, runner.hover, runner.drag = (1.0, 2.0, 3.0, 4.0), (5.0, 6.0), (7.0, 8.0, 9.0, 10.0)
    runner.delta, runner.date = 0.5, (2026.0, 1.0, 2.0, 3.0)
    changed = {name for name, value in runner.frame_uniforms(step, 5).items() if value != before[name]}
    assert {"time", "frame", "mouse", "hover", "drag", "date"} <= changed <= CLOCKED


KERNEL = """#pragma kernel(output = "sum:r32f")
uniform sampler2D before;  //! input("black")
float kernel(ivec2 texel) {
    return texelFetch(before, texel, 0).r + time + (wired_before ? 100.0 : 0.0);
}
"""


def test_own_kernel_frame_loop_gets_frame_time_and_fallback(engine, folder):
    folder.write("sum.glsl", KERNEL)
    sketch = folder.sketch(passes(a=("./sum", 'repeat = "frames"', 'feedback = { before = "sum" }')))
    for last in (0, 1, 12, 6, 18):
        expected = sum(n / 60 + (100 if n else 0) for n in range(last + 1))
        np.testing.assert_allclose(engine.read(sketch, "a", time=last / 60), expected, rtol=1e-6)
    assert engine.runs["a"] < 13 + 13 + 18, "it went on"


def test_self_repeating_frame_kernel_gets_frame_time_and_resumes(engine, folder):
    sketch = folder.one(
        '#pragma kernel(output = "sum:r32f", repeat = "frames")\n'
        "float kernel(ivec2 texel) { return previous(texel) + time; }\n"
    )
    for last in (0, 12, 30):
        expected = sum(n / 60 for n in range(last + 1))
        np.testing.assert_allclose(engine.read(sketch, "a", time=last / 60), expected, rtol=1e-5)
    assert engine.record.texels == 18 * 17 * 17, "18 more frames"


def test_inner_loop_and_siblings_use_time_of_outer_frame(engine, folder):
    folder.write(
        "sum.glsl", KERNEL.replace('("black")', '("zero")').replace("time", "time * float(iteration + 1)")
    )
    folder.write(
        "now.glsl", '#pragma kernel(output = "now:r32f")\nfloat kernel(ivec2 texel) { return time; }\n'
    )
    folder.write(
        "frame.toml",
        passes(sum=("./sum", "repeat = 3", 'feedback = { before = "sum" }'), now="./now")
        + '[inputs]\nbefore = "sum.before"\n[outputs]\nsum = "sum:sum"\nnow = "now:now"\n',
    )
    sketch = folder.sketch(passes(a=("./frame", 'repeat = "frames"', 'feedback = { before = "sum" }')))
    total = 0.0
    for n in range(7):
        total += n / 60 * (1 + 2 + 3) + 300
    np.testing.assert_allclose(engine.read(sketch, "a:sum", time=0.1), total, rtol=1e-6)
    np.testing.assert_allclose(engine.read(sketch, "a:now", time=0.1), 0.1, rtol=1e-6)
    assert engine.runs == {"a.sum": 21, "a.now": 7}


def test_a_sketch_that_counts_frames_is_known_to_move(sketch):
    assert is_animated(sketch)
    assert has_moving_counts(sketch)


# ── A loop over frames reads a film, and a kernel that goes by time, as each frame had them


FILM_SKETCH = (
    "format = 1\nsize = 8\n"
    + passes(
        film=("foreign/video", 'set = { video = "v.mp4", loop = false }'),
        red=("./red", 'inputs = { film = "film" }'),
        second=("./second", "size = [1, 1]"),
        still=("foreign/noise", "size = [4, 4]"),
        sums=(
            "./sum",
            'repeat = "frames"',
            'feedback = { before = "sums" }',
            "size = [2, 2]",
            'inputs = { red = "red", second = "second", still = "still" }',
        ),
    )
    + """[view]
use = "./shown"
inputs = { sums = "sums", film = "film" }
"""
)
RED = """#pragma kernel(output = "red:r32f")
uniform sampler2D film;  //! input
float kernel(ivec2 texel) { return texelFetch(film, ivec2(textureSize(film, 0).x - 2, 1), 0).r; }
"""
SECOND = """#pragma kernel(output = "second:r32f")
float kernel(ivec2 texel) { return time; }
"""
SUM = """#pragma kernel(output = "sums:rgba32f")
uniform sampler2D before;  //! input("zero")
uniform sampler2D red;     //! input
uniform sampler2D second;  //! input
uniform sampler2D still;   //! input
vec4 kernel(ivec2 texel) {
    float film = texelFetch(red, ivec2(0), 0).r, now = texelFetch(second, ivec2(0), 0).r;
    return texelFetch(before, texel, 0) + vec4(film, now, texelFetch(still, texel, 0).r, 1.0);
}
"""
SHOWN = """#pragma kernel(output = "frame:rgba16f")
uniform sampler2D sums;  //! input
uniform sampler2D film;  //! input
vec4 kernel(ivec2 texel) {
    return texelFetch(sums, ivec2(0), 0) / 100.0 + 0.0 * texelFetch(film, ivec2(0), 0);
}
"""


@pytest.fixture
def film_sketch(folder, tmp_path):
    own_film(tmp_path / "v.mp4", count=30, fps=20)
    folder.kernels(red=RED, second=SECOND, sum=SUM, shown=SHOWN)
    return load(folder.write("sketch.toml", FILM_SKETCH))


def sums(engine: Engine, film_sketch, time: float) -> np.ndarray:
    return engine.read(film_sketch, "sums", size=(8, 8), time=time)[0, 0].copy()


@pytest.mark.parametrize("time", [0.0, 0.5, 2.0])
def test_each_frame_reads_what_was_shown_then(any_engine, film_sketch, time):
    frames = round(60 * time) + 1
    red = [colour(min(frame * 20 // 60, 29))[0] / 255 for frame in range(frames)]
    array = sums(any_engine, film_sketch, time)
    # A byte of the film is exact to a few of its steps: yuv420p keeps 219 of 256, and one is a flat patch.
    np.testing.assert_allclose(array[0], sum(red), atol=frames * 5 / 255)
    np.testing.assert_allclose(array[1], sum(frame / 60 for frame in range(frames)), rtol=frames * 2**-23)
    assert array[3] == frames


def test_a_later_moment_runs_only_the_frames_between(any_engine, film_sketch):
    any_engine.draw(film_sketch, size=(8, 8), time=0.5)
    assert {name: any_engine.runs[name] for name in ("film", "red", "second", "sums", "still")} == {
        "film": 31,
        "red": 31,
        "second": 31,
        "sums": 31,
        "still": 1,
    }
    any_engine.draw(film_sketch, size=(8, 8), time=0.6)
    assert any_engine.runs["sums"] == 37 and any_engine.runs["still"] == 1


def test_the_picture_is_the_same_from_cold_and_from_warm(ctx, film_sketch):
    with Engine(ctx) as warm:
        for time in (0.7, 0.2, 1.0, 0.7):
            with Engine(ctx) as cold:
                expected = cold.render(film_sketch, size=(8, 8), time=time).array
            np.testing.assert_array_equal(warm.render(film_sketch, size=(8, 8), time=time).array, expected)


def test_another_loop_between_them_keeps_them_outside(folder, film_sketch, any_engine):
    text = FILM_SKETCH.replace(
        'use = "./red"\ninputs', 'use = "./blur"\nrepeat = "2"\nfeedback = { film = "red" }\ninputs'
    )
    folder.write("blur.toml", '[[pass]]\nname = "red"\nuse = "./red"\n[inputs]\nfilm = "red.film"\n')
    array = sums(any_engine, load(folder.write("other.toml", text)), 0.5)
    assert array[3] == 31 and np.isfinite(array).all()
