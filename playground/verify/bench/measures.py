"""Measure rows: a texture, a frame, a process, a comparison of pictures, or what the engine itself costs.

Each measure is a function (row, context, size) that yields figures; rooms bring more by their ``measures``
module, whose ``MEASURES`` are functions (bench, options, size) that yield, for each figure, what follows
the row's name, what follows its text, and (wall, processor) milliseconds of each run.


Run the rows that were chosen, one after the other, and say on what machine.
"""

from __future__ import annotations

import importlib
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import datetime
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Any

import moderngl
import numpy as np

from playground._version import __version__
from playground.engine.cache import VERSIONS
from playground.engine.plan import LoopStep, Plan
from playground.errors import PlaygroundError
from playground.extras import install_command
from playground.rooms import modules
from playground.sketch.model import Camera, Sketch
from playground.sketch.variants import any_variants
from playground.verify.bench.context import (
    BenchContext,
    Options,
    Run,
    Samples,
    alternate,
    beyond,
    changing,
    processors,
    timed,
)
from playground.verify.bench.peers import PeerSetup, made
from playground.verify.bench.results import Figure, Results
from playground.verify.bench.rows import Row
from playground.verify.shots.flip import flip
from playground.verify.shots.judge import judge
from playground.verify.shots.references import Fingerprint, Reference

# ── calls of OpenGL, counted and timed ────────────────────────────────────────────────────────────


_CALLS: dict[str, tuple[tuple[type, str], ...]] = {
    "draw calls": ((moderngl.VertexArray, "render"), (moderngl.VertexArray, "render_indirect")),
    "dispatches": ((moderngl.ComputeShader, "run"),),
    "textures bound": ((moderngl.Texture, "use"), (moderngl.Texture, "bind_to_image")),
    "samplers bound": ((moderngl.Sampler, "use"),),
    "framebuffers bound": ((moderngl.Framebuffer, "use"),),
    "mipmaps made": ((moderngl.Texture, "build_mipmaps"),),
    "copies of framebuffers": ((moderngl.Context, "copy_framebuffer"),),
    "waits": ((moderngl.Context, "finish"),),
}
_MOVED: tuple[tuple[type, str], ...] = (
    (moderngl.Texture, "write"),
    (moderngl.Texture, "read"),
    (moderngl.Buffer, "write"),
    (moderngl.Buffer, "read"),
)
_OTHERS: tuple[tuple[type, str], ...] = (
    (moderngl.Context, "enable_direct"),
    (moderngl.Context, "disable_direct"),
    (moderngl.Context, "disable"),
    (moderngl.Context, "texture"),
    (moderngl.Context, "memory_barrier"),
)
BYTES = "bytes moved"


@contextmanager
def counted() -> Iterator[dict[str, int]]:
    """Count within, by kind; what is created meanwhile, and its first texels, are not counted."""
    counts = dict.fromkeys((*_CALLS, BYTES), 0)
    changed: list[tuple[type, str, Any]] = []

    def count(kind: str, owner: type, name: str, amount: Callable[[Any, Any], int]) -> None:
        own = getattr(owner, name)

        def call(*arguments: Any, **named: Any) -> Any:
            result = own(*arguments, **named)
            counts[kind] += amount(arguments, result)
            return result

        changed.append((owner, name, own))
        setattr(owner, name, call)

    try:
        for kind, calls in _CALLS.items():
            for owner, name in calls:
                count(kind, owner, name, lambda arguments, result: 1)
        for owner, name in _MOVED:
            count(BYTES, owner, name, _size_of)
        yield counts
    finally:
        for owner, name, own in changed:
            setattr(owner, name, own)


@dataclass
class Spent:
    """The time that calls took."""

    milliseconds: float = 0.0


@contextmanager
def timed_calls() -> Iterator[Spent]:
    """Time what happens inside the calls of OpenGL that drawing makes, but for those that set uniforms."""
    spent = Spent()
    clock = time.perf_counter
    changed: list[tuple[type, str, Any]] = []
    try:
        for owner, name in (*chain(*_CALLS.values()), *_MOVED, *_OTHERS):
            own = getattr(owner, name)

            def call(*arguments: Any, own: Any = own, **named: Any) -> Any:
                start = clock()
                try:
                    return own(*arguments, **named)
                finally:
                    spent.milliseconds += (clock() - start) * 1e3

            changed.append((owner, name, own))
            setattr(owner, name, call)
        yield spent
    finally:
        for owner, name, own in changed:
            setattr(owner, name, own)


def _size_of(arguments: tuple[Any, ...], result: Any) -> int:
    """Return the bytes that a call gave or was given."""
    moved = result if isinstance(result, bytes) else arguments[1] if len(arguments) > 1 else b""
    return moved.size if isinstance(moved, moderngl.Buffer) else memoryview(moved).nbytes


# ── one texture, made again each time, next to what else makes the same ───────────────────────────


FORMS = ("auto", "fragment", "plain")
"""By compute shaders where there are any; without; and in the canonical form, without fast variants."""


def _texture(row: Row, context: BenchContext, size: int) -> Iterator[Figure]:
    """Yield the row's figure: each form of ours, each peer.

    Keys: ``texture``, what is read; ``seeds``, ``suns`` and ``nudged``, what is new each time (see
    ``changing``); ``forms``; and those of the sketch (see ``BenchContext.sketch``). ``part`` is a texture
    that it is made of, whose own time is taken off: each round makes one of another terrain as well.
    """
    options = row.options
    sketch, texture = context.sketch(options, size), str(options["texture"])
    varied = any(any_variants(each.technique) for each in sketch.graph.passes if each.name != "height")
    runs: dict[str, Run] = {}
    parts: dict[str, Run] = {}
    for form in options.get("forms", FORMS):
        if form == "plain" and not varied:
            continue
        engine = context.engine("auto" if form == "plain" else form)
        change = changing(context, options)

        def run(of: str, plain: bool = form == "plain", engine=engine, change=change) -> None:  # type: ignore[no-untyped-def]
            engine.texture(change(sketch).plainly(plain), of)
            engine.ctx.finish()

        runs[form] = partial(run, texture)
        if "part" in options:
            parts[_part_of(form)] = partial(run, str(options["part"]))
    setting = PeerSetup(context, size, options)
    peers = [peer for options in row.peers if (peer := made(setting, options)) is not None]
    for name in setting.missing:
        context.options.say(f"{name} is not installed, and is left out; {install_command('bench')}")
    ours = list(runs)
    runs |= parts
    for _ in range(VERSIONS):  # from then on textures are used again, as while one drags
        for warm_up in runs.values():
            warm_up()
    runs |= {peer.name: peer.run for peer in peers}
    once = [peer.name for peer in peers if peer.once]
    samples = alternate(runs, context.rounds, once=once)
    yield Figure(
        row.suite,
        row.name,
        row.what,
        size,
        "ms",
        row.goal,
        {name: beyond(samples[name], samples[_part_of(name)]) if parts else samples[name] for name in ours},
        {peer.name: samples[peer.name] for peer in peers},
        frozenset(peer.name for peer in peers if peer.alone),
    )


def _part_of(form: str) -> str:
    """Return the name of the run that makes the part, of a form."""
    return f"{form}, part"


# ── a frame while the camera or the clock moves, or one draw of it ────────────────────────────────


TURN = 0.1  # degrees of the camera between two frames


def _frame(row: Row, context: BenchContext, size: int) -> Iterator[Figure]:
    """Yield the row's figure, frames of ``pixels``.

    Keys: ``draw``, the pass that is timed, else the whole picture; ``before``, the texture that it
    draws over, made untimed; ``beside``, keys of another frame that is the peer; ``camera``; ``advance``,
    seconds of the sketch between two frames; ``shader``, the text of a draw that ``passes`` use as
    "./screen"; and those of the sketch, of which the peer has ``first`` and what else it does not say
    itself.
    """
    options = row.options
    if "shader" in options:
        context.written("screen.glsl", str(options["shader"]))
    frames = {"": options}
    if "beside" in options:
        frames[options["beside"]["name"]] = {**options, "draw": "", "before": "", **options["beside"]}
    turning = iter(range(1, 10**9))
    loaded = {name: context.sketch(options, size) for name, options in frames.items()}

    def once(name: str, request: Any) -> tuple[float, float]:
        engine, pixels = context.engine(), tuple(options["pixels"])
        number = next(turning)
        moved, moment = _turned(loaded[name], request, number), number * float(request.get("advance", 0.0))
        if request.get("before"):
            engine.texture(moved, request["before"], size=pixels, time=moment)
        engine.ctx.finish()

        def draw() -> None:
            if request.get("draw"):
                engine.texture(moved, request["draw"], size=pixels, time=moment)
            else:
                engine.draw(moved, size=pixels, time=moment)
            engine.ctx.finish()

        return timed(draw)

    samples = {name: Samples() for name in frames}
    for number in range(-2, context.rounds):
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


# ── whole processes: from their start to their end or to a picture, and of memory ─────────────────


MIB = 2**20
_MARK = "spent "
# A process prints what it took so far as JSON: seconds of processors, bytes at most.
_SPENT = """
def spent():
    import json, sys
    try:
        import resource
        own = resource.getrusage(resource.RUSAGE_SELF)
        most = own.ru_maxrss * (1 if sys.platform == "darwin" else 1024)
        times = [own.ru_utime + own.ru_stime, most]
    except ImportError:
        import time
        times = [time.process_time(), 0]
    print("spent", json.dumps(times), flush=True)
"""
_ENDS = "\nspent()\n"


def _process(row: Row, context: BenchContext, size: int) -> Iterator[Figure]:
    """Yield the figure of a process that runs the Python text ``code``.

    In it, ``{out}`` is a file that it may write, ``{cache}`` a folder of all runs, and ``{size}`` the texels
    a side; where it calls ``spent()``, the time ends there, else with the process. ``prepare`` runs once
    before, untimed; ``takes`` is "time" or "memory"; ``cold`` gives each run an empty shader cache.
    """
    options = row.options
    names = {"{out}": context.folder / "out.png", "{cache}": context.folder / row.name, "{size}": size}

    def text_of(key: str) -> str:
        text = str(options[key])
        for name, what in names.items():
            text = text.replace(name, str(what))
        return text

    usual = environment_of(context)
    if "prepare" in options:
        spent(text_of("prepare"), usual)
    samples = Samples()
    memory = options.get("takes") == "memory"
    rounds = 1 if memory else context.rounds
    for number in range(0 if memory or options.get("cold") else -1, rounds):
        environment = dict(usual)
        if options.get("cold"):
            cache = context.folder / f"cache{next(context.numbers)}"
            environment |= {"MESA_SHADER_CACHE_DIR": str(cache), "PLAYGROUND_CACHE": "0"}
        wall, seconds, most = spent(text_of("code"), environment)
        if number < 0:
            continue
        samples.wall.append(most / MIB if memory else wall * 1e3)
        if not memory:
            samples.processor.append(seconds * 1e3)
    if memory and not any(samples.wall):
        context.options.say(f"{row.name}: this system does not say how much memory a process took")
        return
    unit = "MiB" if memory else "ms"
    yield Figure(row.suite, row.name, row.what, size, unit, row.goal, {"auto": samples})


def environment_of(context: BenchContext) -> dict[str, str]:
    """Return this process's environment, in which compiled modules are written and found."""
    own = {"PYTHONDONTWRITEBYTECODE": "", "PYTHONPYCACHEPREFIX": str(context.folder / "modules")}
    return {**os.environ, **own}


def spent(code: str, environment: Mapping[str, str]) -> tuple[float, float, float]:
    """Run Python text in a process; return seconds on the clock, of processors, and bytes at most.

    Raises ``PlaygroundError`` with its last words where it fails.
    """
    ends = "spent()" not in code
    command = [sys.executable, "-c", _SPENT + code + (_ENDS if ends else "")]
    start, wall, times = time.perf_counter(), 0.0, [0.0, 0.0]
    with (
        tempfile.TemporaryFile("w+", encoding="utf-8") as errors,
        subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=errors, text=True, env=dict(environment)
        ) as process,
    ):
        assert process.stdout is not None
        for line in process.stdout:
            if line.startswith(_MARK):
                wall = time.perf_counter() - start
                times = json.loads(line.removeprefix(_MARK))
        process.wait()
        if ends:
            wall = time.perf_counter() - start
        if process.returncode:
            errors.seek(0)
            last = (errors.read().strip().splitlines() or ["it said nothing"])[-1]
            raise PlaygroundError(f"a process of the benchmark failed: {last}")
    return wall, float(times[0]), float(times[1])


# ── comparing two pictures that differ by noise ──────────────────────────────


def _comparison(row: Row, context: BenchContext, size: int) -> Iterator[Figure]:
    """Yield the figure of ``of``, for pictures of ``pixels``: "flip" or "judge".

    ``alike``: the picture is the reference; ``beside``: FLIP's authors' own is the peer.
    """
    width, height = row.options["pixels"]
    rows, columns = np.indices((height, width), np.float32)
    first = np.full((height, width, 4), 255, np.uint8)
    for channel, (along, across) in enumerate(((97, 71), (53, 31), (11, 23))):
        first[..., channel] = 127.0 + 120.0 * np.sin(columns / along) * np.cos(rows / across)
    noise = np.random.default_rng(1).integers(-6, 7, (height, width, 3))
    other = first.copy()
    if not row.options.get("alike"):
        other[..., :3] = np.clip(first[..., :3].astype(np.int16) + noise, 0, 255)
    origin = Fingerprint(renderer="llvmpipe", size=f"{width}x{height}")
    references = [Reference(Path("a.png"), first, origin.texts())]
    runs: dict[str, Run] = {"auto": lambda: judge(other, origin, references)}
    if row.options["of"] == "flip":
        runs = {"auto": lambda: flip(first, other)}
    if "beside" in row.options:
        try:
            evaluate = importlib.import_module("flip_evaluator").evaluate
        except ImportError:
            context.options.say("flip-evaluator is not installed, and is left out")
        else:
            pair = [np.ascontiguousarray(p[..., :3], np.float32) / np.float32(255) for p in (first, other)]
            runs["flip-evaluator"] = lambda: evaluate(*pair, "LDR")
    samples = alternate(runs, context.rounds)
    own = {"auto": samples.pop("auto")}
    yield Figure(row.suite, row.name, row.what, size, "ms", row.goal, own, samples)


# ── the engine itself: Python a pass, a frame in which nothing has changed, calls of OpenGL ───────


def _engine_cost(row: Row, context: BenchContext, size: int) -> Iterator[Figure]:
    """Yield the _engine_cost of ``of``: "passes", "unchanged" or "calls"."""
    of = {"passes": _passes, "unchanged": _unchanged, "calls": _calls}[row.options["of"]]
    yield from of(row, context, size)


def _passes(row: Row, context: BenchContext, size: int) -> Iterator[Figure]:
    """Yield milliseconds of Python a pass of the loop ``loop``: without those inside calls of OpenGL."""
    options, engine = row.options, context.engine()
    sketch, texture = context.sketch(options, size), str(options["texture"])
    change = changing(context, options)
    plan = engine.plan(sketch, (64, 36), 0.0, None, texture)
    steps = _steps_of(plan, str(options["loop"]))
    samples = Samples()
    for number in range(-2, context.rounds):
        with timed_calls() as calls:
            wall, _ = timed(lambda: engine.texture(change(sketch), texture))
        if number >= 0:
            samples.wall.append((wall - calls.milliseconds) / steps)
    yield Figure(row.suite, row.name, row.what, size, "ms", row.goal, {"auto": samples})


def _steps_of(plan: Plan, path: str) -> int:
    loop = next(node for node in plan.nodes if node.path == path)
    assert isinstance(loop, LoopStep), path
    return loop.repeat * len(loop.body)


def _unchanged(row: Row, context: BenchContext, size: int) -> Iterator[Figure]:
    """Yield the time of a frame in which only the camera has moved a pass that takes nothing, by passes.

    In a ``chain`` each reads the one before it, and the picture the last; otherwise it reads only the first.
    """
    engine = context.engine()
    for passes in row.options["counts"]:
        sketch = unchanging(row, context, passes)

        def run(sketch=sketch) -> None:  # type: ignore[no-untyped-def]
            look = sketch.camera  # turned further each time: else its picture would be known
            moved = sketch.with_camera(replace(look, azimuth=look.azimuth + 0.1 * next(context.numbers)))
            engine.draw(moved, size=(16, 9))
            engine.ctx.finish()

        samples = alternate({"auto": run}, context.rounds, unmeasured=3)
        name, what = f"{row.name}-{passes}", row.what.replace("N", str(passes))
        yield Figure(row.suite, name, what, 0, "ms", row.goal, samples)


def unchanging(row: Row, context: BenchContext, passes: int) -> Sketch:
    """Return a sketch of so many passes of the kernel ``shader``, for the row's ``view`` of @."""
    chain, text = bool(row.options.get("chain")), ""
    context.written("flat.glsl", str(row.options["shader"]))
    for number in range(passes):
        text += f'[[pass]]\nname = "p{number}"\nuse = "./flat"\nsize = 4\n'
        if chain and number:
            text += f'inputs = {{ height = "p{number - 1}" }}\n'
    view = str(row.options["view"]).replace("@", f"p{passes - 1 if chain else 0}")
    return context.sketch({**row.options, "passes": text + view}, 0)


def _calls(row: Row, context: BenchContext, size: int) -> Iterator[Figure]:
    """Yield how often a frame in which the camera moves calls OpenGL, and how many bytes it moves."""
    engine, pixels = context.engine(), tuple(row.options["pixels"])
    sketch = context.sketch(row.options, size)
    for number in range(1, 4):
        look = sketch.camera
        moved = sketch.with_camera(replace(look, azimuth=look.azimuth + number))
        with counted() as counts:
            engine.draw(moved, size=pixels)
    for kind, count in counts.items():
        name, what = f"{row.name}-{kind.replace(' ', '-')}", f"{row.what}: {kind}"
        samples = {"auto": Samples([float(count)])}
        yield Figure(row.suite, name, what, size, "", row.goal, samples)


MEASURES: dict[str, Callable[[Row, BenchContext, int], Iterator[Figure]]] = {
    "comparison": _comparison,
    "engine_cost": _engine_cost,
    "frame": _frame,
    "process": _process,
    "texture": _texture,
}


def figures(row: Row, context: BenchContext, size: int) -> Iterator[Figure]:
    """Measure a row at a size; raise ``PlaygroundError`` for one that cannot be drawn."""
    if row.measure in MEASURES:
        yield from MEASURES[row.measure](row, context, size)
        return
    measure = next(
        module.MEASURES[row.measure] for module in modules("measures") if row.measure in module.MEASURES
    )
    for suffix, what, times in measure(context, row.options, size):
        samples = Samples([wall for wall, _ in times], [processor for _, processor in times])
        name = row.name + (suffix and f"-{suffix}")
        yield Figure(row.suite, name, row.what + what, size, "ms", row.goal, {"auto": samples})


# ── run the rows that were chosen, one after the other, and say on what machine ──


def run(
    rows: Sequence[Row],
    sizes: Sequence[int],
    options: Options,
    ended: Callable[[], None] = lambda: None,
) -> Results:
    """Measure rows at each size, and return what was found; ``ended`` is called after each.

    Raises ``PlaygroundError`` for a row that cannot be drawn.
    """
    notes: list[str] = []
    say = options.say

    def note(text: str) -> None:
        if text not in notes:
            notes.append(text)
            say(text)

    options.say = note
    date = datetime.now().astimezone().isoformat(timespec="seconds")
    results = Results(date, __version__, {}, options.rounds)
    with BenchContext(options) as context:
        results.machine = machine(context)
        for row, size in planned(rows, sizes):
            results.figures += figures(row, context, size)
            ended()
    results.notes = notes
    return results


def planned(rows: Sequence[Row], sizes: Sequence[int]) -> list[tuple[Row, int]]:
    """Return each row with each size at which it is measured; 0 for one that has no size."""
    return [(row, size) for row in rows for size in (sizes if row.sized else (0,))]


def machine(context: BenchContext) -> dict[str, Any]:
    """Return what figures depend on: renderer, processors, system, versions."""
    info = context.engine().info
    return {
        "renderer": info.renderer,
        "opengl": info.opengl,
        "processor": _processor(),
        "processors": processors(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "load": round(os.getloadavg()[0], 1) if hasattr(os, "getloadavg") else 0.0,
    }


def _processor() -> str:
    """Return the processor's name, as far as the system tells."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.machine())
