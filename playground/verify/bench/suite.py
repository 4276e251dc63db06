"""Run the rows that were chosen, one after the other, and say on what machine."""

from __future__ import annotations

import importlib
import os
import platform
from collections.abc import Callable, Iterator, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

from playground._version import __version__
from playground.verify.bench.results import Figure, Results
from playground.verify.bench.room import Options, Room, processors
from playground.verify.bench.rows import Row


def run(
    rows: Sequence[Row],
    sizes: Sequence[int],
    options: Options,
    ended: Callable[[], None] = lambda: None,
) -> Results:
    """Measure rows at each size, and return what was found; ``ended`` is called after each.

    Raises ``PlaygroundError`` for a row that cannot be drawn.
    """
    notes: list[str] = []
    say = options.say

    def note(text: str) -> None:
        if text not in notes:
            notes.append(text)
            say(text)

    options.say = note
    date = datetime.now().astimezone().isoformat(timespec="seconds")
    results = Results(date, __version__, {}, options.rounds)
    with Room(options) as room:
        results.machine = machine(room)
        for row, size in planned(rows, sizes):
            results.figures += _figures(row, room, size)
            ended()
    results.notes = notes
    return results


def planned(rows: Sequence[Row], sizes: Sequence[int]) -> list[tuple[Row, int]]:
    """Return each row with each size at which it is measured; 0 for one that has no size."""
    return [(row, size) for row in rows for size in (sizes if row.sized else (0,))]


def _figures(row: Row, room: Room, size: int) -> Iterator[Figure]:
    module: Any = importlib.import_module(f"playground.verify.bench.measures.{row.measure}")
    yield from module.figures(row, room, size)


def machine(room: Room) -> dict[str, Any]:
    """Return what figures depend on: renderer, processors, system, versions."""
    info = room.engine().info
    return {
        "renderer": info.renderer,
        "opengl": info.opengl,
        "processor": _processor(),
        "processors": processors(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "load": round(os.getloadavg()[0], 1) if hasattr(os, "getloadavg") else 0.0,
    }


def _processor() -> str:
    """Return the processor's name, as far as the system tells."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor()
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.machine())
