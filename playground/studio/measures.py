"""Measure the session as a window has it: saves, moving pictures, strokes of a brush.

For ``playground bench``, which says what a measure is. ``measures.toml`` has the rows.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Protocol

from playground.engine.engine import Engine
from playground.engine.sandbox import Sandbox
from playground.errors import PlaygroundError
from playground.paths import GLSL
from playground.sketch.model import Kernel, Sketch
from playground.studio.paint.brush import TOOLS, Brush
from playground.studio.paint.erode_tool import STAMP
from playground.studio.paint.painting import Painting
from playground.studio.reload.watcher import Follower, Watcher
from playground.studio.session import Session

ROWS = Path(__file__).with_suffix(".toml")

PATIENCE = 60.0  # [s] after which a save counts as missed
PAUSE = 0.1  # [s] between saves that are timed
UNMEASURED = 2  # saves, or steps of a brush, that warm up what is used again
SETTLES = 8  # pictures until the size of a preview has settled
TURN = 0.3  # degrees of the camera between two

Times = list[tuple[float, float]]
"""Milliseconds of each run: on the clock, and of processors."""

Timed = tuple[str, str, Times]
"""What follows a row's name and its text, and its times."""


class Bench(Protocol):
    """What a measure is given: an engine, a folder for files, how often to measure, and sketches of rows."""

    folder: Path

    @property
    def rounds(self) -> int:
        """How many runs count."""

    def engine(self) -> Engine:
        """Return the engine."""

    def sketch(self, options: Mapping[str, Any], size: int) -> Sketch:
        """Return a row's sketch."""


def timed(run: Callable[[], object]) -> tuple[float, float]:
    """Return the milliseconds of a run: on the clock, and of processors."""
    start, busy = time.perf_counter(), time.process_time()
    run()
    return (time.perf_counter() - start) * 1e3, (time.process_time() - busy) * 1e3


def window(bench: Bench, options: Mapping[str, Any], size: int) -> Iterator[Timed]:
    """Time a picture of ``sketch`` in a window of ``pixels`` while the camera moves."""
    engine, pixels = bench.engine(), tuple(options["pixels"])
    session = Session(engine, str(options["sketch"]))

    def draw() -> None:
        session.frame(pixels)
        engine.ctx.finish()

    try:
        session.clock.playing = False
        draw()
        camera = _sketch_of(session).camera
        session.read()  # in full
        times = []
        for number in range(1, bench.rounds + SETTLES + 1):
            session.drafts.set_camera(replace(camera, azimuth=camera.azimuth + TURN * number))
            times.append(timed(draw))
        width, height = session.picture.drawn_size
    finally:
        session.release()
    yield "", f" ({width} × {height} by then)", times[SETTLES:]


def stroke(bench: Bench, options: Mapping[str, Any], size: int) -> Iterator[Timed]:
    """Time a step of a stroke to its picture of ``pixels``, by each tool; ``radius`` is in texels."""
    engine, pixels = bench.engine(), tuple(options["pixels"])
    file = Path(bench.sketch(options, size).file)
    session, clock = Session(engine, file), [0.0]
    painting = Painting(session, file.parent, lambda: clock[0])

    def step(number: int) -> None:
        painting.move((0.4 + 0.005 * number, 0.45))
        session.frame(pixels)
        engine.ctx.finish()

    try:
        session.frame(pixels)
        _sketch_of(session)
        painting.toggle()
        radius = float(options["radius"]) * float(options["extent"]) / (size - 1)
        for tool in TOOLS:
            painting.brush = Brush(tool=tool, radius=radius, strength=0.5)
            painting.press((0.4, 0.45))
            times = []
            for number in range(bench.rounds + UNMEASURED):
                clock[0] += STAMP
                times.append(timed(lambda number=number: step(number)))  # type: ignore[misc]
            painting.release()
            yield tool, f": {tool}", times[UNMEASURED:]
    finally:
        painting.close()
        session.release()


def _sketch_of(session: Session) -> Sketch:
    if session.error is not None:
        raise session.error
    assert session.sketch is not None
    return session.sketch


# ── a save until its picture ─────────────────────────────────────────────────


def save(bench: Bench, options: Mapping[str, Any], size: int) -> Iterator[Timed]:
    """Time saves of a kernel, of a file that it includes, and of a value, each until its picture.

    Watcher, sandbox process and engine are as in the window. ``kernel`` is a copy of a library file, which
    ``edit`` makes differ: pairs of a text and what takes its place. In them and in ``passes``, @ is a
    number that was never there. ``sandbox``: whether a process of its own tries each text first.
    """
    texts = texts_of(bench.folder / f"save-{time.monotonic_ns()}", options, size)
    sandbox = Sandbox() if options.get("sandbox", True) else None
    if sandbox is not None:
        sandbox.start()
    watched = WatchedSketch(bench.engine(), texts, sandbox, tuple(options["pixels"]))
    try:
        with watched.watcher:
            watched.follower.follow()
            time.sleep(0.3)
            for file, what in zip(texts, ("a kernel", "an included file", "a value"), strict=True):
                yield file.stem, f": {what}", watched.times(file, bench.rounds)
    finally:
        watched.session.release()
        if sandbox is not None:
            sandbox.close()


def texts_of(folder: Path, options: Mapping[str, Any], size: int) -> dict[Path, str]:
    """Return the texts of a kernel, of what it includes and of the sketch, by file of a new folder.

    Raises ``PlaygroundError`` where the library's kernel has nothing that could be edited so.
    """
    text = (GLSL / f"{options['kernel']}.glsl").read_text(encoding="utf-8")
    for before, after in options["edit"]:
        if before not in text:
            raise PlaygroundError(f"{options['kernel']}.glsl has no '{before}' that the benchmark could edit")
        text = text.replace(before, after, 1)
    folder.mkdir()
    return {
        folder / "mine.glsl": text,
        folder / "own.glsl": "float own() { return @; }\n",
        folder / "sketch.toml": f"format = 1\nsize = {size}\n{options['passes']}",
    }


class WatchedSketch:
    """A session that follows files as the window's does."""

    def __init__(
        self, engine: Engine, texts: dict[Path, str], sandbox: Sandbox | None, pixels: tuple[int, int]
    ) -> None:
        self.engine, self.texts, self.pixels = engine, texts, pixels
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

    def times(self, file: Path, rounds: int) -> Times:
        """Return what saves of a file took until their picture."""
        times = []
        for _ in range(UNMEASURED + rounds):
            self.until(lambda: not self.session.is_preview)
            time.sleep(PAUSE)
            times.append(timed(lambda: self.save_and_show(file)))
        return times[UNMEASURED:]

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


MEASURES: dict[str, Callable[[Bench, Mapping[str, Any], int], Iterator[Timed]]] = {
    "save": save,
    "stroke": stroke,
    "window": window,
}
