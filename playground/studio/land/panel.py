"""Draw the group Terrain: how high and large the land is, its sun, its looks, and where it is seen from."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Protocol

from imgui_bundle import ImVec2, imgui

from playground.engine.exaggeration import LARGEST
from playground.engine.plan import view_height
from playground.sketch.assign import values_of
from playground.sketch.model import Sketch
from playground.studio import theme
from playground.studio.draw import (
    Area,
    button,
    choose,
    cross,
    fitting_choice,
    header,
    next_in_row,
    plate,
    pushed_id,
    row,
    slot,
    slots_width,
    styled,
    wrapped,
)
from playground.studio.edits.edits import Draft
from playground.studio.interface import Preferences
from playground.studio.land.land import (
    METRES_IN,
    VIEWS,
    Land,
    aspect_sizes,
    from_above,
    keep_exaggeration,
    keep_view,
    level_items,
    north_up,
    recall_view,
    sea_items,
    sun_items,
)
from playground.studio.land.looks import LOOKS, look_of, look_title
from playground.studio.land.walk import Walk
from playground.studio.language import numeral, tr, tr_label
from playground.studio.panel.parameter_list import Item
from playground.studio.session import Session
from playground.studio.theme import Theme
from playground.studio.widgets import WidgetSlot, draw_value, slide

TYPE_ROW = "##land."
_OPEN = "terrain"  # whether the group is, among what is remembered of panes
_CLAMP = imgui.SliderFlags_.always_clamp.value


class ParameterRows(Protocol):
    """What draws a parameter as the panel does elsewhere."""

    def draw(self, item: Item, folder: Path) -> None:
        """Draw one row; ``folder`` is the sketch's own."""


@dataclass
class TerrainGroup:
    """The group, and what it remembers."""

    land: Land = field(default_factory=Land)

    def draw(
        self,
        sketch: Sketch,
        session: Session,
        rows: ParameterRows,
        look: Theme,
        preferences: Preferences,
        walk: Walk,
    ) -> None:
        """Draw it; ``rows`` draws the parameters of passes that belong to it."""
        imgui.spacing()
        before = bool(preferences.panes.get(_OPEN, 1.0))
        imgui.set_next_item_open(before)
        opened = header(f"{tr('Terrain')}###terrain", look, imgui.TreeNodeFlags_.allow_overlap)
        if opened != before:
            preferences.choose(panes={**preferences.panes, _OPEN: float(opened)})
        imgui.set_item_tooltip(tr("The terrain: its size, sun and look, and where it is seen from"))
        plan, draft = session.plan, session.shown
        if not opened or plan is None or draft is None:
            return
        with pushed_id("terrain"):
            self.land.unit = "ft" if preferences.is_in_feet else "m"
            if view_height(plan):
                self._exaggeration(session)
                self._look(session)
                self._metres(session, preferences)
                self._sea(sketch, session, draft, rows)
            else:
                with wrapped():
                    imgui.text_disabled(
                        tr("This sketch makes no heights, so there is no terrain to measure.")
                    )
                if plan.terrain.size is not None:
                    self._size(session, plan.terrain.size)
            if imgui.tree_node_ex(f"{tr('Sun')}###sun"):
                self._sun(sketch, session, rows, look)
                imgui.tree_pop()
            if imgui.tree_node_ex(f"{tr('Camera')}###camera"):
                self._camera(session, walk)
                imgui.tree_pop()

    def _parameters(self, items: Iterable[Item], sketch: Sketch, rows: ParameterRows) -> None:
        for item in items:
            rows.draw(replace(item, label=f"{TYPE_ROW}{item.path}"), Path(sketch.folder))

    def _sun(self, sketch: Sketch, session: Session, rows: ParameterRows, look: Theme) -> None:
        """Draw the sun of what is seen: of a look its own, else the sketch's."""
        seen = session.view.look
        if seen is None:
            items = sun_items(session.shown) if session.shown is not None else []
            self._parameters(items, sketch, rows)
            if not items:
                imgui.text_disabled(tr("this sketch has no sun of its own"))
            return
        sun = seen.sun()
        if sun is None:
            imgui.text_disabled(tr("no light changes this look"))
            return
        parameter, value = sun
        with row(tr_label(parameter.title), tr("The light of this look; that of the sketch stays as it is")):
            changed = draw_value(parameter, value, WidgetSlot(f"{TYPE_ROW}look sun", look.scale, Path()))
        if changed is not None:
            session.view.show_as(seen.with_sun(changed))

    # ── how high and large ───────────────────────────────────────────────────

    def _exaggeration(self, session: Session) -> None:
        factor = session.exaggeration
        note = tr("Vertical: how many times higher the terrain is drawn and lit; no data or file changes")
        with row(tr("Exaggeration"), note, edited=factor != 1.0):
            wide, style = imgui.calc_item_width() + slots_width(), imgui.get_style()
            start = imgui.get_cursor_pos_x()
            with _narrow_buttons():
                for times in (1, 2, 3):
                    if button(f"×{times}###times{times}", tr("{times} times as high", times=times)):
                        session.exaggerate(float(times))
                    imgui.same_line(0, style.item_inner_spacing.x)
            left = max(start + wide - imgui.get_cursor_pos_x(), 40.0)
            imgui.set_next_item_width(left)
            changed = slide(f"{TYPE_ROW}exaggeration", factor, (0.5, LARGEST), "×%.2f", logarithmic=True)
            if changed is not None:
                session.exaggerate(round(changed, 2))
        if factor != 1.0 and button(
            f"{tr('Make it the relief')}###keep", tr("Sets the sketch's relief to what is seen, and ×1")
        ):
            keep_exaggeration(session)

    def _look(self, session: Session) -> None:
        now = session.view.look.name if session.view.look is not None else LOOKS[0]
        note = tr("Other colours and light for the same terrain; the sketch stays as it is")
        with row(tr("Look"), note, edited=now != LOOKS[0]):
            name = choose(f"{TYPE_ROW}look", fitting_choice(look_title(now)), LOOKS, now, name=look_title)
        shown = session.view.look
        if shown is not None and shown.interval is not None:
            with row(tr("Interval"), tr("From one contour line to the next; every fifth is thick")):
                interval = self._drag(f"{TYPE_ROW}interval", shown.interval, 0.1)
            if interval is not None:
                session.view.show_as(shown.with_interval(interval))
        if name is None:
            return
        if session.view.map is not None:
            session.show(None)
        chosen = look_of(name, session.plan, METRES_IN[self.land.unit])
        session.view.show_as(chosen)
        if chosen is None and name != LOOKS[0]:
            session.notes.append(tr("this sketch has no heights that a look could show"))

    def _metres(self, session: Session, preferences: Preferences) -> None:
        assert session.plan is not None
        terrain, unit = session.plan.terrain, self.land.unit
        relief, extent, base = terrain.relief, terrain.extent, terrain.base_elevation
        with _terrain_row(session, "relief", tr("Relief"), tr("From height 0 to height 1")):
            if relief is not None:
                self._length(session, "relief", relief, low=0.0)
        with _terrain_row(session, "extent", tr("Extent"), tr("West to east, and south to north")):
            if extent is not None:
                self._extent(session, extent)
        if terrain.size is not None:
            self._size(session, terrain.size)
        note = tr("Of height 0, above the sea")
        with _terrain_row(session, "base_elevation", tr("Base elevation"), note):
            self._length(session, "base_elevation", base or 0.0, low=-1e6)
        with row(tr("Units"), tr("In which lengths are shown here; files have metres")):
            for name in METRES_IN:
                if imgui.radio_button(f"{name}###unit {name}", unit == name):
                    preferences.choose(is_in_feet=name == "ft")
                    look = session.view.look
                    if look is not None and look.interval is not None:  # a round number of that unit
                        session.view.show_as(look_of(look.name, session.plan, METRES_IN[name]) or look)
                imgui.same_line()
            imgui.new_line()

    def _length(self, session: Session, key: str, metres: float, *, low: float, label: str = "") -> None:
        value = self._drag(label or f"{TYPE_ROW}{key}", metres, low)
        if value is not None:
            session.drafts.set(key, value)

    def _drag(self, label: str, metres: float, low: float) -> float | None:
        """Draw a length; return it in metres where it changed."""
        land = self.land
        shown = land.shown(metres)
        speed = max(abs(shown) * 0.005, 0.05)
        places = 0 if abs(shown) >= 100 else 1
        form = f"%.{places}f {land.unit}"
        high = land.shown(1e8)
        changed, now = imgui.drag_float(label, shown, speed, land.shown(low), high, form, _CLAMP)
        return land.metres(now) if changed and now != shown else None

    def _extent(self, session: Session, extent: tuple[float, float]) -> None:
        wide, gap = imgui.calc_item_width(), imgui.get_style().item_inner_spacing.x
        values = list(extent)
        for at, name in enumerate("xy"):
            if at:
                imgui.same_line(0, gap)
            imgui.set_next_item_width((wide - gap) / 2)
            value = self._drag(f"{TYPE_ROW}extent.{name}", extent[at], 0.001)
            if value is not None:
                values[at] = max(value, 0.001)
        if tuple(values) != extent:
            session.drafts.set("extent", tuple(values))

    def _sea(self, sketch: Sketch, session: Session, draft: Draft, rows: ParameterRows) -> None:
        self._parameters(sea_items(draft), sketch, rows)
        levels, values = level_items(draft), values_of(draft.sketch)
        for item in levels:
            value = values[item.leaf]
            with _terrain_row(session, item.path, tr_label(item.title), item.parameter.tooltip):
                if isinstance(value, int | float):
                    self._length(session, item.path, float(value), low=item.parameter.widget.low or -1e6)
        if not levels:
            with row(tr("Sea level"), tr("The elevation that the sea lies at")):
                imgui.align_text_to_frame_padding()
                imgui.text_disabled(tr("no sea here"))
                imgui.set_item_tooltip(
                    tr("Its view draws no water: view/terrain has a sea, other views may not")
                )

    def _size(self, session: Session, size: tuple[int, int]) -> None:
        note = tr("Texels from west to east, and from south to north; Enter takes what is typed")
        with _terrain_row(session, "size", tr("Size"), note):
            self._draw_size(session, size)

    def _draw_size(self, session: Session, size: tuple[int, int]) -> None:
        text = size_text(size)
        wide, side = imgui.calc_item_width(), imgui.get_frame_height()
        imgui.set_next_item_width(wide - side)
        enter = imgui.InputTextFlags_.enter_returns_true
        label = f"{TYPE_ROW}size"
        entered, typed = imgui.input_text(label, self.land.size_text or text, enter)
        self.land.size_text = typed if imgui.is_item_active() else ""
        if entered and typed != text:
            session.drafts.set("size", typed.replace(" ", "").replace("×", "x"))
        imgui.same_line(0, 0)
        no_preview = imgui.ComboFlags_.no_preview.value
        imgui.set_next_item_width(side)
        chosen = choose(f"{TYPE_ROW}sizes", "", aspect_sizes(size), size, name=size_text, flags=no_preview)
        if chosen is not None:
            session.drafts.set("size", chosen)

    # ── where it is seen from ────────────────────────────────────────────────

    def _camera(self, session: Session, walk: Walk) -> None:
        sketch = session.sketch
        if sketch is None or not session.orbits:
            imgui.text_disabled(tr("this picture has no camera"))
            return
        if button(f"{tr('From above')}###above", tr("All of the terrain as a map, north up")):
            session.turn_table(False)
            session.drafts.set_camera(from_above(sketch.camera))
        imgui.same_line()
        if button(f"{tr('North up')}###north", tr("Looks north, from as high as now")):
            session.turn_table(False)
            session.drafts.set_camera(north_up(sketch.camera))
        turns = session.view.turning
        label = tr("Stop") if turns else tr("Turntable")
        next_in_row(label)
        if button(f"{label}###turntable", tr("Goes slowly around the terrain")):
            walk.end()
            session.turn_table(not turns)
        label = tr("Stop walking") if walk.on else tr("Walk")
        next_in_row(label)
        note = tr(
            "On the ground, from the picture's middle: W A S D or arrows, drag to look, wheel for speed"
        )
        if button(f"{label}###walk", f"{note} (W)"):
            walk.toggle()
        with row(tr("Views"), tr("A click goes there; with Shift, or the right button, it keeps this view")):
            with _narrow_buttons():
                self._views(session)

    def _views(self, session: Session) -> None:
        for number in VIEWS:
            kept = number in session.view.views
            mark = "●" if kept else ""
            note = tr("View {number}", number=number) if kept else tr("Empty: Shift+click keeps this")
            pressed = button(f"{number}{mark}###view {number}", note)
            stores = imgui.is_item_clicked(1) or (pressed and imgui.get_io().key_shift)
            if stores:
                keep_view(session, number)
                session.notes.append(tr("kept as view {number}", number=number))
            elif pressed and not recall_view(session, number):
                session.notes.append(tr("view {number} is empty: Shift+click keeps this one", number=number))
            imgui.same_line(0, imgui.get_style().item_inner_spacing.x)
        imgui.new_line()


def _narrow_buttons() -> AbstractContextManager[None]:
    """Draw the block's buttons with less room beside their words, as high as rows are."""
    style = imgui.get_style()
    narrow = ImVec2(style.item_inner_spacing.x, style.frame_padding.y)
    return styled(sizes={imgui.StyleVar_.frame_padding: narrow})


@contextmanager
def _terrain_row(session: Session, key: str, label: str, note: str) -> Iterator[None]:
    """Draw the row of one of the terrain's own numbers, with a reset where it is edited."""
    edited = session.shown is not None and session.shown.edits.has(key)
    end = imgui.get_cursor_pos_x() + imgui.get_content_region_avail().x
    with row(label, f"{note}\n{key}", edited=edited):
        yield
    if edited:
        imgui.same_line(end - slot())
        if cross(f"{TYPE_ROW}{key}-reset", tr("Back to the file's value")):
            session.drafts.unset(key)


def size_text(size: tuple[int, int]) -> str:
    """Return texels as "513 × 257"."""
    return f"{size[0]} × {size[1]}"


def draw_land(session: Session, walk: Walk, look: Theme, area: Area) -> None:
    """Write in the picture's lower left corner how many times too high the land is shown, and of a walk."""
    factor, texts = session.exaggeration, []
    if factor != 1.0:
        texts.append(tr("heights ×{factor}", factor=numeral(factor)))
    if walk.on:
        texts.append(tr("walking, {speed} m/s; Esc ends", speed=numeral(walk.speed, ".3g")))
    if not texts or session.plan is None:
        return
    margin = 14 * look.scale
    plate(
        imgui.get_background_draw_list(),
        "\n".join(texts),
        (area[0] + margin, area[1] + area[3] - margin),
        ink=theme.packed(theme.palette.ink),
        ground=theme.packed(theme.palette.ground, 0.85),
        padding=6 * look.scale,
        rounding=5 * look.scale,
        align=(0.0, 1.0),
    )
