"""The tasks of a lesson that check themselves."""

from __future__ import annotations

from playground.lessons.model import Challenge, Exercise, Lesson


def tasks_of(lesson: Lesson) -> list[Exercise | Challenge]:
    """List a lesson's exercises that have checks, and its challenges, in its order."""
    return [
        block
        for block in lesson.blocks
        if isinstance(block, Challenge) or (isinstance(block, Exercise) and block.checks)
    ]
