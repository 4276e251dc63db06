"""What counts as failing, and as failing in the same way.

A candidate that fails in another way is no smaller form of what was asked about: taking
out a line that kept a divisor from zero makes a NaN of its own. So each fault says of
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

from playground.reduce.child import Seen
from playground.reduce.edits import LITERALS, LITERALS_WITHOUT_ZERO

_ROUNDING = 1e-5  # relative: what rounding explains; what lies beyond is another kind of difference


@dataclass(frozen=True, eq=False)
class Finding:
    """A failure: its kind, in words that stay the same from candidate to candidate, and where it is."""

    word: str
    told: str = ""  # more of it, for a person
    where: NDArray[np.bool_] | None = None  # (ny, nx) of the texels that are wrong
    messages: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Side:
    """One way to draw a candidate."""

    worker: int = 0
    driver: str = "auto"


class Fault(ABC):
    """A kind of failure; ``sides`` are the ways in which a candidate must be drawn to see it."""

    sides: tuple[Side, ...] = (Side(),)
    literals: Sequence[str] = LITERALS
    as_picture = False  # whether the picture's bytes are looked at, not a pass's values

    @abstractmethod
    def found(self, seen: Sequence[Seen]) -> Finding | None:
        """Return what is wrong with a candidate; None where nothing of this kind is."""

    def same(self, before: Finding, after: Finding) -> bool:
        """Say whether a candidate fails as the one before did, and at no texel that was good."""
        if before.word != after.word:
            return False
        if before.where is None or after.where is None or before.where.shape != after.where.shape:
            return True
        return not bool((after.where & ~before.where).any())


class Refused(Fault):
    """The compiler refuses, with a message that a pattern finds."""

    def __init__(self, pattern: str = "", driver: str = "auto") -> None:
        self.sides = (Side(driver=driver),)
        self._pattern = re.compile(pattern)

    def found(self, seen: Sequence[Seen]) -> Finding | None:
        """Return what is wrong; None where nothing of this kind is."""
        if seen[0].word != "shader":
            return None
        short = {_short(message): message for message in seen[0].messages}
        hit = next((word for word, whole in short.items() if self._pattern.search(whole)), None)
        return None if hit is None else Finding(hit, seen[0].told, messages=frozenset(short))

    def same(self, before: Finding, after: Finding) -> bool:
        """Say whether it is the same message, and none that was not there before."""
        return before.word == after.word and after.messages <= before.messages


class Died(Fault):
    """The driver crashes or hangs."""

    def __init__(self, word: str = "", driver: str = "auto") -> None:
        self.sides = (Side(driver=driver),)
        self._words = (word,) if word else ("crash", "hang")

    def found(self, seen: Sequence[Seen]) -> Finding | None:
        """Return how it died; None where it did not."""
        return Finding(seen[0].word, seen[0].told) if seen[0].word in self._words else None


class NotFinite(Fault):
    """A value is NaN or infinite.

    No texel may turn bad that was good, and what was bad in places may not become bad
    everywhere; nor are zeros put in, which make NaNs of their own. ``anywhere`` lets go of
    the first two: what is left is smaller, and may be a NaN of another making.
    """

    literals = LITERALS_WITHOUT_ZERO

    def __init__(self, driver: str = "auto", anywhere: bool = False) -> None:
        self.sides = (Side(driver=driver),)
        self._anywhere = anywhere

    def found(self, seen: Sequence[Seen]) -> Finding | None:
        """Return what is wrong; None where nothing of this kind is."""
        values = seen[0].values
        if seen[0].word != "drawn" or values is None or values.dtype.kind != "f":
            return None
        wrong = _flat(~np.isfinite(values))
        if not wrong.any():
            return None
        kind = "NaN" if _flat(np.isnan(values)).any() else "infinite"
        whole = bool(wrong.all())
        count = int(wrong.sum())
        told = f"{count} of {wrong.size} texels are {kind}; first at {_first(wrong)}"
        if self._anywhere:
            return Finding(kind, told)
        return Finding(f"{kind} {'everywhere' if whole else 'in places'}", told, wrong)


class Differs(Fault):
    """Two ways to draw give other numbers, or only one of them draws at all.

    Where they agreed they must go on to agree, and what rounding explains is another
    kind of difference than what it does not.
    """

    def __init__(self, sides: tuple[Side, Side], names: tuple[str, str], tolerance: float = 0.0) -> None:
        self.sides = sides
        self._names = names
        self._tolerance = tolerance

    def found(self, seen: Sequence[Seen]) -> Finding | None:
        """Return how far they are apart; None where they are not."""
        one, other = seen
        if one.word != "drawn" or other.word != "drawn":
            if one.word == other.word:
                return None
            bad, name = (one, self._names[0]) if one.word != "drawn" else (other, self._names[1])
            if bad.word == "refused" or "drawn" not in (one.word, other.word):
                return None
            said = _short(bad.messages[0]) if bad.messages else bad.told
            return Finding(f"only by {name}: {bad.word} {said}", bad.told)
        assert one.values is not None and other.values is not None
        if one.values.shape != other.values.shape:
            return None
        return self._compared(one.values, other.values)

    def _compared(self, one: NDArray[Any], other: NDArray[Any]) -> Finding | None:
        first, second = one.astype(np.float64), other.astype(np.float64)
        good = np.isfinite(first) & np.isfinite(second)
        # NaN is NaN, of whatever bits; an infinity is itself.
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
            word = f"not finite by one of them {places}"
        elif wide.any():
            word = f"differs widely {places}"
        else:
            word = "differs in the last bits"
        worst = np.unravel_index(
            int(np.argmax(np.where(wrong, np.where(good, apart, np.inf), -1.0))), wrong.shape
        )
        told = (
            f"{int(flat.sum())} of {flat.size} texels differ, the most at {_place(worst)}:"
            f" {first[worst]:.9g} by {self._names[0]}, {second[worst]:.9g} by {self._names[1]}"
        )
        # Which texels rounding meets changes with every edit.
        return Finding(word, told, None if word.endswith("bits") else flat)


class OffReference(Fault):
    """A shot is not its reference: the pixels that were wrong must stay wrong in the same way.

    Any other picture would differ from the reference too, so what is kept is how each
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

    def found(self, seen: Sequence[Seen]) -> Finding | None:
        """Return what is wrong; None where nothing of this kind is."""
        values = seen[0].values
        if seen[0].word != "drawn" or values is None or values.shape != self._picture.shape:
            return None
        apart = np.abs(values.astype(np.int16) - self._picture)[self.wrong]
        if not self.wrong.any() or bool((apart > self._tolerance).any()):
            return None
        count = int(self.wrong.sum())
        told = f"{count} of {self.wrong.size} pixels are off the reference, first at {_first(self.wrong)}"
        return Finding("off its reference", told, self.wrong)


class Commanded(Fault):
    """A command of the user's says that a candidate fails."""

    sides = ()

    def __init__(self, command: str) -> None:
        self.command = command

    def found(self, seen: Sequence[Seen]) -> Finding | None:
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
