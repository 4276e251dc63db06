"""The sources that a window feeds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.media import analysis
from playground.media.camera import Seen
from playground.media.film import as_pixels
from playground.media.live_inputs import CAMERA, KEYS, MICROPHONE, KeysNow, LiveInputs
from playground.media.microphone import Heard
from playground.media.now import Now
from playground.sketch.model import Value
from playground.terrain.over_time import OUTPUT, shown_of, size_of_content


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


def size_of_microphone(values: Mapping[str, Value]) -> tuple[int, int]:
    """Return the texels of what is shown of a microphone."""
    return size_of_content(_whole(values, "content"), 1)


def moment_of_microphone(values: Mapping[str, Value], now: Now) -> Heard | None:
    """Return what was heard; None for nothing."""
    device = now.inputs.device(MICROPHONE)
    return device.now if device else None


def make_microphone(
    values: Mapping[str, Value], size: tuple[int, int], moment: Any = None
) -> dict[str, NDArray[np.uint8]]:
    """Return what is shown of a microphone; of nothing, silence."""
    heard = moment.samples if moment else np.zeros((1, analysis.SPAN), np.float32)
    return {OUTPUT: shown_of(heard, _whole(values, "content"), size)}


def lack_of_microphone(values: Mapping[str, Value], inputs: LiveInputs) -> str:
    """Return why it is silent, if it is."""
    problem = inputs.problem(MICROPHONE)
    return f"{problem}; it is silent here" if problem else ""


def size_of_camera(values: Mapping[str, Value]) -> tuple[int, int]:
    """Return the texels of a camera's picture."""
    return 640, 480


def moment_of_camera(values: Mapping[str, Value], now: Now) -> Seen | None:
    """Return the camera's picture; None for none."""
    device = now.inputs.device(CAMERA, _whole(values, "device"))
    return device.now if device else None


def make_camera(
    values: Mapping[str, Value], size: tuple[int, int], moment: Any = None
) -> dict[str, NDArray[np.uint8]]:
    """Return the camera's picture; of none, black."""
    if moment is None:
        black = np.zeros((size[1], size[0], 4), np.uint8)
        black[..., 3] = 255
        return {OUTPUT: black}
    pixels = as_pixels(moment.frame, size)
    return {OUTPUT: pixels[:, ::-1] if values["mirror"] else pixels}


def lack_of_camera(values: Mapping[str, Value], inputs: LiveInputs) -> str:
    """Return why it is black, if it is."""
    problem = inputs.problem(CAMERA, _whole(values, "device"))
    return f"{problem}; it is black here" if problem else ""


def _whole(values: Mapping[str, Value], name: str) -> int:
    value = values[name]
    assert isinstance(value, int)  # the kernel's file says so
    return value
