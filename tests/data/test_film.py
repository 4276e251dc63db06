"""A film at any time: the frame that its time stamps say, the same however it is reached."""

from __future__ import annotations

import random
import re
import subprocess
import sys

import numpy as np
import pytest

from playground.data import bounds
from playground.data.media import Film, film_of, open_media
from playground.errors import ContextError, DataError
from playground.extras import install_command
from tests.data.films import colour, own_film, sound, uneven_film

STAMPS = [0, 40, 50, 120, 500, 510, 520, 900, 905, 1400, 1433, 1466, 1500, 1510, 1515, 1700, 1800, 1900, 2000]


def at_corner(pixels: np.ndarray) -> tuple[int, ...]:
    """Return the colour of the lower right corner: row 0 is south."""
    return tuple(int(channel) for channel in pixels[1, -2, :3])


@pytest.mark.parametrize("name", ["a.mp4", "a.webm", "a.gif"])
def test_each_frame_has_its_colour_and_north_is_up(tmp_path, name):
    film = Film(own_film(tmp_path / name))
    assert (film.count, film.size) == (40, (64, 48))
    assert film.duration == pytest.approx(1.6, abs=1e-3)
    for number in range(40):
        seconds = number / 25
        assert film.frame_at(seconds, loop=False) == number, "a time that no float holds exactly"
        assert film.frame_at(seconds + 0.039, loop=False) == number
        pixels = film.pixels(number, film.size)
        assert pixels.shape == (48, 64, 4) and pixels.dtype == np.uint8
        np.testing.assert_allclose(at_corner(pixels), colour(number), atol=4)
        assert pixels[-4, 3, :3].max() < 12, "black is in the north-west"
        assert (pixels[..., 3] == 255).all()


@pytest.mark.parametrize("codec", ["libx264", "ffv1"])
def test_a_film_of_uneven_times_shows_what_a_player_would(tmp_path, codec):
    film = Film(uneven_film(tmp_path / "v.mkv", STAMPS, codec))
    assert film.count == len(STAMPS)
    for milliseconds in range(0, 2100, 7):
        expected = max(i for i, stamp in enumerate(STAMPS) if stamp <= milliseconds)
        number = film.frame_at(milliseconds / 1000, loop=False)
        assert number == expected
        np.testing.assert_allclose(at_corner(film.pixels(number, film.size)), colour(expected), atol=6)


@pytest.mark.parametrize("name", ["a.mp4", "a.webm", "a.gif", "v.mkv", "v.avi", "v.mov"])
def test_a_frame_is_the_same_however_it_is_reached(tmp_path, name):
    if name.startswith("a"):
        path = own_film(tmp_path / name)
    else:
        stamps = STAMPS if name != "v.avi" else range(0, 19)
        path = uneven_film(tmp_path / name, stamps, "libx264" if name != "v.avi" else "mpeg4")
    film = Film(path)
    played = [film.pixels(number, film.size).copy() for number in range(film.count)]
    order = list(range(film.count)) * 2
    random.Random(4).shuffle(order)
    jumping = Film(path)
    for number in order:
        np.testing.assert_array_equal(jumping.pixels(number, film.size), played[number])
    for number in (film.count - 1, film.count // 2):
        np.testing.assert_array_equal(Film(path).pixels(number, film.size), played[number])
    backwards = Film(path)
    for number in reversed(range(film.count)):
        np.testing.assert_array_equal(backwards.pixels(number, film.size), played[number])


AS_IT_WAS = """
import sys, av
from fractions import Fraction
from pathlib import Path
import numpy as np
from playground.publish.video import Video
from playground.data.media import Film
path = Path(sys.argv[1])
with Video(path, (64, 48), Fraction(25), 9) as video:
    for number in range(9):
        video.add(np.full((48, 64, 4), 20 * number, np.uint8))
film = Film(path)
film.pixels(3, film.size)
film.pixels(0, film.size)
print(av.logging.get_level())
"""


def test_decoders_log_nothing_by_way_of_python(tmp_path):
    """Where a level is set, any, their threads wait for Python's lock to log.

    Whoever closes a film holds that lock and waits for them: with films of noise it stood still after some
    hundred of them.
    """
    command = [sys.executable, "-c", AS_IT_WAS, str(tmp_path / "a.mp4")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stdout, done.stderr) == (0, "None\n", "")


def test_playing_on_decodes_each_frame_once(tmp_path, monkeypatch):
    film, decoded = Film(own_film(tmp_path / "a.mp4")), []
    real = Film._numbered

    def counted(self, container, key):
        for number, frame in real(self, container, key):
            decoded.append(number)
            yield number, frame

    monkeypatch.setattr(Film, "_numbered", counted)
    for number in range(40):
        film.pixels(number, film.size)
    assert decoded == list(range(40))


def test_few_frames_are_held_however_long_the_film(tmp_path, monkeypatch):
    monkeypatch.setattr("playground.data.media._HELD_BYTES", 5 * 64 * 48 * 4)
    film = Film(own_film(tmp_path / "a.mp4"))
    for number in (39, 2, 38, 0, 20):
        np.testing.assert_allclose(at_corner(film.pixels(number, film.size)), colour(number), atol=4)
        assert len(film._held) <= 5


def test_a_film_loops_or_stays(tmp_path):
    film = Film(own_film(tmp_path / "a.mp4"))
    assert [film.frame_at(t, loop=False) for t in (-3.0, -0.01, 1.59, 1.6, 99.0)] == [0, 0, 39, 39, 39]
    assert [film.frame_at(t, loop=True) for t in (1.6, 1.64, 3.2, 16.0, -0.04, -1.6)] == [0, 1, 0, 0, 39, 0]


def test_another_size_is_averaged_or_interpolated(tmp_path, monkeypatch):
    film = Film(own_film(tmp_path / "a.mp4"))
    for size in ((16, 12), (130, 100)):
        pixels = film.pixels(7, size)
        assert pixels.shape == (size[1], size[0], 4)
        np.testing.assert_allclose(at_corner(pixels), colour(7), atol=4)
        assert pixels[-2, 1, :3].max() < 12, "the black quarter"
    lines = np.zeros((48, 64, 4), np.uint8)
    lines[:, ::2] = 255
    monkeypatch.setattr("tests.data.films.frame", lambda number, size: lines)
    film = Film(uneven_film(tmp_path / "lines.mkv", [0, 40], "ffv1"))
    np.testing.assert_allclose(film.pixels(1, (16, 12))[..., :3], 127.5, atol=2)
    between = film.pixels(1, (128, 48))[20, 40:80, 0].astype(int)
    assert {*between.tolist()} - {0, 255}, "interpolated"


def test_a_file_that_changes_is_read_anew(tmp_path):
    path = own_film(tmp_path / "a.mp4")
    first = film_of(path)
    assert film_of(path) is first
    own_film(path, count=3)
    assert film_of(path).count == 3


def test_what_cannot_be_shown_is_a_sentence(tmp_path, monkeypatch):
    (tmp_path / "empty.mp4").write_bytes(b"")
    (tmp_path / "text.mp4").write_text("no film at all\n" * 99)
    whole = own_film(tmp_path / "a.mp4").read_bytes()
    (tmp_path / "cut.mp4").write_bytes(whole[: len(whole) // 3])
    tone = np.sin(np.arange(4410) * 0.1)[None]
    sound(tmp_path / "tone.m4a", tone)
    for name, message in {
        "none.mp4": "there is no such file; did you mean",
        "empty.mp4": "the file is empty",
        "text.mp4": r"not a video file that can be read .*; expected mp4, mov, webm, mkv, gif, avi",
        "cut.mp4": "its first frame cannot be decoded: invalid data found",
        "tone.m4a": "it has sound and no picture; foreign/sound reads sound",
    }.items():
        with pytest.raises(DataError, match=message):
            Film(tmp_path / name)
    monkeypatch.setattr(bounds, "MAX_TEXELS", 64 * 48 - 1)
    with pytest.raises(DataError, match="64 x 48 pixels are too many"):
        Film(tmp_path / "a.mp4")


@pytest.mark.parametrize(
    ("name", "existing", "message"),
    [
        ("a.mp4", b"avc1", "its picture is in a codec that this FFmpeg cannot decode"),
        ("a.webm", b"V_VP9", "it has no picture"),  # FFmpeg leaves the stream out
    ],
)
def test_a_film_of_an_unknown_codec_is_a_sentence(tmp_path, name, existing, message):
    path = own_film(tmp_path / name, count=2)
    data = path.read_bytes()
    assert existing in data
    path.write_bytes(data.replace(existing, b"zzzzz"[: len(existing)]))
    with pytest.raises(DataError, match=message):
        Film(path)


def test_a_film_that_would_become_monstrous_is_refused(tmp_path, monkeypatch):
    path = own_film(tmp_path / "a.mp4", count=2)
    monkeypatch.setattr(bounds, "ALWAYS_FINE", 1000)
    monkeypatch.setattr(bounds, "MAX_RATIO", 1)
    with pytest.raises(DataError, match="would become"):
        Film(path)


def test_a_damaged_film_is_a_sentence_where_it_is_damaged(tmp_path):
    path = uneven_film(tmp_path / "v.mkv", range(0, 1600, 40), "ffv1")
    data = bytearray(path.read_bytes())
    middle = len(data) // 2
    data[middle : middle + len(data) // 4] = b"\xff" * (len(data) // 4)
    path.write_bytes(data)
    try:
        film = Film(path)
        for number in range(film.count):
            film.pixels(number, film.size)
    except DataError as error:
        assert "\n" not in str(error)


@pytest.mark.parametrize(
    "text", ["#EXTM3U\n#EXTINF:1,\n{}\n#EXT-X-ENDLIST\n", "ffconcat version 1.0\nfile {}\n"]
)
def test_a_playlist_leads_nowhere(tmp_path, text):
    own_film(tmp_path / "secret.mp4")
    (tmp_path / "list.mp4").write_text(text.format(tmp_path / "secret.mp4"))
    with pytest.raises(DataError, match="not a video file that can be read"):
        Film(tmp_path / "list.mp4")


def test_without_pyav_the_extra_is_named(tmp_path, monkeypatch):
    path = own_film(tmp_path / "a.mp4", count=2)
    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(ContextError, match="a video file needs PyAV: " + re.escape(install_command("video"))):
        open_media(path, "a video file", (".mp4",))
