"""Run a sketch on a context, and only what is stale: what is inside an ``Engine``.

A pass runs again when its key changes (see ``cache_keys``): so moving the sun lights the terrain
anew and leaves the terrain alone. ``execution`` runs the passes in order, ``runner`` each of
them. Programs call ``engine``; the playground's own tools use this as well.
"""

from __future__ import annotations

import logging
import threading
import weakref
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from functools import partial
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING

from playground.engine.cache import Cache
from playground.engine.cache_keys import KeyMaker, Keys
from playground.engine.context import (
    ContextInfo,
    context_info,
    keep_freed_memory,
    make_current,
    release_context,
    report_leak,
)
from playground.engine.disk_cache_choice import choose
from playground.engine.disk_caching import DiskCaching
from playground.engine.execution import Execution, would_run
from playground.engine.eye_height import EyeHeight
from playground.engine.frame_record import FrameRecord, Recorded
from playground.engine.gl_calls import Timer
from playground.engine.last_use import last_uses
from playground.engine.non_finite import FiniteCheck, NotFinite
from playground.engine.painted_images import PaintedFiles
from playground.engine.picture_hash import PictureHasher
from playground.engine.plain_forms import PlainForms
from playground.engine.plan import LoopIteration, Plan, PlanRequest, Step, Window, drawn_size, needed
from playground.engine.plan_warnings import PlanWarnings
from playground.engine.planner import planned
from playground.engine.results import Pool, Result, Wired
from playground.engine.runner import Runner
from playground.engine.unfinished import Deadline, Piece
from playground.engine.window import windowed
from playground.errors import ContextError, Diagnostic, OpenGLFault
from playground.paths import shown
from playground.shader.wrap import COMPUTE, FRAGMENT
from playground.sketch.flat import Ref
from playground.sketch.load import load
from playground.sketch.model import (
    DEFAULT_PICTURE,
    DRIVERS,
    LARGEST_PICTURE,
    LARGEST_SIDE,
    ComputeVariant,
    PlainCompute,
    Sketch,
    TexelKernel,
)

if TYPE_CHECKING:
    import moderngl

_log = logging.getLogger(__name__)

CACHE_BYTES = 768 * 2**20
_POOL_SHARE = 8  # spare textures may take an eighth of what the cache may


class Internals(Recorded):
    """Plans, textures, caches and counts of one engine; arguments as ``Engine`` takes them."""

    def __init__(
        self,
        ctx: moderngl.Context,
        *,
        driver: str,
        cache_bytes: int,
        owns_context: bool,
        notice: Callable[[str], None],
    ) -> None:
        if driver not in DRIVERS:
            raise ContextError(f"driver '{driver}': expected one of {', '.join(DRIVERS)}")
        self.ctx = ctx
        self.info: ContextInfo = context_info(ctx)
        _log.debug("opened %s: %s (%s)", self.info.opengl, self.info.renderer, self.info.version)
        if self.info.software:
            keep_freed_memory()
        self._computes = self.info.compute  # whether there are compute shaders
        if driver == COMPUTE and not self._computes:
            raise ContextError(f"this context is {self.info.opengl}; compute needs 4.3")
        self.driver = driver
        self.runs: Counter[str] = Counter()  # how often each pass ran, by path
        super().__init__()
        self.profiling = False
        # [s] after which loops that follow the time, and sources at work, raise ``Unfinished``
        self.patience: float | None = None
        self.piece: Callable[[], bool] | None = None  # whether a picture is to stop between passes
        self.keeps = (
            True  # textures for later frames; else each is dropped once it was read for the last time
        )
        self.looks_early = False  # for numbers that are not finite, where nothing is kept
        self.pool = Pool(ctx, cache_bytes // _POOL_SHARE)
        self.cache = Cache(cache_bytes, self.pool)
        self.painted = PaintedFiles()  # painted in this process, in place of their files
        self._piece = Piece(None, ctx.finish)
        self.runner = Runner(ctx, self.info, self.pool, self.painted)
        self.warnings = PlanWarnings(lambda: self.runner.inputs)
        self.disk_caching: DiskCaching | None = None  # None: nothing is cached on disk
        self.eye_height = EyeHeight()  # over the terrain, in the last frame
        self.plain_forms = PlainForms(
            notice, compute=self._computes and driver != FRAGMENT, software=self.info.software
        )
        self._keys = KeyMaker(content=self.painted.content)
        self._hasher = PictureHasher()
        self._finite = FiniteCheck(self)
        self._timer: Timer | None = None
        self._owns_context = owns_context
        self._default = ctx.detect_framebuffer(0)
        self._leak: weakref.finalize[..., Internals] | None = None  # reports this engine as dropped
        self._released = False
        self._thread = threading.current_thread()

    @property
    def clock(self) -> str:
        """Which clock the times come from."""
        return self._timer_of().clock

    def release(self) -> None:
        """Release every texture and program, and the context if it is the engine's own.

        A second call does nothing. Once its own context is gone, nothing more can be drawn.
        """
        if self._released:
            return
        self._make_current()
        if self._leak is not None:
            self._leak.detach()
        self._released = self._owns_context
        self._log_counts()
        self.record = FrameRecord()
        self.cache.clear()
        self.pool.clear()
        self.runner.release()
        self._timer = None
        if self._owns_context:
            release_context(self.ctx)
        elif (bound := self.ctx.fbo) is None or not _is_alive(bound):
            self._default.use()  # later calls of others bind again what is bound

    def _log_counts(self) -> None:
        """Log what ran since the engine was opened, and what was taken from caches instead."""
        ran = ", ".join(f"{path} {times}" for path, times in self.runs.items())
        _log.debug("times that passes ran: %s", ran or "none")
        times = self.runner.compile_times.values()
        _log.debug("programs compiled: %d, in %.0f ms", len(times), sum(times))
        read = self.disk_caching.reads if self.disk_caching is not None else 0
        _log.debug("results taken from the cache in memory: %d, from that on disk: %d", self.cache.hits, read)

    def plan_for(
        self,
        sketch: Sketch | str | Path,
        size: tuple[int, int],
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
        wanted: str = "",
        largest: int = LARGEST_SIDE,
        interpolated: bool | None = None,
        *,
        in_parts: bool = False,
    ) -> Plan:
        """Make a sketch, or that of a name or path, concrete for this engine; see ``PlanRequest``.

        A picture to be drawn ``in_parts`` has draws in their plain form: windows are cut out of those.
        """
        self.refuse_misuse()
        found = opened(sketch)
        samples = 0 if in_parts else min(found.samples, self.info.max_samples)
        kinds = self.plain_forms.kinds if samples == 1 else self.plain_forms.kinds_without_draws
        return planned(found, PlanRequest(size, time, kinds, steps or {}, wanted, interpolated, largest))

    def draw(
        self,
        sketch: Sketch | str | Path,
        *,
        size: tuple[int, int],
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
        interpolated: bool = True,
    ) -> moderngl.Texture:
        """Draw the sketch's picture, as ``render``; return its texture, which lives until the next frame."""
        plan_of = partial(self.plan_for, size=size, time=time, steps=steps, interpolated=interpolated)
        return self._draw_above_terrain(opened(sketch), plan_of)

    def draw_window(
        self,
        sketch: Sketch | str | Path,
        window: Window,
        *,
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
    ) -> moderngl.Texture:
        """Draw a window of a picture and return its texture, which lives until the next frame.

        The whole picture may have up to ``LARGEST_PICTURE`` pixels a side, more than any texture.
        Raises ``SketchError`` at a pass that cannot be drawn in parts (see ``window``).
        """
        plan_of = partial(self.plan_for_window, window=window, time=time, steps=steps)
        return self._draw_above_terrain(opened(sketch), plan_of)

    def _draw_above_terrain(self, sketch: Sketch, plan_of: Callable[[Sketch], Plan]) -> moderngl.Texture:
        """Draw a sketch; where the eye is under the terrain, warn once, and draw again from just above it."""
        plan, before = plan_of(sketch), None
        camera = self.eye_height.raised_as_before(plan, self.keys_of)
        if camera is None:
            texture = self._texture(plan, plan.picture)
            with self.borrowed():
                camera = self.eye_height.raised(plan, self.record.keys, self.record.results, self.ctx)
            if camera is None:
                return texture
            before = self.record
        warning = Diagnostic(self.eye_height.message, shown(sketch.file), severity="warning")
        self.warnings.once(warning, "the eye's height")
        raised = plan_of(sketch.with_camera(camera))
        texture = self._texture(raised, raised.picture)
        if before is not None:
            self.record = self.record.plus(before)
        return texture

    def plan_for_window(
        self,
        sketch: Sketch | str | Path,
        window: Window,
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
    ) -> Plan:
        """Make a sketch concrete for a window of a picture; raise as ``draw_window`` does."""
        found, (width, height) = opened(sketch), window.whole
        plan = self.plan_for(found, window.whole, time, steps, largest=LARGEST_PICTURE, in_parts=True)
        larger = width + 1, height + 1
        other = self.plan_for(found, larger, time, steps, largest=LARGEST_PICTURE + 1, in_parts=True)
        return windowed(plan, other, window)

    def texture_of(self, plan: Plan, ref: Ref) -> moderngl.Texture:
        """Run what a texture of a plan needs, and return it; it lives until the next frame."""
        return self._texture(plan, ref)

    def drawn(self) -> str:
        """Return a hash of what the last frame's picture was drawn from; "" before the first.

        The same on every machine: see ``engine.picture_hash``.
        """
        return "" if self.plan is None else self._hash_of(self.plan)

    def not_finite(self) -> NotFinite | None:
        """Return the first number that is not finite among what the last frame was made from, if any.

        Ask before the next frame is drawn. What it costs, and what it leaves out: see
        ``engine.non_finite``.
        """
        self.refuse_misuse()
        return self._finite.first()

    def not_finite_by_pass(self) -> Iterator[NotFinite | None]:
        """Look at the last frame's passes one by one, in the order in which they ran, as ``not_finite`` does.

        Yields after each what is not finite in it, if anything; another frame ends it.
        """
        return self._finite.looks()

    def recall(self, plan: Plan) -> None:
        """Restore ``plan`` and ``results`` of an earlier frame; what is cached of it does not run.

        What ran for the last frame, and what it took, stays as it was.
        """
        before = self.record
        self._texture(plan, plan.picture)
        self.record = self.record.counted_as(before)

    def fingerprint(
        self,
        sketch: Sketch | str | Path,
        *,
        size: tuple[int, int] = DEFAULT_PICTURE,
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
    ) -> str:
        """Return a hash of all that a picture depends on, the renderer included, without drawing it."""
        found = opened(sketch)
        size = drawn_size(found, size, LARGEST_PICTURE)
        plan = self.plan_for(found, size, time, steps, largest=LARGEST_PICTURE)
        with self._supposing(plan):
            made = f"{self._hash_of(plan)} {self.info.renderer} {self.info.opengl}"
        return blake2b(made.encode(), digest_size=16).hexdigest()

    def _hash_of(self, plan: Plan) -> str:
        return self._hasher.hash_of(plan, self.driver_for, self.runner.given_for_key)

    def forget_unused(self) -> None:
        """Drop what is cached but not used for the last frame; without it, a film caches all its frames."""
        self.refuse_misuse()
        self.cache.drop_unused()

    def stale(
        self,
        sketch: Sketch | str | Path,
        *,
        size: tuple[int, int],
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
        interpolated: bool = True,
    ) -> list[str]:
        """Return the paths of the passes that drawing the sketch's picture would run; nothing is run."""
        plan = self.plan_for(sketch, size, time, steps, interpolated=interpolated)
        keys, nodes = self.keys_of(plan), needed(plan.nodes, plan.picture)
        if self.disk_caching is not None:
            nodes = self.disk_caching.would_run(self.cache, plan, keys, plan.picture, self.painted)
        return would_run(keys, self.cache, nodes, plan)

    def keys_of(self, plan: Plan) -> Keys:
        """Return what each pass's textures depend on: see ``cache_keys``."""
        with self._supposing(plan):
            return self._keys.keys_of(plan, self.driver_for, self.runner.given_for_key)

    @contextmanager
    def _supposing(self, plan: Plan) -> Iterator[None]:
        """Suppose that a plan were being drawn; afterwards the last frame's is the last frame's again."""
        self.runner.look_at(plan)
        try:
            yield
        finally:
            if self.plan is not None:
                self.runner.look_at(self.plan)

    # ── running ──────────────────────────────────────────────────────────────

    def _texture(self, plan: Plan, ref: Ref) -> moderngl.Texture:
        """Run what a texture needs and return it, with the context left as it was found."""
        self.plain_forms.report(plan.sketch, plan.lacking)
        self.record = record = FrameRecord(plan, before=self.record.keys)
        self.cache.begin()
        self.runner.look_at(plan)
        self.runner.programs.frame += 1
        record.keys = self._keys.keys_of(plan, self.driver_for, self.runner.given_for_key)
        execution = Execution(record.keys, self.cache, self.runner, self._compute, self.driver_for)
        execution.replayed = None if self.profiling else self._count_replayed
        execution.deadline = Deadline(self.patience, self.ctx.finish)
        self._piece = Piece(self.piece, self.ctx.finish)
        self.runner.works.waits = self.patience is None
        self.runner.works.keep(record.keys.computed)
        with self.borrowed():
            if not self.keeps:
                self._run_once(execution, plan, ref)
            elif self.disk_caching is not None:
                execution.run(self.disk_caching.begin(execution, plan, ref))
            else:
                execution.run(needed(plan.nodes, ref))
        self.cache.end()
        record.results = execution.results
        self.warnings.look(plan)
        return execution.results[ref.path].textures[ref.output]

    def _run_once(self, execution: Execution, plan: Plan, ref: Ref) -> None:
        """Run what a texture needs, and drop what is read no more."""
        keys, needs = execution.keys, needed(plan.nodes, ref)
        found = choose(keys, needs, ref, self.cache.get, lambda _: False, skips=True)
        self.record.results = execution.results = found.taken
        if self.looks_early:
            execution.ended = lambda step, result: self._finite.look_early(
                step, result, keys.computed(step.path)
            )
        execution.last_uses = last_uses(plan, found.nodes, keys, ref)
        execution.run(found.nodes)

    @contextmanager
    def borrowed(self) -> Iterator[None]:
        """Lend the context, made current, and restore its framebuffer and samplers afterwards."""
        self._make_current()
        bound = self.ctx.fbo
        try:
            yield
        finally:
            self.runner.binder.tidy()
            # What stays bound here is bound again by later calls, so it may not be a released one.
            (bound if bound is not None and _is_alive(bound) else self._default).use()

    def _compute(
        self,
        step: Step,
        inputs: Mapping[str, Wired],
        iteration: LoopIteration | None,
        start: Result | None,
    ) -> Result:
        """Run a step, and record that and how it ran."""
        if iteration is None:
            self._piece.check()
        record, runner, first = self.record, self.runner, (start.settled or start.iterations) if start else 0
        continued = record.plan is not None and step.path in record.plan.continued
        objects, drawn = self.pool.made + runner.programs.compiled, runner.draws.drawn
        timed = self._timer_of().measure(record.times, step.path) if self.profiling else nullcontext()
        with timed:
            result = runner.run(
                step,
                self.driver_for(step),
                inputs,
                iteration=iteration,
                start=start,
                keeps_surface=continued,
                key="" if iteration is not None else record.keys.computed(step.path),
            )
        if objects != self.pool.made + runner.programs.compiled:
            # What has run without an error before will do so again, and a query waits for the driver.
            error = self.ctx.error
            if error != "GL_NO_ERROR":
                raise OpenGLFault(f"pass '{step.path}': OpenGL reports {error}")
        self.runs[step.path] += 1
        record.ran.append(step.path)
        if iteration is None and _log.isEnabledFor(logging.DEBUG):
            why = ", ".join(record.reasons(step.path)) or "its textures were dropped"
            _log.debug("ran %s: %s", step.path, why)
        steps = max((result.settled or step.repeat) - first, 0)
        record.iterations[step.path] += steps
        record.texels += step.size[0] * step.size[1] * max(steps, 1)
        record.triangles += runner.draws.drawn - drawn
        return result

    def _count_replayed(self, steps: Sequence[Step], times: int) -> None:
        """Record that steps of a loop ran so often, once in each iteration."""
        record = self.record
        for step in steps:
            self.runs[step.path] += times
            record.iterations[step.path] += times
            record.texels += step.size[0] * step.size[1] * times
        record.ran += [step.path for step in steps] * times

    def driver_for(self, step: Step) -> str:
        """Choose by which driver the kernel of a step runs."""
        kernel = step.kernel
        if isinstance(kernel, ComputeVariant | PlainCompute):
            if not self._computes:
                message = f"'{kernel.name}' is a compute shader; this context is {self.info.opengl}"
                raise ContextError(f"{message}, and compute needs 4.3")
            return COMPUTE
        if not isinstance(kernel, TexelKernel) or not self._computes or self.driver == FRAGMENT:
            return FRAGMENT
        return COMPUTE if self.driver == COMPUTE or kernel.visits else FRAGMENT

    def _make_current(self) -> None:
        """Make this engine's context current: there may be others in the process.

        It stays current, since glcontext's way back leaves none.
        """
        self.refuse_misuse()
        make_current(self.ctx)
        if not self._owns_context and (self._leak is None or not self._leak.alive):
            self._leak = weakref.finalize(self, report_leak, self.ctx)
            self._leak.atexit = False

    def refuse_misuse(self) -> None:
        """Raise ``ContextError`` where the engine was released, or belongs to another thread."""
        if self._released:
            raise ContextError("this engine was released; open another")
        now = threading.current_thread()
        if now is not self._thread:
            raise ContextError(
                f"this engine was opened in thread '{self._thread.name}' and is called from '{now.name}': "
                "an OpenGL context belongs to one thread; open an engine in each"
            )

    def _timer_of(self) -> Timer:
        self.refuse_misuse()
        if self._timer is None:
            self._timer = Timer(self.ctx, software=self.info.software)
        return self._timer


def opened(sketch: Sketch | str | Path) -> Sketch:
    """Return the sketch itself, or the one of that name or path."""
    return sketch if isinstance(sketch, Sketch) else load(sketch)


def _is_alive(framebuffer: moderngl.Framebuffer) -> bool:
    import moderngl

    return not isinstance(framebuffer.mglo, moderngl.InvalidObject)
