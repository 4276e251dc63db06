"""Merge user edits with what the files set: one rule, for a reload and for a new start.

An edit stays, unless the files now set another value themselves: by the sketch's own ``set``,
added, changed or removed, or by its size, extent or relief. A new default alone does not win.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from playground.data.content_hash import content_key
from playground.errors import DataError, ParameterError
from playground.shader.parameter import write
from playground.sketch.assign import TERRAIN_KEYS, resolve, values_of
from playground.sketch.model import Sketch, Value


@dataclass(frozen=True, slots=True)
class FileValue:
    """What the files say of a parameter."""

    value: Value | None  # None: of the terrain, left to the heightmap
    own: bool  # by the sketch itself; else by a default or inside a technique


def file_values(sketch: Sketch, paths: Iterable[str]) -> dict[str, FileValue]:
    """Return what the files say of each parameter, by its path; those that are gone are left out."""
    paths_wanted = tuple(paths)
    if not paths_wanted:
        return {}
    values_in_file, own = values_of(sketch), _set_by(sketch)
    values_found = {}
    for path in paths_wanted:
        if path in TERRAIN_KEYS:
            values_found[path] = FileValue(getattr(sketch.terrain, path), True)
            continue
        try:
            leaf = resolve(sketch.graph, path)[0].path
        except ParameterError:
            continue
        values_found[path] = FileValue(values_in_file[leaf], leaf in own)
    return values_found


def newer_value(
    path: str, was: Mapping[str, FileValue], now: Mapping[str, FileValue], locked: Iterable[str] = ()
) -> FileValue | None:
    """Return what the files say where it wins over the user's edit; None where the edit stays.

    ``was`` is what they set when it was edited or last shown, as ``file_values`` gives it; ``locked``
    are the paths whose values stay over any change of the files.
    """
    before, after = was.get(path), now.get(path)
    if path in locked or before is None or after is None or before.value == after.value:
        return None
    return after if before.own or after.own else None


def notice(sketch: Sketch, path: str, value: Value, newer: FileValue) -> str:
    """Return the sentence that reports an edit that gave way; "" where the files say that very value."""
    if newer.value == value or _same_file(sketch, value, newer.value):
        return ""
    if newer.value is None or path in TERRAIN_KEYS:
        return f"{path}: the file's new value is taken"
    parameter = resolve(sketch.graph, path)[0].parameter
    return f"{path}: the file's new value, {write(parameter, newer.value)}, is taken"


def _same_file(sketch: Sketch, value: Value, newer: Value | None) -> bool:
    """Return whether two paths lead to the same contents: saving copies files next to the sketch."""
    if not (isinstance(value, str) and isinstance(newer, str)):
        return False
    folder = Path(sketch.folder)
    try:
        return content_key(folder / value) == content_key(folder / newer)
    except DataError:
        return False


def _set_by(sketch: Sketch) -> set[str]:
    """Return the paths of the parameters that the sketch's own passes set."""
    return {
        f"{spec.name}.{target.path}"
        for spec in sketch.graph.passes
        for path, _ in spec.values
        for target in resolve(spec.technique, path)
    }
