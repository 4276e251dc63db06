"""What an even surface throws back, in float64."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def reflected(cosine: ArrayLike, before: float = 1.0, after: float = 1.333) -> NDArray[np.float64]:
    """Return the share thrown back of unpolarised light between two refractive indices (Fresnel)."""
    cosine = np.asarray(cosine, np.float64)
    sine = before / after * np.sqrt(1 - cosine**2)
    inner = np.sqrt(np.maximum(1 - sine**2, 0))
    across = ((before * cosine - after * inner) / (before * cosine + after * inner)) ** 2
    along = ((before * inner - after * cosine) / (before * inner + after * cosine)) ** 2
    return np.where(sine >= 1, 1.0, (across + along) / 2)
