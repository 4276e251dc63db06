"""texturing/splat_many: the best four of sixteen materials a texel, and the tiles they are read from."""

from __future__ import annotations

import numpy as np
import pytest

from playground.errors import PlaygroundError

COLOUR = '#include "noise/hash.glsl"\n#pragma kernel(output = "colour:rgba16f")\n'
COLOUR += "vec4 kernel(ivec2 texel) {{ return {}; }}\n"
HEIGHT = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) {{ return {}; }}\n'
NAMES = [f"material_{k}" for k in range(1, 17)]
SHADES = np.stack(
    [np.linspace(0.05, 0.8, 16), np.linspace(0.9, 0.1, 16), (np.arange(16) * 7 % 16) / 16], axis=1
)
FLAT = {
    "tile": COLOUR.replace("vec4 kernel", "uniform vec3 shade = vec3(0.0);\nvec4 kernel").format(
        "vec4(shade, 1.0)"
    )
}
NOISE = {
    "tile": COLOUR.replace("vec4 kernel", "uniform vec3 shade = vec3(0.0);\nvec4 kernel").format(
        "vec4(random_pair(texel, uint(shade.x * 999.0)), random(texel, uint(shade.y * 999.0)), 1.0)"
    )
}
TILES = "".join(
    f'[[pass]]\nname = "{n}"\nuse = "./tile"\nsize = 64\nset = {{{{ shade = {shade} }}}}\n'
    for n, shade in zip(NAMES, SHADES.tolist(), strict=True)
)
WIRES = ", ".join(f'{n} = "{n}"' for n in NAMES)
EASTWARD = HEIGHT.format("float(texel.x) / float(size.x - 1)")
MANY = (
    '[[pass]]\nname = "height"\nuse = "./terrain"\n'
    + TILES
    + '[[pass]]\nname = "colour"\nuse = "texturing/splat_many"\n'
)
MANY += f"inputs = {{{{ {WIRES} }}}}\n{{}}"


def bands(random, count=16):
    """Return bands in which many materials overlap: height from and to, slope from and to."""
    low = random.uniform(-0.2, 0.7, count)
    return np.stack(
        [low, low + random.uniform(0.2, 0.9, count), np.full(count, -90.0), np.full(count, 180.0)], 1
    )


def settings(result, **more):
    value = [f"band_{k + 1} = {[float(x) for x in band]}" for k, band in enumerate(result)]
    return "set = { " + ", ".join([*value, *(f"{name} = {value}" for name, value in more.items())]) + " }\n"


def claims(result, heights, fade):
    rising = np.clip((heights - result[:, 0]) / fade + 0.5, 0, 1)
    falling = np.clip((result[:, 1] - heights) / fade + 0.5, 0, 1)
    return rising * falling


@pytest.mark.parametrize("seed", [1, 2])
def test_the_four_largest_claims_count_less_the_fifth(engine, make_sketch, seed):
    result = bands(np.random.default_rng(seed))
    text = MANY.format(settings(result, chance=0, height_fade=0.3))
    sketch = make_sketch(text, size=[129, 3], terrain=EASTWARD, **FLAT)
    chosen = np.round(engine.read(sketch, "colour.choose:chosen")[1] * 255).astype(int)
    weights = engine.read(sketch, "colour.choose:weights")[1].astype(float)
    assert (np.round(weights * 255).sum(axis=-1) == 255).all()
    crowded = 0
    for x, level in enumerate(np.linspace(0, 1, 129)):
        all_ = claims(result, level, 0.3)
        order = np.argsort(-all_, kind="stable")
        left = np.maximum(all_ - all_[order[4]], 0)
        crowded += all_[order[4]] > 0
        if left.sum() < 0.02:
            continue
        expected = left / left.sum()
        shown = np.zeros(16)
        np.add.at(shown, chosen[x], weights[x])
        np.testing.assert_allclose(shown, expected, atol=2.2 / 255)
    assert crowded > 20, "the fifth was never more than nothing"


def test_no_material_appears_or_goes_with_a_jump(any_engine, make_sketch):
    """Every step along 1000 m changes every share by little, though the lists change often."""
    result = bands(np.random.default_rng(3))
    text = MANY.format(settings(result, chance=0.9, grain=400, height_fade=0.3))
    sketch = make_sketch(text, size=[2049, 2], terrain=EASTWARD, **FLAT)
    chosen = np.round(any_engine.read(sketch, "colour.choose:chosen")[0] * 255).astype(int)
    weights = any_engine.read(sketch, "colour.choose:weights")[0].astype(float)
    shown = np.zeros((2049, 16))
    for x in range(2049):
        np.add.at(shown[x], chosen[x], weights[x])
    assert (shown.max(axis=0) > 0.02).sum() >= 8
    lists = np.sort(chosen, axis=1)
    assert (lists[1:] != lists[:-1]).any(axis=1).sum() > 10
    assert np.abs(np.diff(shown, axis=0)).max() < 0.05


def test_unclaimed_texel_takes_first_layer_and_nan_is_harmless(any_engine, make_sketch):
    none = np.tile([2.0, 3.0, 0.0, 90.0], (16, 1))
    terrain = HEIGHT.format("texel.x > 8 ? uintBitsToFloat(0x7fc00000u) : 0.5")
    sketch = make_sketch(MANY.format(settings(none, chance=0)), size=17, terrain=terrain, **FLAT)
    result = any_engine.read(sketch, "colour")
    np.testing.assert_allclose(result[..., :3], np.broadcast_to(SHADES[0], (17, 17, 3)), atol=1e-3)


def test_fewer_materials_leave_the_others_out(any_engine, make_sketch):
    text = MANY.format("set = { materials = 3 }\nsize = 33\n")
    sketch = make_sketch(text, size=33, relief=900.0, terrain=EASTWARD, **FLAT)
    chosen = any_engine.read(sketch, "colour.choose:chosen") * 255
    weights = any_engine.read(sketch, "colour.choose:weights")
    assert chosen[weights > 0].max() < 2.5


def test_chance_parts_materials_that_all_fit_into_patches(any_engine, make_sketch):
    open_ = np.tile([-1.0, 2.0, -90.0, 180.0], (16, 1))
    text = MANY.format(settings(open_, chance=1, grain=200))
    sketch = make_sketch(text, size=65, terrain=HEIGHT.format("0.5"), **FLAT)
    chosen = any_engine.read(sketch, "colour.choose:chosen")[..., 0] * 255
    assert len(np.unique(np.round(chosen))) > 10
    other = any_engine.read(sketch.with_values({"colour.seed": 5}), "colour.choose:chosen")[..., 0] * 255
    assert np.mean(chosen != other) > 0.5


def test_a_seventeenth_material_is_refused_in_one_sentence(make_sketch):
    with pytest.raises(PlaygroundError) as caught:
        make_sketch(MANY.format("set = { materials = 17 }\n"), terrain=EASTWARD, **FLAT)
    assert "materials" in str(caught.value) and "1 to 16" in str(caught.value)
    assert "\n" not in str(caught.value)


# ── tiles ────────────────────────────────────────────────────────────────────


@pytest.mark.slow
def test_the_atlas_holds_every_tile(engine, make_sketch):
    sketch = make_sketch(MANY.format(""), size=33, terrain=EASTWARD, **NOISE).with_values({})
    atlas = engine.read(sketch, "colour.atlas")
    assert atlas.shape == (1024, 1024, 4)
    for k, name in enumerate(NAMES):
        tile = engine.read(sketch, name)[..., :3]
        y, x = k // 4 * 256, k % 4 * 256
        cell = atlas[y : y + 256, x : x + 256, :3]
        # Four times as large: the middle two of each four texels lie around the tile's texel.
        middle = cell.reshape(64, 4, 64, 4, 3)[:, 1:3, :, 1:3].mean(axis=(1, 3))
        corner = (tile + np.roll(tile, 1, 1) + np.roll(tile, 1, 0) + np.roll(tile, (1, 1), (0, 1))) / 4
        np.testing.assert_allclose(cell[::4, ::4][1:, 1:], _between(tile)[1:, 1:], atol=3e-3)
        assert np.abs(middle - tile).mean() < np.abs(corner - tile).mean()


def _between(tile):
    """Return a tile 3/8 of a texel south-west of its texels, around itself."""
    west, south, both = np.roll(tile, 1, 1), np.roll(tile, 1, 0), np.roll(tile, (1, 1), (0, 1))
    part = 3 / 8
    return (1 - part) ** 2 * tile + part * (1 - part) * (west + south) + part**2 * both


@pytest.mark.slow
@pytest.mark.parametrize(("number", "repeats"), [(5, 4), (15, 32)])
def test_a_tile_repeats_and_meets_its_own_copy(any_engine, make_sketch, number, repeats):
    """Waves whose period is the tile go on across it: nothing of the cells beside it is read."""
    wave = COLOUR.format("vec4(vec3(0.5 + 0.4 * sin(6.2831853 * (float(texel.x) + 0.5) / 64.0)), 1.0)")
    alone = np.tile([2.0, 3.0, 0.0, 90.0], (16, 1))
    alone[number] = [-1.0, 2.0, -90.0, 180.0]
    text = MANY.format(settings(alone, chance=0, repeats=repeats) + "size = [401, 5]\n")
    text = text.replace(
        f'name = "{NAMES[number]}"\nuse = "./tile"', f'name = "{NAMES[number]}"\nuse = "./wave"'
    )
    text = "\n".join(line for line in text.split("\n") if f"shade = {SHADES[number].tolist()}" not in line)
    files = {**FLAT, "wave": wave}
    sketch = make_sketch(text, size=33, extent=[1000.0, 10.0], terrain=HEIGHT.format("0.5"), **files)
    row = any_engine.read(sketch, "colour")[2, :, 0].astype(float)
    expected = 0.5 + 0.4 * np.sin(2 * np.pi * np.linspace(0, repeats, 401))
    np.testing.assert_allclose(row, expected, atol=0.012 if repeats == 4 else 0.03)


def test_repeats_beyond_texel_count_give_mean_of_their_tile(any_engine, make_sketch):
    alone = np.tile([2.0, 3.0, 0.0, 90.0], (16, 1))
    alone[6] = [-1.0, 2.0, -90.0, 180.0]
    text = MANY.format(settings(alone, chance=0, repeats=512) + "size = 65\n")
    sketch = make_sketch(text, size=33, terrain=HEIGHT.format("0.5"), **NOISE)
    tile = any_engine.read(sketch, NAMES[6])[..., :3].mean(axis=(0, 1))
    result = any_engine.read(sketch, "colour")[..., :3]
    np.testing.assert_allclose(result, np.broadcast_to(tile, result.shape), atol=0.01)


def test_a_finer_colour_lies_between_the_lists(any_engine, make_sketch):
    """On the nodes of the lists it is their mixture, halfway between them the mean of both."""
    result = bands(np.random.default_rng(7))
    value = settings(result, chance=0, height_fade=0.3)
    coarse, fine = (
        make_sketch(MANY.format(value + f"size = {size}\n"), size=[33, 33], terrain=EASTWARD, **FLAT)
        for size in ("[33, 33]", "[65, 65]")
    )
    nodes = any_engine.read(coarse, "colour").astype(float)
    between = any_engine.read(fine, "colour").astype(float)
    np.testing.assert_allclose(between[::2, ::2], nodes, atol=1e-3)
    np.testing.assert_allclose(between[4, 1::2], (nodes[2, :-1] + nodes[2, 1:]) / 2, atol=2e-3)
