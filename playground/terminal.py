"""Print for a person at a terminal, or for a program at the other end of a pipe.

Colour only on a terminal, and not where NO_COLOR is set; bars and spinners only on
standard error. Tables are drawn on a terminal; in a pipe each row is a line, its columns
separated by tabs.

What is printed on standard error never ends a command: its reader may have closed it. How much
is printed there is the user's choice: see ``Loudness``.
"""

from __future__ import annotations

import json
import logging
import os
import shutil
import sys
import textwrap
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from enum import Enum
from typing import TYPE_CHECKING, TextIO

from playground.errors import shortened
from playground.streams import flush_or_discard

if TYPE_CHECKING:
    from rich.console import Console

_BAR = 24  # letters
_LOG = "playground"  # the parent of every module's log


class Loudness(Enum):
    """How much is printed on standard error."""

    QUIET = "errors"
    DEFAULT = "errors, warnings, notes and progress"
    VERBOSE = "all that, and what the modules log"


_loudness = Loudness.DEFAULT


def loudness() -> Loudness:
    """Return how much is printed on standard error."""
    return _loudness


def choose_loudness(chosen: Loudness) -> None:
    """Choose how much is printed on standard error, for the rest of ``with_loudness``."""
    global _loudness
    _loudness = chosen
    log = logging.getLogger(_LOG)
    if chosen is Loudness.VERBOSE and not any(isinstance(handler, _Log) for handler in log.handlers):
        log.addHandler(_Log())
        log.setLevel(logging.DEBUG)


@contextmanager
def with_loudness() -> Iterator[None]:
    """Begin with the usual loudness, and return to it in the end."""
    global _loudness
    log = logging.getLogger(_LOG)
    level, handlers = log.level, list(log.handlers)
    _loudness = Loudness.DEFAULT
    try:
        yield
    finally:
        _loudness = Loudness.DEFAULT
        log.handlers[:] = handlers
        log.setLevel(level)


class _Log(logging.Handler):
    """Prints what the modules log, each with the seconds since this was asked for."""

    def __init__(self) -> None:
        super().__init__()
        self._start = time.perf_counter()

    def emit(self, record: logging.LogRecord) -> None:
        """Print a record."""
        note(painted(f"{time.perf_counter() - self._start:7.3f} s  {record.getMessage()}", "2", sys.stderr))


def has_colour(stream: TextIO) -> bool:
    """Whether colour belongs on a stream."""
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def painted(text: str, code: str, stream: TextIO) -> str:
    """Return text in a colour, an ANSI code as "1;31", where colour belongs on the stream."""
    return f"\033[{code}m{text}\033[0m" if has_colour(stream) else text


def complain(text: str, severity: str = "error") -> None:
    """Print a mistake on standard error."""
    colour = "1;31" if severity == "error" else "1;33"
    if severity == "error" or _loudness is not Loudness.QUIET:
        say(f"{painted(f'{severity}:', colour, sys.stderr)} {shortened(text)}")


def note(text: str) -> None:
    """Print a note on standard error, unless only errors are wanted there."""
    if _loudness is not Loudness.QUIET:
        say(text)


def say(text: str) -> None:
    """Print on standard error what the user asked for."""
    try:
        print(text, file=sys.stderr)
    except OSError:  # its reader is gone
        flush_or_discard(sys.stderr)


def console_for(stream: TextIO) -> Console:
    """Return rich's console for a stream."""
    from rich.console import Console

    return Console(file=stream, highlight=False, no_color=not has_colour(stream))


def print_table(title: str, headings: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table on standard output."""
    if not sys.stdout.isatty():
        print_rows(rows)
        return
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(title=title, title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    for index, heading in enumerate(headings):
        table.add_column(heading, style="bold" if index == 0 else None, overflow="fold")
    for row in rows:
        table.add_row(*(Text(cell) for cell in row))
    console_for(sys.stdout).print(table)


def print_rows(rows: Sequence[Sequence[str]]) -> None:
    """Print one line a row on standard output, its columns separated by tabs."""
    for row in rows:
        print("\t".join(" ".join(cell.split()) for cell in row))


def print_json(value: object, indent: int | None = 2) -> None:
    """Print a value as JSON on standard output: as text where its encoding has all of it, else escaped."""
    text = json.dumps(value, indent=indent, ensure_ascii=False)
    try:
        text.encode(sys.stdout.encoding or "utf-8")
    except UnicodeEncodeError:
        text = json.dumps(value, indent=indent)
    print(text, flush=True)


def print_indented(text: str) -> None:
    """Print a paragraph on standard output, set in a little, as wide as the terminal."""
    width = max(shutil.get_terminal_size().columns, 40)
    print(textwrap.fill(text, width, initial_indent="    ", subsequent_indent="    "))


def has_bars() -> bool:
    """Whether bars and spinners belong on standard error."""
    return sys.stderr.isatty() and _loudness is not Loudness.QUIET


@contextmanager
def busy(text: str) -> Iterator[Callable[[str, int, int], None]]:
    """Show on a terminal that something is being done.

    Yields a function that adds a bar to it: of what, how many parts are done, and of how many.
    """
    if not has_bars():
        yield lambda what, done, total: None
        return
    with console_for(sys.stderr).status(f"{text} …") as status:

        def show(what: str, done: int, total: int) -> None:
            filled = _BAR * done // max(total, 1)
            status.update(f"{text} … {what} {'━' * filled}{'─' * (_BAR - filled)}")

        yield show


@contextmanager
def progress(text: str, total: int) -> Iterator[Callable[[], None]]:
    """Show a bar on a terminal; yields a function that moves it on by one."""
    if not has_bars():
        yield lambda: None
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn
    from rich.progress import TimeElapsedColumn as Elapsed
    from rich.progress import TimeRemainingColumn as Remaining

    columns = (
        TextColumn(text),
        BarColumn(),
        MofNCompleteColumn(),
        Elapsed(),
        TextColumn("left:"),
        Remaining(),
    )
    console = console_for(sys.stderr)
    # What is printed meanwhile goes above the bar, but only where both go to the terminal.
    with Progress(*columns, console=console, transient=True, redirect_stdout=sys.stdout.isatty()) as bar:
        task = bar.add_task(text, total=total)
        yield lambda: bar.advance(task)
