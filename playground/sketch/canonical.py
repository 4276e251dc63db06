"""Hash what a technique's text says, so that two versions of it can be compared.

The text of a kernel counts as the compiler takes it: with its includes, without comments,
with any white space. Of a technique of several passes each pass counts, and how they are
wired. What a person reads besides (titles, labels, tooltips, units) does not; nor do names of
files, nor fast variants.
"""

from __future__ import annotations

import hashlib
import re
from functools import lru_cache
from typing import Any

from playground.sketch.identity import Identity
from playground.sketch.model import Graph, Kernel, Parameter, Technique

_TOKEN = re.compile(
    r"[A-Za-z_]\w*"
    r"|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?\w*"
    r"|<<=|>>=|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||\^\^|[-+*/%&|^]="
    r"|\S"
)


def content_of(technique: Technique) -> str:
    """Return the hash of a technique's canonical text; worked out once for each object."""
    return _content_of(Identity(technique))


@lru_cache(maxsize=2048)
def _content_of(key: Identity[Technique]) -> str:
    technique = key.object
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
    more = [[p.when, p.choices] for p in graph.passes if p.when or p.choices]
    return [*exports, graph.outputs, passes, graph.agrees, *more]


def _of_kernel(kernel: Kernel) -> list[Any]:
    header: list[Any] = [kernel.kind, kernel.registry, kernel.blend, kernel.depth, kernel.samples]
    header += [kernel.repeat, kernel.accepts, kernel.visits, kernel.stride, kernel.at_once, kernel.count]
    header += [kernel.groups, kernel.local, kernel.aligned, kernel.stages, kernel.overwrites]
    header += [(b.name, b.type, b.count) for b in kernel.buffers]
    header += [(o.name, o.format) for o in kernel.outputs]
    header += [(i.name, _sampling(i), i.fallback) for i in kernel.inputs]
    header += [_parameter(p) for p in kernel.parameters]
    # Only where it is there, as in ``_of_graph``.
    more = [kernel.own_accepts] if kernel.own_accepts else []
    more += [kernel.instances] if kernel.instances else []
    more += [f"in place: {kernel.in_place}"] if kernel.in_place else []
    more += [f"active: {kernel.active}"] if kernel.active else []
    more += [f"over: {kernel.over}"] if kernel.over else []
    return [header, kernel.agrees, compiled_text(kernel.source.code), *more]


def _parameter(parameter: Parameter) -> tuple[Any, ...]:
    widget = parameter.widget
    what: tuple[Any, ...] = (widget.kind, widget.low, widget.high, widget.choices)
    more = (widget.values, widget.axes, widget.raw)
    what += more if any(more) else ()  # as in ``_of_kernel``
    return parameter.name, parameter.type, parameter.default, what, _sampling(parameter)


def _sampling(read: Any) -> tuple[Any, ...]:
    return read.sampling.filter, read.sampling.wrap, read.sampling.mipmap


def compiled_text(code: str) -> str:
    """Return a text without comments as a compiler takes it: tokens, one space between each two.

    A line of the preprocessor stays a line, with its spaces: they can mean something there.
    """
    found: list[str] = []
    for line in code.split("\n"):
        if line.lstrip().startswith("#"):
            found.append(f"\n{' '.join(line.split())}\n")
        else:
            found += _TOKEN.findall(line)
    return " ".join(found)
