"""The command line: arguments and printing, nothing else.

Standard output holds the answer (a path, a table, JSON); notes, progress and errors go to
standard error. A mistake of the user's is one sentence, never a traceback. Exit status:
0 well; 1 ``check`` or ``doctor`` found something; 2 a mistake in what was asked; 130
interrupted; 141 the reader of a pipe has gone.

What is heavy (NumPy, OpenGL, tables) is imported by the command that needs it.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from playground._version import __version__
from playground.errors import ContextError, DataError, ParameterError, PlaygroundError, SketchError, nearest
from playground.terminal import (
    busy,
    complain,
    console_for,
    count,
    note,
    painted,
    print_indented,
    print_rows,
    print_table,
    progress,
)

if TYPE_CHECKING:
    from playground.engine.check import FileReport
    from playground.engine.engine import Engine
    from playground.gpu.doctor import Health
    from playground.sketch.catalogue import Choice, Entry
    from playground.sketch.model import Sketch

FAILED, MISTAKE, INTERRUPTED, BROKEN_PIPE = 1, 2, 130, 141
DEFAULT_SIZE = (1280, 720)
MAX_SIDE = 16384

# The base of every mistake that typer finds itself; it exports only the leaves of that family.
_UsageError: type[Exception] = typer.BadParameter.__bases__[0]


DRIVERS = ("auto", "fragment", "compute")


@dataclass(frozen=True, slots=True)
class _Renderer:
    """Which renderer was asked for before the command."""

    software: bool = False
    device: int | None = None

    def or_else(self, software: bool, device: str = "") -> _Renderer:
        """Return what was asked for before or after the command."""
        return _Renderer(self.software or software, _device(device) if device else self.device)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit status."""
    given = sys.argv[1:] if arguments is None else list(arguments)
    output = sys.stdout
    try:
        status = app(given, prog_name="playground", standalone_mode=False)
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
        # What is still in the buffer cannot be written either; without this, Python says so as it ends.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    except SystemExit as left:
        # Completion leaves so; and typer, having silenced the output, where a pipe has no reader.
        return BROKEN_PIPE if sys.stdout is not output else int(left.code or 0)
    except MemoryError:
        complain("out of memory; choose a smaller --size, or a smaller land, as --set size=513")
        return MISTAKE
    except OSError as error:
        complain(": ".join(str(part) for part in (error.filename, error.strerror or error) if part))
        return MISTAKE
    return int(status or 0)


# ── words for the help ───────────────────────────────────────────────────────


def _help(text: str, *examples: str) -> str:
    r"""Return a command's help: what it does, then examples, whose lines ``\b`` keeps as they are."""
    return f"{text}\n\n\b\nExamples:\n" + "\n".join(f"  {example}" for example in examples)


def _complete_sketch(incomplete: str) -> list[str]:
    from playground.sketch.load import shipped_sketches

    return [name for name in shipped_sketches() if name.startswith(incomplete)]


def _complete_listed(incomplete: str) -> list[str]:
    from playground.sketch.load import shipped_names, shipped_sketches

    names = ["sketches", "techniques", *shipped_sketches(), *shipped_names()]
    return [name for name in names if name.startswith(incomplete)]


def _complete_driver(incomplete: str) -> list[str]:
    return [name for name in DRIVERS if name.startswith(incomplete)]


def _complete_setting(ctx: typer.Context, incomplete: str) -> list[str]:
    from playground.sketch.catalogue import settable
    from playground.sketch.load import load

    try:
        paths = settable(load(ctx.params.get("sketch") or ""))
    except PlaygroundError:
        return []
    return [f"{path}=" for path in paths if path.startswith(incomplete)]


SketchArgument = Annotated[
    str,
    typer.Argument(
        help="A shipped sketch's name, or the path of a sketch, of its folder, or of a shader."
        " Without it, the default sketch.",
        metavar="SKETCH",
        show_default=False,
        autocompletion=_complete_sketch,
    ),
]
SizeOption = Annotated[
    str | None, typer.Option("--size", help="Size in pixels, as 1280x720.", metavar="WxH", show_default=False)
]
SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        help="Set a parameter, as light.sun=250,12, or the land, as size=513. May be repeated.",
        metavar="PATH=VALUE",
        show_default=False,
        autocompletion=_complete_setting,
    ),
]
DriverOption = Annotated[
    str,
    typer.Option(
        "--driver",
        help="What runs the kernels: auto, fragment or compute.",
        metavar="NAME",
        show_default=False,
        autocompletion=_complete_driver,
    ),
]
SoftwareOption = Annotated[
    bool, typer.Option("--software", metavar="", help="Draw with the processor (Mesa llvmpipe).")
]
DeviceOption = Annotated[
    str, typer.Option("--device", help="Draw on this EGL device, from 0.", metavar="N", show_default=False)
]
JsonOption = Annotated[bool, typer.Option("--json", metavar="", help="Print JSON, for programs.")]

app = typer.Typer(
    name="playground",
    help=_help(
        "A playground for terrain shaders: save a GLSL file and see the land change.\n\n"
        "Without a command, opens the default sketch in a window; where there is no display,"
        " renders it to a PNG in this folder and prints its path.",
        "playground",
        "playground live jacksboro",
        "playground render jacksboro -o land.png --set light.sun=250,12",
        "playground new my-land",
        "playground check my-land",
    ),
    invoke_without_command=True,
    no_args_is_help=False,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["--help", "-h"]},
)


def _say_version(wanted: bool) -> None:
    if wanted:
        print(f"playground {__version__}")
        raise typer.Exit()


@app.callback()
def _global(
    ctx: typer.Context,
    version: Annotated[
        bool,
        typer.Option(
            "--version", metavar="", help="Print the version.", callback=_say_version, is_eager=True
        ),
    ] = False,
    software: SoftwareOption = False,
    device: DeviceOption = "",
) -> None:
    ctx.obj = _Renderer(software, _device(device))
    if ctx.invoked_subcommand is None:
        _open_default(ctx.obj)


def _open_default(renderer: _Renderer) -> None:
    from playground.gpu.doctor import where_to_show
    from playground.paths import DEFAULT_SKETCH

    if where_to_show(os.environ, sys.platform):
        _run_live(DEFAULT_SKETCH, DEFAULT_SIZE, renderer, "auto", {})
        return
    note("no display here, so a picture is made instead; playground --help says what else there is")
    _render(_Picture(), renderer)


# ── live ─────────────────────────────────────────────────────────────────────


@app.command(
    help=_help(
        "Open a sketch in a window.\n\n"
        "Every save of its files shows at once, and a panel sets its parameters.",
        "playground live",
        "playground live jacksboro --size 1600x900",
        "playground live my-land --set height.seed=3",
        "playground live shader.frag",
    )
)
def live(
    ctx: typer.Context,
    sketch: SketchArgument = "",
    size: SizeOption = None,
    settings: SetOption = None,
    driver: DriverOption = "auto",
    software: SoftwareOption = False,
) -> None:
    """Open a sketch in a window."""
    from playground.gpu.doctor import where_to_show

    renderer: _Renderer = ctx.obj.or_else(software)
    pixels = _pixels(size) or DEFAULT_SIZE
    values = _values(settings)
    if renderer.device is not None:
        raise ContextError("--device is for pictures without a window; a window opens where its display is")
    if not where_to_show(os.environ, sys.platform):
        from playground.gpu.mend import mend

        raise ContextError(mend("unable to open display", sys.platform, os.environ))
    _run_live(sketch, pixels, renderer, _driver(driver), values)


def _run_live(
    sketch: str, size: tuple[int, int], renderer: _Renderer, driver: str, values: dict[str, object]
) -> None:
    from playground.live.app import run

    if values:
        from playground.sketch.load import load

        with suppress(PlaygroundError):  # what is wrong with the sketch, the window shows
            values = _with_whole_paths(load(sketch), values)
    status = run(sketch, size=size, software=renderer.software, driver=driver, values=values)
    if status:
        raise typer.Exit(status)


# ── render ───────────────────────────────────────────────────────────────────


@dataclass(frozen=True)
class _Picture:
    """What ``render`` was asked for."""

    sketch: str = ""
    output: str = ""
    size: tuple[int, int] | None = None
    time: float | None = None
    values: dict[str, object] | None = None
    driver: str = "auto"
    shot: str = ""
    preset: str = ""
    texture: str = ""
    profile: bool = False


@app.command(
    help=_help(
        "Render a sketch to a PNG and print its path.\n\n"
        "With --texture, write the values of one pass instead: .npy (float32, south row first), .png (16"
        " bits, 0 to 1) or .tif (float32).",
        "playground render",
        "playground render jacksboro -o land.png --size 1920x1080",
        "playground render jacksboro --set light.sun=250,12",
        "playground render jacksboro --shot morning -o morning.png",
        "playground render jacksboro --texture height -o height.npy",
        "playground render my-land/my_land.glsl --profile",
        "playground render shader.frag --time 2.5 -o - > frame.png",
    )
)
def render(
    ctx: typer.Context,
    sketch: SketchArgument = "",
    output: Annotated[
        str,
        typer.Option(
            "-o",
            "--output",
            help="The file to write, or - for standard output. Without it, a new name in this folder.",
            metavar="FILE",
            show_default=False,
        ),
    ] = "",
    size: SizeOption = None,
    time: Annotated[
        str, typer.Option("--time", help="Time in seconds.", metavar="T", show_default=False)
    ] = "",
    settings: SetOption = None,
    driver: DriverOption = "auto",
    shot: Annotated[
        str, typer.Option("--shot", help="Render a shot of the sketch.", metavar="NAME", show_default=False)
    ] = "",
    preset: Annotated[
        str, typer.Option("--preset", help="Begin with a preset.", metavar="NAME", show_default=False)
    ] = "",
    texture: Annotated[
        str,
        typer.Option(
            "--texture",
            help="Write this pass's own values, not the picture.",
            metavar="PASS",
            show_default=False,
        ),
    ] = "",
    profile: Annotated[
        bool, typer.Option("--profile", metavar="", help="Print the milliseconds of each pass.")
    ] = False,
    software: SoftwareOption = False,
    device: DeviceOption = "",
) -> None:
    """Render a sketch to a file and print its path."""
    picture = _Picture(
        sketch,
        output,
        _pixels(size),
        _seconds(time),
        _values(settings),
        _driver(driver),
        shot,
        preset,
        texture,
        profile,
    )
    _render(picture, ctx.obj.or_else(software, device))


def _render(picture: _Picture, renderer: _Renderer) -> None:
    from playground.sketch.load import load

    sketch = load(picture.sketch)
    size, time, steps = DEFAULT_SIZE, 0.0, {}
    if picture.shot:
        shot = sketch.shot(picture.shot)
        sketch = sketch.for_shot(shot)
        size, time, steps = shot.size, shot.time, dict(shot.steps)
    if picture.preset:
        sketch = sketch.with_preset(picture.preset)
    if picture.values:
        sketch = sketch.with_values(_with_whole_paths(sketch, picture.values))
    size = picture.size or size
    time = time if picture.time is None else picture.time
    target = _target(picture, sketch)

    from playground.api import headless

    with (
        busy(f"rendering {sketch.name}"),
        headless(software=renderer.software, device=renderer.device, driver=picture.driver) as engine,
    ):
        if picture.profile:
            _prepare_profile(engine, sketch, picture.texture, size, time, steps)
        if picture.texture:
            from playground.images.files import write_values

            values = engine.read(sketch, picture.texture, size=size, time=time, steps=steps)
            clamped = write_values(target, values)
            if clamped:
                note(clamped)
        else:
            frame = engine.render(sketch, size=size, time=time, steps=steps)
            if picture.output == "-":
                from playground.images.files import encode_png

                sys.stdout.buffer.write(encode_png(frame.array))
            else:
                frame.save(target)
        if picture.profile:
            _print_profile(engine)
    if picture.output != "-":
        print(target)


def _target(picture: _Picture, sketch: Sketch) -> Path:
    """Return the file to write; refuse what could not be written before anything is drawn."""
    endings = (".npy", ".png", ".tif", ".tiff") if picture.texture else (".png",)
    if picture.output == "-":
        if picture.texture:
            raise ParameterError("--texture needs a file: -o NAME.npy, NAME.png or NAME.tif")
        if sys.stdout.isatty():
            raise ParameterError("-o - writes a PNG to standard output, which is the terminal; redirect it")
        return Path("-")
    if not picture.output:
        parts = [sketch.name, picture.shot, picture.texture.replace(":", "-")]
        return _unused(Path("-".join(filter(None, parts)) + endings[0]))
    path = Path(picture.output).expanduser()
    if path.is_dir():
        raise DataError("is a folder; expected the name of a file to write", file=picture.output)
    if path.suffix.lower() not in endings:
        what = "values are" if picture.texture else "a picture is"
        raise DataError(f"{what} written to a name ending in {' or '.join(endings)}", file=picture.output)
    if not path.parent.is_dir():
        raise DataError(f"there is no folder '{path.parent}' to write into", file=picture.output)
    return path


def _unused(path: Path) -> Path:
    """Return a name that no file has yet: land.png, else land-2.png, else land-3.png and so on."""
    candidate, number = path, 1
    while candidate.exists():
        number += 1
        candidate = path.with_name(f"{path.stem}-{number}{path.suffix}")
    return candidate


def _prepare_profile(
    engine: Engine, sketch: Sketch, texture: str, size: tuple[int, int], time: float, steps: dict[str, int]
) -> None:
    """Draw once unmeasured, so that the measured frame compiles nothing, then forget every texture."""
    if texture:
        engine.texture(sketch, texture, size=size, time=time, steps=steps)
    else:
        engine.draw(sketch, size=size, time=time, steps=steps)
    engine.ctx.finish()
    engine.cache.clear()
    engine.runs.clear()
    engine.profiling = True


def _print_profile(engine: Engine) -> None:
    from rich.table import Table

    plan = engine.plan
    table = Table(title="one frame, every pass run anew, nothing compiled", title_justify="left")
    table.add_column("pass", overflow="fold")
    for heading in ("texels", "turns", "ms"):
        table.add_column(heading, justify="right")
    for path, milliseconds in engine.times.items():
        step = plan.step(path) if plan is not None else None
        if step is not None:
            turns = engine.runs[path] * step.repeat
            table.add_row(path, f"{step.size[0]} x {step.size[1]}", str(turns), f"{milliseconds:.2f}")
    table.add_section()
    table.add_row("together", "", "", f"{sum(engine.times.values()):.2f}")
    console = console_for(sys.stderr)
    console.print(table)
    compiled = sum(engine.runner.compile_times.values())
    console.print(
        f"clock: {engine.clock}; compiling took {compiled:.0f} ms before that ({engine.info.renderer})",
        highlight=False,
        soft_wrap=True,
    )


# ── check ────────────────────────────────────────────────────────────────────


@app.command(
    help=_help(
        "Check shaders and sketches.\n\n"
        "Compiles every kernel by both drivers, loads every sketch, draws a small frame of each. A folder is"
        " searched for .glsl, .comp, .frag and .toml. What hangs or crashes the driver is stopped and"
        " reported. Where there are no compute shaders, they are skipped. Exit status 1 when anything fails.",
        "playground check my-land",
        "playground check land.glsl sketch.toml",
        "playground check --json glsl | jq 'select(.ok | not)'",
    )
)
def check(
    ctx: typer.Context,
    paths: Annotated[list[Path], typer.Argument(help="Files, and folders to search.", metavar="PATH...")],
    as_json: Annotated[
        bool, typer.Option("--json", metavar="", help="Print one JSON object a file, a line each.")
    ] = False,
    software: SoftwareOption = False,
    device: DeviceOption = "",
) -> None:
    """Check shaders and sketches."""
    from playground.engine.check import check_file, find_files
    from playground.engine.trial import Trial

    renderer: _Renderer = ctx.obj.or_else(software, device)
    files = find_files(paths)
    failed, skipped = 0, False
    with (
        Trial(software=renderer.software, device=renderer.device) as trial,
        progress("checking", len(files)) as advance,
    ):
        for path, root in files:
            report = check_file(path, trial, root)
            failed += not report.ok
            skipped |= bool(report.skipped)
            if as_json:
                print(json.dumps(report.as_json(), ensure_ascii=False), flush=True)
            else:
                _print_report(report)
            advance()
    if not as_json:
        print(f"{count(len(files), 'file')} checked, {failed or 'none'} failed{_why_skipped(skipped)}")
    if failed:
        raise typer.Exit(FAILED)


def _why_skipped(skipped: bool) -> str:
    return "; compute was skipped, because this context has no compute shaders" if skipped else ""


def _print_report(report: FileReport) -> None:
    mark = painted("ok", "32", sys.stdout) if report.ok else painted("FAILED", "1;31", sys.stdout)
    skipped = f"  (skipped: {', '.join(report.skipped)})" if report.skipped else ""
    print(f"{mark}{' ' * (6 if report.ok else 2)}{report.path}{skipped}")
    for diagnostic in report.errors:
        print("\n".join(f"        {line}" for line in str(diagnostic).split("\n")), flush=True)


# ── list ─────────────────────────────────────────────────────────────────────


@app.command(
    "list",
    help=_help(
        "List sketches and techniques, or the parameters of one.\n\n"
        "WHAT is sketches, techniques, a folder of techniques, or the name or path of one sketch or"
        " technique. In a pipe, the columns are parted by tabs.",
        "playground list",
        "playground list jacksboro",
        "playground list generation",
        "playground list lighting/l_dot_n --json",
    ),
)
def list_(
    what: Annotated[
        str,
        typer.Argument(
            help="What to list; everything by default.",
            metavar="WHAT",
            show_default=False,
            autocompletion=_complete_listed,
        ),
    ] = "",
    as_json: JsonOption = False,
) -> None:
    """List sketches, techniques, parameters."""
    from playground.sketch import catalogue

    sketches = catalogue.sketches() if what in ("", "sketches") else []
    techniques = catalogue.techniques() if what in ("", "techniques") else []
    named = catalogue.one(what) if what not in ("", "sketches", "techniques") else []
    if as_json:
        groups = {"sketches": sketches, "techniques": techniques}
        for entry in named:
            groups["sketches" if entry.kind == "sketch" else "techniques"].append(entry)
        table = {group: [entry.as_json() for entry in entries] for group, entries in groups.items()}
        print(json.dumps(table, indent=2, ensure_ascii=False))
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


# ── doctor ───────────────────────────────────────────────────────────────────


@app.command(
    help=_help(
        "Say what this machine offers, and what to do where something is missing.\n\n"
        "The OpenGL context, its limits, the display, the packages. Exit status 1 when no context opens.",
        "playground doctor",
        "playground doctor --software",
        "playground doctor --json",
    )
)
def doctor(
    ctx: typer.Context,
    as_json: JsonOption = False,
    software: SoftwareOption = False,
    device: DeviceOption = "",
) -> None:
    """Say what this machine offers."""
    from playground.gpu.doctor import examine

    renderer: _Renderer = ctx.obj.or_else(software, device)
    health = examine(software=renderer.software, device=renderer.device)
    if as_json:
        print(json.dumps(health.as_json(), indent=2, ensure_ascii=False))
    else:
        findings = list(_findings(health))
        width = max(len(label) for label, _ in findings) + 2
        for label, text in findings:
            print(f"{label:<{width}}{text}")
        if health.trouble:
            sys.stdout.flush()
            complain(health.trouble)
    if not health.ok:
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
        yield "software renderer", "yes: the processor draws" if info.software else "no"
        for name, value in health.limits.items():
            yield f"most {name}", str(value)
    yield "display", health.display or "none: live needs one, render does not"
    yield "system", health.system
    yield "Python", health.python
    yield "playground", __version__
    for name, version in health.packages.items():
        yield name, version or "missing"


# ── new ──────────────────────────────────────────────────────────────────────


@app.command(
    help=_help(
        "Make a folder with a sketch and a kernel of your own.\n\nIt never overwrites anything.",
        "playground new my-land",
        "playground live my-land",
    )
)
def new(
    name: Annotated[
        str,
        typer.Argument(
            help="The folder to make; letters, digits, - and _.", metavar="NAME", show_default=False
        ),
    ],
) -> None:
    """Make a fresh sketch folder."""
    from playground.templates import make_sketch

    folder = make_sketch(Path(name).expanduser())
    for path in sorted(folder.iterdir()):
        print(path)
    shell = _quoted(str(folder))
    note(
        f"next: playground live {shell}     opens it; edit {folder / 'my_land.glsl'}, save, and look\n"
        f"      playground render {shell}   makes a PNG\n"
        f"      playground check {shell}    says what is wrong with it, if anything"
    )


# ── reading arguments ────────────────────────────────────────────────────────


def _pixels(text: str | None) -> tuple[int, int] | None:
    if text is None:
        return None
    width, _, height = text.lower().replace("×", "x").partition("x")
    sides = [int(side) if side.strip().isdecimal() else 0 for side in (width, height)]
    if not all(1 <= side <= MAX_SIDE for side in sides):
        raise ParameterError(f"--size {text}: expected width and height, 1 to {MAX_SIDE} pixels, as 1280x720")
    return sides[0], sides[1]


def _seconds(text: str) -> float | None:
    if not text:
        return None
    try:
        seconds = float(text)
    except ValueError:
        seconds = float("nan")
    if not abs(seconds) < 1e9:
        raise ParameterError(f"--time {text}: expected a number of seconds, as 2.5")
    return seconds


def _driver(text: str) -> str:
    if text not in DRIVERS:
        raise ParameterError(f"--driver {text}: expected {', '.join(DRIVERS[:-1])} or {DRIVERS[-1]}")
    return text


def _device(text: str) -> int | None:
    if text and not (text.isdecimal() and len(text) < 4):
        raise ParameterError(f"--device {text}: expected the number of an EGL device, from 0")
    return int(text) if text else None


def _values(settings: Sequence[str] | None) -> dict[str, object]:
    """Split ``path=value`` settings; the last of a path counts."""
    found: dict[str, object] = {}
    for setting in settings or ():
        path, equals, value = setting.partition("=")
        path = path.strip()
        if not equals or not path:
            raise ParameterError(f"--set {setting}: expected PATH=VALUE, as light.sun=250,12 or size=513")
        found.pop(path, None)
        found[path] = value.strip()
    return found


def _with_whole_paths(sketch: Sketch, values: dict[str, object]) -> dict[str, object]:
    """Make the files among the values absolute: the user named them from the current folder.

    A name that is not there but in the sketch's folder or in ``glsl/`` is left as it is.
    """
    from playground.paths import GLSL
    from playground.sketch.assign import resolve

    found = dict(values)
    for path, value in values.items():
        try:
            parameter = resolve(sketch.graph, path)[0].parameter
        except PlaygroundError:
            continue  # the land's own, or a mistake that with_values explains
        text = str(value)
        if parameter.widget.kind != "file" or not text:
            continue
        here = Path(text).expanduser()
        elsewhere = any((Path(folder) / text).is_file() for folder in (sketch.folder, GLSL))
        if here.exists() or not elsewhere:
            found[path] = str(Path.cwd() / here)
    return found


def _usage_message(error: Exception) -> str:
    """Return a usage mistake as one sentence, with the help to turn to."""
    text: str = error.format_message() if hasattr(error, "format_message") else str(error)
    text = " ".join(text.split())
    ctx: Any = getattr(error, "ctx", None)
    if text.startswith("No such command"):
        return _no_command(text)
    path = ctx.command_path if ctx is not None else "playground"
    if not text:
        return f"something is missing; see {path} --help"
    return f"{text[0].lower()}{text[1:].rstrip('.')}; see {path} --help"


def _no_command(text: str) -> str:
    name = text.split("'")[1] if text.count("'") >= 2 else ""
    if name in _complete_sketch("") or Path(name).exists():
        shell = _quoted(name)
        return f"'{name}' is no command; did you mean: playground live {shell}, or playground render {shell}?"
    return f"no command '{name}'{nearest(name, _COMMANDS)}"


_COMMANDS = ("live", "render", "check", "list", "doctor", "new")


def _quoted(text: str) -> str:
    if sys.platform == "win32":
        return f'"{text}"' if " " in text else text
    import shlex

    return shlex.quote(text)


if __name__ == "__main__":
    sys.exit(main())
