"""Which file endings pictures and values have."""

from __future__ import annotations

PICTURE_ENDINGS = (".png", ".jpg", ".jpeg", ".webp", ".tif", ".tiff")
"""What a picture is written as; one that is drawn in parts as the first."""

VALUE_ENDINGS: dict[str, str] = {
    ".npy": "float32, south row first",
    ".png": "16 bits, 0 to 1",
    ".tif": "float32",
    ".tiff": "float32",
}
"""What a grid of values is written as, and what the file then holds."""

VIDEO_ENDINGS: dict[str, str] = {".mp4": "H.264", ".webm": "VP9", ".gif": "256 colours"}
"""What a video is written as."""
