"""A lesson as beats: what is on the screen between one press of Next and the following one.

A paragraph is one beat, and shows its first sentences; all of it is in the notes. A series is a beat a
step, a question three, a bug three; an exercise in the middle of the text two, since it goes on from the
solution, and one at the end one. Until a page's first picture is reached, that picture is already shown,
unless it answers something; where a page has none, the one before stays. The picture of an exercise or a
challenge is shown with it alone.
"""

from __future__ import annotations

import math
import re
import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from playground.course.library import labels
from playground.course.model import (
    Block,
    Break,
    Challenge,
    Code,
    Compare,
    Exercise,
    Figure,
    Lesson,
    Markdown,
    Measure,
    Prose,
    Question,
    Scene,
    Slider,
    Steps,
    Trace,
)
from playground.course.scenes import BOTH, comparable, excerpt
from playground.course.tasks import scene_of as begun
from playground.course.tasks import starter


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


MAX_WORDS = 40
"""Words that are shown large at a time; only a single longer sentence is more."""

_UNCUT = re.compile(r"`[^`]*`|\$[^$]*\$|\[[^\]]*\]\([^)]*\)|\{\{[^}]*\}\}|«[^»]*»")  # never cut inside
_END = re.compile(r"[.!?…][\"”’)*_]*(?:\s+)(?=[A-ZÀ-Þ0-9«`$*\[({“\x00])")
_SHORT = re.compile(r"(?:\b(?:e\.g|i\.e|cf|p|pp|fig|vol|M|Mr|Dr|et al|env)|\b[A-Z])\.$")
_WORD = re.compile(r"[^\W_]+(?:['’.,\-][^\W_]+)*")
_BLANKS = re.compile(r"[ \t\n]+")  # a no-break space stays
_NUMBER = re.compile(r"\{\{[^}]*\}\}")  # one, whatever its name
_LINK = re.compile(r"\]\([^)]*\)")


def sentences(text: Markdown) -> list[Markdown]:
    """Return the sentences of one paragraph; code, formulas, links and quotations stay whole."""
    stored: list[str] = []

    def store(match: re.Match[str]) -> str:
        stored.append(match[0])
        return f"\0{len(stored) - 1}\1"

    flat = _BLANKS.sub(" ", _UNCUT.sub(store, text)).strip()
    parts, start = [], 0
    for end in _END.finditer(flat):
        part = flat[start : end.end()].strip()
        if _SHORT.search(part) or part.count("**") % 2:
            continue
        parts.append(part)
        start = end.end()
    parts.append(flat[start:].strip())
    return [re.sub("\0(\\d+)\1", lambda m: stored[int(m[1])], part) for part in parts if part]


def words(text: Markdown) -> int:
    """Count what is read of a text: its words, its numbers, the names in its formulas."""
    return len(_WORD.findall(_LINK.sub("]", _NUMBER.sub("0", text))))


def shown_of(text: Markdown, most: int = MAX_WORDS) -> Markdown:
    """Return the first sentences of a paragraph, of at most so many words; the first one always."""
    parts: list[Markdown] = []
    for sentence in sentences(text):
        if parts and words(" ".join([*parts, sentence])) > most:
            break
        parts.append(sentence)
    return " ".join(parts)


WORDS_A_MINUTE = 200
MIN_SECONDS = 3.0
"""[s] that a beat is on at least."""
LETTERS, LINES = 60, 2
"""Of a subtitle: letters a line, and lines."""

_CODE_LINE = 1.0  # [s] more for a line of code
_LATEX = {
    r"\cdot": "·", r"\times": "×", r"\Delta": "Δ", r"\alpha": "α", r"\beta": "β", r"\pi": "π",
    r"\theta": "θ", r"\lambda": "λ", r"\sum": "∑", r"\infty": "∞", r"\le": "≤", r"\ge": "≥",
    r"\approx": "≈", r"\sqrt": "√", r"\to": "→", r"\omega": "ω", r"\sigma": "σ", r"\tau": "τ",
}  # fmt: skip
_FRACTION = re.compile(r"\\t?frac\s*\{([^{}]*)\}\s*\{([^{}]*)\}")


@dataclass(frozen=True)
class Cue:
    """A subtitle: when it begins and ends [s], and what it says."""

    begin: float
    end: float
    text: str


def read_of(beat: Beat) -> Markdown:
    """Return what is read of a beat: its notes, else what is shown, and the choices."""
    return "\n".join([beat.notes or beat.shown, *([] if beat.right >= 0 else beat.choices)])


def seconds_of(beat: Beat) -> float:
    """Return how long a beat is on [s], by what there is to read."""
    lines = beat.code.text.count("\n") + 1 if beat.code is not None else 0
    return max(words(read_of(beat)) * 60 / WORDS_A_MINUTE + lines * _CODE_LINE, MIN_SECONDS)


def cues_of(beat: Beat, begin: float, seconds: float) -> list[Cue]:
    """Return the subtitles of a beat that is on from ``begin`` for some seconds."""
    texts = [part for sentence in _spoken(beat) for part in _parts(sentence)]
    shares = [max(len(text), 12) for text in texts]
    cues, at = [], begin
    for text, share in zip(texts, shares, strict=True):
        end = at + seconds * share / sum(shares)
        cues.append(Cue(at, end, text))
        at = end
    return cues


def srt(cues: Iterable[Cue]) -> str:
    """Return subtitles as SubRip."""
    rows = (
        f"{number}\n{_time(cue.begin)} --> {_time(cue.end)}\n{cue.text}\n"
        for number, cue in enumerate(cues, 1)
    )
    return "\n".join(rows)


def _spoken(beat: Beat) -> Sequence[str]:
    text = beat.notes
    if text.lstrip().startswith("|"):
        return []  # a table is read on the picture
    paragraphs = [part for part in re.split(r"\n\s*\n|\n(?=\s*[-*] )", text) if part.strip()]
    from playground.course.document import plain

    return [plain(sentence, plain_formula) for part in paragraphs for sentence in sentences(part)]


def _parts(text: str) -> list[str]:
    """Return a sentence in parts of so many lines, as even as words allow."""
    lines = textwrap.wrap(text, LETTERS)
    count = math.ceil(len(lines) / LINES)
    if count < 2:
        return ["\n".join(lines)] if lines else []
    each = math.ceil(len(text) / count) + 8
    return [
        "\n".join(textwrap.wrap(part, LETTERS)) for part in textwrap.wrap(text, min(each, LETTERS * LINES))
    ]


def _time(seconds: float) -> str:
    whole = round(seconds * 1000)
    hours, minutes, left = whole // 3_600_000, whole // 60_000 % 60, whole % 60_000
    return f"{hours:02}:{minutes:02}:{left // 1000:02},{left % 1000:03}"


def plain_formula(latex: str) -> str:
    """Return a formula as nearly as letters say it."""
    plain_latex = latex
    while plain_latex != (plain_latex := _FRACTION.sub(r"\1/\2", plain_latex)):
        pass
    plain_latex = re.sub(r"\\(?:text|mathrm|operatorname|mathbf|vec)\s*\{([^{}]*)\}", r"\1", plain_latex)
    plain_latex = re.sub(r"\\[a-zA-Z]+", lambda match: _LATEX.get(match[0], match[0][1:]), plain_latex)
    return " ".join(re.sub(r"\\[,;! ]|[{}\\]", " ", plain_latex).split())


CODE_LINES = 20
"""Lines of a shader that are shown at a time."""
BOARD_WORDS = 70
"""Words that are shown at a time over the whole picture: a list, choices and their answer."""

_ROWS = 9  # of a table


def _figure(block: Figure, lesson: Lesson) -> Iterator[Beat]:
    still = Still(block.name) if block.scene else None
    yield _told("figure", block.caption, aside=block.alt, still=still, sliders=block.sliders)


def _slider(block: Slider, lesson: Lesson) -> Iterator[Beat]:
    yield _told("sweep", block.caption, aside=block.alt, still=Still(block.name), sliders=(block.parameter,))


def _exercise(block: Exercise, lesson: Lesson) -> Iterator[Beat]:
    say = labels("talk", lesson.language)
    aside = "\n\n".join(filter(None, [block.hint, f"**{say['solution']}.** {block.solution}"]))
    label = say["exercise"].format(lesson.number_of(block))
    still = Still(block.name, started=True) if block.begin is not None else None
    sliders = () if block.file else block.sliders
    yield _told("exercise", block.ask, label=label, aside=aside, still=still, sliders=sliders)
    if block.scene is not None and block not in lesson.sections[-1].blocks:  # the text goes on from it
        yield _told("solution", block.solution, label=say["solution"], still=Still(block.name))


def _challenge(block: Challenge, lesson: Lesson) -> Iterator[Beat]:
    label = labels("talk", lesson.language)["challenge"]
    yield _told("challenge", block.ask, label=label, still=Still(block.name))


def _measure(block: Measure, lesson: Lesson) -> Iterator[Beat]:
    if block.sentence:
        yield _told("text", block.sentence, label=labels("talk", lesson.language)["measured"])


def _told(kind: str, text: Markdown, **more: object) -> Beat:
    """Return a beat that tells one text: its first sentences are shown, all of it is in the notes."""
    return Beat(kind, 0, "", shown=shown_of(text), notes=text, **more)  # type: ignore[arg-type]


def _prose(block: Prose, lesson: Lesson, formula: Markdown = "") -> Iterator[Beat]:
    text = block.markdown
    if block.kind == "code":
        lines = [line for line in text.strip().split("\n") if not line.startswith("```")]
        for shared in _shared(lines):
            yield Beat("code", 0, "", code=Listing("\n".join(shared)))
    elif block.kind == "list":
        for part in _listed(text):
            yield Beat("board", 0, "", board=part, notes=part)
    elif block.kind == "table":
        head, rule, *rows = text.strip().split("\n")
        for at in range(0, len(rows), _ROWS):
            part = "\n".join([head, rule, *rows[at : at + _ROWS]])
            yield Beat("board", 0, "", board=part, notes=part)
    elif block.kind == "formula":
        yield Beat("text", 0, "", formula=text, notes=text)
    elif formula:
        yield replace(_told("text", text), formula=formula, notes=f"{text}\n\n{formula}")
    elif block.kind != "rule":
        yield _told("text", text.lstrip("> ") if block.kind == "quote" else text)


def _listed(text: Markdown) -> Iterator[Markdown]:
    """Yield the items of a list, as many at a time as a board has room for."""
    items: list[str] = []
    for line in text.strip().split("\n"):
        if items and line.startswith((" ", "\t")):
            items[-1] += f"\n{line}"
        else:
            items.append(line)
    part: list[str] = []
    for item in items:
        if part and words("\n".join([*part, item])) > BOARD_WORDS:
            yield "\n".join(part)
            part = []
        part.append(item)
    yield "\n".join(part)


def _steps(block: Steps, lesson: Lesson) -> Iterator[Beat]:
    label = labels("talk", lesson.language)["step"]
    last = block.iterations[-1] if block.iterations else len(block.scenes)
    for index in range(len(block.scenes)):
        own = block.captions[index] if block.captions else ""
        whole = " ".join(filter(None, [own, block.caption if index == 0 else ""]))  # told once
        at = block.iterations[index] if block.iterations else index + 1
        yield Beat(
            "step",
            0,
            "",
            label.format(at, last),
            shown_of(own or block.caption),
            notes=whole,
            aside=block.alt if index == 0 else "",
            still=Still(block.name, index),
        )


def _variants(block: Compare, lesson: Lesson) -> Iterator[Beat]:
    if len(block.scenes) == 2 and comparable(*block.scenes):
        still = Still(block.name, BOTH)
        yield _told("compare", block.caption, names=block.labels, aside=block.alt, still=still)
        return
    for index, name in enumerate(block.labels):
        aside = block.alt if index == 0 else ""
        still = Still(block.name, index)
        beat = _told("compare", block.caption, label=name, names=(name,), aside=aside, still=still)
        yield beat if index == 0 else replace(beat, notes=name)


def _listed_code(block: Code | Trace, lesson: Lesson) -> Iterator[Beat]:
    label = labels("talk", lesson.language)["part"]
    excerpt_text = excerpt(block.file, block.anchor)
    parts = _shared(excerpt_text.text.split("\n"))
    line = excerpt_text.line
    for number, part in enumerate(parts):
        name = excerpt_text.file
        if len(parts) > 1:
            name += f", {label.format(number + 1, len(parts))}"
        code = Listing("\n".join(part), excerpt_text.file, line)
        beat = _told("code", block.caption, label=name, code=code)
        line += len(part)
        yield beat if number == 0 else replace(beat, notes="")


def _trace(block: Trace, lesson: Lesson) -> Iterator[Beat]:
    """Yield the lines, then the table of the loop, whose cells are numbers that are filled in later."""
    yield from _listed_code(block, lesson)
    if not block.rows:
        return
    hidden = lesson.asked(block.name)
    head = f"| {block.loop} | {' | '.join(f'`{name}`' for name in block.variables)} |"
    rule = "|---" * (len(block.variables) + 1) + "|"
    for at in range(0, len(block.rows), _ROWS):
        rows = [head, rule]
        for step in block.rows[at : at + _ROWS]:
            keys = [(name, step) for name in block.variables]
            cells = ["?" if key in hidden else f"{{{{{block.name}:{key[0]}:{step}}}}}" for key in keys]
            rows.append(f"| {step} | {' | '.join(cells)} |")
        board = "\n".join(rows)
        yield Beat("board", 0, "", label=block.file, board=board, notes=board)


def _shared(lines: list[str]) -> list[list[str]]:
    """Return lines of code in parts of about one length, each no longer than a board."""
    each = math.ceil(len(lines) / math.ceil(len(lines) / CODE_LINES))
    return [lines[at : at + each] for at in range(0, len(lines), each)]


def _bug(block: Break, lesson: Lesson) -> Iterator[Beat]:
    say = labels("talk", lesson.language)
    wrong, whole = Still(block.name, 1, broken=True), Still(block.name)
    later = f"**{say['hint']}.** {block.hint}\n\n**{say['fix']}.** {block.fix}"
    yield _told("broken", block.ask, label=say["broken"], aside=later, still=wrong)
    yield _told("hint", block.hint, label=say["hint"], aside=f"**{say['fix']}.** {block.fix}", still=wrong)
    yield _told("fix", block.fix, label=say["fix"], aside=block.caption, still=whole)


def _question(block: Question, lesson: Lesson) -> Iterator[Beat]:
    say = labels("talk", lesson.language)
    later = f"**{say['answer']}.** {block.answer}"
    yield _told("question", block.ask, label=say["question"], aside=later)
    if block.choices:
        lines = "\n".join(f"- {choice}" for choice in block.choices)
        choosing = Beat("choices", 0, "", say["choices"], board=block.ask, choices=block.choices)
        yield replace(choosing, shown="", notes=lines, aside=later)
        right = Beat("answer", 0, "", say["answer"], shown_of(block.answer), board=block.ask)
        yield replace(right, choices=block.choices, right=block.right, notes=block.answer)
    else:
        yield _told("answer", block.answer, label=say["answer"])


BEATS: dict[type[Block], Callable[[Any, Lesson], Iterator[Beat]]] = {
    Prose: _prose,
    Figure: _figure,
    Steps: _steps,
    Slider: _slider,
    Compare: _variants,
    Code: _listed_code,
    Trace: _trace,
    Break: _bug,
    Question: _question,
    Exercise: _exercise,
    Challenge: _challenge,
    Measure: _measure,
}
"""What yields the beats of each kind of block, each with a picture only where it brings one."""

_TASKS = ("exercise", "challenge")


def beats_of(lesson: Lesson) -> tuple[Beat, ...]:
    """Return the beats of a lesson, in its order; raise ``SketchError`` where code that it quotes is gone."""
    beats: list[Beat] = []
    shown: Still | None = None
    sliders: tuple[str, ...] = ()
    for page, section in enumerate(lesson.sections):
        mine: list[Beat] = []
        blocks = [b for b in section.blocks if not (isinstance(b, Prose) and b.kind == "heading")]
        if page == 0:
            mine.append(_title(lesson))
        at = 0
        while at < len(blocks):
            told, count = _told_next(blocks[at:], lesson)
            mine += [replace(beat, page=page, heading=section.title or lesson.title) for beat in told]
            at += count
        coming = next((beat for beat in mine if beat.still is not None), None)
        if coming is not None and coming.kind not in ("broken", "solution", *_TASKS):
            shown, sliders = coming.still, coming.sliders
        for beat in mine:
            own = beat.still is not None and beat.kind in _TASKS
            if beat.still is not None and not own:
                shown, sliders = beat.still, beat.sliders
            if beat.kind == "text" and beat.shown[:1].islower() and beats and beats[-1].formula:
                both = "\n\n".join(filter(None, [beats[-1].formula, beat.formula]))
                beat = replace(beat, formula=both)  # it goes on from that one
            if beat.kind == "code" and not beat.shown and beats[-1].page == page:
                beat = replace(beat, shown=beats[-1].shown)  # "This is the kernel:" stays
            beats.append(beat if own else replace(beat, still=shown, sliders=sliders))
            if beat.kind == "sweep" and shown is not None:
                shown = _at_end(lesson, shown)
    first = next((beat for beat in beats if beat.still is not None), None)
    if first is not None:  # the title of a lesson whose first page has no picture
        empty = {"still": first.still, "sliders": first.sliders}
        beats = [beat if beat.still is not None else replace(beat, **empty) for beat in beats]  # type: ignore[arg-type]
    return tuple(beats)


def _at_end(lesson: Lesson, still: Still) -> Still:
    """Return the picture that a sweep ends with."""
    block = lesson.named[still.block]
    return replace(still, index=len(block.scenes) - 1) if isinstance(block, Slider) else still


def first_of_page(beats: tuple[Beat, ...], page: int) -> int:
    """Return the index of a page's first beat, or of the last beat before the page where it has none."""
    return next((n for n, beat in enumerate(beats) if beat.page >= page), max(len(beats) - 1, 0))


def _title(lesson: Lesson) -> Beat:
    """Return the beat that a lesson begins with."""
    return Beat(
        "title", 0, lesson.title, labels("talk", lesson.language)["lesson"], lesson.goal, notes=lesson.goal
    )


def _told_next(blocks: list[Block], lesson: Lesson) -> tuple[Iterator[Beat], int]:
    """Return the next beats, and how many blocks they tell: a paragraph and the formula after it are one."""
    pair = [block for block in blocks[:2] if isinstance(block, Prose)]
    if [block.kind for block in pair] == ["paragraph", "formula"]:
        return _prose(pair[0], lesson, pair[1].markdown), 2
    return BEATS[type(blocks[0])](blocks[0], lesson), 1
