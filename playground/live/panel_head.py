"""The top of the panel: title, undo, chance, resets, time, presets, what is shown, the search."""

from __future__ import annotations

from imgui_bundle import ImVec2, imgui

from playground.errors import counted
from playground.live import theme
from playground.live.panel_memory import Memory
from playground.live.panel_rows import fitting, fitting_choice, row
from playground.live.sliders import slide
from playground.live.text_field import letters, with_typed_ahead
from playground.live.theme import Theme
from playground.paths import shown
from playground.sketch.model import Preset, Sketch
from playground.sketch.values import spell, write
from playground.workbench.actions import Actions
from playground.workbench.history import in_words
from playground.workbench.parameter_list import Filter, Item, set_words
from playground.workbench.random_targets import targets
from playground.workbench.randomise import at_random, mutated
from playground.workbench.save_commands import copy_toml, save_a_copy, save_as_preset, save_values

_OWN_VIEW = "its own view"
_CLOSER = 2.5  # [units of scale 1]
_LISTED = 14  # steps of the history that show without scrolling


def draw_head(memory: Memory, actions: Actions, look: Theme) -> None:
    """Draw what stands above the passes."""
    session, sketch = actions.session, actions.session.sketch
    with look.font(look.bold, theme.TEXT_SIZE + 2):
        imgui.text_wrapped((sketch.title.strip() if sketch else "") or session.path.stem)
    with look.font(look.text, theme.SMALL):
        style = imgui.get_style()
        room = imgui.get_content_region_avail().x
        button = imgui.calc_text_size("Lessons").x + 2 * style.frame_padding.x
        start = imgui.get_cursor_pos_x()
        imgui.text_disabled(fitting(shown(session.path), room - button - style.item_spacing.x))
        imgui.set_item_tooltip(str(session.path))
        imgui.same_line(start + room - button)
        if imgui.small_button("Lessons"):
            actions.toggle_lessons()
        imgui.set_item_tooltip("What there is to know of terrain, step by step (F2)")
    if sketch is None:
        return
    _buttons(memory, actions, look)
    if sketch.presets:
        _presets(sketch, memory, actions)
    _shown(actions)


def _buttons(memory: Memory, actions: Actions, look: Theme) -> None:
    """Draw two lines of buttons, closer than elsewhere: so both fit."""
    style = imgui.get_style()
    padding, spacing = style.frame_padding, style.item_spacing
    closer = _CLOSER * look.scale
    imgui.push_style_var(imgui.StyleVar_.frame_padding, ImVec2(padding.x - closer, padding.y))
    imgui.push_style_var(imgui.StyleVar_.item_spacing, ImVec2(spacing.x - closer, spacing.y))
    _undo(memory, actions, look)
    imgui.same_line()
    _chance(memory, actions, look)
    imgui.same_line()
    if imgui.button("A/B"):
        actions.see.compare.toggle()
    imgui.set_item_tooltip("Keep this as A, go on with B, and compare the two; or no longer (A)")
    _resets(actions)
    imgui.same_line()
    _copies(memory, actions)
    imgui.same_line()
    _saves(memory, actions)
    imgui.same_line()
    if imgui.button("PNG"):
        actions.save_picture()
    imgui.set_item_tooltip(f"Save the picture as a new file in {actions.folder} (S)")
    imgui.same_line()
    if imgui.button("Capture"):
        actions.capture.shown = True
    imgui.set_item_tooltip("Large pictures, numbered ones, films, sheets of a sweep (C)")
    imgui.same_line()
    if imgui.button("Graph"):
        actions.see.graph.toggle()
    imgui.set_item_tooltip("The passes as a graph, or no longer (G)")
    imgui.pop_style_var(2)


def draw_search(memory: Memory, actions: Actions) -> None:
    """Draw the search, and the switch that leaves only what is changed."""
    style = imgui.get_style()
    only = "Changed"
    wide = imgui.calc_text_size(only).x + imgui.get_frame_height() + style.item_inner_spacing.x
    if memory.focus_search:
        imgui.set_keyboard_focus_here()
        memory.focus_search = False
    imgui.set_next_item_width(-wide - style.item_spacing.x)
    flags = imgui.InputTextFlags_.escape_clears_all
    typed = letters()
    _, text = imgui.input_text_with_hint("##search", "Search  /", memory.filter.search, flags)
    text = with_typed_ahead(actions, text, memory.filter.search, typed)
    imgui.set_item_tooltip("By label, name, pass, group or description; Esc ends it")
    imgui.same_line()
    _, changed = imgui.checkbox(f"{only}##only", memory.filter.changed)
    imgui.set_item_tooltip("Only what differs from the file")
    if (text, changed) != (memory.filter.search, memory.filter.changed):
        memory.filter = Filter(text, changed)


# ── undo ─────────────────────────────────────────────────────────────────────


def _undo(memory: Memory, actions: Actions, look: Theme) -> None:
    history = actions.history
    imgui.begin_disabled(not history.can_undo and not actions.painting.on)
    if imgui.button("Undo"):
        actions.undo()
    imgui.end_disabled()
    imgui.set_item_tooltip("Ctrl+Z")
    imgui.same_line()
    imgui.begin_disabled(not history.can_redo and not actions.painting.on)
    if imgui.button("Redo"):
        actions.redo()
    imgui.end_disabled()
    imgui.set_item_tooltip("Ctrl+Shift+Z, Ctrl+Y")
    imgui.same_line()
    if imgui.button("History"):
        imgui.open_popup("history")
    imgui.set_item_tooltip("Every step; click on one to go there")
    if imgui.begin_popup("history"):
        draw_history(memory, actions, look)
        imgui.end_popup()


def draw_history(memory: Memory, actions: Actions, look: Theme) -> None:
    """Draw the list of steps, oldest first; what is undone is dimmed."""
    history, items = actions.history, _items(memory, actions)
    room = imgui.get_main_viewport().size
    lines = min(len(history.steps) + 1, _LISTED)
    wide, high = min(300 * look.scale, room.x - 60), lines * imgui.get_frame_height() + 10
    imgui.begin_child("steps", ImVec2(wide, min(high, room.y - 120)))
    if imgui.selectable("As it was opened" if len(history.steps) < 200 else "Before", history.done == 0)[0]:
        actions.go_to(0)

    def name_of(path: str) -> str:
        return items[path].parameter.title if path in items else path

    def said(path: str, value: object) -> str:
        if value is None:
            return "the file's"
        known = items.get(path)
        return write(known.parameter, value) if known else spell(value)  # type: ignore[arg-type]

    for number, step in enumerate(history.steps, 1):
        text = fitting(in_words(step, name_of, said), wide - 20 * look.scale)
        done, latest = number <= history.done, number == history.done
        imgui.push_style_color(imgui.Col_.text, theme.colour(theme.INK if done else theme.DIM))
        if imgui.selectable(f"{text}##{number}", latest)[0]:
            actions.go_to(number)
        imgui.pop_style_color()
        if latest and imgui.is_window_appearing():
            imgui.set_scroll_here_y()
    imgui.end_child()


# ── chance ───────────────────────────────────────────────────────────────────


def _chance(memory: Memory, actions: Actions, look: Theme) -> None:
    if imgui.button("Random"):
        imgui.open_popup("chance")
    imgui.set_item_tooltip("Values by chance, from a seed")
    if not imgui.begin_popup("chance"):
        return
    session, draft = actions.session, actions.session.shown
    _, memory.seed = imgui.input_int("Seed", memory.seed)
    strength = slide("##strength", memory.strength, (0.01, 0.5), "%.2f")
    memory.strength = memory.strength if strength is None else strength
    imgui.same_line(0, imgui.get_style().item_inner_spacing.x)
    imgui.text_unformatted("Strength")
    imgui.set_item_tooltip("Of a mutation: how far a value goes, in shares of its range")
    imgui.begin_disabled(bool(memory.filter))
    _, memory.everything = imgui.checkbox("Everything", memory.everything)
    imgui.end_disabled()
    imgui.set_item_tooltip("Also colours, light, the view and what reads files; else the shape alone")
    drawn, what = targets(draft, memory.listing, memory.filter, everything=memory.everything)
    if draft is not None and session.sketch is not None:
        values = memory.listing.values(draft)
        if imgui.button("Random values"):
            actions.set_all(f"Random, seed {memory.seed}", at_random(drawn, memory.seed))
            memory.seed += 1
        imgui.same_line()
        if imgui.button("Mutate"):
            near = mutated(drawn, values.of, memory.seed, memory.strength)
            actions.set_all(f"Mutation, seed {memory.seed}", near)
            memory.seed += 1
    imgui.text_disabled(f"{counted(len(drawn), 'parameter')}: {what}")
    imgui.end_popup()


# ── resets, copies ───────────────────────────────────────────────────────────


def _resets(actions: Actions) -> None:
    session = actions.session
    if imgui.button("Reset"):
        imgui.open_popup("resets")
    imgui.set_item_tooltip("Back to what the file says")
    if not imgui.begin_popup("resets"):
        return
    edits = session.shown.edits if session.shown else None
    touched = edits is not None and bool(edits.values or edits.techniques or session.view.steps)
    if imgui.menu_item_simple("View", "R", False, edits is not None and edits.camera is not None):
        session.drafts.set_camera(None)
    if imgui.menu_item_simple("All values and techniques", "", False, touched):
        actions.reset_values()
    if imgui.menu_item_simple("Locks", "", False, edits is not None and bool(edits.locked)):
        for path in edits.locked if edits is not None else ():
            session.drafts.lock(path, False)
    imgui.end_popup()


def _copies(memory: Memory, actions: Actions) -> None:
    if imgui.button("Copy"):
        imgui.open_popup("copies")
    imgui.set_item_tooltip("What differs from the file, to the clipboard")
    if not imgui.begin_popup("copies"):
        return
    draft = actions.session.shown
    if draft is not None and imgui.menu_item_simple("As --set words", "", False, bool(draft.applied)):
        text = set_words(draft, memory.listing.values(draft))
        imgui.set_clipboard_text(text)
        actions.say(f"copied {fitting(text, 320.0)}")
    if imgui.menu_item_simple("As TOML"):
        copy_toml(actions, imgui.set_clipboard_text)
    imgui.end_popup()


def _saves(memory: Memory, actions: Actions) -> None:
    if imgui.button("Save"):
        imgui.open_popup("saves")
    imgui.set_item_tooltip("What differs from the file, into the file")
    if imgui.begin_popup("saves"):
        if imgui.menu_item_simple("Into the sketch", "Ctrl+S"):
            save_values(actions)
        if imgui.menu_item_simple("As a copy in the current folder"):
            save_a_copy(actions)
        imgui.separator()
        imgui.set_next_item_width(imgui.get_font_size() * 9)
        flags = imgui.InputTextFlags_.enter_returns_true
        hint = "name of a preset"
        entered, memory.preset_name = imgui.input_text_with_hint("##name", hint, memory.preset_name, flags)
        imgui.same_line()
        imgui.begin_disabled(not memory.preset_name.strip())
        if imgui.button("Save preset") or (entered and memory.preset_name.strip()):
            save_as_preset(actions, memory.preset_name)
            memory.preset = memory.preset_name.strip()
            imgui.close_current_popup()
        imgui.end_disabled()
        imgui.end_popup()
    if actions.opening == "offer":
        actions.opening = ""
        imgui.open_popup("offer")
    if imgui.begin_popup("offer"):
        imgui.text_unformatted(actions.offer)
        done = imgui.button("Save a copy")
        imgui.set_item_tooltip(f"A new folder in {actions.folder}")
        if done:
            save_a_copy(actions)
        imgui.same_line()
        if imgui.button("Cancel") or done:
            actions.offer = ""
            imgui.close_current_popup()
        imgui.end_popup()


# ── rows ─────────────────────────────────────────────────────────────────────


def _presets(sketch: Sketch, memory: Memory, actions: Actions) -> None:
    held = next((p for p in sketch.presets if _differing(sketch, p) == []), None)
    if held is not None:
        memory.preset = held.name
    last = next((p for p in sketch.presets if p.name == memory.preset), None)
    off = _differing(sketch, last) if last is not None and held is None else []
    note = "Values that go together"
    if off and last is not None:
        note += f"\nChanged since {last.name}: {', '.join(off)}"
    with row("Preset", note, edited=bool(off), fixed=True):
        text = held.name if held else f"{last.name}, changed" if last else "choose"
        if imgui.begin_combo("##preset", fitting_choice(text)):
            for preset in sketch.presets:
                if imgui.selectable(preset.name, preset is held)[0]:
                    memory.preset = preset.name
                    actions.apply_preset(preset.name)
            imgui.end_combo()


def _differing(sketch: Sketch, preset: Preset) -> list[str]:
    """Return the paths of a preset that are set otherwise."""
    overrides = dict(sketch.overrides)
    if not preset.values:
        return [preset.name]
    return [path for path, value in preset.values if overrides.get(path) != value]


def _shown(actions: Actions) -> None:
    session = actions.session
    with row("Show", "The sketch's own view, or any texture seen from above (M)", fixed=True):
        if imgui.begin_combo(
            "##shown", fitting_choice(ref_name(session.view.map.ref) if session.view.map else _OWN_VIEW)
        ):
            if imgui.selectable(_OWN_VIEW, session.view.map is None)[0]:
                actions.show(None)
            for ref in session.refs:
                now = session.view.map is not None and session.view.map.ref == ref
                if imgui.selectable(ref_name(ref), now)[0]:
                    actions.show(ref)
            imgui.end_combo()


def ref_name(ref: str) -> str:
    """Return a texture's name without what is said twice: "height:height" is "height"."""
    path, _, output = ref.partition(":")
    return path if path.rpartition(".")[2] == output else ref


def _items(memory: Memory, actions: Actions) -> dict[str, Item]:
    draft = actions.session.shown
    sections = memory.listing.sections(draft) if draft is not None else ()
    return {item.path: item for section in sections for item in section.items}
