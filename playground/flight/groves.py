"""Find the trees of a part: made once on the graphics card, then sorted so that a picture takes few of them.

Trees are in blocks, and in each by their rank: of a block so far away that a fraction of its trees
is drawn, those are its first.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.engine.textures import make_framebuffer, make_texture, read_texture
from playground.flight.layout import PartName, Plot
from playground.flight.programs import screen_program

if TYPE_CHECKING:
    import moderngl

BLOCK = 32  # [cells] a side


@dataclass(frozen=True)
class Grove:
    """The trees of one part."""

    trees: NDArray[np.float32]  # (n, 7): east and north in the part, up [m], how tall [m]; rank, density, sun
    places: NDArray[np.float64]  # (n,): the number of its block, and its rank
    low: NDArray[np.float64]  # (blocks, 3): the corners of a block's feet, from the part's corner [m]
    high: NDArray[np.float64]

    @property
    def blocks(self) -> int:
        """How many blocks have trees, or could."""
        return len(self.low)

    def first_of(self, blocks: NDArray[np.intp], shares: NDArray[np.float64]) -> NDArray[np.intp]:
        """Return the numbers of the trees that have ranks below so much in some blocks, in their order."""
        starts = np.searchsorted(self.places, blocks)
        counts = np.searchsorted(self.places, blocks + np.minimum(shares, 0.999999)) - starts
        before = np.cumsum(counts) - counts
        indices: NDArray[np.intp] = np.repeat(starts - before, counts) + np.arange(counts.sum())
        return indices


class Planter:
    """Makes the trees of parts from their heights and densities."""

    def __init__(self, ctx: moderngl.Context, plot: Plot) -> None:
        assert plot.trees is not None
        self.ctx = ctx
        self.plot = plot
        self.cells, self.side = cells_of(plot)
        self._program = screen_program(ctx, "part_trees")
        self._array = ctx.vertex_array(self._program, [])
        self._textures = [make_texture(ctx, (self.cells, self.cells), "rgba32f") for _ in range(2)]
        self._surface = make_framebuffer(ctx, self._textures)

    def plant(self, part: PartName, heights: moderngl.Texture, woods: moderngl.Texture) -> Grove:
        """Return the trees of a part."""
        plot, trees = self.plot, self.plot.trees
        assert trees is not None
        self._surface.use()
        self._surface.viewport = (0, 0, self.cells, self.cells)
        self.ctx.enable_only(0)
        self.ctx.clear_samplers(0, 2)
        heights.use(0)
        woods.use(1)
        sea = plot.view.sea_level - plot.base if plot.view.sea else -1e9
        first = tuple(_wrapped(number * self.cells) for number in part)
        values: dict[str, Any] = {"heights": 0, "woods": 1, "first": first, "side": self.side, "lowest": sea}
        values |= {"width": plot.width, "relief": plot.relief, "seed": int(trees["seed"])}
        values |= {name: trees[name] for name in ("tallest", "shortest")}
        for name, value in values.items():
            self._program[name].value = value  # type: ignore[union-attr]
        self._array.render(self.ctx.TRIANGLES, vertices=3)
        tree, own = (read_texture(texture) for texture in self._textures)
        return _sorted(tree, own, self.side)

    def release(self) -> None:
        """Release program, textures and framebuffer."""
        owned: list[Any] = [self._surface, self._array, self._program, *self._textures]
        for item in owned:
            item.release()


def cells_of(plot: Plot) -> tuple[int, float]:
    """Return how many cells a part is wide, a whole number so that they fit, and how wide a cell is [m]."""
    assert plot.trees is not None
    cells = max(round(plot.width / plot.trees["cell"]), 1)
    return cells, plot.width / cells


def _wrapped(number: int) -> int:
    """Return a number as 32 bits have it."""
    return (number + 2**31) % 2**32 - 2**31


def _sorted(tree: NDArray[np.float32], own: NDArray[np.float32], side: float) -> Grove:
    rows, columns = np.nonzero(tree[..., 3] > 0)
    across = -(-tree.shape[1] // BLOCK)
    block = rows // BLOCK * across + columns // BLOCK
    trees = np.concatenate([tree[rows, columns], own[rows, columns, :3]], axis=1)
    places = block + np.minimum(trees[:, 4].astype(np.float64), 0.999999)
    order = np.argsort(places)
    trees, places, block = trees[order], places[order], block[order]
    blocks = across * (-(-tree.shape[0] // BLOCK))
    west, south = np.arange(blocks) % across, np.arange(blocks) // across
    low = np.stack([west, south, np.zeros(blocks)], axis=1) * (BLOCK * side)
    high = low + BLOCK * side
    ups, downs = np.full(blocks, -np.inf), np.full(blocks, np.inf)
    np.maximum.at(ups, block, trees[:, 2])
    np.minimum.at(downs, block, trees[:, 2])
    # Of a block without trees nothing is taken.
    low[:, 2], high[:, 2] = (np.where(np.isfinite(up), up, 0.0) for up in (downs, ups))
    return Grove(trees, places, low, high)
