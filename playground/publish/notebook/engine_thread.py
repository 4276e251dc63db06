"""One engine for all that a notebook shows, in a thread of its own.

A context draws in one thread only, and a notebook answers its sliders in another than its cells run in.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from playground.api import headless
from playground.engine.engine import Engine

T = TypeVar("T")

_THREAD = ThreadPoolExecutor(1, thread_name_prefix="notebook")
engines: list[Engine] = []  # one at most


def on_engine(work: Callable[[Engine], T]) -> T:
    """Run some work on the engine that all widgets of this process share, and return its result."""
    return _THREAD.submit(lambda: work(_engine())).result()


def release_engine() -> None:
    """Release the engine with its textures and programs; the next work opens another."""
    _THREAD.submit(_release).result()


def _engine() -> Engine:
    if not engines:
        engines.append(headless())
    return engines[0]


def _release() -> None:
    while engines:
        engines.pop().release()
