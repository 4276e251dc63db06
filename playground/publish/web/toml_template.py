"""Cut a TOML text where a page may write into it: a value, a technique's name, the end of a table.

Python knows how a file writes its tables (in braces, under a header, by dotted keys); the page, which
cannot run Python, fills in what was changed. With nothing filled in, the pieces are the text.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from playground.paths import GLSL
from playground.shader.source import normalised
from playground.sketch.assign import TERRAIN_KEYS, resolve, shown_parameters
from playground.sketch.model import Camera, Graph, Sketch
from playground.sketch.save import table_of, with_view
from playground.sketch.toml_text import KeyPath, TomlPlaces, key_text

Piece = str | dict[str, Any]
"""A part of the text, or a hole: ``{path, was}`` a parameter's value, ``{camera, was}`` and ``{terrain,
was}`` likewise; ``{use, of}`` the name of a technique and its file; ``{into, open, join, close, was}`` the
end of a table, where keys that the file has not yet go: of a pass, "#camera" or "#terrain"; ``{aside}`` a
parameter that the file sets in parts."""

TERRAIN, CAMERA = "#terrain", "#camera"


@dataclass(frozen=True)
class _Cut:
    """What is written in place of a part of the text."""

    start: int
    end: int
    hole: dict[str, Any]


def sketch_pieces(text: str, sketch: Sketch, named: Callable[[str], str]) -> list[Piece]:
    """Return a sketch's TOML in pieces; ``named`` gives the page's name of a file by its absolute path.

    ``text`` says what ``sketch`` does. Of a parameter that the file sets in a way that has no single
    value, as an angle of a direction, there is no hole.
    """
    text = normalised(text)
    text = with_view(text if text.endswith("\n") else f"{text}\n", sketch, "view")
    places = TomlPlaces(text)
    cuts = list(_uses(text, places, sketch.graph, named))
    cuts += _known(text, places, (), ((key, {"terrain": key}) for key in TERRAIN_KEYS))
    cuts.append(_insertion(text, places, (), TERRAIN))
    camera: KeyPath = ("view", "camera")
    names = [part.name for part in fields(Camera)]
    cuts += _known(text, places, camera, ((name, {"camera": name}) for name in names))
    cuts.append(_insertion(text, places, camera, CAMERA))
    rows = {
        frozenset(t.path for t in resolve(sketch.graph, row.path)): row.path
        for row in shown_parameters(sketch)
    }
    for spec in sketch.graph.passes:
        table = (*table_of(sketch, spec.name), "set")
        keys = [
            (key, frozenset(t.path for t in resolve(sketch.graph, f"{spec.name}.{key}")))
            for key, _ in spec.values
        ]
        cuts += _known(
            text, places, table, ((key, {"path": rows[mine]}) for key, mine in keys if mine in rows)
        )
        split = [rows[mine] for key, mine in keys if mine in rows and places.find(table, key) is None]
        cuts += [_Cut(len(text), len(text), {"aside": path}) for path in split]
        cuts.append(_insertion(text, places, table, spec.name))
    return _pieces(text, cuts)


def technique_pieces(text: str, graph: Graph, named: Callable[[str], str]) -> list[Piece]:
    """Return the TOML of a technique of several passes in pieces, cut at the techniques that it names."""
    text = normalised(text)
    return _pieces(text, _uses(text, TomlPlaces(text), graph, named))


def _uses(text: str, places: TomlPlaces, graph: Graph, named: Callable[[str], str]) -> Iterator[_Cut]:
    """Yield the names of shipped techniques."""
    for index, spec in enumerate(graph.passes):
        own = ("view",) if spec.name == "view" else ("pass", index)
        pair = places.pairs.get((*own, "use"))
        if pair is None or spec.use.startswith("./"):
            continue
        start = text.index(spec.use, pair.value, pair.end)
        hole = {"use": spec.use, "of": named(spec.technique.path)}
        yield _Cut(start, start + len(spec.use), hole)


def _known(
    text: str, places: TomlPlaces, table: KeyPath, holes: Iterable[tuple[str, dict[str, Any]]]
) -> Iterator[_Cut]:
    """Yield the values that a table has already."""
    for key, hole in holes:
        pair_found = places.find(table, key)
        if pair_found is not None:
            pair = places.pairs[pair_found]
            yield _Cut(pair.value, pair.end, {**hole, "was": text[pair.value : pair.end]})


def _insertion(text: str, places: TomlPlaces, table: KeyPath, into: str) -> _Cut:
    """Return where keys are added to a table, in the way that it is written."""
    pairs = places.inside(table)
    if table in places.pairs:
        own = places.pairs[table]
        if pairs:
            return _cut(text, pairs[-1].end, pairs[-1].end, into, ", ", ", ", "")
        return _cut(text, own.value, own.end, into, "{ ", ", ", " }")
    if table in places.bodies:
        return _lines(text, places.bodies[table], into, "")
    around = next(table[:n] for n in range(len(table) - 1, -1, -1) if table[:n] in places.bodies)
    prefix = ".".join(key_text(str(part)) for part in table[len(around) :])
    if pairs:
        return _lines(text, pairs[-1].end, into, f"{prefix}.")
    cut = _lines(text, places.bodies[around], into, "")
    indent = cut.hole["open"]
    return _cut(text, cut.start, cut.end, into, f"{indent}{prefix} = {{ ", ", ", " }\n")


def _lines(text: str, position: int, into: str, prefix: str) -> _Cut:
    """Return what adds lines behind the one that a position is on, indented as that one is."""
    start = text.rfind("\n", 0, position) + 1
    line = text[start:position]
    indent = line[: len(line) - len(line.lstrip(" \t"))]
    end = text.index("\n", position) + 1
    return _cut(text, end, end, into, f"{indent}{prefix}", f"\n{indent}{prefix}", "\n")


def _cut(text: str, start: int, end: int, into: str, begin: str, join: str, close: str) -> _Cut:
    return _Cut(
        start, end, {"into": into, "open": begin, "join": join, "close": close, "was": text[start:end]}
    )


def _pieces(text: str, cuts: Iterable[_Cut]) -> list[Piece]:
    pieces: list[Piece] = []
    at = 0
    # An insertion behind a value comes after it, and those at one place in the order of the tables.
    for cut in sorted(cuts, key=lambda cut: (cut.start, cut.end)):
        if cut.start > at:
            pieces.append(text[at : cut.start])
        pieces.append(cut.hole)
        at = cut.end
    return [*pieces, text[at:]] if at < len(text) else pieces


def page_name(path: str) -> str:
    """Return the name of a file of the library, as sketches use and include it."""
    return Path(path).relative_to(GLSL).as_posix()
