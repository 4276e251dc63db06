"""Outline a GLSL file: its top-level declarations with their comments.

Read from the text alone, one file at a time and with every branch of its conditions, so that a text that does
not compile has an outline too. A name that a macro replaces is listed as it is written.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from playground.memo import TEXTS
from playground.shader.syntax.nodes import Declaration, Function, InterfaceBlock, Node
from playground.shader.syntax.parser import Tree, parse

_MARKER = re.compile(r"//\s*(?:anchor|end|trace):")  # comments that tools read
_WORD = re.compile(r"[A-Za-z_]\w*", re.ASCII)


@dataclass(frozen=True, slots=True)
class Declared:
    """One name that a file declares at its top level."""

    name: str
    kind: str  # function | struct | variable | uniform | macro
    signature: str  # as written, on one line: "float random(ivec2 point, uint seed)"
    comment: str  # the lines of // above it, without their marks; "" where there are none
    at: int  # where the name begins in the text
    start: int  # where the declaration begins, without its comment
    end: int  # behind it: of a function, its body
    body: int = -1  # where a function's body begins; -1: there is none, as of a prototype

    @property
    def is_prototype(self) -> bool:
        """Whether it is a function that the file asks of whoever includes it."""
        return self.kind == "function" and self.body < 0


@TEXTS.cached()
def outline(text: str) -> tuple[Declared, ...]:
    """Return what a text declares at its top level, in its order; lines end in LF."""
    return outline_of(parse(text, all_branches=True))


def outline_of(tree: Tree) -> tuple[Declared, ...]:
    """Return what a tree with every branch declares at its top level, in the order of its text."""
    declared = [each for reading in (tree, *tree.branches) for each in _Outline(reading).declared()]
    return tuple(sorted(dict.fromkeys(declared), key=lambda each: (each.start, each.at)))


class _Outline:
    def __init__(self, tree: Tree) -> None:
        self.tree = tree
        self.text = tree.text

    def declared(self) -> Iterator[Declared]:
        for node in self.tree.declarations:
            if isinstance(node, Function):
                body = self.tree.span(node.body)[0] if node.body is not None else -1
                yield self._declared("function", node.at, node, body)
            elif isinstance(node, Declaration):
                kind = "uniform" if "uniform" in node.type.qualifiers else "variable"
                if (struct := node.type.struct) is not None and struct.name:
                    yield self._declared("struct", struct.at, struct, self.tree.tokens[struct.at + 1].start)
                for declarator in node.names if node.type.name or struct is not None else ():
                    yield self._declared(kind, declarator.at, node)
            elif isinstance(node, InterfaceBlock):
                kind = "uniform" if "uniform" in node.qualifiers else "variable"
                if node.instance:
                    yield self._declared(kind, node.instance_at, node)
                for member in node.members if not node.instance else ():
                    for declarator in member.names:
                        yield self._declared(kind, declarator.at, member)
        yield from self._macros()

    def _declared(self, kind: str, token: int, node: Node, body: int = -1) -> Declared:
        start, end = self.tree.span(node)
        name, at = self._name(token)
        head_end = body if kind == "function" and body >= 0 else end
        signature = self._one_line(start, head_end).removesuffix(";").rstrip()
        return Declared(name, kind, signature, _comment_above(self.text, start), at, start, end, body)

    def _name(self, index: int) -> tuple[str, int]:
        """Return a name as the text spells it, and where; a macro's call is what it stands for."""
        token = self.tree.tokens[index]
        if not token.macros or _WORD.fullmatch(self.text, token.start, token.end):
            return self.text[token.start : token.end], token.start
        return token.text, token.spelled if token.spelled >= 0 else token.start

    def _macros(self) -> Iterator[Declared]:
        for macro in self.tree.preprocessed.macros:
            if macro.at < 0 or (not macro.body and self._is_guard(macro.name, macro.start)):
                continue
            signature = f"#define {self._one_line(macro.at, macro.end)}"
            comment = _comment_above(self.text, macro.start)
            yield Declared(macro.name, "macro", signature, comment, macro.at, macro.start, macro.end)

    def _is_guard(self, name: str, start: int) -> bool:
        """Return whether a macro is defined to mark the file as included."""
        above = self.text[:start].rstrip().rpartition("\n")[2].replace(" ", "")
        return above in (f"#ifndef{name}", f"#if!defined({name})", f"#if!defined{name}")

    def _one_line(self, start: int, end: int) -> str:
        """Return a part of the text without its comments, on one line."""
        written, at = "", start
        for comment in self.tree.preprocessed.comments:
            if at <= comment.start < end:
                written += f"{self.text[at : comment.start]} "
                at = comment.end
        return " ".join(f"{written}{self.text[at:end]}".replace("\\\n", " ").split())


def _comment_above(text: str, start: int) -> str:
    """Return the lines of ``//`` right above a place, without their marks, their line ends kept."""
    lines: list[str] = []
    end = text.rfind("\n", 0, start)
    while end >= 0:
        begins = text.rfind("\n", 0, end) + 1
        line = text[begins:end].strip()
        if not line.startswith("//") or line.startswith("//!"):
            break
        if not _MARKER.match(line):
            lines.append(line[2:].removeprefix(" "))
        end = begins - 1
    return "\n".join(reversed(lines)).strip()
