"""Encode pictures as a video, one by one, into a file that is whole or not there.

PyAV brings FFmpeg's encoders. The pictures are sRGB: they become BT.709 Y'CbCr of limited
range, and the file says so, which every player shows as it was drawn; each second pixel has
a colour of its own, all have their brightness. A GIF has 256 colours a picture, chosen for
each. Alpha is dropped, and counted: ``Video.dropped``.
"""

from __future__ import annotations

from contextlib import ExitStack, suppress
from fractions import Fraction
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import ContextError, DataError, ParameterError, PlaygroundError, counted, nearest
from playground.images.extensions import VIDEO_ENDINGS
from playground.images.files import reason, writing
from playground.partial import partial_file
from playground.paths import shown

if TYPE_CHECKING:
    import av.container

QUALITIES: dict[str, tuple[int, int]] = {
    "low": (30, 44),
    "medium": (23, 36),
    "high": (18, 28),
    "best": (10, 16),
}
"""Name → constant rate factor of H.264 and of VP9: the lower, the better and the larger."""

_SAME_BYTES = "cpu-independent=1"  # x264's fast motion trees read what no one wrote in small pictures

QUALITY = "high"
_BT709, _LIMITED = 1, 1  # as in ITU-T H.273
_GIF_RATES = "1, 2, 4, 5, 10, 20, 25, 50"  # a picture of a GIF is shown for whole hundredths of a second
_LONGEST = 16_384  # [pixels] of a side: H.264's and VP9's encoders take no more


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

    Raises ``DataError``, ``ParameterError`` or ``ContextError`` in a sentence for another
    ending, odd sides, a rate that a GIF has not, a missing folder, and where PyAV is missing.
    """

    def __init__(
        self, path: str | Path, size: tuple[int, int], fps: Fraction, count: int, *, quality: str = QUALITY
    ) -> None:
        self.path = Path(path).expanduser()
        self.size, self.fps, self.count = size, fps, count
        self.added = 0
        self.dropped = 0  # pictures so far whose alpha was below one somewhere
        self.warning = ""  # a sentence where the finished file could not be checked
        self._ending = check_video(self.path, size, fps, quality)
        self._av = _pyav()
        with ExitStack() as stack:
            with writing(self.path):
                self._partial = stack.enter_context(partial_file(self.path))
            self._open(quality)
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
            self._container.close()
            self._open_partial.close()

    def add(self, picture: NDArray[np.uint8]) -> None:
        """Encode the next picture, (height, width, 3 or 4) bytes, top row first, sRGB."""
        self.dropped += has_alpha(picture)
        frame = self._indexed(picture) if self._ending == ".gif" else self._yuv(picture)
        frame.pts, frame.time_base = self.added, 1 / self.fps
        self._mux(frame)
        self.added += 1

    def _open(self, quality: str) -> None:
        crf = str(QUALITIES[quality][0])
        x264 = {"crf": crf, "preset": "medium", "x264-params": _SAME_BYTES}
        form, codec, pixels, options = {
            ".mp4": ("mp4", "libx264", "yuv420p", x264),
            ".webm": ("webm", "libvpx-vp9", "yuv420p", {"crf": str(QUALITIES[quality][1]), "b": "0"}),
            ".gif": ("gif", "gif", "pal8", {}),
        }[self._ending]
        if codec == "libvpx-vp9":
            options |= {"row-mt": "1", "deadline": "good", "cpu-used": "3"}
        moved = {"movflags": "+faststart"} if form == "mp4" else {}
        try:
            with writing(self.path):
                self._container: av.container.OutputContainer = self._av.open(
                    str(self._partial.path), "w", format=form, options=moved
                )
                self._stream: Any = self._container.add_stream(codec, rate=self.fps, options=options)
        except ValueError as error:  # an encoder that this build has not
            raise ContextError(f"this PyAV cannot write {self._ending}: {reason(error)}") from None
        self._stream.width, self._stream.height = self.size
        self._stream.pix_fmt = pixels
        self._stream.time_base = 1 / self.fps
        if pixels == "yuv420p":
            context = self._stream.codec_context
            context.color_primaries = context.color_trc = context.colorspace = _BT709
            context.color_range = _LIMITED

    def _yuv(self, picture: NDArray[np.uint8]) -> Any:
        rgb = self._av.VideoFrame.from_ndarray(np.ascontiguousarray(picture[..., :3]), format="rgb24")
        return rgb.reformat(
            format="yuv420p",
            src_colorspace="ITU709",
            dst_colorspace="ITU709",
            src_color_range="JPEG",
            dst_color_range="MPEG",
            interpolation="AREA",
        )

    def _indexed(self, picture: NDArray[np.uint8]) -> Any:
        import PIL.Image

        found = PIL.Image.fromarray(np.ascontiguousarray(picture[..., :3])).quantize(256)
        colours = np.zeros((256, 4), np.uint8)
        given = np.array(found.getpalette() or [], np.uint8).reshape(-1, 3)[:256]
        colours[: len(given), 1:], colours[:, 0] = given, 255  # alpha, red, green, blue
        return self._av.VideoFrame.from_ndarray((np.array(found, np.uint8), colours), format="pal8")

    def _mux(self, frame: Any) -> None:
        with writing(self.path):
            for packet in self._stream.encode(frame):
                self._container.mux(packet)

    def _finish(self) -> None:
        """Rename the video; one that holds another number of pictures gets another."""
        if not self.added:
            raise DataError(f"no picture was drawn, of {self.count}", file=self.path)
        self._close()
        try:
            found, rate = count_pictures(self._partial.path)
        except KeyboardInterrupt:
            self._name(self._first(self.added))
            raise Stopped(self._first(self.added), self.added) from None
        except Exception as error:  # any error of any version of PyAV: the film is encoded, and stays
            self._name(self.path)
            why = error.diagnostics[0].message if isinstance(error, PlaygroundError) else reason(error)
            self.warning = f"{shown(self.path)} was written, but could not be checked: {why}"
            return
        if found == self.count and rate == self.fps:
            self._name(self.path)
            return
        renamed = self._first(found)
        self._name(renamed)
        raise DataError(
            f"the encoder wrote {found} pictures at {float(rate):g} a second, not {self.count} at "
            f"{float(self.fps):g}; they are kept in {renamed.name}",
            file=self.path,
        )

    def _close(self) -> None:
        """Write what the encoder still holds, and the end of the file."""
        self._mux(None)
        with writing(self.path):
            self._container.close()

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
        self._close()
        with suppress(Exception, KeyboardInterrupt):  # then the count is what was added
            self.added, _ = count_pictures(self._partial.path)
        path = self._first(self.added)
        self._name(path)
        return path


def has_alpha(picture: NDArray[np.uint8]) -> bool:
    """Return whether a picture, (height, width, 3 or 4) bytes, is not opaque somewhere."""
    return picture.shape[2] == 4 and bool((picture[..., 3] < 255).any())


def alpha_note(dropped: int, count: int, what: str) -> str:
    """Return a sentence on pictures whose alpha a film or sheet could not keep; "" for none."""
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
    if max(size) > _LONGEST:
        raise ParameterError(f"a video of {width} x {height} pixels: at most {_LONGEST} a side")
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
    module = _pyav()
    try:
        with module.open(str(path), format=None) as container:
            stream = container.streams.video[0]
            rate = Fraction(stream.average_rate or 0)  # a closed container has none
            packets = [packet for packet in container.demux(stream) if packet.size]
            times = sorted(packet.pts * packet.time_base for packet in packets if packet.pts is not None)
    except (OSError, IndexError, ValueError) as error:
        raise DataError(f"cannot be read back: {reason(error)}", file=Path(path)) from None
    if len(times) > 1 and times[-1] > times[0]:  # what is written is times; some formats round to thousandths
        mean = Fraction(len(times) - 1) / (times[-1] - times[0])
        near = rate and abs(mean / rate - 1) < Fraction(1, 100)
        rate = rate if near else mean.limit_denominator(1001)
    return len(packets), rate


def _pyav() -> Any:
    try:
        import av
    except ImportError:
        raise ContextError(
            'a video needs PyAV: python -m pip install "terrain-shader-playground[video]", or '
            "python -m pip install av; --frames writes PNG files without it"
        ) from None
    return av
