"""The labels of a report of grades."""

from __future__ import annotations

import tomllib
from pathlib import Path

from playground.course.library import Labels
from playground.memo import INTERFACE


@INTERFACE.cached()
def report_labels(language: str) -> Labels:
    """Return the labels of a report of grades in a language."""
    with (Path(__file__).resolve().parent / "labels" / f"{language}.toml").open("rb") as handle:
        return Labels(tomllib.load(handle))
