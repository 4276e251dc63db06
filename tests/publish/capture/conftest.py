"""A small terrain of which every number is known: its north-western corner is its highest."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import playground

from ...sketch_texts import passes

HEIGHT = """// lop.glsl -- terrain that is like itself in no mirror.
#pragma kernel(output = "height:r32f")
uniform float gap = 0.0;  //! slider(0, 1) step(1) Whether a texel in the middle is no number
float kernel(ivec2 texel) {
    vec2 place = vec2(texel) / vec2(size - 1);
    float height = 0.125 + 0.75 * (1.0 - place.x) * place.y + 0.0625 * place.x * place.x;
    return gap > 0.5 && texel == size / 2 ? uintBitsToFloat(0x7fc00000u) : height;
}
"""
COLOUR = """// tint.glsl -- red to the east, green to the north.
#pragma kernel(output = "colour:rgba32f")
vec4 kernel(ivec2 texel) { return vec4(vec2(texel) / vec2(size - 1), 0.25, 1.0); }
"""
LIGHT = """// glow.glsl -- brighter to the north, from 0.5 to 1.25.
#pragma kernel(output = "light:rgba32f")
vec4 kernel(ivec2 texel) { return vec4(vec3(0.5 + 0.75 * float(texel.y) / float(size.y - 1)), 1.0); }
"""
WEIGHTS = """// weights.glsl -- four numbers, and two.
#pragma kernel(output = "weights:rgba32f, flow:rg32f")
void kernel(ivec2 texel, out vec4 weights, out vec2 flow) {
    vec2 place = vec2(texel) / vec2(size - 1);
    weights = vec4(place.x, 0.5, place.y, 0.25);
    flow = vec2(-3.0, 1e6) * place;
}
"""
SKETCH = (
    """format = 1
size = [9, 5]
extent = [800.0, 300.0]
relief = 1000.0
base_elevation = 50.0
"""
    + passes(height="./lop", colour=("./tint", "size = [17, 13]"), light="./glow", mix="./weights")
    + '[view]\nuse = "view/terrain"\n'
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = tmp_path / "lop"
    made.mkdir()
    texts = {"lop.glsl": HEIGHT, "tint.glsl": COLOUR, "glow.glsl": LIGHT, "weights.glsl": WEIGHTS}
    for name, text in (texts | {"sketch.toml": SKETCH}).items():
        (made / name).write_text(text)
    return made


@pytest.fixture
def lop(folder: Path) -> playground.Sketch:
    return playground.load(folder)


def metres(size: tuple[int, int] = (9, 5)) -> np.ndarray:
    """Return the terrain's heights, north row first, worked out texel by texel in float64."""
    nx, ny = size
    result = np.empty((ny, nx))
    for row in range(ny):
        north = 1.0 - row / (ny - 1)
        for col in range(nx):
            east = col / (nx - 1)
            result[row, col] = 50.0 + 1000.0 * (0.125 + 0.75 * north * (1.0 - east) + 0.0625 * east**2)
    return result


@pytest.fixture(scope="session")
def heightmap() -> np.ndarray:
    return metres()
