"""Begin where an earlier session ended: what was set by hand there, over the files as they are now."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from playground.errors import PlaygroundError
from playground.sketch.model import Camera, Sketch
from playground.workbench.edit_merge import Said, newer_word, notice, said_by_files
from playground.workbench.edits import Draft, Edits, with_camera_of


def first_draft(
    loaded: Sketch, edits: Edits, in_file: Mapping[str, Said], camera_in_file: Camera | None = None
) -> tuple[Draft, list[str]]:
    """Return the draft to begin with, and a sentence for each edit that gave way.

    ``in_file`` is what the files said of a value when it was last shown: see ``words`` for
    where what they say now goes before it. ``camera_in_file`` is what they said of the camera then,
    if that is known; where they say another now, theirs is taken.
    """
    edits, note = with_camera_of(edits, camera_in_file or loaded.camera, loaded.camera)
    draft = Draft(loaded, loaded, replace(edits, techniques=()))
    notes = [note] if note else []
    for name, use in edits.techniques:
        try:
            draft = draft.choose(name, use)
        except PlaygroundError as error:
            notes.append(f"{name}: {use} can no longer be used ({error.diagnostics[0].message})")
    now = said_by_files(draft.base, [path for path, _ in edits.values])
    kept = []
    for path, value in edits.values:
        said = newer_word(path, in_file, now, edits.locked)
        if said is None:
            kept.append((path, value))
        else:
            notes += filter(None, [notice(draft.base, path, value, said)])
    return draft.with_edits(replace(draft.edits, values=tuple(kept))), notes
