"""Time trees at 1280 x 720: each pass alone, run again for an eye that has moved.

    python tests/verify/benchmarks/trees.py [--rounds 5]

Processor time of all threads in milliseconds, the median of the rounds: on a software renderer that is what a
pass costs. The scene is the sketch ``trees``. Each round moves the eye by a metre, so all that depends on it
runs; from what that takes, what the passes before it take is left out.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from statistics import median

import moderngl

from playground.engine.engine import Engine
from playground.sketch.load import load
from playground.sketch.model import Sketch

SIZE = (1280, 720)
STEPS = {
    "place": ("view.place.cells:tree", ()),
    "list": ("view.place:tree", ("place",)),
    "the terrain alone": ("view.where", ()),
    "crowns": ("view.crowns", ("list", "the terrain alone", "place")),
    "leaves near the eye": ("view.seen", ("crowns", "list", "the terrain alone", "place")),
    "shade": ("view.shade", ("list", "place")),
    "the ground's colour": (
        "view.cover",
        ("leaves near the eye", "crowns", "list", "the terrain alone", "place"),
    ),
    "cover": (
        "view.wooded:albedo",
        (
            "the ground's colour",
            "leaves near the eye",
            "crowns",
            "shade",
            "list",
            "the terrain alone",
            "place",
        ),
    ),
}
"""What is timed → its texture, and what else is drawn for it."""


def moved(sketch: Sketch, k: int) -> Sketch:
    """Return the sketch with its eye some metres farther east."""
    east, north, up = sketch.camera.target or (0.0, 0.0, 0.0)
    return sketch.with_camera(replace(sketch.camera, target=(east + k, north, up)))


def main() -> None:
    """Print what each pass costs."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--rounds", type=int, default=5)
    rounds = arguments.parse_args().rounds
    sketch = load("trees")
    with moderngl.create_context(standalone=True, backend="egl") as ctx, Engine(ctx) as engine:
        engine.draw(sketch, size=SIZE)
        step, own = 0, {}
        for what, (path, before) in STEPS.items():
            result = []
            for _ in range(rounds + 1):
                step += 1
                start = time.process_time()
                engine.texture(moved(sketch, step), path, size=SIZE)
                ctx.finish()
                result.append(1000.0 * (time.process_time() - start))
            own[what] = median(result[1:]) - sum(own[each] for each in before)
            print(f"{what:20} {own[what]:7.0f} ms")
        total = int(engine.read(moved(sketch, step), "view.place:total", size=SIZE)[0, 0])
        print(f"{total} trees")


if __name__ == "__main__":
    main()
