"""Open a sketch in a window."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Mapping
from contextlib import suppress
from inspect import Signature, signature
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand

from playground import rooms
from playground.commands import options
from playground.commands.arguments import (
    Renderer,
    help_text,
    read_option,
    read_values,
    with_whole_paths,
    within,
)
from playground.commands.options import flag, value
from playground.commands.standard_input import kept
from playground.errors import ContextError, ParameterError, PlaygroundError
from playground.sketch.model import DEFAULT_PICTURE
from playground.terminal import complain, say

REMOTE_PORT = 8765
"""Of ``--remote`` without a port."""

HELP = help_text(
    "Open a sketch in a window.\n\nEvery save of its files shows at once, and a panel sets its parameters."
    " Your edits, the camera and the time are restored the next time. An elevation file opens in a sketch"
    " that is made around it. As SKETCH, - opens a"
    " shader's text from standard input, or from the clipboard where that is the terminal: it is kept as a"
    " new file in this folder.",
    "playground live",
    "playground live jacksboro --size 1600x900",
    "playground live my-land --set height.seed=3",
    "playground live my-land --fresh",
    *(example for module in rooms.modules("options") for example in module.LIVE_EXAMPLES),
    "playground live my-land --no-cache",
    "playground live shader.frag",
    "playground live dem.tif",
    "playground live - < shader.frag",
    "playground live jacksboro --remote",
    "playground live jacksboro --osc 9000 --osc-to 127.0.0.1:9001",
)


class LiveCommand(TyperCommand):
    """Takes ``--remote`` with or without a port."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the arguments; a ``--remote`` without a port gets the usual one."""
        arguments = list(args)
        for at, word in enumerate(arguments):
            if word == "--":
                break
            if word == "--remote" and not "".join(arguments[at + 1 : at + 2]).isdecimal():
                arguments[at] = f"--remote={REMOTE_PORT}"
        return super().parse_args(ctx, arguments)


def live(
    ctx: typer.Context,
    sketch: options.Sketch = "",
    size: options.Size = None,
    settings: options.Set = None,
    driver: options.Driver = "auto",
    plain: options.Plain = False,
    dialect: options.Dialect = "",
    software: options.Software = False,
    fresh: Annotated[bool, flag("--fresh", "Forget your edits of the last time.")] = False,
    request: Mapping[str, object] | None = None,
    no_cache: Annotated[
        bool,
        flag("--no-cache", "Compute all terrain again, and cache none on disk (see playground cache)."),
    ] = False,
    remote: Annotated[
        str,
        value(
            "--remote [PORT]",
            "Let programs and a browser on this machine drive the window, by HTTP and WebSocket;"
            f" port {REMOTE_PORT} where none is given, 0 for a free one.",
        ),
    ] = "",
    token: Annotated[
        str,
        value("--token TEXT", "The remote's token, 16 to 128 letters, digits, - and _; else a random one."),
    ] = "",
    osc: Annotated[
        str,
        value("--osc PORT", "Receive OSC at this port, from this machine; at another address as HOST:PORT."),
    ] = "",
    osc_to: Annotated[str, value("--osc-to HOST:PORT", "Send each new value there by OSC.")] = "",
) -> None:
    """Open a sketch in a window."""
    from playground.shader.dialect import check_name

    renderer: Renderer = ctx.obj.or_else(software)
    values = read_values(settings)
    remotes = read_remotes(remote, token, osc, osc_to)
    check_display(renderer)
    open_window(
        kept(sketch, "live", _clipboard),
        size,
        renderer,
        driver=driver,
        values=values,
        plain=plain,
        dialect=check_name(dialect),
        fresh=fresh,
        request=request,
        no_cache=no_cache,
        remotes=remotes,
    )


def command() -> Callable[..., None]:
    """Return ``live`` as it is called: with the options of the rooms in the place of ``request``."""
    readers = [module.live_options for module in rooms.modules("options")]
    added = [signature(read, eval_str=True).parameters for read in readers]
    own = signature(live, eval_str=True).parameters

    def called(**arguments: Any) -> None:
        request: dict[str, object] = {}
        for read, names in zip(readers, added, strict=True):
            request |= read(**{name: arguments.pop(name) for name in names})
        live(**arguments, request=request)

    parameters = [
        parameter
        for name in own
        for parameter in ((own[name],) if name != "request" else (p for each in added for p in each.values()))
    ]
    called.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    called.__signature__ = Signature(parameters)  # type: ignore[attr-defined]
    return called


def _clipboard() -> str:
    from playground.studio.window import clipboard_text

    return clipboard_text()


def read_remotes(remote: str = "", token: str = "", osc: str = "", osc_to: str = "") -> dict[str, Any]:
    """Return the fields of ``RemoteOptions``; raise ``ParameterError``."""
    from playground.local_server import check_token

    expected = "a port from 1 to 65535, or 0 for a free one"
    port = read_option("--remote", remote, within(0, 65535), expected)
    if token and port is None:
        raise ParameterError("--token is that of --remote, which is not given")
    return {
        "port": port,
        "token": check_token(token) if token else "",
        "osc": read_option("--osc", osc, _address, "a port, as 9000, or HOST:PORT, as 0.0.0.0:9000"),
        "osc_to": read_option("--osc-to", osc_to, _address, "HOST:PORT, as 127.0.0.1:9001"),
    }


def _address(text: str) -> tuple[str, int] | None:
    host, colon, port = text.rpartition(":")
    number = within(1, 65535)(port)
    return None if number is None or bool(colon) != bool(host) else (host or "127.0.0.1", number)


def check_display(renderer: Renderer) -> None:
    """Raise ``ContextError`` where no window can be opened, or not on the chosen renderer."""
    from playground.doctor import where_to_show

    if renderer.device is not None:
        raise ContextError("--device is for pictures without a window; a window opens where its display is")
    if not where_to_show(os.environ, sys.platform):
        from playground.engine.driver_advice import advice

        raise ContextError(advice("unable to open display", sys.platform, os.environ))


def open_window(
    sketch: str,
    size: tuple[int, int] | None,
    renderer: Renderer,
    *,
    values: dict[str, object] | None = None,
    no_cache: bool = False,
    remotes: dict[str, Any] | None = None,
    **options: Any,
) -> None:
    """Open a window and stay until it is closed; ``options`` are those of ``playground.studio.app.run``."""
    from playground.engine.disk_cache import limit_in

    limit = (
        0 if no_cache else limit_in()
    )  # a wrong value in the environment is an error before a window opens
    from playground.engine.sandbox import Sandbox
    from playground.sketch.find import find, is_pack
    from playground.sketch.load import load
    from playground.studio.remote.remotes import RemoteOptions, Remotes

    if sketch and not is_pack(Path(sketch)):
        find(sketch)  # says so before anything is started, where there is none
    if values:
        with suppress(PlaygroundError):  # the window shows what is wrong with the sketch
            values = with_whole_paths(load(sketch, dialect=options.get("dialect", "")), values)
    with Sandbox(software=renderer.software) as sandbox, Remotes(RemoteOptions(**(remotes or {}))) as opened:
        for sentence in opened.sentences:
            say(sentence)  # where it is reached was asked for
        sandbox.start()  # it is warm by the time that the window, whose parts take long to read, is there
        from playground.studio.app import run

        options |= {"cache_limit": limit, "report": complain, "sandbox": sandbox, "remotes": opened}
        options["start_page"] = not sketch and not (options.get("request") or {}).get("lesson")
        status = run(sketch, size=size, software=renderer.software, values=values, **options)
    if status:
        raise typer.Exit(status)


def open_default(renderer: Renderer) -> bool:
    """Open a window with the start page, where there is a display; return whether there is."""
    from playground.doctor import where_to_show

    if not where_to_show(os.environ, sys.platform):
        return False
    open_window("", DEFAULT_PICTURE, renderer)
    return True


def add_to(app: typer.Typer) -> None:
    """Add the room's command to a command line."""
    app.command("live", cls=LiveCommand, help=HELP)(command())
