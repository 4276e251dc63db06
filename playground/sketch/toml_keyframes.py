"""Read the keyframes of a sketch from its TOML."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from playground.sketch.assign import TERRAIN_KEYS, resolve
from playground.sketch.keyframes import EASES
from playground.sketch.model import Camera, Keyframe, Sketch
from playground.sketch.toml_camera import read_camera
from playground.sketch.toml_graph import read_set
from playground.sketch.toml_keys import KEYFRAME
from playground.sketch.toml_places import Place
from playground.sketch.toml_table import TomlFile
from playground.sketch.values import spell

_LATEST = 1e6  # [s]


def read_keyframes(file: TomlFile, sketch: Sketch) -> tuple[Keyframe, ...]:
    """Return what the ``[[keyframe]]`` tables say; raise ``SketchError`` at the line that is wrong."""
    found: list[Keyframe] = []
    names: dict[str, str] = {}  # the path that a parameter inside was set by, by its own path
    for index, table in enumerate(file.tables("keyframe")):
        place: Place = ("keyframe", index)
        file.only(table, KEYFRAME, *place)
        time = _time(file, table, place, found)
        who = f"keyframe at {time:g} s"
        values = read_set(file, sketch, table, place, who)
        for path, _ in values:
            if path in TERRAIN_KEYS:
                message = f"'{path}' is the terrain's; keyframes set parameters and the camera"
                raise file.error(f"{who}: {message}", *place, "set", path)
            for target in resolve(sketch.graph, path):
                other = names.setdefault(target.path, path)
                if other != path:
                    message = f"'{path}' is what '{other}' sets in another keyframe"
                    raise file.error(f"{who}: {message}", *place, "set", path)
        camera = _camera(file, table, place)
        if not values and not camera:
            raise file.error(f"{who}: it sets nothing; expected camera = {{ … }} or set = {{ … }}", *place)
        ease = file.take(table, "ease", str, EASES[0], *place)
        if ease not in EASES:
            raise file.error(f"ease = {spell(ease)}: expected {', '.join(EASES)}", *place, "ease")
        found.append(Keyframe(time, camera, values, ease, file.line(*place)))
    _check_distances(file, found)
    return tuple(found)


def _time(file: TomlFile, table: Mapping[str, Any], place: Place, before: list[Keyframe]) -> float:
    if "time" not in table:
        raise file.error("a keyframe needs time = …, in seconds", *place)
    time: float = file.take(table, "time", float, 0.0, *place)
    if not 0.0 <= time <= _LATEST:
        raise file.error(f"time = {time:g}: expected seconds from 0 to {_LATEST:g}", *place, "time")
    if before and time <= before[-1].time:
        last = before[-1]
        what = "there is one at that time" if time == last.time else f"the one before is at {last.time:g} s"
        raise file.error(f"time = {time:g}: {what}, on line {last.line}; times must increase", *place, "time")
    return time


def _camera(
    file: TomlFile, table: Mapping[str, Any], place: Place
) -> tuple[tuple[str, float | tuple[float, ...]], ...]:
    if "camera" not in table:
        return ()
    camera = read_camera(file, table, Camera(), place)
    return tuple((name, getattr(camera, name)) for name in table["camera"])


def _check_distances(file: TomlFile, found: list[Keyframe]) -> None:
    """Raise ``SketchError`` where the distance is metres in one keyframe and 0, automatic, in another."""
    far = {bool(dict(k.camera)["distance"]) for k in found if "distance" in dict(k.camera)}
    for index, keyframe in enumerate(found):
        if len(far) > 1 and dict(keyframe.camera).get("distance") == 0.0:
            message = "distance = 0 shows the whole terrain and cannot be mixed with metres; give metres"
            raise file.error(message, "keyframe", index, "camera", "distance")
