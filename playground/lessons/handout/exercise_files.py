"""Name the files of exercises in a hand-out, by which a submission is found again."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from playground.lessons.model import Exercise, Lesson
from playground.lessons.tasks.tasks import tasks_of


@dataclass(frozen=True)
class Assignment:
    """One exercise that checks itself, of one lesson."""

    lesson: Lesson
    exercise: Exercise

    @property
    def name(self) -> str:
        """What it goes by in a hand-out and a table: no other exercise has the same."""
        return f"{self.lesson.name}-{self.exercise.name}"

    @property
    def file(self) -> str:
        """The file that the student edits: a kernel, or the sketch whose values are set."""
        return f"{self.name}.glsl" if self.exercise.file else f"{self.name}.toml"

    @property
    def sketch_file(self) -> str:
        """The sketch that shows the exercise; a kernel next to it may not have its name."""
        return "sketch.toml" if self.exercise.file else self.file

    @property
    def opens(self) -> str:
        """What opens the exercise in the window, from the hand-out's folder."""
        return self.name if self.exercise.file else f"{self.name}/{self.file}"

    @property
    def number(self) -> int:
        """The exercise's number in its lesson, from 1."""
        return self.lesson.number_of(self.exercise)


def assignments_of(lessons: Iterable[Lesson]) -> list[Assignment]:
    """List the exercises of lessons that check themselves, in the order of the lessons."""
    return [
        Assignment(lesson, task)
        for lesson in lessons
        for task in tasks_of(lesson)
        if isinstance(task, Exercise)
    ]
