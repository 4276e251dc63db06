"""Find defaults that have no effect because a sketch, a technique or the user sets the parameter.

Someone who edits such a default in a kernel sees nothing change.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from playground.errors import Diagnostic
from playground.paths import GLSL, shown
from playground.sketch.assign import apply, effective_values, resolve
from playground.sketch.model import Graph, Parameter, Sketch, Value
from playground.sketch.values import write

PANEL = "the panel"
"""The name in messages of what sets a value that no file sets."""


@dataclass(frozen=True, slots=True)
class Shadowed:
    """A parameter whose default has no effect."""

    path: str  # of the parameter, in the sketch
    parameter: Parameter
    value: Value  # what it is instead
    by: str  # "sketch.toml:15", or the panel

    def __str__(self) -> str:
        return f"{self.path}: the {self._words}"

    @property
    def _words(self) -> str:
        default, value = write(self.parameter, self.parameter.default), write(self.parameter, self.value)
        return f"default is {default}; {self.by} sets {value}"

    @property
    def warning(self) -> Diagnostic:
        """The same as a warning, at the line of the default."""
        message = f"the {self._words} in pass '{self.path.rpartition('.')[0]}'"
        return Diagnostic(message, shown(self.parameter.file), self.parameter.line, severity="warning")


def shadowed_by_files(sketch: Sketch) -> list[Shadowed]:
    """Return the defaults in the sketch's own kernels that its own files set over.

    Techniques that ship are there to be set, and users know what they set.
    """
    by, values = _setters(sketch.graph, ""), effective_values(sketch.graph)
    by_user = {target.path for path, _ in sketch.overrides for target in resolve(sketch.graph, path)}
    found = []
    for path, parameter in sketch.graph.leaf_parameters.items():
        own = not Path(parameter.file).is_relative_to(GLSL)
        if own and path in by and path not in by_user and values[path] != parameter.default:
            found.append(Shadowed(path, parameter, values[path], by[path]))
    return found


def newly_shadowed(before: Sketch, now: Sketch) -> list[Shadowed]:
    """Return the parameters whose default an edit has changed, to no effect.

    ``now`` is the sketch after the edit, with what is set by the user in it.
    """
    was = {path: parameter.default for path, parameter in before.graph.leaf_parameters.items()}
    changed = {
        path: parameter
        for path, parameter in now.graph.leaf_parameters.items()
        if path in was and was[path] != parameter.default
    }
    if not changed:
        return []
    by, values = _setters(now.graph, ""), effective_values(now.graph)
    layers = [(f"{shown(now.file)}:{one.line}", one.values) for one in reversed(now.keyframes)]
    for who, pairs in [*layers, (PANEL, now.overrides)]:
        apply(now.graph, values, pairs)
        by |= {target.path: who for path, _ in pairs for target in resolve(now.graph, path)}
    return [
        Shadowed(path, parameter, values[path], by[path])
        for path, parameter in changed.items()
        if path in by and values[path] != parameter.default
    ]


def _setters(graph: Graph, prefix: str) -> dict[str, str]:
    """Return "file:line" of what sets each parameter that a ``set`` names; the outermost counts."""
    found: dict[str, str] = {}
    for spec in graph.passes:
        inside = f"{prefix}{spec.name}."
        if isinstance(spec.technique, Graph):
            found |= _setters(spec.technique, inside)
        lines = dict(spec.set_lines)
        for path, _ in spec.values:
            for target in resolve(spec.technique, path):
                found[f"{inside}{target.path}"] = f"{spec.file}:{lines.get(path, spec.line)}"
    return found
