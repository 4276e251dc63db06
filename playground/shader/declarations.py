"""What a GLSL text declares: variables and functions, uniforms with their initial values, varyings.

``Declarations`` reads tokens: a statement that begins with qualifiers, a type and a name declares something.
What is no declaration, or one with a mistake, is passed over.

``uniforms``, ``declared_names`` and ``vertex_outputs`` read the statements of a text whose comments are
blanked already, and so are its branches that are off.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import accumulate, groupby

from playground.memo import TEXTS
from playground.shader.syntax.preprocessor import readings, value_of
from playground.shader.syntax.tokens import Token

BUILT_IN = re.compile(r"float|double|u?int|bool|[biud]?vec[234]|d?mat[234](?:x[234])?")
"""Types with a value that GLSL has by itself; samplers and images have none."""

_NAME = re.compile(r"[A-Za-z_]\w*")
_QUALIFIERS = frozenset(
    "const in out inout uniform varying attribute buffer shared flat smooth noperspective centroid sample "
    "patch invariant precise highp mediump lowp coherent volatile restrict readonly writeonly layout".split()
)
_NO_TYPES = frozenset(
    "return else do while for if switch case default break continue discard precision struct".split()
)
_JUMPS = frozenset({"break", "return", "continue", "discard"})
_HEADERS = frozenset({"for", "while", "if", "switch"})
_BEHIND_NAMES = frozenset({"=", ";", ",", ")", "[", "("})
_CLOSES = {"(": ")", "[": "]", "{": "}"}
_MAX_MEMBERS = 256  # of a struct, those of its members too

Size = tuple[str, ...]
"""The tokens between the brackets of an array."""


@dataclass(frozen=True, slots=True)
class Type:
    """What a variable is: the name of a type, "" of a struct without one, and the sizes of arrays of it."""

    name: str
    sizes: tuple[Size, ...] = ()  # the outermost first
    members: tuple[tuple[str, Type], ...] = ()  # of a struct

    @property
    def member_count(self) -> int:
        """How many members it has, and they have in turn; an array counts once."""
        return sum(1 + member.member_count for _, member in self.members)


@dataclass(frozen=True, slots=True)
class Variable:
    """One name that is declared."""

    name: str
    type: Type
    qualifiers: frozenset[str]
    at: int  # index of its token
    end: int  # index of the last token of its declarator, without a value
    has_value: bool = False
    close: int = -1  # index of the token that ends the declaration: a semicolon, or the bracket of a header
    is_global: bool = False
    may_follow: bool = False  # a statement may stand behind the semicolon
    block: int = -1  # index of the bracket that opens the block around it; -1: none does


@dataclass(slots=True)
class Function:
    """One definition of a function."""

    name: str
    type: Type
    parameters: tuple[Variable, ...]
    opens: int  # index of the bracket of its body
    closes: int = -1  # index of the bracket that closes it; -1: none does
    last: int = -1  # index of the first token of its last statement
    returns: bool = False  # somewhere a value is


@dataclass(slots=True)
class _Open:
    """An open bracket."""

    bracket: str
    at: int = -1  # its index
    header: str = ""  # for | while | if | switch before a round one
    function: Function | None = None  # whose body a curly one opens


@dataclass
class Declarations:
    """What a text declares; ``tokens`` are one of its readings."""

    tokens: Sequence[Token]
    variables: list[Variable] = field(default_factory=list)
    functions: list[Function] = field(default_factory=list)
    prototypes: list[Function] = field(default_factory=list)
    structs: dict[str, Type] = field(default_factory=dict)
    numbers: dict[str, str] = field(default_factory=dict)  # const ints with values that can be worked out
    entries: list[tuple[int, int]] = field(default_factory=list)  # labels that are only jumped to: the
    # bracket of their switch, and their colon
    is_balanced: bool = True

    def __post_init__(self) -> None:
        self._texts = [token.text for token in self.tokens]
        self._closing: dict[int, int] = {}
        opened: list[int] = []
        for index, text in enumerate(self._texts):
            if text in _CLOSES:
                opened.append(index)
            elif text in _CLOSES.values() and opened:
                self._closing[opened.pop()] = index
        self._read()

    # ── what there is ────────────────────────────────────────────────────────

    def count(self, size: Size) -> int | None:
        """Return an array's size; None where it cannot be worked out."""
        words = [self.numbers.get(word, word).rstrip("uU") for word in size]
        if any(_NAME.match(word) for word in words):
            return None
        return value_of(" ".join(words))

    def names(self) -> Iterator[tuple[str, str, int]]:
        """Yield each name that is declared, its kind, and the index of its token.

        The kind is global, local, called (a function or a struct) or member.
        """
        yield from (
            (variable.name, "global" if variable.is_global else "local", variable.at)
            for variable in self.variables
        )
        for function in (*self.functions, *self.prototypes):
            yield function.name, "called", function.opens - 1
            yield from ((variable.name, "local", variable.at) for variable in function.parameters)
        for struct in self.structs.values():
            yield struct.name, "called", -1
            yield from ((name, "member", -1) for name, _ in struct.members)

    # ── reading ──────────────────────────────────────────────────────────────

    def _read(self) -> None:
        texts, count = self._texts, len(self._texts)
        stack: list[_Open] = []
        index, first = 0, ""  # of the statement: its first token's text
        begins, single = True, False  # a statement begins here; it stands alone behind a header
        jumped = False  # no statement goes on to this one
        while index < count:
            if begins:
                is_label = texts[index] in ("case", "default")
                if not (is_label and texts[index - 1] == ":"):
                    jumped = is_label and texts[index - 1] == ";" and first in _JUMPS
                first = "" if single else texts[index]
                body = stack[0].function if stack else None
                if body is not None and len(stack) == 1 and not single and texts[index] != "}":
                    body.last = index
                after = self._declaration(index, stack, single=single)
                if after is not None:
                    index, begins, single = after, False, False
                    continue
            text = texts[index]
            begins, single = False, False
            if text in ("(", "["):
                before = texts[index - 1] if index else ""
                stack.append(_Open(text, index, before if before in _HEADERS else ""))
                begins = before == "for"
            elif text == "{":
                own = self.functions[-1] if not stack and self.functions else None
                stack.append(_Open(text, index, function=own if own and own.opens == index else None))
                begins = True
            elif text in (")", "]", "}"):
                self.is_balanced &= bool(stack) and _CLOSES[stack[-1].bracket] == text
                while stack and text == "}" and stack[-1].bracket != "{":
                    stack.pop()
                closed = stack.pop() if stack and _CLOSES[stack[-1].bracket] == text else _Open("")
                if closed.function is not None:
                    closed.function.closes = index
                begins = text == "}" or bool(closed.header)
                single = bool(closed.header)
            elif text == ";":
                begins = True
            elif text == ":" and first in ("case", "default"):
                begins = True
                if jumped and stack:
                    self.entries.append((stack[-1].at, index))
            elif text in ("else", "do"):
                begins = single = True
            elif text == "return" and stack and stack[0].function and texts[index + 1 : index + 2] != [";"]:
                stack[0].function.returns = True
            index += 1
        self.is_balanced &= not stack

    def _declaration(self, start: int, stack: Sequence[_Open], *, single: bool) -> int | None:
        """Read a declaration; return the index of the token that ends it, or that its body opens with."""
        qualifiers, index = self._qualifiers(start)
        is_block = self._text(index + 1) == "{" and bool(qualifiers)
        kind = self._struct(index, is_block=is_block) if is_block else self._type(index)
        if kind is None:
            return None
        type_, index = kind
        name = self._name(index)
        if not name:
            if is_block:
                self.variables += [
                    Variable(member, own, qualifiers, index, index, is_global=True)
                    for member, own in type_.members
                ]
            return index if self._text(index) == ";" and index > start else None
        if not stack and self._text(index + 1) == "(":
            return self._function(type_, index)
        in_header = bool(stack) and stack[-1].header != ""
        variables: list[Variable] = []
        while name:
            sizes, last = self._sizes(index + 1)
            close = self.end_of_value(last + 1)
            own = Type(type_.name, (*sizes, *type_.sizes), type_.members)
            variables.append(Variable(name, own, qualifiers, index, last, self._text(last + 1) == "=", close))
            self._note_number(variables[-1])
            if self._text(close) != ",":
                break
            index = close + 1
            name = self._name(index)
        if self._text(close) != ";" and not (in_header and self._text(close) == ")"):
            return None
        follows = not single and not in_header
        self.variables += [
            replace(
                variable,
                close=close,
                is_global=not stack,
                may_follow=follows,
                block=stack[-1].at if stack else -1,
            )
            for variable in variables
        ]
        return close

    def _note_number(self, variable: Variable) -> None:
        """Note the value of a constant that a size may name."""
        if (
            "const" in variable.qualifiers
            and variable.has_value
            and variable.type in (Type("int"), Type("uint"))
        ):
            number = self.count(tuple(self._texts[variable.end + 2 : variable.close]))
            if number is not None:  # one of two with a name counts for none of them
                first = self.numbers.setdefault(variable.name, str(number))
                self.numbers[variable.name] = first if first == str(number) else variable.name

    def _function(self, type_: Type, at: int) -> int | None:
        closing = self.closing(at + 1)
        if closing is None:
            return None
        parameters = []
        index = at + 2
        while index < closing:
            qualifiers, index = self._qualifiers(index)
            kind = self._type(index)
            if kind is not None:
                own, index = kind
                name = self._name(index)
                sizes, last = self._sizes(index + 1) if name else ((), index - 1)
                whole = Type(own.name, (*sizes, *own.sizes), own.members)
                parameters.append(Variable(name, whole, qualifiers, index, last))
            index = self.end_of_value(index) + 1
        function = Function(self._texts[at], type_, tuple(parameters), closing + 1)
        if self._text(closing + 1) == "{":
            self.functions.append(function)
            return closing + 1
        self.prototypes.append(function)
        return closing + 1 if self._text(closing + 1) == ";" else None

    def _qualifiers(self, index: int) -> tuple[frozenset[str], int]:
        qualifiers = set()
        while (text := self._text(index)) in _QUALIFIERS:
            qualifiers.add(text)
            index += 1
            if text == "layout" and self._text(index) == "(":
                index = (self.closing(index) or index) + 1
        return frozenset(qualifiers), index

    def _type(self, index: int) -> tuple[Type, int] | None:
        """Return a type and the index behind it; None where none stands there that a variable may have."""
        text = self._text(index)
        if text == "struct":
            return self._struct(index)
        if not self._word(index):
            return None
        sizes, last = self._sizes(index + 1)
        return Type(text, sizes, self.structs[text].members if text in self.structs else ()), last + 1

    def _struct(self, index: int, *, is_block: bool = False) -> tuple[Type, int] | None:
        name = "" if is_block else self._word(index + 1)
        opens = index + 2 if name else index + 1
        closing = self.closing(opens) if self._text(opens) == "{" else None
        if closing is None:
            return None
        inner, members = opens + 1, []
        while inner < closing:
            _, inner = self._qualifiers(inner)
            kind = self._type(inner) if self._text(inner) != "struct" else None
            if kind is None:
                return None
            own, inner = kind
            while self._name(inner):
                sizes, last = self._sizes(inner + 1)
                members.append((self._texts[inner], Type(own.name, (*sizes, *own.sizes), own.members)))
                inner = last + 2
                if self._text(last + 1) != ",":
                    break
            else:
                return None
        made = Type(name, (), tuple(members))
        if made.member_count > _MAX_MEMBERS:
            return None
        if name:
            self.structs[name] = made
        return made, closing + 1

    def _sizes(self, index: int) -> tuple[tuple[Size, ...], int]:
        """Return the sizes in the brackets that follow, and the index of the last token of them."""
        sizes = []
        while self._text(index) == "[":
            closing = self.closing(index)
            if closing is None:
                break
            sizes.append(tuple(self._texts[index + 1 : closing]))
            index = closing + 1
        return tuple(sizes), index - 1

    def end_of_value(self, index: int) -> int:
        """Return the index of the comma, semicolon or bracket that ends what begins at an index."""
        while index < len(self._texts) and self._texts[index] not in (",", ";", ")", "]", "}"):
            if self._texts[index] in _CLOSES:
                index = self.closing(index) or len(self._texts)
            index += 1
        return min(index, len(self._texts))

    def closing(self, index: int) -> int | None:
        """Return the index of the bracket that closes the one at an index."""
        return self._closing.get(index)

    def _text(self, index: int) -> str:
        return self._texts[index] if index < len(self._texts) else ""

    def _word(self, index: int) -> str:
        """Return the name at an index, "" where none stands there."""
        text = self._text(index)
        return text if _NAME.match(text) and text not in _NO_TYPES and text not in _QUALIFIERS else ""

    def _name(self, index: int) -> str:
        """Return what is declared behind a type; older texts have names there that are qualifiers since."""
        text = self._text(index)
        return text if _NAME.match(text) and self._text(index + 1) in _BEHIND_NAMES else ""


_PRECISION = r"(?:(?:lowp|mediump|highp)\s+)?"
_MEMORY = r"(?:(?:coherent|volatile|restrict|readonly|writeonly)\s+)*"
_BEGINS = r"(?:^|[;{}\n])[ \t]*"
_UNIFORM = re.compile(
    rf"{_BEGINS}(?:layout\s*\([^)]*\)\s*)?uniform\s+{_MEMORY}{_PRECISION}(\w+)(\s*\[[^\]]*\]\s*|\s+)"
    r"([^;{}]*)(?=;)",
    re.MULTILINE,
)
_IN = re.compile(
    rf"{_BEGINS}(layout\s*\([^)]*\)\s*)?"
    rf"((?:(?:flat|smooth|noperspective|centroid|sample|invariant)\s+)*)in\s+"
    rf"((?:(?:flat|smooth|noperspective|centroid|sample)\s+)*){_PRECISION}(\w+)\s+([^;(){{}}]*)(?=;)",
    re.MULTILINE,
)
_BLOCK = re.compile(rf"{_BEGINS}in\s+(\w+)\s*\{{([^}}]*)\}}\s*(\w*)\s*;", re.MULTILINE)
_MEMBER = re.compile(
    rf"\s*((?:(?:flat|smooth|noperspective|centroid|sample)\s+)*){_PRECISION}(\w+)\s+([^;]*);"
)
_DECLARED_NAME = re.compile(r"\s*([A-Za-z_]\w*)\s*(\[[^\]]*\])?")
_DIRECTIVE = re.compile(r"^[ \t]*#.*$", re.MULTILINE)
_BRACKETS = re.compile(r"\([^()]*\)")
_VECTOR = re.compile(r"vec([234])|float")
_KINDS = {
    "numbers": re.compile(r"float|double|int|uint|bool|[iubd]?vec[234]"),
    "matrix": re.compile(r"mat[34]"),
    "sampler": re.compile(r"[iu]?sampler\w+"),
}
"""What a tool gives that declares a uniform of one of these types, another of them can be given, too."""


@dataclass(frozen=True, slots=True)
class Declared:
    """A uniform."""

    name: str
    type: str
    is_array: bool
    line: int  # of the text, from 0
    written: str  # the name, its array and its initial value


@TEXTS.cached()  # passes of one file share a text
def uniforms(code: str) -> Mapping[str, Declared]:
    """Return the uniforms that a text declares, by name; of one in two branches, the first."""
    code = expanded(code)
    declarations: dict[str, Declared] = {}
    for match in _UNIFORM.finditer(code):
        of_type = match.group(2).strip()  # the array of "float[3] a"
        for name, array, at, written in _names(match.group(3)):
            line = code.count("\n", 0, match.start(3) + at)
            written = written.replace(name, f"{name}{of_type}", 1)
            declarations.setdefault(
                name, Declared(name, match.group(1), bool(array or of_type), line, written)
            )
    return declarations


def expanded(code: str) -> str:
    """Return a text, as many lines, without its directives and with the macros expanded."""
    lines = _DIRECTIVE.sub("", code).split("\n")
    starts = [0, *accumulate(len(line) + 1 for line in code.split("\n"))]
    for tokens in readings(code):
        for line, some in groupby(tokens, key=lambda token: bisect_right(starts, token.start) - 1):
            texts = [token.text for token in some]
            if "".join(texts) != "".join(lines[line].split()):
                lines[line] = " ".join(texts)
    return "\n".join(lines)


def takes(kind: str, other: str) -> bool:
    """Return whether a uniform of a type can be given what another type is given."""
    kinds = [
        next((n for n, sign in _KINDS.items() if sign.fullmatch(type_name.partition("[")[0])), type_name)
        for type_name in (kind, other)
    ]
    return kinds[0] == kinds[1]


def is_declared(code: str, name: str, *, anywhere: bool) -> bool:
    """Return whether a text declares a variable or a function, outside of functions or ``anywhere``."""
    kinds = declared_names(code).get(name, frozenset())
    return bool(kinds & {"global", "called"}) or (anywhere and bool(kinds))


@TEXTS.cached()
def declared_names(code: str) -> Mapping[str, frozenset[str]]:
    """Return the names that a text declares, its macros expanded, with their kinds: see ``Declarations``."""
    names: dict[str, frozenset[str]] = {}
    for tokens in readings(code):
        for name, kind, _ in Declarations(tokens).names():
            names[name] = names.get(name, frozenset()) | {kind}
    return names


@TEXTS.cached()
def vertex_outputs(code: str) -> tuple[tuple[str, str], ...]:
    """Return what the vertex shader gives a fragment shader: declarations, and statements that set them."""
    code = expanded(code)
    outputs: dict[str, tuple[str, str]] = {}
    for block in _BLOCK.finditer(code):
        members = " ".join(block.group(2).split())
        instance = block.group(3)
        statements = [
            _set(f"{instance}.{name}" if instance else name, name, member.group(2), array)
            for member in _MEMBER.finditer(block.group(2))
            for name, array, _, _ in _names(member.group(3))
        ]
        declaration = f"out {block.group(1)} {{ {members} }} {instance};"
        outputs.setdefault(block.group(1), (declaration, " ".join(statements)))
    for match in _IN.finditer(code):
        layout, before, after, kind, names = match.groups()
        for name, array, _, _ in _names(names):
            if not name.startswith("gl_"):
                ways = " ".join(f"{before}{after}".split())
                declaration = " ".join(f"{layout or ''} {ways} out {kind} {name}{array};".split())
                outputs.setdefault(name, (declaration, _set(name, name, kind, array)))
    return tuple(outputs.values())


def _names(text: str) -> Iterator[tuple[str, str, int, str]]:
    """Yield (name, array, place, as written with its initial value) of each name that a declaration lists."""
    flat = text
    while (inner := _BRACKETS.sub(lambda m: " " * len(m.group()), flat)) != flat:
        flat = inner
    start = 0
    for part in flat.split(","):
        if match := _DECLARED_NAME.match(part):
            written = text[start + match.start(1) : start + len(part)]
            yield match.group(1), (match.group(2) or "").strip(), start + match.start(1), written
        start += len(part) + 1


def _set(target: str, name: str, kind: str, array: str) -> str:
    """Return the statement that sets one output."""
    value = _value(name.lower(), kind)
    if array:
        return f"for (int k_i = 0; k_i < {target}.length(); ++k_i) {target}[k_i] = {value};"
    return f"{target} = {value};"


def _value(name: str, kind: str) -> str:
    """Return an output's value by its name: coordinates 0..1, a position -1..1, a normal, white, else 0."""
    vector = _VECTOR.fullmatch(kind)
    if kind.startswith("mat"):
        return f"{kind}(1.0)"
    if vector is None or kind == "float":
        return f"{kind}({'1' if 'color' in name or 'colour' in name else '0'})"
    count = int(vector.group(1))
    if "color" in name or "colour" in name:
        return f"{kind}(1.0)"
    if "normal" in name:
        return {2: "vec2(0.0)", 3: "vec3(0.0, 0.0, 1.0)", 4: "vec4(0.0, 0.0, 1.0, 0.0)"}[count]
    if re.search(r"uv|tex|coord", name.replace("vertex", "")):
        return {2: "k_share", 3: "vec3(k_share, 0.0)", 4: "vec4(k_share, 0.0, 1.0)"}[count]
    if "pos" in name:
        return {2: "k_place", 3: "vec3(k_place, 0.0)", 4: "vec4(k_place, 0.0, 1.0)"}[count]
    return f"{kind}(0.0)"
