"""Report what this machine offers."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import typer

from playground._version import __version__
from playground.commands import options
from playground.commands.arguments import FAILED, Renderer, help_text
from playground.commands.cache import usage_text
from playground.commands.import_name import explained, other_owners
from playground.terminal import complain, print_json

if TYPE_CHECKING:
    from playground.doctor import Health


HELP = help_text(
    "Report what this machine offers, and what to do where something is missing.\n\n"
    "The OpenGL context, its limits, the display, the packages, the terrain cached on disk."
    " Exit status 1 when no context opens, or another package with a module playground is installed.",
    "playground doctor",
    "playground doctor --software",
    "playground doctor --json",
)


def doctor(
    ctx: typer.Context,
    as_json: options.Json = False,
    software: options.Software = False,
    device: options.Device = None,
) -> None:
    """Report what this machine offers."""
    from playground.doctor import examine

    renderer: Renderer = ctx.obj.or_else(software, device)
    others = other_owners()
    health = examine(software=renderer.software, device=renderer.device)
    if as_json:
        print_json(health.as_json() | {"cache": _cache(), "other_playgrounds": others})
    else:
        findings = list(_findings(health))
        width = max(len(label) for label, _ in findings) + 2
        for label, text in findings:
            print(f"{label:<{width}}{text}")
        if health.trouble:
            sys.stdout.flush()
            complain(health.trouble)
        if others:
            sys.stdout.flush()
            complain(explained(others))
    if not health.ok or others:
        raise typer.Exit(FAILED)


def _findings(health: Health) -> Iterator[tuple[str, str]]:
    if health.context is None:
        yield "context", "none"
    else:
        info = health.context
        yield "context", f"OpenGL {info.version_code // 100}.{info.version_code % 100 // 10}"
        yield "renderer", info.renderer
        yield "vendor", info.vendor
        yield "driver", info.version
        yield "compute shaders", "yes" if info.compute else "no: they need OpenGL 4.3; everything else works"
        yield "software renderer", "yes: the CPU renders" if info.software else "no"
        for name, value in health.limits.items():
            yield f"most {name}", str(value)
    yield "display", health.display or "none: live needs one, render does not"
    yield "system", health.system
    yield "Python", health.python
    yield "playground", __version__
    for name, version in health.packages.items():
        yield name, version or "missing"
    yield "terrain cached on disk", usage_text(**_cache())


def _cache() -> dict[str, Any]:
    """Return what is cached of expensive terrain, as `usage_text` takes it."""
    from playground.engine.disk_cache import bytes_in, cache_directory, limit_in

    files, size = bytes_in(cache_directory())
    return {"folder": str(cache_directory()), "files": files, "bytes": size, "most_bytes": limit_in()}
