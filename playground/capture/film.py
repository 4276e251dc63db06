"""Films: pictures at one time after another, as a video or as numbered PNG files.

Picture n of a film is that of the time ``n / fps``, independent of the machine's speed; what a
sketch's keyframes, its text or its repeats make of the time is theirs. The terrain and its
light are computed again only where they change with it, and nothing that later pictures do
not use stays in the cache.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.api import headless
from playground.capture.video import QUALITY, Video, alpha_note
from playground.engine.engine import Engine
from playground.engine.plain_forms import warn
from playground.errors import ParameterError
from playground.sketch.load import opened
from playground.sketch.model import Sketch
from playground.sketch.traits import traits_of

FPS = 30
DEFAULT_SIZE = (1280, 720)
MAX_FRAMES = 1_000_000


@dataclass(frozen=True, kw_only=True)
class Film:
    """A sketch at so many times, one after another."""

    sketch: Sketch
    count: int  # pictures
    fps: Fraction
    size: tuple[int, int]  # [pixels]
    start: float = 0.0  # [s] of the first picture
    steps: Mapping[str, int] | None = None  # as in ``Engine.render``

    def time(self, number: int) -> float:
        """Return the time in seconds of a picture, from 0."""
        return self.start + float(number / self.fps)

    @property
    def still(self) -> str:
        """Return a message where all pictures are the same, since nothing depends on the time; else ""."""
        traits, first, last = traits_of(self.sketch), self.time(0), self.time(self.count - 1)
        if self.count == 1 or traits.moves or traits.devices:
            return ""
        times = (last, *(frame.time for frame in self.sketch.keyframes if first < frame.time < last))
        if any(self.sketch.at(time) != self.sketch.at(first) for time in times):
            return ""
        what = "no keyframe changes anything" if self.sketch.keyframes else "it has no keyframes"
        return (
            f"all {self.count} pictures are the same: "
            f"nothing in sketch {self.sketch.name} depends on the time, and {what}"
        )


def film_of(
    sketch: Sketch | str | Path,
    *,
    seconds: float | None = None,
    fps: float | Fraction = FPS,
    size: tuple[int, int] = DEFAULT_SIZE,
    start: float = 0.0,
    steps: Mapping[str, int] | None = None,
) -> Film:
    """Return the film of a sketch: ``seconds`` long, else from ``start`` to its last keyframe.

    Raises ``ParameterError`` for a film of no picture, or of more than a million.
    """
    loaded = opened(sketch)
    rate = fps if isinstance(fps, Fraction) else Fraction(fps).limit_denominator(1001)
    if not Fraction(1, 60) <= rate <= 1000:
        raise ParameterError(f"{float(fps):g} pictures a second: expected 1/60 to 1000")
    if seconds is None:
        seconds = loaded.duration - start
        if seconds <= 0.0:
            raise ParameterError(
                f"how long? sketch {loaded.name} has no keyframe after {start:g} s; say how many seconds"
            )
    count = round(Fraction(seconds) * rate) if abs(seconds) < 1e7 else 0
    if not 1 <= count <= MAX_FRAMES:
        raise ParameterError(
            f"{seconds:g} s at {float(rate):g} pictures a second: expected 1 to {MAX_FRAMES} pictures"
        )
    return Film(sketch=loaded, count=count, fps=rate, size=size, start=start, steps=steps)


@contextmanager
def frame_uniforms(engine: Engine, film: Film) -> Iterator[None]:
    """Set the time between two pictures for plain shaders, in the block."""
    before = engine.runner.delta
    engine.runner.delta = float(1 / film.fps)
    try:
        yield
    finally:
        engine.runner.delta = before


def frames(engine: Engine, film: Film) -> Iterator[NDArray[np.uint8]]:
    """Yield the pictures of a film, each (height, width, 4), top row first, sRGB and alpha."""
    for number in range(film.count):
        with frame_uniforms(engine, film):
            frame = engine.render(film.sketch, size=film.size, time=film.time(number), steps=film.steps)
        engine.forget_unused()
        yield frame.array


def write_film(
    engine: Engine,
    film: Film,
    path: str | Path,
    *,
    quality: str = QUALITY,
    done: Callable[[], None] = lambda: None,
    notice: Callable[[str], None] = lambda _: None,
) -> Path:
    """Write a film as a video by the path's ending, whole or not at all, and return its path.

    Each picture is encoded as it is drawn; ``done`` is called after each, ``notice`` with a
    sentence where all are the same, and where alpha was dropped. The file is read back before it
    takes its name: the pictures in it are counted. See ``Video`` for what is refused, and for what
    is left of it when it is interrupted.
    """
    if film.still:
        notice(film.still)
    with Video(path, film.size, film.fps, film.count, quality=quality) as video:
        for picture in frames(engine, film):
            video.add(picture)
            done()
    for note in (video.warning, alpha_note(video.dropped, film.count, "the video")):
        if note:
            notice(note)
    return Path(path)


def render_video(
    sketch: Sketch | str | Path,
    path: str | Path,
    *,
    seconds: float | None = None,
    fps: float | Fraction = FPS,
    size: tuple[int, int] = DEFAULT_SIZE,
    start: float = 0.0,
    quality: str = QUALITY,
    engine: Engine | None = None,
) -> Path:
    """Render a sketch as a video: ``.mp4`` (H.264), ``.webm`` (VP9) or ``.gif``, by the path's ending.

    ``seconds`` long, to its last keyframe unless given, from ``start``; ``size`` in pixels,
    both sides even but for ``.gif``; ``quality`` "low", "medium", "high" or "best". Without
    an ``engine`` one is opened. Needs the extra ``video`` or the program ``ffmpeg`` on PATH.
    A warning says where all pictures are the same, and where alpha was dropped.
    ``path`` is returned; a file of that name is replaced at the end. ``sketch`` is a loaded one, or
    what ``load`` takes; ``fps`` is pictures a second.

        playground.render_video("l_dot_n", "land.mp4", seconds=0.2, fps=10, size=(64, 36))

    Raises ``PlaygroundError`` in a message.
    """
    film = film_of(sketch, seconds=seconds, fps=fps, size=size, start=start)
    with nullcontext(engine) if engine is not None else headless() as used:
        return write_film(used, film, path, quality=quality, notice=warn)
