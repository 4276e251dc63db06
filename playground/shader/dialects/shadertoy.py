"""Shadertoy: one file with ``mainImage``, its passes, their channels and directives.

Shadertoy declares its channels by what a user puts there, which a file alone does not say. Its lookups do:
a cube map is read at three coordinates, a volume by texels of three. So does a function that a channel is
passed to. Types are followed by name, not by a compiler.

Directives are those of the VS Code extension: ``#iChannel0 "…"``, ``#iUniform`` and the like. The driver
gets a uniform in place of ``#iUniform`` and an empty line in place of the others; ``#iKeyboard`` stays as a
pragma, which ``rewritten`` removes.
"""

from __future__ import annotations

import math
import re
from bisect import bisect_left
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from playground.errors import ShaderError, nearest
from playground.shader.declarations import Declarations, is_declared
from playground.shader.dialects.es import rewritten
from playground.shader.dialects.foreign import (
    VIEW,
    Files,
    Names,
    Rules,
    Shader,
    ShaderChannel,
    picture_parameter,
)
from playground.shader.parameter import Sampling, spell
from playground.shader.preprocessor import WEBGL_2, Token, live_source, readings
from playground.shader.reserved_names import SIZES
from playground.shader.source import Line, SourceText

_LOOKUP = re.compile(r"texture(?:Lod|Grad|Cube\w*)?")
_TYPES = {
    "float": 1,
    "int": 1,
    "uint": 1,
    "bool": 1,
    **{f"{k}vec{n}": n for k in ("", "i", "u") for n in (2, 3, 4)},
}
"""GLSL type → its numbers."""
_CHANNEL = re.compile(r"iChannel\d")
_MACRO = re.compile(r"^[ \t]*#[ \t]*define[ \t]+([A-Za-z_]\w*)(.*)$", re.MULTILINE)
_WORD = re.compile(r"[A-Za-z_]\w*")
_SHAPED = {"samplerCube", "sampler3D"}
_MAX_TOKENS = 300  # of an expression whose numbers are counted
_SWIZZLE = re.compile(r"[xyzw]+|[rgba]+|[stpq]+")
_GIVEN = {"iResolution": 3, "iMouse": 4, "iTime": 1, "fragCoord": 2, "gl_FragCoord": 4}
_OF_ARGUMENTS = frozenset(
    "abs sign floor ceil fract mod min max clamp mix step smoothstep normalize reflect refract sin cos tan "
    "pow exp log sqrt round trunc faceforward".split()
)


def sampler_types(code: str) -> dict[str, str]:
    """Return the channels of a text that are no pictures, each with its type in GLSL."""
    threes, types, unknown = set[str](), dict[str, set[str]](), set[str]()
    for tokens in readings(code):
        reading = _Reading(tokens)
        for name, width in reading.lookups():
            if width == 3:
                threes.add(name)
            elif width:
                types.setdefault(name, set()).add("sampler2D")
            else:
                unknown.add(name)
        for name, kind in reading.handed():
            types.setdefault(name, set()).add(kind)
    kinds = {name: kinds.pop() for name, kinds in types.items() if len(kinds) == 1 and kinds < _SHAPED}
    return {name: "samplerCube" for name in threes - unknown - types.keys()} | kinds


def names_reached(code: str, names: Collection[str]) -> set[str]:
    """Return names, with those that the functions and macros of a text of these names name in turn."""
    bodies: dict[str, set[str]] = {}
    for name, body in _MACRO.findall(code):
        bodies.setdefault(name, set()).update(_WORD.findall(body))
    for tokens in readings(code):
        for function in Declarations(tokens).functions:
            inside = (token.text for token in tokens[function.opens : function.closes])
            bodies.setdefault(function.name, set()).update(filter(_WORD.fullmatch, inside))
    names_seen, added = set[str](), set(names)
    while added:
        names_seen |= added
        added = set().union(*(bodies.get(name, ()) for name in added)) - names_seen
    return names_seen


class _Reading:
    """One reading of a text: its calls, and how many numbers its expressions are."""

    def __init__(self, tokens: Sequence[Token]) -> None:
        self.declared = declared = Declarations(tokens)
        self.texts = [token.text for token in tokens]
        self.functions = (*declared.functions, *declared.prototypes)
        parameters = [parameter for function in self.functions for parameter in function.parameters]
        places = [(v.at, v.name, v.type.name) for v in (*declared.variables, *parameters)]
        places += [(function.opens, f"{function.name}(", function.type.name) for function in self.functions]
        self.widths: dict[str, list[tuple[int, int]]] = {}  # name, with ( a function → where, its numbers
        for at, name, kind in sorted(places):
            if kind in _TYPES:
                self.widths.setdefault(name, []).append((at, _TYPES[kind]))

    def lookups(self) -> Iterator[tuple[str, int]]:
        """Yield the channels that are looked up, each with the numbers of its coordinates, 0 for unknown."""
        for at, arguments in self._calls(_LOOKUP):
            if len(arguments) > 1 and (name := self._channel(arguments[0])):
                yield name, 3 if "Cube" in self.texts[at] else self._width(*arguments[1])

    def handed(self) -> Iterator[tuple[str, str]]:
        """Yield the channels that functions are called with, each with the type that the function takes."""
        forms: dict[str, list[list[str]]] = {}
        for function in self.functions:
            forms.setdefault(function.name, []).append([p.type.name for p in function.parameters])
        for at, arguments in self._calls(_WORD):
            channels = [self._channel(argument) for argument in arguments]
            fitting = [kinds for kinds in forms.get(self.texts[at], ()) if len(kinds) == len(arguments)]
            if not any(channels):
                continue
            if len(fitting) > 1:
                widths = [self._width(*argument) for argument in arguments]
                fitting = [
                    kinds
                    for kinds in fitting
                    if all(not w or _TYPES.get(k, w) == w for k, w in zip(kinds, widths, strict=True))
                ]
            for kinds in fitting:
                yield from ((name, kind) for name, kind in zip(channels, kinds, strict=True) if name)
            called, texel = self.texts[at], [self.texts[start] for start, _ in arguments[1:2]]
            is_volume = called.startswith("texture3D") or (called == "texelFetch" and texel == ["ivec3"])
            if channels[0] and is_volume:
                yield channels[0], "sampler3D"

    def _calls(self, pattern: re.Pattern[str]) -> Iterator[tuple[int, list[tuple[int, int]]]]:
        """Yield the index of each call's name, and where its arguments begin and end."""
        for at in range(len(self.texts) - 2):
            if self.texts[at + 1] == "(" and pattern.fullmatch(self.texts[at]):
                yield at, self._parts(at + 2, self.declared.closing(at + 1) or at + 2, ",")

    def _channel(self, argument: tuple[int, int]) -> str:
        """Return the channel that an argument is, "" for another."""
        start, end = argument
        return self.texts[start] if end == start + 1 and _CHANNEL.fullmatch(self.texts[start]) else ""

    def _parts(self, start: int, end: int, marks: str) -> list[tuple[int, int]]:
        """Return the parts of some tokens between operators, or commas, that are in no bracket."""
        parts: list[tuple[int, int]] = []
        at = start
        while at < end:
            if self.texts[at] in marks and at > start:
                parts.append((start, at))
                start = at + 1
            at = max(self.declared.closing(at) or 0, at) + 1
        return [*parts, (start, end)]

    def _width(self, start: int, end: int) -> int:
        """Return how many numbers an expression is; 0 where that is not known."""
        if end - start > _MAX_TOKENS:
            return 0
        parts = self._parts(start, end, "+-*/")
        if len(parts) > 1:
            return max(self._width(*part) for part in parts)
        while start < end and self.texts[start] in "+-!":
            start += 1
        if start >= end:
            return 0
        last = self.texts[end - 1]
        if self.texts[end - 2] == "." and _SWIZZLE.fullmatch(last):
            return len(last)
        if end == start + 1:
            return self._declared(last, start) or _GIVEN.get(last, 0)
        opens = next((at for at in range(end - 2, start - 1, -1) if self.declared.closing(at) == end - 1), -1)
        if last != ")" or opens < 0:
            return 0
        name = self.texts[opens - 1] if opens > start else ""
        if not name:
            return self._width(opens + 1, end - 1)
        if name in _OF_ARGUMENTS:
            return max(self._width(*part) for part in self._parts(opens + 1, end - 1, ","))
        return 3 if name == "cross" else _TYPES.get(name, 0) or self._declared(f"{name}(", opens)

    def _declared(self, name: str, before: int) -> int:
        """Return the numbers of the latest declaration of a name before an index; 0 where there is none."""
        places = self.widths.get(name, [])
        index = bisect_left(places, (before,))
        return places[index - 1][1] if index else 0


CHANNELS = tuple(f"iChannel{number}" for number in range(4))

NAMES: Names = {
    "iResolution": ("vec3", "resolution"),
    "iTime": ("float", "time"),
    "iGlobalTime": ("float", "time"),
    "iTimeDelta": ("float", "delta"),
    "iFrame": ("int", "frame_of_time"),
    "iFrameRate": ("float", "frame_rate"),
    "iSampleRate": ("float", "sample_rate"),
    "iMouse": ("vec4", "drag"),
    "iDate": ("vec4", "date"),
    "iChannelTime": ("float[4]", "time"),
    "iChannelResolution": ("vec3[4]", f"{SIZES}{' '.join(CHANNELS)}"),
    **{name: ("sampler2D", f"noise {number}") for number, name in enumerate(CHANNELS)},
}

_MORE_CHANNELS = tuple(f"iChannel{number}" for number in range(10))

MORE_NAMES: Names = {
    **NAMES,
    "iGlobalFrame": ("int", "frame_of_time"),
    "iMouseButton": ("vec4", "buttons"),
    "iViewMatrix": ("mat4", "identity4"),
    "iChannelResolution": ("vec3[10]", f"{SIZES}{' '.join(_MORE_CHANNELS)}"),
    **{name: ("sampler2D", f"noise {number}") for number, name in enumerate(_MORE_CHANNELS)},
}
"""Those of the VS Code extension."""

MACROS = {**WEBGL_2, "HW_PERFORMANCE": "1"}
"""What Shadertoy defines."""


def defines(source: SourceText) -> tuple[str, ...]:
    """Return those of Shadertoy's own macros that a text names."""
    return ("#define HW_PERFORMANCE 1",) if "HW_PERFORMANCE" in source.names else ()


RULES = Rules("shadertoy", NAMES, epilogue="main_image.glsl", defines=defines)


_NOT_DRAWN = {"mainSound": "sound", "mainVR": "for VR"}


def shaders(files: Files) -> Sequence[Shader]:
    """Return the passes of a file."""
    source = live_source(files.source(), MACROS)
    note_not_drawn(files, source)
    return (Shader(VIEW, rewritten(source), replace(RULES, names=with_sampler_types(NAMES, source))),)


_STAND_INS = {"samplerCube": "sky", "sampler3D": "volume"}


def with_sampler_types(names: Names, source: SourceText) -> Names:
    """Return names with the channels as the cube maps and volumes that a text reads."""
    types = {name: kind for name, kind in sampler_types(source.code).items() if name in names}
    return {**names, **{name: (kind, f"{_STAND_INS[kind]} {name[-1]}") for name, kind in types.items()}}


def note_not_drawn(files: Files, source: SourceText) -> None:
    """Note each function of a text that makes no picture here."""
    for function, what in _NOT_DRAWN.items():
        if line := _defines(source, function):
            files.note_at(line, f"{function} is {what}, which is not drawn")


def refused(files: Files) -> Sequence[Shader]:
    """Raise ``ShaderError`` for a text that has no picture of its own, at the function that it has."""
    source = files.source()
    for function, what in _NOT_DRAWN.items():
        if line := _defines(source, function):
            raise line.error(f"{function} is {what}, which is not drawn, and there is no mainImage")
    line = _defines(source, "mainCubemap") or source.lines[0]
    raise line.error(
        "a cube map alone is not drawn: as 'Cube A.glsl' it is, next to an Image.glsl that reads it"
    )


def _defines(source: SourceText, function: str) -> Line | None:
    return source.line_with(rf"\b{function}\s*\(")


KEYBOARD = "iKeyboard"
MAX_CHANNELS = 10

_STRICT = "StrictCompatibility"  # mainImage is what runs: so it is here wherever a text has one
_DIRECTIVE = re.compile(rf"\s*#\s*(i[A-Z]\w*|{_STRICT})\b(.*)", re.DOTALL)
_ASKS_FOR_KEYS = f"#pragma {KEYBOARD}"
_CHANNEL_LINE = re.compile(r'\s*#\s*iChannel(\d)\s*(?:::\s*(\w+)\s*)?(["\'])(.*?)\3')
_UNIFORM = re.compile(
    r"\s*(\w+)\s+([A-Za-z_]\w*)\s*(?:=\s*(.+?)\s*)?(?:\bin\s*\{\s*([^,{}]+),\s*([^,{}]+)\})?"
    r"\s*(?:\bstep\s+(\S+))?\s*;?\s*$"
)
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_COLOURS = {"color3": "vec3", "color4": "vec4"}
_TYPE_NAMES = (
    "float",
    "int",
    "uint",
    "bool",
    *(f"{kind}vec{n}" for kind in ("", "i", "u") for n in (2, 3, 4)),
)
_FILTERS = (
    "Nearest", "Linear", "NearestMipMapNearest", "NearestMipMapLinear", "LinearMipMapNearest",
    "LinearMipMapLinear",
)  # fmt: skip
_NOT_DONE = {
    "iFirstPersonControls": ": no key moves a camera here, so iViewMatrix stays the identity",
    "iVertex": ": no vertex shader is run here, so the picture is drawn over the whole view",
    "iSound": " is sound, which is not drawn",
}
"""What is not as in the extension, by directive: the rest of a sentence."""
_CHOICES = {
    "MinFilter": _FILTERS,
    "MagFilter": ("Nearest", "Linear"),
    "WrapMode": ("Clamp", "Repeat", "Mirror"),
    "Type": ("Texture2D", "CubeMap"),
}


@dataclass
class ChannelLines:
    """What the lines of one channel say."""

    line: Line  # the first of them
    path: str = ""  # "file://x.png", "self"; "" where no line says it
    settings: dict[str, str] = field(default_factory=dict)  # MinFilter, MagFilter, WrapMode, Type

    @property
    def is_cube(self) -> bool:
        """Whether it is a cube map."""
        return self.settings.get("Type") == "CubeMap"

    def sampling(self, usual: Sampling) -> Sampling:
        """Return how it is read; what no line says is as ``usual``."""
        least, most = self.settings.get("MinFilter", ""), self.settings.get("MagFilter", "")
        wrap = self.settings.get("WrapMode", "")
        result = replace(usual, wrap=wrap.lower()) if wrap else usual
        if least:
            form = "nearest" if least.startswith("Nearest") else "linear"
            result = replace(result, filter=form, mipmap="MipMap" in least)
        return replace(result, magnify=most.lower()) if most else result


@dataclass(frozen=True)
class Read:
    """A text without its directives, and what they say."""

    source: SourceText
    channels: dict[int, ChannelLines]
    notes: tuple[tuple[Line, str], ...]  # lines, and what is not as in the extension


def read_directives(source: SourceText) -> Read:
    """Read the directives of a text; raise ``ShaderError`` at a line that cannot be understood."""
    channels: dict[int, ChannelLines] = {}
    notes: list[tuple[Line, str]] = []
    lines = []
    for line in source.lines:
        match = _DIRECTIVE.match(line.code)
        if match is None:
            lines.append(line)
        elif match.group(1).startswith("iChannel"):
            _channel(line, channels)
            lines.append(replace(line, code=""))
        elif match.group(1) == "iUniform":
            lines.append(_uniform(line, match.group(2)))
        elif match.group(1) == KEYBOARD:
            lines.append(replace(line, code=_ASKS_FOR_KEYS))
        else:
            name = match.group(1)
            if name != _STRICT:
                notes.append((line, f"#{name}{_NOT_DONE.get(name, ' is not known here, and does nothing')}"))
            lines.append(replace(line, code=""))
    return Read(SourceText(source.path, tuple(lines), source.files), channels, tuple(notes))


def has_keyboard(source: SourceText) -> bool:
    """Return whether a text, with what is included and common, asks for the keyboard."""
    return any(line.code == _ASKS_FOR_KEYS for line in source.lines)


def _channel(line: Line, channels: dict[int, ChannelLines]) -> None:
    match = _CHANNEL_LINE.match(line.text)
    if match is None:
        raise line.error('expected #iChannel0 "file://picture.png", or #iChannel0::WrapMode "Repeat"')
    number, name, text = int(match.group(1)), match.group(2), match.group(4)
    channel = channels.setdefault(number, ChannelLines(line))
    if not name:
        channel.path, channel.line = text, line
        return
    setting = next((choice for choice in _CHOICES if choice.lower() == name.lower()), None)
    if setting is None:
        raise line.error(
            f"#iChannel{number} has no '{name}'{nearest(name, _CHOICES)}", line.text.find(name) + 1
        )
    value = next((choice for choice in _CHOICES[setting] if choice.lower() == text.lower()), None)
    if value is None:
        wrong = f"{setting} of #iChannel{number}: no '{text}'{nearest(text, _CHOICES[setting])}"
        raise line.error(wrong, line.text.find(text) + 1)
    channel.settings[setting] = value


def _uniform(line: Line, text: str) -> Line:
    """Return a line that declares a parameter as ours do, with a ``//!`` annotation."""
    match = _UNIFORM.match(text)
    if match is None:
        example = "#iUniform float size = 1.0 in { 0.0, 5.0 } step 0.1"
        raise line.error(f"cannot read this #iUniform; expected as {example}")
    kind, name, initial, low, high, step = match.groups()
    if kind not in (*_TYPE_NAMES, *_COLOURS):
        hint = nearest(kind, (*_TYPE_NAMES, *_COLOURS))
        raise line.error(f"#iUniform of the type '{kind}'{hint}", line.text.find(kind) + 1)
    glsl = _COLOURS.get(kind, kind)
    bounds = [_float(line, word) for word in (low, high)] if low else []
    value = _initial(line, kind, glsl, initial, bounds)
    calls = ["colour"] if kind in _COLOURS else []
    if len(bounds) == 2 and bounds[0] < bounds[1] and kind not in _COLOURS and glsl != "bool":
        calls.append(f"slider({bounds[0]:g}, {bounds[1]:g})")
    if step and glsl != "bool" and (size := _float(line, step)) > 0:
        calls.append(f"step({size:g})")
    note = " ".join(["!", *calls, line.comment.strip()])
    return replace(line, code=f"uniform {glsl} {name}{value};", comment=note)


def _initial(line: Line, kind: str, glsl: str, initial: str | None, bounds: list[float]) -> str:
    """Return " = value" in GLSL, within the bounds; "" where there is none."""
    if initial is None:
        return ""
    if glsl == "bool" or not (bounds or glsl != kind or "vec" in glsl):
        return f" = {initial}"
    numbers = initial.partition("(")[2] if "(" in initial else initial
    names = [_float(line, number) for number in _NUMBER.findall(numbers)]
    if len(bounds) == 2 and bounds[0] < bounds[1]:
        names = [min(max(number, bounds[0]), bounds[1]) for number in names]
    whole = glsl in ("int", "uint") or glsl.startswith(("i", "u"))
    texts = [str(int(number)) if whole else repr(number) for number in names]
    if "vec" not in glsl:
        return f" = {texts[0] if texts else initial}"
    return f" = {glsl}({', '.join(texts)})"


def _float(line: Line, text: str) -> float:
    text = text.strip()
    try:
        number = float(text.rstrip("fF"))
    except ValueError:
        number = math.nan
    if not abs(number) < 1e30:
        raise line.error(f"expected a number, not {spell(text)}", line.text.find(text) + 1)
    return number


IMAGE, BUFFER, CUBE = "image", "buffer", "cubemap"
CUBE_SIDE = 1024
"""Texels of a side of a cube map's face, as on Shadertoy's site."""

OF_BUFFERS = Sampling("linear", "clamp")
"""How a pass is read where nothing says how."""

_ORDER = (BUFFER, CUBE, IMAGE)
_EPILOGUES = {IMAGE: "main_image.glsl", BUFFER: "main_buffer.glsl", CUBE: "main_cubemap.glsl"}
_FORMATS = {IMAGE: "rgba8", BUFFER: "rgba32f", CUBE: "rgba16f"}
_FUNCTIONS = {IMAGE: "mainImage", BUFFER: "mainImage", CUBE: "mainCubemap"}
_NOT_NAMES = re.compile(r"\W+")


@dataclass(frozen=True)
class ToyInput:
    """What one channel reads: a pass or a technique, or an image file."""

    channel: ShaderChannel
    type: str = "sampler2D"
    file: str = ""  # an image, from the root


@dataclass(frozen=True)
class ToyPass:
    """One pass, as its tool calls it."""

    label: str  # "Buffer A"
    kind: str  # image | buffer | cubemap
    source: SourceText  # what they have in common before it
    inputs: Mapping[str, ToyInput] = field(default_factory=dict)  # by sampler; others are noise
    may_have_main: bool = False  # one of its own, in place of the function of its kind
    called: str = ""  # its name, where that is not made of the label

    @property
    def name(self) -> str:
        """Its name as a pass, and as what others read."""
        return self.called or pass_name(self.label)


def pass_name(label: str) -> str:
    """Return the name of a pass that its tool calls so: ``buffer_a`` of "Buffer A"."""
    return _NOT_NAMES.sub("_", label.strip()).strip("_").lower()


def with_common(common: SourceText | None, source: SourceText) -> SourceText:
    """Return a pass's text after what all have in common; each line stays that of its own file."""
    if common is None:
        return source
    files = tuple(dict.fromkeys((*source.files, *common.files)))
    return SourceText(source.path, (*common.lines, *source.lines), files)


def shaders_of(passes: Sequence[ToyPass], dialect: str = "shadertoy") -> tuple[Shader, ...]:
    """Return the shaders of some passes in the order in which they are drawn, the image last.

    ``dialect`` is the name of their row.

    Buffers and cube maps come in the order given. Raises ``ShaderError`` for one without its function.
    """
    ordered = sorted(passes, key=lambda item: _ORDER.index(item.kind))
    macros = {"SHADER_TOY": "", **WEBGL_2} if dialect == "vscode" else MACROS
    live = [replace(item, source=live_source(item.source, macros)) for item in ordered]
    return tuple(_shader(item, dialect) for item in live)


def _shader(toy: ToyPass, dialect: str) -> Shader:
    function = _FUNCTIONS[toy.kind]
    is_there = function in toy.source.names
    has_main = toy.may_have_main and not is_there and is_declared(toy.source.code, "main", anywhere=False)
    if not (is_there or has_main):
        own = [line for line in toy.source.lines if line.text.strip()]
        position = own[-1] if own else toy.source.lines[-1]
        others = next((f for f in ("mainImage", "mainCubemap", "mainSound") if f in toy.source.names), "")
        hint = f", but a {others}" if others else ""
        raise ShaderError(diagnostics=[position.diagnostic(f"{toy.label} has no {function}{hint}")])
    names = dict(with_sampler_types(MORE_NAMES if dialect == "vscode" else NAMES, toy.source))
    parameters = []
    for sampler, feeds in toy.inputs.items():
        if feeds.file:
            names.pop(sampler, None)
            line = toy.source.lines[-1]
            parameters.append(picture_parameter(sampler, feeds.file, feeds.channel.sampling, line))
        else:
            names[sampler] = (feeds.type, "none")
    if toy.kind == CUBE:
        names["iResolution"] = ("vec3", "square_resolution")
    has_keyboard = KEYBOARD in toy.inputs
    return Shader(
        toy.name,
        rewritten(toy.source),
        Rules(
            dialect,
            names,
            epilogue="" if has_main else _EPILOGUES[toy.kind],
            helpers=("vscode_keyboard.glsl",) if has_keyboard else (),
            defines=defines if dialect != "vscode" else lambda source: (),
        ),
        named=frozenset({KEYBOARD}) if has_keyboard else frozenset(),
        target=toy.name,
        channels={name: feeds.channel for name, feeds in toy.inputs.items() if not feeds.file},
        parameters=tuple(parameters),
        size=(str(CUBE_SIDE), str(6 * CUBE_SIDE)) if toy.kind == CUBE else None,
        format=_FORMATS[toy.kind],
        prelude=(
            *(("#define SHADER_TOY",) if dialect == "vscode" else ()),
            *((f"const float k_side = {CUBE_SIDE}.0;",) if toy.kind == CUBE else ()),
        ),
        keeps=toy.kind != IMAGE,
    )


def reading(target: str, sampling: Sampling = OF_BUFFERS) -> ShaderChannel:
    """Return a channel that reads a pass."""
    return replace(ShaderChannel(target=target), sampling=sampling)
