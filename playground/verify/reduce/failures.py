"""What counts as failing, and as failing in the same way.

A candidate that fails in another way is no smaller form of the failure in question: taking
out a line that prevents a zero divisor makes a NaN of its own. So each failure says of
what came of a candidate what it found there, and whether that is the same.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.verify.reduce.candidate_process import DrawResult
from playground.verify.reduce.edits import LITERALS, LITERALS_WITHOUT_ZERO

_ROUNDING = 1e-5  # relative: what rounding explains; what lies beyond is another kind of difference


@dataclass(frozen=True, eq=False)
class Finding:
    """A failure: its kind, as text that stay the same from candidate to candidate, and where it is."""

    kind: str
    details: str = ""  # more of it, for a person
    where: NDArray[np.bool_] | None = None  # (ny, nx) of the texels that are wrong
    messages: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Side:
    """One way to draw a candidate."""

    process: int = 0
    driver: str = "auto"


class FailureKind(ABC):
    """A kind of failure; ``sides`` are the ways in which a candidate must be drawn to see it."""

    sides: tuple[Side, ...] = (Side(),)
    literals: Sequence[str] = LITERALS
    as_picture = False  # whether the picture's bytes are looked at, not a pass's values

    @abstractmethod
    def finding(self, results: Sequence[DrawResult]) -> Finding | None:
        """Return what is wrong with a candidate; None where nothing of this kind is."""

    def same(self, before: Finding, after: Finding) -> bool:
        """Return whether a candidate fails as the one before did, and at no texel that was good."""
        if before.kind != after.kind:
            return False
        if before.where is None or after.where is None or before.where.shape != after.where.shape:
            return True
        return not bool((after.where & ~before.where).any())


class Refused(FailureKind):
    """The compiler refuses, with a message that a pattern finds."""

    def __init__(self, pattern: str = "", driver: str = "auto") -> None:
        self.sides = (Side(driver=driver),)
        self._pattern = re.compile(pattern)

    def finding(self, results: Sequence[DrawResult]) -> Finding | None:
        """Return what is wrong; None where nothing of this kind is."""
        if results[0].kind != "shader":
            return None
        short = {_short(message): message for message in results[0].messages}
        hit = next((clause for clause, whole in short.items() if self._pattern.search(whole)), None)
        return None if hit is None else Finding(hit, results[0].details, messages=frozenset(short))

    def same(self, before: Finding, after: Finding) -> bool:
        """Return whether it is the same message, and none that was not there before."""
        return before.kind == after.kind and after.messages <= before.messages


class Died(FailureKind):
    """The driver crashes or hangs."""

    def __init__(self, kind: str = "", driver: str = "auto") -> None:
        self.sides = (Side(driver=driver),)
        self._kinds = (kind,) if kind else ("crash", "hang")

    def finding(self, results: Sequence[DrawResult]) -> Finding | None:
        """Return how it died; None where it did not."""
        return Finding(results[0].kind, results[0].details) if results[0].kind in self._kinds else None


class NotFinite(FailureKind):
    """A value is NaN or infinite.

    No texel may become bad that was good, and what was bad in places may not become bad
    everywhere; nor are zeros put in, which make NaNs of their own. ``anywhere`` lets go of
    the first two: what is left is smaller, and may be a NaN of another making.
    """

    literals = LITERALS_WITHOUT_ZERO

    def __init__(self, driver: str = "auto", anywhere: bool = False) -> None:
        self.sides = (Side(driver=driver),)
        self._anywhere = anywhere

    def finding(self, results: Sequence[DrawResult]) -> Finding | None:
        """Return what is wrong; None where nothing of this kind is."""
        values = results[0].values
        if results[0].kind != "drawn" or values is None or values.dtype.kind != "f":
            return None
        wrong = _flat(~np.isfinite(values))
        if not wrong.any():
            return None
        kind = "NaN" if _flat(np.isnan(values)).any() else "infinite"
        whole = bool(wrong.all())
        count = int(wrong.sum())
        details = f"{count} of {wrong.size} texels are {kind}; first at {_first(wrong)}"
        if self._anywhere:
            return Finding(kind, details)
        return Finding(f"{kind} {'everywhere' if whole else 'in places'}", details, wrong)


class Differs(FailureKind):
    """Two ways to draw give other numbers, or only one of them draws at all.

    Where they agreed they must go on to agree, and what rounding explains is another
    kind of difference than what it does not.
    """

    def __init__(self, sides: tuple[Side, Side], names: tuple[str, str], tolerance: float = 0.0) -> None:
        self.sides = sides
        self._names = names
        self._tolerance = tolerance

    def finding(self, results: Sequence[DrawResult]) -> Finding | None:
        """Return how far they are apart; None where they are not."""
        left, other = results
        if left.kind != "drawn" or other.kind != "drawn":
            if left.kind == other.kind:
                return None
            bad, name = (left, self._names[0]) if left.kind != "drawn" else (other, self._names[1])
            if bad.kind == "refused" or "drawn" not in (left.kind, other.kind):
                return None
            message = _short(bad.messages[0]) if bad.messages else bad.details
            return Finding(f"only by {name}: {bad.kind} {message}", bad.details)
        assert left.values is not None and other.values is not None
        if left.values.shape != other.values.shape:
            return None
        return self._compared(left.values, other.values)

    def _compared(self, left: NDArray[Any], other: NDArray[Any]) -> Finding | None:
        first, second = left.astype(np.float64), other.astype(np.float64)
        good = np.isfinite(first) & np.isfinite(second)
        # NaN equals NaN, with any bits; an infinity is itself.
        with np.errstate(invalid="ignore"):
            alike = (first == second) | (np.isnan(first) & np.isnan(second))
            apart = np.where(good, np.abs(first - second), 0.0)
        wrong = ~alike & (~good | (apart > self._tolerance))
        if not wrong.any():
            return None
        scale = np.maximum(np.abs(first), np.abs(second), where=good, out=np.ones_like(first))
        wide = wrong & good & (apart > _ROUNDING * np.maximum(scale, 1e-30))
        flat = _flat(wrong)
        places = "everywhere" if flat.all() else "in places"
        if (wrong & ~good).any():
            kind = f"not finite by one of them {places}"
        elif wide.any():
            kind = f"differs widely {places}"
        else:
            kind = "differs in the last bits"
        worst = np.unravel_index(
            int(np.argmax(np.where(wrong, np.where(good, apart, np.inf), -1.0))), wrong.shape
        )
        details = (
            f"{int(flat.sum())} of {flat.size} texels differ, the most at {_place(worst)}:"
            f" {first[worst]:.9g} by {self._names[0]}, {second[worst]:.9g} by {self._names[1]}"
        )
        # Which texels rounding meets changes with every edit.
        return Finding(kind, details, None if kind.endswith("bits") else flat)


class OffReference(FailureKind):
    """A shot is not its reference: the pixels that were wrong must stay wrong in the same way.

    Any other picture would differ from the reference too, so the requirement is how each
    wrong pixel looks; those that were right are free.
    """

    as_picture = True

    def __init__(
        self, picture: NDArray[np.uint8], references: Sequence[NDArray[np.uint8]], tolerance: int
    ) -> None:
        self._picture = picture.astype(np.int16)
        self._tolerance = tolerance
        wrong = np.ones(picture.shape[:2], bool)
        for reference in references:
            if reference.shape == picture.shape:
                apart = np.abs(reference.astype(np.int16) - self._picture)
                wrong &= (apart > tolerance).any(axis=2)
        self.wrong = wrong

    def finding(self, results: Sequence[DrawResult]) -> Finding | None:
        """Return what is wrong; None where nothing of this kind is."""
        values = results[0].values
        if results[0].kind != "drawn" or values is None or values.shape != self._picture.shape:
            return None
        apart = np.abs(values.astype(np.int16) - self._picture)[self.wrong]
        if not self.wrong.any() or bool((apart > self._tolerance).any()):
            return None
        count = int(self.wrong.sum())
        details = f"{count} of {self.wrong.size} pixels are off the reference, first at {_first(self.wrong)}"
        return Finding("off its reference", details, self.wrong)


class Commanded(FailureKind):
    """A command of the user's says that a candidate fails."""

    sides = ()

    def __init__(self, command: str) -> None:
        self.command = command

    def finding(self, results: Sequence[DrawResult]) -> Finding | None:
        """Return None: nothing is drawn, and the command's exit status tells."""
        return None


def _short(message: str) -> str:
    """Return a message's first clause: what follows lists candidates, or advises."""
    return message.partition(";")[0].strip()


def _flat(wrong: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return (ny, nx): whether any component of a texel is wrong."""
    return np.asarray(wrong.any(axis=2)) if wrong.ndim == 3 else wrong


def _first(wrong: NDArray[np.bool_]) -> str:
    return _place(np.unravel_index(int(np.argmax(wrong)), wrong.shape))


def _place(index: Sequence[Any]) -> str:
    return f"({int(index[1])}, {int(index[0])})"
