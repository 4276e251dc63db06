"""Time that a process waits for a processor is distinguished from time that it works."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from playground.process.cpu_wait import waited_since, waits_of

BUSY = "import os, time\nos.sched_setaffinity(0, {cpu})\nprint(flush=True)\nwhile True: pass"
needs_counts = pytest.mark.skipif(
    not Path("/proc/self/schedstat").exists(), reason="this system does not count waits"
)


def test_the_thread_that_waited_longest_counts_and_new_threads_from_their_beginning():
    before = {"1": 5_000_000_000, "2": 1_000_000_000}
    now = {"1": 5_500_000_000, "2": 3_000_000_000, "3": 700_000_000}
    assert waited_since(before, now) == pytest.approx(2.0)
    assert waited_since({}, {}) == 0.0


def test_a_process_that_is_gone_waits_for_nothing():
    done = subprocess.Popen([sys.executable, "-c", ""])
    done.wait()
    assert waits_of(done.pid) == {}


@pytest.mark.slow
@needs_counts
def test_processes_that_share_one_processor_wait_for_each_other():
    """Three on one: each waits about two thirds of the time, so together twice as long as passes."""
    cpu = min(os.sched_getaffinity(0))
    text = BUSY.format(cpu=f"{{{cpu}}}")
    busy = [subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE) for _ in range(3)]
    try:
        for process in busy:
            assert process.stdout is not None
            process.stdout.readline()
        before = [waits_of(process.pid) for process in busy]
        end = time.monotonic() + 60.0
        waited = 0.0
        while waited < 2.0 and time.monotonic() < end:
            time.sleep(0.1)
            waited = sum(waited_since(b, waits_of(p.pid)) for b, p in zip(before, busy, strict=True))
        assert waited >= 2.0
    finally:
        for process in busy:
            process.kill()
            process.communicate()
