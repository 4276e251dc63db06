"""view/profile: heights under a line, a section whose ticks and numbers can be read back off the picture."""

from __future__ import annotations

import numpy as np
import pytest

from playground.sketch.model import Sketch

HEIGHT = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) {{ return {}; }}\n'
PASSES = '[[pass]]\nname = "height"\nuse = "./terrain"\n{}[view]\nuse = "view/profile"\nset = {{ {} }}\n'
EASTWARD = "float(texel.x) / float(size.x - 1)"
NUMBERS = "view/profile/digits.glsl"
SIZE = (640, 360)

SIGNS = """
 ###    #    ###  #####    #  #####   ##  #####  ###   ###
#   #  ##   #   #    #    ##  #      #        # #   # #   #
#  ##   #       #   #    # #  ####  #        #  #   # #   #
# # #   #      #     #  #  #      # ####    #    ###   ####
##  #   #     #       # #####     # #   #   #   #   #     #
#   #   #    #    #   #    #  #   # #   #   #   #   #    #
 ###   ###  #####  ###     #   ###   ###    #    ###   ##
""".strip("\n").split("\n")
DIGITS = [
    np.array([[c == "#" for c in row.ljust(60)[6 * k : 6 * k + 5]] for row in SIGNS], bool) for k in range(10)
]


def read_sign(dots: np.ndarray) -> str:
    """Return the digit that 7 x 5 dots are, top row first; "" for none."""
    result = [str(k) for k, digit in enumerate(DIGITS) if (digit == dots).all()]
    return result[0] if result else ""


# ── numbers ──────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("number", "decimals", "text"),
    [
        (0, 0, "0"),
        (1234567890, 0, "1234567890"),
        (-45, 0, "-45"),
        (12345, 2, "123.45"),
        (7, 1, "0.7"),
        (-5, 2, "-0.05"),
    ],
)
def test_a_number_is_written_as_python_writes_it(on_gpu, number, decimals, text):
    assert f"{number / 10**decimals:.{decimals}f}" == text
    wide = 6 * len(text) - 1
    assert on_gpu(NUMBERS, f"number_width({number}, {decimals})")[0] == wide
    x, y = np.meshgrid(np.arange(-3, wide + 4), np.arange(-2, 10))
    pixels = np.stack([x.ravel(), y.ravel()], axis=-1).astype(np.int32)
    result = on_gpu(NUMBERS, f"number_at(p, {number}, {decimals})", p=pixels).reshape(x.shape)[::-1] > 0.5
    for k, sign in enumerate(text):
        dots = result[3:10, 3 + 6 * k : 8 + 6 * k]
        if sign == "-":
            assert dots[3].sum() == 3 and dots.sum() == 3
        elif sign == ".":
            assert dots[5:].sum() == 4 and dots.sum() == 4
        else:
            assert read_sign(dots) == sign
    inked = np.argwhere(result)
    assert inked[:, 0].min() >= 3 and inked[:, 0].max() <= 9
    assert inked[:, 1].min() >= 3 and inked[:, 1].max() < 3 + wide


# ── heights under the line ───────────────────────────────────────────────────


def test_elevations_are_interpolated_along_the_line(engine, make_sketch):
    start, finish = (0.1, 0.9), (0.85, 0.2)
    text = "base_elevation = 70.0\n" + '[[pass]]\nname = "height"\nuse = "generation/white_noise"\n'
    text += '[[pass]]\nname = "line"\nuse = "view/profile/line"\nsize = [200, 1]\n'
    text += f"set = {{ start = {list(start)}, finish = {list(finish)} }}\n"
    sketch = make_sketch(text, size=[33, 21], relief=250.0)
    height = engine.read(sketch, "height").astype(float)
    result = engine.read(sketch, "line")[0]
    t = np.linspace(0, 1, 200)
    x, y = (np.array([(1 - t) * a + t * b for a, b in zip(start, finish, strict=True)]).T * [32, 20]).T
    i, j = np.minimum(x.astype(int), 31), np.minimum(y.astype(int), 19)
    fx, fy = x - i, y - j
    south = height[j, i] * (1 - fx) + height[j, i + 1] * fx
    north = height[j + 1, i] * (1 - fx) + height[j + 1, i + 1] * fx
    np.testing.assert_allclose(result, 70 + 250 * (south * (1 - fy) + north * fy), atol=2e-3)


# ── the section ──────────────────────────────────────────────────────────────


class Section:
    """A section read back off its picture: axes, ticks with their numbers, the curve."""

    def __init__(self, picture: np.ndarray) -> None:
        rgb = picture[..., :3].astype(int)
        self.ink = rgb.max(axis=-1) < 90
        # The axes are the longest dark column and row right of the map.
        self.left = 260 + int(self.ink[:, 260:].sum(axis=0).argmax())
        self.foot = int(self.ink[:, self.left :].sum(axis=1).argmax())
        right = rgb[:, self.left + 6 :]
        red = (
            (right[..., 0] > right[..., 1] + 60)
            & (right[..., 0] > right[..., 2] + 60)
            & (right[..., 1] < 120)
        )
        red[self.foot - 5 :] = False
        self.curve = {
            self.left + 6 + x: np.flatnonzero(column).mean() for x, column in enumerate(red.T) if column.any()
        }

    def up(self) -> dict[int, int]:
        """Return the elevations at the left axis by the picture's row."""
        numbers = {}
        for row in np.flatnonzero(self.ink[: self.foot - 4, self.left - 3]):
            text, x = "", self.left - 11
            while sign := read_sign(self.ink[row - 3 : row + 4, x : x + 5]):
                text, x = sign + text, x - 6
            if text:  # a tick between two rows is drawn in both
                numbers[int(row)] = int(text)
        return numbers

    def along(self) -> dict[int, int]:
        """Return the distances under the lower axis by the picture's column."""
        numbers = {}
        for column in np.flatnonzero(self.ink[self.foot + 4, self.left + 6 :]) + self.left + 6:
            for count in range(1, 6):
                x = column - (6 * count - 1) // 2
                signs = [
                    read_sign(self.ink[self.foot + 9 : self.foot + 16, x + 6 * k : x + 6 * k + 5])
                    for k in range(count)
                ]
                if all(signs):
                    numbers[int(column)] = int("".join(signs))
        return numbers


@pytest.fixture
def section(make_sketch):
    def read(engine, terrain, given="start = [0.0, 0.5], finish = [1.0, 0.5]", **more) -> Section:
        sketch: Sketch = make_sketch(PASSES.format("", given), terrain=HEIGHT.format(terrain), **more)
        return Section(engine.render(sketch, size=SIZE).array)

    return read


@pytest.mark.parametrize(("extent", "relief"), [(1000.0, 100.0), (5000.0, 640.0), (800.0, 37.0)])
def test_numbers_at_the_ticks_are_those_of_the_curve(engine, section, extent, relief):
    """On a plane: under a number along, the curve is at the elevation that the numbers upwards say."""
    result = section(engine, EASTWARD, size=65, extent=extent, relief=relief)
    up, along = result.up(), result.along()
    assert len(up) >= 4 and len(along) >= 3
    rows, elevations = np.array(list(up.items())).T
    columns, distances = np.array(list(along.items())).T
    slope, base = np.polyfit(rows, elevations, 1)
    np.testing.assert_allclose(slope * rows + base, elevations, atol=abs(slope) * 0.8)
    for column, distance in zip(columns, distances, strict=True):
        column = min(column, max(result.curve))  # the last tick stands on the section's rim
        elevation = slope * result.curve[column] + base
        np.testing.assert_allclose(elevation, relief * distance / extent, atol=abs(slope) * 1.5)


def test_ticks_stand_at_round_numbers(any_engine, section):
    for relief in (90.0, 1234.0, 317.0):
        elevations = np.array(sorted(section(any_engine, EASTWARD, size=65, relief=relief).up().values()))
        steps = np.unique(np.diff(elevations))
        assert len(steps) == 1
        assert str(steps[0]).rstrip("0") in ("1", "2", "5")
        assert (elevations % steps[0] == 0).all()


def test_profile_shows_elevation_above_sea_and_long_lines_in_km(any_engine, make_sketch):
    text = "base_elevation = 1400.0\n" + PASSES.format("", "start = [0.0, 0.5], finish = [1.0, 0.5]")
    sketch = make_sketch(text, size=65, extent=40000.0, relief=500.0, terrain=HEIGHT.format(EASTWARD))
    result = Section(any_engine.render(sketch, size=SIZE).array)
    assert min(result.up().values()) >= 1300 and max(result.up().values()) <= 2000
    assert max(result.along().values()) in (35, 40)


def test_profile_elevation_range_fits_line_or_whole_terrain(any_engine, section):
    value = 'start = [0.0, 0.5], finish = [0.3, 0.5], elevations = "{}"'
    line, terrain = (
        section(any_engine, EASTWARD, value.format(what), size=65, relief=1000.0)
        for what in ("of the line", "of the land")
    )
    assert max(line.up().values()) <= 330
    assert max(terrain.up().values()) >= 900


def test_level_terrain_and_a_line_of_no_length_are_drawn_too(any_engine, section):
    flat = section(any_engine, "0.5", size=9)
    rows = np.array(list(flat.curve.values()))
    assert np.ptp(rows) < 1
    point = section(any_engine, EASTWARD, "start = [0.5, 0.5], finish = [0.5, 0.5]", size=9)
    assert np.ptp(np.array(list(point.curve.values()))) < 1


def test_the_map_is_the_terrain_s_colour_with_the_line_on_it(any_engine, make_sketch):
    blue = '[[pass]]\nname = "colour"\nuse = "./blue"\n'
    text = PASSES.format(blue, "start = [0.25, 0.25], finish = [0.75, 0.75]")
    kernel = HEIGHT.replace("height:r32f", "colour:rgba16f").replace("float kernel", "vec4 kernel")
    kernel = kernel.format("vec4(0.0, 0.0, 1.0, 1.0)")
    sketch = make_sketch(text, size=9, extent=[1000.0, 500.0], terrain=HEIGHT.format("0.0"), blue=kernel)
    picture = any_engine.render(sketch, size=SIZE).array[..., :3].astype(int)
    rows, columns = np.nonzero((picture == (0, 0, 255)).all(axis=-1))
    width, height = np.ptp(columns) + 1, np.ptp(rows) + 1
    assert 200 < width < 260
    np.testing.assert_allclose(height / width, 0.5, atol=0.01)
    # From a quarter to three quarters, upwards to the east, and nowhere else.
    for share, on in ((0.25, True), (0.5, True), (0.75, True), (0.1, False), (0.9, False)):
        column = columns.min() + round(share * width)
        row = rows.max() - round(share * height)
        patch = picture[row - 1 : row + 2, column - 1 : column + 2].reshape(-1, 3)
        assert ((patch[:, 0] > 100) & (patch[:, 2] < 150)).any() == on
