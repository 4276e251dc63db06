"""scene/near/: the ground near the eye, finer than its maps. Slopes, means and limits in float64."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from playground.sketch.model import Camera

from ..truth.noise import lattice_seed, perlin, solid
from ..truth.surfaces import reflected

RNG = np.random.default_rng(18)
RUNGS, COARSEST = 13, 64.0
FINE = "PixelOnGround(vec2(1e-4, 0.0), 1e-4, 1e-4)"
GRASS, STONES, ROCK = np.eye(3, dtype=np.float32)
FOLDED = 0.26663  # mean of the plane's noise without its sign
TURN = np.array([[0.8, -0.6], [0.6, 0.8]])


# ── noise in space ───────────────────────────────────────────────────────────


@pytest.mark.parametrize("seed", [0, 4711])
def test_solid_noise_matches_corner_sum_and_its_derivatives(on_gpu, seed):
    places = RNG.uniform(-40, 40, (400, 3)).astype(np.float32)
    result = on_gpu("noise/solid.glsl", "solid(p, s)", p=places, s=np.uint32(seed)).astype(float)
    exact, step = places.astype(float), 1e-5
    np.testing.assert_allclose(result[:, 0], solid(exact, seed), atol=3e-6)
    for axis in range(3):
        away = step * np.eye(3)[axis]
        slope = (solid(exact + away, seed) - solid(exact - away, seed)) / (2 * step)
        np.testing.assert_allclose(result[:, 1 + axis], slope, atol=5e-5)
    assert abs(result[:, 0]).max() <= 1


# ── octaves ──────────────────────────────────────────────────────────────────


def test_octaves_appear_between_two_pixels_and_two_spacings(on_gpu):
    file = "scene/near/ladder.glsl"
    cells = (COARSEST * 0.5 ** np.arange(RUNGS)).astype(np.float32)
    for pixel in np.geomspace(1e-4, 40.0, 60).astype(np.float32):
        shown = on_gpu(file, "shown_to(c, p)", c=cells, p=float(pixel))
        assert np.all(shown[cells <= 2 * pixel] == 0) and np.all(shown[cells >= 4 * pixel] == 1)
        end = on_gpu(file, "last_rung(p)", p=[float(pixel)])[0]
        assert np.all(shown[end:] == 0), "what is left out is not seen"
    for spacing in (0.02, 1.3, 17.0, 93.0):
        part = on_gpu(file, "beyond_map(c, s)", c=cells, s=spacing)
        begin = on_gpu(file, "first_rung(s)", s=[spacing])[0]
        assert np.all(part[cells >= 2 * spacing] == 0) and np.all(part[:begin] == 0)
        assert np.all(part[cells <= spacing] == 1)


def octaves(on_gpu, places, kinds, spacing, grain):
    """Return the height [m] of all octaves at places, worked out octave by octave in float64."""
    total, turn = np.zeros(len(places)), np.diag([1.0, grain])
    begin = on_gpu("scene/near/ladder.glsl", "first_rung(s)", s=[spacing])[0]
    for k in range(begin, RUNGS):
        turn = TURN @ turn
        cell = COARSEST / 2.0**k
        rough = on_gpu("scene/near/materials.glsl", "roughness_of(m, k)", m=kinds[None], k=np.int32([k]))[0]
        at = places @ turn.T / cell + np.array([0.618034, 0.381966]) * k
        noise = perlin(at[:, 0], at[:, 1], lattice_seed(0x411167EB, k))
        noise = abs(noise) - FOLDED if cell <= 1 else noise
        total += np.clip(2 - cell / spacing, 0, 1) * float(rough) / 0.94501 * cell * noise
    return total


@pytest.mark.parametrize(("kinds", "grain"), [(GRASS, 1.0), (STONES, 0.25), (ROCK, 1.0)])
def test_slopes_of_the_bumps_are_their_heights_derivatives(on_gpu, kinds, grain):
    places = RNG.uniform(-20, 20, (300, 2)).astype(np.float32)
    call = f"bumps_at(p, mat2(1.0, 0.0, 0.0, {grain}), m, 1.0, {FINE}, 24.0, 0.0)"
    result = on_gpu("scene/near/bumps.glsl", f"{call}.slope", p=places, m=kinds[None]).astype(float)
    exact, step = places.astype(float), 1e-6
    for axis in range(2):
        away = step * np.eye(2)[axis]
        high, low = (octaves(on_gpu, exact + side * away, kinds, 24.0, grain) for side in (1, -1))
        rise = high - low
        # A place in the bottom of a furrow has two slopes.
        wrong = abs(result[:, axis] - rise / (2 * step)) > 4e-3
        assert wrong.mean() < 0.02, wrong.mean()
        assert abs(result[:, axis]).std() > 0.1 * grain


@pytest.mark.parametrize("pixel", [FINE, "PixelOnGround(vec2(0.3, 0.1), 0.316, 0.08)"])
@pytest.mark.parametrize("kinds", [GRASS, STONES])
def test_bumps_are_none_on_the_mean_and_as_rough_as_they_say(on_gpu, pixel, kinds):
    places = RNG.uniform(0, 9000, (60000, 2)).astype(np.float32)
    read = lambda name: on_gpu(  # noqa: E731
        "scene/near/bumps.glsl",
        f"bumps_at(p, mat2(1.0), m, 1.0, {pixel}, 90.0, 0.2).{name}",
        p=places,
        m=kinds[None],
    ).astype(float)
    for name in ("slope", "snowy", "tone", "dry", "height"):
        result = read(name)
        assert np.all(abs(result.mean(axis=0)) < 5 * result.std(axis=0) / np.sqrt(len(places))), name
    for slopes, variance in (("slope", "variance"), ("snowy", "snow_variance")):
        ratio = read(slopes).var(axis=0) / read(variance).mean()
        if pixel == FINE:
            np.testing.assert_allclose(ratio, 1.0, atol=0.04)
        else:
            # Means over a long pixel take it that its places share nothing: along it they do.
            assert ratio.mean() == pytest.approx(1.0, abs=0.25)
    assert np.quantile(read("tone"), 0.001) > -0.9, "no black specks"


def test_nothing_pops_while_the_eye_comes_nearer(on_gpu):
    """Of 600 frames from 300 m to 3 m, each shows a place as the one before, but for a derived share.

    An octave of strength c fades by at most 2 c d(log w) while a pixel's width w changes, times the most
    that it can be (1.33 where round-topped). The places of its mean move by at most 0.375 (2 + 1) w d(log w),
    w at most half a cell, over slopes of at most 4 to a cell. At most three octaves do so at once.
    """
    distance = np.geomspace(300.0, 3.0, 600).astype(np.float32)
    wide = distance * 7e-4
    position = RNG.uniform(0, 5000, (20, 2)).astype(np.float32)
    change = np.log(300 / 3) / 599
    contrast = 0.31 * 1.8
    bound = 3 * contrast * change * (2 * 0.74 + 0.375 * 3 * 0.5 * 4)
    pixel = "PixelOnGround(vec2(2.2 * w, w), 2.42 * w, w)"
    for p in position:
        call = f"bumps_at(p, mat2(1.0), vec3(1.0, 0.0, 0.0), 1.0, {pixel}, 90.0, 0.0).tone"
        result = on_gpu("scene/near/bumps.glsl", call, p=tuple(map(float, p)), w=wide)
        assert abs(np.diff(result)).max() < bound
        assert result.std() > 0.01
    assert bound < 0.05


def test_rock_is_pushed_by_the_slopes_of_its_heights(on_gpu):
    turn = np.array([[0.36, -0.8, 0.48], [0.48, 0.6, 0.64], [-0.8, 0.0, 0.6]])
    places = RNG.uniform(-60, 60, (200, 3)).astype(np.float32)
    call = "cliff_at(p, 1.0, 1.0, 0.0, Layer(0.0, 0.0, 0.0), 1e-4, 10.0).push"
    result = on_gpu("scene/near/cliff.glsl", call, p=places).astype(float)

    def height(place):
        total = 0.0
        for k in range(2, RUNGS):
            cell = COARSEST / 2.0**k
            at = (place * [1, 1, 2.0 if cell < 4 else 0.45] / cell) @ turn.T + 0.618034 * k
            noise = solid(at, lattice_seed(0x4F396EA5, k))
            rough = 0.24 + (0.12 - 0.24) * k / RUNGS
            part = np.clip(2 - cell / 10.0, 0, 1)
            total += part * rough / 0.57515 * cell * (abs(noise) if k % 2 == 0 else noise)
        return total

    for axis in range(3):
        away = 1e-6 * np.eye(3)[axis]
        slope = (height(places + away) - height(places - away)) / 2e-6
        assert (abs(result[:, axis] - slope) > 6e-3).mean() < 0.02


# ── colour ───────────────────────────────────────────────────────────────────


def test_patches_leave_the_mean_colour(on_gpu):
    places = RNG.uniform(0, 30000, (40000, 2)).astype(np.float32)
    call = "dried(vec3(0.2, 0.3, 0.1), variation_at(p, 0.1), 1.0)"
    result = on_gpu("scene/near/variation.glsl", call, p=places).astype(float)
    np.testing.assert_allclose(result.mean(axis=0), [0.2, 0.3, 0.1], rtol=0.01)
    assert np.all(result.std(axis=0) / result.mean(axis=0) > 0.03)


def test_soil_has_the_brightness_of_what_it_replaces(on_gpu):
    colours = RNG.uniform(0.01, 0.9, (100, 3)).astype(np.float32)
    luma = np.array([0.2126, 0.7152, 0.0722])
    result = on_gpu("scene/near/kinds.glsl", "soiled(c, 0.7)", c=colours).astype(float)
    np.testing.assert_allclose(result @ luma, colours @ luma, rtol=1e-5)


def test_rock_grows_with_slope_and_ground_kinds_sum_to_one(on_gpu):
    slope = np.tile(np.linspace(0, 2.5, 200), 5).astype(np.float32)
    patchy = np.repeat(np.linspace(-1, 1, 5), 200).astype(np.float32)
    call = "kinds_of_ground(s, vec2(0.6, 1.1), true, 0.0, 0.3, p, 0.2)"
    result = on_gpu("scene/near/kinds.glsl", call, s=slope, p=patchy).astype(float)
    np.testing.assert_allclose(result.sum(axis=1), 1.0, atol=1e-6)
    rock = result[:, 2].reshape(5, 200)
    assert np.all(np.diff(rock, axis=1) >= 0) and np.all(rock[:, 0] == 0) and np.all(rock[:, -1] == 1)


def test_ripples_of_sand_are_long_across_the_wind(on_gpu):
    for wind in (0.0, 250.0):
        towards = np.array([np.sin(np.radians(wind)), np.cos(np.radians(wind))])
        across = np.array([-towards[1], towards[0]])
        for way, share in ((towards, 1.0), (across, 0.2)):
            call = "grain_of_sand(1.0, w) * d"
            result = on_gpu("scene/near/kinds.glsl", call, w=[wind], d=way[None].astype(np.float32))[0]
            np.testing.assert_allclose(result, share * way, atol=1e-5)


def test_layers_follow_the_height(on_gpu):
    file = "scene/near/strata.glsl"
    height = RNG.uniform(-500, 4000, 3000).astype(np.float32)
    layer = lambda z, name, bent=0.0: on_gpu(  # noqa: E731
        file, f"strata_at(z, b, 12.0, 0.01).{name}", z=np.asarray(z, np.float32), b=bent
    ).astype(float)
    tone = layer(height, "tone")
    np.testing.assert_allclose(layer(height + 16, "tone", 16.0), tone, atol=2e-3)
    step = 2.0**-5
    rise = (layer(height + step, "tone") - layer(height - step, "tone")) / (2 * step)
    assert (abs(layer(height, "rise") - rise) > 0.05 * (1 + abs(rise))).mean() < 0.1, "but at ends of steps"
    assert abs(tone.mean()) < 4 * 0.5 / np.sqrt(4500 / 12.0) and tone.std() > 0.2


def test_axis_aligned_normal_takes_one_triplanar_plane(on_gpu):
    axes = np.eye(3, dtype=np.float32)
    file, call = "texturing/planes.glsl", "planes_of(n, vec2(30.0, 45.0), 4.0)"
    np.testing.assert_allclose(on_gpu(file, call, n=axes), axes, atol=1e-12)
    normals = RNG.normal(size=(500, 3)).astype(np.float32)
    normals[:, 2] = abs(normals[:, 2])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    shares = on_gpu(file, call, n=normals)
    np.testing.assert_allclose(shares.sum(axis=1), 1.0, atol=1e-5)
    flat = normals[:, 2] > np.cos(np.radians(30))
    np.testing.assert_array_equal(shares[flat][:, 2], 1.0)
    # On a slope to the east no plane faces north, and the sides come in evenly by the angle. Mesa's acos
    # is a polynomial, good to 1e-4 radians of the 15 degrees.
    for angle, part in ((30, 0.0), (37.5, 0.5), (42, 0.8), (45, 1.0), (70, 1.0)):
        sine, cosine = np.sin(np.radians(angle)), np.cos(np.radians(angle))
        east = part / (1 + (cosine / sine) ** 4)
        result = on_gpu(file, call, n=np.array([[sine, 0.0, cosine]], np.float32))[0]
        np.testing.assert_allclose(result, [east, 0.0, 1 - east], atol=4e-4)


# ── wet ground, snow ─────────────────────────────────────────────────────────


def test_wet_ground_gives_back_what_its_film_lets_out(on_gpu):
    """By Fresnel's equations over the half sphere, and light counted each time that it comes back."""
    places, weights = np.polynomial.legendre.leggauss(300)
    cosine, weights = (places + 1) / 2, weights / 2
    outside = (reflected(cosine, 1.0, 1.333) * 2 * cosine * weights).sum()
    inside = (reflected(cosine, 1.333, 1.0) * 2 * cosine * weights).sum()
    dry = np.array([0.02, 0.1, 0.3, 0.6, 0.95])
    out, left = np.zeros(5), np.full(5, 1 - outside)
    for _ in range(60):
        left = left * dry
        out += left * (1 - inside)
        left = left * inside
    result = on_gpu("scene/near/wet.glsl", "wet_albedo(vec3(c)).g", c=dry.astype(np.float32)).astype(float)
    np.testing.assert_allclose(result, out, rtol=2e-3)
    assert np.all(result < dry)


@pytest.mark.slow
def test_snow_covers_hollows_first_and_everything_at_last(on_gpu):
    file = "scene/near/snow.glsl"
    over = np.linspace(-0.6, 0.4, 41).astype(np.float32)
    call = "snow_share(d, o, 0.1, h, p)"
    for hidden, patchy in product((0.0, 0.02, 0.1), (-0.9, 0.0, 0.9)):
        value = {"o": over, "h": hidden, "p": patchy}
        assert np.all(on_gpu(file, call, d=0.0, **value) == 0), "no snow, no white"
        depths = [on_gpu(file, call, d=float(d), **value) for d in np.linspace(0, 3, 30)]
        assert np.all(np.diff(depths, axis=0) >= 0) and np.all(depths[-1] == 1)
        assert np.all(np.diff(depths, axis=1) <= 0), "what stands higher is bare longer"


def test_snow_amount_matches_on_resolved_and_unresolved_bumps(on_gpu):
    """Near by, the mean over places; far away, the fraction of a pixel that shows none of its bumps."""
    places = RNG.uniform(0, 5000, (20000, 2)).astype(np.float32)
    files = {name: f"scene/near/{name}.glsl" for name in ("bumps", "snow")}
    call = f"bumps_at(p, mat2(1.0), vec3(1.0, 0.0, 0.0), 1.0, {FINE}, 24.0, 0.0)"
    over, whole, hidden = (
        on_gpu(files["bumps"], f"{call}.{n}", p=places) for n in ("height", "whole", "hidden")
    )
    np.testing.assert_allclose(over.std(), whole[0], rtol=0.1)
    assert hidden.max() < 0.1 * whole[0]
    for depth in (0.06, 0.1, 0.14, 0.2):
        value = {"d": depth, "w": float(whole[0])}
        near = on_gpu(files["snow"], "snow_share(d, o, w, h, 0.0)", o=over, h=hidden, **value).mean()
        far = on_gpu(files["snow"], "snow_share(d, 0.0, w, w, 0.0)", **value)[0]
        assert abs(near - far) < 0.1, depth


LAND = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 t) {{ return {}; }}\n'
EAST, NORTH = "float(t.x) / float(size.x - 1)", "float(t.y) / float(size.y - 1)"


@pytest.fixture
def of_land(any_engine, make_sketch):
    """Give a function that reads a pass's output on 2000 m by 1300 m of 57 by 41 texels, relief 1000 m."""

    def read(use, height, **values):
        value = ", ".join(f"{name} = {value}" for name, value in values.items())
        text = '[[pass]]\nname = "height"\nuse = "./land"\n'
        text += f'[[pass]]\nname = "found"\nuse = "{use}"\nset = {{ {value} }}\n'
        land = LAND.format(height)
        sketch = make_sketch(text, size=[57, 41], extent=[2000.0, 1300.0], relief=1000.0, land=land)
        return any_engine.read(sketch, "found").astype(float)

    return read


def test_snow_depends_on_height_slope_season_and_lee(of_land):
    depth = lambda height, **v: of_land("texturing/snow_depth", height, **{"line": 200.0} | v)  # noqa: E731
    calm = {"season": 0.0, "drift": 0.0, "maximum": 20.0}
    ramp = depth(f"0.6 * {EAST}", **calm)
    expected = np.maximum(0.002 * (np.linspace(0, 600, 57) - 200), 0)
    np.testing.assert_allclose(ramp, np.broadcast_to(expected, ramp.shape), atol=2e-3)
    steeper = [depth(f"0.5 + {s} * ({NORTH} - 0.5)", **calm)[20, 28] for s in (0.0, 0.8, 1.0, 1.3, 1.7)]
    assert np.all(np.diff(steeper) <= 0) and steeper[0] == pytest.approx(0.6, abs=1e-3) and steeper[-1] == 0
    ridge = depth(f"0.6 - 0.5 * abs({EAST} - 0.5)", wind=270.0, season=0.0)
    assert ridge[20, 33] > 1.5 * ridge[20, 23], "the wind blows from the west"
    turned = depth(f"0.6 - 0.5 * abs({EAST} - 0.5)", wind=90.0, season=0.0)
    np.testing.assert_allclose(turned, ridge[:, ::-1], atol=2e-3)
    winter, summer = (depth("0.4", day=day) for day in (46, 228))
    assert winter.min() > 0 and summer.max() == 0


def test_domes_are_exposed_and_bowls_are_not(of_land):
    bent = f"0.2 * (({EAST} - 0.5) * ({EAST} - 0.5) + 0.4225 * ({NORTH} - 0.5) * ({NORTH} - 0.5))"
    dome, bowl = (of_land("texturing/exposed", f"0.5 {sign} {bent}") for sign in "-+")
    inner = np.s_[3:-3, 3:-3]
    # Second differences of a x^2: 2 a a step, in both directions, over the metres of each.
    change = 2 * 2 * 0.2 * 1000 / 2000**2 * 50
    np.testing.assert_allclose(dome[inner], change / (change + 0.15), rtol=0.02)
    np.testing.assert_allclose(bowl, -dome, atol=1e-3)
    np.testing.assert_allclose(of_land("texturing/exposed", f"0.5 * {EAST} + 0.2 * {NORTH}"), 0.0, atol=1e-3)


# ── light ────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("rise", [(0.0, 0.0), (0.4, -0.3)])
@pytest.mark.parametrize("elevation", [5.0, 20.0, 60.0])
def test_a_rough_ground_receives_what_a_smooth_one_does(on_gpu, rise, elevation):
    """Over many bumps pushed along the normal, by a bell curve: sun and sky, within a hundredth."""
    file, count, spread = "scene/near/self_shadow.glsl", 200000, 0.3
    ground = np.array([-rise[0], -rise[1], 1.0]) / np.linalg.norm([*rise, 1.0])
    angle = np.radians(elevation)
    sun = np.array([np.sin(1.1) * np.cos(angle), np.cos(1.1) * np.cos(angle), np.sin(angle)])
    side = np.cross(ground, [0.0, 1.0, 0.0])
    side /= np.linalg.norm(side)
    push = np.random.default_rng(3).normal(0.0, spread, (count, 2)) @ np.array([side, np.cross(ground, side)])
    bumps = ground - push
    bumps /= np.linalg.norm(bumps, axis=1, keepdims=True)
    value = {"b": bumps.astype(np.float32), "g": tuple(map(float, ground)), "s": tuple(map(float, sun))}
    faces = on_gpu(file, "max(facing_of_bumps(b, g, s), 0.0)", **value).astype(float).mean()
    share = on_gpu(file, "sun_past_bumps(dot(g, s), v)", **value | {"v": spread**2})[0]
    smooth = max(ground @ sun, 0.0)
    np.testing.assert_allclose(faces * share, smooth, atol=0.005, rtol=0.01)
    sky = on_gpu(file, "sky_on_bumps(b, g, s)", **value).astype(float).mean()
    np.testing.assert_allclose(sky, 1.0, atol=0.005)


def test_a_ground_that_faces_away_gets_no_sun_by_its_bumps(on_gpu):
    share = on_gpu("scene/near/self_shadow.glsl", "sun_past_bumps(c, 0.1)", c=[-0.5, -1e-3, 0.0])
    np.testing.assert_array_equal(share, 0.0)


COLOUR = (
    '#pragma kernel(output = "colour:rgba16f")\nvec4 kernel(ivec2 t) { return vec4(0.4, 0.5, 0.3, 1.0); }\n'
)
PASSES = '[[pass]]\nname = "height"\nuse = "./land"\n[[pass]]\nname = "colour"\nuse = "./plain"\n'


@pytest.fixture
def from_above(any_engine, make_sketch):
    """Give a function that shades a plane of 2 km seen from a height, and what is set."""

    def read(given, distance=40.0, extra="", wide=2000.0, rise=1.0, **files):
        view = f'[view]\nuse = "scene/terrain"\nset = {{ grid = 33, antialias = false, {given} }}\n'
        sketch = make_sketch(
            PASSES + extra + view,
            size=[33, 21],
            extent=[wide, 0.65 * wide],
            relief=0.1 * wide,
            land=LAND.format(f"{rise} * (0.3 * {EAST} + 0.2 * {NORTH})"),
            plain=COLOUR,
            **files,
        )
        target = (0.45 * wide, 0.35 * wide, 0.025 * wide)
        look = Camera(azimuth=30, elevation=60, distance=distance, target=target)
        sketch = sketch.with_camera(look)
        size = (192, 128)
        frame = any_engine.read(sketch, "view.shaded", size=size)[..., :3].astype(float)
        return frame, any_engine.read(sketch, "view.cover:bumps", size=size).astype(float)

    return read


@pytest.mark.parametrize("elevation", [12, 55])
@pytest.mark.parametrize("wide", [40.0, 2000.0])
def test_detail_leaves_the_mean_light_and_colour(from_above, elevation, wide):
    """Within 6 in 100 at any distance, the stated bound: a picture has few of the widest patches."""
    sun = f"gain = 2.0, ambient = 0.4, sun = {{ azimuth = 250.0, elevation = {elevation} }}"
    distance = 0.4 * wide
    plain, none = from_above(sun, distance, wide=wide)
    assert np.all(none == 0), "switched off it gives no bumps"
    result, bumps = from_above(
        f"{sun}, fine_ground = true, variation = 0.0, soils = 0.0", distance, wide=wide
    )
    np.testing.assert_allclose(result.mean(axis=(0, 1)), plain.mean(axis=(0, 1)), rtol=0.06)
    assert result[..., 1].std() > 3 * plain[..., 1].std() and bumps[..., 2].min() > 0


def test_wet_ground_is_dark_and_shiny_deep_snow_white_and_smooth(from_above):
    field = '#pragma kernel(output = "{0}:r32f")\nfloat kernel(ivec2 t) {{ return {1}; }}\n'
    extra = '[[pass]]\nname = "{0}"\nuse = "./{0}"\n'
    value = "fine_ground = true, gain = 2.0, ambient = 0.4, sun = { azimuth = 250.0, elevation = 40.0 }"
    dry, rough = from_above(value, 8.0)
    damp, _ = from_above(value, 8.0, extra.format("wetness"), wetness=field.format("wetness", 0.5))
    assert 0.35 < damp.mean() / dry.mean() < 0.75
    soaked = {"extra": extra.format("wetness"), "wetness": field.format("wetness", 1.0)}
    assert from_above(value, 8.0, rise=5.0, **soaked)[1][..., 3].max() == 0, "water runs off a slope"
    _, under = from_above(value, 8.0, rise=0.0, **soaked)
    assert under[..., 3].mean() > 0.3
    assert abs(under[..., :2]).mean() < 0.8 * abs(rough[..., :2]).mean()
    snow = field.format("snow_depth", 3.0)
    white, packed = from_above(value, 8.0, extra.format("snow_depth"), snow_depth=snow)
    steps = lambda bumps: np.diff(bumps[..., :2], axis=0).std()  # noqa: E731
    assert white.mean() > 1.6 * dry.mean() and steps(packed) < 0.5 * steps(rough)
