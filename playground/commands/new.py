"""Make a new sketch folder."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from playground.commands.arguments import help_text, quoted
from playground.commands.options import positional
from playground.terminal import note

HELP = help_text(
    "Make a folder with a sketch and a kernel of your own.\n\nIt never overwrites anything.",
    "playground new my-land",
    "playground live my-land",
)


def new(
    name: Annotated[
        str,
        positional("NAME", "The folder to make; letters, digits, - and _."),
    ],
) -> None:
    """Make a new sketch folder."""
    from playground.templates import make_sketch

    folder = make_sketch(Path(name).expanduser())
    for path in sorted(folder.iterdir()):
        print(path)
    shell = quoted(str(folder))
    note(
        f"next: playground live {shell}     opens it; edit {folder / 'my_land.glsl'}, save, and look\n"
        f"      playground render {shell}   makes a PNG\n"
        f"      playground check {shell}    reports what is wrong with it, if anything"
    )
