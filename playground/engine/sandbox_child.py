"""The trial's child process: opens a context, tries what it is handed, answers.

Run by ``engine.sandbox`` only, as
``python -m playground.engine.sandbox_child MEMORY RENDERER DEVICE SECONDS``.
"""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import IO, TYPE_CHECKING

from playground.engine.all_errors import all_mistakes
from playground.engine.engine import Engine
from playground.engine.plain_forms import silent
from playground.engine.plan import Step
from playground.engine.planner import smallest_land
from playground.engine.sandbox import Request, TrialReport, TryLibrary, TrySketch
from playground.engine.sandbox_process import Doing, Ready, receive_bytes, send
from playground.engine.sandbox_wire import Reader
from playground.errors import ContextError, PlaygroundError, ShaderError, TrialCrash
from playground.gpu.context import open_context
from playground.gpu.program import compile_library
from playground.gpu.textures import drain, is_lost
from playground.gpu.wrap import COMPUTE
from playground.sketch.source import read_source

if TYPE_CHECKING:
    import moderngl


_FINEST = 33  # vertices a side of the trial's meshes


class Teller:
    """Tells the parent what is about to be done, and ends this process where that takes too long."""

    def __init__(self, answers: IO[bytes], longest: float) -> None:
        self._answers = answers
        self._longest = longest
        self.subject = "this"

    def __call__(self, path: str, file: str, driver: str = "") -> None:
        """Say that a pass is about to run, or a file alone to be compiled."""
        doing = Doing(path, file, driver=driver)
        self.subject = doing.subject
        _end_yourself_after(self._longest)
        send(self._answers, doing)


def main() -> None:
    """Answer requests until the parent closes its end."""
    memory, renderer, device, longest = int(sys.argv[1]), sys.argv[2], sys.argv[3], float(sys.argv[4])
    requests = sys.stdin.buffer
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever a driver prints must not get between the answers
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's
    ctx: moderngl.Context | None = None
    failure: ContextError | None = None
    try:
        ctx = open_context(software=renderer == "software", device=int(device) if device else None)
    except ContextError as error:
        failure = error
    _limit(memory)
    tell = Teller(answers, longest)
    engines: dict[str, Engine] = {}
    send(answers, Ready())
    reader = Reader()
    while (data := receive_bytes(requests)) is not None:
        start = time.perf_counter()
        request: Request = reader.read(data)
        _end_yourself_after(longest)
        if ctx is None:
            report = TrialReport(False, failure)
        else:
            report = _try(ctx, engines, request, tell)
        _end_yourself_after(0.0)
        send(answers, replace(report, seconds=time.perf_counter() - start))


def _end_yourself_after(seconds: float) -> None:
    """Have the system end this process in case it hangs and its parent is gone; 0: no more."""
    if hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_REAL, seconds)  # SIGALRM kills, even in the middle of a draw


def _try(ctx: moderngl.Context, engines: dict[str, Engine], request: Request, tell: Teller) -> TrialReport:
    skipped: list[str] = []
    try:
        if isinstance(request, TryLibrary):
            tell("", request.path)
            compile_library(ctx, read_source(Path(request.path), (Path(request.folder),)))
            return TrialReport(True)
        for driver in request.drivers:
            if driver == COMPUTE and ctx.version_code < 430:
                skipped.append(COMPUTE)
                continue
            if driver not in engines:
                engines[driver] = Engine(ctx, driver=driver, cache_bytes=64 * 2**20, notice=silent)
                # A mesh's fineness proves nothing more, and takes longer than all the rest.
                engines[driver].runner.draws.finest = _FINEST
            engines[driver].runner.tell = _teller(ctx, tell, driver if len(request.drivers) > 1 else "")
            try:
                _draw(engines[driver], request)
            except ShaderError as error:
                size, when = request.size, request.time
                raise all_mistakes(error, engines[driver], request.sketch, size=size, time=when) from None
    except PlaygroundError as error:
        if is_lost(ctx):
            return TrialReport(False, TrialCrash(f"{tell.subject} made the driver reset itself in the trial"))
        return TrialReport(False, error, tuple(skipped))
    except MemoryError:
        return TrialReport(False, PlaygroundError("the trial ran out of memory"), tuple(skipped))
    except Exception as error:  # a fault of ours: it must reach the parent as words
        return TrialReport(False, PlaygroundError(f"{type(error).__name__}: {error}"), tuple(skipped))
    return TrialReport(True, None, tuple(skipped))


def _teller(ctx: moderngl.Context, tell: Teller, driver: str) -> Callable[[Step], None]:
    """Return what is called before each step: the one before ends first, so that its time is its own."""

    def told(step: Step) -> None:
        ctx.finish()
        tell(step.path, step.kernel.path, driver)

    return told


def _draw(engine: Engine, request: TrySketch) -> None:
    small = replace(request.sketch, size=smallest_land(request.sketch), samples=1)
    drain(engine.ctx)  # what an earlier, failed request left behind
    engine.draw(small, size=request.size, time=request.time)
    engine.ctx.finish()
    fault = engine.ctx.error
    if fault != "GL_NO_ERROR":
        raise ContextError(f"OpenGL reports {fault} after the frame")
    if request.refuses:
        _refuse(engine, request.refuses)


def _refuse(engine: Engine, what: str) -> None:
    """Raise ``ShaderError`` at the first pass that gives a number that is not finite, or nothing else."""
    for found in engine.not_finite_by_pass():
        if found is None or engine.plan is None:
            continue
        width, height = found.size
        throughout = found.count == width * height
        step = engine.plan.step(found.path)
        if step is not None and (throughout or what == "any"):
            raise step.kernel.error(found.everywhere() if throughout else str(found))


def _limit(memory: int) -> None:
    try:
        import resource
    except ImportError:  # Windows
        return
    # Data, not address space: a GPU's driver reserves far more addresses than it uses.
    resource.setrlimit(resource.RLIMIT_DATA, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # it dies often, and nobody reads what it leaves


if __name__ == "__main__":
    main()
