"""Find the least part of a list that still passes a test: delta debugging.

The algorithm is ddmin of Zeller and Hildebrandt 2002, "Simplifying and Isolating
Failure-Inducing Input" (IEEE Transactions on Software Engineering 28), with complements
only: a candidate is always what is left when one part is taken out. The result is
1-minimal: without any one of its items the test no longer passes. That is not the
smallest of all, which would take as many tests as there are subsets.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

Item = TypeVar("Item")


def ddmin(items: Sequence[Item], test: Callable[[list[Item]], bool]) -> list[Item]:
    """Return a part of ``items``, in their order, that passes and of which no item can be spared.

    ``items`` themselves must pass, which is not tried. The test is tried on the same lists
    in the same order every time; it should give the same answer to the same list.
    """
    left = list(items)
    if left and test([]):
        return []
    parts = min(2, len(left))
    while len(left) > 1:
        # From the end: what is later in a text is seldom needed by what is before it.
        for part in reversed(range(parts)):
            low, high = part * len(left) // parts, (part + 1) * len(left) // parts
            rest = left[:low] + left[high:]
            if rest and test(rest):
                left, parts = rest, min(max(parts - 1, 2), len(rest))
                break
        else:
            if parts == len(left):
                break
            parts = min(2 * parts, len(left))
    return left
