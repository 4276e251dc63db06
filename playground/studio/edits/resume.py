"""User edits of an earlier session, over the files as they are now."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from playground.errors import PlaygroundError
from playground.sketch.model import Camera, Sketch, Value
from playground.studio.channels.channels import in_order
from playground.studio.edits.edit_merge import FileValue, file_values, newer_value, notice
from playground.studio.edits.edits import Draft, Edits, with_camera_of


@dataclass(frozen=True)
class StoredEdits:
    """User edits, and what the files set when they were made."""

    edits: Edits = field(default_factory=Edits)
    in_file: Mapping[str, FileValue] = field(default_factory=dict)  # of each edited value, where it is known
    camera_in_file: Camera | None = None  # of the camera, where another is set and it is known

    def with_values(self, values: Mapping[str, Value]) -> StoredEdits:
        """Return them with values that override those of the files."""
        edits = self.edits
        for name, value in values.items():
            edits = edits.with_value(name, value)
        return replace(self, edits=edits, in_file={k: v for k, v in self.in_file.items() if k not in values})


def stored(draft: Draft) -> StoredEdits:
    """Return a draft's edits with what its files say now."""
    in_file = file_values(draft.base, [path for path, _ in draft.edits.values])
    return StoredEdits(draft.edits, in_file, draft.file.camera if draft.edits.camera is not None else None)


def first_draft(loaded: Sketch, start: StoredEdits) -> tuple[Draft, list[str]]:
    """Return the draft to begin with, and a message for each edit that gave way to the files."""
    edits, note = with_camera_of(start.edits, start.camera_in_file or loaded.camera, loaded.camera)
    draft = Draft(loaded, loaded, replace(edits, techniques=(), channels=()))
    notes = [note] if note else []
    for name, use in edits.techniques:
        try:
            draft = draft.choose(name, use)
        except PlaygroundError as error:
            notes.append(f"{name}: {use} can no longer be used ({error.diagnostics[0].message})")
    for channel, source in in_order(edits.channels):
        try:
            draft = draft.feed(channel, source)
        except PlaygroundError as error:
            notes.append(f"{channel}: {source} can no longer feed it ({error.diagnostics[0].message})")
    now = file_values(draft.base, [path for path, _ in edits.values])
    values = []
    for path, value in edits.values:
        newer = newer_value(path, start.in_file, now, edits.locked)
        if newer is None:
            values.append((path, value))
        else:
            notes += filter(None, [notice(draft.base, path, value, newer)])
    return draft.with_edits(replace(draft.edits, values=tuple(values))), notes
