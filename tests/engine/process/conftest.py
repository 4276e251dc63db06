"""A handler that needs no OpenGL and ends in each way that a process can."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path

import pytest

HANDLER = """
import ctypes, os, sys, time
from pathlib import Path
from playground.errors import ContextError, ShaderError
from playground.engine.process.worker import Service

def open_service(parent, options):
    if options == "dies":
        print("no driver", file=sys.stderr, flush=True)
        sys.exit(7)
    if options == "refuses":
        raise ContextError("no renderer")
    while options == "waits" and not Path("now").exists():
        time.sleep(0.01)
    if options == "hangs":
        time.sleep(100_000)

    def answer(request):
        what, *more = request
        if what == "echo":
            return more[0]
        if what == "number":
            return os.getpid()
        if what == "environment":
            return os.environ.get(more[0])
        if what == "folder":
            return os.getcwd()
        if what == "print":
            os.write(1, b"to standard output\\n")
            print("from Python", flush=True)
            os.write(2, b"nir: validation failed\\n")
            return sys.stdin.read()
        if what == "mistake":
            raise ShaderError("no such name", file="a.glsl", line=3)
        if what == "bug":
            return 1 // 0
        if what == "hungry":
            return len(bytearray(more[0]))
        if what == "no memory":
            raise MemoryError
        if what == "signal":
            parent.report(("pass", "a"))
            os.kill(os.getpid(), more[0])
        if what == "half a frame":
            parent._answers.write(b"\\0frame\\r\\n\\x40")
            parent._answers.flush()
            os._exit(3)
        if what == "no frame":
            parent._answers.write(b"libEGL warning: failed")
            parent._answers.flush()
        if what == "loop":  # as a draw does: with Python's lock held, so that no thread and no handler runs
            parent.report("loop")
            Path("begun").touch()
            ctypes.PyDLL(None).sleep(100_000)
        if what == "resident":
            return int(Path("/proc/self/statm").read_text().split()[1]) * 4096
        if what == "holes":  # as a compiler: of many small blocks few stay, among them the last
            malloc, free = ctypes.CDLL(None).malloc, ctypes.CDLL(None).free
            malloc.restype, free.argtypes = ctypes.c_void_p, [ctypes.c_void_p]
            blocks = [malloc(2**15) for _ in range(more[0] // 2**15)]
            for number, block in enumerate(reversed(blocks)):
                ctypes.memset(block, 1, 2**15)
                if number % 64:
                    free(block)
            return int(Path("/proc/self/statm").read_text().split()[1]) * 4096
        if what == "count":
            done = 0
            while more[0] is None or done < more[0]:
                parent.report((done, more[0]))
                done += 1
                time.sleep(0.001)
            return done
        if what == "passes":
            for number in range(more[1]):
                parent.report(f"pass {number}")
                end = time.monotonic() + more[0]
                while time.monotonic() < end:
                    time.sleep(0.01)
            return "done"
        if what == "together":  # so many processes
            Path(f"here-{os.getpid()}").touch()
            while len([*Path().glob("here-*")]) < more[0]:
                time.sleep(0.005)
            return os.getpid()
        if what == "dies once":
            if not Path("died").exists():
                Path("died").touch()
                os.abort()
            return "alive"
        if what == "clean up":
            try:
                while True:
                    parent.report("busy")
                    Path("begun").touch()
                    time.sleep(0.01)
            finally:
                Path("cleaned").touch()
        raise AssertionError(what)

    return Service(answer, ("ready", options))
"""


@pytest.fixture
def handler(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """Give the handler's module name; the working folder is the test's own."""
    (tmp_path / "made_up_handler.py").write_text(HANDLER, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    return "made_up_handler"


def is_alive(pid: int) -> bool:
    """Say whether a process runs; a zombie does not."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


@pytest.fixture
def soon() -> Callable[[Callable[[], object]], bool]:
    """Give what waits until something holds, and says whether it does."""

    def wait(holds: Callable[[], object], patience: float = 60.0) -> bool:
        end = time.monotonic() + patience
        while not (result := bool(holds())) and time.monotonic() < end:
            time.sleep(0.005)
        return result

    return wait


@pytest.fixture
def alive() -> Callable[[int], bool]:
    """Give what says whether a process runs."""
    if not Path("/proc/self/stat").exists():
        return _signalled
    return is_alive


def _signalled(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except OSError:
        return False
    return True
