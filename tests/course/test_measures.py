"""What lessons measure, against values known beforehand, a flood in a queue, and laws made on purpose."""

from __future__ import annotations

import math

import numpy as np
import pytest
import scipy.ndimage

from playground.course import measures
from playground.course.measures import (
    MEASURES,
    Grid,
    OfTexture,
    filled,
    measured,
    named_in,
    numbers_of,
    peaks_on_lattice,
    spelled,
)
from playground.errors import SketchError

from ..truth.drainage import drained_areas, exponent_of

GRID = Grid((10.0, 10.0), 100.0)
RAMP = np.tile(np.linspace(0.0, 1.0, 65), (65, 1))  # rises eastwards
NOISE = np.random.default_rng(3).random((65, 65))


def test_each_says_what_it_returns():
    for name, measure in MEASURES.items():
        if isinstance(measure, OfTexture):
            assert measure.function.__doc__ and measure.function.__name__ == name


def test_plain_statistics():
    assert measures.mean(RAMP, GRID) == pytest.approx(0.5)
    assert (measures.lowest(RAMP, GRID), measures.highest(RAMP, GRID)) == (0.0, 1.0)
    assert measures.spread(RAMP * 3, GRID) == pytest.approx(3.0)
    assert measures.deviation(NOISE, GRID) == pytest.approx(math.sqrt(1 / 12), rel=0.05)
    assert measures.share_below(RAMP, GRID, 0.25) == pytest.approx(16 / 65)
    assert measures.share_above(RAMP, GRID, 0.25) == pytest.approx(48 / 65)
    assert measures.share_between(RAMP, GRID, 0.25, 0.5) == pytest.approx(17 / 65)
    assert measures.distinct(RAMP, GRID) == 65


def test_local_maxima_are_those_that_scipy_finds():
    highest = scipy.ndimage.maximum_filter(NOISE, 3) == NOISE
    assert measures.local_maxima(NOISE, GRID) == highest[1:-1, 1:-1].sum()
    assert measures.local_maxima(np.zeros((9, 9)), GRID) == 0


def test_a_ramp_s_slope():
    """64 steps of 10 m for 100 m of rise."""
    expected = math.degrees(math.atan(100 / 640))
    assert measures.mean_slope(RAMP, GRID) == pytest.approx(expected)
    assert measures.share_steeper(RAMP, GRID, expected - 0.1) == 1.0
    assert measures.share_steeper(RAMP, GRID, expected + 0.1) == 0.0


@pytest.mark.parametrize("hurst", [0.2, 0.8])
def test_the_spectrum_s_slope_of_a_terrain_made_of_it(hurst):
    n = 512
    along = np.fft.fftfreq(n, 1 / n)
    frequency = np.hypot(along[None], along[:, None])
    frequency[0, 0] = 1.0
    waves = np.fft.fft2(np.random.default_rng(1).standard_normal((n, n))) / frequency ** (hurst + 1)
    assert measures.spectrum_slope(np.fft.ifft2(waves).real, GRID) == pytest.approx(
        -(2 * hurst + 2), abs=0.15
    )


def test_boxes_of_a_line_and_of_a_plane():
    line = np.zeros((256, 256))
    line[100] = 1.0
    assert measures.box_dimension(line, GRID, 0.5) == pytest.approx(1.0)
    assert measures.box_dimension(np.ones((256, 256)), GRID, 0.5) == pytest.approx(2.0)


def test_a_crease_along_the_diagonal_only():
    x, y = np.meshgrid(np.arange(129), np.arange(129))
    rough = 0.01 * np.random.default_rng(2).random((129, 129))
    assert measures.diagonal_crease(rough, GRID) == pytest.approx(1.0, abs=0.3)
    assert measures.diagonal_crease(np.abs(x - y) + rough, GRID) > 50


def test_a_step_at_a_column():
    terrain = np.cumsum(np.full((20, 40), 0.1), axis=1)
    assert measures.step_across(terrain, GRID, 20) == pytest.approx(1.0)
    terrain[:, 20:] += 0.4
    assert measures.step_across(terrain, GRID, 20) == pytest.approx(5.0)
    assert measures.step_across(terrain, GRID, 19) == pytest.approx(1.0)


def test_correlation_with_itself_moved():
    waves = np.sin(2 * np.pi * np.arange(64) / 16)[None].repeat(64, 0)
    assert measures.correlation(waves, GRID, 16, 0) == pytest.approx(1.0)
    assert measures.correlation(waves, GRID, 8, 5) == pytest.approx(-1.0)
    moved = NOISE[3:, 4:]
    expected = np.corrcoef(moved.ravel(), NOISE[:-3, :-4].ravel())[0, 1]
    assert measures.correlation(NOISE, GRID, 4, 3) == pytest.approx(expected)
    assert abs(measures.correlation(NOISE, GRID, -4, 3)) < 0.1


def test_what_repeats_has_no_edge():
    waves = np.sin(2 * np.pi * np.arange(64) / 64)[None].repeat(4, 0)
    assert measures.edge_match(waves, GRID) == pytest.approx(1.0, rel=0.7)
    assert measures.edge_match(RAMP, GRID) == pytest.approx(64.0)


@pytest.mark.parametrize(
    ("value", "digits", "unit", "text"),
    [
        (1.0, 3, "", "1"),
        (0.98765, 3, "", "0.988"),
        (12345.6, 3, "", "12\u202f300"),
        (3330.0, 4, "", "3\u202f330"),
        (263169.0, 6, "", "263\u202f169"),
        (0.0, 3, "", "0"),
        (-2.6, 2, "", "−2.6"),
        (45.04, 3, "°", "45.0°"),
        (12.34, 2, "%", "12\u202f%"),
        (0.00123, 2, "m", "0.0012\u202fm"),
        (9.999, 2, "", "10"),
    ],
)
def test_how_a_number_is_written(value, digits, unit, text):
    assert spelled(value, digits, unit) == text


def test_numbers_go_where_words_name_them(lesson, engine):
    numbers = numbers_of(engine, lesson)
    terrain = engine.read(lesson.named["spread"].scene.sketch, "height")
    assert numbers["spread"].value == pytest.approx(float(terrain.max() - terrain.min()))
    words = "It is {{spread}}; {{ spread }}, not {{other}}."
    assert named_in(words) == ["spread", "spread", "other"]
    text = numbers["spread"].text
    assert filled(words, numbers, "en") == f"It is {text}; {text}, not …."
    assert filled("{{spread}}", numbers, "fr") == text.replace(".", ",")


def test_a_quotient_of_two_terrains(make_lesson, engine):
    """Diamond-square is linear in its smoothing where its corners are level."""
    level = 'set = { "height.corners" = [0.5, 0.5, 0.5, 0.5], "height.smoothing" = 0.3 }\nwhat    = "spread"'
    over = f'{level}\nover = {{ set = {{ "height.smoothing" = 0.6 }} }}'
    block = make_lesson(('what    = "spread"', over)).named["spread"]
    assert measured(engine, block).value == pytest.approx(0.5, rel=1e-4)
    hundredths = make_lesson(('what    = "spread"', f'{over}\nunit = "%"')).named["spread"]
    assert measured(engine, hundredths).value == pytest.approx(50.0, rel=1e-4)


def test_numbers_of_the_engine_s_own(make_lesson, engine):
    def number(what, of="height.raw"):
        return measured(
            engine, make_lesson(('what    = "spread"', f'of = "{of}"\nwhat = "{what}"')).named["spread"]
        )

    assert number("iterations").value == 5
    assert number("texels").value == 5 * 5 * 5
    assert number("texture_bytes").value == 5 * 5 * 4
    assert number("milliseconds").value > 0


def test_triangles_of_a_terrain_that_is_drawn(make_lesson, engine):
    change = (
        'sketch  = "diamond_square_steps"\nwhat    = "spread"',
        'sketch = "wireframe"\nset = { "view.grid" = 9 }\nwhat = "triangles"',
    )
    assert measured(engine, make_lesson(change).named["spread"]).value >= 2 * 8 * 8


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ('what = "step_across"\nwith = { at = 0 }', "column 0 of 5 has not four on each side"),
        ('what = "step_across"\nwith = { at = 40 }', "column 40 of 5 has not four on each side"),
        ('what = "peaks_on_lattice"\nwith = { every = 0 }', "every = 0: expected 1 or more"),
        ('what = "correlation"\nwith = { dx = 5, dy = 0 }', "moved by 5, 0: expected less than 5"),
        ('what = "local_maxima"\nof = "nowhere"', "no pass 'nowhere'"),
    ],
)
def test_arguments_that_do_not_fit_are_a_sentence(make_lesson, engine, change, words):
    block = make_lesson(('what    = "spread"', change)).named["spread"]
    with pytest.raises(SketchError) as caught:
        measured(engine, block)
    assert words in caught.value.diagnostics[0].message


def test_what_is_no_number_is_refused(make_lesson, engine):
    level = '"height.corners" = [0.5, 0.5, 0.5, 0.5], "height.smoothing" = 0.0'
    over = f'what = "spread"\nover = {{ set = {{ {level} }} }}'
    block = make_lesson(('what    = "spread"', over)).named["spread"]
    with pytest.raises(SketchError, match="measure 'spread': nan is not a number to show"):
        measured(engine, block)


def test_the_mean_below_a_mesh_counts_edges_by_half():
    """That of the bilinear surface, by its value in the middle of each cell."""
    cells = (NOISE[1:, 1:] + NOISE[1:, :-1] + NOISE[:-1, 1:] + NOISE[:-1, :-1]) / 4
    assert measures.mean_below_mesh(NOISE, GRID) == pytest.approx(cells.mean())


# ── water ─────────────────────────────────────────────────────────────────────


STEEP = Grid((20.0, 30.0), 500.0)


def valley(ny, nx):
    """Return heights that all drain to one row, and along it westwards."""
    y, x = np.mgrid[:ny, :nx]
    return 0.1 * abs(y - ny // 2) + 0.001 * x


def test_areas_are_those_of_a_flood():
    """On a terrain whose every texel has a way down, so that a flood fills nothing."""
    heights = valley(41, 57) + 1e-5 * np.random.default_rng(2).random((41, 57))
    assert measures.pits(heights, STEEP) == 0.0
    square = Grid((10.0, 10.0), 500.0)
    slopes, receivers = measures.flow_directions(heights, square)
    np.testing.assert_array_equal(measures.drainage_areas(heights, receivers), drained_areas(heights))
    assert slopes[20, 30] == pytest.approx(0.001 * 500 / 10, rel=0.05)


def test_pits_are_counted():
    heights = valley(41, 57)
    heights[10, 10] = heights[30, 40] = -1.0
    assert measures.pits(heights, STEEP) == pytest.approx(2 / (39 * 55))


def test_the_tail_of_areas():
    areas = drained_areas(np.random.default_rng(5).random((150, 150)).cumsum(0).cumsum(1)) * 1e4
    low, high = 20 * 0.01, areas.size / 50 * 0.01
    assert measures.tail_power(areas, STEEP, low, high) == pytest.approx(exponent_of(areas / 1e4), rel=1e-9)
    with pytest.raises(ValueError, match="some texels exceed"):
        measures.tail_power(areas, STEEP, 1e6, 2e6)


@pytest.mark.parametrize("power", [-0.5, -0.3])
def test_a_law_of_slopes_is_found_again(power):
    """A river in the middle row, of S = 2 A^p where A is what lies east of it, edges aside."""
    ny, nx = 21, 80
    area = np.arange(nx, 0, -1) * (ny - 2) * 600.0  # [m²]
    rise = 2.0 * area**power * 20.0 / 500.0
    river = np.cumsum(rise) - rise[0]
    heights = river + 10.0 * abs(np.arange(ny) - ny // 2)[:, None]
    heights[:, -1] += 1.0  # the eastern edge is an outlet: nothing may leave by it
    slope_area_power = measures.slope_area_power(heights, STEEP, 0.05, 2.0)
    assert slope_area_power == pytest.approx(power, abs=0.03)
    middle = measures.slope_where_drained(heights, STEEP, 0.3, 0.34)
    assert middle == pytest.approx(2.0 * 0.32e6**power, rel=0.1)
    with pytest.raises(ValueError, match="no texel drains"):
        measures.slope_where_drained(heights, STEEP, 1e3, 2e3)


def test_peak_counts_if_row_and_column_are_on_lattice():
    values = np.zeros((17, 17))
    for row, column in ((4, 8), (6, 2), (9, 4), (4, 11), (13, 13)):
        values[row, column] = 1.0
    assert peaks_on_lattice(values, Grid(), 2) == 2 / 5
    assert peaks_on_lattice(values, Grid(), 4) == 1 / 5
    assert peaks_on_lattice(values, Grid(), 1) == 1.0


def test_what_is_no_peak_does_not_count():
    values = np.zeros((9, 9))
    values[4, 4:6] = 1.0  # two texels alike
    values[0, 2] = 2.0  # at the border
    assert peaks_on_lattice(values, Grid(), 2) == 0.0
