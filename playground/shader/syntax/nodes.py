"""The nodes of a GLSL syntax tree.

A node covers the tokens from ``first`` up to, not including, ``last``; ``at`` is the token of its name. Nodes
compare by identity. ``children`` and ``walk`` go through a tree in the order of its text.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar


@dataclass(slots=True, eq=False)
class Node:
    """A part of the tree."""

    first: int
    last: int
    parts: ClassVar[tuple[str, ...]] = ()
    """Fields that hold nodes, in the order of the text."""


# ── expressions ──────────────────────────────────────────────────────────────


@dataclass(slots=True, eq=False)
class Name(Node):
    """A variable, or a function or type named alone."""

    name: str


@dataclass(slots=True, eq=False)
class Literal(Node):
    """A number."""

    text: str


@dataclass(slots=True, eq=False)
class Call(Node):
    """A call or a constructor, ``float[3](…)`` too."""

    name: str
    at: int
    arrays: list[Node | None]
    arguments: list[Node]
    parts: ClassVar = ("arrays", "arguments")


@dataclass(slots=True, eq=False)
class Method(Node):
    """``heights.length()``."""

    base: Node
    name: str
    arguments: list[Node]
    parts: ClassVar = ("base", "arguments")


@dataclass(slots=True, eq=False)
class Index(Node):
    """``heights[i]``."""

    base: Node
    index: Node
    parts: ClassVar = ("base", "index")


@dataclass(slots=True, eq=False)
class Member(Node):
    """A member of a struct, or a swizzle."""

    base: Node
    name: str
    at: int
    parts: ClassVar = ("base",)


@dataclass(slots=True, eq=False)
class Unary(Node):
    """``-x``, ``x++``."""

    operator: str
    operand: Node
    is_postfix: bool
    parts: ClassVar = ("operand",)


@dataclass(slots=True, eq=False)
class Binary(Node):
    """Two operands; the operator may be a comma."""

    operator: str
    left: Node
    right: Node
    parts: ClassVar = ("left", "right")


@dataclass(slots=True, eq=False)
class Assign(Node):
    """``=``, ``+=`` and the like."""

    operator: str
    target: Node
    value: Node
    parts: ClassVar = ("target", "value")


@dataclass(slots=True, eq=False)
class Conditional(Node):
    """``condition ? yes : no``."""

    condition: Node
    yes: Node
    no: Node
    parts: ClassVar = ("condition", "yes", "no")


@dataclass(slots=True, eq=False)
class Parenthesized(Node):
    """``(x)``."""

    inside: Node
    parts: ClassVar = ("inside",)


@dataclass(slots=True, eq=False)
class InitializerList(Node):
    """``{1.0, 2.0}``."""

    items: list[Node]
    parts: ClassVar = ("items",)


# ── declarations ─────────────────────────────────────────────────────────────


@dataclass(slots=True, eq=False)
class Type(Node):
    """Qualifiers and a type; ``name`` is "" where there is none, as in ``invariant gl_Position;``."""

    qualifiers: list[str]  # a layout whole, without blanks: "layout(location=0)"
    name: str
    at: int  # -1 where there is no name, or a struct stands in its place
    arrays: list[Node | None]
    struct: Struct | None
    parts: ClassVar = ("arrays", "struct")


@dataclass(slots=True, eq=False)
class Declarator(Node):
    """One name of a declaration, with its array sizes and its initializer."""

    name: str
    at: int
    arrays: list[Node | None]
    value: Node | None
    parts: ClassVar = ("arrays", "value")


@dataclass(slots=True, eq=False)
class Declaration(Node):
    """Variables of one type; none of ``layout(…) in;`` or ``struct S {…};``."""

    type: Type
    names: list[Declarator]
    parts: ClassVar = ("type", "names")


@dataclass(slots=True, eq=False)
class Parameter(Node):
    """One parameter of a function."""

    type: Type
    name: str  # "" for one without
    at: int
    arrays: list[Node | None]
    parts: ClassVar = ("type", "arrays")


@dataclass(slots=True, eq=False)
class Function(Node):
    """A definition, or a prototype without a body."""

    type: Type
    name: str
    at: int
    parameters: list[Parameter]
    body: Block | None
    parts: ClassVar = ("type", "parameters", "body")


@dataclass(slots=True, eq=False)
class Struct(Node):
    """``struct S {…}``."""

    name: str  # "" for one without
    at: int
    members: list[Declaration]
    parts: ClassVar = ("members",)


@dataclass(slots=True, eq=False)
class InterfaceBlock(Node):
    """A uniform, buffer, in or out block."""

    qualifiers: list[str]
    name: str
    at: int
    members: list[Declaration]
    instance: str  # "" for one without
    instance_at: int
    arrays: list[Node | None]
    parts: ClassVar = ("members", "arrays")


@dataclass(slots=True, eq=False)
class Precision(Node):
    """``precision mediump float;``."""


# ── statements ───────────────────────────────────────────────────────────────


@dataclass(slots=True, eq=False)
class Block(Node):
    """Statements in braces."""

    statements: list[Node]
    parts: ClassVar = ("statements",)


@dataclass(slots=True, eq=False)
class Expression(Node):
    """An expression and its semicolon."""

    value: Node
    parts: ClassVar = ("value",)


@dataclass(slots=True, eq=False)
class If(Node):
    """``if``, with or without ``else``."""

    condition: Node  # a Declaration where it declares a variable
    yes: Node
    no: Node | None
    parts: ClassVar = ("condition", "yes", "no")


@dataclass(slots=True, eq=False)
class For(Node):
    """``for``."""

    start: Node
    condition: Node | None
    step: Node | None
    body: Node
    parts: ClassVar = ("start", "condition", "step", "body")


@dataclass(slots=True, eq=False)
class While(Node):
    """``while``."""

    condition: Node
    body: Node
    parts: ClassVar = ("condition", "body")


@dataclass(slots=True, eq=False)
class Do(Node):
    """``do`` … ``while``."""

    body: Node
    condition: Node
    parts: ClassVar = ("body", "condition")


@dataclass(slots=True, eq=False)
class Switch(Node):
    """``switch``."""

    value: Node
    body: Block
    parts: ClassVar = ("value", "body")


@dataclass(slots=True, eq=False)
class Case(Node):
    """``case 3:``, or ``default:`` without a value."""

    value: Node | None
    parts: ClassVar = ("value",)


@dataclass(slots=True, eq=False)
class Jump(Node):
    """``return``, ``break``, ``continue`` or ``discard``."""

    word: str
    value: Node | None
    parts: ClassVar = ("value",)


@dataclass(slots=True, eq=False)
class Empty(Node):
    """A semicolon alone."""


@dataclass(slots=True)
class ParseError:
    """A token that the grammar does not expect."""

    token: int  # its index; the number of tokens at the end of the text
    message: str


def children(node: Node) -> Iterator[Node]:
    """Yield the parts of a node, in the order of the text."""
    for name in node.parts:
        part = getattr(node, name)
        if isinstance(part, list):
            yield from (one for one in part if one is not None)
        elif part is not None:
            yield part


def walk(*nodes: Node) -> Iterator[Node]:
    """Yield nodes and all in them, each before its parts."""
    stack = list(reversed(nodes))
    while stack:
        node = stack.pop()
        yield node
        if node.parts:
            stack += reversed(list(children(node)))
