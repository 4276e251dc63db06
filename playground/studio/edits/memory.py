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
from collections.abc import Callable
from dataclasses import asdict, dataclass, field, is_dataclass, replace
from itertools import repeat
from pathlib import Path
from typing import IO, Any, cast, get_args, get_origin, get_type_hints

from playground.errors import DataError, PlaygroundError
from playground.files import new_name, read_regular, write_file
from playground.json_text import read_json
from playground.sketch.model import Camera, Value
from playground.studio.edits.edits import Edits, FileValue, StoredEdits
from playground.studio.language import tr
from playground.studio.picture.view import Kept


def set_aside(path: Path, what: str, error: Exception) -> str:
    """Rename a file to ``NAME.unread.json``, numbered where that is taken; return a message that reports it.

    ``what`` was remembered in it, as the message begins; ``error`` is why it cannot be read.
    """
    why = f" ({error})" if str(error) else ""
    try:
        with new_name(path.with_suffix(".unread.json")) as aside:
            path.replace(aside)
    except (OSError, PlaygroundError):
        return tr("{what} cannot be read and cannot be set aside: {path}{why}", what=what, path=path, why=why)
    return tr("{what} cannot be read; it is kept in {aside}{why}", what=what, aside=aside, why=why)


FORMAT = 1
_MAX_SIDE = 16384  # of a window, in the screen's units
_MAX_BYTES = 4 * 2**20  # [bytes] no session sets so much by the user


@dataclass(frozen=True)
class Compared:
    """The A that what is shown was compared with, and how."""

    edits: Edits
    steps: tuple[tuple[str, int], ...] = ()
    mode: str = "divider"
    split: float = 0.5  # fraction of the picture's width where the two meet
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
    kept: Kept = field(default_factory=Kept)  # views, places of nodes, the look

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
            return Remembered(), set_aside(self.path, tr("what was remembered of this sketch"), error)

    def write(self, remembered: Remembered) -> None:
        """Write it, or remove the file where there is nothing to remember; raise ``DataError``."""
        if remembered.is_default and remembered.window == (0, 0):
            with contextlib.suppress(OSError):
                self.path.unlink(missing_ok=True)
            return
        table = {"format": FORMAT, "sketch": self.sketch, **asdict(remembered)}
        text = json.dumps(table, indent=1, ensure_ascii=False)
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
        if not locked(lock):
            lock.close()
            return False
        self._lock = lock
        return True

    def close(self) -> None:
        """Let others write."""
        if self._lock is not None:
            self._lock.close()
            self._lock = None


def locked(file: IO[bytes]) -> bool:
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


def _read(table: Any) -> Remembered:
    """Return what a file says; raise ``ValueError``, ``TypeError`` or ``KeyError`` for another's."""
    if table["format"] != FORMAT:
        raise ValueError(f"it has format {table['format']}, and this version knows {FORMAT}")
    remembered: Remembered = typed(Remembered, table)
    if not (0 < min(remembered.window) and max(remembered.window) <= _MAX_SIDE):
        remembered = replace(remembered, window=(0, 0))
    return replace(remembered, time=max(remembered.time, 0.0))


def typed(kind: Any, value: Any) -> Any:
    """Return plain data of JSON as a type: a record's fields by name, tuples as lists, finite numbers.

    Fields that are missing have their defaults. Raises ``TypeError`` or ``ValueError`` for what is another.
    """
    kinds = get_args(kind)
    if is_dataclass(kind):
        record, types = cast(Callable[..., Any], kind), get_type_hints(kind)
        return record(**{name: typed(types[name], value[name]) for name in types if name in value})
    if get_origin(kind) is tuple:
        if not isinstance(value, list):
            raise TypeError(f"{value!r} is no list")
        repeated = kinds[-1] is ...
        return tuple(
            typed(kinds[0] if repeated else part, each)
            for part, each in zip(repeat(None) if repeated else kinds, value, strict=not repeated)
        )
    if kinds:  # of several types; a list is of whole numbers where all of them are
        if value is None and type(None) in kinds:
            return None
        if isinstance(value, list):
            wholes = all(type(number) is int for number in value)
            return typed(tuple[int, ...] if wholes else tuple[float, ...], value)
        records = [part for part in kinds if is_dataclass(part)]
        return typed(records[0] if records else type(value), value)
    if kind is float and type(value) in (int, float):
        if not math.isfinite(value):
            raise ValueError(f"{value} is no number to set")
        return float(value)
    if type(value) is not kind or kind not in (bool, int, str):
        raise TypeError(f"{value!r} is no {kind}")
    return value
