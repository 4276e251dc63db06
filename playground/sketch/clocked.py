"""Put what changes from frame to frame inside the loops over frames that read it.

A loop that counts frames shows each of its frames what it reads as it was then: a film has another
picture, a kernel another time. Outside of the loop they would be what they are at the end, in all its
frames, and each new moment would start the loop anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from playground.sketch.expressions import counts_frames, follows_time
from playground.sketch.flat import Leaf, Loop, Node, Ref, leaves_of
from playground.sketch.model import Kernel
from playground.sketch.reserved_names import CLOCKED


def with_clocked_inside(nodes: Sequence[Node]) -> list[Node]:
    """Return nodes, each after what it reads, with what changes from frame to frame inside such loops.

    What another loop reads that the loop reads as well stays outside.
    """
    found = list(nodes)
    for loop in [node for node in nodes if isinstance(node, Loop) and counts_frames(node.repeat)]:
        index = next(i for i, node in enumerate(found) if node.path == loop.path)
        moved = _to_move(found[:index], loop)
        if moved:
            body = tuple(node for node in found[:index] if node.path in moved and isinstance(node, Leaf))
            before = [node for node in found[:index] if node.path not in moved]
            after = [node for node in before if _reads(node) & moved]
            while more := [n for n in before if n not in after and _reads(n) & {a.path for a in after}]:
                after += more
            later = [node for node in before if node in after]
            inside = replace(loop, body=(*body, *loop.body))
            found = [*(n for n in before if n not in after), inside, *later, *found[index + 1 :]]
    return found


def _to_move(earlier: Sequence[Node], loop: Loop) -> set[str]:
    """Return the paths of the leaves to move into a loop."""
    needed, wanted = [], _reads(loop)
    for node in reversed(earlier):
        if {leaf.path for leaf in leaves_of([node])} & wanted:
            needed.append(node)
            wanted |= _reads(node)
    moved: set[str] = set()
    for node in reversed(needed):
        if isinstance(node, Leaf) and (_is_clocked(node.kernel) or _reads(node) & moved):
            moved.add(node.path)
    staying = [node for node in needed if node.path not in moved]
    while staying:  # what stays before the loop, and all that it reads
        read = set[str]().union(*(_reads(node) for node in staying))
        staying = [node for node in needed if node.path in read & moved]
        moved -= {node.path for node in staying}
    return moved


def _is_clocked(kernel: Kernel) -> bool:
    if follows_time(kernel.repeat):  # what it does of each frame is its own
        return False
    return bool(kernel.depends) or kernel.reads("time") or any(m in CLOCKED for _, m in kernel.usual)


def _reads(node: Node) -> set[str]:
    found: set[str] = set()
    for leaf in leaves_of([node]):
        found |= {source.path for _, source in leaf.inputs if isinstance(source, Ref)}
    if isinstance(node, Loop):
        found |= _first_reads(node)
        found -= _own(node)
    return found


def _first_reads(loop: Loop) -> set[str]:
    found = {first.path for _, first, _ in loop.feedback if isinstance(first, Ref)}
    return found.union(*(_first_reads(node) for node in loop.body if isinstance(node, Loop)))


def _own(loop: Loop) -> set[str]:
    return {leaf.path for leaf in leaves_of(loop.body)}
