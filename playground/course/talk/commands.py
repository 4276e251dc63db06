"""Present a lesson to a class, in the window or as a film."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from playground.commands import options
from playground.commands.arguments import Renderer, help_text, read_pixels
from playground.commands.live import check_display, open_window
from playground.commands.options import flag, positional, value
from playground.course.options import Language, complete_lesson, read_language
from playground.errors import ParameterError
from playground.terminal import note, progress

if TYPE_CHECKING:
    from playground.course.model import Lesson

HELP = help_text(
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


def present(
    ctx: typer.Context,
    name: Annotated[str, positional("NAME", "A lesson.", complete_lesson)],
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
    renderer, pixels = ctx.obj.or_else(software), read_pixels(size)
    if video:
        _film(lesson, beat, video, pixels, renderer, subtitles=not no_notes)
        return
    check_display(renderer)
    from playground.course.talk.stage import Presenting

    presenting = Presenting(beat, notes=not no_notes, say=note)
    request = {"lesson": name, "language": lesson.language, "present": presenting}
    open_window(lesson.sketch, pixels, renderer, request=request)


def _film(
    lesson: Lesson,
    first: int,
    video: str,
    size: tuple[int, int] | None,
    renderer: Renderer,
    *,
    subtitles: bool,
) -> None:
    """Write the film, and print the paths of what was written."""
    from playground.course.talk.film import film_of, write_presentation

    film = film_of(lesson, Path(video).expanduser(), size or FILM_SIZE, first=first - 1)
    film.check()
    with renderer.open_engine() as engine, progress(f"filming {lesson.name}", len(film.beats)) as done:
        for path in write_presentation(engine, film, subtitles=subtitles, done=done, notice=note):
            print(path)
