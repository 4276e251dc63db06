"""The list of techniques that a pass may be added of: a search, a picture and a sentence of each."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from playground.studio import theme
from playground.studio.bench import Workbench
from playground.studio.draw import await_field, fitting, letters, pushed_id, with_typed_ahead
from playground.studio.graph.edits import Entry, fit
from playground.studio.graph.graph import Graph, Wiring
from playground.studio.language import tr, tr_label
from playground.studio.theme import Theme

_WIDE, _HIGH, _ROW = 460.0, 400.0, 46.0
_PICTURE = (72.0, 40.5)
_POPUP = "add a pass"
_READING = 0.03  # [s] of a frame that techniques are read


def draw_chooser(bench: Workbench, wiring: Wiring, look: Theme) -> None:
    """Draw it while it is open; what is chosen in it is added."""
    graph = bench.inspection.graph
    chooser = graph.chooser
    if chooser.opens:
        imgui.open_popup(_POPUP)
        await_field(bench.interface.ahead)
    if not chooser.is_open:
        return
    room, mouse, scale = imgui.get_main_viewport().size, imgui.get_mouse_pos(), look.scale
    wide, high = min(_WIDE * scale, room.x - 16), min(_HIGH * scale, room.y - 16)
    x = min(max(mouse.x - wide / 2, 8.0), room.x - wide - 8)
    y = min(max(mouse.y - high - 12, 8.0), room.y - high - 8)
    imgui.set_next_window_pos(ImVec2(x, y), imgui.Cond_.appearing)
    imgui.set_next_window_size(ImVec2(wide, high))
    if not imgui.begin_popup(_POPUP):
        chooser.is_open = chooser.opens
        chooser.opens = False
        return
    chooser.catalogue.go_on(chooser.search, _READING)
    _search(bench, graph)
    entries, outputs = graph.entries(wiring), chooser.outputs(wiring)
    chooser.marked = min(max(chooser.marked + _stepped(), 0), max(len(entries) - 1, 0))
    chosen = _rows(entries, outputs, graph, look)
    enters = imgui.is_key_pressed(imgui.Key.enter, False) or imgui.is_key_pressed(
        imgui.Key.keypad_enter, False
    )
    if enters and entries:
        chosen = entries[chooser.marked]
    if imgui.is_key_pressed(imgui.Key.escape, repeat=False):  # out of its search, and out of it
        imgui.close_current_popup()
    if chosen is not None:
        imgui.close_current_popup()
        chooser.is_open = False
        on = (chooser.on.reader, chooser.on.input) if chooser.on is not None else None
        name = bench.passes.add(chosen.use, chooser.after, chooser.output, between=not chooser.output, on=on)
        graph.chosen, graph.wire = name or graph.chosen, None
        graph.has_keys = True
    imgui.end_popup()


def _search(bench: Workbench, graph: Graph) -> None:
    chooser = graph.chooser
    where = chooser.after + (f":{chooser.output}" if chooser.output else "")
    words = tr("A pass after {name}", name=where) if where else tr("A pass before the view")
    if chooser.on is not None:
        words = tr("A pass between {giver} and {reader}", giver=chooser.on.giver, reader=chooser.on.reader)
    imgui.text_disabled(words)
    if chooser.opens:
        imgui.set_keyboard_focus_here()
        chooser.opens = False
    imgui.set_next_item_width(-1)
    typed = letters()
    hint = tr("Search by name or by what it does")
    _, text = imgui.input_text_with_hint("##find a technique", hint, chooser.search)
    text = with_typed_ahead(bench.interface.ahead, text, chooser.search, typed)
    if text != chooser.search:
        chooser.search, chooser.marked = text, 0


def _stepped() -> int:
    return int(imgui.is_key_pressed(imgui.Key.down_arrow)) - int(imgui.is_key_pressed(imgui.Key.up_arrow))


def _rows(entries: list[Entry], outputs: tuple[str, ...], graph: Graph, look: Theme) -> Entry | None:
    """Draw the rows in sight; return the one that is clicked on."""
    chooser, row, chosen = graph.chooser, _ROW * look.scale, None
    imgui.begin_child("techniques", ImVec2(0, 0))
    if not entries:
        waits = not chooser.catalogue.is_whole
        imgui.text_disabled(tr("techniques are being read…") if waits else tr("no technique matches"))
    step = row + imgui.get_style().item_spacing.y
    top, room = imgui.get_scroll_y(), imgui.get_window_height()
    for number, entry in enumerate(entries):
        if number == chooser.marked and _stepped():
            if number * step < top:
                imgui.set_scroll_y(number * step)
            elif (number + 1) * step > top + room:
                imgui.set_scroll_y((number + 1) * step - room)
        if not top - step < number * step < top + room:
            imgui.dummy(ImVec2(1, row))
            continue
        with pushed_id(entry.use):
            if _draw_row(entry, outputs, graph, look, marked=number == chooser.marked):
                chosen = entry
    imgui.end_child()
    return chosen


def _draw_row(entry: Entry, outputs: tuple[str, ...], graph: Graph, look: Theme, *, marked: bool) -> bool:
    scale, palette = look.scale, theme.palette
    corner, wide = imgui.get_cursor_screen_pos(), imgui.get_content_region_avail().x
    clicked = imgui.selectable(f"##add {entry.use}", marked, 0, ImVec2(0, _ROW * scale))[0]
    if imgui.is_item_hovered(imgui.HoveredFlags_.for_tooltip):
        imgui.set_tooltip(f"{entry.use}\n{', '.join(entry.inputs) or '–'} → {', '.join(entry.outputs)}")
    draw, picture = imgui.get_window_draw_list(), graph.pictures.get(entry.use)
    low = ImVec2(corner.x + 2 * scale, corner.y + 2.5 * scale)
    far = ImVec2(low.x + _PICTURE[0] * scale, low.y + _PICTURE[1] * scale)
    if picture is not None:
        texture, (left, above, right, below) = picture
        draw.add_image(imgui.ImTextureRef(texture.glo), low, far, ImVec2(left, above), ImVec2(right, below))
    else:
        draw.add_rect(low, far, theme.packed(palette.line), 3 * scale)
    x, room = far.x + 10 * scale, wide - _PICTURE[0] * scale - 20 * scale
    taken = next((name for name in outputs if name in entry.inputs), "") if fit(entry, outputs) < 2 else ""
    if taken:
        note = tr("takes {name}", name=taken)
        size = imgui.calc_text_size(note)
        draw.add_text(ImVec2(corner.x + wide - size.x - 4 * scale, low.y), theme.packed(palette.accent), note)
        room -= size.x
    with look.font(look.bold):
        name = fitting(entry.name, room)
        draw.add_text(ImVec2(x, low.y), theme.packed(palette.ink), name)
        after = imgui.calc_text_size(name).x
    folder = fitting(entry.use.rpartition("/")[0], max(room - after - 10 * scale, 1.0))
    draw.add_text(ImVec2(x + after + 8 * scale, low.y), theme.packed(palette.dim), folder)
    title = fitting(tr_label(entry.title), wide - _PICTURE[0] * scale - 20 * scale)
    draw.add_text(ImVec2(x, low.y + 21 * scale), theme.packed(palette.ink), title)
    return bool(clicked)
