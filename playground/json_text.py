"""Read untrusted JSON: whatever is wrong with it raises one kind of error."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

DEEPEST = 64
"""Levels of lists and objects in each other; nothing of ours has ten."""


def read_json(text: str | bytes, *, constant: Callable[[str], Any] | None = None) -> Any:
    """Return what a JSON text holds; ``constant`` as ``parse_constant`` of ``json.loads``.

    Raises ``ValueError`` where it is no JSON, and where it is nested deeper than `DEEPEST`:
    reading such a text, or printing what was read, would overflow the stack.
    """
    try:
        found = json.loads(text, parse_constant=constant)
    except RecursionError:
        raise ValueError(f"it is nested deeper than {DEEPEST} levels") from None
    inner = [found]
    for _ in range(DEEPEST):
        inner = [one for value in inner for one in _inside(value)]
        if not inner:
            return found
    raise ValueError(f"it is nested deeper than {DEEPEST} levels")


def _inside(value: Any) -> list[Any]:
    """Return the lists and objects directly in a value."""
    if isinstance(value, dict):
        value = value.values()
    elif not isinstance(value, list):
        return []
    return [one for one in value if isinstance(one, list | dict)]
