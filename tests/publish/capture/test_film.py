"""Videos and numbered pictures: the right pictures, all of them, in the right colours, whole or not there."""

from __future__ import annotations

import itertools
import shutil
import sys
from collections import Counter
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import playground.publish.video as video_module
from playground.data.image_files import read_png, write_png
from playground.engine.engine import Engine
from playground.errors import ContextError, DataError, ParameterError, PlaygroundWarning
from playground.extras import install_command
from playground.publish.series import NumberedFiles, Series, render_sequence, write_series
from playground.publish.video import QUALITIES, Stopped, Video, VideoFile, count_pictures, render_video

from ...loading import load
from ...sketch_texts import LIT_NOISE, SMALL_VIEW
from .series import Arrays, pictures

av = pytest.importorskip("av")

CLOCK = """#version 330
uniform vec2 u_resolution;
uniform float u_time;
uniform int iFrame;
uniform float iTimeDelta;
out vec4 colour;
void main() { colour = vec4(u_time / 10.0, float(iFrame) / 255.0, iTimeDelta, 1.0); }
"""
KEYS = (
    "format = 1\nsize = 33\n"
    + LIT_NOISE
    + """[[keyframe]]
time = 0.0
camera = { azimuth = 100.0 }
set = { "light.sun" = [90, 20] }
[[keyframe]]
time = 0.4
camera = { azimuth = 190.0 }
set = { "light.sun" = [200, 60] }
"""
    + SMALL_VIEW
)


@pytest.fixture
def clock(tmp_path: Path):
    (tmp_path / "clock.frag").write_text(CLOCK, encoding="utf-8")
    return load(tmp_path / "clock.frag")


@pytest.fixture
def keyed(tmp_path: Path):
    (tmp_path / "keyed.toml").write_text(KEYS, encoding="utf-8")
    return load(tmp_path / "keyed.toml")


def decoded(path: Path) -> np.ndarray:
    with av.open(str(path)) as container:
        return np.stack(
            [
                frame.reformat(
                    format="rgb24", src_colorspace="ITU709", src_color_range="MPEG", dst_color_range="JPEG"
                ).to_ndarray()
                if frame.format.name.startswith("yuv")
                else frame.reformat(format="rgb24").to_ndarray()
                for frame in container.decode(video=0)
            ]
        )


# ── time ─────────────────────────────────────────────────────────────────────


def test_a_picture_is_that_of_its_number(any_engine: Engine, clock):
    film = Series.at_times(clock, seconds=0.5, fps=20, size=(4, 2), start=1.0)
    result = np.stack(pictures(any_engine, film))[:, 0, 0]
    times = 1.0 + np.arange(10) / 20
    np.testing.assert_allclose(result[:, 0] / 255, times / 10, atol=0.5 / 255)
    np.testing.assert_array_equal(result[:, 1], 60 + 3 * np.arange(10))
    np.testing.assert_allclose(result[:, 2] / 255, 0.05, atol=0.5 / 255)
    assert any_engine.runner.delta == 1 / 60, "as it was"


def test_keyframes_move_what_a_film_shows(any_engine: Engine, keyed):
    film = Series.at_times(keyed, fps=10, size=(64, 36))
    assert film.count == 4, "to the last keyframe"
    result = pictures(any_engine, film)
    for number, picture in enumerate(result):
        alone = any_engine.render(keyed.at(film.time(number)), size=(64, 36))
        np.testing.assert_array_equal(picture, alone.array)
    assert all((first != other).any() for first, other in itertools.pairwise(result))


def test_how_long_a_film_is(clock, keyed):
    assert Series.at_times(clock, seconds=2, fps=Fraction(30000, 1001)).count == 60
    assert Series.at_times(clock, seconds=2, fps=29.97).fps == Fraction(2997, 100)
    with pytest.raises(ParameterError, match="how long"):
        Series.at_times(clock)
    with pytest.raises(ParameterError, match="no keyframe after 9 s"):
        Series.at_times(keyed, start=9.0)
    with pytest.raises(ParameterError, match="expected 1 to"):
        Series.at_times(clock, seconds=0.001)
    with pytest.raises(ParameterError, match="pictures a second"):
        Series.at_times(clock, seconds=1, fps=0.0)


@pytest.mark.slow
def test_a_thousand_pictures_leave_as_many_objects_as_ten(any_engine: Engine, keyed, alive: Counter[str]):
    film = Series(sketch=keyed, count=10, fps=Fraction(25), size=(32, 18))
    pictures(any_engine, film)
    before, cached = Counter(alive), any_engine.cache.bytes
    film = Series(sketch=keyed, count=1000, fps=Fraction(2500), size=(32, 18))
    sink = Arrays()

    def done() -> None:
        assert len(sink.arrays) % 100 or alive == before

    write_series(any_engine, film, sink, done=done)
    assert alive == before and any_engine.cache.bytes == cached


def test_pictures_leave_no_objects(any_engine: Engine, keyed, alive: Counter[str]):
    pictures(any_engine, Series(sketch=keyed, count=5, fps=Fraction(25), size=(32, 18)))
    before, cached = Counter(alive), any_engine.cache.bytes
    pictures(any_engine, Series(sketch=keyed, count=60, fps=Fraction(150), size=(32, 18)))
    assert alive == before and any_engine.cache.bytes == cached


# ── what is in the file ──────────────────────────────────────────────────────

SMALL = (64, 36)


def ramps(count: int, size=SMALL) -> list[np.ndarray]:
    width, height = size
    arrays = []
    for number in range(count):
        picture = np.full((height, width, 4), 255, np.uint8)
        picture[..., 0] = np.linspace(0, 255, width)
        picture[..., 1] = np.linspace(0, 255, height)[:, None]
        picture[..., 2] = 255 * number // max(count - 1, 1)
        arrays.append(picture)
    return arrays


def encode(
    path: Path, arrays, fps=Fraction(10), count: int = 0, error: BaseException | None = None, **more
) -> Video:
    """Write pictures as a film of ``count``, or raise an error after the last."""
    with Video(path, arrays[0].shape[1::-1] if arrays else SMALL, fps, count or len(arrays), **more) as video:
        for picture in arrays:
            video.add(picture)
        if error is not None:
            raise error
    return video


def interrupted(path: Path, arrays, **more) -> Path | None:
    """Interrupt a film of five pictures, and return the shorter one."""
    with pytest.raises(Stopped) as caught:
        encode(path, arrays, count=5, error=KeyboardInterrupt(), **more)
    assert caught.value.count == len(arrays)
    return caught.value.path


@pytest.mark.parametrize(("ending", "worst"), [(".mp4", 2.0), (".webm", 2.0), (".gif", 12.0)])
def test_colours_come_back(tmp_path: Path, ending: str, worst: float):
    path, pictures = tmp_path / f"film{ending}", ramps(6, (128, 72))
    encode(path, pictures, Fraction(20))
    array = decoded(path)
    assert array.shape == (6, 72, 128, 3)
    error = np.abs(array.astype(int) - np.stack(pictures)[..., :3])
    assert error.mean() < worst
    assert abs(array.astype(float).mean() - np.stack(pictures)[..., :3].mean()) < 2.0, (
        "neither darker nor paler"
    )
    assert count_pictures(path) == (6, Fraction(20))
    assert [p.name for p in tmp_path.iterdir()] == [path.name], "nothing half written is left"


@pytest.mark.parametrize("ending", [".mp4", ".webm"])
def test_the_file_says_what_its_colours_mean(tmp_path: Path, ending: str):
    path = tmp_path / f"film{ending}"
    encode(path, ramps(3), Fraction(30000, 1001))
    with av.open(str(path)) as container:
        context = container.streams.video[0].codec_context
        marks = context.color_primaries, context.color_trc, context.colorspace, context.color_range
        assert marks == (1, 1, 1, 1) and context.pix_fmt == "yuv420p"
    assert count_pictures(path) == (3, Fraction(30000, 1001))


def test_better_quality_is_nearer_and_larger(tmp_path: Path):
    random = np.random.default_rng(2)
    picture = random.integers(0, 256, (72, 128, 4), np.uint8)
    sizes, errors = [], []
    for quality in QUALITIES:
        path = tmp_path / f"{quality}.mp4"
        encode(path, [picture, picture], quality=quality)
        sizes.append(path.stat().st_size)
        errors.append(np.abs(decoded(path).astype(int) - picture[..., :3]).mean())
    assert sizes == sorted(sizes) and errors == sorted(errors, reverse=True) and sizes[0] < sizes[-1]


# ── interrupted, failed, refused ─────────────────────────────────────────────


def test_an_interrupted_video_is_a_shorter_one(any_engine: Engine, keyed, tmp_path: Path):
    (tmp_path / "film.mp4").write_bytes(b"what was there")
    shown = Counter()

    def done() -> None:
        shown.update(["picture"])
        if shown["picture"] == 3:
            raise KeyboardInterrupt

    film = Series(sketch=keyed, count=8, fps=Fraction(10), size=(64, 36))
    with pytest.raises(Stopped) as caught:
        write_series(any_engine, film, VideoFile(tmp_path / "film.mp4"), done=done)
    path = tmp_path / "film-first-3.mp4"
    assert caught.value.path == path and caught.value.count == 3
    assert decoded(path).shape == (3, 36, 64, 3)
    assert (tmp_path / "film.mp4").read_bytes() == b"what was there"
    assert not list(tmp_path.glob(".*"))


def test_interrupted_video_counts_frame_already_encoded(tmp_path: Path):
    with pytest.raises(Stopped) as caught, Video(tmp_path / "a.mp4", SMALL, Fraction(10), 5) as video:
        for picture in ramps(3):
            video.add(picture)
        video.added -= 1  # Ctrl-C came between the two
        raise KeyboardInterrupt
    assert caught.value.path == tmp_path / "a-first-3.mp4" and caught.value.count == 3
    assert count_pictures(caught.value.path)[0] == 3


def test_nothing_is_left_of_a_video_that_fails(tmp_path: Path):
    assert interrupted(tmp_path / "a.mp4", []) is None
    with pytest.raises(ZeroDivisionError):
        encode(tmp_path / "a.mp4", ramps(1), count=5, error=ZeroDivisionError())
    with pytest.raises(DataError, match="no picture was drawn, of 5"):
        encode(tmp_path / "a.mp4", [], count=5)
    assert not list(tmp_path.iterdir())


def test_a_video_of_too_few_pictures_gets_a_name_that_says_so(tmp_path: Path):
    (tmp_path / "a.mp4").write_bytes(b"what was there")
    with pytest.raises(DataError, match=r"wrote 1 pictures .* kept in a-first-1\.mp4"):
        encode(tmp_path / "a.mp4", ramps(1), count=5)
    assert decoded(tmp_path / "a-first-1.mp4").shape == (1, 36, 64, 3)
    assert (tmp_path / "a.mp4").read_bytes() == b"what was there"
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.parametrize(
    "error", [AttributeError("no such thing"), ReferenceError("closed"), OSError(5, "bad")]
)
def test_a_film_that_cannot_be_read_back_is_not_lost(
    any_engine: Engine, keyed, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: Exception
):
    def fails(path: Path) -> tuple[int, Fraction]:
        raise error

    monkeypatch.setattr(video_module, "count_pictures", fails)
    messages: list[str] = []
    path = tmp_path / "film.mp4"
    film = Series(sketch=keyed, count=3, fps=Fraction(10), size=(64, 36))
    write_series(any_engine, film, VideoFile(path), notice=messages.append)
    assert decoded(path).shape == (3, 36, 64, 3)
    assert len(messages) == 1 and "was written, but could not be checked" in messages[0]
    assert [path.name for path in tmp_path.glob("*film*")] == ["film.mp4"]
    # Interrupted as well: then by the number of pictures that were handed over.
    shorter = interrupted(tmp_path / "b.mp4", ramps(1))
    assert shorter == tmp_path / "b-first-1.mp4" and shorter.is_file()


def test_ctrl_c_while_a_film_is_read_back_does_not_lose_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    def stopped(path: Path) -> tuple[int, Fraction]:
        raise KeyboardInterrupt

    monkeypatch.setattr(video_module, "count_pictures", stopped)
    with pytest.raises(Stopped) as caught:
        encode(tmp_path / "a.mp4", ramps(1))
    assert caught.value.path == tmp_path / "a-first-1.mp4" and caught.value.path.is_file()


@pytest.mark.parametrize(
    ("name", "size", "fps", "quality", "message"),
    [
        ("a.avi", (64, 36), 30, "high", "ending in .mp4 (H.264), .webm (VP9), .gif"),
        ("a.mp4", (65, 36), 30, "high", "both must be even, as 66x36"),
        ("a.mp4", (64, 36), 30, "hihg", "quality 'hihg': expected low, medium, high, best"),
        ("a.gif", (64, 36), 30, "high", "choose one of 1, 2, 4, 5, 10, 20, 25, 50"),
        ("no/a.mp4", (64, 36), 30, "high", "there is no folder"),
        ("a.mp4", (32770, 36), 30, "high", "at most 16384 a side"),
    ],
)
def test_what_cannot_be_written_is_a_sentence(tmp_path: Path, name, size, fps, quality, message):
    with pytest.raises((DataError, ParameterError)) as caught:
        Video(tmp_path / name, size, Fraction(fps), 1, quality=quality)
    assert message in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_without_an_encoder_a_sentence_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "av", None)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ContextError) as caught:
        Video(tmp_path / "a.mp4", (64, 36), Fraction(30), 1)
    assert install_command("video") in str(caught.value) and "ffmpeg on PATH" in str(caught.value)
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(
    not shutil.which("ffmpeg") or not shutil.which("ffprobe"), reason="needs FFmpeg's programs"
)
@pytest.mark.parametrize("count", [1, 6])
@pytest.mark.parametrize(
    ("ending", "fps", "most"),
    [("mp4", Fraction(30000, 1001), 0), ("gif", Fraction(25), 0), ("webm", Fraction(30), 32)],
)
def test_the_program_writes_the_film_that_pyav_writes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, ending: str, fps: Fraction, most: int, count: int
):
    """VP9's decoded pictures may differ between versions of libvpx; H.264 of x264 and a GIF's do not."""
    paths = [tmp_path / f"{name}.{ending}" for name in ("pyav", "program")]
    for path in paths:
        assert not encode(path, ramps(count), fps).warning
        monkeypatch.setitem(sys.modules, "av", None)
    assert count_pictures(paths[0]) == count_pictures(paths[1]) == (count, fps)
    monkeypatch.setitem(sys.modules, "av", av)
    assert count_pictures(paths[0]) == count_pictures(paths[1]) == (count, fps)
    theirs, ours = (decoded(path).astype(int) for path in paths)
    assert np.abs(theirs - ours).max() <= most
    assert {path.name for path in tmp_path.iterdir()} == {path.name for path in paths}


@pytest.mark.skipif(
    not shutil.which("ffmpeg") or not shutil.which("ffprobe"), reason="needs FFmpeg's programs"
)
def test_a_film_of_the_program_that_is_interrupted_is_shorter(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setitem(sys.modules, "av", None)
    assert interrupted(tmp_path / "a.mp4", ramps(3)) == tmp_path / "a-first-3.mp4"
    with pytest.raises(ZeroDivisionError):
        encode(tmp_path / "b.mp4", ramps(1), count=5, error=ZeroDivisionError())
    assert [path.name for path in tmp_path.iterdir()] == ["a-first-3.mp4"]


@pytest.mark.skipif(sys.platform == "win32", reason="a script for sh")
def test_why_the_program_failed_is_in_the_message(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "av", None)
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "ffmpeg").write_text("#!/bin/sh\necho \"Unknown encoder 'libx264'\" >&2\nexit 1\n")
    (tmp_path / "bin" / "ffmpeg").chmod(0o755)
    with pytest.raises(DataError, match=r"a\.mp4.*cannot be written: ffmpeg: Unknown encoder 'libx264'"):
        encode(tmp_path / "a.mp4", ramps(9, (640, 360)), Fraction(30))
    assert [path.name for path in tmp_path.iterdir()] == ["bin"]


def test_render_video_needs_no_engine(clock, tmp_path: Path):
    path = render_video(clock, tmp_path / "a.mp4", seconds=0.1, fps=20, size=(32, 18))
    assert decoded(path).shape == (2, 18, 32, 3)


SENTENCE = "all 3 pictures are the same: nothing in sketch keyed depends on the time, and "


def test_a_still_film_is_warned_of_before_it_is_made(any_engine: Engine, keyed, clock, tmp_path: Path):
    """Films that move: by their text, and by keyframes between the first and the last picture."""
    still = replace(keyed, keyframes=())
    noted: list[str] = []
    film = Series.at_times(still, seconds=0.3, fps=10, size=(32, 18))
    write_series(any_engine, film, VideoFile(tmp_path / "a.mp4"), notice=noted.append)
    pictures = decoded(tmp_path / "a.mp4")
    assert np.ptp(pictures.astype(int), axis=0).max() == 0
    assert noted == [film.still] == [f"{SENTENCE}it has no keyframes"]
    moving = (
        Series.at_times(clock, seconds=0.3, fps=10),
        Series.at_times(keyed, seconds=0.3, fps=10),
        Series.at_times(still, seconds=0.1, fps=10),  # of one picture
    )
    assert [each.still for each in moving] == ["", "", ""]
    later = Series.at_times(keyed, seconds=0.3, fps=10, start=0.5)  # after the last keyframe
    assert later.still == f"{SENTENCE}no keyframe changes anything"
    with pytest.warns(PlaygroundWarning, match="all 2 pictures are the same"):
        render_video(still, tmp_path / "b.mp4", seconds=0.1, fps=20, size=(32, 18), engine=any_engine)


# ── numbered pictures ────────────────────────────────────────────────────────


def test_numbered_pictures(any_engine: Engine, keyed, tmp_path: Path):
    result = render_sequence(
        keyed, tmp_path / "new" / "%03d.png", range(2, 5), fps=10, size=(64, 36), engine=any_engine
    )
    assert [path.name for path in result.drawn] == ["002.png", "003.png", "004.png"] and not result.kept
    for number, path in enumerate(result.drawn, 2):
        alone = any_engine.render(keyed, size=(64, 36), time=number / 10).array
        np.testing.assert_array_equal(read_png(path)[0], alone)
    assert len(list((tmp_path / "new").iterdir())) == 3


def test_good_pictures_stay_and_others_are_drawn_anew(any_engine: Engine, keyed, tmp_path: Path):
    pattern = tmp_path / "%d.png"
    film = Series(sketch=keyed, count=6, fps=Fraction(20), size=(64, 36))
    write_series(any_engine, film, NumberedFiles(pattern))
    truth = [read_png(tmp_path / f"{n}.png")[0] for n in range(6)]
    (tmp_path / "1.png").write_bytes((tmp_path / "1.png").read_bytes()[:-200])  # cut short
    write_png(tmp_path / "2.png", truth[0])  # of something else
    (tmp_path / "3.png").unlink()
    (tmp_path / "4.png").write_bytes(b"")
    before = (tmp_path / "0.png").stat().st_mtime_ns
    sequence = NumberedFiles(pattern, resume=True)
    write_series(any_engine, film, sequence)
    assert [path.name for path in sequence.kept] == ["0.png", "5.png"]
    assert [path.name for path in sequence.drawn] == ["1.png", "2.png", "3.png", "4.png"]
    assert (tmp_path / "0.png").stat().st_mtime_ns == before
    for number in range(6):
        np.testing.assert_array_equal(read_png(tmp_path / f"{number}.png")[0], truth[number])
    # Another sketch or another time: no picture is the one wanted, but where nothing differs.
    other = Series(sketch=keyed.with_values({"light.gain": 1.25}), count=6, fps=Fraction(20), size=(64, 36))
    resumed, again = NumberedFiles(pattern, resume=True), NumberedFiles(pattern)
    write_series(any_engine, other, resumed)
    later = Series(sketch=other.sketch, count=6, fps=Fraction(20), size=(64, 36), start=0.1)
    write_series(any_engine, later, resumed, numbers=[0, 1])
    assert not resumed.kept
    write_series(any_engine, other, again, numbers=[3])
    assert len(again.drawn) == 1


@pytest.mark.parametrize("pattern", ["a.png", "%d", "%d-%d.png", "%s.png", "%5.2f.png", "%d.jpg", "%d%%.png"])
def test_a_name_without_a_number_is_refused(any_engine: Engine, keyed, tmp_path: Path, pattern: str):
    with pytest.raises(DataError, match=r"frames/%05d\.png"):
        film = Series(sketch=keyed, count=1, fps=Fraction(1), size=(8, 8))
        write_series(any_engine, film, NumberedFiles(tmp_path / pattern))


def test_a_fingerprint_identifies_the_picture(any_engine: Engine, keyed):
    def of(sketch=keyed, **more):
        return any_engine.fingerprint(sketch, **{"size": (64, 36), "time": 0.1, **more})

    first = of()
    any_engine.render(keyed, size=(64, 36), time=0.3)
    assert of() == first
    others = [of(time=0.2), of(size=(64, 38)), of(keyed.with_values({"view.haze": 0.5}))]
    others.append(of(keyed.with_values({"height.seed": 99})))
    assert len({first, *others}) == 5
    assert of(time=0.4) == of(time=7.0), "after its last keyframe nothing changes"
