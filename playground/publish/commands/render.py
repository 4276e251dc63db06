"""Render a sketch to a file."""

from __future__ import annotations

import sys
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from playground.commands import options
from playground.commands.arguments import (
    Moment,
    Pixels,
    Renderer,
    either,
    help_text,
    moment_of,
    output_file,
    read_option,
    read_pixels,
    read_steps,
    read_values,
    refuse,
    within,
)
from playground.commands.options import flag, value
from playground.commands.standard_input import kept
from playground.commands.standard_output import check_standard_output
from playground.data.image_files import PICTURE_ENDINGS, VALUE_ENDINGS, VIDEO_ENDINGS
from playground.errors import DataError, ParameterError, counted
from playground.paths import program
from playground.publish.commands.film import SeriesJob, SeriesOptions, read_fps, read_frames
from playground.sketch.model import DEFAULT_PICTURE, MAX_PICTURE_SIDE, MAX_SUPERSAMPLE
from playground.terminal import busy, console_for, note, progress

if TYPE_CHECKING:
    from playground.engine.engine import Engine
    from playground.sketch.model import Sketch


_MAX_LISTED = 3  # defaults without effect that are listed one by one

HELP = help_text(
    "Render a sketch to a PNG, a video, numbered pictures or a sheet of variants, and print the path.\n\n"
    "A picture may have up to 65536 pixels a side; a large one is drawn part by part. Time in a video"
    " and in numbered pictures is that of the picture's number: keyframes of the sketch, if it has any,"
    " say what changes. --sweep takes a range or values, of two parameters for a grid; a part of a vector"
    " is named, as .azimuth, .r or .x. As SKETCH, - renders a shader's text from standard input, which is"
    " kept as a new file in this folder.\n\n"
    "A .png has 8 bits a channel, with --bits 16 twice as many; an .exr holds the light in floats.\n\n"
    "With --texture, write the values of one pass instead: "
    + either([f"{ending} ({what})" for ending, what in VALUE_ENDINGS.items()])
    + ".",
    "playground render",
    "playground render jacksboro -o terrain.png --size 1920x1080",
    "playground render jacksboro --set light.sun=250,12",
    "playground render jacksboro --shot morning -o morning.png",
    "playground render jacksboro --texture height -o height.npy",
    "playground render diamond_square --steps height=9",
    "playground render my-land/my_land.glsl --profile",
    "playground render shader.frag --time 2.5 -o - > frame.png",
    "playground render - < shader.frag",
    "playground render dem.tif --set height.longest=4097 -o picture.png",
    "playground render jacksboro -o light.exr",
    "playground render jacksboro --size 20000x12000 -o poster.png",
    "playground render sun_flight --video flight.mp4 --size 1920x1080",
    "playground render jacksboro --shot evening --video still.webm --seconds 2 --fps 25",
    "playground render sun_flight --frames 0..299 --fps 30 -o frames/%05d.png --resume",
    "playground render jacksboro --sweep light.sun.elevation=5..60 -n 12 -o suns.png",
    "playground render jacksboro --sweep light.gain=1,2,4 --sweep view.haze=0..0.4,3",
    "playground render jacksboro --sweep light.sun.azimuth=0..350,36 --video day.mp4 --fps 12",
)


@dataclass(frozen=True, slots=True)
class Output:
    """What is written of one moment, and where to."""

    file: str = ""  # "" for a new name, "-" for standard output
    size: tuple[int, int] = DEFAULT_PICTURE  # pixels
    texture: str = ""  # whose values are written, in place of the picture
    profile: bool = False
    driver: str = "auto"
    bits: int = 8  # a channel of a PNG


def _read_bits(text: str) -> int | None:
    return int(text) if text in ("8", "16") else None


_read_large = partial(read_pixels, most=MAX_PICTURE_SIDE)


def render(
    ctx: typer.Context,
    sketch: options.Sketch = "",
    output: Annotated[
        str,
        value(
            "-o --output FILE",
            "The file to write, or - for standard output. Without it, a new name in this folder.",
        ),
    ] = "",
    size: Annotated[
        Pixels | None, value("--size WxH", "Size in pixels, as 1280x720.", read=_read_large)
    ] = None,
    time: options.Time = None,
    settings: options.Set = None,
    driver: options.Driver = "auto",
    plain: options.Plain = False,
    dialect: options.Dialect = "",
    shot: Annotated[str, value("--shot NAME", "Render a shot of the sketch.")] = "",
    preset: options.Preset = "",
    texture: Annotated[str, value("--texture PASS", "Write this pass's own values, not the picture.")] = "",
    steps: options.Steps = None,
    supersample: Annotated[
        str,
        value(
            "--supersample N",
            "Draw N times as wide and high, and take the mean light of each pixel; as the sketch says by"
            " default.",
        ),
    ] = "",
    bits: Annotated[str, value("--bits N", "Bits a channel of a .png: 8, or 16.")] = "",
    profile: Annotated[bool, flag("--profile", "Print the milliseconds of each pass.")] = False,
    video: Annotated[
        str,
        value(
            "--video FILE",
            f"Write a video: {either([f'{e} ({what})' for e, what in VIDEO_ENDINGS.items()])}.",
        ),
    ] = "",
    seconds: Annotated[
        str, value("--seconds S", "With --video: how long. Without it, to the last keyframe.")
    ] = "",
    fps: Annotated[
        str,
        value("--fps N", "Pictures a second of --video and --frames: 30 by default, 4 of a sweep."),
    ] = "",
    quality: Annotated[
        str, value("--quality NAME", "With --video: low, medium, high or best; high by default.")
    ] = "",
    frames: Annotated[
        str,
        value("--frames FIRST..LAST", "Write these pictures as PNG files, named by -o, as frames/%05d.png."),
    ] = "",
    resume: Annotated[bool, flag("--resume", "With --frames: keep good files that are there.")] = False,
    sweep: Annotated[
        list[str] | None,
        value(
            "--sweep PATH=FROM..TO",
            "A picture for each value of a parameter, on one sheet. May be given twice.",
        ),
    ] = None,
    count: Annotated[str, value("-n N", "With --sweep: values of a range; 9 by default.")] = "",
    software: options.Software = False,
    device: options.Device = None,
) -> None:
    """Render a sketch to a file and print its path."""
    from playground.sketch.load import load

    series = SeriesOptions(
        video=video,
        seconds=read_option("--seconds", seconds, within(1e-6, 1e7), "a number above 0, as 10"),
        fps=read_fps(fps),
        quality=quality,
        frames=read_frames(frames),
        resume=resume,
        sweeps=tuple(sweep or ()),
        steps=read_option("-n", count, within(2, 99_999), "a whole number from 2, as 12"),
    )
    series.check(output, texture, profile)
    values, stops = read_values(settings), read_steps(steps)
    times = read_option(
        "--supersample", supersample, within(1, MAX_SUPERSAMPLE), f"a whole number, 1 to {MAX_SUPERSAMPLE}"
    )
    supersampled = "--supersample is for pictures; --texture writes the values of one pass as they are"
    refuse({supersampled: times is not None and texture})
    moment = moment_of(
        load(kept(sketch, "render"), dialect=dialect).plainly(plain),
        shot=shot,
        preset=preset,
        values=values,
        steps=stops,
        time=time,
    )
    depth = read_option("--bits", bits, _read_bits, "8 or 16") or 8
    refuse(
        {
            "--bits is for one picture; --texture writes the values of one pass as they are": bits
            and texture,
            "--bits is for one picture": bits and series.many,
        }
    )
    renderer: Renderer = ctx.obj.or_else(software, device)
    if times is not None:
        moment = replace(moment, sketch=moment.sketch.with_picture(supersample=times))
    if series.many:
        _note_hidden_defaults(moment.sketch)
        SeriesJob(series, moment, output, size, renderer, driver).make()
    else:
        chosen = size or moment.size or DEFAULT_PICTURE
        write_output(moment, Output(output, chosen, texture, profile, driver, depth), renderer)


def write_output(moment: Moment, output: Output, renderer: Renderer) -> None:
    """Render a moment to its file, and print the file's path."""
    from playground.engine.plan import located_at

    _note_hidden_defaults(moment.sketch)
    of_shot = moment.shot is not None and moment.steps == dict(moment.shot.steps)
    with (
        located_at(moment.sketch, moment.shot) if moment.shot and of_shot else nullcontext(),
        _target(output, moment) as target,
        renderer.open_engine(driver=output.driver) as engine,
    ):
        _draw(engine, output, moment, target)
        if output.profile:
            _print_profile(engine)
    if output.file != "-":
        print(target)


def _note_hidden_defaults(sketch: Sketch) -> None:
    """Note which defaults of the sketch's own kernels have no effect, because its own files override them."""
    from playground.engine.sketch_warnings import shadowed_by_files

    hidden = shadowed_by_files(sketch)
    for warning in hidden[:_MAX_LISTED]:
        note(str(warning))
    if len(hidden) > _MAX_LISTED:
        more = counted(len(hidden) - _MAX_LISTED, "more default")
        note(f"{more} that a set overrides: {program()} check lists them")


def _draw(engine: Engine, output: Output, moment: Moment, target: Path) -> None:
    """Draw the picture, or read the texture, and write it: in parts where it is too large for one frame."""
    from playground.publish.large import is_large

    if output.bits == 16 or target.suffix.lower() == ".exr":
        _draw_deep(engine, output, moment, target)
        return
    if not output.texture and is_large(engine, moment.sketch, output.size):
        if output.profile:
            raise ParameterError("--profile needs a picture that is drawn whole; choose a smaller --size")
        if target.name != "-" and target.suffix.lower() != ".png":
            raise DataError("a picture this large is drawn in parts, and written as .png", file=output.file)
        _draw_large(engine, moment, output.size, target)
        return
    at: dict[str, Any] = {"size": output.size, "time": moment.time, "steps": moment.steps}
    engine.options.keeps, engine.options.looks_early = False, True
    with busy(f"rendering {moment.sketch.name}") as show:
        engine.runner.works.on_progress = show
        if output.profile:
            _prepare_profile(engine, moment.sketch, output.texture, at)
        if output.texture:
            _write_texture(engine, moment.sketch, output.texture, target, at)
        else:
            _write_frame(engine, moment.sketch, target, at)
    _note_not_finite(engine)


def _draw_deep(engine: Engine, output: Output, moment: Moment, target: Path) -> None:
    """Draw a picture of more than 8 bits, and write it."""
    from playground.publish.deep_picture import save_deep

    if output.profile or target.name == "-" or target.suffix.lower() not in (".png", ".exr"):
        raise ParameterError("--bits 16 is for a .png without --profile, and for no other file")
    engine.options.looks_early = True
    with busy(f"rendering {moment.sketch.name}") as show:
        engine.runner.works.on_progress = show
        save_deep(engine, moment.sketch, target, output.size, time=moment.time, steps=moment.steps)
    _note_not_finite(engine)


def _write_texture(engine: Engine, sketch: Sketch, texture: str, target: Path, at: dict[str, Any]) -> None:
    from playground.data.values import write_values

    clamped = write_values(target, engine.read(sketch, texture, **at))
    if clamped:
        note(clamped)


def _write_frame(engine: Engine, sketch: Sketch, target: Path, at: dict[str, Any]) -> None:
    frame = engine.render(sketch, **at)
    if target.name == "-":
        from playground.data.image_files import encode_png

        sys.stdout.buffer.write(encode_png(frame.array))
    else:
        frame.save(target, say=note)


def _note_not_finite(engine: Engine) -> None:
    """Note which pass made NaN or infinity, if any did: the picture may show nothing of it."""
    not_finite = [not_finite for not_finite in engine.not_finite_by_pass() if not_finite is not None]
    if not_finite:
        more = f" (first of {len(not_finite)} passes)" if len(not_finite) > 1 else ""
        note(f"{not_finite[0]}{more}")


def _draw_large(engine: Engine, moment: Moment, size: tuple[int, int], target: Path) -> None:
    from playground.publish.large import count_parts, encode_strips, strips, write_large

    parts = count_parts(moment.sketch, size)
    with progress(f"rendering {moment.sketch.name} in parts", parts) as done:
        at: dict[str, Any] = {"time": moment.time, "steps": moment.steps, "done": done}
        if target.name == "-":
            encode_strips(sys.stdout.buffer, size, strips(engine, moment.sketch, size, **at))
        else:
            write_large(engine, moment.sketch, target, size, **at)


def _target(output: Output, moment: Moment) -> AbstractContextManager[Path]:
    """Open the file to write; refuse what could not be written before anything is drawn."""
    endings = tuple(VALUE_ENDINGS) if output.texture else (*PICTURE_ENDINGS, ".exr")
    if output.file == "-":
        if output.texture:
            raise ParameterError(f"--texture needs a file: -o {either([f'NAME{e}' for e in endings])}")
        check_standard_output("-o", "a PNG")
        return nullcontext(Path("-"))
    parts = [moment.sketch.name, moment.shot.name if moment.shot else "", output.texture.replace(":", "-")]
    usual = "-".join(filter(None, parts)) + endings[0]
    return output_file(output.file, usual, endings, "values are" if output.texture else "a picture is")


def _prepare_profile(engine: Engine, sketch: Sketch, texture: str, at: dict[str, Any]) -> None:
    """Draw once unmeasured, so that the measured frame compiles nothing, then forget every texture."""
    if texture:
        engine.texture(sketch, texture, **at)
    else:
        engine.draw(sketch, **at)
    engine.ctx.finish()
    engine.cache.clear()
    engine.runs.clear()
    engine.options.profiling = True


def _print_profile(engine: Engine) -> None:
    from rich.table import Table

    plan = engine.record.plan
    table = Table(title="one frame, every pass run again, nothing compiled", title_justify="left")
    table.add_column("pass", overflow="fold")
    for heading in ("texels", "iterations", "ms"):
        table.add_column(heading, justify="right")
    for path, milliseconds in engine.record.times.items():
        step = plan.step(path) if plan is not None else None
        if step is not None:
            iterations = str(engine.record.iterations[path])
            table.add_row(path, f"{step.size[0]} x {step.size[1]}", iterations, f"{milliseconds:.2f}")
    table.add_section()
    table.add_row("together", "", "", f"{sum(engine.record.times.values()):.2f}")
    console = console_for(sys.stderr)
    console.print(table)
    compiled = sum(engine.runner.compile_times.values())
    console.print(
        f"clock: {engine.clock}; compiling took {compiled:.0f} ms before that ({engine.info.renderer})",
        highlight=False,
        soft_wrap=True,
    )
