"""How closely a fast variant agrees with the canonical form, as its text states it.

``agrees = "exact"`` is every bit; ``"1e-5"`` the most that any number of any output may differ
by. Bounds of single outputs are separated by semicolons, and may count otherwise:

    "sky: 0.012 rms; ahead, behind: 0.9 degrees rms; exact"

``rms`` bounds the root of the mean square of the differences, ``degrees`` compares tangents as
angles. A bound without a name is for all outputs that have none of their own.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

_BOUND = re.compile(
    r"(?:(?P<names>[A-Za-z_]\w*(?:\s*,\s*[A-Za-z_]\w*)*)\s*:\s*)?"
    r"(?:(?P<exact>exact)|(?P<most>\d+\.?\d*(?:e[+-]?\d+)?)(?P<degrees>\s+degrees)?(?P<rms>\s+rms)?)",
    re.ASCII,
)
EXAMPLE = 'agrees = "exact", agrees = "1e-5" or agrees = "sky: 0.01 rms; exact"'


@dataclass(frozen=True, slots=True)
class Bound:
    """How far numbers may be apart."""

    output: str = ""  # "": every output without a bound of its own
    most: float = 0.0  # 0: every bit is the same
    degrees: bool = False  # of angles, whose tangents the numbers are
    rms: bool = False  # of the root of the mean square, instead of every difference

    def __str__(self) -> str:
        words = f"{self.most:g}" if self.most else "the last bit"
        return f"{words}{' degrees' if self.degrees else ''}{' (rms)' if self.rms else ''}"


def read_agreement(text: str) -> tuple[Bound, ...]:
    """Return the bounds that a text states; raise ``ValueError`` with what is wrong with it."""
    found: list[Bound] = []
    for part in (part.strip() for part in text.split(";")):
        match = _BOUND.fullmatch(part)
        if match is None or (match["most"] and not 0.0 < float(match["most"]) < math.inf):
            raise ValueError(f"'{part}' states no bound; expected {EXAMPLE}")
        for name in [n.strip() for n in (match["names"] or "").split(",")]:
            if name in [bound.output for bound in found]:
                raise ValueError(f"'{part}': {name or 'all other outputs'} appears twice")
            most = float(match["most"] or 0.0)
            found.append(Bound(name, most, bool(match["degrees"]), bool(match["rms"])))
    return tuple(found)


def bound_of(bounds: tuple[Bound, ...], output: str) -> Bound | None:
    """Return the bound of an output; None where none is stated."""
    named = {bound.output: bound for bound in bounds}
    return named.get(output, named.get(""))
