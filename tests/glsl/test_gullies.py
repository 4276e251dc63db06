"""Gullies against their definition in float64, summed over all lattice points, and what must hold of them."""

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from ..sketch_texts import passes
from ..truth.noise import bits, lattice_seed, salt, signed

SIDE = 1.5  # of the lattice's triangles, in widths
ROW = np.sqrt(3) / 2


# ── the truth ────────────────────────────────────────────────────────────────


def lattice_of(width, extent=None):
    """Return (metres between columns, between rows, columns, rows) of one octave; 0 columns: no period."""
    across, up = SIDE * width, SIDE * ROW * width
    if extent is None:
        return across, up, 0, 0
    columns, pairs = max(round(extent[0] / across), 1), max(round(extent[1] / up / 2), 1)
    return extent[0] / columns, extent[1] / (2 * pairs), columns, 2 * pairs


def wave(x, y, turns_x, turns_y, lattice, seed):
    """Return cosine and sine of the random wave: a sum over every lattice point that might be near."""
    across, up, columns, rows = lattice
    total, weights = np.zeros(np.shape(x), complex), np.zeros(np.shape(x))
    near_row = np.floor(y / up)
    near_column = np.floor(x / across - near_row / 2)
    for j in range(-2, 4):
        for i in range(-3, 5):
            row, column = near_row + j, near_column + i
            dx, dy = x - (column + row / 2) * across, y - row * up
            weight = np.maximum(1 - (dx / across / ROW) ** 2 - (dy / up) ** 2, 0) ** 3
            if columns:  # the point of the first tile that it is a copy of, by its place
                column = column + row / 2
                row = np.mod(row, rows)
                column = np.mod(np.round(column - row / 2), columns)
            turns = dx * turns_x + dy * turns_y + signed(bits(column, row, seed)) / 2
            total += weight * np.exp(2j * np.pi * turns)
            weights += weight
    total /= np.maximum(abs(total), 0.35 * weights)
    return total.real, total.imag


def read(z, row, column, tiles):
    ny, nx = z.shape
    if tiles:
        row, column = np.mod(row, ny - 1), np.mod(column, nx - 1)
    return map_coordinates(z, [row, column], order=1, mode="nearest")


def rises(z, spacing, far, tiles):
    """Return the rises to the west and east, south and north, of a distance in metres, over that distance."""
    rows, columns = np.mgrid[: z.shape[0], : z.shape[1]].astype(float)
    result = []
    for axis, (nodes, last) in enumerate(((columns, z.shape[1] - 1), (rows, z.shape[0] - 1))):
        step = max(far / spacing[axis], 1.0)
        back, on = nodes - step, nodes + step
        if not tiles:
            back, on = np.maximum(back, 0), np.minimum(on, last)
        ends = [read(z, rows, p, tiles) if axis == 0 else read(z, p, columns, tiles) for p in (back, on)]
        with np.errstate(invalid="ignore"):
            before = (z - ends[0]) / ((nodes - back) * spacing[axis])
            after = (ends[1] - z) / ((on - nodes) * spacing[axis])
        before, after = np.where(nodes > back, before, after), np.where(on > nodes, after, before)
        result.append((before, after))
    return result


def smoothstep(low, high, x):
    t = np.clip((x - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def gullies(
    z, spacing, *, width=1200.0, strength=0.16, octaves=5, gain=0.5, clear_crests=0.5, corner=(0, 0),
    tiles=False, seed=1,
):  # fmt: skip
    """Return heights [m] and the mask, of heights in metres, rows from the south."""
    z = z.astype(np.float64)
    (west, east), (south, north) = rises(z, spacing, width / 8, tiles)
    gx, gy = (west + east) / 2, (south + north) / 2
    bent = ((east - west) / 2) ** 2 + ((north - south) / 2) ** 2
    whole = (gx**2 + gy**2) / np.maximum(gx**2 + gy**2 + bent, 1e-12)
    rows, columns = np.mgrid[: z.shape[0], : z.shape[1]]
    x, y = corner[0] + columns * spacing[0], corner[1] + rows * spacing[1]
    extent = [(n - 1) * metres for n, metres in zip(z.shape[::-1], spacing, strict=True)]
    mask = weights = 0.0
    for k in range(octaves):
        w, depth = width / 2**k, strength * width * gain**k
        shown = np.clip(w / max(spacing) / 2 - 1, 0, 1)
        if shown == 0:
            break
        steep = np.hypot(gx, gy)
        side_x, side_y = -gy / np.maximum(steep, 1e-6), gx / np.maximum(steep, 1e-6)
        key = lattice_seed(seed + salt("erosion/gullies"), k)
        c, s = wave(x, y, side_x / w, side_y / w, lattice_of(w, extent if tiles else None), key)
        fade = smoothstep(0, 0.5, steep) * whole
        a = shown * depth * np.minimum(steep, 1) * fade
        z = z + a * (c - 0.3)
        gx, gy = gx - a * 2 * np.pi / w * s * side_x, gy - a * 2 * np.pi / w * s * side_y
        mask, weights = mask + 0.7**k * fade * (1 - c) / 2, weights + 0.7**k
        whole = whole * (1 - clear_crests * fade * c**2)
    return z, smoothstep(0.1, 0.6, mask / max(weights, 1))


# ── what is tested ───────────────────────────────────────────────────────────

METRES = 40.0  # from texel to texel
RELIEF = 1000.0
HILLS = """
#pragma kernel(output = "height:r32f")
uniform vec2 origin = vec2(0.0);
float kernel(ivec2 texel) {
    vec2 place = 6.2831853 * (origin + vec2(texel) * spacing) / 2560.0;
    return 0.5 + 0.2 * sin(place.x) * cos(2.0 * place.y) + 0.1 * sin(3.0 * place.y + 1.0)
         + 0.04 * cos(5.0 * place.x + 2.0);
}
"""
TILTED = """
#pragma kernel(output = "height:r32f")
uniform vec2 tilt = vec2(0.0);
float kernel(ivec2 texel) { return 0.5 + dot(tilt, vec2(texel) * spacing) / relief; }
"""
SPIKES = """
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return (texel.x ^ texel.y) % 3 == 0 ? 1e4 * float(texel.x % 5) : -1.0; }
"""


@pytest.fixture
def gullied(engine, make_sketch):
    """Give what draws gullies on a terrain: (heights before [m], after [m], the mask)."""

    def draw(base=HILLS, size=(65, 65), spacing=(METRES, METRES), given="", **values):
        text = ", ".join(f"{k} = {str(v).lower()}" for k, v in values.items())
        extent = [max(n - 1, 1) * metres for n, metres in zip(size, spacing, strict=True)]
        sketch = make_sketch(
            passes(
                raw=("./base", f"set = {{ {given} }}"),
                made=("erosion/gullies", 'inputs = { height = "raw" }', f"set = {{ {text} }}"),
            ),
            size=list(size), extent=extent, relief=RELIEF, base=base,
        )  # fmt: skip
        read = [engine.read(sketch, ref) for ref in ("raw", "made:height", "made:gully")]
        return RELIEF * read[0].astype(np.float64), RELIEF * read[1].astype(np.float64), read[2]

    return draw


@pytest.mark.parametrize("tile", [(0.0, 0.0), (2560.0, 1900.0)], ids=["endless", "tile"])
def test_stripes_are_the_sum_over_the_lattice(on_gpu, tile):
    rng = np.random.default_rng(8)
    places, angles, width = rng.uniform(-1500, 3000, (4000, 2)), rng.uniform(0, 2 * np.pi, 4000), 150.0
    turns = np.stack([np.cos(angles), np.sin(angles)], 1) / width
    places, turns = places.astype(np.float32), turns.astype(np.float32)
    result = on_gpu(
        "noise/stripes.glsl", "stripes(place, turns, cells_of_width(150.0, tile), 77u)",
        place=places, turns=turns, tile=np.float32([tile] * 4000),
    )  # fmt: skip
    lattice = lattice_of(width, tile if tile[0] else None)
    expected = wave(*places.astype(np.float64).T, *turns.astype(np.float64).T, lattice, 77)
    # A place is some 20 cells from the origin: 2**-24 of that, times a cell's turns, 2 pi 1.5, and the
    # polynomials' 1e-5; where waves all but cancel it is divided by 0.35.
    np.testing.assert_allclose(result, np.stack(expected, 1), atol=(20 * 2**-23 * 9.5 + 1e-5) / 0.35)


@pytest.mark.parametrize(
    ("size", "spacing", "values"),
    [
        ((65, 65), (40.0, 40.0), {"octaves": 1}),
        ((65, 65), (40.0, 40.0), {"octaves": 4, "width": 900.0, "seed": 5}),
        ((49, 65), (40.0, 25.0), {"octaves": 3, "gain": 0.7, "clear_crests": 1.0, "corner": [5120.0, -80.0]}),
        ((65, 33), (40.0, 80.0), {"octaves": 3, "width": 600.0, "tiles": True}),
    ],
    ids=["octave", "octaves", "uneven", "tiles"],
)
def test_gullies_are_their_definition(gullied, size, spacing, values):
    before, after, mask = gullied(size=size, spacing=spacing, **values)
    expected, wanted_mask = gullies(before, spacing, **values)
    depth = 0.16 * values.get("width", 1200.0)
    assert np.std(after - before) > 0.05 * depth, "and there are gullies"
    # The wave is off by 1e-4 at the most (above), and each next octave, whose waves turn with it, by
    # 2 pi strength 2 pi 1.3 = 8 times as much, of a depth half as large or less.
    error = abs(after - expected) / depth
    assert error.max() < 1e-4 * 8 ** (values["octaves"] - 1) and np.median(error) < 1e-4
    np.testing.assert_allclose(mask, wanted_mask, atol=3e-4 * 8 ** (values["octaves"] - 1))
    assert 0 <= mask.min() and 0.5 < mask.max() <= 1


def test_flat_terrain_stays_flat(gullied):
    before, after, mask = gullied(TILTED, given="tilt = [0, 0]")
    np.testing.assert_array_equal(after, before)
    assert not mask.any()


@pytest.mark.parametrize("none", [{"strength": 0}, {"octaves": 0}], ids=str)
def test_no_gullies_leave_the_terrain(gullied, none):
    before, after, _ = gullied(**none)
    np.testing.assert_allclose(after, before, rtol=2**-22)  # into metres and back


def test_a_part_equals_the_whole(gullied):
    """Inside of what the slopes of the part's own edge reach, 150 m."""
    _, whole, mask = gullied(size=(65, 65))
    _, part, part_mask = gullied(size=(33, 25), given="origin = [640, 1000]", corner=[640, 1000])
    inside, there = (slice(4, -4), slice(4, -4)), (slice(25 + 4, 50 - 4), slice(16 + 4, 49 - 4))
    np.testing.assert_array_equal(part[inside], whole[there])
    np.testing.assert_array_equal(part_mask[inside], mask[there])


def test_waves_under_two_texels_cost_and_change_nothing(gullied):
    np.testing.assert_array_equal(gullied(octaves=4, width=600)[1], gullied(octaves=8, width=600)[1])


@pytest.mark.parametrize(
    "values",
    [
        {"width": 10000, "strength": 0.5, "octaves": 8, "gain": 1.0},
        {"width": 10, "strength": 0.5, "octaves": 8, "gain": 1.0, "clear_crests": 0.0, "tiles": True},
        {"width": 10000, "strength": 0.5, "octaves": 8, "tiles": True, "corner": [1e7, -1e7]},
    ],
    ids=["wide", "narrow", "far"],
)
def test_hostile_numbers_stay_finite_and_bounded(gullied, values):
    before, after, mask = gullied(SPIKES, size=(33, 17), **values)
    assert np.isfinite(after).all() and 0 <= mask.min() and mask.max() <= 1
    most = 1.3 * values["strength"] * values["width"] * values["octaves"]
    assert abs(after - before).max() <= most + 1e-6 * abs(before).max()
    for size in ((1, 1), (1, 9)):
        assert np.isfinite(gullied(size=size, **values)[1]).all()
