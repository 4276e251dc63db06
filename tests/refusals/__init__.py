"""Read what is refused: the rows of the files of this folder."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

Row = Any
"""A table of strings, and a line; or a text."""


def rows(name: str) -> list[Row]:
    """Return the rows of a file of this folder."""
    result: list[Row] = tomllib.loads((Path(__file__).parent / f"{name}.toml").read_text("utf-8"))["rows"]
    return result
