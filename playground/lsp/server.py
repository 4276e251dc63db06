"""The messages of the Language Server Protocol, and who answers each.

No answer is a traceback: a mistake of ours is one line in the editor's log, and the answer is empty.
Texts are sent whole, so that no count of lines but the project's own is needed.
"""

from __future__ import annotations

import asyncio
import logging
import os
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Protocol, TypeVar

from lsprotocol import types
from pygls import uris
from pygls.exceptions import FeatureRequestError, JsonRpcException
from pygls.lsp.server import LanguageServer

from playground._version import __version__
from playground.errors import Diagnostic, PlaygroundError
from playground.lsp import explain, highlight
from playground.lsp.complete import complete_shader, complete_sketch
from playground.lsp.documents import Checker, Document, Documents, Text
from playground.lsp.traced import Tracer
from playground.shader.names import word_at
from playground.sketch.rename import Refused, prepare, references, rename
from playground.sketch.shader_names import library_declared

T = TypeVar("T")

_REFUSED = -32803  # the protocol's RequestFailed
_SEVERITIES = {
    "error": types.DiagnosticSeverity.Error,
    "warning": types.DiagnosticSeverity.Warning,
    "hint": types.DiagnosticSeverity.Hint,
}
_TRIGGERS = ["/", '"', ".", "!", "(", "[", "{", "#", "="]


class Server(LanguageServer):
    """The server of one editor."""

    def __init__(self, *, software: bool = False, device: int | None = None) -> None:
        super().__init__("playground", __version__, text_document_sync_kind=types.TextDocumentSyncKind.Full)
        self.documents = Documents()
        self.loop: asyncio.AbstractEventLoop | None = None  # once the editor has begun
        self.lock = threading.RLock()  # held by who reads texts: what is cached of them is for one thread
        self.checker = Checker(
            self.documents,
            self.lock,
            self._publish,
            self._tell,
            self._hints,
            software=software,
            device=device,
        )
        self.tracer = Tracer(
            self.documents, self.lock, self._refresh_hints, self._tell, software=software, device=device
        )
        self._published: dict[Path, str] = {}  # under which URI a file's diagnostics were sent last
        for name, (answer, options) in _FEATURES.items():
            self.feature(name, options)(guarded(self, answer))

    def report_server_error(self, error: Exception, source: object) -> None:
        """Log what the protocol's own code cannot do in one line; a request's error is its answer."""
        if source is FeatureRequestError:
            return
        self.log(f"{type(error).__name__}: {str(error).partition(chr(10))[0][:300]}")

    def log(self, sentence: str) -> None:
        """Write a message to the editor's log."""
        with suppress(Exception):  # the editor is gone
            self.window_log_message(types.LogMessageParams(types.MessageType.Warning, sentence))

    def on_loop(self, call: Callable[[], object]) -> None:
        """Send something from another thread."""
        if self.loop is not None:
            with suppress(RuntimeError):  # it has ended
                self.loop.call_soon_threadsafe(call)

    def _publish(self, path: Path, diagnostics: list[Diagnostic]) -> None:
        with self.lock:
            document = self.documents.at(path)
            uri = self.documents.uri_of(path)
            try:
                text = self.documents.text_of(path)
            except PlaygroundError:
                text = Text("", self.documents.units)
            sent = types.PublishDiagnosticsParams(
                uri, [self._diagnostic(d, text) for d in diagnostics], document.version if document else None
            )
            before = self._published.get(path, uri)
            self._published[path] = uri
        if before != uri:  # it was open by another name
            empty = types.PublishDiagnosticsParams(before, [])
            self.on_loop(lambda: self.text_document_publish_diagnostics(empty))
        self.on_loop(lambda: self.text_document_publish_diagnostics(sent))

    def _tell(self, sentence: str) -> None:
        message = types.ShowMessageParams(types.MessageType.Warning, sentence)
        self.on_loop(lambda: self.window_show_message(message))

    def _refresh_hints(self) -> None:
        workspace = self.client_capabilities.workspace
        hints = workspace.inlay_hint if workspace is not None else None
        if hints is not None and hints.refresh_support:
            self.on_loop(lambda: self.workspace_inlay_hint_refresh(None))

    def _hints(self, document: Document) -> list[Diagnostic]:
        return highlight.unused_names(document, self.documents)

    def _diagnostic(self, diagnostic: Diagnostic, text: Text) -> types.Diagnostic:
        row = min(max(diagnostic.line - 1, 0), len(text.lines) - 1)
        line = text.lines[row]
        start, end = len(line) - len(line.lstrip()), len(line.rstrip())
        if diagnostic.line and diagnostic.column:
            start = min(diagnostic.column - 1, len(line))
            word, at = word_at(line, start)
            end = at + len(word) if word and at == start else min(start + 1, len(line))
        base = text.line_start(row)
        return types.Diagnostic(
            text.range(base + start, base + max(start, end)),
            diagnostic.message,
            severity=_SEVERITIES[diagnostic.severity],
            tags=[types.DiagnosticTag.Unnecessary] if diagnostic.severity == "hint" else None,
            source="playground",
            related_information=self._chain(diagnostic) or None,
        )

    def _chain(self, diagnostic: Diagnostic) -> list[types.DiagnosticRelatedInformation]:
        """Return the includes that lead to a diagnostic."""
        related = []
        for location in reversed(diagnostic.chain):
            name, _, line = location.rpartition(":")
            path = self.checker.file_named(name)
            if path is not None and line.isdecimal():
                at = types.Position(max(int(line) - 1, 0), 0)
                where = types.Location(self.documents.uri_of(path), types.Range(at, at))
                related.append(types.DiagnosticRelatedInformation(where, "included from here"))
        return related


def serve(port: int | None, *, software: bool = False, device: int | None = None) -> None:
    """Serve one editor over standard input and output, or on a port of this computer; return when it ends."""
    for name in ("pygls", "asyncio"):  # what they log has tracebacks
        logging.getLogger(name).addHandler(logging.NullHandler())
        logging.getLogger(name).propagate = False
    server = Server(software=software, device=device)
    try:
        if port is not None:
            server.start_tcp("127.0.0.1", port)
            return
        # Only messages go to standard output: what a library prints goes where errors go.
        with os.fdopen(os.dup(sys.stdout.fileno()), "wb") as output:
            os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
            server.start_io(sys.stdin.buffer, output)
    finally:
        server.checker.close()
        server.tracer.close()


def guarded(server: Server, answer: Callable[[Server, T], object]) -> Callable[[T], object]:
    """Return a handler that has the lock, and whose mistakes are no tracebacks."""

    def handler(params: T) -> object:
        with server.lock:
            try:
                return answer(server, params)
            except Refused as why:
                raise JsonRpcException(str(why), _REFUSED) from None
            except PlaygroundError as error:
                server.log(error.diagnostics[0].message)
            except Exception as error:
                server.log(f"{answer.__name__.strip('_')} failed: {type(error).__name__}: {error}")
            return None

    return handler


# ── the texts ────────────────────────────────────────────────────────────────


def _initialize(server: Server, params: types.InitializeParams) -> None:
    server.loop = asyncio.get_running_loop()
    folders = [folder.uri for folder in params.workspace_folders or ()] or [params.root_uri or ""]
    server.documents.folders = tuple(
        Path(path).resolve() for uri in folders if uri and (path := uris.to_fs_path(uri))
    )


def _initialized(server: Server, params: types.InitializedParams) -> None:
    server.documents.units = server.workspace.position_codec.client_num_units
    server.checker.start()
    server.tracer.start()
    threading.Thread(target=library_declared, daemon=True).start()  # read once, before it is asked for
    workspace = server.client_capabilities.workspace
    watched = workspace.did_change_watched_files if workspace is not None else None
    if watched is not None and watched.dynamic_registration:
        watcher = types.FileSystemWatcher("**/*.{glsl,comp,frag,fs,fragment,toml}")
        options = types.DidChangeWatchedFilesRegistrationOptions([watcher])
        method = types.WORKSPACE_DID_CHANGE_WATCHED_FILES
        registration = types.Registration("watched-files", method, options)
        server.client_register_capability(types.RegistrationParams([registration]))


def _opened(server: Server, params: types.DidOpenTextDocumentParams) -> None:
    document = params.text_document
    server.checker.changed(
        server.documents.put(document.uri, document.text, document.version, document.language_id)
    )
    server.tracer.changed()


def _changed(server: Server, params: types.DidChangeTextDocumentParams) -> None:
    uri = params.text_document.uri
    text = server.workspace.get_text_document(uri).source
    server.checker.changed(server.documents.put(uri, text, params.text_document.version))
    server.tracer.changed()


def _saved(server: Server, params: types.DidSaveTextDocumentParams) -> None:
    document = server.documents.get(params.text_document.uri)
    if document is not None:
        server.checker.files_changed({document.path})


def _closed(server: Server, params: types.DidCloseTextDocumentParams) -> None:
    document = server.documents.remove(params.text_document.uri)
    if document is not None:
        server.checker.closed(document)
        server.tracer.changed()


def _watched(server: Server, params: types.DidChangeWatchedFilesParams) -> None:
    paths = {Path(path).resolve() for change in params.changes if (path := uris.to_fs_path(change.uri))}
    server.checker.files_changed(paths)


def _moved(server: Server, params: types.RenameFilesParams) -> None:
    server.checker.files_changed({document.path for document in server.documents})


def _folders(server: Server, params: types.DidChangeWorkspaceFoldersParams) -> None:
    server.documents.folders = tuple(
        Path(path).resolve() for uri in server.workspace.folders if (path := uris.to_fs_path(uri)) is not None
    )


# ── requests ─────────────────────────────────────────────────────────────────


class _Params(Protocol):
    """The params of a request that is about a place."""

    @property
    def text_document(self) -> types.TextDocumentIdentifier: ...

    @property
    def position(self) -> types.Position: ...


def _at(server: Server, params: _Params) -> tuple[Document, int] | None:
    """Return the text and the place that a request is about; None for a text that is not ours."""
    document = server.documents.get(params.text_document.uri)
    if document is None or not (document.is_toml or document.is_ours):
        return None
    return document, document.offset(params.position)


def _completion(server: Server, params: types.CompletionParams) -> types.CompletionList | None:
    if (opened := _at(server, params)) is None:
        return None
    document, at = opened
    complete = complete_sketch if document.is_toml else complete_shader
    return types.CompletionList(is_incomplete=True, items=complete(document, server.documents, at))


def _hover(server: Server, params: types.HoverParams) -> types.Hover | None:
    if (opened := _at(server, params)) is None:
        return None
    document, at = opened
    if document.is_toml:
        text = explain.hover_sketch(document, server.documents, at)
    else:
        values = server.tracer.hover(document, at)
        text = "\n\n".join(filter(None, [values, explain.hover_shader(document, server.documents, at)]))
    return types.Hover(types.MarkupContent(types.MarkupKind.Markdown, text)) if text else None


def _definition(server: Server, params: types.DefinitionParams) -> types.Location | None:
    if (opened := _at(server, params)) is None:
        return None
    document, at = opened
    define = explain.define_sketch if document.is_toml else explain.define_shader
    target = define(document, server.documents, at)
    if target is None:
        return None
    text = server.documents.text_of(target.path)
    where = text.range(target.at, target.at + target.length)
    return types.Location(server.documents.uri_of(target.path), where)


def _references(server: Server, params: types.ReferenceParams) -> list[types.Location] | None:
    if (opened := _at(server, params)) is None or opened[0].is_toml:
        return None
    locations = []
    for path, places in references(opened[0], server.documents, opened[1]).items():
        text = server.documents.text_of(path)
        uri = server.documents.uri_of(path)
        locations += [types.Location(uri, text.range(start, end)) for start, end in places]
    return locations


def _highlights(
    server: Server, params: types.DocumentHighlightParams
) -> list[types.DocumentHighlight] | None:
    if (opened := _at(server, params)) is None or opened[0].is_toml:
        return None
    return highlight.highlights(opened[0], server.documents, opened[1])


def _inlay_hints(server: Server, params: types.InlayHintParams) -> list[types.InlayHint] | None:
    document = server.documents.get(params.text_document.uri)
    if document is None or document.is_toml or not document.is_ours:
        return None
    return server.tracer.hints(document, range(params.range.start.line, params.range.end.line + 1))


def _semantic_tokens(server: Server, params: types.SemanticTokensParams) -> types.SemanticTokens | None:
    document = server.documents.get(params.text_document.uri)
    if document is None or document.is_toml or not document.is_ours:
        return None
    return highlight.semantic_tokens(document, server.documents)


def _symbols(server: Server, params: types.DocumentSymbolParams) -> list[types.DocumentSymbol] | None:
    document = server.documents.get(params.text_document.uri)
    if document is None or not document.is_ours:
        return None
    return explain.symbols_of_sketch(document) if document.is_toml else explain.symbols_of_shader(document)


def _colours(server: Server, params: types.DocumentColorParams) -> list[types.ColorInformation]:
    document = server.documents.get(params.text_document.uri)
    if document is None or not document.is_ours:
        return []
    of = explain.colours_of_sketch if document.is_toml else explain.colours_of_shader
    return of(document, server.documents)


def _presentations(server: Server, params: types.ColorPresentationParams) -> list[types.ColorPresentation]:
    document = server.documents.get(params.text_document.uri)
    if document is None or not document.is_ours:
        return []
    present = explain.present_in_sketch if document.is_toml else explain.present_in_shader
    return present(document, server.documents, params.range, params.color)


def _prepare_rename(server: Server, params: types.PrepareRenameParams) -> types.Range | None:
    document, at = _text_to_rename(server, params)
    return document.range(*prepare(document, server.documents, at))


def _rename(server: Server, params: types.RenameParams) -> types.WorkspaceEdit:
    document, at = _text_to_rename(server, params)
    changes: dict[str, list[types.TextEdit]] = {}
    for path, edits in rename(document, server.documents, at, params.new_name).items():
        text = server.documents.text_of(path)
        changes[server.documents.uri_of(path)] = [
            types.TextEdit(text.range(start, end), new) for start, end, new in edits
        ]
    return types.WorkspaceEdit(changes=changes)


def _text_to_rename(server: Server, params: _Params) -> tuple[Document, int]:
    opened = _at(server, params)
    if opened is None:
        raise Refused("there is no name here that can be renamed")
    return opened


_FILES = types.FileOperationRegistrationOptions(
    [types.FileOperationFilter(types.FileOperationPattern("**/*"), scheme="file")]
)
_FEATURES: dict[str, tuple[Callable[..., object], object]] = {
    types.INITIALIZE: (_initialize, None),
    types.INITIALIZED: (_initialized, None),
    types.TEXT_DOCUMENT_DID_OPEN: (_opened, None),
    types.TEXT_DOCUMENT_DID_CHANGE: (_changed, None),
    types.TEXT_DOCUMENT_DID_SAVE: (_saved, None),
    types.TEXT_DOCUMENT_DID_CLOSE: (_closed, None),
    types.WORKSPACE_DID_CHANGE_WATCHED_FILES: (_watched, None),
    types.WORKSPACE_DID_RENAME_FILES: (_moved, _FILES),
    types.WORKSPACE_DID_CHANGE_WORKSPACE_FOLDERS: (_folders, None),
    types.TEXT_DOCUMENT_COMPLETION: (_completion, types.CompletionOptions(_TRIGGERS)),
    types.TEXT_DOCUMENT_HOVER: (_hover, None),
    types.TEXT_DOCUMENT_DEFINITION: (_definition, None),
    types.TEXT_DOCUMENT_REFERENCES: (_references, None),
    types.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT: (_highlights, None),
    types.TEXT_DOCUMENT_INLAY_HINT: (_inlay_hints, None),
    types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL: (
        _semantic_tokens,
        types.SemanticTokensRegistrationOptions(highlight.LEGEND, full=True),
    ),
    types.TEXT_DOCUMENT_DOCUMENT_SYMBOL: (_symbols, None),
    types.TEXT_DOCUMENT_DOCUMENT_COLOR: (_colours, None),
    types.TEXT_DOCUMENT_COLOR_PRESENTATION: (_presentations, None),
    types.TEXT_DOCUMENT_PREPARE_RENAME: (_prepare_rename, None),
    types.TEXT_DOCUMENT_RENAME: (_rename, types.RenameOptions(prepare_provider=True)),
}
"""Message → what answers it, and what the editor is told of it."""
