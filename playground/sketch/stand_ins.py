"""Know when a saved text shows nothing, for a compute companion stands in for it."""

from __future__ import annotations

from collections.abc import Iterator

from playground.paths import shown
from playground.sketch.model import Graph, Sketch, Technique


def stand_ins(before: Sketch, after: Sketch) -> list[str]:
    """Return a sentence for each companion that stands in for what has changed between two readings."""
    return list(dict.fromkeys(_stand_ins(before.graph, after.graph)))


def _stand_ins(before: Technique, after: Technique) -> Iterator[str]:
    if before is after or before == after:
        return
    companion = after.companion
    if companion is not None and companion == before.companion:
        name = shown(companion.path)
        yield (
            f"{name} stands in for what was saved, where there are compute shaders: change it as well,"
            " or open with --driver fragment"
        )
    elif isinstance(before, Graph) and isinstance(after, Graph):
        for spec in after.passes:
            old = before.find(spec.name)
            if old is not None:
                yield from _stand_ins(old.technique, spec.technique)
