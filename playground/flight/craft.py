"""Simulate the craft: easy to fly, in steps of a sixtieth of a second, never through the ground.

It turns as it banks, climbs as it pitches, gains speed downhill and loses it uphill; without
input it levels out. It cannot stall or roll over: the pilot is to look at the terrain.
Where the ground comes too near it lifts the craft, and turns its nose up along the slope.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

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
