"""Show that no save of a live session is missed, and that memory stays.

    python tests/verify/benchmarks/live.py [--many 1000] [--reloads 500]

A watcher, a sandbox process and an engine as in the window. What a save takes until its picture is there
``playground bench save`` measures.
"""

from __future__ import annotations

import argparse
import gc
import os
import sys
import time
from pathlib import Path

import moderngl

from playground.engine.sandbox import Sandbox
from playground.errors import PlaygroundError
from playground.verify.bench.measures.save import WatchedSketch, texts_of
from playground.verify.bench.room import Options, Room
from playground.verify.bench.rows import chosen

SIZE = 65  # texels a side: what counts is that a picture comes, not how soon
PIXELS = (320, 180)


def resident() -> float:
    """Return this process's memory in MiB."""
    if not sys.platform.startswith("linux"):
        return 0.0
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20


def objects() -> int:
    """Return how many OpenGL objects are alive."""
    gc.collect()
    kinds = (moderngl.Texture, moderngl.Framebuffer, moderngl.Renderbuffer, moderngl.Buffer)
    kinds += (moderngl.VertexArray, moderngl.Program, moderngl.ComputeShader, moderngl.Sampler)
    alive = (o for o in gc.get_objects() if isinstance(o, kinds))
    return sum(not isinstance(getattr(o, "mglo", None), moderngl.InvalidObject) for o in alive)


def main() -> None:
    """Save, and print how many saves were missed and what has grown."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--many", type=int, default=1000, help="saves of which none is missed (default 1000)")
    parser.add_argument(
        "--reloads", type=int, default=500, help="reloads over which memory is flat (default 500)"
    )
    options = parser.parse_args()
    (row,) = chosen(["save"])
    with Room(Options()) as room, Sandbox() as sandbox:
        sandbox.start()
        watched = WatchedSketch(room, texts_of(row, room, SIZE), sandbox, PIXELS)
        with watched.watcher:
            watched.follower.follow()
            time.sleep(0.3)
            report_missed(watched, options.many)
            if options.reloads > 1:
                report_growth(watched, options.reloads)
        watched.session.release()


def report_missed(watched: WatchedSketch, saves: int) -> None:
    """Print how many of so many saves had no picture."""
    files, missed = list(watched.texts), 0
    for number in range(1, saves + 1):
        try:
            watched.save_and_show(files[number % 3])
        except PlaygroundError as error:
            print(error)
            missed += 1
        if number % 100 == 0 or number == saves:
            print(f"saves missed of {number}: {missed} (wanted 0)", flush=True)


def report_growth(watched: WatchedSketch, reloads: int) -> None:
    """Print what memory and OpenGL objects grow by over the second half of many reloads."""
    files, seen = list(watched.texts), []
    for reload in range(reloads):
        watched.save_and_show(files[reload % 3])
        if reload in (reloads // 2 - 1, reloads - 1):
            seen.append((resident(), objects()))
    (before, fewer), (after, more) = seen
    grown = f"{after - before:+.1f} MiB, {more - fewer:+d} OpenGL objects"
    print(f"over the second half of {reloads} reloads: {grown} (wanted: flat)")


if __name__ == "__main__":
    main()
