"""Fast variants: which may run in place of a technique, the interface they must have, and their record.

A technique's canonical form is its plain text. A fast variant of it, a ``.comp`` or the passes of a
``.fast.toml``, runs only while both texts are those that were verified to agree: their hashes
(``content_of``) are in a record. Techniques are compared as they are in memory, so a text that replaces a
file's counts as well.

A kernel's text is hashed as the compiler takes it: with its includes, without comments, with any white
space. Of a technique of several passes each pass counts, and their wiring. Titles, labels, tooltips, units,
names of files and fast variants do not count.

One generated file, ``glsl/fast_variants.json``, is the record of all that ships; a user's own variants have
one in their folder. It has the hashes of both forms by the variant's path from the record's folder.
``playground variants renew`` writes it, after the two forms were drawn and compared; nothing else does.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from shlex import quote
from typing import Any

from playground.allowed_files import is_file
from playground.errors import SketchError, nearest
from playground.json_text import read_json
from playground.memo import FILES, GRAPHS
from playground.paths import GLSL, shown
from playground.shader.kernel import Bound, Variant, with_inner
from playground.shader.source import read_text
from playground.sketch.model import (
    VARIANTS,
    ComputeVariant,
    Draw,
    Graph,
    Kernel,
    Output,
    Parameter,
    Sketch,
    Technique,
)
from playground.sketch.wiring import initial_names, outputs_with_formats

_TOKEN = re.compile(
    r"[A-Za-z_]\w*"
    r"|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?\w*"
    r"|<<=|>>=|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||\^\^|[-+*/%&|^]="
    r"|\S"
)


@GRAPHS.cached(identities=1)
def content_of(technique: Technique) -> str:
    """Return the hash of a technique's canonical text; worked out once for each object."""
    parts = _of_graph(technique) if isinstance(technique, Graph) else _of_kernel(technique)
    return hashlib.blake2b(repr(parts).encode(), digest_size=16).hexdigest()


def _of_graph(graph: Graph) -> list[Any]:
    graph = graph.written
    exports = [[(e.name, e.targets) for e in some] for some in (graph.parameters, graph.inputs)]
    passes = [
        (p.name, content_of(p.technique), p.inputs, p.values, p.size, p.repeat, p.feedback)
        for p in graph.passes
    ]
    # Only where it is there: hashes of others in records stay valid.
    more = [p.choices for p in graph.passes if p.choices]
    return [*exports, graph.outputs, passes, graph.agrees, *more]


def _of_kernel(kernel: Kernel) -> list[Any]:
    options = sorted((row.name, repr(value)) for row, value in kernel.options if row.compared)
    header: list[Any] = [kernel.kind, options, [(o.name, o.format) for o in kernel.outputs]]
    header += [(i.name, _sampling(i), i.fallback) for i in kernel.inputs]
    header += [_parameter(p) for p in kernel.parameters]
    return [header, compiled_text(kernel.source.code)]


def _parameter(parameter: Parameter) -> tuple[Any, ...]:
    widget = parameter.widget
    what: tuple[Any, ...] = (widget.kind, widget.low, widget.high, widget.choices)
    more = (widget.values, widget.axes, widget.raw)
    what += more if any(more) else ()  # only where it is there, as in ``_of_graph``
    return parameter.name, parameter.type, parameter.default, what, _sampling(parameter)


def _sampling(read: Any) -> tuple[Any, ...]:
    return read.sampling.filter, read.sampling.wrap, read.sampling.mipmap


def compiled_text(code: str) -> str:
    """Return a text without comments as a compiler takes it: tokens, one space between each two.

    A line of the preprocessor stays a line, with its spaces: they can mean something there.
    """
    lines: list[str] = []
    for line in code.split("\n"):
        if line.lstrip().startswith("#"):
            lines.append(f"\n{' '.join(line.split())}\n")
        else:
            lines += _TOKEN.findall(line)
    return " ".join(lines)


@dataclass(frozen=True)
class Omission:
    """A fast variant that does not run here, and why not."""

    variant: str  # name of the variant's file
    reason: str
    path: str = ""  # of the technique in the sketch; "": wherever it is used
    runs: str = "the plain form"  # in its place
    is_news: bool = True  # it follows from no request, as to read a pass inside

    def __str__(self) -> str:
        where = f"{self.path}: " if self.path else ""
        return f"{where}{self.variant} is left out, {self.runs} runs: {self.reason}"


def active_variant(technique: Technique, kinds: Collection[str]) -> Variant | None:
    """Return the fast variant of some ``kinds`` that runs in place of a technique, if one may."""
    variants = (v for v in technique.variants if v.kind in kinds and is_verified(technique, v))
    return next(variants, None)


def is_verified(technique: Technique, variant: Variant) -> bool:
    """Return whether a technique and its fast variant are those that were found to agree."""
    return variant.verified == (content_of(technique), content_of(variant.technique))


def unverified(sketch: Sketch, kinds: Collection[str] = VARIANTS) -> tuple[Omission, ...]:
    """Return the fast variants of some ``kinds`` that its sketch cannot have run: they are not verified."""
    return () if sketch.plain else _unverified(sketch.graph, frozenset(kinds))


@GRAPHS.cached(identities=1)
def _unverified(technique: Technique, kinds: frozenset[str]) -> tuple[Omission, ...]:
    other = active_variant(technique, kinds)
    runs = Path(other.path).name if other else "the plain form"
    omissions = [
        Omission(Path(variant.path).name, why_not(technique, variant), runs=runs)
        for variant in technique.variants
        if variant.kind in kinds and not is_verified(technique, variant)
    ]
    if isinstance(technique, Graph) and other is None:
        omissions += [each for spec in technique.passes for each in _unverified(spec.technique, kinds)]
    return tuple(dict.fromkeys(omissions))


def why_not(technique: Technique, variant: Variant) -> str:
    """Return why a fast variant that is not verified is not."""
    renew = f"`playground variants renew {quote(shown(variant.path))}` verifies it"
    canonical = Path(technique.path).name
    if not variant.technique.agrees:
        return 'it does not say how closely it agrees, as agrees = "1e-5"'
    if variant.verified is None:
        return f"it was never verified against {canonical}; {renew}"
    if variant.verified[0] == content_of(technique):
        return f"it has changed since it was verified against {canonical}; {renew}"
    what = f"{canonical}, or what it is made of," if isinstance(technique, Graph) else canonical
    return f"{what} has changed since the two were found to agree; {renew} again"


def trusted(technique: Technique) -> Technique:
    """Return a technique whose fast variants count as verified, those of its passes included."""
    if isinstance(technique, Graph):
        technique = with_inner(technique, trusted)
    variants = tuple(
        replace(v, verified=(content_of(technique), content_of(v.technique))) for v in technique.variants
    )
    return replace(technique, variants=variants)


def without_variants(technique: Technique) -> Technique:
    """Return a technique in its canonical form; the same object where it has no fast variants."""
    if not any_variants(technique):
        return technique
    if isinstance(technique, Graph):
        return replace(with_inner(technique, without_variants), variants=())
    return replace(technique, variants=())


def any_variants(technique: Technique) -> bool:
    """Return whether a technique, or one inside it, has fast variants."""
    if technique.variants:
        return True
    return isinstance(technique, Graph) and any(any_variants(spec.technique) for spec in technique.passes)


INSIDE = "fast"
"""Name of the place, inside a technique, that the passes of its fast variant are in."""


def canonical_path(path: str) -> str:
    """Return the path of the technique that a pass of a fast variant runs for; else the path itself."""
    return path.partition(f".{INSIDE}.")[0]


_HELD = {1: ("float", "vec4"), 2: ("vec2", "vec4"), 4: ("vec4",)}  # types of a buffer that is an output


def check_shape(variant: ComputeVariant | Graph, of: Technique) -> None:
    """Raise ``SketchError`` or ``ShaderError`` where a fast variant has what its technique has not."""
    starts = initial_names(of) if isinstance(of, Draw) else ()
    names = [parameter.name for parameter in of.parameters], [*(item.name for item in of.inputs), *starts]
    for declared, valid in zip((variant.parameters, variant.inputs), names, strict=True):
        for item in declared:
            if item.name not in valid:
                message = f"'{item.name}' is not among the parameters and inputs of {of.name}"
                raise SketchError(
                    f"{message}{nearest(item.name, valid)}", file=shown(variant.path), line=item.line
                )
    outputs = of.outputs if isinstance(of, Kernel) else outputs_with_formats(of)
    if isinstance(variant, Graph):
        _check_passes(variant, of, outputs)
    else:
        _check_compute(variant, outputs)
    if wrong := _unbound(variant.agrees, outputs):
        raise variant.error(wrong)


def _check_compute(variant: ComputeVariant, outputs: tuple[Output, ...]) -> None:
    storage = variant.storage
    written = [*(o.name for o in outputs), *(b.name for b in storage.buffers)]
    for name in storage.overwrites:
        if name not in written:
            raise variant.error(f"overwrites: no output or buffer '{name}'{nearest(name, written)}")
    if storage.in_place and len(outputs) != 1:
        raise variant.error(f"in_place: one output was expected, not {', '.join(o.name for o in outputs)}")
    for output in outputs:
        buffer = storage.of_output(output.name)
        held = buffer.type if buffer else ""
        if held and not (output.format.endswith("32f") and held in _HELD[output.components]):
            raise variant.error(f"a buffer of {held} cannot be the output {output.name}:{output.format}")


def _check_passes(variant: Graph, of: Technique, expected: tuple[Output, ...]) -> None:
    outputs = outputs_with_formats(variant)
    if {(o.name, o.format) for o in outputs} != {(o.name, o.format) for o in expected}:
        left, other = (", ".join(f"{o.name}:{o.format}" for o in some) for some in (outputs, expected))
        raise variant.error(f"gives {left}; {of.name} gives {other}")
    if isinstance(of, Graph) and of.find(INSIDE):
        message = f"with a fast variant no pass is named '{INSIDE}': that is where the variant's passes are"
        raise of.error(message)


def _unbound(agrees: tuple[Bound, ...], outputs: tuple[Output, ...]) -> str:
    """Return what is wrong with the bounds: an output without one, or one of no output."""
    names, bounds = [o.name for o in outputs], {bound.output for bound in agrees}
    for name in sorted(bounds - {"", *names}):
        return f"agrees: there is no output '{name}'{nearest(name, names)}"
    missing = [name for name in names if agrees and name not in bounds and "" not in bounds]
    return f"agrees: no bound for the output '{missing[0]}'" if missing else ""


NAME = "fast_variants.json"

Verified = tuple[str, str]
"""Contents of a canonical form and of its fast variant."""


def record_of(variant: Path) -> tuple[Path, str]:
    """Return the record that a variant's file belongs to, and its name there."""
    folder = GLSL if variant.is_relative_to(GLSL) else variant.parent
    return folder / NAME, variant.relative_to(folder).as_posix()


def verified(variant: Path) -> tuple[Verified | None, str]:
    """Return what the record says of a variant's file, and the record's absolute path.

    The path is "" where there is none, and for the library's: that is no part of a sketch.
    Raises ``SketchError`` for a record that is not one.
    """
    record, name = record_of(variant)
    if not is_file(record):
        return None, ""
    entry = _read(read_text(record), shown(record)).get(name)
    return entry, "" if record.parent == GLSL else str(record)


def written(entries: Mapping[str, Verified]) -> str:
    """Return a record's text: the same for the same entries."""
    table = {name: {"canonical": hashes[0], "variant": hashes[1]} for name, hashes in sorted(entries.items())}
    return json.dumps({"format": 1, "variants": table}, indent=1) + "\n"


def read(record: Path) -> dict[str, Verified]:
    """Return what a record says, by the variants' names; raise ``SketchError`` for one that is not one."""
    return dict(_read(read_text(record), shown(record))) if record.is_file() else {}


@FILES.cached()
def _read(text: str, name: str) -> Mapping[str, Verified]:
    try:
        table = read_json(text)["variants"]
        return {key: (str(step["canonical"]), str(step["variant"])) for key, step in table.items()}
    except (ValueError, TypeError, KeyError, AttributeError):
        message = "not a record of fast variants; remove it, then `playground variants renew` writes it again"
        raise SketchError(message, file=name) from None
