"""Encode pictures as a video, one by one, into a file that is whole or not there.

FFmpeg encodes (see ``encoders``). The pictures are sRGB: they become BT.709 Y'CbCr of limited
range, and the file says so, which every player shows as it was drawn; each second pixel has
a colour of its own, all have their brightness. A GIF has 256 colours a picture, chosen for
each. Alpha is dropped, and counted: ``Video.dropped``.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from playground.data.image_files import VIDEO_ENDINGS
from playground.engine.engine import Engine
from playground.engine.plain_forms import warn
from playground.errors import ContextError, DataError, ParameterError, PlaygroundError, nearest
from playground.extras import needs
from playground.files import partial_file, reason, writing
from playground.paths import shown
from playground.publish.series import (
    DEFAULT_SIZE,
    FPS,
    Add,
    Series,
    alpha_note,
    engine_or_own,
    has_alpha,
    write_series,
)
from playground.sketch.model import Sketch

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
    video, as ``film-first-120.mp4``, and ``Stopped`` has its name; without ``names_shorter`` a video of
    fewer pictures takes the name itself.

    Raises ``DataError``, ``ParameterError`` or ``ContextError`` in a message for another
    ending, odd sides, a rate that a GIF has not, a missing folder, and where nothing encodes.
    """

    def __init__(
        self,
        path: str | Path,
        size: tuple[int, int],
        fps: Fraction,
        count: int,
        *,
        quality: str = QUALITY,
        names_shorter: bool = True,
    ) -> None:
        self.path = Path(path).expanduser()
        self._names_shorter = names_shorter
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
        if not self._names_shorter:
            return self.path
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
    names_shorter: bool = True

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
        how: dict[str, Any] = {"quality": self.quality, "names_shorter": self.names_shorter}
        with Video(self.path, series.size, series.fps, series.count, **how) as video:
            yield lambda picture: video.add(picture.array)
        for note in (video.warning, alpha_note(video.dropped, series.count, "the video")):
            if note:
                notice(note)


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


# ── FFmpeg, by PyAV or by the program ──────────────────────────────────────────


_BT709, _LIMITED = 1, 1  # as in ITU-T H.273


@dataclass(frozen=True)
class Codec:
    """How a kind of video is encoded, by FFmpeg's names."""

    form: str
    encoder: str
    pixels: str
    options: Mapping[str, str]


class Encoder(Protocol):
    """Write pictures into a file, one by one."""

    def add(self, picture: NDArray[np.uint8], number: int) -> None:
        """Encode a picture, (height, width, 3 or 4) bytes, top row first, sRGB."""

    def finish(self) -> None:
        """Write what the encoder still holds, and the end of the file."""

    def close(self) -> None:
        """Let go of the file, finished or not."""


def open_encoder(path: Path, codec: Codec, size: tuple[int, int], fps: Fraction) -> Encoder:
    """Open an encoder that writes to ``path``, and raises ``OSError`` where that fails.

    Raises ``ContextError`` where there is none, or not this one.
    """
    if module := _pyav():
        return _Pyav(module, path, codec, size, fps)
    return _Program(_program("ffmpeg"), path, codec, size, fps)


def read_packets(path: Path) -> tuple[Fraction, list[Fraction | None]]:
    """Return the pictures a second that a video's file says, 0 for none, and the time of each packet.

    Nothing is decoded. Raises ``DataError`` for what is no video.
    """
    read = _packets_of_pyav if _pyav() else _packets_of_ffprobe
    try:
        return read(path)
    except (OSError, LookupError, ValueError) as error:
        raise DataError(f"cannot be read back: {reason(error)}", file=path) from None


def missing_encoder() -> str:
    """Return what is missing for a video, and how to get it; "" where one can be written."""
    if _pyav() is not None or shutil.which("ffmpeg"):
        return ""
    return needs("a video", "PyAV, or the program ffmpeg on PATH", "video")


def _pyav() -> Any:
    try:
        import av
    except ImportError:
        return None
    return av


def _program(name: str) -> str:
    path = shutil.which(name)
    if path is None:
        ways = needs("a video", f"PyAV, or the program {name} on PATH", "video")
        raise ContextError(f"{ways}; --frames writes PNG files without either")
    return path


def _indexed(picture: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Return a picture's indices and its 256 colours: alpha, red, green, blue."""
    import PIL.Image

    indexed = PIL.Image.fromarray(np.ascontiguousarray(picture[..., :3])).quantize(256)
    colours = np.zeros((256, 4), np.uint8)
    palette = np.array(indexed.getpalette() or [], np.uint8).reshape(-1, 3)[:256]
    colours[: len(palette), 1:], colours[:, 0] = palette, 255
    return np.array(indexed, np.uint8), colours


class _Pyav:
    def __init__(self, module: Any, path: Path, codec: Codec, size: tuple[int, int], fps: Fraction) -> None:
        self._av, self._indexes, self._fps = module, codec.pixels == "pal8", fps
        moved = {"movflags": "+faststart"} if codec.form == "mp4" else {}
        try:
            self._container: av.container.OutputContainer = module.open(
                str(path), "w", format=codec.form, options=moved
            )
            self._stream: Any = self._container.add_stream(
                codec.encoder, rate=fps, options=dict(codec.options)
            )
        except ValueError as error:  # an encoder that this build has not
            raise ContextError(f"this PyAV cannot write {codec.form}: {reason(error)}") from None
        self._stream.width, self._stream.height = size
        self._stream.pix_fmt = codec.pixels
        self._stream.time_base = 1 / fps
        if not self._indexes:
            context = self._stream.codec_context
            context.color_primaries = context.color_trc = context.colorspace = _BT709
            context.color_range = _LIMITED

    def add(self, picture: NDArray[np.uint8], number: int) -> None:
        if self._indexes:
            frame = self._av.VideoFrame.from_ndarray(_indexed(picture), format="pal8")
        else:
            rgb = self._av.VideoFrame.from_ndarray(np.ascontiguousarray(picture[..., :3]), format="rgb24")
            frame = rgb.reformat(
                format="yuv420p",
                src_colorspace="ITU709",
                dst_colorspace="ITU709",
                src_color_range="JPEG",
                dst_color_range="MPEG",
                interpolation="AREA",
            )
        frame.pts, frame.time_base = number, 1 / self._fps
        self._mux(frame)

    def finish(self) -> None:
        self._mux(None)
        self._container.close()

    def close(self) -> None:
        self._container.close()

    def _mux(self, frame: Any) -> None:
        for packet in self._stream.encode(frame):
            self._container.mux(packet)


class _Program:
    def __init__(self, program: str, path: Path, codec: Codec, size: tuple[int, int], fps: Fraction) -> None:
        self._indexes = codec.pixels == "pal8"
        command = [program, "-v", "error", "-nostdin", "-y", "-f", "rawvideo"]
        command += ["-pix_fmt", "pal8" if self._indexes else "rgb24"]
        command += ["-s", f"{size[0]}x{size[1]}", "-r", str(fps), "-i", "pipe:0", "-c:v", codec.encoder]
        for key, value in codec.options.items():
            command += [f"-{key}:v", value]
        if not self._indexes:
            scale = "scale=in_range=full:out_range=limited:in_color_matrix=bt709:out_color_matrix=bt709"
            command += ["-vf", f"{scale}:flags=area,format={codec.pixels}", "-color_range", "tv"]
            for key in ("color_primaries", "color_trc", "colorspace"):
                command += [f"-{key}", "bt709"]
        if codec.form == "mp4":
            command += ["-movflags", "+faststart"]
        if codec.form == "gif":  # how long the last picture is shown
            command += ["-final_delay", str(int(100 / fps))]
        self._errors = tempfile.TemporaryFile()
        self._process = subprocess.Popen(
            [*command, "-f", codec.form, _of_file(path)],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=self._errors,
            start_new_session=True,  # a Ctrl-C in our terminal is ours: the film is finished
        )

    def add(self, picture: NDArray[np.uint8], number: int) -> None:
        if self._indexes:
            indices, colours = _indexed(picture)
            data = indices.tobytes() + colours[:, ::-1].tobytes()
        else:
            data = picture[..., :3].tobytes()
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(data)
        except BrokenPipeError:
            self.finish()
            raise

    def finish(self) -> None:
        self._close_pipe()
        if self._process.wait():
            self._errors.seek(0)
            message = self._errors.read().decode(errors="replace").strip().partition("\n")[0]
            raise OSError(f"ffmpeg: {message}")

    def close(self) -> None:
        if self._process.poll() is None:
            self._process.kill()
        self._close_pipe()
        self._process.wait()
        self._errors.close()

    def _close_pipe(self) -> None:
        assert self._process.stdin is not None
        with suppress(BrokenPipeError):  # it has ended
            self._process.stdin.close()


def _packets_of_pyav(path: Path) -> tuple[Fraction, list[Fraction | None]]:
    with _pyav().open(str(path), format=None) as container:
        stream = container.streams.video[0]
        packets = [packet for packet in container.demux(stream) if packet.size]
        times = [None if packet.pts is None else packet.pts * packet.time_base for packet in packets]
        return Fraction(stream.average_rate or 0), times  # a closed container has none


def _packets_of_ffprobe(path: Path) -> tuple[Fraction, list[Fraction | None]]:
    command = [_program("ffprobe"), "-v", "error", "-select_streams", "v:0", "-of", "json"]
    command += [
        "-show_entries",
        "stream=avg_frame_rate,r_frame_rate,time_base:packet=pts,size",
        _of_file(path),
    ]
    done = subprocess.run(command, capture_output=True, stdin=subprocess.DEVNULL, start_new_session=True)
    if done.returncode:
        raise ValueError(done.stderr.decode(errors="replace"))
    report = json.loads(done.stdout)
    stream = report["streams"][0]
    base = Fraction(stream["time_base"])
    packets = [packet for packet in report["packets"] if int(packet["size"])]
    times = [packet["pts"] * base if "pts" in packet else None for packet in packets]
    rates = (stream["avg_frame_rate"], stream["r_frame_rate"])  # a GIF of one picture has no average
    return next((Fraction(rate) for rate in rates if not rate.endswith("/0")), Fraction(0)), times


def _of_file(path: Path) -> str:
    """Return a path as FFmpeg takes it for nothing but a file."""
    return f"file:{path.absolute()}"
