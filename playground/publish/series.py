"""Many pictures of a sketch, one after another: at each time of a film, or with each value of a sweep.

Picture n of a film is that of the time ``n / fps``, independent of the machine's speed; what a
sketch's keyframes, its text or its repeats make of the time is theirs. The terrain and its
light are computed again only where they change from picture to picture, and nothing that later ones do
not use stays in the cache.

``write_series`` draws a series into a sink: a video (``video``), numbered files (``sequence``) or a sheet
(``sheet``).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from playground.api import headless
from playground.engine.engine import Engine
from playground.errors import ParameterError
from playground.publish.sweep import DEFAULT_STEPS, MAX_PICTURES, Swept, columns_of, combinations, read_sweep
from playground.sketch.load import opened
from playground.sketch.model import FPS as FPS
from playground.sketch.model import Sketch
from playground.sketch.traits import traits_of

SWEEP_FPS = 4
"""Pictures a second of a sweep."""
DEFAULT_SIZE = (1280, 720)
SWEEP_SIZE = (320, 180)
"""Width and height in pixels of a picture of a sweep."""
MAX_FRAMES = 1_000_000


@dataclass(frozen=True, kw_only=True)
class Series:
    """A sketch at several times or, where it has ``cases``, at one time with several values."""

    sketch: Sketch
    count: int  # pictures
    size: tuple[int, int]  # [pixels]
    fps: Fraction
    start: float = 0.0  # [s] of the first picture
    steps: Mapping[str, int] | None = None  # as in ``Engine.render``
    cases: tuple[Swept, ...] = ()  # of a sweep, a sketch for each picture
    columns: int = 1  # pictures of a sweep side by side

    @classmethod
    def at_times(
        cls,
        sketch: Sketch | str | Path,
        *,
        seconds: float | None = None,
        fps: float | Fraction = FPS,
        size: tuple[int, int] = DEFAULT_SIZE,
        start: float = 0.0,
        steps: Mapping[str, int] | None = None,
    ) -> Series:
        """Return the film of a sketch: ``seconds`` long, else from ``start`` to its last keyframe.

        Raises ``ParameterError`` for a film of no picture, or of more than a million.
        """
        loaded, rate = opened(sketch), rate_of(fps)
        if not Fraction(1, 60) <= rate <= 1000:
            raise ParameterError(f"{float(fps):g} pictures a second: expected 1/60 to 1000")
        if seconds is None:
            seconds = loaded.duration - start
            if seconds <= 0.0:
                raise ParameterError(
                    f"how long? sketch {loaded.name} has no keyframe after {start:g} s; say how many seconds"
                )
        count = round(Fraction(seconds) * rate) if abs(seconds) < 1e7 else 0
        if not 1 <= count <= MAX_FRAMES:
            raise ParameterError(
                f"{seconds:g} s at {float(rate):g} pictures a second: expected 1 to {MAX_FRAMES} pictures"
            )
        return cls(sketch=loaded, count=count, fps=rate, size=size, start=start, steps=steps)

    @classmethod
    def of_values(
        cls,
        sketch: Sketch | str | Path,
        sweeps: Sequence[str],
        *,
        steps: int = DEFAULT_STEPS,
        fps: Fraction = Fraction(SWEEP_FPS),
        size: tuple[int, int] = SWEEP_SIZE,
        time: float = 0.0,
    ) -> Series:
        """Return a sketch with each value of a sweep, or of two that make a grid, row by row.

        The first sweep goes along a row. ``sweeps`` and ``steps`` as ``read_sweep`` takes them. Raises
        ``ParameterError`` for what they do not say right, for more than two sweeps, for two of one
        parameter's same part, and for more than 400 pictures.
        """
        base = opened(sketch).at(time)
        read = [read_sweep(base, text, steps) for text in sweeps]
        if not 1 <= len(read) <= 2:
            raise ParameterError(f"{len(read)} sweeps: expected one, or two that make a grid")
        if len({sweep.path for sweep in read}) < len(read):
            raise ParameterError(f"two sweeps of {read[0].path}: expected two parameters")
        count, along = math.prod(len(sweep.values) for sweep in read), len(read[0].values)
        if count > MAX_PICTURES:
            raise ParameterError(f"{count} pictures are more than the {MAX_PICTURES} that a sheet may have")
        return cls(
            sketch=base,
            count=count,
            size=size,
            fps=fps,
            start=time,
            cases=combinations(base, read),
            columns=along if len(read) == 2 else columns_of(along),
        )

    def time(self, number: int) -> float:
        """Return the time in seconds of a picture, from 0."""
        return self.start if self.cases else self.start + float(number / self.fps)

    def picture(self, engine: Engine, number: int) -> Picture:
        """Return a picture, from 0, that ``engine`` draws."""
        sketch = self.cases[number].sketch if self.cases else self.sketch
        at = {"size": self.size, "time": self.time(number), "steps": self.steps}
        return Picture(engine, number, sketch, at)

    @property
    def still(self) -> str:
        """Return a message where all pictures are the same, since nothing depends on the time; else ""."""
        traits, first, last = traits_of(self.sketch), self.time(0), self.time(self.count - 1)
        if self.cases or self.count == 1 or traits.moves or traits.devices:
            return ""
        times = (last, *(frame.time for frame in self.sketch.keyframes if first < frame.time < last))
        if any(self.sketch.at(time) != self.sketch.at(first) for time in times):
            return ""
        what = "no keyframe changes anything" if self.sketch.keyframes else "it has no keyframes"
        return (
            f"all {self.count} pictures are the same: "
            f"nothing in sketch {self.sketch.name} depends on the time, and {what}"
        )


@dataclass(frozen=True)
class Picture:
    """One picture of a series, drawn when a sink asks for it."""

    engine: Engine
    number: int  # from 0
    sketch: Sketch
    at: dict[str, Any]  # its size, time and steps, as ``Engine.render`` takes them

    @property
    def array(self) -> NDArray[np.uint8]:
        """The picture, (height, width, 4), top row first, sRGB and alpha."""
        return self.engine.render(self.sketch, **self.at).array


class Sink(Protocol):
    """What a series is written into: files that are whole or not there."""

    @property
    def paths(self) -> Sequence[Path]:
        """The files."""

    def open(self, series: Series, notice: Callable[[str], None]) -> AbstractContextManager[Add]:
        """Take the pictures of a series in the block, and write the file at its end.

        ``notice`` is called with a message where something of them was lost. Raises ``PlaygroundError`` for
        what cannot be written.
        """


Add = Callable[[Picture], None]
"""Takes the next picture."""


def write_series(
    engine: Engine,
    series: Series,
    sink: Sink,
    *,
    numbers: Iterable[int] | None = None,
    done: Callable[[], None] = lambda: None,
    notice: Callable[[str], None] = lambda _: None,
) -> None:
    """Draw the pictures of a series into a sink, one by one.

    ``numbers`` are those of the pictures, all unless given. ``done`` is called after each, and may raise to
    stop; ``notice`` with a message where all are the same, and with those of the sink.
    """
    if series.still:
        notice(series.still)
    with sink.open(series, notice) as add, _frame_delta(engine, series):
        for number in range(series.count) if numbers is None else numbers:
            add(series.picture(engine, number))
            engine.forget_unused()
            done()


@contextmanager
def _frame_delta(engine: Engine, series: Series) -> Iterator[None]:
    """Set the time between two pictures of a film for plain shaders, in the block."""
    before = engine.runner.delta
    engine.runner.delta = before if series.cases else float(1 / series.fps)
    try:
        yield
    finally:
        engine.runner.delta = before


def rate_of(fps: float | Fraction) -> Fraction:
    """Return pictures a second as a fraction, as 30000/1001."""
    return fps if isinstance(fps, Fraction) else Fraction(fps).limit_denominator(1001)


def engine_or_own(engine: Engine | None) -> AbstractContextManager[Engine]:
    """Return an engine for a block: the one that is given, or one that is opened for it."""
    return headless() if engine is None else nullcontext(engine)
