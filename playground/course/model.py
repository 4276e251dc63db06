"""What a lesson is made of: frozen values; its texts are Markdown, its pictures sketches."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import Field, dataclass, field, fields
from typing import Any

from playground.sketch.model import Sketch, Value

Markdown = str
"""Markdown with formulas between dollars, and ``{{name}}`` for the number of a measure."""


# What the field of a block is, besides its type: a text that a translation replaces.
_NEEDED: dict[str, Any] = {"translated": True, "needed": True}
_OPTIONAL: dict[str, Any] = {"translated": True, "needed": False}
_LISTED: dict[str, Any] = {"translated": True, "listed": True}


@dataclass(frozen=True)
class Scene:
    """A picture that can be drawn: a sketch, all of it set."""

    sketch: Sketch  # with its values and its camera
    pixels: tuple[int, int]
    time: float = 0.0  # [s]
    steps: tuple[tuple[str, int], ...] = ()  # repeated pass → iteration to stop at
    shot: str = ""  # of the sketch, that it began as
    preset: str = ""
    values: tuple[tuple[str, Value], ...] = ()  # set over those of shot and preset
    view: str = ""  # texture that is shown from above instead of the sketch's view
    plain: bool = False  # it is that shot and nothing else


@dataclass(frozen=True)
class Block:
    """A part of a lesson; ``text`` is what the English file says."""

    line: int  # in the English file, from 1
    text: str


@dataclass(frozen=True)
class Prose(Block):
    """A paragraph, a heading, a list, a table or a formula."""

    kind: str = "paragraph"  # heading | paragraph | list | table | formula | quote | code
    level: int = 0  # of a heading, from 1
    markdown: Markdown = field(default="", metadata=_NEEDED)


@dataclass(frozen=True)
class Named(Block):
    """A fenced block."""

    name: str = ""


@dataclass(frozen=True)
class Figure(Named):
    """A sketch, with parameters that may be dragged where there is somebody to drag them."""

    scene: Scene | None = None
    sliders: tuple[str, ...] = ()  # parameter paths
    caption: Markdown = field(default="", metadata=_NEEDED)
    alt: str = field(default="", metadata=_NEEDED)


@dataclass(frozen=True)
class Steps(Named):
    """A repeated kernel, iteration by iteration."""

    scenes: tuple[Scene, ...] = ()  # one for each iteration shown
    passes: tuple[str, ...] = ()  # stopped together
    iterations: tuple[int, ...] = ()
    caption: Markdown = field(default="", metadata=_NEEDED)
    alt: str = field(default="", metadata=_NEEDED)
    captions: tuple[Markdown, ...] = field(
        default=(), metadata=_LISTED
    )  # none, or one for each iteration shown


@dataclass(frozen=True)
class Slider(Named):
    """One parameter swept."""

    scenes: tuple[Scene, ...] = ()  # one a value
    parameter: str = ""  # path
    values: tuple[Value, ...] = ()
    caption: Markdown = field(default="", metadata=_NEEDED)
    alt: str = field(default="", metadata=_NEEDED)
    label: str = field(default="", metadata=_OPTIONAL)  # of the parameter; "": as the sketch names it


@dataclass(frozen=True)
class Compare(Named):
    """Two or more variants side by side."""

    scenes: tuple[Scene, ...] = ()
    labels: tuple[str, ...] = field(default=(), metadata=_LISTED)  # one for each variant
    caption: Markdown = field(default="", metadata=_NEEDED)
    alt: str = field(default="", metadata=_NEEDED)


@dataclass(frozen=True)
class Code(Named):
    """An excerpt of a shader, by an anchor in it."""

    file: str = ""  # in glsl/
    anchor: str = ""
    caption: Markdown = field(default="", metadata=_OPTIONAL)


@dataclass(frozen=True)
class Trace(Named):
    """Lines of a shader with the values of one texel beside them, a loop's by its iterations."""

    scene: Scene | None = None
    path: str = ""  # of the pass: "height.raw"
    texel: tuple[int, int] = (0, 0)  # column and row, from the south-west
    iteration: tuple[int, ...] = ()  # of the repeat, or of the loops around it, from 0; (): the last
    file: str = ""  # in glsl/
    anchor: str = ""  # in it, of the lines that are shown
    function: str = ""  # whose lines they are; "": the kernel's own
    call: int = 1  # which call of it, from 1
    loop: str = ""  # variable of the loop that is stepped through; "": none
    variables: tuple[str, ...] = ()  # columns of the loop's table
    rows: tuple[int, ...] = ()  # of the table, by the loop's variable
    digits: int = 4  # significant, of each number
    caption: Markdown = field(default="", metadata=_NEEDED)


@dataclass(frozen=True)
class Break(Named):
    """A bug put into a shader, to be found and fixed."""

    scene: Scene | None = None  # whole
    file: str = ""  # in glsl/
    find: str = ""  # a text that occurs there once
    put: str = ""  # the bug in its place
    ask: Markdown = field(default="", metadata=_NEEDED)
    hint: Markdown = field(default="", metadata=_NEEDED)
    fix: Markdown = field(default="", metadata=_NEEDED)
    alt: str = field(default="", metadata=_NEEDED)  # of the broken picture
    caption: Markdown = field(default="", metadata=_OPTIONAL)


@dataclass(frozen=True)
class Asked:
    """The value of a trace that a question asks for: its figure leaves it out."""

    trace: str  # name of the block
    variable: str
    step: int | None = None  # of the loop, by its variable; None: what is there once


@dataclass(frozen=True)
class Question(Named):
    """Something to answer before the answer is shown: by a choice, or by a number of a trace."""

    of: Asked | None = None
    points: int = 0  # of a question for a number, which is graded
    ask: Markdown = field(default="", metadata=_NEEDED)
    choices: tuple[Markdown, ...] = field(default=(), metadata=_LISTED)
    right: int = -1  # index of the right choice; -1: there are none
    answer: Markdown = field(default="", metadata=_NEEDED)


@dataclass(frozen=True)
class Check:
    """What a student's work is judged by: its picture, a texture, or the measure of one."""

    tolerance: float = 0.0  # share of pixels that may differ; or the largest difference of a texel
    at: tuple[tuple[str, Value], ...] = ()  # parameter path → value, over the exercise's own
    hidden: bool = False  # the student is not told at which values
    of: str = ""  # texture, as "pass[.inner…][:output]"; "": the picture
    measure: Measure | None = None  # of the texture; its ``between`` is what it must give


@dataclass(frozen=True)
class Task(Named):
    """What a student writes or sets: a kernel in place of a file, or parameters."""

    file: str = ""  # in glsl/, that the student's text replaces; "": parameters are set
    start: str = ""  # in exercises/: what the student begins from; "": the file as it ships
    answer: str = ""  # in exercises/: the model answer; "": the file as it ships
    sliders: tuple[str, ...] = ()  # parameter paths
    scene: Scene | None = None  # of the answer
    begin: Scene | None = None  # the same before the student has set anything
    ask: Markdown = field(default="", metadata=_NEEDED)
    hint: Markdown = field(default="", metadata=_OPTIONAL)


@dataclass(frozen=True)
class Exercise(Task):
    """Something to do, with a solution that is hidden at first; one with checks judges what is done."""

    solution: Markdown = field(default="", metadata=_NEEDED)
    alt: str = field(default="", metadata=_OPTIONAL)  # of the solution
    checks: tuple[Check, ...] = ()
    points: int = 0  # 0: there is nothing to check


@dataclass(frozen=True)
class Challenge(Task):
    """A picture to match, with a score that says how near one is."""

    solution: Markdown = field(default="", metadata=_OPTIONAL)
    alt: str = field(default="", metadata=_NEEDED)  # of the picture to match
    caption: Markdown = field(default="", metadata=_OPTIONAL)
    goal: int = 95  # score of 100 from which it is solved


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
    sentence: Markdown = field(
        default="", metadata=_OPTIONAL | {"key": "text"}
    )  # with the number; "": only prose names it


@dataclass(frozen=True)
class Section:
    """The blocks under one heading of the second level; the first has none."""

    title: Markdown
    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class Lesson:
    """One lesson in one language."""

    name: str
    language: str
    file: str  # absolute path of the English file
    number: int  # its place in the course, from 0
    title: str
    goal: Markdown
    minutes: int  # that reading it takes
    exercise_minutes: int  # that its exercises take besides
    thesis: tuple[str, ...]  # sections, as "1.3.2"
    papers: tuple[str, ...]
    sketch: str  # to play with at the end
    blocks: tuple[Block, ...]
    stale: tuple[int, ...] = ()  # indices of blocks whose English has changed since they were translated

    @property
    def sections(self) -> tuple[Section, ...]:
        """Its blocks, by headings of the second level; the first section comes before any."""
        sections: list[tuple[Markdown, list[Block]]] = [("", [])]
        for block in self.blocks:
            if isinstance(block, Prose) and block.kind == "heading" and block.level == 2:
                sections.append((block.markdown, []))
            else:
                sections[-1][1].append(block)
        return tuple(Section(title, tuple(blocks)) for title, blocks in sections)

    @property
    def named(self) -> dict[str, Named]:
        """Its fenced blocks by their names."""
        return {block.name: block for block in self.blocks if isinstance(block, Named)}

    @property
    def measures(self) -> tuple[Measure, ...]:
        """Its numbers."""
        return tuple(block for block in self.blocks if isinstance(block, Measure))

    def asked(self, trace: str) -> dict[tuple[str, int | None], str]:
        """Return the values of a trace that questions ask for, a variable and a step, with the question."""
        asked = ((question.of, question.name) for question in self.questions_of(trace))
        return {(of.variable, of.step): name for of, name in asked if of is not None}

    def questions_of(self, trace: str) -> tuple[Question, ...]:
        """Return the questions about a trace."""
        questions = (block for block in self.blocks if isinstance(block, Question))
        return tuple(each for each in questions if each.of is not None and each.of.trace == trace)

    def number_of(self, exercise: Exercise) -> int:
        """Return an exercise's number, from 1."""
        names = [block.name for block in self.blocks if isinstance(block, Exercise)]
        return names.index(exercise.name) + 1

    def texts(self) -> Iterator[Markdown]:
        """Yield all that a reader reads of it."""
        yield self.title
        yield self.goal
        for block in self.blocks:
            yield from texts_of(block)


def block_classes(base: type[Block] = Block) -> list[type[Block]]:
    """List the kinds of block that a lesson can have: the subclasses that have none themselves."""
    kinds = base.__subclasses__()
    return [base] if not kinds else [each for kind in kinds for each in block_classes(kind)]


def translated_fields(kind: type[Block]) -> list[Field[Any]]:
    """List the fields of a kind of block that are texts: all that a translation may replace."""
    return [each for each in fields(kind) if "translated" in each.metadata]


def key_of(text: Field[Any]) -> str:
    """Return the key of a text in the file."""
    return text.metadata.get("key") or text.name


def texts_of(block: Block) -> Iterator[Markdown]:
    """Yield the texts of a block."""
    for each in translated_fields(type(block)):
        value = getattr(block, each.name)
        yield from value if isinstance(value, tuple) else (value,)
