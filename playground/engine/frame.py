"""A finished picture: an array that saves itself and shows itself in a notebook."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.images.files import encode_png
from playground.images.image_formats import write_picture


@dataclass(frozen=True, eq=False)
class Frame:
    """A picture, display-encoded."""

    array: NDArray[np.uint8]  # (height, width, 4), top row first, sRGB and alpha
    sketch: str = ""
    time: float = 0.0  # [s]

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self.array.shape[1], self.array.shape[0]

    def save(
        self,
        path: str | Path,
        text: dict[str, str] | None = None,
        *,
        say: Callable[[str], None] = lambda _: None,
    ) -> Path:
        """Write a picture by the path's ending, whole or not at all: .png, .jpg, .webp or .tif.

        ``text`` goes into a PNG; ``say`` is called with a sentence where a JPEG drops alpha.
        Raises ``DataError`` for another ending, and where it cannot be written.
        """
        if dropped := write_picture(path, self.array, text=text or {}):
            say(dropped)
        return Path(path)

    def _repr_png_(self) -> bytes:
        return encode_png(self.array)
