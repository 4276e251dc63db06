"""Grade submissions: read each, judge each text once, give each student marks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from playground.course.grading.duplicates import alike
from playground.course.grading.handed_in import HandedIn, read_submission
from playground.course.grading.judges import Judges, Request, Result, Stopped, no_mark
from playground.course.grading.labels import report_labels
from playground.course.grading.marks import MISSING, REFUSED, STOPPED, Graded, Mark, spelled_points
from playground.course.grading.submissions import Submission
from playground.course.handout.exercise_files import Assignment
from playground.course.translatable import in_language
from playground.errors import SketchError, counted

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
            judged[key] = outcome  # type: ignore[index]
            advance()
        _check_answers(judged, assignments)
    same = {
        submission.name: alike(_readable(read, submission), submission.starter)
        for submission in assignments
        if submission.task.file
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
    nothing, label = no_mark(assignment.task), report_labels(language)
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
