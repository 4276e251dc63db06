"""How the cost of a texel grows with the terrain: 1 where four times the texels take four times as long."""

from __future__ import annotations

from collections.abc import Sequence

from playground.verify.bench.results import Results


def growth(results: Results, sizes: Sequence[int], clock: str = "wall") -> list[tuple[str, float]]:
    """Return the cost of a texel at the largest size over that at the smallest, of each row that has both."""
    low, high = min(sizes), max(sizes)
    if low == high:
        return []
    cost = {
        (figure.name, figure.size): next(iter(figure.ours.values())).median(clock)
        for figure in results.figures
        if figure.unit == "ms"
    }
    names = dict.fromkeys(name for name, _ in cost)
    both = [name for name in names if (name, low) in cost and (name, high) in cost]
    return [(name, cost[name, high] / cost[name, low] * (low / high) ** 2) for name in both]
