"""A session without a window: a save shows, a mistake is reported, and the last good picture stays."""

from __future__ import annotations

import gc
import math
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import moderngl
import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.engine.context import ContextInfo
from playground.engine.engine import Engine
from playground.engine.sandbox import SandboxReport
from playground.errors import ContextError, SandboxTimeout, SketchError
from playground.sketch.assign import values_of
from playground.sketch.model import DEFAULT_PICTURE, Camera
from playground.studio import app
from playground.studio.picture import shown_picture
from playground.studio.picture.view import framed
from playground.studio.reload.dependencies import files_of
from playground.studio.reload.stages import ReloadStage
from playground.studio.session import Session

from ..plans import plans_made_whole
from ..sketch_texts import TERRAIN_IN_3D, map_of_height
from .session_desk import FakeSandbox, OpenSession

SIZE = (64, 48)
KERNEL = """// terrain.glsl -- a slope
#include "inc/tilt.glsl"
#pragma kernel(output = "height:r32f")
uniform float level = 0.25; //! slider(0, 1)
float kernel(ivec2 texel) {
    return level * tilt(texel, size);
}
"""
TILT = """// tilt.glsl -- a slope
float tilt(ivec2 texel, ivec2 size) { return float(texel.x) / float(size.x); }
"""
SKETCH = (
    "format = 1\nsize = 33\n"
    + map_of_height(channel="red")
    + '[[preset]]\nname = "high"\nset = { "height.level" = 1.0 }\n'
)

SLOPE = {"terrain.glsl": KERNEL, "inc/tilt.glsl": TILT, "sketch.toml": SKETCH}
SKETCH_3D = """format = 1
size = 33
[[pass]]
name = "height"
use = "generation/diamond_square"
[view]
use = "view/terrain"
samples = 4
"""


class Bench:
    """A sketch's folder and a session on it."""

    def __init__(self, folder: Path, engine: Engine, sandbox: FakeSandbox | None = None) -> None:
        self.folder = folder
        (folder / "inc").mkdir()
        for name, text in SLOPE.items():
            self.write(name, text)
        self.session = Session(engine, folder, sandbox=sandbox)

    def write(self, name: str, text: str) -> None:
        (self.folder / name).write_text(text, encoding="utf-8")

    def change(self, name: str, old: str, new: str) -> None:
        text = (self.folder / name).read_text(encoding="utf-8")
        assert old in text
        self.write(name, text.replace(old, new))
        self.session.drafts.reload()

    def picture(self) -> np.ndarray:
        self.session.frame(SIZE)
        frame = self.session.read()
        return frame.array


@pytest.fixture
def bench(tmp_path: Path, any_engine: Engine) -> Iterator[Bench]:
    made = Bench(tmp_path, any_engine)
    yield made
    made.session.release()


@pytest.fixture
def tried(tmp_path: Path, any_engine: Engine) -> Iterator[tuple[Bench, FakeSandbox]]:
    sandbox = FakeSandbox()
    made = Bench(tmp_path, any_engine, sandbox)
    yield made, sandbox
    made.session.release()


def test_the_picture_is_the_engines(bench: Bench) -> None:
    picture = bench.picture()
    expected = bench.session.engine.render(bench.session.sketch, size=SIZE)
    np.testing.assert_array_equal(picture[..., :3], expected.array[..., :3])


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("terrain.glsl", "level * tilt", "1.0 - level * tilt"),
        ("inc/tilt.glsl", "texel.x", "texel.y"),
        ("sketch.toml", 'channel = "red"', 'channel = "red", highest = 0.5'),
    ],
)
def test_a_save_shows(bench: Bench, name: str, old: str, new: str) -> None:
    before = bench.picture()
    bench.change(name, old, new)
    assert not np.array_equal(bench.picture(), before)
    assert bench.session.error is None and bench.session.last_reload is not None


def test_a_save_of_an_included_parameter_shows(bench: Bench) -> None:
    declared = "uniform float level = 0.25; //! slider(0, 1)\n"
    bench.write("inc/level.glsl", declared)
    bench.change("terrain.glsl", declared, '#include "inc/level.glsl"\n')
    before = bench.picture()
    bench.change("inc/level.glsl", "0.25", "0.75")
    assert not np.array_equal(bench.picture(), before)
    bench.change("inc/level.glsl", "slider(0, 1)", "slider(1, 0)")
    assert bench.session.error is not None
    assert "inc/level.glsl:1:" in str(bench.session.error)


@pytest.mark.parametrize(
    ("name", "old", "new", "location"),
    [
        ("terrain.glsl", "level * tilt", "levle * tilt", "terrain.glsl:6:"),
        ("inc/tilt.glsl", "float(texel.x)", "float(texle.x)", "tilt.glsl:2:"),
        ("terrain.glsl", "//! slider", "//! slidder", "terrain.glsl:4"),
        ("sketch.toml", "[view]", "[view", "sketch.toml:6:"),
        ("sketch.toml", "./terrain", "./terrian", "sketch.toml:5"),
        ("terrain.glsl", "inc/tilt", "inc/tlit", "terrain.glsl:2"),
    ],
)
def test_error_is_reported_and_last_good_picture_stays_until_fix(
    bench: Bench, name: str, old: str, new: str, location: str
) -> None:
    before = bench.picture()
    bench.change(name, old, new)
    np.testing.assert_array_equal(bench.picture(), before)
    assert location in str(bench.session.error)
    assert bench.folder / name in bench.session.drafts.files
    bench.change(name, new, old)
    assert bench.session.error is None
    np.testing.assert_array_equal(bench.picture(), before)


def test_initially_broken_sketch_is_shown_once_fixed(tmp_path: Path, open_session: OpenSession) -> None:
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    session = open_session(tmp_path)
    assert session.frame(SIZE) is None and session.sketch is None
    assert "./terrain" in str(session.error)
    (tmp_path / "inc").mkdir()
    (tmp_path / "inc" / "tilt.glsl").write_text(TILT, encoding="utf-8")
    (tmp_path / "terrain.glsl").write_text(KERNEL, encoding="utf-8")
    session.drafts.reload()
    assert session.frame(SIZE) is not None and session.error is None


def test_a_sketch_that_is_not_there_is_refused(tmp_path: Path, any_engine: Engine) -> None:
    with pytest.raises(SketchError, match="there is no file"):
        Session(any_engine, tmp_path / "none.toml")


def test_nothing_is_drawn_while_nothing_changes(bench: Bench) -> None:
    bench.picture()
    draws = bench.session.draws
    bench.session.clock.advance(1.0)
    bench.picture()
    assert bench.session.draws == draws, "nothing in it names time"
    bench.session.drafts.set("height.level", 0.5)
    bench.picture()
    assert bench.session.draws == draws + 1


def test_cpu_renderer_previews_at_once_and_draws_full_at_rest(
    tmp_path: Path, any_engine: Engine, open_session: OpenSession
) -> None:
    if not any_engine.info.software:
        pytest.skip("on a GPU every picture is drawn in full")
    now = [100.0]
    (tmp_path / "terrain.toml").write_text(SKETCH_3D, encoding="utf-8")
    session = open_session(tmp_path / "terrain.toml", now=lambda: now[0])
    session.frame(SIZE)
    assert session.is_preview and session.draws == 1
    session.frame(SIZE)
    assert session.draws == 1, "it has not rested yet"
    now[0] += 1.0
    session.frame(SIZE)
    assert not session.is_preview and session.draws == 2
    now[0] += 1.0
    session.frame(SIZE)
    assert session.draws == 2
    session.drafts.set("height.smoothing", 0.5)
    session.frame(SIZE)
    assert session.is_preview
    saved = session.read()
    assert saved is not None and session.sketch is not None
    seen = framed(session.sketch, 0.0, DEFAULT_PICTURE, SIZE)
    expected = any_engine.render(seen, size=SIZE).array
    np.testing.assert_array_equal(saved.array[..., :3], expected[..., :3], "what is saved is drawn in full")


def test_time_moves_what_names_it_and_stays_over_a_save(bench: Bench) -> None:
    before = bench.picture()
    bench.change("terrain.glsl", "level * tilt", "fract(time) * tilt")
    still = bench.picture()
    bench.session.clock.advance(0.5)
    moved = bench.picture()
    assert bench.session.animated and not np.array_equal(still, moved)
    bench.session.clock.toggle()
    bench.session.clock.advance(0.5)
    np.testing.assert_array_equal(bench.picture(), moved)
    bench.change("terrain.glsl", "fract(time)", "fract(time) * 1.0")
    np.testing.assert_array_equal(bench.picture(), moved)
    assert not np.array_equal(before, moved) and bench.session.clock.time == 0.5


def test_a_size_that_names_time_moves(bench: Bench) -> None:
    bench.change("sketch.toml", 'use = "./terrain"', 'use = "./terrain"\nsize = "9 + time"')
    bench.picture()
    session = bench.session
    assert session.error is None and session.animated and session.plan is not None
    sizes = []
    for _ in range(2):
        session.frame(SIZE)
        sizes.append(session.plan.step("height").size[0])
        session.clock.advance(4.0)
    assert sizes == [9, 13]


def test_how_many_steps_there_are_follows_time_and_keyframes(bench: Bench) -> None:
    bench.change("terrain.glsl", 'output = "height:r32f"', 'output = "height:r32f", repeat = "2 + time"')
    bench.picture()
    assert bench.session.repeats == {"height": 2}
    bench.session.clock.advance(3.0)
    assert bench.session.repeats == {"height": 5}
    bench.change("terrain.glsl", "2 + time", "count")
    bench.change("terrain.glsl", "uniform float", "uniform int count = 2; //! slider(1, 9)\nuniform float")
    keyframes = [f'[[keyframe]]\ntime = {t}\nset = {{ "height.count" = {n} }}\n' for t, n in ((0, 2), (4, 6))]
    bench.change("sketch.toml", "[[preset]]", "".join(keyframes) + "[[preset]]")
    bench.picture()
    bench.session.clock.time = 0.0
    assert bench.session.error is None and bench.session.repeats == {"height": 2}
    bench.session.clock.time = 4.0
    assert bench.session.repeats == {"height": 6}


def test_values_stay_and_those_of_another_type_fall_back(bench: Bench) -> None:
    bench.picture()
    bench.session.drafts.set("height.level", 0.75)
    bench.change("terrain.glsl", "level * tilt", "1.0 - level * tilt")
    bench.picture()
    assert values_of(bench.session.sketch)["height.level"] == 0.75
    bench.write(
        "sketch.toml", SKETCH.partition("[[preset]]")[0]
    )  # a preset of another type would be a mistake
    bench.change(
        "terrain.glsl",
        "uniform float level = 0.25; //! slider(0, 1)",
        "uniform bool level = true; //! checkbox",
    )
    bench.change("terrain.glsl", "1.0 - level", "1.0 - float(level)")
    bench.picture()
    assert values_of(bench.session.sketch)["height.level"] is True
    assert any("height.level" in note for note in bench.session.notes)


def test_a_value_that_does_not_fit_becomes_a_note(bench: Bench) -> None:
    bench.picture()
    bench.session.drafts.set("height.level", 7.0)
    bench.session.drafts.set("height.levle", 0.5)
    assert values_of(bench.session.sketch)["height.level"] == 0.25
    assert "outside its range" in bench.session.notes[0] and "did you mean" in bench.session.notes[1]


def test_a_technique_that_does_not_draw_leaves_the_one_there_was(bench: Bench) -> None:
    bench.change("sketch.toml", "size = 33", "size = 32")
    before = bench.picture()
    bench.session.drafts.choose("height", "generation/diamond_square")
    np.testing.assert_array_equal(bench.picture(), before)
    assert "33 x 33" in str(bench.session.error)
    bench.session.drafts.choose("height", "./terrain")
    np.testing.assert_array_equal(bench.picture(), before)
    assert bench.session.error is None and bench.session.drafts.stage is ReloadStage.NONE


def test_any_texture_is_shown_as_a_map_fitted_to_its_values(bench: Bench) -> None:
    own = bench.picture()
    assert bench.session.refs == ["height:height"]
    bench.session.show("height:height")
    picture = bench.picture()
    assert picture[..., 0].max() > 250, "the highest value there is is white"
    assert not np.array_equal(picture, own)
    bench.session.show(None)
    np.testing.assert_array_equal(bench.picture(), own)


def test_view_state_survives_saves_errors_and_fixes(bench: Bench) -> None:
    session = bench.session
    bench.picture()
    session.show("height:height")
    session.view.set_map("highest", 0.5)
    session.drafts.set_camera(Camera(azimuth=77.0))
    session.clock.time = 3.0
    session.clock.toggle()
    session.drafts.set("height.level", 0.75)
    looked_at = session.view.map, session.clock.time, session.clock.playing, session.shown.edits
    for old, new in [("level * tilt", "1.0 - level * tilt"), ("1.0 -", "1.0 - x"), ("1.0 - x", "")]:
        bench.change("terrain.glsl", old, new)
        bench.picture()
        assert (session.view.map, session.clock.time, session.clock.playing, session.shown.edits) == looked_at
    expected = session.engine.render(session.view.map.of(session.sketch), size=SIZE, time=3.0)
    np.testing.assert_array_equal(bench.picture()[..., :3], expected.array[..., :3])


def test_a_map_whose_texture_is_gone_gives_way(bench: Bench) -> None:
    bench.picture()
    bench.session.show("height:height")
    bench.picture()
    text = SKETCH.replace('"height"', '"terrain"').replace("height.level", "terrain.level")
    bench.write("sketch.toml", text)
    bench.session.drafts.reload()
    bench.picture()
    assert "height:height is gone" in bench.session.notes[0]
    assert bench.session.view.map is None and bench.session.error is None


def test_the_sandbox_comes_first(tried: tuple[Bench, FakeSandbox]) -> None:
    bench, sandbox = tried
    assert bench.session.frame(SIZE) is None and bench.session.drafts.testing
    sandbox.answer = SandboxReport(True, seconds=0.01)
    before = bench.picture()
    bench.change("terrain.glsl", "level * tilt", "1.0 - level * tilt")
    np.testing.assert_array_equal(bench.picture(), before)
    assert bench.session.drafts.testing and len(sandbox.requests) == 2
    sandbox.answer = SandboxReport(True)
    assert not np.array_equal(bench.picture(), before)
    assert not bench.session.drafts.testing


def test_save_is_planned_during_sandbox_check_without_drawing(
    tmp_path: Path, any_engine: Engine, open_session: OpenSession, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Until it is allowed the driver gets nothing of it; then a save only has to be drawn."""
    monkeypatch.setattr(ContextInfo, "software", True)
    text = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) { return 0.1; }\n'
    (tmp_path / "own.glsl").write_text(text, encoding="utf-8")
    own = SKETCH_3D.replace("generation/diamond_square", "./own")
    (tmp_path / "sketch.toml").write_text(own, encoding="utf-8")
    sandbox, size = FakeSandbox(), (640, 360)
    sandbox.answer = SandboxReport(True)
    session = open_session(tmp_path / "sketch.toml", sandbox=sandbox)
    session.frame(size)
    session.read()
    wholes, runs = plans_made_whole(monkeypatch), sum(any_engine.runs.values())
    (tmp_path / "own.glsl").write_text(text.replace("0.1", "0.2"), encoding="utf-8")
    session.drafts.reload()
    for _ in range(3):
        session.frame(size)
    planned = len(wholes)
    assert sum(any_engine.runs.values()) == runs and session.drafts.testing
    sandbox.answer = SandboxReport(True)
    session.frame(size)
    assert session.error is None and sum(any_engine.runs.values()) > runs
    assert len(wholes) == planned


def test_a_first_picture_that_fails_is_an_error_and_no_more(
    tmp_path: Path, open_session: OpenSession
) -> None:
    """The child had no context to try it in, and here it cannot be drawn: several samples, no image."""
    text = SKETCH_3D.replace("generation/diamond_square", "generation/heightmap")
    (tmp_path / "sketch.toml").write_text(text.replace("[view]", 'set = { elevation = "none.npy" }\n[view]'))
    np.save(tmp_path / "none.npy", np.zeros((3, 3), np.float32))
    sandbox = FakeSandbox()
    session = open_session(tmp_path / "sketch.toml", sandbox=sandbox)
    (tmp_path / "none.npy").unlink()
    sandbox.answer = SandboxReport(False, ContextError("no context"))
    for _ in range(3):
        assert session.frame(SIZE) is None
    assert "none.npy" in str(session.error) and not session.is_preview


def test_what_the_sandbox_refuses_is_never_drawn(tried: tuple[Bench, FakeSandbox]) -> None:
    bench, sandbox = tried
    sandbox.answer = SandboxReport(True)
    before = bench.picture()
    bench.change("terrain.glsl", "level * tilt", "1.0 - level * tilt")
    sandbox.answer = SandboxReport(False, SandboxTimeout("the sandbox took longer than 10 s"))
    np.testing.assert_array_equal(bench.picture(), before)
    assert "longer than 10 s" in str(bench.session.error)
    bench.session.drafts.set("height.level", 0.5)
    assert not np.array_equal(bench.picture(), before), "the last good sketch goes on"
    bench.change("terrain.glsl", "1.0 - level * tilt", "level * tilt")
    assert bench.session.error is None, "it is the sketch that is shown already"
    assert len(sandbox.requests) == 2


@pytest.mark.parametrize(
    ("name", "old", "new", "is_tried"),
    [
        ("terrain.glsl", "a slope", "another comment", False),
        ("terrain.glsl", "slider(0, 1)", "slider(0, 2) step(0.5) How high", False),
        ("sketch.toml", '"height.level" = 1.0', '"height.level" = 0.5', False),
        ("terrain.glsl", "level = 0.25", "level = 0.5", True),
        ("sketch.toml", 'channel = "red"', 'channel = "red", highest = 0.5', True),
        ("inc/tilt.glsl", "texel.x", "texel.y", True),
    ],
    ids=["comment", "range", "preset", "default", "value", "include"],
)
def test_what_the_driver_has_drawn_already_needs_no_sandbox(
    tried: tuple[Bench, FakeSandbox], name: str, old: str, new: str, is_tried: bool
) -> None:
    bench, sandbox = tried
    sandbox.answer = SandboxReport(True)
    before = bench.picture()
    bench.change(name, old, new)
    assert bench.session.drafts.testing == is_tried and len(sandbox.requests) == (2 if is_tried else 1)
    sandbox.answer = SandboxReport(True)
    assert np.array_equal(bench.picture(), before) == (not is_tried)
    assert bench.session.error is None
    assert bench.session.drafts.coming is None, "the new text is the one shown"


def test_internal_error_does_not_end_session(
    bench: Bench, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    before = bench.picture()

    def fails(*_: object, **__: object) -> None:
        raise ZeroDivisionError("oh")

    with monkeypatch.context() as patch:
        patch.setattr(bench.session.engine, "draw", fails)
        bench.session.drafts.set("height.level", 0.5)
        np.testing.assert_array_equal(bench.picture(), before)
        assert "a bug of the playground itself, ZeroDivisionError: oh" in str(bench.session.error)
    assert "the playground itself failed" in caplog.text
    bench.session.drafts.set("height.level", 0.6)
    bench.picture()
    assert bench.session.error is None


def test_every_file_is_watched_images_as_well(bench: Bench) -> None:
    bench.picture()
    bench.change(
        "terrain.glsl",
        "uniform float level",
        'uniform sampler2D grass; //! file("grass.png")\nuniform float level',
    )
    bench.picture()
    names = {path.name for path in bench.session.drafts.files}
    assert {"sketch.toml", "terrain.glsl", "tilt.glsl", "map.glsl"} <= names
    assert "grass.png" in names, "it is missing, and its coming would fix that"
    assert bench.session.sketch is not None
    assert {p.name for p in files_of(bench.session.sketch)} <= names


def test_places_where_a_file_may_come_are_watched_too(bench: Bench) -> None:
    """An include that is missing, in a folder that is missing; and one before which another may stand."""
    bench.picture()
    bench.change("terrain.glsl", "inc/tilt", "new/place/tilt")
    bench.picture()
    assert "new/place/tilt" in str(bench.session.error)
    assert bench.folder / "new" / "place" / "tilt.glsl" in bench.session.drafts.files
    bench.change("terrain.glsl", "new/place/tilt", "noise/hash")
    bench.picture()
    missing = bench.folder / "noise" / "hash.glsl"
    assert missing in bench.session.drafts.files, "it would stand before the library's"
    assert not any(path.parent == Path("/") for path in bench.session.drafts.files)


def stepped(bench: Bench) -> Session:
    bench.write(
        "sketch.toml", SKETCH.replace("./terrain", "generation/diamond_square").split("[[preset]]")[0]
    )
    bench.session.drafts.reload()
    bench.session.frame(SIZE)
    assert bench.session.error is None
    return bench.session


def test_a_repeat_is_shown_at_the_step_that_is_requested(bench: Bench) -> None:
    session = stepped(bench)
    assert session.repeats == {"height.raw": 11}
    whole = bench.picture()
    session.stop_at("height.raw", 4)
    expected = session.engine.render(session.sketch, size=SIZE, steps={"height": 4})
    np.testing.assert_array_equal(bench.picture()[..., :3], expected.array[..., :3])
    assert not np.array_equal(bench.picture(), whole)
    session.stop_at("height.raw", 11)
    assert session.view.steps == {}
    np.testing.assert_array_equal(bench.picture(), whole)


def test_stop_step_survives_save_and_is_dropped_if_out_of_range(bench: Bench) -> None:
    session = stepped(bench)
    whole = bench.picture()
    session.stop_at("height.raw", 8)
    at_eight = bench.picture()
    bench.change("sketch.toml", "format = 1", "# a comment\nformat = 1")
    np.testing.assert_array_equal(bench.picture(), at_eight)
    bench.change("sketch.toml", "size = 33", "size = 5")
    small = bench.picture()
    assert session.repeats == {"height.raw": 5}
    expected = session.engine.render(session.sketch, size=SIZE)
    np.testing.assert_array_equal(small[..., :3], expected.array[..., :3])
    bench.change("sketch.toml", "size = 5", "size = 33")
    np.testing.assert_array_equal(bench.picture(), at_eight)
    session.reset_values()
    np.testing.assert_array_equal(bench.picture(), whole)


def test_results_of_the_last_two_sketches_are_kept(tmp_path: Path, open_session: OpenSession) -> None:
    for name, level in (("one", 0.2), ("two", 0.4), ("three", 0.6)):
        (tmp_path / name / "inc").mkdir(parents=True)
        for file, text in SLOPE.items():
            (tmp_path / name / file).write_text(text.replace("0.25", str(level)), encoding="utf-8")
    session = open_session(tmp_path / "one")
    session.frame(SIZE)

    def ran(name: str) -> bool:
        """Open a sketch; return whether its terrain was made."""
        session.open(tmp_path / name)
        session.frame(SIZE)
        made = "height" in session.engine.record.ran
        assert session.path.parent.name == name and session.error is None
        session.frame(SIZE)
        return made

    assert [ran(name) for name in ("two", "one", "two", "one")] == [True, False, False, False]
    assert [ran(name) for name in ("three", "one")] == [True, False]
    assert [ran(name) for name in ("two", "one")] == [True, False], "two was the last but one"


def test_an_eye_under_the_terrain_is_reported_once(tmp_path: Path, open_session: OpenSession) -> None:
    (tmp_path / "sketch.toml").write_text(SKETCH_3D, encoding="utf-8")
    session = open_session(tmp_path / "sketch.toml")
    session.frame(SIZE)
    assert not any("under the terrain" in note for note in session.notes)
    for azimuth in (20.0, 30.0, 40.0):
        camera = Camera(azimuth=azimuth, elevation=-40, distance=3000, target=(5120, 5120, 0))
        session.drafts.set_camera(camera)
        session.frame(SIZE)
    assert sum("under the terrain" in note for note in session.notes) == 1
    assert session.plan is not None and session.plan.eye.position[2] > 0


PLAIN = """#version 330
uniform sampler2D tex;  //! file("x.png")
out vec4 colour;
void main() { colour = texelFetch(tex, ivec2(0), 0); }
"""


def test_plain_shader_image_is_watched_and_its_change_shows(any_engine: Engine, tmp_path: Path):
    for level in (50, 200):
        write_png(tmp_path / "x.png", np.full((2, 2, 4), level, np.uint8))
        if level == 50:
            (tmp_path / "look.frag").write_text(PLAIN)
            session = Session(any_engine, tmp_path / "look.frag")
            assert tmp_path / "x.png" in session.drafts.files
        session.drafts.reload()
        session.frame(SIZE)
        frame = session.read()
        assert frame is not None and frame.array[0, 0, 0] == level
    session.release()


# ── session leaks ─────────────────────────────────────────────────────────────


LEAKS_SIZE = (64, 36)
TERRAIN = """#pragma kernel(output = "height:r32f", repeat = "3")
uniform float level = 0.25; //! slider(0, 1)
float kernel(ivec2 texel) { return previous(texel) * EDIT + level * float(texel.x) / float(size.x); }
"""


def resident() -> int:
    """Return this process's memory in bytes."""
    if not sys.platform.startswith("linux"):
        pytest.skip("reads /proc")
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096


@pytest.mark.slow
def test_memory_is_flat_over_five_hundred_reloads(
    tmp_path: Path, ctx: moderngl.Context, alive: Counter[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each with another text, every tenth with a mistake, values set by the user between.

    When a picture is drawn in full, with a mesh of its own, is told, and does not depend on the clock.
    """
    monkeypatch.setattr(shown_picture, "REST", math.inf)
    (tmp_path / "sketch.toml").write_text(TERRAIN_IN_3D, encoding="utf-8")
    seen = []
    before = dict(+alive)
    with Engine(ctx) as engine:
        session = None
        for number in range(500):
            edit = "wrong" if number % 10 == 9 else f"0.{number + 1000}"
            (tmp_path / "terrain.glsl").write_text(TERRAIN.replace("EDIT", edit), encoding="utf-8")
            if session is None:
                session = Session(engine, tmp_path)
            else:
                session.drafts.reload()
            session.frame(LEAKS_SIZE)
            assert (session.error is not None) == (edit == "wrong")
            session.drafts.set("height.level", number % 7 / 7)
            session.frame(LEAKS_SIZE)
            if number % 10 == 0:
                session.read()
            if number in (199, 499):
                gc.collect()
                seen.append((dict(+alive), resident()))
        session.release()
    (objects, memory), (later, grown) = seen
    assert later == objects
    assert grown - memory < 12 * 2**20, "300 programs that stayed would take several times that"
    gc.collect()
    assert dict(+alive) == before


# ── collections ───────────────────────────────────────────────────────────────


def test_imports_are_frozen_from_gc_while_window_is_open(monkeypatch):
    frozen = []

    def no_window(*_: object) -> None:
        frozen.append(gc.get_freeze_count())
        raise ContextError("no window in this test")

    monkeypatch.setattr(app, "Window", no_window)
    with pytest.raises(ContextError, match="no window"):
        app.run("l_dot_n", fresh=True, sandbox=SimpleNamespace())  # type: ignore[arg-type]
    assert frozen[0] > 10_000
    assert gc.get_freeze_count() == 0
