"""Make films and sounds to be read: colours and tones that are known."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest

RATE = 44_100


def colour(number: int) -> tuple[int, int, int]:
    """Return the colour of a frame: no two of the first two hundred are near."""
    return (number * 41) % 256, (number * 97 + 60) % 256, (number * 29 + 120) % 256


def frame(number: int, size: tuple[int, int]) -> np.ndarray:
    """Return a frame, (height, width, 4), its upper left quarter black."""
    width, height = size
    made = np.full((height, width, 4), 255, np.uint8)
    made[..., :3] = colour(number)
    made[: height // 2, : width // 2, :3] = 0
    return made


def own_film(path: Path, count: int = 40, fps: int = 25, size: tuple[int, int] = (64, 48)) -> Path:
    """Write a film by what films sketches; without that room, skip the test."""
    with pytest.importorskip("playground.publish.video").Video(
        path, size, Fraction(fps), count, quality="best"
    ) as video:
        for number in range(count):
            video.add(frame(number, size))
    return path


def uneven_film(
    path: Path, stamps: Sequence[int], codec: str = "libx264", size: tuple[int, int] = (64, 48)
) -> Path:
    """Write a film whose frames are shown at these thousandths of a second."""
    lossless = codec in ("ffv1", "png")
    with av.open(str(path), "w") as container:
        stream = container.add_stream(codec, rate=1000, options={"crf": "1", "g": "8"})
        stream.width, stream.height = size
        stream.pix_fmt = "bgr0" if codec == "ffv1" else "rgb24" if codec == "png" else "yuv420p"
        stream.time_base = Fraction(1, 1000)
        for number, stamp in enumerate(stamps):
            made = av.VideoFrame.from_ndarray(np.ascontiguousarray(frame(number, size)[..., :3]), "rgb24")
            made = (
                made.reformat(format=stream.pix_fmt)
                if lossless
                else made.reformat(format="yuv420p", dst_colorspace="ITU601", interpolation="AREA")
            )
            made.pts, made.time_base = stamp, Fraction(1, 1000)
            container.mux(stream.encode(made))
        container.mux(stream.encode(None))
    return path


def sound(path: Path, samples: np.ndarray, rate: int = RATE) -> Path:
    """Write a sound, (channels, count), -1..1; 16 bits in .wav and .flac."""
    codec = {".wav": "pcm_s16le", ".flac": "flac", ".mp3": "libmp3lame", ".m4a": "aac", ".ogg": "libopus"}
    layout = "mono" if len(samples) == 1 else "stereo"
    with av.open(str(path), "w") as container:
        written = 48_000 if path.suffix == ".ogg" else rate  # Opus has no other near it
        stream = container.add_stream(codec[path.suffix], rate=written, layout=layout)
        form = {"flac": "s16", "pcm_s16le": "s16", "libopus": "flt"}.get(codec[path.suffix], "fltp")
        value = av.AudioFrame.from_ndarray(samples.astype(np.float32), format="fltp", layout=layout)
        value.sample_rate, value.pts = rate, 0
        stream.codec_context.format = form
        resampler = av.AudioResampler(format=form, layout=layout, rate=written, frame_size=960)
        for part in (*resampler.resample(value), *resampler.resample(None)):
            container.mux(stream.encode(part))
        container.mux(stream.encode(None))
    return path
