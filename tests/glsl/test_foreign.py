"""What replaces the channels of other tools' shaders, and an image encoded as its file."""

from __future__ import annotations

import numpy as np
import pytest

from playground.data.image_files import write_png
from tests.cube_maps import directions

from ..loading import load

SKETCH = """format = 1
size = 8
[[pass]]
name = "a"
use = "foreign/{}"
size = [{}, {}]
set = {{ {} }}
"""


@pytest.fixture
def texels(any_engine, tmp_path):
    def read(
        kernel: str, size: tuple[int, int] = (64, 64), setting: str = "", time: float = 0.0
    ) -> np.ndarray:
        path = tmp_path / "s.toml"
        path.write_text(SKETCH.format(kernel, *size, setting))
        return any_engine.read(load(path), "a", time=time).astype(float)

    return read


def test_noise_is_even_and_its_numbers_are_independent(texels):
    zero, item = texels("noise"), texels("noise", setting="number = 1")
    assert zero.shape == (64, 64, 4)
    channels = np.concatenate([zero.reshape(-1, 4), item.reshape(-1, 4)], axis=1)
    np.testing.assert_allclose(channels.mean(0), 0.5, atol=4 / np.sqrt(12 * 4096))
    np.testing.assert_allclose(channels.var(0), 1 / 12, rtol=0.06)
    others = np.corrcoef(channels.T) - np.eye(8)
    assert np.abs(others).max() < 4 / np.sqrt(4096)


def test_pictures_differ_and_show_which_way_is_up(texels):
    made = [texels("picture", setting=f"number = {n}") for n in range(10)]
    assert all(np.abs(a - b).mean() > 0.02 for i, a in enumerate(made) for b in made[:i])
    for item in made:
        assert (item[:, -8:, 0].mean() - item[:, :8, 0].mean()) > 0.3  # red in the east
        assert (item[-8:, :, 1].mean() - item[:8, :, 1].mean()) > 0.3  # green in the north


def test_black_is_black_and_opaque(texels):
    assert (texels("black", (3, 2)) == [0.0, 0.0, 0.0, 1.0]).all()


def test_an_image_has_the_bytes_of_its_file(texels, tmp_path):
    pixels = np.random.default_rng(3).integers(0, 256, (6, 8, 4), dtype=np.uint8)
    write_png(tmp_path / "x.png", pixels)
    result = texels("image", (8, 6), 'image = "x.png"')
    np.testing.assert_allclose(result[::-1] * 255, pixels, atol=1)


def test_sky_cube_map_places_horizon_sun_and_ground(texels):
    side = 32
    ways = directions(side)
    ways /= np.linalg.norm(ways, axis=2, keepdims=True)
    ground, suns = ways[..., 1] < 0, []
    for number in range(6):
        sky = texels("sky_box", (side, 6 * side), f"number = {number}")
        np.testing.assert_array_less(sky[ground][:, 2], 0.4)
        np.testing.assert_array_less(0.4, sky[~ground][:, 2])
        assert np.corrcoef(sky[ground][:, 0], ways[ground][:, 0])[0, 1] > 0.99
        assert np.corrcoef(sky[ground][:, 1], ways[ground][:, 2])[0, 1] > 0.99
        bright = (sky[..., :3] > 0.995).all(2)
        sun = ways[bright].mean(0)
        sun /= np.linalg.norm(sun)
        assert (ways[bright] @ sun > 0.97).all() and abs(sun[1] - 0.6) < 0.05
        suns.append(sun)
    assert max(a @ b for i, a in enumerate(suns) for b in suns[:i]) < 0.95


def music(
    texels, time: float, size: tuple[int, int] = (512, 2), number: int = 0, content: str = ""
) -> np.ndarray:
    """Return rows 0..1 of the stand-in of a sound at a time."""
    return texels("spectrum", size, f"number = {number}{content}", time=time)[..., 0]


@pytest.mark.slow
def test_a_made_up_sound_has_tones_a_beat_and_a_wave(texels):
    times = np.arange(0.0, 6.0, 0.05)
    result = np.stack([music(texels, time) for time in times])
    spectra, waves = result[:, 0], result[:, 1]
    drum = spectra[:, :4].mean(1)  # up to 86 Hz
    struck = np.flatnonzero(np.diff(drum) > 0.25)
    assert 8 <= len(struck) <= 15, "1.6 to 2.4 beats a second for six seconds"
    assert np.ptp(np.diff(times[struck])) < 0.11, "evenly, as far as a twentieth of a second shows"
    assert spectra[:, 10:].max(1).min() > 0.3 and spectra[:, -10:].max() < 0.3, "tones, few of them high"
    np.testing.assert_allclose(waves.mean(), 0.5, atol=0.02)
    assert waves.std(1).min() > 0.02 and 0.0 < waves.min() and waves.max() < 1.0


def test_a_made_up_wave_has_the_tones_of_its_spectrum(texels):
    """The strongest tone of a transform of the wave stands in the spectrum, too."""
    time = 10.3
    wave = music(texels, time)[1] - 0.5
    strengths = np.abs(np.fft.rfft(wave * np.hanning(512), 4096))
    hertz = np.argmax(strengths) * 44100 / 4096
    row = music(texels, time)[0]
    near = row[max(int(hertz / 11025 * 512) - 4, 0) :][:9]
    assert near.max() > 0.4


def test_made_up_sounds_differ_by_number_and_go_by_time_alone(texels):
    made = [music(texels, 2.0, number=number) for number in range(4)]
    assert min(np.abs(a - b).max() for i, a in enumerate(made) for b in made[:i]) > 0.2
    np.testing.assert_array_equal(music(texels, 2.0), made[0])
    whole = music(texels, 2.0, (512, 4))
    alone = {c: music(texels, 2.0, content=f', content = "{c}"') for c in ("spectrum", "waves")}
    np.testing.assert_array_equal(whole, [*alone["spectrum"], *alone["waves"]])
