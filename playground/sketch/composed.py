"""Compose two techniques: ``use = "A(B)"`` fills a pass with A, which reads what B gives.

So another tool's picture becomes heights, ``foreign/height(./waves)``, and another tool's filter is laid
over a frame, ``./film(view/terrain)``. All of B stays within reach under its own names; A comes after
it, as one more pass.
"""

from __future__ import annotations

import re
from dataclasses import replace
from functools import lru_cache

from playground.errors import Diagnostic, SketchError
from playground.shader.kernel_cache import replaced
from playground.sketch.identity import Identity
from playground.sketch.model import Export, Graph, Kernel, Output, PassSpec, PlainFragment, Technique
from playground.sketch.wiring import input_names, output_names

_COMPOSED = re.compile(r"\s*([^()\s]+)\s*\((.*)\)\s*", re.DOTALL)
_FIRST = ("inputImage", "startImage", "iChannel0", "u_tex0", "texture0", "backbuffer")
"""What other tools call the picture that a filter is laid over, in the order in which it is looked for."""

_KEPT = {"r8": "r32f", "rg8": "rg32f", "rgba8": "rgba32f"}
"""In which format a picture keeps all its numbers."""


def parts_of(use: str) -> tuple[str, str] | None:
    """Return what is outside and what is inside the brackets of "A(B)"; None for a plain name."""
    found = _COMPOSED.fullmatch(use)
    return (found[1], found[2].strip()) if found and found[2].strip() else None


def first_input(technique: Technique) -> str:
    """Return the input that takes what is in the brackets; "" where a technique has none."""
    names = input_names(technique)
    return next((name for name in _FIRST if name in names), names[0] if names else "")


def is_foreign(technique: Technique) -> bool:
    """Return whether a technique's picture is that of another tool's shader, or of a plain one."""
    if isinstance(technique, Graph):
        return is_foreign(technique.parts[0]) if technique.parts else bool(technique.dialect)
    return isinstance(technique, PlainFragment)


def composed(use: str, outer: Technique, inner: Technique) -> Graph:
    """Return the technique of "outer(inner)"; the same two give the same object.

    A picture of another tool that a kernel reads keeps all its numbers: 32-bit floats, not bytes.
    Raises ``SketchError`` where the outer technique reads nothing.
    """
    if not first_input(outer):
        name = parts_of(use)
        raise SketchError(f"use = '{use}': {name[0] if name else use} reads no picture; it has no input")
    return _composed(use, Identity(outer), Identity(inner))


@lru_cache(maxsize=64)
def _composed(use: str, outer_key: Identity[Technique], inner_key: Identity[Technique]) -> Graph:
    outer, inner = outer_key.object, inner_key.object
    names = parts_of(use)
    assert names is not None  # or nothing would be composed
    if not is_foreign(outer) and is_foreign(inner):
        inner = _exact(inner)
    before = _passes(inner, names[1])
    last = _free(_short(names[0]), {spec.name for spec in before})
    fed = first_input(outer)
    outputs = output_names(inner)
    output = fed if fed in outputs else outputs[0]
    opened = isinstance(inner, Graph) and not inner.variants
    source = dict(inner.outputs).get(output) if isinstance(inner, Graph) and opened else ""
    wire = source or f"{before[-1].name}:{output}"
    parameters = _exports(inner, before[0].name, "parameters") + _own(outer, last, "parameters", "")
    inputs = _exports(inner, before[0].name, "inputs") + _own(outer, last, "inputs", fed)
    return Graph(
        use,
        outer.path,
        (*before, PassSpec(last, names[0], outer, inputs=((fed, wire),), file=outer.path)),
        parameters=_distinct(parameters, last),
        inputs=_distinct(inputs, last),
        title=outer.title if is_foreign(outer) else inner.title or outer.title,
        warnings=(*_warnings(inner), *_warnings(outer)),
        parts=(outer, inner_key.object),
    )


def _passes(technique: Technique, use: str) -> tuple[PassSpec, ...]:
    if isinstance(technique, Graph) and not technique.variants:
        return technique.written.passes
    return (PassSpec(_free(_short(use), set()), use, technique, file=technique.path),)


def _exact(technique: Technique) -> Technique:
    """Return another tool's technique whose picture keeps all its numbers."""
    if isinstance(technique, Kernel):
        outputs = tuple(Output(o.name, _KEPT.get(o.format, o.format)) for o in technique.outputs)
        return replaced(technique, outputs=outputs)
    *others, last = technique.written.passes
    return replace(technique.written, passes=(*others, replace(last, technique=_exact(last.technique))))


def _exports(technique: Technique, name: str, what: str) -> list[Export]:
    if isinstance(technique, Graph) and not technique.variants:
        return list(getattr(technique, what))
    return [Export(one.name, (f"{name}.{one.name}",)) for one in getattr(technique, what)]


def _own(technique: Technique, name: str, what: str, fed: str) -> list[Export]:
    """Return what a pass of its own exports, all but the input that is fed."""
    names = [one.name for one in getattr(technique, what)]
    return [Export(one, (f"{name}.{one}",)) for one in names if one != fed]


def _distinct(exports: list[Export], prefix: str) -> tuple[Export, ...]:
    """Return exports of which no two have one name: the later of two gets its pass's name before it."""
    found: dict[str, Export] = {}
    for export in exports:
        name = export.name if export.name not in found else _free(f"{prefix}_{export.name}", {*found})
        found[name] = replace(export, name=name)
    return tuple(found.values())


def _warnings(technique: Technique) -> tuple[Diagnostic, ...]:
    return technique.warnings if isinstance(technique, Graph) else ()


def _short(use: str) -> str:
    name = re.sub(r"\W", "_", use.partition("(")[0].rpartition("/")[2])
    return name if name[:1].isalpha() else f"pass_{name}"


def _free(name: str, taken: set[str]) -> str:
    while name in taken:
        name += "_"
    return name
