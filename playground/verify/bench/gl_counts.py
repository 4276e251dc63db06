"""Count and time what a frame asks of OpenGL through moderngl: draws, what is bound, bytes that are moved."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain
from typing import Any

import moderngl

_CALLS: dict[str, tuple[tuple[type, str], ...]] = {
    "draw calls": ((moderngl.VertexArray, "render"), (moderngl.VertexArray, "render_indirect")),
    "dispatches": ((moderngl.ComputeShader, "run"),),
    "textures bound": ((moderngl.Texture, "use"), (moderngl.Texture, "bind_to_image")),
    "samplers bound": ((moderngl.Sampler, "use"),),
    "framebuffers bound": ((moderngl.Framebuffer, "use"),),
    "mipmaps made": ((moderngl.Texture, "build_mipmaps"),),
    "copies of framebuffers": ((moderngl.Context, "copy_framebuffer"),),
    "waits": ((moderngl.Context, "finish"),),
}
_MOVED: tuple[tuple[type, str], ...] = (
    (moderngl.Texture, "write"),
    (moderngl.Texture, "read"),
    (moderngl.Buffer, "write"),
    (moderngl.Buffer, "read"),
)
_OTHERS: tuple[tuple[type, str], ...] = (
    (moderngl.Context, "enable_direct"),
    (moderngl.Context, "disable_direct"),
    (moderngl.Context, "disable"),
    (moderngl.Context, "texture"),
    (moderngl.Context, "memory_barrier"),
)
BYTES = "bytes moved"


@contextmanager
def counted() -> Iterator[dict[str, int]]:
    """Count within, by kind; what is created meanwhile, and its first texels, are not counted."""
    counts = dict.fromkeys((*_CALLS, BYTES), 0)
    changed: list[tuple[type, str, Any]] = []

    def count(kind: str, owner: type, name: str, amount: Callable[[Any, Any], int]) -> None:
        own = getattr(owner, name)

        def call(*arguments: Any, **named: Any) -> Any:
            result = own(*arguments, **named)
            counts[kind] += amount(arguments, result)
            return result

        changed.append((owner, name, own))
        setattr(owner, name, call)

    try:
        for kind, calls in _CALLS.items():
            for owner, name in calls:
                count(kind, owner, name, lambda arguments, result: 1)
        for owner, name in _MOVED:
            count(BYTES, owner, name, _size_of)
        yield counts
    finally:
        for owner, name, own in changed:
            setattr(owner, name, own)


@dataclass
class Spent:
    """The time that calls took."""

    milliseconds: float = 0.0


@contextmanager
def timed_calls() -> Iterator[Spent]:
    """Time what happens inside the calls of OpenGL that drawing makes, but for those that set uniforms."""
    spent = Spent()
    clock = time.perf_counter
    changed: list[tuple[type, str, Any]] = []
    try:
        for owner, name in (*chain(*_CALLS.values()), *_MOVED, *_OTHERS):
            own = getattr(owner, name)

            def call(*arguments: Any, own: Any = own, **named: Any) -> Any:
                start = clock()
                try:
                    return own(*arguments, **named)
                finally:
                    spent.milliseconds += (clock() - start) * 1e3

            changed.append((owner, name, own))
            setattr(owner, name, call)
        yield spent
    finally:
        for owner, name, own in changed:
            setattr(owner, name, own)


def _size_of(arguments: tuple[Any, ...], result: Any) -> int:
    """Return the bytes that a call gave or was given."""
    moved = result if isinstance(result, bytes) else arguments[1] if len(arguments) > 1 else b""
    return moved.size if isinstance(moved, moderngl.Buffer) else memoryview(moved).nbytes
