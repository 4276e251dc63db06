"""The texel that a window traces, in one small file of the user's state folder, for editors that show values.

The window writes it whole or not at all, and removes it when it traces nothing more; of several windows the
last one counts. What reads it traces by itself.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from playground.errors import PlaygroundError
from playground.files import write_file
from playground.paths import state_folder
from playground.sketch.model import Value

_FORMAT = 1
_MAX_BYTES = 2**18


@dataclass(frozen=True, slots=True)
class LiveTexel:
    """A texel of a pass, and the picture that it is of."""

    sketch: str  # absolute path of what is open: a sketch, a shader
    path: str  # of the pass: "height.detail"
    texel: tuple[int, int]  # column and row, from the south-west
    iteration: int | None = None  # of a pass that repeats, from 0; None: the last
    size: tuple[int, int] | None = None  # of the picture [pixels]; None: as it is drawn without one
    time: float = 0.0  # [s]
    values: tuple[tuple[str, Value], ...] = ()  # that no file sets, by path


def live_file(folder: Path | None = None) -> Path:
    """Return the file, in the user's state folder unless another is named."""
    return (folder or state_folder()) / "traced_texel.json"


def write_live_texel(texel: LiveTexel | None, file: Path) -> None:
    """Write the texel that is traced, or remove the file; where that cannot be done, it is left as it is."""
    try:
        if texel is None:
            file.unlink(missing_ok=True)
            return
        file.parent.mkdir(parents=True, exist_ok=True)
        write_file(file, json.dumps({"format": _FORMAT, **asdict(texel), "values": dict(texel.values)}))
    except (OSError, PlaygroundError):
        return  # a convenience for editors: the window shows the trace itself


def read_live_texel(file: Path) -> LiveTexel | None:
    """Return the texel that a window traces; None where none does, and for what cannot be read."""
    try:
        with file.open("rb") as stream:
            table = json.loads(stream.read(_MAX_BYTES))
        if table["format"] != _FORMAT:
            return None
        iteration, size = table["iteration"], table["size"]
        return LiveTexel(
            sketch=_of(str, table["sketch"]),
            path=_of(str, table["path"]),
            texel=_pair(table["texel"]),
            iteration=None if iteration is None else _of(int, iteration),
            size=None if size is None else _pair(size),
            time=float(table["time"]),
            values=tuple((name, _value(value)) for name, value in table["values"].items()),
        )
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return None  # nothing is traced, or the file is another version's


def _of(kind: type, value: Any) -> Any:
    if not isinstance(value, kind):
        raise TypeError
    return value


def _pair(value: Any) -> tuple[int, int]:
    first, second = value
    return _of(int, first), _of(int, second)


def _value(value: Any) -> Value:
    if isinstance(value, list):
        return tuple(_of((int, float), part) for part in value)  # type: ignore[arg-type]
    return _of((bool, int, float, str), value)  # type: ignore[arg-type, no-any-return]
