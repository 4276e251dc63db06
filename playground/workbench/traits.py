"""What a sketch's graph says of its picture: whether it moves, whose inputs it reads. Cached by graph."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from playground.sketch.identity import Identity
from playground.sketch.model import Graph, Kernel, Parameter, Sketch, kernels_of

_MOVING = frozenset({"time", "frame", "frame_of_time", "delta", "date"})
_MOUSE = frozenset({"mouse", "hover", "hover_share", "drag"})
_CAMERA = ("clip_from_world", "world_from_clip", "eye")


@dataclass(frozen=True, slots=True)
class Traits:
    """What a graph reads."""

    moves: bool  # by time, keyframes apart
    camera: bool  # the camera moves something in the picture
    mouse: bool  # a plain shader reads the mouse
    files: tuple[tuple[str, Parameter], ...]  # parameters that name files, by the paths of the leaves
    draws: tuple[tuple[str, Kernel], ...]  # kernels that draw meshes
    arcs: bool  # an angle follows a direction until it is set


def traits_of(sketch: Sketch) -> Traits:
    """Return the traits of a sketch's graph."""
    return _traits(Identity(sketch.graph))


def is_animated(sketch: Sketch) -> bool:
    """Say whether the picture may differ from moment to moment."""
    return bool(sketch.keyframes) or traits_of(sketch).moves


@lru_cache(maxsize=64)
def _traits(key: Identity[Graph]) -> Traits:
    kernels = list(kernels_of(key.object))
    plain = {id(kernel) for _, kernel in kernels if kernel.kind.startswith("plain")}
    files = [(f"{at}.{p.name}", p) for at, k in kernels for p in k.parameters if p.widget.kind == "file"]
    return Traits(
        moves=_repeats_by_time(key.object)
        or any("time" in k.repeat or (id(k) not in plain and k.reads("time")) for _, k in kernels)
        or any(meaning in _MOVING for _, k in kernels for _, meaning in k.usual),
        camera=any(kernel.reads(name) for _, kernel in kernels for name in _CAMERA),
        mouse=any(meaning in _MOUSE for _, k in kernels for _, meaning in k.usual),
        files=tuple(files),
        draws=tuple((path, kernel) for path, kernel in kernels if kernel.kind == "draw"),
        arcs=any(p.follows for _, k in kernels for p in k.parameters),
    )


def _repeats_by_time(graph: Graph) -> bool:
    return any(
        "time" in spec.repeat or (isinstance(spec.technique, Graph) and _repeats_by_time(spec.technique))
        for spec in graph.passes
    )
