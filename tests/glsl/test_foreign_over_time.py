"""Films and sounds as channels of other tools' shaders: the right texels at the right time."""

from __future__ import annotations

import re
import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from playground.data import media
from playground.engine.disk_caching import passing
from playground.errors import ContextError, DataError, ShaderError
from playground.extras import install_command
from playground.publish.series import Series
from playground.sketch.traits import is_animated
from tests.data.films import RATE, colour, own_film, sound, uneven_film
from tests.publish.capture.series import pictures

from ..loading import load

pytestmark = pytest.mark.room("dialects")

SKETCH = """format = 1
size = 8
[[pass]]
name = "a"
use = "foreign/{}"
set = {{ {} }}
{}
[view]
use = "./shown"
inputs = {{ iChannel0 = "a" }}
"""
SHOWN = """void mainImage(out vec4 colour, vec2 place) {
    colour = textureLod(iChannel0, place / iResolution.xy, 0.0);
}
"""


@pytest.fixture
def sketch(tmp_path):
    def made(kernel: str, setting: str, size: str = ""):
        (tmp_path / "shown.glsl").write_text(SHOWN)
        path = tmp_path / "s.toml"
        path.write_text(SKETCH.format(kernel, setting, f"size = {size}" if size else ""))
        return load(path)

    return made


def shown(pixels: np.ndarray) -> np.ndarray:
    """Return the colour in the south-east of a texture's values."""
    return pixels[1, -2, :3] * 255


def test_film_shows_frame_of_its_time_in_any_seek_order(any_engine, sketch, tmp_path):
    stamps = [0, 40, 50, 120, 500, 510, 900]
    uneven_film(tmp_path / "v.mkv", stamps)
    made = sketch("video", 'video = "v.mkv", loop = false')
    for milliseconds in (0, 45, 900, 505, 499, 41, 2000, 0, 119):
        values = any_engine.read(made, "a", time=milliseconds / 1000)
        assert values.shape == (48, 64, 4), "the film's own size"
        expected = max(i for i, stamp in enumerate(stamps) if stamp <= milliseconds)
        np.testing.assert_allclose(shown(values), colour(expected), atol=6)
        assert values[-4, 3, :3].max() < 0.05, "north is on top"


def test_a_film_s_pass_runs_only_when_its_frame_changes(any_engine, sketch, tmp_path):
    own_film(tmp_path / "v.mp4", count=5, fps=10)
    made = sketch("video", 'video = "v.mp4"')
    for time in (0.0, 0.01, 0.099, 0.1, 0.15, 0.5, 0.55):  # frames 0 0 0 1 1 0 0
        any_engine.draw(made, size=(32, 24), time=time)
    assert any_engine.runs["a"] == 2, "the loop's first frame is still there"
    assert any_engine.stale(made, size=(32, 24), time=0.19) == []
    assert any_engine.stale(made, size=(32, 24), time=0.2) == ["a", "view.view"]


@pytest.mark.parametrize(
    ("setting", "time", "expected"),
    [
        ("start = 0.4", 0.1, 5),
        ("speed = 2.0", 0.2, 4),
        ("speed = 0.5", 0.3, 1),
        ("speed = -1.0, start = 0.75", 0.2, 5),
        ("start = -0.5, loop = false", 0.3, 0),
        ("loop = false", 9.0, 9),
        ("loop = true", 1.3, 3),
    ],
)
def test_start_speed_and_loop(any_engine, sketch, tmp_path, setting, time, expected):
    own_film(tmp_path / "v.mp4", count=10, fps=10)
    values = any_engine.read(sketch("video", f'video = "v.mp4", {setting}'), "a", time=time)
    np.testing.assert_allclose(shown(values), colour(expected), atol=5)


def test_a_pass_may_say_its_size(any_engine, sketch, tmp_path):
    own_film(tmp_path / "v.mp4", count=2)
    values = any_engine.read(sketch("video", 'video = "v.mp4"', "[16, 12]"), "a")
    assert values.shape == (12, 16, 4)
    np.testing.assert_allclose(shown(values), colour(0), atol=5)


def test_another_film_of_the_same_name_has_its_own_size(any_engine, sketch, tmp_path):
    own_film(tmp_path / "v.mp4", count=2)
    made = sketch("video", 'video = "v.mp4"')
    assert any_engine.read(made, "a").shape == (48, 64, 4)
    own_film(tmp_path / "v.mp4", count=2, size=(32, 16))
    assert any_engine.read(made, "a").shape == (16, 32, 4)


def test_a_film_of_a_film_is_the_same_twice(any_engine, sketch, tmp_path):
    own_film(tmp_path / "v.mp4", count=12, fps=12)
    film = Series.at_times(sketch("video", 'video = "v.mp4"'), seconds=1.0, fps=Fraction(8), size=(32, 24))
    first, second = pictures(any_engine, film), pictures(any_engine, film)
    assert len(first) == 8 and all(np.array_equal(a, b) for a, b in zip(first, second, strict=True))
    assert not np.array_equal(first[0], first[4])


def test_a_sound_s_texture_is_shadertoy_s(any_engine, sketch, tmp_path):
    tone = 0.02 * np.sin(2 * np.pi * 100 / media.WINDOW * np.arange(2 * RATE))
    tone[:RATE] = 0.0
    sound(tmp_path / "s.wav", tone[None])
    made = sketch("sound", 'sound = "s.wav", loop = false')
    at = {time: any_engine.read(made, "a", time=time) for time in (0.9, 1.9, 0.9, 5.0, 1.9)}
    assert at[1.9].shape == (2, 512)
    assert at[1.9][0].argmax() == 100 and at[1.9][0, 100] > 0.5
    wave = tone[int(1.9 * RATE) - 2048 :][:512]
    np.testing.assert_allclose(at[1.9][1], 0.5 + wave / 2, atol=1 / 127)
    for silent in (at[0.9], at[5.0]):
        assert (silent[0] == 0).all()
        np.testing.assert_array_equal(silent[1], np.float32(128 / 255))


def test_a_sound_as_waves_and_as_a_spectrum(any_engine, sketch, tmp_path):
    both = 0.02 * np.sin(2 * np.pi * np.outer([50, 400], np.arange(RATE)) / media.WINDOW)
    sound(tmp_path / "s.flac", both)
    waves = any_engine.read(sketch("sound", 'sound = "s.flac", content = "waves"', "[256, 2]"), "a", time=0.5)
    end = RATE // 2
    np.testing.assert_allclose(waves, 0.5 + both[:, end - 256 : end] / 2, atol=1 / 127)
    spectrum = any_engine.read(sketch("sound", 'sound = "s.flac", content = "spectrum"'), "a", time=0.9)
    assert spectrum.shape == (2, 1024) and spectrum.argmax(1).tolist() == [50, 400]


def test_a_wrong_file_is_a_sentence_at_the_pass_that_names_it(any_engine, sketch, tmp_path, monkeypatch):
    (tmp_path / "v.mp4").write_text("no film" * 99)
    for kernel, name in (("video", "video"), ("sound", "sound")):
        with pytest.raises(DataError, match=f"v.mp4: not a {name} file that can be read") as error:
            any_engine.read(sketch(kernel, f'{name} = "v.mp4"'), "a")
        assert error.value.diagnostics[0].line == 3
        with pytest.raises(DataError, match="not a"):
            any_engine.read(sketch(kernel, f'{name} = "v.mp4"', "[4, 4]"), "a")
    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(ContextError, match=f"needs PyAV: {re.escape(install_command('video'))}"):
        any_engine.read(sketch("video", 'video = "v.mp4"'), "a")


def test_a_film_moves_the_picture_and_is_not_cached_on_disk(any_engine, sketch, tmp_path):
    own_film(tmp_path / "v.mp4", count=2)
    made = sketch("video", 'video = "v.mp4"')
    assert is_animated(made)
    assert "a" in passing(any_engine.plan(made, (32, 24)))


def test_a_misspelt_film_has_its_nearest_name(any_engine, sketch, tmp_path):
    own_film(tmp_path / "waves.mp4", count=2)
    with pytest.raises(DataError, match=r"no such file; did you mean 'waves.mp4'"):
        any_engine.read(sketch("video", 'video = "wave.mp4"'), "a")


def test_a_source_reads_what_it_says(tmp_path):
    text = Path("glsl/foreign/video.glsl").read_text().replace('reads = "time"', 'reads = "tim"')
    (tmp_path / "x.glsl").write_text(text)
    with pytest.raises(ShaderError, match="a source cannot read 'tim'; did you mean 'time'"):
        load(tmp_path / "x.glsl")
