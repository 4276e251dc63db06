"""Cache an engine's expensive textures on disk, and take them from there.

The camera, the window's size and the time change a sketch's last passes all the time; what
they read of the terrain stays. Where that meets is the frontier: of the passes that stay, those
that are read by one that does not. A reopened sketch takes the frontier from the disk, and
the passes behind it are not run at all. Of a pass that stays, two times are compared: what it took to
compute, with what it depends on computed or read, and what it would take to read it. It is read where that
saves enough.

What passes cost is measured as they run. Once the terrain has not changed for a moment, the textures
that are worth it are read back a piece at a time, and the disk cache's own thread writes them: no
frame waits for either. A pass in between that is needed after all, runs then. Where the renderer takes longer
to make mipmaps than a disk to give them (``Tuning.mipmap_cost``), they are cached too.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from playground.engine.cache import Cache
from playground.engine.cache_keys import Keys
from playground.engine.disk_cache import CachedTextures, DiskCache
from playground.engine.execution import Execution, FrameSource
from playground.engine.gl_calls import read_mipmap, write_mipmaps
from playground.engine.plan import (
    LoopStep,
    Plan,
    PlanNode,
    Step,
    every_node,
    needed,
    sources_of,
    walk,
)
from playground.engine.results import Cached, Result
from playground.engine.textures import bytes_of, levels_of, read_block
from playground.memo import PLANS, Memo
from playground.shader.expressions import follows_time
from playground.shader.reserved_names import OF_THE_TERRAIN
from playground.sketch.flat import Ref
from playground.sketch.model import PlainShader

if TYPE_CHECKING:
    import moderngl


FLOOR = 20.0  # [ms] that a read must save: less is not visible
RATE = 250e3  # [bytes/ms] from a slow disk to the graphics card, checksum included
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
        self.costs: Memo[str, float] = Memo("costs of results", _MAX_COSTS)
        self._costed_at = 0.0
        self.pending = False  # something was computed since the last look
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

        choice = choose(keys, needed(plan.nodes, ref), ref, execution.cache.get, read, skips=self.skips)
        self.skipped = choice.skipped
        execution.results, execution.timed = choice.taken, timed
        return choice.nodes

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
        self._costed_at, self.pending = self._now(), True
        self._note(key, (self._costed_at - start + before()) * 1e3)

    def _take(self, execution: Execution, step: Step, key: str) -> bool:
        """Put what the disk cache has of a step into the cache in memory."""
        cached, outputs = self.store.read(key), step.kernel.outputs
        expected = step.size, tuple((o.name, o.format) for o in outputs)
        if cached is None or (cached.size, cached.outputs) != expected:
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
        self.costs.put(key, cost)

    # ── at rest ──────────────────────────────────────────────────────────────

    def look(self, source: FrameSource, plan: Plan) -> float | None:
        """Do a piece of the work for the frame of a plan; return in how many seconds to call again.

        None: not before another frame has run something.
        """
        if self._work is not None:
            with source.borrowed():
                ended = next(self._work, self) is self
            if not ended:
                return 0.0
            self._work = None
        if not self.pending:
            return None
        left = self._costed_at + self.rest - self._now()
        if left > 0:
            return left
        self.pending = False
        if source.record.plan is not plan:  # a texture was read since
            source.recall(plan)
        self._work = self._write_all(source, plan, source.record.keys)
        return 0.0

    def finish(self, source: FrameSource, plan: Plan) -> None:
        """Do all work for the frame of a plan at once, and wait until it is written."""
        self._costed_at -= self.rest
        while self.look(source, plan) is not None:
            pass
        self.close()

    def close(self) -> None:
        """Wait until all that was read back is written."""
        self._work = None
        self.store.close()

    def _write_all(self, source: FrameSource, plan: Plan, keys: Keys) -> Iterator[None]:
        """Write what is worth it, a piece at a time; ends early where a texture is gone."""
        passes, costs = passing(plan, source.runner.painted), self.costs
        mipmaps = source.runner.tuning.mipmap_cost
        more = {path: mipmaps for path, result in source.record.results.items() if result.mipmapped}
        for worth in worth_caching(plan, keys, plan.picture, passes, costs, read_time, self.floor, more):
            step = source.record.keys.steps.get(worth.path)
            if step is None or step.result != worth.key:
                self.pending = True  # another sketch was drawn since
                return
            result = source.record.results.get(worth.path)
            if result is None or worth.key in self.store:
                continue
            mipmapped = frozenset(result.mipmapped if mipmaps else ())
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
                        self.pending = True  # another frame was made, and the texture may be another's by now
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


_PASSING = ("time", "clip_from_world", "world_from_clip", "eye")  # given names that change while one looks


def passing(plan: Plan, painted: Collection[Path] = ()) -> frozenset[str]:
    """Return the paths of the steps and loops of a plan that are never cached on disk.

    What reads the time, the camera or the mouse, has a texel for each pixel of the picture, is
    stopped before its last iteration or gone on from by a later draw, or reads a file that is
    ``painted`` in this process, which no other one knows by its version; and each that reads such a one.
    """
    return _passing(plan.nodes, plan.frame_size, plan.continued, frozenset(painted))


@PLANS.cached(identities=1)
def _passing(
    nodes: tuple[PlanNode, ...],
    frame_size: tuple[int, int],
    continued: frozenset[str],
    painted: frozenset[Path],
) -> frozenset[str]:
    """Return what ``passing`` does, worked out once for the frames that have the same passes."""
    names: set[str] = set()
    for node in nodes:
        reads = {source.path for source in sources_of(node) if isinstance(source, Ref)}
        steps = list(walk((node,)))
        loops = [loop for loop in every_node((node,)) if isinstance(loop, LoopStep)]
        own = any(_passes(step, frame_size, continued) or _reads_one(step, painted) for step in steps)
        if own or reads & names or any(_stops(loop) for loop in loops):
            names |= {node.path, *(step.path for step in steps)}
    return frozenset(names)


def _reads_one(step: Step, files: Collection[Path]) -> bool:
    named = (step.values[p.name] for p in step.kernel.parameters if p.widget.kind == "file")
    return bool(files) and any(Path(str(value)) in files for value in named)


def _stops(loop: LoopStep) -> bool:
    return follows_time(loop.spec.repeat) or loop.repeat != loop.total


def _passes(step: Step, frame_size: tuple[int, int], continued: Collection[str]) -> bool:
    kernel = step.kernel
    if (
        isinstance(kernel, PlainShader)
        or not set(kernel.depends) <= set(OF_THE_TERRAIN)
        or step.path in continued
        or step.window is not None
    ):
        return True
    if step.size == frame_size or step.repeat != step.total:
        return True
    if follows_time(kernel.repeat):
        return True
    return any(kernel.reads(name) for name in _PASSING)


@dataclass(frozen=True)
class Chosen:
    """How a frame is made."""

    nodes: list[PlanNode]  # to be run, in order
    taken: dict[str, Result]  # by the step's path: cached in memory, or read
    skipped: frozenset[str]  # steps that are neither, since nothing that runs reads them


def choose(
    keys: Keys,
    nodes: Iterable[PlanNode],
    ref: Ref,
    held: Callable[[str], Cached | None],
    read: Callable[[Step], bool],
    *,
    skips: bool,
) -> Chosen:
    """Choose how to make a texture; ``nodes`` are what it needs, in order.

    ``held(key)`` is what is cached in memory. ``read(step)`` puts a step's textures there from the disk
    cache, and says whether it could. ``skips``: what nothing that runs reads is left out.
    """
    reached = list(nodes)
    paths = {ref.path} if skips else {step.path for step in walk(tuple(reached))}
    run: list[PlanNode] = []
    taken: dict[str, Result] = {}
    skipped: set[str] = set()
    for node in reversed(reached):
        here = _in_memory(node, keys, held)
        if here is None:
            inside = {step.path: step for step in walk((node,))}
            # Of a loop that was read, each step that others read is cached by itself.
            missing = [step for path, step in inside.items() if path in paths and not held(keys.result(path))]
            if all(read(step) for step in missing):
                here = {path: cached for path in inside if (cached := _alone(held(keys.result(path))))}
                skipped |= inside.keys() - here.keys() - {step.path for step in missing}
        if here is not None:
            taken |= here
            continue
        run.append(node)
        paths |= {source.path for source in sources_of(node) if isinstance(source, Ref)}
    return Chosen(run[::-1], taken, frozenset(skipped))


def _in_memory(node: PlanNode, keys: Keys, held: Callable[[str], Cached | None]) -> dict[str, Result] | None:
    """Return what is cached in memory of a node, by the step's path; None where it has to be run, or read."""
    if isinstance(node, Step):
        result = _alone(held(keys.result(node.path)))
        return None if result is None else {node.path: result}
    cached = held(keys.loops[node.path])
    if cached is None or cached.iterations != node.repeat or not cached.results:
        return None
    together = dict(cached.results)
    for inside in every_node(node.body):
        if not keys.changes[id(inside)]:
            together |= _in_memory(inside, keys, held) or {}
    return together


def _alone(cached: Cached | None) -> Result | None:
    return None if cached is None else next(iter(cached.results.values()), None)


# ── what is worth caching ────────────────────────────────────────────────────


@dataclass(frozen=True)
class Worth:
    """A step whose textures are worth caching on disk."""

    path: str
    key: str
    cost: float  # [ms] that it took to make, with all that it reads


def worth_caching(
    plan: Plan,
    keys: Keys,
    ref: Ref,
    passes: frozenset[str],
    costs: Memo[str, float],
    read_time: Callable[[int], float],
    floor: float,
    more: Mapping[str, float] = MappingProxyType({}),
) -> list[Worth]:
    """Return the steps of a texture's frame that are worth caching: those of the frontier that cost enough.

    ``passes``: as ``passing`` returns them. ``costs`` [ms] of what ran, by the key of the step or the
    loop; ``read_time(bytes)`` [ms]. To read must save at least ``floor`` [ms].
    ``more`` [ms] is what else steps cost that are computed in another process, by path.
    """
    nodes = needed(plan.nodes, ref)
    home = {step.path: number for number, node in enumerate(nodes) for step in walk((node,))}
    sources = [_sources(node, number, home) for number, node in enumerate(nodes)]
    others = {ref.path}.union(*sources)
    steps = {step.path: step for step in walk(tuple(nodes))}
    to_read = {path: read_time(bytes_in(step)) for path, step in steps.items()}
    # What must be run or read to have a node by running it, each with its time, by what and which.
    ways: list[dict[tuple[bool, str], float]] = []
    wholes: list[dict[str, float]] = []  # what was run for a node, nothing read, each with its time
    is_read: list[bool] = []
    for number, node in enumerate(nodes):
        key = keys.loops[node.path] if isinstance(node, LoopStep) else keys.result(node.path)
        whole = {key: costs.get(key, 0.0)}
        way = {(True, key): whole[key] + max(more.get(step.path, 0.0) for step in walk((node,)))}
        for path in sources[number]:
            before = home[path]
            whole |= wholes[before]
            way |= {(False, path): to_read[path]} if is_read[before] else ways[before]
        ways.append(way)
        wholes.append(whole)
        mine = sum(to_read[step.path] for step in walk((node,)) if step.path in others)
        stays = not any(step.path in passes for step in walk((node,)))
        is_read.append(stays and sum(way.values()) - mine >= floor)
    candidates: list[Worth] = []
    paths = {ref.path}
    for number in reversed(range(len(nodes))):
        read_here = [step.path for step in walk((nodes[number],)) if step.path in paths]
        if read_here and is_read[number]:
            cost = sum(wholes[number].values())
            candidates += [Worth(path, keys.result(path), cost) for path in read_here]
        elif read_here:
            paths |= sources[number]
    return candidates[::-1]


def bytes_in(step: Step) -> int:
    """Return the bytes of a step's textures."""
    return sum(bytes_of(step.size, output.format) for output in step.kernel.outputs)


def _sources(node: PlanNode, number: int, home: Mapping[str, int]) -> set[str]:
    """Return the steps of other nodes that a node reads."""
    read = {source.path for source in sources_of(node) if isinstance(source, Ref)}
    return {path for path in read if home[path] != number}
