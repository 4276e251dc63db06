"""Films and sounds at any time: what their time stamps say, the same however it is reached."""

from __future__ import annotations

import random
import re
import subprocess
import sys

import numpy as np
import pytest

from playground.data import bounds, media
from playground.data.media import BINS, RATE, SHOWN, SPAN, WINDOW, Film, Sound, film_of, open_media, sound_of
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
    real = Film.numbered_frames

    def counted(self, container, key):
        for number, frame in real(self, container, key):
            decoded.append(number)
            yield number, frame

    monkeypatch.setattr(Film, "numbered_frames", counted)
    for number in range(40):
        film.pixels(number, film.size)
    assert decoded == list(range(40))


def test_few_frames_are_held_however_long_the_film(tmp_path, monkeypatch):
    monkeypatch.setattr("playground.data.media.HELD_BYTES", 5 * 64 * 48 * 4)
    film = Film(own_film(tmp_path / "a.mp4"))
    for number in (39, 2, 38, 0, 20):
        np.testing.assert_allclose(at_corner(film.pixels(number, film.size)), colour(number), atol=4)
        assert len(film.held) <= 5


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


# ── A sound at any time: its samples, and the spectrum and wave that browsers would show of them


SECOND = np.arange(RATE)


def tone(bin_: float, strength: float = 0.02, count: int = RATE) -> np.ndarray:
    return strength * np.sin(2 * np.pi * bin_ / WINDOW * np.arange(count))


def browsers(samples: np.ndarray) -> np.ndarray:
    """Return what AnalyserNode gives after it was asked sixty times a second, frame by frame."""
    n = np.arange(WINDOW)
    a = 0.16
    window = (1 - a) / 2 - 0.5 * np.cos(2 * np.pi * n / WINDOW) + a / 2 * np.cos(4 * np.pi * n / WINDOW)
    # A transform by its definition, of the bins that are looked at.
    smooth = np.zeros(BINS)
    padded = np.concatenate([np.zeros(WINDOW), samples])
    for frame in range(len(samples) // 735 + 1):
        end = len(samples) % 735 + frame * 735 + WINDOW
        smooth = 0.8 * smooth + 0.2 * np.abs(np.fft.fft(padded[end - WINDOW : end] * window)[:BINS]) / WINDOW
    with np.errstate(divide="ignore"):
        decibels = 20 * np.log10(smooth)
    return np.floor(np.clip(255 / 70 * (decibels + 100), 0, 255))


@pytest.mark.parametrize("ending", [".wav", ".flac"])
def test_samples_are_those_of_the_file(tmp_path, ending):
    noise = np.random.default_rng(1).uniform(-0.9, 0.9, (2, 10_000))
    file = Sound(sound(tmp_path / f"a{ending}", noise))
    assert file.channels == 2
    heard = file.heard(9_000, 500, loop=False)
    np.testing.assert_allclose(heard, noise[:, 8_500:9_000], atol=2**-14)


@pytest.mark.parametrize("ending", [".mp3", ".ogg", ".m4a", ".wav"])
def test_every_format_is_heard_at_its_time(tmp_path, ending):
    silence = np.zeros(RATE // 2)
    samples = np.concatenate([silence, tone(100, 0.5), silence])[None]
    file = Sound(sound(tmp_path / f"a{ending}", samples))
    strength = [
        float(np.abs(file.heard(int(at * RATE), 2000, loop=False)).max()) for at in (0.4, 0.8, 1.2, 1.8)
    ]
    assert strength[0] < 0.02 and strength[3] < 0.02
    np.testing.assert_allclose(strength[1:3], 0.5, atol=0.05)


def test_silence_is_before_the_first_sample_and_after_the_last(tmp_path):
    samples = np.full((1, 3000), 0.5)
    file = Sound(sound(tmp_path / "a.wav", samples))
    assert file.length(2999) is None and file.length(5000) == 3000
    assert (file.heard(0, 100, loop=False) == 0).all()
    before = file.heard(50, 100, loop=True)[0]
    assert (before[:50] == 0).all() and np.allclose(before[50:], 0.5, atol=1e-4), "nothing wraps to before 0"
    after = file.heard(3050, 100, loop=False)[0]
    assert np.allclose(after[:50], 0.5, atol=1e-4) and (after[50:] == 0).all()
    assert (file.heard(9000, 100, loop=False) == 0).all()


def test_a_loop_goes_on_at_the_first_sample(tmp_path):
    ramp = np.linspace(-0.9, 0.9, 3000)[None]
    file = Sound(sound(tmp_path / "a.wav", ramp))
    heard = file.heard(3000 * 4 + 30, 60, loop=True)[0]
    np.testing.assert_allclose(heard, np.concatenate([ramp[0, -30:], ramp[0, :30]]), atol=1e-4)


def test_a_moment_is_heard_the_same_however_it_is_reached(tmp_path):
    path = sound(tmp_path / "a.mp3", np.random.default_rng(2).uniform(-0.5, 0.5, (2, RATE)))
    played = Sound(path)
    pieces = [played.heard(end, 1000, loop=False).copy() for end in range(1000, RATE, 1000)]
    jumped = Sound(path)
    for number in (40, 3, 20):
        np.testing.assert_array_equal(jumped.heard((number + 1) * 1000, 1000, loop=False), pieces[number])


def test_another_rate_is_brought_to_one(tmp_path):
    rate = 8000
    samples = 0.02 * np.sin(2 * np.pi * 1000 * np.arange(rate) / rate)[None]
    file = Sound(sound(tmp_path / "a.wav", samples, rate))
    spectrum = media.channel(file.heard(30_000, SPAN, loop=False))[0]
    assert abs(int(spectrum.argmax()) * RATE / WINDOW - 1000) < RATE / WINDOW
    assert abs((file.length(10**6) or 0) - RATE) < 64


@pytest.mark.parametrize("bin_", [3, 50, 200, 511])
def test_a_tone_stands_at_its_bin(bin_):
    row = media.channel(tone(bin_)[None, :SPAN].astype(np.float32))[0].astype(int)
    assert row.argmax() == bin_
    # Blackman's main lobe ends three bins away, and its side lobes lie 58 dB below: under -100 here.
    far = np.abs(np.arange(SHOWN) - bin_) > 3
    assert row[far].max() == 0
    # Half the amplitude of a sine, times the window's mean, 0.42.
    assert abs(row[bin_] - 255 / 70 * (20 * np.log10(0.02 / 2 * 0.42) + 100)) < 1.5


def test_a_faint_tone_has_its_decibels():
    for decibels in (-90, -60, -45):
        strength = 10 ** (decibels / 20) * 2 / 0.42
        row = media.channel(tone(80, strength)[None, :SPAN].astype(np.float32))[0]
        assert abs(int(row[80]) - 255 / 70 * (decibels + 100)) < 1.5


def test_the_spectrum_is_what_a_browser_gives_after_playing():
    rng = np.random.default_rng(5)
    played = rng.normal(0, 0.1, RATE) * np.linspace(0, 1, RATE) ** 3
    np.testing.assert_allclose(media.spectrum(played.astype(np.float32)), browsers(played), atol=1)


def test_silence_has_no_spectrum_and_a_flat_wave():
    spectrum, wave = media.channel(np.zeros((2, SPAN), np.float32))
    assert (spectrum == 0).all() and (wave == 128).all()


def test_the_wave_is_the_window_s_first_samples_one_a_texel():
    ramp = np.linspace(-1, 1, SPAN, dtype=np.float32)[None]
    wave = media.channel(ramp)[1]
    expected = np.floor(128 * (1 + ramp[0, -WINDOW:][:SHOWN].astype(float)))
    np.testing.assert_array_equal(wave, expected)
    assert media.wave(np.array([-2.0, -1.0, 1.0, 2.0], np.float32)).tolist() == [0, 0, 255, 255]


def test_channels_are_rows_or_mixed():
    both = np.stack([tone(100)[:SPAN], tone(300)[:SPAN]]).astype(np.float32)
    rows = media.spectra(both, (BINS, 2))
    assert rows.shape == (2, BINS) and rows.argmax(1).tolist() == [100, 300]
    mixed = media.spectra(both, (BINS, 1))[0]
    assert mixed[100] > 150 and mixed[300] > 150
    assert media.spectra(both, (BINS, 3)).argmax(1).tolist() == [100, 300, 300]
    np.testing.assert_array_equal(media.waves(both, (400, 2)), media.wave(both[:, -400:]))
    np.testing.assert_array_equal(media.waves(both, (64, 1))[0], media.wave(both[:, -64:].mean(0)))


@pytest.mark.parametrize("width", [16, 100, 1000, 3000])
def test_a_tone_shows_at_any_width(width):
    row = media.spectra(tone(333)[None, :SPAN].astype(np.float32), (width, 1))[0]
    assert row.shape == (width,) and abs(int(row.argmax()) / width - 333 / BINS) <= 1 / min(width, BINS)


def test_what_cannot_be_heard_is_a_sentence(tmp_path, monkeypatch):
    (tmp_path / "text.wav").write_text("no sound\n" * 99)
    with pytest.raises(DataError, match=r"not a sound file that can be read .*; expected wav, mp3"):
        Sound(tmp_path / "text.wav")
    with pytest.raises(DataError, match="it has no sound"):
        Sound(own_film(tmp_path / "a.mp4", count=2))
    path = sound(tmp_path / "a.wav", tone(10)[None])
    monkeypatch.setattr(media, "MAX_BYTES", 1000)
    with pytest.raises(DataError, match="minutes of sound are too many; the limit is"):
        Sound(path)


def test_a_sound_of_an_unknown_codec_is_a_sentence(tmp_path):
    path = sound(tmp_path / "a.wav", tone(10)[None])
    data = path.read_bytes()
    assert b"fmt \x10\0\0\0\x01\0" in data
    path.write_bytes(data.replace(b"fmt \x10\0\0\0\x01\0", b"fmt \x10\0\0\0\x77\x77"))
    with pytest.raises(DataError, match="its sound is in a codec that this FFmpeg cannot decode"):
        Sound(path)


def test_a_title_in_another_encoding_does_not_matter(tmp_path):
    path = sound(tmp_path / "a.wav", tone(10)[None])
    heard = Sound(path).heard(100, 100, loop=False)
    title = b"Mont\xe9e "  # Latin-1
    info = b"INFOINAM" + len(title).to_bytes(4, "little") + title
    data = bytearray(path.read_bytes() + b"LIST" + len(info).to_bytes(4, "little") + info)
    data[4:8] = (len(data) - 8).to_bytes(4, "little")
    path.write_bytes(data)
    np.testing.assert_array_equal(Sound(path).heard(100, 100, loop=False), heard)


def test_a_file_that_changes_is_heard_anew(tmp_path):
    path = sound(tmp_path / "a.wav", tone(10)[None])
    first = sound_of(path)
    assert sound_of(path) is first
    sound(path, tone(10, count=99)[None])
    assert sound_of(path).length(10**6) == 99
