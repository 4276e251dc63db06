"""The craft: attitudes within bounds, speed by the throttle, turns by the bank, never through the ground."""

from __future__ import annotations

import math

import numpy as np
import pytest

from playground.flight import craft as model
from playground.flight.craft import CLEARANCE, STEP, Controls, Craft, axes, stepped, through


def flown(craft, controls, seconds, ground=lambda east, north: -1e9):
    for _ in range(round(seconds / STEP)):
        craft = stepped(craft, controls, ground)
    return craft


HIGH = Craft(up=3000.0)


@pytest.mark.parametrize("throttle", [0.0, 0.5, 1.0])
def test_in_level_flight_the_throttle_holds_a_speed(throttle):
    craft = flown(Craft(up=3000.0, throttle=throttle, speed=200.0), Controls(), 30)
    expected = model.SLOWEST + (model.FASTEST - model.SLOWEST) * throttle
    assert craft.speed == pytest.approx(expected, abs=0.5)
    assert craft.up == pytest.approx(3000.0) and craft.east == pytest.approx(0.0)


def test_descent_is_faster_than_climb_and_within_speed_bounds():
    down = flown(Craft(up=8000.0), Controls(pitch=-100), 8)
    up = flown(Craft(up=2000.0), Controls(pitch=100), 8)
    level = flown(HIGH, Controls(), 8)
    assert down.speed > level.speed + 10 > up.speed + 20
    fast = flown(Craft(up=8000.0, throttle=1.0), Controls(pitch=-100), 60)
    slow = flown(Craft(up=2000.0, throttle=0.0), Controls(pitch=100), 60)
    assert fast.speed <= model.DIVING and slow.speed == model.SLOWEST


def test_any_hands_keep_the_attitude_within_its_bounds():
    rng = np.random.default_rng(4)
    craft = HIGH
    for _ in range(200):
        craft = flown(craft, Controls(*(int(n) for n in rng.integers(-300, 300, 4))), 0.5)
        assert abs(craft.pitch) <= model.STEEPEST and abs(craft.roll) <= model.BANKED
        assert 0 <= craft.heading < math.tau and 0 <= craft.throttle <= 1
        assert model.SLOWEST <= craft.speed <= model.DIVING and craft.up <= model.CEILING


def test_let_go_it_levels_out():
    banked = flown(HIGH, Controls(roll=100, pitch=60), 2)
    assert banked.roll > 0.8 and banked.pitch > 0.3
    level = flown(banked, Controls(), 12)
    assert abs(level.roll) < 0.01 and abs(level.pitch) < 0.02


def test_right_is_right():
    """A bank to the right turns from north to east; so does the rudder; the mirror image to the west."""
    for hands in (Controls(roll=100), Controls(yaw=100)):
        right = flown(HIGH, hands, 1.5)
        left = flown(HIGH, Controls(0, 0, -hands.roll, -hands.yaw), 1.5)
        assert 0 < right.heading < math.pi and right.east > 0
        assert left.east == pytest.approx(-right.east) and left.north == pytest.approx(right.north)


def test_a_turn_is_a_circle():
    """At a held bank the way's curvature is g tan(bank) times 1.6 over the square of the speed."""
    craft = Craft(up=3000.0, roll=0.5, speed=120.0, throttle=(120.0 - model.SLOWEST) / 280.0)
    after = stepped(craft, Controls(), lambda east, north: -1e9)
    turned = 1.6 * 9.81 * math.tan(0.5 * math.exp(-1.1 * STEP)) / 120.0 * STEP
    assert after.heading == pytest.approx(turned, rel=1e-3)


def test_the_same_hands_make_the_same_flight_to_the_last_bit():
    item = flown(HIGH, Controls(20, 31, -40, 5), 20)
    assert item == flown(HIGH, Controls(20, 31, -40, 5), 20) and item.steps == 1200


@pytest.mark.parametrize("pitch", [-100, 0])
@pytest.mark.parametrize("steepness", [0.0, 0.5, 3.0])
def test_the_ground_is_never_passed_through(pitch, steepness):
    def ground(east, north):
        return steepness * 400 * (1 + math.sin(north / 500) * math.cos(east / 700)) + 100

    craft = Craft(up=1400.0 * max(steepness, 0.5), throttle=1.0, speed=300.0)
    for _ in range(60 * 40):
        craft = stepped(craft, Controls(50, pitch, 10, 0), ground)
        assert craft.up >= ground(craft.east, craft.north) + CLEARANCE - 1e-9
    assert pitch == 0 or craft.touched > 0


def test_over_level_ground_it_glides_on():
    craft = flown(Craft(up=30.0, pitch=-0.5), Controls(), 5, lambda east, north: 0.0)
    assert craft.up >= CLEARANCE and craft.pitch > -0.15 and craft.north > 300


def test_the_eye_looks_where_the_craft_flies():
    craft = Craft(heading=math.radians(90), pitch=0.2, roll=0.3)
    ahead, right, up = axes(craft)
    np.testing.assert_allclose(ahead, [math.cos(0.2), 0, math.sin(0.2)], atol=1e-12)
    np.testing.assert_allclose(
        np.array([ahead, right, up]) @ np.array([ahead, right, up]).T, np.eye(3), atol=1e-12
    )
    assert right[1] < 0 and right[2] < 0, "flying east, right is south; banked right, it points down"
    moved = stepped(Craft(up=3000.0, heading=1.0, pitch=0.0), Controls(), lambda e, n: -1e9)
    way = np.array([moved.east, moved.north, moved.up - 3000.0])
    np.testing.assert_allclose(way / np.linalg.norm(way), axes(moved)[0], atol=1e-3)


def test_what_is_straight_ahead_is_in_the_middle_of_the_picture():
    craft = Craft(heading=2.0, pitch=-0.3, roll=0.7)
    lens = through(craft, (640, 360), 20_000.0)
    ahead, right, up = axes(craft)
    for position, expected in ((ahead, (0, 0)), (ahead + 0.1 * right, (1, 0)), (ahead + 0.1 * up, (0, 1))):
        x, y, _, w = lens.clip_from_near @ np.array([*(position * 1000), 1.0])
        elements = np.array([x / w, y / w])
        np.testing.assert_allclose(np.sign(np.where(abs(elements) < 1e-5, 0, elements)), expected)


def test_boxes_out_of_view_are_culled_and_no_others():
    rng = np.random.default_rng(8)
    lens = through(Craft(heading=0.7, pitch=-0.2, roll=0.4), (640, 360), 20_000.0)
    low = rng.uniform(-9000, 9000, (500, 3)) * [1, 1, 0.1]
    high = low + rng.uniform(100, 2000, (500, 3))
    seen = lens.sees(low, high)
    share = rng.uniform(0, 1, (400, 3))
    inside = np.zeros(500, bool)
    for index in range(500):
        places = low[index] + share * (high[index] - low[index])
        clip = np.column_stack([places, np.ones(400)]) @ lens.clip_from_near.T.astype(float)
        inside[index] = (np.abs(clip[:, :2]) <= clip[:, 3:]).all(axis=1).any()
    assert not (inside & ~seen).any(), "a box that is seen is drawn"
    assert 0.05 < seen.mean() < 0.5 and (seen & ~inside).sum() < 0.1 * 500
