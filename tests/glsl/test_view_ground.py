"""view/ground and the draws over its pixels: places of the terrain, and the pictures of the plain draws."""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine.textures import read_texture
from playground.sketch.model import Camera

from ..sketch_texts import passes
from .test_splat_view import BILINEAR, COLOUR, FLAT, HEIGHT, HILLS, SUN, TERRAIN, VIEW, WEIGHTS, real_terrain

SIZE = (240, 150)
LOOKS = [
    Camera(azimuth=azimuth, elevation=elevation, distance=1500, target=(500, 500, 0))
    for azimuth, elevation in ((200, 35), (20, 60), (110, 12))
]
GROUND = passes(height="./terrain", ground="view/ground")
GROUND += "size = [160, 100]\nset = { grid = 9 }\n[view]\nsamples = 1\n"
READ = GROUND.replace("[view]", '[[pass]]\nname = "place"\nuse = "./place"\nsize = [160, 100]\n[view]')
PLACE = """
#include "view/ground_texel.glsl"
#pragma draw(mesh = "sheet", output = "place:rgba32f", samples = 1)
uniform sampler2D ground;  //! input
vec4 vertex(vec3 corner, out vec3 ray) {
    ray = ray_through(clip_from_world, corner.xy);
    return vec4(corner.xy * 2.0 - 1.0, 0.0, 1.0);
}
vec4 fragment(vec3 ray) {
    Ground seen = ground_of_texel(texelFetch(ground, ivec2(gl_FragCoord.xy), 0).rg, ray);
    return vec4(seen.place, seen.eye_distance, seen.mark);
}
"""
TERRAIN_VIEW = passes(
    height="generation/diamond_square", colour=("./colour", "size = 257"), light="lighting/l_dot_n"
)
GRAINS = '#include "noise/hash.glsl"\n' + COLOUR.partition("\n")[2].format(
    "vec4(vec3(0.2 + 0.6 * random(texel / 4, 3u)), 1.0)"
)


@pytest.fixture
def software(any_engine):
    """Give an engine without a GPU, where draws have fast variants."""
    if not any_engine.info.software:
        pytest.skip("on a GPU draws run in their plain form")
    return any_engine


def unpacked(pairs):
    """Return the two floats of 16 bits that each number holds."""
    bits = np.ascontiguousarray(pairs.astype(np.float32)).view(np.uint32)
    return np.stack([(bits << 16).view(np.float32), (bits & 0xFFFF0000).view(np.float32)], axis=-1)


def forms(engine, sketch, size=SIZE):
    """Return the frame by the fast variant, which has run, by the plain draw, and where they must agree.

    That is where all pixels of a square of four show terrain of one slope: a level of detail follows from
    the slope of a square, which the plain draw takes from each triangle in it, the variant from one.
    """
    result = engine.read(sketch, "view.sea", size=size)[..., :3].astype(float)
    ground = read_texture(engine.record.results["view.land.fast.ground"].textures["ground"])
    slopes = unpacked(np.maximum(ground[..., 1], 0))
    squares = slopes.reshape(size[1] // 2, 2, size[0] // 2, 2, 2)
    low, high = squares.min(axis=(1, 3)), squares.max(axis=(1, 3))
    # Two neighbours of 8 bits.
    alike = ((low > 0) & (high <= low * (1 + 2**-7))).all(axis=-1).repeat(2, 0).repeat(2, 1)
    return result, engine.read(sketch.plainly(), "view.sea", size=size)[..., :3].astype(float), alike


def assert_agree(result, expected, alike, most=1 / 64 + 1e-3):
    """Check that linear frames agree where they must, and anywhere by the bound of the variant.

    A level that is 1/128 off moves a colour by twice that, at most, of what two levels differ by, where the
    driver blends them over half of the way; both forms round to halves.
    """
    assert expected.std() > 0.02 and alike.sum() > 200
    np.testing.assert_allclose(result[alike], expected[alike], atol=most)
    assert np.sqrt(((result - expected) ** 2).mean()) < 0.01


def test_pixel_has_ground_position_distance_and_next_spacing(software, make_sketch):
    """Level ground under a perspective camera: the pixels' rays meet a plane."""
    sketch = make_sketch(READ, terrain=HEIGHT.format("0.0"), place=PLACE).with_camera(LOOKS[0])
    result = software.read(sketch, "ground").astype(float)
    read = software.read(sketch, "place").astype(float)
    eye = software.record.plan.eye
    clip = eye.clip_from_world.astype(float)
    inverse = np.linalg.inv(clip[np.ix_([0, 1, 3], [0, 1, 3])])

    def places(rows, columns):
        position = np.stack([columns / 80 - 1, rows / 50 - 1, np.ones_like(rows)], axis=-1) @ inverse.T
        return position[..., :2] / position[..., 2:]

    rows, columns = np.indices((100, 160)) + 0.5
    position = places(rows, columns)
    inside = ((position > 5) & (position < 995)).all(axis=-1) & (result[..., 0] > 0)
    assert inside.sum() > 2000
    away = np.concatenate([position - eye.position[:2], np.full((100, 160, 1), -eye.position[2])], axis=-1)
    np.testing.assert_allclose(1 / result[..., 0][inside], away[inside] @ clip[3, :3], rtol=1e-5)
    np.testing.assert_allclose(read[..., :2][inside], position[inside], atol=2e-2)
    np.testing.assert_allclose(read[..., 2][inside], np.linalg.norm(away, axis=-1)[inside], rtol=1e-5)
    change = unpacked(result[..., 1])
    # Of a square of four pixels each row, and each column, has one difference.
    low, left = rows - (rows - 0.5) % 2, columns - (columns - 0.5) % 2
    right = np.abs(places(rows, left + 1) - places(rows, left))
    up = np.abs(places(low + 1, columns) - places(low, columns))
    longer = np.linalg.norm(right, axis=-1) > np.linalg.norm(up, axis=-1)
    expected = np.where(longer[..., None], right, up)
    # Seven bits, and differences of positions that are 32-bit floats of up to 1000 m.
    np.testing.assert_allclose(change[inside], expected[inside], rtol=2**-8, atol=5e-4)


def test_walls_and_holes_have_their_mark(any_engine, make_sketch):
    hole = HEIGHT.format("all(lessThan(abs(texel - 16), ivec2(4))) ? uintBitsToFloat(0x7fc00000u) : 0.0")
    sketch = make_sketch(GROUND.replace("grid = 9", "grid = 33"), terrain=hole)
    last = any_engine.read(sketch.with_camera(LOOKS[2]), "ground")[..., 1]
    assert np.count_nonzero(last < -10) > 20
    walls = last[(last < 0) & (last > -10)]
    assert walls.size > 200 and walls.min() >= -1 and np.ptp(walls) > 0.5


@pytest.mark.parametrize("more", ["", ", haze = 0.4", ', blend = "by heights"'])
def test_the_splatted_terrain_is_that_of_the_plain_draw(software, make_sketch, more):
    text = real_terrain("view/splat", 1, more).replace(SUN, "").replace("grid = 65", "grid = 17")
    sketch = make_sketch(text, size=65, relief=200.0)
    for look in LOOKS:
        assert_agree(*forms(software, sketch.with_camera(look)))


def test_with_its_light_it_is_too(software, make_sketch):
    sketch = make_sketch(real_terrain("view/splat", 1), size=65, relief=400.0)
    for look in LOOKS:
        result, expected, _ = forms(software, sketch.with_camera(look))
        assert np.sqrt(((result - expected) ** 2).mean()) < 0.01


@pytest.mark.parametrize(
    "more", ["", "haze = 0.4", 'detail = "geomipmap", tolerance = 4.0', "sea = true, sea_level = 30"]
)
def test_the_terrain_is_that_of_the_plain_draw(software, make_sketch, more):
    view = f'[view]\nuse = "view/terrain"\nsamples = 1\nset = {{ grid = 17{", " if more else ""}{more} }}\n'
    sketch = make_sketch(TERRAIN_VIEW + view, size=65, relief=150.0, colour=GRAINS)
    for look in LOOKS:
        assert_agree(*forms(software, sketch.with_camera(look)))


def test_a_detail_image_and_a_hole_are_those_of_the_plain_draw(software, make_sketch):
    hole = HEIGHT.format("all(lessThan(abs(texel - 16), ivec2(3))) ? uintBitsToFloat(0x7fc00000u) : 0.0")
    text = '[[pass]]\nname = "height"\nuse = "./terrain"\n'
    text += '[[pass]]\nname = "detail_image"\nuse = "./colour"\nsize = 64\n'
    text += '[view]\nuse = "view/terrain"\nsamples = 1\nset = { grid = 17, detail_repeats = 6 }\n'
    sketch = make_sketch(text, terrain=hole, colour=GRAINS).with_camera(LOOKS[0])
    result, expected, alike = forms(software, sketch)
    magenta = (expected == (1, 0, 1)).all(axis=-1)
    assert magenta.sum() > 20
    np.testing.assert_array_equal((result == (1, 0, 1)).all(axis=-1), magenta)
    assert_agree(result, expected, alike)


def test_small_tiles_have_the_level_of_the_plain_draw(software, make_sketch):
    """Level ground in perspective, tiles of many texels: from the finest level to the mean."""
    spread = WEIGHTS.format("vec2 s = vec2(texel) / vec2(size - 1)", BILINEAR)
    text = TERRAIN + VIEW.format("view/splat", 1, ", repeats = 40")
    sketch = make_sketch(text, terrain=HEIGHT.format("0.0"), weights=spread, **{**FLAT, "rock": GRAINS})
    look = Camera(azimuth=180, elevation=15, distance=700, target=(500, 500, 0))
    assert_agree(*forms(software, sketch.with_camera(look)))


@pytest.mark.parametrize(
    ("values", "samples"),
    [
        ({"view.wireframe": True}, 1),
        ({"view.facets": True}, 1),
        ({}, 4),
        ({"view.land.wire": (0.0, 0.0, 1.0)}, 1),
    ],
)
def test_what_the_variant_lacks_has_the_plain_draw_run(any_engine, make_sketch, values, samples):
    text = f'[view]\nuse = "view/terrain"\nsamples = {samples}\nset = {{ grid = 17 }}\n'
    sketch = make_sketch('[[pass]]\nname = "height"\nuse = "./terrain"\n' + text, terrain=HILLS)
    any_engine.render(sketch.with_values(values), size=(48, 30))
    assert not [step.path for step in any_engine.record.plan.walk() if ".fast." in step.path]
    any_engine.render(sketch.with_picture(samples=1), size=(48, 30))  # and back
    paths = [step.path for step in any_engine.record.plan.walk()]
    assert ("view.fast.ground" in paths) == any_engine.info.software


@pytest.mark.parametrize("sea", ["false", "true"])
@pytest.mark.parametrize("view", ["view/terrain", "view/splat"])
def test_the_sky_is_there_where_nothing_else_is(software, make_sketch, view, sea):
    """In the whole view's variant the terrain comes first; the picture has sky, sea and terrain as before."""
    more = f', haze = 0.3, sea = {sea}, sea_level = 60, zenith = "#103080"'
    text = real_terrain(view, 1, more)
    sketch = make_sketch(text, size=65, relief=200.0)
    for look in LOOKS:
        seen = sketch.with_camera(look)
        result = software.render(seen, size=SIZE).array.astype(int)
        assert "view.fast.sky" in [step.path for step in software.record.plan.walk()]
        plain = software.render(seen.plainly(), size=SIZE).array.astype(int)
        ground = software.read(seen.plainly(), "view.land", size=SIZE)
        sky = software.read(seen.plainly(), "view.sky", size=SIZE)
        empty = (ground == sky).all(axis=-1)[::-1]
        assert empty.mean() > 0.1
        # Rays to a pixel's middle, which are interpolated or of whole numbers.
        np.testing.assert_allclose(result[empty], plain[empty], atol=1)
        assert np.sqrt(((result - plain) ** 2).mean()) < 0.02 * 255
