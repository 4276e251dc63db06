"""Remember of each sketch what was edited, in a file of its own in the user's state folder.

One file a sketch, JSON with a format number, written whole or not at all. Only the window that
holds the lock file next to it may write, so that two windows on one sketch do not overwrite each
other. The system releases the lock when a process ends, however it ends.

A file that cannot be read is set aside before a new one takes its place.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
import sys
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import IO, Any

from playground.errors import DataError, PlaygroundError
from playground.files import new_name, read_regular, write_file
from playground.json_text import read_json
from playground.sketch.model import Camera, Value
from playground.studio.edits.edits import Edits, FileValue, StoredEdits


def set_aside(path: Path, what: str, error: Exception) -> str:
    """Rename a file to ``NAME.unread.json``, numbered where that is taken; return a message that reports it.

    ``what`` was remembered in it, as the sentence begins; ``error`` is why it cannot be read.
    """
    why = f" ({error})" if str(error) else ""
    try:
        with new_name(path.with_suffix(".unread.json")) as aside:
            path.replace(aside)
    except (OSError, PlaygroundError):
        return f"{what} cannot be read and cannot be set aside: {path}{why}"
    return f"{what} cannot be read; it is kept in {aside}{why}"


FORMAT = 1
_MAX_BYTES = 4 * 2**20  # [bytes] no session sets so much by the user


@dataclass(frozen=True)
class Compared:
    """The A that what is shown was compared with, and how."""

    edits: Edits
    steps: tuple[tuple[str, int], ...] = ()
    mode: str = "divider"
    split: float = 0.5  # share of the picture's width where the two meet
    gain: float = 8.0  # of the difference


@dataclass(frozen=True)
class Remembered:
    """What is remembered of one sketch."""

    edits: Edits = field(default_factory=Edits)
    in_file: tuple[tuple[str, FileValue], ...] = ()  # what the files set for each edited value
    time: float = 0.0  # [s]
    playing: bool = True
    speed: float = 1.0
    map: str = ""  # the texture shown from above; empty: the sketch's own view
    map_values: tuple[tuple[str, Value], ...] = ()
    steps: tuple[tuple[str, int], ...] = ()
    window: tuple[int, int] = (0, 0)  # in the screen's units; (0, 0): as it opens
    at: tuple[int, int] | None = None  # where its upper left corner is; None: wherever the system puts it
    camera_in_file: Camera | None = None  # the file's, where another was edited
    loop: tuple[float, float] | None = None  # [s] the times between which time goes round
    compared: Compared | None = None

    @property
    def start(self) -> StoredEdits:
        """The edits, as a session takes them to begin with."""
        return StoredEdits(self.edits, dict(self.in_file), self.camera_in_file)

    @property
    def is_default(self) -> bool:
        """Whether it says no more than the sketch does."""
        return replace(self, window=(0, 0), at=None) == Remembered()


class Memory:
    """The file that remembers one sketch."""

    def __init__(self, sketch: Path, folder: Path) -> None:
        whole = str(sketch.resolve())
        digest = hashlib.blake2b(whole.encode("utf-8", "surrogatepass"), digest_size=6).hexdigest()
        self.sketch = whole
        self.path = folder / f"{sketch.stem[:40]}-{digest}.json"
        self._lock: IO[bytes] | None = None

    def read(self) -> tuple[Remembered, str]:
        """Return what is remembered, and a message if the file cannot be used: it is then set aside."""
        try:
            if not self.path.exists():
                return Remembered(), ""
            if self.path.stat().st_size > _MAX_BYTES:
                raise ValueError(f"it is larger than {_MAX_BYTES // 2**20} MiB")
            return _read(read_json(read_regular(self.path).decode())), ""
        except (OSError, ValueError, TypeError, KeyError, AttributeError, ArithmeticError) as error:
            return Remembered(), set_aside(self.path, "what was remembered of this sketch", error)

    def write(self, remembered: Remembered) -> None:
        """Write it, or remove the file where there is nothing to remember; raise ``DataError``."""
        if remembered.is_default and remembered.window == (0, 0):
            with contextlib.suppress(OSError):
                self.path.unlink(missing_ok=True)
            return
        text = json.dumps(_written(remembered, self.sketch), indent=1, ensure_ascii=False)
        write_file(self.path, text.encode("utf-8", "surrogatepass"))

    def claim(self) -> bool:
        """Say whether this process may write; one that may keeps that right until it ends."""
        if self._lock is not None:
            return True
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            lock = self.path.with_suffix(".lock").open("a+b")
        except OSError as error:
            reason = error.strerror or str(error)
            raise DataError(f"cannot be written to: {reason}", file=self.path.parent) from None
        if not _locked(lock):
            lock.close()
            return False
        self._lock = lock
        return True

    def close(self) -> None:
        """Let others write."""
        if self._lock is not None:
            self._lock.close()
            self._lock = None


def _locked(file: IO[bytes]) -> bool:
    """Lock a file without waiting; closing it unlocks it."""
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


def _written(remembered: Remembered, sketch: str) -> dict[str, Any]:
    table = asdict(remembered) | _written_edits(remembered.edits)
    for path, in_file in remembered.in_file:
        if path in table["values"]:
            table["values"][path] |= {"file": in_file.value, "own": in_file.own}
    del table["edits"], table["in_file"]
    table |= {"map_values": dict(remembered.map_values), "steps": dict(remembered.steps)}
    compared = remembered.compared
    if compared is not None:
        table["compared"] |= _written_edits(compared.edits) | {"steps": dict(compared.steps)}
        del table["compared"]["edits"]
    return {"format": FORMAT, "sketch": sketch, **table}


def _written_edits(edits: Edits) -> dict[str, Any]:
    values = {path: {"value": value} for path, value in edits.values}
    return asdict(edits) | {
        "values": values,
        "techniques": dict(edits.techniques),
        "channels": dict(edits.channels),
    }


def _read(table: Any) -> Remembered:
    """Return what a file says; raise ``ValueError``, ``TypeError`` or ``KeyError`` for another's."""
    if table["format"] != FORMAT:
        raise ValueError(f"it has format {table['format']}, and this version knows {FORMAT}")
    in_file = tuple(
        (str(path), _file_value(entry)) for path, entry in table["values"].items() if "file" in entry
    )
    width, height = (int(side) for side in table["window"])
    at, loop = table.get("at"), table.get("loop")
    return Remembered(
        edits=_edits(table),
        in_file=in_file,
        time=max(_number(table["time"]), 0.0),
        playing=bool(table["playing"]),
        speed=_number(table["speed"]),
        map=str(table["map"]),
        map_values=tuple((str(name), _value(value)) for name, value in table["map_values"].items()),
        steps=_steps(table),
        window=(width, height) if 0 < min(width, height) and max(width, height) <= 16384 else (0, 0),
        at=(int(at[0]), int(at[1])) if at is not None else None,
        camera_in_file=_camera(table.get("camera_in_file")),
        loop=(_number(loop[0]), _number(loop[1])) if loop is not None else None,
        compared=_compared(table.get("compared")),
    )


def _file_value(entry: Any) -> FileValue:
    return FileValue(None if entry["file"] is None else _value(entry["file"]), bool(entry.get("own")))


def _edits(table: Any) -> Edits:
    return Edits(
        tuple((str(path), _value(entry["value"])) for path, entry in table["values"].items()),
        tuple((str(name), str(use)) for name, use in table["techniques"].items()),
        _camera(table["camera"]),
        tuple(str(path) for path in table.get("locked", ())),
        tuple((str(path), str(source)) for path, source in table.get("channels", {}).items()),
    )


def _steps(table: Any) -> tuple[tuple[str, int], ...]:
    return tuple((str(path), int(step)) for path, step in table["steps"].items())


def _compared(table: Any) -> Compared | None:
    if table is None:
        return None
    split = min(max(_number(table["split"]), 0.0), 1.0)
    return Compared(_edits(table), _steps(table), str(table["mode"]), split, _number(table["gain"]))


def _camera(table: Any) -> Camera | None:
    if table is None:
        return None
    target_point = None
    if table["target"] is not None:
        east, north, up = (_number(number) for number in table["target"])
        target_point = east, north, up
    numbers = {name: _number(table[name]) for name in ("azimuth", "elevation", "distance", "field_of_view")}
    return Camera(**numbers, target=target_point)


def _value(number: Any) -> Value:
    if isinstance(number, list):
        return tuple(number) if all(isinstance(n, int) for n in number) else tuple(_number(n) for n in number)
    if isinstance(number, str | bool | int):
        return number
    return _number(number)


def _number(value: Any) -> float:
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(f"{value} is no number to set")
    return number
