"""Measure how soon a widget's picture follows its slider in JupyterLab: the browser draws, or the kernel.

    python -m tests.verify.benchmarks.notebook_drag [--steps 8] [sketch]

Each slider is dragged step by step, the next as soon as the picture of the last is on the canvas:
milliseconds from the slider's event until the pixels can be read, and the widths that the pictures had. While
something moves, a picture may have fewer pixels than its 640 × 360 at rest.
"""

from __future__ import annotations

import argparse
import os
import statistics
import tempfile
from pathlib import Path

from rich.console import Console
from rich.table import Table

from tests.publish.notebook.lab import MISSING, Lab

CELL = "import playground\nw = playground.widget({!r}, draws={!r})\nw"
SHOWN = "document.querySelector('.sketches .stage[aria-busy=false] canvas:not([hidden])')"
DRAG = """
const canvas = document.querySelector('.sketches canvas'), found = [];
const draw = CanvasRenderingContext2D.prototype.drawImage;
let shown = () => {};
CanvasRenderingContext2D.prototype.drawImage = function (...given) {
  draw.apply(this, given);
  if (this.canvas !== canvas) return;
  this.getImageData(0, 0, 1, 1);
  shown();
};
const range = document.querySelectorAll('.sketches .rows input[type=range]')[arguments[0]];
const steps = arguments[1], begun = +range.value, low = +range.min, high = +range.max;
return (async () => {
  for (let step = 0; step < steps; step++) {
    const start = performance.now();
    const done = new Promise((resolve) => { shown = resolve; });
    range.value = low + (high - low) * (0.3 + (0.4 * step) / steps);
    range.dispatchEvent(new Event('input', { bubbles: true }));
    await done;
    found.push([performance.now() - start, canvas.width]);
  }
  CanvasRenderingContext2D.prototype.drawImage = draw;
  range.value = begun;
  range.dispatchEvent(new Event('input', { bubbles: true }));
  return [range.getAttribute('aria-label'), found];
})();
"""


def measure(sketch: str, draws: str, steps: int) -> list[tuple[str, list[tuple[float, int]]]]:
    """Return for each slider its name, and [ms] and width of the picture of each step."""
    with tempfile.TemporaryDirectory() as folder, Lab(Path(folder), [CELL.format(sketch, draws)]) as lab:
        lab.browser.wait(SHOWN)
        count = lab.browser.run(
            "return document.querySelectorAll('.sketches .rows input[type=range]').length"
        )
        result = []
        for number in range(count):
            result.append(tuple(lab.browser.run(DRAG, number, steps)))
            lab.browser.wait(SHOWN)
        return result


def main() -> None:
    """Measure, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sketch", nargs="?", default="")
    parser.add_argument("--steps", type=int, default=8)
    names = parser.parse_args()
    if MISSING:
        raise SystemExit(MISSING)
    table = Table("drawn by", "slider", "median ms", "longest ms", "widths", title=names.sketch)
    for draws in ("browser", "kernel"):
        every = []
        for name, steps in measure(names.sketch, draws, names.steps):
            times = [taken for taken, _ in steps]
            every += times
            widths = ", ".join(map(str, sorted({width for _, width in steps})))
            table.add_row(draws, name, f"{statistics.median(times):.0f}", f"{max(times):.0f}", widths)
        table.add_row(
            draws, "all", f"{statistics.median(every):.0f}", f"{max(every):.0f}", "", end_section=True
        )
    console = Console()
    console.print(table)
    console.print(f"load of the machine: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")


if __name__ == "__main__":
    main()
