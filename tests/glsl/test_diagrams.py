"""The diagrams of light: their numbers in float64, their colours where geometry says, and what they write."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ..sketch_texts import toml_value

INK = "lighting/diagram/ink.glsl"
LETTERS = "lighting/diagram/letters.glsl"
SIZE = (640, 360)
RELIEF = 900.0
EXTENT = 3200.0
COLUMNS = 65
SPACING = EXTENT / (COLUMNS - 1)

TERRAIN = """
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")
uniform float rough = 1.0;
uniform float step_up = 0.0;    // of all columns from step_at on
uniform int step_at = 40;
float kernel(ivec2 texel) {
    float total = 0.0;
    for (int k = 0; k < 3; k++) {
        float cell = float(16 >> k);
        vec2 place = vec2(texel) / cell;
        ivec2 low = ivec2(place);
        vec2 part = place - vec2(low);
        float south = mix(random(low, uint(k)), random(low + ivec2(1, 0), uint(k)), part.x);
        float north = mix(random(low + ivec2(0, 1), uint(k)), random(low + 1, uint(k)), part.x);
        total += mix(south, north, part.y) * cell / 28.0;
    }
    return rough * total + (texel.x >= step_at ? step_up : 0.0);
}
"""


@pytest.fixture
def diagram(make_sketch):
    """Give a sketch of a terrain and a diagram of it as large as the picture."""

    def make(use, *, size=(COLUMNS, 9), paper=SIZE, rough=1.0, step_up=0.0, extra="", **values):
        values = {"text": False, **values}
        setting = "".join(f"{k} = {toml_value(v)}\n" for k, v in values.items())
        passes = (
            '[[pass]]\nname = "height"\nuse = "./terrain"\n'
            f"set = {{ rough = {rough}, step_up = {step_up} }}\n{extra}"
            f'[[pass]]\nname = "diagram"\nuse = "lighting/diagram/{use}"\nsize = {list(paper)}\n'
            f"inputs = {{ height = 'height' }}\n[pass.set]\n{setting}"
            '[view]\nuse = "view/map"\ninputs = { shown = "diagram" }\n'
        )
        extent = [EXTENT, EXTENT * (size[1] - 1) / (COLUMNS - 1) or 1.0]
        return make_sketch(passes, size=list(size), extent=extent, relief=RELIEF, terrain=TERRAIN)

    return make


def heights_of(engine, sketch, row=4):
    return engine.read(sketch, "height")[row].astype(np.float64) * RELIEF


def paper_of(heights, shown=(0, COLUMNS - 1), foot=0.25):
    """Return a function from metres along and up to pixels, from the picture's lower left corner."""
    scale = SIZE[0] / ((shown[1] - shown[0]) * SPACING)
    lowest = heights[shown[0] : shown[1] + 1].min()
    return lambda along, up: np.array(
        [(along - shown[0] * SPACING) * scale, (up - lowest) * scale + foot * SIZE[1]]
    )


def colour_at(picture, position):
    """Return the colour at a pixel, counted from the lower left corner; row 0 is the lowest."""
    return picture[int(position[1]), int(position[0])]


def paint(name):
    return np.array(
        {
            "ground": (0.58, 0.47, 0.33),
            "free": (0.0, 0.168, 0.445),
            "partly": (0.79, 0.347, 0.0),
            "hidden": (0.434, 0.006, 0.023),
            "sun": (1.0, 0.578, 0.047),
            "dull": (0.25, 0.20, 0.13),
        }[name]
    )


# Pens


def supersampled(inside, shape, many=9):
    """Return the covered part of each pixel, by counting places in it."""
    ny, nx = shape
    at = (np.arange(many) + 0.5) / many
    y, x = np.mgrid[0:ny, 0:nx]
    total = np.zeros(shape)
    for v in at:
        for u in at:
            total += inside(x + u, y + v)
    return total / many**2


def test_pens_cover_what_shapes_cover(on_gpu):
    """A shape's cover is known from the distance to its edge: exact along a straight one, near elsewhere."""
    y, x = np.mgrid[0:60, 0:80]
    places = np.stack([x.ravel() + 0.5, y.ravel() + 0.5], axis=1)
    middle, way = np.array([31.3, 24.8]), np.array([math.cos(0.5), math.sin(0.5)])

    def along(px, py):
        return (px - middle[0]) * way[0] + (py - middle[1]) * way[1]

    def aside(px, py):
        return way[0] * (py - middle[1]) - way[1] * (px - middle[0])

    def angle(px, py):
        return np.arctan2(py - middle[1], px - middle[0])

    def far(px, py):
        return np.hypot(px - middle[0], py - middle[1])

    end = tuple(middle + 33 * way)
    shapes = {
        "dot_cover(place, m, 11.0)": lambda u, v: far(u, v) < 11,
        "line_cover(place, m, end, 4.0)": lambda u, v: (
            np.hypot(aside(u, v), along(u, v) - np.clip(along(u, v), 0, 33)) < 2
        ),
        "half_plane(place, m, end - m)": lambda u, v: aside(u, v) > 0,
        "arc_cover(place, m, 20.0, 0.3, 2.1, 5.0)": lambda u, v: (
            (np.abs(far(u, v) - 20) < 2.5) & (angle(u, v) > 0.3) & (angle(u, v) < 2.1)
        ),
        "sector_cover(place, m, 20.0, 0.3, 2.1)": lambda u, v: (
            (far(u, v) < 20) & (angle(u, v) > 0.3) & (angle(u, v) < 2.1)
        ),
        "arrow_cover(place, m, end, 2.0, 12.0)": lambda u, v: (
            ((np.abs(aside(u, v)) < (33 - along(u, v)) / 3) & (along(u, v) > 21) & (along(u, v) < 33))
            | (np.hypot(aside(u, v), along(u, v) - np.clip(along(u, v), 0, 27)) < 1)
        ),
    }
    for expression, inside in shapes.items():
        result = on_gpu(INK, expression, place=places, m=tuple(middle), end=end).reshape(60, 80)
        expected = supersampled(inside, (60, 80))
        off = np.abs(result - expected)
        assert off.max() < 0.42 and off.mean() < 0.004, expression
        assert result.sum() == pytest.approx(expected.sum(), rel=0.03), expression


def test_dashes_are_half_of_their_line(on_gpu):
    x = np.stack([np.arange(200) + 0.5, np.full(200, 10.5)], axis=1)
    args = {"place": x, "start": (0.0, 10.5), "end": (200.0, 10.5)}
    result = on_gpu(INK, "dash_cover(place, start, end, 3.0, 5.0)", **args)
    assert result[:5].min() > 0.4 and result[6:9].max() == 0
    assert result.sum() == pytest.approx(100, abs=6)


# Letters


def test_numbers_are_written_as_python_writes_them(on_gpu):
    values = np.random.default_rng(5).uniform(-999, 999, 200).astype(np.float32)
    values[:8] = [0, 0.04, -0.04, 9.96, -0.5, 99.96, 1000, -12.34]
    for decimals in (0, 1, 2, 3):
        exact = values.astype(np.float64) * 10**decimals
        sure = np.abs(exact % 1 - 0.5) > 1e-3 + 2e-7 * np.abs(exact)  # a tie may go either way
        shown = values[sure]
        result = on_gpu(
            LETTERS,
            f"number_character(value, {decimals}, place, 9)",
            value=np.repeat(shown, 9),
            place=np.tile(np.arange(9), len(shown)),
        )
        for value, characters in zip(shown, result.reshape(-1, 9), strict=True):
            text = f"{float(value):.{decimals}f}".rjust(9)
            if float(text) == 0:
                text = text.replace("-", " ")
            assert "".join(map(chr, characters)) == text


def test_characters_are_there_and_differ(on_gpu):
    codes = [*range(ord("0"), ord("9") + 1), *range(ord("a"), ord("z") + 1), *map(ord, "V.,:=-`")]
    shapes = glyphs(on_gpu, codes)
    wide = glyphs(on_gpu, codes, around=3)
    for code, shape, larger in zip(codes, shapes, wide, strict=True):
        assert shape.sum() > 2, chr(code)
        assert larger.sum() == pytest.approx(shape.sum(), abs=1e-3), f"{chr(code)} leaves its room"
    differ = np.abs(shapes[:, None] - shapes).sum(axis=(2, 3)) + 9 * np.eye(len(codes))
    assert differ.min() > 3
    assert glyphs(on_gpu, [32, 200]).sum() == 0


def glyphs(on_gpu, codes, around=0):
    """Return how much ink each character lays in each of its 8 x 15 pixels, one of which is a unit."""
    y, x = np.mgrid[-around : 15 + around, -around : 8 + around]
    places = np.stack([x.ravel() - 0.5, y.ravel() - 0.5], axis=1)
    away = on_gpu(
        LETTERS,
        "letter_distance(code, place)",
        code=np.repeat(codes, x.size),
        place=np.tile(places, (len(codes), 1)),
    )
    return np.clip(0.75 - away + 0.5, 0, 1).reshape(len(codes), *x.shape)


@pytest.fixture
def assert_written(on_gpu):
    """Give ``assert_written(picture, corner, text)``: dark where the letters are, light beside them."""

    def check(picture, corner, text):
        x, y = corner
        shape = np.concatenate(glyphs(on_gpu, [ord(c) for c in text.replace("°", "`")]), axis=1)
        # The glyph's first row is one pixel below its line's corner.
        value = picture[y - 1 : y + 14, x : x + shape.shape[1]].mean(axis=-1)
        assert value[shape > 0.95].max() < 0.12, text
        assert value[shape == 0].min() > 0.25, text

    return check


# Horizons


def horizons(heights, column, side):
    """Return the horizon's tangent and column by looking at every texel on one side."""
    best, where = -1e4, -1
    k = column + side
    while 0 <= k < len(heights):
        tangent = (heights[k] - heights[column]) / (abs(k - column) * SPACING)
        if tangent > best:
            best, where = tangent, k
        k += side
    return best, where


@pytest.mark.parametrize("column", [0, 1, 20, 33, 47, 64])
def test_horizons_planes_and_the_sun_s_part(engine, diagram, column):
    sketch = diagram("horizon", row=4, viewpoint=column, elevation=24.0, diameter=9.0, first=5, last=50)
    heights = heights_of(engine, sketch)
    result = engine.read(sketch, "diagram.angles")[0].astype(np.float64)
    low, high = max(column - 1, 0), min(column + 1, COLUMNS - 1)
    slope = (heights[high] - heights[low]) / ((high - low) * SPACING)
    effective = []
    for texel, side in ((0, 1), (1, -1)):
        tangent, where = horizons(heights, column, side)
        effective.append(math.atan(max(tangent, side * slope)))
        np.testing.assert_allclose(result[texel], [tangent, where, side * slope, effective[-1]], atol=2e-5)
    up, down = math.radians(24 + 4.5), math.radians(24 - 4.5)
    seen = min(max((up - effective[0]) / (up - down), 0), 1)
    # The disc's area over the horizon, by counting places on it.
    y, x = np.mgrid[-1:1:801j, -1:1:801j]
    disc = x**2 + y**2 < 1
    area = (y[disc] > 1 - 2 * seen).mean()
    np.testing.assert_allclose(
        result[2], [column * SPACING, heights[column], seen, area], atol=3e-3, rtol=1e-5
    )
    assert result[3, 0] == pytest.approx(heights[5:51].min(), rel=1e-6)


def test_terrain_is_below_its_heights_and_sky_above(any_engine, diagram):
    sketch = diagram("horizon", row=4, viewpoint=32, first=4, last=60)
    picture = any_engine.read(sketch, "diagram")[..., :3]
    heights = heights_of(any_engine, sketch)
    on_paper = paper_of(heights, (4, 60))
    level = on_paper(0, heights[32])[1]
    checked = 0
    for column in range(6, 20):
        position = on_paper((column + 0.5) * SPACING, (heights[column] + heights[column + 1]) / 2)
        steep = abs(heights[column + 1] - heights[column]) / SPACING
        away = np.array([0, 5 + 6 * steep])
        below, above = position - away, position + away
        if min(abs(below[1] - level), abs(above[1] - level)) < 4:
            continue
        checked += 1
        assert colour_at(picture, below)[0] > 1.2 * colour_at(picture, below)[2]
        colour = colour_at(picture, above)
        assert colour[2] > 0.6 or colour[2] > colour[0]  # sky, or the horizon's line on it
    assert checked > 8


def test_horizon_line_touches_terrain_and_arc_spans_its_angle(engine, diagram):
    sketch = diagram("horizon", rough=0.0, step_up=0.4, viewpoint=16)
    picture = engine.read(sketch, "diagram")[..., :3]
    on_paper = paper_of(np.where(np.arange(COLUMNS) >= 40, 0.4, 0.0) * RELIEF)
    eye, touch = on_paper(16 * SPACING, 0), on_paper(40 * SPACING, 0.4 * RELIEF)
    np.testing.assert_allclose(colour_at(picture, touch), paint("free"), atol=0.02)
    np.testing.assert_allclose(colour_at(picture, eye), 0, atol=0.03)
    angle = math.atan2(*(touch - eye)[::-1])
    assert angle == pytest.approx(math.atan(0.4 * RELIEF / (24 * SPACING)), abs=1e-6)
    for share in (0.1, 0.5, 0.9):
        on_line = eye + share * (touch - eye)
        assert colour_at(picture, on_line)[2] > 2 * colour_at(picture, on_line)[0]
        # The arc, 62 pixels away, and what lies inside it.
        on_arc = eye + 62 * np.array([math.cos(share * angle), math.sin(share * angle)])
        np.testing.assert_allclose(colour_at(picture, on_arc), paint("free"), atol=0.25)
    outside = eye + 62 * np.array([math.cos(1.25 * angle), math.sin(1.25 * angle)])
    assert colour_at(picture, outside).min() > 0.6


def test_the_plane_cuts_the_horizon_on_the_side_that_it_rises_to(any_engine, diagram):
    """At the foot of a step the normal leans back; just before its top the terrain is under the plane."""
    sketch = diagram(
        "horizon", shows="effective horizon", rough=0.0, step_up=0.2, viewpoint=40, first=24, last=56
    )
    facts = any_engine.read(sketch, "diagram.angles")[0]
    plane = 0.2 * RELIEF / (2 * SPACING)
    np.testing.assert_allclose(facts[0], [0, 41, plane, math.atan(plane)], atol=1e-5)
    picture = any_engine.read(sketch, "diagram")[..., :3]
    on_paper = paper_of(np.where(np.arange(COLUMNS) >= 40, 0.2, 0.0) * RELIEF, (24, 56))
    eye = on_paper(40 * SPACING, 0.2 * RELIEF)

    def at(radius, angle):
        return colour_at(picture, eye + radius * np.array([math.cos(angle), math.sin(angle)]))

    rise = math.atan(plane)
    np.testing.assert_allclose(at(50, rise + math.pi / 2), 0.012, atol=0.02)  # the normal
    assert at(80, 0.6 * rise)[0] > 1.25 * at(80, 0.6 * rise)[1]  # taken away: reddish
    above = at(80, rise + 0.5)
    assert above[0] > 0.7 and above[0] > above[2]  # the hemisphere: yellowish
    assert at(110, rise + 0.5)[2] > 0.8  # beyond it: sky
    # Seen the other way the plane falls, and takes nothing.
    assert facts[1, 2] < facts[1, 0]


def test_the_sun_s_disc_is_bright_above_the_horizon_only(any_engine, diagram):
    elevation, diameter = 20.0, 12.0
    sketch = diagram(
        "horizon", shows="visibility of the sun", rough=0.0, step_up=0.42, viewpoint=16,
        elevation=elevation, diameter=diameter,
    )  # fmt: skip
    picture = any_engine.read(sketch, "diagram")[..., :3]
    seen = any_engine.read(sketch, "diagram.angles")[0, 2, 2]
    wall = math.degrees(math.atan(0.42 * RELIEF / (24 * SPACING)))
    assert 0.2 < seen < 0.8 and seen == pytest.approx((elevation + 6 - wall) / 12, abs=1e-4)
    heights = np.where(np.arange(COLUMNS) >= 40, 0.42, 0.0) * RELIEF
    eye = paper_of(heights)(16 * SPACING, 0)
    y, x = np.mgrid[0 : SIZE[1], 0 : SIZE[0]] + 0.5
    angles = np.degrees(np.arctan2(y - eye[1], x - eye[0]))
    near = (np.abs(angles - elevation) < 8) & (x > eye[0] + 330)
    yellow = near & (np.abs(picture - paint("sun")).max(axis=-1) < 0.03)
    dull = near & (np.abs(picture - paint("dull")).max(axis=-1) < 0.004)
    assert yellow.sum() > 300 and dull.sum() > 100
    for mask, low, high in ((yellow, wall, elevation + 6), (dull, elevation - 6, wall)):
        assert low - 0.3 < angles[mask].min() and angles[mask].max() < high + 0.3


def test_horizons_are_written_as_they_are(any_engine, diagram, assert_written):
    sketch = diagram("horizon", row=4, viewpoint=33, text=True)
    picture = any_engine.read(sketch, "diagram")[..., :3]
    heights = heights_of(any_engine, sketch)
    for line, (name, side) in enumerate((("east", 1), ("west", -1))):
        angle = math.degrees(math.atan(horizons(heights, 33, side)[0]))
        text = f"{name} {angle:5.1f}° = {max(angle, 0) / 90:.3f} of 90°"
        assert_written(picture, (12, 360 - 31 - 17 * line), text)


def test_the_sun_s_part_is_written_as_it_is(any_engine, diagram, assert_written):
    sketch = diagram(
        "horizon", shows="visibility of the sun", rough=0.0, step_up=0.42, viewpoint=16, elevation=20.0,
        diameter=12.0, text=True,
    )  # fmt: skip
    picture = any_engine.read(sketch, "diagram")[..., :3]
    wall = math.degrees(math.atan(0.42 * RELIEF / (24 * SPACING)))
    above = (wall - 20) / 6
    area = (math.acos(above) - above * math.sqrt(1 - above**2)) / math.pi
    lines = ["sun at 20.0°, 12.0° wide", f"horizon at {wall:5.1f}°"]
    lines.append(f"V = {(26 - wall) / 12:.2f}, area of disc {area:.2f}")
    for line, text in enumerate(lines):
        assert_written(picture, (12, 360 - 31 - 17 * line), text)


# Beams


def walk(heights, column, beam, elevation, radius, delta_r, highest):
    """Return the tests of a beam: (its height, its radius, the free part) each, until it ends."""
    result = []
    climb = math.tan(math.radians(elevation)) * SPACING
    path = SPACING / math.cos(math.radians(elevation))
    for k, other in enumerate(range(column, len(heights))):
        wide = {"ray": 0.0, "cylinder": radius / 255 * RELIEF, "cone": k * path * delta_r}[beam]
        middle = heights[column] + k * climb
        if middle - wide > highest:
            break
        terrain = heights[other]
        if wide == 0:
            part = 0.0 if terrain > middle else 1.0
        else:
            part = min(max((middle + wide - terrain) / (2 * wide), 0), 1)
        result.append((middle, wide, part))
        if part == 0:
            break
    return result


@pytest.mark.parametrize("beam", ["ray", "cylinder", "cone"])
def test_tests_are_those_of_a_slow_walk(engine, diagram, beam):
    seen = set()
    for column, elevation in ((3, 14.0), (20, 8.0), (21, 30.0), (40, 3.0), (48, 1.0), (63, 20.0), (64, 5.0)):
        sketch = diagram(
            "beam", beam=beam, row=4, viewpoint=column, second=10, elevation=elevation,
            radius=20.0, delta_r=0.07, first=3, last=60,
        )  # fmt: skip
        terrain = engine.read(sketch, "height").astype(np.float64) * RELIEF
        result = engine.read(sketch, "diagram.tests").astype(np.float64)
        for row, viewpoint in ((0, column), (1, 10)):
            expected = walk(terrain[4], viewpoint, beam, elevation, 20.0, 0.07, terrain.max())
            parts = [part for *_, part in expected]
            head = [min(parts), len(expected), viewpoint * SPACING, terrain[4, viewpoint]]
            np.testing.assert_allclose(result[row, 0], head, rtol=1e-5, atol=1e-3)
            least = result[row, 1, 0]
            assert (parts[int(least)] if least >= 0 else 1) == pytest.approx(min(parts), abs=1e-4)
            value = result[row, 2:]
            np.testing.assert_allclose(value[: len(expected), :3], expected, rtol=1e-4, atol=2e-3)
            np.testing.assert_array_equal(value[:, 3], np.arange(COLUMNS) < len(expected))
            seen |= {math.ceil(2 * part) for part in parts}
        np.testing.assert_allclose(result[2, 0, :2], [terrain[4, 3:61].min(), terrain.max()], rtol=1e-6)
    assert seen == ({0, 2} if beam == "ray" else {0, 1, 2})


METHODS = {
    "ray": ("lighting/ray_cast", ""),
    "cylinder": ("lighting/soft_cylinder", "radius = 20.0,"),
    "cone": ("lighting/soft_cone", "delta_r = 0.07,"),
}


@pytest.mark.parametrize("beam", METHODS)
def test_what_is_drawn_is_what_the_method_finds(any_engine, diagram, beam):
    use, value = METHODS[beam]
    extra = f'[[pass]]\nname = "light"\nuse = "{use}"\nset = {{ {value} sun = [90.0, 12.0] }}\n'
    sketch = diagram(
        "beam", beam=beam, extra=extra, row=4, elevation=12.0, radius=20.0, delta_r=0.07, paper=(64, 36)
    )
    visible = any_engine.read(sketch, "light.visibility")[4]
    drawn = []
    for column in range(COLUMNS):
        result = any_engine.read(sketch.with_values({"diagram.viewpoint": column}), "diagram.tests")
        drawn.append(result[0, 0, 0])
    np.testing.assert_allclose(visible, drawn, atol=2e-5)
    assert visible.min() < 0.1 and visible.max() > 0.45


def test_on_level_ground_the_cylinder_s_foot_hides_half(engine, diagram):
    sketch = diagram("beam", beam="cylinder", rough=0.0, radius=10.0, viewpoint=20, elevation=50.0)
    facts = engine.read(sketch, "diagram.tests")[0]
    assert facts[0, 0] == 0.5 and facts[1, 0] == 0
    cone = sketch.with_values({"diagram.beam": "cone"})
    assert engine.read(cone, "diagram.tests")[0, 0, 0] == 1


def test_tests_have_the_colours_of_what_they_find(any_engine, diagram):
    """Level ground and a step: the cone is free before it, partly hidden over it; then wholly."""
    heights = np.where(np.arange(COLUMNS) >= 40, 0.3, 0.0) * RELIEF
    for elevation, last in ((16.0, "partly"), (5.0, "hidden")):
        sketch = diagram(
            "beam", beam="cone", rough=0.0, step_up=0.3, viewpoint=16, elevation=elevation, delta_r=0.08
        )
        picture = any_engine.read(sketch, "diagram")[..., :3]
        facts = any_engine.read(sketch, "diagram.tests")[0].astype(np.float64)
        on_paper = paper_of(heights)
        for k, expected in ((8, "free"), (20, "free"), (24, last)):
            middle, wide = facts[2 + k, :2]
            position = on_paper((16 + k) * SPACING, middle)
            np.testing.assert_allclose(colour_at(picture, position), paint(expected), atol=0.03)
            if expected == "partly":
                # The line is amber over the ground, and red in it.
                for up, name in ((middle + 0.9 * wide, "partly"), (middle - 0.9 * wide, "hidden")):
                    position = on_paper((16 + k) * SPACING, up)
                    np.testing.assert_allclose(colour_at(picture, position), paint(name), atol=0.06)
        np.testing.assert_allclose(colour_at(picture, on_paper(16 * SPACING, 0)), paint(last), atol=0.03)
        if last == "hidden":
            # Behind the last test nothing is tested.
            assert facts[0, 1] == 25 and not facts[2 + 25 :, 3].any()


def test_two_rays_one_lit(any_engine, diagram, assert_written):
    sketch = diagram("beam", rough=0.0, step_up=0.3, viewpoint=40, second=30, elevation=20.0, text=True)
    picture = any_engine.read(sketch, "diagram")[..., :3]
    facts = any_engine.read(sketch, "diagram.tests")
    assert [facts[0, 0, 0], facts[1, 0, 0]] == [1, 0]
    heights = np.where(np.arange(COLUMNS) >= 40, 0.3, 0.0) * RELIEF
    on_paper = paper_of(heights)
    for column, expected, text in ((40, "free", "V = 1.00"), (30, "hidden", "V = 0.00")):
        position = on_paper(column * SPACING, heights[column])
        np.testing.assert_allclose(colour_at(picture, position), paint(expected), atol=0.03)
        assert_written(picture, np.floor(position - (32, 27)).astype(int), text)
    assert_written(picture, (12, 329), "ray at 20.0°")
    assert_written(picture, (12, 312), f"tests:{int(facts[0, 0, 1]):3} and{int(facts[1, 0, 1]):3}")


# The grid of texels


@pytest.mark.parametrize("azimuth", [62.0, 180.0, 301.0])
@pytest.mark.parametrize("position", [(20, 4), (64, 4), (0, 0)], ids=str)
def test_the_share_that_is_written_is_the_method_s(any_engine, diagram, assert_written, azimuth, position):
    setting = f"sun = [{azimuth}, 25.0], softness = 0.05, step_length = 2.0"
    extra = f'[[pass]]\nname = "light"\nuse = "lighting/height_difference"\nset = {{ {setting} }}\n'
    sketch = diagram(
        "grid", extra=extra, column=position[0], row=position[1], sun=(azimuth, 25.0), softness=0.05,
        step_length=2.0, text=True, texels=11,
    )  # fmt: skip
    share = any_engine.read(sketch, "light")[position[1], position[0], 3]
    picture = any_engine.read(sketch, "diagram")[..., :3]
    assert_written(picture, (12, 360 - 31 - 51), f"share of light {share:.2f}")
    height = any_engine.read(sketch, "height")[position[1], position[0]] * 255
    assert_written(picture, (12, 329), f"here {height:5.1f}")


def test_texels_above_middle_one_are_brown_and_below_blue(any_engine, diagram, assert_written):
    sketch = diagram("grid", column=32, row=4, sun=(90.0, 25.0), softness=0.05, texels=11, text=True)
    picture = any_engine.read(sketch, "diagram")[..., :3]
    heights = any_engine.read(sketch, "height").astype(np.float64)
    pitch = SIZE[0] / 11
    for row, column in ((4, 30), (5, 29), (3, 35), (6, 34), (2, 36), (4, 28)):
        middle = np.array([(column - 32) * pitch + 320, (row - 4) * pitch + 180])
        colour = colour_at(picture, (middle[0], middle[1] + 0.3 * pitch))
        share = (heights[row, column] - heights[4, 32]) / 0.05
        if abs(share) > 0.1:
            assert (colour[0] > colour[2]) == (share > 0)
        value = f"{255 * heights[row, column]:3.0f}"
        assert_written(picture, np.floor(middle - (12, 0.42 * pitch)).astype(int), value)
    # The ring is on the next texel to the east.
    np.testing.assert_allclose(colour_at(picture, (320 + pitch, 180)), paint("hidden"), atol=0.02)


def test_beyond_the_terrain_there_is_no_height(any_engine, diagram, assert_written):
    sketch = diagram("grid", column=64, row=4, sun=(90.0, 25.0), text=True, texels=11)
    picture = any_engine.read(sketch, "diagram")[..., :3]
    assert_written(picture, (12, 312), "towards the sun no land")
    assert_written(picture, (12, 278), "share of light 1.00")
    assert colour_at(picture, (600, 100)).max() < 0.4


# All of them


@pytest.mark.parametrize("use", ["horizon", "beam", "grid"])
@pytest.mark.parametrize("size", [(1, 1), (2, 2), (1, 9), (9, 1), (129, 3)], ids=str)
def test_tiny_terrains_and_wild_places_are_drawn(any_engine, diagram, use, size):
    wild = [{"text": True}]
    if use == "grid":
        wild += [
            {"column": 4096, "row": 4096, "step_length": 0.0, "text": True},
            {"texels": 40.0, "steps": 64},
        ]
    else:
        shows = {"shows": "visibility of the sun"} if use == "horizon" else {"beam": "cone", "second": 4096}
        wild += [{"row": 4096, "viewpoint": 4096, "first": 4096, "last": 1, **shows}]
        wild += [{"elevation": 89.0, "foot": 0.9, **shows}, {"elevation": 0.0, **shows}]
    for values in wild:
        sketch = diagram(use, size=size, paper=(80, 45), **values)
        assert np.isfinite(any_engine.read(sketch, "diagram")).all()


@pytest.mark.parametrize("use", ["horizon", "beam", "grid"])
def test_a_larger_picture_is_the_same_picture(any_engine, diagram, use):
    large = any_engine.read(diagram(use, paper=(1280, 720)), "diagram")[..., :3]
    small = any_engine.read(diagram(use), "diagram")[..., :3]
    shrunk = large.reshape(360, 2, 640, 2, 3).mean(axis=(1, 3))
    assert np.abs(shrunk - small).mean() < 0.004
    assert np.quantile(np.abs(shrunk - small).max(axis=-1), 0.99) < 0.2
