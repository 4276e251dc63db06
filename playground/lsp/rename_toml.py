"""Find what a sketch or a technique says of a parameter, to rename it there."""

from __future__ import annotations

import re
from collections.abc import Collection
from pathlib import Path

from playground.errors import PlaygroundError
from playground.lsp.documents import Document
from playground.lsp.sketch_text import SketchText
from playground.shader.source import read_text
from playground.sketch.assign import find_targets
from playground.sketch.model import Graph, Parameter, Technique
from playground.sketch.toml_text import TomlPlaces

Edit = tuple[int, int, str]
"""Where a text begins and ends that is replaced, and by what."""

_QUOTED = re.compile(r"\"([^\"\n]*)\"|'([^'\n]*)'")


def edits_in_toml(
    document: Document, parameter: Parameter, files: Collection[Path], name: str, new: str
) -> list[Edit]:
    """Return the edits that rename a parameter in a sketch's or a technique's text.

    ``files`` are those that declare it or read it; ``name`` is what it is called, ``new`` what it will be.
    """
    sketch = SketchText(document)
    edits: list[Edit] = []

    def is_meant(technique: Technique | None, path: str) -> bool:
        """Return whether the last part of a path is the parameter's own name."""
        if technique is None or path.rpartition(".")[2] != name:
            return False
        targets = find_targets(technique, path)
        if not any((t.parameter.file, t.parameter.line) == (parameter.file, parameter.line) for t in targets):
            return False
        head, _, rest = path.partition(".")
        if isinstance(technique, Graph) and rest:
            spec = technique.find(head)
            return spec is not None and is_meant(spec.technique, rest)
        return not (isinstance(technique, Graph) and _exports_by_name(technique, name))

    def is_meant_in_sketch(path: str) -> bool:
        head, _, rest = path.partition(".")
        return bool(rest) and is_meant(sketch.technique_of(head), rest)

    for table, path, pair in sketch.settings():
        own = table[:1] in (("pass",), ("view",))
        if is_meant(sketch.technique(table), path) if own else is_meant_in_sketch(path):
            key = document.text[pair.key : pair.value]
            at = [match.start() for match in re.finditer(rf"(?<!\w){name}(?!\w)", key)][-1]
            edits.append((pair.key + at, pair.key + at + len(name), new))
    for key_path, pair in sketch.places.pairs.items():
        if key_path != ("main",) and key_path[:1] != ("parameters",):
            continue
        for match in _QUOTED.finditer(document.text, pair.value, pair.end):
            text = match[1] if match[1] is not None else match[2]
            if is_meant_in_sketch(text):
                end = match.end() - 1
                edits.append((end - len(name), end, new))
    return edits


def _exports_by_name(technique: Graph, name: str) -> bool:
    """Return whether a technique's text writes an export of that name, which then is its own."""
    try:
        return ("parameters", name) in TomlPlaces(read_text(Path(technique.path))).pairs
    except PlaygroundError:
        return False
