"""Show a video file at any time: the frame is a function of the time alone.

A first pass over the file, which decodes nothing, lists when each frame is shown. A frame is then
decoded from the last key frame before it, so that it is the same as in a film that is played from its
start; the decoder stays where it is, so that playing on costs one frame. A container that does not say
when each frame is shown (AVI) is decoded from its start, and its frames are counted.
"""

from __future__ import annotations

from bisect import bisect_right
from collections import OrderedDict
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.images.bounds import refuse_bomb, refuse_too_many
from playground.images.content_hash import content_key
from playground.media.pyav import VIDEO_FILES, decodable, decoding, open_media

if TYPE_CHECKING:
    import av.container
    import av.video

_WHAT = "a video file"
_MOST_FRAMES = 2**22  # 19 hours at 60 frames a second
_HELD_BYTES = 2**26  # of decoded frames, for what is shown again or backwards
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
        self._held: OrderedDict[int, Any] = OrderedDict()

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
        frame = self._held.get(number)
        if frame is None:
            frame = self._decoded(number)
            self._hold(number, frame)
        self._held.move_to_end(number)
        with decoding(self.path, f"frame {number}"):
            return as_pixels(frame, size)

    def _decoded(self, number: int) -> Any:
        """Decode up to a frame, from where the decoder is or from the last key frame before it."""
        keys = self._index.keys
        key = keys[max(bisect_right(keys, number) - 1, 0)] if keys else 0
        if self._frames is None or number <= self._last or key > self._last + 1:
            self._restart(key)
        found = self._read_until(number)
        if found is None and key:  # the demuxer went too far
            self._restart(0)
            found = self._read_until(number)
        if found is None:
            raise DataError(
                f"frame {number} cannot be decoded: the file is damaged or cut short", file=self.path
            )
        return found

    def _read_until(self, number: int) -> Any:
        """Decode on; return the frame, or the one before it that stays where it does not come out."""
        found = self._latest
        if self._frames is None:
            return found
        with decoding(self.path, f"frame {number} (at {self._index.times[number]:.3g} s)"):
            for at, frame in self._frames:
                self._judge(frame.width, frame.height)
                self._last, self._latest = at, frame
                self._hold(at, frame)
                if at >= number:
                    return frame if at == number else found
                found = frame
        return found

    def _restart(self, key: int) -> None:
        if self._container is not None:
            self._container.close()
        self._container = self._open()
        self._frames = self._numbered(self._container, key)
        self._last, self._latest = -1, None

    def _numbered(self, container: av.container.InputContainer, key: int) -> Iterator[tuple[int, Any]]:
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
        self._held[number] = frame
        self._held.move_to_end(number)
        most = max(_HELD_BYTES // (frame.width * frame.height * 4), 2)
        while len(self._held) > most:
            self._held.popitem(last=False)

    def _open(self) -> av.container.InputContainer:
        container = open_media(self.path, _WHAT, VIDEO_FILES)
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
        if len(shown) > _MOST_FRAMES:
            raise DataError(f"more than {_MOST_FRAMES} frames are too many", file=path)
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


@lru_cache(maxsize=4)
def _film(path: str, content: str) -> Film:
    return Film(Path(path))


def film_of(path: Path) -> Film:
    """Return an open film, anew where its file has changed. Raises ``DataError`` as ``Film`` does."""
    return _film(str(path), content_key(path))
