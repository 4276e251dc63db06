"""What a frame costs while the camera moves, or one draw of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from playground.sketch.model import Camera, Sketch
from playground.verify.bench.results import Figure
from playground.verify.bench.room import Room
from playground.verify.bench.rows import Row
from playground.verify.bench.timing import Samples, timed

TURN = 0.1  # degrees of the camera between two frames


def figures(row: Row, room: Room, size: int) -> Iterator[Figure]:
    """Yield the row's figure, frames of ``pixels``.

    Keys: ``draw``, the pass that is timed, else the whole picture; ``before``, the texture that it
    draws over, made untimed; ``beside``, keys of another frame that is the peer; ``camera``; ``shader``, the
    text of a draw that ``passes`` use as "./screen"; and those of the sketch, of which the peer has ``first``
    and what else it does not say itself.
    """
    options = row.options
    if "shader" in options:
        room.written("screen.glsl", str(options["shader"]))
    frames = {"": options}
    if "beside" in options:
        frames[options["beside"]["name"]] = {**options, "draw": "", "before": "", **options["beside"]}
    turning = iter(range(1, 10**9))
    loaded = {name: room.sketch(options, size) for name, options in frames.items()}

    def once(name: str, request: Any) -> tuple[float, float]:
        engine, pixels = room.engine(), tuple(options["pixels"])
        moved = _turned(loaded[name], request, next(turning))
        if request.get("before"):
            engine.texture(moved, request["before"], size=pixels)
        engine.ctx.finish()

        def draw() -> None:
            if request.get("draw"):
                engine.texture(moved, request["draw"], size=pixels)
            else:
                engine.draw(moved, size=pixels)
            engine.ctx.finish()

        return timed(draw)

    samples = {name: Samples() for name in frames}
    for number in range(-2, room.options.rounds):
        for name, frame in frames.items():
            wall, processor = once(name, frame)
            if number >= 0:
                samples[name].wall.append(wall)
                samples[name].processor.append(processor)
    own = samples.pop("")
    yield Figure(row.suite, row.name, row.what, size, "ms", row.goal, {"auto": own}, samples)


def _turned(sketch: Sketch, request: Any, number: int) -> Sketch:
    look = sketch.camera
    if "camera" in request:
        at = dict(request["camera"])
        look = Camera(**{**at, "target": tuple(at["target"])})
    return sketch.with_camera(replace(look, azimuth=look.azimuth + TURN * number))
