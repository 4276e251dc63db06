"""Shadertoy: ``mainImage``, passes and their channels, of one file, of an export, of a folder.

Shadertoy declares its channels by what a user puts there, which a file alone does not say. Its lookups do:
a cube map is read at three coordinates, a volume by texels of three. So does a function that a channel is
passed to. Types are followed by name, not by a compiler.

Directives are those of the VS Code extension: ``#iChannel0 "…"``, ``#iUniform`` and the like. The driver
gets a uniform in place of ``#iUniform`` and an empty line in place of the others; ``#iKeyboard`` stays as a
pragma, which ``rewritten`` removes.

The passes of an export are texts in its strings. A line of one is named by the file, the pass and its own
number. In a folder each pass is a file, ``.glsl`` or ``.frag``, as "Buffer A", with a space, ``_`` or
neither, in any case. A line as ``#iChannel0 "file://Buffer A.glsl"`` or a comment as
``// iChannel0: Buffer A`` says what a channel reads; without one, channel 0 reads Buffer A, 1 Buffer B and so
on, of those that are there.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from playground.allowed_files import SHADERS, how_to_open, is_inside, leads_outside, names_below
from playground.dialects import foreign
from playground.dialects.es import rewritten
from playground.dialects.foreign import (
    SAMPLING,
    VIEW,
    Files,
    Names,
    Rules,
    Shader,
    ShaderChannel,
    declaration,
    picture_parameter,
    stand_in,
)
from playground.errors import ShaderError, SketchError, nearest
from playground.json_text import read_json
from playground.paths import shown
from playground.shader.conditions import WEBGL_2, live_code, live_source
from playground.shader.declarations import is_declared
from playground.shader.header import title_of
from playground.shader.parameter import Sampling, spell
from playground.shader.reserved_names import SIZES
from playground.shader.source import Line, SourceText
from playground.shader.syntax.nodes import Function, Name
from playground.shader.syntax.symbols import Symbol, symbols_of
from playground.shader.syntax.tokens import is_named
from playground.shader.syntax.types import UNKNOWN, ExpressionType, ExpressionTypes, components, conversions

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

_LOOKUPS = ("texture", "textureLod", "textureGrad")
_SHAPED = {"samplerCube", "sampler3D"}
_DECLARED = "vec2 fragCoord; " + " ".join(
    f"uniform {declaration(kind, name)};" for name, (kind, _) in MORE_NAMES.items() if kind != "sampler2D"
)


def sampler_types(code: str) -> dict[str, str]:
    """Return the channels of a text that are no pictures, each with its type in GLSL."""
    threes, types, unknown = set[str](), dict[str, set[str]](), set[str]()
    if "iChannel" not in code:
        return {}
    symbols = symbols_of(f"{_DECLARED}{code}")
    of = ExpressionTypes(symbols).of
    for site in symbols.calls:
        call, arguments = site.node, site.node.arguments
        channels = [
            one.name if isinstance(one, Name) and one.name in _MORE_CHANNELS else "" for one in arguments
        ]
        if not any(channels):
            continue
        given = [of(one) for one in arguments]
        fitting = [kinds for kinds in map(_parameters, site.functions) if _fits(given, kinds)]
        for kinds in fitting:
            for name, (kind, _) in zip(channels, kinds, strict=True):
                types.setdefault(name, set()).add(kind)
        name, place = channels[0], given[1] if len(given) > 1 else UNKNOWN
        width = components(place[0])[1]
        if not name or fitting:
            continue
        if call.name.startswith("texture3D") or (call.name == "texelFetch" and place == ("ivec3", 0)):
            types.setdefault(name, set()).add("sampler3D")
        elif call.name.startswith("textureCube") or (call.name in _LOOKUPS and width == 3):
            threes.add(name)
        elif call.name in _LOOKUPS and width:
            types.setdefault(name, set()).add("sampler2D")
        elif call.name in _LOOKUPS:
            unknown.add(name)
    sure = {name: kinds.pop() for name, kinds in types.items() if len(kinds) == 1 and kinds < _SHAPED}
    return {name: "samplerCube" for name in threes - unknown - types.keys()} | sure


def _parameters(function: Symbol) -> list[ExpressionType]:
    assert isinstance(function.node, Function)
    return [(p.type.name, len(p.type.arrays) + len(p.arrays)) for p in function.node.parameters]


def _fits(given: Sequence[ExpressionType], wanted: Sequence[ExpressionType]) -> bool:
    """Return whether a function takes arguments; what is not known may be anything."""
    return len(given) == len(wanted) and all(
        not one[0] or conversions(one, other) is not None for one, other in zip(given, wanted, strict=True)
    )


def names_reached(code: str, names: Collection[str]) -> set[str]:
    """Return names, with those that the functions and macros of a text of these names name in turn."""
    bodies: dict[str, set[str]] = {}
    tree = symbols_of(code).tree
    for macro in tree.preprocessed.macros:
        bodies.setdefault(macro.name, set()).update(token.text for token in macro.body)
    for node in tree.declarations:
        if isinstance(node, Function) and node.body:
            inside = (token.text for token in tree.tokens[node.body.first : node.body.last])
            bodies.setdefault(node.name, set()).update(inside)
    names_seen, added = set[str](), set(names)
    while added:
        names_seen |= added
        added = set().union(*(bodies.get(name, ()) for name in added)) - names_seen
    return names_seen


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
    return source.line_naming(function, called=True)


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


# ── the VS Code extension: files that name the files that their channels read

_OF_CUBES = Sampling("linear", "clamp", mipmap=True)
_SCHEME = re.compile(r"(?:file|buf|glsl)://")
_WEB = re.compile(r"https?://", re.IGNORECASE)
_SOUND_ENDINGS = (".mp3", ".wav", ".ogg", ".flac", ".m4a", ".aac", ".opus")
_PICTURES = (".png", ".jpg", ".jpeg", ".webp", ".tif", ".tiff")
_FACES = (
    ("px", "nx", "py", "ny", "pz", "nz"),
    ("e", "w", "u", "d", "n", "s"),
    ("east", "west", "up", "down", "north", "south"),
    ("posx", "negx", "posy", "negy", "posz", "negz"),
)
_FACE_NAMES = ("right", "left", "top", "bottom", "front", "back")
_CUBE_SIZE = ("512", "3072")
_MAX_PASSES = 32


def vscode_shaders(files: Files) -> Sequence[Shader]:
    """Return the passes of a file, those that its channels read before it."""
    reader = Reader(files)
    reader.add(files.path, IMAGE)
    return shaders_of(reader.passes(), "vscode")


@dataclass
class Reader:
    """Reads files that read each other, each once.

    ``labels`` are those of files that have one besides their name, ``inputs`` what their channels read that
    no line of theirs names; ``common`` comes before each.
    """

    files: Files
    labels: dict[Path, str] = field(default_factory=dict)
    kinds: dict[Path, str] = field(default_factory=dict)
    inputs: dict[Path, dict[str, ToyInput]] = field(default_factory=dict)
    common: SourceText | None = None
    _names: dict[Path, str] = field(default_factory=dict)  # of passes, those that are being read too
    _done: dict[Path, ToyPass] = field(default_factory=dict)  # in the order in which they are drawn
    _read_before: set[Path] = field(default_factory=set)  # whose last frame somebody reads

    def add(self, path: Path, kind: str) -> str:
        """Read a file and those that it reads; return the name of its pass."""
        if path in self._names:
            if path not in self._done:
                self._read_before.add(path)
            return self._names[path]
        if len(self._names) >= _MAX_PASSES:
            raise ShaderError(f"more than {_MAX_PASSES} passes", file=path)
        label = self.labels.get(path, path.stem)
        name = pass_name(label) or "pass"
        while name in self._names.values():
            name += "_"
        self._names[path] = name
        read = read_directives(self.files.source(path))
        for line, message in read.notes:
            self.files.note_at(line, message)
        note_not_drawn(self.files, live_source(read.source, WEBGL_2, unsure={"SHADER_TOY"}))
        feeds = dict(self.inputs.get(path, {}))
        for number, channel in read.channels.items():
            feeds[f"iChannel{number}"] = self._feed(path, number, channel)
        source = with_common(self.common, read.source)
        if has_keyboard(source):
            feeds[KEYBOARD] = ToyInput(stand_in("keys", 0, ""))
        label = self.labels.get(path, path.name)
        self._done[path] = ToyPass(label, kind, source, feeds, True, name)
        return name

    def passes(self) -> tuple[ToyPass, ...]:
        """Return the passes; where the picture reads itself, one more shows it."""
        passes = []
        for path, toy in self._done.items():
            if toy.kind == IMAGE and path in self._read_before:
                passes += [replace(toy, kind=BUFFER), _showing(toy)]
            else:
                passes.append(toy)
        return tuple(passes)

    def _feed(self, path: Path, number: int, channel: ChannelLines) -> ToyInput:
        """Return what a channel reads; raise ``ShaderError`` for a shader that is not there."""
        text = _SCHEME.sub("", channel.path)
        of_buffers, of_pictures = channel.sampling(OF_BUFFERS), channel.sampling(SAMPLING)
        if text == "self":
            self._read_before.add(path)
            return ToyInput(reading(self._names[path], of_buffers))
        ending = Path(text).suffix.lower()
        if ending in SHADERS:
            path_found = self._found(text, channel.line)
            if path_found is None:
                hint = nearest(text, names_below((path.parent,), SHADERS))
                raise channel.line.error(f"#iChannel{number}: there is no file '{text}'{hint}")
            if path_found == path:
                self._read_before.add(path)
            kind = self.kinds.get(path_found, BUFFER)
            name = self.add(path_found, kind)
            return ToyInput(reading(name, of_buffers), "samplerCube" if kind == CUBE else "sampler2D")
        if channel.is_cube:
            return self._cube(text, channel, number)
        form, unfed = "picture", ""
        if not text:
            form, unfed = "noise", "no line says what it reads, so a stand-in is drawn"
        elif _WEB.match(text):
            unfed = f"'{text}' is on the web, where nothing is read, so a stand-in is drawn"
        elif ending in _SOUND_ENDINGS:
            return ToyInput(self._sound(text, number, channel))
        elif ending not in _PICTURES:
            unfed = f"'{text}' is no image that can be read, so a stand-in is drawn"
        elif (path_found := self._found(text, channel.line)) is not None:
            file = path_found.relative_to(self.files.root.resolve()).as_posix()
            return ToyInput(ShaderChannel(sampling=of_pictures), file=file)
        else:
            unfed = f"there is no file '{text}' in this folder, so a stand-in is drawn"
        return ToyInput(stand_in(form, number, unfed, of_pictures))

    def _sound(self, text: str, number: int, channel: ChannelLines) -> ShaderChannel:
        """Return a sound file's spectrum and wave, or those of a made-up one."""
        sampling, path_found = channel.sampling(OF_BUFFERS), self._found(text, channel.line)
        if path_found is not None:
            file = path_found.relative_to(self.files.root.resolve()).as_posix()
            return ShaderChannel(
                "", "foreign/sound", (("sound", file),), foreign.SIZES["foreign/sound"], sampling
            )
        unfed = f"there is no file '{text}' in this folder, so a made-up sound stands in for it"
        return stand_in("sound", 0, unfed, sampling)

    def _cube(self, text: str, channel: ChannelLines, number: int) -> ToyInput:
        """Return a cube map of six files, or a sky."""
        sampling = channel.sampling(_OF_CUBES)
        if "{}" in text:
            for letters in _FACES:
                faces = [self._found(text.replace("{}", letter), channel.line) for letter in letters]
                there = [face for face in faces if face is not None]
                if len(there) == len(letters):
                    root = self.files.root.resolve()
                    values = [
                        (name, face.relative_to(root).as_posix())
                        for name, face in zip(_FACE_NAMES, there, strict=True)
                    ]
                    made = ShaderChannel(
                        use="foreign/cube_faces", values=tuple(values), size=_CUBE_SIZE, sampling=sampling
                    )
                    return ToyInput(made, "samplerCube")
        unfed = f"'{text}' is not there with all of px nx py ny pz nz for {{}}, so a stand-in is drawn"
        return ToyInput(stand_in("sky", number, unfed, sampling), "samplerCube")

    def _found(self, text: str, line: Line) -> Path | None:
        """Return the file that a line names, inside the folder; None where there is none."""
        root = self.files.root.resolve()
        for folder in _around(Path(line.file).parent, root):
            path = folder / text
            if "\0" not in text and self.files.is_there(path):
                if is_inside(path, (root,)):
                    return path.resolve()
                more = how_to_open(path.resolve(), root)
                raise line.error(f"'{text}' lies outside the shader's own folder, {shown(root)}{more}")
        return None


def _around(folder: Path, root: Path) -> Iterator[Path]:
    """Yield a folder, those around it up to the root, and the root."""
    yield folder
    yield from (parent for parent in folder.parents if parent.is_relative_to(root))
    yield root


def _showing(toy: ToyPass) -> ToyPass:
    """Return the pass that shows another, opaque."""
    first = toy.source.lines[0]
    code = "void mainImage(out vec4 c, in vec2 p) { c = texelFetch(k_shown, ivec2(p), 0); }"
    line = Line("", code, "", first.file, first.number)
    source = SourceText(toy.source.path, (line,), toy.source.files)
    return ToyPass("shown", IMAGE, source, {"k_shown": ToyInput(reading(toy.name))})


# ── passes on disk: an export as JSON, or a folder of files ─────────────────

_COMMON, _SOUND = "common", "sound"
_KINDS = (IMAGE, BUFFER, CUBE, _COMMON, _SOUND)
_BY_NAME = (
    (re.compile(r"^common\b", re.IGNORECASE), _COMMON),
    (re.compile(r"^sound\b", re.IGNORECASE), _SOUND),
    (re.compile(r"^cube", re.IGNORECASE), CUBE),
    (re.compile(r"^buf", re.IGNORECASE), BUFFER),
    (re.compile(r"^image\b", re.IGNORECASE), IMAGE),
)
_PREVIEW = re.compile(r"/previz/(buffer|cubemap)(\d\d)\.png$")
_PHOTO = re.compile(r"\.(?:jpe?g|webp)$", re.IGNORECASE)
_LETTERS = "ABCDEFGH"
_LETTERED = re.compile(r"\s*(?:buf(?:fer)?|cube(?:map)?)?[\s_]*([a-h])\s*$", re.IGNORECASE)
_CHANNELS = ("0", "1", "2", "3")
_EXPORTED_TYPES = {
    "cubemap": ("samplerCube", "sky"),
    "volume": ("sampler3D", "volume"),
    "video": ("sampler2D", "picture"),
    "webcam": ("sampler2D", "picture"),
}
_SOUNDS = ("music", "musicstream", "mic")
_NOT_FED = {
    "video": "a video",
    "webcam": "a camera",
    "mic": "a microphone",
    "music": "music",
    "musicstream": "a stream of music",
}


@dataclass(frozen=True)
class _Pass:
    """One entry of ``renderpass``."""

    label: str
    kind: str
    code: str
    inputs: tuple[Mapping[str, Any], ...]
    outputs: tuple[str, ...]


def export_shaders(files: Files) -> Sequence[Shader]:
    """Return the passes of an export; raise ``SketchError`` for what is damaged or draws nothing."""
    shader = _table(files)
    passes = _passes(files, shader)
    common = next((files.part(pass_.label, pass_.code) for pass_ in passes if pass_.kind == _COMMON), None)
    for pass_ in passes:
        if pass_.kind == _SOUND:
            files.note(f"{pass_.label} is sound, which is not drawn")
    drawn = [pass_ for pass_ in passes if pass_.kind in (IMAGE, BUFFER, CUBE)]
    if not any(item.kind == IMAGE for item in drawn):
        there = ", ".join(pass_.label for pass_ in passes) or "nothing"
        raise _wrong(files, f"there is no Image pass to draw; there is {there}")
    written = {output: item for item in drawn for output in item.outputs}
    made = []
    for pass_ in sorted(drawn, key=lambda item: item.label):
        source = files.part(pass_.label, pass_.code)
        note_not_drawn(files, live_source(source, MACROS))
        inputs = dict(_inputs(files, pass_, written, drawn))
        made.append(ToyPass(pass_.label, pass_.kind, with_common(common, source), inputs))
    info = shader.get("info")
    files.title = str(info.get("name") or "") if isinstance(info, dict) else ""
    return shaders_of(made, "export")


def _table(files: Files) -> Mapping[str, Any]:
    """Return the table that holds ``renderpass``."""
    try:
        document = read_json(files.text(), strict=False)
    except json.JSONDecodeError as error:
        message = f"damaged JSON: {error.msg[:1].lower()}{error.msg[1:]}"
        raise SketchError(message, file=shown(files.path), line=error.lineno, column=error.colno) from None
    except ValueError as error:
        raise _wrong(files, f"damaged JSON: {error}") from None
    several = document if isinstance(document, list) else [document]
    tables = [table.get("Shader", table) for table in several if isinstance(table, dict)]
    shaders = [
        table for table in tables if isinstance(table, dict) and isinstance(table.get("renderpass"), list)
    ]
    if not shaders:
        raise _wrong(files, "an export holds a list of passes called renderpass, and none is here")
    if len(shaders) > 1:
        files.note(f"this holds {len(shaders)} shaders; the first is drawn")
    return shaders[0]


def _passes(files: Files, shader: Mapping[str, Any]) -> list[_Pass]:
    """Return the passes with their labels, each of them once."""
    passes: list[_Pass] = []
    for index, table in enumerate(shader["renderpass"]):
        where = f"renderpass[{index}]"
        if table is None or table == {}:
            continue
        if not isinstance(table, dict):
            raise _wrong(files, f"{where} is not a table of a pass")
        code = table.get("code")
        name = str(table.get("name") or "")
        if not isinstance(code, str):
            raise _wrong(files, f"{name or where} has no code, a text")
        kind = table.get("type") or next((k for sign, k in _BY_NAME if sign.search(name)), IMAGE)
        if kind not in _KINDS:
            files.note(f"{name or where} is of the type '{kind}', which is not drawn")
            continue
        label = _label(kind, name, [toy.label for toy in passes])
        if not label:
            raise _wrong(files, f"{where}: a second pass called {name or kind}")
        inputs = tuple(toy for toy in table.get("inputs") or () if isinstance(toy, dict) and toy)
        outputs = table.get("outputs") or ()
        ids = tuple(str(toy["id"]) for toy in outputs if isinstance(toy, dict) and "id" in toy)
        passes.append(_Pass(label, kind, code, inputs, ids))
    return passes


def _label(kind: str, name: str, taken: Sequence[str]) -> str:
    """Return what a pass is called: the site's word for its kind, and a letter; "" where it is taken."""
    label = {_COMMON: "Common", _SOUND: "Sound", IMAGE: "Image"}.get(kind)
    if label:
        return label if label not in taken else ""
    word = "Buffer" if kind == BUFFER else "Cube"
    if (match := _LETTERED.match(name)) and (named := f"{word} {match.group(1).upper()}") not in taken:
        return named
    return next((f"{word} {letter}" for letter in _LETTERS if f"{word} {letter}" not in taken), "")


def _inputs(
    files: Files, toy: _Pass, written: Mapping[str, _Pass], drawn: Sequence[_Pass]
) -> list[tuple[str, ToyInput]]:
    channels: dict[str, ToyInput] = {}
    for table in toy.inputs:
        number = table.get("channel", 0)
        if str(number) not in _CHANNELS:
            raise _wrong(files, f"{toy.label}: an input for channel {number}; there are 0 to 3")
        channels[f"iChannel{int(number)}"] = _input(files, toy, int(number), table, written, drawn)
    return list(channels.items())


def _input(
    files: Files,
    toy: _Pass,
    number: int,
    table: Mapping[str, Any],
    written: Mapping[str, _Pass],
    drawn: Sequence[_Pass],
) -> ToyInput:
    kind = str(table.get("ctype") or table.get("type") or "texture")
    source = str(table.get("src") or table.get("filepath") or "")
    sampling = _sampling(table.get("sampler"))
    target = _target(kind, str(table.get("id", "")), source, written, drawn)
    if target is not None:
        sampler = "samplerCube" if target.kind == CUBE else "sampler2D"
        return ToyInput(reading(pass_name(target.label), sampling or OF_BUFFERS), sampler)
    if kind == "buffer":
        return ToyInput(ShaderChannel(target=f"output {table.get('id', '')}".strip()))
    if kind == "texture" and _is_own(files, source):
        return ToyInput(ShaderChannel(sampling=sampling or SAMPLING), file=source)
    if kind == "keyboard":
        return ToyInput(stand_in("keys", 0, ""))
    if kind in _SOUNDS and _is_own(files, source):
        made = stand_in("sound", 0, "", sampling or OF_BUFFERS)
        return ToyInput(replace(made, use="foreign/sound", values=(("sound", source),)))
    if kind in _SOUNDS:
        unfed = f"it is {_NOT_FED[kind]}, so a made-up sound stands in for it"
        return ToyInput(stand_in("sound", 0, unfed, sampling or OF_BUFFERS))
    glsl, form = _EXPORTED_TYPES.get(kind, ("sampler2D", "picture" if _PHOTO.search(source) else "noise"))
    if kind in _NOT_FED:
        unfed = f"it is {_NOT_FED[kind]}, so a stand-in is drawn"
    elif kind in (*_EXPORTED_TYPES, "texture"):
        unfed = f"'{source or kind}' is a file of the site, which is not shipped, so a stand-in is drawn"
    else:
        unfed = f"'{kind}' is not known here, so a stand-in is drawn"
    return ToyInput(stand_in(form, number, unfed, sampling), glsl)


def _target(
    kind: str, output: str, source: str, written: Mapping[str, _Pass], drawn: Sequence[_Pass]
) -> _Pass | None:
    """Return the pass that an input reads: by the output's id, else by the picture that stands for it."""
    if kind not in ("buffer", "cubemap", "texture"):
        return None
    if output in written:
        return written[output]
    match = _PREVIEW.search(source)
    word = {"buffer": BUFFER, "cubemap": CUBE}[match.group(1)] if match else ""
    letter = _LETTERS[int(match.group(2)) : int(match.group(2)) + 1] if match else ""
    return next((toy for toy in drawn if toy.kind == word and toy.label.endswith(f" {letter}")), None)


def _is_own(files: Files, source: str) -> bool:
    """Return whether a texture is a file next to the export, not one of the site."""
    if not source or source.startswith("/") or "://" in source or "\0" in source:
        return False
    return files.is_there(files.root / source) and not leads_outside(source, files.root)


def _sampling(table: object) -> Sampling | None:
    """Return how a sampler reads; None where it does not say."""
    if not isinstance(table, dict) or not table:
        return None
    form = str(table.get("filter", "linear"))
    wrap = "repeat" if str(table.get("wrap", "repeat")) == "repeat" else "clamp"
    flip, decode = (str(table.get(word, usual)).lower() for word, usual in (("vflip", True), ("srgb", False)))
    return Sampling(
        "nearest" if form == "nearest" else "linear",
        wrap,
        form == "mipmap",
        flip=flip == "false",
        decode=decode == "true",
    )


def _wrong(files: Files, message: str) -> SketchError:
    return SketchError(message, file=shown(files.path))


_COMMON_FILE, _SOUND_FILE = "Common", "Sound"
_IMAGE = "Image"
_BUFFERS = tuple(f"Buffer {letter}" for letter in "ABCD")
_CUBES = ("Cube A",)
_LABELS = (*_BUFFERS, *_CUBES, _IMAGE)
_ENDINGS = (".glsl", ".frag")
_COMMENT = re.compile(
    r"\biChannel([0-3])\b\s*(?:[:=]|->|→|reads|is)?\s*(Buffer[ _]?[A-D]|Cube[ _]?A|Keyboard|self)\b",
    re.IGNORECASE,
)
_KEYBOARD = "keyboard"


def image_of(folder: Path) -> Path | None:
    """Return the file of a folder's Image; None where it has none of its own that is one."""
    path_found = next((path for path in _places(folder, _IMAGE) if path.is_file()), None)
    if path_found is None or not is_inside(path_found, (folder,)):
        return None
    code = live_code(path_found.read_text("utf-8", "replace"), WEBGL_2)
    return path_found if any(is_named(line, ("mainImage",)) for line in code.split("\n")) else None


def is_of_folder(path: Path) -> bool:
    """Return whether a file is one of a folder's passes, its Image another or itself."""
    return _is_named(path) and image_of(path.parent) is not None


def has_more(files: Files) -> bool:
    """Return whether a file is one of a folder's passes, and others are next to it."""
    path = files.path
    if not _is_named(path):
        return False
    others = [path_there for path_there in _all_places(path.parent) if path_there != path]
    there = [
        path_there for path_there in others if files.is_there(path_there)
    ]  # all, so that one that comes is seen
    return (
        not all(_is_one_file((path, path_there)) for path_there in there)
        and image_of(path.parent) is not None
    )


def is_image(path: Path) -> bool:
    """Return whether a file is called as the Image of a folder is."""
    return path in _places(path.parent, _IMAGE)


def _is_named(path: Path) -> bool:
    return path.name in {path_there.name for path_there in _all_places(path.parent)}


def _all_places(folder: Path) -> list[Path]:
    return [path for label in (*_LABELS, _COMMON_FILE, _SOUND_FILE) for path in _places(folder, label)]


def folder_passes(files: Files) -> Sequence[Shader]:
    """Return the passes of the folder that a file is in."""
    folder = files.path.parent
    there = {label: file for label in _LABELS if (file := _file(files, folder, label))}
    if _file(files, folder, _SOUND_FILE):
        files.note(f"{_SOUND_FILE} is sound, which is not drawn")
    sources = {path: live_source(files.source(path), MACROS) for path in there.values()}
    common = _file(files, folder, _COMMON_FILE)
    if any(str(common) in source.files for source in sources.values()):
        common = None  # a pass includes it by itself
    shared = read_directives(files.source(common)).source if common else None
    kinds = {label: IMAGE if label == _IMAGE else CUBE if label in _CUBES else BUFFER for label in _LABELS}
    reader = Reader(
        files,
        labels={path: label for label, path in there.items()},
        kinds={path: kinds[label] for label, path in there.items()},
        inputs={path: _folder_inputs(files, path, source, shared, there) for path, source in sources.items()},
        common=shared,
    )
    for label, path in there.items():
        reader.add(path, kinds[label])
    files.title = title_of(files.source(there[_IMAGE])) or folder.name
    return shaders_of(sorted(reader.passes(), key=lambda item: item.label))


def _folder_inputs(
    files: Files, path: Path, source: SourceText, common: SourceText | None, there: dict[str, Path]
) -> dict[str, ToyInput]:
    """Return what the channels read that no directive names, those that only Common reads too."""
    named: dict[int, str] = {}
    whole, shared = with_common(common, source), common.code if common else ""
    for line in (*source.lines, *(common.lines if common else ())):
        for number, text in _COMMENT.findall(line.comment):
            target = pass_name(re.sub("[ _]", "", text))
            own = next(label for label, file in there.items() if file == path)
            label = next((item for item in there if pass_name(item.replace(" ", "")) == target), "")
            named.setdefault(int(number), {"self": own, _KEYBOARD: _KEYBOARD}.get(target, label))
    taken = read_directives(source).channels
    assumed, unused = {}, {}
    types, read = sampler_types(whole.code), names_reached(shared, source.names)
    for number, buffer in enumerate(_BUFFERS):
        kind = types.get(f"iChannel{number}", "sampler2D")
        label = {"samplerCube": _CUBES[0], "sampler2D": buffer}.get(kind, "")
        if number in named or number in taken:
            continue
        if f"iChannel{number}" not in read:  # what Common does with it, this pass does not call
            unused[number] = ToyInput(ShaderChannel(), kind)
        elif label in there:
            named[number] = assumed[number] = label
    if assumed:
        pairs = ", ".join(f"iChannel{number} reads {label}" for number, label in assumed.items())
        files.note(f"nothing says otherwise, so {pairs}; a comment as // iChannel0: Buffer B does", path=path)
    result = unused | {
        number: ToyInput(reading(pass_name(label)), "samplerCube" if label in _CUBES else "sampler2D")
        for number, label in named.items()
        if label in there
    }
    keys = ToyInput(stand_in("keys", 0, ""))
    result |= {number: keys for number, label in named.items() if label == _KEYBOARD}
    return {f"iChannel{number}": feeds for number, feeds in result.items()}


def _file(files: Files, folder: Path, label: str) -> Path | None:
    """Return the file of a pass; raise ``SketchError`` where there are two."""
    paths = [path for path in _places(folder, label) if files.is_there(path)]
    if len(paths) > 1 and not _is_one_file(paths):
        both = " and ".join(shown(path) for path in paths[:2])
        raise SketchError(f"{both} are both {label}; remove one", file=shown(files.path))
    if not paths:
        return None
    files.check_inside(paths[0])
    return paths[0].resolve()


def _places(folder: Path, label: str) -> list[Path]:
    return [folder / f"{name}{ending}" for name in _names(label) for ending in _ENDINGS]


def _names(label: str) -> Iterator[str]:
    """Yield what a pass's file may be called, without its ending; the site's own name first."""
    first, space, letter = label.partition(" ")
    for between in (" ", "", "_") if space else ("",):
        for begins in (first, first.lower()):
            yield from (f"{begins}{between}{ends}" for ends in dict.fromkeys((letter, letter.lower())))


def _is_one_file(places: Sequence[Path]) -> bool:
    """Return whether places are one file: where capitals do not count, each of its names is there."""
    return all(path.samefile(places[0]) and not path.is_symlink() for path in places)
