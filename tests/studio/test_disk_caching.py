"""Expensive terrain that a session caches on disk for the next: at rest, and only if it is sound."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import moderngl
import pytest

from playground.engine.disk_cache import listed
from playground.engine.disk_caching import REST as LAND_RESTS
from playground.engine.disk_caching import DiskCaching
from playground.engine.engine import Engine
from playground.errors import ContextError
from playground.studio.bench import Workbench
from playground.studio.graph.graph import Thumbnails
from playground.studio.interface import WindowControls
from playground.studio.picture import disk_caching as module
from playground.studio.picture.disk_caching import SessionCaching
from playground.studio.problems.non_finite import REST, FiniteWatch
from playground.studio.session import Session

from ..sketch_texts import map_of, passes

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
SKETCH = (
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
        assert self.session is not None
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
        assert self.session is not None
        return dict(self.session.engine.runs)


@pytest.fixture
def harness(ctx: moderngl.Context, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Harness]:
    folder = tmp_path / "sketch"
    folder.mkdir()
    for name, text in (("height.glsl", HEIGHT), ("raised.glsl", RAISED), ("sketch.toml", SKETCH)):
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
    assert harness.session is not None
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
    assert harness.session is not None
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
    assert harness.session is not None
    engine = harness.session.engine
    assert "low" not in engine.record.results
    getattr(harness.bench.inspection, tool).on = True
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
    assert harness.session is not None
    tries = []

    def fails(*_: object, **__: object) -> None:
        tries.append(1)
        raise ContextError("no")

    monkeypatch.setattr(harness.session.engine, "draw", fails)
    harness.bench.inspection.graph.on = True
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
    assert harness.session is not None
    harness.storing.close()
    harness.run_frames()
    harness.run_frames()
    notes = [note for note in harness.session.notes if note.startswith("terrain cannot be cached on disk")]
    assert len(notes) == 1


def test_without_a_limit_there_is_no_store(harness: Harness, tmp_path: Path) -> None:
    assert harness.session is not None
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
    assert session is not None
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
