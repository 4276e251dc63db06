"""Images that are painted in this process: they replace their files, and only what changed is uploaded.

A file's contents are hashed, decoded and uploaded whole, which is too much for every step of a
stroke. What is painted has a version in place of a hash, and a texture that is written to
where the brush has been.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from playground.data.content_hash import content_key
from playground.engine.textures import make_texture, split_format, write_texels, write_texture

if TYPE_CHECKING:
    import moderngl

_MAX_SIZES = 4  # textures cached


class Painted(Protocol):
    """One image."""

    @property
    def token(self) -> str:
        """A name that no other has, in no process."""

    @property
    def pixels(self) -> NDArray[np.uint8] | NDArray[np.float32]:
        """(ny, nx, channels) or (ny, nx), row 0 south: bytes that mean 0..1, or numbers as they are."""

    @property
    def version(self) -> int:
        """How often it was changed."""

    def holds(self) -> bool:
        """Return whether it is what its file holds, or newer; not where others have written the file."""

    def changed_since(self, version: int) -> tuple[slice, slice]:
        """Return the rows and columns of all that was changed since then."""


class PaintedFiles(dict[Path, Painted]):
    """What is painted, by the file that it replaces."""

    def of(self, path: Path) -> Painted | None:
        """Return what replaces a file; None where the file itself is read."""
        painted = self.get(path)
        return painted if painted is not None and painted.holds() else None

    def content(self, path: Path) -> str:
        """Return what tells a file's contents from others, or the version of what is painted over it."""
        painted = self.of(path)
        return content_key(path) if painted is None else f"painted {painted.token} {painted.version}"


class PaintedTextures:
    """A texture of each painted image, on one context."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._textures: dict[tuple[str, str], tuple[moderngl.Texture, int]] = {}  # and the version it shows
        self.uploaded = 0  # texels so far

    def texture_of(self, painted: Painted, form: str) -> moderngl.Texture:
        """Return the texture of an image in a format of as many channels, its changes written to it."""
        key, pixels = (painted.token, form), painted.pixels
        cached = self._textures.pop(key, None)
        if cached is None:
            while len(self._textures) >= _MAX_SIZES:
                self._textures.pop(next(iter(self._textures)))[0].release()
            texture = make_texture(self._ctx, (pixels.shape[1], pixels.shape[0]), form)
            write_texture(texture, _in_format(pixels, form))
            self.uploaded += pixels.shape[0] * pixels.shape[1]
        else:
            texture, version = cached
            rows, columns = painted.changed_since(version)
            part = pixels[rows, columns]
            if part.size:
                write_texels(texture, (columns.start, rows.start), _in_format(part, form))
                self.uploaded += part.shape[0] * part.shape[1]
        self._textures[key] = texture, painted.version
        return texture

    def release(self) -> None:
        """Release the textures."""
        for texture, _ in self._textures.values():
            texture.release()
        self._textures.clear()


def channels_of(painted: Painted) -> int:
    """Return how many numbers a texel of an image has."""
    return int(np.prod(painted.pixels.shape[2:], dtype=int))


def _in_format(
    pixels: NDArray[np.uint8] | NDArray[np.float32], form: str
) -> NDArray[np.uint8] | NDArray[np.float32]:
    """Return pixels as a texture's format takes them: bytes for bytes, else numbers."""
    if pixels.dtype != np.uint8 or split_format(form)[1] == "f1":
        return pixels
    return np.asarray(pixels / np.float32(255), np.float32)
