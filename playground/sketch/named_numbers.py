"""Tell what a name in a pass's size or repeat stands for, whatever its number is then."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import NamedTuple

from playground.errors import PlaygroundError
from playground.sketch.assign import find_targets, resolve
from playground.sketch.expressions import CLOCKS, COUNTERS, ITERATION, names_in
from playground.sketch.flat import Fed, Flat, Shape
from playground.sketch.identity import Identity
from playground.sketch.model import PassSpec

CLOCK, SIZE, PICTURE, VALUE, COMPUTE = "clock", "size", "picture", "value", "compute"
COUNTER, FED, UNWIRED = "counter", "fed", "unwired"
TERRAIN, FRAME = "#terrain", "#frame"
"""The bases of the sketch's own passes: of the view the picture's size, of the others the terrain's."""

_AXES = {"x": 0, "y": 1}


class Named(NamedTuple):
    """What a name stands for."""

    kind: str  # SIZE of a pass or a base, PICTURE: an image file's size, UNWIRED: 1, or another of the above
    path: str = ""  # of the pass, or TERRAIN or FRAME; of the leaf parameter; of a COUNTER's or FED's loop
    axis: int = 0  # of a size: 0 along x, 1 along y
    name: str = ""  # of a CLOCK or a COUNTER; of FED, whose size is what its loop feeds back


def base_of(path: str) -> str:
    """Return whose size a pass has unless it says another: that of the technique around it, or a base."""
    return path.rpartition(".")[0] or (FRAME if path == "view" else TERRAIN)


def loops_around(specs: Mapping[str, PassSpec], path: str) -> tuple[str, ...]:
    """Return the passes with a repeat that a pass at any level is in, outermost first, itself included."""
    parts = path.split(".")
    paths = [".".join(parts[: count + 1]) for count in range(len(parts))]
    return tuple([each for each in paths if each in specs and specs[each].repeat])


def counting(flat: Flat) -> frozenset[str]:
    """Return the loops of whose iterations each may have sizes and counts of its own, by path."""
    return _counting(Identity(flat.shape))


@lru_cache(maxsize=32)
def _counting(key: Identity[Shape]) -> frozenset[str]:
    shape, found = key.object, set[str]()
    for path, spec in shape.specs.items():
        around = loops_around(shape.specs, path)
        texts = [(text, around[-1:]) for text in spec.size or ()]
        texts += [(spec.repeat, around[:-1][-1:])] if spec.repeat else []
        graph = shape.graphs.get(path.rpartition(".")[0])  # None inside what a fast variant replaces
        if graph is not None and not find_targets(graph, ITERATION):
            found.update(*(loop for text, loop in texts if ITERATION in names_in(text)))
    return frozenset(found)


def named(flat: Flat, path: str, name: str, *, repeat: bool = False) -> Named:
    """Return what a name means in the size, or the ``repeat``, of the pass at a path.

    Raises ``KeyError`` for what it does not know.
    """
    prefix, spec = path.rpartition(".")[0], flat.specs[path]
    if name in CLOCKS:
        return Named(CLOCK, name=name)
    head, _, axis = name.rpartition(".")
    if axis in _AXES and head == "size":
        return Named(SIZE, base_of(inside(prefix, spec.name)), _AXES[axis])
    if axis in _AXES and head.endswith(".size"):
        return _sized(flat, prefix, head.removesuffix(".size"), _AXES[axis])
    try:
        target = resolve(flat.graphs[prefix], name)[0]
    except PlaygroundError:
        if name in COUNTERS:
            around = loops_around(flat.specs, path)
            around = around[:-1] if repeat else around
            return Named(COUNTER, around[-1] if around else "", name=name)
        if name != COMPUTE:
            raise KeyError(name) from None
        return Named(COMPUTE)
    return Named(VALUE, inside(prefix, target.path))


def _sized(flat: Flat, prefix: str, name: str, axis: int) -> Named:
    """Return the size of the picture that a parameter reads, of a pass, or of what feeds an input."""
    target = next(iter(find_targets(flat.graphs[prefix], name)), None)
    if target is not None and target.parameter.widget.kind == "file":
        return Named(PICTURE, inside(prefix, target.path), axis)
    path = inside(prefix, name)
    if path in flat.specs:
        return Named(SIZE, path, axis)
    source = flat.wires[prefix][name]
    if isinstance(source, Fed):
        return Named(FED, source.loop, axis, source.name)
    if source is None:  # what is read there is one texel
        return Named(UNWIRED)
    return Named(SIZE, source.path, axis)


def inside(prefix: str, name: str) -> str:
    """Return the path of what has a name in the technique at ``prefix``."""
    return f"{prefix}.{name}" if prefix else name
