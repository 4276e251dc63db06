"""Hand out the exercises of lessons as a zip."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from playground.commands import options
from playground.commands.arguments import Renderer, check_parent, help_text
from playground.commands.options import flag, positional, value
from playground.course.options import Language, complete_lesson, read_language
from playground.errors import DataError, counted
from playground.terminal import note, progress

HELP = help_text(
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
    from playground.course.handout.pack import count_tasks, read_wheel, write_handout
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
    renderer: Renderer = ctx.obj.or_else(software)
    with renderer.open_engine() as engine, progress("drawing", count_tasks(lessons)) as advance:
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
