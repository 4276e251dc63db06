"""Drainage in NumPy and Python, texel by texel: slow, serial, and independent of the library's passes."""

from __future__ import annotations

import heapq

import numpy as np

STEPS = [(y, x) for y in (-1, 0, 1) for x in (-1, 0, 1) if (y, x) != (0, 0)]


def edge_of(shape: tuple[int, ...]) -> np.ndarray:
    """Return where a grid's edge is."""
    edge = np.ones(shape, bool)
    edge[1:-1, 1:-1] = False
    return edge


def steepest_slopes(height: np.ndarray, spacing: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return (the slope down to each of the eight neighbours, their numbers), NaN off the grid; float64."""
    rows, columns = height.shape
    padded = np.pad(height.astype(float), 1, constant_values=np.nan)
    numbers = np.pad(np.arange(rows * columns).reshape(rows, columns), 1)
    slopes, targets = [], []
    for y, x in STEPS:
        window = slice(1 + y, 1 + y + rows), slice(1 + x, 1 + x + columns)
        slopes.append((height - padded[window]) / np.hypot(x * spacing[0], y * spacing[1]))
        targets.append(numbers[window])
    return np.stack(slopes), np.stack(targets)


def counted(receiver: np.ndarray, weight: np.ndarray | None = None) -> np.ndarray:
    """Return what drains through each texel, one texel after another, from the springs down.

    Raises ``AssertionError`` where ways go in a circle.
    """
    ways = receiver.astype(int).ravel()
    total = np.ones(ways.size) if weight is None else weight.astype(float).ravel().copy()
    donors = np.bincount(ways[ways != np.arange(ways.size)], minlength=ways.size)
    springs = list(np.flatnonzero(donors == 0))
    done = 0
    while springs:
        here = springs.pop()
        done += 1
        down = ways[here]
        if down == here:
            continue
        total[down] += total[here]
        donors[down] -= 1
        if donors[down] == 0:
            springs.append(down)
    assert done == ways.size, "no way goes in a circle"
    return total.reshape(receiver.shape)


def ends_of(receiver: np.ndarray) -> np.ndarray:
    """Return the number of the texel at which each way ends."""
    ways = receiver.astype(int).ravel()
    for _ in range(ways.size.bit_length()):
        ways = ways[ways]
    return ways.reshape(receiver.shape)


def flooded(height: np.ndarray, spacing: tuple[float, float], fall: float) -> np.ndarray:
    """Return the filled terrain by a priority flood, with a fall [height per metre] along its ways.

    After Barnes, Lehman and Mulla 2014, "Priority-flood", algorithm 3, in float64; texels may be
    visited again where a shorter way is found, as in Dijkstra's algorithm.
    """
    rows, columns = height.shape
    level = np.full(height.shape, np.inf)
    edge = edge_of(height.shape)
    level[edge] = height[edge]
    heap = [(float(level[y, x]), y, x) for y, x in np.argwhere(edge)]
    heapq.heapify(heap)
    while heap:
        here, y, x = heapq.heappop(heap)
        if here > level[y, x]:
            continue
        for down, along in STEPS:
            j, i = y + down, x + along
            if not (0 <= j < rows and 0 <= i < columns) or edge[j, i]:
                continue
            result = max(float(height[j, i]), here + fall * np.hypot(along * spacing[0], down * spacing[1]))
            if result < level[j, i]:
                level[j, i] = result
                heapq.heappush(heap, (result, j, i))
    return level


def drained_areas(heights: np.ndarray) -> np.ndarray:
    """Return the texels that drain through each one, itself included; edges are outlets."""
    level = flooded(heights, (1.0, 1.0), 1e-9 * float(np.ptp(heights)))
    slopes, numbers = steepest_slopes(level, (1.0, 1.0))
    down = np.take_along_axis(numbers, np.nan_to_num(slopes, nan=-np.inf).argmax(axis=0)[None], axis=0)[0]
    edge = edge_of(heights.shape)
    down[edge] = np.flatnonzero(edge)
    return counted(down)


def exponent_of(areas: np.ndarray, fewest: float = 20, part: float = 50) -> float:
    """Return τ of P(area > a) ~ a^-τ, from some texels to a part of all."""
    at = np.geomspace(fewest, areas.size / part, 12)
    return -float(np.polyfit(np.log(at), np.log([(areas > a).mean() for a in at]), 1)[0])
