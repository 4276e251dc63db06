"""Rewrite desktop GLSL in the subset that GLSL ES 3.00 has as well, and name what has no other form there.

A page compiles GLSL ES 3.00. Kernels are written in the common subset, and ``desktop_only`` says where one is
not; other tools' shaders, many of which are written for desktops, are rewritten when they are exported. Each
line stays where it is:

* blocks of varyings become varyings; ``sampler1D`` becomes a row of a ``sampler2D``; functions named as
  built-in ones get names of their own; globals computed from others get their values in ``main``;
* conversions that a desktop does by itself are written out: a whole number becomes a float where one is
  expected, ``f.xx`` of a number a vector, ``{ a, b }`` a constructor.

An edit of what a macro stands for is one of the whole call, or of the macro's definition where all its calls
want the same there. What is not GLSL stays.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from itertools import islice
from pathlib import Path

from playground.errors import Diagnostic
from playground.memo import TEXTS
from playground.paths import GLSL
from playground.shader.conditions import WEBGL_2
from playground.shader.kernel import ComputeVariant, CpuSource, Kernel, PlainCompute, PlainFragment
from playground.shader.reserved_names import BUILT_IN_FUNCTIONS
from playground.shader.syntax.nodes import (
    Assign,
    Binary,
    Call,
    Conditional,
    Declaration,
    Declarator,
    Function,
    InitializerList,
    InterfaceBlock,
    Jump,
    Member,
    Name,
    Node,
    Struct,
    Type,
    walk,
)
from playground.shader.syntax.parser import parse
from playground.shader.syntax.symbols import Symbol, resolve
from playground.shader.syntax.tokens import tokenize
from playground.shader.syntax.types import (
    ExpressionType,
    ExpressionTypes,
    components,
    matrix,
    vector,
)
from playground.shader.wrap import FRAGMENT, recipes_of

_MISSING_FUNCTIONS = frozenset(
    """
    textureGather textureGatherOffset textureGatherOffsets textureQueryLod textureQueryLevels fma frexp
    ldexp bitCount bitfieldExtract bitfieldInsert bitfieldReverse findLSB findMSB uaddCarry usubBorrow
    umulExtended imulExtended packUnorm4x8 packSnorm4x8 unpackUnorm4x8 unpackSnorm4x8 packDouble2x32
    unpackDouble2x32 imageLoad imageStore imageSize interpolateAtCentroid interpolateAtSample
    interpolateAtOffset dFdxFine dFdyFine dFdxCoarse dFdyCoarse fwidthFine fwidthCoarse
    """.split()
)
_MISSING_TYPES = frozenset(
    """
    double dvec2 dvec3 dvec4 dmat2 dmat3 dmat4 dmat2x2 dmat2x3 dmat2x4 dmat3x2 dmat3x3 dmat3x4 dmat4x2
    dmat4x3 dmat4x4
    """.split()
).union(
    f"{prefix}{kind}"
    for prefix in ("", "i", "u")
    for kind in (
        "sampler2DMS sampler2DMSArray samplerBuffer sampler2DRect samplerCubeArray sampler1DArray "
        "image1D image2D image3D imageCube image2DArray"
    ).split()
)
_TAKING_FLOATS = frozenset(
    """
    radians degrees sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh pow exp log exp2 log2 sqrt
    inversesqrt floor trunc round roundEven ceil fract mod modf mix step smoothstep length distance dot cross
    normalize faceforward reflect refract dFdx dFdy fwidth fma isnan isinf floatBitsToInt floatBitsToUint
    packHalf2x16 packSnorm2x16 packUnorm2x16 outerProduct
    """.split()
)
_TAKING_ALIKE = frozenset(
    """
    abs sign min max clamp lessThan lessThanEqual greaterThan greaterThanEqual equal notEqual
    """.split()
)
_LOOKUPS = frozenset(
    f"texture{projected}{level}{offset}"
    for projected in ("", "Proj")
    for level in ("", "Lod", "Grad")
    for offset in ("", "Offset")
)
_WIDENED = {("int", "float"), ("uint", "float"), ("int", "uint")}
_NO_ARITHMETIC = frozenset({"<<", ">>", "&&", "||", "^^", ",", "<<=", ">>="})
_STORAGE = frozenset("uniform in out attribute varying buffer shared const".split())
_INTERPOLATION = frozenset("flat smooth noperspective centroid invariant".split())

_ROWS = (
    "vec4 k_line(sampler2D k_s, float k_p) { return texture(k_s, vec2(k_p, 0.5)); } "
    "vec4 k_line(sampler2D k_s, float k_p, float k_b) { return texture(k_s, vec2(k_p, 0.5), k_b); } "
    "vec4 k_lineLod(sampler2D k_s, float k_p, float k_l) { return textureLod(k_s, vec2(k_p, 0.5), k_l); } "
    "vec4 k_lineFetch(sampler2D k_s, int k_p, int k_l) { return texelFetch(k_s, ivec2(k_p, 0), k_l); } "
    "int k_lineSize(sampler2D k_s, int k_l) { return textureSize(k_s, k_l).x; } "
)
_ROW_FUNCTIONS = {
    "texture": "k_line",
    "textureLod": "k_lineLod",
    "texelFetch": "k_lineFetch",
    "textureSize": "k_lineSize",
}


def desktop_only(kernel: Kernel) -> Iterator[Diagnostic]:
    """Yield a warning for each line of a kernel that no web page takes as it is; shipped files have none.

    A shader of another tool is rewritten when it is exported: of one only what has no other form counts.
    """
    is_shipped = all(Path(file).is_relative_to(GLSL) for file in kernel.source.files)
    if is_shipped or isinstance(kernel, CpuSource | ComputeVariant | PlainCompute):
        return
    if name := lacking(kernel.source.code):
        line = kernel.source.line_naming(name.removesuffix("()")) or kernel.source.lines[0]
        yield line.diagnostic(f"this names {name}, which the GLSL of web pages has not", severity="warning")
    for recipe in () if isinstance(kernel, PlainFragment) else recipes_of(kernel, FRAGMENT)[1].values():
        text, first = recipe.make()
        lines = zip(text.split("\n"), in_common_glsl(text).split("\n"), strict=True)
        own = zip(recipe.source.lines, islice(lines, first - 1, None), strict=False) if first else ()
        for line, (was, now) in own:
            if was != now and not Path(line.file).is_relative_to(GLSL):
                message = f"web pages compile GLSL ES 3.00, which wants this written as `{now.strip()}`"
                yield line.diagnostic(message, severity="warning")


@TEXTS.cached()
def lacking(code: str) -> str:
    """Return the first name in a text that GLSL ES 3.00 lacks, a function with brackets; "" if there is none.

    A function that the text itself defines is none.
    """
    symbols = resolve(parse(code, WEBGL_2))
    types = [node.name for node in walk(*symbols.tree.declarations) if isinstance(node, Type | Call)]
    called = [f"{site.node.name}()" for site in symbols.calls if not site.functions]
    names = [name for name in types if name in _MISSING_TYPES]
    return next(iter(names or [name for name in called if name[:-2] in _MISSING_FUNCTIONS]), "")


@cache
def in_common_glsl(text: str) -> str:
    """Return a stage's text in the common subset of GLSL 3.30 and ES 3.00; its lines stay where they are."""
    return _Rewriter(text).text()


class _Rewriter:
    """The edits of one text."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._tree = parse(text, WEBGL_2)
        self._tokens = self._tree.tokens
        self._symbols = resolve(self._tree)
        self._types = ExpressionTypes(self._symbols)
        self._around: dict[tuple[int, int], set[tuple[str, str]]] = defaultdict(set)  # put around a span
        self._instead: dict[tuple[int, int], set[str]] = defaultdict(set)  # put in its place
        self._structs = {s.name: s.node for s in self._symbols.symbols if isinstance(s.node, Struct)}

    def text(self) -> str:
        """Return the text with all edits."""
        self._blocks()
        self._locations()
        self._sampler_rows()
        self._own_names()
        for node in walk(*self._tree.declarations):
            self._conversions(node)
        self._initial_values()
        return self._edited(0, len(self._text))

    # ── edits ────────────────────────────────────────────────────────────────

    def _span(self, first: int, last: int) -> tuple[int, int] | None:
        """Return where the text has some tokens, or a macro spells them; None where neither does."""
        tokens = self._tokens
        begin, end = tokens[first], tokens[last - 1]
        begins = not begin.macros or first == 0 or tokens[first - 1].start != begin.start
        ends = not end.macros or last == len(tokens) or tokens[last].start != end.start
        if begins and ends:
            return begin.start, end.end
        start, after = begin.spelled, end.spelled + len(end.text)
        if last - first > after - start:  # more tokens than letters: macros within macros
            return None
        spelled = [token.text for token in tokenize(self._text[start:after])[0]] if start < after else []
        return (start, after) if spelled == [token.text for token in tokens[first:last]] else None

    def _replace(self, first: int, last: int, new: str) -> None:
        if span := self._span(first, last):
            self._instead[span].add(new + "\n" * self._text.count("\n", *span))

    def _edited(self, begin: int, end: int) -> str:
        """Return a part of the text with its edits; where a macro's calls want different ones, without."""
        edits: list[tuple[int, int, int, int, str]] = []  # place, order there, order of equals, end, new text
        for (start, after), pairs in self._around.items():
            if len(pairs) == 1 and begin <= start and after <= end:
                ((opening, closing),) = pairs
                edits += [(start, 1, -after, start, opening), (after, 0, -start, after, closing)]
        for (start, after), texts in self._instead.items():
            if len(texts) == 1 and begin <= start and after <= end:
                edits += [(start, 2, 0, after, text) for text in texts]
        pieces, at = list[str](), begin
        for start, _, _, after, new in sorted(edits):
            pieces += [self._text[at:start], new]
            at = max(at, after)
        return "".join([*pieces, self._text[at:end]])

    # ── forms of desktops ────────────────────────────────────────────────────

    def _blocks(self) -> None:
        """Write blocks of varyings as varyings: ``in V { vec2 uv; } v;`` as ``in vec2 V_uv;``."""
        members: dict[tuple[str, str], str] = {}  # instance and member → varying
        for block in self._tree.declarations:
            if not isinstance(block, InterfaceBlock) or block.name.startswith("gl_"):
                continue
            way = next((way for way in ("in", "out") if way in block.qualifiers), "")
            if not way or not block.members:
                continue
            self._replace(block.at - 1, block.at + 2, "")
            self._replace(block.members[-1].last, block.last, "")
            for member in block.members:
                at = member.first
                while self._tokens[at].text in _INTERPOLATION:
                    at += 1
                if span := self._span(at, at + 1):
                    self._around[span].add((f"{way} ", ""))
                for one in member.names:
                    members[block.instance, one.name] = f"{block.name}_{one.name}"
                    self._replace(one.at, one.at + 1, f"{block.name}_{one.name}")
        for node in walk(*self._tree.declarations) if members else ():
            base = node.base if isinstance(node, Member) else node
            symbol = self._symbols.symbol_at.get(base.first) if isinstance(base, Name) else None
            if isinstance(node, Member) and symbol is not None and symbol.kind == "block":
                self._replace(node.first, node.last, members.get((symbol.name, node.name), node.name))
            elif symbol is not None and symbol.kind == "variable" and ("", symbol.name) in members:
                self._replace(base.first, base.last, members["", symbol.name])

    def _locations(self) -> None:
        """Take the locations of varyings away: ES matches them by their names."""
        way = "out" if any(token.text == "gl_Position" for token in self._tokens) else "in"
        for node in self._tree.declarations:
            holder = node.type if isinstance(node, Declaration) else node
            if not isinstance(holder, Type | InterfaceBlock) or way not in holder.qualifiers or holder.at < 0:
                continue
            texts = [self._tokens[at].text for at in range(node.first, holder.at)]
            if "layout" in texts:
                at = node.first + texts.index("layout")
                self._replace(at, node.first + texts.index(")") + 1, "")

    def _sampler_rows(self) -> None:
        """Write textures of one dimension as rows of such of two."""
        rows = [n for n in walk(*self._tree.declarations) if isinstance(n, Type) and n.name == "sampler1D"]
        if not rows:
            return
        for node in rows:
            self._replace(node.at, node.at + 1, "sampler2D")
        self._around[self._tokens[0].start, len(self._text)].add((_ROWS, ""))
        for site in self._symbols.calls:
            call = site.node
            is_row = call.arguments and self._types.of(call.arguments[0])[0] == "sampler1D"
            if is_row and call.name in _ROW_FUNCTIONS and not site.functions:
                self._replace(call.at, call.at + 1, _ROW_FUNCTIONS[call.name])

    def _own_names(self) -> None:
        """Give functions that are named as built-in ones names of their own."""
        taken = BUILT_IN_FUNCTIONS.keys() - _MISSING_FUNCTIONS
        places = [symbol.token for symbol in self._symbols.functions() if symbol.name in taken]
        for site in self._symbols.calls if places else ():
            if site.node.name in taken and self._types.overload(site.node) is not None:
                places.append(site.node.at)
        for at in places:
            self._replace(at, at + 1, f"k_own_{self._tokens[at].text}")

    def _initial_values(self) -> None:
        """Write as variables what is no constant in ES; global ones get their values in ``main``."""
        constants, moved = set[Symbol](), list[Declarator]()
        for node in walk(*self._tree.declarations):
            if not isinstance(node, Declaration):
                continue
            is_const = "const" in node.type.qualifiers
            for one in node.names:
                symbol = self._symbols.symbol_at.get(one.at)
                if symbol is None or one.value is None:
                    continue
                is_constant = self._is_constant(one.value, constants)
                if is_const and (is_constant or symbol.kind != "local"):
                    constants.add(symbol)
                elif is_const:
                    words = [self._tokens[at].text for at in range(node.first, node.last)]
                    at = node.first + words.index("const")
                    self._replace(at, at + 1, "")
                elif (
                    symbol.kind == "variable"
                    and not is_constant
                    and _STORAGE.isdisjoint(node.type.qualifiers)
                ):
                    moved.append(one)
        for node in self._tree.declarations:
            if isinstance(node, Function) and node.name == "main" and node.body is not None:
                place = self._tokens[node.body.first].end
                self._instead[place, place].add("".join(map(self._moved, moved)))

    def _moved(self, one: Declarator) -> str:
        """Take a variable's value away; return the statement that sets it."""
        assert one.value is not None
        span = self._span(one.value.first - 1, one.value.last)
        if span is None:
            return ""
        value = self._edited(*span)
        for edits in (self._around, self._instead):
            for start, end in [place for place in edits if span[0] <= place[0] and place[1] <= span[1]]:
                del edits[start, end]
        self._instead[span].add("\n" * self._text.count("\n", *span))
        return f" {one.name} {' '.join(value.split())};"

    def _is_constant(self, value: Node, constants: set[Symbol]) -> bool:
        for node in walk(value):
            if isinstance(node, Name):
                symbol = self._symbols.symbol_at.get(node.first)
                if symbol not in constants and node.name not in ("true", "false"):
                    return False
            elif isinstance(node, Call):
                if self._symbols.callees.get(node) or node.name.startswith(("texture", "texel")):
                    return False
        return True

    # ── conversions ──────────────────────────────────────────────────────────

    def _conversions(self, node: Node) -> None:
        """Write out those of a node's own parts."""
        match node:
            case Function():
                for part in walk(*node.body.statements) if node.body else ():
                    if isinstance(part, Jump) and part.value is not None:
                        self._convert(part.value, _scalar((node.type.name, len(node.type.arrays))))
            case Declaration() if "uniform" not in node.type.qualifiers:
                for one in node.names:
                    if one.value is not None:
                        count = len(node.type.arrays) + len(one.arrays)
                        self._initialize(one.value, (node.type.name, count))
            case Assign() if node.operator not in _NO_ARITHMETIC:
                self._convert(node.value, _scalar(self._types.of(node.target)))
            case Binary() if node.operator not in _NO_ARITHMETIC:
                self._to_each_other(node.left, node.right)
            case Conditional():
                self._to_each_other(node.yes, node.no)
            case Member():
                self._swizzle(node)
            case Call():
                for argument, scalar in zip(node.arguments, self._wanted(node), strict=False):
                    self._convert(argument, scalar)

    def _convert(self, node: Node, scalar: str) -> None:
        """Make an expression's numbers those of another type, where a desktop does."""
        name, arrays = self._types.of(node)
        base, count = components(name)
        span = self._span(node.first, node.last)
        if span is None or (not self._tokens[node.first].macros and (base, scalar) not in _WIDENED):
            return
        before = after = ""
        if (base, scalar) in _WIDENED and not arrays:
            before, after = f"{vector(scalar, count)}(", ")"
            written = self._text[slice(*span)]
            if written.isdecimal() and str(int(written)) == written:
                before, after = "", ".0" if scalar == "float" else "u"
        self._around[span].add((before, after))

    def _to_each_other(self, one: Node, other: Node) -> None:
        kinds = _scalar(self._types.of(one)), _scalar(self._types.of(other))
        self._convert(one, kinds[1])
        self._convert(other, kinds[0])

    def _swizzle(self, node: Member) -> None:
        """Write ``f.xx`` of a number as a constructor."""
        name, arrays = self._types.of(node.base)
        whole, suffix = self._span(node.first, node.last), self._span(node.at - 1, node.at + 1)
        if components(name)[1] == 1 and not arrays and whole and suffix and whole[1] == suffix[1]:
            self._around[whole[0], suffix[0]].add((f"{self._types.of(node)[0]}(", ""))
            self._instead[suffix].add(")")

    def _wanted(self, call: Call) -> list[str]:
        """Return what numbers a call takes for its arguments, "" where any or none."""
        count, function = len(call.arguments), self._types.overload(call)
        if call.arrays:
            return [_scalar((call.name, len(call.arrays) - 1))] * count
        if call.name in self._structs:
            return [_scalar(of_type) for of_type in self._members(call.name)]
        if function is not None and isinstance(function.node, Function):
            return [
                ""
                if "out" in p.type.qualifiers
                else _scalar((p.type.name, len(p.type.arrays) + len(p.arrays)))
                for p in function.node.parameters
            ]
        if call.name in _LOOKUPS:
            offset = 2 + ("Lod" in call.name) + 2 * ("Grad" in call.name) if "Offset" in call.name else -1
            return ["" if at in (0, offset) else "float" for at in range(count)]
        if call.name in _TAKING_FLOATS:
            return ["float"] * count
        if call.name in _TAKING_ALIKE:
            kinds = [_scalar(self._types.of(argument)) for argument in call.arguments]
            return [next((kind for kind in ("float", "uint") if kind in kinds), "")] * count
        return []

    def _members(self, struct: str) -> list[ExpressionType]:
        return [
            (member.type.name, len(member.type.arrays) + len(one.arrays))
            for member in self._structs[struct].members
            for one in member.names
        ]

    def _initialize(self, value: Node, of_type: ExpressionType) -> None:
        """Convert a value of a type: ``{ a, b }`` too."""
        if not isinstance(value, InitializerList):
            self._convert(value, _scalar(of_type))
            return
        name, arrays = of_type
        scalar, _, rows = matrix(name)
        if arrays:
            inner = [(name, arrays - 1)] * len(value.items)
        elif name in self._structs:
            inner = self._members(name)
        else:
            inner = [(vector(scalar, rows) or components(name)[0], 0)] * len(value.items)
        for item, kind in zip(value.items, inner, strict=False):
            self._initialize(item, kind)
        self._replace(value.first, value.first + 1, f"{name}{'[]' * arrays}(")
        self._replace(value.last - 1, value.last, ")")
        if self._tokens[value.last - 2].text == ",":
            self._replace(value.last - 2, value.last - 1, "")


def _scalar(of_type: ExpressionType) -> str:
    """Return what the numbers of a type are; "" of all but scalars, vectors and matrices."""
    name, arrays = of_type
    return "" if arrays else components(name)[0] or matrix(name)[0]
