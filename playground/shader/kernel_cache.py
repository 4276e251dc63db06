"""Cache parsed kernels for as long as the files that they were made of stay the same.

A live session reads its sketch again at every save, and most of its kernels have not
changed; parsing them all again would take longer than drawing. A cached kernel is
also the same object, by whose identity other caches go.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar, cast

from playground.memo import FILES, GRAPHS
from playground.shader.header import parse_kernel
from playground.shader.kernel import Kernel, Variant
from playground.shader.source import Origin, read_source_and_origin

_AnyKernel = TypeVar("_AnyKernel", bound=Kernel)


def parsed_kernel(name: str, path: Path, roots: Sequence[Path]) -> Kernel | None:
    """Return what ``parse_kernel`` makes of a file, parsed again only if anything it is made of changed."""
    key = (parsed_kernel, name, path, tuple(roots))
    cached: tuple[Kernel | None, Origin] | None = FILES.get(key)
    if cached is None or not cached[1].holds():
        source, origin = read_source_and_origin(path, roots)
        cached = FILES.put(key, (parse_kernel(name, source), origin))
    return cached[0]


def replaced(kernel: _AnyKernel, **changes: Any) -> _AnyKernel:
    """Return a kernel with some fields replaced: the same object for the same kernel and changes."""
    key = (replaced, id(kernel), *((name, _identity(value)) for name, value in changes.items()))
    cached: _AnyKernel | None = GRAPHS.get(key)
    # What it is made of is held too, so that its identity is not given to another object.
    return cached or cast(_AnyKernel, GRAPHS.put(key, replace(kernel, **changes), 1, kernel, changes))


def _identity(value: Any) -> Any:
    """Return what a value is known by: kernels are large, so those of fast variants by which they are.

    Passes of a variant are read again with each sketch, so they are known by what they are made of.
    """
    if isinstance(value, tuple):
        return tuple(_identity(element) for element in value)
    if not isinstance(value, Variant):
        return value
    technique = id(value.technique) if isinstance(value.technique, Kernel) else value.technique
    return technique, value.verified, value.record
