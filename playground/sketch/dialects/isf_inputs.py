"""Make parameters and channels of what an ISF shader declares in INPUTS and IMPORTED."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from playground.errors import Diagnostic, nearest
from playground.sketch.allowed_files import leads_outside
from playground.sketch.dialects.isf_header import Header, is_true, number_of, numbers_of
from playground.sketch.dialects.reading import Files
from playground.sketch.dialects.shader import STAND_INS, Channel, stand_in
from playground.sketch.model import Parameter, Sampling, Widget
from playground.sketch.source import Line
from playground.sketch.uniforms import with_axes

IMAGE = Sampling("linear", "clamp")
"""How ISF reads an image: it has no mipmaps, and no copies of itself around it."""

OF_PICTURE = ("view.size.x", "view.size.y")
"""The size of what stands in for an image: filters read it by the places of the picture's pixels."""

_KEYS = ("NAME", "TYPE", "LABEL", "DEFAULT", "MIN", "MAX", "IDENTITY", "VALUES", "LABELS", "DESCRIPTION")
_IMPORT_KEYS = ("NAME", "PATH", "TYPE", "DESCRIPTION")
_BINS = 256
_FACES = ("right", "left", "top", "bottom", "front", "back")
_CUBE = ("512", "3072")


@dataclass
class Inputs:
    """What a header declares for its text."""

    parameters: list[Parameter] = field(default_factory=list)
    channels: dict[str, Channel] = field(default_factory=dict)  # by sampler
    cubes: list[str] = field(default_factory=list)  # those of the channels that are cube maps
    notes: list[Diagnostic] = field(default_factory=list)

    @property
    def names(self) -> list[str]:
        """Every name that is taken."""
        return [*(p.name for p in self.parameters), *self.channels]


def read_inputs(header: Header, files: Files, taken: Callable[[str], str]) -> Inputs:
    """Return what INPUTS and IMPORTED declare.

    ``taken`` returns what a name is already, "" for a free one. Raises ``ShaderError`` for an input
    without a name of its own, or of a type that there is not.
    """
    found = Inputs()
    for one in header.items("INPUTS"):
        name = _name(one, header, "an input", found, taken)
        line = header.line_of_input(name)
        kind = _BY_LOWER.get(str(one.get("TYPE", "")).lower(), "")
        if not kind:
            given = str(one.get("TYPE", ""))
            message = f"input '{name}' is left out: ISF has no type '{given}'{nearest(given, _READERS)}"
            found.notes.append(line.diagnostic(message, severity="warning"))
            continue
        note = header.unknown(one.keys(), _KEYS, f"input '{name}'")
        found.notes += [note] if note else []
        _READERS[kind](_Declared(name, one, line), found)
    for one in header.items("IMPORTED", named=True):
        name = _name(one, header, "an imported image", found, taken)
        note = header.unknown(one.keys(), _IMPORT_KEYS, f"image '{name}'")
        found.notes += [note] if note else []
        _import(name, one, header.line_of_input(name), files, found)
    return found


@dataclass(frozen=True)
class _Declared:
    name: str
    table: Mapping[str, Any]
    line: Line

    def parameter(self, kind: str, default: Any, widget: Widget) -> Parameter:
        """Return a parameter of a GLSL type."""
        label, tooltip = (str(self.table.get(key) or "").strip() for key in ("LABEL", "DESCRIPTION"))
        found = Parameter(self.name, kind, default, widget, label=label, tooltip=tooltip)
        return replace(found, file=self.line.file, line=self.line.number)

    def number(self, key: str) -> float | None:
        return number_of(self.table.get(key))


def _name(
    one: Mapping[str, Any], header: Header, what: str, found: Inputs, taken: Callable[[str], str]
) -> str:
    name = one.get("NAME")
    if not isinstance(name, str) or not name.isidentifier() or not name.isascii():
        line = header.line_of_input(name) if isinstance(name, str) else header.line_of("INPUTS")
        raise line.error(f'{what} needs a NAME that GLSL can use, as "NAME": "level"; found {name!r}')
    already = "two inputs have this name" if name in found.names else taken(name)
    if already:
        raise header.line_of_input(name).error(f"{what} cannot be called '{name}': {already}")
    return name


def _float(declared: _Declared, found: Inputs) -> None:
    low, high, default = (declared.number(key) for key in ("MIN", "MAX", "DEFAULT"))
    least, most = _ordered(0.0 if low is None else low, 1.0 if high is None else high)
    value = (least + most) / 2 if default is None else default
    if low is None and high is None:  # the author bounds nothing
        least, most = min(least, value), max(most, value)
    widget = Widget("slider", least, most)
    found.parameters.append(declared.parameter("float", min(max(value, least), most), widget))


def _bool(declared: _Declared, found: Inputs) -> None:
    default = is_true(declared.table["DEFAULT"]) if "DEFAULT" in declared.table else True
    found.parameters.append(declared.parameter("bool", default, Widget("checkbox")))


def _event(declared: _Declared, found: Inputs) -> None:
    found.parameters.append(declared.parameter("bool", False, Widget("button")))


def _long(declared: _Declared, found: Inputs) -> None:
    values, labels = (declared.table.get(key) or [] for key in ("VALUES", "LABELS"))
    default = declared.number("DEFAULT")
    if not isinstance(values, list) or not isinstance(labels, list):
        raise declared.line.error(f"input '{declared.name}': expected lists as its VALUES and LABELS")
    numbers = [number_of(one) for one in values] or [float(n) for n in range(len(labels))]
    if None in numbers:
        raise declared.line.error(f"input '{declared.name}': expected whole numbers as its VALUES")
    whole = [_whole(n) for n in numbers if n is not None]
    if not whole:
        low, high = declared.number("MIN"), declared.number("MAX")
        widget = Widget()
        if low is not None and high is not None:
            least, most = _ordered(_whole(low), _whole(high))
            widget = Widget("slider", least, most)
            default = min(max(least if default is None else default, least), most)
        found.parameters.append(declared.parameter("int", _whole(default or 0.0), widget))
        return
    names: list[str] = []
    for at, number in enumerate(whole):
        label = str(labels[at]).strip() if at < len(labels) else str(number)
        label = label or str(number)
        label = f"{label} ({number})" if label in names else label
        while label in names:
            label += "'"
        names.append(label)
    chosen = whole.index(int(default)) if default is not None and default in whole else 0
    menu = Widget("menu", choices=tuple(names), values=tuple(whole))
    found.parameters.append(declared.parameter("int", chosen, menu))


def _point(declared: _Declared, found: Inputs) -> None:
    low, high, default = (numbers_of(declared.table.get(key), 2) for key in ("MIN", "MAX", "DEFAULT"))
    least, most = low or (0.0, 0.0), high or (1.0, 1.0)
    axes = [_ordered(a, b) for a, b in zip(least, most, strict=True)]
    value = default or tuple((a + b) / 2 for a, b in axes)
    if low is None and high is None:  # the author bounds nothing: places in pixels, as in version 1
        axes = [(min(a, n), max(b, n)) for (a, b), n in zip(axes, value, strict=True)]
    held = tuple(min(max(n, a), b) for n, (a, b) in zip(value, axes, strict=True))
    found.parameters.append(declared.parameter("vec2", held, with_axes("point", axes)))


def _color(declared: _Declared, found: Inputs) -> None:
    given = declared.table.get("DEFAULT")
    value = numbers_of(given, 4) or (*(numbers_of(given, 3) or (0.0, 0.0, 0.0)), 1.0)
    found.parameters.append(declared.parameter("vec4", value, Widget("colour", raw=True)))


def _image(declared: _Declared, found: Inputs) -> None:
    number = sum(channel.use == STAND_INS["picture"] for channel in found.channels.values())
    found.channels[declared.name] = _card(number)


def _cube(declared: _Declared, found: Inputs) -> None:
    _add_cube(declared.name, found, "a sky stands in for it")


def _add_cube(name: str, found: Inputs, unfed: str) -> None:
    found.cubes.append(name)
    found.channels[name] = replace(stand_in("sky", 0, unfed), sampling=IMAGE)


def _sound(content: int) -> Callable[[_Declared, Inputs], None]:
    def read(declared: _Declared, found: Inputs) -> None:
        most = declared.number("MAX")
        bins = _BINS if most is None else min(max(_whole(most), 1), 4096)
        found.channels[declared.name] = Channel(
            use="foreign/spectrum",
            values=(("content", content),),
            size=(str(bins), "1"),
            sampling=IMAGE,
            unfed="a made-up sound stands in for it",
        )

    return read


def _card(number: int, unfed: str = "a stand-in is drawn; a sketch may wire an image to it") -> Channel:
    """Return the channel of an image that nothing feeds."""
    return replace(stand_in("picture", number, unfed), size=OF_PICTURE, sampling=IMAGE)


_READERS: dict[str, Callable[[_Declared, Inputs], None]] = {
    "event": _event,
    "bool": _bool,
    "long": _long,
    "float": _float,
    "point2D": _point,
    "color": _color,
    "image": _image,
    "cube": _cube,
    "audio": _sound(1),
    "audioFFT": _sound(0),
}
"""By the type of an input."""

_BY_LOWER = {kind.lower(): kind for kind in _READERS} | {"int": "long"}


def _import(name: str, one: Mapping[str, Any], line: Line, files: Files, found: Inputs) -> None:
    path = one.get("PATH")
    if str(one.get("TYPE", "")).lower() == "cube" or isinstance(path, list):
        _import_cube(name, path, line, files, found)
        return
    path = _path(name, path, line)
    if wrong := _lacking(path, line, files):
        found.channels[name] = _card(0, f"{wrong}, so a stand-in is drawn")
        return
    declared = _Declared(name, one, line)
    parameter = declared.parameter("sampler2D", path, Widget("file"))
    found.parameters.append(replace(parameter, sampling=IMAGE))


def _import_cube(name: str, given: object, line: Line, files: Files, found: Inputs) -> None:
    """Add a cube map of six images: right, left, top, bottom, front, back."""
    if not isinstance(given, list) or len(given) != len(_FACES):
        message = f"cube '{name}' needs the paths of six images, +X, -X, +Y, -Y, +Z and -Z, as its PATH"
        raise line.error(message)
    paths = [_path(name, one, line) for one in given]
    wrong = next(filter(None, (_lacking(path, line, files) for path in paths)), "")
    if wrong:
        _add_cube(name, found, f"{wrong}, so a sky stands in")
        return
    found.cubes.append(name)
    # What fills the pass ships, so that a path has to be that from the sketch's folder.
    values = tuple(zip(_FACES, (_from_root(path, line, files) for path in paths), strict=True))
    found.channels[name] = Channel(use="foreign/cube_faces", values=values, size=_CUBE, sampling=IMAGE)


def _path(name: str, given: object, line: Line) -> str:
    if not isinstance(given, str) or not given.strip() or "\0" in given:
        raise line.error(f'image \'{name}\' needs the path of its file, as "PATH": "moon.jpg"')
    return given.strip().replace("\\", "/")


def _lacking(path: str, line: Line, files: Files) -> str:
    """Return why there is no image at a path, "" where there is one."""
    if leads_outside(path, files.root, line.file):
        return f"'{path}' lies outside the sketch's folder"
    there = [files.is_there(place / path) for place in (Path(line.file).parent, files.root)]
    return "" if any(there) else f"there is no file '{path}'"


def _from_root(path: str, line: Line, files: Files) -> str:
    place = Path(line.file).parent / path
    return place.resolve().relative_to(files.root.resolve()).as_posix() if files.is_there(place) else path


def _ordered(low: float, high: float) -> tuple[float, float]:
    """Return a range that a slider can have: the lower end first, and the ends apart."""
    least, most = min(low, high), max(low, high)
    return (least, most) if most > least else (least, least + 1.0)


def _whole(number: float) -> int:
    return min(max(math.floor(number), -(2**31)), 2**31 - 1)
