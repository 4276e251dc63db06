"""Describe a session's parameters and its state as plain data, for JSON."""

from __future__ import annotations

from typing import Any

from playground.shader.parameter import expected, shortest, write
from playground.sketch.assign import Shown, described, range_of
from playground.sketch.model import Parameter, Value
from playground.studio.bench import Workbench
from playground.studio.panel.parameter_list import Item, Values
from playground.studio.problems.problems import Problems
from playground.studio.remote.items import items_of, values_of
from playground.studio.session import Session


def parameters_of(session: Session) -> list[dict[str, Any]]:
    """Return every parameter with its value, range, unit and group, in the panel's order."""
    values = values_of(session)
    if values is None:
        return []
    return [_described(item, values) for item in items_of(session).values()]


def plain(parameter: Parameter, value: Value) -> Any:
    """Return a value for JSON: a menu's choice by its name, a colour as ``#rrggbb`` where that is exact."""
    if parameter.widget.kind in ("menu", "colour"):
        text = write(parameter, value)
        if parameter.widget.kind == "menu" or text.startswith("#"):
            return text
    shortest_value = shortest(value)
    return list(shortest_value) if isinstance(shortest_value, tuple) else shortest_value


def state_of(bench: Workbench) -> dict[str, Any]:
    """Return what is shown, its time, its presets and what is wrong with it."""
    session, clock = bench.session, bench.session.clock
    sketch = session.sketch
    return {
        "sketch": session.drafts.shown_path.name,
        "title": sketch.title if sketch is not None else "",
        "time": clock.time,
        "playing": clock.playing,
        "speed": clock.speed,
        "moves": session.animated,
        "presets": [preset.name for preset in sketch.presets] if sketch is not None else [],
        "can_undo": bench.undo.history.can_undo,
        "can_redo": bench.undo.history.can_redo,
        "errors": errors_of(bench.problems),
    }


def errors_of(problems: Problems) -> list[dict[str, Any]]:
    """Return what is wrong with the files just now, each with its place."""
    return [
        {"file": d.file, "line": d.line, "column": d.column, "message": d.message} for d in problems.errors
    ]


def _described(item: Item, values: Values) -> dict[str, Any]:
    parameter = item.parameter
    value, ends = values.of[item.path], range_of(parameter)
    return described(Shown(item.path, parameter, item.exported)) | {
        "label": item.title,
        "value": plain(parameter, value),
        "text": write(parameter, value),
        "default": plain(parameter, parameter.default),
        "file": plain(parameter, values.in_file[item.path]),
        "low": ends[0] if ends else None,
        "high": ends[1] if ends else None,
        "takes": expected(parameter),
        "changed": item.path in values.changed,
        "locked": item.path in values.locked,
        "raw": parameter.widget.raw,
    }
