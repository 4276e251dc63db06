"""Shaders of other tools: their files, their passes, the kernel made of each pass, and their wiring.

What a dialect gives is a table: name → (type, meaning). A name that the text reads and does not
declare is declared before it; where the text declares one, its own type counts.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

from playground.allowed_files import is_file, is_inside, leads_outside
from playground.dialects.es import Rewritten, directives, version_of
from playground.errors import Diagnostic, ShaderError, SketchError, nearest
from playground.paths import GLSL, PART_OF_FILE, shown
from playground.shader.declarations import Declared, is_declared, takes, uniforms, vertex_outputs
from playground.shader.dialect import Read
from playground.shader.header import read_uniforms, title_of
from playground.shader.kernel import (
    SHAPES,
    Export,
    ForeignShader,
    Graph,
    Input,
    Kernel,
    Output,
    PassSpec,
    Technique,
    VertexShader,
)
from playground.shader.parameter import Parameter, Sampling
from playground.shader.reserved_names import ELEMENT
from playground.shader.source import Line, Origin, SourceText, normalised, read_source_and_origin, read_text
from playground.shader.syntax.tokens import as_written, is_named, tokenize
from playground.shader.widgets import Value, Widget

Names = Mapping[str, tuple[str, str]]
"""Name → GLSL type and meaning: a key of ``Runner``'s values; of a sampler "noise 0", "picture 3", "none"."""

STAND_INS = {
    "noise": "foreign/noise",
    "picture": "foreign/picture",
    "sky": "foreign/sky_box",
    "volume": "foreign/noise",
    "sound": "foreign/spectrum",
    "fft": "foreign/spectrum",
    "keys": "foreign/keys",
}
"""What is drawn where nothing feeds a channel: the first word of its meaning → a technique of ``glsl/``."""

STAND_INS_OF_SHAPES = {"cube": "sky", "volume": "volume"}
"""Likewise, by a channel's shape, where it has one of its own."""

SAMPLING = Sampling("linear", "repeat", mipmap=True)
STAND_IN_SIZE = ("256", "256")
SIZES = {
    "foreign/keys": ("256", "3"),
    "foreign/microphone": ("512", "2"),
    "foreign/sky_box": ("128", "768"),
    "foreign/sound": ("512", "2"),
    "foreign/spectrum": ("512", "2"),
}
"""Texels of techniques that feed a channel, where they are not ``STAND_IN_SIZE``."""

SIZES_OF_SHAPES = {"cube": ("64", "384"), "volume": ("32", "1024"), "line": ("256", "1")}
"""Texels of other techniques, by the channel's shape."""

_CLAMPED = Sampling("linear", "clamp")
_SAMPLINGS = {"sound": _CLAMPED, "fft": _CLAMPED, "keys": Sampling("nearest", "clamp")}
_STRENGTHS = {"fft": 0.01}  # Bonzomatic's shaders multiply what they hear, by 100 as a rule
_ALIKE = ("keys",)  # stand-ins that have no numbers


@dataclass(frozen=True)
class Rules:
    """What a dialect gives a shader."""

    name: str  # of its row
    names: Names
    declared_anywhere: bool = False  # a name declared in any function counts as declared
    epilogue: str = ""  # of shader/shaders
    varyings: tuple[str, ...] = ()  # declarations of what every text may take from its vertex shader
    helpers: tuple[str, ...] = ()  # of shader/shaders, between what is declared and the text
    vertex_helpers: tuple[str, ...] = ()  # likewise, of a vertex shader of the author's own
    defines: Callable[[SourceText], tuple[str, ...]] = lambda source: ()  # lines of the prelude


@dataclass(frozen=True)
class ShaderChannel:
    """What one sampler of a shader reads: a target, or a technique of ``glsl/``; neither: black."""

    target: str = ""  # of the same file: its latest write in this frame, else that of the frame before
    use: str = ""  # a technique, as "foreign/image"
    values: tuple[tuple[str, Value], ...] = ()  # of the technique
    size: tuple[str, str] = STAND_IN_SIZE  # [texels] likewise, expressions
    sampling: Sampling = SAMPLING
    unfed: str = ""  # what is drawn instead, where the technique is a stand-in: the end of a message


def stand_in(kind: str, number: int, unfed: str, sampling: Sampling | None = None) -> ShaderChannel:
    """Return a channel that a stand-in feeds; ``kind`` is a key of ``STAND_INS``."""
    size = SIZES.get(STAND_INS[kind]) or SIZES_OF_SHAPES.get(kind, STAND_IN_SIZE)
    values: tuple[tuple[str, Value], ...] = () if kind in _ALIKE else (("number", number),)
    if kind in _STRENGTHS:
        values = (*values, ("strength", _STRENGTHS[kind]))
    sampling = sampling or _SAMPLINGS.get(kind, SAMPLING)
    return ShaderChannel(use=STAND_INS[kind], values=values, size=size, sampling=sampling, unfed=unfed)


@dataclass(frozen=True)
class Shader:
    """One pass of another tool's file."""

    name: str  # of the pass, one of its own in the file
    text: Rewritten
    rules: Rules
    target: str = ""  # what others read its picture as; of two that write one, the later counts
    channels: Mapping[str, ShaderChannel] = field(
        default_factory=dict
    )  # by sampler; others depend on the rules
    parameters: tuple[Parameter, ...] = ()  # besides the uniforms that the text declares
    size: tuple[str, str] | None = None  # expressions; None: the size of the picture
    format: str = "rgba8"
    named: frozenset[str] = frozenset()  # names of the rules that the prelude names
    prelude: tuple[str, ...] = ()  # lines besides those that the rules give
    vertex: Rewritten | None = None  # the author's own vertex shader
    keeps: bool = False  # what it wrote in the last frame may be read
    repeat: str = ""  # an expression: it is drawn so often, and reads what it wrote before by ``feeds``
    feeds: str = ""  # a sampler


@dataclass(frozen=True)
class Made:
    """A pass that a technique of ``glsl/`` makes of what others wrote; its output is ``frame``."""

    name: str
    use: str
    reads: Mapping[str, str]  # input → target
    target: str = ""
    size: tuple[str, str] | None = None
    repeat: str = ""
    feeds: str = ""  # an input
    keeps: bool = True


_COMMENTED_FILE = re.compile(r"^\s*([^\s\"'<>|*?]+\.(?:png|jpe?g|webp|tiff?))\b", re.IGNORECASE)
_PICTURES = frozenset(f"u_tex{number}" for number in range(100))
_MAX_SAMPLERS = 16  # of an array of samplers: what a driver of OpenGL 3.3 may be limited to
_MODEL = "MODEL_"
_PACKS = 420  # the version of GLSL that has all of these
_PACKING = frozenset(f"{way}{kind}2x16" for way in ("pack", "unpack") for kind in ("Half", "Snorm", "Unorm"))
_SHADOW_MAP = "#define LIGHT_SHADOWMAP "
_STANDS_IN = "a stand-in is drawn; a sketch may wire an image to it"
_SOUNDS = "a made-up sound stands in; a sketch may wire foreign/sound to it"
_BANDS = "a made-up sound stands in"
_NO_PANEL = "it is 0, as no panel shows its type"
_NO_IMAGE = "it reads 0, and nothing stores what it writes"
_IMAGES = ("image", "iimage", "uimage")  # what begins a type


class ForeignKernel:
    """One shader's kernel, and what its samplers read; ``root`` is the folder that its files stay in."""

    def __init__(self, shader: Shader, root: Path) -> None:
        self.shader = shader
        self.source = shader.text.source
        self.code = self.source.code
        self.root = root
        self.declared = uniforms(self.code)
        self.vertex = shader.vertex.source if shader.vertex else None
        own = {**(uniforms(self.vertex.code) if self.vertex else {}), **self.declared}
        names = shader.rules.names.items()
        kept = {n: declared for n, declared in names if n not in own or takes(own[n].type, declared[0])}
        self.types = {n: own[n].type for n in kept if n in own}
        self.rules = replace(shader.rules, names=kept)
        self.missing = self._missing(self.source)
        self.vertex_missing = self._missing(self.vertex) if self.vertex else []
        self.commented = {(line.file, line.number): file for line, file in commented_files(self.source)}
        self.pictures = dict(self._pictures())
        self.shapes = {n: SHAPES[kind] for n, kind in self._kinds() if kind in SHAPES and self._is_read(n)}
        self.shapes |= {element: SHAPES[declared.type] for element, declared in self._elements()}
        self.channels = {name: self._channel(name) for name in self.shapes}

    def kernel(self, name: str) -> ForeignShader:
        """Return the kernel as a technique called ``name``."""
        shader, parameters = self.shader, self._parameters()
        own = {p.name for p in parameters}
        names = {*self.declared, *self.missing, *self.vertex_missing}
        meanings = [
            (n, f"identity{self.types.get(n, kind)[-1]}" if kind.startswith("mat") else meaning)
            for n, (kind, meaning) in self.rules.names.items()
            if n in names and n not in own and "sampler" not in kind
        ]
        vertex: VertexShader | tuple[tuple[str, str], ...]
        if shader.vertex and self.vertex:
            prelude = tuple(self._prelude(shader.vertex, self.vertex_missing))
            vertex = VertexShader(self.vertex, prelude, (*_packing(self.vertex), *self.rules.vertex_helpers))
        else:
            vertex = vertex_outputs("\n".join([*shader.text.prelude, *self._varyings(), self.code]))
        return ForeignShader(
            name,
            self.source,
            (Output("frame", shader.format),),
            parameters,
            tuple(
                Input(n, c.sampling, "zero" if c.target else "black", shape=self.shapes[n])
                for n, c in self.channels.items()
            ),
            title=title_of(self.source),
            dialect=self.rules.name,
            prelude=(*self._prelude(shader.text, self.missing), *self._varyings()),
            epilogue=self.rules.epilogue,
            helpers=(*_packing(self.source), *self.rules.helpers),
            vertex=vertex,
            tool_names=(
                *((n, m) for n, (_, m) in self.rules.names.items()),
                *((p.name, "") for p in shader.parameters),
                *((varying.rstrip(";").split()[-1], "") for varying in self.rules.varyings),
            ),
            usual=tuple(meanings),
            unfed=tuple(self._unfed(own)),
        )

    def _prelude(self, text: Rewritten, missing: Sequence[str]) -> Iterator[str]:
        """Yield the lines that come before a text: what is declared for it."""
        yield from (*text.prelude, *self.shader.prelude, *self.rules.defines(text.source))
        yield from (f"uniform {declaration(self.rules.names[name][0], name)};" for name in missing)
        declared = uniforms(text.source.code)
        yield from (f"uniform {p.type} {p.name};" for p in self.shader.parameters if p.name not in declared)

    def _varyings(self) -> list[str]:
        """Return the dialect's own that a text reads and does not declare itself."""
        declarations = [declaration for declaration, _ in vertex_outputs(self.code)]
        return [
            varying
            for varying in self.rules.varyings
            if varying.replace("in ", "out ", 1) not in declarations
        ]

    def _channel(self, sampler: str) -> ShaderChannel:
        """Return what feeds a sampler; by the rules where the shader does not say."""
        if sampler in self.shader.channels:
            return self.shader.channels[sampler]
        kind, _, number = self.rules.names.get(sampler, ("", ""))[1].partition(" ")
        if kind not in STAND_INS:
            return ShaderChannel()
        file = self._commented(self.declared[sampler]) if sampler in self.declared else ""
        unfed = f"there is no file '{file}', so a stand-in is drawn" if file else _STANDS_IN
        unfed = _SOUNDS if kind in ("sound", "fft") else unfed
        kind = STAND_INS_OF_SHAPES.get(self.shapes[sampler], kind)
        return stand_in(kind, int(number), unfed)

    def _missing(self, source: SourceText) -> list[str]:
        """Return the names of the dialect that a text reads and does not declare."""
        code, declared = source.code, uniforms(source.code)
        tokens = list(as_written(code))
        read = {now.text for before, now in pairwise([*tokens[:1], *tokens]) if before.text != "."}
        anywhere = self.rules.declared_anywhere
        return [
            name
            for name in self.rules.names
            if name not in declared
            and (name in self.shader.named or name in read)
            and not is_declared(code, name, anywhere=anywhere)
        ]

    def _is_read(self, name: str) -> bool:
        """Return whether a text names a sampler besides declaring it."""
        return name in self.missing or name in self.vertex_missing or self.source.counts[name] > 1

    def _kinds(self) -> Iterator[tuple[str, str]]:
        """Yield each sampler that a wire may feed, with its type."""
        for name in dict.fromkeys([*self.missing, *self.vertex_missing]):
            yield name, self.rules.names[name][0]
        files = {p.name for p in self.shader.parameters}
        for declared in self.declared.values():
            if (
                not declared.is_array
                and declared.name not in self.pictures
                and declared.name not in files
                and not self._line(declared).comment.startswith("!")
            ):
                yield declared.name, declared.type

    def _elements(self) -> Iterator[tuple[str, Declared]]:
        """Yield what a wire feeds of the arrays of samplers: ``maps_0`` is the first of ``maps[4]``."""
        for declared in self.declared.values():
            texts = [token.text for token in tokenize(declared.written)[0]]
            if declared.type in SHAPES and texts[1:2] == ["["] and self._is_read(declared.name):
                count = int(texts[2][:9]) if texts[3:4] == ["]"] and texts[2].isdecimal() else 0
                numbers = range(min(count, _MAX_SAMPLERS))
                elements = (f"{declared.name}{ELEMENT}{number}" for number in numbers)
                yield from ((element, declared) for element in elements if element not in self.source.names)

    def _line(self, declared: Declared) -> Line:
        return self.source.lines[declared.line]

    # ── parameters ───────────────────────────────────────────────────────────

    def _parameters(self) -> tuple[Parameter, ...]:
        """Return the text's own uniforms; one that no panel can show keeps what the text gives it."""
        parameters: dict[str, Parameter] = {}
        for declared in self.declared.values():
            line = self._line(declared)
            line = replace(line, code=f"uniform {declared.type} {' '.join(declared.written.split())};")
            annotated = line.comment.startswith("!")  # in our own way, so that a parameter is meant
            skip = () if annotated else self.rules.names.keys()
            try:
                some, _ = read_uniforms(replace(self.source, lines=(line,)), plain=True, skip=skip)
            except ShaderError:
                if annotated:
                    raise
                continue
            parameters |= {parameter.name: parameter for parameter in some}
        parameters |= {parameter.name: parameter for parameter in self.shader.parameters}
        return (*parameters.values(), *self.pictures.values())

    def _pictures(self) -> Iterator[tuple[str, Parameter]]:
        """Yield the samplers whose comment names a file that is there."""
        for declared in self.declared.values():
            line, file = self._line(declared), self._commented(declared)
            if file and self._is_there(file, line):
                yield declared.name, picture_parameter(declared.name, file, SAMPLING, line)

    def _commented(self, declared: Declared) -> str:
        line = self._line(declared)
        return self.commented.get((line.file, line.number), "") if declared.type == "sampler2D" else ""

    def _is_there(self, file: str, line: Line) -> bool:
        there = any(is_file(path) for path in places_of(file, line, self.root))
        return there and not leads_outside(file, self.root, line.file)

    def _unfed(self, fed: Collection[str]) -> Iterator[tuple[str, str]]:
        """Yield what the picture lacks where nothing is wired: each name, and what is drawn instead."""
        arrays = {declared.name for _, declared in self._elements()}
        own = {
            declared.name: declared.type for declared in self.declared.values() if declared.name not in arrays
        }
        for element, _ in self._elements():
            yield element, "it reads black"
        own |= {name: self.rules.names[name][0] for name in (*self.missing, *self.vertex_missing)}
        for name, kind in own.items():
            channel = self.channels.get(name, ShaderChannel())
            if channel.unfed:
                yield name, channel.unfed
            elif self.rules.names.get(name, ("", ""))[1] == "bands":
                yield name, _BANDS
            elif name in fed or name in self.shader.channels:  # where that is black, the tool has it so
                continue
            elif "sampler" in kind and channel == ShaderChannel() and self._is_read(name):
                yield name, "it reads black"
        yield from self._unset(fed)
        if any(line.startswith(_SHADOW_MAP) for line in self.rules.defines(self.source)):
            yield "LIGHT_SHADOWMAP", "it reads black"
        for name in sorted(self.source.names):
            if name.startswith(_MODEL):
                yield name, "there is no mesh here, so it is drawn flat"

    def _unset(self, fed: Collection[str]) -> Iterator[tuple[str, str]]:
        """Yield the uniforms that are no parameters, are given by nobody and have no value in the text."""
        for declared in self.declared.values():
            is_given = declared.name in fed or declared.name in self.rules.names or "sampler" in declared.type
            if not is_given and "=" not in declared.written and self._is_read(declared.name):
                yield declared.name, _NO_IMAGE if declared.type.startswith(_IMAGES) else _NO_PANEL


def unfed_warnings(kernel: ForeignShader, wired: Collection[str]) -> tuple[Diagnostic, ...]:
    """Return a warning for each thing that another tool's shader lacks; ``wired`` are inputs that are fed."""
    names: dict[str, list[str]] = {}
    for name, instead in kernel.unfed:
        if name not in wired:
            names.setdefault(instead, []).append(name)
    diagnostics = []
    for instead, some in names.items():
        either = (*some, *(name.rpartition(ELEMENT)[0] or name for name in some))
        line = kernel.source.line_naming(*either) or kernel.source.lines[0]
        diagnostics.append(line.diagnostic(f"nothing feeds {', '.join(some)}: {instead}", severity="warning"))
    return tuple(diagnostics)


def commented_files(source: SourceText) -> Iterator[tuple[Line, str]]:
    """Yield each line that declares ``u_tex0`` or its like with a file in its comment, and the file."""
    for line in source.lines:
        is_picture = line.comment and is_named(line.code, ("uniform",)) and is_named(line.code, _PICTURES)
        if is_picture and (match := _COMMENTED_FILE.match(line.comment)):
            yield line, match.group(1)


def picture_parameter(name: str, path: str, sampling: Sampling, line: Line) -> Parameter:
    """Return the parameter of a sampler that reads an image file; ``line`` is what says so."""
    widget = Widget("file")
    return Parameter(name, "sampler2D", path, widget, sampling=sampling, file=line.file, line=line.number)


def places_of(file: str, line: Line, root: Path) -> tuple[Path, ...]:
    """Return where a file is looked for that a line names."""
    return tuple(dict.fromkeys((root / file, Path(line.file).parent / file)))


def _packing(source: SourceText) -> tuple[str, ...]:
    """Return what packs numbers for a text that does so in a version of GLSL without such functions."""
    used = _PACKING & source.names
    used -= {name for words in directives(source) if used and words[0] == "define" for name in words[1:2]}
    packs = [name for name in used if not is_declared(source.code, name, anywhere=False)]
    return ("packing.glsl",) if packs and version_of(source) < _PACKS else ()


def declaration(kind: str, name: str) -> str:
    """Return "vec3 name[4]" for vec3[4]."""
    base, bracket, count = kind.partition("[")
    return f"{base} {name}{bracket}{count}"


@dataclass
class Files:
    """The files of one shader, inside ``root``.

    ``instead`` has texts, by absolute path, in place of files'; ``named``: a user has named the dialect.
    """

    path: Path
    root: Path
    instead: Mapping[str, str] = field(default_factory=dict)
    named: bool = False
    title: str = ""  # that the other tool gives it
    notes: list[Diagnostic] = field(default_factory=list)  # of what is not as in the other tool
    _origins: list[Origin] = field(default_factory=list)
    _texts: dict[str, str] = field(default_factory=dict)
    _there: dict[Path, bool] = field(default_factory=dict)

    def text(self, path: Path | None = None) -> str:
        """Return a file's text, by default the shader's; raise ``SketchError`` where it cannot be read."""
        path = path or self.path
        entry = self.instead.get(str(path))
        entry = read_text(path, any_encoding=True) if entry is None else entry
        self._texts[str(path)] = entry
        return entry

    def check_inside(self, path: Path) -> None:
        """Raise ``SketchError`` for a file that leads out of the root; a user may name such a shader."""
        if path != self.path and not is_inside(path, (self.root,)):
            message = f"this leads outside the shader's own folder, {shown(self.root)}, and is not read"
            raise SketchError(message, file=shown(path))

    def source(self, path: Path | None = None) -> SourceText:
        """Return a file with its includes, by default the shader's; raise as ``read_source`` does."""
        self.check_inside(path or self.path)
        source, origin = read_source_and_origin(path or self.path, (self.root,), self.instead, foreign=True)
        self._origins.append(origin)
        for line, file in commented_files(source):
            for path in places_of(file, line, self.root):
                self.is_there(path)
        return source

    def part(self, label: str, text: str) -> SourceText:
        """Return a text that is a part of the file: its lines are those of "file:label", from 1."""
        named = self.path.with_name(f"{self.path.name}{PART_OF_FILE}{label}")
        instead = {**self.instead, str(named): normalised(text)}
        source, origin = read_source_and_origin(named, (self.root,), instead, foreign=True)
        self._origins.append(Origin(tuple(t for t in origin.texts if t[0] != str(named)), origin.places))
        files = (str(self.path), *(name for name in source.files if name != str(named)))
        return SourceText(str(self.path), source.lines, files)

    def note(self, message: str, line: int = 0, path: Path | None = None) -> None:
        """Note what a user is notified of the file, at one of its lines."""
        self._note(Diagnostic(message, shown(path or self.path), line, severity="warning"))

    def note_at(self, line: Line, message: str) -> None:
        """Note what a user is notified of a line."""
        self._note(line.diagnostic(message, severity="warning"))

    def _note(self, diagnostic: Diagnostic) -> None:
        if diagnostic not in self.notes:
            self.notes.append(diagnostic)

    def is_there(self, path: Path) -> bool:
        """Return whether there is a file at a place, in the folder or not."""
        exists = self._there[path] = str(path) in self.instead or is_file(path)
        return exists

    def hold(self) -> bool:
        """Return whether all that was read and looked for is still the same."""
        return (
            all(is_file(path) == there for path, there in self._there.items())
            and Origin(tuple(self._texts.items()), ()).holds()
            and all(origin.holds() for origin in self._origins)
        )


# ── wiring ───────────────────────────────────────────────────────────────────
#
# The last pass of a technique is ``view``: the shader itself, or a technique of several shaders where
# there are more. Before it come the passes that feed its channels, each named like its channel, so that
# what a user wires to the channel takes its place. Where a shader reads what it or a later one writes,
# that is what was written in the frame before, and the whole of ``view`` is a loop over the frames.

VIEW = "view"
_BEFORE = "before_"  # begins the input that has a target's content of the frame before
_MAX_NAMED = 3  # passes in one message
_FRAMES = "frames"


def graph_of_shaders(name: str, shaders: Sequence[Shader | Made], read: Read, root: Path) -> Graph:
    """Return a technique called ``name``, whose picture is that of the last of its shaders.

    Its channels are inputs, and its shaders' own uniforms parameters: one for those of the same name.
    ``root`` is the folder that its files stay in. Raises ``ShaderError`` for a sampler of a target that
    no shader writes.
    """
    return _Passes(name, shaders, read, root).graph()


class _Passes:
    """The shaders of one file, as kernels, and what wires them."""

    def __init__(self, name: str, shaders: Sequence[Shader | Made], read: Read, root: Path) -> None:
        self.name = name
        self.shaders = shaders
        self.read = read  # returns what feeds a channel, and what makes a pass
        self.techniques: list[Technique] = []
        self.channels: list[Mapping[str, ShaderChannel]] = []
        for shader in shaders:
            if isinstance(shader, Made):
                self.techniques.append(read(shader.use, GLSL, GLSL))
                self.channels.append({name: ShaderChannel(target) for name, target in shader.reads.items()})
            else:
                foreign = ForeignKernel(shader, root)
                self.techniques.append(foreign.kernel(name))
                self.channels.append(foreign.channels)
        self._drop_unread()
        self.kernels = [kernel for kernel in self.techniques if isinstance(kernel, ForeignShader)]
        # Of each shader: samplers, and the passes of this frame that they read.
        self.wires: list[list[tuple[str, str]]] = [[] for _ in shaders]
        self.state: dict[str, list[str]] = {}  # target → the samplers that read it as it was, as paths
        for index, channels in enumerate(self.channels):
            for sampler, channel in channels.items():
                if channel.target:
                    self._wire(index, sampler, channel.target)
        self.inputs = dict(self._inputs())

    def _unread(self) -> Iterator[Diagnostic]:
        """Yield a warning that names the passes which the picture does not depend on: they are not drawn."""
        last = {shader.target: shader.name for shader in self.shaders}
        reads: dict[str, set[str]] = {shader.name: set() for shader in self.shaders}
        for shader, wires in zip(self.shaders, self.wires, strict=True):
            reads[shader.name] |= {name for _, name in wires}
        for target, paths in self.state.items():
            for path in paths:
                reads[path.partition(".")[0]].add(last[target])
        reached, read_names = set[str](), {self.shaders[-1].name}
        while read_names:
            reached |= read_names
            read_names = set().union(*[reads[name] for name in read_names]) - reached
        left = [shader.name for shader in self.shaders if shader.name not in reached]
        if left:
            more = f" and {len(left) - _MAX_NAMED} more" if len(left) > _MAX_NAMED else ""
            names = f"{', '.join(left[:_MAX_NAMED])}{more}"
            message = f"the picture reads nothing of {names}: what the picture does not need is not drawn"
            yield self.kernels[-1].source.lines[0].diagnostic(message, severity="warning")

    def _drop_unread(self) -> None:
        """Drop the parameters that a pass declares and only other passes read."""
        kernels = [technique for technique in self.techniques if isinstance(technique, ForeignShader)]
        reads = {id(kernel): _names_read(kernel) for kernel in kernels}
        declared = {p.name for kernel in kernels for p in kernel.parameters}
        anywhere = set().union(*reads.values())
        anywhere |= {name for kernel in kernels for name in declared if kernel.source.counts[name] > 1}
        for index, technique in enumerate(self.techniques):
            if isinstance(technique, ForeignShader):
                kept = [
                    p
                    for p in technique.parameters
                    if p.name in reads[id(technique)] or p.name not in anywhere
                ]
                if len(kept) < len(technique.parameters):
                    self.techniques[index] = replace(technique, parameters=tuple(kept))

    def _wire(self, index: int, sampler: str, target: str) -> None:
        writers = [i for i, shader in enumerate(self.shaders) if shader.target == target]
        if not writers:
            raise self._unwritten(index, sampler, target)
        earlier = [i for i in writers if i < index]
        if earlier:
            self.wires[index].append((sampler, self.shaders[earlier[-1]].name))
        elif self.shaders[writers[-1]].keeps:
            self.state.setdefault(target, []).append(f"{self.shaders[index].name}.{sampler}")

    def _unwritten(self, index: int, sampler: str, target: str) -> ShaderError:
        made = self.techniques[index]
        source = (made if isinstance(made, Kernel) else self.kernels[-1]).source
        line = source.line_naming(sampler) or source.lines[0]
        hint = nearest(target, [shader.target for shader in self.shaders if shader.target])
        return line.error(f"{sampler} reads '{target}', which no pass writes{hint}")

    def _inputs(self) -> Iterator[tuple[str, tuple[ShaderChannel, list[str]]]]:
        """Yield what may be wired from outside: a name, what feeds it, the samplers that read it, as paths.

        Samplers of one name that are fed alike are one input.
        """
        channels_by_pass: dict[str, list[tuple[str, ShaderChannel]]] = {}
        for shader, channels in zip(self.shaders, self.channels, strict=True):
            for sampler, channel in channels.items():
                if not channel.target:
                    channels_by_pass.setdefault(sampler, []).append((shader.name, channel))
        for sampler, readers in channels_by_pass.items():
            if all(channel == readers[0][1] for _, channel in readers):
                yield sampler, (readers[0][1], [f"{shader}.{sampler}" for shader, _ in readers])
                continue
            for shader_name, channel in readers:
                yield _own_name(shader_name, sampler), (channel, [f"{shader_name}.{sampler}"])

    def graph(self) -> Graph:
        """Return the whole."""
        view = self._view()
        passes = [
            PassSpec(name, c.use, self.read(c.use, GLSL, GLSL), values=c.values, size=c.size)
            for name, (c, _) in self.inputs.items()
            if c.use
        ]
        return Graph(
            self.name,
            self.kernels[-1].path,
            (*passes, view),
            parameters=tuple(_inside(VIEW, parameter.name) for parameter in view.technique.parameters),
            inputs=tuple(_inside(VIEW, name) for name in self.inputs),
            title=next((kernel.title for kernel in self.kernels if kernel.title), ""),
            warnings=tuple(self._unread()),
        )

    def _view(self) -> PassSpec:
        path = self.kernels[-1].path
        use, file = f"./{Path(path).stem}", shown(path)
        if len(self.shaders) == 1 and not self.state:
            return PassSpec(VIEW, use, self.kernels[0], size=self.shaders[0].size, file=file)
        passes = tuple(
            PassSpec(
                shader.name,
                shader.use if isinstance(shader, Made) else use,
                technique,
                inputs=tuple(wires),
                size=shader.size,
                repeat=shader.repeat,
                feedback=((shader.feeds, "frame"),) if shader.feeds else (),
                file=file,
            )
            for shader, technique, wires in zip(self.shaders, self.techniques, self.wires, strict=True)
        )
        last = {shader.target: shader.name for shader in self.shaders}
        inputs = [Export(name, tuple(readers)) for name, (_, readers) in self.inputs.items()]
        inputs += [Export(f"{_BEFORE}{target}", tuple(readers)) for target, readers in self.state.items()]
        several = Graph(
            self.name,
            path,
            passes,
            parameters=tuple(self._parameters()),
            inputs=tuple(inputs),
            outputs=(
                ("frame", f"{passes[-1].name}:frame"),
                *((target, f"{last[target]}:frame") for target in self.state),
            ),
        )
        feedback = tuple((f"{_BEFORE}{target}", target) for target in self.state)
        return PassSpec(VIEW, use, several, repeat=_FRAMES if feedback else "", feedback=feedback, file=file)

    def _parameters(self) -> Iterator[Export]:
        """Yield one parameter for those of one name and type; where types differ, one for each shader.

        Two that name different files differ as well.
        """
        parameters_by_pass: dict[str, list[tuple[str, object]]] = {}
        for shader, technique in zip(self.shaders, self.techniques, strict=True):
            if isinstance(shader, Made) or not isinstance(technique, Kernel):
                continue
            for p in technique.parameters:
                kind = (p.type, p.default) if p.widget.kind == "file" else p.type
                parameters_by_pass.setdefault(p.name, []).append((shader.name, kind))
        for name, owners in parameters_by_pass.items():
            if len({kind for _, kind in owners}) == 1:
                yield Export(name, tuple(f"{owner}.{name}" for owner, _ in owners))
            else:
                yield from (Export(_own_name(owner, name), (f"{owner}.{name}",)) for owner, _ in owners)


def _names_read(kernel: ForeignShader) -> set[str]:
    """Return the parameters that a text names besides declaring them."""
    return {p.name for p in kernel.parameters if kernel.source.counts[p.name] > 1 or kernel.vertex_source}


def stand_in_paths(path: str, sampler: str) -> set[str]:
    """Return the paths that a channel's own stand-in may have; ``path`` is that of the shader's pass."""
    around, _, name = path.rpartition(".")
    outer = around.rpartition(".")[0]
    inside = {(around, sampler), (outer, sampler), (outer, _own_name(name, sampler))}
    return {f"{where}.{called}" if where else called for where, called in inside}


def _own_name(shader: str, name: str) -> str:
    """Return the name of one shader's channel or parameter where another shader's is not the same."""
    return f"{shader}_{name}"


def _inside(where: str, name: str) -> Export:
    return Export(name, (f"{where}.{name}",))
