"""Lessons beside the picture: what the window asks of them turn by turn."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from playground.live.lesson.panel import LessonPanel
from playground.live.theme import Theme
from playground.workbench.actions import Actions
from playground.workbench.autosave import Rememberer
from playground.workbench.lesson.progress import progress_file, read_progress
from playground.workbench.lesson.reader import Reading


class Lessons:
    """One window's; ``remember`` takes in what is shown, for the next start."""

    def __init__(self, actions: Actions, rememberer: Rememberer, remember: Callable[[], None]) -> None:
        file = progress_file()
        self.reading = Reading(actions, read_progress(file), file, self._keep_own, self._play)
        self._panel = LessonPanel()
        self._rememberer = rememberer
        self._remember = remember
        actions.toggle_lessons, actions.turn_page = self.reading.toggle, self.reading.turn_page
        actions.lesson_shown = lambda: self.reading.lesson is not None and self.reading.progress.shown

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

    def turn(self, *, idle: bool) -> None:
        """Take in what a turn has brought; ``idle``: there is time to compute."""
        if self.reading.stage.own is None:  # what a lesson sets is not the reader's
            self._remember()
        self.reading.turn(idle=idle)

    def release(self) -> None:
        """Give back what was made in the session's context; it is made again where it is needed."""
        self._panel.release()

    def _keep_own(self) -> None:
        """Remember what is shown, before a lesson shows something else."""
        self._remember()
        self._rememberer.write()

    def _play(self, sketch: Path) -> None:
        self._rememberer.open(sketch)
