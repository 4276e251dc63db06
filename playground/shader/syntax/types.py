"""The type of every expression of a GLSL text, and which overload a call means.

Conversions are GLSL 4.60's, section 4.1.10; results of operators those of section 5.9, overloads are chosen
as in 6.1. What a text does not declare has a type where it is GLSL's own, or ``given``; else none is known.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from playground.shader.reserved_names import BUILT_IN_FUNCTIONS, BUILT_IN_VARIABLES
from playground.shader.syntax.nodes import (
    Assign,
    Binary,
    Call,
    Conditional,
    Function,
    Index,
    InterfaceBlock,
    Literal,
    Member,
    Method,
    Name,
    Node,
    Parenthesized,
    Struct,
    Unary,
    walk,
)
from playground.shader.syntax.symbols import Symbol, Symbols

ExpressionType = tuple[str, int]
"""The name of a type, "" of one that is not known, and the dimensions of an array of it."""

UNKNOWN: ExpressionType = ("", 0)

_PREFIXES = {"float": "", "double": "d", "int": "i", "uint": "u", "bool": "b"}
_SCALARS = {prefix: scalar for scalar, prefix in _PREFIXES.items()}
_VECTORS = {f"{prefix}vec{n}": (scalar, n) for scalar, prefix in _PREFIXES.items() for n in (2, 3, 4)}
_NUMBERS = {scalar: (scalar, 1) for scalar in _PREFIXES} | _VECTORS
_MATRICES = {
    f"{prefix}mat{columns}x{rows}": (scalar, columns, rows)
    for scalar, prefix in (("float", ""), ("double", "d"))
    for columns in (2, 3, 4)
    for rows in (2, 3, 4)
}
_MATRICES |= {f"{p}mat{n}": _MATRICES[f"{p}mat{n}x{n}"] for p in ("", "d") for n in (2, 3, 4)}
_WIDENING = ("bool", "int", "uint", "float", "double")
_COMPARISONS = frozenset("< > <= >= == != && || ^^ !".split())
_SIZES = {"1D": 1, "Buffer": 1, "3D": 3}  # of a texture: integers that its size has; others have 2


def components(name: str) -> tuple[str, int]:
    """Return the scalar type and the number of components of a scalar or vector; ("", 0) of all else."""
    return _NUMBERS.get(name, UNKNOWN)


def vector(scalar: str, count: int) -> str:
    """Return the type of so many components, a scalar for one; "" where GLSL has none."""
    if count == 1:
        return scalar
    return f"{_PREFIXES[scalar]}vec{count}" if scalar in _PREFIXES and 2 <= count <= 4 else ""


def matrix(name: str) -> tuple[str, int, int]:
    """Return the scalar type, the columns and the rows of a matrix; ("", 0, 0) of all else."""
    return _MATRICES.get(name, ("", 0, 0))


def is_built_in(name: str) -> bool:
    """Return whether a type is a scalar, a vector or a matrix."""
    return name in _NUMBERS or name in _MATRICES


def conversions(given: ExpressionType, wanted: ExpressionType) -> int | None:
    """Return how far an implicit conversion goes, 0 for the same type; None where there is none."""
    if given == wanted:
        return 0
    (source, count), (target, wanted_count) = components(given[0]), components(wanted[0])
    if matrix(given[0])[1:] == matrix(wanted[0])[1:] and matrix(given[0])[1]:
        return 0 if given[0].startswith("d") <= wanted[0].startswith("d") and not given[1] else None
    if not count or count != wanted_count or given[1] or wanted[1] or "bool" in (source, target):
        return None
    steps = _WIDENING.index(target) - _WIDENING.index(source)
    return steps if steps > 0 else None


class ExpressionTypes:
    """The types of a text's expressions, each computed once.

    ``given``: the types of names that stand around the text, and of what functions there return.
    """

    def __init__(self, symbols: Symbols, given: Mapping[str, str] | None = None) -> None:
        self._symbols = symbols
        self._given = {**BUILT_IN_VARIABLES, "true": "bool", "false": "bool", **(given or {})}
        self._types: dict[Node, ExpressionType] = {}
        self._members: dict[str, dict[str, ExpressionType]] = {}
        for symbol in symbols.symbols:
            if isinstance(symbol.node, Struct | InterfaceBlock) and symbol.kind in ("struct", "block"):
                members = _members_of(symbol.node)
                same = self._members.setdefault(symbol.node.name, members)
                if same != members:  # two scopes have a struct of this name
                    self._members[symbol.node.name] = {
                        name: of_type for name, of_type in same.items() if members.get(name) == of_type
                    }

    def of(self, node: Node) -> ExpressionType:
        """Return the type of an expression."""
        if node not in self._types:
            for part in reversed(list(walk(node))):  # long sums nest deeply: no recursion
                if part not in self._types:
                    self._types[part] = self._of(part)
        return self._types[node]

    def overload(self, call: Call) -> Symbol | None:
        """Return the function of the text that a call means; None where it is GLSL's, or a constructor."""
        functions = self._symbols.callees.get(call, ())
        if not functions:
            return None
        given = [self.of(argument) for argument in call.arguments]
        ranked = [(cost, symbol) for symbol in functions if (cost := _cost(symbol, given)) is not None]
        if ranked:
            return min(ranked, key=lambda pair: pair[0])[1]
        return None if call.name in BUILT_IN_FUNCTIONS else functions[0]

    def _of(self, node: Node) -> ExpressionType:
        match node:
            case Name():
                symbol = self._symbols.symbol_at.get(node.first)
                if symbol is not None:
                    return (
                        (symbol.type, symbol.arrays) if symbol.kind not in ("function", "struct") else UNKNOWN
                    )
                return self._given.get(node.name, ""), 0
            case Literal():
                return _literal(node.text), 0
            case Parenthesized():
                return self.of(node.inside)
            case Member():
                return self._member(*self.of(node.base), node.name)
            case Index():
                return _element(*self.of(node.base))
            case Unary():
                return ("bool", 0) if node.operator == "!" else self.of(node.operand)
            case Assign():
                return self.of(node.target)
            case Conditional():
                yes, no = self.of(node.yes), self.of(node.no)
                return yes if yes == no else (_widest((yes[0], no[0])), 0)
            case Binary():
                return self._binary(node)
            case Method():
                return ("int", 0) if node.name == "length" else UNKNOWN
            case Call():
                return self._call(node)
        return UNKNOWN

    def _member(self, name: str, arrays: int, member: str) -> ExpressionType:
        if arrays:
            return UNKNOWN
        if name in self._members:
            return self._members[name].get(member, UNKNOWN)
        scalar, count = components(name)
        return (vector(scalar, len(member)), 0) if count else UNKNOWN

    def _binary(self, node: Binary) -> ExpressionType:
        left, right = self.of(node.left), self.of(node.right)
        if node.operator == ",":
            return right
        if node.operator in _COMPARISONS:
            return "bool", 0
        if node.operator in ("<<", ">>"):
            return left
        if left[1] or right[1]:
            return UNKNOWN
        if node.operator == "*" and (matrix(left[0])[1] or matrix(right[0])[1]):
            return _product(left[0], right[0]), 0
        if matrix(left[0])[1]:
            return left
        if matrix(right[0])[1]:
            return right
        return _widest((left[0], right[0])), 0

    def _call(self, node: Call) -> ExpressionType:
        if node.arrays:
            return node.name, len(node.arrays)
        if is_built_in(node.name) or node.name in self._members:
            return node.name, 0
        function = self.overload(node)
        if function is not None:
            return function.type, function.arrays
        if node.name in self._given:
            return self._given[node.name], 0
        return _result(node.name, [self.of(argument)[0] for argument in node.arguments]), 0


def _members_of(node: Struct | InterfaceBlock) -> dict[str, ExpressionType]:
    return {
        one.name: (member.type.name, len(member.type.arrays) + len(one.arrays))
        for member in node.members
        for one in member.names
    }


def _cost(symbol: Symbol, given: Sequence[ExpressionType]) -> int | None:
    """Return the cost of the conversions with which a call can mean a function; None where it cannot."""
    assert isinstance(symbol.node, Function)
    if len(symbol.node.parameters) != len(given):
        return None
    total = 0
    for of_type, parameter in zip(given, symbol.node.parameters, strict=True):
        wanted = parameter.type.name, len(parameter.type.arrays) + len(parameter.arrays)
        pair = (wanted, of_type) if "out" in parameter.type.qualifiers else (of_type, wanted)
        cost = conversions(*pair) if of_type[0] else 0
        if cost is None:
            return None
        total += cost + (len(_WIDENING) * len(given) if cost else 0)  # one exact match more decides
    return total


def _literal(text: str) -> str:
    is_hexadecimal = text[1:2] in ("x", "X")
    if not is_hexadecimal and not {".", "e", "E", "f", "F"}.isdisjoint(text):
        return "double" if text[-2:] in ("lf", "LF") else "float"
    return "uint" if text[-1] in "uU" else "int"


def _element(name: str, arrays: int) -> ExpressionType:
    """Return the type of what an index picks."""
    if arrays:
        return name, arrays - 1
    scalar, columns, rows = matrix(name)
    return (vector(scalar, rows), 0) if columns else (components(name)[0], 0)


def _product(left: str, right: str) -> str:
    """Return the type of a product with a matrix: linear algebra's, or of each component with a scalar."""
    (scalar, columns, rows), (other, more_columns, inner) = matrix(left), matrix(right)
    widest = "double" if "double" in (scalar, other) else "float"
    if columns and more_columns:
        return _matrix_type(widest, more_columns, rows) if columns == inner else ""
    if columns:
        return vector(widest, rows) if components(right)[1] > 1 else left
    return vector(widest, more_columns) if components(left)[1] > 1 else right


def _matrix_type(scalar: str, columns: int, rows: int) -> str:
    size = f"{columns}" if columns == rows else f"{columns}x{rows}"
    return f"{_PREFIXES[scalar]}mat{size}"


def _widest(names: Iterable[str], scalar: str = "") -> str:
    """Return the type to which numbers are converted, of ``scalar`` if given; "" where there is none."""
    numbers = [components(name) for name in names]
    if not numbers or not all(count for _, count in numbers):
        return ""
    base = scalar or max((of_scalar for of_scalar, _ in numbers), key=_WIDENING.index)
    if scalar == "float" and any(of_scalar == "double" for of_scalar, _ in numbers):
        base = "double"
    return vector(base, max(count for _, count in numbers))


def _result(name: str, arguments: list[str]) -> str:
    """Return what a function of GLSL returns for arguments of some types."""
    result = BUILT_IN_FUNCTIONS.get(name.removesuffix("Fine").removesuffix("Coarse")) or _of_family(name)
    first = arguments[0] if arguments else ""
    if result == "first":
        return first
    if result == "*":
        return _widest(arguments[:2] if name == "mix" else arguments)
    if result.endswith("*"):
        if matrix(first)[1]:
            return first
        return _widest([of_type for of_type in arguments if of_type] or [""], result[:-1])
    if result == "texel":
        prefix = first[0] if first[:1] in ("i", "u") and first[1:].startswith(("sampler", "image")) else ""
        return "float" if first.endswith("Shadow") and name != "textureGather" else f"{prefix}vec4"
    if result == "texels":
        count = next((n for kind, n in _SIZES.items() if kind in first), 2)
        return vector("int", count + ("Array" in first))
    if result == "columns":
        return _of_columns(first, arguments[1] if len(arguments) > 1 else "")
    return result


def _of_family(name: str) -> str:
    """Return the result of functions that GLSL has many of, and of those that earlier versions had."""
    if name.startswith(("texture2D", "texture3D", "texture1D", "textureCube", "shadow1D", "shadow2D")):
        return "vec4"
    if name.startswith(("textureProj", "textureLod", "textureGrad", "textureGather", "texelFetch")):
        return "texel"
    if name.startswith("imageAtomic"):
        return ""
    if name.startswith(("atomicCounter",)):
        return "uint"
    return "first" if name.startswith(("atomic", "interpolateAt")) else ""


def _of_columns(first: str, second: str) -> str:
    """Return the type of ``transpose`` of a matrix, or of ``outerProduct`` of two vectors."""
    scalar, columns, rows = matrix(first)
    if columns:
        return _matrix_type(scalar, rows, columns)
    (base, count), (_, second_count) = components(first), components(second)
    return _matrix_type(base, second_count, count) if base in ("float", "double") and second_count > 1 else ""
