"""Colours: sRGB and linear light, and the hexadecimal text of a colour.

Every colour is linear inside the playground; encoded ones live only in files, in TOML and on the screen.
There is no other colour space here, and no tone mapping (that is `view/present`).
Source: IEC 61966-2-1:1999 with Amendment 1 (2003), clause 5.2: the exact piecewise curve, not the power 2.2.
Its printed thresholds (0.04045 and 0.0031308) leave a step of less than 1e-7 between the pieces, far below
the 1/255 of a byte.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from playground.errors import DataError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

_HEX = re.compile(r"#(?:[0-9a-f]{3}|[0-9a-f]{6}|[0-9a-f]{8})", re.IGNORECASE | re.ASCII)


def srgb_to_linear(encoded: ArrayLike) -> NDArray[np.float64]:
    """Decode sRGB to linear light, component by component.

    `encoded` is 0..1, any shape (divide bytes by 255 first); the result is
    float64 of that shape. Below 0 the straight piece goes on, above 1 the
    curve does. Alpha is never encoded: leave it out.
    """
    import numpy as np  # a tenth of a second, which to list the sketches need not cost

    c = np.asarray(encoded, dtype=np.float64)
    curve = ((np.maximum(c, 0.04045) + 0.055) / 1.055) ** 2.4
    return np.asarray(np.where(c <= 0.04045, c / 12.92, curve))


def linear_to_srgb(linear: ArrayLike) -> NDArray[np.float64]:
    """Encode linear light as sRGB: the inverse of `srgb_to_linear`, same shapes."""
    import numpy as np  # as above

    c = np.asarray(linear, dtype=np.float64)
    curve = 1.055 * np.maximum(c, 0.0031308) ** (1.0 / 2.4) - 0.055
    return np.asarray(np.where(c <= 0.0031308, 12.92 * c, curve))


def parse_hex(text: str, *, raw: bool = False) -> tuple[float, ...]:
    """Read `"#rgb"`, `"#rrggbb"` or `"#rrggbbaa"` as linear floats, 0..1; `raw`: not decoded.

    Returns three numbers, or four where an alpha was written (it is not decoded:
    alpha is a coverage, not a light).

    Raises:
        DataError: the text is not such a colour.
    """
    number = text.strip() if isinstance(text, str) else ""
    if not _HEX.fullmatch(number):
        raise DataError(f"{text!r} is not a colour; expected '#rrggbb', '#rgb' or '#rrggbbaa', as '#87a96b'")
    digits = number[1:]
    if len(digits) == 3:
        digits = "".join(2 * d for d in digits)
    values = [byte / 255.0 for byte in bytes.fromhex(digits)]
    return tuple(values) if raw else (*map(_decoded, values[:3]), *values[3:])


def to_hex(linear: Sequence[float], *, raw: bool = False) -> str:
    """Write a linear colour of three or four numbers as `"#rrggbb"` or `"#rrggbbaa"`; `raw`: not encoded.

    Components outside 0..1 are clamped. `to_hex(parse_hex(text))` is `text` in
    lower case and full length.

    Raises:
        DataError: not three or four finite numbers.
    """
    values = [float(v) for v in linear]
    if len(values) not in (3, 4) or not all(map(math.isfinite, values)):
        raise DataError(f"{tuple(values)} is not a colour; expected three or four finite numbers from 0 to 1")
    clamped = [min(max(v, 0.0), 1.0) for v in values]
    shown = clamped if raw else [*map(_encoded, clamped[:3]), *clamped[3:]]
    return "#" + bytes(round(255.0 * v) for v in shown).hex()


def _decoded(c: float) -> float:
    return c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4


def _encoded(c: float) -> float:
    return c * 12.92 if c <= 0.0031308 else 1.055 * c ** (1.0 / 2.4) - 0.055
