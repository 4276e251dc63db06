"""Sources: what an elevation file says of its terrain, and the heights it becomes."""

from __future__ import annotations

import os

import numpy as np
import pytest

from playground import memo
from playground.data.content_hash import content_key
from playground.engine import file_sources
from playground.engine.source_kinds import Terrain
from playground.engine.sources import SOURCES, source_kind
from playground.errors import DataError, SketchError
from playground.paths import GLSL
from playground.sketch.techniques import read_technique

KIND = source_kind("elevation_file")
HEIGHTS = np.array([[10, 20, 30], [40, 60, 50]], np.uint8)  # first row first


@pytest.fixture
def values(tmp_path):
    np.save(tmp_path / "a.npy", HEIGHTS.astype(np.float32))

    def values_(**changes):
        defaults = {p.name: p.default for p in read_technique("generation/heightmap", GLSL, GLSL).parameters}
        return defaults | {"elevation": str(tmp_path / "a.npy")} | changes

    return values_


def test_the_kernel_declares_what_the_source_reads():
    parameters = read_technique("generation/heightmap", GLSL, GLSL).parameters
    assert {*KIND.parameters, *KIND.optional} == {p.name for p in parameters}
    menus = {p.name: p.widget.choices for p in parameters if p.widget.kind == "menu"}
    assert menus == {
        "packing": ("grey", "rgb"),
        "no_data": ("refuse", "fill"),
        "first_row": ("north", "south"),
    }
    assert all(name in KIND.parameters for name in KIND.files)


def test_triangulation_kernel_declares_parameters_of_its_source():
    kind = source_kind("delaunay")
    parameters = read_technique("generation/delaunay/triangulation", GLSL, GLSL).parameters
    assert set(kind.parameters) == {p.name for p in parameters}
    menus = {p.name: p.widget.choices for p in parameters if p.widget.kind == "menu"}
    assert menus == {
        "weights": ("equal", "random"),
        "method": ("destruction and construction", "flips"),
        "heights": ("random", "displaced"),
    }
    assert kind.describe({p.name: p.default for p in parameters}) == Terrain()
    made = kind.make({p.name: p.default for p in parameters}, (16, 8))
    assert {name: table.shape for name, table in made.items()} == dict.fromkeys(
        ("places", "triangles", "neighbours", "last"), (8, 16, 4)
    )


@pytest.mark.parametrize(("first_row", "south_first"), [(0, HEIGHTS[::-1]), (1, HEIGHTS)])
def test_the_first_row_is_north_unless_it_is_set_to_south(values, first_row, south_first):
    made = KIND.make(values(first_row=first_row), (3, 2))["height"]
    np.testing.assert_allclose(made, (south_first - 10.0) / 50.0, atol=1e-7)


@pytest.mark.parametrize("size", [(3, 2), (64, 33), (257, 300), (2, 2)])
def test_heights_stay_from_0_to_1_at_any_size(values, size):
    made = KIND.make(values(), size)["height"]
    assert made.shape == size[::-1] and made.dtype == np.float32
    assert made.min() >= 0.0 and made.max() <= 1.0


def test_a_steep_file_stays_in_its_range_too(values, tmp_path):
    steps = np.zeros((64, 64), np.float32)
    steps[::5] = 100.0
    np.save(tmp_path / "b.npy", steps)
    for size in ((300, 300), (129, 65), (50, 40)):
        made = KIND.make(values(elevation=str(tmp_path / "b.npy")), size)["height"]
        assert made.min() >= 0.0 and made.max() <= 1.0


def test_flat_terrain_is_0(values, tmp_path):
    np.save(tmp_path / "flat.npy", np.full((4, 4), 7.0))
    assert (KIND.make(values(elevation=str(tmp_path / "flat.npy")), (9, 9))["height"] == 0).all()


def test_user_metres_map_full_range_of_file_codes(values, tmp_path):
    from PIL import Image

    Image.fromarray(HEIGHTS).save(tmp_path / "a.png")
    terrain = KIND.describe(values(elevation=str(tmp_path / "a.png"), metres=(100.0, 355.0)))
    assert (terrain.size, terrain.extent) == ((3, 2), None)
    assert (terrain.base_elevation, terrain.relief) == pytest.approx((110.0, 50.0))  # a metre a grey
    silent = KIND.describe(values(elevation=str(tmp_path / "a.png")))
    assert (silent.base_elevation, silent.relief) == (None, None)


def test_a_file_is_read_anew_when_it_changes(values, tmp_path):
    first = KIND.make(values(), (3, 2))["height"]
    np.save(tmp_path / "a.npy", np.flip(HEIGHTS).astype(np.float64))
    assert not np.array_equal(KIND.make(values(), (3, 2))["height"], first)


def replaced(path):
    new = path.with_name("new.npy")
    np.save(new, np.flip(HEIGHTS).astype(np.float32))
    new.replace(path)


def rewritten(path):
    np.save(path, np.flip(HEIGHTS).astype(np.float32))


@pytest.mark.parametrize("large", [2**26, 1])
@pytest.mark.parametrize("change", [replaced, rewritten])
def test_a_file_of_the_same_size_and_time_is_read_anew(values, tmp_path, monkeypatch, change, large):
    monkeypatch.setattr("playground.data.content_hash._LARGE", large)
    file = tmp_path / "a.npy"
    an_hour_ago = file.stat().st_mtime_ns - 3600 * 10**9
    os.utime(file, ns=(an_hour_ago, an_hour_ago))
    first = KIND.make(values(), (3, 2))["height"]
    change(file)
    os.utime(file, ns=(an_hour_ago, an_hour_ago))
    np.testing.assert_array_equal(KIND.make(values(), (3, 2))["height"], np.flip(first))


def test_a_file_that_does_not_change_is_read_once(values, tmp_path, monkeypatch):
    file = tmp_path / "a.npy"
    os.utime(file, (0, 0))
    value = values()
    first = KIND.make(value, (3, 2))["height"]
    monkeypatch.setattr("playground.data.arrays.open_regular", None)
    np.testing.assert_array_equal(KIND.make(value, (3, 2))["height"], first)


def test_large_heights_are_freed_after_upload_and_stay_described(values, tmp_path, monkeypatch):
    os.utime(tmp_path / "a.npy", (0, 0))
    value = values()
    terrain, kept = KIND.describe(value), KIND.make(value, (3, 2))["height"]
    monkeypatch.setattr("playground.engine.file_sources.KEPT", 1)
    np.testing.assert_array_equal(KIND.make(value, (3, 2))["height"], kept)
    assert memo.SOURCES.count_of(file_sources._whole) == 0
    for module in ("arrays", "grid"):
        monkeypatch.setattr(f"playground.data.{module}.open_regular", None)
    assert KIND.describe(value) == terrain
    with pytest.raises(DataError):
        KIND.make(value, (3, 2))


def test_a_large_file_is_not_read_to_be_known(tmp_path, monkeypatch):
    file = tmp_path / "holes.npy"
    with file.open("wb") as handle:
        handle.truncate(2**31)
    monkeypatch.setattr("playground.data.content_hash.content_hash", None)
    text = content_key(file)
    os.utime(file, ns=(0, 0))
    assert content_key(file) != text


def test_a_missing_file_and_an_unknown_source_are_sentences(values, tmp_path):
    with pytest.raises(DataError, match="cannot be read"):
        KIND.describe(values(elevation=str(tmp_path / "none.npy")))
    with pytest.raises(SketchError, match="did you mean 'elevation_file'"):
        source_kind("elevation_fil")
    assert list(SOURCES) == [
        "elevation_file",
        "delaunay",
        "example_file",
        "ranked_heights",
        "mask_file",
        "array_file",
        "numbers_file",
        "vector_file",
        "model_file",
        "video_file",
        "sound_file",
        "keyboard",
        "microphone",
        "camera",
    ]
