"""The settings of the window in one small menu, and the line of hints at the picture's bottom.

The menu is the same in the panel's head and on the start page; what is chosen takes effect at once.
"""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from playground.studio import theme
from playground.studio.draw import OVERLAY, Area, button, menu, window
from playground.studio.interface import HINTS, SIZES, Interface, Preferences
from playground.studio.language import LANGUAGES, choose_language, language, numeral, tr
from playground.studio.theme import Theme

_MENU = "settings"
_HINTS = OVERLAY | imgui.WindowFlags_.no_bring_to_front_on_focus
_ABOVE = 44.0  # [units of scale 1] from the picture's lower edge: the corners' words are below


def settings_label() -> str:
    """Return what the menu's button says: the language in use, and that letters have a size."""
    return f"{language().upper()}  Aa###settings"


def draw_settings(interface: Interface, look: Theme, *, small: bool = False) -> None:
    """Draw the button of the settings, and its menu while that is open."""
    low, size = imgui.get_cursor_screen_pos(), imgui.calc_text_size(settings_label(), True)
    right = low.x > imgui.get_main_viewport().size.x / 2
    corner = ImVec2(low.x + (size.x + 2 * imgui.get_style().frame_padding.x) * right, low.y + 1.6 * size.y)
    if interface.settings_asked:
        interface.settings_asked = False
        imgui.open_popup(_MENU)
    imgui.set_next_window_pos(corner, imgui.Cond_.appearing, ImVec2(float(right), 0.0))
    note = tr("Language, colours, size of text, panes (F10)")
    with menu(settings_label(), _MENU, note, small=small) as opened:
        if opened:
            with look.font(look.text):
                _draw_choices(interface.preferences)


def _draw_choices(preferences: Preferences) -> None:
    imgui.text_disabled(tr("Language"))
    for code, name in LANGUAGES.items():
        if imgui.radio_button(f"{name}###language {code}", language() == code):
            preferences.choose(language=choose_language(code))
        imgui.same_line()
    imgui.new_line()
    imgui.text_disabled(tr("Colours"))
    for key, name, is_light in (("dark", tr("Dark"), False), ("light", tr("Light"), True)):
        if imgui.radio_button(f"{name}###{key}", preferences.is_light == is_light):
            preferences.choose(is_light=is_light)
        imgui.same_line()
    imgui.new_line()
    imgui.text_disabled(tr("Size of text and panels"))
    if button("−###smaller", tr("Smaller (Ctrl+-)"), enabled=preferences.size > SIZES[0]):
        preferences.step(-1)
    imgui.same_line()
    if button(f"{numeral(preferences.size, '.0%')}###first size", tr("As large as the screen says (Ctrl+0)")):
        preferences.choose(size=1.0)
    imgui.same_line()
    if button("+###larger", tr("Larger (Ctrl++)"), enabled=preferences.size < SIZES[-1]):
        preferences.step(1)
    imgui.separator()
    label = tr("Frames a second in the corner")
    changed, shown = imgui.checkbox(f"{label}###readout shown", preferences.shows_readout)
    if changed:
        preferences.choose(shows_readout=shown)
    changed, shown = imgui.checkbox(f"{tr('Hints below the picture')}###hints shown", bool(preferences.hints))
    if changed:
        preferences.choose(used_keys=() if shown else tuple(HINTS))
    label, note = (
        tr("Panes as delivered"),
        tr("Code beside the picture, passes below it, as large as at first"),
    )
    if button(f"{label}###as delivered", note):
        preferences.choose(panes={})


def draw_hints(preferences: Preferences, look: Theme, area: Area) -> None:
    """Name the keys that have not been used yet, where there is room; a cross closes the line."""
    with look.font(look.text, theme.SMALL):
        style, keys = imgui.get_style(), preferences.hints
        gap, pad = style.item_spacing.x, 5 * look.scale
        words = {key: tr(HINTS[key]) for key in keys}
        wide = {key: imgui.calc_text_size(f"{key}{words[key]}").x + 4 * gap for key in keys}
        room = area[2] - imgui.calc_text_size("×").x - 6 * gap
        while keys and sum(wide[key] for key in keys) > room:
            keys.pop()
        if not keys or area[3] < 3 * _ABOVE * look.scale:
            return
        place = ImVec2(area[0] + area[2] / 2, area[1] + area[3] - _ABOVE * look.scale)
        imgui.set_next_window_pos(place, imgui.Cond_.always, ImVec2(0.5, 1.0))
        sizes: dict[imgui.StyleVar_, float | ImVec2] = {
            imgui.StyleVar_.window_padding: ImVec2(2 * pad, pad),
            imgui.StyleVar_.window_min_size: ImVec2(8, 8),
        }
        ground = theme.colour(theme.palette.ground, 0.92)
        with window("hints", _HINTS, ground=ground, rounding=6 * look.scale, sizes=sizes):
            for key in keys:
                _draw_cap(key, look)
                imgui.same_line(0, gap)
                imgui.text_unformatted(words[key])
                imgui.same_line(0, 2 * gap)
            if button("×###close hints", tr("Close; the settings (F10) bring it back"), small=True):
                preferences.choose(used_keys=tuple(HINTS))


def _draw_cap(key: str, look: Theme) -> None:
    """Write a key as its cap."""
    low, size = imgui.get_cursor_screen_pos(), imgui.calc_text_size(key)
    pad = 4 * look.scale
    far = ImVec2(low.x + size.x + 2 * pad, low.y + size.y + look.scale)
    draw = imgui.get_window_draw_list()
    draw.add_rect_filled(ImVec2(low.x, low.y - look.scale), far, theme.packed(theme.palette.raised), pad)
    draw.add_rect(ImVec2(low.x, low.y - look.scale), far, theme.packed(theme.palette.dim), pad, look.scale)
    draw.add_text(ImVec2(low.x + pad, low.y), theme.packed(theme.palette.ink), key)
    imgui.dummy(ImVec2(size.x + 2 * pad, size.y))
