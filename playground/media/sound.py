"""Hear a sound file at any time: its samples around that time, decoded from its start, once.

Samples are brought to one rate, which is what other tools' shaders are told (``iSampleRate``), and to one or
two channels. What comes before the first and after the last sample is silence, unless the file loops.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.images.bounds import ALWAYS_FINE
from playground.images.content_hash import content_key
from playground.media.pyav import SOUND_FILES, decodable, decoding, open_media, pyav

if TYPE_CHECKING:
    import av.container

RATE = 44_100  # [Hz]
_WHAT = "a sound file"
_MOST_BYTES = ALWAYS_FINE  # of samples: 25 minutes in stereo


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
        length, found = self._count, np.zeros((self.channels, count), np.float32)
        if not length:
            return found
        indices = np.arange(max(first, 0), max(end, 0))
        if loop and self._ended:
            indices %= length
        there = indices < length
        found[:, count - len(indices) :][:, there] = self._samples[:, indices[there]]
        return found

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
        resampler: Any = pyav(_WHAT).AudioResampler(format="fltp", layout=layout, rate=RATE)
        with decoding(self.path, f"its sound after {self._count / RATE:.3g} s"):
            for frame in self._container.decode(self._stream):
                yield from (part.to_ndarray() for part in resampler.resample(frame))
            yield from (part.to_ndarray() for part in resampler.resample(None))

    def _open(self) -> av.container.InputContainer:
        container = open_media(self.path, _WHAT, SOUND_FILES)
        if not container.streams.audio:
            container.close()
            raise DataError("it has no sound", file=self.path)
        return container

    def _judge(self, count: int) -> None:
        if count * self.channels * 4 > _MOST_BYTES:
            most = _MOST_BYTES // (self.channels * 4 * RATE * 60)
            raise DataError(
                f"{count / RATE / 60:.0f} minutes of sound are too many; the limit is {most}", file=self.path
            )


@lru_cache(maxsize=4)
def _sound(path: str, content: str) -> Sound:
    return Sound(Path(path))


def sound_of(path: Path) -> Sound:
    """Return an open sound, anew where its file has changed. Raises ``DataError`` as ``Sound`` does."""
    return _sound(str(path), content_key(path))
