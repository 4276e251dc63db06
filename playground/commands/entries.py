"""List sketches, techniques, and the parameters of each, as plain data.

Reads text only. A file that is wrong is listed too, with its error, so that one
mistake does not hide the rest.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from pathlib import Path

from playground.errors import PlaygroundError, SketchError, nearest
from playground.paths import GLSL, SKETCHES
from playground.shader.parameter import write
from playground.sketch.assign import Settable, Shown, shown_parameters, value_of, values_of
from playground.sketch.find import is_part, shipped_names, shipped_sketches
from playground.sketch.load import load, load_with
from playground.sketch.model import Graph, Kernel, Parameter, PassSpec, Sketch, Technique, Value
from playground.sketch.techniques import Techniques, read_technique
from playground.sketch.wiring import input_names, output_names


@dataclass(frozen=True, slots=True)
class Choice:
    """A parameter, and the value it has."""

    path: str  # as ``--set`` takes it: "height.smoothing" in a sketch, "smoothing" in a technique
    parameter: Parameter
    value: Value  # in a sketch what its file sets, in a technique the default
    exported: bool  # False: inside a technique of several passes, which does not show it

    @property
    def text(self) -> str:
        """The value as ``--set`` would take it."""
        return write(self.parameter, self.value)

    @property
    def range(self) -> str:
        """What values there may be, in a few words; "" where anything of its type will do."""
        widget = self.parameter.widget
        if words := ", ".join(widget.choices) or widget.facts.listed:
            return words
        if widget.low is None or widget.high is None:
            return ""
        axes = widget.axes or ((widget.low, widget.high),)
        return ", ".join(f"{low:g} to {high:g}" for low, high in axes)

    def as_json(self) -> dict[str, object]:
        """Return it as JSON takes it; a menu's values are names, a colour's linear numbers."""
        parameter, widget = self.parameter, self.parameter.widget
        bounded = widget.low is not None and widget.high is not None
        return {
            "path": self.path,
            "type": parameter.type,
            "widget": widget.kind,
            "value": _plain(parameter, self.value),
            "default": _plain(parameter, parameter.default),
            "range": [widget.low, widget.high] if bounded else None,
            "choices": list(widget.choices),
            "step": parameter.step,
            "unit": parameter.unit,
            "group": parameter.group,
            "title": parameter.title,
            "tooltip": parameter.tooltip,
            "exported": self.exported,
        }


@dataclass(frozen=True, slots=True)
class Entry:
    """A sketch or a technique."""

    name: str  # as ``render`` or ``use`` takes it
    kind: str  # sketch | kernel | draw | source | plain_fragment | plain_compute | several passes
    title: str = ""
    file: str = ""
    inputs: tuple[str, ...] = ()
    outputs: tuple[str, ...] = ()
    parameters: tuple[Choice, ...] = ()
    shots: tuple[str, ...] = ()
    presets: tuple[str, ...] = ()
    error: str = ""  # what is wrong with it

    def as_json(self) -> dict[str, object]:
        """Return it as JSON takes it."""
        table: dict[str, object] = {field.name: getattr(self, field.name) for field in fields(self)}
        return table | {"parameters": [choice.as_json() for choice in self.parameters]}


def sketches() -> list[Entry]:
    """List the sketches that ship."""
    entries = []
    read = Techniques()  # most are in several sketches
    for name in shipped_sketches():
        try:
            entries.append(_of_sketch(name, load_with(read, name)))
        except PlaygroundError as error:
            entries.append(Entry(name, "sketch", file=str(SKETCHES / f"{name}.toml"), error=str(error)))
    return entries


def techniques(within: str = "") -> list[Entry]:
    """List the techniques in ``glsl/``, or in one of its folders; library files are none.

    The parts of a technique are listed only for its own folder.
    """
    entries = []
    read = Techniques()
    for name in shipped_names():
        if is_part(name) and not (within and is_part(f"{within}/x")):
            continue
        if within and not name.startswith(f"{within.rstrip('/')}/"):
            continue
        try:
            entries.append(_of_technique(name, read.read(name, GLSL, GLSL)))
        except PlaygroundError as error:
            if "is a library file" not in str(error):
                entries.append(Entry(name, "technique", error=str(error)))
    return entries


def entries_named(name: str) -> list[Entry]:
    """Return what a name means: a sketch, a technique, or all techniques of a folder of ``glsl/``.

    A path means the sketch or the shader there. Raises ``SketchError`` with the nearest name.
    """
    if Path(name).is_file() or (Path(name) / "sketch.toml").is_file():
        sketch = load(name)
        return [_of_sketch(sketch.name, sketch)]
    if name in shipped_sketches():
        return [_of_sketch(name, load(name))]
    if name in shipped_names():
        return [_of_technique(name, read_technique(name, GLSL, GLSL))]
    if within := techniques(name):
        return within
    names = [entry.name for entry in techniques()]
    folders = {entry.rpartition("/")[0] for entry in names}
    names += [*shipped_sketches(), *folders, "sketches", "techniques"]
    raise SketchError(f"there is no sketch and no technique '{name}'{nearest(name, names)}")


def _of_sketch(name: str, sketch: Sketch) -> Entry:
    values = values_of(sketch)
    return Entry(
        name,
        "sketch",
        sketch.title,
        sketch.file,
        outputs=tuple(spec.name for spec in sketch.graph.passes),
        parameters=tuple(_choice(sketch, shown, values) for shown in shown_parameters(sketch)),
        shots=tuple(shot.name for shot in sketch.shots),
        presets=tuple(preset.name for preset in sketch.presets),
    )


def _of_technique(name: str, technique: Technique) -> Entry:
    alone = _Alone(name, Graph(name, "", (PassSpec("it", name, technique),)))
    values = values_of(alone)
    choices = [_choice(alone, shown, values) for shown in shown_parameters(alone)]
    return Entry(
        name,
        technique.kind if isinstance(technique, Kernel) else "several passes",
        technique.title,
        technique.path,
        input_names(technique),
        output_names(technique),
        tuple(replace(choice, path=choice.path.removeprefix("it.")) for choice in choices),
    )


@dataclass(frozen=True)
class _Alone:
    """A technique as its file has it, with the passes that are there only where something is wired."""

    name: str
    graph: Graph
    overrides: tuple[tuple[str, Value], ...] = ()


def _choice(sketch: Settable, shown: Shown, values: dict[str, Value]) -> Choice:
    return Choice(shown.path, shown.parameter, value_of(sketch, shown.path, values), shown.exported)


def _plain(parameter: Parameter, value: Value) -> object:
    if parameter.widget.kind == "menu" and isinstance(value, int):
        return parameter.widget.choices[value]
    return list(value) if isinstance(value, tuple) else value
