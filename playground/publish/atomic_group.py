"""Write the files of one export: all of them or none."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path

from playground.errors import DataError
from playground.files import open_regular, reason, replacing

_MARK = b"terrain shader playground"
_LOOKED_AT = 4096  # bytes, within which an export says who made it


def refuse_foreign_files(path: Path, sidecars: list[Path]) -> None:
    """Raise ``DataError`` where a file that goes with ``path`` would replace one that is no export."""
    for other in sidecars:
        try:
            if not other.exists():
                continue
            with open_regular(other) as handle:
                ours = _MARK in handle.read(_LOOKED_AT)
        except OSError as error:
            raise DataError(f"cannot be read: {reason(error)}", file=other) from error
        if not ours:
            raise DataError(
                f"{other.name} is there already, and no export wrote it; choose another name", file=path
            )


def write_together(files: Mapping[Path, bytes]) -> None:
    """Write files that belong together; when one fails, none of them takes its name.

    Raises:
        DataError: a missing folder, no permission, a full disk.
    """
    with ExitStack() as stack:
        handles = [(stack.enter_context(replacing(path)), data) for path, data in files.items()]
        for handle, data in handles:
            handle.write(data)
            handle.flush()  # a full disk shows here, before any file has its name
