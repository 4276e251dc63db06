"""Serve the page of results on this machine, with buttons that accept pictures and undo that.

Anyone who can send a request to the port could change references, so only who has the page's address
may (see ``local_server``); one that changes something has the token in a header too. Only the few paths
below are known, and no part of one becomes the name of a file: a picture is looked up among those that the
records name. The page's policy lets nothing run, and nothing be fetched, but its own.

A request names the result it means by its stamp. Where the tests have run again since, or a
reference has changed, it is refused in words; all changes are made one after the other.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any
from urllib.parse import unquote

from playground.errors import DataError, ParameterError
from playground.json_text import read_json
from playground.local_server import HTML, PNG, Answer, LocalServer, Request, as_json, refused
from playground.verify.shots.page.document import policy_of
from playground.verify.shots.review_session import ReviewSession

MAX_REQUEST_BYTES = 2**20
"""[bytes] What a request may hold: the names of thousands of shots."""


class Review:
    """The server of one review, until `end` is called or the page says so."""

    def __init__(self, folder: Path, port: int = 0) -> None:
        """Listen on 127.0.0.1; raise ``DataError`` for a folder without results, or a port that is taken."""
        self.session = ReviewSession(folder)
        routes = {
            "GET ": self._page,
            "GET state": lambda _: as_json(self.session.state()),
            "GET picture/": self._picture,
            "POST act": self._act,
            "POST done": lambda _: as_json({}, last=True),
        }
        try:
            self.server = LocalServer(routes, port, max_bytes=MAX_REQUEST_BYTES, proof="X-Shots-Token")
        except OSError as error:
            raise DataError(f"cannot listen on port {port}: {error.strerror}; try --port 0") from error

    @property
    def url(self) -> str:
        """The page's address, with the token."""
        return self.server.guard.url

    def serve(self) -> None:
        """Answer requests until `end`."""
        self.server.serve()

    def end(self) -> None:
        """Stop `serve`, once what is under way is answered."""
        self.server.end()

    def summary(self) -> list[str]:
        """Return what was accepted and not undone."""
        done = list(self.session.changes.values())  # a request may still be answered
        written = [line for change in done if change.written for line in change.sentences]
        return written or ["nothing was accepted"]

    def __enter__(self) -> Review:
        return self

    def __exit__(self, *_: object) -> None:
        self.server.server_close()

    def _page(self, request: Request) -> Answer:
        return Answer(200, HTML, self.session.page().encode(), policy_of(self.session.setting))

    def _picture(self, request: Request) -> Answer:
        data = self.session.picture(unquote(request.path))
        return refused(404, "there is no such page") if data is None else Answer(200, PNG, data)

    def _act(self, request: Request) -> Answer:
        try:
            body: Any = read_json(request.body)
            action = body["action"]
            shots = [(str(shot["name"]), str(shot["stamp"])) for shot in body["shots"]]
            if action not in ("accept", "also", "undo"):
                raise ValueError
        except (ValueError, TypeError, KeyError):
            raise ParameterError("expected an action and its shots, as JSON") from None
        return as_json(self.session.act(action, shots))
