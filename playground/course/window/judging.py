"""Works that are judged, and pictures to match that are drawn, in a process of their own, one by one.

So a text that never ends, or values at which it does not, cost no more than that process.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from playground.course.model import Block, Challenge, Exercise
from playground.course.tasks.judge import Ends
from playground.course.tasks.judge_process import JudgeProcess
from playground.course.tasks.verdict import Picture, Verdict
from playground.course.tasks.work import Work
from playground.errors import PlaygroundError
from playground.workbench.notices import Notices

SIDE = 160
"""Pixels, the longer way, of the pictures that a score compares while one plays."""


@dataclass(kw_only=True)
class Judging:
    """What the process is asked by one reader, and what has come of it."""

    notices: Notices
    is_idle: Callable[[], bool]  # whether the picture in view rests
    received: Callable[[str, Verdict], None]  # called with a block's name and its verdict
    process: JudgeProcess = field(default_factory=JudgeProcess)
    verdicts: dict[str, Verdict] = field(default_factory=dict)  # by block
    ends: dict[str, Ends] = field(default_factory=dict)  # by challenge: what its score lies between
    judged: dict[str, Work] = field(default_factory=dict)  # by block: what its verdict is on
    at: str = ""  # the exercise whose work is judged, or is to be
    _work: tuple[Exercise, Work] | None = None  # that is still to be sent
    _wanted: list[Challenge] = field(default_factory=list)
    _sent: str = ""  # the block that the process is at
    _at_work: Work = field(default_factory=Work)  # the work that it is at, or was last

    @property
    def busy(self) -> bool:
        """Whether an answer is to come."""
        return bool(self._sent or self.at)

    def check(self, block: Exercise, work: Work) -> None:
        """Have a work judged; ``update`` receives the verdict."""
        self.at, self._work = block.name, (block, work)

    def want(self, blocks: tuple[Block, ...]) -> None:
        """Have the pictures to match of a page drawn, while the picture in view rests."""
        self._wanted = [b for b in blocks if isinstance(b, Challenge) and b.name not in self.ends]

    def target(self, block: Challenge) -> Picture | None:
        """Return the picture to match; None while it is not drawn yet."""
        ends = self.ends.get(block.name)
        return None if ends is None else ends.target

    def update(self) -> bool:
        """Receive what has come, and send what comes next; return whether anything has come."""
        came = self._receive()
        self._send()
        return came

    def forget(self) -> None:
        """Forget all, and expect nothing more of the process."""
        self.at, self._sent, self._work = "", "", None
        for table in (self.verdicts, self.judged, self.ends, self._wanted):
            table.clear()

    def close(self) -> None:
        """End the process; it starts again where it is needed."""
        self.at, self._sent, self._work = "", "", None
        self.process.close()

    def _send(self) -> None:
        if self._sent:
            return
        if self._work is not None:
            (block, work), self._work = self._work, None
            self._sent, self._at_work = block.name, work
            self.process.submit(block, work)
        elif self._wanted and self.is_idle():
            challenge = self._wanted.pop(0)
            self._sent = challenge.name
            self.process.submit(challenge, None, SIDE)

    def _receive(self) -> bool:
        name, answer = self._sent, None
        if not name:
            return False
        try:
            answer = self.process.poll()
        except PlaygroundError as error:
            self.notices.say(str(error))
        else:
            if answer is None:
                return False
        self._sent = ""
        if name == self.at and self._work is None:
            self.at = ""
        if isinstance(answer, Ends):
            self.ends[name] = answer
        elif isinstance(answer, Verdict):
            self.verdicts[name], self.judged[name] = answer, self._at_work
            self.received(name, answer)
        return True
