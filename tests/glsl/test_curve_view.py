"""view/curve: where curves, axes and what is no number are in the picture."""

import numpy as np
import pytest

from playground.shader.colours import srgb_to_linear

HEIGHT = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) {{ return {}; }}\n'
NAN = "uintBitsToFloat(0x7fc00000u)"
# A black curve on white, the range over the whole height.
PLAIN = {"line": "#000000", "line_last": "#000000", "ground": "#ffffff", "axis": False, "margin": 0.0}


@pytest.fixture
def picture(make_sketch):
    """Give ``picture(engine, height, texels, size, **values)``: colours 0..1, the picture's top row first."""

    def make(engine, height, texels, size, **values):
        passes = '[[pass]]\nname = "height"\nuse = "./curve"\n[view]\nuse = "view/curve"\n[view.set]\n'
        passes += "".join(
            f"{k} = {str(v).lower() if v in (True, False) else repr(v)}\n"
            for k, v in (PLAIN | values).items()
        )
        sketch = make_sketch(passes, size=list(texels), curve=HEIGHT.format(height))
        return engine.render(sketch, size=size).array[..., :3].astype(float) / 255

    return make


def ink(shown):
    """Return how much of each pixel is covered by black, linear."""
    return 1 - srgb_to_linear(shown[..., 0])


def middle_of(cover):
    """Return the height of the ink's middle in each column, in pixels from the picture's foot."""
    up = cover.shape[0] - 0.5 - np.arange(cover.shape[0])
    return (cover * up[:, None]).sum(axis=0) / cover.sum(axis=0)


def test_a_slanted_line_is_where_its_ends_say(engine, picture):
    shown = picture(engine, "0.2 + 0.6 * float(texel.x) / 8.0", (9, 1), (160, 100), width=3.0)
    expected = 20 + 60 * (np.arange(160) + 0.5) / 160
    np.testing.assert_allclose(middle_of(ink(shown))[4:-4], expected[4:-4], atol=0.05)


@pytest.mark.parametrize("width", [1.0, 2.5, 6.0])
def test_a_line_is_as_wide_as_its_parameter_says(engine, picture, width):
    shown = picture(engine, "0.5", (5, 1), (64, 101), width=width)
    np.testing.assert_allclose(ink(shown).sum(axis=0), width, atol=0.03)
    steep = picture(engine, "float(texel.x) / 8.0", (9, 1), (100, 100), width=width)
    np.testing.assert_allclose(ink(steep)[:, 30:70].sum(axis=0), width * np.sqrt(2), atol=0.2)


def test_corners_are_where_texels_are(engine, picture):
    """A zigzag of five texels: its tips in the picture's quarters, its middle crossed between."""
    shown = picture(engine, "float(texel.x & 1)", (5, 1), (200, 120), margin=0.1, width=2.0)
    across = middle_of(ink(shown))
    expected = 12 + 96 * (1 - abs((np.arange(200) + 0.5) / 50 % 2 - 1))
    inner = np.abs((np.arange(200) + 0.5) / 50 - np.round((np.arange(200) + 0.5) / 50)) > 0.1
    np.testing.assert_allclose(across[inner], expected[inner], atol=0.1)


def test_the_range_says_what_is_at_foot_and_top(engine, picture):
    shown = picture(engine, "-2.0 + float(texel.x)", (5, 1), (80, 80), lowest=-2.0, highest=2.0, width=2.0)
    np.testing.assert_allclose(middle_of(ink(shown))[5:-5], np.arange(80)[5:-5] + 0.5, atol=0.05)


def test_rows_have_panels_the_first_on_top(engine, picture):
    shown = picture(engine, "0.1 + 0.2 * float(texel.y)", (4, 5), (60, 250), width=2.0)
    cover = ink(shown)
    for row in range(5):
        panel = cover[50 * row : 50 * row + 50]
        np.testing.assert_allclose(middle_of(panel), 50 * (0.1 + 0.2 * row), atol=0.05)
    fewer = ink(picture(engine, "0.1 + 0.2 * float(texel.y)", (4, 5), (60, 250), rows=2, width=2.0))
    np.testing.assert_allclose(middle_of(fewer[:125]), 12.5, atol=0.05)
    np.testing.assert_allclose(middle_of(fewer[125:]), 37.5, atol=0.05)


def test_overlaid_curve_rows_share_panel_with_own_colours(engine, picture):
    value = {"arranged": "overlaid", "line": "#ff0000", "line_last": "#0000ff", "width": 4.0}
    shown = picture(engine, "0.25 + 0.25 * float(texel.y)", (4, 3), (40, 200), **value)
    for row, colour in ((50, (1, 0, 0)), (150, (0, 0, 1))):
        np.testing.assert_allclose(shown[200 - row, 20], colour, atol=0.01)
    mixture = shown[100, 20]
    np.testing.assert_allclose(mixture, [mixture[0], 0, mixture[0]], atol=0.01)
    assert 0.7 < mixture[0] < 0.76  # half the light


def test_more_texels_than_pixels_fill_what_they_pass(engine, picture):
    """Eight texels a pixel, up and down between two heights: a band, and nothing outside it."""
    shown = ink(picture(engine, "(texel.x & 1) == 0 ? 0.3 : 0.7", (801, 1), (100, 100), width=1.0))
    assert shown[35:65].min() > 0.85
    assert shown[:28].max() == 0 and shown[72:].max() == 0


def test_the_axis_is_drawn_at_its_number_under_the_curve(engine, picture):
    value = {"axis": True, "axis_colour": "#ff0000", "baseline": 0.25, "width": 4.0}
    shown = picture(engine, "0.75", (3, 2), (40, 202), **value)
    for panel in (0, 101):
        axis = shown[panel + 101 - 26, 20]  # 25.25 up: in the 26th row of pixels from the panel's foot
        np.testing.assert_allclose(axis[0], 1.0, atol=0.01)
        assert axis[1] < 0.8
    hidden = picture(engine, "0.25", (3, 2), (40, 202), **value)
    assert hidden[..., 0].min() < 0.01 and not (hidden[..., 0] > hidden[..., 1] + 0.5).any()


def test_what_is_not_a_number_is_magenta_in_its_own_panel(engine, picture):
    for broken in (NAN, "1.0 / (float(texel.x) - 3.0)"):
        height = f"texel == ivec2(3, 0) ? {broken} : 0.5"
        shown = picture(engine, height, (9, 2), (160, 100))
        magenta = (shown == (1, 0, 1)).all(axis=-1)
        columns = (np.arange(160) + 0.5) / 20
        expected = np.zeros((100, 160), bool)
        expected[:50] = np.abs(columns - 3) <= 0.5
        np.testing.assert_array_equal(magenta, expected)
        assert ink(shown)[:50, :35].max() > 0.7


def test_no_such_texel_is_lost_among_many(engine, picture):
    shown = picture(engine, f"texel.x == 401 ? {NAN} : 0.5", (1601, 1), (100, 40))
    assert (shown == (1, 0, 1)).all(axis=-1).any(axis=0)[24:26].any()


@pytest.mark.parametrize("texels", [(1, 1), (2, 1), (1, 4), (3000, 2), (64, 64)], ids=str)
@pytest.mark.parametrize("arranged", ["stacked", "overlaid"])
def test_textures_of_any_size_are_drawn(engine, picture, texels, arranged):
    shown = picture(engine, "0.5", texels, (90, 128), arranged=arranged)
    cover = ink(shown)
    assert cover.sum(axis=0).min() > 0.9
    panels = texels[1] if arranged == "stacked" else 1
    np.testing.assert_allclose(cover.sum(axis=0), min(1.5, 128 / panels) * panels, rtol=0.35)


def test_wild_heights_harm_nothing(engine, picture):
    height = "texel.x == 2 ? 1e38 : texel.x == 5 ? -1e38 : 0.5"
    shown = picture(engine, height, (9, 1), (90, 60))
    assert not (shown == (1, 0, 1)).all(axis=-1).any()
    assert ink(shown)[29:31, :8].max() > 0.5
