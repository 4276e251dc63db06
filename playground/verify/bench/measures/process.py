"""What whole processes take: from their start to their end or to a picture, and of memory.

Python's compiled modules are in a folder of all runs, even where the environment has none written: with an
installed playground they are there.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping

from playground.errors import PlaygroundError
from playground.verify.bench.results import Figure
from playground.verify.bench.room import Room
from playground.verify.bench.rows import Row
from playground.verify.bench.timing import Samples

MIB = 2**20
_MARK = "spent "
# A process prints what it took so far as JSON: seconds of processors, bytes at most.
_SPENT = """
def spent():
    import json, sys
    try:
        import resource
        own = resource.getrusage(resource.RUSAGE_SELF)
        most = own.ru_maxrss * (1 if sys.platform == "darwin" else 1024)
        found = [own.ru_utime + own.ru_stime, most]
    except ImportError:
        import time
        found = [time.process_time(), 0]
    print("spent", json.dumps(found), flush=True)
"""
_ENDS = "\nspent()\n"


def figures(row: Row, room: Room, size: int) -> Iterator[Figure]:
    """Yield the figure of a process that runs the Python text ``code``.

    In it, ``{out}`` is a file that it may write, ``{cache}`` a folder of all runs, and ``{size}`` the texels
    a side; where it calls ``spent()``, the time ends there, else with the process. ``prepare`` runs once
    before, untimed; ``takes`` is "time" or "memory"; ``cold`` gives each run an empty shader cache.
    """
    options = row.options
    names = {"{out}": room.folder / "out.png", "{cache}": room.folder / row.name, "{size}": size}

    def text_of(key: str) -> str:
        text = str(options[key])
        for name, what in names.items():
            text = text.replace(name, str(what))
        return text

    usual = environment_of(room)
    if "prepare" in options:
        spent(text_of("prepare"), usual)
    samples = Samples()
    memory = options.get("takes") == "memory"
    rounds = 1 if memory else room.options.rounds
    for number in range(0 if memory or options.get("cold") else -1, rounds):
        environment = dict(usual)
        if options.get("cold"):
            cache = room.folder / f"cache{next(room.numbers)}"
            environment |= {"MESA_SHADER_CACHE_DIR": str(cache), "PLAYGROUND_CACHE": "0"}
        wall, seconds, most = spent(text_of("code"), environment)
        if number < 0:
            continue
        samples.wall.append(most / MIB if memory else wall * 1e3)
        if not memory:
            samples.processor.append(seconds * 1e3)
    if memory and not any(samples.wall):
        room.options.say(f"{row.name}: this system does not say how much memory a process took")
        return
    unit = "MiB" if memory else "ms"
    yield Figure(row.suite, row.name, row.what, size, unit, row.goal, {"auto": samples})


def environment_of(room: Room) -> dict[str, str]:
    """Return this process's environment, in which compiled modules are written and found."""
    own = {"PYTHONDONTWRITEBYTECODE": "", "PYTHONPYCACHEPREFIX": str(room.folder / "modules")}
    return {**os.environ, **own}


def spent(code: str, environment: Mapping[str, str]) -> tuple[float, float, float]:
    """Run Python text in a process; return seconds on the clock, of processors, and bytes at most.

    Raises ``PlaygroundError`` with its last words where it fails.
    """
    ends = "spent()" not in code
    command = [sys.executable, "-c", _SPENT + code + (_ENDS if ends else "")]
    start, wall, times = time.perf_counter(), 0.0, [0.0, 0.0]
    with (
        tempfile.TemporaryFile("w+", encoding="utf-8") as errors,
        subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=errors, text=True, env=dict(environment)
        ) as process,
    ):
        assert process.stdout is not None
        for line in process.stdout:
            if line.startswith(_MARK):
                wall = time.perf_counter() - start
                times = json.loads(line.removeprefix(_MARK))
        process.wait()
        if ends:
            wall = time.perf_counter() - start
        if process.returncode:
            errors.seek(0)
            last = (errors.read().strip().splitlines() or ["it said nothing"])[-1]
            raise PlaygroundError(f"a process of the benchmark failed: {last}")
    return wall, float(times[0]), float(times[1])
