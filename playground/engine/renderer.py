"""Run plans of sketches on a context, and only what is stale: what an ``Engine`` is made on.

A pass runs again when its key changes (see ``cache_keys``): so moving the sun lights the terrain
again and leaves the terrain alone. ``execution`` runs the passes in order, ``runner`` each of
them. Programs call ``engine``; the window and other tools also use what is here.
"""

from __future__ import annotations

import logging
import threading
import weakref
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from playground.engine.cache import Cache
from playground.engine.cache_keys import KeyMaker, Keys
from playground.engine.context import (
    ContextInfo,
    context_info,
    make_current,
    release_context,
    report_leak,
)
from playground.engine.disk_caching import DiskCaching, choose
from playground.engine.execution import Execution, FrameRecord, last_uses, would_run
from playground.engine.eye_height import EyeHeight
from playground.engine.gl_calls import Timer
from playground.engine.non_finite import FiniteCheck, NotFinite
from playground.engine.painted_images import PaintedFiles
from playground.engine.plain_forms import PlainForms, warn
from playground.engine.plan import LoopStep, Plan, PlanRequest, Step, Window, needed, walk
from playground.engine.plan_warnings import PlanWarnings
from playground.engine.planner import planned
from playground.engine.results import Pool
from playground.engine.runner import Runner
from playground.engine.software import Software
from playground.engine.tuning import Tuning
from playground.engine.unfinished import Interruption
from playground.engine.window import windowed
from playground.errors import ContextError, Diagnostic
from playground.paths import shown
from playground.shader.kernel import DRIVERS
from playground.shader.reserved_names import MOMENT
from playground.shader.wrap import COMPUTE, FRAGMENT
from playground.sketch.flat import Ref
from playground.sketch.load import opened
from playground.sketch.model import MAX_PICTURE_SIDE, MAX_SIDE, Kernel, Sketch, TexelKernel
from playground.sketch.variants import compiled_text

if TYPE_CHECKING:
    import moderngl

    from playground.engine.trace.tracer import Tracer

_log = logging.getLogger(__name__)

CACHE_BYTES = 768 * 2**20
_DIGITS = 9  # of numbers in floating point, in the hash of a picture
_POOL_SHARE = 8  # spare textures may take an eighth of what the cache may


@dataclass
class RunOptions:
    """How frames are run, for what shows them while they come or needs less memory."""

    profiling: bool = False  # the time of each pass is measured
    # [s] after which loops that follow the time, and sources at work, raise ``Unfinished``
    patience: float | None = None
    piece: Callable[[], bool] | None = None  # whether a picture is to stop between passes
    # Textures stay for later frames; else each is dropped once it was read for the last time.
    keeps: bool = True
    looks_early: bool = False  # for numbers that are not finite, where nothing is kept


class Renderer:
    """Draws plans on one context; arguments as ``Engine`` takes them."""

    def __init__(
        self,
        ctx: moderngl.Context,
        *,
        driver: str = "auto",
        cache_bytes: int = CACHE_BYTES,
        owns_context: bool = False,
        notice: Callable[[str], None] = warn,
    ) -> None:
        if driver not in DRIVERS:
            raise ContextError(f"driver '{driver}': expected one of {', '.join(DRIVERS)}")
        self._ctx = ctx
        self._info: ContextInfo = context_info(ctx)
        _log.debug("opened %s: %s (%s)", self._info.opengl, self._info.renderer, self._info.version)
        if driver == COMPUTE and not self._info.compute:
            raise ContextError(f"this context is {self._info.opengl}; compute needs 4.3")
        self._driver = driver
        self.options = RunOptions()
        self.record = FrameRecord()  # of the last frame
        self.runs: Counter[str] = Counter()  # how often each pass ran, by path
        pool = Pool(ctx, cache_bytes // _POOL_SHARE)
        self.cache = Cache(cache_bytes, pool)
        self.painted = PaintedFiles()  # painted in this process, in place of their files
        tuning = Software(ctx) if self._info.software else Tuning()
        self.runner = Runner(ctx, self._info, driver, pool, self.painted, tuning)
        self.warnings = PlanWarnings(lambda: self.runner.inputs)
        self.disk_caching: DiskCaching | None = None  # None: nothing is cached on disk
        self.eye_height = EyeHeight()  # over the terrain, in the last frame
        self.plain_forms = PlainForms(
            notice, compute=self._info.compute and driver != FRAGMENT, draws=tuning.replaces_draws
        )
        self._keys = KeyMaker(content=self.painted.content)
        self._hasher = PictureHasher()
        self._finite_check = FiniteCheck(self)
        self._timer: Timer | None = None
        self._tracer: Tracer | None = None
        self._context = _ContextUse(self, owns=owns_context)

    @property
    def clock(self) -> str:
        """Which clock the times come from."""
        return self._frame_timer().clock

    @property
    def released(self) -> bool:
        """Whether it was released, and the context with it."""
        return self._context.released

    def release(self) -> None:
        """Release every texture and program, and the context if it is the engine's own.

        A second call does nothing. Once its own context is gone, nothing more can be drawn.
        """
        if self._context.released:
            return
        self._context.make_current()
        self._log_counts()
        self.record = FrameRecord()
        if self._tracer is not None:
            self._tracer.release()  # before the pool, to which it gives textures
        self.cache.clear()
        self.runner.pool.clear()
        self.runner.release()
        self._timer = None
        self._context.release()

    def _log_counts(self) -> None:
        """Log what ran since the engine was opened, and what was taken from caches instead."""
        ran = ", ".join(f"{path} {times}" for path, times in self.runs.items())
        _log.debug("times that passes ran: %s", ran or "none")
        times = self.runner.compile_times.values()
        _log.debug("programs compiled: %d, in %.0f ms", len(times), sum(times))
        read = self.disk_caching.reads if self.disk_caching is not None else 0
        _log.debug("results taken from the cache in memory: %d, from that on disk: %d", self.cache.hits, read)

    def plan(
        self,
        sketch: Sketch | str | Path,
        size: tuple[int, int],
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
        ref: str = "",
        largest: int = MAX_SIDE,
        interpolated: bool | None = None,
        *,
        in_parts: bool = False,
        canonical: str = "",
    ) -> Plan:
        """Make a sketch, or that of a name or path, concrete for this engine; see ``PlanRequest``.

        A picture to be drawn ``in_parts`` has draws in their plain form: windows are cut out of those.
        """
        self._context.check()
        opened_sketch = opened(sketch)
        samples = 0 if in_parts else min(opened_sketch.picture.samples, self._info.max_samples)
        kinds = self.plain_forms.kinds if samples == 1 else self.plain_forms.kinds_without_draws
        exaggeration = self.runner.exaggeration
        factor = exaggeration.factor if exaggeration is not None else 1.0
        request = PlanRequest(size, time, kinds, steps or {}, ref, interpolated, largest, canonical, factor)
        return planned(opened_sketch, request)

    def draw_window(
        self,
        sketch: Sketch | str | Path,
        window: Window,
        *,
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
    ) -> moderngl.Texture:
        """Draw a window of a picture and return its texture, which lives until the next frame.

        The whole picture may have up to ``MAX_PICTURE_SIDE`` pixels a side, more than any texture.
        Raises ``SketchError`` at a pass that cannot be drawn in parts (see ``window``).
        """
        plan_of = partial(self.plan_for_window, window=window, time=time, steps=steps)
        return self.draw_above_terrain(opened(sketch), plan_of)

    def draw_above_terrain(self, sketch: Sketch, plan_of: Callable[[Sketch], Plan]) -> moderngl.Texture:
        """Draw a sketch; where the eye is under the terrain, warn once, and draw again from just above it."""
        plan, before = plan_of(sketch), None
        camera = self.eye_height.raised_as_before(plan, self.keys_of)
        if camera is None:
            texture = self._texture(plan, plan.picture)
            with self.borrowed():
                camera = self.eye_height.raised(plan, self.record.keys, self.record.results, self._ctx)
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
        opened_sketch, (width, height) = opened(sketch), window.full_size
        plan = self.plan(
            opened_sketch, window.full_size, time, steps, largest=MAX_PICTURE_SIDE, in_parts=True
        )
        larger = width + 1, height + 1
        other = self.plan(opened_sketch, larger, time, steps, largest=MAX_PICTURE_SIDE + 1, in_parts=True)
        return windowed(plan, other, window)

    def texture_of(self, plan: Plan, ref: Ref) -> moderngl.Texture:
        """Run what a texture of a plan needs, and return it; it lives until the next frame."""
        return self._texture(plan, ref)

    @property
    def tracer(self) -> Tracer:
        """What traces steps of frames, made when it is first asked for."""
        if self._tracer is None:
            from playground.engine.trace.tracer import Tracer

            self._tracer = Tracer(self)
        return self._tracer

    def drawn(self) -> str:
        """Return a hash of what the last frame's picture was drawn from; "" before the first.

        The same on every machine: see ``PictureHasher``.
        """
        plan = self.record.plan
        return "" if plan is None else self.picture_hash(plan)

    def not_finite_by_pass(self) -> Iterator[NotFinite | None]:
        """Look at the last frame's passes one by one, in the order in which they ran, as ``not_finite`` does.

        Yields after each what is not finite in it, if anything; another frame ends it.
        """
        return self._finite_check.looks()

    def recall(self, plan: Plan) -> None:
        """Restore ``plan`` and ``results`` of an earlier frame; what is cached of it does not run.

        What ran for the last frame, and what it took, stays as it was.
        """
        before = self.record
        self._texture(plan, plan.picture)
        self.record = self.record.counted_as(before)

    def run_apart(self, plan: Plan, refs: Sequence[Ref]) -> FrameRecord:
        """Run what some textures of a plan need apart from the frames, and return the record of that.

        It runs to its end. The last frame, what ran for it and how often all passes ran stay as they were.
        """
        before, runs, options = self.record, self.runs.copy(), self.options
        self.options = RunOptions()
        try:
            self._run(plan, refs, apart=True)
            record = self.record
            if not self._is_whole(before):
                assert before.plan is not None, "a frame without a plan has no results"
                self.recall(before.plan)
                before.results = self.record.results
            return record
        finally:
            self.record, self.runs, self.options = before, runs, options

    def _is_whole(self, record: FrameRecord) -> bool:
        """Return whether a picture's results are still there: another plan may have gone on from them."""
        plan, results = record.plan, record.results
        if plan is None or plan.picture.path not in results:
            return True
        for node in plan.nodes:
            if isinstance(node, LoopStep):
                ran = any(step.path in results for step in walk(node.body))
                if ran and not self.cache.holds(record.keys.loops[node.path], node.repeat):
                    return False
            elif node.path in results and isinstance(node.kernel, TexelKernel):
                if record.keys.result(node.path) not in self.cache:
                    return False
        return True

    def picture_hash(self, plan: Plan) -> str:
        """Return a hash of what a plan's picture is drawn from, the same on every machine.

        See ``PictureHasher``.
        """
        with self.supposing(plan):
            return self._hasher.hash_of(plan, self.runner.driver_for, self.runner.given_for_key)

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
        plan = self.plan(sketch, size, time, steps, interpolated=interpolated)
        keys, nodes = self.keys_of(plan), list(needed(plan.nodes, plan.picture))
        if self.disk_caching is not None:
            nodes = self.disk_caching.would_run(self.cache, plan, keys, plan.picture, self.painted)
        return would_run(keys, self.cache, nodes, plan)

    def keys_of(self, plan: Plan) -> Keys:
        """Return what each pass's textures depend on: see ``cache_keys``."""
        with self.supposing(plan):
            return self._keys.keys_of(plan, self.runner.driver_for, self.runner.given_for_key)

    @contextmanager
    def supposing(self, plan: Plan) -> Iterator[None]:
        """Suppose that a plan were being drawn; afterwards the last frame's is the last frame's again."""
        self.runner.set_frame(plan)
        try:
            yield
        finally:
            if self.record.plan is not None:
                self.runner.set_frame(self.record.plan)

    # ── running ──────────────────────────────────────────────────────────────

    def _texture(self, plan: Plan, ref: Ref) -> moderngl.Texture:
        """Run what a texture needs and return it, with the context left as it was found."""
        self._run(plan, (ref,))
        return self.record.results[ref.path].textures[ref.output]

    def _run(self, plan: Plan, refs: Sequence[Ref], *, apart: bool = False) -> None:
        """Run what some textures need, for one frame; ``apart``: what the last one uses stays in use."""
        runner, options = self.runner, self.options
        self.plain_forms.report(plan.sketch, plan.lacking)
        self.record = record = FrameRecord(plan, before=self.record.keys)
        if not apart:
            self.cache.begin()
        runner.set_frame(plan)
        runner.programs.frame += 1
        record.keys = self._keys.keys_of(plan, runner.driver_for, runner.given_for_key)
        execution = Execution(
            record,
            self.cache,
            runner,
            interruption=Interruption(self._ctx.finish, options.piece, options.patience),
            timer=self._frame_timer() if options.profiling else None,
        )
        runner.works.waits = options.patience is None
        runner.works.keep(record.keys.computed)
        try:
            with self.borrowed():
                for ref in refs:
                    if not options.keeps:
                        self._run_once(execution, plan, ref)
                    elif self.disk_caching is not None:
                        results = execution.results
                        nodes = self.disk_caching.begin(execution, plan, ref)
                        execution.results = results | execution.results
                        execution.run(nodes)
                    else:
                        execution.run(needed(plan.nodes, ref))
        finally:
            self.runs.update(record.ran)
        self.cache.end()
        record.results = execution.results
        self.warnings.look(plan)

    def _run_once(self, execution: Execution, plan: Plan, ref: Ref) -> None:
        """Run what a texture needs, and drop what is read no more."""
        keys, needs = execution.keys, needed(plan.nodes, ref)
        result = choose(keys, needs, ref, self.cache.get, lambda _: False, skips=True)
        self.record.results = execution.results = result.taken
        if self.options.looks_early:
            execution.ended = lambda step, result: self._finite_check.look_early(
                step, result, keys.computed(step.path)
            )
        execution.last_uses = last_uses(plan, result.nodes, keys, ref)
        execution.run(result.nodes)

    @contextmanager
    def borrowed(self) -> Iterator[None]:
        """Lend the context, made current, and restore its framebuffer and samplers afterwards."""
        with self._context.borrowed():
            try:
                yield
            finally:
                self.runner.binder.tidy()

    def _frame_timer(self) -> Timer:
        """Return the timer of passes, created at the first call."""
        self._context.check()
        if self._timer is None:
            self._timer = Timer(self._ctx, queries=self.runner.tuning.has_timers)
        return self._timer


class _ContextUse:
    """A context that an engine draws on, in its thread: its own, or one that it leaves as it found it."""

    def __init__(self, engine: Renderer, *, owns: bool) -> None:
        self.released = False
        self._engine = weakref.ref(engine)
        self._ctx = engine._ctx
        self._owns = owns
        self._default = engine._ctx.detect_framebuffer(0)
        self._leak: weakref.finalize[..., Renderer] | None = None  # reports the engine as dropped
        self._thread = threading.current_thread()

    def check(self) -> None:
        """Raise ``ContextError`` where the engine was released, or belongs to another thread."""
        if self.released:
            raise ContextError("this engine was released; open another")
        now = threading.current_thread()
        if now is not self._thread:
            raise ContextError(
                f"this engine was opened in thread '{self._thread.name}' and is called from '{now.name}': "
                "an OpenGL context belongs to one thread; open an engine in each"
            )

    def make_current(self) -> None:
        """Make the context current: there may be others in the process.

        It stays current, since glcontext's way back leaves none.
        """
        self.check()
        make_current(self._ctx)
        engine = self._engine()
        if not self._owns and engine is not None and (self._leak is None or not self._leak.alive):
            self._leak = weakref.finalize(engine, report_leak, self._ctx)
            self._leak.atexit = False

    @contextmanager
    def borrowed(self) -> Iterator[None]:
        """Lend the context, made current, and restore its framebuffer afterwards."""
        self.make_current()
        bound = self._ctx.fbo
        try:
            yield
        finally:
            # What stays bound here is bound again by later calls, so it may not be a released one.
            (bound if bound is not None and _is_alive(bound) else self._default).use()

    def release(self) -> None:
        """Release the context, if it is the engine's own; else leave it with what can be bound."""
        if self._leak is not None:
            self._leak.detach()
        self.released = self._owns
        if self._owns:
            release_context(self._ctx)
        elif (bound := self._ctx.fbo) is None or not _is_alive(bound):
            self._default.use()  # later calls of others bind again what is bound


def _is_alive(framebuffer: moderngl.Framebuffer) -> bool:
    import moderngl

    return not isinstance(framebuffer.mglo, moderngl.InvalidObject)


def _compiled_text(kernel: Kernel) -> str:
    return compiled_text(kernel.source.code)


class PictureHasher:
    """Computes in one hash what a picture is drawn from, the same on every machine and in every year.

    It is a pass's key (see ``cache_keys``) with two things smoothed out. A text counts by its tokens, as
    the compiler takes it, so that comments, line ends and spaces say nothing. What the engine works
    out in floating point, the camera's matrices above all, counts to nine digits, since the last
    ones differ between mathematical libraries.

    What a file is called and where it lies, and the order of a TOML's tables, say nothing either;
    a number, a size, a wire, the form that runs (a plain text or a fast variant, and by which driver)
    and a byte of an image do. It explains a picture that differs; by itself it fails no comparison, so a
    fast variant that was renewed leaves every reference good whose picture it still draws.
    """

    def __init__(self) -> None:
        self._keys = KeyMaker(_compiled_text)

    def hash_of(
        self, plan: Plan, driver: Callable[[Step], str], uniforms_of: Callable[[Step], Mapping[str, Any]]
    ) -> str:
        """Return the hash of what a plan's picture is made from; arguments as ``KeyMaker`` takes them."""

        def smoothed(step: Step) -> dict[str, Any]:
            return {n: value if n == MOMENT else rounded(value) for n, value in uniforms_of(step).items()}

        keys = self._keys.keys_of(plan, driver, smoothed).result(plan.picture.path)
        times = plan.sketch.picture.supersample
        return keys if times == 1 else f"{keys} reduced {times} times"


def rounded(value: Any) -> Any:
    """Return a number, or a tuple of them, to nine digits of the largest; anything else as it is."""
    if isinstance(value, tuple | list):
        most = max((abs(float(v)) for v in value), default=0.0)
        return tuple(_to_digits(float(v), most) for v in value)
    return _to_digits(value, abs(value)) if isinstance(value, float) else value


def _to_digits(value: float, most: float) -> str:
    if most == 0.0:
        return "0"
    share = round(value / most, _DIGITS) + 0.0  # no -0.0
    return f"{share:.{_DIGITS}f} of {most:.{_DIGITS}g}"
