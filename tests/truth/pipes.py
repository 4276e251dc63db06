"""A step of hydraulic erosion by virtual pipes in float64, written as sums over the sides of texels.

Mei, Decaudin and Hu 2007, with the load carried upwind. What the kernels do texel by texel is
done here side by side: each side takes from one texel and gives the same to the other.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

SIDES = ((0, -1), (0, 1), (-1, 0), (1, 0))
"""Rows and columns to the western, eastern, southern and northern neighbour, in the order of a flux."""


@dataclass
class Pipes:
    """A terrain with water on it; every array is (ny, nx), row 0 in the south."""

    bed: Array  # [m]
    water: Array  # [m]
    load: Array  # [m] of rock
    mean_flow: Array  # [m] a step
    flux: Array  # [m] a step, (4, ny, nx) in the order of SIDES
    spacing: tuple[float, float]  # [m] east, north
    rain: float = 0.05  # [m/h]
    evaporation: float = 0.02  # [1/h]
    friction: float = 0.02  # [1/h]
    capacity: float = 5.0
    wear: float = 0.3  # [1/h]
    settling: float = 0.3  # [1/h]
    repose: float = 36.0  # [degrees]
    creep: float = 1.0  # [m2/h]
    closed: bool = False
    left: Array = field(default_factory=lambda: np.zeros(2))  # water and load that went over the edges

    @property
    def hours(self) -> float:
        """Return the length of a step [h]."""
        return 256 / (max(self.bed.shape) - 1)

    def step(self) -> None:
        """Go on by a step."""
        self._pump()
        worn, slumped = self._carry(), self._slump()
        self.bed = worn + slumped

    def _pump(self) -> None:
        level = np.pad(self.bed + self.water, 1, constant_values=np.inf)
        ny, nx = self.bed.shape
        kept = max(1 - self.friction * self.hours, 0)
        finest = min(self.spacing)
        for k, (dy, dx) in enumerate(SIDES):
            beyond = level[1 + dy : 1 + dy + ny, 1 + dx : 1 + dx + nx]
            if not self.closed:
                beyond = np.where(np.isinf(beyond), self.bed, beyond)
            across = (finest / self.spacing[0 if dx else 1]) ** 2
            with np.errstate(invalid="ignore"):
                drive = 0.2 * across * (self.bed + self.water - beyond)
            self.flux[k] = np.maximum(kept * self.flux[k] + drive, 0)
        total = self.flux.sum(0)
        self.flux *= np.where(total > self.water, self.water / np.where(total > 0, total, 1), 1)

    def _carry(self) -> Array:
        """Move water and load, exchange rock, and return the bed without the slump."""
        ny, nx = self.bed.shape
        surface = np.pad(self.bed + self.water, 1, mode="edge")
        share = self.load / np.maximum(self.water, 1e-9)
        water, load = np.pad(self.water, 1), np.pad(self.load, 1)
        for k, (dy, dx) in enumerate(SIDES):
            for what, amount in ((water, self.flux[k]), (load, self.flux[k] * share)):
                what[1:-1, 1:-1] -= amount
                what[1 + dy : 1 + dy + ny, 1 + dx : 1 + dx + nx] += amount
        inner = water[1:-1, 1:-1].sum(), load[1:-1, 1:-1].sum()
        self.left = self.left + np.array([water.sum() - inner[0], load.sum() - inner[1]])
        self.water, self.load = np.maximum(water[1:-1, 1:-1], 0), load[1:-1, 1:-1]

        # The discharge of a metre of width: the mean of what comes and of what leaves, each a vector.
        # A side of a texel takes the amount over the texel's area through the length of that side.
        comes, leaves = np.zeros((2, ny + 2, nx + 2, 2))
        for k, (dy, dx) in enumerate(SIDES):
            volume = self.flux[k] * self.spacing[0] * self.spacing[1]
            along = volume / self.spacing[1 if dx else 0]
            leaves[1:-1, 1:-1, 0 if dx else 1] += along
            comes[1 + dy : 1 + dy + ny, 1 + dx : 1 + dx + nx, 0 if dx else 1] += along
        both = np.stack([comes, leaves])[:, 1:-1, 1:-1] / min(self.spacing)
        flow = np.linalg.norm(both, axis=3).mean(0)
        fall = np.hypot(
            (surface[1:-1, 2:] - surface[1:-1, :-2]) / (2 * self.spacing[0]),
            (surface[2:, 1:-1] - surface[:-2, 1:-1]) / (2 * self.spacing[1]),
        )
        # What it can carry depends on the amounts themselves, whichever way they go.
        can = self.capacity * both.sum(3).mean(0) * np.maximum(np.sin(np.arctan(fall)), 0.01)
        bed = np.pad(self.bed, 1, mode="edge")
        lowest = np.min([bed[1 + dy : 1 + dy + ny, 1 + dx : 1 + dx + nx] for dy, dx in SIDES], 0)
        taken = -np.expm1(-self.wear * self.hours) * (can - self.load)
        taken = np.minimum(taken, np.maximum(self.bed - lowest, 0) / 2)
        dropped = min(-np.expm1(-self.settling * self.hours), 0.5) * (self.load - can)
        change = np.where(can > self.load, taken, -dropped)
        self.load = self.load + change
        self.water = self.water / (1 + self.evaporation * self.hours) + self.rain * self.hours
        self.mean_flow = flow + (self.mean_flow - flow) * 50 / (50 + self.hours)
        return self.bed - change

    def _slump(self) -> Array:
        """Return what slides and creeps to each texel from its eight neighbours."""
        moved = np.zeros_like(self.bed)
        talus = np.tan(np.radians(self.repose))
        ny, nx = self.bed.shape
        for dy, dx in ((0, 1), (1, 0), (1, 1), (1, -1)):
            low = np.s_[: ny - dy, (1 if dx < 0 else 0) : (nx - 1 if dx > 0 else nx)]
            high = np.s_[dy:, (1 if dx > 0 else 0) : (nx - 1 if dx < 0 else nx)]
            rise = self.bed[high] - self.bed[low]
            away = np.hypot(dx * self.spacing[0], dy * self.spacing[1])
            moves = np.maximum(np.abs(rise) - talus * away, 0) / 8 * min(0.25 / self.hours, 1)
            if dy * dx == 0:
                moves += min(self.creep * self.hours / away**2, 0.1) * np.abs(rise)
            moves *= np.sign(rise)
            moved[low] += moves
            moved[high] -= moves
        return moved
