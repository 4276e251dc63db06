"""Capture from the window: what is wished for, the job at work, and its result.

The pictures are drawn in another process from the sketch as it is now, so that the window
goes on; one job at a time.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path

from playground.errors import DataError, ParameterError, PlaygroundError, counted
from playground.paths import shown
from playground.publish.capture_job import FILM, PICTURE, PICTURES, SHEET, CaptureJob, JobProcess
from playground.publish.series import SWEEP_SIZE, Series
from playground.publish.video import QUALITY, check_video
from playground.sketch.model import MAX_PICTURE_SIDE, MAX_SIDE, Sketch
from playground.studio.notices import Notices
from playground.studio.session import Session

MULTIPLES = (1, 2, 4, 8)


@dataclass
class CaptureSettings:
    """What is typed and chosen in the capture's window."""

    kind: str = PICTURE
    multiple: int = 1  # of the picture's size in the window; 0: the size that is typed
    size: tuple[int, int] = (3840, 2160)
    seconds: float = 0.0  # 0: to the last keyframe, or ten
    start: float = 0.0
    fps: int = 30
    ending: str = ".mp4"
    quality: str = QUALITY
    sweeps: list[str] = field(default_factory=lambda: ["", ""])


@dataclass
class Captures:
    """The captures of one session, each made in another process."""

    session: Session
    notices: Notices
    folder: Path  # where pictures go
    settle: Callable[[], bool]  # has what is painted written, which the other process reads; whether it is
    settings: CaptureSettings = field(default_factory=CaptureSettings)
    shown: bool = False  # the capture's window is open
    working: JobProcess | None = None
    made: Path | None = None  # the file or folder that was captured last
    failed: str = ""  # why the last one was not made

    def toggle(self) -> None:
        """Show the capture's window, or no longer."""
        self.shown = not self.shown

    def start(self) -> None:
        """Begin what is wished for; what cannot be done becomes a notice."""
        if self.working is not None:
            return
        self.failed = ""
        try:
            if not self.settle():
                raise DataError("no capture was made, for what was painted last could not be written")
            job = self.job()
        except PlaygroundError as error:
            self.failed = str(error)
            self.notices.say(self.failed)
            return
        engine = self.session.engine
        self.working = JobProcess(job, software=engine.info.software, driver=engine.driver)

    def poll(self) -> None:
        """Take in how far the job is; report it once it has ended."""
        finished = self.working.poll() if self.working is not None else None
        if self.working is None or finished is None:
            return
        job, took = self.working.job, time.monotonic() - self.working.started
        self.working = None
        for note in finished.notes:
            self.notices.say(note)
        if finished.stopped:
            self.notices.say(
                "the capture was stopped" + ("; its pictures stay" if job.kind == PICTURES else "")
            )
        elif finished.path is None:
            self.failed = finished.error
            self.notices.say(finished.error)
        else:
            self.made = finished.path
            width, height = job.size
            what = "pictures of " if job.kind in (PICTURES, SHEET) else ""
            text = f"saved {shown(finished.path)}, {what}{width} x {height} pixels, in {took:.1f} s"
            self.notices.say(text)

    def close(self) -> None:
        """Stop the job that is at work."""
        if self.working is not None:
            self.working.close()
            self.working = None

    def size(self) -> tuple[int, int]:
        """Return the size in pixels that is wished for; raise ``ParameterError``."""
        settings, picture = self.settings, self.session.picture.texture
        width, height = picture.size if picture is not None else (0, 0)
        if settings.kind == SHEET and settings.multiple:
            scale = SWEEP_SIZE[0] * settings.multiple / max(width, 1)
            return max(round(width * scale), 1), max(round(height * scale), 1)
        size = (width * settings.multiple, height * settings.multiple) if settings.multiple else settings.size
        if settings.kind == FILM and settings.ending != ".gif":
            size = size[0] + size[0] % 2, size[1] + size[1] % 2
        most = MAX_PICTURE_SIDE if settings.kind in (PICTURE, PICTURES) else MAX_SIDE
        if not all(1 <= side <= most for side in size):
            raise ParameterError(f"{size[0]} x {size[1]} pixels: expected 1 to {most} a side")
        return size

    def job(self) -> CaptureJob:
        """Return what is wished for as a job; raise ``PlaygroundError`` for what cannot be."""
        settings, session = self.settings, self.session
        if session.sketch is None:
            raise DataError("there is no picture to save yet")
        shown_map = session.view.map
        sketch = shown_map.of(session.sketch) if shown_map is not None else session.sketch
        steps, size = session.view.stops(session.sketch, session.clock.time), self.size()
        moves = settings.kind in (FILM, PICTURES)
        start = settings.start if moves else session.clock.time
        fps, sweeps = (
            Fraction(max(settings.fps, 1)),
            tuple(filter(None, (s.strip() for s in settings.sweeps))),
        )
        if settings.kind == FILM:
            check_video(self.folder / f"film{settings.ending}", size, fps, settings.quality)
        if settings.kind == SHEET:
            if not sweeps:
                raise ParameterError("choose a parameter to sweep, or write one, as light.gain=0.5..3")
            Series.of_values(sketch, sweeps, time=start)
            if steps:
                raise ParameterError("a sheet runs every repeat to its end; set the steps back to all")
        return CaptureJob(
            kind=settings.kind,
            sketch=sketch,
            folder=self.folder,
            size=size,
            time=start,
            steps=steps,
            seconds=seconds_of(settings, sketch) if moves else None,
            fps=fps,
            ending=settings.ending,
            quality=settings.quality,
            sweeps=sweeps,
        )

    def summary(self) -> str:
        """Return in a few words what would be made."""
        try:
            width, height = self.size()
        except ParameterError as error:
            return str(error)
        if self.settings.kind in (FILM, PICTURES) and self.session.sketch is not None:
            count = round(seconds_of(self.settings, self.session.sketch) * self.settings.fps)
            return f"{counted(count, 'picture')} of {width} x {height} pixels"
        return f"{width} x {height} pixels" + (" each" if self.settings.kind == SHEET else "")


def seconds_of(settings: CaptureSettings, sketch: Sketch) -> float:
    """Return how long a film is [s]: as long as is wished, else to its last keyframe, else ten."""
    left = sketch.duration - settings.start
    return settings.seconds if settings.seconds > 0.0 else left if left > 0.0 else 10.0


def open_folder(path: Path) -> str:
    """Show a file's folder, or a folder, in the system's file manager; return a message where that fails."""
    folder = path if path.is_dir() else path.parent
    try:
        if sys.platform == "win32":
            os.startfile(folder)
        else:
            program = "open" if sys.platform == "darwin" else "xdg-open"
            subprocess.Popen(
                [program, str(folder)],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                start_new_session=True,
            )
    except OSError:
        return f"no program to show folders was found; it is {folder}"
    return ""
