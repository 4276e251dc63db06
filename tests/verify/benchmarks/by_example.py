"""What gullies and terrain from an example cost: ``python tests/verify/benchmarks/by_example.py [SIZE …]``.

C is processor time, of all threads: the median of five terrains, each of another seed, with what they read
drawn before. On a software renderer that is what the picture costs; on a card it is only the driver's.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
import time
from pathlib import Path

from playground.engine.engine import Engine, open_engine
from playground.sketch.load import load

SIZES = (257, 513, 1025)
METRES = 80.0  # from texel to texel of what is pieced together
SKETCH = """format = 1
size = {size}
extent = {extent}
relief = 1800.0
[[pass]]
name = "raw"
use = "generation/gradient_noise"
set = {{ frequency = 3, octaves = 3, seed = 5 }}
[[pass]]
name = "made"
use = "{use}"
inputs = {{ {input} = "raw" }}
"""


def cost(engine: Engine, folder: Path, use: str, wired: str, size: int, extent: float) -> tuple[float, float]:
    """Return the processor's and the clock's milliseconds of one technique at a size."""
    path = folder / "sketch.toml"
    path.write_text(SKETCH.format(use=use, input=wired, size=size, extent=extent))
    result = []
    for seed in range(6):
        sketch = load(path).with_values({"made.seed": seed})
        engine.texture(sketch, "raw")
        engine.ctx.finish()
        start = time.process_time(), time.perf_counter()
        engine.texture(sketch, "made:height")
        engine.ctx.finish()
        result.append(((time.process_time() - start[0]) * 1e3, (time.perf_counter() - start[1]) * 1e3))
    return statistics.median(c for c, _ in result[1:]), statistics.median(w for _, w in result[1:])


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("sizes", type=int, nargs="*", default=SIZES, metavar="SIZE", help="texels a side")
    with open_engine() as engine, tempfile.TemporaryDirectory() as name:
        print(engine.info.renderer)
        for size in parser.parse_args().sizes:
            gullies = cost(engine, Path(name), "erosion/gullies", "height", size, 10240.0)
            pieces = cost(engine, Path(name), "generation/from_example", "guide", size, METRES * (size - 1))
            for what, (spent, passed) in (("gullies", gullies), ("from_example", pieces)):
                print(f"{size}²  {what:13} C {spent:8.1f} ms   wall {passed:8.1f} ms")
    return 0


if __name__ == "__main__":
    sys.exit(main())
