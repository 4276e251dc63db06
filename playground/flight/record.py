"""Write down a flight as JSON lines, and read it back: a header, then what the hands did, step by step.

A line of controls is ``[steps, throttle, pitch, roll, yaw]``, in hundredths, for so many
steps alike; ``{"hour": 17.5}`` sets the time of day before the next step, and
``{"reset": true}`` goes back to the start. The file can be read while it is being written, and
after a flight that ended in the middle of a line: that line is left out.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import IO, Any

from playground.errors import DataError
from playground.flight.craft import STEP, Controls
from playground.json_text import read_json

FORMAT, VERSION = "playground flight", 1
LEAST_RADIUS, MOST_RADIUS = 1.5, 16.0  # [parts] seen: nearer, the end of the land would show
LONGEST = 60 * 60 * 24  # [steps] of one line, and lines are so few that no file takes for ever
SAVED_EVERY = 60  # [steps] alike after which they are written, lest a flight that ends badly be lost
_MOST_STEPS = 60 * 60 * 60 * 100


@dataclass(frozen=True)
class Header:
    """What a flight stands on."""

    sketch: str  # as the command line takes it
    size: tuple[int, int] = (640, 360)  # [pixels] of its pictures
    values: dict[str, Any] = field(default_factory=dict)  # by path, as --set
    radius: float = 5.0  # [parts] seen
    start: tuple[float, float, float, float] | None = None  # east, north, up [m], heading [degrees]

    def line(self) -> str:
        """Return it as the first line of a record."""
        return json.dumps(
            {
                "format": FORMAT,
                "version": VERSION,
                "sketch": self.sketch,
                "size": list(self.size),
                "step": STEP,
                "radius": self.radius,
                "values": self.values,
                "start": list(self.start) if self.start else None,
            }
        )


@dataclass(frozen=True, slots=True)
class Moment:
    """One step of a record: the hands, and what was asked for just before."""

    controls: Controls
    hour: float | None = None
    reset: bool = False


class Recorder:
    """Writes a flight; steps alike become one line. Use it with ``with``, or call ``close()``.

    Raises ``DataError`` where there is a file already, or none can be written.
    """

    def __init__(self, path: str | Path, header: Header) -> None:
        self.path = Path(path).expanduser()
        self._alike = (0, Controls())
        try:
            if self.path.is_file() and self.path.stat().st_size > 0:
                raise DataError("is there already; a flight is written to a new file", file=str(path))
            self._file: IO[str] = self.path.open("w", encoding="utf-8")
        except OSError as error:
            raise self._unwritten(error) from None
        try:
            self._write(header.line())
        except DataError:
            with contextlib.suppress(OSError):
                self._file.close()
            raise

    def __enter__(self) -> Recorder:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def add(self, moment: Moment) -> None:
        """Write down one step."""
        count, last = self._alike
        if moment.hour is not None or moment.reset or moment.controls != last or count >= SAVED_EVERY:
            self._flush()
            count = 0
            if moment.reset:
                self._write('{"reset": true}')
            if moment.hour is not None:
                self._write(json.dumps({"hour": moment.hour}))
        self._alike = (count + 1, moment.controls)

    def close(self) -> None:
        """Write what is left, and close the file."""
        if not self._file.closed:
            try:
                self._flush()
            finally:
                with contextlib.suppress(OSError):  # what could not be written has been said
                    self._file.close()

    def _flush(self) -> None:
        count, controls = self._alike
        self._alike = (0, controls)
        if count:
            self._write(json.dumps([count, *controls.values]))

    def _write(self, line: str) -> None:
        try:
            self._file.write(line + "\n")
            self._file.flush()
        except OSError as error:
            raise self._unwritten(error) from None

    def _unwritten(self, error: OSError) -> DataError:
        return DataError(f"cannot be written: {error.strerror}", file=str(self.path))


@dataclass(frozen=True)
class Record:
    """A flight that was written down."""

    header: Header
    lines: tuple[tuple[int, Moment], ...]  # how many steps alike

    @property
    def steps(self) -> int:
        """Steps in all."""
        return sum(count for count, _ in self.lines)

    def __iter__(self) -> Iterator[Moment]:
        """Yield step by step."""
        for count, moment in self.lines:
            yield moment
            for _ in range(count - 1):
                yield Moment(moment.controls)


def read_record(path: str | Path) -> Record:
    """Read a flight; raise ``DataError`` naming the line that is wrong."""
    try:
        text = Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise DataError(f"cannot be read: {error.strerror}", file=str(path)) from None
    except UnicodeDecodeError:
        raise DataError("is no text; expected a flight as --record writes it", file=str(path)) from None
    rows = text.split("\n")
    if len(rows) > 1 and rows[-1] and not _is_json(rows[-1]):
        rows.pop()  # cut while it was written
    header = _header(_json(rows[0], path, 1), path)
    lines: list[tuple[int, Moment]] = []
    hour: float | None = None
    reset, total = False, 0
    for number, row in enumerate(rows[1:], 2):
        if not row.strip():
            continue
        found = _json(row, path, number)
        if isinstance(found, dict) and set(found) == {"hour"} and _is_number(found["hour"]):
            hour = float(found["hour"]) % 24.0
        elif isinstance(found, dict) and found == {"reset": True}:
            reset = True
        elif isinstance(found, list) and len(found) == 5 and all(_is_whole(n) for n in found):
            count, controls = found[0], Controls(*found[1:])
            if not 1 <= count <= LONGEST or controls != controls.within():
                raise DataError(
                    f"{row.strip()[:60]}: expected 1 to {LONGEST} steps and controls from -100 to 100",
                    file=str(path),
                    line=number,
                )
            total += count
            lines.append((count, Moment(controls, hour, reset)))
            hour, reset = None, False
        else:
            raise DataError(
                f"{row.strip()[:60]}: expected [steps, throttle, pitch, roll, yaw] in whole numbers, "
                'or {"hour": 17.5}, or {"reset": true}',
                file=str(path),
                line=number,
            )
        if total > _MOST_STEPS:
            raise DataError("is longer than a hundred hours", file=str(path), line=number)
    return Record(header, tuple(lines))


def _is_json(row: str) -> bool:
    try:
        read_json(row)
    except ValueError:
        return False
    return True


def _json(row: str, path: str | Path, number: int) -> Any:
    try:
        return read_json(row)
    except ValueError as error:
        if number == 1:
            raise _no_record(path) from None
        why = "is no JSON" if isinstance(error, json.JSONDecodeError) else str(error)
        raise DataError(f"{row.strip()[:60]}: {why}", file=str(path), line=number) from None


def _no_record(path: str | Path) -> DataError:
    return DataError(
        f'is no flight: its first line should be {{"format": "{FORMAT}", …}}, as --record writes it',
        file=str(path),
        line=1,
    )


def _header(found: Any, path: str | Path) -> Header:
    if not isinstance(found, dict) or found.get("format") != FORMAT:
        raise _no_record(path)
    if found.get("version") != VERSION:
        raise DataError(
            f"is a flight of version {found.get('version')}; this playground reads version {VERSION}",
            file=str(path),
            line=1,
        )
    size, start, values = found.get("size"), found.get("start"), found.get("values")
    good = (
        isinstance(found.get("sketch"), str)
        and isinstance(size, list)
        and len(size) == 2
        and all(_is_whole(n) and 1 <= n <= 16384 for n in size)
        and isinstance(values, dict)
        and _is_number(found.get("radius"))
        and LEAST_RADIUS <= found["radius"] <= MOST_RADIUS
        and (start is None or (isinstance(start, list) and len(start) == 4 and all(map(_is_number, start))))
    )
    if not good or not isinstance(size, list) or not isinstance(values, dict):
        raise DataError(
            "its first line should have sketch, size, radius, values and start, as --record writes them",
            file=str(path),
            line=1,
        )
    if not _is_number(found.get("step")) or abs(found["step"] - STEP) > 1e-9:
        raise DataError(
            f"has steps of {found.get('step')} s; this playground flies in steps of 1/60 s",
            file=str(path),
            line=1,
        )
    place = (start[0], start[1], start[2], start[3]) if start else None
    return Header(found["sketch"], (size[0], size[1]), values, float(found["radius"]), place)


def _is_whole(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e12
