"""The colours of a map's ramp, drawn by the very functions that draw the map."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from playground.memo import INTERFACE
from playground.paths import GLSL
from playground.shader.own_shaders import own_shader
from playground.studio.inspect.results import TexelShader

if TYPE_CHECKING:
    import moderngl

    from playground.sketch.map_sketch import Map

STEPS = 64
Colour = tuple[float, float, float]


def colours_of(ctx: moderngl.Context, ramp: int) -> tuple[Colour, ...]:
    """Return ``STEPS`` display-encoded colours of a ramp, evenly from its begin to its end.

    The context is the caller's to make current and to leave as it was; nothing stays in it.
    """
    ramp_functions = (GLSL / "colour" / "ramp.glsl").read_text(encoding="utf-8")
    shader = TexelShader(ctx, f"#version 330\n{ramp_functions}{own_shader('ramp_main.glsl')}", (STEPS, 1))
    try:
        (values,) = shader.compute({}, ramp=ramp, steps=float(STEPS))
    finally:
        shader.release()
    return tuple((float(r), float(g), float(b)) for r, g, b, _ in values)


def ends_of(shown: Map) -> tuple[float, float]:
    """Return the numbers at the two ends of a map's legend.

    Around a middle they are as far from it on either side, independent of where the map's range begins.
    """
    low, high, middle = (_number(shown, name) for name in ("lowest", "highest", "middle"))
    if _number(shown, "ramp") != 4:
        return low, high
    half = max(abs(high - middle), abs(low - middle))
    return middle - half, middle + half


@INTERFACE.cached()
def ticks(low: float, high: float, most: int = 5) -> tuple[float, ...]:
    """Return round numbers between two, at most so many."""
    span = abs(high - low)
    if not (0 < span < 1e30):
        return (low,)
    step = 10.0 ** np.floor(np.log10(span / max(most - 1, 1)))
    for factor in (1, 2, 2.5, 5, 10, 20):
        if span / (step * factor) <= most - 1:
            step *= factor
            break
    first = np.ceil(min(low, high) / step - 1e-9)
    last = np.floor(max(low, high) / step + 1e-9)
    return tuple(float(n * step) + 0.0 for n in np.arange(first, last + 1))


def _number(shown: Map, name: str) -> float:
    value = shown.value(name)
    return float(value) if isinstance(value, int | float) else 0.0
