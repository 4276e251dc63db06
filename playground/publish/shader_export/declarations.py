"""Split a shader's text into its declarations, and join those of several passes into one text.

What passes declare alike is there once. Where two passes mean different things by one name, each
pass's own gets the pass's name before it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from playground.shader.preprocessor import without_guards
from playground.shader.source import Line
from playground.sketch.model import Parameter, Value

_DIRECTIVE = re.compile(r"\s*#\s*(\w+)\s*(\w*)")
_UNIFORM = re.compile(r"\s*(?:layout\s*\([^)]*\)\s*)?uniform\b")
_FUNCTION = re.compile(r"\b[A-Za-z_]\w*\s+([A-Za-z_]\w*)\s*\(")
_STRUCT = re.compile(r"\s*struct\s+(\w+)")
_VARIABLES = re.compile(r"\s*(?:(?:const|in|out|flat|highp|mediump|lowp)\s+)*[A-Za-z_]\w*\s+(.*)", re.DOTALL)
_ARGUMENT = re.compile(r"[A-Za-z_]\w*\s+([A-Za-z_]\w*)\s*(?:\[[^\]]*\]\s*)?[,)]")
_WORD = re.compile(r"(?<![\w.])[A-Za-z_]\w*")
_MEMBER = re.compile(r"([A-Za-z_]\w*)(?=\s*(?:\[[^\]]*\]\s*)?[;,])")
_MARK = re.compile(r"\s*(?:anchor|end): \w+\s*$")  # what lessons quote lies between these
_CONDITIONS = ("if", "ifdef", "ifndef", "else", "elif", "endif", "undef")


@dataclass(frozen=True)
class Declaration:
    """A function, a struct, a macro, a constant or a global variable, with the comment above it."""

    names: tuple[str, ...]  # what it declares
    code: str  # without comments
    text: str  # with them
    is_macro: bool = False

    def reads(self, name: str) -> bool:
        """Return whether its code names something."""
        return name in self.words

    @cached_property
    def words(self) -> frozenset[str]:
        """Every name in its code, but for members of structs where they are read."""
        return frozenset(_WORD.findall(self.code))

    @cached_property
    def arguments(self) -> frozenset[str]:
        """What a function calls its arguments, which hide what the names mean elsewhere."""
        head = self.code[: self.code.find("{")]
        return frozenset(_ARGUMENT.findall(head[head.find("(") :])) if "(" in head else frozenset()

    def edited(self, edit: Callable[[str], str]) -> Declaration:
        """Return it with its code and its text edited; its names stay."""
        return replace(self, code=edit(self.code), text=edit(self.text))

    def renamed(self, names: Mapping[str, str]) -> Declaration:
        """Return it with other names, by the old ones."""
        names = {old: new for old, new in names.items() if old in self.words and old not in self.arguments}
        if not names:
            return self
        own = tuple(names.get(n, n) for n in self.names)
        return replace(self.edited(lambda text: _renamed(text, names)), names=own)


def declaration_of(text: str, *names: str, is_macro: bool = False) -> Declaration:
    """Return a declaration of our own, which may end in a comment."""
    return Declaration(names, re.sub(r"//.*", "", text).rstrip(), text, is_macro)


def declarations_of(lines: Sequence[Line]) -> list[Declaration]:
    """Return what a flattened text declares, in order: all but its uniforms.

    A text that has conditions of its own, or takes a macro back, is one declaration.
    """
    kept = [lines[index] for index in without_guards([line.code for line in lines])]
    declarations: list[Declaration] = []
    above: list[str] = []  # comments
    codes: list[str] = []
    texts: list[str] = []
    depth = 0
    for line in kept:
        code = line.code
        if not code.strip():
            is_comment = line.comment and not line.pragma and not line.comment.startswith("!")
            is_mark = _MARK.match(line.comment)
            if codes:
                texts += [_with_comment(line)] if is_comment and not is_mark else []
            elif not is_mark:
                above = [*above, f"//{line.comment}"] if is_comment else []
            continue
        codes.append(code)
        texts.append(_with_comment(line))
        depth += sum(code.count(a) for a in "{([") - sum(code.count(a) for a in "})]")
        directive = _DIRECTIVE.match(code) if len(codes) == 1 else None
        if not directive and (depth > 0 or not code.rstrip().endswith((";", "}"))):
            continue
        if not _UNIFORM.match(codes[0]) and not codes[0].lstrip().startswith("precision "):
            written = "\n".join(codes)
            names = (directive.group(2),) if directive else _names_in(written)
            is_macro = directive is not None and directive.group(1) == "define"
            declarations.append(Declaration(names, written, "\n".join([*above, *texts]), is_macro))
        above, codes, texts, depth = [], [], [], 0
    directives = [_DIRECTIVE.match(d.code) for d in declarations]
    if any(d and d.group(1) in _CONDITIONS for d in directives):
        whole = tuple(dict.fromkeys(name for d in declarations if not d.is_macro for name in d.names if name))
        return [
            Declaration(
                whole, "\n".join(d.code for d in declarations), "\n".join(d.text for d in declarations)
            )
        ]
    return declarations


def _with_comment(line: Line) -> str:
    """Return a line's code with its comment; an annotation is left out."""
    if not line.code.strip():
        indent = line.text[: len(line.text) - len(line.text.lstrip())]
        return f"{indent}//{line.comment}"
    comment = "" if not line.comment or line.comment.startswith("!") else f"  //{line.comment}"
    return f"{line.code.rstrip()}{comment}"


def _names_in(code: str) -> tuple[str, ...]:
    struct = _STRUCT.match(code)
    if struct:
        return (struct.group(1),)
    head = code[: code.find("{")] if "{" in code else code
    function = _FUNCTION.search(head)
    if function and "=" not in head[: function.start(1)]:
        return (function.group(1),)
    variables = _VARIABLES.match(code)
    if not variables:
        return ()
    names, depth, part = [], 0, ""
    for letter in variables.group(1):
        depth += (letter in "([{") - (letter in ")]}")
        if letter in ",;" and depth == 0:
            names += re.findall(r"^\s*([A-Za-z_]\w*)", part)
            part = ""
        else:
            part += letter
    return tuple(names)


def _renamed(text: str, names: Mapping[str, str]) -> str:
    """Return a text with other names outside of comments; members of structs keep theirs."""
    parts = []
    for line in text.split("\n"):
        code, mark, comment = line.partition("//")
        parts.append(_WORD.sub(lambda word: names.get(word.group(), word.group()), code) + mark + comment)
    new = "\n".join(parts)
    if _STRUCT.match(text):
        back = {new: old for old, new in names.items()}
        head, brace, body = new.partition("{")
        new = head + brace + _MEMBER.sub(lambda m: back.get(m.group(1), m.group(1)), body)
    return new


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


def _codes(passes: Sequence[Sequence[Declaration]]) -> dict[str, dict[int, str]]:
    """Return for each name, by pass, all that declares it there."""
    codes: dict[str, dict[int, str]] = {}
    for index, declarations in enumerate(passes):
        for each in declarations:
            for name in each.names:
                by_pass = codes.setdefault(name, {})
                by_pass[index] = by_pass.get(index, "") + each.code + "\n"
    return codes


def _once(declarations: Collection[Declaration]) -> list[Declaration]:
    """Return declarations without those whose code is there already."""
    by_code: dict[str, Declaration] = {}
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
