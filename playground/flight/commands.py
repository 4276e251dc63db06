"""Fly over endless terrain, or write the pictures of a flight."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from playground.commands import options
from playground.commands.arguments import (
    Renderer,
    check_parent,
    help_text,
    read_option,
    read_values,
    refuse,
    with_whole_paths,
    within,
)
from playground.commands.options import complete_sketch, positional, value
from playground.sketch.model import DEFAULT_PICTURE
from playground.studio.commands import check_display
from playground.terminal import busy, progress

if TYPE_CHECKING:
    from playground.flight.record import Record
    from playground.sketch.model import Sketch

DEFAULT_FLIGHT = "flight"

HELP = help_text(
    "Fly over terrain that has no end.\n\nIt is generated during the flight, part by part, from a sketch"
    " whose height has a parameter 'part'. Keys, mouse or gamepad; ? in the window lists them. With --replay"
    " and --frames, pictures are written without a window.",
    "playground fly",
    "playground fly flight --set daylight.hour=17.5",
    "playground fly --record evening.jsonl",
    "playground fly --replay evening.jsonl",
    "playground fly --replay evening.jsonl --frames pictures --every 30",
)


@dataclass(frozen=True, kw_only=True)
class Request:
    """What flight is to be flown, and how."""

    sketch: str = ""
    size: tuple[int, int] | None = None
    values: dict[str, object] = field(default_factory=dict)
    record: str = ""
    replay: str = ""
    frames: str = ""
    every: int = 0
    radius: float | None = None
    driver: str = "auto"
    plain: bool = False
    renderer: Renderer

    def check(self) -> None:
        """Raise ``ParameterError`` for options that do not go together."""
        record, replay, frames, every = self.record, self.replay, self.frames, self.every
        needs = "needs --replay FILE, a flight recorded before"
        refuse(
            {
                "--record and --replay: one flight is either flown or flown again": record and replay,
                f"--frames {needs}": frames and not replay,
                f"--every {needs}": every and not replay,
                "--every needs --frames FOLDER, to write pictures into": every and not frames,
                "--radius cannot change a recorded flight, which has its own": replay and self.radius,
            }
        )

    def load(self, record: Record | None) -> tuple[Sketch, dict[str, object]]:
        """Load the sketch with the values of the record and its own; return it and its own values."""
        from playground.sketch.load import load

        loaded = load(self.sketch or (record.header.sketch if record else DEFAULT_FLIGHT))
        loaded = loaded.plainly(self.plain).with_values(record.header.values if record else {})
        values = with_whole_paths(loaded, self.values)
        return loaded.with_values(values), values


def fly(
    ctx: typer.Context,
    sketch: Annotated[
        str,
        positional(
            "SKETCH",
            f"A shipped sketch's name, or the path of a sketch. Without it, {DEFAULT_FLIGHT}.",
            complete_sketch,
        ),
    ] = "",
    size: options.Size = None,
    settings: options.Set = None,
    record: Annotated[str, value("--record FILE", "Write the flight to this file.")] = "",
    replay: Annotated[str, value("--replay FILE", "Fly a recorded flight again.")] = "",
    frames: Annotated[
        str,
        value("--frames FOLDER", "With --replay: write its pictures into this folder, without a window."),
    ] = "",
    every: Annotated[
        str,
        value("--every N", "With --frames: steps of 1/60 s from one picture to the next; 6 by default."),
    ] = "",
    radius: Annotated[
        str, value("--radius PARTS", "How many parts are visible, 1.5 to 16; 5 by default.")
    ] = "",
    driver: options.Driver = "auto",
    plain: options.Plain = False,
    software: options.Software = False,
    device: options.Device = None,
) -> None:
    """Fly in a window, or write the pictures of a recorded flight and print their paths."""
    request = Request(
        sketch=sketch,
        size=size,
        values=read_values(settings),
        record=record,
        replay=replay,
        frames=frames,
        every=read_option("--every", every, within(1, 10**8 - 1), "a whole number of steps from 1, as 30")
        or 0,
        radius=read_radius(radius),
        driver=driver,
        plain=plain,
        renderer=ctx.obj.or_else(software, device),
    )
    request.check()
    if frames:
        _write(request)
    else:
        _open(request)


def read_radius(text: str) -> float | None:
    """Return the number of ``--radius``; raise ``ParameterError``."""
    if not text:
        return None
    from playground.flight.record import MAX_RADIUS, MIN_RADIUS

    expected = f"a number of parts, {MIN_RADIUS:g} to {MAX_RADIUS:g}"
    return read_option("--radius", text, within(MIN_RADIUS, MAX_RADIUS), expected)


def _write(request: Request) -> None:
    """Write the pictures of a recorded flight into the folder, and print their paths."""
    from playground.files import make_folder
    from playground.flight.flight import CACHE_BYTES, EVERY, count_frames, write_frames
    from playground.flight.record import read_record

    record = read_record(request.replay)
    sketch, _ = request.load(record)
    target = make_folder(Path(request.frames).expanduser())
    every = request.every or EVERY
    with busy(f"opening {sketch.name}"):
        engine = request.renderer.open_engine(driver=request.driver, cache_bytes=CACHE_BYTES)
    with engine, progress(f"flying over {sketch.name}", count_frames(record, every)) as done:
        paths = write_frames(engine, sketch, record, target, every=every, size=request.size, done=done)
    for path in paths:
        print(path)


def _open(request: Request) -> None:
    """Fly in a window until it is closed."""
    from playground.flight.record import read_record
    from playground.sketch.find import find

    if request.renderer.device is not None:
        check_display(request.renderer)
    record = read_record(request.replay) if request.replay else None
    sketch, values = request.load(record)
    if request.record:
        check_parent(Path(request.record), request.record)
    check_display(request.renderer)
    from playground.flight.window import run

    # What a record names must be found again from another folder.
    name = request.sketch or (record.header.sketch if record else DEFAULT_FLIGHT)
    status = run(
        sketch,
        str(find(name).absolute()) if Path(name).exists() else name,
        values=values,
        size=request.size or (record.header.size if record else DEFAULT_PICTURE),
        record=request.record,
        replay=record,
        radius=request.radius,
        software=request.renderer.software,
        driver=request.driver,
    )
    if status:
        raise typer.Exit(status)


def add_to(app: typer.Typer) -> None:
    """Add the room's command to a command line."""
    app.command("fly", help=HELP)(fly)
