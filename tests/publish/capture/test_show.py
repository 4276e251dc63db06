"""What the window shows to others: the file is the command's, and what the window shows is in it."""

from __future__ import annotations

import re
import signal
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from imgui_bundle import imgui

import playground
from playground import cli
from playground.data.image_files import read_png
from playground.engine.engine import Engine
from playground.engine.process.worker import Cancelled
from playground.errors import ParameterError, PlaygroundError
from playground.extras import install_command
from playground.publish.addition import Showing, open_addition
from playground.publish.capture_job import FILM, KINDS, MESH, PAGE, PICTURE, SHEET, TURNTABLE, Made, do
from playground.publish.sweep import parts_of, sweep_text
from playground.publish.window import panel as showing_panel
from playground.publish.window import show as showing
from playground.publish.window.show import FORMS, Show, ShowSettings, duration_text, size_text
from playground.sketch.assign import resolve
from playground.sketch.model import Camera
from playground.studio.bench import Host
from playground.studio.edits.autosave import Autosave, memory_of
from playground.studio.edits.memory import Remembered
from playground.studio.keys import open_layers
from playground.studio.land.looks import look_of
from playground.studio.language import choose_language
from playground.studio.notices import Notices
from playground.studio.session import Session

from ...sketch_texts import map_of_height
from ...studio.panel_desk import Bare

TERRAIN = """// terrain.glsl -- a slope that goes up
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1)
uniform int kind = 0; //! menu("one", "two")
uniform vec3 tint = vec3(1.0); //! colour
float kernel(ivec2 texel) { return level * float(texel.x + kind) / float(size.x) + fract(0.25 * time); }
"""
SKETCH = (
    "format = 1\nsize = 33\n"
    + map_of_height(channel="red")
    + """[[keyframe]]
time = 0.0
set = { "height.tint" = "#000000" }
[[keyframe]]
time = 0.5
set = { "height.tint" = "#ffffff" }
"""
)
LIMIT = 90.0  # [s] for a job to end on a slow machine
SIZE = (40, 30)
WIDE = (64, 36)


@pytest.fixture
def opened(any_engine: Engine, tmp_path: Path) -> Iterator[Callable[[Path, tuple[int, int]], Show]]:
    """Return what opens a sketch in a window of a size, and what it shows to others."""
    shows: list[Show] = []

    def opens(path: Path, size: tuple[int, int]) -> Show:
        session = Session(any_engine, path)
        session.frame(size)
        assert session.error is None
        session.clock.playing = False
        (tmp_path / "out").mkdir(exist_ok=True)
        shows.append(Show(session, Notices(), tmp_path / "out", lambda: True))
        return shows[-1]

    yield opens
    for show in shows:
        show.close()
        show.session.exaggerate(1.0)
        show.session.release()


@pytest.fixture
def show(opened: Callable[..., Show], tmp_path: Path) -> Show:
    """A map of heights that move: no camera."""
    (tmp_path / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    return opened(tmp_path, SIZE)


@pytest.fixture
def land(opened: Callable[..., Show], folder: Path) -> Show:
    """A terrain under a camera in which nothing moves, in a window of 16 to 9."""
    return opened(folder, WIDE)


def choose(show: Show, kind: str, form: str = "", **values: object) -> Show:
    """Choose what is to be shown."""
    show.settings = ShowSettings(kind, **values)  # type: ignore[arg-type]
    show.choose_form(form or FORMS[kind][0])
    return show


def made(show: Show) -> Made:
    """Do the job here that the other process does."""
    return do(show.job(), show.session.engine, lambda *_: None, lambda _: None)


def wait(show: Show) -> None:
    """Wait until the job has ended; the window goes on meanwhile."""
    end, texture = time.monotonic() + LIMIT, show.session.picture.texture
    assert texture is not None
    while show.working is not None:
        assert time.monotonic() < end
        show.session.frame(texture.size)
        show.poll()
        time.sleep(0.01)


def notices_of(show: Show) -> str:
    return "\n".join(notice.text for notice in show.notices.items)


def pixels(path: Path) -> np.ndarray:
    return read_png(path)[0]


# ── pictures ──────────────────────────────────────────────────────────────────


def test_a_picture_is_the_windows_with_all_that_is_set(show: Show) -> None:
    show.session.drafts.set("height.level", 0.2)
    show.session.clock.time = 1.5
    show.session.frame(SIZE)
    frame = show.session.read()
    assert frame is not None
    show.start()
    working = show.working
    wait(show)
    assert working is not None and working.progress == (1, 1)
    assert show.made is not None and np.array_equal(pixels(show.made), frame.array), notices_of(show)
    assert show.result.startswith(f"saved {show.made}, 40 × 30 pixels, in ")
    assert show.result in notices_of(show)
    choose(show, PICTURE, size="2")
    larger = made(show).path
    assert larger != show.made and pixels(larger).shape == (60, 80, 4)


@pytest.mark.parametrize(
    ("form", "words"), [("png", "a.png"), ("png16", "a.png --bits 16"), ("exr", "a.exr")]
)
def test_a_picture_is_the_commands(
    land: Show, folder: Path, monkeypatch: pytest.MonkeyPatch, form: str, words: str
) -> None:
    monkeypatch.chdir(folder)
    for times in "12":
        path = made(choose(land, PICTURE, form, size=times)).path
        size = f"{WIDE[0] * int(times)}x{WIDE[1] * int(times)}"
        assert cli.main(["render", "sketch.toml", "--size", size, "-o", *words.split()]) == 0
        assert path.read_bytes() == (folder / words.split()[0]).read_bytes()


def test_the_windows_camera_and_exaggeration_are_in_it(land: Show) -> None:
    session = land.session
    session.drafts.set_camera(Camera(azimuth=30.0, elevation=50.0, target=(0.0, 0.0, 300.0)))
    session.exaggerate(3.0)
    for size in (WIDE, (24, 36)):  # a window that is narrower sees more above and below
        session.frame(size)
        frame = session.read()
        assert frame is not None
        land.start()
        wait(land)
        assert land.made is not None and np.array_equal(pixels(land.made), frame.array)
    assert "Heights are ×3, as shown." in land.prospect.notes


@pytest.mark.parametrize("what", ["map", "look", "muted"])
def test_what_is_shown_in_place_of_the_picture_is_in_it(land: Show, what: str) -> None:
    session = land.session
    if what == "map":
        session.show("height:height")
    elif what == "look":
        session.view.show_as(look_of("clay", session.plan))
    else:
        session.view.mute("colour", True)
    session.frame(WIDE)
    frame = session.read()
    assert frame is not None
    assert np.array_equal(pixels(made(choose(land, PICTURE)).path), frame.array)
    notes = land.prospect.notes
    assert notes == {"map": ("It shows the map of height:height, as the window does.",)}.get(
        what, ("The look is Clay, as in the window.",) if what == "look" else ()
    )


def test_a_large_picture_says_that_it_is_drawn_in_parts(land: Show) -> None:
    choose(land, PICTURE, size="8K")
    assert land.prospect.sentence == "A picture of 7680 × 4320 pixels: PNG, 8 bits"
    assert land.prospect.notes == ("It is drawn in 36 parts, which meet without a seam.",)
    most = int(land.session.engine.ctx.info["GL_MAX_TEXTURE_SIZE"])
    choose(land, PICTURE, "exr", size="typed", typed=(most + 2, 20))
    assert "can be a PNG of 8 bits" in land.form_refusal(PICTURE, "exr") and land.prospect.error
    choose(land, PICTURE, size="typed", typed=(70000, 10))
    assert land.prospect.error == "70000 × 10 pixels: 1 to 65536 a side"


def test_a_view_that_cannot_be_parted_is_refused_before(opened: Callable[..., Show], tmp_path: Path) -> None:
    (tmp_path / "blur.glsl").write_text(
        """// blur.glsl -- reads its neighbours
#pragma kernel(output = "frame:rgba8", repeat = "2")
vec4 kernel(ivec2 texel) { return 0.5 + 0.5 * previous(clamp(texel + 1, ivec2(0), size - 1)); }
"""
    )
    (tmp_path / "sketch.toml").write_text('format = 1\n[view]\nuse = "./blur"\n')
    blur = opened(tmp_path, SIZE)
    most = int(blur.session.engine.ctx.info["GL_MAX_TEXTURE_SIZE"])
    assert choose(blur, PICTURE, size="4K").prospect.error == ""
    assert "parts" in choose(blur, PICTURE, size="typed", typed=(most + 2, 16)).prospect.error


# ── films and turntables ──────────────────────────────────────────────────────


def test_a_turntable_closes_its_circle(land: Show) -> None:
    engine = land.session.engine
    choose(land, TURNTABLE, "frames", around=0.8, fps=5)
    assert land.prospect.sentence == (
        "A turntable of 4 frames, 64 × 36 pixels, 0.8 s at 5 fps: numbered PNG files"
    )
    written = made(land)
    frames = sorted(written.path.iterdir())
    assert (written.count, [path.name for path in frames]) == (4, [f"{n:05d}.png" for n in range(4)])
    sketch = land.session.sketch
    assert sketch is not None and written.path.name == f"{sketch.name}-turntable-frames"
    for quarter, path in enumerate(frames):
        camera = replace(sketch.camera, azimuth=(sketch.camera.azimuth + 90.0 * quarter) % 360.0)
        expected = engine.render(sketch.with_camera(camera), size=WIDE).array
        assert np.array_equal(pixels(path), expected)
    assert len({path.read_bytes() for path in frames}) == 4, "the last is not the first again"


def test_a_turntable_begins_with_what_is_shown(land: Show) -> None:
    land.session.exaggerate(3.0)
    land.session.view.show_as(look_of("hillshade", land.session.plan))
    land.session.frame(WIDE)
    frame = land.session.read()
    assert frame is not None
    written = made(choose(land, TURNTABLE, "frames", around=0.5, fps=4))
    assert np.array_equal(pixels(written.path / "00000.png"), frame.array)
    assert not np.array_equal(pixels(written.path / "00001.png"), frame.array)


def test_a_film_is_the_commands_and_follows_its_keyframes(
    show: Show, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("av")
    monkeypatch.chdir(tmp_path)
    for form in ("mp4", "gif"):
        path = made(choose(show, FILM, form, fps=10)).path
        words = ["render", "sketch.toml", "--video", f"a.{form}", "--fps", "10", "--size", "40x30"]
        assert cli.main(words) == 0
        assert path.read_bytes() == (tmp_path / f"a.{form}").read_bytes()
    assert "A film of 5 frames, 40 × 30 pixels, 0.5 s at 10 fps" in show.prospect.sentence


def test_a_film_of_a_still_sketch_is_refused(land: Show) -> None:
    choose(land, FILM)
    assert land.is_still and "all frames of a film would be the same" in land.prospect.error
    land.start()
    assert land.working is None and land.failed == land.prospect.error and land.failed in notices_of(land)
    choose(land, TURNTABLE)
    assert not land.is_still and not land.prospect.error


def test_a_gif_gets_a_rate_that_it_can_have(show: Show) -> None:
    choose(show, FILM, "gif")
    assert show.settings.fps == 25 and not show.prospect.error
    show.settings.fps = 30
    with pytest.raises(PlaygroundError, match="a GIF cannot show 30"):
        show.job()


# ── stopped ───────────────────────────────────────────────────────────────────


def stopped(show: Show, after: int) -> Made:
    """Do the job here, and stop it after so many parts."""

    def progress(done: int, of: int) -> None:
        if done >= after:
            raise Cancelled

    return do(show.job(), show.session.engine, progress, lambda _: None)


@pytest.mark.parametrize("form", ["mp4", "frames"])
def test_a_film_that_is_stopped_keeps_its_frames(show: Show, form: str) -> None:
    if form == "mp4":
        pytest.importorskip("av")
    kept = [stopped(choose(show, FILM, form, seconds=2.0, fps=10), after=7) for _ in range(2)]
    assert [(each.stopped, each.count) for each in kept] == [(True, 7)] * 2
    assert kept[0].path != kept[1].path, "what the first has kept stays"
    for each in kept:
        if form == "mp4":
            from playground.publish.video import count_pictures

            assert count_pictures(each.path)[0] == 7
        else:
            assert len(list(each.path.iterdir())) == 7
    before = set(show.folder.iterdir())
    with pytest.raises(Cancelled):
        stopped(show, after=0)
    assert set(show.folder.iterdir()) == before, "of nothing, nothing is kept"


@pytest.mark.parametrize("kind", [PICTURE, SHEET, PAGE, MESH])
def test_all_else_that_is_stopped_leaves_nothing(land: Show, kind: str) -> None:
    choose(land, kind, sweeps=["height.gap=0,1", ""])
    with pytest.raises(Cancelled):
        stopped(land, after=0)
    assert list(land.folder.iterdir()) == []


def test_a_stopped_job_says_what_was_kept(show: Show) -> None:
    choose(show, FILM, "frames", seconds=600.0, fps=100)
    show.start()
    assert show.working is not None
    end = time.monotonic() + LIMIT
    while show.working.progress[0] < 3:
        assert time.monotonic() < end
        show.poll()
        time.sleep(0.01)
    assert show.working.seconds_left is not None
    show.working.stop()
    wait(show)
    assert show.made is not None and len(list(show.made.iterdir())) >= 3
    count = len(list(show.made.iterdir()))
    assert show.result == f"stopped; the first {count} frames are kept: {show.made}"
    choose(show, PICTURE, size="typed", typed=(6000, 6000))
    show.start()
    assert show.working is not None
    show.working.stop()
    wait(show)
    assert show.result == "stopped; nothing was kept" and list(show.folder.iterdir()) == [show.made]


def test_the_window_may_close_while_a_job_is_at_work(show: Show) -> None:
    choose(show, PICTURE, size="typed", typed=(6000, 6000)).start()
    show.close()
    assert show.working is None and list(show.folder.iterdir()) == []


def test_a_process_that_dies_is_reported(show: Show) -> None:
    import os

    choose(show, PICTURE, size="typed", typed=(6000, 6000)).start()
    assert show.working is not None
    task = show.working.task
    while not task.begun:
        time.sleep(0.005)
    assert task.slot is not None and task.slot.process is not None
    os.kill(task.slot.process.pid, signal.SIGTERM)
    wait(show)
    assert show.failed.startswith("the capture "), show.failed
    assert not [path for path in show.folder.iterdir() if path.suffix != ".part"], "not even its name"


# ── meshes, pages, sheets ─────────────────────────────────────────────────────


@pytest.mark.parametrize("form", FORMS[MESH])
def test_a_mesh_is_the_exports(land: Show, folder: Path, monkeypatch: pytest.MonkeyPatch, form: str) -> None:
    monkeypatch.chdir(folder)
    assert cli.main(["export", "sketch.toml", "--to", f"a.{form}"]) == 0
    assert made(choose(land, MESH, form)).path.read_bytes() == (folder / f"a.{form}").read_bytes()
    assert land.prospect.sentence.startswith("A mesh of 9 × 5 vertices: ")
    land.session.exaggerate(2.0)
    true = made(choose(land, MESH, form))
    assert true.path.read_bytes() == (folder / f"a.{form}").read_bytes()
    assert land.prospect.notes == ("Heights are true metres, not ×2 as shown.",)
    higher = made(choose(land, MESH, form, exaggerated=True))
    assert higher.path.read_bytes() != (folder / f"a.{form}").read_bytes()
    assert land.job().options.exaggeration == 2.0 and land.prospect.notes == ("Heights are ×2, as shown.",)


def test_light_is_baked_in_where_there_is_some(land: Show, show: Show) -> None:
    assert choose(land, MESH, light=True).job().options.light and not land.light_refusal
    assert choose(land, MESH, "stl").light_refusal == "this format has no colours"
    assert choose(show, MESH).light_refusal == "this sketch has no light of its own"


def test_a_page_is_the_exports_and_says_what_it_lacks(
    land: Show, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder)
    assert cli.main(["export", "sketch.toml", "--to", "a.html"]) == 0
    assert made(choose(land, PAGE)).path.read_bytes() == (folder / "a.html").read_bytes()
    land.session.exaggerate(2.0)
    assert choose(land, PAGE).prospect.notes == (
        "A page has no exaggeration: heights are true in it, not ×2.",
    )
    look, sketch = look_of("clay", land.session.plan), land.session.sketch
    assert look is not None and sketch is not None
    land.session.view.show_as(look)
    land.session.exaggerate(1.0)
    playground.export(look.of(sketch), "b.html", engine=land.session.engine)
    assert made(land).path.read_bytes() == (folder / "b.html").read_bytes()
    try:
        choose_language("fr")
        assert land.job().options.language == "fr"
    finally:
        choose_language("en")


def test_a_sheet_of_a_sweep(show: Show) -> None:
    sheet = made(choose(show, SHEET, sweeps=["height.level=0..1,3", ""]))
    assert sheet.path.name.endswith("-sweep.png") and sheet.count == 3
    assert show.prospect.sentence == "A sheet of 3 pictures, 320 × 240 pixels each: PNG, 8 bits"
    graph = show.session.sketch.graph  # type: ignore[union-attr]
    level, kind, tint = (resolve(graph, f"height.{n}")[0].parameter for n in ("level", "kind", "tint"))
    assert sweep_text("height.level", level) == "height.level=0..1,9"
    assert sweep_text("height.kind", kind) == "height.kind=one,two"
    assert parts_of(tint) == ("r", "g", "b") and parts_of(level) == ("",)
    for text in (sweep_text("height.kind", kind), sweep_text("height.tint", tint, "g")):
        assert choose(show, SHEET, sweeps=[text, ""]).job().sweeps == (text,)


# ── what cannot be ────────────────────────────────────────────────────────────


def test_what_does_not_apply_is_refused_with_a_reason(show: Show, monkeypatch: pytest.MonkeyPatch) -> None:
    assert show.refusal(TURNTABLE) == "no camera can go around this picture: it has no terrain"
    assert not any(show.refusal(kind) for kind in KINDS if kind != TURNTABLE)
    monkeypatch.setitem(__import__("sys").modules, "av", None)
    monkeypatch.setenv("PATH", "")
    assert re.search(re.escape(install_command("video")), show.form_refusal(FILM, "mp4"))
    assert show.form_refusal(FILM, "frames") == ""
    with pytest.raises(PlaygroundError, match=re.escape(install_command("video"))):
        choose(show, FILM, "mp4").job()


def test_a_sketch_without_terrain_has_no_mesh(opened: Callable[..., Show], tmp_path: Path) -> None:
    (tmp_path / "plain.frag").write_text("void main() { gl_FragColor = vec4(0.5, 0.2, 0.1, 1.0); }\n")
    plain = opened(tmp_path / "plain.frag", SIZE)
    assert plain.refusal(MESH) == "this sketch has no terrain that could be a mesh"
    assert plain.refusal(TURNTABLE) and not plain.refusal(PICTURE)
    plain.settings.kind = MESH
    assert plain.prospect.error == plain.refusal(MESH)


def test_an_invalid_choice_is_reported_before_anything_begins(show: Show) -> None:
    for sweep, message in (("", "choose a parameter to sweep"), ("height.levle=0..1", "level")):
        choose(show, SHEET, sweeps=[sweep, ""]).start()
        assert show.working is None and message in show.failed and show.failed in notices_of(show)
    with pytest.raises(ParameterError):
        choose(show, FILM, size="typed", typed=(20000, 100)).job()


def test_it_waits_for_painted_files_and_none_starts_without(show: Show) -> None:
    settled = [True, False]
    show.settle = settled.pop
    choose(show, SHEET).start()
    assert show.failed == "no capture was made, for what was painted last could not be written"
    show.start()
    assert show.failed.startswith("choose a parameter to sweep") and not settled


# ── how long, how large, where ────────────────────────────────────────────────


def test_the_path_is_said_and_nothing_is_overwritten(show: Show) -> None:
    choose(show, PICTURE)
    names = []
    for _ in range(3):
        show._prospect = (None, 0.0, show._prospect[2])
        said = show.prospect.path
        assert said == made(show).path
        names.append(said.name)
    stem = show.job().sketch.name
    assert names == [f"{stem}.png", f"{stem}-2.png", f"{stem}-3.png"]


def test_time_grows_with_pixels_and_frames(land: Show) -> None:
    for _ in range(2):  # the first has the compiler in it
        land.session.redraw()
        land.session.drafts.set_camera(Camera(azimuth=10.0 * _))
        land.session.frame(WIDE)
        land.session.read()
        land.follow()
    small = land.expected_seconds(choose(land, PICTURE).job())
    large = land.expected_seconds(choose(land, PICTURE, size="4K").job())
    few = land.expected_seconds(choose(land, TURNTABLE, "frames", around=1.0).job())
    many = land.expected_seconds(choose(land, TURNTABLE, "frames", around=10.0).job())
    assert small is not None and large is not None and few is not None and many is not None
    assert 0.0 < small < large and small < few < many
    assert many - few == pytest.approx(270 / 29 * (few - small), rel=0.05)


def test_a_card_is_asked_what_the_camera_costs(land: Show, monkeypatch: pytest.MonkeyPatch) -> None:
    engine, session = land.session.engine, land.session
    moved = [path for path in engine.stale(session.sketch, size=(63, 36)) if path.startswith("view")]  # type: ignore[arg-type]
    land.measure()
    assert moved and land.costs.expected(moved[0], 100) is None, "on a processor every picture is timed"
    session.read()
    plan, draws, runs = session.plan, session.draws, dict(engine.runs)
    monkeypatch.setattr(engine, "_info", replace(engine.info, renderer="a card"))
    land.measure()
    assert all(land.costs.expected(path, 100) is not None for path in moved)
    assert session.plan is plan and (session.draws, dict(engine.runs)) == (draws, runs)
    assert engine.record.plan.sketch == session.sketch  # type: ignore[union-attr]
    assert not engine.options.profiling, "nothing else has changed"


def test_times_and_bytes_are_said_as_a_person_reads_them() -> None:
    assert [duration_text(s) for s in (0.2, 42.4, 600.0, 9000.0)] == [
        "about 1 s",
        "about 42 s",
        "about 10 min",
        "about 2.5 h",
    ]
    sizes = 200, 53_000, 2_640_000, 133_000_000
    assert [size_text(size) for size in sizes] == ["1 kB", "53 kB", "2.6 MB", "133 MB"]


def test_the_size_of_an_stl_is_known(land: Show) -> None:
    written = made(choose(land, MESH, "stl")).path
    assert land.prospect.cost.endswith(size_text(written.stat().st_size))


def test_the_folder_is_shown_or_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[object] = []
    monkeypatch.setattr(showing.sys, "platform", "linux")
    monkeypatch.setattr(showing.subprocess, "Popen", lambda words, **_: calls.append(words))
    file = tmp_path / "x.png"
    file.touch()
    assert showing.open_folder(file) == "" and showing.open_folder(tmp_path) == ""
    assert calls == [["xdg-open", str(tmp_path)]] * 2

    def missing(*_: object, **__: object) -> None:
        raise FileNotFoundError

    monkeypatch.setattr(showing.subprocess, "Popen", missing)
    assert str(tmp_path) in showing.open_folder(file)


# ── the dialog ────────────────────────────────────────────────────────────────


@pytest.fixture
def desk(any_engine: Engine, folder: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[Bare, Showing]]:
    """A bare window of the terrain, and its dialog."""
    bare = Bare(any_engine, folder)
    autosave = Autosave(bare.session, memory_of(bare.session.path), Remembered())
    addition = open_addition(Host(bare.bench, autosave, lambda: None, lambda: None, lambda: bare.theme))
    bare.bench.additions = [addition]
    draw = bare.draw

    def both() -> None:
        draw()
        addition.draw_over()
        addition.take()
        addition.update(idle=True)

    monkeypatch.setattr(bare, "draw", both)
    yield bare, addition
    addition.close()
    autosave.close()
    bare.close()


def test_c_opens_the_dialog_and_esc_closes_it(desk: tuple[Bare, Showing]) -> None:
    bare, addition = desk
    show = addition.show
    assert show.settle == bare.bench.painting.settle
    bare.key(imgui.Key.c)
    bare.run_frames(3)
    assert show.shown and open_layers(bare.bench) == ["show"] and addition.has_keys
    for kind in KINDS:
        bare.click(f"{showing.kind_title(kind)}###kind {kind}")
        bare.run_frames(3)
        assert show.settings.kind == kind
    bare.click("Film###kind film")
    assert "Make a turntable instead###instead" in bare.places or bare.run_frames() is None
    bare.click("Make a turntable instead###instead")
    assert show.settings.kind == TURNTABLE
    bare.click("Sheet of a sweep###kind sheet")
    bare.click("###swept0", 0.99)
    bare.click("height.gap")
    assert show.settings.sweeps[0].startswith("height.gap=")
    bare.key(imgui.Key.escape)
    assert not show.shown and not bare.quits
    bare.click("Show…")
    assert show.shown


def test_the_dialog_works_by_keys_alone(desk: tuple[Bare, Showing], tmp_path: Path) -> None:
    bare, addition = desk
    show = addition.show
    show.folder = tmp_path
    bare.key(imgui.Key.c)
    bare.run_frames(3)
    bare.key(imgui.Key.tab)
    bare.key(imgui.Key.tab)
    bare.key(imgui.Key.space)
    assert show.settings.kind == TURNTABLE, "Tab goes on, Space chooses"
    bare.key(imgui.Key.left_arrow)
    bare.key(imgui.Key.space)
    assert show.settings.kind == PICTURE
    bare.key(imgui.Key.down_arrow)
    bare.key(imgui.Key.down_arrow)
    for key in (imgui.Key.space, imgui.Key.down_arrow, imgui.Key.enter):
        bare.key(key)
        bare.run_frames(2)
    assert show.settings.form == "png16" and show.working is None, "Enter is the list's that is open"
    bare.key(imgui.Key.enter)
    assert show.working is not None, show.failed
    bare.key(imgui.Key.escape)
    assert not show.shown and show.working is not None and not show.working.stopping, "it goes on"
    bare.key(imgui.Key.c)
    end = time.monotonic() + LIMIT
    while show.working is not None:
        assert time.monotonic() < end
        bare.run_frames()
        time.sleep(0.01)
    assert show.made is not None and show.made.parent == tmp_path
    bare.click("Copy the path###copy")
    assert bare.clipboard == str(show.made)
    assert bare.bench.interface.panel_shown, "no key went to the window"


def test_the_dialog_fits_a_small_window_in_french(any_engine: Engine, folder: Path) -> None:
    choose_language("fr")
    bare = Bare(any_engine, folder, size=(800, 600))
    show = Show(bare.session, Notices(), folder, lambda: True)
    try:
        show.toggle()
        for kind in KINDS:
            choose(show, kind, sweeps=["height.gap=0,1", ""])
            for _ in range(3):
                imgui.new_frame()
                showing_panel.draw_show(show, bare.theme)
                size = imgui.internal.find_window_by_name("Montrer à d’autres###show").size
                imgui.render()
            assert size.x <= 800 and size.y <= 600 - 16
    finally:
        choose_language("en")
        bare.close()
