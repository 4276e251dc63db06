"""Draw parameters as their annotations say, and give back what the user makes of them.

One function a control, by its name in ``CONTROLS``: those of ``shader/widgets.json``. Each returns the new
value, or None while nothing changed.

A number that would lie under its slider's knob moves to the wider side of the knob. The parts of a vector are
one below the other, so that each has a name and room for its number. A direction is a dot on a disc: the
middle is the zenith, the rim the horizon, north is up; azimuth clockwise from north and elevation above the
horizon, in degrees.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from imgui_bundle import ImVec2, ImVec4, imgui, implot

from playground.errors import DataError
from playground.paths import shown
from playground.shader.colours import linear_to_srgb, srgb_to_linear
from playground.shader.parameter import expected, is_whole, length_of, part_names, tidied, write
from playground.shader.widgets import fraction_of
from playground.sketch.files import find_file
from playground.sketch.model import Parameter, Value
from playground.studio import theme
from playground.studio.channels.channels import IMAGES
from playground.studio.draw import choose, fitting_choice
from playground.studio.language import tr, tr_label
from playground.studio.panel.values import format_of, snapped, unit_of

# ── directions ────────────────────────────────────────────────────────────────


def dot_of(azimuth: float, elevation: float) -> tuple[float, float]:
    """Return the place of a direction on the unit disc: right, up. Below the horizon is on the rim."""
    radius = 1.0 - min(max(elevation, 0.0), 90.0) / 90.0
    angle = math.radians(azimuth)
    return radius * math.sin(angle), radius * math.cos(angle)


def direction_at(right: float, up: float) -> tuple[float, float]:
    """Return (azimuth, elevation) [degrees] of a place on the unit disc, or of the nearest on its rim."""
    radius = min(math.hypot(right, up), 1.0)
    azimuth = math.degrees(math.atan2(right, up)) % 360.0
    return azimuth, 90.0 * (1.0 - radius)


# ── numbers ───────────────────────────────────────────────────────────────────


_CLAMP = imgui.SliderFlags_.always_clamp.value
_LOGARITHMIC = imgui.SliderFlags_.logarithmic.value
_NO_FIELD = imgui.SliderFlags_.no_input.value  # the panel has a field of its own, which reads expressions
_WHOLE = 2**31 - 1
_EDGE = 2.0  # imgui keeps a knob so far from the slider's ends


def draw_numbers(parameter: Parameter, numbers: Sequence[float], label: str) -> list[float] | None:
    """Draw a number, or the parts of a vector, over the width that is left; return them where one changed."""
    names = part_names(parameter)
    if not names:
        changed = _draw_one(parameter, numbers[0], numbers[0], label)
        return None if changed is None else [changed]
    wide = imgui.calc_item_width()
    spacing = imgui.get_style().item_inner_spacing.x
    column = min(max(imgui.calc_text_size(tr_label(name)).x for name in names) + spacing, wide / 2)
    largest = max(abs(n) for n in numbers)
    values: list[float] | None = None
    imgui.begin_group()
    for at, name in enumerate(names):
        imgui.align_text_to_frame_padding()
        imgui.text_disabled(tr_label(name))
        imgui.same_line(column)  # from the group's left edge
        imgui.push_item_width(wide - column)
        changed = _draw_one(parameter, numbers[at], largest, f"{label}.{name}")
        imgui.pop_item_width()
        if changed is not None:
            values = [*numbers[:at], changed, *numbers[at + 1 :]]
    imgui.end_group()
    return values


def _draw_one(parameter: Parameter, number: float, largest: float, label: str) -> float | None:
    """Draw one number; ``largest``: of its vector, which says how fast a drag without a range goes."""
    widget = parameter.widget
    if widget.low is not None and widget.high is not None:
        value = _slide(parameter, number, widget.low, widget.high, label)
    elif not isinstance(parameter.default, tuple) and is_whole(parameter.type):
        return _step(parameter, number, label)
    else:
        value = _drag(parameter, number, largest, label)
    return None if value is None else snapped(parameter, value)


def _slide(parameter: Parameter, number: float, low: float, high: float, label: str) -> float | None:
    form = format_of(parameter)
    if is_whole(parameter.type):
        ends = max(int(low), -_WHOLE), min(int(high), _WHOLE)
        whole = slide_whole(label, int(number), ends, lambda n: form % n, typed=False)
        return None if whole is None else float(whole)
    logarithmic = parameter.widget.facts.is_log
    return slide(label, number, (low, high), form, logarithmic=logarithmic, typed=False)


def slide(
    label: str,
    number: float,
    ends: tuple[float, float],
    form: str,
    *,
    logarithmic: bool = False,
    typed: bool = True,
) -> float | None:
    """Draw a slider over the width that is left; return the number where it changed.

    ``form`` is the C format that writes it. ``typed``: a click with Ctrl opens imgui's own field.
    """
    low, high = ends
    flags = _CLAMP | (_LOGARITHMIC if logarithmic else 0) | (0 if typed else _NO_FIELD)
    with _hidden_number(typed) as hidden:
        changed, now = imgui.slider_float(label, number, low, high, form, flags)
    if hidden:  # at 0 where there is nothing to choose from, as for a brush while there is no terrain
        _write_number(form % now, fraction_of(min(max(now, low), high), low, high, log=logarithmic))
    return now if changed else None


def slide_whole(
    label: str, number: int, ends: tuple[int, int], words: Callable[[int], str], *, typed: bool = True
) -> int | None:
    """Draw a slider of whole numbers, which ``words`` writes; else as ``slide`` does."""
    low, high = ends
    with _hidden_number(typed) as hidden:
        changed, now = imgui.slider_int(label, number, low, high, "%d", _CLAMP | (0 if typed else _NO_FIELD))
    if hidden:
        _write_number(words(now), (min(max(now, low), high) - low) / max(high - low, 1), high - low + 1)
    return now if changed else None


@contextmanager
def _hidden_number(typed: bool) -> Iterator[bool]:
    """Have imgui draw a slider without its number, which it would write in its middle.

    Gives False where the number is visible after all: while it may be that very number which is typed.
    """
    hidden = not (typed and imgui.get_io().want_text_input)
    if hidden:
        imgui.push_style_color(imgui.Col_.text, theme.colour(theme.palette.ink, 0.0))
    yield hidden
    if hidden:
        imgui.pop_style_color()


def _write_number(text: str, fraction: float, values: int = 0) -> None:
    """Write a number on the slider that was drawn last, clear of the knob; see ``knob_of``."""
    left, right = imgui.get_item_rect_min(), imgui.get_item_rect_max()
    size, style = imgui.calc_text_size(text), imgui.get_style()
    knob = knob_of(fraction, right.x - left.x, style.grab_min_size, values)
    across = place_of_number(right.x - left.x, size.x, knob, style.item_inner_spacing.x / 2)
    position = ImVec2(round(left.x + across), round((left.y + right.y - size.y) / 2))
    draw = imgui.get_window_draw_list()
    draw.push_clip_rect(left, right, True)
    draw.add_text(position, imgui.get_color_u32(imgui.Col_.text), text)
    draw.pop_clip_rect()


def knob_of(fraction: float, wide: float, least: float, values: int = 0) -> tuple[float, float]:
    """Return where imgui draws the knob of a slider ``wide`` across: its left and its right end.

    ``fraction`` of its way is gone; the knob is ``least`` wide or, where it goes through so many whole
    ``values``, as wide as one of them.
    """
    room = wide - 2 * _EDGE
    across = min(max(room / values if values else 0.0, least), room)
    start = _EDGE + fraction * (room - across)
    return start, start + across


def place_of_number(wide: float, text: float, knob: tuple[float, float], gap: float) -> float:
    """Return where a text begins in a slider: in its middle, or in that of the wider side of the knob."""
    middle = (wide - text) / 2
    start, end = knob
    if middle + text + gap <= start or end + gap <= middle:
        return middle
    if start >= wide - end:
        return max(min((start - text) / 2, start - gap - text), 0.0)
    return min(max((end + wide - text) / 2, end + gap), wide - text)


def _drag(parameter: Parameter, number: float, largest: float, label: str) -> float | None:
    speed = parameter.step or max(abs(largest), 0.1) * 0.01
    if is_whole(parameter.type):
        form = format_of(parameter)
        changed, now = imgui.drag_int(label, int(number), max(speed, 0.2), -_WHOLE, _WHOLE, form, _NO_FIELD)
        return float(now) if changed else None
    form = "%.6g" + _unit_format(parameter)
    changed, dragged = imgui.drag_float(label, number, speed, 0.0, 0.0, form, _NO_FIELD)
    return dragged if changed else None


def _step(parameter: Parameter, number: float, label: str) -> float | None:
    # A double holds every 32-bit number, signed or not.
    step = parameter.step or 1.0
    changed, typed = imgui.input_double(label, number, step, 10 * step, f"%.0f{_unit_format(parameter)}")
    low, high = (0, 2**32 - 1) if parameter.type == "uint" else (-(2**31), 2**31 - 1)
    return float(min(max(round(typed), low), high)) if changed else None


def _unit_format(parameter: Parameter) -> str:
    return unit_of(parameter).replace("%", "%%")


# ── controls ──────────────────────────────────────────────────────────────────


_PAD = 84.0
_PATH = imgui.InputTextFlags_.enter_returns_true | imgui.InputTextFlags_.elide_left  # its end is the name


@dataclass(frozen=True)
class WidgetSlot:
    """Where a widget is drawn."""

    label: str  # imgui's, unique in the panel
    scale: float  # of the screen
    folder: Path  # the sketch's own: its files are offered
    endings: tuple[str, ...] = IMAGES  # of the files


Draw = Callable[[Parameter, Value, WidgetSlot], "Value | None"]


def draw_value(parameter: Parameter, value: Value, slot: WidgetSlot) -> Value | None:
    """Draw the widget of a parameter over the width that is left; return a new value, or None."""
    return CONTROLS[parameter.widget.facts.control](parameter, value, slot)


def explanation(parameter: Parameter, path: str) -> str:
    """Return a tooltip: what a parameter is, takes, is by default, where it is declared, its path."""
    lines = [parameter.tooltip] if parameter.tooltip else []
    in_words = parameter.widget.choices or parameter.widget.facts.expects
    unit = "" if in_words else unit_of(parameter)
    default = write(parameter, parameter.default) or tr("none")
    lines.append(
        tr(
            "Takes {values}{unit}; by default {default}{unit}.",
            values=expected(parameter, tr),
            unit=unit,
            default=default,
        )
    )
    if parameter.step:
        lines.append(tr("In steps of {step}{unit}.", step=f"{parameter.step:g}", unit=unit))
    if names := part_names(parameter):
        if parameter.widget.facts.control == "numbers":
            lines.append(tr("Its parts: {names}.", names=", ".join(map(tr_label, names))))
    declared = f"uniform {parameter.type} {parameter.name}"
    lines.append(f"{declared}, {shown(parameter.file)}:{parameter.line}" if parameter.file else declared)
    return "\n".join([*lines, path])


# ── numbers ──────────────────────────────────────────────────────────────────


def _numbers(parameter: Parameter, value: Value, slot: WidgetSlot) -> Value | None:
    data = draw_numbers(parameter, _as_list(value), slot.label)
    return None if data is None else _back(parameter, data)


def _checkbox(parameter: Parameter, value: Value, slot: WidgetSlot) -> Value | None:
    changed, on = imgui.checkbox(slot.label, bool(value))
    return on if changed else None


def _button(parameter: Parameter, value: Value, slot: WidgetSlot) -> Value | None:
    pressed = imgui.button(f"{tr_label(parameter.title)}{slot.label}", ImVec2(imgui.calc_item_width(), 0))
    return True if pressed else None


def _menu(parameter: Parameter, value: Value, slot: WidgetSlot) -> Value | None:
    choices = [tr_label(choice) for choice in parameter.widget.choices]
    now = int(value) if isinstance(value, int) and 0 <= value < len(choices) else 0
    shown = fitting_choice(choices[now])
    chosen = choose(slot.label, shown, range(len(choices)), now, name=choices.__getitem__)
    return chosen if chosen != now else None


# ── places and colours ───────────────────────────────────────────────────────


def _colour(parameter: Parameter, value: Value, slot: WidgetSlot) -> Value | None:
    # Linear inside unless it is raw, display-encoded for the eye; alpha is not a light and stays as it is.
    linear, raw = _as_list(value), parameter.widget.raw
    flags = imgui.ColorEditFlags_.display_hex | imgui.ColorEditFlags_.picker_hue_wheel
    held = [min(max(c, 0.0), 1.0) for c in linear[:3]]
    seen = [*(held if raw else linear_to_srgb(held).tolist()), *linear[3:]]
    if len(linear) == 4:
        changed, edited = imgui.color_edit4(slot.label, seen, flags | imgui.ColorEditFlags_.alpha_bar)
    else:
        changed, edited = imgui.color_edit3(slot.label, seen, flags)
    # Eight bits a channel, as the field shows it and a file can say it.
    picked = [round(c * 255) / 255 for c in _as_list(edited)]
    if not changed:
        return None
    return tuple(picked) if raw else (*srgb_to_linear(picked[:3]).tolist(), *picked[3:])


def _direction(parameter: Parameter, value: Value, slot: WidgetSlot) -> Value | None:
    azimuth, elevation = _as_list(value)
    origin, side, field, dragged = _pad(slot)
    radius, draw = side / 2, imgui.get_window_draw_list()
    middle = ImVec2(origin.x + radius, origin.y + radius)
    draw.add_circle_filled(middle, radius - 1, theme.packed(theme.palette.field))
    for fraction in (1.0, 2 / 3, 1 / 3):  # the horizon, 30 and 60 degrees
        draw.add_circle(middle, (radius - 1) * fraction, theme.packed(theme.palette.line), 0, slot.scale)
    north = imgui.calc_text_size("N")
    draw.add_text(ImVec2(middle.x - north.x / 2, origin.y + slot.scale), theme.packed(theme.palette.dim), "N")
    right, up = dot_of(azimuth, elevation)
    dot = ImVec2(middle.x + right * (radius - 1), middle.y - up * (radius - 1))
    below = elevation < 0
    draw.add_line(middle, dot, theme.packed(theme.palette.warm, 0.5), slot.scale)
    draw.add_circle_filled(
        dot, 5 * slot.scale, theme.packed(theme.palette.dim if below else theme.palette.warm)
    )
    result: Value | None = None
    if dragged is not None:
        across, down = dragged
        direction_picked = direction_at(2 * across - 1, 1 - 2 * down)
        result = (round(direction_picked[0], 1), round(direction_picked[1], 1))
    imgui.same_line()
    imgui.begin_group()
    _name(tr("azimuth"))
    imgui.set_next_item_width(field)
    turned, azimuth = imgui.drag_float(f"{slot.label}-azimuth", azimuth, 0.5, -720, 720, "%.1f°", _CLAMP)
    imgui.set_item_tooltip(tr("Azimuth: clockwise from north"))
    _name(tr("elevation"))
    imgui.set_next_item_width(field)
    raised, elevation = imgui.drag_float(f"{slot.label}-elevation", elevation, 0.25, -90, 90, "%.1f°", _CLAMP)
    imgui.set_item_tooltip(tr("Elevation above the horizon"))
    imgui.end_group()
    return (tidied(azimuth), tidied(elevation)) if turned or raised else result


def _name(text: str) -> None:
    """Write what a field below it is, small, close to it."""
    imgui.push_style_var(imgui.StyleVar_.item_spacing, ImVec2(0, 0))
    imgui.push_font(None, theme.SMALL)
    imgui.text_disabled(text)
    imgui.pop_font()
    imgui.pop_style_var()


def _point(parameter: Parameter, value: Value, slot: WidgetSlot) -> Value | None:
    x, y = _as_list(value)
    axes = [(low or 0.0, 1.0 if high is None else high) for low, high in map(parameter.widget.ends, range(2))]
    (west, east), (south, north) = axes
    across, up = (x - west) / (east - west), (y - south) / (north - south)
    origin, side, field, dragged = _pad(slot)
    draw = imgui.get_window_draw_list()
    corner = ImVec2(origin.x + side, origin.y + side)
    draw.add_rect_filled(origin, corner, theme.packed(theme.palette.field), 5 * slot.scale)
    dot = ImVec2(origin.x + across * side, origin.y + (1 - up) * side)
    draw.add_line(
        ImVec2(dot.x, origin.y), ImVec2(dot.x, corner.y), theme.packed(theme.palette.line), slot.scale
    )
    draw.add_line(
        ImVec2(origin.x, dot.y), ImVec2(corner.x, dot.y), theme.packed(theme.palette.line), slot.scale
    )
    draw.add_circle_filled(dot, 5 * slot.scale, theme.packed(theme.palette.warm))
    result: Value | None = None
    if dragged is not None:
        fractions = (dragged[0], 1 - dragged[1])
        point_picked = [low + (high - low) * part for (low, high), part in zip(axes, fractions, strict=True)]
        result = (_rounded(point_picked[0], axes[0]), _rounded(point_picked[1], axes[1]))
    imgui.same_line()
    imgui.begin_group()
    changed = False
    for name, unit, number, (low, high) in (("x", "E", x, axes[0]), ("y", "N", y, axes[1])):
        imgui.set_next_item_width(field)
        speed, digits = (high - low) / 500, max(_places(axes[0]), _places(axes[1])) - 1
        moved, number = imgui.drag_float(
            f"{slot.label}-{name}", number, speed, low, high, f"%.{digits}f {unit}", _CLAMP
        )
        changed = changed or moved
        x, y = (number, y) if name == "x" else (x, number)
    imgui.end_group()
    return (tidied(x), tidied(y)) if changed else result


def _places(axis: tuple[float, float]) -> int:
    """Return the places after the point that tell a ten-thousandth of a range from the next."""
    return min(max(4 - math.floor(math.log10(axis[1] - axis[0]) + 1e-9), 1), 9)


def _rounded(number: float, axis: tuple[float, float]) -> float:
    """Return a number within its range in as many places as a pad can be pointed to."""
    return min(max(round(number, _places(axis)), axis[0]), axis[1])


def _pad(slot: WidgetSlot) -> tuple[ImVec2, float, float, tuple[float, float] | None]:
    """Make a square to drag in.

    Return its upper left corner, its side, the width that is left for fields, and while it is dragged
    the mouse's fraction of it, right and down.
    """
    origin, wide = imgui.get_cursor_screen_pos(), imgui.calc_item_width()
    side = min(_PAD * slot.scale, wide)
    field = wide - side - imgui.get_style().item_spacing.x
    imgui.invisible_button(slot.label, ImVec2(side, side))
    if not imgui.is_item_active():
        return origin, side, field, None
    mouse = imgui.get_io().mouse_pos
    across, down = (mouse.x - origin.x) / side, (mouse.y - origin.y) / side
    return origin, side, field, (min(max(across, 0.0), 1.0), min(max(down, 0.0), 1.0))


def _file(parameter: Parameter, value: Value, slot: WidgetSlot) -> Value | None:
    """Draw a path to type, and a list of the images and elevation files in the sketch's folder."""
    text = str(value)
    button = imgui.get_frame_height()
    imgui.set_next_item_width(max(imgui.calc_item_width() - button, button))
    changed, typed = imgui.input_text(slot.label, text, _PATH)
    if not changed and imgui.is_item_deactivated_after_edit():
        changed = True
    if text and imgui.is_item_hovered(imgui.HoveredFlags_.for_tooltip):
        imgui.set_tooltip(_whole_path(text, parameter, slot))
    imgui.same_line(0, 0)
    chosen: str | None = None
    imgui.set_next_item_width(button)
    if imgui.begin_combo(
        f"{slot.label}-files", "", imgui.ComboFlags_.no_preview | imgui.ComboFlags_.popup_align_left
    ):
        names = _files_in(slot.folder, slot.endings)
        for name in names:
            if imgui.selectable(name, name == text)[0]:
                chosen = name
        if not names:
            none = tr("images or elevation files") if slot.endings == IMAGES else ", ".join(slot.endings)
            imgui.text_disabled(tr("no {files} next to the sketch", files=none))
        imgui.end_combo()
    if chosen is not None:
        return chosen
    return typed if changed and typed != text else None


def _whole_path(text: str, parameter: Parameter, slot: WidgetSlot) -> str:
    try:
        return str(find_file(text, str(slot.folder), parameter.file, parameter.name))
    except DataError as error:
        return str(error)


def _files_in(folder: Path, endings: tuple[str, ...]) -> list[str]:
    inside = (p for pattern in ("*", "*/*") for p in folder.glob(pattern))
    return sorted(p.relative_to(folder).as_posix() for p in inside if p.suffix.lower() in endings)[:200]


# ── between imgui's lists and parameters' values ─────────────────────────────


def _as_list(value: object) -> list[float]:
    if isinstance(value, int | float):
        return [float(value)]
    return [float(v) for v in value] if isinstance(value, Sequence) and not isinstance(value, str) else [0.0]


def _back(parameter: Parameter, numbers: Sequence[float]) -> Value:
    values: tuple[float, ...] = tuple(round(n) if is_whole(parameter.type) else tidied(n) for n in numbers)
    return values[0] if length_of(parameter.type) == 1 else values


CONTROLS: dict[str, Draw] = {
    "numbers": _numbers,
    "direction": _direction,
    "colour": _colour,
    "menu": _menu,
    "checkbox": _checkbox,
    "button": _button,
    "point": _point,
    "file": _file,
}
"""How each control is drawn."""


# ── plots ─────────────────────────────────────────────────────────────────────


_LOOKED_AT = (
    implot.Flags_.no_menus.value | implot.Flags_.no_box_select.value | implot.Flags_.no_mouse_text.value
)
"""A plot that is only looked at."""


@contextmanager
def plot(name: str, size: ImVec2, flags: int) -> Iterator[bool]:
    """Draw the block in a plot, where it is given True; ImPlot is set up by the first."""
    if implot.get_current_context() is None:
        implot.create_context()
    implot.push_style_var(implot.StyleVar_.plot_padding, ImVec2(4, 4))
    drawn = implot.begin_plot(name, size, _LOOKED_AT | flags)
    yield drawn
    if drawn:
        implot.end_plot()
    implot.pop_style_var()


def series(number: int) -> theme.Rgb:
    """Return the colour of the curve of that number."""
    colours = theme.palette.series
    return colours[number % len(colours)]


def plot_line(number: int, weight: float = 1.5) -> implot.Spec:
    """Return how the line of that number is drawn."""
    spec = implot.Spec()
    spec.line_color = ImVec4(*series(number), 1.0)
    spec.line_weight = weight
    return spec
