"""Crowns, stands and woods: by rays through ellipsoids in float64, and by what is drawn of a stand."""

from dataclasses import replace

import numpy as np
import pytest

FIELD = np.array([1 / 150.0, 4.5, 7.0, 9.0])  # trees a square metre, half width, half height, middle


def free_share(height, elevation, rng, rays=20000, wide=400.0):
    """Return the share of rays from a height on, upwards at an elevation, that meet no ellipsoid."""
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
def test_what_reaches_the_ground_is_what_no_crown_is_in_the_way_of(on_gpu, elevation):
    angle = np.radians(elevation)
    stand = "Stand({}, {}, {}, {}, 1.0, 0.0)".format(*FIELD)
    towards = np.array([[np.cos(angle) * 0.6, np.cos(angle) * 0.8, np.sin(angle)]], np.float32)
    for height, bound in ((0.0, 0.012), (9.0, 0.06), (13.0, 0.06)):
        found = on_gpu(
            "trees/stand.glsl", f"reaches({stand}, share_above({stand}, h), d)", h=[height], d=towards
        )[0]
        # At half a crown's height a ray that starts inside a crown counts as hidden; not so in the model,
        # which counts what is above: so much more open it may be.
        truth = free_share(height, angle, np.random.default_rng(11))
        assert -bound < found - truth < bound + (0.0 if height == 0 else np.pi * FIELD[0] * FIELD[1] ** 2), (
            height,
            found,
            truth,
        )


FLAT = """
#pragma kernel(output = "height:r32f, density:r32f, colour:rgba16f")
uniform float most = 0.7;  //! slider(0, 1)
void kernel(ivec2 texel, out float height, out float density, out vec4 colour) {
    height = 0.0;
    density = most;
    colour = vec4(0.16, 0.14, 0.06, 1.0);
}
"""
STAND = """
[[pass]]
name = "flat"
use = "./flat"
set = {{ most = {most} }}
[view]
use = "scene/wooded"
camera = {{ azimuth = 70.0, elevation = {elevation}, distance = {distance}, target = [8000, 8000, 0] }}
inputs = {{ height = "flat:height", density = "flat:density", colour = "flat:colour" }}
set = {{ sun = {sun}, gain = 2.0, ambient = 0.6, trees = 200000, detail = "full grid", grid = 2, {more} }}
"""


def stand(
    engine, make_sketch, distance, most=0.7, elevation=8.0, sun="[135, 35]", what="shaded", more="haze = 0"
):
    """Return what the eye sees of a stand on a plain: about 300 m of it, or 5 degrees."""
    text = STAND.format(**{k: v for k, v in locals().items() if k not in ("engine", "make_sketch")})
    sketch = make_sketch(text, size=3, extent=16000.0, relief=30.0, flat=FLAT)
    lens = max(np.degrees(2 * np.arctan(75.0 / distance)), 5.0)
    sketch = sketch.with_camera(replace(sketch.camera, field_of_view=lens))
    return engine.read(sketch, "view.shaded", size=(320, 180)).copy()


@pytest.mark.slow
@pytest.mark.parametrize("most, elevation, sun", [(0.7, 8.0, "[135, 35]"), (0.25, 12.0, "[200, 20]")])
def test_a_stand_has_one_mean_colour_at_every_distance(kept, ctx, make_sketch, most, elevation, sun):
    found = []
    for distance in (1000.0, 3000.0, 5000.0, 6000.0):
        lit = stand(kept, make_sketch, distance, most, elevation, sun=sun)
        found.append(lit[..., :3].mean((0, 1), dtype=np.float64))
    np.testing.assert_allclose(found, np.broadcast_to(found[0], (4, 3)), rtol=0.05)


@pytest.mark.slow
def test_where_single_trees_end_the_picture_keeps_its_brightness(kept, ctx, make_sketch):
    """Over the last tenth of the reach, a hundredth nearer each step."""
    means = [stand(kept, make_sketch, 4900.0 * 0.99**k)[..., :3].mean() for k in range(0, 14, 2)]
    assert (np.abs(np.diff(means) / means[0]) < 0.04).all() and len(means) == 7
