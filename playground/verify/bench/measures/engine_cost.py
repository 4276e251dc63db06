"""What the engine itself costs: Python a pass, a frame in which nothing has changed, calls of OpenGL."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from playground.engine.plan import LoopStep, Plan
from playground.sketch.model import Sketch
from playground.verify.bench.gl_counts import counted, timed_calls
from playground.verify.bench.results import Figure
from playground.verify.bench.room import Room, changing
from playground.verify.bench.rows import Row
from playground.verify.bench.timing import Samples, alternate, timed


def figures(row: Row, room: Room, size: int) -> Iterator[Figure]:
    """Yield the figures of ``of``: "passes", "unchanged" or "calls"."""
    of = {"passes": _passes, "unchanged": _unchanged, "calls": _calls}[row.options["of"]]
    yield from of(row, room, size)


def _passes(row: Row, room: Room, size: int) -> Iterator[Figure]:
    """Yield milliseconds of Python a pass of the loop ``loop``: without those inside calls of OpenGL."""
    options, engine = row.options, room.engine()
    sketch, texture = room.sketch(options, size), str(options["texture"])
    change = changing(room, options)
    plan = engine.plan(sketch, (64, 36), 0.0, None, texture)
    steps = _steps_of(plan, str(options["loop"]))
    samples = Samples()
    for number in range(-2, room.options.rounds):
        with timed_calls() as calls:
            wall, _ = timed(lambda: engine.texture(change(sketch), texture))
        if number >= 0:
            samples.wall.append((wall - calls.milliseconds) / steps)
    yield Figure(row.suite, row.name, row.what, size, "ms", row.goal, {"auto": samples})


def _steps_of(plan: Plan, path: str) -> int:
    loop = next(node for node in plan.nodes if node.path == path)
    assert isinstance(loop, LoopStep), path
    return loop.repeat * len(loop.body)


def _unchanged(row: Row, room: Room, size: int) -> Iterator[Figure]:
    """Yield the time of a frame in which only the camera has moved a pass that takes nothing, by passes.

    In a ``chain`` each reads the one before it, and the picture the last; otherwise it reads only the first.
    """
    engine = room.engine()
    for passes in row.options["counts"]:
        sketch = unchanging(row, room, passes)

        def run(sketch=sketch) -> None:  # type: ignore[no-untyped-def]
            look = sketch.camera  # turned further each time: else its picture would be known
            moved = sketch.with_camera(replace(look, azimuth=look.azimuth + 0.1 * next(room.numbers)))
            engine.draw(moved, size=(16, 9))
            engine.ctx.finish()

        samples = alternate({"auto": run}, room.options.rounds, unmeasured=3)
        name, what = f"{row.name}-{passes}", row.what.replace("N", str(passes))
        yield Figure(row.suite, name, what, 0, "ms", row.goal, samples)


def unchanging(row: Row, room: Room, passes: int) -> Sketch:
    """Return a sketch of so many passes of the kernel ``shader``, for the row's ``view`` of @."""
    chain, text = bool(row.options.get("chain")), ""
    room.written("flat.glsl", str(row.options["shader"]))
    for number in range(passes):
        text += f'[[pass]]\nname = "p{number}"\nuse = "./flat"\nsize = 4\n'
        if chain and number:
            text += f'inputs = {{ height = "p{number - 1}" }}\n'
    view = str(row.options["view"]).replace("@", f"p{passes - 1 if chain else 0}")
    return room.sketch({**row.options, "passes": text + view}, 0)


def _calls(row: Row, room: Room, size: int) -> Iterator[Figure]:
    """Yield how often a frame in which the camera moves calls OpenGL, and how many bytes it moves."""
    engine, pixels = room.engine(), tuple(row.options["pixels"])
    sketch = room.sketch(row.options, size)
    for number in range(1, 4):
        look = sketch.camera
        moved = sketch.with_camera(replace(look, azimuth=look.azimuth + number))
        with counted() as counts:
            engine.draw(moved, size=pixels)
    for kind, count in counts.items():
        name, what = f"{row.name}-{kind.replace(' ', '-')}", f"{row.what}: {kind}"
        samples = {"auto": Samples([float(count)])}
        yield Figure(row.suite, name, what, size, "", row.goal, samples)
