"""From sketches to the pictures they promise, and from pictures to what came of them.

``shots_of`` lists the cases, ``take`` draws one, ``check`` compares it with its reference,
``save_pictures`` puts what there is to look at into a folder. No pytest, no options: a
command or a report calls the same four.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from playground.engine.engine import Engine
from playground.engine.frame import Frame
from playground.errors import ContextError, DataError
from playground.gpu.context import ContextInfo
from playground.images.files import write_png
from playground.shots.compare import TOLERANCE, Comparison, compare, difference_picture
from playground.shots.references import Reference, accepted, drawn_by, read_reference, reference_path
from playground.sketch.load import load
from playground.sketch.model import Shot, Sketch


@dataclass(frozen=True)
class ShotCase:
    """One picture to take."""

    sketch: Sketch
    shot: Shot

    def __str__(self) -> str:
        return f"{self.sketch.name}/{self.shot.name}"


@dataclass(frozen=True, eq=False)
class Outcome:
    """What came of one shot."""

    case: ShotCase
    frame: Frame
    comparison: Comparison  # with the reference that is nearest
    path: Path  # of that reference, or where it would be
    renderer: ContextInfo  # that drew the frame
    reference: Reference | None = None  # None: missing

    @property
    def ok(self) -> bool:
        """Whether the picture is one of those expected."""
        return self.comparison.ok

    @property
    def other_build(self) -> str:
        """Say who drew the reference, if that was another build of the renderer; else ""."""
        before = self.reference.drawn_by if self.reference else ""
        return before if before != drawn_by(self.renderer) else ""


def shots_of(sketches: Iterable[Sketch | str | Path]) -> list[ShotCase]:
    """List the shots of sketches, given loaded, by path, or by the name of a shipped one.

    Raises ``SketchError`` or ``ShaderError`` for what cannot be loaded.
    """
    loaded = [given if isinstance(given, Sketch) else load(given) for given in sketches]
    return [ShotCase(sketch, shot) for sketch in loaded for shot in sketch.shots]


def take(engine: Engine, case: ShotCase) -> Frame:
    """Draw one shot: its size, time, camera, preset, values, steps and samples.

    Raises ``PlaygroundError`` for a mistake in the sketch, ``ContextError`` where drawing
    left an OpenGL error behind: whatever the picture looks like, it is not to be trusted.
    """
    shot = case.shot
    frame = engine.render(case.sketch.for_shot(shot), size=shot.size, time=shot.time, steps=dict(shot.steps))
    error = engine.ctx.error
    if error != "GL_NO_ERROR":
        raise ContextError(f"drawing {case} left the OpenGL error {error}")
    return frame


def check(case: ShotCase, frame: Frame, renderer: ContextInfo, tolerance: int = TOLERANCE) -> Outcome:
    """Compare a frame with the references of its renderer; any may match, else the nearest is told.

    Raises ``DataError`` where a reference cannot be read.
    """
    files = accepted(case.sketch, case.shot.name, renderer.slug)
    if not files:
        path = reference_path(case.sketch, case.shot.name, renderer.slug)
        return Outcome(case, frame, compare(frame.array, None, tolerance), path, renderer)
    outcomes: list[Outcome] = []
    for file in files:
        reference = read_reference(file)
        comparison = compare(frame.array, reference.pixels, tolerance)
        outcomes.append(Outcome(case, frame, comparison, file, renderer, reference))
    return min(outcomes, key=_distance)


def _distance(outcome: Outcome) -> tuple[bool, bool, int, int]:
    found = outcome.comparison
    return not found.ok, found.verdict == "size", found.over, found.most


def save_pictures(outcome: Outcome, folder: Path) -> dict[str, Path]:
    """Write the actual picture, and the expected one and the difference ×16 if there is a reference.

    Returns the files by those three words: ``folder/<sketch>/<shot>.actual.png`` and so on.
    Raises ``DataError`` where the folder cannot be written to.
    """
    pictures = {"actual": outcome.frame.array}
    if outcome.reference is not None:
        pictures["expected"] = outcome.reference.pixels
        pictures["difference"] = difference_picture(outcome.frame.array, outcome.reference.pixels)
    place = folder / outcome.case.sketch.name
    try:
        place.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise DataError(f"no folder can be made: {error.strerror}", file=place) from error
    files = {word: place / f"{outcome.case.shot.name}.{word}.png" for word in pictures}
    for word, file in files.items():
        write_png(file, pictures[word])
    return files
