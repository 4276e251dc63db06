"""Draw numbers to slide, drag or step: the knob leaves the number free, and each part of a vector is named.

A number that would lie under its slider's knob moves to the wider side of the knob. The parts of
a vector are one below the other, so that each has a name and room for its number.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from imgui_bundle import ImVec2, imgui

from playground.shader.parameter import is_whole, part_names
from playground.shader.widgets import fraction_of
from playground.sketch.model import Parameter
from playground.studio import theme
from playground.studio.panel.number_format import format_of, snapped, unit_of

_CLAMP = imgui.SliderFlags_.always_clamp.value
_LOGARITHMIC = imgui.SliderFlags_.logarithmic.value
_PLAIN = imgui.SliderFlags_.no_input.value  # the panel has a field of its own, which reads expressions
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
    column = min(max(imgui.calc_text_size(name).x for name in names) + spacing, wide / 2)
    largest = max(abs(n) for n in numbers)
    values: list[float] | None = None
    imgui.begin_group()
    for at, name in enumerate(names):
        imgui.align_text_to_frame_padding()
        imgui.text_disabled(name)
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
    flags = _CLAMP | (_LOGARITHMIC if logarithmic else 0) | (0 if typed else _PLAIN)
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
        changed, now = imgui.slider_int(label, number, low, high, "%d", _CLAMP | (0 if typed else _PLAIN))
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
        imgui.push_style_color(imgui.Col_.text, theme.colour(theme.INK, 0.0))
    yield hidden
    if hidden:
        imgui.pop_style_color()


def _write_number(text: str, share: float, values: int = 0) -> None:
    """Write a number on the slider that was drawn last, clear of the knob; see ``knob_of``."""
    left, right = imgui.get_item_rect_min(), imgui.get_item_rect_max()
    size, style = imgui.calc_text_size(text), imgui.get_style()
    knob = knob_of(share, right.x - left.x, style.grab_min_size, values)
    across = place_of_number(right.x - left.x, size.x, knob, style.item_inner_spacing.x / 2)
    position = ImVec2(round(left.x + across), round((left.y + right.y - size.y) / 2))
    draw = imgui.get_window_draw_list()
    draw.push_clip_rect(left, right, True)
    draw.add_text(position, imgui.get_color_u32(imgui.Col_.text), text)
    draw.pop_clip_rect()


def knob_of(share: float, wide: float, least: float, values: int = 0) -> tuple[float, float]:
    """Return where imgui draws the knob of a slider ``wide`` across: its left and its right end.

    ``share`` of its way is gone; the knob is ``least`` wide or, where it goes through so many whole
    ``values``, as wide as one of them.
    """
    room = wide - 2 * _EDGE
    across = min(max(room / values if values else 0.0, least), room)
    start = _EDGE + share * (room - across)
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
        changed, now = imgui.drag_int(label, int(number), max(speed, 0.2), -_WHOLE, _WHOLE, form, _PLAIN)
        return float(now) if changed else None
    form = "%.6g" + _unit_format(parameter)
    changed, dragged = imgui.drag_float(label, number, speed, 0.0, 0.0, form, _PLAIN)
    return dragged if changed else None


def _step(parameter: Parameter, number: float, label: str) -> float | None:
    # A double holds every 32-bit number, signed or not.
    step = parameter.step or 1.0
    changed, typed = imgui.input_double(label, number, step, 10 * step, f"%.0f{_unit_format(parameter)}")
    low, high = (0, 2**32 - 1) if parameter.type == "uint" else (-(2**31), 2**31 - 1)
    return float(min(max(round(typed), low), high)) if changed else None


def _unit_format(parameter: Parameter) -> str:
    return unit_of(parameter).replace("%", "%%")
