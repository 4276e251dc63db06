"""The file that remembers which MIDI controllers set which parameters: next to the sketch, readable TOML.

``hills/sketch.toml`` has ``hills/sketch.controllers``, ``shader.frag`` has ``shader.controllers``. A
sketch is shared without it, unless its owner adds it.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from playground.errors import SketchError
from playground.files import write_file
from playground.sketch.toml_table import FORMAT, TomlFile

ENDING = ".controllers"
KINDS = ("control", "note")
_MAX_BYTES = 2**16  # [bytes]
_KEYS = ("parameter", "part", "channel", *KINDS, "fine")


@dataclass(frozen=True, order=True)
class Source:
    """A knob, fader, key or button of a MIDI device; which device is not looked at."""

    channel: int  # 1 to 16
    kind: str  # one of KINDS
    number: int  # 0 to 127

    def __str__(self) -> str:
        return f"{self.kind} {self.number} of channel {self.channel}"


@dataclass(frozen=True)
class Binding:
    """A parameter, or one part of a vector, that a controller sets."""

    path: str
    part: str  # "": all of it
    source: Source
    fine: bool = False  # 14 bits: the control 32 higher has the lower seven

    @property
    def target(self) -> str:
        """What it sets, in a word."""
        return f"{self.path}, {self.part}" if self.part else self.path


def file_of(sketch: Path) -> Path:
    """Return the file for a sketch's."""
    return sketch.with_suffix(ENDING)


def read_bindings(path: Path) -> tuple[Binding, ...]:
    """Return what a file says, nothing where there is none; raise ``SketchError`` with the line."""
    try:
        if not path.is_file():
            return ()
        size = path.stat().st_size
    except OSError as error:
        raise SketchError(f"cannot be read: {error.strerror or error}", file=path) from None
    if size > _MAX_BYTES:
        raise SketchError(f"larger than {_MAX_BYTES // 1024} KiB: no list of controllers is", file=path)
    file = TomlFile(path, path.parent)
    file.only(file.table, ("format", "controller"))
    file.version(required=False)
    return tuple(_binding(file, table, at) for at, table in enumerate(file.tables("controller")))


def write_bindings(path: Path, bindings: Iterable[Binding]) -> None:
    """Write a file, whole or not at all; remove it where there is nothing to say. Raise ``DataError``."""
    parts = [_text(binding) for binding in bindings]
    if not parts:
        path.unlink(missing_ok=True)
        return
    head = "# MIDI controllers of the sketch next to this file; playground live writes it.\n"
    write_file(path, head + f"format = {FORMAT}\n" + "".join(parts))


def _text(binding: Binding) -> str:
    lines = [f"parameter = {json.dumps(binding.path)}"]
    lines += [f"part = {json.dumps(binding.part)}"] if binding.part else []
    lines += [f"channel = {binding.source.channel}", f"{binding.source.kind} = {binding.source.number}"]
    lines += ["fine = true"] if binding.fine else []
    return "\n[[controller]]\n" + "\n".join(lines) + "\n"


def _binding(file: TomlFile, table: dict[str, Any], at: int) -> Binding:
    key_path = "controller", at
    file.only(table, _KEYS, *key_path)
    path = file.take(table, "parameter", str, "", *key_path)
    if not path:
        raise file.error('a controller has a parameter, as parameter = "light.sun"', *key_path)
    kinds = [kind for kind in KINDS if kind in table]
    if len(kinds) != 1:
        raise file.error("a controller has a control or a note, as control = 21", *key_path)
    number = _within(file, table, kinds[0], 0, 127, at)
    fine = file.take(table, "fine", bool, False, *key_path)
    if fine and not (kinds[0] == "control" and number < 32):
        raise file.error("fine = true: only the controls 0 to 31 have 14 bits", *key_path, "fine")
    source = Source(_within(file, table, "channel", 1, 16, at), kinds[0], number)
    return Binding(path, file.take(table, "part", str, "", *key_path), source, fine)


def _within(file: TomlFile, table: dict[str, Any], key: str, low: int, high: int, at: int) -> int:
    number: int = file.take(table, key, int, low if key == "channel" else None, "controller", at)
    if not low <= number <= high:
        raise file.error(f"{key} = {number}: expected {low} to {high}", "controller", at, key)
    return number
