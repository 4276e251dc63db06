"""Time that a process waits for a processor is told from time that it works."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from playground.engine.sandbox_process import Process
from playground.process.cpu_wait import waited_since, waits_of

BUSY = "import os, time\nos.sched_setaffinity(0, {cpu})\nprint(flush=True)\nwhile True: pass"
READY = """
import sys
import time
from pathlib import Path
from playground.engine.sandbox_process import Ready, send
while not Path(sys.argv[1]).exists():
    time.sleep(0.01)
send(sys.stdout.buffer, Ready())
sys.stdin.read()
"""
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


def test_a_trial_s_time_is_what_it_had(monkeypatch):
    """One that waited for a processor has worked for the rest, and for an eighth at least."""
    process = Process[object]("playground.engine.sandbox_child", ["0", "any", "60.0"])
    try:
        process.busy, process._ready_at = True, time.monotonic() - 100.0
        process._handed_at = process._ready_at
        monkeypatch.setattr("playground.engine.sandbox_process.waits_of", lambda _: {"1": 80_000_000_000})
        assert process.seconds == pytest.approx(20.0, abs=9.0)
        monkeypatch.setattr("playground.engine.sandbox_process.waits_of", lambda _: {"1": 99_900_000_000})
        assert process.seconds == pytest.approx(100.0 / 8, abs=2.0)
        monkeypatch.setattr("playground.engine.sandbox_process.waits_of", lambda _: {})
        assert process.seconds >= 100.0
    finally:
        process.kill()


def test_what_it_waited_before_it_was_ready_does_not_count(monkeypatch, tmp_path):
    """Its time begins when it is ready, and so do its waits."""
    (tmp_path / "ready_late.py").write_text(READY, encoding="utf-8")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    waited = {"1": 0}
    monkeypatch.setattr("playground.engine.sandbox_process.waits_of", lambda _: dict(waited))
    process = Process[object]("ready_late", [str(tmp_path / "now")])
    try:
        process.hand_over(object())
        waited["1"] = 40_000_000_000  # while it started
        (tmp_path / "now").touch()
        end = time.monotonic() + 120.0
        while not process.is_ready and time.monotonic() < end:
            time.sleep(0.01)
        assert process.is_ready
        process._ready_at = time.monotonic() - 100.0
        process._handed_at = process._ready_at
        waited["1"] += 30_000_000_000
        assert 70.0 <= process.seconds < 100.0
    finally:
        process.kill()
