"""A lesson's picture as user edits: edits, stopped repeats, a map."""

from __future__ import annotations

from pathlib import Path

from playground.course.model import Scene
from playground.engine.planner import repeated_in
from playground.sketch.flatten import flatten
from playground.sketch.map_sketch import USE, Map
from playground.sketch.model import Sketch, Value
from playground.workbench.edits import Edits


def path_of(scene: Scene) -> Path:
    """Return the file of a picture's sketch."""
    return Path(scene.sketch.file)


def edits_of(scene: Scene, file: Sketch) -> Edits:
    """Return what has to be edited in a sketch, as its file says it, to see a picture."""
    values: dict[str, Value] = {}
    parts = [_preset(file, scene.preset), dict(scene.values)]
    if scene.shot:
        shot = file.shot(scene.shot)
        parts = [_preset(file, shot.preset), dict(shot.values), *parts]
    for part in parts:  # what is set later comes later: of two names of one parameter, the last counts
        values = {path: value for path, value in values.items() if path not in part} | part
    seen = scene.sketch
    moved = seen.camera != file.camera or seen.keyframes != file.keyframes
    return Edits(tuple(values.items()), camera=seen.camera if moved else None)


def steps_of(scene: Scene) -> dict[str, int]:
    """Return after how many steps each repeated pass of a picture stops, by its whole path."""
    return {repeated_in(scene.sketch, path): step for path, step in scene.steps}


def map_of(scene: Scene) -> Map | None:
    """Return the map that a picture is; None where it is the sketch's own view."""
    if not scene.view:
        return None
    path, _, output = scene.view.partition(":")
    if not output:  # a pass's texture is that of its own name, else its first
        outputs, last = flatten(scene.sketch).outputs[path], path.rpartition(".")[2]
        output = last if last in outputs else next(iter(outputs))
    spec = scene.sketch.graph.find("view")
    return Map(f"{path}:{output}", spec.values if spec is not None and spec.use == USE else ())


def _preset(file: Sketch, name: str) -> dict[str, Value]:
    return next((dict(preset.values) for preset in file.presets if preset.name == name), {})
