"""Hold what is reviewed: the results as they are now, what was accepted of them, and how to undo it.

Several pages may ask at once. A result is meant by its shot and its stamp: where the tests
have run again since, or a reference has changed, the request is refused with a reason; all
changes are made one after the other. It knows no network.
"""

from __future__ import annotations

import threading
from pathlib import Path
from urllib.parse import quote

from playground.errors import DataError, PlaygroundError
from playground.files import read_regular
from playground.paths import shown
from playground.verify.shots.accept import Change, accept, undo
from playground.verify.shots.page.document import page
from playground.verify.shots.page.shot import ShotPageContext
from playground.verify.shots.results import Record, read_results

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
        return "; ".join(change.sentences).removeprefix(f"{record.name}: ")


def _picture_url(record: Record, kind: str) -> str:
    """Return a picture's address; with the stamp, so that no older one is shown for it."""
    return f"picture/{quote(record.actual.pictures[kind])}?{record.stamp}"
