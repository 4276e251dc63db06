"""Terrain from a file: the real DEM there and back, its metres, other sizes, painted greys."""

import numpy as np
import pytest
from PIL import Image as PillowImage
from scipy.interpolate import RectBivariateSpline

from playground.errors import DataError
from playground.paths import GLSL

from ..loading import load

DEM = GLSL / "sketches" / "data" / "jacksboro_fault_dem.npz"
PASS = '[[pass]]\nname = "terrain"\nuse = "generation/heightmap"\n'


@pytest.fixture
def sketch_of(tmp_path):
    def make(head="", values=""):
        path = tmp_path / "sketch.toml"
        path.write_text(f"format = 1\n{head}\n{PASS}[pass.set]\n{values}\n")
        return load(path)

    return make


@pytest.fixture
def metres():
    """Give the file's own numbers, south first."""
    with np.load(DEM) as archive:
        return archive["elevation"][::-1].astype(np.float64)


def test_a_real_terrain_comes_back_in_metres(engine, sketch_of, metres):
    sketch = sketch_of()
    terrain = engine.plan(sketch, (64, 64)).terrain
    result = engine.read(sketch, "terrain").astype(np.float64)
    assert terrain.size == metres.shape[::-1] and result.shape == metres.shape
    assert (result.min(), result.max()) == (0.0, 1.0)
    assert (terrain.base_elevation, terrain.relief) == (metres.min(), metres.max() - metres.min())
    np.testing.assert_allclose(result * terrain.relief + terrain.base_elevation, metres, atol=1e-4)
    np.testing.assert_array_equal(np.round(result * terrain.relief + terrain.base_elevation), metres)


def test_a_real_terrain_is_as_long_as_its_degrees(engine, sketch_of):
    """Three arc seconds at 36.6 degrees north: about 92.5 m north and 74.5 m east."""
    terrain = engine.plan(sketch_of(), (64, 64)).terrain
    spacing = terrain.extent[0] / (terrain.size[0] - 1), terrain.extent[1] / (terrain.size[1] - 1)
    assert spacing == pytest.approx((74.5, 92.5), abs=0.3)


@pytest.mark.parametrize("size", [(403, 344), (128, 128), (805, 687), (33, 65)], ids=str)
def test_another_size_is_the_same_terrain(engine, sketch_of, metres, size):
    result = engine.read(sketch_of(f"size = {list(size)}"), "terrain")
    heights = (metres - metres.min()) / (metres.max() - metres.min())
    assert result.shape == size[::-1]
    corners = np.ix_([0, -1], [0, -1])
    np.testing.assert_allclose(result[corners], heights[corners], atol=1e-6)
    y, x = (np.linspace(0, n - 1, m) for n, m in zip(heights.shape, size[::-1], strict=True))
    spline = RectBivariateSpline(range(heights.shape[0]), range(heights.shape[1]), heights, kx=1, ky=1)(y, x)
    assert np.abs(result - spline).mean() < (0.003 if size[0] >= 403 else 0.03)
    assert abs(result.mean() - heights.mean()) < 0.01


def test_twice_as_fine_a_grid_keeps_the_texels_of_the_file(engine, sketch_of, metres):
    nx, ny = metres.shape[::-1]
    fine = engine.read(sketch_of(f"size = [{2 * nx - 1}, {2 * ny - 1}]"), "terrain")
    np.testing.assert_allclose(fine[::2, ::2], engine.read(sketch_of(), "terrain"), atol=1e-6)


def test_the_sketch_may_overrule_the_files_metres(engine, sketch_of):
    terrain = engine.plan(
        sketch_of("relief = 10.0\nextent = [5.0, 6.0]\nbase_elevation = -2.0"), (64, 64)
    ).terrain
    assert (terrain.relief, terrain.extent, terrain.base_elevation) == (10.0, (5.0, 6.0), -2.0)


def test_greys_stand_between_two_heights(engine, sketch_of, tmp_path):
    """Section 2.3.1: greys 0..255 are elevations a..b."""
    greys = np.linspace(51, 204, 12).astype(np.uint8).reshape(3, 4)  # north first
    PillowImage.fromarray(greys).save(tmp_path / "grey.png")
    sketch = sketch_of(values='elevation = "grey.png"\nmetres = [100.0, 1120.0]')
    terrain = engine.plan(sketch, (64, 64)).terrain
    relief = engine.read(sketch, "terrain") * terrain.relief + terrain.base_elevation
    np.testing.assert_allclose(relief, 100 + greys[::-1] / 255 * 1020, atol=1e-3)


def test_heights_packed_in_three_channels(engine, sketch_of, tmp_path):
    codes = np.array([[0, 300], [70000, 2**24 - 1]])
    colour = np.stack([codes >> 16, codes >> 8 & 255, codes & 255], axis=-1).astype(np.uint8)
    PillowImage.fromarray(colour).save(tmp_path / "packed.png")
    result = engine.read(sketch_of(values='elevation = "packed.png"\npacking = "rgb"'), "terrain")
    np.testing.assert_allclose(result, codes[::-1] / (2**24 - 1), atol=1e-7)


def test_gaps_are_refused_or_filled(engine, sketch_of, tmp_path):
    terrain = np.add.outer(np.arange(9.0), np.arange(9.0))
    terrain[4, 4] = np.nan
    np.save(tmp_path / "holed.npy", terrain)
    with pytest.raises(DataError, match="no data"):
        engine.read(sketch_of(values='elevation = "holed.npy"'), "terrain")
    result = engine.read(sketch_of(values='elevation = "holed.npy"\nno_data = "fill"'), "terrain")
    assert result[4, 4] == pytest.approx(0.5, abs=1e-3)


def test_raw_numbers_with_their_size(engine, sketch_of, tmp_path):
    codes = np.arange(6, dtype="<u2").reshape(2, 3)
    codes.tofile(tmp_path / "land.r16")
    result = engine.read(sketch_of(values='elevation = "land.r16"\nraw_size = [3, 2]'), "terrain")
    np.testing.assert_allclose(result, codes[::-1] / 5, atol=1e-7)


def test_a_flat_file_is_flat_terrain(engine, sketch_of, tmp_path):
    np.save(tmp_path / "flat.npy", np.full((5, 5), 7.0))
    result = engine.read(sketch_of(values='elevation = "flat.npy"'), "terrain")
    np.testing.assert_array_equal(result, 0)


def test_a_missing_file_names_the_nearest(engine, sketch_of):
    with pytest.raises(DataError, match="jacksboro_fault_dem"):
        engine.read(sketch_of(values='elevation = "sketches/data/jacksboro_fault_den.npz"'), "terrain")
