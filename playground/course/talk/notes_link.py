"""The teacher's page of notes and a presentation: what the page is told, what it may ask for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from playground.course.talk.beat import Beat
from playground.course.talk.presenter import Presenter
from playground.errors import DataError, ParameterError
from playground.remote.notes import Notes

EXPECTED = 'expected {"go": "next"}, {"cover": "black"} or {"clock": "pause"}'


class NotesLink:
    """The page of one window, once it is opened; ``filled`` puts numbers into a beat's texts."""

    def __init__(
        self, presenter: Presenter, filled: Callable[[Beat], Beat], wake: Callable[[], None]
    ) -> None:
        self.notes: Notes | None = None
        self._presenter = presenter
        self._filled = filled
        self._wake = wake
        self._told: object = None

    @property
    def url(self) -> str:
        """The page's address; "" while there is none."""
        return self.notes.url if self.notes is not None else ""

    @property
    def waits(self) -> bool:
        """Whether the page asks for something."""
        return self.notes is not None and self.notes.waits

    def open(self) -> str:
        """Serve the page; return why that cannot be done, or ""."""
        try:
            self.notes = self.notes or Notes(self._act, self._wake)
        except DataError as error:
            return str(error)
        return ""

    def take(self) -> None:
        """Do what the page asked for."""
        if self.notes is not None:
            self.notes.take()

    def tell(self, language: str) -> None:
        """Tell the page what is on, where that is new."""
        presenter = self._presenter
        if self.notes is None or presenter.lesson is None or not presenter.beats:
            return
        clock, beat = presenter.clock, self._filled(presenter.beat)
        coming = self._filled(presenter.following) if presenter.following is not None else None
        key = presenter.on, presenter.at, beat, presenter.blank, clock.running, clock.started_at
        if key != self._told:
            from playground.course.talk.told import notes_message

            self._told = key
            self.notes.tell(notes_message(presenter, beat, coming, language))

    def close(self) -> None:
        """Close the page's port."""
        if self.notes is not None:
            self.notes.close()
            self.notes = None

    def _act(self, wishes: Mapping[str, Any]) -> None:
        """Do what the page asks for; raise ``ParameterError`` for what nobody knows."""
        presenter = self._presenter
        if not presenter.on:
            raise ParameterError("the presentation is over")
        go, cover, clock = (wishes.get(key) for key in ("go", "cover", "clock"))
        steps = {"next": presenter.next, "back": presenter.back}
        ends = {"first": 0, "last": len(presenter.beats) - 1}
        if isinstance(go, str) and go in steps:
            steps[go]()
        elif isinstance(go, str) and go in ends:
            presenter.go(ends[go])
        elif type(go) is int:
            presenter.go(go - 1)
        elif cover in ("black", "white"):
            presenter.cover(str(cover))
        elif clock == "pause":
            presenter.clock.toggle()
        elif clock == "reset":
            presenter.clock.reset()
        else:
            raise ParameterError(EXPECTED)
