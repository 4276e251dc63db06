"""What is known of a terrain."""

from __future__ import annotations

from dataclasses import dataclass

from playground.terrain.place import Place


@dataclass(frozen=True, slots=True)
class Terrain:
    """What a source knows of its terrain; None where it does not."""

    size: tuple[int, int] | None = None  # texels, x and y
    extent: tuple[float, float] | None = None  # [m]
    relief: float | None = None  # [m] from height 0 to height 1
    base_elevation: float | None = None  # [m] above sea level at height 0
    place: Place | None = None  # where it lies on the Earth
