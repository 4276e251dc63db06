"""Sculpting: the tools against formulas, from the mouse to the file and back, erosion, queued writes."""

from __future__ import annotations

import subprocess
import sys
import threading
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from playground.engine.engine import Engine
from playground.engine.file_sources import read_numbers, write_numbers
from playground.engine.on_arrays import OnArrays
from playground.engine.textures import read_texture
from playground.errors import DataError, ParameterError, SketchError
from playground.sketch.techniques import read_technique
from playground.studio.actions import Actions
from playground.studio.edits.undo import Undo
from playground.studio.notices import Notices
from playground.studio.paint.brush import APPROACH, RISE, SHARPEN, TOOLS, Brush, Dab, sculpt
from playground.studio.paint.erode_tool import STAMP, ErodeTool, technique_at
from playground.studio.paint.layer import NUMBERS, LatestWrite, Layer
from playground.studio.paint.painting import CLICK, MAX_DAB_SECONDS, Painting
from playground.studio.save.sketch_file import SketchFile
from playground.studio.session import Session

from ..plans import plans_made_whole
from ..sketch_texts import passes
from .session_desk import OpenSession

SKETCH = (
    """format = 1
size = [97, 65]
extent = [2000.0, 1100.0]
relief = 200.0
"""
    + passes(
        hills="generation/layered_noise",
        rain="erosion/painted_factor",
        height="generation/sculpted",
        light="lighting/l_dot_n",
    ).replace('use = "generation/sculpted"', 'use = "generation/sculpted"\ninputs = { height = "hills" }')
    + """[view]
use = "view/terrain"
samples = 1
camera = { azimuth = 180, elevation = 60, distance = 3000 }
"""
)
PICTURE = (160, 120)
PLACE = (0.45, 0.5)


class Clock:
    """Seconds that a test counts."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def session(tmp_path: Path, open_session: OpenSession) -> Session:
    (tmp_path / "sketch.toml").write_text(SKETCH)
    made = open_session(tmp_path / "sketch.toml")
    made.frame(PICTURE)
    assert made.error is None
    return made


@pytest.fixture
def painting(session: Session, tmp_path: Path) -> Painting:
    made = Painting(session, tmp_path, Clock())
    made.choose("height.image")
    made.toggle()
    made.brush = Brush(tool="raise", radius=150.0, strength=1.0, softness=0.5)
    assert made.on and made.sculpts
    return made


def read(session: Session, name: str) -> np.ndarray:
    session.frame(PICTURE)
    assert session.error is None
    return session.engine.read(session.sketch, name)


def stroke(painting: Painting, *places: tuple[float, float], seconds: float = 0.05) -> None:
    painting.press(places[0])
    for position in places:
        painting.now.now += seconds  # type: ignore[attr-defined]
        painting.move(position)
    painting.release()
    painting.settle()


def test_what_is_painted_is_added_in_metres(session: Session, painting: Painting) -> None:
    before = read(session, "height")
    np.testing.assert_array_equal(before, read(session, "hills"))
    x, y = painting.ground(PLACE) or (0.0, 0.0)
    stroke(painting, PLACE)
    after = read(session, "height")
    rise = (after - before) * 200.0
    expected = RISE * 150.0 * (CLICK + 0.05)  # [m] in the brush's hard core
    there = round(y * 64), round(x * 96)
    assert abs(rise[there] - expected) < 0.01
    away = np.hypot(np.arange(97) / 96 * 2000 - x * 2000, (np.arange(65)[:, None] / 64 - y) * 1100)
    assert (rise[away > 150] == 0).all() and (rise[away < 149] > 0).all()
    layer = painting.layer
    assert layer is not None and layer.kind is NUMBERS
    exact = before.astype(np.float64) + layer.pixels.astype(np.float64) / 200.0
    np.testing.assert_allclose(after, exact, atol=2e-7 * max(1.0, np.abs(exact).max()))


def test_the_brush_works_for_as_long_as_the_button_is_down(session: Session, painting: Painting) -> None:
    stroke(painting, *[PLACE] * 8)
    layer = painting.layer
    assert abs(layer.pixels.max() - RISE * 150.0 * (CLICK + 8 * 0.05)) < 1e-3
    painting.undo()
    stroke(painting, PLACE, seconds=60.0)  # a frame that took a minute
    assert abs(layer.pixels.max() - RISE * 150.0 * (CLICK + MAX_DAB_SECONDS)) < 1e-3


def test_the_file_has_the_window_s_bits_and_draws_its_picture(
    session: Session, painting: Painting, tmp_path: Path
) -> None:
    empty = read_texture(session.frame(PICTURE))  # type: ignore[arg-type]
    stroke(painting, PLACE, (0.6, 0.55))
    layer = painting.layer
    assert layer is not None and layer.saved
    picture = read_texture(session.frame(PICTURE))  # type: ignore[arg-type]
    np.testing.assert_array_equal(read_numbers(layer.path, (97, 65)), layer.pixels)
    assert (picture != empty).any()
    text = SKETCH.replace(
        'use = "generation/sculpted"\n',
        f'use = "generation/sculpted"\nset = {{ image = "{layer.path.name}" }}\n',
    )
    (tmp_path / "saved.toml").write_text(text)
    with Engine(session.engine.ctx, driver=session.engine.driver) as another:
        other = Session(another, tmp_path / "saved.toml")
        try:
            np.testing.assert_array_equal(read_texture(other.frame(PICTURE)), picture)  # type: ignore[arg-type]
            assert other.error is None and not another.painted
        finally:
            other.release()


@pytest.mark.parametrize("act", ["undo", "redo", "clear"])
def test_stroke_ended_with_button_down_is_fully_undoable(painting: Painting, act: str) -> None:
    stroke(painting, PLACE)
    layer = painting.layer
    first = layer.pixels.copy()
    painting.press(PLACE)
    getattr(painting, act)()
    ended = layer.pixels.copy()
    for position in (PLACE, (0.6, 0.55)):  # the button is still down
        painting.now.now += 0.05  # type: ignore[attr-defined]
        painting.move(position)
    painting.release()
    painting.settle()
    np.testing.assert_array_equal(layer.pixels, ended)
    np.testing.assert_array_equal(read_numbers(layer.path, (97, 65)), ended)
    stroke(painting, PLACE)
    painting.undo()
    np.testing.assert_array_equal(layer.pixels, ended)
    while layer.can_undo:
        painting.undo()
    assert not layer.pixels.any() and first.any()


def test_a_stroke_that_begins_in_the_sky_paints_nothing(session: Session, painting: Painting) -> None:
    stroke(painting, PLACE)
    layer = painting.layer
    assert layer is not None and painting.ground((0.5, 0.99)) is None
    before = layer.pixels.copy()
    stroke(painting, (0.5, 0.99), PLACE)
    np.testing.assert_array_equal(layer.pixels, before)


def test_each_stroke_is_undone_and_redone_to_the_same_bytes(session: Session, painting: Painting) -> None:
    states, files = [], []
    for tool in ("raise", "smooth", "flatten", "sharpen", "lower", "erase"):
        painting.brush = Brush(tool=tool, radius=300.0, strength=0.7)  # type: ignore[arg-type]
        stroke(painting, (0.4, 0.45), (0.6, 0.55))
        layer = painting.layer
        states.append(layer.pixels.copy())
        files.append(layer.path.read_bytes())
        assert len(states) == 1 or (states[-1] != states[-2]).any()
    for act, order in ((painting.undo, range(4, -1, -1)), (painting.redo, range(1, 6))):
        for n in order:
            act()
            painting.settle()
            np.testing.assert_array_equal(layer.pixels, states[n])
            assert layer.path.read_bytes() == files[n]
            np.testing.assert_array_equal(read(session, "height.strokes"), states[n])
    painting.clear()
    assert not layer.pixels.any()
    painting.undo()
    np.testing.assert_array_equal(layer.pixels, states[-1])


def test_only_the_rectangle_goes_to_the_graphics_card(session: Session, painting: Painting) -> None:
    painting.brush = Brush(tool="raise", radius=60.0, strength=1.0)
    painting.press(PLACE)
    read(session, "height.strokes")
    paint = session.engine.runner.paint
    before = paint.uploaded
    painting.move((0.47, 0.5))
    layer = painting.layer
    np.testing.assert_array_equal(read(session, "height.strokes"), layer.pixels)
    assert 0 < paint.uploaded - before <= (120 / (2000 / 96) + 8) * (120 / (1100 / 64) + 4)
    painting.release()


def test_flatten_targets_stroke_start_height_or_fixed_level(session: Session, painting: Painting) -> None:
    hills = read(session, "hills") * 200.0
    x, y = painting.ground(PLACE) or (0.0, 0.0)
    there = round(y * 64), round(x * 96)
    for level in (None, 90.0):
        painting.brush = Brush(tool="flatten", radius=250.0, strength=1.0, softness=0.5, level=level)
        stroke(painting, *[PLACE] * 40)
        result = read(session, "height")[there[0] - 2 : there[0] + 3, there[1] - 2 : there[1] + 3] * 200.0
        np.testing.assert_allclose(result, hills[there] if level is None else level, atol=1e-3)
        painting.undo()


def test_a_factor_is_painted_as_what_is_added_to_1(session: Session, painting: Painting) -> None:
    painting.choose("rain.image")
    assert (read(session, "rain") == 1).all()
    painting.brush = Brush(tool="lower", radius=150.0, strength=1.0, softness=0.5)
    stroke(painting, *[PLACE] * 12)
    painting.brush = Brush(tool="raise", radius=150.0, strength=1.0, softness=0.5)
    stroke(painting, *[(0.6, 0.5)] * 100)
    layer = painting.layer
    assert layer is not None and layer.kind is NUMBERS and layer.ground is None
    result = read(session, "rain")
    np.testing.assert_array_equal(result, np.clip(1 + layer.pixels, 0, 4).astype(np.float32))
    assert abs(result.min() - 0.35) < 1e-5 and result.max() == 4
    assert (read(session, "height") == read(session, "hills")).all(), "the other layer is another"


def test_file_of_other_size_is_resampled_and_gaps_are_refused(tmp_path: Path) -> None:
    write_numbers(tmp_path / "coarse.tif", np.array([[0, 8], [-4, 4]], np.float32))
    layer = Layer.create(tmp_path, "fine", NUMBERS, (9, 5), of=tmp_path / "coarse.tif")
    assert layer.path.name == "fine.tif" and layer.size == (9, 5)
    np.testing.assert_allclose(layer.pixels[[0, 0, -1, -1], [0, -1, 0, -1]], [0, 8, -4, 4])
    write_numbers(tmp_path / "gaps.tif", np.array([[0, np.nan], [1, 2]], np.float32))
    with pytest.raises(DataError, match="1 texels have no data; expected a number in each"):
        Layer.create(tmp_path, "fine", NUMBERS, (9, 5), of=tmp_path / "gaps.tif")


def test_strokes_over_many_tiles_are_undone_one_by_one(tmp_path: Path) -> None:
    layer = Layer.create(tmp_path, "large", NUMBERS, (203, 150))
    rng = np.random.default_rng(5)
    states = [layer.pixels.copy()]
    for _ in range(8):
        layer.begin()
        for _ in range(4):
            start, end = (tuple(map(float, rng.uniform(-0.1, 1.1, 2))) for _ in range(2))
            layer.paint(Dab(start, end, (2000.0, 1500.0), Brush(tool="raise", radius=90.0), 0.1))
        layer.save()
        states.append(layer.pixels.copy())
    for expected in states[-2::-1]:
        layer.undo()
        np.testing.assert_array_equal(layer.pixels, expected)
    assert not layer.can_undo


# ── sculpting ─────────────────────────────────────────────────────────────────


SHAPING = tuple(tool for tool in TOOLS if tool != "erode")  # which runs a technique
EXTENT = (900.0, 400.0)
NY, NX = 41, 61
DX, DY = EXTENT[0] / (NX - 1), EXTENT[1] / (NY - 1)  # [m] 15 and 10
MIDDLE = (0.5, 0.5)
Y, X = np.mgrid[0:NY, 0:NX] * np.array([DY, DX])[:, None, None]


def hills(seed: int = 3) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return (300 + 80 * np.sin(X / 70) * np.cos(Y / 50) + rng.normal(0, 5, (NY, NX))).astype(np.float32)


def worked(tool: str, seconds: float, *, ground=None, start=None, at=(MIDDLE, MIDDLE), steps=1, **brush):
    """Return the change after a stroke, float64."""
    change = np.zeros((NY, NX), np.float32) if start is None else start.copy()
    value = Brush(**{"radius": 120.0, "strength": 0.8, "softness": 0.6, "tool": tool} | brush)
    for n in range(steps):
        a, b = (tuple(np.array(at[0]) + (np.array(at[1]) - at[0]) * (n + k) / steps) for k in (0, 1))
        sculpt(change, ground, Dab(a, b, EXTENT, value, seconds / steps), rate=40.0, level=310.0)
    return change.astype(np.float64)


def falloff(position=MIDDLE, radius=120.0, softness=0.6) -> np.ndarray:
    """Return the brush's share at each texel, from its description: a cubic over the softness."""
    away = np.hypot(X - position[0] * EXTENT[0], Y - position[1] * EXTENT[1])
    t = np.clip((radius - away) / (radius * softness), 0, 1)
    return 3 * t**2 - 2 * t**3


@pytest.mark.parametrize(("tool", "sign"), [("raise", 1), ("lower", -1)])
def test_raise_adds_rate_times_seconds_times_falloff(tool, sign):
    value = worked(tool, 0.5)
    np.testing.assert_allclose(value, sign * 0.8 * 40.0 * 0.5 * falloff(), atol=1e-4)


@pytest.mark.parametrize("tool", SHAPING)
def test_tool_effect_per_second_is_independent_of_frame_rate(tool):
    ground, start = hills(), np.full((NY, NX), 12.0, np.float32)
    once, often = (worked(tool, 1.0, ground=ground, start=start, steps=n) - 12.0 for n in (10, 100))
    assert np.abs(once).max() > 1
    np.testing.assert_allclose(once, often, atol=0.03 * np.abs(once).max())


def test_line_stroke_is_time_integral_of_brush():
    ends = (0.3, 0.4), (0.7, 0.6)
    value = worked("raise", 2.0, at=ends)
    shares = np.linspace(0, 1, 2001)
    places = (np.array(ends[0]) + share * (np.array(ends[1]) - ends[0]) for share in shares)
    expected = 0.8 * 40.0 * 2.0 * np.mean([falloff(tuple(position)) for position in places], axis=0)
    np.testing.assert_allclose(value, expected, atol=0.02 * expected.max())


def test_flatten_levels_hard_core_and_leaves_outside_unchanged():
    ground = hills()
    change = worked("flatten", 4.0, ground=ground, strength=1.0, softness=0.5)
    terrain = ground + change
    away = np.hypot(X - 450, Y - 200)
    core = away < 60 - 1e-6
    # exp(-rate t) of what was there is left, and what float32 rounds off.
    left = np.exp(-APPROACH * 4.0) * np.abs(ground - 310.0).max() + 4 * np.spacing(np.float32(310.0))
    assert np.abs(terrain[core] - 310.0).max() <= left
    assert (change[away >= 120] == 0).all()
    before, after = np.abs(ground.astype(float) - 310), np.abs(terrain - 310)
    assert (after <= before + 1e-4).all(), "nowhere farther from the level"


def test_flatten_and_erase_go_by_the_exponential():
    start = hills() - 300
    value = worked("erase", 0.13, start=start)
    np.testing.assert_allclose(value, start * np.exp(-APPROACH * 0.8 * 0.13 * falloff()), atol=1e-4)
    value = worked("flatten", 0.13, start=start)
    expected = 310 + (start - 310) * np.exp(-APPROACH * 0.8 * 0.13 * falloff())
    np.testing.assert_allclose(value, expected, atol=1e-4)


def test_smooth_moves_rock_and_makes_none():
    ground = hills()
    change = worked("smooth", 1.0, ground=ground, steps=7)
    assert np.abs(change).max() > 5
    # The sum of float32 roundings of 7 stamps over the texels that were reached.
    assert abs(change.sum()) < 7 * np.count_nonzero(change) * np.spacing(np.float32(np.abs(change).max()))
    inside = falloff() > 0
    terrain = ground + change
    assert terrain[inside].var() < 0.8 * ground[inside].var()
    assert terrain.max() <= ground.max() + 1e-3 and terrain.min() >= ground.min() - 1e-3
    assert (change[~inside] == 0).all()


def test_smooth_is_the_heat_equation_in_metres():
    """Under a brush that is 1 everywhere a wave decays by exp(-D k^2 t), alike along both axes."""
    seconds, radius = 0.1, 5000.0
    most = (32 * min(DX, DY)) ** 2 / 16 * seconds  # the finer side bounds its steps
    for axis, (length, coordinate) in enumerate([(10 * DY, Y), (10 * DX, X)]):
        wave = np.sin(2 * np.pi * coordinate / length)
        result = wave + worked(
            "smooth", seconds, ground=wave.astype(np.float32), strength=0.1, softness=0.0, radius=radius
        )
        inner = result[12:-12, 15:-15]
        spacing = (DY, DX)[axis]
        # Of the five-point operator: k^2 becomes (2 - 2 cos(k d)) / d^2.
        decay = np.exp(-0.1 * most * (2 - 2 * np.cos(2 * np.pi * spacing / length)) / spacing**2)
        assert decay < 0.9
        np.testing.assert_allclose(inner, decay * wave[12:-12, 15:-15], atol=0.02)


def test_sharpen_raises_what_stands_above_its_mean():
    ground = hills()
    value = worked("sharpen", 0.2, ground=ground)
    sigma, weight = 30.0, 0.8 * falloff()
    y, x = 17, 33
    # The mean by a slow sum over the square that the brush looks at: three deviations beyond its edge.
    columns = range(max(int(np.floor((450 - 210) / DX)), 0), min(int(np.ceil((450 + 210) / DX)) + 1, NX))
    rows = range(max(int(np.floor((200 - 210) / DY)), 0), min(int(np.ceil((200 + 210) / DY)) + 1, NY))
    near = [(j, i, np.exp(-(((i - x) * DX) ** 2 + ((j - y) * DY) ** 2) / (2 * sigma**2)))
            for j in rows for i in columns]  # fmt: skip
    mean = sum(g * float(ground[j, i]) for j, i, g in near) / sum(g for *_, g in near)
    expected = (np.exp(SHARPEN * 0.2 * weight[y, x]) - 1) * (ground[y, x] - mean)
    np.testing.assert_allclose(value[y, x], expected, rtol=1e-3)
    assert abs(worked("sharpen", 1.0, ground=np.full((NY, NX), 70.0, np.float32))).max() < 1e-4


@pytest.mark.parametrize("tool", SHAPING)
@pytest.mark.parametrize("position", [(0.0, 0.0), (1.0, 0.3), (3.0, 3.0), (-0.01, 1.005)])
def test_every_tool_stays_finite_at_edges_and_off_terrain(tool, position):
    ground = hills()
    value = worked(tool, 0.1, ground=ground, at=(position, position))
    assert np.isfinite(value).all()
    assert value.any() == (position[0] < 2 and tool != "erase")


@pytest.mark.parametrize("tool", SHAPING)
def test_a_mirrored_stroke_is_the_mirror_image(tool):
    ground, start = hills(), hills(4) - 300
    value = worked(tool, 0.3, ground=ground, start=start, at=((0.3, 0.4), (0.6, 0.5)))
    other = worked(tool, 0.3, ground=ground[:, ::-1], start=start[:, ::-1], at=((0.7, 0.4), (0.4, 0.5)))[
        :, ::-1
    ]
    np.testing.assert_allclose(value, other, atol=1e-3)


# ── erode tool ────────────────────────────────────────────────────────────────


ERODE_NY, ERODE_NX = 97, 129
ERODE_EXTENT = (1280.0, 1440.0)
ERODE_DX, ERODE_DY = ERODE_EXTENT[0] / (ERODE_NX - 1), ERODE_EXTENT[1] / (ERODE_NY - 1)  # [m] 10 and 15
ERODE_Y, ERODE_X = np.mgrid[0:ERODE_NY, 0:ERODE_NX] * np.array([ERODE_DY, ERODE_DX])[:, None, None]
BRUSH = Brush(tool="erode", radius=170.0, strength=0.9, softness=0.6)
HERE = (0.5, 0.5)


def erode_hills(seed: int = 3) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return (
        900 + 120 * np.sin(ERODE_X / 110) * np.cos(ERODE_Y / 150) + rng.normal(0, 1, (ERODE_NY, ERODE_NX))
    ).astype(np.float32)


def layer_of(engine: Engine, tmp_path: Path) -> Layer:
    made = Layer(tmp_path / "x.tif", np.zeros((ERODE_NY, ERODE_NX), np.float32), NUMBERS)
    made.set_base(erode_hills())
    made.eroding = ErodeTool(engine, technique_at("erosion/brush", __file__))
    return made


def work(on: Layer, *path: tuple[float, float], seconds: float, frames: int = 1, brush: Brush = BRUSH):
    """Return the change after one stroke along a path at an even pace, painted in so many frames."""
    on.begin()
    times, places = np.linspace(0, 1, len(path)), np.array(path)
    shares = np.linspace(0, 1, frames + 1)
    at = [tuple(float(np.interp(share, times, places[:, axis])) for axis in (0, 1)) for share in shares]
    for a, b in pairwise(at):
        on.paint(Dab(a, b, ERODE_EXTENT, brush, seconds / frames))  # type: ignore[arg-type]
    return on.pixels.astype(np.float64)


def test_erode_brush_wears_terrain_under_it_and_nowhere_else(any_engine: Engine, tmp_path: Path):
    change = work(layer_of(any_engine, tmp_path), HERE, HERE, seconds=1.0, frames=4)
    away = np.hypot(ERODE_X - 640, ERODE_Y - 720)
    assert change.min() < -2 and change.sum() < 0, "what is not laid down again leaves with the water"
    assert (change[away >= 170] == 0).all() and (change[away < 80] != 0).mean() > 0.9


def test_no_seam_is_at_the_brush_s_rim(any_engine: Engine, tmp_path: Path):
    """Each step changes the bed by the brush's share of some change; a hard brush fades too."""
    for softness in (0.6, 0.0):
        brush = Brush(tool="erode", radius=170.0, strength=0.9, softness=softness)
        change = work(layer_of(any_engine, tmp_path), HERE, HERE, seconds=1.0, brush=brush)
        away = np.hypot(ERODE_X - 640, ERODE_Y - 720)
        fade = 170.0 * max(softness, 0.25)
        for depth in (0.1, 0.2, 0.3):  # of the fade, from the rim: the share is 3 d^2 - 2 d^3
            band = (away < 170) & (away > 170 - depth * fade)
            assert np.abs(change[band]).max(initial=0) <= 3 * depth**2 * np.abs(change).max()


def test_a_window_gives_what_the_whole_terrain_gives(any_engine: Engine, tmp_path: Path):
    """Rates count by the clock of the grid's size: scaled, a step on the whole is a step on the window."""
    on, stamps = layer_of(any_engine, tmp_path), 10
    ground = erode_hills()
    work(on, HERE, HERE, seconds=stamps * STAMP)
    clock = (ERODE_NX - 1) / 64  # of the window's hours a step to the terrain's: 36 texels, filled up to 64
    usual = {"rain": 0.03, "wear": 0.02, "evaporation": 0.02, "friction": 0.02, "settling": 0.01}
    values = {name: value * clock for name, value in usual.items()} | {"hours": 4}
    away = np.hypot(ERODE_X - 640, ERODE_Y - 720)
    t = np.clip((170 - away) / (0.6 * 170), 0, 1)
    level = ground[ERODE_NY // 2, ERODE_NX // 2]
    value = {
        "height": ground - level,
        "brush": (0.9 * t * t * (3 - 2 * t)).astype(np.float32),
        "water": np.zeros((ERODE_NY, ERODE_NX, 4), np.float32),
        "flux": np.zeros((ERODE_NY, ERODE_NX, 4), np.float32),
    }
    run = OnArrays(any_engine, "erosion/brush")
    for _ in range(stamps):
        value |= run.run(value, spacing=(ERODE_DX, ERODE_DY), relief=1.0, values=values)
    expected = value["height"].astype(np.float64) - (ground - level)
    assert np.abs(expected).max() > 1
    np.testing.assert_allclose(on.pixels, expected, atol=1e-3 * np.abs(expected).max())


def waves(engine: Engine, tmp_path: Path, texels: int) -> tuple[Layer, float]:
    """Erode a terrain of 2560 m by a brush of 320 m, of so many texels; return it, and its spacing [m]."""
    spacing = 320.0 / texels
    y, x = np.mgrid[0 : 8 * texels + 1, 0 : 8 * texels + 1] * spacing
    ground = 300 + 120 * np.sin(x / 210) * np.cos(y / 250) + 15 * np.sin(x / 60 + 1) * np.sin(y / 70)
    on = Layer(tmp_path / "x.tif", np.zeros(ground.shape, np.float32), NUMBERS)
    on.set_base(ground.astype(np.float32))
    on.eroding = ErodeTool(engine, technique_at("erosion/brush", __file__))
    on.begin()
    on.paint(Dab(HERE, HERE, (2560.0, 2560.0), Brush(tool="erode", radius=320.0, strength=0.9), 0.8))
    return on, spacing


@pytest.mark.slow
def test_metric_brush_erodes_alike_on_coarse_and_fine_grids(any_engine: Engine, tmp_path: Path):
    lost = {}
    for texels in (3, 16, 24, 30, 31, 47):
        on, spacing = waves(any_engine, tmp_path, texels)
        lost[texels] = -on.pixels.astype(np.float64).sum() * spacing**2
    finest = lost[47]
    for texels in (16, 24, 30, 31):
        assert abs(lost[texels] / finest - 1) < 0.05, texels
    # Of the short waves' slope, sin(k x) of 60 m, differences over two texels of d m see sin(k d) / (k d).
    seen = np.sinc(320 / 3 / 60 / np.pi)
    assert seen < lost[3] / finest < 1.05


def test_brush_result_has_same_shape_on_coarse_and_fine_grids(any_engine: Engine, tmp_path: Path):
    result = []
    for per in (1, 2):
        on, _ = waves(any_engine, tmp_path, 16 * per)
        # Without what the coarse grid cannot have.
        result.append(gaussian_filter(on.pixels.astype(np.float64), 2 * per)[::per, ::per])
    coarse, fine = result
    assert np.sqrt(((coarse - fine) ** 2).mean()) < 0.1 * np.sqrt((fine**2).mean())


def test_a_stroke_is_the_same_bits_in_however_many_frames(any_engine: Engine, tmp_path: Path):
    path = (0.4, 0.45), (0.55, 0.5), (0.5, 0.6)
    result = [
        work(layer_of(any_engine, tmp_path), *path, seconds=0.8, frames=frames) for frames in (4, 16, 64)
    ]
    assert np.abs(result[0]).max() > 1
    for other in result[1:]:
        np.testing.assert_array_equal(other, result[0])


def test_a_fast_stroke_is_the_same_bits_in_however_many_frames(any_engine: Engine, tmp_path: Path):
    """Of 24 radii a second: at each twentieth of a second it erodes once, where the brush then is."""
    path = (0.05, 0.1), (0.9, 0.93)
    result = [
        work(layer_of(any_engine, tmp_path), *path, seconds=0.4, frames=frames) for frames in (2, 8, 32)
    ]
    assert result[0].min() < 0
    for other in result[1:]:
        np.testing.assert_array_equal(other, result[0])


@pytest.mark.parametrize("position", [(0.0, 0.0), (1.0, 0.4), (0.02, 0.99)])
def test_at_the_edges_it_wears_what_is_there(
    any_engine: Engine, tmp_path: Path, position: tuple[float, float]
):
    on = layer_of(any_engine, tmp_path)
    change = work(on, position, position, seconds=1.0)
    away = np.hypot(ERODE_X - position[0] * ERODE_EXTENT[0], ERODE_Y - position[1] * ERODE_EXTENT[1])
    assert np.isfinite(change).all() and change.min() < -0.5 and change.sum() < 0
    assert (change[away >= 170] == 0).all()
    # A mirrored terrain is eroded alike: no side is treated as another.
    other = layer_of(any_engine, tmp_path)
    other.set_base(erode_hills()[:, ::-1].copy())
    mirrored = work(other, (1 - position[0], position[1]), (1 - position[0], position[1]), seconds=1.0)
    np.testing.assert_allclose(mirrored[:, ::-1], change, atol=5e-3 * np.abs(change).max())


def test_a_brush_that_is_wider_than_the_terrain_works(any_engine: Engine, tmp_path: Path):
    wide = Brush(tool="erode", radius=3000.0, strength=0.9)
    change = work(layer_of(any_engine, tmp_path), HERE, HERE, seconds=0.2, brush=wide)
    assert np.isfinite(change).all() and (change != 0).mean() > 0.9


def test_warm_brush_stamps_compile_nothing_and_keep_engine_frame(
    any_engine: Engine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    wholes = plans_made_whole(monkeypatch)
    on = layer_of(any_engine, tmp_path)
    work(on, HERE, (0.6, 0.5), seconds=0.3)
    engine, existing = any_engine, []
    for _ in range(2):
        existing.append((len(engine.cache), engine.runner.programs.compiled, engine.runner.pool.made))
        wholes.clear()
        work(on, (0.3, 0.5), (0.6, 0.7), seconds=0.5)
        assert len(wholes) <= 1, "one plan a stroke: of its own level"
    assert existing[0] == existing[1]


def test_session_stroke_is_shown_saved_and_undone_bit_for_bit(
    session: Session, painting: Painting, tmp_path: Path
) -> None:
    painting.brush = Brush(tool="raise", radius=150.0, strength=1.0)
    stroke(painting, PLACE)
    layer = painting.layer
    assert layer is not None and layer.kind is NUMBERS
    raised = layer.pixels.copy()
    painting.brush = Brush(tool="erode", radius=300.0, strength=1.0)
    stroke(painting, (0.4, 0.45), *[(0.6, 0.55)] * 10)
    worn = layer.pixels.copy()
    assert (worn - raised).min() < -0.2
    np.testing.assert_array_equal(read(session, "height.strokes"), worn)
    picture = read_texture(session.frame(PICTURE))  # type: ignore[arg-type]
    session.redraw()
    np.testing.assert_array_equal(read_texture(session.frame(PICTURE)), picture)  # type: ignore[arg-type]
    painting.undo()
    np.testing.assert_array_equal(layer.pixels, raised)
    painting.redo()
    painting.settle()
    np.testing.assert_array_equal(layer.pixels, worn)
    np.testing.assert_array_equal(read_numbers(layer.path, layer.size), worn)


def test_where_no_height_is_there_is_nothing_to_erode(session: Session, painting: Painting) -> None:
    painting.take_tool("erode")
    assert "erode" in painting.tools and painting.brush.tool == "erode"
    painting.choose("rain.image")
    assert "erode" not in painting.tools and painting.brush.tool == "raise"
    painting.take_tool("erode")
    assert painting.brush.tool == "raise"
    assert "nothing to erode in rain.image: choose another tool" in session.notes


OWN = """#pragma kernel(output = "height:r32f")
uniform sampler2D height; //! input
float kernel(ivec2 texel) { return texelFetch(height, texel, 0).r - 2.0; }
"""


def test_another_technique_may_erode(any_engine: Engine, tmp_path: Path):
    """One that knows nothing of a brush is weighted by it."""
    (tmp_path / "lower.glsl").write_text(OWN)
    on = layer_of(any_engine, tmp_path)
    on.eroding = ErodeTool(any_engine, technique_at("./lower", str(tmp_path / "x.glsl")))
    change = work(on, HERE, HERE, seconds=3 * STAMP)
    away = np.hypot(ERODE_X - 640, ERODE_Y - 720)
    t = np.clip((170 - away) / (0.6 * 170), 0, 1)
    np.testing.assert_allclose(change, -3 * 2 * 0.9 * t * t * (3 - 2 * t), atol=1e-3)


def test_a_technique_that_cannot_erode_says_so(any_engine: Engine, tmp_path: Path):
    with pytest.raises(ParameterError, match="has no output 'height', so the brush cannot erode with it"):
        ErodeTool(any_engine, read_technique("lighting/l_dot_n", tmp_path, tmp_path))
    with pytest.raises(SketchError, match="did you mean 'erosion/brush'"):
        technique_at("erosion/brus", __file__)


# ── latest write ──────────────────────────────────────────────────────────────


def test_newest_of_queued_writes_alone_is_written() -> None:
    event, may_end, seen = threading.Event(), threading.Event(), []
    writing = LatestWrite()

    def first() -> None:
        event.set()
        may_end.wait(10)
        seen.append(0)

    writing.give(first)
    assert event.wait(10) and writing.pending
    for number in (1, 2, 3):
        writing.give(lambda number=number: seen.append(number))  # type: ignore[misc]
    assert not seen, "nobody has waited for it"
    may_end.set()
    writing.wait()
    assert seen == [0, 3] and writing.writes == 2 and not writing.pending


def test_error_belongs_to_last_write_and_next_one_clears_it() -> None:
    writing, ended = LatestWrite(), threading.Event()
    writing.ended = ended.set

    def fail() -> None:
        raise DataError("no space left on device")

    for wrong, sentence in ((fail, "no space left"), (lambda: 1 / 0, "could not be written: division")):
        writing.give(wrong)
        with pytest.raises(DataError, match=sentence):
            writing.wait()
    writing.give(lambda: None)
    writing.wait()
    assert writing.error is None and ended.wait(10)


def test_each_write_is_reported_before_a_wait_for_it_ends() -> None:
    """What is called may be gone afterwards: the window that it wakes."""
    seen: list[tuple[int, bool]] = []
    writing = LatestWrite(lambda: seen.append((writing.writes, writing.pending)))
    for number in (1, 2, 3):
        writing.give(lambda: None)
        writing.wait()
        assert len(seen) == number
    assert seen == [(1, True), (2, True), (3, True)]


def test_a_stroke_s_end_waits_for_no_file(
    session: Session, painting: Painting, monkeypatch: pytest.MonkeyPatch
) -> None:
    stroke(painting, PLACE)
    layer = painting.layer
    assert layer is not None and layer.kind is NUMBERS
    before, may_write = layer.path.read_bytes(), threading.Event()
    write = layer.kind.write

    def slowly(path: Path, pixels: np.ndarray) -> None:
        assert may_write.wait(10)
        write(path, pixels)

    monkeypatch.setattr(layer, "kind", replace(layer.kind, write=slowly))
    for _ in range(3):
        painting.press(PLACE)
        painting.release()
        painting.undo()
        painting.redo()
    assert layer.saved and layer.holds() and layer.path.read_bytes() == before
    threading.Timer(0.05, may_write.set).start()
    expected = layer.pixels.copy()
    painting.press(PLACE)  # goes on while the file is written: what is written is a copy
    assert not layer.saved
    assert painting.settle() and layer.saved
    np.testing.assert_array_equal(read_numbers(layer.path, layer.size), layer.pixels)
    assert (layer.pixels != expected).any()
    painting.close()


def test_what_cannot_be_written_is_said_once_and_tried_again(
    session: Session, painting: Painting, tmp_path: Path
) -> None:
    stroke(painting, PLACE)
    layer = painting.layer
    assert layer is not None and layer.kind is NUMBERS
    moved = tmp_path.rename(tmp_path.with_name("moved"))
    session.notes.clear()
    stroke(painting, PLACE)
    for _ in range(3):
        painting.follow()
    assert sum("there is no folder" in note for note in session.notes) == 1
    assert not layer.saved and painting.layer is layer
    assert len(painting.close()) == 1, "nothing is lost without a word"
    moved.rename(tmp_path)
    assert painting.close() == [] and layer.saved
    np.testing.assert_array_equal(read_numbers(layer.path, layer.size), layer.pixels)


def test_saving_reports_a_painting_that_cannot_be_written(
    session: Session, painting: Painting, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stroke(painting, PLACE)
    layer, notices = painting.layer, Notices()
    assert layer is not None

    def fail(path: Path, pixels: np.ndarray) -> None:
        raise DataError("no space left on device")

    monkeypatch.setattr(layer, "kind", replace(NUMBERS, write=fail))
    stroke(painting, PLACE)
    session.notes.clear()
    assert not painting.settle()
    assert list(session.notes) == ["no space left on device"]
    file = SketchFile(session, notices)
    actions = Actions(session, notices, Undo(session, notices, painting, file), file, tmp_path)
    missed = "; what was painted last could not be written, and is not in it"
    acts = actions.save_values, actions.save_values, actions.save_a_copy
    for act, begins in zip(acts, ("saved 1 value into ", "nothing differs ", "saved a copy "), strict=True):
        act()
        session.frame(PICTURE)
        message = notices.items[-1].text
        assert message.startswith(begins) and message.endswith(missed), message
    monkeypatch.setattr(layer, "kind", NUMBERS)
    actions.save_values()
    assert not notices.items[-1].text.endswith(missed)
    assert painting.settle()
    painting.close()


ENDS = """
import sys
from pathlib import Path
import numpy as np
from playground.studio.paint.brush import Brush, Dab
from playground.studio.paint.layer import NUMBERS, Layer
layer = Layer(Path(sys.argv[1]), np.zeros((2000, 2000), np.float32), NUMBERS)
for _ in range(5):
    layer.begin()
    layer.paint(Dab((0.5, 0.5), (0.5, 0.5), (9.0, 9.0), Brush(radius=9.0, strength=1.0), 1.0))
    layer.save()
raise SystemExit(7)
"""


@pytest.mark.slow
def test_a_process_that_ends_has_written_the_last_state(tmp_path: Path) -> None:
    path = tmp_path / "last.tif"
    done = subprocess.run([sys.executable, "-c", ENDS, str(path)], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (7, "")
    assert read_numbers(path, (2000, 2000)).max() == pytest.approx(5.0), "a second's raise, five times"
    assert [file.name for file in tmp_path.iterdir()] == ["last.tif"]
