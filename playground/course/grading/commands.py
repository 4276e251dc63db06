"""Grade what a class has handed in."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from playground.commands import options
from playground.commands.arguments import Renderer, help_text
from playground.commands.options import positional, value
from playground.course.options import Language, complete_lesson, read_language
from playground.errors import SketchError, counted
from playground.terminal import note, print_json, print_table, progress

if TYPE_CHECKING:
    from playground.course.grading.marks import Graded
    from playground.course.grading.submissions import Submission
    from playground.course.handout.exercise_files import Assignment

HELP = help_text(
    "Grade a folder of submissions: one folder or zip for each student, as `playground lesson handout` gave"
    " them out.\n\n"
    "Writes grades.csv and index.html, a contact sheet with submissions next to expected pictures. Each"
    " work is judged in a process of its own limits: an endless loop costs its author the points and nobody"
    " else anything. Without --lesson, those lessons are graded of which something was handed in. Exit"
    " status 0 when graded, whatever the grades.",
    "playground lesson grade handed-in -o report",
    "playground lesson grade handed-in --lesson diamond_square --lang fr -o notes",
    "playground lesson grade handed-in --json",
)


def grade(
    ctx: typer.Context,
    folder: Annotated[Path, positional("FOLDER", "A folder or a zip for each student is in it.")],
    output: Annotated[Path, value("-o --output FOLDER", "The report; report by default.")] = Path("report"),
    lessons: Annotated[
        list[str] | None,
        value("--lesson NAME", "A lesson to grade; may be repeated.", complete_lesson),
    ] = None,
    lang: Language = "",
    as_json: options.Json = False,
    software: options.Software = False,
) -> None:
    """Grade a folder of submissions."""
    from playground.course.grading.grade import count_works, grade, read_all
    from playground.course.grading.judges import Judges, Options
    from playground.course.grading.report import check_folder, write_report
    from playground.course.grading.submissions import find_submissions
    from playground.course.handout.exercise_files import assignments_of
    from playground.course.read import read_lesson

    language, folder, output = read_language(lang), folder.expanduser(), output.expanduser()
    submissions, others = find_submissions(folder, output)
    check_folder(output)
    names = list(dict.fromkeys(lessons or _lessons_handed_in(submissions)))
    assignments = assignments_of(read_lesson(name, language) for name in names)
    for name in names:
        if not any(submission.lesson.name == name for submission in assignments):
            raise SketchError(f"no exercise of the lesson {name} checks itself, so there is nothing to grade")
    read = read_all(submissions, assignments)
    renderer: Renderer = ctx.obj.or_else(software)
    with (
        Judges(Options(tuple(names), language, renderer.software, renderer.device)) as judges,
        progress("grading", count_works(read, assignments)) as advance,
    ):
        graded = grade(read, assignments, judges, language, advance)
        drawn_by = judges.renderer
    titles = {submission.name: submission.title for submission in assignments}
    page, kept = write_report(output, graded, titles, language, drawn_by)
    for name in others:
        note(f"left out: {name}")
    if kept is not None:
        note(f"grades.csv had been changed since the last report; it is kept as {kept}")
    if as_json:
        print_json([_as_json(submission) for submission in graded])
        return
    _print(graded, assignments)
    note(f"{page} and {page.with_name('grades.csv')}")


def _lessons_handed_in(submissions: Sequence[Submission]) -> list[str]:
    """Return the lessons of which anything was handed in; raise ``SketchError`` for none."""
    from playground.course.contents import lesson_names
    from playground.course.grading.handed_in import lessons_in

    lessons = lesson_names()
    names = {name for submission in submissions for name in lessons_in(submission.path, lessons)}
    if not names:
        raise SketchError("no submission holds a file of an exercise; name the lessons: --lesson NAME")
    return [name for name in lessons if name in names]


def _as_json(graded: Graded) -> dict[str, object]:
    return {
        "student": graded.student,
        "points": graded.points,
        "of": graded.of,
        "exercises": {
            name: {
                "points": mark.points,
                "of": mark.of,
                **({} if mark.score is None else {"score": mark.score}),
                "outcome": mark.outcome,
                "sentences": list(mark.sentences),
                "note": mark.note,
                "same_as": list(mark.same_as),
            }
            for name, mark in graded.marks.items()
        },
    }


def _print(graded: Sequence[Graded], assignments: Sequence[Assignment]) -> None:
    from playground.course.grading.entries import printable
    from playground.course.grading.marks import spelled_points

    headings = ["student", *(graded.name for graded in assignments), "total", "of"]
    rows = [
        [
            printable(graded.student),
            *(mark.spelled for mark in graded.marks.values()),
            spelled_points(graded.points),
            str(graded.of),
        ]
        for graded in graded
    ]
    print_table(f"Grades of {counted(len(graded), 'submission')}", headings, rows)
