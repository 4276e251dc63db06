"""Pickle requests for a worker process so that each kernel is sent once, not with every sketch.

A sketch is mostly its kernels' texts, and a save changes one of them. Both ends keep the
kernels of the last message and no others, so that a name replaces the rest; the process,
which receives the same objects again, need not parse their texts again.
"""

from __future__ import annotations

import io
import pickle
from typing import Any

from playground.sketch.model import Kernel


class Encoder:
    """The parent's end; one ``Decoder`` reads all its messages, in order."""

    def __init__(self) -> None:
        self._known: dict[int, tuple[str, Kernel]] = {}  # by identity: held, so that it stays its own
        self._count = 0

    def encode(self, message: object) -> bytes:
        """Return a message as bytes."""
        news: dict[str, Kernel] = {}
        used: dict[int, tuple[str, Kernel]] = {}

        def name_of(thing: object) -> str | None:
            if type(thing) is not Kernel:
                return None
            named = self._known.get(id(thing)) or used.get(id(thing))
            if named is None:
                self._count += 1
                named = str(self._count), thing
                news[named[0]] = thing
            used[id(thing)] = named
            return named[0]

        body = _pickled(message, name_of)
        self._known = used
        return pickle.dumps(news) + body


class Decoder:
    """The child's end. Only ever for bytes from our own parent."""

    def __init__(self) -> None:
        self._known: dict[str, Kernel] = {}

    def decode(self, data: bytes) -> Any:
        """Return the message that an ``Encoder`` wrote."""
        stream = io.BytesIO(data)
        known = self._known | pickle.load(stream)
        unpickler = _Unpickler(stream, known)
        message = unpickler.load()
        self._known = unpickler.used
        return message


def _pickled(message: object, name_of: Any) -> bytes:
    stream = io.BytesIO()
    pickler = _Pickler(stream)
    pickler.name_of = name_of
    pickler.dump(message)
    return stream.getvalue()


class _Pickler(pickle.Pickler):
    name_of: Any

    def persistent_id(self, thing: object) -> Any:
        return self.name_of(thing)


class _Unpickler(pickle.Unpickler):
    def __init__(self, stream: io.BytesIO, known: dict[str, Kernel]) -> None:
        super().__init__(stream)
        self._known = known
        self.used: dict[str, Kernel] = {}

    def persistent_load(self, name: Any) -> Kernel:
        kernel = self.used[name] = self._known[name]
        return kernel
