"""The pixel inspector, against whole textures and a ray march on the CPU."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from imgui_bundle import imgui

from playground.engine.camera import ground_under
from playground.engine.engine import Engine
from playground.engine.textures import read_picture, read_texels, read_texture
from playground.studio.inspect.inspector import Inspector
from playground.studio.inspect.panel import lines_of
from playground.studio.session import Session

from ..sketch_texts import passes
from .panel_desk import Bare

TERRAIN = """// terrain.glsl -- hills
#pragma kernel(output = "height:r32f, other:rg16")
void kernel(ivec2 texel, out float height, out vec2 other) {
    vec2 share = vec2(texel) / vec2(size - 1);
    height = 0.5 + 0.3 * sin(7.0 * share.x) * cos(5.0 * share.y);
    other = share;
}
"""
HALF = """// half.glsl -- a texture of half the size
#pragma kernel(output = "light:rgba16f")
uniform sampler2D height; //! input
vec4 kernel(ivec2 texel) { return vec4(texelFetch(height, 2 * texel, 0).r / vec3(1.0, 3.0, -7.0), 1.0); }
"""
SKETCH = (
    """format = 1
size = [65, 49]
extent = [1600.0, 1200.0]
relief = 300.0
base_elevation = 120.0
"""
    + passes(height="./terrain", light=("./half", 'size = ["size.x // 2", "size.y // 2"]'))
    + """[view]
use = "view/terrain"
[view.camera]
azimuth = 200.0
elevation = 35.0
"""
)
SIZE = 96, 64


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in {"terrain.glsl": TERRAIN, "half.glsl": HALF, "sketch.toml": SKETCH}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


@pytest.fixture
def session(folder: Path, any_engine: Engine) -> Iterator[Session]:
    made = Session(any_engine, folder)
    yield made
    made.release()


@pytest.fixture
def inspector(session: Session) -> Iterator[Inspector]:
    made = Inspector(session, on=True)
    yield made
    made.release()


@pytest.mark.parametrize("form", ["r8", "rg16", "rgba16f", "rgba32f", "r32f"])
def test_a_texel_is_the_one_of_a_whole_reading(any_engine: Engine, form: str) -> None:
    from playground.engine.textures import make_texture, write_texture

    any_engine.ctx.detect_framebuffer(0).use()  # nothing is bound that another test has taken away
    texture = make_texture(any_engine.ctx, (7, 5), form)
    values = np.random.default_rng(1).random((5, 7, texture.components), np.float32)
    write_texture(texture, values)
    whole = read_texture(texture).reshape(5, 7, texture.components)
    for y in range(5):
        for x in range(7):
            np.testing.assert_array_equal(read_texels(texture, (x, y), (1, 1))[0, 0], whole[y, x])
    np.testing.assert_array_equal(read_texels(texture, (2, 1), (4, 3)), whole[1:4, 2:6])
    texture.release()


def test_every_pass_is_read_exactly_at_ray_terrain_hit(session: Session, inspector: Inspector) -> None:
    picture = session.frame(SIZE)
    assert not session.error, str(session.error)
    assert picture is not None and session.plan is not None
    colours = read_picture(picture)
    whole = {}
    engine = session.engine
    for name in ("height:height", "height:other", "light:light"):
        path, _, output = name.partition(":")
        ref = session.plan.flat.outputs[path][output]
        values = (
            read_texture(engine.record.results[ref.path].textures[ref.output]) if path != "light" else None
        )
        whole[name] = values
    # The light is not in the picture where the view does not read it; then it is named as missing.
    runs, draws = dict(engine.runs), session.draws
    heights = whole["height:height"]
    assert heights is not None
    met = 0
    for x in range(0, SIZE[0], 7):
        for y in range(0, SIZE[1], 5):
            result = inspector.at((x, y), picture)
            assert result is not None and result.picture == tuple(colours[SIZE[1] - 1 - y, x, :3])
            position = (x + 0.5) / SIZE[0], (y + 0.5) / SIZE[1]
            truth = ground_under(session.plan.eye, position, heights, (1600.0, 1200.0), 300.0)
            assert (truth is None) == (result.ground is None)
            if truth is None or result.ground is None:
                continue
            met += 1
            assert (
                math.dist((result.ground.east, result.ground.north), (truth[0] * 1600, truth[1] * 1200)) < 0.5
            )
            for sample in result.samples:
                values = whole[sample.name]
                if values is None:
                    continue
                share = result.ground.east / 1600, result.ground.north / 1200
                assert sample.texel == (round(share[0] * 64), round(share[1] * 48))
                assert list(sample.values) == np.atleast_1d(values[sample.texel[::-1]]).tolist()
            i, j = result.samples[0].texel
            rise_y, rise_x = np.gradient(heights.astype(np.float64) * 300.0, 25.0)
            steep = math.hypot(rise_x[j, i], rise_y[j, i])
            assert result.ground.slope == pytest.approx(math.degrees(math.atan(steep)), abs=1e-9)
            normal = np.array([-rise_x[j, i], -rise_y[j, i], 1.0])
            np.testing.assert_allclose(result.ground.normal, normal / np.linalg.norm(normal), atol=1e-12)
            assert result.ground.above_sea == result.ground.height + 120.0
            assert result.samples[0].metres == result.samples[0].values[0] * 300.0
    assert met > 40
    assert dict(engine.runs) == runs and session.draws == draws  # nothing was drawn for it


@pytest.mark.slow
def test_in_a_map_it_is_the_texel_that_the_pixel_shows(session: Session, inspector: Inspector) -> None:
    session.frame(SIZE)
    session.show("height:other")
    session.view.set_map("channel", 2)
    session.view.set_map("shrunk", 1)
    for size in (SIZE, (41, 90), (130, 98)):
        picture = session.frame(size)
        assert picture is not None
        colours = read_picture(picture)[::-1]
        whole = session.read_values("height:other")
        assert whole is not None
        inside = 0
        for y in range(size[1]):
            for x in range(y % 4, size[0], 4):  # every row and every column
                result = inspector.at((x, y), picture)
                assert result is not None
                if result.shown is None:
                    assert colours[y, x, :3].max() == 0
                    continue
                inside += 1
                i, j = result.shown.texel
                assert list(result.shown.values) == whole[j, i].tolist()
                assert abs(int(colours[y, x, 0]) - 255 * result.shown.values[1]) <= 0.51
        assert inside > 300


def test_the_light_of_another_size_is_read_at_its_own_node(session: Session, inspector: Inspector) -> None:
    session.frame(SIZE)
    session.show("light:light")
    picture = session.frame((32, 24))
    assert picture is not None
    result = inspector.at((8, 12), picture)
    assert result is not None and result.shown is not None and result.ground is not None
    assert result.shown.texel == (8, 12)
    assert result.ground.east == pytest.approx(1600 * 8 / 31)
    high = next(r for r in result.samples if r.name == "height:height")
    assert high.texel == (round(64 * 8 / 31), round(48 * 12 / 23))


def test_it_asks_once_for_a_pixel_of_a_picture(session: Session, inspector: Inspector) -> None:
    picture = session.frame(SIZE)
    assert picture is not None
    for _ in range(5):
        inspector.at((40, 10), picture)
    assert inspector.reads == 1
    inspector.at((41, 10), picture)
    session.redraw()
    again = session.frame(SIZE)
    assert again is not None
    inspector.at((41, 10), again)
    assert inspector.reads == 3
    assert inspector.at((-1, 10), again) is None and inspector.at((0, SIZE[1]), again) is None


def test_numbers_that_are_not_finite_are_named(folder: Path, session: Session, inspector: Inspector) -> None:
    text = TERRAIN.replace(
        "other = share;", "other = share; if (texel.x == 30) height = uintBitsToFloat(0x7fc00000u);"
    )
    (folder / "terrain.glsl").write_text(text, encoding="utf-8")
    session.drafts.reload()
    session.frame((65, 49))
    session.show("height:height")
    picture = session.frame((65, 49))
    assert picture is not None
    result = inspector.at((30, 5), picture)
    assert result is not None and result.shown is not None and math.isnan(result.shown.values[0])
    assert any("nan" in text for _, text, _ in lines_of(result))


def test_a_key_brings_the_box_and_takes_it_away(folder: Path, any_engine: Engine) -> None:
    bare = Bare(any_engine, folder)
    try:
        imgui.get_io().add_mouse_pos_event(800, 600)
        bare.run_frames(2)
        assert bare.bench.inspection.inspector.reads == 0
        bare.key(imgui.Key.i)
        bare.run_frames(2)
        assert bare.bench.inspection.inspector.reads == 1 and not bare.bench.inspection.inspector.inner
        imgui.get_io().add_mouse_pos_event(100, 300)  # over the panel
        bare.run_frames(3)
        assert bare.bench.inspection.inspector.reads == 1
        bare.key(imgui.Key.i)
        imgui.get_io().add_mouse_pos_event(800, 500)
        bare.run_frames(3)
        assert bare.bench.inspection.inspector.reads == 1
    finally:
        bare.close()
