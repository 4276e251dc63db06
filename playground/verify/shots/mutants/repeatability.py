"""Draw an unbroken shot again under conditions that must not matter, and count what a comparison refuses.

Some conditions are of a whole process: its environment, the folder that it runs in, where the sketch
lies. Others are of one drawing: the driver, how much the engine may cache, what it drew
before. The choice is seeded: the same number of drawings is the same drawings.
"""

from __future__ import annotations

import locale
import random
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory

import numpy as np

from playground.allowed_files import is_absolute, is_file
from playground.engine.context import ContextInfo, open_context
from playground.engine.engine import Engine
from playground.engine.plain_forms import silent
from playground.engine.process.pool import Pool
from playground.engine.process.worker import Parent, Service
from playground.engine.renderer import CACHE_BYTES
from playground.paths import GLSL, SKETCHES
from playground.shader.source import read_text
from playground.sketch.assign import values_of
from playground.sketch.load import load
from playground.sketch.model import Shot, Sketch, kernels_of
from playground.sketch.replace_technique import with_texts
from playground.sketch.variants import any_variants
from playground.verify.shots.mutants.rendering import DoesNotApply, broken, rendering_mutants
from playground.verify.shots.mutants.suite import judged
from playground.verify.shots.suite import RenderedShot, ShotCase, render_shot

# ── conditions ───────────────────────────────────────────────────────────────


_SEED = 1841
_A_PROCESS = 8  # drawings, at most

_THREADS = ("", "0", "1", "2", "4")  # of llvmpipe; "": as many as it likes
_ENVIRONMENTS = (
    (),
    (("MESA_GL_VERSION_OVERRIDE", "4.1"),),
    (("MESA_SHADER_CACHE_DISABLE", "true"),),
    (("LC_ALL", "C"),),
    (("LC_ALL", "de_DE.UTF-8"),),  # a comma in place of the decimal point
    (("LC_ALL", "tr_TR.UTF-8"),),  # i and I are no pair
    (("PYTHONHASHSEED", "1"),),
    (("TZ", "Pacific/Chatham"),),
)
_BEFORE = ("", "", "the same", "another shot", "all shots", "a smaller picture", "another camera", "a mutant")


@dataclass(frozen=True, slots=True)
class Drawing:
    """How the shot is drawn once."""

    driver: str = "auto"
    fresh: bool = False  # by a new engine; else by the one of the drawing before
    cache_bytes: int = 0  # of the new engine's cache; 0: as usual
    before: str = ""  # what is drawn before it by the same engine
    commented: bool = False  # comments and blank lines are put into its shaders

    @property
    def words(self) -> str:
        """What is unusual about it."""
        return _listed(
            f"driver {self.driver}" if self.driver != "auto" else "",
            "new engine" if self.fresh else "",
            f"caches {self.cache_bytes // 2**20} MiB" if self.cache_bytes else "",
            f"after {self.before}" if self.before else "",
            "comments edited" if self.commented else "",
        )


@dataclass(frozen=True, slots=True)
class Process:
    """Drawings that one process does, one after the other."""

    drawings: tuple[Drawing, ...]
    environment: tuple[tuple[str, str], ...] = ()
    elsewhere: bool = False  # it runs in another folder
    moved: bool = False  # the sketch lies in another folder
    cold: bool = False  # the driver's shader cache is empty

    @property
    def all_forms(self) -> bool:
        """Whether it may have compute shaders, where there are any."""
        return "MESA_GL_VERSION_OVERRIDE" not in dict(self.environment)

    @property
    def words(self) -> str:
        """What is unusual about it."""
        return _listed(
            *(f"{name}={value}" for name, value in self.environment),
            "in another folder" if self.elsewhere else "",
            "sketch moved" if self.moved else "",
            "cold shader cache" if self.cold else "",
        )


def _listed(*conditions: str) -> str:
    return ", ".join(filter(None, conditions)) or "as usual"


def processes(count: int, drivers: tuple[str, ...]) -> list[Process]:
    """Choose so many drawings, by these drivers, and distribute them among processes."""
    randomness = random.Random(_SEED)
    result: list[Process] = []
    left = count
    while left > 0:
        number = len(result)  # environments alternate, so that a few processes have most of them
        threads = _THREADS[number % len(_THREADS)]
        environment = _ENVIRONMENTS[number % len(_ENVIRONMENTS)]
        if threads:
            environment = (*environment, ("LP_NUM_THREADS", threads))
        drawings = [_drawing(randomness, drivers) for _ in range(min(left, _A_PROCESS))]
        moved, elsewhere, cold = (randomness.random() < part for part in (0.3, 0.5, 0.2))
        result.append(Process(tuple(drawings), environment, elsewhere, moved, cold))
        left -= len(drawings)
    return result


def _drawing(randomness: random.Random, drivers: tuple[str, ...]) -> Drawing:
    return Drawing(
        randomness.choice(drivers),
        randomness.random() < 0.4,
        randomness.choice((0, 0, 1, 16)) * 2**20,
        randomness.choice(_BEFORE),
        randomness.random() < 0.25,
    )


# ── drawing again ────────────────────────────────────────────────────────────


LIMIT = 600.0
"""[s] A drawing may take that long, on a slow machine with a cold shader cache."""


@dataclass(frozen=True)
class Redrawn:
    """What came of drawing the shot once more."""

    process: Process
    drawing: Drawing
    refused: str  # what the same build's comparison says against it; "": nothing
    identical: bool  # to the last bit

    @property
    def words(self) -> str:
        """How it was drawn."""
        return f"process: {self.process.words}; drawing: {self.drawing.words}"


def redraw(
    sketch: Sketch,
    shot: Shot,
    expected: RenderedShot,
    renderer: ContextInfo,
    count: int,
    *,
    software: bool = False,
    device: int | None = None,
    limit: float = LIMIT,
) -> Iterator[Redrawn]:
    """Yield what came of each of ``count`` drawings of a shot, that should be the expected picture.

    A process that dies, or takes longer than ``limit`` seconds over a drawing, counts as refused drawings.
    """
    for process in processes(count, _drivers(sketch, renderer)):
        images = _images_of(process, sketch, Subject(sketch.file, shot, software, device), limit)
        for number, drawing in enumerate(process.drawings):
            image = images[min(number, len(images) - 1)]  # after an error there is nothing more
            if isinstance(image, str):
                yield Redrawn(process, drawing, image, False)
                continue
            judgement = judged(image, expected, renderer)[0]
            refused = "" if judgement.ok else judgement.message
            # The form of a kernel is part of what is drawn, and other drivers take other forms.
            same_forms = process.all_forms and drawing.driver == "auto"
            if not refused and same_forms and image.drawn != expected.drawn:
                refused = "the picture passes, but the hash of what was drawn has changed"
            yield Redrawn(process, drawing, refused, bool(np.array_equal(image.array, expected.array)))


def _drivers(sketch: Sketch, renderer: ContextInfo) -> tuple[str, ...]:
    """Return the drivers whose pictures must be the same.

    Hardware renderers may round differently in the two; a fast variant may
    differ from the canonical form within the bound that it states.
    """
    if not renderer.software or any_variants(sketch.graph):
        return ("auto",)
    return ("auto", "fragment", "compute") if renderer.compute else ("auto", "fragment")


def _images_of(process: Process, sketch: Sketch, subject: Subject, limit: float) -> list[RenderedShot | str]:
    """Return the image of each drawing, the last an error's text where one fails."""
    frames: list[RenderedShot | str] = []
    with TemporaryDirectory(ignore_cleanup_errors=True) as name:
        folder = Path(name)
        if process.moved:
            subject = replace(subject, sketch=_moved(sketch, folder / "moved"))
        environment = dict(process.environment)
        if process.cold:
            environment["MESA_SHADER_CACHE_DIR"] = str(folder / "cache")
        pool = Pool(
            __name__,
            options=subject,
            environment=environment,
            folder=folder if process.elsewhere else None,
        )
        with pool:
            for drawing in process.drawings:
                outcome = pool.run(drawing, seconds=limit)
                if outcome.kind != "answer":
                    frames.append(str(outcome.failure("the drawing")))
                    break
                assert isinstance(outcome.value, RenderedShot)
                frames.append(outcome.value)
    return frames


def _moved(sketch: Sketch, folder: Path) -> str:
    """Copy a sketch, with its own texts and data files, into a folder; return the copy's file.

    A technique of the library that is opened alone stays where it is.
    """
    file, home = Path(sketch.file), Path(sketch.folder)
    if file.is_relative_to(GLSL) and not file.is_relative_to(SKETCHES):
        return sketch.file
    values = values_of(sketch)
    own = {path for path in map(Path, sketch.files) if path.is_relative_to(home)}
    for position, kernel in kernels_of(sketch.graph):
        for parameter in kernel.parameters:
            text = str(values[f"{position}.{parameter.name}"])
            if parameter.widget.kind == "file" and text and not is_absolute(text) and is_file(home / text):
                own.add(home / text)
    target = folder / home.name  # a folder may give the sketch its name
    for path in own:
        copy = target / path.relative_to(home)
        copy.parent.mkdir(parents=True, exist_ok=True)
        copyfile(path, copy)
    return str(target / file.relative_to(home))


# ── in the worker ────────────────────────────────────────────────────────────


_SMALL = (96, 54)


@dataclass(frozen=True)
class Subject:
    """What is drawn, and on what."""

    sketch: str  # path, or the name of a shipped one
    shot: Shot
    software: bool
    device: int | None


def open_service(parent: Parent, subject: Subject) -> Service:
    """Load the sketch; a context is opened for the first drawing."""
    with suppress(locale.Error):  # this machine does not know it
        locale.setlocale(locale.LC_ALL, "")
    return Service(_Redraw(subject).draw)


class _Redraw:
    """Draws, with an engine that lasts until a drawing requires a new one."""

    def __init__(self, subject: Subject) -> None:
        self.subject = subject
        self.sketch = load(subject.sketch)
        self.engine: Engine | None = None
        self.driver = ""

    def draw(self, drawing: Drawing) -> RenderedShot:
        if self.engine is None or drawing.fresh or drawing.driver != self.driver:
            if self.engine is not None:
                self.engine.release()
            context = open_context(software=self.subject.software, device=self.subject.device)
            no_compute = drawing.driver == "compute" and context.version_code < 430
            self.engine = Engine(
                context,
                driver="auto" if no_compute else drawing.driver,
                cache_bytes=drawing.cache_bytes or CACHE_BYTES,
                owns_context=True,
                notice=silent,
            )
            self.driver = drawing.driver
        for sketch, shot in self._before(drawing.before):
            self.engine.render(sketch, size=shot.size, time=shot.time, steps=dict(shot.steps))
        sketch = commented(self.sketch) if drawing.commented else self.sketch
        return render_shot(self.engine, ShotCase(sketch, self.subject.shot))

    def _before(self, what: str) -> Iterator[tuple[Sketch, Shot]]:
        shot = self.subject.shot
        shown = self.sketch.for_shot(shot)
        others = [other for other in self.sketch.shots if other.name != shot.name]
        if what == "the same":
            yield shown, shot
        elif what == "a smaller picture":
            yield shown, replace(shot, size=_SMALL)
        elif what == "another camera":
            camera = replace(shown.camera, azimuth=shown.camera.azimuth + 30.0)
            yield shown.with_camera(camera), shot
        elif what == "a mutant":
            yield from _first_mutant(shown, shot)
        elif what in ("another shot", "all shots"):
            for other in others[: 1 if what == "another shot" else None]:
                yield self.sketch.for_shot(other), replace(other, size=_SMALL)


def _first_mutant(shown: Sketch, shot: Shot) -> Iterator[tuple[Sketch, Shot]]:
    for mutant in rendering_mutants():
        try:
            yield broken(mutant, shown), shot
        except DoesNotApply:
            continue
        return


def commented(sketch: Sketch) -> Sketch:
    """Return the sketch with comments and blank lines put into all of its shaders."""
    files = {file for spec in sketch.graph.passes for file in spec.technique.files}
    shaders = sorted(file for file in files if not file.endswith(".toml"))
    return with_texts(sketch, {file: _commented(read_text(Path(file))) for file in shaders})


def _commented(text: str) -> str:
    first, newline, rest = text.partition("\n")
    return f"{first}{newline}\n// This line says nothing: 3.0 * (1 + 2)\n{rest}\n/* Nor\n   do these. */\n"
