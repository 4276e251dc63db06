"""What fills a pass: a kernel, or a technique of several passes; frozen values.

There is one class for each kind of GLSL file. A field with a row (``option``, ``expression``, ``choice``) is
an option of its pragma. That row is all that the header reader, cache keys, page writer and language server
know of it: a new option is a row, a line in the README, and the code that executes it.

Functions that read an option's text take its name, the text, and what it may name; they raise ``ValueError``
with a message for users.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from operator import attrgetter
from pathlib import Path
from typing import Any, ClassVar

from playground.errors import Diagnostic, ShaderError, SketchError, nearest
from playground.memo import PickledByFields
from playground.shader import expressions
from playground.shader.expressions import CLOCKS, COUNTERS, ExpressionError
from playground.shader.parameter import AS_IT_IS, Parameter, Sampling
from playground.shader.reserved_names import GIVEN, OF_THE_TERRAIN, PLAIN_UNIFORMS, TOWARDS
from playground.shader.source import Line, SourceText
from playground.shader.widgets import Value

FORMATS: tuple[str, ...] = tuple(f"{c}{d}" for c in ("r", "rg", "rgba") for d in ("8", "16", "16f", "32f"))
"""Formats of textures."""

SIZE = ("size.x", "size.y")
SOURCE_READS = ("time", "keys", "microphone", "camera", *OF_THE_TERRAIN)
_BUFFER_TYPES = ("float", "int", "uint", "vec2", "vec4", "ivec2", "ivec4", "uvec2", "uvec4")
_BOUND = re.compile(
    r"(?:(?P<names>[A-Za-z_]\w*(?:\s*,\s*[A-Za-z_]\w*)*)\s*:\s*)?"
    r"(?:(?P<exact>exact)|(?P<most>\d+\.?\d*(?:e[+-]?\d+)?)(?P<degrees>\s+degrees)?(?P<rms>\s+rms)?)",
    re.ASCII,
)
EXAMPLE = 'agrees = "exact", agrees = "1e-5" or agrees = "sky: 0.01 rms; exact"'


@dataclass(frozen=True, slots=True)
class Buffer:
    """A storage buffer of a compute variant."""

    name: str
    type: str  # GLSL scalar or vec4
    count: str  # expression


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
    # Its name, its text and what that may name → its value; raises ``ValueError``.
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

    def of(self, kernel: object) -> Any:
        """Return its value in a kernel."""
        return attrgetter(self.attribute)(kernel)

    @property
    def about(self) -> str:
        """What it says, with its choices and its default, as Markdown."""
        choices = f": {', '.join(f'`{item}`' for item in self.choices)}" if self.choices else ""
        default = ", ".join(map(str, self.default)) if isinstance(self.default, tuple) else self.default
        return f"{self.help}{choices}{f' (`{default}`)' if default not in ('', 0) else ''}"


def option(help: str, default: Any = "", **more: Any) -> Any:
    """Declare an option, as a field of a kernel."""
    return field(default=default, metadata={"option": Option(help, default, **more)})


def expression(
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
        allowed = (
            *SIZE,
            *names,
            *scope.numbers,
            *(f"{item}{part}" for item in scope.inputs for part in of_inputs),
        )
        check_expression(name, text, allowed, count)
        if expressions.counts_frames(text) and "frames" in names and "frames" in scope.numbers:
            raise ValueError(f"{name} '{text}': 'frames' {expressions.TWO_FRAMES}")
        return text

    return option(help, default, parse=parse, expressions=lambda text: (text,), **more)


def check_expression(name: str, text: str, names: tuple[str, ...], count: int = 1) -> None:
    """Raise ``ValueError`` for an expression that is none, or names something else than what is known."""
    try:
        expressions.check(text, names, count=count)
    except ExpressionError as error:
        raise ValueError(f"{name}: {error}") from None


def choice(help: str, default: str, choices: tuple[str, ...], **more: Any) -> Any:
    """Declare an option that is one of a few words."""

    def parse(name: str, text: str, scope: Scope) -> str:
        if text not in choices:
            hint = nearest(text, choices).replace("; there are", ": expected one of")
            raise ValueError(f'{name} = "{text}"{hint}')
        return text

    return option(help, default, parse=parse, choices=choices, **more)


def read_accepts(name: str, text: str, scope: Scope) -> str:
    """Return a form of sizes, where it is one."""
    try:
        expressions.accepted_sizes(text)
    except ExpressionError as error:
        raise ValueError(f'{name}: {error}; as accepts = "2**n + 1"') from None
    return text


def read_warnings(name: str, text: str, scope: Scope) -> tuple[tuple[str, str], ...]:
    """Return conditions, and what is warned of where one holds."""
    warnings: list[tuple[str, str]] = []
    for part in parts_of(text, ";"):
        condition, colon, message = (piece.strip() for piece in part.partition(":"))
        if not colon or not message:
            example = "frequency <= tiles: no detail is left (several are separated by ;)"
            raise ValueError(f"{name} '{part}': expected condition: message, as {example}")
        check_expression(name, condition, (*SIZE, *scope.numbers))
        warnings.append((condition, " ".join(message.split())))
    return tuple(warnings)


def read_reads(name: str, text: str, scope: Scope) -> tuple[str, ...]:
    """Return what a source depends on."""
    parts = parts_of(text, ",")
    for item in parts:
        if item not in SOURCE_READS:
            raise ValueError(f"{name} = '{text}': a source cannot read '{item}'{nearest(item, SOURCE_READS)}")
    return parts


def read_samples(name: str, text: str, scope: Scope) -> int:
    """Return the samples of a pixel."""
    if text not in ("0", "1"):
        raise ValueError(f"{name} = {text}: expected 1, or 0 for as many as the view has")
    return int(text)


def read_level(name: str, text: str, scope: Scope) -> str:
    """Return the name of a parameter that is a number."""
    if text not in scope.numbers:
        raise ValueError(f"{name}: there is no number '{text}'{nearest(text, scope.numbers)}")
    return text


def read_input(name: str, text: str, scope: Scope) -> str:
    """Return the name of an input that there is."""
    if text not in scope.inputs:
        raise ValueError(f"{name}: there is no input '{text}'{nearest(text, scope.inputs)}")
    return text


def read_local(name: str, text: str, scope: Scope) -> tuple[int, int]:
    """Return the threads of a work group, along x and y."""
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 2 or not all(re.fullmatch(r"[1-9][0-9]{0,4}", part) for part in parts):
        raise ValueError(f'{name} = "{text}": expected two whole numbers, as "256, 1"')
    return int(parts[0]), int(parts[1])


def read_buffers(name: str, text: str, scope: Scope) -> tuple[Buffer, ...]:
    """Return storage buffers."""
    buffers: list[Buffer] = []
    for part in parts_of(text, ";"):
        pieces = [piece.strip() for piece in part.split(":", 2)]
        if len(pieces) != 3 or not re.fullmatch(r"[A-Za-z_]\w*", pieces[0], re.ASCII):
            example = "stack:vec4:size.x * 64 (several separated by ;)"
            raise ValueError(f"buffer '{part}': expected name:type:count, as {example}")
        if pieces[1] not in _BUFFER_TYPES:
            hint = nearest(pieces[1], _BUFFER_TYPES)
            raise ValueError(f"buffer '{pieces[0]}' has no type '{pieces[1]}'{hint}")
        check_expression(f"buffer '{pieces[0]}'", pieces[2], (*SIZE, *scope.numbers))
        buffers.append(Buffer(*pieces))
    return tuple(buffers)


def read_stages(name: str, text: str, scope: Scope) -> tuple[int, ...]:
    """Return the numbers of stages."""
    parts = parts_of(text, ",")
    if not all(re.fullmatch(r"[0-9]{1,4}", part, re.ASCII) for part in parts):
        raise ValueError(f'{name} = "{text}": expected whole numbers separated by commas')
    return tuple(map(int, parts))


def read_aligned(name: str, text: str, scope: Scope) -> int:
    """Return the bytes that rows are filled up to."""
    if text not in ("4", "8", "16", "32"):
        raise ValueError(f'{name} = "{text}": expected 4, 8, 16 or 32, the bytes that rows are filled up to')
    return int(text)


def read_agrees(name: str, text: str, scope: Scope) -> tuple[Bound, ...]:
    """Return the bounds of an agreement."""
    try:
        return read_agreement(text)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


@dataclass(frozen=True, slots=True)
class Bound:
    """How far numbers may be apart."""

    output: str = ""  # "": every output without a bound of its own
    most: float = 0.0  # 0: every bit is the same
    degrees: bool = False  # of angles, whose tangents the numbers are
    rms: bool = False  # of the root of the mean square, instead of every difference

    def __str__(self) -> str:
        words = f"{self.most:g}" if self.most else "the last bit"
        return f"{words}{' degrees' if self.degrees else ''}{' (rms)' if self.rms else ''}"


def read_agreement(text: str) -> tuple[Bound, ...]:
    """Return the bounds that a text states; raise ``ValueError`` with what is wrong with it.

    ``agrees = "exact"`` is every bit; ``"1e-5"`` the most that any number of any output may differ by. Bounds
    of single outputs are separated by semicolons, and may count otherwise:

        "sky: 0.012 rms; ahead, behind: 0.9 degrees rms; exact"

    ``rms`` bounds the root of the mean square of the differences, ``degrees`` compares tangents as angles. A
    bound without a name is for all outputs that have none of their own.
    """
    bounds: list[Bound] = []
    for part in (part.strip() for part in text.split(";")):
        match = _BOUND.fullmatch(part)
        if match is None or (match["most"] and not 0.0 < float(match["most"]) < math.inf):
            raise ValueError(f"'{part}' states no bound; expected {EXAMPLE}")
        for name in [n.strip() for n in (match["names"] or "").split(",")]:
            if name in [bound.output for bound in bounds]:
                raise ValueError(f"'{part}': {name or 'all other outputs'} appears twice")
            most = float(match["most"] or 0.0)
            bounds.append(Bound(name, most, bool(match["degrees"]), bool(match["rms"])))
    return tuple(bounds)


def bound_of(bounds: tuple[Bound, ...], output: str) -> Bound | None:
    """Return the bound of an output; None where none is stated."""
    named = {bound.output: bound for bound in bounds}
    return named.get(output, named.get(""))


def parts_of(text: str, separator: str) -> tuple[str, ...]:
    """Return the parts of a text that are not empty."""
    return tuple(filter(None, (part.strip() for part in text.split(separator))))


VARIANTS = ("compute", "passes", "draws")
"""The kinds of fast variants: a ``.comp`` needs compute shaders, a ``.fast.toml`` does not.

One that replaces a draw runs on a software renderer, where a pixel has one sample: what is fast there
is slow on a GPU.
"""


ARRAY = "an array"
"""What the pass of an array uses, which no sketch's file can name."""

SHAPES = {
    "sampler2D": "",
    "samplerCube": "cube",
    "sampler3D": "volume",
    "sampler2DArray": "layers",
    "sampler1D": "line",
}
"""GLSL type of a sampler → the shape of what it reads."""

_IDENTIFIER = re.compile(r"[A-Za-z_]\w*")


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


# ── kernels ──────────────────────────────────────────────────────────────────


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
class Kernel(PickledByFields):
    """One GLSL file that a pass can run; the base of all kinds."""

    name: str  # "generation/diamond_square"
    source: SourceText
    outputs: tuple[Output, ...]
    parameters: tuple[Parameter, ...] = ()
    inputs: tuple[Input, ...] = ()
    title: str = ""  # the sentence that the file begins with
    variants: tuple[Variant, ...] = ()  # its fast variants, the fastest first

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
        """Name of a source, a row of ``engine.sources``; "" for all other kinds."""
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
    def engine_uniforms(self) -> tuple[str, ...]:
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
    def _parameters_by_name(self) -> dict[str, Parameter]:
        return {parameter.name: parameter for parameter in reversed(self.parameters)}

    def reads(self, name: str) -> bool:
        """Return whether the text names something that the engine gives, or depends on it all the same."""
        return name in self.source.names or name in self.depends

    @property
    def needs_inputs(self) -> tuple[str, ...]:
        """Inputs that must be wired."""
        return tuple(i.name for i in self.inputs if not i.fallback)


def _check_relief(kernel: TerrainKernel) -> str:
    if kernel.relief and not any(name in kernel.source.names for name in _METRES):
        return f"relief says which metres the text is given, but it names neither {' nor '.join(_METRES)}"
    return ""


def _check_level(kernel: TerrainKernel) -> str:
    if kernel.level and kernel.relief == "true":
        return 'level is for a kernel that shows the land; take relief = "true" out'
    if kernel.level and "base_elevation" not in kernel.source.names:
        return "level says which parameter is an elevation, but the text never names base_elevation"
    return ""


_METRES = ("relief", "base_elevation")
_CAMERA = ("clip_from_world", "world_from_clip", "eye")


@dataclass(frozen=True)
class TerrainKernel(Kernel):
    """A kernel that is given the terrain's metres: the true ones, or those that a window shows."""

    relief: str = choice(
        "which metres it is given where a window exaggerates the land: what draws or lights it those that "
        "are `shown`, what computes heights, water or materials the `true` ones; without, a draw is given "
        "those that are shown, and so is a text that names the camera or what is towards a direction",
        "",
        ("shown", "true"),
        check=_check_relief,
        keyed=False,
        compared=False,
    )
    level: str = option(
        "the parameter that is an elevation in metres, as a sea's: exaggerated, it keeps its shore",
        parse=read_level,
        check=_check_level,
        keyed=False,
        compared=False,
    )

    @cached_property
    def shows_relief(self) -> bool:
        """Whether it draws or lights the terrain, and so is given an exaggerated one where that is shown."""
        if self.relief or self.level:
            return self.relief != "true"
        directions = (p.name for p in self.parameters if p.widget.kind == "direction")
        return any(self.reads(name) for name in (*_CAMERA, *(f"{TOWARDS}{name}" for name in directions)))


@dataclass(frozen=True)
class TexelKernel(TerrainKernel):
    """A kernel: a function that computes one texel, run by either driver."""

    repeat: str = expression(_REPEAT, "1", names=CLOCKS, keyed=False)
    accepts: str = option(_ACCEPTS, parse=read_accepts, keyed=False, page="accepts")
    visits: str = expression(
        "how many texels a step changes, along x and y; `ivec2 visit(ivec2 cell)` says which",
        names=COUNTERS,
        count=2,
    )
    stride: str = expression(
        "how far apart the texels of `visits` lie that are known after a step, a power of two",
        names=COUNTERS,
        check=lambda kernel: (
            ""
            if kernel.visits
            else "stride says how far apart the texels of visits lie; give the kernel visits"
        ),
        page="stride",
    )
    between: str = choice(
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
    at_once: str = expression(
        "how many steps one run may take: the text does those from `iteration` up to `until`",
        "1",
        check=_check_at_once,
        excludes=("visits",),
        page="atOnce",
    )
    until: str = choice(
        "ends the run once a step has changed no bit of any texel",
        "",
        ("unchanged",),
        check=_check_until,
        excludes=("visits", "at_once"),
        page="until",
    )
    warns: tuple[tuple[str, str], ...] = option(
        'what is warned of where a condition holds, as `"frequency <= tiles: no detail is left; …"`',
        (),
        parse=read_warnings,
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
class Draw(TerrainKernel):
    """A draw of a mesh: a vertex and a fragment function."""

    mesh: str = option(
        "the mesh: `grid`, `sheet`, `triangles` or `land`", required='a mesh, as mesh = "grid"', page="mesh"
    )
    count: str = expression(
        "how many elements a mesh has that has no size of its own; it may name sizes of inputs",
        of_inputs=tuple(f".{side}" for side in SIZE),
        page="count",
    )
    instances: str = expression(
        "how often the mesh is drawn; it may name the first texel of an input, as `list.x`",
        of_inputs=(".x", ".y", ".z", ".w"),
        page="instances",
    )
    blend: str = choice(
        "how it is mixed with what is drawn already", "none", ("none", "alpha", "add"), page="blend"
    )
    depth: str = choice(
        "which fragments are drawn, by their depth", "less", ("less", "equal", "none"), page="depth"
    )
    over: str = option(
        "the input whose pixels it draws over, those that its draw has drawn", parse=read_input
    )
    samples: int = option(
        "samples a pixel, 0 for as many as the view has",
        0,
        parse=read_samples,
        choices=("0", "1"),
        page="samples",
    )
    repeat: str = expression("how often it is drawn; 0 costs nothing", "1", names=CLOCKS, keyed=False)

    kind = "draw"
    example = '(mesh = "grid")'
    replaced = (WHERE, replace(OUTPUT, default="frame:rgba16f", required=""))

    @property
    def shows_relief(self) -> bool:
        """Whether it is given an exaggerated terrain where that is shown."""
        return self.relief != "true"


@dataclass(frozen=True)
class CpuSource(Kernel):
    """A source: textures that a processor makes, as of a file."""

    registry: str = option(
        "a row of `playground/engine/sources.py`",
        name="name",
        required='its name, as #pragma source("elevation_file", output = "height:r32f")',
        positional=True,
    )
    depends: tuple[str, ...] = option(
        "what it depends on besides its parameters, separated by commas",
        (),
        name="reads",
        parse=read_reads,
        choices=SOURCE_READS,
        keyed=False,
    )

    kind = "source"
    example = '("elevation_file", output = "height:r32f")'
    replaced = (OUTPUT,)


@dataclass(frozen=True)
class Storage:
    """The storage buffers of a compute variant."""

    buffers: tuple[Buffer, ...] = option(
        'its buffers, as `"stack:vec4:size.x * 64; …"`',
        (),
        parse=read_buffers,
        expressions=lambda buffers: tuple(buffer.count for buffer in buffers),
    )
    aligned: int = option(
        "bytes that rows of an output's buffer are filled up to",
        8,
        parse=read_aligned,
        choices=("4", "8", "16", "32"),
    )
    in_place: str = option(
        "the buffer that begins as the first input and ends as the output", check=_check_in_place
    )
    active: str = option(
        "the buffer in which steps count what is left to do; at 0 only the last step still runs",
        check=_check_active,
    )
    overwrites: tuple[str, ...] = option(
        "outputs and buffers that need not begin as zeros",
        (),
        parse=lambda name, text, scope: parts_of(text, ","),
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
class ComputeVariant(TerrainKernel):
    """A compute shader that takes the place of a technique: one of its fast variants."""

    repeat: str = expression(_REPEAT, "1")
    accepts: str = ""  # of its technique
    own_accepts: str = option(_ACCEPTS, name="accepts", parse=read_accepts, keyed=False)
    groups: str = expression(
        "work groups of a step, along x and y",
        names=(COUNTERS[0],),
        count=2,
        required='groups, as groups = "size.y, 1"',
    )
    local: tuple[int, int] = option("threads of a work group, along x and y", (8, 8), parse=read_local)
    stages: tuple[int, ...] = option(
        'what each of its steps does, as `"0, 1, 1, 2"`, in place of `repeat`',
        (),
        parse=read_stages,
        excludes=("repeat",),
    )
    agrees: tuple[Bound, ...] = option(
        'how closely it agrees with the canonical form, as `"exact"` or `"1e-5"`',
        (),
        parse=read_agrees,
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

    dialect: str = ""  # its name, as ``--dialect`` takes it
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

    def reads(self, name: str) -> bool:
        """Return whether one of its texts names something."""
        return super().reads(name) or (self.vertex_source is not None and name in self.vertex_source.names)


PRAGMAS: Mapping[str, type[Kernel]] = {
    kernel.kind: kernel for kernel in (TexelKernel, CpuSource, Draw, ComputeVariant)
}
"""Word behind ``#pragma`` → kind of kernel."""

RECORDS: Mapping[str, type[Any]] = {"storage": Storage}
"""Field of a kernel that holds options → its class."""


def _rows(record: type[Any], path: str) -> Iterator[Option]:
    for element in fields(record):
        if row := element.metadata.get("option"):
            yield replace(row, name=row.name or element.name, attribute=f"{path}{element.name}")
        elif element.metadata.get("record"):
            yield from _rows(RECORDS[element.name], f"{element.name}.")


_KINDS: tuple[type[Kernel], ...] = (*PRAGMAS.values(), PlainFragment, PlainCompute, ForeignShader)
_OPTIONS: Mapping[type[Kernel], Mapping[str, Option]] = {
    kind: {row.name: row for row in (*kind.replaced, *_rows(kind, ""))} for kind in _KINDS
}


def options_of(kind: type[Kernel]) -> Mapping[str, Option]:
    """Return the table of a kind's options, by name."""
    return _OPTIONS[kind]


# ── techniques of several passes ─────────────────────────────────────────────


@dataclass(frozen=True, slots=True)
class Export:
    """A name that a technique of several passes exports, and its targets inside."""

    name: str
    targets: tuple[str, ...]  # paths inside; the first gives annotation and default
    line: int = 0


@dataclass(frozen=True)
class PassSpec:
    """A ``[[pass]]`` of a TOML file, with the technique that fills it."""

    name: str
    use: str
    technique: Technique
    inputs: tuple[tuple[str, str], ...] = ()  # input → "pass[.inner…][:output]"
    values: tuple[tuple[str, Value], ...] = ()  # parameter path inside the technique → value
    size: tuple[str, str] | None = None  # expressions; None: the size of what it is in
    repeat: str = ""
    feedback: tuple[tuple[str, str], ...] = ()  # input → own output
    choices: tuple[tuple[str, tuple[str, ...]], ...] = ()  # input → its sources: the first present
    file: str = ""
    line: int = 0
    set_lines: tuple[tuple[str, int], ...] = ()  # parameter path of ``values`` → line of the file

    def error(self, message: str) -> SketchError:
        """Return an error that points at this pass."""
        return SketchError(message, file=self.file, line=self.line)


@dataclass(frozen=True)
class Graph(PickledByFields):
    """A technique of several passes; a sketch is one too."""

    name: str
    path: str  # absolute path of its TOML
    passes: tuple[PassSpec, ...]
    parameters: tuple[Export, ...] = ()
    inputs: tuple[Export, ...] = ()
    outputs: tuple[tuple[str, str], ...] = ()  # name → "inner:output"; empty: the last pass's
    title: str = ""
    agrees: tuple[Bound, ...] = ()  # of a fast variant: how closely, with the technique that it replaces
    variants: tuple[Variant, ...] = ()  # its fast variants, the fastest first
    line: int = 0  # of its outputs
    warnings: tuple[Diagnostic, ...] = field(default=(), compare=False)  # of its file
    complete: Graph | None = field(default=None, compare=False)  # of one form of it: all of it; see wiring.py
    absent: tuple[tuple[str, str], ...] = field(default=(), compare=False)  # pass → the input that it lacks

    @property
    def written(self) -> Graph:
        """All of it as its file has it, where this is one form of it: with its absent passes."""
        return self.complete or self

    @property
    def files(self) -> tuple[str, ...]:
        """Absolute paths of every file the technique is made of, those of absent passes too."""
        if self.complete is not None:
            return self.complete.files
        parts = (*(spec.technique for spec in self.passes), *self.variants)
        return tuple(dict.fromkeys([self.path, *(file for part in parts for file in part.files)]))

    @property
    def dialect(self) -> str:
        """Of another tool's shader the dialect's name, of a TOML none."""
        if self.path.endswith(".toml"):
            return ""
        last = self.kernels[-1][1]
        return last.dialect if isinstance(last, ForeignShader) else ""

    @cached_property
    def kernels(self) -> tuple[tuple[str, Kernel], ...]:
        """Every kernel inside, by its path."""
        return tuple(
            (f"{spec.name}.{path}" if path else spec.name, kernel)
            for spec in self.passes
            for path, kernel in kernels_of(spec.technique)
        )

    @cached_property
    def leaf_parameters(self) -> dict[str, Parameter]:
        """Every parameter of every kernel inside, by its path."""
        return {f"{path}.{p.name}": p for path, kernel in self.kernels for p in kernel.parameters}

    @cached_property
    def _passes_by_name(self) -> dict[str, PassSpec]:
        return {spec.name: spec for spec in reversed(self.passes)}

    def error(self, message: str, line: int = 0) -> SketchError:
        """Return an error that points at a line of its TOML."""
        return SketchError(message, file=Path(self.path), line=line)

    def find(self, name: str) -> PassSpec | None:
        """Return the pass of that name, if there is one."""
        return self._passes_by_name.get(name)


Technique = Kernel | Graph


@dataclass(frozen=True)
class Variant:
    """A fast variant: another form of a technique, that gives the same within a stated bound."""

    technique: ComputeVariant | Graph  # of a .fast.toml
    verified: tuple[str, str] | None = None  # contents that were found to agree: canonical, its own
    record: str = ""  # absolute path of the record of what was verified; "" where there is none

    @property
    def kind(self) -> str:
        """One of ``VARIANTS``."""
        if not isinstance(self.technique, Graph):
            return "compute"
        return "draws" if any(isinstance(k, Draw) and k.over for _, k in self.technique.kernels) else "passes"

    @property
    def path(self) -> str:
        """Absolute path of its file."""
        return self.technique.path

    @property
    def files(self) -> tuple[str, ...]:
        """Absolute paths of every file that it is made of."""
        return (*self.technique.files, *filter(None, [self.record]))


def with_inner(graph: Graph, change: Callable[[Technique], Technique]) -> Graph:
    """Return a technique as its file has it, with the technique of each of its passes changed."""
    passes = tuple(replace(spec, technique=change(spec.technique)) for spec in graph.written.passes)
    return replace(graph.written, passes=passes)


def kernels_of(technique: Technique) -> tuple[tuple[str, Kernel], ...]:
    """Return (path, kernel) of every kernel a technique is made of, in the order of the files."""
    return (("", technique),) if isinstance(technique, Kernel) else technique.kernels


DRIVERS = ("auto", "fragment", "compute")
"""What may run kernels; "auto" takes for each the one that it gains by."""
