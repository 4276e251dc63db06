"""Give back to the system what a driver has freed.

A driver compiles in many small blocks. What it frees lies between what stays, and glibc returns memory by
itself only from the heap's end: hundreds of programs, all released, leave hundreds of MiB of free pages.
"""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any


def trim_heap() -> None:
    """Return every free page of the heap to the system, in 1 to 30 ms; nothing happens without glibc."""
    trim = _malloc_trim()
    if trim is not None:
        trim(0)


@cache
def _malloc_trim() -> Any:
    try:
        trim = ctypes.CDLL(None).malloc_trim
    except (AttributeError, OSError, TypeError):  # another C library; Windows has no ``CDLL(None)``
        return None
    trim.argtypes = (ctypes.c_size_t,)
    return trim
