"""What is on the screen between one press of Next and the following one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from playground.course.model import Compare, Exercise, Lesson, Markdown, Scene, Slider, Steps
from playground.course.tasks.work import scene_of as begun
from playground.course.tasks.work import starter

BOTH = -1
"""The index of a comparison's picture where both are shown, with a line between them."""


@dataclass(frozen=True)
class Still:
    """Which picture of a lesson is shown."""

    block: str  # its name
    index: int = 0  # of a series or a comparison: which; ``BOTH``
    broken: bool = False  # with the bug of a break in it
    started: bool = False  # of an exercise: what a student begins from


@dataclass(frozen=True)
class Listing:
    """Code, and where it is from."""

    text: str
    file: str = ""  # in glsl/
    line: int = 0  # of the first line there; 0: lines have no numbers


@dataclass(frozen=True)
class Beat:
    """What is on the screen between two presses of Next."""

    kind: str  # title | text | board | figure | step | sweep | compare | code | question | choices
    #            | answer | broken | hint | fix | exercise | solution | challenge
    page: int  # of the lesson, from 0
    heading: Markdown  # of that page
    label: str = ""  # what it is, in the lesson's language: "Hint", "Step 2 of 5"
    shown: Markdown = ""  # in the strip
    board: Markdown = ""  # over the picture
    formula: Markdown = ""  # over the picture's lower part
    code: Listing | None = None  # over the picture
    choices: tuple[Markdown, ...] = ()  # over the picture, below the board's text
    right: int = -1  # of the choices, where the answer is shown
    names: tuple[str, ...] = ()  # of the pictures of a comparison that is shown: one, or two
    notes: Markdown = ""  # all that is told: the block's text, whole
    aside: Markdown = ""  # for the teacher alone: what comes later, answers, solutions
    still: Still | None = None
    sliders: tuple[str, ...] = ()  # paths of the parameters that the picture offers

    @property
    def has_board(self) -> bool:
        """Whether something stands over the picture."""
        return bool(self.board or self.code is not None or self.choices)


def texts_of_beat(beat: Beat) -> tuple[Markdown, ...]:
    """Return all texts of a beat that a class reads or hears."""
    return beat.shown, beat.board, beat.notes, *beat.choices


def with_texts(beat: Beat, fill: Callable[[Markdown], Markdown]) -> Beat:
    """Return a beat with each of its texts as a function returns it, as with numbers in their places."""
    return replace(
        beat,
        shown=fill(beat.shown),
        board=fill(beat.board),
        notes=fill(beat.notes),
        choices=tuple(map(fill, beat.choices)),
    )


def scene_of(lesson: Lesson, still: Still) -> Scene | None:
    """Return the picture of a still; of a comparison of two the second, of a bug the whole one."""
    block = lesson.named.get(still.block)
    if still.started and isinstance(block, Exercise):
        return begun(block, starter(block))
    if isinstance(block, Steps | Slider | Compare):
        return block.scenes[still.index]
    return getattr(block, "scene", None)
