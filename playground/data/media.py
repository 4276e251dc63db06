"""Films and sounds at any time: frames, samples, the spectrum.

PyAV is an extra, and brings FFmpeg's decoders. Only the formats listed here are opened, and nothing but
the file itself is read: a playlist under the name of a film would lead to other files, or to a network.

A first pass over the file, which decodes nothing, lists when each frame is shown. A frame is then
decoded from the last key frame before it, so that it is the same as in a film that is played from its
start; the decoder stays where it is, so that playing on costs one frame. A container that does not say
when each frame is shown (AVI) is decoded from its start, and its frames are counted.

Samples are brought to one rate, which is what other tools' shaders are told (``iSampleRate``), and to one or
two channels. What comes before the first and after the last sample is silence, unless the file loops.

W3C, Web Audio API (2021), section 1.8, AnalyserNode, with its defaults, as Shadertoy has it: a window of
2048 samples, Blackman's, then a Fourier transform, smoothed over time, in decibels from -100 to -30. A
browser smooths over the frames that it happened to show; here the frames are those of sixty a second
before the time in question, so that the result is a function of that time.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from math import exp, pi, sin
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from playground.data.bounds import ALWAYS_FINE, refuse_bomb, refuse_too_many
from playground.data.content_hash import content_key
from playground.errors import ContextError, DataError
from playground.extras import needs
from playground.files import checked_file, reason
from playground.memo import SOURCES, Memo

if TYPE_CHECKING:
    import av.audio
    import av.container
    import av.video

    Stream = TypeVar("Stream", av.audio.AudioStream, av.video.VideoStream)
    import av.container
    import av.video


VIDEO_FILES = (".mp4", ".mov", ".webm", ".mkv", ".gif", ".avi")
SOUND_FILES = (".wav", ".mp3", ".ogg", ".flac", ".m4a")
_FORMATS = "mov,matroska,gif,avi,wav,mp3,ogg,flac"  # FFmpeg's names; m4a is one of mov's
_OPTIONS = {"format_whitelist": _FORMATS, "protocol_whitelist": "file"}


def pyav(what: str) -> Any:
    """Return PyAV's module; raise ``ContextError`` where it is missing. ``what``: "a video file"."""
    try:
        import av
    except ImportError:
        raise ContextError(needs(what, "PyAV", "video")) from None
    # What a decoder has to say goes nowhere: errors are exceptions. So it is by default, and no level is set:
    # at any, a decoder's threads wait for Python's lock to say it, which who closes a film holds, for ever.
    return av


def open_media(path: Path, what: str, endings: tuple[str, ...]) -> av.container.InputContainer:
    """Open a film or a sound, which is recognised by its content.

    Raises ``DataError`` for a file that is missing, damaged or of another format, ``ContextError`` where
    PyAV is missing.
    """
    module = pyav(what)
    checked_file(path)
    listed = ", ".join(ending[1:] for ending in endings)
    try:
        # Metadata need not be UTF-8; from version 19 on PyAV escapes what is not, and has no such option.
        lenient = {"metadata_errors": "replace"} if int(module.__version__.split(".")[0]) < 19 else {}
        container: av.container.InputContainer = module.open(
            str(path), "r", options=dict(_OPTIONS), **lenient
        )
    except (module.FFmpegError, OSError, ValueError) as error:
        message = f"not {what} that can be read ({_why(error)}); expected {listed}"
        raise DataError(message, file=path) from None
    return container


def decodable(streams: Sequence[Stream], what: str, path: Path) -> Stream:
    """Return the first stream that FFmpeg has a decoder for; ``what`` is "sound" or "picture".

    Raises ``DataError`` where there is none: PyAV gives such a stream no codec context.
    """
    for stream in streams:
        if stream.codec_context is not None:
            return stream
    raise DataError(f"its {what} is in a codec that this FFmpeg cannot decode", file=path)


@contextmanager
def decoding(path: Path, what: str) -> Iterator[None]:
    """Raise an error of a decoder as a ``DataError``: ``what`` cannot be decoded."""
    module = pyav("a video or sound file")
    try:
        yield
    except (module.FFmpegError, OSError, ValueError, MemoryError) as error:
        raise DataError(f"{what} cannot be decoded: {_why(error)}", file=path) from None


def _why(error: BaseException) -> str:
    """Return in a few words what an error of FFmpeg means; it names the file as well, which is known."""
    text = getattr(error, "strerror", "") or reason(error)
    return text[:1].lower() + text[1:]


_VIDEO = "a video file"
_MAX_FRAMES = 2**22  # 19 hours at 60 frames a second
HELD_BYTES = 2**26  # of decoded frames, for what is shown again or backwards
_MARGIN = 1e-6  # [s] a time is meant to be that of the frame that begins so little later
_UNORDERED = ("avi",)  # their packets have the times at which they are decoded, not shown
_HIGH = 720  # [pixels] from this height on a film that does not say its colours is BT.709, below BT.601
_BT601, _BT709, _UNSAID = 5, 1, 2


@dataclass(frozen=True)
class _Index:
    """When the frames of a film are shown."""

    times: tuple[float, ...]  # [s] from the first frame's, increasing
    stamps: tuple[int, ...]  # the same in the stream's own units; empty where frames are counted
    keys: tuple[int, ...]  # frames from which decoding may start
    duration: float  # [s] from the first frame's time to the end of the last


class Film:
    """A video file, open to show one frame after another.

    Raises ``DataError`` for a file that cannot be read, has no picture or would take too much memory.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        with self._open() as container:
            stream = decodable(container.streams.video, "picture", path)
            width, height = stream.codec_context.width, stream.codec_context.height
            if width < 1 or height < 1:
                raise DataError("its frames have no size", file=path)
            self._judge(width, height)
            with decoding(path, "the list of its frames"):
                self._index = _indexed(container, stream, path)
            with decoding(path, "its first frame"):
                container.seek(0)
                first = next(container.decode(stream), None)
        if first is None:
            raise DataError("its first frame cannot be decoded: the file is damaged or cut short", file=path)
        turned = first.rotation % 180 != 0
        self.size = (height, width) if turned else (width, height)  # pixels, as it is to be shown
        self._frames: Iterator[tuple[int, Any]] | None = None
        self._container: av.container.InputContainer | None = None
        self._last = -1  # the frame decoded last
        self._latest: Any = None
        self.held: Memo[int, Any] = Memo(f"frames of {path.name}", 0, "bytes")

    @property
    def duration(self) -> float:
        """Seconds from the first frame's time to the end of the last."""
        return self._index.duration

    @property
    def count(self) -> int:
        """How many frames it has."""
        return len(self._index.times)

    @property
    def times(self) -> tuple[float, ...]:
        """Seconds after the first frame's time at which each frame begins."""
        return self._index.times

    def frame_at(self, seconds: float, *, loop: bool) -> int:
        """Return which frame, from 0, is shown at a time after the first frame's.

        Before the first it is the first, after the end the last, unless it ``loop``s.
        """
        time = seconds + _MARGIN
        if loop:
            time %= self._index.duration
        return max(bisect_right(self._index.times, time) - 1, 0)

    def pixels(self, number: int, size: tuple[int, int]) -> NDArray[np.uint8]:
        """Return a frame as (ny, nx, 4) bytes, encoded as in the file, row 0 south.

        To a smaller size it is averaged over areas, to a larger one interpolated bilinearly.
        """
        frame = self.held.get(number)
        if frame is None:
            frame = self._decoded(number)
            self._hold(number, frame)
        with decoding(self.path, f"frame {number}"):
            return as_pixels(frame, size)

    def _decoded(self, number: int) -> Any:
        """Decode up to a frame, from where the decoder is or from the last key frame before it."""
        keys = self._index.keys
        key = keys[max(bisect_right(keys, number) - 1, 0)] if keys else 0
        if self._frames is None or number <= self._last or key > self._last + 1:
            self._restart(key)
        value = self._read_until(number)
        if value is None and key:  # the demuxer went too far
            self._restart(0)
            value = self._read_until(number)
        if value is None:
            raise DataError(
                f"frame {number} cannot be decoded: the file is damaged or cut short", file=self.path
            )
        return value

    def _read_until(self, number: int) -> Any:
        """Decode on; return the frame, or the one before it that stays where it does not come out."""
        value = self._latest
        if self._frames is None:
            return value
        with decoding(self.path, f"frame {number} (at {self._index.times[number]:.3g} s)"):
            for at, frame in self._frames:
                self._judge(frame.width, frame.height)
                self._last, self._latest = at, frame
                self._hold(at, frame)
                if at >= number:
                    return frame if at == number else value
                value = frame
        return value

    def _restart(self, key: int) -> None:
        if self._container is not None:
            self._container.close()
        self._container = self._open()
        self._frames = self.numbered_frames(self._container, key)
        self._last, self._latest = -1, None

    def numbered_frames(self, container: av.container.InputContainer, key: int) -> Iterator[tuple[int, Any]]:
        """Yield frames with their numbers, from a key frame on."""
        stamps = self._index.stamps
        stream = decodable(container.streams.video, "picture", self.path)
        stream.thread_type = "AUTO"
        if not stamps:
            yield from enumerate(container.decode(stream))
            return
        if key:
            container.seek(stamps[key], stream=stream, backward=True)
        for frame in container.decode(stream):
            # What comes before the key frame may lack what it was predicted from.
            if frame.pts is not None and frame.pts >= stamps[key]:
                yield bisect_right(stamps, frame.pts) - 1, frame

    def _hold(self, number: int, frame: Any) -> None:
        size = frame.width * frame.height * 4
        self.held.bound = max(HELD_BYTES, 2 * size)
        self.held.put(number, frame, size)

    def _open(self) -> av.container.InputContainer:
        container = open_media(self.path, _VIDEO, VIDEO_FILES)
        if not container.streams.video:
            has_sound = bool(container.streams.audio)
            container.close()
            hint = "it has sound and no picture; foreign/sound reads sound"
            raise DataError(hint if has_sound else "it has no picture", file=self.path)
        return container

    def _judge(self, width: int, height: int) -> None:
        refuse_too_many(self.path, width, height)
        refuse_bomb(self.path, width * height * 4, self.path.stat().st_size)


def _indexed(container: av.container.InputContainer, stream: av.video.VideoStream, path: Path) -> _Index:
    """List a film's frames without decoding them."""
    unit = float(stream.time_base or 1)
    shown: list[tuple[int, bool]] = []
    ordered = not set(container.format.name.split(",")) & set(_UNORDERED)
    last = 0
    for packet in container.demux(stream):
        if not packet.size or packet.is_discard:
            continue
        stamp = packet.pts if ordered else packet.dts
        ordered = ordered and stamp is not None
        shown.append((len(shown) if stamp is None else stamp, packet.is_keyframe))
        last = max(last, packet.duration or 0)
        if len(shown) > _MAX_FRAMES:
            raise DataError(f"more than {_MAX_FRAMES} frames are too many", file=path)
    if not shown:
        raise DataError("it has no frames: the file is damaged or cut short", file=path)
    shown.sort()
    stamps = [stamp for stamp, _ in shown]
    times = tuple((stamp - stamps[0]) * unit for stamp in stamps)
    mean = times[-1] / (len(times) - 1) if len(times) > 1 else 1.0
    keys = tuple(number for number, (_, is_key) in enumerate(shown) if is_key)
    duration = times[-1] + (last * unit or mean)
    return _Index(times, tuple(stamps) if ordered else (), keys if ordered else (), duration)


def as_pixels(frame: Any, size: tuple[int, int]) -> NDArray[np.uint8]:
    """Return a frame of PyAV as (ny, nx, 4) bytes, row 0 south, at another size if need be."""
    quarters = round(frame.rotation / 90) % 4
    width, height = size[::-1] if quarters % 2 else size
    shrinks = width * height < frame.width * frame.height
    space = _UNSAID if frame.colorspace == _UNSAID else frame.colorspace
    if space == _UNSAID:
        space = _BT709 if frame.height >= _HIGH else _BT601
    rgb = frame.reformat(
        width=width,
        height=height,
        format="rgba",
        src_colorspace=space,
        dst_colorspace=space,
        dst_color_range="JPEG",
        interpolation="AREA" if shrinks else "BILINEAR",
    )
    array: NDArray[np.uint8] = rgb.to_ndarray()
    return np.ascontiguousarray(np.rot90(array, quarters)[::-1])


@SOURCES.cached(weight=HELD_BYTES)
def _film(path: str, content: str) -> Film:
    return Film(Path(path))


def film_of(path: Path) -> Film:
    """Return an open film, opened again where its file has changed. Raises ``DataError`` as ``Film`` does."""
    return _film(str(path), content_key(path))


RATE = 44_100  # [Hz]
_SOUND = "a sound file"
_WEIGHT = 2**26  # [bytes] of an open sound, about: it is decoded as far as it was heard
MAX_BYTES = ALWAYS_FINE  # of samples: 25 minutes in stereo


class Sound:
    """A sound file, decoded as far as it was heard.

    Raises ``DataError`` for a file that cannot be read, has no sound or is too long.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._container = self._open()
        self._stream = stream = decodable(self._container.streams.audio, "sound", path)
        if not stream.codec_context.channels or not stream.codec_context.sample_rate:
            raise DataError("its sound has no channels: the file is damaged or cut short", file=path)
        self.channels = min(stream.codec_context.channels, 2)
        if stream.duration and stream.time_base:
            self._judge(int(stream.duration * stream.time_base * RATE))
        self._samples = np.zeros((self.channels, RATE), np.float32)  # room for more than is there
        self._count = 0
        self._ended = False
        self._chunks = self._decoded()

    def heard(self, end: int, count: int, *, loop: bool) -> NDArray[np.float32]:
        """Return the ``count`` samples before sample ``end``, (channels, count), -1..1."""
        first = end - count
        self.decode_until(end)
        length, samples = self._count, np.zeros((self.channels, count), np.float32)
        if not length:
            return samples
        indices = np.arange(max(first, 0), max(end, 0))
        if loop and self._ended:
            indices %= length
        there = indices < length
        samples[:, count - len(indices) :][:, there] = self._samples[:, indices[there]]
        return samples

    def length(self, end: int) -> int | None:
        """Return the samples that it has, if they are fewer than ``end``; None otherwise."""
        self.decode_until(end)
        return self._count if self._ended and self._count < end else None

    def decode_until(self, end: int) -> None:
        """Decode at least up to a sample."""
        while self._count < end and not self._ended:
            chunk = next(self._chunks, None)
            if chunk is None:
                self._ended = True
                self._container.close()
                return
            self._judge(self._count + chunk.shape[1])
            while self._samples.shape[1] < self._count + chunk.shape[1]:
                self._samples = np.concatenate([self._samples, np.zeros_like(self._samples)], axis=1)
            self._samples[:, self._count : self._count + chunk.shape[1]] = chunk
            self._count += chunk.shape[1]

    def _decoded(self) -> Iterator[NDArray[np.float32]]:
        layout = "mono" if self.channels == 1 else "stereo"
        resampler: Any = pyav(_SOUND).AudioResampler(format="fltp", layout=layout, rate=RATE)
        with decoding(self.path, f"its sound after {self._count / RATE:.3g} s"):
            for frame in self._container.decode(self._stream):
                yield from (part.to_ndarray() for part in resampler.resample(frame))
            yield from (part.to_ndarray() for part in resampler.resample(None))

    def _open(self) -> av.container.InputContainer:
        container = open_media(self.path, _SOUND, SOUND_FILES)
        if not container.streams.audio:
            container.close()
            raise DataError("it has no sound", file=self.path)
        return container

    def _judge(self, count: int) -> None:
        if count * self.channels * 4 > MAX_BYTES:
            most = MAX_BYTES // (self.channels * 4 * RATE * 60)
            raise DataError(
                f"{count / RATE / 60:.0f} minutes of sound are too many; the limit is {most}", file=self.path
            )


@SOURCES.cached(weight=_WEIGHT)
def _sound(path: str, content: str) -> Sound:
    return Sound(Path(path))


def sound_of(path: Path) -> Sound:
    """Return an open sound, opened again where its file changed. Raises ``DataError`` as ``Sound`` does."""
    return _sound(str(path), content_key(path))


_TEMPO = 2.0  # beats a second


def bands_at(time: float) -> tuple[float, float, float]:
    """Return how strong low, middle and high tones are at a time [s], each 0..1: a drum and two swells."""
    since = time * _TEMPO % 1.0
    middle, high = (0.5 + 0.4 * sin(2 * pi * time / seconds) for seconds in (3.0, 1.3))
    return exp(-4.0 * since), middle, high


WINDOW = 2048  # samples
BINS = WINDOW // 2
SHOWN = 512  # bins, and samples of the wave, in Shadertoy's texture
_SMOOTHING = 0.8
_MIN_DECIBELS, _MAX_DECIBELS = -100.0, -30.0  # [dB]
_HOP = RATE // 60  # samples from one frame to the next
_FRAMES = 52  # what is older has less than 0.8 ** 52 = 1e-5 of its strength, which is -100 dB
SPAN = WINDOW + (_FRAMES - 1) * _HOP
"""The samples before a moment that its spectrum depends on."""


def _blackman() -> NDArray[np.float64]:
    turn = 2 * np.pi * np.arange(WINDOW) / WINDOW
    return 0.42 - 0.5 * np.cos(turn) + 0.08 * np.cos(2 * turn)


_BLACKMAN = _blackman()
_WEIGHTS = (1 - _SMOOTHING) * _SMOOTHING ** np.arange(_FRAMES)  # the newest frame first


def spectrum(samples: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return the spectrum after ``SPAN`` samples or more, -1..1: 1024 bytes, bin k at k * 44100 / 2048 Hz."""
    starts = SPAN - WINDOW - _HOP * np.arange(_FRAMES)
    latest = samples[-SPAN:].astype(np.float64)
    windows = np.lib.stride_tricks.sliding_window_view(latest, WINDOW)[starts]
    with np.errstate(under="ignore"):
        strengths = np.abs(np.fft.rfft(windows * _BLACKMAN, axis=1)[:, :BINS]) / WINDOW
        decibels = 20.0 * np.log10(np.maximum(_WEIGHTS @ strengths, 1e-30))
    scaled = 255.0 * (decibels - _MIN_DECIBELS) / (_MAX_DECIBELS - _MIN_DECIBELS)
    return np.floor(np.clip(scaled, 0.0, 255.0)).astype(np.uint8)


def wave(samples: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return samples, -1..1, as bytes: silence is 128."""
    return np.floor(np.clip(128.0 * (1.0 + samples.astype(np.float64)), 0.0, 255.0)).astype(np.uint8)


def channel(samples: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return Shadertoy's texture of a sound, (2, 512) bytes: the spectrum's lower half, then the wave.

    ``samples``: (channels, at least ``SPAN``), which are mixed.
    """
    mixed = samples.mean(axis=0)
    return np.stack([spectrum(mixed)[:SHOWN], wave(mixed[-WINDOW:][:SHOWN])])


def waves(samples: NDArray[np.float32], size: tuple[int, int]) -> NDArray[np.uint8]:
    """Return the last samples of each channel as ``size`` bytes: a row a channel, the first in row 0."""
    width, height = size
    return wave(_rows(samples, height)[:, -width:])


def spectra(samples: NDArray[np.float32], size: tuple[int, int]) -> NDArray[np.uint8]:
    """Return the spectrum of each channel as ``size`` bytes, up to half the rate; rows as ``waves`` has them.

    A texel has the largest of its bins, so that a pure tone shows in a narrow texture too.
    """
    width, height = size
    first = np.minimum(np.arange(width) * BINS // width, BINS - 1)
    return np.stack([np.maximum.reduceat(spectrum(row), first) for row in _rows(samples, height)])


def _rows(samples: NDArray[np.float32], height: int) -> NDArray[np.float32]:
    """Return a row for each of ``height`` channels: one is all of them mixed, more repeat the last."""
    if height == 1:
        return np.asarray(samples.mean(axis=0, keepdims=True), np.float32)
    return samples[np.minimum(np.arange(height), len(samples) - 1)]
