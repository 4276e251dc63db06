"""What a camera sees, in float64: the ray of each pixel, and the pixel of each point."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage

from playground.engine.camera import Eye


def rays(eye: Eye, size: tuple[int, int]) -> NDArray[np.float64]:
    """Return the direction of each pixel's middle from the eye, of length 1, rows from the foot."""
    ny, nx = size[1], size[0]
    y, x = (np.mgrid[0:ny, 0:nx] + 0.5) / np.array([ny, nx])[:, None, None] * 2 - 1
    clip = np.stack([x, y, np.ones_like(x), np.ones_like(x)], axis=-1)
    away = clip @ np.linalg.inv(eye.clip_from_world.astype(np.float64)).T
    ahead = away[..., :3] / away[..., 3:] - np.asarray(eye.position, np.float64)
    result: NDArray[np.float64] = ahead / np.linalg.norm(ahead, axis=-1, keepdims=True)
    return result


def on_level(eye: Eye, size: tuple[int, int]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where each pixel's ray meets height 0, and how far from the eye: infinite or negative above."""
    ahead, at = rays(eye, size), np.asarray(eye.position, np.float64)
    with np.errstate(divide="ignore"):
        length = -at[2] / ahead[..., 2]
    return at + ahead * length[..., None], length


def pixels_of(eye: Eye, points: ArrayLike, size: tuple[int, int]) -> NDArray[np.float64]:
    """Return the column and the row from the foot where points are in a picture, as numbers with parts."""
    clip = np.c_[points, np.ones(len(np.asarray(points)))] @ eye.clip_from_world.astype(np.float64).T
    result: NDArray[np.float64] = (clip[:, :2] / clip[:, 3:] + 1) / 2 * np.asarray(size)
    return result


def holes(picture: NDArray[np.uint8]) -> int:
    """Count the pixels of background, magenta, that terrain closes in on every side."""
    sky = (picture[..., 0] > 128) & (picture[..., 2] > 128)
    return int((ndimage.binary_fill_holes(~sky, np.ones((3, 3))) & sky).sum())
