"""Expensive terrain that is cached on disk: list it, and remove it."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from playground.commands import options
from playground.commands.arguments import command_group, help_text
from playground.errors import counted
from playground.terminal import print_json, print_table

if TYPE_CHECKING:
    from playground.engine.disk_cache import Listed

HELP = help_text(
    "Expensive terrain that live caches on disk, so that a sketch reopens at once.\n\n"
    "It is found by what it was made from (texts, values, files, the renderer's build), so none of it is ever"
    " out of date, and to remove it costs nothing but time. At most 1 GiB is cached, what was used last;"
    " the environment variable PLAYGROUND_CACHE sets another size, as 500M, or 0 to cache nothing.",
    "playground cache show",
    "playground cache clear",
    "PLAYGROUND_CACHE=4G playground live my-land",
)
SHOW_HELP = help_text(
    "Show where terrain is cached, how much there is, and of which passes; the last used comes first.",
    "playground cache show",
    "playground cache show --json",
)
CLEAR_HELP = help_text(
    "Remove all cached terrain; other files of the cache folder stay.\n\n"
    "Windows that are open lose nothing, and go on caching what they compute.",
    "playground cache clear",
)

app = command_group("cache", HELP, "Show or remove the expensive terrain that is cached on disk.")


@app.command("show", help=SHOW_HELP)
def show(as_json: options.Json = False) -> None:
    """Show where terrain is cached, how much there is, and of which passes."""
    from playground.engine.disk_cache import cache_directory, limit_in, listed

    folder, limit = cache_directory(), limit_in()
    entries = listed(folder)
    total: dict[str, Any] = {
        "folder": str(folder),
        "bytes": sum(each.bytes for each in entries),
        "most_bytes": limit,
    }
    if as_json:
        print_json({**total, "files": [_as_json(each) for each in entries]})
        return
    print(usage_text(**total, files=len(entries)))
    if entries:
        headings = ("sketch: pass", "texels", "size", "computed in", "used")
        print_table("Cached terrain, used last first", headings, [_row(each) for each in entries])


@app.command("clear", help=CLEAR_HELP)
def clear_() -> None:
    """Remove all cached terrain."""
    from playground.engine.disk_cache import cache_directory, clear

    number, size = clear(cache_directory())
    print(f"{counted(number, 'file')} removed, {in_bytes(size)}")


def usage_text(*, folder: str, files: int, bytes: int, most_bytes: int) -> str:
    """Describe how much is cached, of how much, and where."""
    bound = f"of at most {in_bytes(most_bytes)}" if most_bytes else "(PLAYGROUND_CACHE turns caching off)"
    return f"{counted(files, 'file')}, {in_bytes(bytes)} {bound}, in {folder}"


def in_bytes(size: int) -> str:
    """Format a size, as "1.5 GiB"."""
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
    if each.textures is None:
        return "(damaged)", "", in_bytes(each.bytes), "", ago
    (width, height), cost = each.textures.size, each.textures.cost
    taken = f"{cost:.0f} ms" if cost < 1000 else f"{cost / 1e3:.1f} s"
    return each.textures.made_for, f"{width}x{height}", in_bytes(each.bytes), taken, ago


def _ago(seconds: float) -> str:
    for unit, length in (("day", 86400), ("hour", 3600), ("minute", 60)):
        if seconds >= length:
            return f"{counted(int(seconds // length), unit)} ago"
    return "just now"


def _as_json(each: Listed) -> dict[str, object]:
    stored = each.textures
    return {
        "file": each.path.name,
        "bytes": each.bytes,
        "used": each.used,
        "made_for": stored.made_for if stored else None,
        "size": list(stored.size) if stored else None,
        "outputs": dict(stored.outputs) if stored else None,
        "cost_ms": stored.cost if stored else None,
    }
