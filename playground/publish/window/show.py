"""Show what the window has to others: what is chosen, the job at work, and its result.

Everything is drawn in another process from the sketch as it is now, so that the window goes on; one job at a
time. What the window shows is what is written: its values, camera and time, a look or a map in place of the
sketch's own view, muted passes and exaggeration.
"""

from __future__ import annotations

import math
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

from playground.data.grid import fitted
from playground.engine.engine import Engine
from playground.engine.plan import Plan, view_height, view_input
from playground.errors import DataError, ParameterError, PlaygroundError
from playground.publish.capture_job import (
    FILM,
    MESH,
    MOVING,
    NUMBERED,
    PAGE,
    PICTURE,
    SHEET,
    TURNTABLE,
    CaptureJob,
    Finished,
    JobProcess,
)
from playground.publish.deep_picture import check_deep
from playground.publish.export_formats import DEFAULT_GRID, MESHES, ExportOptions
from playground.publish.large import check_large, count_parts, is_large, max_side
from playground.publish.series import SWEEP_SIZE
from playground.publish.video import QUALITY, check_video, missing_encoder
from playground.sketch.edit_passes import without_muted
from playground.sketch.model import MAX_PICTURE_SIDE, MAX_SIDE, Camera, Draw, Sketch
from playground.sketch.traits import is_animated, traits_of
from playground.studio.compare.compare import as_before
from playground.studio.cost.costs import PassCosts
from playground.studio.land.looks import look_title
from playground.studio.language import language, numeral, tr
from playground.studio.notices import Notices
from playground.studio.picture.view import field_for
from playground.studio.session import Session

SCREENS = {"4K": (3840, 2160), "8K": (7680, 4320)}
"""Sizes in pixels that have names."""
FORMS: dict[str, tuple[str, ...]] = {
    PICTURE: ("png", "png16", "exr"),
    TURNTABLE: ("mp4", "webm", "gif", "frames"),
    FILM: ("mp4", "webm", "gif", "frames"),
    SHEET: ("png",),
    PAGE: ("html",),
    MESH: ("glb", "stl"),
}
"""Kind → its formats, the usual first."""
_ENDINGS = {"png16": ".png", "frames": NUMBERED}


def kind_title(kind: str) -> str:
    """Return what a kind is called."""
    titles = {
        PICTURE: tr("Still picture"),
        TURNTABLE: tr("Turntable"),
        FILM: tr("Film"),
        SHEET: tr("Sheet of a sweep"),
        PAGE: tr("Web page"),
        MESH: tr("Mesh"),
    }
    return titles[kind]


def form_title(form: str) -> str:
    """Return what a format is called."""
    titles = {
        "png": tr("PNG, 8 bits"),
        "png16": tr("PNG, 16 bits"),
        "exr": tr("EXR, linear light in floats"),
        "mp4": tr("MP4 (H.264)"),
        "webm": tr("WebM (VP9)"),
        "gif": tr("GIF (256 colours)"),
        "frames": tr("numbered PNG files"),
        "html": "HTML",
        "glb": tr("glTF (.glb) with its colours"),
        "stl": tr("STL, the shape alone"),
    }
    return titles[form]


@dataclass
class ShowSettings:
    """What is chosen and typed in the dialog."""

    kind: str = PICTURE
    forms: dict[str, str] = field(default_factory=lambda: {kind: forms[0] for kind, forms in FORMS.items()})
    size: str = "1"  # times the picture of the window, or "2"; of SCREENS; "typed"
    typed: tuple[int, int] = (1920, 1080)
    seconds: float = 0.0  # of a film; 0: to the last keyframe, or ten
    around: float = 10.0  # [s] of a turntable
    start: float = 0.0
    fps: int = 30
    quality: str = QUALITY
    sweeps: list[str] = field(default_factory=lambda: ["", ""])
    exaggerated: bool = False  # a mesh is as high as the window shows it
    light: bool = False  # is baked into a mesh's colours

    @property
    def form(self) -> str:
        """The format of the kind that is chosen."""
        return self.forms[self.kind]


@dataclass(frozen=True)
class Seen:
    """Sees a sketch as the window does: pickled with a job, and called in its process."""

    factor: float  # of the exaggeration
    turned: float  # [degrees] that the window's turntable has gone
    framed_for: tuple[int, int]  # [pixels] the image whose sides stay visible in a narrower one
    size: tuple[int, int]  # [pixels]

    def __call__(self, camera: Camera) -> Camera:
        """Return the camera that stands for a sketch's."""
        if camera.target is not None:
            x, y, z = camera.target
            camera = replace(camera, target=(x, y, z * self.factor))
        if self.turned:
            camera = replace(camera, azimuth=(camera.azimuth + self.turned) % 360.0)
        opened = field_for(camera.field_of_view, self.framed_for, self.size)
        return replace(camera, field_of_view=opened)


@dataclass(frozen=True)
class Prospect:
    """What is going to be written, before it is."""

    sentence: str = ""  # the kind, pixels, frames, length, format
    path: Path | None = None
    cost: str = ""  # how long and how large, about
    notes: tuple[str, ...] = ()  # what of the window is in it, or cannot be
    error: str = ""  # why nothing can be written
    is_still: bool = False  # it is that nothing moves in a film


_EVERY = 0.5  # [s] after which a prospect is worked out again, should something have changed


@dataclass
class Show:
    """What one session shows to others, each made in another process."""

    session: Session
    notices: Notices
    folder: Path  # where it goes
    settle: Callable[[], bool]  # has what is painted written, which the other process reads; whether it is
    settings: ShowSettings = field(default_factory=ShowSettings)
    shown: bool = False  # the dialog is open
    has_keys: bool = False  # the dialog has the keyboard
    working: JobProcess | None = None
    made: Path | None = None  # the file or folder that was written last
    result: str = ""  # a sentence on it
    failed: str = ""  # why the last one was not made
    costs: PassCosts = field(default_factory=PassCosts)  # of full pictures
    _of: Path | None = None  # the sketch that they are of
    _record: object = None  # of the picture whose costs were taken last
    _prospect: tuple[object, float, Prospect] = (None, -math.inf, Prospect())

    def toggle(self) -> None:
        """Show the dialog, or no longer; a job goes on."""
        self.shown = not self.shown
        self.failed = ""

    # ── what can be ──────────────────────────────────────────────────────────

    def refusal(self, kind: str) -> str:
        """Return why there can be nothing of a kind; "" where there can."""
        session = self.session
        if session.sketch is None or session.plan is None:
            return tr("no picture is drawn yet")
        if kind == TURNTABLE and not session.orbits:
            return tr("no camera can go around this picture: it has no terrain")
        if kind == MESH and not view_height(session.plan):
            return tr("this sketch has no terrain that could be a mesh")
        return ""

    def form_refusal(self, kind: str, form: str) -> str:
        """Return why a kind cannot be in a format; "" where it can."""
        if kind in MOVING and form != "frames":
            return missing_encoder()
        if kind == PICTURE and form != "png" and self.session.sketch is not None:
            try:
                check_deep(self.session.engine, self.session.sketch, self.size())
            except PlaygroundError as error:
                return str(error)
        return ""

    @property
    def light_refusal(self) -> str:
        """Why no light can be baked into a mesh's colours; "" where it can."""
        plan = self.session.plan
        if self.settings.form != "glb":
            return tr("this format has no colours")
        return (
            ""
            if plan is not None and view_input(plan, "light")
            else tr("this sketch has no light of its own")
        )

    def choose_form(self, form: str) -> None:
        """Choose a format of the kind that is chosen, with a rate that it can have."""
        self.settings.forms[self.settings.kind] = form
        if form == "gif" and 100 % self.settings.fps:
            self.settings.fps = 25  # a picture of a GIF is shown for whole hundredths of a second

    @property
    def is_still(self) -> bool:
        """Whether a film is chosen of a sketch in which nothing moves."""
        if self.settings.kind != FILM or self.session.sketch is None:
            return False
        if not is_animated(self.session.sketch) and not traits_of(self.session.sketch).devices:
            return True
        try:
            return bool(self.job(checks=False).series().still)
        except PlaygroundError:
            return False

    def size(self) -> tuple[int, int]:
        """Return the size in pixels that is chosen; raise ``ParameterError``."""
        settings, picture = self.settings, self.session.picture.texture
        width, height = picture.size if picture is not None else (0, 0)
        if settings.kind == SHEET and settings.size != "typed":
            scale = SWEEP_SIZE[0] * (2 if settings.size == "2" else 1) / max(width, 1)
            return max(round(width * scale), 1), max(round(height * scale), 1)
        times = 2 if settings.size == "2" else 1
        size = SCREENS.get(settings.size, (width * times, height * times))
        size = settings.typed if settings.size == "typed" else size
        if settings.kind in MOVING and settings.form in ("mp4", "webm"):
            size = size[0] + size[0] % 2, size[1] + size[1] % 2
        still = settings.kind == PICTURE or settings.form == "frames"
        most = MAX_PICTURE_SIDE if still else MAX_SIDE
        if not all(1 <= side <= most for side in size):
            raise ParameterError(
                tr("{wide} × {high} pixels: 1 to {most} a side", wide=size[0], high=size[1], most=most)
            )
        return size

    def _picture_of(self, sketch: Sketch) -> Sketch:
        """Return a sketch with the view that is shown: its own, a map or a look."""
        view = self.session.view
        seen = view.map or view.look
        return seen.of(sketch) if seen is not None else sketch

    def job(self, *, checks: bool = True) -> CaptureJob:
        """Return what is chosen as a job; raise ``PlaygroundError`` for what cannot be.

        Without ``checks`` no format is refused.
        """
        settings, session = self.settings, self.session
        reason = self.refusal(settings.kind)
        if checks and not reason:
            reason = self.form_refusal(settings.kind, settings.form)
        if reason or session.sketch is None:
            raise DataError(reason)
        moves, size = settings.kind in MOVING, self.size()
        sketch = without_muted(session.sketch, session.view.muted)
        sketch = sketch if settings.kind == MESH else self._picture_of(sketch)
        job = CaptureJob(
            kind=settings.kind,
            sketch=sketch,
            folder=self.folder,
            ending=_ENDINGS.get(settings.form, f".{settings.form}"),
            size=size,
            time=settings.start if settings.kind == FILM else session.clock.time,
            steps=session.view.stops(session.sketch, session.clock.time),
            seconds=self._seconds(session.sketch) if moves else None,
            fps=Fraction(max(settings.fps, 1)),
            quality=settings.quality,
            sweeps=tuple(filter(None, (s.strip() for s in settings.sweeps))),
            is_deep=settings.kind == PICTURE and settings.form != "png",
            exaggeration=None if settings.kind in (PAGE, MESH) else session.engine.runner.exaggeration,
            seen=self._seen(sketch, size),
            options=self._options(),
        )
        if checks:
            _check(session.engine, job, settings.form)
        return job

    def _seen(self, sketch: Sketch, size: tuple[int, int]) -> Seen | None:
        """Return the camera of the window; None where it is the sketch's own."""
        view, settings = self.session.view, self.settings
        if settings.kind in (PAGE, MESH, SHEET) or not traits_of(sketch).camera:
            return None
        seen = Seen(self.session.exaggeration, view.turned, view.framed_for, size)
        cameras = (sketch.camera, *(sketch.at(frame.time).camera for frame in sketch.keyframes))
        return None if all(seen(camera) == camera for camera in cameras) else seen

    def _options(self) -> ExportOptions:
        settings = self.settings
        if settings.kind == PAGE:
            return ExportOptions(language=language())
        if settings.kind != MESH:
            return ExportOptions()
        factor = self.session.exaggeration if settings.exaggerated else 1.0
        return ExportOptions(
            light=settings.light and not self.light_refusal, exaggeration=0.0 if factor == 1.0 else factor
        )

    def _seconds(self, sketch: Sketch) -> float:
        """Return how long a film or a turntable is [s]."""
        settings = self.settings
        if settings.kind == TURNTABLE:
            return settings.around
        left = sketch.duration - settings.start
        return settings.seconds if settings.seconds > 0.0 else left if left > 0.0 else 10.0

    # ── what would be ────────────────────────────────────────────────────────

    @property
    def prospect(self) -> Prospect:
        """What would be written now."""
        session, texture = self.session, self.session.picture.texture
        key = (
            repr(self.settings),
            session.drafts.revision,
            session.view.revision,
            texture.size if texture is not None else None,
            language(),
        )
        before, since, prospect = self._prospect
        if key != before or time.monotonic() - since > _EVERY:
            prospect = self._foreseen()
            self._prospect = key, time.monotonic(), prospect
        return prospect

    def _foreseen(self) -> Prospect:
        if self.is_still:
            error = tr("Nothing in this sketch depends on the time: all frames of a film would be the same.")
            return Prospect(error=error, is_still=True)
        try:
            job = self.job()
            return Prospect(
                sentence=self._sentence(job),
                path=job.free_name,
                cost=", ".join(filter(None, (self._time_of(job), self._bytes_of(job)))),
                notes=tuple(self._notes(job)),
            )
        except PlaygroundError as error:
            return Prospect(error=str(error))

    def _sentence(self, job: CaptureJob) -> str:
        form, (wide, high) = form_title(self.settings.form), job.size
        if job.kind == PICTURE:
            return tr("A picture of {wide} × {high} pixels: {form}", wide=wide, high=high, form=form)
        if job.kind == PAGE:
            return tr("A web page in which the sketch runs: one file, HTML")
        if job.kind == MESH:
            across, down = self._grid(job)
            return tr("A mesh of {across} × {down} vertices: {form}", across=across, down=down, form=form)
        series = job.series()
        if job.kind == SHEET:
            return tr(
                "A sheet of {count} pictures, {wide} × {high} pixels each: {form}",
                count=series.count,
                wide=wide,
                high=high,
                form=form,
            )
        values = {
            "count": series.count,
            "wide": wide,
            "high": high,
            "seconds": numeral(float(series.count / series.fps), ".4g"),
            "fps": numeral(float(job.fps)),
            "form": form,
        }
        if job.kind == TURNTABLE:
            return tr(
                "A turntable of {count} frames, {wide} × {high} pixels, {seconds} s at {fps} fps: {form}",
                **values,
            )
        return tr(
            "A film of {count} frames, {wide} × {high} pixels, {seconds} s at {fps} fps: {form}", **values
        )

    def _grid(self, job: CaptureJob) -> tuple[int, int]:
        """Return the vertices of a mesh along its sides."""
        plan = self._plan(job)
        assert plan.terrain.size is not None  # a plan's terrain is known
        return fitted(plan.terrain.size, min(DEFAULT_GRID, MESHES[job.ending]))

    def _notes(self, job: CaptureJob) -> Iterator[str]:
        session, factor = self.session, self.session.exaggeration
        if job.kind == PICTURE and not job.is_deep and is_large(session.engine, job.sketch, job.size):
            count = count_parts(job.sketch, job.size)
            yield tr("It is drawn in {count} parts, which meet without a seam.", count=count)
        if job.kind in (PICTURE, TURNTABLE) and is_animated(job.sketch):
            yield tr("The time stands at {time} s.", time=numeral(job.time, ".2f"))
        if factor != 1.0 and job.kind == PAGE:
            yield tr(
                "A page has no exaggeration: heights are true in it, not ×{factor}.", factor=numeral(factor)
            )
        elif factor != 1.0 and job.kind == MESH and not job.options.exaggeration:
            yield tr("Heights are true metres, not ×{factor} as shown.", factor=numeral(factor))
        elif factor != 1.0:
            yield tr("Heights are ×{factor}, as shown.", factor=numeral(factor))
        view = session.view
        if job.kind == MESH:
            return
        if job.steps and not view.interpolated and job.kind != PAGE:
            yield tr("What stopped repeats have not reached is filled in, which it is not in the window.")
        if view.map is not None:
            yield tr("It shows the map of {name}, as the window does.", name=view.map.ref)
        elif view.look is not None:
            yield tr("The look is {name}, as in the window.", name=look_title(view.look.name))

    # ── how long, how large ──────────────────────────────────────────────────

    def follow(self) -> None:
        """Take what the passes of the last picture took, where they were timed and it was drawn in full."""
        session = self.session
        record, sketch = session.engine.record, session.sketch
        if session.path != self._of:
            self._of = session.path  # passes of another sketch may have the same paths
            self.costs.clear()
        if record is self._record or record.plan is None or sketch is None:
            return
        self._record = record
        if record.times and record.plan.sketch.picture.samples == sketch.picture.samples:
            self.costs.take(_texels(record.plan), record.times)

    def measure(self) -> None:
        """Time the passes that the camera moves, where a graphics card tells no other way what they take."""
        engine, plan, sketch = self.session.engine, self.session.plan, self.session.sketch
        if engine.info.software or plan is None or sketch is None or not self.session.orbits:
            return
        camera = plan.sketch.camera
        moved = plan.sketch.with_camera(replace(camera, azimuth=camera.azimuth + 0.01))
        with suppress(PlaygroundError), as_before(engine, plan):
            engine.options.profiling = True
            engine.draw(moved, size=plan.frame_size, time=plan.time, steps=plan.steps)
            assert engine.record.plan is not None  # it was drawn
            self.costs.take(_texels(engine.record.plan), engine.record.times)

    def _plan(self, job: CaptureJob, number: int = 0) -> Plan:
        """Return the plan of a job's first picture, or of another of its series."""
        engine, at = self.session.engine, {"time": job.time, "steps": job.steps}
        if job.kind in (PAGE, MESH):
            return engine.plan(job.sketch, (1280, 720), **at)  # type: ignore[arg-type]
        sketch, size = _drawn(engine, job, number)
        return engine.plan(sketch, size["size"], size["time"], size["steps"], largest=MAX_PICTURE_SIDE)

    def expected_seconds(self, job: CaptureJob) -> float | None:
        """Return how long a job is expected to take [s], by what passes took; None where nobody knows.

        Passes that did not run since the window was opened are not counted on a graphics card.
        """
        engine = self.session.engine
        plan = self._plan(job)
        first = self._cost(plan, set(_texels(plan)))
        if first is None:
            return None
        seconds = _START + first + sum(engine.runner.compile_times.values()) / 1e3
        if job.kind in (PAGE, MESH):
            return seconds
        pixels, count = job.size[0] * job.size[1], 1
        if job.kind != PICTURE:
            series = job.series()
            count = series.count
            sketch, at = _drawn(engine, job, min(1, count - 1))
            each = self._cost(plan, set(engine.stale(sketch, **at)))
            if each is None:
                return None
            seconds += each * (count - 1)
        return seconds + _ENCODING[self.settings.form] * pixels * count

    def _cost(self, plan: Plan, paths: set[str]) -> float | None:
        """Return what passes of a plan are expected to take [s]; None for a draw that was never timed."""
        total = 0.0
        for step in plan.walk():
            if step.path not in paths or not step.repeat:
                continue
            spent = self.costs.expected(step.path, max(step.size[0] * step.size[1], 1))
            if spent is None and isinstance(step.kernel, Draw) and self.session.engine.info.software:
                return None
            total += spent or 0.0
        return total / 1e3

    def _time_of(self, job: CaptureJob) -> str:
        try:
            seconds = self.expected_seconds(job)
        except PlaygroundError:  # it is said when it is drawn
            seconds = None
        return duration_text(seconds) if seconds is not None else tr("how long is not known yet")

    def _bytes_of(self, job: CaptureJob) -> str:
        """Return how large the file is at most, where that can be known."""
        pixels = job.size[0] * job.size[1]
        if job.kind == PICTURE:
            return tr(
                "at most {size}", size=size_text(pixels * {"png": 4, "png16": 8, "exr": 16}[_form(job)])
            )
        if job.kind == MESH and job.ending == ".stl":
            across, down = self._grid(job)
            return size_text(84 + 50 * 2 * (across - 1) * (down - 1))
        return ""

    # ── at work ──────────────────────────────────────────────────────────────

    def start(self) -> None:
        """Begin what is chosen; what cannot be done becomes a notice."""
        if self.working is not None:
            return
        self.failed = self.result = ""
        try:
            if self.is_still:
                raise DataError(self.prospect.error)
            if not self.settle():
                raise DataError(tr("no capture was made, for what was painted last could not be written"))
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
        working, self.working = self.working, None
        for note in finished.notes:
            self.notices.say(note)
        if finished.path is None and not finished.stopped:
            self.failed = finished.error
            self.notices.say(finished.error)
            return
        self.made = finished.path or self.made
        self.result = _result(working, finished)
        self.notices.say(self.result)

    def close(self) -> None:
        """Stop the job that is at work."""
        if self.working is not None:
            self.working.close()
            self.working = None


_START = 2.0  # [s] that a process takes to begin, with a context of its own
_ENCODING = {
    "png": 3e-7,
    "png16": 6e-7,
    "exr": 9e-7,
    "mp4": 5e-8,
    "webm": 1.3e-7,
    "gif": 2e-7,
    "frames": 3e-7,
}
"""[s] a pixel that a format takes, about: on two slow cores."""


def _drawn(engine: Engine, job: CaptureJob, number: int) -> tuple[Sketch, dict[str, Any]]:
    """Return the sketch of one picture of a job, and its size, time and steps as they are drawn."""
    if job.kind == PICTURE:
        sketch, at = job.sketch, {"size": job.size, "time": job.time, "steps": job.steps}
    else:
        picture = job.series().picture(engine, number)
        sketch, at = picture.sketch, dict(picture.at)
    times = sketch.picture.supersample
    return sketch, at | {"size": (at["size"][0] * times, at["size"][1] * times)}  # type: ignore[index]


def _check(engine: Engine, job: CaptureJob, form: str) -> None:
    """Raise ``PlaygroundError`` for what no job could write."""
    if job.kind == SHEET and not job.sweeps:
        raise ParameterError(tr("choose a parameter to sweep, or write one, as light.gain=0.5..3"))
    if job.kind == SHEET and job.steps:
        raise ParameterError(tr("a sheet runs every repeat to its end; set the steps back to all"))
    if job.kind in (*MOVING, SHEET):
        job.series()
    if job.kind in MOVING and form != "frames":
        check_video(job.folder / f"film{job.ending}", job.size, job.fps, job.quality)
        most = max_side(engine) // job.sketch.picture.supersample
        if max(job.size) > most:
            wide, high = job.size
            raise DataError(
                tr(
                    "a film of {wide} × {high} pixels: a texture here has {most} a side at most",
                    wide=wide,
                    high=high,
                    most=most,
                )
            )
    elif job.kind == PICTURE and not job.is_deep and is_large(engine, job.sketch, job.size):
        check_large(engine, job.sketch, job.size)


def _form(job: CaptureJob) -> str:
    return "png" if not job.is_deep else "exr" if job.ending == ".exr" else "png16"


def _texels(plan: Plan) -> dict[str, int]:
    return {step.path: step.size[0] * step.size[1] for step in plan.walk()}


def _result(working: JobProcess, finished: Finished) -> str:
    """Return a sentence on what a job has written."""
    job, took = working.job, numeral(time.monotonic() - working.started, ".1f")
    if finished.path is None:
        return tr("stopped; nothing was kept")
    name = finished.path.absolute()
    if finished.stopped:
        return tr("stopped; the first {count} frames are kept: {path}", count=finished.count, path=name)
    if job.kind in (PAGE, MESH):
        return tr("saved {path} in {seconds} s", path=name, seconds=took)
    wide, high = job.size
    return tr(
        "saved {path}, {wide} × {high} pixels, in {seconds} s", path=name, wide=wide, high=high, seconds=took
    )


def duration_text(seconds: float) -> str:
    """Return about how long something takes: "about 8 s", "about 12 min"."""
    if seconds < 90:
        return tr("about {seconds} s", seconds=max(round(seconds), 1))
    if seconds < 5400:
        return tr("about {minutes} min", minutes=round(seconds / 60))
    return tr("about {hours} h", hours=numeral(seconds / 3600, ".1f"))


def size_text(size: int) -> str:
    """Return bytes as a person reads them."""
    if size < 1e6:
        return tr("{size} kB", size=max(round(size / 1e3), 1))
    return tr("{size} MB", size=f"{size / 1e6:.{1 if size < 1e7 else 0}f}")


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
        return tr("no program to show folders was found; it is {folder}", folder=folder)
    return ""
