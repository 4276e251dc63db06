"""Choices of the user that have to be checked before they are shown: techniques, channels, data files."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from playground.studio.edits.edits import Draft, Edits
from playground.studio.edits.history import CHECKED, Key, changes_between

Change = Callable[[Draft], Draft]
"""Returns a draft with something edited; may raise ``PlaygroundError``."""


@dataclass(frozen=True)
class Choice:
    """One change of the user, and what of it has to be checked."""

    change: Change
    keys: frozenset[Key]  # all that it sets
    chosen: Mapping[
        Key, object
    ]  # techniques, sources, files, by what they are for; None: the file's own again

    @property
    def use(self) -> str:
        """The technique or source that is chosen; empty where it is the file's, or a data file."""
        return next((str(use) for (kind, _), use in self.chosen.items() if kind in CHECKED and use), "")

    @property
    def label(self) -> str:
        """What is chosen, for a message: "height: ./dunes"."""
        named = {
            path: value if kind in CHECKED or value is None else Path(str(value)).name
            for (kind, path), value in self.chosen.items()
        }
        return ", ".join(f"{path}: {value or 'what the file says'}" for path, value in named.items())


def choice_of(change: Change, before: Edits, after: Edits) -> Choice:
    """Return a change with what it sets; ``chosen`` is empty where that needs no check."""
    old, new = changes_between(before, after)
    chosen = {
        key: value
        for key, value in new.items()
        if key[0] in CHECKED or isinstance(value, str) or isinstance(old[key], str)
    }
    return Choice(change, frozenset(new), chosen)
