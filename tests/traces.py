"""Trace random texels of every pass of sketches, and compare each trace with the texel that is drawn.

    python -m tests.traces                                   # every shipped sketch
    GALLIUM_DRIVER=softpipe python -m tests.traces --side 17 --width 32 --seconds 60 life fbm

The renderer is the one that draws here. Each sketch has a process of its own, which is ended where it takes
longer than ``--seconds``. A line for each pass whose traces differ and each sketch that was ended or failed,
then how many passes are equal in every texel. Exit status 1 where one differs by more than rounding.
"""

from __future__ import annotations

import argparse
import json
import random
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field

import numpy as np

from playground.engine.context import open_context, release_context
from playground.engine.engine import Engine
from playground.engine.plan import Step, every_version
from playground.engine.planner import smallest_terrain
from playground.engine.trace.model import MAX_EVENTS, Trace
from playground.errors import ParameterError
from playground.sketch.find import shipped_sketches
from playground.sketch.flat import Ref
from playground.sketch.model import Draw, Kernel, PlainFragment, TexelKernel

from .loading import load

TIME = 1.5  # seconds
SETTINGS = {
    "texels": (20, "of the last iteration of each pass"),
    "earlier": (
        6,
        "of the second, the middle and a random iteration each, of the innermost loop and the outermost",
    ),
    "side": (65, "of the terrain at least, in texels"),
    "width": (160, "of the picture, in pixels"),
    "values": (MAX_EVENTS, "that are recorded of a texel at most"),
}
ROUNDED = (
    "erosion/terraces.glsl", "from_elsewhere/dunes.frag", "generation/dunes.glsl",
    "generation/gradient_noise/sum.glsl", "generation/gradient_noise/warping.glsl",
    "texturing/height_blend/ragged.glsl", "trees/cover/lit.glsl",
)  # fmt: skip
"""Kernels whose recorded sums Mesa rewrites: the last bits may differ, by 2e-5 of the value.

Of half floats that is one unit in the last place.
"""


@dataclass
class PassTraces:
    """What the traces of one pass gave."""

    sketch: str
    path: str
    kernel: str
    texels: int = 0  # that were traced
    earlier: int = 0  # of them, of another iteration than the last
    rounded: list[str] = field(default_factory=list)  # texels whose last bits differ
    unequal: list[str] = field(default_factory=list)  # texels that differ otherwise


def traces_of(engine: Engine, name: str, **settings: int) -> Iterator[PassTraces]:
    """Trace texels of each pass of a sketch, as ``SETTINGS`` says, and compare them.

    Passes for which few texels are drawn come first, so that a limit of time leaves few out. Then the picture
    is drawn: traces of its passes change neither its bytes nor how often passes have run.
    """
    texels, earlier, side, width, values = ({**DEFAULTS, **settings}[key] for key in SETTINGS)
    sketch = load(name)
    sketch = sketch.with_values({"size": smallest_terrain(sketch, side)}).with_picture(samples=1)
    size, chance = (width, width * 9 // 16), random.Random(name)
    plan = engine.plan(sketch.plainly(), size, TIME)
    steps = [s for s in plan.walk() if isinstance(s.kernel, TexelKernel | PlainFragment | Draw) and s.repeat]
    sizes: dict[str, tuple[int, int]] = {}  # the smallest of all iterations, by path
    costs: dict[str, int] = {}  # texels that are drawn for a step, by path
    for node in every_version(plan.nodes):
        if isinstance(node, Step):
            sizes[node.path] = min(node.size, sizes.get(node.path, node.size))
            read = [costs.get(source.path, 0) for _, source in node.inputs if isinstance(source, Ref)]
            costs[node.path] = sum(read, node.size[0] * node.size[1] * max(node.repeat, 1))
    for step in sorted(steps, key=lambda step: costs[step.path]):
        result = PassTraces(name, step.path, step.kernel.path)
        asked: list[tuple[int, ...] | None] = [None] * texels  # iterations
        for at in asked:
            columns, rows = step.size if at is None else sizes[step.path]
            texel = chance.randrange(columns), chance.randrange(rows)
            try:
                trace = engine.trace(
                    sketch, step.path, texel=texel, iteration=at, size=size, time=TIME, limit=values
                )
            except ParameterError as error:
                if "nothing is drawn" not in str(error):
                    result.unequal.append(f"{texel} of iteration {at}: {error}")
                continue
            if len(asked) == texels and any(last := trace.iteration):
                asked += sorted(iterations_besides(last, chance) * earlier)  # each of them runs anew
            result.texels, result.earlier = result.texels + 1, result.earlier + (at is not None)
            if not trace.is_exact:
                differing = result.rounded if is_rounded(trace, step.kernel) else result.unequal
                differing.append(f"{texel} of {trace.iteration}: {trace.outputs}, {trace.texel_values}")
        yield result
    picture = engine.render(sketch, size=size, time=TIME).array.tobytes()
    runs = dict(engine.runs)
    for step in steps:
        try:
            engine.trace_frame(step.path, texel=(0, 0), limit=values)
        except ParameterError as error:
            assert "nothing is drawn" in str(error), step.path
    assert dict(engine.runs) == runs, f"traces of {name} count as runs of passes"
    again = engine.render(sketch, size=size, time=TIME).array.tobytes()
    assert again == picture, f"traces of {name} change its picture"


def iterations_besides(last: tuple[int, ...], chance: random.Random) -> list[tuple[int, ...]]:
    """Return the second, the middle and a random iteration of the innermost loop and of the outermost.

    In other iterations of an outer loop those inside may be fewer: theirs is the first.
    """
    *outer, inner = last
    in_last = [(*outer, n) for n in (min(1, inner), inner // 2, chance.randint(0, inner))]
    if not outer:
        return in_last
    rest, n = (0,) * len(outer), outer[0]
    return in_last + [(at, *rest) for at in (min(1, n), n // 2, chance.randint(0, n))]


def is_rounded(trace: Trace, kernel: Kernel) -> bool:
    """Return whether a kernel is one that Mesa rounds otherwise, and only the last bits differ."""
    near = {o.name: 2**-10 if o.format.endswith("16f") else 2e-5 for o in kernel.outputs}
    pairs = [(trace.outputs[name], values, near[name]) for name, values in trace.texel_values.items()]
    known = kernel.path.endswith(ROUNDED)
    return known and all(np.allclose(one, other, rtol=rtol, atol=1e-6) for one, other, rtol in pairs)


DEFAULTS = {key: default for key, (default, _) in SETTINGS.items()}


def main() -> int:
    """Compare sketches, each in a process of its own, or those of a command line with ``--here`` in this."""
    parser = argparse.ArgumentParser(description="Compare traces of every pass of sketches with its texels.")
    parser.add_argument("sketches", nargs="*", default=shipped_sketches())
    for key, (default, meaning) in SETTINGS.items():
        parser.add_argument(f"--{key}", type=int, default=default, help=meaning)
    parser.add_argument("--seconds", type=float, default=300.0, help="for one sketch")
    parser.add_argument("--here", action="store_true", help="in this process; prints lines of JSON")
    options = parser.parse_args()
    settings = {key: getattr(options, key) for key in SETTINGS}
    if options.here:
        ctx = open_context()
        print(ctx.info["GL_RENDERER"], flush=True)
        with Engine(ctx) as engine:
            for name in options.sketches:
                for result in traces_of(engine, name, **settings):
                    print(json.dumps(asdict(result)), flush=True)
        release_context(ctx)
        return 0
    results: list[PassTraces] = []
    failed = 0
    for name in options.sketches:
        command = [sys.executable, "-m", "tests.traces", "--here", name]
        command += [f"--{key}={value}" for key, value in settings.items()]
        outcome = ""
        try:
            done = subprocess.run(command, stdout=subprocess.PIPE, timeout=options.seconds)
            lines = done.stdout
            if done.returncode:
                failed, outcome = failed + 1, "failed"
        except subprocess.TimeoutExpired as ended:
            lines, outcome = ended.stdout or b"", f"ended after {options.seconds:g} s"
        rows = [PassTraces(**json.loads(line)) for line in lines.splitlines() if line[-1:] == b"}"]
        for row in rows:
            for kind, texts in (("rounded", row.rounded), ("unequal", row.unequal)):
                if texts:
                    print(f"{name} {row.path} ({row.kernel}), {len(texts)} {kind}: {texts[0]}", flush=True)
        if outcome:
            print(f"{name}: {outcome}, {len(rows)} passes compared", flush=True)
        results += rows
    equal = sum(not (row.rounded or row.unequal) for row in results)
    print(f"{equal} of {len(results)} passes equal in every texel")
    return int(failed > 0 or any(row.unequal for row in results))


if __name__ == "__main__":
    sys.exit(main())
