"""Shots, the pictures that sketches promise: list them, and what else there is to do with them.

One command a file where it is more than a few lines; here they are gathered.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

from playground.commands import options
from playground.commands.arguments import command_group, help_text
from playground.commands.options import complete_sketch, positional
from playground.terminal import print_json, print_table
from playground.verify.commands import mutants, shots_results

if TYPE_CHECKING:
    from playground.sketch.model import Sketch

HELP = help_text(
    "The pictures that sketches promise, and the references that they are compared with.\n\n"
    "pytest compares them, and leaves its results in a folder; here they are listed, looked at and accepted.",
    "playground shots list jacksboro",
    "playground shots mutants --again 200",
    "playground shots list --json | jq '.[] | select(.references == {})'",
    "playground shots review",
)
LIST_HELP = help_text(
    "List shots, their sizes, and whether there is a reference.\n\n"
    "Without a sketch, those of all sketches that ship. In a pipe, the columns are separated by tabs.",
    "playground shots list",
    "playground shots list jacksboro my-land/sketch.toml",
    "playground shots list jacksboro --json",
)

app = command_group("shots", HELP, "List the pictures that sketches promise, and see to their references.")

SketchesArgument = Annotated[
    list[str] | None,
    positional(
        "SKETCH",
        "Shipped sketches by name, or paths of sketches, of their folders, or of shaders.",
        complete_sketch,
    ),
]


@app.command("list", help=LIST_HELP)
def list_(sketches: SketchesArgument = None, as_json: options.Json = False) -> None:
    """List shots, their sizes, and whether there is a reference."""
    from playground.sketch.find import shipped_sketches
    from playground.sketch.load import load_with
    from playground.sketch.techniques import Techniques

    techniques = Techniques()  # most sketches share theirs
    rows = [row for name in sketches or shipped_sketches() for row in _rows(load_with(techniques, name))]
    if as_json:
        print_json(rows)
        return
    table = []
    for row in rows:
        width, height = row["size"]
        summaries = [
            name if len(files) == 1 else f"{name} ({len(files)})" for name, files in row["references"].items()
        ]
        table.append((row["sketch"], row["shot"], f"{width}x{height}", ", ".join(summaries) or "missing"))
    print_table(
        "Shots (playground render SKETCH --shot SHOT)", ("sketch", "shot", "size", "references"), table
    )


app.command("report", help=shots_results.REPORT_HELP)(shots_results.report)
app.command("review", help=shots_results.REVIEW_HELP)(shots_results.review)
app.command("accept", help=shots_results.ACCEPT_HELP)(shots_results.accept)
app.command("mutants", help=mutants.HELP)(mutants.mutants)


def _rows(sketch: Sketch) -> list[dict[str, Any]]:
    """Describe each shot, as JSON takes it."""
    from playground.errors import DataError
    from playground.paths import shown
    from playground.sketch.find import home_of
    from playground.verify.shots.references import accepted

    try:
        home = home_of(sketch) / sketch.name
    except DataError:  # a sketch that ships, in an installed package: its references are in the repository
        renderers = []
    else:
        renderers = sorted(path.name for path in home.glob("*") if path.is_dir())
    rows: list[dict[str, Any]] = []
    for shot in sketch.shots:
        references = {name: [shown(p) for p in accepted(sketch, shot.name, name)] for name in renderers}
        rows.append(
            {
                "sketch": sketch.name,
                "file": shown(sketch.file),
                "shot": shot.name,
                "size": list(shot.size),
                "references": {name: files for name, files in references.items() if files},
            }
        )
    return rows
