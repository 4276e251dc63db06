"""Read what a text does with its samplers: which inputs it fetches texel by texel, and which texels of them.

A function may be handed samplers: an argument means what every call hands it, up the chain of calls. What a
macro writes is not read; what it might mean counts as another use.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections import defaultdict
from collections.abc import Collection, Iterator
from dataclasses import dataclass

from playground.memo import TEXTS
from playground.shader.kernel import Kernel, PlainShader
from playground.shader.outline import Declared, outline
from playground.shader.source import SourceText

_DIRECTIVE = re.compile(r"^[ \t]*#(?:[^\n\\]|\\\n|\\[^\n])*", re.MULTILINE)  # and its further lines
_NAME = re.compile(r"[A-Za-z_]\w*")
_CALLED = re.compile(r"([A-Za-z_]\w*)\s*\Z")
_BRACKETS = re.compile(r"[()\[\],]")
_OPENS = re.compile(r"\s*\(")
_ASKED = frozenset({"texelFetch", "textureSize"})  # functions of GLSL, whose first argument is a sampler
_OF_GLSL = re.compile(r"texture|texel|shadow")  # its functions that take samplers begin so
_SAMPLER = re.compile(r"\bsampler2D\s+([A-Za-z_]\w*)")
_DECLARED = re.compile(r"\bsampler2D\s+\Z")
_UNIFORM = re.compile(r"\buniform\s+(?:(?:highp|mediump|lowp)\s+)?sampler2D\s+[A-Za-z_]\w*\s*;")
_SAMPLERS = re.compile(r"\bsampler2D\b")
_FETCH = re.compile(
    r"\btexelFetch[ \t]*\([ \t]*([A-Za-z_]\w*)[ \t]*,[ \t]*"
    r"ivec2[ \t]*\([ \t]*(\d{1,4})[ \t]*(?:,[ \t]*(\d{1,4})[ \t]*)?\)[ \t]*,[ \t]*0[ \t]*\)"
)
_COMPONENTS = re.compile(r"[ \t]*\.[ \t]*([xyzw]{1,4}|[rgba]{1,4}|[stpq]{1,4})\b")
_DECLARES = re.compile(r"\bsampler2D[ \t]+$")


def _without_directives(code: str) -> str:
    """Return a text as long as this one, with spaces in place of its directives."""
    return _DIRECTIVE.sub(lambda match: re.sub(r"[^\n]", " ", match.group()), code)


def _arguments_of(signature: str) -> list[str]:
    """Return the names of a function's arguments; "" for one without."""
    inside = signature[signature.index("(") + 1 : signature.rindex(")")]
    return [(_NAME.findall(part) or [""])[-1] for part in inside.split(",")]


def _given_to(code: str, at: int) -> list[str]:
    """Return the arguments of the call whose bracket opens at a place, or behind white space there."""
    opens = _OPENS.match(code, at)
    if opens is None:
        return []
    names, depth, start = [], 1, opens.end()
    for mark in _BRACKETS.finditer(code, opens.end()):
        if mark.group() in "([":
            depth += 1
        elif mark.group() in ")]":
            depth -= 1
        if depth == 0 or (depth == 1 and mark.group() == ","):
            names.append(code[start : mark.start()].strip())
            start = mark.end()
        if depth == 0:
            return names
    return []


def _call_around(code: str, at: int) -> tuple[str, int, int] | None:
    """Return of the call that has an argument at a place its name, which argument it is, and its bracket.

    None where no bracket of a call is open there.
    """
    depth, index, opens = 0, 0, at - 1
    while opens >= 0 and not (depth == 0 and code[opens] in "(;{"):
        mark = code[opens]
        depth += (mark in ")]") - (mark in "([")
        index += mark == "," and depth == 0
        opens -= 1
    called = _CALLED.search(code, max(opens - 80, 0), max(opens, 0))
    return (called[1], index, opens) if called and opens >= 0 and code[opens] == "(" else None


_Sampler = tuple[str, int]  # a function and which of its arguments; of a uniform its name and -1


@dataclass(frozen=True, slots=True)
class FetchedAlone:
    """What of a text reads inputs by ``texelFetch`` alone."""

    inputs: frozenset[str] = frozenset()
    fetches: tuple[tuple[int, int], ...] = ()  # of level 0, of these inputs: line and column, both from 0


def fetched_alone(kernel: Kernel) -> FetchedAlone:
    """Return what of a kernel reads inputs by ``texelFetch`` alone; nothing of a plain shader.

    How a sampler filters and what it gives outside of its texture count for none of these inputs. A function
    that is handed samplers reads one of these inputs if it is handed nothing else, by any call. What a macro
    writes is not read: what it might mean counts as another use.
    """
    if isinstance(kernel, PlainShader):
        return FetchedAlone()
    return _fetched_alone(kernel.source, tuple([declared.name for declared in kernel.inputs]))


@TEXTS.cached()
def _fetched_alone(source: SourceText, inputs: tuple[str, ...]) -> FetchedAlone:
    if "texelFetch" not in source.names or not inputs:
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
    result = []
    for at in sorted(places):
        line = bisect_right(lines, at) - 1
        result.append((line, at - lines[line]))
    return FetchedAlone(alone, tuple(result))


class _Uses:
    """What a text does with its samplers."""

    def __init__(self, code: str) -> None:
        self._code = _without_directives(code)
        of_macros = " ".join(match.group() for match in _DIRECTIVE.finditer(code))
        self._functions = [
            item for item in outline(code) if item.kind == "function" and "(" in item.signature
        ]
        self._starts = [function.start for function in self._functions]
        self._names = [_arguments_of(function.signature) for function in self._functions]
        self._takes: dict[str, set[int]] = defaultdict(set)  # which arguments of a function are samplers
        for function in self._functions:
            inside = function.signature[function.signature.index("(") :].split(",")
            self._takes[function.name] |= {i for i, part in enumerate(inside) if _SAMPLER.search(part)}
        self.samplers: set[_Sampler] = set()
        self.used_otherwise: set[_Sampler] = set()
        self.handed_to: dict[_Sampler, set[_Sampler]] = defaultdict(set)
        self.handed_by: dict[_Sampler, set[_Sampler]] = defaultdict(set)
        self.fetches: list[tuple[int, _Sampler]] = []
        names = set(_SAMPLER.findall(self._code))
        self._in_macros = in_macros = set(re.findall(r"[A-Za-z_]\w*", of_macros))
        takers = {name for name, taken in self._takes.items() if taken}
        # Each sampler that the text declares is a uniform, or an argument of a function that is known.
        declared_samplers = sum(len(_SAMPLER.findall(function.signature)) for function in self._functions)
        declared_samplers += len(_UNIFORM.findall(self._code))
        self.is_unclear = bool(
            declared_samplers != len(_SAMPLERS.findall(self._code))
            or in_macros & {"sampler2D", *_ASKED, *names, *takers}
            or _ASKED & self._takes.keys()
        )
        if names and not self.is_unclear:
            for match in re.finditer(rf"\b(?:{'|'.join(sorted(names))})\b", self._code):
                self._look(match.group(), match.start())

    def uniforms_but(self, names: Collection[str]) -> Iterator[_Sampler]:
        """Yield the uniform samplers that have other names than these."""
        yield from (sampler for sampler in self.samplers if sampler[1] < 0 and sampler[0] not in names)

    def _look(self, name: str, at: int) -> None:
        """Note what one naming of a sampler does."""
        sampler = self._meant(name, at)
        called = _call_around(self._code, at)
        function, index, opens = called or ("", 0, at)
        if _DECLARED.search(self._code, max(at - 40, 0), at):
            self.samplers.add(sampler)
        elif function in _ASKED and index == 0:
            self.samplers.add(sampler)
            if function == "texelFetch" and _given_to(self._code, opens)[2:] != ["0"]:
                self.used_otherwise.add(sampler)
            elif function == "texelFetch":
                self.fetches.append((self._code.rindex("texelFetch", 0, opens), sampler))
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


def _reaching(steps: dict[_Sampler, set[_Sampler]], starts: Collection[_Sampler]) -> set[_Sampler]:
    """Return what is reached from some samplers by steps, themselves included."""
    samplers, left = set(starts), list(starts)
    while left:
        for step in steps.get(left.pop(), ()):
            if step not in samplers:
                samplers.add(step)
                left.append(step)
    return samplers


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


@TEXTS.cached()
def fixed_texels(source: SourceText) -> tuple[FixedTexel, ...]:
    """Return the fetches of a flattened text at a place written as numbers, in its order.

    A function may fetch from a sampler that it is handed: then every call, up the chain of calls, must hand
    it the input of that name, else the text does not say which texture is read. What a macro writes is left
    alone.
    """
    if "texelFetch" not in source.names:
        return ()
    matches = [(match.start(), match) for match in _FETCH.finditer(source.code)]
    if not matches:
        return ()
    text = _Text(source.code)
    texels = []
    for at, match in matches:
        if not text.reads_uniform(match[1], at):
            continue
        line_start = source.code.rfind("\n", 0, at) + 1
        line, x = source.code.count("\n", 0, at), int(match[2])
        y = x if match[3] is None else int(match[3])
        taken = _COMPONENTS.match(source.code, match.end())
        components = frozenset(_index(letter) for letter in (taken[1] if taken else "xyzw"))
        start, end = at - line_start, match.end() - line_start
        texels.append(FixedTexel(match[1], x, y, line, start, end, components))
    return tuple(texels)


@TEXTS.cached()
def read_by_texels_alone(source: SourceText) -> frozenset[str]:
    """Return the samplers of which a flattened text reads nothing but what ``fixed_texels`` finds."""
    starts: dict[str, set[int]] = {}
    lines = [0, *(match.end() for match in re.finditer("\n", source.code))]
    for texel in fixed_texels(source):
        starts.setdefault(texel.input, set()).add(lines[texel.line] + texel.start)
    if not starts:
        return frozenset()
    text = _Text(source.code)
    return frozenset([name for name, offset in starts.items() if text.has_no_other_use(name, offset)])


def _index(component: str) -> int:
    return next(names.index(component) for names in ("xyzw", "rgba", "stpq") if component in names)


class _Text:
    """The functions of a text, and what their samplers stand for."""

    def __init__(self, code: str) -> None:
        directives = list(_DIRECTIVE.finditer(code))
        self.directives = [match.span() for match in directives]
        self.code = _without_directives(code)
        self.of_macros = " ".join([match.group() for match in directives])
        self.functions: list[Declared] = [
            function for function in outline(code) if function.kind == "function"
        ]

    def reads_uniform(self, sampler: str, at: int, seen: frozenset[str] = frozenset()) -> bool:
        """Return whether a name in some place stands for the uniform of that name, and for nothing else."""
        if any(start <= at < end for start, end in self.directives):
            return False
        if re.search(rf"\bdefine[ \t]+(?:{sampler}|texelFetch|ivec2)\b", self.of_macros):
            return False
        around = next(
            (
                function
                for function in self.functions
                if function.body >= 0 and function.start <= at < function.end
            ),
            None,
        )
        if around is None:
            return False
        arguments = _arguments_of(around.signature)
        if sampler not in arguments:
            return True
        if around.name in seen:
            return True  # a recursion, which is judged where it is entered
        alike = [
            function for function in self.functions if function.name == around.name and function.body >= 0
        ]
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
        call = _call_around(self.code, at)
        if call is None:
            return False
        name, index, opens = call
        alike = [function for function in self.functions if function.name == name]
        arguments = _given_to(self.code, opens) if alike else []
        if len(arguments) <= index or arguments[index] != sampler:
            return False
        parameters = [_arguments_of(function.signature) for function in alike]
        return all(len(arguments) > index and arguments[index] == sampler for arguments in parameters)

    def _is_handed(self, function: Declared, index: int, sampler: str, seen: frozenset[str]) -> bool:
        """Return whether each call hands a function the uniform of a name as its argument of that index."""
        declared = {item.at for item in self.functions if item.name == function.name}
        for call in re.finditer(rf"\b{function.name}\b", self.code):
            if call.start() in declared:
                continue
            arguments = _given_to(self.code, call.end())
            if len(arguments) <= index or arguments[index] != sampler:
                return False
            if not self.reads_uniform(sampler, call.start(), seen):
                return False
        return True
