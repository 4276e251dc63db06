"""Smooth a field, and find one by its gradients: both by Fourier transforms of the mirrored field.

Mirrored in its edges a field has no step there, and its transform is made of cosines: edges are free.
The transforms are NumPy's own.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Field = NDArray[np.float64]
_LEAST = -200.0
"""The least exponent: products of two such powers, and of heights, are not too small for a float."""


def smoothed(field: Field, sigma: float) -> Field:
    """Return a field (ny, nx) convolved with a Gaussian of ``sigma`` texels."""
    ny, nx = field.shape
    across, along = (
        np.exp(np.maximum(-2 * (np.pi * sigma * frequency) ** 2, _LEAST))
        for frequency in (np.fft.rfftfreq(2 * nx), np.fft.fftfreq(2 * ny))
    )
    return _filtered(field, along[:, None] * across)


def integrated(east: Field, north: Field, near: Field, nearness: float) -> Field:
    """Return the field whose gradients are closest to the given ones, and which is close to another.

    It minimises the sum of squares of (z[y, x + 1] - z[y, x] - ``east``), of the same to the north, and
    of (z - ``near``) times ``nearness``, over all texels: a screened Poisson equation (Bhat et al. 2008,
    "Fourier Analysis of the 2D Screened Poisson Equation for Gradient Domain Problems", ECCV). The last
    column of ``east`` and the last row of ``north`` are not read. All are (ny, nx).
    """
    ny, nx = near.shape
    right = -nearness * near
    right[:, :-1] += east[:, :-1]
    right[:, 1:] -= east[:, :-1]
    right[:-1] += north[:-1]
    right[1:] -= north[:-1]
    across = 2 * np.cos(2 * np.pi * np.fft.rfftfreq(2 * nx)) - 2
    along = 2 * np.cos(2 * np.pi * np.fft.fftfreq(2 * ny)) - 2
    return _filtered(right, 1 / (along[:, None] + across - nearness))


def _filtered(field: Field, factors: Field) -> Field:
    """Multiply the transform of the field, mirrored to (2 ny, 2 nx)."""
    ny, nx = field.shape
    mirrored = np.block([[field, field[:, ::-1]], [field[::-1], field[::-1, ::-1]]])
    result: Field = np.fft.irfft2(np.fft.rfft2(mirrored) * factors, s=mirrored.shape)[:ny, :nx]
    return result
