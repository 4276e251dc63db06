"""texturing/grass, mud, path, rock, sand, snow: seamless, of their colours, as many as there are seeds."""

from __future__ import annotations

import numpy as np
import pytest

# Features large enough for a small tile, so that neighbours are alike and a seam would stand out.
COARSE = {
    "grass": "blades = 8, clumps = 2",
    "rock": "blocks = 2",
    "snow": "drifts = 2",
    "sand": "ripples = 4, grain = 0.1",
    "mud": "clods = 2",
    "path": "stones = 4",
}
# Linear light of a mean green, lowest and highest, and which channels follow one another downwards.
PROMISED = {
    "grass": (0.03, 0.2, "grb"),
    "rock": (0.1, 0.4, "rgb"),
    "snow": (0.6, 0.9, "bgr"),
    "sand": (0.25, 0.45, "rgb"),
    "mud": (0.04, 0.12, "rgb"),
    "path": (0.1, 0.25, "rgb"),
}
NAMES = sorted(COARSE)


@pytest.fixture
def tile(make_sketch):
    def sketch(name, size=96, seed=1, more=""):
        text = f'[[pass]]\nname = "colour"\nuse = "texturing/{name}"\n'
        return make_sketch(f"{text}set = {{ {COARSE[name]}, seed = {seed}{more} }}\n", size=size)

    return sketch


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("size", [384, 301])
def test_tile_seam_is_as_smooth_as_its_interior(any_engine, tile, name, size):
    colour = any_engine.read(tile(name, size), "colour")[..., :3].astype(float)
    for axis in (0, 1):
        steps = np.abs(colour - np.roll(colour, 1, axis)).mean(axis=(1 - axis, 2))
        inside, seam = steps[1:], steps[0]
        assert seam <= inside.mean() + 3 * inside.std()


@pytest.mark.parametrize("name", NAMES)
def test_the_mean_is_the_colour_that_the_name_promises(any_engine, tile, name):
    colour = any_engine.read(tile(name), "colour").astype(float)
    assert np.isfinite(colour).all()
    assert (colour[..., 3] == 1).all()
    assert colour.min() > 0
    assert colour.max() <= 1
    red, green, blue = colour[..., :3].mean(axis=(0, 1))
    lowest, highest, order = PROMISED[name]
    assert lowest < green < highest
    channels = [{"r": red, "g": green, "b": blue}[letter] for letter in order]
    assert channels == sorted(channels, reverse=True)
    if name == "rock":
        assert red < 1.6 * blue, "grey rather than brown"
    if name == "sand":
        assert red > 2 * blue, "yellow rather than grey"


@pytest.mark.parametrize("name", NAMES)
def test_another_seed_is_another_tile_of_the_same_kind(any_engine, tile, name):
    first, other = (any_engine.read(tile(name, seed=s), "colour").astype(float)[..., :3] for s in (1, 2))
    spread = first.std(axis=(0, 1)).mean()
    assert np.abs(first - other).mean() > 0.3 * spread
    np.testing.assert_allclose(first.mean(axis=(0, 1)), other.mean(axis=(0, 1)), rtol=0.15)


@pytest.mark.parametrize("name", NAMES)
def test_a_larger_tile_is_the_same_picture_in_more_texels(any_engine, tile, name):
    small = any_engine.read(tile(name, 64), "colour").astype(float)[..., :3]
    large = any_engine.read(tile(name, 192), "colour").astype(float)[..., :3]
    shrunk = large.reshape(64, 3, 64, 3, 3).mean(axis=(1, 3))
    correlation = np.corrcoef(small.sum(-1).ravel(), shrunk.sum(-1).ravel())[0, 1]
    assert correlation > 0.85


@pytest.mark.parametrize("name", NAMES)
def test_a_tint_dyes_the_tile(any_engine, tile, name):
    plain, dyed = (
        any_engine.read(tile(name, more=more), "colour").astype(float)[..., :3].mean(axis=(0, 1))
        for more in ("", ', tint = "#ff0000"')
    )
    assert dyed[0] / dyed.sum() > plain[0] / plain.sum()


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("end", ["low", "high"])
def test_slider_extremes_and_smallest_tiles_give_valid_colours(any_engine, make_sketch, name, end):
    sketch = make_sketch(f'[[pass]]\nname = "c"\nuse = "texturing/{name}"\n', size=17)
    sliders = [p for p in sketch.graph.passes[0].technique.parameters if p.widget.kind == "slider"]
    assert len(sliders) >= 4
    values = {f"c.{p.name}": type(p.default)(getattr(p.widget, end)) for p in sliders}
    for size in (1, 2, 17):
        colour = any_engine.read(sketch.with_values({**values, "size": size}), "c")
        assert colour.shape == (size, size, 4)
        assert np.isfinite(colour).all() and colour.min() >= 0 and colour[..., :3].max() <= 1
