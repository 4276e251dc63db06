"""The values of one texel beside the lines of open shaders: inlay hints, and iterations in the hover.

The texel is one that a comment of the shader names, ``// trace: 120 40``, or the one that is traced in the
window (``engine.trace.live_texel``). A thread of its own waits until typing rests, has a worker process trace
the open texts, and tells the editor to ask for hints again; until then lines that were changed have none.
"""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

from lsprotocol import types

from playground.engine.process.pool import Limits, Pool
from playground.engine.process.worker import summary_of
from playground.engine.trace.listing import heading, loop_table, note_of, text_of
from playground.engine.trace.live_texel import live_file, read_live_texel
from playground.engine.trace.model import Event, Trace
from playground.errors import ParameterError, PlaygroundError, ShaderError
from playground.lsp import describe
from playground.lsp.documents import Document, Documents
from playground.lsp.trace_worker import TraceRequest
from playground.paths import shown
from playground.shader.names import word_at
from playground.shader.syntax.tokens import tokenize

REST_SECONDS = 0.4
"""[s] without typing before a text is traced again."""

_POLL_SECONDS = 0.5  # between two looks at what the window traces
_HANDLER = "playground.lsp.trace_worker"
_LIMITS = Limits(seconds=20.0, total_seconds=60.0, memory_bytes=4 * 2**30)
_MAX_NOTE = 100  # letters of a hint
_MAX_ROWS = 32  # of a table of iterations
_MARK = re.compile(r"//\s*trace:(.*)", re.DOTALL)
_TEXEL = re.compile(
    r"\s*(\d+)[\s,]+(\d+)(?:\s+iteration\s+(\d+))?(?:\s+of\s+([\w.]+))?(?:\s+in\s+(\S+))?\s*", re.ASCII
)
EXPECTED = "// trace: X Y, and if wanted: iteration N of PASS in SKETCH"


def texel_in_comment(document: Document) -> TraceRequest | None:
    """Return what a text's comment asks to trace; None for none.

    Raises ``PlaygroundError`` for one that cannot be read.
    """
    if "trace:" not in document.text:
        return None
    for comment in tokenize(document.text)[1]:
        mark = _MARK.fullmatch(comment.text)
        if mark is None:
            continue
        match = _TEXEL.fullmatch(mark[1])
        if match is None:
            line = document.text.count("\n", 0, comment.start) + 1
            message = f"'{mark[1].strip()[:60]}' names no texel; expected {EXPECTED}"
            raise PlaygroundError(message, file=document.path, line=line)
        column, row, iteration, path, sketch = match.groups()
        beside = document.path.parent / (sketch or "")
        return TraceRequest(
            (int(column), int(row)),
            sketch=str(beside) if sketch and beside.exists() else sketch or "",
            path=path or "",
            file=document.path,
            iteration=int(iteration) if iteration else None,
        )
    return None


def texel_of_window(file: Path) -> TraceRequest | None:
    """Return what the window traces, by the file that it writes; None where it traces nothing."""
    live = read_live_texel(file)
    if live is None:
        return None
    return TraceRequest(
        live.texel,
        sketch=live.sketch,
        path=live.path,
        iteration=live.iteration,
        size=live.size,
        time=live.time,
        values=live.values,
    )


class _Traced(NamedTuple):
    """A trace, and the lines that the texts had."""

    trace: Trace
    lines: Mapping[Path, tuple[str, ...]]


@dataclass
class _State:
    """What was traced last."""

    of_comments: dict[Path, _Traced] = field(default_factory=dict)  # by document
    of_window: _Traced | None = None
    asked: dict[object, TraceRequest] = field(default_factory=dict)  # by document; "" of the window


class Tracer:
    """Traces the open shaders in a thread of its own."""

    def __init__(
        self,
        documents: Documents,
        lock: threading.RLock,
        refresh: Callable[[], None],
        tell: Callable[[str], None],
        *,
        software: bool = False,
        device: int | None = None,
    ) -> None:
        """Make it; ``start`` starts it.

        ``lock`` is held while texts are read. ``refresh`` is called in the thread when values have changed,
        ``tell`` with each message for the user once.
        """
        self._documents, self._lock = documents, lock
        self._refresh, self._tell = refresh, tell
        self._pool = Pool(_HANDLER, _LIMITS, options=(software, device))
        self._live_file = live_file()
        self._news = threading.Condition()
        self._changed = 0.0  # when a text was last, as time.monotonic
        self._ends = False
        self._state = _State()
        self._told: set[str] = set()
        self._thread = threading.Thread(target=self._run, name="tracing", daemon=True)

    def start(self) -> None:
        """Start the thread; its process starts with the first texel."""
        self._thread.start()

    def close(self) -> None:
        """End the thread and the process."""
        with self._news:
            self._ends = True
            self._news.notify()
        if self._thread.ident is not None:
            self._thread.join(timeout=5.0)
        self._pool.shutdown(wait=False, cancel_futures=True)

    def changed(self) -> None:
        """Trace again, since a text was opened, typed in, saved or closed."""
        with self._news:
            self._changed = time.monotonic()
            self._news.notify()

    # ── the thread ───────────────────────────────────────────────────────────

    def _run(self) -> None:
        seen = -1.0
        while True:
            with self._news:
                if not self._ends:
                    self._news.wait(_POLL_SECONDS)
                if self._ends:
                    return
                changed = self._changed
            rests = time.monotonic() - changed
            if changed != seen and rests < REST_SECONDS:
                time.sleep(REST_SECONDS - rests)
                continue
            seen = changed
            try:
                self._look()
            except Exception as error:  # a mistake of ours must not end the thread
                self._say(f"texels cannot be traced: {summary_of(error)}")

    def _look(self) -> None:
        """Trace what is to be traced and was not yet."""
        with self._lock:
            requests = dict(self._requests())
        for key in [key for key in self._state.asked if key not in requests]:
            del self._state.asked[key]
            self._put(key, None)
        for key, request in requests.items():
            if self._state.asked.get(key) == request:
                continue
            self._state.asked[key] = request
            self._put(key, self._trace(request))

    def _requests(self) -> Iterator[tuple[object, TraceRequest]]:
        """Yield what is to be traced, by document; "" for the window's."""
        shaders = [each for each in self._documents if not each.is_toml and each.is_ours]
        texts = tuple((each.path, each.text) for each in self._documents)
        for document in shaders:
            try:
                request = texel_in_comment(document)
            except PlaygroundError as error:
                self._say(str(error.diagnostics[0]))
                continue
            if request is not None:
                yield document.path, replace(request, unsaved=texts)
        live = texel_of_window(self._live_file) if shaders else None
        if live is not None:
            yield "", replace(live, unsaved=texts)

    def _trace(self, request: TraceRequest) -> _Traced | None:
        result = self._answer(request)
        if result is not None and not request.file:
            texts = {path for path, _ in request.unsaved if path.suffix != ".toml"}
            if texts - {Path(next(iter(result.files), ""))}:  # one that the kernel may include
                result = self._answer(replace(request, is_deep=True)) or result
        if result is None:
            return None
        lines = {Path(path): tuple(lines) for path, lines in result.files.items()}
        lines |= {path: tuple(text.split("\n")) for path, text in request.unsaved if path in lines}
        return _Traced(result, lines)

    def _answer(self, request: TraceRequest) -> Trace | None:
        task = self._pool.submit(request)
        while not task.wait(0.05):
            if self._ends:
                task.cancel(0.0)
                return None
        outcome = task.result()
        if outcome.kind == "answer" and isinstance(outcome.value, Trace):
            return outcome.value
        error = outcome.failure("the worker that traces")
        message = summary_of(error)
        if isinstance(error, PlaygroundError):
            diagnostic = error.diagnostics[0]
            message = (
                f"{diagnostic.location}: {diagnostic.message}" if diagnostic.location else diagnostic.message
            )
            is_open = diagnostic.file in {shown(path) for path, _ in request.unsaved}
            if isinstance(error, ShaderError) or (is_open and not isinstance(error, ParameterError)):
                return None  # its diagnostic is shown already
        self._say(f"texel {request.texel[0]} {request.texel[1]} is not traced: {message}")
        return None

    def _put(self, key: object, traced: _Traced | None) -> None:
        with self._news:
            if key == "":
                self._state.of_window = traced
            elif isinstance(key, Path) and traced is not None:
                self._state.of_comments[key] = traced
            elif isinstance(key, Path):
                self._state.of_comments.pop(key, None)
        self._refresh()

    def _say(self, sentence: str) -> None:
        if sentence not in self._told:
            self._told.add(sentence)
            self._tell(sentence)

    # ── what an editor shows ─────────────────────────────────────────────────

    def hints(self, document: Document, rows: range) -> list[types.InlayHint]:
        """Return the values at the ends of a text's lines, of those rows, counted from 0."""
        traced = self._of(document)
        if traced is None:
            return []
        hints = []
        for row, events in self._rows(document, traced).items():
            note = note_of(events)
            if row not in rows or not note:
                continue
            end = types.Position(row, document.units(document.lines[row].rstrip()))
            note = note if len(note) <= _MAX_NOTE else f"{note[: _MAX_NOTE - 1]}…"
            tooltip = types.MarkupContent(types.MarkupKind.Markdown, _tooltip(traced.trace, events))
            hints.append(types.InlayHint(end, note, tooltip=tooltip, padding_left=True))
        return hints

    def hover(self, document: Document, at: int) -> str:
        """Return the values of the name at a place, an iteration a row, as Markdown; "" for none."""
        traced = self._of(document)
        name, start = word_at(document.text, at)
        if traced is None or not name:
            return ""
        row = document.position(start).line
        events = [
            event
            for event in self._rows(document, traced).get(row, ())
            if re.match(rf"{re.escape(name)}\b", event.name) and event.value is not None
        ]
        return _values(traced.trace, events) if events else ""

    def _of(self, document: Document) -> _Traced | None:
        with self._news:
            own = self._state.of_comments.get(document.path)
            window = self._state.of_window
        if own is None and window is not None and document.path in window.lines:
            return window
        return own

    def _rows(self, document: Document, traced: _Traced) -> dict[int, list[Event]]:
        """Return the events by row of the text as it is now; of a line that was changed none."""
        before, now = traced.lines.get(document.path, ()), document.lines
        head = next(
            (i for i, (a, b) in enumerate(zip(before, now, strict=False)) if a != b),
            min(len(before), len(now)),
        )
        pairs = zip(reversed(before[head:]), reversed(now[head:]), strict=False)
        tail = next((i for i, (a, b) in enumerate(pairs) if a != b), min(len(before), len(now)) - head)
        rows = {}
        for line, events in traced.trace.lines(str(document.path)).items():
            row = line - 1
            if row >= len(before) - tail:
                row += len(now) - len(before)
            elif row >= head:
                continue
            rows[row] = events
        return rows


def _tooltip(trace: Trace, events: list[Event]) -> str:
    """Return what a line gave: the loop that begins there as a table, else each value."""
    parts = [heading(trace)]
    loops = [loop for loop in trace.loops() if (loop.path, loop.line) == (events[0].path, events[0].line)]
    parts += [describe.code("\n".join(loop_table(loop)), "text") for loop in loops[:4]]
    return "\n\n".join(parts if loops else [*parts, _values(trace, events)])


def _values(trace: Trace, events: list[Event]) -> str:
    """Return values as a table, an event a row: in which call and iteration it was."""
    rows = []
    for event in events[:_MAX_ROWS]:
        call = trace.calls[event.call]
        calls = [each.index for each in trace.calls_of(call.function)]
        count = f" {calls.index(call.index) + 1}" if len(calls) > 1 else ""
        at = f", iteration {', '.join(map(str, event.iterations))}" if event.iterations else ""
        name = {"return": "→", "condition": "?"}.get(event.kind, event.name)
        rows.append(f"{name} = {text_of(event.value)}    {call.function}{count}{at}")
    rows += [f"… {len(events) - _MAX_ROWS} more"] if len(events) > _MAX_ROWS else []
    return describe.code("\n".join(rows), "text")
