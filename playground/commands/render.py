"""Render a sketch to a file."""

from __future__ import annotations

import sys
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from playground.commands.arguments import (
    DeviceOption,
    DriverOption,
    Moment,
    PlainOption,
    Renderer,
    SetOption,
    SizeOption,
    SketchArgument,
    SoftwareOption,
    StepsOption,
    TimeOption,
    either,
    help_text,
    moment_of,
    read_driver,
    read_pixels,
    read_seconds,
    read_steps,
    read_values,
)
from playground.commands.film import Asked, make_many, read_count, read_fps, read_frames, read_number
from playground.errors import DataError, ParameterError, counted
from playground.images.extensions import PICTURE_ENDINGS, VALUE_ENDINGS, VIDEO_ENDINGS
from playground.sketch.model import DEFAULT_PICTURE, LARGEST_PICTURE
from playground.streams import Nowhere
from playground.terminal import busy, console_for, note, progress

if TYPE_CHECKING:
    from playground.engine.engine import Engine
    from playground.sketch.model import Sketch


_MOST_HIDDEN = 3  # defaults without effect that are told one by one

HELP = help_text(
    "Render a sketch to a PNG, a video, numbered pictures or a sheet of variants, and print the path.\n\n"
    "A picture may have up to 65536 pixels a side; a large one is drawn part by part. Time in a video"
    " and in numbered pictures is that of the picture's number: keyframes of the sketch, if it has any,"
    " say what changes. --sweep takes a range or values, of two parameters for a grid; a part of a vector"
    " is named, as .azimuth, .r or .x.\n\n"
    "With --texture, write the values of one pass instead: "
    + either([f"{ending} ({what})" for ending, what in VALUE_ENDINGS.items()])
    + ".",
    "playground render",
    "playground render jacksboro -o land.png --size 1920x1080",
    "playground render jacksboro --set light.sun=250,12",
    "playground render jacksboro --shot morning -o morning.png",
    "playground render jacksboro --texture height -o height.npy",
    "playground render diamond_square --steps height=9",
    "playground render my-land/my_land.glsl --profile",
    "playground render shader.frag --time 2.5 -o - > frame.png",
    "playground render jacksboro --size 20000x12000 -o poster.png",
    "playground render sun_flight --video flight.mp4 --size 1920x1080",
    "playground render jacksboro --shot evening --video still.webm --seconds 2 --fps 25",
    "playground render sun_flight --frames 0..299 --fps 30 -o frames/%05d.png --resume",
    "playground render jacksboro --sweep light.sun.elevation=5..60 -n 12 -o suns.png",
    "playground render jacksboro --sweep light.gain=1,2,4 --sweep view.haze=0..0.4,3",
    "playground render jacksboro --sweep light.sun.azimuth=0..350,36 --video day.mp4 --fps 12",
)


@dataclass(frozen=True)
class Picture:
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
    steps: dict[str, int] | None = None
    plain: bool = False
    asked: Asked | None = None  # more than one picture


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
    time: TimeOption = "",
    settings: SetOption = None,
    driver: DriverOption = "auto",
    plain: PlainOption = False,
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
    steps: StepsOption = None,
    profile: Annotated[
        bool, typer.Option("--profile", metavar="", help="Print the milliseconds of each pass.")
    ] = False,
    video: Annotated[
        str,
        typer.Option(
            "--video",
            help=f"Write a video: {either([f'{e} ({what})' for e, what in VIDEO_ENDINGS.items()])}.",
            metavar="FILE",
            show_default=False,
        ),
    ] = "",
    seconds: Annotated[
        str,
        typer.Option(
            "--seconds",
            help="With --video: how long. Without it, to the last keyframe.",
            metavar="S",
            show_default=False,
        ),
    ] = "",
    fps: Annotated[
        str,
        typer.Option(
            "--fps",
            help="Pictures a second of --video and --frames: 30 unless told, 4 of a sweep.",
            metavar="N",
            show_default=False,
        ),
    ] = "",
    quality: Annotated[
        str,
        typer.Option(
            "--quality",
            help="With --video: low, medium, high or best; high unless told.",
            metavar="NAME",
            show_default=False,
        ),
    ] = "",
    frames: Annotated[
        str,
        typer.Option(
            "--frames",
            help="Write these pictures as PNG files, named by -o, as frames/%05d.png.",
            metavar="FIRST..LAST",
            show_default=False,
        ),
    ] = "",
    resume: Annotated[
        bool, typer.Option("--resume", metavar="", help="With --frames: keep good files that are there.")
    ] = False,
    sweep: Annotated[
        list[str] | None,
        typer.Option(
            "--sweep",
            help="A picture for each value of a parameter, on one sheet. May be given twice.",
            metavar="PATH=FROM..TO",
            show_default=False,
        ),
    ] = None,
    count: Annotated[
        str,
        typer.Option(
            "-n", help="With --sweep: values of a range; 9 unless told.", metavar="N", show_default=False
        ),
    ] = "",
    software: SoftwareOption = False,
    device: DeviceOption = "",
) -> None:
    """Render a sketch to a file and print its path."""
    asked = Asked(
        video,
        read_number(seconds, "--seconds", "10"),
        read_fps(fps),
        quality,
        read_frames(frames),
        resume,
        tuple(sweep or ()),
        read_count(count),
    )
    asked.check(output, texture, profile)
    picture = Picture(
        sketch,
        output,
        read_pixels(size, LARGEST_PICTURE),
        read_seconds(time),
        read_values(settings),
        read_driver(driver),
        shot,
        preset,
        texture,
        profile,
        read_steps(steps),
        plain,
        asked,
    )
    make_picture(picture, ctx.obj.or_else(software, device))


def make_picture(picture: Picture, renderer: Renderer) -> None:
    """Render what was asked for to its file, and print the file's path."""
    from playground.sketch.load import load

    moment = moment_of(
        load(picture.sketch).plainly(picture.plain),
        shot=picture.shot,
        preset=picture.preset,
        values=picture.values,
        steps=picture.steps,
        time=picture.time,
    )
    _say_hidden_defaults(moment.sketch)
    if picture.asked is not None and picture.asked.many:
        make_many(picture.asked, moment, picture.output, picture.size, renderer, picture.driver)
        return
    sketch = moment.sketch
    size = picture.size or moment.size or DEFAULT_PICTURE

    from playground.api import headless
    from playground.engine.error_place import told_at

    with (
        told_at(sketch, moment.shot) if moment.shot and not picture.steps else nullcontext(),
        _target(picture, sketch) as target,
        headless(software=renderer.software, device=renderer.device, driver=picture.driver) as engine,
    ):
        from playground.capture.large import is_large

        if not picture.texture and is_large(engine, sketch, size):
            if picture.profile:
                raise ParameterError("--profile needs a picture that is drawn whole; choose a smaller --size")
            if picture.output != "-" and target.suffix.lower() != ".png":
                raise DataError(
                    "a picture this large is drawn in parts, and written as .png", file=picture.output
                )
            _draw_large(engine, moment, size, target, picture.output == "-")
        else:
            with busy(f"rendering {sketch.name}"):
                _draw(engine, picture, moment, size, target)
            _say_not_finite(engine)
        if picture.profile:
            _print_profile(engine)
    if picture.output != "-":
        print(target)


def _say_hidden_defaults(sketch: Sketch) -> None:
    """Say which defaults of the sketch's own kernels have no effect, for its own files set them over."""
    from playground.sketch.shadowed import shadowed_by_files

    hidden = shadowed_by_files(sketch)
    for one in hidden[:_MOST_HIDDEN]:
        note(str(one))
    if len(hidden) > _MOST_HIDDEN:
        more = counted(len(hidden) - _MOST_HIDDEN, "more default")
        note(f"{more} that a set stands over: playground check lists them")


def _draw(engine: Engine, picture: Picture, moment: Moment, size: tuple[int, int], target: Path) -> None:
    sketch, time, steps = moment.sketch, moment.time, moment.steps
    if picture.profile:
        _prepare_profile(engine, sketch, picture.texture, size, time, steps)
    if picture.texture:
        from playground.images.files import write_values

        values = engine.read(sketch, picture.texture, size=size, time=time, steps=steps)
        clamped = write_values(target, values)
        if clamped:
            note(clamped)
        return
    frame = engine.render(sketch, size=size, time=time, steps=steps)
    if picture.output == "-":
        from playground.images.files import encode_png

        sys.stdout.buffer.write(encode_png(frame.array))
    else:
        frame.save(target, say=note)


def _say_not_finite(engine: Engine) -> None:
    """Say which pass made NaN or infinity, if any did: the picture may show nothing of it."""
    found = [one for one in engine.not_finite_by_pass() if one is not None]
    if found:
        more = f" (first of {len(found)} passes)" if len(found) > 1 else ""
        note(f"{found[0]}{more}")


def _draw_large(engine: Engine, moment: Moment, size: tuple[int, int], target: Path, piped: bool) -> None:
    from playground.capture.large import count_tiles, pack_large, write_large

    with progress(f"rendering {moment.sketch.name} in parts", count_tiles(size)) as done:
        if piped:
            pack_large(
                engine,
                moment.sketch,
                sys.stdout.buffer,
                size,
                time=moment.time,
                steps=moment.steps,
                done=done,
            )
        else:
            write_large(engine, moment.sketch, target, size, time=moment.time, steps=moment.steps, done=done)


def _target(picture: Picture, sketch: Sketch) -> AbstractContextManager[Path]:
    """Open the file to write; refuse what could not be written before anything is drawn."""
    endings = tuple(VALUE_ENDINGS) if picture.texture else PICTURE_ENDINGS
    if picture.output == "-":
        if picture.texture:
            raise ParameterError(f"--texture needs a file: -o {either([f'NAME{e}' for e in endings])}")
        if sys.stdout.isatty():
            raise ParameterError("-o - writes a PNG to standard output, which is the terminal; redirect it")
        if isinstance(sys.stdout, Nowhere):
            raise ParameterError("-o - writes a PNG to standard output, which is closed; redirect it")
        return nullcontext(Path("-"))
    if not picture.output:
        parts = [sketch.name, picture.shot, picture.texture.replace(":", "-")]
        from playground.images.files import new_name

        return new_name("-".join(filter(None, parts)) + endings[0])
    path = Path(picture.output).expanduser()
    if path.is_dir():
        raise DataError("is a folder; expected the name of a file to write", file=picture.output)
    if path.suffix.lower() not in endings:
        what = "values are" if picture.texture else "a picture is"
        raise DataError(f"{what} written to a name ending in {either(endings)}", file=picture.output)
    if not path.parent.is_dir():
        raise DataError(f"there is no folder '{path.parent}' to write into", file=picture.output)
    return nullcontext(path)


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
