"""Time and keyframes under a hand, and how they are written into the sketch's text."""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from imgui_bundle import imgui

from playground.engine.engine import Engine
from playground.errors import PlaygroundError, SketchError
from playground.shader.parameter import shortest
from playground.sketch.model import Camera, Keyframe, Sketch, Value
from playground.studio.bench import Workbench
from playground.studio.clock import Clock, marks_of, span_of, stepped, toggle_loop
from playground.studio.interface import WindowControls
from playground.studio.mouse import PictureMouse
from playground.studio.save.sketch_file import save_keyframes, with_keyframes
from playground.studio.session import Session

from ..loading import load
from ..sketch_texts import LIT_NOISE, SMALL_VIEW, passes
from .panel_desk import Bare, OpenBare
from .session_desk import OpenSession

TERRAIN = """// terrain.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high
float kernel(ivec2 texel) { return level; }
"""
SKETCH = "format = 1\nsize = 17\n" + passes(height="./terrain") + '[view]\nuse = "view/terrain"\n'
KEYFRAMES = """
[[keyframe]]
time = 1.0
camera = { azimuth = 100.0 }
set = { "height.level" = 0.0 }
ease = "linear"
[[keyframe]]
time = 3.0
camera = { azimuth = 200.0 }
set = { "height.level" = 1.0 }
"""


FILES = {"terrain.glsl": TERRAIN, "sketch.toml": SKETCH + KEYFRAMES}


def test_a_loop_goes_round_and_keeps_what_is_over() -> None:
    clock = Clock(time=2.9, loop=(1.0, 3.0))
    clock.advance(0.25)
    assert clock.time == pytest.approx(1.15)
    clock.advance(4.0)  # twice round
    assert clock.time == pytest.approx(1.15)
    clock.time = 7.0  # beyond it time goes on, as after a scrub
    clock.advance(0.5)
    assert clock.time == 7.5
    clock.set_loop(5.0, 2.0)
    assert clock.loop == (2.0, 5.0)
    clock.set_loop(2.0, 2.01)
    assert clock.loop is None


@pytest.mark.parametrize(
    ("time", "frames", "then"),
    [
        (0.0, 1, 1 / 30),
        (0.0, -1, 0.0),
        (0.5, 1, 16 / 30),
        (0.51, 1, 16 / 30),
        (0.51, -1, 0.5),
        (1 / 3, -1, 0.3),
    ],
)
def test_a_step_ends_on_a_picture_of_the_film(time: float, frames: int, then: float) -> None:
    assert stepped(time, frames) == pytest.approx(then, abs=1e-12)


def test_many_steps_on_and_back_end_where_they_began() -> None:
    time = 0.0
    for n in range(1, 400):
        time = stepped(time, 1)
        assert time == n / 30
    for _ in range(399):
        time = stepped(time, -1)
    assert time == 0.0


def test_the_bar_shows_the_keyframes_and_the_current_time(folder: Path) -> None:
    sketch, clock = load(folder), Clock()
    assert marks_of(sketch) == (1.0, 3.0) and span_of(sketch, clock) == 3.0
    clock.time = 12.0
    assert span_of(sketch, clock) == 20.0
    clock.time, clock.loop = 0.0, (2.0, 8.0)
    assert span_of(sketch, clock) == 8.0
    toggle_loop(sketch, clock)
    assert clock.loop is None
    toggle_loop(sketch, clock)
    assert clock.loop == (1.0, 3.0)


def test_keyframes_move_the_picture_as_time_goes(bare: Bare) -> None:
    session = bare.session
    assert session.animated and session.plan is not None
    session.clock.playing = False
    for time, azimuth in ((0.0, 100.0), (2.0, 150.0), (3.0, 200.0), (9.0, 200.0)):
        bare.bench.undo.seek(time)
        bare.run_frames(2)
        assert session.plan.sketch.camera.azimuth == pytest.approx(azimuth)


def test_buttons_and_keys(bare: Bare) -> None:
    clock = bare.session.clock
    bare.click("Pause")
    assert not clock.playing
    bare.click("○ Loop###loop")
    assert clock.loop == (1.0, 3.0)
    bare.click(">")
    assert clock.time == pytest.approx(1 / 30)
    bare.click("<")
    assert clock.time == 0.0
    bare.type("..,")
    assert clock.time == pytest.approx(1 / 30)
    bare.key(imgui.Key.l)
    assert clock.loop is None
    bare.click("To 0")
    assert clock.time == 0.0
    bare.click("##speed")
    bare.click("4 x")
    assert clock.speed == 4.0
    bare.click("Play")
    assert clock.playing


def test_a_scrub_is_one_step_and_keeps_to_a_mark(bare: Bare) -> None:
    bare.session.clock.playing = False
    bare.drag("##timeline", 0.2, 0.5)
    assert bare.session.clock.time == pytest.approx(1.5, abs=0.01)
    assert len(bare.bench.undo.history.steps) == 1
    bare.click("##timeline", 1.0 / 3.0 + 0.004)
    assert bare.session.clock.time == 1.0  # the keyframe's very time
    bare.bench.undo.undo()
    bare.bench.undo.undo()
    assert bare.session.clock.time == 0.0


def test_shift_and_a_drag_choose_the_loop(bare: Bare) -> None:
    bare.run_frames()
    imgui.get_io().add_key_event(imgui.Key.mod_shift, True)
    bare.drag("##timeline", 0.5, 0.9)
    imgui.get_io().add_key_event(imgui.Key.mod_shift, False)
    bare.run_frames()
    loop = bare.session.clock.loop
    assert loop is not None and loop == pytest.approx((1.5, 2.7), abs=0.01)


def test_a_sketch_that_rests_has_no_bar(folder: Path, open_bare: OpenBare) -> None:
    (folder / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    bare = open_bare(folder)
    bare.run_frames(3)
    assert "##timeline" not in bare.places and not bare.session.animated
    bare.key(imgui.Key.l)
    bare.type(".")
    assert bare.session.clock.loop is None and bare.session.clock.time == 0.0


def test_a_drag_begins_where_the_keyframes_left_the_camera(bare: Bare) -> None:
    session, io = bare.session, imgui.get_io()
    session.clock.playing = False
    bare.bench.undo.seek(2.0)
    bare.run_frames(2)
    assert session.plan is not None and session.plan.sketch.camera.azimuth == pytest.approx(150.0)
    hand = PictureMouse(bare.bench)

    def drag_frame(x: float, y: float, down: bool) -> None:
        io.add_mouse_pos_event(x, y)
        io.add_mouse_button_event(0, down)
        imgui.new_frame()
        hand.act((0.0, 0.0, 1280.0, 720.0), 1.0)
        imgui.render()
        for texture in imgui.get_platform_io().textures:
            texture.set_status(imgui.ImTextureStatus.ok)
        session.frame((48, 32))

    drag_frame(900, 300, False)
    drag_frame(900, 300, True)
    drag_frame(904, 300, True)  # 1 degree of 180 a height
    assert session.plan.sketch.camera.azimuth == pytest.approx(150.0, abs=1.5)
    assert session.plan.sketch.camera.azimuth != pytest.approx(150.0, abs=0.1)
    drag_frame(908, 300, True)
    assert session.plan.sketch.camera.azimuth == pytest.approx(150.0, abs=2.5)
    drag_frame(908, 300, False)
    session.clock.time = 3.0
    session.frame((48, 32))
    assert session.plan.sketch.camera.azimuth == pytest.approx(150.0, abs=2.5)  # the hand's stays


# ── keyframe edits ────────────────────────────────────────────────────────────


EDITED_SKETCH = (
    """format = 1  # ours
size = 33
extent = 1000.0
relief = 200.0
"""
    + LIT_NOISE
    + SMALL_VIEW
)
SIZE = (48, 32)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    result = tmp_path / "sketch.toml"
    result.write_text(EDITED_SKETCH, encoding="utf-8")
    return result


@pytest.fixture
def bench(any_engine: Engine, path: Path) -> Iterator[Workbench]:
    session = Session(any_engine, path)
    made = Workbench(session, WindowControls(lambda: None), folder=path.parent)
    draw_frame(made)
    yield made
    session.release()


def draw_frame(bench: Workbench) -> np.ndarray:
    for _ in range(2):
        bench.session.frame(SIZE)
        bench.undo.record()
        bench.take_notes()
    assert bench.session.error is None
    frame = bench.session.read()
    return frame.array


def add(bench: Workbench, time: float, camera: Camera, gain: float) -> np.ndarray:
    bench.session.clock.time = time
    bench.session.drafts.set_camera(camera)
    bench.session.drafts.set("light.gain", gain)
    before = draw_frame(bench)
    assert bench.keyframes.add_here(bench.keyframes.changed_paths)
    after = draw_frame(bench)
    assert np.array_equal(before, after), "the keyframe shows what was seen when it was added"
    return after


def test_what_is_seen_is_keyed_and_is_no_longer_set_by_hand(bench: Workbench, path: Path) -> None:
    first = add(bench, 0.0, Camera(200.0, 30.0, 1500.0), 1.0)
    second = add(bench, 2.0, Camera(120.0, 50.0, 900.0), 2.5)
    draft = bench.session.shown
    assert draft is not None and draft.edits.camera is None and draft.edits.values == ()
    result = load(path)
    assert [k.time for k in result.keyframes] == [0.0, 2.0]
    assert path.read_text(encoding="utf-8").startswith(EDITED_SKETCH)
    bench.session.clock.time = 0.0
    assert np.array_equal(draw_frame(bench), first)
    bench.session.clock.time = 1.0
    between = result.at(1.0)
    assert 900.0 < between.camera.distance < 1500.0
    assert not np.array_equal(draw_frame(bench), first) and not np.array_equal(draw_frame(bench), second)


@pytest.mark.slow
def test_each_step_is_undone_and_done_again_in_the_file_too(bench: Workbench, path: Path) -> None:
    texts = [path.read_text(encoding="utf-8")]

    def step(done: bool) -> None:
        assert done
        draw_frame(bench)
        texts.append(path.read_text(encoding="utf-8"))

    add(bench, 0.0, Camera(200.0, 30.0, 1500.0), 1.0)
    texts.append(path.read_text(encoding="utf-8"))
    add(bench, 2.0, Camera(120.0, 50.0, 900.0), 2.5)
    texts.append(path.read_text(encoding="utf-8"))
    step(bench.keyframes.move(1, 3.0))
    step(bench.keyframes.set_ease(0, "linear"))
    step(bench.keyframes.delete(1))
    names = [step.name for step in bench.undo.history.steps if step.name]
    assert names == [
        "Keyframe at 0 s",
        "Keyframe at 2 s",
        "Keyframe to 3 s",
        "Keyframe: linear",
        "Delete the keyframe at 3 s",
    ]
    written = [load(path).keyframes]
    while bench.undo.history.can_undo:
        bench.undo.undo()
        draw_frame(bench)
        written.append(load(path).keyframes)
    assert path.read_text(encoding="utf-8") == texts[0]
    assert [len(frames) for frames in dict.fromkeys(written)] == [1, 2, 2, 2, 1, 0]
    while bench.undo.history.can_redo:
        bench.undo.redo()
        draw_frame(bench)
    assert [(k.time, k.ease) for k in load(path).keyframes] == [(0.0, "linear")]


def test_undoing_a_keyframe_gives_back_what_was_set_by_hand(bench: Workbench) -> None:
    picture = add(bench, 1.0, Camera(200.0, 30.0, 1500.0), 2.0)
    bench.undo.undo()
    assert np.array_equal(draw_frame(bench), picture)
    draft = bench.session.shown
    assert draft is not None and draft.edits.camera == Camera(200.0, 30.0, 1500.0)
    assert dict(draft.edits.values) == {"light.gain": 2.0} and draft.file.keyframes == ()


def test_a_second_at_the_same_time_goes_into_the_first(bench: Workbench, path: Path) -> None:
    add(bench, 1.0, Camera(200.0, 30.0, 1500.0), 2.0)
    bench.session.drafts.set("light.ambient", 0.25)
    draw_frame(bench)
    assert bench.keyframes.add_here(["light.ambient"], camera=False)
    (result,) = load(path).keyframes
    assert (
        dict(result.values) == {"light.gain": 2.0, "light.ambient": 0.25}
        and dict(result.camera)["azimuth"] == 200
    )


@pytest.mark.slow
def test_an_invalid_edit_is_reported_and_nothing_is_written(bench: Workbench, path: Path) -> None:
    assert not bench.keyframes.add_here([], camera=False)
    assert "choose what the keyframe sets" in bench.notices.items[-1].text
    assert not bench.keyframes.add_here(["size"], camera=False)
    assert "is of the terrain" in bench.notices.items[-1].text
    assert path.read_text(encoding="utf-8") == EDITED_SKETCH
    add(bench, 0.0, Camera(distance=900.0), 1.0)
    add(bench, 1.0, Camera(distance=800.0), 2.0)
    assert not bench.keyframes.move(1, 0.0)
    assert "there is a keyframe at 0 s already" in bench.notices.items[-1].text
    with pytest.raises(ValueError, match="expected smooth, linear, hold"):
        bench.keyframes.set_ease(0, "bouncy")


def test_the_whole_terrain_is_given_in_metres(bench: Workbench, path: Path) -> None:
    assert bench.keyframes.add_here([])
    draw_frame(bench)
    (result,) = load(path).keyframes
    plan = bench.session.plan
    assert plan is not None and dict(result.camera)["distance"] == pytest.approx(plan.eye.distance, abs=0.01)


@pytest.mark.slow
def test_a_sketch_that_ships_offers_a_copy(open_session: OpenSession, tmp_path: Path) -> None:
    session = open_session("l_dot_n", values={"size": 33})
    bench = Workbench(session, WindowControls(lambda: None), folder=tmp_path)
    draw_frame(bench)
    assert not bench.keyframes.add_here([])
    assert bench.file.asks and "belongs to the playground" in bench.file.offer


def test_the_panel_s_list(open_bare: OpenBare, path: Path) -> None:
    bare = open_bare(path, (1280, 3000))
    bare.click("Keyframes###keyframes", 0.3)
    bare.watch(imgui, "radio_button")
    for time in (0.0, 2.0):
        bare.session.clock.time = time
        bare.session.drafts.set("light.gain", 1.0 + time)
        bare.run_frames(2)
        bare.click("Add keyframe here")
    assert [k.time for k in load(path).keyframes] == [0.0, 2.0]
    assert dict(load(path).keyframes[1].values) == {"light.gain": 3.0}
    bare.click("##go")
    assert bare.session.clock.time == 2.0 and not bare.session.clock.playing
    bare.click("##ease")
    bare.click("hold")
    assert "hold" in [k.ease for k in load(path).keyframes]


# ── save keyframes ────────────────────────────────────────────────────────────


SAVED_SKETCH = """format = 1  # ours
size = 33
# The morning.
[[keyframe]]
time = 0.0    # at once
camera = { azimuth = 230.0, distance = 4000.0 }
[keyframe.set]
"light.sun" = { azimuth = 95.0, elevation = 8.0 }
"light.gain" = 2   # bright

[[pass]]
name = "height"
use = "generation/white_noise"

[[pass]]
name = "light"
use = "lighting/l_dot_n"

# Noon,
# and it is hot.
[[keyframe]]
time = 4.0
set = { "light.gain" = 1.5 }
ease = "hold"

[[shot]]
name = "late"
time = 3.0
"""
NEW = """[[keyframe]]
time = 2.25
camera = { azimuth = 10 }
set = { "light.gain" = 1.0 }
ease = "linear"
"""


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "sketch.toml"
    path.write_text(SAVED_SKETCH, encoding="utf-8")
    return path


def plain(keyframes: Iterable[Keyframe]) -> list[tuple[object, ...]]:
    """Return what keyframes say, in one order, and as a shader reads it."""

    def values(keyframe: Keyframe) -> list[tuple[str, Value]]:
        return sorted((path, shortest(value)) for path, value in keyframe.values)

    return [(k.time, k.ease, sorted(k.camera), values(k)) for k in keyframes]


def saved(path: Path, *expected: Keyframe) -> str:
    save_keyframes(load(path), expected)
    assert plain(load(path).keyframes) == plain(sorted(expected, key=lambda k: k.time))
    return path.read_text(encoding="utf-8")


def test_keyframe_time_ease_and_value_are_overwritten_in_place(file: Path) -> None:
    first, second = load(file).keyframes
    assert saved(file, first, replace(second, time=5.5)) == SAVED_SKETCH.replace("time = 4.0", "time = 5.5")
    first, second = load(file).keyframes
    text = saved(file, replace(first, ease="linear"), replace(second, ease="smooth", time=4.0))
    assert 'ease = "smooth"' in text and 'ease = "linear"' in text and "# at once" in text
    file.write_text(SAVED_SKETCH, encoding="utf-8")
    first, second = load(file).keyframes
    values = dict(first.values) | {"light.gain": 3.0}
    text = saved(file, replace(first, values=tuple(values.items())), second)
    assert text == SAVED_SKETCH.replace('"light.gain" = 2 ', '"light.gain" = 3 ')


def test_one_that_moves_past_another_takes_its_comments_along(file: Path) -> None:
    first, second = load(file).keyframes
    text = saved(file, replace(first, time=9.0), second)
    assert text.index("# and it is hot.") < text.index("[[pass]]") < text.index("# The morning.")
    assert "# The morning.\n[[keyframe]]\ntime = 9.0    # at once\n" in text
    assert all(
        text.count(line) == SAVED_SKETCH.count(line)
        for line in SAVED_SKETCH.split("\n")
        if line.startswith("#")
    )
    again = [replace(k, time=0.0) if k.time == 9.0 else k for k in load(file).keyframes]
    assert saved(file, *again).strip() == SAVED_SKETCH.strip()


def test_a_new_one_comes_in_and_one_goes_out_with_its_comments(file: Path) -> None:
    first, second = load(file).keyframes
    new = Keyframe(2.25, (("azimuth", 10.0),), (("light.gain", 1.0),), "linear")
    text = saved(file, first, second, new)
    assert NEW in text
    text = saved(file, *(k for k in load(file).keyframes if k.time != 2.25))
    assert "2.25" not in text and "# at once" in text and "# and it is hot." in text
    text = saved(file, load(file).keyframes[0])
    assert "and it is hot" not in text and text.count("[[keyframe]]") == 1 and "[[shot]]" in text
    text = saved(file)
    assert "keyframe" not in text and "morning" not in text
    assert "\n\n\n" not in text and text.startswith("format = 1  # ours\nsize = 33\n")
    assert saved(file, new).endswith(NEW)


def test_windows_line_ends_and_no_end_of_line_stay(file: Path) -> None:
    file.write_bytes(SAVED_SKETCH.rstrip("\n").replace("\n", "\r\n").encode())
    first, second = load(file).keyframes
    save_keyframes(load(file), [first, second, Keyframe(7.0, values=(("light.gain", 1.0),))])
    data = file.read_bytes()
    assert data.count(b"\n") == data.count(b"\r\n") and len(load(file).keyframes) == 3


@pytest.mark.parametrize("seed", range(8))
def test_any_change_is_what_it_says_and_leaves_the_rest_alone(file: Path, seed: int) -> None:
    """Against an independent truth: the file loaded again, and every line that is no keyframe's."""
    rng = random.Random(seed)
    rest = [
        line
        for line in SAVED_SKETCH.split("\n")
        if line.startswith(("format", "size", "name", "use", "[[pass", "[[shot"))
    ]
    for _ in range(6):
        keyframes = list(load(file).keyframes)
        for keyframe in keyframes[:]:
            share = rng.random()
            if share < 0.2:
                keyframes.remove(keyframe)
            elif share < 0.5:
                keyframes[keyframes.index(keyframe)] = replace(keyframe, time=round(rng.random() * 20, 2))
            elif share < 0.7:
                keyframes[keyframes.index(keyframe)] = replace(keyframe, ease=rng.choice(["hold", "linear"]))
            elif share < 0.8 and keyframe.values:
                keyframes[keyframes.index(keyframe)] = replace(
                    keyframe, values=(("light.gain", rng.random()),)
                )
        if rng.random() < 0.6:
            keyframes.append(
                Keyframe(30 + round(rng.random() * 20, 2), (("elevation", 20.0 + rng.random()),))
            )
        text = saved(file, *keyframes)
        lines = iter(text.split("\n"))
        assert all(line in lines for line in rest), text


def test_what_cannot_be_written_leaves_the_file(file: Path) -> None:
    first, second = load(file).keyframes
    with pytest.raises(SketchError, match="at 4 s already"):
        save_keyframes(load(file), [first, replace(second, time=4.0), replace(first, time=4.0)])
    with pytest.raises(PlaygroundError):
        save_keyframes(load(file), [first, replace(second, values=(("light.nothing", 1.0),))])
    assert file.read_text(encoding="utf-8") == SAVED_SKETCH
    listed = "format = 1\nkeyframe = [ { time = 1.0, camera = { azimuth = 1.0 } } ]\n"
    file.write_text(listed + SAVED_SKETCH.partition("\n\n")[2].partition("# Noon")[0], encoding="utf-8")
    sketch: Sketch = load(file)
    assert len(sketch.keyframes) == 1
    with pytest.raises(SketchError, match=r"written as one list"):
        save_keyframes(sketch, [])


def test_a_header_in_a_text_is_none(file: Path) -> None:
    text = SAVED_SKETCH.replace("size = 33\n", 'size = 33\ntitle = """\n[[keyframe]]\n"""\n')
    file.write_text(text, encoding="utf-8")
    result = load(file)
    assert with_keyframes(text, result, result.keyframes) == text
