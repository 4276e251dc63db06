"""The tool "erode": its window, its stamps, its rim, undoing it, and which technique it runs."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from playground.engine.engine import Engine
from playground.engine.file_sources import read_numbers
from playground.engine.on_arrays import OnArrays
from playground.engine.textures import read_texture
from playground.errors import ParameterError, SketchError
from playground.sketch.techniques import read_technique
from playground.studio.paint.brush import Brush, Dab
from playground.studio.paint.erode_tool import STAMP, ErodeTool, technique_at
from playground.studio.paint.layer import NUMBERS, Layer
from playground.studio.paint.painting import Painting
from playground.studio.session import Session

from ..plans import plans_made_whole
from .test_sculpted_sketch import PICTURE, PLACE, read, stroke
from .test_sculpted_sketch import painting as painting
from .test_sculpted_sketch import session as session

NY, NX = 97, 129
EXTENT = (1280.0, 1440.0)
DX, DY = EXTENT[0] / (NX - 1), EXTENT[1] / (NY - 1)  # [m] 10 and 15
Y, X = np.mgrid[0:NY, 0:NX] * np.array([DY, DX])[:, None, None]
BRUSH = Brush(tool="erode", radius=170.0, strength=0.9, softness=0.6)
HERE = (0.5, 0.5)


def hills(seed: int = 3) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return (900 + 120 * np.sin(X / 110) * np.cos(Y / 150) + rng.normal(0, 1, (NY, NX))).astype(np.float32)


def layer_of(engine: Engine, tmp_path: Path) -> Layer:
    made = Layer(tmp_path / "x.tif", np.zeros((NY, NX), np.float32), NUMBERS)
    made.set_base(hills())
    made.eroding = ErodeTool(engine, technique_at("erosion/brush", __file__))
    return made


def work(on: Layer, *path: tuple[float, float], seconds: float, frames: int = 1, brush: Brush = BRUSH):
    """Return the change after one stroke along a path at an even pace, painted in so many frames."""
    on.begin()
    times, places = np.linspace(0, 1, len(path)), np.array(path)
    shares = np.linspace(0, 1, frames + 1)
    at = [tuple(float(np.interp(share, times, places[:, axis])) for axis in (0, 1)) for share in shares]
    for a, b in pairwise(at):
        on.paint(Dab(a, b, EXTENT, brush, seconds / frames))  # type: ignore[arg-type]
    return on.pixels.astype(np.float64)


def test_erode_brush_wears_terrain_under_it_and_nowhere_else(any_engine: Engine, tmp_path: Path):
    change = work(layer_of(any_engine, tmp_path), HERE, HERE, seconds=1.0, frames=4)
    away = np.hypot(X - 640, Y - 720)
    assert change.min() < -2 and change.sum() < 0, "what is not laid down again leaves with the water"
    assert (change[away >= 170] == 0).all() and (change[away < 80] != 0).mean() > 0.9


def test_no_seam_is_at_the_brush_s_rim(any_engine: Engine, tmp_path: Path):
    """Each step changes the bed by the brush's share of some change; a hard brush fades too."""
    for softness in (0.6, 0.0):
        brush = Brush(tool="erode", radius=170.0, strength=0.9, softness=softness)
        change = work(layer_of(any_engine, tmp_path), HERE, HERE, seconds=1.0, brush=brush)
        away = np.hypot(X - 640, Y - 720)
        fade = 170.0 * max(softness, 0.25)
        for depth in (0.1, 0.2, 0.3):  # of the fade, from the rim: the share is 3 d^2 - 2 d^3
            band = (away < 170) & (away > 170 - depth * fade)
            assert np.abs(change[band]).max(initial=0) <= 3 * depth**2 * np.abs(change).max()


def test_a_window_gives_what_the_whole_terrain_gives(any_engine: Engine, tmp_path: Path):
    """Rates count by the clock of the grid's size: scaled, a step on the whole is a step on the window."""
    on, stamps = layer_of(any_engine, tmp_path), 10
    ground = hills()
    work(on, HERE, HERE, seconds=stamps * STAMP)
    clock = (NX - 1) / 64  # of the window's hours a step to the terrain's: 36 texels, filled up to 64
    usual = {"rain": 0.03, "wear": 0.02, "evaporation": 0.02, "friction": 0.02, "settling": 0.01}
    values = {name: value * clock for name, value in usual.items()} | {"hours": 4}
    away = np.hypot(X - 640, Y - 720)
    t = np.clip((170 - away) / (0.6 * 170), 0, 1)
    level = ground[NY // 2, NX // 2]
    value = {
        "height": ground - level,
        "brush": (0.9 * t * t * (3 - 2 * t)).astype(np.float32),
        "water": np.zeros((NY, NX, 4), np.float32),
        "flux": np.zeros((NY, NX, 4), np.float32),
    }
    run = OnArrays(any_engine, "erosion/brush")
    for _ in range(stamps):
        value |= run.run(value, spacing=(DX, DY), relief=1.0, values=values)
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
    away = np.hypot(X - position[0] * EXTENT[0], Y - position[1] * EXTENT[1])
    assert np.isfinite(change).all() and change.min() < -0.5 and change.sum() < 0
    assert (change[away >= 170] == 0).all()
    # A mirrored terrain is eroded alike: no side is treated as another.
    other = layer_of(any_engine, tmp_path)
    other.set_base(hills()[:, ::-1].copy())
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
    away = np.hypot(X - 640, Y - 720)
    t = np.clip((170 - away) / (0.6 * 170), 0, 1)
    np.testing.assert_allclose(change, -3 * 2 * 0.9 * t * t * (3 - 2 * t), atol=1e-3)


def test_a_technique_that_cannot_erode_says_so(any_engine: Engine, tmp_path: Path):
    with pytest.raises(ParameterError, match="has no output 'height', so the brush cannot erode with it"):
        ErodeTool(any_engine, read_technique("lighting/l_dot_n", tmp_path, tmp_path))
    with pytest.raises(SketchError, match="did you mean 'erosion/brush'"):
        technique_at("erosion/brus", __file__)
