"""Cache an engine's expensive textures on disk, and take them from there.

What passes cost is measured as they run. Once the terrain has not changed for a moment, the textures
that are worth it are read back a piece at a time, and the disk cache's own thread writes them: no
frame waits for either. The next time, an engine with this disk cache reads them and does not run
the passes at all; a pass in between that is needed after all, runs then. On a software renderer
their mipmaps are cached too: a graphics card makes them faster than a disk is read.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from playground.engine.cache import Cache, Cached
from playground.engine.cache_keys import Keys
from playground.engine.disk_cache import CachedTextures, DiskCache
from playground.engine.disk_cache_choice import choose, passing, worth_caching
from playground.engine.execution import Execution
from playground.engine.gl_calls import read_mipmap, write_mipmaps
from playground.engine.plan import Plan, PlanNode, Step, needed
from playground.engine.textures import bytes_of, levels_of, read_block
from playground.memo import Memo
from playground.sketch.flat import Ref

if TYPE_CHECKING:
    import moderngl

    from playground.engine.renderer import Renderer

FLOOR = 20.0  # [ms] that a read must save: less is not visible
RATE = 250e3  # [bytes/ms] from a slow disk to the graphics card, checksum included
MIPMAPS = 90.0  # [ms] that llvmpipe takes in each process to compile what makes the first mipmaps of a format
REST = 1.0  # [s] without another piece of terrain before one is written
PIECE = 4 * 2**20  # [bytes] read back at once
_MAX_COSTS = 4096


def read_time(size: int) -> float:
    """Return what it takes to read so many bytes from the disk cache [ms]."""
    return size / RATE


class DiskCaching:
    """Reads and writes an engine's textures in a disk cache; ``now`` is a clock in seconds."""

    def __init__(
        self,
        store: DiskCache,
        *,
        floor: float = FLOOR,
        rest: float = REST,
        now: Callable[[], float] = time.perf_counter,
    ) -> None:
        self.store = store
        self.floor = floor  # [ms]
        self.rest = rest  # [s]
        self.skips = True  # passes whose textures nothing reads are not run
        self.skipped: frozenset[str] = frozenset()  # those of the last frame, by path
        self.reads = 0  # textures of passes read so far
        self._now = now
        # [ms] by the key of the step or the loop
        self._costs: Memo[str, float] = Memo("costs of results", _MAX_COSTS)
        self._costed_at = 0.0
        self._is_new = False  # something was computed since the last look
        self._work: Iterator[None] | None = None

    @property
    def going(self) -> bool:
        """Whether textures are being read back."""
        return self._work is not None

    # ── while a frame is made ────────────────────────────────────────────────

    def begin(self, execution: Execution, plan: Plan, ref: Ref) -> list[PlanNode]:
        """Read what the disk cache has of a texture, have the rest measured, and return what is to be run."""
        runner, keys = execution.runner, execution.keys
        passes = passing(plan, runner.painted)

        def read(step: Step) -> bool:
            return step.path not in passes and self._take(execution, step, keys.result(step.path))

        def timed(path: str, key: str) -> AbstractContextManager[None]:
            if path in passes:
                return nullcontext()
            return self._timed(runner.ctx.finish, key, lambda: runner.works.took.pop(path, 0.0))

        found = choose(keys, needed(plan.nodes, ref), ref, execution.cache.get, read, skips=self.skips)
        self.skipped = found.skipped
        execution.results, execution.timed = found.taken, timed
        return found.nodes

    def would_run(
        self, cache: Cache, plan: Plan, keys: Keys, ref: Ref, painted: Collection[Path]
    ) -> list[PlanNode]:
        """Return what ``begin`` would; nothing is read. ``painted`` are files as ``passing`` takes them."""
        passes = passing(plan, painted)

        def read(step: Step) -> bool:
            return step.path not in passes and keys.result(step.path) in self.store

        return choose(keys, needed(plan.nodes, ref), ref, cache.peek, read, skips=self.skips).nodes

    @contextmanager
    def _timed(
        self, wait: Callable[[], None], key: str, before: Callable[[], float] = lambda: 0.0
    ) -> Iterator[None]:
        """Measure what a step or a loop takes; both ends ``wait`` for the driver.

        ``before`` returns what it has taken already, in a thread [s].
        """
        wait()
        start = self._now()
        yield
        wait()
        self._costed_at, self._is_new = self._now(), True
        self._note(key, (self._costed_at - start + before()) * 1e3)

    def _take(self, execution: Execution, step: Step, key: str) -> bool:
        """Put what the disk cache has of a step into the cache in memory."""
        cached, outputs = self.store.read(key), step.kernel.outputs
        wanted = step.size, tuple((o.name, o.format) for o in outputs)
        if cached is None or (cached.size, cached.outputs) != wanted:
            return False
        result = execution.runner.pool.take(step.size, outputs)
        for output, data in zip(outputs, cached.data, strict=True):
            texture, own = result.textures[output.name], bytes_of(step.size, output.format)
            texture.write(data[:own], alignment=1)
            if output.name in cached.mipmapped:
                result.release_framebuffer()  # the texels move, as where mipmaps are made
                write_mipmaps(texture, levels_of(step.size)[1:], data[own:])
                result.mipmapped.add(output.name)
        execution.cache.put(key, Cached({step.path: result}))
        self._note(key, cached.cost)
        self.reads += 1
        return True

    def _note(self, key: str, cost: float) -> None:
        self._costs.put(key, cost)

    # ── at rest ──────────────────────────────────────────────────────────────

    def look(self, source: Renderer, plan: Plan) -> float | None:
        """Do a piece of the work for the frame of a plan; return in how many seconds to call again.

        None: not before another frame has run something.
        """
        if self._work is not None:
            with source.borrowed():
                ended = next(self._work, self) is self
            if not ended:
                return 0.0
            self._work = None
        if not self._is_new:
            return None
        left = self._costed_at + self.rest - self._now()
        if left > 0:
            return left
        self._is_new = False
        if source.record.plan is not plan:  # a texture was read since
            source.recall(plan)
        self._work = self._write_all(source, plan, source.record.keys)
        return 0.0

    def finish(self, source: Renderer, plan: Plan) -> None:
        """Do all work for the frame of a plan at once, and wait until it is written."""
        self._costed_at -= self.rest
        while self.look(source, plan) is not None:
            pass
        self.close()

    def close(self) -> None:
        """Wait until all that was read back is written."""
        self._work = None
        self.store.close()

    def _write_all(self, source: Renderer, plan: Plan, keys: Keys) -> Iterator[None]:
        """Write what is worth it, a piece at a time; ends early where a texture is gone."""
        passes, costs = passing(plan, source.runner.painted), self._costs
        more: dict[str, float] = {}
        if source.runner.info.software:  # one texture whose mipmaps are made anew has that compiled again
            more = {path: MIPMAPS for path, result in source.record.results.items() if result.mipmapped}
        for worth in worth_caching(plan, keys, plan.picture, passes, costs, read_time, self.floor, more):
            known = source.record.keys.steps.get(worth.path)
            if known is None or known.result != worth.key:
                self._is_new = True  # another sketch was drawn since
                return
            result = source.record.results.get(worth.path)
            if result is None or worth.key in self.store:
                continue
            mipmapped = frozenset(result.mipmapped if source.runner.info.software else ())
            outputs = tuple((o.name, o.format) for o in result.outputs)
            made_for = f"{plan.sketch.name}: {worth.path}"
            cached = CachedTextures(result.size, outputs, worth.cost, made_for, mipmapped=mipmapped)
            if not self.store.fits(cached.bytes):
                continue
            parts: list[memoryview] = []
            for name, form in outputs:
                whole, at = bytearray(cached.bytes_of_output(name, form)), 0
                for level, south, north in _pieces(result.size, form, mipmapped=name in mipmapped):
                    if source.record.results.get(worth.path) is not result:
                        self._is_new = True  # another frame was made, and the texture may be another's by now
                        return
                    part = _read_piece(result.textures[name], level, south, north)
                    whole[at : at + len(part)] = part
                    at += len(part)
                    yield
                parts.append(memoryview(whole).toreadonly())
            self.store.write(worth.key, replace(cached, data=tuple(parts)))


def _pieces(size: tuple[int, int], form: str, *, mipmapped: bool) -> Iterator[tuple[int, int, int]]:
    """Yield how a texture is read back: rows of it, then each mipmap whole, as level, first row and end."""
    rows = max(PIECE * size[1] // bytes_of(size, form), 1)
    yield from ((0, south, min(south + rows, size[1])) for south in range(0, size[1], rows))
    if mipmapped:
        yield from ((level, 0, high) for level, (_, high) in enumerate(levels_of(size)[1:], 1))


def _read_piece(texture: moderngl.Texture, level: int, south: int, north: int) -> bytes:
    if level:
        return read_mipmap(texture, level, levels_of(texture.size)[level])
    return read_block(texture, (0, south), (texture.size[0], north - south))
