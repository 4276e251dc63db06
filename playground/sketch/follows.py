"""Angles that follow a direction: ``follows("sun")``, the azimuth of ``sun`` until they are set.

A parameter is set when its value is not its default, so the default of one that follows should
be a value that no sketch needs, as -360 degrees. With ``follows("sun", "measured", "on its arc")``
it follows only while the menu ``measured`` has that choice.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from playground.errors import ShaderError, nearest
from playground.sketch.assign import resolve
from playground.sketch.model import Follows, Graph, Kernel, Parameter, Value
from playground.sketch.source import Line


@dataclass(frozen=True, slots=True)
class Rule:
    """Leaf parameters that share a value, which may follow a direction; paths from the sketch."""

    targets: tuple[str, ...]  # the first says whether it is set
    default: Value
    direction: str
    menu: str  # "" where it always follows
    choice: int


def read_follows(
    parameter: Parameter, words: Sequence[str], known: Iterable[Parameter], line: Line
) -> Follows:
    """Return what an annotation's ``follows(…)`` says; raise ``ShaderError`` where it cannot be."""

    def wrong(message: str) -> ShaderError:
        return line.error(f"follows of '{parameter.name}': {message}")

    if parameter.widget.kind != "angle" or len(words) not in (1, 3):
        raise wrong(
            'an angle follows a direction, as follows("sun"), '
            'or while a menu has a choice, as follows("sun", "form", "near")'
        )
    by_name = {p.name: p for p in known}
    directions = [name for name, p in by_name.items() if p.widget.kind == "direction"]
    if words[0] not in directions:
        raise wrong(f"no direction '{words[0]}' here{nearest(words[0], directions)}")
    if len(words) == 1:
        return Follows(words[0])
    menus = {name: p.widget.choices for name, p in by_name.items() if p.widget.kind == "menu"}
    if words[1] not in menus:
        raise wrong(f"no menu '{words[1]}' here{nearest(words[1], menus)}")
    choices = menus[words[1]]
    if words[2] not in choices:
        raise wrong(f"'{words[1]}' has no choice '{words[2]}'{nearest(words[2], choices)}")
    return Follows(words[0], words[1], choices.index(words[2]))


def rules_of(graphs: Mapping[str, Graph]) -> tuple[Rule, ...]:
    """Return the rules of the techniques of several passes, by the path of each.

    An export of a technique follows as a whole; a parameter that is not exported, alone.
    """
    found: list[Rule] = []
    for prefix, graph in graphs.items():
        covered: set[str] = set()
        for export in graph.parameters:
            targets = resolve(graph, export.name)
            covered |= {target.path for target in targets}
            if targets[0].parameter.follows:
                found.append(_rule(prefix, [t.path for t in targets], targets[0].parameter))
        for spec in graph.passes:
            if isinstance(spec.technique, Kernel):
                for parameter in spec.technique.parameters:
                    path = f"{spec.name}.{parameter.name}"
                    if parameter.follows and path not in covered:
                        found.append(_rule(prefix, [path], parameter))
    return tuple(found)


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
