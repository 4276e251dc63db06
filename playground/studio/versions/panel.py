"""Draw the versions as a filmstrip: a click looks, a double click goes back, the right button has more."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import TYPE_CHECKING

import moderngl
import numpy as np
from imgui_bundle import ImVec2, imgui

from playground.errors import PlaygroundError
from playground.studio import theme
from playground.studio.draw import button, explain, fitting, next_in_row, pushed_id
from playground.studio.interface import Tab
from playground.studio.language import counted, tr
from playground.studio.start.thumbnails import CELL, read_picture
from playground.studio.theme import Theme
from playground.studio.versions.store import Version
from playground.studio.versions.versions import Versions, title_of

if TYPE_CHECKING:
    from collections.abc import Iterable

_CAPTION = 22.0  # [units of scale 1] below a picture
_LEAST, _MOST = 54.0, 130.0  # that a picture is high
_NAME_LETTERS = 10  # that the field for a name is wide


class VersionsPanel:
    """The tab's drawing: its pictures, and the name that is typed."""

    def __init__(self, ctx: moderngl.Context, versions: Versions) -> None:
        self.versions = versions
        self._ctx = ctx
        self._textures: dict[tuple[str, float], moderngl.Texture | None] = {}  # by key, and when it was kept
        self._typed = ""
        self._typed_for = ""  # the version that the name is of
        self._is_double = False  # the mouse was pressed the second time
        self._gets_keys = False  # the field for a name, in the next frame
        self._count = -1  # of the versions that were drawn last

    @property
    def tab(self) -> Tab:
        """The tab of the strip."""
        return Tab("versions", "Versions", self.draw, lambda: f"({len(self.versions.items)})")

    def draw(self, look: Theme) -> None:
        """Draw the tab's contents, and do what is clicked on."""
        versions, items = self.versions, self.versions.items
        if imgui.is_mouse_clicked(0):
            self._is_double = imgui.is_mouse_double_clicked(0)  # its release is no click of its own
        self._draw_buttons(versions.chosen, look)
        if not items:
            with_room = imgui.get_content_region_avail().x
            imgui.push_text_wrap_pos(imgui.get_cursor_pos_x() + with_room)
            imgui.text_disabled(tr("Each save that draws is kept here, with its values and its view."))
            imgui.pop_text_wrap_pos()
            return
        bar = imgui.WindowFlags_.horizontal_scrollbar
        imgui.begin_child("film", ImVec2(0, 0), imgui.ChildFlags_.nav_flattened, bar)
        room = imgui.get_content_region_avail().y - imgui.get_style().scrollbar_size
        high = min(max(room - _CAPTION * look.scale, _LEAST * look.scale), _MOST * look.scale)
        size = ImVec2(high * CELL[0] / CELL[1], high + _CAPTION * look.scale)
        gap = 8 * look.scale
        left, right = imgui.get_scroll_x() - size.x, imgui.get_scroll_x() + imgui.get_window_width()
        for number, version in enumerate(items):
            if number:
                imgui.same_line(0, gap)
            if left <= number * (size.x + gap) <= right:
                self._draw_version(version, size, look)
            else:
                imgui.dummy(size)
        if len(items) != self._count:  # a new one comes in sight
            self._count = len(items)
            imgui.set_scroll_x(len(items) * (size.x + gap))
        imgui.end_child()
        self._forget((version.key, version.at) for version in items)

    def release(self) -> None:
        """Release the pictures; they are read again when they are drawn."""
        self._forget(())

    def rebuild(self, ctx: moderngl.Context) -> None:
        """Go on in another context: the one before is lost."""
        self._ctx, self._textures = ctx, {}

    def _forget(self, kept: Iterable[tuple[str, float]]) -> None:
        for key in self._textures.keys() - set(kept):
            texture = self._textures.pop(key)
            if texture is not None:
                texture.release()

    # ── the line of buttons ──────────────────────────────────────────────────

    def _draw_buttons(self, chosen: Version | None, look: Theme) -> None:
        versions = self.versions
        if self._typed_for != versions.selected:
            self._typed_for, self._typed = versions.selected, chosen.name if chosen is not None else ""
        imgui.set_next_item_width(_NAME_LETTERS * imgui.get_font_size())
        enter = imgui.InputTextFlags_.enter_returns_true
        entered, self._typed = imgui.input_text_with_hint("##name", tr("name"), self._typed, enter)
        if self._gets_keys:
            imgui.internal.activate_item_by_id(imgui.get_item_id())
            self._gets_keys = False
        imgui.same_line()
        if chosen is None:
            note = tr("Keep the present state under this name, for ever")
            if button(f"{tr('Keep')}###keep", note, enabled=bool(self._typed.strip())) or (
                entered and self._typed.strip()
            ):
                if versions.keep(self._typed):
                    self._typed = ""
            imgui.same_line()
            imgui.text_disabled(fitting(tr("click: look   hold: compare   double click: go back"), _left()))
            return
        named = bool(self._typed.strip())
        note = tr("One with a name is kept for ever; without, until there are too many")
        label = tr("Name") if named or not chosen.name else tr("Take the name away")
        if button(f"{label}###rename", note, enabled=self._typed.strip() != chosen.name) or entered:
            versions.rename(chosen, self._typed)
        for label, key, note, act in (
            (
                "Go back",
                "back to",
                "Write its texts and values, as one step; what is there now is kept",
                versions.go_back,
            ),
            ("Compare A/B", "compare", "It becomes A; the present picture is B", versions.compare),
            ("As a new sketch", "as new", "A copy in a folder of its own, opened", versions.as_new_sketch),
            ("Remove", "remove", "Take it from the list", versions.remove),
        ):
            next_in_row(tr(label))
            if button(f"{tr(label)}###{key}", tr(note)):
                act(chosen)
        next_in_row(tr("To the present"))
        if button(f"{tr('To the present')}###present", tr("End looking: what is worked on is shown again")):
            self.versions.leave()
        if versions.is_looking:
            text = tr("only looked at")
            next_in_row(text)
            imgui.text_colored(theme.colour(theme.palette.warm), text)
            imgui.set_item_tooltip(tr("The files are as they were; nothing is written"))

    # ── one version ──────────────────────────────────────────────────────────

    def _draw_version(self, version: Version, size: ImVec2, look: Theme) -> None:
        versions = self.versions
        corner, draw = imgui.get_cursor_screen_pos(), imgui.get_window_draw_list()
        clicked = imgui.invisible_button(f"version {version.key}", size, imgui.ButtonFlags_.enable_nav)
        hovered = imgui.is_item_hovered()
        lit = hovered or imgui.is_item_focused()
        if imgui.is_item_active() and imgui.is_mouse_down(0):
            versions.hold(version)
        elif imgui.is_item_deactivated():
            clicked = not versions.let_go() and clicked
        if imgui.is_item_hovered(imgui.HoveredFlags_.for_tooltip):
            explain(title_of(version), _note(version))
        far, radius = ImVec2(corner.x + size.x, corner.y + size.y), 5 * look.scale
        ground = theme.palette.raised if lit else theme.palette.field
        draw.add_rect_filled(corner, far, theme.packed(ground), radius)
        low = far.y - _CAPTION * look.scale
        texture = self._texture(version)
        if texture is not None:
            draw.add_image_rounded(
                imgui.ImTextureRef(texture.glo),
                corner,
                ImVec2(far.x, low),
                ImVec2(0, 0),
                ImVec2(1, 1),
                theme.packed((1.0, 1.0, 1.0)),
                radius,
                imgui.ImDrawFlags_.round_top,
            )
        if version.key == versions.selected or lit:
            wide = (2.5 if version.key == versions.selected else 1.0) * look.scale
            draw.add_rect(corner, far, theme.packed(theme.palette.accent), radius, wide)
        now = f"{tr('now')} · " if version.key == versions.current else ""
        left, middle = corner.x + 5 * look.scale, low + _CAPTION * look.scale / 2
        if version.name:
            _draw_star(draw, ImVec2(left + 6 * look.scale, middle), 6 * look.scale)
            left += 16 * look.scale
        with look.font(look.text, theme.SMALL):
            text = fitting(f"{now}{title_of(version)}", far.x - 4 * look.scale - left)
            top = middle - imgui.get_font_size() / 2
            draw.add_text(ImVec2(left, top), theme.packed(theme.palette.ink), text)
        if hovered and imgui.is_mouse_double_clicked(0):
            versions.go_back(version)
        elif clicked and not (self._is_double and imgui.is_mouse_released(0)):
            if version.key == versions.selected:
                self.versions.leave()
            else:
                versions.look(version)
        self._draw_menu(version)

    def _name(self, version: Version) -> None:
        """Give the field for a name the keys, for a version."""
        self.versions.select(version)
        self._gets_keys = True

    def _draw_menu(self, version: Version) -> None:
        with pushed_id(version.key):
            if not imgui.begin_popup_context_item("menu"):
                return
            for label, act in (
                ("Look at it", self.versions.look),
                ("Name", self._name),
                ("Compare A/B", self.versions.compare),
                ("Go back", self.versions.go_back),
                ("As a new sketch", self.versions.as_new_sketch),
                ("Remove", self.versions.remove),
            ):
                if imgui.menu_item_simple(f"{tr(label)}###{label}"):
                    act(version)
            imgui.end_popup()

    def _texture(self, version: Version) -> moderngl.Texture | None:
        key = version.key, version.at  # one that is kept again has another picture
        if key not in self._textures:
            self._textures[key] = self._read(version)
        return self._textures[key]

    def _read(self, version: Version) -> moderngl.Texture | None:
        try:
            pixels = np.asarray(read_picture(self.versions.picture(version)))
        except OSError:
            return None
        texture = self._ctx.texture((pixels.shape[1], pixels.shape[0]), 3, pixels.tobytes(), alignment=1)
        texture.filter = moderngl.LINEAR, moderngl.LINEAR
        return texture


def _draw_star(draw: imgui.ImDrawList, middle: ImVec2, radius: float) -> None:
    """Draw a star of five points, for which the font has no letter."""
    points: list[ImVec2 | tuple[float, float] | list[float]] = []
    for number in range(10):
        angle, away = math.pi * number / 5, radius if number % 2 == 0 else 0.4 * radius
        points.append(ImVec2(middle.x + away * math.sin(angle), middle.y - away * math.cos(angle)))
    draw.add_concave_poly_filled(points, theme.packed(theme.palette.warm))


def _left() -> float:
    return max(imgui.get_content_region_avail().x, 1.0)


def _note(version: Version) -> str:
    """Return what a version's tooltip says."""
    from datetime import datetime

    lines = [datetime.fromtimestamp(version.at).strftime("%Y-%m-%d %H:%M:%S")] if version.name else []
    with suppress(PlaygroundError):
        count = len(version.state.edits.values)
        lines.append(f"{counted(len(version.texts), 'text')}, {counted(count, 'set value')}")
    return "\n".join(lines)
