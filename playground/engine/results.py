"""Keep what passes made, under a bound in bytes; what was used least recently goes first."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import moderngl


@dataclass(eq=False)
class Result:
    """The textures that one pass made."""

    key: str
    size: tuple[int, int]
    textures: dict[str, moderngl.Texture]  # by output
    bytes: int
    surface: moderngl.Framebuffer | None = None  # a draw's samples and depth, for a draw on top of it
    mipmapped: set[str] = field(default_factory=set)  # outputs whose mipmaps are made
    turn: int = 0  # of a loop's result: how many turns made it

    def release(self) -> None:
        """Give the textures back to the driver."""
        for texture in self.textures.values():
            texture.release()
        if self.surface is not None:
            for attachment in self.surface.color_attachments:
                attachment.release()
            if self.surface.depth_attachment is not None:
                self.surface.depth_attachment.release()
            self.surface.release()
            self.surface = None


class Cache:
    """Results by key; those of the frame being drawn are never dropped."""

    def __init__(self, limit: int) -> None:
        self.limit = limit  # [bytes]
        self.hits = 0
        self.misses = 0
        self._kept: OrderedDict[str, Result] = OrderedDict()
        self._in_use: set[str] = set()

    @property
    def bytes(self) -> int:
        """Bytes held."""
        return sum(result.bytes for result in self._kept.values())

    def __len__(self) -> int:
        return len(self._kept)

    def begin(self) -> None:
        """Begin a frame: nothing is in use yet."""
        self._in_use.clear()

    def get(self, key: str) -> Result | None:
        """Return a result and mark it as used; None if it is not kept."""
        result = self._kept.get(key)
        if result is None:
            self.misses += 1
            return None
        self.hits += 1
        self._kept.move_to_end(key)
        self._in_use.add(key)
        return result

    def put(self, result: Result) -> None:
        """Keep a result, used by the current frame; what is over the bound goes."""
        old = self._kept.pop(result.key, None)
        if old is not None and old is not result:
            old.release()
        self._kept[result.key] = result
        self._in_use.add(result.key)
        self.trim()

    def take(self, key: str) -> Result | None:
        """Hand a result over to the caller, who now owns it."""
        self._in_use.discard(key)
        return self._kept.pop(key, None)

    def trim(self) -> None:
        """Drop what was used least recently until the bound holds or all that is left is in use."""
        total = self.bytes
        for key in list(self._kept):
            if total <= self.limit:
                return
            if key not in self._in_use:
                result = self._kept.pop(key)
                total -= result.bytes
                result.release()

    def clear(self) -> None:
        """Drop everything."""
        for result in self._kept.values():
            result.release()
        self._kept.clear()
        self._in_use.clear()
