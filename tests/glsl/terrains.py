"""Terrains that several tests of light share."""

from __future__ import annotations

from pathlib import Path

from playground.sketch.model import Sketch

from ..sketch_texts import passes as passes_of_uses
from ..sketch_texts import use
from ..truth.land import Land
from ..truth.methods import sketch_of


def lit_by(
    folder: Path,
    terrain: Land,
    name: str,
    technique: str,
    *,
    passes: str = "",
    size: object = None,
    **values: object,
) -> Sketch:
    """Write and load a sketch of a terrain, lit by one technique of ``lighting/`` as the pass ``name``."""
    light = {name: use(f"lighting/{technique}", size=size, **values)}
    return sketch_of(folder, terrain, passes + passes_of_uses(**light))


# Hills of four sizes, turned or mirrored on request.
HILLS = """
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")
uniform float scale = 1.0;
uniform float base = 0.0;
uniform int turned = 0;   //! menu("no", "quarter", "mirrored")
float value(ivec2 texel) {
    float total = 0.0;
    for (int k = 0; k < 4; k++) {
        float cell = float(16 >> k);
        vec2 place = vec2(texel) / cell;
        ivec2 low = ivec2(place);
        vec2 part = place - vec2(low);
        part = part * part * (3.0 - 2.0 * part);
        float south = mix(random(low, uint(k)), random(low + ivec2(1, 0), uint(k)), part.x);
        float north = mix(random(low + ivec2(0, 1), uint(k)), random(low + 1, uint(k)), part.x);
        total += mix(south, north, part.y) * cell / 30.0;
    }
    return total;
}
float kernel(ivec2 texel) {
    ivec2 from = texel;
    if (turned == 1) from = ivec2(texel.y, size.x - 1 - texel.x);
    if (turned == 2) from.x = size.x - 1 - texel.x;
    return base + scale * value(from);
}
"""
