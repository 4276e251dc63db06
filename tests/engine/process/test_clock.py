"""Each pass has its own time, all its steps; what a process waits for a processor is told from its work."""

from __future__ import annotations

import os
import subprocess
import sys
import time as real_time
from pathlib import Path

import pytest

from playground.engine.process import child as clock_module
from playground.engine.process.child import ActivityClock, times_of, worked

BUSY = "import os, time\nos.sched_setaffinity(0, {cpu})\nprint(flush=True)\nwhile True: pass"
needs_counts = pytest.mark.skipif(
    not Path("/proc/self/schedstat").exists(), reason="this system does not count waits"
)


class Time:
    """Replaces the clock, and for how long a process has waited for a processor."""

    def __init__(self) -> None:
        self.now = 1000.0
        self.ran = self.waited = 0.0

    def monotonic(self) -> float:
        return self.now

    def times(self) -> dict[str, tuple[int, int]]:
        return {"1": (round(self.ran * 1e9), round(self.waited * 1e9))}

    def passes(self, seconds: float, waited: float = 0.0) -> None:
        self.now += seconds
        self.ran += seconds - waited
        self.waited += waited


@pytest.fixture
def time(monkeypatch: pytest.MonkeyPatch) -> Time:
    made = Time()
    monkeypatch.setattr(clock_module, "time", made)
    return made


def test_each_pass_has_its_own_time(time: Time):
    clock = ActivityClock(time.times)
    assert clock.seconds == 0.0
    for path in ("height", "horizon", "light"):
        clock.begin(path)
        time.passes(8.0)
        assert clock.seconds == pytest.approx(8.0)
    clock.begin("view")
    assert clock.seconds == 0.0
    assert clock.total == pytest.approx(24.0)


def test_the_steps_of_a_loop_add_up(time: Time):
    clock = ActivityClock(time.times)
    for _ in range(300):
        for path, seconds in (("rain", 0.01), ("flow", 0.04)):
            clock.begin(path)
            time.passes(seconds)
    assert clock.seconds == pytest.approx(300 * 0.04)
    clock.begin("rain")
    assert clock.seconds == pytest.approx(300 * 0.01)
    assert clock.total == pytest.approx(300 * 0.05)
    clock.clear()
    assert clock.total == 0.0
    clock.begin("rain")
    assert clock.seconds == 0.0


def test_activity_clock_excludes_cpu_wait_except_for_a_fraction(time: Time):
    clock = ActivityClock(time.times)
    clock.begin("a")
    time.passes(40.0, waited=39.0)
    assert clock.seconds == pytest.approx(40.0 / 8), "and no more: what never ends must be stopped"
    clock.begin("b")
    time.passes(40.0, waited=30.0)
    assert clock.seconds == pytest.approx(10.0), "what the pass before waited is not this one's"


def test_concurrent_clock_read_in_begin_counts_nothing_twice(time: Time):
    """Another thread may read the clock anywhere in ``begin``: here, where that reads what was waited."""
    totals: list[float] = []

    def times() -> dict[str, tuple[int, int]]:
        nonlocal reads
        reads, amid = False, reads
        if amid:
            totals.append(clock.total)
        reads = amid
        return time.times()

    reads = False
    clock = ActivityClock(times)
    clock.begin("start")
    time.passes(8.0)
    reads = True
    clock.begin("height")
    assert totals and totals == pytest.approx([8.0] * len(totals))


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
        before, start = [times_of(process.pid) for process in busy], real_time.monotonic()
        real_time.sleep(3.0)
        passed = real_time.monotonic() - start
        now = [times_of(process.pid) for process in busy]
        result = [worked(passed, b, n) for b, n in zip(before, now, strict=True)]
        assert sum(result) <= passed * 1.3 + 0.1, "other processes may have had the rest"
        assert max(result) < 0.7 * passed
    finally:
        for process in busy:
            process.kill()
            process.communicate()
