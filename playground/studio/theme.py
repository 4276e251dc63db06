"""How the panel looks: fonts, colours, margins, all scaled to the screen."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from imgui_bundle import ImVec2, ImVec4, imgui

TEXT_SIZE = 15.0
SMALL = 13.0
PANEL_WIDTH = 330.0

Rgb = tuple[float, float, float]
"""A display-encoded colour, 0..1."""

ACCENT = (0.47, 0.71, 0.47)  # the green of a meadow: what is set, what is active
WARM = (0.93, 0.72, 0.38)  # what the user has edited
ALARM = (0.98, 0.52, 0.45)
DIM = (0.56, 0.60, 0.62)
INK = (0.88, 0.90, 0.92)

GROUND = (0.098, 0.106, 0.114)
FIELD = (0.165, 0.178, 0.190)
RAISED = (0.215, 0.232, 0.247)
LINE = (0.30, 0.32, 0.34)


class Theme:
    """The fonts and the style of the current imgui context."""

    def __init__(self, fonts: Path) -> None:
        regular, code = fonts / "Roboto" / "Roboto-Regular.ttf", fonts / "Inconsolata-Medium.ttf"
        symbols = fonts / "latex" / "latinmodern-math.otf"
        # What a font lacks is taken from the next: Roboto has no arrows, Inconsolata no Greek.
        self.text = _font(regular, symbols, code)
        self.bold = _font(fonts / "Roboto" / "Roboto-Bold.ttf", symbols, code)
        self.italic = _font(fonts / "Roboto" / "Roboto-RegularItalic.ttf", symbols, code)
        self.code = _font(code, regular, symbols)
        self.scale = 0.0  # of text and margins
        self.rescale(1.0)

    def rescale(self, scale: float) -> None:
        """Fit the style to a screen; does nothing while the scale stays."""
        if self.scale != scale:
            self.scale = scale
            _take(_style(scale))

    @contextmanager
    def font(self, font: imgui.ImFont, size: float = TEXT_SIZE) -> Iterator[None]:
        """Write with another font inside the block."""
        imgui.push_font(font, size)
        try:
            yield
        finally:
            imgui.pop_font()


def _font(first: Path, *others: Path) -> imgui.ImFont:
    """Load a font that has the glyphs of several files; sizes and line heights are the first one's."""
    atlas = imgui.get_io().fonts
    font = atlas.add_font_from_file_ttf(str(first), TEXT_SIZE)
    merged = imgui.ImFontConfig()
    merged.merge_mode = True
    for other in others:
        atlas.add_font_from_file_ttf(str(other), TEXT_SIZE, merged)
    return font


def colour(rgb: Rgb, alpha: float = 1.0) -> ImVec4:
    """Return a display-encoded colour, as imgui takes it."""
    return ImVec4(*rgb, alpha)


def packed(rgb: Rgb, alpha: float = 1.0) -> int:
    """Return a display-encoded colour, as imgui's draw lists take it."""
    return int(imgui.color_convert_float4_to_u32(ImVec4(*rgb, alpha)))


def _style(scale: float) -> imgui.Style:
    """Return the style for a screen of that scale."""
    style = imgui.Style()
    imgui.style_colors_dark(style)
    style.font_size_base = TEXT_SIZE
    style.window_padding = ImVec2(12, 10)
    style.frame_padding = ImVec2(8, 4)
    style.item_spacing = ImVec2(8, 6)
    style.item_inner_spacing = ImVec2(6, 4)
    style.indent_spacing = 14
    style.scrollbar_size = 11
    style.grab_min_size = 9
    style.frame_rounding = 5
    style.grab_rounding = 4
    style.popup_rounding = 6
    style.child_rounding = 6
    style.scrollbar_rounding = 6
    style.window_rounding = 0
    style.window_border_size = 0
    style.popup_border_size = 1
    style.separator_text_border_size = 1
    style.separator_text_padding = ImVec2(0, 4)
    for name, value in _colours().items():
        style.set_color_(getattr(imgui.Col_, name), value)
    style.scale_all_sizes(scale)
    style.font_scale_dpi = scale
    return style


def _take(style: imgui.Style) -> None:
    """Make a style the current one; imgui offers no assignment."""
    current = imgui.get_style()
    for name in dir(style):
        if name.startswith("_") or callable(getattr(style, name)):
            continue
        setattr(current, name, getattr(style, name))
    for index in range(imgui.Col_.count):
        current.set_color_(index, style.color_(index))


def _colours() -> dict[str, ImVec4]:
    def grey(level: float, alpha: float = 1.0) -> ImVec4:
        return ImVec4(level * 0.96, level, level * 1.03, alpha)

    return {
        "text": colour(INK),
        "text_disabled": colour(DIM),
        "window_bg": colour(GROUND),
        "child_bg": colour(GROUND, 0.0),
        "popup_bg": colour((0.125, 0.135, 0.145), 0.98),
        "border": grey(0.30),
        "frame_bg": colour(FIELD),
        "frame_bg_hovered": colour(RAISED),
        "frame_bg_active": grey(0.28),
        "title_bg": colour(GROUND),
        "title_bg_active": colour(GROUND),
        "scrollbar_bg": colour(GROUND, 0.0),
        "scrollbar_grab": grey(0.26),
        "scrollbar_grab_hovered": grey(0.34),
        "scrollbar_grab_active": grey(0.42),
        "check_mark": colour(ACCENT),
        "slider_grab": colour((0.29, 0.46, 0.32)),
        "slider_grab_active": colour((0.36, 0.56, 0.38)),
        "button": colour(RAISED),
        "button_hovered": grey(0.30),
        "button_active": colour(ACCENT, 0.6),
        "header": colour(FIELD),
        "header_hovered": colour(RAISED),
        "header_active": grey(0.28),
        "separator": grey(0.22),
        "separator_hovered": colour(ACCENT, 0.6),
        "separator_active": colour(ACCENT),
        "resize_grip": grey(0.3, 0.0),
        "resize_grip_hovered": colour(ACCENT, 0.6),
        "resize_grip_active": colour(ACCENT),
        "text_selected_bg": colour(ACCENT, 0.35),
        "nav_cursor": colour(ACCENT),
        "plot_histogram": colour(ACCENT),
        "table_row_bg": grey(0.0, 0.0),
        "table_row_bg_alt": grey(1.0, 0.025),
    }
