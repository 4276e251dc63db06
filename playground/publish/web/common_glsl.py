"""Rewrite desktop GLSL in the subset that GLSL ES 3.00 has as well, and name what has no other form there.

A page compiles GLSL ES 3.00. Kernels are written in the common subset; other tools' shaders, many of which
are written for desktops, are rewritten when they are exported. Each line stays where it is:

* blocks of varyings become varyings; ``sampler1D`` becomes a row of a ``sampler2D``; functions named as
  built-in ones get names of their own; globals worked out from others get their values in ``main``;
* conversions that a desktop does by itself are written out: a whole number becomes a float where one is
  expected, ``f.xx`` of a number a vector, ``{ a, b }`` a constructor.

The text is read as far as types need it; what is not understood, as a macro that takes types, stays.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import NamedTuple

# ── what has no other form ────────────────────────────────────────────────────

_MISSING_FUNCTIONS = frozenset(
    """
    textureGather textureGatherOffset textureGatherOffsets textureQueryLod textureQueryLevels fma frexp
    ldexp bitCount bitfieldExtract bitfieldInsert bitfieldReverse findLSB findMSB uaddCarry usubBorrow
    umulExtended imulExtended packUnorm4x8 packSnorm4x8 unpackUnorm4x8 unpackSnorm4x8 packDouble2x32
    unpackDouble2x32 imageLoad imageStore imageSize interpolateAtCentroid interpolateAtSample
    interpolateAtOffset dFdxFine dFdyFine dFdxCoarse dFdyCoarse fwidthFine fwidthCoarse
    """.split()
)
_MISSING_TYPES = re.compile(
    r"\b(?:double|dvec[234]|dmat[234](?:x[234])?|[iu]?sampler(?:2DMS(?:Array)?|Buffer|2DRect|CubeArray|1DArray)"
    r"|[iu]?image(?:1D|2D|3D|Cube|2DArray))\b"
)
_CALL = re.compile(r"\b([A-Za-z_]\w*)\s*\(")
_OWN = re.compile(r"\b[A-Za-z_]\w*\s+([A-Za-z_]\w*)\s*\([^;{}()]*\)\s*\{|#\s*define\s+(\w+)")


def lacking(code: str) -> str:
    """Return the first name in a text that GLSL ES 3.00 lacks, a function with brackets; "" if there is none.

    A function that the text itself defines is none.
    """
    match = _MISSING_TYPES.search(code)
    if match:
        return match.group(0)
    own = {name for pair in _OWN.findall(code) for name in pair}
    called = (match.group(1) for match in _CALL.finditer(code))
    return next((f"{name}()" for name in called if name in _MISSING_FUNCTIONS and name not in own), "")


@cache
def in_common_glsl(text: str) -> str:
    """Return a stage's text in the common subset of GLSL 3.30 and ES 3.00; its lines stay where they are."""
    for rewrite in (_blocks, _sampler_rows, _own_names, _globals, _constants, _conversions):
        text = rewrite(text)
    return text


# ── tokens and edits ──────────────────────────────────────────────────────────


class _Token(NamedTuple):
    text: str
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class _Edit:
    """A text in place of a part of another; ``opens``: around what earlier edits at its place go around."""

    start: int
    end: int
    text: str
    opens: bool = False


class _UnreadError(ValueError):
    """A text that is not understood."""


_TOKEN = re.compile(
    r"[A-Za-z_]\w*"
    r"|(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?\w*"
    r"|<<=|>>=|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||\^\^|[-+*/%&|^]=|[^\w\s]"
)
_UNREAD = re.compile(r"/\*.*?\*/|//[^\n]*|^[ \t]*#(?:\\\n|[^\n])*", re.DOTALL | re.MULTILINE)
_COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
_DEFINE = re.compile(r"^[ \t]*#[ \t]*define[ \t]+(\w+)(\([^)\n]*\))?(.*)$", re.MULTILINE)


@cache
def _tokens_of(text: str) -> tuple[_Token, ...]:
    """Return the tokens of a text but for comments and directives."""
    plain = _blanked(_UNREAD, _blanked(_COMMENT, text))
    return tuple(_Token(match[0], match.start(), match.end()) for match in _TOKEN.finditer(plain))


def _blanked(pattern: re.Pattern[str], text: str) -> str:
    return pattern.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)


def _macros_of(text: str) -> dict[str, tuple[bool, str]]:
    """Return the macros of a text: whether it has parameters, and what it stands for."""
    return {name: (bool(listed), body) for name, listed, body in _DEFINE.findall(text)}


def _edited(text: str, edits: Sequence[_Edit]) -> str:
    """Return a text with edits; of those at one place the first comes first, but for those that open."""
    pieces, at = [], 0
    keys = [(e.start, e.opens, -index if e.opens else index) for index, e in enumerate(edits)]
    for _, edit in sorted(zip(keys, edits, strict=True), key=lambda pair: pair[0]):
        pieces += [text[at : edit.start], edit.text]
        at = max(edit.end, at)
    return "".join([*pieces, text[at:]])


def _closing(tokens: Sequence[_Token], index: int) -> int:
    """Return the index of the bracket that closes the one at an index."""
    depth = 0
    for at in range(index, len(tokens)):
        depth += (tokens[at].text in "([{") - (tokens[at].text in ")]}")
        if depth == 0:
            return at
    raise _UnreadError("a bracket is not closed")


def _text_at(tokens: Sequence[_Token], index: int) -> str:
    return tokens[index].text if 0 <= index < len(tokens) else ""


def _is_name(word: str) -> bool:
    return bool(word) and (word[0].isalpha() or word[0] == "_")


# ── types ─────────────────────────────────────────────────────────────────────

_BASIC = re.compile(r"void|float|int|uint|bool|[iub]?vec[234]|mat[234](?:x[234])?|[iu]?sampler\w+")
_VALUE = re.compile(r"float|int|uint|bool|[iub]?vec[234]|mat[234](?:x[234])?")
_VECTOR = re.compile(r"(float|int|uint|bool)|([iub]?)vec([234])")
_MATRIX = re.compile(r"mat(\d)(?:x(\d))?")
_SWIZZLE = re.compile(r"[xyzw]{1,4}|[rgba]{1,4}|[stpq]{1,4}")
_BASES = {"": "float", "i": "int", "u": "uint", "b": "bool"}
_PREFIXES = {base: prefix for prefix, base in _BASES.items()}

_FLOATS = frozenset(
    """
    radians degrees sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh pow exp log exp2 log2 sqrt
    inversesqrt floor trunc round roundEven ceil fract mod mix step smoothstep length distance dot cross
    normalize faceforward reflect refract dFdx dFdy fwidth fma
    """.split()
)
_ANY_KIND = frozenset(("abs", "sign", "min", "max", "clamp"))
_LOOKUP = re.compile(r"texture(?:Proj|Lod|Grad|ProjLod|Offset|LodOffset)?")
_COMPARING = frozenset("lessThan lessThanEqual greaterThan greaterThanEqual equal notEqual not".split())
_ALWAYS = {
    **dict.fromkeys(("length", "distance", "dot", "determinant"), "float"),
    **dict.fromkeys(("any", "all"), "bool"),
    **dict.fromkeys(("texelFetch", "texelFetchOffset"), "vec4"),
    "cross": "vec3",
}
_OF_BITS = {"floatBitsToInt": "int", "floatBitsToUint": "uint"} | dict.fromkeys(
    ("intBitsToFloat", "uintBitsToFloat"), "float"
)
_BUILT_IN = (
    (_FLOATS - {"fma"})
    | _ANY_KIND
    | _COMPARING
    | _OF_BITS.keys()
    | frozenset("modf isnan isinf matrixCompMult outerProduct transpose determinant inverse any all".split())
)


def _base_of(kind: str) -> str:
    """Return what a scalar's or a vector's numbers are; "float" of a matrix, "" of all else."""
    if match := _VECTOR.fullmatch(kind):
        return match[1] or _BASES[match[2]]
    return "float" if _MATRIX.fullmatch(kind) else ""


def _size_of(kind: str) -> int:
    """Return how many numbers a scalar or a vector has, 0 of all else."""
    match = _VECTOR.fullmatch(kind)
    return int(match[3] or 1) if match else 0


def _type_of(base: str, size: int) -> str:
    return base if size == 1 else f"{_PREFIXES[base]}vec{size}" if size else ""


def _rows_of(kind: str) -> int:
    """Return the size of a matrix's columns."""
    match = _MATRIX.fullmatch(kind)
    return int(match[2] or match[1]) if match else 0


def _is_widened(kind: str, to: str) -> bool:
    """Return whether numbers of a kind become those of another by themselves on a desktop."""
    return (to == "float" and kind in ("int", "uint")) or (to == "uint" and kind == "int")


def _of_operator(sign: str, left: str, right: str) -> str:
    """Return the type of an operator's value."""
    if sign in ("<", ">", "<=", ">=", "==", "!=", "&&", "||", "^^"):
        return "bool"
    if left.startswith("mat") or right.startswith("mat"):
        if sign == "*" and left.startswith("mat") and _size_of(right) > 1:
            return _type_of("float", _rows_of(left))
        if sign == "*" and right.startswith("mat") and _size_of(left) > 1:
            return _type_of("float", int(right[3]))
        return left if left.startswith("mat") else right
    bases = (_base_of(left), _base_of(right))
    if not all(bases):
        return ""
    is_right = sign not in ("<<", ">>") and _is_widened(*bases)
    return _type_of(bases[is_right], max(_size_of(left), _size_of(right)))


def _takes_floats(name: str, kinds: Sequence[str]) -> bool:
    """Return whether a built-in function takes floats, so that its whole numbers become some."""
    if name in _FLOATS or _LOOKUP.fullmatch(name):
        return True
    return name in _ANY_KIND and any(_base_of(kind) == "float" for kind in kinds)


def _of_function(name: str, kinds: Sequence[str]) -> str:
    """Return the type of a built-in function's value; "" of one that is not known."""
    size = max(map(_size_of, kinds), default=0)
    if _LOOKUP.fullmatch(name):
        return "vec4"
    if name in _ALWAYS:
        return _ALWAYS[name]
    if name in _COMPARING or name in ("isnan", "isinf"):
        return _type_of("bool", size)
    if name in ("transpose", "inverse"):
        return kinds[0] if kinds else ""
    if name in _OF_BITS:
        return _type_of(_OF_BITS[name], size)
    if not all(kinds) or not (name in _FLOATS or name in _ANY_KIND):
        return ""
    return _type_of("float" if _takes_floats(name, kinds) else _base_of(kinds[0]), size)


def _swizzled(kind: str, field_name: str) -> str:
    return _type_of(_base_of(kind), len(field_name)) if _size_of(kind) else ""


def _element_of(kind: str) -> str:
    """Return the type of an element of an array, a vector or a matrix."""
    if kind.endswith("[]"):
        return kind[:-2]
    if kind.startswith("mat"):
        return _type_of("float", _rows_of(kind))
    return _base_of(kind) if _size_of(kind) > 1 else ""


# ── forms of desktops ─────────────────────────────────────────────────────────


def _blocks(text: str) -> str:
    """Write blocks of varyings as varyings: ``in V { vec2 uv; } v;`` as ``in vec2 V_uv;``."""
    tokens, edits, members = _tokens_of(text), list[_Edit](), dict[str, str]()
    at = 0
    while at + 2 < len(tokens):
        word, name, brace = tokens[at : at + 3]
        if word.text not in ("in", "out") or brace.text != "{" or _text_at(tokens, at - 1) == "(":
            at += 1
            continue
        end = _closing(tokens, at + 2)
        instance = _text_at(tokens, end + 1).strip(";")
        last = next((i for i in range(end + 1, len(tokens)) if tokens[i].text == ";"), end)
        edits += [_Edit(word.start, brace.end, ""), _Edit(tokens[end].start, tokens[last].end, "")]
        begins = True
        for inside in range(at + 3, end):
            token, follows = tokens[inside], tokens[inside + 1].text
            if begins:
                edits.append(_Edit(token.start, token.start, f"{word.text} "))
            begins = token.text == ";"
            if follows in (";", ",", "[") and _is_name(token.text):
                edits.append(_Edit(token.start, token.end, f"{name.text}_{token.text}"))
                members[f"{instance}.{token.text}" if instance else token.text] = f"{name.text}_{token.text}"
        at = last + 1
    text = _edited(text, edits)
    if not members:
        return text
    uses, renames = _tokens_of(text), list[_Edit]()
    for at, token in enumerate(uses):
        dotted = f"{token.text}.{_text_at(uses, at + 2)}" if _text_at(uses, at + 1) == "." else ""
        if dotted in members:
            renames.append(_Edit(token.start, uses[at + 2].end, members[dotted]))
        elif token.text in members and _text_at(uses, at - 1) != ".":
            renames.append(_Edit(token.start, token.end, members[token.text]))
    return _edited(text, renames)


_ROWS = (
    "vec4 k_line(sampler2D k_s, float k_p) { return texture(k_s, vec2(k_p, 0.5)); } "
    "vec4 k_line(sampler2D k_s, float k_p, float k_b) { return texture(k_s, vec2(k_p, 0.5), k_b); } "
    "vec4 k_lineLod(sampler2D k_s, float k_p, float k_l) { return textureLod(k_s, vec2(k_p, 0.5), k_l); } "
    "vec4 k_lineFetch(sampler2D k_s, int k_p, int k_l) { return texelFetch(k_s, ivec2(k_p, 0), k_l); } "
    "int k_lineSize(sampler2D k_s, int k_l) { return textureSize(k_s, k_l).x; } "
)
_ROW_FUNCTIONS = dict(
    zip(
        ("texture", "textureLod", "texelFetch", "textureSize"),
        ("k_line", "k_lineLod", "k_lineFetch", "k_lineSize"),
        strict=True,
    )
)


def _sampler_rows(text: str) -> str:
    """Write textures of one dimension as rows of such of two."""
    tokens = _tokens_of(text)
    names = {_text_at(tokens, at + 1) for at, token in enumerate(tokens) if token.text == "sampler1D"}
    if not names:
        return text
    edits = [_Edit(tokens[0].start, tokens[0].start, _ROWS)]
    for at, token in enumerate(tokens):
        if token.text == "sampler1D":
            edits.append(_Edit(token.start, token.end, "sampler2D"))
        elif token.text in _ROW_FUNCTIONS and _text_at(tokens, at + 2) in names:
            edits.append(_Edit(token.start, token.end, _ROW_FUNCTIONS[token.text]))
    return _edited(text, edits)


def _own_names(text: str) -> str:
    """Give functions that are named as built-in ones names of their own."""
    tokens, own, depth = _tokens_of(text), set[str](), 0
    for at, (word, _, _) in enumerate(tokens):
        depth += (word == "{") - (word == "}")
        is_head = word in _BUILT_IN and _text_at(tokens, at + 1) == "("
        if depth == 0 and is_head and _VALUE.fullmatch(_text_at(tokens, at - 1)):
            own.add(word)
    edits = [_Edit(token.start, token.end, f"k_own_{token.text}") for token in tokens if token.text in own]
    return _edited(text, edits)


def _has_variables(tokens: Sequence[_Token], constant: set[str]) -> bool:
    """Return whether an expression names more than types, built-in functions and constants."""
    return any(
        _is_name(token.text)
        and not _VALUE.fullmatch(token.text)
        and token.text not in _BUILT_IN
        and token.text not in constant
        and token.text not in ("true", "false")
        and _text_at(tokens, at - 1) != "."
        for at, token in enumerate(tokens)
    )


_STORAGE = frozenset("uniform in out inout const attribute varying layout precision".split())


def _globals(text: str) -> str:
    """Give global variables that are worked out from others their values where the shader begins."""
    tokens, constant = _tokens_of(text), set(_macros_of(text))
    edits, depth, begins, statements = list[_Edit](), 0, "", ""
    for at, (word, start, _) in enumerate(tokens):
        if depth == 0 and (at == 0 or tokens[at - 1].text in (";", "}")):
            begins = word
        depth += (word in "({[") - (word in ")}]")
        if depth or word != "=":
            continue
        end = _end_of_value(tokens, at + 1)
        name = at - 1
        while tokens[name].text == "]":
            name = max(i for i in range(name) if tokens[i].text == "[") - 1
        if begins == "const":
            constant.add(tokens[name].text)
        if begins in _STORAGE or not _has_variables(tokens[at + 1 : end], constant):
            continue
        value = text[start : tokens[end].start if end < len(tokens) else len(text)]
        on_one_line = re.sub(r"\s*\n\s*", " ", value)
        statements += f" {tokens[name].text} {on_one_line};"
        edits.append(_Edit(start, start + len(value), re.sub(r"[^\n]", "", value)))
    begin = len(edits)
    for at, token in enumerate(tokens):
        if token.text == "main" and _text_at(tokens, at - 1) == "void" and _text_at(tokens, at + 1) == "(":
            brace = _closing(tokens, at + 1) + 1
            if _text_at(tokens, brace) == "{":
                edits.append(_Edit(tokens[brace].end, tokens[brace].end, statements))
    return _edited(text, edits) if statements and len(edits) > begin else text


def _end_of_value(tokens: Sequence[_Token], at: int) -> int:
    """Return the index of the sign that ends an initialiser: a comma or a semicolon in no bracket."""
    while at < len(tokens) and tokens[at].text not in (",", ";"):
        at = (_closing(tokens, at) if tokens[at].text in "([{" else at) + 1
    return at


def _constants(text: str) -> str:
    """Make local constants that are worked out from variables variables."""
    tokens, constant = _tokens_of(text), set(_macros_of(text))
    edits, depth = list[_Edit](), 0
    for at, (word, start, end) in enumerate(tokens):
        depth += (word == "{") - (word == "}")
        is_declared = word == "const" and _VALUE.fullmatch(_text_at(tokens, at + 1))
        if not is_declared or _text_at(tokens, at - 1) in ("(", ","):  # the latter: of a function's parameter
            continue
        last = next((i for i in range(at, len(tokens)) if tokens[i].text == ";"), len(tokens))
        equals = next((i for i in range(at, last) if tokens[i].text == "="), last)
        if depth and _has_variables(tokens[equals + 1 : last], constant):
            edits.append(_Edit(start, end, ""))
        else:
            constant.add(_text_at(tokens, at + 2))
    return _edited(text, edits)


# ── conversions ───────────────────────────────────────────────────────────────

_QUALIFIERS = frozenset(
    """
    const in out inout uniform varying attribute centroid flat smooth noperspective invariant highp mediump
    lowp precise patch sample
    """.split()
)
_LEVELS = "|| ^^ && | ^ & ==,!= <,>,<=,>= <<,>> +,- *,/,%".split()
_BINDING = {sign: level for level, signs in enumerate(_LEVELS, 1) for sign in signs.split(",")}
_ASSIGNING = re.compile(r"(?:[-+*/%&|^]|<<|>>)?=")
_INT = re.compile(r"[-+]?\d+")
_FLOAT = re.compile(r"[-+]?(?:\d+\.\d*|\.\d+|\d+(?=[eE]))(?:[eE][-+]?\d+)?f?")
_CONSTRUCTOR = re.compile(r"\s*\(?\s*(\w+)\s*\(")


def _conversions(text: str) -> str:
    """Write out the conversions that desktop GLSL does by itself."""
    return _Reader(text).converted()


@dataclass(slots=True)
class _Value:
    """An expression: its place in the text, and its type; "" where that is not known."""

    start: int
    end: int
    kind: str
    is_literal: bool = False


@dataclass
class _Function:
    kind: str
    parameters: list[tuple[str, bool]] = field(default_factory=list)  # type, whether it is given back


class _Reader:
    """A recursive descent through a text: declarations, statements and expressions with their types.

    What reads a part raises ``_UnreadError`` for what it does not understand.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = _tokens_of(text)
        self.at = 0
        self.edits: list[_Edit] = []
        self.macros = _macros_of(text)
        self.functions: dict[str, list[_Function]] = {}
        self.structures: dict[str, list[tuple[str, str]]] = {}  # fields: name, type
        self.scopes: list[dict[str, str]] = [{}]

    def converted(self) -> str:
        """Return the text with the conversions written out."""
        while self.at < len(self.tokens):
            begin = self.at
            try:
                self._outermost()
            except (_UnreadError, RecursionError):
                self.at = begin + 1
        return _edited(self.text, self.edits)

    # the tokens

    def _peek(self, ahead: int = 0) -> str:
        return _text_at(self.tokens, self.at + ahead)

    def _take(self) -> _Token:
        if self.at >= len(self.tokens):
            raise _UnreadError("the text ends")
        self.at += 1
        return self.tokens[self.at - 1]

    def _expect(self, text: str) -> _Token:
        if self._peek() != text:
            raise _UnreadError(f"'{text}' is missing")
        return self._take()

    def _skip(self) -> None:
        """Pass a bracket, the next token, and all up to its end."""
        self.at = _closing(self.tokens, self.at) + 1

    def _end(self) -> int:
        return self.tokens[self.at - 1].end

    def _is_type(self, word: str) -> bool:
        return bool(_BASIC.fullmatch(word)) or word in self.structures

    # declarations

    def _outermost(self) -> None:
        self._qualifiers()
        if self._peek() == "precision":
            while self._take().text != ";":
                pass
        elif self._peek() == "struct":
            name = self._structure()
            if self._peek() == ";":
                self._take()
            else:
                self._declarations(name)
        elif self._is_type(self._peek()):
            kind = self._take().text + self._brackets()
            if _is_name(self._peek()) and self._peek(1) == "(":
                self._function(kind, self._take().text)
            else:
                self._declarations(kind)
        else:
            self._take()

    def _brackets(self) -> str:
        """Pass the brackets of an array; return as many empty ones."""
        brackets = ""
        while self._peek() == "[":
            self._skip()
            brackets += "[]"
        return brackets

    def _qualifiers(self) -> bool:
        """Pass qualifiers; return whether one of them is "out" or "inout"."""
        is_out = False
        while True:
            if self._peek() == "layout":
                self._take()
                self._skip()
            elif self._peek() in _QUALIFIERS:
                is_out |= self._take().text.endswith("out")
            else:
                return is_out

    def _structure(self) -> str:
        self._take()
        name = "" if self._peek() == "{" else self._take().text
        fields: list[tuple[str, str]] = []
        self._expect("{")
        while self._peek() != "}":
            self._qualifiers()
            kind = self._take().text + self._brackets()
            while True:
                field_name = self._take().text
                fields.append((field_name, kind + self._brackets()))
                if self._take().text == ";":
                    break
        self._take()
        self.structures[name] = fields
        return name

    def _declarations(self, kind: str) -> None:
        """Read declarations after their type, up to the semicolon."""
        while True:
            name = self._take().text
            whole = kind + self._brackets()
            self.scopes[-1][name] = whole
            if self._peek() == "=":
                self._take()
                self._initial(whole)
            if self._take().text == ";":
                return

    def _function(self, kind: str, name: str) -> None:
        """Read a function's head, and its body where it has one."""
        self._expect("(")
        scope, function = dict[str, str](), _Function(kind)
        if self._peek() == "void":
            self._take()
        while self._peek() != ")":
            is_out = self._qualifiers()
            own = self._take().text + self._brackets()
            parameter = "" if self._peek() in (",", ")") else self._take().text
            own += self._brackets()
            scope[parameter] = own
            function.parameters.append((own, is_out))
            if self._peek() == ",":
                self._take()
        self._take()
        self.functions.setdefault(name, []).append(function)
        if self._peek() == ";":
            self._take()
        if self._peek() != "{":
            return
        behind, before, depth = _closing(self.tokens, self.at) + 1, len(self.edits), len(self.scopes)
        self.scopes.append(scope)
        try:
            self._statement(kind)
        except (_UnreadError, RecursionError):
            del self.edits[before:]  # what is not understood stays
        del self.scopes[depth:]
        self.at = behind

    # statements

    def _statement(self, returns: str) -> None:
        """Read a statement of a function that returns a type."""
        word = self._peek()
        if read := _STATEMENTS.get(word):
            read(self, returns)
        elif word in _QUALIFIERS or (
            self._is_type(word) and (_is_name(self._peek(1)) or self._peek(1) == "[")
        ):
            self._qualifiers()
            self._declarations(self._take().text + self._brackets())
        else:
            self._comma()
            if self._peek() == ";":  # a macro may bring its own
                self._take()

    def _compound(self, returns: str) -> None:
        self._take()
        self.scopes.append({})
        while self._peek() != "}":
            self._statement(returns)
        self._take()
        self.scopes.pop()

    def _condition(self, returns: str) -> None:
        self._take()
        self._expect("(")
        self._comma()
        self._expect(")")
        self._statement(returns)
        if self._peek() == "else":
            self._take()
            self._statement(returns)

    def _for(self, returns: str) -> None:
        self._take()
        self._expect("(")
        self.scopes.append({})
        self._statement(returns)
        for end in (";", ")"):
            if self._peek() != end:
                self._comma()
            self._expect(end)
        self._statement(returns)
        self.scopes.pop()

    def _do(self, returns: str) -> None:
        self._take()
        self._statement(returns)
        self._expect("while")
        self._list()
        self._expect(";")

    def _return(self, returns: str) -> None:
        self._take()
        if self._peek() != ";":
            self._convert(self._comma(), returns)
        self._expect(";")

    def _label(self, _: str) -> None:
        while self._take().text != ":":
            pass

    def _empty(self, _: str) -> None:
        self._take()

    def _local_structure(self, _: str) -> None:
        self._declarations(self._structure())

    # expressions

    def _convert(self, value: _Value, kind: str) -> None:
        """Make a value's numbers those of another type, where a desktop does."""
        base, size = _base_of(kind), _size_of(value.kind)
        if not _is_widened(_base_of(value.kind), base):
            return
        if value.is_literal and self.text[value.start : value.end].isdecimal():
            self.edits.append(_Edit(value.end, value.end, ".0" if base == "float" else "u"))
        else:
            self.edits.append(_Edit(value.start, value.start, f"{_type_of(base, size)}(", opens=True))
            self.edits.append(_Edit(value.end, value.end, ")"))
        value.kind = _type_of(base, size)

    def _primary(self) -> _Value:
        word, start, end = self._take()
        if word[0].isdecimal() or (word[0] == "." and word != "."):
            is_float = not word[:2].lower() == "0x" and bool(re.search(r"[.eEfF]", word))
            kind = "float" if is_float else "uint" if word[-1] in "uU" else "int"
            return _Value(start, end, kind, is_literal=True)
        if word == "(":
            inner = self._comma()
            return _Value(start, self._expect(")").end, inner.kind)
        if word in ("-", "+", "!", "~", "++", "--"):
            inner = self._unary()
            return _Value(start, inner.end, inner.kind)
        if not _is_name(word):
            raise _UnreadError(f"'{word}' begins no value")
        if word in ("true", "false"):
            return _Value(start, end, "bool")
        if self._is_type(word) and self._peek() in ("[", "("):
            kind = word + self._brackets()
            values, fields = self._list(), self.structures.get(word, [])
            for value, expected in zip(
                values, [word] * len(values) if kind != word else [kind for _, kind in fields], strict=False
            ):
                self._convert(value, expected)
            return _Value(start, self._end(), kind)
        if self._peek() != "(":
            return _Value(start, end, self._type_named(word))
        kind = self._called(word, self._list())
        return _Value(start, self._end(), kind)

    def _type_named(self, name: str) -> str:
        """Return the type of a variable, or of a macro that stands for a value."""
        for scope in reversed(self.scopes):
            if name in scope:
                return scope[name]
        if name in ("gl_FragCoord", "gl_VertexID", "gl_InstanceID"):
            return "vec4" if name == "gl_FragCoord" else "int"
        has_parameters, body = self.macros.get(name, (True, ""))
        if has_parameters:
            return ""
        body = re.sub(r"^\((.*)\)$", r"\1", re.sub(r"//.*", "", body).strip())
        if _INT.fullmatch(body) or _FLOAT.fullmatch(body):
            return "int" if _INT.fullmatch(body) else "float"
        made = re.match(r"(\w+)\s*\(", body)
        if made and _BASIC.fullmatch(made[1]):
            return made[1]
        return self._type_named(body) if re.fullmatch(r"\w+", body) and body != name else ""

    def _list(self) -> list[_Value]:
        """Read the values between brackets."""
        values = []
        self._expect("(")
        if self._peek() == "void" and self._peek(1) == ")":
            self._take()
        while self._peek() != ")":
            values.append(self._assignment())
            if self._peek() == ",":
                self._take()
        self._take()
        return values

    def _called(self, name: str, values: list[_Value]) -> str:
        """Convert the values of a call; return the type of what it gives."""
        kinds = [value.kind for value in values]
        if name not in self.functions:
            if _takes_floats(name, kinds):
                for value in values[1 if name.startswith("tex") else 0 :]:  # the first is a sampler
                    self._convert(value, "float")
            if name in self.macros:
                made = _CONSTRUCTOR.match(self.macros[name][1])
                return made[1] if made and _BASIC.fullmatch(made[1]) else ""
            return _of_function(name, [value.kind for value in values])
        all_forms = self.functions[name]
        forms = [form for form in all_forms if len(form.parameters) == len(values)]
        same = next((form for form in forms if [kind for kind, _ in form.parameters] == kinds), None)
        close = next((form for form in forms if self._fits(form, kinds)), None)
        if not same and close:
            for value, (kind, is_out) in zip(values, close.parameters, strict=True):
                if not is_out:
                    self._convert(value, kind)
        return (same or close or (forms or all_forms)[0]).kind

    @staticmethod
    def _fits(form: _Function, kinds: Sequence[str]) -> bool:
        pairs = zip(kinds, form.parameters, strict=True)
        return all(
            not own or own == kind or _is_widened(_base_of(own), _base_of(kind)) for own, (kind, _) in pairs
        )

    def _unary(self) -> _Value:
        value = self._primary()
        while True:
            if self._peek() == "[":
                self._take()
                self._comma()
                value = _Value(value.start, self._expect("]").end, _element_of(value.kind))
            elif self._peek() == ".":
                value = self._field(value)
            elif self._peek() in ("++", "--"):
                value = _Value(value.start, self._take().end, value.kind)
            else:
                return value

    def _field(self, value: _Value) -> _Value:
        dot, name = self._take(), self._take()
        if name.text == "length" and self._peek() == "(":
            self._list()
            return _Value(value.start, self._end(), "int")
        is_swizzle = bool(_SWIZZLE.fullmatch(name.text))
        kind = _swizzled(value.kind, name.text) if is_swizzle else ""
        if is_swizzle and _size_of(value.kind) == 1:
            self.edits.append(_Edit(value.start, value.start, f"{kind}(", opens=True))
            self.edits.append(_Edit(dot.start, name.end, ")"))
        fields = dict(self.structures.get(value.kind, []))
        return _Value(value.start, name.end, fields.get(name.text, kind))

    def _binary(self, level: int) -> _Value:
        """Read an expression whose operators bind at least as strongly as a level."""
        left = self._unary()
        while _BINDING.get(self._peek(), 0) >= level:
            sign = self._take().text
            right = self._binary(_BINDING[sign] + 1)
            if sign not in ("<<", ">>"):
                self._convert(left, right.kind)
                self._convert(right, left.kind)
            left = _Value(left.start, right.end, _of_operator(sign, left.kind, right.kind))
        return left

    def _assignment(self) -> _Value:
        left = self._binary(1)
        if self._peek() == "?":
            self._take()
            first = self._comma()
            self._expect(":")
            second = self._assignment()
            self._convert(first, second.kind)
            self._convert(second, first.kind)
            return _Value(left.start, second.end, first.kind or second.kind)
        if not _ASSIGNING.fullmatch(self._peek()):
            return left
        sign, right = self._take().text, self._assignment()
        if sign not in ("<<=", ">>="):
            self._convert(right, left.kind)
        return _Value(left.start, right.end, left.kind)

    def _comma(self) -> _Value:
        value = self._assignment()
        while self._peek() == ",":
            self._take()
            last = self._assignment()
            value = _Value(value.start, last.end, last.kind, last.is_literal)
        return value

    def _initial(self, kind: str) -> None:
        """Read a value of a type: ``{ a, b }`` too."""
        if self._peek() != "{":
            self._convert(self._assignment(), kind)
            return
        start = self._take()
        fields, count = self.structures.get(kind), 0
        while self._peek() != "}":
            inner = _element_of(kind) if fields is None else fields[count][1] if count < len(fields) else ""
            self._initial(inner)
            count += 1
            if self._peek() == ",":
                mark = self._take()
                if self._peek() == "}":
                    self.edits.append(_Edit(mark.start, mark.end, ""))
        end = self._take()
        self.edits += [_Edit(start.start, start.end, f"{kind}("), _Edit(end.start, end.end, ")")]


_STATEMENTS: dict[str, Callable[[_Reader, str], None]] = {
    "{": _Reader._compound,
    "if": _Reader._condition,
    "while": _Reader._condition,
    "switch": _Reader._condition,
    "for": _Reader._for,
    "do": _Reader._do,
    "return": _Reader._return,
    "case": _Reader._label,
    "default": _Reader._label,
    ";": _Reader._empty,
    "else": _Reader._empty,
    "struct": _Reader._local_structure,
}
