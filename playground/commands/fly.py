"""Fly over an endless land, or write the pictures of a flight."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from playground.commands.arguments import (
    DeviceOption,
    DriverOption,
    Renderer,
    SetOption,
    SizeOption,
    SoftwareOption,
    complete_sketch,
    help_text,
    read_driver,
    read_pixels,
    read_values,
    with_whole_paths,
)
from playground.errors import ContextError, DataError, ParameterError
from playground.sketch.model import DEFAULT_PICTURE
from playground.terminal import busy, progress

DEFAULT_FLIGHT = "flight"

HELP = help_text(
    "Fly over a land that has no end.\n\nIt is made while one flies, part by part, from a sketch whose height"
    " has a parameter 'part'. Keys, mouse or gamepad; ? in the window lists them. With --replay and --frames,"
    " pictures are written without a window.",
    "playground fly",
    "playground fly flight --set daylight.hour=17.5",
    "playground fly --record evening.jsonl",
    "playground fly --replay evening.jsonl",
    "playground fly --replay evening.jsonl --frames pictures --every 30",
)


def fly(
    ctx: typer.Context,
    sketch: Annotated[
        str,
        typer.Argument(
            help=f"A shipped sketch's name, or the path of a sketch. Without it, {DEFAULT_FLIGHT}.",
            metavar="SKETCH",
            show_default=False,
            autocompletion=complete_sketch,
        ),
    ] = "",
    size: SizeOption = None,
    settings: SetOption = None,
    record: Annotated[
        str,
        typer.Option("--record", help="Write the flight to this file.", metavar="FILE", show_default=False),
    ] = "",
    replay: Annotated[
        str,
        typer.Option("--replay", help="Fly a recorded flight again.", metavar="FILE", show_default=False),
    ] = "",
    frames: Annotated[
        str,
        typer.Option(
            "--frames",
            help="With --replay: write its pictures into this folder, without a window.",
            metavar="FOLDER",
            show_default=False,
        ),
    ] = "",
    every: Annotated[
        str,
        typer.Option(
            "--every",
            help="With --frames: steps of 1/60 s from one picture to the next; 6 unless told.",
            metavar="N",
            show_default=False,
        ),
    ] = "",
    radius: Annotated[
        str,
        typer.Option(
            "--radius",
            help="How many parts one sees, 1.5 to 16; 5 unless told.",
            metavar="PARTS",
            show_default=False,
        ),
    ] = "",
    driver: DriverOption = "auto",
    software: SoftwareOption = False,
    device: DeviceOption = "",
) -> None:
    """Fly in a window, or write the pictures of a recorded flight and print their paths."""
    renderer: Renderer = ctx.obj.or_else(software, device)
    pixels, values, seen = read_pixels(size), read_values(settings), read_radius(radius)
    chosen, steps = read_driver(driver), read_every(every)
    if record and replay:
        raise ParameterError("--record and --replay: one flight is either flown or flown again")
    if (frames or every) and not replay:
        raise ParameterError(
            f"{'--frames' if frames else '--every'} needs --replay FILE, a flight recorded before"
        )
    if every and not frames:
        raise ParameterError("--every needs --frames FOLDER, to write pictures into")
    if replay and seen:
        raise ParameterError("--radius cannot change a recorded flight, which has its own")
    if frames:
        _write(replay, frames, sketch, pixels, values, steps, chosen, renderer)
        return
    _open(sketch, pixels, values, record, replay, seen, chosen, renderer)


def read_radius(text: str) -> float | None:
    """Return the number of ``--radius``; raise ``ParameterError``."""
    if not text:
        return None
    try:
        found = float(text)
    except ValueError:
        found = 0.0
    from playground.flight.record import LEAST_RADIUS, MOST_RADIUS

    if not LEAST_RADIUS <= found <= MOST_RADIUS:
        raise ParameterError(
            f"--radius {text}: expected a number of parts, {LEAST_RADIUS:g} to {MOST_RADIUS:g}"
        )
    return found


def read_every(text: str) -> int:
    """Return the steps of ``--every``; raise ``ParameterError``."""
    if not text:
        return 0
    if not (text.isdecimal() and 1 <= int(text[:9]) and len(text) < 9):
        raise ParameterError(f"--every {text}: expected a whole number of steps from 1, as 30")
    return int(text)


def _write(
    replay: str,
    frames: str,
    sketch: str,
    size: tuple[int, int] | None,
    values: dict[str, object],
    every: int,
    driver: str,
    renderer: Renderer,
) -> None:
    from playground.engine.engine import Engine
    from playground.flight.flight import CACHE_BYTES
    from playground.flight.frames import EVERY, count_frames, prepared, write_frames
    from playground.flight.record import read_record
    from playground.gpu.context import open_context
    from playground.sketch.load import load

    record = read_record(replay)
    found = load(sketch or record.header.sketch).with_values(record.header.values)
    found = found.with_values(with_whole_paths(found, values))
    target, steps = prepared(frames), every or EVERY
    total = count_frames(record, steps)
    with busy(f"opening {found.name}"):
        context = open_context(software=renderer.software, device=renderer.device)
    engine = Engine(context, driver=driver, cache_bytes=CACHE_BYTES, owns_context=True)
    with engine, progress(f"flying over {found.name}", total) as done:
        paths = write_frames(engine, found, record, target, every=steps, size=size, done=done)
    for path in paths:
        print(path)


def _open(
    sketch: str,
    size: tuple[int, int] | None,
    values: dict[str, object],
    record: str,
    replay: str,
    radius: float | None,
    driver: str,
    renderer: Renderer,
) -> None:
    from playground.flight.record import read_record
    from playground.gpu.doctor import where_to_show
    from playground.sketch.find import find
    from playground.sketch.load import load

    if renderer.device is not None:
        raise ContextError("--device is for pictures without a window; a window opens where its display is")
    known = read_record(replay) if replay else None
    name = sketch or (known.header.sketch if known else DEFAULT_FLIGHT)
    found = load(name)
    if known:
        found = found.with_values(known.header.values)
    values = with_whole_paths(found, values)
    found = found.with_values(values)
    if record and not Path(record).expanduser().parent.is_dir():
        raise DataError(f"there is no folder '{Path(record).parent}' to write into", file=record)
    if not where_to_show(os.environ, sys.platform):
        from playground.gpu.driver_advice import mend

        raise ContextError(mend("unable to open display", sys.platform, os.environ))
    from playground.live.fly import run

    # What a record names must be found again from another folder.
    whole = str(find(name).absolute()) if Path(name).exists() else name
    status = run(
        found,
        whole,
        values=values,
        size=size or (known.header.size if known else DEFAULT_PICTURE),
        record=record,
        replay=known,
        radius=radius,
        software=renderer.software,
        driver=driver,
    )
    if status:
        raise typer.Exit(status)
