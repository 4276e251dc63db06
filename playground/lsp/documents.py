"""The texts that are open in an editor, by path, and positions in them as the editor counts."""

from __future__ import annotations

import re
import threading
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from urllib.parse import unquote, urlsplit

from lsprotocol import types
from pygls import uris

from playground.allowed_files import noting_places
from playground.engine.process.worker import summary_of
from playground.engine.sandbox import Request, Sandbox, SandboxReport
from playground.errors import ContextError, Diagnostic, OpenGLFault, PlaygroundError
from playground.paths import GLSL, current_folder, without_part
from playground.shader.source import normalised
from playground.sketch.edited import EditedText, EditedTexts
from playground.verify.check import check_file

Units = Callable[[str], int]
"""How many units an editor counts for a text: of UTF-16, unless it has agreed to others."""


@dataclass(frozen=True)
class Text:
    """A text with LF at its lines' ends, and places in it as an editor gives them."""

    text: str
    units: Units

    @cached_property
    def _starts(self) -> list[int]:
        return [0, *(match.end() for match in re.finditer("\n", self.text))]

    @cached_property
    def lines(self) -> list[str]:
        """Its lines, without their ends."""
        return self.text.split("\n")

    def offset(self, position: types.Position) -> int:
        """Return where a position is in the text; one behind its line's end is at that end."""
        if position.line >= len(self.lines):
            return len(self.text)
        line, at = self.lines[position.line], 0
        while at < len(line) and self.units(line[:at]) < position.character:
            at += 1
        return self._starts[position.line] + at

    def position(self, offset: int) -> types.Position:
        """Return the position of a place in the text."""
        row = bisect_right(self._starts, offset) - 1
        start = self._starts[row]
        return types.Position(row, self.units(self.text[start:offset]))

    def range(self, start: int, end: int) -> types.Range:
        """Return the range between two places in the text."""
        return types.Range(self.position(start), self.position(end))

    def line_start(self, row: int) -> int:
        """Return where a line begins, counted from 0; the text's end for one that is not there."""
        return self._starts[row] if row < len(self._starts) else len(self.text)


@dataclass(frozen=True)
class Document(Text, EditedText):
    """An open text."""

    uri: str
    version: int | None


class Documents(EditedTexts):
    """The open texts."""

    def __init__(self) -> None:
        super().__init__()
        self.units: Units = lambda text: len(text.encode("utf-16-le")) // 2
        self._open: dict[str, Document] = {}  # by URI

    def __iter__(self) -> Iterator[Document]:
        return iter(list(self._open.values()))

    def put(self, uri: str, text: str, version: int | None = None, language: str = "") -> Document:
        """Add or replace an open text."""
        cached = self._open.get(uri)
        path = cached.path if cached is not None else self._path(uri, language)
        document = self._open[uri] = Document(path, normalised(text), self.units, uri, version)
        return document

    def remove(self, uri: str) -> Document | None:
        """Forget a text that was closed."""
        return self._open.pop(uri, None)

    def get(self, uri: str) -> Document | None:
        """Return an open text by its URI; None for one that is not open."""
        return self._open.get(uri)

    def at(self, path: Path) -> Document | None:
        """Return the open text of a file; None where it is not open."""
        return next((document for document in self if document.path == path), None)

    def uri_of(self, path: Path) -> str:
        """Return the URI of a file, as the editor wrote it where the file is open."""
        document = self.at(path)
        return document.uri if document is not None else str(uris.from_fs_path(str(path)))

    def text_of(self, path: Path) -> Text:
        """Return the text of a file, as it is open; raise ``SketchError`` where it cannot be read."""
        return self.at(path) or Text(self.read(path), self.units)

    def _path(self, uri: str, language: str) -> Path:
        parts = urlsplit(uri)
        if parts.scheme == "file":
            return Path(str(uris.to_fs_path(uri))).absolute().resolve()
        path = Path(unquote(parts.path))
        name = re.sub(r"[^\w.-]", "_", path.name) or "untitled"
        if not path.suffix:
            name += ".toml" if "toml" in language else ".glsl"
        folder = path.parent if path.is_absolute() and path.parent.is_dir() else None
        return (folder or next(iter(self.folders), Path.cwd())).resolve() / name


# ── diagnostics ────────────────────────────────────────────────────────────────


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
        hints: Callable[[Document], list[Diagnostic]],
        *,
        software: bool = False,
        device: int | None = None,
    ) -> None:
        """Make it; ``start`` starts it.

        ``lock`` is held while texts are read, not while the sandbox draws. ``publish`` gets all that is
        wrong in a file whenever that changes; ``tell`` gets a message for the user. ``hints`` returns what
        could go of a shader, in place of a warning there. All are called in the checker's thread.
        """
        self._documents = documents
        self._publish, self._tell, self._hints = publish, tell, hints
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
        hints: list[Diagnostic] = []
        with self._lock, self._documents.reading(), noting_places() as looked_at:
            try:
                report = check_file(document.path, self._sandbox)
                diagnostics = [*report.errors, *report.warnings]
                if report.ok and not document.is_toml:  # a misspelt name would be one that nothing reads
                    hints = self._hints(document)
            except Stale:
                raise
            except PlaygroundError as error:
                diagnostics = list(error.diagnostics)
            except Exception as error:  # a mistake of ours must not end the thread
                diagnostics = [Diagnostic(f"cannot be checked: {summary_of(error)}")]
            hinted = {(hint.line, hint.column) for hint in hints}
            for diagnostic in diagnostics:
                path = self.file_named(diagnostic.file) or document.path
                if path != document.path or (diagnostic.line, diagnostic.column) not in hinted:
                    result.setdefault(path, []).append(diagnostic)
            result.setdefault(document.path, []).extend(hints)
        return _Result(
            document.version, {path: tuple(some) for path, some in result.items()}, frozenset(looked_at)
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
