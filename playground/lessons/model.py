"""What a lesson is made of: frozen values; words as Markdown, pictures as sketches."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from playground.sketch.model import Sketch, Value

Words = str
"""Markdown with formulas between dollars, and ``{{name}}`` for the number of a measure."""


@dataclass(frozen=True)
class Scene:
    """A picture that can be drawn: a sketch, all of it set."""

    sketch: Sketch  # with its values and its camera
    pixels: tuple[int, int]
    time: float = 0.0  # [s]
    steps: tuple[tuple[str, int], ...] = ()  # repeated pass → turn to stop at
    shot: str = ""  # of the sketch, that it began as
    preset: str = ""
    values: tuple[tuple[str, Value], ...] = ()  # set over those of shot and preset
    view: str = ""  # texture that is shown from above in place of the sketch's view
    plain: bool = False  # it is that shot and nothing else


@dataclass(frozen=True)
class Block:
    """A part of a lesson; ``text`` is what the file says, as long as it is not translated."""

    line: int  # in the English file, from 1
    text: str


@dataclass(frozen=True)
class Prose(Block):
    """A paragraph, a heading, a list, a table or a formula."""

    kind: str = "paragraph"  # heading | paragraph | list | table | formula | quote | code
    level: int = 0  # of a heading, from 1
    words: Words = ""


@dataclass(frozen=True)
class Named(Block):
    """A fenced block."""

    name: str = ""


@dataclass(frozen=True)
class Figure(Named):
    """A sketch, with parameters that may be dragged where there is somebody to drag them."""

    scene: Scene | None = None
    sliders: tuple[str, ...] = ()  # parameter paths
    caption: Words = ""
    alt: str = ""


@dataclass(frozen=True)
class Steps(Named):
    """A repeated kernel, turn by turn."""

    scenes: tuple[Scene, ...] = ()  # one a turn shown
    passes: tuple[str, ...] = ()  # stopped together
    turns: tuple[int, ...] = ()
    caption: Words = ""
    alt: str = ""
    captions: tuple[Words, ...] = ()  # none, or one a turn shown


@dataclass(frozen=True)
class Slider(Named):
    """One parameter swept."""

    scenes: tuple[Scene, ...] = ()  # one a value
    parameter: str = ""  # path
    values: tuple[Value, ...] = ()
    caption: Words = ""
    alt: str = ""
    label: str = ""  # of the parameter; "": as the sketch names it


@dataclass(frozen=True)
class Compare(Named):
    """Two or more variants side by side."""

    scenes: tuple[Scene, ...] = ()
    labels: tuple[str, ...] = ()  # one a variant
    caption: Words = ""
    alt: str = ""


@dataclass(frozen=True)
class Code(Named):
    """An excerpt of a shader, by an anchor in it."""

    file: str = ""  # in glsl/
    anchor: str = ""
    caption: Words = ""


@dataclass(frozen=True)
class Break(Named):
    """A fault put into a shader, to be found and mended."""

    scene: Scene | None = None  # whole
    file: str = ""  # in glsl/
    find: str = ""  # what stands there once
    put: str = ""  # the fault in its place
    ask: Words = ""
    hint: Words = ""
    mend: Words = ""
    alt: str = ""  # of the broken picture
    caption: Words = ""


@dataclass(frozen=True)
class Question(Named):
    """Something to answer before the answer is shown."""

    ask: Words = ""
    choices: tuple[Words, ...] = ()
    right: int = -1  # index of the right choice; -1: there are none
    answer: Words = ""


@dataclass(frozen=True)
class Exercise(Named):
    """Something to do, with a solution that is hidden at first."""

    ask: Words = ""
    hint: Words = ""
    solution: Words = ""
    scene: Scene | None = None  # of the solution
    alt: str = ""


@dataclass(frozen=True)
class Measure(Named):
    """A number computed from a sketch when the lesson is shown."""

    scene: Scene | None = None
    over: Scene | None = None  # the number is divided by what the same gives there
    of: str = "height"  # texture, as "pass[.inner…][:output]"
    what: str = ""  # a function of ``measures``
    arguments: tuple[tuple[str, float], ...] = ()
    digits: int = 3  # significant
    unit: str = ""
    between: tuple[float, float] | None = None  # what the lesson claims of it
    words: Words = ""  # a sentence with the number in it; "": only prose elsewhere names it


@dataclass(frozen=True)
class Section:
    """What stands under one heading of the second level; the first has none."""

    title: Words
    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class Lesson:
    """One lesson in one language."""

    name: str
    language: str
    file: str  # absolute path of the English file
    number: int
    title: str
    goal: Words
    minutes: int
    thesis: tuple[str, ...]  # sections, as "1.3.2"
    papers: tuple[str, ...]
    sketch: str  # to play with at the end
    blocks: tuple[Block, ...]
    stale: tuple[int, ...] = ()  # indices of blocks whose English has changed since they were translated

    @property
    def sections(self) -> tuple[Section, ...]:
        """Its blocks, by headings of the second level; the first section comes before any."""
        found: list[tuple[Words, list[Block]]] = [("", [])]
        for block in self.blocks:
            if isinstance(block, Prose) and block.kind == "heading" and block.level == 2:
                found.append((block.words, []))
            else:
                found[-1][1].append(block)
        return tuple(Section(title, tuple(blocks)) for title, blocks in found)

    @property
    def named(self) -> dict[str, Named]:
        """Its fenced blocks by their names."""
        return {block.name: block for block in self.blocks if isinstance(block, Named)}

    @property
    def measures(self) -> tuple[Measure, ...]:
        """Its numbers."""
        return tuple(block for block in self.blocks if isinstance(block, Measure))

    def words(self) -> Iterator[Words]:
        """Yield all that a reader reads of it."""
        yield self.title
        yield self.goal
        for block in self.blocks:
            yield from words_of(block)


WORDS: dict[type[Block], tuple[str, ...]] = {
    Figure: ("caption", "alt"),
    Steps: ("caption", "alt", "captions"),
    Slider: ("caption", "alt", "label"),
    Compare: ("caption", "alt", "labels"),
    Code: ("caption",),
    Break: ("ask", "hint", "mend", "alt", "caption"),
    Question: ("ask", "choices", "answer"),
    Exercise: ("ask", "hint", "solution", "alt"),
    Measure: ("words",),
    Prose: ("words",),
}
"""The fields of a block that are words: all that a translation may say."""


def words_of(block: Block) -> Iterator[Words]:
    """Yield the words of a block, as they stand in its fields."""
    for field in WORDS[type(block)]:
        value = getattr(block, field)
        yield from value if isinstance(value, tuple) else (value,)
