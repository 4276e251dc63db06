"""Which textures of a sketch a map can show, and the range that suits one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from playground.sketch.map_sketch import Map
from playground.sketch.model import Graph, Sketch, Technique, Value
from playground.sketch.wiring import output_names


def in_view(sketch: Sketch, ref: str) -> bool:
    """Say whether a texture is one of the sketch's view: a map can show it, though no list has it."""
    path, _, output = ref.partition(":")
    technique: Technique | None = None
    for number, name in enumerate(path.split(".")):
        around = technique if number else sketch.graph
        spec = around.find(name) if isinstance(around, Graph) else None
        if spec is None or (number == 0 and name != "view"):
            return False
        technique = spec.technique
    return technique is not None and output in output_names(technique)


def fitted(shown: Map, values: NDArray[np.float32]) -> Map:
    """Return the map with its channel and range chosen to suit a texture's values.

    One or two components are shown as a number, from the lowest to the highest there
    is; three or four as a colour from 0 to 1. Values that are not finite are left out.
    """
    names = {p.name for p in shown.kernel.parameters}
    components = 1 if values.ndim == 2 else values.shape[2]
    settings: dict[str, Value] = {"channel": 0 if components >= 3 else 1, "lowest": 0.0, "highest": 1.0}
    if components < 3:
        numbers = values if values.ndim == 2 else values[..., 0]
        finite = numbers[np.isfinite(numbers)]
        if finite.size and finite.min() < finite.max():
            settings |= {"lowest": float(finite.min()), "highest": float(finite.max())}
    for name, value in settings.items():
        if name in names:
            shown = shown.with_value(name, value)
    return shown
