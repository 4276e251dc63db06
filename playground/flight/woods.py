"""Draw the trees around the craft, and say what woods make of the ground beyond the last of them.

Each tree that is large enough in the picture is drawn; farther away fewer are, larger, and the
ground has the colour of the rest (trees/level, trees/stand). Which trees those are depends on
their own distance and rank alone, so none appears or goes at once.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.engine.engine import Engine
from playground.engine.textures import make_framebuffer, make_texture, read_texture
from playground.flight.craft import Lens
from playground.flight.layout import PartName, Plot
from playground.flight.parts import Daylight, Grove, Parts, Planter, cells_of
from playground.flight.programs import screen_program, trees_program

if TYPE_CHECKING:
    import moderngl

MAX_TREES = 2**16  # of a picture
MIN_TREE_PIXELS, MIN_TREE_PIXELS_ON_SOFTWARE = 5.0, 12.0
"""[pixels] The tallest trees, where the first is left out: on a graphics card, on a processor."""
BEYOND = 4.0
"""Times as far away, the last is."""
_LEVELS = 512  # distances at which the share is known that is drawn
_FLOATS = 9  # of a tree on the graphics card


class Row:
    """A row of texels that a program fills."""

    def __init__(self, ctx: moderngl.Context, name: str, length: int, form: str) -> None:
        self.ctx: Any = ctx
        self.texture = make_texture(ctx, (length, 1), form)
        self._program = screen_program(ctx, name)
        self._array = ctx.vertex_array(self._program, [])
        self._surface = make_framebuffer(ctx, [self.texture])

    def render(self, **values: float) -> None:
        """Fill it."""
        self._surface.use()
        self._surface.viewport = (0, 0, *self.texture.size)
        self.ctx.enable_only(0)
        for name, value in values.items():
            self._program[name].value = value  # type: ignore[union-attr]
        self._array.render(self.ctx.TRIANGLES, vertices=3)

    def release(self) -> None:
        """Release it."""
        for item in (self._surface, self._array, self._program, self.texture):
            item.release()


class Woods:
    """The trees of a flight over one sketch; use ``release()`` at the end."""

    def __init__(self, engine: Engine, plot: Plot) -> None:
        assert plot.trees is not None
        ctx: Any = engine.ctx
        self.ctx, self.plot, self._trees = ctx, plot, plot.trees
        self.drawn = 0  # trees of the last picture
        self.level_from: tuple[float, float, float] | None = None
        """Where levels of detail are chosen from [m]; None: from the eye."""
        self._smallest = MIN_TREE_PIXELS_ON_SOFTWARE if engine.info.software else MIN_TREE_PIXELS
        self._cell = cells_of(plot)[1]
        self._planter = Planter(ctx, plot)
        self._program = trees_program(ctx)
        self._corners = ctx.buffer(np.array([-1, -1, 1, -1, -1, 1, 1, 1], np.float32).tobytes())
        self._buffer = ctx.buffer(reserve=MAX_TREES * _FLOATS * 4)
        content = [(self._corners, "2f", "corner"), (self._buffer, "4f 3f 2f/i", "tree", "own", "part")]
        self._array = ctx.vertex_array(self._program, content)
        sizes = {"drawn_share": (_LEVELS, "r32f"), "leaf_colours": (2, "rgba32f")}
        self._tables = {name: Row(ctx, name, *size) for name, size in sizes.items()}
        self._leaves: tuple[float, list[tuple[float, ...]]] | None = None
        self._known: tuple[float, NDArray[np.float32]] | None = None

    def whole_at(self, lens: Lens) -> float:
        """Return up to where all trees are drawn [m]."""
        return float(self._trees["tallest"] / (self._smallest * lens.pixel))

    def values(
        self, parts: Parts, eye: tuple[float, float, float], lens: Lens, light: Daylight
    ) -> dict[str, Any]:
        """Choose the trees of a picture; return what programs are given that draw them, and the ground."""
        level, whole = self.level_from or eye, self.whole_at(lens)
        names = ("tallest", "shortest", "needles", "needles_from", "ragged")
        values: dict[str, Any] = {name: self._trees[name] for name in names}
        values |= {"whole": whole, "reach": BEYOND * whole, "cell": self._cell, "day": light.day}
        values |= {"base": self.plot.base, "leaf_colours": self._colours(light.day)}
        values["sun_light"] = tuple(self.plot.light.gain * n for n in light.sun)
        values["sky_light"] = tuple(self.plot.light.ambient * n for n in light.sky)
        values["level_eye"] = tuple(at - to for at, to in zip(eye, level, strict=True))
        return values | {"room": self._choose(parts, eye, lens)}

    def _choose(self, parts: Parts, eye: tuple[float, float, float], lens: Lens) -> float:
        """Choose the trees of a picture; return the share that there is room for."""
        reach = BEYOND * self.whole_at(lens)
        shares = self._shares(self.whole_at(lens), reach)
        level = np.array(self.level_from or eye)
        chosen = [
            self._of_part(self._grove(parts, part), part, eye, level, lens, shares, reach)
            for part in self._near(parts, eye, reach)
        ]
        trees = np.concatenate(chosen) if chosen else np.zeros((0, _FLOATS), np.float32)
        room = 1.0
        if len(trees) > MAX_TREES:
            places = trees[:, :3] + np.column_stack([trees[:, 7:9], np.full(len(trees), -eye[2])])
            far = np.linalg.norm(places - (level - eye), axis=1)
            keys = trees[:, 4] / np.maximum(np.interp(far, *shares), 1e-9)
            room = min(float(np.partition(keys, MAX_TREES)[MAX_TREES]), 1.0)
            trees = trees[keys < room][:MAX_TREES]
        self.drawn = len(trees)
        self._buffer.orphan()
        self._buffer.write(np.ascontiguousarray(trees, np.float32).tobytes())
        return room

    def draw(self, values: dict[str, Any]) -> None:
        """Draw the trees chosen, with the uniforms given."""
        for name, value in values.items():
            uniform: Any = self._program.get(name, None)
            if uniform is not None:
                uniform.value = value
        if self.drawn:
            self._array.render(self.ctx.TRIANGLE_STRIP, vertices=4, instances=self.drawn)

    def release(self) -> None:
        """Release everything."""
        self._planter.release()
        owned = (self._array, self._program, self._corners, self._buffer, *self._tables.values())
        for item in owned:
            item.release()

    def _near(self, parts: Parts, eye: tuple[float, float, float], reach: float) -> Iterable[PartName]:
        """Return the parts that have trees to draw, the nearest first."""
        width, parts_near = self.plot.width, []
        for part in parts.visible:
            east, north = (
                max(n * width - at, at - (n + 1) * width, 0.0) for n, at in zip(part, eye, strict=False)
            )
            far = float(np.hypot(east, north))
            if part in parts.slots and far < reach:
                parts_near.append((far, part))
        return [part for _, part in sorted(parts_near)]

    def _grove(self, parts: Parts, part: PartName) -> Grove:
        slot = parts.slots[part]
        assert slot.woods is not None
        if slot.grove is None:
            slot.grove = self._planter.plant(part, slot.heights, slot.woods)
        return slot.grove

    def _of_part(
        self,
        grove: Grove,
        part: PartName,
        eye: tuple[float, float, float],
        level: NDArray[np.float64],
        lens: Lens,
        shares: tuple[NDArray[np.float64], NDArray[np.float32]],
        reach: float,
    ) -> NDArray[np.float32]:
        """Return those of a part that may be drawn (n, 9), from the nearest block to the farthest."""
        corner = np.array([part[0] * self.plot.width, part[1] * self.plot.width, 0.0])
        low, high = grove.low + (corner - eye), grove.high + (corner - eye)
        # No tree is larger than where the last of them are.
        tall = 2 * self._trees["tallest"] * BEYOND
        visible = lens.sees(low - (tall, tall, 0.0), high + tall)
        offset = level - eye
        gap = np.maximum(np.maximum(low - offset, offset - high), 0.0)
        far = np.sqrt((gap**2).sum(axis=1))
        blocks = np.nonzero(visible & (far < reach))[0]
        blocks = blocks[np.argsort(far[blocks], kind="stable")]
        first = grove.first_of(blocks, np.interp(far[blocks], *shares))
        moved = np.broadcast_to((corner[:2] - eye[:2]).astype(np.float32), (len(first), 2))
        return np.concatenate([grove.trees[first], moved], axis=1)

    def _colours(self, day: float) -> list[tuple[float, ...]]:
        """Return the colours of broad leaves and of needles on a day of the year (trees/kinds)."""
        if self._leaves is None or self._leaves[0] != day:
            self._tables["leaf_colours"].render(day=day)
            texture = read_texture(self._tables["leaf_colours"].texture)[0, :, :3]
            self._leaves = day, [tuple(float(n) for n in colour) for colour in texture]
        return self._leaves[1]

    def _shares(self, whole: float, reach: float) -> tuple[NDArray[np.float64], NDArray[np.float32]]:
        """Return distances [m] and the fraction of trees that is drawn there (trees/level)."""
        if self._known is None or self._known[0] != whole:
            self._tables["drawn_share"].render(whole=whole, reach=reach, texels=float(_LEVELS))
            self._known = whole, read_texture(self._tables["drawn_share"].texture)[0]
        return np.linspace(0.0, reach, _LEVELS), self._known[1]
