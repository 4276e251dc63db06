"""The terminal reports each error once, while it lasts."""

from __future__ import annotations

from playground.errors import Diagnostic
from playground.studio.problems.problems import TerminalErrors

ONE, OTHER = Diagnostic("no name 'p'", "terrain.glsl", 3), Diagnostic("a ; is missing", "wave.glsl", 7)


def test_each_error_is_reported_once_and_again_after_fix() -> None:
    printed: list[str] = []
    terminal = TerminalErrors(printed.append)
    for listed in ([ONE], [ONE], [ONE, OTHER], [OTHER], [], [ONE], [ONE]):
        terminal.take(listed)
    assert printed == [str(ONE), str(OTHER), str(ONE)]


def test_a_terminal_that_is_gone_stops_nothing() -> None:
    def gone(_: str) -> None:
        raise BrokenPipeError

    TerminalErrors(gone).take([ONE])
