"""Hold bytes once each, as text that a page can hold: gzip in base64, by a hash of the bytes."""

from __future__ import annotations

import base64
import gzip
import hashlib


def packed(data: bytes) -> str:
    """Return bytes as packed.js unpacks them: gzip in base64; the same bytes give the same text."""
    return base64.b64encode(gzip.compress(data, compresslevel=9, mtime=0)).decode("ascii")


class Blobs:
    """What a page holds besides its JSON."""

    def __init__(self) -> None:
        self.texts: dict[str, str] = {}  # by key

    def add(self, data: bytes) -> str:
        """Return the key of some bytes; the same bytes are held once, and give the same text."""
        key = hashlib.blake2b(data, digest_size=8).hexdigest()
        if key not in self.texts:
            self.texts[key] = packed(data)
        return key

    @property
    def size(self) -> int:
        """Bytes that the texts take in a page."""
        return sum(map(len, self.texts.values()))
