"""What keys, a mouse and a gamepad ask of a craft; no window is needed."""

from __future__ import annotations

import pytest

from playground.flight.craft import (
    FULL,
    NOTCH,
    REST,
    Controls,
    Wheel,
    by_gamepad,
    by_keys,
    by_mouse,
    together,
)
from playground.flight.window import clock, help_rows
from playground.studio.language import choose_language


def test_keys_command_full_deflection_and_opposites_cancel():
    assert by_keys(()) == Controls()
    assert by_keys({"up", "right"}) == Controls(0, 100, 100, 0)
    assert by_keys({"up", "down", "yaw_left", "faster"}) == Controls(100, 0, 0, -100)


def test_the_mouse_is_a_stick_around_where_its_button_went_down():
    assert by_mouse(0, 0, 400) == Controls()
    full = FULL * 400
    assert by_mouse(full, full / 2, 400) == Controls(0, 50, 100, 0)
    assert by_mouse(-9 * full, 0, 400) == Controls(0, 0, -100, 0)
    assert by_mouse(10, 10, 0) == Controls(), "a window without height"


def test_wheel_notch_is_timed_throttle_and_reverse_cancels_it():
    wheel = Wheel()
    wheel.scroll(1.0)
    result = [wheel.next().throttle for _ in range(NOTCH + 2)]
    assert result == [100] * NOTCH + [0, 0]
    wheel.scroll(3.0)
    wheel.scroll(-1.0)
    assert [wheel.next().throttle for _ in range(NOTCH + 1)] == [-100] * NOTCH + [0]


def test_gamepad_at_rest_is_neutral_and_full_throw_is_maximum():
    rest = [REST, -REST / 2, 0.01, 0.0, -1.0, -1.0]
    assert by_gamepad(rest) == Controls()
    assert by_gamepad([1.0, 1.0, -1.0, 0.0, -1.0, 1.0]) == Controls(100, 100, 100, -100)
    assert by_gamepad([-1.0, -1.0, 0.0, 0.0, 1.0, -1.0]) == Controls(-100, -100, -100, 0)
    assert by_gamepad([]) == Controls()


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_gamepad_s_stick_is_even_and_rises(axis):
    result = []
    for way in (-1.0, -0.6, -0.3, 0.0, 0.3, 0.6, 1.0):
        axes = [0.0, 0.0, 0.0, 0.0, -1.0, -1.0]
        axes[axis] = way
        result.append(sum(by_gamepad(axes).values))
    assert result == sorted(result) and result == [-n for n in result[::-1]]


def test_several_hands_add_up_and_stay_within_bounds():
    assert together(Controls(0, 60, 0, 0), Controls(0, 60, -30, 0)) == Controls(0, 100, -30, 0)
    assert together(Controls()) == Controls()


def test_the_clock_goes_from_midnight_to_midnight():
    assert [clock(h) for h in (0.0, 9.5, 23.999)] == ["00:00", "09:30", "00:00"]


def test_the_help_is_in_the_window_s_language():
    english = dict(help_rows())
    choose_language("fr")
    try:
        french = dict(help_rows())
    finally:
        choose_language("en")
    assert english["Ctrl+Q"] == "quit, while paused" and french["Ctrl+Q"] == "quitter, pendant la pause"
    assert len(french) == len(english) and not {*english.values()} & {*french.values()}
