"""Read an ISF shader, version 1 or 2: a fragment shader with a description in JSON before it.

Authors write it by hand: tabs in texts, commas after the last item, comments and numbers as ``.5`` are read.

Source: the Interactive Shader Format's specification, versions 1 and 2.
"""

from __future__ import annotations

import ast
import json
import math
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from playground.allowed_files import leads_outside
from playground.dialects.es import Rewritten, rewritten
from playground.dialects.foreign import (
    STAND_INS,
    VIEW,
    Files,
    Names,
    Rules,
    Shader,
    ShaderChannel,
    stand_in,
)
from playground.errors import Diagnostic, ShaderError, nearest
from playground.json_text import long_number
from playground.paths import shown
from playground.shader import expressions
from playground.shader.conditions import live_source
from playground.shader.declarations import is_declared, uniforms
from playground.shader.expressions import MAX_LETTERS, ExpressionError
from playground.shader.header import with_axes
from playground.shader.parameter import Parameter, Sampling, spell
from playground.shader.source import Line, SourceText
from playground.shader.syntax.tokens import as_written
from playground.shader.widgets import Widget

_BEGIN = re.compile(r"(?:\s|//[^\n]*\n)*/\*\s*(?=\{)")
_LENIENT = re.compile(
    r'(?P<text>"(?:[^"\\]|\\.)*")'
    r"|(?P<comment>//[^\n]*)"
    r"|(?P<comma>,)(?=(?:\s|//[^\n]*)*[}\]])"
    r"|(?P<number>(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)",
    re.DOTALL,
)
_TRUE = ("true", "yes", "on", "1")


@dataclass(frozen=True)
class Header:
    """What an ISF shader says of itself."""

    table: Mapping[str, Any]
    text: str  # of the file, up to the header's end
    lines: tuple[Line, ...]  # of the file, without those of its includes

    def line_of(self, word: str, after: str = "") -> Line:
        """Return the line of a key or a text in quotes, the first ``after`` another; else the first line."""
        start = self.text.find(f'"{after}"') if after else 0
        index = self.text.find(f'"{word}"', max(start, 0))
        return self.lines[self.text.count("\n", 0, index)] if index >= 0 else self.lines[0]

    def line_of_input(self, name: str) -> Line:
        """Return the line that names an input, an image or a buffer."""
        match = re.search(rf'"(?:NAME|TARGET)"\s*:\s*"{re.escape(name)}"', self.text)
        return self.lines[self.text.count("\n", 0, match.end())] if match else self.line_of(name)

    def items(self, key: str, *, named: bool = False) -> list[dict[str, Any]]:
        """Return the objects that a key lists; where they may be ``named``, of an object its values too.

        Raises ``ShaderError`` for anything else.
        """
        entries = self.table.get(key) or []
        if named and isinstance(entries, Mapping):
            entries = [
                {"NAME": name, **(value if isinstance(value, Mapping) else {"PATH": value})}
                for name, value in entries.items()
            ]
        if named and isinstance(entries, list):
            entries = [{"NAME": entry} if isinstance(entry, str) else entry for entry in entries]
        if not isinstance(entries, list) or not all(isinstance(entry, Mapping) for entry in entries):
            raise self.line_of(key).error(f"{key}: expected a list of objects, as [{{…}}, {{…}}]")
        return [dict(entry) for entry in entries]

    def text_of(self, key: str) -> str:
        """Return a text of the header on one line, "" where there is none."""
        text_value = self.table.get(key)
        return " ".join(text_value.split()) if isinstance(text_value, str) else ""

    def unknown(self, keys: Collection[str], valid: Collection[str], what: str) -> list[Diagnostic]:
        """Return a warning of keys that mean nothing, if there are any, with the nearest ``valid`` one."""
        strange = [key for key in keys if key not in valid]
        if not strange:
            return []
        hint = nearest(strange[0].upper(), valid)
        hint = hint if "did you mean" in hint else ""
        message = f"{', '.join(strange)} of {what} means nothing here, and is left out{hint}"
        return [self.line_of(strange[0]).diagnostic(message, severity="warning")]


def read_header(source: SourceText) -> Header:
    """Return the header of a shader; raise ``ShaderError`` at the line and column of a mistake in it."""
    lines = tuple(line for line in source.lines if not line.chain)
    whole = "\n".join(line.text for line in lines).removeprefix("\ufeff")
    begin = _BEGIN.match(whole)
    end = whole.find("*/")
    if begin is None or end < 0:
        message = "an ISF shader begins with its description, a comment that holds JSON, as /*{ … }*/"
        raise lines[0].error(message)
    text = whole[:end]
    start = begin.end()
    lenient = text[:start] + _LENIENT.sub(_strict, text[start:])
    try:
        table, _ = json.JSONDecoder(strict=False).raw_decode(lenient, start)
    except (ValueError, RecursionError) as error:
        raise _wrong(error, lenient, lines) from None
    return Header(table, text, lines)


def is_true(value: object) -> bool:
    """Return whether a flag is set: true, a number above 0, "true"."""
    if isinstance(value, str):
        return value.strip().lower() in _TRUE
    return isinstance(value, int | float) and value > 0


def number_of(value: object) -> float | None:
    """Return a number, also one that is written as a text; None for anything else."""
    try:
        number = float(value) if isinstance(value, int | float | str) else None
    except (ValueError, OverflowError):
        return None
    return number if number is not None and abs(number) < 1e30 else None


def numbers_of(value: object, count: int) -> tuple[float, ...] | None:
    """Return so many numbers of a list; None for anything else."""
    if not isinstance(value, list) or len(value) < count:
        return None
    numbers = [number_of(element) for element in value[:count]]
    return tuple(element for element in numbers if element is not None) if None not in numbers else None


def _strict(match: re.Match[str]) -> str:
    """Return what JSON has in place of what authors write, in the same columns where there is room."""
    word = match.group()
    if match.group("comment") or match.group("comma"):
        return " " * len(word)
    if not match.group("number"):
        return word
    sign, rest = ("-" if word[0] == "-" else ""), word.lstrip("+-")
    whole, point, after = rest.partition(".")
    if point and not after[:1].isdigit():
        after = f"0{after}"
    return f"{sign}{whole.lstrip('0') or '0'}{point}{after}"


def _wrong(error: ValueError | RecursionError, text: str, lines: tuple[Line, ...]) -> ShaderError:
    if isinstance(error, RecursionError):
        return lines[0].error("the description nests too deeply to be read")
    if not isinstance(error, json.JSONDecodeError):
        message, _, at = long_number(text, error)
        line = lines[text.count("\n", 0, at)]
        return ShaderError(f"the description holds {message}", file=shown(line.file), line=line.number)
    at = min(error.pos, len(text.rstrip()))
    line = lines[text.count("\n", 0, at)]
    character = text[at : at + 1]
    what = f"found '{character}'" if character.strip() else "it ends here"
    message = f"the description is not JSON: {error.msg[:1].lower()}{error.msg[1:]}, {what}"
    return line.error(message, at - (text.rfind("\n", 0, at) + 1) + 1)


_NAME = re.compile(r"\$([A-Za-z_]\w*)")
_SIZES = {"WIDTH": "size.x", "HEIGHT": "size.y"}
_ELSEWHERE = ("time", "frames", "compute", "size")
"""Names that mean something else in an expression of a sketch."""

_SAME = ("min", "max", "abs", "floor", "ceil")
_TRANSLATED = {
    "round": (1, "floor({0} + 0.5)"),
    "trunc": (1, "(floor({0}) if {0} >= 0 else ceil({0}))"),
    "mod": (2, "({0} % {1})"),
    "pow": (2, "({0} ** {1})"),
    "clamp": (3, "max({1}, min({2}, {0}))"),
}
"""Functions with the number of their values, and what they are here."""


def translated(text: object, names: Mapping[str, str]) -> str:
    """Return a size in texels, at least 1, as an expression.

    ``names`` are the inputs that are numbers, with what they are called here. Raises
    ``ExpressionError`` for what cannot be one.
    """
    if isinstance(text, bool) or not isinstance(text, str | int | float):
        raise ExpressionError(f'{text!r} is no size; expected a number or a text, as "$WIDTH / 2"')
    written = str(text).strip()

    def name(match: re.Match[str]) -> str:
        word = match.group(1)
        if word not in _SIZES and (word not in names or names[word] in _ELSEWHERE):
            valid = [f"${size}" for size in (*_SIZES, *names)]
            raise ExpressionError(
                f"'{written}' names '{match.group()}', which is not known here{nearest(match.group(), valid)}"
            )
        return _SIZES.get(word) or names[word]

    plain = _NAME.sub(name, written)
    if len(plain) > MAX_LETTERS:
        raise ExpressionError(f"{spell(written)} is longer than {MAX_LETTERS} characters")
    try:
        tree = ast.parse(plain, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ExpressionError(f"'{written}' is not an expression") from None
    whole = f"max(1, floor({_text(tree, written)}))"
    try:
        expressions.check(whole, ("size.x", "size.y", *names.values()))
    except ExpressionError as error:
        reason = str(error).removeprefix(f"'{whole}' ")
        for word, here in _SIZES.items():
            reason = reason.replace(here, f"${word}")
        raise ExpressionError(f"'{written}' {reason}") from None
    return whole


def _text(tree: ast.expr, written: str) -> str:
    """Return an expression with the functions of a sketch in place of ISF's."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            called = node.func.id
            if called not in _SAME and called not in _TRANSLATED:
                hint = nearest(called, [*_SAME, *_TRANSLATED])
                raise ExpressionError(f"'{written}' calls '{called}'{hint}")
    return ast.unparse(_Calls(written).visit(tree))


class _Calls(ast.NodeTransformer):
    """Replaces the calls of functions that a sketch has not."""

    def __init__(self, written: str) -> None:
        self.written = written

    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        if not isinstance(node.func, ast.Name) or node.func.id in _SAME:
            return node
        count, form = _TRANSLATED[node.func.id]
        if len(node.args) != count or node.keywords:
            raise ExpressionError(f"'{self.written}' calls '{node.func.id}' with the wrong number of values")
        values = [f"({ast.unparse(argument)})" for argument in node.args]
        return ast.parse(form.format(*values), mode="eval").body


IMAGE = Sampling("linear", "clamp")
"""How ISF reads an image: it has no mipmaps, and no copies of itself around it."""

OF_PICTURE = ("view.size.x", "view.size.y")
"""The size of what stands in for an image: filters read it by the places of the picture's pixels."""

_IN_KEYS = ("NAME", "TYPE", "LABEL", "DEFAULT", "MIN", "MAX", "IDENTITY", "VALUES", "LABELS", "DESCRIPTION")
_IMPORT_KEYS = ("NAME", "PATH", "TYPE", "DESCRIPTION")
_BINS = 256
_FACES = ("right", "left", "top", "bottom", "front", "back")
_CUBE = ("512", "3072")


@dataclass
class Inputs:
    """What a header declares for its text."""

    parameters: list[Parameter] = field(default_factory=list)
    channels: dict[str, ShaderChannel] = field(default_factory=dict)  # by sampler
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
    inputs = Inputs()
    for entry in header.items("INPUTS"):
        name = _name(entry, header, "an input", inputs, taken)
        line = header.line_of_input(name)
        kind = _BY_LOWER.get(str(entry.get("TYPE", "")).lower(), "")
        if not kind:
            type_name = str(entry.get("TYPE", ""))
            message = (
                f"input '{name}' is left out: ISF has no type '{type_name}'{nearest(type_name, _READERS)}"
            )
            inputs.notes.append(line.diagnostic(message, severity="warning"))
            continue
        inputs.notes += header.unknown(entry.keys(), _IN_KEYS, f"input '{name}'")
        _READERS[kind](_Declared(name, entry, line), inputs)
    for entry in header.items("IMPORTED", named=True):
        name = _name(entry, header, "an imported image", inputs, taken)
        inputs.notes += header.unknown(entry.keys(), _IMPORT_KEYS, f"image '{name}'")
        _import(name, entry, header.line_of_input(name), files, inputs)
    return inputs


@dataclass(frozen=True)
class _Declared:
    name: str
    table: Mapping[str, Any]
    line: Line

    def parameter(self, kind: str, default: Any, widget: Widget) -> Parameter:
        """Return a parameter of a GLSL type."""
        label, tooltip = (str(self.table.get(key) or "").strip() for key in ("LABEL", "DESCRIPTION"))
        parameter = Parameter(self.name, kind, default, widget, label=label, tooltip=tooltip)
        return replace(parameter, file=self.line.file, line=self.line.number)

    def number(self, key: str) -> float | None:
        return number_of(self.table.get(key))


def _name(
    entry: Mapping[str, Any], header: Header, what: str, inputs: Inputs, taken: Callable[[str], str]
) -> str:
    name = entry.get("NAME")
    if not isinstance(name, str) or not name.isidentifier() or not name.isascii():
        line = header.line_of_input(name) if isinstance(name, str) else header.line_of("INPUTS")
        raise line.error(f'{what} needs a NAME that GLSL can use, as "NAME": "level"; found {name!r}')
    already = "two inputs have this name" if name in inputs.names else taken(name)
    if already:
        raise header.line_of_input(name).error(f"{what} cannot be called '{name}': {already}")
    return name


def _float(declared: _Declared, inputs: Inputs) -> None:
    low, high, default = (declared.number(key) for key in ("MIN", "MAX", "DEFAULT"))
    least, most = _ordered(0.0 if low is None else low, 1.0 if high is None else high)
    value = (least + most) / 2 if default is None else default
    if low is None and high is None:  # the author bounds nothing
        least, most = min(least, value), max(most, value)
    widget = Widget("slider", least, most)
    inputs.parameters.append(declared.parameter("float", min(max(value, least), most), widget))


def _bool(declared: _Declared, inputs: Inputs) -> None:
    default = is_true(declared.table["DEFAULT"]) if "DEFAULT" in declared.table else True
    inputs.parameters.append(declared.parameter("bool", default, Widget("checkbox")))


def _event(declared: _Declared, inputs: Inputs) -> None:
    inputs.parameters.append(declared.parameter("bool", False, Widget("button")))


def _long(declared: _Declared, inputs: Inputs) -> None:
    values, labels = (declared.table.get(key) or [] for key in ("VALUES", "LABELS"))
    default = declared.number("DEFAULT")
    if not isinstance(values, list) or not isinstance(labels, list):
        raise declared.line.error(f"input '{declared.name}': expected lists as its VALUES and LABELS")
    numbers = [number_of(element) for element in values] or [float(n) for n in range(len(labels))]
    if None in numbers:
        raise declared.line.error(f"input '{declared.name}': expected whole numbers as its VALUES")
    whole = [_clamped(n) for n in numbers if n is not None]
    if not whole:
        low, high = declared.number("MIN"), declared.number("MAX")
        widget = Widget()
        if low is not None and high is not None:
            least, most = _ordered(_clamped(low), _clamped(high))
            widget = Widget("slider", least, most)
            default = min(max(least if default is None else default, least), most)
        inputs.parameters.append(declared.parameter("int", _clamped(default or 0.0), widget))
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
    inputs.parameters.append(declared.parameter("int", chosen, menu))


def _point(declared: _Declared, inputs: Inputs) -> None:
    low, high, default = (numbers_of(declared.table.get(key), 2) for key in ("MIN", "MAX", "DEFAULT"))
    least, most = low or (0.0, 0.0), high or (1.0, 1.0)
    axes = [_ordered(a, b) for a, b in zip(least, most, strict=True)]
    value = default or tuple((a + b) / 2 for a, b in axes)
    if low is None and high is None:  # the author bounds nothing: places in pixels, as in version 1
        axes = [(min(a, n), max(b, n)) for (a, b), n in zip(axes, value, strict=True)]
    held = tuple(min(max(n, a), b) for n, (a, b) in zip(value, axes, strict=True))
    inputs.parameters.append(declared.parameter("vec2", held, with_axes("point", axes)))


def _color(declared: _Declared, inputs: Inputs) -> None:
    table = declared.table.get("DEFAULT")
    value = numbers_of(table, 4) or (*(numbers_of(table, 3) or (0.0, 0.0, 0.0)), 1.0)
    inputs.parameters.append(declared.parameter("vec4", value, Widget("colour", raw=True)))


def _image(declared: _Declared, inputs: Inputs) -> None:
    number = sum(channel.use == STAND_INS["picture"] for channel in inputs.channels.values())
    inputs.channels[declared.name] = _card(number)


def _cube(declared: _Declared, inputs: Inputs) -> None:
    _add_cube(declared.name, inputs, "a sky stands in for it")


def _add_cube(name: str, inputs: Inputs, unfed: str) -> None:
    inputs.cubes.append(name)
    inputs.channels[name] = stand_in("sky", 0, unfed, IMAGE)


def _sound(content: int) -> Callable[[_Declared, Inputs], None]:
    def read(declared: _Declared, inputs: Inputs) -> None:
        most = declared.number("MAX")
        bins = _BINS if most is None else min(max(_clamped(most), 1), 4096)
        inputs.channels[declared.name] = ShaderChannel(
            use="foreign/spectrum",
            values=(("content", content),),
            size=(str(bins), "1"),
            sampling=IMAGE,
            unfed="a made-up sound stands in for it",
        )

    return read


def _card(number: int, unfed: str = "a stand-in is drawn; a sketch may wire an image to it") -> ShaderChannel:
    """Return the channel of an image that nothing feeds."""
    return replace(stand_in("picture", number, unfed, IMAGE), size=OF_PICTURE)


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


def _import(name: str, entry: Mapping[str, Any], line: Line, files: Files, inputs: Inputs) -> None:
    path = entry.get("PATH")
    if str(entry.get("TYPE", "")).lower() == "cube" or isinstance(path, list):
        _import_cube(name, path, line, files, inputs)
        return
    path = _path(name, path, line)
    if wrong := _lacking(path, line, files):
        inputs.channels[name] = _card(0, f"{wrong}, so a stand-in is drawn")
        return
    declared = _Declared(name, entry, line)
    parameter = declared.parameter("sampler2D", path, Widget("file"))
    inputs.parameters.append(replace(parameter, sampling=IMAGE))


def _import_cube(name: str, value: object, line: Line, files: Files, inputs: Inputs) -> None:
    """Add a cube map of six images: right, left, top, bottom, front, back."""
    if not isinstance(value, list) or len(value) != len(_FACES):
        message = f"cube '{name}' needs the paths of six images, +X, -X, +Y, -Y, +Z and -Z, as its PATH"
        raise line.error(message)
    paths = [_path(name, path, line) for path in value]
    wrong = next(filter(None, (_lacking(path, line, files) for path in paths)), "")
    if wrong:
        _add_cube(name, inputs, f"{wrong}, so a sky stands in")
        return
    inputs.cubes.append(name)
    # What fills the pass ships, so that a path has to be that from the sketch's folder.
    values = tuple(zip(_FACES, (_from_root(path, line, files) for path in paths), strict=True))
    inputs.channels[name] = ShaderChannel(use="foreign/cube_faces", values=values, size=_CUBE, sampling=IMAGE)


def _path(name: str, value: object, line: Line) -> str:
    if not isinstance(value, str) or not value.strip() or "\0" in value:
        raise line.error(f'image \'{name}\' needs the path of its file, as "PATH": "moon.jpg"')
    return value.strip().replace("\\", "/")


def _lacking(path: str, line: Line, files: Files) -> str:
    """Return why there is no image at a path, "" where there is one."""
    if leads_outside(path, files.root, line.file):
        return f"'{path}' lies outside the sketch's folder"
    there = [files.is_there(folder / path) for folder in (Path(line.file).parent, files.root)]
    return "" if any(there) else f"there is no file '{path}'"


def _from_root(path: str, line: Line, files: Files) -> str:
    folder = Path(line.file).parent / path
    return folder.resolve().relative_to(files.root.resolve()).as_posix() if files.is_there(folder) else path


def _ordered(low: float, high: float) -> tuple[float, float]:
    """Return a range that a slider can have: the lower end first, and the ends apart."""
    least, most = min(low, high), max(low, high)
    return (least, most) if most > least else (least, least + 1.0)


def _clamped(number: float) -> int:
    return min(max(math.floor(number), -(2**31)), 2**31 - 1)


NAMES: Names = {
    "TIME": ("float", "time"),
    "TIMEDELTA": ("float", "delta"),
    "FRAMEINDEX": ("int", "frame_of_time"),
    "RENDERSIZE": ("vec2", "resolution"),
    "DATE": ("vec4", "date_from_1"),
}
"""What every ISF shader is given; ``PASSINDEX`` is a macro, and coordinates come from the vertex shader."""

VERTEX_FILES = (".vs", ".vert")
"""What a vertex shader of the author's own ends in, beside the file and of its name."""

_MACROS = ("PASSINDEX",)  # other ones of each pass
_COORDINATE = "in vec2 isf_FragNormCoord;"
_TAKEN = frozenset(
    "vv_FragNormCoord vv_vertShaderInit isf_FragNormCoord isf_vertShaderInit IMG_PIXEL IMG_NORM_PIXEL "
    "IMG_THIS_PIXEL IMG_THIS_NORM_PIXEL IMG_SIZE PASSINDEX".split()
)
_PROPERTIES = {"imgRect": "vec4(0.0, 0.0, IMG_SIZE({0}))", "imgSize": "IMG_SIZE({0})", "flip": "false"}
_SENTENCE = re.compile(r"(.{3,}?[.!?])(?:\s|$)")
_MAX_TITLE = 72
_MAX_PASSES = 64
_MODES = ("", "ISF", "FRAGMENT", "FRAGMENT_SHADER")
_KEYS = (
    *("MODE", "ISFVSN", "VSN", "DESCRIPTION", "CREDIT", "CATEGORIES", "INPUTS", "PASSES", "IMPORTED"),
    *("PERSISTENT_BUFFERS", "LABEL", "KEYWORDS", "TAGS", "LICENSE"),
)
_PASS_KEYS = ("TARGET", "PERSISTENT", "FLOAT", "WIDTH", "HEIGHT", "DESCRIPTION")
_BUFFER_KEYS = ("NAME", "FLOAT", "WIDTH", "HEIGHT", "PERSISTENT", "DESCRIPTION")


@dataclass(frozen=True)
class _Target:
    """A buffer that passes write."""

    name: str
    keeps: bool
    is_float: bool
    sizes: Mapping[str, Any]  # WIDTH and HEIGHT, where they are given


def shaders(files: Files) -> Sequence[Shader]:
    """Return the passes of a file."""
    return _Reader(files).shaders()


class _Reader:
    """One file, its description read."""

    def __init__(self, files: Files) -> None:
        self.files = files
        self.source = live_source(files.source(), {}, unsure=_MACROS, unknown=None)
        self.header = read_header(self.source)
        if not is_declared(self.source.code, "main", anywhere=False):
            raise self.source.lines[-1].error(
                "an ISF shader needs a main() of its own, after its description"
            )
        mode = self.header.table.get("MODE")
        if isinstance(mode, str) and mode.upper() not in _MODES:
            message = f"MODE {mode}: only ISF's own kind is drawn, a fragment shader over the whole picture"
            raise self.header.line_of("MODE").error(message)
        self.notes = self.header.unknown(self.header.table.keys(), _KEYS, "the description")
        self.passes = self.header.items("PASSES") or [{}]
        if len(self.passes) > _MAX_PASSES:
            message = f"{len(self.passes)} passes are more than the {_MAX_PASSES} that are drawn"
            raise self.header.line_of("PASSES").error(message)
        self.inputs: Inputs = read_inputs(self.header, files, _taken)
        self.notes += self.inputs.notes
        self.targets = {target.name: target for target in self._targets()}
        self.text = self._rewritten(self.source)
        self.vertex = self._vertex()

    def shaders(self) -> list[Shader]:
        samplers = [*self.inputs.channels, *self.targets]
        names = {**NAMES, **{name: ("sampler2D", "none") for name in map(self._called, samplers)}}
        names |= {name: ("samplerCube", "none") for name in map(self._called, self.inputs.cubes)}
        helpers = ("isf_image.glsl", "isf_fragment.glsl"), ("isf_image.glsl", "isf_vertex.glsl")
        rules = Rules("isf", names, varyings=(_COORDINATE,), helpers=helpers[0], vertex_helpers=helpers[1])
        channels = {self._called(name): channel for name, channel in self.inputs.channels.items()}
        channels |= {self._called(name): ShaderChannel(target=name, sampling=IMAGE) for name in self.targets}
        parameters = tuple(self._parameters())
        properties = self._properties()
        common = [f"#define _{name}_{what} {_PROPERTIES[what].format(name)}" for name, what in properties]
        result = []
        for index, (pass_table, name) in enumerate(zip(self.passes, self._pass_names(), strict=True)):
            target = self.targets.get(str(pass_table.get("TARGET") or ""))
            result.append(
                Shader(
                    name,
                    self.text,
                    rules,
                    target=target.name if target else "",
                    channels=channels,
                    parameters=parameters,
                    size=self._size(pass_table, target, index),
                    format="rgba32f"
                    if is_true(pass_table.get("FLOAT")) or (target and target.is_float)
                    else "rgba8",
                    prelude=(*self._index(index), *common),
                    named=frozenset(name for name, what in properties if what != "flip"),
                    vertex=self.vertex,
                    keeps=target is not None and target.keeps,
                )
            )
        self.files.notes += dict.fromkeys(self.notes)
        self.files.title = self._title()
        return result

    # ── what the description says ────────────────────────────────────────────

    def _title(self) -> str:
        """Return the description's first sentence, and whose it is."""
        description, credit = self.header.text_of("DESCRIPTION"), self.header.text_of("CREDIT")
        match = _SENTENCE.match(description)
        title = (match.group(1) if match else description).rstrip(".")
        title = title if len(title) <= _MAX_TITLE else f"{title[: _MAX_TITLE - 1]}…"
        credit = credit if len(credit) <= _MAX_TITLE else ""
        if credit and not credit.lower().startswith(("by ", "created by ")):
            credit = f"by {credit}"
        return f"{title or self.files.path.stem}, {credit}" if credit else title

    def _targets(self) -> Iterator[_Target]:
        """Yield the buffers of PASSES, and of version 1's PERSISTENT_BUFFERS."""
        kept = {}
        for table in self.header.items("PERSISTENT_BUFFERS", named=True):
            name = self._target_name(table.get("NAME"), "a persistent buffer")
            kept[name] = table
            self.notes += self.header.unknown(table.keys(), _BUFFER_KEYS, f"buffer '{name}'")
        writers: dict[str, list[Mapping[str, Any]]] = {name: [] for name in kept}
        for index, table in enumerate(self.passes):
            self.notes += self.header.unknown(table.keys(), _PASS_KEYS, f"pass {index}")
            if table.get("TARGET"):
                writers.setdefault(
                    self._target_name(table["TARGET"], f"the target of pass {index}"), []
                ).append(table)
        for name, some in writers.items():
            tables = [*some, kept.get(name, {})]
            sizes = {
                key: next((table[key] for table in tables if table.get(key) not in (None, "")), None)
                for key in ("WIDTH", "HEIGHT")
            }
            keeps = name in kept or any(is_true(table.get("PERSISTENT")) for table in some)
            yield _Target(name, keeps, any(is_true(table.get("FLOAT")) for table in tables), sizes)

    def _target_name(self, name: object, what: str) -> str:
        line = self.header.line_of_input(name) if isinstance(name, str) else self.header.line_of("PASSES")
        if not isinstance(name, str) or not name.isidentifier() or not name.isascii():
            raise line.error(f"{what} needs a name that GLSL can use; found {name!r}")
        taken = "an input has this name" if name in self.inputs.names else _taken(name)
        if taken:
            raise line.error(f"{what} cannot be called '{name}': {taken}")
        return name

    def _size(
        self, pass_table: Mapping[str, Any], target: _Target | None, index: int
    ) -> tuple[str, str] | None:
        """Return the size of a pass; the last one's is the picture's."""
        sides = {
            key: pass_table.get(key) or (target.sizes[key] if target else None) for key in ("WIDTH", "HEIGHT")
        }
        if not any(sides.values()):
            return None
        numbers = {p.name: self._called(p.name) for p in self.inputs.parameters if p.type in _NUMBERS}
        sizes = []
        for key, default in (("WIDTH", "$WIDTH"), ("HEIGHT", "$HEIGHT")):
            try:
                sizes.append(translated(sides[key] or default, numbers))
            except ExpressionError as error:
                after = str(pass_table.get("TARGET") or "PASSES")
                raise self.header.line_of(key, after).error(f"{key} of pass {index}: {error}") from None
        if index == len(self.passes) - 1:
            if sizes != [translated("$WIDTH", {}), translated("$HEIGHT", {})]:
                line = self.header.line_of(
                    "WIDTH" if sides["WIDTH"] else "HEIGHT", str(pass_table.get("TARGET") or "")
                )
                message = f"pass {index} is the last, so it is the picture and has the picture's size"
                self.notes.append(line.diagnostic(message, severity="warning"))
            return None
        return sizes[0], sizes[1]

    def _pass_names(self) -> list[str]:
        """Return a name for each pass: that of its target where it has one."""
        if len(self.passes) == 1:
            return [VIEW]
        names: list[str] = []
        for index, pass_table in enumerate(self.passes):
            first = name = str(pass_table.get("TARGET") or f"pass_{index}")
            number = 2
            while name in names or name in self.inputs.names or (name in self.targets and name != first):
                name, number = f"{first}_{number}", number + 1
            names.append(name)
        return names

    # ── its texts ────────────────────────────────────────────────────────────

    def _rewritten(self, source: SourceText, *, is_vertex: bool = False) -> Rewritten:
        declared = [*self.inputs.names, *self.targets]
        return rewritten(source, is_vertex=is_vertex, declared=declared)

    def _called(self, name: str) -> str:
        """Return what a name is called in the text, where GLSL 3.30 has taken it."""
        return self.text.names.get(name, name)

    def _parameters(self) -> Iterator[Any]:
        for parameter in self.inputs.parameters:
            called = self._called(parameter.name)
            label = parameter.label or ("" if called == parameter.name else parameter.title)
            yield replace(parameter, name=called, label=label)

    def _vertex(self) -> Rewritten | None:
        """Return the author's own vertex shader, if there is one beside the file."""
        places = [self.files.path.with_suffix(suffix) for suffix in VERTEX_FILES]
        there = [path for path in places if self.files.is_there(path)]
        if not there:
            return None
        source = live_source(self.files.source(there[0]), {}, unsure=_MACROS, unknown=None)
        if not is_declared(source.code, "main", anywhere=False):
            raise source.lines[-1].error("a vertex shader needs a main() of its own")
        return self._rewritten(source, is_vertex=True)

    def _index(self, index: int) -> Iterator[str]:
        if "PASSINDEX" not in uniforms(self.source.code):
            yield f"#define PASSINDEX {index}"

    def _properties(self) -> dict[tuple[str, str], None]:
        """Return what the texts read that an image has besides its texels: image and property."""
        code = self.text.source.code + (self.vertex.source.code if self.vertex else "")
        names = {*map(self._called, self.inputs.channels), *map(self._called, self.targets)}
        names |= {p.name for p in self._parameters() if p.type == "sampler2D"}
        words = dict.fromkeys(token.text for token in as_written(code))
        return {
            (name, what): None
            for word in words
            for what in _PROPERTIES
            if word.endswith(f"_{what}") and (name := word[1 : -len(what) - 1]) in names and word[0] == "_"
        }


_NUMBERS = ("float", "int", "bool")


def _taken(name: str) -> str:
    """Return why a name cannot be an input's, "" where it can."""
    if name in NAMES or name in _TAKEN:
        return "ISF itself gives this name"
    if name.startswith(("k_", "gl_")) or "__" in name:
        return "names that begin with k_ or gl_, or hold __, are taken"
    return ""
