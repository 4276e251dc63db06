"""A file called "-": standard output, for the program at the other end of a pipe."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from playground.errors import ParameterError
from playground.streams import Nowhere

NAME = "-"


def check_standard_output(option: str, what: str) -> None:
    """Raise ``ParameterError`` where ``what``, as "a PNG", cannot go to standard output."""
    if sys.stdout.isatty():
        raise ParameterError(
            f"{option} - writes {what} to standard output, which is the terminal; redirect it"
        )
    if isinstance(sys.stdout, Nowhere):
        raise ParameterError(f"{option} - writes {what} to standard output, which is closed; redirect it")


def write_file(path: Path) -> None:
    """Write a file's bytes to standard output."""
    sys.stdout.flush()
    with path.open("rb") as file:
        shutil.copyfileobj(file, sys.stdout.buffer)
    sys.stdout.buffer.flush()
