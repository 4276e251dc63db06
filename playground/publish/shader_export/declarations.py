"""Split a shader's text into its declarations, and join those of several passes into one text.

What passes declare alike is there once. Where two passes mean different things by one name, each pass's own
gets the pass's name before it. A declaration is read as a text of its own: a name that it does not declare
stands for what is around it.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

from playground.memo import TEXTS
from playground.shader.conditions import without_guards
from playground.shader.source import Line
from playground.shader.syntax import nodes
from playground.shader.syntax.parser import Tree, parse
from playground.shader.syntax.preprocessor import preprocess
from playground.shader.syntax.symbols import symbols_of
from playground.shader.syntax.tokens import Token, as_written, directive, tokenize, with_edits
from playground.sketch.model import Parameter, Value

_CONDITIONS = ("if", "ifdef", "ifndef", "else", "elif", "endif", "undef")


class Use(NamedTuple):
    """A place of a declaration that names something which stands around it."""

    function: str  # whose argument it is; "" where no call takes it as it is
    start: int  # of the call
    end: int
    at: int  # of the name


@dataclass(frozen=True)
class Declaration:
    """A function, a struct, a macro, a constant or a global variable, with the comment above it."""

    names: tuple[str, ...]  # what it declares
    text: str
    is_macro: bool = False

    @cached_property
    def code(self) -> tuple[str, ...]:
        """Its tokens, without comments."""
        return tuple(token.text for token in tokenize(self.text)[0])

    @cached_property
    def words(self) -> frozenset[str]:
        """Every name in its code, but for members of structs where they are read."""
        return frozenset(token.text for token in _named(as_written(self.text)))

    def reads(self, name: str) -> bool:
        """Return whether it names something that stands around it, or itself."""
        return name in self._places

    @cached_property
    def _places(self) -> dict[str, list[int]]:
        """Where it names what stands around it, or what it declares there."""
        if self.is_macro:
            (macro,) = preprocess(self.text).macros
            parameters = macro.parameters or ()
            body = [token for token in _named(macro.body) if token.text not in parameters]
            named = [(macro.name, macro.at), *((token.text, token.start) for token in body)]
        else:
            symbols = symbols_of(self.text)
            tokens = symbols.tree.tokens
            named = [
                (tokens[one.token].text, tokens[one.token].start)
                for one in symbols.references
                if one.symbol is None or (one.symbol.function is None and one.symbol.kind in _OUTSIDE)
            ]
            has_directives = any(token.startswith("#") for token in self.code)
            if symbols.tree.errors or has_directives:  # statements, or conditions
                named = [(token.text, token.start) for token in _named(as_written(self.text))]
        places: dict[str, list[int]] = {}
        for name, start in named:
            places.setdefault(name, []).append(start)
        return places

    def uses(self, name: str) -> list[Use]:
        """Return where it names something that stands around it, and in which calls."""
        places = self._places.get(name, ())
        return [self._uses.get(place, Use("", place, place + len(name), place)) for place in places]

    @cached_property
    def _uses(self) -> dict[int, Use]:
        """Of each place of a name that is a call's argument."""
        text, shift = self.text, 0
        if self.is_macro:
            (macro,) = preprocess(text).macros
            begin = macro.body[0].start if macro.body else len(text)
            head = "void k() {"
            text, shift = f"{head}{text[begin:]}\n;}}", begin - len(head)
        uses: dict[int, Use] = {}
        stack = [parse(text, all_branches=True)]
        while stack:
            tree = stack.pop()
            stack += tree.branches
            calls = (node for node in nodes.walk(*tree.declarations) if isinstance(node, nodes.Call))
            for call in calls:
                for argument in call.arguments:
                    if isinstance(argument, nodes.Name) and not tree.tokens[argument.first].macros:
                        start, end = tree.span(call)
                        at = tree.span(argument)[0] + shift
                        uses[at] = Use(call.name, start + shift, end + shift, at)
        return uses

    def renamed(self, names: Mapping[str, str]) -> Declaration:
        """Return it with other names, by the old ones; members, parameters and its own variables stay."""
        edits = {
            (place, place + len(old)): new
            for old, new in names.items()
            for place in self._places.get(old, ())
        }
        own = tuple(names.get(name, name) for name in self.names)
        return replace(self, text=with_edits(self.text, edits), names=own) if edits else self

    def with_calls(self, name: str, new: Callable[[str, str, str], str]) -> Declaration:
        """Return it with each call that takes a name as an argument replaced, those in its arguments first.

        ``new`` returns the text of a function, the call up to that argument, and the call behind it.
        """
        text, grown = self.text, list[tuple[int, int]]()
        for use in sorted(self.uses(name), key=lambda use: use.start, reverse=True):
            if use.function:
                end = use.end + sum(more for start, more in grown if use.start < start < use.end)
                fresh = new(use.function, text[use.start : use.at], text[use.at + len(name) : end])
                grown.append((use.start, len(fresh) - (end - use.start)))
                text = text[: use.start] + fresh + text[end:]
        return self if text == self.text else replace(self, text=text)


_OUTSIDE = ("function", "struct", "variable", "uniform", "block")


def declaration_of(text: str, *names: str, is_macro: bool = False) -> Declaration:
    """Return a declaration of our own, which may end in a comment."""
    return Declaration(names, text, is_macro)


def _named(tokens: Iterable[Token]) -> Iterator[Token]:
    """Yield the names among tokens, but for members behind a dot."""
    before = ""
    for token in tokens:
        if token.kind == "word" and before != ".":
            yield token
        before = token.text


def declarations_of(lines: Sequence[Line]) -> tuple[Declaration, ...]:
    """Return what a flattened text declares, in order: all but its uniforms.

    A text that has conditions of its own, or takes a macro back, is one declaration.
    """
    kept = [lines[index] for index in without_guards([line.code for line in lines])]
    printed = [_with_comment(line) for line in kept if line.code.strip() or not _is_mark(line)]
    return _declarations_in("\n".join(printed))


@TEXTS.cached()  # each step of a repeat is a pass of the same text
def _declarations_in(text: str) -> tuple[Declaration, ...]:
    tree = parse(text, all_branches=True)
    directives = [token for token in tokenize(text)[0] if token.kind == "directive"]
    if any(directive(token.text)[0] in _CONDITIONS for token in directives):
        return (_as_one(text, tree),)
    units: list[tuple[int, int, tuple[str, ...], bool]] = []
    units += [(*tree.span(node), names_of(node), False) for node in tree.declarations if not _stays(node)]
    macros = {macro.start: macro.name for macro in preprocess(text).macros}
    for token in directives:
        name = macros.get(token.start)
        units.append((token.start, token.end, (name,) if name else (), name is not None))
    declarations: list[Declaration] = []
    above = 0  # where the last one ends
    for start, end, names, is_macro in sorted(units):
        begin = text.rfind("\n", above, start) + 1 or above
        if start < above:  # of one macro, or of one line
            declarations[-1] = replace(declarations[-1], names=declarations[-1].names + names)
            continue
        following = min((unit[0] for unit in units if unit[0] >= end), default=len(text))
        behind = text.find("\n", end) if "\n" in text[end:following] else following
        above = behind if behind >= 0 else len(text)
        comment: list[str] = []
        for line in reversed(text[:begin].split("\n")[:-1]):
            if not line.lstrip().startswith("//"):
                break
            comment.insert(0, line.lstrip())
        code = [line.rstrip() for line in text[begin:above].split("\n") if line.strip()]
        declarations.append(Declaration(names, "\n".join([*comment, *code]), is_macro))
    return tuple(declarations)


def _as_one(text: str, tree: Tree) -> Declaration:
    names: dict[str, None] = {}
    stack = [tree]
    while stack:
        part = stack.pop()
        stack += part.branches
        for node in part.declarations:
            if not _stays(node):
                names |= dict.fromkeys(names_of(node))
            else:
                start, end = part.span(node)
                text = text[:start] + " " * (end - start) + text[end:]
    lines: list[str] = []  # from the last on: a comment belongs to what is right below it
    is_beside = False
    for line in reversed(text.split("\n")):
        is_comment = line.lstrip().startswith("//")
        is_beside = bool(line.strip()) and (is_beside or not is_comment)
        lines += [line] if is_beside else []
    return Declaration(tuple(names), "\n".join(reversed(lines)))


def _stays(node: nodes.Node) -> bool:
    """Return whether a text is left without something: its uniforms, and what precision numbers have."""
    if isinstance(node, nodes.Declaration):
        return "uniform" in node.type.qualifiers
    return isinstance(node, nodes.Precision | nodes.Empty) or (
        isinstance(node, nodes.InterfaceBlock) and "uniform" in node.qualifiers
    )


def names_of(node: nodes.Node) -> tuple[str, ...]:
    """Return what a declaration declares."""
    if isinstance(node, nodes.Function):
        return (node.name,)
    if not isinstance(node, nodes.Declaration):
        return ()
    struct = node.type.struct
    return (*((struct.name,) if struct and struct.name else ()), *(one.name for one in node.names))


def _is_mark(line: Line) -> bool:
    """Return whether a comment begins or ends what lessons quote."""
    return line.comment.strip().startswith(("anchor: ", "end: "))


def _with_comment(line: Line) -> str:
    """Return a line's code with its comment; an annotation is left out."""
    is_comment = line.comment and not line.pragma and not line.comment.startswith("!")
    if not line.code.strip():
        indent = line.text[: len(line.text) - len(line.text.lstrip())]
        return f"{indent}//{line.comment}" if is_comment else ""
    return f"{line.code.rstrip()}  //{line.comment}" if is_comment else line.code.rstrip()


@dataclass(frozen=True)
class Joined:
    """Declarations of several passes: once what they share, and what each has of its own."""

    shared: tuple[Declaration, ...]
    own: tuple[tuple[Declaration, ...], ...]  # of each pass
    renames: tuple[Mapping[str, str], ...]  # of each pass: how its text's names are called now


def joined(
    passes: Sequence[Sequence[Declaration]],
    prefixes: Sequence[str],
    renames: Sequence[Mapping[str, str]],
    *,
    taken: Collection[str] = (),
) -> Joined:
    """Join passes into one text, in which no name means two things.

    ``renames`` are new names that each pass's text has to have anyway; ``taken`` are those that are
    declared elsewhere. In ``shared`` is everything, in the order that the passes need, and ``own`` is empty.
    """
    names = [dict(rename) for rename in renames]
    while True:
        now = [
            [d.renamed(own) for d in declarations] for declarations, own in zip(passes, names, strict=True)
        ]
        clashes = _clashes(passes, now, names, taken)
        if not clashes:
            break
        for index, name in clashes:
            names[index][name] = _free(f"{prefixes[index]}_{name}", now, taken)
    shared = dict.fromkeys(d for declarations in now for d in declarations)
    return Joined(tuple(_once(shared)), tuple(() for _ in passes), tuple(names))


def _codes(passes: Sequence[Sequence[Declaration]]) -> dict[str, dict[int, tuple[str, ...]]]:
    """Return for each name, by pass, all that declares it there."""
    codes: dict[str, dict[int, tuple[str, ...]]] = {}
    for index, declarations in enumerate(passes):
        for each in declarations:
            for name in each.names:
                by_pass = codes.setdefault(name, {})
                by_pass[index] = (*by_pass.get(index, ()), *each.code)
    return codes


def _once(declarations: Collection[Declaration]) -> list[Declaration]:
    """Return declarations without those whose code is there already."""
    by_code: dict[tuple[str, ...], Declaration] = {}
    for each in declarations:
        by_code.setdefault(each.code, each)
    return list(by_code.values())


def _clashes(
    passes: Sequence[Sequence[Declaration]],
    now: Sequence[Sequence[Declaration]],
    names: Sequence[Mapping[str, str]],
    taken: Collection[str],
) -> list[tuple[int, str]]:
    """Return (pass, name of its text) of what means something else in another pass."""
    codes = _codes(now)
    macros: dict[str, set[int]] = {}
    for index, declarations in enumerate(now):
        for name in (name for each in declarations if each.is_macro for name in each.names):
            macros.setdefault(name, set()).add(index)
    bad = {name for name, by_pass in codes.items() if len(set(by_pass.values())) > 1 or name in taken}
    for name, owners in macros.items():
        others = (declarations for index, declarations in enumerate(now) if index not in owners)
        if any(each.reads(name) for declarations in others for each in declarations):
            bad.add(name)
    clashes = []
    for index, declarations in enumerate(passes):
        for each in declarations:
            for name in each.names:
                if names[index].get(name, name) in bad:
                    clashes.append((index, name))
    return list(dict.fromkeys(clashes))


def _free(name: str, now: Sequence[Sequence[Declaration]], taken: Collection[str]) -> str:
    used = {word for declarations in now for each in declarations for word in each.words} | {*taken}
    while name in used:
        name += "_"
    return name


def with_common(passes: Sequence[Sequence[Declaration]], never: Collection[str]) -> Joined:
    """Return what two passes and more declare alike, apart from what each has of its own.

    What names one of ``never``, or something that is not shared, is not shared.
    """
    codes = _codes(passes)
    alike = {name for name, by_pass in codes.items() if len(by_pass) > 1 and len(set(by_pass.values())) == 1}
    while True:
        now = {
            name
            for name in alike
            if all(
                _may_share(each, name, alike, codes.keys(), never, passes)
                for declarations in passes
                for each in declarations
            )
        }
        if now == alike:
            break
        alike = now
    everything = [each for declarations in passes for each in declarations]
    shared = _once([d for d in everything if d.names and alike.issuperset(d.names)])
    own = tuple(
        tuple(d for d in declarations if not (d.names and alike.issuperset(d.names)))
        for declarations in passes
    )
    return Joined(tuple(shared), own, tuple({} for _ in passes))


def _may_share(
    each: Declaration,
    name: str,
    alike: Collection[str],
    declared: Collection[str],
    never: Collection[str],
    passes: Sequence[Sequence[Declaration]],
) -> bool:
    """Return whether a declaration, if it is one of a name, may stand before every pass."""
    if name not in each.names:
        return True
    words = each.words
    if not words.isdisjoint(never) or any(w in declared and w not in alike for w in words):
        return False
    if not each.is_macro:
        return True
    without = (declarations for declarations in passes if not any(name in d.names for d in declarations))
    return not any(d.reads(name) for declarations in without for d in declarations)


# ── numbers as GLSL ────────────────────────────────────────────────────────────


def literal(kind: str, value: Value) -> str:
    """Return a value of a GLSL type as a constant expression."""
    if isinstance(value, tuple | list):
        scalar = {"i": "int", "u": "uint"}.get(kind[0], "float")
        return f"{kind}({', '.join(literal(scalar, number) for number in value)})"
    if kind == "bool":
        return "true" if value else "false"
    if kind == "float":
        return number(float(value))
    return f"{int(value)}u" if kind == "uint" else str(int(value))


def number(value: float) -> str:
    """Return a float that no compiler takes for a whole number."""
    text = repr(float(value))
    return text if any(mark in text for mark in ".e") else f"{text}.0"


def vector(values: Sequence[float]) -> str:
    """Return a vec2 to vec4."""
    return f"vec{len(values)}({', '.join(map(number, values))})"


def meaning(parameter: Parameter) -> str:
    """Return what a parameter may be, and is for, as a comment says it."""
    widget = parameter.widget
    parts = []
    if widget.choices:
        parts.append(", ".join(f"{index} {choice}" for index, choice in enumerate(widget.choices)))
    elif widget.low is not None and widget.high is not None:
        parts.append(f"{widget.low:g} to {widget.high:g}")
    elif widget.kind == "direction":
        parts.append("azimuth, elevation in degrees")
    elif widget.kind == "colour":
        parts.append("linear light")
    if parameter.unit and widget.kind != "direction":
        parts.append(parameter.unit)
    return ": ".join(filter(None, [" ".join(parts), parameter.tooltip]))
