"""A text as a tree of lines and blocks, and the same text with some of them left out.

It works on tidy text, where a statement is a line and a block begins with a line that
ends in a brace.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from playground.verify.reduce.ddmin import ddmin

Test = Callable[[str], bool]
"""Says whether a text still fails in the same way."""

Nodes = tuple["Node", ...]

_UNWRAPPED = ("if", "else", "for", "while", "do", "switch", "{")


@dataclass(frozen=True)
class Node:
    """A line, or a block with its first and last line."""

    head: str
    body: tuple[Node, ...] | None = None  # None: a single line
    tail: str = ""

    def lines(self) -> Iterator[str]:
        """Yield its lines."""
        yield self.head
        if self.body is not None:
            for node in self.body:
                yield from node.lines()
            yield self.tail


def parse(text: str) -> Nodes:
    """Return a tidy text's top level."""
    stack: list[tuple[str, list[Node]]] = [("", [])]
    for line in filter(str.strip, text.split("\n")):
        code = line.strip()
        if code.startswith("}") and len(stack) > 1:
            head, body = stack.pop()
            stack[-1][1].append(Node(head, tuple(body), line))
        elif code.endswith("{") and not code.startswith("#"):
            stack.append((line, []))
        else:
            stack[-1][1].append(Node(line))
    while len(stack) > 1:  # a brace that is never closed: its lines are single lines
        head, body = stack.pop()
        stack[-1][1].extend([Node(head), *body])
    return tuple(stack[0][1])


def text_of(nodes: Nodes) -> str:
    """Return the text of a level."""
    return "".join(f"{line}\n" for node in nodes for line in node.lines())


def fewer_lines(text: str, test: Test) -> str:
    """Return the text with lines and blocks left out at every depth, each level made 1-minimal.

    The whole level goes first, then what is inside each block that stays, so a function
    that nothing needs costs one try.
    """

    def holds(nodes: Nodes) -> bool:
        return test(text_of(nodes))

    level = tuple(ddmin(parse(text), lambda some: holds(tuple(some))))
    return text_of(_inside_each(level, holds))


def _inside_each(level: Nodes, holds: Callable[[Nodes], bool]) -> Nodes:
    """Make each block of a level smaller, one after the other."""
    index = 0
    while index < len(level):
        before, node, after = level[:index], level[index], level[index + 1 :]
        level = (*before, *_smaller(node, _between(before, after, holds)), *after)
        index = len(level) - len(after)
    return level


def _between(before: Nodes, after: Nodes, holds: Callable[[Nodes], bool]) -> Callable[[Nodes], bool]:
    """Return the test of what is between some nodes."""
    return lambda nodes: holds((*before, *nodes, *after))


def _smaller(node: Node, holds: Callable[[Nodes], bool]) -> Nodes:
    """Return what a block comes down to: what it holds where that does alone, else with less in it."""
    if node.body is None:
        return (node,)
    opening = node.head.strip().split("(")[0].split()[0]
    if opening in _UNWRAPPED and node.body and holds(node.body):
        return _inside_each(node.body, holds)

    def filled(body: Nodes) -> bool:
        return holds((Node(node.head, body, node.tail),))

    body = tuple(ddmin(node.body, lambda some: filled(tuple(some))))
    return (Node(node.head, _inside_each(body, filled), node.tail),)
