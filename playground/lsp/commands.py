"""A language server: what an editor shows of kernels and sketches while one types."""

from __future__ import annotations

from typing import Annotated

import typer

from playground.commands import options
from playground.commands.arguments import Renderer, help_text, read_option, within
from playground.commands.options import value
from playground.errors import ContextError
from playground.extras import needs

HELP = help_text(
    "Serve an editor by the Language Server Protocol, over standard input and output.\n\n"
    "Diagnostics as one types, the same as those of check; completion, hover, go to definition, rename and"
    " colour boxes in kernels and in sketches. An editor starts it; its extra is lsp. With --tcp it listens"
    " on a port of this computer, for one editor, to look for mistakes.",
    "playground lsp",
    "playground lsp --tcp 8888",
)


def lsp(
    ctx: typer.Context,
    tcp: Annotated[str, value("--tcp PORT", "Listen on this port of this computer.")] = "",
    software: options.Software = False,
    device: options.Device = None,
) -> None:
    """Serve an editor by the Language Server Protocol."""
    port = read_option("--tcp", tcp, within(1, 65535), "a port, 1 to 65535")
    try:
        from playground.lsp.server import serve
    except ImportError as error:
        if (error.name or "").partition(".")[0] not in ("pygls", "lsprotocol", "cattrs", "attrs"):
            raise
        raise ContextError(needs("the language server", "pygls", "lsp")) from None
    renderer: Renderer = ctx.obj.or_else(software, device)
    serve(port, software=renderer.software, device=renderer.device)


def add_to(app: typer.Typer) -> None:
    """Add the room's command to a command line."""
    app.command("lsp", help=HELP)(lsp)
