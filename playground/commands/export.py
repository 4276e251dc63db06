"""Export a sketch's land for other programs."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from playground.capture.extensions import KINDS, MESHES, USUAL_GRID, VALUES
from playground.commands.arguments import (
    DeviceOption,
    DriverOption,
    PlainOption,
    Renderer,
    SetOption,
    SketchArgument,
    SoftwareOption,
    StepsOption,
    TimeOption,
    either,
    help_text,
    moment_of,
    read_driver,
    read_seconds,
    read_steps,
    read_values,
)
from playground.errors import ParameterError
from playground.terminal import busy, complain, note

if TYPE_CHECKING:
    from playground.capture.export_options import Form
    from playground.sketch.model import Sketch


HELP = help_text(
    "Export a sketch's land for other programs, and print the paths of the files.\n\n"
    "Without --texture, .png, .tif, .r16, .raw, .r32, .exr and .npy hold the heights: metres above sea"
    " level as floats, or 16-bit numbers from the lowest to the highest, and what those stand for is said."
    " With it, they hold that texture; .png, .webp and .jpg encode colours as sRGB. The first row is the"
    " north's.\n\n"
    ".glb (glTF) and .obj hold the land as a mesh with its texture, in metres: x east, y up, z south,"
    " the land's middle at x = z = 0, sea level at y = 0.",
    "playground export jacksboro",
    "playground export jacksboro --to land.png --to land.tif",
    "playground export diamond_square --set size=1025 --to land.r16",
    "playground export jacksboro --texture colour --to ground.webp",
    "playground export jacksboro --to land.glb --light --grid 257",
    "playground export jacksboro --preset evening --light --to land.obj",
)


def export(
    ctx: typer.Context,
    sketch: SketchArgument = "",
    to: Annotated[
        list[str] | None,
        typer.Option(
            "-o",
            "--to",
            help=f"A file to write, ending in {either([*VALUES, *MESHES])}. May be repeated."
            " Without it, a .glb of a new name in this folder.",
            metavar="FILE",
            show_default=False,
        ),
    ] = None,
    texture: Annotated[
        str,
        typer.Option(
            "--texture",
            help="Write this pass's texture instead of the heights, or drape it over the mesh.",
            metavar="PASS",
            show_default=False,
        ),
    ] = "",
    kind: Annotated[
        str,
        typer.Option(
            "--as",
            help=f"What the texture holds: {either(KINDS)}. Without it, as its name tells:"
            " height; colour and light; anything else.",
            metavar="KIND",
            show_default=False,
        ),
    ] = "",
    bits: Annotated[
        str,
        typer.Option(
            "--bits",
            help="Bits of a number, 8, 16 or 32, where the format has a choice.",
            metavar="N",
            show_default=False,
        ),
    ] = "",
    span: Annotated[
        str,
        typer.Option(
            "--range",
            help="What 0 and the largest whole number stand for, in metres for heights.",
            metavar="LOW,HIGH",
            show_default=False,
        ),
    ] = "",
    grid: Annotated[
        str,
        typer.Option(
            "--grid",
            help=f"Vertices of a mesh's longer side. Without it, one for each texel, up to {USUAL_GRID}.",
            metavar="N",
            show_default=False,
        ),
    ] = "",
    light: Annotated[
        bool,
        typer.Option(
            "--light", metavar="", help="Bake the light into a mesh's texture, and ask for no other light."
        ),
    ] = False,
    settings: SetOption = None,
    shot: Annotated[
        str,
        typer.Option(
            "--shot", help="Export the land of a shot of the sketch.", metavar="NAME", show_default=False
        ),
    ] = "",
    preset: Annotated[
        str, typer.Option("--preset", help="Begin with a preset.", metavar="NAME", show_default=False)
    ] = "",
    steps: StepsOption = None,
    time: TimeOption = "",
    driver: DriverOption = "auto",
    plain: PlainOption = False,
    software: SoftwareOption = False,
    device: DeviceOption = "",
) -> None:
    """Write what was asked for, and print the files' paths."""
    from playground.capture.export_options import Form
    from playground.sketch.load import load

    form = Form(
        texture=texture,
        kind=kind,
        bits=_whole("--bits", bits),
        span=_span(span),
        grid=_whole("--grid", grid),
        light=light,
    )
    values, turns, seconds = read_values(settings), read_steps(steps), read_seconds(time)
    runs_by = read_driver(driver)
    moment = moment_of(
        load(sketch).plainly(plain), shot=shot, preset=preset, values=values, steps=turns, time=seconds
    )
    _write(
        moment.sketch, to or [], form, moment.time, moment.steps, runs_by, ctx.obj.or_else(software, device)
    )


def _write(
    sketch: Sketch,
    names: list[str],
    form: Form,
    seconds: float,
    turns: dict[str, int],
    driver: str,
    renderer: Renderer,
) -> None:
    from playground.api import headless
    from playground.capture.export import prepare, run
    from playground.capture.export_options import check
    from playground.images.files import new_name

    with ExitStack() as stack:
        paths = [Path(name).expanduser() for name in names]
        _refuse_twins(paths)
        if not paths:
            check(Path(f"{sketch.name}.glb"), form)
            paths = [stack.enter_context(new_name(f"{sketch.name}.glb"))]
        for path in paths:
            check(path, form)
        stack.enter_context(busy(f"exporting {sketch.name}"))
        engine = stack.enter_context(
            headless(software=renderer.software, device=renderer.device, driver=driver)
        )
        # Every file is thought of before the first is written.
        jobs = [prepare(engine, sketch, path, form, time=seconds, steps=turns) for path in paths]
        for job in jobs:
            done = run(engine, job)
            note(f"{done.path.name}: {done.summary}")
            for warning in done.warnings:
                complain(f"{done.path.name}: {warning}", "warning")
            for path in (done.path, *done.sidecars):
                print(path)


def _refuse_twins(paths: list[Path]) -> None:
    from playground.capture.export_options import sidecar_paths

    taken: set[Path] = set()
    for path in paths:
        files = {file.resolve(): file for file in (path, *sidecar_paths(path))}
        twins = [named for file, named in files.items() if file in taken]
        if twins:
            raise ParameterError(f"--to {path}: {min(twins)} would be written twice; choose another name")
        taken |= files.keys()


def _whole(option: str, text: str) -> int:
    if text and not (text.isdecimal() and 0 < int(text) < 10**6):
        raise ParameterError(f"{option} {text}: expected a whole number above 0")
    return int(text or 0)


def _span(text: str) -> tuple[float, float] | None:
    if not text:
        return None
    try:
        low, high = (float(part) for part in text.split(","))
    except ValueError:
        raise ParameterError(f"--range {text}: expected two numbers, as 0,2500") from None
    return low, high
