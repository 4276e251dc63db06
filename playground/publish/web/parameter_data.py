"""Write down what a page shows of a sketch's values: parameters, presets, keyframes, what follows what."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import asdict
from typing import Any

from playground.sketch.assign import Shown, check_value, described, find_targets, resolve, shown_parameters
from playground.sketch.flat import Flat
from playground.sketch.keyframes import Track, tracks_of
from playground.sketch.model import Sketch, Value

Written = Callable[[str, Value], Any]
"""Returns the value of a leaf parameter as a page has it: of a file its key."""

Locked = Callable[[str, tuple[str, ...]], str]
"""Returns why a parameter of a path, with its targets, cannot be changed in a page; "": it can."""


def parameters_data(sketch: Sketch, values: Mapping[str, Any], locked: Locked) -> list[dict[str, Any]]:
    """Return every parameter of a sketch as the panel has it: see ``Shown`` in schema.js."""
    rows = []
    for shown in shown_parameters(sketch):
        targets = tuple(target.path for target in resolve(sketch.graph, shown.path))
        rows.append(row(shown, values[targets[0]], targets, locked(shown.path, targets)))
    named = {entry["path"]: entry for entry in rows}
    by_leaf = {entry["targets"][0]: entry for entry in rows}  # a row inside may be named by an outer path
    for index, path in enumerate(sketch.main, 1):
        main = named.get(path) or by_leaf[resolve(sketch.graph, path)[0].path]
        main["main"] = main["main"] or index
    return rows


def row(shown: Shown, value: Any, targets: tuple[str, ...], locked: str = "") -> dict[str, Any]:
    """Return one parameter as a page shows it."""
    data = described(shown)
    data["ranges"] = [list(ends) if ends else [None, None] for ends in data["ranges"]]
    data |= {"main": 0, "locked": locked, "value": value, "targets": list(targets)}
    if shown.parameter.widget.raw:
        data["raw"] = True
    return data


def presets_data(
    sketch: Sketch, rows: Collection[Mapping[str, Any]], written: Written
) -> tuple[list[dict[str, Any]], list[str]]:
    """Return the presets by the paths of the rows, and a message for each that says less in a page."""
    by_path = {row["path"]: row for row in rows}
    by_target = {target: row for row in rows for target in row["targets"]}
    presets, notes = [], []
    for preset in sketch.presets:
        values = {}
        for path, arguments in preset.values:
            if "." in path and not find_targets(sketch.graph, path):
                notes.append(f"preset '{preset.name}' leaves {path} out: this technique does not have it")
                continue
            value = check_value(sketch, path, arguments)
            if "." not in path:
                values[path] = value
                continue
            target = resolve(sketch.graph, path)[0].path
            shown = by_path.get(path) or by_target[target]
            if shown["locked"]:
                notes.append(f"preset '{preset.name}' leaves {shown['path']} as it is: {shown['locked']}")
            else:
                values[shown["path"]] = written(target, value)
        presets.append({"name": preset.name, "values": values})
    return presets, notes


def tracks_data(sketch: Sketch, locked: Locked, written: Written) -> tuple[list[dict[str, Any]], list[str]]:
    """Return the keyframes' tracks, but for what is set over them, and a message for each left out."""
    cameras, tracks = tracks_of(sketch.graph, sketch.keyframes)
    result = [_track("camera", name, (), track, list(track.values)) for name, track in cameras.items()]
    over = {t.path for path, _ in sketch.overrides for t in resolve(sketch.graph, path)}
    notes = []
    for path, track in tracks.items():
        targets = tuple(t.path for t in resolve(sketch.graph, path) if t.path not in over)
        if why := locked(path, targets):
            notes.append(f"keyframes leave {path} as it is: {why}")
        elif targets:
            values = [written(targets[0], value) for value in track.values]
            result.append(_track("value", path, targets, track, values))
    return result, notes


def rules_data(flat: Flat) -> list[dict[str, Any]]:
    """Return the angles that follow a direction: see ``Rule`` in schema.js."""
    return [asdict(rule) for rule in flat.shape.rules]


def _track(of: str, name: str, targets: tuple[str, ...], track: Track, values: list[Any]) -> dict[str, Any]:
    return {
        "of": of,
        "name": name,
        "targets": list(targets),
        "times": list(track.times),
        "values": values,
        "eases": list(track.eases),
        "holds": track.holds,
        "angles": list(track.angles),
    }
