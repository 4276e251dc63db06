"""Which kernels show the terrain, and so are given an exaggerated relief: those that draw it or light it."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path
from typing import NamedTuple

from playground.engine.exaggeration import Exaggeration
from playground.paths import GLSL
from playground.shader.reserved_names import TOWARDS
from playground.sketch.model import Draw, Kernel
from playground.sketch.techniques import name_of

LARGEST = 10.0
"""How many times higher than it is a terrain can be shown."""

_RULES = Path(__file__).with_suffix(".toml")


class _Rules(NamedTuple):
    """What ``exaggerated.toml`` says: beginnings of kernels' names, and parameters."""

    shows: tuple[str, ...]
    keeps_metres: tuple[str, ...]
    levels: tuple[str, ...]


@cache
def _rules() -> _Rules:
    table = tomllib.loads(_RULES.read_text("utf-8"))
    return _Rules(*(tuple(table[name]) for name in _Rules._fields))


def exaggeration(factor: float) -> Exaggeration | None:
    """Return what shows a terrain so many times higher than it is; None for 1.

    The factor is brought between 0.1 and ``LARGEST``.
    """
    factor = min(max(factor, 0.1), LARGEST)
    return None if factor == 1.0 else Exaggeration(factor, shows, _rules().levels)


def shows(kernel: Kernel) -> bool:
    """Return whether a kernel draws or lights the terrain.

    One that is not shipped does where it is a draw, or has a direction of light.
    """
    if isinstance(kernel, Draw):
        return True
    if Path(kernel.path).is_relative_to(GLSL):
        name = name_of(Path(kernel.path))
        return name.startswith(_rules().shows) and not name.startswith(_rules().keeps_metres)
    directions = (p.name for p in kernel.parameters if p.widget.kind == "direction")
    return any(kernel.reads(f"{TOWARDS}{name}") for name in directions)
