"""Rocks and grass: where they lie and where not, their shadows, and what they change of the ground."""

import numpy as np
import pytest

from ..sketch_texts import passes
from ..truth.marches import shadows_of
from .test_trees import DENSITY, PLANE

SCREE = DENSITY.replace("trees/density", "objects/scree").replace('name = "density"', 'name = "rocks"')


@pytest.mark.parametrize(
    "slope, wired, expected",
    [
        (0.0, "", 0.1),
        (0.7, "", 0.6),
        (2.0, "", 0.0),
        (0.0, "weights", 0.5 * 0.6 * 0.75),  # the second layer is rock
        (0.0, "paths", 0.1),
    ],
)
def test_rocks_lie_on_steep_slopes_and_rock_but_not_on_paths(kept, ctx, make_sketch, slope, wired, expected):
    wires = f', {wired} = "ground:a_{wired}"' if wired else ""
    text = SCREE.format(slope=slope, wired=wires, values="strewn = 0.1, piled = 0.6, heaps = 0")
    result = kept.read(make_sketch(text, size=33, extent=32.0, relief=100.0, plane=PLANE), "rocks")
    x = np.arange(33)
    existing = (x > 0) & (x < 32) & ((x != 20) | (wired != "paths"))
    np.testing.assert_allclose(result[:, existing], expected, atol=4e-3)
    if wired == "paths":
        assert not result[:, 20].any()


def test_heaps_leave_as_many_rocks(kept, ctx, make_sketch):
    text = SCREE.format(slope=0.0, wired="", values="strewn = 0.2, heaps = 1, heap_wide = 10")
    result = kept.read(make_sketch(text, size=257, extent=640.0, relief=100.0, plane=PLANE), "rocks")
    assert result.mean(dtype=np.float64) == pytest.approx(0.2, rel=0.05) and result.std() > 0.05


PATH = """
#pragma kernel(output = "height:r32f, band:r32f, layers:rgba8, brown:rgba16f")
void kernel(ivec2 at, out float height, out float band, out vec4 layers, out vec4 brown) {
    height = 0.5;
    bool on = at.x >= 28 && at.x <= 36;  // 8 texels of 4 m: from 112 to 144 m
    band = on ? 1.0 : 0.0;
    layers = on ? vec4(0.0, 0.0, 0.0, 1.0) : vec4(1.0, 0.0, 0.0, 0.0);
    brown = vec4(0.12, 0.10, 0.05, 1.0);
}
"""
ON_PATH = (
    passes(
        land="./path",
        density=("trees/density", 'inputs = {{ height = "land:height", {wired} }}'),
        rocks=(
            "objects/scree",
            'inputs = {{ height = "land:height", {wired} }}',
            "set = {{ strewn = 1.0, heaps = 0.0 }}",
        ),
        tufts=("trees/density", 'inputs = {{ height = "land:height", {wired} }}'),
    )
    + """[view]
use = "scene/terrain"
samples = 1
inputs = {{ height = "land:height", colour = "land:brown"{view} }}
camera = {{ azimuth = 180.0, elevation = {elevation}, distance = 20.0, target = [128.0, 128.0, 2.0], \
field_of_view = 60.0 }}
set = {{ sun = [{sun}, 35], detail = "full grid", grid = 2, gain = 1.0, ambient = 0.3, haze = 0.0{values} }}
"""
)
ALL = ', density = "density", rocks = "rocks", tufts = "tufts:density"'


def on_path(make_sketch, wired, view=ALL, elevation=12.0, sun=135.0, values=""):
    text = ON_PATH.format(wired=wired, view=view, elevation=elevation, sun=sun, values=values)
    return make_sketch(text, size=65, extent=256.0, relief=4.0, path=PATH)


@pytest.mark.slow
@pytest.mark.parametrize("wired", ['paths = "land:band"', 'weights = "land:layers"'])
def test_nothing_stands_on_a_path(kept, ctx, make_sketch, wired):
    sketch = on_path(make_sketch, wired)
    for name, least in (("place", 20), ("near_trees", 20), ("strewn", 200), ("grown.place", 800)):
        tree = kept.read(sketch, f"view.{name}:tree", size=(320, 180)).reshape(-1, 4)
        x = tree[tree[:, 3] > 0, 0]
        assert len(x) > least and (x < 128).any() and (x > 128).any(), name
        assert not ((x > 112) & (x < 144)).any(), name


@pytest.mark.slow
def test_a_meadow_is_as_light_with_grass_as_without(kept, ctx, make_sketch):
    """From 2 m above it, with the sun from each side."""
    tufts = ', tufts = "tufts:density"'
    for sun in (20.0, 110.0, 200.0, 290.0):
        lit = []
        for view in (tufts, ""):
            sketch = on_path(make_sketch, 'paths = "land:band"', view, elevation=4.0, sun=sun)
            seen = kept.read(sketch, "view.grown" if view else "view.where", size=(320, 180))[..., 3].copy()
            ground = kept.read(sketch, "view.where", size=(320, 180))[..., 3] == 1
            lit.append(kept.read(sketch, "view.shaded", size=(320, 180))[ground, :3].mean(dtype=np.float64))
            assert (seen[ground] >= 4).mean() > 0.02 or not view
        assert lit[0] == pytest.approx(lit[1], rel=0.05), sun


ROCKS = """
#pragma kernel(output = "tree:rgba32f, total:r32f")
void kernel(ivec2 texel, out vec4 tree, out float total) {
    float k = float(texel.x);
    tree = vec4(100.0 + 6.0 * k, 99.0 + 1.1 * k, 5.0, 1.4 + 0.3 * k);
    total = 3.0;
}
"""
SHADE = (
    passes(
        list=("./list", "size = [3, 1]"),
        shade=(
            "objects/shade",
            "size = 512",
            'inputs = {{ tree = "list:tree", total = "list:total" }}',
            "set = {{ sun = [{azimuth}, {elevation}], rock_shade_wide = 32 }}",
        ),
        seen=(
            "objects/boulders",
            "size = [400, 300]",
            'inputs = {{ tree = "list:tree", total = "list:total" }}',
        ),
        height="generation/white_noise",
    )
    + """[view]
use = "view/terrain"
camera = {{ azimuth = 180.0, elevation = 60.0, distance = 24.0, target = [106.0, 100.0, 5.0] }}
"""
)


@pytest.mark.parametrize(("azimuth", "elevation"), [(135.0, 50.0), (250.0, 20.0), (0.0, -3.0)])
def test_a_rock_s_shadow_lies_where_rays_to_the_sun_meet_it(kept, ctx, make_sketch, azimuth, elevation):
    """A rock as the ellipsoid around its foot, half as wide and 0.6 as high as the list says."""
    sketch = make_sketch(
        SHADE.format(azimuth=azimuth, elevation=elevation), size=3, extent=200.0, relief=1.0, list=ROCKS
    )
    shade = kept.read(sketch, "shade").astype(np.float64)
    eye = np.array(kept.plan(sketch, (640, 360)).eye.position)
    if elevation < 0:
        assert not shade.any(), "by night there are none"
        return
    tall = 1.4 + 0.3 * np.arange(3)
    rocks = [
        (np.array([100 + 6.0 * k, 99 + 1.1 * k, 0.0]), tall[k] * np.array([0.5, 0.5, 0.6])) for k in range(3)
    ]
    hidden = shadows_of(eye, 32.0, rocks, azimuth, elevation)
    assert hidden.sum() > 1000
    assert ((shade > 0.5) != hidden).sum() < 0.02 * hidden.sum()
    assert shade.sum() == pytest.approx(hidden.sum(), rel=0.03), "a soft edge takes no more light"


def test_rocks_are_where_the_list_says_and_face_outwards(kept, ctx, make_sketch):
    sketch = make_sketch(
        SHADE.format(azimuth=90.0, elevation=30.0), size=3, extent=200.0, relief=1.0, list=ROCKS
    )
    seen = kept.read(sketch, "seen", size=(400, 300)).astype(np.float64)
    point = seen[seen[..., 3] >= 4]
    assert len(point) > 500 and set((point[:, 3] - 4).astype(int) & 63) <= set(range(48, 56))
    foot = np.array([[100 + 6 * k, 99 + 1.1 * k, 5.0, 1.4 + 0.3 * k] for k in range(3)])
    nearest = np.abs(point[:, None, 0] - foot[:, 0]).argmin(1)
    own = (point[:, :3] - foot[nearest, :3]) / foot[nearest, 3:]
    assert set(nearest) == {0, 1, 2}
    assert np.hypot(own[:, 0], own[:, 1]).max() < 0.667 * 1.25 + 1e-3 and -0.3 < own[:, 2].min()
    assert 0.5 < own[:, 2].max() < 0.35 + 0.667 * 0.75 + 1e-3
    eye = np.array(kept.plan(sketch, (400, 300)).eye.position)
    bits = (point[:, 3] - 4).astype(int) // 64
    square = np.stack([bits // 256, bits % 256], 1) / 255 * 2 - 1
    normal = np.c_[square, 1 - np.abs(square).sum(1)]
    upward = normal[:, 2] > 0
    assert (np.einsum("ij,ij->i", normal, eye - point[:, :3])[upward] > 0).mean() > 0.95, (
        "but where triangles cut an edge"
    )
