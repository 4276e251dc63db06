"""Crowns, stands and woods: by rays through ellipsoids in float64, and by what is drawn of a stand."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from ..sketch_texts import passes
from ..truth.marches import shadows_of

FIELD = np.array([1 / 150.0, 4.5, 7.0, 9.0])  # trees a square metre, half width, half height, middle


def free_share(height, elevation, rng, rays=20000, wide=400.0):
    """Return the fraction of rays from a height on, upwards at an elevation, that meet no ellipsoid."""
    dense, across, up, middle = FIELD
    long = (middle + up - height) / np.tan(elevation) + 2 * across
    hits = np.zeros(rays, bool)
    # In the ray's frame: along x, and up; a field of its own for each ray. A crown is in the way if the ray
    # comes closer than 1 to its middle, where lengths are shares of its half axes.
    area = (long + 2 * across) * 4 * across
    counts = rng.poisson(dense * area, rays)
    for n in range(counts.max()):
        x = rng.uniform(-2 * across, long, rays)
        y = rng.uniform(-2 * across, 2 * across, rays)
        start = np.stack([-x / across, -y / across, np.full(rays, (height - middle) / up)])
        way = np.array([np.cos(elevation) / across, 0.0, np.sin(elevation) / up])
        t = np.maximum(-(way @ start) / (way @ way), 0.0)
        nearest = ((start + way[:, None] * t) ** 2).sum(0)
        hits |= (nearest < 1) & (n < counts)
    return 1 - hits.mean()


@pytest.mark.parametrize("elevation", [7.0, 20.0, 45.0, 80.0])
def test_ground_light_is_fraction_unblocked_by_crowns(on_gpu, elevation):
    angle = np.radians(elevation)
    stand = "Stand({}, {}, {}, {}, 1.0, 0.0)".format(*FIELD)
    towards = np.array([[np.cos(angle) * 0.6, np.cos(angle) * 0.8, np.sin(angle)]], np.float32)
    for height, bound in ((0.0, 0.012), (9.0, 0.06), (13.0, 0.06)):
        result = on_gpu(
            "trees/stand.glsl", f"reaches({stand}, share_above({stand}, h), d, d.z)", h=[height], d=towards
        )[0]
        # At half a crown's height a ray that starts inside a crown counts as hidden; not so in the model,
        # which counts what is above: so much more open it may be.
        truth = free_share(height, angle, np.random.default_rng(11))
        assert -bound < result - truth < bound + (0.0 if height == 0 else np.pi * FIELD[0] * FIELD[1] ** 2), (
            height,
            result,
            truth,
        )


FLAT = """
#pragma kernel(output = "height:r32f, density:r32f, colour:rgba16f")
uniform float most = 0.7;  //! slider(0, 1)
uniform float slope = 0.0;  //! slider(-1, 1)
void kernel(ivec2 texel, out float height, out float density, out vec4 colour) {
    height = 0.5 + slope * 16000.0 / 4000.0 * (0.5 * float(texel.x) - 0.5);
    density = most;
    colour = vec4(0.16, 0.14, 0.06, 1.0);
}
"""
STAND = (
    passes(flat=("./flat", "set = {{ most = {most}, slope = {slope} }}"))
    + """[view]
use = "scene/terrain"
camera = {{ azimuth = 70.0, elevation = {elevation}, distance = {distance}, target = [8000, 8000, 2000] }}
inputs = {{ height = "flat:height", density = "flat:density", colour = "flat:colour" }}
set = {{ sun = {sun}, gain = 2.0, ambient = 0.6, trees = {trees}, detail = "full grid", grid = 2{value} }}
"""
)


def stand(
    engine,
    make_sketch,
    distance,
    most=0.7,
    elevation=8.0,
    sun="[135, 35]",
    slope=0.0,
    trees=200000,
    value="",
    tables="",
    shown="view.shaded",
    **files,
):
    """Return what the eye sees of a stand on a plain: about 300 m of it, or 5 degrees."""
    value = value and f", {value}"
    text = STAND.format(
        **{k: v for k, v in locals().items() if k not in ("engine", "make_sketch", "tables", "files")}
    )
    sketch = make_sketch(tables + text, size=3, extent=16000.0, relief=4000.0, flat=FLAT, **files)
    lens = max(np.degrees(2 * np.arctan(75.0 / distance)), 5.0)
    sketch = sketch.with_camera(replace(sketch.camera, field_of_view=lens))
    return engine.read(sketch, shown, size=(320, 180)).copy()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("most", "elevation", "sun", "slope"),
    [
        (0.7, 8.0, "[135, 35]", 0.0),
        (0.25, 12.0, "[200, 20]", 0.0),
        (0.8, 6.0, "[150, 40]", -0.35),
    ],
)
def test_a_stand_has_one_mean_colour_at_every_distance(kept, ctx, make_sketch, most, elevation, sun, slope):
    result = []
    for distance in (1000.0, 3000.0, 5000.0, 6000.0):
        lit = stand(kept, make_sketch, distance, most, elevation, sun, slope)
        result.append(lit[..., :3].mean((0, 1), dtype=np.float64))
    np.testing.assert_allclose(result, np.broadcast_to(result[0], (4, 3)), rtol=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("trees", [4096, 512])
def test_a_stand_has_that_colour_whatever_there_is_room_for(kept, ctx, make_sketch, trees):
    """Of more trees than a list has room for some are drawn, and larger: the ground has the rest.

    Of few one sees the lower halves of the crowns as well, which receive less light.
    """
    result = []
    for room in (200000, trees):
        lit = [stand(kept, make_sketch, 1500.0, trees=room, value=f"seed = {k}") for k in (5, 6, 7)]
        result.append(np.mean([each[..., :3].mean((0, 1)) for each in lit], 0))
    np.testing.assert_allclose(result[1], result[0], rtol=0.05)


@pytest.mark.slow
def test_where_single_trees_end_the_picture_keeps_its_brightness(kept, ctx, make_sketch):
    """Over the last tenth of the reach, two hundredths nearer each step."""
    means = [stand(kept, make_sketch, 4900.0 * 0.99**k)[..., :3].mean() for k in range(0, 14, 2)]
    assert (np.abs(np.diff(means) / means[0]) < 0.02).all() and len(means) == 7


LIST = """
#pragma kernel(output = "tree:rgba32f, total:r32f")
void kernel(ivec2 texel, out vec4 tree, out float total) {
    float k = float(texel.x);
    tree = vec4(1000.0 + 60.0 * k, 990.0 + 11.0 * k, 5.0, 14.0 + 3.0 * k);
    total = 3.0;
}
"""
SHADE = (
    passes(
        list=("./list", "size = [3, 1]"),
        shade=(
            "trees/shade",
            "size = 512",
            'inputs = {{ tree = "list:tree", total = "list:total" }}',
            "set = {{ sun = [{azimuth}, {elevation}], shade_wide = 256 }}",
        ),
        height="generation/white_noise",
    )
    + """[view]
use = "view/terrain"
camera = {{ azimuth = 180.0, elevation = 60.0, distance = 2.0, target = [1060.0, 1000.0, 30.0] }}
"""
)


@pytest.mark.parametrize(("azimuth", "elevation"), [(135.0, 50.0), (250.0, 20.0), (0.0, -3.0)])
def test_a_shadow_lies_where_rays_to_the_sun_meet_the_crown(
    kept, ctx, on_gpu, make_sketch, azimuth, elevation
):
    text = SHADE.format(azimuth=azimuth, elevation=elevation)
    sketch = make_sketch(text, size=3, extent=2000.0, relief=1.0, list=LIST)
    shade = kept.read(sketch, "shade").astype(np.float64)
    eye = np.array(kept.plan(sketch, (640, 360)).eye.position)
    if elevation < 0:
        assert not shade.any(), "by night there are none"
        return
    k = np.arange(3)
    tree = np.stack([1000 + 60.0 * k, 990 + 11.0 * k, 5.0 + 0 * k, 14 + 3.0 * k], 1).astype(np.float32)
    crowns = "crown_of(t, vec4(0.0))"
    forms = on_gpu("trees/crown.glsl", f"vec3({crowns}.middle.z, {crowns}.across, {crowns}.up)", t=tree)
    crowns = [
        (np.array([east, north, middle - foot]), np.array([across, across, up]))
        for (east, north, foot, _), (middle, across, up) in zip(tree.astype(float), forms, strict=True)
    ]
    hidden = shadows_of(eye, 256.0, crowns, azimuth, elevation)
    assert hidden.sum() > 500
    assert ((shade > 0.5) != hidden).sum() < 0.02 * hidden.sum()
    assert abs(shade.sum() / hidden.sum() - 1) < 0.03, "a soft edge takes no more light"


def test_leaves_throw_back_no_more_light_than_falls_on_them(on_gpu):
    """All over a sphere that nothing hides: a quarter of the sun, as of any sphere, and half of the sky."""
    rng = np.random.default_rng(5)
    normals = rng.normal(size=(200_000, 3))
    normals = (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32)
    light = on_gpu("trees/stand.glsl", "crown_light(Stand(0.0, 4.0, 6.0, 8.0, 0.5, 9.0), n, 0.0, s, s.z)",
                   n=normals, s=np.array([[0.6, 0.0, 0.8]], np.float32))  # fmt: skip
    np.testing.assert_allclose(light.mean(0, dtype=np.float64), [0.25, 0.5], atol=0.004)
    # In a stand there is less, and the less the deeper.
    stand = "Stand(0.01, 4.0, 6.0, 8.0, 0.5, 9.0)"
    deep = [
        on_gpu("trees/stand.glsl", f"crown_light({stand}, n, h, n, n.z)", n=normals[:9], h=[h])
        for h in (0, 0.5, 1.0)
    ]
    assert (deep[1] <= deep[0]).all() and (deep[2] <= deep[1]).all()


WOOD = """
#include "maths/land.glsl"
#pragma kernel(output = "height:r32f, density:r32f")
void kernel(ivec2 texel, out float height, out float density) {
    vec2 share = share_of_texel(texel, size);
    height = 0.4 + 0.2 * sin(9.0 * share.x) * cos(7.0 * share.y);
    density = share.x < 0.4 && share.y > 0.3 ? 0.9 : 0.0;
}
"""
CANOPY = passes(
    wood="./wood",
    canopy=(
        "trees/canopy",
        'inputs = { bare = "wood:height", density = "wood:density" }',
        "set = { needles = 0 }",
    ),
    plain=("lighting/ray_cast", 'inputs = { height = "wood:height" }', "set = { sun = [270, 11] }"),
    wooded=("lighting/ray_cast", 'inputs = { height = "canopy:height" }', "set = { sun = [270, 11] }"),
)


@pytest.mark.slow
def test_a_wood_shades_the_meadow_beside_it_and_lights_none(kept, ctx, make_sketch):
    sketch = make_sketch(CANOPY, size=[129, 97], extent=[900.0, 800.0], relief=60.0, wood=WOOD)
    density, canopy = kept.read(sketch, "wood:density").copy(), kept.read(sketch, "canopy:canopy").copy()
    lit = [kept.read(sketch, f"{name}.visibility").copy() for name in ("plain", "wooded")]
    assert not canopy[density == 0].any()
    rng = np.random.default_rng(3)
    x = y = (np.arange(600) + 0.5) / 600 * 180
    top = np.zeros((600, 600))
    cells = np.argwhere(rng.random((20, 20)) < 0.9)
    for at in (cells + 0.5 + 0.8 * (rng.random(cells.shape) - 0.5)) * 9.0:
        tall = 21 * rng.uniform(0.55, 1)
        across = tall * rng.uniform(0.26, 0.36)
        square = ((x[None] - at[0]) ** 2 + (y[:, None] - at[1]) ** 2) / across**2
        crown = tall * (0.56 + 0.44 * np.sqrt(np.maximum(1 - square, 0)))
        top = np.maximum(top, np.where(square < 1, crown, 0.0))
    assert canopy.max() == pytest.approx(top.mean(), rel=0.15) and canopy[density > 0].min() > 0
    meadow = density == 0
    assert (lit[1][meadow] <= lit[0][meadow]).all() and (lit[1][meadow] < lit[0][meadow]).sum() > 50
    metres = 60.0 * (kept.read(sketch, "canopy:height") - kept.read(sketch, "wood:height"))
    np.testing.assert_allclose(metres, canopy, atol=1e-3)


@pytest.mark.slow
def test_all_needle_wood_matches_needle_light(kept, ctx, make_sketch):
    """Above `needles_from`, as with needles only; 2000 m above sea level here, far beyond single trees."""
    high, only = (
        stand(kept, make_sketch, 6000.0, value=name)
        for name in ("needles = 0.12, needles_from = 900", "needles = 1.0")
    )
    np.testing.assert_allclose(high, only, rtol=2e-3)


@pytest.mark.slow
def test_single_trees_end_where_their_table_ends(kept, ctx, make_sketch):
    """The table has no more than 1024 cells each way: what is beyond is in the ground, none is lacking."""
    result, sides = [], []
    for reach in (1024, 8000):
        text = f"cell = 1, tallest = 3, whole = 60, reach = {reach}"
        result.append(stand(kept, make_sketch, 1100.0, value=text))
        sides += [max(step.size) for step in kept.record.plan.walk() if step.path == "view.place.cells"]
    assert sides == [2050, 2050]
    np.testing.assert_array_equal(result[0], result[1])


EDGE = """
#include "maths/land.glsl"
#pragma kernel(output = "height:r32f, density:r32f, colour:rgba16f")
void kernel(ivec2 texel, out float height, out float density, out vec4 colour) {
    height = 0.1;
    density = texel.x > 28 && texel.x <= 32 ? 0.4 : 0.0;
    colour = vec4(0.5, 0.5, 0.5, 1.0);
}
"""
MEADOW = (
    passes(
        edge="./edge",
        canopy=("trees/canopy", 'inputs = {{ bare = "edge:height", density = "edge:density" }}'),
        bare=("lighting/ray_cast", 'inputs = {{ height = "edge:height" }}', "set = {{ sun = [275, 16] }}"),
        high=("lighting/ray_cast", 'inputs = {{ height = "canopy:height" }}', "set = {{ sun = [275, 16] }}"),
    )
    + """[view]
use = "scene/terrain"
samples = 1
camera = {{ azimuth = 150.0, elevation = 55.0, distance = 100.0, target = [280.0, 190.0, 6.0] }}
set = {{ sun = [275, 16], gain = 1.0, ambient = 0.0, haze = 0.0, sun_colour = "#ffffff", needles = 0.0, \
    detail = "full grid", grid = 2, margin = 300.0, shade_wide = {wide} }}
[view.inputs]
height = "edge:height"
density = "edge:density"
colour = "edge:colour"
visibility = "bare.visibility"
canopy_visibility = "high.visibility"
"""
)


def meadow_sun(engine, make_sketch, wide):
    """Return places in the meadow beside a wood in the west, (n, 3), and the fraction of the sun on each."""
    sketch = make_sketch(
        MEADOW.format(wide=wide), size=[65, 49], extent=[512.0, 384.0], relief=60.0, edge=EDGE
    )
    seen = engine.read(sketch, "view.seen", size=(240, 160)).copy()
    lit = engine.read(sketch, "view.shaded", size=(240, 160))[..., 1].astype(np.float64)
    meadow = (seen[..., 3] == 1) & (seen[..., 0] > 264) & (seen[..., 0] < 310)
    tree = engine.read(sketch, "view.place:tree", size=(240, 160)).reshape(-1, 4).copy()
    share = lit[meadow] / (0.5 * np.sin(np.radians(16.0)))
    return seen[meadow][:, :3].astype(np.float64), share, tree[tree[:, 3] > 0]


def test_the_sun_beside_a_wood_is_what_its_trees_leave(kept, ctx, on_gpu, make_sketch):
    """Near the eye, by rays through each crown: a wood as one opaque body would take more than they do."""
    position, share, tree = meadow_sun(kept, make_sketch, 700.0)
    crowns = "crown_of(t, s)"
    form = f"vec3({crowns}.middle.z, {crowns}.across, {crowns}.up)"
    species = kept.read(kept.record.plan.sketch, "view.species").astype(np.float64)
    at = tree[:, 1::-1].T / [[8.0], [8.0]]
    shares = [map_coordinates(species[..., k], at, order=1, mode="nearest") for k in range(4)]
    shares = np.stack(shares, 1).astype(np.float32)
    forms = on_gpu("trees/crown.glsl", form, t=tree, s=shares).astype(np.float64)
    turn, rise = np.radians([275.0, 16.0])
    way = np.array([np.sin(turn) * np.cos(rise), np.cos(turn) * np.cos(rise), np.sin(rise)])
    hidden = np.zeros(len(position), bool)
    for (east, north, _, _), (middle, across, up) in zip(tree.astype(float), forms, strict=True):
        start = (position - [east, north, middle]) / [across, across, up]
        along = way / [across, across, up]
        t = -(start @ along) / (along @ along)
        hidden |= ((start + t[:, None] * along) ** 2).sum(1) < 1
    assert 0.1 < hidden.mean() < 0.9
    assert abs(share.mean() - (~hidden).mean()) < 0.005
    assert ((share < 0.5) != hidden).mean() < 0.01


def test_woods_beyond_tree_shadow_square_shade_as_one_body(kept, ctx, make_sketch):
    position, share, _ = meadow_sun(kept, make_sketch, 100.0)
    east, north = np.array(kept.record.plan.eye.position[:2])
    beyond = np.maximum(abs(position[:, 0] - east), abs(position[:, 1] - north)) > 50.0
    visibility = kept.read(kept.record.plan.sketch, "high.visibility").astype(np.float64)
    x, y = position[beyond, 0] / 8, position[beyond, 1] / 8
    column, row = x.astype(int), y.astype(int)
    corners = [[visibility[row + j, column + i] for i in (0, 1)] for j in (0, 1)]
    south, north = (a + (b - a) * (x - column) for a, b in corners)
    np.testing.assert_allclose(share[beyond], south + (north - south) * (y - row), atol=0.01)
    assert beyond.sum() > 1000 and (share[beyond] < 0.5).mean() > 0.05


@pytest.mark.slow
@pytest.mark.parametrize(("day", "from_zero", "distance"), [(292, 291, 1000.0), (366, 0, 6000.0)])
def test_leaves_have_the_season_of_the_daylight(kept, ctx, make_sketch, day, from_zero, distance):
    """One day for sun and leaves: daylight counts from 1, the parameter of trees from 0."""
    daylight = f'[[pass]]\nname = "daylight"\nuse = "lighting/daylight"\nset = {{ day = {day} }}\n'
    by_sun, by_hand = (
        stand(kept, make_sketch, distance, tables=tables, value=value, shown="view.wooded:albedo")
        for tables, value in ((daylight, ""), ("", f"day = {from_zero}"))
    )
    np.testing.assert_array_equal(by_sun, by_hand)


HALF = '#pragma kernel(output = "dark:r16f")\nfloat kernel(ivec2 at) { return at.x < 160 ? 1.0 : 0.0; }\n'


def test_a_shadow_of_the_sketch_falls_on_ground_and_trees(kept, ctx, make_sketch):
    """Where it takes nothing all stays; where it takes all, only the light of the sky is left."""
    shadow = '[[pass]]\nname = "shadow"\nuse = "./half"\nsize = [320, 180]\n'
    halved = stand(kept, make_sketch, 1000.0, tables=shadow, half=HALF)
    free = stand(kept, make_sketch, 1000.0)
    sky = stand(kept, make_sketch, 1000.0, value='sun_colour = "#000000"')
    np.testing.assert_array_equal(halved[:, :160], free[:, :160])
    np.testing.assert_array_equal(halved[:, 160:], sky[:, 160:])
