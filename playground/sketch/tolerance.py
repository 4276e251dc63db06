"""What a shot says of differences that are meant to pass: how much, and why.

    rounding   3 levels of 255, at 0.5 % of the pixels: what another build of a renderer may differ by
    edges      any number of levels, at 0.5 % of the pixels: single pixels that fall the other way
    noise      8 levels at any pixel: grain and dithering that are different in each run

How they are applied, and what no tolerance lets pass, is in `playground.shots.tolerated`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from playground.errors import nearest

Given = str | int | Mapping[str, object]


@dataclass(frozen=True, slots=True)
class Tolerance:
    """What may differ from a reference."""

    levels: int = 3  # [of 255] that any channel of any pixel may differ by
    share: float = 0.005  # of the pixels that may differ by more than one level
    name: str = ""  # of the tier; "": its numbers were given
    reason: str = ""  # why it is needed, for whoever reads the report

    def __str__(self) -> str:
        named = f"{self.name}, " if self.name else ""
        return f"{named}{self.levels} of 255 at {100 * self.share:g} % of the pixels ({self.reason})"


TIERS = {
    "rounding": Tolerance(3, 0.005, "rounding"),
    "edges": Tolerance(255, 0.005, "edges"),
    "noise": Tolerance(8, 1.0, "noise"),
}
"""The tolerances that have names."""


_USUAL = TIERS["rounding"]


def tolerance_of(given: Given | None, reason: str) -> Tolerance | None:
    """Return a tolerance from a tier's name, levels, or a table of levels and share; None for none.

    Raises ``ValueError`` with a sentence for another value, and without a reason.
    """
    if given is None:
        if reason:
            raise ValueError("reason: there is no tolerance that it is a reason for")
        return None
    found = _allowed(given)
    if not reason.strip():
        raise ValueError('tolerance: it needs a reason, as reason = "the grain is different in each run"')
    return replace(found, reason=reason.strip())


def _allowed(given: Given) -> Tolerance:
    if isinstance(given, str):
        if given not in TIERS:
            raise ValueError(f"tolerance = {given!r}: expected {_CHOICES}{nearest(given, TIERS)}")
        return TIERS[given]
    table = given if isinstance(given, Mapping) else {"levels": given}
    unknown = [key for key in table if key not in ("levels", "share")]
    if unknown or not table:
        raise ValueError(f"tolerance = {given!r}: expected {_CHOICES}")
    levels, share = table.get("levels", _USUAL.levels), table.get("share", _USUAL.share)
    if type(levels) is not int or not 2 <= levels <= 255:
        raise ValueError(f"tolerance: levels = {levels!r}: expected a whole number from 2 to 255")
    if type(share) not in (int, float) or not 0.0 < share <= 1.0:  # type: ignore[operator]
        raise ValueError(f"tolerance: share = {share!r}: expected a share of the pixels, above 0 and to 1")
    return Tolerance(levels, float(share))  # type: ignore[arg-type]


_CHOICES = f"{', '.join(TIERS)}, a number of levels of 255, or {{ levels = 6, share = 0.01 }}"
