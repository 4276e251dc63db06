"""Draw the start page over the whole window."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import moderngl
import numpy as np
from imgui_bundle import ImVec2, imgui
from imgui_bundle import portable_file_dialogs as dialogs

from playground.allowed_files import ELEVATIONS, SHADERS
from playground.studio import theme
from playground.studio.draw import QUIET, button, explain, fitting, menu, window
from playground.studio.interface import Interface
from playground.studio.language import tr, tr_label
from playground.studio.settings_panel import draw_settings, settings_label
from playground.studio.start.page import LESSONS, TEMPLATES, Card, StartPage, Template, has_file_dialogs
from playground.studio.start.thumbnails import CELL, place_of, read_atlas, read_picture
from playground.studio.theme import Theme

if TYPE_CHECKING:
    from collections.abc import Sequence

_CARD = 200.0  # [units of scale 1] that a card is wide at least
_CAPTION = 26.0
_PAGE = QUIET | imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.no_move
_GROUPS = (("recent", "Recent"), ("shipped", "Shipped sketches"), ("lesson", "Lessons"))
_SUBJECTS = {
    "landscapes": "landscapes",
    "land": "generation",
    "erosion": "erosion",
    "water": "water",
    "sky": "sky",
    "textures": "textures",
    "light": "light",
    "methods": "other",
    LESSONS: "lessons",
}


class StartPanel:
    """The page's drawing: its pictures, and the file dialog that is open."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._textures: dict[str, moderngl.Texture | None] = {}  # by file; "" is the atlas
        self._dialog: dialogs.open_file | None = None
        self._asks_for: Template | None = None  # what the dialog's file is for; None: to open
        self._typed = ""  # a path, where there are no dialogs
        self._types = self._focus_path = False
        self._focus = True

    @property
    def waits(self) -> bool:
        """Whether a dialog of the system is open, whose answer is asked for."""
        return self._dialog is not None

    def draw(self, page: StartPage, look: Theme, interface: Interface) -> None:
        """Draw the page, and do what is clicked on."""
        self._take_answer(page)
        room = imgui.get_main_viewport().size
        imgui.set_next_window_pos(ImVec2(0, 0))
        imgui.set_next_window_size(room)
        with window("start page", _PAGE, ground=theme.colour(theme.palette.ground)):
            _draw_title(interface, look)
            self._draw_head(page, look)
            if self._types:
                self._draw_path_field(page)
            imgui.begin_child("cards", ImVec2(0, 0), imgui.ChildFlags_.nav_flattened)
            found = False
            for group, heading in _GROUPS:
                cards = page.cards(group)
                found = found or bool(cards)
                if cards:
                    self._draw_group(page, group, f"{tr(heading)}  ({len(cards)})", cards, look)
            if not found:
                imgui.text_disabled(tr("Nothing matches {search}.", search=page.search))
            imgui.end_child()

    def release(self) -> None:
        """Release the pictures; they are read again when the page is drawn."""
        for texture in self._textures.values():
            if texture is not None:
                texture.release()
        self._textures.clear()
        if self._dialog is not None:
            self._dialog.kill()  # else the end of the program waits for it
            self._dialog = None

    # ── head ─────────────────────────────────────────────────────────────────

    def _draw_head(self, page: StartPage, look: Theme) -> None:
        scale = look.scale
        imgui.set_next_item_width(-330 * scale)
        if self._focus or imgui.is_window_appearing():
            imgui.set_keyboard_focus_here()
            self._focus = False
        flags = imgui.InputTextFlags_.escape_clears_all
        hint = tr("Search sketches and lessons")
        _, page.search = imgui.input_text_with_hint("##search", hint, page.search, flags)
        entered = imgui.is_item_deactivated() and imgui.is_key_pressed(imgui.Key.enter)
        if entered and (card := page.first()) is not None:
            page.choose(card)
        imgui.same_line()
        with menu(f"+ {tr('New')}###new", "new sketch", tr("A sketch of your own, in this folder")) as opened:
            if opened:
                for template in TEMPLATES:
                    if template.key == "lesson" and LESSONS not in page.subjects():
                        continue
                    if imgui.menu_item_simple(f"{tr(template.title)}##{template.key}", tr(template.note)):
                        self._begin(page, template)
        imgui.same_line()
        if button(f"{tr('Open…')}###open", tr("A sketch, a shader, an elevation file; or drop it here")):
            self._ask_for_file(None)
        imgui.same_line()
        if button(f"{tr('Back')}###back", tr("To the sketch that is open (O)")):
            page.close()
        for at, subject in enumerate(("", *page.subjects())):
            if at:
                imgui.same_line()
            label = tr(_SUBJECTS[subject]) if subject else tr("all")
            if imgui.radio_button(f"{label}##subject {subject}", page.subject == subject):
                page.subject = subject

    def _begin(self, page: StartPage, template: Template) -> None:
        if template.needs:
            self._ask_for_file(template)
        elif template.key == "lesson":
            page.subject, page.search = LESSONS, ""
        elif template.key == "clipboard":
            before = page.actions.session.path
            page.actions.paste(imgui.get_clipboard_text() or "")
            if page.actions.session.path != before:
                page.close()
        else:
            page.make(template)

    # ── files ────────────────────────────────────────────────────────────────

    def _ask_for_file(self, template: Template | None) -> None:
        self._asks_for = template
        if not has_file_dialogs():
            self._types = self._focus_path = True
            return
        if self._dialog is None:
            kinds = {"elevation": ELEVATIONS, "shader": SHADERS}.get(template.key if template else "", ())
            endings = " ".join(f"*{ending}" for ending in kinds) or "*"
            title = tr("Open…") if template is None else tr(template.title)
            self._dialog = dialogs.open_file(
                title, str(Path.cwd()), [tr("Files"), endings, tr("All files"), "*"]
            )

    def _take_answer(self, page: StartPage) -> None:
        if self._dialog is None or not self._dialog.ready(0):
            return
        names, self._dialog = self._dialog.result(), None
        if names:
            self._open(page, Path(names[0]))

    def _draw_path_field(self, page: StartPage) -> None:
        """Draw a field for a path, where the system has no program for file dialogs."""
        imgui.set_next_item_width(-120 * imgui.get_style().font_scale_dpi)
        if self._focus_path:
            imgui.set_keyboard_focus_here()
            self._focus_path = False
        enter = imgui.InputTextFlags_.enter_returns_true
        hint = tr("A file's path; dialogs need zenity or kdialog")
        entered, self._typed = imgui.input_text_with_hint("##path", hint, self._typed, enter)
        imgui.same_line()
        if button(f"{tr('Open')}###open path") or entered:
            self._open(page, Path(self._typed.strip()).expanduser())

    def _open(self, page: StartPage, path: Path) -> None:
        template = self._asks_for
        opened = page.make(template, path) if template is not None else page.actions.open(path)
        if opened:
            self._types, self._typed = False, ""
            page.close()

    # ── cards ────────────────────────────────────────────────────────────────

    def _draw_group(
        self, page: StartPage, group: str, heading: str, cards: Sequence[Card], look: Theme
    ) -> None:
        with look.font(look.bold, theme.TEXT_SIZE + 2):
            imgui.text_unformatted(heading)
        scale, gap = look.scale, 10 * look.scale
        room = imgui.get_content_region_avail().x - imgui.get_style().scrollbar_size
        across = max(int((room + gap) / (_CARD * scale + gap)), 1)
        wide = (room - (across - 1) * gap) / across
        size = ImVec2(wide, wide * CELL[1] / CELL[0] + _CAPTION * scale)
        shown = cards[:across] if group == "recent" else cards
        rows = -(-len(shown) // across)
        clipper = imgui.ListClipper()
        clipper.begin(rows, size.y + imgui.get_style().item_spacing.y)
        while clipper.step():
            for row in range(clipper.display_start, clipper.display_end):
                for at, card in enumerate(shown[row * across : (row + 1) * across]):
                    if at:
                        imgui.same_line(0, gap)
                    self._draw_card(page, card, size, look)

    def _draw_card(self, page: StartPage, card: Card, size: ImVec2, look: Theme) -> None:
        corner, draw = imgui.get_cursor_screen_pos(), imgui.get_window_draw_list()
        clicked = imgui.invisible_button(card.key, size, imgui.ButtonFlags_.enable_nav)
        lit = imgui.is_item_hovered() or imgui.is_item_focused()
        if card.note and imgui.is_item_hovered(imgui.HoveredFlags_.for_tooltip):
            explain(tr_label(card.title), card.note)
        far, radius = ImVec2(corner.x + size.x, corner.y + size.y), 6 * look.scale
        ground = theme.palette.raised if lit else theme.palette.field
        draw.add_rect_filled(corner, far, theme.packed(ground), radius)
        low = ImVec2(corner.x, far.y - _CAPTION * look.scale)
        texture = self._texture("" if card.picture is None else str(card.picture))
        if texture is not None and (card.cell >= 0 or card.picture is not None):
            left, top, right, bottom = (
                (0.0, 0.0, 1.0, 1.0) if card.picture is not None else place_of(card.cell, texture.size)
            )
            draw.add_image_rounded(
                imgui.ImTextureRef(texture.glo),
                corner,
                ImVec2(far.x, low.y),
                ImVec2(left, top),
                ImVec2(right, bottom),
                theme.packed((1.0, 1.0, 1.0)),
                radius,
                imgui.ImDrawFlags_.round_top,
            )
        if lit:
            draw.add_rect(corner, far, theme.packed(theme.palette.accent), radius, 2 * look.scale)
        text = fitting(tr_label(card.title), size.x - 16 * look.scale)
        place = ImVec2(low.x + 8 * look.scale, low.y + 4 * look.scale)
        draw.add_text(place, theme.packed(theme.palette.ink), text)
        if clicked:
            page.choose(card)

    def _texture(self, name: str) -> moderngl.Texture | None:
        """Return a picture on the GPU: the atlas for "", else that of a file."""
        if name not in self._textures:
            self._textures[name] = self._read(name)
        return self._textures[name]

    def _read(self, name: str) -> moderngl.Texture | None:
        try:
            pixels = np.asarray(read_atlas() if not name else read_picture(name))
        except OSError:
            return None
        texture = self._ctx.texture((pixels.shape[1], pixels.shape[0]), 3, pixels.tobytes(), alignment=1)
        texture.build_mipmaps()
        texture.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR
        return texture


def _draw_title(interface: Interface, look: Theme) -> None:
    """Draw the page's title, and at its right the window's settings."""
    with look.font(look.bold, theme.TEXT_SIZE + 5):
        imgui.text_unformatted(tr("Terrain shader playground"))
    wide = imgui.calc_text_size(settings_label(), True).x + 2 * imgui.get_style().frame_padding.x
    start = imgui.get_cursor_pos_x()
    imgui.same_line(start + max(imgui.get_content_region_avail().x - wide, 0.0))
    draw_settings(interface, look)
