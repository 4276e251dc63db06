"""Open a film or a sound with PyAV, and say in one sentence what is wrong with it.

PyAV is an extra, and brings FFmpeg's decoders. Only the formats listed here are opened, and nothing but
the file itself is read: a playlist under the name of a film would lead to other files, or to a network.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from playground.errors import ContextError, DataError
from playground.extras import needs
from playground.images.files import checked_file, reason

if TYPE_CHECKING:
    import av.audio
    import av.container
    import av.video

    Stream = TypeVar("Stream", av.audio.AudioStream, av.video.VideoStream)

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
        found: av.container.InputContainer = module.open(str(path), "r", options=dict(_OPTIONS), **lenient)
    except (module.FFmpegError, OSError, ValueError) as error:
        message = f"not {what} that can be read ({_why(error)}); expected {listed}"
        raise DataError(message, file=path) from None
    return found


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
