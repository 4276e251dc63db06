"""Find the texels that a kernel fetches at a place written as numbers: the same for all that it computes.

    texelFetch(daylight, ivec2(5, 0), 0)

A function may fetch from a sampler that it is handed: then every call, up the chain of calls, must hand
it the input of that name, else the text does not say which texture is read. What a macro writes is left
alone. Of an input of which a text reads nothing else, these texels are all that counts.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass
from functools import lru_cache

from playground.shader.outline import (
    DIRECTIVE,
    Declared,
    arguments_of,
    call_around,
    given_to,
    outline,
    without_directives,
)
from playground.shader.source import SourceText

_FETCH = re.compile(
    r"\btexelFetch[ \t]*\([ \t]*([A-Za-z_]\w*)[ \t]*,[ \t]*"
    r"ivec2[ \t]*\([ \t]*(\d{1,4})[ \t]*(?:,[ \t]*(\d{1,4})[ \t]*)?\)[ \t]*,[ \t]*0[ \t]*\)"
)
_COMPONENTS = re.compile(r"[ \t]*\.[ \t]*([xyzw]{1,4}|[rgba]{1,4}|[stpq]{1,4})\b")
_DECLARES = re.compile(r"\bsampler2D[ \t]+$")


@dataclass(frozen=True, slots=True)
class FixedTexel:
    """One fetch of a text: which texel of which input, and where the text has it."""

    input: str
    x: int  # [texels]
    y: int  # [texels]
    line: int  # of the text, from 0
    start: int  # column, from 0
    end: int  # behind it
    components: frozenset[int] = frozenset(range(4))  # what the text takes of it


@lru_cache(maxsize=256)
def fixed_texels(source: SourceText) -> tuple[FixedTexel, ...]:
    """Return the fetches of a flattened text that read one texel of a uniform sampler, in its order."""
    if "texelFetch" not in source.names:
        return ()
    found = [(match.start(), match) for match in _FETCH.finditer(source.code)]
    if not found:
        return ()
    text = _Text(source.code)
    texels = []
    for at, match in found:
        if not text.reads_uniform(match[1], at):
            continue
        line_start = source.code.rfind("\n", 0, at) + 1
        line, x = source.code.count("\n", 0, at), int(match[2])
        y = x if match[3] is None else int(match[3])
        taken = _COMPONENTS.match(source.code, match.end())
        components = frozenset(_index(one) for one in (taken[1] if taken else "xyzw"))
        start, end = at - line_start, match.end() - line_start
        texels.append(FixedTexel(match[1], x, y, line, start, end, components))
    return tuple(texels)


@lru_cache(maxsize=256)
def read_by_texels_alone(source: SourceText) -> frozenset[str]:
    """Return the samplers of which a flattened text reads nothing but what ``fixed_texels`` finds."""
    starts: dict[str, set[int]] = {}
    lines = [0, *(match.end() for match in re.finditer("\n", source.code))]
    for texel in fixed_texels(source):
        starts.setdefault(texel.input, set()).add(lines[texel.line] + texel.start)
    if not starts:
        return frozenset()
    text = _Text(source.code)
    return frozenset([name for name, known in starts.items() if text.has_no_other_use(name, known)])


def _index(component: str) -> int:
    return next(names.index(component) for names in ("xyzw", "rgba", "stpq") if component in names)


class _Text:
    """The functions of a text, and what their samplers stand for."""

    def __init__(self, code: str) -> None:
        directives = list(DIRECTIVE.finditer(code))
        self.directives = [match.span() for match in directives]
        self.code = without_directives(code)
        self.of_macros = " ".join([match.group() for match in directives])
        self.functions: list[Declared] = [one for one in outline(code) if one.kind == "function"]

    def reads_uniform(self, sampler: str, at: int, seen: frozenset[str] = frozenset()) -> bool:
        """Return whether a name in some place stands for the uniform of that name, and for nothing else."""
        if any(start <= at < end for start, end in self.directives):
            return False
        if re.search(rf"\bdefine[ \t]+(?:{sampler}|texelFetch|ivec2)\b", self.of_macros):
            return False
        around = next((one for one in self.functions if one.body >= 0 and one.start <= at < one.end), None)
        if around is None:
            return False
        arguments = arguments_of(around.signature)
        if sampler not in arguments:
            return True
        if around.name in seen:
            return True  # a recursion, which is judged where it is entered
        alike = [one for one in self.functions if one.name == around.name and one.body >= 0]
        if len(alike) > 1 or re.search(rf"\b{around.name}\b", self.of_macros):
            return False
        return self._is_handed(around, arguments.index(sampler), sampler, seen | {around.name})

    def has_no_other_use(self, sampler: str, fetches: Collection[int]) -> bool:
        """Return whether a name is only declared, fetched from at these places, and handed on as itself."""
        name = re.compile(rf"\b{sampler}\b")
        if name.search(self.of_macros):
            return False
        for match in name.finditer(self.code):
            before = self.code[: match.start()]
            opens = before.rfind("(")
            if opens >= 0 and re.search(r"\btexelFetch[ \t]*$", before[:opens]):
                fetch = before.rfind("texelFetch")
                if fetch not in fetches or before[opens + 1 :].strip():
                    return False
            elif not _DECLARES.search(before) and not self._is_handed_on(match.start(), sampler):
                return False
        return True

    def _is_handed_on(self, at: int, sampler: str) -> bool:
        """Return whether a name in some place is an argument of a function that calls it so too."""
        call = call_around(self.code, at)
        if call is None:
            return False
        name, index, opens = call
        alike = [one for one in self.functions if one.name == name]
        given = given_to(self.code, opens) if alike else []
        if len(given) <= index or given[index] != sampler:
            return False
        known = [arguments_of(one.signature) for one in alike]
        return all(len(arguments) > index and arguments[index] == sampler for arguments in known)

    def _is_handed(self, function: Declared, index: int, sampler: str, seen: frozenset[str]) -> bool:
        """Return whether each call hands a function the uniform of a name as its argument of that index."""
        declared = {one.at for one in self.functions if one.name == function.name}
        for call in re.finditer(rf"\b{function.name}\b", self.code):
            if call.start() in declared:
                continue
            given = given_to(self.code, call.end())
            if len(given) <= index or given[index] != sampler:
                return False
            if not self.reads_uniform(sampler, call.start(), seen):
                return False
        return True
