"""Colours: the sRGB curve against known pairs, hexadecimal there and back."""

from __future__ import annotations

import numpy as np
import pytest

from playground.errors import DataError
from playground.shader.colours import linear_to_srgb, parse_hex, srgb_to_linear, to_hex


def test_the_curve_passes_through_known_points():
    # Mid grey 128 and the 18 % card (encoded 0.4614) as every table of sRGB has them.
    np.testing.assert_allclose(srgb_to_linear([0.0, 128 / 255, 1.0]), [0.0, 0.2158605, 1.0], atol=1e-7)
    np.testing.assert_allclose(linear_to_srgb(0.18), 0.4613561, atol=1e-7)


def test_the_curve_is_near_the_power_2_2_but_not_it():
    x = np.linspace(0.1, 0.9, 9)
    difference = np.abs(srgb_to_linear(x) - x**2.2)
    assert 1e-4 < difference.max() < 0.01


def test_both_pieces_meet_and_rise():
    x = np.linspace(0.0, 0.1, 20001)
    slopes = np.diff(srgb_to_linear(x)) / np.diff(x)
    assert (slopes > 0.07).all() and slopes.max() < 0.2
    assert abs(float(srgb_to_linear(np.nextafter(0.04045, 1)) - srgb_to_linear(0.04045))) < 1e-7


def test_every_16_bit_code_comes_back():
    codes = np.arange(65536)
    back = linear_to_srgb(srgb_to_linear(codes / 65535.0)) * 65535.0
    assert np.array_equal(np.rint(back).astype(int), codes)


def test_beyond_the_range_the_pieces_go_on_without_a_warning():
    np.testing.assert_allclose(srgb_to_linear([-0.1292, 2.0]), [-0.01, ((2.055) / 1.055) ** 2.4])
    assert linear_to_srgb(-0.01) == pytest.approx(-0.1292)
    assert srgb_to_linear(np.zeros((2, 3, 4), np.float32)).shape == (2, 3, 4)


@pytest.mark.parametrize("text", ["#000000", "#ffffff", "#87a96b", "#01020304", "#10fe80ff"])
def test_hex_comes_back(text):
    assert to_hex(parse_hex(text)) == text


def test_hex_is_decoded_but_alpha_is_not():
    assert parse_hex("#f00") == (1.0, 0.0, 0.0)
    assert parse_hex(" #FF800080 ") == pytest.approx((1.0, 0.2158605, 0.0, 128 / 255), abs=1e-7)


def test_to_hex_clamps():
    assert to_hex((-1.0, 2.0, 0.0)) == "#00ff00"


@pytest.mark.parametrize(
    "text", ["", "#", "red", "#12", "#1234", "#12345", "#gggggg", "123456", "#１２３", 7]
)
def test_what_is_no_colour_is_refused(text):
    with pytest.raises(DataError, match="is not a colour; expected '#rrggbb'"):
        parse_hex(text)


@pytest.mark.parametrize("colour", [(1.0,), (1.0, 2.0), (0.0, float("nan"), 0.0), (1.0,) * 5])
def test_numbers_that_are_no_colour_are_refused(colour):
    with pytest.raises(DataError, match="three or four finite"):
        to_hex(colour)
