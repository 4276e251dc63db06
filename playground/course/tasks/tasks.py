"""The tasks of a lesson that check themselves."""

from __future__ import annotations

from typing import TypeGuard

from playground.course.model import Block, Challenge, Exercise, Lesson


def checks_itself(block: Block) -> TypeGuard[Exercise | Challenge]:
    """Return whether a block is an exercise that has checks, or a challenge."""
    return isinstance(block, Challenge) or (isinstance(block, Exercise) and bool(block.checks))


def tasks_of(lesson: Lesson) -> list[Exercise | Challenge]:
    """List a lesson's exercises that have checks, and its challenges, in its order."""
    return [block for block in lesson.blocks if checks_itself(block)]
