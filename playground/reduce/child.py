"""The process in which candidates are drawn: opens a context, looks at what it is handed, answers.

Run by ``reduce.worker`` only, as ``python -m playground.reduce.child MEMORY RENDERER DEVICE SECONDS``.
It may crash or hang, and is then replaced.
"""

from __future__ import annotations

import os
import re
import signal
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from playground.engine.engine import Engine
from playground.engine.plain_forms import silent
from playground.engine.sandbox_process import receive, send
from playground.errors import Diagnostic, PlaygroundError, ShaderError
from playground.gpu.context import ContextInfo, context_info, open_context
from playground.gpu.textures import drain, read_picture
from playground.sketch.load import load_with
from playground.sketch.model import Sketch
from playground.sketch.techniques import Techniques, WithLibrary

if TYPE_CHECKING:
    import moderngl

_CACHE_BYTES = 256 * 2**20
_FILES = re.compile(r"\S+\.(?:glsl|frag|comp|toml)\b(?::\d+)*:?")


@dataclass(frozen=True)
class Task:
    """Draw one texture of a sketch."""

    sketch: Sketch | str  # loaded, or the path of its file
    ref: str = ""  # pass[:output]; "": the picture, as bytes
    driver: str = "auto"
    frame: tuple[int, int] = (64, 36)  # pixels
    time: float = 0.0  # [s]
    steps: tuple[tuple[str, int], ...] = ()


@dataclass(frozen=True, eq=False)
class Seen:
    """What came of drawing it."""

    word: str  # drawn | shader | refused | fault | crash | hang
    messages: tuple[str, ...] = ()  # of each mistake, without its place
    values: NDArray[Any] | None = None  # float32, or uint8 of a picture
    told: str = ""  # the mistakes with their places


def main() -> None:
    """Answer tasks until the parent closes its end."""
    memory, renderer, device, longest = int(sys.argv[1]), sys.argv[2], sys.argv[3], float(sys.argv[4])
    tasks = sys.stdin.buffer
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever a driver prints must not get between the answers
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's
    try:
        ctx = open_context(software=renderer == "software", device=int(device) if device else None)
        info: ContextInfo | PlaygroundError = context_info(ctx)
    except PlaygroundError as error:
        info = error
    send(answers, info)
    if isinstance(info, PlaygroundError):
        return
    _limit(memory)
    engines: dict[str, Engine] = {}
    library = Techniques()
    while (task := receive(tasks)) is not None:
        assert isinstance(task, Task)
        _end_yourself_after(longest)
        seen = _look(ctx, engines, library, task)
        _end_yourself_after(0.0)
        send(answers, seen)


def _look(ctx: moderngl.Context, engines: dict[str, Engine], library: Techniques, task: Task) -> Seen:
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
        return Seen("refused", ("memory ran out",), told="memory ran out")
    except Exception as error:  # a fault of ours, or moderngl's own: words must reach the parent
        said = f"{type(error).__name__}: {error}"
        return Seen("refused", (said,), told=said)
    fault = ctx.error
    if fault != "GL_NO_ERROR":
        return Seen("fault", (fault,), values, f"OpenGL reports {fault}")
    return Seen("drawn", values=values)


def _refused(error: PlaygroundError, word: str) -> Seen:
    wrong = [d for d in error.diagnostics if d.severity == "error"]
    return Seen(word, tuple(map(_message, wrong)), told=str(error))


def _message(diagnostic: Diagnostic) -> str:
    """Return a mistake without places in it."""
    return " ".join(_FILES.sub("", diagnostic.message).split())


def _end_yourself_after(seconds: float) -> None:
    """Have the system end this process in case it hangs and its parent is gone; 0: no more."""
    if hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_REAL, seconds)


def _limit(memory: int) -> None:
    try:
        import resource
    except ImportError:  # Windows
        return
    resource.setrlimit(resource.RLIMIT_DATA, (memory, memory))


if __name__ == "__main__":
    # Unpickled in the parent, what is sent must be of the module, not of __main__.
    from playground.reduce import child

    child.main()
