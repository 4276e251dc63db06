"""From sketches to the pictures they promise, and from pictures to what came of them.

``shots_of`` lists the cases, ``render_shot`` draws one, ``check`` compares it with its reference,
``images_of`` gives what there is to look at. No pytest, no options: a command or a report
calls the same four.

Shots are rendered in a worker process with an OpenGL context of its own, one after the other. A render that
takes too long is stopped, and a process that dies is replaced; the error says how it ended, with what it
printed. The next shot is rendered all the same.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.engine.context import ContextInfo
from playground.engine.engine import Engine, open_engine
from playground.engine.frame import Frame
from playground.engine.plain_forms import silent
from playground.engine.plan import located_at
from playground.engine.process.pool import OPEN, Limits, Pool, PoolOwner
from playground.engine.process.worker import Parent, Service
from playground.errors import ContextError, DataError
from playground.sketch.load import load
from playground.sketch.model import Shot, Sketch
from playground.sketch.toml_sketch import MASK_ENDING
from playground.verify.shots.compare import (
    Light,
    Mask,
    Rectangle,
    describe_item,
    difference_picture,
    hidden,
    mask_of,
    striped,
)
from playground.verify.shots.first_difference import Difference, Search, first_not_finite, locate
from playground.verify.shots.flip import flip_picture
from playground.verify.shots.judge import (
    Judgement,
    Rule,
    frame_size,
    judge,
    judge_frames,
    repeated,
    strip_of,
    unreadable,
)
from playground.verify.shots.plugin_constants import REFERENCE_RENDERER
from playground.verify.shots.references import (
    Reference,
    accepted,
    fingerprint_of,
    read_reference,
    reference_path,
)

# ── cases, frames, outcomes ──────────────────────────────────────────────────


@dataclass(frozen=True)
class ShotCase:
    """One picture to take."""

    sketch: Sketch
    shot: Shot

    def __str__(self) -> str:
        return f"{self.sketch.name}/{self.shot.name}"


@dataclass(frozen=True, eq=False)
class RenderedShot(Frame):
    """A frame, with what is known of how it was drawn."""

    drawn: str = ""  # hash of what was drawn
    not_finite: str = ""  # the first texture that went into it with a number that is not finite, as text
    first_bad: Difference | None = None  # the line in which that begins
    gl_error: str = ""  # what drawing it left behind
    fonts: str = ""  # the files of the fonts in it
    tone: str = ""  # how its floats were shown
    masks: tuple[Light, ...] = ()  # of the picture's size, or of each frame's
    labels: tuple[str, ...] = ()  # of the frames of a strip, as "at 0.5 s"; none for one picture


@dataclass(frozen=True, eq=False, kw_only=True)
class Outcome(Judgement):
    """What came of one shot: its judgement, and what was judged."""

    case: ShotCase
    frame: Frame
    path: Path  # of the reference that it was judged by, or where that would be
    renderer: ContextInfo  # that drew the frame
    reference: Reference | None = None  # that it was judged by; None: missing or unreadable
    mask: Mask | None = None  # where it was not compared
    masked: tuple[str, ...] = ()  # what that is made of, as text

    @property
    def own_path(self) -> Path:
        """Where its renderer's reference is, or would be: what accepting it writes."""
        return reference_path(self.case.sketch, self.case.shot.name, self.renderer.slug)


def shots_of(sketches: Iterable[Sketch | str | Path]) -> list[ShotCase]:
    """List the shots of sketches, given loaded, by path, or by the name of a shipped one.

    Raises ``SketchError`` or ``ShaderError`` for what cannot be loaded.
    """
    loaded = [
        sketch_or_path if isinstance(sketch_or_path, Sketch) else load(sketch_or_path)
        for sketch_or_path in sketches
    ]
    return [ShotCase(sketch, shot) for sketch in loaded for shot in sketch.shots]


def render_shot(engine: Engine, case: ShotCase) -> RenderedShot:
    """Draw one shot: its size, time, camera, preset, values, steps and samples.

    An OpenGL error left behind is recorded in the frame, which is not to be trusted then.
    Raises ``PlaygroundError`` for a mistake in the sketch, ``OpenGLFault`` where a pass fails and
    there is no frame.
    """
    shot = case.shot
    with located_at(case.sketch, shot):
        sketch = case.sketch.for_shot(shot)
        frame = engine.render(sketch, size=shot.size, time=shot.time, steps=dict(shot.steps))
    error = engine.ctx.error
    not_finite, drawn = engine.not_finite(), engine.drawn()
    textures = [item for item in shot.mask if isinstance(item, str) and not item.endswith(MASK_ENDING)]
    masks = [
        Light(engine.read(sketch, name, size=shot.size, time=shot.time, steps=dict(shot.steps))[::-1], name)
        for name in textures
    ]
    return RenderedShot(
        frame.array,
        frame.sketch,
        frame.time,
        drawn=drawn,
        not_finite=str(not_finite) if not_finite else "",
        first_bad=first_not_finite(engine, not_finite) if not_finite else None,
        gl_error="" if error == "GL_NO_ERROR" else error,
        masks=tuple(masks),
    )


def film_of(frames: Sequence[RenderedShot], labels: Sequence[str], masks: tuple[Light, ...]) -> RenderedShot:
    """Return frames as one picture, a strip, with what is wrong with any of them."""
    strip = strip_of([frame.array for frame in frames])
    drawn = [frame.drawn for frame in frames]
    digest = hashlib.sha256(" ".join(drawn).encode()).hexdigest()[:32] if all(drawn) else ""
    named = [f"frame {i} of {len(frames)}" for i in range(1, len(frames) + 1)]
    bad = [f"{name}: {f.not_finite}" for name, f in zip(named, frames, strict=True) if f.not_finite]
    return RenderedShot(
        strip,
        drawn=digest,
        not_finite=next(iter(bad), ""),
        gl_error=next((frame.gl_error for frame in frames if frame.gl_error), ""),
        fonts=frames[0].fonts,
        tone=frames[0].tone,
        masks=masks,
        labels=tuple(labels),
    )


def check(
    case: ShotCase,
    frame: Frame,
    renderer: ContextInfo,
    reference_renderer: str = REFERENCE_RENDERER,
    *,
    by_pixels: bool = False,
) -> Outcome:
    """Judge a frame by the references of its renderer; any may match, else the nearest decides.

    Without any, it is judged by those of ``reference_renderer``, a slug; of that renderer itself
    a reference that is not there is missing, even where other renderers have one. Another renderer's are
    compared by structure, or ``by_pixels``, as another build's are. A frame of `render_shot`
    also says what was drawn, and what was wrong with it. Raises ``DataError`` for a mask that hides
    everything, or does not fit.
    """
    name = case.shot.name
    rule = rule_of(case, frame)
    if not isinstance(frame, RenderedShot):
        frame = RenderedShot(frame.array, frame.sketch, frame.time)
    fingerprint = fingerprint_of(renderer, frame.size, frame.drawn, frame.fonts)
    path = reference_path(case.sketch, name, renderer.slug)
    files = accepted(case.sketch, name, renderer.slug)
    own = bool(files)
    if not own and renderer.slug != reference_renderer:
        files = accepted(case.sketch, name, reference_renderer)
    origin: dict[str, Any] = {"case": case, "frame": frame, "renderer": renderer}
    references = []
    for file in files:
        try:
            references.append(read_reference(file))
        except DataError as error:
            return Outcome(**vars(unreadable(frame.array, fingerprint, str(error))), **origin, path=file)
    strictly = own or by_pixels
    compared_with = (references if strictly else [], [] if strictly else references)
    count, mask = len(frame.labels), rule.mask
    judged = partial(judge_frames, labels=frame.labels) if count else judge
    judgement, reference = judged(
        frame.array,
        fingerprint,
        *compared_with,
        rule=rule,
        not_finite=frame.not_finite,
        gl_error=frame.gl_error,
    )
    if count and mask is not None:
        mask = repeated(mask, count)
    return Outcome(
        **vars(judgement),
        **origin,
        mask=mask,
        masked=tuple(map(describe_item, _parts(case, frame))),
        path=reference.path if reference else path,
        reference=reference,
    )


def images_of(outcome: Outcome) -> dict[str, NDArray[np.uint8]]:
    """Return the actual image, and the expected one and the differences if there is a reference.

    One of those is 16 times as strong as the pixels have it, the other, of images of one size,
    is FLIP; both are of what is not masked, and "masked" shows what is. By the words actual, expected,
    difference, flip and masked.
    """
    actual, reference = outcome.frame.array, outcome.reference
    images = {"actual": actual}
    if reference is not None:
        visible = hidden(actual, reference.pixels, outcome.mask)
        images["expected"] = reference.pixels
        images["difference"] = difference_picture(visible, reference.pixels)
        if actual.shape == reference.pixels.shape:
            images["flip"] = flip_picture(visible, reference.pixels)
    if outcome.mask is not None:
        images["masked"] = striped(actual, outcome.mask)
    return images


def _parts(case: ShotCase, frame: Frame) -> list[Rectangle | str | Light]:
    """Return what a frame's mask is made of."""
    own = [item for item in case.shot.mask if not isinstance(item, str) or item.endswith(MASK_ENDING)]
    return [*own, *(frame.masks if isinstance(frame, RenderedShot) else ())]


def rule_of(case: ShotCase, frame: Frame) -> Rule:
    """Return how a shot's frame is compared; raise ``DataError`` for a mask that does not fit it."""
    labels = frame.labels if isinstance(frame, RenderedShot) else ()
    size = frame_size(frame.array, len(labels)) if labels else frame.size
    mask = mask_of(_parts(case, frame), size, Path(case.sketch.folder))
    return Rule(tolerance=case.shot.tolerance, mask=mask, allow_blank=case.shot.allow_blank)


# ── the worker process that renders ──────────────────────────────────────────


LIMIT = 120.0
"""[s] A render may take that long: far beyond any shot on a slow machine with a cold shader cache."""

HANDLER = __name__


class RendererProcess(PoolOwner):
    """Renders shots in a worker, which starts with the first and is replaced when it dies.

    ``limit`` is seconds a render. ``renderer`` is "software" for Mesa's software renderer,
    "any" for what OpenGL gives by itself, "either" for the first that there is.
    Use it with ``with``, or call ``close()``.
    """

    def __init__(self, limit: float = LIMIT, renderer: str = "software") -> None:
        self.limit = limit  # [s] a render
        self._pool = Pool(HANDLER, Limits(start_seconds=max(limit, 120.0)), options=renderer)
        self._refusal: Exception | None = None  # no process is started any more
        self._printed = ""

    @property
    def renderer(self) -> ContextInfo:
        """What renders the shots.

        Raises ``ContextError`` where there is no such renderer, ``SandboxCrash`` or
        ``SandboxTimeout`` where the worker does not start.
        """
        info = self._ask(OPEN)
        assert isinstance(info, ContextInfo)
        return info

    @property
    def process(self) -> int | None:
        """The worker's process number; None while there is none."""
        return next(iter(self._pool.pids), None)

    def printed(self) -> str:
        """Return, once, what the worker printed."""
        printed, self._printed = self._printed, ""
        return printed

    def render(self, case: ShotCase) -> RenderedShot:
        """Render one shot in the worker.

        Raises what `playground.verify.shots.suite.take` raises, ``SandboxCrash`` where the worker died,
        ``SandboxTimeout`` where it took too long.
        """
        frame = self._ask(case, f"drawing {case}")
        assert isinstance(frame, RenderedShot)
        return frame

    def locate(self, search: Search) -> Difference:
        """Return where a shot parts from its reference's run.

        Raises ``NoTrace`` where that cannot be said, else as ``render`` does.
        """
        found = self._ask(search, f"tracing {search.sketch.name}/{search.shot.name}", 4 * search.seconds)
        assert isinstance(found, Difference)
        return found

    def _ask(self, request: object, what: str = "", limit: float | None = None) -> object:
        if self._refusal is not None:
            raise self._refusal
        outcome = self._pool.run(request, seconds=limit or self.limit)
        self._printed += outcome.printed
        if not outcome.started:
            self._refusal = outcome.failure(what)
            self.close()
        return outcome.get(what)


# ── in the worker ────────────────────────────────────────────────────────────


def open_service(parent: Parent, renderer: str) -> Service:
    """Open a context and an engine on it: "software", "any", or "either", the first where it is to be had."""
    try:
        engine = open_engine(software=renderer != "any", notice=silent)
    except ContextError:
        if renderer != "either":
            raise
        engine = open_engine(notice=silent)
    return Service(partial(_answer, engine), engine.info)


def _answer(engine: Engine, request: ShotCase | Search) -> RenderedShot | Difference:
    return render_shot(engine, request) if isinstance(request, ShotCase) else locate(engine, request)
