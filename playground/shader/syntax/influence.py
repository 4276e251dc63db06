"""Which statements of a text a symbol can influence, and which symbols nothing reads.

Influence is followed through assignments, calls and conditions, without regard to order: a statement that is
not listed never changes with the symbol; one that is listed may. A variable is followed as a whole, with its
members and elements. What a loop that never ends keeps from running is not followed.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Iterable, Iterator

from playground.shader.reserved_names import OUT_ARGUMENTS
from playground.shader.syntax.nodes import (
    Assign,
    Binary,
    Block,
    Call,
    Conditional,
    Declaration,
    Declarator,
    Do,
    Expression,
    For,
    Function,
    If,
    Index,
    Jump,
    Member,
    Name,
    Node,
    Parameter,
    Parenthesized,
    Switch,
    Unary,
    While,
    children,
    walk,
)
from playground.shader.syntax.symbols import Symbol, Symbols

ENTRY, PREVIOUS = "kernel", "previous"
"""The function of a kernel, and the name, or its beginning, of the function that reads the step before."""

ENTRIES = frozenset(
    "kernel vertex fragment main mainImage mainCubemap mainSound mainVR previous channel_texels".split()
)
"""Functions whose parameters are given by what calls them."""


class Influence:
    """What depends on what in one text."""

    def __init__(self, symbols: Symbols) -> None:
        self._symbols = symbols
        self._symbol_at = symbols.symbol_at
        self._callees = symbols.callees
        self._targets: dict[Hashable, set[Hashable]] = defaultdict(set)  # a fact → facts that follow from it
        self._statements: list[tuple[Node, frozenset[Hashable]]] = []  # each with the facts that it hangs on
        self._parameters = {each.node: each for each in symbols.symbols if each.kind == "parameter"}
        self._by_name: dict[str, list[Symbol]] = defaultdict(list)
        for function in symbols.functions():
            self._by_name[function.name].append(function)
        self._stopping = self._functions_with_discard()
        self._function: Function | None = None
        for node in symbols.tree.declarations:
            if isinstance(node, Function) and node.body is not None:
                self._function = node
                for parameter in node.parameters:
                    own = frozenset({self._parameters.get(parameter), ("runs", node)})
                    self._statements.append((parameter, own))
                self._visit(node.body, frozenset({("runs", node)}))
                if node.name == ENTRY:  # what it gives is what the next iteration reads as previous
                    outs = {self._parameters[each] for each in node.parameters if _is_out(each)}
                    self._flow({("result", node), *outs}, PREVIOUS)
            elif isinstance(node, Declaration):
                self._function = None
                self._visit(node, frozenset())

    def statements(self, names: Iterable[Symbol | str]) -> list[Node]:
        """Return the statements that any of some names can influence, or whether they run.

        Of a branch or a loop that is its condition, of a declaration its declarator, of a call parameters.
        ``names`` has texts of what the text does not declare.
        """
        facts: set[Hashable] = set(names)
        rest = list(facts)
        while rest:
            new = self._targets.get(rest.pop(), set()) - facts
            facts |= new
            rest += new
        return [node for node, own in self._statements if not facts.isdisjoint(own)]

    # ── statements ───────────────────────────────────────────────────────────

    def _visit(self, node: Node | None, around: frozenset[Hashable]) -> None:
        """Go through a statement; ``around`` is what decides whether it runs."""
        if isinstance(node, Block):
            for each in node.statements:
                self._visit(each, around)
                around |= self._leaving(each, around)
        elif isinstance(node, Declaration):
            for declarator in node.names:
                own = around
                for part in children(declarator):
                    own |= self._reads(part, around)
                self._flow(own, self._symbol_at.get(declarator.at))
                self._statements.append((declarator, own))
        elif isinstance(node, Expression):
            self._statements.append((node, around | self._reads(node.value, around)))
        elif isinstance(node, If):
            inside = around | self._condition(node.condition, around)
            self._visit(node.yes, inside)
            self._visit(node.no, inside)
        elif isinstance(node, For | While | Do):
            if isinstance(node, For):
                self._visit(node.start, around)
            # A jump in a loop decides on all later iterations, as its condition does.
            inside = around | self._leaving(node.body, around)
            if node.condition is not None:
                inside |= self._condition(node.condition, inside)
            if isinstance(node, For) and node.step is not None:
                self._statements.append((node.step, inside | self._reads(node.step, inside)))
            self._visit(node.body, inside)
        elif isinstance(node, Switch):
            self._visit(node.body, around | self._condition(node.value, around))
        elif isinstance(node, Jump) and self._function is not None:
            own = around
            if node.value is not None:
                own |= self._reads(node.value, around)
                self._flow(own, ("result", self._function))
            if node.word == "discard":
                self._flow(own, ("stops", self._function))
            self._statements.append((node, own))

    def _condition(self, node: Node, around: frozenset[Hashable]) -> frozenset[Hashable]:
        """Go through a condition, which may declare a variable; return what it reads."""
        if isinstance(node, Declaration):
            self._visit(node, around)
            names = {symbol for each in node.names if (symbol := self._symbol_at.get(each.at)) is not None}
            return frozenset(names)
        own = self._reads(node, around)
        self._statements.append((node, around | own))
        return own

    def _leaving(self, node: Node, around: frozenset[Hashable]) -> frozenset[Hashable]:
        """Return what decides whether a statement is left so that what follows it does not run."""
        calls = [each for each in walk(node) if isinstance(each, Call)] if self._stopping else []
        functions = {f.node for call in calls for f in self._functions(call)} & self._stopping
        stops = frozenset(("stops", function) for function in functions)
        if stops and self._function is not None:
            self._flow(around | stops, ("stops", self._function))
        return stops | (self._jumps(node) or frozenset())

    def _jumps(self, node: Node, breaks: bool = True, continues: bool = True) -> frozenset[Hashable] | None:
        """Return what the conditions around the jumps out of a statement read; None where it has none.

        ``breaks``, ``continues``: whether those words leave it, as they do but from a loop or a switch in it.
        """
        if isinstance(node, Jump):
            leaves = {"break": breaks, "continue": continues}.get(node.word, True)
            return frozenset() if leaves else None
        if isinstance(node, For | While | Do):
            parts, breaks, continues = [node.body], False, False
        elif isinstance(node, Switch):
            parts, breaks = [node.body], False
        elif isinstance(node, Block | If):
            parts = list(children(node))
        else:
            return None
        inside = [facts for part in parts if (facts := self._jumps(part, breaks, continues)) is not None]
        if not inside:
            return None
        head = node.value if isinstance(node, Switch) else getattr(node, "condition", None)
        return frozenset().union(*inside, self._names(head) if head is not None else ())

    def _names(self, node: Node) -> frozenset[Hashable]:
        """Return what an expression reads, without what it does."""
        facts: set[Hashable] = set()
        for each in walk(node):
            if isinstance(each, Name):
                facts.add(self._symbol_at.get(each.first, each.name))
            elif isinstance(each, Call):
                facts |= {("result", function.node) for function in self._functions(each)}
            elif isinstance(each, Declarator) and (symbol := self._symbol_at.get(each.at)) is not None:
                facts.add(symbol)
        return frozenset(facts)

    # ── expressions ──────────────────────────────────────────────────────────

    def _reads(self, node: Node, around: frozenset[Hashable]) -> frozenset[Hashable]:
        """Return what an expression reads; note what flows where in it."""
        if isinstance(node, Name):
            return frozenset({self._symbol_at.get(node.first, node.name)})
        if isinstance(node, Conditional):
            own = self._reads(node.condition, around)
            return own | self._reads(node.yes, around | own) | self._reads(node.no, around | own)
        if isinstance(node, Binary) and node.operator in ("&&", "||"):
            own = self._reads(node.left, around)
            return own | self._reads(node.right, around | own)
        if isinstance(node, Call):
            return self._call(node, around)
        own = frozenset()
        for part in children(node):
            is_written = isinstance(node, Assign) and node.operator == "=" and part is node.target
            own |= self._subscripts(part, around) if is_written else self._reads(part, around)
        if isinstance(node, Assign):
            self._flow(around | own, self._base(node.target))
        elif isinstance(node, Unary) and node.operator in ("++", "--"):
            self._flow(around | own, self._base(node.operand))
        return own

    def _call(self, node: Call, around: frozenset[Hashable]) -> frozenset[Hashable]:
        functions = self._functions(node)
        written = set(OUT_ARGUMENTS.get(node.name, ())) if not functions else _only_written(functions)
        arguments = [
            self._subscripts(argument, around) if number in written else self._reads(argument, around)
            for number, argument in enumerate(node.arguments)
        ]
        own: frozenset[Hashable] = frozenset().union(*arguments, () if functions else (_given(node.name),))
        for size in node.arrays:
            own |= self._reads(size, around) if size is not None else frozenset()
        for function in functions:
            own |= {("result", function.node)}
            self._flow(around, ("runs", function.node))
            assert isinstance(function.node, Function)
            for argument, facts, parameter in zip(
                node.arguments, arguments, function.node.parameters, strict=False
            ):
                symbol = self._parameters.get(parameter)
                self._flow(facts, symbol)
                if symbol is not None and _is_out(parameter):
                    self._flow(around | {symbol} | facts, self._base(argument))
        for number, argument in enumerate(node.arguments):
            if not functions and number in written:
                self._flow(around | own, self._base(argument))
        return own

    def _subscripts(self, node: Node, around: frozenset[Hashable]) -> frozenset[Hashable]:
        """Return what the place that is written reads: the indices in it."""
        own: frozenset[Hashable] = frozenset()
        while isinstance(node, Member | Index | Parenthesized):
            if isinstance(node, Index):
                own |= self._reads(node.index, around)
            node = node.inside if isinstance(node, Parenthesized) else node.base
        return own if isinstance(node, Name) else own | self._reads(node, around)

    def _functions(self, node: Call) -> list[Symbol]:
        """Return the functions of the text that a call may mean; for a prototype, its definitions."""
        called = self._callees.get(node, ())
        return [f for f in self._by_name[node.name] if _count(f) == len(node.arguments)] if called else []

    def _base(self, node: Node) -> Symbol | None:
        """Return the variable that an expression is a part of."""
        while isinstance(node, Member | Index | Parenthesized):
            node = node.inside if isinstance(node, Parenthesized) else node.base
        return self._symbol_at.get(node.first) if isinstance(node, Name) else None

    def _flow(self, facts: Iterable[Hashable], target: Hashable | None) -> None:
        if target is not None:
            for fact in facts:
                self._targets[fact].add(target)

    def _functions_with_discard(self) -> set[Node]:
        """Return the functions, by identity, that discard or call one that does."""
        calls: dict[Node, set[Node]] = {}
        stopping: set[Node] = set()
        for function in self._symbols.functions():
            calls[function.node] = set()
            for node in walk(function.node):
                if isinstance(node, Jump) and node.word == "discard":
                    stopping.add(function.node)
                elif isinstance(node, Call):
                    calls[function.node] |= {each.node for each in self._functions(node)}
        while more := {f for f, called in calls.items() if f not in stopping and called & stopping}:
            stopping |= more
        return stopping


def _given(name: str) -> str:
    """Return the fact of a function that the text does not declare."""
    return PREVIOUS if name.startswith(PREVIOUS) else name


def _count(function: Symbol) -> int:
    return len(function.node.parameters) if isinstance(function.node, Function) else -1


def _only_written(functions: Iterable[Symbol]) -> set[int]:
    """Return the arguments that each of some functions writes and does not read, by number."""
    by_function = []
    for function in functions:
        assert isinstance(function.node, Function)
        parameters = enumerate(function.node.parameters)
        by_function.append({number for number, each in parameters if "out" in each.type.qualifiers})
    return set.intersection(*by_function)


def _is_out(parameter: Parameter) -> bool:
    return not {"out", "inout"}.isdisjoint(parameter.type.qualifiers)


def unused(symbols: Symbols) -> list[Symbol]:
    """Return the locals and parameters of a text that nothing names behind their declaration.

    A parameter counts where its function has a body and no prototype, is not called by the engine or another
    tool, and where it gives nothing back. What a branch that was left out names is used.
    """
    tree = symbols.tree
    named = {r.symbol for r in symbols.references if r.symbol is not None and r.token != r.symbol.token}
    left_out = {token.text for branch in tree.branches for token in branch.tokens}
    functions = [node for node in tree.declarations if isinstance(node, Function)]
    prototypes = {node.name for node in functions if node.body is None}
    scopes = dict(entry for function in functions for entry in scopes_of(function))
    used = {(each.name, scopes.get(each.node)) for each in named}  # each branch may declare it once
    found = []
    for symbol in symbols.symbols:
        function = symbol.function
        if function is None or function.body is None or symbol.name in left_out:
            continue
        if (symbol.name, scopes.get(symbol.node)) in used:
            continue
        if symbol.kind == "local":
            found.append(symbol)
        elif (
            isinstance(symbol.node, Parameter)
            and not _is_out(symbol.node)
            and function.name not in ENTRIES
            and function.name not in prototypes
        ):
            found.append(symbol)
    return found


def scopes_of(function: Function) -> Iterator[tuple[Node, Node]]:
    """Yield the parameters and declarators of a function, each with the node that it can be named in."""
    for parameter in function.parameters:
        yield parameter, function
    rest: list[tuple[Node, Node]] = [(function.body, function)] if function.body is not None else []
    while rest:
        node, scope = rest.pop()
        if isinstance(node, Declaration):
            for declarator in node.names:
                yield declarator, scope
        elif isinstance(node, Expression | Jump):
            continue
        else:
            opens = isinstance(node, Block | For | While | If) and node is not function.body
            inside = node if opens else scope
            rest += [(part, inside) for part in children(node)]
