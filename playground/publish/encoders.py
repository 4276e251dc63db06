"""Encode a video by FFmpeg: by PyAV where it is installed, else by the program ``ffmpeg`` on PATH.

Both have the same encoders and options. The program is fed with raw frames through a pipe, and
``ffprobe``, which comes with it, reads videos back.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import tempfile
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from playground.errors import ContextError, DataError
from playground.extras import needs
from playground.files import reason

if TYPE_CHECKING:
    import av.container

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
