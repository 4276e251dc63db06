"""GLSL libraries that shaders include by name: name their folders, list them, forget them."""

from __future__ import annotations

from typing import Annotated

from playground.commands import options
from playground.commands.arguments import command_group, help_text
from playground.commands.options import positional
from playground.terminal import note, print_json, print_table

HELP = help_text(
    'GLSL libraries on this computer that shaders include by name, as #include "lygia/math/const.glsl".\n\n'
    "Name a library's folder once; every sketch finds it from then on. No library ships with the playground,"
    " and none is packed. The environment variable PLAYGROUND_LIBRARIES names more, as lygia=FOLDER,"
    " separated as in PATH.",
    "playground library add lygia ~/lygia",
    "playground library list",
    "playground library remove lygia",
)
ADD_HELP = help_text(
    "Remember the folder of a library by the name that its includes begin with.\n\n"
    "A name that is known gets the new folder. The folder stays where it is, and is only read.",
    "playground library add lygia ~/lygia",
)
LIST_HELP = help_text(
    "List the libraries that were named, and their folders.",
    "playground library list",
    "playground library list --json",
)
REMOVE_HELP = help_text(
    "Forget a library that was named; its folder stays.", "playground library remove lygia"
)

app = command_group("library", HELP, "Name the folders of GLSL libraries that shaders include.")

Name = Annotated[str, positional("NAME", "What its includes begin with, as lygia.")]


@app.command("add", help=ADD_HELP)
def add(name: Name, folder: Annotated[str, positional("FOLDER", "The library's own folder.")]) -> None:
    """Remember the folder of a library."""
    from playground.shader.libraries import add_library

    path = add_library(name, folder)
    print(path)
    note(f'#include "{name}/…" is found there from now on')


@app.command("list", help=LIST_HELP)
def list_(as_json: options.Json = False) -> None:
    """List the libraries that were named."""
    from playground.shader.libraries import how_to_name, libraries

    paths = libraries()
    if as_json:
        print_json({name: str(folder) for name, folder in paths.items()})
        return
    rows = [(name, str(folder), "" if folder.is_dir() else "is gone") for name, folder in paths.items()]
    if rows:
        print_table("Libraries", ("name", "folder", ""), rows)
    else:
        note(f"no library is named; {how_to_name('NAME')} names one")


@app.command("remove", help=REMOVE_HELP)
def remove(name: Name) -> None:
    """Forget a library."""
    from playground.shader.libraries import remove_library

    remove_library(name)
    note(f"{name} is no longer looked for")
