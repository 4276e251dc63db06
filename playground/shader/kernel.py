"""What fills a pass: a kernel, or a technique of several passes; frozen values.

``agrees = "exact"`` is every bit; ``"1e-5"`` the most that any number of any output may differ
by. Bounds of single outputs are separated by semicolons, and may count otherwise:

    "sky: 0.012 rms; ahead, behind: 0.9 degrees rms; exact"

``rms`` bounds the root of the mean square of the differences, ``degrees`` compares tangents as
angles. A bound without a name is for all outputs that have none of their own.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

from playground.errors import Diagnostic, ShaderError, SketchError
from playground.shader.fetched_alone import FetchedAlone, fetched_alone
from playground.shader.parameter import AS_IT_IS, Parameter, Sampling, Value
from playground.shader.reserved_names import GIVEN, PLAIN_UNIFORMS
from playground.shader.source import Line, SourceText

_BOUND = re.compile(
    r"(?:(?P<names>[A-Za-z_]\w*(?:\s*,\s*[A-Za-z_]\w*)*)\s*:\s*)?"
    r"(?:(?P<exact>exact)|(?P<most>\d+\.?\d*(?:e[+-]?\d+)?)(?P<degrees>\s+degrees)?(?P<rms>\s+rms)?)",
    re.ASCII,
)
EXAMPLE = 'agrees = "exact", agrees = "1e-5" or agrees = "sky: 0.01 rms; exact"'


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
    """Return the bounds that a text states; raise ``ValueError`` with what is wrong with it."""
    found: list[Bound] = []
    for part in (part.strip() for part in text.split(";")):
        match = _BOUND.fullmatch(part)
        if match is None or (match["most"] and not 0.0 < float(match["most"]) < math.inf):
            raise ValueError(f"'{part}' states no bound; expected {EXAMPLE}")
        for name in [n.strip() for n in (match["names"] or "").split(",")]:
            if name in [bound.output for bound in found]:
                raise ValueError(f"'{part}': {name or 'all other outputs'} appears twice")
            most = float(match["most"] or 0.0)
            found.append(Bound(name, most, bool(match["degrees"]), bool(match["rms"])))
    return tuple(found)


def bound_of(bounds: tuple[Bound, ...], output: str) -> Bound | None:
    """Return the bound of an output; None where none is stated."""
    named = {bound.output: bound for bound in bounds}
    return named.get(output, named.get(""))


VARIANTS = ("compute", "passes", "draws")
"""The kinds of fast variants: a ``.comp`` needs compute shaders, a ``.fast.toml`` does not.

One that replaces a draw runs on a software renderer, where a pixel has one sample: what is fast there
is slow on a GPU.
"""


NOT = "not "
"""Begins a condition of a pass that an input is not wired."""

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
    format: str  # r8 r16 r16f r32f and their rg and rgba forms

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


@dataclass(frozen=True)
class Kernel:
    """One GLSL file that can be run: a kernel, a source, a draw, a compute variant or a plain shader."""

    name: str  # "generation/diamond_square"
    kind: str  # kernel | source | draw | compute | plain_fragment | plain_compute
    source: SourceText
    outputs: tuple[Output, ...]
    parameters: tuple[Parameter, ...] = ()
    inputs: tuple[Input, ...] = ()
    repeat: str = "1"
    accepts: str = ""
    own_accepts: str = ""  # of a compute variant: the sizes that it takes, where its technique takes more
    visits: str = ""
    stride: str = ""  # after a step, only texels at multiples of it are known
    between: str = ""  # how the texels of a stride are joined where a run is stopped: squares | triangles
    at_once: str = "1"  # steps that one run may take
    until: str = ""  # "unchanged": no more steps are run once one has changed no texel
    warns: tuple[tuple[str, str], ...] = ()  # condition of its parameters → what is warned of where it holds
    registry: str = ""  # of a source or a draw: the name of the source or mesh
    depends: tuple[str, ...] = ()  # of a source: what its texels depend on besides its parameters, as time
    blend: str = "none"
    depth: str = "less"
    over: str = ""  # of a draw: the input whose pixels it draws over, those that its draw has drawn
    count: str = ""  # of a draw: elements of a mesh that has no size of its own
    instances: str = ""  # of a draw: how often its mesh is drawn, perhaps by the first texel of an input
    samples: int = 0  # of a draw: samples a pixel; 0: the view's
    groups: str = ""  # of a compute variant
    local: tuple[int, int] = (8, 8)
    buffers: tuple[Buffer, ...] = ()
    aligned: int = 8  # bytes that rows of an output's buffer are filled up to
    in_place: str = ""  # of a compute variant: a buffer that begins as its first input and ends as its output
    active: str = ""  # likewise: a buffer; once a step leaves it all zeros, only the last step is left to run
    stages: tuple[int, ...] = ()  # of a compute variant: what each of its steps does
    overwrites: tuple[str, ...] = ()  # of a compute variant: outputs and buffers that need not begin as zeros
    agrees: tuple[Bound, ...] = ()  # of a compute variant: how closely, with the technique that it replaces
    title: str = ""  # the sentence that the file begins with
    variants: tuple[Variant, ...] = ()  # its fast variants, the fastest first
    dialect: str = ""  # of another tool's shader: the name of a row of sketch/dialects
    prelude: tuple[str, ...] = ()  # likewise: lines that the driver gets before the file's
    epilogue: str = ""  # likewise: the file of shader/shaders that follows the file's lines
    helpers: tuple[str, ...] = ()  # likewise: files of shader/shaders between the prelude and its lines
    vertex: tuple[tuple[str, str], ...] = ()  # what its vertex shader gives it: declaration, statements
    vertex_source: SourceText | None = None  # the author's own vertex shader, in place of ``vertex``
    vertex_prelude: tuple[str, ...] = ()  # of that
    vertex_helpers: tuple[str, ...] = ()  # likewise
    tool_names: tuple[tuple[str, str], ...] = ()  # likewise: what its tool gives, with meanings
    meanings: tuple[tuple[str, str], ...] = ()  # uniform → what it is given: see ``usual``
    unfed: tuple[tuple[str, str], ...] = ()  # likewise: what it lacks where nothing is wired, what is instead

    @property
    def path(self) -> str:
        """Absolute path of the file."""
        return self.source.path

    def buffer_of(self, output: str) -> Buffer | None:
        """Return the buffer of a compute variant that is an output, copied to its texture; None for none."""
        names = (output, self.in_place)
        return next((buffer for buffer in self.buffers if buffer.name in names), None)

    @cached_property
    def usual(self) -> tuple[tuple[str, str], ...]:
        """Uniforms that a plain shader names and is given, with what they mean to ``Runner``."""
        if self.dialect or not self.kind.startswith("plain"):
            return self.meanings
        return tuple(
            (n, meaning) for meaning, names in PLAIN_UNIFORMS.items() for n in names if self.reads(n)
        )

    @property
    def files(self) -> tuple[str, ...]:
        """Absolute paths of every file the kernel is made of."""
        vertex = self.vertex_source.files if self.vertex_source else ()
        return tuple(
            dict.fromkeys((*self.source.files, *vertex, *(f for v in self.variants for f in v.files)))
        )

    @cached_property
    def given(self) -> tuple[str, ...]:
        """Which names the text reads of those that the engine gives: see ``reserved_names.GIVEN``."""
        return tuple(name for name in GIVEN if self.reads(name))

    @cached_property
    def fetched_alone(self) -> FetchedAlone:
        """What of it reads inputs by ``texelFetch`` alone; nothing of a plain or another tool's shader."""
        if self.dialect or self.kind.startswith("plain"):
            return FetchedAlone()
        return fetched_alone(self.source, frozenset([declared.name for declared in self.inputs]))

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
        return (
            given in self.source.names
            or given in self.depends
            or (self.vertex_source is not None and given in self.vertex_source.names)
        )

    @property
    def needs_inputs(self) -> tuple[str, ...]:
        """Inputs that must be wired."""
        return tuple(i.name for i in self.inputs if not i.fallback)


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
    when: tuple[str, ...] = ()  # inputs of the technique it is in, "dome" or "not dome"; () always
    choices: tuple[tuple[str, tuple[str, ...]], ...] = ()  # input → its sources: the first that is there
    file: str = ""
    line: int = 0
    set_lines: tuple[tuple[str, int], ...] = ()  # parameter path of ``values`` → line of the file

    def error(self, message: str) -> SketchError:
        """Return an error that points at this pass."""
        return SketchError(message, file=self.file, line=self.line)


@dataclass(frozen=True)
class Graph:
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
    warnings: tuple[Diagnostic, ...] = field(default=(), compare=False)  # former names that its file uses
    parts: tuple[Technique, ...] = ()  # of "A(B)": A and B; see sketch/composed.py
    whole: Graph | None = field(default=None, compare=False)  # of one form of it: all of it; see presence.py
    wired: frozenset[str] = field(default=frozenset(), compare=False)  # likewise: the inputs that are wired

    @property
    def written(self) -> Graph:
        """All of it as its file has it, where this is one form of it: with passes that are not there."""
        return self.whole or self

    @property
    def files(self) -> tuple[str, ...]:
        """Absolute paths of every file the technique is made of, those of passes that are not there too."""
        if self.whole is not None:
            return self.whole.files
        parts = (*(spec.technique for spec in self.passes), *self.variants, *self.parts)
        return tuple(dict.fromkeys([self.path, *(file for part in parts for file in part.files)]))

    @property
    def dialect(self) -> str:
        """Of another tool's shader the name of a row of sketch/dialects, of a TOML none."""
        return "" if self.parts or self.path.endswith(".toml") else self.kernels[-1][1].dialect

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

    technique: Technique  # of a .comp its kernel, of a .fast.toml its passes
    verified: tuple[str, str] | None = None  # contents that were found to agree: canonical, its own
    record: str = ""  # absolute path of the user's file that says so; "" where there is none

    @property
    def kind(self) -> str:
        """One of ``VARIANTS``."""
        if not isinstance(self.technique, Graph):
            return "compute"
        return "draws" if any(kernel.over for _, kernel in self.technique.kernels) else "passes"

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
