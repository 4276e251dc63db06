"""Find the inputs that a kernel reads by ``texelFetch`` alone, and the fetches that read only such inputs.

    float slope(sampler2D heights, ivec2 t) { return texelFetch(heights, t, 0).r - …; }

How a sampler filters and what it gives outside of its texture count for none of these inputs, so whoever
binds them is free to say. A function that is handed samplers reads one of these inputs if it is handed
nothing else, by any call. What a macro writes is not read: what it might mean counts as another use.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections import defaultdict
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from functools import lru_cache

from playground.shader.outline import (
    DIRECTIVE,
    arguments_of,
    call_around,
    given_to,
    outline,
    without_directives,
)
from playground.shader.source import SourceText

FETCH = "texelFetch"
_ASKED = frozenset({FETCH, "textureSize"})  # functions of GLSL, whose first argument is a sampler
_OF_GLSL = re.compile(r"texture|texel|shadow")  # its functions that take samplers begin so
_SAMPLER = re.compile(r"\bsampler2D\s+([A-Za-z_]\w*)")
_DECLARED = re.compile(r"\bsampler2D\s+\Z")
_UNIFORM = re.compile(r"\buniform\s+(?:(?:highp|mediump|lowp)\s+)?sampler2D\s+[A-Za-z_]\w*\s*;")
_SAMPLERS = re.compile(r"\bsampler2D\b")

_Sampler = tuple[str, int]  # a function and which of its arguments; of a uniform its name and -1


@dataclass(frozen=True, slots=True)
class FetchedAlone:
    """What of a text reads inputs by ``texelFetch`` alone."""

    inputs: frozenset[str] = frozenset()
    fetches: tuple[tuple[int, int], ...] = ()  # of level 0, of these inputs: line and column, both from 0


@lru_cache(maxsize=256)
def fetched_alone(source: SourceText, inputs: frozenset[str]) -> FetchedAlone:
    """Return what of a flattened text reads some of its inputs by ``texelFetch`` alone."""
    if FETCH not in source.names or not inputs:
        return FetchedAlone()
    text = _Uses(source.code)
    if text.is_unclear:
        return FetchedAlone()
    free = _reaching(text.handed_by, [*text.used_otherwise, *text.uniforms_but(inputs)])
    # A function that may be handed another sampler too fetches as it did.
    mixed = _reaching(text.handed_to, free)
    alone = frozenset([name for name in inputs if (name, -1) in text.samplers and (name, -1) not in free])
    reached = _reaching(text.handed_to, [(name, -1) for name in alone])
    places = [at for at, sampler in text.fetches if sampler in reached and sampler not in mixed]
    lines = [0, *(match.end() for match in re.finditer("\n", source.code))]
    found = []
    for at in sorted(places):
        line = bisect_right(lines, at) - 1
        found.append((line, at - lines[line]))
    return FetchedAlone(alone, tuple(found))


class _Uses:
    """What a text does with its samplers."""

    def __init__(self, code: str) -> None:
        self._code = without_directives(code)
        of_macros = " ".join(match.group() for match in DIRECTIVE.finditer(code))
        self._functions = [one for one in outline(code) if one.kind == "function" and "(" in one.signature]
        self._starts = [one.start for one in self._functions]
        self._names = [arguments_of(one.signature) for one in self._functions]
        self._takes: dict[str, set[int]] = defaultdict(set)  # which arguments of a function are samplers
        for one in self._functions:
            inside = one.signature[one.signature.index("(") :].split(",")
            self._takes[one.name] |= {i for i, part in enumerate(inside) if _SAMPLER.search(part)}
        self.samplers: set[_Sampler] = set()
        self.used_otherwise: set[_Sampler] = set()
        self.handed_to: dict[_Sampler, set[_Sampler]] = defaultdict(set)
        self.handed_by: dict[_Sampler, set[_Sampler]] = defaultdict(set)
        self.fetches: list[tuple[int, _Sampler]] = []
        names = set(_SAMPLER.findall(self._code))
        self._in_macros = in_macros = set(re.findall(r"[A-Za-z_]\w*", of_macros))
        takers = {name for name, taken in self._takes.items() if taken}
        # Each sampler that the text declares is a uniform, or an argument of a function that is known.
        known = sum(len(_SAMPLER.findall(one.signature)) for one in self._functions)
        known += len(_UNIFORM.findall(self._code))
        self.is_unclear = bool(
            known != len(_SAMPLERS.findall(self._code))
            or in_macros & {"sampler2D", *_ASKED, *names, *takers}
            or _ASKED & self._takes.keys()
        )
        if names and not self.is_unclear:
            for match in re.finditer(rf"\b(?:{'|'.join(sorted(names))})\b", self._code):
                self._look(match.group(), match.start())

    def uniforms_but(self, names: Collection[str]) -> Iterator[_Sampler]:
        """Yield the uniform samplers that have other names than these."""
        yield from (one for one in self.samplers if one[1] < 0 and one[0] not in names)

    def _look(self, name: str, at: int) -> None:
        """Note what one naming of a sampler does."""
        sampler = self._meant(name, at)
        called = call_around(self._code, at)
        function, index, opens = called or ("", 0, at)
        if _DECLARED.search(self._code, max(at - 40, 0), at):
            self.samplers.add(sampler)
        elif function in _ASKED and index == 0:
            self.samplers.add(sampler)
            if function == FETCH and given_to(self._code, opens)[2:] != ["0"]:
                self.used_otherwise.add(sampler)
            elif function == FETCH:
                self.fetches.append((self._code.rindex(FETCH, 0, opens), sampler))
        elif index in self._takes.get(function, ()):
            # Of several functions of a name the text does not say which: the sampler may come to each.
            self.samplers.add(sampler)
            self.handed_to[sampler].add((function, index))
            self.handed_by[function, index].add(sampler)
        elif (
            (index == 0 and _OF_GLSL.match(function))
            or function in self._in_macros
            or (not function and self._is_in_brackets(name, at))
        ):
            self.samplers.add(sampler)
            self.used_otherwise.add(sampler)
        # Anything else is a variable of that name: a sampler can only be handed on.

    def _is_in_brackets(self, name: str, at: int) -> bool:
        """Return whether a name has brackets of its own, within which it is still a sampler."""
        before, after = self._code[:at].rstrip(), self._code[at + len(name) :].lstrip()
        return before.endswith("(") and after.startswith(")")

    def _meant(self, name: str, at: int) -> _Sampler:
        """Return what a name means in some place: an argument of the function around, or a uniform."""
        before = bisect_right(self._starts, at) - 1
        if before >= 0 and at < self._functions[before].end and name in self._names[before]:
            return self._functions[before].name, self._names[before].index(name)
        return name, -1


def _reaching(steps: dict[_Sampler, set[_Sampler]], begun: Collection[_Sampler]) -> set[_Sampler]:
    """Return what is reached from some samplers by steps, themselves included."""
    found, left = set(begun), list(begun)
    while left:
        for step in steps.get(left.pop(), ()):
            if step not in found:
                found.add(step)
                left.append(step)
    return found
