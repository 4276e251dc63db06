"""Tell what a name in a pass's size or repeat stands for, whatever its number is then."""

from __future__ import annotations

from typing import NamedTuple

from playground.errors import PlaygroundError
from playground.sketch.assign import find_targets, resolve
from playground.sketch.expressions import CLOCKS
from playground.sketch.flat import Fed, Flat
from playground.sketch.model import PassSpec

CLOCK, SIZE, PICTURE, VALUE, COMPUTE = "clock", "size", "picture", "value", "compute"
TERRAIN, FRAME = "#terrain", "#frame"
"""The bases of the sketch's own passes: of the view the picture's size, of the others the terrain's."""

_AXES = {"x": 0, "y": 1}


class Named(NamedTuple):
    """What a name stands for."""

    kind: str  # CLOCK, SIZE of a pass or a base, PICTURE: an image file's size, VALUE, COMPUTE
    path: str = ""  # of the pass, or TERRAIN or FRAME; of the leaf parameter
    axis: int = 0  # of a size: 0 along x, 1 along y


def base_of(path: str) -> str:
    """Return whose size a pass has unless it says another: that of the technique around it, or a base."""
    return path.rpartition(".")[0] or (FRAME if path == "view" else TERRAIN)


def named(flat: Flat, prefix: str, spec: PassSpec, name: str) -> Named:
    """Return what a name means in an expression of a pass of the technique at ``prefix``.

    Raises ``KeyError`` for what it does not know.
    """
    if name in CLOCKS:
        return Named(CLOCK, name)
    head, _, axis = name.rpartition(".")
    if axis in _AXES and head == "size":
        return Named(SIZE, base_of(inside(prefix, spec.name)), _AXES[axis])
    if axis in _AXES and head.endswith(".size"):
        return _sized(flat, prefix, head.removesuffix(".size"), _AXES[axis])
    try:
        target = resolve(flat.graphs[prefix], name)[0]
    except PlaygroundError:
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
        output = dict(flat.specs[source.loop].feedback)[source.name]
        source = flat.outputs[source.loop][output]
    if source is None:
        raise KeyError(name)
    return Named(SIZE, source.path, axis)


def inside(prefix: str, name: str) -> str:
    """Return the path of what has a name in the technique at ``prefix``."""
    return f"{prefix}.{name}" if prefix else name
