"""The channels of another tool's shader in the panel: what feeds each, and a chooser for it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from imgui_bundle import imgui

from playground.sketch.model import PassSpec, Sketch
from playground.studio.channels.channels import (
    Channel,
    channels,
    endings_of,
    file_of,
    note_of,
    source_label,
    source_of,
    sources,
)
from playground.studio.draw import choose, cross, fitting_choice, row, slot
from playground.studio.edits.edits import Draft
from playground.studio.language import tr
from playground.studio.panel.parameter_list import shown_values
from playground.studio.session import Session
from playground.studio.theme import Theme
from playground.studio.widgets import WidgetSlot, draw_value, explanation


@dataclass
class ChannelRows:
    """The rows of one panel; what may feed a channel is computed once."""

    _sources: dict[str, list[str]] = field(default_factory=dict)
    _sources_of: Sketch | None = None

    def draw(self, spec: PassSpec, draft: Draft, session: Session, look: Theme) -> None:
        """Draw the channels of a pass."""
        edited = {path for path, _ in draft.edits.channels}
        for channel in channels(draft.base):
            if channel.spec == spec.name:
                self._row(channel, draft, session, edited=channel.path in edited)
                self._file(channel, draft, session, look)

    def _row(self, channel: Channel, draft: Draft, session: Session, *, edited: bool) -> None:
        base, end = draft.base, imgui.get_cursor_pos_x() + imgui.get_content_region_avail().x
        with row(channel.name, lambda: note_of(base, channel), edited=edited):
            # The options are computed in an open list only: that tries each of them.
            shown = fitting_choice(source_label(base, channel.source))
            options = (source for source in self._sources_for(channel.path, base))
            source = choose(
                f"##feeds {channel.path}",
                shown,
                options,
                channel.source,
                name=lambda s: source_label(base, s),
                flags=imgui.ComboFlags_.height_large.value,
            )
        in_file = source_of(draft.file, channel.path)
        if edited and in_file:
            imgui.same_line(end - slot())
            if cross(f"##reset {channel.path}", tr("Back to what the file feeds it")):
                source = in_file
        if source is not None and source != channel.source:
            session.drafts.feed(channel.path, source)

    def _file(self, channel: Channel, draft: Draft, session: Session, look: Theme) -> None:
        """Draw the field of the file that feeds a channel, if one does."""
        file = file_of(draft.base, channel)
        if file is None:
            return
        path, parameter = file
        values = shown_values(draft)
        with row("  " + tr("file"), lambda: explanation(parameter, path), edited=path in values.changed):
            endings = endings_of(draft.base, channel.source)
            position = WidgetSlot(f"##of {channel.path}", look.scale, Path(draft.file.folder), endings)
            new = draw_value(parameter, values.of[path], position)
        if new is not None:
            session.drafts.set(path, new)

    def _sources_for(self, path: str, base: Sketch) -> Iterator[str]:
        if self._sources_of is not base:
            self._sources_of, self._sources = base, {}
        if path not in self._sources:
            self._sources[path] = sources(base, path)
        yield from self._sources[path]
