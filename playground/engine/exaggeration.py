"""Show a terrain higher than it is: what is drawn and lit gets another relief, what computes data its own.

Which kernels light or draw is said by whoever exaggerates: the engine names no technique.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from playground.sketch.model import Kernel, Value


@dataclass(frozen=True, slots=True)
class Exaggeration:
    """How many times higher a terrain is shown, and by which kernels.

    ``levels`` names parameters that are elevations [m], such as a sea's: they stay where they are on the
    terrain.
    """

    factor: float
    shows: Callable[[Kernel], bool]
    levels: tuple[str, ...] = ()

    def given(
        self, kernel: Kernel, values: Mapping[str, Value], given: Mapping[str, float | None]
    ) -> dict[str, float]:
        """Return what replaces the relief and the base elevation that a kernel is ``given`` [m].

        A kernel with a level gets a base elevation from which that level is ``factor`` times as far.
        """
        if self.factor == 1.0 or not self.shows(kernel):
            return {}
        relief, base = given["relief"], given["base_elevation"]
        replaced = {"relief": relief * self.factor} if relief is not None else {}
        for name in self.levels:
            level = values.get(name)
            if base is not None and isinstance(level, int | float):
                replaced["base_elevation"] = level - self.factor * (level - base)
        return replaced
