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

from playground.errors import Diagnostic, SketchError
from playground.shader.parameter import Parameter, Value
from playground.sketch.kernel import ComputeVariant, Draw, ForeignShader, Kernel

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
        if self.parts or self.path.endswith(".toml"):
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
    record: str = ""  # absolute path of the user's file that says so; "" where there is none

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
