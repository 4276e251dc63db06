"""The ways in which editors and archives save a file; ``pause`` is called between their steps."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path

Pause = Callable[[], object]
Save = Callable[[Path, bytes, Pause], None]


def no_pause() -> None:
    """Go on at once."""


def save_in_place(path: Path, data: bytes, pause: Pause = no_pause) -> None:
    path.write_bytes(data)


def save_by_rename(path: Path, data: bytes, pause: Pause = no_pause) -> None:
    temporary = path.with_name(f".{path.name}.tmp")
    temporary.write_bytes(data)
    pause()  # so that its time lies well before the moment when it takes the file's place
    temporary.replace(path)


def save_by_deleting(path: Path, data: bytes, pause: Pause = no_pause) -> None:
    path.unlink(missing_ok=True)
    pause()
    path.write_bytes(data)


def save_with_a_backup(path: Path, data: bytes, pause: Pause = no_pause) -> None:
    """As vim: try whether the folder takes files, put the old one aside, and write."""
    probe = path.with_name("4913")
    probe.write_bytes(b"")
    probe.unlink()
    if path.exists():
        path.replace(path.with_name(f"{path.name}~"))
        pause()
    path.write_bytes(data)


def save_in_halves(path: Path, data: bytes, pause: Pause = no_pause) -> None:
    with path.open("wb", buffering=0) as file:
        pause()
        file.write(data[: len(data) // 2])
        pause()
        file.write(data[len(data) // 2 :])


def save_with_an_old_time(path: Path, data: bytes, pause: Pause = no_pause) -> None:
    """As unpacking an archive does, or a checkout that keeps times."""
    temporary = path.with_name(f".{path.name}.tmp")
    temporary.write_bytes(data)
    os.utime(temporary, (1e9, 1e9))
    temporary.replace(path)


def save_through_a_link(path: Path, data: bytes, pause: Pause = no_pause) -> None:
    """Put a link to another file in its folder in the file's place."""
    real = path.with_name(f"real-{time.monotonic_ns()}-{path.name}")
    real.write_bytes(data)
    link = path.with_name(f".{path.name}.link")
    link.symlink_to(real)
    link.replace(path)


SAVES: tuple[Save, ...] = (
    save_in_place,
    save_by_rename,
    save_by_deleting,
    save_with_a_backup,
    save_in_halves,
    save_with_an_old_time,
)
