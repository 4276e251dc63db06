"""Species: their colours through the year, their patches, and who stands where."""

import numpy as np
import pytest

from ..sketch_texts import passes

DAYS = np.arange(0, 366, 5, dtype=np.float32)
BROAD, NEEDLES = (0, 1, 2), (4, 5)


def colours(on_gpu, species, days=DAYS, late=0.0):
    """Return the colours of eight trees of a species, (days, 8, 3)."""
    tint = np.tile((np.arange(8, dtype=np.float32) + 0.5) / 8, len(days))
    day = np.repeat(np.asarray(days, np.float32), 8)
    text = f"tree_colour({species}, tint, {float(late)}, day)"
    return on_gpu("trees/kinds.glsl", text, tint=tint, day=day).reshape(-1, 8, 3)


@pytest.mark.parametrize("species", BROAD + NEEDLES)
def test_crowns_throw_back_what_crowns_were_measured_to(on_gpu, species):
    result = colours(on_gpu, species)
    assert 0.012 < result.min() and result.max() <= 0.27, "0.25 and a tint of 0.08 or less"
    summer = result[(DAYS > 190) & (DAYS < 240), :, 1]
    low, high = (0.02, 0.065) if species in NEEDLES else (0.03, 0.1)
    assert low < summer.min() and summer.max() < high
    assert (result.max((1, 2)) > 0.1).any() == (species in BROAD)


def test_in_october_woods_are_red_yellow_and_green_at_once(on_gpu):
    """Mid-October: birches yellow, maples orange to red, oaks half green, needles green."""
    oak, maple, birch, pine = (colours(on_gpu, k, [290])[0] for k in (0, 1, 2, 4))
    redder = [(oak[:, 0] / oak[:, 1]) for oak in (oak, maple, birch, pine)]
    assert redder[3].max() < 1 < np.median(redder[2]) < 1.6 < redder[1].max()
    assert redder[0].min() < 1 < redder[0].max(), "oaks are on their way"
    assert np.ptp(redder[1]) > 0.5, "one maple is not as the other"


def test_the_mean_tree_is_as_bright_as_its_leaves(on_gpu):
    """Tints differ and take and give nothing: needles at all days, leaves where they are bare."""
    plain = on_gpu("trees/kinds.glsl", "needle_colour(4, t)", t=(np.arange(8, dtype=np.float32) + 0.5) / 8)
    colour = colours(on_gpu, 4, [0])[0]
    assert np.ptp(colour[:, 1] / plain[:, 1]) > 0.2
    np.testing.assert_allclose((colour / plain).mean(0), 1.0, atol=1e-5)


def test_leaves_send_no_more_light_all_round_than_falls_on_them(on_gpu):
    """The mean over the sphere is 1; against the light and along it there is more than aside."""
    rng = np.random.default_rng(2)
    to_eye = rng.normal(size=(200_000, 3))
    to_eye = (to_eye / np.linalg.norm(to_eye, axis=1, keepdims=True)).astype(np.float32)
    sun = np.array([[0.48, 0.6, 0.64]], np.float32)
    result = on_gpu("trees/stand.glsl", "leaf_phase(e, s)", e=to_eye, s=sun)
    assert result.mean(dtype=np.float64) == pytest.approx(1.0, abs=0.003)
    # By leaves that face every way, half of their light on either side, in float64.
    leaf = rng.normal(size=(100_000, 3))
    leaf /= np.linalg.norm(leaf, axis=1, keepdims=True)
    for e in to_eye[:6].astype(float):
        both = 4 * np.abs(leaf @ sun[0]) * np.abs(leaf @ e)
        truth = both.mean()
        k = on_gpu("trees/stand.glsl", "leaf_phase(e, s)", e=e[None].astype(np.float32), s=sun)[0]
        assert k == pytest.approx(truth, abs=0.012)


LEVEL = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 at) { return 0.5; }\n'
MAP = passes(
    height="./level",
    species=("trees/species", "size = [{size}, {size}]", "set = {{ {values} }}"),
    leaves=("trees/leaves", "size = [25, 54]", "set = {{ day = 290 }}"),
)


def shares(engine, make_sketch, values, size=257):
    sketch = make_sketch(
        MAP.format(size=size, values=values), size=[5, 4], extent=[12000.0, 9000.0], level=LEVEL
    )
    return engine.read(sketch, "species").astype(np.float64).copy(), sketch


def test_species_stand_in_patches_whatever_the_map_s_size(kept, ctx, make_sketch):
    result, _ = shares(kept, make_sketch, "needles = 0.2")
    assert result.min() >= 0 and result.sum(-1).max() < 1 + 3 / 255
    assert result[..., 2:].sum(-1).mean() == pytest.approx(0.2, abs=0.015), "as many needles as are asked for"
    for k in range(4):
        assert result[..., k].std() > 0.3 * result[..., k].mean(), "patches"
    # 12 km over 256 steps: 47 m, a third of the finer waves.
    step = np.abs(np.diff(result[..., 0], axis=1)).mean()
    assert step < 0.5 * result[..., 0].std(), "1.13 of it where neighbours know nothing of each other"
    half, _ = shares(kept, make_sketch, "needles = 0.2", size=129)
    np.testing.assert_allclose(half, result[::2, ::2], atol=1.5 / 255)
    for needles, expected in ((0.0, 0.0), (1.0, 1.0)):
        only, _ = shares(kept, make_sketch, f"needles = {needles}", size=33)
        np.testing.assert_allclose(only[..., 2:].sum(-1), expected, atol=1.5 / 255)


HILL = """
#pragma kernel(output = "height:r32f, wetness:r32f")
void kernel(ivec2 at, out float height, out float wetness) {
    height = at.y < 32 ? float(at.y) / 32.0 : 2.0 - float(at.y) / 32.0;
    wetness = at.x > 32 ? 1.0 : 0.0;
}
"""
FACING = passes(
    hill="./hill",
    species=(
        "trees/species",
        'inputs = {{ height = "hill:height" {wired} }}',
        "set = {{ patchy = 0.0, needles = 0.0 }}",
    ),
)


def test_maples_stand_where_it_is_moist_and_oaks_where_it_is_dry(kept, ctx, make_sketch):
    """A ridge from west to east: its southern side faces the sun of noon; its eastern half is wet."""
    sides, halves = (
        kept.read(
            make_sketch(FACING.format(wired=wired), size=65, extent=3000.0, relief=500.0, hill=HILL),
            "species",
        ).astype(np.float64)
        for wired in ("", ', wetness = "hill:wetness"')
    )
    south, north = sides[4:28].mean((0, 1)), sides[36:60].mean((0, 1))
    assert (north[:2] > 1.3 * south[:2]).all()
    dry, wet = halves[:, 4:30].mean((0, 1)), halves[:, 36:60].mean((0, 1))
    assert (wet[:2] > 1.5 * dry[:2]).all()


def test_as_many_trees_are_of_a_species_as_its_share_says(on_gpu):
    """Places are told apart to a quarter of a metre, so that each has random numbers of its own."""
    n = 40_000
    tree = np.zeros((n, 4), np.float32)
    tree[:, 0], tree[:, 1], tree[:, 3] = 9.0 * (np.arange(n) % 200), 9.0 * (np.arange(n) // 200), 20.0
    expected = [0.3, 0.2, 0.15, 0.25]
    kind = on_gpu("trees/crown.glsl", f"float(crown_of(t, vec4{tuple(expected)}).kind)", t=tree).astype(int)
    counts = np.bincount(kind // 8, minlength=6) / n
    np.testing.assert_allclose(counts, [0.1, 0.3, 0.2, 0.0, 0.15, 0.25], atol=4 * np.sqrt(0.25 / n))
    assert np.abs(np.bincount(kind % 8) / n - 1 / 8).max() < 4 * np.sqrt(1 / 8 / n)


def test_wood_colour_is_visible_area_mean_of_its_trees(kept, ctx, on_gpu, make_sketch):
    """By areas of crowns from the side: a b of an ellipse, 2 / pi of that of a cone."""
    _, sketch = shares(kept, make_sketch, "needles = 0.2", size=9)
    table = kept.read(sketch, "leaves").astype(np.float64)
    assert table.shape[:2] == (54, 25)
    for species in BROAD + NEEDLES:
        each = colours(on_gpu, species, [290])[0].astype(np.float64)
        np.testing.assert_allclose(table[8 * species : 8 * species + 8, 12, :3], each, rtol=2e-3)
        np.testing.assert_allclose(table[48 + species, 12, :3], each.mean(0), rtol=2e-3)
        late = colours(on_gpu, species, [290], late=12.0)[0]
        np.testing.assert_allclose(table[8 * species : 8 * species + 8, 24, :3], late, rtol=2e-3)
    rng = np.random.default_rng(4)
    tree = np.tile(np.array([[0, 0, 0, 20.0]], np.float32), (100_000, 1))
    tree[:, :2] = rng.integers(0, 20_000, (100_000, 2))
    others = (0.25, 0.2, 0.15, 0.1)
    crown = f"crown_of(t, vec4{others})"
    area, kind = (on_gpu("trees/crown.glsl", e, t=tree)
                  for e in (f"{crown}.across * {crown}.up", f"float({crown}.kind)"))  # fmt: skip
    kind = kind.astype(int)
    area = area * np.where(kind // 8 == 5, 2 / np.pi, 1.0)
    truth = (table[kind, 12, :3] * area[:, None]).sum(0) / area.sum()
    seen = on_gpu("trees/crown.glsl", f"others_in_sight(vec4{others})", x=[0.0])[0].astype(np.float64)
    seen = [1 - seen.sum(), seen[0], seen[1], 0.0, seen[2], seen[3]]
    np.testing.assert_allclose(np.array(seen) @ table[48:, 12, :3], truth, rtol=0.02)
