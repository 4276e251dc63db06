"""Trace texels in a worker process, which a driver may crash without harm: of open texts, saved or not."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from playground.allowed_files import reading_unsaved
from playground.engine.context import open_context
from playground.engine.engine import Engine
from playground.engine.plain_forms import silent
from playground.engine.process.worker import Parent, Service
from playground.engine.sandbox import Activity
from playground.engine.trace.model import Trace
from playground.errors import PlaygroundError, SketchError
from playground.paths import shown
from playground.sketch.load import is_technique, load
from playground.sketch.model import DEFAULT_PICTURE, CpuSource, Sketch, Value, kernels_of

_MAX_SKETCHES = 50  # of a folder that are looked at for one that uses a shader


@dataclass(frozen=True, slots=True)
class TraceRequest:
    """A texel to trace, in a sketch and a pass or where a file is used."""

    texel: tuple[int, int]  # column and row, from the south-west
    sketch: str = ""  # path or name; "" for one that is next to the file, or the file alone
    path: str = ""  # of the pass; "" for the first one of the file
    file: Path | None = None  # absolute, of a shader
    iteration: int | tuple[int, ...] | None = None
    size: tuple[int, int] | None = None  # of the picture [pixels]; None: as a trace has it
    time: float = 0.0  # [s]
    values: tuple[tuple[str, Value], ...] = ()
    is_deep: bool = False  # functions of included files, too
    unsaved: tuple[tuple[Path, str], ...] = ()  # texts in place of what files hold, by absolute path


def open_service(parent: Parent, options: tuple[bool, int | None]) -> Service:
    """Open a context: on a software renderer, on which device."""
    software, device = options
    ctx = open_context(software=software, device=device)
    engine = Engine(ctx, cache_bytes=256 * 2**20, notice=silent)

    def answer(request: TraceRequest) -> Trace:
        parent.report(Activity(request.path, str(request.file or "")))
        with reading_unsaved(dict(request.unsaved)):
            return trace(engine, request)

    return Service(answer)


def trace(engine: Engine, request: TraceRequest) -> Trace:
    """Return the trace that a request asks for; raise ``PlaygroundError`` where there is none."""
    sketch = load(request.sketch) if request.sketch else sketch_of(request.file)
    return engine.trace(
        sketch,
        request.path or _pass_of(sketch, request.file),
        texel=request.texel,
        iteration=request.iteration,
        function="all" if request.is_deep else None,
        size=request.size or DEFAULT_PICTURE,
        time=request.time,
        values=dict(request.values),
    )


def sketch_of(file: Path | None) -> Sketch:
    """Return a sketch of a shader's folder that uses it, else one of the shader alone."""
    if file is None:
        raise SketchError("neither a sketch nor a shader is named")
    for path in sorted(file.parent.glob("*.toml"))[:_MAX_SKETCHES]:
        try:
            if not is_technique(path) and _paths(sketch := load(path), file):
                return sketch
        except PlaygroundError:
            continue  # it is another program's, or check says what is wrong with it
    return load(file)


def _paths(sketch: Sketch, file: Path) -> list[str]:
    """Return the passes whose kernel is a file, those before that include it."""
    kernels = [
        (path, kernel) for path, kernel in kernels_of(sketch.graph) if not isinstance(kernel, CpuSource)
    ]
    own = [path for path, kernel in kernels if Path(kernel.path) == file]
    return own or [path for path, kernel in kernels if str(file) in kernel.source.files]


def _pass_of(sketch: Sketch, file: Path | None) -> str:
    paths = _paths(sketch, file) if file is not None else []
    if not paths:
        name = shown(file) if file is not None else ""
        raise SketchError(f"no pass uses {name}; name one: // trace: X Y of PASS", file=sketch.file)
    return paths[0]
