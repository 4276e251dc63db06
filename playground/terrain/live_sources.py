"""The sources that a window feeds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.media.live_inputs import KEYS, KeysNow
from playground.media.now import Now
from playground.sketch.model import Value
from playground.terrain.over_time import OUTPUT


def size_of_keys(values: Mapping[str, Value]) -> tuple[int, int]:
    """Return the texels of the keyboard's texture."""
    return KEYS, 3


def moment_of_keys(values: Mapping[str, Value], now: Now) -> KeysNow:
    """Return which keys are down, were pressed, are toggled."""
    return now.inputs.keyboard.now


def make_keys(
    values: Mapping[str, Value], size: tuple[int, int], moment: Any = None
) -> dict[str, NDArray[np.uint8]]:
    """Return the keyboard's texture; at another size each texel is repeated or left out."""
    rows, columns = np.arange(size[1]) * 3 // size[1], np.arange(size[0]) * KEYS // size[0]
    return {OUTPUT: (moment or KeysNow()).texels()[rows[:, None], columns]}
