"""Remember of each sketch what was edited, in a file of its own in the user's state folder.

One file a sketch, JSON with a format number, written whole or not at all. Whoever holds
the lock beside it may write: so two windows on one sketch do not take turns in undoing
each other. The system gives the lock back when a process ends, however it ends.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
import sys
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import IO, Any

from playground.errors import DataError
from playground.images.files import replacing
from playground.json_text import read_json
from playground.sketch.model import Camera, Value
from playground.workbench.edit_merge import FileValue
from playground.workbench.edits import Edits
from playground.workbench.resume import StoredEdits

FORMAT = 1
_LARGEST = 4 * 2**20  # [bytes] no session sets so much by the user


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
    in_file: tuple[tuple[str, FileValue], ...] = ()  # what the files said of each value edited
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
    def is_nothing(self) -> bool:
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
        """Return what is remembered, and a sentence if the file cannot be used: it is then set aside."""
        try:
            if not self.path.exists():
                return Remembered(), ""
            if self.path.stat().st_size > _LARGEST:
                raise ValueError(f"it is larger than {_LARGEST // 2**20} MiB")
            return _read(read_json(self.path.read_text(encoding="utf-8"))), ""
        except (
            OSError,
            ValueError,
            TypeError,
            KeyError,
            AttributeError,
            ArithmeticError,
        ) as error:
            aside = self.path.with_suffix(".unread.json")
            with contextlib.suppress(OSError):
                self.path.replace(aside)
            why = f" ({error})" if str(error) else ""
            complaint = f"what was remembered of this sketch cannot be read; it is kept in {aside}{why}"
            return Remembered(), complaint

    def write(self, remembered: Remembered) -> None:
        """Write it, or remove the file where there is nothing to remember; raise ``DataError``."""
        if remembered.is_nothing and remembered.window == (0, 0):
            with contextlib.suppress(OSError):
                self.path.unlink(missing_ok=True)
            return
        text = json.dumps(_written(remembered, self.sketch), indent=1, ensure_ascii=False)
        with replacing(self.path) as file:
            file.write(text.encode("utf-8", "surrogatepass"))

    def claim(self) -> bool:
        """Say whether this process may write; another that may, keeps its right until it ends."""
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
    edits, known = remembered.edits, dict(remembered.in_file)
    table = _edits_written(edits)
    for path, said in known.items():
        if path in table["values"]:
            table["values"][path] |= {"file": said.value, "own": said.own}
    stood = remembered.camera_in_file
    return {
        "format": FORMAT,
        "sketch": sketch,
        **table,
        "camera_in_file": asdict(stood) if stood else None,
        "time": remembered.time,
        "playing": remembered.playing,
        "speed": remembered.speed,
        "loop": list(remembered.loop) if remembered.loop else None,
        "map": remembered.map,
        "map_values": dict(remembered.map_values),
        "steps": dict(remembered.steps),
        "compared": _compared_written(remembered.compared) if remembered.compared else None,
        "window": list(remembered.window),
        "at": list(remembered.at) if remembered.at else None,
    }


def _edits_written(edits: Edits) -> dict[str, Any]:
    return {
        "values": {path: {"value": value} for path, value in edits.values},
        "techniques": dict(edits.techniques),
        "camera": asdict(edits.camera) if edits.camera else None,
        **{name: list(getattr(edits, name)) for name in _lists()},
    }


def _compared_written(compared: Compared) -> dict[str, Any]:
    how = {"mode": compared.mode, "split": compared.split, "gain": compared.gain}
    return {**_edits_written(compared.edits), "steps": dict(compared.steps), **how}


def _lists() -> list[str]:
    """Return the fields of ``Edits`` that are lists of paths."""
    return [f.name for f in fields(Edits) if f.name not in ("values", "techniques", "camera")]


def _read(table: Any) -> Remembered:
    """Return what a file says; raise ``ValueError``, ``TypeError`` or ``KeyError`` for another's."""
    if table["format"] != FORMAT:
        raise ValueError(f"it has format {table['format']}, and this version knows {FORMAT}")
    in_file = tuple(
        (str(path), _file_value(entry)) for path, entry in table["values"].items() if "file" in entry
    )
    width, height = (int(side) for side in table["window"])
    stood, loop, compared, at = (table.get(name) for name in ("camera_in_file", "loop", "compared", "at"))
    return Remembered(
        _edits(table),
        in_file,
        max(_number(table["time"]), 0.0),
        bool(table["playing"]),
        _number(table["speed"]),
        str(table["map"]),
        tuple((str(name), _value(value)) for name, value in table["map_values"].items()),
        _steps(table),
        (width, height) if 0 < min(width, height) and max(width, height) <= 16384 else (0, 0),
        (int(at[0]), int(at[1])) if at is not None else None,
        _camera(stood) if stood is not None else None,
        (_number(loop[0]), _number(loop[1])) if loop is not None else None,
        _compared(compared) if compared is not None else None,
    )


def _file_value(entry: Any) -> FileValue:
    return FileValue(None if entry["file"] is None else _value(entry["file"]), bool(entry.get("own")))


def _edits(table: Any) -> Edits:
    camera = table["camera"]
    return Edits(
        tuple((str(path), _value(entry["value"])) for path, entry in table["values"].items()),
        tuple((str(name), str(use)) for name, use in table["techniques"].items()),
        _camera(camera) if camera is not None else None,
        **{name: tuple(str(path) for path in table.get(name, ())) for name in _lists()},
    )


def _steps(table: Any) -> tuple[tuple[str, int], ...]:
    return tuple((str(path), int(turn)) for path, turn in table["steps"].items())


def _compared(table: Any) -> Compared:
    split = min(max(_number(table["split"]), 0.0), 1.0)
    return Compared(_edits(table), _steps(table), str(table["mode"]), split, _number(table["gain"]))


def _camera(table: Any) -> Camera:
    target = table["target"]
    place = None
    if target is not None:
        east, north, up = (_number(number) for number in target)
        place = (east, north, up)
    numbers = {name: _number(table[name]) for name in ("azimuth", "elevation", "distance", "field_of_view")}
    return Camera(**numbers, target=place)


def _value(given: Any) -> Value:
    if isinstance(given, list):
        return tuple(given) if all(isinstance(n, int) for n in given) else tuple(_number(n) for n in given)
    if isinstance(given, str | bool | int):
        return given
    return _number(given)


def _number(given: Any) -> float:
    number = float(given)
    if not math.isfinite(number):
        raise ValueError(f"{given} is no number to set")
    return number
