"""The panel: what can be changed, made from the sketch's own annotations.

From the top: the title, time and pictures; presets; which texture is shown; a section
a pass, with its technique and parameters; what each pass cost. What a technique
exports comes first, what is inside is folded.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import groupby
from pathlib import Path

from imgui_bundle import ImVec2, imgui

from playground.errors import counted
from playground.live import theme
from playground.live.actions import Actions
from playground.live.costs import draw_costs
from playground.live.keys import KEYS
from playground.live.paintbox import draw_paintbox
from playground.live.rows import fitting, reset_width, row
from playground.live.theme import Theme
from playground.live.widgets import Place, draw_value, explanation
from playground.paths import shown
from playground.sketch.assign import Shown, shown_parameters, value_of, values_of
from playground.sketch.choose import choices
from playground.sketch.model import Parameter, PassSpec, Preset, Sketch, Value

_OWN_VIEW = "the sketch's own view"


@dataclass
class Panel:
    """The panel's own memory: its width, and what it need not work out again."""

    width: float = theme.PANEL_WIDTH  # in units of scale 1
    _choices: dict[tuple[int, str], list[str]] = field(default_factory=dict)
    _choices_of: Sketch | None = None

    def draw(self, actions: Actions, look: Theme) -> float:
        """Draw the panel over the window's left side; return the width it takes, in the window's units."""
        room = imgui.get_main_viewport().size
        widest = max(room.x - 160 * look.scale, 160.0)
        wanted = min(self.width * look.scale, widest)
        imgui.set_next_window_pos(ImVec2(0, 0))
        imgui.set_next_window_size(ImVec2(wanted, room.y))
        imgui.set_next_window_size_constraints(
            ImVec2(min(240 * look.scale, widest), room.y), ImVec2(min(620 * look.scale, widest), room.y)
        )
        flags = imgui.WindowFlags_.no_title_bar | imgui.WindowFlags_.no_move | imgui.WindowFlags_.no_collapse
        flags |= imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_bring_to_front_on_focus
        flags |= imgui.WindowFlags_.no_nav_inputs | imgui.WindowFlags_.no_scrollbar
        imgui.begin("panel", None, flags)
        self._head(actions, look)
        footer = _footer_height()
        sketch = actions.session.sketch
        bar = imgui.WindowFlags_.always_vertical_scrollbar if sketch is not None else 0
        imgui.begin_child("sections", ImVec2(0, -footer), 0, bar)
        if sketch is not None:
            self._map(actions, look)
            self._passes(sketch, actions, look)
            draw_costs(sketch, actions, look)
        imgui.end_child()
        _footer(look, actions.session.orbits)
        width = imgui.get_window_size().x
        imgui.end()
        self.width = width / look.scale
        return width

    # ── the top ──────────────────────────────────────────────────────────────

    def _head(self, actions: Actions, look: Theme) -> None:
        session, sketch = actions.session, actions.session.sketch
        with look.font(look.bold, theme.TEXT_SIZE + 2):
            imgui.text_wrapped((sketch.title.strip() if sketch else "") or session.path.stem)
        with look.font(look.text, theme.SMALL):
            imgui.text_disabled(fitting(shown(session.path), imgui.get_content_region_avail().x))
            imgui.set_item_tooltip(str(session.path))
        if sketch is None:
            return
        _buttons(actions, look)
        if session.animated:
            _time(actions, look)
        if sketch.presets:
            _presets(sketch, actions)
        self._shown(actions, look)
        draw_paintbox(actions.painting)

    def _shown(self, actions: Actions, look: Theme) -> None:
        session = actions.session
        with row("Show", "The sketch's own view, or any texture seen from above (M)", fixed=True):
            if imgui.begin_combo("##shown", _ref_name(session.map.ref) if session.map else _OWN_VIEW):
                if imgui.selectable(_OWN_VIEW, session.map is None)[0]:
                    actions.show(None)
                for ref in session.refs:
                    if imgui.selectable(_ref_name(ref), session.map is not None and session.map.ref == ref)[
                        0
                    ]:
                        actions.show(ref)
                imgui.end_combo()

    def _map(self, actions: Actions, look: Theme) -> None:
        """Draw how the map is shown, while there is one."""
        session = actions.session
        if session.map is None:
            return
        for parameter in session.map.kernel.parameters:
            path, value = f"map.{parameter.name}", session.map.value(parameter.name)
            changed = _parameter(path, parameter, value, False, Path(), look.scale)
            if changed is not None:
                session.set_map(parameter.name, changed)
        if imgui.button("Fit to the values"):
            session.fit_map()

    # ── passes ───────────────────────────────────────────────────────────────

    def _passes(self, sketch: Sketch, actions: Actions, look: Theme) -> None:
        leaves = values_of(sketch)
        by_pass = {
            name: list(group)
            for name, group in groupby(shown_parameters(sketch), lambda s: s.path.partition(".")[0])
        }
        for spec in sketch.graph.passes:
            imgui.spacing()
            imgui.push_id(spec.name)
            opened = _pass_header(spec, actions, look)
            if opened:
                self._technique(sketch, spec, actions)
                _steps(spec, actions)
                mine = by_pass.get(spec.name, [])
                _groups([s for s in mine if s.exported], leaves, sketch, actions, look)
                _inner([s for s in mine if not s.exported], leaves, sketch, actions, look)
            imgui.pop_id()

    def _technique(self, sketch: Sketch, spec: PassSpec, actions: Actions) -> None:
        shown_draft = actions.session.shown
        chosen = shown_draft is not None and any(n == spec.name for n, _ in shown_draft.edits.techniques)
        note = (
            f"What fills this pass\n{spec.technique.title}"
            if spec.technique.title
            else "What fills this pass"
        )
        with row("Technique", note, edited=chosen):
            # Only an open list is worked out: it reads every technique there is.
            if imgui.begin_combo("##use", _use_name(spec.use), imgui.ComboFlags_.height_large):
                for use in self._choices_for(sketch, spec.name, actions):
                    if imgui.selectable(use, use == spec.use)[0]:
                        actions.session.choose(spec.name, use)
                imgui.end_combo()

    def _choices_for(self, sketch: Sketch, name: str, actions: Actions) -> list[str]:
        draft = actions.session.shown
        base = draft.base if draft else sketch
        if self._choices_of is not base:
            self._choices_of, self._choices = base, {}
        key = (id(base), name)
        if key not in self._choices:
            self._choices[key] = choices(base, name)
        return self._choices[key]


def _buttons(actions: Actions, look: Theme) -> None:
    session = actions.session
    if imgui.button("Reset view"):
        session.reset_camera()
    imgui.set_item_tooltip("See the land as the file says (R)")
    imgui.same_line()
    edits = session.shown.edits if session.shown else None
    untouched = edits is None or not (edits.values or edits.techniques or session.steps)
    imgui.begin_disabled(untouched)
    if imgui.button("Reset values"):
        session.reset_values()
    imgui.end_disabled()
    imgui.set_item_tooltip("Every parameter and technique as the file says")
    imgui.same_line()
    if imgui.button("Save PNG"):
        actions.save_picture()
    imgui.set_item_tooltip(f"A new file in {actions.folder} (S)")


def _time(actions: Actions, look: Theme) -> None:
    clock = actions.session.clock
    wide = 64 * look.scale
    if imgui.button("Pause" if clock.playing else "Play", ImVec2(wide, 0)):
        clock.toggle()
    imgui.set_item_tooltip("Space")
    imgui.same_line()
    imgui.set_next_item_width(-wide - imgui.get_style().item_spacing.x)
    changed, time = imgui.drag_float("##time", clock.time, 0.05, 0.0, 1e6, "time %.2f s")
    if changed:
        clock.time = max(time, 0.0)
    imgui.same_line()
    if imgui.button("To 0", ImVec2(-1, 0)):
        actions.rewind()


def _presets(sketch: Sketch, actions: Actions) -> None:
    with row("Preset", "Values that go together", fixed=True):
        now = next((p.name for p in sketch.presets if _holds(sketch, p)), "")
        if imgui.begin_combo("##preset", now or "choose"):
            for preset in sketch.presets:
                if imgui.selectable(preset.name, preset.name == now)[0]:
                    actions.session.apply_preset(preset.name)
            imgui.end_combo()


def _holds(sketch: Sketch, preset: Preset) -> bool:
    overrides = dict(sketch.overrides)
    return bool(preset.values) and all(overrides.get(path) == value for path, value in preset.values)


def _pass_header(spec: PassSpec, actions: Actions, look: Theme) -> bool:
    """Draw a pass's bar: its name, and how often it ran; green if it ran for this picture."""
    engine = actions.session.engine
    mine = [path for path in engine.runs if path == spec.name or path.startswith(f"{spec.name}.")]
    runs = sum(engine.runs[path] for path in mine)
    ran = any(path in mine for path in engine.ran)
    with look.font(look.bold):
        opened = imgui.collapsing_header(
            f"{spec.name.replace('_', ' ').capitalize()}###pass", imgui.TreeNodeFlags_.default_open
        )
    low, high = imgui.get_item_rect_min(), imgui.get_item_rect_max()
    text = counted(runs, "run")
    spent = [actions.session.times[path] for path in mine if path in actions.session.times]
    if engine.profiling and spent:
        text = f"{sum(spent):.1f} ms    {text}"
    size = imgui.calc_text_size(text)
    place = ImVec2(high.x - size.x - 8 * look.scale, (low.y + high.y - size.y) / 2)
    imgui.get_window_draw_list().add_text(place, theme.packed(theme.ACCENT if ran else theme.DIM), text)
    if imgui.is_item_hovered():
        imgui.set_tooltip("How often its kernels ran; green: for this very picture")
    return opened


def _steps(spec: PassSpec, actions: Actions) -> None:
    """Draw a slider over the turns of each repeat in a pass."""
    session = actions.session
    mine = {
        path: whole
        for path, whole in session.repeats.items()
        if whole > 0 and (path == spec.name or path.startswith(f"{spec.name}."))
    }
    for path, whole in mine.items():
        turn = session.steps.get(path, whole)
        label = "Step" if len(mine) == 1 else f"Step of {path.partition('.')[2]}"
        note = f"How many of its {counted(whole, 'turn')} {path} has taken; Ctrl+click to type a number"
        with row(label, note, edited=path in session.steps):
            shape = "all %d" if turn == whole else "%d"
            changed, chosen = imgui.slider_int(
                f"##steps of {path}", turn, 0, whole, shape, imgui.SliderFlags_.always_clamp
            )
            if changed:
                session.stop_at(path, chosen)


def _groups(
    items: list[Shown], leaves: dict[str, Value], sketch: Sketch, actions: Actions, look: Theme
) -> None:
    """Draw parameters, those without a group first."""
    names = dict.fromkeys(["", *(s.parameter.group for s in items)])
    for name in names:
        members = [s for s in items if s.parameter.group == name]
        if name and members:
            with look.font(look.text, theme.SMALL):
                imgui.separator_text(name)
        for item in members:
            _one(item, leaves, sketch, actions, look)


def _inner(
    items: list[Shown], leaves: dict[str, Value], sketch: Sketch, actions: Actions, look: Theme
) -> None:
    """Draw the parameters inside a technique, folded, a heading for each inner pass."""
    if not items or not imgui.tree_node_ex(f"Inside: {len(items)} more###inner"):
        return
    for path, group in groupby(items, lambda s: s.path.rpartition(".")[0]):
        members = list(group)
        if imgui.tree_node_ex(path.partition(".")[2] or path):
            _groups(members, leaves, sketch, actions, look)
            imgui.tree_pop()
    imgui.tree_pop()


def _one(item: Shown, leaves: dict[str, Value], sketch: Sketch, actions: Actions, look: Theme) -> None:
    session = actions.session
    edited = session.shown is not None and session.shown.edits.has(item.path)
    value = value_of(sketch, item.path, leaves)
    right = imgui.get_cursor_pos_x() + imgui.get_content_region_avail().x
    changed = _parameter(item.path, item.parameter, value, edited, Path(sketch.folder), look.scale)
    if changed is not None:
        session.set(item.path, changed)
    if edited:
        imgui.same_line(right - reset_width() + 2 * look.scale)
        if imgui.small_button(f"×##{item.path}"):
            session.unset(item.path)
        imgui.set_item_tooltip("Back to the file's value")


def _parameter(
    path: str, parameter: Parameter, value: Value, edited: bool, folder: Path, scale: float
) -> Value | None:
    with row(parameter.title, explanation(parameter, path), edited=edited):
        return draw_value(parameter, value, Place(f"##{path}", scale, folder))


def _footer_height() -> float:
    return imgui.get_text_line_height_with_spacing() * 2 + imgui.get_style().item_spacing.y * 2


def _footer(look: Theme, orbits: bool) -> None:
    imgui.separator()
    with look.font(look.text, theme.SMALL):
        imgui.push_text_wrap_pos(0)
        imgui.text_disabled("Drag to orbit, Shift to pan, Ctrl for the sun, wheel to zoom" if orbits else "")
        imgui.text_disabled("   ".join(f"{k.name} {k.brief}" for k in KEYS if k.brief))
        imgui.pop_text_wrap_pos()


def _ref_name(ref: str) -> str:
    """Return a texture's name without what is said twice: "height:height" is "height"."""
    path, _, output = ref.partition(":")
    return path if path.rpartition(".")[2] == output else ref


def _use_name(use: str) -> str:
    """Return a technique's name without its folder where a closed list has no room for that."""
    room = imgui.calc_item_width() - imgui.get_frame_height() - 2 * imgui.get_style().frame_padding.x
    return use if imgui.calc_text_size(use).x <= room else use.rpartition("/")[2]
