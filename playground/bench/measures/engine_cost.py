"""What the engine itself costs: Python a pass, a frame in which nothing has changed, calls of OpenGL."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from playground.bench.gl_counts import counted
from playground.bench.results import Figure
from playground.bench.room import Room, changing
from playground.bench.rows import Row
from playground.bench.timing import Run, Samples, alternate
from playground.engine.plan import LoopStep, Plan


def figures(row: Row, room: Room, size: int) -> Iterator[Figure]:
    """Yield the figures of ``of``: "passes", "unchanged" or "calls"."""
    of = {"passes": _passes, "unchanged": _unchanged, "calls": _calls}[row.options["of"]]
    yield from of(row, room, size)


def _passes(row: Row, room: Room, size: int) -> Iterator[Figure]:
    """Yield milliseconds a pass of the loop ``loop``, over textures so small that drawing is nothing.

    The peer is what the driver takes of that: a program that fills textures as small, called by moderngl
    alone, and as many textures bound.
    """
    options, engine = row.options, room.engine()
    sketch, wanted = room.sketch(options, size), str(options["texture"])
    change = changing(room, options)
    plan = engine.internal.plan_for(sketch, (64, 36), 0.0, None, wanted)
    steps = _steps_of(plan, str(options["loop"]))

    def ours() -> None:
        engine.texture(change(sketch), wanted)
        engine.ctx.finish()

    (side, _) = next(step.size for step in plan.walk() if step.path.startswith(f"{options['loop']}."))
    bare = _bare(room, steps, side)
    samples = alternate({"auto": ours, "moderngl alone": bare}, room.options.rounds, unmeasured=2)
    for found in samples.values():
        found.wall = [each / steps for each in found.wall]
        found.processor = [each / steps for each in found.processor]
    own = {"auto": samples.pop("auto")}
    yield Figure(row.suite, row.name, row.what, size, "ms", row.goal, own, samples)


def _steps_of(plan: Plan, path: str) -> int:
    loop = next(node for node in plan.nodes if node.path == path)
    assert isinstance(loop, LoopStep), path
    return loop.repeat * len(loop.body)


def _bare(room: Room, steps: int, size: int) -> Run:
    ctx = room.engine().ctx
    program = ctx.program(
        vertex_shader="#version 330\nvoid main() { vec2 at = vec2(gl_VertexID & 1, gl_VertexID >> 1);"
        " gl_Position = vec4(at * 4.0 - 1.0, 0.0, 1.0); }",
        fragment_shader="#version 330\nuniform sampler2D one; uniform sampler2D two; out vec4 found;"
        " void main() { ivec2 at = ivec2(gl_FragCoord.xy);"
        " found = texelFetch(one, at, 0) + texelFetch(two, at, 0); }",
    )
    program["two"] = 1
    array = ctx.vertex_array(program, [])
    textures = [ctx.texture((size, size), 4, dtype="f4") for _ in range(3)]
    targets = [ctx.framebuffer([texture]) for texture in textures]

    def run() -> None:
        ctx.disable(ctx.BLEND | ctx.DEPTH_TEST | ctx.CULL_FACE)
        for number in range(steps):
            textures[number % 3].use(0)
            textures[(number + 1) % 3].use(1)
            targets[(number + 2) % 3].use()
            array.render(ctx.TRIANGLES, vertices=3)
        ctx.finish()

    return run


def _unchanged(row: Row, room: Room, size: int) -> Iterator[Figure]:
    """Yield the time of a frame in which only the camera has moved a pass that takes nothing, by passes."""
    engine = room.engine()
    for passes in row.options["counts"]:
        text = '[[pass]]\nname = "p0"\nuse = "./flat"\nsize = 4\n'
        for number in range(1, passes):
            text += f'[[pass]]\nname = "p{number}"\nuse = "./flat"\nsize = 4\n'
        room.written("flat.glsl", str(row.options["shader"]))
        sketch = room.sketch({**row.options, "passes": text + str(row.options["view"])}, 0)
        turning = iter(range(1, 10**9))

        def run(sketch=sketch, turning=turning) -> None:  # type: ignore[no-untyped-def]
            look = sketch.camera
            engine.draw(sketch.with_camera(replace(look, azimuth=look.azimuth + next(turning))), size=(16, 9))
            engine.ctx.finish()

        samples = alternate({"auto": run}, room.options.rounds, unmeasured=3)
        name, what = f"{row.name}-{passes}", row.what.replace("N", str(passes))
        yield Figure(row.suite, name, what, 0, "ms", row.goal, samples)


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
        found = {"auto": Samples([float(count)])}
        yield Figure(row.suite, name, what, size, "", row.goal, found)
