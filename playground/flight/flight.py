"""A flight: a sketch's terrain, a craft over it, a time of day; step by step, and a picture of any moment.

A step depends on the steps before it and the pilot's input alone: not on the clock of the
machine, not on which pictures were drawn. Only which parts are there depends on the budget,
and never what lies under the craft, which is made before it is needed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from playground.engine.engine import Engine
from playground.engine.frame import Frame
from playground.engine.textures import read_picture
from playground.errors import DataError, ParameterError
from playground.files import make_folder
from playground.flight.craft import CLEARANCE, LEVEL, Controls, Craft, stepped, through, turned
from playground.flight.layout import Plot, plot_of
from playground.flight.parts import Parts
from playground.flight.record import Moment, Record
from playground.flight.scene import Before, Scene
from playground.sketch.model import Sketch

if TYPE_CHECKING:
    import moderngl


RADIUS = 5.0  # [parts] visible
PARTS_A_STEP = 1  # of a flight without a window
START_ABOVE = 450.0  # [m] over the ground
CACHE_BYTES = 192 * 2**20  # of the engine, besides the flight's own textures

SKY_STEPS = 8
"""Steps for which sky and air are those of one moment: they are soft, and far away."""
WIDER_VIEW = 84.0
"""[degrees] upright, of sky and air."""
TURNED = 0.22
"""[radians] the margin of that: a craft that has turned by more has sky and air of its own."""
_FAR_SKY = 20_000.0  # [m] nothing of the sky is nearer

Start = tuple[float, float, float, float]
"""Metres east, north and up, degrees from north."""


class Flight:
    """Flies over a sketch. Use it with ``with``, or call ``release()``; the engine stays the caller's."""

    def __init__(
        self,
        engine: Engine,
        sketch: Sketch,
        *,
        radius: float = RADIUS,
        start: Start | None = None,
        samples: int | None = None,
    ) -> None:
        self.engine = engine
        self.sketch = sketch
        self.plot: Plot = plot_of(sketch, engine)
        self._next: _Next | None = None
        with ExitStack() as begun:
            self.parts = Parts(engine, self.plot, radius)
            begun.callback(self.parts.release)
            samples_wanted = sketch.picture.samples if samples is None else samples
            self.scene = Scene(engine, self.plot, max(min(samples_wanted, engine.info.max_samples), 1))
            begun.callback(self.scene.release)
            self.craft = self._placed(start)
            self._earlier = self.craft  # whose sky and air are shown
            self._first, self._first_hour = self.craft, self.parts.hour
            self._look()
            _take_daylight(self.engine, self.plot, self.parts.hour, self.scene)
            begun.pop_all()

    def __enter__(self) -> Flight:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()

    def release(self) -> None:
        """Release every texture of the flight's own."""
        self.drop_change()
        self.parts.release()
        self.scene.release()

    # ── where the craft is ─────────────────────────────────────────────────────────

    @property
    def hour(self) -> float:
        """Time of day [hours]."""
        return self.parts.hour

    @property
    def above_ground(self) -> float:
        """Metres over the ground, or over the sea where that is higher."""
        return self.craft.up - max(self.parts.ground_at(self.craft.east, self.craft.north), self._sea)

    @property
    def above_sea(self) -> float:
        """Metres over the zero of elevations."""
        return self.craft.up + self.plot.base

    @property
    def _sea(self) -> float:
        """The sea's height over height 0; far below where there is none."""
        return self.plot.view.sea_level - self.plot.base if self.plot.view.sea else -math.inf

    def floor(self, east: float, north: float) -> float:
        """Return the height that the craft may not go below [m above height 0], clearance aside."""
        return max(self.parts.ground_at(east, north), self._sea)

    # ── what happens ─────────────────────────────────────────────────────────

    def step(self, moment: Moment | Controls = LEVEL, parts: int = PARTS_A_STEP) -> None:
        """Fly a sixtieth of a second, and make at most so many parts besides those under the craft."""
        if isinstance(moment, Controls):
            moment = Moment(moment)
        if moment.reset:
            self.craft = replace(self._first, steps=self.craft.steps)
            self.set_hour(self._first_hour)
        if moment.hour is not None:
            self.set_hour(moment.hour)
        self.craft = stepped(self.craft, moment.controls, self.floor)
        if moment.reset or self.craft.steps % SKY_STEPS == 0:
            self._earlier = self.craft
        self._look()
        self.parts.tend(parts)

    def set_hour(self, hour: float) -> None:
        """Set the time of day; the light of the parts follows as they are tended."""
        if self.plot.hour and hour % 24.0 != self.parts.hour:
            self.parts.hour = hour % 24.0
            _take_daylight(self.engine, self.plot, self.parts.hour, self.scene)

    def make_all(self) -> int:
        """Make every part that is wanted here; return how many."""
        return self.parts.tend(self.parts.limit)

    # ── another sketch ───────────────────────────────────────────────────────

    @property
    def changing(self) -> bool:
        """Whether another sketch is being prepared."""
        return self._next is not None

    def change(self, sketch: Sketch) -> None:
        """Prepare another sketch, to fly on over it from the same place; what is visible stays until then.

        The time of day stays, unless the sketch has another than the one before. Raises
        ``SketchError`` where it cannot be flown over: then nothing changes.
        """
        self.drop_change()
        plot = plot_of(sketch, self.engine)
        parts = Parts(self.engine, plot, self.parts.radius)
        try:
            scene = Scene(self.engine, plot, self.scene.samples)
        except Exception:
            parts.release()
            raise
        parts.hour = self.hour if plot.first_hour() == self.plot.first_hour() else plot.first_hour()
        self._next = _Next(sketch, plot, parts, scene)

    def tend_change(self, seconds: float) -> bool:
        """Make the other sketch's parts for so long; return whether it has replaced this one.

        Raises ``PlaygroundError`` where a part cannot be made: then this one stays.
        """
        upcoming = self._next
        if upcoming is None:
            return False
        try:
            upcoming.parts.look(self.craft.east, self.craft.north, self.craft.heading)
            upcoming.parts.tend_for(seconds)
            if upcoming.parts.missing:
                return False
            _take_daylight(self.engine, upcoming.plot, upcoming.parts.hour, upcoming.scene)
        except Exception:
            self.drop_change()
            raise
        self._next = None
        self.parts.release()
        self.scene.release()
        self.sketch, self.plot, self.parts, self.scene = upcoming
        self._first_hour = self.plot.first_hour()
        floor = self.floor(self.craft.east, self.craft.north) + CLEARANCE
        self.craft = replace(self.craft, up=max(self.craft.up, floor))
        return True

    def drop_change(self) -> None:
        """Drop the other sketch, if one is being prepared."""
        upcoming, self._next = self._next, None
        if upcoming is not None:
            upcoming.parts.release()
            upcoming.scene.release()

    # ── pictures ─────────────────────────────────────────────────────────────

    def draw(self, size: tuple[int, int], *, bare: bool = False) -> moderngl.Texture:
        """Draw the view and return its texture, rgba8, valid until the next draw."""
        craft = self.craft
        lens = through(craft, size, (self.parts.radius + 1.5) * self.plot.width)
        eye = (craft.east, craft.north, craft.up)
        old = self._earlier if turned(self._earlier, craft) < TURNED else craft
        wide = through(old, size, _FAR_SKY, WIDER_VIEW)
        before = Before((old.east, old.north, old.up), wide, old.seconds)
        bound = self.engine.ctx.fbo
        try:
            seconds = craft.seconds
            return self.scene.draw(self.parts, eye, lens, size, seconds=seconds, before=before, bare=bare)
        finally:
            if bound is not None and _is_alive(bound):
                bound.use()

    def picture(self, size: tuple[int, int]) -> Frame:
        """Return the view as a picture that saves itself."""
        return Frame(read_picture(self.draw(size)), self.sketch.name, self.craft.seconds)

    def _look(self) -> None:
        self.parts.look(self.craft.east, self.craft.north, self.craft.heading)

    def _placed(self, start: Start | None) -> Craft:
        if start is None:
            middle = self.plot.width / 2
            up = self.floor(middle, middle) + START_ABOVE
            return Craft(middle, middle, up)
        up = max(start[2], self.floor(start[0], start[1]) + CLEARANCE)
        return Craft(start[0], start[1], up, math.radians(start[3]) % math.tau)


class _Next(NamedTuple):
    """What a flight continues over, once it is ready."""

    sketch: Sketch
    plot: Plot
    parts: Parts
    scene: Scene


def _take_daylight(engine: Engine, plot: Plot, hour: float, scene: Scene) -> None:
    if plot.light.has_daylight:
        scene.take_daylight(engine.texture(plot.at((0, 0), hour), "daylight"))


def _is_alive(framebuffer: moderngl.Framebuffer) -> bool:
    import moderngl

    return not isinstance(framebuffer.mglo, moderngl.InvalidObject)


# ── flown again ────────────────────────────────────────────────────────────────


EVERY = 6
"""Steps from one picture to the next: ten pictures for each second flown."""


def fly_again(
    engine: Engine, sketch: Sketch, record: Record, *, every: int = 0, samples: int | None = None
) -> Iterator[Flight]:
    """Fly a record; yield the flight at its start, then after every so many steps, 0 for its end only.

    Parts are made by number, not by time: the pictures do not depend on the machine's speed.
    """
    header = record.header
    with Flight(engine, sketch, radius=header.radius, start=header.start, samples=samples) as flight:
        flight.make_all()
        yield flight
        for number, moment in enumerate(record, 1):
            flight.step(moment, PARTS_A_STEP)
            if moment.hour is not None or moment.reset:
                flight.make_all()  # no picture shows two times of day
            if (every and number % every == 0) or (not every and number == record.steps):
                yield flight


def write_frames(
    engine: Engine,
    sketch: Sketch,
    record: Record,
    folder: str | Path,
    *,
    every: int = EVERY,
    size: tuple[int, int] | None = None,
    done: Callable[[], None] = lambda: None,
) -> list[Path]:
    """Write the pictures of a flight, each complete or not at all, and return their paths.

    They are named by their steps, ``frame-000120.png``; ``done`` is called after each.
    """
    if every < 1:
        raise ParameterError(f"every {every} steps: expected a whole number from 1")
    target = make_folder(Path(folder).expanduser())
    _refuse_others(target, {f"frame-{n * every:06d}.png" for n in range(count_frames(record, every))})
    written = []
    for flight in fly_again(engine, sketch, record, every=every):
        path = target / f"frame-{flight.craft.steps:06d}.png"
        flight.picture(size or record.header.size).save(path)
        written.append(path)
        done()
    return written


def _refuse_others(folder: Path, expected: set[str]) -> None:
    """Raise ``DataError`` where there are pictures of another flight among those of this one."""
    others = sorted({path.name for path in folder.glob("frame-*.png")} - expected)
    if others:
        raise DataError(
            f"holds {others[0]} of another flight; choose a folder without such pictures", file=str(folder)
        )


def count_frames(record: Record, every: int) -> int:
    """Return how many pictures that gives."""
    return 1 + record.steps // every
