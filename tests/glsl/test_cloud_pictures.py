"""clouds/seen, clouds/layer, scene/sky: as pictures, against their shadows, photons and the dome."""

import numpy as np
import pytest

from playground.sketch.model import Camera

from ..sketch_texts import passes, toml_value
from ..truth.eyes import rays
from ..truth.land import towards

RADIUS = 6360.0
FLAT = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) { return 0.0; }\n'
SEEN = (96, 64)
TERRAIN = '[[pass]]\nname = "height"\nuse = "./flat"\n'
CLOUDS = passes(
    cloud=("clouds/field", "size = 256"), drift=("clouds/drift", "size = 1", "set = { wind = [30.0, -10.0] }")
)
BILLOWS = '[[pass]]\nname = "billows"\nuse = "clouds/billows"\nsize = 204\n'
SKY = passes(air=("scene/air", "size = [128, 80]"), sky=("scene/sky", "size = [96, 64]"))


def looking(sketch, azimuth, elevation, target=(500.0, 500.0, 300.0), field=40.0):
    camera = Camera(
        azimuth=azimuth + 180, elevation=-elevation, distance=50.0, target=target, field_of_view=field
    )
    return sketch.with_camera(camera)


@pytest.fixture
def outdoors(make_sketch):
    def make(rest="", files=None, **day):
        value = {"position": "free", "sun": [150.0, 40.0], "adaptation": 0.0, **day}
        sets = ", ".join(f"{k} = {toml_value(v)}" for k, v in value.items())
        light = f'[[pass]]\nname = "daylight"\nuse = "lighting/daylight"\nset = {{ {sets} }}\n'
        return make_sketch(TERRAIN + light + CLOUDS + rest, flat=FLAT, **(files or {}))

    return make


def test_a_line_of_sight_is_in_the_layer_where_its_height_is(on_gpu):
    """From below, within and above; heights along the way are those of plane geometry."""
    rng = np.random.default_rng(4)
    height, rise = rng.uniform(0, 6, 3000), rng.uniform(-1, 1, 3000) ** 3
    result = on_gpu("clouds/crossing.glsl", "layer_crossing(h, u, 2.2, 3.1)", h=height, u=rise)
    h, u = (np.asarray(v, np.float32).astype(np.float64) for v in (height, rise))
    first, last = result.T.astype(np.float64)

    def reached(way):
        return np.hypot(way * np.sqrt(1 - u**2), RADIUS + h + way * u) - RADIUS

    there = last > first
    nearest = (RADIUS + h) * np.sqrt(1 - u**2) - RADIUS
    lands = (u < 0) & (nearest < 0)
    sure = (np.abs(nearest) > 0.01) & (np.abs(nearest - 3.1) > 0.01) & (np.abs(nearest - 2.2) > 0.01)
    meets = np.where(h < 2.2, ~lands, (h <= 3.1) | ((u < 0) & (nearest < 3.1)))
    np.testing.assert_array_equal(there[sure], meets[sure])
    begins = np.where(h < 2.2, 2.2, np.where(h > 3.1, 3.1, h))
    np.testing.assert_allclose(reached(first)[sure & there], begins[sure & there], atol=2e-3)
    ends = reached(last)[sure & there]
    assert (np.minimum(np.abs(ends - 2.2), np.abs(ends - 3.1)) < 2e-3).all()
    middle = reached((first + last) / 2)[sure & there]
    assert ((middle > 2.2 - 2e-3) & (middle < 3.1 + 2e-3)).all()


@pytest.mark.parametrize(("drawn", "cover"), [("seen", 0.3), ("seen", 0.6), ("layer", 0.6)])
def test_clouds_hide_as_much_as_their_shadows_do(any_engine, outdoors, drawn, cover):
    """Straight up from far below, where no sides are seen, they leave what they leave of the sun."""
    use = BILLOWS + f'[[pass]]\nname = "seen"\nuse = "clouds/{drawn}"\nsize = [32, 32]\n'
    sketch = outdoors(use, clouds=cover).with_values({"drift.base": 11500.0, "drift.wide": 6000.0})
    left, expected = [], []
    tile = any_engine.read(sketch, "cloud").astype(np.float64)[..., 3]
    for east in np.arange(0.0, 6000.0, 1000.0):
        for north in np.arange(0.0, 6000.0, 1000.0):
            now = looking(sketch, 0.0, 89.9, (east, north, 10.0), 5.0)
            left.append(any_engine.read(now, "seen", size=(32, 32)).astype(np.float64)[..., 3].mean())
            eye = any_engine.record.plan.eye
            towards = rays(eye, (32, 32))
            toward = np.asarray(eye.position)[:2] + towards[..., :2] / towards[..., 2:] * 11_700
            x, y = ((toward / 6000 % 1) * 256).astype(int).transpose(2, 0, 1)
            expected.append(tile[y, x].mean())
    assert np.mean(left) == pytest.approx(np.mean(expected), abs=0.04)
    assert np.corrcoef(left, expected)[0, 1] > 0.97


@pytest.mark.parametrize("elevation", [55.0, 20.0])
def test_flat_clouds_are_as_many_and_as_bright_as_heaped_ones(any_engine, outdoors, elevation):
    """Over the sky from 8 to 35 degrees they hide as much to a tenth, and send as much light to a fifth."""
    rest = BILLOWS
    for name in ("seen", "layer"):
        rest += f'[[pass]]\nname = "by_{name}"\nuse = "clouds/{name}"\nsize = [96, 64]\n'
    sketch = outdoors(rest, clouds=0.45, sun=[150.0, elevation])
    result = []
    for name in ("seen", "layer"):
        views = [looking(sketch, azimuth, 21.0, field=26.0) for azimuth in (60.0, 200.0, 330.0)]
        seen = [any_engine.read(view, f"by_{name}", size=SEEN).astype(np.float64) for view in views]
        result.append([1 - np.mean(seen, axis=(0, 1, 2))[3], np.mean(seen, axis=(0, 1, 2))[1]])
    (hidden, light), (flat_hidden, flat_light) = result
    assert flat_hidden == pytest.approx(hidden, rel=0.1)
    assert flat_light == pytest.approx(light, rel=0.2)


TOLD = """
#pragma kernel(output = "daylight:rgba32f")
// A sun of 1 overhead, no sky, no ground.
vec4 kernel(ivec2 texel) {
    if (texel.x == 0) return vec4(0.0, 0.0, 1.0, 90.0);
    if (texel.x == 3) return vec4(0.0, 0.0, 0.0, 1.0);
    return vec4(0.0, 0.0, 0.0, texel.x == 2 ? 2.0 : 1.0);
}
"""
NONE = '#pragma kernel(output = "none:rgba32f")\nvec4 kernel(ivec2 texel) { return vec4(0.0); }\n'
EVEN = '#pragma kernel(output = "cloud:rgba16f")\nvec4 kernel(ivec2 texel) { return vec4(1, 0.5, 0.5, 0); }\n'


def photons_out(depth, edges, count=60_000):
    """Return light from an even layer under a unit beam from the zenith, times pi, by cosine: up, down."""
    rng = np.random.default_rng(3)
    g = 0.85
    at, down = np.zeros(count), np.ones(count)
    out = []
    while len(at):
        at = at + down * rng.exponential(size=len(at))
        gone = (at < 0) | (at > depth)
        out.append(down[gone])
        at, down = at[~gone], down[~gone]
        u = rng.random(len(at))
        cosine = (1 + g**2 - ((1 - g**2) / (1 - g + 2 * g * u)) ** 2) / (2 * g)
        side = np.sqrt(np.clip((1 - down**2) * (1 - cosine**2), 0, None))
        down = np.clip(down * cosine + side * np.cos(rng.uniform(0, 2 * np.pi, len(at))), -1, 1)
    cosines = np.concatenate(out)
    solid = np.diff(np.square(edges))
    return [np.histogram(sign * cosines, edges)[0] / count / solid for sign in (-1, 1)]


@pytest.mark.slow
def test_an_even_layer_sends_back_and_on_what_photons_do(any_engine, make_sketch):
    """Brightness is by energy: 900 m of cloud under the sun, seen from above and below, to a fifth."""
    text = TERRAIN + '[[pass]]\nname = "daylight"\nuse = "./told"\nsize = [16, 1]\n'
    text += '[[pass]]\nname = "none"\nuse = "./none"\nsize = 8\n'
    text += '[[pass]]\nname = "cloud"\nuse = "./even"\nsize = 16\n'
    text += '[[pass]]\nname = "drift"\nuse = "clouds/drift"\nsize = 1\nset = { base = 3000.0 }\n'
    text += BILLOWS + '[[pass]]\nname = "seen"\nuse = "clouds/seen"\nsize = [64, 64]\nset = { wear = 0.0 }\n'
    text += 'inputs = { columns = "none", bounced = "none" }\n'
    sketch = make_sketch(text, flat=FLAT, told=TOLD, none=NONE, even=EVEN)
    edges = np.array([0.7, 0.8, 0.9, 0.97])
    # What the ends of the layer lack of full density.
    above, below = photons_out(0.067 * 900 * (1 - 0.0175 - 1 / 32), edges)
    for height, elevation, truth in ((12000.0, -89.9, above), (50.0, 89.9, below)):
        now = looking(sketch, 0.0, elevation, (500.0, 500.0, height), 88.0)
        result = any_engine.read(now, "seen", size=(64, 64)).astype(np.float64)
        cosine = np.abs(rays(any_engine.record.plan.eye, (64, 64))[..., 2])
        for k, expected in enumerate(truth):
            ring = (cosine > edges[k]) & (cosine < edges[k + 1])
            assert result[ring, 1].mean() == pytest.approx(expected, rel=0.2), (height, edges[k])
        assert result[..., 3].max() < 0.01


LOOK = """
#include "lighting/daylight_sky.glsl"
#pragma kernel(output = "dome_seen:rgba32f")
uniform sampler2D daylight;  //! input
vec4 kernel(ivec2 texel) {
    vec4 away = world_from_clip * vec4((vec2(texel) + 0.5) / vec2(size) * 2.0 - 1.0, 1.0, 1.0);
    return vec4(sky_towards(daylight, normalize(away.xyz / away.w - eye), 0.001 * eye.z), 1.0);
}
"""


@pytest.mark.parametrize("drawn", ["none", "flat", "heaped"])
def test_without_clouds_it_is_the_sky_and_the_sun(any_engine, outdoors, drawn):
    rest = SKY + f'set = {{ clouds = "{drawn}" }}\n[[pass]]\nname = "look"\nuse = "./look"\nsize = [96, 64]\n'
    sketch = looking(outdoors(rest, {"look": LOOK}, sun=[95.0, 12.0], clouds=0.0), 90.0, 8.0)
    result = any_engine.read(sketch, "sky", size=SEEN).astype(np.float64)[..., :3]
    expected = any_engine.read(sketch, "look", size=SEEN).astype(np.float64)[..., :3]
    ahead = rays(any_engine.record.plan.eye, SEEN)
    sun = np.arccos(np.clip(ahead @ towards(95.0, 12.0), -1, 1))
    above = (ahead[..., 2] > 0.01) & (sun > np.radians(1.5))
    np.testing.assert_allclose(result[above], expected[above], rtol=0.03)
    disc = sun == sun.min()  # a pixel is as wide as the sun
    assert (result[disc] > 3 * expected[disc]).all()
    assert (result[sun > np.radians(1.5)] < 2 * expected[above].max()).all()


@pytest.mark.slow
@pytest.mark.parametrize("drawn", ["flat", "heaped"])
def test_clouds_never_exceed_received_light_nor_glow_at_night(any_engine, outdoors, drawn):
    rest = SKY + f'set = {{ clouds = "{drawn}" }}\n'
    brightest = []
    for elevation in (60.0, 20.0, 3.0, -1.0, -4.0, -12.0, -40.0):
        sketch = outdoors(rest, clouds=0.6, sun=[270.0, elevation], turbidity=2.2)
        result = any_engine.read(looking(sketch, 90.0, 20.0), "sky", size=SEEN).astype(np.float64)
        assert np.isfinite(result).all() and (result >= 0).all()
        row = any_engine.read(sketch, "daylight")[0].astype(np.float64)
        clear = row[1, :3] / ((1 - 0.75 * 0.6**3.4) * (1 - 0.6**2))
        # The beam over the clouds has crossed less air than that on the ground.
        most = np.maximum(1.5 * clear, 0.4 if elevation > 2 else 0.0) + row[2, :3] + 0.2 * row[5, :3]
        if elevation > 2:
            assert (result[..., :3].max(axis=(0, 1)) < most).all(), elevation
        brightest.append(result[..., :3].max())
    assert (np.diff(brightest[1:]) <= 0).all() and brightest[-1] < 1e-6 * brightest[0]


@pytest.mark.parametrize("drawn", ["flat", "heaped"])
def test_far_clouds_have_the_colour_of_the_air(any_engine, outdoors, drawn):
    """Just over the horizon all that is seen is air: a thousandth of what is behind comes through 100 km.

    So it is what the farthest slice has, the clear sky in gaps, or between them.
    """
    rest = SKY + f'set = {{ clouds = "{drawn}" }}\n[[pass]]\nname = "look"\nuse = "./look"\nsize = [96, 64]\n'
    sketch = looking(outdoors(rest, {"look": LOOK}, clouds=0.7), 90.0, 0.0, field=4.0)
    clear = any_engine.read(sketch.with_values({"daylight.clouds": 0.0}), "look", size=SEEN)
    result = any_engine.read(sketch, "sky", size=SEEN).astype(np.float64)[..., :3]
    slices = [any_engine.read(sketch, f"air:{name}", size=SEEN) for name in ("scattered", "left")]
    # The farthest slice, 32 x 20 texels of three pixels and 3.2; the horizon is between two of its rows.
    far, left = (each.astype(np.float64)[69:71, 96:, :3].mean(axis=0) for each in slices)
    rises = rays(any_engine.record.plan.eye, SEEN)[..., 2]
    assert (np.abs(rises[31:33]) < 1e-3).all()
    columns = slice(1, None, 3)  # in the middles of texels
    result, clear = (each[31:33, columns, :3].mean(axis=0, dtype=np.float64) for each in (result, clear))
    row = any_engine.read(sketch, "daylight")[0].astype(np.float64)
    beam = row[1, :3] / ((1 - 0.75 * 0.7**3.4) * (1 - 0.7**2))
    behind = left * (1.5 * beam + row[2, :3])  # as of the brightest cloud
    least, most = 0.98 * np.minimum(far, clear), 1.02 * np.maximum(far, clear) + behind
    assert (left < 2e-3).all()
    assert (result > least).all() and (result < most).all()
