"""The strip's tab of a trace: which texel of which pass, what is compared with it, its calls, the probe.

Its values stand behind the lines of the code pane (``values_panel``); here is the line that the cursor is in,
with all that it gave.
"""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from imgui_bundle import ImVec2, imgui

from playground.engine.trace.probe import ProbeMap
from playground.paths import shown
from playground.studio import theme
from playground.studio.draw import Area, button, choose, draw_cross, fitting, fitting_path, wrapped
from playground.studio.interface import Tab
from playground.studio.language import counted, tr
from playground.studio.theme import Theme
from playground.studio.trace.rows import FunctionHead, Row, TraceView
from playground.studio.trace.tracing import Beside, Tracing
from playground.studio.trace.values_panel import full_text
from playground.studio.widgets import slide_whole

if TYPE_CHECKING:
    import moderngl

_SHOW, _BACK, _FIND = "Show as a map", "Back to the picture", "First texel where it is true"
_CLICK = 4.0  # that the mouse may move during a click


def trace_tab(tracing: Tracing) -> Tab:
    """Return the tab."""
    return Tab("trace", "Trace", partial(_draw, tracing))


def _draw(tracing: Tracing, look: Theme) -> None:
    if not tracing.on:
        if button(f"{tr('Trace')}###start trace", "T"):
            tracing.toggle()
        with wrapped():
            imgui.text_disabled(
                tr("Every value of the texel under the mouse, next to the lines of code that gave it")
            )
        return
    imgui.begin_child("trace", ImVec2(0, 0), imgui.ChildFlags_.nav_flattened)
    _head(tracing, look)
    _calls(tracing)
    _probe(tracing, look)
    _line(tracing, look)
    imgui.end_child()


def _head(tracing: Tracing, look: Theme) -> None:
    view, wide = tracing.view, 10 * imgui.get_font_size()
    _pass(tracing, wide)
    pinned = tracing.is_pinned
    label = tr("Unpin") if pinned else tr("Pin")
    note = tr("Stay at this texel, as by a click on the picture")
    note = tr("Trace what is under the mouse") if pinned else note
    unpin = max(_width_of(tr("Unpin")), _width_of(tr("Pin")))
    _flow(unpin)
    if button(f"{label}##pin", note, wide=unpin):
        tracing.follow() if pinned else tracing.pin_here()
    _flow(1.2 * wide)
    imgui.set_next_item_width(1.2 * wide)
    _functions(tracing)
    bad = view.trace.first_not_finite() if view is not None else None
    if _flowing(tr("! First not finite"), tr("The line that first gives NaN or infinity"), bad is not None):
        tracing.go_to_not_finite()
    if _flowing(tr("Keep"), tr("Compare what follows with this trace"), view is not None):
        tracing.keep()
    _flow(wide)
    imgui.set_next_item_width(wide)
    now = tracing.compared.beside
    beside = choose("##beside", tr("compare with: {name}", name=_beside(now)), Beside, now, name=_beside)
    if beside is not None:
        tracing.compare(beside)
    if view is not None and tracing.other() is not None:
        parts = view.difference is not None
        if _flowing(tr("≠ First difference"), tr("The first event at which the two part"), parts):
            tracing.go_to_difference()
    note = tr("It runs first, which may take a while")
    if tracing.can_be_plain and _flowing(tr("Trace its plain form"), note):
        tracing.trace_plain()
    _steps(tracing, wide)
    text, ink = state_of(tracing)
    with look.font(look.text, theme.SMALL), wrapped():
        imgui.text_colored(theme.colour(ink), text)


def _pass(tracing: Tracing, wide: float) -> None:
    spot = tracing.spot
    imgui.set_next_item_width(wide)
    chosen = choose(
        "##pass",
        spot.path if spot is not None else tr("pass"),
        tracing.under.spots,
        spot,
        name=lambda each: f"{each.path}   {each.texel[0]}, {each.texel[1]}",
        flags=imgui.ComboFlags_.height_large,
    )
    imgui.set_item_tooltip(tr("The pass that is traced, at the texel of its own under the mouse"))
    if chosen is not None:
        tracing.choose_pass(chosen.path)


def _functions(tracing: Tracing) -> None:
    view = tracing.view
    names = [*view.trace.others, *view.trace.functions] if view is not None else []
    options: list[str | None] = [None, "all", *dict.fromkeys(names)]
    chosen = _function_name(tracing.choice.function)
    if imgui.begin_combo("##functions", tr("functions: {name}", name=chosen)):
        for option in options:
            is_chosen = option == tracing.choice.function
            if imgui.selectable(_function_name(option), is_chosen)[0]:
                tracing.record(option)
        imgui.end_combo()
    imgui.set_item_tooltip(tr("Whose values are recorded; a large text with all takes seconds to compile"))


def _function_name(function: str | None) -> str:
    return {None: tr("its own file's"), "all": tr("all")}.get(function, str(function))


def _steps(tracing: Tracing, wide: float) -> None:
    """Draw the slider over the steps of a repeated pass."""
    count = tracing.repeats
    if count > 1:
        _flow(wide)
        now = count - 1 if tracing.choice.iteration is None else min(tracing.choice.iteration, count - 1)
        imgui.set_next_item_width(wide)
        number = slide_whole("##step", now + 1, (1, count), partial(_step_of, count))
        if number is not None:
            tracing.choice.iteration = None if number == count else number - 1


def _step_of(count: int, number: int) -> str:
    return tr("step {number} of {count}", number=number, count=count)


def _calls(tracing: Tracing) -> None:
    """Draw the files of the trace, and the calls that are shown, outermost first."""
    view = tracing.view
    if view is None:
        return
    imgui.set_next_item_width(imgui.get_font_size() * 13)
    closed = fitting_path(Path(tracing.caret.file).name, imgui.get_font_size() * 10.5)
    chosen = choose("##file", closed, view.paths, tracing.caret.file, name=shown)
    imgui.set_item_tooltip(tracing.caret.file)
    if chosen is not None:
        tracing.open(chosen)
    for call in view.stack():
        note = tr("line {line} of {file}", line=call.line, file=shown(call.path))
        _flow(_width_of(call.function))
        if button(f"{call.function}##call {call.index}", note):
            tracing.caret.file, tracing.caret.line, tracing.caret.is_asked = call.path, call.line, True


def _line(tracing: Tracing, look: Theme) -> None:
    """Choose what the cursor's line shows, where it begins a loop or function; write all that it gave."""
    view, caret = tracing.view, tracing.caret
    rows = view.rows(caret.file) if view is not None else ()
    if view is None or not 0 < caret.line <= len(rows):
        return
    row = rows[caret.line - 1]
    _heads(view, row)
    with look.font(look.code), wrapped():
        for item in row.items:
            ink = theme.palette.ink if item.is_finite else theme.palette.alarm
            text = full_text(item) if item.is_finite else f"! {full_text(item)}"
            imgui.text_colored(theme.colour(ink), text)


def _heads(view: TraceView, row: Row) -> None:
    """Draw the sliders behind a line of the code, for who comes here by keys."""
    wide = 13 * imgui.get_font_size()
    for at, loop in enumerate(loop for loop in row.loops if loop.count > 1):
        imgui.set_next_item_width(wide)
        words = partial(_iteration_of, loop.count)
        number = slide_whole(f"##iteration {at}", loop.chosen + 1, (1, loop.count), words)
        if number is not None:
            view.choose_iteration(loop, number - 1)
        imgui.same_line()
        imgui.set_next_item_width(wide)
        name = choose(f"##plotted {at}", loop.plotted, loop.names, loop.plotted)
        if name is not None:
            view.plot(loop, name)
    if row.head is not None and row.head.count > 1:
        imgui.set_next_item_width(wide)
        words = partial(_call_of, row.head)
        number = slide_whole("##call of line", row.head.number, (1, row.head.count), words)
        if number is not None:
            view.choose_call(row.head.key, number - 1)


def _iteration_of(count: int, number: int) -> str:
    return tr("iteration {number} of {count}", number=number, count=count)


def _call_of(head: FunctionHead, number: int) -> str:
    return tr("{name}: call {number} of {count}", name=head.key[1], number=number, count=head.count)


def _probe(tracing: Tracing, look: Theme) -> None:
    """Draw the field of an expression, and what shows it."""
    where = tr("after line {line}", line=tracing.caret.line) if tracing.caret.line else tr("after a line")
    shows = isinstance(tracing.session.view.map, ProbeMap)
    labels = tr(_BACK) if shows else tr(_SHOW), tr(_FIND)
    imgui.align_text_to_frame_padding()
    imgui.text_disabled(tr("Probe"))
    imgui.same_line()
    wide = imgui.calc_text_size(where).x + imgui.get_style().item_spacing.x
    if not _probe_is_broken():
        wide += sum(_width_of(label) + imgui.get_style().item_spacing.x for label in labels)
    imgui.set_next_item_width(-wide)
    with look.font(look.code):
        hint = tr("an expression: select it in a line, or type it")
        probe = tracing.probe
        _, probe.expression = imgui.input_text_with_hint("##probe", hint, probe.expression)
    imgui.same_line()
    imgui.text_disabled(where)
    if not _probe_is_broken():
        imgui.same_line()
    can = bool(tracing.caret.line and tracing.probe.expression.strip())
    if shows:
        if button(tr(_BACK), tr("The sketch's own view again")):
            tracing.session.show(None)
    elif button(tr(_SHOW), tr("Its value in every texel; legend and histogram: in the panel"), enabled=can):
        tracing.show_probe()
    imgui.same_line()
    if button(tr(_FIND), tr("The first texel, from the south-west, where it is not 0"), enabled=can):
        tracing.show_probe(find=True)
    if tracing.probe.message:
        with look.font(look.text, theme.SMALL):
            text = tracing.probe.message
            room = imgui.get_content_region_avail().x
            imgui.text_colored(theme.colour(theme.palette.warm), fitting(text.replace("\n", "  "), room))
            imgui.set_item_tooltip(text)


def _probe_is_broken() -> bool:
    """Return whether the probe's buttons need a line of their own."""
    return imgui.get_window_width() < 46 * imgui.get_font_size()


def _width_of(label: str) -> float:
    return imgui.calc_text_size(label).x + 2 * imgui.get_style().frame_padding.x


def _flow(wide: float) -> None:
    """Go on in the same line where what comes has room in it."""
    imgui.same_line()
    if imgui.get_content_region_avail().x < wide:
        imgui.new_line()


def _flowing(label: str, note: str, enabled: bool = True) -> bool:
    """Draw a button in the same line, or in the next; return whether it is pressed."""
    _flow(_width_of(label))
    return button(label, note, enabled=enabled)


# ── texts ─────────────────────────────────────────────────────────────────────


def state_of(tracing: Tracing) -> tuple[str, theme.Rgb]:
    """Return what is traced or why it is not, and the colour to write it in."""
    view = tracing.view
    if tracing.compiler.compiles:
        return tr("compiling {name} …", name=tracing.compiler.compiles), theme.palette.warm
    if tracing.message:
        return tracing.message, theme.palette.warm
    if view is None:
        return (
            tr("a click on the picture pins a texel; Shift+click compares it with the one before"),
            theme.palette.dim,
        )
    trace = view.trace
    values, calls = counted(len(trace.events), "value"), counted(len(trace.calls), "call")
    parts = [tr("{values} of {calls}", values=values, calls=calls)]
    if not trace.is_complete:
        parts.append(tr("cut at the limit of events"))
    if trace.is_discarded:
        parts.append(tr("the run ends in a discard"))
    elif trace.is_exact:
        parts.append(tr("its result is the texel's, bit for bit"))
    else:
        parts.append(tr("its result differs from the texel's: the driver rounds a recorded sum otherwise"))
    if tracing.other() is None:
        missing = {Beside.KEPT: tr("nothing is kept yet"), Beside.SAVE: tr("nothing was saved since")}
        parts += [missing[tracing.compared.beside]] if tracing.compared.beside in missing else []
    else:
        parts.append(tr("both run alike") if view.difference is None else f"≠ {other_name(tracing)}")
    return "   ".join(parts), theme.palette.dim


def other_name(tracing: Tracing) -> str:
    """Return what is beside a trace: its texel, where it is another, or the save before."""
    other = tracing.other()
    if other is None or tracing.compared.beside is Beside.SAVE:
        return tr("before the last save")
    texel = f"{other.texel[0]}, {other.texel[1]}"
    return tr("{name} at {texel}, kept", name=other.step, texel=texel)


def _beside(beside: Beside) -> str:
    return tr(beside.value)


def act_on_picture(tracing: Tracing, picture: moderngl.Texture | None, area: Area, density: float) -> None:
    """Take the texel under the mouse, and pin it at a click; with Shift, keep the one before beside it."""
    io = imgui.get_io()
    if not tracing.on or picture is None or io.want_capture_mouse or io.key_ctrl:
        return
    x, y = int((io.mouse_pos.x - area[0]) * density // 1), int((io.mouse_pos.y - area[1]) * density // 1)
    pixel = x, picture.size[1] - 1 - y
    if not (0 <= pixel[0] < picture.size[0] and 0 <= pixel[1] < picture.size[1]):
        return
    gone = imgui.get_mouse_drag_delta(0, 0.0)
    if imgui.is_mouse_released(0) and math.hypot(gone.x, gone.y) < _CLICK:
        if io.key_shift:
            tracing.keep()
        tracing.pin_at(pixel, picture.size)
    elif not imgui.is_mouse_down(0):
        tracing.point(pixel)


def draw_mark(tracing: Tracing, look: Theme, area: Area) -> None:
    """Draw a cross on the picture where a place is pinned."""
    mark = tracing.mark(area[2:]) if tracing.on else None
    if mark is None:
        return
    x, y = area[0] + mark[0] * area[2], area[1] + (1 - mark[1]) * area[3]
    draw_cross(imgui.get_background_draw_list(), (x, y), theme.DARK.warm, 10.0, look)
