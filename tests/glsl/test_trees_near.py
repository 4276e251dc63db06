"""Trees as meshes near the eye: as large and as bright as the crowns that they become farther away."""

import numpy as np
import pytest

from ..sketch_texts import passes

LIST = """
#pragma kernel(output = "tree:rgba32f, total:r32f, species:rgba8")
void kernel(ivec2 texel, out vec4 tree, out float total, out vec4 species) {
    tree = vec4(200.0 + 31.0 * float(texel.x % 8), 200.0 + 33.0 * float(texel.x / 8), 5.0, 18.0);
    total = 64.0;
    species = vec4(SHARES);
}
"""
LISTED = 'inputs = {{ tree = "list:tree", total = "list:total", species = "list:species" }}'
PASSES = (
    passes(
        height="generation/white_noise",
        list=("./list", "size = [64, 1]"),
        body=(
            "trees/seen",
            "size = [480, 360]",
            LISTED,
            "set = {{ near = {near} }}",
        ),
        seen=(
            "trees/foliage",
            "size = [480, 360]",
            LISTED.replace(" }}", ', initial = "body" }}'),
            "set = {{ near = {near} }}",
        ),
    )
    + """[view]
use = "view/terrain"
camera = {{ azimuth = {azimuth}, elevation = 14.0, distance = {distance}, target = [308.0, 315.0, 14.0], \
field_of_view = 60.0 }}
"""
)
SPECIES = {
    "oaks": "0.0",
    "maples": "1.0, 0.0, 0.0, 0.0",
    "birches": "0.0, 1.0, 0.0, 0.0",
    "pines": "0.0, 0.0, 1.0, 0.0",
    "spruces": "0.0, 0.0, 0.0, 1.0",
}
SUN = np.array([0.6, -0.5, 0.62])


def drawn(engine, make_sketch, near, species="oaks", azimuth=200.0, distance=120.0):
    """Return the fraction of pixels with a tree, and the mean light of sun on those."""
    text = PASSES.format(near=near, azimuth=azimuth, distance=distance)
    listed = LIST.replace("SHARES", SPECIES[species])
    sketch = make_sketch(text, size=33, extent=620.0, relief=1.0, list=listed)
    number = engine.read(sketch, "seen", size=(480, 360))[..., 3].astype(np.float64)
    there = number >= 4
    bits = (number[there] - 4).astype(int) // 64
    square = np.stack([bits // 256, bits % 256], 1) / 255 * 2 - 1
    up = 1 - np.abs(square).sum(1)
    sign = np.where(square < 0, -1, 1)
    square = np.where(up[:, None] < 0, (1 - np.abs(square[:, ::-1])) * sign, square)
    normal = np.c_[square, up] / np.linalg.norm(np.c_[square, up], axis=1, keepdims=True)
    return there.mean(), np.maximum(normal @ (SUN / np.linalg.norm(SUN)), 0).mean()


@pytest.mark.parametrize("species", SPECIES)
def test_tree_mesh_matches_area_and_brightness_of_its_crown(kept, ctx, make_sketch, species):
    """From two sides, with the sun ahead and behind: areas to a tenth, light to a twentieth of the sun."""
    for azimuth in (200.0, 20.0):
        area, light = zip(
            *(drawn(kept, make_sketch, near, species, azimuth) for near in (0, 250)), strict=True
        )
        assert area[1] == pytest.approx(area[0], rel=0.10) and area[0] > 0.02
        assert light[1] == pytest.approx(light[0], abs=0.05)


@pytest.mark.slow
def test_nothing_switches_on_the_way_to_a_mesh(kept, ctx, make_sketch):
    """Fiftieths of the way: as the eye stays, all change is the meshes', and spread over all of it."""
    nears = 120.0 / np.linspace(1.02, 0.48, 28)
    elements = np.array([drawn(kept, make_sketch, near)[:2] for near in nears])
    step = np.abs(np.diff(elements, axis=0) / elements[0])
    assert step.max() < 0.02
