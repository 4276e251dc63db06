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
import re
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeVar

from playground.memo import TEXTS
from playground.sketch.model import Camera
from playground.verify.reduce import edits
from playground.verify.reduce.candidate import Finding, Probe
from playground.verify.reduce.case import Case, Pass, glsl_of
from playground.verify.reduce.edits import tidy, tokens_of

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


# ── a text as a tree of lines and blocks ─────────────────────────────────────


Test = Callable[[str], bool]
"""Says whether a text still fails in the same way."""

Nodes = tuple["Node", ...]

_UNWRAPPED = ("if", "else", "for", "while", "do", "switch", "{")


@dataclass(frozen=True)
class Node:
    """A line, or a block with its first and last line."""

    head: str
    body: tuple[Node, ...] | None = None  # None: a single line
    tail: str = ""

    def lines(self) -> Iterator[str]:
        """Yield its lines."""
        yield self.head
        if self.body is not None:
            for node in self.body:
                yield from node.lines()
            yield self.tail


def blocks_of(text: str) -> Nodes:
    """Return a tidy text's top level."""
    stack: list[tuple[str, list[Node]]] = [("", [])]
    for line in filter(str.strip, text.split("\n")):
        code = line.strip()
        if code.startswith("}") and len(stack) > 1:
            head, body = stack.pop()
            stack[-1][1].append(Node(head, tuple(body), line))
        elif code.endswith("{") and not code.startswith("#"):
            stack.append((line, []))
        else:
            stack[-1][1].append(Node(line))
    while len(stack) > 1:  # a brace that is never closed: its lines are single lines
        head, body = stack.pop()
        stack[-1][1].extend([Node(head), *body])
    return tuple(stack[0][1])


def text_of_blocks(nodes: Nodes) -> str:
    """Return the text of a level."""
    return "".join(f"{line}\n" for node in nodes for line in node.lines())


def fewer_lines(text: str, test: Test) -> str:
    """Return the text with lines and blocks left out at every depth, each level made 1-minimal.

    The whole level goes first, then what is inside each block that stays, so a function
    that nothing needs costs one try.
    """

    def holds(nodes: Nodes) -> bool:
        return test(text_of_blocks(nodes))

    level = tuple(ddmin(blocks_of(text), lambda some: holds(tuple(some))))
    return text_of_blocks(_inside_each(level, holds))


def _inside_each(level: Nodes, holds: Callable[[Nodes], bool]) -> Nodes:
    """Make each block of a level smaller, one after the other."""
    index = 0
    while index < len(level):
        before, node, after = level[:index], level[index], level[index + 1 :]
        level = (*before, *_smaller(node, _between(before, after, holds)), *after)
        index = len(level) - len(after)
    return level


def _between(before: Nodes, after: Nodes, holds: Callable[[Nodes], bool]) -> Callable[[Nodes], bool]:
    """Return the test of what is between some nodes."""
    return lambda nodes: holds((*before, *nodes, *after))


def _smaller(node: Node, holds: Callable[[Nodes], bool]) -> Nodes:
    """Return what a block comes down to: what it holds where that does alone, else with less in it."""
    if node.body is None:
        return (node,)
    opening = node.head.strip().split("(")[0].split()[0]
    if opening in _UNWRAPPED and node.body and holds(node.body):
        return _inside_each(node.body, holds)

    def filled(body: Nodes) -> bool:
        return holds((Node(node.head, body, node.tail),))

    body = tuple(ddmin(node.body, lambda some: filled(tuple(some))))
    return (Node(node.head, _inside_each(body, filled), node.tail),)


# ── the search ───────────────────────────────────────────────────────────────


_OUTPUTS = re.compile(r'\boutput\s*=\s*"([^"]*)"')
_UNIFORM = re.compile(r"^\s*uniform\s+(\w+)\s+(\w+)", re.MULTILINE)
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
        self._undefined = _undefined(case)

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
        if not _undefined(case) <= self._undefined:
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
                for text in _plain_texts(pass_, "0.0" in self._probe.failure.literals):
                    plain = replace(pass_, text=text, variant="", inputs=(), values=(), repeat=0, feedback=())
                    if len(tokens_of(text)) >= len(tokens_of(pass_.text)):
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
        kinds = {name: kind for kind, name in _UNIFORM.findall(pass_.text)}
        values = {name: glsl_of(kinds[name], value) for name, value in pass_.live_values}
        return edits.constants(pass_.text, values)

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
            number = "0.0" if "0.0" in self._probe.failure.literals else "1.0"
            self._first_of(name, partial(_stubs, kind=kind, number=number), kind)
            before = ""
            # A body that shrank may free the functions that it called.
            while (text := getattr(self._pass(name), kind)) != before:
                before = text
                fewer_lines(text, partial(self._try_lines, name, kind))

    def _expressions(self, name: str) -> None:
        literals = self._probe.failure.literals
        again = bool(self._pass(name).variant)
        while again:
            pass_ = self._pass(name)
            pairs = edits.in_both(pass_.text, pass_.variant, literals)
            both = (replace(pass_, text=text, variant=other) for text, other in pairs)
            again = any(self.holds(self.best.with_pass(pair)) for pair in both if pair != pass_)

        def smaller(text: str) -> Iterable[str]:
            yield from edits.headers(text)
            yield from edits.parameters_of_functions(text)
            yield from edits.inlined(text)
            yield from edits.expressions(text, literals)

        self._first_of(name, lambda pass_: smaller(pass_.text), between=True)
        if self._pass(name).variant:
            self._first_of(name, lambda pass_: smaller(pass_.variant), "variant")

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
                if index >= start and text != before and self._try(name, kind, text):
                    begin = index
                    held += 1
                    break
            if between and held % _BETWEEN == _BETWEEN - 1 and begin >= 0:
                self._lines(name)  # what those edits freed goes at once, by whole lines
                held += 1

    def _pass(self, name: str) -> Pass:
        return next(pass_ for pass_ in self.best.passes if pass_.name == name)

    def _try_lines(self, name: str, kind: str, text: str) -> bool:
        return self._try(name, kind, tidy(text))

    def _try(self, name: str, kind: str, text: str) -> bool:
        pass_ = self._pass(name)
        changed = replace(pass_, **{kind: text})  # type: ignore[arg-type]
        return self.holds(self.best.with_pass(changed))


def _undefined(case: Case) -> frozenset[str]:
    """Return what GLSL leaves undefined in each text."""
    texts = ((pass_.name, text) for pass_ in case.live for text in (pass_.text, pass_.variant) if text)
    return frozenset(f"{name} {wrong}" for name, text in texts for wrong in _undefined_in(text))


@TEXTS.cached()
def _undefined_in(text: str) -> frozenset[str]:
    return edits.undefined(text)


def _with_settings(case: Case, settings: frozenset[tuple[str, str]]) -> Case:
    """Return the case with these settings alone: (pass, parameter), or the terrain's own as ("", name)."""
    passes = tuple(
        replace(pass_, values=tuple(pair for pair in pass_.values if (pass_.name, pair[0]) in settings))
        for pass_ in case.passes
    )
    plain = {name: value for name, value in _PLAIN.items() if ("", name) not in settings}
    return replace(case, passes=passes, **plain)  # type: ignore[arg-type]


def _stubs(pass_: Pass, kind: str, number: str) -> Iterator[str]:
    return edits.stubs(getattr(pass_, kind), number)


def _plain_texts(pass_: Pass, zero: bool) -> Iterator[str]:
    """Yield texts that give the same outputs from nothing: a constant, then a ramp."""
    match = _OUTPUTS.search(pass_.text)
    if not pass_.text.startswith("#pragma") and "#pragma" not in pass_.text:
        return
    outputs = [part.partition(":") for part in (match.group(1) if match else "frame:rgba16f").split(",")]
    declared = ", ".join(f"{name.strip()}:{form.strip()}" for name, _, form in outputs)
    kinds = ["vec4" if "rgba" in form else "vec2" if "rg" in form else "float" for _, _, form in outputs]
    ramp = "float(texel.x + 2 * texel.y) / float(size.x)"
    for value in (*(("0.0",) if zero else ()), "1.0", "0.5", ramp):
        head = f'#pragma kernel(output = "{declared}")\n'
        if len(outputs) == 1:
            cast = value if kinds[0] == "float" else f"{kinds[0]}({value})"
            yield tidy(f"{head}{kinds[0]} kernel(ivec2 texel) {{ return {cast}; }}")
            continue
        arguments = ", ".join(
            f"out {kind} {name.strip()}" for kind, (name, _, _) in zip(kinds, outputs, strict=True)
        )
        body = " ".join(
            f"{name.strip()} = {value if kind == 'float' else f'{kind}({value})'};"
            for kind, (name, _, _) in zip(kinds, outputs, strict=True)
        )
        yield tidy(f"{head}void kernel(ivec2 texel, {arguments}) {{ {body} }}")


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
