"""Measure what the spine promises, and print it with its limit.

    python tests/benchmarks/spine.py [--saves 25]

Each figure is the median of several runs, and says whether the driver's shader cache
was warm. Figures wander with the machine: compare runs on the same one.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

from rich.console import Console
from rich.table import Table

import playground
from playground.engine.sandbox import Sandbox
from playground.paths import GLSL
from playground.workbench.session import Session
from playground.workbench.watcher import Watcher

SIZE = (1280, 720)
KERNELS = ("texturing/height_blend/mix", "texturing/tiled")  # one that fetches, one that filters


def main() -> None:
    """Run every measurement and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--saves", type=int, default=25, help="saves to time (default 25)")
    options = parser.parse_args()
    with playground.headless() as engine:
        renderer = engine.info.renderer
    table = Table(title=f"The spine on {renderer}, {os.cpu_count()} processors")
    for heading in ("what", "measured", "limit", "shader cache"):
        table.add_column(heading)
    table.add_row("import playground", f"{import_time():.0f} ms", "150 ms", "none used")
    cold, warm = render_times()
    table.add_row("render jacksboro 1280x720, process start to PNG", f"{warm:.2f} s", "2.5 s", "warm")
    table.add_row("the same", f"{cold:.2f} s", "", "cold")
    ran, milliseconds = sun()
    table.add_row(
        f"moving the sun re-runs {', '.join(ran)}", f"{milliseconds:.0f} ms", "light and view only", "warm"
    )
    for name, sandboxed in [(name, sandboxed) for name in KERNELS for sandboxed in (False, True)]:
        times = sorted(save_to_picture(name, options.saves, sandboxed=sandboxed))
        median, worst = statistics.median(times), times[int(0.95 * (len(times) - 1))]
        label = "with a sandbox process" if sandboxed else "drawn at once"
        row = f"save to picture, {name} at 1025², {label}"
        table.add_row(row, f"{median:.0f} ms (95th {worst:.0f})", "150 ms", "each text new to it")
    table.add_row("memory of jacksboro at 4097²", f"{memory(4097):.2f} GiB", "2 GiB", "warm")
    Console(width=None if sys.stdout.isatty() else 130).print(table)


def import_time() -> float:
    """Return the milliseconds that ``import playground`` takes in a fresh process."""
    code = "import time; t = time.perf_counter(); import playground; print(time.perf_counter() - t)"
    runs = [float(_python(code)) for _ in range(9)]
    return statistics.median(runs) * 1e3


def render_times() -> tuple[float, float]:
    """Return the seconds of ``playground render`` with a cold and with a warm shader cache."""
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"MESA_SHADER_CACHE_DIR": f"{folder}/cache"}
        command = [
            sys.executable,
            "-m",
            "playground",
            "render",
            "jacksboro",
            "-o",
            f"{folder}/land.png",
            "--size",
            "1280x720",
        ]
        times = []
        for _ in range(6):
            start = time.perf_counter()
            subprocess.run(command, check=True, capture_output=True, env=environment)
            times.append(time.perf_counter() - start)
    return times[0], statistics.median(times[1:])


def sun() -> tuple[list[str], float]:
    """Return what a moved sun runs again in jacksboro, and the milliseconds."""
    sketch = playground.load("jacksboro")
    with playground.headless() as engine:
        engine.draw(sketch, size=SIZE)
        times = []
        for azimuth in range(90, 99):
            moved = sketch.with_values({"light.sun": (float(azimuth), 25.0)})
            start = time.perf_counter()
            engine.draw(moved, size=SIZE)
            engine.ctx.finish()
            times.append((time.perf_counter() - start) * 1e3)
        return sorted({path.split(".")[0] for path in engine.internal.ran}), statistics.median(times)


def save_to_picture(name: str, saves: int, *, sandboxed: bool) -> list[float]:
    """Return the milliseconds from each save of a texturing kernel to the finished picture."""
    with tempfile.TemporaryDirectory() as folder:
        sketch, kernel = _texturing_sketch(Path(folder), name)
        text = kernel.read_text()
        with playground.headless() as engine:
            child = Sandbox() if sandboxed else None
            if child is not None:
                child.start()
            woken = threading.Event()
            session = Session(engine, sketch, sandbox=child)
            try:
                with Watcher(woken.set) as watcher:
                    _settle(session, engine)
                    watcher.follow(session.drafts.files)
                    time.sleep(0.3)
                    return [
                        _one_save(session, engine, watcher, woken, kernel, text, n) for n in range(saves + 3)
                    ][3:]
            finally:
                session.release()
                if child is not None:
                    child.close()


def _one_save(
    session: Session,
    engine: playground.Engine,
    watcher: Watcher,
    woken: threading.Event,
    kernel: Path,
    text: str,
    number: int,
) -> float:
    woken.clear()
    drawn = session.draws
    edited = text.replace(
        "vec4 kernel(", f"const float EDIT = {1 + (number + time.time() % 1) * 1e-4:.9f};\nvec4 kernel("
    )
    edited = edited.replace("return vec4(", "return EDIT * vec4(")
    if "EDIT *" not in edited:
        raise SystemExit(f"{kernel.name} has changed: this benchmark cannot edit it any more")
    start = time.perf_counter()
    kernel.write_text(edited)
    while not watcher.take():
        woken.wait(1.0)
        woken.clear()
    session.drafts.reload()
    while session.draws == drawn:
        session.frame(SIZE)
        if session.error:
            raise SystemExit(str(session.error))
        time.sleep(0.0005)
    engine.ctx.finish()
    taken = (time.perf_counter() - start) * 1e3
    watcher.follow(session.drafts.files)
    time.sleep(0.1)
    return taken


def _settle(session: Session, engine: playground.Engine) -> None:
    while session.draws == 0 or session.drafts.testing:
        session.frame(SIZE)
        if session.error:
            raise SystemExit(str(session.error))
        time.sleep(0.005)
    engine.ctx.finish()


def _texturing_sketch(folder: Path, name: str) -> tuple[Path, Path]:
    """Write a sketch one of whose texturing kernels is a copy, so that it can be saved over and over."""
    kernel = folder / "mine.glsl"
    kernel.write_text((GLSL / f"{name}.glsl").read_text())
    uses = [("height", "generation/diamond_square", "")]
    for ground in ("grass", "rock", "snow"):
        uses += [(f"{ground}_tile", f"texturing/{ground}", "size = 512"), (ground, "texturing/tiled", "")]
    uses += [("colour", "texturing/height_blend/mix", ""), ("light", "lighting/ray_cast", "")]
    text = "format = 1\nsize = 1025\n"
    for called, use, more in uses:
        # The last pass of its kind: a save of texturing/tiled lays the snow anew.
        mine = use == name and called in ("snow", "colour")
        text += f'[[pass]]\nname = "{called}"\nuse = "{"./mine" if mine else use}"\n{more}\n'
    sketch = folder / "sketch.toml"
    sketch.write_text(text + '[view]\nuse = "view/terrain"\n')
    return sketch, kernel


def memory(side: int) -> float:
    """Return the most memory, in GiB, that a process takes to render jacksboro so large."""
    code = (
        "import resource, playground\n"
        f"frame = playground.render('jacksboro', size={SIZE}, values={{'size': {side}}})\n"
        "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)"
    )
    return float(_python(code)) / 2**20


def _python(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout


if __name__ == "__main__":
    main()
