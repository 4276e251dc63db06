"""The passes in the panel: a section each, with its technique, its repeats and its parameters.

A parameter has a label, a widget, a lock and a reset, a menu, and a field to type its value in.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from imgui_bundle import ImVec2, imgui

from playground.errors import ParameterError
from playground.shader.parameter import label_of, part_names, write
from playground.sketch.model import PassSpec, Sketch, TexelKernel, kernels_of
from playground.sketch.replace_technique import choices
from playground.studio import focus, theme
from playground.studio.actions import Actions
from playground.studio.bench import Workbench
from playground.studio.channels.channels import channels
from playground.studio.channels.panel import ChannelRows
from playground.studio.code.open_files import OpenFiles, editor_name
from playground.studio.cost.costs import RunReasons
from playground.studio.draw import (
    await_field,
    choose,
    cross,
    fitting_choice,
    header,
    inked,
    letters,
    pushed_id,
    row,
    slot,
    slot_button,
    with_typed_ahead,
)
from playground.studio.edits.edits import Draft
from playground.studio.graph.graph import cost_of
from playground.studio.interface import TypedAhead
from playground.studio.land.panel import TerrainGroup
from playground.studio.language import counted, numeral, tr, tr_label
from playground.studio.notices import Notices
from playground.studio.panel.parameter_list import (
    Group,
    Item,
    PanelState,
    Section,
    Values,
    filtered,
    main_items,
    shown_values,
)
from playground.studio.panel.values import read_typed
from playground.studio.remote.controllers import Controllers
from playground.studio.remote.panel import draw_controllers
from playground.studio.session import Session
from playground.studio.theme import Theme
from playground.studio.widgets import WidgetSlot, draw_value, explanation, slide_whole

# ── a parameter ───────────────────────────────────────────────────────────────


_TYPED = "numbers"  # the control that becomes a field at a double click, or a click with Ctrl
_MENU = "parameter"
_PRESSED = imgui.HoveredFlags_.allow_when_blocked_by_active_item.value  # as while the lock is pressed


@dataclass(frozen=True)
class Rows:
    """What every row of parameters in one frame uses."""

    session: Session
    notices: Notices
    memory: PanelState
    ahead: TypedAhead
    values: Values
    look: Theme
    controllers: Controllers | None = None  # that may be learned

    def draw(self, item: Item, folder: Path) -> None:
        """Draw a parameter, and set what the user makes of it; ``folder`` is the sketch's own."""
        drafts, path, parameter = self.session.drafts, item.path, item.parameter
        value, changed = self.values.of[path], path in self.values.changed
        end = imgui.get_cursor_pos_x() + imgui.get_content_region_avail().x
        top = imgui.get_cursor_screen_pos()
        by_keys = focus.has(item.label, *(f"{item.label}.{name}" for name in part_names(parameter)))
        with row(tr_label(item.title), lambda: explanation(parameter, path), edited=changed):
            if self.memory.entry == item.label:
                self._entry(item)
            else:
                new = draw_value(parameter, value, WidgetSlot(item.label, self.look.scale, folder))
                if by_keys and self._acts_on_keys(item):
                    new = None
                clicked = imgui.is_item_hovered() and imgui.is_mouse_clicked(0)
                if parameter.widget.facts.control == _TYPED and clicked and self._is_typing(item):
                    new = None
                if new is not None and parameter.widget.kind == "button":
                    self.session.press(path)
                elif new is not None:
                    drafts.set(path, new)
        locked = path in self.values.locked
        mouse = imgui.get_mouse_pos()
        inside = top.y <= mouse.y < imgui.get_cursor_screen_pos().y and imgui.is_window_hovered(_PRESSED)
        here = by_keys or (inside and mouse.y < top.y + imgui.get_frame_height())
        if locked or here:
            imgui.same_line(end - 2 * slot() - 2)
            if _lock(path, locked, self.look):
                drafts.lock(path, not locked)
        if changed:
            imgui.same_line(end - slot())
            if cross(f"{item.label}-reset", tr("Back to the file's value")):
                drafts.unset(path)
        if inside and imgui.is_mouse_clicked(1):
            self.memory.menu, self.memory.menu_opens = item.label, True

    def draw_menu(self, items: dict[str, Item]) -> None:
        """Draw the menu of the parameter that was right-clicked; ``items`` by their labels."""
        if self.memory.menu_opens:
            self.memory.menu_opens = False
            imgui.open_popup(_MENU)
        item = items.get(self.memory.menu)
        if not imgui.begin_popup(_MENU):
            return
        if item is not None:
            drafts, path = self.session.drafts, item.path
            locked = path in self.values.locked
            imgui.text_disabled(path)
            if imgui.menu_item_simple(tr("Type a value"), tr("double click")):
                self.open_entry(item)
            if imgui.menu_item_simple(tr("Reset"), "", False, path in self.values.changed):
                drafts.unset(path)
            if imgui.menu_item_simple(tr("Unlock") if locked else tr("Lock")):
                drafts.lock(path, not locked)
            if imgui.menu_item_simple(tr("Copy as --set")):
                text = f"--set {path}={write(item.parameter, self.values.of[path])}"
                imgui.set_clipboard_text(text)
                self.notices.say(tr("copied {text}", text=text))
            if self.controllers is not None:
                draw_controllers(self.controllers, item)
        imgui.end_popup()

    def open_entry(self, item: Item) -> None:
        """Begin to type a parameter's value."""
        await_field(self.ahead)
        self.memory.entry, self.memory.entry_opens = item.label, True
        self.memory.entry_text = write(item.parameter, self.values.of[item.path])

    def _acts_on_keys(self, item: Item) -> bool:
        """Act on the keys of the row that shows the focus; return whether one was for the row.

        Enter opens the field in which a number is typed, the menu's key its menu.
        """
        is_menu = imgui.is_key_pressed(imgui.Key.menu, repeat=False)
        if is_menu or (imgui.get_io().key_shift and imgui.is_key_pressed(imgui.Key.f10, repeat=False)):
            self.memory.menu, self.memory.menu_opens = item.label, True
            return True
        entered = any(
            imgui.is_key_pressed(key, repeat=False) for key in (imgui.Key.enter, imgui.Key.keypad_enter)
        )
        if not entered or item.parameter.widget.facts.control != _TYPED or imgui.get_io().want_text_input:
            return False
        self.open_entry(item)
        return True

    def _is_typing(self, item: Item) -> bool:
        """Handle a click on a widget; return whether it opens a field to type in.

        The first click of a double click has moved the slider already: that is undone.
        """
        session, path, ctrl = self.session, item.path, imgui.get_io().key_ctrl
        if not ctrl and not imgui.is_mouse_double_clicked(0):
            edited = session.shown is not None and session.shown.edits.has(path)
            self.memory.clicked = path, edited, self.values.of[path]
            return False
        clicked, edited, before = self.memory.clicked
        self.open_entry(item)
        if not ctrl and clicked == path:
            if edited:
                session.drafts.set(path, before)
            else:
                session.drafts.unset(path)
            self.memory.entry_text = write(item.parameter, before)
        return True

    def _entry(self, item: Item) -> None:
        """Draw the field; Enter takes the value, Esc leaves it."""
        memory = self.memory
        if memory.entry_opens:
            imgui.set_keyboard_focus_here()
        flags = imgui.InputTextFlags_.enter_returns_true | imgui.InputTextFlags_.auto_select_all
        imgui.set_next_item_width(imgui.calc_item_width())
        typed = letters()
        entered, text = imgui.input_text(f"{item.label}-typed", memory.entry_text, flags)
        memory.entry_text = with_typed_ahead(self.ahead, text, memory.entry_text, typed)
        opened, memory.entry_opens = memory.entry_opens, False
        if opened:
            return
        left = imgui.is_item_deactivated()
        if entered or (left and not imgui.is_key_pressed(imgui.Key.escape)):
            try:
                value = read_typed(item.parameter, memory.entry_text, item.path)
                self.session.drafts.set(item.path, value)
            except ParameterError as error:
                self.notices.say(str(error))
        if entered or left:
            memory.entry = ""


def _lock(path: str, locked: bool, look: Theme) -> bool:
    """Draw a padlock, open or closed; return whether it is clicked on."""
    note = tr("randomising, presets, resets and reloads leave it")
    note = tr("Locked: {note}. Click to unlock", note=note) if locked else tr("Lock: {note}", note=note)
    clicked, hovered, middle = slot_button(f"lock {path}", note)
    ink = theme.palette.warm if locked else theme.palette.ink if hovered else theme.palette.dim
    unit, draw = look.scale, imgui.get_window_draw_list()
    x, y = middle.x, middle.y
    body = ImVec2(x - 4 * unit, y - unit), ImVec2(x + 4 * unit, y + 5 * unit)
    draw.add_rect_filled(*body, theme.packed(ink), unit)
    shift = 0.0 if locked else 3 * unit
    draw.path_arc_to(ImVec2(x + shift, y - unit), 2.5 * unit, 3.1416, 6.2832, 10)
    draw.path_stroke(theme.packed(ink), 1.5 * unit)
    return clicked


# ── a pass ────────────────────────────────────────────────────────────────────


_TALL = imgui.ComboFlags_.height_large.value


@dataclass
class Sections:
    """The list of passes; what may fill each is computed once."""

    memory: PanelState
    _choices: dict[str, list[str]] = field(default_factory=dict)
    _choices_of: Sketch | None = None

    def __post_init__(self) -> None:
        self._channels = ChannelRows()
        self._terrain = TerrainGroup()

    def draw(self, sketch: Sketch, bench: Workbench, look: Theme) -> None:
        """Draw every pass, or what a search has found of them."""
        session, memory = bench.session, self.memory
        draft = session.shown
        if draft is None:
            return
        values, sections = shown_values(draft), filtered(draft, memory.filter)
        if memory.filter and not sections:
            imgui.text_disabled(tr("no parameter matches"))
        rows = Rows(session, bench.notices, memory, bench.interface.ahead, values, look, bench.controllers)
        reasons = bench.inspection.reasons
        drawing = _Drawing(Path(sketch.folder), rows, bench.actions, bench.files, reasons)
        main = main_items(draft.base) if not memory.filter else ()
        if main:
            drawing.main(main)
        if not memory.filter:
            self._terrain.draw(sketch, session, rows, look, bench.interface.preferences, bench.walk)
        feeders = {channel.feeder for channel in channels(draft.base) if channel.alone}
        for spec in sketch.graph.passes:
            section = sections.get(spec.name)
            if memory.filter and section is None:
                continue
            imgui.spacing()
            with pushed_id(spec.name):
                revealed = bench.interface.reveal == spec.name
                if revealed:
                    bench.interface.reveal = ""
                    imgui.set_scroll_here_y(0.0)
                if memory.filter or revealed:
                    imgui.set_next_item_open(True)
                opened = not sketch.main and spec.name not in feeders  # its channel's row has the same
                if drawing.header(spec, section, opened=opened):
                    if not memory.filter:
                        self._technique(spec, draft, session)
                        self._channels.draw(spec, draft, session, look)
                        _steps(spec, session)
                    if section is not None:
                        drawing.section(section)
        if memory.menu:
            items = {item.label: item for section in sections.values() for item in section.items}
            rows.draw_menu(items | {item.label: item for item in main})

    def _technique(self, spec: PassSpec, draft: Draft, session: Session) -> None:
        mine = {channel.path for channel in channels(draft.base) if channel.feeder == spec.name}
        chosen = any(name == spec.name for name, _ in draft.edits.techniques)
        chosen = chosen or any(path in mine for path, _ in draft.edits.channels)
        title = spec.technique.title
        note = tr("What fills this pass") + (f"\n{tr_label(title)}" if title else "")
        with row(tr("Technique"), note, edited=chosen):
            # The options are computed in an open list only: that reads every technique there is.
            options = (use for use in self._choices_for(spec.name, draft))
            use = choose("##use", _use_name(spec.use), options, spec.use, flags=_TALL)
            if use is not None:
                session.drafts.choose(spec.name, use)

    def _choices_for(self, name: str, draft: Draft) -> Iterator[str]:
        if self._choices_of is not draft.base:
            self._choices_of, self._choices = draft.base, {}
        if name not in self._choices:
            self._choices[name] = choices(draft.base, name)
        yield from self._choices[name]


@dataclass
class _Drawing:
    """What every section in one frame uses."""

    folder: Path
    rows: Rows
    actions: Actions
    files: OpenFiles
    reasons: RunReasons

    @property
    def memory(self) -> PanelState:
        return self.rows.memory

    @property
    def look(self) -> Theme:
        return self.rows.look

    def main(self, items: tuple[Item, ...]) -> None:
        """Draw the parameters that the sketch is about, under a bar of their own."""
        imgui.spacing()
        flags = imgui.TreeNodeFlags_.default_open | imgui.TreeNodeFlags_.allow_overlap
        opened = header(f"{tr('Main parameters')}###main", self.look, flags)
        imgui.set_item_tooltip(tr("What this sketch is about, by its own list: main = [...] in its file"))
        self._reset(tr("Main parameters"), items)
        if opened:
            self._rows(Group("", items))

    def header(self, spec: PassSpec, section: Section | None, *, opened: bool) -> bool:
        """Draw a pass's bar: its name, how often it ran, and a reset where something is changed.

        ``opened``: whether it is open until it is clicked on.
        """
        session, look = self.rows.session, self.look
        flags = imgui.TreeNodeFlags_.allow_overlap
        if opened:
            flags |= imgui.TreeNodeFlags_.default_open
        unfolded = header(f"{tr_label(label_of(spec.name))}###pass", look, flags)
        low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
        text, ran, spent = cost_of(session, spec.name)
        if session.engine.options.profiling and spent is not None:
            text = f"{numeral(spent, '.1f')} ms    {text}"
        text = f"• {text}" if ran else text
        size = imgui.calc_text_size(text)
        right = high.x - slot() - 8 * look.scale
        position = ImVec2(right - size.x, (low.y + high.y - size.y) / 2)
        imgui.get_window_draw_list().add_text(
            position, theme.packed(theme.palette.accent if ran else theme.palette.dim), text
        )
        if imgui.is_item_hovered():
            lines = [tr("pass {name}", name=spec.name)]
            lines += [tr("How often its kernels ran; • and green: for this very picture")]
            lines += [self.reasons.text(spec.name), tr("Right click: its files")]
            imgui.set_tooltip("\n".join(filter(None, lines)))
        _files(spec, self.files)
        if section is not None:
            self._reset(spec.name, section.items)
        return unfolded

    def section(self, section: Section) -> None:
        """Draw a pass's parameters, those inside its technique folded."""
        self._groups(section.groups, "")
        if not section.inner:
            return
        if self.memory.filter:
            imgui.set_next_item_open(True)
        count = sum(len(group.items) for _, groups in section.inner for group in groups)
        if imgui.tree_node_ex(f"{tr('Inside: {count} more', count=count)}###inner"):
            for heading, groups in section.inner:
                if self.memory.filter:
                    imgui.set_next_item_open(True)
                if imgui.tree_node_ex(heading):
                    self._groups(groups, heading)
                    imgui.tree_pop()
            imgui.tree_pop()

    def _groups(self, groups: tuple[Group, ...], where: str) -> None:
        for group in groups:
            if not group.name:
                self._rows(group)
                continue
            if self.memory.filter:
                imgui.set_next_item_open(True)
            flags = imgui.TreeNodeFlags_.default_open | imgui.TreeNodeFlags_.span_avail_width
            flags |= imgui.TreeNodeFlags_.allow_overlap | imgui.TreeNodeFlags_.no_tree_push_on_open
            with inked(theme.palette.dim):
                opened = imgui.tree_node_ex(f"{tr_label(group.name)}###{where} {group.name}", flags)
            self._reset(group.name, group.items)
            if opened:
                self._rows(group)

    def _rows(self, group: Group) -> None:
        """Draw parameters. One that is scrolled away leaves only its room, unless a widget is in use."""
        heights, used = self.memory.heights, imgui.is_any_item_active()
        top = imgui.get_window_pos().y
        bottom = top + imgui.get_window_height()
        if focus.is_shown():  # Tab goes on to a row that comes into view by it
            top, bottom = 2 * top - bottom, 2 * bottom - top
        for item in group.items:
            y = imgui.get_cursor_screen_pos().y
            high = heights.get((item.path, self.look.scale))
            if high is not None and not used and (y > bottom or y + high < top):
                imgui.dummy(ImVec2(1, high))
                continue
            self.rows.draw(item, self.folder)
            gap = imgui.get_style().item_spacing.y
            heights[item.path, self.look.scale] = imgui.get_cursor_screen_pos().y - y - gap

    def _reset(self, name: str, items: tuple[Item, ...]) -> None:
        """Draw a reset at the end of the line, where one of the parameters is changed."""
        paths = [item.path for item in items if item.path in self.rows.values.changed]
        if not paths:
            return
        high = imgui.get_item_rect_size().y
        imgui.same_line(imgui.get_window_width() - imgui.get_style().scrollbar_size - slot())
        note = tr("{parameters} back to the file's values", parameters=counted(len(paths), "parameter"))
        if cross(f"##reset {name}", note, high):
            self.actions.reset(tr_label(name), paths)


def _files(spec: PassSpec, files: OpenFiles) -> None:
    """Draw the menu of a pass, under its bar: its files, to be opened in an editor."""
    if not imgui.begin_popup_context_item("files"):
        return
    imgui.text_disabled(tr("Files of {spec}", spec=spec.name))
    for file in dict.fromkeys(f for _, kernel in kernels_of(spec.technique) for f in kernel.files if f):
        with pushed_id(file):
            if imgui.menu_item_simple(tr("Edit {file}", file=Path(file).name), editor_name()):
                files.open(Path(file))
            imgui.set_item_tooltip(file)
            if editor_name() and imgui.menu_item_simple(tr("Edit {file} here", file=Path(file).name)):
                files.open(Path(file), here=True)
    imgui.end_popup()


def _steps(spec: PassSpec, session: Session) -> None:
    """Draw a slider over the steps of each repeat in a pass; several are folded until one is stopped."""
    stopped = session.view.steps
    mine = {
        path: whole
        for path, whole in session.repeats.items()
        if whole > 0 and (path == spec.name or path.startswith(f"{spec.name}."))
    }
    if len(mine) > 1:
        if any(path in stopped for path in mine):
            imgui.set_next_item_open(True)
        flags = imgui.TreeNodeFlags_.span_avail_width | imgui.TreeNodeFlags_.no_tree_push_on_open
        with inked(theme.palette.dim):
            opened = imgui.tree_node_ex(f"{tr('Loops: {count}', count=len(mine))}###loops", flags)
        if not opened:
            return
    for path, whole in mine.items():
        parts = path.split(".")[1:]  # the first is the pass
        label = tr("Step") if len(mine) == 1 else ("…" if len(parts) > 2 else "") + ".".join(parts[-2:])
        note = tr(
            "How many of its {steps} {path} has run; Ctrl+click to type a number",
            steps=counted(whole, "step"),
            path=path,
        )
        with row(label, note, edited=path in stopped):

            def text(now: int, last: int = whole) -> str:
                return tr("all {now}", now=now) if now == last else str(now)

            chosen = slide_whole(f"##steps of {path}", stopped.get(path, whole), (0, whole), text)
            if chosen is not None:
                session.stop_at(path, chosen)
    if any(path in stopped for path in mine) and any(
        isinstance(k, TexelKernel) and k.between for _, k in kernels_of(spec.technique)
    ):
        with row(
            tr("Interpolated"), tr("The heights between the known ones; otherwise texels not reached are 0")
        ):
            changed, on = imgui.checkbox("##interpolated", session.view.interpolated)
            if changed:
                session.view.interpolate(on)


def _use_name(use: str) -> str:
    """Return a technique's name without its folder where a closed list has no room for that."""
    return use if fitting_choice(use) == use else fitting_choice(use.rpartition("/")[2])
