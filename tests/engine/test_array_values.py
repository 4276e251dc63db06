"""Arrays where files are taken: what is drawn of them, that they are copied, and what is refused."""

from __future__ import annotations

import gc
import json
import pickle
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from rasterio.crs import CRS

import playground
from playground.engine.sources import SOURCES
from playground.publish.web.page_data import page_data
from playground.sketch.arrays import GRIDS, PICTURES
from playground.sketch.save import save_copy

# Every corner differs, and no row is another backwards.
HEIGHTS = np.array([[0, 1, 2, 3, 4], [9, 8, 7, 5, 6], [10, 12, 11, 14, 13], [15, 18, 17, 16, 19]], np.float32)
SHARES = HEIGHTS / np.float32(19)
UTM = CRS.from_epsg(32633).to_wkt()


@dataclass
class Labelled:
    """What xarray.DataArray has of itself."""

    values: np.ndarray
    dims: tuple[str, ...] = ("y", "x")
    places: dict[str, Any] = field(default_factory=dict)
    units: str = ""
    name: str = "dem"
    rio: Any = None
    attrs: dict[str, str] = field(default_factory=dict)

    @property
    def coords(self) -> dict[str, Any]:
        return {dim: Coordinate(np.asarray(v), {"units": self.units}) for dim, v in self.places.items()}

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return np.array(self.values, dtype)


@dataclass
class Coordinate:
    values: np.ndarray
    attrs: dict[str, str]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        return np.array(self.values, dtype)


@pytest.fixture(scope="module")
def sketch() -> playground.Sketch:
    return playground.load("jacksboro")


def given(sketch: playground.Sketch, array: object) -> playground.Sketch:
    return sketch.with_values({"height.elevation": array})


def file_of(sketch: playground.Sketch) -> Path:
    return Path(str(dict(sketch.overrides)["height.elevation"]))


@pytest.mark.parametrize("dtype", ["f4", "f8", ">f4", "i2", "u1", "f2"])
def test_heights_come_back_as_they_were_given(any_engine, sketch, dtype):
    result = any_engine.read(given(sketch, HEIGHTS.astype(dtype)), "height")
    np.testing.assert_allclose(result, SHARES, atol=1e-6)  # (ny, nx), row 0 in the south both ways


def test_what_was_read_can_be_given_again(any_engine, sketch):
    once = any_engine.read(given(sketch, HEIGHTS[:, ::-1]), "height")
    again = any_engine.read(given(sketch, once), "height")
    np.testing.assert_array_equal(again, once)


def test_an_array_is_copied(any_engine, sketch):
    mine = HEIGHTS.copy()
    changed = given(sketch, mine)
    mine[:] = 0.0
    np.testing.assert_allclose(any_engine.read(changed, "height"), SHARES, atol=1e-6)
    assert not file_of(changed).stat().st_mode & 0o222


def test_a_sketch_with_an_array_is_a_value(any_engine, sketch):
    first, same = given(sketch, HEIGHTS), given(sketch, np.asfortranarray(HEIGHTS))
    other = given(sketch, HEIGHTS + np.eye(4, 5, dtype=np.float32))
    assert first == same and hash(first) == hash(same) and first != other
    assert pickle.loads(pickle.dumps(first)) == first
    marks = [any_engine.fingerprint(s, size=(32, 18)) for s in (first, same, other)]
    assert marks[0] == marks[1] != marks[2]
    any_engine.read(first, "height")
    any_engine.read(same, "height")
    assert any_engine.record.ran == [], "the same numbers are not read again"
    np.testing.assert_array_equal(any_engine.read(other, "height").shape, (4, 5))


def test_the_file_goes_with_the_last_sketch(sketch):
    first = given(sketch, HEIGHTS * np.float32(3.5))
    second, path = first.with_values({"height.no_data": "fill"}), file_of(first)
    del first
    gc.collect()
    assert path.is_file()
    del second
    gc.collect()
    assert not path.exists()
    assert file_of(given(sketch, HEIGHTS * np.float32(3.5))) == path


OPENED = """
import pickle, sys
import playground
sketch = pickle.loads(sys.stdin.buffer.read())
with playground.headless() as engine:
    print(engine.fingerprint(sketch, size=(32, 18)))
"""


@pytest.mark.slow
def test_another_process_has_the_array_though_its_file_is_gone(any_engine, sketch):
    array = HEIGHTS * np.float32(2.25)
    changed = given(sketch, array)
    data, path = pickle.dumps(changed), file_of(changed)
    del changed
    gc.collect()
    assert not path.exists()
    done = subprocess.run([sys.executable, "-c", OPENED], input=data, capture_output=True, check=True)
    with playground.headless() as engine:
        assert done.stdout.decode().strip() == engine.fingerprint(given(sketch, array), size=(32, 18))


def test_nan_is_no_data_as_in_files(any_engine, sketch):
    gaps = HEIGHTS.copy()
    gaps[1, 2] = np.nan
    masked = np.ma.masked_equal(HEIGHTS, HEIGHTS[1, 2])
    for array in (gaps, masked):
        with pytest.raises(playground.DataError, match="1 of 20 texels have no data"):
            any_engine.read(given(sketch, array), "height")
        filled = given(sketch, array).with_values({"height.no_data": "fill"})
        assert np.isfinite(any_engine.read(filled, "height")).all()


NORTH_FIRST = {"x": [500.0, 530.0, 560.0, 590.0, 620.0], "y": [90.0, 70.0, 50.0, 30.0]}
SOUTH_FIRST = NORTH_FIRST | {"y": NORTH_FIRST["y"][::-1]}


@pytest.mark.parametrize(
    "labelled",
    [
        Labelled(HEIGHTS, places=SOUTH_FIRST),
        Labelled(HEIGHTS[::-1], places=NORTH_FIRST),
        Labelled(HEIGHTS[::-1, ::-1], places=NORTH_FIRST | {"x": NORTH_FIRST["x"][::-1]}),
        Labelled(HEIGHTS.T, ("x", "y"), SOUTH_FIRST),
        Labelled(HEIGHTS[None, ::-1], ("band", "y", "x"), NORTH_FIRST),
        Labelled(HEIGHTS, places={k: np.array(v) / 1000 for k, v in SOUTH_FIRST.items()}, units="km"),
    ],
)
def test_array_coordinates_set_row_order_and_spacing(any_engine, sketch, labelled):
    metres = any_engine.metres(given(sketch, labelled), "height")
    np.testing.assert_allclose(metres, HEIGHTS, atol=1e-5)
    terrain = any_engine.record.plan.terrain
    assert terrain.extent == pytest.approx((120.0, 60.0)) and terrain.size == (5, 4)
    assert terrain.relief == pytest.approx(19.0)


@pytest.mark.parametrize("places", [{}, SOUTH_FIRST])
def test_an_array_s_own_unit_counts(any_engine, sketch, places):
    labelled = Labelled(HEIGHTS, places=places, attrs={"units": "ft"})
    metres = any_engine.metres(given(sketch, labelled), "height")
    np.testing.assert_allclose(metres, HEIGHTS * 0.3048, atol=1e-5)


def test_a_reference_system_of_rioxarray_is_kept(any_engine, sketch):
    rio = SimpleNamespace(crs=SimpleNamespace(to_wkt=lambda: UTM), nodata=8.0)
    labelled = Labelled(HEIGHTS[::-1], places=NORTH_FIRST, rio=rio)
    result = given(sketch, labelled).with_values({"height.no_data": "fill"})
    any_engine.read(result, "height")
    position = any_engine.record.plan.terrain.place
    assert position.crs.name == "EPSG:32633" and position.bounds == (500.0, 30.0, 620.0, 90.0)
    with pytest.raises(playground.DataError, match="1 of 20 texels have no data"):  # the 8 is a gap
        any_engine.read(given(sketch, labelled), "height")


def test_degrees_become_metres(any_engine, sketch):
    step = 1 / 3600
    places = {"lat": 36.0 + step * np.arange(4), "lon": -84.0 + step * np.arange(5)}
    labelled = Labelled(HEIGHTS, ("lat", "lon"), places, "degrees_east")
    any_engine.read(given(sketch, labelled), "height")
    east, north = any_engine.record.plan.terrain.extent
    # A second of arc on WGS 84 at 36 degrees: 30.82 m to the north; to the east cos(36°) of 30.99 m.
    assert (east / 4, north / 3) == pytest.approx((25.05, 30.82), abs=0.05)


def test_xarray_itself(any_engine, sketch):
    xarray = pytest.importorskip("xarray")
    array = xarray.DataArray(HEIGHTS[::-1], dims=("y", "x"), coords=NORTH_FIRST, name="a name / with signs")
    np.testing.assert_allclose(any_engine.metres(given(sketch, array), "height"), HEIGHTS, atol=1e-5)
    with pytest.raises(playground.ParameterError, match=r"height\.elevation: this Dataset gives no array"):
        given(sketch, array.to_dataset(name="dem"))


@pytest.mark.parametrize(
    ("array", "sentence"),
    [
        (np.zeros(5), r"height.elevation = an array of float64 \(5,\): expected numbers \(ny, nx\)"),
        (np.zeros((1, 5)), "at least 2 x 2"),
        (np.zeros((4, 5), complex), "complex128"),
        (np.array([["a", "b"], ["c", "d"]]), "expected numbers"),
        (np.where(HEIGHTS == 8, np.inf, HEIGHTS), "row 1, column 1 is infinite"),
        (np.full((3, 3), np.nan), "all are NaN"),
        (Labelled(HEIGHTS, places=SOUTH_FIRST | {"x": [0.0, 1, 2, 3, 5]}), "'x' are 1 to 2 apart"),
        (Labelled(HEIGHTS, places=SOUTH_FIRST, units="ft"), "coordinates in 'ft'; expected m, km or degrees"),
    ],
)
def test_what_is_no_grid_is_refused_in_a_sentence(sketch, array, sentence):
    with pytest.raises(playground.ParameterError, match=sentence):
        given(sketch, array)


def test_sketch_copy_saves_its_array_and_pack_is_refused(any_engine, sketch, tmp_path):
    changed = given(sketch, HEIGHTS)
    copied = playground.load(save_copy(sketch, changed, tmp_path))
    np.testing.assert_allclose(any_engine.read(copied, "height"), SHARES, atol=1e-6)
    from playground.publish.pack import pack

    with pytest.raises(playground.DataError, match=r"array.*cannot be packed.*save a copy"):
        pack(changed, tmp_path / "packed.zip")


# ── pictures ─────────────────────────────────────────────────────────────────

KERNEL = """#pragma kernel(output = "shown:rgba32f")
uniform sampler2D image;  //! file("p.png")
vec4 kernel(ivec2 texel) { return texelFetch(image, texel, 0); }
"""


@pytest.fixture
def shown(tmp_path: Path) -> playground.Sketch:
    (tmp_path / "k.glsl").write_text(KERNEL)
    (tmp_path / "s.toml").write_text('format = 1\nsize = [3, 2]\n[[pass]]\nname = "a"\nuse = "./k"\n')
    return playground.load(tmp_path / "s.toml")


def linear(encoded: np.ndarray) -> np.ndarray:
    """IEC 61966-2-1."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


@pytest.mark.parametrize("most", [255, 65535, 1])
def test_a_picture_has_its_top_row_first(any_engine, shown, most):
    dtype = {255: np.uint8, 65535: np.uint16, 1: np.float32}[most]
    shares = np.linspace(0.0, 1.0, 18).reshape(2, 3, 3)
    array = (shares * most).round().astype(dtype) if most > 1 else shares.astype(dtype)
    result = any_engine.read(shown.with_values({"a.image": array}), "a")
    exact = linear(array.astype(np.float64) / most)[::-1]
    # Bytes are eight bits; the rest is a half float on the card, of 11 bits.
    np.testing.assert_allclose(result[..., :3], exact, atol=1 / 255 if most == 255 else 2.0**-11)
    np.testing.assert_array_equal(result[..., 3], 1.0)


def test_what_is_no_picture_is_refused(shown, tmp_path):
    for array, sentence in (
        (np.zeros((2, 2, 2)), "expected a picture"),
        (np.full((2, 2, 3), 1.5), "from 1.5 to 1.5; a picture's floats are 0 to 1"),
        (np.full((2, 2, 3), np.nan), "a picture's floats are 0 to 1"),
        (np.zeros((2, 2, 3), np.int64), "expected a picture"),
    ):
        with pytest.raises(playground.ParameterError, match=sentence):
            shown.with_values({"a.image": array})
    (tmp_path / "film.toml").write_text('format = 1\n[[pass]]\nname = "a"\nuse = "foreign/video"\n')
    with pytest.raises(playground.ParameterError, match=r"a\.video: takes a file of its own kind"):
        playground.load(tmp_path / "film.toml").with_values({"a.video": HEIGHTS})


def test_every_source_that_reads_a_file_is_judged():
    """A new one is a grid, a picture, or refuses arrays, which is what these do."""
    refusing = {name for name, kind in SOURCES.items() if kind.files} - {*GRIDS, *PICTURES}
    assert refusing == {"model_file", "video_file", "sound_file", "array_file"}


# ── inputs ───────────────────────────────────────────────────────────────────

ADDS = """#pragma kernel(output = "sum:rgba32f")
uniform sampler2D first;  //! input
uniform sampler2D other;  //! input("black")
vec4 kernel(ivec2 texel) { return texelFetch(first, texel, 0) + 10.0 * texelFetch(other, texel, 0); }
"""


@pytest.fixture
def adding(tmp_path: Path) -> playground.Sketch:
    (tmp_path / "adds.glsl").write_text(ADDS)
    (tmp_path / "k.glsl").write_text(
        '#pragma kernel(output = "a:r32f")\nfloat kernel(ivec2 t) { return 0.5; }'
    )
    passes = (
        '[[pass]]\nname = "a"\nuse = "./k"\n[[pass]]\nname = "b"\nuse = "./adds"\ninputs = { first = "a" }\n'
    )
    (tmp_path / "sketch.toml").write_text(f"format = 1\nsize = [5, 4]\n{passes}")
    return playground.load(tmp_path / "sketch.toml")


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_an_input_takes_an_array_of_any_numbers(any_engine, adding, channels):
    array = (HEIGHTS[..., None] * np.arange(1, channels + 1) - 30.0).astype(np.float32)
    result = any_engine.read(adding.with_inputs({"b.first": array, "b.other": HEIGHTS}), "b")
    exact = np.zeros((4, 5, 4), np.float32)
    exact[..., 3] = 1.0  # what a texture without alpha reads
    exact[..., :channels] = array
    exact[..., 0] += 10.0 * HEIGHTS
    exact[..., 3] += 10.0
    np.testing.assert_array_equal(result, exact)


def test_an_array_on_an_input_is_a_value_like_any_other(any_engine, adding):
    first, same = (adding.with_inputs({"b.first": HEIGHTS}) for _ in range(2))
    assert first == same and hash(first) == hash(same) != hash(adding)
    assert pickle.loads(pickle.dumps(first)) == first
    other = first.with_inputs({"b.first": HEIGHTS + 1})
    assert len(other.graph.passes) == len(first.graph.passes), "it takes the earlier one's place"
    marks = {any_engine.fingerprint(s, size=(8, 8)) for s in (adding, first, same, other)}
    assert len(marks) == 3
    np.testing.assert_array_equal(any_engine.read(other, "b")[..., 0], HEIGHTS + 1)
    np.testing.assert_array_equal(any_engine.read(first, "b")[..., 0], HEIGHTS)


def test_an_array_of_another_size_keeps_its_own(any_engine, adding):
    larger = adding.with_inputs({"b.first": np.ones((7, 9))})
    any_engine.read(larger, "b")
    assert any_engine.record.plan.step("b_first_array").size == (9, 7)


def test_unknown_input_and_invalid_array_are_refused(adding, tmp_path):
    for path, array, sentence in (
        ("b.frist", HEIGHTS, r"no input 'b\.frist'; did you mean 'b\.first'"),
        ("c.first", HEIGHTS, r"no input 'c\.first'"),
        ("b.first", np.zeros(5), r"b\.first = an array of float64 \(5,\): expected numbers"),
        ("b.first", np.zeros((2, 2, 5)), "expected numbers"),
        ("b.first", np.where(HEIGHTS == 8, np.nan, HEIGHTS), "row 1, column 1 is not finite"),
    ):
        with pytest.raises(playground.ParameterError, match=sentence):
            adding.with_inputs({path: array})
    changed = adding.with_inputs({"b.first": HEIGHTS})
    with pytest.raises(playground.SketchError, match="'b_first_array' is an array, which a"):
        save_copy(adding, changed, tmp_path)


def test_a_web_page_has_the_arrays(engine, sketch):
    changed = sketch.with_values({"height.elevation": np.pad(HEIGHTS, 2)})
    lit = changed.with_inputs({"view.light": np.full((8, 9, 3), 0.5)})
    for item in (changed, lit):
        (result,) = page_data([item], engine=engine)["sketches"]
        assert "array" in json.dumps(result)
