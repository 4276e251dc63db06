"""How the panel looks: fonts, colours, margins, all scaled to the screen."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from imgui_bundle import ImVec2, ImVec4, imgui

TEXT_SIZE = 15.0
SMALL = 13.0
PANEL_WIDTH = 330.0

Rgb = tuple[float, float, float]
"""A display-encoded colour, 0..1."""


@dataclass(frozen=True)
class Palette:
    """The colours of the interface.

    ``ink``, ``dim``, ``accent``, ``warm`` and ``alarm`` write on ``ground``, ``popup``, ``field``, ``raised``
    and what is under mistakes with a contrast of 4.5 : 1 at least (WCAG 2.2, 1.4.3); ``line``, ``knob`` and
    ``series`` stand out by 3 : 1 (1.4.11). What a colour means is said by a sign or a word as well.
    """

    is_light: bool
    accent: Rgb  # what is set, what is active
    warm: Rgb  # what the user has edited
    alarm: Rgb
    dim: Rgb
    ink: Rgb
    ground: Rgb
    popup: Rgb
    field: Rgb
    raised: Rgb
    line: Rgb
    grab: Rgb  # a button that stands out
    knob: Rgb  # of a slider
    hover: Rgb
    pressed: Rgb
    surround: Rgb  # what is around the picture
    wrong: Rgb  # under errors
    mild: Rgb  # under warnings alone
    not_finite: Rgb
    channels: tuple[Rgb, Rgb, Rgb, Rgb]  # the curves of red, green, blue and alpha
    series: tuple[Rgb, ...]  # the curves of a plot


# Okabe and Ito 2008, "Color Universal Design", without black; on light ground the same hues, darker.
_SERIES = (
    (0.90, 0.62, 0.00),
    (0.34, 0.71, 0.91),
    (0.00, 0.62, 0.45),
    (0.94, 0.89, 0.26),
    (0.10, 0.50, 0.78),
    (0.84, 0.37, 0.00),
    (0.80, 0.47, 0.65),
)
_DARK_SERIES = (
    (0.62, 0.40, 0.00),
    (0.10, 0.45, 0.66),
    (0.00, 0.46, 0.33),
    (0.47, 0.43, 0.00),
    (0.00, 0.32, 0.56),
    (0.70, 0.27, 0.00),
    (0.60, 0.27, 0.46),
)

DARK = Palette(
    is_light=False,
    accent=(0.47, 0.71, 0.47),
    warm=(0.93, 0.72, 0.38),
    alarm=(0.98, 0.52, 0.45),
    dim=(0.63, 0.67, 0.69),
    ink=(0.88, 0.90, 0.92),
    ground=(0.098, 0.106, 0.114),
    popup=(0.125, 0.135, 0.145),
    field=(0.165, 0.178, 0.190),
    raised=(0.215, 0.232, 0.247),
    line=(0.46, 0.48, 0.50),
    grab=(0.26, 0.42, 0.29),
    knob=(0.37, 0.60, 0.41),
    hover=(0.288, 0.30, 0.309),
    pressed=(0.269, 0.28, 0.288),
    surround=(0.06, 0.065, 0.07),
    wrong=(0.17, 0.075, 0.075),
    mild=(0.125, 0.118, 0.095),
    not_finite=(1.0, 0.42, 1.0),
    channels=((0.95, 0.42, 0.38), (0.45, 0.80, 0.45), (0.45, 0.62, 0.98), (0.75, 0.75, 0.75)),
    series=_SERIES,
)
LIGHT = Palette(
    is_light=True,
    accent=(0.12, 0.38, 0.15),
    warm=(0.52, 0.30, 0.00),
    alarm=(0.68, 0.12, 0.08),
    dim=(0.34, 0.37, 0.39),
    ink=(0.09, 0.10, 0.11),
    ground=(0.955, 0.960, 0.965),
    popup=(0.985, 0.988, 0.990),
    field=(0.885, 0.893, 0.900),
    raised=(0.830, 0.842, 0.852),
    line=(0.48, 0.50, 0.52),
    grab=(0.45, 0.68, 0.47),
    knob=(0.22, 0.50, 0.26),
    hover=(0.76, 0.775, 0.788),
    pressed=(0.70, 0.72, 0.735),
    surround=(0.90, 0.905, 0.91),
    wrong=(0.995, 0.930, 0.925),
    mild=(0.985, 0.970, 0.930),
    not_finite=(0.62, 0.0, 0.62),
    channels=((0.70, 0.12, 0.10), (0.05, 0.42, 0.10), (0.12, 0.27, 0.75), (0.36, 0.36, 0.36)),
    series=_DARK_SERIES,
)

palette = DARK
"""The colours in use: read as ``theme.palette`` in each frame; ``Theme.choose`` changes it."""


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

    def choose(self, chosen: Palette) -> None:
        """Use other colours from the next frame on."""
        global palette
        if chosen is not palette:
            palette = chosen
            _take(_style(self.scale))

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
    (imgui.style_colors_light if palette.is_light else imgui.style_colors_dark)(style)
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
    style.frame_border_size = 1
    style.disabled_alpha = 0.7
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
    now = palette
    return {
        "text": colour(now.ink),
        "text_disabled": colour(now.dim),
        "window_bg": colour(now.ground),
        "child_bg": colour(now.ground, 0.0),
        "popup_bg": colour(now.popup, 0.98),
        "border": colour(now.line),
        "frame_bg": colour(now.field),
        "frame_bg_hovered": colour(now.raised),
        "frame_bg_active": colour(now.pressed),
        "title_bg": colour(now.ground),
        "title_bg_active": colour(now.ground),
        "title_bg_collapsed": colour(now.ground),
        "menu_bar_bg": colour(now.ground),
        "scrollbar_bg": colour(now.ground, 0.0),
        "scrollbar_grab": colour(now.line),
        "scrollbar_grab_hovered": colour(now.dim),
        "scrollbar_grab_active": colour(now.accent),
        "check_mark": colour(now.accent),
        "slider_grab": colour(now.knob),
        "slider_grab_active": colour(now.accent),
        "button": colour(now.raised),
        "button_hovered": colour(now.hover),
        "button_active": colour(now.pressed),
        "header": colour(now.field),
        "header_hovered": colour(now.raised),
        "header_active": colour(now.pressed),
        "separator": colour(now.field),
        "separator_hovered": colour(now.accent, 0.6),
        "separator_active": colour(now.accent),
        "resize_grip": colour(now.line, 0.0),
        "resize_grip_hovered": colour(now.accent, 0.6),
        "resize_grip_active": colour(now.accent),
        "tab": colour(now.ground),
        "tab_hovered": colour(now.raised),
        "tab_selected": colour(now.field),
        "tab_selected_overline": colour(now.accent),
        "tab_dimmed": colour(now.ground),
        "tab_dimmed_selected": colour(now.field),
        "tab_dimmed_selected_overline": colour(now.line),
        "docking_preview": colour(now.accent, 0.5),
        "docking_empty_bg": colour(now.surround),
        "text_selected_bg": colour(now.accent, 0.35),
        "nav_cursor": colour(now.accent),
        "text_link": colour(now.accent),
        "checkbox_selected_bg": colour(now.field),
        "drag_drop_target": colour(now.accent),
        "plot_lines": colour(now.ink),
        "plot_histogram": colour(now.accent),
        "table_header_bg": colour(now.field),
        "table_border_strong": colour(now.line),
        "table_border_light": colour(now.raised),
        "table_row_bg": colour(now.ground, 0.0),
        "table_row_bg_alt": colour(now.ink, 0.04 if now.is_light else 0.025),
    }
