"""The parameters of what a session shows, by path, and their values."""

from __future__ import annotations

from playground.studio.panel.parameter_list import Item, Listing, Values
from playground.studio.session import Session

_LISTING = Listing()


def items_of(session: Session) -> dict[str, Item]:
    """Return every parameter of the sketch that is shown, by path, as the panel has them."""
    if session.shown is None:
        return {}
    return {item.path: item for section in _LISTING.sections(session.shown) for item in section.items}


def values_of(session: Session) -> Values | None:
    """Return what they are set to; None before the first good sketch."""
    return None if session.shown is None else _LISTING.values(session.shown)
