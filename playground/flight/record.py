"""Record a flight as JSON lines, and read it back: a header, then the pilot's input, step by step.

A line of controls is ``[steps, throttle, pitch, roll, yaw]``, in hundredths, for so many
steps alike; ``{"hour": 17.5}`` sets the time of day before the next step, and
``{"reset": true}`` goes back to the start. The file can be read while it is being written, and
after a flight that ended in the middle of a line: that line is left out.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from types import TracebackType
from typing import IO, Any, TypeGuard

from playground.errors import DataError
from playground.files import read_regular
from playground.flight.craft import STEP, Controls
from playground.json_text import read_json

FORMAT, VERSION = "playground flight", 1
MIN_RADIUS, MAX_RADIUS = 1.5, 16.0  # [parts] visible: nearer, the end of the terrain would show
MAX_STEPS_A_LINE = 60 * 60 * 24  # [steps] of one line: no file takes for ever to read
SAVED_EVERY = 60  # [steps] alike after which they are written, so that a crash loses no more
_MAX_STEPS = 60 * 60 * 60 * 100


@dataclass(frozen=True)
class Header:
    """What a flight is recorded over."""

    sketch: str  # as the command line takes it
    size: tuple[int, int] = (640, 360)  # [pixels] of its pictures
    values: dict[str, Any] = field(default_factory=dict)  # by path, as --set
    radius: float = 5.0  # [parts] visible
    start: tuple[float, float, float, float] | None = None  # east, north, up [m], heading [degrees]

    def line(self) -> str:
        """Return it as the first line of a record."""
        return json.dumps({"format": FORMAT, "version": VERSION, "step": STEP} | asdict(self))


@dataclass(frozen=True, slots=True)
class Moment:
    """One step of a record: the controls, and what was set just before."""

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
        """Record one step."""
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
                with contextlib.suppress(OSError):  # the error is raised already
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
    """A recorded flight."""

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
        text = read_regular(Path(path)).decode()
    except OSError as error:
        raise DataError(f"cannot be read: {error.strerror}", file=str(path)) from None
    except UnicodeDecodeError:
        raise DataError("is no text; expected a flight as --record writes it", file=str(path)) from None
    rows = text.split("\n")
    if len(rows) > 1 and rows[-1] and not _is_json(rows[-1]):
        rows.pop()  # cut while it was written
    with _at_line(path, 1):
        header = _header(rows[0])
    lines: list[tuple[int, Moment]] = []
    hour: float | None = None
    reset, total = False, 0
    for number, row in enumerate(rows[1:], 2):
        if not row.strip():
            continue
        with _at_line(path, number):
            row_value = _json(row)
            if isinstance(row_value, dict) and set(row_value) == {"hour"} and _is_number(row_value["hour"]):
                hour = float(row_value["hour"]) % 24.0
            elif isinstance(row_value, dict) and row_value == {"reset": True}:
                reset = True
            else:
                count, controls = _steps(row_value, row)
                total += count
                lines.append((count, Moment(controls, hour, reset)))
                hour, reset = None, False
            if total > _MAX_STEPS:
                raise ValueError("is longer than a hundred hours")
    return Record(header, tuple(lines))


@contextlib.contextmanager
def _at_line(path: str | Path, number: int) -> Iterator[None]:
    """Raise ``DataError`` at a line for what is wrong with it."""
    try:
        yield
    except ValueError as error:
        raise DataError(str(error), file=str(path), line=number) from None


def _steps(value: Any, row: str) -> tuple[int, Controls]:
    """Return how many steps of which controls a line holds; raise ``ValueError``."""
    if not (isinstance(value, list) and len(value) == 5 and all(map(_is_whole, value))):
        raise ValueError(
            f"{row.strip()[:60]}: expected [steps, throttle, pitch, roll, yaw] in whole numbers, "
            'or {"hour": 17.5}, or {"reset": true}'
        )
    count, controls = value[0], Controls(*value[1:])
    if not 1 <= count <= MAX_STEPS_A_LINE or controls != controls.within():
        raise ValueError(
            f"{row.strip()[:60]}: expected 1 to {MAX_STEPS_A_LINE} steps and controls from -100 to 100"
        )
    return count, controls


def _is_json(row: str) -> bool:
    try:
        read_json(row)
    except ValueError:
        return False
    return True


def _json(row: str) -> Any:
    try:
        return read_json(row)
    except ValueError as error:
        why = "is no JSON" if isinstance(error, json.JSONDecodeError) else str(error)
        raise ValueError(f"{row.strip()[:60]}: {why}") from None


def _header(row: str) -> Header:
    """Return the header of a record; raise ``ValueError``."""
    document = read_json(row) if _is_json(row) else None
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise ValueError(
            f'is no flight: its first line should be {{"format": "{FORMAT}", …}}, as --record writes it'
        )
    if (version := document.get("version")) != VERSION:
        raise ValueError(f"is a flight of version {version}; this playground reads version {VERSION}")
    sketch, values, radius = (document.get(key) for key in ("sketch", "values", "radius"))
    size, start = _tuple(document.get("size"), 2), _tuple(document.get("start"), 4)
    if (
        not isinstance(sketch, str)
        or not all(_is_whole(n) and 1 <= n <= 16384 for n in size)
        or not size
        or not isinstance(values, dict)
        or not (_is_number(radius) and MIN_RADIUS <= radius <= MAX_RADIUS)
        or not (all(map(_is_number, start)) and (start or document.get("start") is None))
    ):
        raise ValueError(
            "its first line should have sketch, size, radius, values and start, as --record writes them"
        )
    step = document.get("step")
    if not _is_number(step) or abs(step - STEP) > 1e-9:
        raise ValueError(f"has steps of {step} s; this playground flies in steps of 1/60 s")
    return Header(sketch, size, values, float(radius), start or None)


def _tuple(value: Any, length: int) -> Any:
    """Return a list of a length as a tuple, anything else as an empty one."""
    return tuple(value) if isinstance(value, list) and len(value) == length else ()


def _is_whole(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e12
