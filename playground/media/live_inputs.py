"""What only a window has: a keyboard. Without one, all of it is at rest."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

KEYS = 256
"""Columns of the keyboard's texture: a key's code in JavaScript."""


class KeysNow(NamedTuple):
    """The keys of one frame, by their codes in JavaScript, in order."""

    down: tuple[int, ...] = ()
    pressed: tuple[int, ...] = ()  # in this very frame
    toggled: tuple[int, ...] = ()  # pressed an odd number of times

    def texels(self) -> NDArray[np.uint8]:
        """Return (3, 256) bytes: what is down, what was pressed, what is toggled; 255 or 0."""
        found = np.zeros((3, KEYS), np.uint8)
        for row, codes in enumerate(self):
            found[row, list(codes)] = 255
        return found


class Keyboard:
    """The keys that a picture gets, frame by frame."""

    def __init__(self) -> None:
        self.now = KeysNow()

    def hold(self, codes: Collection[int]) -> bool:
        """Begin a frame in which these keys are down; return whether anything differs from the last one."""
        before = self.now
        down = {code for code in codes if 0 <= code < KEYS}
        pressed = down - set(before.down)
        toggled = set(before.toggled) ^ pressed
        self.now = KeysNow(tuple(sorted(down)), tuple(sorted(pressed)), tuple(sorted(toggled)))
        return self.now != before


@dataclass
class LiveInputs:
    """The live inputs of one engine; what has a window feeds them."""

    keyboard: Keyboard = field(default_factory=Keyboard)
