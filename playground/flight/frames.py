"""Fly a record again without a window, and write pictures of it: a flight as a sequence of shots."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

from playground.engine.engine import Engine
from playground.errors import DataError, ParameterError
from playground.flight.flight import PARTS_A_STEP, Flight
from playground.flight.record import Record
from playground.sketch.model import Sketch

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
    target = prepared(folder)
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


def prepared(folder: str | Path) -> Path:
    """Return the folder, made if it is not there; raise ``DataError`` where it cannot be."""
    path = Path(folder).expanduser()
    try:
        path.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise DataError("is a file; expected a folder to write pictures into", file=str(folder)) from None
    except OSError as error:
        raise DataError(f"cannot be made a folder: {error.strerror}", file=str(folder)) from None
    return path
