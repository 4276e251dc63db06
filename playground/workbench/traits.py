"""What a sketch's graph says of its picture: whether it moves, whose inputs it reads. Cached by graph."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from playground.sketch.identity import Identity
from playground.sketch.model import Graph, Kernel, Parameter, Sketch, Technique, kernels_of
from playground.sketch.reserved_names import PLAIN_UNIFORMS

_MOVING = frozenset(n for meaning in ("time", "frame", "delta", "date") for n in PLAIN_UNIFORMS[meaning])
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
    files = [(f"{at}.{p.name}", p) for at, k in kernels for p in k.parameters if p.widget.kind == "file"]
    return Traits(
        moves=any(map(_moves, (kernel for _, kernel in kernels))) or _repeats_by_time(key.object),
        camera=any(kernel.reads(name) for _, kernel in kernels for name in _CAMERA),
        mouse=any(_is_plain(k) and any(map(k.reads, PLAIN_UNIFORMS["mouse"])) for _, k in kernels),
        files=tuple(files),
        draws=tuple((path, kernel) for path, kernel in kernels if kernel.kind == "draw"),
        arcs=any(p.follows for _, k in kernels for p in k.parameters),
    )


def _is_plain(kernel: Kernel) -> bool:
    return kernel.kind.startswith("plain")


def _moves(kernel: Kernel) -> bool:
    names = _MOVING if _is_plain(kernel) else {"time"}
    return "time" in kernel.repeat or any(kernel.reads(name) for name in names)


def _repeats_by_time(technique: Technique) -> bool:
    if not isinstance(technique, Graph):
        return False
    return any("time" in spec.repeat or _repeats_by_time(spec.technique) for spec in technique.passes)
