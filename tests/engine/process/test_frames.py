"""A frame is read whole, and what is no frame is recognised."""

from __future__ import annotations

import io

import pytest

from playground.engine.process.frames import _HEAD, _MARK, NotAFrame, read, write


@pytest.mark.parametrize("data", [b"", b"one", bytes(100_000)])
def test_what_is_read_is_what_was_written(data: bytes):
    stream = io.BytesIO()
    write(stream, data)
    write(stream, b"next")
    stream.seek(0)
    assert (read(stream), read(stream)) == (data, b"next")
    with pytest.raises(EOFError):
        read(stream)


@pytest.mark.parametrize(
    ("data", "kind"),
    [
        (b"", EOFError),
        (_HEAD.pack(_MARK, 3)[:9], EOFError),
        (_HEAD.pack(_MARK, 30) + b"cut short", EOFError),
        (b"Mesa", NotAFrame),
        (b"Mesa: error: ZINK: failed to choose pdev", NotAFrame),
        (_HEAD.pack(_MARK, 2**60), NotAFrame),  # it is not even tried to read so much
    ],
)
def test_what_is_no_frame_is_recognised(data: bytes, kind: type[Exception]):
    with pytest.raises(kind):
        read(io.BytesIO(data))
