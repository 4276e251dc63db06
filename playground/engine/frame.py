"""A finished picture: an array that saves itself and shows itself in a notebook."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.data.image_files import encode_png, write_picture


@dataclass(frozen=True, eq=False)
class Frame:
    """A picture, display-encoded: what ``Engine.render`` gives. A notebook shows it.

    ``array`` is uint8 (height, width, 4), top row first, sRGB and straight alpha; ``numpy.asarray(frame)``
    gives it, too. ``sketch`` is the sketch's name, ``time`` the moment in seconds.

        import numpy

        frame = playground.render("l_dot_n", size=(64, 36))
        assert numpy.asarray(frame).shape == (36, 64, 4)
    """

    array: NDArray[np.uint8]  # (height, width, 4), top row first, sRGB and alpha
    sketch: str = ""
    time: float = 0.0  # [s]

    @property
    def size(self) -> tuple[int, int]:
        """Return the width and height in pixels.

        For example:

            assert playground.render("l_dot_n", size=(64, 36)).size == (64, 36)
        """
        return self.array.shape[1], self.array.shape[0]

    def save(
        self,
        path: str | Path,
        text: dict[str, str] | None = None,
        *,
        say: Callable[[str], None] = lambda _: None,
    ) -> Path:
        """Write a picture by the path's ending, whole or not at all: .png, .jpg, .webp or .tif.

        ``text`` goes into a PNG; ``say`` is called with a message where a JPEG drops alpha.
        Returns the path.

            playground.render("l_dot_n", size=(64, 36)).save("land.webp")

        Raises ``DataError`` for another ending, with the list, and where it cannot be written.
        """
        if dropped := write_picture(path, self.array, text=text or {}):
            say(dropped)
        return Path(path)

    def __array__(self, dtype: np.dtype[Any] | None = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.array, dtype=dtype, copy=copy)

    def _repr_png_(self) -> bytes:
        return encode_png(self.array)
