"""Draw on the picture with the mouse, and point at it with a spot of light."""

from __future__ import annotations

from dataclasses import dataclass

from imgui_bundle import ImVec2, imgui

from playground.course.talk.presenter import Point, Presenter
from playground.live.draw import Area

_INK = 0xFF3CC8FF  # a warm yellow, as imgui packs it
_EDGE = 0xB0101010
_SPOT = 0xFF2020FF


@dataclass
class Pen:
    """The pen of one window."""

    down: bool = False  # it draws

    def act(self, presenter: Presenter, area: Area) -> None:
        """Draw while the left button is down."""
        if not imgui.is_mouse_down(0):
            self.down = False
            return
        position = _place(area)
        if imgui.is_mouse_clicked(0):
            self.down = all(0.0 <= side <= 1.0 for side in position)
            if self.down:
                presenter.press(position)
        elif self.down:
            presenter.draw(position)

    def draw(self, presenter: Presenter, area: Area, scale: float) -> None:
        """Draw the strokes of the beat, which are as large as the picture in ``area`` makes them."""
        paint = imgui.get_background_draw_list()
        for stroke in presenter.strokes.get(presenter.at, []):
            points: list[ImVec2 | tuple[int | float, int | float] | list[int | float]] = [
                ImVec2(area[0] + x * area[2], area[1] + y * area[3]) for x, y in stroke
            ]
            if len(points) == 1:
                paint.add_circle_filled(points[0], 6 * scale, _EDGE)
                paint.add_circle_filled(points[0], 4.5 * scale, _INK)
                continue
            paint.add_polyline(points, _EDGE, 9 * scale, 0)
            paint.add_polyline(points, _INK, 6 * scale, 0)

    def draw_spot(self, scale: float) -> None:
        """Draw the spot at the mouse."""
        position, paint = imgui.get_mouse_pos(), imgui.get_foreground_draw_list()
        for radius, alpha in ((30.0, 0x30), (20.0, 0x60), (12.0, 0xFF)):
            paint.add_circle_filled(position, radius * scale, (_SPOT & 0x00FFFFFF) | alpha << 24)
        paint.add_circle_filled(position, 5 * scale, 0xFFE0E0FF)


def _place(area: Area) -> Point:
    mouse = imgui.get_mouse_pos()
    return (mouse.x - area[0]) / area[2], (mouse.y - area[1]) / area[3]
