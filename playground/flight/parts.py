"""Cache the parts of the terrain around the eye: make what is near, drop what is far.

A part is made by the engine, which runs the sketch for it: height, colour and light of the
part and its apron. The part itself is cut out into a slot's textures, which are the
flight's own: heights at its nodes, and its ground, colour times light. There are as many
slots as may ever be wanted, and no more, so memory is bounded however long a flight is.

The order is: missing parts, nearest first, those in view before the rest; then parts that are
lit at another time of day. A part depends on its number alone, not on the way there, so a part
that is made again has the same bits.
"""

from __future__ import annotations

import math
import time
from collections.abc import Generator, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from playground.engine.engine import Engine
from playground.engine.textures import bytes_of, make_framebuffer, make_texture, read_texture
from playground.errors import SketchError
from playground.flight.layout import DAYLIGHT, DENSITY, FARTHEST, LIGHT, VISIBILITY, PartName, Plot
from playground.flight.programs import screen_program
from playground.sketch.model import Sketch

if TYPE_CHECKING:
    import moderngl


MAX_BYTES = 2 * 2**30
"""Of all parts in memory at once."""
BEHIND = 1.6
"""How many times its distance a part out of view counts when the next part is chosen."""
_SPARE = 12  # slots more than are ever wanted at once: after turning back, little is made again
_GRAIN = 4  # the eye's place is taken to this fraction of a part when parts are chosen
_HEADINGS = 32  # and its heading to this fraction of a circle


@dataclass(eq=False)
class Slot:
    """The textures of one part."""

    heights: moderngl.Texture  # r32f, a texel a node, 0..1 times relief
    ground: moderngl.Texture  # rgba16f with mipmaps, colour times light
    woods: moderngl.Texture | None  # rg8: how densely trees stand, what of the sun is visible
    nodes: NDArray[np.float32]  # the heights again, for the CPU: row 0 south
    hour: float = 0.0
    lowest: float = 0.0
    highest: float = 0.0
    mean: tuple[float, ...] = (0.1, 0.1, 0.1, 1.0)  # of its ground
    used: int = 0  # when it was last wanted
    grove: Grove | None = None  # its trees, once they are near

    @property
    def bytes(self) -> int:
        """Bytes held, mipmaps and the CPU's copy included."""
        ground = bytes_of(self.ground.size, "rgba16f")
        return bytes_of(self.heights.size, "r32f") + ground + ground // 3 + self.nodes.nbytes

    def release(self) -> None:
        """Release the textures."""
        self.heights.release()
        self.ground.release()
        if self.woods is not None:
            self.woods.release()


class Parts:
    """The parts around the eye, on one engine."""

    def __init__(self, engine: Engine, plot: Plot, radius: float) -> None:
        self.engine = engine
        self.plot = plot
        self.radius = radius  # in parts: all whose middle is as near as that are wanted
        self.hour = plot.first_hour()
        self.made = 0  # parts made so far, those lit again included
        self.slots: dict[PartName, Slot] = {}
        self._near = _around(radius)
        self.limit = len(self._near) + _SPARE
        _check_memory(plot, radius, self.limit)
        # Each part is a version of every pass, which is taken up again when the part is lit again.
        cache = engine.cache
        self._versions_before, cache.versions = cache.versions, max(cache.versions, self.limit)
        self._cutter = Cutter(engine.ctx, plot)
        self._spare: list[Slot] = []
        self.all_slots: list[Slot] = []  # those being filled included
        self._clock = 0
        self._sky_at: tuple[float, tuple[float, float, float]] | None = None  # the sky's light at an hour
        self._chosen: tuple[int, int, int] | None = None
        self._wanted: list[PartName] = []
        self._open: tuple[PartName, Generator[None, None, None]] | None = None  # the part being made

    # ── what is there ────────────────────────────────────────────────────────

    def __len__(self) -> int:
        return len(self.slots)

    @property
    def bytes(self) -> int:
        """Bytes of all slots."""
        return sum(slot.bytes for slot in self.all_slots)

    @property
    def visible(self) -> tuple[PartName, ...]:
        """The parts around the eye, the most wanted first."""
        return tuple(self._wanted)

    @property
    def missing(self) -> int:
        """How many of the wanted parts are not there, or are lit at another time of day."""
        return sum(1 for _ in self._lacking())

    def part_at(self, east: float, north: float) -> PartName:
        """Return the part under a place [m]."""
        width = self.plot.width
        return math.floor(east / width), math.floor(north / width)

    def ground_at(self, east: float, north: float) -> float:
        """Return the highest of the four nodes around a place [m above height 0]; makes the part if needed.

        It is above the ground between them, however that is drawn.
        """
        part = self.part_at(east, north)
        slot = self.slots.get(part) or self.make(part)
        n, spacing = self.plot.intervals, self.plot.spacing
        x = min(max(int((east - part[0] * self.plot.width) / spacing), 0), n - 1)
        y = min(max(int((north - part[1] * self.plot.width) / spacing), 0), n - 1)
        return float(slot.nodes[y : y + 2, x : x + 2].max()) * self.plot.relief

    # ── what is to come ──────────────────────────────────────────────────────

    def look(self, east: float, north: float, heading: float) -> None:
        """Set where the eye is [m] and its heading [radians from north]; drops nothing yet."""
        width = self.plot.width
        direction = round(heading / math.tau * _HEADINGS) % _HEADINGS
        now = (round(east / width * _GRAIN), round(north / width * _GRAIN), direction)
        if now == self._chosen:
            return
        self._chosen = now
        self._clock += 1
        x, y = now[0] / _GRAIN, now[1] / _GRAIN
        middle = math.floor(x), math.floor(y)
        ahead = math.sin(direction / _HEADINGS * math.tau), math.cos(direction / _HEADINGS * math.tau)
        offsets = self._near + middle
        away = offsets + 0.5 - (x, y)
        far = np.hypot(away[:, 0], away[:, 1])
        # Within a right angle of straight ahead; around the eye itself, nothing is behind.
        visible = (away @ ahead > 0.7 * far) | (far < 1.0)
        order = np.lexsort((offsets[:, 0], offsets[:, 1], np.where(visible, far, BEHIND * far)))
        nearest = order[far[order] <= self.radius]
        self._wanted = [(int(i), int(j)) for i, j in offsets[nearest]]
        for part in self._wanted:
            if part in self.slots:
                self.slots[part].used = self._clock

    def tend(self, parts: int) -> int:
        """Make at most so many parts; return how many were made."""
        made = 0
        while made < parts and (part := self._next()) is not None:
            self.make(part)
            made += 1
        return made

    def tend_for(self, seconds: float) -> int:
        """Go on making parts for so long, a stage at least; return how many stages were done.

        A part is made in stages, so that a picture need not wait for a whole one.
        """
        end, stages = time.perf_counter() + seconds, 0
        while stages == 0 or time.perf_counter() < end:
            if self._open is None:
                part = self._next()
                if part is None:
                    break
                self._open = part, self._stages(part)
            if next(self._open[1], self) is self:
                self._open = None
            elif not self.engine.info.software:
                self.engine.ctx.finish()  # the time is the graphics card's
            stages += 1
        return stages

    def make(self, part: PartName) -> Slot:
        """Make a part now, or light it again, and return it."""
        for _ in self._stages(part):
            pass
        return self.slots[part]

    def _stages(self, part: PartName) -> Generator[None, None, None]:
        """Make a part: each step runs one pass for it, the last puts it in its place.

        It is made in a slot that is not shown, so that the old light stays until the new one is complete.
        """
        hour = self.hour
        sketch = self.plot.at((_clamped(part[0]), _clamped(part[1])), hour)
        slot = self._take_slot(part)
        self._cutter.heights(slot.heights, self.engine.texture(sketch, "height"))
        yield
        for index, name in enumerate(self.plot.shares):
            sky = self._sky(sketch, hour) if name == LIGHT else (0.0, 0.0, 0.0)
            texture = self.engine.texture(sketch, name)
            self._cutter.ground(slot.ground, name, texture, first=index == 0, sky=sky)
            yield
        if not self.plot.shares:
            self._cutter.bare(slot.ground)
        if slot.woods is not None:
            self._cut_woods(slot.woods, sketch)
            slot.grove = None
            yield
        slot.ground.build_mipmaps()
        last = slot.ground.read(level=self.plot.ground.bit_length() - 1, alignment=1)
        slot.mean = tuple(float(n) for n in np.frombuffer(last, np.float16))
        # NaN and infinity are drawn at height 0, and the craft stays above that.
        slot.nodes = np.nan_to_num(read_texture(slot.heights), nan=0.0, posinf=0.0, neginf=0.0)
        slot.lowest, slot.highest = float(slot.nodes.min()), float(slot.nodes.max())
        slot.hour, slot.used = hour, self._clock
        before = self.slots.pop(part, None)
        if before is not None:
            self._spare.append(before)
        self.slots[part] = slot
        self.made += 1

    def _cut_woods(self, woods: moderngl.Texture, sketch: Sketch) -> None:
        """Cut how densely trees stand, and what of the sun is visible there."""
        self._cutter.sunny(woods)
        self._cutter.woods(woods, self.engine.texture(sketch, DENSITY), 0)
        if self.plot.light.has_visibility:
            self._cutter.woods(woods, self.engine.texture(sketch, VISIBILITY), 1)
        woods.build_mipmaps()

    def _sky(self, sketch: Sketch, hour: float) -> tuple[float, float, float]:
        """Return the sky's light in the light of a time of day; none where it is not known."""
        if self.plot.outdoors is None:
            return 0.0, 0.0, 0.0
        if self._sky_at is None or self._sky_at[0] != hour:
            red, green, blue = daylight_of(self.engine.read(sketch, DAYLIGHT)).sky
            times = self.plot.light.ambient
            self._sky_at = hour, (times * red, times * green, times * blue)
        return self._sky_at[1]

    def _next(self) -> PartName | None:
        return next(self._lacking(), None)

    def _lacking(self) -> Iterator[PartName]:
        """Yield the wanted parts that are not there, then those lit at another time of day."""
        yield from (part for part in self._wanted if part not in self.slots)
        if self.plot.hour:
            yield from (p for p in self._wanted if p in self.slots and self.slots[p].hour != self.hour)

    def _take_slot(self, part: PartName) -> Slot:
        """Return a slot to fill: a spare one, a new one, or the one least recently wanted."""
        if self._spare:
            return self._spare.pop()
        if len(self.all_slots) < self.limit:
            return self._new_slot()

        def recency(name: PartName) -> tuple[int, int, PartName]:
            away = (name[0] - part[0]) ** 2 + (name[1] - part[1]) ** 2
            return self.slots[name].used, -away, name

        return self.slots.pop(min(self.slots, key=recency))

    def _new_slot(self) -> Slot:
        ctx, n = self.engine.ctx, self.plot.intervals + 1
        heights = make_texture(ctx, (n, n), "r32f")
        heights.filter = (ctx.LINEAR, ctx.LINEAR)
        ground = make_texture(ctx, (self.plot.ground, self.plot.ground), "rgba16f")
        ground.filter = (ctx.LINEAR_MIPMAP_LINEAR, ctx.LINEAR)
        ground.anisotropy = 1.0 if self.engine.info.software else 8.0
        woods = None
        if self.plot.trees is not None:
            side = self.plot.intervals * self.plot.density + 1
            woods = make_texture(ctx, (side, side), "rg8")
            woods.filter = (ctx.LINEAR_MIPMAP_LINEAR, ctx.LINEAR)
        for texture in filter(None, (heights, ground, woods)):
            texture.repeat_x = texture.repeat_y = False
        self.all_slots.append(Slot(heights, ground, woods, np.zeros((n, n), np.float32)))
        return self.all_slots[-1]

    def release(self) -> None:
        """Release every texture."""
        self.engine.cache.versions = self._versions_before
        if self._open is not None:
            self._open[1].close()
        for slot in self.all_slots:
            slot.release()
        self.all_slots.clear()
        self.slots.clear()
        self._spare.clear()
        self._cutter.release()


def _check_memory(plot: Plot, radius: float, slots: int) -> None:
    """Raise ``SketchError`` where the visible parts would take more than ``MAX_BYTES``."""
    nodes, ground = (plot.intervals + 1) ** 2, plot.ground**2 * 8
    each = 2 * 4 * nodes + ground + ground // 3
    if each * slots <= MAX_BYTES:
        return
    fits = [r / 2 for r in range(3, 33) if each * (len(_around(r / 2)) + _SPARE) <= MAX_BYTES]
    way = f"; --radius {fits[-1]:g} would fit" if fits else "; smaller parts would be less"
    raise SketchError(
        f"sketch {plot.sketch.name}: {slots} parts of {each / 2**20:.0f} MiB, as many as are visible within "
        f"{radius:g}, are more than {MAX_BYTES / 2**30:g} GiB{way}",
        file=plot.sketch.file,
    )


def _around(radius: float) -> NDArray[np.int64]:
    """Return the parts that may be wanted from anywhere in part (0, 0)."""
    farthest = math.ceil(radius) + 1
    steps = np.arange(-farthest, farthest + 1)
    grid = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    # How far the middle of a part is from the nearest place in part (0, 0).
    far = np.maximum(np.abs(grid) - 0.5, 0.0)
    offsets: NDArray[np.int64] = grid[np.hypot(far[:, 0], far[:, 1]) <= radius]
    return offsets


def _clamped(number: int) -> int:
    """Clamp a part's number so that its nodes fit an integer of 32 bits: the terrain ends there."""
    return min(max(number, -FARTHEST), FARTHEST)


# ── cut from the sketch's textures ─────────────────────────────────────────────


PROGRAMS = ("part_heights", "part_ground", "part_map")


class Cutter:
    """Fills a slot's textures; the light is multiplied into the colour that is there."""

    def __init__(self, ctx: moderngl.Context, plot: Plot) -> None:
        self.ctx: Any = ctx
        self.plot = plot
        self._programs = [screen_program(ctx, name) for name in PROGRAMS]
        self._arrays = [ctx.vertex_array(program, []) for program in self._programs]
        self._surfaces: dict[int, moderngl.Framebuffer] = {}  # by the texture's own number

    def heights(self, target: moderngl.Texture, source: moderngl.Texture) -> None:
        """Cut the heights of the part's own nodes."""
        self._draw(0, target, source, apron=self.plot.apron)

    def ground(
        self,
        target: moderngl.Texture,
        name: str,
        source: moderngl.Texture,
        *,
        first: bool,
        sky: tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> None:
        """Cut the part's own texels, over what is there or times it; ``sky``: its light in the source."""
        start, rise = self.plot.shares[name]
        if not first:
            self.ctx.enable_only(self.ctx.BLEND)
            self.ctx.blend_func = self.ctx.DST_COLOR, self.ctx.ZERO
        self._draw(1, target, source, first=start, rise=rise, sky=sky)
        self.ctx.enable_only(0)
        self.ctx.blend_func = self.ctx.DEFAULT_BLENDING

    def woods(self, target: moderngl.Texture, source: moderngl.Texture, channel: int) -> None:
        """Cut one number of the part's own texels into a channel."""
        plot, surface = self.plot, self._surface(target)
        each = (source.width - 1) / (plot.intervals + 2 * plot.apron)
        rise = each * plot.intervals / (target.width - 1)
        surface.color_mask = channel == 0, channel == 1, False, False
        self._draw(2, target, source, first=plot.apron * each, rise=rise)
        surface.color_mask = True, True, True, True

    def sunny(self, target: moderngl.Texture) -> None:
        """Leave all of the sun to woods: the sketch does not say what of it is visible."""
        self._surface(target).clear(0.0, 1.0, 0.0, 0.0)

    def bare(self, target: moderngl.Texture) -> None:
        """Fill with grey: the sketch has neither colour nor light."""
        self._surface(target).clear(0.7, 0.7, 0.7, 1.0)

    def release(self) -> None:
        """Release programs and framebuffers."""
        owned: list[Any] = [*self._surfaces.values(), *self._arrays, *self._programs]
        for item in owned:
            item.release()
        self._surfaces.clear()

    def _draw(self, which: int, target: moderngl.Texture, source: moderngl.Texture, **values: Any) -> None:
        surface = self._surface(target)
        surface.use()
        surface.viewport = (0, 0, *target.size)
        self.ctx.clear_samplers(0, 1)
        source.use(0)
        program = self._programs[which]
        for name, value in {"source": 0, **values}.items():
            program[name].value = value  # type: ignore[union-attr]
        self._arrays[which].render(self.ctx.TRIANGLES, vertices=3)

    def _surface(self, target: moderngl.Texture) -> moderngl.Framebuffer:
        if target.glo not in self._surfaces:
            self._surfaces[target.glo] = make_framebuffer(self.ctx, [target])
        return self._surfaces[target.glo]


# ── sun and sky ────────────────────────────────────────────────────────────────


Three = tuple[float, float, float]


class Daylight(NamedTuple):
    """Sun and sky at one time of day."""

    to_sun: Three = (0.0, 0.0, 1.0)
    sun: Three = (0.0, 0.0, 0.0)  # its light on what faces it; none where it is below the horizon
    sky: Three = (0.0, 0.0, 0.0)  # the sky's on open level ground
    day: float = 0.0  # of the year, from the first of January


def daylight_of(texels: NDArray[np.float32]) -> Daylight:
    """Return what the texels of a daylight say (rows, columns, 4); few have but the sun's place."""
    row = texels[0, :, :].astype(float)
    to_sun = _three(row[0])
    if len(row) < 6:
        return Daylight(to_sun)
    sun = _three(row[1]) if to_sun[2] > 0 else (0.0, 0.0, 0.0)
    return Daylight(to_sun, sun, _three(row[2]), float(row[5, 3]))


def _three(texel: NDArray[np.float64]) -> Three:
    return float(texel[0]), float(texel[1]), float(texel[2])


# ── trees ──────────────────────────────────────────────────────────────────────


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
