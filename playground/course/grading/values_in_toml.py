"""Take the values of an exercise from a sketch's TOML; what else is in the file changes nothing.

The file is only read as a table, never loaded as a sketch. One that names a file outside of its folder
is refused whole: no hand-out has such a name.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePosixPath, PureWindowsPath
from typing import Any, cast

from playground.allowed_files import is_absolute
from playground.course.grading.entries import printable
from playground.course.translatable import Said
from playground.errors import DataError
from playground.sketch.model import Value

_MAX_TOML = 2**17  # characters of a sketch's TOML
_MAX_VALUE = 200  # characters of a value


def values_in_toml(text: str, sliders: Sequence[str]) -> dict[str, Value]:
    """Return the values that a sketch's TOML sets of some parameters, by their paths; others are left out.

    Raises ``DataError`` in a message for what is no TOML, or names a file elsewhere.
    """
    if len(text) > _MAX_TOML:
        raise DataError(Said("is longer than any sketch: {count} characters", count=len(text)))
    try:
        table = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, ValueError) as error:
        raise DataError(Said("is no TOML: {why}", why=printable(str(error), 200))) from None
    except RecursionError:
        raise DataError(Said("is no sketch: its tables nest too deeply")) from None
    for name in _texts(table):
        if _leads_out(name):
            raise DataError(
                Said("names '{name}', a file outside of its folder; it was not opened", name=printable(name))
            )
    values: dict[str, Value] = {}
    for path in sliders:
        owner, _, rest = path.partition(".")
        value = _under(_settings_of(table, owner), rest) if rest else table.get(path)
        if value is not None:
            values[path] = _checked(path, value)
    return values


def _settings_of(table: Mapping[str, Any], owner: str) -> Mapping[str, Any]:
    """Return what a sketch's TOML sets of one pass; an empty table where it sets nothing."""
    passes = table.get("pass")
    candidates = [p for p in passes if isinstance(p, dict)] if isinstance(passes, list) else []
    named = [p for p in candidates if p.get("name") == owner]
    if owner == "view" and isinstance(table.get("view"), dict):
        named.append(table["view"])
    settings = named[0].get("set") if named else None
    return settings if isinstance(settings, dict) else {}


def _under(settings: Mapping[str, Any], path: str) -> Any:
    """Return what is under a path, written as one key or as tables in tables; None where nothing is."""
    if path in settings:
        return settings[path]
    first, dot, rest = path.partition(".")
    inner = settings.get(first)
    return _under(inner, rest) if dot and isinstance(inner, dict) else None


def _checked(path: str, value: Any) -> Value:
    """Return a value if it is one that a parameter may have; whether it suits is the judge's to say."""
    if isinstance(value, bool | str) and len(str(value)) <= _MAX_VALUE:
        return value
    numbers = (
        list(value.values()) if isinstance(value, dict) else value if isinstance(value, list) else [value]
    )
    plain = all(type(n) in (int, float) and math.isfinite(n) and abs(n) < 2**53 for n in numbers)
    if not plain or not 0 < len(numbers) <= 16:
        raise DataError(
            Said(
                "sets {path} to a value that is not a number: {value}",
                path=path,
                value=printable(repr(value)),
            )
        )
    return cast(Value, value)


def _texts(value: object) -> Iterator[str]:
    waiting = [value]
    while waiting:
        item = waiting.pop()
        if isinstance(item, str):
            yield item
        elif isinstance(item, dict):
            waiting += [*item.keys(), *item.values()]
        elif isinstance(item, list):
            waiting += item


def _leads_out(text: str) -> bool:
    """Return whether a text, taken for a path, is absolute or climbs out of a folder, on any system."""
    parts = (*PurePosixPath(text).parts, *PureWindowsPath(text).parts)
    return is_absolute(text) or ".." in parts
