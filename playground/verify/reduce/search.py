"""What is tried, in which order, until nothing more goes.

From large to small: passes, what is set, sizes, then the texts, by lines and blocks, by
expressions, by headers. A text that got smaller may free a pass, so it all begins again
until one whole round changes nothing. The order is always the same, and no candidate is
tried twice.

Lists are made smaller by delta debugging: ddmin of Zeller and Hildebrandt 2002, "Simplifying and Isolating
Failure-Inducing Input" (IEEE Transactions on Software Engineering 28), with complements only: a candidate is
always what is left when one part is taken out. The result is 1-minimal: without any one of its items the
test no longer passes. That is not the smallest of all, which would take as many tests as there are subsets.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

from playground.memo import TEXTS
from playground.shader.syntax.tokens import with_edits
from playground.sketch.model import Camera
from playground.verify.reduce.candidate import Finding, Probe
from playground.verify.reduce.case import Case, Pass, glsl_of
from playground.verify.reduce.edits import (
    Candidates,
    outputs_of,
    tidy,
    token_count,
    uniforms_of,
)

# ── delta debugging ──────────────────────────────────────────────────────────


Item = TypeVar("Item")


def ddmin(items: Sequence[Item], test: Callable[[list[Item]], bool]) -> list[Item]:
    """Return a part of ``items``, in their order, that passes and of which no item can be spared.

    ``items`` themselves must pass, which is not tried. The test is tried on the same lists
    in the same order every time; it should give the same answer to the same list.
    """
    left = list(items)
    if left and test([]):
        return []
    parts = min(2, len(left))
    while len(left) > 1:
        # From the end: what is later in a text is seldom needed by what is before it.
        for part in reversed(range(parts)):
            low, high = part * len(left) // parts, (part + 1) * len(left) // parts
            rest = left[:low] + left[high:]
            if rest and test(rest):
                left, parts = rest, min(max(parts - 1, 2), len(rest))
                break
        else:
            if parts == len(left):
                break
            parts = min(2 * parts, len(left))
    return left


# ── the search ───────────────────────────────────────────────────────────────


_PLAIN = {
    "time": 0.0,
    "samples": 1,
    "camera": Camera(),
    "steps": (),
    "extent": None,
    "relief": None,
    "base_elevation": None,
}
_BETWEEN = 8  # edits that held between two looks at the lines
_MIN_SIDE = 2  # texels or pixels a side


@dataclass(frozen=True)
class State:
    """How far the search is."""

    what: str
    lines: int
    tries: int
    repeated: int  # candidates known from before
    seconds: float


class LimitReached(Exception):
    """The limit of time or of tries is reached."""


class Search:
    """Shrinks one case; ``best`` is the smallest found so far, however the search ends."""

    def __init__(
        self,
        case: Case,
        finding: Finding,
        probe: Probe,
        *,
        seconds: float = 0.0,
        tries: int = 0,
        progress: Callable[[State], None] = lambda state: None,
    ) -> None:
        self.best = case
        self.finding = finding  # of the best
        self.finished = False
        self.tries = self.repeated = 0
        self._probe = probe
        self._limit, self._most = seconds, tries  # 0: none
        self._progress = progress
        self._known: dict[bytes, bool] = {}
        self._start = time.monotonic()
        self._what = ""
        self._undefined = self._lacks(case)

    @property
    def state(self) -> State:
        """How far it is."""
        return State(self._what, self.best.lines, self.tries, self.repeated, time.monotonic() - self._start)

    def run(self) -> bool:
        """Shrink until nothing more goes, or a limit is reached; say whether nothing more goes."""
        try:
            while True:
                before = self.best
                self._round()
                if self.best == before:
                    self.finished = True
                    return True
        except LimitReached:
            return False

    def holds(self, case: Case, *, resized: bool = False) -> bool:
        """Return whether a case fails as the best one does, and let it be the best if so.

        ``resized``: its texels are others, so what is wrong is known by its place again.
        """
        key = hashlib.blake2b("\0".join(f"{k}\0{v}" for k, v in case.texts().items()).encode()).digest()
        cached = self._known.get(key)
        if cached is not None:
            self.repeated += 1
            # What held may have been taken back by no one: it is a former best, or the best itself.
            if cached:
                self.best = case
            return cached
        if self._limit and time.monotonic() - self._start > self._limit:
            raise LimitReached
        if self._most and self.tries >= self._most:
            raise LimitReached
        if not self._lacks(case) <= self._undefined:
            self._known[key] = False
            return False
        self.tries += 1
        finding = self._probe.find(case)
        holds = finding is not None and self._probe.failure.same(self.finding, finding)
        self._known[key] = holds
        if holds:
            assert finding is not None
            if resized:
                self.finding = finding
            self.best = case
        self._progress(self.state)
        return holds

    def confirmed(self) -> Finding | None:
        """Return how the best fails in fresh processes; None where it does not, or otherwise."""
        self._probe.renew()
        finding = self._probe.find(self.best)
        return finding if finding is not None and self._probe.failure.same(self.finding, finding) else None

    # ── one round ────────────────────────────────────────────────────────────

    def _round(self) -> None:
        # A small picture first: all that follows is then tried on it.
        self._begin("sizes")
        self._sizes()
        self._begin("passes")
        self._simplify_inputs()
        self._begin("settings")
        self._settings()
        for name in [pass_.name for pass_ in reversed(self.best.live)]:
            for what, shrink in (("lines", self._lines), ("expressions", self._expressions)):
                if any(pass_.name == name for pass_ in self.best.live):
                    self._begin(f"{what} of {name}")
                    shrink(name)

    def _begin(self, what: str) -> None:
        self._what = what
        self._progress(self.state)

    def _simplify_inputs(self) -> None:
        """Put something plain in the place of each pass that the target reads, the nearest first."""
        for pass_ in reversed(self.best.live[:-1]):
            if any(live.name == pass_.name for live in self.best.live):
                for text in _plain_texts(pass_, 0 in self._probe.failure.numbers):
                    plain = replace(pass_, text=text, variant="", inputs=(), values=(), repeat=0, feedback=())
                    if token_count(text) >= token_count(pass_.text):
                        break  # it is as plain already
                    if self.holds(self.best.with_pass(plain)):
                        break
        for pass_ in reversed(self.best.live):
            for name, _ in pass_.live_inputs:
                fewer = tuple(pair for pair in pass_.inputs if pair[0] != name)
                if name.startswith("initial"):
                    self.holds(self.best.with_pass(replace(pass_, inputs=fewer)))
            if pass_.variant:
                current = next(p for p in self.best.live if p.name == pass_.name)
                self.holds(self.best.with_pass(replace(current, variant="")))

    def _settings(self) -> None:
        """Remove what is set: all of it at once if that goes, then one after the other."""
        start = self.best
        terrain = [name for name, plain in _PLAIN.items() if getattr(start, name) != plain]
        value = [(pass_.name, name) for pass_ in start.live for name, _ in pass_.live_values]
        settings = [("", name) for name in terrain] + value
        if settings:
            ddmin(settings, lambda some: self.holds(_with_settings(start, frozenset(some))))
        for name in [pass_.name for pass_ in self.best.live]:
            self._first_of(name, self._folded)

    def _folded(self, pass_: Pass) -> Iterator[str]:
        kinds = uniforms_of(pass_.text)
        values = {name: glsl_of(kinds[name], value) for name, value in pass_.live_values}
        return self._candidates(pass_, "text").constants(values)

    def _sizes(self) -> None:
        """Halve the terrain, the passes of other sizes with it, then the picture, as often as it goes."""
        for halved in (_smaller_terrain, _smaller_frame):
            smallest = self.best
            while (smaller := halved(smallest)) != smallest:
                smallest = smaller
            if smallest == self.best or self.holds(smallest, resized=True):
                continue
            while (smaller := halved(self.best)) != self.best and self.holds(smaller, resized=True):
                pass

    def _lines(self, name: str) -> None:
        for kind in ("text", "variant"):
            if not getattr(self._pass(name), kind):
                continue
            self._of_each(name, kind, Candidates.without_unused)
            self._of_each(name, kind, Candidates.stubs)
            before = ""
            # A body that shrank may free the functions that it called.
            while (text := getattr(self._pass(name), kind)) != before:
                before = text
                self._lists(name, kind)
                self._of_each(name, kind, Candidates.unwrapped)
                self._of_each(name, kind, Candidates.without_unused)

    def _lists(self, name: str, kind: str) -> None:
        """Leave out what can be of each list of the text, the outer ones first."""
        number = 0
        while True:
            text = getattr(self._pass(name), kind)
            lists = Candidates(text).lists()
            if number >= len(lists):
                return
            ddmin(lists[number], partial(self._without, name, kind, text, lists[number]))
            number += 1

    def _without(
        self,
        name: str,
        kind: str,
        text: str,
        items: Sequence[tuple[int, int]],
        left: Sequence[tuple[int, int]],
    ) -> bool:
        """Try a text with these items of a list alone."""
        gone = set(items).difference(left)
        return self._try(name, kind, tidy(with_edits(text, dict.fromkeys(gone, ""))))

    def _candidates(self, pass_: Pass, kind: str) -> Candidates:
        return Candidates(getattr(pass_, kind), self._probe.failure.numbers, dict(pass_.given))

    def _of_each(self, name: str, kind: str, texts: Callable[[Candidates], Iterable[str]]) -> None:
        self._first_of(name, lambda pass_: texts(self._candidates(pass_, kind)), kind)

    def _expressions(self, name: str) -> None:
        again = bool(self._pass(name).variant)
        while again:
            pass_ = self._pass(name)
            pairs = self._candidates(pass_, "text").simplified_with(pass_.variant)
            both = (replace(pass_, text=tidy(text), variant=tidy(other)) for text, other in pairs)
            again = any(self.holds(self.best.with_pass(pair)) for pair in both if pair != pass_)

        def smaller(pass_: Pass) -> Iterable[str]:
            candidates = self._candidates(pass_, "text")
            yield from candidates.headers()
            yield from candidates.without_parameter()
            yield from candidates.inlined()
            yield from candidates.simplified()

        self._first_of(name, smaller, between=True)
        if self._pass(name).variant:
            self._of_each(name, "variant", Candidates.simplified)

    def _first_of(
        self,
        name: str,
        candidates: Callable[[Pass], Iterable[str]],
        kind: str = "text",
        between: bool = False,
    ) -> None:
        """Go through the candidates once, and take each that holds; the next are those of the smaller text.

        What is before it in the order is tried again in the next round: lines may have gone by then.
        """
        begin = held = 0
        while begin >= 0:
            before, start = getattr(self._pass(name), kind), begin
            begin = -1
            for index, text in enumerate(candidates(self._pass(name))):
                if index >= start and (text := tidy(text)) != before and self._try(name, kind, text):
                    begin = index
                    held += 1
                    break
            if between and held % _BETWEEN == _BETWEEN - 1 and begin >= 0:
                self._lines(name)  # what those edits freed goes at once, by whole lines
                held += 1

    def _pass(self, name: str) -> Pass:
        return next(pass_ for pass_ in self.best.passes if pass_.name == name)

    def _try(self, name: str, kind: str, text: str) -> bool:
        pass_ = self._pass(name)
        changed = replace(pass_, **{kind: text})  # type: ignore[arg-type]
        return self.holds(self.best.with_pass(changed))

    def _lacks(self, case: Case) -> frozenset[str]:
        """Return what GLSL leaves undefined in each text, and the names that nothing declares."""
        texts = ((pass_.name, text) for pass_ in case.live for text in (pass_.text, pass_.variant) if text)
        names_all = self._probe.failure.names_all
        return frozenset(f"{name} {wrong}" for name, text in texts for wrong in _lacking(text, names_all))


@TEXTS.cached()
def _lacking(text: str, names_all: bool) -> frozenset[str]:
    candidates = Candidates(text)
    return candidates.undefined | candidates.undeclared if names_all else candidates.undefined


def _with_settings(case: Case, settings: frozenset[tuple[str, str]]) -> Case:
    """Return the case with these settings alone: (pass, parameter), or the terrain's own as ("", name)."""
    passes = tuple(
        replace(pass_, values=tuple(pair for pair in pass_.values if (pass_.name, pair[0]) in settings))
        for pass_ in case.passes
    )
    plain = {name: value for name, value in _PLAIN.items() if ("", name) not in settings}
    return replace(case, passes=passes, **plain)  # type: ignore[arg-type]


def _plain_texts(pass_: Pass, zero: bool) -> Iterator[str]:
    """Yield texts that give the same outputs from nothing: a constant, then a ramp."""
    if "#pragma" not in pass_.text:
        return
    outputs = outputs_of(pass_.text)
    declared = ", ".join(f"{output.name}:{output.format}" for output in outputs)
    head = f'#pragma kernel(output = "{declared}")\n'
    ramp = "float(texel.x + 2 * texel.y) / float(size.x)"
    for value in (*(("0.0",) if zero else ()), "1.0", "0.5", ramp):
        values = [value if output.glsl == "float" else f"{output.glsl}({value})" for output in outputs]
        if len(outputs) == 1:
            yield tidy(f"{head}{outputs[0].glsl} kernel(ivec2 texel) {{ return {values[0]}; }}")
            continue
        parameters = ", ".join(f"out {output.glsl} {output.name}" for output in outputs)
        body = " ".join(f"{output.name} = {of};" for output, of in zip(outputs, values, strict=True))
        yield tidy(f"{head}void kernel(ivec2 texel, {parameters}) {{ {body} }}")


def _half(number: int) -> int:
    """Halve a side; odd ones stay odd, so that 2**n + 1 stays of its form."""
    if number <= _MIN_SIDE:
        return number
    return (number - 1) // 2 + 1 if number % 2 else number // 2


def _smaller_terrain(case: Case) -> Case:
    size = (_half(case.size[0]), _half(case.size[1]))
    passes = tuple(
        pass_
        if pass_.size is None or pass_.size == case.frame
        else replace(pass_, size=(_half(pass_.size[0]), _half(pass_.size[1])))
        for pass_ in case.passes
    )
    return replace(case, size=size, passes=passes)


def _smaller_frame(case: Case) -> Case:
    frame = (_half(case.frame[0]), _half(case.frame[1]))
    passes = tuple(
        replace(pass_, size=frame) if pass_.size is not None and pass_.size == case.frame else pass_
        for pass_ in case.passes
    )
    return replace(case, frame=frame, passes=passes)
