"""What each name of a GLSL text means: symbols, their references, calls with the functions they may mean.

Scopes are GLSL 4.60's, section 4.2.2. A name that the text does not declare, of GLSL or of what stands around
an author's file, is a reference without a symbol. Of overloads, those with the call's number of arguments are
kept; ``types`` chooses among them.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from playground.memo import TEXTS
from playground.shader.syntax.nodes import (
    Block,
    Call,
    Case,
    Declaration,
    Do,
    Expression,
    For,
    Function,
    If,
    InterfaceBlock,
    Jump,
    Name,
    Node,
    Struct,
    Switch,
    Type,
    While,
    children,
    walk,
)
from playground.shader.syntax.parser import Tree, collector_paused, parse


@dataclass(slots=True, eq=False)
class Symbol:
    """What a text declares by a name."""

    name: str
    kind: str  # function | struct | variable | uniform | parameter | local | block | member
    type: str  # "" of a struct
    token: int  # of its name
    node: Node
    function: Function | None = None  # around it
    arrays: int = 0  # dimensions
    qualifiers: tuple[str, ...] = ()


@dataclass(slots=True)
class Reference:
    """A name in some place, its declaration's too; ``symbol`` is None where the text does not declare it."""

    token: int
    symbol: Symbol | None
    overloads: tuple[Symbol, ...] = ()  # what a call may mean as well
    function: Function | None = None  # around it


@dataclass(slots=True)
class CallSite:
    """A call or a constructor; ``functions`` are those of the text that it may mean."""

    node: Call
    functions: tuple[Symbol, ...]
    around: Function | None


@dataclass(slots=True)
class Symbols:
    """The symbols of a tree, without its branches."""

    tree: Tree
    symbols: list[Symbol] = field(default_factory=list)
    references: list[Reference] = field(default_factory=list)
    calls: list[CallSite] = field(default_factory=list)
    symbol_at: dict[int, Symbol] = field(default_factory=dict)
    """By token: what a name in that place means."""
    callees: dict[Call, tuple[Symbol, ...]] = field(default_factory=dict)
    """By call: the functions of the text that it may mean."""

    def functions(self) -> list[Symbol]:
        """Return the functions, prototypes too."""
        return [symbol for symbol in self.symbols if symbol.kind == "function"]


def has_same_signature(one: Node, other: Node) -> bool:
    """Return whether two functions have the same name and the same types of parameters."""
    assert isinstance(one, Function)
    assert isinstance(other, Function)

    def signature(function: Function) -> list[tuple[str, int]]:
        return [(p.type.name, len(p.arrays) + len(p.type.arrays)) for p in function.parameters]

    return one.name == other.name and signature(one) == signature(other)


def _parameter_count(symbol: Symbol) -> int:
    return len(symbol.node.parameters) if isinstance(symbol.node, Function) else -1


def resolve(tree: Tree) -> Symbols:
    """Return what each name of a text means."""
    return _Resolver(tree).symbols


@TEXTS.cached(weight=256)  # nodes and tokens are many
def symbols_of(text: str, *, all_branches: bool = False, unknown: bool = False) -> Symbols:
    """Return the symbols of a text; treat them as constant. ``parse`` has the arguments."""
    with collector_paused():
        return resolve(parse(text, all_branches=all_branches, unknown=unknown))


def readings(text: str) -> tuple[Symbols, ...]:
    """Return the symbols of a text, of one reading or of two.

    What the driver defines (``GL_…``) is not known here: there is a reading without, and one with all of it
    where that makes a difference. Empty where its macros expand to too much.
    """
    results = [symbols_of(text)]
    if results[0].tree.preprocessed.depends_on_driver:
        other = symbols_of(text, unknown=True)
        results += [other] if other.tree.tokens != results[0].tree.tokens else []
    is_truncated = any(result.tree.preprocessed.is_truncated for result in results)
    return () if is_truncated else tuple(results)


class _Resolver:
    def __init__(self, tree: Tree) -> None:
        self.symbols = Symbols(tree)
        self._scopes: list[dict[str, list[Symbol]]] = [{}]
        self._function: Function | None = None
        for node in tree.declarations:
            self._external(node)

    # ── scopes ───────────────────────────────────────────────────────────────

    def _note(self, symbol: Symbol) -> None:
        self.symbols.symbols.append(symbol)
        self._refer(symbol.token, symbol)

    def _refer(self, token: int, symbol: Symbol | None, overloads: tuple[Symbol, ...] = ()) -> None:
        self.symbols.references.append(Reference(token, symbol, overloads, self._function))
        if symbol is not None:
            self.symbols.symbol_at[token] = symbol

    def _declare(self, symbol: Symbol) -> None:
        scope = self._scopes[-1]
        if symbol.kind == "function":
            known = scope.setdefault(symbol.name, [])
            if known and known[0].kind != "function":
                known.clear()
            known.append(symbol)
        else:
            scope[symbol.name] = [symbol]
        self._note(symbol)

    def _look_up(self, name: str) -> list[Symbol]:
        for scope in reversed(self._scopes):
            if name in scope:
                return scope[name]
        return []

    def _use(self, token: int, name: str) -> None:
        known = self._look_up(name)
        self._refer(token, known[0] if known else None, tuple(known[1:]))

    # ── declarations ─────────────────────────────────────────────────────────

    def _external(self, node: Node) -> None:
        if isinstance(node, Function):
            self._function_definition(node)
        elif isinstance(node, InterfaceBlock):
            for member in node.members:
                self._members(member, "member" if node.instance else "variable")
            self._each(node.arrays)
            if node.instance:
                qualifiers = tuple(node.qualifiers)
                self._declare(
                    Symbol(
                        node.instance,
                        "block",
                        node.name,
                        node.instance_at,
                        node,
                        arrays=len(node.arrays),
                        qualifiers=qualifiers,
                    )
                )
        else:
            self._visit(node)

    def _function_definition(self, node: Function) -> None:
        self._type(node.type)
        qualifiers, arrays = tuple(node.type.qualifiers), len(node.type.arrays)
        self._declare(Symbol(node.name, "function", node.type.name, node.at, node, None, arrays, qualifiers))
        self._function = node
        self._scopes.append({})
        for parameter in node.parameters:
            self._type(parameter.type)
            self._each(parameter.arrays)
            if parameter.name:
                count = len(parameter.arrays) + len(parameter.type.arrays)
                of_type, qualifiers = parameter.type.name, tuple(parameter.type.qualifiers)
                symbol = Symbol(
                    parameter.name, "parameter", of_type, parameter.at, parameter, node, count, qualifiers
                )
                self._declare(symbol)
        if node.body is not None:
            self._each(node.body.statements)
        self._scopes.pop()
        self._function = None

    def _members(self, member: Declaration, kind: str) -> None:
        self._type(member.type)
        for one in member.names:
            self._each(one.arrays)
            count = len(one.arrays) + len(member.type.arrays)
            symbol = Symbol(one.name, kind, member.type.name, one.at, one, self._function, count)
            if kind == "member":
                self._note(symbol)
            else:
                self._declare(symbol)

    def _type(self, of_type: Type) -> None:
        self._each(of_type.arrays)
        struct = of_type.struct
        if struct is not None:
            self._struct(struct)
        elif of_type.at >= 0:
            self._use(of_type.at, of_type.name)

    def _struct(self, struct: Struct) -> None:
        for member in struct.members:
            self._members(member, "member")
        if struct.name:
            self._declare(Symbol(struct.name, "struct", "", struct.at, struct, self._function))

    def _declaration(self, node: Declaration) -> None:
        self._type(node.type)
        qualifiers = tuple(node.type.qualifiers)
        kind = "local" if self._function is not None else "uniform" if "uniform" in qualifiers else "variable"
        for one in node.names:
            self._each(one.arrays)
            if one.value is not None:
                self._visit(one.value)
            if not node.type.name and node.type.struct is None:  # invariant gl_Position;
                self._use(one.at, one.name)
                continue
            count = len(one.arrays) + len(node.type.arrays)
            self._declare(
                Symbol(one.name, kind, node.type.name, one.at, one, self._function, count, qualifiers)
            )

    # ── statements and expressions ───────────────────────────────────────────

    def _each(self, nodes: Iterable[Node | None]) -> None:
        for node in nodes:
            if node is not None:
                self._visit(node)

    def _visit(self, node: Node) -> None:
        match node:
            case Declaration():
                self._declaration(node)
            case Block():
                self._inside(node)
            case For():
                self._scopes.append({})
                self._each((node.start, node.condition, node.step))
                self._inside(node.body)
                self._scopes.pop()
            case While():
                self._scopes.append({})
                self._visit(node.condition)
                self._inside(node.body)
                self._scopes.pop()
            case If():
                self._if(node)
            case Switch():
                self._visit(node.value)
                self._inside(node.body)
            case Function():  # a prototype inside a function's body
                around = self._function
                self._function_definition(node)
                self._function = around
            case Expression() | Jump() | Case() | Do():
                self._each(children(node))
            case _:
                self._expression(node)

    def _if(self, node: If) -> None:
        depth = len(self._scopes)
        following: Node | None = node
        while isinstance(following, If):  # a loop: chains of else if may be longer than the stack is deep
            self._scopes.append({})
            self._visit(following.condition)
            self._inside(following.yes)
            following = following.no
        if following is not None:
            self._inside(following)
        del self._scopes[depth:]

    def _expression(self, node: Node) -> None:
        """Note the names of an expression, which may be long: sums are as deep as they have terms."""
        for part in walk(node):
            if isinstance(part, Name):
                self._use(part.first, part.name)
            elif isinstance(part, Call):
                self._call(part)

    def _inside(self, node: Node) -> None:
        """Visit a statement in a scope of its own."""
        self._scopes.append({})
        self._each(node.statements if isinstance(node, Block) else (node,))
        self._scopes.pop()

    def _call(self, node: Call) -> None:
        known = self._look_up(node.name)
        functions = [one for one in known if one.kind == "function"]
        if functions:
            count = len(node.arguments)
            fitting = [one for one in functions if _parameter_count(one) == count]
            known = functions = fitting or functions
        self._refer(node.at, known[0] if known else None, tuple(known[1:]))
        self.symbols.callees[node] = tuple(functions)
        self.symbols.calls.append(CallSite(node, tuple(functions), self._function))
