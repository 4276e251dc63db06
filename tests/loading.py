"""Load a sketch that a test wrote: its own files each time, those of ``glsl/`` once a session."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from playground.paths import GLSL
from playground.sketch.load import load_with
from playground.sketch.model import Sketch, Technique
from playground.sketch.techniques import Techniques, WithLibrary, shipped_techniques

_LIBRARY = Techniques()


def load(name: str | Path = "") -> Sketch:
    """Load a sketch as the playground does, but read each of the library's techniques once a session."""
    return load_with(WithLibrary(_LIBRARY), name)


@cache
def library() -> dict[str, Technique]:
    """Return the techniques of ``glsl/`` by name."""
    return {name: _LIBRARY.read(name, GLSL, GLSL) for name in shipped_techniques()}
