"""List sketches, techniques and their parameters."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated

from playground.commands import options
from playground.commands.arguments import help_text
from playground.commands.options import complete_listed, positional
from playground.errors import SketchError
from playground.terminal import note, painted, print_indented, print_json, print_rows, print_table

if TYPE_CHECKING:
    from playground.commands.entries import Choice, Entry


HELP = help_text(
    "List sketches and techniques, or the parameters of one.\n\n"
    "WHAT is sketches, techniques, a folder of techniques, or the name or path of one sketch or"
    " technique. In a pipe, the columns are separated by tabs.",
    "playground list",
    "playground list jacksboro",
    "playground list generation",
    "playground list lighting/l_dot_n --json",
)


def list_(
    what: Annotated[str, positional("WHAT", "What to list; everything by default.", complete_listed)] = "",
    as_json: options.Json = False,
) -> None:
    """List sketches, techniques, parameters."""
    from playground.commands import entries

    sketches = entries.sketches() if what in ("", "sketches") else []
    techniques = entries.techniques() if what in ("", "techniques") else []
    named = entries.entries_named(what) if what not in ("", "sketches", "techniques") else []
    if as_json:
        groups = {"sketches": sketches, "techniques": techniques}
        for entry in named:
            groups["sketches" if entry.kind == "sketch" else "techniques"].append(entry)
        table = {group: [entry.as_json() for entry in items] for group, items in groups.items()}
        print_json(table)
        return
    if len(named) == 1:
        _print_entry(named[0])
        return
    if sketches:
        rows = [(e.name, ", ".join(e.shots), e.error or e.title) for e in sketches]
        print_table("Sketches (playground render NAME)", ("name", "shots", "what"), rows)
    if sketches and techniques and sys.stdout.isatty():
        print()
    if techniques or named:
        rows = [(e.name, ", ".join(e.outputs), e.error or e.title) for e in techniques or named]
        print_table('Techniques (use = "NAME")', ("name", "gives", "what"), rows)


def _print_entry(entry: Entry) -> None:
    if entry.error:
        raise SketchError(entry.error)
    if sys.stdout.isatty():
        print(f"{entry.name}: {entry.title}" if entry.title else entry.name)
        about = {
            "passes" if entry.kind == "sketch" else "gives": entry.outputs,
            "needs": entry.inputs,
            "shots": entry.shots,
            "presets": entry.presets,
        }
        for label, names in about.items():
            if names:
                print(f"  {label}: {', '.join(names)}")
        print()
    if not entry.parameters:
        note(f"{entry.name} has no parameters")
        return
    if not sys.stdout.isatty():
        print_rows(
            [
                (c.path, c.parameter.type, c.text, c.range, c.parameter.unit, _what(c))
                for c in entry.parameters
            ]
        )
        return
    width = max(len(choice.path) for choice in entry.parameters)
    for choice in entry.parameters:
        limits = " ".join(filter(None, (choice.range, choice.parameter.unit)))
        facts = [choice.parameter.type, choice.text, f"({limits})" if limits else ""]
        print(painted(f"{choice.path:<{width}}", "1", sys.stdout), "  ".join(filter(None, facts)), sep="  ")
        print_indented(_what(choice))


def _what(choice: Choice) -> str:
    return choice.parameter.tooltip or choice.parameter.title
