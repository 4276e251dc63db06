"""A lesson's picture as what a hand could have set: edits, stopped repeats, a map."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

from playground.engine.plan import repeated_in
from playground.lessons.model import Scene
from playground.live.edits import Edits
from playground.live.session import is_seen_from_camera
from playground.sketch.flatten import flatten
from playground.sketch.maps import USE, Map
from playground.sketch.model import Sketch, Value

_WIDEST = 100.0
"""[degrees] that a view is opened to at most: beyond, what is near its edges is drawn out of shape."""


def path_of(scene: Scene) -> Path:
    """Return the file of a picture's sketch."""
    return Path(scene.sketch.file)


def edits_of(scene: Scene, file: Sketch, room: tuple[int, int] | None = None) -> Edits:
    """Return what has to be set by hand in a sketch, as its file says it, to see a picture.

    ``room`` [pixels]: where it is seen. In one that is narrower than the picture, the camera
    sees more above and below, so that nothing at the sides is lost.
    """
    values: dict[str, Value] = {}
    parts = [_preset(file, scene.preset), dict(scene.values)]
    if scene.shot:
        shot = file.shot(scene.shot)
        parts = [_preset(file, shot.preset), dict(shot.values), *parts]
    for part in parts:  # what is set later comes later: of two names of one parameter, the last counts
        values = {path: value for path, value in values.items() if path not in part} | part
    seen = scene.sketch
    camera = seen.camera
    if room is not None and is_seen_from_camera(seen) and not seen.keyframes:
        camera = replace(camera, field_of_view=_opened(camera.field_of_view, scene.pixels, room))
    moved = camera != file.camera or seen.keyframes != file.keyframes
    return Edits(tuple(values.items()), camera=camera if moved else None)


def steps_of(scene: Scene) -> dict[str, int]:
    """Return after how many turns each repeated pass of a picture stops, by its whole path."""
    return {repeated_in(scene.sketch, path): turn for path, turn in scene.steps}


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


def _opened(degrees: float, pixels: tuple[int, int], room: tuple[int, int]) -> float:
    """Return the vertical field of view that shows, in a room, what a picture shows from side to side."""
    narrower = (pixels[0] / pixels[1]) / (room[0] / max(room[1], 1))
    if narrower <= 1.0:
        return degrees
    opened = 2 * math.degrees(math.atan(math.tan(math.radians(degrees) / 2) * narrower))
    return max(degrees, min(round(opened, 2), _WIDEST))


def _preset(file: Sketch, name: str) -> dict[str, Value]:
    return next((dict(preset.values) for preset in file.presets if preset.name == name), {})
