"""What a pass runs: one class for each kind of GLSL file, and the options that its pragma takes.

A field with a row (``_option``, ``_expression``, ``_choice``) is an option of the pragma. That row is all
that the header reader, cache keys, page writer, language server and README know of it: a new option is a row
and the code that executes it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from operator import attrgetter
from typing import Any, ClassVar

from playground.errors import ShaderError, nearest
from playground.shader import expressions
from playground.shader.expressions import CLOCKS, COUNTERS, ExpressionError
from playground.shader.kernel import Bound, read_agreement
from playground.shader.parameter import AS_IT_IS, Parameter, Sampling
from playground.shader.reserved_names import GIVEN, OF_THE_TERRAIN, PLAIN_UNIFORMS
from playground.shader.source import Line, SourceText

FORMATS: tuple[str, ...] = tuple(f"{c}{d}" for c in ("r", "rg", "rgba") for d in ("8", "16", "16f", "32f"))
"""Formats of textures."""

SHAPES = {
    "sampler2D": "",
    "samplerCube": "cube",
    "sampler3D": "volume",
    "sampler2DArray": "layers",
    "sampler1D": "line",
}
"""GLSL type of a sampler → the shape of what it reads."""

SIZE = ("size.x", "size.y")
_IDENTIFIER = re.compile(r"[A-Za-z_]\w*")
_SOURCE_READS = ("time", "keys", "microphone", "camera", *OF_THE_TERRAIN)
_BUFFER_TYPES = ("float", "int", "uint", "vec2", "vec4", "ivec2", "ivec4", "uvec2", "uvec4")


@dataclass(frozen=True, slots=True)
class Input:
    """A texture that a kernel reads."""

    name: str
    sampling: Sampling = AS_IT_IS
    fallback: str = ""  # "white", "black", "zero": what it reads when nothing is wired; "": must be wired
    line: int = 0
    shape: str = ""  # of another tool's shader: a value of ``SHAPES``; "": two dimensions


@dataclass(frozen=True, slots=True)
class Output:
    """A texture that a kernel writes."""

    name: str
    format: str  # one of ``FORMATS``

    @property
    def components(self) -> int:
        """Channels of a texel."""
        return 4 if self.format.startswith("rgba") else 2 if self.format.startswith("rg") else 1

    @property
    def glsl(self) -> str:
        """The GLSL type of a texel."""
        return {1: "float", 2: "vec2", 4: "vec4"}[self.components]


@dataclass(frozen=True, slots=True)
class Buffer:
    """A storage buffer of a compute variant."""

    name: str
    type: str  # GLSL scalar or vec4
    count: str  # expression


# ── the table of options ─────────────────────────────────────────────────────


@dataclass(frozen=True, slots=True)
class Scope:
    """What the options of a file may name."""

    numbers: tuple[str, ...]  # parameters that are one number
    inputs: tuple[str, ...]


@dataclass(frozen=True)
class Option:
    """One option of a pragma."""

    help: str  # Markdown
    default: Any = ""
    # Its name, its text and what that may name → its value; raises ``ValueError`` in a sentence.
    parse: Callable[[str, str, Scope], Any] = lambda name, text, scope: text
    # The kernel with all its options → what is wrong with this one; "" for nothing.
    check: Callable[[Any], str] = lambda kernel: ""
    excludes: tuple[str, ...] = ()  # options that may not stand beside it
    choices: tuple[str, ...] = ()  # what it may be, where that is one of a few; for completion
    # Its value → its expressions, which may use the names of ``where``; None: it has none.
    expressions: Callable[[Any], tuple[str, ...]] | None = None
    required: str = ""  # what a pragma without it lacks
    positional: bool = False  # it may stand first, without its name
    keyed: bool = True  # the textures depend on it, beyond what a step's size and repeat say
    compared: bool = True  # part of what a fast variant was verified against
    page: str = ""  # its name in a page's data; "": pages have no use for it
    name: str = ""
    attribute: str = ""  # path of the kernel's field; "": the header reader replaces it by what it means

    def of(self, kernel: Kernel) -> Any:
        """Return its value in a kernel."""
        return attrgetter(self.attribute)(kernel)

    @property
    def about(self) -> str:
        """What it says, with its choices and its default, as Markdown."""
        choices = f": {', '.join(f'`{one}`' for one in self.choices)}" if self.choices else ""
        default = ", ".join(map(str, self.default)) if isinstance(self.default, tuple) else self.default
        return f"{self.help}{choices}{f' (`{default}`)' if default not in ('', 0) else ''}"


def _option(help: str, default: Any = "", **more: Any) -> Any:
    return field(default=default, metadata={"option": Option(help, default, **more)})


def _expression(
    help: str,
    default: str = "",
    *,
    names: tuple[str, ...] = (),
    of_inputs: tuple[str, ...] = (),
    count: int = 1,
    **more: Any,
) -> Any:
    """Declare an option with ``count`` expressions of sizes, parameters, ``names``, and parts of inputs."""

    def parse(name: str, text: str, scope: Scope) -> str:
        known = (
            *SIZE,
            *names,
            *scope.numbers,
            *(f"{one}{part}" for one in scope.inputs for part in of_inputs),
        )
        check_expression(name, text, known, count)
        if expressions.counts_frames(text) and "frames" in names and "frames" in scope.numbers:
            raise ValueError(f"{name} '{text}': 'frames' {expressions.TWO_FRAMES}")
        return text

    return _option(help, default, parse=parse, expressions=lambda text: (text,), **more)


def check_expression(name: str, text: str, known: tuple[str, ...], count: int = 1) -> None:
    """Raise ``ValueError`` for an expression that is none, or names something else than what is known."""
    try:
        expressions.check(text, known, count=count)
    except ExpressionError as error:
        raise ValueError(f"{name}: {error}") from None


def _choice(help: str, default: str, choices: tuple[str, ...], **more: Any) -> Any:
    def parse(name: str, text: str, scope: Scope) -> str:
        if text not in choices:
            hint = nearest(text, choices).replace("; there are", ": expected one of")
            raise ValueError(f'{name} = "{text}"{hint}')
        return text

    return _option(help, default, parse=parse, choices=choices, **more)


def _accepts(name: str, text: str, scope: Scope) -> str:
    try:
        expressions.accepted_sizes(text)
    except ExpressionError as error:
        raise ValueError(f'{name}: {error}; as accepts = "2**n + 1"') from None
    return text


def _warnings(name: str, text: str, scope: Scope) -> tuple[tuple[str, str], ...]:
    found: list[tuple[str, str]] = []
    for part in _parts(text, ";"):
        condition, colon, message = (piece.strip() for piece in part.partition(":"))
        if not colon or not message:
            example = "frequency <= tiles: no detail is left (several are separated by ;)"
            raise ValueError(f"{name} '{part}': expected condition: message, as {example}")
        check_expression(name, condition, (*SIZE, *scope.numbers))
        found.append((condition, " ".join(message.split())))
    return tuple(found)


def _reads(name: str, text: str, scope: Scope) -> tuple[str, ...]:
    found = _parts(text, ",")
    for one in found:
        if one not in _SOURCE_READS:
            raise ValueError(f"{name} = '{text}': a source cannot read '{one}'{nearest(one, _SOURCE_READS)}")
    return found


def _samples(name: str, text: str, scope: Scope) -> int:
    if text not in ("0", "1"):
        raise ValueError(f"{name} = {text}: expected 1, or 0 for as many as the view has")
    return int(text)


def _input(name: str, text: str, scope: Scope) -> str:
    if text not in scope.inputs:
        raise ValueError(f"{name}: there is no input '{text}'{nearest(text, scope.inputs)}")
    return text


def _local(name: str, text: str, scope: Scope) -> tuple[int, int]:
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 2 or not all(re.fullmatch(r"[1-9][0-9]{0,4}", part) for part in parts):
        raise ValueError(f'{name} = "{text}": expected two whole numbers, as "256, 1"')
    return int(parts[0]), int(parts[1])


def _buffers(name: str, text: str, scope: Scope) -> tuple[Buffer, ...]:
    found: list[Buffer] = []
    for part in _parts(text, ";"):
        pieces = [piece.strip() for piece in part.split(":", 2)]
        if len(pieces) != 3 or not re.fullmatch(r"[A-Za-z_]\w*", pieces[0], re.ASCII):
            example = "stack:vec4:size.x * 64 (several separated by ;)"
            raise ValueError(f"buffer '{part}': expected name:type:count, as {example}")
        if pieces[1] not in _BUFFER_TYPES:
            hint = nearest(pieces[1], _BUFFER_TYPES)
            raise ValueError(f"buffer '{pieces[0]}' has no type '{pieces[1]}'{hint}")
        check_expression(f"buffer '{pieces[0]}'", pieces[2], (*SIZE, *scope.numbers))
        found.append(Buffer(*pieces))
    return tuple(found)


def _stages(name: str, text: str, scope: Scope) -> tuple[int, ...]:
    parts = _parts(text, ",")
    if not all(re.fullmatch(r"[0-9]{1,4}", part, re.ASCII) for part in parts):
        raise ValueError(f'{name} = "{text}": expected whole numbers separated by commas')
    return tuple(map(int, parts))


def _aligned(name: str, text: str, scope: Scope) -> int:
    if text not in ("4", "8", "16", "32"):
        raise ValueError(f'{name} = "{text}": expected 4, 8, 16 or 32, the bytes that rows are filled up to')
    return int(text)


def _agrees(name: str, text: str, scope: Scope) -> tuple[Bound, ...]:
    try:
        return read_agreement(text)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


def _parts(text: str, separator: str) -> tuple[str, ...]:
    return tuple(filter(None, (part.strip() for part in text.split(separator))))


def _check_at_once(kernel: TexelKernel) -> str:
    if kernel.repeat == "1":
        return "at_once counts steps, but the kernel has one step only; give it a repeat"
    if not kernel.reads("until"):
        return "at_once: the kernel must do the steps from iteration up to until, but never names until"
    return ""


def _check_until(kernel: TexelKernel) -> str:
    """Say why two steps may make different things of one state: then an unchanged state may still change."""
    if kernel.repeat == "1":
        return "until says when a repeat may end, but the kernel has one step only; give it a repeat"
    for name in (*COUNTERS, "until", "time"):
        if kernel.reads(name):
            return f"until: the text names '{name}', so after a step that changes nothing another may"
    return ""


def _check_active(kernel: ComputeVariant) -> str:
    if kernel.repeat == "1":
        return "active says when a repeat may end; give the compute variant a repeat"
    return kernel.storage.lacks("active", kernel.storage.active)


def _check_in_place(kernel: ComputeVariant) -> str:
    lacking = kernel.storage.lacks("in_place", kernel.storage.in_place)
    return lacking or ("" if kernel.inputs else "in_place: there is no input that the buffer could begin as")


# ── the kinds ────────────────────────────────────────────────────────────────

WHERE = Option(
    'names for expressions, as `"rows = size.y + 1; cells = size.x * rows"`; each may use those before it',
    name="where",
)
OUTPUT = Option(
    'the textures that it writes, as `"height:r32f, water:rgba32f"`; formats are `r`, `rg` or `rgba` with '
    "`8`, `16`, `16f` or `32f`",
    required='output = "name:format", as output = "height:r32f"',
    name="output",
)
_REPEAT = "how often it runs, each time on what it gave before"
_ACCEPTS = "the sizes that it takes, as `2**n + 1`, `2**n or 2**n + 1` or `n up to 4097`"


@dataclass(frozen=True)
class Kernel:
    """One GLSL file that a pass can run; the base of all kinds."""

    name: str  # "generation/diamond_square"
    source: SourceText
    outputs: tuple[Output, ...]
    parameters: tuple[Parameter, ...] = ()
    inputs: tuple[Input, ...] = ()
    title: str = ""  # the sentence that the file begins with
    variants: tuple[Any, ...] = ()  # its fast variants, of class ``Variant``, the fastest first

    kind: ClassVar[str]  # its pragma, or what a plain shader is
    example: ClassVar[str] = ""  # of the options of its pragma
    replaced: ClassVar[tuple[Option, ...]] = ()  # options that the header reader replaces by what they mean

    @property
    def repeat(self) -> str:
        """How often it runs: an expression."""
        return "1"

    @property
    def accepts(self) -> str:
        """The sizes that it takes: see ``expressions.accepted_sizes``; "": all."""
        return ""

    @property
    def registry(self) -> str:
        """Name of a source, a row of ``terrain.sources``; "" for all other kinds."""
        return ""

    @property
    def counts(self) -> tuple[str, ...]:
        """The expressions that a plan evaluates."""
        return (self.repeat,)

    @property
    def ends_early(self) -> bool:
        """Whether its repeat may end before its last step."""
        return False

    @property
    def depends(self) -> tuple[str, ...]:
        """What its texels depend on besides its parameters and what its text names, as time."""
        return ()

    @property
    def usual(self) -> tuple[tuple[str, str], ...]:
        """Uniforms of a plain shader that it is given, with what they mean to ``Runner``."""
        return ()

    @property
    def path(self) -> str:
        """Absolute path of the file."""
        return self.source.path

    @property
    def files(self) -> tuple[str, ...]:
        """Absolute paths of every file the kernel is made of."""
        return tuple(dict.fromkeys((*self.source.files, *(f for v in self.variants for f in v.files))))

    @cached_property
    def given(self) -> tuple[str, ...]:
        """Which names the text reads of those that the engine gives: see ``reserved_names.GIVEN``."""
        return tuple(name for name in GIVEN if self.reads(name))

    @property
    def options(self) -> tuple[tuple[Option, Any], ...]:
        """The options of its pragma that are not at their defaults, with their values."""
        rows = [row for row in options_of(type(self)).values() if row.attribute]
        return tuple((row, row.of(self)) for row in rows if row.of(self) != row.default)

    @cached_property
    def names_in_options(self) -> frozenset[str]:
        """Names in the expressions that its textures depend on beyond what the plan says."""
        keyed = [(row, value) for row, value in self.options if row.keyed and row.expressions]
        texts = [text for row, value in keyed if row.expressions for text in row.expressions(value)]
        return frozenset(_IDENTIFIER.findall(" ".join(texts)))

    @property
    def pragma(self) -> Line | None:
        """The line of its header; a plain shader has none."""
        return next((line for line in self.source.lines if line.pragma and not line.chain), None)

    @cached_property
    def file_parameters(self) -> tuple[Parameter, ...]:
        """Those of its parameters that name files."""
        return tuple(p for p in self.parameters if p.widget.kind == "file")

    @cached_property
    def valued_menus(self) -> tuple[Parameter, ...]:
        """Those of its parameters that are menus with values of their own."""
        return tuple(p for p in self.parameters if p.widget.values)

    def error(self, message: str) -> ShaderError:
        """Return an error that points at its header."""
        line = self.pragma
        return line.error(message) if line else ShaderError(message, file=self.path)

    def parameter(self, name: str) -> Parameter | None:
        """Return the parameter of that name, if there is one."""
        return self._parameters_by_name.get(name)

    @cached_property
    def former_names(self) -> dict[str, str]:
        """Former name → name of its parameters that were renamed."""
        return {former: parameter.name for parameter in self.parameters for former in parameter.former}

    @cached_property
    def _parameters_by_name(self) -> dict[str, Parameter]:
        return {parameter.name: parameter for parameter in reversed(self.parameters)}

    def reads(self, given: str) -> bool:
        """Return whether the text names something that the engine gives, or depends on it all the same."""
        return given in self.source.names or given in self.depends

    @property
    def needs_inputs(self) -> tuple[str, ...]:
        """Inputs that must be wired."""
        return tuple(i.name for i in self.inputs if not i.fallback)


@dataclass(frozen=True)
class TexelKernel(Kernel):
    """A kernel: a function that computes one texel, run by either driver."""

    repeat: str = _expression(_REPEAT, "1", names=CLOCKS, keyed=False)
    accepts: str = _option(_ACCEPTS, parse=_accepts, keyed=False, page="accepts")
    visits: str = _expression(
        "how many texels a step changes, along x and y; `ivec2 visit(ivec2 cell)` says which",
        names=COUNTERS,
        count=2,
    )
    stride: str = _expression(
        "how far apart the texels of `visits` lie that are known after a step, a power of two",
        names=COUNTERS,
        check=lambda kernel: (
            ""
            if kernel.visits
            else "stride says how far apart the texels of visits lie; give the kernel visits"
        ),
        page="stride",
    )
    between: str = _choice(
        "how those texels are joined in a picture of a run that is stopped early",
        "",
        ("squares", "triangles"),
        check=lambda kernel: (
            ""
            if kernel.stride
            else "between says how the texels of a stride are joined; give the kernel a stride"
        ),
        keyed=False,
        compared=False,
        page="between",
    )
    at_once: str = _expression(
        "how many steps one run may take: the text does those from `iteration` up to `until`",
        "1",
        check=_check_at_once,
        excludes=("visits",),
        page="atOnce",
    )
    until: str = _choice(
        "ends the run once a step has changed no bit of any texel",
        "",
        ("unchanged",),
        check=_check_until,
        excludes=("visits", "at_once"),
        page="until",
    )
    warns: tuple[tuple[str, str], ...] = _option(
        'what is warned of where a condition holds, as `"frequency <= tiles: no detail is left; …"`',
        (),
        parse=_warnings,
        keyed=False,
        compared=False,
    )

    kind = "kernel"
    example = '(output = "height:r32f")'
    replaced = (WHERE, OUTPUT)

    @property
    def counts(self) -> tuple[str, ...]:
        """The expressions that a plan evaluates."""
        return (self.repeat, self.stride) if self.stride else (self.repeat,)

    @property
    def ends_early(self) -> bool:
        """Whether its repeat may end before its last step."""
        return bool(self.until)

    @property
    def runs_once(self) -> bool:
        """Whether it has one step, which computes every texel."""
        return self.repeat == "1" and not self.visits

    @property
    def fills_lattice(self) -> bool:
        """Whether its steps fill an ever closer lattice: see ``engine.lattice``."""
        return bool(self.stride)


@dataclass(frozen=True)
class Draw(Kernel):
    """A draw of a mesh: a vertex and a fragment function."""

    mesh: str = _option(
        "the mesh: `grid`, `sheet`, `triangles` or `land`", required='a mesh, as mesh = "grid"', page="mesh"
    )
    count: str = _expression(
        "how many elements a mesh has that has no size of its own; it may name sizes of inputs",
        of_inputs=tuple(f".{side}" for side in SIZE),
        page="count",
    )
    instances: str = _expression(
        "how often the mesh is drawn; it may name the first texel of an input, as `list.x`",
        of_inputs=(".x", ".y", ".z", ".w"),
        page="instances",
    )
    blend: str = _choice(
        "how it is mixed with what is drawn already", "none", ("none", "alpha", "add"), page="blend"
    )
    depth: str = _choice(
        "which fragments are drawn, by their depth", "less", ("less", "equal", "none"), page="depth"
    )
    over: str = _option("the input whose pixels it draws over, those that its draw has drawn", parse=_input)
    samples: int = _option(
        "samples a pixel, 0 for as many as the view has",
        0,
        parse=_samples,
        choices=("0", "1"),
        page="samples",
    )
    repeat: str = _expression("how often it is drawn; 0 costs nothing", "1", names=CLOCKS, keyed=False)

    kind = "draw"
    example = '(mesh = "grid")'
    replaced = (WHERE, replace(OUTPUT, default="frame:rgba16f", required=""))


@dataclass(frozen=True)
class CpuSource(Kernel):
    """A source: textures that a processor makes, as of a file."""

    registry: str = _option(
        "a row of `playground/engine/sources.py`",
        name="name",
        required='its name, as #pragma source("elevation_file", output = "height:r32f")',
        positional=True,
    )
    depends: tuple[str, ...] = _option(
        "what it depends on besides its parameters, separated by commas",
        (),
        name="reads",
        parse=_reads,
        choices=_SOURCE_READS,
        keyed=False,
    )

    kind = "source"
    example = '("elevation_file", output = "height:r32f")'
    replaced = (OUTPUT,)


@dataclass(frozen=True)
class Storage:
    """The storage buffers of a compute variant."""

    buffers: tuple[Buffer, ...] = _option(
        'its buffers, as `"stack:vec4:size.x * 64; …"`',
        (),
        parse=_buffers,
        expressions=lambda buffers: tuple(buffer.count for buffer in buffers),
    )
    aligned: int = _option(
        "bytes that rows of an output's buffer are filled up to",
        8,
        parse=_aligned,
        choices=("4", "8", "16", "32"),
    )
    in_place: str = _option(
        "the buffer that begins as the first input and ends as the output", check=_check_in_place
    )
    active: str = _option(
        "the buffer in which steps count what is left to do; at 0 only the last step still runs",
        check=_check_active,
    )
    overwrites: tuple[str, ...] = _option(
        "outputs and buffers that need not begin as zeros",
        (),
        parse=lambda name, text, scope: _parts(text, ","),
    )

    def of_output(self, output: str) -> Buffer | None:
        """Return the buffer that is an output, copied to its texture; None for none."""
        names = (output, self.in_place)
        return next((buffer for buffer in self.buffers if buffer.name in names), None)

    def lacks(self, option: str, name: str) -> str:
        """Say that there is no buffer of that name; "" where there is."""
        names = [buffer.name for buffer in self.buffers]
        return "" if name in names else f"{option}: no buffer '{name}'{nearest(name, names)}"


@dataclass(frozen=True)
class ComputeVariant(Kernel):
    """A compute shader that takes the place of a technique: one of its fast variants."""

    repeat: str = _expression(_REPEAT, "1")
    accepts: str = ""  # of its technique
    own_accepts: str = _option(_ACCEPTS, name="accepts", parse=_accepts, keyed=False)
    groups: str = _expression(
        "work groups of a step, along x and y",
        names=(COUNTERS[0],),
        count=2,
        required='groups, as groups = "size.y, 1"',
    )
    local: tuple[int, int] = _option("threads of a work group, along x and y", (8, 8), parse=_local)
    stages: tuple[int, ...] = _option(
        'what each of its steps does, as `"0, 1, 1, 2"`, in place of `repeat`',
        (),
        parse=_stages,
        excludes=("repeat",),
    )
    agrees: tuple[Bound, ...] = _option(
        'how closely it agrees with the canonical form, as `"exact"` or `"1e-5"`',
        (),
        parse=_agrees,
        keyed=False,
    )
    storage: Storage = field(default=Storage(), metadata={"record": True})

    kind = "compute"
    example = '(groups = "size.y, 1", agrees = "exact")'
    replaced = (WHERE,)

    @property
    def ends_early(self) -> bool:
        """Whether its repeat may end before its last step."""
        return bool(self.storage.active)

    def __post_init__(self) -> None:
        """Repeat for each of the stages."""
        if self.stages and self.repeat == "1":
            object.__setattr__(self, "repeat", str(len(self.stages)))


class PlainShader(Kernel):
    """A shader with a ``main`` of its own, which runs unchanged."""

    @cached_property
    def usual(self) -> tuple[tuple[str, str], ...]:
        """Uniforms that it names and is given, with what they mean to ``Runner``."""
        return tuple(
            (n, meaning) for meaning, names in PLAIN_UNIFORMS.items() for n in names if self.reads(n)
        )


@dataclass(frozen=True)
class PlainFragment(PlainShader):
    """A plain fragment shader."""

    kind = "plain_fragment"


@dataclass(frozen=True)
class PlainCompute(PlainShader):
    """A plain compute shader."""

    local: tuple[int, int] = (1, 1)

    kind = "plain_compute"


@dataclass(frozen=True)
class VertexShader:
    """The vertex shader of another tool's shader that its author wrote."""

    source: SourceText
    prelude: tuple[str, ...] = ()
    helpers: tuple[str, ...] = ()


@dataclass(frozen=True)
class ForeignShader(PlainFragment):
    """A fragment shader of another tool."""

    dialect: str = ""  # the name of a row of sketch/dialects
    prelude: tuple[str, ...] = ()  # lines that the driver gets before the file's
    epilogue: str = ""  # the file of shader/shaders that follows the file's lines
    helpers: tuple[str, ...] = ()  # files of shader/shaders between the prelude and its lines
    # Its vertex shader: the author's own, or what the engine's gives it: declaration, statements.
    vertex: VertexShader | tuple[tuple[str, str], ...] = ()
    tool_names: tuple[tuple[str, str], ...] = ()  # what its tool gives, with meanings
    usual: tuple[tuple[str, str], ...] = ()
    unfed: tuple[tuple[str, str], ...] = ()  # what it lacks where nothing is wired, what is instead

    @property
    def vertex_source(self) -> SourceText | None:
        """The text of the author's own vertex shader."""
        return self.vertex.source if isinstance(self.vertex, VertexShader) else None

    @property
    def files(self) -> tuple[str, ...]:
        """Absolute paths of every file the shader is made of."""
        vertex = self.vertex_source.files if self.vertex_source else ()
        return tuple(dict.fromkeys((*super().files, *vertex)))

    def reads(self, given: str) -> bool:
        """Return whether one of its texts names something."""
        return super().reads(given) or (self.vertex_source is not None and given in self.vertex_source.names)


PRAGMAS: Mapping[str, type[Kernel]] = {
    one.kind: one for one in (TexelKernel, CpuSource, Draw, ComputeVariant)
}
"""Word behind ``#pragma`` → kind of kernel."""

RECORDS: Mapping[str, type[Any]] = {"storage": Storage}
"""Field of a kernel that holds options → its class."""


def _rows(record: type[Any], path: str) -> Iterator[Option]:
    for one in fields(record):
        if row := one.metadata.get("option"):
            yield replace(row, name=row.name or one.name, attribute=f"{path}{one.name}")
        elif one.metadata.get("record"):
            yield from _rows(RECORDS[one.name], f"{one.name}.")


_KINDS: tuple[type[Kernel], ...] = (*PRAGMAS.values(), PlainFragment, PlainCompute, ForeignShader)
_OPTIONS: Mapping[type[Kernel], Mapping[str, Option]] = {
    kind: {row.name: row for row in (*kind.replaced, *_rows(kind, ""))} for kind in _KINDS
}


def options_of(kind: type[Kernel]) -> Mapping[str, Option]:
    """Return the table of a kind's options, by name."""
    return _OPTIONS[kind]
