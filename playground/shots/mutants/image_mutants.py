"""Mutants of the finished picture: what can go wrong after the last draw.

Each is one function from a picture to a broken copy. Random numbers are seeded, so that a mutant is
the same at every run.
"""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from playground.shots.mutants.model import Finished, Picture

_SEED = 20101


def _upside_down(picture: Picture) -> Picture:
    return picture[::-1].copy()


def _mirrored(picture: Picture) -> Picture:
    return picture[:, ::-1].copy()


def _blue_first(picture: Picture) -> Picture:
    return picture[..., [2, 1, 0, 3]]


def _one_pixel_along(picture: Picture) -> Picture:
    broken = picture.copy()
    broken[:, 1:] = picture[:, :-1]
    return broken


def _half_a_pixel_along(picture: Picture) -> Picture:
    after = _one_pixel_along(picture).astype(np.uint16)
    return ((picture + after + 1) // 2).astype(np.uint8)


def _magenta_square(picture: Picture) -> Picture:
    broken = picture.copy()
    middle = picture.shape[0] // 2, picture.shape[1] // 2
    broken[middle[0] - 16 : middle[0] + 16, middle[1] - 16 : middle[1] + 16] = (255, 0, 255, 255)
    return broken


def _dead_row(picture: Picture) -> Picture:
    broken = picture.copy()
    broken[picture.shape[0] // 3, :, :3] = 0
    return broken


def _lost_row(picture: Picture) -> Picture:
    broken = picture.copy()
    lost = picture.shape[0] // 3
    broken[lost:-1] = picture[lost + 1 :]
    return broken


def _dead_pixel(picture: Picture) -> Picture:
    broken = picture.copy()
    place = picture.shape[0] // 2, picture.shape[1] // 3
    broken[place] = 255 - broken[place]
    broken[place][3] = 255
    return broken


def _dark_rim(picture: Picture) -> Picture:
    broken = picture.copy()
    for rim in (np.s_[:1], np.s_[-1:], np.s_[:, :1], np.s_[:, -1:]):
        broken[rim][..., :3] = picture[rim][..., :3] // 2
    return broken


def _five_bits(picture: Picture) -> Picture:
    broken = picture.copy()
    broken[..., :3] = (picture[..., :3] & 0xF8) | (picture[..., :3] >> 5)
    return broken


def _blocks(picture: Picture) -> Picture:
    from PIL import Image

    stream = io.BytesIO()
    Image.fromarray(picture[..., :3]).save(stream, "JPEG", quality=75)
    broken = picture.copy()
    broken[..., :3] = np.asarray(Image.open(stream))
    return broken


def _grey(picture: Picture) -> Picture:
    broken = picture.copy()
    weights = np.array((0.2126, 0.7152, 0.0722))
    broken[..., :3] = np.rint(picture[..., :3] @ weights).astype(np.uint8)[..., None]
    return broken


def _two_levels_up(picture: Picture) -> Picture:
    broken = picture.copy()
    broken[..., :3] = np.minimum(picture[..., :3].astype(np.uint16) + 2, 255)
    return broken


def _blank(picture: Picture) -> Picture:
    broken = np.zeros_like(picture)
    broken[..., 3] = 255
    return broken


def _half_blank(picture: Picture) -> Picture:
    broken = picture.copy()
    broken[: picture.shape[0] // 2] = (0, 0, 0, 255)
    return broken


def _cropped(picture: Picture) -> Picture:
    return picture[:-1].copy()


def _faint_patch(picture: Picture) -> Picture:
    row, column = picture.shape[0] // 2, picture.shape[1] // 2
    return _off(picture, 3, slice(row - 12, row + 12), slice(column - 12, column + 12))


def _specks(picture: Picture) -> Picture:
    return _off(picture, 3, np.random.default_rng(_SEED).random(picture.shape[:2]) < 0.003)


def _noise_of_two(picture: Picture) -> Picture:
    generator = np.random.default_rng(_SEED)
    seen = generator.random(picture.shape[:2]) < 0.01
    return _off(picture, 2 * generator.choice((-1, 1), (int(seen.sum()), 3)).astype(np.int16), seen)


def _noise_of_one(picture: Picture) -> Picture:
    return _off(picture, np.random.default_rng(_SEED).integers(-1, 2, (*picture.shape[:2], 3), np.int16), ...)


def _off(picture: Picture, levels: Any, *where: Any) -> Picture:
    """Return the picture with its colours off by so many levels at some places."""
    broken = picture.astype(np.int16)
    broken[(*where, slice(3))] += levels
    return np.clip(broken, 0, 255).astype(np.uint8)


FINISHED: tuple[Finished, ...] = (
    Finished("upside-down", "Rows are read from the bottom up.", _upside_down),
    Finished("mirrored", "East and west are exchanged.", _mirrored),
    Finished("blue-for-red", "Bytes are taken in the order blue, green, red.", _blue_first),
    Finished("one-pixel-along", "The picture is one pixel further to the right.", _one_pixel_along),
    Finished(
        "half-a-pixel-along",
        "The picture is half a pixel further to the right, so that each pixel is the mean of two.",
        _half_a_pixel_along,
    ),
    Finished(
        "magenta-square",
        "A square of 32 × 32 pixels has the colour of a texture that is missing.",
        _magenta_square,
    ),
    Finished("dead-row", "One row of the picture is black.", _dead_row),
    Finished("lost-row", "One row is lost, and those below it move up.", _lost_row),
    Finished("dead-pixel", "One pixel has the wrong colour.", _dead_pixel),
    Finished("dark-rim", "A rim one pixel wide is half as bright: a filter reads outside.", _dark_rim),
    Finished("five-bits", "Each colour has five bits, so that the sky has bands.", _five_bits),
    Finished("jpeg-blocks", "The picture went through a JPEG of quality 75.", _blocks),
    Finished("grey", "All three colours are the picture's luminance.", _grey),
    Finished("two-levels-brighter", "Every colour is two levels of 255 brighter.", _two_levels_up),
    Finished("blank", "Nothing is drawn.", _blank),
    Finished("half-blank", "The upper half is not drawn.", _half_blank),
    Finished("a-row-short", "The picture is one row too small.", _cropped),
    Finished("faint-patch", "A patch of 24 × 24 pixels is three levels brighter.", _faint_patch),
    Finished("specks", "Three pixels in a thousand are three levels brighter.", _specks),
    Finished("noise-of-two", "One pixel in a hundred is off by two levels.", _noise_of_two),
    Finished(
        "noise-of-one",
        "Nothing: levels are off by one at most, as where a sum is rounded the other way.",
        _noise_of_one,
        exempt=True,
    ),
)  # fmt: skip
"""Each of them, in the order in which they are listed."""
