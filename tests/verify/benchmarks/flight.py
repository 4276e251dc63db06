"""Print what a flight over the shipped terrain costs: ``python tests/verify/benchmarks/flight.py``.

A picture is 640 x 360 (``--size W H``) at one sample, as in a window that the processor draws. Parts are made
in stages between the pictures, as there.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time

from playground.engine.engine import open_engine
from playground.flight.craft import Controls
from playground.flight.flight import CACHE_BYTES, Flight
from playground.sketch.load import load

SIZE = (640, 360)
PICTURES = 150
HANDS = (Controls(100, 20, 40, 0), Controls(0, 0, -40, 0), Controls(0, -15, 0, 20), Controls(0, 10, 0, 0))


def milliseconds(work, engine):
    start = time.perf_counter()
    work()
    engine.ctx.finish()
    return (time.perf_counter() - start) * 1e3


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--size", type=int, nargs=2, default=SIZE, metavar=("W", "H"), help="pixels")
    width, height = parser.parse_args().size
    size = width, height
    with open_engine(cache_bytes=CACHE_BYTES) as engine:
        print(f"{engine.info.renderer}; pictures of {width} x {height}, 1 sample")
        with Flight(engine, load("flight"), samples=1) as flight:
            first = milliseconds(lambda: flight.parts.tend(1), engine)
            count = 0

            def rest() -> None:
                nonlocal count
                count = flight.make_all()

            each = milliseconds(rest, engine) / max(count, 1)
            print(f"a part: {each:.1f} ms (the first, with what all share and compiling: {first:.0f} ms)")
            still = [milliseconds(lambda: flight.draw(size), engine) for _ in range(20)]
            print(f"a picture while nothing is made: {statistics.median(still):.1f} ms")
            frames, drawn, stages = [], [], []
            for number in range(PICTURES):
                hands = HANDS[number * len(HANDS) // PICTURES]

                def step(hands: Controls = hands) -> None:
                    for _ in range(4):
                        flight.step(hands, 0)
                    stages.append(flight.parts.tend_for(0.005))
                    flight.draw(size)

                frames.append(milliseconds(step, engine))
                drawn.append(flight.scene.drawn)
            ordered = sorted(frames)
            middle, late = statistics.median(frames), ordered[int(0.99 * len(ordered))]
            busy = statistics.mean(n > 0 for n in stages)
            print(
                f"a picture in flight, {busy:.0%} of them with work on a part: "
                f"median {middle:.1f} ms, 99 in 100 below {late:.1f} ms ({late / middle:.2f} x)"
            )
            triangles = flight.scene.triangles
            print(f"parts in view: {statistics.mean(drawn):.0f}; triangles of the last picture: {triangles}")
            mine, cached = flight.parts.bytes / 2**20, engine.cache.bytes / 2**20
            print(f"cached: {len(flight.parts)} parts, {mine:.0f} MiB, and {cached:.0f} MiB in the engine")
    return 0


if __name__ == "__main__":
    sys.exit(main())
