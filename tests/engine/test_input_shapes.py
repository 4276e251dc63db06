"""What a shader reads of passes through samplers of other shapes: cubes, volumes, arrays, lines."""

from __future__ import annotations

import gc

import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.engine import binder
from playground.engine.engine import Engine
from playground.engine.plan import PlanRequest
from playground.engine.planner import make_plan
from playground.engine.textures import copied
from playground.errors import SketchError
from tests.cube_maps import directions, face_and_place

from ..loading import load

pytestmark = pytest.mark.room("dialects")

SIDE = 4
SAMPLER = {
    "cube": ("samplerCube", (SIDE, 6 * SIDE)),
    "volume": ("sampler3D", (SIDE, SIDE * SIDE)),
    "layers": ("sampler2DArray", (SIDE, 3 * SIDE)),
    "line": ("sampler1D", (SIDE, 2)),
}
SKETCH = """format = 1
size = 8
[[pass]]
name = "data"
use = "foreign/image"
set = {{ image = "data.png" }}
size = [{}, {}]
[view]
use = "./reads"
inputs = {{ data = "data" }}
"""


class Reader:
    """A sketch whose picture is one lookup of a texture of random bytes."""

    def __init__(self, engine, folder, shape, expression, *, seed=0):
        kind, self.size = SAMPLER[shape]
        self.engine, self.folder = engine, folder
        self.texels = np.random.default_rng(seed).integers(0, 256, (self.size[1], self.size[0], 4), np.uint8)
        self.texels[..., 3] = 255
        write_png(folder.path / "data.png", self.texels[::-1])
        text = f"uniform {kind} data;\nuniform vec3 at;\nvoid main() {{ gl_FragColor = {expression}; }}\n"
        folder.write("reads.frag", text)
        self.sketch = load(folder.write("sketch.toml", SKETCH.format(*self.size)))

    def __call__(self, at):
        sketch = self.sketch.with_values({"view.at": tuple(map(float, at))})
        return self.engine.render(sketch, size=(1, 1)).array[0, 0].astype(int)


def test_each_direction_reads_the_texel_that_the_cube_map_says(any_engine, folder):
    read = Reader(any_engine, folder, "cube", "textureLod(data, at, 0.0)")
    for row, line in enumerate(directions(SIDE)):
        for column, direction in enumerate(line):
            np.testing.assert_allclose(read(direction), read.texels[row, column], atol=1)
            np.testing.assert_allclose(read(3.5 * direction), read.texels[row, column], atol=1)


def test_an_edge_reads_both_of_its_faces(any_engine, folder):
    read = Reader(any_engine, folder, "cube", "textureLod(data, at, 0.0)")
    along = (2 * 1 + 1) / SIDE - 1  # the middle of a texel
    for axis in range(3):
        for first in (1.0, -1.0):
            for second in (1.0, -1.0):
                beside, expected = [], np.zeros(4)
                for shift in ((1e-3, 0), (0, 1e-3)):
                    direction = np.insert([first * (1 - shift[0]), second * (1 - shift[1])], axis, along)
                    face, s, t = face_and_place(direction)
                    beside.append(face)
                    position = min(int(s * SIDE), SIDE - 1), min(int(t * SIDE), SIDE - 1)
                    expected += read.texels[face * SIDE + position[1], position[0]] / 2
                assert len(set(beside)) == 2
                np.testing.assert_allclose(read(np.insert([first, second], axis, along)), expected, atol=2)


def test_the_smallest_level_is_the_mean_of_each_face(any_engine, folder):
    read = Reader(any_engine, folder, "cube", "textureLod(data, at, 2.0)")
    for face, direction in enumerate(np.repeat(np.eye(3), 2, axis=0) * np.tile([[1], [-1]], (3, 1))):
        mean = read.texels[face * SIDE : (face + 1) * SIDE].mean((0, 1))
        np.testing.assert_allclose(read(direction), mean, atol=2)


@pytest.mark.parametrize("position", [(0, 0, 0), (3, 1, 2), (2, 3, 3)])
def test_a_volume_and_an_array_are_slices_above_each_other(any_engine, folder, position):
    for shape in ("volume", "layers"):
        column, row, layer = (*position[:2], min(position[2], 2) if shape == "layers" else position[2])
        exact = Reader(any_engine, folder, shape, "texelFetch(data, ivec3(at), 0)")
        np.testing.assert_allclose(
            exact((column, row, layer)), exact.texels[layer * SIDE + row, column], atol=1
        )
        third = "at.z" if shape == "layers" else f"(at.z + 0.5) / {SIDE}.0"
        smooth = Reader(any_engine, folder, shape, f"texture(data, vec3((at.xy + 0.5) / {SIDE}.0, {third}))")
        np.testing.assert_allclose(smooth((column, row, layer)), exact((column, row, layer)), atol=2)


def test_a_line_is_row_0_and_repeats(any_engine, folder):
    read = Reader(any_engine, folder, "line", "texture(data, at.x)")
    for column in range(SIDE):
        for turn in (0, 1, -2):
            np.testing.assert_allclose(
                read(((column + 0.5) / SIDE + turn, 0, 0)), read.texels[0, column], atol=1
            )
    fetched = Reader(any_engine, folder, "line", "texelFetch(data, int(at.x), 0)")
    np.testing.assert_allclose(fetched((2, 0, 0)), fetched.texels[0, 2], atol=1)


@pytest.mark.parametrize("shape", SAMPLER)
def test_a_copy_follows_what_it_is_of(any_engine, folder, shape):
    lookup = {"cube": "at", "line": "at.x"}.get(shape, "at")
    read = Reader(any_engine, folder, shape, f"textureLod(data, {lookup}, 0.0)")
    before = read((0.1, 0.2, 0.9))
    again = Reader(any_engine, folder, shape, f"textureLod(data, {lookup}, 0.0)", seed=1)
    assert np.abs(again((0.1, 0.2, 0.9)) - before).max() > 2
    with Engine(any_engine.ctx) as fresh:
        again.engine, after = fresh, again((0.1, 0.2, 0.9))
    again.engine = any_engine
    np.testing.assert_array_equal(again((0.1, 0.2, 0.9)), after)


@pytest.mark.parametrize("shape", SAMPLER)
def test_what_nothing_feeds_is_black_and_opaque(any_engine, folder, shape):
    kind = SAMPLER[shape][0]
    more = "uniform sampler2D flat_one; uniform samplerCubeShadow other;"
    lookups = {"line": "texture(data, 0.5)", "cube": "texture(data, vec3(1.0, 0.2, 0.1))"}
    lookup = lookups.get(shape, "texture(data, vec3(0.5))")
    text = (
        f"uniform {kind} data; {more}\nvoid main() {{ gl_FragColor = 0.5 * {lookup} "
        "+ 0.5 * texture(flat_one, vec2(0.5)) + 0.0 * texture(other, vec4(1.0)); gl_FragColor.r += 0.25; }\n"
    )
    picture = any_engine.render(load(folder.write("t.frag", text)), size=(2, 2)).array
    np.testing.assert_allclose(picture[0, 0], [64, 0, 0, 255], atol=1)


def test_texture_of_wrong_cube_layout_is_refused_at_its_input(folder):
    for shape, size, expected in [
        ("cube", (8, 32), r"data reads 'data', 8 x 32 texels; .*1 : 6, as 8 x 48"),
        ("volume", (8, 32), r"n slices above each other, as 8 x 64"),
        ("layers", (8, 33), r"square layers above each other, as 8 x 32"),
    ]:
        lookup = "vec4(vec3(textureSize(data, 0), 1.0).xyz, 1.0)"
        text = f"uniform {SAMPLER[shape][0]} data;\nvoid main() {{ gl_FragColor = {lookup}; }}\n"
        folder.write("reads.frag", text)
        write_png(folder.path / "data.png", np.zeros((2, 2, 4), np.uint8))
        sketch = load(folder.write("sketch.toml", SKETCH.format(*size)))
        with pytest.raises(SketchError, match=expected) as caught:
            make_plan(sketch, PlanRequest(frame_size=(4, 4)))
        diagnostic = caught.value.diagnostics[0]
        assert (
            diagnostic.file.endswith("sketch.toml")
            and diagnostic.line == SKETCH.count("\n", 0, SKETCH.index("[view]")) + 1
        )


def test_a_copy_is_made_once_for_all_who_read_it(any_engine, folder, monkeypatch):
    made = []
    monkeypatch.setattr(binder, "copied", lambda *value: made.append(value[1]) or copied(*value))
    read = Reader(any_engine, folder, "cube", "textureLod(data, at, 0.0)")
    for way in ((1, 0, 0), (0, 1, 0), (0, 0, -1)):
        read(way)
    assert made == ["cube"]
    Reader(any_engine, folder, "cube", "textureLod(data, at, 0.0)", seed=1)((1, 0, 0))
    assert made == ["cube", "cube"]


def test_copies_are_released(any_engine, folder, alive):
    for turn in range(3):
        read = Reader(any_engine, folder, "cube", "textureLod(data, at, 0.0)", seed=turn)
        read((1, 0, 0))
        if turn == 0:
            any_engine.cache.clear()
            gc.collect()
            before = dict(alive)
    any_engine.cache.clear()
    gc.collect()
    assert alive["TextureCube"] == 0 == before.get("TextureCube", 0)
    assert alive["Buffer"] == before["Buffer"] and alive["Framebuffer"] <= before["Framebuffer"] + 2


def test_sizes_are_those_of_the_shape(any_engine, folder):
    head = "uniform samplerCube iChannel0;\nuniform sampler3D iChannel1;\n"
    text = (
        f"{head}void mainImage(out vec4 c, vec2 p) {{ c = vec4(iChannelResolution[0].xy / 512.0, "
        "iChannelResolution[1].z / 64.0, 1.0);"
        "c += 0.0 * texture(iChannel0, vec3(1.0)) * texture(iChannel1, vec3(0.5)); }\n"
    )
    picture = any_engine.render(load(folder.write("t.frag", text)), size=(1, 1)).array
    np.testing.assert_allclose(picture[0, 0, :3], [64, 64, 128], atol=1)
