"""The command line: where a command begins, and how a mistake ends.

Standard output holds the answer (a path, a table, JSON); notes, progress and errors go to
standard error, more with --verbose, errors alone with --quiet. A mistake of the user's is one
sentence, never a traceback. Exit status: 0 well; 1 ``check`` or ``doctor`` found something; 2 a
mistake in the command; 130 interrupted; 141 the reader of a pipe has closed it; 143 and 129 ended
by SIGTERM or SIGHUP.

What is heavy (NumPy, OpenGL, tables) is imported by the command that needs it.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import cache as cached
from pathlib import Path
from typing import Annotated, Any

import typer

from playground import rooms
from playground._version import __version__
from playground.allowed_files import exists
from playground.commands import cache, doctor, library, listing, new, options, trace
from playground.commands.arguments import Renderer, help_text
from playground.commands.common_options import prepared, with_root
from playground.commands.import_name import check_package
from playground.errors import PlainFormWarning, PlaygroundError, PlaygroundWarning, nearest
from playground.paths import program, quoted
from playground.signals import ended_by_signals
from playground.streams import flush_or_discard, open_streams
from playground.terminal import complain, note, with_loudness

_NAME = "playground"
MISTAKE, INTERRUPTED, BROKEN_PIPE = 2, 130, 141

# The base of every mistake that typer finds itself; it exports only the leaves of that family.
_UsageError: type[Exception] = typer.BadParameter.__bases__[0]

app = typer.Typer(
    name="playground",
    help=help_text(
        "A playground for terrain shaders: save a GLSL file and see the terrain change.\n\n"
        "Without a command, opens the default sketch in a window; where there is no display,"
        " renders it to a PNG in this folder and prints its path.",
        "playground",
        "playground live jacksboro",
        "playground render jacksboro -o terrain.png --set light.sun=250,12",
        "playground new my-land",
        "playground check my-land",
    ),
    invoke_without_command=True,
    no_args_is_help=False,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit status."""
    open_streams()
    with with_loudness(), with_root(), ended_by_signals() as came:
        status = _status(sys.argv[1:] if arguments is None else list(arguments))
    return 128 + came[-1] if came else status


def _status(arguments: list[str]) -> int:
    output = sys.stdout
    try:
        with _printing_warnings():
            check_package()
            status = command_line()(arguments, prog_name=_NAME, standalone_mode=False)
        sys.stdout.flush()
    except PlaygroundError as error:
        for diagnostic in error.diagnostics:
            complain(str(diagnostic), diagnostic.severity)
        return error.exit_status
    except _UsageError as error:
        complain(_usage_message(error))
        return MISTAKE
    except (KeyboardInterrupt, typer.Abort):
        return INTERRUPTED
    except BrokenPipeError:
        return BROKEN_PIPE
    except SystemExit as left:
        # Completion leaves so; and rich and typer, where a pipe has no reader.
        gone = isinstance(left.__context__, OSError) or sys.stdout is not output
        return BROKEN_PIPE if gone else int(left.code or 0)
    except MemoryError:
        complain("out of memory; choose a smaller --size, or a smaller terrain, as --set size=513")
        return MISTAKE
    except OSError as error:
        complain(": ".join(str(part) for part in (error.filename, error.strerror or error) if part))
        return MISTAKE
    finally:
        # Their buffers cannot be written either; without this, Python reports an error as it ends.
        for stream in (output, sys.stderr):
            flush_or_discard(stream)
    return int(status or 0)


@contextmanager
def _printing_warnings() -> Iterator[None]:
    """Print the playground's own warnings as sentences, why a fast variant does not run as a note."""
    with warnings.catch_warnings():
        others = warnings.showwarning

        def show(message: Warning | str, category: type[Warning], *more: Any, **named: Any) -> None:
            if issubclass(category, PlainFormWarning):
                note(f"note: {message}")
            elif issubclass(category, PlaygroundWarning):
                complain(str(message), "warning")
            else:
                others(message, category, *more, **named)

        warnings.simplefilter("always", PlaygroundWarning)
        warnings.showwarning = show
        yield


def _print_version(requested: bool) -> None:
    if requested:
        print(f"playground {__version__}")
        raise typer.Exit()


@app.callback()
def _global(
    ctx: typer.Context,
    version: Annotated[
        bool,
        typer.Option(
            "--version", metavar="", help="Print the version.", callback=_print_version, is_eager=True
        ),
    ] = False,
    software: options.Software = False,
    device: options.Device = None,
) -> None:
    ctx.obj = Renderer(software, device)
    if ctx.invoked_subcommand is None:
        _open_default(ctx)


def _open_default(ctx: typer.Context) -> None:
    """Run what the first room offers that can run here; without such a room, print the help."""
    for module in rooms.modules("commands"):
        if hasattr(module, "open_default") and module.open_default(ctx.obj):
            return
    print(ctx.get_help())


def _usage_message(error: Exception) -> str:
    """Return a usage mistake as one message, with the help to read."""
    text: str = error.format_message() if hasattr(error, "format_message") else str(error)
    text = " ".join(text.split())
    ctx: Any = getattr(error, "ctx", None)
    path = (ctx.command_path if ctx is not None else _NAME).replace(_NAME, program(), 1)
    if text.startswith("No such command") and ctx is not None:
        return _no_command(text.split("'")[1] if text.count("'") >= 2 else "", ctx)
    if not text:
        return f"something is missing; see {path} --help"
    return f"{text[0].lower()}{text[1:].rstrip('.')}; see {path} --help"


def _no_command(name: str, ctx: Any) -> str:
    hint = nearest(name, ctx.command.list_commands(ctx))
    if ctx.parent is not None:
        return f"no command '{name}' in {ctx.command_path}{hint}"
    if name in options.complete_sketch("") or exists(Path(name)):
        shell = quoted(name)
        live, drawn = f"{program()} live {shell}", f"{program()} render {shell}"
        return f"'{name}' is no command; did you mean: {live}, or {drawn}?"
    return f"no command '{name}'{hint}"


for _room in rooms.modules("commands"):
    _room.add_to(app)
app.command("list", help=listing.HELP)(listing.list_)
app.command("trace", help=trace.HELP)(trace.trace)
app.command("doctor", help=doctor.HELP)(doctor.doctor)
app.command("new", help=new.HELP)(new.new)
for _group in (cache.app, library.app):
    app.add_typer(_group)


@cached
def command_line() -> Any:
    """Return the whole command line: every command with the options of its own and those of all."""
    return prepared(app)


if __name__ == "__main__":
    sys.exit(main())
