"""Mutants of the finished picture: what can go wrong after the last draw.

Each is one function from a picture to a broken copy. Random numbers are seeded, so that a mutant is
the same at every run.

"""

from __future__ import annotations

import io
from typing import Any

import numpy as np

from playground.verify.shots.mutants.rendering import ImageMutant, Picture

_SEED = 20101
_COLOURS = np.s_[..., :3]  # without alpha
_BLACK = (0, 0, 0, 255)


def _set(picture: Picture, where: Any, colours: Any) -> Picture:
    """Return the picture with other values at some places."""
    broken = picture.copy()
    broken[where] = colours
    return broken


def _off(picture: Picture, levels: Any, *where: Any) -> Picture:
    """Return the picture with its colours off by so many levels at some places."""
    broken = picture.astype(np.int16)
    broken[(*where, slice(3))] += levels
    return np.clip(broken, 0, 255).astype(np.uint8)


def _around_the_middle(picture: Picture, half: int) -> tuple[slice, slice]:
    """Return the place of a square in the middle, of twice ``half`` pixels a side."""
    row, column = picture.shape[0] // 2, picture.shape[1] // 2
    return slice(row - half, row + half), slice(column - half, column + half)


def _one_pixel_along(picture: Picture) -> Picture:
    return _set(picture, np.s_[:, 1:], picture[:, :-1])


def _half_a_pixel_along(picture: Picture) -> Picture:
    after = _one_pixel_along(picture).astype(np.uint16)
    return ((picture + after + 1) // 2).astype(np.uint8)


def _lost_row(picture: Picture) -> Picture:
    lost = picture.shape[0] // 3
    return _set(picture, np.s_[lost:-1], picture[lost + 1 :])


def _dead_pixel(picture: Picture) -> Picture:
    texel = picture.shape[0] // 2, picture.shape[1] // 3
    return _set(picture, texel, [*(255 - picture[texel][:3]), 255])


def _dark_rim(picture: Picture) -> Picture:
    broken = picture.copy()
    for rim in (np.s_[:1], np.s_[-1:], np.s_[:, :1], np.s_[:, -1:]):
        broken[rim][..., :3] = picture[rim][..., :3] // 2
    return broken


def _jpeg_blocks(picture: Picture) -> Picture:
    from PIL import Image

    stream = io.BytesIO()
    Image.fromarray(picture[..., :3]).save(stream, "JPEG", quality=75)
    return _set(picture, _COLOURS, np.asarray(Image.open(stream)))


def _grey(picture: Picture) -> Picture:
    weights = np.array((0.2126, 0.7152, 0.0722))
    return _set(picture, _COLOURS, np.rint(picture[..., :3] @ weights).astype(np.uint8)[..., None])


def _noise_of_two(picture: Picture) -> Picture:
    generator = np.random.default_rng(_SEED)
    seen = generator.random(picture.shape[:2]) < 0.01
    return _off(picture, 2 * generator.choice((-1, 1), (int(seen.sum()), 3)).astype(np.int16), seen)


def _noise_of_one(picture: Picture) -> Picture:
    return _off(picture, np.random.default_rng(_SEED).integers(-1, 2, (*picture.shape[:2], 3), np.int16), ...)


FINISHED: tuple[ImageMutant, ...] = (
    ImageMutant("upside-down", "Rows are read from the bottom up.", lambda p: p[::-1].copy()),
    ImageMutant("mirrored", "East and west are exchanged.", lambda p: p[:, ::-1].copy()),
    ImageMutant(
        "blue-for-red", "Bytes are taken in the order blue, green, red.", lambda p: p[..., [2, 1, 0, 3]]
    ),
    ImageMutant("one-pixel-along", "The picture is one pixel further to the right.", _one_pixel_along),
    ImageMutant(
        "half-a-pixel-along",
        "The picture is half a pixel further to the right, so that each pixel is the mean of two.",
        _half_a_pixel_along,
    ),
    ImageMutant(
        "magenta-square",
        "A square of 32 × 32 pixels has the colour of a texture that is missing.",
        lambda p: _set(p, _around_the_middle(p, 16), (255, 0, 255, 255)),
    ),
    ImageMutant(
        "dead-row", "One row of the picture is black.", lambda p: _set(p, np.s_[p.shape[0] // 3, :, :3], 0)
    ),
    ImageMutant("lost-row", "One row is lost, and those below it move up.", _lost_row),
    ImageMutant("dead-pixel", "One pixel has the wrong colour.", _dead_pixel),
    ImageMutant("dark-rim", "A rim one pixel wide is half as bright: a filter reads outside.", _dark_rim),
    ImageMutant(
        "five-bits",
        "Each colour has five bits, so that the sky has bands.",
        lambda p: _set(p, _COLOURS, (p[..., :3] & 0xF8) | (p[..., :3] >> 5)),
    ),
    ImageMutant("jpeg-blocks", "The picture went through a JPEG of quality 75.", _jpeg_blocks),
    ImageMutant("grey", "All three colours are the picture's luminance.", _grey),
    ImageMutant(
        "two-levels-brighter", "Every colour is two levels of 255 brighter.", lambda p: _off(p, 2, ...)
    ),
    ImageMutant("blank", "Nothing is drawn.", lambda p: _set(p, ..., _BLACK)),
    ImageMutant(
        "half-blank",
        "The upper half is not drawn.",
        lambda p: _set(p, np.s_[: p.shape[0] // 2], _BLACK),
    ),
    ImageMutant("a-row-short", "The picture is one row too small.", lambda p: p[:-1].copy()),
    ImageMutant(
        "faint-patch",
        "A patch of 24 × 24 pixels is three levels brighter.",
        lambda p: _off(p, 3, *_around_the_middle(p, 12)),
    ),
    ImageMutant(
        "specks",
        "Three pixels in a thousand are three levels brighter.",
        lambda p: _off(p, 3, np.random.default_rng(_SEED).random(p.shape[:2]) < 0.003),
    ),
    ImageMutant("noise-of-two", "One pixel in a hundred is off by two levels.", _noise_of_two),
    ImageMutant(
        "noise-of-one",
        "Nothing: levels are off by one at most, as where a sum is rounded the other way.",
        _noise_of_one,
        exempt=True,
    ),
)
"""Each of them, in the order in which they are listed."""
