"""Read untrusted JSON: any defect raises one kind of error."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from typing import Any

MAX_DEPTH = 64
"""Levels of lists and objects in each other; nothing of ours has ten."""

MAX_DIGITS = 4_300
"""Digits of a whole number: those that Python reads."""

_LONG_NUMBER = re.compile(rf"\d[\d_]{{{MAX_DIGITS},}}")


def read_json(text: str | bytes, *, constant: Callable[[str], Any] | None = None, strict: bool = True) -> Any:
    """Return what a JSON text holds; ``constant`` and ``strict`` as ``json.loads`` takes them.

    Raises ``ValueError`` where it is no JSON, where a number is longer than `MAX_DIGITS`, and where it is
    nested deeper than `MAX_DEPTH`: reading such a text, or printing what was read, would overflow the stack.
    """
    try:
        value = json.loads(text, parse_constant=constant, strict=strict)
    except RecursionError:
        raise ValueError(f"it is nested deeper than {MAX_DEPTH} levels") from None
    except (json.JSONDecodeError, UnicodeDecodeError):
        raise
    except ValueError as error:
        whole = text if isinstance(text, str) else text.decode("utf-8", "replace")
        raise json.JSONDecodeError(*long_number(whole, error)) from None
    inner = [value] if isinstance(value, list | dict) else []
    for _ in range(MAX_DEPTH):
        values = (value.values() if isinstance(value, dict) else value for value in inner)
        inner = [child for some in values for child in some if isinstance(child, list | dict)]
        if not inner:
            return value
    raise ValueError(f"it is nested deeper than {MAX_DEPTH} levels")


def long_number(text: str, error: ValueError) -> tuple[str, str, int]:
    """Return what to say of a text whose number Python refuses, the text, and the place of the number."""
    match = _LONG_NUMBER.search(text)
    if match is None:
        return str(error), text, 0
    return f"a number of {len(match[0])} digits; the most is {MAX_DIGITS}", text, match.start()
