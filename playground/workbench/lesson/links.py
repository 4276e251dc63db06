"""Where links and buttons lead from a page: another lesson, a sketch of one's own, the web."""

from __future__ import annotations

import webbrowser
from collections.abc import Callable
from pathlib import Path

from playground.errors import PlaygroundError
from playground.sketch.find import find
from playground.workbench.history import History
from playground.workbench.lesson.labels import labels_in
from playground.workbench.lesson.reader import Reading


def follow(reading: Reading, address: str) -> None:
    """Go where a link leads."""
    kind, _, name = address.partition(":")
    if kind == "lesson":
        reading.open(name)
    elif kind == "sketch":
        open_sketch(reading, name)
    elif kind == "thesis":
        reading.bench.notices.say(labels_in(reading.language)["thesis_section"].format(name))
    elif kind in ("https", "http") and not webbrowser.open(address):
        reading.bench.notices.say(address)


def play_on(reading: Reading) -> None:
    """Open the lesson's sketch as the reader's own."""
    if reading.lesson is not None:
        open_sketch(reading, reading.lesson.sketch)


def open_sketch(reading: Reading, name: str) -> None:
    """Open a sketch as the reader's own, with the user's edits of the last time."""
    bench, figure = reading.bench, reading.figure
    try:
        path = find(name)
    except PlaygroundError as error:
        bench.notices.say(str(error))
        return
    reading.playing = ""
    reading.bugs.close_all(drawn=False)
    figure.let_go()
    bench.interface.panel_shown = True
    opens: Callable[[Path], None] = reading.play or bench.commands.open
    opens(path)
    bench.undo.begin(History())
