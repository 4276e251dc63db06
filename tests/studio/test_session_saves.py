"""However and whenever files are saved: in the end the session shows what is on the disk.

Random sequences of real file operations, each from its seed, while the session goes on
as it does in a window. When they are over and it has come to rest, it must show what a
fresh load and a fresh engine make of the folder, byte for byte; or say the very mistake
that a fresh load says, and still show a picture of something that was there before.
"""

from __future__ import annotations

import io
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

from playground.engine.engine import Engine
from playground.engine.sandbox import Sandbox
from playground.errors import PlaygroundError
from playground.sketch.assign import values_of
from playground.sketch.model import Camera
from playground.studio.reload.stages import ReloadStage, explained, missing_file_error
from playground.studio.reload.watcher import Follower, Watcher
from playground.studio.session import Session

from ..loading import load
from .saves import SAVES, Pause

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
