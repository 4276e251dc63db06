"""A capture in its process ends with a message, whatever went wrong."""

from __future__ import annotations

from pathlib import Path

from playground.publish.capture_job import PICTURE, CaptureJob, JobProcess


def test_a_job_that_cannot_be_sent_ends_with_a_sentence(tmp_path: Path) -> None:
    def sketch() -> None:
        """Stand in for a sketch: what is defined inside a function cannot be pickled."""

    sketch.name = "none"  # type: ignore[attr-defined]

    working = JobProcess(
        CaptureJob(kind=PICTURE, sketch=sketch, folder=tmp_path, ending=".png", size=(64, 64))  # type: ignore[arg-type]
    )
    finished = working.poll(timeout=60.0)
    assert finished is not None and finished.path is None
    assert finished.error.startswith("a bug of the playground itself, ") and "local object" in finished.error
