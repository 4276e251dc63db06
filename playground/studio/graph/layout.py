"""Where the passes of a graph are drawn: in columns, with wires that go around the nodes between.

A pass is in one column right of the last that it reads, as in Sugiyama, Tagawa and Toda 1981, "Methods for
Visual Understanding of Hierarchical System Structures"; one that reads nothing is near its first reader, in
a column with room for it. A wire that crosses columns has an invisible node in each, one for all wires of a
pass. Within a column nodes are in the order of the middle of those that they are joined to, and each is as
near to that middle as the others leave room for; no column is higher than the fullest needs to be.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from playground.studio.picture.view import Place

Edge = tuple[str, str]
"""From who gives to who reads."""
LANE = 0.22
"""Height of the room that a wire has where it crosses a column; a node's is 1."""
GAP = 0.2
"""Between two nodes of a column, in heights of a node."""

_SWEEPS = 8
_WIDE = 0.8  # of a node, in columns: what is so far apart has room between
_Node = str | tuple[str, int]  # a pass, or where the wires of one cross a column


@dataclass(frozen=True)
class Layout:
    """A graph's nodes: ``y`` is that of their middle, downwards, in heights of a node."""

    places: Mapping[str, Place]  # of each pass: column from the left, y
    lanes: Mapping[tuple[str, int], float]  # of the wires of a pass in a column that they cross: y

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """The first column, the upper edge of the highest node, the last column, the lower edge."""
        columns = [column for column, _ in self.places.values()] or [0.0]
        tops = [y - 0.5 for _, y in self.places.values()] + [y - LANE / 2 for y in self.lanes.values()]
        ends = [y + 0.5 for _, y in self.places.values()] + [y + LANE / 2 for y in self.lanes.values()]
        return min(columns), min(tops, default=0.0), max(columns), max(ends, default=0.0)

    def route(self, edge: Edge) -> list[tuple[int, float]]:
        """Return the columns that a wire crosses between its nodes, and where."""
        (first, _), (last, _) = self.places[edge[0]], self.places[edge[1]]
        columns = range(math.ceil(first + _WIDE), math.floor(last - _WIDE) + 1)
        return [(c, self.lanes[edge[0], c]) for c in columns if (edge[0], c) in self.lanes]

    def moved(self, places: Mapping[str, Place]) -> Layout:
        """Return the layout with some nodes elsewhere; the others, and the lanes, stay where they are."""
        own = {node: place for node, place in places.items() if node in self.places}
        return replace(self, places={**self.places, **own}) if own else self


def layout_of(nodes: Sequence[str], edges: Sequence[Edge]) -> Layout:
    """Return where nodes and wires are; wires go to the right, and nothing overlaps.

    Edges that would close a circle are left out of it.
    """
    column = _columns(nodes, edges)
    forward = [(a, b) for a, b in edges if column[a] < column[b]]
    cells: dict[int, list[_Node]] = {c: [] for c in range(max(column.values(), default=-1) + 1)}
    for node in nodes:
        cells[column[node]].append(node)
    links: dict[tuple[_Node, _Node], None] = {}
    for giver, reader in forward:
        before: _Node = giver
        for c in range(column[giver] + 1, column[reader]):
            lane = giver, c
            if lane not in cells[c]:
                cells[c].append(lane)
            links[before, lane] = None
            before = lane
        links[before, reader] = None
    givers: dict[_Node, list[_Node]] = {}
    readers: dict[_Node, list[_Node]] = {}
    for a, b in links:
        readers.setdefault(a, []).append(b)
        givers.setdefault(b, []).append(a)
    order: dict[_Node, float] = {n: float(r) for row in cells.values() for r, n in enumerate(row)}
    for sweep in range(_SWEEPS):
        near = givers if sweep % 2 == 0 else readers
        for c in sorted(cells, reverse=sweep % 2 == 1):
            middles = {n: _mean([order[m] for m in near.get(n, ())], order[n]) for n in cells[c]}
            cells[c].sort(key=lambda n: middles[n])
            order |= {n: float(r) for r, n in enumerate(cells[c])}
    y: dict[_Node, float] = dict(order)
    around: Mapping[_Node, list[_Node]] = {n: givers.get(n, []) + readers.get(n, []) for n in order}
    highest = max((sum(map(_high, row)) + GAP * (len(row) - 1) for row in cells.values()), default=0.0)
    for sweep in range(_SWEEPS):
        for c in sorted(cells, reverse=sweep % 2 == 1):
            wanted = [_mean([y[m] for m in around[n]], y[n]) for n in cells[c]]
            y |= dict(zip(cells[c], _spaced(wanted, cells[c], highest), strict=True))
    top = min((y[n] - _high(n) / 2 for n in y), default=0.0)
    return Layout(
        {node: (column[node], y[node] - top) for node in nodes},
        {n: y[n] - top for n in y if isinstance(n, tuple)},
    )


def _columns(nodes: Sequence[str], edges: Sequence[Edge]) -> dict[str, int]:
    """Return the column of each node; an edge to an earlier one counts where that closes no circle."""
    givers: dict[str, set[str]] = {node: set() for node in nodes}
    for giver, reader in edges:
        if giver in givers and reader in givers and giver != reader:
            givers[reader].add(giver)
    column: dict[str, int] = {}
    left = list(nodes)
    while left:
        node = next((n for n in left if givers[n] <= column.keys()), left[0])
        left.remove(node)
        column[node] = max((column[giver] + 1 for giver in givers[node] if giver in column), default=0)
    free = [node for node in nodes if not givers[node]]
    held = [c for node, c in column.items() if node not in free]
    most = max(-(-len(nodes) // (max(column.values(), default=0) + 1)), 2)
    for node in free:
        behind = [column[b] for a, b in edges if a == node and b != node and column.get(b, 0) > 0]
        places = range(max(min(behind, default=1) - 1, 0), -1, -1)
        column[node] = next((c for c in places if held.count(c) < most), min(places, key=held.count))
        held.append(column[node])
    return column


def _spaced(wanted: Sequence[float], row: Sequence[_Node], highest: float) -> list[float]:
    """Return the places nearest to those wanted, by their squares, at which nodes in a column do not touch.

    All of it is between 0 and ``highest``. By pools of adjacent violators, after the room that each node
    needs is taken out.
    """
    offset, offsets = 0.0, []
    for number, node in enumerate(row):
        offset += (_high(row[number - 1]) + _high(node)) / 2 + GAP if number else 0.0
        offsets.append(offset)
    pools: list[tuple[float, int]] = []  # mean, count
    for want, off in zip(wanted, offsets, strict=True):
        pools.append((want - off, 1))
        while len(pools) > 1 and pools[-2][0] > pools[-1][0]:
            (b, m), (a, n) = pools.pop(), pools.pop()
            pools.append(((a * n + b * m) / (n + m), n + m))
    low, most = _high(row[0]) / 2, highest - offset - _high(row[-1]) / 2
    flat = [min(max(mean, low), most) for mean, count in pools for _ in range(count)]
    return [x + off for x, off in zip(flat, offsets, strict=True)]


def _high(node: _Node) -> float:
    return LANE if isinstance(node, tuple) else 1.0


def _mean(values: Sequence[float], otherwise: float) -> float:
    return sum(values) / len(values) if values else otherwise


def nearest_node(layout: Layout, node: str, across: int, down: int, edges: Iterable[Edge] = ()) -> str:
    """Return the node that an arrow key leads to; where there is none, the node itself.

    ``across``: along a wire, else one column over. ``down``: the next in the column.
    """
    if node not in layout.places:
        return next(iter(layout.places), "")
    column, y = layout.places[node]
    if down:
        found = [n for n, (c, at) in layout.places.items() if abs(c - column) < _WIDE and (at - y) * down > 0]
    else:
        joined = {b if a == node else a for a, b in edges if node in (a, b)}
        aside = {n: (c - column) * across for n, (c, _) in layout.places.items() if (c - column) * across > 0}
        least = min(aside.values(), default=0.0)
        found = [n for n in aside if n in joined] or [n for n, c in aside.items() if c < least + _WIDE]

    def far(other: str) -> float:
        c, at = layout.places[other]
        return abs(c - column) + abs(at - y)

    return min(found, key=far, default=node)
