"""Every way of saving is seen, and shown in the end; cached techniques and fast variants follow."""

from __future__ import annotations

import io
import os
import random
import shutil
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from playground.allowed_files import noting_places, signature
from playground.engine.engine import Engine
from playground.engine.sandbox import Sandbox
from playground.errors import PlaygroundError, SketchError
from playground.paths import GLSL
from playground.sketch.assign import values_of
from playground.sketch.load import load as load_fresh
from playground.sketch.load import load_with
from playground.sketch.model import Camera, kernels_of
from playground.sketch.variants import NAME
from playground.studio.edits.technique_cache import TechniqueCache
from playground.studio.reload.stages import ReloadStage, explained, missing_file_error
from playground.studio.reload.watcher import Follower, Watcher
from playground.studio.session import Session

from ..loading import load
from ..sketch_texts import map_of_height
from ..variants import trust
from .saves import SAVES, Pause, Save, save_by_rename, save_in_place

LIMIT = 30.0  # [s]


def pause() -> None:
    """Let a moment pass between the steps of a save."""
    time.sleep(0.01)


class Watched:
    """Two files in two folders, and a watcher on them."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.file = folder / "terrain.glsl"
        self.include = folder / "inc" / "deep" / "noise.glsl"
        self.include.parent.mkdir(parents=True)
        self.file.write_text("one", encoding="utf-8")
        self.include.write_text("one", encoding="utf-8")
        self.woken = threading.Event()
        self.watcher = Watcher(self.woken.set, also=(".glsl",))
        self.watcher.follow([self.file, self.include])
        self.watcher.start()
        time.sleep(0.1)  # the kernel's watches are being set up

    def sees(self, *expected: Path) -> bool:
        paths: set[Path] = set()
        end = time.monotonic() + LIMIT
        while not set(expected) <= paths and time.monotonic() < end:
            self.woken.wait(0.02)
            self.woken.clear()
            paths |= self.watcher.take()
        return set(expected) <= paths

    def is_idle(self) -> bool:
        """Wait until nothing is reported for a while: a file may be reported half-written."""
        end = time.monotonic() + LIMIT
        while time.monotonic() < end:
            if self.sees_nothing():
                return True
        return False

    def sees_nothing(self, seconds: float = 1.0) -> bool:
        time.sleep(seconds)
        return not self.watcher.take()


@pytest.fixture
def watched(tmp_path: Path) -> Iterator[Watched]:
    made = Watched(tmp_path)
    yield made
    made.watcher.stop()


@pytest.mark.parametrize("save", SAVES, ids=lambda save: save.__name__)
def test_every_way_of_saving_is_seen_again_and_again(watched: Watched, save: Save) -> None:
    for number in range(3):
        save(watched.file, f"text {number}".encode(), pause)
        assert watched.sees(watched.file)
    save(watched.include, b"another text", pause)
    assert watched.sees(watched.include)


def test_a_second_save_within_50_ms_is_seen(watched: Watched) -> None:
    for number in range(4):
        save_in_place(watched.file, f"first {number}".encode())
        time.sleep(0.02)
        save_in_place(watched.file, f"second {number}".encode())
        seen = ""
        end = time.monotonic() + LIMIT
        while seen != f"second {number}" and time.monotonic() < end:
            if watched.watcher.take():
                seen = watched.file.read_text(encoding="utf-8")
            time.sleep(0.005)
        assert seen == f"second {number}"


@pytest.mark.slow
def test_saving_what_was_there_is_no_change(watched: Watched) -> None:
    for save in SAVES:
        save(watched.file, b"one", pause)
    watched.file.touch()
    (watched.folder / "notes.txt").write_text("nobody follows this", encoding="utf-8")
    assert watched.sees_nothing()


@pytest.mark.slow
def test_a_change_that_is_undone_before_it_is_taken_is_none(watched: Watched) -> None:
    save_in_place(watched.file, b"two")
    assert watched.woken.wait(LIMIT)
    watched.woken.clear()
    save_in_place(watched.file, b"one")
    assert watched.sees_nothing()
    save_in_place(watched.file, b"two")
    assert watched.sees(watched.file)


def test_a_deleted_file_is_a_change_and_so_is_its_return(watched: Watched) -> None:
    watched.file.unlink()
    assert watched.sees(watched.file)
    save_in_place(watched.file, b"back")
    assert watched.sees(watched.file)


def test_a_new_shader_next_to_a_watched_one_is_reported(watched: Watched) -> None:
    new = watched.folder / "new.glsl"
    save_in_place(new, b"new")
    assert watched.sees(new)


@pytest.mark.slow
def test_what_is_followed_may_change_at_any_time(watched: Watched) -> None:
    other = watched.folder / "other" / "sketch.toml"
    other.parent.mkdir()
    save_in_place(other, b"one")
    watched.watcher.follow([watched.file, other])
    save_in_place(other, b"two")
    assert watched.sees(other) and watched.is_idle()
    save_in_place(watched.include, b"nobody follows it any more")
    assert watched.sees_nothing()
    save_in_place(watched.file, b"two")
    assert watched.sees(watched.file)


def test_a_change_between_reading_and_following_is_not_lost(watched: Watched) -> None:
    other = watched.folder / "late.toml"
    read_at = time.time()
    time.sleep(0.06)
    save_in_place(other, b"saved while it was being read")
    watched.watcher.follow([watched.file, other], read_at=read_at)
    assert watched.sees(other)


@pytest.mark.slow
def test_what_a_reader_saw_and_was_never_reported_is_reported(watched: Watched) -> None:
    """It was away for a moment, just when another save had it read: deleted and created is no change."""
    watched.watcher.follow([watched.file, watched.include], read={watched.file: None})
    assert watched.sees(watched.file)
    now = signature(watched.file)
    time.sleep(0.06)  # so that its time is not that of this very moment
    watched.watcher.follow([watched.file, watched.include], read={watched.file: now})
    assert watched.sees_nothing()


def test_old_dated_save_during_read_is_not_lost(watched: Watched) -> None:
    other = watched.folder / "late.toml"
    save_in_place(other, b"one")
    read_at, read = time.time() + 1.0, {other: signature(other)}
    temporary = watched.folder / "unpacked.tmp"
    save_in_place(temporary, b"from an archive")
    os.utime(temporary, (1e9, 1e9))
    temporary.replace(other)
    watched.watcher.follow([watched.file, other], read_at=read_at, read=read)
    assert watched.sees(other)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system's folders hold files alone")
@pytest.mark.parametrize("kind", ["fifo", "zero"])
def test_what_is_no_file_is_reported_and_saves_after_it_as_well(watched: Watched, kind: str) -> None:
    watched.file.unlink()
    if kind == "fifo":
        os.mkfifo(watched.file)
    else:
        watched.file.symlink_to("/dev/zero")
    assert watched.sees(watched.file)
    watched.watcher.follow([watched.include])
    watched.watcher.follow([watched.file, watched.include])  # which waits for no writer
    watched.file.unlink()
    save_in_place(watched.file, b"two")
    assert watched.sees(watched.file)
    save_in_place(watched.file, b"three")
    assert watched.sees(watched.file)


def test_a_save_that_keeps_inode_size_and_time_is_seen(watched: Watched) -> None:
    before = watched.file.stat()
    save_in_place(watched.file, b"two")
    os.utime(watched.file, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert watched.sees(watched.file)


@pytest.mark.slow
def test_a_folder_that_vanishes_and_returns_is_found_again(watched: Watched) -> None:
    shutil.rmtree(watched.include.parent)
    assert watched.sees(watched.include)
    watched.include.parent.mkdir()
    save_in_place(watched.include, b"back")
    assert watched.sees(watched.include)
    save_in_place(watched.include, b"and changed")
    assert watched.sees(watched.include)


@pytest.mark.skipif(os.name == "nt", reason="links need a right of their own on Windows")
def test_a_file_behind_a_link_is_followed(watched: Watched) -> None:
    real = watched.folder / "elsewhere" / "real.glsl"
    real.parent.mkdir()
    save_in_place(real, b"one")
    link = watched.folder / "link.glsl"
    link.symlink_to(real)
    watched.watcher.follow([link])
    time.sleep(0.1)
    save_by_rename(real, b"two")
    assert watched.sees(link)


def test_nothing_runs_before_it_is_started(tmp_path: Path) -> None:
    before = threading.active_count()
    watcher = Watcher()
    watcher.follow([tmp_path / "a.glsl"])
    assert threading.active_count() == before
    watcher.stop()


# ── session saves ─────────────────────────────────────────────────────────────


SIZE = (24, 16)
PATIENCE = 90.0  # [s] for the session to come to rest
LEVEL = "height.level"
SHORT, LONG = range(8), range(8, 108)


def kernel(term: str, includes: str = '#include "inc/tilt.glsl"', level: str = "level") -> str:
    declared = "uniform float level = 0.25; //! slider(0, 1)\n" if level == "level" else ""
    return (
        f'// terrain.glsl -- one of several\n{includes}\n#pragma kernel(output = "height:r32f")\n{declared}'
        f'uniform sampler2D grass; //! file("grass.png")\n'
        f"float kernel(ivec2 texel) {{\n    vec4 g = texelFetch(grass, ivec2(0), 0);\n"
        f"    return {level} * ({term}) + 0.3 * g.r;\n}}\n"
    )


def sketch(use: str, more: str = "size = 17", expected: str = "") -> str:
    wired = f"set = {{ {expected} }}\n" if expected else ""
    return (
        f'format = 1\n{more}\n[[pass]]\nname = "height"\nuse = "{use}"\n{wired}'
        '[view]\nuse = "view/map"\ninputs = { shown = "height" }\nset = { channel = "red" }\n'
    )


def image(colour: tuple[int, int, int], side: int = 2) -> bytes:
    made = io.BytesIO()
    PIL.Image.new("RGB", (side, side), colour).save(made, "PNG")
    return made.getvalue()


def heights(side: int, top: float) -> bytes:
    made = io.BytesIO()
    np.save(made, np.linspace(0.0, top, side * side, dtype=np.float32).reshape(side, side))
    return made.getvalue()


TILT = "tilt(texel, size)"
EXTRA = '#include "inc/tilt.glsl"\n#include "inc/deep/extra.glsl"'
# One of the library's own, before which a file of the same name in the sketch's folder comes.
SHADOW = '#include "inc/tilt.glsl"\n#include "colour/ramp.glsl"'
# Every file that may be there, and what it may hold; the first is what a sequence begins with.
VARIANTS: dict[str, list[bytes]] = {
    "sketch.toml": [
        text.encode()
        for text in (
            sketch("./terrain"),
            sketch("./terrain", "size = 9"),
            sketch("./tech"),
            sketch("./other"),
            sketch("generation/heightmap", "size = 9", 'elevation = "terrain.npy"'),
            sketch("generation/heightmap", "", 'elevation = "terrain.npy"'),
            sketch("./terrain").replace('channel = "red"', 'channel = "red", highest = 0.5'),
            sketch("./terrian"),
            sketch("./terrain").replace("[view]", "[view"),
        )
    ],
    "terrain.glsl": [
        text.encode()
        for text in (
            kernel(TILT),
            kernel(f"1.0 - {TILT}"),
            kernel(f"{TILT} + extra()", EXTRA),
            kernel(f"{TILT} * ramp_blue_yellow(0.5).x", SHADOW),
            kernel(TILT, level="0.5"),
            kernel(f"{TILT} * undeclared"),
            kernel(TILT).replace("slider", "slidder"),
            kernel(TILT, '#include "inc/none.glsl"'),
        )
    ],
    "inc/tilt.glsl": [
        f"float tilt(ivec2 texel, ivec2 size) {{ return {body}; }}\n".encode()
        for body in ("float(texel.x) / float(size.x)", "float(texel.y) / 20.0", "0.5", "texle.x")
    ],
    "inc/deep/extra.glsl": [
        b"",
        *(f"float extra() {{ return {x}; }}\n".encode() for x in ("0.1", "0.4", "a")),
    ],
    "colour/ramp.glsl": [
        b"",
        *(
            f"vec3 ramp_blue_yellow(float share) {{ return vec3({x}); }}\n".encode()
            for x in ("0.9", "share", "wrong")
        ),
    ],
    "other.glsl": [b"", *(kernel(f"{TILT} * {x}").encode() for x in ("0.6", "0.2", "wrong"))],
    "tech.toml": [
        f'[[pass]]\nname = "inner"\nuse = "{use}"\n'.encode() for use in ("./terrain", "./other", "./nothing")
    ],
    "grass.png": [image((255, 0, 0)), image((10, 9, 8)), image((120, 50, 8), 4), image((1, 2, 3))[:40]],
    "terrain.npy": [heights(9, 1.0), heights(5, 0.5), heights(9, 0.25), heights(9, 0.5)[:60]],
}


@dataclass
class Folder:
    """The sketch's folder, and every state it has been in."""

    path: Path
    states: list[dict[str, bytes]] = field(default_factory=list)

    def fill(self) -> None:
        for name, variants in VARIANTS.items():
            if variants[0]:
                self.write(name, variants[0])

    def write(self, name: str, data: bytes) -> None:
        path = self.path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
        self.note()

    def note(self) -> None:
        """Keep what is on the disk just now."""
        result = {}
        for name in VARIANTS:
            if (self.path / name).is_file():
                result[name] = (self.path / name).read_bytes()
        self.states.append(result)


def save_twice(path: Path, data: bytes, pause: Pause) -> None:
    for variant in (next(texts for name, texts in VARIANTS.items() if name.endswith(path.name))[-2], data):
        path.write_bytes(variant)
        pause()


def delete(path: Path, data: bytes, pause: Pause) -> None:
    path.unlink(missing_ok=True)


def delete_its_folder(path: Path, data: bytes, pause: Pause) -> None:
    top = next(item for item in (path, *path.parents) if item.parent.name == "sketch")
    shutil.rmtree(top, ignore_errors=True)  # nothing, where it is the file itself


WAYS = [*SAVES, *SAVES, save_twice, save_twice, delete, delete_its_folder]


class Truth:
    """What a fresh load and an engine of its own make of a folder."""

    def __init__(self, engine: Engine) -> None:
        self.engine = engine

    def of(self, path: Path, level: float | None, seconds: float) -> tuple[str, bytes]:
        """Return what is wrong, or "" and the picture."""
        try:
            result = load(path / "sketch.toml")
            if level is not None and LEVEL in values_of(result):
                result = result.with_values({LEVEL: level})
            frame = self.engine.render(result, size=SIZE, time=seconds)
        except PlaygroundError as error:
            sketch = path / "sketch.toml"
            return str(missing_file_error(sketch) or explained(error, sketch)), b""
        return "", frame.array[..., :3].tobytes()


class Run:
    """One sequence: a session that goes on while files are saved under it."""

    def __init__(self, folder: Folder, engine: Engine, seed: int, sandbox: Sandbox | None) -> None:
        self.folder = folder
        self.dice = random.Random(seed)
        self.woken = threading.Event()
        self.levels: list[float | None] = [None]
        folder.fill()
        self.session = Session(engine, folder.path, sandbox=sandbox)
        self.watcher = Watcher(self.woken.set, also=(".glsl", ".toml"))
        self.follower = Follower(self.session, self.watcher)
        self.follower.follow()
        self.watcher.start()

    def frame(self) -> None:
        """Do what the window does in a frame."""
        self.follower.take()
        self.session.frame(SIZE)
        self.follower.follow()

    def rest(self) -> None:
        """Let the session have some frames, or none."""
        for _ in range(self.dice.choice([0, 0, 1, 3])):
            self.frame()
            time.sleep(self.dice.choice([0.0, 0.001, 0.01]))

    def pause(self) -> None:
        """Keep what is on the disk just now, and let the session have some frames."""
        self.folder.note()
        self.rest()

    def play(self) -> list[str]:
        """Save this and that; return what was done."""
        done = []
        for _ in range(self.dice.randint(3, 9)):
            name = self.dice.choice(list(VARIANTS))
            way = self.dice.choice(WAYS)
            data = self.dice.choice([v for v in VARIANTS[name] if v])
            done.append(f"{way.__name__}({name}, {VARIANTS[name].index(data)})")
            path = self.folder.path / name
            path.parent.mkdir(parents=True, exist_ok=True)
            way(path, data, self.pause)
            self.pause()
            if self.dice.random() < 0.2:
                self.edit()
                done.append(f"level = {self.levels[-1]}")
        return done

    def edit(self) -> None:
        """Edit something, as a user does while files are being saved."""
        if self.session.sketch is not None and LEVEL in values_of(self.session.sketch):
            self.levels.append(round(self.dice.random(), 2))
            self.session.drafts.set(LEVEL, self.levels[-1])
        self.session.drafts.set_camera(Camera(azimuth=self.dice.uniform(0, 360)))
        self.session.clock.time += 0.5

    def picture(self) -> bytes:
        frame = self.session.read()
        return frame.array[..., :3].tobytes() if frame is not None else b""

    def is_at_rest(self) -> bool:
        return self.session.drafts.stage in (ReloadStage.NONE, ReloadStage.FAILED)

    def shows(self, wrong: str, picture: bytes) -> bool:
        """Say whether this mistake is reported, or this picture shown."""
        if not self.is_at_rest() or str(self.session.error or "") != wrong:
            return False
        return bool(wrong) or self.picture() == picture

    def settle(self, wrong: str, picture: bytes) -> None:
        """Go on until this is shown."""
        started = time.monotonic()
        while not self.shows(wrong, picture) and time.monotonic() - started < PATIENCE:
            self.frame()
            self.woken.wait(0.003)
            self.woken.clear()

    def close(self) -> None:
        self.watcher.stop()
        self.session.release()


@pytest.fixture(scope="module")
def shared_sandbox() -> Iterator[Sandbox]:
    with Sandbox(limit_seconds=PATIENCE) as made:
        made.start()
        yield made


def check(tmp_path: Path, engine: Engine, seed: int, sandbox: Sandbox | None) -> None:
    folder = Folder(tmp_path / "sketch")
    folder.path.mkdir()
    run = Run(folder, engine, seed, sandbox)
    with Engine(engine.ctx) as other:
        truth = Truth(other)
        try:
            started = time.monotonic()
            while run.session.draws == 0 and time.monotonic() - started < PATIENCE:
                run.frame()
            assert run.session.draws and run.session.error is None
            done = run.play()
            camera, seconds = run.session.shown.edits.camera, run.session.clock.time
            wrong, picture = truth.of(folder.path, run.levels[-1], seconds)
            for _ in range(2):  # and after what is still reported late, it is so again
                run.settle(wrong, picture)
                text = f"seed {seed}: {'; '.join(done)}\nsaid: {run.session.error}\ntrue: {wrong}"
                assert run.shows(wrong, picture), text
                for _ in range(3):
                    run.frame()
            assert run.session.shown.edits.camera == camera and run.session.clock.time == seconds, text
            if wrong:
                assert run.picture() in pictures_of(tmp_path / "past", folder, truth, run.levels, seconds), (
                    text
                )
        finally:
            run.close()


def pictures_of(
    past: Path, folder: Folder, truth: Truth, levels: list[float | None], seconds: float
) -> Iterator[bytes]:
    """Yield the pictures of every state that the folder has been in, the last first: one of those is shown.

    What an image is, the picture shows at once; what a text is, once it is right. So the
    texts of each state count with the images of that state or of any later one.
    """
    places: dict[tuple[tuple[str, bytes], ...], None] = {}
    for number, state in enumerate(folder.states):
        texts = [item for item in state.items() if not is_data(item[0])]
        for later in folder.states[number:]:
            images = [item for item in later.items() if is_data(item[0])]
            places[tuple(sorted(texts + images))] = None
    for number, files in enumerate(reversed(places)):
        for name, data in files:
            (past / str(number) / name).parent.mkdir(parents=True, exist_ok=True)
            (past / str(number) / name).write_bytes(data)
        if "sketch.toml" in dict(files):
            result = (truth.of(past / str(number), level, seconds)[1] for level in reversed(levels))
            yield from filter(None, result)


def is_data(name: str) -> bool:
    return name.endswith((".png", ".npy"))


@pytest.mark.slow
@pytest.mark.parametrize("seed", SHORT)
def test_every_save_is_shown_in_the_end(
    tmp_path: Path, any_engine: Engine, seed: int, shared_sandbox: Sandbox
) -> None:
    check(tmp_path, any_engine, seed, shared_sandbox if seed % 2 else None)


@pytest.mark.slow
@pytest.mark.parametrize("seed", LONG)
def test_every_save_is_shown_in_the_end_again_and_again(
    tmp_path: Path, any_engine: Engine, seed: int, shared_sandbox: Sandbox
) -> None:
    check(tmp_path, any_engine, seed, shared_sandbox if seed % 2 else None)


# ── technique cache ───────────────────────────────────────────────────────────


KERNEL = """#include "part.glsl"
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return part(); }
"""
PART = "float part() { return 1.0; }\n"
INNER = '[[pass]]\nname = "one"\nuse = "./k"\n[outputs]\nheight = "one"\n'
OUTER = '[[pass]]\nname = "two"\nuse = "./inner"\n[outputs]\nheight = "two"\n'
SKETCH = 'format = 1\n[[pass]]\nname = "height"\nuse = "./outer"\n[[pass]]\nname = "again"\nuse = "./k"\n'


class Files:
    """A sketch's folder, whose files all rested before they are read."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._saved = time.time() - 1e6

    def save(self, name: str, text: str) -> None:
        """Save a file as it was a while ago, and later than all saves before."""
        self._saved += 1.0
        path = self.folder / name
        path.write_text(text, encoding="utf-8")
        os.utime(path, (self._saved, self._saved))


@pytest.fixture
def files(tmp_path: Path) -> Files:
    made = Files(tmp_path)
    for name, text in (
        ("part.glsl", PART),
        ("k.glsl", KERNEL),
        ("inner.toml", INNER),
        ("outer.toml", OUTER),
        ("sketch.toml", SKETCH),
    ):
        made.save(name, text)
    return made


def code_in(sketch) -> list[str]:
    return [kernel.source.code for _, kernel in kernels_of(sketch.graph)]


def test_what_rests_is_the_same_object_in_the_next_reading(files: Files):
    techniques = TechniqueCache()
    first = load_with(techniques.begin(), files.folder)
    second = load_with(techniques.begin(), files.folder)
    for name in ("height", "again", "view"):
        assert first.graph.find(name).technique is second.graph.find(name).technique


def test_a_save_of_what_is_included_deep_inside_is_seen(files: Files):
    techniques = TechniqueCache()
    view = load_with(techniques.begin(), files.folder).graph.find("view").technique
    files.save("part.glsl", PART.replace("1.0", "2.0"))
    sketch = load_with(techniques.begin(), files.folder)
    assert sum("return 2.0;" in code for code in code_in(sketch)) == 2
    assert sketch.graph.find("view").technique is view, "nothing of it was saved"


@pytest.mark.parametrize(
    ("name", "text", "other"),
    [
        ("part.glsl", PART, PART.replace("1.0", "2.0")),
        ("k.glsl", KERNEL, KERNEL.replace("part();", "trap();")),
        ("inner.toml", INNER, INNER.replace("one", "xyz")),
        ("outer.toml", OUTER, OUTER.replace("two", "abc")),
    ],
)
def test_a_save_that_keeps_inode_size_and_times_is_seen(files: Files, name: str, text: str, other: str):
    """As ``cp -p`` does, ``unzip -o`` of packed versions, and a save in one tick of a coarse clock."""
    path = files.folder / name
    techniques = TechniqueCache()
    load_with(techniques.begin(), files.folder)
    before = path.stat()
    assert len(text) == len(other)
    path.write_text(other, encoding="utf-8")
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
    after = path.stat()
    assert (before.st_ino, before.st_size, before.st_mtime_ns) == (
        after.st_ino,
        after.st_size,
        after.st_mtime_ns,
    )
    assert load_with(techniques.begin(), files.folder) == load_fresh(files.folder)
    path.write_text(text, encoding="utf-8")
    assert load_with(techniques.begin(), files.folder) == load_fresh(files.folder)


def test_a_save_that_changes_times_alone_keeps_a_technique(files: Files):
    techniques = TechniqueCache()
    first = load_with(techniques.begin(), files.folder)
    for path in files.folder.iterdir():
        path.touch()
    second = load_with(techniques.begin(), files.folder)
    assert first.graph.find("height").technique is second.graph.find("height").technique


def test_a_file_that_comes_where_another_was_looked_for_is_seen(files: Files):
    techniques = TechniqueCache()
    load_with(techniques.begin(), files.folder)
    files.save("inner.glsl", KERNEL)
    with pytest.raises(SketchError, match="remove one"):
        load_with(techniques.begin(), files.folder)
    (files.folder / "inner.toml").unlink()
    assert load_with(techniques.begin(), files.folder) == load_fresh(files.folder)


def test_cached_load_notes_same_places_as_full_load(files: Files):
    techniques = TechniqueCache()
    with noting_places() as anew:
        load_fresh(files.folder)
    for _ in range(2):
        with noting_places() as places:
            load_with(techniques.begin(), files.folder)
        assert places == anew


def test_cached_techniques_may_nest_no_deeper(files: Files):
    def chain(first: int, last: int) -> None:
        for level in range(first, last):
            files.save(f"n{level}.toml", INNER.replace("./k", f"./n{level + 1}"))

    chain(0, 10)
    files.save("n10.toml", INNER)
    files.save("sketch.toml", SKETCH.replace("./outer", "./n0"))
    techniques = TechniqueCache()
    load_with(techniques.begin(), files.folder)
    chain(20, 29)
    files.save("n29.toml", INNER.replace("./k", "./n0"))
    files.save("sketch.toml", SKETCH.replace("./outer", "./n20"))
    with pytest.raises(SketchError, match="nest more than"):
        load_with(techniques.begin(), files.folder)


def test_cycle_through_cached_technique_is_found(files: Files):
    techniques = TechniqueCache()
    load_with(techniques.begin(), files.folder)
    files.save("inner.toml", INNER.replace("./k", "./outer"))
    with pytest.raises(SketchError, match="circle"):
        load_with(techniques.begin(), files.folder)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_after_any_saves_it_gives_what_a_reading_anew_gives(files: Files, seed: int):
    rng = random.Random(seed)
    texts = {
        "part.glsl": [PART, PART.replace("1.0", "2.0"), "float part( { }\n"],
        "k.glsl": [
            KERNEL,
            KERNEL.replace("part()", "2.0 * part()"),
            KERNEL.replace("part.glsl", "gone.glsl"),
        ],
        "inner.toml": [INNER, INNER.replace("one", "other"), INNER.replace("./k", "./outer")],
        "outer.toml": [OUTER, OUTER.replace("./inner", "./k"), "format = "],
        "sub.glsl": ["// nothing\n"],
        "k.comp": ['#pragma compute(groups = "1, 1")\nvoid main() {}\n'],
    }
    techniques = TechniqueCache()
    for _ in range(60):
        name = rng.choice(list(texts))
        if rng.random() < 0.25:
            (files.folder / name).unlink(missing_ok=True)
        else:
            files.save(name, rng.choice(texts[name]))
        with noting_places() as places:
            seen = result_of(lambda: load_with(techniques.begin(), files.folder))
        with noting_places() as expected:
            assert seen == result_of(lambda: load_fresh(files.folder))
        assert expected.keys() <= places.keys()


def result_of(loading):
    try:
        return loading()
    except PlaygroundError as error:
        return str(error)


# ── fast variants ─────────────────────────────────────────────────────────────


FAST_SKETCH = "format = 1\nsize = 33\n" + map_of_height("./diamond_square")
BEFORE, AFTER = "number * share * smoothing", "number * share * share * smoothing"
FAST_SIZE = (64, 48)


@pytest.fixture
def fast_folder(tmp_path: Path) -> Path:
    """A sketch with diamond-square of its own, its compute variant verified."""
    generation = GLSL / "generation"
    shutil.copytree(generation / "diamond_square", tmp_path / "diamond_square")
    for suffix in (".toml", ".comp"):
        text = (generation / f"diamond_square{suffix}").read_text(encoding="utf-8")
        text = text.replace('"generation/diamond_square/', '"./diamond_square/')
        (tmp_path / f"diamond_square{suffix}").write_text(text, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(FAST_SKETCH, encoding="utf-8")
    trust(tmp_path)
    return tmp_path


@pytest.fixture
def session(ctx, fast_folder):
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    with Engine(ctx) as engine:
        made = Session(engine, fast_folder)
        made.frame(FAST_SIZE)
        yield made
        made.release()


def change(path: Path, before: str, after: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert before in text
    path.write_text(text.replace(before, after), encoding="utf-8")


def picture(session: Session) -> np.ndarray:
    session.frame(FAST_SIZE)
    frame = session.read()
    assert frame is not None and session.error is None
    return frame.array


def saved(session: Session) -> np.ndarray:
    session.notes.clear()
    session.drafts.reload()
    return picture(session)


def runs_fast(session: Session) -> bool:
    return session.plan is not None and session.plan.step("height") is not None


def test_a_save_of_the_plain_text_shows_and_is_reported_once(session, fast_folder):
    before = picture(session)
    assert runs_fast(session) and not session.notes
    change(fast_folder / "diamond_square/raw.glsl", BEFORE, AFTER)
    after = saved(session)
    assert (after != before).any() and not runs_fast(session)
    (note,) = session.notes
    assert "diamond_square.comp is left out, the plain form runs" in note
    change(fast_folder / "diamond_square/raw.glsl", "// end: height", "// more\n// end: height")
    saved(session)
    assert not session.notes, "what was reported before is not reported again"
    change(fast_folder / "diamond_square/raw.glsl", AFTER, BEFORE)
    np.testing.assert_array_equal(saved(session), before)
    assert runs_fast(session) and not session.notes
    change(fast_folder / "diamond_square/raw.glsl", BEFORE, AFTER)
    saved(session)
    assert len(session.notes) == 1, "it ran again in between"


def test_what_is_wrong_from_the_beginning_is_reported(ctx, fast_folder):
    (fast_folder / NAME).unlink()
    with Engine(ctx) as engine:
        session = Session(engine, fast_folder)
        session.frame(FAST_SIZE)
        assert len([note for note in session.notes if "was never verified" in note]) == 1
        session.release()


def test_a_record_that_is_renewed_is_taken_up(session, fast_folder):
    change(fast_folder / "diamond_square/raw.glsl", BEFORE, AFTER)
    saved(session)
    assert not runs_fast(session)
    trust(fast_folder)
    saved(session)
    assert runs_fast(session)
    assert fast_folder / NAME in session.drafts.files, "so that the window follows it"


def test_the_switch_runs_the_plain_form_and_outlives_a_save(session, fast_folder):
    before = picture(session)
    session.drafts.run_plain(True)
    assert np.abs(picture(session).astype(int) - before).max() <= 1
    assert not runs_fast(session) and not session.notes
    change(fast_folder / "sketch.toml", "size = 33", "size = 65")
    saved(session)
    assert not runs_fast(session) and session.plan is not None and session.plan.terrain.size == (65, 65)
    session.drafts.run_plain(False)
    picture(session)
    assert runs_fast(session)


def test_plain_from_the_beginning(ctx, fast_folder):
    with Engine(ctx) as engine:
        session = Session(engine, fast_folder, plain=True)
        session.frame(FAST_SIZE)
        assert not runs_fast(session) and not session.notes
        session.release()


def test_a_text_that_replaces_a_file_shows_as_well(session, fast_folder):
    before = picture(session)
    path = fast_folder / "diamond_square/raw.glsl"
    session.drafts.read_as({str(path): path.read_text(encoding="utf-8").replace(BEFORE, AFTER)})
    assert (picture(session) != before).any() and not runs_fast(session)
    assert len(session.notes) == 1
    session.drafts.read_as({})
    np.testing.assert_array_equal(picture(session), before)
    assert runs_fast(session)
