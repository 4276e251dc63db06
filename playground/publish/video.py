"""Encode pictures as a video, one by one, into a file that is whole or not there.

FFmpeg encodes (see ``encoders``). The pictures are sRGB: they become BT.709 Y'CbCr of limited
range, and the file says so, which every player shows as it was drawn; each second pixel has
a colour of its own, all have their brightness. A GIF has 256 colours a picture, chosen for
each. Alpha is dropped, and counted: ``Video.dropped``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from types import TracebackType

import numpy as np
from numpy.typing import NDArray

from playground.data.image_files import VIDEO_ENDINGS
from playground.engine.engine import Engine
from playground.engine.plain_forms import warn
from playground.errors import DataError, ParameterError, PlaygroundError, counted, nearest
from playground.files import partial_file, reason, writing
from playground.paths import shown
from playground.publish.encoders import Codec, open_encoder, read_packets
from playground.publish.series import DEFAULT_SIZE, FPS, Add, Series, engine_or_own, write_series
from playground.sketch.model import Sketch

QUALITIES: dict[str, tuple[int, int]] = {
    "low": (30, 44),
    "medium": (23, 36),
    "high": (18, 28),
    "best": (10, 16),
}
"""Name → constant rate factor of H.264 and of VP9: the lower, the better and the larger."""

_SAME_BYTES = "cpu-independent=1"  # x264's fast motion trees read what no one wrote in small pictures

QUALITY = "high"
_GIF_RATES = "1, 2, 4, 5, 10, 20, 25, 50"  # a picture of a GIF is shown for whole hundredths of a second
_MAX_SIDE = 16_384  # [pixels] of a side: H.264's and VP9's encoders take no more


class Stopped(KeyboardInterrupt):
    """A video was interrupted; ``path`` is the shorter one that is left, None where there is none."""

    def __init__(self, path: Path | None, count: int) -> None:
        super().__init__()
        self.path = path
        self.count = count  # pictures in it


class Video:
    """A video being written: use it with ``with``, and ``add()`` every picture.

    ``size`` in pixels; ``count`` pictures are expected. At the end the file is read back,
    and takes its name if all are in it at the given rate. Where it cannot be read back it
    takes its name all the same, and ``warning`` says so; where another number of pictures is
    in it, it is named ``film-first-119.mp4`` and ``DataError`` says so. When the block fails
    before that, nothing is left; when it is interrupted, what is there becomes a shorter
    video, as ``film-first-120.mp4``, and ``Stopped`` has its name.

    Raises ``DataError``, ``ParameterError`` or ``ContextError`` in a message for another
    ending, odd sides, a rate that a GIF has not, a missing folder, and where nothing encodes.
    """

    def __init__(
        self, path: str | Path, size: tuple[int, int], fps: Fraction, count: int, *, quality: str = QUALITY
    ) -> None:
        self.path = Path(path).expanduser()
        self.size, self.fps, self.count = size, fps, count
        self.added = 0
        self.dropped = 0  # pictures so far whose alpha was below one somewhere
        self.warning = ""  # a message where the finished file could not be checked
        self._ending = check_video(self.path, size, fps, quality)
        with ExitStack() as stack:
            with writing(self.path):
                self._partial = stack.enter_context(partial_file(self.path))
                self._encoder = open_encoder(self._partial.path, _codec(self._ending, quality), size, fps)
            self._open_partial = stack.pop_all()

    def __enter__(self) -> Video:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if kind is None:
                self._finish()
            elif issubclass(kind, KeyboardInterrupt):
                raise Stopped(self._shorter(), self.added) from None
        finally:
            self._encoder.close()
            self._open_partial.close()

    def add(self, picture: NDArray[np.uint8]) -> None:
        """Encode the next picture, (height, width, 3 or 4) bytes, top row first, sRGB."""
        self.dropped += has_alpha(picture)
        with writing(self.path):
            self._encoder.add(picture, self.added)
        self.added += 1

    def _finish(self) -> None:
        """Rename the video; one that holds another number of pictures gets another."""
        if not self.added:
            raise DataError(f"no picture was drawn, of {self.count}", file=self.path)
        self._finish_encoder()
        try:
            count, rate = count_pictures(self._partial.path)
        except KeyboardInterrupt:
            self._name(self._first(self.added))
            raise Stopped(self._first(self.added), self.added) from None
        except Exception as error:  # any error of any version of PyAV: the film is encoded, and stays
            self._name(self.path)
            why = error.diagnostics[0].message if isinstance(error, PlaygroundError) else reason(error)
            self.warning = f"{shown(self.path)} was written, but could not be checked: {why}"
            return
        if count == self.count and rate == self.fps:
            self._name(self.path)
            return
        renamed = self._first(count)
        self._name(renamed)
        raise DataError(
            f"the encoder wrote {count} pictures at {float(rate):g} a second, not {self.count} at "
            f"{float(self.fps):g}; they are kept in {renamed.name}",
            file=self.path,
        )

    def _finish_encoder(self) -> None:
        with writing(self.path):
            self._encoder.finish()

    def _name(self, path: Path) -> None:
        with writing(path):
            self._partial.rename(path)

    def _first(self, count: int) -> Path:
        return self.path.with_name(f"{self.path.stem}-first-{count}{self.path.suffix}")

    def _shorter(self) -> Path | None:
        """Return where the pictures so far are, once they are a video; None for none.

        They are counted in the file: one may be in it that was interrupted before it was counted.
        """
        if not self.added:
            return None
        self._finish_encoder()
        with suppress(Exception, KeyboardInterrupt):  # then the count is what was added
            self.added, _ = count_pictures(self._partial.path)
        path = self._first(self.added)
        self._name(path)
        return path


@dataclass(frozen=True)
class VideoFile:
    """The sink of a series that is a video: each picture is encoded as it is drawn.

    See ``Video`` for what is refused, and for what is left of it when it is interrupted.
    """

    path: str | Path
    quality: str = QUALITY

    @property
    def paths(self) -> list[Path]:
        """The one file."""
        return [Path(self.path)]

    def check(self, series: Series) -> None:
        """Raise ``DataError`` or ``ParameterError`` where no such video can be written."""
        check_video(Path(self.path).expanduser(), series.size, series.fps, self.quality)

    @contextmanager
    def open(self, series: Series, notice: Callable[[str], None]) -> Iterator[Add]:
        """Write the video; ``notice`` gets a message where it could not be checked, or alpha was dropped."""
        with Video(self.path, series.size, series.fps, series.count, quality=self.quality) as video:
            yield lambda picture: video.add(picture.array)
        for note in (video.warning, alpha_note(video.dropped, series.count, "the video")):
            if note:
                notice(note)


def has_alpha(picture: NDArray[np.uint8]) -> bool:
    """Return whether a picture, (height, width, 3 or 4) bytes, is not opaque somewhere."""
    return picture.shape[2] == 4 and bool((picture[..., 3] < 255).any())


def alpha_note(dropped: int, count: int, what: str) -> str:
    """Return a message on pictures whose alpha a film or sheet could not keep; "" for none."""
    if not dropped:
        return ""
    some = "every picture" if dropped == count else f"{dropped} of {counted(count, 'picture')}"
    return f"{what} is opaque: the alpha of {some} was dropped; PNG files keep it (--frames)"


def check_video(path: Path, size: tuple[int, int], fps: Fraction, quality: str) -> str:
    """Return the ending of a video that can be written; raise ``DataError`` or ``ParameterError``."""
    ending = path.suffix.lower()
    if ending not in VIDEO_ENDINGS:
        kinds = ", ".join(f"{e} ({what})" for e, what in VIDEO_ENDINGS.items())
        raise DataError(f"a video is written to a name ending in {kinds}", file=str(path))
    if quality not in QUALITIES:
        hint = nearest(quality, QUALITIES)
        raise ParameterError(f"quality '{quality}': expected {', '.join(QUALITIES)}{hint.partition(';')[0]}")
    width, height = size
    if ending != ".gif" and (width % 2 or height % 2):
        near = f"{width + width % 2}x{height + height % 2}"
        raise ParameterError(f"a video of {width} x {height} pixels: both must be even, as {near}")
    if max(size) > _MAX_SIDE:
        raise ParameterError(f"a video of {width} x {height} pixels: at most {_MAX_SIDE} a side")
    if ending == ".gif" and (100 / fps).denominator != 1:
        raise ParameterError(
            f"a GIF cannot show {float(fps):g} pictures a second: it counts in hundredths of a second; "
            f"choose one of {_GIF_RATES}"
        )
    if path.is_dir():
        raise DataError("is a folder; expected the name of a file to write", file=str(path))
    if not path.parent.is_dir():
        raise DataError(f"there is no folder '{shown(path.parent)}' to write into", file=str(path))
    return ending


def count_pictures(path: str | Path) -> tuple[int, Fraction]:
    """Return how many pictures a video has and how many a second, without decoding them."""
    rate, result = read_packets(Path(path))
    times = sorted(time for time in result if time is not None)
    if len(times) > 1 and times[-1] > times[0]:  # what is written is times; some formats round to thousandths
        mean = Fraction(len(times) - 1) / (times[-1] - times[0])
        near = rate and abs(mean / rate - 1) < Fraction(1, 100)
        rate = rate if near else mean.limit_denominator(1001)
    return len(result), rate


def _codec(ending: str, quality: str) -> Codec:
    h264, vp9 = QUALITIES[quality]
    if ending == ".mp4":
        x264 = {"crf": str(h264), "preset": "medium", "x264-params": _SAME_BYTES}
        return Codec("mp4", "libx264", "yuv420p", x264)
    if ending == ".webm":
        speed = {"row-mt": "1", "deadline": "good", "cpu-used": "3"}
        return Codec("webm", "libvpx-vp9", "yuv420p", {"crf": str(vp9), "b": "0"} | speed)
    return Codec("gif", "gif", "pal8", {})


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
    series = Series.at_times(sketch, seconds=seconds, fps=fps, size=size, start=start)
    with engine_or_own(engine) as used:
        write_series(used, series, VideoFile(path, quality), notice=warn)
    return Path(path)
