"""An elevation file that is opened alone: the sketch around it, and how it is found."""

from __future__ import annotations

import numpy as np
import pytest
import tifffile

from playground.allowed_files import ELEVATIONS
from playground.errors import SketchError
from playground.sketch.find import find
from playground.sketch.load import elevation_text, load
from playground.sketch.model import TerrainSettings


@pytest.fixture
def dem(tmp_path):
    path = tmp_path / 'a "b" `c` é.TIF'
    tifffile.imwrite(path, np.arange(12, dtype=np.float32).reshape(3, 4))
    return path


def test_dem_sketch_names_its_file_and_leaves_terrain_to_it(dem):
    sketch = load(dem)
    assert (sketch.file, sketch.folder, sketch.name) == (str(dem), str(dem.parent), dem.stem)
    assert sketch.terrain == TerrainSettings()
    height = sketch.graph.find("height")
    assert dict(height.values) == {"elevation": dem.name, "longest": 1025, "no_data": 1}
    assert [spec.name for spec in sketch.graph.passes if spec.name in ("colour", "light", "view")]
    assert {spec.line for spec in sketch.graph.passes} == {0}, "no line of the file says any of it"
    assert not sketch.warnings


def test_saved_beside_the_file_its_text_is_the_same_sketch(dem):
    saved = dem.with_suffix(".toml")
    saved.write_text(elevation_text(dem, dem.name), "utf-8")
    alone, again = load(dem), load(saved)
    assert [(p.name, p.use, p.values, p.inputs) for p in alone.graph.passes] == [
        (p.name, p.use, p.values, p.inputs) for p in again.graph.passes
    ]
    assert (alone.camera, alone.main, alone.title) == (again.camera, again.main, again.title)


@pytest.mark.parametrize("ending", ELEVATIONS)
def test_every_ending_of_elevations_is_found(tmp_path, ending):
    path = tmp_path / f"land{ending}"
    path.write_bytes(b"")
    assert find(path) == path and load(path).name == "land"


def test_what_is_neither_says_what_is(tmp_path):
    (tmp_path / "a.pdf").write_bytes(b"%PDF")
    with pytest.raises(SketchError, match=r"an elevation file in \.png, \.tif, .*\.hgt"):
        find(tmp_path / "a.pdf")


@pytest.mark.room("dialects")
def test_a_dialect_is_for_shaders(dem):
    with pytest.raises(SketchError, match="--dialect is for a shader file"):
        load(dem, dialect="isf")
