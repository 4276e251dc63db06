"""What twins of techniques that draw random numbers share: salts, and the finest lattice."""

from __future__ import annotations

from zlib import crc32

FINEST_SIDE = 2**15
"""Spacings of the lattice that points of terrains made by halving are keyed on, noise/finest.glsl."""


def salt(name: str) -> int:
    """Return what a technique adds to its seed: the CRC-32 of its name, see noise/hash.glsl."""
    return crc32(name.encode())
