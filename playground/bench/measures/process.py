"""What whole processes take: from their start to their end, and of memory."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from typing import Any

from playground.bench.results import Figure
from playground.bench.room import Room
from playground.bench.rows import Row
from playground.bench.timing import Samples
from playground.errors import PlaygroundError

MIB = 2**20
# A process prints what its children and it took as JSON, last: seconds of processors, bytes at most.
_SPENT = """
import json, sys
try:
    import resource
    own = resource.getrusage(resource.RUSAGE_SELF)
    most = own.ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    print(json.dumps([own.ru_utime + own.ru_stime, most]))
except ImportError:
    import time
    print(json.dumps([time.process_time(), 0]))
"""


def figures(row: Row, room: Room, size: int) -> Iterator[Figure]:
    """Yield the figure of a process that runs the Python text ``code``.

    In it, ``{out}`` is a file that it may write, ``{cache}`` a folder of all runs, and ``{size}`` the texels
    a side; ``prepare`` runs once before, untimed; ``takes`` is "time" or "memory"; ``cold`` gives each run
    an empty shader cache.
    """
    options = row.options
    names = {"{out}": room.folder / "out.png", "{cache}": room.folder / row.name, "{size}": size}

    def text_of(key: str) -> str:
        text = str(options[key])
        for name, what in names.items():
            text = text.replace(name, str(what))
        return text

    code = text_of("code")
    if "prepare" in options:
        spent([sys.executable, "-c", text_of("prepare") + _SPENT], dict(os.environ))
    found = Samples()
    memory = options.get("takes") == "memory"
    rounds = 1 if memory else room.options.rounds
    for number in range(0 if memory or options.get("cold") else -1, rounds):
        environment = dict(os.environ)
        if options.get("cold"):
            cache = room.folder / f"cache{next(room.numbers)}"
            environment |= {"MESA_SHADER_CACHE_DIR": str(cache), "PLAYGROUND_CACHE": "0"}
        start = time.perf_counter()
        seconds, most = spent([sys.executable, "-c", code + _SPENT], environment)
        wall = time.perf_counter() - start
        if number < 0:
            continue
        found.wall.append(most / MIB if memory else wall * 1e3)
        if not memory:
            found.processor.append(seconds * 1e3)
    if memory and not any(found.wall):
        room.options.say(f"{row.name}: this system does not say how much memory a process took")
        return
    unit = "MiB" if memory else "ms"
    yield Figure(row.suite, row.name, row.what, size, unit, row.goal, {"auto": found})


def spent(command: Sequence[str], environment: dict[str, str]) -> tuple[float, float]:
    """Run a process and return what it printed last: seconds of processors, and bytes at most."""
    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["it said nothing"])[-1]
        raise PlaygroundError(f"a process of the benchmark failed: {last}")
    found: Any = json.loads(done.stdout.strip().splitlines()[-1])
    return float(found[0]), float(found[1])
