"""Read untrusted JSON: any defect raises one kind of error."""

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
    inner = [found] if isinstance(found, list | dict) else []
    for _ in range(DEEPEST):
        values = (value.values() if isinstance(value, dict) else value for value in inner)
        inner = [one for some in values for one in some if isinstance(one, list | dict)]
        if not inner:
            return found
    raise ValueError(f"it is nested deeper than {DEEPEST} levels")
