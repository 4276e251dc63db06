"""A worker answers, reports and is cancelled; the parent learns how it ended, and another starts."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from playground.engine.process import worker as worker_module
from playground.engine.process.messages import Cancelled, UnexpectedError, summary_of
from playground.engine.process.worker import Launch, Replaceable, Worker, WorkerDied, WorkerTimeout
from playground.errors import ContextError, ShaderError

LONG = 120.0  # [s] for what is quick on any machine that is not busy
Soon = Callable[[Callable[[], object]], bool]
Alive = Callable[[int], bool]

linux = pytest.mark.skipif(sys.platform != "linux", reason="only Linux does this")


@pytest.fixture
def worker(handler: str) -> Iterator[Worker]:
    with Worker(Launch(handler=handler, options={"a": 1})) as made:
        yield made


def ended(worker: Worker, *request: object, limit: float = LONG) -> WorkerDied:
    with pytest.raises(WorkerDied) as caught:
        worker.ask(request, limit)
    return caught.value


def test_it_is_warm_answers_and_ends_by_itself(worker: Worker, alive: Alive):
    assert worker.wait_until_ready() == ("ready", {"a": 1})
    assert worker.is_ready and worker.starting_seconds == 0.0
    assert [worker.ask(("number",), LONG) for _ in range(3)] == [worker.pid] * 3
    assert worker.ask(("echo", bytes(2**20)), LONG) == bytes(2**20), "more than a pipe holds"
    report = worker.end()
    assert report.status == 0 and not alive(worker.pid)
    assert worker.end().status == 0, "a second time does nothing"


def test_errors_of_our_family_cross_whole_and_others_as_text(worker: Worker):
    with pytest.raises(ShaderError, match=r"a\.glsl:3: no such name") as caught:
        worker.ask(("mistake",), LONG)
    assert caught.value.diagnostics[0].line == 3
    with pytest.raises(UnexpectedError, match=r"in the child process:\nTraceback[^$]*1 // 0") as bug:
        worker.ask(("bug",), LONG)
    assert summary_of(bug.value).startswith("ZeroDivisionError: ")
    with pytest.raises(MemoryError):
        worker.ask(("no memory",), LONG)
    assert worker.ask(("echo", 5), LONG) == 5, "it answers on"


def test_a_request_that_cannot_be_sent_is_an_error_and_the_next_is_answered(worker: Worker):
    with pytest.raises(Exception, match="local object"):
        worker.ask(("echo", lambda: None), LONG)
    assert worker.ask(("echo", 5), LONG) == 5


def test_what_a_handler_prints_comes_between_no_frames_and_it_reads_nothing(worker: Worker):
    assert worker.ask(("print",), LONG) == ""
    assert worker.printed() == "to standard output\nfrom Python\nnir: validation failed\n"
    assert worker.printed() == ""


@linux
def test_a_process_that_cannot_be_started_leaves_no_file_open(handler: str, tmp_path: Path):
    files = Path("/proc/self/fd")
    before = len([*files.iterdir()])
    for _ in range(3):
        with pytest.raises(FileNotFoundError):
            Worker(Launch(handler=handler, folder=tmp_path / "missing"))
    assert len([*files.iterdir()]) == before


def test_its_environment_and_its_folder_are_those_of_its_launch(handler: str, tmp_path: Path):
    (tmp_path / "inside").mkdir()
    launch = Launch(handler=handler, environment={"MADE_UP": "yes"}, folder=tmp_path / "inside")
    with Worker(launch) as worker:
        assert worker.ask(("environment", "MADE_UP"), LONG) == "yes"
        assert worker.ask(("folder",), LONG) == str(tmp_path / "inside")
    assert "MADE_UP" not in os.environ


@pytest.mark.parametrize("name", ["SIGSEGV", "SIGABRT", "SIGKILL"])
def test_a_crash_is_reported_with_its_signal_and_what_was_being_done(worker: Worker, name: str):
    died = ended(worker, "signal", signal.Signals[name])
    assert not isinstance(died, WorkerTimeout)
    assert died.report.signal_name == name
    assert died.report.progress == ("pass", "a") and died.report.was_ready
    assert not worker.runs


def test_an_endless_loop_is_killed(worker: Worker, alive: Alive):
    worker.wait_until_ready()
    died = ended(worker, "loop", limit=0.3)
    assert isinstance(died, WorkerTimeout)
    assert died.report.progress == "loop"
    assert not alive(worker.pid)


@linux
def test_memory_has_a_limit_and_is_not_lost(handler: str):
    with Worker(Launch(handler=handler, memory_bytes=300 * 2**20)) as worker:
        assert worker.ask(("hungry", 2**20), LONG) == 2**20
        with pytest.raises(MemoryError):
            worker.ask(("hungry", 400 * 2**20), LONG)
        assert worker.ask(("echo", 5), LONG) == 5


def test_half_a_frame_is_a_crash_and_what_is_no_frame_is_quoted(handler: str):
    launch = Launch(handler=handler)
    with Worker(launch) as worker:
        assert ended(worker, "half a frame").report.ending == "ended with status 3"
    with Worker(launch) as worker:
        report = ended(worker, "no frame").report
    assert report.ending == "sent what is no answer: b'libEGL warning: '"


def test_a_worker_that_dies_at_start_says_why(handler: str):
    with Worker(Launch(handler=handler, options="dies")) as worker:
        died = ended(worker, "echo", 1)
    assert died.report.ending == "ended with status 7" and not died.report.was_ready
    assert died.report.last_lines == "\n    | no driver"
    with Worker(Launch(handler="no_such_handler")) as worker, pytest.raises(WorkerDied) as caught:
        worker.wait_until_ready()
    assert "No module named 'no_such_handler'" in caught.value.report.output


def test_an_error_at_opening_is_each_answer(handler: str):
    with Worker(Launch(handler=handler, options="refuses")) as worker:
        for _ in range(2):
            with pytest.raises(ContextError, match="no renderer"):
                worker.ask(("echo", 1), LONG)
        worker.submit(("echo", 1))
        answer = worker.poll(LONG)
        assert answer is not None and isinstance(answer.error, ContextError)


def test_a_start_that_hangs_is_stopped(handler: str, alive: Alive):
    with Worker(Launch(handler=handler, options="hangs")) as worker:
        with pytest.raises(WorkerTimeout):
            worker.wait_until_ready(0.2)
        assert not alive(worker.pid)


def test_progress_is_seen_and_counts_as_time_of_its_own(worker: Worker, soon: Soon):
    worker.submit(("count", 200))
    seen = set()

    def done() -> bool:
        seen.add(worker.progress)
        return (answer := worker.poll()) is not None and answer.get() == 200

    assert soon(done)
    assert len(seen - {None}) > 3 and seen - {None} <= {(done, 200) for done in range(200)}
    assert not worker.busy and worker.seconds == 0.0


def test_a_request_is_cancelled_and_the_next_is_not(worker: Worker, soon: Soon):
    for ready in (False, True):
        worker.submit(("count", None))
        if ready:
            assert soon(lambda: worker.progress)
        worker.cancel()
        answer = worker.poll(LONG)
        assert answer is not None and isinstance(answer.error, Cancelled)
    worker.cancel()
    assert worker.ask(("count", 3), LONG) == 3


@pytest.mark.parametrize("ready", [False, True])
def test_closing_while_it_is_busy_kills_it(handler: str, alive: Alive, soon: Soon, ready: bool):
    start = time.monotonic()
    with Worker(Launch(handler=handler)) as worker:
        worker.submit(("loop",))
        if ready:
            assert soon(lambda: worker.progress)
            start = time.monotonic()
    assert not alive(worker.pid)
    assert time.monotonic() - start < 5.0, "it did not wait for it"


def test_ctrl_c_leaves_no_process_and_no_answer_for_the_next(
    handler: str, alive: Alive, monkeypatch: pytest.MonkeyPatch
):
    def interrupted(timeout: float) -> None:
        raise KeyboardInterrupt

    workers = Replaceable(Launch(handler=handler))
    first = workers.start()
    assert first.ask(("echo", 1), LONG) == 1
    monkeypatch.setattr(first, "poll", interrupted)
    with pytest.raises(KeyboardInterrupt):
        first.ask(("echo", 2), LONG)
    assert not alive(first.pid)
    assert workers.start().ask(("echo", 3), LONG) == 3
    workers.close()


def test_another_starts_where_one_died_or_the_spare_takes_over(handler: str, alive: Alive):
    workers = Replaceable(Launch(handler=handler))
    first = workers.start()
    assert workers.start() is first
    ended(first, "signal", signal.SIGABRT)
    second = workers.start()
    assert second is not first and second.ask(("print",), LONG) == ""
    workers.start_spare()
    spare = workers.spare
    assert workers.replace() is spare and not alive(second.pid)
    assert spare is not None and spare.ask(("echo", 5), LONG) == 5
    assert workers.printed().startswith("to standard output"), "of one that is gone"
    workers.start_spare()
    assert workers.spare is not None
    workers.spare.end(kill=True)
    assert workers.replace() is not spare, "a spare that died is of no use"
    assert workers.started == 5
    workers.close()
    assert workers.worker is None and workers.spare is None


@pytest.mark.slow
def test_many_at_once_answer_for_themselves(handler: str, alive: Alive):
    launch = Launch(handler=handler)
    workers = [Worker(launch) for _ in range(6)]
    for number, worker in enumerate(workers):
        worker.submit(("signal", signal.SIGABRT) if number == 3 else ("number",))
    for number, worker in enumerate(workers):
        if number == 3:
            with pytest.raises(WorkerDied):
                worker.poll(LONG)
        else:
            answer = worker.poll(LONG)
            assert answer is not None and answer.get() == worker.pid
    for worker in workers:
        worker.end()
    assert not any(alive(worker.pid) for worker in workers)


PARENT = """
import sys
from playground.engine.process import worker
worker._GRACE = 1.0
launch = worker.Launch(handler="made_up_handler", limit_seconds=LIMIT, ends_with_parent=PIPE)
worker = worker.Worker(launch)
worker.submit((REQUEST,))
print(worker.pid, flush=True)
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


def test_what_it_waits_for_a_processor_does_not_count_but_for_a_share(
    handler: str, soon: Soon, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    """Its time begins when it is ready, and so do its waits."""
    waited = {"1": 0}
    monkeypatch.setattr(worker_module, "times_of", lambda _: {name: (0, ns) for name, ns in waited.items()})
    with Worker(Launch(handler=handler, options="waits")) as worker:
        worker.submit(("loop",))
        time.sleep(0.3)
        assert worker.seconds == worker.activity_seconds == 0.0 < worker.starting_seconds
        waited["1"] = 40_000_000_000  # while it started
        begun = time.monotonic()
        (tmp_path / "now").touch()
        assert soon(lambda: worker.progress)
        time.sleep(0.4)
        assert 0.3 < worker.activity_seconds <= worker.seconds
        waited["1"] += 350_000_000
        assert worker.activity_seconds <= time.monotonic() - begun - 0.35, "however slow this machine is"
        waited["1"] += 100_000_000_000
        assert worker.activity_seconds >= 0.4 / 8, "a share counts, however long it waited"
