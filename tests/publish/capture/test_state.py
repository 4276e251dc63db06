"""Films, sequences, shots and sheets of a sketch with state go on from frame to frame."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.publish.series import NumberedFiles, Series, write_series
from playground.publish.video import Video, VideoFile
from playground.verify.shots.suite import render_shot, shots_of

from ...loading import load
from ...sketch_texts import map_of, passes
from .series import pictures

TRAIL = """#pragma kernel(output = "trail:r32f")
uniform sampler2D before;    //! input("zero")
uniform float fade = 0.1;    //! slider(0, 1)
float kernel(ivec2 texel) {
    vec2 away = vec2(texel) - vec2(size) * (0.5 + 0.4 * vec2(cos(3.0 * time), sin(5.0 * time)));
    return max(texelFetch(before, texel, 0).r * (1.0 - fade), exp(-0.1 * dot(away, away)));
}
"""
GAIN = """#pragma kernel(output = "shown:r32f")
uniform sampler2D trail;     //! input
uniform float gain = 1.0;    //! slider(0, 2)
float kernel(ivec2 texel) { return gain * texelFetch(trail, texel, 0).r; }
"""
SHOTS = "".join(
    f'[[shot]]\nname = "at-{i}"\nsize = [32, 32]\ntime = {t}\n' for i, t in enumerate((0, 0.5, 2))
)
SKETCH = (
    "format = 1\nsize = 33\n"
    + passes(trail=("./trail", 'repeat = "frames"', 'feedback = { before = "trail" }'), gain="./gain")
    + map_of("gain", "red")
    + SHOTS
)
SIZE = (32, 32)


@pytest.fixture
def sketch(tmp_path: Path):
    (tmp_path / "trail.glsl").write_text(TRAIL, encoding="utf-8")
    (tmp_path / "gain.glsl").write_text(GAIN, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    return load(tmp_path / "sketch.toml")


@pytest.mark.parametrize(("fps", "last"), [(60, 119), (24, 117), (120, 119)])
def test_a_film_runs_each_frame_once(any_engine: Engine, sketch, fps, last):
    film = Series.at_times(sketch, seconds=2, fps=fps, size=SIZE)
    result = pictures(any_engine, film)
    assert any_engine.runs["trail"] == last + 1
    with Engine(any_engine.ctx) as cold:
        for number in (0, film.count // 2, film.count - 1):
            alone = cold.render(sketch, size=SIZE, time=film.time(number)).array
            np.testing.assert_array_equal(result[number], alone)
    assert (result[0] != result[-1]).any()


def test_a_film_that_begins_later_runs_what_is_before_it_once(any_engine: Engine, sketch):
    pictures(any_engine, Series.at_times(sketch, seconds=0.5, fps=60, size=SIZE, start=1.0))
    assert any_engine.runs["trail"] == 60 + 30


@pytest.mark.slow
def test_a_film_rendered_twice_has_the_same_bytes(ctx, sketch, tmp_path: Path):
    film, written = Series.at_times(sketch, seconds=1, fps=30, size=SIZE), set()
    for name in ("one", "two"):
        with Engine(ctx) as engine:
            write_series(engine, film, VideoFile(tmp_path / f"{name}.mp4"))
            written.add((tmp_path / f"{name}.mp4").read_bytes())
    with Engine(ctx) as engine:
        drawn = pictures(engine, film)
    scraps = np.random.default_rng(1)  # what lies in memory that the encoder gets
    for number in range(40):
        with Video(tmp_path / f"{number}.mp4", SIZE, film.fps, film.count) as video:
            for picture in drawn:
                for size in scraps.integers(100, 200_000, 3):
                    scraps.integers(0, 255, size).astype(np.uint8).tobytes()
                video.add(picture)
        written.add(video.path.read_bytes())
    assert len(written) == 1


def test_sequence_runs_each_frame_once_and_resumes(any_engine: Engine, sketch, tmp_path):
    film, pattern = Series.at_times(sketch, seconds=1, fps=30, size=SIZE), tmp_path / "frames" / "%03d.png"
    write_series(any_engine, film, NumberedFiles(pattern))
    assert any_engine.runs["trail"] == 59
    files = sorted((tmp_path / "frames").iterdir())
    first = [file.read_bytes() for file in files]
    for file in files[20:]:
        file.unlink()
    with Engine(any_engine.ctx) as cold:
        sink = NumberedFiles(pattern, resume=True)
        write_series(cold, film, sink)
        assert len(sink.kept) == 20
        assert cold.runs["trail"] == 59, "the frames before those that are missing run once as well"
    assert [file.read_bytes() for file in files] == first


def test_shots_in_the_order_of_their_times_go_on(any_engine: Engine, sketch):
    arrays = [render_shot(any_engine, case).array for case in shots_of([sketch])]
    assert any_engine.runs["trail"] == 121
    backwards = [render_shot(any_engine, case).array for case in reversed(shots_of([sketch]))]
    np.testing.assert_array_equal(arrays, backwards[::-1])
    assert any_engine.runs["trail"] < 121 + 31 + 121


def test_sheet_runs_state_once_if_swept_value_does_not_affect_it(any_engine: Engine, sketch):
    sheet = Series.of_values(sketch, ["gain.gain=0.5,1,2"], size=SIZE, time=1.0)
    assert len(pictures(any_engine, sheet)) == 3
    assert any_engine.runs["trail"] == 61
    sheet = Series.of_values(sketch, ["trail.fade=0.05,0.2"], size=SIZE, time=1.0)
    first, other = pictures(any_engine, sheet)
    assert (first != other).any()
    assert any_engine.runs["trail"] == 3 * 61, "with another value, each frame is another"
