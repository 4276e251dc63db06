"""The same seed is the same terrain at every size: a preview at 257² shows the terrain of 2049²."""

import numpy as np
import pytest

ALIKE = {
    "diamond_square": 0.99,
    "midpoint_displacement": 0.99,
    "triangle_subdivision": 0.99,
    "layered_noise": 0.99,
    "fourier": 0.99,
    "circles": 0.99,
    "delaunay": 0.99,
    "fault_formation": 0.99,
    "fbm": 0.95,  # a larger size adds octaves
    "gradient_noise": 0.95,
    "mixed": 0.95,
    "mixed_tiled": 0.95,
    "layered_noise_tiled": 0.95,
}


@pytest.fixture
def terrain_of(any_engine, make_sketch):
    def terrain(name, size, **values):
        text = "".join(f"{k} = {v!r}\n" for k, v in values.items())
        sketch = make_sketch(
            f'[[pass]]\nname = "a"\nuse = "generation/{name}"\n[pass.set]\n{text}', size=size
        )
        return any_engine.read(sketch, "a").astype(np.float64)

    return terrain


def likeness(small, large):
    """Return the correlation of a terrain with a larger one read at its texels."""
    step = (len(large) - 1) // (len(small) - 1)
    return np.corrcoef(small.ravel(), large[::step, ::step].ravel())[0, 1]


@pytest.mark.parametrize("seed", [7, 1234])
@pytest.mark.parametrize("sizes", [(65, 129), (129, 513), (257, 513)], ids=str)
@pytest.mark.parametrize("name", ALIKE)
def test_a_seed_is_one_terrain(terrain_of, name, sizes, seed):
    """As it comes, normalised or not; a terrain of 33 texels or fewer has no room for its details."""
    small, large = (terrain_of(name, size, seed=seed) for size in sizes)
    assert likeness(small, large) >= ALIKE[name]


@pytest.mark.slow
@pytest.mark.parametrize("name", ALIKE)
def test_a_preview_shows_the_terrain_of_2049(terrain_of, name):
    assert likeness(terrain_of(name, 257, seed=3), terrain_of(name, 2049, seed=3)) >= ALIKE[name]


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("layered_noise", {"random_layers": "independent", "octaves": 4, "persistence": 0.5}),
        ("mixed", {"persistence": 0.2, "shape_range": "none", "normalise": "none"}),
        ("mixed_tiled", {"persistence": 0.2, "tiles": 8, "seams": "left"}),
        ("layered_noise_tiled", {"octaves": 3, "persistence": 0.5}),
        ("diamond_square", {"normalise": "minmax", "random": "positive", "smoothing": 0.9}),
        ("fourier", {"roughness": 1.5, "normalise": "none"}),
    ],
    ids=str,
)
def test_with_any_parameters(terrain_of, name, values):
    assert likeness(terrain_of(name, 129, **values), terrain_of(name, 257, **values)) >= 0.95


def test_halved_terrains_agree_to_the_last_bits(terrain_of):
    """What a coarse level makes, a finer one does not touch: the same points, the same heights."""
    for name in ("diamond_square", "midpoint_displacement", "triangle_subdivision"):
        small, large = (terrain_of(name, size, normalise="none") for size in (65, 257))
        np.testing.assert_allclose(small, large[::4, ::4], atol=2e-6)


@pytest.mark.parametrize("sizes", [(64, 128), (128, 512)], ids=str)
def test_fourier_of_a_power_of_two(terrain_of, sizes):
    small, large = (terrain_of("fourier", size) for size in sizes)
    step = sizes[1] // sizes[0]
    assert np.corrcoef(small.ravel(), large[::step, ::step].ravel())[0, 1] >= 0.99


@pytest.mark.parametrize("name", ["layered_noise", "fourier"])
def test_a_long_terrain(terrain_of, name):
    small, large = (terrain_of(name, [257 * k - k + 1, 129 * k - k + 1]) for k in (1, 2))
    assert np.corrcoef(small.ravel(), large[::2, ::2].ravel())[0, 1] >= 0.99


def test_white_noise_is_texel_by_texel(terrain_of):
    """By its definition it has no shape that a larger size could keep."""
    small, large = terrain_of("white_noise", 129), terrain_of("white_noise", 257)
    assert abs(likeness(small, large)) < 4 / 129
