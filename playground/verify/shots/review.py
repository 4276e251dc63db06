"""Serve the page of results on this machine, with buttons that accept pictures and undo that.

Anyone who can send a request to the port could change references, so only who has the page's address
may (see ``local_server``); one that changes something has the token in a header too. Only the few paths
below are known, and no part of one becomes the name of a file: a picture is looked up among those that the
records name. The page's policy lets nothing run, and nothing be fetched, but its own.

Several pages may ask at once. A request names the result it means, by its shot and its stamp. Where the tests
have run again since, or a reference has changed, it is refused with a reason; all changes are made one
after the other.
"""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any
from urllib.parse import quote, unquote

from playground.errors import DataError, ParameterError, PlaygroundError
from playground.files import read_regular
from playground.json_text import read_json
from playground.local_server import HTML, PNG, Answer, LocalServer, Request, as_json, refused
from playground.paths import shown
from playground.verify.shots.accept import Change, accept, undo
from playground.verify.shots.page.document import ShotPageContext, page, policy_of
from playground.verify.shots.results import Record, read_results

# ── what is reviewed: it knows no network ────────────────────────────────────


_Result = tuple[str, str]  # a shot's "sketch/shot", and the stamp of its result


class ReviewSession:
    """The results that are reviewed, and what was accepted so far."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.changes: dict[_Result, Change] = {}  # what was accepted and not undone
        self._messages: dict[_Result, str] = {}
        self._pictures: set[str] = set()  # that records name
        self._lock = threading.Lock()
        self.records()  # a folder without any is an error at once

    def records(self) -> dict[str, Record]:
        """Return the records as they are now, by "sketch/shot"; raise ``DataError``."""
        records = {record.name: record for record in read_results(self.folder)}
        self._pictures = {name for record in records.values() for name in record.actual.pictures.values()}
        return records

    def page(self) -> str:
        """Return the page on the results as they are now."""
        return page(list(self.records().values()), self.setting)

    @property
    def setting(self) -> ShotPageContext:
        """What the page is for: review."""
        return ShotPageContext(shown(self.folder), _picture_url, review=True)

    def picture(self, name: str) -> bytes | None:
        """Return the file of a picture that a record names, as "hills/dawn.actual.png"; None for no other."""
        if name not in self._pictures:
            self.records()
        if name not in self._pictures:
            return None
        try:
            return read_regular(self.folder / name)
        except OSError:
            return None

    def state(self) -> dict[str, dict[str, str]]:
        """Return, of each shot that failed, its stamp, whether it was accepted, and the last message."""
        with self._lock:
            return {name: self._state(record) for name, record in self.records().items() if not record.ok}

    def act(self, action: str, shots: list[_Result]) -> list[dict[str, object]]:
        """Accept ("accept", "also") or "undo" shots, given by name and stamp; return what came of each."""
        with self._lock:
            records = self.records()
            return [self._act(action, records.get(result[0]), result) for result in shots]

    def _state(self, record: Record) -> dict[str, str]:
        result = record.name, record.stamp
        change = self.changes.get(result)
        state = "open" if change is None else "further" if change.further else "accepted"
        return {"stamp": record.stamp, "state": state, "message": self._messages.get(result, "")}

    def _act(self, action: str, record: Record | None, result: _Result) -> dict[str, object]:
        name = result[0]
        try:
            self._messages[result] = self._done(action, record, result)
        except PlaygroundError as error:
            return {"name": name, "ok": False, "message": str(error).removeprefix(f"{name}: ")}
        return {"name": name, "ok": True, "message": self._messages[result]}

    def _done(self, action: str, record: Record | None, result: _Result) -> str:
        if record is None or record.stamp != result[1]:
            raise DataError("the tests have run again since this page was loaded; load it again")
        change = self.changes.get(result)
        if action == "undo":
            if change is None:
                raise DataError("nothing to undo")
            lines = undo(change)
            del self.changes[result]
            return "; ".join(lines) or "nothing was written, so nothing had to be undone"
        if change is not None:
            raise DataError("it is accepted already")
        self.changes[result] = change = accept(self.folder, record, also=action == "also")
        return "; ".join(change.messages).removeprefix(f"{record.name}: ")


def _picture_url(record: Record, kind: str) -> str:
    """Return a picture's address; with the stamp, so that no older one is shown for it."""
    return f"picture/{quote(record.actual.pictures[kind])}?{record.stamp}"


# ── the server ───────────────────────────────────────────────────────────────


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
        written = [line for change in done if change.written for line in change.messages]
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
