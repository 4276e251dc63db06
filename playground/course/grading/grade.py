"""Grade submissions: judge each text once, side by side in worker processes, and give each student marks.

A work that takes too long, by the processor's time that it has had, ends with its process, and so does one
that crashes it or takes all memory. A process that died is replaced. A crash counts only if it happens
again in a new process: what went wrong there may be what an earlier work has left behind.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from pathlib import PurePosixPath, PureWindowsPath
from typing import Any, TypeVar, cast

from playground.allowed_files import is_absolute, leads_outside
from playground.course.grading.report import (
    GRADED,
    MISSING,
    REFUSED,
    STOPPED,
    Graded,
    Mark,
    Pair,
    spelled_points,
)
from playground.course.grading.submissions import HandedIn, Submission, printable, read_submission
from playground.course.handout import Assignment, assignments_of, normalised
from playground.course.judging import LIMIT_BYTES, Judge, cause_of, surviving
from playground.course.library import LANGUAGES, Said, decimal, in_language, labels
from playground.course.model import Challenge, Exercise, Question, Task
from playground.course.read import read_lesson
from playground.course.scenes import draw
from playground.course.tasks import (
    Match,
    Picture,
    Verdict,
    Work,
    answer,
    path_of,
    scene_of,
    score_of,
    sentences,
    small,
    wanted_scene,
    webp_of,
)
from playground.course.traces import Answer, number_in, trace_of, traced
from playground.engine.context import ContextInfo
from playground.engine.engine import Engine, open_engine
from playground.engine.plain_forms import silent
from playground.engine.process.child import Outcome
from playground.engine.process.pool import Limits, Pool, PoolOwner
from playground.engine.process.worker import Parent, Service
from playground.errors import ContextError, DataError, PlaygroundError, SketchError, counted
from playground.paths import GLSL, shown
from playground.sketch.model import Sketch, Value, kernels_of

_MAX_TOML = 2**17  # characters of a sketch's TOML
_MAX_VALUE = 200  # characters of a value


def values_in_toml(text: str, sliders: Sequence[str]) -> dict[str, Value]:
    """Return the values that a sketch's TOML sets of some parameters, by their paths; others are left out.

    Raises ``DataError`` in a message for what is no TOML, or names a file elsewhere.
    """
    if len(text) > _MAX_TOML:
        raise DataError(Said("is longer than any sketch: {count} characters", count=len(text)))
    try:
        table = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, ValueError) as error:
        raise DataError(Said("is no TOML: {why}", why=printable(str(error), 200))) from None
    except RecursionError:
        raise DataError(Said("is no sketch: its tables nest too deeply")) from None
    for name in _texts_in(table):
        if _leads_out(name):
            raise DataError(
                Said("names '{name}', a file outside of its folder; it was not opened", name=printable(name))
            )
    values: dict[str, Value] = {}
    for path in sliders:
        owner, _, rest = path.partition(".")
        value = _under(_settings_of(table, owner), rest) if rest else table.get(path)
        if value is not None:
            values[path] = _checked(path, value)
    return values


def _settings_of(table: Mapping[str, Any], owner: str) -> Mapping[str, Any]:
    """Return what a sketch's TOML sets of one pass; an empty table where it sets nothing."""
    passes = table.get("pass")
    candidates = [p for p in passes if isinstance(p, dict)] if isinstance(passes, list) else []
    named = [p for p in candidates if p.get("name") == owner]
    if owner == "view" and isinstance(table.get("view"), dict):
        named.append(table["view"])
    settings = named[0].get("set") if named else None
    return settings if isinstance(settings, dict) else {}


def _under(settings: Mapping[str, Any], path: str) -> Any:
    """Return what is under a path, written as one key or as tables in tables; None where nothing is."""
    if path in settings:
        return settings[path]
    first, dot, rest = path.partition(".")
    inner = settings.get(first)
    return _under(inner, rest) if dot and isinstance(inner, dict) else None


def _checked(path: str, value: Any) -> Value:
    """Return a value if it is one that a parameter may have; whether it suits is the judge's to say."""
    if isinstance(value, bool | str) and len(str(value)) <= _MAX_VALUE:
        return value
    numbers = (
        list(value.values()) if isinstance(value, dict) else value if isinstance(value, list) else [value]
    )
    plain = all(type(n) in (int, float) and math.isfinite(n) and abs(n) < 2**53 for n in numbers)
    if not plain or not 0 < len(numbers) <= 16:
        raise DataError(
            Said(
                "sets {path} to a value that is not a number: {value}",
                path=path,
                value=printable(repr(value)),
            )
        )
    return cast(Value, value)


def _texts_in(value: object) -> Iterator[str]:
    waiting = [value]
    while waiting:
        item = waiting.pop()
        if isinstance(item, str):
            yield item
        elif isinstance(item, dict):
            waiting += [*item.keys(), *item.values()]
        elif isinstance(item, list):
            waiting += item


def _leads_out(text: str) -> bool:
    """Return whether a text, taken for a path, is absolute or climbs out of a folder, on any system."""
    parts = (*PurePosixPath(text).parts, *PureWindowsPath(text).parts)
    return is_absolute(text) or ".." in parts


WORKERS = 2
"""Processes side by side."""

LIMIT = 10.0
"""[s] of a processor that judging one work may take, where the model answer is not slow itself."""

TIMES_ANSWER = 10.0
"""A work may take so many times as long as the model answer, if that is more."""

_ANSWER = 300.0  # [s] that drawing a model answer may take, which is not the student's time
_MAX_WORKS = 80  # of a process: a driver never forgets a shader


@dataclass(frozen=True)
class Stopped:
    """What ended the process that judged a work."""

    took_too_long: bool = False
    cause: str = ""  # of a crash


Result = Mark | Stopped
K = TypeVar("K")


class Judges(PoolOwner):
    """Worker processes that judge; use it with ``with``, or call ``close()``."""

    def __init__(
        self, options: Options, workers: int = WORKERS, limit: float = LIMIT, memory_bytes: int = LIMIT_BYTES
    ) -> None:
        self._limit = limit
        self._limits: dict[str, float] = {}  # [s] by exercise
        self.renderer = ""  # what draws, once something was judged
        self._pool = Pool(
            __name__,
            Limits(longer={PREPARING: _ANSWER}, memory_bytes=memory_bytes, requests=_MAX_WORKS, crashes=2),
            options=options,
            workers=workers,
            # Processes side by side: each draws on a processor of its own.
            environment={"LP_NUM_THREADS": "1"} if workers > 1 else {},
        )

    def judge_all(self, requests: Iterable[tuple[K, Request]]) -> Iterator[tuple[K, Result]]:
        """Yield what comes of each request, with its key, in their order.

        Raises ``PlaygroundError`` where it is nobody's work: no renderer, a model answer that fails.
        """
        tasks = [
            (key, request, self._pool.submit(request, seconds=self._seconds(request)))
            for key, request in requests
        ]
        for key, request, task in tasks:
            yield key, self._result(request, task.result())

    def limit_of(self, exercise: str) -> float:
        """Return how long judging a work of an exercise may take [s]."""
        return self._limits.get(exercise, self._limit)

    def _seconds(self, request: Request) -> float:
        return _ANSWER if request.text is None else self.limit_of(request.exercise)

    def _result(self, request: Request, outcome: Outcome) -> Result:
        if not outcome.started or (outcome.kind == "hang" and outcome.progress == PREPARING):
            raise outcome.failure(f"drawing the answer of {request.exercise}")
        if outcome.kind == "hang":
            return Stopped(took_too_long=True)
        if outcome.kind == "crash":
            return Stopped(cause=cause_of(outcome))
        mark = outcome.get("judging")
        assert isinstance(mark, Mark) and isinstance(outcome.info, ContextInfo)
        self.renderer = outcome.info.renderer
        if request.text is None:
            # By its own clock, as the limit is kept: on a busy machine the wall's would give much more.
            longest = min(max(self._limit, TIMES_ANSWER * outcome.seconds), _ANSWER)
            self._limits[request.exercise] = float(round(longest))
        return mark


# ── in the worker ────────────────────────────────────────────────────────────


PREPARING, JUDGING = "preparing", "judging"
"""What the worker reports: it draws the model answer, or a student's work, whose time is limited."""

_CACHE = 192 * 2**20  # [bytes] of textures
_MAX_LINE = 160  # characters of a line of a sentence
_MAX_MESSAGES = 8  # a text may have thousands of mistakes
_MAX_PAIRS = 4  # of pictures, for each exercise


@dataclass(frozen=True)
class Options:
    """What a worker is started with."""

    lessons: tuple[str, ...]
    language: str
    software: bool = False
    device: int | None = None


@dataclass(frozen=True)
class Request:
    """One work to judge; without a text, the model answer, which must have all points."""

    exercise: str  # its name in a hand-out
    text: str | None = None  # of its file


def open_service(parent: Parent, options: Options) -> Service:
    """Open a context and an engine on it, and read the lessons."""
    engine = open_engine(software=options.software, device=options.device, cache_bytes=_CACHE, notice=silent)
    engine.runner.pool.clears = True  # a text that gets around writing a texel shows nobody else's there
    lessons = [read_lesson(name, options.language) for name in options.lessons]
    assignments = {assignment.name: assignment for assignment in assignments_of(lessons)}
    judge = Judge(engine)
    numbers: dict[str, Answer] = {}

    def number_of(assignment: Assignment, question: Question) -> Answer:
        if assignment.name not in numbers:
            lines = traced(engine, assignment.lesson, trace_of(assignment.lesson, question))
            numbers[assignment.name] = lines.answer(question)
        return numbers[assignment.name]

    def answer_request(request: Request) -> Mark:
        assignment = assignments[request.exercise]
        task = assignment.task
        parent.report(PREPARING)
        if isinstance(task, Question):
            return _number_mark(task, number_of(assignment, task), request.text, options.language)
        _ = judge.ends(task) if isinstance(task, Challenge) else judge.answers(task)
        if request.text is None:
            return _judged_mark(judge, options.language, task, request.exercise, answer(task))
        parent.report(JUDGING)
        with surviving(engine):
            try:
                work = _work_of(task, request.text)
                return _judged_mark(judge, options.language, task, request.exercise, work)
            except (ContextError, DataError) as error:  # or a texture larger than there is room for
                said = (_short(in_language(error.diagnostics[0].message, options.language)),)
                return replace(no_mark(task), outcome=REFUSED, sentences=said)

    return Service(answer_request, engine.info)


def _judged_mark(judge: Judge, language: str, task: Exercise | Challenge, name: str, work: Work) -> Mark:
    """Return the mark of a work; raise as ``Judge.judge``, and where the model answer cannot be drawn."""
    result = judge.judge(task, work)
    # Where a text was read from is the student's own file, not the one that it takes the place of.
    path_text, own = shown(path_of(task)) if task.file else "", f"{name}.glsl"

    def said(texts: Iterable[str]) -> tuple[str, ...]:
        first = islice(texts, _MAX_MESSAGES)
        return tuple(_short(s.replace(path_text, own) if path_text else s) for s in first)

    if isinstance(result, Match):
        texts = [*map(str, result.diagnostics)] or [score_of(result, language)]
        both = result.mine, result.target
        pair = () if both[0] is None or both[1] is None else (_pair(both[0], both[1]),)
        return replace(no_mark(task), sentences=said(texts), pairs=pair, score=result.score)
    assert isinstance(task, Exercise)
    pairs = () if result.diagnostics else _pairs(judge.engine, task, work, result)
    return Mark(result.points, result.of, GRADED, said(sentences(result, language)), pairs)


def _number_mark(task: Question, answer: Answer, text: str | None, language: str) -> Mark:
    """Return the mark of the number that a file holds; of the answer itself for no text."""
    given = answer.text if text is None else _number_text(text)
    right = answer.accepts(given)
    key = "number_right" if right else "number_wrong" if number_in(given) is not None else "no_number"
    said = labels("grading", language)(
        key, mine=printable(given), value=decimal(answer.text, language), tolerance=f"{answer.tolerance:g}"
    )
    return Mark(float(task.points) if right else 0.0, task.points, GRADED, (said,))


def _number_text(text: str) -> str:
    """Return what a student has written behind the last colon that the number belongs behind; "" for none."""
    lines = [line.strip().partition(":") for line in text[:_MAX_TOML].split("\n")]
    keys = {labels("handout", code)["number_key"] for code in LANGUAGES}
    texts = [value.strip() for key, _, value in lines if key.strip().casefold() in keys]
    return texts[-1] if texts else ""


def _pairs(engine: Engine, exercise: Exercise, work: Work, verdict: Verdict) -> tuple[Pair, ...]:
    """Return the pictures to compare: those that failed first, of measures one of all that is drawn."""
    results = sorted(verdict.results, key=lambda result: result.passed)
    both = [(r.mine, r.expected) for r in results if r.mine is not None and r.expected is not None]
    if both:
        return tuple(_pair(mine, expected) for mine, expected in both[:_MAX_PAIRS])
    scenes = scene_of(exercise, work), wanted_scene(exercise)
    return (_pair(*(draw(engine, small(scene)).array for scene in scenes)),)


def _pair(mine: Picture, expected: Picture) -> Pair:
    return Pair(webp_of(mine), webp_of(expected))


def no_mark(task: Exercise | Challenge | Question) -> Mark:
    """Return the mark of one who has nothing."""
    if isinstance(task, Challenge):
        return Mark(0.0, 0, GRADED, score=0.0, goal=task.goal)
    return Mark(0.0, task.points, GRADED)


def _work_of(task: Exercise | Challenge, text: str) -> Work:
    """Return a work by its file's text; raise ``DataError`` for what names files elsewhere."""
    if not task.file:
        return Work(None, values_in_toml(text, task.sliders))
    work = Work(text)
    try:
        sketch = scene_of(task, work).sketch
    except PlaygroundError:
        return work  # the judge says what is wrong with it
    if outside := _outside_file(sketch):
        raise DataError(Said("names '{name}', a file outside of its folder; it was not opened", name=outside))
    return work


def _outside_file(sketch: Sketch) -> str:
    """Return a file that a kernel names by itself and that lies neither with the sketch nor in ``glsl/``."""
    for _, kernel in kernels_of(sketch.graph):
        for parameter in kernel.parameters:
            text = str(parameter.default)
            if parameter.widget.kind == "file" and text and leads_outside(text, GLSL, parameter.file):
                return text
    return ""


def _short(sentence: str) -> str:
    """Return a sentence, with the code that it may quote, without the rest of endless lines."""
    lines = [line if len(line) <= _MAX_LINE else f"{line[:_MAX_LINE]}…" for line in sentence.split("\n")]
    return "\n".join(line for line in lines[:3] if line.strip())


def alike(texts: Mapping[str, str], handed_out: str) -> dict[str, tuple[str, ...]]:
    """Return for each student those who handed in the same text; what was handed out is no text of theirs."""
    groups: dict[str, list[str]] = {}
    for student, text in texts.items():
        groups.setdefault(normalised(text), []).append(student)
    for nobodys in ("", normalised(handed_out)):
        groups.pop(nobodys, None)
    return {
        student: tuple(other for other in group if other != student)
        for group in groups.values()
        if len(group) > 1
        for student in group
    }


Judged = dict[tuple[str, str | None], Result]
"""What came of each text, by the exercise's name; None is the model answer."""


def read_all(
    submissions: Sequence[Submission], assignments: Sequence[Assignment]
) -> dict[str, dict[str, HandedIn]]:
    """Return what each student handed in, by the exercise's name."""
    by_file = {assignment.file.casefold(): assignment.name for assignment in assignments}
    return {
        submission.student: {
            by_file[file]: files for file, files in read_submission(submission.path, by_file).items()
        }
        for submission in submissions
    }


def count_works(read: dict[str, dict[str, HandedIn]], assignments: Sequence[Assignment]) -> int:
    """Return how many works are to be judged, the model answers among them."""
    return len(assignments) + len(_texts(read))


def grade(
    read: dict[str, dict[str, HandedIn]],
    assignments: Sequence[Assignment],
    judges: Judges,
    language: str,
    advance: Callable[[], None] = lambda: None,
) -> list[Graded]:
    """Return the marks of all students, in their order; ``advance`` is called after each work.

    Raises ``PlaygroundError`` where a grade would be wrong for all: no renderer, a model answer that does
    not have all its points on it.
    """
    judged: Judged = {}
    for requests in ([(submission.name, None) for submission in assignments], _texts(read)):
        named = [((name, text), Request(name, text)) for name, text in requests]
        for key, outcome in judges.judge_all(named):
            judged[key] = outcome
            advance()
        _check_answers(judged, assignments)
    same = {
        submission.name: alike(_readable(read, submission), submission.starter)
        for submission in assignments
        if isinstance(submission.task, Task) and submission.task.file
    }
    return [
        Graded(
            student,
            {
                submission.name: _mark(
                    submission,
                    files[submission.name],
                    judged,
                    judges.limit_of(submission.name),
                    language,
                    same,
                    student,
                )
                for submission in assignments
            },
        )
        for student, files in read.items()
    ]


def _texts(read: dict[str, dict[str, HandedIn]]) -> list[tuple[str, str]]:
    """List what is to be judged, each text of an exercise once, in the order of the students."""
    return list(
        dict.fromkeys(
            (name, file.text)
            for files in read.values()
            for name, file in files.items()
            if not file.missing and not file.problem
        )
    )


def _readable(read: dict[str, dict[str, HandedIn]], assignment: Assignment) -> dict[str, str]:
    files = {student: files[assignment.name] for student, files in read.items()}
    return {student: file.text for student, file in files.items() if not file.missing and not file.problem}


def _check_answers(judged: Judged, assignments: Sequence[Assignment]) -> None:
    for assignment in assignments:
        mark = judged[assignment.name, None]
        if isinstance(mark, Mark) and mark.is_full:
            continue
        if isinstance(mark, Mark) and mark.score is not None:
            got = f"has a score of {mark.spelled} here"
        elif isinstance(mark, Mark):
            got = f"has {spelled_points(mark.points)} of {counted(mark.of, 'point')} here"
            got += f": {'; '.join(mark.sentences)}"
        else:
            got = "takes too long here" if mark.took_too_long else f"cannot be drawn here: it {mark.cause}"
        message = f"{assignment.name}: the model answer {got}; nothing was graded"
        raise SketchError(message, file=assignment.lesson.file, line=assignment.task.line)


def _mark(
    assignment: Assignment,
    file: HandedIn,
    judged: Judged,
    limit: float,
    language: str,
    same: dict[str, dict[str, tuple[str, ...]]],
    student: str,
) -> Mark:
    nothing, label = no_mark(assignment.task), labels("grading", language)
    if file.missing:
        return replace(nothing, outcome=MISSING, sentences=(label["missing"],))
    if file.problem:
        return replace(
            nothing,
            outcome=REFUSED,
            sentences=(_sentence(in_language(file.problem, language)),),
            note=in_language(file.note, language),
        )
    outcome = judged[assignment.name, file.text]
    if isinstance(outcome, Stopped):
        key = "stopped" if outcome.took_too_long else "crashed"
        said = label(key, limit=f"{limit:g}", cause=in_language(outcome.cause, language))
        mark = replace(nothing, outcome=STOPPED, sentences=(said,))
    else:
        mark = outcome
    if mark.outcome == REFUSED:
        mark = replace(
            mark, sentences=tuple(_sentence(f"{assignment.file} {text}") for text in mark.sentences)
        )
    return replace(
        mark, note=in_language(file.note, language), same_as=same.get(assignment.name, {}).get(student, ())
    )


def _sentence(text: str) -> str:
    text = text.strip()
    return text if text.endswith((".", "?", "!")) else f"{text}."
