"""Draw candidates in a worker process, which is replaced when it crashes or hangs: results, both."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from playground.engine.context import ContextInfo, context_info, open_context
from playground.engine.engine import Engine
from playground.engine.plain_forms import silent
from playground.engine.process.pool import OPEN, Limits, Pool, PoolOwner
from playground.engine.process.worker import Parent, Service
from playground.engine.sandbox import LIMIT_BYTES
from playground.engine.textures import drain, read_picture
from playground.errors import Diagnostic, PlaygroundError, ShaderError
from playground.sketch.load import load_with
from playground.sketch.model import Sketch
from playground.sketch.techniques import Techniques, WithLibrary

if TYPE_CHECKING:
    import moderngl

LIMIT = 10.0
"""[s] What one candidate may take before it counts as one that hangs."""

_FIRST_EXTRA = (
    60.0  # [s] more for a process's first answer: it compiles every pass and draws them at full size
)
_CACHE_BYTES = 256 * 2**20
_FILES = re.compile(r"\S+\.(?:glsl|frag|comp|toml)\b(?::\d+)*:?")


@dataclass(frozen=True, kw_only=True)
class DrawTask:
    """Draw one texture of a sketch."""

    sketch: Sketch | str  # loaded, or the path of its file
    ref: str = ""  # pass[:output]; "": the picture, as bytes
    driver: str = "auto"
    frame: tuple[int, int] = (64, 36)  # pixels
    time: float = 0.0  # [s]
    steps: tuple[tuple[str, int], ...] = ()


@dataclass(frozen=True, eq=False)
class DrawResult:
    """What came of drawing it."""

    kind: str  # drawn | shader | refused | gl-error | crash | hang
    messages: tuple[str, ...] = ()  # of each mistake, without its place
    values: NDArray[Any] | None = None  # float32, or uint8 of a picture
    details: str = ""  # the mistakes with their places


class CandidateProcess(PoolOwner):
    """Draws candidates in a process of its own, with an environment of its own.

    Mesa's shader cache is off there: a text that crashes the compiler must meet the compiler.
    Use it with ``with``, or call ``close()``.
    """

    def __init__(
        self,
        *,
        software: bool = False,
        device: int | None = None,
        environment: Mapping[str, str] | None = None,
        limit: float = LIMIT,
    ) -> None:
        self.limit = limit  # [s]
        self._pool = Pool(
            __name__,
            Limits(memory_bytes=LIMIT_BYTES),
            options=(software, device),
            spare=True,
            environment={"MESA_SHADER_CACHE_DISABLE": "true", **(environment or {})},
        )
        self._warm = False  # the process has answered before

    @property
    def info(self) -> ContextInfo:
        """What draws; raises ``ContextError`` where there is no such renderer."""
        info = self._pool.run(OPEN).get("")
        assert isinstance(info, ContextInfo)
        return info

    @property
    def started(self) -> int:
        """How many processes there were."""
        return self._pool.started

    def draw(self, task: DrawTask) -> DrawResult:
        """Draw, and return what came of it; a crash and a hang are results too."""
        # Where candidates die, a process answers seldom more than once: then the limit is the limit.
        extra = 0.0 if self._warm or self._pool.died else _FIRST_EXTRA
        outcome = self._pool.run(task, seconds=self.limit + extra)
        self._warm = outcome.kind == "answer"
        if outcome.kind == "hang" and outcome.started:
            return DrawResult("hang", details=f"it took more than {self.limit:g} s and was stopped")
        if outcome.kind == "crash" and outcome.started and outcome.error is None:
            return DrawResult("crash", details=f"the process {outcome.ending}")
        result = outcome.get("drawing")
        assert isinstance(result, DrawResult)
        return result

    def renew(self) -> None:
        """Have the next candidate meet a fresh process."""
        self._warm = False
        self._pool.renew()


# ── in the worker ────────────────────────────────────────────────────────────


def open_service(parent: Parent, options: tuple[bool, int | None]) -> Service:
    """Open a context: on a software renderer, on which device."""
    software, device = options
    ctx = open_context(software=software, device=device)
    return Service(partial(_draw, ctx, {}, Techniques()), context_info(ctx))


def _draw(
    ctx: moderngl.Context, engines: dict[str, Engine], library: Techniques, task: DrawTask
) -> DrawResult:
    try:
        sketch = load_with(WithLibrary(library), task.sketch) if isinstance(task.sketch, str) else task.sketch
    except PlaygroundError as error:
        return _refused(error, "refused")
    drain(ctx)
    try:
        engine = engines.get(task.driver)
        if engine is None:
            engine = engines[task.driver] = Engine(
                ctx, driver=task.driver, cache_bytes=_CACHE_BYTES, notice=silent
            )
        steps = dict(task.steps)
        if task.ref:
            values: NDArray[Any] = engine.read(sketch, task.ref, size=task.frame, time=task.time, steps=steps)
        else:
            values = read_picture(engine.draw(sketch, size=task.frame, time=task.time, steps=steps))
    except ShaderError as error:
        return _refused(error, "shader")
    except PlaygroundError as error:
        return _refused(error, "refused")
    except MemoryError:
        return DrawResult("refused", ("memory ran out",), details="memory ran out")
    except Exception as error:  # a bug of ours, or moderngl's own
        message = f"{type(error).__name__}: {error}"
        return DrawResult("refused", (message,), details=message)
    if (gl_error := ctx.error) != "GL_NO_ERROR":
        return DrawResult("gl-error", (gl_error,), values, f"OpenGL reports {gl_error}")
    return DrawResult("drawn", values=values)


def _refused(error: PlaygroundError, kind: str) -> DrawResult:
    wrong = [d for d in error.diagnostics if d.severity == "error"]
    return DrawResult(kind, tuple(map(_message, wrong)), details=str(error))


def _message(diagnostic: Diagnostic) -> str:
    """Return a mistake without places in it."""
    return " ".join(_FILES.sub("", diagnostic.message).split())
