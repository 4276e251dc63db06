"""What is over the picture: dividers, names of its parts, the dragged sun, work that is behind."""

from __future__ import annotations

import threading
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest

from playground.engine import sources
from playground.engine.engine import Engine
from playground.engine.process.worker import Cancelled
from playground.engine.sandbox import SandboxReport
from playground.engine.source_kinds import SourceKind
from playground.engine.unfinished import Unfinished
from playground.paths import GLSL
from playground.sketch.find import find
from playground.sketch.model import Sketch
from playground.sketch.replace_technique import with_technique
from playground.studio.overlay import behind_text
from playground.studio.paint.brush import Brush
from playground.studio.paint.painting import Painting
from playground.studio.picture import shown_picture
from playground.studio.picture.gestures import (
    GRAB_DISTANCE,
    divider_at,
    divider_position,
    dividers_of,
    suns_of,
    turned_sun,
)
from playground.studio.picture.panel import PictureRegion, parts_of
from playground.studio.session import Session

from ..loading import load
from ..sketch_texts import map_of, passes
from .session_desk import FakeSandbox, OpenSession

METHODS = GLSL / "sketches" / "lighting_methods.toml"  # three pictures, two lines


def test_the_lines_are_those_of_the_view() -> None:
    dividers = dividers_of(load(METHODS))
    assert dividers == {"view.first": pytest.approx(0.3333), "view.second": pytest.approx(0.6667)}
    moved_one = load(METHODS).with_values({"view.second": 0.9})
    assert dividers_of(moved_one)["view.second"] == pytest.approx(0.9)


@pytest.mark.parametrize(
    ("across", "path"),
    [
        (333.3, "view.first"),
        (333.3 - GRAB_DISTANCE + 0.1, "view.first"),
        (666.7 + GRAB_DISTANCE - 0.1, "view.second"),
        (333.3 + GRAB_DISTANCE + 0.2, ""),
        (0.0, ""),
    ],
)
def test_the_nearest_within_grab_distance_is_taken(across: float, path: str) -> None:
    assert divider_at(load(METHODS), across, 1000.0) == path


def test_a_sketch_without_any_has_none() -> None:
    assert divider_at(load(GLSL / "sketches" / "jacksboro.toml"), 0.0, 1000.0) == ""


def test_a_line_stays_in_the_picture() -> None:
    assert [divider_position(x, 200.0) for x in (-20.0, 0.0, 50.0, 400.0)] == [0.0, 0.0, 0.25, 1.0]


def test_its_value_is_a_share(tmp_path: Path) -> None:
    kernel = tmp_path / "parted.glsl"
    kernel.write_text(
        '#pragma kernel(output = "frame:rgba8")\n'
        "uniform float line = 0.5;  //! divider Where it is\n"
        "vec4 kernel(ivec2 texel) { return vec4(line); }\n"
    )
    sketch = load(kernel)
    [path] = dividers_of(sketch)
    assert dividers_of(sketch.with_values({path: 0.25})) == {path: 0.25}
    with pytest.raises(Exception, match="outside its range 0 to 1"):
        sketch.with_values({path: 1.5})


# ── part labels ───────────────────────────────────────────────────────────────


def sketch_of(name: str) -> Sketch:
    return load(find(name))


def test_three_methods_of_light_are_named_between_their_lines() -> None:
    sketch = sketch_of("lighting_methods")
    parts = parts_of(sketch)
    assert [part.name for part in parts] == ["Difference", "Product", "Ray"]
    titles = [sketch.graph.find(name).technique.title for name in ("difference", "product", "ray")]  # type: ignore[union-attr]
    assert [part.method for part in parts] == titles
    assert (parts[0].start, parts[-1].end) == (0.0, 1.0)
    assert parts[0].end == parts[1].start == pytest.approx(0.3333)
    assert parts[1].end == parts[2].start == pytest.approx(0.6667)


def test_equally_filtered_parts_are_named_by_filter_input() -> None:
    parts = parts_of(sketch_of("lighting_ray_cone"))
    assert [part.name for part in parts] == ["Ray filtered", "Cone filtered"]
    assert [part.method for part in parts] == ["Ray cast", "Soft shadows by a cone"]


def test_what_both_parts_share_is_not_named() -> None:
    names = [(part.name, part.method) for part in parts_of(sketch_of("variants"))]
    assert names == [
        ("By height", "Grass, rock and snow by height"),
        ("Splatted", "Texture splatting, four layers baked"),
    ]


def test_lines_that_cross_leave_nothing_between_them() -> None:
    sketch = sketch_of("lighting_methods").with_values({"view.first": 0.8, "view.second": 0.2})
    assert [(p.start, p.end) for p in parts_of(sketch)] == [(0.0, 0.8), (0.8, 0.8), (0.8, 1.0)]


def test_a_difference_is_one_picture_of_both() -> None:
    sketch = sketch_of("interreflection").with_values({"view.mode": "difference"})
    assert parts_of(sketch) == [PictureRegion(0.0, 1.0, "Cone against Thrown", "")]


def test_another_technique_in_a_pass_is_named_at_once() -> None:
    sketch = with_technique(sketch_of("interreflection"), "cone", "lighting/soft_cylinder")
    assert parts_of(sketch)[0].method == "Soft shadows by a cylinder"


@pytest.mark.parametrize("name", ["mixed", "profile", "lighting_hill", "night"])
def test_other_pictures_have_no_parts(name: str) -> None:
    assert parts_of(sketch_of(name)) == []


# ── sun drag ──────────────────────────────────────────────────────────────────


SKETCH = "format = 1\nsize = 17\n" + passes(
    height="generation/layered_noise",
    light=("lighting/l_dot_n", "set = { sun = { azimuth = 350.0, elevation = 20.0 } }"),
    second=("lighting/l_dot_n", "set = { sun = { azimuth = 90.0, elevation = 85.0 } }"),
)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    file = tmp_path / "sketch.toml"
    file.write_text(SKETCH)
    return file


def test_the_suns_are_those_of_the_passes(path: Path) -> None:
    assert suns_of(load(path)) == {"light.sun": (350.0, 20.0), "second.sun": (90.0, 85.0)}


def test_full_height_drag_turns_sun_half_around_and_quarter_up() -> None:
    assert turned_sun((10.0, 20.0), 1.0, 0.0) == (190.0, 20.0)
    assert turned_sun((350.0, 20.0), 0.25, 0.5) == (35.0, 65.0)


def test_the_sun_stops_overhead_and_a_little_below_the_horizon() -> None:
    assert turned_sun((10.0, 80.0), 0.0, 1.0) == (10.0, 90.0)
    assert turned_sun((10.0, 5.0), 0.0, -1.0) == (10.0, -10.0)


def test_a_drag_turns_every_sun_and_runs_the_light_alone(
    path: Path, any_engine: Engine, open_session: OpenSession
) -> None:
    session = open_session(path)
    session.frame((64, 48))
    session.drafts.move_suns(0.1, 0.1)
    session.frame((64, 48))
    assert session.sketch is not None
    assert suns_of(session.sketch) == {"light.sun": (8.0, 29.0), "second.sun": (108.0, 90.0)}
    assert not [path for path in any_engine.record.ran if path.startswith("height")]
    assert session.shown is not None and session.shown.edits.has("light.sun")


# ── source at work ────────────────────────────────────────────────────────────


SOURCE = """#pragma source("slow", output = "height:r32f")
uniform sampler2D given;   //! input("black")
uniform float gain = 0.5;  //! slider(0, 1)
"""
SIZE = (16, 16)


@pytest.fixture
def cancelled():
    return threading.Event()


@pytest.fixture
def gate(monkeypatch, cancelled):
    opened = threading.Event()
    opened.set()

    def work(values, size, material):
        for done in range(50):
            material.report(done, 100)
        try:
            while not opened.wait(0.002):
                material.report(50, 100)
        except Cancelled:
            cancelled.set()
            raise
        return {"height": np.full(size[::-1], values["gain"], np.float32)}

    kind = SourceKind("the slow", ("gain",), inputs=("given",), work=work)
    monkeypatch.setitem(sources.SOURCES, "slow", kind)
    yield opened
    opened.set()


@pytest.fixture
def session(tmp_path: Path, open_session: OpenSession, gate):
    (tmp_path / "slow.glsl").write_text(SOURCE, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(
        "format = 1\nsize = 9\n" + passes(height="./slow") + map_of("height", "red"), encoding="utf-8"
    )
    made = open_session(tmp_path / "sketch.toml")
    drawn(made)
    return made


def drawn(session: Session) -> np.ndarray:
    for _ in range(500):
        session.frame(SIZE)
        if session.catch_up.behind is None:
            frame = session.read()
            assert frame is not None and session.error is None
            return frame.array
    raise AssertionError("it never ends")


def test_the_last_picture_stays_until_the_source_has_ended(session, gate):
    before, draws = drawn(session), session.draws
    gate.clear()
    session.drafts.set("height.gain", 0.9)
    for _ in range(3):
        assert session.frame(SIZE) is not None
    assert session.catch_up.behind == (50, 100) and session.catch_up.source == "height"
    assert session.draws == draws and not session.is_idle and session.error is None
    assert behind_text(50, 100, "height") == "making height … 50 %"
    session.clock.playing, at = True, session.clock.time
    session.advance(0.5, datetime(2026, 1, 1))
    assert session.clock.time == at, "the clock waits"
    gate.set()
    after = drawn(session)
    assert session.catch_up.source == "" and not np.array_equal(before, after)
    np.testing.assert_array_equal(after[0, 0, :3], after[-1, -1, :3])


def test_a_value_set_back_shows_at_once_and_stops_the_work(session, gate, cancelled):
    before = drawn(session)
    gate.clear()
    session.drafts.set("height.gain", 0.9)
    session.frame(SIZE)
    assert session.catch_up.behind is not None
    session.drafts.set("height.gain", 0.5)
    session.frame(SIZE)
    assert session.catch_up.behind is None
    np.testing.assert_array_equal(drawn(session), before)
    assert cancelled.wait(5.0)


def test_first_picture_reading_file_draws_once_source_ends(session, open_session, gate, tmp_path):
    """What the sandbox has read is not new any more, though nothing was drawn with it yet."""
    np.save(tmp_path / "hills.npy", np.eye(9, dtype=np.float32))
    file = ("generation/heightmap", 'set = { elevation = "hills.npy" }')
    text = passes(hills=file, height=("./slow", 'inputs = { given = "hills" }')) + map_of("height", "red")
    (tmp_path / "other.toml").write_text("format = 1\nsize = 9\n" + text, encoding="utf-8")
    gate.clear()
    made = open_session(tmp_path / "other.toml", sandbox=FakeSandbox())
    FakeSandbox.latest.answer = SandboxReport(True)
    for _ in range(5):
        made.frame(SIZE)
    assert made.catch_up.source == "height" and made.draws == 0
    gate.set()
    drawn(made)
    assert made.draws == 1 and made.plan is not None


# ── what waits for nothing ───────────────────────────────────────────────────

SCULPTED = (
    """format = 1
size = 33
extent = [2000.0, 2000.0]
relief = 200.0
"""
    + passes(low="./slow", height="generation/sculpted", light="lighting/l_dot_n").replace(
        'use = "generation/sculpted"', 'use = "generation/sculpted"\ninputs = { height = "low" }'
    )
    + """[view]
use = "view/terrain"
samples = 1
camera = { azimuth = 180, elevation = 60, distance = 3000 }
"""
)


class Opening:
    """A gate that opens by itself after some seconds, so that who waits for it fails and does not hang."""

    def __init__(self, gate: threading.Event) -> None:
        self.waited = False
        self._timer = threading.Timer(3.0, self._open, [gate])
        self._timer.start()

    def _open(self, gate: threading.Event) -> None:
        self.waited = True
        gate.set()

    def close(self) -> None:
        self._timer.cancel()


@pytest.fixture
def closed(gate):
    gate.clear()
    opening = Opening(gate)
    yield opening
    opening.close()


def test_values_are_not_waited_for(session, gate, closed):
    session.drafts.set("height.gain", 0.9)
    session.frame(SIZE)
    assert session.read_values("height") is None and not closed.waited
    assert session.notes[-1] == "height is being made, 50 of 100: try again when it is there"
    session.show("height")
    assert not closed.waited and session.view.map is not None, "it is shown when it is there"
    gate.set()
    drawn(session)
    assert session.read_values("height").max() == np.float32(0.9)


@pytest.mark.parametrize("hovers", [True, False])
def test_a_brush_that_is_pressed_waits_for_no_source(open_session, gate, closed, tmp_path, hovers):
    (tmp_path / "slow.glsl").write_text(SOURCE, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SCULPTED, encoding="utf-8")
    gate.set()
    made = open_session(tmp_path / "sketch.toml")
    drawn(made)
    painting = Painting(made, tmp_path)
    painting.toggle()
    painting.brush = Brush(tool="flatten", radius=150.0)
    if hovers:
        assert painting.ground((0.5, 0.5)) is not None
    gate.clear()
    made.drafts.set("low.gain", 0.9)
    made.frame(SIZE)
    assert made.catch_up.source == "low"
    made.notes.clear()
    painting.press((0.5, 0.5))
    painting.move((0.5, 0.52))
    painting.release()
    assert not closed.waited and painting.layer is None, "nothing is painted on ground that is not there"
    assert made.notes and all("low is being made" in note for note in made.notes)
    gate.set()
    drawn(made)
    painting.press((0.5, 0.5))
    painting.release()
    assert painting.layer is not None


# ── catch up ──────────────────────────────────────────────────────────────────


COUNT = """#pragma kernel(output = "count:r32f")
uniform sampler2D before;  //! input("zero")
float kernel(ivec2 texel) { return texelFetch(before, texel, 0).r + 1.0 / 256.0; }
"""
BEHIND_SKETCH = (
    "format = 1\nsize = 9\n"
    + passes(count=("./count", 'repeat = "frames"', 'feedback = { before = "count" }'))
    + map_of("count", "red")
)


@pytest.fixture
def behind_session(tmp_path: Path, open_session: OpenSession):
    (tmp_path / "count.glsl").write_text(COUNT, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(BEHIND_SKETCH, encoding="utf-8")
    made = open_session(tmp_path / "sketch.toml")
    made.clock.playing = False
    made.frame(SIZE)
    assert made.error is None
    return made


@pytest.fixture
def slow(behind_session, monkeypatch):
    """Let each look at the clock find that time is over."""
    monkeypatch.setattr(shown_picture, "LOOP_PIECE", -1.0)
    return behind_session


def test_time_jump_shows_progress_and_ends_at_same_picture(slow):
    engine = slow.engine
    slow.clock.time, before = 1.0, engine.runs["count"]
    done = []
    while True:
        slow.frame(SIZE)
        if slow.catch_up.behind is None:
            break
        done.append(slow.catch_up.behind)
        assert not slow.is_idle
        assert len(done) < 100
    assert done == [(number, 61) for number in range(5, 61, 4)], "each piece goes on from the last"
    assert engine.runs["count"] - before <= 60 + 2 * len(done), "a picture on the way is one frame at most"
    assert slow.clock.time == 1.0
    array = slow.read().array
    with Engine(engine.ctx) as cold:
        np.testing.assert_array_equal(array, cold.render(slow.sketch, size=SIZE, time=1.0).array)


def test_the_clock_waits_while_the_picture_is_behind(slow):
    slow.clock.playing, slow.clock.time = True, 1.0
    slow.frame(SIZE)
    assert slow.catch_up.behind == (5, 61)
    slow.advance(0.5, datetime(2026, 1, 1))
    assert slow.clock.time == 1.0
    while slow.catch_up.behind is not None:
        slow.frame(SIZE)
    slow.advance(0.5, datetime(2026, 1, 1))
    assert slow.clock.time == 1.5


def test_a_picture_that_is_read_is_that_of_its_time(slow):
    slow.clock.time = 1.0
    slow.frame(SIZE)
    result = slow.read()
    assert slow.catch_up.behind is None
    assert result.array[0, 0, 0] > 0
    np.testing.assert_array_equal(result.array, slow.engine.render(slow.sketch, size=SIZE, time=1.0).array)


def test_a_save_at_a_late_time_shows_how_far_it_came_as_well(slow):
    slow.clock.time = 1.0
    path = slow.path.parent / "count.glsl"
    path.write_text(COUNT.replace("256.0", "128.0"), encoding="utf-8")
    slow.drafts.reload()
    slow.frame(SIZE)
    assert slow.catch_up.behind == (8, 61), "a piece to see that it draws, and one to show"
    while slow.catch_up.behind is not None:
        slow.frame(SIZE)
    assert slow.engine.runs["count"] <= 1 + 61 + 2 * 15


def test_a_short_run_is_not_parted(behind_session, monkeypatch):
    monkeypatch.setattr(shown_picture, "LOOP_PIECE", 3600.0)  # shorter than that on a busy machine too
    behind_session.clock.time = 1.0
    behind_session.frame(SIZE)
    assert behind_session.catch_up.behind is None


def test_an_engine_without_patience_runs_to_the_end(any_engine, behind_session):
    any_engine.options.patience = -1.0
    with pytest.raises(Unfinished) as stopped:
        any_engine.draw(behind_session.sketch, size=SIZE, time=2.0)
    assert stopped.value.total == 121
    any_engine.options.patience = None
    assert any_engine.draw(behind_session.sketch, size=SIZE, time=2.0) is not None


def test_what_the_window_says():
    assert behind_text(1200, 36000) == "computing frame 1,200 of 36,000 …"
