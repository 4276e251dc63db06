"""Hold bytes once each, by a hash of them, as gzip in base64."""

from __future__ import annotations

import base64
import gzip
import hashlib
import json
from collections.abc import Mapping
from typing import Any


def packed(data: bytes) -> str:
    """Return bytes as packed.js unpacks them: gzip in base64; the same bytes give the same text."""
    return base64.b64encode(gzip.compress(data, compresslevel=9, mtime=0)).decode("ascii")


def packed_json(data: Any) -> str:
    """Return data as packed JSON; the same data give the same text."""
    return packed(json.dumps(data, separators=(",", ":"), ensure_ascii=False).encode())


def bytes_in_page(texts: Mapping[str, str]) -> int:
    """Return what such texts take in a page."""
    return sum(map(len, texts.values()))


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
        return bytes_in_page(self.texts)
