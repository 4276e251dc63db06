"""Draw one shot again and again in a worker process, each time under other conditions."""

from __future__ import annotations

import locale
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from playground.engine.context import open_context
from playground.engine.engine import Engine
from playground.engine.internals import CACHE_BYTES
from playground.engine.plain_forms import silent
from playground.engine.process.worker import Parent, Service
from playground.shader.source import read_text
from playground.shots.mutants.breaking import broken
from playground.shots.mutants.harmless import Drawing
from playground.shots.mutants.model import DoesNotApply
from playground.shots.mutants.render_mutants import rendering_mutants
from playground.shots.suite import RenderedShot, ShotCase, render_shot
from playground.sketch.load import load
from playground.sketch.model import Shot, Sketch
from playground.sketch.replace_technique import with_texts

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
