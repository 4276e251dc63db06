"""A sound at any time: its samples, and the spectrum and wave that browsers would show of them."""

from __future__ import annotations

import numpy as np
import pytest

from playground.data import media
from playground.data.media import BINS, RATE, SHOWN, SPAN, WINDOW, Sound, sound_of
from playground.errors import DataError
from tests.data.films import own_film
from tests.data.films import sound as write

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
    file = Sound(write(tmp_path / f"a{ending}", noise))
    assert file.channels == 2
    heard = file.heard(9_000, 500, loop=False)
    np.testing.assert_allclose(heard, noise[:, 8_500:9_000], atol=2**-14)


@pytest.mark.parametrize("ending", [".mp3", ".ogg", ".m4a", ".wav"])
def test_every_format_is_heard_at_its_time(tmp_path, ending):
    silence = np.zeros(RATE // 2)
    samples = np.concatenate([silence, tone(100, 0.5), silence])[None]
    file = Sound(write(tmp_path / f"a{ending}", samples))
    strength = [
        float(np.abs(file.heard(int(at * RATE), 2000, loop=False)).max()) for at in (0.4, 0.8, 1.2, 1.8)
    ]
    assert strength[0] < 0.02 and strength[3] < 0.02
    np.testing.assert_allclose(strength[1:3], 0.5, atol=0.05)


def test_silence_is_before_the_first_sample_and_after_the_last(tmp_path):
    samples = np.full((1, 3000), 0.5)
    file = Sound(write(tmp_path / "a.wav", samples))
    assert file.length(2999) is None and file.length(5000) == 3000
    assert (file.heard(0, 100, loop=False) == 0).all()
    before = file.heard(50, 100, loop=True)[0]
    assert (before[:50] == 0).all() and np.allclose(before[50:], 0.5, atol=1e-4), "nothing wraps to before 0"
    after = file.heard(3050, 100, loop=False)[0]
    assert np.allclose(after[:50], 0.5, atol=1e-4) and (after[50:] == 0).all()
    assert (file.heard(9000, 100, loop=False) == 0).all()


def test_a_loop_goes_on_at_the_first_sample(tmp_path):
    ramp = np.linspace(-0.9, 0.9, 3000)[None]
    file = Sound(write(tmp_path / "a.wav", ramp))
    heard = file.heard(3000 * 4 + 30, 60, loop=True)[0]
    np.testing.assert_allclose(heard, np.concatenate([ramp[0, -30:], ramp[0, :30]]), atol=1e-4)


def test_a_moment_is_heard_the_same_however_it_is_reached(tmp_path):
    path = write(tmp_path / "a.mp3", np.random.default_rng(2).uniform(-0.5, 0.5, (2, RATE)))
    played = Sound(path)
    pieces = [played.heard(end, 1000, loop=False).copy() for end in range(1000, RATE, 1000)]
    jumped = Sound(path)
    for number in (40, 3, 20):
        np.testing.assert_array_equal(jumped.heard((number + 1) * 1000, 1000, loop=False), pieces[number])


def test_another_rate_is_brought_to_one(tmp_path):
    rate = 8000
    samples = 0.02 * np.sin(2 * np.pi * 1000 * np.arange(rate) / rate)[None]
    file = Sound(write(tmp_path / "a.wav", samples, rate))
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
    path = write(tmp_path / "a.wav", tone(10)[None])
    monkeypatch.setattr(media, "_MAX_BYTES", 1000)
    with pytest.raises(DataError, match="minutes of sound are too many; the limit is"):
        Sound(path)


def test_a_sound_of_an_unknown_codec_is_a_sentence(tmp_path):
    path = write(tmp_path / "a.wav", tone(10)[None])
    data = path.read_bytes()
    assert b"fmt \x10\0\0\0\x01\0" in data
    path.write_bytes(data.replace(b"fmt \x10\0\0\0\x01\0", b"fmt \x10\0\0\0\x77\x77"))
    with pytest.raises(DataError, match="its sound is in a codec that this FFmpeg cannot decode"):
        Sound(path)


def test_a_title_in_another_encoding_does_not_matter(tmp_path):
    path = write(tmp_path / "a.wav", tone(10)[None])
    heard = Sound(path).heard(100, 100, loop=False)
    title = b"Mont\xe9e "  # Latin-1
    info = b"INFOINAM" + len(title).to_bytes(4, "little") + title
    data = bytearray(path.read_bytes() + b"LIST" + len(info).to_bytes(4, "little") + info)
    data[4:8] = (len(data) - 8).to_bytes(4, "little")
    path.write_bytes(data)
    np.testing.assert_array_equal(Sound(path).heard(100, 100, loop=False), heard)


def test_a_file_that_changes_is_heard_anew(tmp_path):
    path = write(tmp_path / "a.wav", tone(10)[None])
    first = sound_of(path)
    assert sound_of(path) is first
    write(path, tone(10, count=99)[None])
    assert sound_of(path).length(10**6) == 99
