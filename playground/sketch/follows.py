"""Angles that follow a direction: ``follows("sun")``, the azimuth of ``sun`` until they are set.

A parameter is set when its value is not its default, so the default of one that follows should
be a value that no sketch needs, as -360 degrees. With ``follows("sun", "measured", "on its arc")``
it follows only while the menu ``measured`` has that choice.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from playground.sketch.assign import resolve
from playground.sketch.model import Graph, Kernel, Parameter, Value


@dataclass(frozen=True, slots=True)
class Rule:
    """Leaf parameters that share a value, which may follow a direction; paths from the sketch."""

    targets: tuple[str, ...]  # the first says whether it is set
    default: Value
    direction: str
    menu: str  # "" where it always follows
    choice: int


def rules_of(graphs: Mapping[str, Graph]) -> tuple[Rule, ...]:
    """Return the rules of the techniques of several passes, by the path of each.

    An export of a technique follows as a whole; a parameter that is not exported, alone.
    """
    rules: list[Rule] = []
    for prefix, graph in graphs.items():
        covered: set[str] = set()
        for export in graph.parameters:
            targets = resolve(graph, export.name)
            covered |= {target.path for target in targets}
            if targets[0].parameter.follows:
                rules.append(_rule(prefix, [t.path for t in targets], targets[0].parameter))
        for spec in graph.passes:
            if isinstance(spec.technique, Kernel):
                for parameter in spec.technique.parameters:
                    path = f"{spec.name}.{parameter.name}"
                    if parameter.follows and path not in covered:
                        rules.append(_rule(prefix, [path], parameter))
    return tuple(rules)


def follow(rules: Iterable[Rule], values: dict[str, Value]) -> None:
    """Give what follows and is not set the azimuth that it follows, in place."""
    for rule in rules:
        if values[rule.targets[0]] != rule.default or (rule.menu and values[rule.menu] != rule.choice):
            continue
        direction = values[rule.direction]
        assert isinstance(direction, tuple)
        values.update(dict.fromkeys(rule.targets, direction[0]))


def _rule(prefix: str, targets: Sequence[str], parameter: Parameter) -> Rule:
    paths = tuple(f"{prefix}.{path}" if prefix else path for path in targets)
    kernel = paths[0].removesuffix(parameter.name)
    follows = parameter.follows
    assert follows
    menu = f"{kernel}{follows.menu}" if follows.menu else ""
    return Rule(paths, parameter.default, f"{kernel}{follows.direction}", menu, follows.choice)
