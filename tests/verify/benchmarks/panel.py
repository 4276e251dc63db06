"""Measure what the panel costs a frame, and print it with its limit.

    python tests/verify/benchmarks/panel.py [--frames 300] [--profile]

The time is this process's own, of the panel's code alone: a sketch of thirty parameters in
every kind of widget, all of them drawn, without a window. It rests, or one value changes in
every frame, as in a drag, or a search is typed.
"""

from __future__ import annotations

import argparse
import cProfile
import pstats
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from rich.console import Console
from rich.table import Table

from playground.engine.context import open_context
from playground.engine.engine import Engine
from playground.studio.panel.parameter_list import Filter

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "studio" / "live"))
from desk import Bare

LIMIT = 3.0  # [ms]
COUNT = 30
WIDGETS = (
    "uniform float {} = 0.5; //! slider(0, 1) step(0.01) How high it is",
    'uniform float {} = 1.0; //! log_slider(0.01, 100) unit("1/m") group("Shape") How rough it is',
    'uniform int {} = 3; //! slider(1, 9) group("Shape") How many there are',
    'uniform int {} = 0; //! menu("round", "sharp") group("Shape") What it is like',
    'uniform vec3 {} = vec3(0.2); //! colour group("Look") Its colour',
    'uniform bool {} = true; //! group("Look") Whether there is any',
    'uniform float {} = 0.0; //! angle group("Look") Where it points',
    'uniform vec3 {} = vec3(0.0); //! group("Place") Where it is',
    'uniform vec2 {} = vec2(135.0, 40.0); //! direction group("Place") Where the light is',
    'uniform vec2 {} = vec2(0.5); //! point group("Place") Its middle',
)
SKETCH = """format = 1
size = 33
[[pass]]
name = "height"
use = "./terrain"
[view]
use = "./plain"
inputs = { shown = "height" }
[[preset]]
name = "one"
set = { "height.p0" = 0.25 }
"""
PLAIN = """// plain.glsl -- what is wired to it
#pragma kernel(output = "frame:rgba8")
uniform sampler2D shown;  //! input()
vec4 kernel(ivec2 texel) { return vec4(texelFetch(shown, texel % textureSize(shown, 0), 0).rrr, 1.0); }
"""


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--frames", type=int, default=300)
    parser.add_argument("--profile", action="store_true", help="say where the time of a drag goes")
    options = parser.parse_args()
    table = Table("thirty parameters", "median", "95 of 100", "limit", title="Panel, ms of processor a frame")
    with tempfile.TemporaryDirectory() as name, Engine(open_context()) as engine:
        bare = Bare(engine, _sketch(Path(name)))
        for what, before in _ways(bare).items():
            times = _measure(bare, options.frames, before)
            middle, most = statistics.median(times), sorted(times)[int(0.95 * len(times))]
            table.add_row(what, f"{middle:.2f}", f"{most:.2f}", f"{LIMIT:g}" if middle <= LIMIT else "MISSED")
        if options.profile:
            profile = cProfile.Profile()
            drag = _ways(bare)["a value changes"]
            for frame in range(options.frames):
                drag(frame)
                bare.run_frames(1, around=lambda draw: profile.runcall(draw))
            pstats.Stats(profile).sort_stats("tottime").print_stats(25)
        bare.close()
    Console().print(table)


def _ways(bare: Bare) -> dict[str, Callable[[int], None]]:
    def drag(frame: int) -> None:
        bare.session.drafts.set("height.p0", round(frame % 100 / 100, 2))

    def search(frame: int) -> None:
        bare.panel.memory.filter = Filter("how its where whether what"[: frame % 3])

    return {"at rest": lambda frame: None, "a value changes": drag, "a search is typed": search}


def _measure(bare: Bare, frames: int, before: Callable[[int], None]) -> list[float]:
    times: list[float] = []

    def around(draw: Callable[[], object]) -> None:
        start = time.process_time()
        draw()
        times.append((time.process_time() - start) * 1e3)

    for frame in range(frames):
        before(frame)
        bare.run_frames(1, around=around)
    bare.panel.memory.filter = Filter()
    return times


def _sketch(folder: Path) -> Path:
    """Write a sketch with that many parameters into a folder."""
    lines = [WIDGETS[n % len(WIDGETS)].format(f"p{n}") for n in range(COUNT)]
    head = '// terrain.glsl -- level terrain\n#pragma kernel(output = "height:r32f")\n'
    terrain = head + "\n".join(lines) + "\nfloat kernel(ivec2 texel) { return p0; }\n"
    for name, text in {"terrain.glsl": terrain, "plain.glsl": PLAIN, "sketch.toml": SKETCH}.items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder


if __name__ == "__main__":
    main()
