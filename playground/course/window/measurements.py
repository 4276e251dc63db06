"""The numbers of a lesson, computed on the session's own engine while nothing else is to be done."""

from __future__ import annotations

from dataclasses import dataclass, field

from playground.course.measuring import Number, filled, measured, named_in
from playground.course.model import Block, Lesson, Markdown, Measure, texts_of
from playground.errors import PlaygroundError
from playground.workbench.inspect.compare import as_before
from playground.workbench.session import Session

Known = dict[str, Number]


@dataclass
class Numbers:
    """The results of the measures of the lessons read so far."""

    session: Session
    results: dict[str, Known] = field(default_factory=dict)  # by lesson and measure
    failed: dict[tuple[str, str], str] = field(default_factory=dict)  # why there is no number
    pending: list[tuple[str, Measure]] = field(default_factory=list)

    def want(self, lesson: Lesson, blocks: tuple[Block, ...]) -> None:
        """Request all numbers that blocks of a lesson show."""
        names = {name for block in blocks for text in texts_of(block) for name in named_in(text)}
        names |= {block.name for block in blocks if isinstance(block, Measure)}
        numbers = self.results.setdefault(lesson.name, {})
        self.pending = [
            (lesson.name, measure)
            for measure in lesson.measures
            if measure.name in names
            and measure.name not in numbers
            and (lesson.name, measure.name) not in self.failed
        ]

    def waits(self, lesson: Lesson, name: str) -> bool:
        """Return whether a number is still to be computed."""
        return any((lesson.name, name) == (other, measure.name) for other, measure in self.pending)

    @property
    def ready(self) -> bool:
        """Whether a number is wanted, and the picture rests."""
        return bool(self.pending) and self.session.is_idle

    def compute(self) -> bool:
        """Compute the next number that is wanted, where the picture rests; return whether one was."""
        session = self.session
        if not self.ready or session.plan is None:
            return False
        lesson, measure = self.pending.pop(0)
        try:
            with as_before(session.engine, session.plan):
                self.results[lesson][measure.name] = measured(session.engine, measure)
        except PlaygroundError as error:
            self.failed[lesson, measure.name] = error.diagnostics[0].message
        return True

    def fill(self, text: Markdown, lesson: Lesson) -> Markdown:
        """Return a text with today's numbers; "…" for one that is not computed yet."""
        return filled(text, self.results.get(lesson.name, {}), comma=lesson.language == "fr")
