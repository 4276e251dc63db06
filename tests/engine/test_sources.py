"""Sources: what the processor makes of a file becomes a texture, and gives the sketch its size and metres."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from playground.errors import DataError, PlaygroundError

SOURCE = """#pragma source("elevation_file", output = "height:r32f")
uniform sampler2D elevation; //! file("heights.npy")
uniform ivec2 raw_size = ivec2(0);
uniform int packing = 0; //! menu("grey", "rgb")
uniform int no_data = 0; //! menu("refuse", "fill")
uniform int first_row = 0; //! menu("north", "south")
uniform vec2 metres = vec2(0.0);
"""


@pytest.fixture
def heightmap(folder):
    heights = np.linspace(100.0, 300.0, 5 * 7, dtype=np.float32).reshape(5, 7)  # row 0 in the north
    np.save(folder.path / "heights.npy", heights)
    folder.write("terrain.glsl", SOURCE)
    return folder, heights


def test_a_file_becomes_heights_row_0_in_the_south(any_engine, heightmap):
    folder, heights = heightmap
    sketch = folder.sketch('[[pass]]\nname = "height"\nuse = "./terrain"\n', size="")
    result = any_engine.read(sketch, "height")
    span = heights.max() - heights.min()
    np.testing.assert_allclose(result, (heights[::-1] - heights.min()) / span, atol=1e-6)
    plan = any_engine.record.plan
    assert plan is not None
    assert plan.terrain.size == (7, 5)


def test_the_sketch_may_ask_for_another_size(any_engine, heightmap):
    folder, _ = heightmap
    sketch = folder.sketch('[[pass]]\nname = "height"\nuse = "./terrain"\n', size="size = [13, 9]")
    result = any_engine.read(sketch, "height")
    assert result.shape == (9, 13)
    assert result.min() == pytest.approx(0.0, abs=1e-6)
    assert result.max() == pytest.approx(1.0, abs=1e-6)


def test_it_is_read_again_when_the_file_changes_and_not_before(any_engine, heightmap):
    folder, heights = heightmap
    sketch = folder.sketch('[[pass]]\nname = "height"\nuse = "./terrain"\n', size="")
    any_engine.texture(sketch, "height")
    any_engine.texture(sketch, "height")
    assert any_engine.record.ran == []
    np.save(folder.path / "heights.npy", heights[:, ::-1])
    result = any_engine.read(sketch, "height")
    assert any_engine.record.ran == ["height"]
    assert result[0, 0] > result[0, -1]


def test_a_source_without_its_parameters_has_a_sentence(any_engine, heightmap):
    folder, _ = heightmap
    folder.write("terrain.glsl", SOURCE.replace("uniform vec2 metres = vec2(0.0);\n", ""))
    with pytest.raises(PlaygroundError, match="needs the parameters metres"):
        any_engine.read(folder.sketch('[[pass]]\nname = "height"\nuse = "./terrain"\n', size=""), "height")


def test_an_unknown_source_and_an_unknown_output_have_sentences(any_engine, heightmap):
    folder, _ = heightmap
    folder.write("terrain.glsl", SOURCE.replace('"elevation_file"', '"elevation_fil"'))
    with pytest.raises(PlaygroundError, match="did you mean 'elevation_file'"):
        any_engine.read(folder.sketch('[[pass]]\nname = "height"\nuse = "./terrain"\n', size=""), "height")
    folder.write("terrain.glsl", SOURCE.replace("height:r32f", "depth:r32f"))
    with pytest.raises(PlaygroundError, match="gives height, not 'depth'"):
        any_engine.read(folder.sketch('[[pass]]\nname = "height"\nuse = "./terrain"\n', size=""), "height")


def test_a_missing_file_has_a_sentence(any_engine, heightmap):
    folder, _ = heightmap
    (folder.path / "heights.npy").unlink()
    with pytest.raises(PlaygroundError, match="no such file"):
        any_engine.read(folder.sketch('[[pass]]\nname = "height"\nuse = "./terrain"\n', size=""), "height")


PASS = '[[pass]]\nname = "height"\nuse = "./terrain"\n'


def refused(any_engine, sketch) -> str:
    """Draw what is wrong; check that the error is at the sketch's pass, and return its sentence."""
    with pytest.raises(DataError) as caught:
        any_engine.read(sketch, "height")
    (result,) = caught.value.diagnostics
    assert (Path(result.file).name, result.line) == ("sketch.toml", 3), result
    return result.message


@pytest.mark.parametrize(
    "body", [PASS, '[[pass]]\nname = "height"\nuse = "./inner"\n'], ids=["source", "nested"]
)
def test_invalid_data_file_is_reported_at_its_pass(any_engine, heightmap, monkeypatch, body):
    folder, _ = heightmap
    monkeypatch.chdir(folder.path)
    folder.write("inner.toml", '[[pass]]\nname = "height"\nuse = "./terrain"\n')
    (folder.path / "heights.npy").write_bytes(b"nothing")
    message = refused(any_engine, folder.sketch(body, size=""))
    assert message.startswith("heights.npy: the file is damaged")
    holes = np.ones((4, 4), dtype=np.float32)
    holes[1, 1] = np.nan
    np.save(folder.path / "heights.npy", holes)
    message = refused(any_engine, folder.sketch(body, size=""))
    assert message.startswith("heights.npy: 1 of 16 texels have no data")
    assert message.endswith('expected none, or no_data = "fill"')
    (folder.path / "heights.npy").unlink()
    message = refused(any_engine, folder.sketch(body, size=""))
    assert "heights.npy: height" in message
    assert "there is no such file" in message


def test_invalid_image_is_reported_at_its_pass(any_engine, folder, monkeypatch):
    monkeypatch.chdir(folder.path)
    folder.write("grass.png", "no picture")
    folder.write(
        "terrain.glsl",
        '#pragma kernel(output = "height:r32f")\n'
        'uniform sampler2D grass;  //! file("grass.png")\n'
        "float kernel(ivec2 texel) { return texelFetch(grass, texel, 0).r; }\n",
    )
    assert refused(any_engine, folder.sketch(PASS)).startswith("grass.png: not a picture")


def test_source_without_terrain_info_defers_to_next_source(any_engine, heightmap):
    folder, _ = heightmap
    made = '[[pass]]\nname = "tin"\nuse = "generation/delaunay"\n'
    sketch = folder.sketch(f'{made}[[pass]]\nname = "height"\nuse = "./terrain"\n', size="")
    any_engine.texture(sketch, "height")
    assert any_engine.record.plan is not None and any_engine.record.plan.terrain.size == (7, 5)
