"""Warn of what in a sketch's texts has no effect, another one than its author can see, or a former name."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from playground.errors import Diagnostic
from playground.paths import GLSL
from playground.sketch.model import Graph, Kernel, Sketch
from playground.sketch.uniforms import unfed_samplers
from playground.sketch.unused_parameters import unread


def warnings_of_kernel(kernel: Kernel) -> tuple[Diagnostic, ...]:
    """Return what a kernel's author should know: parameters that nothing reads, and ``unheeded``."""
    return (*unread(kernel), *unheeded(kernel))


def unheeded(kernel: Kernel) -> tuple[Diagnostic, ...]:
    """Return what a picture does not show though the text says it: unfed samplers, ``#line``."""
    found = [*(unfed_samplers(kernel.source) if kernel.kind.startswith("plain") else ())]
    found += [
        line.diagnostic("#line is left out, so that errors name the file's own lines", severity="warning")
        for line in kernel.source.lines
        if line.left_out
    ]
    return tuple(dict.fromkeys(found))


def former_names_used(sketch: Sketch) -> tuple[Diagnostic, ...]:
    """Return a warning for each former name in a sketch, in its own techniques or in what is set over it."""
    return tuple(dict.fromkeys([*sketch.warnings, *_of_graph(sketch.graph)]))


def _of_graph(graph: Graph) -> Iterator[Diagnostic]:
    if not Path(graph.path).is_relative_to(GLSL):
        yield from graph.warnings
    for spec in graph.passes:
        if isinstance(spec.technique, Graph):
            yield from _of_graph(spec.technique)
