"""Where the picture, the code beside it and the strip below them are.

The edges between them are dragged, or moved by keys, and remembered.

The panel of parameters is at the left, over the window's whole height. What is left of the window is the
picture, the code pane at its right, and below both the strip, whose tabs are the passes, the versions, the
errors. In a window narrower than ``NARROW`` the code takes the picture's place while it is open, so that
neither is too small to read.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from imgui_bundle import ImVec2, imgui

from playground.studio import theme
from playground.studio.draw import QUIET, Area, window
from playground.studio.interface import Panes, Tab
from playground.studio.language import tr
from playground.studio.theme import Theme

NARROW = 1000.0
"""[units of scale 1] of a window's width."""

_GRIP = 6.0  # [units of scale 1] that the mouse grasps of an edge
_CODE = (0.2, 0.45, 0.8)  # fraction of the width: least, as delivered, most
_STRIP = (0.15, 0.34, 0.7)  # of the height
_STEP = 0.02  # fraction by which a key moves an edge
_PANE = QUIET | imgui.WindowFlags_.no_title_bar | imgui.WindowFlags_.no_move | imgui.WindowFlags_.no_resize
_PANE |= imgui.WindowFlags_.no_collapse | imgui.WindowFlags_.no_bring_to_front_on_focus
_PANE |= imgui.WindowFlags_.no_focus_on_appearing


@dataclass(frozen=True)
class Places:
    """Where things are in a frame, in the window's units; None for what is closed."""

    picture: Area
    code: Area | None
    strip: Area | None


class PaneLayout:
    """Places and draws the panes of one window; the mouse drags their edges."""

    def __init__(self, panes: Panes) -> None:
        self._panes = panes
        self._grasped = ""  # the edge that is dragged
        self._dragged = 0.0  # to where, as a fraction

    def place(self, left: float, tabs: Sequence[Tab], look: Theme) -> Places:
        """Return where things are; ``left``: what panels take of the window's left side."""
        room = imgui.get_main_viewport().size
        self._panes.is_narrow = self._is_narrow()
        wide, high = max(room.x - left, 1.0), room.y
        for pane, name, bounds in (("code pane", "code width", _CODE), ("strip", "strip height", _STRIP)):
            steps = self._panes.take_steps(pane)
            if steps and not (pane == "code pane" and self._is_narrow()):
                fraction = self._fraction(name, bounds) + steps * _STEP
                self._panes.remember(name, _within(fraction, bounds))
        strip = (
            round(high * self._fraction("strip height", _STRIP))
            if self._panes.is_open("strip", narrow=self._is_narrow()) and tabs
            else 0
        )
        upper = max(high - strip, 1.0)
        code: Area | None = None
        picture = (left, 0.0, wide, upper)
        if not self._panes.has_code:
            pass
        elif self._panes.is_open("code", narrow=self._is_narrow()) and self._is_narrow():
            code = picture
        elif self._panes.is_open("code", narrow=self._is_narrow()):
            width = round(wide * self._fraction("code width", _CODE))
            code = (left + wide - width, 0.0, float(width), upper)
            picture = (left, 0.0, max(wide - width, 1.0), upper)
        below = (left, upper, wide, float(strip)) if strip else None
        self._drag(left, wide, high, Places(picture, code, below), look)
        return Places(picture, code, below)

    def draw_code(self, places: Places, draw: Callable[[], None]) -> None:
        """Draw the code pane where it is open; ``draw`` draws what is in it."""
        if places.code is not None:
            draw_pane("code pane", places.code, draw)

    def draw_strip(self, places: Places, tabs: Sequence[Tab], look: Theme) -> None:
        """Draw the strip where it is open."""
        if places.strip is not None and tabs:
            draw_pane("strip", places.strip, lambda: self._draw_tabs(tabs, look))

    def _draw_tabs(self, tabs: Sequence[Tab], look: Theme) -> None:
        if not imgui.begin_tab_bar("tabs"):
            return
        for tab in tabs:
            flags = imgui.TabItemFlags_.set_selected if self._panes.selects == tab.name else 0
            badge = tab.badge()
            title = f"{tr(tab.title)} {badge}".rstrip()
            if imgui.begin_tab_item(f"{title}###{tab.name}", None, flags)[0]:
                self._panes.tab = tab.name
                tab.draw(look)
                imgui.end_tab_item()
        self._panes.selects = ""
        imgui.end_tab_bar()

    # ── edges ────────────────────────────────────────────────────────────────

    def _drag(self, left: float, wide: float, high: float, places: Places, look: Theme) -> None:
        """Let the mouse drag the edges between the panes."""
        mouse, grip = imgui.get_mouse_pos(), _GRIP * look.scale / 2
        edges: dict[str, bool] = {}
        before = {"code width": self._fraction("code width", _CODE)}
        before["strip height"] = self._fraction("strip height", _STRIP)
        if places.code is not None and not self._is_narrow():
            on = abs(mouse.x - places.code[0]) <= grip and mouse.y < places.code[3]
            edges["code width"] = on
        if places.strip is not None:
            edges["strip height"] = abs(mouse.y - places.strip[1]) <= grip and mouse.x > left
        if imgui.is_mouse_clicked(0) and not imgui.is_popup_open("", imgui.PopupFlags_.any_popup):
            self._grasped = next((name for name, on in edges.items() if on), "")
            self._dragged = before.get(self._grasped, 0.0)
        elif not imgui.is_mouse_down(0) and self._grasped:
            self._panes.remember(self._grasped, self._dragged)
            self._grasped = ""
        edge = self._grasped or next((name for name, on in edges.items() if on), "")
        if edge:
            upright = edge == "code width"
            imgui.set_mouse_cursor(imgui.MouseCursor_.resize_ew if upright else imgui.MouseCursor_.resize_ns)
        if self._grasped:
            imgui.set_next_frame_want_capture_mouse(True)
        if self._grasped == "code width":
            self._dragged = _within((left + wide - mouse.x) / wide, _CODE)
        elif self._grasped == "strip height":
            self._dragged = _within((high - mouse.y) / high, _STRIP)

    def _fraction(self, name: str, bounds: tuple[float, float, float]) -> float:
        if name == self._grasped:
            return self._dragged
        return _within(self._panes.fraction(name, bounds[1]), bounds)

    def _is_narrow(self) -> bool:
        return imgui.get_main_viewport().size.x < NARROW * imgui.get_style().font_scale_dpi


def draw_pane(name: str, area: Area, draw: Callable[[], None]) -> None:
    """Draw a window that stays in its place; ``draw`` draws what is in it."""
    imgui.set_next_window_pos(ImVec2(*area[:2]))
    imgui.set_next_window_size(ImVec2(*area[2:]))
    with window(name, _PANE, ground=theme.colour(theme.palette.ground)):
        draw()


def _within(value: float, bounds: tuple[float, float, float]) -> float:
    return min(max(value, bounds[0]), bounds[2])
