"""What a picture in the window costs while the camera moves: as large as a preview has it by then."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from playground.studio.session import Session
from playground.verify.bench.results import Figure
from playground.verify.bench.room import Room
from playground.verify.bench.rows import Row
from playground.verify.bench.timing import Samples, timed

SETTLES = 8  # pictures until the size of a preview has settled
TURN = 0.3  # degrees of the camera between two


def figures(row: Row, room: Room, size: int) -> Iterator[Figure]:
    """Yield the figure of a moving picture of ``sketch``, in a window of ``pixels``."""
    engine, pixels = room.engine(), tuple(row.options["pixels"])
    session = Session(engine, str(row.options["sketch"]))
    try:
        session.clock.playing = False
        session.frame(pixels)
        if session.error is not None:
            raise session.error
        assert session.sketch is not None
        camera = session.sketch.camera
        session.read()  # in full
        moving = Samples()
        for number in range(1, room.options.rounds + SETTLES + 1):
            session.drafts.set_camera(replace(camera, azimuth=camera.azimuth + TURN * number))
            engine.ctx.finish()

            def draw() -> None:
                session.frame(pixels)
                engine.ctx.finish()

            wall, processor = timed(draw)
            if number > SETTLES:
                moving.wall.append(wall)
                moving.processor.append(processor)
        drawn = session.picture.drawn_size
    finally:
        session.release()
    what = f"{row.what} ({drawn[0]} × {drawn[1]} by then)"
    yield Figure(row.suite, row.name, what, size, "ms", row.goal, {"auto": moving})
