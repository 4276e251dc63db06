"""Lessons: list them, check them, keep translations up to date."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from playground.commands import options
from playground.commands.arguments import FAILED, Renderer, command_group, either, help_text
from playground.commands.live import check_display, open_window
from playground.commands.options import flag, positional, value
from playground.course.grading.commands import HELP as GRADE_HELP
from playground.course.grading.commands import grade
from playground.course.handout.commands import HELP as HANDOUT_HELP
from playground.course.handout.commands import handout
from playground.course.options import Language, complete_language, complete_lesson, read_language
from playground.course.talk.commands import HELP as PRESENT_HELP
from playground.course.talk.commands import present
from playground.errors import ParameterError, PlaygroundError, SketchError, counted, nearest
from playground.terminal import complain, note, painted, print_json, print_rows, print_table, progress

if TYPE_CHECKING:
    from playground.course.model import Lesson
    from playground.course.read import Summary
    from playground.engine.engine import Engine

HELP = help_text(
    "Lessons on terrain, to read next to the window, in a browser or as notebooks.",
    "playground lesson list",
    "playground lesson open diamond_square",
    "playground lesson build -o book",
    "playground lesson status",
)
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

app = command_group("lesson", HELP, "Lessons on terrain: read them, build them as a book or notebooks.")

app.command("handout", help=HANDOUT_HELP)(handout)
app.command("grade", help=GRADE_HELP)(grade)
app.command("present", help=PRESENT_HELP)(present)

NameArgument = Annotated[str, positional("NAME", "A lesson.", complete_lesson)]
NamesArgument = Annotated[list[str] | None, positional("NAME", "Lessons; all by default.", complete_lesson)]


@app.command("list", help=LIST_HELP)
def list_(lang: Language = "", as_json: options.Json = False) -> None:
    """List the lessons, in their order."""
    from playground.course.read import summaries

    result = summaries(read_language(lang))
    if as_json:
        print_json([asdict(summary) for summary in result])
        return
    headings = ("", "lesson", "title", "reading", "exercises")
    rows = [_row(summary) for summary in result]
    if not sys.stdout.isatty():
        print_rows([(*row, summary.part) for row, summary in zip(rows, result, strict=True)])
        return
    for part in dict.fromkeys(summary.part for summary in result):
        print_table(
            part, headings, [row for row, summary in zip(rows, result, strict=True) if summary.part == part]
        )


def _row(summary: Summary) -> tuple[str, ...]:
    return (
        str(summary.number),
        summary.name,
        summary.title,
        f"{summary.minutes} min",
        f"{summary.exercise_minutes} min",
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
    from playground.course.contents import lesson_names
    from playground.course.window.progress import progress_file, read_progress

    names, last = lesson_names(), read_progress(progress_file()).lesson
    return last if last in names else names[0]


@app.command("status", help=STATUS_HELP)
def status(as_json: options.Json = False) -> None:
    """List the translations that are out of date."""
    from playground.course.library import LANGUAGES, SOURCE
    from playground.course.read import summaries
    from playground.course.translate import status_of

    names = [summary.name for summary in summaries(SOURCE)]
    statuses = [status_of(name, code) for code in LANGUAGES if code != SOURCE for name in names]
    if as_json:
        print_json([item.as_json() for item in statuses])
    else:
        rows = [(item.name, item.language, item.state, "; ".join(item.sentences)) for item in statuses]
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
    with _engine(ctx, software) as engine, progress("checking", len(chosen)) as advance:
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
    from playground.course.figure_renders import draw, pictures_of
    from playground.course.read import read_lesson
    from playground.data.image_files import write_png

    result = pictures_of(read_lesson(name))
    output.mkdir(parents=True, exist_ok=True)
    with _engine(ctx, software) as engine, progress("drawing", len(result)) as advance:
        for picture in result:
            path = output / f"{name}-{picture.name}.png"
            write_png(path, draw(engine, picture.scene).array)
            print(path)
            advance()


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
    from playground.course.book.blocks import ANSWERS
    from playground.course.book.build import prepare, write_book
    from playground.course.library import LANGUAGES
    from playground.course.read import read_lessons

    if answers not in ANSWERS:
        raise ParameterError(f"--answers {answers}: expected {either(ANSWERS)}{nearest(answers, ANSWERS)}")
    languages = [read_language(lang)] if lang else list(LANGUAGES)
    chosen = _chosen(names)
    lessons = {code: [lesson for lesson in read_lessons(code) if lesson.name in chosen] for code in languages}
    if notebooks:
        with _engine(ctx, software) as engine:
            _write_notebooks(output, lessons, engine)
        return
    made = prepare(output, lessons, gallery=not names, answers=answers)
    with _engine(ctx, software) as engine, progress("drawing", len(made.names)) as advance:
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
    from playground.course.read import read_lesson
    from playground.course.translate import mark
    from playground.paths import shown

    if not lang or lang == SOURCE:
        raise SketchError("name the translation: --lang fr")
    path = lesson_file(name, lang)
    mark(read_lesson(name), read_document(lesson_file(name)), read_document(path), lang)
    print(shown(path))


def _write_notebooks(folder: Path, lessons: dict[str, list[Lesson]], engine: Engine) -> None:
    from playground.course.measuring import numbers_of
    from playground.course.notebook.build import notebook_text
    from playground.files import write_file

    names = {lesson.name for chosen in lessons.values() for lesson in chosen}
    for in_languages in zip(*lessons.values(), strict=True):
        numbers = numbers_of(engine, in_languages[0])
        for lesson in in_languages:
            path = folder / lesson.language / f"{lesson.name}.ipynb"
            path.parent.mkdir(parents=True, exist_ok=True)
            write_file(path, notebook_text(lesson, numbers, names))
            print(path)


def _chosen(names: list[str] | None) -> list[str]:
    from playground.course.library import SOURCE, lesson_file
    from playground.course.read import summaries

    for name in names or []:
        lesson_file(name)  # raises with the list of lessons
    return names or [summary.name for summary in summaries(SOURCE)]


def _engine(ctx: typer.Context, software: bool) -> Engine:
    renderer: Renderer = ctx.obj.or_else(software)
    return renderer.open_engine()


def add_to(line: typer.Typer) -> None:
    """Add the room's commands to a command line."""
    line.add_typer(app)
