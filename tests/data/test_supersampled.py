"""Pictures that are drawn larger and reduced: the mean is that of light."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine.frame import reduced
from playground.errors import ParameterError, SketchError
from playground.publish.large import strips
from playground.sketch.load import load

NOISE = """#pragma kernel(output = "frame:rgba8")
vec4 kernel(ivec2 texel) {
    uint bits = uint(texel.x * 7919 + texel.y * 104729) * 2654435769u; bits ^= bits >> 13;
    return vec4(float(bits & 255u), float(bits >> 8 & 255u), float(bits >> 16 & 255u), 255.0) / 255.0;
}
"""


def byte_of_mean(bytes_, weights=None):
    """Return the byte of the mean light of some bytes, in plain float64."""
    share = [b / 255 for b in bytes_]
    light = [s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4 for s in share]
    weights = weights or [1.0] * len(light)
    mean = sum(v * w for v, w in zip(light, weights, strict=True)) / max(sum(weights), 1e-300)
    encoded = 12.92 * mean if mean <= 0.0031308 else 1.055 * mean ** (1 / 2.4) - 0.055
    return round(255 * encoded)


@pytest.mark.parametrize("times", [1, 2, 3, 8])
@pytest.mark.parametrize("opaque", [True, False])
def test_a_pixel_is_the_mean_light_of_its_square(times, opaque):
    random = np.random.default_rng(times)
    large = random.integers(0, 256, (5 * times, 7 * times, 4), dtype=np.uint8)
    if opaque:
        large[..., 3] = 255
    array = reduced(large, times)
    assert array.shape == (5, 7, 4)
    if times == 1:
        np.testing.assert_array_equal(array, large)
        return
    for row, column in ((0, 0), (4, 6), (2, 3)):
        square = large[times * row : times * (row + 1), times * column : times * (column + 1)].reshape(-1, 4)
        weights = None if opaque else [float(a) for a in square[:, 3]]
        expected = [byte_of_mean(square[:, c].tolist(), weights) for c in range(3)]
        np.testing.assert_array_equal(array[row, column, :3], expected)
        assert array[row, column, 3] == round(square[:, 3].mean())


def test_half_white_is_not_half_of_255():
    large = np.full((2, 2, 4), 255, np.uint8)
    large[0, :, :3] = 0
    assert reduced(large, 2)[0, 0].tolist() == [188, 188, 188, 255]


@pytest.fixture
def noise(tmp_path):
    """Give a function that loads a sketch of one noisy picture, with lines of its view and of a shot."""
    (tmp_path / "noise.glsl").write_text(NOISE)

    def make(view="", shot=""):
        file = tmp_path / "sketch.toml"
        shots = f'[[shot]]\nname = "a"\nsize = [31, 20]\n{shot}\n'
        file.write_text(f'format = 1\nsize = 33\n[view]\nuse = "./noise"\n{view}\n{shots}')
        return load(file)

    return make


def test_a_picture_is_reduced_from_one_that_is_drawn_larger(any_engine, noise):
    plain = noise()
    expected = reduced(any_engine.render(plain, size=(93, 60)).array, 3)
    thrice = noise("supersample = 3")
    np.testing.assert_array_equal(any_engine.render(thrice, size=(31, 20)).array, expected)
    shot = noise(shot="supersample = 3")
    assert (shot.picture.supersample, shot.for_shot(shot.shots[0]).picture.supersample) == (1, 3)
    assert noise("supersample = 3", "supersample = 1").for_shot(thrice.shots[0]).picture.supersample == 3
    parts = [*strips(any_engine, thrice, (31, 20), tile=(40, 26))]
    np.testing.assert_array_equal(np.concatenate(parts), expected)


def test_how_often_a_picture_is_drawn_is_in_its_fingerprint(any_engine, noise):
    sketch = noise()
    prints = {
        any_engine.fingerprint(sketch.with_picture(supersample=n), size=(60 // n, 60 // n)) for n in (1, 2, 3)
    }
    assert len(prints) == 3


def test_a_number_that_is_wrong_has_a_sentence(any_engine, noise):
    for text in ("0", "9"):
        with pytest.raises(SketchError, match=f"supersample = {text}: expected a whole number, 1 to 8"):
            noise(f"supersample = {text}")
    with pytest.raises(ParameterError, match="1 to 2048 a side"):
        any_engine.render(noise("supersample = 8"), size=(3000, 20))
