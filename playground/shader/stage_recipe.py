"""Say as data how the text of a shader stage is made of a kernel's flat text, and make it so.

What surrounds a kernel's lines follows from its header, but for what stands there only if the lines name
it: an edited text makes another stage by the same recipe. The web page applies the same recipes.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from playground.shader.source import Line, SourceText
from playground.shader.syntax.tokens import directive

SIGNATURE = r"\b(\w+)\s+{name}\s*\(([^)]*)\)\s*\{{"
"""A pattern of the head of a function's definition: its type, its arguments."""

VERSION_NUMBER = re.compile(r"#\s*version\s+(\d{1,9})\d*\s*(\w*)")


@dataclass(frozen=True, slots=True)
class StagePart:
    """A text before a kernel's lines; with ``names``, only where these lines name one of them."""

    text: str  # without its last line's end
    names: tuple[str, ...] = ()

    def stands_before(self, source: SourceText) -> bool:
        """Return whether it stands before the lines of a text."""
        return not self.names or not source.names.isdisjoint(self.names)


@dataclass(frozen=True)
class Recipe:
    """How a stage is made: the parts before, each on its lines, the kernel's lines, what is after."""

    source: SourceText  # whose lines, and whose names
    before: tuple[StagePart, ...] = ()
    after: str = ""
    without: str = ""  # a function of the lines that is blanked
    replaced: tuple[tuple[str, str], ...] = ()  # names of the lines, each by one as long
    keeps_version: bool = False  # the lines' own #version begins the text; else that line is blanked
    text: str = ""  # a whole stage, made of no lines
    expected: str = ""  # the signatures that the lines should have, for errors outside of them

    def make(self) -> tuple[str, int]:
        """Return the stage's text, and the line of it, from 1, of the first of the source's lines.

        The line is 0 for a stage that is made of none.
        """
        if self.text:
            return self.text, 0
        head = "".join(f"{part.text}\n" for part in self.before if part.stands_before(self.source))
        return head + self._lines() + self.after, head.count("\n") + 1

    def _lines(self) -> str:
        if self.keeps_version:  # Mesa does not count blank lines above #version
            lines = [line.code for line in self.source.lines]
            above = next((i for i, code in enumerate(lines) if code.strip()), 0)
            return "\n".join([*["//"] * above, *lines[above:]]) + "\n"
        code, own = self.source.code, version_line(self.source)
        if own is not None:
            code = "\n".join(["" if line is own else line.code for line in self.source.lines]) + "\n"
        if self.without:
            code = without_function(code, self.without)
        for name, instead in self.replaced:
            code = re.sub(rf"\b{name}\b", instead, code)
        return code


def version_line(source: SourceText) -> Line | None:
    """Return the line of a text that says its version; None for what has none."""
    lines = (line for line in source.lines if "#" in line.code)
    return next((line for line in lines if directive(line.code)[0] == "version"), None)


def without_function(code: str, name: str) -> str:
    """Blank a function's definition, not its line ends: what one stage calls may be missing in the other."""
    match = re.search(SIGNATURE.format(name=name), code)
    if not match:
        return code
    depth, end = 0, match.end() - 1
    for end in range(match.end() - 1, len(code)):
        depth += {"{": 1, "}": -1}.get(code[end], 0)
        if depth == 0:
            break
    blank = "\n".join([" " * len(line) for line in code[match.start() : end + 1].split("\n")])
    return code[: match.start()] + blank + code[end + 1 :]
