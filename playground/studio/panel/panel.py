"""The panel: what can be changed, made from the sketch's own annotations.

From the top: title, what it is about, undo, resets, time and presets; which texture is shown; a search; a
section a pass, with its technique and parameters; what each pass cost. What a
technique exports comes first, what is inside is folded.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from imgui_bundle import ImVec2, imgui

from playground.paths import shown
from playground.shader.parameter import spell, write
from playground.sketch.model import Preset, Sketch
from playground.studio import theme
from playground.studio.actions import Actions
from playground.studio.bench import Workbench
from playground.studio.cost.panel import draw_costs
from playground.studio.draw import (
    SIDE_PANEL,
    await_field,
    button,
    buttons,
    choose,
    ctrl_held,
    disabled,
    first_lines,
    fitting,
    fitting_choice,
    fitting_path,
    inked,
    letters,
    menu,
    next_in_row,
    place_side_panel,
    row,
    styled,
    with_typed_ahead,
    wrapped,
)
from playground.studio.edits.edits import Edits
from playground.studio.edits.history import step_label
from playground.studio.edits.undo import Undo
from playground.studio.inspect.inspection import Inspection
from playground.studio.inspect.panel import draw_spread
from playground.studio.interface import TypedAhead
from playground.studio.keyframes.panel import KeyframeList
from playground.studio.keys import all_keys
from playground.studio.language import counted, shortcut, tr, tr_label
from playground.studio.paint.panel import draw_paintbox
from playground.studio.panel.about import about
from playground.studio.panel.parameter_list import Filter, PanelState, items_of, set_words, shown_values
from playground.studio.panel.passes_panel import Sections
from playground.studio.panel.randomise import at_random, mutated, targets
from playground.studio.picture.view import ref_name
from playground.studio.session import Session
from playground.studio.settings_panel import draw_settings, settings_label
from playground.studio.theme import Theme
from playground.studio.widgets import WidgetSlot, draw_value, explanation, slide

_LOW = 400.0
"""[units of scale 1] of a window's height below which the head scrolls with the rest."""


_WIDTH = "panel width"  # [units of scale 1] among what panes remember


@dataclass
class Panel:
    """The panel's own memory: what is searched for and typed in it."""

    memory: PanelState = field(default_factory=PanelState)

    def __post_init__(self) -> None:
        self._sections = Sections(self.memory)
        self._keyframes = KeyframeList()
        self._pulled = 0.0  # [units of scale 1] to which width its edge is pulled; 0: nobody pulls it

    def draw(self, bench: Workbench, look: Theme, left: float = 0.0) -> float:
        """Draw the panel over the window's left side; return the width it takes, in the window's units.

        ``left``: what is taken there already.
        """
        room, panes = imgui.get_main_viewport().size, bench.panes
        steps, chosen = panes.take_steps("panel"), self._pulled or panes.fraction(_WIDTH, theme.PANEL_WIDTH)
        target = place_side_panel(chosen, (240, 620), look, left=left, beside=160, steps=steps)
        imgui.begin("panel", None, SIDE_PANEL)
        if bench.interface.searching and not bench.interface.keymap_shown:
            bench.interface.searching, self.memory.focus_search = False, True
            await_field(bench.interface.ahead)
        sketch, footer = bench.session.sketch, _footer_lines(bench.session.orbits, look)
        scrolls_whole = room.y < _LOW * look.scale
        if not scrolls_whole:
            self._draw_head(bench, look)
        bar = imgui.WindowFlags_.always_vertical_scrollbar if sketch is not None else 0
        below = 0.0 if scrolls_whole else -_footer_height(footer, look)
        imgui.begin_child("sections", ImVec2(0, below), imgui.ChildFlags_.nav_flattened, bar)
        if scrolls_whole:
            self._draw_head(bench, look)
        if bench.inspection.costs_asked:
            self.memory.filter = Filter()
        if sketch is not None:
            if not self.memory.filter:
                _map(bench.session, bench.inspection, look)
            self._sections.draw(sketch, bench, look)
            if not self.memory.filter:
                self._keyframes.draw(bench.keyframes, look)
                draw_costs(sketch, bench.session, bench.inspection, look)
        if scrolls_whole:
            _footer(footer, look)
        imgui.end_child()
        if not scrolls_whole:
            _footer(footer, look)
        width = imgui.get_window_size().x
        imgui.end()
        if width != target:  # a narrow window alone makes it no narrower for good
            self._pulled = width / look.scale
        elif self._pulled and not imgui.is_mouse_down(0):
            panes.remember(_WIDTH, self._pulled)
            self._pulled = 0.0
        return width

    def _draw_head(self, bench: Workbench, look: Theme) -> None:
        draw_head(self.memory, bench, look)
        if bench.session.sketch is not None:
            draw_paintbox(bench.painting, look)
            draw_search(self.memory, bench.interface.ahead)


def _map(session: Session, inspection: Inspection, look: Theme) -> None:
    """Draw how the map is shown, while there is one."""
    shown = session.view.map
    if shown is None:
        return
    for parameter in shown.kernel.parameters:
        path, value = f"map.{parameter.name}", shown.value(parameter.name)
        with row(tr_label(parameter.title), explanation(parameter, path)):
            changed = draw_value(parameter, value, WidgetSlot(f"##{path}", look.scale, Path()))
        if changed is not None:
            session.view.set_map(parameter.name, changed)
    if imgui.button(tr("Fit to the values")):
        session.fit_map()
    draw_spread(session, inspection, look)


def _footer_lines(orbits: bool, look: Theme) -> tuple[str, str]:
    """Return the lines at the bottom: what the mouse does, and the keys used most, none broken in itself."""
    mouse = tr("Drag to orbit, Shift to pan, Ctrl for the sun, wheel to zoom") if orbits else ""
    lines, wide = [""], imgui.get_content_region_avail().x
    with look.font(look.text, theme.SMALL):
        for key in filter(lambda key: key.brief, all_keys()):
            text = f"{shortcut(key.name)} {tr(key.brief)}"
            longer = f"{lines[-1]}   {text}".strip()
            lines[-1:] = [longer] if imgui.calc_text_size(longer).x <= wide else [lines[-1], text]
    return mouse, "\n".join(lines)


def _footer_height(lines: tuple[str, str], look: Theme) -> float:
    """Return the room that the lines take: in a narrow panel they are broken."""
    wide, gap = imgui.get_content_region_avail().x, imgui.get_style().item_spacing.y
    with look.font(look.text, theme.SMALL):
        return sum(imgui.calc_text_size(line, False, wide).y + gap for line in lines) + 2 * gap


def _footer(lines: tuple[str, str], look: Theme) -> None:
    imgui.separator()
    with look.font(look.text, theme.SMALL):
        with wrapped():
            for line in lines:
                imgui.text_disabled(line)


# ── the head ──────────────────────────────────────────────────────────────────


_CLOSER = 2.5  # [units of scale 1]
_ABOUT_LINES = 2
_LISTED = 14  # steps of the history that show without scrolling


def draw_head(memory: PanelState, bench: Workbench, look: Theme) -> None:
    """Draw what is above the passes."""
    session, sketch = bench.session, bench.session.sketch
    path = session.drafts.shown_path
    with look.font(look.bold, theme.TEXT_SIZE + 2):
        imgui.text_wrapped((tr_label(sketch.title.strip()) if sketch else "") or path.stem)
    with look.font(look.text, theme.SMALL):
        style = imgui.get_style()
        room = imgui.get_content_region_avail().x
        buttons = [addition for addition in bench.additions if addition.button]
        labels = [*(tr(addition.button) for addition in buttons), settings_label()]
        widths = [imgui.calc_text_size(label, True).x + 2 * style.frame_padding.x for label in labels]
        wide = sum(widths) + style.item_spacing.x * (len(labels) - 1)
        start = imgui.get_cursor_pos_x()
        imgui.text_disabled(fitting_path(shown(path), room - wide - style.item_spacing.x))
        imgui.set_item_tooltip(str(path))
        for at, addition in enumerate(buttons):
            imgui.same_line(*() if at else (start + room - wide,))
            if button(tr(addition.button), tr(addition.button_note), small=True):
                addition.toggle()
        imgui.same_line(*() if buttons else (start + room - wide,))
        draw_settings(bench.interface, look, small=True)
    if sketch is None:
        return
    with look.font(look.text, theme.SMALL):
        _about(memory, about(sketch), sketch.file)
    _buttons(memory, bench, look)
    if sketch.presets:
        _presets(sketch, memory, bench.actions)
    _shown_texture(session)


def _about(memory: PanelState, paragraphs: list[str], file: str) -> None:
    """Write what the sketch is about; of more than two lines the rest is folded."""
    if not paragraphs:
        return
    wide, unfolded = imgui.get_content_region_avail().x, memory.unfolded == file
    label = tr("less") if unfolded else tr("more")
    lines, is_cut = first_lines(paragraphs[0], wide, _ABOUT_LINES, f"… {label}")
    with wrapped():
        for text in paragraphs if unfolded else lines:
            imgui.text_disabled(text)
    if unfolded or is_cut or len(paragraphs) > 1:
        if not unfolded:
            imgui.same_line(0, imgui.calc_text_size(" ").x)
        if imgui.text_link(f"{label}###about"):
            memory.unfolded = "" if unfolded else file


def _buttons(memory: PanelState, bench: Workbench, look: Theme) -> None:
    """Draw rows of buttons, closer than elsewhere; in a narrow panel they take more rows."""
    style, closer = imgui.get_style(), _CLOSER * look.scale
    padding, spacing = style.frame_padding, style.item_spacing
    sizes: dict[imgui.StyleVar_, float | ImVec2] = {
        imgui.StyleVar_.frame_padding: ImVec2(padding.x - closer, padding.y),
        imgui.StyleVar_.item_spacing: ImVec2(spacing.x - closer, spacing.y),
    }
    with styled(sizes=sizes):
        _undo(memory, bench.undo, look)
        next_in_row(tr("Random"))
        _randomise(memory, bench.actions)
        next_in_row("A/B")
        if button("A/B", tr("Keep this as A, go on with B and compare the two, or end that (A)")):
            bench.inspection.compare.toggle()
        next_in_row(tr("Reset"))
        _resets(bench.actions)
        next_in_row(tr("Copy"))
        _copies(memory, bench.actions)
        next_in_row(tr("Save"))
        _saves(memory, bench.actions)
        next_in_row("PNG")
        if button("PNG", tr("Save the picture as a new file in {folder} (S)", folder=bench.actions.folder)):
            bench.actions.save_picture()
        next_in_row(tr("Graph"))
        if button(tr("Graph"), tr("Show or hide the passes as a graph (G)")):
            bench.toggle_passes()
        next_in_row(tr("Trace"))
        if button(
            tr("Trace"), tr("Show or hide every value of the texel under the mouse beside the code (T)")
        ):
            bench.tracing.toggle()
        next_in_row(tr("Code"))
        if button(f"{tr('Code')}###code", tr("Show or hide the sketch's text beside the picture (Ctrl+E)")):
            bench.toggle_code()


def draw_search(memory: PanelState, ahead: TypedAhead) -> None:
    """Draw the search, and the switch that leaves only what is changed."""
    style = imgui.get_style()
    only = tr("Changed")
    wide = imgui.calc_text_size(only).x + imgui.get_frame_height() + style.item_inner_spacing.x
    if memory.focus_search:
        imgui.set_keyboard_focus_here()
        memory.focus_search = False
    imgui.set_next_item_width(-wide - style.item_spacing.x)
    flags = imgui.InputTextFlags_.escape_clears_all
    typed = letters()
    _, text = imgui.input_text_with_hint("##search", tr("Search  /"), memory.filter.search, flags)
    text = with_typed_ahead(ahead, text, memory.filter.search, typed)
    imgui.set_item_tooltip(tr("By label, name, pass, group or description; Esc ends it"))
    imgui.same_line()
    _, changed = imgui.checkbox(f"{only}##only", memory.filter.changed)
    imgui.set_item_tooltip(tr("Only what differs from the file"))
    if (text, changed) != (memory.filter.search, memory.filter.changed):
        memory.filter = Filter(text, changed)


# ── undo ─────────────────────────────────────────────────────────────────────


def _undo(memory: PanelState, undo: Undo, look: Theme) -> None:
    paints = undo.painting.on
    buttons(
        (tr("Undo"), shortcut("Ctrl+Z"), undo.undo, undo.can_undo or paints),
        (tr("Redo"), shortcut("Ctrl+Shift+Z, Ctrl+Y"), undo.redo, undo.can_redo or paints),
    )
    imgui.same_line()
    with menu(tr("History"), "history", tr("Every step; click on one to go there")) as opened:
        if opened:
            draw_history(memory, undo, look)


def draw_history(memory: PanelState, undo: Undo, look: Theme) -> None:
    """Draw the list of steps, oldest first; what is undone is dimmed."""
    history, items = undo.history, items_of(undo.session.shown)
    room = imgui.get_main_viewport().size
    lines = min(len(history.steps) + 1, _LISTED)
    wide, high = min(300 * look.scale, room.x - 60), lines * imgui.get_frame_height() + 10
    size = ImVec2(wide, min(high, room.y - 120))
    imgui.begin_child("steps", size, imgui.ChildFlags_.nav_flattened)
    if imgui.selectable(
        tr("As it was opened") if len(history.steps) < 200 else tr("Before"), history.done == 0
    )[0]:
        undo.go_to(0)

    def name_of(path: str) -> str:
        item = items.get(path)
        return tr_label(item.parameter.title) if item else path

    def written(path: str, value: object) -> str:
        if value is None:
            return tr("the file's")
        item = items.get(path)
        return tr_label(write(item.parameter, value)) if item else spell(value)  # type: ignore[arg-type]

    for number, step in enumerate(history.steps, 1):
        text = fitting(step_label(step, name_of, written), wide - 20 * look.scale)
        done, latest = number <= history.done, number == history.done
        with inked(theme.palette.ink if done else theme.palette.dim):
            if imgui.selectable(f"{text}##{number}", latest)[0]:
                undo.go_to(number)
        if latest and imgui.is_window_appearing():
            imgui.set_scroll_here_y()
    imgui.end_child()


# ── random values ────────────────────────────────────────────────────────────


def _randomise(memory: PanelState, actions: Actions) -> None:
    with menu(tr("Random"), "random", tr("Random values, from a seed")) as opened:
        if opened:
            _random_values(memory, actions)


def _random_values(memory: PanelState, actions: Actions) -> None:
    draft = actions.session.shown
    _, memory.seed = imgui.input_int(tr("Seed"), memory.seed)
    strength = slide("##strength", memory.strength, (0.01, 0.5), "%.2f")
    memory.strength = memory.strength if strength is None else strength
    imgui.same_line(0, imgui.get_style().item_inner_spacing.x)
    imgui.text_unformatted(tr("Strength"))
    imgui.set_item_tooltip(tr("Of a mutation: how far a value goes, in fractions of its range"))
    with disabled(bool(memory.filter)):
        _, memory.everything = imgui.checkbox(tr("Everything"), memory.everything)
    imgui.set_item_tooltip(tr("Also colours, light, the view and what reads files; else the shape alone"))
    chosen, what = targets(draft, memory.filter, everything=memory.everything)
    if draft is not None:
        values = shown_values(draft)
        if button(tr("Random values")):
            actions.set_all(tr("Random, seed {seed}", seed=memory.seed), at_random(chosen, memory.seed))
            memory.seed += 1
        imgui.same_line()
        if button(tr("Mutate")):
            near = mutated(chosen, values.of, memory.seed, memory.strength)
            actions.set_all(tr("Mutation, seed {seed}", seed=memory.seed), near)
            memory.seed += 1
    imgui.text_disabled(
        tr("{parameters}: {which}", parameters=counted(len(chosen), "parameter"), which=tr(what))
    )


# ── resets, copies, saves ────────────────────────────────────────────────────


def _resets(actions: Actions) -> None:
    session = actions.session
    with menu(tr("Reset"), "resets", tr("Back to what the file says")) as opened:
        if not opened:
            return
        edits = session.shown.edits if session.shown else Edits()
        touched = bool(edits.values or edits.techniques or edits.channels or session.view.steps)
        if imgui.menu_item_simple(tr("View"), "R", False, edits.camera is not None):
            session.drafts.set_camera(None)
        if imgui.menu_item_simple(tr("All values and techniques"), "", False, touched):
            actions.reset_values()
        if imgui.menu_item_simple(tr("Locks"), "", False, bool(edits.locked)):
            for path in edits.locked:
                session.drafts.lock(path, False)


def _copies(memory: PanelState, actions: Actions) -> None:
    with menu(tr("Copy"), "copies", tr("What differs from the file, to the clipboard")) as opened:
        if not opened:
            return
        draft = actions.session.shown
        if draft is not None and imgui.menu_item_simple(
            tr("As --set options"), "", False, bool(draft.applied)
        ):
            text = set_words(draft)
            imgui.set_clipboard_text(text)
            actions.notices.say(tr("copied {text}", text=fitting(text, 320.0)))
        if imgui.menu_item_simple(tr("As TOML")):
            actions.copy_toml(imgui.set_clipboard_text)


def _saves(memory: PanelState, actions: Actions) -> None:
    with menu(tr("Save"), "saves", tr("What differs from the file, into the file")) as opened:
        if opened:
            if imgui.menu_item_simple(tr("Into the sketch"), "Ctrl+S"):
                actions.save_values()
            here, new = tr("As a copy in the current folder"), tr("As a new sketch")
            if imgui.menu_item_simple(here if actions.copy_is[0] == tr("Save a copy") else new):
                actions.save_a_copy()
            imgui.separator()
            _preset_to_save(memory, actions)
    if actions.file.asks:
        actions.file.asks = False
        imgui.open_popup("offer")
    if imgui.begin_popup("offer"):
        imgui.text_unformatted(actions.file.offer)
        done = button(*actions.copy_is)
        if done:
            actions.save_a_copy()
        imgui.same_line()
        if button(tr("Cancel")) or done:
            actions.file.offer = ""
            imgui.close_current_popup()
        imgui.end_popup()


def _preset_to_save(memory: PanelState, actions: Actions) -> None:
    imgui.set_next_item_width(imgui.get_font_size() * 9)
    enter = imgui.InputTextFlags_.enter_returns_true
    hint = tr("name of a preset")
    entered, memory.preset_name = imgui.input_text_with_hint("##name", hint, memory.preset_name, enter)
    imgui.same_line()
    name = memory.preset_name.strip()
    taken = actions.has_preset(name)
    label = tr("Replace preset") if taken else tr("Save preset")
    note = tr("There is one of that name: it is written over, which undo takes back") if taken else ""
    pressed = button(f"{label}###save preset", note, enabled=bool(name))
    if pressed or (entered and name):
        actions.save_as_preset(name, replaces=pressed and taken)
    if pressed or (entered and name and not taken):
        memory.preset = name
        imgui.close_current_popup()


# ── rows ─────────────────────────────────────────────────────────────────────


def _presets(sketch: Sketch, memory: PanelState, actions: Actions) -> None:
    active = next((p for p in sketch.presets if _differing(sketch, p) == []), None)
    if active is not None:
        memory.preset = active.name
    last = next((p for p in sketch.presets if p.name == memory.preset), None)
    off = _differing(sketch, last) if last is not None and active is None else []
    note = tr("Values that go together")
    if off and last is not None:
        note += "\n" + tr("Changed since {name}: {paths}", name=last.name, paths=", ".join(off))
    with row(tr("Preset"), note, edited=bool(off), fixed=True):
        text = active.name if active else tr("{name}, changed", name=last.name) if last else tr("choose")
        preset = choose("##preset", fitting_choice(text), sketch.presets, active, name=lambda p: p.name)
        imgui.same_line(0, imgui.get_style().item_inner_spacing.x)
        _preset_order(sketch, actions)
    if preset is not None:
        memory.preset = preset.name
        actions.apply_preset(preset.name)


def _preset_order(sketch: Sketch, actions: Actions) -> None:
    """Draw the menu that moves and deletes presets, by its buttons or by the keys of a name."""
    with menu("…###preset order", "preset order", tr("Move and delete presets")) as opened:
        if not opened:
            return
        last = len(sketch.presets) - 1
        wide = max(imgui.calc_text_size(preset.name).x for preset in sketch.presets)
        start = imgui.get_cursor_pos_x()
        for number, preset in enumerate(sketch.presets):
            imgui.align_text_to_frame_padding()
            stays = imgui.SelectableFlags_.no_auto_close_popups
            imgui.selectable(f"{preset.name}###preset {number}", False, stays, ImVec2(wide, 0))
            if imgui.is_item_focused():
                _act_on_preset(preset.name, actions)
            imgui.set_item_tooltip(tr("Ctrl+Up, Ctrl+Down: move   Delete: delete"))
            imgui.same_line(start + wide + 2 * imgui.get_style().item_spacing.x)
            buttons(
                (f"{tr('Up')}###up {number}", "", partial(actions.move_preset, preset.name, -1), number > 0),
                (
                    f"{tr('Down')}###down {number}",
                    "",
                    partial(actions.move_preset, preset.name, 1),
                    number < last,
                ),
                (f"{tr('Delete')}###delete {number}", "", partial(actions.delete_preset, preset.name), True),
            )


def _act_on_preset(name: str, actions: Actions) -> None:
    """Act on the keys of the preset whose name has them; the keys move on with it."""
    ctrl = ctrl_held()
    if imgui.is_key_pressed(imgui.Key.delete, repeat=False):
        actions.delete_preset(name)
    elif ctrl and imgui.is_key_pressed(imgui.Key.up_arrow):
        actions.move_preset(name, -1)
    elif ctrl and imgui.is_key_pressed(imgui.Key.down_arrow):
        actions.move_preset(name, 1)


def _differing(sketch: Sketch, preset: Preset) -> list[str]:
    """Return the paths of a preset that are set otherwise."""
    overrides = dict(sketch.overrides)
    if not preset.values:
        return [preset.name]
    return [path for path, value in preset.values if overrides.get(path) != value]


def _shown_texture(session: Session) -> None:
    current = session.view.map.ref if session.view.map else ""

    def name(ref: str) -> str:
        return ref_name(ref) if ref else tr("its own view")

    with row(tr("Show"), tr("The sketch's own view, or any texture seen from above (M)"), fixed=True):
        ref = choose("##shown", fitting_choice(name(current)), ["", *session.refs], current, name=name)
    if ref is not None:
        session.show(ref or None)
