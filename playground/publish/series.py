"""Many pictures of a sketch, one after another: at each time of a film, or with each value of a sweep.

Picture n of a film is that of the time ``n / fps``, independent of the machine's speed; what a
sketch's keyframes, its text or its repeats make of the time is theirs. The terrain and its
light are computed again only where they change from picture to picture, and nothing that later ones do
not use stays in the cache.

``write_series`` draws a series into a sink: a ``VideoFile`` (of ``video``), ``NumberedFiles`` or a ``Sheet``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from playground.api import headless
from playground.data.image_files import read_png, write_png
from playground.engine.engine import Engine
from playground.errors import DataError, ParameterError, counted
from playground.files import make_folder
from playground.publish.large import save_picture
from playground.publish.sweep import DEFAULT_STEPS, MAX_PICTURES, Swept, columns_of, combinations, read_sweep
from playground.sketch.load import opened
from playground.sketch.model import FPS as FPS
from playground.sketch.model import MAX_SIDE, Camera, Sketch
from playground.sketch.traits import traits_of

if TYPE_CHECKING:
    import PIL.ImageFont


SWEEP_FPS = 4
"""Pictures a second of a sweep."""
DEFAULT_SIZE = (1280, 720)
SWEEP_SIZE = (320, 180)
"""Width and height in pixels of a picture of a sweep."""
MAX_FRAMES = 1_000_000


@dataclass(frozen=True, kw_only=True)
class Series:
    """A sketch at several times or, where it has ``cases``, at one time with several values.

    One that ``turns`` is a turntable: after its last picture its first would come again.
    """

    sketch: Sketch
    count: int  # pictures
    size: tuple[int, int]  # [pixels]
    fps: Fraction
    start: float = 0.0  # [s] of the first picture
    steps: Mapping[str, int] | None = None  # as in ``Engine.render``
    turns: bool = False  # the camera goes once round at one time, clockwise, seen from above
    seen: Callable[[Camera], Camera] | None = None  # what stands for the sketch's camera at each time
    cases: tuple[Swept, ...] = ()  # of a sweep, a sketch for each picture
    columns: int = 1  # pictures of a sweep side by side

    @classmethod
    def at_times(
        cls,
        sketch: Sketch | str | Path,
        *,
        seconds: float | None = None,
        fps: float | Fraction = FPS,
        size: tuple[int, int] = DEFAULT_SIZE,
        start: float = 0.0,
        steps: Mapping[str, int] | None = None,
    ) -> Series:
        """Return the film of a sketch: ``seconds`` long, else from ``start`` to its last keyframe.

        Raises ``ParameterError`` for a film of no picture, or of more than a million.
        """
        loaded, rate = opened(sketch), rate_of(fps)
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
        return cls(sketch=loaded, count=count, fps=rate, size=size, start=start, steps=steps)

    @classmethod
    def of_values(
        cls,
        sketch: Sketch | str | Path,
        sweeps: Sequence[str],
        *,
        steps: int = DEFAULT_STEPS,
        fps: Fraction = Fraction(SWEEP_FPS),
        size: tuple[int, int] = SWEEP_SIZE,
        time: float = 0.0,
    ) -> Series:
        """Return a sketch with each value of a sweep, or of two that make a grid, row by row.

        The first sweep goes along a row. ``sweeps`` and ``steps`` as ``read_sweep`` takes them. Raises
        ``ParameterError`` for what they do not say right, for more than two sweeps, for two of one
        parameter's same part, and for more than 400 pictures.
        """
        base = opened(sketch).at(time)
        read = [read_sweep(base, text, steps) for text in sweeps]
        if not 1 <= len(read) <= 2:
            raise ParameterError(f"{len(read)} sweeps: expected one, or two that make a grid")
        if len({sweep.path for sweep in read}) < len(read):
            raise ParameterError(f"two sweeps of {read[0].path}: expected two parameters")
        count, along = math.prod(len(sweep.values) for sweep in read), len(read[0].values)
        if count > MAX_PICTURES:
            raise ParameterError(f"{count} pictures are more than the {MAX_PICTURES} that a sheet may have")
        return cls(
            sketch=base,
            count=count,
            size=size,
            fps=fps,
            start=time,
            cases=combinations(base, read),
            columns=along if len(read) == 2 else columns_of(along),
        )

    def time(self, number: int) -> float:
        """Return the time in seconds of a picture, from 0."""
        return self.start if self.cases or self.turns else self.start + float(number / self.fps)

    def picture(self, engine: Engine, number: int) -> Picture:
        """Return a picture, from 0, that ``engine`` draws."""
        sketch = self.cases[number].sketch if self.cases else self.sketch
        at = {"size": self.size, "time": self.time(number), "steps": self.steps}
        if self.turns or self.seen is not None:
            sketch = sketch.at(self.time(number))
            camera = self.seen(sketch.camera) if self.seen is not None else sketch.camera
            if self.turns:
                camera = replace(camera, azimuth=(camera.azimuth + 360.0 * number / self.count) % 360.0)
            sketch = sketch.with_camera(camera)
        return Picture(engine, number, sketch, at)

    @property
    def still(self) -> str:
        """Return a message where all pictures are the same, since nothing depends on the time; else ""."""
        traits, first, last = traits_of(self.sketch), self.time(0), self.time(self.count - 1)
        if self.cases or self.turns or self.count == 1 or traits.moves or traits.devices:
            return ""
        times = (last, *(frame.time for frame in self.sketch.keyframes if first < frame.time < last))
        if any(self.sketch.at(time) != self.sketch.at(first) for time in times):
            return ""
        what = "no keyframe changes anything" if self.sketch.keyframes else "it has no keyframes"
        return (
            f"all {self.count} pictures are the same: "
            f"nothing in sketch {self.sketch.name} depends on the time, and {what}"
        )


@dataclass(frozen=True)
class Picture:
    """One picture of a series, drawn when a sink asks for it."""

    engine: Engine
    number: int  # from 0
    sketch: Sketch
    at: dict[str, Any]  # its size, time and steps, as ``Engine.render`` takes them

    @property
    def array(self) -> NDArray[np.uint8]:
        """The picture, (height, width, 4), top row first, sRGB and alpha."""
        return self.engine.render(self.sketch, **self.at).array


class Sink(Protocol):
    """What a series is written into: files that are whole or not there."""

    @property
    def paths(self) -> Sequence[Path]:
        """The files."""

    def open(self, series: Series, notice: Callable[[str], None]) -> AbstractContextManager[Add]:
        """Take the pictures of a series in the block, and write the file at its end.

        ``notice`` is called with a message where something of them was lost. Raises ``PlaygroundError`` for
        what cannot be written.
        """


Add = Callable[[Picture], None]
"""Takes the next picture."""


def write_series(
    engine: Engine,
    series: Series,
    sink: Sink,
    *,
    numbers: Iterable[int] | None = None,
    done: Callable[[], None] = lambda: None,
    notice: Callable[[str], None] = lambda _: None,
) -> None:
    """Draw the pictures of a series into a sink, one by one.

    ``numbers`` are those of the pictures, all unless given. ``done`` is called after each, and may raise to
    stop; ``notice`` with a message where all are the same, and with those of the sink.
    """
    if series.still:
        notice(series.still)
    with sink.open(series, notice) as add, _frame_delta(engine, series):
        for number in range(series.count) if numbers is None else numbers:
            add(series.picture(engine, number))
            engine.forget_unused()
            done()


@contextmanager
def _frame_delta(engine: Engine, series: Series) -> Iterator[None]:
    """Set the time between two pictures of a film for plain shaders, in the block."""
    before = engine.runner.delta
    engine.runner.delta = before if series.cases else float(1 / series.fps)
    try:
        yield
    finally:
        engine.runner.delta = before


def has_alpha(picture: NDArray[np.uint8]) -> bool:
    """Return whether a picture, (height, width, 3 or 4) bytes, is not opaque somewhere."""
    return picture.shape[2] == 4 and bool((picture[..., 3] < 255).any())


def alpha_note(dropped: int, count: int, what: str) -> str:
    """Return a message on pictures whose alpha a film or sheet could not keep; "" for none."""
    if not dropped:
        return ""
    some = "every picture" if dropped == count else f"{dropped} of {counted(count, 'picture')}"
    return f"{what} is opaque: the alpha of {some} was dropped; PNG files keep it (--frames)"


def rate_of(fps: float | Fraction) -> Fraction:
    """Return pictures a second as a fraction, as 30000/1001."""
    return fps if isinstance(fps, Fraction) else Fraction(fps).limit_denominator(1001)


def engine_or_own(engine: Engine | None) -> AbstractContextManager[Engine]:
    """Return an engine for a block: the one that is given, or one that is opened for it."""
    return headless() if engine is None else nullcontext(engine)


# ── numbered PNG files ─────────────────────────────────────────────────────────


MADE_OF = "Made of"
"""The text of a PNG that identifies all that its picture depends on."""

_NUMBER = re.compile(r"%(0\d+)?d")


def numbered(pattern: str | Path, number: int) -> Path:
    """Return the file of a picture: ``frames/%05d.png`` with its number in it."""
    path = Path(pattern).expanduser()
    return path.with_name(_NUMBER.sub(lambda match: f"{number:{match.group(1) or ''}d}", path.name))


def check_pattern(pattern: str | Path) -> None:
    """Raise ``DataError`` for what names no PNG files by number."""
    name = Path(pattern).name
    if len(_NUMBER.findall(name)) != 1 or name.count("%") != 1 or not name.lower().endswith(".png"):
        raise DataError("expected a name for numbered files, as frames/%05d.png", file=str(pattern))


@dataclass
class NumberedFiles:
    """The sink of a series that is PNG files, each whole or not at all.

    ``pattern`` names the files, as ``frames/%05d.png``; its folder is made. With ``resume`` a file that is
    there and good stays.
    """

    pattern: str | Path
    resume: bool = False
    drawn: list[Path] = field(default_factory=list)  # now
    kept: list[Path] = field(default_factory=list)  # that were there

    @property
    def paths(self) -> list[Path]:
        """The files, those that stayed as well."""
        return sorted(self.drawn + self.kept)

    @contextmanager
    def open(self, series: Series, notice: Callable[[str], None]) -> Iterator[Add]:
        """Write the files; ``notice`` gets a message on those that stayed.

        Raises ``DataError`` for a name without a number.
        """
        check_pattern(self.pattern)
        make_folder(Path(self.pattern).expanduser().parent)
        yield self._add
        if self.kept:
            notice(f"{counted(len(self.kept), 'picture')} kept, {len(self.drawn)} drawn")

    def _add(self, picture: Picture) -> None:
        path = numbered(self.pattern, picture.number)
        made_of = picture.engine.fingerprint(picture.sketch, **picture.at)  # reports mistakes of the sketch
        if self.resume and _is_good(path, picture.at["size"], made_of):
            self.kept.append(path)
        else:
            save_picture(picture.engine, picture.sketch, path, **picture.at, text={MADE_OF: made_of})
            self.drawn.append(path)


def _is_good(path: Path, size: tuple[int, int], made_of: str) -> bool:
    """Return whether a file is there, whole to its last pixel, and the picture wanted."""
    if not path.is_file():
        return False
    try:
        pixels, texts = read_png(path)
    except DataError:
        return False
    return (pixels.shape[1], pixels.shape[0]) == size and texts.get(MADE_OF) == made_of


def render_sequence(
    sketch: Sketch | str | Path,
    pattern: str | Path,
    numbers: Iterable[int],
    *,
    fps: float | Fraction = FPS,
    size: tuple[int, int] = DEFAULT_SIZE,
    resume: bool = False,
    engine: Engine | None = None,
) -> NumberedFiles:
    """Render pictures ``numbers`` of a sketch as PNG files named by ``pattern``, as ``frames/%05d.png``.

    Picture n is that of the time n / ``fps`` seconds; ``size`` in pixels. With ``resume``
    good files stay, whose sketch, size and time are the same. Without an ``engine`` one is
    opened. ``sketch`` is a loaded one, or what ``load`` takes. The result has
    the paths of those that were ``drawn`` and of those that were ``kept``.

        written = playground.render_sequence("l_dot_n", "frames/%05d.png", range(2), fps=10, size=(64, 36))

    Raises ``PlaygroundError`` in a message.
    """
    requested = list(numbers)
    if not requested or min(requested) < 0 or max(requested) >= MAX_FRAMES:
        raise ParameterError(f"pictures are numbered from 0 to {MAX_FRAMES - 1}; at least one was expected")
    series = Series(sketch=opened(sketch), count=max(requested) + 1, fps=rate_of(fps), size=size)
    sink = NumberedFiles(pattern, resume)
    with engine_or_own(engine) as used:
        write_series(used, series, sink, numbers=requested)
    return sink


# ── contact sheets ─────────────────────────────────────────────────────────────


_PAPER, _INK = (24, 25, 28), (232, 232, 228)
_MARGIN = 8  # [pixels] around a picture
_MIN_TEXT_HEIGHT = 9  # [pixels]


@dataclass(frozen=True)
class Sheet:
    """The sink of a series that is a contact sheet, a PNG that is whole or not there."""

    path: str | Path

    @property
    def paths(self) -> list[Path]:
        """The one file."""
        return [Path(self.path)]

    @contextmanager
    def open(self, series: Series, notice: Callable[[str], None]) -> Iterator[Add]:
        """Write the sheet; ``notice`` gets a message where alpha was dropped.

        Raises ``ParameterError`` for a sheet that is larger than a picture may be.
        """
        paper, dropped = Paper(series), 0

        def add(picture: Picture) -> None:
            nonlocal dropped
            array = picture.array
            dropped += has_alpha(array)
            paper.add(array)

        yield add
        write_png(self.path, paper.array)
        if note := alpha_note(dropped, series.count, "a sheet"):
            notice(note)


class Paper:
    """A sheet, onto which the pictures of a series are put one by one, each with its caption.

    A caption is as large as fits its picture's width. Raises ``ParameterError`` for too large a sheet.
    """

    def __init__(self, series: Series) -> None:
        import PIL.Image
        import PIL.ImageDraw

        self._columns, self._captions = series.columns, [case.caption for case in series.cases]
        width, height = series.size
        self._font, self._line = _font([text for caption in self._captions for text in caption], width)
        lines = len(self._captions[0])
        self._cell = width + _MARGIN, height + lines * self._line + _MARGIN + 4
        rows = -(-series.count // series.columns)
        size = series.columns * self._cell[0] + _MARGIN, rows * self._cell[1] + _MARGIN
        if max(size) > MAX_SIDE:
            raise ParameterError(
                f"a sheet of {size[0]} x {size[1]} pixels; at most {MAX_SIDE} a side: "
                "choose smaller pictures, or fewer"
            )
        self._image = PIL.Image.new("RGB", size, _PAPER)
        self._drawing = PIL.ImageDraw.Draw(self._image)
        self._count = 0

    @property
    def array(self) -> NDArray[np.uint8]:
        """The sheet, (height, width, 3) bytes, top row first."""
        return np.array(self._image, np.uint8)

    def add(self, picture: NDArray[np.uint8]) -> None:
        """Put the next picture, (height, width, 3 or 4) bytes, top row first, onto the sheet."""
        import PIL.Image

        down, along = divmod(self._count, self._columns)
        x, y = _MARGIN + along * self._cell[0], _MARGIN + down * self._cell[1]
        image = PIL.Image.fromarray(np.ascontiguousarray(picture[..., :3]))
        self._image.paste(image, (x, y))
        for number, text in enumerate(self._captions[self._count]):
            centre = (x + image.width / 2, y + image.height + 2 + (number + 0.5) * self._line)
            self._drawing.text(centre, text, _INK, font=self._font, anchor="mm")
        self._count += 1


def _font(captions: Sequence[str], width: int) -> tuple[PIL.ImageFont.FreeTypeFont, int]:
    """Return letters with which every caption is narrower than the picture, and the height of a line."""
    import PIL.ImageFont

    size = max(min(width // 16, 18), _MIN_TEXT_HEIGHT)
    while True:
        font = PIL.ImageFont.load_default(size)
        assert isinstance(font, PIL.ImageFont.FreeTypeFont)
        if size <= _MIN_TEXT_HEIGHT or max(font.getlength(text) for text in captions) <= width:
            return font, round(1.4 * size)
        size -= 1


def render_sweep(
    sketch: Sketch | str | Path,
    path: str | Path,
    *sweeps: str,
    steps: int = DEFAULT_STEPS,
    size: tuple[int, int] = SWEEP_SIZE,
    time: float = 0.0,
    engine: Engine | None = None,
) -> Path:
    """Render a contact sheet of one sweep, or of two that make a grid, as a PNG.

    A sweep is written ``"light.sun.elevation=5..60"``, ``"light.gain=1..3,5"`` for five steps,
    ``"light.gain=1,2,4"``; ``steps`` for a range that does not say. ``size`` in pixels is that
    of each picture, ``time`` in seconds. Without an ``engine`` one is opened. ``sketch`` is a loaded one,
    or what ``load`` takes; ``path`` is returned.

        playground.render_sweep("l_dot_n", "sheet.png", "product.sun.elevation=10,40,80", size=(64, 36))

    Raises ``ParameterError`` in a message for what ``sweeps`` do not say right.
    """
    series = Series.of_values(sketch, sweeps, steps=steps, size=size, time=time)
    with engine_or_own(engine) as used:
        write_series(used, series, Sheet(path))
    return Path(path)
