"""Load a sketch that a test wrote: its own files each time, those of ``glsl/`` once a session."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from playground.paths import GLSL
from playground.shader.wrap import wrap
from playground.sketch.load import load_with
from playground.sketch.model import Sketch, Technique, kernels_of
from playground.sketch.techniques import Techniques, WithLibrary, shipped_techniques

_LIBRARY = Techniques()


def load(name: str | Path = "") -> Sketch:
    """Load a sketch as the playground does, but read each of the library's techniques once a session."""
    return load_with(WithLibrary(_LIBRARY), name)


@cache
def library() -> dict[str, Technique]:
    """Return the techniques of ``glsl/`` by name."""
    return {name: _LIBRARY.read(name, GLSL, GLSL) for name in shipped_techniques()}


@cache
def stages() -> dict[tuple[str, str], str]:
    """Return every stage of the library as both drivers have it, by kind and text, each with a name."""
    result: dict[tuple[str, str], str] = {}
    for name, technique in library().items():
        for form in (technique, *(variant.technique for variant in technique.variants)):
            for path, kernel in kernels_of(form):
                for driver in ("fragment", "compute") if kernel.kind != "source" else ():
                    for kind, stage in wrap(kernel, driver, 430).stages.items():
                        result.setdefault((kind, stage.text), f"{name} {path} {kind}")
    return result
