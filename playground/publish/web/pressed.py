"""Press a text for a page: LZMA of it, as letters of 7 bits that may stand in a script element.

Base64 makes four letters of three bytes; here eight letters make seven. All ASCII stands for 7 bits of its
own but for ``ESCAPED``, which a browser, an editor or a terminal would change or act on. Such 7 bits and the
7 that follow become one letter of two bytes of UTF-8. dense.js and pressed.js read what this writes.
"""

from __future__ import annotations

import lzma
import re
import zlib
from collections import Counter
from string import ascii_letters

import numpy as np

ESCAPED = "\0\a\b\t\n\v\f\r\x1a\x1b&<\x7f"
"""At most 13, or the letters that stand for pairs would take three bytes."""

_FIRST = 2  # of the 128 letters for each: U+0080 … are controls
_ESCAPE = re.compile(b"[" + re.escape(ESCAPED.encode()) + b"].?", re.DOTALL)
_PAIRS = {
    bytes([ord(item), next_]): chr(index << 7 | next_).encode()
    for index, item in enumerate(ESCAPED, _FIRST)
    for next_ in range(128)
} | {item.encode(): chr(15 << 7 | ord(item)).encode() for item in ESCAPED}  # at the end, alone
_LETTERS = ascii_letters.encode()
_WORD = re.compile(rb"[A-Za-z]{3,}")
_FILTERS = [
    {
        "id": lzma.FILTER_LZMA1,
        "preset": 9 | lzma.PRESET_EXTREME,
        "dict_size": 2**24,
        "lc": 3,
        "lp": 0,
        "pb": 0,
        "nice_len": 128,
    }
]


def pressed(text: str) -> str:
    """Return a text as pressed.js reads it; the same text gives the same."""
    data = _with_words(text.encode())
    coded = len(data).to_bytes(4, "little") + lzma.compress(data, lzma.FORMAT_RAW, filters=_FILTERS)
    return dense(zlib.adler32(coded).to_bytes(4, "little") + coded)


def _with_words(data: bytes) -> bytes:
    """Return bytes in which bytes that they do not have stand for words, after a list of those.

    Each byte of the list is followed by the letters of its word; a zero ends it. That spares LZMA
    a fortieth.
    """
    present = {*data, 0, *_LETTERS}
    counts = Counter(_WORD.findall(data))
    best = sorted(counts, key=lambda word: (-(counts[word] - 1) * (len(word) - 1), word))
    codes = {word: bytes([code]) for word, code in zip(best, sorted({*range(256)} - present), strict=False)}
    listed = b"".join(code + word for word, code in codes.items())
    return listed + b"\0" + _WORD.sub(lambda match: codes.get(match[0], match[0]), data)


def dense(data: bytes) -> str:
    """Return bytes as text, 7 bits a letter; zeros follow the last bit."""
    bits = np.unpackbits(np.frombuffer(data, np.uint8))
    sevens = np.pad(bits, (0, -len(bits) % 7)).reshape(-1, 7)
    codes = np.packbits(np.pad(sevens, ((0, 0), (1, 0))), axis=1).tobytes()
    return _ESCAPE.sub(lambda match: _PAIRS[match[0]], codes).decode()
