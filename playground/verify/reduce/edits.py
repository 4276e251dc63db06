"""A text's tree, made smaller: what may be left out, simpler expressions, and one form to print it in.

A candidate is the text with a few edits, each in the place of a node. Types decide which: an expression gives
way to a part of its own type, or to a literal of it, so nearly every candidate compiles. What a macro's text
makes is left as it is, but what a call hands the macro is edited there. ``tidy`` prints any text in one form,
so that two candidates that differ in blanks alone are one.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property

from playground.memo import TEXTS
from playground.shader.kernel import Output
from playground.shader.reserved_names import (
    BUILT_IN_FUNCTIONS,
    GIVEN,
    GLSL_WORDS,
    MATCHES,
    OUT_ARGUMENTS,
    TOWARDS,
    WIRED,
)
from playground.shader.syntax.nodes import (
    Assign,
    Binary,
    Block,
    Call,
    Case,
    Conditional,
    Declaration,
    Declarator,
    Do,
    Empty,
    Expression,
    For,
    Function,
    If,
    Index,
    InterfaceBlock,
    Jump,
    Literal,
    Member,
    Method,
    Name,
    Node,
    Parameter,
    Parenthesized,
    Struct,
    Switch,
    Type,
    Unary,
    While,
    children,
    walk,
)
from playground.shader.syntax.parser import PRECEDENCE, Tree, parse
from playground.shader.syntax.symbols import Symbol, Symbols, resolve
from playground.shader.syntax.tokens import Comment, Token, as_written, directive, tokenize, with_edits
from playground.shader.syntax.types import (
    UNKNOWN,
    ExpressionType,
    ExpressionTypes,
    components,
    conversions,
    is_built_in,
)

# ── printing ─────────────────────────────────────────────────────────────────


_ASSIGNS = frozenset("= += -= *= /= %= &= |= ^= <<= >>=".split())
_OPERATORS = frozenset("+ - * / % << >> < > <= >= == != && || ^^ & | ^".split())
_CONTROL = frozenset("if else for while do switch return case default break continue discard".split())
_NO_SPACE_BEFORE = frozenset(") ] , ; . ++ --".split())
_NO_SPACE_AFTER = frozenset("( [ . ! ~".split())
_BEFORE_SIGNS = frozenset(["", "(", "[", ",", "?", ":", "return", "{", "}", ";", *_ASSIGNS, *_OPERATORS])


def tidy(text: str) -> str:
    """Return a text with one statement a line, without comments but for the annotations of uniforms."""
    tokens, comments = tokenize(text)
    notes = [comment for comment in comments if comment.text.startswith("//!")]
    return "\n".join([*_Printer(tokens, notes).lines(), ""]) if tokens else ""


def token_count(text: str) -> int:
    """Return how many tokens a text has."""
    return len(tokenize(text)[0])


class _Printer:
    def __init__(self, tokens: Sequence[Token], notes: Sequence[Comment]) -> None:
        self._tokens = tokens
        self._notes = list(reversed(notes))  # the next one last
        self._lines: list[str] = []
        self._words: list[str] = []  # of the open line, blanks among them
        self._uniform = -1  # the line that an annotation belongs to
        self._depth = 0

    def lines(self) -> list[str]:
        brackets, last, is_unary = 0, "", False
        for index, token in enumerate(self._tokens):
            self._annotate(token.start)
            text = token.text
            if token.kind == "directive":
                self._end()
                self._lines.append(text.rstrip())
                last = ""
                continue
            is_sign = text in ("-", "+") and last in _BEFORE_SIGNS
            if self._words and _is_parted(last, text, is_unary):
                self._words.append(" ")
            self._words.append(text)
            is_unary, last = is_sign, text
            brackets += {"(": 1, "[": 1, ")": -1, "]": -1}.get(text, 0)
            if text == "{":
                self._end()
                self._depth += 1
            elif text == "}":
                depth = self._depth
                if not self._goes_on(index + 1):
                    self._end()
                self._depth = max(depth - 1, 0)
            elif text == ";" and brackets <= 0:
                self._end()
                brackets = 0
        self._end()
        self._annotate(None)
        return self._lines

    def _end(self) -> None:
        if self._words:
            shift = self._depth - 1 if self._words[0] == "}" else self._depth
            self._uniform = len(self._lines) if "uniform" in self._words else -1
            self._lines.append("    " * max(shift, 0) + "".join(self._words))
        self._words = []

    def _annotate(self, place: int | None) -> None:
        """Append the annotations before a place, or all, to the uniform above, on one line."""
        while self._notes and (place is None or self._notes[-1].start < place):
            note = self._notes.pop().text[3:].strip()
            if note and not self._words and self._uniform == len(self._lines) - 1 >= 0:
                self._lines[-1] += f"{' ' if '//!' in self._lines[-1] else '  //! '}{note}"

    def _goes_on(self, index: int) -> bool:
        """Return whether a closing brace's line does: in front of ``;``, or of a name as in ``} light;``."""
        following = [token.text for token in self._tokens[index : index + 2]]
        if following[:1] in ([";"], [","]):
            return True
        is_name = bool(following) and self._tokens[index].kind == "word" and following[0] not in _CONTROL
        return is_name and following[1:] in ([";"], ["["])


def _is_parted(last: str, text: str, is_unary: bool) -> bool:
    """Return whether a blank stands between two tokens of a line."""
    if text in _NO_SPACE_BEFORE or last in _NO_SPACE_AFTER or (is_unary and text[0] not in "+-"):
        return False
    if text == "[":
        return False
    if text == "(":
        return not (last[-1:].isalnum() or last[-1:] == "_" or last == "]") or last in _CONTROL
    if last in ("++", "--"):
        return text in _OPERATORS or text in _ASSIGNS
    return True


# ── candidates ───────────────────────────────────────────────────────────────


NUMBERS = (0, 1)
"""The numbers of literals that may take the place of an expression."""

NUMBERS_WITHOUT_ZERO = (1,)
"""The same where a zero could itself bring about what is looked for: a whole 0 becomes 0.0 in a division."""

Edit = tuple[int, int, str]
"""Where a part of a text begins and ends, and what takes its place."""

_ARITHMETIC = frozenset("+-*/")
_ENTRY_POINTS = frozenset("kernel visit vertex fragment main mainImage".split())
_PRIMARY, _POSTFIX_OPERAND, _UNARY, _ARGUMENT = 14, 13, 12, 0  # beside the parser's levels of operators
_OUTPUT = re.compile(r'\boutput\s*=\s*"([^"]*)"')
_OPTION = re.compile(r',?\s*\b(\w+)\s*=\s*("[^"]*"|\d+)')
_ROLE = re.compile(r"\w+(?:\([^)]*\))?")


def edited(text: str, edits: Iterable[Edit]) -> str:
    """Return a text with edits, none of which overlap."""
    return with_edits(text, {(start, end): new for start, end, new in edits})


def outputs_of(text: str) -> list[Output]:
    """Return what a kernel's header says that it gives."""
    match = _OUTPUT.search(text)
    rows = [row.partition(":") for row in (match[1] if match else "frame:rgba16f").split(",")]
    return [Output(name.strip(), form.strip()) for name, _, form in rows]


class Candidates:
    """The smaller texts of one text, of each kind those first that take the most away.

    ``given``: the types of names that stand around it, besides those that the engine gives a kernel.
    """

    def __init__(
        self, text: str, numbers: Sequence[int] = NUMBERS, given: Mapping[str, str] | None = None
    ) -> None:
        self.text = text
        self._numbers = numbers
        self._symbols = read(text)
        self._tree: Tree = self._symbols.tree
        self._given = given or {}
        self._uses: dict[Symbol, list[int]] = {}  # tokens, that of its declaration apart
        for one in self._symbols.references:
            for symbol in (one.symbol, *one.overloads):
                if symbol is not None and one.token != symbol.token:
                    self._uses.setdefault(symbol, []).append(one.token)

    # ── expressions ──────────────────────────────────────────────────────────

    def simplified(self) -> Iterator[str]:
        """Yield the text with one expression replaced by a part of it, or by a literal."""
        for edit in self._simplifications:
            yield edited(self.text, [edit])

    def simplified_with(self, other: str) -> Iterator[tuple[str, str]]:
        """Yield two texts with the same expression made simpler in each, where both have it once.

        A kernel and the compute shader that replaces it agree only as long as both change.
        """
        tokens, others = tokenize(self.text)[0], tokenize(other)[0]
        for edit in self._simplifications:
            start, end, new = edit
            part = [token.text for token in tokenize(self.text[start:end])[0]]
            there = _only_place(others, part)
            if there is not None and _only_place(tokens, part) is not None:
                yield edited(self.text, [edit]), edited(other, [(*there, new)])

    @cached_property
    def _simplifications(self) -> list[Edit]:
        tops = [top for top in self._tree.declarations if not _is_uniform(top)]
        edits = {edit for top in tops for edit in self._of_expressions(top)}
        return sorted(edits, key=lambda edit: (edit[0] - edit[1] + len(edit[2]), -edit[0], edit[2]))

    def _of_expressions(self, top: Node) -> Iterator[Edit]:
        for node in walk(top):
            if isinstance(node, Assign) and node.operator != "=":
                place = self._place(node.target.last, node.target.last + 1)
                if place and self._type_of(node.target) == self._type_of(node.value):
                    yield *place, "= "  # a letter longer, so that it comes last
            if node not in self._values:
                continue
            whole = self._with_brackets(node)
            place = self._place(whole.first, whole.last)
            if place is None:
                continue
            old = whole.last - whole.first
            for new in self._simpler(node, whole):
                count = token_count(new)
                if count < old or (old == 1 == count and isinstance(node, Name)):
                    yield *place, new

    def _simpler(self, node: Node, whole: Node) -> Iterator[str]:
        accepted = self._accepted(node, whole)
        of_type, arrays = self._type_of(node)
        if isinstance(node, Parenthesized):
            yield self._fitting(node.inside, whole)
            return
        if not arrays and not isinstance(node, Literal) and node not in self._loop_conditions:
            yield from (text for name, _ in accepted for text in self._literals(name))
        if isinstance(node, Call) and not node.arrays:
            if components(node.name)[1] > 1:
                scalars = [one for one in node.arguments if components(self._type_of(one)[0])[1] == 1]
                yield from (f"{node.name}({self._source(one)})" for one in scalars)
            elif not of_type:
                yield f"{node.name}()"
        parent = self._parents.get(whole)
        while isinstance(parent, Member | Parenthesized):
            parent = self._parents.get(parent)
        is_converted = isinstance(parent, Binary | Assign | Declarator | Call)
        for part in self._parts(node, accepted, is_converted):
            yield self._fitting(part, whole)

    def _with_brackets(self, node: Node) -> Node:
        """Return an expression with all the brackets around it."""
        while isinstance(parent := self._parents.get(node), Parenthesized):
            node = parent
        return node

    def _accepted(self, node: Node, whole: Node) -> list[ExpressionType]:
        """Return the types that may stand where an expression does: its own, and a scalar beside a vector."""
        own = self._type_of(node)
        parent = self._parents.get(whole)
        other = None
        if isinstance(parent, Binary) and parent.operator in _ARITHMETIC:
            other = parent.left if parent.right is whole else parent.right
        elif isinstance(parent, Assign) and parent.operator[:-1] in _ARITHMETIC and parent.value is whole:
            other = parent.target
        scalar, count = components(own[0])
        is_beside_vector = other is not None and count > 1 and self._type_of(other) == own
        return [own, (scalar, 0)] if is_beside_vector else [own]

    def _parts(self, node: Node, accepted: Sequence[ExpressionType], is_converted: bool) -> Iterator[Node]:
        """Yield the parts of an expression that may stand in its place, the outermost on each way down.

        ``is_converted``: whole numbers become floats there by themselves.
        """
        stack = list(children(node))
        while stack:
            part = stack.pop()
            own = self._type_of(part)
            fits = own == UNKNOWN or own in accepted
            if is_converted and not fits:
                floats = (other for other in accepted if components(other[0])[0] == "float")
                fits = any(conversions(own, other) is not None for other in floats)
            if fits and part not in self._written:
                yield part
            if not fits or own == UNKNOWN or own != accepted[0]:
                stack += children(part)

    def _literals(self, of_type: str) -> Iterator[str]:
        if of_type == "bool":
            yield from ("true", "false")
            return
        scalar, count = components(of_type)
        for number in self._numbers if is_built_in(of_type) else ():
            spelt = {"int": f"{number}", "uint": f"{number}u", "bool": "true"}.get(scalar, f"{number}.0")
            yield spelt if count == 1 and scalar != "double" else f"{of_type}({spelt})"

    def _fitting(self, part: Node, replaced: Node) -> str:
        """Return an expression as it may stand in the place of another, in brackets where it must."""
        while isinstance(part, Parenthesized):
            part = part.inside
        text = self._source(part)
        text = f" {text}" if text[0] in "+-" else text  # two signs would become one
        is_loose = _precedence(part) < _precedence_in(self._parents.get(replaced), replaced)
        return f"({text})" if is_loose else text

    def _type_of(self, node: Node) -> ExpressionType:
        return self._types.of(node)

    def _symbol_of(self, name: Name) -> Symbol | None:
        return self._symbols.symbol_at.get(name.first)

    @cached_property
    def _changed(self) -> set[Symbol | None]:
        """What expressions write, or parts of it."""
        return {self._symbol_of(one) for one in self._written if isinstance(one, Name)}

    @cached_property
    def _types(self) -> ExpressionTypes:
        names = {one.name for one in self._symbols.symbols if one.kind == "uniform"}
        given = {name: of_type for name, (of_type, _) in GIVEN.items()}
        given |= {f"{prefix}{name}": "bool" for prefix in (WIRED, MATCHES) for name in names}
        given |= {f"{TOWARDS}{name}": "vec3" for name in names}
        outputs = outputs_of(self.text)
        given |= {f"previous_{output.name}": output.glsl for output in outputs}
        return ExpressionTypes(self._symbols, given | {"previous": outputs[0].glsl, **self._given})

    @cached_property
    def _parents(self) -> dict[Node, Node]:
        return {part: node for node in walk(*self._tree.declarations) for part in children(node)}

    @cached_property
    def _values(self) -> set[Node]:
        """The expressions that are read, but sizes of arrays and labels of cases."""
        fixed: list[Node] = []
        for node in walk(*self._tree.declarations):
            if isinstance(node, Type | Declarator | Parameter | InterfaceBlock):
                fixed += [size for size in node.arrays if size is not None]
            elif isinstance(node, Case):
                fixed += children(node)
        read: set[Node] = {one for one in walk(*self._tree.declarations) if isinstance(one, _EXPRESSIONS)}
        return read - self._written - set(walk(*fixed))

    @cached_property
    def _written(self) -> set[Node]:
        """What expressions write, whole and their bases: targets, and arguments that functions write."""
        targets: list[Node] = []
        for node in walk(*self._tree.declarations):
            if isinstance(node, Assign):
                targets.append(node.target)
            elif isinstance(node, Unary) and node.operator in ("++", "--"):
                targets.append(node.operand)
            elif isinstance(node, Call):
                targets += self._outputs(node)
        return {base for target in targets for base in _bases(target)}

    def _outputs(self, call: Call) -> list[Node]:
        """Return the arguments that a call may write; all, of a function that nobody knows."""
        function = self._types.overload(call)
        if function is not None:
            assert isinstance(function.node, Function)
            pairs = zip(function.node.parameters, call.arguments, strict=False)
            return [one for p, one in pairs if not {"out", "inout"}.isdisjoint(p.type.qualifiers)]
        if call.name.startswith(("atomic", "imageAtomic")):
            return call.arguments[:1]
        if call.name in BUILT_IN_FUNCTIONS:
            return [one for i, one in enumerate(call.arguments) if i in OUT_ARGUMENTS.get(call.name, ())]
        is_type = is_built_in(call.name) or call.name.startswith(("texture", "texel", "shadow", "image"))
        symbol = self._symbols.symbol_at.get(call.at)
        return [] if is_type or symbol is not None else call.arguments

    @cached_property
    def _loop_conditions(self) -> set[Node]:
        """What makes a loop end: with a literal in its place, it might not."""
        loops = [one for one in walk(*self._tree.declarations) if isinstance(one, For | While | Do)]
        conditions = [loop.condition for loop in loops if loop.condition is not None]
        return {loop.step for loop in loops if isinstance(loop, For) and loop.step is not None} | {
            part
            for part in walk(*conditions)
            if any(self._symbol_of(one) in self._changed for one in walk(part) if isinstance(one, Name))
        }

    @cached_property
    def undefined(self) -> frozenset[str]:
        """The variables that are read but never given a value, and the functions that return none.

        What GLSL leaves undefined, drivers fill in as they like, and no failure of it is a driver's. A
        variable that a function may write may be given its value there.
        """
        names = {
            one.name for one in self._symbols.symbols if _begins_undefined(one) and one not in self._changed
        }
        functions = (one for one in self._tree.declarations if isinstance(one, Function) and one.body)
        unreturned = (one for one in functions if one.type.name != "void" and not _returns(one.body))
        return frozenset(names | {f"{one.name}()" for one in unreturned})

    @property
    def undeclared(self) -> frozenset[str]:
        """The names that neither the text nor GLSL nor the engine declares."""
        tokens = self._tree.tokens
        names = {tokens[one.token].text for one in self._symbols.references if one.symbol is None}
        prefixes = (WIRED, MATCHES, TOWARDS, "previous", "gl_")
        return frozenset(name for name in names - GLSL_WORDS - GIVEN.keys() if not name.startswith(prefixes))

    # ── variables and functions ──────────────────────────────────────────────

    def inlined(self) -> Iterator[str]:
        """Yield the text with one variable less: its value in its place, where that makes it smaller."""
        for node in walk(*self._tree.declarations):
            if not isinstance(node, Declaration) or len(node.names) != 1 or node.names[0].value is None:
                continue
            symbol = self._symbols.symbol_at.get(node.names[0].at)
            place = self._place(node.first, node.last)
            if symbol is None or place is None or symbol.kind not in ("local", "variable"):
                continue
            for edits in (self._overwritten(node, symbol), self._replaced(symbol, node.names[0].value)):
                text = edited(self.text, [*edits, (*place, "")]) if edits else self.text
                if token_count(text) < token_count(self.text):
                    yield text

    def _overwritten(self, node: Declaration, symbol: Symbol) -> list[Edit]:
        """Return the edits that declare a variable where it is set, if that is in the next statement."""
        parent = self._parents.get(node)
        rest = parent.statements[parent.statements.index(node) + 1 :] if isinstance(parent, Block) else []
        assign = rest[0].value if rest and isinstance(rest[0], Expression) else None
        if not isinstance(assign, Assign) or assign.operator != "=" or not isinstance(assign.target, Name):
            return []
        names = [one for one in walk(assign.value) if isinstance(one, Name)]
        place = self._place(assign.first, assign.first + 1)
        if self._symbol_of(assign.target) is not symbol or symbol in map(self._symbol_of, names) or not place:
            return []
        return [(place[0], place[0], f"{self._source(node.type)} ")]

    def _replaced(self, symbol: Symbol, value: Node) -> list[Edit]:
        """Return the edits that put a value in the place of a variable; none where that cannot be."""
        uses = [self._name_at.get(token) for token in self._uses.get(symbol, ())]
        names = [name for name in uses if name is not None and name not in self._written]
        places = [self._place(name.first, name.last) for name in names]
        if len(names) < len(uses) or None in places:
            return []
        of_type = self._type_of(value)
        is_converted = bool(of_type[0]) and of_type != (symbol.type, symbol.arrays)
        whole = f"{symbol.type}({self._source(value)})"
        texts = (whole if is_converted else self._fitting(value, name) for name in names)
        return [(*place, text) for place, text in zip(places, texts, strict=True) if place]

    @cached_property
    def _name_at(self) -> dict[int, Name]:
        return {n.first: n for n in walk(*self._tree.declarations) if isinstance(n, Name)}

    def without_parameter(self) -> Iterator[str]:
        """Yield the text without one parameter that a function does not read, nor its calls' arguments."""
        functions = [one.node for one in self._symbols.functions() if isinstance(one.node, Function)]
        for function in functions:
            same = [one for one in functions if one.name == function.name]
            counts = {len(one.parameters) for one in same}
            if function.name in _ENTRY_POINTS or not function.body or len(counts) > 1:
                continue
            if sum(one.body is not None for one in same) > 1:
                continue  # overloaded
            calls = [site.node for site in self._symbols.calls if site.node.name == function.name]
            lists: list[Sequence[Node]] = [
                *(one.parameters for one in same),
                *(one.arguments for one in calls),
            ]
            for number, parameter in enumerate(function.parameters):
                own = self._symbols.symbol_at.get(parameter.at) if parameter.name else None
                places = [self._item_place(row, number) for row in lists]
                if (own is None or own not in self._uses) and None not in places:
                    yield edited(self.text, [(*place, "") for place in places if place])

    def _item_place(self, row: Sequence[Node], number: int) -> tuple[int, int] | None:
        """Return the place of an item of a list, with a comma beside it."""
        if number >= len(row):
            return None
        first, last = row[number].first, row[number].last
        if number + 1 < len(row):
            last = row[number + 1].first
        elif number:
            first = row[number - 1].last
        return self._place(first, last)

    def stubs(self) -> Iterator[str]:
        """Yield the text with one function's body replaced by a constant, the last function first."""
        for top in reversed(self._tree.declarations):
            if not isinstance(top, Function) or top.body is None or top.type.arrays:
                continue
            place = self._place(top.body.first, top.body.last)
            literals = [one for one in self._literals(top.type.name) if one != "true"]
            if literals and place:
                new = f"{{ return {literals[0]}; }}"
                if token_count(new) < token_count(self.text[slice(*place)]):
                    yield edited(self.text, [(*place, new)])

    def without_unused(self) -> Iterator[str]:
        """Yield the text without all that nothing reads, then without each of it."""
        groups = list(self._unused())
        if len(groups) > 1:
            yield self._without(place for group in groups for place in group)
        yield from map(self._without, groups)

    def _without(self, places: Iterable[tuple[int, int]]) -> str:
        return edited(self.text, [(*place, "") for place in _merged(places)])

    def _unused(self) -> Iterator[list[tuple[int, int]]]:
        """Yield the places of each thing that nothing reads: where it is declared, and set."""
        preprocessed = self._tree.preprocessed
        called = {site.node.name for site in self._symbols.calls} | _ENTRY_POINTS
        for top in self._tree.declarations:
            if isinstance(top, Function) and top.name not in called:
                place = self._place(top.first, top.last)
                yield from [[place]] if place else []
            else:
                declared = [node for node in walk(top) if isinstance(node, Declaration) and node.type.name]
                for node in declared:
                    yield from self._unused_names(node)
        named = {one.name for one in preprocessed.expansions} | {one.text for one in self._tree.tokens}
        named |= {token.text for macro in preprocessed.macros for token in macro.body}
        for macro in preprocessed.macros:
            if macro.start >= 0 and macro.name not in named:
                yield [(macro.start, macro.end)]

    def _unused_names(self, node: Declaration) -> Iterator[list[tuple[int, int]]]:
        groups: list[list[tuple[int, int]]] = []
        for number, one in enumerate(node.names):
            symbol = self._symbols.symbol_at.get(one.at)
            if symbol is None or symbol.kind not in ("local", "variable", "uniform"):
                continue
            statements = [self._setting(token) for token in self._uses.get(symbol, ())]
            places = [self._place(each.first, each.last) if each else None for each in statements]
            places.append(self._item_place(node.names, number))
            if None not in places:
                groups.append([place for place in places if place])
        whole = self._place(node.first, node.last)
        struct = node.type.struct
        is_used = struct is not None and self._symbols.symbol_at.get(struct.at) in self._uses
        if len(groups) == len(node.names) and whole and not is_used:
            yield [place for group in groups for place in group[:-1]] + [whole]
        else:
            yield from groups

    def _setting(self, token: int) -> Expression | None:
        """Return the statement that does nothing but set the variable named by a token, or a part of it."""
        node: Node | None = self._name_at.get(token)
        parent = self._parents.get(node) if node else None
        while isinstance(parent, Member | Index) and parent.base is node:
            node, parent = parent, self._parents.get(parent)
        if not isinstance(parent, Assign) or parent.target is not node:
            return None
        statement = self._parents.get(parent)
        is_in_block = isinstance(statement, Expression) and isinstance(self._parents.get(statement), Block)
        return statement if isinstance(statement, Expression) and is_in_block else None

    # ── statements ───────────────────────────────────────────────────────────

    def unwrapped(self) -> Iterator[str]:
        """Yield the text with one statement replaced by what hangs on it."""
        for node in walk(*self._tree.declarations):
            place = self._place(node.first, node.last)
            if place is None:
                continue
            for part in self._inside(node):
                yield edited(self.text, [(*place, part)])

    def _inside(self, node: Node) -> Iterator[str]:
        in_block = isinstance(self._parents.get(node), Block)
        source = self._bare if in_block else self._source
        if isinstance(node, Block) and in_block:
            yield self._bare(node)
        elif isinstance(node, If):
            yield source(node.yes)
            if node.no is not None:
                yield source(node.no)
                yield self.text[self._tree.span(node)[0] : self._tree.span(node.yes)[1]]
        elif isinstance(node, For) and not _jumps(node.body) and not isinstance(node.start, Empty):
            both = f"{self._source(node.start)} {self._bare(node.body)}"
            yield both if in_block else f"{{ {both} }}"
        elif isinstance(node, For | While | Do) and not _jumps(node.body):
            yield source(node.body)

    def _bare(self, node: Node) -> str:
        """Return a statement, a block without its braces."""
        if not isinstance(node, Block):
            return self._source(node)
        start, end = self._tree.span(node)
        return self.text[start + 1 : end - 1]

    def lists(self) -> list[list[tuple[int, int]]]:
        """Return where the items of each list are: of the whole text, of each block and struct, in order.

        An item of a block is a statement, one of the text a declaration or a directive. A condition's
        directives and what is between them are one item.
        """
        tokens = tokenize(self.text)[0]
        lines = [*(token[2:4] for token in tokens if token.kind == "directive"), *_groups(tokens)]
        lists = [_merged([*map(self._tree.span, self._tree.declarations), *lines])]
        for node in walk(*self._tree.declarations):
            if isinstance(node, Block | Struct | InterfaceBlock) and self._place(node.first, node.last):
                start, end = self._tree.span(node)
                items = node.statements if isinstance(node, Block) else node.members
                inside = [line for line in lines if start < line[0] < end]
                lists.append(_merged([*map(self._tree.span, items), *inside]))
        return lists

    # ── headers ──────────────────────────────────────────────────────────────

    def headers(self) -> Iterator[str]:
        """Yield the text with an option less in its pragma, one step in place of many, or less annotation."""
        for token in self._tree.preprocessed.directives:
            if token.text.startswith("#pragma"):
                for start, end, new in _shorter_pragma(token.text):
                    yield edited(self.text, [(token.start + start, token.start + end, new)])
        for _, note in self._annotated():
            words = note.text[3:].strip()
            role = _ROLE.match(words)
            shorter = ["", *([f"//! {role[0]}"] if role else ())]
            if role and (kind := role[0].partition("(")[0]) in ("input", "file"):
                shorter.append(f"//! {kind}")
            yield from (
                edited(self.text, [(note.start, note.end, new)])
                for new in dict.fromkeys(shorter)
                if len(new) < len(f"//! {words}")
            )

    def constants(self, values: Mapping[str, str]) -> Iterator[str]:
        """Yield the text with one parameter folded in as a constant; ``values`` are GLSL, by name.

        A parameter that is not among them has its default.
        """
        notes = dict(self._annotated())
        for node in self._tree.declarations:
            if not (isinstance(node, Declaration) and _is_uniform(node) and len(node.names) == 1):
                continue
            one = node.names[0]
            default = self._source(one.value) if one.value is not None else ""
            value = values.get(one.name, default)
            if value and is_built_in(node.type.name) and (place := self._place(node.first, node.last)):
                end = notes[node].end if node in notes else place[1]
                yield edited(self.text, [(place[0], end, f"const {node.type.name} {one.name} = {value};")])

    def _annotated(self) -> Iterator[tuple[Node, Comment]]:
        """Yield the uniforms that have an annotation behind them, with it."""
        notes = [one for one in self._tree.preprocessed.comments if one.text.startswith("//!")]
        for node in self._tree.declarations:
            if isinstance(node, Declaration) and _is_uniform(node):
                end = self._tree.span(node)[1]
                note = next((one for one in notes if one.start >= end), None)
                if note is not None and not self.text[end : note.start].strip():
                    yield node, note

    # ── places ───────────────────────────────────────────────────────────────

    def _source(self, node: Node) -> str:
        """Return the text of a node, behind the preprocessor where a macro makes it with others."""
        place = self._place(node.first, node.last)
        if place is not None:
            return self.text[slice(*place)]
        return " ".join(token.text for token in self._tree.tokens[node.first : node.last])

    def _place(self, first: int, last: int) -> tuple[int, int] | None:
        """Return where some tokens stand in the text; None where a macro's text makes them with others."""
        tokens = self._tree.tokens
        if last <= first:
            return None
        begin, end = tokens[first], tokens[last - 1]
        around = tokens[first - 1 : first] + tokens[last : last + 1]
        if not any(one.macros for one in (begin, end)):
            return begin.start, end.end
        if not any(one.macros and one.start in (begin.start, end.start) for one in around):
            return begin.start, end.end
        in_call = all(begin.start <= one.spelled < begin.end for one in tokens[first:last])
        return (begin.spelled, end.spelled + len(end.text)) if in_call else None


_EXPRESSIONS = (Binary, Unary, Conditional, Call, Method, Parenthesized, Member, Index, Name, Literal)


def _precedence(node: Node) -> int:
    """Return how tightly an expression holds together: the higher, the fewer brackets it needs."""
    if isinstance(node, Binary):
        return -1 if node.operator == "," else PRECEDENCE[node.operator]
    if isinstance(node, Assign | Conditional):
        return 0
    return _UNARY if isinstance(node, Unary) and not node.is_postfix else _PRIMARY


def _precedence_in(parent: Node | None, node: Node) -> int:
    """Return what an expression needs so that it may stand without brackets where another does."""
    match parent:
        case Binary():
            level = _precedence(parent)
            return level + (parent.right is node)
        case Unary():
            return _UNARY
        case Member() | Method():
            return _POSTFIX_OPERAND
        case Index():
            return _POSTFIX_OPERAND if parent.base is node else -1
        case Conditional():
            return 1 if parent.condition is node else _ARGUMENT
        case Call() | Declarator() | Assign():
            return _ARGUMENT
    return -1


def _is_uniform(node: Node) -> bool:
    return isinstance(node, Declaration) and "uniform" in node.type.qualifiers


def _bases(node: Node) -> Iterator[Node]:
    """Yield what is written by an expression, and what that is a part of."""
    yield node
    while isinstance(node, Member | Index | Parenthesized):
        node = node.inside if isinstance(node, Parenthesized) else node.base
        yield node


def _begins_undefined(symbol: Symbol) -> bool:
    if isinstance(symbol.node, Declarator):
        return symbol.kind == "local" and symbol.node.value is None
    return symbol.kind == "parameter" and "out" in symbol.qualifiers


def _returns(body: Node | None) -> bool:
    """Return whether a function's own level has a return that hangs on nothing."""
    if isinstance(body, Block):
        return any(map(_returns, body.statements))
    return isinstance(body, Jump) and body.word == "return"


def _jumps(body: Node) -> bool:
    """Return whether a loop's body leaves the loop, or goes on with it, by a jump of its own."""
    stack = [body]
    while stack:
        node = stack.pop()
        if isinstance(node, Jump) and node.word in ("break", "continue"):
            return True
        if not isinstance(node, For | While | Do | Switch):
            stack += children(node)
    return False


def _only_place(tokens: Sequence[Token], part: Sequence[str]) -> tuple[int, int] | None:
    """Return where some tokens occur among others, if they do so once."""
    texts = [token.text for token in tokens]
    first = [i for i in range(len(texts) - len(part) + 1) if texts[i : i + len(part)] == part]
    return (tokens[first[0]].start, tokens[first[0] + len(part) - 1].end) if len(first) == 1 else None


def _groups(tokens: Sequence[Token]) -> list[tuple[int, int]]:
    """Return where conditions of the preprocessor begin and end, with what is between."""
    groups, open_ = [], []
    for token in tokens:
        word = directive(token.text)[0] if token.kind == "directive" else ""
        if word in ("if", "ifdef", "ifndef"):
            open_.append(token.start)
        elif word == "endif" and open_:
            groups.append((open_.pop(), token.end))
    return groups


def _merged(spans: Iterable[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return spans in order, those that overlap as one."""
    merged: list[tuple[int, int]] = []
    for start, end in sorted(spans):
        if merged and start < merged[-1][1]:
            merged[-1] = merged[-1][0], max(end, merged[-1][1])
        elif end > start:
            merged.append((start, end))
    return merged


def _shorter_pragma(line: str) -> Iterator[Edit]:
    for match in _OPTION.finditer(line):
        if match[1] not in ("output", "mesh"):
            yield *match.span(), ""
        if match[1] == "repeat" and match[2] not in ('"1"', '"2"'):
            yield from ((*match.span(2), f'"{steps}"') for steps in (1, 2))


# ── reading ──────────────────────────────────────────────────────────────────


_MAX_EXPANDED_TOKENS = 20_000  # of one macro: each candidate is read once


@TEXTS.cached(weight=256)
def read(text: str) -> Symbols:
    """Return the symbols of a text as its stage has it; treat them as constant.

    Macros that double to more than can be read of every candidate are names there.
    """
    sizes: dict[str, int] = {}
    places: list[tuple[int, int]] = []
    for token in tokenize(text)[0] if "#define" in text else ():
        if token.kind == "directive" and directive(token.text)[0] == "define":
            _, _, name, *body = [*(word.text for word in as_written(token.text)), ""]
            sizes[name] = sum(sizes.get(word, 1) for word in body)
            places.append((token.start, token.end))
    if max(sizes.values(), default=0) > _MAX_EXPANDED_TOKENS:
        text = edited(text, [(*place, " " * (place[1] - place[0])) for place in places])
    stage = "COMPUTE_STAGE" if "#pragma compute" in text else "FRAGMENT_STAGE"
    return resolve(parse(text, {stage: ""}))


def uniforms_of(text: str) -> dict[str, str]:
    """Return the types of a text's uniforms by their names."""
    return {one.name: one.type for one in read(text).symbols if one.kind == "uniform"}
