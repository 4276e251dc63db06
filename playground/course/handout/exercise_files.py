"""Name the files of exercises and challenges in a hand-out, by which a submission is found again."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

from playground.course.language import labels
from playground.course.model import Challenge, Exercise, Lesson
from playground.course.tasks.work import answer_text, starter_text, tasks_of

_COMMENT = re.compile(r"//(?:\\\n|[^\n])*|/\*.*?(?:\*/|\Z)", re.DOTALL)
_TOKEN = re.compile(r"\w+|[^\w\s]")


def normalised(text: str) -> str:
    """Return a text as its tokens, without comments and without how it is laid out."""
    return " ".join(_TOKEN.findall(_COMMENT.sub(" ", text)))


@dataclass(frozen=True)
class Assignment:
    """One exercise that checks itself, or one picture to match, of one lesson."""

    lesson: Lesson
    task: Exercise | Challenge
    starter: str = ""  # what is handed out in the student's file; "" where values are set
    follows: Exercise | None = None  # the student goes on from what was written there

    @property
    def name(self) -> str:
        """What it goes by in a hand-out and a table: no other exercise has the same."""
        return f"{self.lesson.name}-{self.task.name}"

    @property
    def file(self) -> str:
        """The file that the student edits: a kernel, or the sketch whose values are set."""
        return f"{self.name}.glsl" if self.task.file else f"{self.name}.toml"

    @property
    def sketch_file(self) -> str:
        """The sketch that shows the exercise; a kernel next to it may not have its name."""
        return "sketch.toml" if self.task.file else self.file

    @property
    def opens(self) -> str:
        """What opens the exercise in the window, from the hand-out's folder."""
        return self.name if self.task.file else f"{self.name}/{self.file}"

    @property
    def points(self) -> int:
        """How many points it has: a picture to match has a score instead."""
        return self.task.points if isinstance(self.task, Exercise) else 0

    @property
    def title(self) -> str:
        """The lesson, and the exercise's number in it, or that a picture is to be matched."""
        if isinstance(self.task, Challenge):
            challenge = labels("handout", self.lesson.language)["challenge"]
            return f"{self.lesson.title}, {challenge.lower()}"
        return f"{self.lesson.title}, {self.lesson.number_of(self.task)}"


def assignments_of(lessons: Iterable[Lesson]) -> list[Assignment]:
    """List the exercises of lessons that check themselves and the challenges, in the order of the lessons.

    Where an exercise begins with the answer of an earlier one, it is handed out with what that one begins
    with: the student goes on from a kernel of their own, and no answer is given away.
    """
    assignments: list[Assignment] = []
    for lesson in lessons:
        of_lesson: list[Assignment] = []
        for task in tasks_of(lesson):
            of_lesson.append(_assignment(lesson, task, of_lesson))
        assignments += of_lesson
    return assignments


def _assignment(lesson: Lesson, task: Exercise | Challenge, earlier: Iterable[Assignment]) -> Assignment:
    starter = starter_text(task)
    for before in earlier:
        if task.file and task.file == before.task.file and isinstance(before.task, Exercise):
            if normalised(starter) == normalised(answer_text(before.task)):
                return Assignment(lesson, task, before.starter, before.task)
    return Assignment(lesson, task, starter)
