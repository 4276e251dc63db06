"""Terrains that several tests of light share."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from playground.sketch.model import Sketch

from ..loading import load
from ..truth.land import Land
from ..truth.methods import relief_of, written


def lit_by(
    folder: Path, terrain: Land, name: str, use: str, *, passes: str = "", size: str = "", **values: object
) -> Sketch:
    """Write and load a sketch of a terrain, lit by one technique of ``lighting/`` as the pass ``name``."""
    ny, nx = terrain.heights.shape
    relief = relief_of(terrain)
    np.save(folder / "land.npy", ((terrain.heights - terrain.heights.min()) / relief).astype(np.float32))
    setting = "".join(f"{key} = {written(value)}\n" for key, value in values.items())
    extent = [(n - 1) * metres for n, metres in zip((nx, ny), terrain.spacing, strict=True)]
    path = folder / "sketch.toml"
    path.write_text(
        f"format = 1\nsize = [{nx}, {ny}]\nextent = {extent}\nrelief = {relief}\n"
        '[[pass]]\nname = "height"\nuse = "generation/heightmap"\n'
        'set = { elevation = "land.npy", first_row = "south" }\n'
        f'{passes}[[pass]]\nname = "{name}"\nuse = "lighting/{use}"\n{size}\n[pass.set]\n{setting}'
    )
    return load(path)


def toml_value(value: object) -> str:
    """Return a parameter's value as TOML writes it."""
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else str(list(value) if isinstance(value, tuple) else value)


def sun_vector(azimuth: float, elevation: float) -> np.ndarray:
    """Return the unit vector towards a sun [degrees]: east, north, up."""
    a, e = np.radians([azimuth, elevation])
    return np.array([np.cos(e) * np.sin(a), np.cos(e) * np.cos(a), np.sin(e)])


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
