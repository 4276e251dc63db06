"""Which kernels show the terrain, and so are given an exaggerated relief: those that draw it or light it.

What computes heights, water, materials, slopes in degrees or lines of elevation keeps the true metres.
"""

from __future__ import annotations

from pathlib import Path

from playground.engine.exaggeration import Exaggeration
from playground.paths import GLSL
from playground.shader.reserved_names import TOWARDS
from playground.sketch.model import Draw, Kernel
from playground.sketch.techniques import name_of

LARGEST = 10.0
"""How many times higher than it is a terrain can be shown."""

_SHOWING = (
    "lighting/",
    "view/",
    "scene/",
    "objects/",
    "clouds/",
    "trees/place",
    "trees/cover",
    "trees/from_above",
    "terrain/normal_map",
    "water/sheet",
    "water/sea",
)
_OF_ELEVATIONS = ("view/contours", "view/profile", "lighting/diagram")
"""These write true metres."""
_LEVELS = ("sea_level",)


def exaggeration(factor: float) -> Exaggeration | None:
    """Return what shows a terrain so many times higher than it is; None for 1.

    The factor is brought between 0.1 and ``LARGEST``.
    """
    factor = min(max(factor, 0.1), LARGEST)
    return None if factor == 1.0 else Exaggeration(factor, shows, _LEVELS)


def shows(kernel: Kernel) -> bool:
    """Return whether a kernel draws or lights the terrain.

    One that is not shipped does where it is a draw, or has a direction of light.
    """
    if isinstance(kernel, Draw):
        return True
    if Path(kernel.path).is_relative_to(GLSL):
        name = name_of(Path(kernel.path))
        return name.startswith(_SHOWING) and not name.startswith(_OF_ELEVATIONS)
    directions = (p.name for p in kernel.parameters if p.widget.kind == "direction")
    return any(kernel.reads(f"{TOWARDS}{name}") for name in directions)
