"""What a sketch's graph says of its picture: whether it moves, whose inputs it reads. Cached by graph."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from playground.memo import GRAPHS
from playground.shader.expressions import follows_time
from playground.sketch.model import Draw, Graph, Kernel, Parameter, PlainShader, Sketch, Technique, kernels_of

_MOVING = frozenset({"time", "bands", "frame", "frame_of_time", "delta", "date", "date_from_1"})
_DEVICES = frozenset({"microphone", "camera"})
_MOUSE = frozenset({"mouse", "hover", "hover_share", "drag", "buttons"})
_CAMERA = ("clip_from_world", "world_from_clip", "eye")


@dataclass(frozen=True, slots=True)
class Traits:
    """What a graph reads."""

    moves: bool  # by time, keyframes apart
    counts: bool  # a size or a number of steps names time
    camera: bool  # the camera moves something in the picture
    mouse: bool  # a plain shader reads the mouse
    keys: bool  # a source reads the keyboard
    devices: bool  # a source reads a microphone or a camera
    files: tuple[tuple[str, Parameter], ...]  # parameters that name files, by the paths of the leaves
    draws: tuple[tuple[str, Draw], ...]  # kernels that draw meshes
    faster: tuple[tuple[str, Kernel], ...]  # kernels with a menu of which previews have another choice


def traits_of(sketch: Sketch) -> Traits:
    """Return the traits of a sketch's graph."""
    return _traits(sketch.graph)


def is_animated(sketch: Sketch) -> bool:
    """Say whether the picture may differ from moment to moment."""
    return bool(sketch.keyframes) or traits_of(sketch).moves


def has_moving_counts(sketch: Sketch) -> bool:
    """Say whether sizes and numbers of steps may differ from moment to moment."""
    return bool(sketch.keyframes) or traits_of(sketch).counts


@GRAPHS.cached(identities=1)
def _traits(graph: Graph) -> Traits:
    kernels = list(kernels_of(graph))
    plain = {id(kernel) for _, kernel in kernels if isinstance(kernel, PlainShader)}
    files = [(f"{at}.{p.name}", p) for at, k in kernels for p in k.parameters if p.widget.kind == "file"]
    counts = any(follows_time(text) for text in _counts_of(graph))
    return Traits(
        moves=counts
        or any(k.reads("time") for _, k in kernels if id(k) not in plain)
        or any(meaning in _MOVING for _, k in kernels for _, meaning in k.usual),
        counts=counts,
        camera=any(kernel.reads(name) for _, kernel in kernels for name in _CAMERA),
        mouse=any(meaning in _MOUSE for _, k in kernels for _, meaning in k.usual),
        keys=any("keys" in kernel.depends for _, kernel in kernels),
        devices=any(not _DEVICES.isdisjoint(kernel.depends) for _, kernel in kernels),
        files=tuple(files),
        draws=tuple((path, kernel) for path, kernel in kernels if isinstance(kernel, Draw)),
        faster=tuple(
            (path, kernel)
            for path, kernel in kernels
            if any(p.widget.preview is not None for p in kernel.parameters)
        ),
    )


def _counts_of(technique: Technique) -> Iterator[str]:
    """Yield the expressions of a technique's sizes and numbers of steps."""
    if isinstance(technique, Kernel):
        yield from technique.counts
        return
    for spec in technique.passes:
        yield from (spec.repeat, *(spec.size or ()))
        yield from _counts_of(spec.technique)
