"""Lessons: list, open, present, check, build, hand out and grade them, keep translations up to date."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from playground.commands import options
from playground.commands.arguments import (
    FAILED,
    Renderer,
    check_parent,
    command_group,
    either,
    help_text,
)
from playground.commands.options import flag, positional, value
from playground.course.options import Language, complete_language, complete_lesson, read_language
from playground.errors import DataError, ParameterError, PlaygroundError, SketchError, counted, nearest
from playground.studio.commands import check_display, open_window
from playground.terminal import complain, note, painted, print_json, print_rows, print_table, progress

if TYPE_CHECKING:
    from playground.course.grading.report import Graded
    from playground.course.grading.submissions import Submission
    from playground.course.handout import Assignment
    from playground.course.model import Lesson
    from playground.engine.engine import Engine

HELP = help_text(
    "Lessons on terrain, to read next to the window, in a browser or as notebooks.",
    "playground lesson list",
    "playground lesson open diamond_square",
    "playground lesson build -o book",
    "playground lesson status",
)
app = command_group("lesson", HELP, "Lessons on terrain: read them, build them as a book or notebooks.")

NameArgument = Annotated[str, positional("NAME", "A lesson.", complete_lesson)]
NamesArgument = Annotated[list[str] | None, positional("NAME", "Lessons; all by default.", complete_lesson)]

HANDOUT_HELP = help_text(
    "Write the exercises of lessons as a zip for students: a page without answers, and for each exercise"
    " that checks itself a folder that the window opens.\n\n"
    "Students edit one file an exercise and hand the folder in; `playground lesson grade` grades what a class"
    " has handed in. Model answers are not in the zip. The playground is on no package index: --wheel puts it"
    " into the zip, --install says in the students' README where they get it.",
    "playground lesson handout diamond_square -o week3.zip",
    "playground lesson handout diamond_square --hints --lang fr -o semaine3.zip",
    "playground lesson handout diamond_square --wheel terrain_shader_playground-0.1.0-py3-none-any.whl",
    'playground lesson handout diamond_square --install "In room 3 it is installed."',
    "playground live week3.zip",
)


@app.command("handout", help=HANDOUT_HELP)
def handout(
    ctx: typer.Context,
    names: Annotated[list[str], positional("NAME", "The lessons.", complete_lesson)],
    output: Annotated[Path, value("-o --output FILE", "The zip; handout.zip by default.")] = Path(
        "handout.zip"
    ),
    hints: Annotated[bool, flag("--hints", "Put the exercises' hints on the page.")] = False,
    install: Annotated[str, value("--install LINE", "How students install the playground.")] = "",
    wheel: Annotated[
        Path | None, value("--wheel FILE", "A wheel of the playground, to put into the zip.")
    ] = None,
    lang: Language = "",
    software: options.Software = False,
) -> None:
    """Write the exercises of lessons as a zip for students."""
    from playground.course.handout import count_tasks, read_wheel, write_handout
    from playground.course.read import read_lesson

    output = output.expanduser()
    if output.is_dir() or output.suffix.lower() != ".zip":
        raise DataError("a hand-out is written to a name ending in .zip", file=output)
    check_parent(output, str(output))
    if wheel is not None:
        wheel = wheel.expanduser()
        read_wheel(wheel)
    language = read_language(lang)
    lessons = [read_lesson(name, language) for name in dict.fromkeys(names)]
    with (
        ctx.obj.or_else(software).open_engine() as engine,
        progress("drawing", count_tasks(lessons)) as advance,
    ):
        written = write_handout(
            output, lessons, engine, hints=hints, install=install, wheel=wheel, advance=advance
        )
    print(output)
    exercises = sum(assignment.points > 0 for assignment in written)
    matches = f", {counted(len(written) - exercises, 'challenge')}" if exercises < len(written) else ""
    points = counted(sum(assignment.points for assignment in written), "point")
    if not install and wheel is None:
        note("README.txt leaves it to you how students install the playground: see --wheel and --install")
    note(f"{counted(exercises, 'exercise')} to hand in, {points}{matches}")


GRADE_HELP = help_text(
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


@app.command("grade", help=GRADE_HELP)
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
    from playground.course.grading.grade import Judges, Options, count_works, grade, read_all
    from playground.course.grading.report import check_folder, write_report
    from playground.course.grading.submissions import find_submissions
    from playground.course.handout import assignments_of
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
    from playground.course.grading.submissions import lessons_in
    from playground.course.library import lesson_names

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
    from playground.course.grading.report import spelled_points
    from playground.course.grading.submissions import printable

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


PRESENT_HELP = help_text(
    "Present a lesson to a class: full screen, large type, one thought at a time.\n\n"
    "Space, PgDn or a clicker goes on; ? shows every key; Esc goes back to the window. The teacher's notes,"
    " with a clock, are at the address that is printed, for a browser on this machine. --video writes the"
    " presentation as a film, its notes as subtitles (.srt) next to it, without a window.",
    "playground lesson present diamond_square",
    "playground lesson present diamond_square --lang fr --from 12",
    "playground lesson present diamond_square --video talk.mp4",
)

FILM_SIZE = (1280, 720)
"""Pixels of a film, where none are given."""


@app.command("present", help=PRESENT_HELP)
def present(
    ctx: typer.Context,
    name: NameArgument,
    lang: Language = "",
    beat: Annotated[int, value("--from BEAT", "The number of the beat to begin at.")] = 1,
    no_notes: Annotated[bool, flag("--no-notes", "Without the page of notes, or subtitles.")] = False,
    video: Annotated[str, value("--video FILE", "Write it as a film: .mp4, .webm or .gif.")] = "",
    size: options.Size = None,
    software: options.Software = False,
) -> None:
    """Present a lesson to a class."""
    from playground.course.library import lesson_file
    from playground.course.read import read_lesson
    from playground.course.talk.beats import beats_of

    lesson_file(name)  # says so where there is none
    lesson = read_lesson(name, read_language(lang))
    count = len(beats_of(lesson))
    if not 1 <= beat <= count:
        raise ParameterError(f"--from {beat}: lesson {name} has beats 1 to {count}")
    renderer = ctx.obj.or_else(software)
    if video:
        from playground.course.talk.film import film_of, write_presentation

        film = film_of(lesson, Path(video).expanduser(), size or FILM_SIZE, first=beat - 1)
        film.check()
        with renderer.open_engine() as engine, progress(f"filming {lesson.name}", len(film.beats)) as done:
            paths = write_presentation(engine, film, subtitles=not no_notes, done=done, notice=note)
        print(*paths, sep="\n")
        return
    check_display(renderer)
    from playground.course.talk.stage import Presenting

    presenting = Presenting(beat, notes=not no_notes, say=note)
    request = {"lesson": name, "language": lesson.language, "present": presenting}
    open_window(lesson.sketch, size, renderer, request=request)


LIST_HELP = help_text(
    "List the lessons, in their order, by the parts of the course.\n\n"
    "Shown are the minutes that reading a lesson takes, and those that its exercises take besides. In a pipe,"
    " the columns are separated by tabs, the last one is the part.",
    "playground lesson list",
    "playground lesson list --lang fr",
    "playground lesson list --json",
)
OPEN_HELP = help_text(
    "Open a lesson next to the live window, with the sketch that it ends with.\n\n"
    "Without a name the one that was read last, or the course's first one.\n\n"
    "Its figures are the window's picture, its sliders act on it; its bugs are put into a copy, no file"
    " is written. Next time it opens at the page where you were.",
    "playground lesson open",
    "playground lesson open diamond_square",
    "playground lesson open shadows --lang fr",
)
STATUS_HELP = help_text(
    "List the translations that are out of date.\n\n"
    "A translation holds a hash of each English block that it was made from. Listed are the blocks whose"
    " English has changed since, or is new. Exit status 1 where there are any.",
    "playground lesson status",
    "playground lesson status --json",
)
CHECK_HELP = help_text(
    "Check lessons: what they name, the rules of lessons, what they claim.\n\n"
    "Draws every deliberate bug, which must be visible, and computes every number, which must be as claimed."
    " Exit status 1 when anything is wrong.",
    "playground lesson check",
    "playground lesson check diamond_square shadows",
)
PICTURES_HELP = help_text(
    "Draw every picture of a lesson into a folder, as PNG.",
    "playground lesson pictures diamond_square -o pictures",
)
TRACE_HELP = help_text(
    "Print the traces of a lesson: the values of one texel beside the code, then the table of their loop.\n\n"
    "What a question asks for is printed as ?. In a pipe, the table's columns are separated by tabs.",
    "playground lesson trace shadows",
    "playground lesson trace shadows march --lang fr",
)
TRANSLATED_HELP = help_text(
    "Mark a translation as up to date with today's English.\n\n"
    "Writes the hashes of the English blocks into it. It must have as many blocks, of the same kinds.",
    "playground lesson translated diamond_square --lang fr",
)
BUILD_HELP = help_text(
    "Build the lessons as a book, a folder of pages that need no network, or as notebooks.\n\n"
    "In English and French, or in the language of --lang. Built again into the same folder, pages and"
    " pictures that no longer exist are removed, and nothing else is touched.",
    "playground lesson build -o book",
    "playground lesson build -o livre --lang fr",
    "playground lesson build diamond_square -o one-lesson",
    "playground lesson build diamond_square -o for-class --answers end",
    "playground lesson build --notebooks -o notebooks",
)


@app.command("list", help=LIST_HELP)
def list_(lang: Language = "", as_json: options.Json = False) -> None:
    """List the lessons, in their order."""
    from playground.course.read import summaries

    result = summaries(read_language(lang))
    if as_json:
        print_json([asdict(summary) for summary in result])
        return
    headings = ("", "lesson", "title", "reading", "exercises")
    rows = [
        (str(each.number), each.name, each.title, f"{each.minutes} min", f"{each.exercise_minutes} min")
        for each in result
    ]
    if not sys.stdout.isatty():
        print_rows([(*row, summary.part) for row, summary in zip(rows, result, strict=True)])
        return
    for part in dict.fromkeys(summary.part for summary in result):
        print_table(
            part, headings, [row for row, summary in zip(rows, result, strict=True) if summary.part == part]
        )


@app.command("open", help=OPEN_HELP)
def open_(
    ctx: typer.Context,
    name: Annotated[str, positional("NAME", "A lesson; the one read last by default.", complete_lesson)] = "",
    lang: Language = "",
    software: options.Software = False,
) -> None:
    """Open a lesson next to the live window."""
    from playground.course.document import read_document
    from playground.course.library import lesson_file

    language = read_language(lang)
    name = name or _lesson_read_last()
    sketch = str(read_document(lesson_file(name)).front.table.get("sketch", ""))
    renderer: Renderer = ctx.obj.or_else(software)
    check_display(renderer)
    open_window(sketch, None, renderer, request={"lesson": name, "language": language})


def _lesson_read_last() -> str:
    from playground.course.library import lesson_names
    from playground.course.window.progress import progress_file, read_progress

    names, last = lesson_names(), read_progress(progress_file()).lesson
    return last if last in names else names[0]


@app.command("status", help=STATUS_HELP)
def status(as_json: options.Json = False) -> None:
    """List the translations that are out of date."""
    from playground.course.library import LANGUAGES, SOURCE
    from playground.course.read import status_of, summaries

    names = [summary.name for summary in summaries(SOURCE)]
    statuses = [status_of(name, code) for code in LANGUAGES if code != SOURCE for name in names]
    if as_json:
        print_json([asdict(item) for item in statuses])
    else:
        rows = [(item.lesson, item.language, item.state, "; ".join(item.sentences)) for item in statuses]
        print_table("Translations", ("lesson", "language", "state", "what"), rows)
    if any(item.state != "current" for item in statuses):
        raise typer.Exit(FAILED)


@app.command("check", help=CHECK_HELP)
def check(ctx: typer.Context, names: NamesArgument = None, software: options.Software = False) -> None:
    """Check lessons: what they name, the rules of lessons, what they claim."""
    from playground.course.library import LANGUAGES
    from playground.course.read import read_lesson
    from playground.course.rules import broken_rules, wrong_pictures
    from playground.course.scenes import Sketches
    from playground.paths import shown

    chosen = _chosen(names)
    wrong, sketches = 0, Sketches()
    with ctx.obj.or_else(software).open_engine() as engine, progress("checking", len(chosen)) as advance:
        for name in chosen:
            for language in LANGUAGES:
                try:
                    lesson = read_lesson(name, language, sketches)
                except PlaygroundError as error:
                    wrong += len(error.diagnostics)
                    for diagnostic in error.diagnostics:
                        complain(str(diagnostic), diagnostic.severity)
                    continue
                problems = list(broken_rules(lesson))
                problems += wrong_pictures(engine, lesson) if language == "en" else []
                for line, sentence in problems:
                    complain(f"{shown(lesson.file)}:{line}: {language}: {sentence}")
                wrong += len(problems)
            advance()
    if wrong:
        note(f"{counted(wrong, 'thing')} to fix")
        raise typer.Exit(FAILED)
    print(painted(f"{counted(len(chosen), 'lesson')}: well", "32", sys.stdout))


@app.command("pictures", help=PICTURES_HELP)
def pictures(
    ctx: typer.Context,
    name: NameArgument,
    output: Annotated[Path, value("-o --output FOLDER", "The folder; this one by default.")] = Path(),
    software: options.Software = False,
) -> None:
    """Draw every picture of a lesson into a folder."""
    from playground.course.read import read_lesson
    from playground.course.scenes import draw, pictures_of
    from playground.data.image_files import write_png

    result = pictures_of(read_lesson(name))
    output.mkdir(parents=True, exist_ok=True)
    with ctx.obj.or_else(software).open_engine() as engine, progress("drawing", len(result)) as advance:
        for picture in result:
            path = output / f"{name}-{picture.name}.png"
            write_png(path, draw(engine, picture.scene).array)
            print(path)
            advance()


@app.command("trace", help=TRACE_HELP)
def trace(
    ctx: typer.Context,
    name: NameArgument,
    block: Annotated[str, positional("BLOCK", "One of its traces; all by default.")] = "",
    lang: Language = "",
    software: options.Software = False,
) -> None:
    """Print the traces of a lesson."""
    from playground.course.document import plain
    from playground.course.library import lesson_file
    from playground.course.measures import filled
    from playground.course.model import Trace
    from playground.course.read import read_lesson
    from playground.course.traces import numbers_in, traced

    lesson_file(name)  # says so where there is none
    lesson = read_lesson(name, read_language(lang))
    blocks = {each.name: each for each in lesson.blocks if isinstance(each, Trace)}
    if block and block not in blocks:
        hint = nearest(block, blocks) or "; it has none"
        raise SketchError(f"lesson {name} has no trace '{block}'{hint}")
    if not blocks:
        raise SketchError(f"lesson {name} has no trace")
    with ctx.obj.or_else(software).open_engine() as engine:
        for each in [blocks[block]] if block else blocks.values():
            lines = traced(engine, lesson, each)
            print(f"{each.name}: glsl/{lines.file}, texel {lines.texel}")
            print(lines.text())
            if lines.steps:
                rows = [[str(lines.steps[i]), *(lines.cell(c, i) for c in lines.columns)] for i in lines.rows]
                print_table("", [lines.loop, *lines.columns], rows)
            note(plain(filled(each.caption, numbers_in(lines), lesson.language)))


@app.command("build", help=BUILD_HELP)
def build(
    ctx: typer.Context,
    names: NamesArgument = None,
    output: Annotated[Path, value("-o --output FOLDER", "The folder of the book; book by default.")] = Path(
        "book"
    ),
    lang: Annotated[
        str,
        value("--lang CODE", "Language: en or fr; both by default.", complete_language),
    ] = "",
    answers: Annotated[
        str,
        value("--answers PLACE", "Answers: inline, folded under their questions; end of the page; or none."),
    ] = "inline",
    notebooks: Annotated[bool, flag("--notebooks", "Write Jupyter notebooks, not pages.")] = False,
    software: options.Software = False,
) -> None:
    """Build the lessons as a book, or as notebooks."""
    from playground.course.book.build import prepare, write_book
    from playground.course.book.html import ANSWERS
    from playground.course.library import LANGUAGES
    from playground.course.read import read_lessons

    if answers not in ANSWERS:
        raise ParameterError(f"--answers {answers}: expected {either(ANSWERS)}{nearest(answers, ANSWERS)}")
    languages = [read_language(lang)] if lang else list(LANGUAGES)
    chosen = _chosen(names)
    lessons = {code: [lesson for lesson in read_lessons(code) if lesson.name in chosen] for code in languages}
    if notebooks:
        with ctx.obj.or_else(software).open_engine() as engine:
            _write_notebooks(output, lessons, engine)
        return
    made = prepare(output, lessons, gallery=not names, answers=answers)
    with ctx.obj.or_else(software).open_engine() as engine, progress("drawing", len(made.names)) as advance:
        front = write_book(made, engine, advance)
    print(front)


@app.command("translated", help=TRANSLATED_HELP)
def translated(
    name: NameArgument,
    lang: Annotated[str, value("--lang CODE", "Language of the translation: fr.", complete_language)] = "",
) -> None:
    """Mark a translation as up to date with today's English."""
    from playground.course.document import read_document
    from playground.course.library import SOURCE, lesson_file
    from playground.course.read import mark, read_lesson
    from playground.paths import shown

    if not lang or lang == SOURCE:
        raise SketchError("name the translation: --lang fr")
    path = lesson_file(name, lang)
    mark(read_lesson(name), read_document(lesson_file(name)), read_document(path), lang)
    print(shown(path))


def _write_notebooks(folder: Path, lessons: dict[str, list[Lesson]], engine: Engine) -> None:
    from playground.course.notebook.build import notebook_text
    from playground.course.traces import results_of
    from playground.files import write_file

    names = {lesson.name for chosen in lessons.values() for lesson in chosen}
    for in_languages in zip(*lessons.values(), strict=True):
        results = results_of(engine, in_languages[0])
        for lesson in in_languages:
            path = folder / lesson.language / f"{lesson.name}.ipynb"
            path.parent.mkdir(parents=True, exist_ok=True)
            write_file(path, notebook_text(lesson, results, names))
            print(path)


def _chosen(names: list[str] | None) -> list[str]:
    from playground.course.library import SOURCE, lesson_file
    from playground.course.read import summaries

    for name in names or []:
        lesson_file(name)  # raises with the list of lessons
    return names or [summary.name for summary in summaries(SOURCE)]


def add_to(line: typer.Typer) -> None:
    """Add the room's commands to a command line."""
    line.add_typer(app)
