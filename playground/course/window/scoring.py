"""How near the picture in view is to the one that a challenge asks for, while a student changes it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

from playground.course.model import Challenge
from playground.course.tasks.judge import Ends, Match, match
from playground.course.tasks.work import Work
from playground.course.window.judging import SIDE
from playground.errors import PlaygroundError
from playground.workbench.inspect.compare import as_before
from playground.workbench.notices import Notices
from playground.workbench.reload_stages import ReloadStage
from playground.workbench.session import Session

_PAUSE = 0.3  # [s] between two scores at least
_SHARE = 10.0  # times what a score takes that it waits for the next


@dataclass(kw_only=True)
class Scoring:
    """The scores of one reader; ``matches`` has the last one of each challenge."""

    session: Session
    notices: Notices
    scored: Callable[[Challenge, Match], None]  # called with each score
    matches: dict[str, Match] = field(default_factory=dict)  # by block

    def __post_init__(self) -> None:
        self._of: tuple[str, Work] | None = None  # what was scored last
        self._stale = False  # the picture in view is another than that
        self._due = 0.0  # when the next score may be computed

    def update(self, block: Challenge, drawn: Work, ends: Ends, now: float) -> bool:
        """Score the picture in view where it rests and is another than before; return whether that was done.

        ``drawn`` is what the picture is made of: what the sandbox has tried.
        """
        session = self.session
        coming = session.drafts.stage is not ReloadStage.NONE or session.error is not None
        self._stale = not coming and (block.name, drawn) != self._of
        if not self._stale or now < self._due or session.plan is None:
            return False
        self._of, started = (block.name, drawn), self.notices.now()
        try:
            with as_before(session.engine, session.plan):
                result = match(session.engine, block, drawn, ends, SIDE)
        except PlaygroundError as error:
            self.notices.say(str(error))
            return True
        took = self.notices.now() - started
        self._due = started + took + max(_PAUSE, _SHARE * took)
        self.matches[block.name] = result
        self.scored(block, result)
        return True

    def rest(self) -> None:
        """Wait for nothing: no challenge is in view that can be scored."""
        self._stale = False

    def patience(self, now: float) -> float:
        """Return how long nothing needs to be scored [s]."""
        return max(self._due - now, 0.0) if self._stale else math.inf

    def forget(self, name: str = "") -> None:
        """Forget the score of a block, or of all: it was of a work that is no more."""
        self._of = None
        for block_name in [name] if name else list(self.matches):
            self.matches.pop(block_name, None)
