"""Grade submissions: read what each hands in, judge each text once, give each student marks."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from playground.course.grading.entries import Entry, Submission, entries_of, printable
from playground.course.grading.judges import Judges, Request, Result, Stopped, no_mark
from playground.course.grading.report import MISSING, REFUSED, STOPPED, Graded, Mark, spelled_points
from playground.course.handout import Assignment, normalised
from playground.course.library import Said, in_language, labels
from playground.errors import DataError, SketchError, counted


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


_NUMBERED = re.compile(r"(?:[ _-]*\(\d+\)|[ _-]+copy(?:[ _-]*\d+)?|[ _-]+kopie)+(?=\.[^.]+$)")
_MARKS = {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}  # of what Windows writes as "Unicode"


@dataclass(frozen=True)
class HandedIn:
    """The file of one exercise, or why there is none."""

    text: str = ""
    problem: str = ""  # a message without a full stop; "": there is none
    note: str = ""  # on which of several files it is
    missing: bool = False  # it was not handed in


def read_submission(path: Path, names: Collection[str]) -> dict[str, HandedIn]:
    """Return the wanted files of a submission by their names; what is wrong with one is in it, in a message.

    Never raises for what a student has done.
    """
    try:
        entries = entries_of(path)
    except DataError as error:
        problem = Said("{name} {what}", name=printable(path.name), what=error.diagnostics[0].message)
        return {name: HandedIn(problem=problem) for name in names}
    entries_by_name = {name: [e for e in entries if _plain_name(e.name) == name.casefold()] for name in names}
    archives = [entry for entry in entries if entry.is_archive][:1]  # what is missing may be in one
    return {name: _file_of(named) if named else _file_of(archives) for name, named in entries_by_name.items()}


def lessons_in(path: Path, lessons: Collection[str]) -> set[str]:
    """Return the lessons, of those named, of which a submission holds files; none where it cannot be read."""
    try:
        stems = {_plain_name(entry.name).partition("-")[0] for entry in entries_of(path)}
    except DataError:
        return set()
    return stems & set(lessons)


def _file_of(entries: list[Entry]) -> HandedIn:
    """Return the first of the files that go by one name, and say so where another differs."""
    if not entries:
        return HandedIn(missing=True)
    first = _read(entries[0])
    others = [_read(entry) for entry in entries[1:4]]
    if all(other.text == first.text and not other.problem for other in others):
        return first
    note = Said(
        "{count} files of this name were handed in; graded: {path}",
        count=len(entries),
        path=printable(entries[0].path),
    )
    return HandedIn(first.text, first.problem, note)


def _read(entry: Entry) -> HandedIn:
    try:
        data = entry.read()
        encoding = _MARKS.get(data[:2], "utf-8-sig")
        text = data.decode(encoding).replace("\r\n", "\n").replace("\r", "\n")
    except DataError as error:
        return HandedIn(
            problem=Said("{name} {what}", name=printable(entry.name), what=error.diagnostics[0].message)
        )
    except UnicodeDecodeError:
        return HandedIn(
            problem=Said("{name} is not UTF-8 text; save the file as UTF-8", name=printable(entry.name))
        )
    if "\0" in text:
        return HandedIn(problem=Said("{name} is not a text: it holds zero bytes", name=printable(entry.name)))
    return HandedIn(text)


def _plain_name(name: str) -> str:
    """Return a file's name without what a copy or a download has added to it."""
    name = unicodedata.normalize("NFKC", name).casefold()
    if name.endswith((".glsl.txt", ".toml.txt")):
        name = name.removesuffix(".txt")
    return _NUMBERED.sub("", name)


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
