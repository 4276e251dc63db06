"""Double clicks are judged by when the button went down, however long the frames between take."""

from __future__ import annotations

import pytest

from playground.studio.window import DOUBLE_CLICK_TIME, Clicks

SLOW = 0.4
"""[s] that a frame takes where a picture is drawn slowly."""


class PictureMouse:
    """Presses at moments; a window that asks for events between pictures of a given length."""

    def __init__(self, picture: float, presses: list[float], *, sleeps: bool = False) -> None:
        self.time = 0.0
        self.clicks = Clicks(lambda: self.time)
        self.doubles: list[bool] = []
        left = sorted(presses)
        while left:
            self.clicks.before_poll()
            if sleeps and left[0] > self.time:  # an event wakes it
                self.time = min(left[0], self.time + 1.0)
            while left and left[0] <= self.time:
                left.pop(0)
                self.clicks.press()
            self.clicks.after_poll()
            self.draw()
            self.time += picture
        for _ in presses:
            self.draw()

    def draw(self) -> None:
        """Have imgui come to one press, if there is one: as it does, one a frame."""
        longest = self.clicks.double_click_time()
        if longest != DOUBLE_CLICK_TIME:
            self.doubles.append(longest > 1.0)
            self.clicks.handled()


@pytest.mark.parametrize("picture", [1 / 60, 0.1, SLOW, 1.5])
@pytest.mark.parametrize("first", [0.001, 0.05, 0.3, 0.39, 0.6])
def test_two_clicks_a_tenth_of_a_second_apart_are_a_double_click(picture: float, first: float) -> None:
    assert PictureMouse(picture, [first, first + 0.1]).doubles == [False, True]


@pytest.mark.parametrize("picture", [1 / 60, 0.1])
def test_two_clicks_a_second_apart_are_two(picture: float) -> None:
    assert PictureMouse(picture, [0.05, 1.05]).doubles == [False, False]


def test_in_slow_frames_clicks_that_cannot_have_been_one_are_two() -> None:
    assert PictureMouse(SLOW, [0.05, 1.5]).doubles == [False, False]


@pytest.mark.parametrize(("apart", "double"), [(0.1, True), (0.29, True), (0.5, False), (0.99, False)])
def test_while_the_window_sleeps_the_moment_is_known(apart: float, double: bool) -> None:
    assert PictureMouse(0.02, [0.5, 0.5 + apart], sleeps=True).doubles == [False, double]


def test_without_a_press_imgui_keeps_its_own_time() -> None:
    assert Clicks().double_click_time() == DOUBLE_CLICK_TIME
