"""Run a capture in a worker process: open an engine for the job, report how far it is."""

from __future__ import annotations

from playground.api import headless
from playground.capture.job import CaptureJob, do
from playground.capture.job_process import Finished
from playground.engine.plain_forms import silent
from playground.engine.process.child import Parent, Service


def open_service(parent: Parent, options: tuple[bool, str]) -> Service:
    """Return the service that does a job: on a software renderer, by which driver."""
    software, driver = options

    def answer(job: CaptureJob) -> Finished:
        notes: list[str] = []
        with headless(software=software, driver=driver, notice=silent) as engine:
            path = do(job, engine, lambda done, of: parent.report((done, of)), notes.append)
        return Finished(path, notes=tuple(notes))

    return Service(answer)
