"""The mutants that the engine draws, read from their table."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from playground.errors import DataError
from playground.memo import INTERFACE
from playground.verify.shots.mutants.model import Edit, Rendering

TABLE = Path(__file__).with_name("rendering.toml")

_KEYS = {"name", "broke", "edit", "set", "plus", "times", "wire", "samples", "later", "steps", "shot"}


@INTERFACE.cached()
def rendering_mutants(table: Path = TABLE) -> tuple[Rendering, ...]:
    """Return the mutants of a table; raise ``DataError`` for a key or a name that is wrong in it."""
    with table.open("rb") as file:
        renderings = tuple(_mutant(entry, table) for entry in tomllib.load(file)["mutant"])
    names = [mutant.name for mutant in renderings]
    for name in names:
        if names.count(name) > 1:
            raise DataError(f"two mutants are called '{name}'", file=table)
    return renderings


def _mutant(entry: dict[str, Any], table: Path) -> Rendering:
    name = entry.get("name", "")
    if not name or not entry.get("broke", "").endswith("."):
        raise DataError(f"mutant '{name}': it needs a name, and a sentence as `broke`", file=table)
    if unknown := entry.keys() - _KEYS:
        raise DataError(f"mutant '{name}': no key '{min(unknown)}'; there are {sorted(_KEYS)}", file=table)
    mutant = Rendering(
        name=name,
        broke=entry["broke"],
        edits=tuple(Edit(edit["file"], edit["find"], edit["put"]) for edit in entry.get("edit", ())),
        values=tuple(entry.get("set", {}).items()),
        plus=tuple(entry.get("plus", {}).items()),
        times=tuple(entry.get("times", {}).items()),
        wires=tuple(entry.get("wire", {}).items()),
        samples=entry.get("samples"),
        later=entry.get("later", 0.0),
        steps=entry.get("steps", 0),
        shot=entry.get("shot", ""),
    )
    if mutant == Rendering(name=name, broke=mutant.broke, shot=mutant.shot):
        raise DataError(f"mutant '{name}' breaks nothing", file=table)
    return mutant
