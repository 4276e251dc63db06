"""Simulate the craft, read its controls from keys, mouse and gamepad, and look ahead of it.

It is easy to fly, in steps of a sixtieth of a second, and never goes through the ground: it turns as it
banks, climbs as it pitches, gains speed downhill and loses it uphill; without input it levels out. It cannot
stall or roll over: the pilot is to look at the terrain. Where the ground comes too near it lifts the craft,
and turns its nose up along the slope. Matrices are around the eye, so that numbers stay small far from the
first part.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

STEP = 1 / 60
"""Seconds of a step, always the same, so a flight does not depend on the frame rate."""

SLOWEST, FASTEST = 40.0, 320.0  # [m/s] range of the throttle
DIVING = 400.0  # [m/s] never more
GRAVITY = 9.81  # [m/s²]
STEEPEST, BANKED = math.radians(55.0), math.radians(70.0)  # pitch and roll never more
CEILING = 9_000.0  # [m above height 0]
CLEARANCE = 14.0  # [m] over the ground, at least
AHEAD = 0.35  # [s] of flight ahead whose ground is sampled

_PITCHES, _ROLLS, _YAWS, _THROTTLES = 0.7, 1.7, 0.45, 0.35  # [1/s] at full deflection
_LEVELS, _RIGHTS = 0.35, 1.1  # [1/s] with which pitch and roll return without input
_EAGER = 0.55  # [1/s] with which speed follows the throttle
_QUICK = 7.0  # [1/s] with which the stick is followed: smooths jerks

Ground = Callable[[float, float], float]
"""Height of the ground at a place [m above height 0]."""


@dataclass(frozen=True, slots=True)
class Controls:
    """The pilot's input, in hundredths: whole numbers, so that a record is exact."""

    throttle: int = 0  # -100..100: less, more
    pitch: int = 0  # up
    roll: int = 0  # to the right
    yaw: int = 0  # to the right

    def within(self) -> Controls:
        """Return the controls clamped to their range."""
        return Controls(*(min(max(int(n), -100), 100) for n in self.values))

    @property
    def values(self) -> tuple[int, int, int, int]:
        """All four, as a record has them."""
        return self.throttle, self.pitch, self.roll, self.yaw


LEVEL = Controls()


@dataclass(frozen=True, slots=True)
class Craft:
    """Where the craft is and how it flies."""

    east: float = 0.0  # [m]
    north: float = 0.0  # [m]
    up: float = 0.0  # [m above height 0]
    heading: float = 0.0  # [radians clockwise from north, 0..2π]
    pitch: float = 0.0  # [radians above the horizon]
    roll: float = 0.0  # [radians, right wing down]
    speed: float = 120.0  # [m/s]
    throttle: float = 0.3  # 0..1
    stick: tuple[float, float, float] = (0.0, 0.0, 0.0)  # pitch, roll and yaw as followed so far, -1..1
    steps: int = 0  # since the start
    touched: int = 0  # steps in which the ground lifted it

    @property
    def seconds(self) -> float:
        """Time since the start [s]."""
        return self.steps * STEP


def stepped(craft: Craft, controls: Controls, ground: Ground) -> Craft:
    """Return the craft a step later."""
    controls_now = controls.within()
    share = 1 - math.exp(-_QUICK * STEP)
    stick_target = (controls_now.pitch / 100, controls_now.roll / 100, controls_now.yaw / 100)
    stick = tuple(s + (w - s) * share for s, w in zip(craft.stick, stick_target, strict=True))
    throttle = _clamped(craft.throttle + controls_now.throttle / 100 * _THROTTLES * STEP, 0.0, 1.0)

    pitch = craft.pitch + stick[0] * _PITCHES * STEP
    if controls_now.pitch == 0:
        pitch *= math.exp(-_LEVELS * STEP)
    pitch = _clamped(pitch, -STEEPEST, STEEPEST)
    roll = craft.roll + stick[1] * _ROLLS * STEP
    if controls_now.roll == 0:
        roll *= math.exp(-_RIGHTS * STEP)
    roll = _clamped(roll, -BANKED, BANKED)

    wanted_speed = SLOWEST + (FASTEST - SLOWEST) * throttle
    change = _EAGER * (wanted_speed - craft.speed) - GRAVITY * math.sin(pitch)
    speed = _clamped(craft.speed + change * STEP, SLOWEST, DIVING)

    # A banked wing pulls the craft around: a level turn has g tan(roll) / v.
    turn = GRAVITY * math.tan(roll) / speed * 1.6 + stick[2] * _YAWS
    heading = (craft.heading + turn * STEP) % math.tau
    level = speed * math.cos(pitch) * STEP
    moved = replace(
        craft,
        east=craft.east + level * math.sin(heading),
        north=craft.north + level * math.cos(heading),
        up=min(craft.up + speed * math.sin(pitch) * STEP, CEILING),
        heading=heading,
        pitch=pitch,
        roll=roll,
        speed=speed,
        throttle=throttle,
        stick=(stick[0], stick[1], stick[2]),
        steps=craft.steps + 1,
    )
    return _lifted(moved, ground)


def _lifted(craft: Craft, ground: Ground) -> Craft:
    """Return the craft above the ground, its nose up where the ground ahead rises."""
    far = craft.speed * AHEAD
    floor = ground(craft.east, craft.north) + CLEARANCE
    ahead = ground(craft.east + far * math.sin(craft.heading), craft.north + far * math.cos(craft.heading))
    rise = math.atan2(ahead + CLEARANCE - max(craft.up, floor), far)
    if craft.up >= floor and math.tan(craft.pitch) >= math.tan(min(rise, STEEPEST)):
        return craft
    if craft.up >= floor and rise <= 0.0:
        return craft  # it goes down, but to no ground near enough
    touched = craft.touched + (craft.up < floor)
    nose = craft.pitch + (min(max(rise, 0.0), STEEPEST) - craft.pitch) * (1 - math.exp(-6.0 * STEP))
    return replace(craft, up=max(craft.up, floor), pitch=max(craft.pitch, nose), touched=touched)


def _clamped(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


# ── controls ───────────────────────────────────────────────────────────────────


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


# ── the view ahead ─────────────────────────────────────────────────────────────


FIELD_OF_VIEW = 58.0  # [degrees] upright
NEAREST = 2.0  # [m]


@dataclass(frozen=True)
class Lens:
    """The view frustum, in a space whose origin is the eye: x east, y north, z up, metres."""

    clip_from_near: NDArray[np.float32]  # (4, 4), rows; acts on columns
    near_from_clip: NDArray[np.float32]
    planes: NDArray[np.float64]  # (5, 4): a place is inside where plane · (place, 1) >= 0
    pixel: float  # [radians] high

    def sees(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which boxes, given by their corners (n, 3), may be in the picture."""
        normals = self.planes[:, None, :3]
        farthest = np.where(normals >= 0, high[None], low[None])
        inside: NDArray[np.bool_] = ((farthest * normals).sum(axis=2) + self.planes[:, 3:] >= 0).all(axis=0)
        return inside


def through(
    craft: Craft, size: tuple[int, int], farthest: float, field_of_view: float = FIELD_OF_VIEW
) -> Lens:
    """Return the view ahead of a craft in a picture of that size [pixels], as far as that [m]."""
    ahead, right, up = axes(craft)
    rotation = np.eye(4)
    rotation[:3, :3] = [right, up, -ahead]
    tall = 1 / math.tan(math.radians(field_of_view) / 2)
    near, far = NEAREST, farthest
    lens = np.zeros((4, 4))
    lens[0, 0], lens[1, 1] = tall * size[1] / size[0], tall
    lens[2, 2], lens[2, 3] = (far + near) / (near - far), 2 * far * near / (near - far)
    lens[3, 2] = -1.0
    matrix = lens @ rotation
    rows = [matrix[3] + matrix[0], matrix[3] - matrix[0], matrix[3] + matrix[1], matrix[3] - matrix[1]]
    rows.append(matrix[3] + matrix[2])
    pixel = math.radians(field_of_view) / size[1]
    inverse = np.linalg.inv(matrix)
    with np.errstate(under="ignore"):  # a right angle's cosine is 0, or nearly
        return Lens(matrix.astype(np.float32), inverse.astype(np.float32), np.array(rows), pixel)


def axes(craft: Craft) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return the unit vectors ahead, to the right and up of a craft."""
    ch, sh = math.cos(craft.heading), math.sin(craft.heading)
    cp, sp = math.cos(craft.pitch), math.sin(craft.pitch)
    ahead = np.array([sh * cp, ch * cp, sp])
    level = np.array([ch, -sh, 0.0])
    above = np.cross(level, ahead)
    cr, sr = math.cos(craft.roll), math.sin(craft.roll)
    # Right wing down: the craft's right goes below the horizon.
    return ahead, cr * level - sr * above, sr * level + cr * above


def turned(before: Craft, after: Craft) -> float:
    """Return the angle between two attitudes [radians]."""
    cosine = (np.sum(np.array(axes(before)) * np.array(axes(after))) - 1) / 2
    return math.acos(min(max(float(cosine), -1.0), 1.0))
