"""The source ``ranked_heights``: an example's heights as ranks, and sorted, for by-example noise.

Heitz and Neyret 2018, "High-Performance By-Example Noise using a Histogram-Preserving Blending Operator"
(Proc. ACM CGIT 1, 2): blended as the numbers of a normal distribution that have their ranks, and brought
back by the sorted heights, heights keep their histogram.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from playground.sketch.model import Value
from playground.terrain.example.mirrored import smoothed
from playground.terrain.resample import resample
from playground.terrain.source_kinds import Material

PARAMETERS = ("widest",)
INPUTS = ("example",)
_STEPS = 5  # resampling, smoothing, sorting, the deviates, and what is left


def work(
    values: Mapping[str, Value], size: tuple[int, int], material: Material
) -> dict[str, NDArray[np.float32]]:
    """Return of the example in a size (nx, ny): the normal deviate of each texel's rank, and all sorted.

    ``sorted`` holds the heights from the lowest on, row by row.
    """
    nx, ny = size
    material.report(0, _STEPS)
    given = material.inputs.get("example")
    heights = np.zeros((ny, nx)) if given is None else given.reshape(*given.shape[:2], -1)[..., 0]
    heights = np.nan_to_num(np.asarray(heights, np.float64), posinf=0.0, neginf=0.0)
    if heights.shape != (ny, nx):
        heights = resample(heights, size).astype(np.float64) if min(heights.shape) > 1 else np.zeros((ny, nx))
    material.report(1, _STEPS)
    widest = values["widest"]
    assert isinstance(widest, int | float)  # the kernel's file says so
    if widest > 0:
        heights = heights - smoothed(heights, widest * nx / 4)  # a hill is some four deviations wide
    material.report(2, _STEPS)
    order = heights.ravel().argsort(kind="stable")
    material.report(3, _STEPS)
    ranks = np.empty(order.size)
    ranks[order] = np.arange(order.size)
    normal = normal_deviate((ranks + 0.5) / order.size)
    material.report(4, _STEPS)
    return {
        "normal": normal.reshape(ny, nx).astype(np.float32),
        "sorted": heights.ravel()[order].reshape(ny, nx).astype(np.float32),
    }


def normal_deviate(share: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the number below which a share of a normal distribution lies, to 1e-8.

    Source: P. J. Acklam 2003, "An algorithm for computing the inverse normal cumulative distribution
    function": rational functions, near each end of the square root of -2 log.
    """
    a = (-39.6968302866538, 220.946098424521, -275.928510446969, 138.357751867269, -30.6647980661472)
    b = (-54.4760987982241, 161.585836858041, -155.698979859887, 66.8013118877197, -13.2806815528857)
    c = (-0.00778489400243029, -0.322396458041136, -2.40075827716184, -2.54973253934373, 4.37466414146497)
    d = (0.00778469570904146, 0.32246712907004, 2.445134137143, 3.75440866190742)
    tail = np.minimum(share, 1 - share)
    q = np.sqrt(-2 * np.log(tail))
    outer = np.polyval([*c, 2.938163982698783], q) / np.polyval([*d, 1.0], q)
    middle = share - 0.5
    r = middle**2
    inner = np.polyval([*a, 2.506628277459239], r) * middle / np.polyval([*b, 1.0], r)
    found: NDArray[np.float64] = np.where(tail < 0.02425, np.copysign(outer, middle), inner)
    return found
