"""Three bands of a sound that is not there, for shaders that read no more of one than that."""

from __future__ import annotations

from math import exp, pi, sin

_TEMPO = 2.0  # beats a second


def bands_at(time: float) -> tuple[float, float, float]:
    """Return how strong low, middle and high tones are at a time [s], each 0..1: a drum and two swells."""
    since = time * _TEMPO % 1.0
    middle, high = (0.5 + 0.4 * sin(2 * pi * time / seconds) for seconds in (3.0, 1.3))
    return exp(-4.0 * since), middle, high
