"""Make a new sketch folder."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from playground.commands.arguments import help_text
from playground.commands.options import flag, positional
from playground.paths import program, quoted
from playground.terminal import note

HELP = help_text(
    "Make a folder with a sketch and a kernel of your own.\n\nIt never overwrites anything. With --empty"
    " the kernel gives the height 0 everywhere, and all the rest is yours to write, as in the first lesson.",
    "playground new my-land",
    "playground live my-land",
    "playground new first --empty",
)


def new(
    name: Annotated[
        str,
        positional("NAME", "The folder to make; letters, digits, - and _."),
    ],
    empty: Annotated[bool, flag("--empty", "An empty kernel of heights, to be written.")] = False,
) -> None:
    """Make a new sketch folder."""
    from playground.sketch.templates import make_sketch

    folder = make_sketch(Path(name).expanduser(), empty=empty)
    made = sorted(folder.iterdir())
    for path in made:
        print(path)
    kernel = next(path for path in made if path.suffix == ".glsl")
    shell = quoted(str(folder))
    note(
        f"next: {program()} live {shell}     opens it; edit {kernel}, save, and look\n"
        f"      {program()} render {shell}   makes a PNG\n"
        f"      {program()} check {shell}    reports its errors, if any"
    )
