"""Expensive land that is kept on disk: say what there is, and remove it."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import typer

from playground.commands.arguments import JsonOption, help_text
from playground.errors import counted
from playground.terminal import print_json, print_table

if TYPE_CHECKING:
    from playground.engine.disk_cache import Listed

HELP = help_text(
    "Expensive land that live keeps on disk, so that a sketch reopens at once.\n\n"
    "It is found by what it was made from (texts, values, files, the renderer's build), so none of it is ever"
    " out of date, and to remove it costs nothing but time. At most 1 GiB is kept, what was used last;"
    " the environment variable PLAYGROUND_CACHE says another size, as 500M, or 0 to keep nothing.",
    "playground cache show",
    "playground cache clear",
    "PLAYGROUND_CACHE=4G playground live my-land",
)
SHOW_HELP = help_text(
    "Say where land is kept, how much there is, and of which passes; what was used last comes first.",
    "playground cache show",
    "playground cache show --json",
)
CLEAR_HELP = help_text(
    "Remove all land that is kept; other files of the cache folder stay.\n\n"
    "Windows that are open lose nothing, and go on keeping what they make.",
    "playground cache clear",
)

app = typer.Typer(
    name="cache",
    help=HELP,
    short_help="Show or remove the expensive land that is kept on disk.",
    invoke_without_command=True,
    rich_markup_mode="rich",
)


@app.callback()
def _group(ctx: typer.Context) -> None:
    if ctx.invoked_subcommand is None:
        print(ctx.get_help())


@app.command("show", help=SHOW_HELP)
def show(as_json: JsonOption = False) -> None:
    """Say where land is kept, how much there is, and of which passes."""
    from playground.engine.disk_cache import limit_in, listed, place

    folder, limit = place(), limit_in()
    found = listed(folder)
    if as_json:
        print_json(_as_json(str(folder), limit, found))
        return
    print(kept_text(str(folder), len(found), sum(each.bytes for each in found), limit))
    if found:
        headings = ("sketch: pass", "texels", "size", "made in", "used")
        print_table("Land that is kept, used last first", headings, [_row(each) for each in found])


@app.command("clear", help=CLEAR_HELP)
def clear_() -> None:
    """Remove all land that is kept."""
    from playground.engine.disk_cache import clear, place

    number, size = clear(place())
    print(f"{counted(number, 'file')} removed, {in_bytes(size)}")


def kept_text(folder: str, number: int, size: int, limit: int) -> str:
    """Return in words how much is kept, of how much, and where."""
    bound = f"of at most {in_bytes(limit)}" if limit else "(PLAYGROUND_CACHE has nothing kept)"
    return f"{counted(number, 'file')}, {in_bytes(size)} {bound}, in {folder}"


def in_bytes(size: int) -> str:
    """Return a size in words, as "1.5 GiB"."""
    if size < 1000:
        return counted(size, "byte")
    number, unit = float(size), ""
    for larger in ("KiB", "MiB", "GiB", "TiB"):
        if number < 1000:
            break
        number, unit = number / 1024, larger
    return f"{number:.0f} {unit}" if number >= 100 else f"{number:.1f} {unit}"


def _row(each: Listed) -> tuple[str, ...]:
    ago = _ago(max(time.time() - each.used, 0.0))
    if each.kept is None:
        return "(damaged)", "", in_bytes(each.bytes), "", ago
    width, height = each.kept.size
    cost = f"{each.kept.cost:.0f} ms" if each.kept.cost < 1000 else f"{each.kept.cost / 1e3:.1f} s"
    return each.kept.made_for, f"{width}x{height}", in_bytes(each.bytes), cost, ago


def _ago(seconds: float) -> str:
    for unit, length in (("day", 86400), ("hour", 3600), ("minute", 60)):
        if seconds >= length:
            return f"{counted(int(seconds // length), unit)} ago"
    return "just now"


def _as_json(folder: str, limit: int, found: list[Listed]) -> dict[str, object]:
    files = [
        {
            "file": each.path.name,
            "bytes": each.bytes,
            "used": each.used,
            "made_for": each.kept.made_for if each.kept else None,
            "size": list(each.kept.size) if each.kept else None,
            "outputs": dict(each.kept.outputs) if each.kept else None,
            "cost_ms": each.kept.cost if each.kept else None,
        }
        for each in found
    ]
    total = sum(each.bytes for each in found)
    return {"folder": folder, "bytes": total, "most_bytes": limit, "files": files}
