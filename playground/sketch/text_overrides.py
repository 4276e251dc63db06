"""A sketch with other texts in place of its shaders' files'; nothing is written.

What the texts declare takes the place of the kernels that were made of those files.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

from playground.errors import DataError
from playground.paths import GLSL
from playground.sketch.assign import find_targets
from playground.sketch.composed import composed
from playground.sketch.dialects import read_foreign
from playground.sketch.header import parse_kernel
from playground.sketch.model import Graph, Kernel, Sketch, Technique, with_inner
from playground.sketch.source import read_source
from playground.sketch.techniques import Techniques


def with_texts(sketch: Sketch, texts: Mapping[str, str]) -> Sketch:
    """Return the sketch with texts, by absolute path, in place of those of its shaders' files.

    Texts of files that the sketch does not use change nothing. Where a text says something else
    than its file, the fast variants of what is made of it no longer agree, and do not run. A main
    parameter that a text no longer declares is one no more.

    Raises ``DataError`` where a text leaves no kernel of its file, and ``ShaderError`` where
    a text's declarations or includes are wrong.
    """
    if not texts:
        return sketch
    known: dict[int, Any] = {}  # one technique may be in several passes

    def reread(technique: Technique) -> Technique:
        """Return the technique itself where none of the texts is in it."""
        if not any(file in texts for file in technique.files):
            return technique
        if id(technique) not in known:
            variants = tuple(replace(v, technique=reread(v.technique)) for v in technique.variants)
            if isinstance(technique, Graph) and technique.parts:
                known[id(technique)] = composed(technique.name, *map(reread, technique.parts))
            elif isinstance(technique, Graph) and technique.dialect:
                known[id(technique)] = _read_again(technique, texts, Path(sketch.folder))
                if technique is sketch.graph:  # of a sketch all are at view
                    known[id(technique)] = replace(known[id(technique)], inputs=(), parameters=())
            elif isinstance(technique, Graph):
                known[id(technique)] = replace(with_inner(technique, reread), variants=variants)
            else:
                kernel = _parsed_again(technique, texts, Path(sketch.folder))
                known[id(technique)] = replace(kernel, variants=variants)
        return cast(Technique, known[id(technique)])

    graph = cast(Graph, reread(sketch.graph))
    return replace(sketch, graph=graph, main=tuple(path for path in sketch.main if find_targets(graph, path)))


def _read_again(graph: Graph, texts: Mapping[str, str], folder: Path) -> Graph:
    """Return another tool's shader by its texts."""
    path = Path(graph.path)
    root = GLSL if path.is_relative_to(GLSL) else folder
    found = read_foreign(path, graph.name, root, Techniques().read, graph.dialect, instead=texts)
    if found is None:
        raise DataError("no shader is left of this text", file=path)
    return found


def _parsed_again(kernel: Kernel, texts: Mapping[str, str], folder: Path) -> Kernel:
    path = Path(kernel.path)
    root = folder if not path.is_relative_to(GLSL) else GLSL
    found = parse_kernel(kernel.name, read_source(path, (root,), texts))
    if found is None:
        raise DataError("no kernel is left of this text", file=path)
    if kernel.kind == "compute":  # a compute variant has these of its technique
        return replace(found, outputs=kernel.outputs, accepts=kernel.accepts)
    return found
