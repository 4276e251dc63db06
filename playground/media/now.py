"""What a picture may depend on besides its sketch and its size: the time."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Now:
    """The moment that a picture shows."""

    time: float = 0.0  # [s]
