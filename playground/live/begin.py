"""Begin where an earlier session ended: what was set by hand there, over the files as they are now."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from playground.errors import PlaygroundError
from playground.live.edits import Draft, Edits
from playground.sketch.assign import resolve, values_of
from playground.sketch.model import Sketch, Value


def first_draft(loaded: Sketch, edits: Edits, in_file: Mapping[str, Value]) -> tuple[Draft, list[str]]:
    """Return the draft to begin with, and a sentence for each edit that gave way.

    ``in_file`` is what the files said of a value when it was set: where they say another
    now, they are the newer word.
    """
    draft = Draft(loaded, loaded, replace(edits, techniques=()))
    notes = []
    for name, use in edits.techniques:
        try:
            draft = draft.choose(name, use)
        except PlaygroundError as error:
            notes.append(f"{name}: {use} can no longer be used ({error.diagnostics[0].message})")
    now = said_by_files(draft.base, edits)
    kept = []
    for path, value in edits.values:
        if path in now and path in in_file and now[path] != in_file[path]:
            notes.append(f"{path}: the file says another value than when it was set; the file's is taken")
        else:
            kept.append((path, value))
    return draft.with_edits(replace(draft.edits, values=tuple(kept))), notes


def said_by_files(sketch: Sketch, edits: Edits) -> dict[str, Value]:
    """Return what the files say of each value that is set by hand, by its path as it was set."""
    known = values_of(sketch) if edits.values else {}
    found = {}
    for path, _ in edits.values:
        try:
            found[path] = known[resolve(sketch.graph, path)[0].path]
        except (PlaygroundError, KeyError):
            continue  # it is gone, or of the land: it stays as it was set
    return found
