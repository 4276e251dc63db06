"""Sculpting in a session: from the mouse to the heights, the picture, the file and back."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.engine.file_sources import read_numbers, write_numbers
from playground.engine.textures import read_texture
from playground.errors import DataError
from playground.studio.paint.brush import RISE, Brush, Dab
from playground.studio.paint.layer import NUMBERS, Layer
from playground.studio.paint.painting import CLICK, MAX_DAB_SECONDS, Painting
from playground.studio.session import Session

from ..sketch_texts import passes

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
def session(tmp_path: Path, any_engine: Engine) -> Iterator[Session]:
    (tmp_path / "sketch.toml").write_text(SKETCH)
    made = Session(any_engine, tmp_path / "sketch.toml")
    made.frame(PICTURE)
    assert made.error is None
    yield made
    made.release()


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
        painting._now.now += seconds  # type: ignore[attr-defined]
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
    assert layer is not None
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
    assert layer is not None
    first = layer.pixels.copy()
    painting.press(PLACE)
    getattr(painting, act)()
    ended = layer.pixels.copy()
    for position in (PLACE, (0.6, 0.55)):  # the button is still down
        painting._now.now += 0.05  # type: ignore[attr-defined]
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
        assert layer is not None
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
    assert layer is not None
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
