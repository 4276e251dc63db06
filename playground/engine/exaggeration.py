"""Show a terrain higher than it is: what is drawn and lit gets another relief, what computes data its own.

Which of the two a kernel is, its header says: see ``TerrainKernel``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from playground.shader.kernel import Kernel, TerrainKernel
from playground.shader.widgets import Value

SMALLEST, LARGEST = 0.1, 10.0
"""How many times higher than it is a terrain can be shown."""


@dataclass(frozen=True, slots=True)
class Exaggeration:
    """How many times higher than it is a terrain is shown."""

    factor: float

    def given(
        self, kernel: Kernel, values: Mapping[str, Value], given: Mapping[str, float | None]
    ) -> dict[str, float]:
        """Return what replaces the relief and the base elevation that a kernel is ``given`` [m].

        A kernel with a level gets a base elevation from which that level is ``factor`` times as far.
        """
        if self.factor == 1.0 or not isinstance(kernel, TerrainKernel) or not kernel.shows_relief:
            return {}
        relief, base = given["relief"], given["base_elevation"]
        replaced = {"relief": relief * self.factor} if relief is not None else {}
        level = values.get(kernel.level)
        if base is not None and isinstance(level, int | float):
            replaced["base_elevation"] = level - self.factor * (level - base)
        return replaced


def exaggeration(factor: float) -> Exaggeration | None:
    """Return what shows a terrain so many times higher than it is, within the bounds; None for 1."""
    factor = min(max(factor, SMALLEST), LARGEST)
    return None if factor == 1.0 else Exaggeration(factor)
