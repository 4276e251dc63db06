"""Try sketches in the sandbox's worker process: open a context, draw what is requested by each driver."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from playground.allowed_files import reading_unsaved
from playground.engine.context import open_context
from playground.engine.engine import Engine
from playground.engine.plain_forms import silent
from playground.engine.plan import Step
from playground.engine.planner import smallest_terrain
from playground.engine.process.worker import Parent, Service
from playground.engine.programs import compile_library
from playground.engine.sandbox import (
    Activity,
    Request,
    SandboxReport,
    TryLibrary,
    TrySketch,
    TryTrace,
)
from playground.engine.textures import drain, is_lost
from playground.engine.unfinished import Unfinished
from playground.errors import (
    ContextError,
    Diagnostic,
    PlaygroundError,
    SandboxCrash,
    ShaderError,
    SketchError,
)
from playground.shader.source import read_source
from playground.shader.wrap import COMPUTE
from playground.sketch.model import CpuSource, Sketch

if TYPE_CHECKING:
    import moderngl

_FINEST = 33  # vertices a side of the sandbox's meshes
_PATIENCE = 0.2  # [s] for loops over the frames: many frames prove little more than some
_MAX_DIAGNOSTICS = 200  # more help no one
_TRIES = 4  # at earlier times: of several loops, each may have come less far


def open_service(parent: Parent, options: tuple[bool, int | None]) -> Service:
    """Open a context: on a software renderer, on which device."""
    software, device = options
    return Service(_Handler(open_context(software=software, device=device), parent).answer)


class _Handler:
    """Draws with one engine a driver."""

    def __init__(self, ctx: moderngl.Context, parent: Parent) -> None:
        self._ctx = ctx
        self._parent = parent
        self._engines: dict[str, Engine] = {}
        self._subject = "this"

    def answer(self, request: Request) -> SandboxReport:
        """Try something; a mistake is an answer too."""
        skipped: list[str] = []
        self._subject = "this"
        try:
            if isinstance(request, TryLibrary):
                self._report(Activity("", request.path))
                with reading_unsaved(dict(request.unsaved)):
                    source = read_source(Path(request.path), (Path(request.folder),))
                compile_library(self._ctx, source)
                return SandboxReport(True)
            if isinstance(request, TryTrace):
                self._trace(request)
                return SandboxReport(True)
            for driver in request.drivers:
                if driver == COMPUTE and self._ctx.version_code < 430:
                    skipped.append(COMPUTE)
                else:
                    self._draw(request, driver)
        except PlaygroundError as error:
            if is_lost(self._ctx):
                message = f"{self._subject} made the driver reset itself in the sandbox"
                raise SandboxCrash(message) from None  # so another process takes this one's place
            return SandboxReport(False, error, tuple(skipped))
        return SandboxReport(True, None, tuple(skipped))

    def _draw(self, request: TrySketch, driver: str) -> None:
        engine = self._engine(driver)
        engine.runner.before_step = partial(self._before_step, driver if len(request.drivers) > 1 else "")
        small = request.sketch.with_values({"size": smallest_terrain(request.sketch)}).with_picture(samples=1)
        drain(engine.ctx)  # what an earlier, failed request left behind
        try:
            _draw_some_frames(engine, small, request)
            engine.ctx.finish()
            if (error := engine.ctx.error) != "GL_NO_ERROR":
                raise ContextError(f"OpenGL reports {error} after the frame")
            if request.refuses:
                _refuse(engine, request.refuses)
        except ShaderError as wrong:
            raise all_errors(wrong, engine, request.sketch, size=request.size, time=request.time) from None

    def _trace(self, request: TryTrace) -> None:
        engine = self._engine("auto")
        engine.runner.before_step = partial(self._before_step, "")
        small = request.sketch.with_values({"size": smallest_terrain(request.sketch)}).with_picture(samples=1)
        drain(engine.ctx)
        _draw_some_frames(engine, small, request)
        assert engine.record.plan is not None
        self._report(Activity(request.path, request.sketch.file))
        try:
            engine.tracer.trace(engine.record.plan, request.path, (0, 0), None, request.function)
        except SketchError:  # by the plain form, of what has no fragment shader in the frame
            engine.trace_frame(request.path, texel=(0, 0), function=request.function)
        engine.ctx.finish()

    def _engine(self, driver: str) -> Engine:
        if driver not in self._engines:
            engine = Engine(self._ctx, driver=driver, cache_bytes=64 * 2**20, notice=silent)
            # A mesh's fineness proves nothing more, and takes longer than all the rest.
            engine.runner.draws.finest = _FINEST
            engine.runner.works.idle = True  # shaders are tried here; sources have no code of the user's
            self._engines[driver] = engine
        return self._engines[driver]

    def _before_step(self, driver: str, step: Step) -> None:
        """Report a step; the one before ends first, so that its time is its own."""
        self._ctx.finish()
        self._report(Activity(step.path, step.kernel.path, driver=driver))

    def _report(self, activity: Activity) -> None:
        self._subject = activity.subject
        self._parent.report(activity)


def _draw_some_frames(engine: Engine, sketch: Sketch, request: TrySketch | TryTrace) -> None:
    """Draw at the time asked for, or where that takes very many frames, at an earlier one."""
    at, engine.options.patience = request.time, _PATIENCE
    try:
        for _ in range(1 + _TRIES):
            try:
                engine.draw(sketch, size=request.size, time=at)
                return
            except Unfinished as stopped:
                at *= stopped.done / stopped.total
    finally:
        engine.options.patience = None
    engine.draw(sketch, size=request.size, time=0.0)


def _refuse(engine: Engine, what: str) -> None:
    """Raise ``ShaderError`` at the first pass that gives a number that is not finite, or nothing else."""
    for not_finite in engine.not_finite_by_pass():
        if not_finite is None or engine.record.plan is None:
            continue
        width, height = not_finite.size
        throughout = not_finite.count == width * height
        step = engine.record.plan.step(not_finite.path)
        if step is not None and (throughout or what == "any"):
            raise step.kernel.error(not_finite.everywhere() if throughout else str(not_finite))


def all_errors(
    error: PlaygroundError, engine: Engine, sketch: Sketch, *, size: tuple[int, int], time: float = 0.0
) -> PlaygroundError:
    """Return an error with those of all other kernels of the sketch after its own.

    Each pass is compiled in the form that the engine would run; nothing is drawn. An error
    that is not a shader's, and one of a sketch with no plan, comes back as it is.
    """
    if not isinstance(error, ShaderError):
        return error
    try:
        plan = engine.plan(sketch, size, time)
    except PlaygroundError:
        return error
    diagnostics: dict[tuple[str, int, int, str], Diagnostic] = {}
    _take(diagnostics, error)
    tried: set[tuple[int, str]] = set()
    for step in plan.walk():
        if isinstance(step.kernel, CpuSource) or len(diagnostics) >= _MAX_DIAGNOSTICS:
            continue
        try:
            kernel, driver = step.kernel, engine.runner.driver_for(step)
            if (id(kernel), driver) in tried:
                continue
            tried.add((id(kernel), driver))
            if engine.runner.before_step is not None:
                engine.runner.before_step(step)
            engine.runner.programs.get(kernel, driver)
        except ShaderError as other:
            _take(diagnostics, other)
        except PlaygroundError:
            continue  # this machine lacks something, which is no mistake of the text
    return ShaderError(diagnostics=diagnostics.values())


def _take(diagnostics: dict[tuple[str, int, int, str], Diagnostic], error: ShaderError) -> None:
    """Add an error's diagnostics; one of a file that several kernels include is added once."""
    for diagnostic in error.diagnostics:
        key = (diagnostic.file, diagnostic.line, diagnostic.column, diagnostic.message)
        diagnostics.setdefault(key, diagnostic)
