"""The passes in the panel: a section each, with its technique, its repeats and its parameters."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from imgui_bundle import ImVec2, imgui

from playground.errors import counted
from playground.shader.parameter import label_of
from playground.sketch.model import PassSpec, Sketch, TexelKernel, kernels_of
from playground.sketch.replace_technique import choices
from playground.studio import theme
from playground.studio.actions import Commands
from playground.studio.bench import Workbench
from playground.studio.channels.channels import channels
from playground.studio.channels.panel import ChannelRows
from playground.studio.code.open_files import OpenFiles, editor_name
from playground.studio.cost.costs import RunReasons
from playground.studio.draw import choose, header, inked, pushed_id
from playground.studio.edits.edits import Draft
from playground.studio.graph.graph import cost_of
from playground.studio.panel.memory import Memory
from playground.studio.panel.parameter_list import Group, Item, Section
from playground.studio.panel.parameter_row import Rows
from playground.studio.panel.rows import cross, fitting_choice, row, slot
from playground.studio.panel.sliders import slide_whole
from playground.studio.session import Session
from playground.studio.theme import Theme

_TALL = imgui.ComboFlags_.height_large.value


@dataclass
class Sections:
    """The list of passes; what may fill each is computed once."""

    memory: Memory
    _choices: dict[str, list[str]] = field(default_factory=dict)
    _choices_of: Sketch | None = None

    def __post_init__(self) -> None:
        self._channels = ChannelRows(self.memory.listing)

    def draw(self, sketch: Sketch, bench: Workbench, look: Theme) -> None:
        """Draw every pass, or what a search has found of them."""
        session, memory = bench.session, self.memory
        draft = session.shown
        if draft is None:
            return
        values, sections = memory.listing.values(draft), memory.listing.filtered(draft, memory.filter)
        if memory.filter and not sections:
            imgui.text_disabled("no parameter is like that")
        rows = Rows(session, bench.notices, memory, bench.interface.ahead, values, look, bench.controllers)
        reasons = bench.inspection.reasons
        drawing = _Drawing(Path(sketch.folder), rows, bench.commands, bench.files, reasons)
        main = memory.listing.main(draft) if not memory.filter else ()
        if main:
            drawing.main(main)
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
        note = f"What fills this pass\n{title}" if title else "What fills this pass"
        with row("Technique", note, edited=chosen):
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
    commands: Commands
    files: OpenFiles
    reasons: RunReasons

    @property
    def memory(self) -> Memory:
        return self.rows.memory

    @property
    def look(self) -> Theme:
        return self.rows.look

    def main(self, items: tuple[Item, ...]) -> None:
        """Draw the parameters that the sketch is about, under a bar of their own."""
        imgui.spacing()
        flags = imgui.TreeNodeFlags_.default_open | imgui.TreeNodeFlags_.allow_overlap
        opened = header("Main parameters###main", self.look, flags)
        imgui.set_item_tooltip("What this sketch is about, by its own list: main = [...] in its file")
        self._reset("Main parameters", items)
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
        unfolded = header(f"{label_of(spec.name)}###pass", look, flags)
        low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
        text, ran, spent = cost_of(session, spec.name)
        if session.engine.options.profiling and spent is not None:
            text = f"{spent:.1f} ms    {text}"
        size = imgui.calc_text_size(text)
        right = high.x - slot() - 8 * look.scale
        position = ImVec2(right - size.x, (low.y + high.y - size.y) / 2)
        imgui.get_window_draw_list().add_text(
            position, theme.packed(theme.ACCENT if ran else theme.DIM), text
        )
        if imgui.is_item_hovered():
            lines = ["How often its kernels ran; green: for this very picture"]
            lines += [self.reasons.text(spec.name), "Right click: its files"]
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
        if imgui.tree_node_ex(f"Inside: {count} more###inner"):
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
            with inked(theme.DIM):
                opened = imgui.tree_node_ex(f"{group.name}###{where} {group.name}", flags)
            self._reset(group.name, group.items)
            if opened:
                self._rows(group)

    def _rows(self, group: Group) -> None:
        """Draw parameters. One that is scrolled away leaves only its room, unless a widget is in use."""
        heights, used = self.memory.heights, imgui.is_any_item_active()
        top = imgui.get_window_pos().y
        bottom = top + imgui.get_window_height()
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
        note = f"{counted(len(paths), 'parameter')} back to the file's values"
        if cross(f"##reset {name}", note, high):
            self.commands.reset(name, paths)


def _files(spec: PassSpec, files: OpenFiles) -> None:
    """Draw the menu of a pass, under its bar: its files, to be opened in an editor."""
    if not imgui.begin_popup_context_item("files"):
        return
    imgui.text_disabled(f"Files of {spec.name}")
    for file in dict.fromkeys(f for _, kernel in kernels_of(spec.technique) for f in kernel.files if f):
        with pushed_id(file):
            if imgui.menu_item_simple(f"Edit {Path(file).name}", editor_name()):
                files.open(Path(file))
            imgui.set_item_tooltip(file)
            if editor_name() and imgui.menu_item_simple(f"Edit {Path(file).name} here"):
                files.open(Path(file), here=True)
    imgui.end_popup()


def _steps(spec: PassSpec, session: Session) -> None:
    """Draw a slider over the steps of each repeat in a pass."""
    steps = session.view.steps
    mine = {
        path: whole
        for path, whole in session.repeats.items()
        if whole > 0 and (path == spec.name or path.startswith(f"{spec.name}."))
    }
    for path, whole in mine.items():
        label = "Step" if len(mine) == 1 else f"Step of {path.partition('.')[2]}"
        note = f"How many of its {counted(whole, 'step')} {path} has run; Ctrl+click to type a number"
        with row(label, note, edited=path in steps):

            def text(now: int, last: int = whole) -> str:
                return f"all {now}" if now == last else str(now)

            chosen = slide_whole(f"##steps of {path}", steps.get(path, whole), (0, whole), text)
            if chosen is not None:
                session.stop_at(path, chosen)
    if any(path in steps for path in mine) and any(
        isinstance(k, TexelKernel) and k.between for _, k in kernels_of(spec.technique)
    ):
        with row("Interpolated", "The heights between the known ones; otherwise texels not reached are 0"):
            changed, on = imgui.checkbox("##interpolated", session.view.interpolated)
            if changed:
                session.view.interpolate(on)


def _use_name(use: str) -> str:
    """Return a technique's name without its folder where a closed list has no room for that."""
    return use if fitting_choice(use) == use else fitting_choice(use.rpartition("/")[2])
