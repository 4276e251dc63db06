"""Convert colours between linear light and sRGB's encoding.

Source: IEC 61966-2-1:1999, the exact two-piece curve.
"""

from __future__ import annotations

import re
from collections.abc import Sequence


def decode(encoded: float) -> float:
    """Return the linear light of one sRGB-encoded channel, both 0..1."""
    return encoded / 12.92 if encoded <= 0.04045 else ((encoded + 0.055) / 1.055) ** 2.4


def encode(linear: float) -> float:
    """Return one channel of linear light, 0..1, encoded as sRGB."""
    return linear * 12.92 if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055


def parse_hex(text: str) -> tuple[float, float, float, float]:
    """Return linear RGB and alpha of ``#rgb``, ``#rrggbb`` or ``#rrggbbaa``; raise ``ValueError`` in a sentence."""
    if not re.fullmatch(r"#([0-9A-Fa-f]{3}|[0-9A-Fa-f]{6}|[0-9A-Fa-f]{8})", text):
        raise ValueError(f"'{text}' is not a colour; expected #rrggbb, as #8a9a5b")
    digits = text[1:] if len(text) > 4 else "".join(c * 2 for c in text[1:])
    channels = [int(digits[i : i + 2], 16) / 255 for i in range(0, len(digits), 2)]
    alpha = channels[3] if len(channels) == 4 else 1.0
    return decode(channels[0]), decode(channels[1]), decode(channels[2]), alpha


def to_hex(linear: Sequence[float]) -> str:
    """Return linear RGB (and alpha) as ``#rrggbb`` (``#rrggbbaa``), clamped to 0..1."""
    channels = [encode(min(max(c, 0.0), 1.0)) for c in linear[:3]] + [min(max(a, 0.0), 1.0) for a in linear[3:4]]
    return "#" + "".join(f"{round(c * 255):02x}" for c in channels)
