"""Decide between what was set by hand and what the files say: one rule, for a reload and for a new start.

What the hand set stays, unless the files have come to say another value of their own
accord: by the sketch's own ``set``, put there, changed or taken away, or by its land. A
new default alone is no newer word.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from playground.errors import ParameterError
from playground.sketch.assign import LAND, resolve, values_of
from playground.sketch.model import Sketch, Value
from playground.sketch.values import write


@dataclass(frozen=True, slots=True)
class Said:
    """What the files say of a parameter."""

    value: Value | None  # None: of the land, left to the heightmap
    own: bool  # by the sketch's own ``set`` or land; else by a default or inside a technique


def said_by_files(sketch: Sketch, paths: Iterable[str]) -> dict[str, Said]:
    """Return what the files say of each parameter, by its path; those that are gone are left out."""
    wanted = tuple(paths)
    if not wanted:
        return {}
    known, own = values_of(sketch), _set_by(sketch)
    found = {}
    for path in wanted:
        if path in LAND:
            found[path] = Said(getattr(sketch, path), True)
            continue
        try:
            leaf = resolve(sketch.graph, path)[0].path
        except ParameterError:
            continue
        found[path] = Said(known[leaf], leaf in own)
    return found


def newer_word(
    path: str, was: Mapping[str, Said], now: Mapping[str, Said], locked: Iterable[str] = ()
) -> Said | None:
    """Return what the files say where it goes before what was set by hand; None where the hand's stays.

    ``was`` is what they said when it was set by hand, as ``said_by_files`` gives it, or when it was last
    seen to stand; ``locked`` are the paths whose values stay whatever the files say.
    """
    before, after = was.get(path), now.get(path)
    if path in locked or before is None or after is None or before.value == after.value:
        return None
    return after if before.own or after.own else None


def notice(sketch: Sketch, path: str, value: Value, said: Said) -> str:
    """Return the sentence that tells of a value that gave way; "" where the files say that very value."""
    if said.value == value:
        return ""
    if said.value is None or path in LAND:
        return f"{path}: the file's new value is taken"
    parameter = resolve(sketch.graph, path)[0].parameter
    return f"{path}: the file's new value, {write(parameter, said.value)}, is taken"


def _set_by(sketch: Sketch) -> set[str]:
    """Return the paths of the parameters that the sketch's own passes set."""
    return {
        f"{spec.name}.{target.path}"
        for spec in sketch.graph.passes
        for path, _ in spec.values
        for target in resolve(spec.technique, path)
    }
