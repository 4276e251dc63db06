"""From the brush to the picture: processor time of a step of a stroke, by tool, without a window.

    nice -n 5 .venv/bin/python -m tests.verify.benchmarks.sculpting [--size 1025] [--radius 32]

Median of many steps, in milliseconds of processor time, all threads together: the tool on the processor,
the frame after it (upload, the sculpted height, light, the view of 640 x 360), the two together, and
what pressing and releasing the button costs (the ground read, a copy made that a thread writes).
"""

from __future__ import annotations

import argparse
import statistics
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from playground.engine.context import open_context
from playground.engine.engine import Engine
from playground.studio.paint.brush import TOOLS, Brush
from playground.studio.paint.erode_tool import STAMP
from playground.studio.paint.painting import Painting
from playground.studio.session import Session

SKETCH = """format = 1
size = {size}
extent = 10000.0
relief = 1500.0
[[pass]]
name = "hills"
use = "generation/gradient_noise"
[[pass]]
name = "height"
use = "generation/sculpted"
[[pass]]
name = "light"
use = "lighting/l_dot_n"
[view]
use = "view/terrain"
samples = 1
camera = {{ azimuth = 170.0, elevation = 45.0, distance = 9000.0 }}
"""
STEPS = 15


def spent(act: Callable[[], object]) -> float:
    """Return the processor time of a call [ms]."""
    before = time.process_time()
    act()
    return 1e3 * (time.process_time() - before)


def measure(size: int, radius: int) -> None:
    """Print a row for each tool."""
    with tempfile.TemporaryDirectory() as name, Engine(open_context()) as engine:
        folder = Path(name)
        (folder / "sketch.toml").write_text(SKETCH.format(size=size))
        session, clock = Session(engine, folder / "sketch.toml"), [0.0]
        painting = Painting(session, folder, lambda: clock[0])

        def frame() -> None:
            session.frame((640, 360))
            engine.ctx.finish()

        frame()
        assert session.error is None, session.error
        painting.toggle()
        print(f"{size} x {size}, brush of {2 * radius} texels across, ms C, median of {STEPS}")
        print(f"{'tool':<10}{'brush':>8}{'frame':>8}{'both':>8}{'press':>8}{'release':>9}")
        for tool in TOOLS:
            painting.brush = Brush(tool=tool, radius=radius * 10000.0 / (size - 1), strength=0.5)
            frame()
            press = spent(lambda: painting.press((0.4, 0.45)))
            frame()
            brush, drawn = [], []
            for n in range(STEPS):
                clock[0] += STAMP
                position = 0.4 + 0.005 * n, 0.45
                brush.append(spent(lambda position=position: painting.move(position)))  # type: ignore[misc]
                drawn.append(spent(frame))
            release = spent(painting.release)
            both = statistics.median(map(sum, zip(brush, drawn, strict=True)))
            row = statistics.median(brush), statistics.median(drawn), both, press
            print(f"{tool:<10}" + "".join(f"{value:8.1f}" for value in row) + f"{release:9.1f}")
        painting.close()  # whose last file is still being written
        session.release()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--size", type=int, default=1025)
    parser.add_argument("--radius", type=int, default=32, help="of the brush, in texels")
    names = parser.parse_args()
    measure(names.size, names.radius)
