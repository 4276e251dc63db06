"""What the pictures cost, and expensive terrain cached on disk."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import moderngl
import numpy as np
import pytest
from imgui_bundle import imgui, implot

from playground.engine.cache_keys import Keys, StepKey
from playground.engine.disk_cache import listed
from playground.engine.disk_caching import REST as LAND_RESTS
from playground.engine.disk_caching import DiskCaching
from playground.engine.engine import Engine
from playground.engine.execution import FrameRecord
from playground.errors import ContextError
from playground.studio.bench import Workbench
from playground.studio.cost.costs import Record, RunReasons
from playground.studio.cost.panel import draw_readout
from playground.studio.cost.readout import Readout
from playground.studio.graph.graph import Thumbnails
from playground.studio.interface import WindowControls, remembered_preferences
from playground.studio.picture import disk_caching as module
from playground.studio.picture.disk_caching import SessionCaching
from playground.studio.problems.non_finite import REST, FiniteWatch
from playground.studio.session import Session

from ..sketch_texts import map_of, passes
from ..variants import trust
from .panel_desk import Bare, OpenBare

TERRAIN = """// terrain.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high
float kernel(ivec2 texel) { return level; }
"""
MESH = """// mesh.glsl -- two triangles for each of a grid's squares
#pragma draw(mesh = "grid", output = "frame:rgba8")
uniform int grid = 5; //! slider(2, 64) Vertices a side
uniform sampler2D height; //! input
vec4 vertex(vec3 corner) { return vec4(corner.xy, texelFetch(height, ivec2(0), 0).r, 1.0); }
vec4 fragment() { return vec4(1.0); }
"""
SKETCH = """format = 1
size = [33, 17]
[[pass]]
name = "height"
use = "./terrain"
[view]
use = "./mesh"
"""


@pytest.fixture
def bare(tmp_path: Path, open_bare: OpenBare) -> Bare:
    for name, text in {"terrain.glsl": TERRAIN, "mesh.glsl": MESH, "sketch.toml": SKETCH}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    made = open_bare(tmp_path, (1280, 1400))
    return made


def test_a_record_keeps_the_last_numbers_in_order() -> None:
    record = Record(4)
    for n in range(11):
        record.add({"a": n}, n, n)
        for numbers in (record.passes["a"], record.whole, record.texels, record.triangles):
            assert list(numbers) == list(range(max(0, n - 3), n + 1))


def test_a_record_keeps_its_rows_in_step() -> None:
    record = Record(3)
    record.add({"a": 1.0}, 10, 2)
    record.add({"a": 2.0, "b": 5.0}, 20, 0)
    assert list(record.passes["b"]) == [0.0, 5.0]
    assert list(record.whole) == [1.0, 7.0]
    assert record.most_expensive(1) == ["b"]
    for _ in range(3):
        record.add({"b": 1.0}, 0, 0)
    assert list(record.passes) == ["b"]  # what cost nothing for so long is gone
    assert list(record.texels) == [0.0, 0.0, 0.0]


def test_nothing_is_timed_before_it_is_looked_at(bare: Bare) -> None:
    bare.session.drafts.set("height.level", 0.25)
    bare.run_frames(3)
    assert (
        not bare.session.engine.options.profiling
        and not bare.session.times
        and not bare.bench.inspection.record.pictures
    )


def test_each_frame_is_recorded_while_the_costs_are_shown(bare: Bare) -> None:
    engine, record = bare.session.engine, bare.bench.inspection.record
    bare.click("Cost###costs")
    assert engine.options.profiling
    before = record.pictures
    for n in range(5):
        bare.session.drafts.set("height.level", 0.1 * n)
        bare.run_frames()
    bare.run_frames(4)
    assert record.pictures == before + 5  # a frame without a picture is none
    assert record.texels[-1] == 33 * 17 + 48 * 32
    assert record.triangles[-1] == engine.record.triangles == _triangles(engine, 5)
    assert set(record.passes) == {"height", "view"} and record.whole[-1] > 0
    assert np.isclose(record.whole, np.sum(list(record.passes.values()), axis=0)).all()
    assert implot.get_current_context() is not None
    bare.session.drafts.set("view.grid", 9)
    bare.run_frames(2)
    assert record.texels[-1] == 48 * 32  # the terrain was not computed again
    assert record.triangles[-1] == _triangles(engine, 9)
    assert record.passes["height"][-1] == 0
    bare.click("Cost###costs")
    assert not engine.options.profiling and record.pictures == 0 and not bare.session.times


def test_it_is_not_timed_while_the_panel_is_away(bare: Bare) -> None:
    bare.click("Cost###costs")
    assert bare.session.engine.options.profiling
    bare.bench.inspection.begin()  # a frame in which no panel is drawn
    bare.bench.inspection.update()
    assert not bare.session.engine.options.profiling


def test_programs_are_listed_with_what_they_took(bare: Bare) -> None:
    times = bare.session.engine.runner.compile_times
    assert {Path(path).name for path in times} == {"terrain.glsl", "mesh.glsl"} and min(times.values()) > 0
    bare.click("Cost###costs")
    bare.run_frames(2)
    assert any(label.endswith("###compiling") for label in bare.places)


def _triangles(engine: Engine, side: int) -> int:
    """Return what a grid has: its squares, and its skirt's, as its mesh is built."""
    from playground.engine.meshes import build_mesh

    return build_mesh("grid", (("grid", side),)).indices.size // 3


FAST = 'agrees = "exact"\n[[pass]]\nname = "height"\nuse = "./twin"\n[parameters]\nlevel = "height.level"\n'


def test_cost_switch_runs_canonical_form_and_shows_if_one_exists(bare: Bare, tmp_path: Path) -> None:
    bare.click("Cost###costs")
    bare.run_frames(2)
    assert "Plain form" not in bare.places
    (tmp_path / "twin.glsl").write_text(TERRAIN, encoding="utf-8")
    (tmp_path / "terrain.fast.toml").write_text(FAST, encoding="utf-8")
    trust(tmp_path)
    bare.session.drafts.reload()
    bare.run_frames(4)
    for plain in (True, False):
        bare.click("Plain form")
        bare.run_frames(3)
        assert bare.session.drafts.plain == plain and bare.session.plan is not None
        assert (bare.session.plan.step("height") is not None) == plain
        assert (bare.session.plan.step("height.fast.height") is None) == plain


def test_a_row_says_why_its_pass_ran_last(bare: Bare, monkeypatch: pytest.MonkeyPatch) -> None:
    reasons = bare.bench.inspection.reasons
    bare.session.drafts.set("height.level", 0.25)
    bare.run_frames(2)
    assert reasons.text("height") == "Last ran because of: value level"
    bare.click("Cost###costs")
    bare.session.drafts.set("height.level", 0.75)
    bare.run_frames(2)
    assert reasons.text("height") == "Last ran because of: value level"
    assert reasons.text("view") == "Last ran because of: input height"
    bare.session.drafts.set("view.grid", 9)
    bare.run_frames(2)
    assert reasons.text("height") == "Last ran because of: value level"  # it did not run for the last picture
    assert reasons.text("view") == "Last ran because of: value grid"
    tooltips: list[str] = []
    monkeypatch.setattr(imgui, "set_item_tooltip", tooltips.append)
    bare.run_frames()
    assert {"Last ran because of: value level", "Last ran because of: value grid"} <= set(tooltips)
    monkeypatch.setattr(imgui, "set_tooltip", tooltips.append)
    bare.point("View###pass")
    assert any("\nLast ran because of: value grid\n" in text for text in tooltips)


def test_of_what_is_inside_a_technique_each_has_a_line() -> None:
    inner = {f"light.{n}": StepKey("", "", "", "", (("value", n),)) for n in "abcdefgh"}
    reasons = RunReasons()
    reasons.add(FrameRecord(keys=Keys(inner), ran=[*inner, *inner]))
    assert reasons.text("light.b") == "Last ran because of: the pass"
    assert reasons.text("light").split("\n") == [
        *(f"{n} last ran because of: the pass" for n in "abcdef"),
        "and 2 more",
    ]
    assert reasons.text("lig") == ""
    reasons.add(FrameRecord(keys=Keys({"view": inner["light.a"]}), ran=["view"]))
    assert reasons.text("light") == ""  # it is in the sketch no more


# ── disk caching ──────────────────────────────────────────────────────────────


HEIGHT = """// height.glsl -- cheap
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(-1, 1) How high
float kernel(ivec2 texel) { return sqrt(level) * float(texel.x + texel.y) / 66.0; }
"""
RAISED = """// raised.glsl -- what swallows a NaN
#pragma kernel(output = "height:r32f")
uniform sampler2D low; //! input
float kernel(ivec2 texel) { float h = texelFetch(low, texel, 0).r; return h >= 0.0 ? h : 0.25; }
"""
CACHED_SKETCH = (
    "format = 1\nsize = 33\n"
    + passes(low="./height", height=("./raised", 'inputs = { low = "low:height" }'))
    + map_of("height", channel="red")
)


class Harness:
    """Sessions on one sketch, one after another, and a clock that the test moves."""

    def __init__(self, ctx: moderngl.Context, folder: Path) -> None:
        self.ctx = ctx
        self.folder = folder
        self.time = 100.0
        self.session: Session | None = None

    def open(self) -> None:
        """Begin a new session, as after a start."""
        self.close()
        engine = Engine(self.ctx)
        self.session = Session(engine, self.folder, now=lambda: self.time)
        window = WindowControls(lambda: None)
        self.bench = Workbench(self.session, window, folder=self.folder, now=lambda: self.time)
        self.watch = FiniteWatch(lambda: self.time)
        self.storing = SessionCaching(self.session, 2**26)

    def run_frames(self, seconds: float = 0.0) -> None:
        self.time += seconds
        self.session.frame((40, 30))
        self.watch.update(self.session, held=False)
        self.storing.update(self.bench.inspection, self.watch)

    def rest(self) -> None:
        """Let things rest until nothing is left to do."""
        self.run_frames()
        self.run_frames(2 * REST)
        for _ in range(20):
            self.run_frames(LAND_RESTS)

    def close(self) -> None:
        """End the session."""
        if self.session is not None:
            self.storing.close()
            self.session.release()
            self.session.engine.release()

    @property
    def runs(self) -> dict[str, int]:
        return dict(self.session.engine.runs)


@pytest.fixture
def harness(ctx: moderngl.Context, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Harness]:
    folder = tmp_path / "sketch"
    folder.mkdir()
    for name, text in (("height.glsl", HEIGHT), ("raised.glsl", RAISED), ("sketch.toml", CACHED_SKETCH)):
        (folder / name).write_text(text, encoding="utf-8")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr("playground.engine.disk_cache.cache_directory", lambda: tmp_path / "land")
    made = Harness(ctx, folder)

    def caching(store: object) -> DiskCaching:  # all terrain is worth it, by the test's clock
        return DiskCaching(store, floor=float("-inf"), now=lambda: made.time)  # type: ignore[arg-type]

    monkeypatch.setattr(module, "DiskCaching", caching)
    made.open()
    yield made
    made.close()


def cached(tmp_path: Path) -> set[str]:
    return {each.textures.made_for for each in listed(tmp_path / "land") if each.textures}


def test_a_session_reopens_without_running_the_terrain(harness: Harness, tmp_path: Path) -> None:
    harness.run_frames()
    seen = harness.session.read()
    assert seen is not None and not cached(tmp_path)
    harness.rest()
    assert harness.storing.patience is None, "nothing more is waited for"
    harness.open()
    assert cached(tmp_path) == {"sketch: height"}
    harness.run_frames()
    again = harness.session.read()
    assert again is not None and again.array.tobytes() == seen.array.tobytes()
    assert harness.runs == {"view": 1}


def test_it_waits_for_the_picture_to_rest_and_says_for_how_long(harness: Harness, tmp_path: Path) -> None:
    harness.run_frames()
    assert harness.storing.patience is None, "numbers that are not finite are looked for first"
    harness.run_frames(2 * REST)
    for _ in range(5):
        harness.run_frames()
    assert harness.watch.patience is None
    assert harness.storing.patience == pytest.approx(LAND_RESTS - 2 * REST)
    harness.run_frames(LAND_RESTS)
    assert harness.storing.patience == 0.0
    harness.rest()
    harness.close()
    assert cached(tmp_path) == {"sketch: height"}


def test_non_finite_terrain_is_not_cached(harness: Harness, tmp_path: Path) -> None:
    """The next session must name the pass that made it, and so must run it."""
    harness.run_frames()
    harness.session.drafts.set("low.level", -0.5)
    harness.rest()
    assert [result.path for result in harness.watch.non_finite] == ["low"]
    assert harness.storing.patience is None
    harness.storing.close()
    assert cached(tmp_path) == set()
    harness.session.drafts.set("low.level", 0.75)
    harness.rest()
    harness.open()
    assert cached(tmp_path) == {"sketch: height"}


@pytest.mark.parametrize("tool", ["graph", "inspector"])
def test_who_looks_at_every_pass_sees_every_pass(harness: Harness, tool: str) -> None:
    harness.rest()
    harness.open()
    harness.run_frames()
    engine = harness.session.engine
    assert "low" not in engine.record.results
    inspection = harness.bench.inspection
    inspection.graph.touched, inspection.inspector.on = tool == "graph", tool == "inspector"
    harness.run_frames()
    harness.run_frames()
    assert set(engine.record.results) == {"low", "height", "view"}
    assert harness.runs["low"] == 1 and harness.runs.get("height", 0) == 0
    draws = harness.session.draws
    for _ in range(5):
        harness.run_frames()
    assert harness.session.draws == draws, "it was requested once"


def test_passes_that_fail_are_requested_once(harness: Harness, monkeypatch: pytest.MonkeyPatch) -> None:
    harness.rest()
    harness.open()
    harness.run_frames()
    tries = []

    def fails(*_: object, **__: object) -> None:
        tries.append(1)
        raise ContextError("no")

    monkeypatch.setattr(harness.session.engine, "draw", fails)
    harness.bench.inspection.graph.touched = True
    for _ in range(5):
        harness.run_frames()
    assert len(tries) == 1


def test_an_edited_kernel_is_another_terrain(harness: Harness) -> None:
    harness.rest()
    (harness.folder / "height.glsl").write_text(HEIGHT.replace("66.0", "67.0"), encoding="utf-8")
    harness.open()
    harness.run_frames()
    assert harness.runs == {"low": 1, "height": 1, "view": 1}


def test_a_folder_that_cannot_be_written_is_reported_once(harness: Harness, tmp_path: Path) -> None:
    (tmp_path / "land").write_text("a file")
    harness.rest()
    harness.storing.close()
    harness.run_frames()
    harness.run_frames()
    notes = [note for note in harness.session.notes if note.startswith("terrain cannot be cached on disk")]
    assert len(notes) == 1


def test_without_a_limit_there_is_no_store(harness: Harness, tmp_path: Path) -> None:
    harness.session.engine.disk_caching = None
    harness.storing = SessionCaching(harness.session, 0)
    harness.rest()
    harness.close()
    harness.session = None
    assert not (tmp_path / "land").exists()


def test_cached_terrain_is_identified_by_itself_not_its_texture(harness: Harness) -> None:
    """What is read does not run, and its texture may be one that held another terrain before."""
    harness.run_frames()
    session = harness.session
    engine, name = session.engine, "height:height"
    thumbnails = Thumbnails(session)
    thumbnails.refresh([name], now=0.0)
    assert thumbnails.is_current(name)
    pool, outputs = engine.runner.pool, engine.record.results["height"].outputs
    first = pool.take((5, 3), outputs)
    engine.record.results = {**engine.record.results, "height": first}
    thumbnails.refresh([name], now=1.0)
    assert thumbnails.is_current(name)
    pool.give(first)
    again = pool.take((5, 3), outputs)
    assert again.textures["height"] is first.textures["height"]
    engine.record.results = {**engine.record.results, "height": again}
    assert not thumbnails.is_current(name)
    thumbnails.release()
    again.release()


# ── the corner ───────────────────────────────────────────────────────────────


def test_the_corner_counts_the_pictures_of_the_last_second(bare: Bare) -> None:
    now = 0.0
    session = bare.session
    readout = Readout(session, lambda: now)
    assert "fps" not in readout.text()
    for number in range(8):
        now = number / 10
        session.view.revision += 1
        session.frame((48, 32))
        readout.take(0.002)
    readout.take(0.5)
    assert (readout.frames, readout.waits) == (8, True)
    assert readout.text().startswith("8 fps") and "48 × 32" in readout.text()
    measured = sum(session.engine.record.times.values()) if session.engine.info.software else 0.0
    assert readout.milliseconds == pytest.approx(measured or 2.0)
    now = 1.65
    readout.take(0.002)
    assert readout.frames == 1
    now = 3.0
    readout.take(0.002)
    assert (readout.frames, readout.waits) == (0, False)
    assert "at rest" in readout.text()


def test_the_corner_opens_the_costs_and_its_key_hides_it(bare: Bare, tmp_path: Path) -> None:
    readout = Readout(bare.session, lambda: bare.time)
    preferences = bare.bench.interface.preferences
    preferences.file = tmp_path / "interface.json"
    draw = bare.draw

    def draw_with_corner() -> None:
        draw()
        bench = bare.bench
        draw_readout(readout, bench.interface, bench.inspection, bare.theme, (330.0, 0.0, 950.0, 720.0))

    bare.draw = draw_with_corner  # type: ignore[method-assign]
    bare.bench.interface.panel_shown = False
    bare.click("readout")
    bare.run_frames(3)
    assert bare.bench.inspection.costs_shown and bare.bench.interface.panel_shown
    assert "readout" in bare.places
    bare.key(imgui.Key.f4)
    bare.places.clear()
    bare.run_frames(2)
    assert "readout" not in bare.places
    assert not remembered_preferences(tmp_path).shows_readout
