"""Comparing pictures, against a slow comparison in Python's own integers, and what must not pass."""

from __future__ import annotations

import numpy as np
import pytest

from playground.verify.shots.compare import Comparison, compare, difference_picture

from ...cases import each

RNG = np.random.default_rng(11)


def picture(width: int = 7, height: int = 5, low: int = 0, high: int = 256) -> np.ndarray:
    return RNG.integers(low, high, (height, width, 4), dtype=np.uint8)


def slow(actual: np.ndarray, expected: np.ndarray, tolerance: int) -> tuple[list[int], int, tuple[int, int]]:
    """Return (most by channel, pixels over, first worst place), one pixel after the other."""
    channels, over, worst, position = [0] * 4, 0, -1, (0, 0)
    for y in range(actual.shape[0]):
        for x in range(actual.shape[1]):
            result = [abs(a - b) for a, b in zip(actual[y, x].tolist(), expected[y, x].tolist(), strict=True)]
            channels = [max(pair) for pair in zip(channels, result, strict=True)]
            over += max(result) > tolerance
            if max(result) > worst:
                worst, position = max(result), (x, y)
    return channels, over, position


def changed(base: np.ndarray, x: int, y: int, channel: int, by: int) -> np.ndarray:
    other = base.copy()
    other[y, x, channel] = int(other[y, x, channel]) + by
    return other


def assert_as_slow(actual: np.ndarray, expected: np.ndarray, tolerance: int) -> Comparison:
    channels, over, (x, y) = slow(actual, expected, tolerance)
    result = compare(actual, expected, tolerance)
    assert (list(result.channels), result.most, result.over) == (channels, max(channels), over)
    assert (result.verdict, result.ok) == (("differs", False) if over else ("same", True))
    assert result.position == ((x, y) if max(channels) else None)
    if max(channels):
        assert (result.actual, result.expected) == (tuple(actual[y, x]), tuple(expected[y, x]))
        assert f"max difference {max(channels)} of 255, at x = {x}, y = {y}" in str(result)
    return result


@each("spread", [0, 1, 3, 40, 255])
@each("tolerance", [0, 1, 3, 254, 255])
@each("size", [(1, 2), (7, 5), (64, 3), (31, 33)])
def test_agrees_with_the_slow_comparison(spread: int, tolerance: int, size: tuple[int, int]) -> None:
    expected = picture(*size)
    noise = RNG.integers(-spread, spread + 1, expected.shape)
    assert_as_slow(np.clip(expected.astype(int) + noise, 0, 255).astype(np.uint8), expected, tolerance)


@each("pair", [(0, 255), (255, 0), (0, 128), (128, 0), (1, 254), (100, 98), (98, 100), (7, 8), (9, 9)])
@each("channel", range(4))
@each(("x", "y"), [(0, 0), (6, 0), (0, 4), (6, 4), (4, 1)])
def test_one_byte_counts_in_every_channel_and_never_wraps(
    x: int, y: int, channel: int, pair: tuple[int, int]
) -> None:
    """Alpha too, and colours under full transparency."""
    for alpha in (0, 255):
        first = picture()
        first[..., 3] = alpha
        other = first.copy()
        first[y, x, channel], other[y, x, channel] = pair
        assert assert_as_slow(first, other, 1).over == (abs(pair[0] - pair[1]) > 1)


@pytest.mark.parametrize(("by", "word"), [(-2, "differs"), (-1, "same"), (1, "same"), (2, "differs")])
def test_one_level_passes_everywhere_and_two_fail(by: int, word: str) -> None:
    expected = picture(low=2, high=254)
    result = assert_as_slow((expected.astype(int) + by).astype(np.uint8), expected, 1)
    assert (result.verdict, result.most, result.over) == (word, abs(by), 35 * (word == "differs"))


def test_a_small_hole_in_a_large_picture_fails() -> None:
    expected = picture(1280, 720, high=200)
    assert compare(changed(expected, 1279, 719, 2, 2), expected).over == 1


@pytest.mark.parametrize("size", [(7, 4), (5, 7), (8, 5), (35, 1)])
def test_another_size_is_never_compared(size: tuple[int, int]) -> None:
    result = compare(picture(*size), picture(7, 5))
    assert not result.ok
    assert (result.verdict, result.size, result.expected_size) == ("size", size, (7, 5))
    assert "7 × 5" in str(result)


@pytest.mark.parametrize("colour", [(0, 0, 0, 0), (0, 0, 0, 255), (255, 0, 255, 255), (255, 255, 255, 255)])
@pytest.mark.parametrize("size", [(7, 5), (3, 3)])
def test_a_picture_of_one_colour_never_passes(colour: tuple[int, ...], size: tuple[int, int]) -> None:
    blank = np.full((5, 7, 4), colour, np.uint8)
    for expected in (blank.copy(), picture(*size), None):
        result = compare(blank, expected)
        assert not result.ok
        assert result.verdict == "blank"
        assert result.actual == colour
        assert str(colour) in str(result)


@pytest.mark.parametrize("size", [(7, 5), (640, 360)])
@pytest.mark.parametrize("channel", range(4))
def test_one_other_pixel_is_not_blank(size: tuple[int, int], channel: int) -> None:
    flat = np.zeros((size[1], size[0], 4), np.uint8)
    nearly = changed(flat, size[0] - 2, size[1] - 2, channel, 2)
    assert compare(nearly, nearly.copy()).ok


@pytest.mark.parametrize("size", [(7, 5), (640, 360)])
def test_noise_of_one_level_is_one_colour_still(size: tuple[int, int]) -> None:
    noisy = picture(*size, low=200, high=202)
    result = compare(noisy, noisy.copy())
    assert result.verdict == "blank"
    assert "to within one level" in str(result)


def test_a_blank_reference_does_not_let_a_picture_pass() -> None:
    assert compare(picture(), np.zeros((5, 7, 4), np.uint8)).verdict == "differs"


def test_nothing_to_compare_with_is_missing() -> None:
    result = compare(picture(), None)
    assert not result.ok
    assert (result.verdict, result.expected_size) == ("missing", None)


def test_the_order_in_memory_does_not_matter() -> None:
    item = picture(9, 9)
    turned = np.asfortranarray(item)
    assert compare(turned, item).ok
    assert compare(item[::-1], item[::-1].copy()).ok
    assert compare(item[:, ::2], item[:, ::2].copy()).ok
    assert not compare(item[::-1], item).ok


def test_neither_picture_is_written_to() -> None:
    first, other = picture(), picture()
    before = first.copy(), other.copy()
    for array in (first, other):
        array.setflags(write=False)
    compare(first, other)
    difference_picture(first, other)
    np.testing.assert_array_equal((first, other), before)


def test_the_difference_is_amplified_sixteen_times() -> None:
    expected = picture(low=100, high=150)
    assert not difference_picture(expected, expected)[..., :3].any()
    shown = difference_picture(changed(expected, 3, 2, 1, -2), expected)
    assert shown[2, 3].tolist() == [0, 32, 0, 255]
    assert np.count_nonzero(shown[..., :3]) == 1
    np.testing.assert_array_equal(shown, difference_picture(expected, changed(expected, 3, 2, 1, -2)))
    for by, seen in ((15, 240), (16, 255), (100, 255)):
        assert difference_picture(changed(expected, 3, 2, 0, by), expected)[2, 3, 0] == seen


def test_a_difference_in_alpha_is_grey_and_seen() -> None:
    expected = picture(low=100, high=150)
    shown = difference_picture(changed(expected, 3, 2, 3, 3), expected)
    assert shown[2, 3].tolist() == [48, 48, 48, 255]


def test_what_only_one_picture_has_is_magenta() -> None:
    tall, wide = picture(3, 6), picture(5, 2)
    tall[:2, :3] = wide[:2, :3]
    shown = difference_picture(tall, wide)
    assert shown.shape == (6, 5, 4)
    magenta = (shown == (255, 0, 255, 255)).all(axis=2)
    assert not magenta[:2, :3].any()
    assert magenta[2:].all() and magenta[:, 3:].all()


def test_a_comparison_is_one_line() -> None:
    comparisons: list[Comparison] = [
        compare(picture(), picture()),
        compare(picture(), picture(3, 3)),
        compare(picture(), None),
        compare(np.zeros((5, 7, 4), np.uint8), None),
    ]
    for comparison in comparisons:
        assert str(comparison).startswith(f"{comparison.verdict}: ")
        assert "\n" not in str(comparison)
