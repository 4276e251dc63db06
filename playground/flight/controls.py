"""Convert input from keys, a mouse or a gamepad to the controls of a craft."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence

from playground.flight.craft import Controls

REST = 0.14
"""Of a gamepad's stick: nearer to its middle it is at rest."""
NOTCH = 10
"""Steps of full throttle that a notch of the wheel is: six hundredths of all there is."""
FULL = 0.3
"""Of the window's height: so far from where the button went down, the mouse is a full stick."""


_AXES = (("faster", "slower"), ("up", "down"), ("right", "left"), ("yaw_right", "yaw_left"))


def by_keys(held: Collection[str]) -> Controls:
    """Return the controls of the keys that are held, by name: full or nothing; "up" is nose up."""
    return Controls(*(100 * ((more in held) - (less in held)) for more, less in _AXES))


def by_mouse(across: float, down: float, height: float) -> Controls:
    """Return the controls for a drag of the mouse [pixels] since its button went down; down is nose up."""
    if height <= 0:
        return Controls()
    full = FULL * height
    return Controls(0, round(100 * down / full), round(100 * across / full), 0).within()


class Wheel:
    """The mouse wheel as a throttle: a notch is held for ``NOTCH`` steps."""

    def __init__(self) -> None:
        self._owed = 0.0  # steps, with the sign of their way

    def scroll(self, notches: float) -> None:
        """Add notches; one in the other direction cancels what is left."""
        if notches * self._owed < 0:
            self._owed = 0.0
        self._owed += notches * NOTCH

    def next(self) -> Controls:
        """Return the controls of the next step."""
        if abs(self._owed) < 1:
            self._owed = 0.0
            return Controls()
        way = 1 if self._owed > 0 else -1
        self._owed -= way
        return Controls(throttle=100 * way)


def by_gamepad(axes: Sequence[float]) -> Controls:
    """Return the controls of a gamepad.

    ``axes`` as GLFW's standard mapping has them: left stick across and down, right stick
    across and down, left and right trigger, all -1..1. The left stick back is nose up; the
    right trigger is faster, the left one slower.
    """
    if len(axes) < 6:
        return Controls()
    across, down, yaw = (_away(axes[n]) for n in (0, 1, 2))
    faster, slower = ((1 + axes[n]) / 2 for n in (5, 4))
    throttle = _away(faster - slower)
    return Controls(*(round(100 * n) for n in (throttle, down, across, yaw))).within()


def together(*controls: Controls) -> Controls:
    """Return the sum of several controls, within their range."""
    sums = (sum(axis) for axis in zip(*(h.values for h in controls), strict=True))
    return Controls(*sums).within()


def _away(value: float) -> float:
    """Return a stick's way past its rest, -1..1; fine near the middle."""
    size = max(abs(value) - REST, 0.0) / (1 - REST)
    return math.copysign(size * math.sqrt(min(size, 1.0)), value)
