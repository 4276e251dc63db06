"""Shaders of other tools in the window: inputs are widgets, a save shows, a mistake has its pass and line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.studio.drops import is_sketch
from playground.studio.problems.problems import Problems
from playground.studio.session import Session

from ..foreign_cases import CASES, HERE, MISTAKE, TEXTS, Case, export, one
from ..studio.panel_desk import Bare
from .drawing import colours

SIZE = (16, 9)
TOYS, ISF = CASES["shadertoy"], CASES["isf"]
PLAIN = TEXTS["plain"]
COUNTING = """/*{"ISFVSN": "2", "INPUTS": [{"NAME": "again", "TYPE": "event", "LABEL": "Again!"},
  {"NAME": "mode", "TYPE": "long", "VALUES": [3, 7], "LABELS": ["three", "seven"], "DEFAULT": 3},
  {"NAME": "at", "TYPE": "point2D"}, {"NAME": "tint", "TYPE": "color"}, {"NAME": "on", "TYPE": "bool"}],
  "PASSES": [{"TARGET": "count", "PERSISTENT": true, "FLOAT": true, "WIDTH": "1", "HEIGHT": "1"}, {}]}*/
void main() {
    float now = IMG_PIXEL(count, vec2(0.5)).r;
    if (PASSINDEX == 0) gl_FragColor = vec4(again ? 0.0 : now + 1.0);
    vec4 others = tint + vec4(at, float(mode), on ? 1.0 : 0.0);
    if (PASSINDEX != 0) gl_FragColor = vec4(now / 255.0, 0.0, 0.0, 1.0) + 0.0 * others;
}
"""


@pytest.fixture
def opened(tmp_path: Path, any_engine: Engine):
    desks: list[Bare] = []

    def made(case: Case) -> Bare:
        desks.append(Bare(any_engine, case.write(tmp_path)))
        return desks[-1]

    yield made
    for item in desks:
        item.close()


@pytest.fixture
def counting(opened) -> Bare:
    return opened(Case("isf", "counting", {"a.fs": COUNTING}, "a.fs"))


def count(bare: Bare) -> int:
    frame = bare.session.read()
    assert frame is not None
    return int(frame.array[0, 0, 0])


def test_an_event_restarts_in_the_frame_that_is_shown(counting) -> None:
    clock = counting.session.clock
    clock.time, clock.paused = 0.5, True
    counting.run_frames(3)
    assert count(counting) == 31
    counting.point(next(label for label in counting.places if label.startswith("Again!")))
    counting.press(True)
    counting.press(False)
    result = []
    for frame in range(31, 35):
        clock.time = frame / 60
        counting.run_frames()
        result.append(count(counting))
    assert result == [0, 1, 2, 3]


def test_its_inputs_are_widgets_of_the_panel(counting) -> None:
    counting.run_frames(3)
    labels = " ".join(counting.places)
    assert "Again!" in labels and "at-x" in labels
    assert counting.session.error is None


@pytest.mark.parametrize("name", ["with_vertex", "persistent", "inputs", "audio", "transition", "imported"])
def test_it_is_drawn_in_the_window(opened, name: str) -> None:
    bare = opened(ISF[name])
    bare.run_frames(3)
    frame = bare.session.read()
    assert bare.session.error is None and frame is not None
    assert colours(frame.array) > 1


def test_a_saved_vertex_shader_is_followed(opened, tmp_path: Path) -> None:
    bare = opened(ISF["with_vertex_1"])
    bare.run_frames(3)
    assert tmp_path / "with_vertex_1.vs" in bare.session.drafts.files


@pytest.fixture
def session(any_engine, tmp_path):
    sessions: list[Session] = []

    def start(path: Path) -> Session:
        sessions.append(Session(any_engine, path))
        sessions[-1].frame(SIZE)
        return sessions[-1]

    yield start
    for each in sessions:
        each.release()


def picture(session: Session) -> np.ndarray:
    frame = session.read()
    assert frame is not None
    return frame.array


def save(session: Session, case: Case, folder: Path) -> None:
    case.write(folder)
    session.drafts.reload()
    session.frame(SIZE)


SAVED = {
    "common_in_a_buffer": "shader.json",
    "folder_directive": "Buffer A.glsl",
    "code_file": "b.glsl",
    "code_include": "lib/x.glsl",
}


@pytest.mark.parametrize("name", SAVED)
def test_a_save_of_any_pass_shows_and_an_error_keeps_the_picture(session, tmp_path, name):
    toy, file = TOYS[name], SAVED[name]
    live = session(toy.write(tmp_path))
    first = picture(live)
    assert live.error is None and tmp_path / file in live.drafts.files
    for wrong, place, line in toy.mistakes():
        save(live, wrong, tmp_path)
        assert live.error is not None
        diagnostic = live.error.diagnostics[0]
        assert (diagnostic.file.rpartition("/")[2], diagnostic.line) == (place, line)
        assert MISTAKE.strip() in [text.strip() for _, text in Problems().lines_around(diagnostic)]
        np.testing.assert_array_equal(picture(live), first)
    changed = toy.files[file].replace("0.5", "0.125")
    assert changed != toy.files[file] or name != "code_include"
    save(live, Case("", name, {**toy.files, file: changed}, toy.opens), tmp_path)
    assert live.error is None
    assert np.array_equal(picture(live), first) == (changed == toy.files[file])


def test_what_is_dropped_opens(tmp_path):
    files = {"a.json": export(one("Image", PLAIN), one("Buffer A", PLAIN, output=257)), "b.json": '{"x": 1}'}
    Case("", "dropped", {**files, "t/Image.glsl": PLAIN}, "").write(tmp_path)
    (tmp_path / "none").mkdir()
    opens = {name: is_sketch(tmp_path / name) for name in ("a.json", "b.json", "t", "none")}
    assert opens == {"a.json": True, "b.json": False, "t": True, "none": False}


def test_a_pass_that_comes_is_watched_for(session, tmp_path):
    alone = Case("", "folder", {"Image.glsl": TEXTS["image"].replace(HERE, "")}, "")
    live = session(alone.write(tmp_path))
    noise = picture(live)
    assert tmp_path / "Buffer A.glsl" in live.drafts.files
    save(live, Case("", "folder", {"Buffer A.glsl": PLAIN}, ""), tmp_path)
    assert live.error is None and not np.array_equal(picture(live), noise)
