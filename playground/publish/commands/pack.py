"""Pack a sketch into one file to share."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from playground.commands import options
from playground.commands.arguments import help_text, output_file
from playground.commands.options import value
from playground.errors import DataError, counted
from playground.terminal import busy, note

if TYPE_CHECKING:
    from playground.sketch.model import Sketch

HELP = help_text(
    "Put a sketch with all that it needs into one zip, and print its path.\n\n"
    "In it are the sketch, its kernels and includes, its images and elevation files, its references, and a"
    " README and a licence. What ships with the playground is not: only its names and the version."
    " Nor is a library of your own (playground library): its licence may forbid to pass it on."
    " The zip opens wherever a sketch does. A window opens a copy in its folder, for edits; the zip stays.",
    "playground pack my-land",
    "playground pack my-land -o lesson-3.zip",
    "playground live lesson-3.zip",
    "playground render lesson-3.zip -o terrain.png",
)


def pack(
    sketch: options.Sketch = "",
    output: Annotated[
        str, value("-o --output FILE", "The zip to write. Without it, a new name in this folder.")
    ] = "",
) -> None:
    """Pack a sketch into one zip."""
    from playground.publish import pack as packing
    from playground.shader.libraries import how_to_name, libraries_of
    from playground.sketch.find import ENDING, read_pack, summary
    from playground.sketch.load import load

    loaded = load(sketch)
    usual = f"{loaded.name}{ENDING}"
    with output_file(output, usual, (ENDING,), "a pack is") as path, busy(f"packing {loaded.name}"):
        packing.pack(loaded, path, _references(loaded))
    print(path)
    packed = read_pack(path)
    note(summary(packed))
    for name in packed.manifest.libraries:
        files = len(libraries_of(loaded.files)[name])
        note(
            f"without {counted(files, 'file')} of the library {name}, whose licence may forbid to pass it on:"
            f" to open the pack, name a folder of it, as {how_to_name(name)}"
        )


def _references(sketch: Sketch) -> Iterator[tuple[Path, str]]:
    """Yield the sketch's reference pictures, and where they go in its folder."""
    from playground.paths import SCREENSHOTS
    from playground.sketch.find import home_of

    try:
        home = home_of(sketch)
    except DataError:  # an installed package has none for what it ships
        return
    for path in sorted((home / sketch.name).glob("*/*.png")):
        if path.is_file() and not path.is_symlink():
            yield path, f"{SCREENSHOTS}/{path.relative_to(home).as_posix()}"
