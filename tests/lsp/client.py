"""A tiny editor: starts `playground lsp` and exchanges real messages with it over its standard streams."""

from __future__ import annotations

import json
import os
import queue
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from playground.paths import GLSL

PATIENCE = 60.0  # [s] for an answer: the first check starts a process and opens a context


class Editor:
    """One editor's end."""

    def __init__(
        self, folder: Path, *arguments: str, encodings: tuple[str, ...] = (), **environ: str
    ) -> None:
        self.folder = folder
        self.errors = folder.parent / f"{folder.name}-stderr.txt"
        command = [sys.executable, "-m", "playground", "lsp", *(arguments or ("--software",))]
        root = str(GLSL.parent)
        with self.errors.open("wb") as stderr:
            self.process = subprocess.Popen(
                command,
                cwd=folder,
                env={**os.environ, "PYTHONPATH": root, **environ},
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=stderr,
            )
        self.answers: dict[int, queue.Queue[dict[str, Any]]] = {}
        self.notes: list[dict[str, Any]] = []  # every notification, in order
        self.arrived = threading.Condition()
        self.number = 0
        self.versions: dict[str, int] = {}
        self.since: dict[str, int] = {}  # how many notifications there were when a text was opened
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()
        capabilities: dict[str, Any] = (
            {"general": {"positionEncodings": list(encodings)}} if encodings else {}
        )
        capabilities |= {"workspace": {"inlayHint": {"refreshSupport": True}}}
        self.initialized = self.ask(
            "initialize",
            processId=None,
            rootUri=folder.as_uri(),
            capabilities=capabilities,
            workspaceFolders=[{"uri": folder.as_uri(), "name": "here"}],
        )
        self.send("initialized")

    def __enter__(self) -> Editor:
        return self

    def __exit__(self, *error: object) -> None:
        if self.process.poll() is None:
            try:
                self.ask("shutdown")
                self.send("exit")
                self.process.wait(timeout=20)
            finally:
                self.process.kill()
        self.reader.join(timeout=20)
        for stream in (self.process.stdin, self.process.stdout):
            assert stream is not None
            stream.close()

    # ── messages ─────────────────────────────────────────────────────────────

    def send(self, method: str, **params: Any) -> None:
        self._write({"jsonrpc": "2.0", "method": method, "params": params})

    def ask(self, method: str, **params: Any) -> Any:
        """Return the result of a request; raise ``Refusal`` where it is an error."""
        self.number += 1
        waiting = self.answers[self.number] = queue.Queue()
        asked = {"jsonrpc": "2.0", "id": self.number, "method": method}
        self._write(asked if method == "shutdown" else {**asked, "params": params})
        answer = waiting.get(timeout=PATIENCE)
        if "error" in answer:
            raise Refusal(answer["error"])
        return answer.get("result")

    def _write(self, message: dict[str, Any]) -> None:
        body = json.dumps(message).encode()
        assert self.process.stdin is not None
        self.process.stdin.write(b"Content-Length: %d\r\n\r\n%b" % (len(body), body))
        self.process.stdin.flush()

    def _read(self) -> None:
        stream = self.process.stdout
        assert stream is not None
        while line := stream.readline():
            length = 0
            while line.strip():
                name, _, value = line.decode().partition(":")
                length = int(value) if name.lower() == "content-length" else length
                line = stream.readline()
            message = json.loads(stream.read(length))
            if "method" not in message:
                self.answers[message["id"]].put(message)
                continue
            if "id" in message:
                self._write({"jsonrpc": "2.0", "id": message["id"], "result": None})
            with self.arrived:
                self.notes.append({**message, "at": time.perf_counter()})
                self.arrived.notify_all()

    # ── texts ────────────────────────────────────────────────────────────────

    def open(self, uri: str, text: str, language: str = "glsl") -> None:
        self.versions[uri] = 1
        self.since[uri] = len(self.notes)
        document = {"uri": uri, "languageId": language, "version": 1, "text": text}
        self.send("textDocument/didOpen", textDocument=document)

    def type(self, uri: str, text: str) -> int:
        """Replace the whole text, as a keystroke does; return its version."""
        self.versions[uri] += 1
        document = {"uri": uri, "version": self.versions[uri]}
        self.send("textDocument/didChange", textDocument=document, contentChanges=[{"text": text}])
        return self.versions[uri]

    def close(self, uri: str) -> None:
        self.send("textDocument/didClose", textDocument={"uri": uri})

    def at(self, method: str, uri: str, line: int, character: int, **more: Any) -> Any:
        """Ask about a place."""
        position = {"line": line, "character": character}
        return self.ask(f"textDocument/{method}", textDocument={"uri": uri}, position=position, **more)

    def diagnostics(
        self, uri: str, version: int | None = None, after: int = 0, *, some: bool = False
    ) -> list[dict[str, Any]]:
        """Wait for a file's diagnostics after so many notifications: of a version; ``some``: not none."""

        def fits(message: dict[str, Any]) -> bool:
            params = message.get("params", {})
            is_about = message["method"] == "textDocument/publishDiagnostics" and params["uri"] == uri
            of_version = version is None or (is_about and params.get("version") == version)
            return is_about and of_version and (bool(params["diagnostics"]) or not some)

        return self.note(fits, max(after, self.since.get(uri, 0)))["params"]["diagnostics"]

    def note(self, fits: Callable[[dict[str, Any]], bool], after: int = 0) -> dict[str, Any]:
        """Wait for a notification."""
        end = time.monotonic() + PATIENCE
        with self.arrived:
            while True:
                for message in self.notes[after:]:
                    if fits(message):
                        return message
                if not self.arrived.wait(max(end - time.monotonic(), 0.0)):
                    raise TimeoutError(f"no such notification; {self.errors.read_text()[-2000:]}")


class Refusal(Exception):
    """An error in answer to a request."""
