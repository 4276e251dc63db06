"""The process that captures for a window: it takes one job, says how far it is, and answers.

Run by ``capture.job_process`` only, as ``python -m playground.capture.job_child RENDERER DRIVER STOP``,
where STOP is a file whose coming stops the job.
"""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

from playground.api import headless
from playground.capture.job import Job, do
from playground.capture.job_process import Finished, Progress
from playground.engine.plain_forms import silent
from playground.engine.sandbox_process import Ready, receive_bytes, send
from playground.engine.sandbox_wire import Reader
from playground.errors import PlaygroundError


class Stop(Exception):
    """The job is not wanted any more."""


def main() -> None:
    """Do the job that comes in, and answer."""
    renderer, driver, stop = sys.argv[1], sys.argv[2], Path(sys.argv[3])
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever a driver prints must not get between the answers
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the window's, which then stops the job
    send(answers, Ready())
    asked = receive_bytes(sys.stdin.buffer)
    if asked is None:
        return
    job: Job = Reader().read(asked)
    notes: list[str] = []

    def tell(done: int, of: int) -> None:
        if stop.exists():
            raise Stop
        send(answers, Progress("", "", done, of))

    try:
        with headless(software=renderer == "software", driver=driver, notice=silent) as engine:
            answer = Finished(do(job, engine, tell, notes.append), notes=tuple(notes))
    except Stop:
        answer = Finished(None, stopped=True)
    except BrokenPipeError:  # the window is gone
        return
    except PlaygroundError as error:
        answer = Finished(None, str(error))
    except MemoryError:
        answer = Finished(None, "there is not enough memory for a picture of that size")
    except Exception as error:  # a fault of ours: it must reach the window as words
        answer = Finished(None, f"a fault of the playground itself, {type(error).__name__}: {error}")
    send(answers, answer)


if __name__ == "__main__":
    main()
