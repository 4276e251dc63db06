"""What only a window has: a keyboard, a microphone, cameras. Without one, all of it is at rest."""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from playground.media.camera import camera
from playground.media.device import Device
from playground.media.microphone import microphone

KEYS = 256
"""Columns of the keyboard's texture: a key's code in JavaScript."""

MICROPHONE, CAMERA = "microphone", "camera"
_UNUSED = 120  # frames after which a device that nothing asked for is closed


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
    """The live inputs of one engine; what has a window feeds them.

    A device is opened when a picture asks for it, and closed when none did for two seconds.
    """

    keyboard: Keyboard = field(default_factory=Keyboard)
    is_live: bool = False  # there is a window, so that devices may be opened
    makers: dict[str, Callable[[int], Device]] = field(
        default_factory=lambda: {MICROPHONE: microphone, CAMERA: camera}
    )
    _devices: dict[tuple[str, int], Device] = field(default_factory=dict)
    _unused: dict[tuple[str, int], int] = field(default_factory=dict)  # frames since it was asked for

    def device(self, kind: str, number: int = 0) -> Device | None:
        """Return a device, opened if it was not; None without a window."""
        if not self.is_live:
            return None
        key = kind, number
        if key not in self._devices:
            self._devices[key] = self.makers[kind](number)
        self._unused[key] = 0
        return self._devices[key]

    def problem(self, kind: str, number: int = 0) -> str:
        """Return why nothing comes from a device, "" where something may."""
        if not self.is_live:
            return f"a {kind} is for the window only"
        device = self._devices.get((kind, number))
        return f"the {kind} gives nothing: {device.problem}" if device and device.problem else ""

    def begin_frame(self) -> bool:
        """Take what the devices delivered; return whether anything is new."""
        for key in [key for key, frames in self._unused.items() if frames >= _UNUSED]:
            self._devices.pop(key).close()
            del self._unused[key]
        self._unused = {key: frames + 1 for key, frames in self._unused.items()}
        return any([device.latch() for device in self._devices.values()])

    def close(self) -> None:
        """Close every device."""
        for device in self._devices.values():
            device.close()
        self._devices.clear()
        self._unused.clear()
