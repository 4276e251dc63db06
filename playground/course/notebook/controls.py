"""What can be dragged of a block, as plain values for a browser, and the picture that a state of it shows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from playground.course.language import Labels
from playground.course.model import Compare, Figure, Scene, Slider, Steps
from playground.course.scenes import spelled_value, with_value
from playground.shader.parameter import is_whole
from playground.sketch.assign import resolve, value_of, values_of
from playground.sketch.model import Value

_STEPS = 200  # positions of a slider whose parameter has no step


@dataclass(frozen=True)
class Control:
    """Something to drag or to choose."""

    key: str  # parameter path, with ":0" and ":1" for the parts of a direction; or "frame"
    label: str
    kind: str  # range | choice | checkbox
    value: float
    low: float = 0.0
    high: float = 1.0
    step: float = 1.0
    choices: tuple[str, ...] = ()  # of a choice: their names; of a frame: one for each
    unit: str = ""


def controls_of(block: Figure | Steps | Slider | Compare, language: str, label: Labels) -> list[Control]:
    """Return what can be dragged of a block."""
    if isinstance(block, Figure):
        assert block.scene is not None
        return [control for path in block.sliders for control in _parameter(block.scene, path, label)]
    if isinstance(block, Steps):
        name = label("step")
        names = tuple(label("iteration", n=number) for number in block.iterations)
    elif isinstance(block, Slider):
        name = block.label or block.parameter
        names = tuple(spelled_value(block, value, language) for value in block.values)
    else:
        return [Control("frame", label("show"), "choice", 0.0, choices=block.labels)]
    start = 0 if isinstance(block, Steps) else len(names) // 2
    return [Control("frame", name, "range", float(start), 0.0, len(names) - 1.0, 1.0, names)]


def scene_at(block: Figure | Steps | Slider | Compare, values: Mapping[str, float]) -> Scene:
    """Return the picture of a block for values of its controls; raise ``ParameterError`` for a bad one."""
    if not isinstance(block, Figure):
        last = len(block.scenes) - 1
        return block.scenes[min(max(round(values.get("frame", 0.0)), 0), last)]
    assert block.scene is not None
    scene = block.scene
    for path in block.sliders:
        if path in values:
            scene = with_value(scene, path, _value(scene, path, values[path]))
        elif any(key in values for key in _parts(path)):
            now = value_of(scene.sketch, path, values_of(scene.sketch))
            assert isinstance(now, tuple)
            both = zip(_parts(path), now, strict=True)
            scene = with_value(scene, path, tuple(float(values.get(key, part)) for key, part in both))
    return scene


def _parts(path: str) -> tuple[str, str]:
    """Return the keys of a direction's azimuth and elevation."""
    return f"{path}:0", f"{path}:1"


def _parameter(scene: Scene, path: str, label: Labels) -> list[Control]:
    parameter = resolve(scene.sketch.graph, path)[0].parameter
    value = value_of(scene.sketch, path, values_of(scene.sketch))
    widget = parameter.widget
    if widget.kind == "menu" and isinstance(value, int):
        return [Control(path, parameter.title, "choice", float(value), choices=widget.choices)]
    if parameter.type == "bool":
        return [Control(path, parameter.title, "checkbox", float(bool(value)))]
    if widget.kind == "direction" and isinstance(value, tuple):
        azimuth, elevation = _parts(path)
        return [
            Control(azimuth, label("azimuth"), "range", value[0] % 360.0, 0.0, 360.0, 0.5, unit="°"),
            Control(elevation, label("elevation"), "range", float(value[1]), -90.0, 90.0, 0.5, unit="°"),
        ]
    if isinstance(value, tuple | str) or widget.low is None or widget.high is None:
        return []  # other vectors and files are set in code: with_values
    whole = is_whole(parameter.type)
    step = 1.0 if whole else parameter.step or (widget.high - widget.low) / _STEPS
    unit = parameter.unit
    return [Control(path, parameter.title, "range", float(value), widget.low, widget.high, step, unit=unit)]


def _value(scene: Scene, path: str, number: float) -> Value:
    parameter = resolve(scene.sketch.graph, path)[0].parameter
    if parameter.type == "bool":
        return bool(number)
    if is_whole(parameter.type):
        return round(number)
    return float(number)
