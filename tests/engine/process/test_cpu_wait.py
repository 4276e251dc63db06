"""Processor time is distinguished from time that a process waits for a processor."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from playground.engine.process.cpu_wait import times_of, worked

BUSY = "import os, time\nos.sched_setaffinity(0, {cpu})\nprint(flush=True)\nwhile True: pass"
needs_counts = pytest.mark.skipif(
    not Path("/proc/self/schedstat").exists(), reason="this system does not count waits"
)


def test_the_busiest_thread_counts_and_what_no_thread_waited_for():
    second = 1_000_000_000
    before = {"1": (5 * second, second), "2": (second, 0)}
    # Two threads share a processor with others for 10 s; a new one has run for a second.
    now = {"1": (8 * second, 8 * second), "2": (3 * second, 8 * second), "3": (second, 9 * second)}
    assert worked(10.0, before, now) == pytest.approx(3.0)
    # Main thread for 4 s, then a renderer's for 4 s, while others have the processor for 8 s.
    now = {"1": (9 * second, 5 * second), "2": (5 * second, 4 * second)}
    assert worked(16.0, before, now) == pytest.approx(4.0)
    # A graphics card works for it: no thread runs or waits.
    assert worked(10.0, before, before) == pytest.approx(10.0)
    assert worked(10.0, before, {"1": (6 * second, second), "2": (second, 0)}) == pytest.approx(10.0)
    # Nothing is counted here.
    assert worked(10.0, {}, {}) == 10.0
    assert worked(80.0, {}, {"1": (0, 80 * second)}) == pytest.approx(10.0), "a share of all that passed"


def test_a_process_that_is_gone_has_no_times():
    done = subprocess.Popen([sys.executable, "-c", ""])
    done.wait()
    assert times_of(done.pid) == {}


@pytest.mark.slow
@needs_counts
def test_processes_that_share_one_processor_work_in_turn():
    """Three on one: each works for about a third of the time, so together for all that passes."""
    cpu = min(os.sched_getaffinity(0))
    text = BUSY.format(cpu=f"{{{cpu}}}")
    busy = [subprocess.Popen([sys.executable, "-c", text], stdout=subprocess.PIPE) for _ in range(3)]
    try:
        for process in busy:
            assert process.stdout is not None
            process.stdout.readline()
        before, start = [times_of(process.pid) for process in busy], time.monotonic()
        time.sleep(3.0)
        passed = time.monotonic() - start
        now = [times_of(process.pid) for process in busy]
        found = [worked(passed, b, n) for b, n in zip(before, now, strict=True)]
        assert sum(found) <= passed * 1.3 + 0.1, "other processes may have had the rest"
        assert max(found) < 0.7 * passed
    finally:
        for process in busy:
            process.kill()
            process.communicate()
