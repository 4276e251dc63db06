"""What a save costs until its picture is there: watcher, sandbox process and engine as in the window."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from playground.engine.sandbox import Sandbox
from playground.errors import PlaygroundError
from playground.paths import GLSL
from playground.sketch.model import Kernel
from playground.studio.reload.watcher import Follower, Watcher
from playground.studio.session import Session
from playground.verify.bench.results import Figure
from playground.verify.bench.room import Room
from playground.verify.bench.rows import Row
from playground.verify.bench.timing import Samples

PATIENCE = 60.0  # [s] after which a save counts as missed
PAUSE = 0.1  # [s] between saves that are timed
UNMEASURED = 2  # saves that warm up what is used again


def figures(row: Row, room: Room, size: int) -> Iterator[Figure]:
    """Yield the figures of saves of a kernel, of a file that it includes, and of a value in the sketch.

    ``kernel`` is a copy of a library file, which ``edit`` makes differ: pairs of a text and what takes its
    place. In them and in ``passes``, @ is a number that was never there. ``sandbox``: whether a process
    of its own tries each text first.
    """
    options = row.options
    texts = texts_of(row, room, size)
    sandbox = Sandbox() if options.get("sandbox", True) else None
    if sandbox is not None:
        sandbox.start()
    watched = WatchedSketch(room, texts, sandbox, tuple(options["pixels"]))
    try:
        with watched.watcher:
            watched.follower.follow()
            time.sleep(0.3)
            for file, what in zip(texts, ("a kernel", "an included file", "a value"), strict=True):
                times = watched.times(file, room.options.rounds)
                name = f"{row.name}-{file.stem}"
                yield Figure(row.suite, name, f"{row.what}: {what}", size, "ms", row.goal, {"auto": times})
    finally:
        watched.session.release()
        if sandbox is not None:
            sandbox.close()


def texts_of(row: Row, room: Room, size: int) -> dict[Path, str]:
    """Return the texts of a kernel, of what it includes and of the sketch, by file of a new folder.

    Raises ``PlaygroundError`` where the library's kernel has nothing that could be edited so.
    """
    options = row.options
    text = (GLSL / f"{options['kernel']}.glsl").read_text(encoding="utf-8")
    for before, after in options["edit"]:
        if before not in text:
            raise PlaygroundError(f"{options['kernel']}.glsl has no '{before}' that the benchmark could edit")
        text = text.replace(before, after, 1)
    folder = room.folder / f"save{next(room.numbers)}"
    folder.mkdir()
    return {
        folder / "mine.glsl": text,
        folder / "own.glsl": "float own() { return @; }\n",
        folder / "sketch.toml": f"format = 1\nsize = {size}\n{options['passes']}",
    }


class WatchedSketch:
    """A session that follows files as the window's does."""

    def __init__(
        self, room: Room, texts: dict[Path, str], sandbox: Sandbox | None, pixels: tuple[int, int]
    ) -> None:
        self.engine, self.texts, self.pixels = room.engine(), texts, pixels
        self.number = 0
        for file in texts:
            self.save(file)
        self.woken = threading.Event()
        if sandbox is not None:
            sandbox.on_answer = self.woken.set
        self.session = Session(self.engine, next(iter(texts)).parent, sandbox=sandbox)
        self.watcher = Watcher(self.woken.set, (".glsl", ".toml"))
        self.follower = Follower(self.session, self.watcher)
        self.until(lambda: self.session.draws > 0 and not self.session.is_preview)

    def save(self, file: Path) -> str:
        """Save a text that was never there; return the number in it."""
        self.number += 1
        number = f"{1.0 + self.number * 1e-5 + time.time() % 1 * 1e-6:.9f}"
        file.write_text(self.texts[file].replace("@", number), encoding="utf-8")
        return number

    def until(self, is_shown: Callable[[], bool]) -> None:
        """Go on as the window does until something is shown; raise ``PlaygroundError`` if it is not."""
        end = time.perf_counter() + PATIENCE
        while time.perf_counter() < end:
            self.follower.take()
            self.session.frame(self.pixels)
            self.follower.follow()
            if self.session.error is not None:
                raise self.session.error
            if is_shown():
                self.engine.ctx.finish()
                return
            self.woken.wait(0.004 if self.session.drafts.testing else 0.05)
            self.woken.clear()
        raise PlaygroundError(f"no picture came within {PATIENCE:g} s of a save")

    def times(self, file: Path, rounds: int) -> Samples:
        """Return what saves of a file took until their picture."""
        samples = Samples()
        for number in range(-UNMEASURED, rounds):
            self.until(lambda: not self.session.is_preview)
            time.sleep(PAUSE)
            start, busy = time.perf_counter(), time.process_time()
            self.save_and_show(file)
            if number >= 0:
                samples.wall.append((time.perf_counter() - start) * 1e3)
                samples.processor.append((time.process_time() - busy) * 1e3)
        return samples

    def save_and_show(self, file: Path) -> None:
        """Save a file, and wait for its picture; raise ``PlaygroundError`` where none comes."""
        saved = self.save(file)
        self.until(lambda: self._is_shown(file, saved))

    def _is_shown(self, file: Path, number: str) -> bool:
        draft = self.session.shown
        if draft is None or self.session.drafts.coming is not None:
            return False
        colour = draft.file.graph.find("colour")
        assert colour is not None, "a row's passes have one of this name"
        if file.suffix == ".toml":
            return float(number) in dict(colour.values).values()
        assert isinstance(colour.technique, Kernel), "it is a kernel's file"
        return number in colour.technique.source.code
