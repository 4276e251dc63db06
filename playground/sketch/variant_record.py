"""The record of fast variants that were found to agree with their canonical form.

One generated file, ``glsl/fast_variants.json``, is for all that ships; a user's own variants
have one in their folder. It holds the contents of both forms (see ``canonical``) by the variant's
path from the record's folder. ``playground variants renew`` writes it, after the two forms were
drawn and compared; nothing else does.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

from playground.errors import SketchError
from playground.json_text import read_json
from playground.paths import GLSL, shown
from playground.sketch.allowed_files import is_file
from playground.sketch.source import read_text

NAME = "fast_variants.json"

Verified = tuple[str, str]
"""Contents of a canonical form and of its fast variant."""


def record_of(variant: Path) -> tuple[Path, str]:
    """Return the record that a variant's file belongs to, and its name there."""
    folder = GLSL if variant.is_relative_to(GLSL) else variant.parent
    return folder / NAME, variant.relative_to(folder).as_posix()


def verified(variant: Path) -> tuple[Verified | None, str]:
    """Return what the record says of a variant's file, and the record's absolute path.

    The path is "" where there is none, and for the library's: that is no part of a sketch.
    Raises ``SketchError`` for a record that is not one.
    """
    record, name = record_of(variant)
    if not is_file(record):
        return None, ""
    found = _read(read_text(record), shown(record)).get(name)
    return found, "" if record.parent == GLSL else str(record)


def written(entries: Mapping[str, Verified]) -> str:
    """Return a record's text: the same for the same entries."""
    table = {name: {"canonical": found[0], "variant": found[1]} for name, found in sorted(entries.items())}
    return json.dumps({"format": 1, "variants": table}, indent=1) + "\n"


def read(record: Path) -> dict[str, Verified]:
    """Return what a record says, by the variants' names; raise ``SketchError`` for one that is not one."""
    return dict(_read(read_text(record), shown(record))) if record.is_file() else {}


@lru_cache(maxsize=16)
def _read(text: str, name: str) -> Mapping[str, Verified]:
    try:
        table = read_json(text)["variants"]
        return {key: (str(one["canonical"]), str(one["variant"])) for key, one in table.items()}
    except (ValueError, TypeError, KeyError, AttributeError):
        message = "not a record of fast variants; remove it, then `playground variants renew` writes it again"
        raise SketchError(message, file=name) from None
