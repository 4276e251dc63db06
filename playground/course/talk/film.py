"""A presentation as a film: each beat as long as it takes to read, sweeps moving, notes as subtitles.

The strip and what is over the picture are those of the window: ``slide``. No window is opened.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from playground.course.measures import Number, filled, measured, named_in
from playground.course.model import Break, Compare, Lesson, Scene, Slider
from playground.course.scenes import BOTH, broken, with_value
from playground.course.talk.beats import (
    Beat,
    beats_of,
    cues_of,
    scene_of,
    seconds_of,
    srt,
    texts_of_beat,
    with_texts,
)
from playground.course.talk.presenter import Row
from playground.course.talk.slide import Sizes, board_of, gauges_of, strip_of
from playground.course.traces import numbers_of_traces
from playground.engine.engine import Engine
from playground.files import write_file
from playground.publish.video import QUALITY, Video, check_video
from playground.sketch.assign import resolve
from playground.sketch.model import Value
from playground.studio.picture.view import framed

FPS = Fraction(10)
_VALUE = 0.5
"""[s] from one value of a sweep to the next."""
_BETWEEN = 5  # pictures from one value to the next, where what lies between is a value too
_HOLDS = 1.5  # [s] that a sweep stays at its last value at least
_WIPE = 3.0  # [s] that the line takes from one side of a comparison to the other and half way back

Picture = NDArray[np.uint8]


@dataclass(frozen=True)
class PresentedFilm:
    """A lesson's beats, and for how many pictures of the film each is on."""

    lesson: Lesson
    beats: tuple[Beat, ...]
    first: int  # which beat of the lesson the first is, from 0
    counts: tuple[int, ...]
    path: Path
    sizes: Sizes

    @property
    def seconds(self) -> float:
        """How long it is."""
        return float(sum(self.counts) / FPS)

    def check(self) -> None:
        """Raise ``DataError`` or ``ParameterError`` where no such film can be written."""
        check_video(self.path, (self.sizes.width, self.sizes.height), FPS, QUALITY)


def film_of(lesson: Lesson, path: Path, size: tuple[int, int], first: int = 0) -> PresentedFilm:
    """Return the film of a lesson from a beat on, ``size`` in pixels; raises as ``beats_of``."""
    beats = beats_of(lesson)[first:]
    counts = tuple(round(_seconds(lesson, beat) * FPS) for beat in beats)
    return PresentedFilm(lesson, beats, first, counts, path, Sizes(*size))


def write_presentation(
    engine: Engine,
    film: PresentedFilm,
    *,
    subtitles: bool = True,
    done: Callable[[], None] = lambda: None,
    notice: Callable[[str], None] = lambda text: None,
) -> list[Path]:
    """Write a film, whole or not at all, and its subtitles; return the paths. ``done`` follows each beat.

    Raises as ``Video`` and ``Engine.render``.
    """
    numbers = _numbers(engine, film)
    beats = [_with_numbers(beat, film.lesson, numbers) for beat in film.beats]
    size = film.sizes.width, film.sizes.height
    with Video(film.path, size, FPS, sum(film.counts)) as video:
        for number, (beat, count) in enumerate(zip(beats, film.counts, strict=True)):
            position = film.first + number + 1, film.first + len(beats)
            for picture in _frames(engine, film.lesson, beat, position, count, film.sizes):
                video.add(picture)
            done()
    if video.warning:
        notice(video.warning)
    if not subtitles:
        return [film.path]
    path, at, cues = film.path.with_suffix(".srt"), 0.0, []
    for beat, count in zip(beats, film.counts, strict=True):
        cues += cues_of(beat, at, float(count / FPS))
        at += float(count / FPS)
    write_file(path, srt(cues))
    return [film.path, path]


def _seconds(lesson: Lesson, beat: Beat) -> float:
    """Return how long a beat is on [s]: as long as it is read, and as its picture moves."""
    block, seconds = _block(lesson, beat), seconds_of(beat)
    if beat.kind == "sweep" and isinstance(block, Slider):
        return max(seconds, (len(block.values) - 1) * _VALUE + _HOLDS)
    return max(seconds, _WIPE) if beat.still is not None and beat.still.index == BOTH else seconds


def _frames(
    engine: Engine, lesson: Lesson, beat: Beat, position: tuple[int, int], count: int, sizes: Sizes
) -> Iterator[Picture]:
    """Yield the pictures of a beat."""
    strip, board, block = strip_of(beat, position, sizes), board_of(beat, sizes), _block(lesson, beat)
    if beat.kind == "sweep" and isinstance(block, Slider):
        yield from _sweep(engine, block, count, sizes, strip)
        return
    if isinstance(block, Compare) and beat.still is not None and beat.still.index == BOTH:
        both = [_drawn(engine, scene, sizes) for scene in block.scenes]
        is_comparison = beat.kind == "compare"
        for number in range(count):
            share = _wiped(float(number / FPS)) if is_comparison else 0.5
            yield _whole(_divided(both, share, sizes), board, strip, sizes)
        return
    whole = _whole(_drawn(engine, _scene(lesson, beat), sizes), board, strip, sizes)
    for _ in range(count):
        yield whole


def _sweep(engine: Engine, block: Slider, count: int, sizes: Sizes, strip: Image.Image) -> Iterator[Picture]:
    """Yield the pictures of a sweep: from value to value, then the last."""
    values = list(_values(block))
    each = max(round(float(_VALUE * FPS) * (len(block.values) - 1) / max(len(values) - 1, 1)), 1)
    last: Picture | None = None
    for number in range(count):
        at = min(number // each, len(values) - 1)
        if last is None or (number % each == 0 and number // each < len(values)):
            scene = with_value(block.scenes[0], block.parameter, values[at])
            row = _row(scene, block, values[at])
            gauges = gauges_of([row], 0, sizes)
            last = _whole(_drawn(engine, scene, sizes), gauges, strip, sizes, margin=True)
        yield last


def _values(block: Slider) -> Iterator[Value]:
    """Yield the values of a sweep, and those between two numbers that are not whole."""
    for value, other in zip(block.values, block.values[1:], strict=False):
        yield value
        if isinstance(value, float) and isinstance(other, float):
            yield from (value + (other - value) * n / _BETWEEN for n in range(1, _BETWEEN))
    yield block.values[-1]


def _row(scene: Scene, block: Slider, value: Value) -> Row:
    parameter = resolve(scene.sketch.graph, block.parameter)[0].parameter
    return Row(block.parameter, block.label or parameter.title, parameter, value)


def _drawn(engine: Engine, scene: Scene, sizes: Sizes) -> Picture:
    """Return a scene's picture above the strip, (height, width, 3), as the window frames it."""
    size = sizes.picture
    sketch = framed(scene.sketch, scene.time, scene.pixels, size)
    frame = engine.render(sketch, size=size, time=scene.time, steps=dict(scene.steps))
    engine.forget_unused()
    return np.ascontiguousarray(frame.array[..., :3])


def _whole(
    picture: Picture, over: Image.Image | None, strip: Image.Image, sizes: Sizes, *, margin: bool = False
) -> Picture:
    """Return a picture of the film: what was drawn, what is over it, the strip below."""
    image = Image.new("RGB", (sizes.width, sizes.height))
    image.paste(Image.fromarray(picture))
    if over is not None:
        edge = round(24 * sizes.scale) if margin else 0
        image.paste(over, (edge, edge), over)
    image.paste(strip.convert("RGB"), (0, sizes.height - sizes.strip))
    return np.asarray(image)


def _divided(both: list[Picture], share: float, sizes: Sizes) -> Picture:
    """Return two pictures with a line between them, at a fraction of the width."""
    at = round(share * sizes.width)
    image = Image.fromarray(both[1].copy())
    image.paste(Image.fromarray(both[0][:, :at]) if at else Image.new("RGB", (0, 0)))
    line = ImageDraw.Draw(image)
    line.line((at, 0, at, sizes.picture[1]), (255, 255, 255), max(round(3 * sizes.scale), 1))
    return np.asarray(image)


def _wiped(seconds: float) -> float:
    """Return where the line is: from the right to the left, then to the middle, where it stays."""
    part = seconds / _WIPE
    if part < 2 / 3:
        return 0.9 - 0.8 * part * 1.5
    return min(0.1 + 0.4 * (part - 2 / 3) * 3, 0.5)


def _scene(lesson: Lesson, beat: Beat) -> Scene:
    assert beat.still is not None
    block = _block(lesson, beat)
    if isinstance(block, Break) and beat.still.broken:
        return broken(block)
    scene_shown = scene_of(lesson, beat.still)
    assert scene_shown is not None
    return scene_shown


def _block(lesson: Lesson, beat: Beat) -> Any:
    return lesson.named.get(beat.still.block) if beat.still is not None else None


def _numbers(engine: Engine, film: PresentedFilm) -> dict[str, Number]:
    """Compute the numbers that the film's beats name."""
    names = {name for beat in film.beats for text in texts_of_beat(beat) for name in named_in(text)}
    measures = [measure for measure in film.lesson.measures if measure.name in names]
    numbers = {measure.name: measured(engine, measure) for measure in measures}
    return numbers | numbers_of_traces(engine, film.lesson, names)


def _with_numbers(beat: Beat, lesson: Lesson, numbers: Mapping[str, Number]) -> Beat:
    return with_texts(beat, lambda text: filled(text, numbers, lesson.language))
