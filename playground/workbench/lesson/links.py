"""Where links and buttons lead from a page: another lesson, a sketch of one's own, the web."""

from __future__ import annotations

import webbrowser
from collections.abc import Callable
from pathlib import Path

from playground.errors import PlaygroundError
from playground.sketch.find import find
from playground.workbench.history import History
from playground.workbench.lesson.labels import words_in
from playground.workbench.lesson.reader import Reading


def follow(reading: Reading, address: str) -> None:
    """Go where a link leads."""
    kind, _, name = address.partition(":")
    if kind == "lesson":
        reading.open(name)
    elif kind == "sketch":
        open_sketch(reading, name)
    elif kind == "thesis":
        reading.actions.say(words_in(reading.language)["thesis_section"].format(name))
    elif kind in ("https", "http") and not webbrowser.open(address):
        reading.actions.say(address)


def play_on(reading: Reading) -> None:
    """Open the lesson's sketch as the reader's own."""
    if reading.lesson is not None:
        open_sketch(reading, reading.lesson.sketch)


def open_sketch(reading: Reading, name: str) -> None:
    """Open a sketch as the reader's own, with what was set by hand in it the last time."""
    actions, stage = reading.actions, reading.stage
    try:
        path = find(name)
    except PlaygroundError as error:
        actions.say(str(error))
        return
    reading.playing = ""
    reading.faults.put_away(drawn=False)
    if stage.own is None:
        reading.begins()
    stage.let_go()
    actions.panel_shown = True
    opens: Callable[[Path], None] = reading.play or actions.open
    opens(path)
    actions.history = History()
