"""Generate the table of keys from the window's own."""

from __future__ import annotations

from playground.studio.keys import CONTROL_KEYS, CURSOR_KEYS, GESTURES, STEERING_KEYS, keys_by_meaning

from .markdown import code, escaped, table

_HEAD = """# Keys and mouse

This page is generated from the window's own table; `?` shows it in the window.
The keys of `playground fly` are [on its page](../how-to/fly.md#controls).

"""


def page() -> str:
    """Return the page of keys and gestures."""
    rows = [
        (", ".join(code(name) for name in names), escaped(meaning))
        for meaning, names in keys_by_meaning().items()
    ]
    without = (*STEERING_KEYS, *CURSOR_KEYS, *CONTROL_KEYS)
    by_focus = [(escaped(keys), escaped(meaning)) for keys, meaning in without]
    gestures = [(escaped(gesture), escaped(meaning)) for gesture, meaning in GESTURES]
    return (
        _HEAD
        + "## Keys\n\n"
        + table(("Key", "What it does"), rows)
        + "## Without a mouse\n\n"
        + table(("Key", "What it does"), by_focus)
        + "## Mouse\n\n"
        + table(("Gesture", "What it does"), gestures)
    )
