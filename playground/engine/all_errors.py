"""Find the errors of all shaders of a sketch, not only of the first pass that fails."""

from __future__ import annotations

from playground.engine.engine import Engine
from playground.errors import Diagnostic, PlaygroundError, ShaderError
from playground.sketch.model import CpuSource, Sketch

MAX_DIAGNOSTICS = 200  # diagnostics; more help no one


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
        if isinstance(step.kernel, CpuSource) or len(diagnostics) >= MAX_DIAGNOSTICS:
            continue
        try:
            kernel, driver = step.kernel, engine.driver_for(step)
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
