"""A pool answers, reports and cancels; an outcome says how its process ended, and another starts."""

from __future__ import annotations

import os
import platform
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from playground.engine.process import child as child_module
from playground.engine.process import pool as pool_module
from playground.engine.process.child import Outcome
from playground.engine.process.pool import OPEN, Limits, Pool, Task
from playground.engine.process.worker import Cancelled, UnexpectedError, summary_of
from playground.errors import ContextError, SandboxCrash, ShaderError
from playground.sketch.load import load
from playground.sketch.model import kernels_of

Soon = Callable[..., bool]
Alive = Callable[[int], bool]

linux = pytest.mark.skipif(sys.platform != "linux", reason="only Linux does this")
GAVE_UP = "ended its process: the driver or its compiler gave up, or memory ran out"


@pytest.fixture
def pool(handler: str) -> Iterator[Pool]:
    made = Pool(handler, options={"a": 1})
    yield made
    made.shutdown(cancel_futures=True)


def value(pool: Pool, *request: object) -> object:
    return pool.run(request).get("asking")


def test_it_is_warm_answers_and_ends_by_itself(pool: Pool, alive: Alive, monkeypatch: pytest.MonkeyPatch):
    assert not pool.pids, "nothing starts before it is needed"
    assert pool.run(OPEN).value == ("ready", {"a": 1})
    (pid,) = pool.pids
    assert [value(pool, "number") for _ in range(3)] == [pid] * 3
    outcome = pool.run(("echo", bytes(2**20)))
    assert outcome.value == bytes(2**20), "more than a pipe holds"
    assert outcome.kind == "answer" and outcome.info == ("ready", {"a": 1}) and outcome.seconds < 60.0
    ends: list[Outcome] = []
    real = child_module.ChildProcess.end
    monkeypatch.setattr(
        child_module.ChildProcess, "end", lambda *arguments: ends.append(real(*arguments)) or ends[-1]
    )
    monkeypatch.setattr(pool_module, "PATIENCE", 60.0)
    pool.shutdown()
    assert [end.status for end in ends] == [0] and not alive(pid)
    pool.shutdown()
    assert value(pool, "echo", 5) == 5, "it starts again"


def test_requests_are_shared_out_and_answered_in_order(handler: str, alive: Alive):
    with Pool(handler, workers=2) as pool:
        tasks = [pool.submit(("together", 2)) for _ in range(2)]
        first, second = (task.result().get("asking") for task in tasks)
        assert {first, second} == set(pool.pids), "at the same time"
        assert [outcome.value for outcome in pool.map(("echo", n) for n in range(9))] == list(range(9))
        pending = [pool.submit(("echo", n)) for n in range(5)]
    assert [task.result().value for task in pending] == list(range(5)), "leaving waits for them"
    assert not alive(first) and not alive(second)


def test_errors_of_our_family_cross_whole_and_others_as_text(pool: Pool):
    pid = value(pool, "number")
    outcome = pool.run(("mistake",))
    assert outcome.kind == "refused" and isinstance(outcome.error, ShaderError)
    with pytest.raises(ShaderError, match=r"a\.glsl:3: no such name"):
        outcome.get("asking")
    assert value(pool, "number") == pid, "the same process answers on"
    bug = pool.run(("bug",))
    assert bug.kind == "crash" and isinstance(bug.error, UnexpectedError)
    assert summary_of(bug.error).startswith("ZeroDivisionError: ")
    assert "in the child process:\nTraceback" in str(bug.error) and "1 // 0" in str(bug.error)
    assert value(pool, "number") != pid, "who knows what it left behind"
    assert isinstance(pool.run(("no memory",)).error, MemoryError)
    assert value(pool, "echo", 5) == 5


def test_a_request_that_cannot_be_sent_is_refused(pool: Pool):
    outcome = pool.run(("echo", lambda: None))
    assert outcome.kind == "refused" and "local object" in str(outcome.error)
    assert value(pool, "echo", 5) == 5


def test_what_a_handler_prints_comes_between_no_frames(pool: Pool):
    outcome = pool.run(("print",))
    assert outcome.value == "", "it reads nothing"
    assert outcome.printed == "to standard output\nfrom Python\nnir: validation failed\n"
    assert pool.run(("echo", 1)).printed == ""


@linux
def test_a_process_that_cannot_be_started_leaves_no_file_open(handler: str, tmp_path: Path):
    files = Path("/proc/self/fd")
    before = len([*files.iterdir()])
    pool = Pool(handler, folder=tmp_path / "missing")
    for _ in range(3):
        with pytest.raises(FileNotFoundError):
            pool.run(("number",))
    pool.shutdown()
    assert len([*files.iterdir()]) == before


def test_environment_and_folder_are_the_pool_s_own(handler: str, tmp_path: Path):
    (tmp_path / "inside").mkdir()
    with Pool(handler, environment={"MADE_UP": "yes"}, folder=tmp_path / "inside") as pool:
        assert value(pool, "environment", "MADE_UP") == "yes"
        assert value(pool, "folder") == str(tmp_path / "inside")
    assert "MADE_UP" not in os.environ


@pytest.mark.parametrize("name", ["SIGSEGV", "SIGABRT", "SIGKILL"])
def test_a_crash_has_its_signal_and_what_was_being_done(pool: Pool, name: str):
    outcome = pool.run(("signal", signal.Signals[name]))
    assert outcome.kind == "crash" and outcome.signal_name == name
    assert outcome.progress == ("pass", "a") and outcome.started
    with pytest.raises(SandboxCrash, match=f"asking crashed: the process was ended by {name}"):
        outcome.get("asking")
    assert pool.died and value(pool, "number") in pool.pids


def test_an_endless_loop_is_killed(pool: Pool, alive: Alive):
    pid = value(pool, "number")
    outcome = pool.run(("loop",), seconds=0.3)
    assert (outcome.kind, outcome.limit, outcome.progress) == ("hang", 0.3, "loop")
    assert outcome.seconds >= 0.3 and not alive(pid)


@pytest.mark.slow
def test_a_request_has_a_limit_for_all_and_activities_their_own(handler: str):
    limits = Limits(seconds=0.6, total_seconds=2.0, longer={"pass 0": 60.0})
    with Pool(handler, limits) as pool:
        assert pool.run(("passes", 0.8, 1)).kind == "answer", "it may take longer"
        assert pool.run(("passes", 0.8, 2)).limit == 0.6
        assert pool.run(("passes", 0.05, 100)).limit == 2.0


@linux
def test_memory_has_a_limit_and_is_not_lost(handler: str):
    with Pool(handler, Limits(memory_bytes=300 * 2**20)) as pool:
        assert value(pool, "hungry", 2**20) == 2**20
        assert isinstance(pool.run(("hungry", 400 * 2**20)).error, MemoryError)
        assert value(pool, "echo", 5) == 5


@linux
@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="another C library has its own ways")
def test_a_process_at_rest_holds_no_free_memory(pool: Pool, soon: Soon):
    size = 128 * 2**20
    before = value(pool, "resident")
    held = value(pool, "holes", size)
    assert held - before > 0.9 * size, "its heap holds what is free"
    assert soon(lambda: value(pool, "resident") - before < 0.1 * size, 10.0)


def test_half_a_frame_is_a_crash_and_no_frame_is_quoted(pool: Pool):
    assert pool.run(("half a frame",)).ending == "ended with status 3"
    assert pool.run(("no frame",)).ending == "sent an invalid answer: b'libEGL warning: '"


def test_a_process_that_dies_at_start_says_why(handler: str):
    pool = Pool(handler, options="dies")
    outcome = pool.run(("echo", 1))
    assert outcome.kind == "crash" and not outcome.started
    assert outcome.ending == "ended with status 7"
    assert outcome.printed == "no driver\n"
    assert pool.started == 3 and not pool.pids, "an end is put to it"
    assert "No module named 'no_such_handler'" in Pool("no_such_handler").run(OPEN).printed


def test_an_error_at_opening_is_each_outcome(handler: str):
    with Pool(handler, options="refuses") as pool:
        for outcome in (pool.run(OPEN), pool.run(("echo", 1)), pool.run(("echo", 1))):
            assert outcome.kind == "refused" and not outcome.started
            assert isinstance(outcome.error, ContextError)
        assert pool.started == 1


def test_a_start_that_hangs_is_stopped(handler: str, alive: Alive, soon: Soon):
    pool = Pool(handler, Limits(start_seconds=0.2), options="hangs")
    task = pool.submit(OPEN)
    assert soon(lambda: pool.pids)
    (pid,) = pool.pids
    outcome = task.result()
    assert (outcome.kind, outcome.limit, outcome.started) == ("hang", 0.2, False)
    assert not alive(pid) and pool.started == 1
    pool.shutdown()


def test_progress_is_seen(pool: Pool, soon: Soon):
    task = pool.submit(("count", 200))
    seen = set()

    def done() -> bool:
        seen.add(task.progress)
        return task.wait(0.0)

    assert soon(done) and task.result().get("asking") == 200
    assert len(seen - {None}) > 3 and seen - {None} <= {(done, 200) for done in range(200)}
    assert task.seconds == 0.0 < task.result().seconds


def test_a_request_is_cancelled_and_the_next_is_not(pool: Pool, soon: Soon):
    for ready in (False, True):
        task, behind = pool.submit(("count", None)), pool.submit(("echo", 1))
        if ready:
            assert soon(lambda task=task: task.progress)
        assert task.cancel() and behind.cancel() and behind.cancelled()
        for outcome in (task.result(), behind.result()):
            assert outcome.kind == "refused" and isinstance(outcome.error, Cancelled)
    assert not task.cancel(), "it is done"
    assert value(pool, "count", 3) == 3
    (pid,) = pool.pids
    stubborn = pool.submit(("loop",))
    assert soon(lambda: stubborn.progress)
    stubborn.cancel(0.1)
    assert isinstance(stubborn.result().error, Cancelled)
    assert value(pool, "number") != pid, "it was killed"


class CancelsItself:
    """A part of a request that is cancelled while it is encoded."""

    task: Task | None = None

    def __reduce__(self) -> tuple[type[str], tuple[()]]:
        while self.task is None:
            time.sleep(0.001)
        self.task.cancel()
        return str, ()


def test_kernels_of_request_cancelled_unsent_come_with_the_next(pool: Pool):
    _, kernel = next(iter(kernels_of(load("l_dot_n").graph)))
    assert value(pool, "echo", 1) == 1
    part = CancelsItself()
    part.task = pool.submit(("echo", [kernel, part]))
    assert isinstance(part.task.result().error, Cancelled)
    assert value(pool, "echo", kernel) == kernel


@pytest.mark.parametrize("ready", [False, True])
def test_closing_while_it_is_busy_kills_it(handler: str, alive: Alive, soon: Soon, ready: bool):
    pool = Pool(handler)
    task, waiting = pool.submit(("loop",)), pool.submit(("echo", 1))
    assert soon(lambda: task.progress if ready else pool.pids)
    (pid,) = pool.pids
    start = time.monotonic()
    pool.shutdown(cancel_futures=True)
    assert not alive(pid)
    assert time.monotonic() - start < 5.0, "it did not wait for it"
    assert all(isinstance(task.result().error, Cancelled) for task in (task, waiting))


def test_ctrl_c_leaves_no_process_and_no_answer_for_the_next(
    pool: Pool, alive: Alive, monkeypatch: pytest.MonkeyPatch, soon: Soon
):
    def interrupted(task: Task, timeout: float) -> bool:
        if task.progress:
            raise KeyboardInterrupt
        time.sleep(0.01)
        return False

    first = value(pool, "number")
    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(Task, "wait", interrupted)
        pool.run(("loop",))
    assert value(pool, "echo", 3) == 3
    assert not alive(first)
    with pytest.raises(KeyboardInterrupt), pool:
        pool.submit(("loop",))
        assert soon(lambda: pool.pids)
        raise KeyboardInterrupt
    assert not pool.pids


@pytest.mark.parametrize("idle", [True, False])
def test_request_is_resent_if_process_died_before_start(pool: Pool, idle: bool):
    pid = value(pool, "number")
    os.kill(pid, signal.SIGKILL)
    if idle:
        os.waitid(os.P_PID, pid, os.WEXITED | os.WNOWAIT)
    assert value(pool, "number") != pid
    assert not pool.died, "it is nobody's crash"


def test_a_crash_is_tried_again_as_often_as_the_limits_say(handler: str):
    with Pool(handler, Limits(crashes=2)) as pool:
        assert pool.run(("dies once",)).value == "alive"
        assert pool.run(("signal", signal.SIGABRT)).kind == "crash"
        assert pool.started == 4  # one more is warm


def test_a_process_answers_so_many_requests(handler: str):
    with Pool(handler, Limits(requests=2)) as pool:
        pids = [value(pool, "number") for _ in range(5)]
        assert pids[0] == pids[1] != pids[2] == pids[3] != pids[4]
        pool.renew()
        assert value(pool, "number") != pids[4]


def test_a_spare_takes_the_place_of_one_that_takes_long_or_died(handler: str, alive: Alive, soon: Soon):
    with Pool(handler, spare=True) as pool:
        first = value(pool, "number")
        assert pool.pids == [first]
        task = pool.submit(("loop",))
        assert soon(lambda: len(pool.pids) == 2)
        spare = pool.pids[1]
        task.cancel(0.0)
        assert value(pool, "number") == spare and not alive(first)
        os.kill(pool.pids[-1], signal.SIGKILL)
        pool.run(("signal", signal.SIGABRT))
        assert value(pool, "number") not in (first, spare), "a spare that died is of no use"
    assert not pool.pids


@pytest.mark.slow
def test_many_at_once_answer_for_themselves(handler: str, alive: Alive):
    with Pool(handler, workers=6) as pool:
        crash = ("signal", signal.SIGABRT)
        outcomes = list(pool.map(crash if n % 6 == 3 else ("echo", n) for n in range(30)))
        pids = pool.pids
    for number, outcome in enumerate(outcomes):
        assert outcome.kind == "crash" if number % 6 == 3 else outcome.value == number
    assert not any(map(alive, pids))


PARENT = """
import sys
import time
from playground.engine.process import pool
pool._GRACE, pool.max_wall_seconds = 1.0, lambda _: LIMIT
limits = pool.Limits(seconds=60.0) if LIMIT else pool.Limits()
pool = pool.Pool("made_up_handler", limits, ends_with_parent=PIPE)
pool.submit((REQUEST,))
while not pool.pids:
    time.sleep(0.01)
print(*pool.pids, flush=True)
sys.stdin.read()
"""


@pytest.mark.always
@pytest.mark.slow
@linux
@pytest.mark.parametrize(
    ("request_name", "pipe", "limit"),
    [("loop", True, 0.0), ("loop", False, 0.1), ("clean up", False, 0.0)],
    ids=["by its pipe", "by its own clock", "by cancelling"],
)
def test_a_parent_that_is_killed_leaves_no_worker(
    handler: str, alive: Alive, soon: Soon, tmp_path: Path, request_name: str, pipe: bool, limit: float
):
    text = (
        PARENT.replace("LIMIT", str(limit)).replace("PIPE", str(pipe)).replace("REQUEST", repr(request_name))
    )
    path = os.pathsep.join([*(p for p in sys.path if p)])
    with subprocess.Popen(
        [sys.executable, "-c", text],
        env={**os.environ, "PYTHONPATH": path},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    ) as parent:
        assert parent.stdout is not None
        pid = int(parent.stdout.readline())
        assert soon(Path("begun").exists)
        parent.kill()
    try:
        assert soon(lambda: not alive(pid))
        assert Path("cleaned").exists() == (request_name == "clean up")
    finally:
        if alive(pid):
            os.kill(pid, signal.SIGKILL)


def test_pool_task_time_excludes_cpu_wait_except_for_a_fraction(
    handler: str, soon: Soon, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    """Its time begins when it is ready, and so do its waits."""
    waited = {"1": 0}
    monkeypatch.setattr(child_module, "times_of", lambda _: {name: (0, ns) for name, ns in waited.items()})
    pool = Pool(handler, options="waits")
    task = pool.submit(("loop",))
    time.sleep(0.3)
    assert task.seconds == 0.0
    waited["1"] = 40_000_000_000  # while it started
    started = time.monotonic()
    (tmp_path / "now").touch()
    assert soon(lambda: task.progress)
    time.sleep(0.4)
    assert 0.3 < task.seconds
    waited["1"] += 350_000_000
    assert task.seconds <= time.monotonic() - started - 0.35, "however slow this machine is"
    waited["1"] += 100_000_000_000
    assert task.seconds >= 0.4 / 8, "a fraction counts, however long it waited"
    pool.shutdown(cancel_futures=True)


@pytest.mark.parametrize(
    ("status", "ending"),
    [
        (7, "ended with status 7"),
        (0, "ended with status 0"),
        (-11, "was ended by SIGSEGV"),
        (-1000, "was ended by signal 1000"),
        (0xC0000005, "was ended by an access violation"),
        (None, "died"),
    ],
)
def test_the_ending_is_a_signal_or_a_status(status: int | None, ending: str):
    assert Outcome("crash", status=status).ending == ending


@pytest.mark.parametrize(
    ("status", "output", "cause"),
    [
        (-11, "", "crashed the driver or its compiler (SIGSEGV)"),
        (
            -6,
            "first\nnir\n",
            "crashed the driver or its compiler (SIGABRT; its last output: nir)",
        ),
        (
            -6,
            "LLVM ERROR: out of memory",
            "ran out of memory (SIGABRT; its last output: LLVM ERROR: out of memory)",
        ),
        (0xC00000FD, "", "crashed the driver or its compiler (a stack overflow)"),
        (-9, "", "was killed by the system (SIGKILL); did memory run out?"),
        (
            3,
            "",
            "ended its process: the driver or its compiler gave up, or memory ran out (ended with status 3)",
        ),
        (None, "", "ended its process: the driver or its compiler gave up, or memory ran out (died)"),
    ],
)
def test_the_cause_is_guessed_from_the_signal_and_the_last_line(status: int | None, output: str, cause: str):
    assert Outcome("crash", status=status, printed=output).cause() == cause


def test_the_last_lines_are_quoted_and_a_place_is_named():
    outcome = Outcome("crash", status=-11, printed="".join(f"line {number}\n\n" for number in range(20)))
    lines = "".join(f"\n    | line {number}" for number in range(8, 20))
    assert str(outcome.failure("drawing")) == f"drawing crashed: the process was ended by SIGSEGV{lines}"
    assert outcome.cause(" in the sandbox").startswith("crashed the driver or its compiler in the sandbox")
