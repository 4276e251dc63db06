"""Frame messages on a pipe: a mark, a length, then as many bytes.

The mark tells a frame from what a driver, or a library that it loads, may write into the pipe.
"""

from __future__ import annotations

import struct
from typing import IO

_MARK = b"\0frame\r\n"
_HEAD = struct.Struct("<8sQ")
_LONGEST = 2**33  # [bytes] of a frame: an image of 16384 x 16384 has 2**30


class NotAFrame(Exception):
    """What was read is no frame."""


def write(stream: IO[bytes], data: bytes) -> None:
    """Write one frame."""
    stream.write(_HEAD.pack(_MARK, len(data)))
    stream.write(data)
    stream.flush()


def read(stream: IO[bytes]) -> bytes:
    """Read one frame; raise ``EOFError`` at the end, even amid a frame, ``NotAFrame`` for anything else."""
    head = stream.read(_HEAD.size)
    if not head:
        raise EOFError
    if not head.startswith(_MARK[: len(head)]):
        raise NotAFrame(repr(head))
    if len(head) < _HEAD.size:
        raise EOFError
    _, length = _HEAD.unpack(head)
    if length > _LONGEST:
        raise NotAFrame(f"a frame of {length} bytes")
    data = stream.read(length)
    if len(data) < length:
        raise EOFError
    return data
