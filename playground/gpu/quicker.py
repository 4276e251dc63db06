"""Have a kernel's text read texels, and know its own, as a software renderer does sooner."""

from __future__ import annotations

from collections.abc import Collection

from playground.gpu.interpolated_place import with_interpolated_place
from playground.gpu.nearest_texels import with_nearest_texels
from playground.gpu.wrap import Wrapped
from playground.sketch.reserved_names import LEVEL_0, OWN_SIZE, PLACE

QUICKER = frozenset({LEVEL_0, OWN_SIZE, PLACE})
"""Names of the choices that change how, and not what."""


def quicker(wrapped: Wrapped, choices: Collection[str]) -> Wrapped:
    """Return a kernel's stages as those of the names ``QUICKER`` that are chosen have them."""
    if LEVEL_0 in choices:
        wrapped = with_nearest_texels(wrapped, own_size=OWN_SIZE in choices)
    return with_interpolated_place(wrapped) if PLACE in choices else wrapped
