"""Drained areas by a priority flood and serial counting, and how they are distributed."""

from __future__ import annotations

import heapq

import numpy as np


def drained_areas(heights: np.ndarray) -> np.ndarray:
    """Return the texels that drain through each one, itself included; edges are outlets.

    Depressions are flooded from the edges inwards (Barnes, Lehman and Mulla 2014, "Priority-Flood"); then
    each texel drains to its steepest neighbour, or on flooded ground to the one it was flooded from.
    """
    ny, nx = heights.shape
    level = np.full((ny, nx), np.inf)
    receiver = np.full((ny, nx), -1)
    waiting: list[tuple[float, int]] = []
    for y in range(ny):
        for x in range(nx):
            if y in (0, ny - 1) or x in (0, nx - 1):
                level[y, x] = heights[y, x]
                waiting.append((float(heights[y, x]), y * nx + x))
    heapq.heapify(waiting)
    order = []
    near = [(dy, dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1) if dy or dx]
    while waiting:
        low, position = heapq.heappop(waiting)
        order.append(position)
        y, x = divmod(position, nx)
        for dy, dx in near:
            b, a = y + dy, x + dx
            if 0 <= b < ny and 0 <= a < nx and level[b, a] == np.inf:
                level[b, a] = max(float(heights[b, a]), low)
                receiver[b, a] = position
                heapq.heappush(waiting, (level[b, a], b * nx + a))
    steepest = np.zeros((ny - 2, nx - 2))
    inner = receiver[1:-1, 1:-1]
    numbers = np.arange(ny * nx).reshape(ny, nx)
    for dy, dx in near:
        there = slice(1 + dy, ny - 1 + dy), slice(1 + dx, nx - 1 + dx)
        slope = (level[1:-1, 1:-1] - level[there]) / np.hypot(dy, dx)
        inner[:] = np.where(slope > steepest, numbers[there], inner)
        steepest = np.maximum(steepest, slope)
    areas = np.ones(ny * nx)
    for position in reversed(order):
        if receiver.flat[position] >= 0:
            areas[receiver.flat[position]] += areas[position]
    return areas.reshape(ny, nx)


def exponent_of(areas: np.ndarray) -> float:
    """Return τ of P(area > a) ~ a^-τ, from 20 texels to a fiftieth of all."""
    at = np.geomspace(20, areas.size / 50, 12)
    return -float(np.polyfit(np.log(at), np.log([(areas > a).mean() for a in at]), 1)[0])
