"""Write down traced texts: of each kernel of a page its fragment shader that records, and what that records.

See ``TracedText`` in schema.js, ``playground.engine.trace`` for the method, and trace_run.js for what draws
it. A text is written at export: what is edited in a page has none.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from playground.engine.trace.instrument import ALL, instrument
from playground.engine.trace.model import Place
from playground.errors import ShaderError
from playground.publish.web.texts import Texts
from playground.shader.source import SourceText
from playground.shader.stage_recipe import Recipe
from playground.shader.wrap import ShaderStage
from playground.sketch.model import CpuSource, Draw, Kernel

MAX_PLACES = 2_000
"""Places of a text that record; of one with more, its own file's functions alone are traced."""

_VERSION = re.compile(r"^[ \t]*#[ \t]*version\b.*$", re.MULTILINE)


def trace_data(
    kernel: Kernel, recipes: Mapping[str, Recipe], texts: Texts, folder: str, label: str
) -> dict[str, Any] | None:
    """Return the traced text of a kernel as data, or why it has none; None for what no shader computes.

    ``label`` names its text as ``Texts.add`` was told.
    """
    if isinstance(kernel, CpuSource):
        return None
    if isinstance(kernel, Draw) or recipes["vertex"].source is not recipes["fragment"].source:
        return {"lacks": f"{label} draws a mesh, which the trace of a page does not follow"}
    recipe = recipes["fragment"]
    text, first = recipe.make()
    # As GLSL ES, where globals begin with constants alone; the page gives it what else ES wants.
    stage = ShaderStage(_VERSION.sub("#version 300 es", text, count=1), first, recipe.source, "")
    try:
        traced = instrument(stage, ALL)
        if len(traced.places) > MAX_PLACES:
            traced = instrument(stage)
    except ShaderError as error:
        return {"lacks": error.diagnostics[0].message}
    places = _Places(texts, recipe.source, folder, label)
    return {
        "text": traced.text,
        "quads": traced.quads,
        "places": [places.row(place) for place in traced.places],
        "structs": {name: [list(member) for member in members] for name, members in traced.structs.items()},
        "files": places.files,
    }


class _Places:
    """The places of one text, whose files have a page's names."""

    def __init__(self, texts: Texts, source: SourceText, folder: str, label: str) -> None:
        self._lines = texts.lines_of(source, folder, label)
        self.files = list(dict.fromkeys(file for file, _ in self._lines.values()))
        self._numbers = {file: number for number, file in enumerate(self.files)}

    def row(self, place: Place) -> list[Any]:
        """Return kind, name, function, type, number of the file, line, last line, and the loops around it."""
        file, line = self._lines.get((place.path, place.line), (self.files[0], 1))
        last = self._lines.get((place.path, place.end_line), (file, line))[1]
        return [
            place.kind,
            place.name,
            place.function,
            place.type,
            self._numbers[file],
            line,
            last,
            list(place.loops),
        ]
