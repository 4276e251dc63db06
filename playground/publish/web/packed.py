"""Write down what "download my version" puts into a zip: see ``Pack`` in schema.js.

In the zip is the sketch as ``playground pack`` packs it, with what was changed in the page: values,
camera and terrain in its TOML, time and steps as a shot, texts in their files. A file of the library
that was edited comes into the sketch's folder under its own name, and with it what includes or uses
it, since the library's own files read from the library alone; ``use`` then names the copies.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from playground._version import __version__
from playground.allowed_files import TEXTS
from playground.errors import PlaygroundError
from playground.files import read_regular
from playground.paths import GLSL, SKETCHES
from playground.publish.web.blobs import Blobs
from playground.publish.web.toml_template import Piece, page_name, sketch_pieces, technique_pieces
from playground.shader.libraries import libraries_of
from playground.shader.source import normalised, read_text
from playground.sketch.files import contents, folder_of
from playground.sketch.find import FORMAT, MANIFEST
from playground.sketch.load import is_technique, load
from playground.sketch.model import Graph, Sketch, Technique
from playground.sketch.save import saved_text

MAX_FILE_BYTES = 4 * 2**20
"""Bytes of a file of data that a page still carries for the sake of the zip."""
_TEXTS = (*TEXTS, ".md", ".txt", "")


def pack_data(sketch: Sketch, names: Mapping[str, str], blobs: Blobs) -> dict[str, Any]:
    """Return what a page's zip of a sketch is made of; JSON's own types only.

    ``names`` are the page's names of the texts that it has, by absolute path.
    """
    listed, main, shipped = contents(sketch)
    top = folder_of(sketch)
    inside = {name.removeprefix(f"{top}/"): path for name, path in listed.items()}
    own = {str(path): name for name, path in inside.items()}

    def named(path: str) -> str:
        """Return the name by which the page knows a file, or would."""
        if path in names or not Path(path).is_relative_to(GLSL):
            return names.get(path, f"./{own.get(path, Path(path).name)}")
        return page_name(path)

    toml = _toml(sketch, named)
    graphs = {graph.path: graph for graph in _graphs(sketch.graph) if graph.path != sketch.file}
    files: dict[str, list[str]] = {}
    left_out = []
    for name, path in inside.items():
        if toml is not None and path == Path(sketch.file):
            continue
        if path.is_relative_to(SKETCHES) and path.suffix not in _TEXTS:
            shipped.append(page_name(str(path)))  # named from there: a page need not hold it
        elif str(path) in graphs:
            files[name] = ["pieces", named(str(path))]
        elif str(path) in names:
            files[name] = ["file", names[str(path)]]
        elif path.suffix in _TEXTS:
            files[name] = ["text", read_text(path, any_encoding=True)]
        elif path.stat().st_size <= MAX_FILE_BYTES:
            files[name] = ["blob", blobs.add(read_regular(path))]
        else:
            left_out.append(name)
    return {
        "folder": top,
        "main": main.removeprefix(f"{top}/"),
        "manifest": MANIFEST,
        "format": FORMAT,
        "version": __version__,
        "shipped": sorted(shipped),
        "libraries": sorted(libraries_of(sketch.files)),
        "files": files,
        "leftOut": left_out,
        "toml": toml,
        "techniques": {
            named(path): technique_pieces(read_text(Path(path)), graph, named)
            for path, graph in graphs.items()
        },
        "shots": [shot.name for shot in sketch.shots],
    }


def _toml(sketch: Sketch, named: Callable[[str], str]) -> list[Piece] | None:
    """Return the sketch's own TOML in pieces, as it is now; None for what has none."""
    path = Path(sketch.file)
    if path.suffix != ".toml" or is_technique(path):
        return None
    text = normalised(read_text(path))
    try:
        text = saved_text(text, load(path), sketch)
    except PlaygroundError:
        return None
    if path.is_relative_to(SKETCHES):
        text = _with_shipped_data(text)
    return sketch_pieces(text, sketch, named)


def _with_shipped_data(text: str) -> str:
    """Return a shipped sketch's TOML with its data files named from ``glsl/``."""
    text_filled, at = "", 0
    for match in re.finditer(r'"([^"\\\n]+)"', text):
        if (SKETCHES / match[1]).suffix not in ("", *_TEXTS) and (SKETCHES / match[1]).is_file():
            text_filled += f'{text[at : match.start()]}"{page_name(str(SKETCHES / match[1]))}"'
            at = match.end()
    return text_filled + text[at:]


def _graphs(technique: Technique) -> Iterator[Graph]:
    """Yield the techniques of several passes that files of TOML hold, each file once."""
    seen: set[str] = set()
    waiting = [technique]
    while waiting:
        graph = waiting.pop()
        if not isinstance(graph, Graph):
            continue
        if graph.path.endswith(".toml") and graph.path not in seen:
            seen.add(graph.path)
            yield graph.written
        waiting += [spec.technique for spec in graph.written.passes]
