"""A loop over frames reads a film, and a kernel that goes by time, as each frame had them."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine.engine import Engine
from tests.data.films import colour, own_film

from ..loading import load
from ..sketch_texts import passes

SKETCH = (
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
def sketch(folder, tmp_path):
    own_film(tmp_path / "v.mp4", count=30, fps=20)
    for name, text in {"red": RED, "second": SECOND, "sum": SUM, "shown": SHOWN}.items():
        folder.write(f"{name}.glsl", text)
    return load(folder.write("sketch.toml", SKETCH))


def sums(engine: Engine, sketch, time: float) -> np.ndarray:
    return engine.read(sketch, "sums", size=(8, 8), time=time)[0, 0].copy()


@pytest.mark.parametrize("time", [0.0, 0.5, 2.0])
def test_each_frame_reads_what_was_shown_then(any_engine, sketch, time):
    frames = round(60 * time) + 1
    red = [colour(min(frame * 20 // 60, 29))[0] / 255 for frame in range(frames)]
    array = sums(any_engine, sketch, time)
    # A byte of the film is exact to a few of its steps: yuv420p keeps 219 of 256, and one is a flat patch.
    np.testing.assert_allclose(array[0], sum(red), atol=frames * 5 / 255)
    np.testing.assert_allclose(array[1], sum(frame / 60 for frame in range(frames)), rtol=frames * 2**-23)
    assert array[3] == frames


def test_a_later_moment_runs_only_the_frames_between(any_engine, sketch):
    any_engine.draw(sketch, size=(8, 8), time=0.5)
    assert {name: any_engine.runs[name] for name in ("film", "red", "second", "sums", "still")} == {
        "film": 31,
        "red": 31,
        "second": 31,
        "sums": 31,
        "still": 1,
    }
    any_engine.draw(sketch, size=(8, 8), time=0.6)
    assert any_engine.runs["sums"] == 37 and any_engine.runs["still"] == 1


def test_the_picture_is_the_same_from_cold_and_from_warm(ctx, sketch):
    with Engine(ctx) as warm:
        for time in (0.7, 0.2, 1.0, 0.7):
            with Engine(ctx) as cold:
                expected = cold.render(sketch, size=(8, 8), time=time).array
            np.testing.assert_array_equal(warm.render(sketch, size=(8, 8), time=time).array, expected)


def test_another_loop_between_them_keeps_them_outside(folder, sketch, any_engine):
    text = SKETCH.replace(
        'use = "./red"\ninputs', 'use = "./blur"\nrepeat = "2"\nfeedback = { film = "red" }\ninputs'
    )
    folder.write("blur.toml", '[[pass]]\nname = "red"\nuse = "./red"\n[inputs]\nfilm = "red.film"\n')
    array = sums(any_engine, load(folder.write("other.toml", text)), 0.5)
    assert array[3] == 31 and np.isfinite(array).all()
