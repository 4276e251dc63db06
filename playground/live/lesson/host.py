"""Lessons beside the picture: what the window asks of them frame by frame."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from playground.live.lesson.panel import LessonPanel
from playground.live.theme import Theme
from playground.workbench.autosave import Autosave
from playground.workbench.bench import Bench
from playground.workbench.lesson.progress import progress_file, read_progress
from playground.workbench.lesson.reader import Reading


class Lessons:
    """One window's; ``remember`` takes in what is shown, for the next start."""

    def __init__(self, bench: Bench, autosave: Autosave, remember: Callable[[], None]) -> None:
        file = progress_file()
        self.reading = Reading(bench, read_progress(file), file, self._store_own, self._play)
        self._panel = LessonPanel()
        self._autosave = autosave
        self._remember = remember
        bench.lessons.toggle, bench.lessons.turn_page = self.reading.toggle, self.reading.turn_page
        bench.lessons.is_shown = lambda: self.reading.lesson is not None and self.reading.progress.shown

    def begin(self, name: str, language: str, *, beside: bool) -> None:
        """Open a lesson by name; else, ``beside`` the sketch, the one read last, unless all were closed."""
        reading = self.reading
        if language and not name:
            reading.progress.language = language
        if name:
            reading.open(name, language=language)
        elif beside and reading.progress.shown:
            reading.open(show=False)

    def draw(self, look: Theme) -> float:
        """Draw the panel; return the width it takes, in the window's units."""
        return self._panel.draw(self.reading, look)

    def update(self, *, idle: bool) -> None:
        """Take in what a frame has brought; ``idle``: there is time to compute."""
        if self.reading.figure.own is None:  # what a lesson sets is not the reader's
            self._remember()
        self.reading.update(idle=idle)

    def release(self) -> None:
        """Release what was made in the session's context; it is made again where it is needed."""
        self._panel.release()

    def _store_own(self) -> None:
        """Remember what is shown, before a lesson shows something else."""
        self._remember()
        self._autosave.pause()

    def _play(self, sketch: Path) -> None:
        self._autosave.open(sketch)
