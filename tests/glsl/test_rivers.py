"""Rivers by the area that their lines cover, lakes by depth, wetness on planes, water over colours."""

import numpy as np
import pytest

from ..sketch_texts import passes, use

# A river due east through the middle row, or north-east over the diagonal; all else drains nothing.
RIVER = """
#include "water/texels.glsl"
#pragma kernel(output = "receiver:r32f, area:r32f")
uniform int diagonal = 0;     //! slider(0, 1) North-east for east
uniform float drained = 4e6;  //! slider(0, 1e9) m2
void kernel(ivec2 texel, out float receiver, out float area) {
    bool river = diagonal == 1 ? texel.x == texel.y : texel.y == size.y / 2;
    ivec2 to = texel + (diagonal == 1 ? ivec2(1) : ivec2(1, 0));
    receiver = number_of(river && inside(to, size) ? to : texel, size);
    area = river ? drained : 0.0;
}
"""
PASSES = passes(
    ways="./ways",
    rivers=("water/rivers", 'inputs = {{ receiver = "ways:receiver", area = "ways:area" }}', "size = {size}"),
)
EXTENT = 1600.0  # 33 nodes, 50 m apart


def drawn(engine, make_sketch, size, **values):
    sketch = make_sketch(PASSES.format(size=size), size=33, extent=EXTENT, ways=RIVER)
    sketch = sketch.with_values({k.replace("_", ".", 1): v for k, v in values.items()})
    return engine.read(sketch, "rivers:river").copy(), engine.read(sketch, "rivers:width").copy()


@pytest.mark.parametrize("size", [33, 65, 257])
@pytest.mark.parametrize("diagonal", [0, 1])
@pytest.mark.parametrize("wide", [4.0, 17.0, 40.0])
def test_a_river_covers_its_width_at_any_size(engine, make_sketch, size, diagonal, wide):
    """At 4 km2 it is twice as wide as at 1 km2, and its area is its length times that."""
    river, width = drawn(engine, make_sketch, size, ways_diagonal=diagonal, rivers_wide=wide)
    assert river.min() == 0 and river.max() <= 1
    assert width.max() == pytest.approx(2 * wide, rel=1e-5)
    along = river[:, size // 4 : 3 * size // 4 + 1].sum(0).mean() * EXTENT / (size - 1)
    across = along * np.cos(np.pi / 4 * diagonal)
    # A cover is a ramp one texel long. Along a diagonal, texels lie on the line and 0.71 away:
    # (1 + 2 * 0.29) / sqrt(2) = 1.12.
    assert across == pytest.approx(2 * wide, rel=0.125 if diagonal else 0.02)


def test_river_starts_at_drainage_threshold_and_widens_by_power(engine, make_sketch):
    river, _ = drawn(engine, make_sketch, 65, rivers_source=4.1)
    assert not river.any()
    _, width = drawn(engine, make_sketch, 65, rivers_source=3.9, rivers_growth=1.0, rivers_wide=5.0)
    assert width.max() == pytest.approx(20.0, rel=1e-5)


def test_a_bend_is_round_and_joins_up(engine, make_sketch):
    """East, then north-east: the line goes through the middles, and is as wide everywhere."""
    bent = RIVER.replace(
        "texel.y == size.y / 2;", "texel.y == size.y / 2 + max(texel.x - size.x / 2, 0) - 4;"
    ).replace("ivec2(1, 0));", "ivec2(1, texel.x < size.x / 2 ? 0 : 1));")
    sketch = make_sketch(PASSES.format(size=257), size=33, extent=EXTENT, ways=bent)
    river = engine.read(sketch, "rivers:river").copy() > 0.5
    columns = river.sum(0)
    assert columns[8:-8].min() >= 1, "no gap"
    middle = (np.arange(257)[:, None] * river).sum(0) / np.maximum(columns, 1)
    second = np.abs(np.diff(middle[16:240], 2))
    assert second.max() < 0.5 + 1e-6, "rounded to texels, no corner"


GROUND = """
#pragma kernel(output = "height:r32f, level:r32f")
void kernel(ivec2 texel, out float height, out float level) {
    height = 0.1 * float(texel.x);
    level = max(height, 0.5);
}
"""


def test_lakes_are_as_deep_as_the_level_is_above_the_ground(engine, make_sketch):
    text = passes(
        ground="./ground",
        lake=(
            "water/lakes",
            "set = { shallowest = 15 }",
            'inputs = { height = "ground:height", level = "ground:level" }',
        ),
    )
    sketch = make_sketch(text, size=[9, 3], relief=100.0, ground=GROUND)
    expected = [50, 40, 30, 20, 0, 0, 0, 0, 0]
    np.testing.assert_allclose(engine.read(sketch, "lake"), np.tile(expected, (3, 1)), atol=1e-4)


@pytest.mark.parametrize("slope", [0.02, 0.5])
def test_wetness_is_beven_and_kirkbys_index(engine, make_sketch, slope):
    text = passes(
        plane="./plane",
        wetness=("water/wetness", 'inputs = { height = "plane:height", area = "plane:area" }'),
    )
    plane = f"""
#pragma kernel(output = "height:r32f, area:r32f")
void kernel(ivec2 texel, out float height, out float area) {{
    height = {slope} * float(texel.x) * spacing.x / relief;
    area = 1e4 * float(texel.y + 1);
}}
"""
    sketch = make_sketch(text, size=[9, 7], extent=[400.0, 300.0], plane=plane)
    index = np.log(1e4 * np.arange(1, 8) / 50.0 / slope)
    expected = np.clip((index - 5) / 9, 0, 1)
    np.testing.assert_allclose(engine.read(sketch, "wetness")[:, 4], expected, atol=2e-5)


def test_water_lies_over_the_colour(engine, make_sketch):
    text = passes(
        given="./given",
        colour=use(
            "texturing/waters",
            inputs={name: f"given:{name}" for name in ("colour", "river", "lake", "wetness")},
            shallow=(0.0, 1.0, 0.0),
            deep=(0.0, 0.0, 1.0),
            clarity=5,
            shore=2,
            darkening=0.5,
        ),
    )
    value = """
#pragma kernel(output = "colour:rgba32f, river:r32f, lake:r32f, wetness:r32f")
void kernel(ivec2 texel, out vec4 colour, out float river, out float lake, out float wetness) {
    colour = vec4(1.0, 1.0, 1.0, 1.0);
    river = texel.x == 1 ? 0.25 : 0.0;
    lake = texel.x == 2 ? 1.0 : texel.x == 3 ? 100.0 : 0.0;
    wetness = texel.x == 4 ? 1.0 : 0.0;
}
"""
    result = engine.read(make_sketch(text, size=[5, 2], given=value), "colour")[0, :, :3]
    shallow = np.exp(-0.2)
    expected = [
        [1, 1, 1],
        [0.75, 1, 0.75],
        [0.5, 0.5 + 0.5 * shallow, 1 - 0.5 * shallow],
        [0, 0, 1],
        [0.5] * 3,
    ]
    np.testing.assert_allclose(result, expected, atol=2e-3)
