"""Measure what a save costs in a live session, and that none is missed: ``python tests/benchmarks/live.py``.

Save to new picture, by a watcher, a sandbox process and an engine as in the window, at 1025²:
for a texturing kernel, an included library file and a value in the sketch. Each text is
new to the driver. Next to the elapsed seconds is the CPU time of both
processes, which a busy machine stretches less.
"""

from __future__ import annotations

import argparse
import gc
import os
import statistics
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import moderngl

from playground.engine.engine import Engine
from playground.engine.sandbox import Sandbox
from playground.gpu.context import open_context
from playground.paths import GLSL
from playground.workbench.reload import Follower
from playground.workbench.session import Session
from playground.workbench.watcher import Watcher

SIZE = (1280, 720)
SMALL = (320, 180)  # where what counts is that a picture comes, not how soon
KERNEL = "texturing/height_blend/mix"
PATIENCE = 60.0  # [s] after which a save counts as missed
PAUSE = 0.1  # [s] between saves that are timed


class Bench:
    """A sketch in a folder, and a session that follows it as the window's does."""

    def __init__(
        self, folder: Path, engine: Engine, sandbox: Sandbox, side: int, picture: tuple[int, int]
    ) -> None:
        self.engine, self.sandbox, self.picture = engine, sandbox, picture
        text = (GLSL / f"{KERNEL}.glsl").read_text(encoding="utf-8")
        edited = text.replace(
            "vec4 kernel(", '#include "own.glsl"\nconst float EDIT = @;\nvec4 kernel(', 1
        ).replace("return vec4(", "return own() * EDIT * vec4(", 1)
        if edited.count("EDIT") != 2:
            raise SystemExit(f"{KERNEL}.glsl has changed: this benchmark cannot edit it any more")
        uses = [("height", "generation/diamond_square", "")]
        for ground in ("grass", "rock", "snow"):
            uses += [(f"{ground}_tile", f"texturing/{ground}", "size = 512"), (ground, "texturing/tiled", "")]
        uses += [("colour", "./mine", "set = { grass_below = @ }"), ("light", "lighting/ray_cast", "")]
        passes = "".join(f'[[pass]]\nname = "{name}"\nuse = "{use}"\n{more}\n' for name, use, more in uses)
        self.texts = {
            folder / "mine.glsl": edited,
            folder / "own.glsl": "float own() { return @; }\n",
            folder / "sketch.toml": f'format = 1\nsize = {side}\n{passes}[view]\nuse = "view/terrain"\n',
        }
        self.number = 0
        for file in self.texts:
            self.save(file)
        self.woken = threading.Event()
        self.session = Session(engine, folder, sandbox=sandbox)
        self.watcher = Watcher(self.woken.set, (".glsl", ".toml"))
        self.follower = Follower(self.session, self.watcher)
        self.until(lambda: self.session.draws > 0 and not self.session.is_preview)

    def save(self, file: Path) -> str:
        """Save a text that was never there; return the number in it."""
        self.number += 1
        number = f"{1.0 + self.number * 1e-5 + time.time() % 1 * 1e-6:.9f}"
        file.write_text(self.texts[file].replace("@", number), encoding="utf-8")
        return number

    def until(self, shown: Callable[[], bool]) -> bool:
        """Go on as the window does until something is shown; say whether it was."""
        end = time.perf_counter() + PATIENCE
        while time.perf_counter() < end:
            self.follower.take()
            self.session.frame(self.picture)
            self.follower.follow()
            if self.session.error is not None:
                raise SystemExit(str(self.session.error))
            if shown():
                self.engine.ctx.finish()
                return True
            self.woken.wait(0.004 if self.session.drafts.testing else 0.05)
            self.woken.clear()
        return False

    def save_and_show(self, file: Path) -> bool:
        """Save a file and wait for its picture; say whether it came."""
        number = self.save(file)

        def is_shown() -> bool:
            draft = self.session.shown
            if draft is None or self.session.drafts.coming is not None:
                return False
            if file.suffix == ".toml":
                return float(number) in dict(draft.file.graph.find("colour").values).values()
            return number in draft.file.graph.find("colour").technique.source.code

        return self.until(is_shown)

    def processor(self) -> float:
        """Return the seconds that processors have spent on this process and on the sandbox's."""
        child = self.sandbox._workers.worker
        return sum(spent(pid) for pid in (os.getpid(), child.pid if child else 0) if pid)


def spent(pid: int) -> float:
    if not sys.platform.startswith("linux"):
        return time.process_time() if pid == os.getpid() else 0.0
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


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


@contextmanager
def opened(side: int, picture: tuple[int, int]) -> Iterator[Bench]:
    with tempfile.TemporaryDirectory() as folder, Sandbox() as sandbox:
        sandbox.start()
        with Engine(open_context(), owns_context=True) as engine:
            bench = Bench(Path(folder), engine, sandbox, side, picture)
            with bench.watcher:
                bench.follower.follow()
                time.sleep(0.3)
                yield bench
            bench.session.release()


def main() -> None:
    """Run every measurement and print it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--saves", type=int, default=25, help="saves of each kind to time (default 25)")
    parser.add_argument("--many", type=int, default=1000, help="saves of which none is missed (default 1000)")
    parser.add_argument(
        "--reloads", type=int, default=500, help="reloads over which memory is flat (default 500)"
    )
    options = parser.parse_args()
    if options.saves > 0:
        with opened(1025, SIZE) as bench:
            print(f"A live session on {bench.engine.info.renderer}, {os.cpu_count()} processors, sandbox on")
            report_times(bench, options.saves)
    if options.many > 0 or options.reloads > 1:
        with opened(65, SMALL) as bench:
            files, missed = list(bench.texts), 0
            for number in range(1, options.many + 1):
                missed += not bench.save_and_show(files[number % 3])
                if number % 100 == 0 or number == options.many:
                    print(f"saves missed of {number}: {missed} (wanted 0)", flush=True)
            if options.reloads > 1:
                report_growth(bench, options.reloads)


def report_times(bench: Bench, saves: int) -> None:
    """Print what a save of each kind takes, and of processors."""
    names = ("a texturing kernel", "an included library file", "a value in the sketch")
    for name, file in zip(names, bench.texts, strict=True):
        times, used = time_saves(bench, file, saves)
        late = sorted(times)[int(0.95 * (len(times) - 1))]
        print(
            f"save to picture at 1025², {name}: median {statistics.median(times):.0f} ms (wanted 200), "
            f"95th percentile {late:.0f} ms (wanted 400); {used:.0f} ms of processors",
            flush=True,
        )


def report_growth(bench: Bench, reloads: int) -> None:
    """Print what memory and OpenGL objects grow by over the second half of many reloads."""
    files, seen = list(bench.texts), []
    for reload in range(reloads):
        bench.save_and_show(files[reload % 3])
        if reload in (reloads // 2 - 1, reloads - 1):
            seen.append((resident(), objects()))
    (before, fewer), (after, more) = seen
    grown = f"{after - before:+.1f} MiB, {more - fewer:+d} OpenGL objects"
    print(f"over the second half of {reloads} reloads: {grown} (wanted: flat)")


def time_saves(bench: Bench, file: Path, saves: int) -> tuple[list[float], float]:
    """Return the milliseconds from each save to its picture, and those of processors for each."""
    times, used = [], 0.0
    for number in range(saves + 2):
        bench.until(lambda: not bench.session.is_preview)
        time.sleep(PAUSE)
        before, start = bench.processor(), time.perf_counter()
        if not bench.save_and_show(file):
            raise SystemExit(f"a save of {file.name} was missed")
        if number >= 2:  # the first ones warm up what is used again
            times.append((time.perf_counter() - start) * 1e3)
            used += (bench.processor() - before) * 1e3
    return times, used / saves


if __name__ == "__main__":
    main()
