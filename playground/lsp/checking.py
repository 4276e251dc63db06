"""Diagnostics as one types: ``check_file`` on the texts that are open, saved or not, the newest first.

One thread checks one text after the other; what draws is drawn in the sandbox's process, which may hang or
crash alone. A keystroke makes what is being checked stale: it is given up, and the text that was typed in
goes first. Then come the open texts that read it.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from playground.allowed_files import noting_places
from playground.engine.process.worker import summary_of
from playground.engine.sandbox import Request, Sandbox, SandboxReport
from playground.errors import ContextError, Diagnostic, OpenGLFault, PlaygroundError
from playground.lsp.documents import Document, Documents
from playground.paths import GLSL, current_folder, without_part
from playground.verify.check import check_file

Found = Mapping[Path, tuple[Diagnostic, ...]]
"""What is wrong, by file."""


class Stale(Exception):
    """The text was changed while it was checked."""


@dataclass
class _Result:
    """What one text's check found."""

    version: int | None = None
    diagnostics: Found = field(default_factory=dict)
    places: frozenset[Path] = frozenset()  # where files were looked for


class Checker:
    """Checks the open texts in a thread of its own."""

    def __init__(
        self,
        documents: Documents,
        lock: threading.RLock,
        publish: Callable[[Path, list[Diagnostic]], None],
        tell: Callable[[str], None],
        *,
        software: bool = False,
        device: int | None = None,
    ) -> None:
        """Make it; ``start`` starts it.

        ``lock`` is held while texts are read, not while the sandbox draws. ``publish`` gets all that is
        wrong in a file whenever that changes; ``tell`` gets a message for the user. Both are called in
        the checker's thread.
        """
        self._documents = documents
        self._publish, self._tell = publish, tell
        self._sandbox = _Sandbox(lock, self._give_up_if_stale, self._without_graphics, software, device)
        self._lock = lock
        self._news = threading.Condition()
        self._wanted: dict[str, None] = {}  # URIs of what is to be checked, first one first
        self._stale = self._ends = False
        self._results: dict[str, _Result] = {}  # by URI
        self._thread = threading.Thread(target=self._run, name="checking", daemon=True)

    def start(self) -> None:
        """Start the thread, and the sandbox's process."""
        self._thread.start()

    def close(self) -> None:
        """End the thread and the sandbox's process."""
        with self._news:
            self._ends = self._stale = True
            self._news.notify()
        if self._thread.ident is not None:
            self._thread.join(timeout=5.0)

    def changed(self, document: Document) -> None:
        """Check a text that was opened or typed in, before all others."""
        with self._news:
            self._wanted = {document.uri: None, **self._wanted}
            self._stale = True
            self._news.notify()

    def files_changed(self, paths: set[Path]) -> None:
        """Check the open texts again that read files which were saved, made, moved or deleted."""
        with self._news:
            for document in self._documents:
                result = self._results.get(document.uri)
                if result is None or document.path in paths or result.places & paths:
                    self._wanted[document.uri] = None
            self._news.notify()

    def closed(self, document: Document) -> None:
        """Take back what a text's check found; what reads the file has the saved text again."""
        with self._news:
            self._wanted.pop(document.uri, None)
            result = self._results.pop(document.uri, None)
        for path in result.diagnostics if result is not None else ():
            self._publish_of(path)
        self.files_changed({document.path})

    # ── the thread ───────────────────────────────────────────────────────────

    def _run(self) -> None:
        with self._sandbox:
            self._sandbox.start()
            while True:
                with self._news:
                    while not self._wanted and not self._ends:
                        self._news.wait()
                    if self._ends:
                        return
                    uri = next(iter(self._wanted))
                    del self._wanted[uri]
                    self._stale = False
                document = self._documents.get(uri)
                if document is not None:
                    self._take(document)

    def _take(self, document: Document) -> None:
        """Check a text; put it back behind what made it stale."""
        try:
            result = self._checked(document)
        except Stale:
            with self._news:
                self._wanted.setdefault(document.uri)
            return
        with self._news:
            if self._documents.get(document.uri) is not document:  # closed, or typed in: that is checked next
                return
            old = self._results.get(document.uri, _Result())
            self._results[document.uri] = result
            if old.version != result.version or not old.places:
                for other, its in self._results.items():
                    if other != document.uri and document.path in its.places:
                        self._wanted.setdefault(other)
        for path in dict.fromkeys([document.path, *old.diagnostics, *result.diagnostics]):
            self._publish_of(path)

    def _checked(self, document: Document) -> _Result:
        if not document.is_ours:
            return _Result(document.version)
        result: dict[Path, list[Diagnostic]] = {}
        with self._lock, self._documents.reading(), noting_places() as places:
            try:
                report = check_file(document.path, self._sandbox)
                diagnostics = [*report.errors, *report.warnings]
            except Stale:
                raise
            except PlaygroundError as error:
                diagnostics = list(error.diagnostics)
            except Exception as error:  # a mistake of ours must not end the thread
                diagnostics = [Diagnostic(f"cannot be checked: {summary_of(error)}")]
            for diagnostic in diagnostics:
                path = self.file_named(diagnostic.file) or document.path
                result.setdefault(path, []).append(diagnostic)
        return _Result(
            document.version, {path: tuple(some) for path, some in result.items()}, frozenset(places)
        )

    def file_named(self, name: str) -> Path | None:
        """Return the file that a diagnostic names as its user would; None for one that is not there."""
        name = without_part(name)
        places = [Path(name)] if Path(name).is_absolute() else [current_folder() / name]
        if name.startswith("glsl/"):
            places.append(GLSL / name.removeprefix("glsl/"))
        for position in places if name else ():
            path = position.resolve()
            if self._documents.at(path) is not None or path.is_file():
                return path
        return None

    def _publish_of(self, path: Path) -> None:
        """Publish all that is wrong in a file, whichever texts' checks have found it."""
        with self._news:
            diagnostics = [d for result in self._results.values() for d in result.diagnostics.get(path, ())]
        once = {(d.line, d.column, d.message): d for d in diagnostics}
        self._publish(path, list(once.values()))

    def _give_up_if_stale(self) -> None:
        if self._stale:
            raise Stale

    def _without_graphics(self, why: str) -> None:
        self._tell(f"shaders are not compiled here, and only texts are checked: {why}")


class _Sandbox(Sandbox):
    """The sandbox, waited for without the lock; where nothing can be drawn, everything passes."""

    def __init__(
        self,
        lock: threading.RLock,
        while_waiting: Callable[[], None],
        lacking: Callable[[str], None],
        software: bool,
        device: int | None,
    ) -> None:
        super().__init__(software=software, device=device)
        self.while_waiting = while_waiting
        self._held = lock
        self._on_lacking = lacking
        self._is_lacking = False

    def run(self, request: Request) -> SandboxReport:
        """Try something, as ``Sandbox.run`` does; raise ``Stale`` where it is wanted no more."""
        if self._is_lacking:
            return SandboxReport(True)
        self.while_waiting()
        self._held.release()
        try:
            report = super().run(request)
        finally:
            self._held.acquire()
        if isinstance(report.error, ContextError) and not isinstance(report.error, OpenGLFault):
            self._is_lacking = True
            self._on_lacking(report.error.diagnostics[0].message)
            return SandboxReport(True)
        return report
