"""The passes of a sketch as a graph: which reads which, and where each is drawn.

A pass is one column right of the last that it reads, as in Sugiyama, Tagawa and Toda
1981, "Methods for Visual Understanding of Hierarchical System Structures"; within a column
passes are put in the order of the middle of those that they are joined to.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from playground.errors import counted
from playground.sketch.flat import Fed, Flat, Ref, leaves_of
from playground.sketch.flatten import flatten
from playground.sketch.model import Sketch
from playground.studio.session import Session

Edge = tuple[str, str]
"""From who gives to who reads."""
_SWEEPS = 4


@dataclass(frozen=True)
class Wiring:
    """A sketch's passes as a graph with a layout."""

    refs: Mapping[str, str]  # each node's texture, "pass:output", by the node's path; in the order they run
    edges: tuple[Edge, ...]
    places: Mapping[str, tuple[int, int]]  # column from the left, row from above


def wiring_of(sketch: Sketch, *, inner: bool) -> Wiring:
    """Return the graph of a sketch's own passes, or of all passes that run, those inside techniques."""
    flat = flatten(sketch)
    refs: dict[str, str] = {}
    edges: dict[Edge, None] = {}
    for leaf in leaves_of(flat.nodes):
        node = leaf.path if inner else leaf.path.partition(".")[0]
        refs.setdefault(node, _main(flat, node))
        for _, source in leaf.inputs:
            giver = _giver(flat, source)
            giver = giver if inner else giver.partition(".")[0]
            if giver and giver != node and not isinstance(source, Fed):
                edges[giver, node] = None
    return Wiring(refs, tuple(edges), node_grid(tuple(refs), tuple(edges)))


def cost_of(session: Session, node: str) -> tuple[str, bool, float | None]:
    """Return how often a pass ran, as "3 runs", whether it did for the last picture, and its time [ms].

    What is inside it counts. Without a time None.
    """
    engine = session.engine
    inside = [path for path in engine.runs if path == node or path.startswith(f"{node}.")]
    spent = [session.times[path] for path in inside if path in session.times]
    runs = counted(sum(engine.runs[path] for path in inside), "run")
    return runs, any(path in inside for path in engine.record.ran), sum(spent) if spent else None


def node_grid(nodes: Sequence[str], edges: Sequence[Edge]) -> dict[str, tuple[int, int]]:
    """Return a column and a row for each node; every edge goes to the right, no two nodes share a place.

    The nodes are in an order in which each comes after those that it reads.
    """
    column = dict.fromkeys(nodes, 0)
    for node in nodes:
        column[node] = max((column[giver] + 1 for giver, reader in edges if reader == node), default=0)
    columns = [[n for n in nodes if column[n] == c] for c in range(max(column.values(), default=-1) + 1)]
    row = {node: float(r) for each in columns for r, node in enumerate(each)}
    for sweep in range(_SWEEPS):
        for each in columns if sweep % 2 == 0 else columns[::-1]:
            middles = {node: _middle(node, edges, row, sweep % 2) for node in each}
            each.sort(key=lambda node: middles[node])
            row |= {node: float(r) for r, node in enumerate(each)}
    return {node: (c, r) for c, each in enumerate(columns) for r, node in enumerate(each)}


def _middle(node: str, edges: Sequence[Edge], row: Mapping[str, float], backwards: int) -> float:
    """Return the mean row of those on one side that a node is joined to; its own where there is none."""
    near = [row[edge[backwards]] for edge in edges if edge[1 - backwards] == node]
    return sum(near) / len(near) if near else row[node]


def _giver(flat: Flat, source: object) -> str:
    return source.path if isinstance(source, Ref) and source.path.partition(".")[0] in flat.specs else ""


def _main(flat: Flat, node: str) -> str:
    """Return a node's texture: that of its own name, else its first."""
    outputs = flat.outputs[node]
    name = node.rpartition(".")[2]
    return f"{node}:{name if name in outputs else next(iter(outputs))}"
