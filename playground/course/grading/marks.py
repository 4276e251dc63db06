"""What came of one submission: for each exercise points, sentences and pictures."""

from __future__ import annotations

from dataclasses import dataclass

GRADED, MISSING, REFUSED, STOPPED = "graded", "missing", "refused", "stopped"
"""What may have come of an exercise: judged; not handed in; not read; ended with its process."""


@dataclass(frozen=True)
class Pair:
    """What was handed in and what was wanted, side by side."""

    mine: bytes  # WebP
    expected: bytes  # WebP


@dataclass(frozen=True)
class Mark:
    """What came of one exercise or challenge of one student; a challenge has a score and no points."""

    points: float
    of: int
    outcome: str  # GRADED, MISSING, REFUSED or STOPPED
    sentences: tuple[str, ...] = ()
    pairs: tuple[Pair, ...] = ()
    note: str = ""  # for information: it changes no points
    same_as: tuple[str, ...] = ()  # students who handed in the same text
    score: float | None = None  # of a challenge: 0..100
    goal: int = 0  # score from which a challenge is solved

    @property
    def is_full(self) -> bool:
        """Whether it has all points, or solves its challenge."""
        return self.points == self.of and (self.score is None or self.score >= self.goal)

    @property
    def spelled(self) -> str:
        """What stands in a table: points, or the score in whole steps, as the window shows it."""
        return spelled_points(self.points) if self.score is None else str(int(self.score))


@dataclass(frozen=True)
class Graded:
    """One student's marks."""

    student: str
    marks: dict[str, Mark]  # by the exercise's name, in their order

    @property
    def points(self) -> float:
        """The total."""
        return round(sum(mark.points for mark in self.marks.values()), 2)

    @property
    def of(self) -> int:
        """The points that there are."""
        return sum(mark.of for mark in self.marks.values())


def spelled_points(points: float) -> str:
    """Return points without needless digits: "2", "1.5"."""
    return f"{points:.2f}".rstrip("0").rstrip(".")
