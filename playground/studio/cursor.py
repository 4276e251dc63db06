"""The picture's cursor: arrow keys move it in the mouse's place, Space and Enter press its button.

imgui has it as its mouse, so all that reads the mouse over the picture follows it: the box of values, the
traced texel and its pin, the brush, the lines that divide a picture, a shader that asks for the mouse. Over
a map whose texels are large it goes from texel to texel, else by the window's units. A mouse that moves
ends it.
"""

from __future__ import annotations

import math

from imgui_bundle import ImVec2, imgui

from playground.studio import theme
from playground.studio.draw import Area, arrows, draw_cross
from playground.studio.interface import PictureCursor
from playground.studio.session import Session
from playground.studio.theme import Theme

_MOVED = 8.0  # [the window's units] that a mouse that is only touched may move
_MIN_TEXEL = 2.0  # [the window's units] imgui's mouse has whole ones: it meets each texel of this size
_DOUBLES = 0.4  # [s] in which an arrow that is held down becomes twice as fast
_FASTEST = 16.0  # [the window's units] a step of one that is held down
_WITH_SHIFT, _WITH_CTRL = 10, 100  # texels


def feed(cursor: PictureCursor, mouse: tuple[float, float]) -> None:
    """Give imgui the cursor as its mouse, before a frame begins; ``mouse`` is where the mouse itself is."""
    io = imgui.get_io()
    if cursor.mouse is not None and math.dist(cursor.mouse, mouse) > _MOVED:
        cursor.leave()
    if cursor.is_down and not cursor.pressed:  # where it was: it may have gone on meanwhile
        io.add_mouse_button_event(0, False)
    if cursor.on or cursor.mouse is not None:
        io.add_mouse_pos_event(*(cursor.position if cursor.on else mouse))
        cursor.mouse = (cursor.mouse or mouse) if cursor.on else None
    if cursor.pressed and not cursor.is_down:
        io.add_mouse_button_event(0, True)
    cursor.is_down = cursor.pressed


def act(cursor: PictureCursor) -> None:
    """Move it by the arrows, and hold its button by Space or Enter.

    Shift and Ctrl are for longer steps: what is dragged meanwhile knows of no more than a Shift that was held
    when the button went down.
    """
    io = imgui.get_io()
    across, down = arrows()
    if across or down:
        stride = _WITH_CTRL if io.key_ctrl else _WITH_SHIFT if io.key_shift else _speed(cursor.spacing)
        cursor.step(across * stride, down * stride)
    if imgui.is_key_pressed(imgui.Key.enter, False) or imgui.is_key_pressed(imgui.Key.keypad_enter, False):
        cursor.latched = not cursor.latched
    cursor.pressed = cursor.latched or imgui.is_key_down(imgui.Key.space)
    if cursor.is_down or imgui.is_mouse_released(0):
        io.key_shift, io.key_ctrl = cursor.shift, False
    else:
        cursor.shift = io.key_shift


def _speed(spacing: float) -> int:
    """Return how many texels a step of the arrows is: the more the longer one is held down."""
    keys = imgui.Key.left_arrow, imgui.Key.right_arrow, imgui.Key.up_arrow, imgui.Key.down_arrow
    held: float = max(imgui.internal.get_key_data(key).down_duration for key in keys)
    return max(int(min(2.0 ** (held // _DOUBLES), _FASTEST / spacing)), 1)


def draw_cursor(cursor: PictureCursor, session: Session, look: Theme, area: Area) -> None:
    """Draw it over the picture, with a circle around it while its button is down."""
    cursor.area = area
    cursor.texels, cursor.spacing = _grid(session, area)
    if not cursor.on:
        return
    x, y = (math.floor(n) + 0.5 for n in cursor.position)
    draw = imgui.get_foreground_draw_list()
    draw_cross(draw, (x, y), (1.0, 1.0, 1.0), 16.0, look)
    if cursor.is_down:
        for ink, thick in ((theme.packed((0.0, 0.0, 0.0), 0.9), 5.0), (theme.packed((1.0, 1.0, 1.0)), 2.0)):
            draw.add_circle(ImVec2(x, y), 10 * look.scale, ink, 0, thick * look.scale)


def _grid(session: Session, area: Area) -> tuple[tuple[int, int], float]:
    """Return the texels that the cursor goes through, and how far apart they are in the window's units."""
    shown = session.view.map
    result = session.result_of(shown.ref) if shown is not None else None
    if result is not None:
        size: tuple[int, int] = result[0].size
        spacing = min(area[2] / size[0], area[3] / size[1])
        if spacing >= _MIN_TEXEL:
            return size, spacing
    return (max(int(area[2]), 1), max(int(area[3]), 1)), 1.0
