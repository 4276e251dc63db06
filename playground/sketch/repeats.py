"""The passes of a flattened sketch that repeat, and which of them a path stands for."""

from __future__ import annotations

from collections.abc import Iterator

from playground.sketch.flat import Loop, Node, leaves_of


def repeated_paths(nodes: tuple[Node, ...]) -> list[str]:
    """Return the paths of the passes that repeat, those inside loops included."""
    kernels = (leaf.path for leaf in leaves_of(nodes) if leaf.kernel.repeat != "1")
    return sorted({*_loops_of(nodes), *kernels})


def repeated_path(path: str, nodes: tuple[Node, ...]) -> str | None:
    """Return the pass that repeats and that a path stands for: itself, or the only one inside it."""
    valid = repeated_paths(nodes)
    if path in valid:
        return path
    inside = [name for name in valid if name.startswith(f"{path}.")]
    return inside[0] if len(inside) == 1 else None


def _loops_of(nodes: tuple[Node, ...]) -> Iterator[str]:
    for node in nodes:
        if isinstance(node, Loop):
            yield node.path
            yield from _loops_of(node.body)
