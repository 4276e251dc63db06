"""Grade submissions: read each, judge each text once, give each student marks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from playground.errors import SketchError, counted
from playground.lessons.grading.duplicates import alike
from playground.lessons.grading.handed_in import HandedIn, read_submission
from playground.lessons.grading.judges import Judges, Request, Result, Stopped, no_mark
from playground.lessons.grading.labels import report_labels
from playground.lessons.grading.marks import MISSING, REFUSED, STOPPED, Graded, Mark, spelled_points
from playground.lessons.grading.submissions import Submission
from playground.lessons.handout.exercise_files import Assignment
from playground.lessons.translatable import in_language

Judged = dict[tuple[str, str | None], Result]
"""What came of each text, by the exercise's name; None is the model answer."""


def read_all(
    submissions: Sequence[Submission], assignments: Sequence[Assignment]
) -> dict[str, dict[str, HandedIn]]:
    """Return what each student handed in, by the exercise's name."""
    by_file = {one.file.casefold(): one.name for one in assignments}
    return {
        one.student: {by_file[file]: found for file, found in read_submission(one.path, by_file).items()}
        for one in submissions
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
    for requests in ([(one.name, None) for one in assignments], _texts(read)):
        named = [((name, text), Request(name, text)) for name, text in requests]
        for key, outcome in judges.judge_all(named):
            judged[key] = outcome  # type: ignore[index]
            advance()
        _check_answers(judged, assignments)
    same = {one.name: alike(_readable(read, one), one.starter) for one in assignments if one.task.file}
    return [
        Graded(
            student,
            {
                one.name: _mark(
                    one, files[one.name], judged, judges.limit_of(one.name), language, same, student
                )
                for one in assignments
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


def _readable(read: dict[str, dict[str, HandedIn]], one: Assignment) -> dict[str, str]:
    found = {student: files[one.name] for student, files in read.items()}
    return {student: file.text for student, file in found.items() if not file.missing and not file.problem}


def _check_answers(judged: Judged, assignments: Sequence[Assignment]) -> None:
    for one in assignments:
        mark = judged[one.name, None]
        if isinstance(mark, Mark) and mark.is_full:
            continue
        if isinstance(mark, Mark) and mark.score is not None:
            got = f"has a score of {mark.spelled} here"
        elif isinstance(mark, Mark):
            got = f"has {spelled_points(mark.points)} of {counted(mark.of, 'point')} here"
            got += f": {'; '.join(mark.sentences)}"
        else:
            got = "takes too long here" if mark.took_too_long else f"cannot be drawn here: it {mark.cause}"
        message = f"{one.name}: the model answer {got}; nothing was graded"
        raise SketchError(message, file=one.lesson.file, line=one.task.line)


def _mark(
    one: Assignment,
    file: HandedIn,
    judged: Judged,
    limit: float,
    language: str,
    same: dict[str, dict[str, tuple[str, ...]]],
    student: str,
) -> Mark:
    nothing, label = no_mark(one.task), report_labels(language)
    if file.missing:
        return replace(nothing, outcome=MISSING, sentences=(label["missing"],))
    if file.problem:
        return replace(
            nothing,
            outcome=REFUSED,
            sentences=(_sentence(in_language(file.problem, language)),),
            note=in_language(file.note, language),
        )
    outcome = judged[one.name, file.text]
    if isinstance(outcome, Stopped):
        key = "stopped" if outcome.took_too_long else "crashed"
        said = label(key, limit=f"{limit:g}", cause=in_language(outcome.cause, language))
        mark = replace(nothing, outcome=STOPPED, sentences=(said,))
    else:
        mark = outcome
    if mark.outcome == REFUSED:
        mark = replace(mark, sentences=tuple(_sentence(f"{one.file} {text}") for text in mark.sentences))
    return replace(
        mark, note=in_language(file.note, language), same_as=same.get(one.name, {}).get(student, ())
    )


def _sentence(text: str) -> str:
    text = text.strip()
    return text if text.endswith((".", "?", "!")) else f"{text}."
