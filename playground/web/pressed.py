"""Press a text for a page: LZMA, as letters of 7 bits that may stand in a script element.

Base64 makes four letters of three bytes; here eight letters make seven. All ASCII stands for 7 bits of its
own but for ``ESCAPED``, which a browser, an editor or a terminal would change or act on. Such 7 bits and the
7 that follow become one letter of two bytes of UTF-8. pressed.js reads what this writes.
"""

from __future__ import annotations

import lzma

import numpy as np

ESCAPED = "\0\a\b\t\n\v\f\r\x1a\x1b&<\x7f"
"""At most 14, or the letters that stand for pairs would take three bytes."""

_FILTERS = [
    {
        "id": lzma.FILTER_LZMA1,
        "preset": 9 | lzma.PRESET_EXTREME,
        "dict_size": 2**24,
        "lc": 3,
        "lp": 0,
        "pb": 0,
        "nice_len": 273,
    }
]


def pressed(text: str) -> str:
    """Return a text as pressed.js reads it; the same text gives the same."""
    data = text.encode()
    return dense(len(data).to_bytes(4, "little") + lzma.compress(data, lzma.FORMAT_RAW, filters=_FILTERS))


def dense(data: bytes) -> str:
    """Return bytes as text, 7 bits a letter; what reads it may find a zero more at their end."""
    bits = np.unpackbits(np.frombuffer(data, np.uint8))
    padded = np.pad(bits, (0, -len(bits) % 7)).reshape(-1, 7)
    sevens = iter((padded @ (64 >> np.arange(7))).tolist())
    places = {ord(letter): place for place, letter in enumerate(ESCAPED, 2)}  # U+0080 … are controls
    return "".join(chr(places[one] << 7 | next(sevens, 0) if one in places else one) for one in sevens)
