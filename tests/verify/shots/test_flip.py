"""FLIP: against its authors' own program where that can be installed, and by what the paper says of it."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from playground.data.image_files import read_png
from playground.errors import DataError
from playground.verify.shots.flip import Flip, coloured, flip, flip_picture, ramp

SCREENSHOTS = Path(__file__).resolve().parent.parent.parent.parent / "screenshots"


def seeded(width: int, height: int, seed: int = 5) -> np.ndarray:
    array = np.random.default_rng(seed).integers(0, 256, (height, width, 4), dtype=np.uint8)
    array[..., 3] = 255
    return array


def plain(*colour: int, size: tuple[int, int] = (40, 40)) -> np.ndarray:
    return np.full((size[1], size[0], 4), (*colour, 255), np.uint8)


def shot(name: str) -> np.ndarray:
    """Return the middle of a reference: sky, ridges and slopes."""
    sketch, picture = name.split("/")
    pixels, _ = read_png(SCREENSHOTS / sketch / "llvmpipe" / f"{picture}.png")
    return np.ascontiguousarray(pixels[80:280, 160:480])


def edge(at: int, low: int = 60, high: int = 190) -> np.ndarray:
    array = plain(low, low, low, size=(64, 48))
    array[:, at:, :3] = high
    return array


@pytest.fixture(scope="module")
def authors() -> ModuleType:
    return pytest.importorskip(
        "flip_evaluator", reason="the authors' program has no wheels for this Python or machine"
    )


def theirs(
    authors: ModuleType, actual: np.ndarray, expected: np.ndarray, *, coloured: bool = False
) -> np.ndarray:
    first, other = (picture[..., :3].astype(np.float32) / 255 for picture in (expected, actual))
    with np.errstate(all="ignore"):
        return np.squeeze(authors.evaluate(first, other, "LDR", applyMagma=coloured)[0])


PAIRS = {
    "sun": lambda: (shot("jacksboro/morning"), shot("jacksboro/evening")),
    "shifted": lambda: (np.roll(shot("jacksboro/morning"), 2, axis=1), shot("jacksboro/morning")),
    "darker": lambda: (shot("splat/near") // np.array([2, 2, 2, 1], np.uint8), shot("splat/near")),
    "noise": lambda: (seeded(150, 70), seeded(150, 70, 6)),
    "edge": lambda: (edge(30), edge(33)),
    "edge gone": lambda: (edge(30), edge(30, 125, 125)),
    "point": lambda: (_with_point(), plain(30, 60, 90)),
    "green and blue": lambda: (plain(0, 255, 0), plain(0, 0, 255)),
    "black and white": lambda: (plain(0, 0, 0), plain(255, 255, 255)),
    "narrow": lambda: (seeded(3, 90), seeded(3, 90, 6)),
    "one pixel": lambda: (plain(9, 8, 7, size=(1, 1)), plain(99, 8, 7, size=(1, 1))),
}


def _with_point() -> np.ndarray:
    array = plain(30, 60, 90)
    array[20, 11, :3] = 255
    return array


@pytest.mark.parametrize("pair", PAIRS)
def test_it_gives_what_the_authors_program_gives(authors: ModuleType, pair: str) -> None:
    actual, expected = PAIRS[pair]()
    result = flip(actual, expected)
    truth = theirs(authors, actual, expected).reshape(result.difference.shape)
    np.testing.assert_allclose(result.difference, truth, atol=3e-4)
    assert result.mean == pytest.approx(float(truth.mean(dtype=np.float64)), abs=1e-4)
    assert result.difference.dtype == np.float32


def test_its_colours_are_those_of_the_authors_program(authors: ModuleType) -> None:
    actual, expected = PAIRS["sun"]()
    ours = flip_picture(actual, expected)
    truth = theirs(authors, actual, expected, coloured=True) * 255
    # Our ramp is at most 3 levels off theirs; a difference that is rounded the other way has the next colour.
    step = np.abs(np.diff(ramp().astype(float), axis=0)).max()
    off = np.abs(ours[..., :3] - truth).max(axis=-1)
    assert off.max() <= 3 + step
    assert np.mean(off > 3.5) < 0.01  # differences within 3e-4 of the middle between two of 256 colours
    assert (ours[..., 3] == 255).all()


def test_the_same_picture_is_0_everywhere() -> None:
    result = flip(seeded(50, 40), seeded(50, 40))
    assert (result.mean, result.tile, float(result.difference.max())) == (0.0, 0.0, 0.0)


def test_the_largest_difference_in_srgb_is_1() -> None:
    assert flip(plain(0, 255, 0), plain(0, 0, 255)).mean == pytest.approx(1.0, abs=1e-5)


def test_it_is_the_same_both_ways_round_and_in_a_mirror() -> None:
    first, other = seeded(60, 44), seeded(60, 44, 6)
    difference = flip(first, other).difference
    np.testing.assert_allclose(flip(other, first).difference, difference, atol=1e-5)
    np.testing.assert_allclose(
        flip(first[:, ::-1], other[:, ::-1]).difference[:, ::-1], difference, atol=1e-4
    )
    turned = flip(first.swapaxes(0, 1), other.swapaxes(0, 1)).difference.T
    np.testing.assert_allclose(turned, difference, atol=1e-4)


def test_what_moves_further_differs_more() -> None:
    means = [flip(edge(20 + by), edge(20)).mean for by in range(6)]
    assert means == sorted(means)
    assert means[0] == 0 < means[1]


def test_an_edge_that_comes_makes_a_difference_count_more() -> None:
    difference = flip(edge(20, 120, 130), plain(120, 120, 120, size=(64, 48))).difference[24]
    # Outside the blur's radius the colours differ as much as next to the edge, or more.
    assert difference[20:26].max() > 1.2 * difference[55]
    assert difference[55] > difference[5]


def test_the_worst_tile_is_the_worst_of_all_places() -> None:
    values = np.random.default_rng(2).random((47, 70), dtype=np.float32) ** 4
    values[9:20, 31:39] += 0.3
    slow = {
        (x, y): float(values[y : y + 32, x : x + 32].mean(dtype=np.float64))
        for y in range(47 - 31)
        for x in range(70 - 31)
    }
    position = max(slow, key=lambda where: slow[where])
    tile, where = Flip(values).worst_tile()
    assert where == position
    assert tile == pytest.approx(slow[position], abs=1e-9)


@pytest.mark.parametrize("size", [(5, 3), (32, 32), (80, 7)])
def test_a_small_picture_is_one_tile_as_far_as_it_goes(size: tuple[int, int]) -> None:
    values = np.full(size[::-1], 0.25, np.float32)
    assert Flip(values).worst_tile() == (pytest.approx(0.25), (0, 0))


@pytest.mark.parametrize("colour", [(0, 0, 0), (255, 255, 255), (128, 128, 128), (200, 30, 10)])
def test_missing_alpha_is_visible_over_any_colour(colour: tuple[int, int, int]) -> None:
    opaque, clear = plain(*colour), plain(*colour)
    clear[10:30, 10:30, 3] = 0
    difference = flip(clear, opaque).difference
    assert difference[20, 20] > 0.5
    assert difference[2, 2] < 0.01


def test_invisible_colours_count_for_nothing() -> None:
    first, other = seeded(30, 30), seeded(30, 30, 6)
    first[..., 3] = other[..., 3] = 0
    assert flip(first, other).mean == 0


def test_half_a_cover_is_between_none_and_all() -> None:
    covered = [plain(200, 30, 10) for _ in range(3)]
    covered[1][..., 3], covered[2][..., 3] = 128, 0
    half, none = (flip(other, covered[0]).mean for other in covered[1:])
    assert 0 < half < none


@pytest.mark.parametrize(
    ("first", "other"),
    [
        (seeded(8, 8), seeded(8, 9)),
        (seeded(8, 8)[..., :3], seeded(8, 8)),
        (seeded(8, 8).astype(np.float32), seeded(8, 8)),
        (seeded(8, 8)[:0], seeded(8, 8)[:0]),
    ],
)
def test_what_is_no_pair_of_pictures_is_refused_in_a_sentence(first: np.ndarray, other: np.ndarray) -> None:
    with pytest.raises(DataError, match=r"picture"):
        flip(first, other)


def test_the_ramp_grows_lighter_all_the_way_from_black() -> None:
    light = ramp()[:, :3].astype(float) @ [0.2126, 0.7152, 0.0722]
    assert (np.diff(light) > -2.0).all()
    assert (np.diff(light[::8]) > 0).all()
    assert tuple(ramp()[0]) == (0, 0, 4, 255)
    assert tuple(ramp()[255]) == (252, 253, 191, 255)
    assert not ramp().flags.writeable
    np.testing.assert_array_equal(coloured(np.array([[0.0, 0.5, 2.0]], np.float32))[0], ramp()[[0, 128, 255]])
