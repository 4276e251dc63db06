"""Compare cache keys by identity, which is cheap, not by equality.

Techniques are frozen and large: a slider makes a new sketch around the same graph, so
what is computed from the graph alone can be cached.
"""

from __future__ import annotations

from typing import Generic, TypeVar

T = TypeVar("T")


class Identity(Generic[T]):
    """A key that equals only a key of the same object, which it keeps alive."""

    __slots__ = ("object",)

    def __init__(self, given: T) -> None:
        self.object = given

    def __hash__(self) -> int:
        return id(self.object)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Identity) and other.object is self.object
