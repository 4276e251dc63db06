"""Where links and buttons lead from a page: another lesson, a sketch of one's own, the web."""

from __future__ import annotations

import webbrowser
from collections.abc import Callable
from pathlib import Path

from playground.course.glossary import linked_term
from playground.course.window.labels import labels_in
from playground.course.window.reader import Reader
from playground.errors import PlaygroundError
from playground.sketch.find import find
from playground.workbench.history import History


def follow(reader: Reader, address: str) -> None:
    """Open what a link names."""
    kind, _, name = address.partition(":")
    if kind == "lesson":
        reader.open(name)
    elif kind == "sketch":
        open_sketch(reader, name)
    elif kind == "thesis":
        reader.bench.notices.say(labels_in(reader.language)["thesis_section"].format(name))
    elif kind == "term":
        reader.bench.notices.say(link_text(reader, address))
    elif kind in ("https", "http") and not webbrowser.open(address):
        reader.bench.notices.say(address)


def link_text(reader: Reader, address: str) -> str:
    """Return what is shown of a link under the mouse: of a term its definition, else its address."""
    term = linked_term(address)
    language = reader.lesson.language if reader.lesson else reader.language
    return term.definition(language) if term else address


def play_on(reader: Reader) -> None:
    """Open the lesson's sketch as the reader's own."""
    if reader.lesson is not None:
        open_sketch(reader, reader.lesson.sketch)


def open_sketch(reader: Reader, name: str) -> None:
    """Open a sketch as the reader's own, with the user's edits of the last time."""
    bench, figure = reader.bench, reader.figure
    try:
        path = find(name)
    except PlaygroundError as error:
        bench.notices.say(str(error))
        return
    reader.playing = ""
    reader.bugs.close_all(drawn=False)
    figure.forget_figure()
    bench.interface.panel_shown = True
    opens: Callable[[Path], object] = reader.play or bench.commands.open
    opens(path)
    if bench.session.drafts.opening:  # else it is open already
        bench.undo.begin(History())
