"""Find parameters by path, set them, and describe each as panels, remotes and pages show it.

A path is ``pass[.inner…].parameter``. A name that a technique exports means its
targets inside; every inner parameter can be reached as well.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Protocol

from playground.errors import ParameterError, nearest
from playground.memo import GRAPHS
from playground.shader.kernel import Export, Graph, Kernel, Technique
from playground.shader.parameter import MAX_SIDE, Parameter, coerce, part_names, spell
from playground.shader.widgets import Value

# How many numbers at most, which, and what a message expects.
_TERRAIN: dict[str, tuple[int, Callable[[float], bool], str]] = {
    "size": (
        2,
        lambda n: n.is_integer() and 1 <= n <= MAX_SIDE,
        f"1 to {MAX_SIDE} texels a side, as 513 or 513x257",
    ),
    "extent": (2, lambda n: 0 < n < 1e9, "metres above 0, as 10240 or 10240x8000"),
    "relief": (1, lambda n: 0 <= n < 1e9, "a number of metres, 0 or more"),
    "base_elevation": (1, lambda n: abs(n) < 1e9, "a number of metres"),
}
TERRAIN_KEYS = tuple(_TERRAIN)
"""What belongs to the sketch itself, and may be set like a parameter."""


class Settable(Protocol):
    """A sketch, as far as its parameters are concerned."""

    @property
    def name(self) -> str:
        """Its name, for messages."""

    @property
    def graph(self) -> Graph:
        """Its passes."""

    @property
    def overrides(self) -> tuple[tuple[str, Value], ...]:
        """Parameter path → value, over what its file sets."""


@dataclass(frozen=True, slots=True)
class Target:
    """A leaf parameter that a path resolves to."""

    path: str  # "height.detail.frequency"
    parameter: Parameter


@dataclass(frozen=True, slots=True)
class Shown:
    """A parameter as it is listed: one entry of a panel."""

    path: str  # as ``--set`` takes it
    parameter: Parameter  # of the first target
    exported: bool  # by its pass's technique, or the pass is a single kernel


def resolve(technique: Technique, path: str) -> tuple[Target, ...]:
    """Resolve a path to leaf parameters, at least one.

    Raises ``ParameterError`` that names the nearest path.
    """
    targets = find_targets(technique, path)
    if not targets:
        if why := why_absent(technique, path):
            raise ParameterError(f"{path}: {why}")
        raise ParameterError(f"no parameter '{path}'{nearest(path, all_paths(technique))}")
    return targets


def find_targets(technique: Technique, path: str) -> tuple[Target, ...]:
    """Resolve a path to leaf parameters; none where there is no such parameter."""
    if isinstance(technique, Kernel):
        parameter = technique.parameter(path)
        return (Target(parameter.name, parameter),) if parameter else ()
    head, _, rest = path.partition(".")
    if rest:
        spec = technique.find(head)
        result = find_targets(spec.technique, rest) if spec else ()
        return tuple([Target(f"{head}.{t.path}", t.parameter) for t in result])
    export = _export(technique, head)
    # A target is a path inside: one without a dot would be another export, perhaps this one.
    targets = [target for target in export.targets if "." in target] if export else []
    return tuple([targets for target in targets for targets in find_targets(technique, target)])


def why_absent(technique: Technique, path: str) -> str:
    """Return why a parameter, or a pass, of a technique's file is absent now; "" where there is none such."""
    if isinstance(technique, Kernel):
        return ""
    head, _, rest = path.partition(".")
    if (spec := technique.find(head)) is not None:
        return why_absent(spec.technique, rest)
    written = technique.written.find(head)
    if written is not None and (not rest or find_targets(written.technique, rest)):
        lacking = dict(technique.absent).get(head)
        only = f"has an effect only where '{lacking}' is wired"
        return only if lacking else "has no effect: another source takes the place of its pass"
    export = None if rest or _export(technique, head) else _export(technique.written, head)
    return why_absent(technique, export.targets[0]) if export else ""


def all_paths(technique: Technique) -> list[str]:
    """List every path that ``resolve`` takes: exported names, then inner ones."""
    if isinstance(technique, Kernel):
        return [p.name for p in technique.parameters]
    exported = [e.name for e in technique.parameters]
    inner = [f"{s.name}.{p}" for s in technique.passes for p in all_paths(s.technique)]
    return exported + inner


def shown_parameters(sketch: Settable) -> Iterator[Shown]:
    """Yield every parameter of a sketch, pass by pass, exported ones before inner ones.

    An inner parameter that is exported is not yielded a second time.
    """
    for spec in sketch.graph.passes:
        technique = spec.technique
        if isinstance(technique, Kernel):
            for parameter in technique.parameters:
                yield Shown(f"{spec.name}.{parameter.name}", parameter, True)
            continue
        covered: set[str] = set()
        for export in technique.parameters:
            targets = resolve(technique, export.name)
            covered |= {t.path for t in targets}
            parameter = replace(targets[0].parameter, name=export.name)
            yield Shown(f"{spec.name}.{export.name}", parameter, True)
        for path, parameter in technique.leaf_parameters.items():
            if path not in covered:
                yield Shown(f"{spec.name}.{path}", parameter, False)


def described(shown: Shown) -> dict[str, Any]:
    """Return what is true of a parameter whatever its value is; ``ranges`` has one for each number."""
    parameter = shown.parameter
    names = part_names(parameter)
    return {
        "path": shown.path,
        "label": parameter.title,
        "pass": shown.path.partition(".")[0],
        "group": parameter.group,
        "description": parameter.tooltip,
        "widget": parameter.widget.kind,
        "type": parameter.type,
        "ranges": [range_of(parameter, part) for part in range(max(len(names), 1))],
        "step": parameter.step,
        "unit": parameter.unit or parameter.widget.facts.unit,
        "choices": list(parameter.widget.choices),
        "parts": list(names),
        "exported": shown.exported,
    }


def range_of(parameter: Parameter, part: int = 0) -> tuple[float, float] | None:
    """Return the range of a parameter's number, or of one of its parts; None where it has none."""
    facts = parameter.widget.facts
    if facts.spans:
        return facts.spans[part]
    low, high = parameter.widget.ends(part)
    if low is not None and high is not None:
        return low, high
    return facts.range


def flat_values(technique: Technique, arguments: Mapping[str, object], prefix: str = "") -> dict[str, object]:
    """Join the nested tables that TOML makes of dotted keys, but for a value that is itself a table.

    Raises ``ParameterError`` for a path that is set twice, once as a table and once by a dotted name.
    """
    values: dict[str, object] = {}
    for key, value in arguments.items():
        path = f"{prefix}{key}"
        new = {path: value}
        names_parameter = find_targets(technique, path) or why_absent(technique, path)
        if isinstance(value, Mapping) and not names_parameter:
            new = flat_values(technique, value, f"{path}.")
        for name in new.keys() & values.keys():
            raise ParameterError(f"'{name}' is set twice")
        values |= new
    return values


def check_value(sketch: Settable, path: str, value: object) -> Value:
    """Return a value as the parameter, or the part of the terrain, takes it; raise ``ParameterError``."""
    if path in TERRAIN_KEYS:
        return _terrain_value(path, value)
    targets = find_targets(sketch.graph, path)
    if not targets:
        if why := why_absent(sketch.graph, path):
            raise ParameterError(f"{path}: {why}")
        valid = [*TERRAIN_KEYS, *all_paths(sketch.graph)]
        raise ParameterError(f"no parameter '{path}' in sketch {sketch.name}{nearest(path, valid)}")
    is_array = hasattr(value, "__array__") or hasattr(value, "__array_interface__")
    is_array &= not isinstance(value, str | bytes | os.PathLike)
    if is_array and targets[0].parameter.widget.kind == "file":
        from playground.sketch.arrays import stored  # loads NumPy, which few loads need

        kernel = dict(sketch.graph.kernels)[targets[0].path.rpartition(".")[0]]
        return stored(value, targets[0].parameter, kernel.registry, path)
    return coerce(targets[0].parameter, value, path)


def effective_values(technique: Technique) -> dict[str, Value]:
    """Return the value of every leaf parameter, by its path inside the technique.

    A pass's own ``set`` wins over what its technique sets inside, and that over the
    kernels' defaults; the targets of one export share the first target's value.
    """
    return dict(_effective(technique))


@GRAPHS.cached(identities=1)
def _effective(technique: Technique) -> Mapping[str, Value]:
    if isinstance(technique, Kernel):
        return {p.name: p.default for p in technique.parameters}
    values: dict[str, Value] = {}
    for spec in technique.passes:
        inner = effective_values(spec.technique)
        apply(spec.technique, inner, spec.values)
        values |= {f"{spec.name}.{path}": value for path, value in inner.items()}
    for export in technique.parameters:
        targets = resolve(technique, export.name)
        for target in targets[1:]:
            values[target.path] = values[targets[0].path]
    return values


def apply(
    technique: Technique, values_by_path: dict[str, Value], values: Iterable[tuple[str, Value]]
) -> None:
    """Put values, by path, over those of ``effective_values``, in place."""
    for path, value in values:
        for target in resolve(technique, path):
            values_by_path[target.path] = value


def value_of(sketch: Settable, path: str, values: Mapping[str, Value]) -> Value:
    """Return the value that a path has, given the sketch's leaf values."""
    return values[resolve(sketch.graph, path)[0].path]


def values_of(sketch: Settable) -> dict[str, Value]:
    """Return the value of every leaf parameter of a sketch, overrides included, by its path."""
    values = effective_values(sketch.graph)
    apply(sketch.graph, values, sketch.overrides)
    return values


def _export(graph: Graph, name: str) -> Export | None:
    return next((export for export in graph.parameters if export.name == name), None)


def _terrain_value(key: str, value: object) -> Value:
    if hasattr(value, "tolist"):  # a NumPy scalar or array
        value = value.tolist()
    parts = value.replace("x", ",").split(",") if isinstance(value, str) else value
    numbers: list[object] = list(parts) if isinstance(parts, list | tuple) else [parts]
    try:
        values = [float(str(n)) for n in numbers]
    except ValueError:
        values = []
    most, fits, expected = _TERRAIN[key]
    if not 1 <= len(values) <= most or not all(map(fits, values)):
        raise ParameterError(f"{key} = {spell(value)}: expected {expected}")
    if key == "size":
        return int(values[0]), int(values[-1])
    return (values[0], values[-1]) if most == 2 else values[0]
