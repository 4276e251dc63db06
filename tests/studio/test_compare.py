"""A and B: A stays what it was, is swapped, painted as it is, and there again in the next session."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import moderngl
import numpy as np
import pytest
from imgui_bundle import imgui
from numpy.typing import NDArray

from playground.data.image_files import write_png
from playground.engine.engine import Engine
from playground.engine.sandbox import SandboxReport
from playground.engine.textures import make_framebuffer, make_texture, read_picture, write_texture
from playground.errors import SandboxTimeout
from playground.sketch.assign import values_of
from playground.sketch.model import DEFAULT_PICTURE
from playground.studio.compare.compare import PERIOD, Compare, Mode
from playground.studio.compare.panel import drag_line, shows_first
from playground.studio.edits.autosave import Autosave
from playground.studio.edits.edits import Edits
from playground.studio.edits.memory import Compared, Memory, Remembered
from playground.studio.inspect.inspection import Inspection
from playground.studio.inspect.inspector import Inspector
from playground.studio.picture.full_screen import Blend
from playground.studio.picture.preview import as_preview
from playground.studio.picture.view import framed
from playground.studio.session import Session

from ..loading import load
from ..sketch_texts import passes
from .panel_desk import OpenBare
from .session_desk import FakeSandbox, OpenSession

TERRAIN = """// terrain.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high
uniform sampler2D mask; //! file("mask.png")
float kernel(ivec2 texel) {
    float found = 0.0;
    for (int n = 0; n < 3; ++n) found += sin(float(texel.x * (n + 1)) * 0.4) * cos(float(texel.y) * 0.3);
    return level * (0.5 + 0.15 * found) * texelFetch(mask, ivec2(0), 0).r;
}
"""
SKETCH = """format = 1
size = [33, 33]
extent = [1000.0, 1000.0]
relief = 300.0
[[pass]]
name = "height"
use = "./terrain"
[view]
use = "view/terrain"
"""
SIZE = 60, 40


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    write_png(tmp_path / "mask.png", np.full((2, 2, 4), 255, np.uint8))
    return tmp_path


@pytest.fixture
def session(folder: Path, open_session: OpenSession) -> Session:
    made = open_session(folder, now=lambda: 0.0)
    return made


@pytest.fixture
def compare(session: Session) -> Iterator[Compare]:
    made = Compare(session)
    yield made
    made.release()


def draw_frame(session: Session, compare: Compare) -> NDArray[np.uint8]:
    picture = session.frame(SIZE)
    assert picture is not None and session.error is None
    compare.follow(picture)
    return read_picture(picture)


def first(compare: Compare) -> NDArray[np.uint8]:
    return read_picture(compare.picture)


def drawn(engine: Engine, session: Session, level: float) -> NDArray[np.uint8]:
    """Return the picture of the files with a level, seen as the session sees it, drawn for itself."""
    sketch = load(session.path).with_values({"height.level": level}).with_camera(session.plan.sketch.camera)
    return engine.render(as_preview(sketch) if session.is_preview else sketch, size=SIZE).array


def test_a_stays_while_b_changes(session: Session, compare: Compare) -> None:
    before = draw_frame(session, compare)
    assert compare.picture is None
    compare.keep()
    draw_frame(session, compare)
    np.testing.assert_array_equal(first(compare), before)
    session.drafts.set("height.level", 0.9)
    after = draw_frame(session, compare)
    assert (after != before).any() and compare.draws == 0
    np.testing.assert_array_equal(first(compare), before)
    compare.end()
    draw_frame(session, compare)
    assert compare.picture is None and not compare.on


def test_a_follows_the_camera_and_the_size(session: Session, compare: Compare, any_engine: Engine) -> None:
    draw_frame(session, compare)
    compare.keep()
    draw_frame(session, compare)
    session.drafts.set("height.level", 0.9)
    session.drafts.set_camera(replace(session.sketch.camera, azimuth=77.0))
    second = draw_frame(session, compare)
    assert compare.draws == 1 and (first(compare) != second).any()
    np.testing.assert_array_equal(first(compare), drawn(any_engine, session, 0.5))
    draw_frame(session, compare)
    assert compare.draws == 1  # a frame in which nothing moved draws nothing
    picture = session.frame((31, 47))
    assert picture is not None
    compare.follow(picture)
    assert first(compare).shape[:2] == (47, 31)


def test_a_keeps_its_texts_when_the_files_change(
    session: Session, compare: Compare, folder: Path, any_engine: Engine
) -> None:
    draw_frame(session, compare)
    compare.keep()
    draw_frame(session, compare)
    session.drafts.set_camera(replace(session.sketch.camera, azimuth=200.0))
    draw_frame(session, compare)
    old = drawn(any_engine, session, 0.5)
    session.drafts.set_camera(None)
    (folder / "terrain.glsl").write_text(TERRAIN.replace("0.15", "-0.3"), encoding="utf-8")
    session.drafts.reload()
    draw_frame(session, compare)
    session.drafts.set_camera(replace(session.sketch.camera, azimuth=200.0))
    second = draw_frame(session, compare)
    np.testing.assert_array_equal(first(compare), old)
    assert (second != old).any()


def test_an_image_of_another_content_alone_is_another(
    session: Session, compare: Compare, folder: Path
) -> None:
    before, file = draw_frame(session, compare), folder / "mask.png"
    compare.keep()
    draw_frame(session, compare)
    stat = file.stat()
    write_png(file, np.full((2, 2, 4), 254, np.uint8))
    os.utime(file, ns=(stat.st_atime_ns, stat.st_mtime_ns))
    assert file.stat().st_size == stat.st_size
    session.drafts.set_camera(replace(session.sketch.camera, azimuth=10.0))
    draw_frame(session, compare)
    np.testing.assert_array_equal(first(compare), before)
    assert any("mask.png is another file now" in note for note in session.notes)


def test_changed_image_leaves_kept_comparison_unchanged(
    session: Session, compare: Compare, folder: Path
) -> None:
    before = draw_frame(session, compare)
    compare.keep()
    draw_frame(session, compare)
    write_png(folder / "mask.png", np.full((3, 3, 4), 100, np.uint8))
    session.redraw()
    draw_frame(session, compare)
    session.drafts.set_camera(replace(session.sketch.camera, azimuth=10.0))
    draw_frame(session, compare)
    session.drafts.set_camera(replace(session.sketch.camera, azimuth=20.0))
    draw_frame(session, compare)
    np.testing.assert_array_equal(first(compare), before)
    assert [note for note in session.notes if "mask.png" in note] == [
        "A stays as it was drawn last: mask.png is another file now"
    ]


def test_swap_and_back(session: Session, compare: Compare) -> None:
    frame = draw_frame(session, compare)
    compare.keep()
    draw_frame(session, compare)
    session.drafts.set("height.level", 0.9)
    two = draw_frame(session, compare)
    compare.swap()
    np.testing.assert_array_equal(draw_frame(session, compare), frame)
    np.testing.assert_array_equal(first(compare), two)
    compare.swap()
    np.testing.assert_array_equal(draw_frame(session, compare), two)
    np.testing.assert_array_equal(first(compare), frame)
    compare.back()
    np.testing.assert_array_equal(draw_frame(session, compare), frame)
    np.testing.assert_array_equal(first(compare), frame)
    assert compare.on and not session.notes


def test_to_draw_a_leaves_the_engine_s_account_of_b(session: Session, compare: Compare) -> None:
    draw_frame(session, compare)
    compare.keep()
    draw_frame(session, compare)
    session.drafts.set("height.level", 0.9)
    session.drafts.set_camera(replace(session.sketch.camera, azimuth=50.0, elevation=60.0))
    picture = session.frame(SIZE)
    assert picture is not None
    engine = session.engine
    counters = (
        list(engine.record.ran),
        engine.record.texels,
        dict(engine.runs),
        engine.record.triangles,
        dict(engine.record.times),
    )
    inspector = Inspector(session)
    under = inspector.at((30, 20), picture)
    compare.follow(picture)
    assert compare.draws == 1
    assert counters == (
        list(engine.record.ran),
        engine.record.texels,
        dict(engine.runs),
        engine.record.triangles,
        dict(engine.record.times),
    )
    again = Inspector(session)
    assert again.at((30, 20), picture) == under and under is not None and under.ground is not None
    inspector.release()
    again.release()


def test_it_shows_the_same_texture_of_both(session: Session, compare: Compare) -> None:
    draw_frame(session, compare)
    compare.keep()
    draw_frame(session, compare)
    session.drafts.set("height.level", 1.0)
    draw_frame(session, compare)
    session.show("height:height")
    for name, value in (("lowest", 0.0), ("highest", 1.0)):
        session.view.set_map(name, value)
    second = draw_frame(session, compare).astype(int)
    np.testing.assert_allclose(first(compare).astype(int)[..., :3] * 2, second[..., :3], atol=2)


def test_another_sketch_ends_it(
    session: Session, compare: Compare, tmp_path_factory: pytest.TempPathFactory
) -> None:
    draw_frame(session, compare)
    compare.keep()
    draw_frame(session, compare)
    other = tmp_path_factory.mktemp("other")
    (other / "terrain.glsl").write_text(TERRAIN.replace('file("mask.png")', 'file("")'), encoding="utf-8")
    (other / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    session.open(other)
    picture = session.frame(SIZE)
    assert picture is not None and session.error is not None
    compare.follow(picture)
    assert compare.on, "the sketch that A is of is still shown"
    compare.swap()
    compare.follow(picture)
    assert compare.on
    (other / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
    write_png(other / "mask.png", np.full((2, 2, 4), 255, np.uint8))
    session.drafts.reload()
    draw_frame(session, compare)
    assert not compare.on


def test_two_pictures_are_painted_as_they_are(ctx: moderngl.Context) -> None:
    ctx.detect_framebuffer(0).use()  # nothing is bound that another test has taken away
    random = np.random.default_rng(2)
    a, b = (make_texture(ctx, (20, 10), "rgba8") for _ in range(2))
    item, two = (random.integers(0, 256, (10, 20, 4), dtype=np.uint8) for _ in range(2))
    for texture, values in ((a, item), (b, two)):
        write_texture(texture, values)
    target = make_texture(ctx, (24, 10), "rgba8")
    framebuffer = make_framebuffer(ctx, [target])
    painter = Blend(ctx)
    painter.paint((a, b), framebuffer, (4, 0, 20, 10), split=0.35)
    picture = read_picture(target)[::-1, 4:, :3]
    np.testing.assert_array_equal(picture[:, :7], item[:, :7, :3])
    np.testing.assert_array_equal(picture[:, 7:], two[:, 7:, :3])
    painter.paint((a, b), framebuffer, (4, 0, 20, 10), gain=3.0)
    expected = np.minimum(3 * np.abs(item.astype(int) - two), 255)[..., :3]
    np.testing.assert_array_equal(read_picture(target)[::-1, 4:, :3], expected)
    ctx.detect_framebuffer(0).use()  # what stays bound is bound again by later calls
    for made in (painter, framebuffer, target, a, b):
        made.release()


def test_they_alternate_when_they_flicker(session: Session) -> None:
    see = Inspection(session)
    session.frame(SIZE)
    assert see.patience(0.1) > 1e6
    see.compare.keep()
    assert see.patience(0.1) > 1e6
    see.compare.mode = Mode.FLICKER
    assert see.patience(0.1) == pytest.approx(PERIOD - 0.1)
    assert [shows_first(n * PERIOD + 0.01) for n in range(4)] == [True, False, True, False]
    see.release()


def test_the_line_follows_the_mouse(folder: Path, open_bare: OpenBare) -> None:
    bare = open_bare(folder)
    compare, io = bare.bench.inspection.compare, imgui.get_io()
    area = 280.0, 0.0, 1000.0, 720.0
    bare.key(imgui.Key.a)
    assert compare.on
    held = []

    def mouse(x: float, down: bool) -> None:
        io.add_mouse_pos_event(x, 400)
        io.add_mouse_button_event(0, down)
        imgui.new_frame()
        held.append(drag_line(compare, area))
        imgui.render()

    for x, down in ((600, False), (600, True), (700, True), (700, False)):
        mouse(x, down)
    assert held == [False] * 4 and compare.split == 0.5  # it was not on the line
    for x, down in (
        (780, False),
        (780, True),
        (580, True),
        (2000, True),
        (480, True),
        (480, False),
        (900, False),
    ):
        mouse(x, down)
    assert held[4:] == [False, True, True, True, True, False, False] and compare.split == 0.2
    bare.run_frames(3)
    bare.click("##how")
    bare.click("difference")
    assert compare.mode is Mode.DIFFERENCE
    bare.run_frames(2)
    assert "##gain" in bare.places
    bare.click("A/B")
    assert not compare.on


def test_a_swap_can_be_undone(folder: Path, open_bare: OpenBare) -> None:
    bare = open_bare(folder)
    bare.key(imgui.Key.a)
    bare.session.drafts.set("height.level", 0.9)
    bare.run_frames(3)
    bare.click("Back to A")
    assert bare.session.shown is not None and not bare.session.shown.edits.values
    bare.key(imgui.Key.mod_ctrl, imgui.Key.z)
    bare.run_frames(3)
    assert bare.session.shown.edits.values == (("height.level", 0.9),)


# ── memory compare ────────────────────────────────────────────────────────────


MEMORY_SIZE = (48, 32)
MEMORY_TERRAIN = """#pragma kernel(output = "height:r32f")
uniform float level = 0.25; //! slider(0, 1)
float kernel(ivec2 texel) { return level * float(texel.x) / float(size.x); }
"""
MEMORY_SKETCH = "format = 1\nsize = 33\n" + passes(height="./terrain") + '[view]\nuse = "view/terrain"\n'


class Harness:
    """One window after another on a sketch."""

    def __init__(self, folder: Path, engine: Engine) -> None:
        self.folder, self.engine = folder, engine
        self.sandbox = FakeSandbox()
        (folder / "terrain.glsl").write_text(MEMORY_TERRAIN, encoding="utf-8")
        (folder / "sketch.toml").write_text(MEMORY_SKETCH, encoding="utf-8")
        self.open()

    def open(self) -> None:
        memory = Memory(self.folder / "sketch.toml", self.folder / "state")
        result, complaint = memory.read()
        assert complaint == ""
        self.found = result.compared
        self.sandbox = FakeSandbox()
        self.session = Session(self.engine, self.folder, start=result.start, sandbox=self.sandbox)
        self.compare = Compare(self.session)
        self.autosave = Autosave(self.session, memory, result, compare=self.compare)
        self.session.frame(MEMORY_SIZE)
        self.answer(SandboxReport(True))

    def answer(self, report: SandboxReport) -> None:
        self.sandbox.answer = report
        self.frame()

    def frame(self) -> None:
        picture = self.session.frame(MEMORY_SIZE)
        if picture is not None:
            self.compare.follow(picture)
        self.autosave.look((900, 600))

    def first(self) -> NDArray[np.uint8]:
        return read_picture(self.compare.picture)

    def close(self) -> None:
        self.autosave.close()
        self.compare.release()
        self.session.release()


@pytest.fixture
def harness(tmp_path: Path, any_engine: Engine):
    made = Harness(tmp_path, any_engine)
    yield made
    made.close()


def compare_something(harness: Harness) -> None:
    harness.session.drafts.set("height.level", 0.75)
    harness.frame()
    harness.compare.keep()
    harness.compare.mode, harness.compare.split, harness.compare.gain = Mode.DIFFERENCE, 0.25, 16.0
    harness.session.drafts.set("height.level", 0.5)
    harness.frame()
    harness.close()


def test_a_is_there_again_once_it_has_been_tried(harness: Harness) -> None:
    compare_something(harness)
    harness.open()
    assert isinstance(harness.found, Compared) and harness.found.mode == "difference"
    harness.frame()
    assert not harness.compare.on and harness.autosave.waits, "it waits for the sandbox"
    assert values_of(harness.sandbox.requests[-1].sketch)["height.level"] == 0.75
    harness.answer(SandboxReport(True))
    harness.frame()
    compare = harness.compare
    assert (compare.mode, compare.split, compare.gain) == (Mode.DIFFERENCE, 0.25, 16.0)
    alone = harness.session.sketch.with_values({"height.level": 0.75})
    if harness.session.is_preview:
        harness.session.read()
        harness.frame()
    expected = harness.engine.render(framed(alone, 0.0, DEFAULT_PICTURE, MEMORY_SIZE), size=MEMORY_SIZE).array
    np.testing.assert_array_equal(harness.first()[..., :3], expected[..., :3])
    assert values_of(harness.session.sketch)["height.level"] == 0.5


def test_an_a_that_fails_the_sandbox_is_never_drawn(harness: Harness) -> None:
    compare_something(harness)
    harness.open()
    harness.frame()
    draws = harness.compare.draws
    harness.answer(SandboxReport(False, SandboxTimeout("pass 'height' took longer than 10 s in the sandbox")))
    harness.frame()
    assert not harness.compare.on and harness.compare.draws == draws
    assert any(
        "A of the last session is left out: pass 'height' took" in note for note in harness.session.notes
    )
    harness.close()
    harness.open()
    assert harness.found is None, "it is not requested again"


def test_close_before_sandbox_answer_still_remembers_comparison(harness: Harness) -> None:
    compare_something(harness)
    for _ in range(2):
        harness.open()
        harness.frame()
        assert harness.found is not None and not harness.compare.on
        harness.close()


def test_comparison_of_left_sketch_is_not_applied_to_other(harness: Harness) -> None:
    compare_something(harness)
    other = harness.folder / "other"
    other.mkdir()
    for name in ("sketch.toml", "terrain.glsl"):
        (other / name).write_bytes((harness.folder / name).read_bytes())
    memory = Memory(other / "sketch.toml", harness.folder / "state")
    assert memory.claim()
    memory.write(Remembered(compared=Compared(Edits((("height.level", 0.625),)))))
    memory.close()
    harness.open()
    harness.frame()
    assert harness.sandbox.requests and not harness.compare.on
    harness.autosave.open(other)
    harness.answer(SandboxReport(True))
    assert harness.session.path == other / "sketch.toml" and not harness.session.drafts.opening
    for _ in range(2):
        harness.answer(SandboxReport(True))
        harness.frame()
    stored = harness.compare.stored
    assert stored is not None and stored.path == other / "sketch.toml"
    assert Path(stored.draft.file.file).parent == other
    assert dict(stored.draft.edits.values) == {"height.level": 0.625}


def test_a_save_goes_before_what_is_only_compared(harness: Harness) -> None:
    compare_something(harness)
    harness.open()
    harness.frame()
    before = len(harness.sandbox.requests)
    (harness.folder / "terrain.glsl").write_text(
        MEMORY_TERRAIN.replace("float(texel.x)", "float(texel.y)"), encoding="utf-8"
    )
    harness.session.drafts.reload()
    harness.frame()
    assert len(harness.sandbox.requests) == before + 1 and harness.session.drafts.testing
    harness.answer(SandboxReport(True))
    assert not harness.session.drafts.testing and not harness.compare.on
    harness.frame()
    harness.answer(SandboxReport(True))
    harness.frame()
    assert harness.compare.on and harness.session.error is None


def test_nothing_compared_is_nothing_remembered(harness: Harness) -> None:
    harness.session.drafts.set("height.level", 0.75)
    harness.compare.keep()
    harness.compare.end()
    harness.frame()
    harness.close()
    harness.open()
    assert harness.found is None and not harness.compare.on
