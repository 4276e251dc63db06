"""Keep the window alive: a part of a frame that fails becomes a notice, and the rest goes on.

imgui's own checks raise an exception as well, in the middle of drawing. What was begun
and not ended by then (windows, ids, colours, fonts) is ended here, so that the next part finds imgui
as the one before had left it.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from imgui_bundle import imgui

Result = TypeVar("Result")

log = logging.getLogger("playground.studio")


class Guard:
    """Runs the parts of each frame; ``say`` puts a message on the screen."""

    def __init__(self, say: Callable[[str], None]) -> None:
        self._say = say
        self._reported: set[str] = set()  # what the terminal has reported already

    def draw(self, part: str, draw: Callable[[], Result], otherwise: Result) -> Result:
        """Draw a part of the interface, and leave imgui as it was; return ``otherwise`` where that fails."""
        before = imgui.internal.ErrorRecoveryState()
        imgui.internal.error_recovery_store_state(before)
        try:
            return draw()
        except Exception as error:
            self._report(part, error)
            return otherwise
        finally:
            with _without_complaint():
                imgui.internal.error_recovery_try_to_recover_state(before)

    def run(self, part: str, act: Callable[[], Result], otherwise: Result) -> Result:
        """Run a part that draws nothing; return ``otherwise`` where it fails."""
        try:
            return act()
        except Exception as error:
            self._report(part, error)
            return otherwise

    def _report(self, part: str, error: Exception) -> None:
        """Show a failure on the screen, and log it once, with its traceback."""
        message = f"{part} failed and is left out, by a bug of the playground: {_brief(error)}"
        self._say(message)
        if message not in self._reported:
            self._reported.add(message)
            log.error(message, exc_info=error)


@contextmanager
def _without_complaint() -> Iterator[None]:
    """Let imgui end what is open without raising, printing or showing anything."""
    io = imgui.get_io()
    names = [f"config_error_recovery_enable_{way}" for way in ("assert", "debug_log", "tooltip")]
    before = {name: getattr(io, name) for name in names}
    for name in names:
        setattr(io, name, False)
    try:
        yield
    finally:
        for name, value in before.items():
            setattr(io, name, value)


def _brief(error: Exception) -> str:
    text = " ".join(str(error).split())
    return f"{type(error).__name__}: {text[:200]}" if text else type(error).__name__
