"""Read what a text does with its samplers: which inputs it fetches texel by texel, and which texels of them.

A function may be handed samplers: a parameter means what every call hands it, up the chain of calls. All
branches of conditions count, since stages and drivers differ; of a text that is no GLSL with all of them,
nothing is returned. What is fetched from and not declared is a uniform that stands around the text.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from playground.memo import TEXTS
from playground.shader.kernel import Kernel, PlainShader
from playground.shader.source import SourceText
from playground.shader.syntax.nodes import (
    Call,
    Function,
    Literal,
    Member,
    Name,
    Node,
    Parenthesized,
    walk,
)
from playground.shader.syntax.parser import parse
from playground.shader.syntax.symbols import CallSite, Symbol, Symbols, has_same_signature, resolve
from playground.shader.syntax.tokens import directive, tokenize

_MAYBE_FIXED = re.compile(r"\bivec2\s*\(\s*\d")
_MARK = re.compile(r"^[ \t]*#(?:[^\n\\]|\\\n|\\.)*|[{};]", re.MULTILINE)  # ends of parts; directives whole
_UNIFORM = re.compile(r"\buniform\b[^;]*?\bsampler2D\s+([A-Za-z_]\w*)")
_MAX_DIGITS = 4  # of a coordinate


@dataclass(frozen=True, slots=True)
class FetchedAlone:
    """What of a text reads inputs by ``texelFetch`` alone."""

    inputs: frozenset[str] = frozenset()
    fetches: tuple[tuple[int, int], ...] = ()  # of level 0, of these inputs: line and column, both from 0


def fetched_alone(kernel: Kernel) -> FetchedAlone:
    """Return what of a kernel reads inputs by ``texelFetch`` alone; nothing of a plain shader.

    How a sampler filters and what it gives outside of its texture count for none of these inputs. A function
    that is handed samplers reads one of these inputs if it is handed nothing else, by any call. A fetch that
    a macro writes is none of ``fetches``: there it cannot be replaced.
    """
    if isinstance(kernel, PlainShader):
        return FetchedAlone()
    return _fetched_alone(kernel.source, tuple([declared.name for declared in kernel.inputs]))


@TEXTS.cached()
def _fetched_alone(source: SourceText, inputs: tuple[str, ...]) -> FetchedAlone:
    if "texelFetch" not in source.names or not inputs:
        return FetchedAlone()
    reads = _reads(source.code)
    others = {sampler for name, sampler in reads.uniforms.items() if name not in inputs}
    free = _reaching(reads.handed_by, reads.used_otherwise | others)
    # A function that may be handed another sampler too fetches as it did.
    mixed = _reaching(reads.handed_to, free | reads.unclear)
    alone = {name: sampler for name, sampler in reads.uniforms.items() if sampler not in free}
    reached = _reaching(reads.handed_to, set(alone.values())) - mixed
    fetches = [place for place, sampler in reads.fetches if sampler in reached]
    return FetchedAlone(frozenset(alone), tuple(fetches))


def _reaching(steps: Mapping[int, set[int]], starts: set[int]) -> set[int]:
    """Return what is reached from some samplers by steps, themselves included."""
    samplers, left = set(starts), list(starts)
    while left:
        new = steps.get(left.pop(), set()) - samplers
        samplers |= new
        left += new
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


def fixed_texels(source: SourceText) -> tuple[FixedTexel, ...]:
    """Return the fetches of a flattened text at a place written as numbers, in its order.

    A function may fetch from a sampler that it is handed: then every call, up the chain of calls, must hand
    it the input of that name, else the text does not say which texture is read. What a macro writes is left
    alone.
    """
    return _reads(source.code).fixed if _may_be_fixed(source) else ()


def read_by_texels_alone(source: SourceText) -> frozenset[str]:
    """Return the samplers of which a flattened text reads nothing but what ``fixed_texels`` finds."""
    return _reads(source.code).fixed_alone if _may_be_fixed(source) else frozenset()


def _may_be_fixed(source: SourceText) -> bool:
    """Return whether a text may have such fetches; parsing most texts is spared."""
    return "texelFetch" in source.names and _MAYBE_FIXED.search(source.code) is not None


@dataclass(slots=True)
class _Reads:
    """What a text does with its samplers, each a number: a uniform, or a parameter of a function."""

    uniforms: dict[str, int] = field(default_factory=dict)
    handed_to: dict[int, set[int]] = field(default_factory=lambda: defaultdict(set))
    handed_by: dict[int, set[int]] = field(default_factory=lambda: defaultdict(set))
    unclear: set[int] = field(default_factory=set)  # parameters that are handed something else too
    used_otherwise: set[int] = field(default_factory=set)  # than fetched at level 0, handed on, or measured
    fetches: list[tuple[tuple[int, int], int]] = field(default_factory=list)  # place, sampler
    fixed: tuple[FixedTexel, ...] = ()
    fixed_alone: frozenset[str] = frozenset()


@TEXTS.cached()
def _reads(code: str) -> _Reads:
    symbols = resolve(parse(_with_samplers(code), all_branches=True))
    preprocessed = symbols.tree.preprocessed
    if symbols.tree.errors or preprocessed.inactive or preprocessed.is_truncated:
        return _Reads()
    return _Reader(symbols).reads()


def _with_samplers(code: str) -> str:
    """Return a text with blanks in place of the functions that name no sampler: half of it is parsed."""
    words = {"sampler2D", "texelFetch", *_UNIFORM.findall(code)}
    defines = [directive(line) for line in code.split("\n") if "define" in line]
    macros = [[one.text for one in tokenize(text)[0]] for word, text in defines if word == "define"]
    macros = [macro for macro in macros if macro]
    while new := {name for name, *body in macros if name not in words and not words.isdisjoint(body)}:
        words |= new
    names_one = re.compile(rf"\b(?:{'|'.join(words)})\b").search
    parts, start, depth, opens = list[str](), 0, 0, -1
    for match in _MARK.finditer(code):
        mark = match[0]
        depth += (mark == "{") - (mark == "}")
        if mark == "{" and depth == 1:
            opens = match.start()
        if depth == 0 and mark != "{":
            part = code[start : match.end()]
            if mark == "}" and code[:opens].endswith((")", ") ", ")\n")) and not names_one(part):
                part = "\n".join([" " * len(line) for line in part.split("\n")])
            parts.append(part)
            start = match.end()
    return "".join([*parts, code[start:]])


class _Reader:
    """Reads the calls of a text that have samplers as arguments."""

    def __init__(self, symbols: Symbols) -> None:
        self._symbols = symbols
        self._tree = symbols.tree
        declared = [
            symbol
            for symbol in symbols.symbols
            if symbol.type == "sampler2D" and not symbol.arrays and symbol.kind in ("uniform", "parameter")
        ]
        parameters = [symbol for symbol in declared if symbol.kind == "parameter"]
        fetched = [site.node.arguments[0] for site in symbols.calls if _is_fetch(site)]
        around = [one.name for one in fetched if isinstance(one, Name) and one.first not in symbols.symbol_at]
        samplers: dict[Symbol | str, None] = dict.fromkeys([*declared, *around])
        self._numbers = {key: number for number, key in enumerate(samplers)}
        self._names = [key if isinstance(key, str) else key.name for key in self._numbers]
        self._parameters = {id(one.node): self._numbers[one] for one in parameters}
        self._functions: dict[str, list[Symbol]] = defaultdict(list)
        for function in symbols.functions():
            self._functions[function.name].append(function)
        self._fetches: dict[Call, int] = {}
        uniforms = set(self._numbers.values()) - set(self._parameters.values())
        self._reads = _Reads({self._names[number]: number for number in sorted(uniforms)})

    def reads(self) -> _Reads:
        reads, tree = self._reads, self._tree
        arguments, measured = set[int](), set[int]()  # tokens, samplers
        for site in self._symbols.calls:
            for index, argument in enumerate(site.node.arguments):
                number, token = self._sampler(argument)
                arguments.add(token)
                self._hand(site, index, number)
                if number < 0 or site.functions:
                    continue
                if index == 0 and _is_fetch(site) and _is_zero(site.node.arguments[2:3]):
                    self._fetches[site.node] = number
                elif site.node.name == "textureSize":
                    measured.add(number)
                else:
                    reads.used_otherwise.add(number)
        for one in self._symbols.references:
            number = self._numbers.get(one.symbol or tree.tokens[one.token].text, -1)
            is_declaration = one.symbol is not None and one.token == one.symbol.token
            if number >= 0 and not is_declaration and one.token not in arguments:
                reads.used_otherwise.add(number)
        reads.fetches = sorted(
            (tree.place(tree.tokens[call.at].start), number)
            for call, number in self._fetches.items()
            if not tree.tokens[call.at].macros
        )
        fixed = self._fixed()
        reads.fixed = tuple(sorted(fixed.values(), key=lambda texel: (texel.line, texel.start)))
        others = {number for call, number in self._fetches.items() if call not in fixed}
        others |= measured | reads.used_otherwise
        names = {texel.input for texel in reads.fixed} & reads.uniforms.keys()
        reads.fixed_alone = frozenset(
            name for name in names if others.isdisjoint(_reaching(reads.handed_to, {reads.uniforms[name]}))
        )
        return reads

    def _sampler(self, argument: Node) -> tuple[int, int]:
        """Return the number of the sampler that an argument is, and its token; -1 for anything else."""
        while isinstance(argument, Parenthesized):
            argument = argument.inside
        if not isinstance(argument, Name):
            return -1, -1
        number = self._numbers.get(self._symbols.symbol_at.get(argument.first, argument.name), -1)
        return number, argument.first

    def _hand(self, site: CallSite, index: int, number: int) -> None:
        """Note which parameters an argument of a call is handed to: of each function that it may mean."""
        for callee in site.functions:
            for other in self._functions[callee.name]:
                parameters = other.node.parameters if isinstance(other.node, Function) else []
                place = id(parameters[index]) if index < len(parameters) else 0
                if place not in self._parameters or not has_same_signature(other.node, callee.node):
                    continue
                if number < 0:
                    self._reads.unclear.add(self._parameters[place])
                else:
                    self._reads.handed_to[number].add(self._parameters[place])
                    self._reads.handed_by[self._parameters[place]].add(number)

    def _fixed(self) -> dict[Call, FixedTexel]:
        """Return the fetches at places written as numbers from what is surely a uniform."""
        tree, nodes = self._tree, walk(*self._tree.declarations) if self._fetches else ()
        members = {node.base: node.name for node in nodes if isinstance(node, Member)}
        texels: dict[Call, FixedTexel] = {}
        for call, number in self._fetches.items():
            texel, name = _texel(call.arguments[1]), self._names[number]
            (line, start), (last, end) = map(tree.place, tree.span(call))
            is_written = line == last and not any(one.macros for one in tree.tokens[call.first : call.last])
            sources = _reaching(self._reads.handed_by, {number})
            is_uniform = sources.isdisjoint(self._reads.unclear) and all(
                self._names[source] == name for source in sources
            )
            if texel and is_written and is_uniform:
                taken = _components(members.get(call, ""))
                texels[call] = FixedTexel(name, *texel, line, start, end, taken)
        return texels


def _is_fetch(site: CallSite) -> bool:
    return site.node.name == "texelFetch" and not site.functions and len(site.node.arguments) > 1


def _is_zero(nodes: Sequence[Node]) -> bool:
    return any(isinstance(node, Literal) and node.text == "0" for node in nodes)


def _texel(node: Node) -> tuple[int, int] | None:
    """Return the numbers of ``ivec2(5, 0)`` or ``ivec2(3)``; None for anything else."""
    if not isinstance(node, Call) or node.name != "ivec2" or node.arrays or not 1 <= len(node.arguments) <= 2:
        return None
    texts = [one.text for one in node.arguments if isinstance(one, Literal)]
    if len(texts) != len(node.arguments) or not all(map(_is_coordinate, texts)):
        return None
    return int(texts[0]), int(texts[-1])


def _is_coordinate(text: str) -> bool:
    """Return whether a literal is a whole number, in decimal."""
    return text.isdecimal() and len(text) <= _MAX_DIGITS and (text == "0" or text[0] != "0")


def _components(swizzle: str) -> frozenset[int]:
    names = next((names for names in ("xyzw", "rgba", "stpq") if set(swizzle) <= set(names)), "")
    return frozenset(map(names.index, swizzle)) if swizzle and names else frozenset(range(4))
