"""Shots, the pictures that sketches promise: list them, look at results, accept pictures among them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from playground.commands import options
from playground.commands.arguments import command_group, help_text, read_option, within
from playground.commands.options import complete_sketch, flag, positional, value
from playground.errors import PlaygroundError
from playground.terminal import complain, note, print_json, print_table
from playground.verify.commands import mutants

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

app = command_group("shots", HELP, "List the pictures that sketches promise, and see to their references.")

MISTAKE = 2
"""Exit status where a picture was refused."""

REPORT_HELP = help_text(
    "Make one HTML file of the results of screenshot tests.\n\n"
    "Everything is inside, so that it can be sent, and opened with no network. Prints its path.",
    "playground shots report",
    "playground shots report ~/Downloads/shots-report -o report.html",
)
ACCEPT_HELP = help_text(
    "Make references of pictures that were drawn.\n\n"
    "Takes shots that failed, by name or with * and ?. A picture replaces the references of its shot;"
    " with --also they stay, and it is a further one that may match. Broken pictures (blank, with"
    " values that are no numbers) are refused, and so is one whose reference has changed since.",
    "playground shots accept hills/dawn",
    "playground shots accept 'hills/*' --also",
    "playground shots accept ~/Downloads/shots-report --all",
)
REVIEW_HELP = help_text(
    "Look at results in the browser, and accept pictures there.\n\n"
    "A page on this machine alone; its address holds a secret, so keep that to yourself."
    " Ends with Ctrl+C or the page's Done.",
    "playground shots review",
    "playground shots review out/shots --no-open --port 8000",
)

FolderArgument = Annotated[
    Path | None,
    positional("DIR", "The folder of results, as --shots-output of pytest named it (default: shots-report)."),
]
LIST_HELP = help_text(
    "List shots, their sizes, and whether there is a reference.\n\n"
    "Without a sketch, those of all sketches that ship. In a pipe, the columns are separated by tabs.",
    "playground shots list",
    "playground shots list jacksboro my-land/sketch.toml",
    "playground shots list jacksboro --json",
)
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


@app.command(help=REPORT_HELP)
def report(
    folder: FolderArgument = None,
    output: Annotated[
        Path | None, value("-o --output FILE", "The file to write (default: index.html in DIR).")
    ] = None,
) -> None:
    """Make one HTML file of the results of screenshot tests."""
    from playground.verify.shots.report import write_report
    from playground.verify.shots.results import FOLDER

    print(write_report(folder or Path(FOLDER), output))


@app.command(help=REVIEW_HELP)
def review(
    folder: FolderArgument = None,
    port: Annotated[str, value("--port PORT", "Listen on this port; without it, on a free one.")] = "",
    opened: Annotated[bool, typer.Option("--open/--no-open", help="Open the page in the browser.")] = True,
) -> None:
    """Look at results in the browser, and accept pictures there."""
    import webbrowser

    from playground.verify.shots.results import FOLDER
    from playground.verify.shots.review import Review

    number = read_option("--port", port, within(0, 65535), "a port, 0 to 65535; 0 takes a free one") or 0
    with Review(folder or Path(FOLDER), number) as server:
        print(server.url, flush=True)
        note("Ctrl+C, or Done on the page, ends it")
        if opened and not webbrowser.open(server.url):
            note("no browser could be opened: open the address above yourself")
        try:
            server.serve()
        except KeyboardInterrupt:
            note("")
        for line in server.summary():
            note(line)


@app.command(help=ACCEPT_HELP)
def accept(
    shots: Annotated[
        list[str] | None,
        positional(
            "[DIR] SHOT...",
            "Shots, as sketch/shot, or with * and ?; before them, the folder of results if it is"
            " not shots-report.",
        ),
    ] = None,
    everything: Annotated[bool, flag("--all", "Every shot that failed and can be accepted.")] = False,
    also: Annotated[bool, flag("--also", "Keep the references that are there; add this one.")] = False,
) -> None:
    """Make references of pictures that were drawn."""
    from playground.verify.shots.accept import accept as accept_one
    from playground.verify.shots.accept import choose
    from playground.verify.shots.results import read_results
    from playground.verify.shots.verdicts import verdict_on

    folder, patterns = _folder_and_shots(shots or [])
    if everything == bool(patterns):
        raise typer.BadParameter("expected the names of shots, or --all")
    records = read_results(folder)
    chosen = [record for record in records if not record.ok] if everything else choose(records, patterns)
    if not chosen:
        note("every shot passed: there is nothing to accept")
    refused = 0
    for record in chosen:
        try:
            change = accept_one(folder, record, also=also)
        except PlaygroundError as error:
            if everything and not verdict_on(record.word).acceptable:
                note(f"left as it is: {error}")
                continue
            refused += 1
            complain(str(error))
            continue
        for line in change.messages:
            print(line)
    if refused:
        raise typer.Exit(MISTAKE)


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


def _folder_and_shots(names: list[str]) -> tuple[Path, list[str]]:
    """Split the folder, which may come first, from the shots."""
    from playground.verify.shots.results import FOLDER

    # A folder that is there, unless a result has that very name.
    if names and Path(names[0]).is_dir() and not (Path(FOLDER) / f"{names[0]}.json").is_file():
        return Path(names[0]), names[1:]
    return Path(FOLDER), names
