"""A finished picture: an array that saves itself and shows itself in a notebook."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.images.files import encode_png, write_png


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

    def save(self, path: str | Path, text: dict[str, str] | None = None) -> Path:
        """Write a PNG, whole or not at all; raise ``DataError`` where it cannot be written."""
        write_png(path, self.array, text=text or {})
        return Path(path)

    def _repr_png_(self) -> bytes:
        return encode_png(self.array)
