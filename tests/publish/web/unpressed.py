"""Read what is pressed into a page, by arithmetic on whole numbers and with Python's own LZMA."""

from __future__ import annotations

import lzma
import re

ESCAPED = "\0\a\b\t\n\v\f\r\x1a\x1b&<\x7f"


def undense(text: str) -> bytes:
    """Return the bytes that letters of 7 bits stand for, those of two bytes for two."""
    number, count = 0, 0
    for letter in map(ord, text):
        group, low = divmod(letter, 128)
        pair = (ord(ESCAPED[group - 2]), low) if 2 <= group < 15 else (low,)
        for seven in pair:
            number, count = number << 7 | seven, count + 7
    return (number >> count % 8).to_bytes(count // 8, "big")


def unpressed(text: str) -> str:
    """Return the text that a pressed one holds."""
    data = undense(text)
    filters = [{"id": lzma.FILTER_LZMA1, "dict_size": 2**24, "lc": 3, "lp": 0, "pb": 0}]
    result = lzma.LZMADecompressor(lzma.FORMAT_RAW, filters=filters).decompress(data[8:])
    listed, _, coded = result[: int.from_bytes(data[4:8], "little")].partition(b"\0")
    for code, word in re.findall(rb"([^A-Za-z])([A-Za-z]+)", listed):
        coded = coded.replace(code, word)
    return coded.decode()


def parts_of(pressed: str) -> list[str]:
    """Return a page's style, its data as JSON and its script."""
    return unpressed(pressed).split("\0")
