"""Analyse a sound as browsers do for other tools' shaders: its spectrum and its wave.

W3C, Web Audio API (2021), section 1.8, AnalyserNode, with its defaults, as Shadertoy has it: a window of
2048 samples, Blackman's, then a Fourier transform, smoothed over time, in decibels from -100 to -30. A
browser smooths over the frames that it happened to show; here the frames are those of sixty a second
before the time in question, so that the result is a function of that time.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from playground.media.sound import RATE

WINDOW = 2048  # samples
BINS = WINDOW // 2
SHOWN = 512  # bins, and samples of the wave, in Shadertoy's texture
_SMOOTHING = 0.8
_LOWEST, _HIGHEST = -100.0, -30.0  # [dB]
_HOP = RATE // 60  # samples from one frame to the next
_FRAMES = 52  # what is older has less than 0.8 ** 52 = 1e-5 of its strength, which is -100 dB
SPAN = WINDOW + (_FRAMES - 1) * _HOP
"""The samples before a moment that its spectrum depends on."""


def _blackman() -> NDArray[np.float64]:
    turn = 2 * np.pi * np.arange(WINDOW) / WINDOW
    return 0.42 - 0.5 * np.cos(turn) + 0.08 * np.cos(2 * turn)


_BLACKMAN = _blackman()
_WEIGHTS = (1 - _SMOOTHING) * _SMOOTHING ** np.arange(_FRAMES)  # the newest frame first


def spectrum(samples: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return the spectrum after ``SPAN`` samples or more, -1..1: 1024 bytes, bin k at k * 44100 / 2048 Hz."""
    starts = SPAN - WINDOW - _HOP * np.arange(_FRAMES)
    latest = samples[-SPAN:].astype(np.float64)
    windows = np.lib.stride_tricks.sliding_window_view(latest, WINDOW)[starts]
    with np.errstate(under="ignore"):
        strengths = np.abs(np.fft.rfft(windows * _BLACKMAN, axis=1)[:, :BINS]) / WINDOW
        decibels = 20.0 * np.log10(np.maximum(_WEIGHTS @ strengths, 1e-30))
    scaled = 255.0 * (decibels - _LOWEST) / (_HIGHEST - _LOWEST)
    return np.floor(np.clip(scaled, 0.0, 255.0)).astype(np.uint8)


def wave(samples: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return samples, -1..1, as bytes: silence is 128."""
    return np.floor(np.clip(128.0 * (1.0 + samples.astype(np.float64)), 0.0, 255.0)).astype(np.uint8)


def channel(samples: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return Shadertoy's texture of a sound, (2, 512) bytes: the spectrum's lower half, then the wave.

    ``samples``: (channels, at least ``SPAN``), which are mixed.
    """
    mixed = samples.mean(axis=0)
    return np.stack([spectrum(mixed)[:SHOWN], wave(mixed[-WINDOW:][:SHOWN])])


def waves(samples: NDArray[np.float32], size: tuple[int, int]) -> NDArray[np.uint8]:
    """Return the last samples of each channel as ``size`` bytes: a row a channel, the first in row 0."""
    width, height = size
    return wave(_rows(samples, height)[:, -width:])


def spectra(samples: NDArray[np.float32], size: tuple[int, int]) -> NDArray[np.uint8]:
    """Return the spectrum of each channel as ``size`` bytes, up to half the rate; rows as ``waves`` has them.

    A texel has the largest of its bins, so that a pure tone shows in a narrow texture too.
    """
    width, height = size
    first = np.minimum(np.arange(width) * BINS // width, BINS - 1)
    return np.stack([np.maximum.reduceat(spectrum(row), first) for row in _rows(samples, height)])


def _rows(samples: NDArray[np.float32], height: int) -> NDArray[np.float32]:
    """Return a row for each of ``height`` channels: one is all of them mixed, more repeat the last."""
    if height == 1:
        return np.asarray(samples.mean(axis=0, keepdims=True), np.float32)
    return samples[np.minimum(np.arange(height), len(samples) - 1)]
