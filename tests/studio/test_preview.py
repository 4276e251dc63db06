"""Previews: fewer samples, vertices and pixels while it moves, whole in pieces at rest."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from playground.engine import renderer
from playground.engine.camera import look
from playground.engine.context import ContextInfo
from playground.engine.engine import Engine
from playground.engine.textures import read_picture
from playground.engine.unfinished import PassesUnfinished
from playground.sketch.assign import values_of
from playground.sketch.find import find
from playground.sketch.model import DEFAULT_PICTURE, Camera, Sketch
from playground.studio.compare.compare import Compare
from playground.studio.cost.costs import PassCosts
from playground.studio.inspect.inspection import Inspection
from playground.studio.picture import shown_picture
from playground.studio.picture.full_screen import Enlarger
from playground.studio.picture.gestures import Gesture, steered_through
from playground.studio.picture.preview import (
    BUDGETS,
    DIVISORS,
    GRID,
    GRID_OF_FEWER,
    as_preview,
    chosen_divisor,
)
from playground.studio.picture.shown_picture import REST
from playground.studio.picture.view import MAX_FIELD_OF_VIEW, field_for, framed
from playground.studio.session import Session

from ..loading import load
from ..sketch_texts import passes
from .session_desk import OpenSession

SKETCH = """format = 1
size = 129
[[pass]]
name = "height"
use = "generation/diamond_square"
[view]
use = "view/terrain"
"""


@pytest.fixture
def terrain(tmp_path: Path) -> Sketch:
    (tmp_path / "terrain.toml").write_text(SKETCH, encoding="utf-8")
    return load(tmp_path / "terrain.toml")


def test_it_has_one_sample_and_a_coarser_mesh(terrain: Sketch):
    chosen = as_preview(terrain)
    assert chosen.picture.samples == 1 and values_of(chosen)["view.land.grid"] == GRID
    assert values_of(chosen) == values_of(terrain) | {"view.land.grid": GRID}
    assert chosen.terrain.size == terrain.terrain.size


def test_fewer_pixels_have_a_coarser_mesh_still(terrain: Sketch):
    assert values_of(as_preview(terrain, (600, 400), (600, 400)))["view.land.grid"] == GRID
    assert values_of(as_preview(terrain, (600, 400), (300, 200)))["view.land.grid"] == GRID_OF_FEWER


@pytest.mark.slow
def test_half_of_the_pixels_a_side_jump_no_more_than_stated(any_engine: Engine):
    """docs/explanation/performance.md: half a level of 255 in the mean, and the skyline by a pixel or two."""
    size, half = (960, 540), (480, 270)
    sketch = load("jacksboro")
    full = any_engine.render(sketch, size=size).array[..., :3].astype(np.float64)
    small = any_engine.draw(as_preview(sketch, size, half), size=half)
    with any_engine.borrowed():
        target = any_engine.ctx.simple_framebuffer(size, 4)
        enlarger = Enlarger(any_engine.ctx)
        enlarger.draw(small, target)
        data = target.read(components=3, alignment=1)
        enlarger.release()
        target.release()
    moving = np.frombuffer(data, np.uint8).reshape(size[1], size[0], 3)[::-1].astype(np.float64)
    assert abs(moving.mean() - full.mean()) < 0.5

    def skyline(picture: np.ndarray) -> np.ndarray:
        steps = np.abs(np.diff(picture.mean(axis=2), axis=0)) > 18
        return np.argmax(steps, axis=0)

    shifts = np.abs(skyline(moving) - skyline(full))
    assert np.median(shifts) <= 1 and np.percentile(shifts, 95) <= 2


@pytest.mark.parametrize("pixels", [(600, 400), (300, 200), (150, 100)])
def test_a_preview_has_one_sample_however_few_its_pixels(terrain: Sketch, pixels: tuple[int, int]):
    assert as_preview(terrain, (600, 400), pixels).picture.samples == 1 < terrain.picture.samples


@pytest.mark.parametrize("grid", [2, 100, 256, 1025])
def test_a_mesh_that_somebody_set_stays(terrain: Sketch, grid: int):
    chosen = terrain.with_values({"view.grid": grid})
    assert values_of(as_preview(chosen))["view.land.grid"] == grid
    alone = chosen.with_picture(samples=1)
    assert as_preview(alone) is alone


def test_what_draws_no_mesh_is_drawn_as_it_is(tmp_path: Path):
    (tmp_path / "flat.toml").write_text(SKETCH.partition("[view]")[0], encoding="utf-8")
    flat = load(tmp_path / "flat.toml")
    assert flat.picture.samples > 1 and as_preview(flat) is flat


def test_draws_that_must_share_a_mesh_still_do():
    """What is drawn over at equal depth has to have the same triangles."""
    sketch = load("splat_mask")
    values = values_of(as_preview(sketch))
    grids = [value for path, value in values.items() if path.endswith(".grid")]
    assert len(grids) > 1 and set(grids) == {GRID}


def test_the_preview_shows_the_same_land(terrain: Sketch, any_engine: Engine):
    preview = any_engine.render(as_preview(terrain), size=(160, 90)).array.astype(np.float64)
    full = any_engine.render(terrain, size=(160, 90)).array.astype(np.float64)
    far = np.abs(preview - full).max(axis=2) > 32
    assert (preview != full).any() and far.mean() < 0.1


def test_preview_picks_own_variants_when_full_picture_moves(
    terrain: Sketch, any_engine: Engine, open_session: OpenSession
):
    """What would run of the full picture is no pass of the preview, where the terrain is drawn first."""
    session = open_session(terrain.file)
    session.clock.playing = False
    session.frame((640, 360))
    session.read()  # in full
    assert session.sketch is not None and session.error is None
    camera = session.sketch.camera
    for number in range(1, 4):
        session.drafts.set_camera(replace(camera, azimuth=camera.azimuth + number))
        session.frame((640, 360))
        assert session.error is None
        assert session.is_preview == any_engine.info.software
    ran = set(any_engine.record.ran)
    assert ("view.fast.land" if any_engine.info.software else "view.land") in ran


def test_a_saved_text_is_planned_as_a_preview_alone(
    terrain: Sketch, any_engine: Engine, open_session: OpenSession, monkeypatch: pytest.MonkeyPatch
):
    """The plan in full waits until the picture is there; what only has another comment is asked of that."""
    file = Path(terrain.file)
    kernel = file.parent / "own.glsl"
    file.write_text(SKETCH.replace("generation/diamond_square", "./own"), encoding="utf-8")
    text = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) { return 0.1; }\n'
    kernel.write_text(text, encoding="utf-8")
    planned: list[int] = []
    plan = renderer.planned
    monkeypatch.setattr(
        renderer,
        "planned",
        lambda sketch, request: planned.append(sketch.picture.samples) or plan(sketch, request),
    )
    session = open_session(file)
    session.frame((640, 360))
    session.read()
    other = text.replace("0.1", "0.2")
    for saved, in_full in ((other, False), (f"{other}// the same\n", True)):
        kernel.write_text(saved, encoding="utf-8")
        planned.clear()
        session.drafts.reload()
        session.frame((640, 360))
        assert session.error is None
        if any_engine.info.software:
            assert (max(planned) > 1) is in_full
        session.read()


# ── preview choices ───────────────────────────────────────────────────────────


SIZE = (160, 90)
SHADOW_SKETCH = """format = 1
size = 65
extent = 640
relief = 200
[[pass]]
name = "height"
use = "generation/diamond_square"
[[pass]]
name = "light"
use = "lighting/ray_cast"
[view]
use = "view/terrain"
"""
FORM = "light.visibility.form"
LOW = (120.0, 6.0)  # a sun with long shadows


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "shadow.toml").write_text(SHADOW_SKETCH, encoding="utf-8")
    return tmp_path / "shadow.toml"


@pytest.fixture
def session(path: Path, any_engine: Engine, monkeypatch) -> Iterator[Session]:
    monkeypatch.setattr(ContextInfo, "software", True)
    with Engine(any_engine.ctx) as engine:
        result = Session(engine, path)
        result.clock.playing = False
        result.frame(SIZE)
        result.read()
        yield result
        result.release()


@pytest.fixture
def compute(any_engine: Engine) -> None:
    if not any_engine.info.compute:
        pytest.skip("this context has no compute shaders")


def form(session: Session) -> object:
    """Return the form by which the last picture's shadow was made."""
    return next(
        step.values["form"]
        for step in session.plan.walk()
        if step.path.startswith("light.visibility") and "form" in step.values
    )


def shadow_runs(session: Session) -> int:
    """Return how often the pass that makes the shadow has run, in either form."""
    names = ("light.visibility", "light.visibility.fast.visibility")
    return sum(session.engine.runs[name] for name in names)


def test_only_passes_that_are_named_have_it(path: Path):
    sketch = load(path)
    assert values_of(as_preview(sketch))[FORM] == 0
    assert values_of(as_preview(sketch, faster={"light.light", "height"}))[FORM] == 0
    assert values_of(as_preview(sketch, faster={"light.visibility"}))[FORM] == 1


@pytest.mark.parametrize("of_the_group", [{"light.step_length": 2.0}, {"light.sampling": "cut down"}])
def test_not_while_something_of_its_group_is_set(path: Path, of_the_group: dict[str, object]):
    sketch = load(path).with_values(of_the_group)
    assert values_of(as_preview(sketch, faster={"light.visibility"}))[FORM] == 0


def test_it_alone_makes_a_preview(path: Path):
    sketch = load(path).with_picture(samples=1).with_values({"view.grid": 20})
    assert as_preview(sketch) is sketch
    chosen = as_preview(sketch, faster={"light.visibility"})
    assert values_of(chosen) == values_of(sketch) | {FORM: 1}


@pytest.mark.usefixtures("compute")
def test_a_dragged_sun_sweeps_and_one_at_rest_marches(session: Session, any_engine: Engine):
    sketch = load(session.path).with_values({"light.sun": (200.0, 20.0)})
    full = any_engine.render(sketch, size=SIZE).array
    session.drafts.set("light.sun", (200.0, 20.0))
    session.frame(SIZE)
    assert session.error is None and session.is_preview and form(session) == 1
    before = shadow_runs(session)
    session.drafts.set_camera(replace(session.sketch.camera, azimuth=31.0))
    session.frame(SIZE)
    assert form(session) == 1 and shadow_runs(session) == before, "nothing of the shadow has changed"
    session.drafts.set_camera(None)
    np.testing.assert_array_equal(session.read().array, full)
    assert form(session) == 0 and not session.is_preview


def test_a_camera_that_moves_leaves_the_shadow_as_it_is(session: Session):
    before = shadow_runs(session)
    for azimuth in (10.0, 11.0, 12.0):
        session.drafts.set_camera(replace(session.sketch.camera, azimuth=azimuth))
        session.frame(SIZE)
        assert session.is_preview and form(session) == 0
    assert shadow_runs(session) == before


def test_resting_preview_runs_nothing_until_full_draw(session: Session):
    session.drafts.set("light.sun", (200.0, 20.0))
    session.frame(SIZE)
    before = dict(session.engine.runs)
    session.frame(SIZE)
    assert session.engine.runs == before


@pytest.mark.usefixtures("compute")
def test_what_it_is_compared_with_has_the_same_form(session: Session, any_engine: Engine):
    """A sweeps while B does, so that the two differ by what was changed alone; at rest both march."""
    compare = Compare(session)

    def follow() -> NDArray[np.uint8]:
        picture = session.picture.texture
        assert picture is not None
        compare.follow(picture)
        return read_picture(compare.picture)

    session.drafts.set("light.sun", LOW)
    session.frame(SIZE)
    session.read()
    compare.keep()
    full = follow()
    session.drafts.set("light.sun", (200.0, 20.0))
    session.frame(SIZE)
    seen, sketch = follow(), load(session.path).with_values({"light.sun": LOW})
    assert form(session) == 1 and session.picture.drawn_size == SIZE
    swept = as_preview(sketch, faster={"light.visibility"})
    np.testing.assert_array_equal(seen, any_engine.render(swept, size=SIZE).array)
    assert (seen != any_engine.render(as_preview(sketch), size=SIZE).array).any()
    session.drafts.set("light.sun", (201.0, 20.0))
    session.frame(SIZE)
    follow()
    assert compare.draws == 1, "A has that form already"
    session.read()
    np.testing.assert_array_equal(follow(), full)
    compare.release()


def test_without_compute_shaders_it_marches(session: Session, monkeypatch):
    monkeypatch.setattr(ContextInfo, "compute", False)
    session.drafts.set("light.sun", (200.0, 20.0))
    session.frame(SIZE)
    assert session.is_preview and form(session) == 0


def test_a_save_shows_what_is_written(session: Session, path: Path):
    """Somebody who edits the march looks at it."""
    path.write_text(SHADOW_SKETCH.replace("relief = 200", "relief = 260"), encoding="utf-8")
    session.drafts.reload([path])
    session.frame(SIZE)
    assert session.plan is not None and session.plan.terrain.relief == 260.0
    assert form(session) == 0


@pytest.mark.usefixtures("compute")
@pytest.mark.parametrize("use", ["ray_cast", "soft_cone", "sun_disc"])
def test_the_sweep_of_a_preview_jumps_no_more_than_stated(tmp_path: Path, any_engine: Engine, use: str):
    """lighting/sun_sweep: of hard shadows 0.6 % of the texels at most, of soft ones 0.006 on average."""
    text = SHADOW_SKETCH.replace("ray_cast", use).replace("size = 65", "size = 257")
    (tmp_path / "soft.toml").write_text(text, encoding="utf-8")
    sketch = load(tmp_path / "soft.toml").with_values({"light.sun": (200.0, 15.0)})
    result = [
        any_engine.read(each, "light.visibility")
        for each in (sketch, as_preview(sketch, faster={"light.visibility"}))
    ]
    far = np.abs(result[0] - result[1])
    assert far.any() and far.mean() <= 0.006


# ── preview size ──────────────────────────────────────────────────────────────


SLOW_SIZE = (640, 480)
RAMP = """#pragma kernel(output = "frame:rgba8")
uniform float level = 0.5;  //! slider(0, 1)
uniform sampler2D made;     //! input
vec4 kernel(ivec2 texel) {
    return vec4(vec2(texel) / vec2(size), level * texelFetch(made, ivec2(0), 0).r, 1.0);
}
"""
MADE = """#pragma kernel(output = "made:r32f")
uniform float high = 0.5;  //! slider(0, 1)
float kernel(ivec2 texel) { return high; }
"""
COUNT = """#pragma kernel(output = "frame:rgba8")
uniform sampler2D before;  //! input("zero")
vec4 kernel(ivec2 texel) { return texelFetch(before, texel, 0) + vec4(1.0 / 255.0); }
"""
POINTER = """void mainImage(out vec4 colour, vec2 at) { colour = vec4(iMouse.xy / iResolution.xy, 0, 1); }
"""
SLOW_SKETCH = """format = 1
size = 8
[[pass]]
name = "made"
use = "./made"
size = 8
[view]
use = "./ramp"
inputs = { made = "made" }
"""


@dataclass
class MadeUpTimer:
    """Says that passes took what a test makes up: [ms] for a texel, and for any number of them."""

    engine: Engine
    each: dict[str, float] = field(default_factory=dict)
    fixed: dict[str, float] = field(default_factory=dict)
    busy: Callable[[], float] = lambda: 1.0  # a factor of all
    clock: str = "made up"

    @contextmanager
    def measure(self, into: dict[str, float], name: str) -> Iterator[None]:
        yield
        step = self.engine.record.plan.step(name)
        texels = step.size[0] * step.size[1]
        into[name] = self.busy() * (self.fixed.get(name, 0.0) + self.each.get(name, 0.0) * texels)


@dataclass
class Slow:
    """A session on the sketch of this file, its clock and what its passes take."""

    session: Session
    timer: MadeUpTimer
    now: list[float]

    def frame(self, seconds: float = 0.0) -> tuple[int, int]:
        """Let a frame pass, so many seconds after the last; return the pixels that were drawn."""
        self.now[0] += seconds
        self.session.frame(SLOW_SIZE)
        assert self.session.error is None
        return self.session.picture.drawn_size

    def move(self, times: int, path: str = "view.level") -> list[int]:
        """Move a slider for so many frames; return by what the sides were divided."""
        numbers = []
        for number in range(times):
            self.session.drafts.set(path, 0.1 + 0.79 * number / times)
            numbers.append(round(SLOW_SIZE[0] / self.frame(0.05)[0]))
        return numbers


@pytest.fixture
def slow(tmp_path: Path, any_engine: Engine, monkeypatch: pytest.MonkeyPatch) -> Iterator[Slow]:
    """Open the sketch; a whole picture takes a second."""
    for name, text in (("ramp.glsl", RAMP), ("made.glsl", MADE), ("sketch.toml", SLOW_SKETCH)):
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.setattr(ContextInfo, "software", True)
    timer = MadeUpTimer(any_engine, each={"view": 1000.0 / (SLOW_SIZE[0] * SLOW_SIZE[1])})
    monkeypatch.setattr(any_engine, "_frame_timer", lambda: timer)
    now = [0.0]
    made = Slow(Session(any_engine, tmp_path / "sketch.toml", now=lambda: now[0]), timer, now)
    yield made
    made.session.release()


def test_a_slow_picture_moves_in_fewer_pixels_and_rests_in_full(slow: Slow):
    session = slow.session
    slow.frame()
    slow.frame(1.0)
    assert session.picture.drawn_size == SLOW_SIZE and not session.is_preview
    divisors = slow.move(12)
    spent = sum(session.engine.record.times.values())
    assert set(divisors[-6:]) == {3} and spent < 1e3 * BUDGETS[3], "the largest within its budget: 111 ms"
    assert session.is_preview and session.picture.texture.size == SLOW_SIZE and not session.is_idle
    assert slow.frame(REST / 2) != SLOW_SIZE and slow.frame(REST) == SLOW_SIZE
    assert not session.is_preview and session.is_idle
    expected = session.engine.render(session.sketch, size=SLOW_SIZE).array
    np.testing.assert_array_equal(session.read().array[..., :3], expected[..., :3])


def test_the_first_picture_is_small_and_the_next_frame_is_whole(slow: Slow):
    width, height = slow.frame()
    assert (width, height) == (213, 160) and slow.session.picture.texture.size == SLOW_SIZE
    assert slow.frame() == SLOW_SIZE and slow.session.draws == 2


def test_what_is_read_back_is_whole_while_it_moves(slow: Slow):
    slow.move(6)
    picture = slow.session.read().array
    expected = slow.session.engine.render(slow.session.sketch, size=SLOW_SIZE).array
    np.testing.assert_array_equal(picture[..., :3], expected[..., :3])


def test_a_fast_picture_stays_whole(slow: Slow):
    slow.timer.each["view"] /= 40  # 25 ms
    slow.frame()
    slow.frame(1.0)
    assert set(slow.move(10)) == {1}


def test_what_fewer_pixels_do_not_make_faster_stays_whole(slow: Slow):
    slow.timer.each["view"] /= 20
    slow.timer.fixed["made"] = 700.0
    slow.frame()
    slow.frame(1.0)
    assert set(slow.move(8, "made.high")) == {1}


def test_a_slider_that_runs_only_fast_passes_shows_all_pixels(slow: Slow):
    """Which passes run decides, and not what the last picture took."""
    slow.timer.each = {"made": 1.0, "view": 1e-6}
    slow.timer.fixed["made"] = 700.0
    slow.frame()
    slow.frame(1.0)
    slow.move(3, "made.high")
    assert set(slow.move(3, "view.level")) == {1}


def test_preview_size_is_steady_under_varying_machine_load(slow: Slow):
    factors = itertools.cycle((1.0, 1.3, 0.9, 1.1))
    slow.timer.each["view"] *= 0.7
    slow.timer.busy = lambda: next(factors)
    slow.frame()
    slow.frame(1.0)
    divisors = slow.move(40)[8:]
    assert sum(a != b for a, b in itertools.pairwise(divisors)) <= 1, str(divisors)


def test_preview_size_changes_with_one_fifth_hysteresis():
    by_size = {d: 4.5 * BUDGETS[2] / d**2 for d in DIVISORS}  # a half: 1.125 of its budget
    assert (
        chosen_divisor(by_size, 2) == 2
        and chosen_divisor(by_size, 3) == 3
        and chosen_divisor(by_size, 1) == 3
    )
    by_size = {d: 3.6 * BUDGETS[2] / d**2 for d in DIVISORS}
    assert chosen_divisor(by_size, 3) == 3 and chosen_divisor(by_size, 1) == 2
    by_size = {d: 3.0 * BUDGETS[2] / d**2 for d in DIVISORS}
    assert chosen_divisor(by_size, 3) == 2
    by_size = {d: 1.1 * BUDGETS[1] / d for d in DIVISORS}
    assert chosen_divisor(by_size, 1) == 1 and chosen_divisor(by_size, 2) == 2
    assert chosen_divisor({d: 9.0 + 0.1 / d**2 for d in DIVISORS}, 4) == 1, "fewer pixels gain nothing"


def test_a_simulation_keeps_its_size(slow: Slow, tmp_path: Path):
    """Another size would begin it again, from second 0."""
    (tmp_path / "count.glsl").write_text(COUNT, encoding="utf-8")
    inside = passes(count=("./count", 'repeat = "frames"', 'feedback = { before = "frame" }'))
    (tmp_path / "counted.toml").write_text(inside, encoding="utf-8")
    (tmp_path / "counting.toml").write_text('format = 1\n[view]\nuse = "./counted"\n', encoding="utf-8")
    slow.session.open(tmp_path / "counting.toml")
    for _ in range(4):
        assert slow.frame(0.05) == SLOW_SIZE
        slow.session.clock.time += 0.1


def test_too_slow_time_is_paused_once_for_full_picture(slow: Slow, tmp_path: Path):
    (tmp_path / "ramp.glsl").write_text(RAMP.replace("level *", "fract(time) * level *"), encoding="utf-8")
    (tmp_path / "playing.toml").write_text(SLOW_SKETCH, encoding="utf-8")
    session = slow.session
    session.open(tmp_path / "playing.toml")

    def play(frames: int) -> list[tuple[int, int]]:
        result = []
        for _ in range(frames):
            session.advance(0.05, datetime(2026, 11, 23, tzinfo=UTC))
            result.append(slow.frame(0.05))
        return result

    assert SLOW_SIZE not in play(4) and not session.clock.playing
    assert [note for note in session.notes if "paused" in note] == [
        "time is paused, so that the picture is drawn in full; Space plays it"
    ]
    stands = session.clock.time
    assert play(8)[-1] == SLOW_SIZE and session.clock.time == stands and not session.is_preview
    session.clock.toggle()
    assert play(8)[-1] != SLOW_SIZE and session.clock.playing, "who plays it, knows"
    assert session.clock.time == pytest.approx(stands + 0.4)


def test_time_that_is_fast_enough_is_not_paused(slow: Slow, tmp_path: Path):
    slow.timer.each["view"] /= 20
    (tmp_path / "ramp.glsl").write_text(RAMP.replace("level *", "fract(time) * level *"), encoding="utf-8")
    (tmp_path / "playing.toml").write_text(SLOW_SKETCH, encoding="utf-8")
    slow.session.open(tmp_path / "playing.toml")
    for _ in range(8):
        slow.session.advance(0.05, datetime(2026, 11, 23, tzinfo=UTC))
        slow.frame(0.05)
    assert slow.session.clock.playing and not slow.session.notes


def test_maps_and_what_reads_pixels_have_them_all(slow: Slow):
    slow.frame()
    slow.frame(1.0)
    slow.move(6)
    slow.session.show("made:made")
    assert slow.frame() == SLOW_SIZE
    slow.session.show(None)
    inspection = Inspection(slow.session)
    inspection.inspector.toggle()
    inspection.begin()
    assert set(slow.move(4)) == {1}
    inspection.inspector.toggle()
    inspection.begin()
    assert set(slow.move(6)[-2:]) == {3}


def test_compared_pictures_have_the_same_pixels(slow: Slow):
    slow.frame()
    slow.frame(1.0)
    compare = Inspection(slow.session).compare
    kept = slow.session.sketch
    compare.keep()
    compare.follow(slow.session.picture.texture)
    slow.move(6, "made.high")
    slow.session.clock.time = 0.0
    compare.follow(slow.session.picture.texture)
    assert compare.picture.size == SLOW_SIZE and slow.session.is_preview
    assert slow.session.engine.record.plan.frame_size == slow.session.picture.drawn_size != SLOW_SIZE
    slow.frame(1.0)
    compare.follow(slow.session.picture.texture)
    assert slow.session.picture.drawn_size == SLOW_SIZE
    result = np.frombuffer(compare.picture.read(), np.uint8).reshape(*SLOW_SIZE[::-1], -1)
    expected = slow.session.engine.render(kept, size=SLOW_SIZE).array
    np.testing.assert_array_equal(result[::-1, :, :3], expected[..., :3])
    compare.release()


@pytest.mark.room("dialects")
def test_shader_sees_mouse_at_same_place_in_smaller_picture(slow: Slow, tmp_path: Path):
    (tmp_path / "pointer.glsl").write_text(POINTER, encoding="utf-8")
    slow.session.open(tmp_path / "pointer.glsl")
    assert slow.frame() != SLOW_SIZE
    slow.session.hover((480.0, 120.0), pressed=True, clicked=True)
    slow.timer.each = {step.path: 1e-2 for step in slow.session.plan.walk()}
    for _ in range(3):
        slow.session.redraw()
        slow.frame()
    assert slow.session.picture.drawn_size != SLOW_SIZE
    picture = np.frombuffer(slow.session.picture.texture.read(), np.uint8).reshape(-1, 4)
    np.testing.assert_allclose(picture[0, :2], [0.75 * 255, 0.25 * 255], atol=1)


@pytest.mark.parametrize(("small", "large"), [((40, 30), (120, 90)), ((41, 23), (97, 60))])
def test_a_cubic_surface_is_enlarged_to_itself(
    any_engine: Engine, small: tuple[int, int], large: tuple[int, int]
):
    """Catmull-Rom's splines reproduce parabolas; the border, where texels repeat, is left out."""

    def surface(size: tuple[int, int]) -> np.ndarray:
        x, y = ((np.arange(side) + 0.5) / side for side in size)
        return 0.2 + 0.5 * x[None, :] ** 2 + 0.3 * (1 - y[:, None]) * y[:, None]

    texels = np.round(surface(small) * 255).astype(np.uint8)
    ctx = any_engine.ctx
    enlarger = Enlarger(ctx)
    picture = ctx.texture(small, 4, np.repeat(texels[..., None], 4, 2).tobytes())
    shown = ctx.texture(large, 4)
    target = ctx.framebuffer([shown])
    with any_engine.borrowed():
        enlarger.draw(picture, target)
    result = np.frombuffer(shown.read(), np.uint8).reshape(large[1], large[0], 4)
    for made in (enlarger, target, shown, picture):
        made.release()
    edge = 2 * (-(-large[0] // small[0]))
    inner = (slice(edge, -edge), slice(edge, -edge))
    np.testing.assert_allclose(result[..., 0][inner], 255 * surface(large)[inner], atol=1.8)


def test_grey_pictures_and_coloured_ones_are_enlarged_in_turn(any_engine: Engine):
    ctx, size, large = any_engine.ctx, (6, 4), (13, 11)
    level = np.full((size[1], size[0], 4), (200, 90, 30, 255), np.uint8)
    shown, enlarger = ctx.texture(large, 4), Enlarger(ctx)
    target = ctx.framebuffer([shown])
    grey, coloured = ctx.texture(size, 1, level[..., 0].tobytes(), alignment=1), ctx.texture(size, 4, level)
    for picture, expected in ((grey, (200, 200, 200)), (coloured, (200, 90, 30)), (grey, (200, 200, 200))):
        with any_engine.borrowed():
            enlarger.draw(picture, target)
        result = np.frombuffer(shown.read(), np.uint8).reshape(-1, 4)
        np.testing.assert_allclose(result[:, :3], np.tile(expected, (len(result), 1)), atol=1)
    for made in (enlarger, target, shown, grey, coloured):
        made.release()


def test_pass_costs_interpolate_linearly_and_drop_first_sample():
    costs = PassCosts()
    assert costs.expected("a", 100) is None
    costs.take({"a": 100}, {"a": 900.0})  # with its compiler
    assert costs.expected("a", 200) == 1800.0
    costs.take({"a": 100}, {"a": 30.0})
    assert costs.expected("a", 100) == 30.0 and costs.expected("a", 50) == 15.0
    costs.take({"a": 400}, {"a": 90.0})
    assert costs.expected("a", 200) == pytest.approx(50.0) and costs.expected("a", 900) == pytest.approx(
        190.0
    )
    costs.take({"a": 400}, {"a": 110.0})
    assert costs.expected("a", 400) == 100.0, "slower: it may have been busy"
    costs.take({"a": 400}, {"a": 70.0})
    assert costs.expected("a", 400) == 70.0


# ── pieces ────────────────────────────────────────────────────────────────────


PIECES_SKETCH = """format = 1
size = 65
extent = 640
relief = 200
[[pass]]
name = "height"
use = "generation/diamond_square"
[[pass]]
name = "colour"
use = "texturing/height_colour"
[[pass]]
name = "light"
use = "lighting/l_dot_n"
[view]
use = "view/terrain"
set = { sea = true, sea_level = 60 }
"""


@pytest.fixture
def pieces_session(tmp_path: Path, any_engine: Engine, monkeypatch) -> Iterator[Session]:
    """A session at rest, drawn in full, in which a piece is a single pass."""
    monkeypatch.setattr(ContextInfo, "software", True)
    monkeypatch.setattr(shown_picture, "REST", 0.0)
    monkeypatch.setattr(shown_picture, "PIECE", 0.0)
    (tmp_path / "sea.toml").write_text(PIECES_SKETCH, encoding="utf-8")
    with Engine(any_engine.ctx) as engine:
        result = Session(engine, tmp_path / "sea.toml")
        result.clock.playing = False
        result.frame(SIZE)
        result.read()
        yield result
        result.release()


def turned(pieces_session: Session, azimuth: float) -> None:
    pieces_session.drafts.set_camera(replace(load(pieces_session.path).camera, azimuth=azimuth))


def of_a_full_picture(pieces_session: Session) -> list[str]:
    """Return the passes that a full picture runs after a preview of another camera, in their order."""
    turned(pieces_session, 10.0)
    pieces_session.frame(SIZE)
    pieces_session.read()
    return list(pieces_session.engine.record.ran)


def pieces(pieces_session: Session) -> list[list[str]]:
    """Draw frames until the picture rests; return the passes that each of them ran."""
    names = []
    while pieces_session.is_preview:
        pieces_session.frame(SIZE)
        assert pieces_session.error is None and len(names) < 20
        names.append(list(pieces_session.engine.record.ran))
    return names


def test_each_piece_runs_what_is_left(pieces_session: Session):
    expected = of_a_full_picture(pieces_session)
    assert len(expected) > 2
    turned(pieces_session, 40.0)
    pieces_session.frame(SIZE)
    preview = pieces_session.picture.frame("", 0.0).array
    assert pieces_session.is_preview
    assert pieces(pieces_session) == [[path] for path in expected]
    full = pieces_session.engine.render(pieces_session.sketch, size=SIZE).array
    np.testing.assert_array_equal(pieces_session.picture.frame("", 0.0).array, full)
    assert (preview != full).any()


def test_the_preview_stays_until_the_last(pieces_session: Session):
    expected = of_a_full_picture(pieces_session)
    turned(pieces_session, 40.0)
    pieces_session.frame(SIZE)
    preview, draws = pieces_session.picture.frame("", 0.0).array, pieces_session.draws
    for _ in expected[:-1]:
        pieces_session.frame(SIZE)
        np.testing.assert_array_equal(pieces_session.picture.frame("", 0.0).array, preview)
        assert pieces_session.is_preview and pieces_session.draws == draws and not pieces_session.is_idle
    pieces_session.frame(SIZE)
    assert pieces_session.draws == draws + 1 and pieces_session.is_idle


def test_motion_during_full_draw_shows_at_once_then_in_full(pieces_session: Session):
    turned(pieces_session, 40.0)
    for _ in range(3):
        pieces_session.frame(SIZE)
    turned(pieces_session, 70.0)
    pieces_session.frame(SIZE)
    assert pieces_session.is_preview and pieces_session.plan.sketch.camera.azimuth == 70.0
    assert pieces(pieces_session)[-1][-1] == "view.present"
    full = pieces_session.engine.render(pieces_session.sketch, size=SIZE).array
    np.testing.assert_array_equal(pieces_session.picture.frame("", 0.0).array, full)


def test_what_is_read_back_is_whole_at_once(pieces_session: Session):
    turned(pieces_session, 40.0)
    pieces_session.frame(SIZE)
    pieces_session.frame(SIZE)
    array = pieces_session.read().array
    assert not pieces_session.is_preview
    np.testing.assert_array_equal(array, pieces_session.engine.render(pieces_session.sketch, size=SIZE).array)


def test_pieces_grow_so_that_a_picture_ends_that_no_cache_holds(pieces_session: Session, monkeypatch):
    """With no room for textures each piece would begin again for ever."""
    monkeypatch.setattr(shown_picture, "PIECE", 1e-4)
    monkeypatch.setattr(shown_picture, "STEADY", 3)
    monkeypatch.setattr(pieces_session.engine.cache, "limit", 1)
    turned(pieces_session, 40.0)
    pieces_session.frame(SIZE)
    assert pieces(pieces_session)


def test_all_passes_run_where_no_piece_is_asked_for(pieces_session: Session):
    options = pieces_session.engine.options
    options.piece = lambda: True
    with pytest.raises(PassesUnfinished):
        pieces_session.engine.render(pieces_session.sketch.with_values({"height.seed": 99}), size=SIZE)
    options.piece = None
    pieces_session.engine.render(pieces_session.sketch.with_values({"height.seed": 99}), size=SIZE)


# ── framing ───────────────────────────────────────────────────────────────────


EXTENT, RELIEF = (10_240.0, 8_000.0), 1_800.0
NARROW = (950, 720)


def across(camera: Camera, size: tuple[int, int], places: np.ndarray) -> np.ndarray:
    """Return where places of the terrain are in a picture, from -1 at its left side to 1 at its right one."""
    matrix = look(camera, EXTENT, RELIEF, size).clip_from_world.astype(float)
    clip = np.concatenate([places, np.ones((len(places), 1))], axis=1) @ matrix.T
    return clip[:, 0] / clip[:, 3]


@pytest.mark.parametrize("distance", [15_000.0, 40_000.0])
def test_places_keep_their_distance_from_the_sides(distance: float) -> None:
    sketch = load(find("mixed")).with_camera(Camera(azimuth=205.0, elevation=28.0, distance=distance))
    places = np.random.default_rng(3).uniform((0, 0, 0), (*EXTENT, RELIEF), (50, 3))
    seen = framed(sketch, 0.0, DEFAULT_PICTURE, NARROW)
    np.testing.assert_allclose(
        across(seen.camera, NARROW, places), across(sketch.camera, DEFAULT_PICTURE, places), atol=1e-5
    )
    cut = across(sketch.camera, NARROW, places)
    assert np.abs(cut).max() > np.abs(across(seen.camera, NARROW, places)).max()


@pytest.mark.parametrize("size", [DEFAULT_PICTURE, (640, 360), (1920, 800)])
def test_a_wide_picture_is_the_sketch_s_own(size: tuple[int, int]) -> None:
    sketch = load(find("mixed"))
    assert framed(sketch, 0.0, DEFAULT_PICTURE, size) is sketch


def test_a_view_is_never_opened_out_of_shape() -> None:
    assert field_for(35.0, DEFAULT_PICTURE, (40, 720)) == MAX_FIELD_OF_VIEW
    assert field_for(110.0, DEFAULT_PICTURE, (400, 720)) == 110.0, "a wider one of the sketch's own stays"


def test_gesture_moves_camera_as_seen_and_keeps_field_of_view() -> None:
    camera = Camera(distance=15_000.0)
    wide = replace(camera, field_of_view=field_for(camera.field_of_view, DEFAULT_PICTURE, NARROW))
    gesture = Gesture(height=720.0, across=100.0, panning=True)
    target = np.array([[EXTENT[0] / 2, EXTENT[1] / 2, RELIEF / 2]])  # it goes with the mouse
    after = steered_through(camera, look(wide, EXTENT, RELIEF, NARROW), gesture, wide)
    assert after.field_of_view == camera.field_of_view
    seen = replace(after, field_of_view=wide.field_of_view)
    assert across(seen, NARROW, target)[0] * NARROW[0] / 2 == pytest.approx(100.0, rel=1e-3)


@pytest.mark.slow
def test_the_window_opens_a_view_and_a_render_does_not(any_engine: Engine, tmp_path: Path) -> None:
    session = Session(any_engine, find("low_detail"))
    session.frame((48, 48))
    assert session.plan is not None and session.sketch is not None
    assert session.plan.sketch.camera.field_of_view > session.sketch.camera.field_of_view
    session.frame((64, 36))
    assert session.plan.sketch.camera == session.sketch.camera
    session.release()
    any_engine.render(load(find("low_detail")), size=(48, 48))
    assert any_engine.record.plan.sketch.camera.field_of_view == 35.0
