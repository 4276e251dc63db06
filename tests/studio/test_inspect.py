"""What shows values: the histogram and the legend of a map, and the pixel inspector."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import moderngl
import numpy as np
import pytest
from imgui_bundle import imgui

from playground.engine.camera import ground_under
from playground.engine.engine import Engine
from playground.engine.textures import make_texture, read_picture, read_texels, read_texture, write_texture
from playground.sketch.map_sketch import Map
from playground.studio.inspect import histogram
from playground.studio.inspect.histogram import (
    BINS,
    STEPS,
    Counter,
    Histogram,
    colours_of,
    count,
    ends_of,
    ticks,
)
from playground.studio.inspect.inspector import Inspector
from playground.studio.inspect.panel import lines_of
from playground.studio.session import Session

from ..sketch_texts import map_of_height, passes
from .panel_desk import Bare, OpenBare
from .session_desk import OpenSession

TERRAIN = """// terrain.glsl -- a slope from west to east
#pragma kernel(output = "height:r32f")
uniform float level = 1.0; //! slider(0, 1) How high
float kernel(ivec2 texel) { return level * float(texel.x) / float(size.x - 1); }
"""
SKETCH = "format = 1\nsize = [64, 8]\nrelief = 250.0\n" + map_of_height()


@pytest.fixture
def ctx(ctx: moderngl.Context) -> moderngl.Context:
    """Give the context with nothing bound that another test has taken away."""
    ctx.detect_framebuffer(0).use()
    return ctx


FILES = {"terrain.glsl": TERRAIN, "sketch.toml": SKETCH}


def counted(texture: moderngl.Texture, **limits: int) -> tuple[Histogram, int]:
    """Return the histogram, and in how many pieces it was made."""
    *pieces, result = count(texture, **limits)
    assert result is not None and not any(pieces)
    return result, len(pieces) + 1


@pytest.mark.parametrize("piece", [10_000_000, 1000, 1])
@pytest.mark.parametrize("form", ["r32f", "rgba32f", "rg16"])
def test_it_is_what_numpy_finds(ctx: moderngl.Context, form: str, piece: int) -> None:
    texture = make_texture(ctx, (90, 70), form)
    values = np.random.default_rng(3).normal(0.4, 0.1, (70, 90, texture.components)).astype(np.float32)
    if form != "rg16":
        values[3:9, 5, 0] = np.nan
        values[10, 7:9, 0] = np.inf, -np.inf
    write_texture(texture, values)
    if form == "rg16":
        values = (np.round(np.clip(values, 0, 1) * 65535) / np.float32(65535)).astype(np.float32)
    result, pieces = counted(texture, piece=piece)
    assert result.whole and result.size == (90, 70) and len(result.channels) == texture.components
    assert pieces >= 6300 * 2 // max(piece, 90) - 1
    good = [values[..., c][np.isfinite(values[..., c])].astype(np.float64) for c in range(texture.components)]
    low, high = min(g.min() for g in good), max(g.max() for g in good)
    assert (result.low, result.high) == (low, high)
    for number, (channel, numbers) in enumerate(zip(result.channels, good, strict=True)):
        assert channel.count == len(numbers)
        assert (channel.nans, channel.infinities) == ((6, 2) if form != "rg16" and number == 0 else (0, 0))
        assert (channel.lowest, channel.highest) == (numbers.min(), numbers.max())
        assert channel.mean == pytest.approx(numbers.mean(), rel=1e-12)
        assert channel.deviation == pytest.approx(numbers.std(), rel=1e-9)
        truth, _ = np.histogram(numbers, BINS, (low, high))
        assert np.abs(np.cumsum(channel.bins) - np.cumsum(truth)).max() <= 1  # where rounding parts two bins
        assert channel.bins.sum() == len(numbers)
    texture.release()


def test_no_finite_number_and_one_number_alone(ctx: moderngl.Context) -> None:
    texture = make_texture(ctx, (4, 4), "r32f")
    write_texture(texture, np.full((4, 4), np.nan, np.float32))
    result, _ = counted(texture)
    assert (
        result.channels[0].nans == 16
        and math.isnan(result.channels[0].mean)
        and not result.channels[0].bins.any()
    )
    write_texture(texture, np.full((4, 4), 7.0, np.float32))
    result, _ = counted(texture)
    assert result.low == result.high == 7.0 and result.channels[0].bins[0] == 16
    texture.release()


def test_of_a_large_texture_whole_rows_are_left_out(ctx: moderngl.Context) -> None:
    texture = make_texture(ctx, (50, 100), "r32f")
    write_texture(texture, np.repeat(np.arange(100, dtype=np.float32)[:, None], 50, axis=1))
    result, _ = counted(texture, most=1500)
    assert not result.whole and result.read == 50 * 25
    assert result.channels[0].mean == np.arange(0, 100, 4).mean()
    texture.release()


def test_shares_of_the_numbers(ctx: moderngl.Context) -> None:
    texture = make_texture(ctx, (100, 100), "r32f")
    write_texture(texture, np.linspace(0, 1, 10_000, dtype=np.float32).reshape(100, 100))
    result, _ = counted(texture)
    low, high = result.between(0, 0.1)
    assert low == pytest.approx(0.1, abs=1 / BINS) and high == pytest.approx(0.9, abs=1 / BINS)
    texture.release()


def test_a_frame_reads_no_more_than_a_piece(ctx: moderngl.Context, monkeypatch: pytest.MonkeyPatch) -> None:
    real, sizes = histogram.read_texels, []

    def noted(texture: moderngl.Texture, corner: tuple[int, int], size: tuple[int, int]) -> object:
        sizes.append(size[0] * size[1])
        return real(texture, corner, size)

    monkeypatch.setattr(histogram, "read_texels", noted)
    texture = make_texture(ctx, (100, 100), "r32f")
    write_texture(texture, np.zeros((100, 100), np.float32))
    work = count(texture, piece=1000)
    next(work)
    assert sizes == [1000]
    assert len([None for _ in work]) >= 18 and sum(sizes) == 10_000
    texture.release()


def test_it_follows_the_map_and_begins_anew(folder: Path, open_session: OpenSession) -> None:
    session = open_session(folder)
    counter = Counter(session, piece=64)

    def settle() -> int:
        for frames in range(1, 100):
            session.frame((32, 32))
            counter.go_on()
            if not counter.waits:
                return frames
        raise AssertionError("it never ends")

    session.frame((32, 32))
    counter.go_on()
    assert counter.latest is None and not counter.waits  # no map is shown
    session.show("height:height")
    assert settle() > 5
    assert counter.latest is not None and counter.fresh and counter.latest.high == 1.0
    assert settle() == 1  # nothing is counted twice
    session.drafts.set("height.level", 0.5)
    session.frame((32, 32))
    counter.go_on()
    assert counter.waits and not counter.fresh and counter.latest.high == 1.0  # the old one stays meanwhile
    settle()
    assert counter.fresh and counter.latest.high == 0.5
    draws = session.draws
    session.view.set_map("ramp", 2)
    assert settle() == 1 and session.draws == draws + 1  # other colours are no other numbers
    session.show(None)
    session.frame((32, 32))
    counter.go_on()
    assert counter.latest is None


@pytest.mark.parametrize("ramp", range(5))
def test_the_legend_has_the_colours_of_the_map(
    folder: Path, any_engine: Engine, open_session: OpenSession, ramp: int
) -> None:
    session = open_session(folder)
    session.frame((64, 8))
    session.show("height:height")
    for name, value in (("channel", 1), ("ramp", ramp), ("lowest", 0.0), ("highest", 1.0), ("middle", 0.5)):
        session.view.set_map(name, value)
    session.frame((64, 8))
    frame = session.read()
    with any_engine.borrowed():
        legend = np.array(colours_of(any_engine.ctx, ramp)) * 255
    assert len(legend) == STEPS == 64
    np.testing.assert_allclose(frame.array[4, :, :3], legend, atol=0.51)  # the slope has the same 64 numbers


@pytest.mark.parametrize("middle", [0.2, 0.5, 0.9])
def test_around_a_middle_both_sides_have_one_scale(
    folder: Path, any_engine: Engine, open_session: OpenSession, middle: float
) -> None:
    session = open_session(folder)
    session.frame((64, 8))
    session.show("height:height")
    for name, value in (("channel", 1), ("ramp", 4), ("middle", middle)):
        session.view.set_map(name, value)
    session.frame((64, 8))
    frame = session.read()
    assert frame is not None and session.view.map is not None
    low, high = ends_of(session.view.map)
    assert (low + high) / 2 == pytest.approx(middle) and high - low == pytest.approx(
        2 * max(middle, 1 - middle)
    )
    with any_engine.borrowed():
        legend = np.array(colours_of(any_engine.ctx, 4)) * 255
    numbers = np.arange(64) / 63
    places = (numbers - low) / (high - low) * (STEPS - 1)
    expected = np.stack([np.interp(places, np.arange(STEPS), legend[:, c]) for c in range(3)], axis=1)
    np.testing.assert_allclose(frame.array[4, :, :3], expected, atol=2.0)


def test_a_range_may_be_any_numbers(folder: Path) -> None:
    shown = Map("height:height").with_value("lowest", -4000.0).with_value("highest", 9000.0)
    assert ends_of(shown) == (-4000.0, 9000.0)
    for name in ("lowest", "highest", "middle"):
        parameter = shown.kernel.parameter(name)
        assert parameter is not None and parameter.widget.low is None


@pytest.mark.parametrize(
    ("low", "high", "marks"),
    [
        (0.0, 1.0, (0.0, 0.5, 1.0)),
        (0.0, 840.0, (0.0, 250.0, 500.0, 750.0)),
        (-3.0, 4.0, (-2.0, 0.0, 2.0, 4.0)),
        (5.0, 5.0, (5.0,)),
    ],
)
def test_ticks_are_round_and_few(low: float, high: float, marks: tuple[float, ...]) -> None:
    values = ticks(low, high)
    assert len(values) <= 5 and set(marks) <= set(values)
    assert all(low <= mark <= high for mark in values)


def test_the_panel_counts_only_while_it_shows_it(bare: Bare) -> None:
    see = bare.bench.inspection
    bare.bench.session.show("height:height")
    bare.run_frames(5)
    assert see.counter.latest is None and see.patience(0.0) > 1e6
    bare.click("Histogram###histogram")
    bare.run_frames(5)
    assert see.counter.latest is not None and see.counter.latest.high == 1.0
    bare.click("All but outliers")
    shown = bare.session.view.map
    assert 0.0 < float(str(shown.value("lowest"))) < 0.1 and 0.9 < float(str(shown.value("highest"))) < 1.0
    bare.click("All of it")
    assert (bare.session.view.map.value("lowest"), bare.session.view.map.value("highest")) == (0.0, 1.0)
    bare.click("Around the mean")
    assert bare.session.view.map.value("middle") == pytest.approx(0.5)
    bare.click("Logarithmic")
    assert see.logarithmic
    bare.run_frames(3)
    bare.click("Histogram###histogram")
    assert see.counter.latest is None


# ── inspector ─────────────────────────────────────────────────────────────────


INSPECTOR_TERRAIN = """// terrain.glsl -- hills
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
INSPECTOR_SKETCH = (
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
def inspector_folder(tmp_path: Path) -> Path:
    for name, text in {
        "terrain.glsl": INSPECTOR_TERRAIN,
        "half.glsl": HALF,
        "sketch.toml": INSPECTOR_SKETCH,
    }.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


@pytest.fixture
def session(inspector_folder: Path, open_session: OpenSession) -> Session:
    made = open_session(inspector_folder)
    return made


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
        colours = read_picture(picture)[::-1]
        whole = session.read_values("height:other")
        inside = 0
        for y in range(size[1]):
            for x in range(y % 4, size[0], 4):  # every row and every column
                result = inspector.at((x, y), picture)
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


def test_numbers_that_are_not_finite_are_named(
    inspector_folder: Path, session: Session, inspector: Inspector
) -> None:
    text = INSPECTOR_TERRAIN.replace(
        "other = share;", "other = share; if (texel.x == 30) height = uintBitsToFloat(0x7fc00000u);"
    )
    (inspector_folder / "terrain.glsl").write_text(text, encoding="utf-8")
    session.drafts.reload()
    session.frame((65, 49))
    session.show("height:height")
    picture = session.frame((65, 49))
    assert picture is not None
    result = inspector.at((30, 5), picture)
    assert result is not None and result.shown is not None and math.isnan(result.shown.values[0])
    assert any("nan" in text for _, text, _ in lines_of(result))


def test_a_key_brings_the_box_and_takes_it_away(inspector_folder: Path, open_bare: OpenBare) -> None:
    bare = open_bare(inspector_folder)
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
